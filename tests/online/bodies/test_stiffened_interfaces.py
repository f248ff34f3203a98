"""Sensors and joint coordinates see the motion of second order of interfaces whose body loads stiffen."""

from __future__ import annotations

import numpy as np
import pytest

from warpffrf import sensors
from warpffrf.model import forces, joints
from warpffrf.model.material import Material
from warpffrf.model.mesh import box
from warpffrf.model.scene import Scene
from warpffrf.offline import ReductionOptions, reduce
from warpffrf.online.run import run

LENGTH, STEP = 1.0, 1e-4  # m, s
CLOSED = 1e-10  # m: to which the joints are


@pytest.fixture(scope="module")
def history():
    """A cantilever that a load at its tip bends far: its tip moves by a third of the length in 50 ms."""
    beam = reduce(
        box((0.02, LENGTH, 0.01), (1, 20, 1), order=2), Material(210e9, 0.0, 7850.0),
        interfaces={"y_min": "rigid", "y_max": "rigid"}, modes=12, options=ReductionOptions(stiffening=True),
        progress=False,
    )  # fmt: skip
    scene = Scene(gravity=(0.0, 0.0, 0.0))
    bar = scene.add_body(beam, name="bar", position=(0.0, 0.5 * LENGTH, 0.0), stiffening=True, inertia="full")
    scene.add(joints.Fixed(scene.ground, bar["y_min"], name="root"))
    hub = scene.add_rigid_body(0.1, (1e-5, 1e-5, 1e-5), name="hub", position=(0.0, LENGTH, 0.0))
    scene.add(joints.Revolute(bar["y_max"], hub.at((0.0, 0.0, 0.0)), axis=(1.0, 0.0, 0.0), name="pin"))
    scene.add(forces.PointForce(bar["y_max"], (0.0, 0.0, -700.0), name="load"))
    for name, port in (("root", bar["y_min"]), ("tip", bar["y_max"]), ("hub", hub.at((0.0, 0.0, 0.0)))):
        scene.add(sensors.Position(port, name=f"x {name}"))
        scene.add(sensors.Velocity(port, name=f"v {name}"))
        scene.add(sensors.Acceleration(port, name=f"a {name}"))
    found = run(scene, 0.05, step=STEP, progress=False)
    assert found.status == "completed", found.message
    return found


def test_a_fixed_root_stays(history) -> None:
    x = history.sensors["x root"].values
    assert np.abs(history.sensors["x tip"].values[:, 2]).max() > 0.3 * LENGTH
    assert np.abs(x - x[0]).max() < CLOSED


def test_both_sides_of_a_joint_move_together(history) -> None:
    """Places to round-off; rates and accelerations as far as joints at the level of positions hold them."""
    for kind, within in (("x", CLOSED), ("v", 1e-4), ("a", 5e-3)):
        tip, hub = (history.sensors[f"{kind} {name}"].values for name in ("tip", "hub"))
        assert np.abs(tip - hub)[5:].max() < within * np.abs(hub).max(), kind


def test_rates_are_those_of_the_places(history) -> None:
    """Central differences of the saved rows, once the axial waves that the sudden load sets off are resolved."""
    x, v, a = (history.sensors[f"{kind} tip"].values for kind in "xva")
    for place, rate, within in ((x, v, 2e-3), (v, a, 5e-2)):
        found = (place[2:] - place[:-2]) / (2.0 * STEP)
        assert np.abs(found - rate[1:-1])[50:].max() < within * np.abs(rate).max()
