"""Verification: joints with small sliding."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import replace

import numpy as np

from demos import leaf_spring as leaves
from demos import press_fit as fit
from references.closed_forms import LeafSpring, PressFit, TurnedFit
from studies.small_sliding import cases, motion
from studies.small_sliding.rows import Row as StudyRow
from studies.validate.case import Row, case

ROOM = "Joints with small sliding"


def _rows(found: Iterable[StudyRow]) -> Iterator[Row]:
    """As rows of this page."""
    for row in found:
        yield Row(row.compared, row.found, row.exact, row.target, row.unit, None if row.relative else 1.0)


@case(ROOM, "L. E. Goodman and J. H. Klumpp, J. Appl. Mech. 23 (1956) 421; cycles by Masing's rule")
def two_leaves() -> Iterator[Row]:
    """Two leaves pressed together, clamped at one end and loaded at the tip, a cycle to twice the force of slip"""
    yield from _rows(cases.leaf_rows())


@case(ROOM, "Bar on a base with a constant resistance t: displacement F²/(2 EA t), loss 2F³/(3 EA t)")
def bar_with_micro_slip() -> Iterator[Row]:
    """A bar between rigid faces, cycles of forces over a decade"""
    yield from _rows(cases.micro_slip_rows())


@case(ROOM, "VDI 2230 (2015): bolt and clamped parts in parallel")
def bolted_joint() -> Iterator[Row]:
    """Two blocks drawn together by a spring and parted until the joint opens"""
    yield from _rows(cases.bolt_rows())


@case(ROOM, "G. Lamé's thick rings; slip at 2πR²bμp")
def press_fit_pressure() -> Iterator[Row]:
    """A solid shaft in a hub of twice its radius, 10 µm of interference, 32 cells around"""
    yield from _rows(cases.press_fit_rows())


@case(ROOM, "The same body without the joint")
def pressed_blocks() -> Iterator[Row]:
    """Two blocks pressed together without friction: nodes and facets as cells"""
    for row, cells in zip(_rows(cases.press_rows()), ("nodes", "facets"), strict=True):
        yield replace(row, quantity=f"shortening by {cells}")


@case(ROOM, "Invariants: momentum; forces of a rotated system are rotated")
def flying_pair() -> Iterator[Row]:
    """Reduced model: a pair of blocks that a spring holds together flies and spins, and the same pair rotated"""
    yield from _rows(motion.flight_rows())


@case(ROOM, "2ζ = D/(2πU) of the static loop between the same forces")
def ring_down() -> Iterator[Row]:
    """A mass on a spring at the end of the bar loses energy by its slip"""
    yield from _rows(motion.ring_down_rows())


@case(ROOM, "Shear lag of a seat in torsion and Masing's rule, derived in references/closed_forms/turned_fit.py")
def turned_press_fit() -> Iterator[Row]:
    """The demo press_fit: a shaft rotated in its hub through a cycle, slip from the entry of the seat"""
    size = fit.QUICK
    result = fit.run(fit.build(size, progress=False), size, progress=False)
    closed = PressFit(
        fit.RADIUS, fit.OUTER_RADIUS, fit.INTERFERENCE, fit.WIDTH, friction=fit.FRICTION, shaft=fit.STEEL
    )  # fmt: skip
    exact, n = TurnedFit(closed), size.steps
    torque, angle = result.joint(fit.TURN).torque[:, 1], result.joint(fit.TURN).coordinate
    loss = result.contact(fit.SEAT).loss_between(float(n), float(5 * n))
    pressed = result.contact(fit.SEAT).pressure[0]
    yield Row("largest pressure", 1e-6 * pressed.max(), 1e-6 * closed.pressure, 0.015, "MPa")
    yield Row("torque of whole slip", torque[-1], closed.slip_torque, 0.01, "N m")
    up = slice(1, n + 1)
    twist = np.abs(angle[up] - exact.loading(torque[up])).max()
    yield Row("angle of first loading off by, over the largest", twist, 0.0, 0.01, "rad", float(angle[n]))
    yield Row("loss per cycle", 1e3 * loss, 1e3 * exact.cycle_loss(float(torque[n])), 0.02, "mJ")


@case(ROOM, "Beams that touch at their tips alone, references/closed_forms/leaf_spring.py; they are stiff in the clamp")
def leaf_spring() -> Iterator[Row]:
    """The demo leaf_spring: four leaves with friction under loads that grow and fall"""
    size = leaves.QUICK
    result = leaves.run(leaves.build(size, progress=False), size, progress=False)
    load, n = leaves.path(size), size.steps
    z = np.mean([result.sensor(end).values[:, 2] for end in leaves.ENDS], axis=0)
    down = z[0] - z
    lengths = tuple(leaves.HALF - leaves.CLAMP)
    beams = LeafSpring(lengths, leaves.WIDE, leaves.THICK, leaves.STEEL.youngs_modulus, leaves.FRICTION)
    yield Row("deflection under all of the load", 1e3 * down[n], 1e3 * beams.follow(load)[0][n], 0.08, "mm")
    for name, row, theirs in (
        ("load grows", n, beams.stiffness(1.0)), ("load falls", 2 * n, beams.stiffness(-1.0)),
        ("all stuck", 3 * n + 1, beams.stuck_stiffness),
    ):  # fmt: skip
        slope = (load[row] - load[row - 1]) / (down[row] - down[row - 1])
        yield Row(f"stiffness, {name}", 1e-3 * slope, 1e-3 * theirs, 0.08, "N/mm")
