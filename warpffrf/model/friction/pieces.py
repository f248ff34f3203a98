r"""A coefficient of friction as cubic pieces over the slip speed, which is what the device reads of any law.

Between neighbouring `breaks` of a law intervals are halved until Hermite's cubic, through values and slopes at both
ends, is within TOLERANCE of the law at three points between. Of a table every piece is its own straight line.
"""

from __future__ import annotations

import numpy as np

from warpffrf.model.errors import InputError
from warpffrf.model.friction.law import FrictionLaw

TOLERANCE = 1e-9  # of the coefficient: far below what any is known to
MOST_PIECES = 4096  # of a law
SHORTEST = 1e-12  # of its speeds: no piece is shorter
BETWEEN = np.array([0.25, 0.5, 0.75])  # where a piece is compared with the law


def cubic_pieces(law: FrictionLaw, label: str) -> np.ndarray:
    """Speeds v_i [m/s] at which pieces begin, and their coefficients by (v - v_i)^0 to ^3 (n, 5); the last one is
    constant. Raises `InputError` naming `label` where the coefficient is negative, no number, or not smooth."""
    found: list[np.ndarray] = []
    room = TOLERANCE * law.largest_coefficient
    least, most = law.least_coefficient - room, law.largest_coefficient + room
    ends = list(zip(law.breaks[:-1], law.breaks[1:], strict=True))[::-1]
    while ends:
        low, high = ends.pop()
        piece = _hermite(law, low, high)
        at = BETWEEN * (high - low)
        values = law.coefficient_at(low + at)
        if not np.all(np.isfinite(piece)) or not np.all(values >= 0.0):
            raise InputError(f"{label}: {law.kind} has a coefficient of friction that is negative or no number")
        if np.any(values > most) or np.any(values < least):
            raise InputError(
                f"{label}: the coefficient of {law.kind} rises and falls between {low:g} and {high:g} m/s; name the "
                "speed of its extreme in `breaks`"
            )
        if np.abs(_value(piece, at) - values).max() <= room:
            found.append(np.concatenate([[low], piece]))
            continue
        if len(found) + len(ends) > MOST_PIECES or high - low < SHORTEST * law.breaks[-1]:
            raise InputError(
                f"{label}: the coefficient of {law.kind} jumps near {low:g} m/s, or its slope_at is not that of its "
                "coefficient_at"
            )
        middle = 0.5 * (low + high)
        ends += [(middle, high), (low, middle)]
    last = law.breaks[-1]
    return np.array([*found, [last, float(law.coefficient_at(last)), 0.0, 0.0, 0.0]])


def _hermite(law: FrictionLaw, low: float, high: float) -> np.ndarray:
    """Coefficients (4,) of the cubic on an interval."""
    h = high - low
    m_0, m_1 = (float(law.coefficient_at(v)) for v in (low, high))
    s_0, s_1 = (float(law.slope_at(v)) for v in (low, np.nextafter(high, low)))  # of a kink the side of the interval
    rise = (m_1 - m_0) / h
    return np.array([m_0, s_0, (3.0 * rise - 2.0 * s_0 - s_1) / h, (s_0 + s_1 - 2.0 * rise) / h**2])


def _value(piece: np.ndarray, x: np.ndarray) -> np.ndarray:
    return piece[0] + x * (piece[1] + x * (piece[2] + x * piece[3]))
