"""A rigid cylinder on an exact elastic half-plane with a stiff layer and friction: shifted to and fro (Cattaneo and
Mindlin), and rolled along (Carter).

"full" has the law of the layer at nodes (`references.monolithic`), "nodes" bilinear shape functions of the contact grid
and cells (the engine), with the same bodies, layer and steps.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from references.closed_forms import CarterRolling, LineContact, MindlinLine, contact_modulus
from references.half_space.bodies import FACE, HOLD, half_plane
from references.monolithic import results as monolithic
from references.monolithic.line_of_centres.pair import default_layer
from warpffrf.model import forces, joints, laws, signals, surfaces
from warpffrf.model.contact import Contact
from warpffrf.model.material import Material
from warpffrf.model.reduced.body import ReducedBody
from warpffrf.model.reduced.contact_surface import Recovery
from warpffrf.model.reduced.data import DisplaySurface
from warpffrf.model.scene import Scene
from warpffrf.online import GeneralizedAlpha
from warpffrf.output.options import RunOptions
from warpffrf.output.result import Result
from warpffrf.output.simulate import simulate

STEEL = Material(210e9, 0.3, 7850.0, name="steel")
PAIR = "pair"
FRICTION, WIDTH, HALF_WIDTH = 0.3, 0.01, 1.5e-3  # -, m, m
RADIUS, FLAT_RADIUS = 0.05, 5.0  # m, shifted and rolled: in the second the surface bends little
MASS, INERTIA = 0.1, (1e-4, 1e-4, 1e-4)  # kg, kg m2: small, and the runs are slow
STEP, QUARTER = 1e-3, 4  # s, and steps to the peak of the shift
SHARE = 0.5  # of mu P that the shift, or the creepage, asks for
SPEED = 1.0  # m/s
ACROSS = (0.0, 1.0, 0.0)


def with_nodes(body: ReducedBody) -> ReducedBody:
    """A body whose surface is an exact half-space or half-plane, with a skin whose nodes are those of its grid. Shares
    of the area are those of the nodes, but at the four corners, where they are 4/3 or 2/3 of them."""
    (name,) = body.contact_surfaces
    surface = body.contact_surfaces[name]
    grid = surface.grid
    points = surface.shape.point(*np.meshgrid(grid.theta, grid.z, indexing="ij")).reshape(-1, 3)
    i = (np.arange(grid.columns - 1)[:, None] * grid.rows + np.arange(grid.rows - 1)).ravel()
    quads = np.stack([i, i + grid.rows, i + grid.rows + 1, i + 1], axis=1)
    triangles = np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]])
    skin = DisplaySurface(points, triangles, np.zeros((len(body.frequencies), len(points), 3)))
    surface = replace(surface, recovery=_nothing_seen(surface.recovery, points))
    if surface.tangential is not None:
        seen = _nothing_seen(surface.tangential.recovery, points)
        surface = replace(surface, tangential=replace(surface.tangential, recovery=seen))
    return replace(body, surface=skin, contact_surfaces={name: surface})


def _nothing_seen(recovery: Recovery, points: np.ndarray) -> Recovery:
    """A skin of `points` that tractions do not move."""
    return replace(recovery, transfer=np.zeros((1, points.size, recovery.transfer.shape[2]), np.float32))


def line_contact(radius: float) -> LineContact:
    """Hertz's line contact of the half-width HALF_WIDTH under a rigid cylinder."""
    E = contact_modulus(STEEL)
    return LineContact(HALF_WIDTH**2 * np.pi * E / (4.0 * radius), radius, E)


@dataclass(frozen=True, eq=False)
class Shifted:
    """A run and its closed form; errors of displacement and of the work of a cycle (fractions), of the stick zone
    [spacings], at the peak of the shift."""

    exact: MindlinLine
    result: Result
    displacement: float
    stick: float
    loss: float


def shifted(cells: int, quadrature: str, *, stiffer: float = 1.0, stick: float | None = None) -> Shifted:
    """A rigid cylinder, pressed on the half-plane with `cells` in a half-width, shifted aside and once to and fro; the
    layer is `stiffer` times the default one of nodes, the stick stiffness `stick` times that (None: of the layer)."""
    line = line_contact(RADIUS)
    exact = MindlinLine(line, FRICTION, 20.0 * HALF_WIDTH)
    columns = 2 * int(1.3 * cells + 3) + 1
    body = with_nodes(half_plane(columns, HALF_WIDTH / cells, WIDTH, STEEL, exact.depth))
    scene, face = _on_space(body)
    carriage, partner, port = _cylinder(scene, RADIUS, (0.0, 0.0, RADIUS))
    scene.add(joints.Prismatic(scene.ground, carriage, axis=(0.0, 0.0, 1.0), name="down"))
    side = scene.add(joints.Prismatic(carriage, partner, axis=(1.0, 0.0, 0.0), name="side"))
    scene.add(forces.PointForce(carriage, (0.0, 0.0, -line.load * WIDTH)))
    first = 0.5 * (1.0 - np.cos(np.pi * np.arange(QUARTER + 1) / QUARTER))
    path = np.concatenate([first, np.cos(0.5 * np.pi * np.arange(1, 4 * QUARTER + 2) / QUARTER)])
    shift = float(exact.loading(SHARE * exact.limit))
    scene.add(
        joints.Drive(side, signals.Table(STEP * np.arange(len(path)), shift * path, cubic=True), quantity="position")
    )
    result = _run(scene, face, port, quadrature, 5 * QUARTER * STEP, STEP, stiffer, stick)
    c = result.history.contacts[PAIR]
    if c.friction is None:
        raise RuntimeError("no friction in the result")
    Q, i = c.force[:, 0] / WIDTH, QUARTER
    zone = 0.5 * float(np.sum(c.friction.state[i][:, 0] == 1))
    work = result.history.energy["friction"]
    lost = float(work[QUARTER] - work[5 * QUARTER]) / WIDTH
    return Shifted(
        exact, result,
        float(result.history.bodies["partner"].position[i, 0] / exact.loading(Q[i])) - 1.0,
        zone - float(exact.stick_ratio(Q[i])) * cells,
        lost / float(exact.cycle_loss(0.5 * (Q[QUARTER] - Q[3 * QUARTER]))) - 1.0,
    )  # fmt: skip


