"""Verification: rolling bearings under load."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import numpy as np

from demos import gearbox_shaft, raceway_defect, spindle
from gearbox_reference import compared
from references.closed_forms.angular_contact import AngularContact
from references.closed_forms.ball_bearing import BallBearing
from references.finite_elements import pressed_tubes
from scenes import fitted_rings
from scenes.bearing_kinds import (
    OF_TWO_ROWS,
    barrels,
    barrels_in_rows,
    solved,
    tapered_bearing,
    tapered_row,
    two_rows_of_balls,
)
from scenes.published_bearings import P7, P7_CAPACITY, UM, p7, p8, p9, p10
from studies.validate.case import Row, case
from warpffrf.model.bearings import BallGeometry, fit
from warpffrf.output.result import Result
from warpffrf.output.simulate import equilibrium, simulate

ROOM = "Rolling bearings"
PROGRAM = "ISO/TS 16281:2008 by a commercial program; P7 of the verification cases"
HARRIS = "T. A. Harris and M. N. Kotzalas, Rolling Bearing Analysis, 5th ed. (2007)"


def _rest(scene: Any) -> Result:
    result = equilibrium(scene, progress=False)
    if result.status != "completed":
        raise RuntimeError(result.message)
    return result


def _p7(clearance: float, radial: float, axial: float) -> tuple[Result, Any, np.ndarray]:
    """Its result, the bearing in it, and the ring's ways along the radial and axial load [µm] and tilt [mrad]."""
    scene, bearing = p7(clearance, radial, axial)
    result = _rest(scene)
    ring = result.history.bodies[bearing.inner.name]
    x = np.array([1e6 * ring.position[-1, 2], 1e6 * ring.position[-1, 1], 2e3 * ring.rotation[-1, 0]])
    return result, result.bearing("bearing"), x


def _by_clearance(radial: float, axial: float, published: tuple[tuple[float, float, float], ...]) -> Iterator[Row]:
    """Deflection along the load and life, `published` with the clearance in front."""
    for clearance, way, life in published:
        _, bearing, x = _p7(clearance * UM, radial, axial)
        named = f"clearance {clearance:g} µm"
        yield Row(f"deflection, {named}", x[int(axial > 0.0)], way, 5e-3, "µm")
        revolutions = bearing.reference_life(P7_CAPACITY).revolutions
        yield Row(f"reference life, {named}", revolutions, life, 5e-3, "10⁶ rev")


@case(ROOM, PROGRAM)
def ball_bearing_radial() -> Iterator[Row]:
    """P7: seven balls of 11.5 mm, 1 kN radial, without and with 10 µm of clearance"""
    yield from _by_clearance(1e3, 0.0, ((0.0, 15.1101, 13163.0), (10.0, 21.223, 10795.8)))


@case(ROOM, PROGRAM)
def ball_bearing_axial() -> Iterator[Row]:
    """P7, G3: seven balls of 11.5 mm, 1 kN axial, without and with 10 µm of clearance"""
    yield from _by_clearance(0.0, 1e3, ((0.0, 133.538, 2222.7), (10.0, 149.172, 3115.88)))


@case(ROOM, PROGRAM)
def ball_bearing_both() -> Iterator[Row]:
    """P7: seven balls of 11.5 mm, 1 kN radial and axial, 10 µm of clearance, free tilt; the published equations are of
    first order in the tilt, the bodies move in space"""
    *_, x = _p7(10 * UM, 1e3, 1e3)
    for name, ours, theirs, unit in zip(
        ("radial", "axial", "tilt"), x, (19.592, 146.46, 2.687), ("µm", "µm", "mrad"), strict=True
    ):
        yield Row(name, ours, theirs, 0.02, unit)
    D = P7["ball_diameter"]
    book = BallBearing(7, D, P7["pitch_diameter"], 0.52 * D, 0.53 * D, 10 * UM, 210e9)
    exact, _ = book.exact(1e3, 1e3, (2e-5, 14e-5, -2.6e-3))
    for name, ours, theirs, unit in zip(
        ("radial", "axial", "tilt"), x, np.abs(exact) * (1e6, 1e6, 1e3), ("µm", "µm", "mrad"), strict=True
    ):
        yield Row(f"{name}, same equations with exact kinematics", ours, theirs, 5e-4, unit)


