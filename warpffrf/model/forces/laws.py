"""The terms in which force elements describe themselves.

A *spring law* acts on coordinates e (n,) of two markers a and b (frames fixed to bodies or interfaces, with axes u_x,
u_y, u_z of a and w_x, w_y, w_z of b in the world, at x_a and x_b):

    lambda = K (e - reference) + D de/dt + preload,      generalised force -C^T lambda,   C the gradient of e.

Kinds of coordinates:

    "translation"  u_i . (x_b - x_a)                                     [m]
    "distance"     |x_b - x_a|                                           [m]
    "direction"    u_i . w_j                                             [-]
    "angle", "second_angle", "twist"   see `warpffrf.model.joints.base`, but not limited to one revolution   [rad]
    "bushing"      v[:3] . d + v[3:] . phi                               d = A_a^T (x_b - x_a), exp(phi^) = A_a^T A_b

Forces follow the exact gradients of these, so with K symmetric the work of the law on any path is the change of
`1/2 (e - reference)^T K (e - reference) + preload . (e - reference)` plus the dissipation of the dampers, `de/dt^T D
de/dt`. The skew part of K stores no energy: its work depends on the path, and the energy ledger counts it as work of
forces.

A nonlinear law has *characteristics* F_i of deformation and G_i of rate (`characteristics`) in addition,

    lambda_i = K_ii (e_i - reference_i) + F_i(e_i - reference_i) + D_ii de_i/dt + G_i(de_i/dt) + preload_i,

each coordinate separately. It additionally stores `V_i(e_i - reference_i)`, V_i the potential of F_i, and dissipates
`G_i(de_i/dt) de_i/dt`. Its tangents are `K_ii + F_i'` and `D_ii + G_i'`.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from warpffrf.model.errors import InputError, require_array, require_number
from warpffrf.model.forces.characteristics import CHARACTERISTICS, ROUND_OFF, Characteristic

ZERO_STIFFNESS = 1e-10  # of an equilibrated matrix with unit diagonal: rounding of input, not a stiffness


@dataclass(frozen=True, eq=False)
class Coordinate:
    """One coordinate of a spring law: its kind, the axes it takes of a (`i`) and b (`j`), or its `vector` (6,)."""

    kind: str
    i: int = 0
    j: int = 0
    vector: np.ndarray = field(default_factory=lambda: np.zeros(6))


@dataclass(frozen=True, eq=False)
class SpringLaw:
    """Coordinates of two markers and their law, see the module.

    `ports` carry the markers at `points` (2, 3) [m, user frames] with `axes` (2, 3, 3, columns, user frames); with a
    `joint` its own markers are used. stiffness [N/m, N m/rad] and damping [N s/m, N m s/rad] (n, n); reference [m, rad]
    and preload [N, N m] (n,). The first `sprung` coordinates have stiffness, the rest are dampers only. `expand` (k, n)
    gives the deformation that a result shows from the coordinates; None: the coordinates themselves. `elastic`,
    `viscous` (n,): the characteristics F_i and G_i, None where there is none; empty of a linear law. With them
    stiffness and damping are diagonal.
    """

    coordinates: tuple[Coordinate, ...]
    stiffness: np.ndarray
    damping: np.ndarray
    reference: np.ndarray
    preload: np.ndarray
    sprung: int
    ports: tuple[Any, Any]
    points: tuple[np.ndarray, np.ndarray] | None = None
    axes: tuple[np.ndarray, np.ndarray] | None = None
    joint: Any = None
    expand: np.ndarray | None = None
    elastic: tuple[Characteristic | None, ...] = ()
    viscous: tuple[Characteristic | None, ...] = ()

    def force(self, e: np.ndarray, rate: np.ndarray) -> np.ndarray:
        """lambda (n,) [N, N m] at the coordinates e (n,) [m, rad] and their rates (n,) [m/s, rad/s]."""
        off = e - self.reference
        lam = self.stiffness @ off + self.damping @ rate + self.preload
        for curves, x in ((self.elastic, off), (self.viscous, rate)):
            for i, curve in enumerate(curves):
                if curve is not None:
                    lam[i] += curve.force(x[i])
        return lam

    def slopes(self, e: np.ndarray, rate: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Slopes (n,) of the characteristics alone, F' [N/m, N m/rad] and G' [N s/m, N m s/rad], at the coordinates e
        (n,) [m, rad] and their rates (n,) [m/s, rad/s]."""
        found = np.zeros((2, len(self.coordinates)))
        for line, curves, x in zip(found, (self.elastic, self.viscous), (e - self.reference, rate), strict=True):
            for i, curve in enumerate(curves):
                if curve is not None:
                    line[i] = curve.slope(x[i])
        return found[0], found[1]

    def potential(self, e: np.ndarray) -> np.ndarray:
        """Energy (...) [J] stored at the coordinates e (..., n), including that of the preload."""
        off = e - self.reference
        total = 0.5 * np.einsum("...i,ij,...j->...", off, self.stiffness, off) + off @ self.preload
        for i, curve in enumerate(self.elastic):
            if curve is not None:
                total = total + curve.energy(off[..., i])
        return total


