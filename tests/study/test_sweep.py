"""A sweep: what it runs, keeps and reports; closed forms of a bob on a spring."""

from __future__ import annotations

import errno
import json
from functools import partial
from pathlib import Path
from typing import Any

import h5py
import meshio
import numpy as np
import pytest
from sweep_scenes import GRAVITY, IN_TIME, TIMES, bob, fall, named_bob, rest, scene_file, shy_bob, timed_bob

import warpffrf as wf
from warpffrf.model.errors import InputError
from warpffrf.model.files.sealed_file import TRAILER, seal
from warpffrf.study.sweeps import executors

STIFFNESS = [1000.0, 2000.0, 4000.0]
OUTPUTS = {
    "lowest": "min(body_position_z[bob])",
    "height": "body_position_z[bob]",
    "velocity": "body_velocity[bob]",
    "end": fall,
}
ROUND_OFF = 1e-12
BEAM = """
[parameters]
load = 1.0
density = 7850.0
modes = 1
[materials.steel]
youngs_modulus = 210e9
poisson_ratio = 0.3
density = "= density"
[meshes.beam]
kind = "read"
path = "a.vtu"
length_unit = "m"
[reduced_bodies.beam]
mesh = "beam"
material = "steel"
modes = "= modes"
cache = false
[bodies.beam]
body = "beam"
[scene]
gravity = ["= load", 0, 0]
"""


def run(
    store: Path, parameters: Any, outputs: Any = ("last(body_position_z[bob])",), scene: Any = bob, **options: Any
) -> Any:
    times = {} if scene is timed_bob or "run" in options else {"run": IN_TIME}
    return wf.study.sweep(scene, parameters, outputs=outputs, store=store, progress=False, **times, **options)


@pytest.fixture(scope="module")
def swept(tmp_path_factory: Any) -> Any:
    store = tmp_path_factory.mktemp("grid") / "bob.sweep"
    return run(store, {"stiffness": STIFFNESS, "mass": "1:2:2"}, OUTPUTS)


def test_a_grid_has_all_combinations_and_each_has_its_run(swept: Any) -> None:
    """z'' = -g - k z/m from rest at 0: z = -(m g/k) (1 - cos(w t)); the integrator errs by w^2 h^2/12 of it."""
    assert swept.status == "completed" and swept.counts == {"completed": 6}
    assert swept["stiffness"].tolist() == [k for k in STIFFNESS for _ in range(2)]
    assert swept["mass"].tolist() == [1, 2] * 3
    t = np.linspace(0.0, TIMES["duration"], 11)
    for k, m, height, lowest, end in zip(
        *(swept[n] for n in ("stiffness", "mass", "height", "lowest", "end")), strict=True
    ):
        omega = np.sqrt(k / m)
        exact = -(m * GRAVITY / k) * (1.0 - np.cos(omega * t))
        assert np.allclose(height, exact, atol=2.0 * (omega * TIMES["step"]) ** 2 * abs(exact).max())
        assert lowest == height.min() and np.array_equal(end, height)
    assert swept["velocity"].shape == (6, 11, 3)


def test_xarray_opens_the_table_lazily_with_parameters_as_coordinates(swept: Any) -> None:
    with swept.to_xarray() as data:
        assert set(data.coords) == {"run", "stiffness", "mass", "time", "axis"}
        assert data["height"].dims == ("run", "time") and data["velocity"].dims == ("run", "time", "axis")
        assert data["height"].attrs["units"] == "m" and data["end"].dims == ("run", "end[0]")
        chosen = data.where(data.stiffness == 2000.0, drop=True)["lowest"].values
        assert np.array_equal(chosen, swept["lowest"][2:4])
        assert np.allclose(data["time"].values, np.linspace(0.0, 0.01, 11), atol=ROUND_OFF)
        assert data["velocity"].sel(axis="z").values.tolist() == swept["velocity"][:, :, 2].tolist()
    frame = swept.to_dataframe()
    assert frame["lowest"].tolist() == swept["lowest"].tolist() and "height" not in frame and len(frame) == 6


