r"""Pressures on two grids as means over common boxes of a chart.

A contact has one pressure for each of its boxes: the mean over a cell that travels with the patch, or over the cell
around a node. Within a box it says nothing of how the pressure runs, and how the grid of one cuts the patch is no error
of another's. So both are compared as means over the boxes of the coarser grid, across and along for itself, continued
to wherever either has boxes:

    P_B = sum_j |B and box j| p_j / |B|,        |P|^2 = sum_B A_B P_B^2
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

Array = np.ndarray


@dataclass(frozen=True, eq=False)
class Boxes:
    """Pressures p (columns, rows) [Pa] of boxes between lines x (columns + 1,) and z (rows + 1,) [m], ascending."""

    x: Array
    z: Array
    p: Array

    def means(self, x: Array, z: Array) -> Array:
        """(n, m) Pa, means over the boxes between lines x (n + 1,) and z (m + 1,); beyond the own ones p is zero."""
        return _shares(x, self.x) @ self.p @ _shares(z, self.z).T


def squares(one: Boxes, reference: Boxes, scale: Callable[[Array], Array] = np.ones_like) -> tuple[float, float]:
    """int (p - p_ref)^2 dA and int p_ref^2 dA [Pa2 m2], of means over common boxes; scale: dA/(dx dz) at heights z
    (m,), which lie within those of the two."""
    x, z = _common(one.x, reference.x), _common(one.z, reference.z)
    ends = min(one.z[0], reference.z[0]), max(one.z[-1], reference.z[-1])
    middle = np.clip(0.5 * (z[:-1] + z[1:]), *ends)
    area = np.diff(x)[:, None] * (np.broadcast_to(scale(middle), middle.shape) * np.diff(z))
    p, p_ref = one.means(x, z), reference.means(x, z)
    return float((area * (p - p_ref) ** 2).sum()), float((area * p_ref**2).sum())


def _shares(lines: Array, of: Array) -> Array:
    """(n, m), how much of each interval between `lines` (n + 1,) lies in each of those between `of` (m + 1,)."""
    low = np.maximum(lines[:-1, None], of[None, :-1])
    high = np.minimum(lines[1:, None], of[None, 1:])
    return np.maximum(high - low, 0.0) / np.diff(lines)[:, None]


def _common(one: Array, other: Array) -> Array:
    """Lines of the coarser of two grids, continued by its outermost widths until they span both."""
    wide = max((one, other), key=lambda lines: float(np.diff(lines).mean()))
    low, high = min(one[0], other[0]), max(one[-1], other[-1])
    first, last = wide[1] - wide[0], wide[-1] - wide[-2]
    before = int(np.ceil((wide[0] - low) / first))
    behind = int(np.ceil((high - wide[-1]) / last))
    return np.concatenate([
        wide[0] - first * np.arange(before, 0, -1), wide, wide[-1] + last * np.arange(1, behind + 1)
    ])  # fmt: skip
