r"""Andrews' squeezer: seven bodies, ten pins, one spring, one torque.

Data: E. Hairer and G. Wanner, Solving Ordinary Differential Equations II, 1996, section VII.7; reference at t = 0.03 s:
IVP test set (case P5 of the published values). With e(a) = (cos a, sin a), the absolute angles are beta (K1), beta +
theta (K2), gamma (K3), phi + delta (K4), delta (K5), Omega + epsilon (K6), epsilon (K7), all bars meet in

    F = rr e(beta) - d e(beta + theta)                                  (K1, K2)
      = B + ss (sin gamma, -cos gamma)                                  (K3)
      = A + zt e(delta) + e (sin(phi + delta), -cos(phi + delta))       (K5, K4)
      = A + u (sin epsilon, -cos epsilon) + zf e(Omega + epsilon)       (K7, K6)

and the spring runs from C to D = B + (sd cos gamma + sc sin gamma, sd sin gamma - sc cos gamma).
"""

from __future__ import annotations

import numpy as np

from studies.hard_cases.case import Case, Finding
from warpffrf.model import forces, joints
from warpffrf.model import rotation as rot
from warpffrf.model.bodies import Port
from warpffrf.model.scene import Scene
from warpffrf.output.result import Result

A, B, C = np.array([-0.06934, -0.00227]), np.array([-0.03635, 0.03273]), np.array([0.014, 0.072])  # m
MASSES = (0.04325, 0.00365, 0.02373, 0.00706, 0.07050, 0.00706, 0.05498)  # kg
INERTIAS = (2.194e-6, 4.410e-7, 5.255e-6, 5.667e-7, 1.169e-5, 5.667e-7, 1.912e-5)  # kg m2
D_, DA, E_, EA, ZF, FA = 28e-3, 11.5e-3, 20e-3, 14.21e-3, 20e-3, 14.21e-3  # m
RR, RA, SS, SA, SB, SC, SD = 7e-3, 0.92e-3, 35e-3, 18.74e-3, 10.43e-3, 18e-3, 20e-3
TA, TB, U_, UA, UB, ZT = 23.08e-3, 9.16e-3, 40e-3, 12.28e-3, 4.49e-3, 40e-3
STIFFNESS, FREE, TORQUE = 4530.0, 0.07785, 0.033  # N/m, m, N m
NAMES = ("beta", "theta", "gamma", "phi", "delta", "omega", "epsilon")
START = np.array([
    -0.0617138900142764496358948458001, 0.0, 0.455279819163070380255912382449, 0.222668390165885884674473185609,
    0.487364979543842550225598953530, -0.222668390165885884674473185609, 1.23054744454982119249735015568,
])  # fmt: skip
END = np.array([
    15.81077119629904, -15.75637105984298, 0.04082224013073101, -0.5347301163226948, 0.5244099658805304,
    0.5347301163226948, 1.048080741042263,
])  # fmt: skip
DURATION, SHORTEST = 0.03, 0.0299  # s


def _e(angle: float) -> np.ndarray:
    return np.array([np.cos(angle), np.sin(angle)])


def _across(angle: float) -> np.ndarray:
    return np.array([np.sin(angle), -np.cos(angle)])


def build() -> Scene:
    """The mechanism at rest."""
    beta, theta, gamma, phi, delta, omega, epsilon = START
    scene = Scene()
    start = np.zeros(2)
    P = RR * _e(beta)
    F = P - D_ * _e(beta + theta)
    G, H = A + ZT * _e(delta), A + U_ * _across(epsilon)
    centers = (
        RA * _e(beta), P - DA * _e(beta + theta), B + SA * _across(gamma) + SB * _e(gamma),
        G + (E_ - EA) * _across(phi + delta), A + TA * _e(delta) + TB * _across(delta),
        H + (ZF - FA) * _e(omega + epsilon), A + UA * _across(epsilon) + UB * _e(epsilon),
    )  # fmt: skip
    angles = (beta, beta + theta, gamma, phi + delta, delta, omega + epsilon, epsilon)
    bodies = []
    for i, (center, angle, mass, inertia) in enumerate(zip(centers, angles, MASSES, INERTIAS, strict=True)):
        turn = rot.quaternion(rot.rotation_vector_matrix(np.array([0.0, 0.0, angle])))
        J = (0.6 * inertia, 0.6 * inertia, inertia)
        bodies.append(scene.add_rigid_body(mass, J, name=f"K{i + 1}", position=(*center, 0.0), rotation=turn))

    def at(i: int, place: np.ndarray) -> Port:
        body = bodies[i - 1]
        return body.at(tuple(body.to_user(np.array([*place, 0.0]))))

    def pin(i: int, j: int, place: np.ndarray) -> object:
        first = at(i, place) if i else scene.ground.at((*place, 0.0))
        return scene.add(joints.Revolute(first, at(j, place), axis=(0, 0, 1), name=f"pin {i}-{j}"))

    pins = (
        (0, 1, start),
        (1, 2, P),
        (0, 3, B),
        (2, 3, F),
        (2, 4, F),
        (2, 6, F),
        (0, 5, A),
        (5, 4, G),
        (0, 7, A),
        (7, 6, H),
    )
    for i, j, place in pins:
        pin(i, j, place)
    spring = B + SD * _e(gamma) + SC * _across(gamma)
    scene.add(
        forces.SpringDamper(scene.ground.at((*C, 0.0)), at(3, spring), STIFFNESS, free_length=FREE, name="spring")
    )
    scene.add(forces.PointTorque(bodies[0].at((0.0, 0.0, 0.0)), (0.0, 0.0, TORQUE), name="torque"))
    return scene


def angles_of(result: Result) -> np.ndarray:
    """The seven angles (T, 7) [rad]."""
    turned = {
        name: result.joint(f"pin {name}").named("rotation")
        for name in ("0-1", "1-2", "0-3", "5-4", "0-5", "7-6", "0-7")
    }
    return START + np.column_stack(list(turned.values()))


def check(result: Result) -> list[Finding]:
    """All angles at 0.03 s, where the run gets there."""
    if result.time[-1] < SHORTEST:
        return []
    off = np.abs(angles_of(result)[-1] - END)
    return [Finding("angles at 0.03 s", float(off.max() / END[0]), 1e-3, 5e-2)]


CASE = Case(
    "Andrews' squeezer",
    "The benchmark of stiff mechanisms: seven bodies, nine redundant pins' rows, accelerations up to 1e6 rad/s2.",
    build, DURATION, check, steps=(1e-6, 1e-5, 1e-4, 1e-3), middle=1e-5, most_steps=30_000, quick=True,
)  # fmt: skip