def test_one_variable_is_read_without_the_others(tmp_path: Path) -> None:
    """Bytes that are asked of the file, counted."""
    import io

    import xarray

    from warpffrf.study.sweeps.job import Answer, Value
    from warpffrf.study.sweeps.table import Table

    table = Table.empty(["x"], [{"x": float(n)} for n in range(500)])
    random = np.random.default_rng(0)
    for n in range(500):
        values = {name: Value(random.random(50), ("time",)) for name in "abcdefgh"}
        table.add(Answer(n, "completed", values=values, time=np.arange(50.0)))
    table.write(tmp_path / "table.h5")

    class Counting(io.FileIO):
        taken = 0

        def readinto(self, buffer: Any) -> int:
            found = super().readinto(buffer)
            Counting.taken += found
            return found

    size = (tmp_path / "table.h5").stat().st_size
    with xarray.open_dataset(Counting(tmp_path / "table.h5"), engine="h5netcdf") as data:
        opening = Counting.taken
        assert np.array_equal(data["c"].values, table.columns["c"].array)
    array = 500 * 50 * 8
    assert size > 8 * 0.8 * array  # random numbers do not pack
    assert opening < 0.1 * size
    assert 0.8 * array < Counting.taken - opening < 1.5 * array


def test_runs_of_other_lengths_have_their_own_times_and_nan_behind(tmp_path: Path) -> None:
    found = run(
        tmp_path / "s", [{"stiffness": 1e3, "duration": d} for d in (0.004, 0.002)], ["body_position_z[bob]"], timed_bob
    )
    name = "body_position_z[bob]"
    assert found[name].shape == (2, 5) and np.isnan(found[name][1, 3:]).all() and np.isfinite(found[name][1, :3]).all()
    with found.to_xarray() as data:  # the shorter has the first times of the longer
        assert data["time"].values.tolist() == pytest.approx([0.0, 1e-3, 2e-3, 3e-3, 4e-3])
        assert data["saved_steps"].values.tolist() == [5, 3]
    from warpffrf.study.sweeps.table import Table

    own = wf.study.sweep(
        lambda step: (bob(1e3), partial(wf.simulate, duration=0.004, step=step)), {"step": [1e-3, 2e-3]},
        progress=False, store=tmp_path / "t", outputs={"height": name, "end": fall},
    )  # fmt: skip
    assert own["time_of_run"].shape == (2, 5)
    for axis, words in (("time", "see 'time_of_run'"), ("end[0]", "did you mean 'end'")):
        for read in (own.__getitem__, own.about):
            with pytest.raises(InputError, match="does not exist") as told:
                read(axis)
            assert words in str(told.value)
    again = Table.read(tmp_path / "s" / "table.h5", 2)
    assert again.time is not None and np.isfinite(again.time).sum(axis=1).tolist() == [5, 3]


def test_equilibria_of_a_scene_file(tmp_path: Path) -> None:
    found = run(
        tmp_path / "s",
        {"spring.stiffness": STIFFNESS},
        {"z": "last(body_position_z[bob])"},
        scene_file(tmp_path),
        run=wf.equilibrium,
    )
    assert np.allclose(found["z"], [rest(k) for k in STIFFNESS], rtol=1e-9)  # equilibria are found to 1e-10
    assert found.definition["call"] == "equilibrium"


def test_a_file_and_a_function_give_the_same_bits(tmp_path: Path) -> None:
    name = "body_position_z[bob]"
    of_file = run(tmp_path / "f", {"spring.stiffness": STIFFNESS}, [name], scene_file(tmp_path))
    of_function = run(tmp_path / "g", {"stiffness": STIFFNESS}, [name])
    assert np.array_equal(of_file[name], of_function[name])


def test_a_file_that_is_edited_while_a_sweep_runs_is_the_one_that_was_read(tmp_path: Path) -> None:
    """The first row writes another gravity into it, as a user with an editor would; resume reports it."""
    file, z = scene_file(tmp_path), "last(body_position_z[bob])"
    text = file.read_text()

    def edited(result: Any) -> float:
        file.write_text(text.replace("-9.81", "-5.0"))
        return 0.0

    parameters, outputs = {"spring.stiffness": STIFFNESS}, {"z": z, "edit": edited}
    found = run(tmp_path / "s", parameters, outputs, file, run=wf.equilibrium)
    assert np.allclose(found["z"], [rest(k) for k in STIFFNESS], rtol=1e-9)  # equilibria are found to 1e-10
    with pytest.raises(InputError, match="the scene differs"):
        run(tmp_path / "s", parameters, outputs, file, run=wf.equilibrium, resume=True)


