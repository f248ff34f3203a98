"""The folder `run.h5.unfinished` beside results that are being made: what a run has done so far, and a lock.

    lock                         held by the process that runs; says which
    scene.arrays                 what it takes to make histories of rows: scene, kind, options; written once
    part-000001.arrays, ...      the rows saved since the part before, as the run collects them
    checkpoint.arrays            the state after the last part that counts, what the run is to reach, and its options

All are plain sealed files (`model/files/sealed_file.py`), which a thread writes beside the run: it copies no row, and
writing and checksums leave Python's lock to the run. A part is written whole, then the checkpoint that counts it, so
that at any time the two belong together; a part behind the last that counts was cut and is ignored. The history is made
when the folder is read. The folder is removed when the results are written. As long as another process holds the lock,
it is refused to run into the same results.

Each row is written once, however often parts are; what goes with their number is the checkpoint: after one that took t
the next part waits t/SHARE at least. While a part is being written the next one is not due.
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
from warpffrf.online import keeping
from warpffrf.online.arrays.ring import joined
from warpffrf.online.free_flight import check_run
from warpffrf.online.history.history import History

ENDING = ".unfinished"
LOCK, SCENE, CHECKPOINT, PART = "lock", "scene.arrays", "checkpoint.arrays", "part-{:06d}.arrays"
PARTS = "part-*.arrays"
HASH = re.compile(r"\W*\b[0-9a-f]{32,64}\b")  # of an option
SHARE = 0.02  # of the time between two parts that writing the checkpoint before took
GO_ON = "the run had not ended: go on with results='{results}' and resume=True (--resume)"
HISTORY_OF: dict[str, Callable[..., History]] = {  # by `Source.kind`
    keeping.KIND: keeping.history_of,
    check_run.KIND: check_run.history_of,
}

log = logging.getLogger("warpffrf")


class UnfinishedRun:
    """The folder of one run, locked from `open` to `close`; a keeper (`warpffrf.model.messages.checkpoints`)."""

    def __init__(self, results: Path, options: Mapping[str, str], every: float) -> None:
        """results: the file to be; options: of the run, by which a run that goes on is told from another one; every:
        seconds between two parts."""
        self.results, self.folder = results, results.with_name(results.name + ENDING)
        self.options, self.every, self.wait = dict(options), every, every
        self.last, self.troubles = time.monotonic(), []
        self.parts, self.taken = 0, 0  # that count, and chunks of rows in them
        self._source: Source | None = None  # while it is to be written
        self._writer: threading.Thread | None = None
        self._lock: IO[str] | None = None

    def open(self) -> None:
        """Make the folder and lock it. Raises `InputError` where another process has."""
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
        if not _is_file(stream, file):  # whoever had it has just removed it
            stream.close()
            return self.open()
        stream.truncate(0)
        stream.write(f"process {os.getpid()} on {socket.gethostname()}\n")
        stream.flush()
        self._lock = stream
        remove_left_over_in(self.folder)
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
        rows = _rows(self.folder, about["parts"])
        self.parts = self.taken = len(rows)
        return Unfinished(rows, checkpoint, Plan(about["last_step"], about["rejected"], tuple(about["notes"])))

    def has_checkpoint(self) -> bool:
        """Whether there is something to go on from."""
        return (self.folder / CHECKPOINT).is_file()

    def clear(self) -> None:
        """Forget an earlier run, or what this one has done."""
        self.settle()
        for file in (self.folder / CHECKPOINT, *self._files()):
            file.unlink(missing_ok=True)
        self.parts = self.taken = 0

    def begin(self, source: Source) -> None:
        """What rows are of; it is written before the next part."""
        self._source = source

    def due(self) -> bool:
        """Whether it is time for another part, and the last one is written."""
        busy = self._writer is not None and self._writer.is_alive()
        return not busy and time.monotonic() - self.last >= self.wait

    def keep(self, run: Unfinished) -> None:
        """Write what there is since the last part that counts, and the checkpoint after it, beside the run. Where that
        fails, the same comes with the next."""
        self.settle()
        self._writer = threading.Thread(target=self._write, args=(run,), name="warpffrf keeping", daemon=True)
        try:
            self._writer.start()
        except RuntimeError:  # no more threads in this process
            self._writer = None
            self._write(run)

    def settle(self) -> None:
        """Wait for what is being written."""
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
        except Exception as error:  # whatever it is, the run goes on
            if not self.troubles:
                log.warning("results: '%s' cannot be written during the run (%s); going on", self.folder, error)
            said = str(error) or type(error).__name__
            self.troubles = [f"results: what was done could not be kept during the run ({said})"]
        finally:
            self.last = time.monotonic()

    def close(self, *, remove: bool) -> None:
        """Give up the lock; with `remove`, or without a checkpoint, the folder goes too."""
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
        """All but the lock and the checkpoint."""
        return [self.folder / SCENE, *self.folder.glob(PARTS)]

    def _write_checkpoint(self, checkpoint: Mapping[str, np.ndarray], plan: Plan, parts: int) -> None:
        about = {"parts": parts, "options": self.options, "last_step": plan.last_step}
        about |= {"rejected": plan.rejected, "notes": list(plan.notes)}
        blocks = {name: [np.asarray(array)] for name, array in checkpoint.items()}
        write_arrays(self.folder / CHECKPOINT, about, blocks)


def read_checkpoint(folder: Path) -> tuple[dict[str, np.ndarray], dict[str, Any]] | None:
    """The checkpoint in `folder`, and what belongs to it; None where there is none yet."""
    if not (folder / CHECKPOINT).is_file():
        return None
    about, checkpoint = _read(folder / CHECKPOINT)
    return checkpoint, about


def _rows(folder: Path, parts: int) -> list[Rows]:
    """The rows of the parts that count."""
    return [_read(folder / PART.format(number))[1] for number in range(1, parts + 1)]


def _read(file: Path) -> tuple[dict[str, Any], dict[str, np.ndarray]]:
    """A file of the folder, whose seal holds. Raises `InputError` for a damaged or missing one."""
    subject = f"unfinished run '{file.parent}': {file.name}"
    cure = "begin the run anew with overwrite=True (--overwrite)"
    if not file.is_file():
        raise InputError(f"{subject} is missing; {cure}")
    return read_arrays(file, subject, cure)


def _write_source(file: Path, source: Source) -> None:
    """Write what rows are of; where it cannot be put into a file, why."""
    try:
        document, arrays = to_arrays((source.scene, dict(source.options)))
        about = {"kind": source.kind, "hash": source.scene.content_hash(), "document": document}
    except InputError as error:
        arrays, about = {}, {"missing": str(error)}
    write_arrays(file, about, {name: [array] for name, array in arrays.items()})


def _read_source(folder: Path) -> Source:
    """What the rows in `folder` are of. Raises `InputError` where it was not put there, or by another version."""
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
        except Exception as error:  # what another version left out, its methods look for
            reason = f"it is of another version of warpffrf ({error})"
    raise InputError(
        f"unfinished run '{folder}': {SCENE} cannot be made a scene again ({reason}); go on with the run, with "
        "resume=True (--resume), which does not need it"
    )


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
    """The options in which two runs differ, in words; what is known by a hash, as the scene, is another one."""
    said = []
    for name in {**options, **others}:
        before, now = (HASH.sub("", of.get(name, "not given")) for of in (others, options))
        if options.get(name) != others.get(name):
            said.append(f"{name} was {before}, is {now}" if before != now else f"{name} is another one")
    return ", ".join(said)


def _is_file(stream: IO[str], file: Path) -> bool:
    """Whether `file` is still the one that was opened."""
    return file.exists() and os.path.samestat(os.fstat(stream.fileno()), file.stat())
