"""The pin in a bore, whole; Persson's closed form for like materials written into the check here."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from demo_files import left_behind

from warpffrf.demos import pin_in_bore as demo
from warpffrf.study.closed_forms import persson


def test_the_whole_demo_passes_and_writes_its_files(tmp_path: Path) -> None:
    assert demo.main(tmp_path / "out", quick=True, progress=False) == 0
    checks = left_behind(tmp_path / "out", "pin_in_bore", "wide")
    assert len(checks) == 3 * 5
    E_star = 0.5 * 210e9  # two like bodies in plane stress
    for clearance, angles in demo.ANGLES.items():
        for angle in angles:
            ratio, peak = persson(np.radians(angle), np.zeros(1))
            load = E_star * clearance * demo.RADIUS / ratio
            label = f"{angle:.0f} deg, clearance {clearance:g}"
            assert checks[f"{label}: force"]["computed"] == pytest.approx(load * demo.WIDTH, rel=1e-6)
            assert checks[f"{label}: peak"]["computed"] == pytest.approx(peak[0] * load / demo.RADIUS, rel=demo.PEAK)


def test_the_material_in_plane_stress_has_its_moduli() -> None:
    plane = demo.IN_PLANE_STRESS
    assert plane.lame[1] == pytest.approx(demo.STEEL.lame[1])
    assert plane.plane_strain_modulus == pytest.approx(demo.STEEL.youngs_modulus)
