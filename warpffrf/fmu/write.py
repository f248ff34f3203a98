"""Packing of a scene file as an FMU: `write_fmu`.

Packed are the scene as one file without includes and parameters, its reduced bodies, and the input files that remain:
meshes are left out wherever only reductions use them. On the other machine Python with this version of warpffrf is
required; pythonfmu, which is in the FMU, finds it.
"""

from __future__ import annotations

import copy
import importlib
import json
import os
import re
import shutil
import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import fields
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np

import warpffrf
from warpffrf.fmu.instance import DEFINITION, SCENE, STATUS, TIME, Instance, run_step, simulation_of
from warpffrf.model.errors import InputError, require_number, unknown_name
from warpffrf.model.files.paths import check_ending, checked_output_path, written_whole
from warpffrf.model.messages.named_arguments import named_arguments
from warpffrf.model.messages.status import Status
from warpffrf.output.files.table import histories, quantity, series_of_sensor
from warpffrf.output.options import RunOptions
from warpffrf.output.simulation import Simulation
from warpffrf.scene_file import LoadedScene, load_scene
from warpffrf.scene_file.document import to_toml

MODULES = {"2.0": ("pythonfmu", "slave"), "3.0": ("pythonfmu3", "slave3")}  # library, and module with its slave
SCRIPT = '''"""The slave of this FMU: a scene of warpffrf."""

try:
    from warpffrf.fmu.{module} import SceneSlave as {base}
except ImportError as error:
    raise ImportError(
        f"this FMU needs warpffrf {version} in the Python that the importing tool uses; install it there ({{error}})"
    ) from error


class Scene({base}):
    pass


import warpffrf.fmu.kept

warpffrf.fmu.kept.keep(globals())
'''
KEPT = {"start", *(field.name for field in fields(RunOptions))} - {"save_every"}  # keys of [simulate] that are packed


@named_arguments
def write_fmu(
    scene_file: str | os.PathLike[str],
    path: str | os.PathLike[str],
    *,
    step: float | None = None,
    inputs: Sequence[str] | None = None,
    outputs: Sequence[str] | None = None,
    start: str | None = None,
    settings: Sequence[str] = (),
    fmi: str = "2.0",
    overwrite: bool = False,
) -> Path:
    """Write the scene of a TOML file as an FMU for co-simulation; returns its path, which ends in .fmu.

    step: of the simulation [s]; communication steps are multiples of it. inputs: names of `signals.Input`s that the
    importing tool sets, None: all; outputs: sensors and histories by their names in a result, None: all sensors; one of
    several components becomes one output for each. start: "initial" or "equilibrium". Step, start and options left out
    are those of [simulate]. settings: "name=value" as of `--set`. fmi: version of FMI, "2.0" or "3.0". overwrite:
    replace an existing FMU. Needs the extra `fmu`. Raises `InputError`.
    """
    builder = _library(fmi)
    check_ending(path, "write_fmu", (".fmu",))
    target = checked_output_path(path, "write_fmu", overwrite=overwrite, ours=_is_fmu)
    loaded = load_scene(scene_file, settings=settings)
    h = _step(step, loaded)
    if start not in (None, "initial", "equilibrium"):
        raise InputError(f"write_fmu: start must be 'initial' or 'equilibrium', got {start!r}")
    with TemporaryDirectory() as folder:
        resources = Path(folder)
        _pack(loaded, resources, h, start)
        definition = _definition(load_scene(resources / SCENE), target.stem, inputs, outputs)
        (resources / DEFINITION).write_text(json.dumps(definition, indent=1), encoding="utf-8")
        _try(resources)
        script = resources / f"warpffrf_{MODULES[fmi][1]}.py"
        base = f"Fmi{fmi[0]}Slave"  # the library looks for this word
        text = SCRIPT.format(module=MODULES[fmi][1], base=base, version=warpffrf.__version__)
        script.write_text(text, encoding="utf-8")
        packed = [one for one in resources.iterdir() if one != script]
        with written_whole(target) as partial, _imports_as_before(script.stem):
            made = builder.build_FMU(script, dest=resources / "out", project_files=packed, **_abilities(fmi))
            shutil.copyfile(made or next((resources / "out").glob("*.fmu")), partial)
    return target


def _library(fmi: str) -> Any:
    if fmi not in MODULES:
        raise InputError(f"write_fmu: fmi must be one of {', '.join(map(repr, MODULES))}, got {fmi!r}")
    try:
        return importlib.import_module(MODULES[fmi][0]).FmuBuilder
    except ImportError as error:
        raise InputError(f"write_fmu needs {MODULES[fmi][0]}: pip install 'warpffrf[fmu]'") from error


def _abilities(fmi: str) -> dict[str, bool]:
    """Attributes of the model description that differ from the defaults of the library."""
    state = "state" if fmi == "2.0" else "State"
    names = ("canHandleVariableCommunicationStepSize", f"canGetAndSetFMU{state}", f"canSerializeFMU{state}")
    return dict.fromkeys(names, True)


def _is_fmu(file: Path) -> bool:
    with file.open("rb") as stream:
        return stream.read(2) in (b"PK", b"")


