"""FMUs of scene files as an importing tool sees them: fmpy, in a process of its own."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path
from typing import Any

import fmu_scenes
import numpy as np
import pytest
from fmu_scenes import FIRST, MOTOR, SECOND, SPEED

import warpffrf as wf
from warpffrf import cli

for needed in ("pythonfmu", "pythonfmu3", "fmpy"):
    pytest.importorskip(needed)

VERSIONS = ("2.0", "3.0")
STEP = 1e-3
ROUNDED = 1e-12  # of the sum of a few hundred steps


def driven(*tasks: tuple[Any, ...]) -> list[Any]:
    """What tasks of the driver find, all in one process, which ends by itself."""
    done = subprocess.run(
        [sys.executable, str(Path(__file__).with_name("fmu_driver.py")), json.dumps(tasks)],
        capture_output=True, text=True, timeout=600, check=False,
    )  # fmt: skip
    assert done.returncode == 0, done.stdout + done.stderr
    return json.loads(done.stdout.splitlines()[-1])


@pytest.fixture(scope="module", params=VERSIONS)
def motor(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> dict[str, Any]:
    """What an importing tool finds with the motor as an FMU, written by the command."""
    folder = tmp_path_factory.mktemp("motor")
    (folder / "motor.toml").write_text(MOTOR)
    path = str(folder / "motor drive.fmu")
    arguments = ["--input", "motor torque", "--output", "rim", "--output", SPEED, "--fmi", request.param]
    assert cli.main(["fmu", str(folder / "motor.toml"), *arguments, "-o", path]) == 0
    names = ("validate", "values", "states", "failures")
    return dict(zip(names, driven(*[(name, path) for name in names]), strict=True), scene=folder / "motor.toml")


def test_fmpy_finds_no_problem_and_simulates(motor: dict[str, Any]) -> None:
    found = motor["validate"]
    assert found["problems"] == []
    assert found["rows"] == 51
    assert found["speed"] == pytest.approx(2.0 * 0.1 / 0.2, rel=ROUNDED)  # torque times time over inertia


def test_values_are_those_of_a_simulation(motor: dict[str, Any]) -> None:
    """The same bits, with communication steps of several steps, and the start value as initial value."""
    sim = wf.Simulation(wf.load_scene(motor["scene"], settings=["signals.torque.initial=2.0"]).scene, step=STEP)
    expected = []
    for n in range(60):
        sim.inputs["motor torque"] = float(np.cos(0.3 * n))
        sim.run((1 + n % 3) * STEP)
        expected.append(sim.outputs[SPEED])
    assert motor["values"] == expected


def test_states_are_got_set_and_serialised(motor: dict[str, Any]) -> None:
    first, again, other = motor["states"]
    assert first == again == other
    assert first != 0.0


def test_wrong_calls_are_named_and_the_process_goes_on(motor: dict[str, Any]) -> None:
    found = motor["failures"]
    for name, said in (
        ("no multiple", "no positive multiple of the step 0.001 s"),
        ("zero", "no positive multiple"),
        ("backwards", "no positive multiple"),
        ("not a number", "no positive multiple"),
        ("elsewhere", "is not where this instance is"),
        ("nan", "input 'motor torque' must be a finite number"),
        ("again", "input 'motor torque' must be a finite number"),
        ("failed", "not_finite at t ="),
        ("after", "it has ended"),
        ("no state", "it has ended"),
    ):
        assert found[name].startswith("discard: "), (name, found[name])
        assert said in found[name], (name, found[name])
    assert found["restored"] == found["reset"] == "completed"
    assert found.get("terminated", True)
    assert len(set(found["speed"])) == 1  # of the last step that succeeded


@pytest.mark.slow
def test_two_halves_are_the_whole(tmp_path: Path) -> None:
    """Two halves of a beam, each an FMU, joined by a stiff bushing, with windows of a tenth of its period: 1 %.

    With one exchange per window, and forces that are held, the coupling adds energy and the halves are off by more than
    the amplitude; sweeps over the window converge to the whole beam."""
    count = 15
    (tmp_path / "whole.toml").write_text(fmu_scenes.whole(1e-3))
    modes = wf.eigenmodes(wf.load_scene(tmp_path / "whole.toml").scene, 1, about="initial", progress=False)
    window = round(0.1 / modes.frequencies[0], 6)  # s
    step = window / 10
    (tmp_path / "whole.toml").write_text(fmu_scenes.whole(step))
    sim, places = wf.Simulation(wf.load_scene(tmp_path / "whole.toml").scene, step=step), []
    for n in range(count + 1):
        places.append([sim.outputs[f"sensor_{a}[{which[0]}_place]"] for which in (FIRST, SECOND) for a in "xz"])
        if n < count:
            sim.run(10 * step)
    paths = []
    for which in (FIRST, SECOND):
        (tmp_path / f"{which[0]}.toml").write_text(fmu_scenes.half(which, step=step))
        paths.append(str(tmp_path / f"{which[0]}.fmu"))
        assert cli.main(["fmu", str(tmp_path / f"{which[0]}.toml"), "-o", paths[-1]]) == 0
    scale = np.ptp(np.array(places), axis=0).max()
    sweeps = (1, 3, 5)
    found = driven(*[("coupled", *paths, window, step, count, each) for each in sweeps])
    error = {each: np.abs(np.array(one) - places).max() / scale for each, one in zip(sweeps, found, strict=True)}
    print(window, scale, error)
    assert error[1] > 1.0
    assert error[5] < 0.01
