"""Pretensions of a scene, and preloads of springs that are signals -> rows without stiffness, and the times of locking.

The kernels are in `warpffrf_kernels.constraints.pretension`.
"""

from __future__ import annotations

from dataclasses import dataclass, field

from warpffrf.model.forces import TensionLaw
from warpffrf.model.forces.laws import tension_of
from warpffrf.online.compile.collector import Collector
from warpffrf.online.compile.joints import ROW_KINDS, JointTable


@dataclass
class TensionTable:
    """Pretensions of a scene, and preloads in time, in the order of the device arrays: their laws and rows by name."""

    laws: dict[str, TensionLaw] = field(default_factory=dict)
    rows: dict[str, int] = field(default_factory=dict)


def compile_pretensions(collector: Collector, joints: JointTable) -> TensionTable:
    """Enter the rows, after those of joints and their friction and before those of springs."""
    table = TensionTable()
    for item in collector.scene.forces:
        if (law := tension_of(item)) is not None:
            a, b = joints.markers[str(law.joint.name)]
            c = law.coordinate
            table.laws[item.name] = law
            table.rows[item.name] = collector.rows.add(ROW_KINDS[c.kind], a, b, c.i, c.j, rigid=0)
    return table


def fill_pretensions(collector: Collector, table: TensionTable) -> None:
    """Device arrays; their signals are entered, so that it must precede their layout."""
    laws = table.laws.values()
    collector.fill(
        collector.elements.pretensions, count=len(laws), row=list(table.rows.values()),
        signal=[collector.signal(law.force) for law in laws], lock_at=[law.lock_at for law in laws],
    )  # fmt: skip
