"""Quadrature "reduced" compared with "full": the same contact at a third of the points, for both kinematics."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from partner_scenes import pressed, solved

from scenes.rollers import PAIR, Path, StaticPath, guided_pair, prescribed_pair
from warpffrf.model import signals, surfaces
from warpffrf.model.contact import Contact
from warpffrf.model.errors import InputError
from warpffrf.model.reduced.body import ReducedBody
from warpffrf.model.reduced.contact_grid import SurfaceGrid
from warpffrf.model.reduced.contact_surface import ALL_ALONG, ALL_AROUND, Sampling, gauss_points
from warpffrf.model.scene import Scene
from warpffrf.offline.contact.cubature import all_points, choose_sampling
from warpffrf.online import Engine, Settings, run
from warpffrf.online.compile.sampling_rules import on_stations
from warpffrf.online.diagnosis.contact_notes import check_sampling
from warpffrf.online.start.static_equilibrium import settle

WANTED = 0.01
STEP = 2.5e-5  # s: contact that bounces at some 2 kHz is resolved


def sampled(body: ReducedBody, error: float = WANTED) -> ReducedBody:
    """The body with sampling points on its rim."""
    rim = body.contact_surfaces["rim"]
    return replace(body, contact_surfaces={"rim": replace(rim, sampling=choose_sampling(rim, error))})


def evaluated(scene: Scene, quadrature: str) -> Scene:
    scene.contacts[0].quadrature = quadrature
    for body in scene.bodies:
        body.level = "constant"
    return scene


def pressing(first: ReducedBody, second: ReducedBody, quadrature: str, **more: Any) -> Scene:
    """Rollers that are pressed together harder while they begin to roll, their grids sliding along each other."""
    load = signals.SmoothStep(40e3, 80e3, duration=1e-3)
    return evaluated(guided_pair(first, second, load=load, speed=60.0, ramp=1e-3, **more), quadrature)


# of force and approach. Equal grids roll at one phase, where few points see what all see. On unequal ones these patches
# of two columns are not resolved, and points that lie otherwise against the other grid give another force, as would
# another phase: 10 % from column to column here, see docs/studies/hertz_and_ripple.md.
TOLERANCES = {"equal": 1e-4, "other": 0.025, "crowned": 0.025}


@pytest.fixture(scope="module", params=list(TOLERANCES))
def pair(request, plain_body, other_body, crowned_body) -> tuple[ReducedBody, ReducedBody, float]:
    first = crowned_body if request.param == "crowned" else plain_body
    second = other_body if request.param == "other" else plain_body
    return sampled(first), second, TOLERANCES[request.param]


def test_all_points_are_those_of_the_engine() -> None:
    assert (Settings().theta_points, Settings().z_points) == (ALL_AROUND, ALL_ALONG)


@pytest.mark.parametrize("at_points", [False, True])
def test_a_third_of_the_points_gives_the_same_contact(pair, at_points: bool) -> None:
    first, second, tolerance = pair
    surface = first.contact_surfaces["rim"]
    assert 3 * surface.sampling.count <= len(gauss_points(surface.grid.rows, ALL_AROUND, ALL_ALONG)[0])
    settings = Settings(force_points=at_points)
    full, reduced = (
        run(
            pressing(first, second, quadrature), 2e-3, step=STEP, start="equilibrium", progress=False,
            settings=settings,
        )
        for quadrature in ("full", "reduced")
    )  # fmt: skip
    assert full.status == reduced.status == "completed", full.message + reduced.message
    a, b = full.contacts[PAIR], reduced.contacts[PAIR]
    size = np.linalg.norm(a.force, axis=1)
    assert size.min() > 1e4
    assert np.abs(np.linalg.norm(b.force, axis=1) / size - 1.0).max() < tolerance
    assert np.abs(a.approach - b.approach).max() < tolerance * np.abs(a.approach).max()
    assert np.abs(b.force + b.force_second).max() < 1e-9 * size.max()  # action and reaction
    note = [text for text in reduced.notes if "quadrature 'reduced'" in text]
    assert len(note) == 1 and f"{surface.sampling.count} of" in note[0]


def test_the_check_predicts_the_difference_at_a_held_approach(plain_body, other_body) -> None:
    """Bodies that are held: pressures of all points less those of few, where both carry the same nodes, are what the
    host computes from the latter alone."""
    path = Path.of([2e-3, 2e-3], 0.013)
    first = sampled(plain_body, 0.1)
    found = {}
    for quadrature in ("full", "reduced"):
        scene = evaluated(prescribed_pair(first, other_body, path), quadrature)
        found[quadrature] = run(scene, 1e-6, step=1e-6, start="equilibrium", progress=False)
        assert found[quadrature].status == "completed", found[quadrature].message
    full, reduced = (h.contacts[PAIR] for h in found.values())
    np.testing.assert_array_equal(full.pressure[0] > 0.0, reduced.pressure[0] > 0.0)
    rim = first.contact_surfaces["rim"]
    weight = np.kron(
        SurfaceGrid.gram_theta(replace(rim.grid, columns=full.pressure.shape[1], periodic=False)), rim.gram_z
    )
    change, whole = (reduced.pressure[0] - full.pressure[0]).ravel(), full.pressure[0].ravel()
    pressure = float(np.sqrt(change @ weight @ change / (whole @ weight @ whole)))
    forces = [float(np.linalg.norm(c.force[0])) for c in (full, reduced)]
    check = check_sampling(found["reduced"].scene.contacts[0], found["reduced"], 1)
    assert pressure > 0.01
    assert check.pressure == pytest.approx(pressure, rel=0.3)  # global modes yield, and 2 mm is not small
    assert check.force == pytest.approx(abs(forces[1] / forces[0] - 1.0), abs=0.3 * pressure)


@pytest.mark.parametrize("at_points", [False, True])
def test_all_points_as_a_list_are_all_points(pair, at_points: bool) -> None:
    """The kernels of few points, given the Gauss points, are those of all points to round-off, rolling and tilted."""
    first, second, _ = pair
    rim = first.contact_surfaces["rim"]
    places, weight = all_points(rim)
    every = Sampling(places.x, places.row, places.zeta, weight, 0.0, 0.0, 0.0, 0)
    listed = replace(first, contact_surfaces={"rim": replace(rim, sampling=every)})
    path = Path.of([6e-4, 9e-4], [0.0, 0.021], [0.0, -0.017])
    found = []
    for quadrature in ("full", "reduced"):
        scene = evaluated(prescribed_pair(listed, second, path, tilt=1e-3), quadrature)
        history = StaticPath(scene, settings=Settings(force_points=at_points)).solve(2)
        assert history.status == "completed", history.message
        found.append(history.contacts[PAIR])
    a, b = found
    size = np.abs(a.force).max()
    assert size > 1e4
    assert np.abs(a.force - b.force).max() < 1e-9 * size
    assert np.abs(a.torque - b.torque).max() < 1e-9 * size * 0.05
    assert np.abs(a.pressure - b.pressure).max() < 1e-7 * a.pressure.max()


@pytest.mark.parametrize("shape", ["plane", "sphere"])
def test_against_a_rigid_partner(plain_body, shape: str) -> None:
    """A roller on the ground, and on a large ball: no grid opposite, so that few points see what all see but for the
    edge of the patch."""
    shapes: dict[str, Any] = {
        "plane": surfaces.Plane(origin=(0.0, 0.0, -0.05), outward=(0.0, 0.0, 1.0), direction=(0.0, 1.0, 0.0)),
        "sphere": surfaces.Sphere(radius=0.5, axis_point=(0.0, 0.0, -0.55), axis_direction=(0.0, 1.0, 0.0)),
    }
    forces = []
    for quadrature in ("full", "reduced"):
        scene = pressed(sampled(plain_body), shapes[shape], [8e-4, 1.2e-3], angle=[0.0, 0.013])
        scene.contacts[0].quadrature = quadrature
        result = solved(scene, 2)
        assert result.status == "completed", result.message
        contact = result.history.contacts["pair"]
        forces.append(np.linalg.norm(contact.force, axis=1))
        assert np.abs(contact.force + contact.force_second).max() < 1e-9 * forces[-1].max()
    assert forces[0].min() > 1e4
    assert np.abs(forces[1] / forces[0] - 1.0).max() < WANTED
    check = check_sampling(scene.contacts[0], result.history)
    assert check.rows == (0, 1) and 0.0 < check.force < WANTED


def test_the_tangent_in_the_stress_modes_is_symmetric_and_definite(pair) -> None:
    first, second, _ = pair
    engine = Engine(pressing(first, second, "reduced"))
    assert settle(engine)
    active = int(np.count_nonzero(engine.state.active.numpy()))
    slots = int(np.count_nonzero(engine.scratch.slot_of.numpy()[0] >= 0))
    assert active >= 4 and slots >= active
    G = engine.scratch.G.numpy()[0][:active, :active]
    G = np.tril(G) + np.tril(G, -1).T if np.allclose(np.triu(G, 1), 0.0) else G
    assert np.abs(G - G.T).max() < 1e-12 * np.abs(G).max()
    assert np.linalg.eigvalsh(G).min() > 0.0


def test_no_energy_is_gained_by_rolling_and_unloading(plain_body, other_body) -> None:
    """Pressed, rolled by several columns and lifted again: what the ledger cannot account for stays below the largest
    contact energy by as much as with all points."""
    goes_on = Settings(gain_limit=0.0)  # whatever a grid of so few columns makes of the energy
    unaccounted, gained = [], []
    for quadrature in ("full", "reduced"):
        down = signals.SmoothStep(80e3, 20e3, duration=2e-3, delay=1e-3)
        scene = evaluated(guided_pair(sampled(plain_body), other_body, load=down, speed=60.0, ramp=1e-3), quadrature)
        history = run(scene, 4e-3, step=STEP, start="equilibrium", progress=False, settings=goes_on)
        assert history.status == "completed", history.message
        contact = float(history.energy["contact"].max())
        unaccounted.append(np.abs(history.energy["contact_grid"]).max() / contact)
        gained.append(float(history.energy["numerical"].max()) / contact)
    assert unaccounted[1] < 2.0 * unaccounted[0] + 1e-3
    assert max(gained) < 0.01  # of the energy stored in the contact, as for every law
    assert gained[1] < gained[0] + 1e-3


def test_points_off_the_stations_are_looked_at_in_the_general_way(plain_body) -> None:
    rim = plain_body.contact_surfaces["rim"]
    points = sampled(plain_body).contact_surfaces["rim"].sampling
    assert points is not None
    moved = replace(points, zeta=np.clip(points.zeta + 0.01, 0.0, 1.0))
    for sampling, family in ((points, 0), (moved, 1)):
        body = replace(plain_body, contact_surfaces={"rim": replace(rim, sampling=sampling)})
        scene = pressing(body, plain_body, "reduced")
        assert on_stations(scene.contacts[0], ALL_ALONG) == (family == 0)
        model = Engine(scene).compiled.model
        assert int(model.pairs.family.numpy()[0]) == family
        assert int(model.points.count.numpy()[0]) == points.count


def test_what_is_refused(plain_body) -> None:
    scene = pressing(plain_body, plain_body, "full")
    with pytest.raises(InputError, match="reduced"):
        Contact(scene.body("lower")["rim"], scene.body("upper")["rim"], quadrature="reduced")
