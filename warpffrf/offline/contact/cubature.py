r"""Choice of few sampling points with positive weights for a contact surface: `reduce(..., sampling_error=)`.

Of many candidates in a strip of the contact grid those are kept, and weighted, that integrate a training set
(`warpffrf.offline.contact.cubature`) as all points do, to a wanted error:

    minimise  sum over families |V_f w - t_f|^2   subject to   E w = e,   w >= 0,

V_f snapshots at the candidates, t_f the integrals by all points, E w = e the areas of the hats row by row: a constant
pressure has its resultant exactly, whatever the error. Non-negative least squares (`nonnegative`) with the areas as
heavy rows, begun with the columns that QR with pivoting takes first and stopped at the first set for which the *worst*
family is good enough; then the weights of that set with E w = e exact, by its null space. Empirical cubature: J. A.
Hernandez, M. A. Caicedo, A. Ferrer, Comput. Methods Appl. Mech. Engng 313, 2017; weights that are not negative, and the
early stop: C. Farhat, T. Chapman, P. Avery, Int. J. Numer. Meth. Engng 102, 2015.

**How few.** Because a strip repeats itself, a point counts for a hat twice, at x and at x - 1, and what it sees of u^2
is x (1 - x): the exact mean 1/6 is that of *one* Gauss point x = (1 - 1/sqrt 3)/2 a row of points. With two along z a
cell, a third of the 3 x 2 points of the full rule, all quadratic gaps and all products of hats are integrated exactly;
a larger wanted error needs fewer. The method takes what helps most at once and so prefers pairs of points at x = 0 and
1/2; it is run on these single points, on opposite sides by turns, and on the two sets of `CANDIDATES`; the smallest
result counts. Points that the others can replace are taken out afterwards, those of the smallest weights first. Errors
below what these sets reach, some tenths of a per cent, are looked for among all points themselves.

**What few points cannot see.** Between two grids of unequal spacing every hat has the other grid's nodes at another
place, and one point a column tells less of them than three. That is an error from hat to hat, to which force and
approach are blind (0.05 % at 4.5 columns a half-width) but the pressure is not: it varies by 4 to 7 % (L2) about that
of all points. On equal grids that roll on each other there is no such difference (1e-5). The online check reports
it.

**Energy.** Weights are positive and the same on both sides of a product, so that the tangent in the hats stays
symmetric, and the area of a hat is exact, so that a force and its reaction stay the same number. What is inexact is
which gap belongs to a hat; that enters the *grid defect* of the energy ledger, as the Gauss rule's own error does.

Nonnegative. Non-negative least squares that may stop early: few points, positive weights.

    minimise |A c - b|^2   subject to   c >= 0

by the active-set method of Lawson and Hanson (Solving Least Squares Problems, 1974, chapter 23): the column whose
gradient `A^T (b - A c)` is largest enters, the least-squares problem of the columns that are in is solved, and columns
whose coefficient would fall below zero leave on the way. Two things are added. The columns of a `seed` enter first,
each if its gradient is positive; that saves rounds and, of many equal solutions, decides which is found. And `enough`
may end it before the minimum: each round adds about one column, so the first set that is good enough is a small one
(Farhat, Chapman, Avery, Int. J. Numer. Meth. Engng 102, 2015). At the end of a full run

    A^T (A c - b) = 0 where c > 0,      >= 0 where c = 0,

which is what makes a minimum (Karush, Kuhn, Tucker).

Columns are compared by their gradient over their own norm, so that scaling a column changes nothing.

Training. What sampling points are trained on: the integrals that evaluating a contact takes, for patches of all kinds.

The strip of a contact grid repeats itself, so that the weak value of a function f on the hat of column j and row k is
a sum over one list of points (x, z) of the strip, each used in the two strips that the hat covers,

    int psi_jk f dA = int over the strip of  psi_k(z) [ (1 - x) f(j + x, z) + x f(j - 1 + x, z) ] dA:

the integrand of the bracket, at the points, is a *snapshot*; no simulation is needed to have it. Families of snapshots:

    areas      f = 1, which must be exact: a constant pressure has its resultant, and the weights add up to the area
    stress     f = psi_jl, the hats themselves: products of two hats, the overlap of the grid with itself
    gaps       f = u^2/a^2 + v^2/b^2 - 1 inside the ellipse f < 0: the undeformed gap of a patch
    response   f = u_n, the displacement of the body's local modes under the pressure sqrt(1 - u^2/a^2 - v^2/b^2) of
               that patch, interpolated on a grid that is displaced by a part of a column and of a row, the one opposite
    modes      f = the displacement of a global mode

with u, v along the axes of the patch. Semi-axes a, b, position, skew and the place of the opposite grid follow a
low-discrepancy sequence (Halton), the same each time. Every family is scaled to size one.

The targets are the integrals by *all* points, the Gauss points of evaluation "semi": few points stand for many, and
what the many miss of an opposite grid whose kinks lie inside a cell is no fault of the few (2 % of a response where
rows are far apart). Only the areas are those of the exact surface.
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
DEPENDENT = 1e-10  # of the norm: a column that the others make up to this adds nothing
ROUNDS_PER_COLUMN = 5  # a column enters and leaves a few times at most; more is cycling by round-off


def nonnegative_least_squares(
    A: np.ndarray,
    b: np.ndarray,
    *,
    seed: Iterable[int] = (),
    enough: Callable[[np.ndarray], bool] | None = None,
) -> np.ndarray:
    """c (n,) >= 0 that minimises |A c - b|, A (m, n); or the first on the way there for which `enough(c)` is true.
    Columns `seed` are tried first. Raises `ArithmeticError` where the method does not end."""
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
    """Least squares of the columns `inside`, from which those leave that reach zero on the way there."""
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
    """The `count` columns of A that QR with column pivoting takes first (DEIM's choice of points, Drmac and Gugercin,
    SIAM J. Sci. Comput. 38, 2016), fewer where A has a lower rank."""
    R, order = (np.asarray(part) for part in qr(A, mode="r", pivoting=True))
    diagonal = np.abs(np.diag(R))
    rank = int(np.sum(diagonal > DEPENDENT * diagonal[0])) if len(diagonal) and diagonal[0] > 0.0 else 0
    return order[: min(count, rank)]


HALF_WIDTHS = (1.5, 8.0)  # columns: a patch that a grid resolves at all, and one that it resolves well
PATCHES = 48  # more changed the choice of points on no grid tried
MARGIN = 3  # columns beside a patch whose displacement its hats see
PRIMES = (2, 3, 5, 7, 11, 13, 17)  # bases of the sequence, one a parameter
LINE = 0.25  # share of patches that reach over all rows: lines
SKEW = 0.5 * np.pi  # largest angle between a patch and the columns [rad]
StripField: TypeAlias = Callable[[int], np.ndarray]  # values (n,) at places that are shifted by so many columns
MODES = 12  # global modes, the lowest: a surface is small beside the waves of any of them


@dataclass(frozen=True, eq=False)
class Places:
    """Points of a strip: fraction x (n,) of a column, row (n,) and zeta (n,) between rows, axial place z (n,) [m], and
    the measure (n,) [m] `R sqrt(1 + R'^2)` there."""

    x: np.ndarray
    row: np.ndarray
    zeta: np.ndarray
    z: np.ndarray
    measure: np.ndarray

    @classmethod
    def of(cls, surface: Any, x: np.ndarray, row: np.ndarray, zeta: np.ndarray) -> Places:
        """Places on `surface` (shape and grid)."""
        lines = surface.grid.z
        z = lines[row] + zeta * (lines[row + 1] - lines[row])
        shape = surface.shape
        return cls(x, row, zeta, z, shape.radius_at(z) * np.sqrt(1.0 + shape.slope_at(z) ** 2))

    def along(self, rows: int) -> np.ndarray:
        """psi_k at the places (rows, n)."""
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
    """Gauss points of a strip and their weights [m^2], as many a cell as evaluation "semi" has or as told."""
    grid = surface.grid
    x, row, zeta, share = gauss_points(grid.rows, around, along)
    places = Places.of(surface, x, row, zeta)
    return places, grid.pitch * share * np.diff(grid.z)[row] * places.measure


def strip_areas(surface: Any) -> np.ndarray:
    """Areas of the hats by row (rows,) [m^2]; their sum is the area of the strip."""
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
    """Gap and response of the patches of these numbers of the sequence: name, field at places, and patch. Training has
    the first ones; those behind are held out."""
    for number in numbers:
        patch = Patch.of(surface, number)
        yield f"gap {number + 1}", patch.gap, patch
        yield f"response {number + 1}", _response(surface, patch), patch


@dataclass(frozen=True)
class Patch:
    """An ellipse on the grid: semi-axes a [columns] and b [m], centre x0 [columns], z0 [m], turned by `skew` [rad];
    `spacing` [m] of a column; `moved` (2,): place of the opposite grid, parts of a column and of a row."""

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
        """u^2/a^2 + v^2/b^2 - 1 at columns x and axial places z: negative inside."""
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
    """A hat field (columns, rows) whose first column is `first`, at places that are shifted by columns and `moved`."""

    def __init__(self, places: Places, field: np.ndarray, first: int, moved: tuple[float, float] = (0.0, 0.0)) -> None:
        self.field, self.first = field, first
        self.x = places.x + moved[0]
        zeta = places.zeta + moved[1]
        up = np.minimum(np.floor(zeta).astype(np.int64), 1)
        self.row = np.minimum(places.row + up, field.shape[1] - 2)
        self.v = np.clip(places.row + zeta - self.row, 0.0, 1.0)  # beyond the last row the field goes on constant

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
    """Snapshots (hats, n) of a field: all rows of the columns that the patch touches, of the column 0 without one."""
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
    """Displacement under the patch's pressure, as a function of places."""
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
# places across a column and between two rows: the Gauss points, and with them the lines and their middles
GAUSS_PAIRS = (PAIR, PAIR)
CANDIDATES = (GAUSS_PAIRS, (LINES, LINES))
ALL = tuple(tuple(0.5 * (p + 1.0) for p in np.polynomial.legendre.leggauss(n)[0]) for n in (ALL_AROUND, ALL_ALONG))
HEAVY = 1e3  # weight of the areas beside the families: they hold to 1e-6 before they are made exact
EXACT = 1e-12  # of the strip's area: what is left of the area conditions
SMALLEST = 1e-6  # of the area: a weight below it is a point that does nothing
MOST_ROWS = 200  # rows of a grid: candidates and snapshots by the thousand beyond


