"""Moments of lumped contacts: their bounds against closed forms and sums over the patch, and what is refused."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from warpffrf.model import laws, surfaces
from warpffrf.model.bodies import Body
from warpffrf.model.errors import InputError
from warpffrf.model.lumped_contact import LumpedContact
from warpffrf.model.material import Material
from warpffrf.model.scene import Scene
from warpffrf.output.contact.hertz import hertz_point

STEEL = Material(210e9, 0.3, 7850.0)
MODULUS = 0.5 * STEEL.plane_strain_modulus
R, LENGTH = 0.01, 0.012
HERTZ = laws.HertzPoint(STEEL, STEEL)
CREEP = laws.RegularisedCoulomb(0.2, 1e-3)
LOADS = np.array([1.0, 1e3])  # N
EXACT = 1e-9


def ball_in(surface: Any, place: tuple[float, float, float], **contact: Any) -> LumpedContact:
    """A ball of the radius R at a place, against a surface of the ground."""
    scene = Scene()
    skin = surfaces.Sphere(radius=R, axis_point=(0, 0, 0), axis_direction=(0, 1, 0))
    ball: Body = scene.add_rigid_body(0.03, (1e-6,) * 3, name="ball", position=place, surfaces={"skin": skin})
    return scene.add(LumpedContact(ball["skin"], scene.ground.surface(surface, name="way"), **contact))


def on_plane(**contact: Any) -> LumpedContact:
    return ball_in(surfaces.Plane(origin=(0, 0, 0), outward=(0, 0, 1)), (0, 0, R), **{"law": HERTZ, **contact})


def in_groove(**contact: Any) -> tuple[LumpedContact, np.ndarray]:
    """And the relative curvatures across and along it [1/m]."""
    groove, bottom = 1.04 * R, 0.03
    way = surfaces.Groove(radius=bottom, groove_radius=groove, axis_point=(0, 0, 0), axis_direction=(0, 1, 0))
    contact_ = ball_in(way, (0, 0, bottom + R), **{"law": HERTZ, **contact})
    return contact_, np.array([1.0 / R - 1.0 / groove, 1.0 / R + 1.0 / bottom])


def bound(resistance: Any, F: np.ndarray) -> np.ndarray:
    return resistance.bound * F**resistance.bound_power


def slope(resistance: Any, F: np.ndarray) -> np.ndarray:
    return resistance.slope * F**resistance.slope_power


def test_a_lever_times_the_load() -> None:
    rolling, pivoting = on_plane(rolling_resistance=laws.RollingResistanceArm(2e-5, 0.1)).moments() or (None, None)
    np.testing.assert_allclose(bound(rolling, LOADS), 2e-5 * LOADS)
    np.testing.assert_allclose(slope(rolling, LOADS), 2e-4 * LOADS)
    np.testing.assert_array_equal(bound(pivoting, LOADS), 0.0)
    assert on_plane().moments() is None


def test_hysteresis_of_a_ball_and_of_a_roller() -> None:
    """Johnson: 3 F a/16 of a circle, 2 F b/(3 pi) of a line, times the loss."""
    rolling, _ = on_plane(rolling_resistance=laws.RollingHysteresis(0.02, 0.1)).moments() or (None, None)
    a = (0.75 * LOADS * R / MODULUS) ** (1.0 / 3.0)
    np.testing.assert_allclose(bound(rolling, LOADS), 0.02 * 3.0 / 16.0 * LOADS * a, rtol=EXACT)
    steel = 0.5 * 207e9 / (1.0 - 0.3**2)  # of laws that hold for steel alone
    for law, laminae in ((laws.PalmgrenLine(LENGTH, 4), 4), (laws.IsoLamina(LENGTH, 30), 30)):
        scene = Scene()
        tread = surfaces.Cylinder(radius=R, axis_point=(0, 0, 0), axis_direction=(0, 1, 0))
        roller = scene.add_rigid_body(
            0.03, (1e-6,) * 3, name="roller", position=(0, 0, 0.04), surfaces={"tread": tread}
        )
        way = surfaces.Cylinder(radius=0.03, axis_point=(0, 0, 0), axis_direction=(0, 1, 0))
        contact = LumpedContact(
            roller["tread"], scene.ground.surface(way, name="way"), law=law,
            rolling_resistance=laws.RollingHysteresis(0.02, 0.1),
        )  # fmt: skip
        rolling, _ = contact.moments() or (None, None)
        b = np.sqrt(4.0 * LOADS / (np.pi * steel * LENGTH * (1.0 / R + 1.0 / 0.03)))  # of the whole roller
        found = laminae * bound(rolling, LOADS / laminae)
        np.testing.assert_allclose(found, 0.02 * 2.0 / (3.0 * np.pi) * LOADS * b, rtol=1e-6)  # curvatures by a search


@pytest.mark.parametrize("load", LOADS)
def test_spin_on_an_ellipse(load: float) -> None:
    """mu p r summed over Hertz's ellipse, from an independent solution of it, and mu p r^2/v_slip."""
    contact, curvatures = in_groove(friction=CREEP, spin=True)
    _, pivoting = contact.moments() or (None, None)
    found = hertz_point(load, np.diag(curvatures), MODULUS)
    a, b = found.semi_axes
    nodes, weights = np.polynomial.legendre.leggauss(200)
    s, phi = 0.25 * np.pi * (nodes + 1.0), np.pi * (nodes + 1.0)  # x = a sin(s) cos(phi): smooth in both
    x, y = (h * np.outer(np.sin(s), e) for h, e in ((a, np.cos(phi)), (b, np.sin(phi))))
    force = 1.5 * load / np.pi * np.outer(np.cos(s) ** 2 * np.sin(s) * 0.25 * np.pi * weights, np.pi * weights)
    assert force.sum() == pytest.approx(load)
    assert bound(pivoting, np.array(load)) == pytest.approx(np.sum(0.2 * force * np.hypot(x, y)), rel=1e-6)
    assert slope(pivoting, np.array(load)) == pytest.approx(np.sum(0.2 * force * (x**2 + y**2)) / 1e-3, rel=1e-6)


