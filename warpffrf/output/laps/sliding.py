r"""How faces have slid and turned on each other as wholes: the rigid motion that slips of cells are nearest to.

With the slips w_c (2,) along t_1, t_2 of cells at x_c, areas A_c and their middle x, the translation d and the turn
theta are those of

    min  sum_c A_c | w_c - T_c (d + theta x (x_c - x)) |^2,        T_c = rows t_1, t_2,

of all that do as well the smallest, with theta measured by the radius of gyration of the cells: what slides no face,
such as a translation along the normal of a plane, is zero.
"""

from __future__ import annotations

import numpy as np

RANK = 1e-6  # of the largest singular value: rigid motions that slide the cells by less are none


def rigid_sliding(
    points: np.ndarray, frames: np.ndarray, area: np.ndarray, slip: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Translation (T, 3) [m] at the middle of the cells and turn (T, 3) [rad] of the second face against the first, in
    the axes of `points` (c, 3) and `frames` (c, 3, 3); slip (T, c, 2) [m]."""
    middle = area @ points / area.sum()
    arm = points - middle
    gyration = float(np.sqrt(area @ np.sum(arm**2, axis=1) / area.sum())) or 1.0
    along = frames[:, 1:]
    turning = np.cross(arm[:, None], along) / gyration
    weight = np.sqrt(area)[:, None]
    A = (np.concatenate([along, turning], axis=2) * weight[:, :, None]).reshape(-1, 6)
    found = (slip * weight).reshape(len(slip), -1) @ np.linalg.pinv(A, rcond=RANK).T
    return found[:, :3], found[:, 3:] / gyration
