"""A run as one HDF5 file: writing and reading.

    /time (time), /step_size, /iterations, /factorisations
    /body_position (time, body, axis), /contact_force (time, pair, axis), ...   stacked over the owners
    /lumped_force (time, lumped_contact, axis), ...   over the lumped contacts, if any
    /film_force (time, film, axis), /film_pressure/<film> (time, film_column, film_row), ...   over the oil films, if
                             any; /film_theta/<film>, /film_z/<film> coordinates of the nodes
    /small_sliding_force (time, small_sliding, axis), /small_sliding_pressure/<name> (time, small_sliding_cell), ...
                             over the small-sliding contacts, if any; /small_sliding_point/<name>, ... their cells
    /contact_friction_power (time, friction_pair), ...   over the contacts with friction, if any
    /contact_cell_half_width (time, cell_pair), /contact_cell_z/<pair> (time, row), ...   over the contacts
                             whose pressure is given on cells that move with the patch, if any
    /contact_pressure/<pair> (time, column, row), /body_modal/<body>, ...       one dataset per owner
    /sensor/<name> (time, component)
    /energy (time, line)
    /checkpoint/<array>      the complete state at the end, to continue from
    /scene                   names, pairs, mass data, hash of the scene
    /scene/description       everything a run depends on except reduced bodies, as JSON
    /reduced/<hash>          each reduced body once, as the bytes of its file

Names, energy lines, counters and notes are JSON in the file's attributes. Every dataset has the attributes `units`,
`frame` and `dims`; `fields.py` is the table. Derived quantities (half-width, positions of the pressure) are written for
other readers and are not read back. Names of owners are percent-encoded where HDF5 requires it ("/", ".").

The schema version increases with every new quantity or name; files of other versions are refused.

A checksum of the whole file follows the last byte (`model/files/sealed_file.py`); other readers ignore it.

History check. The arrays of a run must be consistent: one row per saved time, axes of the right length, finite motion.

The checksum detects damage to a file, but not wrong arrays written by a faulty writer.
"""

from __future__ import annotations

import json
import os
import tempfile
from pathlib import Path
from typing import Any
from urllib.parse import quote, unquote

import h5py
import numpy as np

from warpffrf.model.errors import InputError
from warpffrf.model.files import hdf5_parts
from warpffrf.model.files.hdf5_parts import member, read
from warpffrf.model.files.paths import check_ending, checked_output_path
from warpffrf.model.files.sealed_file import check_schema, verify, written_sealed
from warpffrf.model.messages.status import Status
from warpffrf.model.reduced.body import ReducedBody
from warpffrf.model.reduced.file import read_reduced_body
from warpffrf.model.surfaces import from_description
from warpffrf.online.history.history import (
    BodyHistory,
    BudgetLine,
    CellHistory,
    ContactHistory,
    FilmHistory,
    ForceHistory,
    FrictionHistory,
    History,
    JointFrictionHistory,
    JointHistory,
    LumpedHistory,
    SensorHistory,
    SmallSlidingHistory,
)
from warpffrf.output.files.fields import (
    BODY_FIELDS,
    CELL_FIELDS,
    CONTACT_FIELDS,
    DERIVED_FIELDS,
    DERIVED_POSITIONS,
    ENERGY_UNITS,
    FILM_FIELDS,
    FILM_HEAT_FIELDS,
    FILM_POSITIONS,
    FILM_SECOND_FIELDS,
    FORCE_FIELDS,
    FRICTION_DERIVED,
    FRICTION_FIELDS,
    JOINT_FIELDS,
    JOINT_FRICTION_FIELDS,
    LUMPED_FIELDS,
    RUN_FIELDS,
    SIZES,
    SMALL_SLIDING_CELLS,
    SMALL_SLIDING_DERIVED,
    SMALL_SLIDING_FIELDS,
    Field,
    of_owner,
)
from warpffrf.output.files.table import stacked
from warpffrf.output.geometry.scene_view import (
    GROUND,
    Anchor,
    BodyView,
    FilmView,
    PairView,
    SceneView,
    SmallSlidingView,
    ground_view,
)

