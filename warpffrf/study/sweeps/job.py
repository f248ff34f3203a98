"""Work of a worker on rows: build, run, extract the outputs. It returns answers, plain data and arrays.

BLAS uses one thread, because workers run in parallel, and so that sums have the same order everywhere. A row that
cannot be run is also an answer, with its message; only a dead worker and an interrupt by the user give no answer.

Outputs. Stored quantities of a run: histories and fields by their names, reductions of these over time, or values of a
function.

    contact_force_z[lower-upper]          the history, with the times of the run
    max(contact_peak_pressure[lower-upper])   its largest value
    last(contact_pressure[lower-upper])   a field at the last saved step

Names are those of `Result.to_dataframe`; a name without component denotes all components, and spatial fields have the
names of the results file (`output/files/table.py`). Reductions over time:

    max, min, first, last   of each entry             range       max - min
    mean                    (1/T) int v dt            amplitude   range / 2
    rms                     sqrt((1/T) int v^2 dt)

with integrals by the trapezoidal rule over the T seconds that are saved; for a single saved step v itself. Entries that
are NaN at some times, such as quantities that exist only during contact, are ignored by max and min, and make a mean
NaN.
"""

from __future__ import annotations

import inspect
import logging
import platform
import re
import socket
import threading
import time
import warnings
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field
from functools import cache, partial
from typing import Any

import numpy as np
from threadpoolctl import ThreadpoolController

from warpffrf import __version__
from warpffrf.model.errors import InputError, unknown_name
from warpffrf.model.messages.status import Status
from warpffrf.online.device import chosen_device
from warpffrf.output.files.table import NoQuantity, quantity
from warpffrf.output.result import Result
from warpffrf.study.runs import CALLS, Run, combined, with_options
from warpffrf.study.sweeps.design import Row
from warpffrf.study.sweeps.functions import word_of
from warpffrf.study.sweeps.scenes import Built, Scenes, each_together, worlds_of

REFUSED, FAILED, LOST = "refused", "failed", "lost"  # statuses of rows in addition to those of results
NO_QUANTITY = "no quantity"  # for rows without an output that earlier ones had; if none had it the sweep ends
OTHER_VERSIONS = "other versions"  # for answers that are no rows: the sweep ends
ERROR_BUDGET = "error_budget"  # an output: the error budget of each run
OWN = "progress"  # the argument of the calls that the sweep sets itself
FILES = ("results", "record", "overwrite", "resume")  # options for files of single runs

Numbered = Sequence[tuple[int, Row]]
Ran = tuple[Result, float, str | None]  # of a row: its result, the seconds of its set-up, its device

_alone = threading.Lock()  # threads of a worker run sequentially: a process captures one graph at a time


@dataclass
class Answer:
    """Answer for row `number`: status, outputs (name -> `Value`), times [s], machine, and number of worlds in its
    graph."""

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
        """Whether there was a run, with any status."""
        return bool(self.values)


class NoCall(InputError):
    """The scene's options do not state how it is run, or include options reserved for the sweep."""


@cache
def versions() -> dict[str, str]:
    """Versions that affect numbers, name -> version; for Python without the part that does not affect pickles."""
    import scipy
    import warp

    numbers = {"warpffrf": __version__, "warp": warp.__version__, "numpy": np.__version__, "scipy": scipy.__version__}
    return {**numbers, "Python": ".".join(platform.python_version_tuple()[:2])}


@cache
def _threads() -> ThreadpoolController:
    """Controller of the threads in this process; creating it takes some milliseconds."""
    return ThreadpoolController()


