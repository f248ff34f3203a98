"""Oil films in the monolithic system: compared with the separated solver by the same law, and with pressures at FE
nodes."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from references import monolithic
from references.monolithic.core.integrator import Formula
from references.monolithic.films.basis import node_basis
from references.monolithic.films.film import FilmState, Memory, Unknowns, rates_of
from references.monolithic.results import simulate, to_history
from references.monolithic.run import build
from references.monolithic.start import _at_rest
from scenes.film_bearing import CLEARANCE, GROOVE, SPEED, VISCOSITY, bearing, bore
from warpffrf.model import films, joints, laws, oils, signals, surfaces
from warpffrf.model.errors import InputError
from warpffrf.model.films import Film
from warpffrf.model.material import Material
from warpffrf.model.mesh import box
from warpffrf.model.scene import Scene
from warpffrf.offline import reduce
from warpffrf.online import GeneralizedAlpha, Settings, run
from warpffrf.online.run import find_equilibrium

GRID_NODES = (32, 7)
TIGHT = 2e-11  # tolerance of both solvers; squeeze flows of the small steps of a start have 1e-11 of round-off
AT_REST = 1e-8  # of the largest value: each stops at 1e-9 of the forces and flows, and powers have both in them
FLOWS_AT_REST = 1e-8  # of what the shaft carries around
MOVING = 1e-6  # of the largest value of a run: the tolerance times what some ten steps and the thinnest film make of it
# what is steady in space moves the modes of a grid that turns: they start with accelerations, which both solvers take
# from tiny steps of sizes of their own
STARTED = 1e-5
DIFFERENCES = 1e-6  # of the largest entry: central differences, round-off compared with truncation
# at nodes compared with nodes, on six columns a radian: triangles and nodes differ by the square of the pitch
NODES = 0.03
STEP = float(np.radians(2.0)) / SPEED  # s
FIELDS = ("pressure", "gap", "void")
SUMS = (
    "force", "torque", "torque_second", "smallest_gap", "largest_pressure", "pressure_loss", "friction_power",
    "void_fraction", "oil_volume", "eccentricity",
)  # fmt: skip
FLOWS = ("feed_flow", "end_flow")


class Load(signals.SmoothStep):
    """A force [N] with its negative."""

    def __neg__(self) -> Load:
        return Load(-self.start_value, -self.end_value, duration=self.duration)


def constant(scene: Scene) -> Scene:
    """With constant inertia, as the separated solver's `auto` chooses it."""
    for body in scene.bodies:
        body.level = "constant"
    return scene


def journal(load: Any = (20e3, 0.0), **film: Any) -> Scene:
    """A shaft in an elastic bore that is fed by a groove."""
    given: dict[str, Any] = {"feeds": [GROOVE]} | film
    return constant(bearing(bore(GRID_NODES), load, mass=0.1, **given))


def off(x: Any, y: Any) -> float:
    """Largest difference over the largest value."""
    x, y = np.asarray(x), np.asarray(y)
    return float(np.abs(x - y).max() / max(np.abs(x).max(), 1e-300))


def rest(scene: Scene, **options: Any) -> Any:
    """The film at rest by the monolithic solver."""
    found = monolithic.run(scene, 1e-6, step=1e-6, start="equilibrium", progress=False, **options)
    assert found.status == "completed", found.message
    return to_history(found, [])


# --- the same law


@pytest.mark.slow
@pytest.mark.parametrize(
    ("load", "film"),
    [
        (2e3, {}),
        (20e3, {"oil": oils.Barus(VISCOSITY, coefficient=1.5e-8)}),
        (20e3, {"feeds": [], "ambient_pressure": 2e5, "form_a": films.BarrelForm(2e-6, 0.02)}),
        (2e3, {"cavitation": "half_sommerfeld", "feeds": []}),
    ],
    ids=["light", "barus", "ambient", "half"],
)
def test_an_equilibrium_is_that_of_the_separated_solver(load: float, film: dict[str, Any]) -> None:
    scene = journal((load, 0.0), **film)
    a, b = find_equilibrium(scene), rest(scene)
    assert a.status == "completed", a.message
    own, other = a.films["film"], b.films["film"]
    for name in (*SUMS, *FIELDS):
        assert off(getattr(own, name)[-1], getattr(other, name)[0]) < AT_REST, name
    carried = 0.5 * SPEED * 0.025 * CLEARANCE * 0.025  # m3/s
    for name in FLOWS:
        assert np.abs(getattr(own, name)[-1] - getattr(other, name)[0]) < FLOWS_AT_REST * carried, name
    assert off(a.bodies["shaft"].position[-1], b.bodies["shaft"].position[0]) < AT_REST


