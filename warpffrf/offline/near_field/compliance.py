r"""The half-space's part of the compliance of a surface, by functions of its contact grid.

T_ij is the mean outward displacement over function i under function j, both of unit force. For functions within
reach of one another it is computed on a flat window of the body's own mesh (`window`), for others it is the exact
half-space's mean between them. Both are multiplied by the `cutoff` of the angle between outward normals. In nodal
coefficients, as `ContactSurface.lags`, the near compliance is

    N = M^-1 diag(a) T diag(a) M^-1,      a_i = int psi_i dA,

and lags - N is the far compliance: smooth, and free of the mesh's error near a load.

Tangential tractions are constant on cells, with the displacement d under a force d', each around (0) or along the
meridian (1): T_tt,id,jd' is the mean over the cell i under a unit force on the cell j, and T_tn,id,j the mean of the
tangential displacement over the cell i under a unit force on the node j. The coefficients of cells are means for
displacements and forces for loads, so that

    N_tt = T_tt,      N_nt = M^-1 diag(a) T_tn^T,

the latter by Maxwell and Betti. On a curved surface T_tn accounts for the different tangents at i and j (`exact`), by
the distance of each point of the one function from each of the other. With the centre c of the node j

    <(x - x') v_n>_ij = <(x - c) v_n>_i under the node j - <v_n>_i under the node j times (x' - c),

which needs, on a surface curved in one direction, one more load per node. With distances from the centre of the node,
without that load, the strain under a patch of 0.6 x 8 mm on a roller of 50 mm is in error by 0.2 % of the half-space's,
on every mesh; without any rotation of tangents, by 2 to 4 %, depending on the mesh.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
import scipy.sparse as sp

from warpffrf.model.errors import InputError
from warpffrf.model.half_space import transposed
from warpffrf.model.material import Material
from warpffrf.model.mesh.elements import facet_kind
from warpffrf.model.reduced.contact_grid import SurfaceGrid
from warpffrf.model.reduced.far_field import NOTHING, FreeEnd, cutoff
from warpffrf.offline.contact.contact_grid import GridPlan
from warpffrf.offline.fe import Assignment
from warpffrf.offline.general.checkpoint import Checkpoint
from warpffrf.offline.near_field.half_space import EndField, coupled_mean, mean_between, tangential_mean
from warpffrf.offline.near_field.window import (
    ON_SURFACE,
    FlatCells,
    FlatChart,
    FlatLoads,
    NearFunctions,
    SpreadFunctions,
    on_end,
    sharpest,
)
from warpffrf.offline.progress import Progress

Array = np.ndarray
Blocks = dict[str, Array]  # T by its functions: "nn", and with tangential tractions "tt" (2, 2, ...) and "tn" (2, ...)
# From the loads to the cut faces, along the surface in spacings of the grid or facet edges, whichever are longer, and
# below it in facet edges: 2 costs 0.3 % of a force, 4 gains 0.05 %.
REACH = 3.0
# Under tangential tractions on linear cells it does not decrease with the mesh below SAME_REACH radii, up to this many
# spacings, where windows are few. The cut faces move as the exact half-space; the mesh n spacings h from a load P per
# width does not quite, which causes a strain under the patch proportional to P/(E h) (n + 1)^-2.5. It affects the
# rolling of dissimilar bodies: at 3 spacings by 0.5 % of their creepage on cells of 0.02 R, by 1 % on cells of 0.012 R,
# a/R = 0.0064 (docs/studies/rolling_patches.md). The error of quadratic cells is a tenth of that.
SAME_REACH, FARTHEST_REACH, FEW_WINDOWS = 0.24, 12.0, 16
COVERED = 0.02  # relative area at which a function counts as inside a window: the error of a kinked quadrature
CLUSTER = 48  # functions per window, at most
WIDEST = 0.25  # of the smaller radius of curvature: half the width of a cluster; with NOTHING below 90 degrees


@dataclass(frozen=True, eq=False)
class NearTangential:
    """N_tt and N_nt [m/N] in the layouts of `Tangential`, and the largest |T_tt,ij - T_tt,ji| of forces along the
    displacement over the largest of these T_tt: between the directions images at the ends are not symmetric (`exact`),
    but do not contribute to the mean, which is used."""

    lags_tt: Array
    lags_nt: Array
    asymmetry: float


@dataclass(frozen=True, eq=False)
class NearCompliance:
    """`lags` [m/N] in the layout of the surface's own, and their accuracy and cost: the largest |T_ij - T_ji| over the
    largest T, the number of windows solved, the largest number of dofs of one."""

    lags: Array
    asymmetry: float
    windows: int
    largest: int
    tangential: NearTangential | None = None


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
    """N of the nodes, and of the cells if there are any, `sectors` and columns per sector as in the surface's lags.
    `quarter`: the `QuarterSpace` of the material, None without `ends`; `checkpoint` stores the windows.
    Raises `InputError` if other materials lie under the surface."""
    f, g = functions, functions.grid
    c, rows = g.columns_per_sector, g.rows
    total = sectors * c  # columns that lags distinguish
    first = 0
    if sectors > 1 and not g.periodic:  # an arc: a sector in its middle, with facets on both sides
        first = (g.columns // 2) // c * c
    blocks = {"nn": ()} if f.cells is None else {"nn": (), "tt": (2, 2), "tn": (2,)}
    T = {block: np.zeros((*directions, total, rows, c, rows)) for block, directions in blocks.items()}
    largest = 0
    clusters = _clusters(f, c, first, ends)
    reach = _reach(f, len(clusters))
    for i in progress.track(range(len(clusters)), f"half-space of {f.name}"):
        columns, of_rows = clusters[i]
        key = f"half-space of {f.name}, window {i} of {len(clusters)}"
        found = checkpoint.get(key)
        if found is None:
            window = _Window(f, columns, of_rows, material, assignment, ends, quarter, reach)
            at, means = window.means(total)
            found = {"at": at, **means, "dofs": np.array(3 * window.nodes)}
            checkpoint.put(key, found)
        place = np.ix_((found["at"] - first) % total, np.arange(rows), columns - first, of_rows)
        for block, whole in T.items():
            whole[(..., *place)] = found[block]
        largest = max(largest, int(found["dofs"]))
    size = c * rows
    known = _known(g, sectors, first)
    lags, asymmetry = _symmetric(T["nn"].reshape(sectors, size, size), known)
    area = np.tile(f.grid_nodes.area, c)
    forces = lags * area[:, None] * area
    tangential = None
    if f.cells is not None:
        by_sector = T["tt"].reshape(2, 2, sectors, size, size).transpose(2, 0, 3, 1, 4)
        lags_tt, _ = _symmetric(by_sector.reshape(sectors, 2 * size, 2 * size), known)
        asymmetry_tt = max(_symmetric(T["tt"][d, d].reshape(sectors, size, size), known)[1] for d in (0, 1))
        lags_tn = T["tn"].reshape(2, sectors, size, size).transpose(1, 0, 2, 3).reshape(sectors, 2 * size, size)
        lags_nt = _targets_without_gram(g, f.shape, transposed(lags_tn) * area[:, None])
        tangential = NearTangential(lags_tt, lags_nt, asymmetry_tt)
    return NearCompliance(_without_gram(g, f.shape, forces), asymmetry, len(clusters), largest, tangential)


def _symmetric(lags: Array, known: Array) -> tuple[Array, float]:
    """Mean of `lags` and of those of the transposed operator, and their largest difference at `known` lags over the
    largest entry."""
    mirrored = transposed(lags)
    return 0.5 * (lags + mirrored), float(np.max(np.abs(lags - mirrored)[known]) / np.max(np.abs(lags)))


def _known(g: SurfaceGrid, sectors: int, first: int) -> Array:
    """Lags (sectors,) bool for which columns of the surface lie on either side of the sector starting at column
    `first`: all of a revolution, and of an arc up to half of it."""
    if sectors == 1 or g.periodic:
        return np.ones(sectors, dtype=bool)
    c, lag = g.columns_per_sector, np.arange(sectors)
    beside = min(first, g.columns - first - c)
    return np.minimum(lag, sectors - lag) * c <= beside


def _reach(f: NearFunctions, windows: int) -> float:
    """From the loads to the cut faces, in spacings of the grid along the surface, in facet edges below it."""
    curvature = max(sharpest(f.shape, f.grid))
    linear = all(facet_kind(kind).degree == 1 for kind in f.surface.blocks)
    if f.cells is None or not linear or curvature == 0.0 or windows > FEW_WINDOWS:
        return REACH
    return float(np.clip(SAME_REACH / (curvature * f.spacing), REACH, FARTHEST_REACH))


def _clusters(f: NearFunctions, c: int, first: int, ends: list[FreeEnd]) -> list[tuple[Array, Array]]:
    """Columns and rows of the functions that share a window; none has rows nearer to either end."""
    g = f.grid
    around, along = sharpest(f.shape, g)
    width = np.inf if around == 0.0 else 2.0 * WIDEST / around
    height = np.inf if along == 0.0 else 2.0 * WIDEST / along
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
        reach: float,
    ) -> None:
        self.f, self.columns, self.rows, self.material = f, columns, rows, material
        g = f.grid
        theta = g.theta_start + g.pitch * 0.5 * (columns[0] + columns[-1])
        self.chart = FlatChart(f.shape, float(theta), float(0.5 * (g.z[rows[0]] + g.z[rows[-1]])))
        self.loads = f.grid_nodes.point_loads(self.chart, columns, rows)
        self.tolerance = ON_SURFACE * f.edge
        self.ends = [self._end(end, quarter) for end in ends]
        faces = [on_end(f.shape, f.mesh.points, end, f.edge) for end in ends]
        self.reach = reach
        self.flat = self._laid_flat(faces)
        if reach > REACH and not _of_one_material(self.flat, material, assignment):
            self.reach = REACH
            self.flat = self._laid_flat(faces)
        if not self.flat.cells:
            raise _too_large(f)
        if not _of_one_material(self.flat, material, assignment):
            raise _other_material(f)
        self.nodes = len(self.flat.points)
        near = [e for e in self.ends if self.flat.reaches(e, self.tolerance)]
        middle = float(np.mean(self.loads.t))
        self.free = min(near, key=lambda e: e.inward(np.asarray(middle)), default=None)

    def _laid_flat(self, faces: list[Array]) -> FlatCells:
        """The cells of the window; `faces`: which points lie on each end."""
        f = self.f
        return FlatCells.around(
            f.mesh.points,
            f.mesh.cells,
            self.chart,
            self.loads.box,
            self.reach * f.spacing,
            self.reach * f.edge,
            max(self.tolerance, _deviation(f.shape)),
            [(face, end.t) for face, end in zip(faces, self.ends, strict=True)],
        )

    @cached_property
    def curvatures(self) -> tuple[float, float]:
        """Principal curvatures [1/m] along s and t in the middle."""
        around, along = self.f.shape.curvatures(self.chart.theta, self.chart.z)
        return float(around), float(along)

    def _end(self, end: FreeEnd, quarter: Any) -> EndField:
        _, t = self.chart.on_surface(np.asarray(self.chart.theta), np.asarray(end.z))
        return EndField(float(t), end.side, quarter)

    def means(self, total: int) -> tuple[Array, Blocks]:
        """Columns (k,) with something other than zero, and T (..., k, rows, columns, rows of the cluster)."""
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
        place = {int(j): i for i, j in enumerate(near)}
        sources = f.shape.normal((g.theta_start + g.pitch * self.columns)[:, None], g.z[self.rows][None, :])
        c = cutoff(np.einsum("jkx,abx->jkab", normals, sources))
        found: Blocks = {}
        for block, target, source in f.blocks:
            pairs = self._between(candidates, target, source)
            T = self._exact(block, pairs)
            for i, j in enumerate(candidates):
                k = place.get(int(j))
                if k is not None:
                    here = inside[target.grid.kind][k]
                    T[..., i, here, :, :] = solved[block][..., k, here, :, :]
            found[block] = (T + self._other_ends(block, pairs)) * c
        return candidates, found

    def _solved(self, total: int) -> tuple[Array, Blocks, Blocks]:
        """Columns (k,), which functions of each kind lie inside the window (k, rows), and T (..., k, rows, columns,
        rows of the cluster) of these by finite elements."""
        f, g = self.f, self.f.grid
        here = self.flat.carriers(f.surface)
        low, high = int(self.columns[0]), int(self.columns[-1])
        pitch = g.pitch * float(np.min(f.shape.radius_at(g.z)))
        margin = int(np.ceil((self.reach * f.spacing + 2.0 * f.edge) / pitch)) + 2
        if g.periodic or total > g.columns:  # no column twice
            margin = min(margin, (total - 1 - (high - low)) // 2)
        columns = np.arange(low - margin, high + margin + 1)
        only = not (g.periodic or total > g.columns)
        grid_nodes = self._nodal(f.grid_nodes, here, columns, only)
        own = ((self.columns - columns[0])[:, None] * g.rows + self.rows).ravel()
        unit = grid_nodes.unit[:, own]
        inside = {"nodes": grid_nodes.inside}
        shape = (len(columns), g.rows, len(self.columns), len(self.rows))
        if f.cells is None:
            (v,) = self._answer([FlatLoads(unit, self.loads)])
            return columns, inside, {"nn": np.asarray(grid_nodes.unit.T @ v[:, 2]).reshape(shape)}

        cells = self._nodal(f.cells, here, columns, only)
        inside["cells"] = cells.inside
        curved = [d for d in (0, 1) if self.curvatures[d] != 0.0]
        centre = [np.asarray(m.sum(axis=0)).ravel()[own] for m in grid_nodes.moments]
        dipoles = [grid_nodes.moments[d][:, own] - unit @ sp.diags(centre[d]) for d in curved]
        spread = self.loads.force
        means = self.loads.moments()
        off = [spread * ((self.loads.s, self.loads.t)[d] - means[d][:, None]) for d in curved]
        cell_loads = f.cells.point_loads(self.chart, self.columns, self.rows)
        normal, *tangential = self._answer(
            [
                FlatLoads(sp.csr_matrix(sp.hstack([unit, *dipoles])), self.loads, at_points=np.stack([spread, *off])),
                *(FlatLoads(cells.unit[:, own], cell_loads, d) for d in (0, 1)),
            ]
        )
        m = len(own)
        v = normal[:, :, :m]
        T_tn = np.stack([cells.unit.T @ v[:, d] for d in (0, 1)])
        for number, d in enumerate(curved):
            dipole = normal[:, 2, (number + 1) * m : (number + 2) * m]
            turned = cells.moments[d].T @ v[:, 2] - cells.unit.T @ (v[:, 2] * centre[d] + dipole)
            T_tn[d] -= self.curvatures[d] * turned
        T_tt = np.stack([[cells.unit.T @ tangential[load][:, d] for load in (0, 1)] for d in (0, 1)])
        T_nn = np.asarray(grid_nodes.unit.T @ v[:, 2])
        solved = {"nn": T_nn, "tt": T_tt, "tn": T_tn}
        return columns, inside, {block: T.reshape(*T.shape[:-2], *shape) for block, T in solved.items()}

    def _answer(self, loads: list[FlatLoads]) -> list[Array]:
        return self.flat.solve(loads, self.material, self.free, self.tolerance)

    def _nodal(self, functions: SpreadFunctions, here: Array, columns: Array, only: bool) -> _Nodal:
        """The functions of `columns` on the facets `here` (m,); `only`: no functions beyond the grid's own exist."""
        f, g = self.f, self.f.grid
        plan = GridPlan(g.theta_start + g.pitch * columns[0], g.pitch, len(columns), False, g.z, False)
        entries = f.facets.part(here).loads(plan, functions.grid.kind, self._place)
        node = np.searchsorted(self.flat.of_body, entries.node)
        function = entries.column * g.rows + entries.row

        def matrix(values: Array) -> Any:
            return sp.csc_matrix((values, (node, function)), shape=(self.nodes, len(columns) * g.rows))

        loads = matrix(entries.area)
        area = np.asarray(loads.sum(axis=0)).ravel().reshape(len(columns), g.rows)
        inside = np.abs(area / functions.area - 1.0) < COVERED
        inside[[0, -1]] = False  # the part beyond the plan is assigned to its edges
        if only:
            inside &= ((columns >= 0) & (columns < g.columns))[:, None]
        if not inside[np.ix_(self.columns - columns[0], self.rows)].all():
            raise _too_large(f)
        scale = sp.diags(1.0 / np.where(area > 0.0, area, 1.0).ravel())
        return _Nodal(loads @ scale, [matrix(entries.value[:, d]) @ scale for d in (0, 1)], inside)

    def _place(self, theta: Array, z: Array) -> Array:
        """(s, t, 0) (..., 3) [m] of points of the surface."""
        s, t = self.chart.on_surface(theta, z)
        return np.stack([s, t, np.zeros_like(s)], axis=-1)

    def _exact(self, block: str, pairs: _Pairs) -> Array:
        """T (..., k, rows, columns, rows of the cluster) of the half-space, or of the quarter space of the free end;
        not finite between functions inside the window."""
        s, t, moments = pairs.s, pairs.t - pairs.at, pairs.moments
        nu = self.material.poisson_ratio
        if block == "nn":
            same = (s == 0.0) & (t == 0.0)
            u = np.where(same, 0.0, mean_between(np.where(same, 1.0, s), t, moments, nu))
        else:
            with np.errstate(divide="ignore", invalid="ignore"):
                if block == "tt":
                    u = tangential_mean(s, t, moments, nu)
                else:
                    u = coupled_mean(s, t, moments, self.curvatures, nu)
        if self.free is not None:
            u = u + self._end_mean(self.free, block, pairs)
        return u / self.material.youngs_modulus

    def _other_ends(self, block: str, pairs: _Pairs) -> Any:
        """Contribution of the ends that are not free in the window."""
        added = sum(self._end_mean(end, block, pairs) for end in self.ends if end is not self.free)
        return added / self.material.youngs_modulus

    def _end_mean(self, end: EndField, block: str, pairs: _Pairs) -> Array:
        where, nu = (pairs.s, pairs.t, pairs.at, pairs.moments), self.material.poisson_ratio
        if block == "nn":
            return end.mean(*where, nu)
        return end.tangential_mean(*where, nu) if block == "tt" else end.coupled_mean(*where, self.curvatures, nu)

    def _between(self, columns: Array, target: SpreadFunctions, source: SpreadFunctions) -> _Pairs:
        """The functions `target` of `columns` and the functions `source` of the cluster."""
        rows = self.f.grid.rows
        everywhere = target.point_loads(self.chart, columns, np.arange(rows)).moments()
        own = source.point_loads(self.chart, self.columns, self.rows).moments()
        targets = [v.reshape(len(columns), rows, 1, 1) for v in everywhere]
        sources = [v.reshape(1, 1, len(self.columns), len(self.rows)) for v in own]
        shape = np.broadcast_shapes(targets[0].shape, sources[0].shape)
        t, at = np.broadcast_to(targets[1], shape), np.broadcast_to(sources[1], shape)
        return _Pairs(targets[0] - sources[0], t, at, (targets[2] + sources[2], targets[3] + sources[3]))


