"""Joints in a scene: turns counted, redundant constraints, what is refused."""

from __future__ import annotations

import numpy as np
import pytest

from warpffrf.model import forces, joints, signals
from warpffrf.model import rotation as rot
from warpffrf.model.checks.redundancy import find_redundancy
from warpffrf.model.errors import InputError
from warpffrf.model.scene import Scene
from warpffrf.online import GeneralizedAlpha, find_equilibrium, run
from warpffrf.online.history.history import BodyHistory, JointHistory
from warpffrf.online.history.record import left_out_notes

CUBE = (0.1, 0.1, 0.1)


def test_turns_of_a_free_joint_are_counted_between_sparse_rows() -> None:
    """Constant spin, 5 turns between saved steps."""
    scene = Scene()
    wheel = scene.add_rigid_body(1.0, CUBE, name="wheel", angular_velocity=(0.0, 0.0, 100.0 * np.pi))
    scene.add(joints.Cylindrical(scene.ground, wheel.at((0, 0, 0)), axis=(0, 0, 1), name="axle"))
    history = run(scene, 1.0, step=1e-3, save_every=100, progress=False)
    assert history.joints["axle"].named("rotation") == pytest.approx(100.0 * np.pi * history.time, abs=1e-6)
    assert history.joints["axle"].names == ("translation", "rotation")
    with pytest.raises(InputError, match="joint coordinate 'angle' does not exist; known: 'translation', 'rotation'"):
        history.joints["axle"].named("angle")


# --- redundant constraints


def test_two_fixed_joints_in_parallel_carry_the_load_together() -> None:
    """The second is left out whole; the first carries the weight and its moment; the sum is that of equilibrium."""
    scene = Scene(gravity=(0.0, 0.0, -9.81))
    beam = scene.add_rigid_body(2.0, CUBE, name="beam", center_of_mass=(0.3, 0.1, 0.0))
    for name, point in (("left", (0, 0, 0)), ("right", (1, 0, 0))):
        scene.add(joints.Fixed(scene.ground, beam.at(point), name=name))
    scene.add(forces.PointForce(beam.at((0.5, 0, 0)), (3.0, 4.0, 5.0)))
    for history in (find_equilibrium(scene), run(scene, 0.01, step=1e-3, progress=False)):
        assert history.status == "completed"
        left, right = history.joints["left"], history.joints["right"]
        load = np.array([3.0, 4.0, 5.0 - 2.0 * 9.81])
        assert left.force[-1] == pytest.approx(-load, rel=1e-9) and not np.any(right.force) and not np.any(right.torque)
        moment = np.cross([0.3, 0.1, 0.0], [0, 0, -2.0 * 9.81]) + np.cross([0.5, 0, 0], [3.0, 4.0, 5.0])
        assert left.torque[-1] == pytest.approx(-moment, rel=1e-8)
        text = "\n".join(history.notes)
        assert "redundant constraints left out" in text and text.count("'right'") == 6 and "'left'" not in text


def hinged_frame(tilt: float = 0.0) -> Scene:
    """A planar four-bar of hinges: crank, coupler and rocker of unequal lengths, driven at the crank."""
    scene = Scene(gravity=(0.0, 0.0, -9.81))
    corners = np.array([(0, 0, 0), (0, 0, 1.0), (2.5, 0, 1.8), (2.5, 0, 0)], dtype=float)
    links = [
        scene.add_rigid_body(1.0 + i, CUBE, name=f"link_{i}", position=0.5 * (corners[i] + corners[i + 1]))
        for i in range(3)
    ]
    chain = [scene.ground, *links, scene.ground]
    for i, corner in enumerate(corners):
        axis = (0, 1, 0) if i != 2 else (tilt, 1, 0)
        ports = [b if b is scene.ground else b.at(b.to_user(corner)) for b in (chain[i], chain[i + 1])]
        scene.add(joints.Revolute(*ports, axis=axis, point=corner, name=f"hinge_{i}"))
    return scene


