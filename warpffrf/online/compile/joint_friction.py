"""Friction in joints -> rows without stiffness, and the bounds of their forces (`kernels joint_friction`)."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from warpffrf.model.forces import SlipLaw
from warpffrf.online.compile.collector import Collector
from warpffrf.online.compile.joints import ROW_KINDS, JointTable


@dataclass
class SlipTable:
    """Friction in the joints of a scene, in the order of the device arrays."""

    laws: dict[str, SlipLaw] = field(default_factory=dict)
    rows: dict[str, list[int]] = field(default_factory=dict)
    held: dict[str, list[int]] = field(default_factory=dict)  # rows of the joints whose reactions act normally


def compile_joint_friction(collector: Collector, joints: JointTable) -> SlipTable:
    """Enter the rows, after those of the joints and before those of springs; a note where the normal reactions are not
    determined.
    """
    table = SlipTable()
    for item in collector.scene.forces:
        if not hasattr(item, "slip"):
            continue
        law = item.slip()
        joint = str(law.joint.name)
        a, b = joints.markers[joint]
        table.laws[item.name] = law
        table.rows[item.name] = [
            collector.rows.add(ROW_KINDS[c.kind], a, b, c.i, c.j, rigid=0) for c in law.coordinates
        ]
        table.held[item.name] = joints.held[joint]
    if rubbing := [name for name, law in table.laws.items() if str(law.joint.name) in joints.undetermined]:
        collector.notes.append(
            f"friction {', '.join(map(repr, rubbing))}: the constraints do not determine how the joints "
            f"{', '.join(map(repr, joints.undetermined))} share their load; reactions omitted as redundant "
            "do not contribute, so that this friction depends on the order of adding the joints; let one of them "
            "leave free what another one constrains, or replace it by a Bushing, whose stiffness shares the load"
        )
    return table


def fill_joint_friction(collector: Collector, table: SlipTable) -> None:
    """Device arrays."""
    laws, held = list(table.laws.values()), list(table.held.values())
    collector.fill(
        collector.elements.joint_frictions, count=len(laws), start=[rows[0] for rows in table.rows.values()],
        size=[len(law.coordinates) for law in laws], weight=[(*law.weights, 1.0)[:2] for law in laws],
        coefficient=[law.friction.static_coefficient for law in laws],
        slip_velocity=[law.friction.creep_limit for law in laws], radial=[law.radial for law in laws],
        axial=[law.axial for law in laws], spin=[law.spin for law in laws],
        bending=[1.0 / law.bearing_length if law.bearing_length else 0.0 for law in laws],
        preload=[law.load_independent for law in laws], held_start=np.cumsum([0] + [len(rows) for rows in held]),
        held=[row for rows in held for row in rows],
    )  # fmt: skip
