"""Verification: rolling bearings under load."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from demos import spindle
from references.closed_forms.angular_contact import AngularContact
from references.closed_forms.ball_bearing import BallBearing
from scenes.published_bearings import P7, P7_CAPACITY, UM, p7, p8, p9, p10
from studies.validate.case import Row, case
from warpffrf.output.result import Result
from warpffrf.output.simulate import equilibrium

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
