"""The folder `run.h5.unfinished` of a run in progress: the rows computed so far, a checkpoint, and a lock.

    lock                         held by the running process, with its identity
    scene.arrays                 data to build histories from rows: scene, kind, options; written once
    part-000001.arrays, ...      the rows saved since the previous part, as the run collects them
    checkpoint.arrays            the state after the last valid part, the end of the run, and its options

All are plain sealed files (`model/files/sealed_file.py`), written by a separate thread: it copies no row, and writing
and checksums release Python's global lock. A part is written completely, then the checkpoint that includes it, so that
the two are always consistent; a part that the checkpoint does not include is incomplete and is ignored. The history is
built when the folder is read. The folder is removed when the results are written. While another process holds the lock,
a run with the same results file is refused.

Each row is written once, so only the cost of checkpoints grows with the number of parts: after a checkpoint that took
t, the next part waits at least t/SHARE. No part is due while another one is being written.
"""

from __future__ import annotations

import logging
import os
import re
import socket
import threading
import time
from collections.abc import Callable, Mapping
from dataclasses import replace
from pathlib import Path
from typing import IO, Any

import numpy as np

from warpffrf.model.errors import InputError
from warpffrf.model.files.object_arrays import from_arrays, to_arrays
from warpffrf.model.files.paths import locked, remove_left_over_in
from warpffrf.model.files.sealed_file import read_arrays, write_arrays
from warpffrf.model.messages.checkpoints import Plan, Rows, Source, Unfinished
from warpffrf.model.messages.status import Status
from warpffrf.online import periodic_checkpoint
from warpffrf.online.arrays.ring import joined
from warpffrf.online.free_flight import check_run
from warpffrf.online.history.history import History

ENDING = ".unfinished"
LOCK, SCENE, CHECKPOINT, PART = "lock", "scene.arrays", "checkpoint.arrays", "part-{:06d}.arrays"
PARTS = "part-*.arrays"
HASH = re.compile(r"\W*\b[0-9a-f]{32,64}\b")  # in an option
SHARE = 0.02  # largest fraction of the time between two parts spent on writing checkpoints
GO_ON = "the run had not ended: go on with results='{results}' and resume=True (--resume)"
HISTORY_OF: dict[str, Callable[..., History]] = {  # by `Source.kind`
    periodic_checkpoint.KIND: periodic_checkpoint.history_of,
    check_run.KIND: check_run.history_of,
}

log = logging.getLogger("warpffrf")


