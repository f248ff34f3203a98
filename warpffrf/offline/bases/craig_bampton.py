r"""Fixed-interface modes and constraint modes (Craig and Bampton 1968), for any kind of interface.

The interface coordinates are F^T u, with F the unit loads. Holding them at rest means reactions `-F lam`:

    K u = f - F lam,      F^T u = 0.

The free body must be in balance, `R^T (f - F lam) = 0`, and then `u = G (f - F lam) + R c` with the inertia-relief
flexibility G and a rigid motion c. So the same factorisation serves, and what holds the interface is a small system,

    [ F^T G F   B^T ] [ lam ]   [ F^T G f ]
    [ B         0   ] [ -c  ] = [ R^T f   ],      B = R^T F (r, a),

whatever F is: dofs of rigid interfaces, dofs of nodes, or averages of nodes. Any one interface holds the body, rank B
= r. *Fixed-interface modes* are those of this flexibility; the *constraint mode* of interface coordinate j has the
right-hand side (e_j, 0) and no load f. Its reactions are in balance, so that

    u_j = G F lam_j + R c_j

is a combination of attachment modes and rigid motion: the constraint modes lie in the span of the attachment modes that
come first anyway. What those add are responses to interface loads with inertia relief, r directions.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from warpffrf.model.messages.named_arguments import named_arguments
from warpffrf.offline.bases.basis import ModalBasis
from warpffrf.offline.bases.problem import BasisProblem, RawBasis, lowest_modes
from warpffrf.offline.elastic import Array, ElasticModel

# Singular value, of the largest, of the scaled small system below which interface coordinates depend on each other (two
# free interfaces share nodes): the square of what round-off leaves of a dependent column.
DEPENDENT = 1e-12


@named_arguments
@dataclass(frozen=True, kw_only=True)
class CraigBampton(ModalBasis):
    """Vibration modes of the body with all interfaces held, and constraint modes (Craig and Bampton 1968)."""

    kind: ClassVar[str] = "craig_bampton"
    takes: ClassVar[Mapping[str, str]] = {
        "max_frequency": "highest fixed-interface mode",
        "modes": "number of fixed-interface modes",
    }

    def columns(self, problem: BasisProblem) -> RawBasis:
        problem.require_interfaces(self.kind)
        held, constraint_modes, rank = hold_interfaces(problem)
        problem.require_fits(
            self.kind, problem.limits.count or 0, "fixed-interface modes", available=problem.model.size - rank
        )
        omega, V, notes = lowest_modes(held, problem.limits, self.mode_tolerance)
        columns = np.concatenate([V, constraint_modes], axis=1)
        facts: dict[str, Any] = {"fixed_interface_modes": len(omega), "constraint_modes": rank}
        if len(omega):
            facts["fixed_interface_frequencies"] = [float(omega[0] / (2 * np.pi)), float(omega[-1] / (2 * np.pi))]
        return RawBasis(columns, redundant=constraint_modes.shape[1], notes=notes, facts=facts)


def hold_interfaces(problem: BasisProblem) -> tuple[ElasticModel, Array, int]:
    """The body with all interface coordinates held, constraint modes (n, a), and the number of held coordinates."""
    model, F, A = problem.model, problem.system.loads, problem.attachments
    r, a = model.R.shape[1], F.shape[1]
    B = model.R.T @ F
    # unit energy a load, unit norm a rigid motion: forces and moments, lengths and angles become comparable
    D = F.T @ A
    scale = 1.0 / np.sqrt(np.diag(D))
    rows = 1.0 / np.linalg.norm(B * scale, ord=2)
    system = np.block([[scale[:, None] * D * scale, (B * scale).T * rows], [B * scale * rows, np.zeros((r, r))]])
    values = np.linalg.svd(system, compute_uv=False)
    inverse = np.linalg.pinv(system, rcond=DEPENDENT, hermitian=True)
    rank = int(np.sum(values > DEPENDENT * values[0])) - r

    def reactions(at_interface: Array, on_rigid: Array) -> tuple[Array, Array]:
        """lam (a, m) and -c (r, m)."""
        x = inverse @ np.concatenate([scale[:, None] * at_interface, rows * on_rigid])
        return scale[:, None] * x[:a], rows * x[a:]

    def solve(f: Array) -> Array:
        u, on_rigid = model.flexibility(f), model.R.T @ f
        for _ in range(2):  # the second pass takes out what round-off left of the interface's motion
            lam, c = reactions(F.T @ u, on_rigid)
            u, on_rigid = u - A @ lam - model.R @ c, np.zeros_like(on_rigid)
        return u

    lam, c = reactions(np.eye(a), np.zeros((r, a)))
    held = ElasticModel(model.K, model.M, np.zeros((model.size, 0)), solve)
    return held, A @ lam + model.R @ c, rank
