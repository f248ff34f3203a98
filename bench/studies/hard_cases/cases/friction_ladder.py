r"""Blocks on slopes with coefficients of friction from 0 to 10.

A block with the coefficient mu on the slope alpha stays where tan(alpha) <= mu, else it slides with
g (sin(alpha) - mu cos(alpha)), once it has stretched the spring k of what sticks:

    x = (g sin(alpha)/w^2) (1 - cos w t),  w^2 = k/m,    until cos w t = 1 - mu/tan(alpha);    then a parabola.

Each pair (mu, alpha) is a ball that hardly rotates for its inertia, on a plane of its
own, so that one scene holds them all. They are put down at their depth at rest.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from studies.hard_cases.case import Case, Finding
from warpffrf.model import laws, surfaces
from warpffrf.model.lumped_contact import LumpedContact
from warpffrf.model.material import Material
from warpffrf.model.scene import Scene
from warpffrf.output.result import Result

STEEL = Material(210e9, 0.3, 7800.0, name="steel")
RADIUS, GRAVITY = 0.01, 9.81
MASS, INERTIA = STEEL.density * 4.0 / 3.0 * np.pi * RADIUS**3, 1e3  # kg, kg m2
K = 4.0 / 3.0 * 0.5 * STEEL.plane_strain_modulus * np.sqrt(RADIUS)
BLOCKS = (  # coefficient, slope [rad]
    (0.0, 0.3), (0.1, 0.05), (0.1, 0.3), (0.5, 0.4), (0.5, 0.6), (1.0, 0.7), (1.0, 0.9), (3.0, 1.2), (3.0, 1.3),
    (10.0, 1.4), (10.0, 1.5),
)  # fmt: skip
HELD = 1e-4  # m: a tangential spring that is stretched, swinging, is a thousandth of it


def build() -> Scene:
    """One ball and plane for each block; gravity points down, the planes lean."""
    scene = Scene(gravity=(0.0, 0.0, -GRAVITY))
    for i, (mu, slope) in enumerate(BLOCKS):
        normal, at = np.array([np.sin(slope), 0.0, np.cos(slope)]), np.array([0.0, 0.1 * i, 0.0])
        depth = (MASS * GRAVITY * np.cos(slope) / K) ** (2.0 / 3.0)
        skin = surfaces.Sphere(radius=RADIUS, axis_point=(0.0, 0.0, 0.0))
        ball = scene.add_rigid_body(
            MASS, (INERTIA,) * 3, name=f"block {i}", position=at + (RADIUS - depth) * normal, surfaces={"skin": skin}
        )
        plane = scene.ground.surface(surfaces.Plane(origin=at, outward=normal), name=f"slope {i}")
        scene.add(LumpedContact(ball["skin"], plane, law=laws.HertzPoint(STEEL, STEEL), friction=mu, name=f"pair {i}"))
    return scene


def way(mu: float, slope: float, stiffness: float, t: float) -> float:
    """How far a block that slides has come [m], with the stiffness [N/m] of what sticks."""
    g, w = GRAVITY * np.sin(slope), float(np.sqrt(stiffness / MASS))
    breaks = float(np.arccos(1.0 - mu / np.tan(slope))) / w if mu < 2.0 * np.tan(slope) else np.inf
    stuck = min(t, breaks)
    x, v = g / w**2 * (1.0 - np.cos(w * stuck)), g / w * np.sin(w * stuck)
    rest = t - stuck
    return float(x + v * rest + 0.5 * GRAVITY * (np.sin(slope) - mu * np.cos(slope)) * rest**2)


def check(result: Result) -> list[Finding]:
    """Ways down the slopes: of those that slide over the exact way, of those that stay over HELD."""
    t, slid, held = float(result.time[-1]), 0.0, 0.0
    scene: Any = result.history.scene
    for i, (mu, slope) in enumerate(BLOCKS):
        down = np.array([np.cos(slope), 0.0, -np.sin(slope)])
        x = result.body(f"block {i}").position
        found = float((x[-1] - x[0]) @ down)
        if np.tan(slope) > mu:
            law = scene.lumped_contacts[i].approach()
            depth = (MASS * GRAVITY * np.cos(slope) / K) ** (2.0 / 3.0)
            exact = way(mu, slope, law.shear * 1.5 * K * np.sqrt(depth), t)
            slid = max(slid, abs(found / exact - 1.0))
        else:
            held = max(held, abs(found))
    return [
        Finding("way of those that slide", slid, 1e-2, 1e-1),
        Finding("way of those that stay [0.1 mm]", held / HELD, 1e-2, 1e-1),
    ]


CASE = Case(
    "friction from 0 to 10",
    "Blocks on slopes with coefficients from 0 to 10, on either side of the slope at which they slide.",
    build, 0.1, check, middle=1e-4, quick=True, most_steps=5000,
)  # fmt: skip