def test_rows_that_fail_are_rows_with_their_message(tmp_path: Path) -> None:
    found = run(tmp_path / "s", {"stiffness": [-1.0, 1000.0, 4000.0]}, ["max(energy[kinetic])"], shy_bob)
    assert found.counts == {"refused": 1, "completed": 1, "failed": 1} and found.status == "completed"
    refused, failed = found.failed()
    assert refused["run"] == 0 and "stiffness" in refused["message"]
    assert failed["stiffness"] == 4000.0 and failed["message"] == "ZeroDivisionError: far too stiff"
    assert np.isnan(found["max(energy[kinetic])"][[0, 2]]).all()
    assert "far too stiff" in found.report()


def test_a_first_row_that_fails_is_a_row_as_others_are(tmp_path: Path) -> None:
    found = run(tmp_path / "s", {"stiffness": [4000.0, 1000.0]}, scene=shy_bob)
    assert found.counts == {"failed": 1, "completed": 1}
    assert found.failed()[0]["message"] == "ZeroDivisionError: far too stiff"
    with pytest.raises(InputError, match="has no run options"):
        wf.study.sweep(bob, {"stiffness": [1e3]}, outputs=["energy[kinetic]"], store=tmp_path / "t", progress=False)


def test_an_argument_that_a_sweep_sets_is_refused_of_a_function(tmp_path: Path) -> None:
    def build(stiffness: float) -> Any:
        return bob(stiffness), partial(wf.simulate, progress=False)

    for worlds in (1, 2):
        with pytest.raises(InputError, match="simulate: progress is an argument of sweep; give it there"):
            run(tmp_path / "s", {"stiffness": STIFFNESS}, scene=build, worlds=worlds)


def test_options_of_the_sweep_prevail_over_those_of_a_file(tmp_path: Path) -> None:
    """Field by field: those at their default stay as the file has them."""
    file = scene_file(tmp_path)
    file.write_text(file.read_text() + 'save_every = 5\ndevice = "cpu"\n')
    name, parameters = "body_position_z[bob]", {"spring.stiffness": STIFFNESS}
    of_file = run(tmp_path / "t", parameters, [name], file, run=wf.simulate)
    assert of_file[name].shape == (3, 3) and set(of_file["device"]) == {"cpu"}
    given = partial(wf.simulate, options=wf.RunOptions(integrator=wf.integrators.HHT()))
    other = run(tmp_path / "u", parameters, [name], file, run=given)
    assert other[name].shape == (3, 3) and not np.array_equal(other[name], of_file[name])
    assert "save_every=5" in other.definition["options"]["options"] and "HHT" in other.definition["options"]["options"]


@pytest.mark.slow
def test_static_runs_also_as_worlds(tmp_path: Path) -> None:
    """Load steps of a hanging bob: its rest, in each world."""
    static = partial(wf.static, duration=1.0, step=0.5)
    for worlds in (1, 3):
        found = run(tmp_path / f"s{worlds}", {"stiffness": STIFFNESS}, run=static, worlds=worlds)
        assert np.allclose(found["last(body_position_z[bob])"], [rest(k) for k in STIFFNESS], rtol=1e-9)
        assert found["worlds"].tolist() == [worlds] * 3


def test_a_run_that_ends_early_keeps_its_status(tmp_path: Path) -> None:
    found = run(tmp_path / "s", {"stiffness": [1e3]}, ["energy[kinetic]", "error_budget"], bob)
    with found.to_xarray() as data:
        assert data["error_budget"].dims == ("run", "error_source") and "time step" in data["error_source"].values


def write_block(file: Path, length: float) -> None:
    """A mesh of two cells."""
    x, y, z = np.meshgrid([0.0, 0.5 * length, length], [0.0, 0.01], [0.0, 0.01], indexing="ij")
    corners = np.array([0, 4, 6, 2, 1, 5, 7, 3])
    points = np.stack([x, y, z], axis=-1).reshape(-1, 3)
    meshio.Mesh(points, [("hexahedron", np.stack([corners, corners + 4]))]).write(file)


