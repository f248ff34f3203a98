"""One output over the rows of a sweep, in a suitable unit, and rows without a value."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np

from warpffrf.model.errors import InputError, unknown_name
from warpffrf.output.files.fields import COMPONENTS

COMPLETED, WAITING = "completed", ""
SAME = 1e-9  # relative: covers omitted digits, but not a neighbour on a fine grid
TIME = "time"
# unit -> display units, from the largest: (least value for it, name, factor)
SHOWN: dict[str, tuple[tuple[float, str, float], ...]] = {
    "Pa": ((1e5, "MPa", 1e-6), (1e2, "kPa", 1e-3)),
    "N": ((1e4, "kN", 1e-3),),
    "m": ((0.5, "m", 1.0), (5e-4, "mm", 1e3), (0.0, "um", 1e6)),
    "s": ((1.0, "s", 1.0), (0.0, "ms", 1e3)),
}


class Table(Protocol):
    """Interface of a sweep for its evaluation."""

    @property
    def definition(self) -> Mapping[str, Any]:
        """Definition of the sweep: title, call, sample, seed, and the texts of `parameters` and `outputs` by name."""
        ...

    @property
    def parameter_names(self) -> Sequence[str]:
        """Names of the parameters."""
        ...

    @property
    def output_names(self) -> Sequence[str]:
        """Names of the outputs."""
        ...

    def __getitem__(self, name: str) -> np.ndarray:
        """A variable (run, ...). Raises `InputError` for an unknown name."""
        ...

    def about(self, name: str) -> tuple[tuple[str, ...], str]:
        """Names of the axes of a variable after `run`, and its unit."""
        ...


@dataclass(frozen=True, eq=False)
class Values:
    """Output `name` in SI units, NaN for rows without a value: `numbers` (run,), or (run, time) at `time` [s] of the
    same shape. `status` (run,) is that of the rows; `text` defines the output."""

    name: str
    text: str
    unit: str
    numbers: np.ndarray
    status: np.ndarray
    time: np.ndarray | None = None

    @property
    def has(self) -> np.ndarray:
        """(run,): which rows were completed and have a value, for a history at least one."""
        finite = np.isfinite(self.numbers)
        return (self.status == COMPLETED) & (finite if finite.ndim == 1 else finite.any(axis=1))

    def missing(self, rows: np.ndarray | None = None) -> str:
        """Number of the `rows` (run,), None for all, without a value, by status, as "2 failed, 1 not run yet"; "" if
        all have one."""
        without = ~self.has if rows is None else ~self.has & rows
        counts = Counter(map(str, self.status[without]))
        names = {WAITING: "not run yet", COMPLETED: "without a value"}
        return ", ".join(f"{n} {names.get(status, status)}" for status, n in counts.items())

    def shown(self) -> tuple[float, str]:
        """Display factor of SI values, and the label of the axis with the unit."""
        factor, unit = shown_in(self.unit, self.numbers)
        return factor, f"{self.name} [{unit}]" if unit else self.name


def shown_in(unit: str, values: np.ndarray) -> tuple[float, str]:
    """Display factor of SI `values`, and the display unit."""
    finite = np.abs(values[np.isfinite(values)])
    top = float(finite.max(initial=0.0))
    for least, name, factor in SHOWN.get(unit, ()):
        if top >= least and top > 0.0:
            return factor, name
    return 1.0, unit


def values_of(table: Table, output: str, component: str | int | None = None) -> Values:
    """The output, for a vector the `component` "x", "y", "z" or its number.

    Raises `InputError` for an unknown output, an unknown component, and if an output then has more than one number per
    row, or per time.
    """
    if output not in table.output_names:
        raise unknown_name("sweep: output", output, table.output_names)
    numbers = np.asarray(table[output], dtype=float)
    dims, unit = table.about(output)
    dims = dims[: numbers.ndim - 1]  # if no run has it yet: one number per row
    others = [dim for dim in dims if dim != TIME]
    text, name = str(table.definition["outputs"][output]), output
    if component is not None:
        numbers, label = _component(output, numbers, dims, component)
        others, name = others[:-1], f"{output}, {label}"
    if others:
        raise InputError(
            f"sweep: output {output!r} has {numbers.shape[-1]} values along {others[-1]!r} in a row and not one; name "
            f"one with component=, {_components(others[-1], numbers.shape[-1])}, or sweep an output that is one number"
        )
    return Values(name, text, unit, numbers, table["status"], _times(table) if TIME in dims else None)


def _component(output: str, numbers: np.ndarray, dims: tuple[str, ...], component: str | int) -> tuple[np.ndarray, str]:
    """The component of the last axis, and its name."""
    if not dims or dims[-1] == TIME:
        raise InputError(f"sweep: output {output!r} has no components; leave component= out")
    known = COMPONENTS.get(dims[-1], ())
    size = numbers.shape[-1]
    n = known.index(component) if component in known else component
    if isinstance(n, bool) or not isinstance(n, int) or not 0 <= n < size:
        raise InputError(
            f"sweep: output {output!r} has no component {component!r}; there are {_components(dims[-1], size)}"
        )
    return numbers[..., n], str(component)


def _components(dim: str, size: int) -> str:
    return ", ".join(map(repr, COMPONENTS[dim])) if dim in COMPONENTS else f"0 to {size - 1}"


def _times(table: Table) -> np.ndarray:
    """(run, time) [s]."""
    try:
        return table["time_of_run"]
    except InputError:  # all rows have the same times
        time = table[TIME]
        return np.broadcast_to(time, (len(table["status"]), len(time)))


def _has_value(name: str, column: np.ndarray, wanted: str) -> np.ndarray:
    """(run,): which texts of the parameter equal `wanted`."""
    same = column == wanted
    if not np.any(same):
        raise unknown_name(f"sweep: where: value of {name!r}", wanted, list(map(str, np.unique(column))))
    return same


def _has_number(name: str, column: np.ndarray, wanted: Any) -> np.ndarray:
    """(run,): which numbers of the parameter equal `wanted`."""
    try:
        number = float(wanted)
    except (TypeError, ValueError):
        raise InputError(f"sweep: where: {name} is a number in all rows, got {wanted!r}; give one of them") from None
    same = np.isclose(column.astype(float), number, rtol=SAME, atol=0.0)
    if not np.any(same):
        known = np.unique(column)
        near = known[np.argmin(np.abs(known.astype(float) - number))]
        raise InputError(f"sweep: where: no row has {name} = {wanted}; the nearest value is {near}")
    return same


def chosen_rows(table: Table, where: Mapping[str, Any] | None) -> np.ndarray:
    """(run,): the rows whose parameters have the values `where`. Raises `InputError` for unknown names, and if no row
    has a value, with the nearest available one."""
    rows = np.ones(len(table["status"]), dtype=bool)
    for name, wanted in (where or {}).items():
        if name not in table.parameter_names:
            raise unknown_name("sweep: parameter", name, table.parameter_names)
        column = table[name]
        rows &= _has_value(name, column, str(wanted)) if column.dtype == object else _has_number(name, column, wanted)
    if not rows.any():
        raise InputError(f"sweep: where: no row has {', '.join(f'{k} = {v}' for k, v in (where or {}).items())}")
    return rows
