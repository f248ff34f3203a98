r"""Creep of a pair about the centre of its patch, and the moment of the tractions there, about the outward normal.

The *centre* is the place where the surfaces are nearest: of cells that travel with the patch the middle of those, on
the contact grid the line of centres at mid-width, of a point contact there at the height of the centre of pressure.
With the outward normal n of the first surface there, which with its tangents makes e_theta x t_z = n, and places
x = x_1 e_theta + x_2 t_z from it, the surfaces slide on each other as rigid bodies by

    w_1 = c_1 - omega_n x_2,      w_2 = c_2 + omega_n x_1,      omega_n = n.(omega_A - omega_B),

the first (A) against the second (B), c their creep at the centre (J. J. Kalker, Three-Dimensional Elastic Bodies in
Rolling Contact, 1990, with the longitudinal direction along e_theta, the lateral one along t_z). The run
records creep in a cell next to it, from where the same lines carry it to the centre. Tractions on the first body
have the moment

    M_z = n.sum (x - x_C) x A (tau_1 e_theta + tau_2 t_z),

and take from the motion, per unit time, -(Q_1 c_1 + Q_2 c_2 + M_z omega_n). That is of a patch as flat as its size is
small beside the radii: slip that the curvature of the patch itself makes, as of a ball in a groove that hugs it
(Heathcote), is in the power of the run, and not in this sum.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from warpffrf.output.contact.pressure_wrench import traction_forces
from warpffrf.output.geometry.grid_places import grid_theta_offset, rotate


def center_points(contact: Any) -> tuple[np.ndarray, np.ndarray]:
    """Centre of the patch (T, 3) [m] and outward normal of the first surface there (T, 3); user axes of its body."""
    surface = contact.view.first
    theta, z = contact.patch_center.T
    theta = theta + grid_theta_offset(surface)
    return surface.shape.point(theta, z), surface.shape.normal(theta, z)


def spin_velocity(contact: Any) -> np.ndarray:
    """omega_n (T,) [rad/s] of the bodies' frames; the ground does not turn."""
    _, normal = center_points(contact)
    turning, first = np.zeros_like(normal), contact.bodies.get(contact.view.first_body.name)
    for body, sign in ((contact.view.first_body, 1.0), (contact.view.second_body, -1.0)):
        motion = contact.bodies.get(body.name)
        if motion is not None:
            turning = turning + sign * np.asarray(motion.angular_velocity, dtype=float)
    if first is not None:
        turned = [rotate(q, n[None])[0] for q, n in zip(first.rotation, normal, strict=True)]
        normal = np.array(turned).reshape(-1, 3)
    return np.einsum("td,td->t", normal, turning)


def center_creep(contact: Any, creep: np.ndarray, spin: np.ndarray) -> np.ndarray:
    """Creep (T, 2) [m/s] along (e_theta, t_z) at the centre, of `creep` (T, 2) where the run records it and the `spin`
    (T,) [rad/s]."""
    shape = contact.view.first.shape
    center, recorded = contact.patch_center, contact.creep_place
    away = center - recorded
    across = contact.side * np.asarray(shape.radius_at(center[:, 1])) * away[:, 0]
    along = np.sqrt(1.0 + np.asarray(shape.slope_at(center[:, 1])) ** 2) * away[:, 1]
    return np.asarray(creep, dtype=float) + spin[:, None] * np.stack([-along, across], axis=1)


def spin_moment(contact: Any) -> np.ndarray:
    """M_z (T,) [N m] of the tractions on the first body, about the outward normal of its surface through the centre."""
    points, normals = center_points(contact)
    found = np.zeros(len(points))
    for i, (point, normal) in enumerate(zip(points, normals, strict=True)):
        places, forces = traction_forces(contact, i)
        found[i] = normal @ np.cross(places - point, forces).sum(axis=0)
    return found
