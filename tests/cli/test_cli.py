"""The command line: help, one-line errors with their exit codes, and the mesh -> reduced body -> info path."""

from __future__ import annotations

import signal
import subprocess
import sys
import textwrap
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

import warpffrf as wf
from warpffrf import cli
from warpffrf.cli import describe
from warpffrf.cli.errors import in_options

DATA = Path(__file__).resolve().parents[1] / "data"
STEEL = ["--youngs-modulus", "210e9", "--poisson-ratio", "0.3", "--density", "7850"]
FACET_LOSS = (
    5e-3  # the quadratic tetrahedra follow the circle in parabolas: measured mass 2e-5 off, left room for others
)
OSCILLATOR = """\
[bodies.block]
mass = 2.0
inertia_tensor = [1, 1, 1]

[joints.guide]
kind = "prismatic"
a = "ground"
b = { body = "block", point = [0, 0, 0] }
axis = [0, 0, 1]

[forces.spring]
kind = "joint_spring_damper"
joint = "guide"
stiffness = 800.0

[simulate]
duration = 2e-3
step = 1e-3
"""


@pytest.fixture
def coarse(tmp_path: Path) -> Path:
    """A coarse roller as .vtu in mm, made with meshio: the set `rim` and `bore` as 0/1 arrays on the facets."""
    import meshio

    mesh = wf.mesh.roller(0.05, 0.015, 0.02, sectors=24, layers=2, axial=2, order=1)
    names = ("rim", "bore")
    facets = np.concatenate([mesh.facets(n).single[1] for n in names])
    owner = np.repeat(names, [len(mesh.facets(n)) for n in names])
    data = {n: [np.zeros(len(mesh.single[1]), dtype=int), (owner == n).astype(int)] for n in names}
    path = tmp_path / "roller.vtu"
    meshio.write(
        path, meshio.Mesh(mesh.points * 1e3, [("hexahedron", mesh.single[1]), ("quad", facets)], cell_data=data)
    )
    return path


@pytest.mark.parametrize(
    "command",
    [
        [],
        ["demo"],
        ["reduce"],
        ["info"],
        ["run"],
        ["modes"],
        ["campbell"],
        ["compare"],
        ["plot"],
        ["spectrum"],
        ["report"],
    ],
    ids=lambda c: "-".join(c) or "main",
)
def test_help_explains_every_option(command: list[str], capsys: pytest.CaptureFixture) -> None:
    assert cli.main([*command, "--help"]) == 0
    text = capsys.readouterr().out
    assert "Usage: warpffrf" in text
    options = [line for line in text.splitlines() if line.startswith(("  -", "  --"))]
    assert options, "no option is listed"


def test_version(capsys: pytest.CaptureFixture) -> None:
    assert cli.main(["--version"]) == 0
    assert capsys.readouterr().out.strip() == f"warpffrf {wf.__version__}"


@pytest.mark.parametrize("arguments", [["frobnicate"], ["reduce"], ["info"], ["info", "a", "--no"]])
def test_wrong_usage_exits_with_2(arguments: list[str], capsys: pytest.CaptureFixture) -> None:
    assert cli.main(arguments) == 2
    assert "Traceback" not in capsys.readouterr().err


def test_wrong_input_is_one_line_and_exit_1(coarse: Path, tmp_path: Path, capsys: pytest.CaptureFixture) -> None:
    other = tmp_path / "data.h5"
    other.write_bytes(describe.HDF5_SIGNATURE + b"not more than that")
    blocked = tmp_path / "file"
    blocked.write_text("")
    target = ["-o", str(tmp_path / "body.h5")]
    mm = ["--length-unit", "mm"]
    cases = [
        (["info", str(tmp_path / "none.h5")], "there is no file"),
        (["info", str(blocked)], "neither a mesh"),
        (["info", str(other)], "damaged"),
        (["info", str(coarse)], "add --length-unit, one of m, cm, mm"),
        (["info", str(coarse), "--length-unit", "furlong"], "known: 'm', 'cm', 'mm'"),
        (["info", str(coarse), *mm, "--density", "0"], "density must be greater than zero"),
        (["reduce", str(tmp_path / "none.msh"), *mm, *STEEL, *target], "does not exist"),
        (["reduce", str(coarse), *mm, *STEEL, "--poisson-ratio", "0.5", *target], "--poisson-ratio must lie between"),
        (["reduce", str(coarse), *mm, *STEEL, "--contact", "tread", *target], "known: 'rim', 'bore'"),
        (["reduce", str(coarse), *mm, *STEEL, "-o", str(blocked / "body.h5")], "cannot be written"),
        (["info", str(DATA / "assembly.inp"), *mm], "select one with --part, one of 'Brick-1', 'Brick-2', 'Peg-1'"),
        (["info", str(DATA / "flat.inp"), *mm, "--part", "2"], "part 2 does not exist, it has 1 connected part(s)"),
        (["reduce", str(coarse), *mm, *STEEL, "-o", str(tmp_path / "x.txt")], "must end in .h5 or .hdf5"),
        (["reduce", str(coarse), *mm, *STEEL, "-o", str(other)], "or replace it with --overwrite\n"),
        (["reduce", str(coarse), *mm, *STEEL, "--half-width", "-1", *target], "--half-width must be greater"),
        (["demo", "three-rollers"], "did you mean 'two-rollers'"),
        (["demo", "two-rollers", "--out", str(blocked / "x")], "choose another folder with --out"),
    ]
    for arguments, expected in cases:
        assert cli.main(["--quiet", *arguments]) == 1, arguments
        error = capsys.readouterr().err
        assert error.startswith("error: ") and expected in error, error
        assert len(error.strip().splitlines()) == 1, error


