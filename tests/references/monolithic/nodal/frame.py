r"""The contact frame, in which the normal forces of nodes exert no torque on a body about its own axle.

A force along the normal n of B at a node of A misses A's axis by the angle between the two normals. Rotating a body of
revolution about its axis moves only its mesh, so that the torque is an artefact of the mesh. As in the separated solver
the node's position on the mesh is a parameter of the contact energy: it is fixed in the contact frame, the angle
theta* of closest approach, which moves with the bodies. With x* at theta* in the node's section, e = e_theta
and e_r there, H = dn/dx, u = tau + w x (x - O) the motion of A relative to B, O on A's axis, and q = ((x - O) x n).e_A

    dtheta* = -[(H u*).e + n.(w x e)]/N,      N = R e.H e - n.e_r,
    force n + q D_f,      moment (x - O) x n + q D_m,      D_f = -H e/N,      D_m = -((x* - O) x H e + e x n)/N.

For a sphere (centre O) rotation about any axis is excluded: with q = (x - O) x n and e = -n(O) the force is n - H (q x
e) + (q.e)(e.e_B)/rho e_phi, at the centre, H at the point O, rho its distance from B's axis e_B and e_phi the direction
around that. H has the curvatures kappa/(1 + kappa d) of the surface parallel to B's. If B is a plane H = 0.

`Extra` is the force in addition to that along n. Its derivatives by the bodies are central differences: few
numbers, and smooth; the angle theta* is followed within them.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from references.monolithic.core.rotation import exponential
from references.monolithic.nodal.gap import RIGID
from references.monolithic.nodal.surface import NodeSide, PartnerSide
from warpffrf.model.rotation import matrix

STEPS = 12  # of Newton's method for theta*: quadratic convergence from the nearest node
FOLLOWED = 1e-13  # rad
COAXIAL = 1e-9  # of N: nothing is omitted there, n.e is round-off
DIFFERENCE = 1e-6  # of A's radius, rad: error of a central difference about its square


@dataclass(frozen=True, eq=False)
class Poses:
    """Centres of mass r and axes A of both bodies (for the ground 0 and 1)."""

    r_a: np.ndarray
    A_a: np.ndarray
    r_b: np.ndarray
    A_b: np.ndarray

    def moved(self, column: int, by: float) -> Poses:
        """With one of the twelve rigid coordinates changed."""
        step = np.zeros(RIGID)
        step[column] = by
        return Poses(
            self.r_a + step[:3], self.A_a @ matrix(exponential(step[3:6])), self.r_b + step[6:9],
            self.A_b @ matrix(exponential(step[9:])),
        )  # fmt: skip


class Extra:
    """Effect of the normal forces (k,) [N] of the nodes `at` in addition to a force along each normal."""

    def __init__(self, a: NodeSide, b: PartnerSide, at: np.ndarray, nearest: int) -> None:
        self.a, self.b, self.at, self.nearest = a, b, at, nearest

    def rows(self, poses: Poses) -> np.ndarray:
        """Generalised force (k, 12) of unit forces: world force and torque about the centre of mass in body axes, A,
        B."""
        a, C = self.a, poses.A_b.T @ poses.A_a
        shift = poses.A_b.T @ (poses.r_a - poses.r_b)
        arm = a.place[self.at] - a.axis_point
        n = self._normal(poses, a.place[self.at])[0]
        q = np.cross(arm, n)
        force, moment = self._sphere(poses, q) if a.shape.profile().spherical else self._section(poses, q @ a.shape.e_a)
        moment = moment + np.cross(a.axis_point, force)
        out = np.empty((len(self.at), RIGID))
        out[:, :3] = force @ poses.A_a.T
        out[:, 3:6] = moment
        out[:, 6:9] = -out[:, :3]
        out[:, 9:] = -(moment @ C.T) - np.cross(shift, force @ C.T)
        return out

    def slope(self, poses: Poses, forces: np.ndarray, columns: int) -> np.ndarray:
        """Derivative (12, columns) of the generalised force of `forces` (k,) by the first rigid coordinates."""
        out = np.zeros((RIGID, columns))
        radius = float(self.a.shape.size)
        for c in range(columns):
            by = DIFFERENCE * (radius if c % 6 < 3 else 1.0)
            both = [forces @ self.rows(poses.moved(c, sign * by)) for sign in (1.0, -1.0)]
            out[:, c] = (both[0] - both[1]) / (2.0 * by)
        return out

    def _normal(self, poses: Poses, x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """n (k, 3) and H (k, 3, 3) at points x (k, 3) about A's centre of mass, A's axes."""
        b, C = self.b, poses.A_b.T @ poses.A_a
        y = poses.A_b.T @ (poses.r_a - poses.r_b) + x @ C.T
        theta, z, d = b.shape.chart(y + b.center)
        tangents = (b.shape.around(theta), b.shape.along(theta, z))
        H = np.zeros((len(x), 3, 3))
        for t, kappa in zip(tangents, b.shape.curvatures(theta, z), strict=True):
            scale = 1.0 + kappa * d
            scale = np.where(scale < 0.0, np.minimum(scale, -COAXIAL), np.maximum(scale, COAXIAL))
            H += (kappa / scale)[:, None, None] * t[:, :, None] * t[:, None, :]
        return b.shape.normal(theta, z) @ C, C.T @ H @ C

    def _section(self, poses: Poses, q: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Forces and moments about O of moments q (k,) about A's axis."""
        theta = self._angle(poses)
        z = self.a.z[self.at]
        x = self.a.shape.point(np.full(len(z), theta), z) - self.a.center
        n, H = self._normal(poses, x)
        e = np.cross(self.a.shape.e_a, self.a.shape.radial(theta))
        e_r = np.cross(e, self.a.shape.e_a)
        bent = H @ e
        N = self.a.shape.radius_at(z) * (bent @ e) - n @ e_r
        N = np.where(np.abs(N) < COAXIAL, np.inf, N)
        force = -(q / N)[:, None] * bent
        return force, -(q / N)[:, None] * (np.cross(x - self.a.axis_point, bent) + np.cross(e, n))

    def _angle(self, poses: Poses) -> float:
        """theta*, starting from the nearest node."""
        a, z = self.a, np.atleast_1d(self.a.z[self.nearest])
        theta = float(a.shape.chart(np.atleast_2d(a.place[self.nearest] + a.center))[0][0])
        for _ in range(STEPS):
            e_r = a.shape.radial(theta)
            e = np.cross(a.shape.e_a, e_r)
            n, H = self._normal(poses, a.shape.point(np.atleast_1d(theta), z) - a.center)
            slope = float(a.shape.radius_at(z)[0]) * float(e @ H[0] @ e) - float(n[0] @ e_r)
            if slope < COAXIAL:
                break
            move = -float(n[0] @ e) / slope
            theta += move
            if abs(move) < FOLLOWED:
                break
        return theta

    def _sphere(self, poses: Poses, q: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Forces and moments about the centre of moments q (k, 3) about it."""
        n, H = (v[0] for v in self._normal(poses, np.atleast_2d(self.a.axis_point)))
        e = -n
        force = -np.cross(q, e) @ H
        shape, C = self.b.shape, poses.A_b.T @ poses.A_a
        if not shape.profile().planar:
            out = poses.A_b.T @ (poses.r_a - poses.r_b) + C @ self.a.axis_point + self.b.center - shape.axis_point
            radial = out - (out @ shape.e_a) * shape.e_a
            size = float(radial @ radial)
            if size > 0.0:
                around = C.T @ np.cross(shape.e_a, radial)
                force = force + (q @ e)[:, None] * float(e @ (C.T @ shape.e_a)) / size * around
        return force, -q
