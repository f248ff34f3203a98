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

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from warpffrf.model.errors import InputError, require_count, require_number
from warpffrf.model.messages.named_arguments import named_arguments
from warpffrf.offline.bases.basis import Basis
from warpffrf.offline.bases.problem import BasisProblem, RawBasis
from warpffrf.offline.bases.shifted import shifted_solver
from warpffrf.offline.elastic import Array, ElasticModel

# Relative distance of an expansion point from the Rayleigh quotient of its own response below which it sits on a
# natural frequency: the response is then that mode alone, and the other half of the digits is lost.
RESONANT = 1e-8


@named_arguments
@dataclass(frozen=True, kw_only=True)
class Krylov(Basis):
    """Moment matching: block Krylov spaces of the interface loads about `expansion_points` [Hz] (B. Salimbahrami and B.
    Lohmann 2006).

    expansion_points: frequencies where the interface receptance and its derivatives are matched. None: 0 and, where
        `max_frequency` is given, half of it and the whole.
    moments: blocks of vectors a point; m of them match the receptance and its first 2 m - 1 derivatives with respect
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
        """Raises `InputError` for `modes`, and for `max_frequency` beside expansion points of one's own."""
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
