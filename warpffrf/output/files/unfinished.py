"""The folder `run.h5.unfinished` beside results that are being made: what a run has done so far, and a lock.

    lock                 held by the process that runs; says which
    part-000001.h5, ...  results files of the rows saved since the part before, readable as any other; beside what every
                         results file has, `rows/`: the same rows as the device wrote them
    checkpoint.h5        the state after the last part that counts, what the run is to reach, and its options

A part is written whole, then the checkpoint that counts it, so that at any time the two belong together; a part behind
the last that counts was cut and is ignored. The folder is removed when the results are written. As long as another
process holds the lock, it is refused to run into the same results.

Parts are not compressed. After a part that took t the next one waits t/SHARE at least, which bounds what a body and a
checkpoint cost; what rows cost goes with their number (bench/keeping.py).
"""

from __future__ import annotations

import json
import logging
import os
import socket
import time
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import IO, Any

import h5py
import numpy as np

from warpffrf.model.errors import InputError
from warpffrf.model.output_paths import remove_left_over
from warpffrf.model.sealed_file import require_seal, verify, written_sealed
from warpffrf.online.arrays.ring import SavedRows
from warpffrf.online.arrays.ring import joined as joined_rows
from warpffrf.online.history.history import History
from warpffrf.online.keeping import UNFINISHED, Plan, Unfinished
from warpffrf.online.stages import joined_parts
from warpffrf.output.files.results import get_history, put_result

try:
    import fcntl
except ImportError:  # without it two runs on one path are not told apart
    fcntl = None

ENDING = ".unfinished"
LOCK, CHECKPOINT = "lock", "checkpoint.h5"
SHARE = 0.02  # of the time between two parts that writing the one before took
ROWS = "rows"
GO_ON = "the run had not ended: go on with results='{results}' and resume=True (--resume)"

log = logging.getLogger("warpffrf")


class UnfinishedRun:
    """The folder of one run, locked from `open` to `close`; a keeper (`warpffrf.online.keeping`)."""

    def __init__(
        self, results: Path, options: Mapping[str, str], every: float, result_of: Callable[[History], Any]
    ) -> None:
        """results: the file to be; options: of the run, by which a run that goes on is told from another one; every:
        seconds between two parts; result_of: what is written of a history."""
        self.results, self.folder = results, results.with_name(results.name + ENDING)
        self.options, self.every, self.wait = dict(options), every, every
        self.result_of = result_of
        self.parts, self.last, self.troubles = 0, time.monotonic(), []
        self._lock: IO[str] | None = None

    def open(self) -> None:
        """Make the folder and lock it. Raises `InputError` where another process has."""
        self.folder.mkdir(exist_ok=True)
        file = self.folder / LOCK
        stream = file.open("a+", encoding="utf-8")
        if not _locked(stream):
            with stream:
                stream.seek(0)
                owner = stream.read().strip() or "unknown process"
            raise InputError(
                f"results: another run is writing '{self.results}' ({owner}); wait for it, or choose another name"
            )
        if not _is_file(stream, file):  # whoever had it has just removed it
            stream.close()
            return self.open()
        stream.truncate(0)
        stream.write(f"process {os.getpid()} on {socket.gethostname()}\n")
        stream.flush()
        self._lock = stream
        for name in {CHECKPOINT, *(part.name for part in self._files())}:
            remove_left_over(self.folder / name)
        return None

    def load(self) -> Unfinished | None:
        """What there is of an earlier run, to go on from; None without a checkpoint. Raises `InputError` where it is
        another run."""
        found = read_checkpoint(self.folder)
        if found is None:
            return None
        checkpoint, about = found
        if other := different(self.options, about["options"]):
            raise InputError(
                f"results: '{self.folder}' is of another run ({other}); go on with what it was run with, or begin anew "
                "with overwrite=True (--overwrite)"
            )
        self.parts = about["parts"]
        rows: list[SavedRows] = []
        for file in self._files()[: self.parts]:
            with _sound(file) as part:
                group: Any = part[ROWS]
                rows.append({name: data[()] for name, data in group.items()})
        return Unfinished(
            joined_rows(rows), checkpoint, Plan(about["last_step"], about["rejected"], tuple(about["notes"]))
        )

    def has_checkpoint(self) -> bool:
        """Whether there is something to go on from."""
        return (self.folder / CHECKPOINT).is_file()

    def clear(self) -> None:
        """Forget an earlier run."""
        for file in (self.folder / CHECKPOINT, *self._files()):
            file.unlink(missing_ok=True)
        self.parts = 0

    def due(self) -> bool:
        """Whether it is time for another part."""
        return time.monotonic() - self.last >= self.wait

    def keep(self, history: History, rows: SavedRows, plan: Plan) -> bool:
        """Write a part and the checkpoint after it; False where that failed, and what was given is to come again."""
        begin = time.monotonic()
        try:
            self._write_part(history, rows)
            self._write_checkpoint(history.checkpoint, plan)
        except OSError as error:
            self.parts -= 1
            if not self.troubles:
                log.warning("results: '%s' cannot be written during the run (%s); going on", self.folder, error)
            self.troubles = [f"results: what was done could not be kept during the run ({error})"]
            return False
        finally:
            self.last = time.monotonic()
            self.wait = max(self.every, (self.last - begin) / SHARE)
        return True

    def close(self, *, remove: bool) -> None:
        """Give up the lock; with `remove`, or without a checkpoint, the folder goes too."""
        if remove:
            self.clear()
        if not self.has_checkpoint():
            for file in (*self._files(), self.folder / LOCK):
                file.unlink(missing_ok=True)
            try:
                self.folder.rmdir()
            except OSError:
                log.warning("results: '%s' holds files that are not of warpffrf, and stays", self.folder)
        if self._lock is not None:
            self._lock.close()

    def _files(self) -> list[Path]:
        return sorted(self.folder.glob("part-*.h5"))

    def _write_part(self, history: History, rows: SavedRows) -> None:
        self.parts += 1
        with written_sealed(self.folder / f"part-{self.parts:06d}.h5") as file:
            put_result(file, self.result_of(replace(history, checkpoint={})), bodies=self.parts == 1, packing={})
            for name, array in rows.items():
                data = file.create_dataset(f"{ROWS}/{name}", data=array)
                data.attrs.update({"units": "internal", "frame": "internal", "dims": "internal"})

    def _write_checkpoint(self, checkpoint: Mapping[str, np.ndarray], plan: Plan) -> None:
        about = {"parts": self.parts, "options": self.options, "last_step": plan.last_step}
        about |= {"rejected": plan.rejected, "notes": list(plan.notes)}
        with written_sealed(self.folder / CHECKPOINT) as file:
            file.attrs.update({"format": "warpffrf-checkpoint", "about": json.dumps(about)})
            for name, array in checkpoint.items():
                file.create_dataset(name, data=array)


