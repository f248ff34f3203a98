"""Every kind of joint in motion: energy and momentum, reactions against Newton and Euler, drives of all coordinates."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from joint_scenes import GRAVITY, KINDS, pair

from warpffrf.model import joints, signals
from warpffrf.model import rotation as rot
from warpffrf.model.joints.base import gradient
from warpffrf.online import GeneralizedAlpha, run
from warpffrf.online.history.history import BodyHistory

ROUND_OFF = 1e-8  # of the weight: of accelerations from positions at a step of 5e-4 s
SECOND_ORDER = 2e-5  # of the weight, at 0.5 ms: bodies that slide freely in a plane turn the fastest
FIRST = 1e-11  # of the weight: round-off of the first reaction
COORDINATES = [(kind, name) for kind in KINDS for name in joints.JOINT_KINDS[kind].coordinates]


@pytest.mark.parametrize("kind", KINDS)
def test_free_flight_of_two_bodies_keeps_energy_and_momentum(kind: str) -> None:
    """Spinning, no loads: linear momentum to round-off, energy and angular momentum to second order in the step."""
    drift = []
    for step in (2e-3, 1e-3):
        scene, _ = pair(kind)
        scene.bodies[0].angular_velocity = np.array([3.0, -2.0, 4.0])
        scene.bodies[1].velocity = np.array([0.2, 0.5, -0.3])
        history = run(scene, 0.4, step=step, integrator=GeneralizedAlpha(0.9), project_start=True, progress=False)
        assert history.status == "completed", history.message
        P, L = np.zeros(3), np.zeros(3)
        for body in scene.bodies:
            motion = history.bodies[body.name]
            A = np.array([rot.matrix(q) for q in motion.rotation])
            arm = A @ body.center_of_mass
            v = motion.velocity + np.cross(motion.angular_velocity, arm)
            spin = np.einsum("tij,jk,tlk,tl->ti", A, body.inertia, A, motion.angular_velocity)
            P = P + body.mass * v
            L = L + body.mass * np.cross(motion.position + arm, v) + spin
        kinetic = history.energy["kinetic"]
        assert np.abs(P - P[0]).max() < 1e-9 * np.abs(P).max()
        drift.append(
            max(np.abs(kinetic - kinetic[0]).max() / kinetic[0], np.abs(L - L[0]).max() / np.linalg.norm(L[0]))
        )
        held = history.joints["j"]
        assert np.all(np.isfinite(held.force)) and np.all(np.isfinite(held.torque))
    assert drift[1] < 1e-4 and (drift[1] < 1e-10 or drift[1] < 0.4 * drift[0])


def required_wrench(body, motion: BodyHistory, time: np.ndarray, at: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Force and torque about the points `at` (T, 3) that the recorded motion of a body needs besides its weight, by
    fourth-order differences of its momenta (rows 2 to T - 2)."""
    A = np.array([rot.matrix(q) for q in motion.rotation])
    arm = A @ body.center_of_mass
    P = body.mass * (motion.velocity + np.cross(motion.angular_velocity, arm))
    L = np.einsum("tij,jk,tlk,tl->ti", A, body.inertia, A, motion.angular_velocity)
    h = time[1] - time[0]

    def rate(x: np.ndarray) -> np.ndarray:
        return (x[:-4] - 8.0 * x[1:-3] + 8.0 * x[3:-1] - x[4:]) / (12.0 * h)

    force = rate(P) - body.mass * np.asarray(GRAVITY)
    lever = (motion.position + arm - at)[2:-2]
    return force, rate(L) + np.cross(lever, force)


