"""The folder of a sweep, by convention NAME.sweep: definition, lock, and completed runs.

    sweep.json            definition of the sweep: scene, parameters, outputs, versions; written first
    lock                  held by the running process, with its identity
    runs/000012.arrays    a completed run, a small sealed file (`model/files/sealed_file.py`), until it is in the
    table table.h5              all rows (`table.py`)
    bodies/HASH.h5        reduced bodies that workers read (`packing.py`)

One process writes: workers send their answers to it. A table in HDF5 can be lost if the process is killed while
writing, and is always written completely; therefore a completed run is first written to its own file, and later merged
into the table with others, and at the end with all. A kill at any time loses no completed run. Opening a folder without
lock first merges the remaining files into the table.
"""

from __future__ import annotations

import json
import logging
import os
import socket
from collections.abc import Mapping
from pathlib import Path
from typing import IO, Any

import numpy as np

from warpffrf.model.errors import InputError
from warpffrf.model.files.paths import ENDING, locked, remove_left_over_in, written_whole
from warpffrf.model.files.sealed_file import read_arrays, write_arrays
from warpffrf.study.sweeps.design import Design
from warpffrf.study.sweeps.job import Answer, Value
from warpffrf.study.sweeps.table import Table

KIND = "warpffrf sweep"
DEFINITION, LOCK, RUNS, TABLE, BODIES = "sweep.json", "lock", "runs", "table.h5", "bodies"
RUN = "{:06d}.arrays"
AGAIN = "choose another folder, or begin anew with overwrite=True (--overwrite)"
GATHER_FROM = 500  # files of runs merged into the table, later as many as are in it: a row is rewritten few times
GATHER_AT = 4000  # upper limit: each write scans the folder
TIMES = "time"

log = logging.getLogger("warpffrf")


def is_sweep(path: str | os.PathLike[str]) -> bool:
    """Whether `path` is the folder of a sweep, by its content."""
    return (Path(path).expanduser() / DEFINITION).is_file()