@dataclass(frozen=True)
class Job:
    """A sweep without its rows. run: the call and its arguments, None for what comes with the scene."""

    scenes: Scenes
    outputs: Mapping[str, Output]
    run: Run | None = None
    error_budget: bool = False

    def call_of(self, built: Built) -> Run:
        """The call that is run on a scene, and its arguments except those about files. Raises `NoCall` where no call is
        specified, and where the arguments of the scene include one that a sweep sets itself."""
        call, arguments = self._call_of(built)
        if OWN in arguments:
            raise NoCall(
                f"sweep: {call}: {OWN} is an argument of sweep; give it there, and not among the arguments that come "
                "with the scene"
            )
        return call, {name: value for name, value in arguments.items() if name not in FILES}

    def _call_of(self, built: Built) -> Run:
        if self.run is not None:
            call, arguments = self.run
            return call, combined(built.runs.get(call, {}), arguments)
        for call in CALLS:
            if call in built.runs:
                return call, dict(built.runs[call])
        raise NoCall(
            "sweep: the scene has no run options; give run=functools.partial(wf.simulate, duration=..., "
            "step=...), or run=wf.equilibrium"
        )

    def answers(self, rows: Numbered, device: str | None) -> list[Answer]:
        """Run `rows`, each with its number: several as worlds of one graph if possible. Raises KeyboardInterrupt if a
        run is interrupted."""
        with _alone, _only_errors(), _threads().limit(limits=1):
            together = self._together(rows, device) if len(rows) > 1 else {}
            return [together.get(number) or self.answer(number, row, device) for number, row in rows]

    def answer(self, number: int, row: Row, device: str | None) -> Answer:
        """Run one row."""
        return self._answer(number, row, lambda: self._run(row, device))

    def _run(self, row: Row, device: str | None) -> Ran:
        """A row: its result, the seconds of its set-up, and the device."""
        begin = time.perf_counter()
        built = self.scenes.built(row)
        call, arguments = self.call_of(built)
        seconds = time.perf_counter() - begin
        arguments, device = on_device(call, arguments, device)
        with built.running(call):
            result = CALLS[call](built.scene, **arguments, progress=False)
        return result, seconds + float(result.history.counters.get("build_seconds", 0.0)), device

    def _together(self, rows: Numbered, device: str | None) -> dict[int, Answer]:
        """Answers, by number, for rows as worlds of one graph; rows without one must be run one by one."""
        begin = time.perf_counter()
        built: dict[int, Any] = {}
        runs: dict[int, Run] = {}
        for number, row in rows:
            with suppress(Exception):  # the single run reports the reason
                built[number] = self.scenes.built(row)
                runs[number] = self.call_of(built[number])
        if not runs:
            return {}
        call, arguments = next(iter(runs.values()))
        numbers = [number for number, run in runs.items() if run == (call, arguments)]
        arguments, device = on_device(call, arguments, device)
        worlds = worlds_of(call, arguments)
        if worlds is None or len(numbers) < 2:
            return {}
        given = dict(rows)

        def read(i: int, result: Result) -> Answer:
            seconds = float(result.history.counters.get("build_seconds", 0.0)) / len(numbers)
            return self._answer(numbers[i], given[numbers[i]], partial(tuple, (result, seconds, device)))

        found = each_together(worlds, [built[number].scene for number in numbers], read)
        answers = {number: one for number, one in zip(numbers, found, strict=True) if isinstance(one, Answer)}
        for answer in answers.values():
            answer.wall_seconds += (time.perf_counter() - begin) / len(answers)
            answer.worlds = len(answers)
        return answers

    def _answer(self, number: int, row: Row, run: Callable[[], Ran]) -> Answer:
        """Answer for a row from the result of `run`."""
        begin = time.perf_counter()
        result = None
        answer = Answer(number, "", host=socket.gethostname())
        answer.versions = ", ".join(f"{name} {version}" for name, version in versions().items())
        try:
            result, answer.set_up_seconds, device = run()
            if result.status == Status.INTERRUPTED:
                raise KeyboardInterrupt
            answer.device = chosen_device(device)
            self._read(answer, row, result)
            answer.status, answer.message = str(result.status), result.message
        except NoQuantity as error:
            answer.status, answer.message = NO_QUANTITY, str(error)
        except Exception as error:  # a failing row must not lose the others
            logging.getLogger("warpffrf").debug("sweep: run %d failed", number, exc_info=True)
            if result is not None and result.status != Status.COMPLETED:  # a function found no row, or a short one
                answer.status, answer.message = str(result.status), result.message
            elif isinstance(error, InputError):
                answer.status, answer.message = REFUSED, str(error)
            else:
                answer.status, answer.message = FAILED, f"{type(error).__name__}: {error}"
        answer.wall_seconds = time.perf_counter() - begin
        return answer

    def _read(self, answer: Answer, row: Row, result: Result) -> None:
        found = {name: output.of(name, row, result) for name, output in self.outputs.items()}
        if any(TIME in value.dims for value in found.values()):
            answer.time = np.asarray(result.time, dtype=float)
        if self.error_budget:
            for line in result.error_budget():
                largest = answer.budget.get(line.source, np.nan)
                answer.budget[line.source] = float(np.nanmax([largest, line.size])) if line.found else largest
        answer.values = found


