"""Whole bearings by their builders against published load distributions, and against the equations of bearings."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from scipy.optimize import brentq

from references.closed_forms.ball_bearing import BallBearing
from scenes.published_bearings import MM, P7, P10_CLEARANCE, P10_LENGTH, P10_LOAD, UM, p7, p8, p9, p10
from warpffrf.model import forces, laws
from warpffrf.model.bearings import BallGeometry, Bearing, RollerGeometry, RollingContact
from warpffrf.model.errors import InputError
from warpffrf.model.scene import Scene
from warpffrf.online import History, find_equilibrium

PUBLISHED = 5e-3  # P7: promised
LOADS = 1e-2  # P8 to P10, above 1 kN: promised
EXACT = 5e-4  # what bodies in space have beyond the same equations in a plane: squares of deflections over radii
CASES = {  # diametral clearance, radial, axial force; published deflections radial, axial [m] and tilt [rad]
    "radial": (0.0, 1e3, 0.0, 15.1101 * UM, None, None),
    "clearance": (10 * UM, 1e3, 0.0, 21.223 * UM, None, None),
    "axial": (0.0, 0.0, 1e3, None, 133.538 * UM, None),
    "both": (10 * UM, 1e3, 1e3, 19.592 * UM, 146.46 * UM, 2.687e-3),
}
GUESS = {"radial": (15e-6, 0, 0), "clearance": (15e-6, 0, 0), "axial": (0, 1e-4, 0), "both": (2e-5, 14e-5, -2.6e-3)}


def by_the_book(clearance: float) -> BallBearing:
    D = P7["ball_diameter"]
    return BallBearing(7, D, P7["pitch_diameter"], 0.52 * D, 0.53 * D, clearance, 210e9)


def loads(history: History, bearing: Bearing, side: str) -> np.ndarray:
    """(elements,) N."""
    return np.array([history.lumped_contacts[c.name].normal_force[-1] for c in bearing.contacts_of(side)])


def motion(history: History, bearing: Bearing) -> tuple[float, float, float]:
    """Of the inner ring along z and the axis y [m], tilt about x [rad]."""
    ring = history.bodies[bearing.inner.name]
    return float(ring.position[-1, 2]), float(ring.position[-1, 1]), float(2.0 * ring.rotation[-1, 0])


@pytest.mark.parametrize("case", CASES)
def test_the_equations_give_the_published_deflections(case: str) -> None:
    """ISO/TS 16281 with rigid rings, a ball under the load; the published tilt takes d_pw/2 as its lever."""
    clearance, radial, axial, *published = CASES[case]
    book = by_the_book(clearance)
    found, _ = book.solve(radial, axial, GUESS[case], tilts=case == "both", lever=0.5 * book.pitch)
    for value, wanted in zip(np.abs(found), published, strict=True):
        assert wanted is None or value == pytest.approx(wanted, rel=2e-4)


@pytest.mark.parametrize("case", ["radial", "clearance", "axial"])
def test_published_deflections(case: str) -> None:
    """P7 of the cases with published values."""
    scene, bearing = p7(*CASES[case][:3])
    history = find_equilibrium(scene)
    assert history.status == "completed", history.message
    clearance, radial, axial, *published = CASES[case]
    book = by_the_book(clearance)
    exact, Q = book.solve(radial, axial, GUESS[case], tilts=False, lever=book.lever)
    found = motion(history, bearing)
    print(f"{case}: deflections {found[0] / UM:.5g}, {found[1] / UM:.5g} um, published {published[:2]}")
    for i in range(2):
        if published[i] is not None:
            assert found[i] == pytest.approx(published[i], rel=PUBLISHED)
            assert found[i] == pytest.approx(exact[i], rel=EXACT)
    assert np.abs(loads(history, bearing, "outer") - Q).max() < 2.0 * EXACT * Q.max()


def test_published_deflections_with_tilt() -> None:
    """P7, radial and axial load, free tilt. The published equations are of first order in the tilt: bodies in space lie
    1.6 % (radial), 0.03 % (axial) and 1.0 % (tilt) from them, and on the exact kinematics of rigid rings."""
    scene, bearing = p7(*CASES["both"][:3])
    history = find_equilibrium(scene)
    assert history.status == "completed", history.message
    found = np.array(motion(history, bearing))
    exact, Q = by_the_book(10 * UM).exact(1e3, 1e3, GUESS["both"])
    print(f"found {found}, exact {exact}")
    np.testing.assert_allclose(found, np.abs(exact), rtol=EXACT)
    np.testing.assert_allclose(loads(history, bearing, "inner"), Q, rtol=2.0 * EXACT)
    np.testing.assert_allclose(found, CASES["both"][3:], rtol=2e-2)


def test_209_ball_bearing() -> None:
    """P8: 8.9 kN radial, 15 um of clearance."""
    scene, bearing = p8()
    history = find_equilibrium(scene)
    assert history.status == "completed", history.message
    found = loads(history, bearing, "outer")
    np.testing.assert_allclose(found[:2], (4527.0, 2841.0), rtol=LOADS)
    assert abs(found[2] - 61.0) < LOADS * found[0]  # 59.8 N by the same law without rounding
    assert motion(history, bearing)[0] == pytest.approx(60.5 * UM, rel=LOADS)


def test_218_angular_contact_bearing() -> None:
    """P9: 17.8 kN thrust turns 40 degrees into 41.5."""
    scene, bearing = p9()
    history = find_equilibrium(scene)
    assert history.status == "completed", history.message
    np.testing.assert_allclose(loads(history, bearing, "inner"), 1679.0, rtol=1e-3)
    F = history.lumped_contacts["218 inner 1"].force[-1]
    assert np.degrees(np.arctan2(F[1], np.hypot(F[0], F[2]))) == pytest.approx(41.5, abs=0.05)


def palmgren_loads(count: int, clearance: float, load: float, stiffness: float) -> np.ndarray:
    """Q = K delta^(10/9) of both contacts in series, delta = shift cos phi - clearance/2: (count,) N."""
    phi = 2.0 * np.pi * np.arange(count) / count

    def taken(shift: float) -> np.ndarray:
        return stiffness * np.maximum(shift * np.cos(phi) - 0.5 * clearance, 0.0) ** (10.0 / 9.0)

    shift: Any = brentq(lambda x: np.sum(taken(x) * np.cos(phi)) - load, 0.0, 1e-3, xtol=1e-16)
    return taken(shift)


def test_209_roller_bearing() -> None:
    """P10: Palmgren's law at each of the two contacts; rollers are free along and about their axes."""
    scene, bearing = p10()
    history = find_equilibrium(scene)
    assert history.status == "completed", history.message
    found = loads(history, bearing, "outer")
    np.testing.assert_allclose(found[:2], (1956.0, 1384.0), rtol=LOADS)
    both = (1e3 * (1e3 * P10_LENGTH) ** 0.8 / (2.0 * 3.84e-5)) ** (10.0 / 9.0)
    exact = palmgren_loads(14, P10_CLEARANCE, P10_LOAD, both)
    assert np.abs(found - exact).max() < EXACT * exact.max()
    assert np.count_nonzero(found) == 3


@pytest.mark.slow
def test_loads_that_nothing_carries_are_named() -> None:
    """Thrust on a bearing of straight rollers, and balls without a cage, which the load squeezes out of its zone."""
    scene = Scene()
    bearing = scene.add_bearing(
        "r", RollerGeometry(elements=8, roller_diameter=8 * MM, roller_length=8 * MM, pitch_diameter=40 * MM),
        outer=scene.ground, contact=RollingContact(law=laws.PalmgrenLine(8 * MM, 3)),
    )  # fmt: skip
    scene.add(forces.PointForce(bearing.inner.at((0, 0, 0)), (0.0, 100.0, 0.0), name="thrust"))
    with pytest.raises(InputError, match="100 N of thrust have no load path: nothing guides body 'r inner ring' along"):
        find_equilibrium(scene)
    scene = Scene()
    bearing = scene.add_bearing("b", BallGeometry(**P7), outer=scene.ground, cage=None)
    scene.add(forces.PointForce(bearing.inner.at((0, 0, 0)), (1e3, 0.0, 300.0), name="load"))
    history = find_equilibrium(scene)
    assert history.status == "no_equilibrium"
    assert "bearing 'b' has no cage, and loads push its elements out of the load zone; give it" in history.message
