"""A run in stages: parts of one run, each with its own step, options and loads.

    simulate(scene, [Stage("press", 0.02, 1e-3), Stage("roll", 0.1, 1e-4, {"save_every": 10})])
    simulate(scene, [Stage("tighten", 1.0, 0.1, kind="static"), Stage("ring", 0.1, 1e-5)])

A stage starts from the checkpoint of the previous one; time continues. A stage of kind "static" computes consecutive
equilibria (`warpffrf.online.load_steps`); a dynamic stage after it starts from rest, and a static stage after a dynamic
one drops the velocities, with a note. Overrides apply to
their stage only; the next stage uses the scene and the options of the run:

    save_every, integrator, local_modes, step_error     as of `RunOptions`
    gravity                                             (3,) m/s2
    forces                                              {name: force}: replaces the scene's force of that name
    released                                            [name, ...]: joints and drives that hold nothing

A force may be replaced only by one of the same kind: size of the equations and meaning of the state then stay the same.
Loads that jump between stages cause accelerations to jump; a jump of the potential energy
with gravity, or with the stiffness or free length of a spring, is booked as work of forces. Joints, drives and bodies
cannot be replaced, because positions would jump. A released joint or drive holds again in the next stage that does not
release it, where it stands then, and a motion that it meets stops there as in an impact (`warpffrf.online.released`).
"""

from __future__ import annotations

import copy
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, fields, is_dataclass, replace
from typing import Any

import numpy as np

from warpffrf.model.errors import InputError, require_array, require_number, unknown_name
from warpffrf.model.forces.laws import tension_of
from warpffrf.model.messages.named_arguments import named_arguments
from warpffrf.model.released import Released
from warpffrf.model.scene import Scene
from warpffrf.online.checkpoint import is_dynamic, is_loaded
from warpffrf.online.history.history import ENERGY_LINES, History, JointHistory
from warpffrf.online.released import require_released, with_common_rows

RUN_OPTIONS = ("save_every", "integrator", "local_modes", "step_error")
OF_TIME = ("integrator", "step_error")
KINDS = ("dynamic", "static")
SCENE_VALUES = ("gravity", "forces", "released")
# the other counters continue through the stages
SUMMED = ("build_seconds", "seconds_in_graph", "loop_seconds", "finish_seconds")


@named_arguments
@dataclass(frozen=True)
class Stage:
    """Part of a run: `duration` [s] in steps of `step` [s]; `overrides` as in the module. name: of the stage,
    unique.
    kind: "dynamic", or "static" for consecutive equilibria; static stages override only save_every, local_modes
    and loads.

    Raises `InputError` for wrong numbers and for what cannot be overridden.
    """

    name: str
    duration: float
    step: float
    overrides: Mapping[str, Any] = field(default_factory=dict)
    kind: str = "dynamic"

    def __post_init__(self) -> None:
        if not isinstance(self.name, str) or not self.name or "/" in self.name:
            raise InputError(f"stage: the name must be a non-empty text without '/', got {self.name!r}")
        label = f"stage {self.name!r}"
        for key in ("duration", "step"):
            value = require_number(getattr(self, key), f"{label}: {key}", positive=True)
            object.__setattr__(self, key, value)
        if not isinstance(self.overrides, Mapping):
            raise InputError(f"{label}: overrides must be a table, got {self.overrides!r}")
        for key in self.overrides:
            if key not in (*RUN_OPTIONS, *SCENE_VALUES):
                raise unknown_name(f"{label}: override", key, (*RUN_OPTIONS, *SCENE_VALUES))
        if self.kind not in KINDS:
            raise InputError(f"{label}: kind must be 'dynamic' or 'static', got {self.kind!r}")
        if self.kind == "static" and (wrong := [key for key in self.overrides if key in OF_TIME]):
            raise InputError(f"{label}: a static stage has no {wrong[0]}: nothing moves in time; leave it out")

    @property
    def options(self) -> dict[str, Any]:
        """The options of `simulate` that this stage overrides."""
        return {key: value for key, value in self.overrides.items() if key in RUN_OPTIONS}

    def scene(self, scene: Scene) -> Scene:
        """`scene` itself, or a copy with this stage's values; bodies, joints and contacts are shared.
        Raises `InputError` for overrides that do not exist in the scene."""
        if not any(key in self.overrides for key in SCENE_VALUES):
            return scene
        label = f"stage {self.name!r}"
        changed = copy.copy(scene)
        if "gravity" in self.overrides:
            changed.gravity = require_array(self.overrides["gravity"], f"{label}: gravity", (3,))
        changed.released = Released(require_released(scene, self.overrides.get("released", ()), label))
        changed.forces = list(scene.forces)
        names = [force.name for force in scene.forces]
        forces = self.overrides.get("forces", {})
        if not isinstance(forces, Mapping):
            raise InputError(f"{label}: forces must be a table {{name: force}}, got {forces!r}")
        for name, given in forces.items():
            if name not in names:
                raise unknown_name(f"{label}: force", name, names)
            old = scene.forces[names.index(name)]
            alike = (tension_of(given) is None) == (tension_of(old) is None) if type(given) is type(old) else False
            if not alike or _places(given) != _places(old):
                raise InputError(
                    f"{label}: force {name!r} is a {old.kind} at {' and '.join(p.label for p in old.ports)}; it can "
                    "only be replaced by one of that kind in that place, its preload a number or a signal as before"
                )
            new = copy.copy(given)
            new.name = name
            changed.forces[names.index(name)] = new
        return changed


