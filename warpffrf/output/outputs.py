"""Files of one call of `simulate`: paths are checked before the run, completed parts are saved during it, and errors
after the run lose no results.

A completed run writes its results and then removes the folder of the unfinished run (`files.unfinished`). An
interrupted run leaves both: the results so far, and the data required to continue. If the results cannot be written,
the folder remains.
"""

from __future__ import annotations

import hashlib
import logging
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import Any, TypeVar

import numpy as np

from warpffrf.model.errors import InputError
from warpffrf.model.files.paths import check_ending, checked_output_path
from warpffrf.model.messages.progress import deferred_interrupts, notes, what_follows
from warpffrf.model.messages.status import Status
from warpffrf.online.checkpoint import time_of
from warpffrf.online.history.history import History
from warpffrf.output.files.results import SUFFIXES
from warpffrf.output.files.unfinished import UnfinishedRun, different
from warpffrf.output.result import Result
from warpffrf.output.written_file import Written

KEEP_EVERY = 20.0  # s of wall time between two saved parts of a run
RECORD_SUFFIXES = (".rrd",)
FREE_OPTIONS = ("device", "progress")  # options that do not change the run

log = logging.getLogger("warpffrf")

Kind = TypeVar("Kind", bound=Result)


class Whole:
    """The results of one run: the file, and the folder of the unfinished run."""

    def __init__(self, path: Path, run: UnfinishedRun) -> None:
        self.path, self.run, self.done = path, run, False

    def written(self, result: Kind) -> Kind:
        """Report how the run ended, and write the results."""
        _tell_end(result)
        return self.kept(result)

    def kept(self, result: Kind) -> Kind:
        """Write the results; if that fails, the result gets a note."""
        self.run.settle()
        result.history.notes.extend(self.run.troubles)
        with deferred_interrupts() as asked:
            self.done = _tried(result, "results", self.path, lambda: result.save(self.path, overwrite=True))
        self.done = self.done and result.status != Status.INTERRUPTED
        result.history.stopping |= bool(asked)
        return result


class NoFile(Whole):
    """Results that are not written to disk."""

    def __init__(self) -> None:
        self.path = None

    def kept(self, result: Kind) -> Kind:
        """Returns the result unchanged."""
        return result


class Outputs:
    """File options of a call; see `simulate`."""

    def __init__(self, overwrite: bool, resume: bool = False) -> None:
        self.overwrite, self.resume = overwrite, resume

    def check(self, results: Any, record: Any) -> None:
        """Raises `InputError` for files that cannot be written or must not be replaced."""
        for path, what, suffixes in ((results, "results", SUFFIXES), (record, "record", RECORD_SUFFIXES)):
            if path is not None:
                check_ending(path, what, suffixes)
                checked_output_path(path, what, overwrite=self.overwrite or self.resume)

    @contextmanager
    def locked(self, results: Any, options: dict[str, str] | None = None) -> Iterator[Whole]:
        """The results of a run, locked against other processes."""
        if results is None:
            yield NoFile()
            return
        path = Path(results).expanduser()
        run = UnfinishedRun(path, options or {}, KEEP_EVERY)
        run.open()
        whole = Whole(path, run)
        try:
            yield whole
        finally:
            run.close(remove=whole.done)

    def run(
        self, scene: Any, call: Callable[..., History], start: Any, duration: float, step: float,
        options: dict[str, Any], results: Any,
    ) -> Result:  # fmt: skip
        """One run, or the remainder of an unfinished one, and its results."""
        named = saved_options(scene, start, duration, step, options)
        with self.locked(results, named) as whole:
            keeper = None
            if whole.path is not None:
                finished = self._finished(whole.path, named)
                if finished is not None:
                    whole.done = True
                    return finished
                start = self._unfinished(whole.run, start)
                keeper = whole.run
            history = call(scene, duration, step=step, start=start, keeper=keeper, **options)
            history.options = named
            return whole.written(Result(history))

    def _finished(self, path: Path, options: dict[str, str]) -> Result | None:
        """The run to resume, if it is complete."""
        if not self.resume or self.overwrite or not path.exists():
            return None
        found = Result.load(path)
        if other := different(options, found.history.options):
            raise InputError(
                f"results: '{path}' is of another run ({other}); go on with what it was run with, or begin anew with "
                "overwrite=True (--overwrite)"
            )
        if found.status == Status.INTERRUPTED:
            return None
        log.info("results: '%s' is finished: %s", path, found.status)
        return found

    def _unfinished(self, run: UnfinishedRun, start: Any) -> Any:
        """Start of the run: the last checkpoint if it is resumed."""
        if self.resume and not self.overwrite:
            found = run.load()
            if found is not None:
                log.info("results: continuing from '%s', %d parts", run.folder, run.parts)
            return start if found is None else replace(found, start=start)
        if run.has_checkpoint() and not self.overwrite:
            raise InputError(
                f"results: '{run.folder}' holds a run that has not ended; go on with resume=True (--resume), or begin "
                "anew with overwrite=True (--overwrite)"
            )
        run.clear()
        return start

    def record(self, result: Kind, path: Any, progress: bool) -> Kind:
        """Write the recording where there are rows to draw; the result gets a note where that is not possible."""
        if path is not None and len(result.time):
            _tried(result, "recording", Path(path), lambda: _record(result, path, progress))
        return result


def _tell_end(result: Result) -> None:
    """Log the status and the notes of a finished run; stages have each logged their own notes."""
    if result.status != Status.COMPLETED:
        after = f"; {what_follows()}" if result.status == Status.INTERRUPTED else ""
        log.warning("run ended early: %s: %s%s", result.status, result.message, after)
    if not hasattr(result, "stages"):
        for note in result.history.notes:
            notes.info("note: %s", note)


def _record(result: Result, path: Any, progress: bool) -> Path:
    if result.history.stopping:
        raise KeyboardInterrupt
    from warpffrf.output.recording.recorder import record

    info = record(result, path, overwrite=True, progress=progress)
    log.info("recording: %d frames, every %d of %d saved rows", info.frames, info.stride, len(result.time))
    return info.path


def _tried(result: Result, what: str, path: Path, write: Callable[[], Path]) -> bool:
    """Whether `write` succeeded; otherwise the result records the error."""
    begin = time.perf_counter()
    try:
        written = Written.of(what, write(), time.perf_counter() - begin)
    except KeyboardInterrupt:
        trouble = f"{what}: '{path}' was not written: interrupted by the user"
    except Exception as error:  # a full disk makes libraries raise any exception
        trouble = f"{what}: '{path}' could not be written: {error or type(error).__name__}; save it elsewhere"
    else:
        log.info("%s: %s", what, written)
        result.written.append(written)
        return True
    log.error(trouble)
    result.unwritten.append(trouble)
    result.history.notes.append(trouble)
    return False


def saved_options(scene: Any, start: Any, duration: float, step: float, options: dict[str, Any]) -> dict[str, str]:
    """What identifies a run, as text: the scene, its start, and its options."""
    found = {"scene": scene.content_hash(), "start": _start_name(start), "duration": repr(float(duration))}
    found["step"] = repr(float(step))
    return found | {name: repr(value) for name, value in options.items() if name not in FREE_OPTIONS}


def _start_name(start: Any) -> str:
    if not isinstance(start, History):
        return repr(start)
    digest = hashlib.blake2b(digest_size=16)
    for name in sorted(start.checkpoint):
        digest.update(name.encode() + np.ascontiguousarray(start.checkpoint[name]).tobytes())
    return f"a state at {time_of(start.checkpoint):.9g} s, {digest.hexdigest()}"
