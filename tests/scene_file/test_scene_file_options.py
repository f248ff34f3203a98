"""Options of bodies and runs in scene files: damping, inertia, stiffening, integrators, local modes."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

import warpffrf as wf
from warpffrf.online import INTEGRATORS
from warpffrf.scene_file.load import scene_of

BEAM = """\
[materials.alloy]
youngs_modulus = 70e9
poisson_ratio = 0.3
density = 2700

[meshes.beam]
kind = "box"
size = [0.5, 0.02, 0.02]
counts = [6, 1, 1]

[reduced_bodies.beam]
mesh = "beam"
material = "alloy"
interfaces = { x_min = "rigid" }
modes = 6
stiffening = true
inertia_modes = 5
cache = false

[bodies.beam]
body = "beam"
inertia = "gyroscopic"
stiffening = true
damping = "1/10/100"
angular_velocity = [0, 0, 30]
velocity = [0, 7.5, 0]

[joints.hub]
kind = "revolute"
a = "ground"
b = "beam.x_min"
axis = [0, 0, 1]
"""
BLOCK = """\
[bodies.block]
mass = 2.0
inertia_tensor = [1, 1, 1]

"""
RUN = """\
[simulate]
duration = 0.02
step = 1e-3
"""
LOCAL = '{ kind = "local_modes", treatment = "hht", max_frequency = 60e3 }'


def test_a_turning_flexible_body_with_its_options() -> None:
    """Damping, inertia level and stiffening from TOML are those of the same calls in Python."""
    mesh = wf.mesh.box((0.5, 0.02, 0.02), (6, 1, 1))
    beam = wf.reduce(
        mesh, wf.Material(70e9, 0.3, 2700.0), interfaces={"x_min": "rigid"}, modes=6,
        options=wf.ReductionOptions(stiffening=True, inertia_modes=5), cache=False, progress=False,
    )  # fmt: skip
    scene = wf.Scene()
    body = scene.add_body(
        beam, name="beam", inertia="gyroscopic", stiffening=True, damping="1/10/100", angular_velocity=(0, 0, 30),
        velocity=(0, 7.5, 0),
    )  # fmt: skip
    scene.add(wf.joints.Revolute(scene.ground, body["x_min"], axis=(0, 0, 1), name="hub"))
    assert scene_of(BEAM).scene.content_hash() == scene.content_hash()
    bands = '{ kind = "damping_bands", bands = [[100, 0.01], [1e3, 0.1], [inf, 1.0]] }'
    damping = scene_of(BEAM.replace('"1/10/100"', bands)).scene.body("beam").damping
    assert damping == pytest.approx(body.damping)
    _refused(BEAM.replace('"gyroscopic"', '"gyroscopc"'), "gyroscopc", "known: 'constant', 'deformed', 'gyroscopic'")


def test_membrane_energy() -> None:
    """`stiffening = "membrane"` and `membrane_modes` of a reduced body are those of the same call in Python, and what
    is wrong about them is refused with the same cure."""
    wanted = 'stiffening = "membrane"\nmembrane_modes = 3\ninertia_modes = 5'
    text = BEAM.replace("stiffening = true\ninertia_modes = 5", wanted)
    mesh = wf.mesh.box((0.5, 0.02, 0.02), (6, 1, 1))
    beam = wf.reduce(
        mesh, wf.Material(70e9, 0.3, 2700.0), interfaces={"x_min": "rigid"}, modes=6,
        options=wf.ReductionOptions(stiffening="membrane", membrane_modes=3, inertia_modes=5), cache=False,
        progress=False,
    )  # fmt: skip
    found = scene_of(text).scene.body("beam")
    assert found.stiffening and found.reduced.content_hash() == beam.content_hash()
    assert found.reduced.report["inertia"]["membrane"]["modes"] == 3
    without = BEAM.replace("inertia_modes = 5", "membrane_modes = 3\ninertia_modes = 5")
    kind = '"membrane"'
    for wrong, at, said in (
        (without, "membrane_modes", "membrane_modes is a number of modes of stiffening='membrane'; set that, too"),
        (text.replace("modes = 3", "modes = 0"), "membrane_modes", "a membrane basis without bending modes"),
        (text.replace("modes = 3", "modes = 9"), "membrane_modes", "membrane_modes=9, of a body with 6 modes"),
        (text.replace('"membrane"', '"plate"'), "stiffening", "or 'membrane', got 'plate'"),
        (text.replace("stiffening = true", f"stiffening = {kind}"), f"stiffening = {kind}\ndamping", "stiffening"),
    ):
        _refused(wrong, at, said)


def test_every_integrator_can_be_written() -> None:
    for kind, cls in INTEGRATORS.items():
        assert _options(f'integrator = {{ kind = "{kind}" }}')["options"].integrator == cls()
    found = _options('integrator = { kind = "hht", alpha = -0.2, project_velocities = true }')
    assert found["options"].integrator == wf.integrators.HHT(-0.2, project_velocities=True)
    _refused(BLOCK + RUN + 'integrator = { kind = "hht", alpha = 0.2 }', "alpha", "alpha must lie between -1/3 and 0")


def test_accuracy_and_start() -> None:
    found = _options("step_error = 1e-6\nproject_start = true")
    assert found["options"] == wf.RunOptions(step_error=1e-6, project_start=True)
    _refused(BLOCK + RUN + "project_start = 1", "project_start", "must be true or false")


def test_treatments_of_local_modes_can_be_written() -> None:
    expected = wf.LocalModes("hht", max_frequency=60e3)
    assert _options('local_modes = "auto"')["options"].local_modes == "auto"
    assert _options(f"local_modes = {LOCAL}")["options"].local_modes == expected
    stage = (
        f'[[simulate.stages]]\nname = "one"\nduration = 1e-2\nstep = 1e-3\noverrides = {{ local_modes = {LOCAL} }}\n'
    )
    staged = scene_of(BLOCK + stage).simulate
    assert staged is not None and staged["duration"][0].options["local_modes"] == expected
    for wrong, said in (
        ('{ kind = "local_modes", treatment = "htt" }', "known: 'quasi_static', 'hht'"),
        ('{ kind = "local_modes", frequency = 6e4 }', "unknown key 'frequency'"),
        ('{ kind = "local_mode" }', "did you mean 'local_modes'"),
    ):
        _refused(BLOCK + RUN + f"local_modes = {wrong}", "local_modes =", said)


def _options(line: str) -> dict:
    """Arguments of `simulate` with a further line."""
    options = scene_of(BLOCK + RUN + line + "\n").simulate
    assert options is not None
    return options


def _refused(text: str, at: str, said: str) -> None:
    """`text` is refused with the words `said` and the line where `at` first stands."""
    with pytest.raises(wf.InputError, match=re.escape(said)) as caught:
        scene_of(text)
    line = text[: text.index(at)].count("\n") + 1
    assert str(caught.value).startswith(f"scene.toml:{line}: "), caught.value


MOUNT = """\
[bodies.block]
mass = 2.0
inertia_tensor = [1, 1, 1]
position = [1, 0, 0]

