"""Every kind of joint in the registry: what it leaves free and holds, the device against NumPy, action and reaction."""

from __future__ import annotations

import numpy as np
import pytest
from joint_scenes import FREE, KINDS, PLACE, SPAN, make_joint, moved, pair

from warpffrf.model import joints
from warpffrf.model import rotation as rot
from warpffrf.model.checks.redundancy import (
    Pose,
    constraint_jacobian,
    constraint_rows,
    initial_pose,
    marker_pose,
    scene_length,
)
from warpffrf.model.joints.base import Row, gradient, value
from warpffrf.model.scene import Scene
from warpffrf.online import Engine
from warpffrf.online.step.launches import blocks
from warpffrf_kernels.bodies import interfaces
from warpffrf_kernels.constraints import rows as row_kernels
from warpffrf_kernels.core import control as k

STEP = 1e-6  # of central differences: truncation 1e-12, round-off 1e-10
DERIVATIVE_TOLERANCE = 1e-8


def test_registry_is_covered() -> None:
    assert set(KINDS) == set(FREE), "state in joint_scenes.FREE what the new joint leaves free"
    for kind, cls in joints.JOINT_KINDS.items():
        assert cls.kind == kind and issubclass(cls, joints.Joint) and cls.__doc__


def values(scene: Scene, joint: joints.Joint, pose: Pose) -> np.ndarray:
    """Constraint values against their initial ones."""
    at = [marker_pose(scene, pose, p, m) for p, m in zip(joint.ports, joint.frames(), strict=True)]
    return np.array([float(value(r, *at[0], *at[1])) - joint.initial_value(r) for r in joint.rows])


@pytest.mark.parametrize("kind", KINDS)
def test_allowed_motions_are_free_and_all_others_are_held(kind: str) -> None:
    """Finite motions by the free ones leave every row at zero; a small motion perpendicular to them does not."""
    scene, joint = pair(kind, grounded=True)
    random = np.random.default_rng(1)
    axes = joint.axes()
    start = scene.bodies[0]
    reach = SPAN if kind == "distance" else np.zeros(3)
    A0, arm = rot.matrix(start.rotation), PLACE + reach - start.position

    def posed(R: np.ndarray, d: np.ndarray, pivot: np.ndarray) -> Pose:
        """b rotated by R about its port, whose point moves to pivot + d."""
        pose = initial_pose(scene)
        pose.axes[0] = R @ A0
        pose.position[0] = pivot + d - R @ arm
        return pose

    for _ in range(5):
        R, d = moved(kind, random.uniform(-1.2, 1.2, len(FREE[kind].replace("'", ""))), axes)
        pivot = PLACE + reach
        if kind == "distance":  # the rod turns as well
            pivot = PLACE + rot.rotation_vector_matrix(random.uniform(-1.0, 1.0, 3)) @ reach
        assert np.abs(values(scene, joint, posed(R, d, pivot))).max() < 1e-14

    def small(twist: np.ndarray) -> np.ndarray:
        R = rot.rotation_vector_matrix(twist[3:])
        return values(scene, joint, posed(R, twist[:3], PLACE + reach))

    J = np.array([(small(STEP * e) - small(-STEP * e)) / (2.0 * STEP) for e in np.eye(6)]).T
    free = np.linalg.svd(J)[2][len(joint.rows) :]
    assert len(free) == 6 - len(joint.rows) == 6 - np.linalg.matrix_rank(J, tol=1e-6)
    for held in np.linalg.svd(J)[2][: len(joint.rows)]:
        assert np.linalg.norm(J @ held) > 0.3  # rows are unit vectors and unit turns
    coordinates = joint.coordinates.values()
    assert len(set(joint.coordinates)) == len(tuple(coordinates)) <= 2


