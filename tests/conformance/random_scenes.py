"""Random scenes, each of which can be built anywhere: rotated, shifted, and drifting as a whole."""

from __future__ import annotations

import functools
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from hypothesis import strategies as st
from joint_scenes import KINDS, make_joint

from scenes.rollers import roller_body
from warpffrf.model import forces, joints, laws, signals, surfaces
from warpffrf.model import rotation as rot
from warpffrf.model.contact import Contact
from warpffrf.model.material import Material
from warpffrf.model.reduced.body import ReducedBody
from warpffrf.model.scene import Scene

GROUND = -1
NUMBERS = st.integers(0, 2**20)  # seeds of what is drawn evenly

SECOND = {"universal": "second_axis", "line_in_plane": "line"}  # directions that are perpendicular to the axis


@dataclass(frozen=True)
class Place:
    """Where a scene is built: rotated by `turn` (3, 3), shifted by `shift` [m], drifting with `drift` [m/s]."""

    turn: np.ndarray = field(default_factory=lambda: np.eye(3))
    shift: np.ndarray = field(default_factory=lambda: np.zeros(3))
    drift: np.ndarray = field(default_factory=lambda: np.zeros(3))

    def point(self, x: Any) -> np.ndarray:
        return self.turn @ np.asarray(x, float) + self.shift

    def vector(self, u: Any) -> np.ndarray:
        return self.turn @ np.asarray(u, float)

    def velocity(self, v: Any) -> np.ndarray:
        return self.vector(v) + self.drift

    def rotation(self, A: np.ndarray) -> np.ndarray:
        return rot.quaternion(self.turn @ A)


HERE = Place()


def any_turn(rng: np.random.Generator) -> np.ndarray:
    """A random rotation matrix (3, 3)."""
    axis = rng.normal(size=3)
    return rot.rotation_vector_matrix(rng.uniform(0.0, np.pi) * axis / np.linalg.norm(axis))


@st.composite
def elsewhere(draw: st.DrawFn) -> Place:
    rng = np.random.default_rng(draw(NUMBERS))
    return Place(any_turn(rng), rng.uniform(-1.0, 1.0, 3))


@st.composite
def drifting(draw: st.DrawFn) -> Place:
    return Place(drift=np.random.default_rng(draw(NUMBERS)).uniform(-2.0, 2.0, 3))


# --- rigid bodies


@dataclass(frozen=True)
class Mechanism:
    """Rigid bodies that move: `links` has of each the body before it that it hangs on, or the ground, and the kind of
    joint, "" for none; `elements` have a kind each and two bodies, of a load the second counts."""

    seed: int
    links: tuple[tuple[int, str], ...]
    elements: tuple[tuple[str, int, int], ...]
    weight: bool
    driven: bool  # the first joint that can be

    def build(self, at: Place = HERE) -> Scene:
        rng = np.random.default_rng(self.seed)
        scene = Scene(gravity=at.vector(6.0 * self.weight * rng.normal(size=3)))
        near = [np.zeros(3)]  # a place that each body is at, the ground first
        for i in range(len(self.links)):
            near.append(np.array([0.3 * (i + 1), 0.0, 0.0]) + rng.uniform(-0.1, 0.1, 3))
            mass, center, inertia = lump(rng)
            scene.add_rigid_body(
                mass, inertia, name=f"body {i}", center_of_mass=center, position=at.point(near[-1]),
                rotation=at.rotation(any_turn(rng)), velocity=at.velocity(rng.normal(size=3)),
                angular_velocity=at.vector(3.0 * rng.normal(size=3)),
            )  # fmt: skip

        def port(body: int, x: np.ndarray) -> Any:
            owner: Any = scene.ground if body == GROUND else scene.bodies[body]
            return owner.at(at.point(x) if body == GROUND else owner.to_user(at.point(x)))

        for i, (before, kind) in enumerate(self.links):
            x = 0.5 * (near[i + 1] + near[before + 1]) + rng.uniform(-0.1, 0.1, 3)
            away = rng.uniform(0.1, 0.3, 3) if kind == "distance" else np.zeros(3)
            axis, across, _ = any_turn(rng)
            axes = {"axis": at.vector(axis)} if kind not in ("spherical", "distance") else {}
            axes |= {SECOND[kind]: at.vector(across)} if kind in SECOND else {}
            if kind:
                scene.add(make_joint(kind, port(before, x), port(i, x + away), **axes, name=f"joint {i}"))
        free = [(j, c) for j in scene.joints for c, row in j.coordinates.items() if row not in j.rows]
        for kind, a, b in self.elements:
            x, y = (near[body + 1] + rng.uniform(-0.2, 0.2, 3) for body in (a, b))
            make(scene, kind, port(a, x), port(b, x), port(b, y), free, at, rng)
        if self.driven and free:
            joint, coordinate = free[0]
            signal = signals.SmoothStep(0.0, rng.uniform(-2.0, 2.0), duration=0.03)
            scene.add(joints.Drive(joint, signal, quantity="velocity", coordinate=coordinate))
        return scene


