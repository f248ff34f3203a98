r"""Sliding blocks that jam: a slide in a guide of length L, pulled along it by a force P, e away from its axis.

The moment P e presses on both ends of the guide with P e/L, friction holds 2 mu P e/L: the slide jams, whatever P,
where mu > L/(2 e), and else goes with (P - 2 mu P e/L)/m. Slides on either side of that bound, and a wedge between two
planes at the angle beta to its way, pushed by P: normal forces N on both, P = 2 N (sin beta + mu cos beta), and when
the push is gone it springs out only where mu < tan beta.
"""

from __future__ import annotations

import numpy as np

from studies.hard_cases.case import Case, Finding
from warpffrf.model import forces, joints, laws, signals, surfaces
from warpffrf.model.lumped_contact import LumpedContact
from warpffrf.model.material import Material
from warpffrf.model.scene import Scene
from warpffrf.output.result import Result

STEEL = Material(210e9, 0.3, 7800.0, name="steel")
MASS, INERTIA, PULL, ARM, FRICTION = 1.0, 0.01, 50.0, 0.5, 0.2  # kg, kg m2, N, m
LENGTHS = (0.1, 0.19, 0.21, 0.4)  # m: L/(2 e) is 0.1, 0.19, 0.21, 0.4
HELD = 1e-4  # m
RADIUS, ANGLE, PUSH, PUSHED = 0.01, 0.1, 500.0, 0.01  # m, rad, N, s
WEDGES = (0.05, 0.3)  # coefficients: springs out, stays
OUT = 1e-3  # m: a wedge that has come out


def build() -> Scene:
    """Four slides and two wedges that do not know of each other."""
    scene = Scene()
    for i, length in enumerate(LENGTHS):
        slide = scene.add_rigid_body(MASS, (INERTIA,) * 3, name=f"slide {i}", position=(0.0, float(i), 0.0))
        port = slide.at((0.0, 0.0, 0.0))
        guide = scene.add(joints.Prismatic(scene.ground, port, axis=(1, 0, 0), name=f"guide {i}"))
        scene.add(forces.PrismaticFriction(guide, FRICTION, bearing_length=length, name=f"friction {i}"))
        scene.add(forces.PointForce(slide.at((0.0, 0.0, ARM)), (PULL, 0.0, 0.0), name=f"pull {i}"))
    mass = STEEL.density * 4.0 / 3.0 * np.pi * RADIUS**3
    push = signals.SmoothStep(PUSH, 0.0, duration=0.5 * PUSHED, delay=0.5 * PUSHED)
    for i, mu in enumerate(WEDGES):
        at = np.array([0.0, 10.0 + i, 0.0])
        skin = surfaces.Sphere(radius=RADIUS, axis_point=(0.0, 0.0, 0.0))
        ball = scene.add_rigid_body(
            mass, (0.4 * mass * RADIUS**2,) * 3, name=f"wedge {i}", position=at, surfaces={"skin": skin}
        )
        port = ball.at((0.0, 0.0, 0.0))
        scene.add(joints.Prismatic(scene.ground, port, axis=(1, 0, 0), name=f"way {i}"))
        scene.add(forces.PointForce(port, (push, (-1.0, 0.0, 0.0)), name=f"push {i}"))
        for side in (-1.0, 1.0):
            outward = np.array([np.sin(ANGLE), 0.0, -side * np.cos(ANGLE)])
            wall = surfaces.Plane(origin=at - RADIUS * outward, outward=outward)
            port_wall = scene.ground.surface(wall, name=f"wall {i} {side:+g}")
            scene.add(
                LumpedContact(
                    ball["skin"],
                    port_wall,
                    law=laws.HertzPoint(STEEL, STEEL),
                    friction=mu,
                    name=f"on wall {i} {side:+g}",
                )
            )
    return scene


def check(result: Result) -> list[Finding]:
    """Ways of the slides; whether wedges have sprung out."""
    t, slid, held = float(result.time[-1]), 0.0, 0.0
    for i, length in enumerate(LENGTHS):
        way = float(np.diff(result.body(f"slide {i}").position[[0, -1], 0])[0])
        acceleration = PULL * (1.0 - 2.0 * FRICTION * ARM / length) / MASS
        if acceleration > 0.0:
            slid = max(slid, abs(way / (0.5 * acceleration * t**2) - 1.0))
        else:
            held = max(held, abs(way))
    found = [
        Finding("way of slides", slid, 1e-2, 1e-1),
        Finding("way of jammed ones [0.1 mm]", held / HELD, 1e-2, 1e-1),
    ]
    if t > 2.0 * PUSHED:
        x = [float(result.body(f"wedge {i}").position[-1, 0]) for i in range(2)]
        found.append(Finding("wedge that springs out has stayed", float(x[0] < OUT), 0.5, 0.5))
        found.append(Finding("wedge that stays has come out", float(abs(x[1]) > OUT), 0.5, 0.5))
    return found


CASE = Case(
    "a wedge that jams",
    "Slides that jam by their own friction, and wedges that stay or spring out when the push is gone.",
    build, 0.05, check, middle=1e-4, quick=True, most_steps=5000,
)  # fmt: skip
