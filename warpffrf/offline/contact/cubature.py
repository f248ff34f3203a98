r"""Choice of few sampling points with positive weights for a contact surface: `reduce(..., sampling_error=)`.

Of many candidates in a strip of the contact grid those are kept, and weighted, that integrate a training set
(`warpffrf.offline.contact.training`) as all points do, to a wanted error:

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
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.linalg import null_space

from warpffrf.model.errors import InputError, require_number
from warpffrf.model.reduced.sampling import ALL_ALONG, ALL_AROUND, Sampling
from warpffrf.offline.contact.nonnegative import least_squares, nonnegative_least_squares, pivots
from warpffrf.offline.contact.training import PATCHES, Family, Places, families, strip_areas

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