def lump(rng: np.random.Generator) -> tuple[float, np.ndarray, np.ndarray]:
    """Mass [kg], centre [m] and inertia about it [kg m2] of six point masses."""
    m, x = rng.uniform(0.1, 0.4, 6), rng.uniform(-0.2, 0.2, (6, 3))
    center = m @ x / m.sum()
    y = x - center
    return float(m.sum()), center, np.sum(m * np.sum(y**2, axis=1)) * np.eye(3) - (y.T * m) @ y


ELEMENTS = (
    "spring_damper", "bushing", "bearing", "joint_spring_damper", "characteristics", "point_force", "point_torque",
)  # fmt: skip


def make(scene: Scene, kind: str, a: Any, b: Any, far: Any, free: list, at: Place, rng: np.random.Generator) -> None:
    """A force element at the ports a and b of two bodies that meet, or from a to `far`, or on one of the coordinates
    that joints leave `free`.
    """
    k, A, axes = rng.uniform(20.0, 200.0), rng.normal(size=(6, 6)), any_turn(rng)
    if kind == "spring_damper":
        scene.add(forces.SpringDamper(a, far, k, 0.01 * k))
    elif kind == "bushing":
        scene.add(forces.Bushing(a, b, 5.0 * A @ A.T, 0.02 * A @ A.T, axes=at.turn @ axes, preload=rng.normal(size=6)))
    elif kind == "bearing":
        scene.add(
            forces.BearingSpring(
                a, b, axis=at.vector(axes[0]), radial=k, axial=0.5 * k, tilt=0.05 * k, radial_tilt=0.1 * k,
                radial_damping=0.01 * k, tilt_damping=0.001 * k,
                spin_damping=0.001 * k,
            )
        )  # fmt: skip
    elif kind == "characteristics":
        hard, drag = forces.ForcePolynomial([k, 0.0, 5.0 * k]), forces.PowerLaw(0.001 * k, 2.0)
        scene.add(forces.SpringDamper(a, far, hard, drag))
        scene.add(forces.Bushing(a, b, [hard, k, k, hard, k, k], [drag] * 6, axes=at.turn @ axes))
    elif kind == "point_force":
        scene.add(forces.PointForce(far, at.vector(5.0 * rng.normal(size=3))))
    elif kind == "point_torque":
        scene.add(forces.PointTorque(far, rng.normal(size=3), frame="body"))
    elif free:
        joint, coordinate = free[rng.integers(len(free))]
        scene.add(forces.JointSpringDamper(joint, k, 0.01 * k, coordinate=coordinate))


@st.composite
def mechanisms(draw: st.DrawFn, *, grounded: bool = True) -> Mechanism:
    """One to four bodies in a tree of joints, some of them free; else none that hangs on the ground."""
    count = draw(st.integers(1 if grounded else 2, 4))
    first = GROUND if grounded else 0
    links = [(draw(st.integers(first, max(i - 1, first))), draw(st.sampled_from(["", *KINDS]))) for i in range(count)]
    if not grounded:
        links[0] = (GROUND, "")
    ends = st.tuples(st.integers(first, count - 1), st.integers(0, count - 1)).filter(lambda pair: pair[0] != pair[1])
    elements = draw(st.lists(st.tuples(st.sampled_from(ELEMENTS), ends), max_size=3))
    flat = tuple((kind, a, b) for kind, (a, b) in elements)
    return Mechanism(draw(NUMBERS), tuple(links), flat, draw(st.booleans()), draw(st.booleans()))