@case(ROOM, f"{HARRIS}, examples of the 209 ball bearing")
def ball_bearing_209() -> Iterator[Row]:
    """P8: nine balls of 12.7 mm, 8.9 kN radial, 15 µm of clearance"""
    scene, bearing = p8()
    result = _rest(scene)
    found = result.bearing("209")
    Q = [result.history.lumped_contacts[c.name].normal_force[-1] for c in bearing.contacts_of("outer")]
    yield Row("ball at 0°", Q[0], 4527.0, 0.01, "N")
    yield Row("ball at 40°", Q[1], 2841.0, 0.01, "N")
    yield Row("ball at 80°, over the largest load", Q[2], 61.0, 0.01, "N", Q[0])
    yield Row("deflection", 1e6 * result.history.bodies[bearing.inner.name].position[-1, 2], 60.5, 0.01, "µm")
    for side, a, b, peak in (("inner", 2.568, 0.274, 3072.0), ("outer", 2.490, 0.338, 2567.0)):
        patches = getattr(found, f"{side}_patches")
        yield Row(f"{side} half-axis across", 1e3 * patches.half_axis_across[-1, 0], a, 3e-3, "mm")
        yield Row(f"{side} half-axis around", 1e3 * patches.half_axis_around[-1, 0], b, 3e-3, "mm")
        yield Row(f"{side} peak pressure", 1e-6 * patches.peak_pressure[-1, 0], peak, 0.01, "MPa")


@case(ROOM, f"{HARRIS}, examples of the 218 angular-contact ball bearing")
def angular_contact_218() -> Iterator[Row]:
    """P9: 16 balls of 22.23 mm at 40°, 17.8 kN of thrust"""
    scene, bearing = p9()
    history = _rest(scene).history
    Q = [history.lumped_contacts[c.name].normal_force[-1] for c in bearing.contacts_of("inner")]
    F = history.lumped_contacts["218 inner 1"].force[-1]
    yield Row("load of a ball", float(np.mean(Q)), 1679.0, 1e-3, "N")
    yield Row("contact angle", float(np.degrees(np.arctan2(F[1], np.hypot(F[0], F[2])))), 41.5, 0.05, "°", 1.0)


@case(ROOM, f"{HARRIS}, examples of the 209 cylindrical roller bearing; deformation: A. Palmgren (1959)")
def roller_bearing_209() -> Iterator[Row]:
    """P10: 14 rollers of 10 x 9.6 mm, 4.45 kN radial, 40.6 µm of clearance; published with rounded constants"""
    scene, bearing = p10()
    history = _rest(scene).history
    Q = [history.lumped_contacts[c.name].normal_force[-1] for c in bearing.contacts_of("outer")]
    for number, theirs in enumerate((1956.0, 1384.0, 0.0)):
        yield Row(f"roller {number}", Q[number], theirs, 0.01, "N", None if theirs else 1956.0)


