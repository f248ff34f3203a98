"""Mechanisms against closed forms and independent integrations: pendulums, Cardan shaft, slider-crank, heavy top."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from scenes.mechanisms import (
    CARDAN_SPEED,
    CRANK_START,
    DELTA,
    GRAVITY,
    OMEGA,
    PERIOD,
    TOP_AFTER_ONE,
    TOP_ENERGY,
    cardan_angle,
    cardan_shaft,
    completed,
    crank_torque,
    heavy_top,
    pendulum,
    piston_place,
    slider_crank,
)  # fmt: skip
from warpffrf.model import joints, signals
from warpffrf.model import rotation as rot
from warpffrf.model.scene import Scene

ORDER_LEAST = 1.9  # of a method of order 2, at steps where the next term is still seen


def orders(errors: list[float]) -> np.ndarray:
    """Observed orders of errors at steps halved from one to the next."""
    return np.log2(np.array(errors[:-1]) / np.array(errors[1:]))


def test_pendulum_has_the_period_of_the_elliptic_integral() -> None:
    """D6: let go from the horizontal, equivalent length 1 m: T = 2.3678419476 s; after 5/4 T it is at the bottom."""
    speed = np.sqrt(2.0 * GRAVITY)  # rad/s at the bottom
    errors = []
    for steps in (1000, 2000, 4000, 8000):
        history = completed(pendulum(), 1.25 * PERIOD, steps, save_every=steps // 20)
        errors.append(abs(history.joints["pivot"].coordinate[-1] - 0.5 * np.pi) / (speed * PERIOD))  # of the period
    assert orders(errors).min() > ORDER_LEAST and errors[-1] < 1e-6


def test_double_pendulum_follows_an_integration_in_minimal_coordinates() -> None:
    """Two compound links in hinges: absolute angles against an eighth-order Runge-Kutta method, energy at order 2."""
    m1, m2, a1, a2, length, J1, J2 = 2.0, 1.5, 0.3, 0.35, 0.6, 0.06, 0.05

    def rates(_: float, y: np.ndarray) -> np.ndarray:
        t1, t2, w1, w2 = y
        c, s = np.cos(t1 - t2), np.sin(t1 - t2)
        M = np.array(
            [[J1 + m1 * a1**2 + m2 * length**2, m2 * length * a2 * c], [m2 * length * a2 * c, J2 + m2 * a2**2]]
        )
        f = np.array([
            -m2 * length * a2 * s * w2**2 - (m1 * a1 + m2 * length) * GRAVITY * np.sin(t1),
            m2 * length * a2 * s * w1**2 - m2 * a2 * GRAVITY * np.sin(t2),
        ])  # fmt: skip
        return np.array([w1, w2, *np.linalg.solve(M, f)])

    start = np.array([1.6, 0.9, 0.0, 0.0])
    exact = solve_ivp(rates, (0.0, 1.0), start, method="DOP853", rtol=1e-12, atol=1e-12).y[:2, -1]
    errors, drifts = [], []
    for steps in (1000, 2000, 4000):
        scene = Scene(gravity=(0.0, 0.0, -GRAVITY))

        def hanging(angle: float) -> tuple[np.ndarray, np.ndarray]:
            """Unit vector down the link and its attitude (z up along the link)."""
            return np.array([np.sin(angle), 0.0, -np.cos(angle)]), rot.quaternion(
                rot.rotation_vector_matrix(np.array([0.0, -angle, 0.0]))
            )

        (d1, q1), (d2, q2) = hanging(start[0]), hanging(start[1])
        first = scene.add_rigid_body(m1, (J1,) * 3, name="first", position=a1 * d1, rotation=q1)
        second = scene.add_rigid_body(m2, (J2,) * 3, name="second", position=length * d1 + a2 * d2, rotation=q2)
        scene.add(joints.Revolute(scene.ground, first.at((0, 0, a1)), axis=(0, -1, 0), name="upper"))
        scene.add(joints.Revolute(first.at((0, 0, a1 - length)), second.at((0, 0, a2)), axis=(0, -1, 0), name="lower"))
        history = completed(scene, 1.0, steps)
        t1 = start[0] + history.joints["upper"].coordinate[-1]
        t2 = start[1] + history.joints["upper"].coordinate[-1] + history.joints["lower"].coordinate[-1]
        errors.append(float(np.abs(np.array([t1, t2]) - exact).max()))
        energy = history.energy["kinetic"] + history.energy["potential"]
        drifts.append(float(np.abs(energy - energy[0]).max() / np.ptp(history.energy["kinetic"])))
    assert orders(errors).min() > ORDER_LEAST and errors[-1] < 2e-5
    assert orders(drifts).min() > ORDER_LEAST and drifts[-1] < 1e-5


def test_cardan_shaft_turns_unevenly() -> None:
    """Two shafts at an angle delta: tan(theta_2) = tan(theta_1)/cos(delta), omega_2/omega_1 = cos(delta)/(1 -
    sin(delta)^2 cos(theta_1)^2), theta_1 from the plane of the shafts; three constraints are redundant."""
    scene = cardan_shaft()
    check = scene.check()
    assert check.redundant == {"bearing_2": 3} and check.degrees_of_freedom == 0
    history = completed(scene, 0.7, 1400, rho_inf=0.6)
    theta = CARDAN_SPEED * history.time
    found = history.joints["bearing_2"].coordinate
    assert found == pytest.approx(cardan_angle(theta), abs=1e-8) and found[-1] > 4.0 * np.pi
    rate = history.bodies["second"].angular_velocity @ np.array([np.cos(DELTA), np.sin(DELTA), 0.0])
    ratio = np.cos(DELTA) / (1.0 - np.sin(DELTA) ** 2 * np.cos(theta) ** 2)
    assert rate[50:] / CARDAN_SPEED == pytest.approx(ratio[50:], rel=1e-3)
    swing = history.joints["cross"].named("second_rotation")  # the second shaft's yoke swings by DELTA to either side
    assert np.ptp(swing) == pytest.approx(2.0 * DELTA, rel=1e-5)
    work = history.energy["drive_work"] + history.energy["numerical"]
    assert work == pytest.approx(history.energy["kinetic"] - history.energy["kinetic"][0], abs=1e-9)


def test_slider_crank_of_rigid_bodies_moves_as_its_closed_form() -> None:
    """x = r cos(theta) + sqrt(l^2 - r^2 sin(theta)^2) at every step; the torque on the crank is dT/dtheta of the closed
    form of the kinetic energy, at order 2 in the step."""
    errors = []
    for steps in (400, 800):
        scene = slider_crank()
        assert sum(scene.check().redundant.values()) == 3
        history = completed(scene, 2.0 * np.pi / OMEGA, steps, rho_inf=0.6)
        theta = CRANK_START + OMEGA * history.time
        x = piston_place(theta) - piston_place(CRANK_START)
        assert history.joints["liner"].coordinate == pytest.approx(x, abs=1e-9)
        torque = crank_torque(theta)
        found = -history.joints["axle"].torque[:, 1]
        errors.append(float(np.abs(found - torque)[steps // 4 :].max() / np.abs(torque).max()))
        # thrust of the liner and of the axle balance the momentum of the whole across the stroke
        assert np.abs(history.joints["liner"].force[:, 1]).max() < 1e-9
    assert errors[-1] < 2e-3 and orders(errors)[-1] > 1.7


def test_driven_rod_of_changing_length_moves_a_slider() -> None:
    """A telescopic rod (driven distance) from a point above a guide: x = sqrt(l(t)^2 - height^2)."""
    scene = Scene(gravity=(0.0, 0.0, -GRAVITY))
    slider = scene.add_rigid_body(1.0, (0.01,) * 3, name="slider", position=(0.4, 0.0, 0.0))
    scene.add(joints.PointOnLine(scene.ground, slider.at((0, 0, 0)), axis=(1, 0, 0), name="guide"))
    rod = scene.add(joints.Distance(scene.ground.at((0, 0, 0.3)), slider.at((0, 0, 0)), name="rod"))
    scene.add(joints.Drive(rod, signals.SmoothStep(0.5, 1.0, duration=0.5), quantity="position"))
    history = completed(scene, 0.6, 600, rho_inf=0.6)
    length = np.asarray(signals.SmoothStep(0.5, 1.0, duration=0.5)(history.time))
    assert history.joints["rod"].coordinate == pytest.approx(length, abs=1e-9)
    assert history.bodies["slider"].position[:, 0] == pytest.approx(np.sqrt(length**2 - 0.09), abs=1e-8)
    end = history.joints["rod"].force[-1] + history.joints["guide"].force[-1]
    assert end == pytest.approx([0.0, 0.0, GRAVITY], abs=1e-5)
    assert np.abs(history.joints["guide"].force[:, 0]).max() < 1e-9  # a smooth line carries nothing along itself


@pytest.mark.slow
def test_heavy_top_reaches_its_reference_position() -> None:
    """D5: a top on a ball joint spinning at 150 rad/s; position of its centre of mass after 1 s, at order 2, and the
    energy of the start."""
    errors = []
    for steps in (8000, 16000, 32000, 64000):
        history = completed(heavy_top(), 1.0, steps, save_every=steps // 10)
        errors.append(float(np.abs(history.bodies["top"].position[-1] - TOP_AFTER_ONE).max()))
        energy = history.energy["kinetic"] + history.energy["potential"]
        assert energy[0] == pytest.approx(TOP_ENERGY, rel=1e-7)
    assert orders(errors).min() > ORDER_LEAST and errors[-1] < 2e-6
