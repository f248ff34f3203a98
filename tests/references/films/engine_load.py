"""A smooth, artificial load on a crank-pin bearing over the two revolutions of a four-stroke engine."""

from __future__ import annotations

import numpy as np

Array = np.ndarray
GAS, FIRING, WIDTH = 22e3, 0.2, 0.35  # N, rad after the dead centre, rad
PISTON, SECOND, CRANK = 6e3, 1.5e3, 4e3  # N, of reciprocating masses and of rotating ones


def crank_load(angle: float) -> Array:
    """(2,) [N] in the frame of the rod at the crank `angle` [rad], of period 4 pi, fired at 2 pi."""
    from_firing = np.mod(angle, 4.0 * np.pi) - 2.0 * np.pi - FIRING
    gas = GAS * np.exp(-((from_firing / WIDTH) ** 2))
    along = gas - PISTON * np.cos(angle) - SECOND * np.cos(2.0 * angle)
    return np.array([along, CRANK * np.sin(angle)])