FORMAT = "warpffrf-results"
SCHEMA_VERSION = 9
SUFFIXES = (".h5", ".hdf5")
COMPRESSION = {"compression": "gzip", "compression_opts": 4, "shuffle": True}
_GROUPS = (
    ("bodies", "body", BODY_FIELDS, BodyHistory),
    ("joints", "joint", JOINT_FIELDS, JointHistory),
    ("contacts", "pair", CONTACT_FIELDS, ContactHistory),
    ("forces", "force", FORCE_FIELDS, ForceHistory),
    ("lumped_contacts", "lumped_contact", LUMPED_FIELDS, LumpedHistory),
    ("films", "film", FILM_FIELDS, FilmHistory),
    ("small_sliding", "small_sliding", SMALL_SLIDING_FIELDS, SmallSlidingHistory),
)
_ONLY_WHERE_THERE = ("lumped_contact", "film", "small_sliding")


def write_results(result: Any, path: str | os.PathLike[str], *, overwrite: bool = False) -> Path:
    """Write `result` to `path` atomically. Raises InputError for a path that cannot be written, a wrong file ending,
    and an existing file, unless `overwrite` is set and warpffrf wrote it."""
    check_ending(path, "results", SUFFIXES)
    target = checked_output_path(path, "results", overwrite=overwrite)
    with written_sealed(target) as file:
        put_result(file, result)
    return target


def put_result(file: Any, result: Any, *, bodies: bool = True, packing: dict[str, Any] = COMPRESSION) -> None:
    """Write `result` into an open file; without `bodies` the reduced bodies are left to another file. packing:
    compression of the datasets of histories."""
    history: History = result.history
    steps = len(history.time)
    file.attrs.update({"format": FORMAT, "schema_version": SCHEMA_VERSION})
    file.attrs.update({"status": str(history.status), "message": history.message})
    file.attrs["counters"] = json.dumps({k: float(v) for k, v in history.counters.items()})
    file.attrs["notes"] = json.dumps(list(history.notes))
    file.attrs["options"] = json.dumps(history.options)
    file.attrs["versions"] = json.dumps(history.versions)
    file.attrs["budget"] = json.dumps(
        [{**vars(line), "size": line.size if line.found else None} for line in history.budget]
    )
    for field in RUN_FIELDS:
        _put(file, field, getattr(history, field.attribute), (), packing)
    for attribute, dim, fields, _ in _GROUPS:
        owners: dict[str, Any] = getattr(history, attribute)
        file.attrs[f"{dim}_names"] = json.dumps(list(owners))
        if owners or dim not in _ONLY_WHERE_THERE:
            _put_group(file, dim, fields, owners, steps, packing)
    file.attrs["joint_coordinates"] = json.dumps({name: j.names for name, j in history.joints.items()})
    contacts = {name: result.contact(name) for name in history.contacts}
    _put_group(file, "pair", (*DERIVED_FIELDS, *DERIVED_POSITIONS), contacts, steps, packing)
    cells = {name: c.cells for name, c in history.contacts.items() if c.cells is not None}
    file.attrs["cell_names"] = json.dumps(list(cells))
    if cells:
        _put_group(file, "cell_pair", CELL_FIELDS, cells, steps, packing)
    rubbing = {name: c.friction for name, c in contacts.items() if c.has_friction}
    file.attrs["friction_names"] = json.dumps(list(rubbing))
    if rubbing:
        _put_group(file, "friction_pair", (*FRICTION_FIELDS, *FRICTION_DERIVED), rubbing, steps, packing)
    stuck = {name: force.friction for name, force in history.forces.items() if force.friction is not None}
    file.attrs["joint_friction_names"] = json.dumps(list(stuck))
    if stuck:
        _put_group(file, "joint_friction", JOINT_FRICTION_FIELDS, stuck, steps, packing)
    yielding = {name: film for name, film in history.films.items() if film.load_second is not None}
    file.attrs["film_second_names"] = json.dumps(list(yielding))
    if yielding:
        _put_group(file, "film", FILM_SECOND_FIELDS, yielding, steps, packing)
    warm = {name: film for name, film in history.films.items() if film.temperature is not None}
    file.attrs["film_heat_names"] = json.dumps(list(warm))
    if warm:
        _put_group(file, "film_heat", FILM_HEAT_FIELDS, warm, steps, packing)
    _put_fixed(file, FILM_POSITIONS, {name: result.film(name) for name in history.films})
    if history.small_sliding:
        _put_group(
            file,
            "small_sliding",
            SMALL_SLIDING_DERIVED,
            {name: result.contact(name) for name in history.small_sliding},
            steps,
            packing,
        )
    _put_fixed(file, SMALL_SLIDING_CELLS, {name: result.view.small_sliding[name] for name in history.small_sliding})
    lines = np.stack(list(history.energy.values()), axis=1) if history.energy else np.zeros((steps, 0))
    file.attrs["energy_lines"] = json.dumps(list(history.energy))
    _put(file, Field("energy", "energy", ENERGY_UNITS, "none", ("line",)), lines, (), packing)
    _put_sensors(file, result, packing)
    for name, array in history.checkpoint.items():
        data = file.create_dataset(f"checkpoint/{_key(name)}", data=np.asarray(array))
        data.attrs.update({"units": "internal", "frame": "internal", "dims": "internal"})
    _put_scene(file, result.view, bodies)


