"""Scenes: bodies, ports, joints, forces, names, hashes."""

from typing import Any

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from warpffrf.model import forces, joints, sensors, signals
from warpffrf.model.contact import Contact
from warpffrf.model.damping import default_damping
from warpffrf.model.errors import InputError
from warpffrf.model.scene import Scene

TURNED = tuple(Rotation.from_rotvec([0.3, -0.5, 0.9]).as_quat())


def two_bodies(body_maker, **more) -> tuple[Scene, Any, Any]:
    scene = Scene(gravity=(0, 0, -9.81))
    reduced = body_maker(modes=4)
    lower = scene.add_body(reduced, name="lower", **more)
    upper = scene.add_body(reduced, name="upper", position=(0, 0, 0.1), rotation=TURNED)
    return scene, lower, upper


def test_handles_carry_the_body(body_maker) -> None:
    scene, lower, upper = two_bodies(body_maker)
    assert (lower.index, upper.index, lower.name) == (0, 1, "lower")
    assert lower.mass == lower.reduced.mass and lower.mode_count == 4
    port = upper["bore"]
    np.testing.assert_allclose(port.point, upper.reduced.interfaces["bore"].point)
    expected = upper.position + Rotation.from_quat(TURNED).apply(port.point)
    np.testing.assert_allclose(port.world_point(), expected, atol=1e-15)
    np.testing.assert_allclose(upper.to_user(upper.to_world([[1.0, 2.0, 3.0]])), [[1.0, 2.0, 3.0]], atol=1e-14)
    with pytest.raises(InputError, match="'hub'.*'bore', 'rim'"):
        lower["hub"]
    with pytest.raises(InputError, match="flexible.*'bore'"):
        lower.at((0, 0, 0))
    with pytest.raises(InputError, match="ground has no interface"):
        scene.ground["bore"]


def test_damping_choices(body_maker) -> None:
    _, lower, _ = two_bodies(body_maker)
    f = lower.reduced.frequencies
    np.testing.assert_array_equal(lower.damping, np.where(f > 0.5 * f.max(), 0.1, 0.0))
    np.testing.assert_array_equal(default_damping(np.zeros(0)), np.zeros(0))
    _, lower, _ = two_bodies(body_maker, damping=0.02)
    np.testing.assert_array_equal(lower.damping, np.full(4, 0.02))
    _, lower, _ = two_bodies(body_maker, damping=lambda hz: 1e-6 * hz)
    np.testing.assert_allclose(lower.damping, 1e-6 * f)
    for bad in ([0.1, 0.2], -0.1, [0.0, 0.0, np.nan, 0.0]):
        with pytest.raises(InputError, match="'lower': damping"):
            two_bodies(body_maker, damping=bad)


def test_joint_markers_coincide_at_the_initial_pose(body_maker) -> None:
    scene, lower, upper = two_bodies(body_maker)
    axis = np.array([1.0, 2.0, -0.5])
    joint = scene.add(joints.Prismatic(lower["bore"], upper["bore"], axis=axis))
    for _ in range(2):
        poses = []
        for port, marker in zip(joint.ports, joint.frames(), strict=True):
            A = Rotation.from_quat(port.body.rotation) * Rotation.from_quat(marker.rotation)
            poses.append((port.body.to_world(marker.point), A.as_matrix()))
        np.testing.assert_allclose(poses[0][0], poses[1][0], atol=1e-15)
        np.testing.assert_allclose(poses[0][1], poses[1][1], atol=1e-14)
        np.testing.assert_allclose(poses[0][1][:, 2], axis / np.linalg.norm(axis), atol=1e-14)
        np.testing.assert_allclose(poses[0][0], upper["bore"].world_point(), atol=1e-15)
        upper.position = (0.0, 0.3, 0.2)  # markers follow the pose at the time they are asked for