# --- a roller that something hits

PLASTIC = Material(3e9, 0.35, 1200.0)  # patches of several nodes at small loads
RADIUS, OTHER, WIDTH, THICK = 0.05, 0.035, 0.02, 0.01  # m
LAWS: dict[str, Any] = {
    "hard": laws.Unilateral(),
    "linear": laws.LinearLayer(1e13),
    "damped": laws.HuntCrossley(1e14, 1.2, damping=1.0),
    "rough": laws.ExponentialAsperities(1e6, 3e-6),
}
ACROSS: Any = {"axis_point": (0.0, 0.0, 0.0), "axis_direction": (0.0, 1.0, 0.0)}
RIGID: dict[str, Any] = {
    "rigid roller": surfaces.Cylinder(radius=OTHER, **ACROSS),
    "ball": surfaces.Sphere(radius=OTHER, **ACROSS),
    "block": surfaces.Plane(origin=(THICK, 0.0, 0.0), outward=(1.0, 0.0, 0.0), direction=(0.0, 1.0, 0.0)),
}


@functools.cache
def flexible(radius: float, sectors: int) -> ReducedBody:
    return roller_body(
        sectors, layers=2, axial=4, grading=1.6, order=1, outer_radius=radius, width=WIDTH, max_frequency=6e3,
        material=PLASTIC, tangential=True, cache=False,
    )  # fmt: skip


@dataclass(frozen=True)
class Impact:
    """A flexible roller that spins, and a partner that comes in from the side, both free; axes are skew by
    milliradians."""

    seed: int
    partner: str
    law: str
    friction: float
    swapped: bool  # the partner is the first of the pair, where it is flexible

    def build(self, at: Place = HERE) -> Scene:
        rng = np.random.default_rng(self.seed)
        scene = Scene(gravity=at.vector(6.0 * rng.normal(size=3)))
        spin, drift = 4.0 * rng.normal(size=(2, 3)) * (0.2, 1.0, 0.2), 0.03 * rng.normal(size=(2, 3))
        around, turned = rng.uniform(0.0, 2.0 * np.pi, 2)
        out = np.array([np.cos(around), 0.0, np.sin(around)])
        skew = rot.rotation_vector_matrix(1e-3 * rng.uniform(-1.0, 1.0, 3))
        inwards = np.stack([-out, [0.0, 1.0, 0.0], np.cross(-out, [0.0, 1.0, 0.0])], axis=1)
        reach = RADIUS + (THICK if self.partner == "block" else OTHER) + 2e-6
        roller = scene.add_body(
            flexible(RADIUS, 240), name="roller", position=at.point(np.zeros(3)),
            rotation=at.rotation(rot.rotation_vector_matrix(np.array([0.0, turned, 0.0]))),
            velocity=at.velocity(drift[0]), angular_velocity=at.vector(spin[0]), inertia="constant",
        )  # fmt: skip
        motion: dict[str, Any] = {
            "name": "partner", "position": at.point(reach * out + (0.0, rng.uniform(-0.3, 0.3) * WIDTH, 0.0)),
            "rotation": at.rotation(skew @ inwards), "velocity": at.velocity(drift[1] - rng.uniform(0.6, 1.0) * out),
            "angular_velocity": at.vector(spin[1]),
        }  # fmt: skip
        if self.partner == "flexible":
            port = scene.add_body(flexible(OTHER, 180), inertia="constant", **motion)["rim"]
        else:
            body = scene.add_rigid_body(0.5, (2e-4, 3e-4, 2e-4), center_of_mass=(0.001, 0.002, -0.001), **motion)
            port = body.surface(RIGID[self.partner], name="face")
        ends = (port, roller["rim"]) if self.swapped and self.partner == "flexible" else (roller["rim"], port)
        scene.add(Contact(*ends, law=LAWS[self.law], friction=self.friction, name="pair"))
        return scene


def impacts() -> st.SearchStrategy[Impact]:
    partners = st.sampled_from(("flexible", *RIGID))
    return st.builds(Impact, NUMBERS, partners, st.sampled_from(list(LAWS)), st.sampled_from((0.0, 0.3)), st.booleans())
