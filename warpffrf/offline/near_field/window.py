r"""The response of the half-space to loads on a contact surface, discretised by the body's own elements.

Around a few neighbouring functions of the contact grid the cells of the body are flattened (`charts`): a piece of a
half-space with the mesh of the body. Its surface has the consistent loads f_j of the functions; on its cut faces
the displacement is that of the exact half-space under the same loads,

    K v_j = f_j,     v_j = half-space on cut faces,     T_ij = f_i^T v_j,

so that T is the half-space's compliance with the discretisation error of this mesh near a load. The compliance C of the
whole body has the same error there, and C - T is smooth however coarse the mesh is. Faces on the surface next to the
contact facets are free, and so is an end face of the body, where the half-space is a quarter space (`ends`).

Cells that cannot be flattened are omitted: those with nodes near the centre of curvature, or too far round the
body. On a mesh with few cells over the radius only those in the outer layer remain.

Normal loads and displacements are outward. The loads are those of the body, without the rotation of the directions over
a facet: f_a = int N_a psi_j dA on the flat surface.

Under tangential loads the end face is a symmetry plane, as for the half-space with an image of the load (`exact`):
under a load along s and its image the displacement along t is zero, under one along t and its image only that along t
is not. A free face together with cut faces that move with half-space and image would mix two fields: the compliance
along t of a hollow roller then differed between 2 and 4 mm cells by 3 % of the own response of a patch of 0.6 x 8 mm,
and by 9 % at 4 mm from an end.

Functions. The functions of a contact grid as unit loads on a flattened surface: shape functions of nodes, and cells for
tangential tractions.

Charts. A contact surface flattened around one of its points: the domain of the near field's half-space.

The unit tangents e_theta and t_z and the outward normal n are those at the point x_c of the surface. A point x of the
body is mapped to (s, t, y): y is its distance below the surface, and the components a, b of the nearest point of the
surface along the tangents become arcs of the principal curvatures k,

    s = asin(k_theta a)/k_theta,   t = asin(k_z b)/k_z       (a and b themselves where k = 0),

so that a cylinder unrolls without stretching, and a sphere keeps its distances from x_c along both principal lines. An
extruded curve has s and t in its own chart, the arc length and z.
(s, t, -y) is right-handed: cells keep their orientation.

Ends. Free end faces of a contact surface, and their contribution to the half-space.

For a load at the distance d from a plane end face at right angles to the surface, the half-space field is mirrored at
the end, and `QuarterSpace` removes the stresses that the mirror image leaves on the face. Ends of other angles, fillets
and chamfers have no table: there the half-space is assumed to continue, and their effect is left to the difference
between the body and the half-space, which is then not smooth within about a spacing of the grid.

If a crown meets a plane face the edge is nearly square; up to the slope `SQUARE` it is taken as such, and its face
is perpendicular to the flat surface (`on_end`).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from warpffrf.model.material import Material
from warpffrf.model.mesh import Mesh
from warpffrf.model.mesh.checks import FLAT_CELL, jacobian_range
from warpffrf.model.mesh.elements import cell_kind, facet_kind
from warpffrf.model.mesh.facets import FacetSet, outer_faces, row_numbers
from warpffrf.model.reduced.contact_grid import SurfaceGrid
from warpffrf.model.reduced.far_field import FreeEnd
from warpffrf.offline.contact.contact_grid import wrapped
from warpffrf.offline.contact.node_loads import ContactFacets
from warpffrf.offline.fe import STIFFNESS_DEGREE, Assignment, Sparse, assemble, rule
from warpffrf.offline.near_field.half_space import OUTWARD, EndField, PointLoads, half_space_at
from warpffrf.offline.solvers import factorise

Array = np.ndarray
MIRRORED = ((1,), (0, 2), ())  # components fixed on an end face under a load along s, along t and outwards
DEEPEST = 0.8  # of the smaller radius of curvature: a flattened cell there is five times as wide as the original


@dataclass(frozen=True, eq=False)
class FlatLoads:
    """Nodal `forces` (n, m) [-] in one `direction` (0 along s, 1 along t, 2 outwards), and the same loads for the
    half-space: `points`, with other forces `at_points` (sets, m / sets, points) if given."""

    forces: Sparse
    points: PointLoads
    direction: int = OUTWARD
    at_points: Array | None = None


@dataclass(frozen=True, eq=False)
class FlatCells:
    """Flattened cells: `points` (n, 3) [m] in (s, t, -y), their numbers `of_body` (n,) in the body, `cells` {kind:
    (m, k)} numbered here, and their `numbers` {kind: (m,)} in the body's blocks; `on_surface` (n,)."""

    points: Array
    of_body: Array
    cells: dict[str, Array]
    numbers: dict[str, Array]
    on_surface: Array

    @classmethod
    def around(
        cls,
        points: Array,
        cells: Mapping[str, Array],
        chart: FlatChart,
        box: Sequence[float],
        reach: float,
        depth: float,
        tolerance: float,
        ends: Sequence[tuple[Array, float]] = (),
    ) -> FlatCells:
        """The body's cells with a corner within `reach` [m] of the `box` (s_low, s_high, t_low, t_high) [m] of the flat
        surface, and less than `depth` [m] below it; nodes nearer to the surface than the `tolerance` [m] are on it.
        `ends`: of each end face which `points` lie on it (n,), and its t [m] after flattening."""
        s_low, s_high, t_low, t_high = box
        radius = np.hypot(max(-s_low, s_high) + reach, max(-t_low, t_high) + reach) + depth
        near = np.flatnonzero(np.sum((points - chart.origin) ** 2, axis=1) < radius**2)
        near = near[chart.before(points[near])]
        s, t, y = chart.flat(points[near])
        inside = (s > s_low - reach) & (s < s_high + reach) & (t > t_low - reach) & (t < t_high + reach) & (y < depth)
        wanted = np.zeros(len(points), dtype=bool)
        wanted[near[inside]] = True
        numbers = {
            kind: np.flatnonzero(wanted[nodes[:, : cell_kind(kind).corner_count]].any(axis=1))
            for kind, nodes in cells.items()
        }
        numbers = {kind: found for kind, found in numbers.items() if len(found)}
        places = np.zeros((len(points), 3))
        bears = np.zeros(len(points), dtype=bool)
        used = np.unique(np.concatenate([cells[kind][found].ravel() for kind, found in numbers.items()]))
        s, t, y = chart.flat(points[used])
        for face, at in ends:
            t[face[used]] = at
        on = np.abs(y) < tolerance
        places[used] = np.stack([s, t, np.where(on, 0.0, -y)], axis=1)
        bears[used] = chart.before(points[used]) & (y < DEEPEST * chart.smallest_radius(points[used]))
        if chart.shape.profile().curve is not None:
            bears[used] &= y > -tolerance  # not the next tooth, above a flank
        kept = {}
        for kind, found in numbers.items():
            good = found[bears[cells[kind][found]].all(axis=1) & _upright(places, kind, cells[kind][found])]
            if len(good):
                kept[kind] = good
        used = np.unique(np.concatenate([cells[kind][found].ravel() for kind, found in kept.items()] or [used[:0]]))
        own = {kind: np.searchsorted(used, cells[kind][found]) for kind, found in kept.items()}
        return cls(places[used], used, own, kept, places[used, 2] == 0.0)

    def carriers(self, surface: FacetSet) -> Array:
        """Which facets of `surface` (body numbers; all blocks in order) are faces of these cells (m,)."""
        keys = [_corners(kind, nodes) for kind, nodes in surface.blocks.items()]
        count = sum(len(k) for k in keys)
        outer = [_corners(kind, self.of_body[nodes]) for kind, nodes in outer_faces(self.cells).blocks.items()]
        number = row_numbers(np.concatenate([*keys, *outer]))
        return np.isin(number[:count], number[count:])

    def cut(self, end: EndField | None, tolerance: float) -> Array:
        """Nodes (c,) of all outer faces that are neither on the surface nor on the `end`."""
        held = []
        for nodes in outer_faces(self.cells).blocks.values():
            free = self.on_surface[nodes].all(axis=1)
            if end is not None:
                free |= (np.abs(self.points[nodes, 1] - end.t) < tolerance).all(axis=1)
            held.append(nodes[~free].ravel())
        return np.unique(np.concatenate(held))

    def reaches(self, end: EndField, tolerance: float) -> bool:
        """Whether the end face is among the outer faces of the cells."""
        on = np.abs(self.points[:, 1] - end.t) < tolerance
        return any(on[nodes].all(axis=1).any() for nodes in outer_faces(self.cells).blocks.values())

    def solve(
        self, loads: Sequence[FlatLoads], material: Material, end: EndField | None, tolerance: float
    ) -> list[Array]:
        """v (n, 3, m) of each of the `loads`: displacement [m] of all nodes along s, t and outwards per unit force."""
        n, nu = len(self.points), material.poisson_ratio
        one = Assignment((material,), {kind: np.zeros(len(c), dtype=np.int64) for kind, c in self.cells.items()})
        K, _ = assemble(self.points, self.cells, one)
        cut = self.cut(end, tolerance)
        together: dict[tuple[int, ...], list[int]] = {}
        for number, part in enumerate(loads):
            together.setdefault(MIRRORED[part.direction] if end is not None else (), []).append(number)
        found = {}
        for components, numbers in together.items():
            held = np.zeros((n, 3), dtype=np.bool_)
            held[cut] = True
            if end is not None:
                held[:, components] |= (np.abs(self.points[:, 1] - end.t) < tolerance)[:, None]
            widths = [loads[number].forces.shape[1] for number in numbers]
            u, force = (np.zeros((n, 3, sum(widths))) for _ in range(2))
            places = [slice(stop - width, stop) for stop, width in zip(np.cumsum(widths), widths, strict=True)]
            for number, at in zip(numbers, places, strict=True):
                part = loads[number]
                exact = half_space_at(self.points[cut], part.points, nu, end, part.direction, part.at_points)
                u[cut, :, at] = exact.transpose(1, 0, 2) / material.youngs_modulus
                force[:, part.direction, at] = part.forces.toarray()
            v = self._static(K, held, u, force)
            found |= {number: v[:, :, at] for number, at in zip(numbers, places, strict=True)}
        return [found[number] for number in range(len(loads))]

    def _static(self, K: Any, held: Array, u: Array, force: Array) -> Array:
        """u (n, 3, m) under the `force` (n, 3, m), with prescribed displacements where `held` (n, 3)."""
        free, fixed = np.flatnonzero(~held), np.flatnonzero(held)
        K_free: Any = K[free]
        v = u.reshape(-1, u.shape[2])
        right = force.reshape(v.shape)[free] - K_free[:, fixed] @ v[fixed]
        coordinates = np.repeat(self.points, 3, axis=0)[free]
        v[free] = factorise(K_free[:, free], coordinates=coordinates).solve(right)
        return v.reshape(u.shape)


