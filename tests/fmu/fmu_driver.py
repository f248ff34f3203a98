"""What an importing tool does with FMUs, with fmpy, in a process of its own.

    python fmu_driver.py "[[TASK, ARGUMENT, ...], ...]"

prints one JSON document, a list with what each task has found.
"""

from __future__ import annotations

import json
import math
import sys
from typing import Any

import numpy as np
from fmpy import extract, read_model_description, simulate_fmu  # type: ignore[import-not-found]
from fmpy.fmi1 import FMICallException  # type: ignore[import-not-found]
from fmpy.fmi2 import FMU2Slave  # type: ignore[import-not-found]
from fmpy.fmi3 import FMU3Slave  # type: ignore[import-not-found]
from fmpy.validation import validate_fmu  # type: ignore[import-not-found]
from fmu_scenes import DAMPING, SPEED, STIFFNESS

STEP = 1e-3
TERMINATED = 3  # kind of status of FMI 2.0


class Slave:
    """An instance of an FMU 2.0 or 3.0, by names of variables."""

    def __init__(self, path: str, start_time: float = 0.0, **start: float) -> None:
        known = read_model_description(path)
        self.three = known.fmiVersion.startswith("3")  # pyright: ignore[reportOptionalMemberAccess]
        self.number = {v.name: v.valueReference for v in known.modelVariables}
        made = FMU3Slave if self.three else FMU2Slave
        token = known.instantiationToken if self.three else known.guid
        self.fmu: Any = made(
            unzipDirectory=extract(path),
            modelIdentifier=known.coSimulation.modelIdentifier,  # pyright: ignore[reportOptionalMemberAccess]
            instanceName="one",
            guid=token,
        )
        self.fmu.instantiate(loggingOn=True)
        self.begin(start_time, **start)

    def begin(self, start_time: float = 0.0, **start: float) -> None:
        if self.three:
            self.fmu.enterInitializationMode(startTime=start_time)
        else:
            self.fmu.setupExperiment(startTime=start_time)
            self.fmu.enterInitializationMode()
        for name, value in start.items():
            self[name.replace("_", " ")] = value
        self.fmu.exitInitializationMode()

    def __setitem__(self, name: str, value: float) -> None:
        (self.fmu.setFloat64 if self.three else self.fmu.setReal)([self.number[name]], [value])

    def __getitem__(self, name: str) -> float:
        return (self.fmu.getFloat64 if self.three else self.fmu.getReal)([self.number[name]])[0]

    @property
    def status(self) -> str:
        said = self.fmu.getString([self.number["status"]])[0]
        return said.decode() if isinstance(said, bytes) else said

    def step(self, time: float, duration: float) -> str:
        """Make a step; what the importing tool gets of it."""
        try:
            self.fmu.doStep(time, duration)
        except FMICallException as error:
            return f"{'discard' if 'discard' in str(error) else error}: {self.status}"
        return self.status

    @property
    def state(self) -> Any:
        return (self.fmu.getFMUState if self.three else self.fmu.getFMUState)()

    @state.setter
    def state(self, state: Any) -> None:
        self.fmu.setFMUState(state)

    def as_bytes(self, state: Any) -> bytes:
        return (self.fmu.serializeFMUState if self.three else self.fmu.serializeFMUstate)(state)

    def from_bytes(self, data: bytes) -> Any:
        return (self.fmu.deserializeFMUState if self.three else self.fmu.deSerializeFMUstate)(data)

    def free(self) -> None:
        self.fmu.terminate()
        self.fmu.freeInstance()


def validate(path: str) -> Any:
    """Problems that fmpy finds, and a run of its own."""
    rows = simulate_fmu(path, stop_time=0.1, output_interval=2 * STEP, start_values={"motor torque": 2.0})
    return {"problems": validate_fmu(path), "speed": float(rows[SPEED][-1]), "rows": len(rows)}


def values(path: str) -> Any:
    """Speeds under a torque that changes at communication steps of 1 to 3 steps, of an instance that begins at 5 s."""
    one, t, found = Slave(path, 5.0, motor_torque=2.0), 5.0, []
    for n in range(60):
        one["motor torque"] = math.cos(0.3 * n)
        assert one.step(t, (1 + n % 3) * STEP) == "completed", one.status
        t += (1 + n % 3) * STEP
        found.append(one[SPEED])
    one.free()
    return found


