"""Runs of every method that are stopped go on bit for bit, and can be looked at meanwhile."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
from test_unfinished import first_rows, kept, same
from unfinished_runs import CHECKS, STEP, top

from scenes.rollers import guided_pair, roller_body
from warpffrf.model import laws, signals, surfaces
from warpffrf.model.contact import Contact
from warpffrf.model.scene import Scene
from warpffrf.monolithic import Monolithic
from warpffrf.monolithic.line_of_centres.pair import default_layer
from warpffrf.online import GeneralizedAlpha
from warpffrf.output.simulate import simulate

METHODS = {
    "low rank": Monolithic(variant="low_rank"),
    "full": Monolithic(variant="full"),
    "modified": Monolithic(variant="modified"),
    "modified at nodes": Monolithic(law="nodes", variant="modified"),
}
ARRAYS = ("time", "energy", "bodies", "joints", "contacts", "forces", "sensors", "step_size", "iterations")


@pytest.fixture(scope="module")
def roller() -> Any:
    return roller_body(96, layers=4, axial=3, grading=1.6, order=1, max_frequency=15e3, cache=False)


def check(scene: Any, folder: Path, steps: int, step: float, **options: Any) -> None:
    """Interrupted, looked at, and gone on with."""
    found, whole = kept(folder, scene, steps, step, **options)
    rows = len(found.time)
    assert 0 < rows < len(whole.time) and found.status == "unfinished"
    for name in ARRAYS:
        assert same(first_rows(getattr(whole.history, name), rows), getattr(found.history, name), name) == []
    results = folder / "run.h5"
    again = simulate(scene, steps * step, step=step, progress=False, results=results, resume=True, **options)
    assert same(whole.history, again.history) == []
    assert again.history.counters["steps"] == whole.history.counters["steps"]
    assert again.history.counters["mean_iterations"] == whole.history.counters["mean_iterations"]
    assert [path.name for path in folder.iterdir()] == ["run.h5"]


@pytest.mark.parametrize("name", METHODS)
def test_a_monolithic_run_goes_on_bit_for_bit(name: str, roller: Any, tmp_path: Path) -> None:
    load = signals.SmoothStep(4e3, 8e3, duration=1e-3)
    scene = guided_pair(roller, roller, load=load, speed=40.0, ramp=2e-3)
    options = {"start": "equilibrium", "integrator": GeneralizedAlpha(0.8), "method": METHODS[name]}
    check(scene, tmp_path, 12, 1e-4, **options)


@pytest.mark.parametrize("variant", ["low_rank", "full"])
def test_friction_at_nodes_goes_on_bit_for_bit(variant: str, tmp_path: Path) -> None:
    """A wheel that slides with spin on the ground: what nodes remember, and what was lost."""
    body = roller_body(40, layers=2, axial=2, grading=1.6, modes=3, tangential=True, contact_fixed=False, cache=False)
    scene = Scene(gravity=(0.0, 0.0, -9.81))
    plane = surfaces.Plane(origin=(0.0, 0.0, 0.0), outward=(0.0, 0.0, 1.0), direction=(0.0, 1.0, 0.0))
    floor = scene.ground.surface(plane, name="floor")
    wheel = scene.add_body(
        body, name="wheel", position=(0.3, 0.0, 0.05), velocity=(0.5, 0.0, 0.0), angular_velocity=(0.0, 5.0, 0.0),
        inertia="constant",
    )  # fmt: skip
    layer = laws.LinearLayer(0.01 * default_layer(body.contact_surfaces["rim"]))
    scene.add(Contact(wheel["rim"], floor, law=layer, friction=0.2, evaluation="full", name="slides"))
    check(scene, tmp_path, 16, 1e-4, method=Monolithic(variant))


@pytest.mark.parametrize("name", CHECKS)
def test_a_check_goes_on_bit_for_bit(name: str, tmp_path: Path) -> None:
    check(top(), tmp_path, 40, STEP, integrator=CHECKS[name], save_every=3)
