"""Oil films in what is made of a run: histories from saved rows, files, arrays, report, plots, recordings."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import fields, replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import h5py
import numpy as np
import pytest
from recordings import columns

from warpffrf.model import films, oils, surfaces
from warpffrf.model import rotation as rot
from warpffrf.model.errors import InputError
from warpffrf.model.files.sealed_file import seal
from warpffrf.model.films import Film
from warpffrf.model.reduced.body import ReducedBody
from warpffrf.model.reduced.contact_grid import SurfaceGrid
from warpffrf.model.reduced.contact_surface import ContactSurface, Recovery
from warpffrf.model.reduced.data import DisplaySurface, Interface
from warpffrf.model.scene import Scene
from warpffrf.online.history.films import eccentricity, film_histories
from warpffrf.online.history.history import ENERGY_LINES, BodyHistory, FilmHistory, History
from warpffrf.online.stages import joined_parts
from warpffrf.output.bodies.normal_loads import node_forces
from warpffrf.output.budget.quantities import quantities
from warpffrf.output.files.fields import FILM_FIELDS, FILM_HEAT_FIELDS, FILM_SECOND_FIELDS
from warpffrf.output.plots.figure import write_figure
from warpffrf.output.plots.films import FILM_PLOTS
from warpffrf.output.recording.recorder import record
from warpffrf.output.result import Result
from warpffrf_kernels.core.films import HEATS, NUMBERS

R, CLEARANCE, WALL = 0.03, 40e-6, 1.5  # m, m, outer over inner radius
COLUMNS, ROWS, STEPS = 24, 7, 6
Z = np.linspace(-0.008, 0.012, ROWS)  # m, not about the middle of the shape
MIDDLE = 0.002
SHAFT_CENTER = np.array([0.001, 0.02, -0.003])  # m, of its mass
CENTER, MASS_CENTER = np.array([0.01, 0.004, -0.02]), np.array([0.02, 0.003, 0.001])  # m, user frame of the sleeve
AXIS = (0.0, 1.0, 0.0)
BORE = surfaces.Bore(radius=R, axis_point=CENTER, axis_direction=AXIS)
SHAFT = surfaces.Cylinder(radius=R - CLEARANCE, axis_point=(0.0, 0.0, 0.005), axis_direction=AXIS)
PEAK, COMPLIANCE = 8e6, 1e-12  # Pa, m/N: outwards under a node
PRESSED = np.array([250.0, 40.0, -1500.0])  # N, in the first step


def sleeve(shape: Any = BORE, name: str = "bore", grid: SurfaceGrid | None = None) -> ReducedBody:
    """A tube about y with the surface `shape` inside, or another body with it; each node moves its own node."""
    grid = SurfaceGrid(shape.e_0, 0.1, 2.0 * np.pi / COLUMNS, COLUMNS, True, Z, 1) if grid is None else grid
    theta, z = np.meshgrid(grid.theta, grid.z, indexing="ij")
    inner, outwards = shape.point(theta, z).reshape(-1, 3), shape.normal(theta, z).reshape(-1, 3)
    points = np.concatenate([inner, inner - (WALL - 1.0) * R * outwards])
    nodes, block = grid.columns * grid.rows, grid.columns_per_sector * grid.rows
    transfer = np.zeros((2 * nodes, 3, nodes), dtype=np.float32)
    transfer[np.arange(nodes), :, np.arange(nodes)] = COMPLIANCE * outwards
    surface = ContactSurface(
        name, shape, grid, np.zeros((nodes // block, block, block)), np.zeros((nodes, 0)),
        Recovery(transfer.reshape(1, -1, nodes), 1, np.eye(3)),
    )  # fmt: skip
    j, k = np.meshgrid(np.arange(grid.columns - (not grid.periodic)), np.arange(ROWS - 1), indexing="ij")
    a, b = (j * ROWS + k).ravel(), ((j + 1) % grid.columns * ROWS + k).ravel()
    faces = np.concatenate([np.stack([a, a + 1, b + 1], axis=1), np.stack([a, b + 1, b], axis=1)])
    return ReducedBody(
        mass=2.0, center_of_mass=MASS_CENTER, inertia=np.diag([2e-3, 3e-3, 2e-3]), frequencies=np.zeros(0),
        interfaces={"outside": Interface("rigid", np.zeros(3), np.zeros((0, 6)))}, contact_surfaces={name: surface},
        surface=DisplaySurface(points, np.concatenate([faces, faces[:, ::-1] + nodes]), np.zeros((0, 2 * nodes, 3))),
        report={}, provenance={},
    )  # fmt: skip


def bearing() -> Scene:
    """A rigid shaft in the bore of a flexible sleeve."""
    scene = Scene()
    bore = scene.add_body(sleeve(), name="sleeve")["bore"]
    journal = scene.add_rigid_body(
        1.0, (1e-3,) * 3, name="shaft", position=CENTER - np.array(SHAFT.axis_point), center_of_mass=SHAFT_CENTER,
        surfaces={"journal": SHAFT},
    )["journal"]  # fmt: skip
    feeds = [films.AxialGroove(0.0, 1e-3, 2e5)]
    oil = oils.iso_vg(46, temperature=40.0, heat_capacity=2000.0)
    scene.add(
        Film(
            bore, journal, oil=oil, feeds=feeds, ambient_pressure=1e5, name="bearing",
            temperature=films.FilmTemperature(45.0, wall_b=50.0),
        )
    )  # fmt: skip
    return scene


def motion(position: Any, rotation: Any, steps: int = STEPS) -> BodyHistory:
    """Of a body that stands, or moves from place to place."""
    zero = np.zeros((steps, 3))
    placed, turned = (
        np.broadcast_to(np.asarray(x, float), (steps, n)).copy() for x, n in ((position, 3), (rotation, 4))
    )
    return BodyHistory(placed, turned, zero, zero.copy(), np.zeros((steps, 0)), zero.copy(), zero.copy())


def spun(axis: Any, angle: float) -> np.ndarray:
    """Unit quaternion of a turn by `angle` [rad]."""
    axis = np.asarray(axis, float) / np.linalg.norm(axis)
    return np.append(np.sin(0.5 * angle) * axis, np.cos(0.5 * angle))


TURN = spun((0.3, 1.0, -0.2), 0.8)
PLACE = np.array([0.4, -0.1, 0.2])


def shaft_at(off: np.ndarray, tilt: np.ndarray, *, first: BodyHistory, shape: Any = BORE, second: Any = SHAFT) -> Any:
    """Motion of the second body whose axis goes through the middle of the film, `off` (2,) [m] from that of the first
    along e_0 and e_1, and has rotated by `tilt` about that place."""
    A = rot.matrix(first.rotation[0])
    middle = shape.axis_point + MIDDLE * shape.e_a + off @ shape.frame[:2]
    rotation = rot.quaternion(A @ rot.matrix(tilt))
    arm = np.asarray(second.axis_point) + MIDDLE * second.e_a
    return motion(first.position[0] + A @ middle - rot.matrix(rotation) @ arm, rotation)


def made_rows() -> dict[str, np.ndarray]:
    """Saved rows of one film, whose eccentricity goes around."""
    grid = sleeve().contact_surfaces["bore"].grid
    turn = 0.9 * np.arange(STEPS)
    theta, z = np.meshgrid(grid.theta, Z, indexing="ij")
    lean = theta - turn[:, None, None]
    gap = CLEARANCE * (1.0 - 0.7 * np.cos(lean))
    bell = 1.0 - ((z - MIDDLE) / (Z[-1] - MIDDLE)) ** 2
    pressure = 1e5 + PEAK * bell * np.maximum(np.sin(-lean), 0.0) ** 2
    void = np.where(np.sin(lean) > 0.5, 0.3 * gap * bell, 0.0)
    flat = {n: v.reshape(STEPS, -1) for n, v in (("pressure", pressure), ("gap", gap), ("void", void))}
    flat["asperity"] = 0.25 * flat["pressure"]
    flat["temperature"] = 45.0 + 1e-6 * flat["pressure"]
    saved = np.zeros((STEPS, 1, NUMBERS))
    saved[:, 0, :3] = PRESSED * (1.0 + 0.1 * np.arange(STEPS))[:, None]
    saved[:, 0, 3:9] = [1.0, -2.0, 0.5, 0.25, 3.0, -0.75]
    saved[:, 0, 9] = gap.min(axis=(1, 2))
    saved[:, 0, 10] = pressure.max(axis=(1, 2))
    saved[:, 0, 11:] = np.array([12.0, 80.0, 3e-6, 2.5e-6, 0.04, 1e-7, 5.0, 1e4]) * (1.0 + np.arange(STEPS))[:, None]
    heat = np.tile(np.arange(10.0, 10.0 + HEATS), (STEPS, 1, 1))
    return {
        "saved_film": saved,
        "saved_film_heat": heat,
        **{f"saved_film_{name}": values for name, values in flat.items()},
    }


def compiled(found: list[Film]) -> Any:
    """As far as histories of films look at a compiled scene."""
    starts = np.cumsum([0, *[film.grid.columns * film.grid.rows for film in found]])
    topic = SimpleNamespace(**dict.fromkeys(("node_start", "heat_start"), SimpleNamespace(numpy=lambda: starts)))
    return SimpleNamespace(scene=SimpleNamespace(films=found), films=topic)


def made_history() -> History:
    scene = bearing()
    first = motion(PLACE, TURN)
    off = 0.7 * CLEARANCE * np.stack([np.cos(0.9 * np.arange(STEPS)), np.sin(0.9 * np.arange(STEPS))], axis=1)
    second = shaft_at(np.zeros(2), spun(AXIS, 0.0), first=first)
    second.position += off @ BORE.frame[:2] @ rot.matrix(TURN).T
    bodies = {"sleeve": first, "shaft": second}
    time = np.linspace(0.0, 0.05, STEPS)
    return History(
        scene=scene, time=time, step_size=np.diff(time, prepend=0.0), bodies=bodies, joints={}, contacts={},
        energy={line: np.zeros(STEPS) for line in ENERGY_LINES}, iterations=np.full(STEPS, 3),
        factorisations=np.full(STEPS, 1), films=film_histories(compiled(scene.films), made_rows(), bodies),
    )  # fmt: skip


@pytest.fixture
def history() -> History:
    return made_history()


@pytest.fixture
def result(history: History) -> Result:
    return Result(history)


# --- histories


def test_numbers_and_fields_have_their_places() -> None:
    """Of the second of two films."""
    mine, other = bearing().films[0], bearing().films[0]
    other.name = "other"
    rows = {name: np.concatenate([-7.0 * values, values], axis=1) for name, values in made_rows().items()}
    bodies = {"sleeve": motion(PLACE, TURN), "shaft": motion(PLACE, TURN)}
    both = film_histories(compiled([other, mine]), rows, bodies)
    found = both["bearing"]
    assert list(both) == ["other", "bearing"] and found.pressure.shape == (STEPS, COLUMNS, ROWS)
    np.testing.assert_array_equal(found.gap[2, 5, 3], made_rows()["saved_film_gap"][2, 5 * ROWS + 3])
    np.testing.assert_array_equal(found.smallest_gap, found.gap.min(axis=(1, 2)))
    np.testing.assert_array_equal(found.largest_pressure, found.pressure.max(axis=(1, 2)))
    np.testing.assert_array_equal(found.force[0], PRESSED)
    last = [x[-1] for x in (found.pressure_loss, found.friction_power, found.feed_flow, found.end_flow)]
    np.testing.assert_allclose(
        [*last, found.void_fraction[-1], found.oil_volume[-1]], [72.0, 480.0, 18e-6, 15e-6, 0.24, 6e-7], rtol=1e-14
    )


def test_a_scene_without_films_reads_nothing() -> None:
    assert film_histories(SimpleNamespace(scene=Scene()), {}, {}) == {}  # pyright: ignore[reportArgumentType]


def test_fill() -> None:
    found = made_history().films["bearing"]
    assert found.fill[found.void == 0.0].min() == 1.0
    np.testing.assert_allclose(found.fill * found.gap, found.gap - found.void, rtol=1e-14)
    assert replace(found, gap=np.zeros_like(found.gap)).fill.min() == 1.0


@pytest.mark.parametrize("second", ["shaft", "ground"])
def test_torques_are_about_user_origins(second: str) -> None:
    """Of a force at a place; saved are moments about centres of mass, of the ground about the world's origin."""
    film = (bearing() if second == "shaft" else around_the_ground()).films[0]
    at, force = np.array([0.3, -0.2, 0.7]), made_rows()["saved_film"][:, 0, :3]
    bodies = {"sleeve": motion(PLACE, TURN)} | (
        {"shaft": motion(-2.0 * PLACE, TURN[::-1])} if second == "shaft" else {}
    )
    origin = -2.0 * PLACE if second == "shaft" else np.zeros(3)
    center = origin + rot.matrix(TURN[::-1]) @ SHAFT_CENTER if second == "shaft" else origin
    rows = made_rows()
    rows["saved_film"][:, 0, 3:6] = np.cross(at - PLACE - rot.matrix(TURN) @ MASS_CENTER, force)
    rows["saved_film"][:, 0, 6:9] = np.cross(at - center, -force)
    found = film_histories(compiled([film]), rows, bodies)["bearing"]
    np.testing.assert_allclose(found.torque, np.cross(at - PLACE, force), rtol=1e-12)
    np.testing.assert_allclose(found.torque_second, np.cross(at - origin, -force), rtol=1e-12)


