r"""Force and torque on the first body, recomputed from the recorded pressure and tractions on its true surface.

An independent check of the recorded `force` and `torque`, and of the torque of frictionless contact about the axle. On
a surface of revolution with point `c` on the axis, `x = c + z e_a + R(z) e_r(theta)` and
`n dA = side (e_r - R' e_a) R dtheta dz`, so for a shape function `psi_j(theta) zeta_k(z)` of angular spacing h, with
`int psi_j e_r dtheta = 2 (1 - cos h)/h e_r(theta_j)` exactly,

    F = -side sum_jk p_jk [ 2 (1 - cos h)/h e_r(theta_j) int zeta_k R dz  -  h e_a int zeta_k R R' dz ]
    T_c = -side sum_jk p_jk 2 (1 - cos h)/h  (e_a x e_r(theta_j)) int zeta_k (z + R R') R dz

and T_c has no axial component: pressure alone cannot drive a surface of revolution. On a plane with normal n

    F = -n h sum_jk p_jk int zeta_k dz,      T_c = -h sum_jk p_jk (theta_j e_1 int zeta_k dz + e_a int zeta_k z dz) x n.

On contact-fixed cells, which span h, 2 (1 - cos h)/h becomes 2 sin(h/2), and zeta_k is 1 on its row.

Tractions are constant per cell of area A, and their forces act at its node, or in the middle of a contact-fixed cell:

    F = sum_jk A_k (tau_1 e_theta + tau_2 t_z),      T = sum_jk x_jk x A_k (tau_1 e_theta + tau_2 t_z).
"""

from __future__ import annotations

from typing import Any

import numpy as np

from warpffrf.output.contact.patch_moments import traction_forces
from warpffrf.output.geometry.places import grid_theta_offset, rotate


def pressure_wrench(result: Any, name: str) -> tuple[np.ndarray, np.ndarray]:
    """Force (T, 3) [N] and torque (T, 3) [N m] of the pressure on the first body of contact `name`: world axes, about
    its user origin."""
    contact = result.contact(name)
    surface = contact.view.first
    shape = surface.shape
    theta = contact.theta + grid_theta_offset(surface)  # (T, columns)
    force, torque = (_plane if shape.kind == "plane" else _revolution)(contact, shape, theta)
    torque = torque + np.cross(shape.axis_point, force)  # from the point on the axis to the user origin
    return _to_world(result, contact, force, torque)


def _revolution(contact: Any, shape: Any, theta: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Force and torque (T, 3) about the point on the axis, user axes, of pressures at theta (T, columns)."""
    radial, around, rings = contact.pressure_resultants()
    sums = np.einsum("tjk,tnk->ntj", contact.history.pressure, rings)
    e_r = shape.radial(theta)  # (T, columns, 3)
    force = -radial[:, None] * np.einsum("tj,tjd->td", sums[0], e_r)
    force = force + (around * sums[1].sum(axis=1))[:, None] * shape.e_a
    torque = -radial[:, None] * np.einsum("tj,tjd->td", sums[2], np.cross(shape.e_a, e_r))
    return shape.side * force, shape.side * torque


def _plane(contact: Any, shape: Any, theta: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The same for a plane, about its origin; theta (T, columns) m."""
    _, around, rings = contact.pressure_resultants()
    loads, _, first = around[:, None] * np.einsum("tjk,tnk->ntj", contact.history.pressure, rings)
    force = -loads.sum(axis=1)[:, None] * shape.e_0
    lever = (loads * theta).sum(axis=1)[:, None] * shape.e_1 + first.sum(axis=1)[:, None] * shape.e_a
    return force, -np.cross(lever, shape.e_0)


def traction_wrench(result: Any, name: str) -> tuple[np.ndarray, np.ndarray]:
    """Force (T, 3) [N] and torque (T, 3) [N m] of the tangential tractions on the first body of contact `name`: world
    axes, about its user origin. Raises `InputError` for a pair without friction."""
    contact = result.contact(name)
    steps = len(contact.friction.traction)
    force, torque = np.zeros((steps, 3)), np.zeros((steps, 3))
    for i in range(steps):
        places, forces = traction_forces(contact, i)
        force[i], torque[i] = forces.sum(axis=0), np.cross(places, forces).sum(axis=0)
    return _to_world(result, contact, force, torque)


def _to_world(result: Any, contact: Any, force: np.ndarray, torque: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    rotation = result.history.bodies[contact.view.first_body.name].rotation
    turned = [(rotate(q, f[None])[0], rotate(q, m[None])[0]) for q, f, m in zip(rotation, force, torque, strict=True)]
    return np.array([f for f, _ in turned]).reshape(-1, 3), np.array([m for _, m in turned]).reshape(-1, 3)
