r"""Sobol indices: contributions of the parameters to the variance of an output.

For independent parameters p_i with their distributions and an output y,

    first order  S_i  = V[E(y | p_i)] / V[y],        reduction of the variance if p_i is known
    total order  S_Ti = 1 - V[E(y | all but p_i)] / V[y],   remaining variance if all but p_i are known

0 <= S_i <= S_Ti <= 1; they are equal if p_i does not interact, and the S_i add up to 1 if no parameter does (I. M.
Sobol', 2001). `scipy.stats.sobol_indices` estimates them from points A, B and A with a column from B (A. Saltelli and
others, 2010).

**Rows of "saltelli:N"** are these points, and the indices are those of the scene itself. For **other rows** the indices
are those of a response surface (`surface`) at `SURFACE_POINTS` points of that kind: its error is reported with them,
and is not in the confidence intervals. Parameters have the distribution of their values in the rows, linear between
them: a sample has the distribution from which it was drawn, a range is uniform, values of a list have equal weights.

Confidence intervals are quantiles of `RESAMPLES` bootstrap samples of the N points; they measure the sampling error of
the indices.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.stats import sobol_indices

from warpffrf.model.errors import InputError
from warpffrf.model.messages import reprs
from warpffrf.study.sweeps.parameters import saltelli
from warpffrf.study.sweeps.reading.plot import axis_of
from warpffrf.study.sweeps.reading.surface import Surface, surface
from warpffrf.study.sweeps.reading.values import Table, Values, chosen_rows, values_of

CONFIDENCE = 0.95
RESAMPLES = 200  # bootstrap samples
SURFACE_POINTS = 2048  # N of the indices of a response surface
CONSTANT = 1e-12  # of the largest value: a smaller range is round-off
SEED = 0
SALTELLI = "saltelli"


@dataclass(frozen=True, eq=False, repr=False)
class Sensitivities(reprs.Shown):
    """Sobol indices of output `name`, in the order of `parameters`: `first` and `total` (d,), and bounds of their 95 %
    confidence intervals (d, 2). method: their source; `of_surface`: not from the scene's own rows."""

    name: str
    parameters: tuple[str, ...]
    first: np.ndarray
    total: np.ndarray
    first_bounds: np.ndarray
    total_bounds: np.ndarray
    method: str
    of_surface: bool

    def report(self) -> str:
        """The indices, largest first, with their intervals and source."""
        width = max(9, *map(len, self.parameters)) + 2
        lines = [f"Sobol indices of {self.name}, {self.method}", f"{'':<{width}}{'first order':>24}{'total order':>24}"]
        for n in np.argsort(-self.total, kind="stable"):
            said = [
                f"{value[n]:.3f} ({bounds[n, 0]:.3f} to {bounds[n, 1]:.3f})"
                for value, bounds in ((self.first, self.first_bounds), (self.total, self.total_bounds))
            ]
            lines.append(f"{self.parameters[n]:<{width}}" + "".join(f"{text:>24}" for text in said))
        return "\n".join(lines)

    def draw(self, ax: Any) -> None:
        """Bars with their intervals on matplotlib axes."""
        from warpffrf.output.plots.panels import COLORS

        at = np.arange(len(self.parameters))
        for n, (name, value, bounds) in enumerate(
            (("first order", self.first, self.first_bounds), ("total order", self.total, self.total_bounds))
        ):
            around = np.abs(bounds.T - value)
            ax.bar(at + 0.4 * (n - 0.5), value, 0.38, yerr=around, color=COLORS[n], capsize=3, label=name)
        ax.set_xticks(at, self.parameters)
        ax.axhline(0.0, color="0.5", lw=0.6)
        ax.set_ylabel("share of the variance [-]")
        ax.set_title(
            f"Sobol indices of {self.name}" + (", of its response surface" if self.of_surface else ""), fontsize=10
        )
        ax.grid(axis="y", alpha=0.25, lw=0.5)
        ax.legend(frameon=False, fontsize=8)

    def _facts(self) -> dict[str, Any]:
        pairs = zip(self.parameters, self.total, strict=True)
        return {"name": self.name, **{f"total of {p}": f"{total:.3f}" for p, total in pairs}}


