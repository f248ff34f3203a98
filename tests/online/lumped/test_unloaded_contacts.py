"""Contacts that cannot do what they are there for: wedged bodies, wide clearances, followers that nothing presses.

An interference that deformation takes up is solved, a wedge that it cannot is named with a cure; so are pairs that
carry nothing, by notes of an equilibrium that is one all the same."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from warpffrf.model import forces, joints, surfaces
from warpffrf.model.bearings import BallGeometry
from warpffrf.model.contact import Contact
from warpffrf.model.reduced.body import ReducedBody
from warpffrf.model.scene import Scene
from warpffrf.online import find_equilibrium, run
from warpffrf.output.simulate import equilibrium, simulate

ACROSS: dict[str, Any] = {"axis_point": (0, 0, 0), "axis_direction": (0, 1, 0)}
RADIUS, SMALL = 0.05, 0.02  # m, of the flexible roller and the rigid one
BALANCED = 1e-9  # of the force: the residual tolerance of Newton's method


def between_planes(body: ReducedBody, depth: float, shift: float = 0.0) -> Scene:
    scene = Scene(gravity=(0, 0, 0))
    roller = scene.add_body(body, name="roller", position=(0, 0, shift))
    for name, side in (("floor", 1.0), ("ceiling", -1.0)):
        plane = surfaces.Plane(origin=(0, 0, -side * (RADIUS - depth)), outward=(0, 0, side))
        scene.add(Contact(roller["rim"], scene.ground.surface(plane, name=name), name=name))
    return scene


def follower(body: ReducedBody, gap: float, weight: float = 0.0, *, beside: float = 0.0) -> Scene:
    """A rigid roller on a vertical slide over a flexible one that is held; weight [N] presses it down."""
    scene = Scene(gravity=(0, 0, 0))
    cam = scene.add_body(body, name="cam")
    scene.add(joints.Fixed(scene.ground, cam["bore"], name="hold"))
    tread = surfaces.Cylinder(radius=SMALL, **ACROSS)
    place = (beside, 0, RADIUS + SMALL + gap)
    wheel = scene.add_rigid_body(1.0, (1e-3,) * 3, name="follower", position=place, surfaces={"tread": tread})
    scene.add(joints.Prismatic(scene.ground, wheel.at((0, 0, 0)), axis=(0, 0, 1), name="guide"))
    if weight:
        scene.add(forces.PointForce(wheel.at((0, 0, 0)), (0, 0, -weight), name="press"))
    scene.add(Contact(cam["rim"], wheel["tread"], name="nose"))
    return scene


def equilibrium_notes(notes: list[str]) -> list[str]:
    return [note for note in notes if note.startswith("equilibrium:")]


@pytest.mark.parametrize("depth", [5e-5, 1e-4, 3e-4])
def test_an_interference_fit_is_solved_and_runs(plain_body: ReducedBody, depth: float) -> None:
    """Up to 0.6 % of the radius. The loads of the two contacts cancel each other on the modes, to round-off."""
    scene = between_planes(plain_body, depth, shift=2e-5)
    rest = find_equilibrium(scene)
    assert rest.status == "completed", rest.message
    after = run(scene, 1e-5, step=1e-6, start=rest, progress=False)
    assert after.status == "completed" and not after.counters["rejected_steps"], after.message
    floor, ceiling = (rest.contacts[name].force[0] for name in ("floor", "ceiling"))
    assert np.linalg.norm(floor + ceiling) < BALANCED * np.linalg.norm(floor)
    assert floor[2] > 1e3
    assert abs(rest.bodies["roller"].position[0][2]) < 1e-9  # m, in the middle again


@pytest.mark.parametrize("depth", [1e-3, 5e-3])
def test_a_wedge_that_is_too_deep_is_named(plain_body: ReducedBody, depth: float) -> None:
    """By a note where linear elasticity has an answer all the same, else by the message."""
    rest = find_equilibrium(between_planes(plain_body, depth))
    told = [text for text in (*rest.notes, rest.message) if "'roller' is wedged between ground['floor'] and" in text]
    assert told and f"an overlap of {depth:g} m" in told[0] and "move the bodies apart" in told[0]
    assert rest.status == "completed" or told[-1] == rest.message
    assert "weak spring" not in rest.message


@pytest.mark.parametrize("start", ["initial", "equilibrium"])
def test_a_roller_larger_than_its_ring_is_named(plain_body: ReducedBody, start: str) -> None:
    """5 um all round: an overlap that is allowed, but its patch has no end, whatever the capacity."""
    scene = Scene(gravity=(0, 0, 0))
    roller = scene.add_body(plain_body, name="roller")
    ring = scene.ground.surface(surfaces.Bore(radius=RADIUS - 5e-6, **ACROSS), name="ring")
    scene.add(Contact(roller["rim"], ring, name="fit"))
    failed = run(scene, 1e-5, step=1e-6, start=start, progress=False)
    assert failed.status == "capacity"
    assert "roller['rim'] is too large for ground['ring']" in failed.message and "raise" not in failed.message


def test_a_follower_that_nothing_presses_is_named(plain_body: ReducedBody) -> None:
    for gap in (1e-6, 0.0):
        rest = find_equilibrium(follower(plain_body, gap))
        assert rest.status == "completed", rest.message
        assert equilibrium_notes(rest.notes) == [
            "equilibrium: body 'follower' is free to slide along (0, 0, 1), and left where it is: nothing presses on "
            "contact 'nose'; a spring with a preload along joint 'guide', a force or gravity would"
        ]


def test_a_follower_pushed_out_of_an_overlap_carries_nothing(plain_body: ReducedBody) -> None:
    """Whether it ends just open or touching is a matter of round-off."""
    rest = find_equilibrium(follower(plain_body, -5e-5))
    assert rest.status == "completed", rest.message
    said = ("nothing presses", "touch without a load")  # open, touching
    assert any(any(words in note for words in said) and "'nose'" in note for note in rest.notes)
    assert not any("columns of the grid wide" in note for note in rest.notes)


def test_a_follower_that_is_pressed_needs_no_note(plain_body: ReducedBody) -> None:
    rest = find_equilibrium(follower(plain_body, 1e-6, 100.0))
    assert rest.status == "completed" and not equilibrium_notes(rest.notes)
    assert not any("without a load" in note or "apart" in note for note in rest.notes)


@pytest.mark.parametrize(("weight", "beside", "said"), [(-10.0, 0.0, "away from"), (10.0, 0.2, "past")])
def test_a_load_that_misses_the_contact_is_named(
    plain_body: ReducedBody, weight: float, beside: float, said: str
) -> None:
    rest = find_equilibrium(follower(plain_body, 1e-6, weight, beside=beside))
    assert rest.status == "no_equilibrium"
    assert (
        f"'follower' is free to slide along (0, 0, 1), and 10 N drive it there, {said} contact 'nose'" in rest.message
    )


def test_an_overlap_that_the_grid_does_not_see_is_noted(plain_body: ReducedBody) -> None:
    """The chord of 1 um is narrower than the columns of the grid."""
    history = run(follower(plain_body, -1e-6), 1e-5, step=1e-6, progress=False)
    assert history.status == "completed" and not np.any(history.contacts["nose"].force)
    assert any("'nose': an overlap of 1e-06 m without any pressure" in note for note in history.notes)


@pytest.mark.parametrize("start", ["initial", "equilibrium"])
def test_a_clearance_larger_than_the_roller_is_noted(plain_body: ReducedBody, start: str) -> None:
    history = run(follower(plain_body, 0.5, 100.0), 1e-5, step=1e-6, start=start, progress=False)
    assert history.status == "completed", history.message
    told = [note for note in history.notes if "0.5 m apart at the start, more than the 0.02 m radius" in note]
    assert len(told) == 1 and "close_gap" in told[0]


def test_a_run_without_any_contact_says_so(plain_body: ReducedBody) -> None:
    """And Hertz's contact of a step in which nothing touches is refused."""
    result = simulate(follower(plain_body, 2e-5), 1e-3, step=1e-4, progress=False)
    (said,) = (note for note in result.history.notes if "not closed" in note)
    assert said.startswith("contact not closed in the run: 'nose' (2e-05 m apart at least)")
    found = result.contact("nose").hertz(3)
    assert np.isnan(found.half_width)
    assert found.reason.startswith("contact 'nose': Hertz does not apply: nothing touches in saved step 3")


def test_elements_outside_of_the_load_zone_are_as_they_should_be() -> None:
    """A bearing under radial load leaves half of its contacts open; without a load all of them are reported."""
    scene = Scene(gravity=(0.0, 0.0, 0.0))
    geometry = BallGeometry(elements=8, ball_diameter=0.01, pitch_diameter=0.05, clearance=1e-5)
    bearing = scene.add_bearing("b", geometry, first=(0, 0, 1), outer=scene.ground)
    load = scene.add(forces.PointForce(bearing.inner.at((0, 0, 0)), (0.0, 0.0, 1000.0)))
    assert "not closed" not in equilibrium(scene).report()
    scene.forces.remove(load)
    assert "contacts not closed in the run" in equilibrium(scene).report()
