r"""Straight leaves on top of each other, clamped at one end and loaded at the tip of the longest: half a leaf spring.

Leaf 0 is the longest, of length l_0 from the clamp, with P at its tip; leaves 1, 2, ... are shorter and lie
below. Bent leaves touch at the tips of the shorter ones alone: just behind the tip of leaf i + 1 leaf i has the larger
curvature. There X_i is the contact force, and H_i the friction, outwards on the leaf above, whose lower face slides
inwards as P grows. The moments and axial forces of leaves of thickness h are

    M_0 = P (l_0 - x) - [X_1 (l_1 - x) + H_1 h/2],        N_0 = H_1,
    M_i = [X_i (l_i - x) - H_i h/2] - [X_(i+1) (l_(i+1) - x) + H_(i+1) h/2],      N_i = H_(i+1) - H_i,

with brackets ending at the tip of the shorter leaf, and the energy sum int M^2/(2EI) + N^2/(2EA) dx = f^T C f/2 of the
forces f = (P, X, H). Its derivatives are the tip's deflection w, the closing of the contacts, which is 0, and their
slip u. Each contact sticks or slips, so that for increments

    C_X df = 0,      stick: C_H df = 0,      slip: H = mu X sign(du) >= ...,

a piecewise linear history. H = mu X everywhere while P grows, and H = -mu X while it falls, give two straight lines
through the origin; in between, after a reversal, contacts stick at first. The loss per cycle is the area of the loop.

Neglected: shear, some (h/l)^2, the finite contact length at the ends of the leaves, and the compliance of the clamp.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

import numpy as np

from warpffrf.model.errors import InputError, require_array, require_number

Array = np.ndarray
ROUND_OFF = 1e-9  # of the largest force: tolerance of the friction bound


@dataclass(frozen=True)
class LeafSpring:
    """Leaves of equal section: `lengths` from the clamp, falling [m], width, thickness [m], E [Pa], friction [-].

    Raises `InputError` for less than two leaves, lengths that do not fall and values that are not positive.
    """

    lengths: tuple[float, ...]
    width: float
    thickness: float
    youngs_modulus: float
    friction: float

    def __post_init__(self) -> None:
        for name in ("width", "thickness", "youngs_modulus", "friction"):
            require_number(getattr(self, name), f"leaf spring: {name}", positive=True)
        lengths = require_array(self.lengths, "leaf spring: lengths", (None,))
        if len(lengths) < 2 or np.any(np.diff(lengths) >= 0.0) or lengths[-1] <= 0.0:
            raise InputError(f"leaf spring: lengths must be two or more that fall, got {lengths.tolist()}")

    @property
    def contacts(self) -> int:
        """Number of tips that press on the leaf above."""
        return len(self.lengths) - 1

    @cached_property
    def compliance(self) -> Array:
        """C (2 k + 1, 2 k + 1) of the forces P, X (k,), H (k,) [m/N]."""
        k, h = self.contacts, self.thickness
        bends = 12.0 / (self.youngs_modulus * self.width * h**3)
        pulls = 1.0 / (self.youngs_modulus * self.width * h)
        gauss, weight = np.polynomial.legendre.leggauss(2)  # exact for products of linear functions
        C = np.zeros((2 * k + 1, 2 * k + 1))
        for inner, outer in pairwise([0.0, *self.lengths[::-1]]):
            x = 0.5 * (inner + outer) + 0.5 * (outer - inner) * gauss
            M, N = np.zeros((k + 1, 2 * k + 1, 2)), np.zeros((k + 1, 2 * k + 1, 2))
            M[0, 0] = self.lengths[0] - x
            for i in range(k):
                if self.lengths[i + 1] >= outer:
                    M[i, 1 + i], M[i + 1, 1 + i] = x - self.lengths[i + 1], self.lengths[i + 1] - x
                    M[i : i + 2, 1 + k + i] = -0.5 * h
                    N[i, 1 + k + i], N[i + 1, 1 + k + i] = 1.0, -1.0
            w = 0.5 * (outer - inner) * weight
            C += bends * np.einsum("laq,lbq,q->ab", M, M, w) + pulls * np.einsum("laq,lbq,q->ab", N, N, w)
        return C

    def _forces(self, load: float, sense: Array, begin: Array) -> Array:
        """f at P = `load`, of contacts that slip in the `sense` (k,) of H and those that stick (0) since the state
        f `begin`."""
        k, C = self.contacts, self.compliance
        pressing, sliding = np.arange(1, k + 1), np.arange(k + 1, 2 * k + 1)
        A, b = np.zeros((2 * k, 2 * k)), np.zeros(2 * k)
        A[:k], b[:k] = C[pressing, 1:], -C[pressing, 0] * load
        for i in range(k):
            if sense[i]:
                A[k + i, i], A[k + i, k + i] = -sense[i] * self.friction, 1.0
            else:
                A[k + i], b[k + i] = C[sliding[i], 1:], C[sliding[i]] @ begin - C[sliding[i], 0] * load
        return np.concatenate([[load], np.linalg.solve(A, b)])

    def stiffness(self, sense: float = 0.0) -> float:
        """P/w [N/m] with H = sense mu X: 1 while the load grows, -1 while it falls, 0 without friction."""
        k = self.contacts
        A = self.compliance[1 : k + 1]
        X = np.linalg.solve(A[:, 1 : k + 1] + sense * self.friction * A[:, k + 1 :], -A[:, 0])
        return 1.0 / float(self.compliance[0] @ np.concatenate([[1.0], X, sense * self.friction * X]))

    @property
    def stuck_stiffness(self) -> float:
        """dP/dw [N/m] if all contacts stick."""
        k = self.contacts
        return 1.0 / float(self.compliance[0] @ self._forces(1.0, np.zeros(k), np.zeros(2 * k + 1)))

    def follow(self, loads: Array) -> tuple[Array, Array]:
        """Deflection (n,) [m] and forces (n, 2 k + 1) [N] through `loads` (n,) [N], from zero, in increments."""
        k = self.contacts
        f, found = np.zeros(2 * k + 1), []
        for load in np.asarray(loads, dtype=float):
            sense = np.zeros(k)
            for _ in range(4**k):
                new = self._forces(load, sense, f)
                X, H = new[1 : k + 1], new[k + 1 :]
                over = np.abs(H) > self.friction * X + ROUND_OFF * (abs(load) + np.abs(new).max())
                slid = (self.compliance[k + 1 :] @ (new - f)) * sense
                wrong = np.where(sense == 0.0, over, slid > 0.0)
                if not wrong.any():
                    break
                first = int(np.flatnonzero(wrong)[0])
                sense[first] = np.sign(H[first]) if sense[first] == 0.0 else 0.0
            else:
                raise InputError(f"leaf spring: no state was found at {load:g} N; take smaller steps of the load")
            f = new
            found.append(f)
        forces = np.array(found)
        return forces @ self.compliance[0], forces

    def cycle_loss(self, high: float, low: float, steps: int = 200) -> Array:
        """Work [J] lost by each contact (k,) in a cycle between the loads `high` and `low` [N], by this number of steps
        either way."""
        k = self.contacts
        fall = np.linspace(high, low, steps + 1)
        _, f = self.follow(np.concatenate([np.linspace(0.0, high, steps + 1), fall[1:], fall[-2::-1]]))
        f = f[steps:]
        slid = f @ self.compliance[k + 1 :].T
        return -np.sum(0.5 * (f[1:, k + 1 :] + f[:-1, k + 1 :]) * np.diff(slid, axis=0), axis=0)
