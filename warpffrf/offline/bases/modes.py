r"""Vibration modes of a free elastic body by block Lanczos on its flexibility.

The operator `T = G M` with `G = P^H K^+ P` is self-adjoint in the M inner product; its eigenvalues are `1/omega^2`
for the elastic modes and 0 for the rigid ones, so the lowest elastic modes are the largest eigenvalues and the rigid
modes never appear. A block Krylov space with full M-orthogonalisation is used (Golub and Underwood 1977; Parlett
1998, ch. 13): blocks find multiple eigenvalues, common in round bodies, of which a single vector finds one each.

With `T Q = Q H + Q_next S E^H` (E picks the last block) a Ritz pair `(nu, Q y)` has residual `|S y_last|` in the M
norm.

Global modes: vibration modes and interface attachment modes, jointly M- and K-orthonormal.

An *attachment mode* is the inertia-relief response to a unit force or moment on an interface, `a = P^H K^+ P F_I`. With
`a` in the span of `Phi_g` the residual local response does not move the interface: for a load f its interface
coordinates are `F_I^H (G - Phi_g (Phi_g^H K Phi_g)^-1 Phi_g^H) f = a^H f - a^H f = 0`.

The union of the attachment modes A and many vibration modes V is nearly dependent (condition 7e15 was met). It is
orthonormalised in the *energy* inner product, the attachment modes first, so that they stay in the span to round-off:

1. A is scaled to unit energy; eigenvectors of `A^H K A` below `dependent^2` are dropped, the others scaled to unit
   energy;
2. V, scaled to unit energy, is made orthogonal to A, `V := V - A A^H K V`, twice, and treated in the same way: dropped
   directions are combinations of vibration modes contained in A. Both are processed a second time, which must not
   reduce any norm;
3. now `Q = [A V]` has `Q^H K Q = 1`; with `Q^H M Q = Y mu Y^H` the modes are `Phi = Q Y mu^-1/2`: M-orthonormal,
   K-orthogonal, and `omega^2 = 1/mu` is the Rayleigh-Ritz frequency.

Problem. Input and output of every basis.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np

from warpffrf.model.errors import InputError
from warpffrf.model.mesh import Mesh
from warpffrf.offline.elastic import Array, ElasticModel
from warpffrf.offline.interfaces import InterfaceSystem
from warpffrf.offline.products import Limits

BLOCK = 8  # vectors per block: more than the multiplicity due to symmetry alone, and efficient right-hand sides
RESIDUAL = 1e-11  # of the eigenvalue: eigenvectors to about 1e-9 for neighbours 1 % apart
ROUND_OFF = 4e-15  # of the largest eigenvalue: residuals below it are noise of the operator itself
CHECKED = 1.05  # growth of the space after which the Ritz values are checked again
SEEN_BEYOND = 1e-3  # relative residual at which the first mode beyond those requested counts as found: none is missed
EXHAUSTED = 1e-11  # of the largest eigenvalue: a new direction below it is noise, the Krylov space is invariant
ORTHOGONAL = 1e-14  # M-product of a new direction with the basis above which another pass is made
SAME_FREQUENCY = 1e-6  # relative distance of frequencies that are one multiple frequency


def vibration_modes(
    model: ElasticModel, *, count: int | None = None, omega_max: float | None = None, residual: float = RESIDUAL
) -> tuple[Array, Array]:
    """Lowest elastic modes: `omega` (m,) [rad/s] ascending and M-orthonormal `Phi` (n, m).

    `count` modes at least (possibly a few more), or all up to `omega_max`; both: the fewer. All modes of the mesh if it
    has fewer. A mode is accepted if its residual is below `residual` of its eigenvalue.
    """
    if count == 0 or (count is None and omega_max is None):
        return np.zeros(0), np.zeros((model.size, 0), dtype=_dtype(model))
    krylov = _Krylov(model)
    checked_at = 0
    while True:
        more = krylov.expand()
        if more and len(krylov.H) < CHECKED * checked_at:
            continue
        checked_at = len(krylov.H)
        nu, Y, rest = krylov.ritz()
        wanted = np.ones(len(nu), dtype=bool) if omega_max is None else nu * omega_max**2 >= 1.0
        if count is not None:
            wanted[count:] = False
        m = int(wanted.sum())
        accurate = bool(np.all(rest[:m] <= residual * nu[:m] + ROUND_OFF * nu[0]))
        beyond = (m < len(nu) and rest[m] <= SEEN_BEYOND * nu[m]) or (count is not None and m == count < len(nu))
        if not more or (accurate and beyond):
            positive = nu[:m] > EXHAUSTED * nu[0] if len(nu) else np.zeros(0, dtype=bool)
            return 1.0 / np.sqrt(nu[:m][positive]), krylov.Q @ Y[:, :m][:, positive]


class _Krylov:
    """The growing basis Q (n, d), M-orthonormal and M-orthogonal to rigid motion, and H = Q^H M T Q.

    Rigid modes precede Q in the store, so that one product projects a block off both.
    """

    def __init__(self, model: ElasticModel) -> None:
        self.model = model
        n, rigid = model.R.shape
        width = min(BLOCK, max(n - rigid, 1))
        rng = np.random.default_rng(n)  # a fixed start: the same input gives bitwise identical modes
        start = rng.standard_normal((n, width)).astype(_dtype(model))
        if np.iscomplexobj(start):
            start = start + 1j * rng.standard_normal((n, width))
        start = model.flexibility(model.M @ start)
        self._store = np.zeros((n, rigid + 4 * width), dtype=start.dtype, order="F")
        self._store[:, :rigid] = model.R
        self._rigid, self._used, self._recent = rigid, rigid, 0
        self.H = np.zeros((0, 0), dtype=start.dtype)
        self._orthonormal(start)

    @property
    def Q(self) -> Array:
        return self._store[:, self._rigid : self._used]

    def expand(self) -> bool:
        """Add the pending block to the basis and prepare the next; False if the space is exhausted."""
        width = self._next.shape[1]
        if not width:
            return False
        if self._used + width > self._store.shape[1]:
            grown = np.zeros((len(self._store), 2 * self._store.shape[1]), dtype=self._store.dtype, order="F")
            grown[:, : self._used] = self._store[:, : self._used]
            self._store = grown
        self._store[:, self._used : self._used + width] = self._next
        self._used += width
        Z = self.model.flexibility(self._M_next)
        Z, column = self._without_recent(Z, width)
        column += self._orthonormal(Z, float(np.max(np.abs(np.diag(column[-width:])))))
        size = self._used - self._rigid
        H = np.zeros((size, size), dtype=column.dtype)
        H[:-width, :-width] = self.H
        H[:, -width:] = column
        H[-width:, :] = column.conj().T
        H[-width:, -width:] = _hermitian(column[-width:])
        self.H = H
        self._recent = width
        return self._next.shape[1] > 0 and size < self.model.size - self._rigid

    def _without_recent(self, Z: Array, width: int) -> tuple[Array, Array]:
        """Z without its projections on the last two blocks, all that it has in exact arithmetic, and these projections
        as a column (d, w) of H."""
        part = slice(self._used - width - self._recent, self._used)
        found = self._store[:, part].conj().T @ (self.model.M @ Z)
        column = np.zeros((self._used - self._rigid, Z.shape[1]), dtype=found.dtype)
        column[-len(found) :] = found
        return Z - self._store[:, part] @ found, column

    def _orthonormal(self, Z: Array, scale: float = 0.0) -> Array:
        """Make the next block (n, w) of Z, M-orthogonal to the basis and M-orthonormal in itself, and S (w, columns of
        Z); returns the part of Z in the basis (d, columns of Z).

        A pass leaves round-off proportional to its input; its size is compared with the smallest direction kept,
        and another pass follows if it is not negligible.
        """
        M = self.model.M
        MZ = M @ Z
        before = _largest(Z, MZ)
        Z, inside = self._freed(Z, MZ)
        MZ = M @ Z
        values, vectors = np.linalg.eigh(_hermitian(Z.conj().T @ MZ))
        largest = max(scale, float(np.max(np.abs(np.diag(self.H)), initial=0.0))) or float(np.sqrt(values[-1]))
        keep = values > (EXHAUSTED * largest) ** 2
        combined = vectors[:, keep] / np.sqrt(values[keep])
        W, MW = Z @ combined, MZ @ combined
        while W.shape[1] and before * np.finfo(float).eps > ORTHOGONAL * np.sqrt(values[keep].min()):
            # directions that were mostly round-off shrink here and are removed as noise
            before = 1.0
            W, _ = self._freed(W, MW)
            MW = M @ W
            values, vectors = np.linalg.eigh(_hermitian(W.conj().T @ MW))
            keep = values > 0.5
            combined = vectors[:, keep] / np.sqrt(values[keep])
            W, MW = W @ combined, MW @ combined
        self._next, self._M_next, self._S = W, MW, W.conj().T @ MZ
        return inside[self._rigid :]

    def _freed(self, Z: Array, MZ: Array) -> tuple[Array, Array]:
        """Z without its M-projections on rigid motion and on the basis, and these projections."""
        basis = self._store[:, : self._used]
        inside = basis.conj().T @ MZ
        return Z - basis @ inside, inside

    def ritz(self) -> tuple[Array, Array, Array]:
        """Ritz values nu (d,) descending, vectors Y (d, d), residuals (d,)."""
        nu, Y = np.linalg.eigh(self.H)
        nu, Y = nu[::-1], Y[:, ::-1]
        last = self._S.shape[1]
        return nu, Y, np.linalg.norm(self._S @ Y[-last:], axis=0)


def _largest(Z: Array, MZ: Array) -> float:
    """Largest M-norm of the columns of Z."""
    return float(np.sqrt(max(np.max(np.real(np.einsum("nw,nw->w", Z.conj(), MZ)), initial=0.0), 0.0)))


def _dtype(model: ElasticModel) -> np.dtype:
    return np.result_type(model.K.dtype, model.M.dtype, model.R.dtype)


def _hermitian(A: Array) -> Array:
    return 0.5 * (A + A.conj().T)


def whole_multiples(omega: Array, count: int) -> int:
    """Number of leading frequencies to keep: `count`, raised if it would split a multiple frequency.

    `omega` (m,) ascending, with repeated entries for multiple frequencies.
    """
    kept = min(count, len(omega))
    while 0 < kept < len(omega) and omega[kept] - omega[kept - 1] <= SAME_FREQUENCY * omega[kept]:
        kept += 1
    return kept


# Energy norm of a unit-energy direction outside the others below which it is dropped: round-off of the Gram matrix,
# 1e-16 in its eigenvalues, is 1e-8 in a norm.
DEPENDENT = 3e-8
# Energy of a unit-energy direction that must remain after a second orthogonalisation: round-off shrinks.
MOSTLY_THERE = 0.5


def attachment_modes(model: ElasticModel, F: Array) -> Array:
    """Inertia-relief responses (n, a) to interface loads F (n, a)."""
    return model.flexibility(F)


def global_basis(model: ElasticModel, V: Array, A: Array, *, dependent: float = DEPENDENT) -> tuple[Array, Array, int]:
    """`omega` (m,) [rad/s] ascending, `Phi` (n, m), and the number of dropped directions.

    V (n, v): vibration modes, or the columns of any other basis; A (n, a): attachment modes; all M-orthogonal to rigid
    motion. A unit-energy direction whose part outside the others has an energy norm below `dependent` is dropped.
    """
    offered = V.shape[1] + A.shape[1]
    A = _independent(model, _scaled(model, A), None, dependent)
    V = _freed(model, _independent(model, _scaled(model, V), A, dependent), A)
    Q = np.concatenate([A, V], axis=1)
    if not Q.shape[1]:
        return np.zeros(0), Q, offered
    mu, Y = np.linalg.eigh(_hermitian(Q.conj().T @ (model.M @ Q)))
    mu, Y = mu[::-1], Y[:, ::-1]
    return 1.0 / np.sqrt(mu), Q @ (Y / np.sqrt(mu)), offered - Q.shape[1]


def _scaled(model: ElasticModel, U: Array) -> Array:
    """Columns scaled to unit energy; those without energy, as of a load that causes no strain, become zero."""
    energy = np.real(np.einsum("na,na->a", U.conj(), model.K @ U))
    scale = np.zeros_like(energy)
    scale[energy > 0.0] = 1.0 / np.sqrt(energy[energy > 0.0])
    return U * scale


def _freed(model: ElasticModel, U: Array, A: Array | None) -> Array:
    """U without its K-projection on the K-orthonormal A, and without rigid motion: that has no energy, so that scaling
    to unit energy would amplify its round-off."""
    for _ in range(2):  # twice is enough (Kahan, Parlett)
        U = model.without_rigid(U if A is None else U - A @ (A.conj().T @ (model.K @ U)))
    return U


def _independent(model: ElasticModel, U: Array, A: Array | None, dependent: float) -> Array:
    """K-orthonormal basis of the columns of U outside A, without directions of energy norm below `dependent`."""
    for least in (dependent**2, MOSTLY_THERE):  # the second pass restores the orthogonality lost to small eigenvalues
        U = _freed(model, U, A)
        values, vectors = np.linalg.eigh(_hermitian(U.conj().T @ (model.K @ U)))
        keep = values > least
        U = U @ (vectors[:, keep] / np.sqrt(values[keep]))
    return U


def missing_energy(model: ElasticModel, V: Array, A: Array, *, dependent: float = DEPENDENT) -> float:
    """Largest energy norm (0 to 1) of a unit-energy column of A outside the span of V: the part of A missing in V."""
    if not A.shape[1]:
        return 0.0
    A, V = _scaled(model, A), _independent(model, _scaled(model, V), None, dependent)
    rest = _freed(model, A, V)
    return float(np.sqrt(max(np.max(np.real(np.einsum("na,na->a", rest.conj(), model.K @ rest))), 0.0)))


AHEAD = 4  # additional modes computed to detect whether a multiple frequency would be split


@dataclass(frozen=True, eq=False)
class BasisProblem:
    """Input of a basis: the free constrained body `model` (n dofs), the `system` of its interfaces with loads F
    (n, a), the `limits` of `reduce`, the `attachments` G F (n, a), displacements [m] under these loads, and the `mesh`,
    for bases that use facets."""

    model: ElasticModel
    system: InterfaceSystem
    limits: Limits
    attachments: Array
    mesh: Mesh | None = None

    @property
    def elastic_dofs(self) -> int:
        """Dofs minus rigid motions: the upper limit of the size of any basis."""
        return self.model.size - self.model.R.shape[1]

    def unit_loads(self) -> tuple[Array, Array]:
        """Interface loads and their attachment modes (n, a), scaled so that each load stores unit static energy
        f^T G f, which makes forces and moments comparable; loads that cause no strain are omitted."""
        F = self.system.loads
        energy = np.einsum("na,na->a", F, self.attachments)
        straining = energy > 0.0
        scale = 1.0 / np.sqrt(energy[straining])
        return F[:, straining] * scale, self.attachments[:, straining] * scale

    def require_interfaces(self, kind: str) -> None:
        """Raises `InputError` if there are no interface loads to build the basis called `kind` from."""
        if not self.attachments.shape[1]:
            raise InputError(
                f"basis {kind!r} is built from loads on interfaces and there are none; name interfaces, or use "
                "'free_free'"
            )

    def require_fits(self, kind: str, wanted: int, what: str, available: int | None = None) -> None:
        """Raises `InputError` if the basis called `kind` requires more columns, `wanted` (`what` in words), than are
        `available`, the elastic dofs if None."""
        most = self.elastic_dofs if available is None else available
        if wanted > most:
            raise InputError(
                f"basis {kind!r}: {wanted} {what} are more than the model has ({most}); request fewer, or refine the "
                "mesh"
            )


@dataclass(frozen=True, eq=False)
class RawBasis:
    """Columns (n, c) that the span of the global modes must contain; their rigid-body part is irrelevant.

    redundant: number of their directions that lie in the span of the attachment modes or of other columns by
    construction, so that dropping them is not reported. notes: lines for the report of the body; facts: plain data for
    its provenance.
    """

    columns: Array
    redundant: int = 0
    notes: list[str] = field(default_factory=list)
    facts: dict[str, Any] = field(default_factory=dict)


def lowest_modes(model: ElasticModel, limits: Limits, residual: float) -> tuple[Array, Array, list[str]]:
    """`omega` (m,) [rad/s] and M-orthonormal modes (n, m) within the limits, and notes. A multiple frequency is never
    split."""
    wanted = limits.count if limits.count is None else limits.count + AHEAD * (limits.count > 0)
    omega, V = vibration_modes(model, count=wanted, omega_max=limits.omega_max, residual=residual)
    notes = []
    if limits.count is not None:
        kept = whole_multiples(omega, limits.count)
        if kept > limits.count:
            notes = [f"modes={limits.count} would split a pair of equal frequencies: {kept} are kept"]
        omega, V = omega[:kept], V[:, :kept]
    return omega, V, notes
