r"""How faces have slid and turned on each other as wholes: the rigid motion that slips of cells are nearest to.

With the slips w_c (2,) along t_1, t_2 of cells at x_c, areas A_c and their middle x, the translation d and the turn
theta are those of

    min  sum_c A_c | w_c - T_c (d + theta x (x_c - x)) |^2,        T_c = rows t_1, t_2,

of all that do as well the smallest, with theta measured by the radius of gyration of the cells: what slides no face,
such as a translation along the normal of a plane, is zero.

Without friction the engine follows no slips. Places x_c of the first body and y_c of the second, the same at the
initial pose, are then apart by

    A_1^T (r_2 + A_2 y_c - r_1) - x_c

in the axes of the first body, with r and A positions and rotations of the user frames: the elastic part is left out.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from warpffrf.online.history.history import BodyHistory
from warpffrf.output.geometry.grid_places import rotate
from warpffrf.output.geometry.scene_view import LapView

INVERSE = np.array([-1.0, -1.0, -1.0, 1.0])  # times a unit quaternion
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


def of_user_frames(view: LapView, bodies: Mapping[str, BodyHistory]) -> np.ndarray:
    """(T, c, 2) m along t_1 and t_2, by how much the user frame of the second body has moved against that of the first
    at the cells; zero within one body."""
    first, second = bodies[view.first_body.name], bodies.get(view.second_body.name)
    found = np.empty((len(first.position), len(view.area), 2))
    for i, (position, rotation) in enumerate(zip(first.position, first.rotation, strict=True)):
        placed = view.partners if second is None else second.position[i] + rotate(second.rotation[i], view.partners)
        apart = rotate(rotation * INVERSE, placed - position) - view.points
        found[i] = np.einsum("ckd,cd->ck", view.frames[:, 1:], apart)
    return found
