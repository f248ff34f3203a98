"""Which space the global modes of a reduced body are taken from: one file each, one orthonormalisation (`build`).

A basis is given to `reduce` by name, `basis="krylov"`, or with options, `basis=bases.Krylov(moments=3)`.
Whatever the basis, the attachment modes of the interfaces are put first, so that the static response to interface loads
is exact and the local modes never move an interface, and the union is orthonormalised by the same code. `reduce`'s
limits `max_frequency` and `modes` mean something else to each basis; `takes` says what, and a limit that means nothing
to a basis is refused. A basis of one's own is a subclass of `Basis` with `columns`.
"""

from __future__ import annotations

from typing import Any

from warpffrf.model.errors import unknown_name
from warpffrf.offline.bases.basis import Basis
from warpffrf.offline.bases.modes import BasisProblem, RawBasis
from warpffrf.offline.bases.responses import POD, Balanced, Krylov, TrialVectorDerivatives
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
