r"""Stress points of a body, and the operators that give the stresses there.

A point is a node, or lies in a cell e at reference coordinates xi. Its stress is that of the patches around the cell,
or, of wedge6 and tet4, the mean of the nodal stresses with the cell's shape functions, over the nodal averages of the
cell's own material,

    sigma(x) = sum_a N_a(xi) sigma_(a, material of e),

and at a point where several materials meet the mean over them, unless `StressPoints` names a cell set: then only its
cells are averaged, and the stress on an interface is that of this side.

Nodes on a contact surface have exactly the applied traction (`stress_operator`); so do points on its facets, where
the stress is corrected once more. With A = 1 - Q N, N the traction of a stress, the two parts are

    S = A_points [sigma_patches + (W (x) 1) (A_slots - 1) sigma_nodal],
    own = A_points (W (x) 1) [Q d psi]_slots + [Q d psi]_points,

and S = A_points (W (x) 1) A_slots sigma_nodal if nodes are averaged; `W` the shape functions, psi the functions of the
contact grid (nodes or cells) and d the direction of their traction on the true surface. S acts on nodal displacements,
own on the traction coefficients. Within one element of the surface the correction decays with the shape functions; a
node shared by two contact surfaces belongs to the one named first.
"""

from __future__ import annotations

import hashlib
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import scipy.sparse as sp

from warpffrf.model.errors import InputError, require_array, unknown_name
from warpffrf.model.material import Orthotropic
from warpffrf.model.mesh import Mesh
from warpffrf.model.mesh.elements import cell_kind, facet_kind
from warpffrf.model.mesh.structure import Shell
from warpffrf.model.reduced.contact_surface import Recovery
from warpffrf.model.reduced.stress_field import GridSpan, LoadStress, StressField, StressPoints
from warpffrf.offline.contact.contact_grid import grid_values
from warpffrf.offline.contact.node_loads import NORMAL, TANGENTIAL, surface_vectors
from warpffrf.offline.fe import Assignment, Sparse
from warpffrf.offline.stress.operator import (
    InCells,
    Slots,
    nodal_stress,
    point_blocks,
    point_stress,
    traction_correction,
    traction_operator,
)
from warpffrf.offline.stress.patches import has_patches
from warpffrf.offline.stress.point_location import (
    INSIDE,
    SNAP,
    Located,
    SectorOperator,
    distinct_places,
    locate,
    sector_blocks,
)
from warpffrf.offline.structure.assembly import shell_stress

Array = np.ndarray
BATCH = 5000  # nodal values processed together: of 27-node cells some 100 MB
LAYERS = {"top": 1.0, "middle": 0.0, "bottom": -1.0}  # of shells, in half thicknesses
NODE_SETS = ("skin", "all")  # names for the nodes of the outer facets, and for all nodes


@dataclass(frozen=True)
class _Terms:
    """Contributions (e,) to the points: nodal stress of (node, material) times weight; `position` counts the terms of a
    point, in the same order at copies of the point in other sectors. If not `nodal`, the stress is that of the patches
    of the point's cell, and nodes contribute the traction correction only."""

    point: Array
    node: Array
    material: Array
    weight: Array
    position: Array
    nodal: Array


@dataclass(frozen=True)
class _OnSurface:
    """A contact surface: its resolved shape, and the (node, material) pairs and points on it."""

    shape: Any
    slots: Array
    points: Array


