"""Sensors against closed forms and against each other; what they add to results and files."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from scenes.rollers import STEEL
from warpffrf.model import forces, joints, sensors, signals
from warpffrf.model import rotation as rot
from warpffrf.model.errors import InputError
from warpffrf.model.mesh import roller
from warpffrf.model.reduced.body import ReducedBody
from warpffrf.model.scene import Scene
from warpffrf.model.surfaces import Cylinder
from warpffrf.offline import reduce
from warpffrf.output.result import Result
from warpffrf.output.simulate import simulate
from warpffrf.scene_file.forms import item_kinds

MASS, INERTIA = 2.0, (0.1, 0.2, 0.25)
SPEED, ARM = 12.0, np.array([0.3, 0.1, 0.0])


def spinning_arm() -> Scene:
    """A body driven about z at a ramped speed, with a point on it and its reaction watched."""
    scene = Scene()
    body = scene.add_rigid_body(MASS, INERTIA, name="arm", center_of_mass=(0.1, 0.0, 0.0))
    axle = scene.add(joints.Revolute(scene.ground, body.at((0, 0, 0)), axis=(0, 0, 1), name="axle"))
    scene.add(joints.Drive(axle, signals.Ramp(SPEED, 2.0 * SPEED, duration=0.2)))
    tip = body.at(ARM)
    for item in (
        sensors.Position(tip, name="x"),
        sensors.Velocity(tip, name="v"),
        sensors.Acceleration(tip, name="a"),
        sensors.Acceleration(tip, frame="body", name="a_body"),
        sensors.JointReaction(axle, name="reaction"),
        sensors.InterfaceForce(body.at((0, 0, 0)), name="hub"),
        sensors.InterfaceForce(scene.ground.at((0, 0, 0)), name="base"),
    ):
        scene.add(item)
    return scene


def test_motion_and_reaction_of_a_driven_arm() -> None:
    result = simulate(spinning_arm(), 0.2, step=5e-4, progress=False)
    assert result.status == "completed", result.message
    t = result.time
    rate = SPEED / 0.2
    omega, angle = SPEED + rate * t, SPEED * t + 0.5 * rate * t**2
    c, s = np.cos(angle), np.sin(angle)
    turn = np.array([[c, -s, 0 * t], [s, c, 0 * t], [0 * t, 0 * t, 1 + 0 * t]]).transpose(2, 0, 1)
    x = turn @ ARM
    z = np.array([0.0, 0.0, 1.0])
    v = omega[:, None] * np.cross(z, x)
    a = rate * np.cross(z, x) - omega[:, None] ** 2 * x
    settled = slice(60, None)  # multipliers and accelerations swing about their values at first (index 3)
    assert result.sensor("x").values == pytest.approx(x, abs=1e-8)
    assert result.sensor("v").values[settled] == pytest.approx(v[settled], abs=1e-4 * SPEED)
    size = np.abs(a).max()
    assert result.sensor("a").values[settled] == pytest.approx(a[settled], abs=2e-3 * size)
    in_body = np.einsum("tji,tj->ti", turn, a)
    assert result.sensor("a_body").values[settled] == pytest.approx(in_body[settled], abs=2e-3 * size)
    reaction, hub, base = (result.sensor(name).values for name in ("reaction", "hub", "base"))
    joint = result.joint("axle")
    assert np.array_equal(reaction, np.hstack([joint.force, joint.torque]))
    assert hub == pytest.approx(reaction) and base == pytest.approx(-reaction)
    assert result.sensor("hub").components == sensors.WRENCH and result.sensor("x").unit == "m"


def springs_at_one_port(body: ReducedBody) -> Scene:
    """A flexible roller: bushing, spring, force and torque on its bore, all at once."""
    scene = Scene(gravity=(0.0, 0.0, -9.81))
    roller = scene.add_body(body, name="roller", damping=0.05)
    hold = np.diag([1e6, 1e6, 1e6, 1e3, 1e3, 1e3])
    scene.add(forces.Bushing(scene.ground, roller["bore"], hold, 1e-3 * hold, name="bush"))
    scene.add(forces.SpringDamper(scene.ground.at((0, 0, 1)), roller["bore"], 1e4, name="spring"))
    signal = signals.SmoothStep(0.0, 500.0, duration=2e-3)
    scene.add(forces.PointForce(roller["bore"], (signal, (1, 0, 1)), name="push"))
    scene.add(forces.PointTorque(roller["bore"], (0.0, signal.scaled(1e-3), 0.0), frame="body", name="twist"))
    scene.add(sensors.InterfaceForce(roller["bore"], name="bore"))
    for sensor in (sensors.Position, sensors.Velocity, sensors.Acceleration):
        scene.add(sensor(roller["bore"], name=sensor.kind))
    return scene


def test_interface_force_is_the_sum_and_equals_the_rate_of_momentum(plain_body: ReducedBody) -> None:
    scene = springs_at_one_port(plain_body)
    result = simulate(scene, 4e-3, step=1e-5, progress=False)
    assert result.status == "completed", result.message
    total = result.sensor("bore").values
    parts = sum(result.force(name).force for name in ("bush", "spring", "push", "twist"))
    assert total[:, :3] == pytest.approx(parts)
    body = result.body("roller")
    arm = np.array([rot.matrix(q) @ plain_body.center_of_mass for q in body.rotation])
    acceleration = body.acceleration + np.cross(body.angular_acceleration, arm)
    acceleration += np.cross(body.angular_velocity, np.cross(body.angular_velocity, arm))
    weight = np.array([0.0, 0.0, -9.81 * plain_body.mass])
    assert total[1:, :3] + weight == pytest.approx(plain_body.mass * acceleration[1:], abs=1e-5 * np.abs(total).max())


def test_motion_of_an_interface_is_consistent(plain_body: ReducedBody) -> None:
    """Position, velocity and acceleration of the flexible bore against central differences of each other."""
    result = simulate(springs_at_one_port(plain_body), 1e-3, step=2e-6, progress=False)
    x, v, a = (result.sensor(name).values for name in ("position", "velocity", "acceleration"))
    h = result.time[1] - result.time[0]
    for low, high, tolerance in ((x, v, 2e-3), (v, a, 2e-2)):
        rate = (low[2:] - low[:-2]) / (2.0 * h)
        assert np.abs(rate - high[1:-1])[5:].max() < tolerance * np.abs(high).max()
    modal = np.abs(result.body("roller").modal_velocity).max()
    assert modal > 0.0


def test_sensors_and_forces_come_back_from_a_file_and_change_no_hash(tmp_path: Path) -> None:
    scene = spinning_arm()
    bare = spinning_arm()
    bare.sensors.clear()
    assert scene.content_hash() == bare.content_hash()
    body = scene.body("arm")
    scene.add(forces.PointForce(body.at((0.1, 0, 0)), (0.0, 0.0, 3.0), name="push"))
    result = simulate(scene, 0.02, step=1e-3, progress=False)
    loaded = Result.load(result.save(tmp_path / "run.h5"))
    assert loaded.sensor_names == result.sensor_names != sorted(result.sensor_names)
    for name in result.sensor_names:
        before, after = result.sensor(name), loaded.sensor(name)
        assert np.array_equal(before.values, after.values)
        assert (before.kind, before.unit, before.frame, before.components) == (
            after.kind, after.unit, after.frame, after.components,
        )  # fmt: skip
    assert np.array_equal(loaded.force("push").force, result.force("push").force)
    assert np.array_equal(loaded.body("arm").acceleration, result.body("arm").acceleration)
    with pytest.raises(InputError, match="no sensor called 'y'"):
        loaded.sensor("y")
    data = result.to_xarray()
    assert data["sensor_x"].dims == ("time", "component_x")


def test_stress_sensor_reads_one_point_of_the_recovery(tmp_path: Path) -> None:
    """Its row is that of `result.stress` at the point, and a file brings it back."""
    mesh = roller(0.05, 0.015, 0.02, sectors=12, layers=2, axial=2)
    points = np.array([[0.03, 0.0, 0.0], [0.0, 0.005, 0.04]])
    body = reduce(
        mesh, STEEL, interfaces={"bore": "rigid"}, contact={"rim": Cylinder()}, max_frequency=15e3,
        stress={"inside": points}, cache=False, progress=False,
    )  # fmt: skip
    scene = Scene()
    part = scene.add_body(body, name="part")
    scene.add(forces.PointForce(part["bore"], (2e4, 0.0, 0.0)))
    scene.add(sensors.Stress(part, "inside", 1, name="hot spot"))
    with pytest.raises(InputError, match="out of range, 'inside' has 2 points"):
        sensors.Stress(part, "inside", 2)
    result = simulate(scene, 1e-4, step=1e-5, progress=False)
    values = result.sensor("hot spot").values
    stress = result.stress("part", "inside")
    assert np.abs(values).max() > 1e3
    assert np.array_equal(values[:, :6], stress.tensor[:, 1]) and np.array_equal(values[:, 6], stress.von_mises[:, 1])
    loaded = Result.load(result.save(tmp_path / "run.h5"))
    assert np.array_equal(loaded.sensor("hot spot").values, values)


def test_every_kind_of_sensor_has_a_name_and_a_row_of_components() -> None:
    scene = spinning_arm()
    kinds = {s.kind for s in scene.sensors} | {"stress"}
    assert kinds == set(item_kinds()["sensors"])
    result = simulate(scene, 2e-3, step=1e-3, progress=False)
    for name in result.sensor_names:
        sensor = result.sensor(name)
        assert sensor.values.shape == (len(result.time), len(sensor.components))


class Unevaluated(sensors.Sensor):
    """One whose values have the wrong shape."""

    kind = "unevaluated"

    def __init__(self, body: Any) -> None:
        self.body = body

    @property
    def ports(self) -> tuple[Any, ...]:
        return (self.body.at((0, 0, 0)),)

    def evaluate(self, run: Any) -> np.ndarray:
        return run.time


def test_a_sensor_that_fails_leaves_the_run() -> None:
    scene = spinning_arm()
    scene.add(Unevaluated(scene.body("arm")))
    result = simulate(scene, 2e-3, step=1e-3, progress=False)
    assert result.status == "completed" and np.all(np.isnan(result.sensor("unevaluated_1").values))
    assert "sensor 'unevaluated_1' has no values (NaN)" in result.report()
    assert "must be (3, 3), saved steps by components" in result.report()


def refused() -> dict[str, tuple[Any, str]]:
    scene = Scene()
    body = scene.add_rigid_body(1.0, (1.0, 1.0, 1.0), name="body")
    other = joints.Fixed(scene.ground, body.at((0, 0, 0)), name="elsewhere")
    return {
        "ground": (lambda: sensors.Position(scene.ground.at((0, 0, 0))), "the ground does not move"),
        "frame": (lambda: sensors.Velocity(body.at((0, 0, 0)), frame="user"), "frame must be one of"),  # pyright: ignore[reportArgumentType]
        "no joint": (lambda: sensors.JointReaction(body), "a joint is needed"),  # pyright: ignore[reportArgumentType]
        "foreign joint": (lambda: scene.add(sensors.JointReaction(other)), "add its joint 'elsewhere'"),
        "rigid": (lambda: sensors.Stress(body, "root"), "a flexible body is needed"),
        "bare ground": (lambda: sensors.InterfaceForce(scene.ground), "a point is needed"),
    }


@pytest.mark.parametrize("case", sorted(refused()))
def test_wrong_sensors_are_refused(case: str) -> None:
    make, message = refused()[case]
    with pytest.raises(InputError, match=message):
        make()