def test_a_four_bar_of_hinges_moves_and_its_reactions_add_up() -> None:
    """Driven through 0.6 rad: the coupler point solves the planar closure; the ground carries weight and inertia."""
    scene = hinged_frame()
    angle = signals.SmoothStep(0.0, 0.6, duration=0.3)
    scene.add(joints.Drive(scene.joint("hinge_0"), angle, quantity="position"))
    found = scene.check()
    assert found.redundant == {"hinge_3": 3} and found.degrees_of_freedom == 0 and not found.singular_pose
    assert sorted(found.redundant_rows) == [
        f"'hinge_3': {what}" for what in ("rotation about x", "rotation about y", "translation along z")
    ]
    history = run(scene, 0.4, step=1e-3, integrator=GeneralizedAlpha(0.6), progress=False)
    assert history.status == "completed"
    assert not any("was left out" in note for note in history.notes)
    # planar closure: crank tip B, rocker foot D, coupler length l, rocker length r
    theta = np.asarray(angle(history.time))
    B = np.stack([np.sin(theta), np.cos(theta)], axis=1)
    D = np.array([2.5, 0.0])
    coupler, rocker = np.hypot(2.5, 0.8), 1.8
    e = D - B
    d = np.linalg.norm(e, axis=1)
    along = (coupler**2 - rocker**2 + d**2) / (2.0 * d)
    across = np.sqrt(coupler**2 - along**2)
    e = e / d[:, None]
    C = B + along[:, None] * e + across[:, None] * np.stack([-e[:, 1], e[:, 0]], axis=1)
    rotation = np.array([rot.matrix(q) for q in history.bodies["link_2"].rotation])
    tip = history.bodies["link_2"].position + rotation @ np.array([0.0, 0.0, 0.9])
    assert tip[:, [0, 2]] == pytest.approx(C, abs=1e-8)
    # momentum of the whole against ground reactions and weight
    h = history.time[1]
    P = sum((b.mass * history.bodies[b.name].velocity for b in scene.bodies), np.zeros(3))
    weight = sum(b.mass for b in scene.bodies) * np.array(scene.gravity)
    ground = history.joints["hinge_0"].force - history.joints["hinge_3"].force
    rate = (P[:-4] - 8.0 * P[1:-3] + 8.0 * P[3:-1] - P[4:]) / (12.0 * h)
    error = np.abs(ground[2:-2] + weight - rate).max(axis=1)
    smooth = np.r_[100:280, 340:390]  # after the start, and away from the end of the drive, where its jerk jumps
    assert error[smooth].max() < 1e-3 * np.abs(weight).max()


def test_a_misaligned_four_bar_is_locked_and_says_so() -> None:
    scene = hinged_frame(tilt=0.3)
    assert scene.check().degrees_of_freedom == 0
    scene.add(joints.Drive(scene.joint("hinge_0"), 1.0, name="motor"))
    with pytest.raises(InputError, match="drive 'motor': the rotation of joint 'hinge_0' is fixed already"):
        run(scene, 0.1, step=1e-3, progress=False)


def test_a_flat_parallelogram_is_a_singular_pose_not_a_redundancy() -> None:
    """All hinges on one line: the planar rows depend on each other there and nowhere else; only the three rows out of
    the plane are redundant."""

    def parallelogram(lift: float) -> Scene:
        scene = Scene()
        up = np.array([np.cos(lift), 0.0, np.sin(lift)])
        corners = [np.zeros(3), up, up + (2.0, 0.0, 0.0), np.array([2.0, 0.0, 0.0])]
        links = [scene.add_rigid_body(1.0, CUBE, name=f"link_{i}", position=corners[i]) for i in range(3)]
        chain = [scene.ground, *links, scene.ground]
        for i, corner in enumerate(corners):
            ports = [b if b is scene.ground else b.at(b.to_user(corner)) for b in (chain[i], chain[i + 1])]
            scene.add(joints.Revolute(*ports, axis=(0, 1, 0), point=corner))
        return scene

    for lift in (0.0, 0.5):
        scene = parallelogram(lift)
        found = scene.check()
        assert found.degrees_of_freedom == 1 and sum(found.redundant.values()) == 3
        assert found.singular_pose == (lift == 0.0) and ("singular" in str(found)) == (lift == 0.0)


def test_a_joint_that_repeats_another_partly_loses_only_what_repeats() -> None:
    """A sphere in addition to a hinge on the same axis: only its motion off the axis, along the held directions,
    repeats."""
    scene = Scene()
    door = scene.add_rigid_body(1.0, CUBE, name="door")
    scene.add(joints.Revolute(scene.ground, door.at((0, 0, 0)), axis=(0, 0, 1), name="hinge"))
    scene.add(joints.Spherical(scene.ground, door.at((0, 0, 1)), name="pin"))
    found = find_redundancy(scene)
    assert found.counts() == {"pin": 3} and found.rank == 5
    scene = Scene()
    door = scene.add_rigid_body(1.0, CUBE, name="door")
    scene.add(joints.Spherical(scene.ground, door.at((0, 0, 0)), name="ball"))
    scene.add(joints.Spherical(scene.ground, door.at((0, 0, 1)), name="pin"))
    assert [row.label for row in find_redundancy(scene).dropped] == ["'pin': translation along z"]
    assert scene.check().degrees_of_freedom == 1


def test_a_row_left_out_that_the_motion_breaks_is_reported() -> None:
    """Redundancy is judged at the initial pose: rows are measured again on what was recorded."""
    scene = Scene()
    beam = scene.add_rigid_body(1.0, CUBE, name="beam")
    for name in ("left", "right"):
        scene.add(joints.Fixed(scene.ground, beam.at((0, 0, 0)), name=name))
    dropped = find_redundancy(scene).dropped
    still = BodyHistory(
        np.zeros((2, 3)), np.tile([0, 0, 0, 1.0], (2, 1)), np.zeros((2, 3)), np.zeros((2, 3)), np.zeros((2, 0))
    )
    assert left_out_notes(scene, dropped, {"beam": still}, 2) == []
    still.position[1] = (0.0, 0.002, 0.0)
    (note,) = left_out_notes(scene, dropped, {"beam": still}, 2)
    assert "'right': translation along" in note and "broke it by 0.002 m" in note


