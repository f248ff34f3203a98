"""The banded system of a film with smooth functions, compared with the dense and exact one."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from film_scenes import CLEARANCE, COLUMNS, GROOVE, ROWS, STEEL, bearing, bore_body, shaft_body

from warpffrf.model import forces, joints, oils, surfaces
from warpffrf.model.films import Film, MixedLubrication
from warpffrf.model.laws import ExponentialAsperities
from warpffrf.model.mesh import box
from warpffrf.model.scene import Scene
from warpffrf.offline import reduce
from warpffrf.online import run
from warpffrf.online.engine import Engine
from warpffrf.online.vibrations.film_system import FilmState
from warpffrf_kernels.films.sampling import STIFFNESS

STEP, STEPS = 1e-4, 6
CHANGE = 0.06  # of a stiffness: what the approximate compliance beyond some columns does; 0.045 measured
MOST = 9  # iterations of a step on a soft bore; 7 measured
ALMOST = 1e-4  # of the stiffest column: a shaft opens its gap by turning about its axis only by its eccentricity
ALGEBRA = 1e-5  # round-off times the condition of the system, 2e11

Array = np.ndarray


def pad() -> Scene:
    """A flexible plate under which a plane slides, and which is pressed on the film: columns with two ends."""
    plate = reduce(
        box((0.04, 0.03, 0.006), (12, 6, 2), order=1), STEEL, interfaces={"z_max": "rigid"},
        contact={"z_min": surfaces.Plane()}, modes=4, cache=False, progress=False,
    )  # fmt: skip
    scene = Scene(gravity=(0.0, 0.0, 0.0))
    body = scene.add_body(plate, name="pad", position=(0.0, 0.0, 0.003 + 30e-6), rotation=(0.0, 3e-4, 0.0, 1.0))
    runner = scene.add_rigid_body(
        5.0, (0.1, 0.1, 0.1), name="runner", velocity=(-5.0, 0.0, 0.0),
        surfaces={"top": surfaces.Plane(origin=(0, 0, 0), outward=(0, 0, 1))},
    )  # fmt: skip
    scene.add(joints.Prismatic(scene.ground, runner, axis=(1, 0, 0)))
    scene.add(forces.PointForce(body["z_max"], (0.0, 0.0, -500.0)))
    scene.add(joints.Prismatic(scene.ground, body["z_max"], axis=(0, 0, 1)))
    scene.add(Film(body["z_min"], runner["top"], oil=oils.Newtonian(0.05), ambient_pressure=1e5, name="film"))
    return scene


SCENES: dict[str, Any] = {
    "mass-conserving": lambda: bearing((8e3, 2e3)),
    "half Sommerfeld": lambda: bearing((8e3, 2e3), cavitation="half_sommerfeld"),
    "profiles": lambda: bearing((8e3, 2e3), quadrature="reduced"),
    "asperities": lambda: bearing(
        (30e3, 0.0), speed=3.0, at=(0.9 * CLEARANCE, 0.0),
        mixed=MixedLubrication(asperities=ExponentialAsperities(1e9, 0.5e-6)),
    ),
    "shaft yields": lambda: bearing((8e3, 2e3), yielding=shaft_body()),
    "pad": pad,
}  # fmt: skip


def assembled(scene: Scene) -> Engine:
    """After some steps, with the system of the last state."""
    kept = []

    def engine_of(*given: Any, **options: Any) -> Engine:
        kept.append(Engine(*given, **options))
        return kept[-1]

    found = run(scene, STEPS * STEP, step=STEP, progress=False, engine_of=engine_of)
    assert found.status == "completed", found.message
    engine = kept[-1]
    engine.scratch.film_rates.assign(np.tile([1.5 / STEP, 0.0, 0.0], (1, 1)))
    engine.scratch.film_changed.fill_(1)  # factors are not kept
    engine.control(run=1, moved=1, refresh=1, failure=0, changes=0)
    engine.graph.move_and_load()
    engine.graph.assemble()
    return engine


def condensed(engine: Engine) -> tuple[Array, Array]:
    """Stiffness (columns, columns) and force (columns,) of the kernels."""
    films = engine.compiled.films
    columns = int(films.column_start.numpy()[-1])
    return engine.scratch.film_stiffness.numpy()[0].reshape(columns, columns), engine.scratch.film_push.numpy()[0]


def rest(engine: Engine, film: FilmState) -> Array:
    """R (x,)."""
    oil = engine.scratch.film_rest.numpy()[0][film.free]
    asperity = engine.state.film_asperity.numpy()[0, 1][: film.rough] - film.node_line[:, 0]
    return np.concatenate([oil, asperity])


@pytest.mark.parametrize("name", SCENES)
def test_bodies_see_the_dense_system(name: str) -> None:
    """Stiffness P^T J^-1 B, and the force of a residual, P^T J^-1 R, of the exact matrices."""
    engine = assembled(SCENES[name]())
    film = FilmState(engine, 0)
    J, B = film.system()
    P = film.loads()
    S, push = condensed(engine)
    expected = P.T @ np.linalg.solve(J, B)
    d = np.sqrt(np.abs(np.diag(expected)))
    d[d < ALMOST * d.max()] = np.inf
    assert np.abs((S - expected) / np.outer(d, d)).max() < CHANGE
    R = rest(engine, film)
    force = P.T @ np.linalg.solve(J, R)
    assert np.abs((push - force) / d).max() < CHANGE * np.abs(force / d).max() + 1e-9


def test_the_algebra_of_bands_seam_and_smooth_functions_is_exact() -> None:
    """The same approximate compliance in a dense matrix gives the same stiffness."""
    engine = assembled(SCENES["mass-conserving"]())
    film, films = FilmState(engine, 0), engine.compiled.films
    J, _ = film.system()
    H = (film.by_gap() @ film.between).toarray()
    n, nodes = len(film.free), film.grid_nodes
    G = films.compliance.numpy().reshape(n, nodes).T * film.acts
    r = int(films.smooth_count.numpy()[0])
    Phi, V = films.smooth.numpy().reshape(nodes, r), films.smooth_load.numpy().reshape(n, r)
    C = films.smooth_compliance.numpy().reshape(r, r)
    np.testing.assert_allclose(C, C.T, atol=0)
    column = film.free // ROWS
    apart = np.abs(np.subtract.outer(column, column))
    near = np.minimum(apart, COLUMNS - apart) <= int(films.reach.numpy()[0])
    smooth = H @ Phi @ C @ V.T * film.acts
    J = J - H @ G + np.where(near, H @ G, smooth)
    columns = int(films.column_start.numpy()[-1])
    Z = engine.scratch.film_motion.numpy()[: r * columns].reshape(r, columns)
    expected = film.loads().T @ np.linalg.solve(J, H @ Phi @ Z)
    S, _ = condensed(engine)
    d = np.sqrt(np.abs(np.diag(expected)))
    d[d < ALMOST * d.max()] = np.inf
    assert np.abs((S - expected) / np.outer(d, d)).max() < ALGEBRA


def test_a_bore_that_yields_by_its_clearance_takes_no_smaller_steps() -> None:
    """Two hundred times as soft as steel, where pressures depend on the deformation as much as on the motion."""
    scene = bearing((1e3, 0.0), body=bore_body(modulus=1.05e9))
    found = run(scene, 30 * STEP, step=STEP, progress=False)
    assert found.status == "completed", found.message
    assert found.counters["rejected_steps"] == 0 and found.counters["max_iterations"] <= MOST
    film = found.films["film"]
    opened = film.gap[-1].max() - film.gap[0].max()
    assert opened > 0.5 * CLEARANCE


def test_rough_walls_are_pressed_in_this_state() -> None:
    """The scene with asperities has some that touch."""
    engine = assembled(SCENES["asperities"]())
    assert np.count_nonzero(engine.scratch.film_node_line.numpy()[0, :, int(STIFFNESS)] > 0.0) > 3


@pytest.mark.parametrize("feeds", [[], [GROOVE]])
def test_the_seam_is_where_fewest_lines_are(feeds: list[Any]) -> None:
    """A groove that gives the pressure of a column has no lines there; without one all places are alike."""
    films = Engine(bearing((2e3, 0.0), feeds=feeds, ambient_pressure=1e5)).compiled.films
    count = np.sum(films.line_at.numpy().reshape(COLUMNS, -1) >= 0, axis=1)
    seam = int(films.seam.numpy()[0])
    some = np.sum([np.roll(count, -k) for k in range(int(films.reach.numpy()[0]))], axis=0)
    assert some[seam] == some.min()
    assert (some.min() < some.max()) == bool(feeds)
