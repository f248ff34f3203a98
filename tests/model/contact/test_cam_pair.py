"""Cams with their followers in one call: lift and jump speed from the law, places, bodies that swing, and refusals."""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np
import pytest

import warpffrf as wf
from demos import cam_follower as demo
from warpffrf.model import rotation as rot
from warpffrf.model.cam_pair import CamPair

STEEL = wf.Material(youngs_modulus=210e9, poisson_ratio=0.3, density=7850, name="steel")
AXIS: dict[str, Any] = {"axis_point": (0, 0, 0), "axis_direction": (0, 1, 0)}
TOP = demo.BASE + demo.ROLLER
MASS, STIFFNESS, PRELOAD = 0.3, 40e3, 300.0  # kg, N/m, N
PIVOT, ARM, TORSION, MOMENT = (0.04, 0.0, 0.03), 0.04, 60.0, 12.0  # m, m, N m/rad, N m
LAW, JUMP = 1e-9, 5e-4  # m, of the jump speed: the curvature of splines through half a degree


@cache
def sections() -> dict[str, wf.surfaces.Curve]:
    rise = wf.signals.Table(
        np.linspace(0.0, 2.0 * np.pi, 25), 3e-3 * np.sin(np.linspace(0.0, np.pi, 25)) ** 4, cubic=True
    )
    return {
        "roller": wf.surfaces.cam(demo.law(), base_radius=demo.BASE, roller_radius=demo.ROLLER),
        "flat": wf.surfaces.cam(rise, base_radius=40e-3),
    }


def roller(points: Any = None) -> wf.ReducedBody:
    rim = wf.surfaces.Cylinder(radius=demo.ROLLER, **AXIS)
    return wf.half_space_body(MASS, (1e-4,) * 3, STEEL, contact={"rim": rim}, extent=(-4e-3, 4e-3), points=points)


def scene_with(
    section: wf.surfaces.Curve, angle: float = 0.0, place: Any = (0, 0, 0.05), pivot: Any = None
) -> wf.Scene:
    """A cam, rotated by `angle` [rad], and a roller well above it, perhaps with a pivot."""
    scene = wf.Scene()
    face = wf.surfaces.Extruded(curve=section, axis_direction=(0, 1, 0), x_direction=(0, 0, 1))
    turned = {"axis": (0, 1, 0), "angle": angle}
    scene.add_rigid_body(0.5, (1e-4,) * 3, name="cam", surfaces={"face": face}, rotation=turned)
    points = None if pivot is None else {"center": (0, 0, 0), "pivot": np.subtract(pivot, place)}
    scene.add_body(roller(points), name="roller", position=place)
    return scene


def placed(angle: float = 0.0, place: Any = (0, 0, 0.05), **options: Any) -> tuple[wf.Scene, CamPair]:
    scene = scene_with(sections()["roller"], angle, place, options.get("pivot"))
    return scene, scene.add_cam(scene.body("cam")["face"], scene.body("roller")["rim"], name="valve", **options)


def test_a_roller_is_lifted_by_the_law_and_jumps_at_its_speed() -> None:
    _, pair = placed(stiffness=STIFFNESS, preload=PRELOAD, speed=10.0)
    phi, lift = pair.lift()
    s, _, dds = demo.lift(phi)
    assert lift == pytest.approx(s, abs=LAW)
    s, _, dds = demo.lift(np.linspace(0.0, 2.0 * np.pi, 20001))
    slows = dds < 0.0
    expected = np.sqrt(np.min((STIFFNESS * s[slows] + PRELOAD) / (-MASS * dds[slows])))
    assert pair.jump_speed == pytest.approx(expected, rel=JUMP)


def test_a_flat_follower_is_lifted_by_the_law_and_its_weight_presses() -> None:
    scene = wf.Scene(gravity=(0, 0, -9.81))
    curve = sections()["flat"]
    face = wf.surfaces.Extruded(curve=curve, axis_direction=(0, 1, 0), x_direction=(0, 0, 1))
    cam = wf.half_space_body(0.5, (1e-4,) * 3, STEEL, contact={"face": face}, extent=(-4e-3, 4e-3))
    table = wf.surfaces.Plane(origin=(0, 0, 0), outward=(0, 0, -1))
    turning = scene.add_body(cam, name="cam")
    flat = scene.add_rigid_body(MASS, (1e-4,) * 3, name="flat", position=(0, 0, 0.06), surfaces={"table": table})
    pair = scene.add_cam(turning["face"], flat["table"], name="valve")
    assert flat.position == pytest.approx([0.0, 0.0, 40e-3], abs=1e-9) and pair.contact.b is pair.follower
    phi, lift = pair.lift()
    rise = 3e-3 * np.sin(0.5 * phi) ** 4
    assert lift == pytest.approx(rise, abs=3e-7)  # the spline through 25 points of the law
    at = np.linspace(0.0, 2.0 * np.pi, 20001)
    dds = 3e-3 * (3.0 * np.sin(0.5 * at) ** 2 * np.cos(0.5 * at) ** 2 - np.sin(0.5 * at) ** 4)
    expected = np.sqrt(9.81 / -dds.min())
    assert pair.jump_speed == pytest.approx(expected, rel=0.01)