def choose_sampling(surface: Any, wanted_error: float, *, patches: int = PATCHES, label: str = "") -> Sampling:
    """Points and weights for `surface` (shape, grid, compliance) whose worst training family errs by `wanted_error` at
    most.

    Raises `InputError` for an impossible error, for cells in place of hats, and where no weights of the candidates
    reach it; the message says which error can be reached.
    """
    wanted = require_number(wanted_error, "reduce: sampling_error", positive=True)
    where = f"contact {label!r}" if label else "contact surface"
    if surface.grid.kind != "hats":
        raise InputError(f"{where}: sampling points are chosen for hats; use traction='hats' or no sampling_error")
    if surface.grid.rows > MOST_ROWS:
        raise InputError(
            f"{where}: sampling points are chosen for up to {MOST_ROWS} rows of the contact grid, it has "
            f"{surface.grid.rows}; use a coarser traction_spacing, or no sampling_error"
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
    """Least squares over one set of candidate `places`; the unknowns are shares (n,) of the strip's `area` [m^2].

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
        """The problem of `surface` with so many training patches."""
        trained = list(families(surface, places, patches))
        E, e = area_conditions(surface, places)
        area = float(strip_areas(surface).sum())
        values = [f.values * area for f in trained]
        A = np.concatenate([*values, HEAVY * E])
        b = np.concatenate([*(f.target for f in trained), HEAVY * e])
        return cls(places, area, trained, values, *compressed(A, b), E, e)

    def solve(self, wanted: float) -> np.ndarray | None:
        """The first shares on the way to the minimum that err by `wanted` at most, without the points that the others
        can replace; else the shares of the minimum, None where these miss the areas."""
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
        """Shares on the points of `share` with exact areas, where they err by `wanted` at most."""
        exact = self.with_areas(share)
        return None if exact is None or self.errors(exact)[0] > wanted else exact

    def with_areas(self, share: np.ndarray) -> np.ndarray | None:
        """Least squares on the points of `share` with E w = e exact; None where positive weights cannot do it."""
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
    """Places of a strip among which points are chosen: `fractions` of a column x `zetas` between every two rows.

    The two ends of the surface are no candidates: the other one may end there too, and round-off would decide whether
    the point faces anything.
    """
    cells = np.arange(surface.grid.rows - 1)
    row, zeta, x = (a.ravel() for a in np.meshgrid(cells, zetas, fractions, indexing="ij"))
    inside = (row > 0) | (zeta > 0.0)
    return Places.of(surface, x[inside], row[inside].astype(np.int64), zeta[inside])


def alternating(places: Places) -> Places:
    """Of `places` with two fractions of a column each, one for every place along the axis, the one and the other by
    turns: what each leaves of odd powers of u the next takes back."""
    order = np.lexsort([places.x, places.zeta, places.row])
    pairs = order.reshape(-1, 2)
    chosen = np.where(np.arange(len(pairs)) % 2 == 0, pairs[:, 0], pairs[:, 1])
    kept = (a[chosen] for a in (places.x, places.row, places.zeta, places.z, places.measure))
    return Places(*kept)


def area_conditions(surface: Any, places: Places) -> tuple[np.ndarray, np.ndarray]:
    """E (rows, n) and e (rows,): shares of the strip's area that the hats of each row must get."""
    areas = strip_areas(surface)
    return places.along(surface.grid.rows), areas / areas.sum()


def compressed(A: np.ndarray, b: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """A smaller problem with the same |A c - b| for every c: the triangle of the QR factors of [A b]."""
    if len(A) <= A.shape[1] + 1:
        return A, b
    R = np.asarray(np.linalg.qr(np.column_stack([A, b]), mode="r"))
    return R[:, :-1], R[:, -1]
