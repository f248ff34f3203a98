r"""From any basis to global modes: the one place where attachment modes come first and everything is orthonormalised.

Columns X of a basis are freed from rigid motion, `X := P^T X` (M-orthogonal: Tisserand frame); the inertia-relief
attachment modes `A = G F` of all interface loads are put before them; `global_basis` makes the union K- and
M-orthonormal, revealing rank. With A in the span of Phi, for every basis,

    Phi Omega^-2 Phi^T F = G F,        F^T (G - Phi Omega^-2 Phi^T) = 0:

the static response to interface loads is exact and the residual local modes leave the interface coordinates at rest.
So it is to the loads of turning, where these are wanted.
Where a basis lacks A of its own, `static_completion` says by how much: the largest energy norm of a unit-energy
attachment mode outside its span.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from warpffrf.model.mesh import Mesh
from warpffrf.offline.bases.basis import Basis
from warpffrf.offline.bases.modes import BasisProblem, attachment_modes, global_basis, missing_energy
from warpffrf.offline.elastic import Array, ElasticModel
from warpffrf.offline.interfaces import InterfaceSystem
from warpffrf.offline.products import Limits


@dataclass(frozen=True, eq=False)
class GlobalBasis:
    """`omega` (m,) [rad/s] ascending, Phi (n^, m) in the coordinates of the constrained model, and what to report."""

    omega: Array
    Phi: Array
    facts: dict[str, Any]


def build_basis(
    options: Basis,
    model: ElasticModel,
    system: InterfaceSystem,
    limits: Limits,
    turning: Array | None = None,
    mesh: Mesh | None = None,
) -> GlobalBasis:
    """Global modes of the free constrained body `model` from the basis `options`; `turning` (n^, 6): loads of turning
    whose attachment modes are wanted too (`inertia.centrifugal`); `mesh`: of the body, for bases that look at facets.

    Raises `InputError` for a basis larger than the model, for one that needs interfaces where there are none, and for
    limits that it does not take.
    """
    A = attachment_modes(model, system.loads)
    raw = options.columns(BasisProblem(model, system, limits, A, mesh))
    if turning is not None:
        A = np.concatenate([A, attachment_modes(model, turning)], axis=1)
    V = model.without_rigid(raw.columns)
    omega, Phi, dropped = global_basis(model, V, A, dependent=options.dependent_tolerance)
    facts = {
        "dependent_directions_dropped": max(dropped - raw.redundant, 0),
        "notes": raw.notes,
        "basis": {
            "kind": options.kind,
            "columns": raw.columns.shape[1],
            "static_completion": {
                "attachment_modes": A.shape[1],
                "missing_before": missing_energy(model, V, A, dependent=options.dependent_tolerance),
            },
            **raw.facts,
        },
    }
    return GlobalBasis(omega, Phi, facts)