class Folder:
    """The folder of one sweep."""

    def __init__(self, path: str | os.PathLike[str]) -> None:
        self.path = Path(path).expanduser()
        self._lock: IO[str] | None = None
        self._loose = 0  # runs that are not in the table yet
        self._in_table = 0
        self.has_values = False  # whether a run in the table has the outputs

    @property
    def bodies(self) -> Path:
        """Folder of reduced bodies."""
        return self.path / BODIES

    @property
    def table(self) -> Path:
        """The file of the table."""
        return self.path / TABLE

    def definition(self) -> dict[str, Any]:
        """The definition of the sweep. Raises `InputError` for a folder that is no sweep."""
        file = self.path / DEFINITION
        if not file.is_file():
            raise InputError(f"sweep: '{self.path}' is no folder of a sweep, it has no {DEFINITION}; check the path")
        try:
            found = json.loads(file.read_text(encoding="utf-8"))
            if found["kind"] != KIND or not isinstance(found["count"], int):
                raise ValueError
            names = [*found["parameters"], *found["outputs"]]
        except (ValueError, KeyError, TypeError, OSError):
            raise InputError(f"sweep: '{file}' is damaged, or of another program; {AGAIN}") from None
        if not all(isinstance(name, str) for name in names):
            raise InputError(f"sweep: '{file}' is damaged; {AGAIN}")
        return found

    # --- writing

    def begin(self, definition: Mapping[str, Any], design: Design, *, overwrite: bool, resume: bool) -> set[int]:
        """Lock the folder for a sweep; returns the indices of completed rows. Raises `InputError` if it holds a sweep
        and neither option is set, another sweep, or something else, and if another process writes it."""
        if self.path.exists() and not self.path.is_dir():
            raise InputError(f"sweep: store '{self.path}' is a file; give the name of a folder")
        if self.path.is_dir() and not is_sweep(self.path) and self._has_others():
            raise InputError(f"sweep: store '{self.path}' is a folder with other files; choose another one")
        try:
            (self.path / RUNS).mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise InputError(
                f"sweep: store '{self.path}' cannot be written ({error.strerror or error}); choose another folder"
            ) from None
        self.hold()
        if is_sweep(self.path) and not overwrite:
            there = self.definition()
            if not resume:
                raise InputError(
                    f"sweep: store '{self.path}' holds a sweep; go on with it with resume=True (--resume), {AGAIN}"
                )
            self._refuse_another(there, json.loads(json.dumps(dict(definition))))
            if not self.table.is_file():
                log.warning("sweep: '%s' has no table; rows without a file in '%s' are run", self.path, RUNS)
                Table.empty(design.names, design.rows).write(self.table)
            table = self.gather()
            return table.done()
        for file in (
            self.table,
            *(self.path / RUNS).glob("*.arrays"),
            *self.bodies.glob("*.h5"),
            *self.bodies.glob("*.job"),
        ):
            file.unlink(missing_ok=True)
        with written_whole(self.path / DEFINITION) as partial:
            partial.write_text(json.dumps(definition, indent=1) + "\n", encoding="utf-8")
        Table.empty(design.names, design.rows).write(self.table)
        return set()

    def _has_others(self) -> bool:
        """Whether the folder, which has no definition, contains more than a sweep leaves that was killed before it
        wrote one."""
        begun = (LOCK, RUNS)
        if any(entry.name not in begun and not entry.name.endswith(ENDING) for entry in self.path.iterdir()):
            return True
        runs = self.path / RUNS
        return runs.is_dir() and any(not entry.name.endswith(ENDING) for entry in runs.iterdir())

    def hold(self) -> None:
        """Lock the folder until `release`. Raises `InputError` if another process holds the lock."""
        stream = (self.path / LOCK).open("a+", encoding="utf-8")
        if not locked(stream):
            with stream:
                stream.seek(0)
                owner = stream.read().strip() or "unknown process"
            raise InputError(f"sweep: another process is writing '{self.path}' ({owner}); wait for it")
        stream.truncate(0)
        stream.write(f"process {os.getpid()} on {socket.gethostname()}\n")
        stream.flush()
        self._lock = stream
        for folder in (self.path, self.path / RUNS):
            remove_left_over_in(folder)

    def release(self) -> None:
        """Release the lock."""
        if self._lock is not None:
            self._lock.close()
            self._lock = None

    def _refuse_another(self, there: Mapping[str, Any], wanted: Mapping[str, Any]) -> None:
        differ = [name for name in {**there, **wanted} if there.get(name) != wanted.get(name)]
        if differ:
            told = "; ".join(_difference(name, there.get(name), wanted.get(name)) for name in differ)
            raise InputError(f"sweep: store '{self.path}' is the store of another sweep: {told}; {AGAIN}")

    def keep(self, answer: Answer) -> None:
        """Write a completed run. Raises OSError if that fails."""
        about = {
            "number": answer.number, "status": answer.status, "message": answer.message,
            "wall_seconds": answer.wall_seconds, "set_up_seconds": answer.set_up_seconds, "device": answer.device,
            "host": answer.host, "versions": answer.versions, "worlds": answer.worlds, "budget": answer.budget,
            "values": {name: [list(v.dims), v.units, v.frame] for name, v in answer.values.items()},
        }  # fmt: skip
        arrays = {f"value {name}": [np.asarray(value.array)] for name, value in answer.values.items()}
        if answer.time is not None:
            arrays[TIMES] = [answer.time]
        write_arrays(self.path / RUNS / RUN.format(answer.number), about, arrays)
        self._loose += 1
        if self._loose >= max(GATHER_FROM, min(self._in_table, GATHER_AT)):
            self.gather()

    def gather(self) -> Table:
        """Merge all runs that have their own files into the table; the folder is locked. Raises `InputError` for a
        damaged table."""
        definition = self.definition()
        table = Table.read(self.table, definition["count"])
        files = sorted((self.path / RUNS).glob("*.arrays"))
        damaged = []
        for file in files:
            try:
                table.add(_read(file))
            except InputError as error:
                log.warning("%s", error)
                damaged.append(file)
        if len(files) > len(damaged):
            table.write(self.table)
        for file in files:
            file.unlink(missing_ok=True)
        self._loose, self._in_table, self.has_values = 0, len(table.done()), bool(table.columns)
        return table

    def waiting(self) -> int:
        """Number of runs with files of their own."""
        return len(list((self.path / RUNS).glob("*.arrays")))


def _read(file: Path) -> Answer:
    """A run written by `keep`. Raises `InputError` for another file."""
    subject, cure = f"sweep: {file}", "its row counts as not run; resume=True (--resume) runs it"
    about, arrays = read_arrays(file, subject, cure)
    try:
        values = {
            name: Value(arrays[f"value {name}"], tuple(dims), units, frame)
            for name, (dims, units, frame) in about.pop("values").items()
        }
        return Answer(**about, values=values, time=arrays.get(TIMES))
    except (KeyError, TypeError, ValueError) as error:
        raise InputError(f"{subject} is damaged ({error}); {cure}") from None


def _difference(name: str, there: Any, wanted: Any) -> str:
    """Differences of a definition, as text."""
    if isinstance(there, dict) and isinstance(wanted, dict):
        keys = [key for key in {**there, **wanted} if there.get(key) != wanted.get(key)]
        parts = [f"{key} was {there.get(key, 'not there')}, is {wanted.get(key, 'not there')}" for key in keys]
        return f"{name}: {', '.join(parts)}" if parts else f"{name}: their order differs"
    if name in ("rows", "scenes", "first_scene"):
        return {
            "rows": "values of the parameters differ", "scenes": "the scene differs",
            "first_scene": "the scene of the first row differs",
        }[name]  # fmt: skip
    return f"{name} was {there}, is {wanted}"
