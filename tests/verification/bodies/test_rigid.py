"""Rigid bodies, joints, springs and drives against closed forms."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from scipy.special import ellipk

from warpffrf.model import forces, joints, signals
from warpffrf.model import rotation as rot
from warpffrf.model.errors import InputError
from warpffrf.model.scene import Scene
from warpffrf.online import GeneralizedAlpha, run

ORDER_LEAST = 1.8  # of a method of order 2, at steps where the next term is still seen


def order(errors: list[float]) -> float:
    """Observed order from errors at steps halved from one to the next: the last pair."""
    return float(np.log2(errors[-2] / errors[-1]))


def test_free_rigid_body_turns_as_euler_says() -> None:
    """I = (1, 2, 3), omega_0 = (1e-3, 5, 1e-3) rad/s, about the unstable axis; omega(10 s) from Jacobi's elliptic
    functions."""
    exact = np.array([4.510627138, -2.157369653, 2.604211920])
    errors = []
    for step in (4e-3, 2e-3):
        scene = Scene()
        scene.add_rigid_body(1.0, (1.0, 2.0, 3.0), name="body", angular_velocity=(1e-3, 5.0, 1e-3))
        history = run(scene, 10.0, step=step, integrator=GeneralizedAlpha(0.9), save_every=250, progress=False)
        assert history.status == "completed"
        motion = history.bodies["body"]
        omega = rot.matrix(motion.rotation[-1]).T @ motion.angular_velocity[-1]
        errors.append(float(np.abs(omega - exact).max()))
    assert order(errors) > ORDER_LEAST
    assert errors[-1] < 2e-2  # 5 rad/s at h |omega| = 1e-2 over 50 rad about an unstable axis


def pendulum(step: float, length: float = 1.0) -> tuple[float, float]:
    """Error of the angle after the quarter period of a pendulum let go from the horizontal, and worst loss of
    energy."""
    mass, inertia, g = 2.0, 0.05, 9.81
    effective = length + inertia / (mass * length)  # of the equivalent mathematical pendulum
    quarter = np.sqrt(effective / g) * float(ellipk(0.5))
    scene = Scene(gravity=(0.0, 0.0, -g))
    bob = scene.add_rigid_body(mass, (inertia,) * 3, name="bob", position=(length, 0.0, 0.0))
    scene.add(joints.Revolute(scene.ground, bob.at((-length, 0.0, 0.0)), axis=(0, 1, 0)))
    count = int(round(quarter / step))
    history = run(scene, quarter, step=quarter / count, integrator=GeneralizedAlpha(0.9), progress=False)
    assert history.status == "completed"
    x = history.bodies["bob"].position
    energy = history.energy["kinetic"] + history.energy["potential"]
    assert np.abs(np.linalg.norm(x, axis=1) - length).max() < 1e-9  # the constraint, exact at every step
    return float(abs(np.arctan2(x[-1, 0], -x[-1, 2]))), float(np.abs(energy - energy[0]).max() / (mass * g * length))


def test_pendulum_from_the_horizontal_swings_with_the_exact_period() -> None:
    """T = 4 sqrt(l/g) K(1/2), with l the length of the equivalent mathematical pendulum."""
    errors, losses = zip(*(pendulum(h) for h in (1e-2, 5e-3, 2.5e-3)), strict=True)
    assert order(list(errors)) > ORDER_LEAST
    assert errors[-1] < 1e-4 and losses[-1] < 1e-4


@pytest.mark.parametrize("rho_inf", [0.5, 0.8, 1.0])
def test_sprung_slider_follows_the_damped_oscillation(rho_inf: float) -> None:
    """Prismatic joint with spring, damper and weight: z(t) = z_s (1 - exp(-zeta w t)(cos w_d t + zeta w/w_d sin w_d
    t))."""
    mass, k, d, g = 2.0, 800.0, 8.0, 9.81
    w, zeta = np.sqrt(k / mass), d / (2.0 * np.sqrt(k * mass))
    w_d = w * np.sqrt(1.0 - zeta**2)
    errors = []
    for step in (4e-3, 2e-3):
        scene = Scene(gravity=(0.0, 0.0, -g))
        slider = scene.add_rigid_body(mass, (0.1,) * 3, name="slider")
        guide = scene.add(joints.Prismatic(scene.ground, slider.at((0, 0, 0)), axis=(0, 0, 1), name="guide"))
        scene.add(forces.JointSpringDamper(guide, k, d))
        history = run(scene, 0.5, step=step, integrator=GeneralizedAlpha(rho_inf), progress=False)
        t = history.time
        exact = -mass * g / k * (1.0 - np.exp(-zeta * w * t) * (np.cos(w_d * t) + zeta * w / w_d * np.sin(w_d * t)))
        errors.append(float(np.abs(history.joints["guide"].coordinate - exact).max() / (mass * g / k)))
        balance = sum(history.energy[n] for n in ("kinetic", "potential", "damping", "contact_grid"))
        balance = balance - history.energy["force_work"] - history.energy["drive_work"] - history.energy["numerical"]
        assert np.abs(balance - balance[0]).max() < 1e-12 * np.abs(history.energy["potential"]).max() + 1e-14
    assert order(errors) > ORDER_LEAST
    assert errors[-1] < 2e-2


SIGNALS = {
    "ramp": signals.Ramp(0.0, 5.0, duration=0.05, delay=0.01),
    "smooth step": signals.SmoothStep(0.0, 30.0, duration=0.05),
    "table": signals.Table([0.0, 0.02, 0.05, 0.1, 0.12], [0.0, 5.0, -3.0, 2.0, 2.0], cubic=True),
}


DRIVES = [
    (name, quantity)
    for name in SIGNALS
    for quantity in ("velocity", "position")
    if (name, quantity) != ("ramp", "position")
]


@pytest.mark.parametrize(("name", "quantity"), DRIVES)
def test_driven_joints_reach_their_prescribed_positions(name: str, quantity: Any) -> None:
    """Revolute and prismatic; the angle passes several turns, so that it must not be counted in half turns."""
    signal = SIGNALS[name]
    scene = Scene()
    wheel = scene.add_rigid_body(1.0, (0.1, 0.2, 0.1), name="wheel", center_of_mass=(0.0, 0.1, 0.0))
    slider = scene.add_rigid_body(1.0, (0.1, 0.1, 0.1), name="slider")
    axle = scene.add(joints.Revolute(scene.ground, wheel.at((0, 0, 0)), axis=(0, 1, 0), name="axle"))
    guide = scene.add(joints.Prismatic(scene.ground, slider.at((0, 0, 0)), axis=(1, 0, 0), name="guide"))
    for joint in (axle, guide):
        scene.add(joints.Drive(joint, signal, quantity=quantity))
    history = run(scene, 0.12, step=2e-3, progress=False)
    assert history.status == "completed"
    t = np.linspace(0.0, 0.12, 24001)
    rate = signal(t)
    integral = np.concatenate(
        [[0.0], np.cumsum(0.5 * (rate[1:] + rate[:-1]) * np.diff(t))]
    )  # independent of the exact one
    exact = np.interp(history.time, t, integral) if quantity == "velocity" else signal(history.time)
    exact = exact - exact[0]
    tolerance = 1e-5 if quantity == "velocity" else 1e-9  # trapezoidal rule of the reference; joint tolerance
    assert np.abs(history.bodies["slider"].position[:, 0] - exact).max() < tolerance
    R = [rot.matrix(q) for q in history.bodies["wheel"].rotation]
    angle = np.array([np.arctan2(A[0, 2], A[0, 0]) for A in R])
    assert np.abs(np.sin(0.5 * (angle - exact))).max() < tolerance
    work = history.energy["drive_work"][-1] + history.energy["numerical"][-1]
    assert work == pytest.approx(history.energy["kinetic"][-1] - history.energy["kinetic"][0], abs=1e-9)


def test_a_position_that_jumps_in_velocity_is_refused() -> None:
    scene = Scene()
    slider = scene.add_rigid_body(1.0, (0.1, 0.1, 0.1), name="slider")
    guide = scene.add(joints.Prismatic(scene.ground, slider.at((0, 0, 0)), axis=(1, 0, 0), name="guide"))
    scene.add(joints.Drive(guide, SIGNALS["ramp"], quantity="position", name="push"))
    with pytest.raises(InputError, match=r"'push': the prescribed position jumps in velocity by 100 at t = 0.01 s"):
        run(scene, 0.12, step=2e-3, progress=False)
    assert run(scene, 0.01, step=2e-3, progress=False).status == "completed"  # the jump is at its end, no step sees it


def test_a_body_at_rest_takes_up_the_speed_of_its_drive_at_once() -> None:
    scene = Scene()
    wheel = scene.add_rigid_body(1.0, (0.1, 0.2, 0.1), name="wheel", center_of_mass=(0.05, 0.0, 0.0))
    axle = scene.add(joints.Revolute(scene.ground, wheel.at((0, 0, 0)), axis=(0, 1, 0), name="axle"))
    scene.add(joints.Drive(axle, 20.0))
    history = run(scene, 0.1, step=1e-3, progress=False)
    assert history.status == "completed"
    assert history.bodies["wheel"].angular_velocity[0, 1] == pytest.approx(20.0, rel=1e-9)
    assert any("'wheel': its initial velocity did not agree" in note and "20 rad/s" in note for note in history.notes)
    centripetal = 1.0 * 20.0**2 * 0.05  # N
    force = np.linalg.norm(history.joints["axle"].force, axis=1)
    # the multiplier swings about its value at first (index 3), damped by rho_inf; second order: (omega h)^2 = 4e-4
    assert force[60:] == pytest.approx(centripetal, rel=1e-3)
