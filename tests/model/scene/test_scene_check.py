"""Degrees of freedom, redundancy, gaps: counted machines and closed forms."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from warpffrf.model import forces, joints
from warpffrf.model.bodies import Port
from warpffrf.model.contact import Contact
from warpffrf.model.errors import InputError
from warpffrf.model.placement.gap import smallest_gap, undeformed_gap
from warpffrf.model.scene import Scene

CUBE = (1.0, 1.0, 1.0)


def four_bar(*, planar_axes: bool = True) -> Scene:
    """Three links and the ground in a closed loop of four hinges."""
    scene = Scene()
    corners = [(0, 0, 0), (0, 0, 1.0), (1.5, 0, 1.2), (1.5, 0, 0)]
    links = [
        scene.add_rigid_body(1.0, CUBE, name=f"link_{i}", position=corners[i], rotation=(0, 0, 0, 1)) for i in range(3)
    ]
    chain = [scene.ground, *links, scene.ground]
    for i, corner in enumerate(corners):
        axis = (0, 1, 0) if planar_axes or i != 2 else (0.3, 1, 0.2)
        ports = [b if b is scene.ground else b.at(b.to_user(corner)) for b in (chain[i], chain[i + 1])]
        scene.add(joints.Revolute(*ports, axis=axis, point=corner))
    return scene


def test_planar_four_bar_has_one_freedom_and_three_redundant_constraints() -> None:
    found = four_bar().check()
    assert found.grubler == 6 * 3 - 4 * 5 == -2
    assert found.degrees_of_freedom == 1
    assert sum(found.redundant.values()) == 3 and set(found.redundant) == {"revolute_4"}
    assert "redundant constraints: revolute_4 (3)" in str(found)


def test_four_bar_with_a_skew_hinge_is_locked() -> None:
    assert four_bar(planar_axes=False).check().degrees_of_freedom == 0


@pytest.mark.parametrize(
    ("make", "freedoms"),
    [
        (lambda g, p: joints.Fixed(g, p), 0),
        (lambda g, p: joints.Revolute(g, p, axis=(1, 2, 3)), 1),
        (lambda g, p: joints.Prismatic(g, p, axis=(1, 2, 3)), 1),
    ],
)
def test_one_joint(make, freedoms) -> None:
    scene = Scene()
    turned = Rotation.from_rotvec([1.0, 0.2, -0.4]).as_quat()
    body = scene.add_rigid_body(1.0, CUBE, name="body", position=(0.2, 0.1, 0.3), rotation=turned)
    joint = scene.add(make(scene.ground, body.at((0.1, 0.2, 0.3))))
    found = scene.check()
    assert found.degrees_of_freedom == found.grubler == freedoms and not found.redundant
    if freedoms:
        scene.add(joints.Drive(joint, 1.0))
        assert scene.check().degrees_of_freedom == 0


def test_two_rollers_as_in_the_demo(body_maker) -> None:
    scene = Scene()
    reduced = body_maker(modes=5)
    lower = scene.add_body(reduced, name="lower")
    upper = scene.add_body(reduced, name="upper", position=(0, 0, 0.1 + 1e-5))
    sled = scene.add_rigid_body(0.5, CUBE, name="sled", position=(0, 0, 0.1 + 1e-5))
    axle = scene.add(joints.Revolute(scene.ground, lower["bore"], axis=(0, 1, 0)))
    scene.add(joints.Prismatic(scene.ground, sled.at((0, 0, 0)), axis=(0, 0, 1)))
    scene.place(upper["bore"], onto=sled.at((0, 0, 0)))
    scene.add(joints.Revolute(sled.at((0, 0, 0)), upper["bore"], axis=(0, 1, 0)))
    scene.add(joints.Drive(axle, 100.0))
    scene.add(Contact(lower["rim"], upper["rim"]))
    found = scene.check()
    assert found.grubler == found.degrees_of_freedom == 3 * 6 + 2 * 5 - 5 - 5 - 5 - 1
    assert found.gaps["lower-upper"] == pytest.approx(1e-5, abs=1e-12)
    assert found.local_modes == {"lower": 36, "upper": 36, "sled": 0} and not found.unsupported
    for text in ("lower", "global modes", "initial gap", "degrees of freedom"):
        assert text in str(found)


def test_a_flexible_interface_can_resolve_redundancy(body_maker) -> None:
    def doubly_held(modes: int) -> Scene:
        scene = Scene()
        body = scene.add_body(body_maker(modes=modes), name="body")
        for _ in range(2):
            scene.add(joints.Fixed(scene.ground, body["bore"]))
        return scene

    assert doubly_held(0).check().redundant == {"fixed_2": 6}
    # both joints hold the same interface: its modes do not help; a second body in between would
    found = doubly_held(8).check()
    assert found.redundant == {"fixed_2": 6} and found.degrees_of_freedom == 8


def test_bodies_without_a_way_to_the_ground(body_maker) -> None:
    scene = Scene()
    a, b = (scene.add_rigid_body(1.0, CUBE, name=n, position=(i, 0, 0)) for i, n in enumerate("ab"))
    scene.add(forces.SpringDamper(a.at((0, 0, 0)), b.at((0, 0, 0)), 10.0))
    assert scene.check().unsupported == ("a", "b")
    scene.add(joints.Prismatic(scene.ground, a.at((0, 0, 0)), axis=(1, 0, 0)))
    assert scene.check().unsupported == ()


def test_a_scene_without_bodies() -> None:
    with pytest.raises(InputError, match="no bodies"):
        Scene().check()


def pair(body_maker, *, crowns=(None, None), rotation=(0, 0, 0, 1), position=(0, 0, 0.2)):
    scene = Scene()
    a = scene.add_body(body_maker(0.05, crown_radius=crowns[0]), name="a")
    b = scene.add_body(body_maker(0.03, crown_radius=crowns[1]), name="b", position=position, rotation=rotation)
    return scene, scene.add(Contact(a["rim"], b["rim"]))


def test_gap_of_parallel_cylinders(body_maker) -> None:
    _, contact = pair(body_maker, position=(0.03, 0.002, 0.2))
    distance = np.hypot(0.03, 0.2)
    gap, theta, _ = smallest_gap(contact)
    assert gap == pytest.approx(distance - 0.08, abs=1e-15)
    line = contact.a.surface.shape.point(theta, 0.0)
    np.testing.assert_allclose(line / 0.05, np.array([0.03, 0.0, 0.2]) / distance, atol=1e-7)
    # far from the line of centres: law of cosines
    theta = np.linspace(-3, 3, 7)
    x = contact.a.surface.shape.point(theta, 0.0)
    expected = np.hypot(x[:, 0] - 0.03, x[:, 2] - 0.2) - 0.03
    np.testing.assert_allclose(undeformed_gap(contact, theta, 0.0), expected, atol=1e-15)


def test_gap_of_crossed_cylinders(body_maker) -> None:
    # perpendicular axes at a distance d: the nearest points lie on the common perpendicular
    quarter = tuple(Rotation.from_rotvec([0, 0, np.pi / 2]).as_quat())
    _, contact = pair(body_maker, rotation=quarter, position=(0.001, -0.002, 0.0815))
    gap, theta, z = smallest_gap(contact)
    assert gap == pytest.approx(0.0815 - 0.08, abs=1e-12)
    place = contact.a.surface.shape.point(theta, z)
    np.testing.assert_allclose(place, [0.0, -0.002, 0.05], atol=1e-7)


def test_gap_outside_the_width_is_not_counted(body_maker) -> None:
    _, contact = pair(body_maker, position=(0.0, 0.015, 0.081))
    gaps = undeformed_gap(contact, -np.pi / 2, [-0.006, 0.006])
    assert np.isnan(gaps[0]) and gaps[1] == pytest.approx(0.001)
    _, apart = pair(body_maker, position=(0.0, 0.5, 0.081))
    with pytest.raises(InputError, match="do not face each other"):
        smallest_gap(apart)


@pytest.mark.parametrize("crowns", [(None, None), (0.3, None), (0.3, 0.5)])
@pytest.mark.parametrize("gap", [0.0, 1e-5, -2e-5])
@pytest.mark.parametrize("along", [(0, 0, 1), (0.4, 0, 1), (0, 0.05, 2)])
def test_close_gap_reaches_the_gap(body_maker, crowns, gap, along) -> None:
    tilt = tuple(Rotation.from_rotvec([0.01, 0, 0.02]).as_quat())
    scene, contact = pair(body_maker, crowns=crowns, rotation=tilt, position=(0.004, 0.0, 0.15))
    before = contact.b.body.position
    moved = scene.close_gap(contact, along=along, gap=gap)
    np.testing.assert_allclose(contact.b.body.position - before, moved * np.array(along) / np.linalg.norm(along))
    assert smallest_gap(contact)[0] == pytest.approx(gap, abs=1e-11)
    assert contact.b.body.position[2] > 0.05


def test_close_gap_from_coincident_bodies_and_past_each_other(body_maker) -> None:
    scene, contact = pair(body_maker, position=(0, 0, 0))
    scene.close_gap(contact)
    np.testing.assert_allclose(contact.b.body.position, [0, 0, 0.08], atol=1e-12)
    scene, contact = pair(body_maker, position=(0.2, 0, 0.1))
    with pytest.raises(InputError, match="never brings the gap"):
        scene.close_gap(contact)
    with pytest.raises(InputError, match="along has zero length"):
        scene.close_gap(contact, along=(0, 0, 0))
    with pytest.raises(InputError, match="gap must be finite"):
        scene.close_gap(contact, gap=float("nan"))


def test_place(body_maker) -> None:
    scene, contact = pair(body_maker)
    a, b = (p.body for p in contact.ports)
    scene.place(b["bore"], onto=scene.ground.at((1, 2, 3)))
    np.testing.assert_allclose(b["bore"].world_point(), [1, 2, 3], atol=1e-15)
    with pytest.raises(InputError, match="ground cannot be moved"):
        scene.place(scene.ground.at((0, 0, 0)), onto=a["bore"])
    with pytest.raises(InputError, match="place: port: .* is a contact surface"):
        scene.place(a["rim"], onto=b["bore"])
    with pytest.raises(InputError, match="a point is needed"):
        scene.place(a["bore"], onto=Port(scene.ground, None, None))
