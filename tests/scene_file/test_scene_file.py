"""Scene files: the same scene as from Python, every kind there is, errors with their line, and no other error ever."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import warpffrf as wf
from demos import two_rollers as demo
from warpffrf import cli
from warpffrf.scene_file import load_scene, run_scene
from warpffrf.scene_file.document import document_of, to_toml
from warpffrf.scene_file.forms import item_kinds
from warpffrf.scene_file.load import DOCUMENT_SIGN, scene_of
from warpffrf.scene_file.source import parse

DATA = Path(__file__).resolve().parents[1] / "data"
DEMO = wf.examples.path("two-rollers") / "two_rollers.toml"
COARSE = demo.Size(sectors=360, layers=8, axial=2)
COARSER = [f"meshes.roller.{name}={getattr(COARSE, name)}" for name in ("sectors", "layers", "axial")]

OSCILLATOR = """\
[parameters]
mass.value = 2.0
stiffness = 800.0

[bodies.block]
mass = "= mass.value"
inertia_tensor = [1, 1, 1]

[joints.guide]
kind = "prismatic"
a = "ground"
b = { body = "block", point = [0, 0, 0] }
axis = [0, 0, 1]

[forces.spring]
kind = "joint_spring_damper"
joint = "guide"
stiffness = "= stiffness"
reference = 0.01