def test_rows_of_a_file_share_their_bodies_and_no_more(tmp_path: Path) -> None:
    """Another load is the same body; another mesh, another material or a file that has changed is another one."""
    from warpffrf.scene_file.document import read_document
    from warpffrf.scene_file.load import scene_of_document
    from warpffrf.scene_file.object_cache import Kept

    write_block(tmp_path / "a.vtu", 0.1)
    file = tmp_path / "beam.toml"
    file.write_text(BEAM, encoding="utf-8")
    kept = Kept()

    def loaded(*settings: str) -> Any:
        return scene_of_document(read_document(file, settings), "beam", kept)

    def body(*settings: str) -> Any:
        return loaded(*settings).made["reduced_bodies"]["beam"]

    first = body()
    assert body("load=2.0") is first and loaded("load=2.0").document["meshes"]["beam"]["path"]
    assert body("density=7000.0") is not first and body("modes=2") is not first and body() is first
    write_block(tmp_path / "a.vtu", 0.2)
    other = body()
    assert other is not first and other.mass == pytest.approx(2.0 * first.mass)


# --- what is refused


@pytest.mark.parametrize(
    ("scene", "parameters", "outputs", "words"),
    [
        (bob, {"stifness": [1.0]}, ["energy[kinetic]"], "did you mean 'stiffness'"),
        ("file", {"spring.stifness": [1.0]}, ["energy[kinetic]"], "did you mean 'spring.stiffness'"),
        (bob, {"stiffness": [1e3]}, ["max(body_position_z[bub])"], "similar names: 'body_position_z[bob]'"),
        (bob, {"stiffness": [1e3]}, ["peak(body_position_z[bob])"], "over time 'peak' does not exist"),
        (bob, {"stiffness": [1e3]}, {"status": "energy[kinetic]"}, "is used in the table"),
        (bob, {"stiffness": "normal(1e3, 10)"}, ["energy[kinetic]"], "sample='latin:64'"),
        (bob, {"stiffness": "gauss(1e3, 10)"}, ["energy[kinetic]"], "known: 'normal'"),
        (bob, {"stiffness": "1:2"}, ["energy[kinetic]"], "1:2:5"),
        (bob, {"stiffness": [1.0, 1.0]}, ["energy[kinetic]"], "twice"),
        (bob, {}, ["energy[kinetic]"], "no parameter"),
        (bob, {"mass": [1.0]}, ["energy[kinetic]"], "stiffness"),
        (bob(1.0), {"stiffness": [1.0]}, ["energy[kinetic]"], "a Scene that is built has no parameters"),
    ],
)  # fmt: skip
def test_what_cannot_be_swept_is_named_with_the_cure(
    tmp_path: Path, scene: Any, parameters: Any, outputs: Any, words: str
) -> None:
    scene = scene_file(tmp_path) if scene == "file" else scene
    with pytest.raises(InputError) as told:
        run(tmp_path / "s", parameters, outputs, scene)
    assert words in str(told.value)


def test_axes_of_arrays_are_called_as_nothing_else(tmp_path: Path) -> None:
    """Of a function that is known before any row is run; of a field its row has failed, and the table can be read."""
    from warpffrf.study.sweeps.job import Answer, Value
    from warpffrf.study.sweeps.table import Table

    for parameters, more in (({"stiffness": [1e3]}, {"p[0]": "last(energy[kinetic])"}), ({"p[0]": [1.0]}, {})):
        with pytest.raises(InputError, match=r"'p\[0\]' is what an axis of output 'p' is called"):
            run(tmp_path / "s", parameters, {"p": fall, **more}, lambda **parameters: bob(1e3))
    table = Table.empty(["x", "mode"], [{"x": 1.0, "mode": 1}, {"x": 2.0, "mode": 1}])
    table.add(Answer(0, "completed", values={"modal": Value(np.ones(3), ("mode",))}))
    table.add(Answer(1, "completed", values={"modal": Value(np.ones(3), ("mode_bob",))}))
    table.write(tmp_path / "table.h5")
    read = Table.read(tmp_path / "table.h5", 2)
    assert read.texts["status"].tolist() == ["failed", "completed"] and "'mode'" in read.texts["message"][0]
    assert np.isnan(read.columns["modal"].array[0]).all() and read.columns["modal"].array[1].tolist() == [1, 1, 1]


