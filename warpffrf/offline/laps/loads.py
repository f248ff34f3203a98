r"""Frames of cells, and the loads of unit forces along them.

The first tangent of all cells is the part across n of one axis of the user frame, that which is furthest from all
normals of the lap: one direction on a plane, along the axis on a cylinder. Where a normal comes near to it, as on a
sphere, the axis furthest from that normal takes its place.

A force of 1 N along d, mean traction times area, loads a face by `d` times the weights of its mean displacement
(`cells`), so that `B^T u` is that displacement; a pair carries the opposite load on its first face.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import scipy.sparse as sp

from warpffrf.offline.laps.cells import Cells

Array = np.ndarray
NEAR = 0.9  # |cosine| between a normal and the common axis from which the cell takes another


def frames(normals: Array) -> Array:
    """Frames (c, 3, 3), rows n, t_1, t_2, right-handed, of unit normals (c, 3); see the module docstring."""
    leaning = np.abs(normals)
    common = int(np.argmin(np.round(leaning.max(axis=0), 9)))
    axis = np.where(leaning[:, common] < NEAR, common, np.argmin(np.round(leaning, 9), axis=1))
    e = np.eye(3)[axis]
    first = e - np.einsum("ci,ci->c", e, normals)[:, None] * normals
    first /= np.linalg.norm(first, axis=1, keepdims=True)
    return np.stack([normals, first, np.cross(normals, first)], axis=1)


def unit_loads(cells: Cells, axes: Array) -> Any:
    """B (3 n, 3 c) csc: nodal loads of a unit force of each cell along each row of its frame `axes` (c, 3, 3); of a
    pair on the second face, and the opposite on the first."""
    weights = cells.first if cells.second is None else cells.second - cells.first
    W = sp.coo_matrix(weights)
    entries = W.data[:, None, None] * axes[W.row]  # (e, 3 rows of the frame, 3 user axes)
    rows = np.broadcast_to(3 * W.col[:, None, None] + np.arange(3), entries.shape)
    columns = np.broadcast_to(3 * W.row[:, None, None] + np.arange(3)[:, None], entries.shape)
    shape = (3 * weights.shape[1], 3 * weights.shape[0])
    return sp.csc_matrix((entries.ravel(), (rows.ravel(), columns.ravel())), shape=shape)
