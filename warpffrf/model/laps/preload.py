"""Laps whose faces begin inside each other, or apart: what holds a preload, and what hardly touches.

Interference presses faces apart. A hub around its shaft carries that by itself, as pressures all around cancel; two
plates need a bolt, a joint or a load. Bodies that no joint, spring or contact connects make a *part*; of each part the
pressures of its laps, taken as one everywhere, have the resultant

    r = |sum n A|/sum A,

n the outward normals of the cells in the world, A their areas: 1 of a plane face, 0 of a closed one. A part with r
above `ONE_SIDED` flies off unless something loads it.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from warpffrf.model import rotation as rot
from warpffrf.model.bodies import GROUND_INDEX
from warpffrf.model.errors import InputError
from warpffrf.model.laps.lap import Lap, LapCellsOf

Array = np.ndarray
ONE_SIDED = 0.5  # of r
APART = 1e-3  # of the extent of a lap: gaps that elastic bodies hardly close
DEEP = 1e-2  # of it: interference beyond small strains
COVERED = 0.5  # of the smaller face


def refuse_pushed_apart(scene: Any) -> None:
    """Raises `InputError` where interference pushes a part of the scene away and nothing holds or loads it."""
    if not any(lap.interference > 0.0 for lap in scene.laps) or np.any(scene.gravity):
        return
    part = _parts(scene)
    for number in set(part.values()) - {part[GROUND_INDEX]}:
        members = [lap for lap in scene.laps if _sides(lap, part, number) == 1]
        pressing = [lap for lap in members if lap.interference > 0.0]
        if not pressing or any(part[port.body.index] == number for item in _loads(scene) for port in item.ports):
            continue
        sums = [_resultant(lap, first=part[lap.a.body.index] == number) for lap in members]
        total = np.linalg.norm(sum(n for n, _ in sums)) / sum(area for _, area in sums)
        if total > ONE_SIDED:
            lap = pressing[0]
            names = ", ".join(repr(body.name) for body in scene.bodies if part[body.index] == number)
            raise InputError(
                f"{lap.label}: its interference of {lap.interference:.3g} m pushes {names} away, a preload without a "
                "load path: no joint, spring or contact holds both sides together and no force presses them; add a "
                "bolt (JointSpringDamper(preload=)), a joint or a force, or leave the interference out"
            )


def lap_notes(lap: Lap, cells: LapCellsOf) -> list[str]:
    """What is odd in where the faces of a lap begin."""
    extent = float(np.linalg.norm(np.ptp(lap.a.surface.points, axis=0))) + float(np.sqrt(cells.area.max()))
    notes = []
    if (gap := float(cells.gap.min())) > APART * extent:
        notes.append(
            f"{lap.label}: its faces are {gap:.3g} m apart where they are nearest, {gap / extent:.2g} of their extent, "
            "and carry nothing until they meet; move a body, with scene.place(), or give interference"
        )
    if (depth := -float(cells.gap.min())) > DEEP * extent:
        notes.append(
            f"{lap.label}: one face begins {depth:.3g} m inside the other, {depth / extent:.2g} of their extent, "
            "beyond small strains unless a layer yields; check the places of the bodies and the unit of interference, m"
        )
    if max(cells.shares) < COVERED:
        notes.append(
            f"{lap.label}: {cells.shares[0]:.2g} and {cells.shares[1]:.2g} of the areas of its faces overlap, the rest "
            "carries nothing; move a body, or name smaller facet sets"
        )
    return notes


def _loads(scene: Any) -> list[Any]:
    return [item for item in scene.forces if len(item.ports) == 1]


def _parts(scene: Any) -> dict[int, int]:
    """Of each body by index, and of the ground, the number of the part that it belongs to."""
    part = {index: index for index in (GROUND_INDEX, *(body.index for body in scene.bodies))}
    linking = (*scene.joints, *scene.forces, *scene.contacts, *scene.lumped_contacts, *scene.films)
    for item in linking:
        first, *others = (part[port.body.index] for port in item.ports)
        for other in others:
            part = {index: first if number == other else number for index, number in part.items()}
    return part


def _sides(lap: Lap, part: dict[int, int], number: int) -> int:
    """How many faces of a lap are on a part."""
    return 0 if lap.b is None else sum(part[port.body.index] == number for port in lap.ports)


def _resultant(lap: Lap, *, first: bool) -> tuple[Array, float]:
    """sum n A (3,) in the world, outwards of the lap's first face or of its second, and sum A [m2]."""
    cells = lap.cells()
    n = rot.matrix(lap.a.body.rotation) @ (cells.area @ cells.frames[:, 0])
    return n if first else -n, float(cells.area.sum())