def test_verbose_shows_where_an_error_came_from(tmp_path: Path, capsys: pytest.CaptureFixture) -> None:
    assert cli.main(["-v", "info", str(tmp_path / "none.h5")]) == 1
    assert "describe.py" in capsys.readouterr().err


def test_verbose_says_more_and_with_times(coarse: Path, tmp_path: Path, capsys: pytest.CaptureFixture) -> None:
    options = [str(coarse), "--length-unit", "mm", *STEEL, "--modes", "4", "--no-cache", "--overwrite"]
    said = []
    for level in ([], ["-v"]):
        assert cli.main([*level, "reduce", *options, "-o", str(tmp_path / "body.h5")]) == 0
        said.append(capsys.readouterr().err)
    assert "reduce: 'roller', " in said[0] and " done in " in said[0] and "took" not in said[0]
    assert len(said[1].splitlines()) > len(said[0].splitlines()) and "reduce: mesh check took" in said[1]
    assert all(" ms] " in line for line in said[1].splitlines())


def test_quiet_demos_print_no_figures(
    capsys: pytest.CaptureFixture, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    def main(out: Path, *, quick: bool, progress: bool) -> list[SimpleNamespace]:
        print(f"figures {progress}")
        return [SimpleNamespace(status="not_converged", message="a shorter step")]

    monkeypatch.setitem(sys.modules, "two_rollers", SimpleNamespace(main=main))  # type: ignore[arg-type]
    said = []
    for level in ([], ["-q"]):
        assert cli.main([*level, "demo", "two-rollers", "--out", str(tmp_path)]) == 1  # the code says how it went
        said.append(capsys.readouterr())
    assert [out for out, _ in said] == ["figures True\n", ""]
    assert all("not_converged: a shorter step" in err for _, err in said)


@pytest.mark.parametrize("command", [[], ["demo"], ["reduce"], ["study", "speed-error"]], ids=" ".join)
def test_h_is_help(command: list[str], capsys: pytest.CaptureFixture) -> None:
    assert cli.main([*command, "-h"]) == 0
    assert "Usage: warpffrf" in capsys.readouterr().out


def test_the_shell_can_complete(capsys: pytest.CaptureFixture) -> None:
    assert cli.main(["--help"]) == 0
    assert "--install-completion" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("said", "told"),
    [
        ("select one with part=, one of 'a', 'b'", "select one with --part, one of 'a', 'b'"),
        ("choose it with part='pad'", "choose it with --part pad"),
        ("replace it with overwrite=True (--overwrite)", "replace it with --overwrite"),
        ("or restart with overwrite=True", "or restart with --overwrite"),
        ("max_frequency must be positive", "--max-frequency must be positive"),
        ("expected_half_width or another part of it", "--half-width or another part of it"),
        ("set 'max_frequency' is not in body.max_frequency", "set 'max_frequency' is not in body.max_frequency"),
    ],
)
def test_errors_speak_of_options(said: str, told: str) -> None:
    options = {"part": "--part", "overwrite": "--overwrite", "max_frequency": "--max-frequency"}
    assert in_options(said, {**options, "half_width": "--half-width"}) == told


