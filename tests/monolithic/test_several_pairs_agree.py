"""Two pairs on one surface, pressed: one set of local coordinates, so that both solvers, written apart, agree."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from references import monolithic
from scenes.rollers import roller_body
from warpffrf.model import forces, joints, laws, signals
from warpffrf.model.contact import Contact
from warpffrf.model.reduced.body import ReducedBody
from warpffrf.model.scene import Scene
from warpffrf.online import GeneralizedAlpha, Settings, run

LOAD, STEP, STEPS = 1000e3, 1e-5, 30  # N, s
TIGHT = 1e-12  # tolerance of both, of the forces
AGREE = 1e-10  # of the largest force: round-off of some ten steps; copies of the coordinates miss by 0.1
LIKE = 0.05  # friction, and the true shapes at nodes in place of the line of centres: 0.026 on six columns a radian
ORDER = {"low first": (False, True), "middle first": (True, True), "middle second": (False, False)}


@pytest.fixture(scope="module")
def rollers() -> tuple[ReducedBody, ReducedBody]:
    """The second one is so much smaller that a quarter turn of the first has nothing opposite."""
    made: dict[str, Any] = {"layers": 2, "axial": 2, "grading": 1.4, "max_frequency": 15e3, "tangential": True}
    return (
        roller_body(48, cache=False, **made),
        roller_body(40, outer_radius=0.035, inner_radius=0.012, width=0.026, cache=False, **made),
    )


def stack(rollers: tuple[ReducedBody, ReducedBody], middle_first: tuple[bool, bool], **options: Any) -> Scene:
    """A small roller between two large ones, the lowest clamped, the others pressed on it from above."""
    scene = Scene(gravity=(0.0, 0.0, -9.81))
    bodies = [scene.add_body(body, name=name, position=(0.0, 0.0, z)) for body, name, z in (
        (rollers[0], "below", 0.0), (rollers[1], "middle", 0.085), (rollers[0], "above", 0.17)
    )]  # fmt: skip
    scene.add(joints.Fixed(scene.ground, bodies[0]["bore"], name="clamp"))
    for body in bodies[1:]:
        scene.add(joints.Prismatic(scene.ground, body["bore"], axis=(0, 0, 1), name=f"{body.name} guide"))
    load = signals.SmoothStep(0.5 * LOAD, LOAD, duration=STEPS * STEP)
    scene.add(forces.PointForce(bodies[2]["bore"], (load, (0.0, 0.0, -1.0))))
    for beside, first, name in zip((bodies[0], bodies[2]), middle_first, ("low", "high"), strict=True):
        ends = (bodies[1]["rim"], beside["rim"])
        scene.add(Contact(*(ends if first else ends[::-1]), name=name, **options))
    return scene


@pytest.mark.parametrize("variant", ["full", "low_rank"])
@pytest.mark.parametrize("order", ORDER)
def test_both_solvers_agree(rollers: tuple[ReducedBody, ReducedBody], order: str, variant: str) -> None:
    scene = stack(rollers, ORDER[order])
    options: dict[str, Any] = {
        "step": STEP, "integrator": GeneralizedAlpha(0.8), "start": "equilibrium", "progress": False
    }  # fmt: skip
    settings = Settings(residual_tolerance=TIGHT)
    a = run(scene, STEPS * STEP, settings=settings, **options)
    b = monolithic.run(scene, STEPS * STEP, tolerance=TIGHT, variant=variant, **options)
    assert a.status == b.status == "completed", (a.message, b.message)
    for name, contact in a.contacts.items():
        size = np.abs(contact.force).max()
        assert size > 0.5 * LOAD
        assert np.abs(contact.force - b.contacts[name].force).max() < AGREE * size


@pytest.mark.slow
def test_nodes_of_all_pairs_load_one_surface(rollers: tuple[ReducedBody, ReducedBody]) -> None:
    """At nodes, friction on one of the two pairs: every surface has its coordinates once, those that friction
    needs; forces are those along the line of centres, where each pair alone would miss them."""
    law = laws.LinearLayer(3e14)
    scene = stack(rollers, ORDER["low first"], law=law)
    scene.contacts[0].friction = laws.Coulomb(0.2)
    options: dict[str, Any] = {"step": STEP, "integrator": GeneralizedAlpha(0.8), "at_nodes": True, "progress": False}
    history = monolithic.run(scene, STEPS * STEP, **options)
    assert history.status == "completed", history.message
    of_low, of_high = history.contacts["low"].local[1], history.contacts["high"].local[0]
    assert of_low.shape == of_high.shape and np.array_equal(of_low, of_high)  # of the middle roller
    alone = stack(rollers, ORDER["low first"], law=law)
    plain = monolithic.run(alone, STEPS * STEP, **options)
    for name in ("low", "high"):
        size = np.abs(plain.contacts[name].force).max()
        assert np.abs(history.contacts[name].force - plain.contacts[name].force).max() < LIKE * size
