r"""Integrals of axial hats over a surface of revolution, and the forces of tractions on its cells.

Tractions are constant per cell of area A, and their forces act at its node, or in the middle of a cell that travels.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from warpffrf.model.reduced.contact_grid import GAUSS_PER_ROW
from warpffrf.output.geometry.grid_places import grid_theta_offset
from warpffrf.output.geometry.poses import tangents


def axial_integrals(shape: Any, z: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """int zeta_k R dz [m^2], int zeta_k R R' dz [m^2], int zeta_k (z + R R') R dz [m^3] of the axial hats, each
    (rows,)."""
    x, w = np.polynomial.legendre.leggauss(GAUSS_PER_ROW)
    t = 0.5 * (x + 1.0)
    step = np.diff(z)
    points = z[:-1, None] + step[:, None] * t
    weight = 0.5 * step[:, None] * w
    R, slope = shape.radius_at(points), shape.slope_at(points)
    sums = []
    for integrand in (R, R * slope, (points + R * slope) * R):
        hats = np.zeros(len(z))
        hats[:-1] += (weight * integrand * (1.0 - t)).sum(axis=1)
        hats[1:] += (weight * integrand * t).sum(axis=1)
        sums.append(hats)
    return sums[0], sums[1], sums[2]


def traction_forces(contact: Any, i: int) -> tuple[np.ndarray, np.ndarray]:
    """Places (n, 3) [m] of the cells of a pair that have tractions at saved step `i`, and their forces (n, 3) [N] on
    the first body; its user axes."""
    traction, surface = contact.friction.traction[i], contact.view.first
    j, k = np.nonzero(np.any(traction != 0.0, axis=0))
    theta, z = contact.theta[i, j] + grid_theta_offset(surface), contact.rows[i, k]
    e_theta, t_z = tangents(surface.shape, theta, z)
    forces = contact.cell_areas[i, k] * traction[:, j, k]
    return surface.shape.point(theta, z), forces[0][:, None] * e_theta + forces[1][:, None] * t_z
