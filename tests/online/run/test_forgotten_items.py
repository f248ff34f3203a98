"""What a run says of joints that were forgotten and of preloads that pull apart."""

from __future__ import annotations

import numpy as np
import pytest

import warpffrf as wf
from warpffrf.online.diagnosis.motion_notes import fall_notes, pulled_apart

ORIGIN = (0.0, 0.0, 0.0)
G = 9.81


def falling(gravity: float = G) -> wf.Scene:
    """A pendulum, and a body that nothing holds."""
    scene = wf.Scene(gravity=(0.0, 0.0, -gravity))
    arm = scene.add_rigid_body(1.0, (0.1, 0.1, 0.1), name="arm", position=(1.0, 0.0, 0.0))
    scene.add(wf.joints.Revolute(arm.at((-1.0, 0.0, 0.0)), scene.ground, axis=(0, 1, 0)))
    scene.add_rigid_body(1.0, (0.1, 0.1, 0.1), name="loose", velocity=(0.3, 0.0, 0.2))
    return scene


def notes(scene: wf.Scene) -> str:
    run = wf.simulate(scene, 0.1, step=0.01, progress=False)
    assert run.status == "completed"
    return "\n".join(run.history.notes)


def test_a_body_that_falls_is_named() -> None:
    said = notes(falling())
    assert (
        f"body 'loose' by {0.5 * G * 0.1**2:.3g} m" in said and "'arm'" not in said and "add the missing joint" in said
    )


def test_free_flight_without_gravity_is_meant() -> None:
    assert "fell" not in notes(falling(gravity=0.0))


def test_a_spring_holds() -> None:
    scene = falling()
    scene.add(wf.forces.SpringDamper(scene.ground.at((0, 0, 1)), scene.body("loose").at(ORIGIN), 100.0, name="spring"))
    run = wf.simulate(scene, 0.1, step=0.01, progress=False)
    assert not fall_notes(scene, run.history)


def test_signs_of_preloads_are_reported() -> None:
    scene = wf.Scene()
    body = scene.add_rigid_body(1.0, (1, 1, 1), name="body")
    guide = scene.add(wf.joints.Prismatic(scene.ground, body.at(ORIGIN), axis=(0, 0, 1)))
    assert pulled_apart(scene) == ""
    scene.add(wf.forces.JointSpringDamper(guide, 1e3, preload=200.0, name="press"))
    assert "sign of the preload of 'press' (+200 N): a positive one is a tension" in pulled_apart(scene)
    scene.add(wf.forces.JointSpringDamper(guide, 1e3, preload=wf.signals.Ramp(0, 1, duration=1), name="soft"))
    assert "'soft' (a signal)" in pulled_apart(scene)


def test_a_lumped_contact_that_never_touches_is_named() -> None:
    """A ball that is thrown up from 1 m above the floor, for 0.1 s."""
    scene = wf.Scene(gravity=(0.0, 0.0, -G))
    steel = wf.Material(210e9, 0.3, 7850.0)
    floor = scene.ground.surface(wf.surfaces.Plane(origin=ORIGIN, outward=(0, 0, 1)), name="floor")
    skin = wf.surfaces.Sphere(radius=0.01, axis_point=ORIGIN, axis_direction=(0, 0, 1))
    place, up = (0.0, 0.0, 1.01), (0.0, 0.0, 1.0)
    ball = scene.add_rigid_body(0.03, (1e-6,) * 3, name="ball", position=place, velocity=up, surfaces={"skin": skin})
    scene.add(wf.LumpedContact(ball["skin"], floor, law=wf.laws.HertzPoint(steel, steel), name="landing"))
    said = notes(scene)
    assert "contact not closed in the run: 'landing' (1 m apart at least)" in said


def test_reports_at_rest_do_not_alarm() -> None:
    """A body that hangs still: the shares of nothing are not reported, and round-off is no figure."""
    scene = wf.Scene(gravity=(0.0, 0.0, -G))
    body = scene.add_rigid_body(1.0, (0.1, 0.1, 0.1), name="body", position=(0.0, 0.0, 1.0))
    scene.add(wf.joints.Fixed(scene.ground, body.at(ORIGIN), name="foot"))
    run = wf.simulate(scene, 0.05, step=0.01, progress=False)
    report = run.report()
    assert np.abs(run.body("body").velocity).max() < 1e-12
    assert "not computed: nothing moves" in report
    assert f"reaction {G:.5g} N (largest {G:.5g}), 0 N m (largest 0)" in report
    moving = wf.simulate(falling(), 0.1, step=0.01, progress=False)
    assert "energy residual   -" in moving.report() or "energy residual   +" in moving.report()


@pytest.mark.parametrize(("value", "least", "shown"), [(7.6e-16, 1e-14, 0.0), (7.6e-9, 1e-14, 7.6e-9)])
def test_round_off(value: float, least: float, shown: float) -> None:
    from warpffrf.output.round_off import without_round_off

    assert without_round_off(value, least) == shown and without_round_off([value], least).tolist() == [shown]
