r"""Static equilibrium f(u) = p g of a body under a dead load g times a factor p, step by step.

`by_load` uses the given factors, with Newton's method in each: K(u) du = p g - f(u). It ends at a limit point, where
K is singular and no equilibrium is near.

`by_displacement` continues: a displacement c.u = s is given and the factor is found with it,

    K(u) du = p g - f(u) + dp g,      c.(u + du) = s      =>      du = a + dp b,   dp = (s - c.(u + a))/(c.b),

a = K^-1 (p g - f), b = K^-1 g (E. Ramm, in Nonlinear Finite Element Analysis in Structural Mechanics, 1981). The
factor may rise and fall on the way; the given displacement must be monotonic.

A state stores the residuals of its iterations; the last ones double the digits.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from scipy.sparse import csc_matrix
from scipy.sparse.linalg import splu

from references.large_deflections.body import StVenantKirchhoffBody
from warpffrf.model.errors import InputError

Array = np.ndarray
BALANCED = (
    1e-8  # of the load: tolerance of Newton's method; round-off of the large internal forces is 1e-9 in a slender body
)
ITERATIONS = 40  # it takes 4 to 12


@dataclass(frozen=True, eq=False)
class State:
    """An equilibrium: `u` (3 n,) [m], the `factor` p of the load, and the `residuals` |p g - f|/|p g| on the way."""

    u: Array
    factor: float
    residuals: list[float] = field(default_factory=list)


def by_load(
    body: StVenantKirchhoffBody, held: Array, load: Array, factors: Sequence[float] | Array, start: Array | None = None
) -> list[State]:
    """States under `load` (3 n,) [N] times each of the `factors`, each from the one before, the first from `start`
    (3 n,), None: at rest.

    Raises `InputError` if Newton's method does not converge: the step is too large, or leads past a limit.
    """
    free = body.free(held)
    u = np.zeros(body.size) if start is None else np.array(start, dtype=float)
    states = []
    for factor in factors:
        residuals = []
        for _ in range(ITERATIONS):
            rest = (factor * load - body.forces(u))[free]
            residuals.append(_size(rest, factor * load))
            if residuals[-1] < BALANCED:
                break
            u[free] += _factor(body, u, free).solve(rest)
            if not np.isfinite(u).all():
                break
        states.append(State(u.copy(), factor, _ended(residuals, f"load factor {factor:g}")))
    return states


def by_displacement(
    body: StVenantKirchhoffBody,
    held: Array,
    load: Array,
    dof: int,
    values: Sequence[float] | Array,
    start: State | None = None,
) -> list[State]:
    """States in which the displacement of `dof` has each of the `values` [m], each from the one before.

    Raises `InputError` as `by_load`, and for a dof that is held.
    """
    free = body.free(held)
    if dof not in free:
        raise InputError(f"by_displacement: dof {dof} is held; give one that moves")
    at = int(np.searchsorted(free, dof))
    u = np.zeros(body.size) if start is None else start.u.copy()
    factor = 0.0 if start is None else start.factor
    states = []
    for value in values:
        residuals = []
        for _ in range(ITERATIONS):
            rest = (factor * load - body.forces(u))[free]
            short = value - u[dof]
            residuals.append(max(_size(rest, max(abs(factor), BALANCED) * load), abs(short) / max(abs(value), 1e-300)))
            if residuals[-1] < BALANCED and len(residuals) > 1:
                break
            solver = _factor(body, u, free)
            a, b = solver.solve(rest), solver.solve(load[free])
            change = (short - a[at]) / b[at]
            u[free] += a + change * b
            factor += change
            if not np.isfinite(u).all():
                break
        states.append(State(u.copy(), factor, _ended(residuals, f"displacement {value:g} m")))
    return states


def _factor(body: StVenantKirchhoffBody, u: Array, free: Array):
    return splu(csc_matrix(body.tangent(u)[free][:, free]), permc_spec="MMD_AT_PLUS_A", options={"SymmetricMode": True})


def _size(rest: Array, load: Array) -> float:
    return float(np.linalg.norm(rest) / max(float(np.linalg.norm(load)), 1e-300))


def _ended(residuals: list[float], where: str) -> list[float]:
    if not residuals[-1] < BALANCED:
        raise InputError(
            f"large deflections: no equilibrium found at {where}, residual {residuals[-1]:.2g}; take smaller steps, or "
            "go by displacement past a limit point"
        )
    return residuals
