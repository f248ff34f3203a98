"""Oil films of the engine compared with closed forms, quadrature and dry contact; a few minutes.

The same cases as of `studies.films.oil_film`, which has the law by itself; here they are scenes, which `run` and
`find_equilibrium` solve. The film stands on a flexible body, so that is one of `RIGID` times the modulus of steel,
and what it still yields is within the figures. A film of the engine ends on all sides: what is wide in a closed form is
looked at in the middle row. Rows of nodes stand `BESIDE` of the length L apart there: of a pressure sin(pi x/L) an end
is felt by none but the first row then, as nodes d apart along couple with d^2 pi^2/L^2 - 6, and other ones fall to a
fifth or less from row to row. Forces are those of pressures alone, as the closed forms have them.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cache
from typing import Any, ClassVar

import numpy as np

from references.closed_forms.cavitation import PartingPlates, ruptured_slider
from references.closed_forms.films import (
    HALF_CYLINDER,
    REYNOLDS_CYLINDER,
    JournalBearing,
    falling_time,
    plane_slider,
    squeezed_plate,
)
from references.films.grid import FilmGrid
from scenes.elastic_journal import ASPERITIES, HEAVY
from scenes.film_bearing import (
    CLEARANCE,
    GROOVE,
    LENGTH,
    RADIUS,
    RIGID,
    SPEED,
    STEEL,
    TURN,
    VISCOSITY,
    bearing,
    bore,
    completed,
    pressed,
)
from warpffrf.model import films, forces, joints, oils, signals, surfaces
from warpffrf.model.contact import Contact
from warpffrf.model.films import Film
from warpffrf.model.integrators import GeneralizedAlpha
from warpffrf.model.mesh import box, roller
from warpffrf.model.reduced.body import ReducedBody
from warpffrf.model.scene import Scene
from warpffrf.offline import reduce
from warpffrf.online import History, run
from warpffrf.online.run import find_equilibrium
from warpffrf.study.markdown import table

BESIDE = float(np.sqrt(6.0)) / np.pi  # of the length of the pressure, between rows
ACROSS = 8  # cells from end to end, of pads
THICK = 0.3  # of the length of a pad
LIGHT = 0.1  # kg: inertia takes 1e-4 of the force

Array = np.ndarray


@dataclass(frozen=True)
class Row:
    """A case on a `grid`, what is `compared`, the figure, and the target (largest size); text where it is no error."""

    case: str
    grid: str
    compared: str
    error: float
    target: float
    told: str = ""

    @property
    def reached(self) -> bool:
        """Whether the target is."""
        return bool(abs(self.error) <= self.target)

    def cells(self) -> list[str]:
        """Of the table."""
        most = "1 cell" if self.told.endswith("cells") else _percent(self.target)[1:]
        found = self.told or _percent(self.error)
        return [self.case, self.grid, self.compared, found, most, "" if self.reached else "missed"]


def _percent(value: float) -> str:
    return f"{100.0 * value:+.2g} %"


@dataclass(frozen=True)
class Profile(films.Form):
    """A gap h(theta) [m] of a pad, against the distance of its plane."""

    gap: Callable[[Array], Array]
    kind: ClassVar[str] = "profile"

    def __call__(self, theta: Any, z: Any) -> Array:
        theta, _ = np.broadcast_arrays(np.asarray(theta, float), np.asarray(z, float))
        return self.gap(theta)

    def describe(self) -> dict[str, Any]:
        return {"kind": self.kind, "gap": self.gap(np.linspace(-1.0, 1.0, 65)).tolist()}


# --- pads


def wide(length: float, cells: int, across: int = ACROSS, pressed: float = 1.0) -> ReducedBody:
    """The plate of a pad that is meant to be wide; pressed: part of the length [m] that carries."""
    return plate(length, across * BESIDE * pressed * length, (cells, across))


@cache
def plate(length: float, width: float, counts: tuple[int, int]) -> ReducedBody:
    """A stiff block under a film at z = 0 of the world, `length` along x and `width` along y [m] in so many cells. It
    reaches one cell further along x at both ends: no node of the film reaches beyond it."""
    thick, more = THICK * length, (counts[0] + 2) / counts[0]
    mesh = box((more * length, width, thick), (counts[0] + 2, counts[1], 1), center=(0.0, 0.0, -0.5 * thick), order=1)
    return reduce(
        mesh, replace(STEEL, youngs_modulus=RIGID * STEEL.youngs_modulus), interfaces={"z_min": "rigid"},
        contact={"z_max": surfaces.Plane()}, modes=2, cache=False, progress=False,
    )  # fmt: skip


def above(
    body: ReducedBody, shape: Any, *, height: float, velocity: tuple[float, float, float] = (0.0, 0.0, 0.0),
    axis: tuple[float, float, float] = (1.0, 0.0, 0.0), mass: float = 1.0, **film: Any,
) -> tuple[Scene, Any]:  # fmt: skip
    """A rigid body with the surface `shape`, which begins `height` [m] above the plate and slides along `axis`; and its
    joint."""
    scene = Scene(gravity=(0.0, 0.0, 0.0))
    low = scene.add_body(body, name="plate")
    scene.add(joints.Fixed(scene.ground, low["z_min"], axis=(0, 0, 1), name="held"))
    high = scene.add_rigid_body(
        mass, (1.0, 1.0, 1.0), name="runner", position=(0.0, 0.0, height), velocity=velocity, surfaces={"face": shape}
    )  # fmt: skip
    guide = scene.add(joints.Prismatic(scene.ground, high.at((0, 0, 0)), axis=axis, name="guide"))
    given: dict[str, Any] = {"oil": oils.Newtonian(VISCOSITY), "name": "film"} | film
    scene.add(Film(low["z_max"], high["face"], **given))
    return scene, guide


FACE = surfaces.Plane(origin=(0, 0, 0), outward=(0, 0, -1), direction=(0, 1, 0))


def along_x(body: ReducedBody) -> tuple[Array, float]:
    """Places of the columns [m] of the world's x, ascending, and the sign of theta in it."""
    surface = body.contact_surfaces["z_max"]
    grid, shape = surface.grid, surface.shape
    sign = float(np.sign(np.asarray(shape.e_1)[0]))
    x = np.array([shape.point(theta, 0.0)[0] for theta in grid.theta])
    return np.sort(x), sign


