"""One quantity of a run by its name, and nothing else of the run evaluated.

A name is what `to_dataframe` calls a column, the same without its component for all of them, or a field of the results
file, which has places besides time:

    contact_force_z[roller on plate]     (T,)
    contact_force[roller on plate]       (T, axis)
    contact_pressure[roller on plate]    (T, column, row)
    energy[kinetic], sensor_x[place], iterations
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from difflib import get_close_matches
from typing import Any

import numpy as np

from warpffrf.model.errors import InputError
from warpffrf.output.files.dataset import owner_groups
from warpffrf.output.files.fields import COMPONENTS, RUN_FIELDS, SIZES, Field, of_owner
from warpffrf.output.files.table import MOST_NEAR, Series, energies, histories, series_of, series_of_sensor


class NoQuantity(InputError):
    """A name that the run does not have."""


@dataclass(frozen=True, eq=False)
class Quantity:
    """`values` (T, ...) with the names `dims` of all axes but the first, which is time; unit and frame."""

    values: np.ndarray
    dims: tuple[str, ...]
    units: str
    frame: str


def quantity(result: Any, name: str) -> Quantity:
    """The quantity of a `Result` that is called `name`. Raises `NoQuantity`, an `InputError`, with the nearest names
    for one that there is not."""
    base, bracket, owner = name.partition("[")
    owner = owner.removesuffix("]") if bracket else ""
    if bracket and not name.endswith("]"):
        raise NoQuantity(f"the result has no quantity {name!r}; write NAME[OWNER]")
    for series in _series_called(result, base, owner):
        if name == series.label:
            whole = series.components != ("",)
            values = np.asarray(series.values, dtype=float)
            dims = (_dimension(series),) if whole else ()
            return Quantity(values if whole else values[:, 0], dims, series.units, series.frame)
        if name in (columns := series.columns):
            return Quantity(np.asarray(columns[name], dtype=float), (), series.units, series.frame)
    for field, thing in _fields_of(result, owner):
        if field.name == base:
            dims = tuple(d if d in SIZES else f"{d}_{owner}" for d in field.dims)
            return Quantity(np.asarray(getattr(thing, field.attribute)), dims, field.units, field.frame)
    raise _unknown(result, name)


def _dimension(series: Series) -> str:
    """What the components of a series run along: of those that have the same names everywhere, their dimension."""
    for dim, names in COMPONENTS.items():
        if names == series.components:
            return dim
    return f"component_{series.owner}"


def _series_called(result: Any, base: str, owner: str) -> Iterator[Series]:
    """The histories whose name begins `base`, of one owner."""
    history = result.history
    if not owner:
        for field in RUN_FIELDS:
            if field.name == base and base != "time":
                values = np.asarray(getattr(history, field.attribute))[:, None]
                yield Series(field.name, "", ("",), field.units, field.frame, values)
        return
    for field, thing in _fields_of(result, owner):
        if base.startswith(field.name) and (series := series_of(of_owner(field, thing), owner, thing)) is not None:
            yield series
    if base.startswith("sensor") and owner in result.sensor_names:
        yield series_of_sensor(result, owner)
    if base == "energy" and owner in history.energy:
        yield from (series for series in energies(result) if series.owner == owner)


def _fields_of(result: Any, owner: str) -> Iterator[tuple[Field, Any]]:
    for _, fields, owners in owner_groups(result):
        if owner in owners:
            yield from ((of_owner(field, owners[owner]), owners[owner]) for field in fields)


def _unknown(result: Any, name: str) -> NoQuantity:
    known = [known for series in histories(result) for known in series.columns]
    known += [
        f"{field.name}[{owner}]"
        for _, fields, owners in owner_groups(result)
        for owner in owners
        for field in fields
        if field.dims
    ]
    near = get_close_matches(name, known, n=MOST_NEAR, cutoff=0.3) or known[:MOST_NEAR]
    return NoQuantity(
        f"the result has no quantity {name!r}; near to it: {', '.join(map(repr, near))}; Result.to_dataframe and "
        "to_csv have all histories"
    )
