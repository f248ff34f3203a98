"""Joints and drives of a scene -> rows of the device model.

Every row of a joint (`warpffrf.model.joints`) that is not redundant (`warpffrf.model.checks.redundancy`) becomes one
rigid row; a drive adds one, or gives its signal to the row of its joint (a distance). Rows that are left
out have no multiplier: their part of the joint's reaction is zero, and the sum over the joints that share a load is
that of equilibrium. Rows of joints that are released in a part of a run, see `warpffrf.model.released`.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from warpffrf.model import rotation as rot
from warpffrf.model.checks.redundancy import ConstraintRow, Redundancy, all_rows, find_redundancy, undetermined
from warpffrf.model.errors import InputError
from warpffrf.model.pieces import Constant, Polynomial, Signal
from warpffrf.online.compile.collector import Collector
from warpffrf_kernels.core import control as k

ROW_KINDS = {
    "translation": k.TRANSLATION,
    "direction": k.DIRECTION,
    "angle": k.ANGLE,
    "distance": k.DISTANCE,
    "second_angle": k.SECOND_ANGLE,
    "twist": k.TWIST,
}


@dataclass
class JointTable:
    """Device indices of the joints of a scene: rows and markers by joint name, the omitted rows, and notes for the
    user.
    """

    rows: dict[str, list[int]] = field(default_factory=dict)  # drives included
    held: dict[str, list[int]] = field(default_factory=dict)  # without them
    markers: dict[str, tuple[int, int]] = field(default_factory=dict)
    dropped: list[ConstraintRow] = field(default_factory=list)
    # joints whose reactions depend on the choice of the omitted rows
    undetermined: list[str] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)


def compile_joints(collector: Collector) -> JointTable:
    """Enter the rows of all joints and drives of `collector.scene`, by its `rows`, `marker` and `signal`.

    Raises `InputError` where a drive prescribes what the joints already fix.
    """
    scene, table = collector.scene, JointTable()
    found = find_redundancy(scene)
    _refuse_driven(found)
    for joint in scene.joints:
        pair = [
            collector.marker(port, marker.point, rot.matrix(marker.rotation))
            for port, marker in zip(joint.ports, joint.frames(), strict=True)
        ]
        table.markers[str(joint.name)] = (pair[0], pair[1])
        table.rows[str(joint.name)], table.held[str(joint.name)] = [], []
    holding, released = found.holding, scene.released
    for item in all_rows(scene):
        if item.key not in holding | released.rows:
            continue
        a, b = table.markers[str(item.joint.name)]
        signal, reference = None, item.initial
        holds = item.key in holding
        if item.drive is not None and holds:
            signal = item.drive.position()
            if item.drive.quantity == "position":  # relative to zero, not to the initial value
                reference = 0.0
        if holds and item.key in released.held_at:
            signal, reference = _held_at(item, signal, released.held_at[item.key])
        number = collector.rows.add(
            ROW_KINDS[item.row.kind], a, b, item.row.i, item.row.j, reference=reference, rigid=int(holds),
            signal=-1 if signal is None else collector.signal(signal),
        )  # fmt: skip
        table.rows[str(item.joint.name)].append(number)
        if item.drive is None and holds:
            table.held[str(item.joint.name)].append(number)
    table.dropped, table.undetermined = found.dropped, undetermined(scene, found)
    if table.dropped:
        table.notes.append(
            "redundant constraints left out, their reactions count as zero (z: axis of the joint): "
            + "; ".join(row.label for row in table.dropped)
        )
    if found.rank_here < found.rank:
        table.notes.append(
            "the initial pose is singular (a dead centre or a flat loop): the joints do not determine the motion "
            "there, place the bodies off it"
        )
    return table


def _held_at(item: ConstraintRow, signal: Signal | None, coordinate: float) -> tuple[Signal | None, float]:
    """Signal and reference of a row that holds at `coordinate`, in addition to the `signal` of a drive. An angle is
    taken relative to its signal, so that it may have any number of turns."""
    if item.row.kind == "direction":
        return None, coordinate
    breaks, c = (signal or Constant(0.0)).polynomial()
    c = np.array(c)
    c[:, 0] += coordinate
    return Polynomial(breaks, c), 0.0


def _refuse_driven(found: Redundancy) -> None:
    for item in found.dropped:
        if item.drive is not None:
            raise InputError(
                f"drive {item.drive.name!r}: the {item.drive.coordinate} of joint {item.joint.name!r} is fixed already "
                "by the other joints and drives; remove one of them"
            )
