"""Several interactions on the same two surfaces: their pressures add up to those of one with the sum of the laws."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import warpffrf as wf
from references import monolithic
from warpffrf.model.errors import InputError
from warpffrf.online import Engine, run

STEEL = wf.Material(210e9, 0.3, 7850.0)
WHOLE, PARTS = 3e13, (1e13, 2e13)  # Pa/m
LOAD, STEP, FRICTION = 20e3, 2e-5, 0.2
TURNED = 1e-3  # pressures and tractions stand on a convex surface: a component of each by the patch's angle
SAME = 1e-8  # of the largest pressure, force and velocity: each run converges to 1e-9 of the contact force


@pytest.fixture(scope="module")
def roller() -> wf.ReducedBody:
    mesh = wf.mesh.roller(0.05, 0.015, 0.01, sectors=180, layers=5, axial=2, grading=1.6, order=1)
    return wf.reduce(
        mesh, STEEL, interfaces={"bore": "rigid"}, contact={"rim": wf.surfaces.Cylinder()}, modes=6,
        grid=wf.ContactGrid(tangential=True, contact_fixed=False), progress=False,
    )  # fmt: skip


def pressed(roller: wf.ReducedBody, *options: dict, speed: float = 0.0) -> wf.Scene:
    """Two rollers, the lower one turning in a bearing with `speed`, the upper one guided under a load."""
    scene = wf.Scene(gravity=(0, 0, 0))
    lower = scene.add_body(roller, name="lower", angular_velocity=(0, speed, 0))
    upper = scene.add_body(roller, name="upper", position=(0, 0, 0.1))
    axle = scene.add(wf.joints.Revolute(scene.ground, lower["bore"], axis=(0, 1, 0), name="axle"))
    scene.add(wf.joints.Drive(axle, speed, quantity="velocity"))
    scene.add(wf.joints.Prismatic(scene.ground, upper["bore"], axis=(0, 0, 1), name="guide"))
    scene.add(wf.forces.PointForce(upper["bore"], (0, 0, -LOAD)))
    for number, given in enumerate(options):
        scene.add(wf.Contact(lower["rim"], upper["rim"], name=f"part {number}", **given))
    return scene


def layers(*stiffness: float, **more: Any) -> list[dict]:
    return [{"law": wf.laws.LinearLayer(stiffness=k), **more} for k in stiffness]


def test_layers_side_by_side_share_the_pressure(roller: wf.ReducedBody) -> None:
    one = run(pressed(roller, *layers(WHOLE)), 10 * STEP, step=STEP, start="equilibrium", progress=False)
    two = run(pressed(roller, *layers(*PARTS)), 10 * STEP, step=STEP, start="equilibrium", progress=False)
    assert one.status == two.status == "completed"
    whole, parts = one.contacts["part 0"], [two.contacts[f"part {i}"] for i in range(2)]
    for part, stiffness in zip(parts, PARTS, strict=True):
        np.testing.assert_allclose(
            part.pressure, stiffness / WHOLE * whole.pressure, atol=SAME * whole.pressure.max(), rtol=0.0
        )
        np.testing.assert_allclose(part.force, stiffness / WHOLE * whole.force, atol=SAME * LOAD, rtol=0.0)
    assert two.counters["mean_iterations"] <= one.counters["mean_iterations"] + 1.0


def test_the_monolithic_reference_shares_alike(roller: wf.ReducedBody) -> None:
    scene = pressed(roller, *layers(*PARTS))
    history = monolithic.run(scene, STEP, step=STEP, start="equilibrium", at_nodes=True, progress=False)
    for number, stiffness in enumerate(PARTS):
        force = history.contacts[f"part {number}"].force[-1]
        assert float(force[2]) == pytest.approx(-stiffness / WHOLE * LOAD, rel=SAME)


def test_a_layer_next_to_a_closed_gap_carries_nothing(roller: wf.ReducedBody) -> None:
    history = run(pressed(roller, {}, *layers(WHOLE)), 4 * STEP, step=STEP, start="equilibrium", progress=False)
    assert history.status == "completed"
    assert np.abs(history.contacts["part 1"].force).max() < SAME * LOAD
    assert history.contacts["part 0"].force[-1, 2] == pytest.approx(-LOAD, rel=SAME)


def test_an_impact_on_two_layers_is_that_on_their_sum(roller: wf.ReducedBody) -> None:
    """In steps that resolve the touch: in longer ones a pair is taken as impulsive by its own receptance, and the
    results differ by as much as the step itself is off by."""

    def thrown(*stiffness: float) -> wf.Scene:
        scene = wf.Scene(gravity=(0, 0, 0))
        body = scene.add_body(roller, name="body", position=(0, 0, 0.05 + 1e-6), velocity=(0, 0, -0.05))
        plane = scene.ground.surface(wf.surfaces.Plane(origin=(0, 0, 0), outward=(0, 0, 1)), name="floor")
        for number, k in enumerate(stiffness):
            scene.add(wf.Contact(body["rim"], plane, law=wf.laws.LinearLayer(stiffness=k), name=f"part {number}"))
        return scene

    one = run(thrown(1e12), 1e-3, step=2e-6, start="initial", progress=False)
    two = run(thrown(4e11, 6e11), 1e-3, step=2e-6, start="initial", progress=False)
    assert one.status == two.status == "completed"
    speed = one.bodies["body"].velocity[:, 2]
    assert speed[-1] > 0.04  # it is on its way back
    np.testing.assert_allclose(two.bodies["body"].velocity[:, 2], speed, atol=SAME * 0.05, rtol=0.0)


def test_friction_of_one_of_them_transmits_its_own_load(roller: wf.ReducedBody) -> None:
    """The lower roller slides under the upper one, which does not turn."""
    given = layers(*PARTS)
    given[1]["friction"] = FRICTION
    history = run(pressed(roller, *given, speed=20.0), 20 * STEP, step=STEP, start="equilibrium", progress=False)
    assert history.status == "completed"
    rubbing = history.contacts["part 1"]
    along, _, down = rubbing.force[-1]
    assert down / (down + history.contacts["part 0"].force[-1, 2]) == pytest.approx(PARTS[1] / WHOLE, rel=TURNED)
    assert abs(along) == pytest.approx(FRICTION * abs(down), rel=TURNED)
    assert abs(history.contacts["part 0"].force[-1, 0]) < TURNED * LOAD


def test_unknowns_are_claimed_once(roller: wf.ReducedBody) -> None:
    with pytest.raises(InputError, match="in contact already, as 'part 0'; one contact.*requires a law with"):
        pressed(roller, {}, {})
    with pytest.raises(InputError, match="both have friction.*give friction to one of them"):
        pressed(roller, *layers(*PARTS, friction=FRICTION))
    scene = pressed(roller, {}, *layers(WHOLE))
    scene.contacts[1].law = wf.laws.Unilateral()  # a law may be changed until a run begins
    for begin in (scene.check, lambda: Engine(scene)):
        with pytest.raises(InputError, match="contact 'part 1'.*in contact already, as 'part 0'"):
            begin()
