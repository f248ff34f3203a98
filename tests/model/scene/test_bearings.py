"""Builders of whole bearings: what they make, by which names, and what they refuse."""

from __future__ import annotations

import json
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import warpffrf as wf
from warpffrf.model.bearings import (
    BallGeometry,
    Bearing,
    Flanges,
    Materials,
    PocketCage,
    PreloadForce,
    PrescribedCage,
    RollerGeometry,
    RollingContact,
)
from warpffrf.model.bearings.bearing import not_guided, refuse_unguided_thrust
from warpffrf.model.bearings.build import add_bearing
from warpffrf.model.bearings.geometry import from_description
from warpffrf.model.bearings.life import _of_rollers, edge_factor, reference_life
from warpffrf.model.bodies import Body
from warpffrf.model.checks.scene import connecting
from warpffrf.model.errors import InputError
from warpffrf.model.joints import LineInPlane, PointInPlane
from warpffrf.model.scene import Scene
from warpffrf.scene_file.forms import flat

BALLS: dict[str, Any] = {"elements": 8, "ball_diameter": 0.01, "pitch_diameter": 0.05}
ROLLERS: dict[str, Any] = {"elements": 12, "roller_diameter": 0.01, "roller_length": 0.012, "pitch_diameter": 0.06}
OPTIONS: dict[str, type] = {"contact": RollingContact, "materials": Materials}
BALL_BEARING = flat(add_bearing, geometry=BallGeometry, **OPTIONS)  # as of scene files
ROLLER_BEARING = flat(add_bearing, geometry=RollerGeometry, **OPTIONS)
STEEL = wf.Material(210e9, 0.3, 7850.0)
SKEW = np.array([1.0, 2.0, 2.0]) / 3.0


def ball(scene: Scene | None = None, **options: Any) -> Bearing:
    return BALL_BEARING(scene or Scene(), "b", **{**BALLS, **options})


def roller(scene: Scene | None = None, **options: Any) -> Bearing:
    return ROLLER_BEARING(scene or Scene(), "r", **{**ROLLERS, **options})


@pytest.mark.parametrize("angle", [0.0, 0.4, -0.4])
def test_balls_just_touch_both_rings_anywhere(angle: float) -> None:
    """At any place, axis and contact angle; the contact angle is that of the normals."""
    scene = Scene()
    shaft = scene.add_rigid_body(
        1.0, (1e-3,) * 3, name="shaft", position=(0.3, -0.1, 0.2), rotation={"axis": (0, 0, 1), "angle": 0.7}
    )
    bearing = ball(scene, contact_angle=angle, position=(0.1, 0.2, 0.3), axis=SKEW, inner=shaft)
    assert bearing.inner is shaft and bearing.outer.name == "b outer ring" and shaft.surfaces
    out = bearing.place.outward(bearing.geometry.angles[2])
    for side, sign in (("inner", 1.0), ("outer", -1.0)):
        at = bearing.contacts_of(side)[2].nearest()  # pyright: ignore[reportAttributeAccessIssue]
        assert abs(at.gap) < 1e-12
        np.testing.assert_allclose(at.normal, sign * (np.cos(angle) * out + np.sin(angle) * SKEW), atol=1e-7)
        across, along = bearing.geometry.curvatures(side, angle)  # pyright: ignore[reportAttributeAccessIssue]
        np.testing.assert_allclose(at.curvatures, (across, along), rtol=1e-7)


def test_clearance_is_the_play_across() -> None:
    """Half of it on every side, a quarter at each contact, of balls and rollers."""
    for bearing in (ball(clearance=40e-6), roller(clearance=40e-6)):
        for side in ("inner", "outer"):
            for contact in bearing.contacts_of(side)[:2]:
                assert contact.nearest().gap == pytest.approx(10e-6, rel=1e-6)  # pyright: ignore[reportAttributeAccessIssue]


