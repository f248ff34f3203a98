"""What every basis is given, and what it gives back."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np

from warpffrf.model.errors import InputError
from warpffrf.model.mesh import Mesh
from warpffrf.offline.bases.modes import vibration_modes, whole_multiples
from warpffrf.offline.elastic import Array, ElasticModel
from warpffrf.offline.interfaces.system import InterfaceSystem
from warpffrf.offline.products import Limits

AHEAD = 4  # modes computed beyond those wanted, to see whether a multiple frequency would be cut apart


@dataclass(frozen=True, eq=False)
class BasisProblem:
    """What a basis is made for: the free constrained body `model` (n dofs), the `system` of its interfaces with loads F
    (n, a), the `limits` of `reduce`, the `attachments` G F (n, a), displacements [m] under these loads, and the `mesh`,
    for bases that look at facets."""

    model: ElasticModel
    system: InterfaceSystem
    limits: Limits
    attachments: Array
    mesh: Mesh | None = None

    @property
    def elastic_dofs(self) -> int:
        """Dofs less rigid motions: no basis can be larger."""
        return self.model.size - self.model.R.shape[1]

    def unit_loads(self) -> tuple[Array, Array]:
        """Interface loads and their attachment modes (n, a), scaled so that each load stores unit static energy
        f^T G f, which makes forces and moments comparable; loads that strain nothing are left out."""
        F = self.system.loads
        energy = np.einsum("na,na->a", F, self.attachments)
        straining = energy > 0.0
        scale = 1.0 / np.sqrt(energy[straining])
        return F[:, straining] * scale, self.attachments[:, straining] * scale

    def require_interfaces(self, kind: str) -> None:
        """Raises `InputError` where there are no interface loads to build the basis called `kind` from."""
        if not self.attachments.shape[1]:
            raise InputError(
                f"basis {kind!r} is built from loads on interfaces and there are none; name interfaces, or use "
                "'free_free'"
            )

    def require_fits(self, kind: str, wanted: int, what: str, available: int | None = None) -> None:
        """Raises `InputError` where `wanted` columns of the basis called `kind`, `what` in words, are more than are
        `available`, the elastic dofs if None."""
        most = self.elastic_dofs if available is None else available
        if wanted > most:
            raise InputError(
                f"basis {kind!r}: {wanted} {what} are more than the model has ({most}); ask for fewer, or refine the "
                "mesh"
            )


@dataclass(frozen=True, eq=False)
class RawBasis:
    """Columns (n, c) that shall be in the span of the global modes; rigid motion in them does not matter.

    redundant: how many of their directions lie in the span of the attachment modes or of other columns by their very
    construction, so that dropping them is no news. notes: lines for the report of the body; facts: plain data for its
    provenance.
    """

    columns: Array
    redundant: int = 0
    notes: list[str] = field(default_factory=list)
    facts: dict[str, Any] = field(default_factory=dict)


def lowest_modes(model: ElasticModel, limits: Limits, residual: float) -> tuple[Array, Array, list[str]]:
    """`omega` (m,) [rad/s] and M-orthonormal modes (n, m) within the limits, and notes. A multiple frequency is never
    cut apart."""
    wanted = limits.count if limits.count is None else limits.count + AHEAD * (limits.count > 0)
    omega, V = vibration_modes(model, count=wanted, omega_max=limits.omega_max, residual=residual)
    notes = []
    if limits.count is not None:
        kept = whole_multiples(omega, limits.count)
        if kept > limits.count:
            notes = [f"modes={limits.count} would split a pair of equal frequencies: {kept} are kept"]
        omega, V = omega[:kept], V[:, :kept]
    return omega, V, notes
