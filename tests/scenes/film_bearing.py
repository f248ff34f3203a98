"""A journal bearing with an oil film: a shaft rotates in a sleeve that is held at its outer surface.

Positions and loads are in the frame of the bore, e_0 = x and e_1 = -z of the world.
"""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np

from references.films.grid import FilmGrid
from warpffrf.model import films, forces, joints, oils, signals, surfaces
from warpffrf.model.films import Film
from warpffrf.model.material import Material
from warpffrf.model.mesh import sleeve
from warpffrf.model.reduced.body import ReducedBody
from warpffrf.model.scene import Scene
from warpffrf.offline import ContactGrid, reduce
from warpffrf.online import History
from warpffrf.online.run import find_equilibrium

STEEL = Material(210e9, 0.3, 7850.0)
RADIUS, WALL, LENGTH, CLEARANCE = 0.025, 0.0125, 0.025, 25e-6  # m
VISCOSITY, SPEED = 0.01, 300.0  # Pa s, rad/s
TURN = 2.0 * np.pi / SPEED  # s
RIGID = 1e5  # times the modulus of steel
GROOVE = films.AxialGroove(np.pi, 1e-4, 0.0)  # one column

Array = np.ndarray


@cache
def bore(
    grid_nodes: tuple[int, int] = (64, 9), length: float = LENGTH, stiffer: float = 1.0, coarse: int | None = None
) -> ReducedBody:
    """A sleeve that is held outside, with so many nodes; around fewer of them, `coarse`, on the same mesh."""
    columns, rows = grid_nodes
    mesh = sleeve(RADIUS, RADIUS + WALL, length, sectors=columns, order=1, axial=rows - 1)
    return reduce(
        mesh, replace(STEEL, youngs_modulus=stiffer * STEEL.youngs_modulus), interfaces={"outside": "rigid"},
        contact={"bore": surfaces.Bore()}, modes=10 if stiffer == 1.0 else 2, cache=False, progress=False,
        grid=ContactGrid(spacing=None if coarse is None else 2.0 * np.pi * RADIUS / coarse),
    )  # fmt: skip


def bearing(
    body: ReducedBody, load: tuple[Any, Any] | None, *, at: tuple[float, float] = (0.3, 0.0), speed: float = SPEED,
    mass: float = 1.0, clearance: float = CLEARANCE, radius: float = RADIUS, **film: Any,
) -> Scene:  # fmt: skip
    """A shaft of `mass` [kg] with `load` [N], numbers or signals, that begins `at` so many clearances; without a load
    it is held there."""
    scene = Scene(gravity=(0.0, 0.0, 0.0))
    held = scene.add_body(body, name="sleeve")
    scene.add(joints.Fixed(scene.ground, held["outside"], axis=(0, 1, 0), name="held"))
    J, place = 0.5 * mass * radius**2, (at[0] * clearance, 0.0, -at[1] * clearance)
    axle = surfaces.Cylinder(radius=radius - clearance, axis_point=(0, 0, 0), axis_direction=(0, 1, 0))
    shaft = scene.add_rigid_body(
        mass, (J, J, J), name="shaft", position=place, angular_velocity=(0.0, speed, 0.0), surfaces={"journal": axle}
    )  # fmt: skip
    kind, centre = joints.Planar if load is not None else joints.Revolute, shaft.at((0, 0, 0))
    joint = scene.add(kind(scene.ground.at(place), centre, axis=(0, 1, 0), name="axis"))
    scene.add(joints.Drive(joint, signals.Constant(speed), quantity="velocity", name="speed"))
    if load is not None:
        down = -load[1]
        scene.add(forces.PointForce(centre, (load[0], 0.0, down), name="load"))
    given: dict[str, Any] = {"oil": oils.Newtonian(VISCOSITY), "name": "film"} | film
    scene.add(Film(held["bore"], shaft["journal"], **given))
    return scene


class Load(signals.Table):
    """A smooth course [N] with its negative."""

    def __neg__(self) -> Load:
        return Load(self.times, -self.values, cubic=True)


def completed(found: History) -> History:
    """A run that came to its end."""
    if found.status != "completed":
        raise RuntimeError(f"{found.status}: {found.message}")
    return found


def at_rest(scene: Scene) -> History:
    """Its equilibrium."""
    return completed(find_equilibrium(scene))


def pressed(body: ReducedBody, pressure: Array) -> Array:
    """(2,) N of the pressures alone on the shaft."""
    grid = body.contact_surfaces["bore"].grid
    own = FilmGrid(RADIUS * (grid.theta - grid.theta[0]), grid.z, period=2.0 * np.pi * RADIUS)
    angle, p = own.at[:, 0] / RADIUS + grid.theta[0], own.weights * (own.value @ pressure.ravel())
    return -np.array([p @ np.cos(angle), p @ np.sin(angle)])


# --- 2: at rest in an elastic bore


# --- 3 and 4: the load of an engine


# --- 5: balances


# --- 6: a load that turns


# --- 7: time


# --- 8: where the shaft begins to whirl


# --- the page
