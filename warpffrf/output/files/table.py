"""The histories of a run as a table: a row for each saved step, a column for each number that has a history.

A history is what has no dimension besides time and a few named components: forces, motions, approaches, losses, sensors
and energies, but no pressure fields and no modal coordinates. Columns are called by quantity, component and owner:

    contact_force_z[roller on plate]      [N]
    body_position_x[roller]               [m]
    sensor_von_mises[root]                [Pa]
    energy[kinetic]                       [J]

Quantities, units and frames are those of the results file (`fields.py`).
"""

from __future__ import annotations

import csv
import os
from dataclasses import dataclass
from difflib import get_close_matches
from pathlib import Path
from typing import Any

import numpy as np

from warpffrf.model.errors import InputError
from warpffrf.model.files.output_paths import check_ending, checked_output_path, written_whole
from warpffrf.output.files.dataset import owner_groups
from warpffrf.output.files.fields import COMPONENTS, ENERGY_UNITS, RUN_FIELDS, Field, of_owner

NUMBERED = ("coordinate", "lamina")  # dimensions with a few entries of one owner, numbered from 0
MOST_NEAR = 4  # names in the answer to one that there is not
TIME_HEADER = "time [s]"
FIRST_CELLS = (TIME_HEADER, "step_size [s]", "iterations [1]")  # of a CSV file of ours: by them it is known


@dataclass(frozen=True, eq=False)
class Series:
    """One history: `values` (T, components) of the quantity `name` of `owner` ("" of the run), what the components are
    called (("",) of a scalar), unit and frame."""

    name: str
    owner: str
    components: tuple[str, ...]
    units: str
    frame: str
    values: np.ndarray

    @property
    def label(self) -> str:
        """Name and owner, as "contact_force[roller on plate]"."""
        return _label(self.name, "", self.owner)

    @property
    def columns(self) -> dict[str, np.ndarray]:
        """Each component (T,) by its column's name, as "contact_force_z[roller on plate]"."""
        named = zip(self.components, self.values.T, strict=True)
        return {_label(self.name, component, self.owner): values for component, values in named}


def _label(name: str, component: str, owner: str) -> str:
    return name + (f"_{component}" if component else "") + (f"[{owner}]" if owner else "")


def histories(result: Any) -> list[Series]:
    """Every history of a `Result` but its time, in the order of the results file; coordinates that a joint does not
    have are left out."""
    history = result.history
    found = [
        Series(field.name, "", ("",), field.units, field.frame, np.asarray(getattr(history, field.attribute))[:, None])
        for field in RUN_FIELDS
        if field.name != "time"
    ]
    for _, fields, owners in owner_groups(result):
        found += [
            series
            for field in fields
            for name, owner in owners.items()
            if (series := series_of(of_owner(field, owner), name, owner)) is not None
        ]
    found += [series_of_sensor(result, name) for name in result.sensor_names]
    return [*found, *energies(result)]


def energies(result: Any) -> list[Series]:
    """The lines of the energy ledger."""
    return [
        Series("energy", line, ("",), ENERGY_UNITS, "none", np.asarray(values)[:, None])
        for line, values in result.history.energy.items()
    ]


def series_of_sensor(result: Any, name: str) -> Series:
    """The history of a sensor."""
    sensor = result.sensor(name)
    return Series("sensor", name, tuple(sensor.components), sensor.unit, sensor.frame, sensor.values)


def series_of(field: Field, name: str, owner: Any) -> Series | None:
    """The history of one owner; None for fields over places and modes, and for what the owner does not have."""
    if len(field.dims) > 1 or not {*field.dims} <= {*COMPONENTS, *NUMBERED}:
        return None
    values = np.asarray(getattr(owner, field.attribute))
    if field.dims and field.dims[0] in COMPONENTS:
        components = COMPONENTS[field.dims[0]]
    elif field.dims:
        components = tuple(str(n) for n in range(values.shape[1]))
        if not components:
            return None
    else:
        components, values = ("",), values[:, None]
    units = field.units
    if field.name in ("joint_coordinate", "joint_second_coordinate"):
        if not np.isfinite(values).any():
            return None
        place = 1 if field.name == "joint_second_coordinate" else 0
        if place < len(owner.names):
            units = "rad" if owner.names[place].endswith("rotation") else "m"
    return Series(field.name, name, components, units, field.frame, values)


def column(result: Any, name: str) -> tuple[np.ndarray, str]:
    """Values (T,) and unit of one column. Raises `InputError` with the nearest names for one that there is not."""
    known: dict[str, tuple[np.ndarray, str]] = {}
    for series in histories(result):
        known |= {column: (np.asarray(values, float), series.units) for column, values in series.columns.items()}
    if name in known:
        return known[name]
    near = get_close_matches(name, known, n=MOST_NEAR, cutoff=0.3) or list(known)[:MOST_NEAR]
    said = ", ".join(map(repr, near))
    raise InputError(f"the result has no history {name!r}; near to it: {said}; to_dataframe and to_csv have all")


def to_dataframe(result: Any) -> Any:
    """A `pandas.DataFrame` of the histories: index `time` [s], units by column in `.attrs["units"]`. Raises ImportError
    with the cure where pandas is not installed."""
    try:
        import pandas
    except ImportError as error:
        raise ImportError(
            "to_dataframe needs pandas: pip install 'warpffrf[tables]'; to_csv writes the same table without it"
        ) from error
    found = histories(result)
    columns = {name: values for series in found for name, values in series.columns.items()}
    frame = pandas.DataFrame(columns, index=pandas.Index(result.time, name="time"))
    frame.attrs["units"] = {name: series.units for series in found for name in series.columns}
    return frame


def write_csv(result: Any, path: str | os.PathLike[str], *, overwrite: bool = False) -> Path:
    """Write the histories as comma-separated values, the first line with names and units, numbers in full.

    Raises InputError for a path that does not end in .csv or cannot be written, and for a file that exists, unless
    `overwrite` is set and its first line is that of such a table.
    """
    check_ending(path, "to_csv", (".csv",))
    target = checked_output_path(path, "to_csv", overwrite=overwrite, ours=_is_table)
    found = histories(result)
    header = [TIME_HEADER, *(f"{name} [{series.units}]" for series in found for name in series.columns)]
    columns = [result.time, *(values for series in found for values in series.columns.values())]
    with written_whole(target) as partial, partial.open("w", encoding="utf-8", newline="") as file:
        table = csv.writer(file)
        table.writerow(header)
        table.writerows(zip(*(np.asarray(values).tolist() for values in columns), strict=True))
    return target


def _is_table(file: Path) -> bool:
    """Whether a file is empty or begins as `write_csv` does."""
    with file.open("rb") as stream:
        start = stream.read(200).decode("utf-8", "replace")
    return not start or start.startswith(",".join(FIRST_CELLS))