[simulate]
duration = 0.02
step = 1e-3
"""


@pytest.fixture(scope="module")
def python_scene() -> wf.Scene:
    return demo.build(COARSE, progress=False)


def test_the_demo_is_the_same_scene_from_toml(python_scene: wf.Scene) -> None:
    loaded = load_scene(DEMO, settings=COARSER)
    assert loaded.scene.content_hash() == python_scene.content_hash()
    assert loaded.title == "two rollers"
    assert loaded.simulate is not None and (loaded.simulate["duration"], loaded.simulate["step"]) == (
        demo.DURATION,
        demo.STEP,
    )


def test_the_demo_gives_the_same_results_bit_for_bit(python_scene: wf.Scene, tmp_path: Path) -> None:
    short = [*COARSER, "simulate.duration=2e-3"]
    found = run_scene(DEMO, settings=short, out=tmp_path, progress=False)["simulate"]
    expected = wf.simulate(python_scene, 2e-3, step=demo.STEP, start="equilibrium", progress=False)
    assert found.status == expected.status == "completed"
    for name, array in expected.history.checkpoint.items():
        assert np.array_equal(found.history.checkpoint[name], array), name
    assert {p.name for p in tmp_path.iterdir()} == {f"two_rollers.{e}" for e in ("h5", "rrd", "toml")}
    # the file next to the results is the scene that was run: no includes, no parameters, the same scene again
    again = load_scene(tmp_path / "two_rollers.toml")
    assert again.scene.content_hash() == python_scene.content_hash()
    assert DOCUMENT_SIGN + again.to_toml() == (tmp_path / "two_rollers.toml").read_text(encoding="utf-8")


def test_what_is_left_out_has_the_defaults_of_python() -> None:
    text = OSCILLATOR.replace("reference = 0.01\n", "")
    scene = wf.Scene()
    block = scene.add_rigid_body(2.0, (1, 1, 1), name="block")
    guide = scene.add(wf.joints.Prismatic(scene.ground, block.at((0, 0, 0)), axis=(0, 0, 1), name="guide"))
    scene.add(wf.forces.JointSpringDamper(guide, 800.0, name="spring"))
    assert scene_of(text).scene.content_hash() == scene.content_hash()


def test_every_item_of_the_registries_has_a_kind() -> None:
    kinds = item_kinds()
    assert {"fixed", "revolute", "prismatic"} <= set(kinds["joints"])
    assert {"point_force", "spring_damper", "joint_spring_damper"} <= set(kinds["forces"])
    assert set(kinds["drives"]) == {"drive"} and set(kinds["contacts"]) == {"contact"}
    for module, section in ((wf.joints, "joints"), (wf.forces, "forces")):
        public = {
            cls.kind
            for cls in vars(module).values()
            if isinstance(cls, type) and getattr(cls, "scene_list", 0) == section
        }
        assert set(kinds[section]) == public - {"joint", ""}


def test_every_joint_can_be_written() -> None:
    extra = {"axis": "axis = [0, 0, 1]", "second_axis": "second_axis = [1, 0, 0]", "line": "line = [1, 0, 0]"}
    for kind, form in item_kinds()["joints"].items():
        lines = [extra[name] for name in form.roles if name in extra]
        text = "[bodies.block]\nmass = 1.0\ninertia_tensor = [1, 1, 1]\n" + "\n".join(
            [
                "[joints.one]",
                f'kind = "{kind}"',
                'a = { body = "ground", point = [0, 0, 0.1] }',
                'b = { body = "block", point = [0, 0, 0.1] }',
                *lines,
            ]
        )
        assert scene_of(text).scene.joint("one").kind == kind


# --- names, settings, includes


def test_settings_keep_the_type() -> None:
    def force(*changes: str) -> wf.forces.JointSpringDamper:
        return scene_of(OSCILLATOR, settings=changes).scene.forces[0]

    assert force("stiffness=900").stiffness == 900.0
    assert force("parameters.stiffness=900").stiffness == 900.0
    assert force("forces.spring.stiffness=5").stiffness == 5.0
    assert force("forces.spring.damping=3").damping == 3.0  # not in the file, but known
    assert scene_of(OSCILLATOR, settings=["mass.value=3"]).scene.body("block").mass == 3.0
    assert scene_of(OSCILLATOR, settings=["stiffness== 2 * mass.value"]).scene.forces[0].stiffness == 4.0
    for change, said in [
        ("stiffness=soft", "'soft' is not a number"),
        ("stiffness=true", "'true' is not a number"),
        ("mass.valu=3", "did you mean 'mass.value'"),
        ("simulate.stepp=1e-4", "unknown key 'stepp'; did you mean 'step'?"),
        ("bodies.block.inertia_tensor=3", "is not a list"),
        ("stiffness", "write --set NAME=VALUE"),
        ("a b=3", "is not a dotted name"),
    ]:
        with pytest.raises(wf.InputError, match=re.escape(said)) as caught:
            scene_of(OSCILLATOR, settings=[change])
        assert str(caught.value).startswith(f"--set {change}: ")


def test_expressions() -> None:
    def value(text: str, **parameters: str) -> object:
        lines = "".join(f"{k} = {v}\n" for k, v in parameters.items())
        return document_of(f"title = {text!r}\n[parameters]\n{lines}", DATA).values["title"]

    assert value("= -2 * (a + 3) ** 2 / 4", a="1") == -8.0
    assert value("= sin(pi / 6) + max(1, b)", b='"= 2 * c"', c="2.5") == pytest.approx(5.5)
    assert value("= name", name="'steel'") == "steel" and value("= list", list="[1, 2]") == [1, 2]
    for text, said in [
        ("= a", "there is no parameter 'a'"),
        ("= 1 / 0", "division by zero"),
        ("= open('x')", "function 'open' does not exist"),
        ("= 'x' * 3", "not supported"),
        ("= (1).__class__", "there is no parameter"),
        ("= 9.0 ** 9999", "cannot be evaluated"),
        ("= (-1) ** 0.5", "is not a real number"),
        ("= " + "(" * 300, "is not an expression"),
        ("= 1 +", "is not an expression"),
    ]:
        with pytest.raises(wf.InputError, match=re.escape(said)):
            value(text)
    with pytest.raises(wf.InputError, match="depends on itself"):
        value("= a", a="'= b'", b="'= a'")


def test_includes_stand_below_the_file_that_includes(tmp_path: Path) -> None:
    (tmp_path / "parts").mkdir()
    (tmp_path / "parts" / "base.toml").write_text(OSCILLATOR, encoding="utf-8")
    top = tmp_path / "top.toml"
    top.write_text('include = ["parts/base.toml"]\n[parameters]\nstiffness = 1.0\n', encoding="utf-8")
    assert load_scene(top).scene.forces[0].stiffness == 1.0
    top.write_text('include = ["parts/base.toml"]\n\n[forces.spring]\nkind = "spring_damper"\n', encoding="utf-8")
    with pytest.raises(wf.InputError, match=r"^top.toml:3: \[forces.spring\]: the key 'a' is missing"):
        load_scene(top)  # another kind is another force: nothing of the old one is left
    base = (tmp_path / "parts" / "base.toml").read_text(encoding="utf-8").replace("reference", "referenz")
    (tmp_path / "parts" / "base.toml").write_text(base, encoding="utf-8")
    top.write_text('include = ["parts/base.toml"]\n', encoding="utf-8")
    line = base.splitlines().index("referenz = 0.01") + 1
    with pytest.raises(wf.InputError, match=rf"^parts/base.toml:{line}: .*did you mean 'reference'\?"):
        load_scene(top)
    top.write_text('include = ["top.toml"]\n', encoding="utf-8")
    with pytest.raises(wf.InputError, match="^top.toml:1: include 'top.toml' includes itself"):
        load_scene(top)
    top.write_text('include = ["none.toml"]\n', encoding="utf-8")
    with pytest.raises(wf.InputError, match="^top.toml:1: include 'none.toml' does not exist; it is searched in"):
        load_scene(top)
    top.write_text('include = ["parts/bas.toml"]\n', encoding="utf-8")
    with pytest.raises(wf.InputError, match="include 'parts/bas.toml' does not exist; did you mean 'base.toml'. it is"):
        load_scene(top)


def test_numbers_come_from_files_next_to_the_scene(tmp_path: Path) -> None:
    (tmp_path / "load.csv").write_text("# s, N\n0.0, 0.0\n0.5, 3.5\n1.0, 7.0\n", encoding="utf-8")
    np.save(tmp_path / "times.npy", [0.0, 0.5, 1.0])
    text = OSCILLATOR + (
        '[signals.load]\nkind = "table"\ntimes = { file = "times.npy" }\n'
        'values = { file = "load.csv", column = 1 }\n'
        '[forces.push]\nkind = "point_force"\nport = { body = "block", point = [0, 0, 0] }\nforce = [0, 0, "load"]\n'
    )
    (tmp_path / "scene.toml").write_text(text, encoding="utf-8")
    force = load_scene(tmp_path / "scene.toml").scene.forces[-1]
    assert force.components[2](0.75) == pytest.approx(5.25)
    moved = tmp_path / "elsewhere.toml"
    moved.write_text(load_scene(tmp_path / "scene.toml").to_toml(), encoding="utf-8")
    assert load_scene(moved).scene.content_hash() == load_scene(tmp_path / "scene.toml").scene.content_hash()
    scaled = text.replace("column = 1", 'column = 1, factor = "= 2 * 1e3"')
    moved.write_text(scaled.replace('times.npy" }', 'times.npy" }\nperiod = 1.25\nduration = 5.0'), encoding="utf-8")
    load = load_scene(moved).scene.forces[-1].components[2]
    assert load(0.75) == pytest.approx(5.25 * 2e3) == load(0.75 + 2.5) and load(1.125) == pytest.approx(3.5 * 2e3)
    for wrong, said in [
        ("column = 2", "column 2 does not exist"), ("column = -1", "whole number from 0"),
        ('column = 1, factor = "kN"', "factor must be a number"),
    ]:  # fmt: skip
        (tmp_path / "scene.toml").write_text(text.replace("column = 1", wrong), encoding="utf-8")
        with pytest.raises(wf.InputError, match=f"^scene.toml:.*{said}"):
            load_scene(tmp_path / "scene.toml")


# --- errors

WRONG = [
    ('a = "ground"', 'a = "grund"', "there is no body 'grund'; did you mean 'ground'?"),
    ("axis = [0, 0, 1]", "axis = [0, 0, 0]", "joint 'guide': axis has zero length"),
    ("axis = [0, 0, 1]", "axes = [0, 0, 1]", "unknown key 'axes'; did you mean 'axis'?"),
    ("axis = [0, 0, 1]", "axis = [0, 0, 'x']", "names no signal and no port"),
    ('joint = "guide"', 'joint = "guid"', "there is no 'guid' in [joints]; did you mean 'guide'?"),
    ('kind = "prismatic"', 'kind = "prism"', "there is no kind 'prism'; did you mean 'prismatic'?"),
    ("step = 1e-3", 'step = "fine"', "step must be a number, got 'fine'"),
    ("step = 1e-3", "save_every = 2.5\nstep = 1e-3", "save_every must be a whole number, got 2.5"),
    ("reference = 0.01", "reference = true", "reference must be a number, got True"),
    ("reference = 0.01", "reference = nan", "reference must be finite"),
    ("inertia_tensor = [1, 1, 1]", "inertia_tensor = [1, 1, 3]", "are impossible"),
    ("inertia_tensor = [1, 1, 1]", "inertia_tensor = 2024-01-01", "is a date or time"),
    ("inertia_tensor = [1, 1, 1]", "inertia_tensor = [1, 99999999999999999999, 1]", "more than 64 bits"),
    ('stiffness = "= stiffness"', 'stiffness = "= stifness"', "no parameter 'stifness'; did you mean 'stiffness'?"),
    ("stiffness = 800.0", 'stiffness = "= 1 +"', "is not an expression"),
    ("[simulate]", "[simulat]", "unknown key 'simulat'; did you mean 'simulate'?"),
    ("[bodies.block]", "[bodies.block", "invalid TOML"),
    ("mass.value = 2.0", "mass.value = ", "invalid TOML"),
]


@pytest.mark.parametrize("old, new, said", WRONG, ids=[w[2][:30] for w in WRONG])
def test_errors_name_the_line_and_the_cure(old: str, new: str, said: str) -> None:
    text = OSCILLATOR.replace(old, new, 1)
    line = text[: text.index(new)].count("\n") + 1
    with pytest.raises(wf.InputError, match=re.escape(said)) as caught:
        scene_of(text)
    assert str(caught.value).startswith(f"scene.toml:{line}: "), caught.value
    assert "\n" not in str(caught.value)


def test_a_missing_key_is_reported_at_its_table() -> None:
    text = OSCILLATOR.replace("inertia_tensor = [1, 1, 1]\n", "")
    with pytest.raises(wf.InputError, match=r"^scene.toml:5: \[bodies.block\]: the key 'inertia_tensor' is missing"):
        scene_of(text)


def test_errors_of_calls_name_the_line(tmp_path: Path) -> None:
    wrong = [
        ("reduced_bodies.roller.interfaces={bor='rigid'}", "set 'bor'"),
        ("joints.axle.b='lower.bor'", "'bor' does not exist"),
        ("reduced_bodies.roller.mesh='rollers'", "did you mean 'roller'?"),
        ("reduced_bodies.roller.contact={rim='conus'}", "no surface 'conus'; did you mean 'cone'?"),
        ("materials.steel.poisson_ratio=0.5", "poisson_ratio must lie between"),
        ("simulate.duration=1e-5", "longer than the duration"),
    ]
    for setting, said in wrong:
        with pytest.raises(wf.InputError, match=re.escape(said)) as caught:
            run_scene(DEMO, settings=[*COARSER, setting], out=tmp_path)
        assert str(caught.value).startswith(f"--set {setting}: "), caught.value


# --- positions


def test_positions_are_right_in_the_whole_grammar() -> None:
    text = (
        '# comment [x]\n"quoted key".b . c = """\nmany\n[lines] = 3\n"""\n[a.b]\nx = [1, # one\n  [2, 3],\n  "]"]\n'
        "y = {p = 1, q.r = '}'}\n[[list]]\nv = 1979-05-27\n[[list]]\n[list.sub]\nz = '''\n'\n''''\nw = 1\n"
    )
    text = text.replace("1979-05-27", "1.5")
    places = {path: int(str(place).split(":")[1]) for path, place in parse(text, "t", DATA).places.items() if path}
    assert places[("quoted key", "b", "c")] == 2 and places[("a", "b")] == 6
    assert places[("a", "b", "x", 0)] == 7 and places[("a", "b", "x", 1)] == 8 and places[("a", "b", "x", 1, 1)] == 8
    assert places[("a", "b", "x", 2)] == 9 and places[("a", "b", "y", "q", "r")] == 10
    assert places[("list", 0, "v")] == 12 and places[("list", 1)] == 13
    assert places[("list", 1, "sub", "z")] == 15 and places[("list", 1, "sub", "w")] == 18


KEYS = st.text(min_size=1, max_size=5)
VALUES = st.recursive(
    st.booleans()
    | st.integers(-(2**63) + 1, 2**63 - 1)
    | st.floats(allow_nan=False)
    | st.text(max_size=8).filter(lambda s: not s.startswith("=")),
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(KEYS, inner, max_size=3),
    max_leaves=12,
)
TABLES = st.dictionaries(KEYS.filter(lambda k: k not in ("include", "parameters")), VALUES, max_size=4)


@given(TABLES)
@settings(deadline=None, max_examples=100)
def test_text_and_back(values: dict) -> None:
    source = parse(to_toml(values), "t", DATA)
    assert source.values == values

    def paths(value: object, path: tuple) -> list[tuple]:
        entries = value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ()
        return [path, *(p for key, entry in entries for p in paths(entry, (*path, key)))]

    assert set(source.places) == set(paths(values, ()))  # every key has a place, and nothing else has


# --- fuzzing: garbled files end in InputError or in a scene, never in anything else


def _lines_or_scene(text: str) -> None:
    try:
        scene_of(text)
    except wf.InputError as error:
        assert str(error)


@given(st.data())
@settings(deadline=None, max_examples=150)
def test_garbled_text_gives_only_input_errors(data: st.DataObject) -> None:
    text = OSCILLATOR
    for _ in range(data.draw(st.integers(1, 4))):
        at = data.draw(st.integers(0, len(text)))
        end = data.draw(st.integers(at, min(at + 12, len(text))))
        piece = data.draw(
            st.text(max_size=6) | st.sampled_from(["[", "]]", "{", '"', "'''", "=", ".", "\n", "nan", "= ("])
        )
        text = text[:at] + piece + text[end:]
    _lines_or_scene(text)


@given(st.data())
@settings(deadline=None, max_examples=150)
def test_odd_values_give_only_input_errors(data: st.DataObject) -> None:
    values = parse(OSCILLATOR, "t", DATA).values
    for _ in range(data.draw(st.integers(1, 3))):
        table = values
        while True:
            key = data.draw(st.sampled_from(sorted(table)))
            if not isinstance(table[key], dict) or not table[key] or data.draw(st.integers(0, 4)) == 0:
                break
            table = table[key]
        table[key] = data.draw(
            VALUES | st.sampled_from(["ground", "block", "= mass.value", {"kind": "ramp"}, {"file": "x"}])
        )
    _lines_or_scene(to_toml(values))


@given(st.binary(max_size=60))
@settings(deadline=None, max_examples=50)
def test_bytes_give_only_input_errors(tmp_path_factory: pytest.TempPathFactory, content: bytes) -> None:
    file = tmp_path_factory.getbasetemp() / "bytes.toml"
    file.write_bytes(content)
    try:
        load_scene(file)
    except wf.InputError:
        pass


@given(st.text(max_size=20))
@settings(deadline=None, max_examples=100)
def test_odd_settings_give_only_input_errors(setting: str) -> None:
    for text in (setting, f"stiffness={setting}", f"{setting}=1", f"joints.guide.axis={setting}"):
        try:
            scene_of(OSCILLATOR, settings=[text])
        except wf.InputError:
            pass


# --- the command


def test_the_command_runs_a_scene(tmp_path: Path, capsys: pytest.CaptureFixture) -> None:
    file = tmp_path / "oscillator.toml"
    file.write_text(OSCILLATOR, encoding="utf-8")
    out = tmp_path / "out"
    assert cli.main(["run", str(file), "--set", "simulate.duration=5e-3", "--out", str(out)]) == 0
    assert "status" in capsys.readouterr().out
    assert len(wf.Result.load(out / "oscillator.h5").time) == 6
    assert cli.main(["-q", "run", str(file), "--check"]) == 0
    assert "block" in capsys.readouterr().out
    for arguments, said in [
        ([str(tmp_path / "none.toml")], "does not exist"),
        ([str(file), "--set", "stiffnes=1"], "did you mean 'stiffness'"),
        ([str(file), "--set", "forces.spring.stiffness=-1"], "stiffness must not be negative"),
    ]:
        assert cli.main(["-q", "run", *arguments]) == 1
        error = capsys.readouterr().err
        assert error.startswith("error: ") and said in error and len(error.strip().splitlines()) == 1


def test_a_file_without_a_run_says_so(tmp_path: Path) -> None:
    file = tmp_path / "still.toml"
    file.write_text(OSCILLATOR[: OSCILLATOR.index("[simulate]")], encoding="utf-8")
    with pytest.raises(wf.InputError, match=r"add the table \[simulate\], \[static\] or \[equilibrium\]"):
        run_scene(file, out=tmp_path)


STAGES = """\
[[simulate.stages]]
name = "soft"
duration = 4e-3
step = 1e-3