def test_parts_have_names_and_may_be_changed() -> None:
    scene = Scene()
    bearing = ball(scene, outer=scene.ground)
    assert scene.bearing("b") is bearing and scene.bearings == [bearing]
    assert [body.name for body in scene.bodies] == ["b inner ring", *(f"b ball {i}" for i in range(1, 9)), "b cage"]
    assert scene.lumped_contact("b outer 3") is bearing.contacts["outer_3"]
    assert scene.joint("b pocket 3") is bearing.joints["pocket_3"]
    assert isinstance(bearing.joints["pocket_1"], PointInPlane) and isinstance(roller().joints["pocket_1"], LineInPlane)
    bearing.contacts["outer_3"].law = wf.laws.PowerForce(1e9)  # pyright: ignore[reportAttributeAccessIssue]
    assert bearing.drive is not None and bearing.drive in scene.drives
    assert "8 balls" in repr(bearing)
    mass = 7850.0 * np.pi * 0.01**3 / 6.0
    assert bearing.elements[0].mass == pytest.approx(mass)
    assert bearing.elements[0].inertia[0, 0] == pytest.approx(0.1 * mass * 0.01**2)
    assert bearing.cage is not None and bearing.cage.mass == pytest.approx(0.2 * 8 * mass)


def test_orbit_speed_is_that_of_rolling() -> None:
    """Points of ball and ring that touch have one velocity: w r_i + (w_c - w)(...) leads to (1 - gamma)/2."""
    bearing = ball(contact_angle=0.5)
    gamma = 0.01 * np.cos(0.5) / 0.05
    assert bearing.orbit_speed(100.0) == pytest.approx(50.0 * (1.0 - gamma))
    assert bearing.orbit_speed(100.0, 100.0) == pytest.approx(100.0)
    radial = bearing.geometry.diameter / bearing.geometry.pitch_diameter
    assert bearing.orbit_speed(100.0, angle=0.0) == pytest.approx(50.0 * (1.0 - radial))
    assert roller().orbit_speed(0.0, 100.0) == pytest.approx(50.0 * (1.0 + 0.01 / 0.06))


def test_defect_frequencies_are_published_ones() -> None:
    """Of the bearing 6205 of the bearing data centre of Case Western Reserve University, per revolution of the inner
    ring, where the frequency of the balls is twice that of their rotation; and of both rings by the textbook."""
    size: dict[str, Any] = {"elements": 9, "ball_diameter": 0.3126 * 25.4e-3, "pitch_diameter": 1.537 * 25.4e-3}
    bearing = Scene().add_bearing("6205", BallGeometry(**size))
    found = bearing.defect_frequencies(2.0 * np.pi)
    assert (found.bpfi, found.bpfo, found.ftf) == pytest.approx((5.4152, 3.5848, 0.39828), rel=1e-4)
    assert 2.0 * found.bsf == pytest.approx(4.7135, rel=1e-4)
    angle, inner, outer = 0.3, 12.0, -5.0  # rev/s
    gamma = size["ball_diameter"] / size["pitch_diameter"] * np.cos(angle)
    found = bearing.defect_frequencies(2.0 * np.pi * inner, 2.0 * np.pi * outer, angle=angle)
    assert found.ftf == pytest.approx(0.5 * abs(inner * (1.0 - gamma) + outer * (1.0 + gamma)))
    assert found.bpfo == pytest.approx(4.5 * (inner - outer) * (1.0 - gamma))
    assert found.bpfi == pytest.approx(4.5 * (inner - outer) * (1.0 + gamma))
    assert found.bsf == pytest.approx(0.5 * np.cos(angle) / gamma * (inner - outer) * (1.0 - gamma**2))
    with pytest.raises(InputError, match="bearing '6205': defect_frequencies: inner"):
        bearing.defect_frequencies("fast")  # pyright: ignore[reportArgumentType]


def test_orbit_speed_at_two_contact_angles() -> None:
    """Jones, of balls that do not pivot on the outer ring; gamma is that of the inner one."""
    bearing = ball(contact_angle=0.5)
    gamma = 0.01 * np.cos(0.6) / 0.05
    assert bearing.orbit_speed(100.0, angle=(0.6, 0.3)) == pytest.approx(100.0 * (1.0 - gamma) / (1.0 + np.cos(0.3)))
    assert bearing.roll(100.0, angle=(0.6, 0.3)).orbit == pytest.approx(bearing.orbit_speed(100.0, angle=(0.6, 0.3)))
    with pytest.raises(InputError, match="angle"):
        bearing.orbit_speed(100.0, angle=(0.6, 0.3, 0.2))  # pyright: ignore[reportArgumentType]


