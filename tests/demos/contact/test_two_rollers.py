"""The two-roller demo on a small mesh, against statics and Hertz, and its files and summary."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from checks import left_behind

import warpffrf as wf
from demos import two_rollers as demo
from warpffrf.study.machine import ONE_THREAD, unit_seconds

# A higher load widens the patch, so that a coarser mesh still has five elements a half-width.
SMALL = demo.Size(sectors=1600, layers=18, axial=2)
LOAD, LOAD_AFTER = 80e3, 84e3  # N
BALANCE = 1e-9  # of the force: what Newton leaves of the balance
HALF_WIDTH, PEAK = 0.02, 0.03  # against Hertz: nodes of a fifth of the half-width, three nodes along the axis


@pytest.fixture(scope="module")
def scene() -> wf.Scene:
    return demo.build(SMALL, load=LOAD, load_after=LOAD_AFTER, progress=False)


def test_nothing_is_redundant_and_nothing_loose(scene: wf.Scene) -> None:
    check = scene.check()
    assert not check.redundant and not check.unsupported
    modes = sum(check.modes.values())
    assert check.degrees_of_freedom == modes + 1  # two driven axles: the guide is the only free rigid motion


def test_the_pressed_pair_carries_the_load_and_is_hertzian(scene: wf.Scene) -> None:
    result = wf.equilibrium(scene)
    assert result.status == "completed", result.message
    pair = result.contact(demo.PAIR)
    assert pair.force_magnitude[-1] == pytest.approx(demo.static_force(scene, result, LOAD), rel=BALANCE)
    # Hertz in closed form here, not from the product: two equal steel cylinders at the line load found at mid-width
    E_star, R = 210e9 / (2 * (1 - 0.3**2)), demo.OUTER_RADIUS / 2
    a = np.sqrt(4 * pair.line_load[-1] * R / (np.pi * E_star))
    assert pair.half_width[-1] == pytest.approx(a, rel=HALF_WIDTH)
    assert pair.mid_peak_pressure[-1] == pytest.approx(2 * pair.line_load[-1] / (np.pi * a), rel=PEAK)
    # the ends are free, so they carry less than the middle, and the middle more than the mean
    assert LOAD / demo.WIDTH < pair.line_load[-1] < 1.1 * LOAD / demo.WIDTH


def test_the_whole_demo(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture) -> None:
    monkeypatch.setattr(demo, "QUICK", demo.Size(sectors=360, layers=8, axial=2))
    monkeypatch.setattr(demo, "DURATION", 0.03)
    monkeypatch.setattr(demo, "LOAD_STEP_AT", 0.005)
    (result,) = demo.main(tmp_path / "new" / "out", quick=True, progress=False)
    left_behind(tmp_path / "new" / "out", "two_rollers")
    said = capsys.readouterr().out
    assert result.status == "completed" and "statics" in said and "Hertz" in said
    roller: Any = result.scene.body("lower").reduced
    assert roller.local_modes == 360 * 3 and roller.report["dofs"] == 360 * 9 * 3 * 3
    contact = result.contact(demo.PAIR)
    static = demo.static_force(result.scene, result, demo.LOAD_AFTER)
    assert demo.settled(result, contact.force_magnitude) == pytest.approx(static, rel=0.01)  # the coarse grid ripples
    stored = wf.Result.load(tmp_path / "new" / "out" / "two_rollers.h5").contact(demo.PAIR)
    np.testing.assert_array_equal(stored.half_width, contact.half_width)


@pytest.mark.slow
def test_the_demo_in_full_is_hertzian(tmp_path: Path) -> None:
    (result,) = demo.main(tmp_path, progress=False)
    contact, rows = result.contact(demo.PAIR), np.flatnonzero(result.time >= result.time[-1] - demo.SETTLED)
    hertz = np.mean([contact.hertz(int(i)).peak_pressure for i in rows])
    assert demo.settled(result, contact.mid_peak_pressure) == pytest.approx(hertz, rel=0.01)
    static = demo.static_force(result.scene, result, demo.LOAD_AFTER)
    assert demo.settled(result, contact.force_magnitude) == pytest.approx(static, rel=1e-4)


@pytest.mark.slow
def test_the_script_runs_by_itself(tmp_path: Path) -> None:
    """From another folder, without anything of a checkout but the package: its figures are those of the command."""
    root = Path(__file__).resolve().parents[3]
    done = subprocess.run(
        [sys.executable, root / "demos" / "elastica.py"],
        cwd=tmp_path,
        env={**os.environ, "PYTHONPATH": os.pathsep.join([str(root), str(root / "kernels")])},
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0 and "elastica" in done.stdout, done.stderr
    left_behind(tmp_path / "out" / "elastica", "elastica")


def test_the_unit_of_time_is_that_of_one_thread(monkeypatch: pytest.MonkeyPatch) -> None:
    """It is timed in a process of its own, whose BLAS takes one thread, whatever this one has."""
    seen = []
    real = subprocess.run

    def watched(*args, **options):
        seen.append(options["env"])
        return real(*args, **options)

    monkeypatch.setenv("OPENBLAS_NUM_THREADS", "4")
    monkeypatch.setattr(subprocess, "run", watched)
    assert unit_seconds() > 0.0
    assert len(seen) == 1 and all(seen[0][name] == "1" for name in ONE_THREAD)
