r"""The rotational harmonics of a periodic body with rigid interfaces on its axis.

In harmonic k (travelling wave `u_s = u e^{i k s phi}`, each sector in its own axes) a rigid interface has the motion
that is itself such a wave. A vector v fixed in space has the components `R(-s phi) v` in sector s, and `R(-a) (1, i,
0) = e^{i a} (1, i, 0)`, `R(-a) (0, 0, 1) = (0, 0, 1)`. So

* k = 0: translation along and rotation about the axis, direction `d = (0, 0, 1)`;
* k = 1: translation across and tilt, complex amplitudes along `d = (1, i, 0)/sqrt(2)`;
* k >= 2: none, the interface nodes are at rest.

The same directions give the rigid modes of the body, two in each of the harmonics 0 and 1. There the sparse solver of
`elastic` is used; all other harmonics are definite, and a block Cholesky factorisation takes them one after the other.

Everything is written in the coordinates v of `waves`, in which a sector that is its own mirror image has real
matrices. With `(1, i, 0) = e^{i theta} (e_r + i e_theta)` the translation of k = 1 is real in them and the rotation i
times a real vector: its amplitude is then counted in units of -i (`ROTATION_UNIT`).

One thread takes the harmonics in turn: the calls of LAPACK are small and hold the interpreter's lock, two threads over
harmonics took 1.5 times as long as one.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp

from warpffrf.offline.cyclic.block_cholesky import BlockCholesky, BlockPattern, NotDefiniteError
from warpffrf.offline.cyclic.sector import Sector
from warpffrf.offline.cyclic.waves import Waves
from warpffrf.offline.elastic import Array, ElasticModel, free_model
from warpffrf.offline.fe.assembly import Sparse

DIRECTIONS = {0: np.array([0.0, 0.0, 1.0]), 1: np.array([1.0, 1.0j, 0.0]) / np.sqrt(2.0)}
ROTATION_UNIT = -1.0j


@dataclass(frozen=True)
class AxialInterface:
    """A rigid interface of a periodic body: its `nodes` in sector 0 and the `height` [m] of its point on the axis."""

    nodes: np.ndarray
    height: float


def rigid_wave(k: int, coordinates: Array, height: float) -> Array:
    """Rigid motions (3 n, 2) of harmonic k = 0, 1 at `coordinates` (n, 3): translation d, rotation d about (0, 0,
    height)."""
    d = DIRECTIONS[k]
    arm = coordinates - np.array([0.0, 0.0, height])
    translation = np.broadcast_to(d, coordinates.shape)
    return np.stack([translation.reshape(-1), np.cross(d, arm).reshape(-1)], axis=1)


class Harmonics:
    """Solvers for every harmonic of one sector; interface dofs, two an interface, come after the free ones for k < 2.

    `loaded`: nodes of the sector that carry loads; they are eliminated last where that is not much more work.
    """

    def __init__(self, sector: Sector, interfaces: list[AxialInterface], loaded: Array | None = None) -> None:
        self.sector = sector
        self.interfaces = interfaces
        self.waves = Waves(sector)
        slaved = np.zeros(sector.nodes, dtype=bool)
        for interface in interfaces:
            slaved[interface.nodes] = True
        free = np.flatnonzero(~slaved)
        rank = np.full(sector.nodes, -1)
        rank[free] = np.arange(len(free))
        graph = _node_graph(sector)
        beside = np.unique(graph[np.flatnonzero(slaved)].indices)
        roots = [rank[nodes] for nodes in (np.zeros(0, np.int64) if loaded is None else loaded, beside)]
        along = sector.coordinates[free, 2]
        roots = [r[r >= 0] for r in roots]
        roots.append(np.flatnonzero(along <= along.min() + np.ptp(along) * 1e-6))
        self.pattern = BlockPattern(graph[free][:, free], roots)
        self.free = (3 * free[:, None] + np.arange(3)).ravel()
        self._values: dict[tuple[str, bool], tuple[Array, Array]] = {}

    @property
    def count(self) -> int:
        """Number of sectors N; harmonics are 0 to N//2."""
        return self.sector.count

    def multiplicity(self, k: int) -> int:
        """Real modes for one mode of harmonic k: 2 (waves k and -k) or 1 for k = 0 and k = N/2."""
        return 1 if k == 0 or 2 * k == self.count else 2

    def size(self, k: int) -> int:
        """Number n_k of coordinates of harmonic k."""
        return len(self.free) + (2 * len(self.interfaces) if k < 2 else 0)

    def constraint(self, k: int) -> Sparse:
        """T_k (3 nn, n_k): v of the sector from free and interface dofs."""
        size = 3 * self.sector.nodes
        count = len(self.free)
        blocks = [sp.csr_matrix((np.ones(count), (self.free, np.arange(count))), shape=(size, count))]
        if k < 2:
            Q = self.waves.basis(k)
            for interface in self.interfaces:
                rows = (3 * interface.nodes[:, None] + np.arange(3)).ravel()
                wave = rigid_wave(k, self.sector.coordinates[interface.nodes], interface.height)
                W = sp.coo_matrix(self._in_waves(k, Q[rows][:, rows], wave))
                blocks.append(sp.csr_matrix((W.data, (rows[W.row], W.col)), shape=(size, 2)))
        return sp.csr_matrix(sp.hstack(blocks, format="csr"))

    def interface_loads(self, k: int) -> Array:
        """Unit loads (n_k, 2 i) on the interface dofs; none for k >= 2."""
        count = 2 * len(self.interfaces) if k < 2 else 0
        F = np.zeros((len(self.free) + count, count))
        F[len(self.free) :] = np.eye(count)
        return F

    def interface_motion(self, k: int, Phi: Array) -> Array:
        """Amplitudes (2 i, p) along d of translation and rotation of the interfaces, of modes Phi (n_k, p)."""
        amplitudes = Phi[len(self.free) :]
        if k >= 2 or not self.waves.mirrored_at(k):
            return amplitudes
        return amplitudes * np.tile([1.0, ROTATION_UNIT], len(self.interfaces))[:, None]

    def mass(self, k: int) -> Sparse:
        """M_k (n_k, n_k) in the coordinates v, csr."""
        T = self.constraint(k)
        return sp.csr_matrix(T.conj().T @ self.waves.matrix("M", k) @ T)

    def model(self, k: int) -> ElasticModel:
        """K_k, M_k with their rigid modes and solver, in the coordinates v."""
        T = self.constraint(k)
        M = self.mass(k)
        K = sp.csr_matrix(T.conj().T @ self.waves.matrix("K", k) @ T)
        if k >= 2:
            return ElasticModel(K, M, np.zeros((len(self.free), 0)), self.factor(k).solve)
        pinned = len(self.free) + np.arange(2) if self.interfaces else None
        return free_model(K, M, self._rigid(k), pinned)

    def _in_waves(self, k: int, Q: Sparse, wave: Array) -> Array:
        """Rigid motions (3 m, 2) in sector axes -> in v and in units of `ROTATION_UNIT`, real where v is."""
        if not self.waves.mirrored_at(k):
            return wave
        return np.real((Q.conj().T @ wave) * np.array([1.0, ROTATION_UNIT]))

    def _rigid(self, k: int) -> Array:
        middle = float(np.mean(self.sector.coordinates[:, 2]))
        whole = rigid_wave(k, self.sector.coordinates, middle)
        R = [self._in_waves(k, self.waves.basis(k), whole)[self.free]]
        d = DIRECTIONS[k]
        real = self.waves.mirrored_at(k)
        for interface in self.interfaces:
            arm = np.cross(d, np.array([0.0, 0.0, interface.height - middle]))
            # the interface's amplitudes are along d; for k = 1, d x e_a is along d again (i times), for k = 0 it is
            # zero
            coupling = np.vdot(d, arm)
            R.append(np.array([[1.0, np.real(coupling * ROTATION_UNIT) if real else coupling], [0.0, 1.0]]))
        return np.concatenate(R, axis=0)

    # --- definite harmonics, k >= 2 ---

    def _entries(self, what: str, k: int) -> Array:
        """Stored entries of K_k or M_k on the free dofs, see `BlockPattern`."""
        key = (what, self.waves.mirrored_at(k))
        if key not in self._values:
            self._values[key] = self._gathered(self.waves.terms(what, k))
        place, terms = self._values[key]
        out = np.zeros(self.pattern.length, dtype=np.float64 if self.waves.real_at(k) else np.complex128)
        out[place] = self.waves.coefficients(k) @ terms
        return out

    def _gathered(self, terms: list[Sparse]) -> tuple[Array, Array]:
        """Places (e,) and values (t, e) of the entries that any of the terms has."""
        found = []
        for term in terms:
            reduced = sp.coo_matrix(term[self.free][:, self.free])
            kept, at = self.pattern.place(reduced.row, reduced.col)
            found.append((at, reduced.data[kept]))
        place = np.unique(np.concatenate([at for at, _ in found]))
        values = np.zeros((len(terms), len(place)))
        for row, (at, data) in zip(values, found, strict=True):
            np.add.at(row, np.searchsorted(place, at), data)
        return place, values

    def factor(self, k: int) -> BlockCholesky:
        """Factors of K_k on the free dofs, k >= 2."""
        try:
            return self.pattern.factor(self._entries("K", k))
        except NotDefiniteError as error:
            raise NotDefiniteError(f"stiffness of harmonic {k}: {error}") from None

    def has_modes(self, k: int, omega: float) -> bool:
        """Whether harmonic k >= 2 has a mode up to `omega`: K - omega^2 M is then indefinite (Sylvester)."""
        try:
            self.pattern.factor(self._entries("K", k) - omega**2 * self._entries("M", k))
        except NotDefiniteError:
            return True
        return False


def _node_graph(sector: Sector) -> Sparse:
    """Which nodes of a sector are coupled in any harmonic (nn, nn)."""
    A, B = sector.K
    graph = sp.csr_matrix(abs(A) + abs(B) + abs(B.T))
    fold = sp.kron(sp.identity(sector.nodes), np.ones((1, 3)), format="csr")
    return sp.csr_matrix(fold @ graph @ fold.T)