def test_rings_grow_towards_each_other() -> None:
    """An interference moves the groove centres apart by half of it, so that balls touch at a smaller angle."""
    cold, warm = ball(contact_angle=0.5).geometry, ball(contact_angle=0.5, clearance=-8e-6).geometry
    apart = [
        one.arc_centre("inner", one.tracks[0])[0] - one.arc_centre("outer", one.tracks[0])[0] for one in (cold, warm)
    ]
    assert apart[1] - apart[0] == pytest.approx(4e-6, rel=1e-6)
    assert np.cos(warm.free_angle) == pytest.approx(apart[1] / warm.reach)  # pyright: ignore[reportAttributeAccessIssue]
    assert cold.free_angle == 0.5  # pyright: ignore[reportAttributeAccessIssue]
    assert ball(contact_angle=-0.5, clearance=-8e-6).geometry.free_angle == pytest.approx(-warm.free_angle)  # pyright: ignore[reportAttributeAccessIssue]


def test_pockets_surround_elements() -> None:
    bearing = ball(cage=PocketCage(0.2e-3, friction=0.1))
    for i in (1, 5):
        assert bearing.contacts[f"pocket_{i}"].nearest().gap == pytest.approx(0.1e-3)  # pyright: ignore[reportAttributeAccessIssue]
    bearing = roller(cage=PocketCage(0.2e-3))
    for name in ("front", "back"):
        contact: Any = bearing.contacts[f"pocket_3_{name}"]
        assert contact.gap() == pytest.approx(0.1e-3, rel=1e-9)


def window_cage(scene: Scene, walls: str, **pose: Any) -> Body:
    """For the rollers or the balls here, at a pose."""
    count, radius, size = (12, 0.03, 0.0102) if walls == "bar" else (8, 0.025, 0.0102)
    mesh = wf.mesh.cage(
        radius - 2e-3, radius + 2e-3, 0.016, pockets=count, pocket_width=size, pocket_length=0.0122, around=(1, 1),
        axial=(1, 1), order=1,
    )  # fmt: skip
    walls_of = [name for name in mesh.facet_sets if name.startswith(walls)]
    interfaces = dict.fromkeys(["ends", *walls_of], "average")
    return scene.add_body(wf.reduce(mesh, STEEL, interfaces=interfaces, modes=0, progress=False), name="cage", **pose)


def test_walls_of_a_flexible_cage_are_on_its_interfaces() -> None:
    """At any pose: a bar between two rollers carries the front of one pocket and the back of the next, a pocket its
    ball; all of it begins to rotate with the cage."""
    pose: dict[str, Any] = {"position": (0.1, 0.2, 0.3)}
    turned = Rotation.from_euler("z", -90.0, degrees=True)  # y to x, x to -y
    scene = Scene()
    held = window_cage(scene, "bar", rotation=turned.as_quat(), **pose)
    cage = PocketCage(0.2e-3, body=held)
    bearing = roller(scene, cage=cage, axis=(1, 0, 0), first=(0, -1, 0), outer=scene.ground, **pose)
    assert bearing.cage is held and list(bearing.pockets) == [f"bar_{i}" for i in (1, 12, *range(2, 12))]
    part = bearing.pockets["bar_3"]
    assert list(part.surfaces) == ["pocket 3 front", "pocket 4 back"] and part.mass < 1e-5 * held.mass
    for i in range(1, 13):
        for name in ("front", "back"):
            contact: Any = bearing.contacts[f"pocket_{i}_{name}"]
            assert contact.gap() == pytest.approx(0.1e-3, rel=1e-9)
    rolled = bearing.roll(100.0)
    for body in (held, part):
        np.testing.assert_allclose(body.velocity, np.cross((rolled.orbit, 0, 0), body.position - pose["position"]))
        np.testing.assert_allclose(body.angular_velocity, (rolled.orbit, 0, 0))

    scene = Scene()
    bearing = ball(scene, cage=PocketCage(0.2e-3, body=window_cage(scene, "pocket"), guided=False))
    assert len(bearing.pockets) == 8 and "cage_axle" not in bearing.joints
    assert bearing.contacts["pocket_5"].nearest().gap == pytest.approx(0.1e-3)  # pyright: ignore[reportAttributeAccessIssue]