# --- eccentricity

OFF = np.array([11e-6, -6e-6])
TILT = spun((1.0, 0.0, 0.3), 2e-4)


def test_a_shaft_stands_where_it_was_put_as_the_first_body_sees_it() -> None:
    for rotation in (np.array([0.0, 0.0, 0.0, 1.0]), TURN):
        for tilt in (spun(AXIS, 0.4), TILT):  # about the middle of the grid
            first = motion(PLACE, rotation)
            bodies = {"sleeve": first, "shaft": shaft_at(OFF, tilt, first=first)}
            found = eccentricity(bearing().films[0], bodies, STEPS)
            np.testing.assert_allclose(found, np.tile(OFF, (STEPS, 1)), atol=1e-12)


def test_of_a_flexible_shaft_the_inner_surface_is_the_first() -> None:
    scene = Scene()
    shaft = replace(SHAFT, axis_point=CENTER)
    journal = scene.add_body(sleeve(shaft, "journal"), name="sleeve")["journal"]
    bore = scene.add_rigid_body(1.0, (1e-3,) * 3, name="shaft", surfaces={"bore": BORE})["bore"]
    film = Film(journal, bore, oil=oils.Newtonian(0.04), ambient_pressure=1e5)
    first = motion(PLACE, TURN)
    bodies = {"sleeve": first, "shaft": shaft_at(OFF, TILT, first=first, shape=shaft, second=BORE)}
    np.testing.assert_allclose(eccentricity(film, bodies, STEPS), np.tile(-OFF, (STEPS, 1)), atol=1e-12)


