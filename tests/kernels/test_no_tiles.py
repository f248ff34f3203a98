"""Kernels have no tiles: on the CPU those share memory by a static pointer, and graphs replay in several threads
(`warpffrf.online.warp_lock`)."""

import re
from pathlib import Path

import warpffrf_kernels

SHARED = re.compile(r"\bwp\.tile|tile_shared|wp_block_shared|__shared__|\bstatic (double|float|int|char)")


def test_no_kernel_has_memory_that_threads_share() -> None:
    folder = Path(warpffrf_kernels.__path__[0])
    found = {
        f"{path.name}: {line.strip()}"
        for path in folder.rglob("*.py")
        for line in path.read_text().splitlines()
        if SHARED.search(line)
    }
    assert found == set()