def read_history(path: str | os.PathLike[str]) -> History:
    """The `History` in a results file; its `scene` is a `SceneView`.

    Raises InputError if the file is missing, is not a results file, is damaged, or has another schema.
    """
    source = Path(path).expanduser()
    if not source.is_file():
        beside = source.with_name(f"{source.name}.unfinished")
        what_is = f"; '{beside}' holds what its run had done when it was stopped" if beside.is_dir() else ""
        raise InputError(f"results file '{source}' does not exist{what_is}")
    subject, cure = f"results file '{source}'", "write it again"
    verify(source, subject, cure)
    try:
        with h5py.File(source, "r") as file:
            attributes: Any = file.attrs
            if attributes.get("format") != FORMAT:
                raise InputError(f"'{source}' is not a results file of warpffrf")
            check_schema(int(attributes["schema_version"]), SCHEMA_VERSION, subject, cure)
            history = get_history(file)
        check_history(history)
        return history
    except InputError as error:
        raise error if str(source) in str(error) else InputError(f"{subject}: {error}; {cure}") from None
    except Exception as error:  # reading a foreign document can raise anything
        reason = " ".join(str(error).split()) or type(error).__name__
        raise InputError(f"{subject} is damaged ({reason}); {cure}") from error


def get_history(file: Any, scene: SceneView | None = None) -> History:
    """The `History` in an open results file; `scene`: that of the file with the bodies, for a file without them."""
    groups = {}
    run = {f.attribute: read(file, f.name) for f in RUN_FIELDS}
    for attribute, dim, fields, record in _GROUPS:
        names = json.loads(file.attrs[f"{dim}_names"])
        groups[attribute] = {name: record(**_fields_of(file, fields, name, n)) for n, name in enumerate(names)}
    for name, named in json.loads(file.attrs["joint_coordinates"]).items():
        groups["joints"][name].names = tuple(named)
    for n, name in enumerate(json.loads(file.attrs["cell_names"])):
        groups["contacts"][name].cells = CellHistory(**_fields_of(file, CELL_FIELDS, name, n))
    for n, name in enumerate(json.loads(file.attrs["friction_names"])):
        groups["contacts"][name].friction = FrictionHistory(**_fields_of(file, FRICTION_FIELDS, name, n))
    for name in json.loads(file.attrs["film_second_names"]):
        vars(groups["films"][name]).update(_fields_of(file, FILM_SECOND_FIELDS, name))
    for n, name in enumerate(json.loads(file.attrs["film_heat_names"])):
        vars(groups["films"][name]).update(_fields_of(file, FILM_HEAT_FIELDS, name, n))
    for n, name in enumerate(json.loads(file.attrs["joint_friction_names"])):
        groups["forces"][name].friction = JointFrictionHistory(**_fields_of(file, JOINT_FRICTION_FIELDS, name, n))
    energy = read(file, "energy")
    return History(
        scene=_get_scene(file) if scene is None else scene,
        energy={line: energy[:, n] for n, line in enumerate(json.loads(file.attrs["energy_lines"]))},
        status=Status(str(file.attrs["status"])),
        message=str(file.attrs["message"]),
        counters={str(k): float(v) for k, v in json.loads(file.attrs["counters"]).items()},
        notes=[str(note) for note in json.loads(file.attrs["notes"])],
        options={str(k): str(v) for k, v in json.loads(file.attrs["options"]).items()},
        budget=[_budget_line(line) for line in json.loads(file.attrs["budget"])],
        versions={str(k): str(v) for k, v in json.loads(file.attrs["versions"]).items()},
        sensors=_get_sensors(file),
        checkpoint={unquote(k): read(file, f"checkpoint/{k}") for k in hdf5_parts.names(file, "checkpoint")},
        **run,
        **groups,
    )


