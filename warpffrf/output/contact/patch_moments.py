r"""Areas and moments of the pressure over the whole patch, and the half-widths that follow from them.

The pressure is `p(theta, z) = sum_jk p_jk psi_j(theta) zeta_k(z)` with bilinear shape functions on the first body's
contact grid, the area element `dA = R sqrt(1 + R'^2) dtheta dz`. With `I^n_k = int zeta_k z^n R sqrt(1 + R'^2) dz` and
the angular spacing h of the nodes

    P = h sum_jk p_jk I^0_k,       P theta_c = h sum_jk p_jk theta_j I^0_k,       P z_c = h sum_jk p_jk I^1_k,
    P m_theta = h sum_jk p_jk ((theta_j - theta_c)^2 + h^2/6) I^0_k,              P m_z = h sum_jk p_jk I^2_k - P z_c^2,

since the second moment of a shape function about its node is h^3/6. For pressures on moving cells zeta_k is 1 on the
row k, h is the angle of a strip, and the pressure at its centre is a sample of a smooth function: the term h^2/6 is
omitted (`cell_result`). Lengths along the surface at the centre of pressure are `R(z_c) theta` and `sqrt(1 + R'(z_c)^2)
z`; the covariance in metres is that of the angles times these factors.

The relation of second moment and half-width depends on the pressure distribution. In one direction, with half-width a:

    p0 sqrt(1 - x^2/a^2)                 line contact, across            m = a^2/4
    p0 sqrt(1 - x^2/a^2 - y^2/b^2)       point contact, either axis      m = a^2/5
    constant                             line contact, along; flat faces m = a^2/3

Areas are counted in cells, the part of the surface nearer to a node than to any other, with the resolution of the grid.

Pressure wrench. Integrals of axial shape functions over a surface of revolution, and the forces of tractions on its
cells.

Tractions are constant on a cell of area A, and their forces act at its node, or at the centre of a moving cell.
"""

from __future__ import annotations

from functools import cached_property
from typing import Any

import numpy as np

from warpffrf.model.reduced.contact_grid import GAUSS_PER_ROW, meridian_gram
from warpffrf.output.geometry.places import CellPlaces, grid_theta_offset, tangents

# square of the half-width over the second moment, (across, along), by kind of patch
SPREAD = {"line": (4.0, 3.0), "line_around": (3.0, 4.0), "point": (5.0, 5.0), "flat": (3.0, 3.0)}


class PatchMeasure:
    """Areas of the nodes and cells of one column of a contact grid, and the integrals of its axial shape functions."""

    def __init__(self, surface: Any) -> None:
        self.shape, self.grid = surface.shape, surface.grid
        self.z = np.asarray(self.grid.z, dtype=float)
        self.pitch = float(self.grid.pitch)

    @cached_property
    def axial(self) -> np.ndarray:
        """(3, rows) I^0 [m2/rad], I^1 [m3/rad], I^2 [m4/rad] of the module."""
        if len(self.z) == 1:
            area = meridian_gram("cells", self.shape, self.z).sum()
            return area * np.stack([np.ones(1), self.z, self.z**2])
        x, w = np.polynomial.legendre.leggauss(GAUSS_PER_ROW)
        s, step = 0.5 * (x + 1.0), np.diff(self.z)
        points = self.z[:-1, None] + step[:, None] * s
        weight = (
            0.5 * step[:, None] * w * self.shape.radius_at(points) * np.sqrt(1.0 + self.shape.slope_at(points) ** 2)
        )
        found = np.zeros((3, len(self.z)))
        for n in range(3):
            found[n, :-1] += (weight * points**n * (1.0 - s)).sum(axis=1)
            found[n, 1:] += (weight * points**n * s).sum(axis=1)
        return found

    @cached_property
    def cell_area(self) -> np.ndarray:
        """(rows,) m2, area of the cell around each node of a column."""
        return self.pitch * meridian_gram("cells", self.shape, self.z).diagonal()

    def metric(self, z: np.ndarray) -> np.ndarray:
        """(..., 2) lengths on the surface per unit of theta [m/rad] and of z [-] at z [m]."""
        return np.stack([self.shape.radius_at(z), np.sqrt(1.0 + self.shape.slope_at(z) ** 2)], axis=-1)


