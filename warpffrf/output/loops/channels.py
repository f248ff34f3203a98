"""One number of a run over time, by the name of what it is of and its component: what loops are drawn of.

("push", "x")              x of a force, a joint's reaction, a lap, contact or film [N], of a body's place [m]
("push", "torque_z")       a torque [N m]
("tip", "x")               a component of a sensor
"hinge"                    a joint's coordinate, a sensor with one component, a spring with one deformation
("joint", "hinge", "x")    with its kind, where things of several kinds have the name
array (T,)                 whatever was worked out
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from warpffrf.model.errors import InputError, unknown_name

AXES = "xyz"


@dataclass(frozen=True, eq=False)
class Channel:
    """Values (T,), what they are called, and their unit."""

    values: np.ndarray
    label: str
    unit: str


Components = dict[str, tuple[np.ndarray, str]]


def channel(result: Any, what: Any, unit: str, label: str) -> Channel:
    """The channel that `what` names (module docstring) in a `Result`; an array is `label` in `unit`. Raises
    `InputError`, listing what there is, for a name, kind or component that there is not."""
    if not isinstance(what, str | tuple):
        values = np.asarray(what, dtype=float)
        if values.shape != (len(result.time),):
            raise InputError(
                f"hysteresis: {label} must have a value for each of the {len(result.time)} saved steps, got an array "
                f"of shape {values.shape}"
            )
        return Channel(values, label, unit)
    kind, name, component = _parts(what)
    found = [known for known, (names, _) in _OWNERS.items() if kind in (known, None) and name in names(result)]
    if not found:
        known = dict.fromkeys(n for k, (names, _) in _OWNERS.items() if kind in (k, None) for n in names(result))
        raise unknown_name(f"hysteresis: {kind or 'name'}", name, tuple(known))
    if len(found) > 1:
        raise InputError(f"hysteresis: {name!r} is a {' and a '.join(found)}; give ({found[0]!r}, {name!r}, component)")
    components = _OWNERS[found[0]][1](result, name)
    if component is None:
        own = [key for key in components if len(components) == 1 or key not in _VECTORS]
        if len(own) != 1:
            raise InputError(
                f"hysteresis: {found[0]} {name!r} has several components; give ({name!r}, component), one of "
                f"{', '.join(map(repr, components))}"
            )
        component = own[0]
    if component not in components:
        raise unknown_name(f"hysteresis: component of {found[0]} {name!r}", component, tuple(components))
    values, its_unit = components[component]
    return Channel(np.asarray(values, dtype=float), f"{name} {component}".replace("_", " "), its_unit)


def _parts(what: Any) -> tuple[str | None, str, str | None]:
    parts = (what,) if isinstance(what, str) else what
    if not 1 <= len(parts) <= 3 or not all(isinstance(part, str) for part in parts):
        raise InputError(
            f"hysteresis: give a name, (name, component), (kind, name, component) or an array, got {what!r}"
        )
    if len(parts) == 3:
        if parts[0] not in _OWNERS:
            raise unknown_name("hysteresis: kind", parts[0], tuple(_OWNERS))
        return parts[0], parts[1], parts[2]
    return None, parts[0], parts[1] if len(parts) == 2 else None


def _vectors(force: np.ndarray, torque: np.ndarray | None = None) -> Components:
    found: Components = {axis: (force[:, n], "N") for n, axis in enumerate(AXES)}
    if torque is not None:
        found |= {f"torque_{axis}": (torque[:, n], "N m") for n, axis in enumerate(AXES)}
    return found


_VECTORS = {*AXES, *(f"torque_{axis}" for axis in AXES)}  # components that a bare name does not mean


def _joint(result: Any, name: str) -> Components:
    joint = result.joint(name)
    named: Components = {key: (joint.named(key), "rad" if key.endswith("rotation") else "m") for key in joint.names}
    return named | _vectors(joint.force, joint.torque)


def _force(result: Any, name: str) -> Components:
    force = result.force(name)
    count = force.deformation.shape[1]
    keys = ["deformation"] if count == 1 else [f"deformation_{n}" for n in range(count)]
    found = {key: (force.deformation[:, n], "m or rad") for n, key in enumerate(keys)}
    return found | _vectors(force.force, force.torque)


def _sensor(result: Any, name: str) -> Components:
    sensor = result.sensor(name)
    return {key: (values, sensor.unit) for key, values in zip(sensor.components, sensor.values.T, strict=True)}


def _lap(result: Any, name: str) -> Components:
    lap = result.lap(name)
    found: Components = {**_vectors(lap.force, lap.torque), "normal_force": (lap.normal_force, "N")}
    found |= {f"sliding_{axis}": (lap.sliding[:, n], "m") for n, axis in enumerate(AXES)}
    return found | {f"turning_{axis}": (lap.turning[:, n], "rad") for n, axis in enumerate(AXES)}


def _body(result: Any, name: str) -> Components:
    position = result.body(name).position
    return {axis: (position[:, n], "m") for n, axis in enumerate(AXES)}


Owner = tuple[Callable[[Any], list[str]], Callable[[Any, str], Components]]
_OWNERS: dict[str, Owner] = {
    "force": (lambda r: list(r.history.forces), _force),
    "sensor": (lambda r: r.sensor_names, _sensor),
    "joint": (lambda r: list(r.history.joints), _joint),
    "lap": (lambda r: list(r.history.laps), _lap),
    "contact": (lambda r: r.contact_names, lambda r, n: _vectors(r.contact(n).force, r.contact(n).torque)),
    "film": (lambda r: r.film_names, lambda r, n: _vectors(r.film(n).force, r.film(n).torque)),
    "body": (lambda r: list(r.history.bodies), _body),
}