def refused_cage(make: Any, walls: str, **options: Any) -> None:
    scene = Scene()
    make(scene, cage=PocketCage(0.2e-3, body=window_cage(scene, walls), **options))


@pytest.mark.parametrize(
    ("make", "said"),
    [
        (lambda: ball(cage=PocketCage(1e-4, body=3)), r"body must be a body of the scene, .* got 3"),  # type: ignore[arg-type]
        (lambda: refused_cage(roller, "bar", mass=0.1), "body 'cage' has a mass of its own; leave mass out"),
        (lambda: refused_cage(ball, "bar"), r"body 'cage' has no interface near \(0.025, 0, 0\) m; .* each pocket"),
        (lambda: ball(elements=20), r"20 elements .* overlap .* use at most 15 elements, .*0\.06392 m or more"),
        (lambda: ball(pitch_diameter=0.015), "leave no inner ring on a pitch circle"),
        (lambda: ball(osculation=0.5), "osculation of the inner ring.* must be above 0.5"),
        (lambda: ball(osculation=(0.52, 0.49)), "osculation of the outer ring.* must be above 0.5"),
        (lambda: ball(contact_angle=40.0), "angles are in radians"),
        (lambda: ball(contact_angle=0.3, clearance=1e-5), "not both; a clearance of 3.57e-05 m"),
        (lambda: ball(clearance=0.9e-3), r"beyond the geometry.* 0\.0008 m"),
        (lambda: roller(clearance=0.02), "beyond the geometry"),
        (lambda: ball(cage=PocketCage(-1e-4)), "pockets of 0.0099 m are smaller than the elements"),
        (lambda: roller(cage=PocketCage(6e-3)), "pockets of 0.016 m overlap"),
        (lambda: roller(cage=PocketCage(1e-4, guided=False)), "leave guided=True"),
        (lambda: ball(cage="prescribed_cage"), "bearings.PrescribedCage"),
        (lambda: ball(first=(0, 1, 0)), "perpendicular to the axis"),
        (lambda: ball(inner=3), "scene.ground, an interface of a body, .* a contact surface of a flexible body"),
        (lambda: ball(bore=0.045), "bore 0.045 m leaves no ring under the raceway, which lies above 0.04 m"),
        (lambda: ball(law=3), "laws.HertzPoint"),
        (lambda: ball(shoulders=-1.0), "shoulders"),
        (lambda: ball(material=3), "material must be a Material"),
        (lambda: Scene().add_bearing("b", "6310"), r"must be bearings.BallGeometry\(...\), .* got '6310'"),  # type: ignore[arg-type]
        (lambda: ball(osculation=(0.52, 0.53, 0.54)), "two, .inner, outer., got 3"),
        (lambda: ball(axial_preload=500.0), r"bearings.PreloadForce\(newtons\)"),
        (lambda: ball(axial_preload=PreloadForce(-5.0)), "PreloadForce: force"),
        (lambda: ball(diameter_deviations=np.zeros(3)), "diameter_deviations"),
        (lambda: ball(diameter_deviations=np.full(8, 1e-3)), "some micrometres"),
        (lambda: ball(outer_form=3), "outer_form: form must be one of films.LobedForm"),
        (lambda: roller(flanges=1e-4), r"flanges must be bearings.Flanges\(...\)"),
        (lambda: roller(flanges=Flanges(1e-4, outer=None)), "neither outer nor inner has a rib"),
        (lambda: roller(flanges=Flanges(1e-4, outer="left")), "'both', 'front', 'back'"),
        (lambda: roller(flanges=Flanges(1e-4, end_radius=0.004)), "must exceed half the length"),
        (lambda: roller(flanges=Flanges(-1e-4)), "Flanges: clearance"),
        (lambda: roller(flanges=Flanges(1e-4, height=0.005)), "beyond the axis of the rollers"),
        (lambda: roller(flanges=Flanges(1e-4, height=1e-3, end_radius=0.01)), "choose an end_radius between"),
    ],
)
def test_what_does_not_fit_is_refused(make: Any, said: str) -> None:
    with pytest.raises(InputError, match=said):
        make()