@dataclass(frozen=True, eq=False)
class SlipLaw:
    """Friction between the two sides of a `joint`: normal loads and sliding coordinates.

    With s the one or two `coordinates` and W = diag(`weights`) the sides slide with the velocity v = W ds/dt [m/s], and
    the force -W f on the coordinates brakes them, |f| at most

        bound = mu (radial (|N_1| + |N_2|) + axial |R_z| + spin |M_z|) + load_independent,

    mu and the law of v those of `friction`. R and M, about the joint's point, are what its rows exert on the second
    body, drives left out. With `bearing_length` L the part of them across the axis e_z is carried at two points at
    +-L/2 along it, N = R/2 +- e_z x M/L; with None at one, N = R/2, and M across the axis causes no friction. radial
    [-], axial [-] and spin [1/m] multiply, load_independent [N] adds.
    """

    joint: Any
    friction: Any
    coordinates: tuple[Coordinate, ...]
    weights: tuple[float, ...]
    radial: float
    axial: float
    spin: float
    load_independent: float
    bearing_length: float | None

    @property
    def ports(self) -> tuple[Any, Any]:
        """Those of the joint."""
        return self.joint.ports

    def bound(self, R: np.ndarray, M: np.ndarray, axis: np.ndarray) -> float:
        """The bound [N] for the reaction R (3,) [N] and M (3,) [N m], `axis` (3,) being e_z, all in the same axes."""
        across = 0.5 * (R - (R @ axis) * axis)
        couple = np.cross(axis, M) / self.bearing_length if self.bearing_length else np.zeros(3)
        load = self.radial * (np.linalg.norm(across + couple) + np.linalg.norm(across - couple))
        load += self.axial * abs(R @ axis) + self.spin * abs(M @ axis)
        return float(self.load_independent + self.friction.static_coefficient * load)


@dataclass(frozen=True, eq=False)
class TensionLaw:
    """A pull `force`(t) [N] on one coordinate of a `joint`, lambda in the words of the module, until the time `lock_at`
    [s] (infinite: always); from then on the coordinate is constant (`pretension`)."""

    joint: Any
    coordinate: Coordinate
    force: Any
    lock_at: float

    @property
    def ports(self) -> tuple[Any, Any]:
        """Those of the joint."""
        return self.joint.ports


@dataclass(frozen=True, eq=False)
class PointLoad:
    """A force [N] (`what` "force") or torque [N m] ("torque") at a port, its `components` three signals along the axes
    `frame`."""

    what: str
    port: Any
    frame: str
    components: tuple[Any, Any, Any]


@dataclass(frozen=True, eq=False)
class BodyLoad:
    """`signal` times constants in body axes: force (3,), torque (3,) about the user origin, modal forces (m,)."""

    body: Any
    force: np.ndarray
    torque: np.ndarray
    modal: np.ndarray
    signal: Any


def require_stiffness(value: Any, name: str) -> float | Characteristic:
    """`value` as a number, not negative, or the characteristic that it is; else `InputError` naming `name`."""
    if isinstance(value, Characteristic):
        return value
    if np.ndim(value):
        known = ", ".join(cls.__name__ for cls in CHARACTERISTICS.values())
        raise InputError(f"{name} must be a number, or one of {known}, got {value!r}; points are a ForceTable(points)")
    return require_number(value, name, non_negative=True)


def require_damping(value: Any, name: str) -> float | Characteristic:
    """As `require_stiffness`; a characteristic must be zero at rate zero."""
    law = require_stiffness(value, name)
    if isinstance(law, Characteristic):
        at_rest, size = float(law.force(0.0)), np.abs(law.force(law.sign_changes())).max()
        if abs(at_rest) > ROUND_OFF * size:
            raise InputError(
                f"{name} must be zero where the rate is zero, its force there is {at_rest:g}; a force that stays at "
                "rest is a preload"
            )
    return law


def vanishes(law: float | Characteristic) -> bool:
    """Whether a stiffness or damping is zero."""
    return law.vanishes if isinstance(law, Characteristic) else law == 0.0


def described(law: Any) -> Any:
    """A stiffness, damping or preload as plain data for hashing."""
    return law.describe() if hasattr(law, "describe") else law


def tension_of(item: Any) -> TensionLaw | None:
    """The tension over time of a force element, alone or in addition to its spring law; None where it has none."""
    return item.tension() if hasattr(item, "tension") else None