def test_reduce_then_info(coarse: Path, tmp_path: Path, capsys: pytest.CaptureFixture) -> None:
    target = tmp_path / "new folder" / "body.h5"
    sets = ["--interface", "bore", "--contact", "rim", "--modes", "4", "--no-cache"]
    assert cli.main(["-q", "reduce", str(coarse), "--length-unit", "mm", *STEEL, *sets, "-o", str(target)]) == 0
    assert capsys.readouterr().out == ""
    body = wf.ReducedBody.load(target)
    assert cli.main(["info", str(target)]) == 0
    said = capsys.readouterr().out
    assert f"{body.mass:.6g} kg" in said and "bore: rigid" in said and "inertia about the centre" in said


def test_options_of_a_reduction_reach_it(tmp_path: Path, capsys: pytest.CaptureFixture) -> None:
    target = tmp_path / "body.h5"
    mesh, mm = str(wf.examples.path("roller") / "roller.msh"), ["--length-unit", "mm"]
    sets = ["--interface", "bore", "--modes", "6", "--no-cache"]
    sets += ["--inertia-modes", "4", "--stiffening", "--centrifugal"]
    assert cli.main(["-q", "reduce", mesh, *mm, *STEEL, *sets, "-o", str(target)]) == 0
    body = wf.ReducedBody.load(target)
    terms = body.inertia_terms
    assert terms is not None and terms.modes == 4
    assert "with the static response to rotation" in body.info()
    assert terms.stiffening is not None and list(terms.stiffening.interfaces) == ["bore"]


def test_campbell_diagram_of_a_scene_file(tmp_path: Path, capsys: pytest.CaptureFixture) -> None:
    """J w^2 -+ J_p W w = k: forward and backward tilting of a rotor held by a spring about its middle."""
    file, picture = wf.examples.path("rotor") / "rotor.toml", tmp_path / "campbell.png"
    given = ["campbell", str(file), "speed", "100", "--steps", "2", "--count", "4", "--out", str(picture)]
    assert cli.main(given) == 0 and picture.stat().st_size > 10_000
    said = capsys.readouterr().out
    for spin in (0.0, 50.0, 100.0):
        for sign in (1.0, -1.0):
            w = abs(np.roots([0.02, -sign * 0.03 * spin, -800.0]).max())
            assert f"{w / (2.0 * np.pi):.5g}" in said, said
    assert cli.main(["campbell", str(file), "speed", "100", "--steps", "0"]) == 1
    assert "--steps is 0" in capsys.readouterr().err


def test_modes_of_a_scene_file(tmp_path: Path, capsys: pytest.CaptureFixture) -> None:
    file = tmp_path / "oscillator.toml"
    file.write_text(OSCILLATOR, encoding="utf-8")
    frequency = f"{np.sqrt(800.0 / 2.0) / (2.0 * np.pi):.5g}"
    assert cli.main(["-q", "run", str(file), "--out", str(tmp_path)]) == 0
    capsys.readouterr()
    for about, said in (
        ([], "about the equilibrium"),
        (["--about", "initial"], "about the initial state"),
        (["--about", str(tmp_path / "oscillator.h5")], "about the last state of a run, t = 0.002 s"),
    ):
        assert cli.main(["modes", str(file), *about]) == 0
        text = capsys.readouterr().out
        assert said in text and frequency in text and "block 100 %" in text, text
    picture = tmp_path / "modes.png"
    stiffer = ["--set", "forces.spring.stiffness=3200.0", "--out", str(picture)]
    assert cli.main(["modes", str(file), *stiffer]) == 0 and picture.stat().st_size > 5_000
    said = capsys.readouterr().out
    assert f"{np.sqrt(3200.0 / 2.0) / (2.0 * np.pi):.5g}" in said and f"drawn to {picture}" in said
    for arguments, said in (
        (["--about", "equilibirum"], "known: equilibrium, initial, or a results file"),
        (["--about", "none.h5"], "does not exist"),
        (["--count", "0"], "eigenmodes: count"),
    ):
        assert cli.main(["modes", str(file), *arguments]) == 1
        error = capsys.readouterr().err
        assert error.startswith("error: ") and said in error and len(error.strip().splitlines()) == 1, error


