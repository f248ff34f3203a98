"""The formats that are read: a sound file of each, how it is read, and how it is damaged."""

from __future__ import annotations

import hashlib
import importlib
import json
import random
import shutil
import sys
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import meshio
import mutations
import numpy as np
import scipy.sparse as sp
from scipy.io import mmwrite

import warpffrf as wf
from warpffrf.model.files.sealed_file import HEAD, TRAILER, seal
from warpffrf.model.mesh.files.matrices import read_matrix
from warpffrf.model.mesh.files.unv_modes import read_modes
from warpffrf.model.messages.checkpoints import Source
from warpffrf.model.reduced.file import _digest, _flatten
from warpffrf.output.files import unfinished
from warpffrf.output.result import Result
from warpffrf.study.sweeps.job import Answer, Value
from warpffrf.study.sweeps.table import Table

TESTS = Path(__file__).resolve().parents[1]
DATA = TESTS / "data"


@dataclass(frozen=True)
class Format:
    """`make(path)` writes a sound file; `read(path)` returns a digest of all that is read from it; `damage` changes the
    copy at a path and returns what was done. `exact`: a file with other numbers is not to be read without a word."""

    suffix: str
    make: Callable[[Path], Any]
    read: Callable[[Path], str]
    damage: Callable[[Path, random.Random], str]
    exact: bool = False


def digest(*things: Any) -> str:
    sha = hashlib.sha256()
    for thing in things:
        sha.update(_flat(thing))
    return sha.hexdigest()


def _flat(thing: Any) -> bytes:
    if isinstance(thing, np.ndarray):
        return repr((thing.shape, thing.dtype)).encode() + thing.tobytes()
    if isinstance(thing, dict):
        return b"".join(repr(key).encode() + _flat(value) for key, value in thing.items())
    if isinstance(thing, list | tuple):
        return b"".join(_flat(value) for value in thing)
    if hasattr(thing, "__dataclass_fields__"):
        return _flat(vars(thing))
    return repr(thing).encode()


# --- damage ---


def bytewise(path: Path, rng: random.Random) -> str:
    data, what = mutations.of_bytes(path.read_bytes(), rng)
    path.write_bytes(data)
    return what


def textwise(path: Path, rng: random.Random) -> str:
    data, what = mutations.of_text(path.read_bytes(), rng)
    path.write_bytes(data)
    return what


def array_of_body(path: Path, rng: random.Random) -> str:
    """A faulty writer: an array is wrong, its hash and the seal are right."""
    import h5py

    what = mutations.of_arrays(path, rng)
    if what.split()[0] not in ("huge", "unknown", "elsewhere", "attribute"):
        with h5py.File(path, "r+") as file:
            arrays: dict[str, np.ndarray] = {}
            file.visititems(lambda n, i: arrays.update({n: np.asarray(i[()])}) if isinstance(i, h5py.Dataset) else None)
            facts: Any = file["facts"]
            known = {key: a for key, a in arrays.items() if key not in ("facts", "report", "provenance")}
            file.attrs["content_hash"] = _digest(known, json.loads(facts[()]))
    seal(path)
    return what


def array_of_results(path: Path, rng: random.Random) -> str:
    what = mutations.of_arrays(path, rng)
    seal(path)
    return what


def header_of_arrays(path: Path, rng: random.Random) -> str:
    """A faulty writer of a file of arrays: its header is wrong, its length and the seal are right."""
    data = path.read_bytes()[: -TRAILER.size]
    mark, size = HEAD.unpack(data[: HEAD.size])
    header, what = mutations.of_text(data[HEAD.size : HEAD.size + size], rng)
    path.write_bytes(HEAD.pack(mark, len(header)) + header + data[HEAD.size + size :])
    seal(path)
    return what


# --- sound files, and what is read from them ---