@pytest.mark.parametrize("kind", KINDS)
def test_gradients_agree_with_finite_differences(kind: str) -> None:
    """Rows and coordinates, in a pose that does not satisfy them."""
    random = np.random.default_rng(2)
    cls = joints.JOINT_KINDS[kind]
    for row in (*cls.rows, *cls.coordinates.values()):
        x_a, x_b = random.normal(size=(2, 3))
        A_a, A_b = (rot.rotation_vector_matrix(0.6 * random.normal(size=3)) for _ in range(2))
        f, t = gradient(row, x_a, A_a, x_b, A_b)
        for e in np.eye(3):
            R = [rot.rotation_vector_matrix(s * STEP * e) for s in (1.0, -1.0)]

            def slope(plus: tuple, minus: tuple, row: Row = row) -> float:
                return float(value(row, *plus) - value(row, *minus)) / (2.0 * STEP)

            moved_b = slope((x_a, A_a, x_b + STEP * e, A_b), (x_a, A_a, x_b - STEP * e, A_b))
            turned_b = slope((x_a, A_a, x_b, R[0] @ A_b), (x_a, A_a, x_b, R[1] @ A_b))
            turned = [(x_b + r @ (x_a - x_b), r @ A_a, x_b, A_b) for r in R]  # about x_b
            turned_a = slope(turned[0], turned[1])
            assert [moved_b, turned_b, turned_a] == pytest.approx([f @ e, t @ e, -t @ e], abs=DERIVATIVE_TOLERANCE)


