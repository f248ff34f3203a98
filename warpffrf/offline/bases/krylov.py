r"""Moment matching of the interface receptance by second-order block Krylov spaces (Salimbahrami and Lohmann 2006).

Undamped, the flexible receptance is a function of lambda = omega^2,

    H(lambda) = F^T (K - lambda M)^-1 P F = sum_j m_j (lambda - lambda_0)^j,
    m_j = F^T X_j,     X_0 = (K - lambda_0 M)^-1 P F,     X_j = (K - lambda_0 M)^-1 M X_{j-1}.

P F, the self-equilibrated loads, leave rigid motion alone, and M X_{j-1} does so again. A Galerkin projection on
X_0 ... X_{k-1} matches m_0 ... m_{2k-1}: K and M are symmetric and inputs are outputs, so each block counts on both
sides, and near lambda_0 the error is of order (lambda - lambda_0)^2k. At lambda_0 = 0 the solve is the inertia-relief
flexibility, and X_0 the attachment modes. The blocks of one point are M-orthonormalised one by one (block Arnoldi);
a direction that is exhausted leaves the sequence. There is no a-priori rule for how many points and moments a frequency
range needs; compare two sizes.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from warpffrf.model.bases import Krylov
from warpffrf.model.errors import InputError
from warpffrf.offline.bases.problem import BasisProblem, RawBasis
from warpffrf.offline.bases.shifted import shifted_solver
from warpffrf.offline.elastic import Array, ElasticModel

# Relative distance of an expansion point from the Rayleigh quotient of its own response below which it sits on a
# natural frequency: the response is then that mode alone, and the other half of the digits is lost.
RESONANT = 1e-8


def krylov(problem: BasisProblem, options: Krylov) -> RawBasis:
    """Krylov spaces about the expansion points. See the module docstring."""
    problem.require_interfaces(options.kind)
    points = expansion_points(problem, options)
    loads, static = problem.unit_loads()
    wanted = len(points) * options.moments * loads.shape[1]
    problem.require_fits(options.kind, wanted, "Krylov vectors")
    model = problem.model
    parts = []
    for hertz in points:
        if hertz == 0.0:
            parts.append(_sequence(model, model.flexibility, static, options))
            continue
        what = f"basis 'krylov': expansion point {hertz:g} Hz"
        solve = _shifted(model, (2.0 * np.pi * hertz) ** 2, problem.system.coordinates, what)
        parts.append(_sequence(model, solve, solve(model.self_equilibrated(loads)), options))
    columns = np.concatenate(parts, axis=1)
    facts = {"expansion_points": list(points), "moments": options.moments, "krylov_vectors": columns.shape[1]}
    # the first block about zero is the attachment modes themselves
    return RawBasis(columns, redundant=static.shape[1] if 0.0 in points else 0, facts=facts)


def expansion_points(problem: BasisProblem, options: Krylov) -> tuple[float, ...]:
    """Expansion points [Hz]: those given, else 0, and half and all of the highest frequency where there is one."""
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
    """M-orthonormal basis of the columns of `block` (n, b) outside the M-orthonormal Q (n, q), which they are freed
    from; directions of less than `tolerance` of a column of unit M-norm are left out."""
    M = model.M
    block = block / np.sqrt(np.einsum("nb,nb->b", block, M @ block))
    for cut in (tolerance**2, 0.5):  # the second pass repairs orthogonality; what shrinks then was round-off
        for _ in range(2):
            block = block - Q @ (Q.T @ (M @ block))
        values, vectors = np.linalg.eigh(block.T @ (M @ block))
        keep = values > cut
        block = block @ (vectors[:, keep] / np.sqrt(values[keep]))
    return block
