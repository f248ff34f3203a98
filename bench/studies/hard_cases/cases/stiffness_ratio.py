r"""Two masses in a row on springs of 1e3 and 1e9 N/m, let go where the soft spring is slack.

    M x'' + K x = (m_1 g, m_2 g),     x(0) = x'(0) = 0,     x = sum_i v_i (v_i . f)/w_i^2 (1 - cos w_i t)

with the M-orthonormal eigenvectors v_i: the exact solution. The stiff vibration has 1e-6 of the amplitude.
"""

from __future__ import annotations

import numpy as np

from studies.hard_cases.case import Case, Finding
from warpffrf.model import forces, joints
from warpffrf.model.scene import Scene
from warpffrf.output.result import Result

MASS, SOFT, STIFF, GRAVITY, SIZE = 1.0, 1e3, 1e9, 9.81, 0.1  # kg, N/m, m/s2, m


def build() -> Scene:
    """The ground, a soft spring, a mass, a stiff spring, a mass, all along z."""
    scene = Scene(gravity=(0.0, 0.0, -GRAVITY))
    above = scene.ground.at((0.0, 0.0, 0.0))
    slides = []
    for i in (1, 2):
        body = scene.add_rigid_body(MASS, (1e-3,) * 3, name=f"mass {i}", position=(0.0, 0.0, -SIZE * i))
        port = body.at((0.0, 0.0, 0.0))
        slides.append(scene.add(joints.Prismatic(scene.ground, port, axis=(0, 0, 1), name=f"guide {i}")))
        scene.add(forces.SpringDamper(above, port, (SOFT, STIFF)[i - 1], name=f"spring {i}"))
        above = port
    return scene


def exact(time: np.ndarray) -> np.ndarray:
    """Displacements (T, 2) [m], downwards."""
    K = np.array([[SOFT + STIFF, -STIFF], [-STIFF, STIFF]])
    w2, V = np.linalg.eigh(K / MASS)
    soft = SOFT / (2.0 * MASS) * (1.0 - SOFT / (4.0 * STIFF))  # w^2 = 5e2 against 2e9: eigh leaves 1e-7 of the latter
    w = np.sqrt(np.array([soft, w2[1]]))
    force = V.T @ np.full(2, MASS * GRAVITY) / MASS
    return (force / w**2 * (1.0 - np.cos(np.outer(time, w)))) @ V.T


def check(result: Result) -> list[Finding]:
    """Both masses against the exact solution, over the largest displacement of it so far."""
    wanted = exact(result.time)
    found = np.column_stack([-SIZE * i - result.body(f"mass {i}").position[:, 2] for i in (1, 2)])
    return [Finding("position", float(np.abs(found - wanted).max() / np.abs(wanted).max()), 1e-3, 5e-2)]


CASE = Case(
    "stiffness ratio",
    "Springs of 1e3 and 1e9 N/m in series: whether the stiff one spoils the slow motion, or its energy grows.",
    build, 0.5, check, quick=True,
)  # fmt: skip
