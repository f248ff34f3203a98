"""Verification: contact with friction, at rest, sliding and rolling."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from references.closed_forms import (
    CarterRolling,
    LineContact,
    MindlinLine,
    MindlinPoint,
    PointContact,
    contact_modulus,
    tangential_compliance,
)
from references.closed_forms import rolling_tables as published
from references.half_space.bodies import half_plane, half_space
from references.stick_slip import BeltOscillator
from scenes import block_on_belt as belt
from scenes.half_space import PAIR, STEEL, STEP, ball, cylinder, pushed, rolling, simulated
from scenes.rolling_pairs import FRICTION as ROLLERS_FRICTION
from scenes.rolling_pairs import PLANE_STEEL, line_contact
from studies.rolling import carter, patch_rolling, rolling_bodies, rolling_steady
from studies.rolling.drilling_ball import SPIN_MOMENT, drilling
from studies.validate.case import Row, case
from warpffrf.model import laws
from warpffrf.model.material import Material
from warpffrf.online.run import run
from warpffrf.output.result import Result
from warpffrf.output.simulate import static

ROOM = "Friction"
FRICTION, QUARTER, UM = 0.3, 4, 1e6  # -, steps to a peak, of a metre
MINDLIN = "C. Cattaneo, Rend. Lincei 27 (1938); R. D. Mindlin, J. Appl. Mech. 16 (1949) 259"
CARTER = "F. W. Carter, Proc. R. Soc. A 112 (1926) 151; K. L. Johnson, Contact Mechanics (1985), section 8.3"
KALKER = (
    "J. J. Kalker, On the rolling contact of two elastic bodies in the presence of dry friction, thesis, Delft (1967), "
    "table of coefficients"
)
CONTACT = "E. A. H. Vollebregt, User guide for CONTACT, VORtech"


def _stick(result: Result, i: int) -> float:
    """Half-width or radius [m] of the stick zone, by its measure."""
    scene: Any = result.history.scene
    grid, friction = scene.contacts[0].a.surface.grid, result.history.contacts[PAIR].friction
    assert friction is not None
    stick = friction.state[i] == 1
    return grid.pitch * (0.5 * float(stick[:, 0].sum()) if grid.rows == 2 else float(np.sqrt(stick.sum() / np.pi)))


def _loss(result: Result, exact: MindlinLine | MindlinPoint, width: float) -> tuple[float, float]:
    """Of a cycle, found and expected [J, or J/m], between the forces that were found."""
    work, Q = result.history.energy["friction"], result.history.contacts[PAIR].force[:, 0] / width
    found = float(work[QUARTER] - work[5 * QUARTER]) / width
    return found, exact.cycle_loss(0.5 * float(Q[QUARTER] - Q[3 * QUARTER]))


@case(ROOM, f"{MINDLIN}; Johnson, section 7.2")
def cattaneo_line() -> Iterator[Row]:
    """C4 in two dimensions: a rigid cylinder shifted to Q = 0.5 μP on an exact elastic half-plane and through a cycle,
    32 cells in the half-width"""
    radius, a, width, cells = 0.05, 1.5e-3, 0.01, 32
    E = contact_modulus(STEEL)
    line = LineContact(a * a * np.pi * E / (4.0 * radius), radius, E)
    exact = MindlinLine(line, FRICTION, 20.0 * a)
    body = half_plane(2 * int(1.3 * cells + 3) + 1, a / cells, width, STEEL, exact.depth)
    shift = float(exact.loading(0.5 * exact.limit))
    scene, steps = pushed(body, cylinder(radius), line.load * width, shift, QUARTER, FRICTION)
    result = simulated(scene, steps * 1e-3, 1e-3)
    Q = float(result.history.contacts[PAIR].force[QUARTER, 0]) / width
    yield Row("c/a of the stick zone", _stick(result, QUARTER) / a, float(np.sqrt(0.5)), 1.0 / cells, "", 1.0)
    yield Row("Q/μP at the shift of the closed form", Q / exact.limit, 0.5, 0.02)
    lost, theirs = _loss(result, exact, width)
    yield Row("loss per cycle", lost, theirs, 0.03, "J/m")


@case(ROOM, f"{MINDLIN}; R. D. Mindlin and H. Deresiewicz, J. Appl. Mech. 20 (1953) 327; Johnson, sections 7.2 and 7.4")
def cattaneo_point() -> Iterator[Row]:
    """C4, C5: a rigid ball of R 10 mm under 100 N shifted to Q = 0.5 μP on an exact elastic half-space, 12 cells in
    the radius of the patch"""
    point, cells = PointContact(100.0, 0.01, contact_modulus(STEEL)), 12.0
    exact = MindlinPoint(point, FRICTION, tangential_compliance(STEEL))
    body = half_space(31, 31, point.half_width / cells, STEEL)
    scene, steps = pushed(body, ball(point.radius), point.load, 0.295764e-6, QUARTER, FRICTION)
    result = simulated(scene, steps * 1e-3, 1e-3)
    Q = float(result.history.contacts[PAIR].force[QUARTER, 0])
    found = float(exact.loading(Q))  # the shift that belongs to the force found
    yield Row("c/a of the stick zone", _stick(result, QUARTER) / point.half_width, 0.79370, 1.0 / cells, "", 1.0)
    yield Row("shift, against that of the force found", UM * 0.295764e-6, UM * found, 0.02, "µm")
    lost, theirs = _loss(result, exact, 1.0)
    yield Row("loss per cycle", 1e6 * lost, 1e6 * theirs, 0.03, "µJ")


@case(ROOM, f"{CONTACT}, example of Cattaneo; closed form 8.17e-3 mm")
def contact_cattaneo() -> Iterator[Row]:
    """P3: a sphere on a plane, both of G 200 MPa and ν 0.42, patch of 1 mm, 9.195 N, pushed to 7/8 of μN, μ 0.4; a
    rigid sphere on an exact half-space of half the modulus, 12 cells in the radius"""
    soft = Material(2.0 * 100e6 * 1.42, 0.42, 1000.0)
    modulus, load, a = contact_modulus(soft), 9.195, 1e-3
    sphere = PointContact(load, a**3 * modulus / (0.75 * load), modulus)
    body = half_space(31, 31, a / 12.0, soft)
    scene, steps = pushed(body, ball(sphere.radius), load, 0.875 * 0.4 * load, QUARTER, 0.4, by_force=True)
    result = static(scene, QUARTER * STEP, step=STEP, progress=False)
    history = result.history
    approach = sphere.radius - float(history.bodies["partner"].position[0, 2])
    yield Row("approach", 1e3 * approach, 0.01998, 0.01, "mm")
    yield Row("peak pressure", 1e-6 * float(history.contacts[PAIR].pressure[0].max()), 4.393, 0.01, "MPa")
    yield Row("shift", 1e3 * float(history.bodies["partner"].position[-1, 0]), 8.155e-3, 0.02, "mm")
    yield Row("c/a of the stick zone", _stick(result, QUARTER) / a, 0.5, 1.0 / 12.0, "", 1.0)


def _carter(radius: float, a: float, creepage: float, cells: int) -> tuple[float, float, LineContact]:
    """Q/(mu P) found after ten crossings, and the creepage found; a rigid cylinder on an exact half-plane of steel."""
    width, speed, crossings, pitch = 0.01, 1.0, 10, a / cells
    line = LineContact(a * a * np.pi * contact_modulus(STEEL) / (4.0 * radius), radius, contact_modulus(STEEL))
    way = 2 * cells * crossings
    body = half_plane(way + 8 * cells + 1, pitch, width, STEEL, 40.0 * a)
    scene = rolling(body, radius, line.load * width, creepage, -0.5 * way * pitch, speed, FRICTION)
    result = simulated(scene, way * pitch / speed, pitch / speed)
    contact = result.history.contacts[PAIR]
    assert contact.friction is not None
    share = -float(np.mean((contact.force[:, 0] / np.abs(contact.force[:, 2]))[-2 * cells :])) / FRICTION
    return share, -float(contact.friction.creep_velocity[-1, 0] / contact.friction.rolling_velocity[-1]), line


@case(ROOM, CARTER)
def carter_half_plane() -> Iterator[Row]:
    """C6: a rigid cylinder rolls on an exact elastic half-plane, body-fixed cells, 8 in the half-width: Q at the
    creepage found, after ten crossings"""
    a, radius = 1.5e-3, 5.0
    for share in (0.25, 0.5, 0.75, 0.99):
        creepage = FRICTION * a / radius * (1.0 - np.sqrt(1.0 - share))
        found, crept, line = _carter(radius, a, creepage, 8)
        theirs = CarterRolling(line, FRICTION, crept).share
        yield Row(f"Q/μP, prescribed for {share:g}", found, theirs, 0.01)


@case(ROOM, CARTER)
def carter_prescribed_force() -> Iterator[Row]:
    """C6: creepage of two steel cylinders of R 50 mm at a prescribed force, μ 0.3, by the friction law in body-fixed
    cells by itself (tests/references/half_space), 8 cells in the half-width"""
    for share, theirs in zip(carter.SHARES, (0.26703, 0.58377, 0.99656, 1.7938), strict=True):
        error = carter.creepage_error(share, 8, 16)
        yield Row(f"creepage in 10⁻³ at Q/μP = {share:g}", theirs * (1.0 + error), theirs, 0.02)


@case(ROOM, f"{CONTACT}, example of Carter, which gives 0.648 with 50 cells; closed form 0.64")
def contact_carter() -> Iterator[Row]:
    """P2: a cylinder of R 500 mm on a plane, half-width 1 mm, creepage 2.4e-4, μ 0.3; a rigid cylinder on an exact
    half-plane, 16 cells in the half-width"""
    found, crept, _ = _carter(0.5, 1e-3, 2.4e-4, 16)
    yield Row("creepage found, in 10⁻³", 1e3 * crept, 0.24, 0.01)
    yield Row("Fx/μN", found, 0.64, 0.015)


@case(ROOM, CARTER)
def carter_rollers() -> Iterator[Row]:
    """C6: two steel rollers of R 50 mm in plane strain, contact-fixed cells, 15 strips, a strip per step, 4 mm mesh"""
    for creepage in rolling_steady.CREEPAGES:
        _, found = rolling_steady.carter_error(15, 1.0, creepage)
        line = line_contact(found.load, PLANE_STEEL, PLANE_STEEL)
        theirs = CarterRolling(line, ROLLERS_FRICTION, creepage).share
        yield Row(f"Q/μP at a creepage of {creepage:g}", abs(float(found.share[0])), theirs, 0.01, "", 1.0)


@case(ROOM, f"{CONTACT}, example Eurosprinter; its own error is about 0.01 of μN")
def eurosprinter() -> Iterator[Row]:
    """P1: wheel on rail by similarity: two crowned rollers of R 50 and 142.16 mm, 170.7 N, G 82 GPa, ν 0.28,
    contact-fixed cells 13 x 13"""
    for creepage, theirs in published.EUROSPRINTER_FORCES:
        found, _ = rolling_steady.eurosprinter(creepage, 13)
        yield Row(f"Fx/μN at a creepage of {creepage:g}", found, theirs, 0.015, "", 1.0)


@case(ROOM, KALKER)
def kalker_rollers() -> Iterator[Row]:
    """P4: two crowned rollers that creep slightly and do not slip, contact-fixed cells 21 x 21, Poisson's ratio 0.25"""
    for ratio, rows in published.KALKER.items():
        errors = rolling_steady.kalker(ratio, 0.25, 21)
        for name, row, error in zip(("C11", "C22", "C23"), rows, errors, strict=True):
            yield Row(f"{name}, a/b = {ratio:g}", row[1] * (1.0 + error), row[1], 0.03)