def _upright(points: Array, kind: str, cells: Array) -> Array:
    """Which `cells` (m, k) of one kind are not inverted at their nodes or integration points (m,)."""
    at_nodes, cube = jacobian_range(points, kind, cells, cell_kind(kind).nodes)
    slopes = np.einsum("qkd,eki->eqdi", rule(kind, STIFFNESS_DEGREE[kind]).gradients, points[cells])
    return np.minimum(at_nodes, np.linalg.det(slopes).min(axis=1, initial=np.inf)) > FLAT_CELL * cube


def _corners(kind: str, nodes: Array) -> Array:
    corners = np.sort(nodes[:, : facet_kind(kind).corner_count], axis=1)
    return np.pad(corners, ((0, 0), (0, 4 - corners.shape[1])), constant_values=-1)


GAUSS = 3  # points on either side of a node and direction, of loads for the cut faces, which are REACH away


class SpreadFunctions:
    """The functions of a contact `grid`, nodes or cells, on a resolved `shape`: their areas, and unit loads distributed
    over them as forces at points."""

    def __init__(self, shape: Any, grid: SurfaceGrid) -> None:
        self.shape, self.grid = shape, grid
        x, w = np.polynomial.legendre.leggauss(GAUSS)
        x, w = 0.5 * (x + 1.0), 0.5 * w
        share, value = (1.0, 1.0 - x) if grid.kind == "nodes" else (0.5, np.ones(GAUSS))  # of the step to the next node
        reach = share * np.diff(grid.z)
        rows = grid.rows
        self._z = np.repeat(grid.z[:, None], 2 * GAUSS, axis=1)
        self._z_weight = np.zeros((rows, 2 * GAUSS))
        for here, side, beyond in (
            (np.s_[1:, :GAUSS], -1.0, grid.z[1:, None]),
            (np.s_[:-1, GAUSS:], 1.0, grid.z[:-1, None]),
        ):
            self._z[here] = beyond + side * reach[:, None] * x
            self._z_weight[here] = w * value * reach[:, None] * shape.measure_at(self._z[here])
        self.area = grid.pitch * grid.gram_z(shape).sum(axis=1)  # (rows,) [m^2] of the functions of a column
        self._z_weight /= self._z_weight.sum(axis=1)[:, None]
        self._turn = grid.pitch * share * np.concatenate([-x, x])
        self._turn_weight = share * np.concatenate([w * value, w * value])

    def point_loads(self, chart: FlatChart, columns: Array, rows: Array) -> PointLoads:
        """Functions of `columns` x `rows` (row fastest) as unit forces at points of the chart."""
        g = self.grid
        shape = (len(columns), len(rows), len(self._turn), self._z.shape[1])
        theta = (g.theta_start + g.pitch * columns)[:, None, None, None] + self._turn[:, None]
        z = self._z[rows][:, None, :]
        s, t = chart.on_surface(np.broadcast_to(theta, shape), np.broadcast_to(z, shape))
        force = np.broadcast_to(self._turn_weight[:, None] * self._z_weight[rows][:, None, :], shape)
        return PointLoads(*(np.ascontiguousarray(v).reshape(len(columns) * len(rows), -1) for v in (s, t, force)))