def test_where_a_joint_is(body_maker) -> None:
    scene, lower, upper = two_bodies(body_maker)
    held = joints.Revolute(scene.ground, lower["bore"], axis=(0, 1, 0))
    np.testing.assert_allclose(held.world_point(), lower["bore"].world_point())
    np.testing.assert_allclose(joints.Fixed(lower["bore"], scene.ground, point=(1, 2, 3)).world_point(), [1, 2, 3])
    apart = scene.add(joints.Revolute(lower["bore"], upper["bore"], axis=(0, 1, 0)))
    with pytest.raises(InputError, match="'revolute_1'.*apart.*place"):
        apart.frames()
    scene.place(upper["bore"], onto=lower["bore"])
    np.testing.assert_allclose(apart.world_point(), lower["bore"].world_point(), atol=1e-15)


def test_a_rigid_body_is_a_port_at_its_origin() -> None:
    scene = Scene()
    rod = scene.add_rigid_body(1.0, (1e-2, 1e-2, 1e-2), name="rod", position=(0.1, 0.2, 0.3))
    origin = rod.at((0.0, 0.0, 0.0))
    made = [
        (joints.Spherical(scene.ground, port), forces.PointForce(port, (0, 0, 1)), sensors.Position(port))
        for port in (rod, origin)
    ]
    for itself, point in zip(*made, strict=True):
        assert [p.describe() for p in itself.ports] == [p.describe() for p in point.ports]
    scene.place(rod, onto=scene.ground.at((1, 2, 3)))
    np.testing.assert_array_equal(rod.position, [1, 2, 3])


def test_joint_border(body_maker) -> None:
    scene, lower, upper = two_bodies(body_maker)
    with pytest.raises(InputError, match="joint 'hinge': axis has zero length; give a vector with a direction"):
        joints.Revolute(scene.ground, lower["bore"], axis=(0, 0, 0), name="hinge")
    with pytest.raises(InputError, match="body 'lower' is flexible: name one of its interfaces"):
        joints.Revolute(scene.ground, lower, axis=(0, 1, 0))
    with pytest.raises(InputError, match="contact surface"):
        joints.Revolute(scene.ground, lower["rim"], axis=(0, 1, 0))
    with pytest.raises(InputError, match="both ports are lower.*take two interfaces"):
        joints.Fixed(lower["bore"], lower["bore"])
    fixed = scene.add(joints.Fixed(scene.ground, lower["bore"]))
    with pytest.raises(InputError, match="'fixed_1' is fixed"):
        joints.Drive(fixed, 1.0)
    slide = joints.Prismatic(scene.ground, upper["bore"], axis=(0, 0, 1))
    with pytest.raises(InputError, match="quantity"):
        joints.Drive(slide, 1.0, quantity="torque")  # pyright: ignore[reportArgumentType]
    with pytest.raises(InputError, match="add its joint"):
        scene.add(joints.Drive(slide, 1.0))
    scene.add(slide)
    scene.add(joints.Drive(slide, 1.0))
    with pytest.raises(InputError, match="driven already"):
        scene.add(joints.Drive(slide, 2.0))


def test_drive_position_is_the_integral_of_a_velocity(body_maker) -> None:
    scene, lower, _ = two_bodies(body_maker)
    axle = scene.add(joints.Revolute(scene.ground, lower["bore"], axis=(0, 1, 0)))
    drive = scene.add(joints.Drive(axle, signals.Ramp(0.0, 100.0, duration=0.02)))
    assert drive.name == "drive_1" and axle.name == "revolute_1"
    np.testing.assert_allclose(drive.position()([0.0, 0.01, 0.02, 0.03]), [0.0, 0.25, 1.0, 2.0])


