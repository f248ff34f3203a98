"""Mechanisms against closed forms and independent integrations: pendulums, Cardan shaft, slider-crank, heavy top."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from warpffrf.model import joints, signals
from warpffrf.model import rotation as rot
from warpffrf.model.scene import Scene
from warpffrf.online import GeneralizedAlpha, run
from warpffrf.online.history.history import History

GRAVITY = 9.81
ORDER_LEAST = 1.9  # of a method of order 2, at steps where the next term is still seen


def orders(errors: list[float]) -> np.ndarray:
    """Observed orders of errors at steps halved from one to the next."""
    return np.log2(np.array(errors[:-1]) / np.array(errors[1:]))


def completed(scene: Scene, duration: float, steps: int, rho_inf: float = 0.9, save_every: int = 1) -> History:
    history = run(
        scene, duration, step=duration / steps, integrator=GeneralizedAlpha(rho_inf), save_every=save_every,
        progress=False,
    )  # fmt: skip
    assert history.status == "completed", history.message
    return history


def test_pendulum_has_the_period_of_the_elliptic_integral() -> None:
    """D6: let go from the horizontal, equivalent length 1 m: T = 2.3678419476 s; after 5/4 T it is at the bottom."""
    period, mass, inertia = 2.3678419476, 2.0, 0.02
    arm = 0.5 * (1.0 + np.sqrt(1.0 - 4.0 * inertia / mass))  # arm + inertia/(mass arm) = 1
    speed = np.sqrt(2.0 * GRAVITY)  # rad/s at the bottom
    errors = []
    for steps in (1000, 2000, 4000, 8000):
        scene = Scene(gravity=(0.0, 0.0, -GRAVITY))
        bob = scene.add_rigid_body(mass, (inertia,) * 3, name="bob", position=(arm, 0.0, 0.0))
        scene.add(joints.Revolute(scene.ground, bob.at((-arm, 0.0, 0.0)), axis=(0, 1, 0), name="pivot"))
        history = completed(scene, 1.25 * period, steps, save_every=steps // 20)
        errors.append(abs(history.joints["pivot"].coordinate[-1] - 0.5 * np.pi) / (speed * period))  # of the period
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
    delta, speed = 0.6, 20.0
    scene = Scene()
    e_1, e_2 = np.array([1.0, 0.0, 0.0]), np.array([np.cos(delta), np.sin(delta), 0.0])
    shaft_1 = scene.add_rigid_body(1.0, (0.01, 0.02, 0.02), name="first", position=-0.2 * e_1)
    turn = rot.quaternion(rot.rotation_vector_matrix(np.array([0.0, 0.0, delta])))
    shaft_2 = scene.add_rigid_body(1.0, (0.01, 0.02, 0.02), name="second", position=0.2 * e_2, rotation=turn)
    bearing = scene.add(joints.Revolute(scene.ground, shaft_1.at((0, 0, 0)), axis=e_1, name="bearing_1"))
    scene.add(
        joints.Universal(
            shaft_1.at((0.2, 0, 0)), shaft_2.at((-0.2, 0, 0)), axis=(0, 1, 0), second_axis=(0, 0, 1), name="cross"
        )
    )
    scene.add(joints.Revolute(scene.ground, shaft_2.at((0, 0, 0)), axis=e_2, name="bearing_2"))
    scene.add(joints.Drive(bearing, speed))
    check = scene.check()
    assert check.redundant == {"bearing_2": 3} and check.degrees_of_freedom == 0
    history = completed(scene, 0.7, 1400, rho_inf=0.6)
    theta = speed * history.time
    found = history.joints["bearing_2"].coordinate
    exact = np.arctan2(np.sin(theta), np.cos(theta) * np.cos(delta))
    exact = exact + 2.0 * np.pi * np.round((theta - exact) / (2.0 * np.pi))
    assert found == pytest.approx(exact, abs=1e-8) and found[-1] > 4.0 * np.pi
    rate = history.bodies["second"].angular_velocity @ e_2
    ratio = np.cos(delta) / (1.0 - np.sin(delta) ** 2 * np.cos(theta) ** 2)
    assert rate[50:] / speed == pytest.approx(ratio[50:], rel=1e-3)
    swing = history.joints["cross"].named("second_rotation")  # the second shaft's yoke swings by delta to either side
    assert np.ptp(swing) == pytest.approx(2.0 * delta, rel=1e-5)
    work = history.energy["drive_work"] + history.energy["numerical"]
    assert work == pytest.approx(history.energy["kinetic"] - history.energy["kinetic"][0], abs=1e-9)


def test_slider_crank_of_rigid_bodies_moves_as_its_closed_form() -> None:
    """x = r cos(theta) + sqrt(l^2 - r^2 sin(theta)^2) at every step; the torque on the crank is dT/dtheta of the closed
    form of the kinetic energy, at order 2 in the step."""
    r, length, omega = 0.15, 0.5, 30.0
    m_crank, m_rod, m_piston, J_crank, J_rod = 1.0, 0.8, 0.5, 0.01, 0.02

    def kinetic(theta: np.ndarray) -> np.ndarray:
        s, c = np.sin(theta), np.cos(theta)
        lean = np.sqrt(length**2 - (r * s) ** 2)
        piston = -r * s - r * r * s * c / lean  # dx/dtheta
        phi = r * c / lean  # of the rod, d/dtheta
        rod = np.array([0.5 * (piston - r * s), 0.5 * r * c])  # its middle
        return 0.5 * omega**2 * (
            J_crank + m_crank * (0.5 * r) ** 2 + m_rod * (rod**2).sum(axis=0) + J_rod * phi**2 + m_piston * piston**2
        )  # fmt: skip

    errors = []
    for steps in (400, 800):
        scene = Scene()
        theta_0 = 0.3
        pin = r * np.array([np.cos(theta_0), 0.0, np.sin(theta_0)])
        x_0 = pin[0] + np.sqrt(length**2 - pin[2] ** 2)
        piston_at = np.array([x_0, 0.0, 0.0])
        crank = scene.add_rigid_body(m_crank, (J_crank,) * 3, name="crank", position=0.5 * pin)
        rod = scene.add_rigid_body(m_rod, (J_rod,) * 3, name="rod", position=0.5 * (pin + piston_at))
        piston = scene.add_rigid_body(m_piston, (0.01,) * 3, name="piston", position=piston_at)
        axle = scene.add(joints.Revolute(scene.ground, crank.at(-0.5 * pin), axis=(0, -1, 0), name="axle"))
        scene.add(joints.Revolute(crank.at(0.5 * pin), rod.at(0.5 * (pin - piston_at)), axis=(0, 1, 0), name="big_end"))
        scene.add(joints.Revolute(rod.at(0.5 * (piston_at - pin)), piston.at((0, 0, 0)), axis=(0, 1, 0), name="wrist"))
        scene.add(joints.Prismatic(scene.ground, piston.at((0, 0, 0)), axis=(1, 0, 0), name="liner"))
        scene.add(joints.Drive(axle, omega))
        assert sum(scene.check().redundant.values()) == 3
        history = completed(scene, 2.0 * np.pi / omega, steps, rho_inf=0.6)
        theta = theta_0 + omega * history.time
        x = r * np.cos(theta) + np.sqrt(length**2 - (r * np.sin(theta)) ** 2)
        assert history.joints["liner"].coordinate == pytest.approx(x - x_0, abs=1e-9)
        d = 1e-5
        torque = (kinetic(theta + d) - kinetic(theta - d)) / (2.0 * d)
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
    exact = np.array([0.173343964, 0.640088592, -0.748490791])
    omega, X = np.array([0.0, 150.0, -4.61538]), np.array([0.0, 1.0, 0.0])
    errors = []
    for steps in (8000, 16000, 32000, 64000):
        scene = Scene(gravity=(0.0, 0.0, -GRAVITY))
        top = scene.add_rigid_body(
            15.0, (0.234375, 0.46875, 0.234375), name="top", position=X, angular_velocity=omega,
            velocity=np.cross(omega, X),
        )  # fmt: skip
        scene.add(joints.Spherical(scene.ground, top.at(-X), name="tip"))
        history = completed(scene, 1.0, steps, save_every=steps // 10)
        errors.append(float(np.abs(history.bodies["top"].position[-1] - exact).max()))
        energy = history.energy["kinetic"] + history.energy["potential"]
        assert energy[0] == pytest.approx(5435.6967909, rel=1e-7)
    assert orders(errors).min() > ORDER_LEAST and errors[-1] < 2e-6
