r"""Inertia of a deforming body: the invariants of its modes, and the coupling forces of rotation and deformation.

A point X of the body (about the centre of mass, body axes) moves to `X + u`, `u = sum_i q_i phi_i(X)`; the body rotates
with w. Its velocity, in body axes, is `v + w x (X + u) + udot`. In a Tisserand frame the modes have no momentum, `int
phi_i dm = 0`, `int X x phi_i dm = 0`, and with `int phi_i.phi_j dm = delta_ij` the kinetic energy is

    T = m v.v/2 + w.J(q) w/2 + w.h(q, qdot) + |qdot|^2/2,
    J(q) = J0 + sum_i q_i J1_i + sum_ij q_i q_j J2_ij,      h = int u x udot dm = sum_ij q_i qdot_j G_ij,
    J1_i = int 2 (X.phi_i) 1 - X phi_i^T - phi_i X^T dm,
    J2_ij = int (phi_i.phi_j) 1 - (phi_i phi_j^T + phi_j phi_i^T)/2 dm,      G_ij = int phi_i x phi_j dm = -G_ji,

exactly: J is of second degree in q. The linear momentum is m v for any q. Lagrange's equations, with the angular
momentum `L = J w + h`, forces f_j on the modes and M on the body:

    Ldot + w x L = M,        Ldot = J wdot + Jdot w + hdot,
    qddot_j + 2 sum_i (w.G_ij) qdot_i + sum_i (wdot.G_ij) q_i - w.J1_j w/2 - sum_i (w.J2_ij w) q_i + ... = f_j,

the added terms of a mode being Coriolis, Euler and centrifugal forces. (Shabana, Dynamics of Multibody Systems, ch. 5,
writes the same integrals as inertia shape integrals.) `w.J2_ij w` is the Gram matrix of `w x phi_i`, not negative.

**Levels** omit J1, J2 or G in T itself; the forces are derived from the remaining T. Each is therefore a mechanical
system of its own, and conserves energy and angular momentum: "constant" keeps none, "deformed" J1 and J2, "gyroscopic"
J1 and G, "full" all three. The terms are called "centrifugal" (J1), "deformed inertia" (J2) and "gyroscopic" (G).
Limits: w = 0 leaves G's Euler forces alone, |q| = 0 the centrifugal load w.J1_j w/2; the terms compare with the elastic
force as (w/omega_j)^2 (J2) and w/omega_j (G), so slow rotation of a stiff body requires none.

**Geometric stiffening.** A prestress sigma0 adds `sum_c int d_a phi_i^c sigma0_ab d_b phi_j^c dV` to the stiffness;
sigma0 is linear in its causes, the centrifugal load (products of w) and the loads F on the interfaces:

    K_geo = sum_ab w_a w_b Kc_ab + sum over interfaces and components F_k Kf_k,      force on the modes - K_geo q.

All arrays are in the axes of the user frame, moments about the centre of mass; modes have modal mass 1 kg, so that q is
in m, J1 in kg m, J2 and G in kg. They cover the first k of the m modes; these terms are neglected for the others.

Membrane. The membrane energy of a body: the second-order stretching of its fibres that cannot be relieved.

Deflections stretch fibres by w'^2/2. A beam whose ends may move, or a developable bend of a plate, relieves that by
motion along itself; a plate clamped along its rim, or bent in both directions, cannot. The remaining energy is the
square of a strain that is quadratic in the modal coordinates q, represented by its R largest principal parts (derived
in `warpffrf.offline.inertia.membrane`):

    V4 = 1/2 sum_r e_r^2,        e_r = q.L_r q/2,        y_r = L_r q,
    dV4/dq = sum_r e_r y_r,      d2V4/dq2 = sum_r y_r y_r^T + e_r L_r.

It is never negative, and so is the first part of its tangent. q is in m at modal mass 1 kg, L_r in sqrt(J)/m^2, e_r in
sqrt(J).

Second order motion. Displacement of the points of a body of second order in the modes, in few shapes.

A body with large deflections moves by u = sum_i q_i phi_i + Theta(q, q): Theta is the shortening by bending and the
motion that relieves stretching (derived in `warpffrf.offline.inertia.second_order`). Of the pairs of modes, each a
field, the R principal ones in the mass are kept (`warpffrf.offline.inertia.second_order`),

    Theta(q, q) = sum_s g_s B_s,      g_s = q.S_s q/2,      dTheta = sum_s (q.S_s dq) B_s,

with shapes B_s of modal mass 1 kg, as those of modes, orthogonal to one another: g_s is in m like q, S_s in 1/m. In the
rates gd_s = q.S_s qd and with the overlap C_is = int phi_i.B_s dm the kinetic energy of a body that does not rotate is

    T = |qd|^2/2 + qd.C gd + |gd|^2/2,

of which simulations include the first part.

Interface motion. Motion of an interface by the modes: its only definition on the host.

Components d_c of the translation and rotation (u, theta) in body axes follow from the mode shapes Phi_c and, of a body
that loads stiffen, the geometric stiffness K_c of a unit load (`warpffrf.model.reduced.inertia.GeometricStiffness`),

    d_c = Phi_c.q - q.K_c q/2,      dd_c/dq = Phi_c - K_c q,

as used by the constraint rows (`warpffrf_kernels.bodies.interfaces`). The second part is the shortening by deflection:
the work of a load F on it is the energy -F.d = F q.K q/2 of the prestress, so that both are required together.

A *body* here is any object with `reduced`, a reduced body, and `stiffening`, whether loads stiffen it: a body of a
scene or a `BodyView` of results.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from warpffrf.model.errors import InputError, require_array, unknown_name

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
    the membrane energy (`warpffrf.model.reduced.inertia`), None of a body reduced without; `motion`: the second-order
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
        Raises `InputError` for an unknown interface.
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
    (k, k, 3) [kg], and the `stiffening` if requested. See the module docstring."""

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
        """J1, J2, G with those that `level` omits set to zero; raises `InputError` for an unknown level.

        `stiffened`: J2 - Kc, the energy q.K_c q/2 of stiffening by rotation with its sign in w.J w/2; a mixed product
        of w is split in halves over two entries of J2.
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
    """w.J w/2 + w.h + |qd|^2/2 [J]: of rotation and deformation, without m v.v/2 of the centre of mass."""
    h = _cross(terms.kept(level)[2], q, qd)
    return float(0.5 * w @ inertia(terms, J0, q, level) @ w + w @ h + 0.5 * qd @ qd)


def body_torque(
    terms: InertiaTerms, J0: Array, q: Array, qd: Array, qdd: Array, w: Array, wdot: Array, level: str = "full"
) -> Array:
    """dL/dt + w x L (3,) [N m]: the torque about the centre of mass required for this motion, body axes."""
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
    """Terms added to qddot + c qdot + k q on the left of the modes' equations (m,) [N]: Coriolis, Euler and
    centrifugal; zero for the modes beyond the first k. Geometric stiffening is not included."""
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


def membrane_amplitudes(forms: Array, q: Array) -> Array:
    """e_r (R,) [sqrt(J)] of the `forms` L (R, k, k) at the first k of the coordinates q (m,) [m]."""
    q = q[: forms.shape[1]]
    return 0.5 * (forms @ q) @ q


def membrane_forms(body: Any) -> Array | None:
    """L (R, k, k) of a body with stiffening, None for others, and for one without membrane energy.

    A *body* is any object with `reduced` and `stiffening`, as in `warpffrf.model.reduced.inertia`.
    """
    terms = body.reduced.inertia_terms if body.stiffening and body.reduced is not None else None
    return None if terms is None or terms.stiffening is None else terms.stiffening.membrane


def membrane_energies(forms: Array, q: Array) -> Array:
    """V4 (T,) [J] of rows of coordinates q (T, m)."""
    k = forms.shape[1]
    e = 0.5 * np.einsum("ti,rij,tj->tr", q[:, :k], forms, q[:, :k], optimize=True)
    return 0.5 * np.sum(e * e, axis=1)


@dataclass(frozen=True, eq=False)
class SecondOrderMotion:
    """Amplitudes of the shapes of second order: `forms` S (R, k, k) [1/m], symmetric, of the first k modes, and the
    `overlap` C (k, R) of these modes with the shapes. The shapes themselves are in `DisplaySurface.second_order`."""

    forms: Array
    overlap: Array

    def __post_init__(self) -> None:
        require_array(self.forms, "second-order motion", (None, None, None))
        if self.forms.shape[1] != self.forms.shape[2] or self.overlap.shape != self.forms.shape[1::-1]:
            raise InputError(
                f"second-order motion: forms {self.forms.shape} and overlap {self.overlap.shape} are not (R, k, k) and "
                "(k, R)"
            )

    def amplitudes(self, q: Array) -> Array:
        """g (..., R) [m] at modal coordinates q (..., m) [m]."""
        return 0.5 * self.between(q, q)

    def between(self, x: Array, y: Array) -> Array:
        """x.S_s y (..., R) [m] of x, y (..., m) [m]: of y a rate or a variation, at x, that of g."""
        k = self.forms.shape[1]
        return np.einsum("...i,sij,...j->...s", x[..., :k], self.forms, y[..., :k], optimize=True)

    def kinetic_energy(self, q: Array, qd: Array) -> Array:
        """Contribution to T (...) [J] in addition to |qd|^2/2, at q (..., m) [m] and rates qd (..., m) [m/s]."""
        gd = self.between(q, qd)
        along = np.einsum("...i,is,...s->...", qd[..., : len(self.overlap)], self.overlap, gd, optimize=True)
        return along + 0.5 * np.sum(gd * gd, axis=-1)


def motion_of(body: Any) -> SecondOrderMotion | None:
    """The second-order motion of a body with stiffening, None for others, and for one reduced without.

    A *body* is any object with `reduced` and `stiffening`, as in `warpffrf.model.reduced.inertia`.
    """
    terms = body.reduced.inertia_terms if body.stiffening and body.reduced is not None else None
    return None if terms is None or terms.stiffening is None else terms.stiffening.motion


def skin_displacement(body: Any, q: Array) -> Array:
    """Phi q + Theta(q, q) (n, 3) [m, user axes] at the points of the skin of a flexible body."""
    surface, motion = body.reduced.surface, motion_of(body)
    u = np.einsum("m,mnd->nd", q, surface.modes)  # without a copy of the modes in double precision
    if motion is not None and surface.second_order is not None:
        u += np.einsum("s,snd->nd", motion.amplitudes(q), surface.second_order)
    return u


def skin_variation(body: Any, q: Array, dq: Array) -> Array:
    """The change (n, 3) [m, user axes] of `skin_displacement` at q (m,) by small dq (m,), real or complex."""
    surface, motion = body.reduced.surface, motion_of(body)
    du = np.tensordot(dq, surface.modes, 1)
    if motion is not None and surface.second_order is not None:
        du = du + np.tensordot(motion.between(q, dq), surface.second_order, 1)
    return du


def interface_motion(body: Any, name: str, q: Array) -> Array:
    """Translation and rotation (..., 6) [m, rad] of interface `name` at modal coordinates q (..., m), body axes."""
    return q @ body.reduced.interfaces[name].modes - 0.5 * second_order(body, name, q, q)


def interface_slope(body: Any, name: str, q: Array) -> Array:
    """The derivative (m, 6) of `interface_motion` by the modal coordinates at q (m,)."""
    slope = np.array(body.reduced.interfaces[name].modes, dtype=float)
    if body.stiffening:
        K = body.reduced.inertia_terms.stiffening.interfaces[name]
        k = K.shape[1]
        slope[:k] -= np.einsum("cij,j->ic", K, q[:k])
    return slope


def second_order(body: Any, name: str, x: Array, y: Array) -> Array:
    """x.K_c y (..., 6) for x, y (..., m) [m]; zeros for a body without stiffening."""
    if not body.stiffening:
        return np.zeros((*x.shape[:-1], 6))
    K = body.reduced.inertia_terms.stiffening.interfaces[name]
    k = K.shape[1]
    return np.einsum("...i,cij,...j->...c", x[..., :k], K, y[..., :k], optimize=True)
