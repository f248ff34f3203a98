"""The two-roller demo on a small mesh, against statics and Hertz, and its files and summary."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import warpffrf as wf
from demos import two_rollers as demo
from warpffrf.study.machine import ONE_THREAD, unit_seconds

# A higher load widens the patch, so that a coarser mesh still has five elements a half-width.
SMALL = demo.Size(sectors=1600, layers=18, axial=2, frames=5)
LOAD, LOAD_AFTER = 80e3, 84e3  # N
BALANCE = 1e-9  # of the force: what Newton leaves of the balance
HALF_WIDTH, PEAK = 0.02, 0.03  # against Hertz: hats of a fifth of the half-width, three nodes along the axis
KEYS = {
    "contact_force", "half_width", "peak_pressure", "hertz_half_width", "hertz_peak_pressure", "local_modes_per_body",
    "fe_dofs_per_body", "steps", "offline_seconds", "online_seconds", "unit_seconds", "status",
}  # fmt: skip


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


def test_the_whole_demo_writes_its_files(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    coarse = demo.Size(sectors=360, layers=8, axial=2, frames=5)
    monkeypatch.setattr(demo, "QUICK", coarse)
    monkeypatch.setattr(demo, "DURATION", 0.03)
    monkeypatch.setattr(demo, "LOAD_STEP_AT", 0.005)
    assert demo.main(tmp_path / "new" / "out", quick=True, progress=False) == 0
    folder = tmp_path / "new" / "out"
    assert {f"two_rollers.{e}" for e in ("h5", "rrd", "png")} | {"summary.json"} == {p.name for p in folder.iterdir()}
    figures = json.loads((folder / "summary.json").read_text(encoding="utf-8"))
    assert set(figures) >= KEYS and figures["status"] == "completed"
    assert figures["local_modes_per_body"] == 360 * 3 and figures["fe_dofs_per_body"] == 360 * 9 * 3 * 3
    assert figures["contact_force"] == pytest.approx(figures["static_force"], rel=0.01)  # the coarse grid ripples
    stored = wf.Result.load(folder / "two_rollers.h5").contact(demo.PAIR)
    assert stored.half_width[-100:].mean() == pytest.approx(figures["half_width"], rel=0.01)


def test_a_folder_that_cannot_be_made_is_refused(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    with pytest.raises(wf.InputError, match="cannot write"):
        demo.main(tmp_path / "file" / "out")


def test_the_script_of_the_checkout_is_the_command_of_the_package() -> None:
    root = Path(__file__).resolve().parents[2]
    path = os.pathsep.join([str(root), str(root / "kernels")])
    done = subprocess.run(
        [sys.executable, root / "demos" / "two_rollers.py", "--help"],
        env={**os.environ, "PYTHONPATH": path},
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0 and "--quick" in done.stdout, done.stderr


def test_the_unit_of_time_is_that_of_one_thread(monkeypatch: pytest.MonkeyPatch) -> None:
    """It is timed in a process of its own, whose BLAS is told to take one thread, whatever this one has."""
    seen = []
    real = subprocess.run

    def watched(*args, **options):
        seen.append(options["env"])
        return real(*args, **options)

    monkeypatch.setenv("OPENBLAS_NUM_THREADS", "4")
    monkeypatch.setattr(subprocess, "run", watched)
    assert unit_seconds() > 0.0
    assert len(seen) == 1 and all(seen[0][name] == "1" for name in ONE_THREAD)
