"""Valid but implausible input: reported immediately as warnings of the package's logger.

A mistake in units or conventions gives numbers that are valid but implausible for any machine: gravity of 9810 (mm/s^2)
or upwards, a friction of 30 (per cent), an angle of 90 (degrees), a quaternion whose real part comes first. Each
function returns the doubts as texts that name the item and its probable meaning; `warn` logs them. Meshes and materials
have theirs in `mesh.report`.
"""

from __future__ import annotations

import logging
from collections.abc import Iterable, Sequence

import numpy as np

GRAVITIES = (0.1, 30.0)  # m/s2: small moons 0.1, Moon 1.6, Earth 9.8, Jupiter 25
UPRIGHT = 1e-3  # of gravity: fraction across z up to which it counts as vertical
MOST_FRICTION = 2.0  # rubber on dry asphalt 1.2, clean metals in vacuum beyond, no machine
FULL_TURN = 2.0 * np.pi  # rad: a pose never needs a larger angle; degrees are larger

log = logging.getLogger("warpffrf")


def warn(doubts: Iterable[str]) -> None:
    """Log `doubts` at level WARNING."""
    for doubt in doubts:
        log.warning("%s", doubt)


def gravity_doubts(gravity: Sequence[float] | np.ndarray) -> list[str]:
    """Doubts about gravity (3,) [m/s2]: its size, and upwards."""
    g = np.asarray(gravity, dtype=float)
    size = float(np.linalg.norm(g))
    if size == 0.0:
        return []
    found = []
    if not GRAVITIES[0] <= size <= GRAVITIES[1]:
        found.append(
            f"scene: gravity is {size:.4g} m/s2, that of the Earth is 9.81; all is in SI units, lengths in m, not mm"
        )
    if g[2] > 0.0 and float(np.hypot(g[0], g[1])) <= UPRIGHT * size:
        found.append(
            f"scene: gravity points upwards, along +z; bodies fall along it: (0, 0, -{g[2]:.4g}) pulls downwards"
        )
    return found


def friction_doubts(coefficient: float, label: str) -> list[str]:
    """A doubt about the largest coefficient [-] of a friction law."""
    if coefficient <= MOST_FRICTION:
        return []
    return [
        f"{label}: a coefficient of friction of {coefficient:.4g} is beyond {MOST_FRICTION:g}, dry steel has 0.1 to "
        f"0.8; for per cent give {coefficient / 100.0:.4g}"
    ]


def angle_doubts(angles: Sequence[float] | np.ndarray, name: str) -> list[str]:
    """A doubt about angles [rad] of a pose."""
    largest = float(np.abs(np.asarray(angles)).max())
    if largest <= FULL_TURN:
        return []
    return [
        f"{name}: an angle of {largest:.4g} rad is more than a full revolution; for degrees give "
        f"np.radians({largest:g})"
    ]


def quaternion_doubts(q: np.ndarray, name: str) -> list[str]:
    """A doubt about (1, 0, 0, 0), which is the identity where the real part comes first."""
    if not np.array_equal(q, (1.0, 0.0, 0.0, 0.0)):
        return []
    return [
        f"{name}: (1, 0, 0, 0) is a rotation by 180 degrees about x: quaternions are (x, y, z, w), no rotation is "
        f'(0, 0, 0, 1); if half a turn is meant, {{"axis": (1, 0, 0), "angle": np.pi}} says so'
    ]
