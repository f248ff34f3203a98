"""A reduced body made of point masses: its inertia terms are plain sums, its motion can be followed point by point."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from warpffrf.model import rotation as rot
from warpffrf.model.reduced.body import ReducedBody
from warpffrf.model.reduced.data import DisplaySurface, Interface
from warpffrf.model.reduced.inertia import InertiaTerms
from warpffrf.online.history.history import BodyHistory


@dataclass(frozen=True)
class PointMasses:
    """Points X (n, 3) [m, user frame], masses (n,) [kg], modes (m, n, 3), M-orthonormal and without momentum."""

    X: np.ndarray
    mass: np.ndarray
    modes: np.ndarray

    @property
    def center(self) -> np.ndarray:
        """Centre of mass (3,) [m]."""
        return self.mass @ self.X / self.mass.sum()


def point_masses(modes: int = 4, points: int = 12, seed: int = 3) -> PointMasses:
    """Random points and modes, off the origin."""
    rng = np.random.default_rng(seed)
    X = rng.normal(size=(points, 3)) * np.array([1.0, 0.6, 0.3]) + np.array([0.2, -0.1, 0.4])
    mass = rng.uniform(0.1, 0.4, points)
    Y = X - mass @ X / mass.sum()
    rigid = [np.tile(e, (points, 1)) for e in np.eye(3)] + [np.cross(e, Y) for e in np.eye(3)]
    columns = np.array([*rigid, *rng.normal(size=(modes, points, 3))]).reshape(6 + modes, -1)
    root = np.repeat(np.sqrt(mass), 3)
    Q, _ = np.linalg.qr((columns * root).T)
    return PointMasses(X, mass, (Q.T / root)[6:].reshape(modes, points, 3))


def reduced_points(body: PointMasses, frequencies: np.ndarray, carrying: int | None = None) -> ReducedBody:
    """The reduced body with inertia terms of the first `carrying` modes (None: all), and an interface "tip" at the
    first point, which does not turn."""
    m, n = body.modes.shape[:2]
    k = m if carrying is None else carrying
    Y, dm, phi, one = body.X - body.center, body.mass, body.modes[:k], np.eye(3)
    J0 = np.einsum("n,nij->ij", dm, np.einsum("nc,nc,ij->nij", Y, Y, one) - np.einsum("ni,nj->nij", Y, Y))
    along = np.einsum("n,nc,knc->k", dm, Y, phi)
    mixed = np.einsum("n,ni,knj->kij", dm, Y, phi)
    first = 2.0 * along[:, None, None] * one - mixed - mixed.transpose(0, 2, 1)
    outer = np.einsum("n,kni,lnj->klij", dm, phi, phi)
    second = np.einsum("klcc,ij->klij", outer, one) - 0.5 * (outer + outer.transpose(0, 1, 3, 2))
    gyroscopic = np.einsum("n,klni->kli", dm, np.cross(phi[:, None], phi[None]))
    tip = np.hstack([body.modes[:, 0], np.zeros((m, 3))])
    skin = DisplaySurface(body.X, np.array([[0, 1, 2]]), body.modes)
    interfaces = {"tip": Interface("rigid", body.X[0], tip)}
    return ReducedBody(
        float(dm.sum()), body.center, J0, np.asarray(frequencies, float), interfaces, {}, skin,
        inertia_terms=InertiaTerms(first, second, gyroscopic),
    )  # fmt: skip


def momenta(body: PointMasses, motion: BodyHistory, row: int) -> tuple[np.ndarray, np.ndarray, float]:
    """Linear momentum, angular momentum about the world's origin, kinetic energy: sums over the points' own velocities,
    from a BodyHistory."""
    A = rot.matrix(motion.rotation[row])
    q, qd = motion.modal[row], motion.modal_velocity[row]
    Z = body.X + np.tensordot(q, body.modes, 1)
    x = motion.position[row] + Z @ A.T
    v = motion.velocity[row] + np.cross(motion.angular_velocity[row], Z @ A.T) + np.tensordot(qd, body.modes, 1) @ A.T
    mv = body.mass[:, None] * v
    return mv.sum(axis=0), np.cross(x, mv).sum(axis=0), float(0.5 * np.sum(mv * v))
