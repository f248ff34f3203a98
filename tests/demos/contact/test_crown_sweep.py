"""The crown sweep on few rows, and where its rollers touch."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pytest
from checks import Check, both_sizes, left_behind, missed

import warpffrf as wf
from demos import crown_sweep as demo
from demos.crown_sweep import HALF_LENGTH, PAIR, RADIUS, STEEL, place, worst
from references.closed_forms import contact_modulus
from references.closed_forms.elliptic import EllipticContact
from warpffrf.study.sweeps.outcome import Sweep, open_sweep

ROOT = Path(__file__).resolve().parents[3]
MODULUS = contact_modulus(STEEL, STEEL)
STORE = "crown_sweep.sweep"
BALANCE = 1e-6  # of the load
WITHIN = 0.85  # of the half-length: an ellipse that ends there is Hertz's; nearer to the end the roller is softer
PEAK, AXIS = 0.01, 0.015  # of peak pressure and half-axis along: eleven strips across, 21 to 27 rows on the length
PLACE = 0.05  # of phi Rc/2: the rollers give way under the moment
SHARP = 1.1  # times the best crown's largest pressure, which straight rollers have, and more
EDGE = 1.1  # times the pressure in the middle, which the end of a straight roller has without tilt, and more


def hertz(curvature: float, load: float) -> EllipticContact:
    """The contact of two crowns that do not end."""
    return EllipticContact(load, 0.5 * RADIUS, 0.5 / curvature, MODULUS)


def best(found: Sweep) -> float:
    """The curvature [1/m] whose largest pressure is least."""
    peak, rows = found["peak"], worst(found)
    return min(rows, key=lambda c: peak[rows[c]])


def within(found: Sweep) -> list[int]:
    """The rows whose ellipse ends before the rollers do."""
    table = zip(found["curvature"], found["load"], found["tilt"], strict=True)
    return [
        n for n, (c, load, tilt) in enumerate(table)
        if c > 0.0 and place(c, tilt) + hertz(c, load).half_axes[1] <= WITHIN * HALF_LENGTH
    ]  # fmt: skip


def checks(found: Sweep, again: wf.Result) -> list[Check]:
    """Of all rows, compared with statics, Hertz and the geometry of two crowns; of the best crown; `again`: its worst
    row, run by itself."""
    peak, load, tilt, curvature = (found[name] for name in ("peak", "load", "tilt", "curvature"))
    rows = within(found)
    exact = [hertz(curvature[n], load[n]) for n in rows]
    of_peak = [peak[n] / h.peak_pressure - 1.0 for n, h in zip(rows, exact, strict=True)]
    of_axis = [found["half_widths"][n, 1] / h.half_axes[1] - 1.0 for n, h in zip(rows, exact, strict=True)]
    leaning = [n for n in rows if tilt[n] > 0.0]
    of_place = [-found["center"][n, 1] / place(curvature[n], tilt[n]) - 1.0 for n in leaning]
    of_force = np.linalg.norm(found["force"], axis=1) / load - 1.0
    least, of_worst = best(found), worst(found)
    edges = found["pressures"][(curvature == 0.0) & (tilt == 0.0)]
    at_edge = [float(row[0] / row[np.isfinite(row)][np.isfinite(row).sum() // 2]) for row in edges]
    completed = found.counts.get("completed", 0)
    ratio = peak[of_worst[0.0]] / peak[of_worst[least]]
    return [
        Check("rows that were completed", completed, found.count, "all", 0.0),
        Check("force of all rows, off by", _largest(of_force), 0.0, "statics", BALANCE, scale=1.0),
        Check(f"peak pressure of {len(rows)} rows, off by", _largest(of_peak), 0.0, "Hertz", PEAK, scale=1.0),
        Check(f"half-axis along of {len(rows)} rows, off by", _largest(of_axis), 0.0, "Hertz", AXIS, scale=1.0),
        Check(f"place of {len(leaning)} tilted rows, off by", _largest(of_place), 0.0, "phi Rc/2", PLACE, scale=1.0),
        Check("straight: end over middle, cut at", min(*at_edge, EDGE), EDGE, "edges", 0.0),
        Check("straight: largest peak over the best's, cut at", min(ratio, SHARP), SHARP, "edges under tilt", 0.0),
        Check("best crown, largest peak: run by itself", float(again.contact(PAIR).peak_pressure[-1]),
              float(peak[of_worst[least]]), "the sweep, bit for bit", 0.0, "MPa", 1e-6),
    ]  # fmt: skip


def _largest(errors: Sequence[float] | np.ndarray) -> float:
    """That of the largest size."""
    return float(max(errors, key=abs))


def test_the_rollers_of_every_row_just_touch() -> None:
    """Two arcs z^2/(2 Rc) and a slope: the axes are as much farther apart as z^2/Rc - phi z is below 0 at its least."""
    z = np.linspace(-demo.HALF_LENGTH, demo.HALF_LENGTH, 160_001)
    for curvature in demo.FULL.curvatures:
        for tilt in demo.FULL.tilts:
            lowest = (curvature * z**2 - tilt * z).min()
            assert demo.lift(curvature, tilt) == pytest.approx(-lowest, abs=1e-15)  # (5e-8 m)^2 of the samples, over Rc
    assert demo.place(1 / 4, 1e-3) == pytest.approx(2e-3)


@both_sizes
def test_the_whole_demo(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, quick: bool) -> None:
    few = demo.Size(curvatures=(0.0, 1 / 8, 1 / 2), loads=(4000.0,), tilts=(0.0, 1e-3))
    monkeypatch.setattr(demo, "QUICK", few)
    monkeypatch.setattr(demo, "WORKERS", 1)
    (again,) = demo.main(tmp_path, quick=quick, progress=False)
    rows = 6 if quick else 60
    page = (tmp_path / "crown_sweep.html").read_text(encoding="utf-8")
    assert f"{rows} rows of equilibrium: {rows} completed." in page and page.count("<svg") >= 5
    found = checks(open_sweep(tmp_path / STORE), again)
    assert not missed(found)
    if quick:
        assert "peak pressure of 2 rows, off by" in {check.name for check in found}
    shutil.rmtree(tmp_path / STORE)
    (tmp_path / "crown_sweep.html").unlink()
    left_behind(tmp_path, "crown_sweep")


@pytest.mark.slow
@pytest.mark.parametrize("by", ["command", "script"])
def test_workers_of_the_command_and_of_the_script_import_the_scene(tmp_path: Path, by: str) -> None:
    """From another folder: the functions of a sweep are in a module of the path, or in the script itself."""
    script = tmp_path / "sweep_script.py"
    text = (ROOT / "demos" / "crown_sweep.py").read_text(encoding="utf-8")
    script.write_text(text.replace("    main()\n", "    main(quick=True)\n"), encoding="utf-8")
    words = ["-m", "warpffrf", "demo", "crown-sweep", "--quick"] if by == "command" else [script.name]
    path = os.pathsep.join([str(ROOT), str(ROOT / "kernels")])
    done = subprocess.run(
        [sys.executable, *words], cwd=tmp_path, env={**os.environ, "PYTHONPATH": path}, capture_output=True, text=True
    )
    assert done.returncode == 0, done.stderr
    assert "the best" in done.stdout
    assert open_sweep(tmp_path / "out" / "crown_sweep" / STORE).counts == {"completed": 12}