def split(laws: Sequence[float | Characteristic]) -> tuple[np.ndarray, tuple[Characteristic | None, ...]]:
    """Numbers (n,), 0 for characteristics, and the characteristics, None for numbers."""
    curves = tuple(law if isinstance(law, Characteristic) else None for law in laws)
    return np.array([0.0 if isinstance(law, Characteristic) else law for law in laws]), curves


def scalar_law(
    coordinate: Coordinate,
    stiffness: float | Characteristic,
    damping: float | Characteristic,
    reference: float,
    preload: float,
    **where: Any,
) -> SpringLaw:
    """The `SpringLaw` of one `coordinate`: stiffness [N/m, N m/rad] and damping [N s/m, N m s/rad], numbers or
    characteristics, about the reference [m, rad], and a preload [N, N m]. where: `ports`, and `points` and `axes`, or a
    `joint`, of the law."""
    (k, elastic), (d, viscous) = split([stiffness]), split([damping])
    curves = {} if elastic == viscous == (None,) else {"elastic": elastic, "viscous": viscous}
    return SpringLaw(
        (coordinate,), np.diag(k), np.diag(d), np.array([reference]), np.array([preload]),
        int(not vanishes(stiffness)), **curves, **where,
    )  # fmt: skip


def matrix_6x6(value: Any, name: str) -> np.ndarray:
    """`value` as a (6, 6) matrix, or the diagonal (6,) of one, whose symmetric part is positive semidefinite.

    Raises `InputError` for other shapes, for a negative stiffness in any direction, and for a coordinate without any
    stiffness of its own that is coupled to others.
    """
    A = np.diag(require_array(value, name, (6,))) if np.ndim(value) == 1 else require_array(value, name, (6, 6))
    S, scale = _equilibrated(A)
    bare = np.diag(A) == 0.0
    if np.any(A[bare]) or np.any(A[:, bare]):
        row = int(np.flatnonzero(bare & (np.any(A, axis=1) | np.any(A, axis=0)))[0])
        raise InputError(f"{name}: entry ({row}, {row}) is zero but row or column {row} is not; give it an entry")
    smallest = float(np.linalg.eigvalsh(0.5 * (S + S.T))[0])
    if np.any(np.diag(A) < 0.0) or smallest < -ZERO_STIFFNESS:
        raise InputError(
            f"{name} must not be negative in any direction, the smallest eigenvalue of its symmetric part with unit "
            f"diagonal is {smallest:.3g}"
        )
    return A


def split_directions(K: np.ndarray, D: np.ndarray) -> tuple[np.ndarray, np.ndarray, int]:
    """Directions in which a law acts: `Q` (6, n) gives coordinates `Q^T e`, `W` (6, n) their dual, and how many are
    sprung.

    A law with K or D of lower rank acts on fewer than six coordinates: those that K resists first, then those that only
    D does. Where rank is lost by coordinates without entries, the coordinates stay the six themselves; else they are
    combinations, orthonormal after scaling by the roots of the diagonal. With the symmetric part of K semidefinite its
    null space is that of K^T too: x^T K x = 0 gives K_s x = 0, so K x = 0 gives K^T x = 0. In c = Q^T e the matrices
    are `W^T K W` and `W^T D W`.
    """
    scale = np.ones(6)
    for A in (D, K):
        has = np.diag(A) > 0.0
        scale[has] = 1.0 / np.sqrt(np.diag(A)[has])
    first = _range(K, scale, np.eye(6))
    rest = _complement(first)
    second = _range(D, scale, rest)
    V = np.hstack([first, second])
    if np.all(np.sum(V != 0.0, axis=0) == 1):
        return V, V, first.shape[1]
    return V / scale[:, None], V * scale[:, None], first.shape[1]


def _equilibrated(A: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    d = np.diag(A)
    scale = 1.0 / np.sqrt(np.where(d > 0.0, d, 1.0))
    return scale[:, None] * A * scale, scale


def _range(A: np.ndarray, scale: np.ndarray, within: np.ndarray) -> np.ndarray:
    """Orthonormal directions (6, n) inside the span of the orthonormal `within` that the scaled `A` resists."""
    S = within.T @ (scale[:, None] * A * scale) @ within
    S = 0.5 * (S + S.T)
    if not S.size:
        return within
    size = max(float(np.abs(S).max()), np.finfo(float).tiny)
    axes = np.flatnonzero(np.diag(S) > ZERO_STIFFNESS * size)
    values, vectors = np.linalg.eigh(S / size)
    if np.sum(values > ZERO_STIFFNESS) == len(axes):
        return within[:, axes]
    return within @ vectors[:, values > ZERO_STIFFNESS]


def _complement(V: np.ndarray) -> np.ndarray:
    """Orthonormal complement (6, 6 - n) of orthonormal columns; unit vectors for unit vectors."""
    if np.all(np.sum(V != 0.0, axis=0) == 1):
        return np.eye(6)[:, ~np.any(V != 0.0, axis=1)]
    return np.linalg.svd(V)[0][:, V.shape[1] :]
