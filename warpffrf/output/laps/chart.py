r"""The cells of a lap laid flat: seen along their mean normal, or unrolled around the axis that normals turn about.

With the normals n_c and areas A_c, |sum A n| / sum A is 1 of a plane and 0 of a full turn. Above `FLAT` the cells are
projected on the plane across the mean normal. Otherwise the axis a is the direction that the normals have least of, the
eigenvector of sum A n n^T to the smallest eigenvalue; it goes through the place whose distance from the lines through
the cells along their normals is least, and places have the arc r phi and the height along a, with r the mean radius.
Triangles are cut nowhere: each is drawn on the side of the seam on which its middle is.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from warpffrf.output.geometry.scene_view import LapView

FLAT = 0.8  # of the sum of areas: a cap of 120 degrees around is still seen from above


@dataclass(frozen=True, eq=False)
class LapChart:
    """Triangles (t, 3, 2) [m] of the cells laid flat, the cell (t,) of each, the middles (c, 2) [m] of the cells, and
    what the two axes of the map are. `radius` [m] of one that was unrolled, else None."""

    triangles: np.ndarray
    cell: np.ndarray
    points: np.ndarray
    labels: tuple[str, str]
    radius: float | None


def lap_chart(view: LapView) -> LapChart:
    """The chart of a lap's cells, in the axes of the first body."""
    normals, area = view.frames[:, 0], view.area
    corners, cell = view.triangles
    mean = area @ normals / area.sum()
    if np.linalg.norm(mean) > FLAT:
        axes, names = _plane(mean / np.linalg.norm(mean))
        return LapChart(corners @ axes.T, cell, view.points @ axes.T, names, None)
    axis = np.linalg.eigh(np.einsum("c,ci,cj->ij", area, normals, normals))[1][:, 0]
    axis = axis * (1.0 if axis[np.argmax(np.abs(axis))] > 0.0 else -1.0)
    e0, e1 = _plane(axis)[0]
    middle = _nearest_to_lines(view.points, normals, np.stack([e0, e1]))
    off = view.points - middle
    radius = float(area @ np.hypot(off @ e0, off @ e1) / area.sum())

    def around(x: np.ndarray) -> np.ndarray:
        return np.arctan2((x - middle) @ e1, (x - middle) @ e0)

    base = around(corners.mean(axis=1))
    turn = around(corners) - base[:, None]
    angle = base[:, None] + (turn + np.pi) % (2.0 * np.pi) - np.pi
    flat = np.stack([radius * angle, corners @ axis], axis=-1)
    points = np.stack([radius * around(view.points), view.points @ axis], axis=-1)
    return LapChart(flat, cell, points, ("arc", f"along ({', '.join(f'{v:.3g}' for v in axis + 0.0)})"), radius)


def _plane(normal: np.ndarray) -> tuple[np.ndarray, tuple[str, str]]:
    """Two axes (2, 3) across `normal`, right-handed with it, near axes of the body, and their names."""
    order = np.argsort(np.abs(normal))[:2]
    first = np.eye(3)[np.min(order)]
    a = first - (first @ normal) * normal
    a /= np.linalg.norm(a)
    axes = np.stack([a, np.cross(normal, a)])
    names = []
    for axis in axes:
        n = int(np.argmax(np.abs(axis)))
        straight = abs(axis[n]) > 1.0 - 1e-6
        sign = "-" if axis[n] < 0.0 else ""
        names.append(f"along {sign}{'xyz'[n]}" if straight else f"along ({', '.join(f'{v:.3g}' for v in axis + 0.0)})")
    return axes, (names[0], names[1])


def _nearest_to_lines(points: np.ndarray, normals: np.ndarray, across: np.ndarray) -> np.ndarray:
    """The place (3,) in the plane of `across` (2, 3) that is nearest to the lines along `normals`."""
    n = normals @ across.T
    n = n / np.maximum(np.linalg.norm(n, axis=1, keepdims=True), 1e-300)
    side = np.stack([-n[:, 1], n[:, 0]], axis=1)
    flat = points @ across.T
    return np.linalg.lstsq(side, np.einsum("ci,ci->c", side, flat), rcond=None)[0] @ across
