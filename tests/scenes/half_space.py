"""A rigid ball or cylinder on an exact elastic half-space or half-plane: pressed, shifted to and fro, rolled along."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from warpffrf.model import forces, joints, signals, surfaces
from warpffrf.model.contact import Contact
from warpffrf.model.material import Material
from warpffrf.model.reduced.body import ReducedBody
from warpffrf.model.reduced.contact_grid import cell_edges
from warpffrf.model.scene import Scene
from warpffrf.online import GeneralizedAlpha
from warpffrf.output.options import RunOptions
from warpffrf.output.result import Result
from warpffrf.output.simulate import simulate

STEEL = Material(210e9, 0.3, 7850.0, name="steel")
PAIR = "pair"
MASS, INERTIA = 0.1, (1e-4, 1e-4, 1e-4)  # kg, kg m2: small, and the runs are slow
STEP = 1e-3  # s
ACROSS = (0.0, 1.0, 0.0)


def simulated(scene: Scene, duration: float, step: float, *, start: str = "equilibrium") -> Result:
    """A run whose integrator damps what the run does not resolve."""
    result = simulate(
        scene,
        duration,
        step=step,
        start=start,
        progress=False,
        options=RunOptions(integrator=GeneralizedAlpha(rho_inf=0.0)),
    )
    assert result.status == "completed", result.message
    return result


def _held(scene: Scene, body: ReducedBody) -> Any:
    """The contact surface of `body`, fixed at its one interface."""
    (surface,), (interface,) = body.contact_surfaces, body.interfaces
    space = scene.add_body(body, name="space")
    scene.add(joints.Fixed(scene.ground, space[interface], name="hold"))
    return space[surface]


def pushed(
    body: ReducedBody, shape: Any, load: float, most: float, quarter: int, friction: float, *, by_force: bool = False
) -> tuple[Scene, int]:
    """`shape` (about the origin of a rigid body), pressed down by `load` [N]; its body is then shifted along x from 0
    to `most` [m] in `quarter` steps and once to -most and back, in four times as many, or pushed so `by_force`, `most`
    in N. Scene and number of steps."""
    scene = Scene()
    face = _held(scene, body)
    place = (0.0, 0.0, shape.radius)
    carriage = scene.add_rigid_body(MASS, INERTIA, name="carriage", position=place)
    partner = scene.add_rigid_body(MASS, INERTIA, name="partner", position=place, surfaces={"face": shape})
    center, middle = carriage.at((0.0, 0.0, 0.0)), partner.at((0.0, 0.0, 0.0))
    scene.add(joints.Prismatic(scene.ground, center, axis=(0.0, 0.0, 1.0), name="down"))
    side = scene.add(joints.Prismatic(center, middle, axis=(1.0, 0.0, 0.0), name="side"))
    scene.add(forces.PointForce(center, (0.0, 0.0, -load)))
    first = 0.5 * (1.0 - np.cos(np.pi * np.arange(quarter + 1) / quarter))
    cycle = np.cos(0.5 * np.pi * np.arange(1, 4 * quarter + 2) / quarter)
    path = most * np.concatenate([first, cycle])
    table = signals.Table(STEP * np.arange(len(path)), path, cubic=True)
    if by_force:
        scene.add(forces.PointForce(middle, (table, (1.0, 0.0, 0.0))))
    else:
        scene.add(joints.Drive(side, table, quantity="position"))
    scene.add(Contact(face, partner["face"], friction=friction, name=PAIR, overlap=1.0))
    return scene, 5 * quarter


def ball(radius: float) -> Any:
    return surfaces.Sphere(radius=radius, axis_point=(0.0, 0.0, 0.0), axis_direction=ACROSS)


def cylinder(radius: float) -> Any:
    return surfaces.Cylinder(radius=radius, axis_point=(0.0, 0.0, 0.0), axis_direction=ACROSS)


def rolling(
    body: ReducedBody, radius: float, load: float, creepage: float, start: float, speed: float, friction: float
) -> Scene:
    """A rigid cylinder that rolls along +x from x = `start` [m] at `speed` [m/s], its surface faster by `creepage`."""
    scene = Scene()
    face = _held(scene, body)
    place, going = (start, 0.0, radius), (speed, 0.0, 0.0)
    turning = speed * (1.0 + creepage) / radius
    car, middle = (
        scene.add_rigid_body(MASS, INERTIA, name=name, position=place, velocity=going) for name in ("car", "middle")
    )
    roller = scene.add_rigid_body(
        MASS, INERTIA, name="roller", position=place, velocity=going, angular_velocity=(0.0, turning, 0.0),
        surfaces={"rim": cylinder(radius)},
    )  # fmt: skip
    ports = [b.at((0.0, 0.0, 0.0)) for b in (car, middle, roller)]
    along = scene.add(joints.Prismatic(scene.ground, ports[0], axis=(1.0, 0.0, 0.0), name="along"))
    scene.add(joints.Prismatic(ports[0], ports[1], axis=(0.0, 0.0, 1.0), name="down"))
    turn = scene.add(joints.Revolute(ports[1], ports[2], axis=ACROSS, name="turn"))
    scene.add(forces.PointForce(ports[1], (0.0, 0.0, -load)))
    scene.add(joints.Drive(along, speed, quantity="velocity"))
    scene.add(joints.Drive(turn, turning, quantity="velocity"))
    scene.add(Contact(face, roller["rim"], friction=friction, name=PAIR, overlap=1.0))
    return scene


@dataclass(frozen=True)
class PatchMoments:
    """Force [N], place (2,) [m], half-width by the second moment [m] and largest coefficient [Pa] of a plane patch."""

    force: float
    place: np.ndarray
    second: np.ndarray  # (2,) m2, about the place, along x and y
    peak: float

    @classmethod
    def of(cls, result: Result, i: int) -> PatchMoments:
        """Of row `i`: nodes are linear, int x^2 psi = h (x_j^2 + h^2/6)."""
        history = result.history.contacts[PAIR]
        scene: Any = result.history.scene
        surface = scene.contacts[0].a.surface
        grid, radius = surface.grid, float(surface.shape.radius)
        p = history.pressure[i]
        x = radius * (grid.theta_start + grid.pitch * (history.first_column[i] + np.arange(len(p))))
        widths = np.diff(cell_edges(grid.z))
        w = p * radius * grid.pitch * widths
        F = float(w.sum())
        place = np.array([w.sum(axis=1) @ x, w.sum(axis=0) @ grid.z]) / F
        spread = np.array([(radius * grid.pitch) ** 2, float(widths.mean()) ** 2]) / 6.0
        second = np.array([w.sum(axis=1) @ (x - place[0]) ** 2, w.sum(axis=0) @ (grid.z - place[1]) ** 2]) / F
        return cls(F, place, second + spread, float(p.max()))
