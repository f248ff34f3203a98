r"""The side of a facet on which the body lies, from K alone.

Two nodes of one cell are coupled: their block of K is not zero. The corners of a face of a cell are therefore coupled
with one another, and the nodes that are coupled with all of them are those of the cells at the face (in meshes of
tetrahedra a few more). With n the unit normal of a facet, c the mean of its corners and d_j = n . (x_j - c) for those
nodes that are not on the facet,

    s = sum d_j / sum |d_j|

is -1 where all of them lie behind the facet, as on the surface with an outward normal, +1 with an inward one, and near
0 for a face between two cells. The median over a set is used, so that a single odd cell has no effect.

A condensed K couples all nodes with each other and gives no information: rows longer than `LONGEST_ROW` are skipped.

Surfaces. Facet sets of a body without cells.

Where there are cells a facet takes its orientation from the cell it lies on. Here the given orientation is used
and checked: neighbours pass their common edge in opposite directions, a surface without edges
encloses a positive volume, `V = 1/3 sum x . n A > 0` over its triangles, and the nodes that K couples with a facet lie
behind it (`inner_side`). With a dense, condensed K an open surface that is completely inverted is not detected.

Motion. Test of the order of nodes and dofs: rigid motion has no strain energy and the total mass.

With R (3 n, 6) the rigid motions of the nodes, `K R = 0`; each row of K R is a sum that must cancel, so it is compared
with the sum of its magnitudes, `|K R|_r <= RIGID (|K| |R|)_r`. Nodes or components in another order than the rows
violate it: translations detect exchanged components, rotations exchanged nodes too. The mass of a body is the same in
the three directions, `R_t^T M R_t = m I`. An M whose nodes have another order than those of K shows in entries that
couple nodes which K does not couple; a lumped M does not show it.

Neither test detects a wrong unit of length: lengths and stiffnesses together are checked by `plausibility`.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from warpffrf.model.errors import InputError
from warpffrf.model.mesh.elements import FACET_KINDS, facet_kind
from warpffrf.model.mesh.facets import FacetSet, node_numbers, rigid_modes, triangles

LONGEST_ROW = 1000  # nodes coupled with one node, in the mean: hex27 have 125, quadratic tetrahedra some 50 to 200
INSIDE = 0.35  # |s| of a face between two cells of unequal depth: up to 1 : 2


def require_on_surface(K: Any, facets: FacetSet, points: np.ndarray, label: str) -> None:
    """Raise `InputError` for facets of no cell, inside the body, or with inward normals; K (3n, 3n) csr."""
    sides = []
    for kind, corners in facets.corners.items():
        nodes = facets.blocks[kind]
        coupled = _coupled(K, corners, len(points))
        if coupled is None:
            return
        torn = np.flatnonzero(~_holds(coupled, corners).all(axis=1))
        if len(torn):
            raise InputError(
                f"{label}: {len(torn)} {kind} facet(s) are no face of a cell, K does not couple their corners; the "
                f"first is number {torn[0]} with corners {corners[torn[0]].tolist()}; give positions in `nodes` "
                "counted from 0, corners first"
            )
        sides.append(_side(coupled, corners, nodes, points))
    s = float(np.median(np.concatenate(sides)))
    if abs(s) < INSIDE:
        raise InputError(f"{label}: the body lies on both sides of them; choose facets on the surface")
    if s > 0.0:
        raise InputError(f"{label}: the normals point into the body; reverse the order of the nodes of each facet")


def _coupled(K: Any, corners: np.ndarray, count: int) -> Any:
    """Nodes coupled with all corners of each facet, csr (m, count) of ones; None where K is dense."""
    from scipy.sparse import csr_matrix

    used, place = np.unique(corners, return_inverse=True)
    dofs = (3 * used[:, None] + np.arange(3)).ravel()
    rows = csr_matrix(K.tocsr()[dofs])
    if rows.nnz > 9 * LONGEST_ROW * len(used):
        return None
    kept = rows.data != 0.0
    node = np.repeat(np.arange(len(dofs)), np.diff(rows.indptr))[kept] // 3
    graph = csr_matrix((np.ones(len(node), dtype=np.int32), (node, rows.indices[kept] // 3)), shape=(len(used), count))
    graph.data[:] = 1  # duplicates were summed
    m, c = corners.shape
    of_facet = csr_matrix((np.ones(m * c, dtype=np.int32), (np.repeat(np.arange(m), c), place.ravel())), (m, len(used)))
    common = csr_matrix(of_facet @ graph)
    common.data = (common.data == c).astype(np.int32)
    common.eliminate_zeros()
    return common


def _holds(common: Any, nodes: np.ndarray) -> np.ndarray:
    """Whether each of the nodes (m, k) is among the common ones of its facet."""
    row = np.repeat(np.arange(len(nodes)), nodes.shape[1])
    found: Any = common[row, nodes.ravel()]
    return np.asarray(found).reshape(nodes.shape) > 0


def _side(common: Any, corners: np.ndarray, nodes: np.ndarray, points: np.ndarray) -> np.ndarray:
    """s (m,) of each facet; -1 where it is unknown."""
    x = points[corners]
    normal = np.cross(x, np.roll(x, -1, axis=1)).sum(axis=1)
    normal /= np.linalg.norm(normal, axis=1)[:, None]
    row = np.repeat(np.arange(len(corners)), np.diff(common.indptr))
    d = np.einsum("ei,ei->e", points[common.indices] - x.mean(axis=1)[row], normal[row])
    d[(nodes[row] == common.indices[:, None]).any(axis=1)] = 0.0
    total = np.bincount(row, np.abs(d), len(corners))
    return np.where(total > 0.0, np.bincount(row, d, len(corners)) / np.where(total > 0.0, total, 1.0), -1.0)


FLAT = 1e-9  # of the square of a facet's size: an area of round-off
KIND_OF_WIDTH = {len(facet_kind(kind).nodes): kind for kind in FACET_KINDS}


def facet_sets(facets: Mapping[str, Any] | None, points: np.ndarray, K: Any = None) -> dict[str, FacetSet]:
    """Facet sets from {name: `FacetSet`, nodes (m, k), or {kind: nodes (m, k)}}, nodes counted from 0, checked.

    With the stiffness `K` (3n, 3n) csr facets that are no face of a cell are detected too. Raises `InputError` for a
    width that is no facet, node numbers out of range, facets without area, and facets that are oriented against their
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