@pytest.mark.parametrize("kind", KINDS)
def test_reactions_are_what_newton_and_euler_ask_for(kind: str) -> None:
    """A body hung on the ground by every kind of joint, let go: the recorded reaction is the momentum balance of its
    recorded motion, to second order in the step, once the transient of the first multipliers has died out."""
    error = []
    for step in (1e-3, 5e-4):
        scene, joint = pair(kind, grounded=True, gravity=GRAVITY)
        body = scene.bodies[0]
        history = run(scene, 0.2, step=step, integrator=GeneralizedAlpha(0.6), progress=False)
        assert history.status == "completed" and not history.notes, history.notes
        motion, found = history.bodies["b"], history.joints["j"]
        port = np.array([rot.matrix(q) @ joint.b.point for q in motion.rotation]) + motion.position
        force, torque = required_wrench(body, motion, history.time, port)
        tail = slice(len(force) // 3, None)
        error.append(
            max(
                np.abs(found.force[2:-2] - force)[tail].max() / (9.81 * body.mass),
                np.abs(found.torque[2:-2] - torque)[tail].max() / (9.81 * body.mass * 0.2),
            )
        )
    assert error[1] < SECOND_ORDER and (error[1] < 0.35 * error[0] or error[1] < ROUND_OFF)


@pytest.mark.parametrize("kind", KINDS)
def test_first_reaction_solves_the_equations_of_motion_at_rest(kind: str) -> None:
    """At t = 0, from rest: [M C^T; C 0] [a; lambda] = [Q; 0] with the NumPy Jacobian."""
    scene, joint = pair(kind, grounded=True, gravity=GRAVITY)
    body = scene.bodies[0]
    (a, b), A = joint.frames(), rot.matrix(body.rotation)
    x_b = body.position + A @ b.point
    R = joint.axes()
    center = body.position + A @ body.center_of_mass
    C = []
    for row in joint.rows:
        f, t = gradient(row, a.point, R, x_b, R)
        C.append(np.concatenate([f, np.cross(x_b - center, f) + t]))
    C = np.array(C)
    M = np.zeros((6, 6))
    M[:3, :3], M[3:, 3:] = body.mass * np.eye(3), A @ body.inertia @ A.T
    Q = np.concatenate([body.mass * np.asarray(GRAVITY), np.zeros(3)])
    n = len(C)
    solution = np.linalg.solve(np.block([[M, C.T], [C, np.zeros((n, n))]]), np.concatenate([Q, np.zeros(n)]))
    reaction = -C.T @ solution[6:]
    force, torque = reaction[:3], reaction[3:] - np.cross(x_b - center, reaction[:3])
    history = run(scene, 1e-3, step=1e-3, progress=False)
    found = history.joints["j"]
    weight = 9.81 * body.mass
    assert found.force[0] == pytest.approx(force, abs=FIRST * weight)
    assert found.torque[0] == pytest.approx(torque, abs=FIRST * weight * 0.2)


@pytest.mark.parametrize("quantity", ["velocity", "position"])
@pytest.mark.parametrize(("kind", "name"), COORDINATES)
def test_drives_of_every_coordinate_are_followed_and_recorded(kind: str, name: str, quantity: Any) -> None:
    """The recorded coordinate is the prescribed one, over several turns where it is an angle; energy is closed."""
    is_angle = not joints.JOINT_KINDS[kind].coordinates[name].is_length
    reach = 15.0 if is_angle else 0.2
    scene, joint = pair(kind, grounded=True)
    start = joint.initial_value(joint.coordinates[name])
    for other in joint.coordinates:
        if other != name:
            scene.add(joints.Drive(joint, 0.0, coordinate=other))
    if quantity == "position":
        signal = signals.SmoothStep(start, start + reach, duration=0.2)
    else:
        signal = signals.SmoothStep(0.0, reach / 0.1, duration=0.2)  # its mean is half the last value
    scene.add(joints.Drive(joint, signal, quantity=quantity, coordinate=name, name="push"))
    history = run(scene, 0.2, step=2e-3, integrator=GeneralizedAlpha(0.8), save_every=10, progress=False)
    assert history.status == "completed", history.message
    wanted = scene.drives[-1].position()(history.time) + (start if quantity == "velocity" else 0.0)
    found = history.joints["j"].named(name)
    assert found == pytest.approx(wanted, abs=1e-8)
    assert found[-1] == pytest.approx(start + reach, rel=1e-9)
    for other in joint.coordinates:
        if other != name:
            assert np.abs(history.joints["j"].named(other)).max() < 1e-8
    numerical = history.energy["drive_work"] + history.energy["numerical"]
    assert numerical == pytest.approx(history.energy["kinetic"] - history.energy["kinetic"][0], abs=1e-9)
