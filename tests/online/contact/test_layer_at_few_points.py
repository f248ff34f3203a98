"""Layers under quadrature "reduced": the law at the few points that were chosen, compared with the law at all
points."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from scenes.rollers import PAIR, Path, StaticPath, guided_pair, prescribed_pair
from warpffrf.model import laws, signals
from warpffrf.model.reduced.body import ReducedBody
from warpffrf.model.reduced.contact_grid import SurfaceGrid
from warpffrf.model.reduced.contact_surface import ALL_ALONG, ALL_AROUND, Sampling, gauss_points
from warpffrf.model.scene import Scene
from warpffrf.offline.contact.cubature import all_points, choose_sampling
from warpffrf.online import Engine, Settings, run
from warpffrf.online.arrays.axes import layer_points
from warpffrf.online.compile.points import gauss_rule
from warpffrf.online.compile.sampling_rules import chosen_rule
from warpffrf.online.diagnosis.contact_notes import check_sampling
from warpffrf.online.start.static_equilibrium import settle
from warpffrf.online.vibrations.linearise import slot_flexibility

WANTED = 0.01
STEP = 1e-4
LAWS: dict[str, Any] = {
    "power": laws.NonlinearLayer(1e15, 1.5),
    "asperities": laws.ExponentialAsperities(1e8, 20e-6),
    "table": laws.TabulatedLayer((-400e-6, -100e-6, -50e-6, 30e-6), (2e9, 2e8, 4e7, 0.0)),
}


def with_points(body: ReducedBody, every: bool = False) -> ReducedBody:
    """The body with chosen points on its rim, or with `every` point that quadrature "full" has."""
    rim = body.contact_surfaces["rim"]
    sampling = choose_sampling(rim, WANTED)
    if every:
        places, weight = all_points(rim)
        sampling = Sampling(places.x, places.row, places.zeta, weight, 0.0, 0.0, 0.0, 0)
    return replace(body, contact_surfaces={"rim": replace(rim, sampling=sampling)})


@pytest.fixture(scope="module")
def few(plain_body: ReducedBody) -> ReducedBody:
    return with_points(plain_body)


def with_law(scene: Scene, law: Any, quadrature: str) -> Scene:
    scene.contacts[0].law, scene.contacts[0].quadrature = law, quadrature
    for body in scene.bodies:
        body.level = "constant"
    return scene


def pressing(first: ReducedBody, second: ReducedBody, law: Any, quadrature: str) -> Scene:
    """Rollers pressed together that begin to roll, and are let go."""
    load = signals.SmoothStep(60e3, 5e3, duration=1e-3, delay=5e-4)
    return with_law(guided_pair(first, second, load=load, speed=60.0, ramp=5e-4), law, quadrature)


@pytest.mark.parametrize("at_points", [False, True])
@pytest.mark.parametrize("name", ["asperities", "damped"])
def test_all_points_as_a_list_are_all_points(
    name: str, at_points: bool, plain_body: ReducedBody, other_body: ReducedBody
) -> None:
    """Also what a damped layer remembers of its material while it rolls."""
    law = LAWS.get(name, laws.HuntCrossley(1e15, 1.5, damping=50.0))
    listed, found = with_points(plain_body, every=True), []
    for quadrature in ("full", "reduced"):
        scene = pressing(listed, other_body, law, quadrature)
        history = run(
            scene, 4 * STEP, step=STEP, start="equilibrium", progress=False, settings=Settings(force_points=at_points)
        )
        assert history.status == "completed", history.message
        found.append(history)
    a, b = (h.contacts[PAIR] for h in found)
    size = np.abs(a.force).max()
    assert size > 1e4
    assert np.abs(a.force - b.force).max() < 1e-7 * size
    assert np.abs(a.pressure - b.pressure).max() < 1e-6 * a.pressure.max()
    for line in ("contact", "damping"):
        x, y = (h.energy[line] for h in found)
        assert np.abs(x - y).max() <= 1e-6 * np.abs(x).max()
    assert name != "damped" or np.abs(found[0].energy["damping"]).max() > 0.0


@pytest.mark.parametrize("name", list(LAWS))
def test_a_third_of_the_points_gives_the_same_pressure(
    name: str, few: ReducedBody, plain_body: ReducedBody, other_body: ReducedBody
) -> None:
    """At a held approach, on grids that do not match; and the online check shows the difference."""
    path = Path.of([1e-3, 1.5e-3], [0.0, 0.013])
    found, scenes, histories = [], [], []
    for quadrature in ("full", "reduced"):
        scene = with_law(prescribed_pair(few, other_body, path), LAWS[name], quadrature)
        history = StaticPath(scene).solve(2)
        assert history.status == "completed", history.message
        scenes.append(scene)
        histories.append(history)
        found.append(history.contacts[PAIR])
    full, reduced = found
    rim = few.contact_surfaces["rim"]
    assert rim.sampling is not None
    assert 3 * rim.sampling.count <= len(gauss_points(rim.grid.rows, ALL_AROUND, ALL_ALONG)[0])
    sizes = [np.linalg.norm(c.force, axis=1) for c in found]
    weight = np.kron(
        SurfaceGrid.gram_theta(replace(rim.grid, columns=full.pressure.shape[1], periodic=False)), rim.gram_z
    )
    worst = 0.0
    for t in range(2):
        change, whole = (reduced.pressure[t] - full.pressure[t]).ravel(), full.pressure[t].ravel()
        worst = max(worst, float(np.sqrt(change @ weight @ change / (whole @ weight @ whole))))
    off = float(np.abs(sizes[1] / sizes[0] - 1.0).max())
    check = check_sampling(scenes[1].contacts[0], histories[1])
    print(f"{name}: force {off:.2%} ({check.force:.2%}), pressure {worst:.2%} ({check.pressure:.2%})")
    assert np.abs(reduced.force + reduced.force_second).max() < 1e-9 * sizes[0].max()  # action and reaction
    assert off < 2.0 * WANTED
    assert worst < 5.0 * WANTED  # patches of a few columns, where the grids differ
    assert check.pressure == pytest.approx(worst, rel=0.5)


def test_the_tangent_of_few_points_is_symmetric_and_not_negative(few: ReducedBody, plain_body: ReducedBody) -> None:
    engine = Engine(pressing(few, plain_body, LAWS["power"], "reduced"))
    model = engine.compiled.model
    sampling = few.contact_surfaces["rim"].sampling
    assert sampling is not None
    assert layer_points(engine.compiled) == (model.window.columns + 1) * sampling.count
    assert settle(engine)
    slots = int(np.count_nonzero(engine.scratch.slot_of.numpy()[0] >= 0))
    assert slots >= 4
    E = slot_flexibility(engine.compiled, engine.scratch, slots)
    assert np.abs(E - E.T).max() < 1e-12 * E.max()
    values = np.linalg.eigvalsh(E)
    assert values.max() > 0.0 and values.min() > -1e-12 * values.max()


def test_no_energy_from_pressing_rolling_and_letting_go(few: ReducedBody, other_body: ReducedBody) -> None:
    """What the ledger cannot explain stays as small as with all points."""
    goes_on = Settings(gain_limit=0.0)  # whatever a grid of so few columns makes of the energy
    unexplained, gained = [], []
    for quadrature in ("full", "reduced"):
        scene = pressing(few, other_body, LAWS["power"], quadrature)
        history = run(scene, 2.5e-3, step=STEP, start="equilibrium", progress=False, settings=goes_on)
        assert history.status == "completed", history.message
        stored = float(history.energy["contact"].max())
        unexplained.append(np.abs(history.energy["contact_grid"]).max() / stored)
        gained.append(float(history.energy["numerical"].max()) / stored)
    assert unexplained[1] < 2.0 * unexplained[0] + 1e-3
    assert max(gained) < 0.01


def test_both_rules_give_a_uniform_pressure_its_yield(few: ReducedBody) -> None:
    """Weights and nodes: sum_p w_p psi_i is the node's area, so that a constant yield is weighed exactly."""
    rim = few.contact_surfaces["rim"]
    assert rim.sampling is not None
    area = np.asarray(rim.gram_z).sum(axis=1) * rim.grid.pitch
    for rule in (chosen_rule(rim.sampling), gauss_rule(rim, ALL_AROUND, ALL_ALONG)):
        weighed = np.zeros(rim.grid.rows)
        for node_part in (rule.x, 1.0 - rule.x):
            np.add.at(weighed, rule.row, rule.weight * node_part * (1.0 - rule.zeta))
            np.add.at(weighed, rule.row + 1, rule.weight * node_part * rule.zeta)
        np.testing.assert_allclose(weighed, area, rtol=1e-6)
