r"""Choice of few sampling points with positive weights for a contact surface: `ContactGrid(sampling_error=)`.

From many candidates in a strip of the contact grid, those points are selected and weighted that integrate a training
set (`warpffrf.offline.contact.cubature`) like all points do, to a required error:

    minimise  sum over families |V_f w - t_f|^2   subject to   E w = e,   w >= 0,

V_f snapshots at the candidates, t_f the integrals by all points, E w = e the areas of the shape functions row by row:
the resultant of a constant pressure is exact for any error. Non-negative least squares (`nonnegative`) has the areas as
heavy rows, starts with the columns that pivoted QR selects first and stops at the first set for which the *worst*
family is accurate enough; then the weights of that set are computed with E w = e exact, by its null space. Empirical
cubature: J. A. Hernandez, M. A. Caicedo, A. Ferrer, Comput. Methods Appl. Mech. Engng 313, 2017; non-negative weights,
and the early stop: C. Farhat, T. Chapman, P. Avery, Int. J. Numer. Meth. Engng 102, 2015.

**Number of points.** As a strip repeats itself, a point counts twice for a node, at x and at x - 1, and samples u^2
as x (1 - x): the exact mean 1/6 is that of *one* Gauss point x = (1 - 1/sqrt 3)/2 per row of points. With two along z
per cell, a third of the 3 x 2 points of the full rule, all quadratic gaps and all products of shape functions are
integrated exactly; a larger admissible error needs fewer. The method prefers the largest immediate gain, hence pairs of
points at x = 0 and 1/2; it is run on these single points, on alternating sides, and on the two sets of `CANDIDATES`;
the smallest result counts. Points that the others can replace are removed afterwards, smallest weights first. For
errors below those of these sets, some tenths of a per cent, all points themselves are the candidates.

**Limits of few points.** Between two grids of unequal spacing every shape function has the other grid's nodes at
different positions, which one point per column samples worse than three. This error varies from node to node: it does
not affect force and approach (0.05 % at 4.5 columns per half-width) but the pressure, which varies by 4 to 7 % (L2)
about that of all points. Equal grids that roll on each other show no such difference (1e-5). The online check reports
it.

**Energy.** Weights are positive and the same on both sides of a product, so that the tangent in the nodes stays
symmetric, and the area of a shape function is exact, so that a force and its reaction stay equal. Only the distribution
of the gap over the nodes is inexact; that enters the *grid defect* of the energy ledger, like the Gauss rule's error.

Nonnegative. Non-negative least squares that may stop early: few points, positive weights.

    minimise |A c - b|^2   subject to   c >= 0

by the active-set method of Lawson and Hanson (Solving Least Squares Problems, 1974, chapter 23): the column whose
gradient `A^T (b - A c)` is largest enters, the least-squares problem of the active columns is solved, and columns
whose coefficient would fall below zero are removed. Two features are added. The columns of a `seed` enter first,
each if its gradient is positive; that saves rounds and selects one of many equal solutions. And `enough`
may stop the iteration before the minimum: each round adds about one column, so the first adequate set is a small one
(Farhat, Chapman, Avery, Int. J. Numer. Meth. Engng 102, 2015). At the end of a full run

    A^T (A c - b) = 0 where c > 0,      >= 0 where c = 0,

the conditions of a minimum (Karush, Kuhn, Tucker).

Columns are compared by their gradient over their own norm, so that scaling a column has no effect.

Training. The training set of sampling points: the integrals of a contact evaluation, for patches of all kinds.

The strip of a contact grid repeats itself, so that the weak value of a function f on the node of column j and row k is
a sum over one list of points (x, z) of the strip, each used in the two strips of the node's support,

    int psi_jk f dA = int over the strip of  psi_k(z) [ (1 - x) f(j + x, z) + x f(j - 1 + x, z) ] dA:

the integrand of the bracket, at the points, is a *snapshot*; it requires no simulation. Families of snapshots:

    areas      f = 1, which must be exact: a constant pressure has its resultant, and the weights add up to the area
    stress     f = psi_jl, the shape functions: products of two of them, the overlap of the grid with itself
    gaps       f = u^2/a^2 + v^2/b^2 - 1 inside the ellipse f < 0: the undeformed gap of a patch
    response   f = u_n, the displacement of the body's local modes under the pressure sqrt(1 - u^2/a^2 - v^2/b^2) of
               that patch, interpolated on a grid that is displaced by a part of a column and of a row, the one opposite
    modes      f = the displacement of a global mode

with u, v along the axes of the patch. Semi-axes a, b, position, skew and the position of the opposite grid follow a
low-discrepancy sequence (Halton), the same each time. Every family is scaled to size one.

The targets are the integrals by *all* points, the Gauss points of quadrature "full": the reduced set replaces the full
set, and is not charged with the full set's own error for an opposite grid whose kinks lie inside a cell (2 % of a
response if rows are far apart). Only the areas are those of the exact surface.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from typing import Any, TypeAlias

import numpy as np
from scipy.linalg import lstsq, null_space, qr

from warpffrf.model.errors import InputError, require_number
from warpffrf.model.reduced.contact_surface import ALL_ALONG, ALL_AROUND, Sampling, gauss_points

OPTIMAL = 1e-11  # gradient over the norms of column and b: below it is round-off of the products
DEPENDENT = 1e-10  # of the norm: a column that the others represent to this accuracy adds nothing
ROUNDS_PER_COLUMN = 5  # a column enters and leaves a few times at most; more is cycling by round-off


def nonnegative_least_squares(
    A: np.ndarray, b: np.ndarray, *, seed: Iterable[int] = (), enough: Callable[[np.ndarray], bool] | None = None
) -> np.ndarray:
    """c (n,) >= 0 that minimises |A c - b|, A (m, n); or the first iterate for which `enough(c)` is true.
    Columns `seed` are tried first. Raises `ArithmeticError` if the method does not end."""
    n = A.shape[1]
    norm = np.linalg.norm(A, axis=0)
    norm[norm == 0.0] = 1.0
    A, size = A / norm, max(float(np.linalg.norm(b)), float(np.finfo(float).tiny))
    c = np.zeros(n)
    inside, refused = np.zeros(n, dtype=bool), np.zeros(n, dtype=bool)
    waiting = list(seed)
    for _ in range(ROUNDS_PER_COLUMN * n + len(waiting)):
        if not waiting and enough is not None and inside.any() and enough(c / norm):
            return c / norm
        gradient = A.T @ (b - A @ c) / size
        gradient[inside | refused] = 0.0
        from_seed = bool(waiting)
        enters = waiting.pop(0) if from_seed else int(np.argmax(gradient))
        if gradient[enters] <= OPTIMAL:
            if from_seed:
                continue
            return c / norm
        inside[enters] = True
        c = _settle(A, b, c, inside)
        refused[:] = refused & ~inside
        refused[enters] = not inside[enters]  # round-off: it entered with a positive gradient and left at once
    raise ArithmeticError("non-negative least squares: the active set does not settle")


def _settle(A: np.ndarray, b: np.ndarray, c: np.ndarray, inside: np.ndarray) -> np.ndarray:
    """Least squares of the columns `inside`, removing those that reach zero on the way."""
    while inside.any():
        chosen = np.flatnonzero(inside)
        target = np.zeros_like(c)
        target[chosen] = least_squares(A[:, chosen], b)
        if np.all(target[chosen] > 0.0):
            return target
        falling = chosen[target[chosen] <= 0.0]
        step = c[falling] / np.maximum(c[falling] - target[falling], np.finfo(float).tiny)
        alpha = min(float(step.min()), 1.0)
        c = c + alpha * (target - c)
        out = falling[step <= alpha]
        inside[out] = False
        c[~inside] = 0.0
    return np.zeros_like(c)


def least_squares(A: np.ndarray, b: np.ndarray) -> np.ndarray:
    """x that minimises |A x - b|, the smallest of many."""
    found = lstsq(A, b, cond=DEPENDENT)
    return np.asarray(found[0])  # type: ignore[index]


def pivots(A: np.ndarray, count: int) -> np.ndarray:
    """The first `count` columns of A selected by QR with column pivoting (DEIM's choice of points, Drmac and Gugercin,
    SIAM J. Sci. Comput. 38, 2016), fewer where A has a lower rank."""
    R, order = (np.asarray(part) for part in qr(A, mode="r", pivoting=True))
    diagonal = np.abs(np.diag(R))
    rank = int(np.sum(diagonal > DEPENDENT * diagonal[0])) if len(diagonal) and diagonal[0] > 0.0 else 0
    return order[: min(count, rank)]


HALF_WIDTHS = (1.5, 8.0)  # columns: a patch barely resolved by a grid, and a well resolved one
PATCHES = 48  # more did not change the choice of points on any grid tried
MARGIN = 3  # columns next to a patch whose displacement affects its nodes
PRIMES = (2, 3, 5, 7, 11, 13, 17)  # bases of the sequence, one per parameter
LINE = 0.25  # share of patches that reach over all rows: lines
SKEW = 0.5 * np.pi  # largest angle between a patch and the columns [rad]
StripField: TypeAlias = Callable[[int], np.ndarray]  # values (n,) at points shifted by a number of columns
MODES = 12  # global modes, the lowest: their wavelengths are large compared with the surface


@dataclass(frozen=True, eq=False)
class Places:
    """Points of a strip: fraction x (n,) of a column, row (n,) and zeta (n,) between rows, axial z (n,) [m], and
    the measure (n,) [m] `R sqrt(1 + R'^2)` there."""

    x: np.ndarray
    row: np.ndarray
    zeta: np.ndarray
    z: np.ndarray
    measure: np.ndarray

    @classmethod
    def of(cls, surface: Any, x: np.ndarray, row: np.ndarray, zeta: np.ndarray) -> Places:
        """Points on `surface` (shape and grid)."""
        lines = surface.grid.z
        z = lines[row] + zeta * (lines[row + 1] - lines[row])
        shape = surface.shape
        return cls(x, row, zeta, z, shape.radius_at(z) * np.sqrt(1.0 + shape.slope_at(z) ** 2))

    def along(self, rows: int) -> np.ndarray:
        """psi_k at the points (rows, n)."""
        out = np.zeros((rows, len(self.x)))
        n = np.arange(len(self.x))
        out[self.row, n] += 1.0 - self.zeta
        out[self.row + 1, n] += self.zeta
        return out


@dataclass(frozen=True, eq=False)
class Family:
    """Snapshots of one kind: `values` (m, n) [1/m^2] at the candidates, `target` (m,) the integrals; size one."""

    name: str
    values: np.ndarray
    target: np.ndarray


def all_points(surface: Any, around: int = ALL_AROUND, along: int = ALL_ALONG) -> tuple[Places, np.ndarray]:
    """Gauss points of a strip and their weights [m^2], with the number per cell of quadrature "full" or as given."""
    grid = surface.grid
    x, row, zeta, share = gauss_points(grid.rows, around, along)
    places = Places.of(surface, x, row, zeta)
    return places, grid.pitch * share * np.diff(grid.z)[row] * places.measure


def strip_areas(surface: Any) -> np.ndarray:
    """Areas of the nodes by row (rows,) [m^2]; their sum is the area of the strip."""
    return surface.grid.pitch * np.asarray(surface.grid.gram_z(surface.shape)).sum(axis=1)


def families(surface: Any, candidates: Places, patches: int = PATCHES) -> Iterator[Family]:
    """All families but the areas, for a contact surface and `candidates`."""
    every, weight = all_points(surface)
    rows = surface.grid.rows
    at = [(places, places.along(rows)) for places in (candidates, every)]

    def family(name: str, snapshots: list[np.ndarray]) -> Family | None:
        target = snapshots[1] @ weight
        size = float(np.linalg.norm(target))
        return None if size == 0.0 else Family(name, snapshots[0] / size, target / size)

    found = [family("stress", [_overlaps(places, along) for places, along in at])]
    modes = surface.mode_normal.reshape(surface.grid.columns, rows, -1)
    for m in range(min(MODES, modes.shape[2])):
        middle = surface.grid.columns // 2
        columns = (middle + np.arange(-2, 3)) % surface.grid.columns
        found.append(family(f"mode {m + 1}", [_folded(p, h, _Field(p, modes[columns, :, m], -2)) for p, h in at]))
    yield from (f for f in found if f is not None)
    for name, field, patch in patch_fields(surface, range(patches)):
        one = family(name, [_folded(p, h, field(p), patch) for p, h in at])
        if one is not None:
            yield one


def patch_fields(surface: Any, numbers: Iterable[int]) -> Iterator[tuple[str, Callable[[Places], StripField], Patch]]:
    """Gap and response of the patches of these numbers of the sequence: name, field at points, and patch. The first
    numbers are used for training, later ones for validation."""
    for number in numbers:
        patch = Patch.of(surface, number)
        yield f"gap {number + 1}", patch.gap, patch
        yield f"response {number + 1}", _response(surface, patch), patch


@dataclass(frozen=True)
class Patch:
    """An ellipse on the grid: semi-axes a [columns] and b [m], centre x0 [columns], z0 [m], rotated by `skew` [rad];
    `spacing` [m] of a column; `moved` (2,): offset of the opposite grid, parts of a column and of a row."""

    a: float
    b: float
    x0: float
    z0: float
    skew: float
    spacing: float
    moved: tuple[float, float]

    @classmethod
    def of(cls, surface: Any, number: int) -> Patch:
        """The patch of this number of the sequence."""
        grid = surface.grid
        u = [halton(number + 1, base) for base in PRIMES]
        spacing = grid.pitch * float(np.max(surface.shape.radius_at(grid.z)))
        width = float(grid.z[-1] - grid.z[0])
        a = HALF_WIDTHS[0] * (HALF_WIDTHS[1] / HALF_WIDTHS[0]) ** u[0]
        shortest = HALF_WIDTHS[0] * max(spacing, float(np.diff(grid.z).max()))
        z0 = float(grid.z[0] + u[2] * width)
        moved = (u[5], u[6])
        if u[1] < LINE or shortest > 0.5 * width:
            return cls(a, 1e3 * width, u[3], z0, 0.0, spacing, moved)
        b = shortest * (width / shortest) ** ((u[1] - LINE) / (1.0 - LINE))
        return cls(a, b, u[3], z0, SKEW * (u[4] - 0.5), spacing, moved)

    def level(self, x: np.ndarray, z: np.ndarray) -> np.ndarray:
        """u^2/a^2 + v^2/b^2 - 1 at columns x and axial positions z: negative inside."""
        du, dv = (x - self.x0) * self.spacing, z - self.z0
        c, s = np.cos(self.skew), np.sin(self.skew)
        return ((c * du + s * dv) / (self.a * self.spacing)) ** 2 + ((c * dv - s * du) / self.b) ** 2 - 1.0

    @property
    def reach(self) -> int:
        """Columns on each side of column 0 that the patch may touch."""
        long = min(self.b / self.spacing, 2.0 * HALF_WIDTHS[1])
        wide = np.hypot(self.a * np.cos(self.skew), long * np.sin(self.skew))
        return int(np.ceil(wide)) + 1

    def gap(self, places: Places) -> Any:
        """The gap as a function of the shift in columns."""
        return lambda shift: self.level(places.x + shift, places.z)


def halton(number: int, base: int) -> float:
    """The radical inverse of `number` in `base`, in (0, 1)."""
    value, part = 0.0, 1.0
    while number:
        part /= base
        number, digit = divmod(number, base)
        value += part * digit
    return value


class _Field:
    """A nodal field (columns, rows) whose first column is `first`, at points shifted by columns and `moved`."""

    def __init__(self, places: Places, field: np.ndarray, first: int, moved: tuple[float, float] = (0.0, 0.0)) -> None:
        self.field, self.first = field, first
        self.x = places.x + moved[0]
        zeta = places.zeta + moved[1]
        up = np.minimum(np.floor(zeta).astype(np.int64), 1)
        self.row = np.minimum(places.row + up, field.shape[1] - 2)
        self.v = np.clip(places.row + zeta - self.row, 0.0, 1.0)  # the field continues as constant beyond the last row

    def __call__(self, shift: int) -> np.ndarray:
        x = self.x + shift
        column = np.floor(x).astype(np.int64)
        u, i = x - column, np.clip(column - self.first, 0, len(self.field) - 2)
        low, high = self.field[i], self.field[i + 1]
        n = np.arange(len(x))
        below = (1.0 - u) * low[n, self.row] + u * high[n, self.row]
        above = (1.0 - u) * low[n, self.row + 1] + u * high[n, self.row + 1]
        return (1.0 - self.v) * below + self.v * above


def _folded(places: Places, along: np.ndarray, field: Any, patch: Patch | None = None) -> np.ndarray:
    """Snapshots (nodes, n) of a field: all rows of the columns touched by the patch, of column 0 without one."""
    reach = 0 if patch is None else patch.reach
    before = field(-reach - 1)
    out = []
    for j in range(-reach, reach + 1):
        here = field(j)
        out.append(along * ((1.0 - places.x) * here + places.x * before))
        before = here
    return np.concatenate(out)


def _overlaps(places: Places, along: np.ndarray) -> np.ndarray:
    """Snapshots of psi_0k psi_jl, j = 0 and 1, rows k <= l <= k + 1."""
    x = places.x
    around = ((1.0 - x) ** 2 + x**2, x * (1.0 - x))
    products = [along * along, along[:-1] * along[1:]]
    return np.concatenate([product * part for part in around for product in products])


def _response(surface: Any, patch: Patch) -> Any:
    """Displacement under the patch's pressure, as a function of points."""
    grid = surface.grid
    rows = grid.rows
    half = min(patch.reach + MARGIN, (grid.columns - 1) // 2)
    offset = np.arange(-half, half + 1)
    columns = grid.columns // 2 + offset
    D = surface.compliance(columns)
    inside = np.maximum(-patch.level(offset[:, None].astype(float), grid.z[None, :]), 0.0)
    pressure = np.sqrt(inside)
    force = grid.pitch * (pressure @ np.asarray(grid.gram_z(surface.shape)).T)
    field = (D @ force.ravel()).reshape(len(offset), rows)
    return lambda places: _Field(places, field, -half, patch.moved)


GAUSS = 0.5 - 0.5 / np.sqrt(3.0)  # of the two-point rule on (0, 1)
PAIR = (GAUSS, 1.0 - GAUSS)
LINES = (0.0, GAUSS, 0.5, 1.0 - GAUSS)
# points across a column and between two rows: the Gauss points, the lines and their middles
GAUSS_PAIRS = (PAIR, PAIR)
CANDIDATES = (GAUSS_PAIRS, (LINES, LINES))
ALL = tuple(tuple(0.5 * (p + 1.0) for p in np.polynomial.legendre.leggauss(n)[0]) for n in (ALL_AROUND, ALL_ALONG))
HEAVY = 1e3  # weight of the areas relative to the families: they are satisfied to 1e-6 before they are made exact
EXACT = 1e-12  # of the strip's area: tolerance of the area conditions
SMALLEST = 1e-6  # of the area: points with a smaller weight have no effect
MOST_ROWS = 200  # rows of a grid: candidates and snapshots by the thousand beyond


def choose_sampling(surface: Any, wanted_error: float, *, patches: int = PATCHES, label: str = "") -> Sampling:
    """Points and weights for `surface` (shape, grid, compliance) with an error of the worst training family of at most
    `wanted_error`.

    Raises `InputError` for an impossible error, for cells instead of nodal functions, and if no weights of the
    candidates reach it; the message states the attainable error.
    """
    wanted = require_number(wanted_error, "reduce: sampling_error", positive=True)
    where = f"contact {label!r}" if label else "contact surface"
    if surface.grid.kind != "nodes":
        raise InputError(f"{where}: sampling points require tractions on nodes; take traction='nodes'")
    if surface.grid.rows > MOST_ROWS:
        raise InputError(
            f"{where}: sampling points are chosen for up to {MOST_ROWS} rows of the contact grid, it has "
            f"{surface.grid.rows}; use a larger spacing, or no sampling_error"
        )
    best: Sampling | None = None
    reached = np.inf
    sets = [alternating(candidate_places(surface, *GAUSS_PAIRS)), *(candidate_places(surface, *c) for c in CANDIDATES)]
    for places in (*sets, candidate_places(surface, *ALL)):
        if best is not None and places not in sets:
            break
        problem = Problem.of(surface, places, patches)
        share = problem.solve(wanted)
        worst, mean = (np.inf, np.inf) if share is None else problem.errors(share)
        reached = min(reached, worst)
        if share is None or worst > wanted:
            continue
        at = np.flatnonzero(share)
        found = Sampling(
            places.x[at], places.row[at], places.zeta[at], share[at] * problem.area, wanted, worst, mean,
            len(problem.trained),
        )  # fmt: skip
        if best is None or found.count < best.count:
            best = found
    if best is None:
        raise InputError(
            f"{where}: no choice of sampling points reaches sampling_error={wanted:g}; {reached:.2g} can be reached"
        )
    return best


@dataclass(frozen=True, eq=False)
class Problem:
    """Least squares over one set of candidate `places`; the unknowns are fractions (n,) of the strip's `area` [m^2].

    values: snapshots of each of the families `trained`, times the area; A, b: all of them and the areas as heavy rows;
    E, e: the areas.
    """

    places: Places
    area: float
    trained: list[Family]
    values: list[np.ndarray]
    A: np.ndarray
    b: np.ndarray
    E: np.ndarray
    e: np.ndarray

    @classmethod
    def of(cls, surface: Any, places: Places, patches: int) -> Problem:
        """The problem of `surface` with this number of training patches."""
        trained = list(families(surface, places, patches))
        E, e = area_conditions(surface, places)
        area = float(strip_areas(surface).sum())
        values = [f.values * area for f in trained]
        A = np.concatenate([*values, HEAVY * E])
        b = np.concatenate([*(f.target for f in trained), HEAVY * e])
        return cls(places, area, trained, values, *compressed(A, b), E, e)

    def solve(self, wanted: float) -> np.ndarray | None:
        """The first iterate with an error of at most `wanted`, without points that the others can replace; otherwise
        the minimiser, None if it misses the areas."""
        seed = [int(i) for i in pivots(self.A, len(self.e))]
        found = nonnegative_least_squares(self.A, self.b, seed=seed, enough=lambda c: self._good(c, wanted) is not None)
        share = self.with_areas(found)
        if share is None or self.errors(share)[0] > wanted:
            return share
        for point in np.argsort(share):
            if share[point] <= 0.0:
                continue
            rest = share.copy()
            rest[point] = 0.0
            without = self._good(rest, wanted)
            share = share if without is None else without
        return share

    def _good(self, share: np.ndarray, wanted: float) -> np.ndarray | None:
        """Weights on the points of `share` with exact areas, if their error is at most `wanted`."""
        exact = self.with_areas(share)
        return None if exact is None or self.errors(exact)[0] > wanted else exact

    def with_areas(self, share: np.ndarray) -> np.ndarray | None:
        """Least squares on the points of `share` with E w = e exact; None if that requires negative weights."""
        chosen = np.flatnonzero(share)
        if not len(chosen):
            return None
        E, A = self.E[:, chosen], self.A[:, chosen]
        weights = least_squares(E, self.e)
        if np.abs(E @ weights - self.e).max() > EXACT:
            return None
        free = null_space(E)
        if free.shape[1]:
            weights = weights + free @ least_squares(A @ free, self.b - A @ weights)
        if not np.all(weights > SMALLEST):
            return None
        out = np.zeros(len(share))
        out[chosen] = weights
        return out

    def errors(self, share: np.ndarray) -> tuple[float, float]:
        """Largest error of a family over its size, and the root of the mean square over families."""
        at = np.flatnonzero(share)
        pairs = zip(self.values, self.trained, strict=True)
        errors = [float(np.linalg.norm(v[:, at] @ share[at] - f.target)) for v, f in pairs]
        return max(errors), float(np.sqrt(np.mean(np.square(errors))))


def candidate_places(surface: Any, fractions: tuple[float, ...], zetas: tuple[float, ...]) -> Places:
    """Candidate points of a strip: `fractions` of a column x `zetas` between every two rows.

    The two ends of the surface are no candidates: the other one may end there too, and round-off would decide whether
    the point faces the opposite surface.
    """
    cells = np.arange(surface.grid.rows - 1)
    row, zeta, x = (a.ravel() for a in np.meshgrid(cells, zetas, fractions, indexing="ij"))
    inside = (row > 0) | (zeta > 0.0)
    return Places.of(surface, x[inside], row[inside].astype(np.int64), zeta[inside])


def alternating(places: Places) -> Places:
    """From `places` with two fractions of a column each, one for every axial position, alternating between the two
    fractions, so that errors in odd powers of u cancel between neighbours."""
    order = np.lexsort([places.x, places.zeta, places.row])
    pairs = order.reshape(-1, 2)
    chosen = np.where(np.arange(len(pairs)) % 2 == 0, pairs[:, 0], pairs[:, 1])
    kept = (a[chosen] for a in (places.x, places.row, places.zeta, places.z, places.measure))
    return Places(*kept)


def area_conditions(surface: Any, places: Places) -> tuple[np.ndarray, np.ndarray]:
    """E (rows, n) and e (rows,): fractions of the strip's area assigned to the nodes of each row."""
    areas = strip_areas(surface)
    return places.along(surface.grid.rows), areas / areas.sum()


def compressed(A: np.ndarray, b: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """A smaller problem with the same |A c - b| for every c: the triangle of the QR factors of [A b]."""
    if len(A) <= A.shape[1] + 1:
        return A, b
    R = np.asarray(np.linalg.qr(np.column_stack([A, b]), mode="r"))
    return R[:, :-1], R[:, -1]
