"""One instance of an FMU that was made of a scene: values by name, communication steps, states.

A communication step from t_n to t_(n+1) = t_n + k h makes k steps h of a `Simulation`. An input u that is set to u_n at
t_n is reached linearly at the end of the first of them, t_n + h, and holds until t_(n+1); one that is set in the
initialisation is the initial value. Outputs at t_n depend on inputs before t_n only: two FMUs in a loop need no
iteration.

The library that stands between an importing tool and Python frees the instance when a method raises, and the next call
then ends the process. No method raises: what is wrong is logged, is the text of `status`, and makes `step` return
False, with which the importing tool gets the FMI status "discard" and the flag "terminated". Nothing has changed then:
with another value, another step or an earlier state it goes on.
"""

from __future__ import annotations

import io
import json
import math
from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import cached_property, wraps
from pathlib import Path
from typing import Any

import numpy as np

from warpffrf.model.errors import MOST_COUNTED, InputError
from warpffrf.model.messages.status import Status
from warpffrf.output.options import RunOptions
from warpffrf.output.simulation import Simulation
from warpffrf.scene_file import LoadedScene, load_scene

SCENE, DEFINITION = "scene.toml", "definition.json"  # names of files in the resources of an FMU
STATUS, TIME = "status", "time"  # names of the text that says what went wrong, and of the time in an FMU 3.0
SAME_STEPS = 1e-6  # of a step: a communication step that is as near to a multiple is one
SAME_POINT = 1e-3  # of a step: between the time of the importing tool, a sum of its own, and that of the instance
BEGIN = "fmu_begin"  # in a state: time [s] of the importing tool at which the simulation began


def reported(otherwise: Any) -> Callable[[Callable[..., Any]], Callable[..., Any]]:
    """A method whose errors are reported, with the value `otherwise` in place of its own."""

    def wrap(method: Callable[..., Any]) -> Callable[..., Any]:
        @wraps(method)
        def call(self: Instance, *arguments: Any) -> Any:
            try:
                return method(self, *arguments)
            except Exception as error:  # see the module: whatever is raised beyond here ends the process
                self.report(str(error) if isinstance(error, InputError) else f"{type(error).__name__}: {error}")
                return otherwise

        return call

    return wrap


def run_step(loaded: LoadedScene) -> float:
    """The step of a packed scene [s]."""
    return (loaded.simulate or {})["step"]


def simulation_of(loaded: LoadedScene) -> Simulation:
    """The simulation of a packed scene, as its [simulate] says; it keeps as few rows as there may be."""
    table = loaded.simulate or {}
    options = replace(table.get("options", RunOptions()), save_every=MOST_COUNTED)
    start = table.get("start", "initial")
    return Simulation(loaded.scene, step=run_step(loaded), start=start, outputs=[], options=options)


