"""The spaces of the global modes of a reduced body: one class each, and one orthonormalisation (`build`).

A basis is given to `reduce` by name, `basis="krylov"`, or with options, `basis=bases.Krylov(moments=3)`.
For every basis the attachment modes of the interfaces come first, so that the static response to interface loads is
exact and the local modes never move an interface; the union is orthonormalised by the same code. The limits
`max_frequency` and `modes` of `reduce` have a meaning specific to each basis, stated in `takes`; a limit without
meaning for a basis is refused. A user-defined basis is a subclass of `Basis` with `columns`.
"""

from __future__ import annotations

from typing import Any

from warpffrf.model.errors import unknown_name
from warpffrf.offline.bases.basis import Basis
from warpffrf.offline.bases.modes import BasisProblem, RawBasis
from warpffrf.offline.bases.responses import POD, Balanced, Krylov
from warpffrf.offline.bases.trial_vector_derivatives import TrialVectorDerivatives
from warpffrf.offline.bases.vibrations import CraigBampton, CraigChang, FreeFree

BASES: dict[str, type[Basis]] = {
    cls.kind: cls for cls in (FreeFree, CraigBampton, CraigChang, Krylov, Balanced, POD, TrialVectorDerivatives)
}

__all__ = [
    "BASES", "Balanced", "Basis", "BasisProblem", "CraigBampton", "CraigChang", "FreeFree", "Krylov", "POD", "RawBasis",
    "TrialVectorDerivatives",
]  # fmt: skip


def __dir__() -> list[str]:
    return __all__


def basis_options(basis: Any) -> Basis:
    """The basis behind `reduce`'s argument `basis`: a name of `BASES`, or a basis. Raises `InputError`."""
    if isinstance(basis, Basis):
        return basis
    if isinstance(basis, str) and basis in BASES:
        return BASES[basis]()
    raise unknown_name("basis", basis, BASES)