def test_options_that_a_sweep_says_itself_are_refused(tmp_path: Path) -> None:
    cases: Any = (
        ({"run": partial(wf.simulate, results="a.h5")}, "files of single runs"),
        ({"run": partial(wf.simulate, progress=True)}, "argument of sweep"),
        ({"run": partial(wf.simulate, bob(1.0))}, "all arguments by name"),
        ({"run": wf.eigenmodes}, "run must be wf.simulate, wf.static or wf.equilibrium"),
        ({"workers": ["cpu", 0]}, "workers must be devices"),
        ({"workers": None}, "workers must be a number of processes"),
        ({}, "has no run options"),
    )
    for options, words in cases:
        with pytest.raises(InputError, match=words):
            wf.study.sweep(bob, {"stiffness": [1e3]}, outputs=["energy[kinetic]"], store=tmp_path / "s", **options)


# --- stores


def test_a_store_goes_on_where_it_stopped_and_no_other_sweep_goes_on_in_it(tmp_path: Path, monkeypatch: Any) -> None:
    """Three of four rows have been run when Ctrl-C comes; then the fourth is, and only that."""
    from warpffrf.study.sweeps.job import Job

    parameters, ran, answer = {"stiffness": [1e3, 2e3, 3e3, 4e3]}, [], Job.answer

    def counted(self: Any, number: int, row: Any, device: Any) -> Any:
        if len(ran) == 3:
            ran.append(None)
            raise KeyboardInterrupt
        ran.append(number)
        return answer(self, number, row, device)

    monkeypatch.setattr(Job, "answer", counted)
    store = tmp_path / "s"
    found = run(store, parameters)
    assert found.status == "unfinished" and found.counts == {"completed": 3, "": 1} and ran == [0, 1, 2, None]
    with pytest.raises(InputError, match="go on with it with resume=True"):
        run(store, parameters)
    for other, words in (
        ({"parameters": {"stiffness": [1e3, 2e3, 3e3, 5e3]}}, "values of the parameters differ"),
        ({"parameters": parameters, "outputs": ["energy[kinetic]"]}, "outputs"),
        ({"parameters": parameters, "scene": shy_bob}, "the scene differs"),
        ({"parameters": parameters, "scene": renamed(shy_bob, "bob")}, "the scene differs"),
    ):
        with pytest.raises(InputError, match="another sweep") as told:
            run(store, resume=True, **other)
        assert words in str(told.value)
    again = run(store, parameters, resume=True)
    assert again.status == "completed" and ran[4:] == [3]
    whole = run(tmp_path / "t", parameters)
    name = "last(body_position_z[bob])"
    assert np.array_equal(again[name], whole[name])
    assert run(store, {"stiffness": [1e3]}, overwrite=True).count == 1


def test_a_sweep_goes_on_with_a_row_that_lacks_what_others_had(tmp_path: Path, monkeypatch: Any) -> None:
    """The second row has no such body, and is a row with its message, whether the first was run just now or before."""
    from warpffrf.study.sweeps.job import Job

    answer = Job.answer

    def stopped(self: Any, number: int, row: Any, device: Any) -> Any:
        if number == 1:
            raise KeyboardInterrupt
        return answer(self, number, row, device)

    parameters, store = {"name": ["bob", "bub"]}, tmp_path / "s"
    with monkeypatch.context() as patch:
        patch.setattr(Job, "answer", stopped)
        assert run(store, parameters, scene=named_bob).counts == {"completed": 1, "": 1}
    again = run(store, parameters, scene=named_bob, resume=True)
    assert again.counts == {"completed": 1, "no quantity": 1}
    assert "body_position_z[bob]" in again["message"][1]


def test_outputs_of_two_arguments_have_the_parameters_of_their_row(tmp_path: Path) -> None:
    """Alone and as worlds; a second argument with a default is not asked for."""
    outputs = {
        "twice": lambda result, row: [2.0 * row["stiffness"], result.time[-1]],
        "own": lambda result, times=3.0: times * result.time[-1],
    }
    for worlds in (1, 2):
        found = run(tmp_path / f"{worlds}.sweep", {"stiffness": [1e3, 2e3]}, outputs, worlds=worlds)
        np.testing.assert_allclose(found["twice"], [[2e3, TIMES["duration"]], [4e3, TIMES["duration"]]])
        np.testing.assert_allclose(found["own"], 3.0 * TIMES["duration"])


