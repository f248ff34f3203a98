"""What the facet sets of laps may not be used for beside."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

import numpy as np

from warpffrf.model.errors import InputError
from warpffrf.model.laps import LapCells
from warpffrf.model.mesh import Mesh


def require_sets(
    mesh: Mesh, laps: Mapping[str, LapCells], contact: Iterable[str], interfaces: Mapping[str, str]
) -> None:
    """Raises `InputError` for unknown facet sets, facets that a contact surface has too, or that both faces of a lap
    have, and sets that are rigid interfaces."""
    contact = list(contact)
    for name, lap in laps.items():
        for used in lap.fine:
            _named(mesh, name, used)
        for used in lap.sets:
            own = _named(mesh, name, used)
            if interfaces.get(used) == "rigid":
                raise InputError(
                    f"lap {name!r}: set {used!r} is a rigid interface, whose facets do not give way; make the "
                    "interface 'average', or use two sets"
                )
            for other in contact:
                if shared := len(own & _facets(mesh, other)):
                    raise InputError(
                        f"lap {name!r}: {shared} facets of {used!r} belong to contact surface {other!r} too; a facet "
                        "carries one or the other: separate the sets"
                    )
        if len(lap.sets) == 2 and (shared := len(_facets(mesh, lap.sets[0]) & _facets(mesh, lap.sets[1]))):
            raise InputError(
                f"lap {name!r}: {lap.sets[0]!r} and {lap.sets[1]!r} share {shared} facets, which cannot face "
                "themselves; separate the sets"
            )


def _named(mesh: Mesh, lap: str, name: str) -> set[tuple[int, ...]]:
    """`_facets`, whose `InputError` names the lap."""
    try:
        return _facets(mesh, name)
    except InputError as error:
        raise InputError(f"lap {lap!r}: {error}") from None


def _facets(mesh: Mesh, name: str) -> set[tuple[int, ...]]:
    """Each facet of a set by its sorted corners."""
    corners = mesh.facets(name).corners.values()
    return {tuple(facet) for nodes in corners for facet in np.sort(nodes, axis=1).tolist()}