[forces.spring]
kind = "spring_damper"
a = { body = "ground", point = [0, 0, 0] }
b = { body = "block", point = [0, 0, 0] }
stiffness = { kind = "force_polynomial", coefficients = [800, 0, 4e5] }
damping = { kind = "force_table", points = [[-1, -20], [0, 0], [1, 60]] }

[forces.mount]
kind = "bushing"
a = "ground"
b = { body = "block", point = [0, 0, 0] }
stiffness = [{ kind = "power_law", coefficient = 1e4, exponent = 1.5 }, 200, 200, 5, 5, 5]
"""


def test_characteristics_of_springs_and_dampers(tmp_path: Path) -> None:
    scene = wf.Scene()
    block = scene.add_rigid_body(2.0, (1, 1, 1), name="block", position=(1, 0, 0))
    ports = scene.ground.at((0, 0, 0)), block.at((0, 0, 0))
    table = wf.forces.ForceTable([(-1, -20), (0, 0), (1, 60)])
    scene.add(wf.forces.SpringDamper(*ports, wf.forces.ForcePolynomial([800, 0, 4e5]), table, name="spring"))
    stiffness = [wf.forces.PowerLaw(1e4, 1.5), 200, 200, 5, 5, 5]
    scene.add(wf.forces.Bushing(scene.ground, ports[1], stiffness, name="mount"))
    assert scene_of(MOUNT).scene.content_hash() == scene.content_hash()
    (tmp_path / "damper.csv").write_text("-1, -20\n0, 0\n1, 60\n", encoding="utf-8")
    (tmp_path / "mount.toml").write_text(
        MOUNT.replace("[[-1, -20], [0, 0], [1, 60]]", '{ file = "damper.csv" }'), encoding="utf-8"
    )
    assert wf.load_scene(tmp_path / "mount.toml").scene.content_hash() == scene.content_hash()
    for old, new, line, message in (
        ("[1, 60]", "[-1, 60]", "damping", "is not monotonic"),
        ('{ kind = "force_polynomial", coefficients = [800, 0, 4e5] }', '"soft"', "stiffness", "a number, got 'soft'"),
        ("force_table", "force_tabel", "force_tabel", "did you mean 'force_table'"),
        ("exponent = 1.5", "exponent = 0.5", "exponent", "at least 1, got 0.5"),
    ):
        _refused(MOUNT.replace(old, new), line, message)


def test_static_runs_and_stages_can_be_written(tmp_path: Path) -> None:
    """A block on a spring that is pushed: 5 N over 1000 N/m, and left there in time."""
    machine = BLOCK + (
        '[joints.rail]\nkind = "prismatic"\na = { body = "ground", point = [0, 0, 0] }\n'
        'b = { body = "block", point = [0, 0, 0] }\naxis = [1, 0, 0]\n'
        '[forces.spring]\nkind = "joint_spring_damper"\njoint = "rail"\nstiffness = 1000.0\n'
        '[forces.push]\nkind = "point_force"\nport = { body = "block", point = [0, 0, 0] }\n'
        'force = [{ kind = "ramp", start_value = 0.0, end_value = 5.0, duration = 1.0 }, 0, 0]\n'
    )
    static = "duration = 1.0\nstep = 0.25\n"
    stages = f'[[simulate.stages]]\nname = "push"\nkind = "static"\n{static}'
    stages += '[[simulate.stages]]\nname = "wait"\nduration = 0.01\nstep = 1e-3\n'
    for call, text, rows in (("static", f"[static]\n{static}", 5), ("simulate", stages, 15)):
        file = tmp_path / f"run{rows}.toml"
        file.write_text(machine + text)
        result = wf.run_scene(file, out=tmp_path / "out", progress=False)[call]
        assert result.status == "completed", result.message
        assert (
            len(result.time) == rows
            and (tmp_path / "out" / f"{file.stem}{'' if call == 'simulate' else '_static'}.h5").exists()
        )
        x = result.history.joints["rail"].coordinate
        assert x[:5] == pytest.approx([0.0, 1.25e-3, 2.5e-3, 3.75e-3, 5e-3], abs=1e-11)
        assert x[4:] == pytest.approx(5e-3, abs=1e-9)


def test_keys_of_before_name_the_new_ones() -> None:
    for line, said in (
        ('kind = "static"', "the table [static]"),
        ('local = "hht"', "it is called 'local_modes' now"),
        ("record_every = 3", "warpffrf view"),
    ):
        _refused(BLOCK + RUN + line, line, said)
    _refused(
        BLOCK + RUN.replace("[simulate]", "[static]") + "step_error = 1e-6", "step_error", "unknown key 'step_error'"
    )
    stage = '[simulate]\nduration = 1.0\n[[simulate.stages]]\nname = "one"\nduration = 1.0\nstep = 0.1\n'
    _refused(BLOCK + stage, "duration", "stages have their own duration")
