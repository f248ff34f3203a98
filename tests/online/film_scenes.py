"""Journal bearings with oil films: a sleeve that is held outside, and a shaft in it, rigid or of steel too."""

from __future__ import annotations

import functools
from dataclasses import replace
from typing import Any

import numpy as np

from references.films.elastic import ElasticJournal, held_compliance
from warpffrf.model import films, forces, joints, oils, signals, surfaces
from warpffrf.model.films import Film
from warpffrf.model.material import Material
from warpffrf.model.mesh import roller, sleeve
from warpffrf.model.reduced.body import ReducedBody
from warpffrf.model.scene import Scene
from warpffrf.offline import reduce
from warpffrf.online import History

STEEL = Material(210e9, 0.3, 7850.0)
RADIUS, WALL, LENGTH, CLEARANCE = 0.025, 0.0125, 0.025, 25e-6  # m
VISCOSITY, SPEED = 0.01, 300.0  # Pa s, rad/s
COLUMNS, ROWS = 32, 7
GROOVE = films.AxialGroove(np.pi, 1e-4, 0.0)
SHEAR = 3e-3  # of the load: what shear does to the shaft, which the reference leaves out, is c/R of it and some

Array = np.ndarray


@functools.cache
def bore_body(columns: int = COLUMNS, modulus: float = 210e9) -> ReducedBody:
    """A sleeve that is held outside."""
    mesh = sleeve(RADIUS, RADIUS + WALL, LENGTH, sectors=columns, order=1, axial=ROWS - 1)
    return reduce(
        mesh, replace(STEEL, youngs_modulus=modulus), interfaces={"outside": "rigid"},
        contact={"bore": surfaces.Bore()}, modes=6, cache=False, progress=False,
    )  # fmt: skip


@functools.cache
def shaft_body(modulus: float = 210e9, density: float = 7850.0) -> ReducedBody:
    """A shaft with a bore of half its radius, columns and rows as those of `bore_body`."""
    mesh = roller(RADIUS - CLEARANCE, 0.5 * RADIUS, LENGTH, sectors=COLUMNS, layers=2, order=1, axial=ROWS - 1)
    return reduce(
        mesh, replace(STEEL, youngs_modulus=modulus, density=density), interfaces={"bore": "rigid"},
        contact={"rim": surfaces.Cylinder()}, modes=6, cache=False, progress=False,
    )  # fmt: skip


def bearing(
    load: tuple[Any, Any] = (2e3, 0.0),
    *,
    body: ReducedBody | None = None,
    yielding: ReducedBody | None = None,
    on_shaft: bool = False,
    speed: float = SPEED,
    mass: float = 1.0,
    at: tuple[float, float] = (0.3 * CLEARANCE, 0.0),
    velocity: tuple[float, float] = (0.0, 0.0),
    **film: Any,
) -> Scene:
    """A shaft that is rotated in a sleeve, under a load along x and -z, which are e_0 and e_1 of the bore. It is rigid,
    or the body `yielding`, and then may have the film on its grid."""
    scene = Scene(gravity=(0.0, 0.0, 0.0))
    held = scene.add_body(body or bore_body(), name="sleeve")
    scene.add(joints.Fixed(scene.ground, held["outside"], axis=(0, 1, 0), name="held"))
    start: dict[str, Any] = {
        "name": "shaft", "position": (at[0], 0.0, -at[1]), "velocity": (velocity[0], 0.0, -velocity[1]),
        "angular_velocity": (0.0, speed, 0.0),
    }  # fmt: skip
    if yielding is None:
        J = 0.5 * mass * RADIUS**2
        journal = surfaces.Cylinder(radius=RADIUS - CLEARANCE, axis_point=(0, 0, 0), axis_direction=(0, 1, 0))
        shaft = scene.add_rigid_body(mass, (J, J, J), surfaces={"rim": journal}, **start)
        middle = shaft.at((0, 0, 0))
    else:
        shaft = scene.add_body(yielding, **start)
        middle = shaft["bore"]
    plane = scene.add(joints.Planar(scene.ground.at((0, 0, 0)), middle, axis=(0, 1, 0), name="plane"))
    scene.add(joints.Drive(plane, signals.Constant(speed), quantity="velocity", name="speed"))
    down = load[1] if isinstance(load[1], signals.Signal) else -load[1]
    scene.add(forces.PointForce(middle, (load[0], 0.0, down), name="load"))
    given: dict[str, Any] = {"oil": oils.Newtonian(VISCOSITY), "feeds": [GROOVE], "name": "film"} | film
    first, second = held["bore"], shaft["rim"]
    scene.add(Film(second, first, **given) if on_shaft else Film(first, second, **given))
    return scene


def place(history: History) -> Array:
    """(2,) of the clearance, of the shaft at the end, along e_0 and e_1."""
    x = history.bodies["shaft"].position[-1] / CLEARANCE
    return np.array([x[0], -x[2]])


def reference(
    oil: Any = None, asperities: Any = None, speed: float = SPEED, powers: tuple[int, ...] | None = None
) -> ElasticJournal:
    grid = bore_body().contact_surfaces["bore"].grid
    held = np.arange(COLUMNS) == COLUMNS // 2
    return ElasticJournal(
        RADIUS, CLEARANCE, oil or oils.Newtonian(VISCOSITY), speed, grid.theta, grid.z,
        held_compliance(bore_body(), "bore", "outside"), held, asperities, powers,
    )  # fmt: skip


def turning_load(step: float, steps: int) -> tuple[signals.Signal, signals.Signal]:
    """2 kN that begin along e_0 and turn at a quarter of the speed."""
    t = step * np.arange(-2, steps + 3)
    angle = 0.25 * SPEED * t
    return signals.Table(t, 2e3 * np.cos(angle)), signals.Table(t, -2e3 * np.sin(angle))