def test_point_forces(body_maker) -> None:
    scene, lower, _ = two_bodies(body_maker)
    plain = scene.add(forces.PointForce(lower["bore"], (1.0, signals.Ramp(0, 2, duration=1.0), 0)))
    np.testing.assert_allclose([float(s(0.5)) for s in plain.components], [1.0, 1.0, 0.0])
    along = forces.PointForce(lower["bore"], (signals.Ramp(0, 10, duration=1.0), (0, 3, 4)), frame="body")
    np.testing.assert_allclose([float(s(2.0)) for s in along.components], [0.0, 6.0, 8.0])
    with pytest.raises(InputError, match="three components"):
        forces.PointForce(lower["bore"], 5.0)  # pyright: ignore[reportArgumentType]
    with pytest.raises(InputError, match="component y"):
        forces.PointForce(lower["bore"], (0.0, np.nan, 1.0))
    with pytest.raises(InputError, match="frame"):
        forces.PointForce(lower["bore"], (0, 0, 1), frame="user")  # pyright: ignore[reportArgumentType]
    with pytest.raises(InputError, match="ground"):
        forces.PointForce(scene.ground.at((0, 0, 0)), (0, 0, 1))


def test_springs(body_maker) -> None:
    scene, lower, upper = two_bodies(body_maker)
    spring = scene.add(forces.SpringDamper(lower["bore"], upper["bore"], 1e4))
    assert spring.free_length == pytest.approx(
        float(np.linalg.norm(upper["bore"].world_point() - lower["bore"].world_point()))
    )
    assert forces.SpringDamper(lower["bore"], upper["bore"], 1e4, free_length=0.2).free_length == 0.2
    scene.place(upper["bore"], onto=lower["bore"])
    with pytest.raises(InputError, match="coincide"):
        _ = spring.free_length
    with pytest.raises(InputError, match="needs a point on the ground"):
        forces.SpringDamper(scene.ground, lower["bore"], 1e4)
    with pytest.raises(InputError, match="stiffness must not be negative"):
        forces.SpringDamper(lower["bore"], upper["bore"], -1.0)
    weld = scene.add(joints.Fixed(scene.ground, lower["bore"]))
    with pytest.raises(InputError, match="leaves free, fixed joint 'fixed_1' has none"):
        forces.JointSpringDamper(weld, 1e4)
    slide = scene.add(joints.Prismatic(scene.ground, upper["bore"], axis=(0, 0, 1)))
    guide = scene.add(forces.JointSpringDamper(slide, 1e6, 100.0, preload=200.0))
    assert guide.name == "joint_spring_damper_1"


def test_contact_border(body_maker) -> None:
    scene, lower, upper = two_bodies(body_maker)
    third = scene.add_body(lower.reduced, name="third")
    pair = scene.add(Contact(lower["rim"], upper["rim"]))
    assert pair.name == "lower-upper" and scene.contact("lower-upper") is pair
    with pytest.raises(InputError, match="contact 'lower-lower': body 'lower' in contact with itself.*two bodies"):
        Contact(lower["rim"], lower["rim"])
    with pytest.raises(InputError, match="friction needs tangential modes, body .lower.*tangential=True"):
        Contact(lower["rim"], third["rim"], friction=0.1)
    with pytest.raises(InputError, match="second surface must be a contact surface"):
        Contact(lower["rim"], upper["bore"])
    with pytest.raises(InputError, match="capacity"):
        Contact(lower["rim"], upper["rim"], capacity=0)
    scene.add(Contact(third["rim"], upper["rim"]))
    with pytest.raises(InputError, match="in contact already, as 'lower-upper'"):
        scene.add(Contact(upper["rim"], lower["rim"]))


