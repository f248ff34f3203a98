"""`sweep`: rows are sent to workers, answers are collected and stored.

The first row is run before the others are sent: missing outputs, workers with other versions and scenes that cannot be
run are then reported early, and kernels are compiled once. Every answer is stored on arrival, so that Ctrl-C, SIGTERM
and a kill lose no completed run.
"""

from __future__ import annotations

import logging
import os
from collections import Counter, deque
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import FIRST_COMPLETED, wait
from typing import Any

from threadpoolctl import threadpool_limits

from warpffrf.model.errors import InputError, require_count
from warpffrf.model.messages.named_arguments import named_arguments
from warpffrf.model.messages.progress import Progress, deferred_interrupts, speaking, terminated_as_interrupted
from warpffrf.output.result import Result
from warpffrf.study.runs import Run, run_of, with_options
from warpffrf.study.sweeps.cluster import Cluster, client_at
from warpffrf.study.sweeps.design import Design, Row, design_of
from warpffrf.study.sweeps.executors import Answers, Elsewhere, Executor, Here, Processes, WorkerDied, refuse_in_workers
from warpffrf.study.sweeps.folder import Folder
from warpffrf.study.sweeps.job import (
    ERROR_BUDGET,
    FILES,
    LOST,
    NO_QUANTITY,
    OTHER_VERSIONS,
    OWN,
    Answer,
    Job,
    NoCall,
    outputs_of,
    versions,
)
from warpffrf.study.sweeps.outcome import Sweep
from warpffrf.study.sweeps.packing import packed
from warpffrf.study.sweeps.scenes import scenes_of
from warpffrf.study.sweeps.table import TAKEN

MOST_TRIES = 3  # for a row whose worker dies
UNPROVED = 3  # rows tried one by one until one of them has been run
LOOK_EVERY = 0.5  # s: an unlimited wait does not react to Ctrl-C on all systems

log = logging.getLogger("warpffrf")


@named_arguments
def sweep(
    scene: str | os.PathLike[str] | Callable[..., Any],
    parameters: Mapping[str, Any] | Sequence[Mapping[str, Any]],
    *,
    outputs: Mapping[str, Any] | Sequence[str],
    store: str | os.PathLike[str],
    sample: str | None = None,
    settings: Sequence[str] = (),
    run: Callable[..., Result] | None = None,
    workers: int | Sequence[str] | Any = 1,
    worlds: int = 1,
    overwrite: bool = False,
    resume: bool = False,
    progress: bool = True,
) -> Sweep:
    """Run a scene at many values of its parameters and store the requested outputs of each run in one table.

    scene: a scene file, or a function `build(**parameters)` that returns a Scene, or a Scene and a run.
    parameters: {name: values}, of a file dotted names as of `--set`; values are a list, a range "1000:5000:5" or
    "log:1e-3:1:4", a distribution as "normal(0.1, 0.02)" or one of scipy.stats. All combinations are run, or a `sample`
    "latin:64", "sobol:64", "random:64" or "saltelli:64", with another seed than 0 "latin:64:SEED"; or rows as they
    are, [{name: value}, ...] or a table of pandas. outputs: {name: what} or a list of texts; what is
    "max(contact_peak_pressure[a-b])", a history by its name in `Result.to_dataframe`, or a function of a Result, or of
    a Result and the row's parameters {name: value}, that gives a number or an array (`warpffrf.study.sweeps.job`);
    "error_budget" is the error budget of each run. store: the folder of the sweep, NAME.sweep. settings: "name=value"
    as of `--set`, for all rows. run: `wf.simulate`, `wf.static` or `wf.equilibrium`, or functools.partial of one of
    them with arguments, which prevail over those that come with the scene; None: what comes with the scene.

    workers: number of processes of this machine; or the device of each, ["cuda:0", "cuda:1"]; or a
    `distributed.Client`, the address of its scheduler "tcp://HOST:8786", or another executor with the `submit` of
    concurrent.futures. worlds: run so many rows at once as worlds of one graph, where their scenes differ in
    numbers only: less set-up for short runs, and the purpose of a GPU.
    Numbers are the same bit for bit for all kinds of workers, and on a CPU for any number of worlds.

    A row that cannot be run is stored with its message. Ctrl-C and SIGTERM keep completed runs; resume: continue a
    sweep in the store; completed rows, including failed ones, are not repeated. overwrite: replace the sweep. progress:
    report the progress on stderr. Raises InputError for unknown parameters and outputs, a store of another sweep, a
    scheduler that does not answer, and workers with other versions.

    >>> found = wf.study.sweep(  # doctest: +SKIP
    ...     "press.toml", {"upper.load": "1000:5000:5", "radius": [0.04, 0.05]}, workers=2, store="press.sweep",
    ...     outputs={"peak": "max(contact_peak_pressure[lower-upper])"}, run=wf.equilibrium,
    ... )
    >>> found.to_dataframe()  # doctest: +SKIP
    """
    refuse_in_workers()
    worlds = require_count(worlds, "sweep: worlds", 1)
    called = None if run is None else _checked(*run_of(run, "sweep"))
    devices = _devices(workers)
    with terminated_as_interrupted(), speaking(progress):
        scenes = scenes_of(scene, settings)
        design = design_of(parameters, sample)
        for name in design.names:
            if name in TAKEN or "/" in name or not name:
                raise InputError(f"sweep: a parameter cannot be called {name!r}; rename it in the scene")
        wanted = outputs_of(outputs, (*TAKEN, *design.names))
        error_budget = wanted.pop(ERROR_BUDGET, None) is not None
        if not wanted:
            raise InputError("sweep: no output is asked for besides the error budget; give one")
        scenes.check(design.rows[0])
        job = Job(scenes, wanted, called, error_budget)
        definition = _definition(job, design)
        folder = Folder(store)
        try:
            done = folder.begin(definition, design, overwrite=overwrite, resume=resume)
            left = [(n, row) for n, row in enumerate(design.rows) if n not in done]
            if done:
                log.info("sweep: %d of %d rows have been run", len(done), len(design.rows))
            if left:
                executor = _executor(job, folder, workers, devices)
                _run(executor, left, worlds, folder, len(design.rows), progress)
        except (OSError, EOFError) as error:  # a full disk, or the process that starts workers was killed
            reason = getattr(error, "strerror", None) or str(error) or type(error).__name__
            raise InputError(
                f"sweep: the system refuses what store '{folder.path}' needs ({reason}); rows that have been run are "
                "kept: correct this, and continue with resume=True (--resume)"
            ) from error
        finally:
            folder.release()
        return Sweep(store)