@pytest.mark.slow
@pytest.mark.parametrize("cavitation", ["jfo", "reynolds", "full_sommerfeld"])
def test_a_run_is_that_of_the_separated_solver(cavitation: str) -> None:
    """A load that grows fourfold and turns within thirty degrees, from rest: the same steps, rates and voids."""
    steps = 15
    load = Load(5e3, 20e3, duration=12 * STEP), Load(0.0, 6e3, duration=15 * STEP)
    scene = journal(load, cavitation=cavitation)
    more: dict[str, Any] = {
        "step": STEP, "integrator": GeneralizedAlpha(0.8), "start": "equilibrium", "progress": False
    }  # fmt: skip
    a = run(scene, steps * STEP, settings=Settings(residual_tolerance=TIGHT), **more)
    found = monolithic.run(scene, steps * STEP, tolerance=TIGHT, **more)
    assert a.status == found.status == "completed", a.message + found.message
    b = to_history(found, [])
    own, other = a.films["film"], b.films["film"]
    assert np.ptp(own.smallest_gap) > 0.1 * own.smallest_gap.max()
    for name in (*SUMS, *FIELDS):
        assert off(getattr(own, name), getattr(other, name)) < MOVING, name
    for name in FLOWS:
        assert off(getattr(own, name)[1:], getattr(other, name)[1:]) < MOVING, name
    for body, motion in a.bodies.items():
        assert off(motion.position, b.bodies[body].position) < MOVING
        if motion.modal.size:
            assert off(motion.modal, b.bodies[body].modal) < MOVING


def pad() -> Scene:
    """A runner that slides along a pad, with a wedge of oil between them: a grid that ends on all sides."""
    body = reduce(
        box((0.04, 0.04, 0.01), (10, 8, 2)), Material(2.1e9, 0.3, 7850.0), interfaces={"z_min": "rigid"},
        contact={"z_max": surfaces.Plane()}, modes=4, cache=False, progress=False,
    )  # fmt: skip
    port = body.contact_surfaces["z_max"]
    grid, shape = port.grid, port.shape
    low, speed = 20e-6, 5.0
    wedge = np.broadcast_to(1e-3 * (grid.theta - grid.theta[0])[:, None], (grid.columns, grid.rows))
    scene = Scene(gravity=(0.0, 0.0, 0.0))
    held = scene.add_body(body, name="pad", inertia="constant")
    scene.add(joints.Fixed(scene.ground, held["z_min"], axis=(0, 0, 1), name="held"))
    along = tuple(shape.e_1)
    runner = scene.add_rigid_body(
        1.0, (1, 1, 1), name="runner", velocity=tuple(-speed * np.asarray(along)),
        surfaces={
            "face": surfaces.Plane(
                origin=(0, 0, float(shape.axis_point[2]) + low), outward=(0, 0, -1), direction=(0, 1, 0)
            )
        },
    )  # fmt: skip
    guide = scene.add(joints.Prismatic(scene.ground, runner.at((0, 0, 0)), axis=along, name="guide"))
    scene.add(joints.Drive(guide, signals.Constant(-speed), quantity="velocity"))
    form = films.MeasuredForm(grid.theta, grid.z, wedge, periodic=False)
    oil = oils.Newtonian(VISCOSITY)
    scene.add(Film(held["z_max"], runner["face"], oil=oil, cavitation="reynolds", form_a=form, name="film"))
    return scene


@pytest.mark.slow
def test_a_plane_pad_is_that_of_the_separated_solver() -> None:
    scene = pad()
    a, b = find_equilibrium(scene), rest(scene)
    own, other = a.films["film"], b.films["film"]
    assert own.largest_pressure[-1] > 1e5
    # the moment on the runner is that of the end of the tiny step of the start, half a micrometre further
    for name in ("force", "torque", "smallest_gap", "friction_power", *FIELDS[:2]):
        assert off(getattr(own, name)[-1], getattr(other, name)[0]) < AT_REST, name