def renamed(function: Any, name: str) -> Any:
    """A copy that is called otherwise."""
    import types

    copy = types.FunctionType(function.__code__, function.__globals__, name)
    copy.__module__ = function.__module__
    return copy


def test_a_function_is_distinguished_from_another_of_its_name() -> None:
    """By numbers, by names, by what it holds, and by functions within it; the same text is the same function, also in
    another process, where a set has another order."""
    import functools
    import os
    import subprocess
    import sys

    from warpffrf.study.sweeps.functions import word_of
    from warpffrf.study.sweeps.job import outputs_of

    def scaled(factor: float) -> Any:
        return lambda result: factor * result

    def made(text: str, name: str = "f") -> Any:
        found: dict[str, Any] = {}
        exec(text, found)
        return found[name]

    texts = [
        "def f(r): return r.max() * 2", "def f(r): return r.min() * 2", "def f(r): return r.max() * 3",
        "def f(r, n=1): return r.max() * 2", "def f(r, n=2): return r.max() * 2",
        "def f(r): return (lambda s: s + 1)(r)", "def f(r): return (lambda s: s + 2)(r)",
        "def f(r): return r in {'one', 'two', 'three'}",
    ]  # fmt: skip
    words = [word_of(made(text)) for text in texts] + [word_of(scaled(1.0)), word_of(scaled(2.0))]
    words += [word_of(functools.partial(rest, 1.0)), word_of(functools.partial(rest, 2.0))]
    assert len(set(words)) == len(words)
    assert words[: len(texts)] == [word_of(made(text)) for text in texts]
    told = [outputs_of({"p": made(text)}, ())["p"].text for text in texts[:2]]
    assert told == [f"f(), code {word}" for word in words[:2]]
    code = f"from warpffrf.study.sweeps.functions import word_of\n{texts[-1]}\nprint(word_of(f))"
    said = {
        subprocess.check_output([sys.executable, "-c", code], text=True, env={**os.environ, "PYTHONHASHSEED": seed})
        for seed in "12"
    }
    assert said == {words[len(texts) - 1] + "\n"}


def test_runs_that_a_kill_left_next_to_the_table_are_found(tmp_path: Path, monkeypatch: Any) -> None:
    """A kill leaves files of runs, one of them damaged; opening puts the whole ones into the table."""
    from warpffrf.study.sweeps.folder import Folder

    gather = Folder.gather
    monkeypatch.setattr(Folder, "gather", lambda self: None)
    store, name = tmp_path / "s", "last(body_position_z[bob])"
    run(store, {"stiffness": [1e3, 2e3, 3e3]})
    monkeypatch.setattr(Folder, "gather", gather)
    file = store / "runs" / "000001.arrays"
    file.write_bytes(file.read_bytes()[:-7])
    found = wf.study.open_sweep(store)
    assert found.counts == {"completed": 2, "": 1} and not list((store / "runs").iterdir())
    again = run(store, {"stiffness": [1e3, 2e3, 3e3]}, resume=True)
    assert again.status == "completed" and np.isfinite(again[name]).all()


def test_a_sweep_that_a_kill_ended_as_it_began_is_begun_again(tmp_path: Path, monkeypatch: Any) -> None:
    """Before it had written what it is, and then before its table; what others have in a folder stays."""
    from warpffrf.study.sweeps import folder

    class Killed(BaseException):
        """Nothing behind it is done."""

    def kill(*given: Any) -> Any:
        raise Killed

    store, parameters = tmp_path / "s", {"stiffness": [1e3, 2e3]}
    for owner, name, left in ((folder, "written_whole", {"lock", "runs"}), (folder.Table, "write", {"sweep.json"})):
        with monkeypatch.context() as patch:
            patch.setattr(owner, name, kill)
            with pytest.raises(Killed):
                run(store, parameters)
        assert {file.name for file in store.iterdir()} == {"lock", "runs"} | left
    (store / ".sweep.json.host.1.word.part").touch()
    assert run(store, parameters, resume=True).counts == {"completed": 2}
    (tmp_path / "t" / "runs").mkdir(parents=True)
    (tmp_path / "t" / "runs" / "mine.arrays").touch()
    with pytest.raises(InputError, match="other files"):
        run(tmp_path / "t", parameters, overwrite=True)


