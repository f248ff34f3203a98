"""What tractions and pressures on the cells of a patch displace along the surface, by a dense NumPy reference.

Of cells j, with areas A_j, tractions tau_j on the first body along its (e_theta, t_z) and pressures p_j,

    e_i = sum_j sum_bodies (Cerruti's and Boussinesq's half-space, in the mean of seen from and seeing i)
          + (Phi_t q + P S_tt P^T A tau - P S_nt^T P^T A p) of A - Q (the same of B under -Q^T tau),

P the splines at the centre of a cell and at the place opposite, Q tangents of B in those of A.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from warpffrf.model.reduced.body import ReducedBody

Array = np.ndarray


def integrals(x: Array, z: Array, width: Any, length: Any) -> dict[str, Array]:
    """Integrals over a rectangle about the origin seen from (x, z): 1/r, x^2/r^3, z^2/r^3, x z/r^3, x/r^2, z/r^2, as
    sums over its corners (K. L. Johnson, Contact Mechanics, 1985, section 3.6)."""
    found: dict[str, Any] = dict.fromkeys(("1", "xx", "zz", "xz", "x", "z"), 0.0)
    for sx in (1.0, -1.0):
        for sz in (1.0, -1.0):
            X, Z = x + 0.5 * sx * width, z + 0.5 * sz * length
            r = np.hypot(X, Z)
            xx, zz = Z * np.arcsinh(X / np.abs(Z)), X * np.arcsinh(Z / np.abs(X))
            corner = {
                "1": xx + zz, "xx": xx, "zz": zz, "xz": -r,
                "x": Z * np.log(r) + X * np.arctan(Z / X), "z": X * np.log(r) + Z * np.arctan(X / Z),
            }  # fmt: skip
            for name, value in corner.items():
                found[name] = found[name] + sx * sz * value
    return found


@dataclass(frozen=True)
class Cells:
    """Centres x, z (n,) [m] of cells along e_theta and t_z of the first surface, their `width` [m], `length` (n,)
    [m]."""

    x: Array
    z: Array
    width: float
    length: Array

    @property
    def area(self) -> Array:
        return self.width * self.length

    def mean(self, name: str, z_from: Array | None = None) -> Array:
        """Integral (n, n) of what cell i sees of cell j, times A_i, in the mean with the other way round. z_from
        (n, n): distance along z where it is not that of the centres."""
        x = self.x[:, None] - self.x
        z = self.z[:, None] - self.z if z_from is None else z_from
        seen = integrals(x, z, self.width, self.length[None, :])[name]
        seeing = integrals(x, z, self.width, self.length[:, None])[name]
        return 0.5 * (seen * self.area[:, None] + seeing * self.area)


def near(cells: Cells, body: ReducedBody, surface: str, way: float, *, ends: bool) -> tuple[Array, Array]:
    """Displacement (2 n, 2 n) [m/Pa] by tractions and (2 n, n) by pressures of the half-space of one body, directions
    one after the other; way: 1 of the first body, -1 of the second. `ends`: with mirror images."""
    far = body.contact_surfaces[surface].far
    assert far is not None
    nu, shear = far.poisson_ratio, far.youngs_modulus / (2.0 * (1.0 + far.poisson_ratio))
    n = len(cells.x)
    T, P = np.zeros((2, n, 2, n)), np.zeros((2, n, n))
    images = [np.abs(end.z - cells.z[:, None]) + np.abs(end.z - cells.z) for end in far.ends] if ends else []
    for at in (None, *images):
        one = (1.0 - nu) * cells.mean("1", at)
        T[0, :, 0] += one + nu * cells.mean("xx", at)
        T[1, :, 1] += one + nu * cells.mean("zz", at)
        P[0] -= cells.mean("x", at)
        if at is None:
            both = nu * cells.mean("xz")
            T[0, :, 1], T[1, :, 0] = both, both
            P[1] -= cells.mean("z")
    T /= 2.0 * np.pi * shear * cells.area[:, None, None]
    P *= way * (1.0 - 2.0 * nu) / (4.0 * np.pi * shear) / cells.area[:, None]
    return T.reshape(2 * n, 2 * n), P.reshape(2 * n, n)


class Side:
    """The far field and modes of one body at places (theta, z) (n,) of a surface."""

    def __init__(self, body: ReducedBody, surface: str, theta: Array, z: Array) -> None:
        s = body.contact_surfaces[surface]
        assert s.far is not None and s.far.tangential is not None
        splines, far = s.splines, s.far.tangential
        P = (splines.around(theta)[:, :, None] * splines.along(z)[:, None, :]).reshape(len(theta), -1)
        n = P.shape[1]
        c, rows = s.grid.columns_per_sector, s.grid.rows
        j, k = np.divmod(np.arange(n), rows)
        lag = (j[:, None] // c - j // c) % len(far.lags_tt)
        own = (j % c) * rows + k
        two = np.concatenate([own, own + c * rows])
        S_tt = far.lags_tt[np.tile(lag, (2, 2)), two[:, None], two]
        S_nt = far.lags_nt[np.tile(lag, (1, 2)), own[:, None], two]
        PP = np.kron(np.eye(2), P)
        self.by_forces = PP @ S_tt @ PP.T  # (2 n, 2 n) along, by forces along
        self.outward = P @ S_nt @ PP.T  # (n, 2 n) by forces along
        self.modes = np.concatenate([P @ modes for modes in s.mode_tangent_splines])  # (2 n, m)
        self.modes_outward = P @ splines.of_functions(s.mode_normal)
        S_n = s.far.lags[lag, own[:, None], own]
        self.pressed_outward = P @ S_n @ P.T  # (n, n) by forces outward