@pytest.mark.parametrize(
    ("place", "options"),
    [
        ((0.004, 0.0, 0.05), {"direction": (0, 0, 1)}),
        ((0.0, 0.0, 0.05), {"pivot": PIVOT}),
        ((0.0, 0.0, 0.05), {"pivot": (-0.04, 0.0, 0.03)}),
    ],
)
def test_offset_and_swinging_rollers_are_lifted_to_where_they_touch(place: Any, options: Any) -> None:
    """Compared with the pose in which the roller touches the rotated cam, found from the gap of the surfaces."""
    scene, pair = placed(0.0, place, **options)
    phi, lift = pair.lift()
    start = scene.body("roller").position
    for angle in (2.0, 3.1, 4.0):
        there = placed(angle, start + [0.0, 0.0, 0.02] if "direction" in options else start, **options)[0].body(
            "roller"
        )
        if "pivot" in options:
            arms = [np.asarray(at) - options["pivot"] for at in (start, there.position)]
            moved = np.arctan2(np.cross(*arms)[1], arms[0] @ arms[1]) * np.sign(options["pivot"][0])
        else:
            moved = there.position[2] - start[2]
        assert np.interp(angle, phi, lift, period=2.0 * np.pi) == pytest.approx(moved, abs=2e-5)


def test_a_swinging_follower_moves_and_jumps_as_its_lift_says() -> None:
    scene, pair = placed(pivot=PIVOT, stiffness=TORSION, preload=MOMENT, speed=0.0)
    limit = pair.jump_speed
    arm = scene.body("roller").position - PIVOT
    assert pair._inertia == pytest.approx(1e-4 + MASS * float(arm @ arm), rel=1e-12)
    phi, lift = pair.lift()
    opened = {}
    for part in (0.9, 1.05):
        scene, pair = placed(pivot=PIVOT, stiffness=TORSION, preload=MOMENT, speed=part * limit)
        turn = 2.0 * np.pi / (part * limit)
        options = wf.RunOptions(integrator=wf.integrators.GeneralizedAlpha(0.5), save_every=4)
        result = wf.simulate(scene, turn, step=turn / 1800, start="equilibrium", options=options, progress=False)
        assert result.status == "completed", (part, result.message)
        contact = result.contact("valve")
        opened[part] = contact.open_times
        if part < 1.0:
            expected = np.interp(part * limit * result.time, phi, lift, period=2.0 * np.pi)
            assert result.joint("valve guide").coordinate == pytest.approx(expected, abs=2e-3 * lift.max())
            place = np.unwrap(contact.second_place[:, 0], period=sections()["roller"].length)
            assert abs(place[-1] - place[0]) == pytest.approx(sections()["roller"].length, rel=1e-3)
    assert len(opened[0.9]) == 0 and len(opened[1.05]) > 0


def test_a_carrier_takes_the_roller_on_a_pin() -> None:
    scene = scene_with(sections()["roller"])
    carrier = scene.add_rigid_body(0.2, (1e-4,) * 3, name="carrier", position=(0, 0, 0.05))
    pair = scene.add_cam(
        scene.body("cam")["face"], scene.body("roller")["rim"], name="valve", carrier=carrier, speed=20.0
    )
    assert pair.pin is not None and [joint.name for joint in scene.joints] == [
        "valve shaft", "valve guide", "valve pin",
    ]  # fmt: skip
    assert carrier.position == pytest.approx([0.0, 0.0, TOP], abs=1e-12)
    assert pair._inertia == pytest.approx(0.5)
    assert scene.body("cam").angular_velocity == pytest.approx([0.0, 20.0, 0.0])
    assert rot.matrix(carrier.rotation) == pytest.approx(np.eye(3))


def test_what_cannot_be_a_cam_is_refused() -> None:
    scene = scene_with(sections()["roller"])
    face, rim = scene.body("cam")["face"], scene.body("roller")["rim"]
    refused: tuple[tuple[Any, dict[str, Any], str], ...] = (
        ((rim, face), {}, "a cam is surfaces.Extruded"),
        ((face, rim), {"direction": (0, 1, 0)}, "must not be along the axis"),
        ((face, rim), {"direction": (0, 0, 1), "pivot": PIVOT}, "not both"),
        ((face, rim), {"carrier": scene.body("roller")}, "must be a rigid body"),
        ((face, scene.body("roller")), {}, "follower must be a surface"),
    )
    for arguments, options, message in refused:
        with pytest.raises(wf.InputError, match=message):
            scene.add_cam(*arguments, name="valve", **options)
    with pytest.raises(wf.InputError, match="no interface on the axis"):
        scene.add_cam(face, rim, name="valve", pivot=PIVOT)
    scene.body("roller").position = (0.2, 0.0, 0.05)
    with pytest.raises(wf.InputError, match="never brings the gap"):
        scene.add_cam(face, rim, name="valve", direction=(0, 0, 1))
    assert not scene.joints and not scene.contacts
