"""The two rollers of the studies: bodies, and a pair with prescribed approach and angles.

A prescribed pair has no dynamics: the lower axle is fixed, the upper one sits in a carriage on a vertical guide, and
guide and axles follow tables of a path parameter that replaces time. State `i` of the path is the static state
at `time = i`; it is computed from its neighbour, so that neighbours should be close together.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from warpffrf.model import forces, joints, signals
from warpffrf.model import rotation as rot
from warpffrf.model.contact import Contact
from warpffrf.model.material import Material
from warpffrf.model.mesh import roller
from warpffrf.model.reduced.body import ReducedBody
from warpffrf.model.scene import Scene
from warpffrf.model.surfaces import CrownedCylinder, Cylinder
from warpffrf.offline import ContactGrid, reduce
from warpffrf.online import Engine, History, Settings
from warpffrf.online.history.record import history_from_rows
from warpffrf.online.outcome import describe
from warpffrf.output.result import Result

STEEL = Material(210e9, 0.3, 7850.0, name="steel")
PAIR = "lower-upper"  # name of the contact pair
CARRIAGE_MASS = 5.0  # kg
CARRIAGE_INERTIA = (0.01, 0.01, 0.01)  # kg m2; it never rotates
# s: the proximal term is then 1e-9 of the stiffness of a steel bore, and the joint equations stay well conditioned
STATIC_STEP = 1.0
CORRECTIONS = 2  # static solves per state: the second removes the residual of the joints (1e-9 m) and the proximal term


def roller_body(
    sectors: int,
    *,
    layers: int = 10,
    axial: int = 4,
    grading: float = 1.3,
    order: int = 1,
    outer_radius: float = 0.05,
    inner_radius: float = 0.015,
    width: float = 0.02,
    crown_radius: float | None = None,
    max_frequency: float | None = 20e3,
    modes: int | None = None,
    material: Material = STEEL,
    tangential: bool = False,
    contact_fixed: bool = False,
    cache: bool = True,
) -> ReducedBody:
    """A hollow roller (lengths in m, frequencies in Hz) with a rigid bore and a contact rim, reduced for pressures on
    its contact grid, with `contact_fixed` on contact-fixed cells; tangential: for friction."""
    mesh = roller(
        outer_radius, inner_radius, width, crown_radius=crown_radius, sectors=sectors, layers=layers, axial=axial,
        grading=grading, order=order,
    )  # fmt: skip
    shape = Cylinder() if crown_radius is None else CrownedCylinder(crown_radius=crown_radius)
    limit = max_frequency if modes is None else None
    return reduce(
        mesh, material, interfaces={"bore": "rigid"}, contact={"rim": shape}, max_frequency=limit, modes=modes,
        grid=ContactGrid(tangential=tangential, contact_fixed=contact_fixed), cache=cache, progress=False,
    )  # fmt: skip


@dataclass(frozen=True, eq=False)
class Path:
    """Prescribed states of a pair, all (n,): approach [m] from first touch, and angles of the two rollers [rad]."""

    approach: np.ndarray
    first: np.ndarray
    second: np.ndarray

    @classmethod
    def of(cls, approach: Any, first: Any = 0.0, second: Any = 0.0) -> Path:
        """The path with numbers repeated to the length of the arrays."""
        a, b, c = np.broadcast_arrays(np.atleast_1d(np.asarray(approach, float)), first, second)
        return cls(a.copy(), b.astype(float), c.astype(float))

    def __len__(self) -> int:
        return len(self.approach)


def _stacked(
    scene: Scene, first: ReducedBody, second: ReducedBody, tilt: float, friction: Any = 0.0
) -> tuple[Any, Any, Contact]:
    """Two rollers above each other along z, touching; `tilt` [rad] rotates the upper one's axis about x."""
    radii = sum(b.contact_surfaces["rim"].shape.radius for b in (first, second))
    rotation = (np.sin(0.5 * tilt), 0.0, 0.0, np.cos(0.5 * tilt))
    lower = scene.add_body(first, name="lower")
    upper = scene.add_body(second, name="upper", position=(0.0, 0.0, radii), rotation=rotation)
    contact = Contact(lower["rim"], upper["rim"], friction=friction)
    scene.add(contact)
    scene.close_gap(contact, along=(0.0, 0.0, 1.0))
    return lower, upper, contact