def test_a_geometry_is_varied_and_kept() -> None:
    """What follows from other fields follows again; results keep the numbers."""
    one = BallGeometry(**BALLS, osculation=(0.52, 0.53), shoulders=1e-3)
    wider = replace(one, elements=9, ball_diameter=0.012)
    assert len(wider.diameters) == 9 and wider.default_width == pytest.approx(0.018)
    assert wider.groove("outer") == 0.53 * 0.012
    assert from_description(json.loads(json.dumps(one.describe()))) == one


def test_names_are_taken_once() -> None:
    scene = Scene()
    ball(scene)
    with pytest.raises(InputError, match="name 'b' of a bearing is taken"):
        ball(scene)
    with pytest.raises(InputError, match="'b'"):
        scene.bearing("c")
    with pytest.raises(InputError, match="inner and outer are both 'ground'"):
        ball(inner=(ground := Scene()).ground, outer=ground.ground)


def test_a_frame_holds_without_a_clearance() -> None:
    assert PrescribedCage().speed == 0.0 and PrescribedCage(speed=3.0).mass is None


def uniform(count: int, laminae: int, load: float) -> np.ndarray:
    """(count, laminae) N: Q = Q_max cos(phi)^(10/9) in half the bearing, sum Q cos(phi) the load."""
    phi = 2.0 * np.pi * (np.arange(count) + 0.25) / count
    Q = np.maximum(np.cos(phi), 0.0) ** (10.0 / 9.0)
    Q *= load / np.sum(Q * np.cos(phi))
    return np.repeat(Q[:, None], laminae, axis=1) / laminae


@pytest.mark.parametrize("turning", ["inner", "outer"])
def test_reference_life_of_rollers_has_the_limit_of_iso_281(turning: str) -> None:
    """A life of one under C/0.83 without edges, to the three digits of the standard's 0.378 and 0.364 (to the 4th or
    4.5th power); with them, the harm of the laminae times f^4 or f^4.5."""
    geometry, C = RollerGeometry(elements=60, roller_diameter=1e-3, pitch_diameter=60e-3, roller_length=0.012), 50e3
    q = uniform(60, 30, C / 0.83)
    plain = _of_rollers(geometry, C, q, q, "inner", edges=np.ones)
    assert plain.revolutions == pytest.approx(1.0, rel=2e-2)
    half = _of_rollers(geometry, C, 0.5 * q, 0.5 * q, turning, edges=np.ones)
    assert half.revolutions == pytest.approx(16.0 * _of_rollers(geometry, C, q, q, turning, edges=np.ones).revolutions)
    found = reference_life(geometry, C, q, q, turning=turning)
    f = edge_factor(30)
    assert f[0] == pytest.approx(2.33, abs=5e-3) and f[15] == pytest.approx(1.0, abs=5e-3)
    same = _of_rollers(geometry, C, q, q, turning, edges=np.ones).revolutions
    assert found.revolutions == pytest.approx(same * np.mean(f**4.5) ** (-8.0 / 9.0))


@pytest.mark.parametrize("angle", [0.0, 25.0, 40.0])
def test_reference_life_of_balls_has_the_limit_of_iso_281(angle: float) -> None:
    """A life of one under C_r, whatever the contact angle, with Lundberg and Palmgren's distribution: Q = Q_max
    cos(phi)^1.5 in half the bearing."""
    alpha, C = np.radians(angle), 20e3
    geometry = BallGeometry(elements=60, ball_diameter=1e-3, pitch_diameter=60e-3, contact_angle=alpha)
    phi = 2.0 * np.pi * (np.arange(60) + 0.25) / 60
    Q = np.maximum(np.cos(phi), 0.0) ** 1.5
    Q *= C / (np.sum(Q * np.cos(phi)) * np.cos(alpha))
    assert reference_life(geometry, C, Q, Q).revolutions == pytest.approx(1.0, rel=2e-2)


