r"""Gramians and Hankel values of a modal system with symmetric inputs and outputs, in closed form.

    q_i'' + 2 zeta omega_i q_i' + omega_i^2 q_i = b_i u,      y = sum_i b_i^T q_i.

An impulse gives `q_i = b_i Im(e^(mu_i t))/omega_d,i` with mu_i = omega_i (-zeta + i sqrt(1 - zeta^2)), omega_d,i =
Im mu_i, and `q_i' = b_i Im(mu_i e^(mu_i t))/omega_d,i`. The controllability Gramian `P = int x x^T dt` of x = (q, q')
needs, for complex alpha and beta,

    int Im(alpha e^(mu t)) Im(beta e^(nu t)) dt = 1/2 Re[ alpha beta/(mu + nu) - alpha conj(beta)/(mu + conj(nu)) ].

No Lyapunov equation is solved. With `J = [[D, 1], [1, 0]]`, D = diag(2 zeta omega), one has A^T J = J A and B^T J = C:
the observability Gramian is `Q = J P J`, the Hankel values are the absolute eigenvalues of P J, and the velocity block
of Q is the position block of P. The state is scaled to (omega q, q'), so that both halves have the unit of a velocity.

Balanced truncation of the second-order system from interface loads to interface motion.

Position-velocity balancing (Reis and Stykel 2008) takes the position controllability Gramian P_p and the velocity
observability Gramian Q_v; for P_p = L_p L_p^T, Q_v = L_v L_v^T and the singular value decomposition
`L_v^T M L_p = U Sigma V^T` the trial space is L_p V and the test space L_v U. A structure loaded and observed at the
same coordinates, with symmetric M, D and K, has `Q_v = P_p` (`gramians.py`), so that both spaces coincide: they are the
dominant eigenvectors of P_p in the inner product of M,

    P_p M v_i = sigma_i v_i.

The projection is Galerkin: M, D, K stay symmetric and definite, as the floating frame needs it, and all is real.

The Gramian of the FE model would need Lyapunov equations of its size. Balancing is carried out in a *pool* of vibration
modes and attachment modes instead, M-orthonormal, where with a modal damping ratio P_p has a closed form; anything
outside the pool is ignored. Loads are scaled to unit static energy. `2 sum_{i > 2k} sigma_i` over the discarded Hankel
values bounds the error of *first-order* balanced truncation to 2 k states (Enns 1984, Glover 1984); a second-order one
with k coordinates has no such bound (Reis and Stykel), so its error is measured over the frequencies of the pool, with
the attachment modes included, and reported in addition.

Krylov. Moment matching of the interface receptance by second-order block Krylov spaces (Salimbahrami and Lohmann 2006).

Undamped, the flexible receptance is a function of lambda = omega^2,

    H(lambda) = F^T (K - lambda M)^-1 P F = sum_j m_j (lambda - lambda_0)^j,
    m_j = F^T X_j,     X_0 = (K - lambda_0 M)^-1 P F,     X_j = (K - lambda_0 M)^-1 M X_{j-1}.

P F, the self-equilibrated loads, do not excite rigid motion, nor does M X_{j-1}. A Galerkin projection on
X_0 ... X_{k-1} matches m_0 ... m_{2k-1}: K and M are symmetric and inputs equal outputs, so each block counts on both
sides, and near lambda_0 the error is of order (lambda - lambda_0)^2k. At lambda_0 = 0 the solve is the inertia-relief
flexibility, and X_0 the attachment modes. The blocks of one point are M-orthonormalised one by one (block Arnoldi);
an exhausted direction is removed from the sequence. No a-priori rule gives the number of points and moments for a
frequency range; compare two sizes.

Pod. Proper orthogonal decomposition: the optimal space for given responses, in the inner product of M.

The vectors of snapshots X (n, t), projected off rigid motion, are (method of snapshots, Sirovich 1987)

    X^T M X w_i = sigma_i^2 w_i,      v_i = X w_i / sigma_i,

M-orthonormal; the first k of them leave `sum_{i > k} sigma_i^2` of the squared mass norm of all snapshots, less than
any other space of k directions. No statement holds for loads outside the snapshots.

Without snapshots, those of the FE model are computed: steady responses to harmonic loads of unit static energy on each
interface coordinate with structural damping, `(K (1 + 2 i zeta) - omega^2 M) u = P F`, real and imaginary parts, by one
complex factorisation per frequency.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
import scipy.sparse as sp

from warpffrf.model.errors import InputError, require_count, require_number
from warpffrf.model.messages.named_arguments import named_arguments
from warpffrf.offline.bases.basis import Basis, ModalBasis
from warpffrf.offline.bases.modes import BasisProblem, RawBasis, global_basis, vibration_modes
from warpffrf.offline.bases.vibrations import shifted_solver
from warpffrf.offline.elastic import Array, ElasticModel


def _integral(mu: Array, alpha: Array, beta: Array) -> Array:
    """int Im(alpha_i e^(mu_i t)) Im(beta_j e^(mu_j t)) dt (m, m)."""
    a, b = alpha[:, None], beta[None, :]
    m, n = mu[:, None], mu[None, :]
    return 0.5 * np.real(a * b / (m + n) - a * b.conj() / (m + n.conj()))


def _poles(omega: Array, damping: float) -> Array:
    return omega * complex(-damping, np.sqrt(1.0 - damping**2))


def position_gramian(omega: Array, damping: float, b: Array) -> Array:
    """P_pp (m, m) = int q q^T dt of modes `omega` (m,) [rad/s] with ratio `damping` and inputs b (m, a)."""
    mu = _poles(omega, damping)
    one = 1.0 / np.imag(mu).astype(complex)
    return (b @ b.T) * _integral(mu, one, one)


def hankel_values(omega: Array, damping: float, b: Array) -> Array:
    """Hankel values (2 m,), descending, of the system from u to y = b^T q."""
    m = len(omega)
    mu = _poles(omega, damping)
    states = [omega / np.imag(mu) + 0j, mu / np.imag(mu)]  # amplitudes of omega q and of q'
    P = np.block([[_integral(mu, x, y) for y in states] for x in states]) * np.tile(b @ b.T, (2, 2))
    D = np.diag(2.0 * damping / omega)
    J = np.block([[D, np.diag(1.0 / omega)], [np.diag(1.0 / omega), np.zeros((m, m))]])
    values, vectors = np.linalg.eigh(0.5 * (P + P.T))
    L = vectors * np.sqrt(np.maximum(values, 0.0))
    return np.sort(np.abs(np.linalg.eigvalsh(L.T @ J @ L)))[::-1]


def modal_receptance(at: Array, omega: Array, damping: float, b: Array) -> Array:
    """b^T (Omega^2 + 2 i zeta w Omega - w^2)^-1 b (w, a, a) at the angular frequencies `at` (w,)."""
    response = 1.0 / (omega**2 + at[:, None] * (2j * damping * omega - at[:, None]))
    return b.T @ (response[:, :, None] * b)


def projected_receptance(at: Array, D: Array, K: Array, b: Array) -> Array:
    """b^T (K + i w D - w^2)^-1 b (w, a, a) at the angular frequencies `at` (w,); D, K dense (m, m), unit mass."""
    w = at[:, None, None]
    S = K + 1j * w * D - w**2 * np.eye(len(K))
    return b.T @ np.linalg.solve(S, np.broadcast_to(b.astype(complex), (len(at), *b.shape)))


POOL_RANGE = 2.0  # pool up to this times max_frequency: modes above still affect the receptance below
DEFAULT_POOL = 200  # vibration modes of a pool without limits
ROUND_OFF = 1e-14  # of the largest eigenvalue of the Gramian: directions below it are noise
REPORTED = 60  # leading Hankel values kept in the report


@named_arguments
@dataclass(frozen=True, kw_only=True)
class Balanced(ModalBasis):
    """Balanced truncation of the second-order system from interface loads to interface motion (position-velocity
    balancing, Reis and Stykel 2008), carried out in a large space of vibration and attachment modes, the pool.

    damping: ratio of every mode of the pool; the balanced energies are finite only with damping.
    pool_modes: vibration modes of the pool. None: all up to twice `max_frequency`, or 200.
    tolerance: if `modes` is not given, directions are added until twice the sum of the discarded Hankel values, the
        bound of first-order balanced truncation, is below this fraction of the largest response.
    """

    kind: ClassVar[str] = "balanced"
    takes: ClassVar[Mapping[str, str]] = {
        "max_frequency": "half the highest vibration mode of the pool",
        "modes": "number of balanced directions",
    }
    damping: float = 0.01
    pool_modes: int | None = None
    tolerance: float = 1e-3

    def __post_init__(self) -> None:
        super().__post_init__()
        self._below_one("damping")
        self._positive("tolerance")
        if self.pool_modes is not None:
            object.__setattr__(self, "pool_modes", require_count(self.pool_modes, "basis 'balanced': pool_modes", 1))

    def check_limits(self, max_frequency: float | None, modes: int | None) -> None:
        """Raises `InputError` if both `max_frequency` [Hz] and `pool_modes` are given, whatever `modes` is."""
        super().check_limits(max_frequency, modes)
        if max_frequency is not None and self.pool_modes is not None:
            raise InputError("basis 'balanced': max_frequency and pool_modes both set the pool; give one of them")

    def columns(self, problem: BasisProblem) -> RawBasis:
        problem.require_interfaces(self.kind)
        model, limits = problem.model, problem.limits
        problem.require_fits(self.kind, limits.count or 0, "balanced directions")
        problem.require_fits(self.kind, self.pool_modes or 0, "vibration modes in the pool")
        count = self.pool_modes
        if count is None and limits.omega_max is None:
            count = min(DEFAULT_POOL, problem.elastic_dofs)
        omega_max = None if limits.omega_max is None else POOL_RANGE * limits.omega_max
        _, V = vibration_modes(model, count=count, omega_max=omega_max, residual=self.mode_tolerance)
        loads, static = problem.unit_loads()
        omega, pool, _ = global_basis(model, V, static, dependent=self.dependent_tolerance)
        b = pool.T @ loads

        values, directions = np.linalg.eigh(position_gramian(omega, self.damping, b))
        values, directions = values[::-1], directions[:, ::-1]
        able = int(np.sum(values > ROUND_OFF * values[0]))
        hankel = hankel_values(omega, self.damping, b)
        grid = np.sort(np.concatenate([[0.0], omega, 0.5 * (omega[1:] + omega[:-1])]))
        full = modal_receptance(grid, omega, self.damping, b)
        largest = float(np.max(np.linalg.norm(full, ord=2, axis=(1, 2))))
        notes = []
        if limits.count is None:
            wanted = _by_tolerance(hankel, self.tolerance * largest)
        else:
            wanted = limits.count
            if wanted > able:
                notes.append(f"modes={wanted}: only {able} balanced directions are above round-off, these are used")
        kept = directions[:, : min(wanted, able)]
        bound = 2.0 * float(hankel[2 * kept.shape[1] :].sum()) / largest
        facts = {
            "pool_modes": V.shape[1],
            "pool_highest_frequency": float(omega[-1] / (2.0 * np.pi)),
            "balanced_directions": kept.shape[1],
            "hankel_values": [float(h) for h in hankel[:REPORTED] / largest],
            "first_order_bound": bound,
            "measured_error": _error(grid, full, omega, self.damping, b, kept) / largest,
        }
        # the pool contains the static responses, and so may the part that is kept
        return RawBasis(pool @ kept, redundant=static.shape[1], notes=notes, facts=facts)


def _by_tolerance(hankel: Array, allowed: float) -> int:
    """Least k for which twice the sum of all Hankel values but the first 2 k is at most `allowed`."""
    rest = 2.0 * np.append(np.cumsum(hankel[::-1])[::-1], 0.0)
    return int(np.argmax(rest[::2] <= allowed))


def _error(grid: Array, full: Array, omega: Array, damping: float, b: Array, kept: Array) -> float:
    """Largest spectral norm of the error of the receptance over `grid` of the space of kept directions and static
    responses, projected from the pool."""
    Q = np.linalg.qr(np.concatenate([b / (omega**2)[:, None], kept], axis=1))[0]
    D, K = Q.T @ ((2.0 * damping * omega)[:, None] * Q), Q.T @ ((omega**2)[:, None] * Q)
    reduced = projected_receptance(grid, D, K, Q.T @ b)
    return float(np.max(np.linalg.norm(full - reduced, ord=2, axis=(1, 2))))


# Relative distance of an expansion point from the Rayleigh quotient of its own response below which it coincides with a
# natural frequency: the response is then that mode alone, and half of the digits are lost.
RESONANT = 1e-8


@named_arguments
@dataclass(frozen=True, kw_only=True)
class Krylov(Basis):
    """Moment matching: block Krylov spaces of the interface loads about `expansion_points` [Hz] (B. Salimbahrami and B.
    Lohmann 2006).

    expansion_points: frequencies at which the interface receptance and its derivatives are matched. None: 0 and, if
        `max_frequency` is given, half of it and the whole.
    moments: blocks of vectors per point; m of them match the receptance and its first 2 m - 1 derivatives with respect
        to the square of the frequency. The space has up to (points x moments x interface loads) directions.
    deflation_tolerance: a vector of unit M-norm whose part outside the space so far is smaller ends its sequence.
    Raises `InputError`.
    """

    kind: ClassVar[str] = "krylov"
    takes: ClassVar[Mapping[str, str]] = {"max_frequency": "highest of the default expansion points"}
    cure: ClassVar[str] = "its size is set by bases.Krylov(expansion_points=..., moments=...)"
    expansion_points: tuple[float, ...] | None = None
    moments: int = 2
    deflation_tolerance: float = 1e-8

    def __post_init__(self) -> None:
        super().__post_init__()
        self._positive("deflation_tolerance")
        object.__setattr__(self, "moments", require_count(self.moments, "basis 'krylov': moments", 1))
        if self.expansion_points is not None:
            name = "basis 'krylov': expansion point [Hz]"
            points = tuple(require_number(f, name, non_negative=True) for f in self.expansion_points)
            if not points or len(set(points)) != len(points):
                raise InputError(f"basis 'krylov': expansion points {points} must be distinct, and at least one")
            object.__setattr__(self, "expansion_points", points)

    def check_limits(self, max_frequency: float | None, modes: int | None) -> None:
        """Raises `InputError` for `modes`, and for `max_frequency` [Hz] together with expansion points of the user."""
        super().check_limits(max_frequency, modes)
        if max_frequency is not None and self.expansion_points is not None:
            raise InputError("basis 'krylov': max_frequency only sets default expansion points; give one or the other")

    def columns(self, problem: BasisProblem) -> RawBasis:
        problem.require_interfaces(self.kind)
        points = expansion_points(problem, self)
        loads, static = problem.unit_loads()
        wanted = len(points) * self.moments * loads.shape[1]
        problem.require_fits(self.kind, wanted, "Krylov vectors")
        model = problem.model
        parts = []
        for hertz in points:
            if hertz == 0.0:
                parts.append(_sequence(model, model.flexibility, static, self))
                continue
            what = f"basis 'krylov': expansion point {hertz:g} Hz"
            solve = _shifted(model, (2.0 * np.pi * hertz) ** 2, problem.system.coordinates, what)
            parts.append(_sequence(model, solve, solve(model.self_equilibrated(loads)), self))
        columns = np.concatenate(parts, axis=1)
        facts = {"expansion_points": list(points), "moments": self.moments, "krylov_vectors": columns.shape[1]}
        # the first block about zero is the attachment modes themselves
        return RawBasis(columns, redundant=static.shape[1] if 0.0 in points else 0, facts=facts)


def expansion_points(problem: BasisProblem, options: Krylov) -> tuple[float, ...]:
    """Expansion points [Hz]: those given, else 0, and half and all of the highest frequency if there is one."""
    if options.expansion_points is not None:
        return options.expansion_points
    if problem.limits.omega_max is None:
        return (0.0,)
    highest = problem.limits.omega_max / (2.0 * np.pi)
    return (0.0, 0.5 * highest, highest)


def _shifted(model: ElasticModel, shift: float, coordinates: Array, what: str) -> Callable[[Array], Array]:
    solve = shifted_solver(model.K, model.M, shift, coordinates, what)

    def checked(f: Array) -> Array:
        u = model.without_rigid(solve(f))
        quotient = np.einsum("nm,nm->m", u, model.K @ u) / np.einsum("nm,nm->m", u, model.M @ u)
        if np.any(np.abs(quotient / shift - 1.0) < RESONANT):
            raise InputError(f"{what} is a natural frequency of the body; move it by a percent")
        return u

    return checked


def _sequence(model: ElasticModel, solve: Callable[[Array], Array], start: Array, options: Krylov) -> Array:
    """M-orthonormal blocks (n, up to moments x a) of the sequence that begins with `start` (n, a)."""
    Q = np.zeros((model.size, 0))
    block = start
    for step in range(options.moments):
        block = orthonormal_block(model, Q, block, options.deflation_tolerance)
        if not block.shape[1]:
            break
        Q = np.concatenate([Q, block], axis=1)
        if step + 1 < options.moments:
            block = solve(model.M @ block)
    return Q


def orthonormal_block(model: ElasticModel, Q: Array, block: Array, tolerance: float) -> Array:
    """M-orthonormal basis of the columns of `block` (n, b) outside the M-orthonormal Q (n, q), to which they are made
    orthogonal; directions of less than `tolerance` of a column of unit M-norm are omitted."""
    M = model.M
    block = block / np.sqrt(np.einsum("nb,nb->b", block, M @ block))
    for cut in (tolerance**2, 0.5):  # the second pass repairs orthogonality; what shrinks then was round-off
        for _ in range(2):
            block = block - Q @ (Q.T @ (M @ block))
        values, vectors = np.linalg.eigh(block.T @ (M @ block))
        keep = values > cut
        block = block @ (vectors[:, keep] / np.sqrt(values[keep]))
    return block


DEFAULT_FREQUENCIES = 20  # evenly from 0 to the highest
SNAPSHOT_ROUND_OFF = (
    1e-7  # of the largest singular value: the Gram matrix squares it, 1e-14 is the noise of its eigenvalues
)
RIGID = 1e-9  # of the mass norm of the snapshots: remainder of a pure rigid motion after its projection


@named_arguments
@dataclass(frozen=True, kw_only=True, eq=False)
class POD(Basis):
    """Proper orthogonal decomposition of snapshots (L. Sirovich 1987), in the inner product of the mass matrix.

    snapshots: displacements (nodes, 3, t) or (3 nodes, t) [m], mesh frame and numbering, small; rigid motion is
        removed. None: steady responses of the FE model to harmonic loads on the interfaces at `frequencies`.
    frequencies: [Hz], of the default snapshots. None: 20, evenly from 0 to `max_frequency`.
    damping: ratio of the structural damping in the default snapshots, K (1 + 2 i damping).
    tolerance: if `modes` is not given, vectors are added until the rest is below this fraction of all snapshots
        (root of the sum of squares, mass norm). Raises `InputError`.
    """

    kind: ClassVar[str] = "pod"
    takes: ClassVar[Mapping[str, str]] = {
        "max_frequency": "highest frequency of the default snapshots",
        "modes": "number of POD vectors",
    }
    snapshots: np.ndarray | None = None
    frequencies: tuple[float, ...] | None = None
    damping: float = 0.01
    tolerance: float = 1e-6

    def __post_init__(self) -> None:
        super().__post_init__()
        self._below_one("damping")
        self._below_one("tolerance")
        if self.snapshots is not None:
            if self.frequencies is not None:
                raise InputError("basis 'pod': snapshots are given, frequencies are not used; give one of them")
            try:
                X = np.array(self.snapshots, dtype=np.float64)
            except (TypeError, ValueError):
                raise InputError("basis 'pod': snapshots must be an array of numbers") from None
            if X.ndim == 3 and X.shape[1] == 3:
                X = X.reshape(-1, X.shape[2])
            if X.ndim != 2 or len(X) % 3 or not X.size:
                raise InputError(f"basis 'pod': snapshots must have shape (nodes, 3, t) or (3 nodes, t), got {X.shape}")
            if not np.all(np.isfinite(X)):
                raise InputError("basis 'pod': snapshots contain NaN or infinite numbers")
            X.setflags(write=False)
            object.__setattr__(self, "snapshots", X)
        if self.frequencies is not None:
            name = "basis 'pod': frequency [Hz]"
            found = tuple(require_number(f, name, non_negative=True) for f in self.frequencies)
            if not found:
                raise InputError("basis 'pod': frequencies are empty; give at least one")
            object.__setattr__(self, "frequencies", found)

    def check_limits(self, max_frequency: float | None, modes: int | None) -> None:
        """Raises `InputError` unless exactly one of `max_frequency` [Hz] and `frequencies` determines where snapshots
        are computed; modes: any number."""
        super().check_limits(max_frequency, modes)
        if max_frequency is not None and (self.snapshots is not None or self.frequencies is not None):
            raise InputError(
                "basis 'pod': max_frequency only sets the frequencies of default snapshots; leave it out here"
            )
        if max_frequency is None and self.snapshots is None and self.frequencies is None:
            raise InputError(
                "basis 'pod': give bases.POD(snapshots=...), bases.POD(frequencies=...) or max_frequency, which "
                "define the responses that it contains"
            )

    def columns(self, problem: BasisProblem) -> RawBasis:
        """The leading POD vectors of the body `problem`. Raises `InputError` for snapshots that do not fit it."""
        problem.require_fits(self.kind, problem.limits.count or 0, "POD vectors")
        facts: dict = {}
        if self.snapshots is None:
            frequencies = _frequencies(problem, self)
            X = harmonic_responses(problem, frequencies, self.damping)
            facts["frequencies"] = [float(f) for f in frequencies]
        else:
            if len(self.snapshots) != 3 * len(problem.system.points):
                raise InputError(
                    f"basis 'pod': snapshots are of {len(self.snapshots) // 3} nodes, the mesh has "
                    f"{len(problem.system.points)}; use those of the same mesh, in its numbering"
                )
            given = problem.system.from_nodes(self.snapshots)
            X = problem.model.without_rigid(given)
            if _mass_norm(problem, X) <= RIGID * _mass_norm(problem, given):
                raise InputError("basis 'pod': the snapshots contain rigid motion only; give some of the deformed body")
        M = problem.model.M
        values, W = np.linalg.eigh(X.T @ (M @ X))
        values, W = np.maximum(values[::-1], 0.0), W[:, ::-1]
        able = int(np.sum(values > SNAPSHOT_ROUND_OFF**2 * values[0]))
        rest = np.sqrt(np.append(np.cumsum(values[::-1])[::-1], 0.0) / values.sum())
        notes = []
        if problem.limits.count is None:
            kept = min(int(np.argmax(rest <= self.tolerance)), able)
        else:
            kept = min(problem.limits.count, able)
            if kept < problem.limits.count:
                notes.append(f"modes={problem.limits.count}: the snapshots span {able} directions, these are used")
        facts |= {"snapshots": X.shape[1], "pod_vectors": kept, "snapshots_left_out": float(rest[kept])}
        return RawBasis(X @ (W[:, :kept] / np.sqrt(values[:kept])), notes=notes, facts=facts)


def _mass_norm(problem: BasisProblem, X: Array) -> float:
    return float(np.sqrt(np.einsum("nt,nt->", X, problem.model.M @ X)))


def _frequencies(problem: BasisProblem, options: POD) -> Array:
    """Frequencies [Hz] of the default snapshots."""
    problem.require_interfaces(options.kind)
    if options.frequencies is not None:
        return np.array(options.frequencies)
    omega_max = problem.limits.omega_max
    if omega_max is None:
        raise InputError("basis 'pod': give snapshots, frequencies or max_frequency")
    return np.linspace(0.0, omega_max / (2.0 * np.pi), DEFAULT_FREQUENCIES)


def harmonic_responses(problem: BasisProblem, frequencies: Array, damping: float) -> Array:
    """Real and imaginary parts (n, t) of the responses to unit harmonic interface loads at `frequencies` (f,) [Hz]."""
    model = problem.model
    loads, static = problem.unit_loads()
    balanced = model.self_equilibrated(loads)
    parts = []
    for hertz in frequencies:
        if hertz == 0.0:
            parts.append(static)
            continue
        what = f"basis 'pod': frequency {hertz:g} Hz"
        stiffness = sp.csr_matrix(model.K * complex(1.0, 2.0 * damping))
        solve = shifted_solver(stiffness, model.M, (2.0 * np.pi * hertz) ** 2, problem.system.coordinates, what)
        u = solve(balanced.astype(complex))
        parts += [model.without_rigid(np.real(u)), model.without_rigid(np.imag(u))]
    return np.concatenate(parts, axis=1)