class Moments:
    """Load, centre and covariance of the pressure, one row per saved step; zero without contact."""

    def __init__(
        self, measure: PatchMeasure, axial: np.ndarray, theta: np.ndarray, widths: tuple[np.ndarray, float]
    ) -> None:
        """axial (T, columns, 3): sum_k p_jk I^n_k of each column; theta (T, columns), from the line of centres; widths:
        int psi_j dtheta (T,) of the shape functions around, and their second moment about their own centre over its
        square."""
        h, own = widths
        total = axial[..., 0].sum(axis=1)
        touching = total > 0.0
        safe = np.where(touching, total, 1.0)
        middle = np.where(touching, (axial[..., 0] * theta).sum(axis=1) / safe, 0.0)
        z = np.where(touching, axial[..., 1].sum(axis=1) / safe, 0.5 * (measure.z[0] + measure.z[-1]))
        away = theta - middle[:, None]
        around = (axial[..., 0] * (away**2 + own * (h * h)[:, None])).sum(axis=1) / safe
        along = axial[..., 2].sum(axis=1) / safe - z * z
        mixed = (axial[..., 1] * away).sum(axis=1) / safe
        metric = measure.metric(z)
        covariance = np.stack([np.stack([around, mixed], axis=1), np.stack([mixed, along], axis=1)], axis=1)
        covariance = covariance * metric[:, :, None] * metric[:, None, :]
        self.load = h * total  # (T,) N, int p dA
        self.center = np.stack([metric[:, 0] * middle, z], axis=1)  # (T, 2) m: arc from the line of centres, z
        self.covariance = np.where(touching[:, None, None], covariance, 0.0)  # (T, 2, 2) m2, along (e_theta, t_z)

    def half_widths(self, kind: str) -> np.ndarray:
        """(T, 2) m along e_theta and t_z, of a patch of `kind`, a key of SPREAD."""
        squares = np.diagonal(self.covariance, axis1=1, axis2=2) * np.array(SPREAD[kind])
        return np.sqrt(np.maximum(squares, 0.0))

    def principal(self) -> tuple[np.ndarray, np.ndarray]:
        """Semi-axes (T, 2) [m], the larger first, of the Hertz ellipse, and the angle (T,) [rad] of the larger from
        e_theta towards t_z, in (-pi/2, pi/2]."""
        values, axes = np.linalg.eigh(self.covariance)
        angle = np.arctan2(axes[:, 1, 1], axes[:, 0, 1])
        angle = angle - np.pi * np.ceil(angle / np.pi - 0.5)
        return np.sqrt(np.maximum(5.0 * values[:, ::-1], 0.0)), angle


class PatchMoments(Moments):
    """Moments of nodal pressures."""

    def __init__(self, measure: PatchMeasure, pressure: np.ndarray, theta: np.ndarray) -> None:
        """pressure (T, columns, rows) Pa, nodal values; theta (T, columns), from the line of centres."""
        super().__init__(measure, pressure @ measure.axial.T, theta, (np.full(len(pressure), measure.pitch), 1.0 / 6.0))


class CellMoments(Moments):
    """Moments of pressures on cells that move with the patch."""

    def __init__(self, measure: PatchMeasure, places: CellPlaces, pressure: np.ndarray, theta: np.ndarray) -> None:
        """pressure (T, columns, rows) Pa; theta (T, columns), from the line of centres."""
        axial = np.einsum("tjk,tnk->tjn", pressure, places.axial)
        super().__init__(measure, axial, theta, (places.pitch, 0.0))


def axial_integrals(shape: Any, z: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """int zeta_k R dz [m^2], int zeta_k R R' dz [m^2], int zeta_k (z + R R') R dz [m^3] of the axial shape functions,
    each (rows,)."""
    x, w = np.polynomial.legendre.leggauss(GAUSS_PER_ROW)
    t = 0.5 * (x + 1.0)
    step = np.diff(z)
    points = z[:-1, None] + step[:, None] * t
    weight = 0.5 * step[:, None] * w
    R, slope = shape.radius_at(points), shape.slope_at(points)
    sums = []
    for integrand in (R, R * slope, (points + R * slope) * R):
        grid_nodes = np.zeros(len(z))
        grid_nodes[:-1] += (weight * integrand * (1.0 - t)).sum(axis=1)
        grid_nodes[1:] += (weight * integrand * t).sum(axis=1)
        sums.append(grid_nodes)
    return sums[0], sums[1], sums[2]


def traction_forces(contact: Any, i: int) -> tuple[np.ndarray, np.ndarray]:
    """Positions (n, 3) [m] of the cells of a contact with tractions at saved step `i`, and their forces (n, 3) [N] on
    the first body; its user axes."""
    traction, surface = contact.friction.traction[i], contact.view.first
    j, k = np.nonzero(np.any(traction != 0.0, axis=0))
    theta, z = contact.theta[i, j] + grid_theta_offset(surface), contact.rows[i, k]
    e_theta, t_z = tangents(surface.shape, theta, z)
    forces = contact.cell_areas[i, k] * traction[:, j, k]
    return surface.shape.point(theta, z), forces[0][:, None] * e_theta + forces[1][:, None] * t_z
