"""What a worker does with rows: build, run, read off what is wanted. It sends back answers, plain data and arrays.

The threads of a BLAS are limited to one, for workers side by side, and so that sums are made in one order everywhere.
A row that cannot be run is an answer too, with its message; what is not answered is a worker that died, and a user who
interrupts.
"""

from __future__ import annotations

import logging
import platform
import socket
import threading
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from functools import cache, partial
from typing import Any

import numpy as np
from threadpoolctl import ThreadpoolController

from warpffrf import __version__
from warpffrf.model.errors import InputError
from warpffrf.online.device import chosen_device
from warpffrf.online.run import INTERRUPTED
from warpffrf.output.files.quantities import NoQuantity
from warpffrf.output.result import Result
from warpffrf.output.simulate import equilibrium, simulate
from warpffrf.study.sweeps.design import Row
from warpffrf.study.sweeps.outputs import TIME, Output, Value
from warpffrf.study.sweeps.scenes import Built, Scenes
from warpffrf.study.sweeps.together import results_together

REFUSED, FAILED, LOST = "refused", "failed", "lost"  # statuses of rows beside those of results
NO_QUANTITY = "no quantity"  # of rows without an output that earlier ones had; where none had it the sweep ends
OTHER_VERSIONS = "other versions"  # of answers that are no rows: the sweep ends
CALLS = {"simulate": simulate, "equilibrium": equilibrium}
OWN = ("progress", "device")  # options of the calls that a sweep says itself
FILES = ("results", "record", "record_every", "overwrite", "resume", "keep_every")  # those about files of single runs

Numbered = Sequence[tuple[int, Row]]

_alone = threading.Lock()  # threads of a worker run one after the other: a process captures one graph at a time


@dataclass
class Answer:
    """What came of row `number`: how it ended, what was wanted of it (name -> `Value`), what it took [s], where, and
    in how many worlds of one graph it ran."""

    number: int
    status: str
    message: str = ""
    values: dict[str, Value] = field(default_factory=dict)
    time: np.ndarray | None = None
    budget: dict[str, float] = field(default_factory=dict)
    wall_seconds: float = 0.0
    set_up_seconds: float = 0.0
    device: str = ""
    host: str = ""
    versions: str = ""
    worlds: int = 1

    @property
    def ran(self) -> bool:
        """Whether there was a run, however it ended."""
        return bool(self.values)


class NoCall(InputError):
    """What a scene comes with does not say how it is run, or says what is not its to say."""


@cache
def versions() -> dict[str, str]:
    """What numbers depend on, name -> version; of Python without what does not matter to pickles."""
    import scipy
    import warp

    numbers = {"warpffrf": __version__, "warp": warp.__version__, "numpy": np.__version__, "scipy": scipy.__version__}
    return {**numbers, "Python": ".".join(platform.python_version_tuple()[:2])}


@cache
def _threads() -> ThreadpoolController:
    """What limits threads in this process; to look for it takes some milliseconds."""
    return ThreadpoolController()


