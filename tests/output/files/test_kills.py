"""A hundred of each: SIGKILL, SIGTERM and Ctrl-C at any time of a reduction, a run, one in stages and a recorded one.

Whatever the moment, the same call with resume=True ends as if nothing had happened, bit for bit, and leaves no other
file than that. `KILLS` in the environment is another number of each.
"""

from __future__ import annotations

import os
import random
import signal
import subprocess
import sys
from pathlib import Path

import pytest
from test_unfinished import BEFORE_LONG, PROGRAM, same
from unfinished_runs import reduced, simulate

import warpffrf as wf

KILLS = int(os.environ.get("KILLS", "100"))
CASES = {"plain": 3.0, "stages": 3.0, "recorded": 4.0, "reduced": 3.0}  # s after the start, within which it is stopped
FILES = {
    "plain": {"run.h5"},
    "stages": {"run.h5", "run.swing.h5", "run.fall.h5"},
    "recorded": {"run.h5", "run.rrd"},
    "reduced": {"run.h5", "cache"},
}
SIGNALS = {"SIGKILL": signal.SIGKILL, "SIGTERM": signal.SIGTERM, "Ctrl-C": signal.SIGINT}


@pytest.fixture(scope="module")
def expected(tmp_path_factory: pytest.TempPathFactory) -> dict[str, object]:
    """What each case gives where nobody stops it."""
    whole: dict[str, object] = {case: simulate(case, None).history for case in CASES if case != "reduced"}
    return whole | {"reduced": reduced(tmp_path_factory.mktemp("whole") / "run.h5").content_hash()}


@pytest.mark.slow
@pytest.mark.parametrize("limit", [int(300 * 1.7**n) for n in range(20)])
def test_a_disk_that_is_full_at_any_place_loses_no_result(
    limit: int, expected: dict[str, object], tmp_path: Path
) -> None:
    """No file may be longer than `limit` bytes: parts, checkpoint, results or recording fail in the middle."""
    file = tmp_path / "run.h5"
    program = subprocess.run(
        [sys.executable, str(PROGRAM), "recorded", str(file)], capture_output=True, text=True, timeout=BEFORE_LONG,
        env={**os.environ, "FILE_LIMIT": str(limit)}, check=False,
    )  # fmt: skip
    assert program.returncode == 0 and "status completed" in program.stdout, program.stderr
    assert "Traceback" not in program.stderr
    assert not list(tmp_path.rglob("*.part"))
    found = simulate("recorded", file, resume=True)
    assert found.unwritten == [] and same(expected["recorded"], found.history) in ([], ["/notes"])  # what was not kept
    assert {path.name for path in tmp_path.iterdir()} == FILES["recorded"]


@pytest.mark.slow
@pytest.mark.parametrize("number", range(KILLS))
@pytest.mark.parametrize("name", SIGNALS)
def test_nothing_is_lost(name: str, number: int, expected: dict[str, object], tmp_path: Path) -> None:
    chance = random.Random(f"{name} {number}")
    case = list(CASES)[number % len(CASES)]
    file = tmp_path / "run.h5"
    program = subprocess.Popen(
        [sys.executable, str(PROGRAM), case, str(file)], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    )
    assert program.stdout is not None and program.stdout.readline() == "ready\n"
    try:
        program.wait(chance.uniform(0.0, CASES[case]))
    except subprocess.TimeoutExpired:
        program.send_signal(SIGNALS[name])
    program.communicate(timeout=BEFORE_LONG)
    if case == "reduced":
        reduced(file).save(file, overwrite=True)
        assert wf.ReducedBody.load(file).content_hash() == expected[case]
    else:
        found = simulate(case, file, resume=True)
        assert found.status == "completed" and same(expected[case], found.history) == []
    assert {path.name for path in tmp_path.iterdir()} == FILES[case]
    assert not [path for path in tmp_path.rglob("*.part") if path.parent.name != "cache" or path.name.startswith(".")]
