r"""A hanging chain of 200 links in spherical joints, let go from a straight line 0.01 rad off the vertical.

To first order in the angles u_i of the links (length l, mass m, inertia m l^2/12, all alike) the sideways places of
their ends are x_i = l sum_{j<=i} u_j, and with the tensions

    M u'' + K u = 0,   K = diag(weight below the middle of link i times l),   M from the kinetic energy,

solved exactly by its modes. The next order is the square of the angle, 1e-4.
"""

from __future__ import annotations

import numpy as np
from scipy.linalg import eigh

from studies.hard_cases.case import Case, Finding
from warpffrf.model import joints
from warpffrf.model import rotation as rot
from warpffrf.model.scene import Scene
from warpffrf.output.result import Result

LINKS, LENGTH, MASS, GRAVITY, ANGLE = 200, 0.02, 0.05, 9.81, 0.01  # m, kg, m/s2, rad


def build() -> Scene:
    """The chain in the plane x-z; the inertia about the links' axes is that of thin bars."""
    scene = Scene(gravity=(0.0, 0.0, -GRAVITY))
    down = np.array([np.sin(ANGLE), 0.0, -np.cos(ANGLE)])
    turn = rot.quaternion(rot.rotation_vector_matrix(np.array([0.0, -ANGLE, 0.0])))
    before, across = scene.ground.at((0.0, 0.0, 0.0)), MASS * LENGTH**2 / 12.0
    for i in range(LINKS):
        link = scene.add_rigid_body(
            MASS, (across, across, 0.1 * across), name=f"link {i}", position=(i + 0.5) * LENGTH * down, rotation=turn
        )
        scene.add(joints.Spherical(before, link.at((0.0, 0.0, 0.5 * LENGTH)), name=f"joint {i}"))
        before = link.at((0.0, 0.0, -0.5 * LENGTH))
    return scene


def exact(time: np.ndarray) -> np.ndarray:
    """Sideways place of the lower end (T,) [m], to first order."""
    above = np.tril(np.ones((LINKS, LINKS)), -1) + 0.5 * np.eye(LINKS)  # of a middle: whole links above, half its own
    M = MASS * LENGTH**2 * (above.T @ above + np.eye(LINKS) / 12.0)
    K = np.diag(MASS * GRAVITY * LENGTH * (np.arange(LINKS, 0, -1) - 0.5))
    w2, V = eigh(K, M)
    start = V.T @ M @ np.full(LINKS, ANGLE)
    return LENGTH * V.sum(axis=0) @ (start[:, None] * np.cos(np.sqrt(w2)[:, None] * time))


def check(result: Result) -> list[Finding]:
    """The lower end, over its way at the start."""
    last = result.body(f"link {LINKS - 1}")
    axis = rot.matrix(last.rotation[-1])[:, 2]
    x = last.position[-1, 0] - 0.5 * LENGTH * axis[0]
    error = abs(float(x - exact(result.time[-1:])[0])) / (LINKS * LENGTH * ANGLE)
    return [Finding("lower end", error, 2e-3, 5e-2)]


CASE = Case(
    "chain of 200 bodies",
    "A chain of 200 links in spherical joints swings: 1,200 degrees of freedom, 600 constraints, one path.",
    build, 1.0, check, steps=(1e-6, 1e-5, 1e-4, 1e-3, 1e-2), middle=1e-2, tolerances=(1e-6,), most_steps=300, rows=50,
)  # fmt: skip
