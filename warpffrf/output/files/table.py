"""The histories of a run as a table: one row per saved step, one column per scalar history.

A history has no dimension except time and a few named components: forces, motions, approaches, losses, sensors and
energies, but no pressure fields and no modal coordinates. Column names consist of quantity, component and owner:

    contact_force_z[roller on plate]      [N]
    body_position_x[roller]               [m]
    sensor_von_mises[root]                [Pa]
    energy[kinetic]                       [J]

Quantities, units and frames are those of the results file (`fields.py`).

Dataset. A run as an xarray dataset: the names, units and frames of the results file.

Quantities. One quantity of a run by its name, without evaluating any other.

A name is a column name of `to_dataframe`, the same without component for all components, or a field of the results
file, which has dimensions in addition to time:

    contact_force_z[roller on plate]     (T,)
    contact_force[roller on plate]       (T, axis)
    contact_pressure[roller on plate]    (T, column, row)
    energy[kinetic], sensor_x[place], iterations
"""

from __future__ import annotations

import csv
import os
from collections.abc import Iterator
from dataclasses import dataclass
from difflib import get_close_matches
from pathlib import Path
from typing import Any

import numpy as np

from warpffrf.model.errors import InputError
from warpffrf.model.files.paths import check_ending, checked_output_path, written_whole
from warpffrf.output.files.fields import (
    BODY_FIELDS,
    CELL_FIELDS,
    COMPONENTS,
    CONTACT_FIELDS,
    DERIVED_FIELDS,
    ENERGY_UNITS,
    FILM_FIELDS,
    FILM_HEAT_FIELDS,
    FILM_POSITIONS,
    FILM_SECOND_FIELDS,
    FORCE_FIELDS,
    FRICTION_DERIVED,
    FRICTION_FIELDS,
    JOINT_FIELDS,
    JOINT_FRICTION_FIELDS,
    LUMPED_FIELDS,
    RUN_FIELDS,
    SIZES,
    SMALL_SLIDING_CELLS,
    SMALL_SLIDING_DERIVED,
    SMALL_SLIDING_FIELDS,
    Field,
    of_owner,
)

NUMBERED = ("coordinate", "lamina")  # dimensions with a few entries of one owner, numbered from 0
MOST_NEAR = 4  # similar names listed for an unknown name
TIME_HEADER = "time [s]"
FIRST_CELLS = (TIME_HEADER, "step_size [s]", "iterations [1]")  # identify a CSV file written by warpffrf


@dataclass(frozen=True, eq=False)
class Series:
    """One history: `values` (T, components) of the quantity `name` of `owner` ("" for the run), the names of the
    components (("",) for a scalar), unit and frame."""

    name: str
    owner: str
    components: tuple[str, ...]
    units: str
    frame: str
    values: np.ndarray

    @property
    def label(self) -> str:
        """Name and owner, such as "contact_force[roller on plate]"."""
        return _label(self.name, "", self.owner)

    @property
    def columns(self) -> dict[str, np.ndarray]:
        """Each component (T,) by its column name, such as "contact_force_z[roller on plate]"."""
        named = zip(self.components, self.values.T, strict=True)
        return {_label(self.name, component, self.owner): values for component, values in named}


def _label(name: str, component: str, owner: str) -> str:
    return name + (f"_{component}" if component else "") + (f"[{owner}]" if owner else "")


def histories(result: Any) -> list[Series]:
    """Every history of a `Result` except time, in the order of the results file; coordinates that a joint does not have
    are omitted."""
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
    """The history of one owner; None for spatial and modal fields, and for quantities that the owner does not have."""
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
    """Values (T,) and unit of one column. Raises `InputError` with similar names for an unknown one."""
    known: dict[str, tuple[np.ndarray, str]] = {}
    for series in histories(result):
        known |= {column: (np.asarray(values, float), series.units) for column, values in series.columns.items()}
    if name in known:
        return known[name]
    near = get_close_matches(name, known, n=MOST_NEAR, cutoff=0.3) or list(known)[:MOST_NEAR]
    said = ", ".join(map(repr, near))
    raise InputError(f"the result has no history {name!r}; similar names: {said}; to_dataframe and to_csv list all")


