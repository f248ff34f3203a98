r"""The half-space's part of a surface's compliance, function by function of its contact grid.

T_ij is the mean outward displacement under the function i by the one of j, both of unit force. Of functions within
reach of one another it comes from a flat window of the body's own mesh (`window`), of others it is the exact
half-space's mean between them. Both are multiplied by the `cutoff` of the angle between outward normals. In
coefficients of hats, as `ContactSurface.lags`, the near compliance is

    N = M^-1 diag(a) T diag(a) M^-1,      a_i = int psi_i dA,

and lags - N is the far compliance: smooth, and free of the mesh's error near a load.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import scipy.sparse as sp

from warpffrf.model.contact_grid import ContactGrid
from warpffrf.model.errors import InputError
from warpffrf.model.far_field import NOTHING, FreeEnd, cutoff
from warpffrf.model.material import Material
from warpffrf.model.mesh import Mesh
from warpffrf.offline.contact.contact_grid import GridPlan
from warpffrf.offline.contact.traction_fields import ContactFacets
from warpffrf.offline.fe.materials import Assignment
from warpffrf.offline.general.checkpoint import Checkpoint
from warpffrf.offline.near_field.charts import FlatChart
from warpffrf.offline.near_field.ends import ON_SURFACE, on_end
from warpffrf.offline.near_field.exact import EndField, PointLoads
from warpffrf.offline.near_field.half_space import mean_between
from warpffrf.offline.near_field.window import FlatCells
from warpffrf.offline.progress import Progress

Array = np.ndarray
# From the loads to the cut faces, along the surface in spacings of the grid or facet edges, whichever are longer, and
# below it in facet edges: 2 costs 0.3 % of a force, 4 gains 0.05 %.
REACH = 3.0
GAUSS = 3  # points a grid interval and direction, of loads as the cut faces see them: those are REACH away
COVERED = 0.02  # a function counts as inside a window when its area is there to this, the error of a kinked quadrature
CLUSTER = 48  # functions that share a window, at most
WIDEST = 0.25  # of the smaller radius of curvature: half the width of a cluster; with NOTHING below a quarter of a turn


class NearFunctions:
    """The hats of a contact `grid` on the facets of set `name`: where they stand, and their loads."""

    def __init__(self, mesh: Mesh, name: str, shape: Any, grid: ContactGrid) -> None:
        self.mesh, self.shape, self.grid, self.name = mesh, shape, grid, name
        self.surface = mesh.facets(name)
        self.facets = ContactFacets.of(mesh.points, self.surface, shape)
        self.edge = self.facets.chart.edge
        around = grid.pitch * float(np.max(shape.radius_at(grid.z)))
        self.spacing = max(self.edge, around, float(np.max(np.diff(grid.z))))  # [m]
        x, w = np.polynomial.legendre.leggauss(GAUSS)
        x, w = 0.5 * (x + 1.0), 0.5 * w
        rows = grid.rows
        step = np.diff(grid.z)
        up = grid.z[:-1, None] + step[:, None] * x
        measure = w * step[:, None] * shape.measure_at(up)
        self._z = np.repeat(grid.z[:, None], 2 * GAUSS, axis=1)
        self._z_weight = np.zeros((rows, 2 * GAUSS))
        self._z[:-1, GAUSS:], self._z_weight[:-1, GAUSS:] = up, measure * (1.0 - x)
        self._z[1:, :GAUSS], self._z_weight[1:, :GAUSS] = up, measure * x
        self.area = grid.pitch * grid.gram_z(shape).sum(axis=1)  # (rows,) [m^2] of the functions of a column
        self._z_weight /= self._z_weight.sum(axis=1)[:, None]
        self._turn = grid.pitch * np.concatenate([x - 1.0, x])
        self._turn_weight = np.concatenate([w * x, w * (1.0 - x)])

    def point_loads(self, chart: FlatChart, columns: Array, rows: Array) -> PointLoads:
        """Functions of `columns` x `rows` (row fastest) as unit forces at points of the chart."""
        g = self.grid
        shape = (len(columns), len(rows), len(self._turn), self._z.shape[1])
        theta = (g.theta_start + g.pitch * columns)[:, None, None, None] + self._turn[:, None]
        z = self._z[rows][:, None, :]
        s, t = chart.on_surface(np.broadcast_to(theta, shape), np.broadcast_to(z, shape))
        force = np.broadcast_to(self._turn_weight[:, None] * self._z_weight[rows][:, None, :], shape)
        return PointLoads(*(np.ascontiguousarray(v).reshape(len(columns) * len(rows), -1) for v in (s, t, force)))


@dataclass(frozen=True, eq=False)
class NearCompliance:
    """`lags` [m/N] in the layout of the surface's own, and how it came about: the largest |T_ij - T_ji| over the
    largest T, the windows that were solved, the largest number of dofs of one."""

    lags: Array
    asymmetry: float
    windows: int
    largest: int


def near_compliance(
    functions: NearFunctions,
    sectors: int,
    material: Material,
    assignment: Assignment,
    ends: list[FreeEnd],
    quarter: Any,
    checkpoint: Checkpoint,
    progress: Progress,
) -> NearCompliance:
    """N of the hats, `sectors` and columns a sector as the surface's lags have them. `quarter`: the `QuarterSpace` of
    the material, None without `ends`; `checkpoint` keeps the windows. Raises `InputError` where other materials lie
    under the surface."""
    f, g = functions, functions.grid
    c, rows = g.columns_per_sector, g.rows
    total = sectors * c  # columns that lags tell apart
    first = 0
    if sectors > 1 and not g.periodic:  # an arc: a sector in its middle, to either side of which there are facets
        first = (g.columns // 2) // c * c
    T = np.zeros((total, rows, c, rows))
    largest = 0
    clusters = _clusters(f, c, first, ends)
    for i in progress.track(range(len(clusters)), f"half-space of {f.name}"):
        columns, of_rows = clusters[i]
        key = f"half-space of {f.name}, window {i} of {len(clusters)}"
        found = checkpoint.get(key)
        if found is None:
            window = _Window(f, columns, of_rows, material, assignment, ends, quarter)
            at, means = window.means(total)
            found = {"at": at, "means": means, "dofs": np.array(3 * window.nodes)}
            checkpoint.put(key, found)
        T[np.ix_((found["at"] - first) % total, np.arange(rows), columns - first, of_rows)] = found["means"]
        largest = max(largest, int(found["dofs"]))
    lags = T.reshape(sectors, c * rows, c * rows)
    mirrored = np.roll(lags[::-1], 1, axis=0).transpose(0, 2, 1)
    asymmetry = float(np.max(np.abs(lags - mirrored)) / np.max(np.abs(lags)))
    area = np.tile(f.area, c)
    forces = 0.5 * (lags + mirrored) * area[:, None] * area
    return NearCompliance(_without_gram(g, f.shape, forces), asymmetry, len(clusters), largest)


def _clusters(f: NearFunctions, c: int, first: int, ends: list[FreeEnd]) -> list[tuple[Array, Array]]:
    """Columns and rows of the functions that share a window; none has rows nearer to the one end and to the other."""
    g = f.grid
    around, along = f.shape.curvatures(g.theta_start, float(np.mean(g.z)))
    width = np.inf if around == 0.0 else 2.0 * WIDEST / abs(float(around))
    height = np.inf if along == 0.0 else 2.0 * WIDEST / abs(float(along))
    halves = [np.arange(g.rows)]
    if len(ends) > 1:
        upper = g.z > 0.5 * (ends[0].z + ends[1].z)
        halves = [np.flatnonzero(~upper), np.flatnonzero(upper)]
    row_parts: list[Array] = []
    for half in halves:
        pieces = max(1, int(np.ceil(np.ptp(g.z[half]) / height)), int(np.ceil(len(half) / CLUSTER)))
        row_parts += [p for p in np.array_split(half, pieces) if len(p)]
    most = max(len(p) for p in row_parts)
    pitch = g.pitch * float(np.max(f.shape.radius_at(g.z)))
    fit = max(1, int(min(CLUSTER // most, width / pitch)))
    columns = np.array_split(first + np.arange(c), int(np.ceil(c / fit)))
    return [(j, k) for j in columns for k in row_parts]


class _Window:
    """The functions of `columns` x `rows` on a flat window of the mesh."""

    def __init__(
        self,
        f: NearFunctions,
        columns: Array,
        rows: Array,
        material: Material,
        assignment: Assignment,
        ends: list[FreeEnd],
        quarter: Any,
    ) -> None:
        self.f, self.columns, self.rows, self.material = f, columns, rows, material
        g = f.grid
        theta = g.theta_start + g.pitch * 0.5 * (columns[0] + columns[-1])
        self.chart = FlatChart(f.shape, float(theta), float(0.5 * (g.z[rows[0]] + g.z[rows[-1]])))
        self.loads = f.point_loads(self.chart, columns, rows)
        self.tolerance = ON_SURFACE * f.edge
        self.ends = [self._end(end, quarter) for end in ends]
        faces = [on_end(f.shape, f.mesh.points, end, f.edge) for end in ends]
        self.flat = FlatCells.around(
            f.mesh.points,
            f.mesh.cells,
            self.chart,
            self.loads.box,
            REACH * f.spacing,
            REACH * f.edge,
            max(self.tolerance, _deviation(f.shape)),
            [(face, end.t) for face, end in zip(faces, self.ends, strict=True)],
        )
        if not self.flat.cells:
            raise _too_large(f)
        _require_one_material(f, self.flat, material, assignment)
        self.nodes = len(self.flat.points)
        near = [e for e in self.ends if self.flat.reaches(e, self.tolerance)]
        middle = float(np.mean(self.loads.t))
        self.free = min(near, key=lambda e: e.inward(np.asarray(middle)), default=None)

    def _end(self, end: FreeEnd, quarter: Any) -> EndField:
        _, t = self.chart.on_surface(np.asarray(self.chart.theta), np.asarray(end.z))
        return EndField(float(t), end.side, quarter)

    def means(self, total: int) -> tuple[Array, Array]:
        """Columns (k,) with something other than zero, and T (k, rows, columns, rows of the cluster)."""
        f, g = self.f, self.f.grid
        near, inside, solved = self._solved(total)
        middle = int(round(0.5 * (self.columns[0] + self.columns[-1])))
        candidates = np.arange(middle - total // 2, middle - total // 2 + total)
        if not (g.periodic or total > g.columns):
            candidates = np.arange(total)
        n_0 = f.shape.normal(self.chart.theta, self.chart.z)
        theta = g.theta_start + g.pitch * candidates
        normals = f.shape.normal(theta[:, None], g.z[None, :])
        keep = (normals @ n_0 > np.cos(NOTHING + WIDEST)).any(axis=1)
        candidates, normals = candidates[keep], normals[keep]
        T = self._exact(candidates)
        place = {int(j): i for i, j in enumerate(near)}
        for i, j in enumerate(candidates):
            k = place.get(int(j))
            if k is not None:
                T[i, inside[k]] = solved[k, inside[k]]
        T = T + self._other_ends(candidates)
        sources = f.shape.normal((g.theta_start + g.pitch * self.columns)[:, None], g.z[self.rows][None, :])
        c = cutoff(np.einsum("jkx,abx->jkab", normals, sources))
        return candidates, T * c

    def _solved(self, total: int) -> tuple[Array, Array, Array]:
        """Columns (k,), which of their functions lie inside the window (k, rows), and T of these by finite elements."""
        f, g = self.f, self.f.grid
        here = self.flat.carriers(f.surface)
        low, high = int(self.columns[0]), int(self.columns[-1])
        pitch = g.pitch * float(np.min(f.shape.radius_at(g.z)))
        margin = int(np.ceil((REACH * f.spacing + 2.0 * f.edge) / pitch)) + 2
        if g.periodic or total > g.columns:  # no column twice
            margin = min(margin, (total - 1 - (high - low)) // 2)
        columns = np.arange(low - margin, high + margin + 1)
        plan = GridPlan(g.theta_start + g.pitch * columns[0], g.pitch, len(columns), False, g.z, False)
        entries = f.facets.part(here).loads(plan, "hats", "normal")
        node = np.searchsorted(self.flat.of_body, entries.node)
        function = entries.column * g.rows + entries.row
        loads = sp.csc_matrix((entries.area, (node, function)), shape=(self.nodes, len(columns) * g.rows))
        area = np.asarray(loads.sum(axis=0)).ravel().reshape(len(columns), g.rows)
        inside = np.abs(area / f.area - 1.0) < COVERED
        inside[[0, -1]] = False  # what lies beyond the plan is counted with its edges
        if not (g.periodic or total > g.columns):
            inside &= ((columns >= 0) & (columns < g.columns))[:, None]
        unit = loads @ sp.diags(1.0 / np.where(area > 0.0, area, 1.0).ravel())
        at = self.columns - columns[0]
        if not inside[np.ix_(at, self.rows)].all():
            raise _too_large(f)
        own = (at[:, None] * g.rows + self.rows).ravel()
        v = self.flat.solve(sp.csr_matrix(unit[:, own]), self.loads, self.material, self.free, self.tolerance)
        T = np.asarray(unit.T @ v).reshape(len(columns), g.rows, len(self.columns), len(self.rows))
        return columns, inside, T

    def _exact(self, columns: Array) -> Array:
        """T (k, rows, columns, rows of the cluster) of the half-space, or of the quarter space of the free end."""
        s, t, moments, at = self._between(columns)
        nu = self.material.poisson_ratio
        same = (s == 0.0) & (t == at)
        u = mean_between(np.where(same, 1.0, s), t - at, moments, nu)
        if self.free is not None:
            u = u + self.free.mean(s, t, at, moments, nu)
        return np.where(same, 0.0, u) / self.material.youngs_modulus

    def _other_ends(self, columns: Array) -> Array:
        """What the ends add that are not free in the window."""
        s, t, moments, at = self._between(columns)
        added = np.zeros(s.shape)
        for end in self.ends:
            if end is not self.free:
                added += end.mean(s, t, at, moments, self.material.poisson_ratio)
        return added / self.material.youngs_modulus

    def _between(self, columns: Array) -> tuple[Array, Array, tuple[Array, Array], Array]:
        """Distance along s, t of the target, sums of variances, t of the load, each (k, rows, columns, rows)."""
        everywhere = self.f.point_loads(self.chart, columns, np.arange(self.f.grid.rows)).moments()
        targets = [v.reshape(len(columns), self.f.grid.rows, 1, 1) for v in everywhere]
        sources = [v.reshape(1, 1, len(self.columns), len(self.rows)) for v in self.loads.moments()]
        shape = np.broadcast_shapes(targets[0].shape, sources[0].shape)
        s = targets[0] - sources[0]
        t, at = np.broadcast_to(targets[1], shape), np.broadcast_to(sources[1], shape)
        return s, t, (targets[2] + sources[2], targets[3] + sources[3]), at


def _deviation(shape: Any) -> float:
    return 2.0 * float(shape.deviation or 0.0)


def _too_large(f: NearFunctions) -> InputError:
    return InputError(
        f"its facets ({f.edge:.3g} m) are too large beside the curvature of the surface to lay those around a "
        "place flat; use three or more cells on the radius"
    )


def _require_one_material(f: NearFunctions, flat: FlatCells, material: Material, assignment: Assignment) -> None:
    wanted = {i for i, m in enumerate(assignment.materials) if m == material}
    for kind, numbers in flat.numbers.items():
        if not set(np.unique(assignment.of_cell[kind][numbers]).tolist()) <= wanted:
            raise InputError(
                f"contact {f.name!r}: cells of another material lie within {REACH:g} facet edges "
                f"({REACH * f.edge:.3g} m) of the surface; a patch grid needs one material there: use a mesh that is "
                'finer at the surface than the layer is thick, or grid="material"'
            )


def _without_gram(g: ContactGrid, shape: Any, lags: Array) -> Array:
    """M^-1 `lags` M^-1 by distance in sectors."""
    half = _targets_without_gram(g, shape, lags)
    back = np.roll(half[::-1], 1, axis=0).transpose(0, 2, 1)
    back = _targets_without_gram(g, shape, back)
    return np.ascontiguousarray(np.roll(back[::-1], 1, axis=0).transpose(0, 2, 1))


def _targets_without_gram(g: ContactGrid, shape: Any, lags: Array) -> Array:
    sectors, rows = len(lags), g.rows
    total = sectors * g.columns_per_sector
    values = lags.reshape(total, rows, -1)
    if sectors > 1:  # columns close around the full turn, of which an arc is a part
        gram = np.zeros(total)
        gram[[0, 1, -1]] = g.pitch * np.array([2.0 / 3.0, 1.0 / 6.0, 1.0 / 6.0])
        spectrum = np.fft.rfft(gram)[:, None, None]
        values = np.fft.irfft(np.fft.rfft(values, axis=0) / spectrum, n=total, axis=0)
    else:
        values = np.linalg.solve(g.gram_theta(), values.reshape(total, -1)).reshape(values.shape)
    values = np.linalg.solve(g.gram_z(shape)[None], values)
    return values.reshape(lags.shape)