def on_device(call: str, arguments: dict[str, Any], device: str | None) -> tuple[dict[str, Any], str | None]:
    """The arguments of a `call` with the `device` of the worker, and the device; None: that of the arguments."""
    if call == "equilibrium":
        device = device or arguments.get("device")
        return {**arguments, "device": device}, device
    own = arguments["options"].device if "options" in arguments else None
    return (arguments, own) if device is None else (with_options(arguments, device=device), device)


@contextmanager
def _only_errors() -> Iterator[None]:
    """Suppress log messages of runs below errors: they are part of their rows."""
    log = logging.getLogger("warpffrf")
    before = log.level
    log.setLevel(logging.ERROR)
    try:
        yield
    finally:
        log.setLevel(before)


TIME = "time"
MOST_AXES = 64  # of a NumPy array
CALL = re.compile(r"\s*([A-Za-z_]\w*)\s*\((.*)\)\s*", re.DOTALL)


@dataclass(frozen=True, eq=False)
class Value:
    """Output of one run: an array, the names of its axes (`time` first if it has one), unit and frame."""

    array: np.ndarray
    dims: tuple[str, ...] = ()
    units: str = ""
    frame: str = ""


def _mean(time: np.ndarray, values: np.ndarray) -> np.ndarray:
    if len(time) < 2:
        return values[-1]
    return np.trapezoid(values, time, axis=0) / (time[-1] - time[0])


def _of_finite(take: Callable[..., np.ndarray]) -> Callable[[np.ndarray, np.ndarray], np.ndarray]:
    def found(time: np.ndarray, values: np.ndarray) -> np.ndarray:
        with warnings.catch_warnings():
            warnings.filterwarnings("ignore", message="All-NaN")  # result is NaN
            return take(values, axis=0)

    return found


_largest, _least = _of_finite(np.nanmax), _of_finite(np.nanmin)


def _range(time: np.ndarray, values: np.ndarray) -> np.ndarray:
    return _largest(time, values) - _least(time, values)


REDUCTIONS: dict[str, Callable[[np.ndarray, np.ndarray], np.ndarray]] = {
    "max": _largest,
    "min": _least,
    "mean": _mean,
    "first": lambda time, values: values[0],
    "last": lambda time, values: values[-1],
    "rms": lambda time, values: np.sqrt(_mean(time, values**2)),
    "range": _range,
    "amplitude": lambda time, values: 0.5 * _range(time, values),
}


@dataclass(frozen=True)
class Named:
    """A quantity by its name, reduced over time by `reduction`, or with its times if that is ""."""

    text: str
    quantity: str
    reduction: str

    def of(self, name: str, row: Row, result: Any) -> Value:
        """The value in the run of a row. Raises `NoQuantity` if the run does not have it."""
        found = quantity(result, self.quantity)
        if not self.reduction:
            return Value(found.values, (TIME, *found.dims), found.units, found.frame)
        if not len(result.time):
            return Value(np.full(found.values.shape[1:], np.nan), found.dims, found.units, found.frame)
        array = REDUCTIONS[self.reduction](result.time, np.asarray(found.values, dtype=float))
        return Value(np.asarray(array, dtype=float), found.dims, found.units, found.frame)