def test_of_a_ball_its_centre_counts_however_it_has_rotated() -> None:
    scene = Scene()
    cup = surfaces.Cup(radius=R, axis_point=CENTER, axis_direction=AXIS)
    ball = surfaces.Sphere(radius=R - CLEARANCE, axis_point=(0.0, 0.001, 0.0), axis_direction=AXIS)
    socket = scene.add_body(sleeve(cup, "cup"), name="sleeve")["cup"]
    skin = scene.add_rigid_body(1.0, (1e-3,) * 3, name="shaft", surfaces={"skin": ball})["skin"]
    film = Film(socket, skin, oil=oils.Newtonian(0.04), ambient_pressure=1e5)
    center = CENTER + np.array([0.0, 3e-6, 0.0]) + OFF @ cup.frame[:2]
    for turn in (spun(AXIS, 0.3), spun((1.0, 0.0, 0.0), 0.5 * np.pi)):
        place = center - rot.matrix(turn) @ ball.axis_point
        bodies = {"sleeve": motion(np.zeros(3), (0.0, 0.0, 0.0, 1.0)), "shaft": motion(place, turn)}
        np.testing.assert_allclose(eccentricity(film, bodies, STEPS), np.tile(OFF, (STEPS, 1)), atol=1e-15)


def around_the_ground() -> Scene:
    """A bore around a journal that stands."""
    scene = Scene()
    bore = scene.add_body(sleeve(), name="sleeve", position=-CENTER)["bore"]
    journal = scene.ground.surface(replace(SHAFT, axis_point=(0.0, 0.0, 0.0)), name="journal")
    scene.add(Film(bore, journal, oil=oils.Newtonian(0.04), ambient_pressure=1e5, name="bearing"))
    return scene


