r"""What sampling points are trained on: the integrals that evaluating a contact takes, for patches of all kinds.

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

from warpffrf.model.reduced.sampling import ALL_ALONG, ALL_AROUND, gauss_points

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
