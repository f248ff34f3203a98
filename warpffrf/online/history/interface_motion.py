r"""Motion of an interface and a port, from the recorded motion of the body.

With d = Phi^T q - q.K q/2 of `warpffrf.model.reduced.inertia` the rates are

    d' = Phi^T qd - q.K qd,      d'' = Phi^T qdd - q.K qdd - qd.K qd.

A port at X (user frame) of a body with user origin r, orientation A and angular velocity omega moves as

    x = r + A y,      y = X + u + theta cross (X - X_if),
    v = rdot + omega cross A y + A ydot,
    a = rddot + alpha cross A y + omega cross (omega cross A y) + 2 omega cross A ydot + A yddot,

with the motion d = (u, theta) of an interface at X_if, zero of other ports. Accelerations are those of the equations of
motion, not finite differences.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, TypeAlias

import numpy as np

from warpffrf.model.bodies import Port
from warpffrf.model.reduced import inertia as at_rest
from warpffrf.model.rotation import cross

if TYPE_CHECKING:
    from warpffrf.online.history.history import BodyHistory

Motion: TypeAlias = tuple[np.ndarray, np.ndarray, np.ndarray]  # (T, ...) of a quantity, its rate, the rate of that


def interface_motion(port: Port, body: BodyHistory) -> Motion:
    """Motion (T, 6) [m, rad] of the interface of `port`, its rate [1/s] and the rate of that [1/s^2], body axes."""
    name = str(port.interface_name)
    modes = port.body.reduced.interfaces[name].modes
    q, qd, qdd = body.modal, body.modal_velocity, body.modal_acceleration

    def bent(x: np.ndarray, y: np.ndarray) -> np.ndarray:
        return at_rest.second_order(port.body, name, x, y)

    motion = at_rest.interface_motion(port.body, name, q)
    return motion, qd @ modes - bent(q, qd), qdd @ modes - bent(q, qdd) - bent(qd, qd)


def turned(p: np.ndarray, x: np.ndarray) -> np.ndarray:
    """Vectors x (3,) or (T, 3) rotated by unit quaternions p (T, 4)."""
    v, w = p[:, :3], p[:, 3:]
    x = x if x.shape == v.shape else np.broadcast_to(x, v.shape)
    t = 2.0 * cross(v, x)
    return x + w * t + cross(v, t)


def point_motion(port: Port, point: np.ndarray, bodies: Mapping[str, BodyHistory], count: int) -> Motion:
    """Position, velocity and acceleration (T, 3), world, of the `point` (3,) [m, user frame] that moves with the
    port's interface, or with its body."""
    if port.body.index < 0:
        zero = np.zeros((count, 3))
        return zero + point, zero, zero
    body = bodies[port.body.name]
    y, y_rate, y_rate2 = np.tile(point, (count, 1)), np.zeros((count, 3)), np.zeros((count, 3))
    if port.interface_name is not None and body.modal.shape[1]:
        arm = point - port.body.reduced.interfaces[port.interface_name].point
        for target, motion in zip((y, y_rate, y_rate2), interface_motion(port, body), strict=True):
            target += motion[:, :3] + cross(motion[:, 3:], arm)
    p, omega, alpha = body.rotation, body.angular_velocity, body.angular_acceleration
    arm, swing = turned(p, y), turned(p, y_rate)
    velocity = body.velocity + cross(omega, arm) + swing
    acceleration = body.acceleration + cross(alpha, arm) + cross(omega, cross(omega, arm) + 2.0 * swing)
    return body.position + arm, velocity, acceleration + turned(p, y_rate2)
