"""A layer between two rollers (`warpffrf.model.laws`): a Winkler bed where it is soft, nothing where it is stiff."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from scenes.rollers import roller_body
from warpffrf.model import joints, laws
from warpffrf.model.contact import Contact
from warpffrf.model.errors import InputError
from warpffrf.model.forces import PointForce
from warpffrf.model.reduced.body import ReducedBody
from warpffrf.model.scene import Scene
from warpffrf.online.history.history import History
from warpffrf.online.run import find_equilibrium, run

WIDTH, RADIUS = 0.02, 0.05
BED = 0.01  # of load and half-width: 8 nodes per half-width; the rollers deform by 0.1 % of the approach
NOTHING = 1e-3  # of pressure: what the stiff layer still yields in addition to the rollers
CLOSES = 0.01  # of the energy moved: the contact grid's own defect while rolling up and down the load


@pytest.fixture(scope="module")
def body() -> ReducedBody:
    return roller_body(900, layers=3, axial=2, grading=1.6, order=1, max_frequency=12e3, cache=False)


def pressed(body: ReducedBody, force: float, law: laws.Law) -> Scene:
    scene = Scene(gravity=(0.0, 0.0, 0.0))
    lower = scene.add_body(body, name="lower")
    upper = scene.add_body(body, name="upper", position=(0.0, 0.0, 2.0 * RADIUS))
    scene.add(joints.Fixed(scene.ground, lower["bore"]))
    scene.add(joints.Prismatic(scene.ground, upper["bore"], axis=(0.0, 0.0, 1.0)))
    scene.add(PointForce(upper["bore"], (0.0, 0.0, -force)))
    scene.add(Contact(lower["rim"], upper["rim"], law=law, capacity=400, name="pair"))
    return scene


def settled(scene: Scene) -> History:
    history = find_equilibrium(scene)
    assert history.status == "completed", history.message
    return history


@pytest.mark.parametrize("approach", [1.0e-4, 2.0e-4])
def test_a_soft_layer_is_a_winkler_bed(body: ReducedBody, approach: float) -> None:
    """p = k (d - x^2/2R), R half the radius of both: force, peak and half-width, for a line load of 1 N/mm."""
    R = 0.5 * RADIUS
    half_width = np.sqrt(2.0 * R * approach)
    stiffness = 1e3 / (4.0 / 3.0 * approach * half_width)
    history = settled(pressed(body, 1e3 * WIDTH, laws.LinearLayer(stiffness)))
    pair = history.contacts["pair"]
    assert pair.approach[0] == pytest.approx(approach, rel=BED)
    p = pair.pressure[0]
    assert p.max() == pytest.approx(stiffness * approach, rel=BED)
    middle = p[:, p.shape[1] // 2]
    x = RADIUS * body.contact_surfaces["rim"].grid.pitch * np.arange(len(middle))
    mean = np.sum(x * middle) / np.sum(middle)
    spread = np.sqrt(np.sum((x - mean) ** 2 * middle) / np.sum(middle))  # of a parabola: half-width/sqrt(5)
    assert spread * np.sqrt(5.0) == pytest.approx(half_width, rel=BED)


def test_a_stiff_layer_is_nothing(body: ReducedBody) -> None:
    rigid = settled(pressed(body, 2e3, laws.Unilateral())).contacts["pair"]
    stiff = settled(pressed(body, 2e3, laws.LinearLayer(1e18))).contacts["pair"]
    assert np.abs(stiff.pressure - rigid.pressure).max() < NOTHING * rigid.pressure.max()
    assert stiff.approach[0] > rigid.approach[0]


def test_the_layer_is_in_the_ledger(body: ReducedBody) -> None:
    """A spring-back: the upper roller bounces on the layer and the energy of the layer comes back."""
    scene = pressed(body, 20.0, laws.LinearLayer(1e12))
    scene.bodies[1].velocity = np.array([0.0, 0.0, -0.05])
    history = run(scene, 2e-3, step=2e-5, progress=False)
    assert history.status == "completed", history.message
    energy = history.energy
    assert energy["contact"].max() > 0.1 * energy["kinetic"][0]
    assert np.abs(energy["numerical"] + energy["contact_grid"]).max() < CLOSES * energy["kinetic"][0]


def test_wrong_laws_are_refused(body: ReducedBody) -> None:
    for value in (0.0, -1.0, float("nan")):
        with pytest.raises(InputError, match="LinearLayer: stiffness"):
            laws.LinearLayer(value)
    with pytest.raises(InputError, match="law must be one of laws.Unilateral, laws.LinearLayer"):
        pressed(body, 1.0, "soft")  # pyright: ignore[reportArgumentType]


def test_another_law_is_another_scene(body: ReducedBody) -> None:
    scenes = [pressed(body, 1.0, law) for law in (laws.Unilateral(), laws.LinearLayer(1e12), laws.LinearLayer(2e12))]
    assert len({scene.content_hash() for scene in scenes}) == 3
    assert replace(laws.LinearLayer(1e12), stiffness=2e12) == laws.LinearLayer(2e12)
