r"""The rotational harmonics of a periodic body with rigid interfaces on its axis.

In harmonic k (travelling wave `u_s = u e^{i k s phi}`, each sector in its own axes) a rigid interface has the motion
that is itself such a wave. A vector v fixed in space has the components `R(-s phi) v` in sector s, and `R(-a) (1, i,
0) = e^{i a} (1, i, 0)`, `R(-a) (0, 0, 1) = (0, 0, 1)`. So

* k = 0: translation along and rotation about the axis, direction `d = (0, 0, 1)`;
* k = 1: translation across and tilt, complex amplitudes along `d = (1, i, 0)/sqrt(2)`;
* k >= 2: none, the interface nodes are at rest.

The same directions give the rigid modes of the body, two in each of the harmonics 0 and 1. There the sparse solver of
`elastic` is used; all other harmonics are definite, and a banded Cholesky factorisation takes them one after the other.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import scipy.sparse as sp
from scipy.linalg import get_lapack_funcs
from scipy.sparse.csgraph import reverse_cuthill_mckee

from warpffrf.offline.assembly import Sparse
from warpffrf.offline.elastic import Array, ElasticModel, free_model
from warpffrf.offline.sector import Sector, phase

DIRECTIONS = {0: np.array([0.0, 0.0, 1.0]), 1: np.array([1.0, 1.0j, 0.0]) / np.sqrt(2.0)}


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
    """Solvers for every harmonic of one sector; interface dofs, two an interface, come after the free ones for k <
    2."""

    def __init__(self, sector: Sector, interfaces: list[AxialInterface]) -> None:
        self.sector = sector
        self.interfaces = interfaces
        slaved = np.zeros(sector.nodes, dtype=bool)
        for interface in interfaces:
            slaved[interface.nodes] = True
        free = np.flatnonzero(~slaved)
        A, B = sector.K
        graph = sp.csr_matrix(abs(A) + abs(B) + abs(B.T))
        fold = sp.kron(sp.identity(sector.nodes), np.ones((1, 3)))
        nodal = sp.csr_matrix(fold @ graph @ fold.T)[free][:, free]
        nodes = min(
            (free, free[reverse_cuthill_mckee(sp.csr_matrix(nodal), symmetric_mode=True)]),
            key=lambda order: _bandwidth(sp.csr_matrix(nodal), np.argsort(np.argsort(order))),
        )
        self.free = (3 * nodes[:, None] + np.arange(3)).ravel()
        self._free_only: Sparse | None = None
        self._bands: dict[str, tuple[Array, Array, Array]] = {}

    @property
    def count(self) -> int:
        """Number of sectors N; harmonics are 0 to N//2."""
        return self.sector.count

    def multiplicity(self, k: int) -> int:
        """Real modes for one mode of harmonic k: 2 (waves k and -k) or 1 for k = 0 and k = N/2."""
        return 1 if k == 0 or 2 * k == self.count else 2

    def constraint(self, k: int) -> Sparse:
        """T_k (3 nn, n_k): sector displacement from free and interface dofs."""
        size = 3 * self.sector.nodes
        count = len(self.free)
        if k >= 2 and self._free_only is not None:
            return self._free_only
        blocks = [sp.csr_matrix((np.ones(count), (self.free, np.arange(count))), shape=(size, count))]
        if k < 2:
            for interface in self.interfaces:
                rows = (3 * interface.nodes[:, None] + np.arange(3)).ravel()
                W = sp.coo_matrix(rigid_wave(k, self.sector.coordinates[interface.nodes], interface.height))
                blocks.append(sp.csr_matrix((W.data, (rows[W.row], W.col)), shape=(size, 2)))
        T = sp.csr_matrix(sp.hstack(blocks, format="csr"))
        if k >= 2:
            self._free_only = T
        return T

    def interface_loads(self, k: int) -> Array:
        """Unit loads (n_k, 2 i) on the interface dofs; none for k >= 2."""
        count = 2 * len(self.interfaces) if k < 2 else 0
        F = np.zeros((len(self.free) + count, count))
        F[len(self.free) :] = np.eye(count)
        return F

    def model(self, k: int) -> ElasticModel:
        """K_k, M_k with their rigid modes and solver."""
        T = self.constraint(k)
        TH = T.conj().T
        K = sp.csr_matrix(TH @ self.sector.harmonic(self.sector.K, k) @ T)
        M = sp.csr_matrix(TH @ self.sector.harmonic(self.sector.M, k) @ T)
        if k >= 2:
            return ElasticModel(K, M, np.zeros((len(self.free), 0)), self.solver(k))
        R = self._rigid(k)
        pinned = len(self.free) + np.arange(2) if self.interfaces else None
        return free_model(K, M, R, pinned)

    def _rigid(self, k: int) -> Array:
        middle = float(np.mean(self.sector.coordinates[:, 2]))
        R = [rigid_wave(k, self.sector.coordinates, middle)[self.free]]
        d = DIRECTIONS[k]
        for interface in self.interfaces:
            arm = np.cross(d, np.array([0.0, 0.0, interface.height - middle]))
            # the interface's amplitudes are along d; for k = 1, d x e_a is along d again (i times), for k = 0 it is
            # zero
            R.append(np.array([[1.0, np.vdot(d, arm)], [0.0, 1.0]]))
        return np.concatenate(R, axis=0)

    # --- banded harmonics, k >= 2 ---

    @cached_property
    def _width(self) -> int:
        place = np.full(3 * self.sector.nodes, -1)
        place[self.free] = np.arange(len(self.free))
        A, B = self.sector.K
        widths = []
        for matrix in (A.tocoo(), B.tocoo()):
            i, j = place[matrix.row], place[matrix.col]
            kept = (i >= 0) & (j >= 0)
            widths.append(int(np.max(np.abs(i - j)[kept], initial=0)))
        return max(widths)

    def _band(self, what: str, k: int) -> Array:
        """Lower band (w + 1, n) of K_k or M_k on the free dofs: entry (i, j) at [i - j, j]."""
        if what not in self._bands:
            A, B = self.sector.K if what == "K" else self.sector.M
            self._bands[what] = (self._lower(A), self._lower(B), self._lower(sp.csr_matrix(B.T)))
        A, B, BT = self._bands[what]
        e = phase(k, self.count)
        return A + e * B + np.conj(e) * BT

    def _lower(self, matrix: Sparse) -> Array:
        reduced = sp.coo_matrix(matrix[self.free][:, self.free])
        band = np.zeros((self._width + 1, len(self.free)))
        lower = reduced.row >= reduced.col
        i, j = reduced.row[lower], reduced.col[lower]
        np.add.at(band, (i - j, j), reduced.data[lower])
        return band

    def solver(self, k: int):
        """Function (n, m) -> (n, m) that solves K_k u = f by banded Cholesky, k >= 2."""
        band = self._band("K", k)
        real = not np.iscomplexobj(band)
        factorise, substitute = get_lapack_funcs(("pbtrf", "pbtrs"), (band,))
        factor, info = factorise(band, lower=1)
        if info != 0:
            raise np.linalg.LinAlgError(f"stiffness of harmonic {k} is not positive definite (LAPACK pbtrf: {info})")

        def solve(F: Array) -> Array:
            if real and np.iscomplexobj(F):
                return solve(np.real(F)) + 1j * solve(np.imag(F))
            return substitute(factor, F, lower=1)[0]

        return solve

    def has_modes(self, k: int, omega: float) -> bool:
        """Whether harmonic k >= 2 has a mode up to `omega`: K - omega^2 M is then indefinite (Sylvester)."""
        band = self._band("K", k) - omega**2 * self._band("M", k)
        (factorise,) = get_lapack_funcs(("pbtrf",), (band,))
        return factorise(band, lower=1, overwrite_ab=1)[1] != 0


def _bandwidth(graph: Sparse, place: np.ndarray) -> int:
    """Half bandwidth of `graph` when node i (by its rank among the free nodes) stands at `place[i]`."""
    entries = graph.tocoo()
    return int(np.max(np.abs(place[entries.row] - place[entries.col]), initial=0))