class NearFunctions:
    """The nodes of a contact `grid` on the facets of set `name`, and the cells of a grid `tangential` on the same nodes
    if there is one."""

    def __init__(
        self, mesh: Mesh, name: str, shape: Any, grid: SurfaceGrid, tangential: SurfaceGrid | None = None
    ) -> None:
        self.mesh, self.shape, self.grid, self.name = mesh, shape, grid, name
        self.surface = mesh.facets(name)
        self.facets = ContactFacets.of(mesh.points, self.surface, shape)
        self.edge = self.facets.chart.edge
        around = grid.pitch * float(np.max(shape.radius_at(grid.z)))
        self.spacing = max(self.edge, around, float(np.max(np.diff(grid.z))))  # [m]
        self.grid_nodes = SpreadFunctions(shape, grid)
        self.cells = None if tangential is None else SpreadFunctions(shape, tangential)

    @property
    def blocks(self) -> list[tuple[str, SpreadFunctions, SpreadFunctions]]:
        """Parts of the compliance: name, functions of the displacement, functions of the force."""
        found = [("nn", self.grid_nodes, self.grid_nodes)]
        if self.cells is not None:
            found += [("tt", self.cells, self.cells), ("tn", self.cells, self.grid_nodes)]
        return found


def sharpest(shape: Any, grid: SurfaceGrid) -> tuple[float, float]:
    """Largest principal curvatures [1/m], unsigned, around and along the meridian, over the columns of the `grid`."""
    around, along = (np.abs(k) for k in shape.curvatures(grid.theta, float(np.mean(grid.z))))
    return float(np.max(around)), float(np.max(along))


