"""Rolling bearings of all kinds whose inner ring is guided in parallel, and their loads in closed form."""

from __future__ import annotations

from typing import Any

import numpy as np
from scipy.optimize import root

import warpffrf as wf
from references.closed_forms.ball_bearing import BallBearing
from references.closed_forms.rolling_bearings import Rows, iso_profiles, lamina_force
from warpffrf.model import laws
from warpffrf.model.bearings import BallGeometry, Bearing, Flanges, RollerGeometry
from warpffrf.output.bearings.bearing_result import BearingResult

MM, UM = 1e-3, 1e-6


def solved(geometry: Any, force: tuple[float, float], **others: Any) -> tuple[Bearing, BearingResult]:
    """Equilibrium under (radial, axial) [N], the inner ring is guided in parallel, along z and the axis y."""
    scene = wf.Scene()
    bearing = scene.add_bearing("b", geometry, first=(0, 0, 1), outer=scene.ground, **others)
    slide = scene.add_rigid_body(1.0, np.eye(3), name="slide")
    scene.add(wf.joints.Prismatic(scene.ground.at((0, 0, 0)), slide.at((0, 0, 0)), axis=(0, 0, 1)))
    scene.add(wf.joints.Prismatic(slide.at((0, 0, 0)), bearing.inner.at((0, 0, 0)), axis=(0, 1, 0)))
    scene.add(wf.forces.PointForce(bearing.inner.at((0, 0, 0)), (0.0, force[1], force[0])))
    result = wf.equilibrium(scene)
    assert result.status == "completed", result.message
    return bearing, result.bearing("b")


class InSphere(BallBearing):
    """A ball in an outer sphere: a round patch."""

    def one_contact(self, groove: float, sign: float) -> float:
        if sign > 0.0:
            return super().one_contact(groove, sign)
        modulus = 0.5 * self.youngs_modulus / (1.0 - self.poisson_ratio**2)
        return 4.0 / 3.0 * modulus * (2.0 / self.diameter - 1.0 / groove) ** -0.5


def book_of(geometry: BallGeometry) -> BallBearing:
    kind = InSphere if geometry.self_aligning else BallBearing
    return kind(
        geometry.elements, geometry.diameter, geometry.pitch_diameter, geometry.groove("inner"),
        geometry.groove("outer"), 0.0, 210e9,
    )  # fmt: skip


def thrust_balls(count: int = 12) -> BallGeometry:
    return BallGeometry(
        elements=count, ball_diameter=10 * MM, pitch_diameter=60 * MM, osculation=0.535, contact_angle=0.5 * np.pi
    )


def two_rows_of_balls(geometry: BallGeometry, F_r: float, F_a: float) -> np.ndarray:
    """Q (2 Z,) [N] by the equations of ISO/TS 16281 of two rows with opposite contact angles."""
    book, phi, alpha = book_of(geometry), geometry.angles, geometry.contact_angle

    def taken(x: np.ndarray) -> list[tuple[np.ndarray, np.ndarray]]:
        X = book.reach * np.cos(alpha) + UM * x[0] * np.cos(phi)
        return [book.balls(X, book.reach * np.sin(s * alpha) + UM * x[1] + 0.0 * phi) for s in (1.0, -1.0)]

    def lacking(x: np.ndarray) -> list[float]:
        rows = taken(x)
        radial = sum(np.sum(Q * np.cos(angle) * np.cos(phi)) for Q, angle in rows)
        return [float(radial - F_r), float(sum(np.sum(Q * np.sin(angle)) for Q, angle in rows) - F_a)]

    return np.concatenate([Q for Q, _ in taken(root(lacking, (10.0, 3.0), tol=1e-12).x)])


OF_TWO_ROWS: dict[str, Any] = {"elements": 12, "ball_diameter": 10 * MM, "pitch_diameter": 50 * MM, "rows": 2}
D, PITCH, LENGTH, ALPHA, COUNT = 8 * MM, 55 * MM, 12 * MM, np.radians(14.0), 16
RIB = 0.4 * MM


def tapered_bearing(force: tuple[float, float], count: int = COUNT) -> tuple[RollerGeometry, BearingResult]:
    geometry = RollerGeometry(
        elements=count, roller_diameter=D, roller_length=LENGTH, pitch_diameter=PITCH, contact_angle=ALPHA
    )
    apex = 0.5 * PITCH / np.sin(geometry.inclination)  # from the rollers' middle to the point where all axes meet
    ribs = Flanges(0.0, outer=None, inner="back", end_radius=0.9 * apex, height=RIB, law=laws.PowerForce(1e9, 1.5))
    return geometry, solved(geometry, force, flanges=ribs)[1]


def tapered_row(count: int) -> Rows:
    """Rollers of `tapered_bearing` between raceways in parallel."""
    return Rows(count, (ALPHA,), 0.0, lamina_force(LENGTH, iso_profiles(LENGTH, D)))


def barrels(alpha: float) -> RollerGeometry:
    """Toroidal rollers, one row between arcs, at the contact angle 0; spherical, two rows in a sphere [degrees]."""
    a, d, pitch = np.radians(alpha), 12 * MM, 100 * MM
    r = 0.5 * (d + pitch / np.cos(a)) if alpha else 0.3
    rows: dict[str, Any] = {"rows": 2, "row_spacing": pitch * np.tan(a)} if alpha else {}
    return RollerGeometry(
        elements=20, roller_diameter=d, roller_length=14 * MM, pitch_diameter=pitch, contact_angle=-a, raceway_radii=r,
        profile=0.97 * r, clearance=40 * UM, **rows,
    )  # fmt: skip


def barrels_in_rows(geometry: Any) -> Rows:
    """The same in closed form."""
    length, a = geometry.roller_length, geometry.contact_angle
    x = length * ((np.arange(30) + 0.5) / 30 - 0.5)
    drop = x**2 * (1.0 / geometry.profile - 1.0 / geometry.raceway_radii[0])  # of both contacts
    angles = (a, -a) if geometry.rows == 2 else (0.0,)
    return Rows(geometry.elements, angles, 0.5 * geometry.clearance * np.cos(a), lamina_force(length, drop))