def to_dataframe(result: Any) -> Any:
    """A `pandas.DataFrame` of the histories: index `time` [s], units by column in `.attrs["units"]`. Raises ImportError
    with the remedy if pandas is not installed."""
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
    """Write the histories as comma-separated values; the first line has names and units, numbers have full precision.

    Raises InputError for a path that does not end in .csv or cannot be written, and for an existing file, unless
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
    """Whether a file is empty or starts as `write_csv` does."""
    with file.open("rb") as stream:
        start = stream.read(200).decode("utf-8", "replace")
    return not start or start.startswith(",".join(FIRST_CELLS))


def stacked(field: Field, owners: list[Any], steps: int) -> np.ndarray:
    """The quantity of all owners as one array (time, owner, ...)."""
    if not owners:
        return np.zeros((steps, 0) + tuple(SIZES[d] for d in field.dims))
    return np.stack([np.asarray(getattr(owner, field.attribute)) for owner in owners], axis=1)


Group = tuple[str, tuple[Field, ...], dict[str, Any]]


def owner_groups(result: Any) -> tuple[Group, ...]:
    """Owners of histories: (dimension of the owners, their fields, owner by name), stored and derived; bodies, joints,
    forces and contacts always, the rest if there are any."""
    history = result.history
    contacts = {name: result.contact(name) for name in history.contacts}
    rubbing = {name: contact.friction for name, contact in contacts.items() if contact.has_friction}
    cells = {name: contact.cells for name, contact in history.contacts.items() if contact.cells is not None}
    stuck = {name: force.friction for name, force in history.forces.items() if force.friction is not None}
    small_sliding = {name: result.contact(name) for name in history.small_sliding}
    yielding = {name: film for name, film in history.films.items() if film.load_second is not None}
    warm = {name: film for name, film in history.films.items() if film.temperature is not None}
    return (
        ("body", BODY_FIELDS, history.bodies),
        ("joint", JOINT_FIELDS, history.joints),
        ("force", FORCE_FIELDS, history.forces),
        ("pair", CONTACT_FIELDS, history.contacts),
        ("pair", DERIVED_FIELDS, contacts),
        *([("joint_friction", JOINT_FRICTION_FIELDS, stuck)] if stuck else []),
        *([("lumped_contact", LUMPED_FIELDS, history.lumped_contacts)] if history.lumped_contacts else []),
        *([("film", FILM_FIELDS, history.films)] if history.films else []),
        *([("film", FILM_SECOND_FIELDS, yielding)] if yielding else []),
        *([("film_heat", FILM_HEAT_FIELDS, warm)] if warm else []),
        *(
            [
                ("small_sliding", SMALL_SLIDING_FIELDS, history.small_sliding),
                ("small_sliding", SMALL_SLIDING_DERIVED, small_sliding),
            ]
            if small_sliding
            else []
        ),
        *([("cell_pair", CELL_FIELDS, cells)] if cells else []),
        *([("friction_pair", (*FRICTION_FIELDS, *FRICTION_DERIVED), rubbing)] if rubbing else []),
    )


def to_xarray(result: Any) -> Any:
    """`xarray.Dataset`; quantities whose shape differs between owners have names such as `contact_pressure_<pair>`."""
    try:
        import xarray as xr
    except ImportError as error:
        raise ImportError("to_xarray needs xarray: pip install 'warpffrf[arrays]'") from error

    history = result.history
    steps = len(history.time)
    data: dict[str, Any] = {}
    always = ("axis", "quaternion", "direction")
    coords: dict[str, Any] = {dim: list(COMPONENTS[dim]) for dim in always}
    for field in RUN_FIELDS:
        entry = (("time",), getattr(history, field.attribute), _attributes(field))
        (coords if field.name == "time" else data)[field.name] = entry
    contacts = {name: result.contact(name) for name in history.contacts}
    cells = {name for name, contact in history.contacts.items() if contact.cells is not None}
    small_sliding = {name: result.contact(name) for name in history.small_sliding}
    groups = owner_groups(result)
    present = {dim for dim, _, _ in groups}
    for dim, owner in (
        ("slip", "joint_friction"), ("chart_axis", "film"), ("along", "small_sliding"), ("frame_axis", "small_sliding"),
        ("side", "small_sliding"),
    ):  # fmt: skip
        if owner in present:
            coords[dim] = list(COMPONENTS[dim])
    for dim, fields, owners in groups:
        coords[dim] = np.array(list(owners), dtype=object if owners else str)
        for field in fields:
            if field.stacked:
                data[field.name] = (
                    ("time", dim, *field.dims),
                    stacked(field, list(owners.values()), steps),
                    _attributes(field),
                )
                continue
            for name, owner in owners.items():
                second = "_second" if field.name.endswith("_second") else ""
                dims = tuple(d if d in SIZES else f"{d}{second}_{name}" for d in field.dims)
                about = _attributes(of_owner(field, owner))
                data[f"{field.name}_{name}"] = (("time", *dims), getattr(owner, field.attribute), about)
    for place, prefix in enumerate(("joint_coordinate", "joint_second_coordinate")):
        names = [joint.names[place] if place < len(joint.names) else "" for joint in history.joints.values()]
        coords[f"{prefix}_name"] = (("joint",), np.array(names, dtype=object if names else str))
    for name, contact in contacts.items():
        if name not in cells:  # moving rows, see contact_cell_z
            z = np.asarray(contact.view.first.grid.z)
            about = {"units": "m", "frame": "along the axis of the first surface"}
            coords[f"row_{name}"] = ((f"row_{name}",), z, about)
        arc = {"units": "m", "frame": "first surface, from the line of centres"}
        coords[f"arc_{name}"] = (("time", f"column_{name}"), contact.arc, arc)
    for name in result.film_names:
        for field in FILM_POSITIONS:
            dim = f"{field.dims[0]}_{name}"
            coords[dim] = ((dim,), getattr(result.film(name), field.attribute), _attributes(field))
    for name, contact in small_sliding.items():
        for field in SMALL_SLIDING_CELLS:
            dims = tuple(d if d in SIZES else f"{d}_{name}" for d in field.dims)
            coords[f"{field.name}_{name}"] = (dims, getattr(contact.view, field.attribute), _attributes(field))
    for name in result.sensor_names:
        sensor = result.sensor(name)
        coords[f"component_{name}"] = list(sensor.components)
        about = {"units": sensor.unit, "frame": sensor.frame}
        data[f"sensor_{name}"] = (("time", f"component_{name}"), sensor.values, about)
    coords["energy_line"] = list(history.energy)
    lines = np.stack(list(history.energy.values()), axis=1) if history.energy else np.zeros((steps, 0))
    data["energy"] = (("time", "energy_line"), lines, {"units": ENERGY_UNITS, "frame": "none"})
    return xr.Dataset(data, coords=coords, attrs={"status": str(result.status), "message": result.message})


def _attributes(field: Field) -> dict[str, str]:
    return {"units": field.units, "frame": field.frame}


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
    """The quantity called `name` of a `Result`. Raises `NoQuantity`, an `InputError`, with similar names for an unknown
    one."""
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
    """Dimension of the components of a series, if their names are the same for all owners."""
    for dim, names in COMPONENTS.items():
        if names == series.components:
            return dim
    return f"component_{series.owner}"


def _series_called(result: Any, base: str, owner: str) -> Iterator[Series]:
    """The histories whose name starts with `base`, of one owner."""
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
        f"the result has no quantity {name!r}; similar names: {', '.join(map(repr, near))}; Result.to_dataframe and "
        "to_csv have all histories"
    )