@case(ROOM, KALKER)
def kalker_law() -> Iterator[Row]:
    """P4: the friction law in contact-fixed cells by itself, without bodies (tests/references/half_space), 21 x 21
    cells"""
    for ratio, rows in published.KALKER.items():
        for nu in (0.0, 0.5):
            errors = patch_rolling.kalker_error(ratio, nu, 21)
            for name, row, error in zip(("C11", "C22", "C23"), rows, errors, strict=True):
                theirs = row[published.KALKER_POISSON.index(nu)]
                tolerance = 0.035 if name == "C23" else 0.025
                yield Row(f"{name}, a/b = {ratio:g}, ν {nu:g}", theirs * (1.0 + error), theirs, tolerance)


@case(ROOM, "Coulomb's law: |Q| = μN against the slip velocity")
def gross_slip() -> Iterator[Row]:
    """Crowned rollers that roll and slip all over the patch, with longitudinal and lateral creepage"""
    force, angle = rolling_bodies.gross(-0.05, 0.0866)
    yield Row("|Q|/μN", 1.0 + force, 1.0, 1e-3)
    yield Row("angle between force and slip", angle, 0.0, 0.05, "°", 1.0)


@case(ROOM, "Hertz's pressure in full slip, integrated: M = (3π/16) μPa")
def drilling_ball() -> Iterator[Row]:
    """A steel ball that turns about the normal of its contact with a plane, five cells in the half-width"""
    friction: Any = drilling().contact("pair").friction
    yield Row("spin moment", 1e3 * float(friction.spin_moment[-1]), 1e3 * SPIN_MOMENT, 0.01, "mN m")


@case(ROOM, "Integration from event to event, references/stick_slip.py; with two coefficients a closed form")
def stick_slip() -> Iterator[Row]:
    """A mass on a belt that sticks and slips, held by a spring; Stribeck's friction 0.4 falling to 0.2"""
    law = laws.Stribeck(0.4, 0.2, 0.1)
    body, step = belt.wheel_body(), 1e-3
    oscillator = BeltOscillator(belt.MASS + body.mass, belt.STIFFNESS, belt.LOAD, belt.SPEED)
    theirs = oscillator.cycle(lambda v: float(law.coefficient_at(v)))
    history = run(belt.on_belt(body, law), 0.65, step=step, start="equilibrium", progress=False)
    amplitude, period = belt.cycle(history, step, 0.25)
    yield Row("amplitude", 1e3 * amplitude, 1e3 * theirs[0], 0.01, "mm")
    yield Row("period", 1e3 * period, 1e3 * theirs[1], 0.01, "ms")
