"""The check of the order of launches: a scratch array that a launch reads, or changes, has to be set by one before it,
unless it is declared as `carried`, and within a phase nothing is read that is set anew after it."""

from __future__ import annotations

import functools
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from launch_order.access import access_of
from warpffrf.online.step.launches import CONSTANTS, DECLARED, Launch
from warpffrf.online.step.phases import Placed, launches
from warpffrf_kernels.core.declaration import Declaration

SET_FIRST = {
    ("joint_friction.rub", "slip_branch"),
    ("joint_friction.rub", "slip_way"),
    ("forces.find_forces", "lumped_load"),
    ("moments.find_moments", "lumped_moment"),
    ("solve.solve_matched", "matched_guess"),
    ("solve.solve_matched", "matched_rest"),
    ("line_of_centres.locate", "center"),
    ("line_of_centres.locate", "phase"),
    ("closest_point.locate_points", "center"),
    ("closest_point.locate_points", "phase"),
    ("place.locate_patches", "center"),
    ("place.locate_patches", "window"),
    ("windows.open_window", "station"),
    ("system.assemble_cells", "slot_reach"),
    ("slope_condensation.condense_slopes", "speed_late"),
    ("slope_condensation.condense_slopes", "speed_slope"),
}
"""Launches that set an array before they read it, though it is read first in the source: in a branch, or in a loop."""


@dataclass(frozen=True)
class Bound:
    """Names of arrays."""

    read: set[str]
    written: set[str]
    changed: set[str]


@functools.cache
def bound_of(launch: Launch) -> Bound:
    """What a launch reads, writes and changes, but for constants of the scene."""
    access = access_of(launch.kernel)
    names = dict(zip((argument.label for argument in launch.kernel.adj.args), launch.bound, strict=True))
    renamed = [{names.get(name, name[1:]) for name in some} for some in (access.read, access.written, access.changed)]
    read, written, changed = ({name for name in some if name not in CONSTANTS} for some in renamed)
    return Bound(read, written, {name for name in changed if (launch.label, name) not in SET_FIRST})


def complaints(
    phases: Sequence[tuple[str, Sequence[Placed]]],
    sizes: Mapping[str, int],
    declared: Mapping[str, Declaration] = DECLARED,
) -> list[str]:
    """What is wrong with the order in a scene of these sizes: launches that read what nothing has set before them."""
    placed = [
        (phase, [(launch.label, bound_of(launch), repeated) for launch, repeated in launches(parts, sizes)])
        for phase, parts in phases
    ]
    set_by_some = {name for _, here in placed for _, launch, _ in here for name in launch.written}
    known = {
        name
        for name, d in declared.items()
        if d.carried or 0 in d.shape(sizes) or (d.zero_without and name not in set_by_some)
    }
    found = []
    for phase, here in placed:
        read_here: dict[str, str] = {}
        for label, launch, repeated in here:
            needed = launch.changed | (launch.read - launch.written)
            for name in sorted(needed - known):
                does = "changes" if name in launch.changed else "reads"
                found.append(
                    f"phase {phase!r}: {label} {does} {name}, which nothing has set before; put what sets it into an "
                    "earlier phase, or declare it as carried"
                )
            for name in sorted((launch.written - launch.read) & set(read_here)):
                if not declared[name].carried and not repeated:
                    found.append(
                        f"phase {phase!r}: {label} sets {name} anew after {read_here[name]} has read it; give them "
                        "phases of their own"
                    )
            read_here |= {name: label for name in launch.read - launch.written}
            known |= launch.written
    return list(dict.fromkeys(found))
