"""Processes that begin at once: with one results file, one body to be reduced, and one empty cache of kernels. All end
right, or one says why it may not."""

from __future__ import annotations

import os
import shutil
import signal
import subprocess
import sys
from pathlib import Path

import pytest
from test_unfinished import BEFORE_LONG, PROGRAM, same
from unfinished_runs import reduced, simulate

import warpffrf as wf

COMPILED = 900.0  # s, until four processes have compiled what a run of rigid bodies needs, on two cores under load
KILLED_AFTER = (5.0, 20.0, 40.0)  # s, while kernels are compiled

Ended = list[tuple[int, str, str]]


def programs(count: int, case: str, results: list[Path], timeout: float, **environment: str) -> Ended:
    """Exit code, what was said and errors of so many programs at once."""
    running = [
        subprocess.Popen(
            [sys.executable, str(PROGRAM), case, str(results[n])], stdout=subprocess.PIPE, stderr=subprocess.PIPE,
            text=True, env={**os.environ, **environment},
        )
        for n in range(count)
    ]  # fmt: skip
    return [(program.wait(timeout), *program.communicate()) for program in running]


@pytest.mark.slow
def test_runs_into_one_file(tmp_path: Path) -> None:
    file = tmp_path / "run.h5"
    ended = programs(3, "plain", [file] * 3, BEFORE_LONG)
    right = [said for code, said, _ in ended if code == 0]
    refused = [errors for code, _, errors in ended if code != 0]
    assert right and all("status completed" in said for said in right)
    assert all("another run is writing" in errors or "exists; choose another name" in errors for errors in refused)
    assert same(simulate("plain", None).history, wf.Result.load(file).history) == []
    assert [path.name for path in tmp_path.iterdir()] == ["run.h5"]


@pytest.mark.slow
def test_reductions_of_one_body(tmp_path: Path) -> None:
    files = [tmp_path / f"{n}.h5" for n in range(3)]
    assert [code for code, _, _ in programs(3, "reduced", files, BEFORE_LONG)] == [0, 0, 0]
    found = {wf.ReducedBody.load(file).content_hash() for file in files}
    assert found == {reduced(tmp_path / "whole" / "run.h5").content_hash()}
    assert len(list((tmp_path / "cache").glob("*.h5"))) == 1 and not list(tmp_path.rglob("*.part"))


@pytest.mark.slow
def test_an_empty_cache_of_kernels(tmp_path: Path) -> None:
    """Killed a few times while it is filled, then filled by four processes."""
    files = [tmp_path / f"{n}.h5" for n in range(4)]
    kernels = {"WARP_CACHE_PATH": str(tmp_path / "kernels")}
    for n, seconds in enumerate(KILLED_AFTER):
        program = subprocess.Popen(
            [sys.executable, str(PROGRAM), "sparse", str(files[0])], stdout=subprocess.PIPE, stderr=subprocess.PIPE,
            text=True, env={**os.environ, **kernels},
        )  # fmt: skip
        try:
            program.wait(seconds)
        except subprocess.TimeoutExpired:
            program.send_signal((signal.SIGKILL, signal.SIGTERM, signal.SIGINT)[n])
        program.communicate(timeout=COMPILED)
    for file in tmp_path.glob("*.h5*"):  # of a program that was fast enough to end, or to begin
        shutil.rmtree(file) if file.is_dir() else file.unlink()
    ended = programs(4, "sparse", files, COMPILED, **kernels)
    assert [code for code, _, _ in ended] == [0] * 4, [errors for *_, errors in ended]
    whole = simulate("sparse", None).history
    assert [same(whole, wf.Result.load(file).history) for file in files] == [[]] * 4