def _budget_line(line: dict[str, Any]) -> BudgetLine:
    size = line["size"]
    words = {name: str(line[name]) for name in ("source", "of", "basis", "cure")}
    return BudgetLine(size=np.nan if size is None else float(size), share=float(line["share"]), **words)


def _fields_of(file: Any, fields: tuple[Field, ...], name: str, n: int = 0) -> dict[str, Any]:
    """The fields of one owner in the file."""
    return {field.attribute: _get(file, field, name, n) for field in fields}


# --- datasets ---


def _key(name: str) -> str:
    return quote(name, safe=" _-+()").replace(".", "%2E")


def _put(
    parent: Any, field: Field, values: Any, owner_dims: tuple[str, ...], packing: dict[str, Any], key: str | None = None
) -> None:
    array = np.asarray(values)
    data = parent.create_dataset(key or field.name, data=array, **(packing if array.size else {}))
    data.attrs.update({"units": field.units, "frame": field.frame})
    data.attrs["dims"] = " ".join(("time", *owner_dims, *field.dims))


def _put_group(
    file: Any, dim: str, fields: tuple[Field, ...], owners: dict[str, Any], steps: int, packing: dict[str, Any]
) -> None:
    for field in fields:
        if field.stacked:
            _put(file, field, stacked(field, list(owners.values()), steps), (dim,), packing)
            continue
        group = file.create_group(field.name)
        for name, owner in owners.items():
            _put(group, of_owner(field, owner), getattr(owner, field.attribute), (), packing, key=_key(name))


def _put_fixed(file: Any, fields: tuple[Field, ...], owners: dict[str, Any]) -> None:
    """Write quantities that are the same in all steps."""
    for field in fields if owners else ():
        group = file.create_group(field.name)
        for name, owner in owners.items():
            data = group.create_dataset(_key(name), data=getattr(owner, field.attribute))
            data.attrs.update({"units": field.units, "frame": field.frame, "dims": " ".join(field.dims)})


def _get(file: Any, field: Field, name: str, n: int) -> np.ndarray:
    return read(file, field.name, np.s_[:, n]) if field.stacked else read(file, f"{field.name}/{_key(name)}")


def _put_sensors(file: Any, result: Any, packing: dict[str, Any]) -> None:
    group = file.create_group("sensor")
    file.attrs["sensor_names"] = json.dumps(result.sensor_names)  # HDF5 sorts members by name
    for name in result.sensor_names:
        sensor = result.sensor(name)
        values = np.asarray(sensor.values)
        data = group.create_dataset(_key(name), data=values, **(packing if values.size else {}))
        data.attrs.update({"units": sensor.unit, "frame": sensor.frame, "dims": "time component"})
        data.attrs.update({"kind": sensor.kind, "components": json.dumps(list(sensor.components))})