def make_body(path: Path) -> None:
    mesh = wf.mesh.roller(0.05, 0.015, 0.02, sectors=24, layers=2, axial=2, order=1)
    steel = wf.Material(youngs_modulus=210e9, poisson_ratio=0.3, density=7850)
    interfaces, contact = {"bore": "rigid"}, {"rim": wf.surfaces.Cylinder()}
    body = wf.reduce(mesh, steel, interfaces=interfaces, contact=contact, modes=4, cache=False, progress=False)
    body.save(path, overwrite=True)


def read_body(path: Path) -> str:
    body = wf.ReducedBody.load(path)
    return digest(*_flatten(body), body.report, body.provenance, body.info())


def make_results(path: Path) -> None:
    sys.path.insert(0, str(TESTS / "output"))
    synthetic = importlib.import_module("synthetic_run")
    Result(synthetic.make_history(synthetic.roller())).save(path, overwrite=True)


def read_results(path: Path) -> str:
    result = Result.load(path)
    history, view = result.history, result.view
    kept = {key: value for key, value in vars(history).items() if key != "scene"}
    bodies = [(b.name, b.mass, b.center_of_mass, b.inertia, b.reduced and b.reduced.content_hash())
              for b in view.bodies.values()]  # fmt: skip
    return digest(kept, bodies, view.content_hash, result.report())


def make_source(path: Path) -> None:
    """What rows of a run under way are of."""
    make_toml(path.with_suffix(".toml"))
    unfinished._write_source(path, Source("steps", wf.load_scene(path.with_suffix(".toml")).scene))


def read_source(path: Path) -> str:
    folder = path.with_name(f"{path.name}.unfinished")
    folder.mkdir(exist_ok=True)
    shutil.copy(path, folder / unfinished.SCENE)
    found = unfinished._read_source(folder)
    return digest(found.scene.content_hash(), found.kind)


def copied(name: str | Path) -> Callable[[Path], Any]:
    return lambda path: shutil.copy(DATA / name, path)


def read_mesh(path: Path, **options: Any) -> str:
    mesh = wf.mesh.read(path, length_unit="mm", **options)
    mesh.check()
    assert np.isfinite(mesh.points).all()
    facets = {name: found.blocks for name, found in mesh.facet_sets.items()}
    return digest(mesh.points, mesh.cells, facets, mesh.cell_sets, mesh.materials)


def make_inp(path: Path) -> None:
    path.write_text((DATA / "flat.inp").read_text())
    shutil.copy(DATA / "flat_nodes.inp", path.parent)


def make_orthotropic(path: Path) -> None:
    make_inp(path)
    text = path.read_text()
    for old, new in (
        ("ELSET=LOWER, MATERIAL=A", "ELSET=LOWER, MATERIAL=A, ORIENTATION=O"),
        ("*ELASTIC\n2.1D11, 0.3", "*ELASTIC, TYPE=ENGINEERING CONSTANTS\n135., 10., 8., 0.3, 0.25, 0.45, 5., 4.,\n3.4"),
    ):
        assert old in text
        text = text.replace(old, new)
    path.write_text(f"{text}\n*ORIENTATION, NAME=O\n1., 2., 0.5, 0., 1., -1.\n3, 30.\n")


def read_assembly(path: Path) -> str:
    return read_mesh(path, part="Brick-2")


def vtu(binary: bool) -> Callable[[Path], Any]:
    def make(path: Path) -> None:
        box = wf.mesh.box((2, 1, 1), (3, 2, 2), order=1)
        held = box.facet_sets["x_min"].blocks["quad4"]
        marks: list[Any] = [np.zeros(len(box.cells["hex8"]), dtype=int), np.ones(len(held), dtype=int)]
        cells: Any = [("hexahedron", box.cells["hex8"]), ("quad", held)]
        meshio.Mesh(box.points, cells, cell_data={"held": marks}).write(path, binary=binary)

    return make