@dataclass(frozen=True)
class Asked:
    """Value of a user function, called `title`, of a result, or of a result and the parameters of its row: a number or
    an array."""

    title: str
    function: Callable[..., Any]

    @property
    def text(self) -> str:
        """The name with a hash of the function, which identifies it when a sweep is resumed."""
        return f"{self.title}, code {word_of(self.function)}"

    def of(self, name: str, row: Row, result: Any) -> Value:
        """The value in the run of a row. Raises `InputError` if the function returns neither a number nor an array of
        numbers."""
        given = self.function(result, dict(row)) if required_arguments(self.function) > 1 else self.function(result)
        try:
            array = np.asarray(given, dtype=float)
        except (TypeError, ValueError):
            raise InputError(f"output {name!r}: {self.title} must give a number or an array, got {given!r}") from None
        return Value(array, axes_of_function(name, array.ndim))


def required_arguments(function: Callable[..., Any]) -> int:
    """The number of positional arguments without defaults; 1 of functions that Python cannot inspect."""
    try:
        parameters = inspect.signature(function).parameters.values()
    except (TypeError, ValueError):
        return 1
    return sum(p.kind in (p.POSITIONAL_ONLY, p.POSITIONAL_OR_KEYWORD) and p.default is p.empty for p in parameters)


def axes_of_function(name: str, count: int) -> tuple[str, ...]:
    """Names of the axes of an array returned by a function for output `name`."""
    return tuple(f"{name}[{n}]" for n in range(count))


Output = Named | Asked


def outputs_of(given: Any, taken: Sequence[str]) -> dict[str, Output]:
    """The outputs, by name, `given` as {name: text or function} or as a list of texts; `taken`: reserved names. Raises
    `InputError`."""
    if isinstance(given, str):
        given = [given]
    if not isinstance(given, Mapping):
        if not isinstance(given, Sequence) or not all(isinstance(one, str) for one in given):
            raise InputError(f"sweep: outputs must be {{name: text or function}}, or a list of texts, got {given!r}")
        given = {one: one for one in given}
    if not given:
        raise InputError("sweep: no output is given; for example outputs=['max(energy[kinetic])']")
    found: dict[str, Output] = {}
    for name, what in given.items():
        if not isinstance(name, str) or not name or "/" in name or name in (".", ".."):
            raise InputError(f"sweep: {name!r} is no name of an output; give it another one, {{name: what}}")
        if name in taken and not name == what == ERROR_BUDGET:
            raise InputError(f"sweep: an output cannot be called {name!r}, which is used in the table; rename it")
        if isinstance(what, str):
            found[name] = _named(name, what)
        elif callable(what):
            found[name] = Asked(getattr(what, "__name__", type(what).__name__) + "()", what)
        else:
            raise InputError(f"sweep: output {name!r} must be a text or a function of a result, got {what!r}")
    axes = {
        axis: name
        for name, one in found.items()
        if isinstance(one, Asked)
        for axis in axes_of_function(name, MOST_AXES)
    }
    for name in (*found, *taken):
        if name in axes:
            raise InputError(f"sweep: {name!r} is what an axis of output {axes[name]!r} is called; rename one of them")
    return found


def _named(name: str, text: str) -> Named:
    call = CALL.fullmatch(text)
    if call is None:
        return Named(text, text.strip(), "")
    if call[1] not in REDUCTIONS:
        raise unknown_name(f"sweep: output {name!r}: over time", call[1], REDUCTIONS)
    return Named(text, call[2].strip(), call[1])
