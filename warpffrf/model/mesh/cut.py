"""A cut along a plane, through a part of a body: a pretension section.

The plane has the distance d = (x - p) . n. Cells are *low* or *high* by the d of their centre. *Faces of the cut* are
those between a low and a high cell whose nodes all lie on the plane, |d| within a tolerance, within the extent of the
cut: a cell set, or a radius about p. The high cells at a node of the cut get their own node in the same position, so
that the two sides are connected only by elements added there: facet set NAME_low has the faces of the low cells,
NAME_high those of the high ones, which face them.

A node on the rim of a cut that ends inside the body is not doubled: a face on the plane outside the cut, or a cell that
the plane intersects, connects low and high cells there. A plane that intersects cells within the cut is refused, as is
a cut that separates the body in two.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from warpffrf.model.errors import InputError, require_array, require_direction, require_number, unknown_name
from warpffrf.model.mesh.checks import part_labels
from warpffrf.model.mesh.elements import cell_kind
from warpffrf.model.mesh.facets import FacetSet, outer_faces, row_numbers
from warpffrf.model.mesh.select import ON_SURFACE

if TYPE_CHECKING:
    from warpffrf.model.mesh.data import Mesh

LOW, HIGH = "low", "high"  # ends of the names of the two facet sets

Array = np.ndarray


def cut(
    mesh: Mesh,
    name: str,
    *,
    point: Any,
    normal: Any,
    cells: str | None = None,
    radius: float | None = None,
    tolerance: float | None = None,
) -> Mesh:
    """A new mesh that is cut along the plane through `point` (3,) [m] with `normal` (3,), which points to the high
    side, with facet sets NAME_low and NAME_high that face each other.

    cells: a cell set; only faces between its cells are cut. radius [m]: extent of the cut about `point`. `tolerance`
    [m] is the largest distance of nodes from the plane, 1e-5 of the diagonal of the bounding box where None. Cell
    numbers are kept; new nodes follow the others. Raises `InputError` for a used name, an unknown cell set, a body of
    matrices, a plane that intersects cells or contains no faces, with its distance from the nearest node, and where the
    two sides are not connected elsewhere.
    """
    label = f"cut {name!r}"
    if mesh.structure.parts:
        raise InputError(
            f"{label}: a body with shells, beams or other structural elements is not cut; cut the solids first"
        )
    if not mesh.cells:
        raise InputError(f"{label}: the body has matrices and no cells; cut it in the program that wrote them")
    for side in (LOW, HIGH):
        if f"{name}_{side}" in mesh.facet_sets:
            raise InputError(f"{label}: facet set '{name}_{side}' exists already, choose another name")
    p = require_array(point, f"{label}: point", (3,))
    n = require_direction(normal, f"{label}: normal")
    reach = np.inf if radius is None else require_number(radius, f"{label}: radius", positive=True)
    limit = ON_SURFACE * float(np.linalg.norm(np.ptp(mesh.points, axis=0)))
    if tolerance is not None:
        limit = require_number(tolerance, f"{label}: tolerance", positive=True)
    meant = np.ones(mesh.cell_count, dtype=bool)
    if cells is not None:
        if cells not in mesh.cell_sets:
            raise unknown_name(f"{label}: cell set", cells, mesh.cell_sets)
        meant = np.isin(np.arange(mesh.cell_count), mesh.cell_sets[cells])
    plane = _Plane(mesh, p, n, limit, reach + limit)
    low, high, rim = plane.faces(meant, label)
    doubled = np.setdiff1d(low.node_set, rim)
    if not len(doubled):
        raise InputError(
            f"{label}: the surrounding material connects all nodes of its {len(low)} faces; include more of the "
            "plane, by a larger radius or cell set"
        )
    return _parted(mesh, name, plane, (low, high), doubled)


class _Plane:
    """Position of nodes and cells relative to a plane: distance `d` of nodes (n,) [m], and of cells (N,) whether they
    are high, whether the plane intersects them (`through`), and their centre."""

    def __init__(self, mesh: Mesh, point: Array, normal: Array, limit: float, reach: float) -> None:
        self.mesh, self.point, self.normal, self.limit, self.reach = mesh, point, normal, limit, reach
        self.d = (mesh.points - point) @ normal
        corners = [nodes[:, : cell_kind(kind).corner_count] for kind, nodes in mesh.cells.items()]
        self.center = np.concatenate([mesh.points[c].mean(axis=1) for c in corners])
        self.high = (self.center - point) @ normal > 0.0
        least, most = (np.concatenate([f(self.d[c], axis=1) for c in corners]) for f in (np.min, np.max))
        self.through = (least < -limit) & (most > limit)

    def within(self, x: Array) -> Array:
        """Whether points (n, 3), projected onto the plane, are within the extent of the cut."""
        off = x - self.point
        off = off - np.outer(off @ self.normal, self.normal)
        return np.linalg.norm(off, axis=1) <= self.reach

    def nodes_of(self, cells: Array, *, corners: bool = False) -> Array:
        """Numbers of the nodes of `cells` (N,) bool, or of their corners."""
        parts = []
        for kind, of_kind in self.mesh.by_block(cells):
            count = cell_kind(kind).corner_count if corners else len(cell_kind(kind).nodes)
            parts.append(self.mesh.cells[kind][of_kind, :count].ravel())
        return np.unique(np.concatenate(parts))

    def faces(self, meant: Array, label: str) -> tuple[FacetSet, FacetSet, Array]:
        """Faces of the cut on the low and the high side, and the nodes where other cells connect the two sides."""
        bad = np.flatnonzero(self.through & meant & self.within(self.center))
        if len(bad):
            raise InputError(
                f"{label}: the plane goes through {len(bad)} cells, one of them at {_place(self.center[bad[0]])}; "
                f"{self._nearest(meant)}"
            )
        inside = self.within(self.mesh.points)
        low, high = self._between(meant, inside)
        if not len(low):
            raise InputError(f"{label}: no faces between two cells lie on the plane there; {self._nearest(meant)}")
        everywhere, _ = self._between(np.ones_like(meant), np.ones_like(inside))
        rim = [self.nodes_of(self.through)]
        for kind, nodes in everywhere.blocks.items():
            own = low.blocks.get(kind, np.zeros((0, nodes.shape[1]), dtype=np.int64))
            number = row_numbers(np.sort(np.concatenate([nodes, own]), axis=1))
            rim.append(nodes[~np.isin(number[: len(nodes)], number[len(nodes) :])].ravel())
        return low, high, np.unique(np.concatenate(rim))

    def _between(self, cells: Array, nodes: Array) -> tuple[FacetSet, FacetSet]:
        """Faces on the plane between low and high ones of `cells` (N,) bool, all of whose nodes are among `nodes` (n,)
        bool: outward of the low cells, and the same faces outward of the high ones."""
        there = nodes & (np.abs(self.d) <= self.limit)
        sides = []
        for side in (cells & ~self.high, cells & self.high):
            parts = {kind: self.mesh.cells[kind][of_kind] for kind, of_kind in self.mesh.by_block(side)}
            parts = {kind: own for kind, own in parts.items() if len(own)}
            facets = outer_faces(parts).blocks if parts else {}
            sides.append({kind: own[np.all(there[own], axis=1)] for kind, own in facets.items()})
        found: tuple[dict[str, Array], dict[str, Array]] = ({}, {})
        for kind in sides[0].keys() & sides[1].keys():
            below, above = sides[0][kind], sides[1][kind]
            number = row_numbers(np.sort(np.concatenate([below, above]), axis=1))
            _, first, second = np.intersect1d(number[: len(below)], number[len(below) :], return_indices=True)
            found[0][kind], found[1][kind] = below[first], above[second]
        return FacetSet(found[0]), FacetSet(found[1])

    def _nearest(self, meant: Array) -> str:
        """Distance of the corners of the intended cells from the plane, and the cure."""
        used = self.nodes_of(meant, corners=True)
        near = used[self.within(self.mesh.points[used])]
        if not len(near):
            return f"no node is within {self.reach:.3g} m of the point; move it, or give a larger radius"
        nearest = near[np.argmin(np.abs(self.d[near]))]
        if abs(self.d[nearest]) <= self.limit:
            return "it has nodes there, but no whole face with a cell on both sides; give a larger radius or cell set"
        return (
            f"the nearest corner of the cells is {abs(self.d[nearest]):.3g} m off the plane, at "
            f"{_place(self.mesh.points[nearest])} (tolerance {self.limit:.3g} m); a cut follows faces of cells: move "
            "the plane onto a layer of them, mesh the body with one there, or raise tolerance"
        )


def _parted(mesh: Mesh, name: str, plane: _Plane, faces: tuple[FacetSet, FacetSet], doubled: Array) -> Mesh:
    """The mesh with `doubled` nodes (k,), the second of each two for the high cells and their facets."""
    twin = np.arange(len(mesh.points))
    twin[doubled] = len(mesh.points) + np.arange(len(doubled))
    cells = {
        kind: np.where(high[:, None], twin[mesh.cells[kind]], mesh.cells[kind])
        for kind, high in mesh.by_block(plane.high)
    }
    before, after = (part_labels(count, of) for count, of in (
        (len(mesh.points), mesh.cells), (len(mesh.points) + len(doubled), cells)
    ))  # fmt: skip
    if after.max() > before.max():
        sizes = ", ".join(str(size) for size in np.bincount(after))
        raise InputError(
            f"cut {name!r}: it leaves parts of {sizes} cells that are not connected, so that a preload would have no "
            "load path; cut through a part of the body (cells=, radius=), or make two bodies of it"
        )
    sets = {}
    for known, facets in mesh.facet_sets.items():
        blocks = {}
        for kind, nodes in facets.blocks.items():
            above = plane.d[nodes].max(axis=1) > plane.limit
            blocks[kind] = np.where(above[:, None], twin[nodes], nodes)
        sets[known] = FacetSet(blocks)
    sets |= {f"{name}_{LOW}": faces[0], f"{name}_{HIGH}": faces[1].renumbered(twin)}
    notes = mesh.notes
    if mesh.cyclic is not None:
        notes = (*notes, f"cut {name!r}: the cut body is no longer treated as periodic")
    points = np.concatenate([mesh.points, mesh.points[doubled]])
    return replace(mesh, points=points, cells=cells, facet_sets=sets, cyclic=None, notes=notes)


def _place(x: Array) -> str:
    return "(" + ", ".join(f"{c:.4g}" for c in x) + ") m"
