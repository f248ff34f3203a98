r"""Facet sets of a body without cells.

Where there are cells a facet takes its orientation from the cell it lies on. Here the orientation is taken as given,
and what can be checked is checked: neighbours pass their common edge in opposite directions, a surface without edges
encloses a positive volume, `V = 1/3 sum x . n A > 0` over its triangles, and the nodes that K couples with a facet lie
behind it (`inner_side`). With a dense, condensed K an open surface that is wholly inside out is not seen.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from warpffrf.model.errors import InputError
from warpffrf.model.mesh.elements import FACET_KINDS, facet_kind
from warpffrf.model.mesh.facets import FacetSet, node_numbers, triangles
from warpffrf.model.mesh.files.matrices.inner_side import require_on_surface

FLAT = 1e-9  # of the square of a facet's size: an area of round-off
KIND_OF_WIDTH = {len(facet_kind(kind).nodes): kind for kind in FACET_KINDS}


def facet_sets(facets: Mapping[str, Any] | None, points: np.ndarray, K: Any = None) -> dict[str, FacetSet]:
    """Facet sets from {name: `FacetSet`, nodes (m, k), or {kind: nodes (m, k)}}, nodes counted from 0, checked.

    With the stiffness `K` (3n, 3n) csr it is also seen which facets are no face of a cell. Raises `InputError` for a
    width that is no facet, node numbers out of range, facets without area, and facets that are turned against their
    neighbours, enclose a negative volume, lie inside the body or have normals into it.
    """
    if facets is not None and not isinstance(facets, Mapping):
        raise InputError(f"facets must be {{set name: nodes (m, k)}}, got {type(facets).__name__}")
    sets = {name: _facet_set(name, given) for name, given in (facets or {}).items()}
    for name, one in sets.items():
        _check_range(name, one, len(points))
        _check_area(name, one, points)
        _check_edges(one, f"facets {name!r}")
    if sets:
        whole = _without_repeats(sets)
        _check_edges(whole, f"facets {', '.join(map(repr, sets))} together")
        for label, one in [*((f"facets {name!r}", one) for name, one in sets.items()), ("the facets together", whole)]:
            _check_volume(one, points, label)
    if K is not None:
        for name, one in sets.items():
            require_on_surface(K, one, points, f"facets {name!r}")
    return sets


def _facet_set(name: str, given: Any) -> FacetSet:
    if isinstance(given, FacetSet):
        return given
    if isinstance(given, Mapping):
        return FacetSet(
            {kind: node_numbers(nodes, f"facets {name!r}: {kind}", _width(kind)) for kind, nodes in given.items()}
        )
    array = np.asarray(given)
    kind = KIND_OF_WIDTH.get(array.shape[1]) if array.ndim == 2 else None
    if kind is None:
        widths = ", ".join(f"{width} ({kind})" for width, kind in sorted(KIND_OF_WIDTH.items()))
        raise InputError(
            f"facets {name!r}: node numbers of shape (m, k) are needed, k one of {widths}, got {array.shape}"
        )
    return FacetSet({kind: node_numbers(array, f"facets {name!r}", array.shape[1])})


def _width(kind: str) -> int:
    return len(facet_kind(kind).nodes)


def _check_range(name: str, facets: FacetSet, count: int) -> None:
    nodes = facets.node_set
    if not len(nodes):
        raise InputError(f"facets {name!r}: the set is empty; leave it out, or select its facets again")
    if nodes[0] < 0 or nodes[-1] >= count:
        raise InputError(
            f"facets {name!r}: node numbers must lie in 0 to {count - 1}, got {nodes[0]} to {nodes[-1]}; they count "
            "the rows of `nodes` from 0, not the numbers of the FE program"
        )


def _check_area(name: str, facets: FacetSet, points: np.ndarray) -> None:
    for kind, corners in facets.corners.items():
        x = points[corners]
        # the vector area of a polygon, half the sum of cross products of consecutive corners
        area = 0.5 * np.linalg.norm(np.cross(x, np.roll(x, -1, axis=1)).sum(axis=1), axis=1)
        size = np.max(np.ptp(x, axis=1), axis=1)
        bad = np.flatnonzero(~(area > FLAT * size**2))
        if len(bad):
            raise InputError(
                f"facets {name!r}: {len(bad)} {kind} facet(s) without area, the first is number {bad[0]} with corners "
                f"{corners[bad[0]].tolist()}; corners come first, in order around the facet"
            )


def _edges(facets: FacetSet) -> np.ndarray:
    """Directed edges (e, 2) between the corners of all facets."""
    parts = [np.stack([c, np.roll(c, -1, axis=1)], axis=2).reshape(-1, 2) for c in facets.corners.values()]
    return np.concatenate(parts)


def _check_edges(facets: FacetSet, label: str) -> None:
    edges, count = np.unique(_edges(facets), axis=0, return_counts=True)
    if np.any(count > 1):
        a, b = edges[np.argmax(count > 1)]
        raise InputError(
            f"{label}: two facets pass the edge from node {a} to node {b} in the same direction, so one is inside out "
            "or listed twice; order the nodes so that normals point out of the body"
        )


def _check_volume(facets: FacetSet, points: np.ndarray, label: str) -> None:
    edges = _edges(facets)
    there, back = (np.unique(e, axis=0) for e in (edges, edges[:, ::-1]))
    if not np.array_equal(there, back):
        return  # an open surface
    x = points - points.mean(axis=0)
    a, b, c = (x[column] for column in triangles(facets).T)
    if np.einsum("ti,ti->", a, np.cross(b, c)) < 0.0:
        raise InputError(
            f"{label} enclose a negative volume: all normals point inwards; reverse the order of their nodes"
        )


def _without_repeats(sets: Mapping[str, FacetSet]) -> FacetSet:
    """All facets of all sets, those in several sets once."""
    merged: dict[str, list[np.ndarray]] = {}
    for one in sets.values():
        for kind, nodes in one.blocks.items():
            merged.setdefault(kind, []).append(nodes)
    blocks = {}
    for kind, parts in merged.items():
        nodes = np.concatenate(parts)
        first = np.unique(np.sort(nodes, axis=1), axis=0, return_index=True)[1]
        blocks[kind] = nodes[np.sort(first)]
    return FacetSet(blocks)
