"""Forces and sensors of a run from what it saved: motion of ports, wrenches of elements, and their sums.

A port at X (user frame) of a body with user origin r, orientation A and angular velocity omega moves as

    x = r + A y,      y = X + u + theta cross (X - X_if),
    v = rdot + omega cross A y + A ydot,
    a = rddot + alpha cross A y + omega cross (omega cross A y) + 2 omega cross A ydot + A yddot,

with the motion (u, theta) of an interface at X_if (`interface_motion`), zero of other ports. Accelerations are those
of the equations of motion, not differences.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from warpffrf.model.bodies import Port
from warpffrf.model.forces import BodyLoad, SlipLaw, SpringLaw, TensionLaw
from warpffrf.model.joints import coincident_within
from warpffrf.model.scene import Scene
from warpffrf.online.compile.forces import ForceTable
from warpffrf.online.history.history import BodyHistory, ForceHistory, JointHistory, SensorHistory
from warpffrf.online.history.interface_motion import interface_motion


def turned(p: np.ndarray, x: np.ndarray) -> np.ndarray:
    """Vectors x (3,) or (T, 3) turned by unit quaternions p (T, 4)."""
    v, w = p[:, :3], p[:, 3:]
    x = np.broadcast_to(x, v.shape)
    t = 2.0 * np.cross(v, x)
    return x + w * t + np.cross(v, t)


def point_motion(port: Port, point: np.ndarray, bodies: dict[str, BodyHistory], count: int) -> tuple[np.ndarray, ...]:
    """Position, velocity and acceleration (T, 3), world, of the place `point` (3,) [m, user frame] that moves with the
    port's interface, or with its body."""
    if port.body.index < 0:
        zero = np.zeros((count, 3))
        return zero + point, zero, zero
    body = bodies[port.body.name]
    y, y_rate, y_rate2 = np.tile(point, (count, 1)), np.zeros((count, 3)), np.zeros((count, 3))
    if port.interface_name is not None and body.modal.shape[1]:
        arm = point - port.body.reduced.interfaces[port.interface_name].point
        for target, motion in zip((y, y_rate, y_rate2), interface_motion(port, body), strict=True):
            target += motion[:, :3] + np.cross(motion[:, 3:], arm)
    p, omega, alpha = body.rotation, body.angular_velocity, body.angular_acceleration
    arm, swing = turned(p, y), turned(p, y_rate)
    velocity = body.velocity + np.cross(omega, arm) + swing
    acceleration = body.acceleration + np.cross(alpha, arm) + np.cross(omega, np.cross(omega, arm) + 2.0 * swing)
    return body.position + arm, velocity, acceleration + turned(p, y_rate2)


def force_histories(
    scene: Scene,
    table: ForceTable,
    time: np.ndarray,
    value: np.ndarray,
    wrench: np.ndarray,
    bodies: dict[str, BodyHistory],
) -> dict[str, ForceHistory]:
    """Force and torque of every force element but friction in joints and pretensions, from `value` (T, rows) and
    `wrench` (T, rows, 6) of the rows in `table`."""
    found: dict[str, ForceHistory] = {}
    T = len(time)
    for item in scene.forces:
        if hasattr(item, "slip") or (hasattr(item, "tension") and item.name not in table.rows):
            continue
        if item.name in table.rows:
            own = table.rows[item.name]
            total = wrench[:, own].sum(axis=1)
            law = table.laws[item.name]
            deformation = value[:, own]
            if law.expand is not None:
                deformation = deformation @ law.expand.T
            found[item.name] = ForceHistory(total[:, :3], total[:, 3:], deformation.copy())
            continue
        load = item.load()
        none = np.zeros((T, 0))
        if isinstance(load, BodyLoad):
            p, s = bodies[load.body.name].rotation, load.signal(time)[:, None]
            found[item.name] = ForceHistory(turned(p, s * load.force), turned(p, s * load.torque), none)
            continue
        vector = np.stack([signal(time) for signal in load.components], axis=1)
        if load.frame == "body":
            vector = turned(bodies[load.port.body.name].rotation, vector)
        zero = np.zeros((T, 3))
        pair = (vector, zero) if load.what == "force" else (zero, vector)
        found[item.name] = ForceHistory(*pair, none)
    return found