def test_around_a_journal_that_stands_the_bore_moves() -> None:
    bodies = {"sleeve": motion(-CENTER - OFF @ BORE.frame[:2], (0.0, 0.0, 0.0, 1.0))}
    np.testing.assert_allclose(
        eccentricity(around_the_ground().films[0], bodies, STEPS), np.tile(OFF, (STEPS, 1)), atol=1e-15
    )


def pad() -> Scene:
    scene = Scene()
    plane = surfaces.Plane(origin=(0, 0, 0), outward=(0, -1, 0), direction=(0, 0, 1))
    grid = SurfaceGrid(plane.e_0, -0.01, 0.002, 11, False, np.linspace(-0.01, 0.01, ROWS), 11)
    flat = scene.add_body(sleeve(plane, grid=grid), name="pad")["bore"]
    floor = scene.ground.surface(surfaces.Plane(origin=(0, 0, 0), outward=(0, 1, 0), direction=(0, 0, 1)), name="floor")
    scene.add(Film(flat, floor, oil=oils.Newtonian(0.04), ambient_pressure=1e5, name="bearing"))
    return scene


def test_planes_have_none() -> None:
    assert np.all(np.isnan(eccentricity(pad().films[0], {"pad": motion(PLACE, TURN)}, STEPS)))


# --- results, files, arrays


