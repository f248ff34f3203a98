"""Joint reactions of a statically determinate mechanism, against the equilibrium of its bodies by NumPy.

A crane of six bodies: a slewing column, a counterweight fixed to it, a boom on a hinge held by a strut, a jib on a
universal joint stayed by two ropes, a trolley that slides on the jib and is held by a rope, and a hook block on a ball
held by three ropes. Every body has exactly six reaction components, so the Newton-Euler equations of the bodies
determine them: at rest, and while the whole crane slews at a constant rate, where all accelerations are known.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import warpffrf as wf
from warpffrf.model import joints
from warpffrf.model import rotation as rot
from warpffrf.model.scene import Scene
from warpffrf.online import run

GRAVITY = np.array([0.0, 0.0, -9.81])
REACTION = 1e-8  # of the largest reaction, promised
INSTANT = 1e-11  # the same where no step has been made: round-off
Z = np.array([0.0, 0.0, 1.0])

# (place of the centre of mass, mass); all numbers are arbitrary, no two axes are parallel by chance
BODIES = {
    "column": ((0.1, -0.2, 2.0), 900.0),
    "counterweight": ((-1.5, 0.3, 1.1), 2500.0),
    "boom": ((2.1, 0.4, 4.3), 400.0),
    "jib": ((5.2, 0.9, 6.4), 150.0),
    "trolley": ((6.1, 1.3, 6.0), 60.0),
    "hook": ((7.3, 0.8, 4.9), 300.0),
}
CROSS = np.array([[0.3, 1.0, -0.1], [1.0, -0.3, 0.0]])  # the two axes of the universal joint
TILT = np.array([0.1, -0.97, 0.2])
JOINTS: dict[str, tuple] = {  # kind, first body, second body, point, axis; of a rope both ends
    "slew": (joints.Revolute, None, "column", (0.0, 0.0, 0.5), Z),
    "bolts": (joints.Fixed, "column", "counterweight", (-0.8, 0.1, 1.2), None),
    "heel": (joints.Revolute, "column", "boom", (0.4, 0.1, 3.1), TILT),
    "strut": (joints.Distance, "column", "boom", (0.6, 0.0, 1.2), (2.4, 0.5, 4.1)),
    "knee": (joints.Universal, "boom", "jib", (4.0, 0.7, 5.6), CROSS[0]),
    "stay left": (joints.Distance, "column", "jib", (0.2, 1.1, 5.2), (5.6, 1.4, 6.8)),
    "stay right": (joints.Distance, "column", "jib", (0.1, -0.9, 5.0), (5.4, 0.2, 6.9)),
    "rail": (joints.Prismatic, "jib", "trolley", (6.0, 1.1, 6.3), (1.0, 0.15, 0.25)),
    "haul": (joints.Distance, "boom", "trolley", (3.7, 0.9, 5.5), (6.2, 1.2, 6.1)),
    "ball": (joints.Spherical, "trolley", "hook", (6.3, 1.2, 5.7), None),
    "rope a": (joints.Distance, "jib", "hook", (6.4, 1.0, 6.7), (7.4, 1.1, 5.2)),
    "rope b": (joints.Distance, "jib", "hook", (5.0, 2.0, 6.2), (7.0, 1.5, 4.6)),
    "rope c": (joints.Distance, "boom", "hook", (3.0, -0.7, 4.6), (7.5, 0.1, 4.7)),
}


def tensor(name: str) -> np.ndarray:
    """An inertia tensor of a cloud of points, full, world axes at the initial pose."""
    points = np.random.default_rng(len(name)).standard_normal((5, 3))
    points -= points.mean(axis=0)
    return BODIES[name][1] / 5.0 * np.sum([p @ p * np.eye(3) - np.outer(p, p) for p in points], axis=0)


def crane(rate: float, turned: float = 0.0) -> Scene:
    """The crane slewing at `rate` [rad/s], its pose rotated by `turned` [rad] about the slewing axis; the user frames
    of the bodies lie anyhow."""
    scene, spin = Scene(gravity=GRAVITY), rate * Z
    R = rot.rotation_vector_matrix(turned * Z)
    bodies = {}
    for n, (name, (center, mass)) in enumerate(BODIES.items()):
        A = rot.rotation_vector_matrix(np.random.default_rng(n).standard_normal(3))
        offset = np.array([0.3, -0.2, 0.1]) * n
        origin = R @ np.array(center) - A @ offset
        bodies[name] = scene.add_rigid_body(
            mass, A.T @ R @ tensor(name) @ R.T @ A, name=name, center_of_mass=offset, position=origin,
            rotation=rot.quaternion(A), velocity=np.cross(spin, origin), angular_velocity=spin,
        )  # fmt: skip
    for name, (kind, first, second, x, y) in JOINTS.items():

        def port(body: str | None, point: Any) -> Any:
            at = R @ np.array(point)
            return scene.ground.at(at) if body is None else bodies[body].at(bodies[body].to_user(at))

        if kind is joints.Distance:
            scene.add(kind(port(first, x), port(second, y), name=name))
        else:
            options: dict[str, Any] = {} if y is None else {"axis": R @ y}
            if kind is joints.Universal:
                options["second_axis"] = R @ CROSS[1]
            scene.add(kind(port(first, x), port(second, x), name=name, **options))
    scene.add(joints.Drive(scene.joint("slew"), rate, quantity="velocity", name="motor"))
    return scene


def directions(name: str, R: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The place (3,) where a joint pulls on its second body, and the wrenches (k, 6) that it can exert there, written
    down kind by kind; axes of the world at the pose `R` after the initial one."""
    kind, _, _, x, y = JOINTS[name]
    place = R @ np.array(y if kind is joints.Distance else x)
    if kind is joints.Distance:
        line = place - R @ np.array(x)
        return place, np.concatenate([line / np.linalg.norm(line), np.zeros(3)])[None]
    forces, torques = np.hstack([np.eye(3), np.zeros((3, 3))]), np.hstack([np.zeros((3, 3)), np.eye(3)])
    if kind is joints.Spherical:
        return place, forces
    if kind is joints.Fixed or name == "slew":  # the motor holds the last rotation
        return place, np.vstack([forces, torques])
    across = np.linalg.svd(R @ np.array(y)[:, None])[0].T[1:]  # perpendicular to the axis
    none = np.zeros((2, 3))
    if kind is joints.Revolute:
        return place, np.vstack([forces, np.hstack([none, across])])
    if kind is joints.Prismatic:
        return place, np.vstack([np.hstack([across, none]), torques])
    assert kind is joints.Universal  # its two axes stay perpendicular: the torque is along their cross product
    return place, np.vstack([forces, np.concatenate([np.zeros(3), R @ np.cross(*CROSS)])[None]])


