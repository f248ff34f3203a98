r"""Proper orthogonal decomposition: the space nearest to given responses, in the inner product of M.

Of snapshots X (n, t), freed from rigid motion, the vectors are (method of snapshots, Sirovich 1987)

    X^T M X w_i = sigma_i^2 w_i,      v_i = X w_i / sigma_i,

M-orthonormal; the first k of them leave `sum_{i > k} sigma_i^2` of the squared mass norm of all snapshots, less than
any other space of k directions. Nothing is said about loads that the snapshots have not seen.

Without snapshots, those of the FE model are computed: steady responses to harmonic loads of unit static energy on each
interface coordinate with structural damping, `(K (1 + 2 i zeta) - omega^2 M) u = P F`, real and imaginary parts, by one
complex factorisation a frequency.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
import scipy.sparse as sp

from warpffrf.model.errors import InputError, require_number
from warpffrf.model.messages.named_arguments import named_arguments
from warpffrf.offline.bases.basis import Basis
from warpffrf.offline.bases.problem import BasisProblem, RawBasis
from warpffrf.offline.bases.shifted import shifted_solver
from warpffrf.offline.elastic import Array

DEFAULT_FREQUENCIES = 20  # evenly from 0 to the highest
ROUND_OFF = 1e-7  # of the largest singular value: the Gram matrix squares it, 1e-14 is the noise of its eigenvalues
RIGID = 1e-9  # of the mass norm of the snapshots: what is left when rigid motion is taken out of nothing else


@named_arguments
@dataclass(frozen=True, kw_only=True, eq=False)
class POD(Basis):
    """Proper orthogonal decomposition of snapshots (L. Sirovich 1987), in the inner product of the mass matrix.

    snapshots: displacements (nodes, 3, t) or (3 nodes, t) [m], mesh frame and numbering, small; rigid motion is taken
        out. None: steady responses of the FE model to harmonic loads on the interfaces at `frequencies`.
    frequencies: [Hz], of the default snapshots. None: 20, evenly from 0 to `max_frequency`.
    damping: ratio of the structural damping in the default snapshots, K (1 + 2 i damping).
    tolerance: where `modes` is not given, vectors are taken until the rest is below this fraction of all snapshots
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
                raise InputError("basis 'pod': snapshots are given, frequencies have no use; give one of them")
            try:
                X = np.array(self.snapshots, dtype=np.float64)
            except (TypeError, ValueError):
                raise InputError("basis 'pod': snapshots must be an array of numbers") from None
            if X.ndim == 3 and X.shape[1] == 3:
                X = X.reshape(-1, X.shape[2])
            if X.ndim != 2 or len(X) % 3 or not X.size:
                raise InputError(f"basis 'pod': snapshots must have shape (nodes, 3, t) or (3 nodes, t), got {X.shape}")
            if not np.all(np.isfinite(X)):
                raise InputError("basis 'pod': snapshots hold NaN or infinite numbers")
            X.setflags(write=False)
            object.__setattr__(self, "snapshots", X)
        if self.frequencies is not None:
            name = "basis 'pod': frequency [Hz]"
            found = tuple(require_number(f, name, non_negative=True) for f in self.frequencies)
            if not found:
                raise InputError("basis 'pod': frequencies are empty; give at least one")
            object.__setattr__(self, "frequencies", found)

    def check_limits(self, max_frequency: float | None, modes: int | None) -> None:
        """Raises `InputError` where it is open, or twice said, at which frequencies snapshots are to be computed:
        `max_frequency` [Hz] or `frequencies`; modes: any number."""
        super().check_limits(max_frequency, modes)
        if max_frequency is not None and (self.snapshots is not None or self.frequencies is not None):
            raise InputError(
                "basis 'pod': max_frequency only sets the frequencies of default snapshots; leave it out here"
            )
        if max_frequency is None and self.snapshots is None and self.frequencies is None:
            raise InputError(
                "basis 'pod': give bases.POD(snapshots=...), bases.POD(frequencies=...) or max_frequency, so that it "
                "is known what responses it shall hold"
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
                    f"{len(problem.system.points)}; take them from the same mesh, in its numbering"
                )
            given = problem.system.from_nodes(self.snapshots)
            X = problem.model.without_rigid(given)
            if _mass_norm(problem, X) <= RIGID * _mass_norm(problem, given):
                raise InputError("basis 'pod': the snapshots hold rigid motion only; give some of the deformed body")
        M = problem.model.M
        values, W = np.linalg.eigh(X.T @ (M @ X))
        values, W = np.maximum(values[::-1], 0.0), W[:, ::-1]
        able = int(np.sum(values > ROUND_OFF**2 * values[0]))
        rest = np.sqrt(np.append(np.cumsum(values[::-1])[::-1], 0.0) / values.sum())
        notes = []
        if problem.limits.count is None:
            kept = min(int(np.argmax(rest <= self.tolerance)), able)
        else:
            kept = min(problem.limits.count, able)
            if kept < problem.limits.count:
                notes.append(f"modes={problem.limits.count}: the snapshots hold {able} directions, these are taken")
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
