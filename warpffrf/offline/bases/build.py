r"""From any basis to global modes: attachment modes first, then orthonormalisation of the union.

Columns X of a basis are projected off rigid motion, `X := P^T X` (M-orthogonal: Tisserand frame); the inertia-relief
attachment modes `A = G F` of all interface loads precede them; `global_basis` makes the union K- and M-orthonormal and
reveals its rank. With A in the span of Phi, for every basis,

    Phi Omega^-2 Phi^T F = G F,        F^T (G - Phi Omega^-2 Phi^T) = 0:

the static response to interface loads is exact and the residual local modes leave the interface coordinates at rest.
The same holds for the loads of rotation, if requested. If a basis does not already contain A, `static_completion`
measures the gap: the largest energy norm of a unit-energy attachment mode outside its span.
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
    """`omega` (m,) [rad/s] ascending, Phi (n^, m) in the coordinates of the constrained model, and report entries."""

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
    """Global modes of the free constrained body `model` from the basis `options`; `turning` (n^, 6): loads of rotation
    whose attachment modes are added (`inertia.centrifugal`); `mesh`: of the body, for bases that use facets.

    Raises `InputError` for a basis larger than the model, for one that requires interfaces if there are none, and for
    limits that it does not accept.
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
