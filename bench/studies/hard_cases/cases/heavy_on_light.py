r"""A ball of 1 t let go on one of 1 g, which lies on the floor: Hertz's contact twice, masses of 1e6 to 1.

The light ball has next to no inertia, and the two contacts are springs in series. With the forces K_i a_i^(3/2) they
give way by a = a_1 + a_2 under one force, K = (K_1^(-2/3) + K_2^(-2/3))^(-3/2), so that the heavy ball moves by

    M x'' = M g - K x^(3/2),     x(0) = x'(0) = 0,

integrated by an eighth-order Runge-Kutta method. What the light ball does besides is faster by a thousand.
"""

from __future__ import annotations

import numpy as np
from scipy.integrate import solve_ivp

from studies.hard_cases.case import Case, Finding
from warpffrf.model import joints, laws, surfaces
from warpffrf.model.lumped_contact import LumpedContact
from warpffrf.model.material import Material
from warpffrf.model.scene import Scene
from warpffrf.output.result import Result

STEEL = Material(210e9, 0.3, 7800.0, name="steel")
HEAVY, LIGHT, LARGE, SMALL, GRAVITY = 1e3, 1e-3, 0.1, 0.005, 9.81  # kg, m, m/s2


def build() -> Scene:
    """Two balls above each other on guides, just touching."""
    scene = Scene(gravity=(0.0, 0.0, -GRAVITY))
    below = scene.ground.surface(surfaces.Plane(origin=(0, 0, 0), outward=(0, 0, 1)), name="floor")
    height = 0.0
    for name, mass, radius in (("light", LIGHT, SMALL), ("heavy", HEAVY, LARGE)):
        skin = surfaces.Sphere(radius=radius, axis_point=(0.0, 0.0, 0.0))
        inertia = (0.4 * mass * radius**2,) * 3
        place = (0.0, 0.0, height + radius)
        ball = scene.add_rigid_body(mass, inertia, name=name, position=place, surfaces={"skin": skin})
        scene.add(joints.Prismatic(scene.ground, ball.at((0.0, 0.0, 0.0)), axis=(0, 0, 1), name=f"{name} guide"))
        scene.add(LumpedContact(ball["skin"], below, law=laws.HertzPoint(STEEL, STEEL), name=f"under {name}"))
        below, height = ball["skin"], height + 2.0 * radius
    return scene


def exact(time: np.ndarray) -> np.ndarray:
    """How far the heavy ball has come down (T,) [m]."""
    modulus = 0.5 * STEEL.plane_strain_modulus
    radii = SMALL, SMALL * LARGE / (SMALL + LARGE)
    K = sum((4.0 / 3.0 * modulus * np.sqrt(R)) ** (-2.0 / 3.0) for R in radii) ** -1.5
    found = solve_ivp(
        lambda _, y: [y[1], GRAVITY - K / HEAVY * max(y[0], 0.0) ** 1.5], (0.0, max(time[-1], 1e-12)), (0.0, 0.0),
        method="DOP853", t_eval=time, rtol=1e-10, atol=1e-15,
    )  # fmt: skip
    return found.y[0]


def check(result: Result) -> list[Finding]:
    """The way of the heavy ball, over the largest so far."""
    wanted, z = exact(result.time), result.body("heavy").position[:, 2]
    size = max(float(wanted.max()), 1e-12)
    return [Finding("way down", float(np.abs((z[0] - z) - wanted).max()) / size, 5e-3, 5e-2)]


CASE = Case(
    "heavy on light",
    "A ball of 1 t is let go on a ball of 1 g: contacts in series with next to no mass between them.",
    build, 0.05, check, middle=1e-5, most_steps=20_000, quick=True,
)  # fmt: skip