def test_rings_are_mounted_on_ports() -> None:
    """A rigid ring at the bearing's centre, fixed to a point of a body, which `roll` rotates with it."""
    scene = Scene()
    shaft = scene.add_rigid_body(1.0, (1e-3,) * 3, name="shaft", position=(0.3, 0.0, 0.0))
    bearing = ball(scene, position=(0.3, 0.2, 0.0), inner=shaft.at((0.0, 0.19, 0.0)), outer=scene.ground)
    assert bearing.inner.name == "b inner ring" and not shaft.surfaces
    joint = bearing.joints["inner_seat"]
    assert isinstance(joint, wf.joints.Fixed) and joint.a.body is shaft and joint.b.body is bearing.inner
    bearing.roll(50.0)
    for body in (shaft, bearing.inner):
        np.testing.assert_allclose(body.angular_velocity, (0.0, 50.0, 0.0), atol=1e-12)  # pyright: ignore[reportAttributeAccessIssue]
    with pytest.raises(InputError, match=r"shaft.at\(0, 0.19, 0\) lies 0.19 m from the centre .* give position="):
        roller(scene, position=(0.3, 0.0, 0.0), inner=shaft.at((0.0, 0.19, 0.0)))


def test_a_shaft_without_a_locating_bearing_is_named() -> None:
    """By its name, whichever of its rings moves; not where something else may guide it, or one bearing locates."""
    scene = Scene()
    shaft = scene.add_rigid_body(1.0, (1e-3,) * 3, name="shaft")
    first = roller(scene, inner=shaft.at((0, 0, 0)), outer=scene.ground)
    wheel = scene.add_rigid_body(1.0, (1e-3,) * 3, name="wheel")
    scene.add(wf.joints.Fixed(wheel, shaft, name="hub"))
    second = ROLLER_BEARING(
        scene, "s", **ROLLERS, position=(0, 0.1, 0), inner=shaft.at((0, 0.1, 0)), outer=scene.ground
    )
    for body in (shaft, first.inner, second.inner):
        assert isinstance(body, Body)
        said = not_guided(scene.bearings, [], body)
        assert said.startswith(
            "nothing guides body 'shaft' along the axis, as its bearings are non-locating: 'r', 's';"
        )
    assert not_guided(scene.bearings, scene.joints, shaft) == ""  # the wheel, which may be held
    assert not_guided(scene.bearings, scene.lumped_contacts, shaft) != ""
    BALL_BEARING(scene, "b", **BALLS, position=(0, 0.2, 0), inner=shaft.at((0, 0.2, 0)), outer=scene.ground)
    assert not_guided(scene.bearings, [], shaft) == ""


def shaft_on_rollers(axial: float, **others: Any) -> Scene:
    """A shaft on two cylindrical roller bearings under a radial load and thrust along its axis y [N]."""
    scene = Scene(gravity=(0.0, 0.0, -9.81))
    shaft = scene.add_rigid_body(1.0, (1e-3,) * 3, name="shaft")
    for name, y in (("left", -0.1), ("right", 0.1)):
        ROLLER_BEARING(
            scene, name, **ROLLERS, position=(0, y, 0), inner=shaft.at((0, y, 0)), outer=scene.ground, **others
        )
    scene.add(wf.forces.PointForce(shaft, (0.0, axial, -500.0)))
    return scene


def test_thrust_on_a_shaft_without_a_locating_bearing_is_refused() -> None:
    """Before the run, with its amount and sense; not a radial load, nor where friction may hold."""
    said = "5 N of thrust have no load path: nothing guides body 'shaft' along the axis, as its bearings are non-loc"
    for axial in (5.0, -5.0):
        with pytest.raises(InputError, match=said):
            wf.equilibrium(shaft_on_rollers(axial))
    for scene in (shaft_on_rollers(0.0), shaft_on_rollers(5.0, friction=0.1)):
        refuse_unguided_thrust(scene.bearings, connecting(scene), scene.forces, scene.gravity)
    upright, gravity = shaft_on_rollers(0.0), np.array([0.0, -9.81, 0.0])
    weight = 9.81 * sum(upright.body(name).mass for name in ("shaft", "left inner ring", "right inner ring"))
    with pytest.raises(InputError, match=f"{weight:.3g} N of thrust"):
        refuse_unguided_thrust(upright.bearings, connecting(upright), upright.forces, gravity)