def test_a_result_knows_its_films(result: Result) -> None:
    film = result.film("bearing")
    assert result.film_names == ["bearing"] and film.clearance == pytest.approx(CLEARANCE)
    np.testing.assert_allclose(film.theta, bearing().films[0].theta)
    np.testing.assert_array_equal(film.z, Z)
    np.testing.assert_allclose(film.force_magnitude[0], np.linalg.norm(PRESSED))
    np.testing.assert_allclose(np.hypot(*film.eccentricity.T), 0.7 * CLEARANCE, rtol=1e-9)
    with pytest.raises(InputError, match="no film called 'bearings'; did you mean 'bearing'. it has: 'bearing'"):
        result.film("bearings")


def test_parts_of_a_run_join(history: History) -> None:
    film = joined_parts([history, made_history()]).films["bearing"]
    assert film.pressure.shape == (2 * STEPS, COLUMNS, ROWS) and film.force.shape == (2 * STEPS, 3)


def test_the_least_film_of_the_last_part_of_a_run(result: Result) -> None:
    """Without the start, in which the film may be thinner."""
    gap = result.film("bearing").smallest_gap
    part = result.since(result.time[-2])
    assert part.film("bearing").smallest_gap.min() == gap[-2:].min()
    assert f"(least {gap[-2:].min() * 1e6:.5g})" in part.report(progress=False)