def _checked(call: str, arguments: dict[str, Any]) -> Run:
    """The run of all rows. Raises `InputError` for arguments that are not its to give."""
    if OWN in arguments:
        raise InputError(f"sweep: {call}: {OWN} is an argument of sweep")
    for name in arguments:
        if name in FILES:
            raise InputError(f"sweep: {call}: {name} is about files of single runs, which a sweep does not write")
    return call, arguments


def _devices(workers: Any) -> list[str | None]:
    """The device of each process of this machine, None for that of the run; none for workers elsewhere."""
    if isinstance(workers, str) or hasattr(workers, "submit"):
        return []
    if isinstance(workers, Sequence):
        if not workers or not all(isinstance(one, str) for one in workers):
            raise InputError(f"sweep: workers must be devices as 'cuda:0', one for each process, got {workers!r}")
        return list(workers)
    if not isinstance(workers, int | float):
        raise InputError(
            "sweep: workers must be a number of processes, a list of devices, a distributed.Client, the address of a "
            f"scheduler, or an executor, got {workers!r}"
        )
    return [None] * require_count(workers, "sweep: workers", 1)


def _definition(job: Job, design: Design) -> dict[str, Any]:
    """Definition that identifies a sweep, as plain data; the first scene is None if it cannot be built, which its row
    reports. Raises `NoCall`."""
    first, (call, options) = None, job.run or ("simulate", {})
    try:
        with threadpool_limits(1):  # as in workers
            built = job.scenes.built(design.rows[0])
        call, options = job.call_of(built)
        if "options" in options:
            options = with_options(options, device=None)  # numbers do not depend on it
        first = built.scene.content_hash()
    except NoCall:
        raise
    except Exception as error:  # a builder of the user may raise anything
        log.debug("sweep: the first scene cannot be built: %s", error)
    return {
        "kind": "warpffrf sweep", "title": job.scenes.title, "count": len(design.rows), "parameters": design.texts,
        "sample": design.sample, "seed": design.seed, "rows": design.digest(), "call": call,
        "options": {name: repr(value) for name, value in options.items() if name not in (*FILES, "device")},
        "outputs": {name: output.text for name, output in job.outputs.items()}, "error_budget": job.error_budget,
        "scenes": job.scenes.digest(), "first_scene": first, "versions": versions(),
    }  # fmt: skip


