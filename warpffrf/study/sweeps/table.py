"""All rows of a sweep in one HDF5 file with the layout of netCDF-4, so that xarray opens it lazily.

    import xarray
    xarray.open_dataset("crown.sweep/table.h5", engine="h5netcdf")

Every variable has the dimension `run`: parameters, which are coordinates; status, message, wall_seconds,
set_up_seconds, device, host, versions and worlds (how many rows ran in one graph); outputs, those with times as (run,
time, ...). `time` is a coordinate if all runs were saved at the same times, up to the `saved_steps` of each; else
`time_of_run` (run, time) has those of each. Numbers that a run does not have are NaN, and arrays are as large as the
largest run's. `error_budget` (run, error_source) is the largest size of each source over the quantities of a run.

HDF5 is used instead of Zarr: h5py is already required for results and bodies; 100,000 runs of ten histories are one
file instead of some thousands, which is moved, copied and checked as one, with the checksum of all HDF5 files of the
package (`model/files/sealed_file.py`). The advantage of Zarr, many concurrent writers, is not needed, because one
process writes (`folder.py`); the weakness of HDF5, a kill while writing, does not matter, because the file is built in
memory and renamed.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np

from warpffrf.model.errors import InputError
from warpffrf.model.files import hdf5_parts
from warpffrf.model.files.hdf5_parts import probe
from warpffrf.model.files.sealed_file import check_schema, verify, written_sealed
from warpffrf.output.files.fields import COMPONENTS
from warpffrf.study.sweeps.design import Row
from warpffrf.study.sweeps.job import FAILED, TIME, Answer, Value

MARK, SCHEMA = "warpffrf sweep table", 1
RUN, TIME_OF_RUN, SAVED, BUDGET, SOURCE = "run", "time_of_run", "saved_steps", "error_budget", "error_source"
TEXTS = ("status", "message", "device", "host", "versions")
NUMBERS = {"wall_seconds": "s", "set_up_seconds": "s", "worlds": "1"}  # name -> unit
TAKEN = (RUN, TIME, TIME_OF_RUN, SAVED, BUDGET, SOURCE, *TEXTS, *NUMBERS, *COMPONENTS)  # reserved names
NO_VARIABLE = "This is a netCDF dimension but not a netCDF variable."  # netCDF's mark of a dimension without coordinate
CURE = "take the table of another copy, or run the sweep again"
PACKED_FROM = 4096  # bytes; smaller arrays are not compressed


@dataclass
class Column:
    """One output of all runs: `array` (run, ...) and its further axes."""

    array: np.ndarray
    dims: tuple[str, ...]
    units: str
    frame: str


@dataclass
class Table:
    """All rows, in memory. A row that has not been run has the status ""."""

    parameters: dict[str, np.ndarray]
    texts: dict[str, np.ndarray]  # (run,) of texts
    numbers: dict[str, np.ndarray]
    columns: dict[str, Column] = field(default_factory=dict)
    time: np.ndarray | None = None  # (run, time)
    budget: dict[str, np.ndarray] = field(default_factory=dict)  # source of errors -> (run,)

    @classmethod
    def empty(cls, names: Sequence[str], rows: Sequence[Row]) -> Table:
        """The table of rows that have not been run."""
        texts = {name: np.full(len(rows), "", dtype=object) for name in TEXTS}
        numbers = {name: np.full(len(rows), np.nan) for name in NUMBERS}
        return cls({name: _values([row[name] for row in rows]) for name in names}, texts, numbers)

    @property
    def count(self) -> int:
        """Total number of rows."""
        return len(self.texts["status"])

    def done(self) -> set[int]:
        """Indices of the rows that have been run."""
        return {int(n) for n in np.flatnonzero(self.texts["status"] != "")}

    def add(self, answer: Answer) -> None:
        """Store a run in its row. A run whose arrays have other axes than earlier ones, or axes with names of other
        items of the table, counts as failed."""
        n = answer.number
        for name in (*TEXTS, *NUMBERS):
            (self.texts if name in TEXTS else self.numbers)[name][n] = getattr(answer, name)
        fault = self._fault(answer.values)
        if fault:
            self.texts["status"][n], self.texts["message"][n] = FAILED, fault
            return
        for name, value in answer.values.items():
            column = self.columns.get(name)
            if column is None:
                empty = np.full((self.count, *value.array.shape), np.nan)
                column = self.columns[name] = Column(empty, value.dims, value.units, value.frame)
            column.array = _with_row(column.array, n, value.array)
        if answer.time is not None:
            if self.time is None:
                self.time = np.full((self.count, len(answer.time)), np.nan)
            self.time = _with_row(self.time, n, answer.time)
        for source, size in answer.budget.items():
            self.budget.setdefault(source, np.full(self.count, np.nan))[n] = size

    def _fault(self, values: Mapping[str, Value]) -> str:
        """The reason why the values of a run cannot be stored in the table, or ""."""
        names = {*TAKEN, *self.parameters, *values} - {TIME, *COMPONENTS}
        for name, value in values.items():
            column = self.columns.get(name)
            if column is not None and column.array.ndim != value.array.ndim + 1:
                return f"output {name!r} has {value.array.ndim} axes, earlier runs have others"
            for dim in value.dims:
                if dim in names:
                    return f"an axis of output {name!r} is called {dim!r}, as something else is; rename that"
        return ""

    # --- the file

    def write(self, path: Path) -> None:
        """Write the table to `path` atomically. Raises OSError."""
        with written_sealed(path) as file:
            file.attrs.update({"format": MARK, "schema": SCHEMA})
            file.attrs["coordinates"] = " ".join(name for name in self.parameters if not any(map(str.isspace, name)))
            writer = _Writer(file)
            writer.coordinate(RUN, np.arange(self.count))
            for name, values in self.parameters.items():
                writer.variable(name, values, (RUN,), {"parameter": "yes"})
            for name, texts in self.texts.items():
                writer.variable(name, texts, (RUN,), {})
            for name, values in self.numbers.items():
                writer.variable(name, values, (RUN,), {"units": NUMBERS[name]})
            if self.time is not None:
                self._write_times(writer, self.time)
            for name, column in self.columns.items():
                about = {"units": column.units, "frame": column.frame, "output": "yes"}
                writer.variable(name, column.array, (RUN, *column.dims), about)
            if self.budget:
                writer.coordinate(SOURCE, np.array(list(self.budget), dtype=object))
                sizes = np.stack(list(self.budget.values()), axis=1)
                writer.variable(BUDGET, sizes, (RUN, SOURCE), {"units": "1"})
        _written.add((path.absolute(), _state(path)))

    def _write_times(self, writer: _Writer, times: np.ndarray) -> None:
        writer.variable(SAVED, np.isfinite(times).sum(axis=1), (RUN,), {})
        longest = times[np.argmax(np.isfinite(times).sum(axis=1))]
        if np.all(np.isnan(times) | (times == longest)):
            writer.coordinate(TIME, longest, {"units": "s"})
        else:
            writer.variable(TIME_OF_RUN, times, (RUN, TIME), {"units": "s"})

    @classmethod
    def read(cls, path: Path, count: int) -> Table:
        """The table in `path`, which has `count` rows. Raises `InputError` for another file."""
        subject = f"sweep: {path}"
        with opened(path) as file:
            kinds: dict[str, dict[str, Any]] = {"parameter": {}, "output": {}}
            for name in file:
                for kind in kinds:
                    if kind in file[name].attrs:
                        kinds[kind][name] = file[name]
            texts = {name: texts_of(file, name) for name in TEXTS}
            numbers = {name: hdf5_parts.read(file, name) for name in NUMBERS}
            found = cls({name: values_of(file, name) for name in kinds["parameter"]}, texts, numbers)
            for name, data in kinds["output"].items():
                units, frame = str(data.attrs["units"]), str(data.attrs["frame"])
                found.columns[name] = Column(hdf5_parts.read(file, name), axes_of(data), units, frame)
            if TIME_OF_RUN in file:
                found.time = hdf5_parts.read(file, TIME_OF_RUN)
            elif TIME in file:
                found.time = _common_times(hdf5_parts.read(file, TIME), hdf5_parts.read(file, SAVED))
            if BUDGET in file:
                sizes = hdf5_parts.read(file, BUDGET)
                found.budget = dict(zip(texts_of(file, SOURCE), sizes.T.copy(), strict=True))
        lengths = {len(v) for part in (found.parameters, found.texts, found.numbers) for v in part.values()}
        lengths |= {len(column.array) for column in found.columns.values()}
        if lengths != {count}:
            raise InputError(f"{subject} does not have the {count} rows of the sweep; run the sweep again")
        return found


class _Writer:
    """Writes variables of one file with their dimensions."""

    def __init__(self, file: Any) -> None:
        self.file = file

    def coordinate(self, name: str, values: np.ndarray, about: Mapping[str, Any] | None = None) -> None:
        """A dimension with a coordinate value at each index."""
        data = _dataset(self.file, name, values, about or {})
        data.make_scale(name)

    def variable(self, name: str, values: np.ndarray, dims: tuple[str, ...], about: Mapping[str, Any]) -> None:
        """An array along dimensions, which are created if necessary."""
        for dim, size in zip(dims, values.shape, strict=True):
            if dim not in self.file and dim in COMPONENTS:
                self.coordinate(dim, np.array(COMPONENTS[dim], dtype=object))
            elif dim not in self.file:
                self.file.create_dataset(dim, (size,), dtype=">f4").make_scale(f"{NO_VARIABLE}{size:10d}")
        data = _dataset(self.file, name, values, about)
        for axis, dim in enumerate(dims):
            data.dims[axis].attach_scale(self.file[dim])


def _dataset(file: Any, name: str, values: np.ndarray, about: Mapping[str, Any]) -> Any:
    import h5py

    if values.dtype == object:
        data = file.create_dataset(name, values.shape, dtype=h5py.string_dtype())
        data[...] = values
    else:
        plain = values.astype(np.int8) if values.dtype == bool else values
        packing = {"compression": "gzip", "compression_opts": 1, "shuffle": True} if plain.nbytes > PACKED_FROM else {}
        data = file.create_dataset(name, data=plain, **packing)
    data.attrs.update(about)
    if values.dtype == bool:
        data.attrs["dtype"] = "bool"  # as xarray writes them
    return data


def _common_times(times: np.ndarray, saved: np.ndarray) -> np.ndarray:
    """(run, time) of runs that have the first `saved` (run,) of the common times."""
    return np.where(np.arange(len(times)) < saved[:, None], times, np.nan)


def _values(values: Sequence[Any]) -> np.ndarray:
    """Values of a parameter as one array: booleans, integers, numbers, else texts."""
    kinds = {type(value) for value in values}
    if kinds in ({bool}, {int}, {float}):
        return np.array(values)
    if kinds == {int, float}:
        return np.array(values, dtype=float)
    return np.array([str(value) for value in values], dtype=object)


def _with_row(array: np.ndarray, n: int, row: np.ndarray) -> np.ndarray:
    """`array` with `row` at index n; it grows if the row is larger."""
    if any(have < wanted for have, wanted in zip(array.shape[1:], row.shape, strict=True)):
        shape = [max(sizes) for sizes in zip(array.shape[1:], row.shape, strict=True)]
        grown = np.full((len(array), *shape), np.nan)
        grown[tuple(slice(0, size) for size in array.shape)] = array
        array = grown
    array[n] = np.nan
    array[(n, *(slice(0, size) for size in row.shape))] = row
    return array


@contextmanager
def opened(path: Path) -> Iterator[Any]:
    """The open `h5py.File` of a table with a valid checksum. Raises `InputError`, also if reading it inside fails."""
    import h5py

    subject = f"sweep: {path}"
    if not path.is_file():
        raise InputError(f"{subject} is missing; {CURE}")
    _whole(path.absolute(), _state(path))
    try:
        with h5py.File(path, "r") as file:
            if file.attrs.get("format") != MARK:
                raise InputError(f"{subject} is no table of a sweep")
            check_schema(int(np.asarray(file.attrs["schema"])), SCHEMA, subject, "run the sweep again")
            yield file
    except InputError as error:
        raise error if str(error).startswith("sweep: ") else InputError(f"{subject}: {error}; {CURE}") from None
    except Exception as error:  # reading a foreign document can raise anything
        reason = " ".join(str(error).split()) or type(error).__name__
        raise InputError(f"{subject} is damaged ({reason}); {CURE}") from error


def _state(path: Path) -> tuple[int, int, int]:
    state = path.stat()
    return state.st_ino, state.st_mtime_ns, state.st_size


@lru_cache(maxsize=16)
def _whole(path: Path, state: tuple[int, int, int]) -> None:
    """Check the checksum of a table, and let the HDF5 library check one that this process has not written, once for
    each `state` of the file: path, time of writing, size. Raises `InputError` at every call."""
    subject = f"sweep: {path}"
    verify(path, subject, CURE)
    if (path, state) not in _written:
        probe(path, subject, CURE)


_written: set[tuple[Path, tuple[int, int, int]]] = set()  # tables of this process


def axes_of(data: Any) -> tuple[str, ...]:
    """Names of the axes of a variable after `run`."""
    return tuple(str(data.dims[axis][0].name).lstrip("/") for axis in range(1, data.ndim))


def variables_of(file: Any) -> list[str]:
    """Names of the variables with values in an open table: all except axes without any."""
    return [name for name in file if not bytes(file[name].attrs.get("NAME", b"")).startswith(NO_VARIABLE.encode())]


def values_of(file: Any, name: str) -> np.ndarray:
    """The variable `name` of an open table, texts as texts."""
    data = hdf5_parts.member(file, name)
    if data.dtype.kind == "O" or name in TEXTS:
        return texts_of(file, name)
    found = hdf5_parts.read(file, name)
    return found.astype(bool) if data.attrs.get("dtype") == "bool" else found


def texts_of(file: Any, name: str) -> np.ndarray:
    """The texts (n,) called `name`."""
    data = hdf5_parts.member(file, name)
    if data.dtype.kind != "O" or data.ndim != 1:
        raise InputError(f"{name} holds no texts")
    return np.array(data.asstr()[...], dtype=object)