def states(path: str) -> Any:
    """Speeds that two instances reach from one state, first and again."""
    one, other = Slave(path), Slave(path)
    one.step(0.0, 50 * STEP)
    one["motor torque"] = 4.0
    one.step(50 * STEP, 5 * STEP)
    state = one.state
    data = one.as_bytes(state)
    found = []
    for which, begun in ((one, state), (one, state), (other, other.from_bytes(data))):
        which.state = begun
        which["motor torque"] = -1.0
        which.step(55 * STEP, 5 * STEP)
        found.append(which[SPEED])
    one.fmu.freeFMUState(state)
    one.free()
    other.free()
    return found


def failures(path: str) -> Any:
    """Statuses and speeds after wrong calls; the process goes on."""
    one = Slave(path)
    one.step(0.0, 2 * STEP)
    t, state = 2 * STEP, one.state
    found: dict[str, Any] = {"speed": [one[SPEED]]}
    for name, time, duration in (
        ("no multiple", t, 1.5 * STEP),
        ("zero", t, 0.0),
        ("backwards", t, -STEP),
        ("not a number", t, math.nan),
        ("elsewhere", t + 0.5, STEP),
    ):
        found[name] = one.step(time, duration)
    one["motor torque"] = math.nan
    found["nan"], found["again"] = one.step(t, STEP), one.step(t, STEP)
    one["motor torque"] = 1e305
    found["failed"], found["after"] = one.step(t, STEP), one.step(t, STEP)
    found["speed"].append(one[SPEED])
    if not one.three:
        found["terminated"] = one.fmu.getBooleanStatus(TERMINATED)
    one.state = one.from_bytes(b"no state at all" * 9)
    found["no state"] = one.step(t, STEP)
    one.state = state
    found["speed"].append(one[SPEED])
    found["restored"] = one.step(t, STEP)
    one.fmu.reset()
    one.begin()
    found["reset"] = one.step(0.0, STEP)
    one.free()
    return found


def coupled(first: str, second: str, window: float, step: float, count: int, sweeps: int) -> Any:
    """Places (count + 1, 4) of the ends of two halves of a beam, with forces exchanged after each window, in so
    many sweeps.

    In a sweep each half makes the steps of the window under the forces of the sweep before, from the state at its
    begin, and its motion at all steps gives the forces of the next one (Jacobi waveform iteration). Forces within the
    first sweep are those at the begin of the window."""
    halves, names = (Slave(first), Slave(second)), ("first", "second")

    def motion() -> np.ndarray:
        kinds = [f"sensor_{a}[{{}}_{kind}]" for kind in ("place", "speed") for a in "xz"]
        return np.array([[one[kind.format(name)] for kind in kinds] for one, name in zip(halves, names, strict=True)])

    def force(both: np.ndarray) -> np.ndarray:
        apart, speed = both[1, :2] - both[0, :2], both[1, 2:] - both[0, 2:]
        return STIFFNESS * apart + DAMPING * speed

    now = motion()
    places, per = [now[:, :2].ravel().tolist()], round(window / step)
    for n in range(count):
        states, forces = [one.state for one in halves], np.tile(force(now), (per, 1))
        for sweep in range(sweeps):
            if sweep:
                for one, state in zip(halves, states, strict=True):
                    one.state = state
            reached = []
            for i in range(per):
                for one, sign in zip(halves, (1.0, -1.0), strict=True):
                    one["force x"], one["force z"] = sign * forces[i]
                    assert one.step(n * window + i * step, step) == "completed", one.status
                reached.append(force(now := motion()))
            forces = np.array(reached)
        places.append(now[:, :2].ravel().tolist())
        for one, state in zip(halves, states, strict=True):
            one.fmu.freeFMUState(state)
    for one in halves:
        one.free()
    return places


if __name__ == "__main__":
    tasks = {f.__name__: f for f in (validate, values, states, failures, coupled)}
    found = [tasks[task](*arguments) for task, *arguments in json.loads(sys.argv[1])]
    print("\n" + json.dumps(found))
