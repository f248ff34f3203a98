r"""Pressure of two runs as means over common boxes of the first surface's chart, whatever grids they stand on.

A contact has one pressure for each of its boxes: the mean over a cell that travels with the patch, or over the cell
around a node (`ContactResult.mean_pressure`, `cell_lines`). Within a box it says nothing of how the pressure runs, and
how the grid of one run cuts the patch is no error of another's. So both are compared as means over the boxes of the
coarser grid, across and along for itself, continued to wherever either presses:

    P_B = sum_j |B and box j| p_j / |B|,        |P|^2 = sum_B A_B P_B^2,   A_B = R sqrt(1 + R'^2) dtheta dz

Angles on a surface of revolution are counted from the line of centres: which of the material is in contact is said by
the motion, and measured by it. On a plane they are the chart's own.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from warpffrf.output.contact.pair_result import PairResult


@dataclass(frozen=True, eq=False)
class Field:
    """Pressures p (columns, rows) [Pa] of boxes between lines x (columns + 1,) and z (rows + 1,) [m], ascending."""

    x: np.ndarray
    z: np.ndarray
    p: np.ndarray

    def means(self, x: np.ndarray, z: np.ndarray) -> np.ndarray:
        """(n, m) Pa, means over the boxes between lines x (n + 1,) and z (m + 1,); beyond the own ones p is zero."""
        return _shares(x, self.x) @ self.p @ _shares(z, self.z).T


def _shares(lines: np.ndarray, of: np.ndarray) -> np.ndarray:
    """(n, m), how much of each interval between `lines` (n + 1,) lies in each of those between `of` (m + 1,)."""
    low = np.maximum(lines[:-1, None], of[None, :-1])
    high = np.minimum(lines[1:, None], of[None, 1:])
    return np.maximum(high - low, 0.0) / np.diff(lines)[:, None]


def _common(one: np.ndarray, other: np.ndarray) -> np.ndarray:
    """Lines of the coarser of two grids, continued by its outermost widths until they span both."""
    wide = max((one, other), key=lambda lines: float(np.diff(lines).mean()))
    low, high = min(one[0], other[0]), max(one[-1], other[-1])
    first, last = wide[1] - wide[0], wide[-1] - wide[-2]
    before = int(np.ceil((wide[0] - low) / first))
    behind = int(np.ceil((high - wide[-1]) / last))
    return np.concatenate([
        wide[0] - first * np.arange(before, 0, -1), wide, wide[-1] + last * np.arange(1, behind + 1)
    ])  # fmt: skip


def field_of(pair: PairResult, i: int) -> Field:
    """The field of `pair` at its saved step `i`."""
    x, z = pair.cell_lines(i)
    if pair.view.first.shape.kind == "plane":
        x = x + float(pair.theta[i][0] - pair.arc[i][0])
    p = pair.history.pressure[i] if pair.view.at_nodes else pair.mean_pressure[i]
    return Field(np.asarray(x, dtype=float), np.asarray(z, dtype=float), np.asarray(p, dtype=float))


def squares(field: Field, reference: Field, shape: object) -> tuple[float, float]:
    """int (p - p_ref)^2 dA and int p_ref^2 dA [Pa2 m2], of means over the common boxes."""
    x, z = _common(field.x, reference.x), _common(field.z, reference.z)
    ends = (min(field.z[0], reference.z[0]), max(field.z[-1], reference.z[-1]))  # the profile has no more
    middle = np.clip(0.5 * (z[:-1] + z[1:]), *ends)
    measure_at, radius_at = shape.measure_at, shape.radius_at  # type: ignore[attr-defined]
    scale = np.broadcast_to(measure_at(middle) / radius_at(0.5 * (z[0] + z[-1])), middle.shape)
    area = np.diff(x)[:, None] * (scale * np.diff(z))
    p, p_ref = field.means(x, z), reference.means(x, z)
    return float((area * (p - p_ref) ** 2).sum()), float((area * p_ref**2).sum())