def test_spin_on_a_circle() -> None:
    _, pivoting = on_plane(friction=laws.TractionCurve(0.1, 0.02, 0.05, 1.0), spin=True).moments() or (None, None)
    a = (0.75 * LOADS * R / MODULUS) ** (1.0 / 3.0)
    np.testing.assert_allclose(bound(pivoting, LOADS), 3.0 * np.pi / 16.0 * 0.1 * LOADS * a, rtol=EXACT)


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (
            {"rolling_resistance": 0.001},
            "must be one of laws.RollingResistanceArm, laws.RollingHysteresis, or None, got 0.001",
        ),
        ({"spin": 1}, "spin must be True or False, got 1"),
        ({"spin": True}, "spin=True requires friction that depends on the velocity"),
        ({"spin": True, "friction": 0.1}, "laws.RegularisedCoulomb or laws.TractionCurve"),
        (
            {"spin": True, "friction": laws.EyringTraction(0.005, 1e-3, 0.05)},
            "EyringTraction rises with the slip speed",
        ),
        ({"spin": True, "friction": CREEP, "law": laws.PowerForce(1e9)}, "that of laws.HertzPoint"),
        (
            {"rolling_resistance": laws.RollingHysteresis(0.1, 1.0), "law": laws.PowerForce(1e9)},
            "only laws.HertzPoint, laws.PalmgrenLine and laws.IsoLamina define; use one of these, or "
            "laws.RollingResistanceArm",
        ),
    ],
)
def test_moments_that_cannot_be_are_named(options: dict[str, Any], words: str) -> None:
    with pytest.raises(InputError, match=words):
        on_plane(**options)


@pytest.mark.parametrize(
    ("law", "words"),
    [
        (lambda: laws.RollingResistanceArm(-1e-6, 1.0), "lever"),
        (lambda: laws.RollingResistanceArm(1e-6, 0.0), "rolling_speed"),
        (lambda: laws.RollingHysteresis(1.5, 1.0), "loss must be at most 1"),
        (lambda: laws.RollingHysteresis(0.1, -1.0), "rolling_speed"),
    ],
)
def test_laws_that_make_no_sense_are_refused(law: Any, words: str) -> None:
    with pytest.raises(InputError, match=words):
        law()