@dataclass(frozen=True)
class Job:
    """A sweep without its rows. simulate, equilibrium: options of the call, None for those that come with the scene."""

    scenes: Scenes
    outputs: Mapping[str, Output]
    simulate: Mapping[str, Any] | None = None
    equilibrium: Mapping[str, Any] | None = None
    error_budget: bool = False

    def call_of(self, built: Built) -> tuple[str, dict[str, Any]]:
        """Which call is made of a scene, and its options but those about files. Raises `NoCall` where nothing says it,
        and where the options that come with the scene have some that a sweep says itself."""
        call, options = self._call_of(built)
        for name in OWN:
            if name in options:
                raise NoCall(
                    f"sweep: {call}: {name} is an argument of sweep; give it there, and not among the options that "
                    "come with the scene"
                )
        return call, {name: value for name, value in options.items() if name not in FILES}

    def _call_of(self, built: Built) -> tuple[str, dict[str, Any]]:
        if self.equilibrium is not None:
            return "equilibrium", {**(built.equilibrium or {}), **self.equilibrium}
        if self.simulate is not None or built.simulate is not None:
            return "simulate", {**(built.simulate or {}), **(self.simulate or {})}
        if built.equilibrium is not None:
            return "equilibrium", dict(built.equilibrium)
        raise NoCall(
            "sweep: nothing says how to run the scene; give simulate={'duration': ..., 'step': ...}, or equilibrium={}"
        )

    def answers(self, rows: Numbered, device: str | None) -> list[Answer]:
        """Run `rows`, each with its number: several as worlds of one graph where they can be. Raises KeyboardInterrupt
        where a run is interrupted."""
        with _alone, _only_errors(), _threads().limit(limits=1):
            together = self._together(rows, device) if len(rows) > 1 else None
            return together or [self.answer(number, row, device) for number, row in rows]

    def answer(self, number: int, row: Row, device: str | None) -> Answer:
        """Run one row."""
        return self._answer(number, device, lambda: self._run(row, device))

    def _run(self, row: Row, device: str | None) -> tuple[Result, float]:
        """The result of a row, and the seconds of its set-up."""
        begin = time.perf_counter()
        built = self.scenes.built(row)
        call, options = self.call_of(built)
        seconds = time.perf_counter() - begin
        with built.running(call):
            result = CALLS[call](built.scene, **options, device=device, progress=False)
        return result, seconds + float(result.history.counters.get("build_seconds", 0.0))

    def _together(self, rows: Numbered, device: str | None) -> list[Answer] | None:
        """Answers to rows as worlds of one graph; None where they have to run one by one."""
        begin = time.perf_counter()
        try:
            built = [self.scenes.built(row) for _, row in rows]
            calls = [self.call_of(one) for one in built]
        except Exception:  # of which row, and why, it says when it runs by itself
            return None
        if any(call != "simulate" for call, _ in calls):
            return None
        seconds = time.perf_counter() - begin
        results = results_together([one.scene for one in built], [options for _, options in calls], device)
        if results is None:
            return None
        share = (time.perf_counter() - begin) / len(rows)
        seconds = (seconds + float(results[0].history.counters.get("build_seconds", 0.0))) / len(rows)
        found = []
        for (number, _), result in zip(rows, results, strict=True):
            answer = self._answer(number, device, partial(tuple, (result, seconds)))
            answer.wall_seconds += share
            answer.worlds = len(rows)
            found.append(answer)
        return found

    def _answer(self, number: int, device: str | None, run: Callable[[], tuple[Result, float]]) -> Answer:
        """What came of `run`."""
        begin = time.perf_counter()
        answer = Answer(number, "", host=socket.gethostname())
        answer.versions = ", ".join(f"{name} {version}" for name, version in versions().items())
        try:
            result, answer.set_up_seconds = run()
            if result.status == INTERRUPTED:
                raise KeyboardInterrupt
            answer.device = chosen_device(device)
            self._read(answer, result)
            answer.status, answer.message = result.status, result.message
        except NoQuantity as error:
            answer.status, answer.message = NO_QUANTITY, str(error)
        except InputError as error:
            answer.status, answer.message = REFUSED, str(error)
        except Exception as error:  # a row that fails is no reason to lose the others
            logging.getLogger("warpffrf").debug("sweep: run %d failed", number, exc_info=True)
            answer.status, answer.message = FAILED, f"{type(error).__name__}: {error}"
        answer.wall_seconds = time.perf_counter() - begin
        return answer

    def _read(self, answer: Answer, result: Result) -> None:
        found = {name: output.of(name, result) for name, output in self.outputs.items()}
        if any(TIME in value.dims for value in found.values()):
            answer.time = np.asarray(result.time, dtype=float)
        if self.error_budget:
            for line in result.error_budget():
                largest = answer.budget.get(line.source, np.nan)
                answer.budget[line.source] = float(np.nanmax([largest, line.size])) if line.found else largest
        answer.values = found


@contextmanager
def _only_errors() -> Iterator[None]:
    """What runs have to say goes into their rows."""
    log = logging.getLogger("warpffrf")
    before = log.level
    log.setLevel(logging.ERROR)
    try:
        yield
    finally:
        log.setLevel(before)