[[simulate.stages]]
name = "hard"
duration = 4e-3
step = 5e-4
overrides = { save_every = 2, gravity = [0, 0, -9.81], forces = { spring = { stiffness = 2000.0 } } }
"""


def test_stages_from_a_file(tmp_path: Path) -> None:
    text = OSCILLATOR[: OSCILLATOR.index("[simulate]")] + STAGES
    (tmp_path / "staged.toml").write_text(text, encoding="utf-8")
    result = run_scene(tmp_path / "staged.toml", out=tmp_path / "out", progress=False)["simulate"]
    assert result.status == "completed" and result.time == pytest.approx([n * 1e-3 for n in range(9)])
    assert {"staged.h5", "staged.soft.h5", "staged.hard.h5"} <= {p.name for p in (tmp_path / "out").iterdir()}
    for old, new, said in [
        ("stiffness = 2000.0", "stifness = 2000.0", "did you mean 'stiffness'"),
        ("spring = {", "sprnig = {", "there is no 'sprnig' in [forces]; did you mean 'spring'?"),
        ("save_every", "save_evry", "override 'save_evry' does not exist"),
    ]:
        wrong = text.replace(old, new, 1)
        line = wrong[: wrong.index(new)].count("\n") + 1
        with pytest.raises(wf.InputError, match=re.escape(said)) as caught:
            scene_of(wrong)
        assert str(caught.value).startswith(f"scene.toml:{line}: "), caught.value


def test_files_of_other_runs_stay(tmp_path: Path) -> None:
    """A run into a folder replaces nothing unasked, and another scene never."""
    file, folder = tmp_path / "oscillator.toml", tmp_path / "out"
    file.write_text(OSCILLATOR, encoding="utf-8")
    first = run_scene(file, out=folder, progress=False)["simulate"]
    for changed in ((), ("simulate.step=2e-3",)):
        with pytest.raises(wf.InputError, match="exists; choose another name, or replace it with .*--overwrite"):
            run_scene(file, settings=changed, out=folder, progress=False)
    with pytest.raises(wf.InputError, match="--resume: .* differs from the one to be run"):
        run_scene(file, settings=("simulate.step=2e-3",), out=folder, resume=True, progress=False)
    again = run_scene(file, out=folder, resume=True, progress=False)["simulate"]
    assert np.array_equal(again.time, first.time)
    run_scene(file, settings=("simulate.step=2e-3",), out=folder, overwrite=True, progress=False)
    (folder / "oscillator.toml").write_text("# of warpffrf, by hand\n", encoding="utf-8")
    with pytest.raises(wf.InputError, match="is another scene, and is not replaced"):
        run_scene(file, out=folder, overwrite=True, progress=False)


def test_a_series_runs_over_the_angle_of_another_signal(tmp_path: Path) -> None:
    (tmp_path / "shake.toml").write_text(
        """
[signals.turn]
kind = "ramp"
start_value = 0
end_value = 10.0
duration = 0.1
[signals.shake]
kind = "harmonics"
cosines = [1.0, 2.0]
angle = "turn"
duration = 0.1
[bodies.bob]
mass = 2.0
inertia_tensor = [0.01, 0.01, 0.01]
[forces.push]
kind = "point_force"
port = { body = "bob", point = [0, 0, 0] }
force = ["shake", 0, 0]
"""
    )
    (push,) = wf.load_scene(tmp_path / "shake.toml").scene.forces
    shake = push.load().components[0]
    assert float(shake(0.03)) == pytest.approx(np.cos(3.0) + 2.0 * np.cos(6.0), abs=1e-8)
