r"""The rotational harmonics of a periodic body with rigid interfaces on its axis.

In harmonic k (travelling wave `u_s = u e^{i k s phi}`, each sector in its own axes) the motion of a rigid interface is
itself such a wave. A vector v fixed in space has the components `R(-s phi) v` in sector s, and `R(-a) (1, i,
0) = e^{i a} (1, i, 0)`, `R(-a) (0, 0, 1) = (0, 0, 1)`. So

* k = 0: translation along and rotation about the axis, direction `d = (0, 0, 1)`;
* k = 1: translation across and tilt, complex amplitudes along `d = (1, i, 0)/sqrt(2)`;
* k >= 2: none, the interface nodes are at rest.

The same directions give the rigid modes of the body, two in each of the harmonics 0 and 1. There the sparse solver of
`elastic` is used; all other harmonics are definite and use a block Cholesky factorisation one after the other.

All quantities are in the coordinates v of `waves`, in which a mirror-symmetric sector has real matrices. With
`(1, i, 0) = e^{i theta} (e_r + i e_theta)` the translation of k = 1 is real in them and the rotation i
times a real vector: its amplitude is then counted in units of -i (`ROTATION_UNIT`).

The harmonics are processed by one thread: the calls of LAPACK are small and hold the interpreter's lock; two threads
over harmonics took 1.5 times as long as one.

Waves. Matrices of all harmonics of a sector as sums of few constant ones, real if the sector is mirror-symmetric.

In harmonic k the matrix of a sector is `K_k = A + e^{ik phi} B + e^{-ik phi} B^T`, complex and Hermitian. On a mesh of
node planes with mirror symmetry at each of them it is real in other coordinates: the displacement of node a, at angle
theta_a, in its own cylindrical axes, without the phase of the wave, with the circumferential part multiplied by i:

    u_a = e^{i k theta_a} (v_r e_r + i v_theta e_theta + v_z e_z)      u = Q_k v,  Q_k unitary.

The reflection theta -> -theta maps the wave k to the wave -k and changes the sign of u_theta; complex conjugation
reverses this. Both together leave every v unchanged if each node maps to itself (theta_a = 0 or phi/2, modulo phi), so
`Q_k^H K_k Q_k` is its own conjugate: real and symmetric, a quarter of the work and half of the memory. With
`delta = theta_b - theta_a` (the angle between the nodes themselves, of whatever sectors) an entry K_ab between them
contributes, K_ab in cylindrical axes,

    Re(s e^{i k delta}) K_ab = cos(k delta) K_ab   (s = 1: both or none circumferential),
                               sin(k delta) K_ab   (s = -i: row circumferential),  - sin(k delta) K_ab  (s = i: column),

with as many different |delta| as the distances of coupled node planes. Mirror symmetry of a sector is detected by
the imaginary part in one harmonic (`MIRRORED`); without it, Q_k = 1 and the three complex terms remain.
The same holds in the harmonics 0 and N/2, where they are real anyway and a real mode must stay a real displacement.

Real modes. The global modes of all harmonics of a periodic body as real modes.

A complex mode `u` of harmonic 0 < k < N/2 with `u^H M_k u = 1` represents the two real modes
`sqrt(2/N) Re, Im (u e^{i k s phi})`; one of k = 0 or N/2 represents `u e^{i k s phi}/sqrt(N)`.

Vibration modes of a periodic body: the harmonics that have any, and their modes.

Whether a harmonic has modes below a limit takes one factorisation (Sylvester's law of inertia), modes take many solves:
all harmonics are therefore tested, only few are solved, and none is missed.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp

from warpffrf.model.reduced.contact_surface import sector_to_user
from warpffrf.offline.bases.modes import SAME_FREQUENCY, vibration_modes, whole_multiples
from warpffrf.offline.cyclic.block_cholesky import BlockCholesky, BlockPattern, NotDefiniteError
from warpffrf.offline.cyclic.sector import Sector, phase
from warpffrf.offline.elastic import ElasticModel, free_model
from warpffrf.offline.fe import Sparse
from warpffrf.offline.products import Limits
from warpffrf.offline.progress import Progress

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
    """Solvers for every harmonic of one sector; interface dofs, two per interface, come after the free ones for k < 2.

    `loaded`: nodes of the sector with loads; they are eliminated last if that is not much more work.
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
        """Positions (e,) and values (t, e) of the entries present in any of the terms."""
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