def test_errors_are_reported_of_the_force(history: History) -> None:
    assert quantities(history)["force of film 'bearing'"].size > np.linalg.norm(PRESSED)


def test_files_bring_everything_back(result: Result, tmp_path: Path) -> None:
    again = Result.load(result.save(tmp_path / "run.h5"))
    found, film = again.film("bearing"), result.film("bearing")
    for field in fields(FilmHistory):
        np.testing.assert_array_equal(getattr(found, field.name), getattr(film, field.name))
    assert {field.attribute for field in (*FILM_FIELDS, *FILM_HEAT_FIELDS, *FILM_SECOND_FIELDS)} == {
        field.name for field in fields(FilmHistory)
    }
    assert found.clearance == film.clearance and found.view.second.shape.kind == "cylinder"
    np.testing.assert_array_equal(found.theta, film.theta)
    with h5py.File(tmp_path / "run.h5") as file:
        np.testing.assert_array_equal(file["film_theta/bearing"], film.theta)  # pyright: ignore[reportArgumentType]
        stored: Any = file["film_pressure/bearing"]
        assert stored.attrs["units"] == "Pa" and stored.attrs["dims"] == "time film_column film_row"


def on_a_floor() -> Result:
    """A film on a plane."""
    scene, rows = pad(), made_rows()
    rows = {name: values if name == "saved_film" else values[:, : 11 * ROWS] for name, values in rows.items()}
    bodies = {"pad": motion(np.zeros(3), (0.0, 0.0, 0.0, 1.0))}
    found = film_histories(compiled(scene.films), rows, bodies)
    return Result(replace(made_history(), scene=scene, bodies=bodies, films=found))


def test_a_surface_of_the_ground_comes_back(tmp_path: Path) -> None:
    film = Result.load(on_a_floor().save(tmp_path / "run.h5")).film("bearing")
    assert film.clearance is None and np.all(np.isnan(film.eccentricity)) and film.view.second.shape.kind == "plane"


def without(name: str) -> Callable[[Any], None]:
    def change(file: Any) -> None:
        del file[name]

    return change


def put(name: str, change: Callable[[np.ndarray], np.ndarray]) -> Callable[[Any], None]:
    def changed(file: Any) -> None:
        values, about = change(np.array(file[name])), dict(file[name].attrs)
        del file[name]
        file.create_dataset(name, data=values).attrs.update(about)

    return changed


def nowhere(values: np.ndarray) -> np.ndarray:
    values[1] = np.nan
    return values


def of_no_scene(file: Any) -> None:
    file["scene"].attrs["films"] = "[]"


def narrower(file: Any) -> None:
    for name in ("pressure", "gap", "void", "asperity"):
        put(f"film_{name}/bearing", lambda values: values[:, 1:])(file)


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (without("film_gap"), "film_gap.* is missing"),
        (without("film_force"), "film_force is missing"),
        (put("film_void/bearing", lambda v: v[:, :, 1:]), r"film_void of 'bearing' must have shape \(6, 24, 7\)"),
        (put("film_pressure/bearing", lambda v: v[1:]), r"film_pressure of 'bearing' must have shape \(6, any, any\)"),
        (put("film_eccentricity", lambda v: v[..., :1]), r"film_eccentricity of 'bearing' must have shape \(6, 2\)"),
        (put("film_gap/bearing", nowhere), "gap of 'bearing' in films holds NaN"),
        (put("film_torque_second", nowhere), "torque_second of 'bearing' in films holds NaN"),
        (of_no_scene, "film 'bearing' has a history, but the scene has no film of this name"),
        (narrower, "film_pressure of 'bearing' has 23 columns and 7 rows, the grid of its first surface 24 and 7"),
    ],
)  # fmt: skip
def test_damaged_files_are_refused(result: Result, tmp_path: Path, change: Callable[[Any], None], said: str) -> None:
    path = result.save(tmp_path / "run.h5")
    with h5py.File(path, "a") as file:
        change(file)
    seal(path)
    with pytest.raises(InputError, match=said):
        Result.load(path)


