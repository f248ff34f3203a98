"""Errors that reports print of their figures compared with true ones: a part of the page of `budget_check`.

Scenes on coarse meshes, cells, nodes and film grids, each against the same scene on fine ones. A figure is right where
the stated error is within a factor of three of the true one, or both are below `FLOOR`, below which a report states no
more; a figure whose line is "not estimated" is counted separately.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from references.closed_forms import LineContact, PointContact, contact_modulus
from scenes.user_meshes import cut_into_tets, serendipity, straight
from studies.contact import coarse_points as points
from studies.contact import coarse_rollers as rollers
from studies.films import film_acceptance as films
from studies.rolling import carter_rollers as carter
from warpffrf.model import joints, surfaces
from warpffrf.model.contact import Contact
from warpffrf.model.material import Material
from warpffrf.model.mesh import Mesh
from warpffrf.model.mesh import roller as roller_mesh
from warpffrf.model.reduced.body import ReducedBody
from warpffrf.model.scene import Scene
from warpffrf.offline import ContactGrid, reduce
from warpffrf.online.history.history import BudgetLine
from warpffrf.output.budget.budget import FLOOR
from warpffrf.output.budget.figures import UNKNOWN, figures, total
from warpffrf.output.budget.quantities import quantities
from warpffrf.output.budget.stresses import below
from warpffrf.output.options import RunOptions
from warpffrf.output.result import Result
from warpffrf.output.simulate import equilibrium, simulate

FACTOR = 3.0
ROLLS = ((11, 16), (15, 32)), (33, 64)  # strips and steps in a crossing; of the reference
LOOKED_AT = 8  # rows in a crossing
RUBBER = Material(4e6, 0.49, 1200.0)
CYLINDER = Material(210e9, 0.0, 7800.0)  # in plane strain at any width


@dataclass(frozen=True)
class Stated:
    """One figure of a scene: its error and what is stated of it, as fractions; NaN where nothing is, which the line
    says if `told`."""

    scene: str
    figure: str
    true: float
    stated: float
    told: bool
    source: str

    @property
    def right(self) -> bool:
        """Whether the error is known to a factor of three, or reported to be below what a report says."""
        if self.true < FLOOR:
            return self.stated < FACTOR * FLOOR
        return 1.0 / FACTOR <= self.stated / self.true <= FACTOR


def compare(scene: str, own: Result, finer: Result) -> list[Stated]:
    """All figures of a result against those of a finer one of the same rows, forces and what is printed; their largest
    differences."""
    lines, found = own.error_budget(), []
    values, others = ({**figures(r.history, r.view), **quantities(r.history)} for r in (own, finer))
    for name, quantity in values.items():
        if name.startswith(("motion", "deformation")) or name not in others:
            continue
        true = float(np.nanmax(np.linalg.norm(quantity.values - others[name].values, axis=1))) / quantity.size
        found.append(_stated(scene, name, true, lines))
    return found


def _stated(scene: str, name: str, true: float, lines: Sequence[BudgetLine]) -> Stated:
    """The `true` error of a figure and what `lines` say of it."""
    mine = [line for line in lines if line.of == name]
    known = [line for line in mine if line.found]
    lacks = any(line.source == UNKNOWN or not line.found for line in mine)
    source = max(known, key=lambda line: line.size).source if known else ""
    return Stated(scene, name, true, total(known) if known and not lacks else np.nan, lacks, source)


def _roller(bore: float, size: float, order: int) -> Mesh:
    around = 4 * round(0.5 * np.pi * rollers.R / size)
    layers = max(round(rollers.LAYER * (rollers.R - bore) / size), 1)
    return roller_mesh(
        rollers.R, bore, rollers.WIDTH, sectors=around, layers=layers, axial=round(rollers.WIDTH / size), order=order
    )


KINDS: dict[str, Callable[[Callable[[int], Mesh]], Mesh]] = {
    "hex8": lambda made: made(1),
    "hex20": lambda made: serendipity(made(2)),
    "tet10": lambda made: cut_into_tets(made(2)),
    "tet4": lambda made: straight(cut_into_tets(made(2))),
}


def pressed_rollers() -> Iterator[Stated]:
    """Hollow and thin rollers at a given approach."""
    for name, bore, size, approaches in (("roller", rollers.BORE, 8e-3, (1e-5, 3e-5)), ("ring", 0.035, 5e-3, (2e-5,))):
        fine = rollers.reduced(_roller(bore, 2.5e-3, 2))
        bodies = {k: rollers.reduced(make(partial(_roller, bore, size))) for k, make in KINDS.items()}
        for approach in approaches:
            exact = equilibrium(rollers.held(fine, fine, approach, cells=(25, 41)), progress=False)
            for kind, body in bodies.items():
                own = equilibrium(rollers.held(body, body, approach), progress=False)
                yield from compare(f"{name}s of {kind}, {1e6 * approach:.0f} um", own, exact)


def cover(axial: int, order: int = 2) -> ReducedBody:
    """A rubber cover of 10 mm on a rigid core, 100 mm wide, with so many cells along."""
    mesh = roller_mesh(0.05, 0.04, 0.1, sectors=96, layers=3, axial=axial, order=order)
    return reduce(
        mesh, RUBBER, interfaces={"bore": "rigid"}, contact={"rim": surfaces.Cylinder()}, modes=2,
        grid=ContactGrid(contact_fixed=True), cache=False, progress=False,
    )  # fmt: skip


def nip(body: ReducedBody, cells: tuple[int, int] | None = None) -> Result:
    """A rigid cylinder that is 0.1 mm too near to a cover."""
    scene = Scene(gravity=(0.0, 0.0, 0.0))
    placed = scene.add_body(body, name="cover")
    shape = surfaces.Cylinder(radius=0.06, axis_point=(0.0, 0.0, 0.11 - 1e-4), axis_direction=(0.0, 1.0, 0.0))
    other = scene.ground.surface(shape, name="cylinder")
    scene.add(Contact(placed["rim"], other, grid="contact_fixed", cells=cells, name=rollers.PAIR))
    scene.add(joints.Fixed(scene.ground, placed["bore"]))
    return equilibrium(scene, progress=False)


def covers() -> Iterator[Stated]:
    """Covers with few cells along."""
    exact = nip(cover(24), (25, 41))
    for axial, order in ((4, 1), (4, 2), (8, 2)):
        yield from compare(f"cover with {axial} cells of order {order} along", nip(cover(axial, order)), exact)


def crowned_rollers() -> Iterator[Stated]:
    """Point contacts at a given approach."""
    for crown in (0.14, 0.5):
        fine = rollers.reduced(rollers.hexahedra(4e-3, 2, crown), crown)
        exact = equilibrium(rollers.held(fine, fine, 1.5e-5, cells=(25, 41)), progress=False)
        for kind in ("hex8", "tet10"):
            body = rollers.reduced(KINDS[kind](partial(rollers.hexahedra, 8e-3, crown_radius=crown)), crown)
            own = equilibrium(rollers.held(body, body, 1.5e-5), progress=False)
            yield from compare(f"crown of {crown:g} m, {kind}", own, exact)


def balls() -> Iterator[Stated]:
    """Balls under their weight, which gives the force."""
    fine = points.ball(points.STEEL, points.BallMesh(12.0, 4, "hex27"))
    exact = points.weighed(fine, points.LOAD, points.STEEL, points.FINE_POINT)
    for mesh in points.COARSE_BALLS[::2]:
        own = points.weighed(points.ball(points.STEEL, mesh), points.LOAD, points.STEEL)
        yield from compare(f"ball of {mesh.kind}, {mesh.elements:g} on the radius", own, exact)


def solid_rollers() -> Iterator[Stated]:
    """A solid roller squeezed between planes."""
    exact = points.pressed_rollers([points.roller(CYLINDER, 8, 2)], 4e-5, (25, 41))
    for elements, order in ((4, 2), (6, 1), (6, 2)):
        own = points.pressed_rollers([points.roller(CYLINDER, elements, order)], 4e-5)
        yield from compare(f"solid roller, {elements} elements of order {order}", own, exact)


def stresses() -> Iterator[Stated]:
    """The largest von Mises stress below lines and points, against Hertz at the load found."""

    def stated(
        scene: str, result: Result, names: tuple[str, str], exact: LineContact | PointContact, nu: float
    ) -> Stated:
        body, pair = names
        values = result.stress(body, "below").von_mises[-1], exact.von_mises(points.DEPTHS * exact.half_width, nu)
        found, wanted = (points.largest(points.DEPTHS, v)[0] for v in values)
        name = f"{below(repr(pair))} of body {body!r}"
        return _stated(scene, name, abs(found / wanted - 1.0), result.error_budget())

    line = LineContact(points.LINE_LOAD, points.ROLLER_RADIUS, contact_modulus(CYLINDER))
    for elements, order in ((3, 1), (4, 2)):
        body = points.roller(CYLINDER, elements, order, points.DEPTHS * line.half_width)
        result = points.pressed_rollers([body], 2.0 * points.roller_approach(line.load, line.half_width, CYLINDER))
        exact = replace(line, load=float(result.contact("pair 0").line_load[-1]))
        yield stated(
            f"below a roller, {elements} elements of order {order}", result, ("roller 0", "pair 0"), exact, 0.0
        )
    point = PointContact(points.LOAD, points.BALL_RADIUS, contact_modulus(points.STEEL))
    for mesh in points.COARSE_BALLS[1:7:2]:
        body = points.ball(points.STEEL, mesh, points.DEPTHS * point.half_width)
        result = points.weighed(body, points.LOAD, points.STEEL)
        name = f"below a ball of {mesh.kind}, {mesh.elements:g} on the radius"
        yield stated(name, result, ("ball", "pair"), point, points.STEEL.poisson_ratio)


def grid_nodes() -> Iterator[Stated]:
    """Rollers on the body-fixed grid, a node and two in a half-width."""

    def body(sectors: int, layers: int, grading: float) -> ReducedBody:
        mesh = roller_mesh(0.05, 0.015, 0.02, sectors=sectors, layers=layers, axial=2, order=1, grading=grading)
        return reduce(
            mesh, rollers.STEEL, interfaces={"bore": "rigid"}, contact={"rim": surfaces.Cylinder()}, modes=2,
            grid=ContactGrid(contact_fixed=False), cache=False, progress=False,
        )  # fmt: skip

    bodies = {720: body(720, 14, 1.3), 960: body(960, 12, 1.4), 1920: body(1920, 30, 1.1)}
    states = {n: equilibrium(rollers.held(b, b, 6e-5, grid="body_fixed"), progress=False) for n, b in bodies.items()}
    for sectors in (720, 960):
        yield from compare(f"nodes, {sectors} around", states[sectors], states[1920])


def rolling() -> Iterator[Stated]:
    """Rollers that roll with friction under half of their bound."""
    mesh = roller_mesh(
        carter.RADIUS, carter.BORE, carter.WIDTH, sectors=4 * round(0.5 * np.pi * carter.RADIUS / 4e-3), layers=4,
        axial=2, order=1,
    )  # fmt: skip
    body = reduce(
        mesh, carter.STEEL, interfaces={"bore": "rigid"}, contact={"rim": surfaces.Cylinder()}, modes=0,
        grid=ContactGrid(tangential=True, contact_fixed=True), cache=False, progress=False,
    )  # fmt: skip

    def run(strips: int, steps: int) -> Result:
        step = 2.0 * carter.HALF_WIDTH / steps / carter.SPEED
        scene = carter.braked_pair(body, 0.5)
        scene.contact(carter.PAIR).cells = (strips, 9)
        every = steps // LOOKED_AT
        return simulate(
            scene,
            6 * steps * step,
            step=step,
            start="equilibrium",
            options=RunOptions(save_every=every),
            progress=False,
        )

    exact = run(*ROLLS[1])
    for strips, steps in ROLLS[0]:
        yield from compare(f"rolling on {strips} strips", run(strips, steps), exact)


def film() -> Iterator[Stated]:
    """A journal bearing at rest under its load."""
    states = {}
    for grid in ((32, 5), (64, 9), (96, 17)):
        scene = films.on_shaft(grid, 2e3, (0.0, 0.0))
        states[grid] = equilibrium(scene, progress=False)
    for grid in ((32, 5), (64, 9)):
        yield from compare(f"film of {grid[0]} x {grid[1]} nodes", states[grid], states[96, 17])


SCENES: dict[str, Callable[[], Iterator[Stated]]] = {
    "pressed rollers": pressed_rollers,
    "covers": covers,
    "crowned rollers": crowned_rollers,
    "balls": balls,
    "solid rollers": solid_rollers,
    "stresses": stresses,
    "hats": grid_nodes,
    "rolling": rolling,
    "film": film,
}


def rows(found: list[Stated]) -> list[list[str]]:
    """Of the table."""
    return [
        [s.scene, s.figure, f"{100.0 * s.true:.2g}",
         "not estimated" if np.isnan(s.stated) else f"{100.0 * s.stated:.2g}", s.source,
         "told" if s.told else "yes" if s.right else "NO"]
        for s in found
    ]  # fmt: skip
