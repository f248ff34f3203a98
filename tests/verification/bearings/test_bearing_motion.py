"""Bearings that turn: rolling kinematics, centrifugal load, vibration by the passing of balls, losses by friction."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from scipy.optimize import least_squares

from warpffrf.model import forces, friction, joints, laws
from warpffrf.model.bearings import BallGeometry, Bearing, PocketCage, PrescribedCage, RollingContact
from warpffrf.model.errors import InputError
from warpffrf.model.material import Material
from warpffrf.model.scene import Scene
from warpffrf.output.options import RunOptions
from warpffrf.output.result import Result
from warpffrf.output.simulate import equilibrium, simulate

MM = 1e-3
STEEL = Material(210e9, 0.3, 7850.0)
DAMPED = laws.HertzPoint(STEEL, STEEL, damping=1.0)
TRACTION = friction.RegularisedCoulomb(0.1, 0.05)
SPEED = 10000.0 * np.pi / 30.0  # rad/s
D, PITCH, FREE, PRELOAD = 10 * MM, 50 * MM, np.radians(25.0), 25e-6
CENTRIFUGAL, KINEMATICS = 1e-3, 1e-2  # promised
STEADY = 1e-2  # of the power: what the kinetic energy of the balls still changes
FREQUENCY, AMPLITUDE = 1e-2, 5e-2  # promised
VC: dict[str, Any] = {"elements": 7, "ball_diameter": 11.5 * MM, "pitch_diameter": 43.5 * MM, "clearance": 40e-6}
VC_SPEED, VC_STEPS = 100.0, 500  # rad/s: the ball passes at a fiftieth of the slowest vibration; steps of a passage


def preloaded(cage: Any, *, speed: float = SPEED) -> tuple[Scene, Bearing]:
    """An angular-contact bearing whose inner ring is held where it is pressed in, and turns at 10,000 rpm."""
    scene = Scene()
    bearing = scene.add_bearing(
        "b", BallGeometry(elements=8, ball_diameter=D, pitch_diameter=PITCH, contact_angle=FREE), outer=scene.ground,
        cage=cage, contact=RollingContact(law=DAMPED, friction=TRACTION), materials=STEEL,
    )  # fmt: skip
    at = np.array([0.0, PRELOAD, 0.0])
    bearing.inner.position = at
    axle = scene.add(joints.Revolute(scene.ground.at(at), bearing.inner.at((0, 0, 0)), axis=(0, 1, 0), name="axle"))  # pyright: ignore[reportAttributeAccessIssue]
    scene.add(joints.Drive(axle, speed, name="drive"))
    return scene, bearing


@pytest.fixture(scope="module")
def fast() -> Result:
    """Until the balls have found their speeds, 1.5 ms."""
    scene, bearing = preloaded(PocketCage(0.1 * MM))
    bearing.roll(SPEED)
    result = simulate(scene, 1.5e-3, step=1e-5, start="equilibrium", options=RunOptions(save_every=5), progress=False)
    assert result.status == "completed", result.message
    return result


@pytest.mark.parametrize("control", ["inner", "outer"])
def test_bodies_begin_to_roll(control: str) -> None:
    """Where they touch surfaces have one velocity, and none of pivoting on one ring; at any axis; the closed forms."""
    scene = Scene()
    bearing = scene.add_bearing(
        "b", BallGeometry(elements=8, ball_diameter=D, pitch_diameter=PITCH, contact_angle=FREE),
        position=(0.1, 0.2, 0.3), axis=(1, 2, 2),
    )  # fmt: skip
    inner, outer = 300.0, -70.0
    found = bearing.roll(inner, outer, control=control)
    gamma = D * np.cos(FREE) / PITCH
    assert found.orbit == pytest.approx(0.5 * (inner * (1.0 - gamma) + outer * (1.0 + gamma)))
    rolling = np.hypot(found.radial, found.axial - found.orbit)
    axis = bearing.place.axis
    for ball, side in ((bearing.elements[2], "inner"), (bearing.elements[2], "outer"), (bearing.elements[5], "outer")):
        contact: Any = bearing.contacts[f"{side}_{1 + bearing.elements.index(ball)}"]
        at, ring = contact.nearest(), getattr(bearing, side)
        moved = [body.velocity + np.cross(body.angular_velocity, at.place - body.position) for body in (ball, ring)]
        np.testing.assert_allclose(moved[0], moved[1], atol=1e-9 * np.abs(moved[1]).max())
        pivoting = (ball.angular_velocity - ring.angular_velocity) @ at.normal
        assert (abs(pivoting) < 1e-6 * rolling) == (side == control)
    speed = 0.5 * PITCH / D * (1.0 - gamma**2) * (outer - inner)  # about the line across that of contact, in the cage
    assert found.axial * np.cos(FREE) - found.radial * np.sin(FREE) - found.orbit * np.cos(FREE) == pytest.approx(speed)
    assert bearing.drive is not None and bearing.drive.signal(0.0) == pytest.approx(found.orbit - outer)
    np.testing.assert_allclose(bearing.cage.angular_velocity, found.orbit * axis)  # pyright: ignore[reportOptionalMemberAccess]


def test_rolling_that_cannot_be_is_named() -> None:
    _, bearing = preloaded(PrescribedCage())
    with pytest.raises(InputError, match="the outer ring is the ground, which is fixed"):
        bearing.roll(10.0, 5.0)
    for control in ("both", "cage"):
        with pytest.raises(InputError, match=f'control must be "inner" or "outer".* got \'{control}\''):
            bearing.roll(10.0, control=control)


def test_centrifugal_load_and_speeds_at_10000_rpm(fast: Result) -> None:
    """Contact angles part under the centrifugal load; with these, rigid kinematics without slip."""
    found, bearing = fast.bearing("b"), fast.scene.bearing("b")  # pyright: ignore[reportOptionalMemberAccess]
    Q_i, Q_o = found.inner_load[-1], found.outer_load[-1]
    a_i, a_o = found.inner_angle[-1], found.outer_angle[-1]
    assert np.all(a_i > a_o + np.radians(1.0))
    R, r = 0.5 * PITCH, 0.5 * D
    t_i = R - r * np.cos(a_i)  # radius of the place of contact
    w, pivot = found.spin[-1, :, 2], found.spin[-1, :, 0]
    orbit = found.orbit_speed[-1]
    rolled_i = (R * orbit - SPEED * t_i) / r  # speed about the direction across the line of contact
    rolled_o = -R * orbit / r
    np.testing.assert_allclose(w * np.cos(a_i) - pivot * np.sin(a_i), rolled_i, rtol=KINEMATICS)
    np.testing.assert_allclose(w * np.cos(a_o) - pivot * np.sin(a_o), rolled_o, rtol=KINEMATICS)
    mean = 0.5 * (a_i + a_o)
    gamma = D * np.cos(mean) / PITCH
    np.testing.assert_allclose(orbit, 0.5 * SPEED * (1.0 - gamma), rtol=KINEMATICS)
    F = bearing.elements[0].mass * R * orbit**2
    names = [[contact.name for contact in bearing.contacts_of(side)] for side in ("inner", "outer")]
    contacts = fast.history.lumped_contacts
    rubs = np.sum([[contacts[n].friction_force[-1] for n in each] for each in names], axis=0)  # gyroscopic moment
    balls = np.array([fast.body(ball.name).position[-1] for ball in bearing.elements]) * [1.0, 0.0, 1.0]
    inwards = -np.einsum("zi,zi->z", rubs, balls) / np.linalg.norm(balls, axis=1)
    pressed = Q_o * np.cos(a_o) - Q_i * np.cos(a_i) + inwards
    assert np.abs(pressed / F - 1.0).max() < CENTRIFUGAL
    ratios, moment = found.spin_to_roll, found.gyroscopic_moment[-1].mean()
    print(
        f"centrifugal {pressed.mean():.4f} N, m r w^2 {F.mean():.4f} N; angles {np.degrees([a_i.mean(), a_o.mean()])}"
    )
    print(f"spin to roll {ratios['inner'][-1].mean():.4f}, {ratios['outer'][-1].mean():.4f}; moment {moment:.4e} N m")
    assert found.gyroscopic_moment[-1] == pytest.approx(0.4 * bearing.elements[0].mass * r**2 * orbit * pivot)


def test_friction_torque_and_power_are_what_the_ledger_has() -> None:
    """A cage that stands: balls slip on both rings. What the drive of the ring puts in, friction takes."""
    speed = 50.0
    scene, _ = preloaded(PrescribedCage(), speed=speed)
    result = simulate(scene, 4e-4, step=5e-6, start="equilibrium", progress=False)
    assert result.status == "completed", result.message
    found = result.bearing("b")
    power = np.sum([each.sum(axis=1) for each in found.friction_power.values()], axis=0)
    ledger = result.history.energy["friction"]
    assert -np.trapezoid(power[20:], result.time[20:]) == pytest.approx(ledger[-1] - ledger[20], rel=1e-3)
    given = -found.friction_torque[-1] * speed
    print(f"torque {found.friction_torque[-1]:.4f} N m, power {power[-1]:.3f} W, of the drive {given:.3f} W")
    assert given == pytest.approx(power[-1], rel=STEADY)
    slip = speed * (0.5 * PITCH - 0.5 * D * np.cos(found.inner_angle[-1]))  # of both contacts, faster than creep
    assert power[-1] == pytest.approx((0.1 * found.inner_load[-1] * slip).sum(), rel=1e-3)  # alpha_o is 0.02 deg less
    assert "friction:" in found.report()
    assert np.ptp(result.energy_residual) < 1e-2


@pytest.fixture(scope="module")
def sweep() -> np.ndarray:
    """(8,) m: place of the inner ring along the load at eight places of the cage in one passage of a ball, standing."""
    half = [_passing(np.pi / 4.0 * k / VC["elements"], PrescribedCage(), 0.0) for k in range(5)]
    rows = []
    for scene, bearing, _ in half:
        result = equilibrium(scene, progress=False)
        assert result.status == "completed", result.message
        rows.append(result.body(bearing.inner.name).position[-1, 2])
    return np.array([*rows, *rows[-2:0:-1]])


def _passing(angle: float, cage: Any, load: Any) -> tuple[Scene, Bearing, Any]:
    """A bearing under a radial load along z, the first ball `angle` from it."""
    scene = Scene()
    bearing = scene.add_bearing(
        "b", BallGeometry(**VC), first=(np.sin(angle), 0.0, np.cos(angle)), outer=scene.ground, cage=cage,
        contact=RollingContact(law=DAMPED, friction=load), materials=STEEL,
    )  # fmt: skip
    center = bearing.inner.at((0, 0, 0))  # pyright: ignore[reportAttributeAccessIssue]
    plane = scene.add(joints.Planar(scene.ground.at((0, 0, 0)), center, axis=(0, 1, 0), name="plane"))
    scene.add(forces.PointForce(center, (0.0, 0.0, 1e3), name="load"))
    return scene, bearing, plane


@pytest.mark.slow
def test_vibration_as_balls_pass(sweep: np.ndarray) -> None:
    """Two passages at 955 rpm, balls driven by the rings alone, in a loose cage, against standing bearings."""
    scene, bearing, plane = _passing(0.0, PocketCage(20e-6), friction.RegularisedCoulomb(0.1, 0.01))
    scene.add(joints.Drive(plane, VC_SPEED, name="drive"))
    rolled = bearing.roll(VC_SPEED, angle=0.0)
    passage = 2.0 * np.pi / (VC["elements"] * rolled.orbit)
    result = simulate(
        scene,
        2.25 * passage,
        step=passage / VC_STEPS,
        start="equilibrium",
        options=RunOptions(save_every=5),
        progress=False,
    )
    assert result.status == "completed", result.message
    z, t = result.body(bearing.inner.name).position[:, 2], result.time
    shares = np.fft.rfft(sweep) / len(sweep)

    def off(x: np.ndarray) -> np.ndarray:
        """Of the sweep's shape (mean, size) and phase (speed, at the beginning) from the run, over the amplitude."""
        phase = 2.0 * np.pi * x[0] * t / passage + x[1]
        shape = sum(2.0 * np.real(shares[k] * np.exp(1j * k * phase)) for k in range(1, 4))
        return (shares[0].real + 1e-6 * x[2] + x[3] * shape - z) / np.ptp(sweep)

    frequency, _, _, size = least_squares(off, (1.0, 0.0, 0.0, 1.0)).x
    print(f"frequency off by {frequency - 1:+.2e}, amplitude by {size - 1:+.2e}, of {np.ptp(sweep) * 1e6:.3f} um")
    assert abs(frequency - 1.0) < FREQUENCY and abs(size - 1.0) < AMPLITUDE
    assert np.ptp(sweep) > 1e-6