def of_rows(table: Table) -> bool:
    """Whether the rows of a sweep are a sample for Sobol indices."""
    return str(table.definition["sample"]).startswith(SALTELLI)


def sensitivities(
    table: Table, output: str, component: str | int | None = None, where: Mapping[str, Any] | None = None
) -> Sensitivities:
    """The indices of an output, see `Sweep.sensitivities`."""
    values = values_of(table, output, component)
    subject = f"sensitivities of {output!r}"
    if values.time is not None:
        raise InputError(f"{subject}: it is over time; sweep one number of it, as 'max({values.text})'")
    if not of_rows(table):
        return of_surface(table, surface(table, output, component, where), where)
    if where:
        raise InputError(f"{subject}: a sample for Sobol indices is used as a whole; leave where out")
    number = int(str(table.definition["sample"]).partition(":")[2])
    return _of_rows(subject, values, tuple(table.parameter_names), number)


def _of_rows(subject: str, values: Values, names: tuple[str, ...], n: int) -> Sensitivities:
    """Indices from the rows A, B, AB_1, ..., AB_d, n of each."""
    missing = values.missing()
    if missing:
        raise InputError(
            f"{subject}: {int((~values.has).sum())} of {len(values.has)} rows have no value ({missing}), and Sobol "
            "indices need all; run what is not run yet with resume=True, and where rows fail narrow the ranges of the "
            "parameters (Sweep.failed() has their messages), or sweep sample='latin:N', whose indices come from a "
            "surface through the rows that there are"
        )
    if n & (n - 1):
        raise InputError(f"{subject}: a sample of 'saltelli:{n}' is not possible; use a power of two")
    return _indices(subject, values.name, names, values.numbers, n, f"from {len(values.numbers)} rows", False)


def of_surface(table: Table, found: Surface, where: Mapping[str, Any] | None = None) -> Sensitivities:
    """Indices from points of a response surface through the rows `where`."""
    rows = chosen_rows(table, where)
    names, n = tuple(found.ranges), SURFACE_POINTS
    q = saltelli(n, len(names), SEED)
    point = {}
    for name, at in zip(names, q.T, strict=True):
        column = np.sort(axis_of(table, name).positions[rows])
        point[name] = np.interp(at, np.linspace(0.0, 1.0, len(column)), column)
    method = (
        f"of a response surface through {found.rows} rows, whose error is {found.relative_error:.2g} of the standard "
        f"deviation" + (f"; {found.note}" if found.note else "")
    )
    return _indices(f"sensitivities of {found.name!r}", found.name, names, found(point), n, method, True)


def _indices(
    subject: str, name: str, names: tuple[str, ...], y: np.ndarray, n: int, method: str, of_surface: bool
) -> Sensitivities:
    """Estimate and bootstrap, from outputs y at the points A, B, AB_1, ..., AB_d, n of each."""
    if len(names) < 2:
        raise InputError(f"{subject}: {''.join(names)} varies alone, so all variance is due to it; vary two parameters")
    if np.ptp(y) <= CONSTANT * np.abs(y).max():
        raise InputError(f"{subject}: it is {y[0]:g} in all rows, so there is no variance")
    parts, rng = y.reshape(len(names) + 2, n), np.random.default_rng(SEED)
    first, total = _estimated(parts, np.arange(n))
    # scipy's bootstrap uses the global random state of the process; this one is reproducible
    drawn = np.array([_estimated(parts, rng.integers(0, n, n)) for _ in range(RESAMPLES)])
    bounds = np.quantile(drawn, [0.5 * (1.0 - CONFIDENCE), 0.5 * (1.0 + CONFIDENCE)], axis=0)  # (2, order, d)
    return Sensitivities(name, names, first, total, bounds[:, 0].T, bounds[:, 1].T, method, of_surface)


def _estimated(parts: np.ndarray, chosen: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """First and total order (d,) from the `chosen` points of `parts` (2 + d, n)."""
    f_A, f_B, *f_AB = parts[:, None, chosen]
    found = sobol_indices(func={"f_A": f_A, "f_B": f_B, "f_AB": np.stack(f_AB)}, n=len(chosen))
    return np.ravel(found.first_order), np.ravel(found.total_order)
