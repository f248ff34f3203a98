"""Joint coordinates and the defects of rows left out, from the recorded motion of the bodies.

A coordinate is a function of the markers' poses (`warpffrf.model.joints.rows`), so it is evaluated from what is saved
instead of being carried through the step. Angles come out in (-pi, pi]; turns are counted by prediction: of a driven
coordinate its signal, else the last value and the trapezoidal rule of its rate t.(omega_b - omega_a). The turn nearest
to the prediction is taken, which is right while that is off by less than half a turn, also when saved steps lie several
turns apart.
"""

from __future__ import annotations

import numpy as np

from warpffrf.model import rotation as rot
from warpffrf.model.bodies import Port
from warpffrf.model.checks.redundancy import ConstraintRow, scene_length
from warpffrf.model.forces import SpringLaw
from warpffrf.model.joints import Drive, Joint, Marker, Row
from warpffrf.model.joints.rows import gradient, value
from warpffrf.model.scene import Scene
from warpffrf.online.history.history import BodyHistory
from warpffrf.online.history.interface_motion import interface_motion

LEFT_OUT = 1e-6  # of the scene's length, or rad: a redundant row is kept to round-off; more means that it was needed
NEAR_HALF_TURN = 0.75  # of half a turn: a bushing that comes so far is no bushing; leaves room for what is not saved


def _matrices(q: np.ndarray) -> np.ndarray:
    """Rotation matrices (T, 3, 3) of unit quaternions (T, 4)."""
    v, w = q[:, :3], q[:, 3]
    V = np.zeros((len(q), 3, 3))
    V[:, 0, 1], V[:, 0, 2], V[:, 1, 2] = -v[:, 2], v[:, 1], -v[:, 0]
    V -= V.transpose(0, 2, 1)
    return np.eye(3) + 2.0 * w[:, None, None] * V + 2.0 * V @ V


def _turns(theta: np.ndarray) -> np.ndarray:
    """Rotation matrices (T, 3, 3) of rotation vectors (T, 3)."""
    angle = np.linalg.norm(theta, axis=1)
    s = 0.5 * np.sinc(0.5 * angle / np.pi)
    return _matrices(np.concatenate([s[:, None] * theta, np.cos(0.5 * angle)[:, None]], axis=1))


def marker_motion(
    port: Port, marker: Marker, bodies: dict[str, BodyHistory], count: int
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Positions (T, 3) [m], axes (T, 3, 3) of a marker, and the angular velocity (T, 3) of its body, world axes."""
    X = np.broadcast_to(marker.point, (count, 3))
    axes = np.broadcast_to(rot.matrix(marker.rotation), (count, 3, 3))
    if port.body.index < 0:
        return X, axes, np.zeros((count, 3))
    body = bodies[port.body.name]
    if port.interface_name is not None and body.modal.shape[1]:
        motion = interface_motion(port, body)[0]
        arm = marker.point - port.body.reduced.interfaces[port.interface_name].point
        X = X + motion[:, :3] + np.cross(motion[:, 3:], arm)
        axes = _turns(motion[:, 3:]) @ axes
    A = _matrices(body.rotation)
    return body.position + np.einsum("tij,tj->ti", A, X), A @ axes, body.angular_velocity


def coordinates(
    joint: Joint, drives: dict[str, Drive], time: np.ndarray, bodies: dict[str, BodyHistory]
) -> dict[str, np.ndarray]:
    """Coordinates (T,) [m or rad] of a joint by name; `drives`: those of this joint by coordinate."""
    (x_a, A_a, w_a), (x_b, A_b, w_b) = (
        marker_motion(p, m, bodies, len(time)) for p, m in zip(joint.ports, joint.frames(), strict=True)
    )
    found = {}
    for name, row in joint.coordinates.items():
        c = value(row, x_a, A_a, x_b, A_b)
        if not row.is_length and len(time):
            _, t = gradient(row, x_a, A_a, x_b, A_b)
            c = _count_turns(c, np.einsum("ti,ti->t", t, w_b - w_a), time, drives.get(name))
        found[name] = c
    return found


def _count_turns(angle: np.ndarray, rate: np.ndarray, time: np.ndarray, drive: Drive | None) -> np.ndarray:
    if drive is not None:
        expected = drive.position()(time)
        return expected + np.angle(np.exp(1j * (angle - expected)))
    travel = 0.5 * (rate[1:] + rate[:-1]) * np.diff(time)
    steps = np.diff(angle)
    steps += 2.0 * np.pi * np.round((travel - steps) / (2.0 * np.pi))
    return np.concatenate([angle[:1], angle[0] + np.cumsum(steps)])


def left_out_notes(scene: Scene, dropped: list[ConstraintRow], bodies: dict[str, BodyHistory], count: int) -> list[str]:
    """A note for every row that was left out as redundant and did not stay satisfied at the `count` saved steps."""
    notes = []
    length = scene_length(scene) if dropped else 1.0
    for item in dropped:
        (x_a, A_a, _), (x_b, A_b, _) = (
            marker_motion(p, m, bodies, count) for p, m in zip(item.joint.ports, item.markers, strict=True)
        )
        row: Row = item.row
        off = float(np.abs(value(row, x_a, A_a, x_b, A_b) - item.initial).max(initial=0.0))
        if off > LEFT_OUT * (length if row.is_length else 1.0):
            notes.append(
                f"joint {item.label} was left out as redundant at the initial pose, but the motion broke it by "
                f"{off:.3g} {'m' if row.is_length else 'rad'}: the results are wrong there; start from another pose"
            )
    return notes


def half_turn_notes(laws: dict[str, SpringLaw], bodies: dict[str, BodyHistory], count: int) -> list[str]:
    """A note for every bushing that came near half a turn at the `count` saved steps, where its rotation vector jumps
    to the other side."""
    notes = []
    for name, law in laws.items():
        if count == 0 or not any(c.kind == "bushing" and np.any(c.vector[3:]) for c in law.coordinates):
            continue
        A_a, A_b = (
            marker_motion(port, Marker(point, rot.quaternion(axes)), bodies, count)[1]
            for port, point, axes in zip(law.ports, law.points or (), law.axes or (), strict=True)
        )
        cosine = 0.5 * (np.einsum("tij,tij->t", A_a, A_b) - 1.0)
        angle = float(np.arccos(np.clip(cosine, -1.0, 1.0)).max())
        if angle > NEAR_HALF_TURN * np.pi:
            notes.append(
                f"bushing {name!r}: its ports turned by {np.degrees(angle):.3g} degrees against each other; at half a "
                "turn its law jumps, the results beyond are wrong; use a joint with springs, or a Bearing for a shaft "
                "that spins"
            )
    return notes
