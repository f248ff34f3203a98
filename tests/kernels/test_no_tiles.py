"""Kernels have no tiles: on the CPU those share memory by a static pointer, and graphs replay in several threads
(`warpffrf.online.warp_lock`). Reductions over lanes (`core.lanes`) share memory in blocks of many lanes only; a CPU has
these in tests alone."""

import re
from pathlib import Path

import warpffrf_kernels
from warpffrf_kernels.core import lanes

SHARED = re.compile(r"\bwp\.tile|tile_shared|wp_block_shared|__shared__|\bstatic (double|float|int|char)")


def test_no_kernel_has_memory_that_threads_share() -> None:
    folder = Path(warpffrf_kernels.__path__[0])
    found = {
        f"{path.name}: {line.strip()}"
        for path in folder.rglob("*.py")
        for line in path.read_text().splitlines()
        if SHARED.search(line) and path.name != "lanes.py"
    }
    assert found == set()


def test_reductions_share_none_in_a_block_of_one_lane() -> None:
    before, rest = lanes.FOLD.split("#if WP_TILE_BLOCK_DIM > 1\n")
    own = before + rest.rsplit("#endif\n", 1)[1]
    assert own.split() == ["return", "x;"] and not SHARED.search(own)
