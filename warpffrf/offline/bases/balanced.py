r"""Balanced truncation of the second-order system from interface loads to interface motion.

Position-velocity balancing (Reis and Stykel 2008) takes the position controllability Gramian P_p and the velocity
observability Gramian Q_v; for P_p = L_p L_p^T, Q_v = L_v L_v^T and the singular value decomposition
`L_v^T M L_p = U Sigma V^T` the trial space is L_p V and the test space L_v U. A structure loaded and observed at the
same coordinates, with symmetric M, D and K, has `Q_v = P_p` (`gramians.py`), so that both spaces coincide: they are the
dominant eigenvectors of P_p in the inner product of M,

    P_p M v_i = sigma_i v_i.

The projection is Galerkin: M, D, K stay symmetric and definite, as the floating frame needs it, and all is real.

The Gramian of the FE model would need Lyapunov equations of its size. Balancing is carried out in a *pool* of vibration
modes and attachment modes instead, M-orthonormal, where with a modal damping ratio P_p has a closed form; what the pool
does not hold is not seen. Loads are scaled to unit static energy. `2 sum_{i > 2k} sigma_i` over the discarded Hankel
values bounds the error of *first-order* balanced truncation to 2 k states (Enns 1984, Glover 1984); a second-order one
with k coordinates has no such bound (Reis and Stykel), so its error is measured over the frequencies of the pool, with
the attachment modes included, and reported beside it.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from warpffrf.model.errors import InputError, require_count
from warpffrf.model.messages.named_arguments import named_arguments
from warpffrf.offline.bases.basis import ModalBasis
from warpffrf.offline.bases.global_basis import global_basis
from warpffrf.offline.bases.gramians import hankel_values, modal_receptance, position_gramian, projected_receptance
from warpffrf.offline.bases.modes import vibration_modes
from warpffrf.offline.bases.problem import BasisProblem, RawBasis
from warpffrf.offline.elastic import Array

POOL_RANGE = 2.0  # pool up to this times max_frequency: modes above still shape the receptance below
DEFAULT_POOL = 200  # vibration modes of a pool without limits
ROUND_OFF = 1e-14  # of the largest eigenvalue of the Gramian: directions below it are noise
REPORTED = 60  # leading Hankel values kept in the report


@named_arguments
@dataclass(frozen=True, kw_only=True)
class Balanced(ModalBasis):
    """Balanced truncation of the second-order system from interface loads to interface motion (position-velocity
    balancing, Reis and Stykel 2008), carried out in a large space of vibration and attachment modes, the pool.

    damping: ratio of every mode of the pool; the energies that are balanced are finite only with damping.
    pool_modes: vibration modes of the pool. None: all up to twice `max_frequency`, or 200.
    tolerance: where `modes` is not given, directions are taken until twice the sum of the discarded Hankel values, the
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
        """Raises `InputError` for `max_frequency` [Hz] beside `pool_modes`, whatever `modes` is."""
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
                notes.append(f"modes={wanted}: only {able} balanced directions are above round-off, these are taken")
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
        # the pool holds the static responses, and so may what is kept of it
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