def test_arrays(result: Result) -> None:
    data, film = result.to_xarray(), result.film("bearing")
    np.testing.assert_array_equal(data["film_force"].sel(film="bearing"), film.force)
    np.testing.assert_array_equal(
        data["film_eccentricity"].sel(film="bearing", chart_axis="e_1"), film.eccentricity[:, 1]
    )
    pressure = data["film_pressure_bearing"]
    assert pressure.dims == ("time", "film_column_bearing", "film_row_bearing") and pressure.attrs["units"] == "Pa"
    np.testing.assert_array_equal(pressure["film_row_bearing"], Z)
    np.testing.assert_array_equal(pressure["film_column_bearing"], film.theta)


# --- report and pictures


def test_report(result: Result) -> None:
    film = result.film("bearing")
    line = next(line for line in result.report().splitlines() if line.startswith("film 'bearing'"))
    size, pressure, gap = film.force_magnitude, film.largest_pressure * 1e-6, film.smallest_gap * 1e6
    assert f"force {size[-1]:.5g} N (largest {size.max():.5g})" in line
    assert f"peak pressure {pressure[-1]:.5g} MPa (largest {pressure.max():.5g})" in line
    assert f"smallest film {gap[-1]:.5g} um (least {gap.min():.5g})" in line
    assert line.endswith("friction power 480 W (largest 480); feeds 10.5 cm3/s on average")
    hottest = film.temperature[-1].max()
    assert f"temperature     {hottest:.5g} degC at the hottest place" in result.report()
    assert "heat            10 W, to oil 11, a 12, b 13, stored 14" in result.report()


def test_maps_show_the_fields_all_around(result: Result, tmp_path: Path) -> None:
    again = Result.load(result.save(tmp_path / "run.h5"))
    for kind, values in (
        ("film_pressure", result.film("bearing").pressure * 1e-6),
        ("film_gap", result.film("bearing").gap * 1e6),
        ("film_temperature", result.film("bearing").temperature),
    ):
        ax: Any = again.plot(kind, row=2)
        mesh = ax.collections[0]
        drawn, x = np.asarray(mesh.get_array()), mesh.get_coordinates()[0, :, 0]
        assert drawn.shape == (ROWS, COLUMNS + 1) and np.all(np.diff(x) > 0.0)
        assert x[-1] - x[0] == pytest.approx(360.0, abs=1e-9)
        place = np.degrees(result.film("bearing").theta)
        for j in (0, 7, COLUMNS - 1):
            apart = np.abs((x - place[j] + 180.0) % 360.0 - 180.0)
            np.testing.assert_allclose(drawn[:, np.argmin(apart)], values[2, j])
        assert "t = 20 ms" in ax.get_title() and ax.get_xlabel() == "angle from e_0 [degrees]"


def test_the_orbit_is_drawn_over_the_clearance(result: Result) -> None:
    ax: Any = result.plot("film_orbit", film="bearing")
    path = next(line for line in ax.get_lines() if len(line.get_xdata()) == STEPS)
    np.testing.assert_allclose(
        np.array(path.get_data()).T, result.film("bearing").eccentricity / result.film("bearing").clearance
    )
    assert ax.get_aspect() == 1.0 and ax.get_xlim()[1] > 1.0


def test_the_smallest_film_is_drawn_over_time(result: Result) -> None:
    ax: Any = result.plot("film_thickness")
    np.testing.assert_allclose(ax.get_lines()[0].get_ydata(), result.film("bearing").smallest_gap * 1e6)