def test_info_of_a_mesh_gives_its_size_mass_and_inertia(capsys: pytest.CaptureFixture) -> None:
    path = wf.examples.path("roller") / "roller.msh"
    assert cli.main(["info", str(path), "--length-unit", "mm"]) == 0
    said = capsys.readouterr().out
    for word in ("nodes", "box", "rim (", "bore (", "mass", "inertia"):
        assert word in said
    found = wf.mesh.read(path, length_unit="mm").report(wf.Material(210e9, 0.3, 7850.0))
    mass, inertia = found.mass, found.inertia
    assert inertia is not None
    R, r, width = 0.05, 0.015, 0.02  # of the script that made the mesh
    expected = 7850.0 * np.pi * (R**2 - r**2) * width
    assert mass == pytest.approx(expected, rel=FACET_LOSS)
    polar, across = 0.5 * expected * (R**2 + r**2), expected * (3 * (R**2 + r**2) + width**2) / 12
    assert np.linalg.eigvalsh(inertia) == pytest.approx([across, across, polar], rel=FACET_LOSS)


def test_one_body_of_several(tmp_path: Path, capsys: pytest.CaptureFixture) -> None:
    deck, mm = str(DATA / "assembly.inp"), ["--length-unit", "mm"]
    assert cli.main(["info", deck, *mm, "--part", "Brick-2"]) == 0
    said = capsys.readouterr().out
    assert "mesh assembly:Brick-2" in said and "2 hex8" in said and "Head (1 facets)" in said
    assert cli.main(["info", str(DATA / "flat.inp"), *mm, "--part", "0"]) == 0
    assert "1 hex8, 1 wedge6" in capsys.readouterr().out
    target = tmp_path / "brick.h5"  # its material is that of the deck
    sets = ["--interface", "Foot", "--modes", "2", "--no-cache"]
    assert cli.main(["-q", "reduce", deck, *mm, "--part", "Brick-1", *sets, "-o", str(target)]) == 0
    assert wf.ReducedBody.load(target).mass == pytest.approx(7850.0 * 2e-6, rel=1e-9)


def test_info_warns_of_a_wrong_length_unit(coarse: Path, capsys: pytest.CaptureFixture) -> None:
    assert cli.main(["--quiet", "info", str(coarse), "--length-unit", "m"]) == 0
    assert "warning: the largest dimension is 100 m" in capsys.readouterr().out


def test_the_command_line_starts_without_the_heavy_libraries() -> None:
    heavy = "('numpy', 'scipy', 'warp', 'rerun', 'matplotlib', 'meshio', 'skfem')"
    code = f"import sys, warpffrf.cli; print([m for m in {heavy} if m in sys.modules])"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"


EVIL = "\x1b]0;owned\x07\x1b[31m\x9b2J\u202e"  # sets a title, a colour, clears, turns the direction of writing


def test_names_in_files_do_not_reach_the_terminal_as_escapes(
    tmp_path: Path, capsys: pytest.CaptureFixture, monkeypatch: pytest.MonkeyPatch
) -> None:
    """In reports and scenes on stdout, in notes and in errors on stderr."""
    name = EVIL.encode("unicode_escape").decode().replace("\\x", "\\u00")
    monkeypatch.chdir(tmp_path)
    scene = tmp_path / "scene.toml"
    scene.write_text(
        f'[scene]\ngravity = [0, 0, 0]\n[bodies."{name}"]\nmass = 1.0\ninertia_tensor = [1, 1, 1]\n[simulate]\n'
        f"duration = 1e-3\nstep = 1e-3\n"
    )
    assert cli.main(["-v", "run", str(scene)]) == 0
    assert cli.main(["run", str(scene), "--set", f"bodies.{EVIL}=1"]) != 0
    assert cli.main(["run", str(tmp_path / EVIL)]) == 1
    said = "".join(capsys.readouterr())
    assert r"\x1b]0;owned\x07\x1b[31m\x9b2J\u202e" in said
    assert not set(said) & set(EVIL[:1] + "\x07\x9b\u202e")


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_interruptions_while_the_command_loads(number: signal.Signals) -> None:
    """The signal comes as the first library of the command line is imported."""
    code = """
        import signal, sys
        signal.signal(signal.SIGINT, signal.default_int_handler)  # which background jobs of a shell do not have
        class Interrupting:
            def find_spec(self, name, path=None, target=None):
                if name == "typer":
                    signal.raise_signal(int(sys.argv[1]))
        sys.meta_path.insert(0, Interrupting())
        from warpffrf.__main__ import main
        sys.exit(main())
    """
    ended = subprocess.run(
        [sys.executable, "-c", textwrap.dedent(code), str(int(number))], capture_output=True, text=True
    )
    assert (ended.returncode, ended.stderr) == (130, "interrupted\n")
