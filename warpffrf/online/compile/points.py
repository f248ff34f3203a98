"""Points at which the gaps of a pair are taken, the same in every column of the first grid, -> device tables."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from warpffrf.model.errors import InputError
from warpffrf.model.reduced.contact_surface import ContactSurface
from warpffrf.online.compile.collector import Collector
from warpffrf_kernels.core.model import Model


@dataclass(frozen=True, eq=False)
class PointRule:
    """Points of the strip between two columns of a contact grid.

    x (n,) fraction of the way to the next column, in [0, 1); row (n,) row of cells, ascending; zeta (n,) fraction of
    the way to the next row; weight (n,) m2, with the measure R sqrt(1 + R'^2), so that the weights of a rule that
    integrates constants sum to the area of the strip.
    """

    x: np.ndarray
    row: np.ndarray
    zeta: np.ndarray
    weight: np.ndarray

    def __post_init__(self) -> None:
        if np.any(np.diff(self.row) < 0):
            raise InputError("sampling points of a contact: rows must ascend; sort the points by row")

    def stations(self, z_points: int) -> np.ndarray:
        """Nearest axial points (n,) of the line of centres, `z_points` Gauss points between two rows."""
        places = 0.5 * (np.polynomial.legendre.leggauss(z_points)[0] + 1.0)
        return self.row * z_points + np.abs(self.zeta[:, None] - places).argmin(axis=1)


def gauss_rule(surface: ContactSurface, theta_points: int, z_points: int) -> PointRule:
    """Gauss points in every cell of a column of the surface's grid."""
    grid, shape = surface.grid, surface.shape
    x, along = (np.polynomial.legendre.leggauss(count) for count in (theta_points, z_points))
    z = np.asarray(grid.z)
    cells = np.arange(grid.rows - 1)
    grown = np.meshgrid(cells, 0.5 * (along[0] + 1.0), 0.5 * (x[0] + 1.0), indexing="ij")
    row, zeta, place = grown[0].ravel().astype(int), grown[1].ravel(), grown[2].ravel()
    weight = np.einsum("k,q,p->kqp", np.diff(z), 0.5 * along[1], 0.5 * x[1] * grid.pitch).ravel()
    at = z[row] + zeta * np.diff(z)[row]
    weight = weight * shape.measure_at(at)
    return PointRule(place, row, zeta, weight)


def fill_points(collector: Collector, m: Model, surfaces: list[ContactSurface], rules: list[PointRule | None]) -> None:
    """Tables of the points of each pair's first surface; None for a pair whose gaps are not evaluated at points."""
    counts, row_starts = [], []
    columns: dict[str, list[np.ndarray]] = {
        name: [np.zeros(0)]
        for name in ("x", "row", "zeta", "weight", "cosine", "sine", "z", "radius", "row_at", "station")
    }
    for surface, rule in zip(surfaces, rules, strict=True):
        row_starts.append(sum(map(len, columns["row_at"])))
        counts.append(0 if rule is None else len(rule.x))
        if rule is None:
            continue
        grid, shape = surface.grid, surface.shape
        z = np.asarray(grid.z)
        at = z[rule.row] + rule.zeta * np.diff(z)[rule.row]
        angle = rule.x * grid.pitch
        planar = shape.profile().planar
        values = {
            "x": rule.x, "row": rule.row, "zeta": rule.zeta, "weight": rule.weight, "z": at,
            "cosine": np.ones(len(at)) if planar else np.cos(angle), "sine": angle if planar else np.sin(angle),
            "radius": shape.radius_at(at),
            "row_at": np.searchsorted(rule.row, np.arange(grid.rows)),
            "station": rule.stations(m.quadrature.z_points),
        }  # fmt: skip
        for name, value in values.items():
            columns[name].append(np.asarray(value))
    collector.fill(
        m.points, most=max(counts, default=0), start=np.cumsum([0, *counts])[:-1], count=counts, row_start=row_starts,
        **{name: np.concatenate(parts) for name, parts in columns.items()},
    )  # fmt: skip
