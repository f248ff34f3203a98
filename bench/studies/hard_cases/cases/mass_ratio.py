r"""A pendulum of a light link, 1 g, with a bob of 1 t at its end, in a joint each: the light body is a body.

Independent: the two links in minimal coordinates, absolute angles t_1, t_2 from the vertical, rods with their centres
of mass in the middle, length L, inertia m L^2/12 (the equations of `tests/verification/test_mechanisms`), by an
eighth-order Runge-Kutta method. The light link has no motion of its own that is slow: the ratio of frequencies is the
root of that of the masses.
"""

from __future__ import annotations

import numpy as np
from scipy.integrate import solve_ivp

from studies.hard_cases.case import Case, Finding
from warpffrf.model import joints
from warpffrf.model import rotation as rot
from warpffrf.model.scene import Scene
from warpffrf.output.result import Result

LIGHT, HEAVY, LENGTH, GRAVITY = 1e-3, 1e3, 0.5, 9.81  # kg, m, m/s2
START = np.array([0.8, 0.8, 0.0, 0.0])  # rad, rad/s: in one line, so that the heavy mass swings as one pendulum


def _link(mass: float) -> float:
    return mass * LENGTH**2 / 12.0


def build() -> Scene:
    """Two rods hanging from the ground."""
    scene = Scene(gravity=(0.0, 0.0, -GRAVITY))
    down = np.array([np.sin(START[0]), 0.0, -np.cos(START[0])])
    turn = rot.quaternion(rot.rotation_vector_matrix(np.array([0.0, -START[0], 0.0])))
    half = 0.5 * LENGTH
    bodies = []
    for name, mass, at in (("light", LIGHT, half), ("heavy", HEAVY, 3.0 * half)):
        bodies.append(scene.add_rigid_body(mass, (_link(mass),) * 3, name=name, position=at * down, rotation=turn))
    light, heavy = bodies
    scene.add(joints.Revolute(scene.ground, light.at((0, 0, half)), axis=(0, -1, 0), name="upper"))
    scene.add(joints.Revolute(light.at((0, 0, -half)), heavy.at((0, 0, half)), axis=(0, -1, 0), name="lower"))
    return scene


def exact(time: np.ndarray) -> np.ndarray:
    """Absolute angles (T, 2) [rad]."""
    m1, m2, a, J1, J2 = LIGHT, HEAVY, 0.5 * LENGTH, _link(LIGHT), _link(HEAVY)

    def rates(_: float, y: np.ndarray) -> np.ndarray:
        c, s = np.cos(y[0] - y[1]), np.sin(y[0] - y[1])
        M = np.array([[J1 + m1 * a**2 + m2 * LENGTH**2, m2 * LENGTH * a * c], [m2 * LENGTH * a * c, J2 + m2 * a**2]])
        f = np.array([
            -m2 * LENGTH * a * s * y[3] ** 2 - (m1 * a + m2 * LENGTH) * GRAVITY * np.sin(y[0]),
            m2 * LENGTH * a * s * y[2] ** 2 - m2 * a * GRAVITY * np.sin(y[1]),
        ])  # fmt: skip
        return np.array([y[2], y[3], *np.linalg.solve(M, f)])

    span = (0.0, max(float(time[-1]), 1e-12))
    return solve_ivp(rates, span, START, method="DOP853", t_eval=time, rtol=1e-11, atol=1e-13).y[:2].T


def check(result: Result) -> list[Finding]:
    """Angles against the integration, over the swing."""
    first = START[0] + result.joint("upper").coordinate
    found = np.column_stack([first, first + result.joint("lower").coordinate])
    wanted = exact(result.time)
    return [Finding("angles", float(np.abs(found - wanted).max() / START[0]), 1e-3, 5e-2)]


CASE = Case(
    "mass ratio",
    "A link of 1 g carries a rod of 1 t in revolute joints: masses of 1e6 to 1 in one constrained system.",
    build, 1.0, check, middle=1e-3, quick=True,
)  # fmt: skip