def test_the_summary_has_every_plot(result: Result, tmp_path: Path) -> None:
    figure = result.summary()
    labelled = [axes for axes in figure.axes if axes.get_xlabel()]
    assert len(labelled) == len(FILM_PLOTS) + 2  # force and energy
    assert all("[" in axes.get_xlabel() and "[" in axes.get_ylabel() and axes.has_data() for axes in labelled)
    assert "Film force" in [axes.get_title() for axes in labelled]
    assert write_figure(result, tmp_path / "run.png").stat().st_size > 20_000
    flat = on_a_floor()
    isothermal = 1  # and no orbit
    assert len([axes for axes in flat.summary().axes if axes.get_xlabel()]) == len(FILM_PLOTS) + 1 - isothermal
    assert flat.plot("film_pressure").get_xlabel() == "along e_1 [mm]"


def test_what_cannot_be_drawn_is_said(result: Result, history: History) -> None:
    wrong: list[tuple[dict[str, Any], str]] = [
        ({"kind": "film_gap", "film": "bearings"}, "no film called 'bearings'"),
        ({"kind": "film_gap", "row": STEPS}, "row is 6; the run has the saved rows 0 to 5"),
        ({"kind": "film_flow"}, "unknown kind 'film_flow'; .*known: .*film_pressure, film_gap"),
    ]
    for options, words in wrong:
        with pytest.raises(InputError, match=words):
            result.plot(**options)
    with pytest.raises(InputError, match="no clearance circle, which takes two surfaces of revolution"):
        on_a_floor().plot("film_orbit")
    with pytest.raises(InputError, match="the scene has no oil film"):
        Result(replace(history, films={})).plot("film_gap")


def test_the_skin_has_the_pressure_and_yields_to_it(result: Result) -> None:
    skin, film = result.skins()["sleeve"], result.film("bearing")
    assert skin.contact_fields == ("pressure",)
    nodes = COLUMNS * ROWS
    whole = film.pressure[3] + film.asperity[3]
    np.testing.assert_allclose(skin.pressure(3)[:nodes], whole.ravel())
    assert not skin.pressure(3)[nodes:].any()
    push = node_forces(film.view.first, whole).ravel()
    theta, z = np.meshgrid(film.theta, Z, indexing="ij")
    outwards = BORE.normal(theta, z).reshape(-1, 3)  # of the bore towards its axis
    found = skin.displacement(3)
    np.testing.assert_allclose(found[:nodes], -COMPLIANCE * push[:, None] * outwards, rtol=1e-5, atol=1e-16)
    assert np.all(np.einsum("ni,ni->n", found[:nodes], outwards) < 0.0) and not found[nodes:].any()


@pytest.mark.parametrize("color", ["displacement", "pressure"])
def test_recording(result: Result, tmp_path: Path, color: str) -> None:
    film = result.film("bearing")
    shown = Result.load(result.save(tmp_path / "run.h5"))
    info = record(shown, tmp_path / "run.rrd", color=color)
    assert info.frames == STEPS
    curve = columns(info.path, "/plots/film_gap/bearing", "scalars")
    np.testing.assert_allclose(np.ravel(curve), film.smallest_gap * 1e6)
    np.testing.assert_allclose(
        np.ravel(columns(info.path, "/plots/film_pressure/bearing", "scalars")), film.largest_pressure * 1e-6
    )
    assert columns(info.path, "/world/shaft/solid", "vertex_positions")
    colors = columns(info.path, "/world/sleeve/surface", "vertex_colors")
    assert len(colors) == STEPS and len(np.unique(colors[0])) > 3
    flat = record(on_a_floor(), tmp_path / "flat.rrd", color=color)
    assert flat.frames == STEPS and columns(flat.path, "/world/ground/solid", "vertex_positions")
