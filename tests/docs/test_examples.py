"""The files that ship with the package: each is run by the commands that `warpffrf example` prints, and named right."""

from __future__ import annotations

import re
import runpy
import shlex
from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import warpffrf as wf
from printed import printed
from warpffrf import cli

ROOT = Path(__file__).resolve().parents[2]
PAGES = (ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md")))
INPUTS = (".toml", ".inp", ".msh", ".vtu")
STEP_ERROR = 1e-4  # of the swing, at steps of a thousandth of a period, second order


def printed_commands(name: str, capsys: pytest.CaptureFixture) -> list[list[str]]:
    """The commands of an example as `warpffrf example` lists them."""
    capsys.readouterr()
    assert cli.main(["example"]) == 0
    (part,) = [p for p in capsys.readouterr().out.split("\n\n") if p.startswith(f"{name}:")]
    return [shlex.split(line)[1:] for line in part.splitlines() if line.startswith("  warpffrf ")]


@pytest.mark.parametrize("name", wf.examples.names())
def test_the_commands_of_an_example_run(
    name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture
) -> None:
    monkeypatch.chdir(tmp_path)
    assert cli.main(["example", "copy", name]) == 0
    assert {p.name for p in tmp_path.iterdir()} == set(wf.examples.get(name).files)
    said = {}
    for words in printed_commands(name, capsys):
        assert cli.main(["-q", *words]) == 0, capsys.readouterr().err
        said[words[0]] = capsys.readouterr().out
    CHECKS[name](said)


def check_ball_bearing(said: dict[str, str]) -> None:
    """All balls carry the load together; a raceway that is lower under it spares the first one."""
    files = ("out/ball_bearing/ball_bearing_equilibrium.h5", "round/ball_bearing_equilibrium.h5")
    oval, even = (wf.Result.load(file).bearing("main") for file in files)
    for bearing in (oval, even):
        assert np.linalg.norm(bearing.force[-1]) == pytest.approx(5e3, rel=1e-6)
    assert oval.outer_load[-1, 0] < 0.97 * even.outer_load[-1, 0] and oval.outer_load[-1, 1] > even.outer_load[-1, 1]


def check_beam(said: dict[str, str]) -> None:
    """A free beam bends at 4.73004^2/(2 pi L^2) sqrt(E I/(rho A)), but for shear and rotary inertia."""
    body = wf.ReducedBody.load("beam.h5")
    assert body.mass == pytest.approx(2700 * 0.2 * 0.01 * 0.008, rel=1e-9)
    slender = 4.73004**2 / (2 * np.pi * 0.2**2) * np.sqrt(70e9 / 2700 * 0.008**2 / 12)
    assert body.frequencies.min() == pytest.approx(slender, rel=0.02)  # free-free; shear and rotary inertia take 1 %
    assert "sets    hub (4 facets), tip (4 facets)" in said["info"]


def check_machine(said: dict[str, str]) -> None:
    body = wf.ReducedBody.load("shoe.h5")
    assert set(body.contact_surfaces) == {"pad"} and body.interfaces["foot"].kind == "average"
    arc = 2 * (2.0 / 2 * np.sqrt(50**2 - 2**2) + 50**2 / 2 * np.arcsin(2 / 50)) - 4 * 50  # mm2 missing under the pad
    assert body.mass == pytest.approx(1e-9 * 4 * (4 * 20 + arc) * 7500, rel=0.06)  # cast iron 7100, steel 7850 kg/m3
    assert "hardened" in said["info"]


def check_pendulum(said: dict[str, str]) -> None:
    """(J + m a^2) phi'' = m g a cos(phi) - c phi', phi from the horizontal, integrated by SciPy."""
    m, J, a, c = 2.0, 0.01, 0.4, 0.2

    def rates(_: float, y: np.ndarray) -> list[float]:
        return [y[1], (m * 9.81 * a * np.cos(y[0]) - c * y[1]) / (J + m * a**2)]

    exact = solve_ivp(rates, (0.0, 1.0), [0.0, 0.0], rtol=1e-10, atol=1e-12).y[0, -1]
    result = wf.Result.load("out/pendulum/pendulum.h5")
    assert result.joint("hinge").coordinate[-1] == pytest.approx(exact, rel=STEP_ERROR)


def check_press(said: dict[str, str]) -> None:
    """The contact carries the preload and the upper roller; the second run goes on where the first has ended."""
    first, light, rolled = (wf.Result.load(f) for f in ("out/press/press.h5", "light/press.h5", "out/roll/roll.h5"))
    weight = wf.load_scene("press.toml").scene.body("upper").mass * 9.81
    for result, load in ((first, 4000.0), (light, 2000.0), (rolled, 4000.0)):
        assert result.status == "completed"
        assert abs(result.contact("lower-upper").force[-1, 2]) == pytest.approx(load + weight, rel=2e-3)
    assert rolled.time[0] == pytest.approx(first.time[-1] + 2e-4) and "[lower-upper] [N]" in said["compare"]


def check_roller(said: dict[str, str]) -> None:
    body = wf.ReducedBody.load("roller.h5")
    made = runpy.run_path("make_roller.py")
    R, r, b = (1e-3 * made[k] for k in ("OUTER_RADIUS", "BORE_RADIUS", "WIDTH"))
    assert body.mass == pytest.approx(7850 * np.pi * (R**2 - r**2) * b, rel=5e-3)  # quadratic facets follow the circle


def check_two_rollers(said: dict[str, str]) -> None:
    assert wf.Result.load("out/two_rollers/two_rollers.h5").status == "completed"


def check_rotor(said: dict[str, str]) -> None:
    """J w^2 - J_p W w = k: the fastest tilting goes with J_p/J of the speed in the end."""
    w = np.roots([0.02, -0.03 * 600.0, -800.0]).max()
    assert f"{w / (2.0 * np.pi):.5g}" in said["campbell"] and Path("campbell.png").stat().st_size > 10_000


CHECKS = {
    "ball-bearing": check_ball_bearing,
    "beam": check_beam,
    "machine": check_machine,
    "pendulum": check_pendulum,
    "press": check_press,
    "roller": check_roller,
    "rotor": check_rotor,
    "two-rollers": check_two_rollers,
}


def test_files_are_what_their_scripts_make(tmp_path: Path) -> None:
    """Meshes that need no mesher are made again from the scripts next to them."""
    for name, file in (("machine", "machine.inp"), ("beam", "beam.vtu")):
        script, *_ = [f for f in wf.examples.copy(name, tmp_path) if f.suffix == ".py"]
        (tmp_path / file).unlink()
        runpy.run_path(str(script), run_name="__main__")
        assert (tmp_path / file).read_bytes() == (wf.examples.path(name) / file).read_bytes()


def test_the_first_line_of_each_file_says_what_it_is() -> None:
    for name in wf.examples.names():
        folder = wf.examples.path(name)
        inside = {p.name for p in folder.iterdir() if p.name != "__pycache__"}
        assert inside == set(wf.examples.get(name).files), name
        for file in inside:
            first = (folder / file).read_bytes().removeprefix(b"$Comments\n").split(b"\n")[0].decode()
            assert "warpffrf example" in first and first[0] in '#*<"A', first


def test_nothing_is_replaced_unasked(tmp_path: Path, capsys: pytest.CaptureFixture) -> None:
    folder = str(tmp_path / "new")
    assert cli.main(["example", "copy", "press", folder]) == 0
    changed = tmp_path / "new" / "steel.toml"
    changed.write_text(changed.read_text() + "# mine\n")
    (tmp_path / "new" / "roll.toml").unlink()
    assert cli.main(["example", "copy", "press", folder]) == 1
    error = capsys.readouterr().err.splitlines()[-1]
    assert error.startswith("error: ") and "steel.toml' exists" in error and "--overwrite" in error
    assert "# mine" in changed.read_text() and not (tmp_path / "new" / "roll.toml").exists()
    assert cli.main(["example", "copy", "press", folder, "--overwrite"]) == 0
    assert "# mine" not in changed.read_text() and (tmp_path / "new" / "roll.toml").exists()
    changed.write_text("[materials]\n")
    assert cli.main(["example", "copy", "press", folder, "--overwrite"]) == 1  # a file of the user's own
    assert "is not replaced" in capsys.readouterr().err


def test_an_unknown_example_is_answered_with_the_nearest(capsys: pytest.CaptureFixture) -> None:
    assert cli.main(["example", "copy", "pres"]) == 1
    assert "did you mean 'press'?" in capsys.readouterr().err
    with pytest.raises(wf.InputError, match="did you mean 'two-rollers'"):
        wf.examples.path("two_rollers")


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_files_that_a_page_reads_are_copied_before(page: Path) -> None:
    there: set[str] = set()
    for item in printed(page.read_text(encoding="utf-8")):
        if not item.is_python and item.words[1:3] == ["example", "copy"]:
            there |= set(wf.examples.get(item.words[3]).files)
            continue
        own = re.sub(r'wf\.examples\.path\("[^"]*"\) / "[^"]*"', "", item.text)  # read where it ships
        words = re.findall(r'"([^"]*)"', own) if item.is_python else item.words
        named = {word for word in words if Path(word).suffix in INPUTS}
        assert named <= there, f"{page.name}:{item.line} reads {sorted(named - there)}, which no line before copies"


def test_the_pendulum_of_the_scene_page_is_the_one_that_ships() -> None:
    page = (ROOT / "docs" / "scene_file.md").read_text(encoding="utf-8")
    text = (wf.examples.path("pendulum") / "pendulum.toml").read_text(encoding="utf-8").split("\n", 1)[1]
    assert "".join(f"    {line}".rstrip() + "\n" for line in text.splitlines()) in page


def test_the_reference_of_scene_files_is_printed(capsys: pytest.CaptureFixture) -> None:
    assert cli.main(["scene-file"]) == 0
    assert capsys.readouterr().out.strip() == (ROOT / "docs" / "scene_file.md").read_text(encoding="utf-8").strip()
    assert cli.main(["run", "--help"]) == 0
    assert "warpffrf scene-file" in capsys.readouterr().out
