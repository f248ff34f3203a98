r"""Inertia of a deforming body: the invariants of its modes, and the forces between turning and deforming.

A point X of the body (about the centre of mass, body axes) moves to `X + u`, `u = sum_i q_i phi_i(X)`; the body turns
with w. Its velocity, in body axes, is `v + w x (X + u) + udot`. In a Tisserand frame the modes have no momentum,
`int phi_i dm = 0`, `int X x phi_i dm = 0`, and with `int phi_i.phi_j dm = delta_ij` the kinetic energy is

    T = m v.v/2 + w.J(q) w/2 + w.h(q, qdot) + |qdot|^2/2,
    J(q) = J0 + sum_i q_i J1_i + sum_ij q_i q_j J2_ij,      h = int u x udot dm = sum_ij q_i qdot_j G_ij,
    J1_i = int 2 (X.phi_i) 1 - X phi_i^T - phi_i X^T dm,
    J2_ij = int (phi_i.phi_j) 1 - (phi_i phi_j^T + phi_j phi_i^T)/2 dm,      G_ij = int phi_i x phi_j dm = -G_ji,

exactly: J is of second degree in q. What is called linear momentum is m v whatever q is. Lagrange's equations, with the
angular momentum `L = J w + h`, forces f_j on the modes and M on the body:

    Ldot + w x L = M,        Ldot = J wdot + Jdot w + hdot,
    qddot_j + 2 sum_i (w.G_ij) qdot_i + sum_i (wdot.G_ij) q_i - w.J1_j w/2 - sum_i (w.J2_ij w) q_i + ... = f_j,

the added terms of a mode being Coriolis, Euler and centrifugal forces. (Shabana, Dynamics of Multibody Systems, ch. 5,
writes the same integrals as inertia shape integrals.) `w.J2_ij w` is the Gram matrix of `w x phi_i`, not negative.

**Levels** leave out J1, J2 or G in T itself, and take forces from what is left. Each is therefore a mechanical system
of its own, and conserves energy and angular momentum: "constant" keeps none, "deformed" J1 and J2, "gyroscopic" J1 and
G, "full" all three. The terms are called "centrifugal" (J1), "deformed inertia" (J2) and "gyroscopic" (G).
Limits: w = 0 leaves G's Euler forces alone, |q| = 0 the centrifugal load w.J1_j w/2; the terms compare with the elastic
force as (w/omega_j)^2 (J2) and w/omega_j (G), so slow turning of a stiff body needs none.

**Geometric stiffening.** A prestress sigma0 adds `sum_c int d_a phi_i^c sigma0_ab d_b phi_j^c dV` to the stiffness;
sigma0 is linear in what causes it, the centrifugal load (products of w) and the loads F on the interfaces:

    K_geo = sum_ab w_a w_b Kc_ab + sum over interfaces and components F_k Kf_k,      force on the modes - K_geo q.

All arrays are in the axes of the user frame, moments about the centre of mass; modes have modal mass 1 kg, so that q is
in m, J1 in kg m, J2 and G in kg. They cover the first k of the m modes; the others count as if without these terms.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from warpffrf.model.errors import InputError, require_array, unknown_name
from warpffrf.model.reduced.second_order_motion import SecondOrderMotion

Array = np.ndarray
LEVELS: dict[str, tuple[bool, bool, bool]] = {  # which of J1, J2, G are kept
    "constant": (False, False, False),
    "deformed": (True, True, False),
    "gyroscopic": (True, False, True),
    "full": (True, True, True),
}
TERM_NAMES = ("centrifugal", "deformed inertia", "gyroscopic")  # of J1, J2, G
PRODUCTS = ((0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (2, 0))  # order of the products w_a w_b


@dataclass(frozen=True, eq=False)
class GeometricStiffness:
    """Stiffness of the first k modes by prestress, symmetric: `centrifugal` (6, k, k) for w_x^2, w_y^2, w_z^2, w_x w_y,
    w_y w_z, w_z w_x, each times the product itself; `interfaces` name -> (6, k, k) per unit force (3) [N] and torque
    (3) [N m] on the body at the interface's point, body (user) axes; `membrane` (R, k, k) [sqrt(J)/m^2], the forms of
    the membrane energy (`warpffrf.model.reduced.membrane`), None of a body reduced without; `motion`: the second-order
    motion of all its points, None likewise."""

    centrifugal: Array
    interfaces: dict[str, Array] = field(default_factory=dict)
    membrane: Array | None = None
    motion: SecondOrderMotion | None = None

    def __post_init__(self) -> None:
        given = {"centrifugal": self.centrifugal, **{f"interface {n!r}": K for n, K in self.interfaces.items()}}
        for name, K in given.items():
            require_array(K, f"geometric stiffness, {name}", (6, None, None))
            if K.shape[1:] != 2 * (self.modes,):
                raise InputError(f"geometric stiffness, {name}: shape {K.shape} is not (6, {self.modes}, {self.modes})")
        if self.membrane is not None:
            require_array(self.membrane, "membrane energy", (None, self.modes, self.modes))
        if self.motion is not None:
            require_array(self.motion.forms, "second-order motion", (None, self.modes, self.modes))

    @property
    def modes(self) -> int:
        """Number k of modes covered."""
        return self.centrifugal.shape[1]

    def matrix(self, w: Array, loads: Mapping[str, Array] | None = None) -> Array:
        """K_geo (k, k) at angular velocity `w` (3,) [rad/s] under interface `loads` name -> (6,) [N, N m], body axes.

        Raises `InputError` for an interface that there is none of.
        """
        total = np.tensordot([w[a] * w[b] for a, b in PRODUCTS], self.centrifugal, 1)
        for name, load in (loads or {}).items():
            if name not in self.interfaces:
                raise unknown_name("geometric stiffness: interface", name, self.interfaces)
            total = total + np.tensordot(load, self.interfaces[name], 1)
        return total


@dataclass(frozen=True, eq=False)
class InertiaTerms:
    """Invariants of the first k modes: `first` J1 (k, 3, 3) [kg m], `second` J2 (k, k, 3, 3) [kg], `gyroscopic` G
    (k, k, 3) [kg], and the `stiffening` where it was asked for. See the module docstring."""

    first: Array
    second: Array
    gyroscopic: Array
    stiffening: GeometricStiffness | None = None

    def __post_init__(self) -> None:
        k = len(self.first)
        shapes = {"first": (k, 3, 3), "second": (k, k, 3, 3), "gyroscopic": (k, k, 3)}
        for name, shape in shapes.items():
            require_array(getattr(self, name), f"inertia terms: {name}", shape)
        if self.stiffening is not None and self.stiffening.modes != k:
            raise InputError(
                f"inertia terms of {k} modes, geometric stiffness of {self.stiffening.modes}; give both of k"
            )

    @property
    def modes(self) -> int:
        """Number k of modes covered."""
        return len(self.first)

    def kept(self, level: str, *, stiffened: bool = False) -> tuple[Array, Array, Array]:
        """J1, J2, G with those that `level` leaves out set to zero; raises `InputError` for an unknown level.

        `stiffened`: J2 - Kc, the energy q.K_c q/2 of stiffening by rotation with its sign in w.J w/2; a mixed product
        of w stands in two places of J2, half in each.
        """
        if level not in LEVELS:
            raise unknown_name("inertia level", level, LEVELS)
        one, two, three = LEVELS[level]
        second = self.second * two
        if stiffened and self.stiffening is not None:
            for (a, b), K in zip(PRODUCTS, self.stiffening.centrifugal, strict=True):
                second[..., a, b] -= 0.5 * K
                second[..., b, a] -= 0.5 * K
        return self.first * one, second, self.gyroscopic * three


def inertia(terms: InertiaTerms, J0: Array, q: Array, level: str = "full") -> Array:
    """J(q) (3, 3) [kg m2]; `J0` of the undeformed body, modal coordinates q (m,) [m], m >= k."""
    J1, J2, _ = terms.kept(level)
    q = q[: terms.modes]
    return J0 + np.tensordot(q, J1 + np.tensordot(q, J2, 1), 1)


def momentum(terms: InertiaTerms, J0: Array, q: Array, qd: Array, w: Array, level: str = "full") -> Array:
    """Angular momentum L = J(q) w + h (3,) [N m s] about the centre of mass, body axes; rates `qd` (m,) [m/s], `w` (3,)
    [rad/s] body axes."""
    return inertia(terms, J0, q, level) @ w + _cross(terms.kept(level)[2], q, qd)


def kinetic_energy(terms: InertiaTerms, J0: Array, q: Array, qd: Array, w: Array, level: str = "full") -> float:
    """w.J w/2 + w.h + |qd|^2/2 [J]: of turning and deforming; the m v.v/2 of the centre of mass is not in it."""
    h = _cross(terms.kept(level)[2], q, qd)
    return float(0.5 * w @ inertia(terms, J0, q, level) @ w + w @ h + 0.5 * qd @ qd)


def body_torque(
    terms: InertiaTerms,
    J0: Array,
    q: Array,
    qd: Array,
    qdd: Array,
    w: Array,
    wdot: Array,
    level: str = "full",
) -> Array:
    """dL/dt + w x L (3,) [N m]: the torque about the centre of mass that this motion needs, body axes."""
    J1, J2, G = terms.kept(level)
    k = terms.modes
    q, qd, qdd = q[:k], qd[:k], qdd[:k]
    bent = np.tensordot(q, J2, 1)
    J = J0 + np.tensordot(q, J1 + bent, 1)
    J_rate = np.tensordot(qd, J1 + 2.0 * bent, 1)
    L = J @ w + _cross(G, q, qd)
    # qd x qd drops out of the rate of h, as G is antisymmetric
    return J @ wdot + J_rate @ w + _cross(G, q, qdd) + np.cross(w, L)


def modal_forces(terms: InertiaTerms, q: Array, qd: Array, w: Array, wdot: Array, level: str = "full") -> Array:
    """What stands beside qddot + c qdot + k q on the left of the modes' equations (m,) [N]: Coriolis, Euler and
    centrifugal terms; zero for the modes beyond the first k. Geometric stiffening is not in it."""
    J1, J2, G = terms.kept(level)
    k = terms.modes
    found = np.zeros(len(q))
    found[:k] = (
        2.0 * np.einsum("a,ija,i->j", w, G, qd[:k])
        + np.einsum("a,ija,i->j", wdot, G, q[:k])
        - 0.5 * np.einsum("a,jab,b->j", w, J1, w)
        - np.einsum("a,ijab,b,i->j", w, J2, w, q[:k])
    )
    return found


def _cross(G: Array, q: Array, qd: Array) -> Array:
    """sum_ij q_i qd_j G_ij (3,): of q and qd the momentum h."""
    k = len(G)
    return np.einsum("i,ija,j->a", q[:k], G, qd[:k])
