"""Number of worlds that fit into the free memory of a device.

The arrays of a world are counted from their declarations, with the lengths of axes that the scene has now: rows of the
ring for the run at hand, and the present capacity of active nodes, not the largest. Half of what is free is left for
the tables of scenes, histories on the host, and nodes that become active.
"""

from __future__ import annotations

import logging

import psutil
import warp as wp

from warpffrf.model.integrators import GeneralizedAlpha, Integrator
from warpffrf.online.arrays import Ring, Scratch, State, sizes_of
from warpffrf.online.compile.retained_pattern import pattern_of
from warpffrf.online.compile.scene import CompiledScene
from warpffrf.online.settings import LARGEST_INDEX, Settings

SHARE = 0.5  # of the free memory, for arrays

log = logging.getLogger("warpffrf")


def free_memory(device: str) -> int:
    """Free memory of a device [byte]; of the CPU that of the machine."""
    found = wp.get_device(device)
    return int(psutil.virtual_memory().available if found.is_cpu else found.free_memory)


def bytes_of_a_world(
    compiled: CompiledScene, settings: Settings, integrator: Integrator | None, step_error: float | None
) -> tuple[int, int]:
    """Bytes of the arrays of one world, and entries of the largest of them."""
    projected = (integrator or GeneralizedAlpha()).project_velocities and compiled.model.rows.count > 0
    sizes = sizes_of(
        compiled, 1, settings.ring_rows, pattern_of(compiled), projected=projected, adaptive=step_error is not None
    )
    parts = [kind.room(sizes) for kind in (State, Ring, Scratch)]
    return sum(size for size, _ in parts), max(entries for _, entries in parts)


def worlds_that_fit(
    compiled: CompiledScene, settings: Settings, integrator: Integrator | None, step_error: float | None, wanted: int
) -> int:
    """At most `wanted` worlds, at least one, for which memory and the indices of kernels suffice; a line in the log
    where they do not suffice for all."""
    size, entries = bytes_of_a_world(compiled, settings, integrator, step_error)
    free = free_memory(compiled.device)
    found = max(1, min(wanted, int(SHARE * free) // size, LARGEST_INDEX // entries))
    if found < wanted:
        log.warning(
            "worlds: %d of %d fit at once (%.3g MB each, half of the %.4g MB free on %s, and 32-bit indices); they run "
            "in batches",
            found, wanted, size / 1e6, free / 1e6, compiled.device,
        )  # fmt: skip
    return found
