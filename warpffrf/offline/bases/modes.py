r"""Vibration modes of a free elastic body by block Lanczos on its flexibility.

The operator `T = G M` with `G = P^H K^+ P` is self-adjoint in the M inner product; its eigenvalues are `1/omega^2`
for the elastic modes and 0 for the rigid ones, so the lowest elastic modes are the largest eigenvalues and the rigid
modes never appear. A block Krylov space with full M-orthogonalisation is used (Golub and Underwood 1977; Parlett
1998, ch. 13): blocks find multiple eigenvalues, of which a round body has many, where a single vector sees one of each.

With `T Q = Q H + Q_next S E^H` (E picks the last block) a Ritz pair `(nu, Q y)` has residual `|S y_last|` in the M
norm.
"""

from __future__ import annotations

import numpy as np

from warpffrf.offline.elastic import Array, ElasticModel

BLOCK = 8  # vectors a block: more than the multiplicity that symmetry alone gives, and efficient right-hand sides
RESIDUAL = 1e-11  # of the eigenvalue: eigenvectors to about 1e-9 for neighbours 1 % apart
ROUND_OFF = 4e-15  # of the largest eigenvalue: residuals below it are noise of the operator itself
SEEN_BEYOND = 1e-3  # relative residual at which the first unwanted mode counts as seen: nothing wanted can hide then
EXHAUSTED = 1e-11  # of the largest eigenvalue: a new direction below it is noise, the Krylov space is invariant
SAME_FREQUENCY = 1e-6  # relative distance of frequencies that are one multiple frequency


def vibration_modes(
    model: ElasticModel, *, count: int | None = None, omega_max: float | None = None, residual: float = RESIDUAL
) -> tuple[Array, Array]:
    """Lowest elastic modes: `omega` (m,) [rad/s] ascending and M-orthonormal `Phi` (n, m).

    `count` modes at least (some more may come), or all up to `omega_max`; both: the fewer. All that the mesh has, if
    less. A mode is accepted when its residual is below `residual` of its eigenvalue.
    """
    if count == 0 or (count is None and omega_max is None):
        return np.zeros(0), np.zeros((model.size, 0), dtype=_dtype(model))
    krylov = _Krylov(model)
    checked_at = 0
    while True:
        more = krylov.expand()
        if more and len(krylov.H) < 1.15 * checked_at:
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
    """The growing basis Q (n, d), M-orthonormal, and H = Q^H M T Q."""

    def __init__(self, model: ElasticModel) -> None:
        self.model = model
        n = model.size
        width = min(BLOCK, max(n - model.R.shape[1], 1))
        rng = np.random.default_rng(n)  # a fixed start: the same input gives the same modes, bit for bit
        start = rng.standard_normal((n, width)).astype(_dtype(model))
        if np.iscomplexobj(start):
            start = start + 1j * rng.standard_normal((n, width))
        start = model.flexibility(model.M @ start)
        self._store = np.zeros((n, 4 * width), dtype=start.dtype)
        self._size = 0
        self.H = np.zeros((0, 0), dtype=start.dtype)
        self._scale = 0.0
        self._next, self._S = self._orthonormal(start)

    @property
    def Q(self) -> Array:
        return self._store[:, : self._size]

    def expand(self) -> bool:
        """Take the pending block into the basis and prepare the next; False when the space is exhausted."""
        block = self._next
        width = block.shape[1]
        if not width:
            return False
        if self._size + width > self._store.shape[1]:
            self._store = np.concatenate([self._store, np.zeros_like(self._store)], axis=1)
        self._store[:, self._size : self._size + width] = block
        self._size += width
        Z = self.model.flexibility(self.model.M @ block)
        column = self.Q.conj().T @ (self.model.M @ Z)
        H = np.zeros((self._size, self._size), dtype=column.dtype)
        H[:-width, :-width] = self.H
        H[:, -width:] = column
        H[-width:, :] = column.conj().T
        H[-width:, -width:] = 0.5 * (column[-width:] + column[-width:].conj().T)
        self.H = H
        self._scale = max(self._scale, float(np.max(np.abs(np.diag(H)))))
        self._next, self._S = self._orthonormal(Z)
        return self._next.shape[1] > 0 and self._size < self.model.size - self.model.R.shape[1]

    def _orthonormal(self, Z: Array) -> tuple[Array, Array]:
        """Z made M-orthogonal to the basis and M-orthonormal in itself (n, w), and S (w, columns of Z)."""
        M = self.model.M
        Z = self._freed(Z)
        values, vectors = np.linalg.eigh(_hermitian(Z.conj().T @ (M @ Z)))
        largest = self._scale**2 if self._scale else float(values[-1])
        keep = values > EXHAUSTED**2 * largest
        W = self._freed(Z @ (vectors[:, keep] / np.sqrt(values[keep])))
        if W.shape[1]:  # directions that were mostly round-off shrink here; they are noise and go
            values, vectors = np.linalg.eigh(_hermitian(W.conj().T @ (M @ W)))
            keep = values > 0.5
            W = self._freed(W @ (vectors[:, keep] / np.sqrt(values[keep])))
        return W, W.conj().T @ (M @ Z)

    def _freed(self, Z: Array) -> Array:
        """Z without its M-projections on the basis and on rigid motion."""
        M, Q = self.model.M, self.Q
        for _ in range(2):  # twice is enough (Kahan, Parlett)
            Z = self.model.without_rigid(Z - Q @ (Q.conj().T @ (M @ Z)))
        return Z

    def ritz(self) -> tuple[Array, Array, Array]:
        """Ritz values nu (d,) descending, vectors Y (d, d), residuals (d,)."""
        nu, Y = np.linalg.eigh(self.H)
        nu, Y = nu[::-1], Y[:, ::-1]
        last = self._S.shape[1]
        return nu, Y, np.linalg.norm(self._S @ Y[-last:], axis=0)


def _dtype(model: ElasticModel) -> np.dtype:
    return np.result_type(model.K.dtype, model.M.dtype, model.R.dtype)


def _hermitian(A: Array) -> Array:
    return 0.5 * (A + A.conj().T)


def whole_multiples(omega: Array, count: int) -> int:
    """Number of leading frequencies to keep: `count`, raised where it would cut a multiple frequency apart.

    `omega` (m,) ascending, with repeated entries for multiple frequencies.
    """
    kept = min(count, len(omega))
    while 0 < kept < len(omega) and omega[kept] - omega[kept - 1] <= SAME_FREQUENCY * omega[kept]:
        kept += 1
    return kept