def rolled(cells: int, quadrature: str, crossings: int = 10, share: float = SHARE) -> tuple[float, float, Result]:
    """A rigid cylinder rolls along, a cell per step: the error of Q at the creepage found, the creepage found over that
    asked for, and the run."""
    pitch, line = HALF_WIDTH / cells, line_contact(FLAT_RADIUS)
    exact = CarterRolling.from_share(line, FRICTION, share)
    steps = 2 * cells * crossings
    body = with_nodes(half_plane(steps + 8 * cells + 1, pitch, WIDTH, STEEL, 40.0 * HALF_WIDTH))
    scene, face = _on_space(body)
    turning = SPEED * (1.0 + exact.creepage) / FLAT_RADIUS
    place, going = (-0.5 * steps * pitch, 0.0, FLAT_RADIUS), (SPEED, 0.0, 0.0)
    middle = scene.add_rigid_body(MASS, INERTIA, name="middle", position=place, velocity=going).at((0.0, 0.0, 0.0))
    car, roller, port = _cylinder(scene, FLAT_RADIUS, place, velocity=going, turning=turning)
    along = scene.add(joints.Prismatic(scene.ground, car, axis=(1.0, 0.0, 0.0), name="along"))
    scene.add(joints.Prismatic(car, middle, axis=(0.0, 0.0, 1.0), name="down"))
    turn = scene.add(joints.Revolute(middle, roller, axis=ACROSS, name="turn"))
    scene.add(forces.PointForce(middle, (0.0, 0.0, -line.load * WIDTH)))
    scene.add(joints.Drive(along, SPEED, quantity="velocity"))
    scene.add(joints.Drive(turn, turning, quantity="velocity"))
    result = _run(scene, face, port, quadrature, steps * pitch / SPEED, pitch / SPEED, 1.0, None)
    c = result.history.contacts[PAIR]
    if c.friction is None:
        raise RuntimeError("no friction in the result")
    Q = -float(np.mean(c.force[-2 * cells :, 0] / np.abs(c.force[-2 * cells :, 2]))) / FRICTION
    creepage = -float(c.friction.creep_velocity[-1, 0] / c.friction.rolling_velocity[-1])
    return Q / CarterRolling(line, FRICTION, creepage).share - 1.0, creepage / exact.creepage, result


def _on_space(body: ReducedBody) -> tuple[Scene, Any]:
    scene = Scene()
    space = scene.add_body(body, name="space")
    scene.add(joints.Fixed(scene.ground, space[HOLD], name="hold"))
    return scene, space[FACE]


def _cylinder(
    scene: Scene, radius: float, place: Any, *, velocity: Any = (0.0, 0.0, 0.0), turning: float = 0.0
) -> tuple[Any, Any, Any]:
    """Centres of a carriage and of a rigid cylinder, and the cylinder's surface."""
    shape = surfaces.Cylinder(radius=radius, axis_point=(0.0, 0.0, 0.0), axis_direction=ACROSS)
    carriage = scene.add_rigid_body(MASS, INERTIA, name="carriage", position=place, velocity=velocity)
    partner = scene.add_rigid_body(
        MASS, INERTIA, name="partner", position=place, velocity=velocity, angular_velocity=(0.0, turning, 0.0),
        surfaces={"face": shape},
    )  # fmt: skip
    return carriage.at((0.0, 0.0, 0.0)), partner.at((0.0, 0.0, 0.0)), partner["face"]


def _run(
    scene: Scene, face: Any, port: Any, quadrature: Any, duration: float, step: float, stiffer: float,
    stick: float | None,
) -> Result:  # fmt: skip
    unit = default_layer(face.surface)
    law = laws.LinearLayer(stiffer * unit)
    scene.add(Contact(face, port, friction=FRICTION, law=law, name=PAIR, overlap=1.0))
    options: dict[str, Any] = {
        "step": step, "start": "equilibrium", "integrator": GeneralizedAlpha(rho_inf=0.0), "progress": False
    }  # fmt: skip
    if quadrature == "at nodes":
        options |= {"variant": "low_rank", "stick_stiffness": None if stick is None else stick * unit}
        result = monolithic.simulate(scene, duration, at_nodes=True, **options)
    else:
        own = RunOptions(integrator=options.pop("integrator"))
        result = simulate(scene, duration, options=own, **options)
    if result.status != "completed":
        raise RuntimeError(f"{quadrature}: {result.status}: {result.message}")
    return result
