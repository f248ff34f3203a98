"""The same machine in the numbers of SI, and of millimetres, newtons and tonnes: the same answer, but for units.

All equations are homogeneous, so that a solver without hidden lengths, masses or forces gives the same numbers up to
powers of ten, to what the iteration leaves. Lengths are 1e3 times as large, masses and densities per volume 1e-3 and
1e-12, moduli 1e-6, stiffnesses and dampings 1e-3, accelerations 1e3; forces and times are the same. A flexible block on
a guide is pressed by a ball with friction that slides over it; a second ball bounces on a floor and pulls an arm on a
hinge by a spring.

What `reduce` chooses by absolute figures in SI is left out: whether a mesh is coarse, and whether a *curved* surface is
so soft that the leaning of its normals counts (`offline.contact.slopes`); it warns of a density that no solid has.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from studies.hard_cases.case import Case, Finding
from warpffrf.model import forces, joints, laws, signals, surfaces
from warpffrf.model.contact import Contact
from warpffrf.model.lumped_contact import LumpedContact
from warpffrf.model.material import Material
from warpffrf.model.mesh import box
from warpffrf.model.reduced.body import ReducedBody
from warpffrf.model.scene import Scene
from warpffrf.offline import ContactGrid, reduce
from warpffrf.output.result import Result

MM, TONNE = 1e3, 1e-3  # in the numbers of the other system
LOAD, GRAVITY, SLIDES, DURATION = 2e3, 9.81, 4e-3, 0.05  # N, m/s2, m, s
RADIUS, HEIGHT = 0.01, 1e-3  # m, of the ball that bounces


def _steel(length: float, mass: float) -> Material:
    return Material(210e9 * mass / length, 0.3, 7850.0 * mass / length**3, name="steel")


@lru_cache
def _block(length: float, mass: float) -> ReducedBody:
    sides = tuple(s * length for s in (0.02, 0.02, 0.008))
    mesh = box(sides, (10, 10, 3), center=(0.0, 0.0, -0.5 * sides[2]), order=1)
    top = surfaces.Plane(origin=(0.0, 0.0, 0.0), outward=(0.0, 0.0, 1.0), direction=(0.0, 1.0, 0.0))
    return reduce(
        mesh, _steel(length, mass), interfaces={"z_min": "rigid"}, contact={"z_max": top}, modes=4,
        grid=ContactGrid(tangential=True, contact_fixed=False), cache=False, progress=False,
    )  # fmt: skip


def scene_in(length: float, mass: float) -> Scene:
    """The machine in units of 1/length m and 1/mass kg."""
    scene = Scene(gravity=(0.0, 0.0, -GRAVITY * length))
    force, inertia = mass * length, mass * length**2
    block = scene.add_body(_block(length, mass), name="block")
    guide = scene.add(joints.Prismatic(scene.ground, block["z_min"], axis=(0, 0, 1), name="guide"))
    scene.add(forces.JointSpringDamper(guide, stiffness=1e7 * mass, damping=500.0 * mass, name="guide spring"))
    scene.add(forces.PointForce(block["z_min"], (0.0, 0.0, LOAD * force), name="load"))
    at, big = (0.0, 0.0, 0.0), 0.06 * length
    slider = scene.add_rigid_body(
        mass, (1e-3 * inertia,) * 3, name="slider", position=(0.0, 0.0, big),
        surfaces={"face": surfaces.Sphere(radius=big, axis_point=at, axis_direction=(0.0, 1.0, 0.0))},
    )  # fmt: skip
    slide = scene.add(joints.Prismatic(scene.ground, slider.at(at), axis=(1, 0, 0), name="slide"))
    way = signals.SmoothStep(0.0, SLIDES * length, duration=DURATION)
    scene.add(joints.Drive(slide, way, quantity="position"))
    scene.add(Contact(block["z_max"], slider["face"], friction=0.2, name="pair"))
    _bouncing(scene, length, mass)
    return scene


def _bouncing(scene: Scene, length: float, mass: float) -> None:
    """The ball that bounces, and the arm that it pulls."""
    steel, radius, beside = _steel(length, mass), RADIUS * length, 0.2 * length
    own, at = steel.density * 4.0 / 3.0 * np.pi * radius**3, (0.0, 0.0, 0.0)
    ball = scene.add_rigid_body(
        own, (0.4 * own * radius**2,) * 3, name="ball", position=(beside, 0.0, radius + HEIGHT * length),
        surfaces={"skin": surfaces.Sphere(radius=radius, axis_point=at)},
    )  # fmt: skip
    floor = scene.ground.surface(surfaces.Plane(origin=at, outward=(0, 0, 1)), name="floor")
    scene.add(LumpedContact(ball["skin"], floor, law=laws.HertzPoint(steel, steel), friction=0.3, name="bounce"))
    arm = scene.add_rigid_body(
        0.5 * mass, (1e-3 * mass * length**2,) * 3, name="arm", position=(1.5 * beside, 0.0, 0.05 * length)
    )
    scene.add(joints.Revolute(scene.ground, arm.at((-0.5 * beside, 0.0, 0.0)), axis=(0, 1, 0), name="hinge"))
    scene.add(forces.SpringDamper(ball.at(at), arm.at(at), 20.0 * mass, 0.05 * mass, name="spring"))


def build() -> Scene:
    """In millimetres and tonnes."""
    return scene_in(MM, TONNE)


def build_si() -> Scene:
    """In metres and kilograms."""
    return scene_in(1.0, 1.0)


def alike(result: Result, other: Result) -> list[Finding]:
    """Places, forces and energies against the run in SI, over the largest change of each."""
    units = {"place": MM, "force": TONNE * MM, "energy": TONNE * MM**2, "pressure": TONNE / MM}
    pairs = {
        f"place of the {name}": ("place", lambda r, n=name: r.body(n).position) for name in ("block", "ball", "arm")
    }
    pairs |= {
        "contact force": ("force", lambda r: r.history.contacts["pair"].force),
        "peak pressure": ("pressure", lambda r: r.history.contacts["pair"].pressure.max(axis=(1, 2))),
        "force of the bounce": ("force", lambda r: r.lumped_contact("bounce").normal_force),
        "kinetic energy": ("energy", lambda r: r.energy["kinetic"]),
    }
    found = [Finding("times of the rows [s]", float(np.abs(result.time - other.time).max()), 1e-12, 1e-9)]
    for name, (unit, of) in pairs.items():
        a, b = of(result) / units[unit], of(other)
        size = max(float(np.abs(b - b[:1]).max()), 1e-12 * float(np.abs(b).max()))
        found.append(Finding(name, float(np.abs(a - b).max()) / size if size > 0.0 else 0.0, 1e-6, 1e-3))
    return found


CASE = Case(
    "mm-N-t and SI",
    "A machine with contacts in the numbers of mm, N and t, and in those of SI: the same motion but for units.",
    build, DURATION, lambda _: [], twin=build_si, alike=alike, most_steps=3000,
)  # fmt: skip
