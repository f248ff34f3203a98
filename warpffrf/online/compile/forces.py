"""Forces of a scene -> spring rows, point loads and body loads of the device model.

Elements describe themselves in the terms of `warpffrf.model.forces.laws`. A spring law on one coordinate is a row with
its own stiffness, as is each coordinate of a law with characteristics; a linear law on several is a *group* of rows
that share matrices (`warpffrf_kernels.constraints.forces`).
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from warpffrf.model.errors import InputError
from warpffrf.model.forces import BodyLoad, PointLoad, SpringLaw
from warpffrf.model.forces.characteristics import TERMS
from warpffrf.online.compile.collector import Collector
from warpffrf.online.compile.joints import JointTable
from warpffrf_kernels.constraints.forces import MOST_COUPLED
from warpffrf_kernels.core import control as k
from warpffrf_kernels.core.model import Model

ROW_KINDS = {
    "translation": k.TRANSLATION,
    "direction": k.DIRECTION,
    "angle": k.ANGLE,
    "second_angle": k.SECOND_ANGLE,
    "twist": k.TWIST,
    "distance": k.DISTANCE,
    "bushing": k.BUSHING,
}


@dataclass
class ForceTable:
    """Device indices of the forces of a scene: rows and laws of springs by name; loads in the order of the device
    arrays.
    """

    rows: dict[str, list[int]] = field(default_factory=dict)
    laws: dict[str, SpringLaw] = field(default_factory=dict)
    forces: list[PointLoad] = field(default_factory=list)
    torques: list[PointLoad] = field(default_factory=list)
    bodies: list[BodyLoad] = field(default_factory=list)
    groups: list[SpringLaw] = field(default_factory=list)
    group_start: list[int] = field(default_factory=list)  # first row of each group
    of_row: dict[int, int] = field(default_factory=dict)  # row -> group
    vectors: dict[int, np.ndarray] = field(default_factory=dict)  # row -> (6,) of a bushing coordinate


def compile_forces(collector: Collector, joints: JointTable) -> ForceTable:
    """Enter springs as rows of `collector` and collect the loads; joints must have been compiled.

    Raises `InputError` for a law without stiffness and damping.
    """
    table = ForceTable()
    for item in collector.scene.forces:
        if hasattr(item, "law"):
            law = item.law()
            table.laws[item.name] = law
            table.rows[item.name] = _spring(collector, joints, table, law)
            continue
        if hasattr(item, "slip") or hasattr(item, "tension"):  # `compile_joint_friction`, `compile_pretensions`
            continue
        load = item.load()
        if isinstance(load, BodyLoad):
            table.bodies.append(load)
        else:
            collector.interface(load.port)
            (table.forces if load.what == "force" else table.torques).append(load)
    return table


def _spring(collector: Collector, joints: JointTable, table: ForceTable, law: SpringLaw) -> list[int]:
    if law.joint is not None:
        a, b = joints.markers[str(law.joint.name)]
    else:
        sides = zip(law.ports, law.points or (), law.axes or (), strict=True)
        a, b = (collector.marker(port, point, axes) for port, point, axes in sides)
    n = len(law.coordinates)
    separate = n == 1 or bool(law.elastic)
    if n > MOST_COUPLED:
        raise InputError(f"a spring law couples {n} coordinates, at most {MOST_COUPLED} can be")
    rows = []
    for i, c in enumerate(law.coordinates):
        row = collector.rows.add(
            ROW_KINDS[c.kind], a, b, c.i, c.j, -1,
            float(law.stiffness[i, i]) if separate else 0.0, float(law.damping[i, i]) if separate else 0.0,
            float(law.reference[i]), float(law.preload[i]), 0,
            *(collector.characteristic(curves[i] if curves else None) for curves in (law.elastic, law.viscous)),
        )  # fmt: skip
        rows.append(row)
        if c.kind == "bushing":
            table.vectors[row] = c.vector
        if not separate:
            table.of_row[row] = len(table.groups)
    if not separate:
        table.groups.append(law)
        table.group_start.append(rows[0])
    return rows


def fill_forces(collector: Collector, table: ForceTable, m: Model) -> None:
    """Device arrays of groups and loads; the signals of loads are entered, so that it must precede their layout."""
    rows, bodies = len(collector.rows), collector.scene.bodies
    group = np.full(rows, -1)
    group[list(table.of_row)] = list(table.of_row.values())
    vectors = np.zeros((rows, 6))
    for row, vector in table.vectors.items():
        vectors[row] = vector
    collector.fill(m.rows, group=group, vector=vectors)
    packed = {name: np.zeros((len(table.groups), MOST_COUPLED, MOST_COUPLED)) for name in ("stiffness", "damping")}
    for name, matrices in packed.items():
        for g, law in enumerate(table.groups):
            n = len(law.coordinates)
            matrices[g, :n, :n] = getattr(law, name)
    collector.fill(
        m.groups, count=len(table.groups), start=table.group_start,
        size=[len(law.coordinates) for law in table.groups], sprung=[law.sprung for law in table.groups], **packed,
    )  # fmt: skip
    pieces = collector.characteristics
    breaks = [np.concatenate([[0.0], p.breaks]) for p in pieces]  # the first piece has no beginning
    collector.fill(
        collector.elements.characteristics, start=np.cumsum([0] + [len(p.origin) for p in pieces]),
        begin=_joined(breaks),
        coefficient=np.concatenate([np.zeros((0, TERMS)), *(p.coefficient for p in pieces)]),
        **{name: _joined([getattr(p, name) for p in pieces]) for name in ("origin", "power", "exponent", "constant")},
    )  # fmt: skip
    device = collector.external
    for topic, loads in ((device.forces, table.forces), (device.torques, table.torques)):
        collector.fill(
            topic, count=len(loads), body=[x.port.body.index for x in loads],
            interface=[collector.interface(x.port) for x in loads], in_body=[int(x.frame == "body") for x in loads],
            signal=[[collector.signal(s) for s in x.components] for x in loads],
        )  # fmt: skip
    collector.fill(device.forces, point=[x.port.point - x.port.body.center_of_mass for x in table.forces])
    widest = max([b.mode_count for b in bodies], default=0)
    modal = np.zeros((len(table.bodies), max(widest, 1)))
    for i, load in enumerate(table.bodies):
        modal[i, : len(load.modal)] = load.modal
    collector.fill(
        device.body_loads, count=len(table.bodies), body=[x.body.index for x in table.bodies],
        signal=[collector.signal(x.signal) for x in table.bodies], force=[x.force for x in table.bodies],
        torque=[x.torque - np.cross(x.body.center_of_mass, x.force) for x in table.bodies], modal=modal,
    )  # fmt: skip


def _joined(arrays: list[np.ndarray]) -> np.ndarray:
    return np.concatenate([np.zeros(0), *arrays])
