"""Scene sources of a study: a `Scene`, a function that builds one, or a scene file; and application of a setting.

A scene is built once for each combination of its parameters, and is shared by the runs of the study: options of
contacts and bodies are set before a run and restored after it.

Machine. Environment of the timings: machine, versions, the unit U, and other load.

An interrupted study has a sitting for each part. Other load is measured by the load average at the start of a sitting:
processes that run or wait for a core, over the previous minute.
"""

from __future__ import annotations

import inspect
import os
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any, Protocol

from warpffrf.model.bodies import INERTIA_LEVELS
from warpffrf.model.errors import InputError, unknown_name
from warpffrf.scene_file import load_scene
from warpffrf.study.machine import machine
from warpffrf.study.speed_against_error.choices import BODY, BUILT_IN, CONTACT, RUN, Setting, can_stiffen, label_of

DROPPED = ("results", "record", "overwrite", "resume", "check", "progress")  # arguments of runs that a study sets


class Source(Protocol):
    """Builder of scenes."""

    title: str

    def options(self) -> dict[str, Any]:
        """Arguments of `simulate` that come with the scene."""
        ...

    def check(self, names: Sequence[str]) -> None:
        """Raises `InputError` for a name that is no parameter of the builder."""
        ...

    def build(self, parameters: Mapping[str, Any]) -> Any:
        """A scene with other values of these parameters."""
        ...


class GivenScene:
    """A given `Scene`."""

    title = "scene"

    def __init__(self, scene: Any) -> None:
        self.scene = scene

    def options(self) -> dict[str, Any]:
        """No options."""
        return {}

    def check(self, names: Sequence[str]) -> None:
        """A given scene has no parameters."""
        if names:
            raise InputError(
                f"speed_error: {names[0]!r} cannot be chosen for a Scene that is already built; known: "
                f"{', '.join(map(repr, BUILT_IN))}; for other parameters give a function that builds the scene from "
                "them, or a scene file"
            )

    def build(self, parameters: Mapping[str, Any]) -> Any:
        """The scene."""
        return self.scene


class BuiltScene:
    """A function `build(**parameters) -> Scene`."""

    def __init__(self, function: Callable[..., Any]) -> None:
        self.function = function
        self.title = getattr(function, "__name__", "build")

    def options(self) -> dict[str, Any]:
        """No options."""
        return {}

    def check(self, names: Sequence[str]) -> None:
        """Its keyword arguments are the parameters."""
        signature = inspect.signature(self.function).parameters.values()
        if any(p.kind is p.VAR_KEYWORD for p in signature):
            return
        known = [p.name for p in signature if p.kind in (p.POSITIONAL_OR_KEYWORD, p.KEYWORD_ONLY)]
        for name in names:
            if name not in known:
                raise unknown_name(f"speed_error: choice or parameter of {self.title}()", name, [*BUILT_IN, *known])

    def build(self, parameters: Mapping[str, Any]) -> Any:
        """Call the function."""
        scene = self.function(**parameters)
        if not hasattr(scene, "content_hash"):
            raise InputError(f"speed_error: {self.title}() must return a Scene, got {scene!r}")
        return scene


class FileScene:
    """A scene file; parameters are dotted names as of `--set`, those of the study set at once."""

    def __init__(self, path: str | os.PathLike[str], parameters: Mapping[str, Any]) -> None:
        self.path, self.parameters = path, dict(parameters)
        self.loaded: Any = self._loaded(self.parameters)
        self.title = str(self.loaded.title)

    def options(self) -> dict[str, Any]:
        """Options of its table [simulate]."""
        found = dict(self.loaded.simulate or {})
        if isinstance(found.get("duration"), list):
            raise InputError(
                f"speed_error: {Path(self.path).name} runs in stages; a study compares one run, give it duration and "
                "step in [simulate], and start from the results of the stage before"
            )
        return found

    def check(self, names: Sequence[str]) -> None:
        """Names are checked when the file is read with them."""

    def build(self, parameters: Mapping[str, Any]) -> Any:
        """Read the file again with the parameters set."""
        return self.loaded.scene if parameters == self.parameters else self._loaded(parameters).scene

    def _loaded(self, parameters: Mapping[str, Any]) -> Any:
        return load_scene(self.path, settings=[f"{name}={_toml(value)}" for name, value in parameters.items()])


def _toml(value: Any) -> str:
    """A value in the syntax of `--set`."""
    return str(value).lower() if isinstance(value, bool) else str(value)


def source_of(scene: Any, parameters: Mapping[str, Any]) -> Source:
    """The source for the user's argument; raises `InputError` for anything else."""
    if hasattr(scene, "content_hash") and hasattr(scene, "contacts"):
        return GivenScene(scene)
    if isinstance(scene, str | os.PathLike):
        return FileScene(scene, parameters)
    if callable(scene):
        return BuiltScene(scene)
    raise InputError(f"speed_error: give a Scene, a function that builds one, or a scene file, got {scene!r}")