@case(ROOM, "H. Sjoevall (1933), rings that move in parallel")
def kinds_of_bearings() -> Iterator[Row]:
    """Two rows of balls, tapered, spherical and toroidal rollers against sums over their elements in closed form"""
    balls = BallGeometry(**OF_TWO_ROWS, contact_angle=np.radians(30.0), row_spacing=0.015)
    spherical, toroidal = barrels(10.0), barrels(0.0)
    for name, found, exact in (
        ("two rows of balls", solved(balls, (2e3, 1.5e3))[1], two_rows_of_balls(balls, 2e3, 1.5e3)),
        ("tapered", tapered_bearing((6e3, 4e3), 20)[1], tapered_row(20).solve(6e3, 4e3, (1e-5, 2e-5))[1]),
        ("spherical", solved(spherical, (1e4, 1.5e3))[1], barrels_in_rows(spherical).solve(1e4, 1.5e3, (5e-5, 0.0))[1]),
        ("toroidal", solved(toroidal, (1e4, 0.0))[1], barrels_in_rows(toroidal).solve(1e4, 0.0, (5e-5, 0.0))[1]),
    ):
        ours, theirs = found.outer_load[-1], exact.ravel()
        worst, most = int(np.argmax(np.abs(ours - theirs))), float(theirs.max())
        yield Row(f"{name}, largest load", float(ours.max()), most, 0.01, "N")
        yield Row(f"{name}, load that differs most", float(ours[worst]), float(theirs[worst]), 0.01, "N", most)


@case(
    ROOM, "rolling without slip, closed form; multiples per revolution: bearing data centre, Case Western Reserve Univ."
)
def defect_frequencies() -> Iterator[Row]:
    """Spall of a raceway, bearing 6205 at 1,797 rpm, balls driven by friction: lines of the envelope spectrum"""
    shaft, size = raceway_defect.SPEED / (2.0 * np.pi), raceway_defect.QUICK
    for side, (line, multiple) in {"outer": ("BPFO", 3.5848), "inner": ("BPFI", 5.4152)}.items():
        scene = raceway_defect.build(side)
        result = simulate(scene, size.duration, step=size.step, start="equilibrium", progress=False)
        if result.status != "completed":
            raise RuntimeError(result.message)
        found = raceway_defect.envelope(result)
        wanted = {line: multiple, f"2 {line}": 2.0 * multiple}
        if side == "inner":
            wanted |= {f"{line} less the shaft": multiple - 1.0, f"{line} plus the shaft": multiple + 1.0, "shaft": 1.0}
        for name, orders in wanted.items():
            place, _ = raceway_defect.line(found, orders * shaft)
            yield Row(f"{side} raceway: {name}", place, orders * shaft, 5e-3, "Hz")


@case(ROOM, "G. Lamé's thick rings in plane stress, bearings.fit")
def ring_on_shaft() -> Iterator[Row]:
    """A ring pressed on a hollow shaft by small-sliding contact, 20 µm of interference, 24 cells around"""
    ring, radius = fitted_rings.RING, fitted_rings.RING.bottom("inner")
    for shaft, named in ((fitted_rings.STEEL, "steel"), (fitted_rings.LIGHT, "aluminium")):
        result = fitted_rings.ring_on_shaft(2e-5, shaft)
        book = fit(
            ring,
            "inner",
            interference=2e-5,
            free_diameter=fitted_rings.SHAFT_BORE,
            material=(fitted_rings.STEEL, shaft),
        )
        pressure = float(result.contact(fitted_rings.SEAT).pressure[-1].mean())
        yield Row(f"pressure, shaft of {named}", 1e-6 * pressure, 1e-6 * book.pressure, 0.01, "MPa")
        change = 1e6 * float(np.mean(fitted_rings.raceway_change(result, radius)))
        yield Row(f"raceway, shaft of {named}", change, 1e6 * book.raceway_change, 0.01, "µm")


