r"""Pressure of two runs on common points of the first surface's chart, whatever grids they stand on.

A field is piecewise bilinear through the values of its columns and rows: of hats means at their nodes (`ContactResult.
mean_pressure`), of cells that travel with the patch samples at their middles, out to the edges of the outermost cells.
Beyond it is zero. The points are the middles of POINTS equal strips by equal rows of the rectangle that holds what
presses in either run, and

    |p|^2 = int p^2 dA = sum p^2 R sqrt(1 + R'^2) dtheta dz.

Angles on a surface of revolution are counted from the line of centres: which of the material is in contact is said by
the motion, and measured by it. On a plane they are the chart's own.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from warpffrf.output.contact.pair_result import PairResult

POINTS = (160, 48)  # across, along: a dozen in each column of a dozen, where the field is linear


@dataclass(frozen=True, eq=False)
class Field:
    """Pressures p (columns, rows) [Pa] at x (columns,) [m of arc] and z (rows,) [m]; they reach to the ends."""

    x: np.ndarray
    z: np.ndarray
    p: np.ndarray
    x_ends: tuple[float, float]
    z_ends: tuple[float, float]

    def at(self, x: np.ndarray, z: np.ndarray) -> np.ndarray:
        """(n, m) Pa at all x (n,) and z (m,), each ascending."""
        return _weights(self.x, self.x_ends, x) @ self.p @ _weights(self.z, self.z_ends, z).T

    def pressed(self) -> tuple[float, float, float, float] | None:
        """The rectangle (x low, x high, z low, z high) of what presses, to a column and a row; None for nothing."""
        on = self.p > 0.0
        if not on.any():
            return None
        found = []
        for along, ends, any_in in ((self.x, self.x_ends, on.any(axis=1)), (self.z, self.z_ends, on.any(axis=0))):
            n = np.flatnonzero(any_in)
            found += [along[n[0] - 1] if n[0] > 0 else ends[0], along[n[-1] + 1] if n[-1] + 1 < len(along) else ends[1]]
        return found[0], found[1], found[2], found[3]


def _weights(nodes: np.ndarray, ends: tuple[float, float], at: np.ndarray) -> np.ndarray:
    """(n, nodes) of linear interpolation, constant from the outermost nodes to `ends`, zero beyond."""
    out = np.zeros((len(at), len(nodes)))
    inside = np.flatnonzero((at >= ends[0]) & (at <= ends[1]))
    if len(nodes) == 1:
        out[inside, 0] = 1.0
        return out
    k = np.clip(np.searchsorted(nodes, at[inside], side="right") - 1, 0, len(nodes) - 2)
    w = np.clip((at[inside] - nodes[k]) / (nodes[k + 1] - nodes[k]), 0.0, 1.0)
    out[inside, k] = 1.0 - w
    out[inside, k + 1] += w
    return out


def field_of(pair: PairResult, i: int) -> Field:
    """The field of `pair` at its saved step `i`."""
    shape, z = pair.view.first.shape, pair.rows[i]
    x = np.asarray(pair.theta[i] if shape.kind == "plane" else pair.arc[i])
    if pair.loaded == "cells":
        x_lines, z_lines = pair.cell_lines(i)
        reach = 0.5 * (x_lines[-1] - x_lines[0])
        middle = 0.5 * (x[0] + x[-1])
        x_ends, z_ends = (middle - reach, middle + reach), (float(z_lines[0]), float(z_lines[-1]))
    else:
        pitch = float(np.asarray(pair.spacing))
        x_ends, z_ends = (x[0] - pitch, x[-1] + pitch), (float(z[0]), float(z[-1]))
        # a hat at the edge of the window falls to zero at the next node
        x, z = np.concatenate([x[:1] - pitch, x, x[-1:] + pitch]), z
    p = pair.history.pressure[i] if pair.view.at_nodes else pair.mean_pressure[i]
    p = np.asarray(p, dtype=float)
    return Field(x, z, np.pad(p, np.array([[1, 1], [0, 0]])) if len(x) > len(p) else p, x_ends, z_ends)


def squares(field: Field, reference: Field, shape: object) -> tuple[float, float]:
    """int (p - p_ref)^2 dA and int p_ref^2 dA [Pa2 m2], the latter on the same points."""
    boxes = [box for box in (field.pressed(), reference.pressed()) if box is not None]
    if not boxes:
        return 0.0, 0.0
    low_x, low_z = min(b[0] for b in boxes), min(b[2] for b in boxes)
    high_x, high_z = max(b[1] for b in boxes), max(b[3] for b in boxes)
    dx, dz = (high_x - low_x) / POINTS[0], (high_z - low_z) / POINTS[1]
    x = low_x + dx * (np.arange(POINTS[0]) + 0.5)
    z = low_z + dz * (np.arange(POINTS[1]) + 0.5)
    middle = 0.5 * (low_z + high_z)
    measure_at, radius_at = shape.measure_at, shape.radius_at  # type: ignore[attr-defined]
    weight = np.broadcast_to(measure_at(z) / radius_at(middle), z.shape) * dx * dz
    p, p_ref = field.at(x, z), reference.at(x, z)
    return float((((p - p_ref) ** 2) @ weight).sum()), float(((p_ref**2) @ weight).sum())
