r"""Cells of a joint interface: their mean displacement on either face, position, area, normal and gap.

*By facets* a cell is one or several cut facets (`overlap`, `clusters`). With the quadrature points q of its pieces on
the first face and the opposite points on the second, areas `a_q` and `A = sum a_q`,

    mean displacement = sum_q a_q/A sum_a N_a(xi_q) u_a,      on the second face N_a(eta_q) with the same a_q,

so that unit forces on both faces have equal resultants for any meshes. The normal is that of the area vector
`sum a_q n_q`.

*By nodes* a cell is a node: the displacement is the node's, on the second face that of the opposite node. Its area is
int N_a dA, which adds up to the area of the face. If that is not positive (corners of quad8 and tri6) the areas are
int N_a^2 dA, scaled to the area of each facet (Hinton, Rock and Zienkiewicz 1976, Earthq. Eng. Struct. Dyn. 4, 245).

Claims. Uses of facet sets that are incompatible with joint interfaces.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
import scipy.sparse as sp
from scipy.spatial import KDTree

from warpffrf.model.errors import InputError
from warpffrf.model.mesh import Mesh
from warpffrf.model.mesh.elements import facet_kind
from warpffrf.model.small_sliding.facing import BEHIND, FACING
from warpffrf.model.surfaces import Matched
from warpffrf.offline.fe import FACET_DEGREE, rule
from warpffrf.offline.small_sliding.clusters import gathered, grown, outline, slivers_joined
from warpffrf.offline.small_sliding.faces import Face
from warpffrf.offline.small_sliding.overlap import Pieces, overlap, places_across, whole

Array = np.ndarray
# Degree of quadrature on triangles of the reference domain: N_a |J| of plane facets, bilinear or biquadratic
DEGREE = {False: 4, True: 6}
POINTS = 200_000  # quadrature points processed together: with nine nodes on either side some 100 MB
OPPOSITE = 1e-3  # of an edge: tangential distance allowed between a node and the opposite one
SLIVER = 1e-6  # of a facet's area: a smaller cut facet does not form a cell
WHOLE = 0.999  # share of a face above which its overlap is not noted
SERENDIPITY = ("quad8", "tri6")  # kinds whose int N_a dA is not positive at the corners


@dataclass(frozen=True, eq=False)
class Cells:
    """Cells of a joint interface. `first`, `second` (c, n) csr: mean displacement of each from that of all nodes, on
    either face (`second` None for a single face); `points` (c, 3) [m], `normals` (c, 3), `area` (c,) [m2], `gap` (c,)
    [m]; `triangles` (t, 3, 3) [m] that form the cells, `cell` (t,); `covered` as in `MatchedSurface`; `notes` for the
    report."""

    first: Any
    second: Any | None
    points: Array
    normals: Array
    area: Array
    gap: Array
    triangles: Array
    cell: Array
    covered: tuple[float, float]
    notes: tuple[str, ...] = ()

    @property
    def count(self) -> int:
        """Number of cells."""
        return len(self.points)


def make_cells(mesh: Mesh, name: str, wanted: Matched) -> Cells:
    """The cells of the interface `name`. Raises `InputError` for unknown facet sets, faces that do not face each other,
    and cells by nodes if the nodes of the faces do not coincide."""
    first, *opposite = (Face.of(mesh, facets) for facets in wanted.sets)
    second = opposite[0] if opposite else None
    if wanted.by == "nodes":
        return _by_nodes(name, first, second)
    return _by_facets(name, first, second, wanted, _outlines(mesh, name, wanted.fine))


def _outlines(mesh: Mesh, name: str, sets: tuple[str, ...]) -> Array | None:
    """Points (k, 3) [m] of the outlines of facet sets, None of no sets. Raises `InputError` for closed ones."""
    found = [outline(Face.of(mesh, one)) for one in sets]
    for one, places in zip(sets, found, strict=True):
        if not len(places):
            raise InputError(
                f"contact {name!r}: {one!r} has no outline at which cells could be fine; name a set that has"
            )
    return np.concatenate(found) if found else None


def _by_facets(name: str, first: Face, second: Face | None, wanted: Matched, fine: Array | None) -> Cells:
    notes = []
    if second is None:
        pieces, covered, of_facet = whole(first), (1.0, 1.0), np.ones(len(first))
    else:
        found = overlap(name, first, second)
        pieces, covered, of_facet = found.pieces, found.covered, found.of_facet
        if min(covered) < WHOLE:
            notes.append(
                f"contact {name!r}: {covered[0]:.1%} of {first.name!r} and {covered[1]:.1%} of {second.name!r} face "
                "each other, the rest carries nothing"
            )
    own = np.bincount(first.triangles.facet, weights=first.triangles.area, minlength=len(first))
    there = of_facet > SLIVER
    if wanted.size is None and wanted.growth is None:
        of_face = np.where(there, np.cumsum(there) - 1, -1)
    else:
        more = grown(first, np.where(there, of_facet, 0.0), wanted.growth, fine)
        of_face = gathered(first, there, of_facet * own, wanted.size, more)
    of_face = slivers_joined(first, of_face, of_facet)
    kept = of_face[pieces.facet] >= 0
    pieces = Pieces(
        pieces.facet[kept], pieces.xi[kept], *(v[kept] if len(v) else v for v in (pieces.source, pieces.across))
    )
    cells = _integrated(first, second, pieces, of_face[pieces.facet], int(of_face.max()) + 1, covered)
    return Cells(**{**vars(cells), "notes": tuple(notes)})


def _integrated(
    first: Face, second: Face | None, pieces: Pieces, cell: Array, count: int, covered: tuple[float, float]
) -> Cells:
    """The cells (module docstring) formed by pieces numbered `cell` (p,) of `count`."""
    n = len(first.points)
    r = rule("tri3", DEGREE[first.quadratic or (second is not None and second.quadratic)])
    one = sp.csr_matrix((count, n))
    other = None if second is None else sp.csr_matrix((count, n))
    area, vector, moment, gap = np.zeros(count), np.zeros((count, 3)), np.zeros((count, 3)), np.zeros((count, 3))
    corners = []
    chunk = max(1, POINTS // len(r.weights))
    for start in range(0, len(cell), chunk):
        part = slice(start, start + chunk)
        xi, facet = pieces.xi[part], pieces.facet[part]
        stretch = np.linalg.det(xi[:, 1:] - xi[:, :1])
        points = np.einsum("qc,pcd->pqd", r.values, xi).reshape(-1, 2)
        facets = np.repeat(facet, len(r.weights))
        N, tangents = first.at(facets, points)
        x = N @ first.points
        vectors = np.cross(tangents[:, 0], tangents[:, 1]) * np.outer(stretch, r.weights).reshape(-1, 1)
        a = np.linalg.norm(vectors, axis=1)
        of = np.repeat(cell[part], len(r.weights))
        W = sp.csr_matrix((a, (of, np.arange(len(of)))), shape=(count, len(of)))
        area += np.asarray(W.sum(axis=1)).ravel()
        one = one + W @ N
        moment += W @ x
        for d in range(3):
            vector[:, d] += np.bincount(of, weights=vectors[:, d], minlength=count)
        if second is not None:
            axes = first.triangles.plane[np.repeat(pieces.source[part], len(r.weights))]
            across, eta = places_across(second, np.repeat(pieces.across[part], len(r.weights)), x, axes)
            N_across = second.at(across, eta)[0]
            other = other + W @ N_across
            gap += W @ (N_across @ second.points - x)
        at_corners = first.at(np.repeat(facet, 3), xi.reshape(-1, 2))[0] @ first.points
        corners.append(at_corners.reshape(-1, 3, 3))
    normals = vector / np.linalg.norm(vector, axis=1, keepdims=True)
    scale = sp.diags(1.0 / area)
    return Cells(
        first=sp.csr_matrix(scale @ one),
        second=None if other is None else sp.csr_matrix(scale @ other),
        points=moment / area[:, None],
        normals=normals,
        area=area,
        gap=np.einsum("ci,ci->c", normals, gap) / area,
        triangles=np.concatenate(corners),
        cell=cell,
        covered=covered,
    )


def _by_nodes(name: str, first: Face, second: Face | None) -> Cells:
    n, nodes = len(first.points), first.node_set
    area, normals = _nodal_areas(first)
    notes = []
    opposite, gap = None, np.zeros(len(nodes))
    covered = (1.0, 1.0)
    if second is not None:
        shared = np.isin(nodes, second.node_set)
        if shared.any():
            notes.append(
                f"contact {name!r}: {int(shared.sum())} nodes belong to both {first.name!r} and {second.name!r}, where "
                "the faces hang together; they make no cells"
            )
            nodes, area, normals = nodes[~shared], area[~shared], normals[~shared]
        opposite, gap = _nodes_across(name, first, second, nodes, normals)
        areas = dict(zip(second.node_set.tolist(), _nodal_areas(second)[0], strict=True))
        met = sum(areas[node] for node in np.unique(opposite).tolist())
        covered = (1.0, float(met / sum(areas.values())))
    if any(kind in SERENDIPITY for kind, _ in first.blocks):
        notes.append(
            f"contact {name!r}: areas of nodes are int N^2 dA, scaled: int N dA is not positive at the corners"
        )
    triangles, node = _node_parts(first)
    cell = np.searchsorted(nodes, node)
    own = np.isin(node, nodes)
    return Cells(
        first=_picked(nodes, n),
        second=None if opposite is None else _picked(opposite, n),
        points=first.points[nodes],
        normals=normals,
        area=area,
        gap=gap,
        triangles=triangles[own],
        cell=cell[own],
        covered=covered,
        notes=tuple(notes),
    )


def _picked(nodes: Array, n: int) -> Any:
    return sp.csr_matrix((np.ones(len(nodes)), (np.arange(len(nodes)), nodes)), shape=(len(nodes), n))


def _nodal_areas(face: Face) -> tuple[Array, Array]:
    """Areas (k,) [m2] and outward unit normals (k, 3) of the nodes of a face (module docstring)."""
    area, normal = np.zeros(len(face.points)), np.zeros((len(face.points), 3))
    for kind, nodes in face.blocks:
        r = rule(kind, FACET_DEGREE[kind])
        tangents = np.einsum("mki,qkd->mqdi", face.points[nodes], r.gradients)
        vectors = np.cross(tangents[:, :, 0], tangents[:, :, 1]) * r.weights[:, None]
        a = np.linalg.norm(vectors, axis=2)
        if kind in SERENDIPITY:
            share = np.einsum("mq,qk->mk", a, r.values**2)
            share *= (a.sum(axis=1) / share.sum(axis=1))[:, None]
        else:
            share = np.einsum("mq,qk->mk", a, r.values)
        np.add.at(area, nodes.ravel(), share.ravel())
        mean = vectors.sum(axis=1)
        mean /= np.linalg.norm(mean, axis=1, keepdims=True)
        np.add.at(normal, nodes.ravel(), (share[:, :, None] * mean[:, None]).reshape(-1, 3))
    kept = face.node_set
    return area[kept], normal[kept] / np.linalg.norm(normal[kept], axis=1, keepdims=True)


def _nodes_across(name: str, first: Face, second: Face, nodes: Array, normals: Array) -> tuple[Array, Array]:
    """Nodes (k,) of the second face opposite to `nodes` (k,) of the first along their `normals`, and the gaps (k,) [m].

    Raises `InputError` if a node has no opposite one within `OPPOSITE` of an edge.
    """
    normal_across = dict(zip(second.node_set.tolist(), _nodal_areas(second)[1], strict=True))
    candidates = np.setdiff1d(second.node_set, first.node_set)
    edge = float(first.edge.min())
    if not len(candidates):
        raise InputError(f"contact {name!r}: {second.name!r} has no nodes of its own; choose two faces that part")
    x, across = first.points[nodes], first.points[candidates]
    # the opposite node is about as far as the nearest one: check a few, take the one with the least tangential offset
    near = min(len(candidates), 8)
    found = KDTree(across).query(x, k=near)[1].reshape(len(nodes), near)
    between = across[found] - x[:, None]
    gap = np.einsum("kni,ki->kn", between, normals)
    aside = np.linalg.norm(between - gap[:, :, None] * normals[:, None], axis=2)
    facing = np.array([normal_across[node] for node in candidates.tolist()])[found]
    seen = (np.einsum("kni,ki->kn", facing, normals) < FACING) & (
        gap > -BEHIND * min(first.triangles.extent, second.triangles.extent)
    )
    aside = np.where(seen, aside, np.inf)
    best = np.argmin(aside, axis=1)
    rows = np.arange(len(nodes))
    least = aside[rows, best]
    if np.any(least > OPPOSITE * edge):
        missing = least > OPPOSITE * edge
        worst = int(np.argmax(np.where(np.isfinite(least), least, -1.0)))
        far = (
            f"the worst, at ({', '.join(f'{v:.6g}' for v in x[worst])}) m, misses the nearest by {least[worst]:.3g} m"
            if np.isfinite(least[worst]) and least[worst] > 0.0
            else "there is nothing opposite"
        )
        raise InputError(
            f"contact {name!r}: by='nodes' needs a node of {second.name!r} opposite to every node of {first.name!r}; "
            f"{int(missing.sum())} of {len(nodes)} have none, {far}; use by='facets', or mesh both faces alike"
        )
    return candidates[found[rows, best]], gap[rows, best]


# Polygons between the nodes of a facet, each shared among its corners; other kinds: their triangles
_QUADS = {"quad4": ((0, 1, 2, 3),), "quad9": ((0, 4, 8, 7), (4, 1, 5, 8), (8, 5, 2, 6), (7, 8, 6, 3))}


def _node_parts(face: Face) -> tuple[Array, Array]:
    """Triangles (t, 3, 3) [m] of the parts of the facets around each node, and the node (t,) of each: from node to the
    middles of the edges to the centre of each polygon between nodes."""
    triangles, owner = [], []
    for kind, nodes in face.blocks:
        for polygon in _QUADS.get(kind, facet_kind(kind).triangles):
            corners = nodes[:, list(polygon)]
            x = face.points[corners]
            center = x.mean(axis=1)
            k = x.shape[1]
            for i in range(k):
                ahead, back = 0.5 * (x[:, i] + x[:, (i + 1) % k]), 0.5 * (x[:, i] + x[:, i - 1])
                triangles += [np.stack([x[:, i], ahead, center], 1), np.stack([x[:, i], center, back], 1)]
                owner += [corners[:, i]] * 2
    return np.concatenate(triangles), np.concatenate(owner)


def require_sets(
    mesh: Mesh, matched: Mapping[str, Matched], contact: Iterable[str], interfaces: Mapping[str, str]
) -> None:
    """Raises `InputError` for unknown facet sets, facets that also belong to a contact surface or to both faces of an
    interface, and sets that are rigid interfaces."""
    contact = list(contact)
    for name, face in matched.items():
        for used in face.fine:
            _named(mesh, name, used)
        for used in face.sets:
            own = _named(mesh, name, used)
            if interfaces.get(used) == "rigid":
                raise InputError(
                    f"contact {name!r}: set {used!r} is a rigid interface, whose facets do not give way; make the "
                    "interface 'average', or use two sets"
                )
            for other in contact:
                if shared := len(own & _facets(mesh, other)):
                    raise InputError(
                        f"contact {name!r}: {shared} facets of {used!r} belong to contact surface {other!r} too; a "
                        "facet carries one or the other: separate the sets"
                    )
        if len(face.sets) == 2 and (shared := len(_facets(mesh, face.sets[0]) & _facets(mesh, face.sets[1]))):
            raise InputError(
                f"contact {name!r}: {face.sets[0]!r} and {face.sets[1]!r} share {shared} facets, which cannot face "
                "themselves; separate the sets"
            )


def _named(mesh: Mesh, face: str, name: str) -> set[tuple[int, ...]]:
    """`_facets`, whose `InputError` names the joint interface."""
    try:
        return _facets(mesh, name)
    except InputError as error:
        raise InputError(f"contact {face!r}: {error}") from None


def _facets(mesh: Mesh, name: str) -> set[tuple[int, ...]]:
    """Each facet of a set by its sorted corners."""
    corners = mesh.facets(name).corners.values()
    return {tuple(facet) for nodes in corners for facet in np.sort(nodes, axis=1).tolist()}