def sensor_histories(
    scene: Scene,
    count: int,
    bodies: dict[str, BodyHistory],
    joints: dict[str, JointHistory],
    forces: dict[str, ForceHistory],
) -> dict[str, SensorHistory]:
    """Values of all sensors but stresses, which need the contact pressures and are evaluated by the result."""
    found = {}
    for sensor in scene.sensors:
        if sensor.kind == "stress":
            continue
        values = _EVALUATE[sensor.kind](sensor, scene, count, bodies, joints, forces)
        found[sensor.name] = SensorHistory(sensor.kind, sensor.unit, sensor.frame, tuple(sensor.components), values)
    return found


def _motion(order: int) -> Callable[..., np.ndarray]:
    def evaluate(sensor, scene, count, bodies, joints, forces) -> np.ndarray:
        value = point_motion(sensor.port, sensor.port.point, bodies, count)[order]
        if sensor.frame == "body":
            p = bodies[sensor.port.body.name].rotation
            value = turned(p * np.array([-1.0, -1.0, -1.0, 1.0]), value)
        return value

    return evaluate


def _reaction(sensor, scene, count, bodies, joints, forces) -> np.ndarray:
    joint = joints[sensor.joint.name]
    return np.hstack([joint.force, joint.torque])


def _interface(sensor, scene, count, bodies, joints, forces) -> np.ndarray:
    """Sum of the wrenches at the sensor's port, about the port."""
    x = point_motion(sensor.port, sensor.port.point, bodies, count)[0]
    total = np.zeros((count, 6))

    def add(sign: float, force: np.ndarray, torque: np.ndarray, at: np.ndarray) -> None:
        total[:, :3] += sign * force
        total[:, 3:] += sign * (torque + np.cross(at - x, force))

    for joint in scene.joints:
        history = joints[joint.name]
        points = [marker.point for marker in joint.frames()]
        at = point_motion(joint.b, points[1], bodies, count)[0]
        for sign, port, point in zip((-1.0, 1.0), joint.ports, points, strict=True):
            if same_place(port, point, sensor.port):
                add(sign, history.force, history.torque, at)
    for item in scene.forces:
        history = forces[item.name]
        law: SpringLaw | SlipLaw | TensionLaw | None = next(
            (getattr(item, term)() for term in ("law", "slip", "tension") if hasattr(item, term)), None
        )
        if law is not None:
            given = law.points if isinstance(law, SpringLaw) else None
            points = given or [marker.point for marker in law.joint.frames()]
            at = point_motion(law.ports[1], points[1], bodies, count)[0]
            for sign, port, point in zip((-1.0, 1.0), law.ports, points, strict=True):
                if same_place(port, point, sensor.port):
                    add(sign, history.force, history.torque, at)
        elif len(item.ports) == 1 and same_place(item.ports[0], None, sensor.port):
            at = x
            if isinstance(item.load(), BodyLoad):  # its torque is about the user origin
                at = bodies[sensor.port.body.name].position
            add(1.0, history.force, history.torque, at)
    return total


def same_place(port: Port, point: np.ndarray | None, other: Port) -> bool:
    """True for two ports of the same interface, or of the same point of a body without; `point` stands for that of a
    port on the bare ground."""
    if port.body is not other.body:
        return False
    name, other_name = getattr(port, "interface_name", ""), other.interface_name
    if name is not None or other_name is not None:
        return name == other_name
    here = point if port.point is None else port.point
    return here is not None and float(np.linalg.norm(here - other.point)) <= coincident_within(port, other)


_EVALUATE = {
    "position": _motion(0),
    "velocity": _motion(1),
    "acceleration": _motion(2),
    "joint_reaction": _reaction,
    "interface_force": _interface,
}
