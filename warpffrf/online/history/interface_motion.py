r"""How the modes move an interface, from the recorded motion of its body.

Components d_c of the translation and rotation (u, theta) in body axes follow from the mode shapes Phi_c and, of a body
that loads stiffen, the geometric stiffness K_c of a unit load (`warpffrf.model.inertia.GeometricStiffness`),

    d_c = Phi_c.q - q.K_c q/2,   d_c' = Phi_c.qd - q.K_c qd,   d_c'' = Phi_c.qdd - q.K_c qdd - qd.K_c qd,

as the constraint rows see it (`warpffrf_kernels.bodies.interfaces`).
"""

from __future__ import annotations

import numpy as np

from warpffrf.model.bodies import Port
from warpffrf.online.history.history import BodyHistory


def interface_motion(port: Port, body: BodyHistory) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Motion (T, 6) [m, rad] of the interface of `port`, its rate [1/s] and the rate of that [1/s^2], body axes."""
    reduced = port.body.reduced
    modes = reduced.interfaces[port.interface_name].modes
    q, qd, qdd = body.modal, body.modal_velocity, body.modal_acceleration
    motion, rate, rate2 = (x @ modes for x in (q, qd, qdd))
    if port.body.stiffening:
        stiffening = reduced.inertia_terms.stiffening
        K, k = stiffening.interfaces[port.interface_name], stiffening.modes
        q, qd, qdd = (x[:, :k] for x in (q, qd, qdd))
        motion -= 0.5 * _both(q, K, q)
        rate -= _both(q, K, qd)
        rate2 -= _both(q, K, qdd) + _both(qd, K, qd)
    return motion, rate, rate2


def _both(x: np.ndarray, K: np.ndarray, y: np.ndarray) -> np.ndarray:
    """x.K_c y (T, 6) of (T, k), (6, k, k), (T, k)."""
    return np.einsum("ti,cij,tj->tc", x, K, y, optimize=True)