def test_names_and_ownership(body_maker) -> None:
    scene, lower, upper = two_bodies(body_maker)
    with pytest.raises(InputError, match="'lower': the name is taken"):
        scene.add_body(lower.reduced, name="lower")
    for bad in ("", "a/b", "ground"):
        with pytest.raises(InputError, match="name"):
            scene.add_body(lower.reduced, name=bad)
    first = scene.add(joints.Fixed(scene.ground, lower["bore"], name="fixed_1"))
    second = scene.add(joints.Revolute(scene.ground, upper["bore"], axis=(0, 1, 0)))
    assert (first.name, second.name) == ("fixed_1", "revolute_1")
    with pytest.raises(InputError, match="in the scene already"):
        scene.add(first)
    with pytest.raises(InputError, match="the name is taken"):
        scene.add(joints.Fixed(lower["bore"], upper["bore"], name="fixed_1"))
    with pytest.raises(InputError, match="joint 'axle' does not exist.*'fixed_1', 'revolute_1'"):
        scene.joint("axle")
    with pytest.raises(InputError, match="another scene"):
        Scene().add(joints.Fixed(lower["bore"], upper["bore"]))
    with pytest.raises(InputError, match="cannot be added"):
        scene.add(lower)


def test_rigid_bodies() -> None:
    scene = Scene()
    body = scene.add_rigid_body(2.0, (0.1, 0.2, 0.25), name="block", center_of_mass=(0, 0, 0.1))
    np.testing.assert_array_equal(body.inertia, np.diag([0.1, 0.2, 0.25]))
    np.testing.assert_array_equal(body.at((1, 2, 3)).world_point(), [1, 2, 3])
    with pytest.raises(InputError, match="use .at"):
        body["bore"]
    for mass, J, message in (
        (0.0, (1, 1, 1), "mass"),
        (1.0, (1, 1, 3), "exceeds the sum"),
        (1.0, (1, 1, -1), "greater than zero"),
        (1.0, [[1, 0.1, 0], [0, 1, 0], [0, 0, 1]], "symmetric"),
        (1.0, np.full((3, 3), np.nan), "NaN"),
    ):
        with pytest.raises(InputError, match=message):
            scene.add_rigid_body(mass, J, name="other")


def test_content_hash_follows_everything(body_maker) -> None:
    def build(**change):
        scene = Scene(gravity=change.get("gravity", (0, 0, -9.81)))
        reduced = body_maker(modes=change.get("modes", 4), radius=change.get("radius", 0.05))
        lower = scene.add_body(reduced, name="lower", damping=change.get("damping"))
        upper = scene.add_body(reduced, name="upper", position=(0, 0, change.get("height", 0.1)))
        axle = scene.add(joints.Revolute(scene.ground, lower["bore"], axis=(0, 1, 0)))
        scene.add(joints.Drive(axle, signals.Ramp(0.0, change.get("speed", 100.0), duration=0.02)))
        scene.add(forces.PointForce(upper["bore"], (0, 0, change.get("force", -1.0))))
        scene.add(Contact(lower["rim"], upper["rim"], capacity=change.get("capacity")))
        return scene.content_hash()

    reference = build()
    assert build() == reference
    changes = [
        {"gravity": (0, 0, 0)},
        {"modes": 3},
        {"radius": 0.050001},
        {"damping": 0.01},
        {"height": 0.1 + 1e-12},
        {"speed": 99.0},
        {"force": -2.0},
        {"capacity": 64},
    ]
    hashes = {build(**change) for change in changes}
    assert len(hashes) == len(changes) and reference not in hashes


class Counted(forces.PointForce):
    """Counts how often its kind is asked for, which each name that is tried does."""

    asked = 0

    @property
    def kind(self) -> str:
        Counted.asked += 1
        return "pull"


def test_names_that_are_given_are_free_and_found_at_once() -> None:
    """The work for each item does not grow with the items before it: not even one name more is tried."""
    scene = Scene()
    stone = scene.add_rigid_body(1.0, (1.0, 1.0, 1.0), name="stone")
    scene.add(forces.PointForce(stone.at((0, 0, 0)), (0, 0, 1.0), name="pull_3"))
    asked = []
    for _ in range(20):
        before = Counted.asked
        scene.add(Counted(stone.at((0, 0, 0)), (0, 0, 1.0)))
        asked.append(Counted.asked - before)
    assert [force.name for force in scene.forces[1:]] == [f"pull_{n}" for n in (1, 2, *range(4, 22))]
    assert max(asked[3:]) == asked[0]