def make_bdf(path: Path) -> None:
    box = wf.mesh.box((2, 1, 1), (3, 2, 2), order=1)
    lines = ["BEGIN BULK"]
    lines += [f"GRID,{i},,{x:g},{y:g},{z:g}" for i, (x, y, z) in enumerate(box.points, start=1)]
    for i, cell in enumerate(box.cells["hex8"] + 1, start=1):
        lines += [f"CHEXA,{i},1,{','.join(map(str, cell[:6]))}", f"+,{cell[6]},{cell[7]}"]
    path.write_text("\n".join([*lines, "PSOLID,1,1", "MAT1,1,2.1+5,,.3,7.85-9", "ENDDATA", ""]))


def make_mtx(path: Path) -> None:
    springs = sp.kron(sp.csr_matrix([[1.0, -1, 0], [-1, 2, -1], [0, -1, 1]]), sp.eye(3)).tocoo() * 1e6
    mmwrite(path, springs, symmetry="symmetric")


def make_pch(path: Path) -> None:
    """A symmetric matrix of DMIG cards in large fields, of springs between nodes 1, 2 and 5."""
    lines = ["$TITLE   = SPRINGS", "DMIG    KAAX           0       6       2       0"]
    for a, b, value in ((1, 1, 1e6), (1, 2, -1e6), (2, 2, 2e6), (2, 5, -1e6), (5, 5, 1e6)):
        for c in (1, 2, 3):
            number = f"{value:.9E}".replace("E", "D")
            lines += [f"DMIG*   {'KAAX':16}{b:16}{c:16}", f"*       {a:16}{c:16}{number:>16}"]
    path.write_text("\n".join([*lines, ""]))


def read_matrix_file(path: Path) -> str:
    found = read_matrix(path)
    matrix = found.matrix.tocsr()
    assert np.isfinite(matrix.data).all()
    return digest(matrix.data, matrix.indices, matrix.indptr, found.dofs)


def read_sti(path: Path) -> str:
    shutil.copy(DATA / "calculix" / "hex8.dof", path.with_suffix(".dof"))
    return read_matrix_file(path)


def make_toml(path: Path) -> None:
    path.write_text(SCENE)


def read_toml(path: Path) -> str:
    found = wf.load_scene(path)
    return digest(found.scene.content_hash(), found.simulate, [s.name for s in found.scene.sensors], found.title)


SCENE = """title = "pendulum"
[parameters]
arm = 0.5  # m
half = "= arm / 2"
[scene]
gravity = [0, 0, -9.81]
[signals.push]
kind = "smooth_step"
start_value = 0.0
end_value = 3.0
duration = 0.05
[bodies.bob]
mass = 2.0
inertia_tensor = [0.01, 0.01, 0.01]
position = ["= arm", 0, 0]
[joints.hinge]
kind = "revolute"
a = "ground"
b = { body = "bob", point = ["= -arm", 0, 0] }
axis = [0, 1, 0]
[forces.brake]
kind = "joint_spring_damper"
joint = "hinge"
stiffness = 0.0
damping = 0.2  # N m s/rad
[forces.f]
kind = "point_force"
port = { body = "bob", point = [0, 0, 0] }
force = ["push", [0, 0, -1]]
[sensors.pin]
kind = "joint_reaction"
joint = "hinge"
[meshes.box]
kind = "box"
size = [1, 1, 1]
counts = [2, 2, 2]
[simulate]
duration = 1.0
step = 1e-3
save_every = 2
"""


def make_sweep(path: Path) -> None:
    """A table of three runs, one with a shorter history and one not run."""
    table = Table.empty(["load", "kind"], [{"load": 0.5 * n, "kind": "ab"[n % 2]} for n in range(3)])
    for n in range(2):
        values = {"peak": Value(np.array(2.0 + n)), "force": Value(np.arange(40.0 - n), ("time",), "N")}
        table.add(Answer(n, "completed", values=values, time=np.arange(40.0 - n), budget={"time step": 0.1}))
    table.write(path)


