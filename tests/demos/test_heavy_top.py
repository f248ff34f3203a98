"""The heavy top against its published position, shown as a rate, and the files of a whole demo."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from checks import Check, both_sizes, left_behind, missed

import warpffrf as wf
from demos import heavy_top as demo
from demos.heavy_top import AFTER_ONE_SECOND, ENERGY

ERROR_PER_STEP2, ERROR_PER_STEP4 = 1e4, 3e7
REFERENCE_DIGITS = 2e-9  # m
DRIFT = 1e-6  # of the energy: dissipation at the coarser step


def checks(coarse: wf.Result, fine: wf.Result, step: float) -> list[Check]:
    """The figures of two runs, at `step` [s] and at half of it."""
    x_h, x = (result.body("top").position[-1] for result in (coarse, fine))
    best = x + (x - x_h) / 3.0
    off = [float(np.linalg.norm(p - AFTER_ONE_SECOND)) for p in (x_h, x)]
    energy = fine.energy["kinetic"] + fine.energy["potential"]
    leave = max(ERROR_PER_STEP4 * step**4, REFERENCE_DIGITS)
    found = [
        Check(f"{axis} after 1 s, step {step / 2:g} s", x[i], AFTER_ONE_SECOND[i], "published",
              0.25 * ERROR_PER_STEP2 * step**2, "m", scale=1.0)
        for i, axis in enumerate("xyz")
    ]  # fmt: skip
    found += [
        Check(f"{axis} after 1 s, extrapolated", best[i], AFTER_ONE_SECOND[i], "published", leave, "m", scale=1.0)
        for i, axis in enumerate("xyz")
    ]
    return [
        *found,
        Check("order of the error", float(np.log2(off[0] / off[1])), 2.0, "generalized-alpha", 0.05),
        Check("energy at the start", float(energy[0]), ENERGY, "closed form", 1e-9, "J"),
        Check("energy at the end", float(energy[-1]), ENERGY, "conserved", DRIFT, "J"),
    ]


def test_the_error_falls_with_the_square_of_the_step() -> None:
    errors = [
        np.linalg.norm(demo.run(step).body("top").position[-1] - demo.AFTER_ONE_SECOND) for step in (4e-4, 2e-4, 1e-4)
    ]
    assert np.log2(np.array(errors[:-1]) / errors[1:]) == pytest.approx(2.0, abs=0.05)


def test_the_energy_of_the_start_is_that_of_its_closed_form() -> None:
    spin, arm = demo.SPIN, demo.ARM
    kinetic = 0.5 * demo.MASS * np.sum(np.cross(spin, arm) ** 2) + 0.5 * np.sum(np.array(demo.INERTIA) * spin**2)
    assert kinetic == pytest.approx(demo.ENERGY, rel=1e-9)


@both_sizes
def test_the_whole_demo(tmp_path: Path, capsys: pytest.CaptureFixture, quick: bool) -> None:
    fine, coarse = demo.main(tmp_path, quick=quick, progress=False)
    left_behind(tmp_path, "heavy_top", "coarse")
    found = checks(coarse, fine, demo.QUICK_STEP if quick else demo.STEP)
    assert len(found) == 9 and not missed(found)
    assert "order of the error" in capsys.readouterr().out
