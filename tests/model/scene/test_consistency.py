"""Initial velocities, positions and tables that do not agree with the joints or the time are found before the run."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from warpffrf.model import forces, joints, signals
from warpffrf.model import rotation as rot
from warpffrf.model.checks.redundancy import refuse_positions, refuse_singular_mass, refuse_velocities, velocity_defects
from warpffrf.model.checks.scene import refuse_short_signals
from warpffrf.model.errors import InputError
from warpffrf.model.scene import Scene

ARM = np.array([0.3, -0.4, 1.2])
AXIS = np.array([1.0, 2.0, 2.0]) / 3.0


def swing(velocity: np.ndarray, angular_velocity: np.ndarray) -> Scene:
    """A body on a hinge at ARM from its origin, in a skew pose; and one that is let go."""
    scene = Scene()
    A = rot.rotation_vector_matrix(np.array([0.3, 0.5, -0.8]))
    body = scene.add_rigid_body(
        2.0, (1.0, 1.0, 1.0), name="body", position=-ARM, rotation=rot.quaternion(A), velocity=velocity,
        angular_velocity=angular_velocity,
    )  # fmt: skip
    scene.add(joints.Revolute(scene.ground, body.at(A.T @ ARM), axis=AXIS, name="hinge"))
    scene.add_rigid_body(1.0, (1.0, 1.0, 1.0), name="free", position=(9, 9, 9), velocity=(1, 2, 3))
    return scene


def test_velocities_that_fit_leave_nothing() -> None:
    omega = 7.0 * AXIS
    for angular in (np.zeros(3), omega):
        assert velocity_defects(swing(np.cross(angular, -ARM), angular)) == []
    typed = np.array([float(f"{x:.5e}") for x in np.cross(omega, -ARM)])
    assert velocity_defects(swing(typed, omega)) == []


def test_a_body_on_its_own_axle_but_for_round_off_may_turn() -> None:
    """The only arm of the scene is 1e-19 m: no length to judge velocities by."""
    scene = Scene()
    body = scene.add_rigid_body(2.0, (1.0, 1.0, 1.0), name="body", angular_velocity=(0.0, 200.0, 0.0))
    scene.add(joints.Revolute(scene.ground, body.at((1e-19, 0.0, 3e-19)), axis=(0, 1, 0), name="axle"))
    assert velocity_defects(scene) == []
    body.velocity = np.array([0.1, 0.0, 0.0])
    assert [defect.owner for defect in velocity_defects(scene)] == ["axle"]


def test_what_is_left_is_reported_per_joint() -> None:
    """The point of the body at the hinge moves with v + omega x ARM; a turn across the axis is left over whole."""
    omega = np.array([1.0, -3.0, 0.5])
    v = np.array([0.2, 0.1, -0.4])
    scene = swing(v, omega)
    (defect,) = velocity_defects(scene)
    assert defect.owner == "hinge" and not defect.driven
    assert defect.translation == pytest.approx(np.linalg.norm(v + np.cross(omega, ARM)), rel=1e-12)
    assert defect.rotation == pytest.approx(np.linalg.norm(omega - AXIS * (AXIS @ omega)), rel=1e-12)
    said = rf"joint 'hinge' by {defect.translation:.3g} m/s and {defect.rotation:.3g} rad/s.*project_start=True"
    with pytest.raises(InputError, match=said):
        refuse_velocities(scene)
    assert "initial velocities violate joints: joint 'hinge'" in str(scene.check())


def test_drives_are_reported_but_not_refused() -> None:
    scene = swing(np.zeros(3), np.zeros(3))
    scene.add(joints.Drive(scene.joint("hinge"), signals.Ramp(4.0, 5.0, duration=1.0), name="motor"))
    (defect,) = velocity_defects(scene)
    assert defect.driven and str(defect) == "drive 'motor' by 4 rad/s"
    refuse_velocities(scene)


def test_a_prescribed_position_begins_where_the_joint_stands() -> None:
    scene = swing(np.zeros(3), np.zeros(3))
    hinge, free = scene.joint("hinge"), scene.body("free")
    rope = scene.add(joints.Distance(scene.ground.at((9, 9, 7)), free.at((0, 0, 0)), name="rope"))
    turn = scene.add(joints.Drive(hinge, 2.0 * np.pi, quantity="position", name="turn"))
    pull = scene.add(joints.Drive(rope, 2.0, quantity="position", name="pull"))
    refuse_positions(scene)
    turn.signal = signals.SmoothStep(0.25, 1.0, duration=1.0)
    with pytest.raises(InputError, match=r"'turn': it prescribes rotation = 0.25 rad .* 'hinge' stands at 0 rad"):
        refuse_positions(scene)
    turn.signal, pull.signal = signals.Constant(0.0), signals.Constant(2.5)
    with pytest.raises(InputError, match=r"'pull': .* distance = 2.5 m .* 'rope' stands at 2 m .*start='equilibrium'"):
        refuse_positions(scene)


def test_a_sine_covers_its_duration() -> None:
    scene = swing(np.zeros(3), np.zeros(3))
    body = scene.bodies[0]
    scene.add(forces.PointForce(body.at((0, 0, 0)), (signals.Sine(1.0, 2.0, duration=0.9), 0, 0), name="f"))
    refuse_short_signals(scene, 0.0, 0.9)
    with pytest.raises(InputError, match="'f': its signal covers 0 to 0.9 s, but 0 to 1 s are simulated; extend"):
        refuse_short_signals(scene, 0.0, 1.0)


@pytest.mark.parametrize(("times", "fits"), [((0.0, 1.0), True), ((0.0, 0.9), False), ((0.1, 1.0), False)])
def test_a_table_covers_the_time(times: tuple[float, float], fits: bool) -> None:
    table = signals.Table(times, [1.0, 2.0])

    def refused(scene: Scene, name: str) -> None:
        if fits:
            refuse_short_signals(scene, 0.0, 1.0)
            return
        with pytest.raises(InputError, match=rf"{name!r}: its signal covers .* but 0 to 1 s are simulated; extend"):
            refuse_short_signals(scene, 0.0, 1.0)

    scene = swing(np.zeros(3), np.zeros(3))
    scene.add(joints.Drive(scene.joint("hinge"), table, name="motor"))
    refused(scene, "motor")
    scene = swing(np.zeros(3), np.zeros(3))
    scene.add(forces.PointForce(scene.body("free").at((0, 0, 0)), (0.0, table, 0.0), name="push"))
    refused(scene, "push")


def test_a_body_without_inertia_about_an_axis_is_refused(body_maker) -> None:
    """Nodes on one line have no inertia about it."""
    scene = Scene()
    scene.add_body(body_maker(), name="round")
    refuse_singular_mass(scene)
    scene.add_body(replace(body_maker(), inertia=np.diag([1e-3, 1e-20, 1e-3])), name="wire")
    with pytest.raises(InputError, match=r"body 'wire': its mass matrix is singular .*1e-20"):
        refuse_singular_mass(scene)