class Instance:
    """The scene in the folder `resources` of an FMU. log: called with each message of what went wrong."""

    def __init__(self, resources: Path, log: Callable[[str], object]) -> None:
        self._folder, self._log = Path(resources), log
        self.definition: dict[str, Any] = json.loads((self._folder / DEFINITION).read_text(encoding="utf-8"))
        self.values: dict[str, float] = {each["name"]: each["start"] for each in self.definition["inputs"]}
        self.status = str(Status.COMPLETED)
        self._wrong: dict[str, str] = {}  # messages of values that were refused, by input
        self._simulation: Simulation | None = None
        self._initial: dict[str, float] = {}  # values that the simulation has begun with
        self._begin: float | None = None  # [s], of the importing tool; None: at its first communication point
        self._origin = 0.0  # [s], of the simulation
        self._initialising = True

    def report(self, message: str) -> None:
        """Log what went wrong; it is the `status` from now on."""
        self.status = message
        self._log(message)

    # --- before the first step

    def begin(self, time: float) -> None:
        """Let the simulation begin at this time [s] of the importing tool."""
        self._begin = float(time)

    @cached_property
    def _loaded(self) -> LoadedScene:
        return load_scene(self._folder / SCENE)

    @property
    def step_size(self) -> float:
        """The step of the simulation [s]."""
        return run_step(self._loaded)

    @reported(None)
    def end_initialisation(self) -> None:
        """Begin with the values of the inputs as they are now."""
        self._run()
        self._initialising = False

    def _run(self) -> Simulation:
        """The simulation, which is begun anew if the values of inputs changed in the initialisation."""
        if self._simulation is not None and (not self._initialising or self._initial == self.values):
            return self._simulation
        if self._wrong:
            raise InputError("; ".join(self._wrong.values()))
        known = simulation_of(self._loaded) if self._simulation is None else self._simulation
        self._origin = known.time
        sources = known.inputs.sources
        if any(sources[name].initial != value for name, value in self.values.items()):
            for name, value in self.values.items():
                sources[name].initial = value
            known = simulation_of(self._loaded)
        self._simulation, self._initial = known, dict(self.values)
        if known.status != Status.COMPLETED:
            raise InputError(f"it did not start ({known.status}: {known.message})")
        return known

    @property
    def time(self) -> float:
        """The present time of the importing tool [s]."""
        return (self._begin or 0.0) + (0.0 if self._simulation is None else self._simulation.time - self._origin)

    # --- values

    @reported(None)
    def set(self, name: str, value: float) -> None:
        """Set an input. One that is not finite is refused: no step is made until there is another value."""
        if not math.isfinite(value):
            self._wrong[name] = f"input {name!r} must be a finite number, got {value}; set another value"
            raise InputError(self._wrong[name])
        self._wrong.pop(name, None)
        self.values[name] = float(value)
        if self._simulation is not None and not self._initialising:
            self._simulation.inputs[name] = value

    @reported(math.nan)
    def get(self, name: str) -> float:
        """The value of an input, as it was set last, or the present one of an output; NaN where there is none."""
        return self.values[name] if name in self.values else float(self._run().outputs[name])

    # --- steps

    @reported(False)
    def step(self, time: float, duration: float) -> bool:
        """Make a communication step of `duration` [s] from `time` [s] of the importing tool; whether it succeeded."""
        if self._wrong:
            raise InputError("; ".join(self._wrong.values()))
        run, h = self._run(), self.step_size
        self._initialising = False
        steps = round(duration / h) if math.isfinite(duration) else 0
        if steps < 1 or abs(steps * h - duration) > SAME_STEPS * h:
            near = max(steps, 1) * h
            raise InputError(
                f"the communication step {duration:g} s is no positive multiple of the step {h:g} s of this FMU; use "
                f"{near:g} s, or write the FMU with another --step"
            )
        if self._begin is None and math.isfinite(time):
            self._begin = time
        here = self.time
        if not abs(time - here) <= SAME_POINT * h:
            raise InputError(
                f"the communication point {time:.9g} s is not where this instance is, {here:.9g} s; set its state of "
                "that time, or reset it"
            )
        status = run.step() if steps == 1 else run.run(steps * h)
        if status != Status.COMPLETED:
            raise InputError(f"{status} at t = {self.time:.6g} s: {run.message}")
        self.status = str(status)
        return True

    # --- states

    @reported({})
    def state(self) -> dict[str, np.ndarray]:
        """Everything that the next steps depend on, arrays by name; empty if there is none."""
        return self._run().state | {BEGIN: np.array(math.nan if self._begin is None else self._begin)}

    @reported(None)
    def put(self, state: Mapping[str, np.ndarray]) -> None:
        """Go on from a `state`, of this instance or of another one of the same FMU."""
        if not state:
            raise InputError("the state is empty or damaged; set one that was got from this FMU after its start")
        run = self._run()
        run.state = {name: array for name, array in state.items() if name != BEGIN}
        begin = float(state[BEGIN])
        self._begin, self._initialising, self._wrong = None if math.isnan(begin) else begin, False, {}
        self.values = {name: run.inputs[name] for name in self.values}
        self.status = str(Status.COMPLETED)


def to_bytes(state: Mapping[str, np.ndarray]) -> bytes:
    """A state as bytes."""
    stream = io.BytesIO()
    np.savez(stream, allow_pickle=False, **state)  # type: ignore[arg-type]
    return stream.getvalue()


def from_bytes(data: bytes) -> dict[str, np.ndarray]:
    """The state of these bytes; an empty one, which `Instance.put` refuses, if they are damaged."""
    try:
        with np.load(io.BytesIO(data), allow_pickle=False) as found:
            return {name: found[name] for name in found.files}
    except Exception:  # of any kind, from a damaged archive; see the module
        return {}