FARTHEST = 1.4  # rad between normals: arcs are computed from their chords, which shorten again from pi/2 on
STRAIGHT = 1e-12  # of a curvature times a length: below it the arc is its chord to round-off


@dataclass(frozen=True, eq=False)
class FlatChart:
    """The chart of a resolved `shape` about its point (`theta`, `z`) [rad or m, m]."""

    shape: Any
    theta: float
    z: float

    @property
    def origin(self) -> Array:
        """x_c (3,) [m], user frame."""
        return self.shape.point(self.theta, self.z)

    def smallest_radius(self, points: Array) -> Array:
        """Smaller radius of curvature (n,) [m] above `points` (n, 3) [m], user frame, inf where the surface is convex
        in no direction; it is constant except on free surfaces."""
        theta, z = np.full(len(points), self.theta), np.full(len(points), self.z)
        if self.shape.profile().free:
            theta, z, _ = self.shape.chart(points)
        largest = np.max(self.shape.curvatures(theta, z), axis=0)
        return np.divide(1.0, largest, out=np.full(len(points), np.inf), where=largest > 0.0)

    def before(self, points: Array) -> Array:
        """Which of `points` (n, 3) [m], user frame, lie less than `FARTHEST` around the body from x_c (n,)."""
        theta, z, _ = self.shape.chart(points)
        return self.shape.normal(theta, z) @ self.shape.normal(self.theta, self.z) > np.cos(FARTHEST)

    def flat(self, points: Array) -> tuple[Array, Array, Array]:
        """(s, t, y) [m] of `points` (n, 3) [m], user frame; y > 0 below the surface."""
        theta, z, distance = self.shape.chart(points)
        return *self.on_surface(theta, z), -distance

    def on_surface(self, theta: Array, z: Array) -> tuple[Array, Array]:
        """(s, t) [m] of the points (theta, z) of the surface, less than a quarter of a revolution from the centre."""
        if (profile := self.shape.profile()).curve is not None:  # its chart is flat already
            return wrapped(theta - self.theta, profile.turn), np.asarray(z - self.z, float)
        off = self.shape.point(theta, z) - self.origin
        k_theta, k_z = (float(k) for k in self.shape.curvatures(self.theta, self.z))
        return (
            _arc(off @ self.shape.around(self.theta), k_theta),
            _arc(off @ self.shape.along(self.theta, self.z), k_z),
        )


