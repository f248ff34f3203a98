"""Kernel modules of a scene, compiled in parallel or read from Warp's cache."""

from __future__ import annotations

import logging
import os
from collections.abc import Iterable
from concurrent.futures import ThreadPoolExecutor, as_completed, wait
from typing import Any

import warp as wp

from warpffrf.model.messages.progress import Progress
from warpffrf.online.step import kernel_cache
from warpffrf.online.warp_start import quiet
from warpffrf_kernels.core.scalars import BLOCK

MOST_AT_ONCE = 8  # a compiler needs several hundred megabytes
READ_BY = 2.0  # s, within which cached modules have been loaded

log = logging.getLogger("warpffrf")


def load(modules: Iterable[Any], device: str, *, progress: bool) -> None:
    """Load the Warp `modules`, which is impossible while a graph is being captured; `progress`: show a bar, or log
    lines, if they have to be compiled."""
    wanted = list(dict.fromkeys(modules))
    bar = Progress("compile kernels", len(wanted), enabled=progress, unit="module", timed=False)
    try:
        with quiet(), ThreadPoolExecutor(max_workers=min(os.cpu_count() or 1, MOST_AT_ONCE)) as pool:
            running = [pool.submit(_load, module, device) for module in wanted]
            try:
                if progress and wait(running, READ_BY).not_done:
                    log.info(
                        "compile kernels: %d modules, once for this kind of scene on this machine; kept in %s",
                        len(wanted), wp.config.kernel_cache_dir,
                    )  # fmt: skip
                for done, future in enumerate(as_completed(running), start=1):
                    future.result()
                    bar.update(done)
            except BaseException:  # also an interruption: running compilations finish, the rest does not start
                pool.shutdown(cancel_futures=True)
                raise
    finally:
        bar.close()


def _load(module: Any, device: str) -> None:
    with kernel_cache.sound(module):
        wp.force_load(device, modules=[module], block_dim=BLOCK, max_workers=0)
