"""Moments in whole bearings: torque of rolling resistance against the loads and the kinematics of rolling, and the
pivoting of balls, which follows from the friction of both patches, against a balance of the moments on one ball."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from scipy.optimize import brentq
from scipy.special import ellipe

from warpffrf.model import forces, joints, laws
from warpffrf.model.bearings import BallGeometry, Bearing, Flanges, RollerGeometry, RollingContact
from warpffrf.model.material import Material
from warpffrf.model.scene import Scene
from warpffrf.output.bearings.bearing_result import BearingResult
from warpffrf.output.contact.hertz import hertz_point
from warpffrf.output.options import RunOptions
from warpffrf.output.simulate import simulate

MM, SIDES = 1e-3, ("inner", "outer")
STEEL = Material(210e9, 0.3, 7850.0)
MODULUS = 0.5 * STEEL.plane_strain_modulus
SETTLED = 1e-4  # what is left of the start: forces of friction that swing in
BALL, PITCH, ANGLE, MU = 10 * MM, 50 * MM, np.radians(40.0), 0.1


def turned(scene: Scene, bearing: Bearing, speed: float, at: Any = (0.0, 0.0, 0.0)) -> None:
    """The inner ring on an axle, driven."""
    bearing.inner.position = np.array(at)
    axle = scene.add(joints.Revolute(scene.ground.at(at), bearing.inner.at((0, 0, 0)), axis=(0, 1, 0), name="axle"))  # pyright: ignore[reportAttributeAccessIssue]
    scene.add(joints.Drive(axle, speed, quantity="velocity", name="drive"))


def test_torque_of_rolling_resistance() -> None:
    """Rollers turn with w_e against the outer ring and w_e - w_i against the inner one; each contact takes e Q times
    that. With w_e = -w_c d/D the torque is e Q (1 + 2 w_c d/(w_i D)) a roller, in proportion to the load as Palmgren's:
    what creeps turns the rollers less, and takes the difference."""
    lever, speed, length, D, pitch, creep = 2e-5, 100.0, 8 * MM, 8 * MM, 40 * MM, 1e-2
    scene = Scene()
    bearing = scene.add_bearing(
        "b",
        RollerGeometry(elements=3, roller_diameter=D, roller_length=length, pitch_diameter=pitch, clearance=-10e-6),
        outer=scene.ground,
        contact=RollingContact(
            law=laws.PalmgrenLine(length, 2), friction=laws.RegularisedCoulomb(MU, creep),
            rolling_resistance=laws.RollingResistanceArm(lever, 0.5),
        ),
    )  # fmt: skip
    turned(scene, bearing, speed)
    bearing.roll(speed)
    assert bearing.drive is not None
    scene.drives.remove(bearing.drive)  # the rollers take the cage along
    result = simulate(scene, 1.5e-3, step=5e-5, start="equilibrium", progress=False)
    assert result.status == "completed", result.message
    found = result.bearing("b")
    around = found.orbit_speed[-1, 0] * pitch / D
    assert around == pytest.approx(0.5 * speed * (1.0 - D / pitch) * pitch / D, rel=1e-4)
    exact = lever * (found.inner_load[-1] * (speed + around) + found.outer_load[-1] * around).sum() / speed
    print(f"torque {-found.friction_torque[-1]:.6g} N m, of the loads and kinematics {exact:.6g} N m")
    assert -found.friction_torque[-1] == pytest.approx(exact, rel=SETTLED)
    assert result.joint("axle").torque[-1, 1] == pytest.approx(exact, rel=SETTLED)
    power = np.sum([each.sum(axis=1) for each in found.friction_power.values()], axis=0)
    assert power[-1] == pytest.approx(exact * speed, rel=SETTLED)
    ledger = result.history.energy["friction"]
    assert -np.trapezoid(power[10:], result.time[10:]) == pytest.approx(ledger[-1] - ledger[10], rel=1e-3)


@pytest.mark.slow
def test_ribs_rub_under_thrust() -> None:
    """An NJ bearing whose rollers carry a thrust between ribs of both rings: the inner ones have the thrust and their
    part of the torque, the drive gives what friction takes, which is in the ledger."""
    speed, thrust, length, origin = 100.0, 300.0, 8 * MM, (0.0, 0.0, 0.0)
    scene, friction = Scene(), laws.RegularisedCoulomb(MU, 1e-2)
    flanges = Flanges(20e-6, inner="back", height=1 * MM, end_radius=30 * MM, friction=friction)
    bearing = scene.add_bearing(
        "b",
        RollerGeometry(
            elements=3, roller_diameter=8 * MM, roller_length=length, pitch_diameter=40 * MM, clearance=-10e-6,
        ),
        outer=scene.ground, flanges=flanges,
        contact=RollingContact(law=laws.PalmgrenLine(length, 2), friction=friction), materials=STEEL,
    )  # fmt: skip
    inner: Any = bearing.inner
    axle = scene.add(joints.Cylindrical(scene.ground.at(origin), inner.at(origin), axis=(0, 1, 0), name="axle"))
    scene.add(joints.Drive(axle, speed, quantity="velocity", coordinate="rotation", name="drive"))
    scene.add(forces.PointForce(inner.at(origin), (0.0, thrust, 0.0), name="thrust"))
    bearing.roll(speed)
    assert bearing.drive is not None
    scene.drives.remove(bearing.drive)
    result = simulate(scene, 2e-4, step=1e-5, start="equilibrium", progress=False)
    assert result.status == "completed", result.message
    found = result.bearing("b")
    assert found.force[-1, 2] == pytest.approx(-thrust, rel=SETTLED)
    power = {where: each.sum(axis=1) for where, each in found.friction_power.items()}
    total = sum(power.values(), np.zeros(len(result.time)))
    assert power["flange"][-1] > 0.9 * total[-1]
    assert -found.friction_torque[-1] == pytest.approx(result.joint("axle").torque[-1, 1], rel=SETTLED)
    assert -found.friction_torque[-1] * speed == pytest.approx(total[-1], rel=SETTLED)
    assert found.table()["friction [W]"].sum() == pytest.approx(total[-1])
    ledger = result.history.energy["friction"]
    assert -np.trapezoid(total[5:], result.time[5:]) == pytest.approx(ledger[-1] - ledger[5], rel=1e-3)


def pivoting(found: BearingResult, bearing: Bearing, creep: float) -> dict[str, float]:
    """Speeds [rad/s] of pivoting on the inner and on the outer ring with which friction of both patches balances.

    Of the ball's moments those along the mean line of contact: friction forces that go round have none there, inertia
    neither, and pivoting both with the same lever. Rolling leaves one speed open, the angular velocity of the ball
    along that line.
    """
    n, moments = {}, {}
    for side in SIDES:
        Q, angle = getattr(found, f"{side}_load")[-1, 0], getattr(found, f"{side}_angle")[-1, 0]
        across, along = bearing.geometry.curvatures(side, angle)  # pyright: ignore[reportAttributeAccessIssue]
        a, b = hertz_point(Q, np.diag([float(across), float(along)]), MODULUS).semi_axes
        bound, slope = 0.375 * MU * Q * a * ellipe(1.0 - (b / a) ** 2), MU * Q * (a**2 + b**2) / (5.0 * creep)
        moments[side] = lambda w, c=bound, d=slope: np.sign(w) * min(c, d * abs(w))
        n[side] = np.array([np.cos(angle), np.sin(angle)])
    mean = n["inner"] + n["outer"]
    mean /= np.linalg.norm(mean)
    ball = found.spin[-1, 0, [0, 2]]  # outward, along the axis
    rings = {"inner": found.history.bodies[bearing.inner.name].angular_velocity[-1, 1], "outer": 0.0}

    def speeds(more: float) -> dict[str, float]:
        return {side: float((ball + more * mean - [0.0, rings[side]]) @ n[side]) for side in SIDES}

    more: Any = brentq(lambda x: sum(moments[s](w) for s, w in speeds(x).items()), -1e4, 1e4, xtol=1e-9)
    return speeds(more)


@pytest.mark.parametrize(
    ("osculation", "speed", "begin", "controls"),
    [
        ((0.52, 0.54), 50.0, "outer", "inner"),  # the wider groove has the smaller patch
        ((0.54, 0.52), 50.0, "inner", "outer"),
        ((0.52, 0.52), 50.0, "inner", "inner"),  # a longer patch inside, by 2 % of the moment
        ((0.52, 0.52), 1000.0, "outer", "outer"),  # centrifugal load
    ],
)
def test_raceway_control_is_found(osculation: tuple[float, float], speed: float, begin: str, controls: str) -> None:
    """Jones: balls pivot on the ring where Q a E(m) is less. They end there from whichever control they begin with, and
    creep on the other ring as far as the regularisation of friction has it."""
    creep = 2e-5 * speed
    scene = Scene()
    bearing = scene.add_bearing(
        "b",
        BallGeometry(elements=3, ball_diameter=BALL, pitch_diameter=PITCH, contact_angle=ANGLE, osculation=osculation),
        outer=scene.ground, cage=None,
        contact=RollingContact(
            friction=laws.RegularisedCoulomb(MU, creep), spin=True, law=laws.HertzPoint(STEEL, STEEL, damping=1.0),
        ),
        materials=STEEL,
    )  # fmt: skip
    turned(scene, bearing, speed, (0.0, 15e-6, 0.0))
    bearing.roll(speed, control=begin)
    result = simulate(scene, 8e-4, step=1e-5, start="equilibrium", options=RunOptions(save_every=4), progress=False)
    assert result.status == "completed", result.message
    found = result.bearing("b")
    exact = pivoting(found, bearing, creep)
    ball, n = found.spin[-1, 0], [getattr(found, f"{side}_angle")[-1, 0] for side in SIDES]
    pivots = [ball[0] * np.cos(a) + (ball[2] - w) * np.sin(a) for a, w in zip(n, (speed, 0.0), strict=True)]
    print(f"pivoting {pivots}, balanced {exact}, loads {found.inner_load[-1, 0]:.4g}, {found.outer_load[-1, 0]:.4g} N")
    np.testing.assert_allclose(pivots, [exact[side] for side in SIDES], atol=1e-2 * np.abs(pivots).max())
    held, free = pivots if controls == "inner" else pivots[::-1]
    assert abs(held) < 0.1 * abs(free)
    assert np.all(np.diff(result.history.energy["friction"]) <= 0.0)