def middle(body: ReducedBody, field: Array) -> Array:
    """Of a field (columns, rows) its middle row, along x."""
    row = field[:, field.shape[1] // 2]
    return row if along_x(body)[1] > 0.0 else row[::-1]


def sliding(scene: Scene, guide: Any, speed: float) -> History:
    """At rest, as if steady, with the runner sliding at `speed` [m/s] along x."""
    scene.add(joints.Drive(guide, signals.Constant(speed), quantity="velocity"))
    return completed(find_equilibrium(scene))


def trapezoid(x: Array, values: Array) -> float:
    """Integral of nodes."""
    return float(np.sum(0.5 * (values[1:] + values[:-1]) * np.diff(x)))


def of_x(body: ReducedBody, gap: Callable[[Array], Array]) -> Profile:
    """A gap h(x) [m] as a form of the plate."""
    shape = body.contact_surfaces["z_max"].shape
    start, sign = float(np.asarray(shape.axis_point)[0]), along_x(body)[1]
    return Profile(lambda theta: gap(start + sign * theta))


def slider_rows(cells: int = 64, ratio: float = 2.0) -> list[Row]:
    """A plane slider, gaps `ratio` to 1: the runner comes from where it is wide."""
    length, low, speed = 0.02, 20e-6, 1.0
    body = wide(length, cells)
    form = of_x(body, lambda x: (ratio - 1.0) * low * (0.5 - x / length))
    scene, guide = above(
        body, FACE, height=low, velocity=(speed, 0, 0), cavitation="full_sommerfeld", ambient_pressure=1.0, form_a=form
    )
    found = sliding(scene, guide, speed)
    force = trapezoid(along_x(body)[0], middle(body, found.films["film"].pressure[-1]))
    exact = plane_slider(ratio * low, low, length, viscosity=VISCOSITY, speed=speed)
    return [Row(f"plane slider, gaps {ratio:g} to 1", f"{cells} cells", "force", force / exact - 1.0, 1e-3)]


def cylinder_rows(cells: int = 192) -> list[Row]:
    """A cylinder on a plane, cut at 13 root(2 R h)."""
    radius, low, speed = 0.2, 2e-6, 0.1
    length = 26.0 * float(np.sqrt(2.0 * radius * low))
    body = wide(length, cells, 6, 4.0 / 26.0)
    shape = surfaces.Cylinder(radius=radius, axis_point=(0, 0, radius), axis_direction=(0, 1, 0))
    rows = []
    for mode, closed, target in (("reynolds", REYNOLDS_CYLINDER, 0.02), ("half_sommerfeld", HALF_CYLINDER, 0.02)):
        ambient: dict[str, Any] = {"ambient_pressure": 1.0} if mode == "half_sommerfeld" else {}
        scene, guide = above(body, shape, height=low, velocity=(speed, 0, 0), cavitation=mode, **ambient)
        found = sliding(scene, guide, speed)
        p = np.maximum(middle(body, found.films["film"].pressure[-1]), 0.0)
        force = trapezoid(along_x(body)[0], p)
        exact = closed * VISCOSITY * 0.5 * speed * radius / low
        rows.append(Row(f"cylinder on a plane, cut at 13 root(2 R h), {mode}", f"{cells} cells", "force",
                        force / exact - 1.0, target))  # fmt: skip
    return rows


def ruptured_rows(cells: int = 128) -> list[Row]:
    """A parabolic slider whose film ruptures and forms again."""
    length, narrow, open_at, speed, viscosity, outlet = 76.2e-3, 25.4e-6, 50.8e-6, 4.57, 0.04, 0.336e6

    def gap(x: Any) -> Any:
        return narrow + (open_at - narrow) * (2.0 * x / length - 1.0) ** 2

    exact = ruptured_slider(gap, length, 0.5 * length, viscosity=viscosity, speed=speed, inlet=0.0, outlet=outlet)
    body = wide(length, cells, 12)  # ends feel the cavity, which is shorter
    grid = body.contact_surfaces["z_max"].grid
    form = of_x(body, lambda x: gap(x + 0.5 * length) - narrow)
    last = float(grid.theta[-1] if along_x(body)[1] > 0.0 else grid.theta[0])
    scene, guide = above(
        body, FACE, height=narrow, velocity=(speed, 0, 0), oil=oils.Newtonian(viscosity), form_a=form,
        feeds=[films.AxialGroove(last, 0.1 * float(grid.pitch), outlet)],
    )  # fmt: skip
    film = sliding(scene, guide, speed).films["film"]
    x = along_x(body)[0] + 0.5 * length
    force = trapezoid(x, middle(body, film.pressure[-1]))
    void = np.flatnonzero(middle(body, film.void[-1]) > 0.0)
    case, on = "parabolic slider that ruptures and fills again", f"{cells} cells"
    off = [(x[void[0]] - exact.rupture) / x[1], (x[void[-1]] - exact.refill) / x[1]]
    return [
        Row(case, on, "force", force / exact.force - 1.0, 5e-4),
        *(
            Row(case, on, name, float(value) / cells, 1.0 / cells, f"{value:+.2f} cells")
            for name, value in zip(("rupture", "refill"), off, strict=True)
        ),
    ]


def squeeze_rows(counts: Sequence[int] = (32,)) -> list[Row]:
    """A square plate that begins to come down: Reynolds' equation of its velocity."""
    size, height, speed = 0.02, 20e-6, 1e-3
    rows = []
    for n in counts:
        body = plate(size, size, (n, n))
        scene, _ = above(
            body, FACE, height=height, velocity=(0, 0, -speed), axis=(0, 0, 1), mass=1e6, cavitation="full_sommerfeld",
            ambient_pressure=1.0,
        )  # fmt: skip
        found = completed(run(scene, 1e-5, step=1e-5, progress=False))
        grid = body.contact_surfaces["z_max"].grid
        force = float(FilmGrid(grid.theta, grid.z).area @ found.films["film"].pressure[-1].ravel())
        exact = squeezed_plate(size, size) * VISCOSITY * speed / found.bodies["runner"].position[-1][2] ** 3
        rows.append(Row("square plate, squeezed", f"{n} x {n}", "force", force / exact - 1.0, 2e-3))
    return rows


def falling_rows(counts: int = 32, numbers: Sequence[int] = (10, 20)) -> list[Row]:
    """A light plate that falls to half the gap under a constant force: of 1/h^2, straight in time."""
    size, height, load = 0.02, 20e-6, 100.0
    body, shape = plate(size, size, (counts, counts)), squeezed_plate(size, size)
    speed = load * height**3 / (shape * VISCOSITY)
    duration = falling_time(shape, load, VISCOSITY, height, 0.5 * height)
    rows = []
    for steps in numbers:
        scene, _ = above(
            body, FACE, height=height, velocity=(0, 0, -speed), axis=(0, 0, 1), mass=LIGHT,
                cavitation="full_sommerfeld",
            ambient_pressure=1.0,
        )  # fmt: skip
        scene.add(forces.PointForce(scene.bodies[1].at((0, 0, 0)), (0.0, 0.0, -load)))
        found = completed(
            run(scene, duration, step=duration / steps, progress=False, integrator=GeneralizedAlpha(0.5))
        )  # fmt: skip
        h = found.bodies["runner"].position[:, 2]
        error = (h[-1] ** -2 - height**-2) / (3.0 * height**-2) - 1.0
        case = f"plate that falls to half the gap in {steps} steps"
        rows.append(Row(case, f"{counts} x {counts}", "1/h²", float(error), 2e-3))
    return rows


def parting_rows(cells: int = 200, steps: int = 400) -> list[Row]:
    """Plates that part and meet: the largest cavity, and when it collapses."""
    given = PartingPlates(5e-3, 25e-6, 10e-6, 0.02, 0.015, 1e5)
    time, half = given.cavity()
    length, step = 2.0 * given.half_width, given.period / steps
    body = wide(length, cells, 4)
    t = step * np.arange(-20, steps + 21)
    height = float(given.gap(0.5 * given.period))
    course = signals.Table(t, np.asarray(given.gap(t + 0.5 * given.period)) - height, cubic=True)
    scene, guide = above(
        body, FACE, height=height, axis=(0, 0, 1), oil=oils.Newtonian(given.viscosity), ambient_pressure=given.ambient
    )  # fmt: skip
    scene.add(joints.Drive(guide, course, quantity="position"))
    found = completed(run(scene, 0.8 * given.period, step=step, progress=False))
    void = np.array([middle(body, field) > 0.0 for field in found.films["film"].void])
    counts, pitch = void.sum(axis=1), length / cells
    widest = float(counts.max()) * 0.5 * pitch / given.half_width
    collapse = float(found.time[counts > 0][-1]) / given.period + 0.5
    case, on = "plates that part and meet", f"{cells} cells, {steps} steps a period"
    largest, end = float(half.max()) / given.half_width, float(time[-1]) / given.period
    return [
        Row(case, on, f"largest cavity over half the width, {largest:.4f}", widest / largest - 1.0, 0.01),
        Row(case, on, f"collapse over the period, {end:.4f}", collapse / end - 1.0, 0.01),
    ]


# --- bearings


def long_rows(grid_nodes: tuple[int, int] = (128, 17)) -> list[Row]:
    """A whole film, of which the middle row has no ends."""
    length = (grid_nodes[1] - 1) * float(np.sqrt(6.0)) * RADIUS  # of a pressure that goes once around, as `BESIDE`
    body, rows = bore(grid_nodes, length, RIGID), []
    for e in (0.5, 0.9):
        scene = bearing(body, None, at=(e, 0.0), cavitation="full_sommerfeld", ambient_pressure=1.0)
        found = completed(find_equilibrium(scene))
        grid = body.contact_surfaces["bore"].grid
        p = found.films["film"].pressure[-1][:, grid_nodes[1] // 2]
        own = np.sinc(0.5 * grid.pitch / np.pi) ** 2 * grid.pitch  # of the nodes with cos and sin
        force = RADIUS * own * np.array([p @ np.cos(grid.theta), p @ np.sin(grid.theta)])
        exact = JournalBearing(RADIUS, 1.0, CLEARANCE, VISCOSITY, SPEED * RADIUS).long(e)
        rows.append(Row(f"long bearing, whole film (Sommerfeld), eccentricity {e:g}", f"{grid_nodes[0]} columns",
                        "force of the middle row", float(np.hypot(*force)) / exact - 1.0, 2e-3))  # fmt: skip
    return rows


def short_rows(grid_nodes: tuple[int, int] = (128, 9), ratio: float = 0.05) -> list[Row]:
    """Ocvirk's bearing."""
    length = ratio * 2.0 * RADIUS
    body, rows = bore(grid_nodes, length, RIGID), []
    for e in (0.5, 0.8):
        scene = bearing(body, None, at=(e, 0.0), cavitation="reynolds")
        force = pressed(body, completed(find_equilibrium(scene)).films["film"].pressure[-1])
        load, attitude = JournalBearing(RADIUS, length, CLEARANCE, VISCOSITY, SPEED * RADIUS).short(e)
        turned = float(np.degrees(np.arctan2(force[1], -force[0]) - attitude))
        case, on = f"short bearing, L/D {ratio:g} (Ocvirk), eccentricity {e:g}", f"{grid_nodes[0]} x {grid_nodes[1]}"
        rows.append(Row(case, on, f"force (attitude {turned:+.2g}°)", float(np.hypot(*force)) / load - 1.0, 0.02))
    return rows


@cache
def stiff_shaft(grid_nodes: tuple[int, int]) -> ReducedBody:
    """A ring whose rim carries the film, and that is held inside."""
    mesh = roller(RADIUS - CLEARANCE, 0.005, LENGTH, sectors=grid_nodes[0], layers=2, order=1, axial=grid_nodes[1] - 1)
    return reduce(
        mesh, replace(STEEL, youngs_modulus=RIGID * STEEL.youngs_modulus), interfaces={"bore": "rigid"},
        contact={"rim": surfaces.Cylinder()}, modes=2, cache=False, progress=False,
    )  # fmt: skip


def on_shaft(grid_nodes: tuple[int, int], load: float, at: tuple[float, float]) -> Scene:
    """A shaft that carries the grid, in a rigid bore of the ground."""
    scene = Scene(gravity=(0.0, 0.0, 0.0))
    shaft = scene.add_body(
        stiff_shaft(grid_nodes), name="shaft", position=(at[0], 0.0, -at[1]), angular_velocity=(0.0, SPEED, 0.0)
    )  # fmt: skip
    round_it = surfaces.Bore(radius=RADIUS, axis_point=(0, 0, 0), axis_direction=(0, 1, 0))
    housing = scene.ground.surface(round_it, name="housing")
    plane = scene.add(joints.Planar(scene.ground.at((0, 0, 0)), shaft["bore"], axis=(0, 1, 0), name="plane"))
    scene.add(joints.Drive(plane, signals.Constant(SPEED), quantity="velocity"))
    scene.add(forces.PointForce(shaft["bore"], (load, 0.0, 0.0)))
    scene.add(Film(shaft["rim"], housing, oil=oils.Newtonian(VISCOSITY), cavitation="reynolds", name="film"))
    return scene


def grid_rows(grid_nodes: tuple[int, int] = (64, 9), load: float = 2e3, turns: int = 3) -> list[Row]:
    """The same bearing with the grid on the shaft and in the bore: at rest, and turning by a column per step."""
    own = bearing(bore(grid_nodes, LENGTH, RIGID), (load, 0.0), cavitation="reynolds")
    exact = _place(completed(find_equilibrium(own)))
    still = _place(completed(find_equilibrium(on_shaft(grid_nodes, load, (0.3 * CLEARANCE, 0.0)))))
    step = TURN / grid_nodes[0]
    scene = on_shaft(grid_nodes, load, (exact[0] * CLEARANCE, exact[1] * CLEARANCE))
    found = completed(run(scene, turns * TURN, step=step, start="equilibrium", progress=False))
    x = found.bodies["shaft"].position[-grid_nodes[0] :]
    moving = np.array([x[:, 0].mean(), -x[:, 2].mean()]) / CLEARANCE
    size, on = float(np.hypot(*exact)), f"{grid_nodes[0]} x {grid_nodes[1]}"
    case = "grid on the shaft compared with grid in the bore"
    return [
        Row(case, on, "place at rest, over the eccentricity", float(np.hypot(*(still - exact))) / size, 0.01),
        Row(case, f"{on}, a column per step", "place, likewise", float(np.hypot(*(moving - exact))) / size, 0.01),
    ]


def _place(found: History) -> Array:
    x = found.bodies["shaft"].position[-1] / CLEARANCE
    return np.array([x[0], -x[2]])


def dry_rows(grid_nodes: tuple[int, int] = (64, 9), speeds: Sequence[float] = (3.0, 0.3)) -> list[Row]:
    """Asperities against a film that hardly carries, and dry contact by the same law."""
    body, rows = bore(grid_nodes), []
    scene = bearing(body, (HEAVY, 0.0), speed=0.0, feeds=[GROOVE], at=(0.9, 0.0))
    first, second = scene.films.pop().ports
    scene.add(Contact(first, second, law=ASPERITIES, name="dry"))
    dry = completed(find_equilibrium(scene))
    place, largest = dry.bodies["shaft"].position[-1][0], float(dry.contacts["dry"].pressure[-1].max())
    for speed in speeds:
        wet = completed(
            find_equilibrium(
                bearing(body, (HEAVY, 0.0), speed=speed, feeds=[GROOVE], mixed=films.MixedLubrication(ASPERITIES))
            )
        )
        film, x = wet.films["film"], wet.bodies["shaft"].position[-1]
        case, on = (
            f"asperities and film at {speed:g} rad/s compared with dry contact",
            f"{grid_nodes[0]} x {grid_nodes[1]}",
        )
        rows += [
            Row(case, on, "largest pressure of asperities", film.largest_asperity_pressure[-1] / largest - 1.0, 0.05),
            Row(case, on, "eccentricity", float(np.hypot(x[0], x[2])) / place - 1.0, 0.05),
        ]
    return rows


CASES: dict[str, Callable[[], list[Row]]] = {
    "short": short_rows, "long": long_rows, "slider": slider_rows, "cylinder": cylinder_rows, "squeeze": squeeze_rows,
    "falling": falling_rows, "ruptured": ruptured_rows, "parting": parting_rows, "grids": grid_rows, "dry": dry_rows,
}  # fmt: skip


def compute() -> list[Row]:
    """Rows of all cases."""
    return [row for case in CASES.values() for row in case()]


def page(found: list[Row]) -> str:
    """Markdown."""
    missed = [row for row in found if not row.reached]
    return f"""# Oil films of the engine compared with closed forms

Closed forms, quadrature and dry contact compared with scenes that `find_equilibrium` and `run` solve; the law by itself
compared with the same is in [oil_film.md](oil_film.md). The body under the film is {RIGID:g} times as stiff as steel,
but for the asperities, which stand in a steel bore. Radius {1e3 * RADIUS:g} mm, clearance {1e6 * CLEARANCE:g} µm,
{VISCOSITY:g} Pa s, {SPEED:g} rad/s unless stated otherwise.

A film of the engine ends on all sides, so that pads and long bearings are looked at in their middle row. Rows stand
{BESIDE:.2f} of the length of the pressure apart: there nodes d apart along do not couple in a pressure that goes as a
half sine, and the ends are not felt. Fewer rows farther apart would alternate.

{len(found) - len(missed)} of {len(found)} targets are reached.

{table(["case", "grid", "compared", "found", "target", ""], [row.cells() for row in found])}
{READ}"""


READ = """\
Of the short bearing 1.6 % are the bilinear pressure along, 1/64 of a parabola over eight cells; the rest is that 0.05
is not 0, as the closed form has it, and grows with the eccentricity.
The cylinder has equal columns here, 0.14 of root(2 R h) apart, and the cut inlet takes most of what is off.

The plate under a constant force comes down from a velocity that fits the force but for what the grid leaves of it, in
steps of a tenth of the whole time. The first of them are taken again in halves: what the grid leaves of the force,
0.15 %, accelerates a plate this light by far more than the film then lets it move, and throws it out of its place from
step to step. What that leaves of 1/h² goes up and down with the number of steps.
"""