def read_sweep(path: Path) -> str:
    table = Table.read(path, 3)
    columns = {name: (column.array, column.dims, column.units) for name, column in table.columns.items()}
    texts = {name: list(values) for name, values in table.texts.items()}
    return digest(list(table.parameters["load"]), texts, table.numbers, columns, table.time, table.budget)


def make_modes(path: Path) -> None:
    """Points and two modes, one real and one complex."""
    lines = ["    -1", "    15"]
    lines += [f"{n:10d}{0:10d}{0:10d}{1:10d}{0.1 * n:13.5E}{0.2:13.5E}{-0.3 * n:13.5E}" for n in (1, 2, 5)]
    for analysis, kind, facts in ((2, 2, (123.4, 1.0, 0.01, 0.0)), (3, 5, (-7.5, 800.0, 0.0, 0.0, 0.0, 0.0))):
        lines += ["    -1", "    -1", "    55", *5 * ["NONE"]]
        lines.append("".join(f"{n:10d}" for n in (1, analysis, 2, 8, kind, 3)))
        lines.append("".join(f"{n:10d}" for n in (2, len(facts), 1, 1)))
        lines.append("".join(f"{x:13.5E}" for x in facts))
        for n in (1, 2, 5):
            lines += [f"{n:10d}", "".join(f"{(-1) ** i * n / 3.0:13.5E}" for i in range(3 * kind // 2 - kind // 5))]
    path.write_text("\n".join([*lines, "    -1", ""]))


def read_shapes(path: Path) -> str:
    found = read_modes(path)
    assert all(np.isfinite(a).all() for a in (found.points, found.frequencies, found.damping, found.shapes))
    return digest(found)


FORMATS: dict[str, Format] = {
    "body .h5": Format(".h5", make_body, read_body, bytewise, exact=True),
    "results .h5": Format(".h5", make_results, read_results, bytewise, exact=True),
    "body .h5, arrays": Format(".h5", make_body, read_body, array_of_body),
    "results .h5, arrays": Format(".h5", make_results, read_results, array_of_results),
    "run under way": Format(".arrays", make_source, read_source, bytewise, exact=True),
    "run under way, header": Format(".arrays", make_source, read_source, header_of_arrays),
    "sweep .h5": Format(".h5", make_sweep, read_sweep, bytewise, exact=True),
    ".msh 4.1": Format(".msh", copied("gmsh_hex8.msh"), read_mesh, textwise),
    ".msh 2.2": Format(".msh", copied("gmsh_wedge6.msh"), read_mesh, textwise),
    ".msh binary": Format(".msh", copied(wf.examples.path("roller") / "roller.msh"), read_mesh, bytewise),
    ".inp": Format(".inp", make_inp, read_mesh, textwise),
    ".inp orthotropic": Format(".inp", make_orthotropic, read_mesh, textwise),
    ".inp assembly": Format(".inp", copied("assembly.inp"), read_assembly, textwise),
    ".cdb": Format(".cdb", copied("box.cdb"), read_mesh, textwise),
    ".unv": Format(".unv", copied("box.unv"), read_mesh, textwise),
    ".unv, modes": Format(".unv", make_modes, read_shapes, textwise),
    ".med": Format(".med", copied("gmsh_hex20.med"), read_mesh, bytewise),
    ".med, arrays": Format(".med", copied("gmsh_hex20.med"), read_mesh, mutations.of_arrays),
    ".vtu ASCII": Format(".vtu", vtu(False), read_mesh, textwise),
    ".vtu binary": Format(".vtu", vtu(True), read_mesh, bytewise),
    ".bdf": Format(".bdf", make_bdf, read_mesh, textwise),
    ".mtx": Format(".mtx", make_mtx, read_matrix_file, textwise),
    ".pch": Format(".pch", make_pch, read_matrix_file, textwise),
    ".sti": Format(".sti", copied("calculix/hex8.sti"), read_sti, textwise),
    ".toml": Format(".toml", make_toml, read_toml, textwise),
}
