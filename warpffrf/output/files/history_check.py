"""Whether the arrays of a run fit together: a row for each saved time, axes of the right length, finite motion.

A seal tells damage to a file; a faulty writer seals wrong arrays, and they would be read as results.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from warpffrf.model.errors import InputError
from warpffrf.online.history.history import History
from warpffrf.output.files.fields import (
    BODY_FIELDS,
    CELL_FIELDS,
    CONTACT_FIELDS,
    FILM_FIELDS,
    FILM_SECOND_FIELDS,
    FORCE_FIELDS,
    FRICTION_FIELDS,
    JOINT_FIELDS,
    JOINT_FRICTION_FIELDS,
    LAP_FIELDS,
    LUMPED_FIELDS,
    RUN_FIELDS,
    SIZES,
    Field,
)
from warpffrf.output.geometry.scene_view import SceneView

# other numbers may be NaN, where they are not known
FINITE = {
    "bodies": ("position", "rotation", "velocity", "angular_velocity", "modal"),
    "joints": ("force", "torque"),
    "contacts": ("force", "torque", "force_second", "torque_second", "pressure", "load_second"),
    "films": (
        "force",
        "torque",
        "torque_second",
        "smallest_gap",
        "largest_pressure",
        "pressure",
        "gap",
        "void",
        "asperity",
    ),
    "laps": ("force", "torque", "normal_force", "pressure", "traction", "gap", "slip", "loss"),
}


def check_history(history: History) -> None:
    """Raise `InputError` that names the first array that cannot be the run's, and why."""
    steps = np.shape(history.time)[0] if np.ndim(history.time) == 1 else -1
    for field in RUN_FIELDS:
        _check(history, field, field.name, steps, {})
    time = np.asarray(history.time)
    if not np.all(np.isfinite(time)) or np.any(np.diff(time) < 0.0):
        raise InputError("time holds numbers that are not finite or do not ascend")
    for line, values in history.energy.items():
        if np.shape(values) != (steps,):
            raise InputError(f"energy line '{line}' has shape {np.shape(values)}, not ({steps},)")
    for name, body in history.bodies.items():
        _check_owner(body, BODY_FIELDS, name, steps)
    for name, joint in history.joints.items():
        _check_owner(joint, JOINT_FIELDS, name, steps)
    for name, force in history.forces.items():
        _check_owner(force, FORCE_FIELDS, name, steps)
        _check_owner(force.friction, JOINT_FRICTION_FIELDS, name, steps)
    for name, lumped in history.lumped_contacts.items():
        _check_owner(lumped, LUMPED_FIELDS, name, steps)
    for name, film in history.films.items():
        _check_owner(film, FILM_FIELDS, name, steps)
        _check_owner(film if film.load_second is not None else None, FILM_SECOND_FIELDS, name, steps)
        _check_film_grid(film, name, history.scene)
    for name, lap in history.laps.items():
        _check_owner(lap, LAP_FIELDS, name, steps)
        _check_lap_cells(lap, name, history.scene)
    for name, contact in history.contacts.items():
        _check_owner(contact, [f for f in CONTACT_FIELDS if f.attribute != "load_second"], name, steps)
        _check_owner(contact, [f for f in CONTACT_FIELDS if f.attribute == "load_second"], name, steps)
        _check_owner(contact.friction, FRICTION_FIELDS, name, steps)
        _check_owner(contact.cells, CELL_FIELDS, name, steps)
    for name, sensor in history.sensors.items():
        if np.shape(sensor.values) != (steps, len(sensor.components)):
            raise InputError(f"sensor '{name}' has shape {np.shape(sensor.values)} and {steps} rows are saved")

    for group, attributes in FINITE.items():
        for name, owner in getattr(history, group).items():
            for attribute in attributes:
                if not np.all(np.isfinite(getattr(owner, attribute))):
                    raise InputError(f"{attribute} of '{name}' in {group} holds NaN or infinite numbers")


def _check_film_grid(film: Any, name: str, scene: Any) -> None:
    """The fields of a film against the grid of its first surface, as a file has it."""
    if not isinstance(scene, SceneView):
        return
    if name not in scene.films:
        raise InputError(f"film '{name}' has a history, but the scene has no film of this name")
    grid, shape = scene.films[name].first.grid, np.shape(film.pressure)[1:]
    if shape != (grid.columns, grid.rows):
        raise InputError(
            f"film_pressure of '{name}' has {shape[0]} columns and {shape[1]} rows, the grid of its first surface "
            f"{grid.columns} and {grid.rows}"
        )


def _check_lap_cells(lap: Any, name: str, scene: Any) -> None:
    """The fields of a lap against its cells, as a file has them."""
    if not isinstance(scene, SceneView):
        return
    if name not in scene.laps:
        raise InputError(f"lap '{name}' has a history, but the scene has no lap of this name")
    cells, count = len(scene.laps[name].area), np.shape(lap.pressure)[1]
    if count != cells:
        raise InputError(f"lap_pressure of '{name}' has {count} cells, the lap has {cells}")


def _check_owner(owner: Any, fields: Any, name: str, steps: int) -> None:
    """The quantities of one owner; dimensions of one name are of one length. An owner that is None has none."""
    if owner is None:
        return
    sizes: dict[str, int] = {}
    for field in fields:
        _check(owner, field, f"{field.name} of '{name}'", steps, sizes)


def _check(owner: Any, field: Field, label: str, steps: int, sizes: dict[str, int]) -> None:
    shape = np.shape(getattr(owner, field.attribute))
    wanted = [SIZES.get(dim) or sizes.get(dim) for dim in field.dims]
    fits = len(shape) == 1 + len(wanted) and shape[0] == steps
    if not fits or any(b is not None and a != b for a, b in zip(shape[1:], wanted, strict=True)):
        should = ", ".join([str(steps), *("any" if b is None else str(b) for b in wanted)])
        raise InputError(f"{label} must have shape ({should}), got {shape}")
    sizes.update(zip(field.dims, shape[1:], strict=True))
