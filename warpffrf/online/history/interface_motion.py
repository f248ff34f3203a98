r"""How an interface moved in a run, from the recorded motion of its body.

With d = Phi^T q - q.K q/2 of `warpffrf.model.reduced.interface_motion` the rates are

    d' = Phi^T qd - q.K qd,      d'' = Phi^T qdd - q.K qdd - qd.K qd.
"""

from __future__ import annotations

import numpy as np

from warpffrf.model.bodies import Port
from warpffrf.model.reduced import interface_motion as at_rest
from warpffrf.online.history.history import BodyHistory


def interface_motion(port: Port, body: BodyHistory) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Motion (T, 6) [m, rad] of the interface of `port`, its rate [1/s] and the rate of that [1/s^2], body axes."""
    name = str(port.interface_name)
    modes = port.body.reduced.interfaces[name].modes
    q, qd, qdd = body.modal, body.modal_velocity, body.modal_acceleration

    def bent(x: np.ndarray, y: np.ndarray) -> np.ndarray:
        return at_rest.second_order(port.body, name, x, y)

    motion = at_rest.interface_motion(port.body, name, q)
    return motion, qd @ modes - bent(q, qd), qdd @ modes - bent(q, qdd) - bent(qd, qd)