def test_a_free_ring_of_a_self_aligning_bearing_swivels_under_combined_load() -> None:
    """Refused with its name, except where a second bearing or joints keep its axis, and under radial load or thrust
    alone."""

    def scene(force: tuple[float, float, float]) -> Scene:
        made = Scene()
        bearing = made.add_bearing("22208", wf.bearings.catalogue("22208"), outer=made.ground)
        made.add(wf.forces.PointForce(bearing.inner, force))
        return made

    with pytest.raises(InputError, match=r"1e\+03 N of thrust and 5e\+03 N across: bearing '22208' is self-aligning"):
        wf.equilibrium(scene((0.0, 1e3, 5e3)))
    guided = scene((0.0, 1e3, 5e3))
    slide = guided.add_rigid_body(1.0, np.eye(3), name="slide")
    guided.add(wf.joints.Prismatic(guided.ground, slide, axis=(0, 0, 1)))
    guided.add(wf.joints.Prismatic(slide, guided.bearing("22208").inner, axis=(0, 1, 0)))
    for made in (guided, scene((0.0, 1e3, 0.0)), scene((0.0, 0.0, 5e3)), scene((0.0, 1.0, 5e3))):
        refuse_unguided_thrust(made.bearings, connecting(made), made.forces, made.gravity)


@pytest.mark.parametrize(
    ("bearing", "locating"),
    [
        (lambda: ball(), True),
        (lambda: roller(), False),
        (lambda: roller(flanges=Flanges(1e-4)), False),
        (lambda: roller(flanges=Flanges(1e-4, inner="front")), True),
        (lambda: roller(contact_angle=0.2), True),
    ],
)
def test_which_bearings_locate(bearing: Any, locating: bool) -> None:
    assert bearing().locating is locating


@pytest.mark.parametrize("designation", ["81110", "29320"])
def test_reference_life_of_thrust_rollers_has_the_limit_of_iso_281(designation: str) -> None:
    """A life of one under C_a/0.73 on equally loaded laminae, exactly, whatever the contact angle; the edges reduce it
    as those of radial rollers do."""
    geometry = wf.bearings.catalogue(designation)
    C, Z = geometry.dynamic_rating, geometry.elements
    q = np.full((Z, 30), C / (0.73 * Z * np.sin(geometry.contact_angle)) / 30)
    for turning in ("inner", "outer"):
        assert _of_rollers(geometry, C, q, q, turning, edges=np.ones).revolutions == pytest.approx(1.0)
        found = reference_life(geometry, C, q, q, turning=turning).revolutions
        assert found == pytest.approx(np.mean(edge_factor(30) ** 4.5) ** (-8.0 / 9.0))


def test_reference_life_of_steep_balls_has_the_limit_of_iso_281() -> None:
    """(C_a/F_a)^3 of equally loaded balls; a row without load of a bearing for both senses does no damage."""
    geometry = BallGeometry(elements=16, ball_diameter=0.01, pitch_diameter=0.06, contact_angle=np.radians(60.0))
    C = geometry.dynamic_rating
    Q = np.full(16, 0.5 * C / (16 * np.sin(geometry.contact_angle)))
    assert reference_life(geometry, C, Q, Q).revolutions == pytest.approx(8.0)
    both = replace(geometry, rows=2, row_spacing=0.02)
    idle = np.concatenate([Q, np.zeros(16)])
    assert reference_life(both, C, idle, idle).revolutions == pytest.approx(8.0)


def test_washers_contain_the_pitch_circle() -> None:
    geometry = replace(wf.bearings.catalogue("81110"), bore=0.08)
    with pytest.raises(InputError, match="do not contain the pitch circle"):
        Scene().add_bearing("b", geometry)
