"""Bearings of rigid parts in lumped contact against the equations of bearings, and against published numbers."""

from __future__ import annotations

import numpy as np
import pytest

from scenes.lumped_bearings import MM, Bearing, ball_209, roller_209
from warpffrf.model import joints, laws
from warpffrf.model.lumped_contact import LumpedContact
from warpffrf.model.scene import Scene
from warpffrf.online import History, find_equilibrium

EXACT = 1e-7  # of the largest force: what the equilibrium's tolerance of 1e-9 and the closed forms leave
PROMISED = 5e-3
ROUNDED = 1e-2  # published with rounded constants


def outer_forces(history: History, bearing: Bearing) -> np.ndarray:
    return np.array([history.lumped_contacts[f"out {i}"].normal_force[-1] for i in range(bearing.count)])


@pytest.mark.parametrize(
    ("bearing", "forces", "deflection", "within"),
    [
        (ball_209(), (4527.0, 2841.0, 61.0), 60.5e-6, 2e-3),  # P8: the last force to 2e-3 of the largest
        (roller_209(), (1965.0, 1379.0, 0.0), None, 1e-3),  # P10, constants rounded
        (roller_209(), (1956.0, 1384.0, 0.0), None, ROUNDED),  # P10
        (roller_209(7), (1965.0, 1379.0, 0.0), None, 1e-3),
    ],
)
def test_the_load_is_shared_as_in_a_bearing(
    bearing: Bearing, forces: tuple[float, ...], deflection: float | None, within: float
) -> None:
    history = find_equilibrium(bearing.scene())
    assert history.status == "completed", history.message
    found, moved = outer_forces(history, bearing), history.bodies["ring"].position[-1, 2]
    shift, exact = bearing.solved()
    print(f"deflection {moved * 1e6:.5g} um, forces {found[:3]} N, exact {shift * 1e6:.5g} um, {exact[:3]} N")
    assert np.abs(found - exact).max() < EXACT * exact.max() < PROMISED * exact.max()
    assert abs(moved - shift) < EXACT * shift
    assert np.abs(found[:3] - forces).max() < within * found.max()
    assert deflection is None or abs(moved - deflection) < 2e-3 * deflection
    inside = sum(history.lumped_contacts[f"in {i}"].force[-1] for i in range(bearing.count))
    np.testing.assert_allclose(inside, (0.0, 0.0, bearing.load), atol=1e-9 * bearing.load)


def tilted_roller(tilt: float, approach: float, law: laws.LumpedLaw) -> tuple[Scene, LumpedContact]:
    """A roller held by a joint, its axis rotated by `tilt` [rad] about the direction of the load."""
    bearing = roller_209()
    element, inner, _ = bearing.surfaces
    scene = Scene()
    way = scene.ground.surface(inner, name="raceway")
    roller = scene.add_rigid_body(
        0.01, (1e-6,) * 3, name="roller", position=(0.0, 0.0, bearing.inner + bearing.radius - approach),
        rotation=(np.sin(0.5 * tilt), 0.0, 0.0, np.cos(0.5 * tilt)), surfaces={"tread": element},
    )  # fmt: skip
    scene.add(joints.Fixed(scene.ground.at(roller.position), roller.at((0, 0, 0)), name="hold"))
    return scene, scene.add(LumpedContact(roller["tread"], way, law=law, name="line"))


@pytest.mark.parametrize("tilt", [0.0, 1e-3])
def test_laminae_of_a_tilted_roller(tilt: float) -> None:
    """ISO/TS 16281: the force and the moment are sums over the laminae."""
    length, n, approach, diameter = 9.6 * MM, 40, 8e-6, 10.0 * MM
    scene, _ = tilted_roller(tilt, approach, laws.IsoLamina(length, n))
    found = find_equilibrium(scene).lumped_contacts["line"]
    x = length * ((np.arange(n) + 0.5) / n - 0.5)
    profile = 0.00035 * diameter / MM * np.log(1.0 / (1.0 - (2.0 * x / length) ** 2))  # mm
    depth = (approach - x * np.sin(tilt) - 0.5 * diameter * (1.0 - np.cos(tilt))) / MM - profile
    q = 35948.0 * (length / MM) ** (8.0 / 9.0) / n * (2.0 * np.maximum(depth, 0.0)) ** (10.0 / 9.0)
    np.testing.assert_allclose(found.lamina_force[-1], q, atol=2e-6 * q.max())  # the lever of the tilt's second order
    np.testing.assert_allclose(found.force[-1, 2], q.sum(), rtol=2e-6)
    arm = x * np.cos(tilt) + 0.5 * diameter * np.sin(tilt)  # the lowest place of a lamina
    np.testing.assert_allclose(found.torque[-1, 0], np.sum(arm * q), atol=1e-6 * q.sum() * length)


def test_iso_of_two_contacts_in_series() -> None:
    """Without profile and tilt: c_L delta^(10/9) of both approaches together."""
    scene, _ = tilted_roller(0.0, 5e-6, laws.IsoLamina(9.6 * MM, profile=False))
    found = find_equilibrium(scene).lumped_contacts["line"].normal_force[-1]
    assert abs(found / (35948.0 * 9.6 ** (8.0 / 9.0) * (2.0 * 5e-3) ** (10.0 / 9.0)) - 1.0) < 1e-9
