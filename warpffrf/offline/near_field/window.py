r"""The response of the half-space to loads on a contact surface, as the body's own elements see it.

Around a few neighbouring functions of the contact grid the cells of the body are laid flat (`charts`): a piece of a
half-space with the mesh of the body. Its surface carries the consistent loads f_j of the functions, on its cut faces
the displacement is that of the exact half-space under the same loads,

    K v_j = f_j,     v_j = half-space on cut faces,     T_ij = f_i^T v_j,

so that T is the half-space's compliance with the error that this mesh makes near a load. The compliance C of the whole
body has the same error there, and C - T is smooth however coarse the mesh is. Faces on the surface beside the contact
facets are free, and so is an end face of the body, where the half-space is a quarter space (`ends`).

Cells that do not bear being laid flat are left out: those with nodes near the centre of curvature, or too far round the
body. On a mesh of a few cells on the radius only those in the outer layer are left.

Normal loads and displacements are outward. The loads are those of the body, without the turning of the directions over
a facet: f_a = int N_a psi_j dA on the flat surface.

Under tangential loads the end face is a mirror, as the half-space with an image of the load has it there (`exact`):
under a load along s and its image nothing moves along t, under one along t and its image something moves along t only.
A free face with cut faces that move with half-space and image would be two fields at once: the compliance along t of a
hollow roller then differed from 2 to 4 mm cells by 3 % of what a patch of 0.6 x 8 mm does itself, and by 9 % at 4 mm
from an end.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from warpffrf.model.material import Material
from warpffrf.model.mesh.checks import FLAT_CELL, jacobian_range
from warpffrf.model.mesh.elements import cell_kind, facet_kind
from warpffrf.model.mesh.facets import FacetSet, outer_faces, row_numbers
from warpffrf.offline.fe.assembly import Sparse, assemble
from warpffrf.offline.fe.materials import Assignment
from warpffrf.offline.near_field.charts import FlatChart
from warpffrf.offline.near_field.exact import OUTWARD, EndField, PointLoads, half_space_at
from warpffrf.offline.solvers import factorise

Array = np.ndarray
MIRRORED = ((1,), (0, 2), ())  # what an end face holds under a load along s, along t and outwards: components
DEEPEST = 0.8  # of the smaller radius of curvature: a cell laid flat there is five times as wide as it was


@dataclass(frozen=True, eq=False)
class FlatLoads:
    """Nodal `forces` (n, m) [-] in one `direction` (0 along s, 1 along t, 2 outwards), and the same loads as the
    half-space sees them: `points`, at these other forces `at_points` (sets, m / sets, points) where given."""

    forces: Sparse
    points: PointLoads
    direction: int = OUTWARD
    at_points: Array | None = None


@dataclass(frozen=True, eq=False)
class FlatCells:
    """Cells laid flat: `points` (n, 3) [m] in (s, t, -y), their numbers `of_body` (n,) in the body, `cells` {kind:
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
        `ends`: of each end face which `points` lie on it (n,), and the t [m] at which it stands upright."""
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
        bears[used] = chart.before(points[used]) & (y < DEEPEST * chart.smallest_radius)
        kept = {}
        for kind, found in numbers.items():
            upright, cube = jacobian_range(places, kind, cells[kind][found], cell_kind(kind).nodes)
            good = found[bears[cells[kind][found]].all(axis=1) & (upright > FLAT_CELL * cube)]
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
        """u (n, 3, m) under the `force` (n, 3, m), where it is not `held` (n, 3)."""
        free, fixed = np.flatnonzero(~held), np.flatnonzero(held)
        K_free: Any = K[free]
        v = u.reshape(-1, u.shape[2])
        right = force.reshape(v.shape)[free] - K_free[:, fixed] @ v[fixed]
        coordinates = np.repeat(self.points, 3, axis=0)[free]
        v[free] = factorise(K_free[:, free], coordinates=coordinates).solve(right)
        return v.reshape(u.shape)


def _corners(kind: str, nodes: Array) -> Array:
    corners = np.sort(nodes[:, : facet_kind(kind).corner_count], axis=1)
    return np.pad(corners, ((0, 0), (0, 4 - corners.shape[1])), constant_values=-1)
