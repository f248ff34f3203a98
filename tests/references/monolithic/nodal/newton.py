"""Contribution of pairs with the law at nodes to a Newton iteration: state, stiffness, and step control.

The law gives forces, no multipliers, so that contact stiffness goes into the Jacobian (semismooth Newton). An
iteration passes to the next, per node, the gap at which its law was linearised (`layer_slopes`) and its traction
(`friction`). Steps that would move one body through another are shortened; if an iteration does not converge
soon, a step that increases the residual is halved.
"""

from __future__ import annotations

import copy
from typing import Any

import numpy as np

from references.monolithic.core.equations import Balance, Increment, Trial
from references.monolithic.core.integrator import BEGIN, PROJECT, REST, Formula
from references.monolithic.core.linear import Solver, Woodbury
from references.monolithic.core.state import Layout, State
from references.monolithic.nodal.pair import NodePairData, Sight
from references.monolithic.nodal.tangent import LinearisedPair

PATIENCE = 8  # iterations with full steps, as a change of the active set may raise the residual
MOST_HALVINGS = 4  # then the iteration continues with a sixteenth: the residual has a kink there
LONGEST = 1e-2  # of the smaller radius: how deep bodies may start in one another (`warpffrf.model.checks.contacts`)
MAX_ITERATIONS = 80  # of Newton, not counting halvings


def node_pair_state(
    data: NodePairData, layout: Layout, trial: Trial, state: State, formula: Formula, local: tuple[Any, Any],
    iterate: np.ndarray | None = None,
) -> LinearisedPair:  # fmt: skip
    """The pair at `trial`; `local`: slices in `q` of both sides' local coordinates, None of a rigid one; iterate (n,
    3): see `pair.Sight`."""
    (r_a, A_a), (r_b, A_b) = (
        (np.zeros(3), np.eye(3)) if body < 0 else (trial.r[body], trial.A[body]) for body in (data.a.body, data.b.body)
    )
    q_a, q_b = (
        np.zeros(0) if own is None else np.concatenate([trial.q[layout.body_modes(body)], trial.q[own]])
        for body, own in zip((data.a.body, data.b.body), local, strict=True)
    )
    moving = formula.coefficients not in (REST, PROJECT, BEGIN)
    sight = Sight(r_a, A_a, r_b, A_b, q_a, q_b, state.nodes[data.rows], formula.h, moving, iterate)
    return LinearisedPair(data, sight)


def add_stiffness(solver: Solver, size: int, pairs: list[Any]) -> Solver:
    """A factored K with the stiffness of the pairs' nodes."""
    found = [s for pair in pairs if (s := stiffness_of(pair)) is not None]
    return Woodbury(solver, size, [(at, L, W) for at, L, W, _ in found]) if found else solver


def stiffness_of(pair: LinearisedPair) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray] | None:
    """(columns, L, -M R, 1) as `linear.dense_jacobian` adds them; None if no node is active."""
    if not len(pair.active):
        return None
    L, R = pair.rows
    return pair.data.columns, L, pair.weighted(R), np.ones(len(L))


class Halving:
    """Halves a step, of increments and of nodal iterates, that increased the residual."""

    def __init__(self) -> None:
        self.step: tuple[Increment, np.ndarray, np.ndarray, list[Any], list[Any]] | None = None
        self.found, self.fraction, self.halvings = np.inf, 1.0, 0

    def keep(self, x: Increment, z: np.ndarray, evaluation: Any, new: list[Any], found: float) -> None:
        """The step z from x, evaluated with the residual `found`, and to the iterates `new` from those there."""
        old = [pair.sight.iterate for pair in evaluation.pairs]
        self.step, self.found = (copy.deepcopy(x), z, evaluation.trial.T_inverse, old, new), found
        self.fraction, self.halvings = 1.0, 0

    def shortened(self, iteration: int, now: float, layout: Layout) -> tuple[Increment, list[Any]] | None:
        """Increments and iterates after half of the last step if `now` is too large, else None."""
        if self.step is None or self.halvings >= MOST_HALVINGS or iteration <= PATIENCE or now <= self.found:
            return None
        self.halvings += 1
        self.fraction *= 0.5
        x, z, T_inverse, old, new = self.step
        half = copy.deepcopy(x)
        half.add(self.fraction * z, layout, T_inverse)
        return half, [_between(a, b, self.fraction) for a, b in zip(old, new, strict=True)]


def _between(old: np.ndarray, new: np.ndarray, part: float) -> np.ndarray:
    """Iterates with a part of the change of tractions; the gap of the last linearisation stays."""
    return np.column_stack([new[:, :1], old[:, 1:] + part * (new[:, 1:] - old[:, 1:])])


def cut_short(pairs: list[Any], z: np.ndarray) -> tuple[np.ndarray, list[Any]]:
    """The step z, limited so that no body passes through another, and the iterates of all pairs after it.

    A step may close the existing gap and LONGEST of the smaller radius more: in a static step a load without contact
    yet moves a body arbitrarily far.
    """
    part = 1.0
    for pair in pairs:
        data, dz = pair.data, z[pair.data.columns]
        free = max(float(pair.gap[pair.over.faces].min(initial=np.inf)), 0.0)
        way = float(np.linalg.norm(dz[0:3] - (dz[6:9] if data.rigid > 6 else 0.0)))
        way += data.extent * float(np.linalg.norm(dz[3:6]) + (np.linalg.norm(dz[9:12]) if data.rigid > 6 else 0.0))
        allowed = free + LONGEST * data.extent
        part = min(part, allowed / way if way > allowed else 1.0)
    found = []
    for pair in pairs:
        new = pair.updated(z[pair.data.columns])
        found.append(new if part == 1.0 else _between(pair.sight.iterate, new, part))
    return part * z, found


def with_constants(residual: np.ndarray, pairs: list[Any]) -> np.ndarray:
    """The residual (size,) with the part of the change of tractions that is independent of the unknowns."""
    out = residual.copy()
    for pair in pairs:
        out[pair.data.columns] -= pair.constant()
    return out


def size_of(balance: Balance, residual: np.ndarray, layout: Layout) -> float:
    """The residual of all coordinates, each over the root of its stiffness and inertia: an energy, except for rows."""
    if not np.all(np.isfinite(residual)):
        return np.inf
    o, c = layout.retained, layout.coordinates
    scale = np.concatenate([np.abs(np.diag(balance.retained)[:o]), np.abs(balance.diagonal)])
    return float(np.sqrt(np.sum(residual[:c] ** 2 / np.where(scale > 0.0, scale, 1.0))))
