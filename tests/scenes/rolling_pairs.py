r"""Two rollers on coarse meshes that roll, shift or slide on each other with friction on contact-fixed cells, with the
motion of their bores prescribed.

Axes along y, the lower roller about the origin, the upper one above it. The speeds of the rims are

    lower   V,      upper   V (1 - xi),      and the upper one moves along y with  -eta V,

so that xi and eta are the creepages of the first body once twisting has ended. An upper axle tilted by
gamma about x rotates by W sin(gamma) about the normal, at W = V/R: a spin of -sin(gamma)/R [1/m] and nothing else,
since axle and point of contact lie in one plane.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from references.closed_forms import LineContact, contact_modulus
from references.closed_forms.elliptic import EllipticContact
from scenes.flat_settings import reduce_flat
from warpffrf.model import joints, signals, surfaces
from warpffrf.model.contact import Contact
from warpffrf.model.errors import InputError
from warpffrf.model.friction import FrictionLaw
from warpffrf.model.material import Material
from warpffrf.model.mesh import Mesh
from warpffrf.model.mesh import roller as roller_mesh
from warpffrf.model.reduced.body import ReducedBody
from warpffrf.model.scene import Scene
from warpffrf.online.compile.patches.plan import span_of
from warpffrf.output.result import Result
from warpffrf.output.simulate import simulate

Array = np.ndarray
R, BORE, WIDTH = 0.05, 0.015, 0.02  # m
FRICTION = 0.3
SPEED = 0.5  # m/s
PAIR = "pair"
AXLE = (0.0, 1.0, 0.0)
LASTS = 1e3  # s, longer than any run
CARRIAGE_MASS, CARRIAGE_INERTIA = 1.0, 1e-3 * np.eye(3)  # kg, kg m2
STEEL = Material(210e9, 0.3, 7850.0, name="steel")
PLANE_STEEL = Material(210e9, 0.0, 7850.0, name="steel without Poisson's ratio")  # plane strain at any width


def roller(
    size: float, *, order: int = 2, crown_radius: float | None = None, width: float = WIDTH, radius: float = R,
    bore: float = BORE,
) -> Mesh:  # fmt: skip
    """A hollow roller in cells of about `size` [m]."""
    return roller_mesh(
        radius, bore, width, sectors=4 * round(0.5 * np.pi * radius / size),
        layers=max(2, round(0.8 * (radius - bore) / size)), axial=max(2, round(width / size)), order=order,
        crown_radius=crown_radius,
    )  # fmt: skip


def reduced(mesh: Mesh, material: Material = STEEL, *, crowned: bool = False, **options: Any) -> ReducedBody:
    """A roller for friction on cells of a patch, its bore rigid, its inertia that of a rigid body."""
    shape = surfaces.CrownedCylinder() if crowned else surfaces.Cylinder()
    given = {"modes": 0, "contact_fixed": True, "tangential": True, "progress": False, **options}
    return reduce_flat(mesh, material, interfaces={"bore": "rigid"}, contact={"rim": shape}, **given)


@dataclass(frozen=True)
class Drives:
    """Prescribed quantities. creepage xi, lateral creepage eta [-]; tilt of the upper axle [rad]; speed V [m/s].

    speeds: signals of the lower and the upper rim over V, instead of 1 and 1 - xi. way, along: signal [m] of a
    carriage under the lower roller and the axis along which it moves. lateral: a signal [m/s] instead of -eta V.
    free: the upper axle rotates freely.
    """

    creepage: float = 0.0
    lateral_creepage: float = 0.0
    tilt: float = 0.0
    speed: float = SPEED
    speeds: tuple[Any, Any] | None = None
    way: Any = None
    along: tuple[float, float, float] = (0.0, 0.0, 1.0)
    lateral: Any = None
    free: bool = False


def pair(
    lower: ReducedBody, upper: ReducedBody, approach: float, drives: Drives, *, radius: float = R,
    crown_radius: float | None = None, friction: float | FrictionLaw = FRICTION, cells: tuple[int, int] = (21, 21),
    shift: float = 0.0,
) -> Scene:  # fmt: skip
    """The scene; approach [m] of the axles, shift [m] of the upper roller along its axle."""
    scene = Scene(gravity=(0, 0, 0))
    turning = drives.speed / radius
    half = 0.5 * drives.tilt
    axle = np.array([0.0, np.cos(drives.tilt), np.sin(drives.tilt)])
    # the middle of the crown's arc stays above the point of contact
    arm = 0.0 if crown_radius is None else crown_radius - radius
    lift = arm * np.array([0.0, np.sin(drives.tilt), 1.0 - np.cos(drives.tilt)])
    place = np.array([0.0, shift, 2.0 * radius - approach]) + lift
    below_ratio, above_ratio = drives.speeds or (constant(1.0), constant(1.0 - drives.creepage))
    start = [float(ratio(0.0)) for ratio in (below_ratio, above_ratio)]
    sideways = -drives.lateral_creepage * drives.speed
    turns = turning * start[0] * np.array(AXLE)
    first = scene.add_body(lower, name="lower", angular_velocity=turns, inertia="constant")
    start_lateral = sideways if drives.lateral is None else float(drives.lateral(0.0))
    second = scene.add_body(
        upper, name="upper", position=place, rotation=np.array([np.sin(half), 0.0, 0.0, np.cos(half)]),
        angular_velocity=-turning * start[1] * axle, velocity=start_lateral * axle, inertia="constant",
    )  # fmt: skip
    base = scene.ground
    if drives.way is not None:
        carriage = scene.add_rigid_body(CARRIAGE_MASS, CARRIAGE_INERTIA, name="carriage")
        base = carriage.at((0.0, 0.0, 0.0))
        slide = scene.add(joints.Prismatic(scene.ground, base, axis=drives.along))
        scene.add(joints.Drive(slide, drives.way, quantity="position"))
    below = scene.add(joints.Revolute(base, first["bore"], axis=AXLE, name="lower axle"))
    above = scene.add(joints.Cylindrical(scene.ground, second["bore"], axis=axle, name="upper axle"))
    lateral = constant(sideways) if drives.lateral is None else drives.lateral
    scene.add(joints.Drive(below, below_ratio.scaled(turning), quantity="velocity"))
    scene.add(joints.Drive(above, lateral, quantity="velocity", coordinate="translation"))
    if not drives.free:
        turns = above_ratio.scaled(-turning)
        scene.add(joints.Drive(above, turns, quantity="velocity", coordinate="rotation"))
    scene.add(Contact(first["rim"], second["rim"], friction=friction, grid="contact_fixed", cells=cells, name=PAIR))
    return scene


def constant(value: float) -> signals.Table:
    """A constant signal."""
    return signals.Table([0.0, LASTS], [value, value])


def run(scene: Scene, steps: int, step: float, **options: Any) -> Result:
    """From the static state; raises `InputError` if the run fails."""
    result = simulate(scene, steps * step, step=step, **{"start": "equilibrium", "progress": False, **options})
    if result.status != "completed":
        raise InputError(f"rolling pairs: {result.message}")
    return result


@dataclass(frozen=True)
class Rolled:
    """Mean over the last crossing of a run of two equal rollers."""

    creepage: Array  # (2,)
    spin: float  # 1/m
    share: Array  # (2,) force over mu N
    load: float  # N
    drift: float  # of the share between the last two crossings
    cells_per_step: float
    rejected: int
    result: Result


def roll(
    scene: Scene, half_width: float, cells: int, per_step: float, crossings: float, *, speed: float = SPEED,
    friction: float = FRICTION,
) -> Rolled:  # fmt: skip
    """Rolls by `crossings` of the patch, half_width a [m], at about `per_step` of its `cells` strips per step."""
    step = per_step * 2.0 * span_of(cells) * half_width / cells / speed
    each = max(1, round(2.0 * half_width / speed / step))
    result = run(scene, int(np.ceil(crossings * each)), step)
    return settled(result, each, friction)


def settled(result: Result, each: int, friction: float = FRICTION) -> Rolled:
    """The last crossing, of `each` steps."""
    contact: Any = result.contact(PAIR)
    rubbing = contact.friction
    share = rubbing.tangential_force / (friction * contact.normal_load[:, None])
    last = share[-each:].mean(axis=0)
    drift = float(np.linalg.norm(last - share[-2 * each : -each].mean(axis=0)))
    return Rolled(
        rubbing.creepage[-each:].mean(axis=0), float(rubbing.spin_creepage[-each:].mean()), last,
        float(contact.normal_load[-each:].mean()), drift, float(rubbing.cells_per_step[-1]),
        int(result.history.counters["rejected_steps"]), result,
    )  # fmt: skip


def line_contact(load: float, first: Material, second: Material, *, width: float = WIDTH, radius: float = R) -> Any:
    """Hertz's line contact of two straight rollers of one radius; load N [N]."""
    return LineContact(load / width, 0.5 * radius, contact_modulus(first, second))


def elliptic_contact(load: float, crown_radius: float, material: Material, *, radius: float = R) -> EllipticContact:
    """Hertz's contact of two crowned rollers, x around them."""
    return EllipticContact(load, 0.5 * radius, 0.5 * crown_radius, contact_modulus(material, material))