# --- what is refused


def test_bad_input_names_the_thing_and_the_cure() -> None:
    scene = Scene()
    body = scene.add_rigid_body(1.0, CUBE, name="body")
    ground, port = scene.ground.at((0, 0, 0)), body.at((0, 0, 0))
    with pytest.raises(InputError, match="joint 'u': axis and second_axis must be perpendicular, their angle is 45"):
        joints.Universal(ground, port, axis=(1, 0, 0), second_axis=(1, 1, 0), name="u")
    with pytest.raises(InputError, match="joint 'c': axis has zero length"):
        joints.Cylindrical(ground, port, axis=(0, 0, 0), name="c")
    with pytest.raises(InputError, match="both ports are on 'body', which does not deform.*port of another body"):
        joints.Spherical(body.at((0, 0, 0)), body.at((1, 0, 0)))
    with pytest.raises(InputError, match="a distance needs a point on the ground"):
        joints.Distance(scene.ground, port)
    with pytest.raises(InputError, match="coincide, the rod has no direction"):
        joints.Distance(ground, port, name="rod").frames()
    with pytest.raises(InputError, match="0.2 m apart"):
        joints.PointOnLine(scene.ground.at((0.0, 0.2, 0.5)), port, axis=(0, 0, 1)).frames()
    joints.PointOnLine(scene.ground.at((0.0, 0.0, 0.5)), port, axis=(0, 0, 1)).frames()
    ball = joints.Spherical(ground, port, name="ball")
    with pytest.raises(InputError, match="drive: joint 'ball' is spherical and has no coordinate"):
        joints.Drive(ball, 1.0)
    pipe = scene.add(joints.Cylindrical(ground, port, axis=(0, 0, 1), name="pipe"))
    with pytest.raises(InputError, match="choose one of coordinate='translation', coordinate='rotation'"):
        joints.Drive(pipe, 1.0)
    with pytest.raises(InputError, match="coordinate 'spin' does not exist; known: 'translation', 'rotation'"):
        joints.Drive(pipe, 1.0, coordinate="spin")
    scene.add(joints.Drive(pipe, 1.0, coordinate="rotation"))
    with pytest.raises(InputError, match="the rotation of joint 'pipe' is driven already"):
        scene.add(joints.Drive(pipe, 1.0, coordinate="rotation"))
    scene.add(joints.Drive(pipe, 1.0, coordinate="translation"))


def test_two_drives_that_contradict_each_other_are_refused() -> None:
    scene = Scene()
    wheel = scene.add_rigid_body(1.0, CUBE, name="wheel")
    for name, speed in (("first", 1.0), ("second", 2.0)):
        joint = joints.Revolute(scene.ground, wheel.at((0, 0, 0)), axis=(0, 0, 1), name=name)
        scene.add(joint)
        scene.add(joints.Drive(joint, speed, name=f"drive_{name}"))
    with pytest.raises(InputError, match="drive 'drive_second': the rotation of joint 'second' is fixed already"):
        run(scene, 0.1, step=1e-3, progress=False)


def test_joint_histories_without_a_second_coordinate() -> None:
    zero = np.zeros((3, 3))
    history = JointHistory(np.zeros(3), zero, zero)
    assert np.all(np.isnan(np.asarray(history.second_coordinate)))


def test_the_check_names_the_drives_that_a_run_refuses() -> None:
    scene = Scene()
    port = scene.add_rigid_body(1.0, (1.0, 1.0, 1.0), name="body").at((0, 0, 0))
    hinge = scene.add(joints.Revolute(scene.ground, port, axis=(0, 0, 1)))
    scene.add(joints.Drive(hinge, 1.0, name="motor"))
    assert scene.check().refused_drives == ()
    scene.add(joints.Fixed(scene.ground, port))
    found = scene.check()
    assert found.refused_drives == ("motor",) and "driven though fixed already: motor" in str(found)
    with pytest.raises(InputError, match="drive 'motor'.*fixed already"):
        run(scene, 1e-2, step=1e-3, progress=False)


def test_a_body_held_at_the_origin_makes_no_energy() -> None:
    """All energies are round-off there, also the potential one that they could be held against."""
    scene = Scene(gravity=(0.0, 0.0, -9.81))
    body = scene.add_rigid_body(2.0, CUBE, name="body")
    scene.add(joints.Fixed(scene.ground.at((0, 0, 0)), body.at((0, 0, 0)), axis=(0.3, 0.2, 1.0)))
    assert run(scene, 0.2, step=1e-3, progress=False).status == "completed"