def read_checkpoint(folder: Path) -> tuple[dict[str, np.ndarray], dict[str, Any]] | None:
    """The checkpoint in `folder`, and what belongs to it; None where there is none yet."""
    if not (folder / CHECKPOINT).is_file():
        return None
    with _sound(folder / CHECKPOINT) as file:
        about: Any = file.attrs["about"]
        return {name: data[()] for name, data in file.items()}, json.loads(about)


@contextmanager
def _sound(file: Path) -> Iterator[h5py.File]:
    """A file of the folder, whose seal holds. Raises `InputError` for a damaged or missing one."""
    subject = f"unfinished run '{file.parent}': {file.name}"
    cure = "begin the run anew with overwrite=True (--overwrite)"
    if not file.is_file():
        raise InputError(f"{subject} is missing; {cure}")
    require_seal(verify(file, subject, cure), 1, 1, subject, cure)
    with h5py.File(file, "r") as opened:
        yield opened


def is_unfinished(path: str | os.PathLike[str]) -> bool:
    """Whether `path` is the folder of a run that has not ended."""
    folder = Path(path).expanduser()
    return folder.suffix == ENDING and folder.is_dir()


def read_unfinished(folder: Path) -> History:
    """What an unfinished run has done, as a History with status "unfinished". Raises `InputError` where that is
    nothing."""
    found = read_checkpoint(folder)
    if found is None:
        raise InputError(f"'{folder}' holds nothing of a run yet; a part is written now and then while it runs")
    checkpoint, about = found
    parts: list[History] = []
    for file in sorted(folder.glob("part-*.h5"))[: about["parts"]]:
        with _sound(file) as part:
            parts.append(get_history(part, parts[0].scene if parts else None))
    whole = joined_parts(parts)
    message = GO_ON.format(results=folder.name.removesuffix(ENDING))
    return replace(whole, status=UNFINISHED, message=message, checkpoint=checkpoint)


def different(options: Mapping[str, str], others: Mapping[str, str]) -> str:
    """The options in which two runs differ, in words."""
    names = [name for name in {**options, **others} if options.get(name) != others.get(name)]
    return ", ".join(
        f"{name} was {others.get(name, 'not given')}, is {options.get(name, 'not given')}" for name in names
    )


def _locked(stream: IO[str]) -> bool:
    """Lock a file that no other process has locked."""
    if fcntl is None:
        return True
    try:
        fcntl.flock(stream, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except OSError:
        return False
    return True


def _is_file(stream: IO[str], file: Path) -> bool:
    """Whether `file` is still the one that was opened."""
    return file.exists() and os.path.samestat(os.fstat(stream.fileno()), file.stat())
