r"""Force and torque on the first body, summed again from the recorded pressure on its true surface.

An independent check of the recorded `force` and `torque`, and of the torque of frictionless contact about the axle. On
a surface of revolution with point `c` on the axis, `x = c + z e_a + R(z) e_r(theta)` and
`n dA = (e_r - R' e_a) R dtheta dz`, so for a hat `psi_j(theta) zeta_k(z)` of angular spacing h, with
`int psi_j e_r dtheta = 2 (1 - cos h)/h e_r(theta_j)` exactly,

    F = -sum_jk p_jk [ 2 (1 - cos h)/h e_r(theta_j) int zeta_k R dz  -  h e_a int zeta_k R R' dz ]
    T_c = -sum_jk p_jk 2 (1 - cos h)/h  (e_a x e_r(theta_j)) int zeta_k (z + R R') R dz

and T_c has no component along the axis: pressure alone cannot drive a surface of revolution.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from warpffrf.model.contact_grid import GAUSS_PER_ROW
from warpffrf.output.skin import grid_theta_offset, rotate


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


def pressure_wrench(result: Any, name: str) -> tuple[np.ndarray, np.ndarray]:
    """Force (T, 3) [N] and torque (T, 3) [N m] on the first body of contact `name`: world axes, about its user
    origin."""
    contact = result.contact(name)
    surface = contact.view.first
    shape, h = surface.shape, float(surface.grid.pitch)
    radial_sum, axial_sum, moment_sum = axial_integrals(shape, np.asarray(surface.grid.z))
    hat = 2.0 * (1.0 - np.cos(h)) / h
    e_r = shape.radial(contact.theta + grid_theta_offset(surface))  # (T, columns, 3)
    p = contact.history.pressure
    force = -hat * np.einsum("tj,tjd->td", p @ radial_sum, e_r) + h * (p @ axial_sum).sum(axis=1)[:, None] * shape.e_a
    torque = -hat * np.einsum("tj,tjd->td", p @ moment_sum, np.cross(shape.e_a, e_r))
    torque = torque + np.cross(shape.axis_point, force)  # from the point on the axis to the user origin
    rotation = result.history.bodies[contact.view.first_body.name].rotation
    turned = [(rotate(q, f[None])[0], rotate(q, m[None])[0]) for q, f, m in zip(rotation, force, torque, strict=True)]
    return np.array([f for f, _ in turned]).reshape(-1, 3), np.array([m for _, m in turned]).reshape(-1, 3)