class UnfinishedRun:
    """The folder of one run, locked from `open` to `close`; a keeper (`warpffrf.model.messages.checkpoints`)."""

    def __init__(self, results: Path, options: Mapping[str, str], every: float) -> None:
        """results: path of the results file; options: of the run, which identify it when it is resumed; every: seconds
        between two parts."""
        self.results, self.folder = results, results.with_name(results.name + ENDING)
        self.options, self.every, self.wait = dict(options), every, every
        self.last, self.troubles = time.monotonic(), []
        self.parts, self.taken = 0, 0  # valid parts, and chunks of rows in them
        self._source: Source | None = None  # until it is written
        self._writer: threading.Thread | None = None
        self._lock: IO[str] | None = None

    def open(self) -> None:
        """Create the folder and lock it. Raises `InputError` if another process holds the lock."""
        self.folder.mkdir(exist_ok=True)
        file = self.folder / LOCK
        stream = file.open("a+", encoding="utf-8")
        if not locked(stream):
            with stream:
                stream.seek(0)
                owner = stream.read().strip() or "unknown process"
            raise InputError(
                f"results: another run is writing '{self.results}' ({owner}); wait for it, or choose another name"
            )
        if not _is_file(stream, file):  # the previous owner has just removed it
            stream.close()
            return self.open()
        stream.truncate(0)
        stream.write(f"process {os.getpid()} on {socket.gethostname()}\n")
        stream.flush()
        self._lock = stream
        remove_left_over_in(self.folder)
        return None

    def load(self) -> Unfinished | None:
        """The state of an earlier run, to continue from; None without a checkpoint. Raises `InputError` if it is
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
        rows = _rows(self.folder, about["parts"])
        self.parts = self.taken = len(rows)
        return Unfinished(rows, checkpoint, Plan(about["last_step"], about["rejected"], tuple(about["notes"])))

    def has_checkpoint(self) -> bool:
        """Whether there is a checkpoint to continue from."""
        return (self.folder / CHECKPOINT).is_file()

    def clear(self) -> None:
        """Discard the parts of an earlier run or of this one."""
        self.settle()
        for file in (self.folder / CHECKPOINT, *self._files()):
            file.unlink(missing_ok=True)
        self.parts = self.taken = 0

    def begin(self, source: Source) -> None:
        """Set the source of the rows; it is written before the next part."""
        self._source = source

    def due(self) -> bool:
        """Whether it is time for another part and the last one is written."""
        busy = self._writer is not None and self._writer.is_alive()
        return not busy and time.monotonic() - self.last >= self.wait

    def keep(self, run: Unfinished) -> None:
        """Write the rows since the last valid part, and then the checkpoint, in a separate thread. If that fails, the
        same rows are written with the next part."""
        self.settle()
        self._writer = threading.Thread(target=self._write, args=(run,), name="warpffrf keeping", daemon=True)
        try:
            self._writer.start()
        except RuntimeError:  # no more threads in this process
            self._writer = None
            self._write(run)

    def settle(self) -> None:
        """Wait for the part that is being written."""
        if self._writer is not None:
            self._writer.join()
            self._writer = None

    def _write(self, run: Unfinished) -> None:
        try:
            if self._source is not None:
                _write_source(self.folder / SCENE, self._source)
                self._source = None
            fresh, parts = run.rows[self.taken :], self.parts
            if fresh:
                parts += 1
                blocks = {name: [chunk[name] for chunk in fresh] for name in fresh[0]}
                write_arrays(self.folder / PART.format(parts), {"part": parts}, blocks)
            begin = time.monotonic()
            self._write_checkpoint(run.checkpoint, run.plan, parts)
            self.parts, self.taken = parts, len(run.rows)
            self.wait = max(self.every, (time.monotonic() - begin) / SHARE)
        except Exception as error:  # errors of any kind must not stop the run
            if not self.troubles:
                log.warning("results: '%s' cannot be written during the run (%s); it continues", self.folder, error)
            said = str(error) or type(error).__name__
            self.troubles = [f"results: completed parts could not be saved during the run ({said})"]
        finally:
            self.last = time.monotonic()

    def close(self, *, remove: bool) -> None:
        """Release the lock; with `remove`, or without a checkpoint, the folder is removed."""
        try:
            self.settle()
            if remove:
                self.clear()
            if not self.has_checkpoint():
                for file in (*self._files(), self.folder / LOCK):
                    file.unlink(missing_ok=True)
                try:
                    self.folder.rmdir()
                except OSError:
                    log.warning("results: '%s' holds files that are not of warpffrf, and stays", self.folder)
        finally:
            if self._lock is not None:
                self._lock.close()

    def _files(self) -> list[Path]:
        """All files except the lock and the checkpoint."""
        return [self.folder / SCENE, *self.folder.glob(PARTS)]

    def _write_checkpoint(self, checkpoint: Mapping[str, np.ndarray], plan: Plan, parts: int) -> None:
        about = {"parts": parts, "options": self.options, "last_step": plan.last_step}
        about |= {"rejected": plan.rejected, "notes": list(plan.notes)}
        blocks = {name: [np.asarray(array)] for name, array in checkpoint.items()}
        write_arrays(self.folder / CHECKPOINT, about, blocks)


def read_checkpoint(folder: Path) -> tuple[dict[str, np.ndarray], dict[str, Any]] | None:
    """The checkpoint in `folder` and its metadata; None if there is none yet."""
    if not (folder / CHECKPOINT).is_file():
        return None
    about, checkpoint = _read(folder / CHECKPOINT)
    return checkpoint, about


def _rows(folder: Path, parts: int) -> list[Rows]:
    """The rows of the valid parts."""
    return [_read(folder / PART.format(number))[1] for number in range(1, parts + 1)]


def _read(file: Path) -> tuple[dict[str, Any], dict[str, np.ndarray]]:
    """A file of the folder, checked by its checksum. Raises `InputError` for a damaged or missing one."""
    subject = f"unfinished run '{file.parent}': {file.name}"
    cure = "begin the run anew with overwrite=True (--overwrite)"
    if not file.is_file():
        raise InputError(f"{subject} is missing; {cure}")
    return read_arrays(file, subject, cure)


def _write_source(file: Path, source: Source) -> None:
    """Write the source of the rows, or the reason why it cannot be stored."""
    try:
        document, arrays = to_arrays((source.scene, dict(source.options)))
        about = {"kind": source.kind, "hash": source.scene.content_hash(), "document": document}
    except InputError as error:
        arrays, about = {}, {"missing": str(error)}
    write_arrays(file, about, {name: [array] for name, array in arrays.items()})


def _read_source(folder: Path) -> Source:
    """The source of the rows in `folder`. Raises `InputError` if it was not stored, or by another version."""
    about, arrays = _read(folder / SCENE)
    reason = about.get("missing", "")
    if not reason:
        try:
            scene, options = from_arrays(about["document"], arrays)
            if scene.content_hash() == about["hash"] and about["kind"] in HISTORY_OF:
                return Source(about["kind"], scene, options)
            reason = "it is of another version of warpffrf"
        except InputError as error:
            reason = str(error)
        except Exception as error:  # attributes missing in another version raise in its methods
            reason = f"it is of another version of warpffrf ({error})"
    raise InputError(
        f"unfinished run '{folder}': {SCENE} cannot be converted to a scene ({reason}); go on with the run, with "
        "resume=True (--resume), which does not need it"
    )


def is_unfinished(path: str | os.PathLike[str]) -> bool:
    """Whether `path` is the folder of a run that has not ended."""
    folder = Path(path).expanduser()
    return folder.suffix == ENDING and folder.is_dir()


def read_unfinished(folder: Path) -> History:
    """The rows of an unfinished run as a History with status "unfinished". Raises `InputError` if there are none."""
    found = read_checkpoint(folder)
    if found is None:
        raise InputError(f"'{folder}' has no rows of a run yet; parts are written at intervals while it runs")
    checkpoint, about = found
    source, rows = _read_source(folder), _rows(folder, about["parts"])
    try:
        history = HISTORY_OF[source.kind](source.scene, joined(rows), **source.options)
    except (KeyError, IndexError, ValueError, TypeError) as error:
        raise InputError(
            f"unfinished run '{folder}': its rows are of another version of warpffrf ({error}); read them with that"
        ) from error
    message = GO_ON.format(results=folder.name.removesuffix(ENDING))
    notes = list(about["notes"])
    return replace(history, status=Status.UNFINISHED, message=message, notes=notes, checkpoint=checkpoint)


def different(options: Mapping[str, str], others: Mapping[str, str]) -> str:
    """The options in which two runs differ, as text; options known by a hash, such as the scene, are only reported as
    different."""
    said = []
    for name in {**options, **others}:
        before, now = (HASH.sub("", of.get(name, "not given")) for of in (others, options))
        if options.get(name) != others.get(name):
            said.append(f"{name} was {before}, is {now}" if before != now else f"{name} differs")
    return ", ".join(said)


def _is_file(stream: IO[str], file: Path) -> bool:
    """Whether `file` is still the file that was opened."""
    return file.exists() and os.path.samestat(os.fstat(stream.fileno()), file.stat())