def prescribed_pair(first: ReducedBody, second: ReducedBody, path: Path, *, tilt: float = 0.0) -> Scene:
    """The pair on prescribed axles; state i of `path` at time i. tilt [rad] rotates the upper axle about x."""
    scene = Scene()
    lower, upper, _ = _stacked(scene, first, second, tilt)
    place = upper["bore"].world_point()
    carriage = scene.add_rigid_body(CARRIAGE_MASS, CARRIAGE_INERTIA, name="carriage", position=place)
    center = carriage.at((0.0, 0.0, 0.0))
    upper_axis = rot.matrix(upper.rotation) @ np.array([0.0, 1.0, 0.0])
    axle = scene.add(joints.Revolute(scene.ground, lower["bore"], axis=(0, 1, 0), name="axle"))
    guide = scene.add(joints.Prismatic(scene.ground, center, axis=(0, 0, 1), name="guide"))
    upper_axle = scene.add(joints.Revolute(center, upper["bore"], axis=upper_axis, name="upper_axle"))
    times = np.arange(len(path) + 1.0)
    for joint, values in ((guide, -path.approach), (axle, path.first), (upper_axle, path.second)):
        table = signals.Table(times, np.append(values, values[-1]))
        scene.add(joints.Drive(joint, table, quantity="position"))
    return scene


def guided_pair(
    first: ReducedBody,
    second: ReducedBody,
    *,
    load: Any = 20e3,
    stiffness: float = 2e6,
    damping: float = 2e3,
    gap: float = 0.0,
    speed: float | None = None,
    ramp: float = 0.02,
    gravity: float = 9.81,
    carriage_mass: float = CARRIAGE_MASS,
    friction: Any = 0.0,
) -> Scene:
    """The upper roller on a sprung vertical guide, pressed down by `load` [N, number or signal of the force along -z].

    stiffness [N/m], damping [N s/m] of the guide, gap [m] at the start, speed [rad/s] of both rollers, equal and
    opposite, reached smoothly within `ramp` [s]; None leaves the axles free. friction: of the pair.
    """
    scene = Scene(gravity=(0.0, 0.0, -gravity))
    lower, upper, contact = _stacked(scene, first, second, 0.0, friction)
    if gap:
        scene.close_gap(contact, along=(0.0, 0.0, 1.0), gap=gap)
    place = upper["bore"].world_point()
    carriage = scene.add_rigid_body(carriage_mass, CARRIAGE_INERTIA, name="carriage", position=place)
    center = carriage.at((0.0, 0.0, 0.0))
    axle = scene.add(joints.Revolute(scene.ground, lower["bore"], axis=(0, 1, 0), name="axle"))
    guide = scene.add(joints.Prismatic(scene.ground, center, axis=(0, 0, 1), name="guide"))
    upper_axle = scene.add(joints.Revolute(center, upper["bore"], axis=(0, 1, 0), name="upper_axle"))
    if speed is not None:
        for joint, sense in ((axle, 1.0), (upper_axle, -1.0)):
            scene.add(joints.Drive(joint, signals.SmoothStep(0.0, sense * speed, duration=ramp), quantity="velocity"))
    if stiffness or damping:
        scene.add(forces.JointSpringDamper(guide, stiffness, damping))
    scene.add(forces.PointForce(center, (load, (0.0, 0.0, -1.0))))
    return scene


class StaticPath:
    """Static states of a scene at the times 0, 1, 2, ...: the states of a prescribed pair."""

    def __init__(self, scene: Scene, *, settings: Settings | None = None) -> None:
        self.engine = Engine(scene, settings=settings)

    def solve(self, count: int) -> History:
        """History of the states at times 0 to count - 1; stops at the first that fails, with its status."""
        engine = self.engine
        for i in range(count):
            engine.rates_to_zero()
            engine.clock(time=float(i))
            for _ in range(CORRECTIONS):
                engine.static_step(STATIC_STEP)
            if engine.word("status")[0]:
                break
            engine.save_now()
        history = history_from_rows(engine.compiled, engine.saved())
        history.status, history.message = describe(int(engine.word("status")[0]), int(engine.word("spare")[0]))
        return history


def solve_path(
    first: ReducedBody, second: ReducedBody, path: Path, *, tilt: float = 0.0, settings: Settings | None = None
) -> Result:
    """Static states of a prescribed pair along `path`, one row per state."""
    return Result(StaticPath(prescribed_pair(first, second, path, tilt=tilt), settings=settings).solve(len(path)))