@pytest.mark.slow
def test_a_bore_that_turns_around_a_shaft_of_the_ground() -> None:
    """The second surface moves nothing, and the grid turns over the film: no steady state in its frame."""
    scene = Scene(gravity=(0.0, 0.0, 0.0))
    sleeve = scene.add_body(bore(GRID_NODES), name="sleeve", inertia="constant", angular_velocity=(0.0, SPEED, 0.0))
    axle = surfaces.Cylinder(
        radius=0.025 - CLEARANCE, axis_point=(0.5 * CLEARANCE, 0, 0), axis_direction=(0, 1, 0)
    )  # fmt: skip
    hinge = scene.add(joints.Revolute(scene.ground, sleeve["outside"], axis=(0, 1, 0), name="hinge"))
    scene.add(joints.Drive(hinge, signals.Constant(SPEED), quantity="velocity"))
    shaft = scene.ground.surface(axle, name="shaft")
    oil = oils.Newtonian(VISCOSITY)
    scene.add(Film(sleeve["bore"], shaft, oil=oil, ambient_pressure=1e5, cavitation="reynolds", name="film"))
    more: dict[str, Any] = {"step": STEP, "integrator": GeneralizedAlpha(0.8), "progress": False}
    a = run(scene, 5 * STEP, settings=Settings(residual_tolerance=TIGHT), start="equilibrium", **more)
    found = monolithic.run(scene, 5 * STEP, tolerance=TIGHT, start="equilibrium", **more)
    assert a.status == found.status == "completed", a.message + found.message
    own, other = a.films["film"], to_history(found, []).films["film"]
    for name in ("force", "torque", "torque_second", "largest_pressure", "eccentricity", "pressure"):
        assert off(getattr(own, name)[1:], getattr(other, name)[1:]) < STARTED, name


# --- the equations


@pytest.mark.parametrize("at_nodes", [False, True])
def test_derivatives_are_those_of_the_equations(at_nodes: bool) -> None:
    """By pressures, voids and modes; those by the rigid coordinates are differences already."""
    scene = journal(oil=oils.Barus(VISCOSITY, coefficient=1.5e-8))
    system, state = build(scene, at_nodes=at_nodes)
    data, rng = system.films[0], np.random.default_rng(1)
    state.q[:] = 1e-9 * rng.normal(size=len(state.q))
    n = data.basis.functions
    full = data.basis.held | (rng.uniform(size=n) > 0.3)
    x = Unknowns(np.where(full, rng.uniform(0, 5e6, n), 0.0), np.where(full, 0.0, rng.uniform(1e-7, 1e-6, n)), full)
    formula = Formula(GeneralizedAlpha(0.8).coefficients, STEP)
    rates = rates_of(data, Memory.of(data, state), formula, 1.0)

    def at(p: Any, D: Any, q: Any) -> FilmState:
        trial = _at_rest(state, True)
        object.__setattr__(trial, "q", q)
        return FilmState(data, trial, rates, Unknowns(p, D, full), formula.vel)

    slopes = at(x.pressure, x.void, state.q).slopes()
    way = {"p": full * rng.normal(size=n), "D": ~full * rng.normal(size=n), "q": rng.normal(size=len(state.q))}
    sizes = {"p": 1e2, "D": 1e-11, "q": 1e-12}
    exact = {
        "p": (slopes.R_p @ way["p"], slopes.F_p @ way["p"]), "D": (slopes.R_D @ way["D"], slopes.F_D @ way["D"]),
        "q": (slopes.R_y[:, data.rigid :] @ way["q"][data.modes], slopes.F_y[:, data.rigid :] @ way["q"][data.modes]),
    }  # fmt: skip
    for name, direction in way.items():
        found = []
        for sign in (1.0, -1.0):
            moved = {"p": x.pressure, "D": x.void, "q": state.q}
            moved[name] = moved[name] + sign * sizes[name] * direction
            found.append(at(**moved))
        R = (found[0].rest - found[1].rest) / (2.0 * sizes[name])
        F = (found[0].total - found[1].total) / (2.0 * sizes[name])
        assert off(exact[name][0], R) < DIFFERENCES, name
        assert off(exact[name][1], F[: len(exact[name][1])]) < DIFFERENCES, name


def test_nodes_have_the_whole_surface_and_linear_pressures() -> None:
    film = journal().films[0]
    b = node_basis(film)
    radius, length = 0.025, 0.025
    assert b.area.sum() == pytest.approx(2.0 * np.pi * radius * length, rel=1e-12)
    assert np.abs(b.value.sum(axis=1) - 1.0).max() < 1e-12
    along = b.place[:, 1]
    assert np.abs(b.along @ along - 1.0).max() < 1e-9 and np.abs(b.around @ along).max() < 1e-9
    assert np.abs(b.to_grid @ along - np.tile(film.grid.z, film.grid.columns)).max() < 1e-12
    assert b.held.sum() == 2 * GRID_NODES[0] + (GRID_NODES[1] - 2)  # both ends and the groove
    closed = np.zeros((b.functions, 2))  # faces around an inner node close
    np.add.at(closed, b.faces[:, 0], b.normals)
    np.add.at(closed, b.faces[:, 1], -b.normals)
    ends = np.isin(along, film.grid.z[[0, -1]])
    assert np.abs(closed[~ends]).max() < 1e-12


