"""Pairs whose overlap no motion opens, and pairs that will hardly touch: what is said of them, and when nothing is."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from warpffrf.model import joints, surfaces
from warpffrf.model.checks.contacts import find_wedge, refuse_overlap
from warpffrf.model.contact import Contact
from warpffrf.model.errors import InputError
from warpffrf.model.scene import Scene

RADIUS = 0.05
ALLOWED = 0.01 * RADIUS
CUBE = (1.0, 1.0, 1.0)
PLACED: dict[str, Any] = {"axis_point": (0, 0, 0), "axis_direction": (0, 1, 0)}
LINEAR = 1e-6  # of the depth: between planes the linear programme is exact but for its own tolerance
BENT = 0.02  # of the depth: gaps of round partners bend while they close, by the depth over the radius


def between_planes(body: Any, depth: float, shift: float = 0.0) -> Scene:
    """A roller between two planes of the ground that are closer than its diameter by twice the depth [m]."""
    scene = Scene()
    roller = scene.add_body(body, name="roller", position=(0, 0, shift))
    for name, side in (("floor", 1.0), ("ceiling", -1.0)):
        plane = surfaces.Plane(origin=(0, 0, -side * (RADIUS - depth)), outward=(0, 0, side))
        scene.add(Contact(roller["rim"], scene.ground.surface(plane, name=name), name=name))
    return scene


def in_bore(body: Any, radius: float, position: Any = (0, 0, 0)) -> Scene:
    scene = Scene()
    pin = scene.add_body(body, name="pin", position=position)
    bore = scene.ground.surface(surfaces.Bore(radius=radius, **PLACED), name="bore")
    scene.add(Contact(pin["rim"], bore, name="fit"))
    return scene


def under_roller(body: Any, gap: float, kind: Callable[..., Any], beside: float = 0.0) -> Scene:
    """A rigid roller over a flexible one that is held, on a joint of the given kind."""
    scene = Scene()
    lower = scene.add_body(body, name="lower")
    scene.add(joints.Fixed(scene.ground, lower["bore"], name="hold"))
    tread = surfaces.Cylinder(radius=0.02, **PLACED)
    place = (beside, 0, RADIUS + 0.02 + gap)
    upper = scene.add_rigid_body(1.0, CUBE, name="upper", position=place, surfaces={"tread": tread})
    scene.add(kind(scene.ground, upper.at((0, 0, 0)), name="guide"))
    scene.add(Contact(lower["rim"], upper["tread"], name="nip"))
    return scene


def slide(a: Any, b: Any, name: str) -> Any:
    return joints.Prismatic(a, b, axis=(0, 0, 1), name=name)


def hinge(a: Any, b: Any, name: str) -> Any:
    return joints.Revolute(a, b, axis=(0, 1, 0), name=name)


def eccentric(a: Any, b: Any, name: str) -> Any:
    """About an axle next to that of the roller."""
    return joints.Revolute(a, b, axis=(0, 1, 0), point=(0.01, 0, 0.1), name=name)


# --- wedges


@pytest.mark.parametrize("shift", [0.0, 1e-3])
def test_a_roller_between_planes(body_maker, shift: float) -> None:
    """However it is placed between them, half of what they are too close stays on each side."""
    scene = between_planes(body_maker(RADIUS), 2e-3, shift)
    wedge = find_wedge(scene)
    assert wedge is not None and [c.name for c in wedge.contacts] == ["floor", "ceiling"]
    assert wedge.depth == pytest.approx(2e-3, rel=LINEAR)
    with pytest.raises(InputError, match="contacts 'floor', 'ceiling': body 'roller' is wedged between") as caught:
        refuse_overlap(scene)
    for said in (" ground['floor'] and ground['ceiling'], an overlap of 0.002 m", "move the bodies apart", "0.0005 m"):
        assert said in str(caught.value)
    assert "'roller' is wedged" in str(scene.check())


def test_a_small_interference_is_refused_by_nobody(body_maker) -> None:
    scene = between_planes(body_maker(RADIUS), 0.5 * ALLOWED)
    refuse_overlap(scene)
    assert scene.check().wedge is not None
    scene = between_planes(body_maker(RADIUS), 4.0 * ALLOWED)
    for contact in scene.contacts:
        contact.overlap = 5.0 * ALLOWED
    refuse_overlap(scene)


def test_what_a_motion_opens_is_no_wedge(body_maker) -> None:
    """A roller too deep in the floor but with room above; a body on a slide; a pin too low in its bore."""
    scene = between_planes(body_maker(RADIUS), -1e-3, shift=-2e-3)
    assert scene.check().wedge is None
    with pytest.raises(InputError, match=r"contact 'floor'.*scene.close_gap\(pair, along=\(0, 0, -1\)\)"):
        refuse_overlap(scene)
    assert find_wedge(under_roller(body_maker(RADIUS), -1e-3, slide)) is None
    assert find_wedge(in_bore(body_maker(RADIUS), RADIUS + 1e-4, (0, 0, -1e-3))) is None


def test_a_pin_larger_than_its_bore(body_maker) -> None:
    scene = in_bore(body_maker(RADIUS), RADIUS - 1e-3, (2e-3, 0, 0))
    wedge = find_wedge(scene)
    assert wedge is not None and wedge.all_round and wedge.depth == pytest.approx(1e-3, rel=BENT)
    with pytest.raises(InputError, match=r"'fit': pin\['rim'\] is too large for ground\['bore'\].*change a radius"):
        refuse_overlap(scene)


@pytest.mark.parametrize("kind", [joints.Fixed, hinge])
def test_an_overlap_that_joints_hold(body_maker, kind: Any) -> None:
    scene = under_roller(body_maker(RADIUS), -1e-3, kind)
    with pytest.raises(
        InputError, match="'nip'.*overlap by 0.001 m, and joints and drives prevent both from moving apart"
    ):
        refuse_overlap(scene)


def test_a_row_of_rollers_between_walls(body_maker) -> None:
    scene = Scene()
    reach = 2.0 * RADIUS - 1e-3
    row = [scene.add_body(body_maker(RADIUS), name=f"r{i}", position=(i * reach, 0, 0)) for i in range(3)]
    for i, side in ((0, 1.0), (2, -1.0)):
        plane = surfaces.Plane(origin=(i * reach - side * (RADIUS - 1e-3), 0, 0), outward=(side, 0, 0))
        scene.add(Contact(row[i]["rim"], scene.ground.surface(plane, name=f"wall{i}"), name=f"w{i}"))
    for i in (0, 1):
        scene.add(Contact(row[i]["rim"], row[i + 1]["rim"], name=f"p{i}"))
    wedge = find_wedge(scene)
    assert wedge is not None and {c.name for c in wedge.contacts} == {"w0", "w2", "p0", "p1"}
    assert wedge.depth == pytest.approx(1e-3, rel=BENT) and "'r0', 'r1', 'r2' are wedged in a row" in str(wedge)


# --- out of reach


def test_radii_in_millimetres_are_named(body_maker) -> None:
    found = in_bore(body_maker(RADIUS), 50.5).check().out_of_reach
    assert len(found) == 1 and "50.5 m apart" in found[0] and "0.05 m radius" in found[0] and "units (m)" in found[0]
    assert in_bore(body_maker(RADIUS), 1.5 * RADIUS).check().out_of_reach == ()


@pytest.mark.parametrize("kind", [joints.Fixed, hinge])
def test_joints_that_hold_a_pair_apart_are_named(body_maker, kind: Any) -> None:
    """A turn about its own axis brings a roller no nearer."""
    found = under_roller(body_maker(RADIUS), 1e-3, kind).check().out_of_reach
    assert len(found) == 1 and "0.001 m apart, and the joints allow neither body to move" in found[0]


@pytest.mark.parametrize("kind", [slide, eccentric])
def test_what_can_move_towards_its_partner_is_left_alone(body_maker, kind: Any) -> None:
    assert under_roller(body_maker(RADIUS), 1e-3, kind).check().out_of_reach == ()


def test_deformation_may_close_a_small_gap(body_maker) -> None:
    assert under_roller(body_maker(RADIUS), 1e-5, joints.Fixed).check().out_of_reach == ()


def test_a_ball_that_only_turns_comes_no_nearer(body_maker) -> None:
    scene = Scene()
    lower = scene.add_body(body_maker(RADIUS), name="lower")
    scene.add(joints.Fixed(scene.ground, lower["bore"], name="hold"))
    sphere = surfaces.Sphere(radius=0.02, axis_point=(0, 0, 0), axis_direction=(0, 0, 1))
    ball = scene.add_rigid_body(1.0, CUBE, name="ball", position=(0, 0, 0.075), surfaces={"skin": sphere})
    scene.add(joints.Spherical(scene.ground, ball.at((0, 0, 0)), name="socket"))
    scene.add(Contact(lower["rim"], ball["skin"], name="nip"))
    assert len(scene.check().out_of_reach) == 1


def test_surfaces_that_look_past_each_other(body_maker) -> None:
    """A roller far outside the width of another."""
    scene = Scene()
    a = scene.add_body(body_maker(RADIUS), name="a")
    b = scene.add_body(body_maker(RADIUS), name="b", position=(0, 10.0 * RADIUS, 2.0 * RADIUS))
    scene.add(Contact(a["rim"], b["rim"], name="c"))
    found = scene.check()
    assert np.isinf(found.gaps["c"]) and "do not face each other" in found.out_of_reach[0]