def _executor(job: Job, folder: Folder, workers: Any, devices: list[str | None]) -> Executor:
    """The executor of the rows."""
    if len(devices) == 1:
        return Here(job, devices[0])
    payload = packed(job, folder.bodies)
    if devices:
        return Processes(payload, devices)
    own = isinstance(workers, str)
    client = client_at(workers) if own else workers
    if hasattr(client, "get_executor") and hasattr(client, "scheduler_info"):
        return Cluster(payload, client, own)
    return Elsewhere(payload, client)


def _run(
    executor: Executor, left: list[tuple[int, Row]], worlds: int, folder: Folder, count: int, progress: bool
) -> None:
    """Run the remaining rows, and store their answers."""
    bar = Progress("sweep", count, enabled=progress, unit="run", done=count - len(left))
    keeping = _Keeping(folder, bar, count - len(left))
    try:
        _dispatch(executor, left, worlds, keeping)
    except KeyboardInterrupt:
        log.warning(
            "sweep: interrupted, %d of %d rows have been run; continue with resume=True (--resume)", keeping.done, count
        )
    finally:
        bar.close()
        with deferred_interrupts():
            try:
                executor.close()
            finally:
                folder.gather()


class _Keeping:
    """Stores answers, and reports the progress of the sweep."""

    def __init__(self, folder: Folder, bar: Progress, done: int) -> None:
        self.folder, self.bar, self.done = folder, bar, done
        self.proved = folder.has_values  # whether a row has had the outputs, also before a sweep was resumed
        self.answers, self.lost = 0, 0  # answers so far, and lost ones

    @property
    def open(self) -> bool:
        """Whether rows may be sent in parallel."""
        return self.proved or self.answers >= UNPROVED

    def take(self, answer: Answer) -> None:
        """Store a row. Raises `InputError` if its worker has other versions, and if no run has had the outputs."""
        if answer.status == OTHER_VERSIONS:
            raise InputError(
                f"sweep: the worker on {answer.host} has other versions ({answer.message}), and its numbers would be "
                "others; install the same on all workers, and go on with resume=True (--resume)"
            )
        self.lost += answer.status == LOST
        if self.lost >= UNPROVED and not self.proved:
            raise InputError(
                f"sweep: workers die before any row has been run, {UNPROVED} rows were tried {MOST_TRIES} times each; "
                "run one here, workers=1, to see why"
            )
        if answer.status == NO_QUANTITY and not self.proved:
            raise InputError(f"sweep: outputs: {answer.message}")
        with deferred_interrupts():
            self.folder.keep(answer)
            self.done, self.answers, self.proved = self.done + 1, self.answers + 1, self.proved or answer.ran
        self.bar.update(self.done)


def _dispatch(executor: Executor, left: list[tuple[int, Row]], worlds: int, keeping: _Keeping) -> None:
    """Rows are sent in packs of `worlds`; those of a dead worker are sent again one by one, to identify the row that
    caused it."""
    waiting = deque(left[n : n + worlds] for n in range(0, len(left), worlds))
    out: dict[Answers, list[tuple[int, Row]]] = {}
    deaths: Counter[int] = Counter()
    while waiting or out:
        while waiting and len(out) < (executor.capacity if keeping.open else 1):
            pack = waiting.popleft()
            out[executor.submit(pack)] = pack
        ended, _ = wait(out, timeout=LOOK_EVERY, return_when=FIRST_COMPLETED)
        for future in ended:
            pack = out.pop(future)
            try:
                answers = executor.collect(future)
            except WorkerDied:
                log.warning("sweep: a worker died at row %s; it is run again", ", ".join(str(n) for n, _ in pack))
                deaths[pack[0][0]] += len(pack) == 1
                if deaths[pack[0][0]] < MOST_TRIES:
                    waiting.extendleft([one] for one in reversed(pack))
                    continue
                message = f"its worker died {MOST_TRIES} times; memory may be short, or try it by itself"
                answers = [Answer(pack[0][0], LOST, message)]
            for answer in answers:
                keeping.take(answer)
