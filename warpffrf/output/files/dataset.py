"""A run as an xarray dataset: the names, units and frames of the results file."""

from __future__ import annotations

from typing import Any

import numpy as np

from warpffrf.output.files.fields import (
    BODY_FIELDS,
    CELL_FIELDS,
    COMPONENTS,
    CONTACT_FIELDS,
    DERIVED_FIELDS,
    ENERGY_UNITS,
    FILM_FIELDS,
    FILM_POSITIONS,
    FILM_SECOND_FIELDS,
    FORCE_FIELDS,
    FRICTION_DERIVED,
    FRICTION_FIELDS,
    JOINT_FIELDS,
    JOINT_FRICTION_FIELDS,
    LAP_CELLS,
    LAP_DERIVED,
    LAP_FIELDS,
    LUMPED_FIELDS,
    RUN_FIELDS,
    SIZES,
    Field,
    of_owner,
)


def stacked(field: Field, owners: list[Any], steps: int) -> np.ndarray:
    """The quantity of all owners as one array (time, owner, ...)."""
    if not owners:
        return np.zeros((steps, 0) + tuple(SIZES[d] for d in field.dims))
    return np.stack([np.asarray(getattr(owner, field.attribute)) for owner in owners], axis=1)


Group = tuple[str, tuple[Field, ...], dict[str, Any]]


def owner_groups(result: Any) -> tuple[Group, ...]:
    """What has histories: (dimension of the owners, their fields, owner by name), kept and derived; bodies, joints,
    forces and contact pairs always, the rest where there are any."""
    history = result.history
    contacts = {name: result.contact(name) for name in history.contacts}
    rubbing = {name: contact.friction for name, contact in contacts.items() if contact.has_friction}
    cells = {name: contact.cells for name, contact in history.contacts.items() if contact.cells is not None}
    stuck = {name: force.friction for name, force in history.forces.items() if force.friction is not None}
    laps = {name: result.lap(name) for name in history.laps}
    yielding = {name: film for name, film in history.films.items() if film.load_second is not None}
    return (
        ("body", BODY_FIELDS, history.bodies),
        ("joint", JOINT_FIELDS, history.joints),
        ("force", FORCE_FIELDS, history.forces),
        ("pair", CONTACT_FIELDS, history.contacts),
        ("pair", DERIVED_FIELDS, contacts),
        *([("joint_friction", JOINT_FRICTION_FIELDS, stuck)] if stuck else []),
        *([("lumped_contact", LUMPED_FIELDS, history.lumped_contacts)] if history.lumped_contacts else []),
        *([("film", FILM_FIELDS, history.films)] if history.films else []),
        *([("film", FILM_SECOND_FIELDS, yielding)] if yielding else []),
        *([("lap", LAP_FIELDS, history.laps), ("lap", LAP_DERIVED, laps)] if laps else []),
        *([("cell_pair", CELL_FIELDS, cells)] if cells else []),
        *([("friction_pair", (*FRICTION_FIELDS, *FRICTION_DERIVED), rubbing)] if rubbing else []),
    )


def to_xarray(result: Any) -> Any:
    """`xarray.Dataset`; quantities whose shape differs between owners are named `contact_pressure_<pair>` and so on."""
    try:
        import xarray as xr
    except ImportError as error:
        raise ImportError("to_xarray needs xarray: pip install 'warpffrf[arrays]'") from error

    history = result.history
    steps = len(history.time)
    data: dict[str, Any] = {}
    always = ("axis", "quaternion", "direction")
    coords: dict[str, Any] = {dim: list(COMPONENTS[dim]) for dim in always}
    for field in RUN_FIELDS:
        entry = (("time",), getattr(history, field.attribute), _attributes(field))
        (coords if field.name == "time" else data)[field.name] = entry
    contacts = {name: result.contact(name) for name in history.contacts}
    cells = {name for name, contact in history.contacts.items() if contact.cells is not None}
    laps = {name: result.lap(name) for name in history.laps}
    groups = owner_groups(result)
    present = {dim for dim, _, _ in groups}
    for dim, owner in (
        ("slip", "joint_friction"), ("chart_axis", "film"), ("along", "lap"), ("frame_axis", "lap"), ("side", "lap")
    ):  # fmt: skip
        if owner in present:
            coords[dim] = list(COMPONENTS[dim])
    for dim, fields, owners in groups:
        coords[dim] = np.array(list(owners), dtype=object if owners else str)
        for field in fields:
            if field.stacked:
                data[field.name] = (
                    ("time", dim, *field.dims),
                    stacked(field, list(owners.values()), steps),
                    _attributes(field),
                )
                continue
            for name, owner in owners.items():
                second = "_second" if field.name.endswith("_second") else ""
                dims = tuple(d if d in SIZES else f"{d}{second}_{name}" for d in field.dims)
                about = _attributes(of_owner(field, owner))
                data[f"{field.name}_{name}"] = (("time", *dims), getattr(owner, field.attribute), about)
    for place, prefix in enumerate(("joint_coordinate", "joint_second_coordinate")):
        names = [joint.names[place] if place < len(joint.names) else "" for joint in history.joints.values()]
        coords[f"{prefix}_name"] = (("joint",), np.array(names, dtype=object if names else str))
    for name, contact in contacts.items():
        if name not in cells:  # whose rows move, see contact_cell_z
            z = np.asarray(contact.view.first.grid.z)
            about = {"units": "m", "frame": "along the axis of the first surface"}
            coords[f"row_{name}"] = ((f"row_{name}",), z, about)
        arc = {"units": "m", "frame": "first surface, from the line of centres"}
        coords[f"arc_{name}"] = (("time", f"column_{name}"), contact.arc, arc)
    for name in result.film_names:
        for field in FILM_POSITIONS:
            dim = f"{field.dims[0]}_{name}"
            coords[dim] = ((dim,), getattr(result.film(name), field.attribute), _attributes(field))
    for name, lap in laps.items():
        for field in LAP_CELLS:
            dims = tuple(d if d in SIZES else f"{d}_{name}" for d in field.dims)
            coords[f"{field.name}_{name}"] = (dims, getattr(lap.view, field.attribute), _attributes(field))
    for name in result.sensor_names:
        sensor = result.sensor(name)
        coords[f"component_{name}"] = list(sensor.components)
        about = {"units": sensor.unit, "frame": sensor.frame}
        data[f"sensor_{name}"] = (("time", f"component_{name}"), sensor.values, about)
    coords["energy_line"] = list(history.energy)
    lines = np.stack(list(history.energy.values()), axis=1) if history.energy else np.zeros((steps, 0))
    data["energy"] = (("time", "energy_line"), lines, {"units": ENERGY_UNITS, "frame": "none"})
    return xr.Dataset(data, coords=coords, attrs={"status": result.status, "message": result.message})


def _attributes(field: Field) -> dict[str, str]:
    return {"units": field.units, "frame": field.frame}
