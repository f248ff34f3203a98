r"""A response surface: an output between the rows of a sweep, and its error.

Parameters are scaled to 0 to 1 over their ranges, u = (p - p_least)/(p_largest - p_least), or by their logarithms if
the values are distributed logarithmically (`Axis.is_log`).

**Whole grids**, with values in all rows: the tensor product of interpolating splines, of degree min(3, n - 1) along a
parameter of n values (`scipy.interpolate.NdBSpline`). Values of a sweep are usually dense where the output is curved,
and a cubic through uneven values overshoots in the wide gaps; the n values are therefore mapped to 0, 1/(n - 1), ...,
1, and u between them by a monotone curve (`scipy.interpolate.PchipInterpolator`; a straight line for even values). The
error is that of held-out values: each inner value of each parameter is omitted in turn with all its rows, and these are
predicted from the others. The gaps are then twice as wide as in the final surface, whose error is smaller, for smooth
outputs by 2^(degree + 1).

**Other rows**: thin-plate splines with a linear part (`scipy.interpolate.RBFInterpolator`),

    s(u) = sum_i w_i |u - u_i|^2 log|u - u_i| + a + b.u,    s(u_i) = y_i.

The error is that of leave-one-out prediction: each row is predicted from all others; for more than `MOST_FOLDS` rows,
groups of `MOST_LEFT_OUT` rows of a fixed random selection. For more than `MANY` rows each point uses its `NEIGHBOURS`
nearest rows. Rows at the boundary are extrapolated when they are omitted, so that this error is larger than that
between rows.

Both errors are root mean squares of prediction minus value, in the unit of the output, and `relative_error` is that
over the standard deviation of the values: 0 is a perfect prediction, 1 is no better than the mean.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.interpolate import NdBSpline, PchipInterpolator, RBFInterpolator, make_interp_spline
from scipy.optimize import minimize

from warpffrf.model.errors import InputError, unknown_name
from warpffrf.model.messages import reprs
from warpffrf.study.sweeps.parameters import sobol
from warpffrf.study.sweeps.reading.plot import Axis, axes_of, grid_places
from warpffrf.study.sweeps.reading.values import Table, Values, chosen_rows, shown_in, values_of

MANY, NEIGHBOURS = 1000, 100  # rows above which thin-plate splines are local; number of nearest rows then
MOST_FOLDS, MOST_LEFT_OUT = 100, 500  # surfaces computed for the error, and rows predicted by them
DEGREE = 3  # of splines along a parameter with enough values
OUTSIDE = 1e-9  # of a range: round-off by which a point may lie outside
STARTS, BEST = 512, 6  # start points of the minimisation, and number of the best that are refined
SEED = 0  # of the groups of rows and of the start points

Unit = Callable[[np.ndarray], np.ndarray]  # (n, d) of 0 to 1 -> (n,)


@dataclass(frozen=True)
class Extremum:
    """The least or largest `value` of a surface, and its parameters; `error` is that of the surface."""

    value: float
    parameters: dict[str, float]
    error: float


@dataclass(frozen=True, eq=False, repr=False)
class Surface(reprs.Shown):
    """An output between the rows of a sweep; a point is {parameter: value, or an array of values}.

    ranges: least and largest value of each parameter; the surface extrapolates at corners without a nearby row of a
    sample. error: root mean square of predictions of omitted rows minus their values, in the unit of the output, NaN
    with too few rows; `relative_error` is that over the standard deviation of the values. method, note: how it was
    computed, and what was omitted.
    """

    name: str
    unit: str
    ranges: dict[str, tuple[float, float]]
    logarithmic: tuple[bool, ...]  # parameters scaled by their logarithms
    rows: int
    method: str
    error: float
    error_method: str
    relative_error: float
    note: str
    of_unit: Unit
    points: np.ndarray  # (rows, d) of 0 to 1
    values: np.ndarray

    def __call__(self, point: Mapping[str, Any]) -> Any:
        """The output [SI] at a point, a number, or an array of the broadcast shape of its values. Raises InputError for
        a parameter that is missing or unknown, and outside of `ranges`."""
        for name in point:
            if name not in self.ranges:
                raise unknown_name(f"response of {self.name!r}: parameter", str(name), self.ranges)
        columns = []
        for (name, (low, high)), is_log in zip(self.ranges.items(), self.logarithmic, strict=True):
            if name not in point:
                raise InputError(f"response of {self.name!r}: give {name} too, between {low:g} and {high:g}")
            p = np.asarray(point[name], dtype=float)
            if not np.all((p >= low - OUTSIDE * (high - low)) & (p <= high + OUTSIDE * (high - low))):
                raise InputError(
                    f"response of {self.name!r}: {name} is swept from {low:g} to {high:g}, and nothing is known "
                    f"outside; got {point[name]}"
                )
            columns.append(_scaled(np.clip(p, low, high), low, high, is_log))
        u = np.stack(np.broadcast_arrays(*columns), axis=-1)
        found = self.of_unit(u.reshape(-1, len(columns))).reshape(u.shape[:-1])
        return float(found) if found.ndim == 0 else found

    def minimum(self) -> Extremum:
        """The least value within the ranges."""
        return self._extremum(1.0)

    def maximum(self) -> Extremum:
        """The largest value within the ranges."""
        return self._extremum(-1.0)

    def _extremum(self, sign: float) -> Extremum:
        """Minimisation from the rows and evenly distributed points; the best local minimum found."""
        spread = sobol(STARTS, len(self.ranges), SEED)
        starts = np.concatenate([self.points, spread])
        heights = sign * np.concatenate([self.values, self.of_unit(spread)])
        best, at = np.inf, starts[0]
        for n in np.argsort(heights, kind="stable")[:BEST]:
            found = minimize(
                lambda u: sign * float(self.of_unit(u[None])[0]), starts[n], method="L-BFGS-B",
                bounds=[(0.0, 1.0)] * len(self.ranges),
            )  # fmt: skip
            height, end = min(((float(found.fun), found.x), (float(heights[n]), starts[n])), key=lambda pair: pair[0])
            if height < best:
                best, at = height, end
        ends = zip(self.ranges.items(), self.logarithmic, at, strict=True)
        where = {name: _unscaled(float(u), low, high, is_log) for (name, (low, high)), is_log, u in ends}
        return Extremum(sign * best, where, self.error)

    def report(self) -> str:
        """Method, error, and the extrema."""
        factor, unit = shown_in(self.unit, self.values)
        said = f"{self.error * factor:.4g} {unit}".strip() + f", {self.relative_error:.2g} of the standard deviation"
        lines = [
            f"response of {self.name}",
            f"  made of         {self.rows} rows, {self.method}",
            f"  error           {said if np.isfinite(self.error) else 'not known'}; {self.error_method}",
        ]
        for name, found in (("least", self.minimum()), ("largest", self.maximum())):
            where = ", ".join(f"{key} = {value:.4g}" for key, value in found.parameters.items())
            lines.append(f"  {name:<15} {found.value * factor:.5g} {unit}".rstrip() + f" at {where}")
        return "\n".join([*lines, *([f"  note            {self.note}"] if self.note else [])])

    def _facts(self) -> dict[str, Any]:
        return {"name": self.name, "rows": self.rows, "parameters": list(self.ranges), "error": f"{self.error:.3g}"}


def surface(
    table: Table, output: str, component: str | int | None = None, where: Mapping[str, Any] | None = None
) -> Surface:
    """The surface of an output, see `Sweep.response`."""
    values, rows = values_of(table, output, component), chosen_rows(table, where)
    if values.time is not None:
        raise InputError(f"response of {output!r}: it is over time; sweep one number of it, as 'max({values.text})'")
    axes = axes_of(table, rows)
    for axis in axes:
        if axis.words is not None:
            raise InputError(
                f"response of {output!r}: {axis.name} is a text, and nothing lies between "
                f"{' and '.join(axis.words[:2])}; choose one with where={{{axis.name!r}: {axis.words[0]!r}}}"
            )
    if not axes:
        raise InputError(f"response of {output!r}: no parameter varies in these rows; sweep at least one")
    return _through(values, rows, axes)


def _through(values: Values, rows: np.ndarray, axes: Sequence[Axis]) -> Surface:
    has = rows & values.has
    ranges = {a.name: (float(a.positions[rows].min()), float(a.positions[rows].max())) for a in axes}
    logarithmic = tuple(axis.is_log for axis in axes)
    columns = [
        _scaled(a.positions, *ends, is_log) for a, ends, is_log in zip(axes, ranges.values(), logarithmic, strict=True)
    ]
    scaled = np.stack(columns, axis=1)
    u, y = scaled[has], values.numbers[has]
    missing = values.missing(rows)
    note = f"rows without a value are left out: {missing}" if missing else ""
    grid = grid_places(axes, rows) if not missing else None
    if grid is not None:
        made = _of_grid(u, y, grid[1], [axis.name for axis in axes])
    else:
        u, y = _once(u, y)
        if len(y) < u.shape[1] + 1:
            raise InputError(
                f"response of {values.name!r}: {len(y)} rows have values, a surface over {u.shape[1]} parameters needs "
                f"{u.shape[1] + 1} at least" + (f" ({missing})" if missing else "")
            )
        misses, error_method = _left_out(values.name, u, y)
        made = _Made(_plates(values.name, u, y), _plates_are(len(y)), misses, error_method)
    error = float(np.sqrt(np.mean(made.misses**2))) if len(made.misses) else np.nan
    deviation = float(np.std(y))
    relative = error / deviation if deviation > 0.0 else 0.0 if error == 0.0 else np.inf
    return Surface(
        name=values.name, unit=values.unit, ranges=ranges, logarithmic=logarithmic, rows=int(has.sum()),
        method=made.method, error=error, error_method=made.error_method, relative_error=relative, note=note,
        of_unit=made.of_unit, points=u, values=y,
    )  # fmt: skip


@dataclass(frozen=True, eq=False)
class _Made:
    """An interpolation of rows, its method, and its errors at omitted rows."""

    of_unit: Unit
    method: str
    misses: np.ndarray
    error_method: str


def _of_grid(u: np.ndarray, y: np.ndarray, places: np.ndarray, names: Sequence[str]) -> _Made:
    """Splines through y (n,) at u (n, d), at the indices `places` (n, d) of a grid."""
    field = np.empty(places.max(axis=0) + 1)
    field[tuple(places.T)] = y
    at = [np.linspace(0.0, 1.0, count) for count in field.shape]
    turns = [PchipInterpolator(np.unique(u[:, k]), even) for k, even in enumerate(at)]
    splines, misses = _splines(at, field), _held_out(at, field)

    def of_unit(asked: np.ndarray, /) -> np.ndarray:
        return splines(np.stack([turn(asked[:, k]) for k, turn in enumerate(turns)], axis=1))

    degrees = ", ".join(f"{min(DEGREE, count - 1)}" for count in field.shape)
    method = f"a whole grid, splines of degree {degrees} along {', '.join(names)}"
    error_method = "inner values of each parameter left out in turn, cells twice as wide"
    if not len(misses):
        error_method = "no parameter has an inner value to leave out; give three values of one, or more"
    return _Made(of_unit, method, misses, error_method)


def _scaled(p: np.ndarray, low: float, high: float, is_log: bool) -> np.ndarray:
    """Values of a parameter as 0 to 1."""
    return np.log(p / low) / np.log(high / low) if is_log else (p - low) / (high - low)


def _unscaled(u: float, low: float, high: float, is_log: bool) -> float:
    """The value of a parameter at 0 to 1, with exact ends."""
    between = low * (high / low) ** u if is_log else low + u * (high - low)
    return high if u == 1.0 else between


def _splines(at: Sequence[np.ndarray], field: np.ndarray) -> Unit:
    """The tensor product of splines through `field` (n_1, ..., n_d) at ascending positions (n_i,)."""
    knots, degrees = [], []
    for axis, places in enumerate(at):
        degree = min(DEGREE, len(places) - 1)
        spline = make_interp_spline(places, np.moveaxis(field, axis, 0), k=degree)
        field = np.moveaxis(spline.c, 0, axis)
        knots.append(spline.t)
        degrees.append(degree)
    return NdBSpline(tuple(knots), field, tuple(degrees))


def _held_out(at: Sequence[np.ndarray], field: np.ndarray) -> np.ndarray:
    """Prediction minus value with each inner value of each axis omitted in turn."""
    misses = []
    for axis, places in enumerate(at):
        for n in range(1, len(places) - 1):
            rest = [np.delete(v, n) if k == axis else v for k, v in enumerate(at)]
            of_unit = _splines(rest, np.delete(field, n, axis=axis))
            asked = np.meshgrid(*[places[n : n + 1] if k == axis else v for k, v in enumerate(at)], indexing="ij")
            found = of_unit(np.stack(asked, axis=-1).reshape(-1, len(at)))
            misses.append(found - np.take(field, n, axis=axis).ravel())
    return np.concatenate(misses) if misses else np.empty(0)


def _once(u: np.ndarray, y: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Each point once, with the mean of its rows."""
    points, of_point, counts = np.unique(u, axis=0, return_inverse=True, return_counts=True)
    return points, np.bincount(of_point.ravel(), y) / counts


