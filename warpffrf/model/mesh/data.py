"""A finite-element body as plain arrays: points, cells of several kinds, named sets, rotational periodicity, matrices.

The frame of `points` is the *user frame* of the body made from the mesh. Lengths are metres.
"""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np

from warpffrf.model.errors import InputError, require_array, unknown_name
from warpffrf.model.material import SolidMaterial
from warpffrf.model.mesh import cut as cutting
from warpffrf.model.mesh import periodicity
from warpffrf.model.mesh import select as selection
from warpffrf.model.mesh.checks import check_connected, check_distinct, check_orientation, check_structure, check_used
from warpffrf.model.mesh.elements import cell_kind
from warpffrf.model.mesh.facets import FacetSet, node_numbers, outer_faces
from warpffrf.model.mesh.files import pyvista_export, writer
from warpffrf.model.mesh.files.set_names import SetNames
from warpffrf.model.mesh.periodicity import Cyclic
from warpffrf.model.mesh.report import MeshReport
from warpffrf.model.mesh.report import report as make_report
from warpffrf.model.mesh.structure import Shell, Structure
from warpffrf.model.messages import reprs
from warpffrf.model.messages.named_arguments import named_arguments

_CHUNK = 20_000  # cells processed together: bounds the memory to some tens of MB


@dataclass(frozen=True, eq=False)
class Matrices:
    """`stiffness` K [N/m] and `mass` M [kg], scipy.sparse csr (3 n, 3 n), dof `3*node + component`, user axes."""

    stiffness: Any
    mass: Any


