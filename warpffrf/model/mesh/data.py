"""A finite-element mesh as plain arrays: points, cells of one kind, named facet sets, rotational periodicity.

The frame of `points` is the *user frame* of the body made from the mesh. Lengths are metres.
"""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace

import numpy as np

from warpffrf.model.errors import InputError, require_array, require_count, require_direction, unknown_name
from warpffrf.model.mesh import elements
from warpffrf.model.mesh.checks import check_connected, check_orientation, check_used

USUAL_SIZE = (1e-3, 10.0)  # m; outside it the length unit of a file was probably wrong


@dataclass(frozen=True, eq=False)
class FacetSet:
    """Facets of one kind: `kind` in quad4, quad9, tri3, tri6; `nodes` (m, k) int64, VTK order, outward normal."""

    kind: str
    nodes: np.ndarray

    def __post_init__(self) -> None:
        if self.kind not in elements.FACET_NODES:
            raise unknown_name("facet kind", self.kind, elements.FACET_NODES)
        object.__setattr__(self, "nodes", _indices(self.nodes, "facet set", elements.FACET_NODES[self.kind]))

    def __len__(self) -> int:
        return len(self.nodes)

    @property
    def corners(self) -> np.ndarray:
        """Corner nodes (m, 3 or 4)."""
        return self.nodes[:, : elements.FACET_CORNERS[self.kind]]

    @property
    def node_set(self) -> np.ndarray:
        """Sorted numbers of all nodes on the set."""
        return np.unique(self.nodes)


@dataclass(frozen=True, eq=False)
class Cyclic:
    """Rotational periodicity: `sectors` equal sectors about the line `axis_point` + t `axis_direction` (user frame, m).

    Numbering is sector-major: with `nn` nodes a sector, node `s*nn + i` is node `i` turned by `2 pi s / sectors`,
    right-handed about `axis_direction`; cells and full facet sets likewise.
    """

    sectors: int
    axis_point: np.ndarray
    axis_direction: np.ndarray

    def __post_init__(self) -> None:
        object.__setattr__(self, "sectors", require_count(self.sectors, "cyclic: sectors", 3))
        object.__setattr__(self, "axis_point", require_array(self.axis_point, "cyclic: axis_point", (3,)))
        direction = require_direction(self.axis_direction, "cyclic: axis_direction")
        object.__setattr__(self, "axis_direction", direction)


@dataclass(frozen=True)
class MeshReport:
    """Summary of a mesh; `str()` gives readable lines. Lengths m, volume m3."""

    name: str
    node_count: int
    cells: dict[str, int]
    sets: dict[str, int]
    lower: tuple[float, float, float]
    upper: tuple[float, float, float]
    volume: float
    sectors: int | None
    warnings: tuple[str, ...] = ()

    def __str__(self) -> str:
        size = [b - a for a, b in zip(self.lower, self.upper, strict=True)]
        lines = [
            f"mesh {self.name or '(unnamed)'}: {self.node_count} nodes, {3 * self.node_count} degrees of freedom",
            "  cells   " + ", ".join(f"{count} {kind}" for kind, count in self.cells.items()),
            "  sets    " + (", ".join(f"{name} ({count} facets)" for name, count in self.sets.items()) or "none"),
            "  box     " + " x ".join(f"{s:.6g}" for s in size) + " m, from "
            f"({', '.join(f'{x:.6g}' for x in self.lower)}) to ({', '.join(f'{x:.6g}' for x in self.upper)})",
            f"  volume  {self.volume:.6g} m3",
            f"  cyclic  {f'{self.sectors} sectors' if self.sectors else 'no'}",
        ]
        return "\n".join(lines + [f"  warning: {w}" for w in self.warnings])


