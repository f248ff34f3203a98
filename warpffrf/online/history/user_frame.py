"""Motion of the centre of mass -> motion of the user frame.

With c the centre of mass in the user frame, A the orientation and s = A c: the user origin is r - s, its velocity
v - w x s, its acceleration vdot - wdot x s - w x (w x s).
"""

from __future__ import annotations

import numpy as np

from warpffrf.online.history.history import BodyHistory
from warpffrf.online.history.interface_motion import turned


def user_frame(
    center: np.ndarray,
    r: np.ndarray,
    p: np.ndarray,
    v: np.ndarray,
    w: np.ndarray,
    vdot: np.ndarray,
    wdot: np.ndarray,
    q: np.ndarray,
    qd: np.ndarray,
    qdd: np.ndarray,
) -> BodyHistory:
    """Motion (T, ...) of the centre of mass, angular velocity and acceleration in body axes, as that of the user frame,
    in whose coordinates the centre of mass is at `center` (3,) [m]."""
    arm, omega, alpha = turned(p, center), turned(p, w), turned(p, wdot)
    swing = np.cross(omega, arm)
    return BodyHistory(
        r - arm, p.copy(), v - swing, omega, q.copy(),
        vdot - np.cross(alpha, arm) - np.cross(omega, swing), alpha, qd.copy(), qdd.copy(),
    )  # fmt: skip