# --- pressures at nodes


@pytest.mark.slow
@pytest.mark.parametrize("load", [2e3, 20e3])
def test_pressures_at_nodes_are_near_those_of_nodes(load: float) -> None:
    grid_nodes, nodes = (rest(journal((load, 0.0)), at_nodes=at_nodes).films["film"] for at_nodes in (False, True))
    assert off(grid_nodes.force[0], nodes.force[0]) < 1e-6  # of a given load
    assert off(grid_nodes.eccentricity[0], nodes.eccentricity[0]) < NODES
    assert nodes.largest_pressure[0] == pytest.approx(grid_nodes.largest_pressure[0], rel=NODES)
    assert nodes.end_flow[0] == pytest.approx(grid_nodes.end_flow[0], rel=NODES)
    assert nodes.void_fraction[0] == pytest.approx(grid_nodes.void_fraction[0], rel=NODES)


# --- a run like any other


@pytest.mark.slow
def test_a_result_of_it_reads_like_any_other() -> None:
    found = simulate(journal(), 4 * STEP, step=STEP, start="equilibrium", at_nodes=True, progress=False)
    assert found.status == "completed", found.message
    film = found.film("film")
    assert film.force.shape == (5, 3) and film.pressure.shape == (5, *GRID_NODES)
    assert not film.asperity_force.any()
    assert film.force[-1, 0] == pytest.approx(20e3, rel=1e-3)


@pytest.mark.slow
def test_a_run_goes_on_where_another_has_ended() -> None:
    """Rates of second order have two steps behind them."""
    scene = journal((signals.SmoothStep(5e3, 10e3, duration=6 * STEP), 0.0))
    more: dict[str, Any] = {"step": STEP, "progress": False}
    whole = monolithic.run(scene, 6 * STEP, start="equilibrium", **more)
    half = monolithic.run(scene, 3 * STEP, start="equilibrium", **more)
    other = monolithic.run(scene, 3 * STEP, start=half, **more)
    assert other.status == "completed", other.message
    assert off(whole.films["film"].force[-1], other.films["film"].force[-1]) < AT_REST
    assert off(whole.films["film"].void[-1], other.films["film"].void[-1]) < AT_REST


# --- refusals


@pytest.mark.parametrize(
    ("film", "options", "words"),
    [
        ({"quadrature": "reduced"}, {}, "quadrature 'reduced'.*quadrature='full'"),
        (
            {"mixed": films.MixedLubrication(laws.ExponentialAsperities(2e9, 0.2e-6, 2.8e-6))},
            {},
            "asperities.*leave asperities out",
        ),
        (
            {"mixed": films.MixedLubrication(roughness_a=films.Roughness(0.5e-6))},
            {},
            "smooth walls.*leave roughness out",
        ),
        ({"oil": oils.Newtonian(VISCOSITY, density=oils.DowsonHigginson())}, {}, "constant density.*leave density"),
        ({}, {"local": "hht"}, "quasi-static.*local='quasi_static'"),
        ({}, {"variant": "modified"}, "variant 'modified'.*variant='full'"),
    ],
)
def test_what_films_of_this_solver_do_not_do_is_refused(
    film: dict[str, Any], options: dict[str, Any], words: str
) -> None:  # fmt: skip
    with pytest.raises(InputError, match=f"film 'film': the monolithic reference.*{words}.*warpffrf.simulate"):
        build(journal(**film), **options)


def test_a_feed_between_the_nodes_is_refused() -> None:
    scene = journal(feeds=[films.AxialGroove(np.pi + 0.03, 1e-4, 0.0)])
    with pytest.raises(InputError, match=r"feed 1, the groove at theta = 3\.1.*between the nodes.*wider"):
        build(scene, at_nodes=True)


def test_surfaces_that_touch_at_the_start_are_refused() -> None:
    scene = journal()
    scene.bodies[1].position = np.array([1.1 * CLEARANCE, 0.0, 0.0])
    with pytest.raises(InputError, match="overlap at the start"):
        simulate(scene, STEP, step=STEP, progress=False)