def evaluate_on_device(scene: Scene, pose: Pose) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Defects, rigid and modal gradients of all rows in a pose, and the wrenches they are made of, from the kernel."""
    engine = Engine(scene)
    m, x = engine.compiled, engine.scratch
    q = np.concatenate([np.zeros(0), *pose.modal])
    x.r1.assign(np.array([[pose.position[i] + pose.axes[i] @ b.center_of_mass for i, b in enumerate(scene.bodies)]]))
    x.axes.assign(pose.axes[None])
    if len(q):
        x.q1.assign(q[None])
    engine.control(run=1, moved=1)
    program = engine.graph.program
    for kernel in (interfaces.move_interfaces, row_kernels.evaluate_rows):
        blocks(kernel).go(program.arrays, program.sizes, program.device)
    n = m.row_count
    return tuple(a.numpy()[0][:n].copy() for a in (x.defect, x.C, x.C_modal, x.row_wrench))  # type: ignore[return-value]


def shifted(scene: Scene, pose: Pose, unknown: int, amount: float) -> Pose:
    """A pose moved along one device unknown: per body centre of mass (world) and turn (body axes), then the modes."""
    position, axes, modal = pose.position.copy(), pose.axes.copy(), [q.copy() for q in pose.modal]
    if unknown >= 6 * len(scene.bodies):
        at = unknown - 6 * len(scene.bodies)
        for q in modal:
            if at < len(q):
                q[at] += amount
                break
            at -= len(q)
        return Pose(position, axes, modal)
    b, c = divmod(unknown, 6)
    center = position[b] + axes[b] @ scene.bodies[b].center_of_mass
    e = np.eye(3)[c % 3]
    if c < 3:
        center = center + amount * e
    else:
        axes[b] = axes[b] @ rot.rotation_vector_matrix(amount * e)
    position[b] = center - axes[b] @ scene.bodies[b].center_of_mass
    return Pose(position, axes, modal)


def with_drives(scene: Scene, joint: joints.Joint) -> None:
    for name in joint.coordinates:
        scene.add(joints.Drive(joint, 0.0, coordinate=name, name=name))


@pytest.mark.parametrize("kind", KINDS)
def test_device_rows_agree_with_numpy_and_action_equals_reaction(kind: str) -> None:
    """Values and gradients by finite differences of the independent NumPy rows, in a perturbed pose."""
    scene, joint = pair(kind)
    with_drives(scene, joint)
    rows = constraint_rows(scene)
    random = np.random.default_rng(3)
    pose = initial_pose(scene)
    for unknown in range(12):
        pose = shifted(scene, pose, unknown, 0.2 * random.normal())
    defect, C, _, wrench = evaluate_on_device(scene, pose)

    def defects(p: Pose) -> np.ndarray:
        at = [marker_pose(scene, p, port, m) for port, m in zip(joint.ports, joint.frames(), strict=True)]
        return np.array([float(value(r.row, *at[0], *at[1])) - r.initial for r in rows])

    assert defect == pytest.approx(defects(pose), abs=1e-14)
    for unknown in range(12):
        plus, minus = (defects(shifted(scene, pose, unknown, s * STEP)) for s in (1.0, -1.0))
        assert C[:, unknown] == pytest.approx((plus - minus) / (2.0 * STEP), abs=DERIVATIVE_TOLERANCE)
    force = C.reshape(len(rows), 2, 6)[:, :, :3]
    assert np.abs(force.sum(axis=1)).max() < 1e-14
    r = np.array([pose.position[i] + pose.axes[i] @ b.center_of_mass for i, b in enumerate(scene.bodies)])
    moment = np.cross(r, force) + np.einsum("bij,rbj->rbi", pose.axes, C.reshape(len(rows), 2, 6)[:, :, 3:])
    assert np.abs(moment.sum(axis=1)).max() < 1e-14
    assert wrench[:, :3] == pytest.approx(force[:, joint.b.body.index], abs=1e-15)


@pytest.mark.parametrize("kind", KINDS)
def test_flexible_interfaces(kind: str, flexible_body) -> None:
    """Gradients by modal coordinates, of a joint between two flexible bodies whose interfaces have moved a little."""
    scene = Scene()
    a, b = (
        scene.add_body(flexible_body, name=n, rotation=r) for n, r in (("a", (0, 0, 0, 1)), ("b", (0, 0.6, 0, 0.8)))
    )
    interface = next(iter(flexible_body.interfaces))
    scene.place(b[interface], onto=a[interface])
    if kind == "distance":
        b.position = b.position + SPAN

    joint = scene.add(make_joint(kind, a[interface], b[interface], name="j"))
    with_drives(scene, joint)
    rows = constraint_rows(scene)
    modes = np.abs(flexible_body.interfaces[interface].modes).max()
    pose = initial_pose(scene)
    random = np.random.default_rng(4)
    amount = 1e-6 / modes  # turns of 1e-6: what the derivative leaves out is linear in them
    for q in pose.modal:
        q += amount * random.normal(size=len(q))
    _, C, C_modal, _ = evaluate_on_device(scene, pose)
    J, _, factor = constraint_jacobian(scene, rows, pose)

    plain = J / factor * np.array([scene_length(scene) if r.row.is_length else 1.0 for r in rows])[:, None]
    m = a.mode_count
    assert m > 0
    numpy_modal = np.hstack([plain[:, 6 : 6 + m], plain[:, 12 + m : 12 + 2 * m]])
    assert np.abs(C_modal - numpy_modal).max() < 1e-12 * max(1.0, np.abs(numpy_modal).max())

    def defects(p: Pose) -> np.ndarray:
        at = [marker_pose(scene, p, port, mark) for port, mark in zip(joint.ports, joint.frames(), strict=True)]
        return np.array([float(value(r.row, *at[0], *at[1])) - r.initial for r in rows])

    for unknown in range(12, 12 + 2 * m):
        h = 1e-5 / modes
        plus, minus = (defects(shifted(scene, pose, unknown, s * h)) for s in (1.0, -1.0))
        slope = (plus - minus) / (2.0 * h)
        assert np.abs(C_modal[:, unknown - 12] - slope).max() < 1e-5 * modes
    assert np.abs(C[:, :12]).max() > 0.1


@pytest.fixture(scope="module")
def flexible_body():
    """A small roller with a rigid bore and a few modes."""
    from scenes.rollers import roller_body

    return roller_body(24, layers=2, axial=2, grading=1.0, order=1, max_frequency=30e3, cache=False)


def test_angle_row_kinds_have_the_kernel_numbers() -> None:
    from warpffrf.online.compile.joints import ROW_KINDS

    assert len({int(v) for v in ROW_KINDS.values()}) == len(ROW_KINDS)
    assert int(k.ANGLE) == int(ROW_KINDS["angle"])
