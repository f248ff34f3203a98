"""Gap and closing of every sort of pair by closed forms: rollers, balls, pins on planes, in grooves, bores and cups."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from warpffrf.model import surfaces
from warpffrf.model.checks.contacts import OVERLAP_FRACTION, allowed_overlap, refuse_overlap
from warpffrf.model.contact import Contact
from warpffrf.model.errors import InputError
from warpffrf.model.placement.gap import facing_gap, smallest_gap, undeformed_gap
from warpffrf.model.reduced.contact_grid import SurfaceGrid
from warpffrf.model.scene import Scene

CUBE = (1.0, 1.0, 1.0)
ALONG_Y: dict[str, Any] = {"axis_point": (0, 0, 0), "axis_direction": (0, 1, 0)}
BALL = surfaces.Sphere(radius=0.01, **ALONG_Y)
FLOOR = surfaces.Plane(origin=(0.3, 0.1, 0.0), outward=(0, 0, 1))


@pytest.fixture
def flexible(body_maker):
    """A reduced body whose surface "rim" has the given shape: full turn, or an arc or rectangle of the given halves."""

    def make(shape, *, half_z=0.008, half_theta=None, columns=41):
        body = body_maker()
        z = np.linspace(-half_z, half_z, 5)
        if half_theta is None:
            grid = SurfaceGrid(shape.e_0, 0.0, 2 * np.pi / columns, columns, True, z, 1)
        else:
            grid = SurfaceGrid(shape.e_0, -half_theta, 2 * half_theta / (columns - 1), columns, False, z, columns)
        surface = replace(body.contact_surfaces["rim"], shape=shape, grid=grid)
        return replace(body, contact_surfaces={"rim": surface})

    return make


def on_ground(body, shape, **pose):
    scene = Scene()
    a = scene.add_body(body, name="a", **pose)
    return scene, scene.add(Contact(a["rim"], scene.ground.surface(shape, name="floor")))


def with_rigid(body, shape, **pose):
    scene = Scene()
    a = scene.add_body(body, name="a")
    b = scene.add_rigid_body(1.0, CUBE, name="b", surfaces={"face": shape}, **pose)
    return scene, scene.add(Contact(a["rim"], b["face"]))


def test_roller_and_ball_over_the_floor(flexible) -> None:
    roller = surfaces.Cylinder(radius=0.05, **ALONG_Y)
    turned = Rotation.from_rotvec([0.0, 0.4, 0.0]).as_quat()
    _, contact = on_ground(flexible(roller), FLOOR, position=(0.1, -0.3, 0.0512), rotation=turned)
    gap, theta, _ = smallest_gap(contact)
    assert gap == pytest.approx(0.0012, abs=1e-15)
    np.testing.assert_allclose(contact.a.body.to_world(roller.point(theta, 0.0))[[0, 2]], [0.1, 0.0012], atol=1e-8)
    # tilted by 0.1 the lower edge of the width is nearest: half width times sin compared with R cos
    _, contact = on_ground(
        flexible(roller), FLOOR, position=(0, 0, 0.06), rotation=Rotation.from_rotvec([0.1, 0, 0]).as_quat()
    )
    gap, _, z = smallest_gap(contact)
    assert gap == pytest.approx(0.06 - 0.05 * np.cos(0.1) - 0.008 * np.sin(0.1), abs=1e-12)
    assert abs(z) == pytest.approx(0.008)
    _, contact = on_ground(flexible(BALL), FLOOR, position=(0.2, 0.2, 0.0099))
    assert smallest_gap(contact)[0] == pytest.approx(-1e-4, abs=1e-14)


def test_the_far_side_does_not_face(flexible) -> None:
    # a plate thinner than the roller's overlap: its back is not a place of contact
    _, contact = on_ground(flexible(BALL), surfaces.Plane(origin=(0, 0, 0), outward=(0, 0, -1)), position=(0, 0, -0.02))
    assert smallest_gap(contact)[0] == pytest.approx(0.01, abs=1e-14)
    _, theta, _ = smallest_gap(contact)
    assert contact.a.body.to_world(BALL.point(theta, 0.0))[2] == pytest.approx(-0.01, abs=1e-9)


def test_a_flexible_plate_and_where_it_ends(flexible) -> None:
    plate = flexible(surfaces.Plane(origin=(0, 0, 0), outward=(0, 0, 1)), half_z=0.02, half_theta=0.03)
    _, contact = with_rigid(plate, BALL, position=(0.011, -0.007, 0.0103))
    gap, theta, z = smallest_gap(contact)
    assert gap == pytest.approx(0.0003, abs=1e-14)
    np.testing.assert_allclose([theta, z], [0.011, -0.007], atol=1e-7)
    # next to the plate the nearest place is on its edge
    _, contact = with_rigid(plate, BALL, position=(0.034, 0.0, 0.0103))
    assert smallest_gap(contact)[0] == pytest.approx(np.hypot(0.004, 0.0103) - 0.01, abs=1e-12)
    # as the second surface it ends a pitch beyond its outermost columns
    scene = Scene()
    a = scene.add_body(flexible(BALL), name="a", position=(0.2, 0, 0.0103))
    b = scene.add_body(plate, name="b")
    contact = scene.add(Contact(a["rim"], b["rim"]))
    assert facing_gap(contact) is None and scene.check().gaps["a-b"] == np.inf
    with pytest.raises(InputError, match="do not face each other"):
        smallest_gap(contact)


def test_ball_in_a_grooved_ring_and_around_a_shaft(flexible) -> None:
    for shape, z0 in (
        (surfaces.Ring(radius=0.05, groove_radius=0.0104, **ALONG_Y), 0.05 - 0.01),
        (surfaces.Groove(radius=0.03, groove_radius=0.0104, **ALONG_Y), 0.03 + 0.01),
    ):
        out = 1.0 if shape.kind == "ring" else -1.0
        _, contact = with_rigid(flexible(shape), BALL, position=(0, 0, z0 - out * 2e-5))
        assert smallest_gap(contact)[0] == pytest.approx(2e-5, abs=1e-13)
        # off the middle: the centres' distance in the meridian counts
        _, contact = with_rigid(flexible(shape), BALL, position=(0, 1e-4, z0))
        center = np.hypot(1e-4, z0 - (0.05 - 0.0104 if out > 0 else 0.03 + 0.0104))
        assert smallest_gap(contact)[0] == pytest.approx(0.0104 - 0.01 - center, abs=1e-12)


@pytest.mark.parametrize(("clearance", "pin_first"), [(5e-6, True), (5e-4, False)])
def test_pin_in_a_bore_is_closed_from_where_it_is(flexible, clearance, pin_first) -> None:
    pin = surfaces.Cylinder(radius=0.01, **ALONG_Y)
    bore = surfaces.Bore(radius=0.01 + clearance, **ALONG_Y)
    first, second = (pin, bore) if pin_first else (bore, pin)
    scene, contact = with_rigid(flexible(first), second)
    for start, along, end in (
        ((0, 0, 0), (0, 0, 1), (0, 0, 1.0)),
        ((0, 0, 0), (0, 0, -2), (0, 0, -1.0)),
        ((0.3, 0, 0.1), (1, 0, 0), (np.sqrt(0.99), 0, 0.1)),
        ((0, 0, 3.0), (0, 0, 1), (0, 0, 1.0)),  # overlapping at first: back to the nearer touch
        ((0, 0, -2.5), (0, 0, 1), (0, 0, -1.0)),
    ):
        contact.b.body.position = clearance * np.array(start)
        moved = scene.close_gap(contact, along=along)
        np.testing.assert_allclose(contact.b.body.position, clearance * np.array(end), atol=1e-11)
        assert smallest_gap(contact)[0] == pytest.approx(0.0, abs=1e-12)
        step = np.linalg.norm(contact.b.body.position - clearance * np.array(start))
        assert abs(moved) == pytest.approx(step, abs=1e-12)
    contact.b.body.position = (0, 0, 0)
    scene.close_gap(contact, along=(0, 0, 1), gap=-0.1 * clearance)
    assert contact.b.body.position[2] == pytest.approx(1.1 * clearance, abs=1e-11)
    with pytest.raises(InputError, match="never brings the gap.*can move"):
        scene.close_gap(contact, along=(0, 0, 1), gap=2.0 * clearance)


def test_ball_in_a_cup(flexible) -> None:
    cup = flexible(surfaces.Cup(radius=0.0101, **ALONG_Y))
    scene, contact = with_rigid(cup, BALL, position=(2e-5, 0, 0))
    assert smallest_gap(contact)[0] == pytest.approx(1e-4 - 2e-5, abs=1e-13)
    scene.close_gap(contact, along=(1, 0, 0))
    np.testing.assert_allclose(contact.b.body.position, [1e-4, 0, 0], atol=1e-11)


def test_cone_on_a_plane_of_its_own_slope(flexible) -> None:
    cone = surfaces.Cone(radius=0.03, half_angle=0.2, **ALONG_Y)
    down = Rotation.from_rotvec([0.2, 0, 0])  # brings the lowest generatrix level
    _, contact = on_ground(flexible(cone), FLOOR, position=(0, 0, 0.04), rotation=down.as_quat())
    lowest = undeformed_gap(contact, smallest_gap(contact)[1], np.linspace(-0.008, 0.008, 5))
    expected = 0.04 - 0.03 * np.cos(0.2)
    np.testing.assert_allclose(lowest, expected, atol=1e-12)


@pytest.mark.parametrize("along", [(0, 0, -1), (0.5, 0.1, -1), (1, 0, -0.05)])
@pytest.mark.parametrize("gap", [0.0, 1e-4, -2e-5])
def test_closing_on_the_ground_moves_the_first_body(flexible, along, gap) -> None:
    scene, contact = on_ground(flexible(BALL), FLOOR, position=(0.7, -0.2, 0.4))
    before = contact.a.body.position
    moved = scene.close_gap(contact, along=along, gap=gap)
    assert contact.a.body.position[2] == pytest.approx(0.01 + gap, abs=1e-11)
    direction = np.array(along) / np.linalg.norm(along)
    np.testing.assert_allclose(before - contact.a.body.position, moved * direction, atol=1e-12)
    np.testing.assert_array_equal(scene.ground.position, 0.0)


def test_closing_a_rigid_plate_onto_a_roller(flexible) -> None:
    roller = surfaces.Cylinder(radius=0.05, **ALONG_Y)
    plate = surfaces.Plane(origin=(0.4, 0.2, 0.0), outward=(0, 0, -1))
    scene, contact = with_rigid(flexible(roller), plate, position=(0, 0, 0.2))
    scene.close_gap(contact, along=(0, 0, 1), gap=1e-6)
    assert contact.b.body.position[2] == pytest.approx(0.050001, abs=1e-12)
    with pytest.raises(InputError, match="never brings the gap.*points from the first body to the second"):
        scene.close_gap(contact, along=(1, 0, 0), gap=1e-3)


@pytest.mark.parametrize(("height", "along"), [(-0.07, (0, 0, 1)), (0.07, (0, 0, -1))])
def test_a_body_that_passes_the_other_one_is_reported(flexible, height, along, caplog) -> None:
    """From either side; from its own side there is nothing to report."""
    roller, rigid = surfaces.Cylinder(radius=0.05, **ALONG_Y), surfaces.Cylinder(radius=0.01, **ALONG_Y)
    scene, contact = with_rigid(flexible(roller), rigid, position=(0.0, 0.0, height))
    assert scene.close_gap(contact, along=along) == pytest.approx(0.13, abs=1e-9)
    (record,) = caplog.records
    assert "'b' by 0.13 m past 'a', to its other side" in record.message
    assert f"along=({0}, {0}, {-along[2]})" in record.message
    caplog.clear()
    scene.close_gap(contact, along=along)
    assert not caplog.records


def test_a_plate_reached_the_wrong_way(flexible) -> None:
    scene, contact = on_ground(flexible(BALL), FLOOR, position=(0, 0, 0.1))
    with pytest.raises(InputError, match="never brings the gap"):
        scene.close_gap(contact, along=(0, 0, 1))


def test_overlap_at_the_start(flexible) -> None:
    allowed = OVERLAP_FRACTION * 0.01
    scene, contact = on_ground(flexible(BALL), FLOOR, position=(0, 0, 0.01 - 0.9 * allowed))
    assert allowed_overlap(contact, *smallest_gap(contact)[1:]) == pytest.approx(allowed)
    refuse_overlap(scene)
    contact.a.body.position = (0, 0, 0.007)
    with pytest.raises(InputError, match=r"contact 'a-ground'.* overlap at the start by 0.003 m.*close_gap\(pair"):
        refuse_overlap(scene)
    scene.close_gap(contact, along=(0, 0, -1))
    refuse_overlap(scene)
    contact.a.body.position = (0, 0, 0.007)
    contact.overlap = 0.0031
    refuse_overlap(scene)
    contact.overlap = 0.0  # none at all
    contact.a.body.position = (0, 0, 0.01 - 1e-9)
    with pytest.raises(InputError, match="more than the 0 m"):
        refuse_overlap(scene)


def test_plates_on_each_other_are_judged_by_their_width(flexible) -> None:
    plate = surfaces.Plane(origin=(0, 0, 0), outward=(0, 0, 1))
    down = surfaces.Plane(origin=(0, 0, 0), outward=(0, 0, -1))
    scene, contact = with_rigid(flexible(plate, half_theta=0.02), down, position=(0, 0, 1e-3))
    assert smallest_gap(contact)[0] == pytest.approx(1e-3)
    assert allowed_overlap(contact, 0.0, 0.0) == pytest.approx(OVERLAP_FRACTION * 0.016)
    scene.close_gap(contact, along=(0, 0, 1))
    assert contact.b.body.position[2] == pytest.approx(0.0, abs=1e-12)


@pytest.mark.parametrize("ball_first", [True, False])
def test_closing_a_ball_onto_a_grooved_shaft(flexible, ball_first) -> None:
    # from far out the ball enters the groove and touches its bottom, or its flank when it comes from the side
    groove = surfaces.Groove(radius=0.03, groove_radius=0.0104, **ALONG_Y)
    first, second = (BALL, groove) if ball_first else (groove, BALL)
    scene, contact = with_rigid(flexible(first), second, position=(0, 0, 0.2))
    sign = -1.0 if ball_first else 1.0  # of the way from the shaft to the ball
    for beside in (0.0, 1e-4):
        contact.b.body.position = (0, sign * beside, 0)
        scene.close_gap(contact, along=(0, 0, sign))
        # the ball's centre lies 0.4 mm from the centre of the groove's arc
        height = 0.03 + 0.0104 - np.sqrt(4e-4**2 - beside**2)
        np.testing.assert_allclose(contact.b.body.position, [0, sign * beside, sign * height], atol=1e-9)


def test_closing_a_roller_with_a_profile(flexible) -> None:
    z = np.linspace(-0.008, 0.008, 33)
    profiled = surfaces.ProfiledCylinder(radius=0.05, table=(z, 0.25 * z**2, 0.5 * z), **ALONG_Y)
    scene, contact = on_ground(
        flexible(profiled), FLOOR, position=(0, 0, 0.3), rotation=Rotation.from_rotvec([1e-3, 0, 0]).as_quat()
    )
    scene.close_gap(contact, along=(0, 0, -1))
    # R(z) = R - c z^2 tilted by e touches at z = e/(2 c): height R cos e + sin e z - c z^2 cos e there
    e, c = 1e-3, 0.25
    place = np.tan(e) / (2 * c)
    assert contact.a.body.position[2] == pytest.approx((0.05 - c * place**2) * np.cos(e) + np.sin(e) * place, abs=1e-12)
    assert abs(smallest_gap(contact)[2]) == pytest.approx(place, rel=1e-4)