class Machines:
    """The scenes of a study by their parameters, each built at the first request."""

    def __init__(self, source: Source, parameters: Mapping[str, Any]) -> None:
        source.check(list(parameters))
        self.source, self.parameters = source, dict(parameters)
        self._built: dict[str, Any] = {}

    def scene(self, setting: Setting) -> Any:
        """The scene of a setting, without its options applied."""
        parameters = {**self.parameters, **{k: v for k, v in setting.items() if k not in BUILT_IN}}
        label = label_of(parameters)
        if label not in self._built:
            self._built[label] = self.source.build(parameters)
        return self._built[label]


def run_options(setting: Setting) -> dict[str, Any]:
    """Step, and fields of `RunOptions`, in a setting."""
    return {name: value for name, value in setting.items() if name in RUN}


@contextmanager
def applied(scene: Any, setting: Setting) -> Iterator[None]:
    """Context in which contacts and bodies of `scene` have the options of the setting. Raises `InputError` if they do
    not support them."""
    level = setting.get("inertia")
    if level is not None and level not in INERTIA_LEVELS:
        raise unknown_name("speed_error: inertia", level, INERTIA_LEVELS)
    if not scene.contacts and (asked := [name for name in CONTACT if name in setting]):
        raise InputError(f"the scene has no distributed contact, and no {' or '.join(asked)} to choose")
    flexible = [body for body in scene.bodies if body.reduced is not None]
    if not flexible and (asked := [name for name in BODY if name in setting]):
        raise InputError(f"no body is flexible, and there is no {' or '.join(asked)} to choose")
    stiffened = [body for body in flexible if can_stiffen(body)] if "stiffening" in setting else []
    if setting.get("stiffening") and not stiffened:
        raise InputError(
            "stiffening is asked for, and no body was reduced with it; use ReductionOptions(stiffening=True)"
        )
    wanted = {name: setting[name] for name in CONTACT if name in setting}
    before = [(contact, {name: getattr(contact, name) for name in wanted}) for contact in scene.contacts]
    levels = [(body, body.level, body.stiffening) for body in flexible]
    try:
        for contact, old in before:
            _set_all(contact, old, wanted)
        for body in flexible if level is not None else []:
            body.level = level
        for body in stiffened:
            body.stiffening = bool(setting["stiffening"])
        yield
    finally:
        for contact, old in before:
            _set_all(contact, {}, {"grid": "body_fixed"} if "grid" in old else {})
            _set_all(contact, {}, dict(sorted(old.items(), key=lambda item: item[0] == "grid")))
        for body, old_level, old_stiffening in levels:
            body.level, body.stiffening = old_level, old_stiffening


def _set_all(contact: Any, old: Mapping[str, Any], values: Mapping[str, Any]) -> None:
    """Set options of a contact that must be compatible: the grid is first set to a value that allows all, then to the
    requested one."""
    if "grid" in values and "quadrature" in values:
        contact.grid = "body_fixed"
    for name in sorted(values, key=lambda name: name == "grid"):
        setattr(contact, name, values[name])


def offline_seconds(scene: Any) -> float:
    """Time of the reductions of the bodies of `scene` [s], each body once; NaN if unknown."""
    bodies = {id(body.reduced): body.reduced for body in scene.bodies if body.reduced is not None}
    found = [body.report.get("seconds") for body in bodies.values()]
    return float("nan") if any(value is None for value in found) else float(sum(found))


BUSY = 1.5  # processes: this one and occasional others


def load_before() -> float | None:
    """Average number of running or waiting processes over the last minute; None if the system does not report it."""
    return float(os.getloadavg()[0]) if hasattr(os, "getloadavg") else None


def sitting(load: float | None) -> dict[str, Any]:
    """Facts of a sitting that started at this `load`, as plain data."""
    return {**machine(), "load_before": load}


def unit_of(sittings: Sequence[Mapping[str, Any]]) -> float | None:
    """U [s] of a study, the least of its sittings, as for times; None for different machines, or without sittings."""
    machines = {(s["machine"]["processor"], s["machine"]["cores"]) for s in sittings}
    return min(float(s["unit_seconds"]) for s in sittings) if len(machines) == 1 else None


def stated(facts: Mapping[str, Any]) -> str:
    """A sitting as one sentence."""
    on, load = facts["machine"], facts.get("load_before")
    versions = ", ".join(f"{name} {version}" for name, version in facts["versions"].items())
    if load is None:
        beside = "other load is unknown"
    elif load < BUSY:
        beside = f"on a quiet machine (load average {load:.2g} before)"
    else:
        beside = f"with other work (load average {load:.2g} before), so that times are preliminary"
    return (
        f"Times taken on {on['processor']}, {on['cores']} cores, {on['platform']}, Python {on['python']}, {versions}; "
        f"{beside}. U = {facts['unit_seconds'] * 1e6:.4g} us (Cholesky factor-and-solve of size 128, one thread)."
    )