class StressPlan:
    """The points of one name and their operators (module docstring).

    `points` (p, 3) [m, user frame]; `home` (p,) sector of each; `one_side`: a cell set was named.
    """

    def __init__(
        self, mesh: Mesh, assignment: Assignment, name: str, wanted: Any, contact: Mapping[str, Any] | None = None
    ) -> None:
        """`wanted`: points (p, 3), `StressPoints`, the name of a facet set, "skin" or "all"; `contact`: {facet set:
        resolved shape}. Raises `InputError` for a point outside, an unknown set, and a body without cells."""
        if not mesh.cells or not assignment.materials:
            cure = "ask for 'top', 'middle' or 'bottom' of shells" if mesh.structure.parts else "give a mesh"
            raise InputError(f"stress {name!r}: stresses need solid cells and a material, the body has none; {cure}")
        self.name, self.mesh, self.assignment = name, mesh, assignment
        self.notes: list[str] = []  # changes made to the given points
        chosen, self.one_side = _chosen_cells(mesh, name, wanted)
        given = wanted.points if isinstance(wanted, StressPoints) else wanted
        self._in_cells: list[tuple[Array, Array, InCells]] = []  # points (e,), weight of each point of the plan, where
        self._cells, of_cell = {}, {}
        for kind, keep in chosen.items():
            self._cells[kind], of_cell[kind] = mesh.cells[kind][keep], assignment.of_cell[kind][keep]
        self._assignment = Assignment(assignment.materials, of_cell)
        if isinstance(given, str):
            where = self._named_nodes(given)
            self.points = np.array(mesh.points[where])
            self._terms = self._of_nodes(where)
            self.home = where // self.sector_nodes
        else:
            self.points = require_array(given, f"stress {name!r}: points", (None, 3))
            if not len(self.points):
                raise InputError(f"stress {name!r}: there are no points; give at least one")
            where = locate(self.points, mesh.points, self._cells, name)
            self.notes += _moved(name, where)
            self._terms = self._of_cells(where)
            self.home = self._home_sector(where, chosen)
        t, count = self._terms, len(assignment.materials)
        keys, slot = np.unique(t.node * count + t.material, return_inverse=True)
        self._slot = slot.ravel()
        self.slots = Slots(keys // count, keys % count)
        shape = (len(self.points), len(keys))
        self.weights = sp.csr_matrix((t.weight, (t.point, self._slot)), shape=shape)
        self._averaged = sp.csr_matrix((t.weight * t.nodal, (t.point, self._slot)), shape=shape)
        self._averaged.eliminate_zeros()
        poisson = np.array([0.0 if isinstance(m, Orthotropic) else m.poisson_ratio for m in assignment.materials])
        self._poisson = poisson[self.slots.material]
        self.on = self._surfaces(contact or {}, where)

    # --- where the points are ---

    @property
    def sector_nodes(self) -> int:
        """Nodes of a sector; of a mesh without periodicity all of them."""
        cyclic = self.mesh.cyclic
        return len(self.mesh.points) // (cyclic.sectors if cyclic else 1)

    def _named_nodes(self, wanted: str) -> Array:
        """Node numbers (p,) of the facet set, or of one of `NODE_SETS`, on the cells that are averaged."""
        mesh = self.mesh
        if wanted in mesh.facet_sets:
            nodes = mesh.facets(wanted).node_set
        elif wanted == "skin":
            nodes = mesh.outer_facets().node_set
        elif wanted == "all":
            nodes = np.arange(len(mesh.points))
        else:
            raise unknown_name(f"stress {self.name!r}: facet set", wanted, [*mesh.facet_sets, *NODE_SETS])
        if self.one_side:
            nodes = nodes[np.isin(nodes, np.concatenate([block.ravel() for block in self._cells.values()]))]
            if not len(nodes):
                raise InputError(f"stress {self.name!r}: no node of {wanted!r} lies on the chosen cell set")
        if mesh.structure.parts:
            on_cells = np.isin(nodes, np.concatenate([block.ravel() for block in self._cells.values()]))
            if not on_cells.any():
                raise InputError(
                    f"stress {self.name!r}: {wanted!r} has shells only; ask for 'top', 'middle' or 'bottom'"
                )
            if not on_cells.all():
                self.notes.append(
                    f"stress {self.name!r}: {np.sum(~on_cells)} nodes of shells and beams alone are left out; the "
                    "stress of shells is that of 'top', 'middle' and 'bottom'"
                )
            nodes = nodes[on_cells]
        return nodes

    def _of_nodes(self, nodes: Array) -> _Terms:
        """All (node, material) pairs of the requested nodes, with the mean over materials."""
        count = len(self.assignment.materials)
        found = [
            np.unique(block * count + self._assignment.of_cell[kind][:, None]) for kind, block in self._cells.items()
        ]
        pairs = np.unique(np.concatenate(found))
        pairs = pairs[np.isin(pairs // count, nodes)]
        point = np.searchsorted(nodes, pairs // count)
        share = np.bincount(point, minlength=len(nodes))
        first = np.searchsorted(point, point)
        position, nodal = np.arange(len(point)) - first, np.ones(len(point), dtype=bool)
        return _Terms(point, pairs // count, pairs % count, 1.0 / share[point], position, nodal)

    def _of_cells(self, located: Located) -> _Terms:
        """One cell per point and material: its nodes with the shape functions; `_in_cells` if patches have stress."""
        kinds = list(self._cells)
        material = np.zeros(len(located.point), dtype=np.int64)
        for b, kind in enumerate(kinds):
            here = located.kind == b
            material[here] = self._assignment.of_cell[kind][located.cell[here]]
        order = np.lexsort((located.cell, located.kind, material, located.point))
        key = located.point[order] * len(self.assignment.materials) + material[order]
        kept = order[np.concatenate([[True], np.diff(key) > 0])]
        share = 1.0 / np.bincount(located.point[kept], minlength=len(self.points))
        parts = []
        for b, kind in enumerate(kinds):
            of_kind = kept[located.kind[kept] == b]
            for g in np.unique(material[of_kind]):
                here = of_kind[material[of_kind] == g]
                point, nodes = located.point[here], self._cells[kind][located.cell[here]]
                width = nodes.shape[1]
                parts.append(
                    (
                        np.repeat(point, width),
                        nodes.ravel(),
                        np.full(nodes.size, g),
                        (cell_kind(kind).shape(located.xi[here])[0] * share[point][:, None]).ravel(),
                        np.tile(np.arange(width), len(here)) + 27 * g,
                        np.full(nodes.size, not has_patches(kind)),
                    )
                )
                if has_patches(kind):
                    self._in_cells.append((point, share, InCells(kind, int(g), nodes, located.xi[here])))
        return _Terms(*(np.concatenate(v) for v in zip(*parts, strict=True)))

    def _home_sector(self, located: Located, chosen: dict[str, Array]) -> Array:
        """Sector of a cell of each point; zero for a mesh without periodicity."""
        home = np.zeros(len(self.points), dtype=np.int64)
        cyclic = self.mesh.cyclic
        if cyclic is None:
            return home
        for b, (kind, keep) in enumerate(chosen.items()):
            here = located.kind == b
            number = np.flatnonzero(keep)[located.cell[here]]
            home[located.point[here]] = number // (len(self.mesh.cells[kind]) // cyclic.sectors)
        return home

    def _surfaces(self, contact: Mapping[str, Any], where: Array | Located) -> dict[str, _OnSurface]:
        taken_slots = np.zeros(len(self.slots), dtype=bool)
        taken_points = np.zeros(len(self.points), dtype=bool)
        found = {}
        for name, shape in contact.items():
            facets = self.mesh.facets(name)
            slots = np.isin(self.slots.node, facets.node_set) & ~taken_slots
            on = self._on_facets(where, facets) if isinstance(where, Located) else np.isin(where, facets.node_set)
            points = on & ~taken_points
            taken_slots |= slots
            taken_points |= points
            found[name] = _OnSurface(shape, np.flatnonzero(slots), np.flatnonzero(points))
        return found

    def _on_facets(self, located: Located, facets: Any) -> Array:
        """Which points (p,) lie on a facet of the set."""
        on = np.zeros(len(self.points), dtype=bool)
        for b, (kind, block) in enumerate(self._cells.items()):
            here = np.flatnonzero(located.kind == b)
            element = cell_kind(kind)
            for facet, faces in element.faces.items():
                if facet not in facets.blocks:
                    continue
                corners = facet_kind(facet).corner_count
                wanted = _keys(facets.blocks[facet][:, :corners])
                for face in faces:
                    x = element.nodes[face[:corners]]
                    normal = np.cross(x[1] - x[0], x[2] - x[0])
                    height = (located.xi[here] - x[0]) @ normal / np.linalg.norm(normal)
                    near = here[np.abs(height) < INSIDE]
                    same = np.isin(_keys(block[located.cell[near]][:, face[:corners]]), wanted)
                    on[located.point[near[same]]] = True
        return on

    # --- operators ---

    @property
    def cells(self) -> dict[str, Array]:
        """The cells that are averaged, {kind: (m, k)}."""
        return self._cells

    @property
    def of_cell(self) -> dict[str, Array]:
        """The number of the material of each of `cells`."""
        return self._assignment.of_cell

    def operator(self) -> Sparse:
        """S, csr (6 p, 3 n) [Pa/m]: nodal displacements (dof 3*node + component) to stress without `own`, user axes."""
        return self.operator_at(np.arange(len(self.points)))

    def operator_at(self, rows: Array) -> Sparse:
        """The rows of `operator` of some of the points (r,): csr (6 r, 3 n)."""
        at_slots, at_points = self._without_traction()
        nodes = np.cumsum(np.diff(self.weights.indptr)[rows])
        found = []
        for part in np.split(rows, np.flatnonzero(np.diff(nodes // BATCH)) + 1):
            S = self._from_slots(self._averaged[part], at_slots)
            inside = sp.csr_matrix(self.weights[part] - self._averaged[part])
            if inside.nnz:
                S = S + self._from_slots(inside, at_slots - np.eye(6)) + self._in_patches(part)
            found.append(sp.csr_matrix(point_blocks(at_points[part]) @ S))
        return sp.csr_matrix(sp.vstack(found, format="csr"))

    def _from_slots(self, weights: Sparse, blocks: Array) -> Sparse:
        """csr (6 r, 3 n): `weights` (r, K) of nodal stresses times `blocks` (K, 6, 6)."""
        used = np.unique(weights.indices)
        used = used[np.any(blocks[used] != 0.0, axis=(1, 2))]
        if not len(used):
            return sp.csr_matrix((6 * weights.shape[0], self.mesh.points.size))
        slots = Slots(self.slots.node[used], self.slots.material[used])
        S = point_blocks(blocks[used]) @ nodal_stress(self.mesh.points, self._cells, self._assignment, slots)
        return sp.kron(weights[:, used], sp.identity(6), format="csr") @ S

    def _in_patches(self, rows: Array) -> Sparse:
        """csr (6 r, 3 n): stress of the points `rows` (r,) by the patches of the cells that they lie in."""
        place = np.full(len(self.points), -1)
        place[rows] = np.arange(len(rows))
        total = sp.csr_matrix((6 * len(rows), self.mesh.points.size))
        for point, share, cells in self._in_cells:
            here = np.flatnonzero(place[point] >= 0)
            if len(here):
                where = replace(cells, nodes=cells.nodes[here], xi=cells.xi[here])
                S = point_stress(self.mesh.points, self._cells, self._assignment, where)
                entries = (share[point[here]], (place[point[here]], np.arange(len(here))))
                spread = sp.csr_matrix(entries, shape=(len(rows), len(here)))
                total = total + sp.kron(spread, sp.identity(6), format="csr") @ S
        return sp.csr_matrix(total)

    def _without_traction(self) -> tuple[Array, Array]:
        """A = 1 - Q N at (node, material) pairs (K, 6, 6) and points (p, 6, 6); the identity off contact surfaces."""
        at_slots = np.tile(np.eye(6), (len(self.slots), 1, 1))
        at_points = np.tile(np.eye(6), (len(self.points), 1, 1))
        for surface in self.on.values():
            for A, (where, place, poisson) in zip((at_slots, at_points), self._sites(surface), strict=True):
                normal = surface.shape.normal(*surface.shape.chart(place)[:2])
                A[where] -= traction_correction(normal, poisson) @ traction_operator(normal)
        return at_slots, at_points

    def without_traction(self, stress: Array) -> Array:
        """Stresses (r, p, 6) at the points with zero traction on contact surfaces."""
        return np.einsum("pij,rpj->rpi", self._without_traction()[1], stress)

    def _sites(self, surface: _OnSurface) -> list[tuple[Array, Array, Array]]:
        """For the (node, material) pairs and the points on the surface: numbers, positions [m], Poisson ratios."""
        at_points = np.asarray(self.weights @ self._poisson)
        return [
            (surface.slots, self.mesh.points[self.slots.node[surface.slots]], self._poisson[surface.slots]),
            (surface.points, self.points[surface.points], at_points[surface.points]),
        ]

    def own(self, name: str, grid: Any, span: GridSpan, directions: tuple[str, ...] = ("normal",)) -> Sparse:
        """The part of the stress that follows from the traction alone, csr (6 p, functions) [-], on the coefficients of
        the functions of `grid` over `span`, numbered by direction, column, row."""
        surface = self.on[name]
        slots, points = self._sites(surface)
        parts = []
        for size, (where, place, poisson) in ((len(self.slots), slots), (len(self.points), points)):
            theta, z, _ = surface.shape.chart(place)
            Q = traction_correction(surface.shape.normal(theta, z), poisson)
            psi = sp.coo_matrix(grid_values(theta, z, grid, span, surface.shape.profile().turn))
            rows = (6 * where[psi.row][:, None] + np.arange(6)).ravel()
            blocks = []
            for direction in directions:
                value = np.einsum("pci,pi->pc", Q, surface_vectors(surface.shape, theta, z, direction))
                data = (value[psi.row] * psi.data[:, None]).ravel()
                entries = (data, (rows, np.repeat(psi.col, 6)))
                blocks.append(sp.csr_matrix(entries, shape=(6 * size, span.columns * grid.rows)))
            parts.append(sp.csr_matrix(sp.hstack(blocks)))
        spread = sp.kron(self.weights, sp.identity(6), format="csr") @ parts[0]
        return sp.csr_matrix(point_blocks(self._without_traction()[1]) @ spread + parts[1])

    def sector_operator(self, axes: Array) -> SectorOperator:
        """The operator of a periodic mesh, `axes` (3, 3): those of sector 0 in columns, the third along the axis."""
        cyclic = self.mesh.cyclic
        if cyclic is None:
            raise ValueError("sector_operator needs a periodic mesh")
        if self.one_side:  # the cells of a set need not repeat
            first, place = np.arange(len(self.points)), np.arange(len(self.points))
        else:
            size = float(np.ptp(self.mesh.points, axis=0).max())
            relative = self.points - cyclic.axis_point
            first, place = distinct_places(relative, self.home, self.node_marks(), axes, size, cyclic.sectors)
        blocks = sector_blocks(self.operator_at(first), self.home[first], axes, cyclic.sectors)
        return SectorOperator(blocks, place, self.home, axes, cyclic.sectors)

    def node_marks(self) -> Array:
        """A number (p,) for each point that encodes which of its nodes lie on which contact surface, and whether it
        does itself: equal for copies of a point in other sectors that are treated in the same way."""
        flag, own = np.zeros(len(self.slots)), np.zeros(len(self.points))
        for i, surface in enumerate(self.on.values()):
            flag[surface.slots] = i + 1.0
            own[surface.points] = i + 1.0
        # random numbers for the positions: sums over flagged ones agree when the same are flagged
        code = np.random.default_rng(0).random(int(self._terms.position.max()) + 2)
        marked = flag[self._slot] * code[self._terms.position]
        return np.bincount(self._terms.point, marked, minlength=len(self.points)) + own * code[-1]

    def field(
        self,
        modes: Array,
        contact: Mapping[str, Any],
        normal: Mapping[str, tuple[Recovery, GridSpan]],
        tangential: Mapping[str, tuple[Recovery, GridSpan]] | None = None,
        sectors: SectorOperator | None = None,
    ) -> StressField:
        """The finished field: `modes` (6 p, m) [Pa], user axes; the body's `contact` surfaces, and for each the
        transfer, with 6 rows per point, of its `normal` and `tangential` loads.

        Modes and transfers are kept in single precision (measured: stresses to 1e-7 of the largest).
        """
        loads: dict[bool, dict[str, LoadStress]] = {False: {}, True: {}}
        for is_tangential, transfers in ((False, normal), (True, tangential or {})):
            directions = TANGENTIAL if is_tangential else NORMAL
            for name, (transfer, span) in transfers.items():
                single = np.complex64 if np.iscomplexobj(transfer.transfer) else np.float32
                stored = replace(transfer, transfer=transfer.transfer.astype(single, copy=False))
                part = LoadStress(contact[name], stored, None, span, is_tangential)
                loads[is_tangential][name] = replace(part, own=self.own(name, part.grid, span, directions))
        count = len(self.points)
        place, home = (np.arange(count), np.zeros(count, int)) if sectors is None else (sectors.place, sectors.sector)
        shaped = np.ascontiguousarray(modes.T).reshape(modes.shape[1], count, 6).astype(np.float32)
        return StressField(self.name, self.points, shaped, loads[False], loads[True], place, home)


class ShellStressPlan(StressPlan):
    """Stress at the centres of all shell elements, on their top or bottom face or in the middle: `points` (p, 3)."""

    def __init__(self, mesh: Mesh, assignment: Assignment, name: str, layer: str) -> None:
        if not mesh.structure.of(Shell):
            raise InputError(f"stress {name!r}: {layer!r} is a layer of shells, the mesh has none; name a facet set")
        self.name, self.mesh, self.assignment, self.notes = name, mesh, assignment, []
        self.points, self._operator = shell_stress(mesh, LAYERS[layer])
        self.home = np.zeros(len(self.points), dtype=np.int64)

    def operator(self) -> Sparse:
        """S, csr (6 p, 3 n + 3 r) [Pa/m, Pa]: displacements and rotations of nodes to stress, user axes."""
        return self._operator

    def own(self, name: str, grid: Any, span: GridSpan, directions: tuple[str, ...] = ("normal",)) -> Sparse:
        """Zero: contact surfaces are on solids."""
        return sp.csr_matrix((6 * len(self.points), len(directions) * span.columns * grid.rows))


def stress_plans(
    mesh: Mesh, assignment: Assignment, wanted: Mapping[str, Any], contact: Mapping[str, Any]
) -> list[StressPlan]:
    """A plan of each name in `wanted`; `contact` {facet set: resolved shape}. `StressPlan`, `ShellStressPlan`."""
    found: list[StressPlan] = []
    for name, points in wanted.items():
        on_shells = isinstance(points, str) and points in LAYERS and points not in mesh.facet_sets
        found.append(
            ShellStressPlan(mesh, assignment, name, points)
            if on_shells
            else StressPlan(mesh, assignment, name, points, contact)
        )
    return found


def stress_settings(wanted: Mapping[str, Any]) -> dict[str, Any]:
    """`wanted` as JSON, for the key of the cache: names of sets, and a hash of points. Raises `InputError` unless it is
    {name: points}."""
    if not isinstance(wanted, Mapping) or not all(isinstance(n, str) and n and "/" not in n for n in wanted):
        raise InputError(f"reduce: stress must be {{name: points}} with names without '/', got {wanted!r}")
    found = {}
    for name, points in wanted.items():
        side = points.cell_set if isinstance(points, StressPoints) else None
        given = points.points if isinstance(points, StressPoints) else points
        if not isinstance(given, str):
            array = require_array(given, f"stress {name!r}: points", (None, 3))
            given = hashlib.sha256(array.tobytes()).hexdigest()
        found[name] = {"points": given, "cell_set": side}
    return found


def _chosen_cells(mesh: Mesh, name: str, wanted: Any) -> tuple[dict[str, Array], bool]:
    """Mask of the cells of each kind that are averaged, and whether a cell set chose them."""
    if not isinstance(wanted, StressPoints):
        return {kind: np.ones(len(nodes), dtype=bool) for kind, nodes in mesh.cells.items()}, False
    if wanted.cell_set not in mesh.cell_sets:
        raise unknown_name(f"stress {name!r}: cell set", wanted.cell_set, mesh.cell_sets)
    chosen = np.zeros(mesh.cell_count, dtype=bool)
    chosen[mesh.cell_sets[wanted.cell_set]] = True
    if not chosen.any():
        raise InputError(f"stress {name!r}: cell set {wanted.cell_set!r} is empty; choose another")
    return {kind: mask for kind, mask in mesh.by_block(chosen) if mask.any()}, True


def _moved(name: str, located: Located) -> list[str]:
    """A note where points were moved onto the mesh."""
    count = int(np.sum(located.moved > 0.0))
    if not count:
        return []
    return [
        f"stress {name!r}: {count} of {len(located.moved)} points lie outside the mesh, by up to "
        f"{located.moved.max():.2g} m and at most {100 * SNAP:g} % of a cell; their stress is that of the nearest "
        "point on it"
    ]


def _keys(corners: Array) -> Array:
    """One comparable key per facet: its sorted corners."""
    ordered = np.ascontiguousarray(np.sort(corners, axis=1).astype(np.int64))
    return ordered.view([("", np.int64)] * ordered.shape[1]).ravel()