def _arc(chord: Array, curvature: float) -> Array:
    """Length of the arc of `curvature` [1/m] from its middle to the point at the distance `chord` [m]."""
    if abs(curvature) * np.max(np.abs(chord), initial=0.0) < STRAIGHT:
        return chord
    return np.arcsin(np.clip(curvature * chord, -1.0, 1.0)) / curvature


ON_SURFACE = 1e-4  # of a facet's edge: nodes within this distance of the true surface are on it
SQUARE = 0.05  # slope dR/dz at an end up to which its edge counts as square: 3 degrees


def free_ends(mesh: Mesh, name: str, shape: Any, grid: SurfaceGrid, edge: float) -> tuple[list[FreeEnd], list[str]]:
    """The square ends of the contact surface, and notes on other edges. `edge`: longest facet edge [m]."""
    own = np.zeros(len(mesh.points), dtype=bool)
    own[mesh.facets(name).node_set] = True
    reach = ON_SURFACE * edge
    found: list[FreeEnd] = []
    notes: list[str] = []
    sides = ((grid.z[0], -1), (grid.z[-1], 1))
    at = {side: np.zeros(len(mesh.points), dtype=bool) for _, side in sides}
    nodes = np.flatnonzero(own)
    _, z, _ = shape.chart(mesh.points[nodes])
    for end, side in sides:
        at[side][nodes[np.abs(z - end) < reach]] = True
    beside: dict[int, list[Array]] = {-1: [], 1: []}
    for kind, faces in mesh.outer_facets().blocks.items():
        corners = faces[:, : facet_kind(kind).corner_count]
        others = ~own[corners].all(axis=1)
        for side, nodes_here in at.items():
            touching = corners[others & (nodes_here[corners].sum(axis=1) >= 2)]
            beside[side] += list(touching)
    for end, side in sides:
        if not beside[side]:
            continue
        touching = np.unique(np.concatenate(beside[side]))
        _, _, distance = shape.chart(mesh.points[touching])
        if (
            np.all(np.abs(along_axis(shape, mesh.points[touching]) - end) < reach)
            and abs(float(shape.slope_at(end))) <= SQUARE
        ):
            found.append(FreeEnd(float(end), side))
        elif np.max(np.abs(distance)) >= reach:
            where = "lower" if side < 0 else "upper"
            notes.append(
                f"contact {name!r}: the edge at its {where} end, z = {end:.4g} m, is no right angle between the "
                "surface and a plane face; within about a spacing of the grid from it a contact-fixed grid is less "
                "accurate"
            )
    return found, notes


def along_axis(shape: Any, points: Array) -> Array:
    """z [m] of `points` (n, 3) [m], user frame, along the axis."""
    return (points - shape.axis_point) @ shape.e_a


def on_end(shape: Any, points: Array, end: FreeEnd, edge: float) -> Array:
    """Which of `points` (n, 3) [m] lie on the plane of the end face (n,)."""
    return np.abs(along_axis(shape, points) - end.z) < ON_SURFACE * edge