def _get_sensors(file: Any) -> dict[str, SensorHistory]:
    found = {}
    for key in hdf5_parts.names(file, "sensor"):
        values, said = read(file, f"sensor/{key}"), file[f"sensor/{key}"].attrs
        what = str(said["kind"]), str(said["units"]), str(said["frame"]), tuple(json.loads(said["components"]))
        found[unquote(key)] = SensorHistory(*what, values)
    return {name: found[name] for name in json.loads(file.attrs["sensor_names"])}


# --- the scene, as far as results need it ---


def _put_scene(file: Any, view: SceneView, reduced: bool) -> None:
    group = file.create_group("scene")
    group.attrs["content_hash"] = view.content_hash
    told = np.frombuffer(json.dumps(view.description).encode(), dtype=np.uint8)
    group.create_dataset("description", data=told, **COMPRESSION)
    group["description"].attrs.update({"units": "bytes", "frame": "JSON", "dims": "byte"})
    group.attrs["joints"] = json.dumps(list(view.joints))
    bodies, hashes = [], {}
    for body in view.bodies.values():
        digest = None
        if body.reduced is not None:
            digest = hashes.get(id(body.reduced)) or body.reduced.content_hash()
            hashes[id(body.reduced)] = digest
            if reduced and f"reduced/{digest}" not in file:
                file.create_dataset(f"reduced/{digest}", data=_as_bytes(body.reduced))
                file[f"reduced/{digest}"].attrs.update(
                    {"units": "bytes", "frame": "a reduced-body file", "dims": "byte"}
                )
        center = [float(v) for v in body.center_of_mass]
        inertia = np.asarray(body.inertia).tolist()
        bodies.append(
            {"name": body.name, "mass": body.mass, "center_of_mass": center, "inertia": inertia, "reduced": digest,
             "shapes": _described(body), "stiffening": body.stiffening}
        )  # fmt: skip
    group.attrs["bodies"] = json.dumps(bodies)
    for kind, found in (("pairs", view.pairs), ("lumped", view.lumped)):
        pairs = [
            [p.name, p.first_body.name, p.first_surface_name, p.second_body.name, p.second_surface_name, p.friction]
            for p in found.values()
        ]
        group.attrs[kind] = json.dumps(pairs)
    films = [
        [f.name, f.first_body.name, f.first_surface_name, f.second_body.name, f.second_surface_name, f.clearance]
        for f in view.films.values()
    ]
    group.attrs["films"] = json.dumps(films)
    small_sliding = [
        [v.name, v.first_body.name, v.first_surface_name, v.second_body.name, v.second_surface_name, v.friction]
        for v in view.small_sliding.values()
    ]
    group.attrs["small_sliding"] = json.dumps(small_sliding)
    fixed = [
        b
        for p in (*view.pairs.values(), *view.lumped.values(), *view.films.values(), *view.small_sliding.values())
        for b in (p.first_body, p.second_body)
        if b.name not in view.bodies
    ]
    group.attrs["ground"] = json.dumps({name: shape for b in fixed for name, shape in _described(b).items()})
    group.attrs["anchors"] = json.dumps([anchor.describe() for anchor in view.anchors])
    group.attrs["bearings"] = json.dumps(view.bearings)
    group.attrs["gears"] = json.dumps(view.gears)


def _described(body: BodyView) -> dict[str, Any]:
    return {name: shape.describe() for name, shape in body.shapes.items()}


def _shapes(described: dict[str, Any]) -> dict[str, Any]:
    return {name: from_description(data) for name, data in described.items()}