def _plates(name: str, u: np.ndarray, y: np.ndarray) -> Unit:
    """Thin-plate splines through y (n,) at u (n, d). Raises `InputError` if the points do not span the space."""
    try:
        nearest = NEIGHBOURS if len(y) > MANY else None
        return RBFInterpolator(u, y, kernel="thin_plate_spline", degree=1, neighbors=nearest)
    except np.linalg.LinAlgError:
        raise InputError(
            f"response of {name!r}: the rows with values stand on a line or a plane between the parameters; sweep rows "
            "next to it, or choose one value of a parameter with where="
        ) from None


def _plates_are(rows: int) -> str:
    """Their name in a report."""
    return f"thin-plate splines through the {NEIGHBOURS} nearest" if rows > MANY else "thin-plate splines"


def _left_out(name: str, u: np.ndarray, y: np.ndarray) -> tuple[np.ndarray, str]:
    """Prediction minus value of omitted rows, and how they were selected."""
    n = len(y)
    if n < u.shape[1] + 3:
        return np.empty(0), f"{n} rows are too few to leave one out"
    chosen = np.random.default_rng(SEED).permutation(n)[:MOST_LEFT_OUT]
    folds = np.array_split(chosen, min(len(chosen), MOST_FOLDS))
    misses = []
    for fold in folds:
        rest = np.setdiff1d(np.arange(n), fold)
        misses.append(_plates(name, u[rest], y[rest])(u[fold]) - y[fold])
    said = "each row left out in turn" if n <= MOST_FOLDS else f"{len(chosen)} rows left out in {MOST_FOLDS} groups"
    return np.concatenate(misses), said