def check_stages(scene: Scene, stages: Any) -> tuple[list[Stage], list[Scene]]:
    """`stages` as a list, checked against each other and the scene, and the scene of each; raises `InputError`."""
    if not isinstance(stages, Sequence) or not stages or not all(isinstance(stage, Stage) for stage in stages):
        raise InputError(
            f"simulate: duration must be a number [s], or a list of Stage(name, duration, step), at least "
            f"one, got {stages!r}"
        )
    names = [stage.name for stage in stages]
    for name in names:
        if names.count(name) > 1:
            raise InputError(f"simulate: two stages are called {name!r}; choose another name")
    labels = [f"stage {name!r}" for name in names]
    return list(stages), with_common_rows(scene, [stage.scene(scene) for stage in stages], labels)


def with_potential(checkpoint: Mapping[str, np.ndarray], before: Scene, after: Scene) -> dict[str, np.ndarray]:
    """A checkpoint changed from the loads of the scene `before` to those of `after`; the forces are the same in
    the same order.

    The potential of gravity and springs jumps without motion; the jump is booked as work of forces, so that the
    energy ledger stays closed. A first equilibrium is unchanged: the ledger starts with it.
    """
    jump = _potential(checkpoint, after) - _potential(checkpoint, before)
    if not (is_dynamic(checkpoint) or is_loaded(checkpoint)) or not np.any(jump):
        return dict(checkpoint)
    energy = np.array(checkpoint["energy"])
    for line in ("potential", "force_work"):
        energy[:, 0, ENERGY_LINES.index(line)] += jump
    return {**checkpoint, "energy": energy}


def _potential(checkpoint: Mapping[str, np.ndarray], scene: Scene) -> np.ndarray:
    """Potential (W,) [J] of gravity, -sum m g.r, and of springs.

    The values of spring rows follow those of joints, in the order of the forces (`compile_forces`).
    """
    masses = np.array([body.mass for body in scene.bodies])
    total = -np.einsum("b,wbi,i->w", masses, checkpoint["r"], scene.gravity)
    laws = [force.law() for force in scene.forces if hasattr(force, "law")]
    values = np.asarray(checkpoint["stretch"])
    at = values.shape[1] - sum(len(law.coordinates) for law in laws)
    for law in laws:
        total += law.potential(values[:, at : at + len(law.coordinates)])
        at += len(law.coordinates)
    return total


def joined(histories: Sequence[History], names: Sequence[str]) -> History:
    """Concatenate the histories of consecutive stages; notes are labelled with the stage's name."""
    last = histories[-1]
    counters = {**last.counters, **{n: sum(h.counters.get(n, 0.0) for h in histories) for n in SUMMED}}
    notes = [f"stage {n!r}: {note}" for n, history in zip(names, histories, strict=True) for note in history.notes]
    message = f"stage {names[-1]!r}: {last.message}" if last.message else ""
    return replace(joined_parts(histories), message=message, counters=counters, notes=list(dict.fromkeys(notes)))


def joined_parts(histories: Sequence[History]) -> History:
    """Concatenate the rows of consecutive parts of a run; everything else is taken from the last part, except the
    scene."""
    rows = {
        entry.name: _joined([getattr(history, entry.name) for history in histories])
        for entry in fields(History)
        if entry.name not in ("scene", "checkpoint", "counters", "notes", "options", "samples", "budget", "stopping")
    }
    return replace(histories[-1], scene=histories[0].scene, samples=None, budget=[], **rows)


def _joined(parts: list[Any]) -> Any:
    first = parts[0]
    if isinstance(first, np.ndarray):
        return np.concatenate(parts)
    if isinstance(first, dict):
        return {key: _joined([part[key] for part in parts]) for key in first}
    if isinstance(first, JointHistory):
        return _joined_joint(parts)
    if is_dataclass(first) and not isinstance(first, type):
        return type(first)(**{f.name: _joined([getattr(part, f.name) for part in parts]) for f in fields(first)})
    return parts[-1]


def _joined_joint(parts: list[JointHistory]) -> JointHistory:
    """Concatenate a joint's histories; angles continue from the previous stage: each record counts its
    revolutions from (-pi, pi]."""
    names = parts[0].names
    seconds = [np.asarray(part.second_coordinate) for part in parts]
    columns = [[part.coordinate for part in parts], seconds]
    for name, values in zip(names, columns, strict=False):
        if name.endswith("rotation"):
            for i in range(1, len(values)):
                if not len(values[i]) or not len(values[i - 1]):
                    continue
                turns = np.round((values[i - 1][-1] - values[i][0]) / (2.0 * np.pi))
                values[i] = values[i] + 2.0 * np.pi * turns
    return JointHistory(
        np.concatenate(columns[0]),
        np.concatenate([part.force for part in parts]),
        np.concatenate([part.torque for part in parts]),
        np.concatenate(columns[1]),
        names,
    )


ROWS = (
    "time", "step_size", "energy", "iterations", "factorisations", "bodies", "joints", "forces", "contacts",
    "lumped_contacts", "small_sliding", "films", "sensors",
)  # what a history has one row per saved step of  # fmt: skip


def last_rows(history: History, first: int) -> History:
    """The saved steps from the row `first` on; what was sampled in the run for its error budget is left out."""
    rows = {name: _cut(getattr(history, name), first) for name in ROWS}
    return replace(history, samples=None, cell_checks={}, film_checks={}, film_grids={}, **rows)


def _cut(part: Any, first: int) -> Any:
    if isinstance(part, np.ndarray):
        return part[first:]
    if isinstance(part, dict):
        return {key: _cut(value, first) for key, value in part.items()}
    if is_dataclass(part):
        found = copy.copy(part)
        vars(found).update({f.name: _cut(getattr(part, f.name), first) for f in fields(part)})
        return found
    return part


def _places(force: Any) -> list[Any]:
    return [(port.describe(), id(port.body)) for port in force.ports]
