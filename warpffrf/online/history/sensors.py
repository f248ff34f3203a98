"""Force elements and sensors of a run, from its saved rows."""

from __future__ import annotations

from typing import Any

import numpy as np

from warpffrf.model.errors import InputError
from warpffrf.model.forces import BodyLoad
from warpffrf.model.pieces import Signal
from warpffrf.model.scene import Scene
from warpffrf.model.sensors import Sensor
from warpffrf.online.compile.forces import ForceTable
from warpffrf.online.compile.inputs import DeviceInputs
from warpffrf.online.history.history import BodyHistory, ForceHistory, History, SensorHistory
from warpffrf.online.history.interface_motion import turned


def force_histories(
    scene: Scene,
    table: ForceTable,
    time: np.ndarray,
    value: np.ndarray,
    wrench: np.ndarray,
    bodies: dict[str, BodyHistory],
    inputs: DeviceInputs | None = None,
) -> dict[str, ForceHistory]:
    """Force and torque of every force element but friction in joints and pretensions, from `value` (T, rows) and
    `wrench` (T, rows, 6) of the rows in `table`; loads have the values of the `inputs`."""
    found: dict[str, ForceHistory] = {}
    T = len(time)
    for item in scene.forces:
        if hasattr(item, "slip") or (hasattr(item, "tension") and item.name not in table.rows):
            continue
        if item.name in table.rows:
            own = table.rows[item.name]
            total = wrench[:, own].sum(axis=1)
            law = table.laws[item.name]
            deformation = value[:, own]
            if law.expand is not None:
                deformation = deformation @ law.expand.T
            found[item.name] = ForceHistory(total[:, :3], total[:, 3:], deformation.copy())
            continue
        load = item.load()
        none = np.zeros((T, 0))
        if isinstance(load, BodyLoad):
            p, s = bodies[load.body.name].rotation, _values(load.signal, inputs, time)[:, None]
            found[item.name] = ForceHistory(turned(p, s * load.force), turned(p, s * load.torque), none)
            continue
        vector = np.stack([_values(signal, inputs, time) for signal in load.components], axis=1)
        if load.frame == "body":
            vector = turned(bodies[load.port.body.name].rotation, vector)
        zero = np.zeros((T, 3))
        pair = (vector, zero) if load.what == "force" else (zero, vector)
        found[item.name] = ForceHistory(*pair, none)
    return found


def _values(signal: Signal, inputs: DeviceInputs | None, time: np.ndarray) -> np.ndarray:
    """Values (T,) of a signal, with those that its input had."""
    if inputs is None or not len(time):
        return signal(time)
    return inputs.resolved(signal, float(time[0]))(time)


def sensor_histories(history: History) -> dict[str, SensorHistory]:
    """Values of all sensors of the run, except those evaluated from its result on request.

    A sensor whose evaluation fails returns NaN, with a note; the run is kept.
    """
    found = {}
    for sensor in history.scene.sensors:
        if sensor.of_result:
            continue
        try:
            values = sensor_values(sensor, history)
        except Exception as error:
            values = np.full((len(history.time), len(sensor.components)), np.nan)
            history.notes.append(f"sensor {sensor.name!r} has no values (NaN): {type(error).__name__}: {error}")
        found[str(sensor.name)] = sensor_history(sensor, values)
    return found


def sensor_values(sensor: Sensor, run: Any) -> np.ndarray:
    """Values (T, components) of a `sensor` in a `run`. Raises `InputError` where they have another shape."""
    values = np.asarray(sensor.evaluate(run), dtype=np.float64)
    expected = len(run.time), len(sensor.components)
    if values.shape != expected:
        raise InputError(
            f"sensor {sensor.name!r}: {type(sensor).__name__}.evaluate returns the shape {values.shape}; it must be "
            f"{expected}, saved steps by components"
        )
    return values


def sensor_history(sensor: Sensor, values: np.ndarray) -> SensorHistory:
    """The `values` of a `sensor`, with kind, unit, frame and components."""
    return SensorHistory(sensor.kind, sensor.unit, sensor.frame, tuple(sensor.components), values)