def test_what_is_no_store_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="no folder of a sweep"):
        wf.study.open_sweep(tmp_path)
    (tmp_path / "letter.txt").write_text("dear")
    with pytest.raises(InputError, match="other files"):
        run(tmp_path, {"stiffness": [1e3]})
    store = tmp_path / "s"
    run(store, {"stiffness": [1e3]})
    table = store / "table.h5"
    table.write_bytes(table.read_bytes().replace(b"completed", b"compleded"))
    with pytest.raises(InputError, match="damaged"):
        wf.study.open_sweep(store).counts  # noqa: B018
    (store / "sweep.json").write_text(json.dumps({"kind": "another"}))
    with pytest.raises(InputError, match="damaged, or of another program"):
        wf.study.open_sweep(store)


def test_a_table_that_somebody_else_has_sealed_is_read_with_care(tmp_path: Path) -> None:
    """A seal shows damage, not malice: what is missing, broken, or holds up the library is reported, whoever asks."""
    store = tmp_path / "s"
    run(store, {"stiffness": [1e3, 2e3]})
    table = store / "table.h5"
    whole = table.read_bytes()[: -TRAILER.size]

    def resealed(change: Any) -> None:
        table.unlink()  # another file, of which this process does not know that it has written it
        table.write_bytes(whole)
        with h5py.File(table, "r+") as file:
            change(file)
        seal(table)

    def raw(file: Any) -> None:
        del file["status"]
        file.create_dataset("status", data=np.zeros(2))

    def longer(file: Any) -> None:
        del file["stiffness"]
        file.create_dataset("stiffness", shape=(1 << 40,), dtype=float).attrs["parameter"] = "yes"

    def refused() -> list[str]:
        found, messages = wf.study.open_sweep(store), []
        for ask in (lambda: found.counts, lambda: found["stiffness"], found.failed, found.to_dataframe):
            try:
                ask()
            except InputError as error:
                messages.append(str(error))
        return messages

    for change in (lambda file: file.__delitem__("status"), raw, longer):
        resealed(change)
        assert refused() and all("sweep: " in message for message in refused())


def test_what_the_system_refuses_ends_a_sweep_with_what_to_do(tmp_path: Path, monkeypatch: Any) -> None:
    """A full disk, and a process that is to fork workers and was killed; the sweep goes on afterwards."""
    from warpffrf.study.sweeps import folder

    write, left = folder.write_arrays, [1]

    def full(*arguments: Any) -> None:
        if not left:
            raise OSError(errno.ENOSPC, "No space left on device")
        left.pop()
        write(*arguments)

    monkeypatch.setattr(folder, "write_arrays", full)
    with pytest.raises(InputError, match=r"No space left on device\); rows that have been run are kept.*resume=True"):
        run(tmp_path / "s", {"stiffness": [1e3, 2e3, 3e3]})
    monkeypatch.undo()
    assert run(tmp_path / "s", {"stiffness": [1e3, 2e3, 3e3]}, resume=True).counts == {"completed": 3}

    def killed(device: Any) -> Any:
        raise EOFError

    monkeypatch.setattr(executors, "_Worker", killed)
    with pytest.raises(InputError, match=r"EOFError\); rows that have been run are kept"):
        run(tmp_path / "t", {"stiffness": [1e3, 2e3]}, workers=2)


def test_bytes_of_a_table_are_verified_once(swept: Any, monkeypatch: Any) -> None:
    """Until the file is another one."""
    from warpffrf.study.sweeps import table

    table._whole.cache_clear()
    verified, verify = [], table.verify
    monkeypatch.setattr(table, "verify", lambda *given: verified.append(given) or verify(*given))
    assert swept.report() == wf.study.open_sweep(swept.path).report() and len(verified) == 1
    table.Table.read(swept.path / "table.h5", 6).write(swept.path / "table.h5")
    assert swept.counts == {"completed": 6} and len(verified) == 2


def test_two_sweeps_do_not_write_one_store(tmp_path: Path) -> None:
    from warpffrf.study.sweeps.folder import Folder

    store = tmp_path / "s"
    run(store, {"stiffness": [1e3]})
    holder = Folder(store)
    holder.hold()
    try:
        with pytest.raises(InputError, match="another process is writing"):
            run(store, {"stiffness": [1e3]}, resume=True)
    finally:
        holder.release()
    assert run(store, {"stiffness": [1e3]}, resume=True).status == "completed"