def equilibrium(rate: float, angle: float) -> dict[str, np.ndarray]:
    """Wrench (6,) of each joint on its second body at its place there: 36 Newton-Euler equations, solved."""
    R = rot.rotation_vector_matrix(angle * Z)
    names, spin = list(BODIES), rate * Z
    columns: list[np.ndarray] = []
    owners: list[tuple[str, np.ndarray]] = []
    centers = {name: R @ np.array(center) for name, (center, _) in BODIES.items()}
    for joint, (_, first, second, _, _) in JOINTS.items():
        place, wrenches = directions(joint, R)
        for w in wrenches:
            column = np.zeros((len(names), 6))
            for sign, body in ((-1.0, first), (1.0, second)):
                if body is not None:
                    column[names.index(body), :3] += sign * w[:3]
                    column[names.index(body), 3:] += sign * (w[3:] + np.cross(place - centers[body], w[:3]))
            columns.append(column.ravel())
            owners.append((joint, w))
    right = np.zeros((len(names), 6))
    for i, name in enumerate(names):
        mass, J = BODIES[name][1], R @ tensor(name) @ R.T
        right[i, :3] = mass * np.cross(spin, np.cross(spin, centers[name])) - mass * GRAVITY
        right[i, 3:] = np.cross(spin, J @ spin)
    A = np.array(columns).T
    assert A.shape == (36, 36) and np.linalg.cond(A / np.linalg.norm(A, axis=0)) < 1e6
    x = np.linalg.solve(A, right.ravel())
    found = {joint: np.zeros(6) for joint in JOINTS}
    for value, (joint, w) in zip(x, owners, strict=True):
        found[joint] += value * w
    return found


def error(history: Any, row: int, expected: dict[str, np.ndarray]) -> float:
    """Largest deviation of a reaction, force or torque, over the largest of its kind."""
    worst = 0.0
    for part, attribute in ((slice(0, 3), "force"), (slice(3, 6), "torque")):
        largest = max(np.abs(w[part]).max() for w in expected.values())
        for name, wrench in expected.items():
            off = np.abs(getattr(history.joints[name], attribute)[row] - wrench[part]).max()
            worst = max(worst, float(off / largest))
    return worst


def test_the_crane_is_statically_determinate() -> None:
    check = crane(0.0).check()
    assert check.degrees_of_freedom == 0 and not check.redundant


@pytest.mark.parametrize("angle", [0.0, 0.83])
def test_reactions_at_rest(angle: float) -> None:
    scene = crane(0.0, angle)
    history = run(scene, 0.5, step=1e-2, progress=False)
    assert history.status == "completed" and not history.counters["rejected_steps"]
    expected = equilibrium(0.0, angle)
    assert error(history, 0, expected) < INSTANT
    assert max(error(history, row, expected) for row in range(len(history.time))) < REACTION
    settled = wf.equilibrium(scene).history
    assert settled.status == "completed" and error(settled, 0, expected) < REACTION


def test_reactions_while_slewing() -> None:
    """The first row is exact; later ones have the error of the integrator's accelerations, of second order. (At 1e-3 s
    round-off of positions over the square of the step shows, 5e-7.)"""
    rate = 1.3
    errors = []
    for step in (8e-3, 4e-3, 2e-3):
        scene = crane(rate)
        history = run(scene, 0.4, step=step, progress=False)
        assert history.status == "completed" and not history.notes
        assert error(history, 0, equilibrium(rate, 0.0)) < INSTANT
        errors.append(error(history, -1, equilibrium(rate, rate * 0.4)))
    assert np.log2(np.array(errors[:-1]) / errors[1:]).min() > 1.9 and errors[-1] < 2e-6