@named_arguments
@dataclass(frozen=True, eq=False, repr=False)
class Mesh(reprs.Shown):
    """A finite-element mesh: `points` (n, 3) [m, user frame], cells by kind, named facet and cell sets, rotational
    periodicity if any; name: of the body in reports.

    `cells`: {kind: (m, k) int64}, kinds in `elements.CELL_KINDS`; cells are numbered through the blocks in the order of
    the dict. `facet_sets`: {name: `FacetSet`}, faces with a name. `cyclic`: periodicity about an axis, None without.
    `cell_sets`: {name: (m,) cell numbers}. `materials`: {cell set: Material} as read from a file. `notes`: items that a
    reader omitted or interpreted differently. A body that comes as `matrices` needs no cells. `structure`: shells,
    beams, point masses, springs and rigid links (`wf.mesh.Shell` and others), with or without solid cells; `node_sets`:
    {name: (k,) nodes} for interfaces on nodes that rotate. Construction checks shapes, finite numbers and index ranges;
    `check()` checks the geometry. The arrays are read-only. Raises `InputError` for inconsistent data.
    """

    points: np.ndarray
    cells: Mapping[str, np.ndarray]
    facet_sets: Mapping[str, FacetSet] = field(default_factory=dict)
    cyclic: Cyclic | None = None
    name: str = ""
    cell_sets: Mapping[str, np.ndarray] = field(default_factory=dict, kw_only=True)
    materials: Mapping[str, SolidMaterial] = field(default_factory=dict, kw_only=True)
    notes: tuple[str, ...] = field(default=(), kw_only=True)
    matrices: Matrices | None = field(default=None, kw_only=True)
    structure: Any = field(default=(), kw_only=True)  # parts; afterwards the `Structure` of them
    node_sets: Mapping[str, Any] = field(default_factory=dict, kw_only=True)

    def __post_init__(self) -> None:
        points = require_array(self.points, "mesh: points", (None, 3))
        points.setflags(write=False)
        cells = {}
        for kind, nodes in self.cells.items():
            numbers = node_numbers(nodes, f"mesh: {kind} cells", len(cell_kind(kind).nodes))
            _in_range(numbers, len(points), f"mesh: {kind} cells")
            if len(numbers):
                cells[kind] = numbers
        structure = self.structure if isinstance(self.structure, Structure) else Structure(tuple(self.structure))
        if not cells and self.matrices is None and not structure.parts:
            raise InputError("mesh: there are no volume cells")
        if structure.parts and self.matrices is not None:
            raise InputError("mesh: a body of matrices takes no structural elements; add them before the export")
        for part in structure.parts:
            _in_range(Structure((part,)).nodes(), len(points), f"mesh: {type(part).__name__}")
        known = {facet for kind in cells for facet in cell_kind(kind).faces}
        known |= {shell.kind for shell in structure.of(Shell)}
        node_sets = {}
        for name, nodes in self.node_sets.items():
            if name in self.facet_sets:
                raise InputError(f"mesh: {name!r} is a facet set and a node set; choose another name for one of them")
            node_sets[name] = np.unique(node_numbers(np.asarray(nodes).reshape(-1, 1), f"mesh: node set {name!r}", 1))
            _in_range(node_sets[name], len(points), f"mesh: node set {name!r}")
        for name, facets in self.facet_sets.items():
            for kind, nodes in facets.blocks.items():
                if cells and kind not in known:
                    raise InputError(
                        f"mesh: set {name!r} holds {kind} facets, {', '.join(cells)} cells have no such face"
                    )
                _in_range(nodes, len(points), f"mesh: set {name!r}")
        cell_count = sum(len(nodes) for nodes in cells.values())
        sets = {name: _cell_numbers(members, cell_count, name) for name, members in self.cell_sets.items()}
        if self.cyclic is not None:
            for count, what in (
                (len(points), "nodes"),
                *((len(nodes), f"{kind} cells") for kind, nodes in cells.items()),
            ):
                if count % self.cyclic.sectors:
                    raise InputError(f"mesh: {count} {what} cannot be split over {self.cyclic.sectors} equal sectors")
        if self.matrices is not None:
            for matrix, what in ((self.matrices.stiffness, "stiffness"), (self.matrices.mass, "mass")):
                if matrix.shape != (3 * len(points), 3 * len(points)):
                    raise InputError(
                        f"mesh: {what} matrix is {matrix.shape}, {len(points)} nodes have {3 * len(points)} dofs"
                    )
        object.__setattr__(self, "points", points)
        object.__setattr__(self, "cells", cells)
        object.__setattr__(self, "facet_sets", SetNames(self.facet_sets))
        object.__setattr__(self, "cell_sets", SetNames(sets))
        object.__setattr__(self, "materials", dict(self.materials))
        object.__setattr__(self, "notes", tuple(self.notes))
        object.__setattr__(self, "structure", structure)
        object.__setattr__(self, "node_sets", node_sets)

    def _facts(self) -> dict[str, Any]:
        counts = {**{kind: len(nodes) for kind, nodes in self.cells.items()}, **self.structure.counts()}
        cells = " and ".join(f"{count} {kind}" for kind, count in counts.items())
        size = " x ".join(f"{length:.4g}" for length in np.ptp(self.points, axis=0)) if len(self.points) else "0"
        facts = {"name": self.name, "nodes": len(self.points), "cells": cells or "none", "size": f"{size} m"}
        return {**facts, "facet_sets": reprs.names(self.facet_sets), "cell_sets": reprs.names(self.cell_sets)}

    @property
    def cell_count(self) -> int:
        """Number of cells of all kinds."""
        return sum(len(nodes) for nodes in self.cells.values())

    @property
    def single(self) -> tuple[str, np.ndarray]:
        """Kind and nodes (m, k) of a mesh of one kind of cells; raises `InputError` for any other."""
        if len(self.cells) != 1:
            raise InputError(f"a mesh of one kind of cells is needed, got {', '.join(self.cells) or 'none'}")
        return next(iter(self.cells.items()))

    def by_block(self, values: np.ndarray) -> Iterator[tuple[str, np.ndarray]]:
        """Split `values` (cell_count, ...), one per cell and in any unit, into (kind, values of that block)."""
        start = 0
        for kind, nodes in self.cells.items():
            yield kind, values[start : start + len(nodes)]
            start += len(nodes)

    @property
    def sets(self) -> dict[str, int]:
        """Names of the facet sets, with the number of facets in each."""
        return {name: len(facets) for name, facets in self.facet_sets.items()}

    def facets(self, name: str) -> FacetSet:
        """The facet set called `name`, in capitals or not; raises `InputError` listing those that exist, and for an
        empty one."""
        if name not in self.facet_sets:
            raise unknown_name(f"mesh {self.name or '(unnamed)'}: facet set", name, self.facet_sets)
        if not len(self.facet_sets[name]):
            raise InputError(f"mesh {self.name or '(unnamed)'}: facet set {name!r} is empty; select its facets again")
        return self.facet_sets[name]

    def outer_facets(self) -> FacetSet:
        """All faces that belong to one cell only, and all shells; of a body of matrices all facets of its sets."""
        if self.cells and not self.structure.parts:
            return outer_faces(self.cells)
        merged: dict[str, list[np.ndarray]] = {}
        if self.structure.parts:
            for kind, nodes in outer_faces(self.cells).blocks.items() if self.cells else ():
                merged.setdefault(kind, []).append(nodes)
            for shell in self.structure.of(Shell):
                merged.setdefault(shell.kind, []).append(shell.nodes)
            return FacetSet({kind: _distinct(np.concatenate(parts)) for kind, parts in merged.items()})
        for facets in self.facet_sets.values():
            for kind, nodes in facets.blocks.items():
                merged.setdefault(kind, []).append(nodes)
        return FacetSet({kind: _distinct(np.concatenate(parts)) for kind, parts in merged.items()})

    def select(self, name: str, from_set: str, predicate: Callable[[np.ndarray], np.ndarray]) -> Mesh:
        """A new mesh with one more facet set: the facets of `from_set` that `predicate` keeps.

        `predicate` gets the facet centres (m, 3) [m], the means of the corners, and returns a mask (m,). Raises
        `InputError` for an unknown `from_set`, a used `name`, a mask of another shape, or an empty selection.
        """
        source = self.facets(from_set)
        if name in self.facet_sets.keys():
            raise InputError(f"mesh: facet set {name!r} exists already, choose another name")
        if not callable(predicate):
            raise InputError(
                f"select {name!r}: the predicate must be a function of the facet centres, got {predicate!r}"
            )
        mask = np.asarray(predicate(source.centers(self.points)))
        if mask.shape != (len(source),) or mask.dtype != bool:
            raise InputError(f"select {name!r}: the predicate must return {len(source)} booleans, one per facet")
        if not mask.any():
            raise InputError(f"select {name!r}: no facet of {from_set!r} fulfils the predicate")
        return replace(self, facet_sets={**self.facet_sets, name: source.kept(mask)})

    def select_plane(
        self, name: str, *, point: Any, normal: Any, tolerance: float | None = None, from_set: str | None = None
    ) -> Mesh:
        """A new mesh with the facet set `name` on a plane through `point` (3,) [m] with `normal` (3,), user frame.

        tolerance [m]: the largest distance of a node, 1e-5 of the diagonal of the box around it where None. from_set:
        the facet set to choose from; None: all outer facets. Raises `InputError` for a used name, and for an empty
        selection, with the distance of the nearest facet.
        """
        return selection.plane(self, name, point=point, normal=normal, tolerance=tolerance, from_set=from_set)

    def select_cylinder(
        self,
        name: str,
        *,
        axis_point: Any = None,
        axis_direction: Any = None,
        radius: float | None = None,
        tolerance: float | None = None,
        from_set: str | None = None,
    ) -> Mesh:
        """A new mesh with the facet set `name` on a cylinder of `radius` [m] about the axis through axis_point (3,) [m]
        along axis_direction (3,), user frame; parameters that are None are fitted to the nodes of `from_set`.

        tolerance [m], from_set and errors: as for `select_plane`.
        """
        return selection.cylinder(
            self,
            name,
            axis_point=axis_point,
            axis_direction=axis_direction,
            radius=radius,
            tolerance=tolerance,
            from_set=from_set,
        )

    def select_sphere(
        self, name: str, *, center: Any, radius: float, tolerance: float | None = None, from_set: str | None = None
    ) -> Mesh:
        """A new mesh with the facet set `name` on a sphere of `radius` [m] about `center` (3,) [m, user frame];
        tolerance [m], from_set and errors: as for `select_plane`."""
        return selection.sphere(self, name, center=center, radius=radius, tolerance=tolerance, from_set=from_set)

    def select_box(self, name: str, *, low: Any = -np.inf, high: Any = np.inf, from_set: str | None = None) -> Mesh:
        """A new mesh with the facet set `name`: the facets of `from_set`, None for all outer ones, whose centres, the
        means of their corners, lie between the corners `low` and `high` (3,) [m, user frame] of a box along the axes;
        -inf and inf for no limit. Raises `InputError` for a used name and for an empty selection."""
        return selection.box(self, name, low=low, high=high, from_set=from_set)

    def select_feature(self, name: str, *, seed: Any, angle: float = 30.0, from_set: str | None = None) -> Mesh:
        """A new mesh with the facet set `name`: all facets reachable from the one nearest `seed` (3,) [m] without
        crossing an edge of more than `angle` [degrees]. from_set: the facet set to stay in; None: all outer facets.
        Raises `InputError` for a used name, an angle outside 0 to 180 and a seed far off the surface."""
        return selection.feature(self, name, seed=seed, angle=angle, from_set=from_set)

    def cut(
        self,
        name: str,
        *,
        point: Any,
        normal: Any,
        cells: str | None = None,
        radius: float | None = None,
        tolerance: float | None = None,
    ) -> Mesh:
        """A new mesh that is cut along faces of cells on the plane through `point` (3,) [m], with the facet sets
        NAME_low and NAME_high that face each other: a pretension section of a bolt called `name`.

        normal (3,): points to the high side, user frame. cells: a cell set; only faces between its cells are cut.
        radius [m]: extent of the cut about `point`. tolerance [m]: the largest distance of nodes from the plane, 1e-5
        of the diagonal of the box around the body where None. Raises `InputError` for a used name, an unknown cell set,
        a body of matrices, a plane that intersects cells or contains no faces, and where the two sides are not
        connected elsewhere.
        """
        return cutting.cut(self, name, point=point, normal=normal, cells=cells, radius=radius, tolerance=tolerance)

    def find_periodicity(self) -> Cyclic | None:
        """Axis and largest number of equal sectors of the cells, or None; `periodicity`."""
        return periodicity.find(self)

    def with_periodicity(
        self, *, axis_point: Any = None, axis_direction: Any = None, sectors: int | None = None
    ) -> Mesh:
        """The same body numbered sector by sector, with `cyclic` set: `sectors` equal sectors about the axis through
        axis_point (3,) [m] along axis_direction (3,), user frame; parameters that are None are determined.

        Nodes move within the precision of the file, at most 1e-5 of the radius; the largest move is in `notes`.
        Raises `InputError` with the reason where the mesh is not periodic.
        """
        return periodicity.required(self, axis_point=axis_point, axis_direction=axis_direction, sectors=sectors)

    def volume(self) -> float:
        """Volume [m3], by quadrature exact for the isoparametric cells; 0 for a body without cells."""
        total = 0.0
        for kind, nodes in self.cells.items():
            cell = cell_kind(kind)
            for part in np.array_split(nodes, len(nodes) // _CHUNK + 1):
                x = self.points[part]
                total += float(np.sum(cell.jacobians(x, cell.quadrature_points) @ cell.quadrature_weights))
        return total

    def check(self) -> Mesh:
        """Raise `InputError` for inverted cells, duplicate cells, unused nodes or disconnected parts;
        else return the mesh itself."""
        if self.cells:
            check_orientation(self.points, self.cells)
            check_distinct(self.cells)
        if self.structure.parts:
            check_structure(len(self.points), self.cells, self.structure)
        elif self.cells:
            check_used(len(self.points), self.cells)
            check_connected(len(self.points), self.cells)
        return self

    def report(self, material: SolidMaterial | Mapping[str, SolidMaterial] | None = None) -> MeshReport:
        """Size, volume, quality, warnings; with `material`, one or {cell set: Material}, mass and inertia too.

        Where it is None the materials of the mesh's file are used, if they cover every cell. Raises `InputError` for an
        unknown cell set and for cells without material.
        """
        return make_report(self, material)

    def write(self, path: str | Path, *, overwrite: bool = False) -> Path:
        """Write the mesh with its sets to a .vtu file, or an .inp for Abaqus and CalculiX, lengths in m; returns its
        path. Raises `InputError` for another suffix, and for a file that exists unless `overwrite` is set."""
        return writer.write(self, path, overwrite=overwrite)

    def to_pyvista(self) -> Any:
        """`pyvista.UnstructuredGrid` of cells and set facets, an array of 0 and 1 per set; `pyvista_export`."""
        return pyvista_export.to_pyvista(self)

    def content_hash(self) -> str:
        """sha256 over all arrays, set names and the periodicity (not over `name`)."""
        digest = hashlib.sha256()

        def add(label: str, array: np.ndarray) -> None:
            digest.update(f"{label}|{array.dtype.str}|{array.shape}|".encode())
            digest.update(np.ascontiguousarray(array).tobytes())

        add("points", self.points)
        for kind, nodes in self.cells.items():
            add(kind, nodes)
        for name, facets in sorted(self.facet_sets.items()):
            for kind, nodes in facets.blocks.items():
                add(f"set|{name}|{kind}", nodes)
        for name, members in sorted(self.cell_sets.items()):
            add(f"cell set|{name}", members)
        if self.cyclic is not None:
            axis = np.concatenate([self.cyclic.axis_point, self.cyclic.axis_direction])
            add(f"cyclic|{self.cyclic.sectors}", axis)
        if self.structure.parts:
            digest.update(self.structure.bytes())
        for name, nodes in sorted(self.node_sets.items()):
            add(f"node set|{name}", nodes)
        if self.matrices is not None:
            for label, matrix in (("K", self.matrices.stiffness), ("M", self.matrices.mass)):
                for part in ("indptr", "indices", "data"):
                    add(f"{label}|{part}", getattr(matrix, part))
        return digest.hexdigest()


def _cell_numbers(members: object, count: int, name: str) -> np.ndarray:
    array = np.unique(np.asarray(members))
    if array.size and (not np.issubdtype(array.dtype, np.integer) or array[0] < 0 or array[-1] >= count):
        raise InputError(f"mesh: cell set {name!r}: cell numbers must be integers in 0 to {count - 1}")
    array = array.astype(np.int64)
    array.setflags(write=False)
    return array


def _distinct(nodes: np.ndarray) -> np.ndarray:
    """Facets without those that occur twice, in the order of their first occurrence."""
    return nodes[np.sort(np.unique(np.sort(nodes, axis=1), axis=0, return_index=True)[1])]


def _in_range(nodes: np.ndarray, count: int, name: str) -> None:
    if nodes.size and (nodes.min() < 0 or nodes.max() >= count):
        raise InputError(f"{name}: node numbers must lie in 0 to {count - 1}, got {nodes.min()} to {nodes.max()}")