RIGID = 1e-5  # of the sum of magnitudes: coordinates written with six digits; a wrong order gives 1e-3 to 1
RIGID_NOTE = 1e-9  # above it a note states that the files are rounded: double precision leaves 1e-12
SAME_MASS = 1e-6  # of the mass: matrices in single precision sum to it
FOREIGN = 0.1  # of M's couplings may lie where K has none: exact zeros of K are few, a wrong order makes nearly all
USUAL_DENSITY = (10.0, 3e4)  # kg/m3 of mass over bounding box: foams to heavy metals; thin rings fill little of it
USUAL_SPEED = (30.0, 3e5)  # m/s, rubber to diamond, and what the estimate of the node distance leaves open
NAMES = (
    "translation along x",
    "translation along y",
    "translation along z",
    "rotation about x",
    "rotation about y",
    "rotation about z",
)


def require_free(K: Any, M: Any, points: np.ndarray) -> float:
    """Largest residual of K R (see above). Raises `InputError` above `RIGID`, naming the motion and the nodes."""
    R = rigid_modes(points, points.mean(axis=0))
    residual = _relative(K, R)
    worst = float(residual.max())
    if not worst > RIGID:
        return worst
    if float(_relative(M, R).max()) <= RIGID:
        raise InputError(
            "M and K look exchanged: M vanishes for rigid motions and K does not; call from_matrices(M, K)"
        )
    motion = int(np.argmax(residual.max(axis=0) > RIGID))  # translations first: they are more specific
    bad = np.unique(np.flatnonzero(residual[:, motion] > RIGID) // 3)
    raise InputError(
        f"K does not vanish for a rigid {NAMES[motion]}: residual {residual[:, motion].max():.2g} of the sum of "
        f"magnitudes, allowed {RIGID:g}, at {len(bad)} of {len(points)} nodes, the first is number {bad[0]}; the "
        "order of nodes or dofs does not match the matrices (nodes, dof_map, node_numbers), or the model is held by "
        "supports or springs"
    )


def require_mass(M: Any, points: np.ndarray) -> float:
    """Total mass [kg]. Raises `InputError` where it is not positive or not the same in the three directions."""
    R = rigid_modes(points, points.mean(axis=0))[:, :3]
    m = R.T @ (M @ R)
    mass = float(np.trace(m)) / 3.0
    if not mass > 0.0:
        raise InputError(f"M is not positive: the total mass is {mass:.3g}; export it again")
    if float(np.max(np.abs(m - mass * np.eye(3)))) > SAME_MASS * mass:
        text = ", ".join(f"{x:.6g}" for x in np.diag(m))
        raise InputError(
            f"M: the mass along x, y, z is {text} kg, it must be the same and uncoupled; the order of dofs does not "
            "match (dof_map), or dofs are missing"
        )
    return mass


def require_one_body(K: Any, M: Any) -> None:
    """Raise `InputError` where K is of several bodies, or M couples nodes that K does not."""
    import scipy.sparse as sp
    from scipy.sparse.csgraph import connected_components

    stiff, heavy = _couplings(K), _couplings(M)
    count, label = connected_components(stiff, directed=False)
    if count > 1:
        sizes = ", ".join(str(n) for n in np.sort(np.bincount(label))[::-1][:5])
        raise InputError(
            f"K consists of {count} unconnected bodies, the largest of {sizes} nodes; a body is one part: export one, "
            "or leave out nodes without elements"
        )
    foreign = heavy - heavy.multiply(stiff)
    off_diagonal = heavy.nnz - heavy.shape[0]
    share = sp.csr_matrix(foreign).count_nonzero() / max(off_diagonal, 1)
    if share > FOREIGN:
        raise InputError(
            f"M couples nodes that K does not ({100 * share:.0f} % of its couplings); the nodes of M and K have "
            "different orders: export both from one run"
        )


def plausibility(K: Any, M: Any, points: np.ndarray, mass: float) -> list[str]:
    """Warnings where mass, size and stiffness are implausible together.

    Density over the bounding box, and the speed `h sqrt(trace K / trace M)` over the typical distance `h = (box/n)^1/3`
    of nodes: of the order of the speed of sound, within a factor of ten on graded meshes and thin bodies.
    """
    box = float(np.prod(np.ptp(points, axis=0)))
    if not box > 0.0:
        return []
    density = mass / box
    speed = (box / len(points)) ** (1.0 / 3.0) * float(np.sqrt(K.diagonal().sum() / M.diagonal().sum()))
    found = []
    if not USUAL_DENSITY[0] <= density <= USUAL_DENSITY[1]:
        found.append(f"mass over bounding box is {density:.3g} kg/m3: are length_unit and matrix_units right?")
    if not USUAL_SPEED[0] <= speed <= USUAL_SPEED[1]:
        found.append(f"the estimated wave speed is about {speed:.2g} m/s: are length_unit and matrix_units right?")
    return found


def _relative(A: Any, R: np.ndarray) -> np.ndarray:
    """|A R| over |A| |R|, zero where both vanish."""
    scale = abs(A) @ np.abs(R)
    value = np.abs(A @ R)
    return np.divide(value, scale, out=np.zeros_like(value), where=scale > 0.0)


def _couplings(A: Any) -> Any:
    """Which nodes A couples: csr (n, n) of ones."""
    import scipy.sparse as sp

    entries = sp.coo_matrix(A)
    n = A.shape[0] // 3
    nodes = sp.coo_matrix((np.ones(entries.nnz), (entries.row // 3, entries.col // 3)), shape=(n, n)).tocsr()
    nodes.data = np.ones_like(nodes.data)
    return nodes
