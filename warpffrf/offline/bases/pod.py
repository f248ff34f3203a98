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

import numpy as np
import scipy.sparse as sp

from warpffrf.model.bases import POD
from warpffrf.model.errors import InputError
from warpffrf.offline.bases.problem import BasisProblem, RawBasis
from warpffrf.offline.bases.shifted import shifted_solver
from warpffrf.offline.elastic import Array

DEFAULT_FREQUENCIES = 20  # evenly from 0 to the highest
ROUND_OFF = 1e-7  # of the largest singular value: the Gram matrix squares it, 1e-14 is the noise of its eigenvalues
RIGID = 1e-9  # of the mass norm of the snapshots: what is left when rigid motion is taken out of nothing else


def pod(problem: BasisProblem, options: POD) -> RawBasis:
    """Leading POD vectors. See the module docstring."""
    problem.require_fits(options.kind, problem.limits.count or 0, "POD vectors")
    facts: dict = {}
    if options.snapshots is None:
        frequencies = _frequencies(problem, options)
        X = harmonic_responses(problem, frequencies, options.damping)
        facts["frequencies"] = [float(f) for f in frequencies]
    else:
        if len(options.snapshots) != 3 * len(problem.system.points):
            raise InputError(
                f"basis 'pod': snapshots are of {len(options.snapshots) // 3} nodes, the mesh has "
                f"{len(problem.system.points)}; take them from the same mesh, in its numbering"
            )
        given = problem.system.from_nodes(options.snapshots)
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
        kept = min(int(np.argmax(rest <= options.tolerance)), able)
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