@dataclass(frozen=True, eq=False)
class Mesh:
    """Points (n, 3) [m], cells of one kind, named facet sets, and rotational periodicity where there is one.

    `cells`: {kind: (m, k) int64} with one kind in hex8, hex27, tet4, tet10 (VTK order). Construction checks shapes,
    finite numbers and index ranges; `check()` looks at the geometry. The arrays are read-only.
    """

    points: np.ndarray
    cells: Mapping[str, np.ndarray]
    facet_sets: Mapping[str, FacetSet] = field(default_factory=dict)
    cyclic: Cyclic | None = None
    name: str = ""

    def __post_init__(self) -> None:
        points = require_array(self.points, "mesh: points", (None, 3))
        points.setflags(write=False)
        if len(self.cells) != 1:
            kinds = ", ".join(self.cells) or "none"
            raise InputError(f"mesh: exactly one kind of volume cell is supported, got {kinds}")
        ((kind, nodes),) = self.cells.items()
        cells = _indices(nodes, f"mesh: {kind} cells", len(elements.cell_kind(kind).nodes))
        if not len(cells):
            raise InputError("mesh: there are no volume cells")
        _in_range(cells, len(points), f"mesh: {kind} cells")
        wanted = elements.cell_kind(kind).facet_kind
        for name, facets in self.facet_sets.items():
            if facets.kind != wanted:
                raise InputError(f"mesh: set {name!r} holds {facets.kind} facets, {kind} cells have {wanted} faces")
            _in_range(facets.nodes, len(points), f"mesh: set {name!r}")
        if self.cyclic is not None:
            for count, what in ((len(points), "nodes"), (len(cells), "cells")):
                if count % self.cyclic.sectors:
                    raise InputError(f"mesh: {count} {what} cannot be split over {self.cyclic.sectors} equal sectors")
        object.__setattr__(self, "points", points)
        object.__setattr__(self, "cells", {kind: cells})
        object.__setattr__(self, "facet_sets", dict(self.facet_sets))

    @property
    def kind(self) -> str:
        """Kind of the volume cells."""
        return next(iter(self.cells))

    @property
    def cell_nodes(self) -> np.ndarray:
        """Node numbers of the volume cells (m, k)."""
        return self.cells[self.kind]

    @property
    def sets(self) -> dict[str, int]:
        """Names of the facet sets, with the number of facets in each."""
        return {name: len(facets) for name, facets in self.facet_sets.items()}

    def facets(self, name: str) -> FacetSet:
        """The facet set called `name`; raises `InputError` listing those that exist."""
        if name not in self.facet_sets:
            raise unknown_name(f"mesh {self.name or '(unnamed)'}: facet set", name, self.facet_sets)
        return self.facet_sets[name]

    def select(self, name: str, from_set: str, predicate: Callable[[np.ndarray], np.ndarray]) -> Mesh:
        """A new mesh with one more facet set: the facets of `from_set` that `predicate` keeps.

        `predicate` gets the facet centres (m, 3) [m], the means of the corners, and returns a mask (m,). Raises
        `InputError` for an unknown `from_set`, a used `name`, a mask of another shape, or an empty selection.
        """
        source = self.facets(from_set)
        if name in self.facet_sets:
            raise InputError(f"mesh: facet set {name!r} exists already, choose another name")
        mask = np.asarray(predicate(self.points[source.corners].mean(axis=1)))
        if mask.shape != (len(source),) or mask.dtype != bool:
            raise InputError(f"select {name!r}: the predicate must return {len(source)} booleans, one per facet")
        if not mask.any():
            raise InputError(f"select {name!r}: no facet of {from_set!r} fulfils the predicate")
        return replace(self, facet_sets={**self.facet_sets, name: FacetSet(source.kind, source.nodes[mask])})

    def volume(self) -> float:
        """Volume [m3], by quadrature exact for the isoparametric cells."""
        kind = elements.cell_kind(self.kind)
        determinants = kind.jacobians(self.points[self.cell_nodes], kind.quadrature_points)
        return float(np.sum(determinants @ kind.quadrature_weights))

    def check(self) -> Mesh:
        """Raise `InputError` for inverted cells, unused nodes or disconnected parts; else return the mesh itself."""
        check_orientation(self.points, self.kind, self.cell_nodes)
        check_used(len(self.points), self.cell_nodes)
        check_connected(self.points, self.cell_nodes)
        return self

    def report(self) -> MeshReport:
        """Bounding box, counts, volume, and a warning where the size lies outside 1 mm to 10 m."""
        lower, upper = self.points.min(axis=0), self.points.max(axis=0)
        size = float(np.max(upper - lower))
        warnings = []
        if not USUAL_SIZE[0] <= size <= USUAL_SIZE[1]:
            warnings.append(
                f"the largest dimension is {size:.3g} m, outside {USUAL_SIZE[0]:g} to {USUAL_SIZE[1]:g} m: "
                "is the length unit right?"
            )
        return MeshReport(
            name=self.name,
            node_count=len(self.points),
            cells={kind: len(nodes) for kind, nodes in self.cells.items()},
            sets=self.sets,
            lower=(float(lower[0]), float(lower[1]), float(lower[2])),
            upper=(float(upper[0]), float(upper[1]), float(upper[2])),
            volume=self.volume(),
            sectors=self.cyclic.sectors if self.cyclic else None,
            warnings=tuple(warnings),
        )

    def content_hash(self) -> str:
        """sha256 over all arrays, set names and the periodicity (not over `name`)."""
        digest = hashlib.sha256()

        def add(label: str, array: np.ndarray) -> None:
            digest.update(f"{label}|{array.dtype.str}|{array.shape}|".encode())
            digest.update(np.ascontiguousarray(array).tobytes())

        add("points", self.points)
        add(self.kind, self.cell_nodes)
        for name, facets in sorted(self.facet_sets.items()):
            add(f"set|{name}|{facets.kind}", facets.nodes)
        if self.cyclic is not None:
            axis = np.concatenate([self.cyclic.axis_point, self.cyclic.axis_direction])
            add(f"cyclic|{self.cyclic.sectors}", axis)
        return digest.hexdigest()


def _indices(nodes: object, name: str, width: int) -> np.ndarray:
    array = np.array(nodes)
    if array.ndim != 2 or array.shape[1] != width or not np.issubdtype(array.dtype, np.integer):
        raise InputError(f"{name}: node numbers must be integers of shape (m, {width}), got {array.shape}")
    array = array.astype(np.int64)
    array.setflags(write=False)
    return array


def _in_range(nodes: np.ndarray, count: int, name: str) -> None:
    if nodes.size and (nodes.min() < 0 or nodes.max() >= count):
        raise InputError(f"{name}: node numbers must lie in 0 to {count - 1}, got {nodes.min()} to {nodes.max()}")