Array = np.ndarray
# Imaginary part, relative to the largest entry, below which a sector counts as mirror-symmetric: round-off of cells a
# thousandth of the radius wide is 1e-12. The neglected part is then below the agreement with the general path, 1e-9.
MIRRORED = 1e-10
SAME_ANGLE = 1e-9  # rad; angles between node planes closer than this are one: planes are 1e-4 rad apart at least
MOST_TERMS = 16  # more different angles between coupled nodes than this cost more than complex arithmetic


class Waves:
    """K and M of every harmonic in the coordinates v, `K_k = sum_t coefficient_t(k) terms[t]`, and Q_k.

    `mirrored`: whether the sector is mirror-symmetric, `angles` (d,) [rad]: the |delta| that occur.
    """

    def __init__(self, sector: Sector) -> None:
        self.sector = sector
        x, y, _ = sector.coordinates.T
        self.theta = np.arctan2(y, x)
        self.theta[np.hypot(x, y) == 0.0] = 0.0
        self._turn = _cylindrical(self.theta)
        pairs = {"K": sector.K, "M": sector.M}
        self._sector_terms = {name: [A, B, sp.csr_matrix(B.T)] for name, (A, B) in pairs.items()}
        self._mirror_terms: dict[str, list[Sparse]] = {}
        self.mirrored, self.angles = self._is_mirrored(), np.zeros(0)
        if self.mirrored:
            self.angles = _distinct(np.abs(np.concatenate([self._entries(pair)[3] for pair in pairs.values()])))
            self.mirrored = len(self.angles) <= MOST_TERMS
        if self.mirrored:
            self._mirror_terms = {name: self._real_terms(pair) for name, pair in pairs.items()}

    @property
    def count(self) -> int:
        """Number of sectors N."""
        return self.sector.count

    def mirrored_at(self, k: int) -> bool:
        """Whether harmonic k uses mirrored coordinates; otherwise Q_k = 1."""
        return self.mirrored and 0 < 2 * k < self.count

    def real_at(self, k: int) -> bool:
        """Whether the matrices of harmonic k are real."""
        return self.mirrored or k == 0 or 2 * k == self.count

    def terms(self, what: str, k: int) -> list[Sparse]:
        """The constant matrices (3 nn, 3 nn) of "K" or "M" that harmonic k consists of."""
        return (self._mirror_terms if self.mirrored_at(k) else self._sector_terms)[what]

    def coefficients(self, k: int) -> Array:
        """The coefficients of the terms in harmonic k."""
        if self.mirrored_at(k):
            return np.concatenate([np.cos(k * self.angles), np.sin(k * self.angles)])
        e = phase(k, self.count)
        return np.array([1.0, e, np.conj(e)])

    def matrix(self, what: str, k: int) -> Sparse:
        """Q_k^H K_k Q_k or Q_k^H M_k Q_k (3 nn, 3 nn)."""
        total = sum(c * term for c, term in zip(self.coefficients(k), self.terms(what, k), strict=True))
        return sp.csr_matrix(total)

    def basis(self, k: int) -> Sparse:
        """Q_k (3 nn, 3 nn): sector displacement u = Q_k v."""
        if not self.mirrored_at(k):
            return sp.identity(3 * self.sector.nodes, format="csr")
        return self._mirror_basis(k)

    def _mirror_basis(self, k: int) -> Sparse:
        wave = np.exp(1j * k * self.theta)[:, None] * np.array([1.0, 1.0j, 1.0])
        return sp.csr_matrix(self._turn @ sp.diags(wave.ravel()))

    def _is_mirrored(self) -> bool:
        k = max(2, self.count // 3)  # large enough for planes a pitch apart to be a third of a revolution out of phase
        Q = self._mirror_basis(k)
        for pair in (self.sector.K, self.sector.M):
            v = Q.conj().T @ self.sector.harmonic(pair, k) @ Q
            if np.abs(v.imag).max() > MIRRORED * np.abs(v.real).max():
                return False
        return True

    def _entries(self, pair: tuple[Sparse, Sparse]) -> tuple[Array, Array, Array, Array]:
        """Row, column, value in cylindrical axes, and delta [rad], of all entries of A, B and B^T."""
        A, B = pair
        rows, columns, values, deltas = [], [], [], []
        for offset, block in ((0, A), (1, B), (-1, sp.csr_matrix(B.T))):
            local = sp.coo_matrix(self._turn.T @ block @ self._turn)
            rows.append(local.row)
            columns.append(local.col)
            values.append(local.data)
            angle = self.theta[local.col // 3] - self.theta[local.row // 3]
            deltas.append(angle + offset * self.sector.phi)
        return np.concatenate(rows), np.concatenate(columns), np.concatenate(values), np.concatenate(deltas)

    def _real_terms(self, pair: tuple[Sparse, Sparse]) -> list[Sparse]:
        """The terms of cos(k |delta|) for each of `angles`, then those of sin(k |delta|)."""
        n = 3 * self.sector.nodes
        row, column, value, delta = self._entries(pair)
        middle = 0.5 * (self.angles[1:] + self.angles[:-1])
        which = np.searchsorted(middle, np.abs(delta))
        row_turned, column_turned = row % 3 == 1, column % 3 == 1
        alike = row_turned == column_turned
        signed = value * np.where(row_turned, 1.0, -1.0) * np.sign(delta)
        terms = []
        for part, entries in ((alike, value), (~alike, signed)):
            for i in range(len(self.angles)):
                here = part & (which == i)
                terms.append(sp.csr_matrix((entries[here], (row[here], column[here])), shape=(n, n)))
        return terms


def _distinct(values: Array) -> Array:
    ordered = np.sort(values)
    starts = np.concatenate([[True], np.diff(ordered) > SAME_ANGLE])
    return ordered[starts]


def _cylindrical(theta: Array) -> Sparse:
    """Block-diagonal (3 n, 3 n): columns are e_r, e_theta, e_z at each node in the sector's axes."""
    n = len(theta)
    c, s = np.cos(theta), np.sin(theta)
    blocks = np.zeros((n, 3, 3))
    blocks[:, 0, 0], blocks[:, 0, 1] = c, -s
    blocks[:, 1, 0], blocks[:, 1, 1] = s, c
    blocks[:, 2, 2] = 1.0
    return sp.csr_matrix(sp.bsr_matrix((blocks, np.arange(n), np.arange(n + 1)), shape=(3 * n, 3 * n)))


@dataclass
class HarmonicModes:
    """Global modes of one harmonic: omega (p,), sector displacement (3 nn, p), interface amplitudes (2 i, p), on each
    contact surface the coefficients of the displacement in each field (count, p), and the observers' values
    (rows, p)."""

    k: int
    omega: Array
    shape: Array
    interface: Array
    fields: list[list[Array]]
    observed: list[Array]


class RealModes:
    """The complex modes of all harmonics as real modes, ascending in frequency, the two of a pair adjacent."""

    def __init__(self, N: int, found: list[HarmonicModes]) -> None:
        self.N, self.found = N, found
        omega, self._kinds = [], []
        for h in found:
            pair = 0 < h.k and 2 * h.k != N
            for w in h.omega:
                omega += [w] * (2 if pair else 1)
            self._kinds.append(pair)
        self._order = np.argsort(np.array(omega), kind="stable")
        self.omega = np.array(omega)[self._order]

    def combine(self, waves: list[Array]) -> Array:
        """Real fields (rows, m) from the complex waves (rows, p) of each harmonic."""
        columns = []
        for wave, pair in zip(waves, self._kinds, strict=True):
            if pair:
                scale = np.sqrt(2.0 / self.N)
                columns.append(np.stack([np.real(wave), np.imag(wave)], axis=2).reshape(len(wave), -1) * scale)
            else:
                columns.append(np.real(wave) / np.sqrt(self.N))
        if not columns:
            return np.zeros((0, 0))
        return np.concatenate(columns, axis=1)[:, self._order]

    def interface_motion(self, j: int, axes: Array) -> Array:
        """Translation and rotation (m, 6) of interface j, user axes."""
        waves = []
        for h in self.found:
            motion = np.zeros((6, len(h.omega)), dtype=complex)
            if h.k in DIRECTIONS:
                d = axes @ DIRECTIONS[h.k]
                motion[:3] = d[:, None] * h.interface[2 * j]
                motion[3:] = d[:, None] * h.interface[2 * j + 1]
            waves.append(motion)
        return self.combine(waves).T if waves else np.zeros((0, 6))

    def skin(self, dofs: Array, axes: Array) -> Array:
        """Displacement of the display points (m, n, 3) float32, user axes."""
        N, points = self.N, len(dofs) // 3
        fields = np.zeros((len(self.omega), N * points, 3), dtype=np.float32)
        place = np.argsort(self._order)
        row = 0
        for h, pair in zip(self.found, self._kinds, strict=True):
            wave = np.exp(2j * np.pi * h.k * np.arange(N) / N)[:, None, None]
            for p in range(len(h.omega)):
                u = wave * h.shape[dofs, p].reshape(1, points, 3)
                parts = (np.real(u), np.imag(u)) if pair else (np.real(u),)
                scale = np.sqrt(len(parts) / N)
                for part in parts:
                    fields[place[row]] = scale * sector_to_user(part, axes)
                    row += 1
        return fields

    def facts(self) -> dict:
        """Harmonics with global modes, for the report."""
        return {"harmonics_with_modes": [int(h.k) for h in self.found]}


LIMIT_GROWTH = 1.35  # factor by which the frequency limit grows until the required number of modes lies below it
# Harmonics solved first until they have the required number of modes; the limit found is then applied to all others.
# The first ones contain most of the lowest modes of a round body.
FIRST_HARMONICS = 8


@dataclass
class _Found:
    """Modes of one harmonic: its model, omega (p,), V (n, p)."""

    model: ElasticModel
    omega: Array
    V: Array


def vibrations(
    harmonics: Harmonics, limits: Limits, progress: Progress
) -> tuple[dict[int, tuple[ElasticModel, Array]], dict]:
    """Vibration modes by harmonic, {k: (model, V (n_k, p))}, whole pairs only, and notes on rounding."""
    if limits.none:
        return {}, {}
    last = harmonics.count // 2
    if limits.omega_max is not None:
        found = _modes_up_to(harmonics, range(last + 1), limits.omega_max, progress, {})
    else:
        found = _enough(harmonics, limits.count or 0, progress)
    facts: dict = {}
    if limits.count is not None:
        omega = np.sort(np.concatenate([np.repeat(f.omega, harmonics.multiplicity(k)) for k, f in found.items()]))
        kept = whole_multiples(omega, limits.count)
        if kept > limits.count:
            facts["notes"] = [f"modes={limits.count} would split a pair of equal frequencies: {kept} are kept"]
        cut = omega[kept - 1] * (1.0 + SAME_FREQUENCY) if kept else 0.0
        found = {k: _Found(f.model, f.omega[f.omega <= cut], f.V[:, f.omega <= cut]) for k, f in found.items()}
    return {k: (f.model, f.V) for k, f in found.items() if len(f.omega)}, facts


def _enough(harmonics: Harmonics, count: int, progress: Progress) -> dict[int, _Found]:
    """All modes up to a limit that includes `count` of them, or all modes of the mesh."""
    last = harmonics.count // 2
    models = {k: harmonics.model(k) for k in range(min(3, last + 1))}
    lowest = [w[0] for m in models.values() if len(w := vibration_modes(m, count=1)[0])]
    limit, found = LIMIT_GROWTH * float(min(lowest)), {}
    for group in (range(min(FIRST_HARMONICS, last + 1)), range(last + 1)):
        total = sum(harmonics.multiplicity(k) * harmonics.size(k) for k in group)
        while True:
            found = _modes_up_to(harmonics, group, limit, progress, models)
            number = sum(harmonics.multiplicity(k) * len(f.omega) for k, f in found.items())
            if number >= min(count, total - 6):  # the six rigid motions are no modes
                break
            limit *= LIMIT_GROWTH
    return found


def _modes_up_to(
    harmonics: Harmonics, group: range, omega: float, progress: Progress, models: dict[int, ElasticModel]
) -> dict[int, _Found]:
    """Modes of the harmonics in `group`; `models` of harmonics that have modes are kept for the next limit."""
    found = {}
    for k in progress.track(group, "vibration modes"):
        if k < 2 or k in models or harmonics.has_modes(k, omega):
            if k not in models:
                models[k] = harmonics.model(k)
            model = models[k]
            w, V = vibration_modes(model, omega_max=omega)
            if len(w):
                found[k] = _Found(model, w, V)
    return found