@contextmanager
def _imports_as_before(script: str) -> Iterator[None]:
    """The library adds the folder of the script to the path of imports, and imports it."""
    path = list(sys.path)
    try:
        yield
    finally:
        sys.path[:] = path
        sys.modules.pop(script, None)


def _step(step: float | None, loaded: LoadedScene) -> float:
    if step is None:
        step = (loaded.simulate or {}).get("step")
    if step is None:
        raise InputError("write_fmu: the scene file has no [simulate] with a step; give step=")
    return require_number(step, "write_fmu: step", positive=True)


# --- resources


def _pack(loaded: LoadedScene, folder: Path, step: float, start: str | None) -> None:
    """Write the scene file with everything that it needs into `folder`."""
    values = copy.deepcopy(dict(loaded.document))
    made = {"meshes", "reduced_bodies"}
    if any(_names_meshes(table) for section, table in values.items() if section not in made):
        made = {"reduced_bodies"}
    for number, (name, body) in enumerate(loaded.made.get("reduced_bodies", {}).items()):
        file = body.save(folder / f"body_{number}.h5")
        values["reduced_bodies"][name] = {"path": file.name}
    if "meshes" in made:
        values.pop("meshes", None)
    for number, (path, file) in enumerate(loaded.files.items()):
        if path[0] not in made:
            name = f"file_{number}{file.suffix}"
            shutil.copyfile(file, folder / name)
            parent: Any = values
            for key in path[:-1]:
                parent = parent[key]
            parent[path[-1]] = name
    kept = {key: value for key, value in values.pop("simulate", {}).items() if key in KEPT}
    values = {key: value for key, value in values.items() if key not in ("equilibrium", "static")}
    values["simulate"] = kept | ({} if start is None else {"start": start}) | {"step": step, "duration": step}
    (folder / SCENE).write_text(to_toml(values), encoding="utf-8")


def _names_meshes(value: Any) -> bool:
    """Whether there is a surface of a mesh in a value of the document."""
    if isinstance(value, dict):
        return value.get("kind") == "mesh_surface" or any(map(_names_meshes, value.values()))
    return isinstance(value, list) and any(map(_names_meshes, value))


def _definition(
    loaded: LoadedScene, name: str, inputs: Sequence[str] | None, outputs: Sequence[str] | None
) -> dict[str, Any]:
    """What the instance has to know, and the names and units of the model description."""
    run = simulation_of(loaded)
    if run.status != Status.COMPLETED:
        raise InputError(f"write_fmu: the scene does not start ({run.status}: {run.message})")
    wanted = list(run.inputs) if inputs is None else list(inputs)
    for each in wanted:
        if each not in run.inputs:
            raise unknown_name("write_fmu: input", each, run.inputs)
    columns = _columns(run, [str(s.name) for s in loaded.scene.sensors] if outputs is None else list(outputs))
    names = [*wanted, *columns]
    twice = sorted({each for each in names if names.count(each) > 1 or each in (STATUS, TIME)})
    if twice:
        raise InputError(f"write_fmu: {twice[0]!r} is the name of two variables of the FMU; name each once")
    step = run_step(loaded)
    return {
        "identifier": _identifier(name),
        "version": warpffrf.__version__,
        "description": (
            f"{loaded.title}: a scene of warpffrf. The machine that runs it needs Python with warpffrf "
            f"{warpffrf.__version__}. Communication steps are multiples of {step:g} s. After a step that is discarded, "
            f"'{STATUS}' has the reason."
        ),
        "inputs": [{"name": n, "unit": run.inputs.units[n], "start": run.inputs[n]} for n in wanted],
        "outputs": [{"name": n, "unit": unit} for n, unit in columns.items()],
    }


def _columns(run: Simulation, names: Sequence[str]) -> dict[str, str]:
    """Units of outputs of one component, by name. Raises `InputError`."""
    if not names:
        raise InputError("write_fmu: there is no output; give outputs=, or add sensors to the scene")
    result = run.result()
    found: dict[str, str] = {}
    for name in names:
        if name in result.sensor_names:
            whole = series_of_sensor(result, name)
            found |= dict.fromkeys(whole.columns, whole.units)
            continue
        one = quantity(result, name)
        if one.values.ndim == 1:
            found[name] = one.units
            continue
        series = [each for each in histories(result) if each.label == name]
        if not series:
            raise InputError(f"write_fmu: output {name!r} has {np.size(one.values[-1])} values; an output has one")
        found |= dict.fromkeys(series[0].columns, one.units)
    return found


def _identifier(name: str) -> str:
    """A name of a C function, with letters, digits and underscores, for a file name."""
    found = re.sub(r"[^A-Za-z0-9_]", "_", name)
    return found if found[:1].isalpha() else f"fmu_{found}"


def _try(folder: Path) -> None:
    """Read every output of an instance and make one step of it. Raises `InputError`."""
    messages: list[str] = []
    one = Instance(folder, messages.append)
    one.end_initialisation()
    for each in one.definition["outputs"]:
        one.get(each["name"])
    one.step(0.0, one.step_size)
    if messages:
        raise InputError(f"write_fmu: the scene makes no step: {messages[0]}")
