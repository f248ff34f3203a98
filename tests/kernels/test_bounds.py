"""No kernel reaches outside of its arrays: steps of small scenes with kernels that check their indices.

What ends a process that does so has to be in a process of its own (`checked_run`, which says what is checked and what
is not). Scenes that no kernel is left out of are in `small_scenes`.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest
from checked_run import SAMPLE_SIZE, with_checked_pointers
from small_scenes import CASES
from test_signatures import KERNELS

from warpffrf_kernels.core.scalars import BLOCK

RUN = Path(__file__).with_name("checked_run.py")
pytestmark = pytest.mark.slow


def checked(folder: Path, *arguments: object) -> subprocess.CompletedProcess[str]:
    """A process with kernels that check; they are kept between runs, as all others are."""
    cache = Path(os.environ["WARP_CACHE_PATH"])
    return subprocess.run(
        [sys.executable, str(RUN), str(folder), *map(str, arguments)],
        env={**os.environ, "WARP_CACHE_PATH": str(cache.with_name(cache.name + "_checked"))},
        capture_output=True,
        text=True,
    )


@pytest.mark.parametrize("lanes", [1, BLOCK])
def test_all_kernels_stay_inside_their_arrays(lanes: int, tmp_path: Path) -> None:
    """Every kernel is launched, with one lane a block, as on a CPU, and with as many as on a GPU."""
    done = checked(tmp_path, lanes)
    if done.returncode:
        last = [path.read_text().strip() for path in sorted(tmp_path.iterdir())]  # kernel and scene, if it came so far
        pytest.fail(f"{', scene '.join(last)}:\n{done.stderr[-2000:]}")
    found = json.loads((tmp_path / "found.json").read_text())
    assert found["endings"] == {name: case.ends for name, case in CASES.items()}
    names = {f"{kernel.module.name.rsplit('.', 1)[-1]}.{kernel.key}" for kernel in KERNELS.values()}
    never = sorted(names - set(found["launched"]))
    assert not never, f"no scene of small_scenes launches {', '.join(never)}"


SAMPLES = ("write", "write_line", "add", "write_natively", "read_natively")


@pytest.mark.parametrize("sample", SAMPLES)
@pytest.mark.parametrize("at", [-1, SAMPLE_SIZE])
def test_what_is_outside_is_caught(sample: str, at: int, tmp_path: Path) -> None:
    """One entry before the first, and one behind the last."""
    done = checked(tmp_path, 1, sample, at)
    assert done.returncode < 0
    said = f"element {at} of {SAMPLE_SIZE}" if "natively" in sample else "arr.shape["
    assert "Assertion failed" in done.stderr and said in done.stderr


@pytest.mark.parametrize("sample", SAMPLES)
def test_what_is_inside_is_not(sample: str, tmp_path: Path) -> None:
    done = checked(tmp_path, 1, sample, SAMPLE_SIZE - 1)
    assert done.returncode == 0, done.stderr
    left = [0.0] * SAMPLE_SIZE
    left[0 if sample == "read_natively" else -1] = 1.0
    assert json.loads(done.stdout.splitlines()[-1]) == left


@pytest.mark.parametrize("lanes", [1, BLOCK])
def test_lanes_are_as_many_as_asked_for(lanes: int, tmp_path: Path) -> None:
    done = checked(tmp_path, lanes, "count_lanes", 0)
    assert json.loads(done.stdout.splitlines()[-1])[0] == lanes


def test_pointers_are_found_in_native_functions() -> None:
    """Of both types, constant or not, several in one declaration; products are none."""
    text = "const double *p = x.data + a * n, *q = p + b; int* const k = m.list.data; double* __restrict r = y.data;"
    assert with_checked_pointers("f", text) == (
        'checked::Pointer<const double> p = checked::data(x, "f: x", 0) + a * n, q = p + b; '
        'const checked::Pointer<int> k = checked::data(m.list, "f: m.list", 0); '
        'checked::Pointer<double> r = checked::data(y, "f: y", 0);'
    )