def _get_scene(file: Any) -> SceneView:
    group = member(file, "scene")
    reduced: dict[str | None, Any] = {None: None}
    for digest in hdf5_parts.names(file, "reduced"):
        reduced[digest] = _from_bytes(read(file, f"reduced/{digest}"), digest, file.filename)
    bodies = {
        b["name"]: BodyView(
            b["name"], reduced[b["reduced"]], b["mass"], np.array(b["center_of_mass"]),
            np.array(b["inertia"]), _shapes(b["shapes"]), b["stiffening"],
        )
        for b in json.loads(group.attrs["bodies"])
    }  # fmt: skip
    known = {GROUND: ground_view(_shapes(json.loads(group.attrs["ground"]))), **bodies}
    pairs, lumped = (
        {
            name: PairView(name, known[first], first_surface, known[second], second_surface, *friction)
            for name, first, first_surface, second, second_surface, *friction in json.loads(group.attrs[kind])
        }
        for kind in ("pairs", "lumped")
    )
    films = {
        name: FilmView(name, known[first], first_surface, known[second], second_surface, clearance=clearance)
        for name, first, first_surface, second, second_surface, clearance in json.loads(group.attrs["films"])
    }
    small_sliding = {
        name: SmallSlidingView(
            name, known[first], first_surface, known[second], second_surface, friction,
            **{field.attribute: read(file, f"{field.name}/{_key(name)}") for field in SMALL_SLIDING_CELLS},
        )
        for name, first, first_surface, second, second_surface, friction in json.loads(group.attrs["small_sliding"])
    }  # fmt: skip
    anchors = tuple(Anchor.of(data) for data in json.loads(group.attrs["anchors"]))
    joints = tuple(json.loads(group.attrs["joints"]))
    bearings, gears = json.loads(group.attrs["bearings"]), json.loads(group.attrs["gears"])
    told = read(file, "scene/description").tobytes()
    return SceneView(
        str(group.attrs["content_hash"]), bodies, pairs, joints, anchors, lumped, films, small_sliding, bearings, gears,
        dict(json.loads(told)),
    )  # fmt: skip


def _as_bytes(reduced: Any) -> np.ndarray:
    with tempfile.TemporaryDirectory() as folder:
        return np.frombuffer(reduced.save(Path(folder) / "body.h5").read_bytes(), dtype=np.uint8)


def _from_bytes(data: np.ndarray, digest: str | None, source: str) -> ReducedBody:
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "body.h5"
        file.write_bytes(data.tobytes())
        return read_reduced_body(ReducedBody, file, f"the reduced body in results file '{source}'", digest)


# other numbers may be NaN if they are unknown
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
    "small_sliding": ("force", "torque", "normal_force", "pressure", "traction", "gap", "slip", "loss"),
}


def check_history(history: History) -> None:
    """Raise `InputError` that names the first inconsistent array and the reason."""
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
        _check_owner(film if film.temperature is not None else None, FILM_HEAT_FIELDS, name, steps)
        _check_film_grid(film, name, history.scene)
    for name, contact in history.small_sliding.items():
        _check_owner(contact, SMALL_SLIDING_FIELDS, name, steps)
        _check_small_sliding_cells(contact, name, history.scene)
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
    """Check the fields of a film against the grid of its first surface in the file."""
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


def _check_small_sliding_cells(contact: Any, name: str, scene: Any) -> None:
    """Check the fields of a small-sliding contact against its cells in the file."""
    if not isinstance(scene, SceneView):
        return
    if name not in scene.small_sliding:
        raise InputError(
            f"contact '{name}' has a history, but the scene has no contact with small sliding of this name"
        )
    cells, count = len(scene.small_sliding[name].area), np.shape(contact.pressure)[1]
    if count != cells:
        raise InputError(f"small_sliding_pressure of '{name}' has {count} cells, the contact has {cells}")


def _check_owner(owner: Any, fields: Any, name: str, steps: int) -> None:
    """Check the quantities of one owner; dimensions of the same name must have the same length. None has no
    quantities."""
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
