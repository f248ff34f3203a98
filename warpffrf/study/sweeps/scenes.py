"""Source of the scene of a row: a scene file with the parameters set, or a function of the parameters.

Together. Rows that run as worlds of one graph, as in `simulate_worlds` and `equilibria`.

Their numbers are those of single runs, bit for bit on a CPU. The outputs of a row are read as soon as its run has
ended, and its histories are dropped. A scene that has a different structure from the first, or is invalid, is run or
refused by itself afterwards, as are all if a graph of them cannot be made, and with options that worlds do not support.
The table contains the number of worlds of each row.
"""

from __future__ import annotations

import hashlib
import inspect
import json
import os
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import AbstractContextManager, contextmanager
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any, Protocol

from warpffrf.model.errors import InputError, unknown_name
from warpffrf.output.result import Result
from warpffrf.output.worlds import Runs, each_of, rests, simulations
from warpffrf.scene_file.document import merged_document, resolved, with_settings
from warpffrf.scene_file.load import scene_of_document
from warpffrf.scene_file.object_cache import Kept
from warpffrf.scene_file.source import Source
from warpffrf.study.runs import CALLS, run_of
from warpffrf.study.sweeps.design import Row
from warpffrf.study.sweeps.functions import word_of


@dataclass(frozen=True)
class Built:
    """The scene of a row, and `runs`, the arguments of calls that come with it, by the name of the call. running: a
    context for the call, which states the position of a refused argument in a file."""

    scene: Any
    runs: Mapping[str, Mapping[str, Any]]
    running: Callable[[str], AbstractContextManager[None]]


class Scenes(Protocol):
    """Builder of the scenes of a sweep."""

    title: str

    def check(self, row: Row) -> None:
        """Raises `InputError` for a name that is no parameter of the builder."""
        ...

    def digest(self) -> str:
        """A hash that changes if scenes of the same parameters change, as far as detectable."""
        ...

    def built(self, row: Row) -> Built:
        """The scene of a row. Raises `InputError`."""
        ...


class FileScenes:
    """A scene file; parameters are dotted names as of `--set`. It is read once, with all its includes, and sent to
    workers in that state: it may be edited while the sweep runs."""

    def __init__(self, path: str | os.PathLike[str], settings: Sequence[str]) -> None:
        file = Path(path).expanduser().absolute()
        if not file.is_file():
            raise InputError(f"sweep: scene file {str(path)!r} does not exist; check the path")
        self._name, self._document, self._kept = file.stem, merged_document(file, settings), Kept()
        self.title = str(self._document.values.get("title", self._name))

    def __getstate__(self) -> dict[str, Any]:
        return {**vars(self), "_kept": Kept()}  # workers have their own

    def check(self, row: Row) -> None:
        """Check names and types of values against the file."""
        self._read(row)

    def digest(self) -> str:
        """Hash of the file with all its includes."""
        values = json.dumps(self._document.values, sort_keys=True, default=str)
        return hashlib.sha256(values.encode()).hexdigest()

    def built(self, row: Row) -> Built:
        """Scene of the file with the values of the row set."""
        found = scene_of_document(self._read(row), self._name, self._kept)
        runs = {call: arguments for call in CALLS if (arguments := getattr(found, call)) is not None}
        return Built(found.scene, runs, found.running)

    def _read(self, row: Row) -> Source:
        return resolved(with_settings(self._document, [f"{name}={_toml(value)}" for name, value in row.items()]))


def _toml(value: Any) -> str:
    """A value in the syntax of `--set`; numbers with every digit."""
    return str(value).lower() if isinstance(value, bool) else str(value)


class FunctionScenes:
    """A function `build(**parameters)` that returns a Scene, or a Scene and a run, as `sweep(run=)`."""

    def __init__(self, function: Callable[..., Any]) -> None:
        self.function = function
        self.title = getattr(function, "__name__", type(function).__name__)

    def check(self, row: Row) -> None:
        """Its arguments are the parameters."""
        try:
            signature = inspect.signature(self.function)
        except (TypeError, ValueError):  # for a callable without signature the first row shows it
            return
        known = [p.name for p in signature.parameters.values() if p.kind in (p.POSITIONAL_OR_KEYWORD, p.KEYWORD_ONLY)]
        if not any(p.kind is p.VAR_KEYWORD for p in signature.parameters.values()):
            for name in row:
                if name not in known:
                    raise unknown_name(f"sweep: parameter of {self.title}()", name, known)
        try:
            signature.bind(**row)
        except TypeError as error:
            raise InputError(f"sweep: {self.title}() cannot be called with the parameters alone: {error}") from None

    def digest(self) -> str:
        """Its name and hash; functions that it calls are covered by the scene of the first row."""
        return f"{getattr(self.function, '__module__', '')}.{self.title} {word_of(self.function)}"

    def built(self, row: Row) -> Built:
        """Call the function."""
        found = self.function(**row)
        scene, run = found if isinstance(found, tuple) and len(found) == 2 else (found, None)
        if not hasattr(scene, "content_hash"):
            raise InputError(f"sweep: {self.title}() must return a Scene, or a Scene and a run, got {found!r}")
        return Built(scene, {} if run is None else dict([run_of(run, f"sweep: {self.title}()")]), _as_it_is)


@contextmanager
def _as_it_is(call: str) -> Iterator[None]:
    yield


def scenes_of(scene: Any, settings: Sequence[str]) -> Scenes:
    """The scene builder for the user's argument; raises `InputError` for anything else."""
    if isinstance(scene, str | os.PathLike):
        return FileScenes(scene, settings)
    if settings:
        raise InputError("sweep: settings are those of a scene file; let the function have its values by itself")
    if callable(scene):
        return FunctionScenes(scene)
    raise InputError(
        f"sweep: give a scene file, or a function build(**parameters) that returns a Scene, got {scene!r}; a Scene "
        "that is built has no parameters"
    )


WORLDS: dict[str, Callable[..., Runs]] = {
    "simulate": simulations, "static": partial(simulations, kind="static"), "equilibrium": rests,
}  # fmt: skip


def worlds_of(call: str, arguments: Mapping[str, Any]) -> Runs | None:
    """The runs of scenes as worlds; None if they must be run one by one."""
    try:
        inspect.signature(WORLDS[call]).bind(**arguments)
        return WORLDS[call](**arguments)
    except (TypeError, InputError):  # a single run reports what is wrong
        return None


def each_together(runs: Runs, scenes: Sequence[Any], read: Callable[[int, Result], Any]) -> list[Any]:
    """What `read` returns of the number and the Result of each scene; for a scene that was refused the error."""
    return each_of(runs, scenes, lambda i, history: read(i, Result(history)), alike=False, progress=False)
