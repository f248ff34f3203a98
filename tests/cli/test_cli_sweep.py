"""The command `warpffrf sweep`, on the pendulum that comes with the package."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from typer.testing import CliRunner

import warpffrf as wf
from warpffrf.cli import app

PENDULUM = str(Path(wf.__file__).parent / "examples" / "pendulum" / "pendulum.toml")
SHORT = ["--set", "simulate.duration=5e-3"]
LOWEST = "lowest=min(body_position_z[bob])"


def call(*words: str) -> Any:
    return CliRunner().invoke(app, ["sweep", PENDULUM, *SHORT, *words])


def test_a_table_is_made_and_reported(tmp_path: Path) -> None:
    out = str(tmp_path / "arms")
    done = call("--vary", "arm=0.2:0.4:2", "--vary", "forces.brake.damping=0.1,1.5", "--output", LOWEST, "--out", out)
    assert done.exit_code == 0, done.output
    assert "4 completed" in done.output and "arm: 0.2:0.4:2" in done.output
    found = wf.study.open_sweep(out)
    assert found["arm"].tolist() == [0.2, 0.2, 0.4, 0.4] and np.all(found["lowest"] < 0.0)
    again = call("--vary", "arm=0.2:0.4:2", "--output", LOWEST, "--out", out)
    assert again.exit_code == 1 and "--resume" in again.output and "--overwrite" in again.output
    quiet = CliRunner().invoke(
        app, ["-q", "sweep", PENDULUM, *SHORT, "--vary", "arm=uniform(0.2, 0.4)", "--sample", "latin:3", "--output",
              "energy[kinetic]", "--out", out, "--overwrite"],
    )  # fmt: skip
    assert quiet.exit_code == 0 and not quiet.output
    strata = np.sort(wf.study.open_sweep(out)["arm"])
    assert np.all((strata > [0.2, 0.2 + 0.2 / 3, 0.2 + 0.4 / 3]) & (strata < [0.2 + 0.2 / 3, 0.2 + 0.4 / 3, 0.4]))


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["--vary", "arn=0.2,0.3", "--output", LOWEST], "did you mean 'arm'"),
        (["--vary", "arm", "--output", LOWEST], "--vary NAME=VALUE"),
        (["--vary", "arm=0.2", "--vary", "arm=0.3", "--output", LOWEST], "given twice"),
        (["--vary", "arm=0.2,0.3", "--output", "max(body_position_z[bop])"], "similar names"),
        (["--vary", "arm=normal(0.3, 0.01)", "--output", LOWEST], "--sample latin:64"),
        (["--vary", "arm=0.2,0.3", "--output", LOWEST, "--sample", "latin"], "latin:64"),
        (["--vary", "arm=0.2,0.3", "--output", LOWEST, "--sample", "latin", "--seed", "3"], "latin:64"),
        (["--vary", "arm=0.2,0.3", "--output", LOWEST, "--workers", "0"], "at least 1"),
        (["--vary", "arm=0.2,0.3", "--output", LOWEST, "--device", "cpu", "--device", "cpu"], "give --workers 2"),
        (
            ["--vary", "arm=0.2,0.3", "--output", LOWEST, "--scheduler", "tcp://x:1", "--device", "cpu"],
            "--scheduler has",
        ),
    ],
)
def test_wrong_input_is_one_line_with_the_cure(tmp_path: Path, words: list[str], said: str) -> None:
    failed = call(*words, "--out", str(tmp_path / "s"))
    assert failed.exit_code == 1 and said in failed.output
    assert "Traceback" not in failed.output


def test_options_of_the_command_are_those_of_the_sweep(tmp_path: Path) -> None:
    """Another seed is another sample; equilibria, the device and the error budget are those of each row."""
    arms = []
    for seed in ("0", "3"):
        done = call("--vary", "arm=uniform(0.2, 0.4)", "--sample", "latin:2", "--seed", seed, "--output", LOWEST,
                    "--device", "cpu", "--error-budget", "--equilibrium", "--out", str(tmp_path / seed))  # fmt: skip
        assert done.exit_code == 0, done.output
        found = wf.study.open_sweep(tmp_path / seed)
        assert found.definition["call"] == "equilibrium" and found.definition["error_budget"]
        assert set(found["device"]) == {"cpu"}
        arms.append(found["arm"].tolist())
    assert arms[0] != arms[1]


def test_a_row_that_fails_makes_the_exit_code(tmp_path: Path) -> None:
    failed = call("--vary", "forces.brake.damping=-1.0,1.0", "--output", LOWEST, "--out", str(tmp_path / "s"))
    assert failed.exit_code == 1 and "1 refused" in failed.output and "1 completed" in failed.output