@case(ROOM, "Finite elements along the radius")
def fits_at_speed_and_warm() -> Iterator[Row]:
    """bearings.fit: a ring on a shaft of aluminium and in a housing of it, 60 µm of interference, 1500 rad/s, the ring
    40 K and the seat 25 K warmer"""
    for side, free in (("inner", 0.02), ("outer", 0.13)):
        seat, raceway = 0.05 if side == "inner" else 0.09, 2.0 * fitted_rings.RING.bottom(side)
        found = fit(
            replace(fitted_rings.RING, outside_diameter=0.09), side, interference=6e-5, free_diameter=free,
            material=(fitted_rings.STEEL, fitted_rings.LIGHT), speed=1500.0, temperature_rise=(40.0, 25.0),
            expansion=(12e-6, 23e-6),
        )  # fmt: skip
        ring = pressed_tubes.tube(seat, raceway, fitted_rings.STEEL, 12e-6 * 40.0, 1500.0)
        mate = pressed_tubes.tube(seat, free, fitted_rings.LIGHT, 23e-6 * 25.0, 1500.0)
        pressure, *u = pressed_tubes.pressed(*((mate, ring) if side == "inner" else (ring, mate)), 6e-5)
        yield Row(f"pressure, {side} ring", 1e-6 * found.pressure, 1e-6 * pressure, 1e-3, "MPa")
        change = 2e6 * float(u[1][-1] if side == "inner" else u[0][0])
        yield Row(f"raceway, {side} ring", 1e6 * found.raceway_change, change, 1e-3, "µm")


@case(
    ROOM,
    "Limit of frictional shakedown: A. Klarbring, M. Ciavarella, J. R. Barber (2007); N. Antoni, Q. S. Nguyen (2008)",
)
def ring_creep() -> Iterator[Row]:
    """An outer ring with 10 µm of interference in its housing under a load that rotates, creep per revolution"""
    limit = fitted_rings.limits().shakedown
    rates = {
        share: 1e9 * float(fitted_rings.creep(fitted_rings.rotating_load(share * limit, fitted_rings.ROUGH, 4))[-1])
        for share in (0.95, 1.05, 1.1)
    }
    begins = 1.05 - 0.05 * rates[1.05] / (rates[1.1] - rates[1.05])
    yield Row(
        "load from which on the ring creeps, from the rates at 1.05 and 1.1 of the limit",
        begins * limit,
        limit,
        0.01,
        "N",
    )
    yield Row("at 0.95 of the limit, over the rate at 1.05", rates[0.95], 0.0, 1e-6, "nm", abs(rates[1.05]))


@case(ROOM, "full finite elements of shaft and housing by scikit-fem, rigid rings by ISO/TS 16281")
def shaft_in_housing() -> Iterator[Row]:
    """A shaft on a 6208 and an NU 208 in a flexible housing under the forces of a helical gear"""
    size = gearbox_shaft.QUICK
    for name, ours, theirs, scale, unit in compared(_rest(gearbox_shaft.build(size, progress=False)), size):
        yield Row(name, ours, theirs, 5e-3, unit, scale)


@case(ROOM, "balance of a ball in NumPy: A. B. Jones, J. Basic Eng. 82 (1960) 309")
def spindle_preload() -> Iterator[Row]:
    """Angular contact bearings back to back, twelve balls of 8 mm at 15°, at speed: raceways offset by 10 µm, and a
    spring of 120 N; centrifugal force, gyroscopic moment, outer raceway control"""
    book = AngularContact(
        spindle.COUNT, spindle.BALL, spindle.PITCH, spindle.ANGLE, spindle.GROOVE, spindle.GROOVE, gyroscopic=True
    )
    speeds = (10e3, 20e3)
    for mounting, held in (("offset", {"press": spindle.OFFSET}), ("spring", {"force": spindle.SPRING})):
        found, _ = spindle.sweep(mounting, spindle.Size(speeds=speeds))
        for rpm, row in zip(speeds, found, strict=True):
            state = book.state(rpm * spindle.RPM, **held)
            named = f"{mounting}, {rpm:,.0f} rpm"
            yield Row(f"preload, {named}", row[0], state.force, 1e-2, "N")
            yield Row(f"load on the inner ring, {named}", row[1], state.loads[0], 1e-2, "N")
            for side, ours, theirs in zip(("inner", "outer"), row[3:], state.angles, strict=True):
                yield Row(f"{side} contact angle, {named}", float(np.degrees(ours)), np.degrees(theirs), 1e-2, "°")