@dataclass(frozen=True, eq=False)
class _Pairs:
    """Distance s [m] of targets from sources, t [m] of the targets, t of the sources `at` [m], and sums of variances
    [m^2], each (k, rows, columns, rows of the cluster)."""

    s: Array
    t: Array
    at: Array
    moments: tuple[Array, Array]


@dataclass(frozen=True, eq=False)
class _Nodal:
    """Functions of one kind as consistent nodal forces: `unit` (nodes, functions) of sum 1, their first `moments` along
    s and t [m], and which lie `inside` the window (columns, rows)."""

    unit: Any
    moments: list[Any]
    inside: Array


def _deviation(shape: Any) -> float:
    return 2.0 * float(shape.deviation or 0.0)


def _too_large(f: NearFunctions) -> InputError:
    return InputError(
        f"its facets ({f.edge:.3g} m) are too large compared with the radius of the surface to be treated as plane; "
        "use three or more cells on the radius"
    )


def _of_one_material(flat: FlatCells, material: Material, assignment: Assignment) -> bool:
    wanted = {i for i, m in enumerate(assignment.materials) if m == material}
    return all(
        set(np.unique(assignment.of_cell[kind][numbers]).tolist()) <= wanted for kind, numbers in flat.numbers.items()
    )


def _other_material(f: NearFunctions) -> InputError:
    return InputError(
        f"contact {f.name!r}: cells of another material lie within {REACH:g} facet edges "
        f"({REACH * f.edge:.3g} m) of the surface; a contact-fixed grid needs one material there: use a mesh that is "
        'finer at the surface than the layer is thick, or grid="body_fixed"'
    )


def _without_gram(g: SurfaceGrid, shape: Any, lags: Array) -> Array:
    """M^-1 `lags` M^-1 by distance in sectors."""
    half = _targets_without_gram(g, shape, lags)
    return np.ascontiguousarray(transposed(_targets_without_gram(g, shape, transposed(half))))


def _targets_without_gram(g: SurfaceGrid, shape: Any, lags: Array) -> Array:
    sectors, rows = len(lags), g.rows
    total = sectors * g.columns_per_sector
    values = lags.reshape(total, rows, -1)
    if sectors > 1:  # columns close around the full revolution, of which an arc is a part
        gram = np.zeros(total)
        gram[[0, 1, -1]] = g.pitch * np.array([2.0 / 3.0, 1.0 / 6.0, 1.0 / 6.0])
        spectrum = np.fft.rfft(gram)[:, None, None]
        values = np.fft.irfft(np.fft.rfft(values, axis=0) / spectrum, n=total, axis=0)
    else:
        values = np.linalg.solve(g.gram_theta(), values.reshape(total, -1)).reshape(values.shape)
    values = np.linalg.solve(g.gram_z(shape)[None], values)
    return values.reshape(lags.shape)
