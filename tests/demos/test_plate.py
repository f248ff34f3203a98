"""The clamped plate, whole; what membrane energy is for; cycles of a swing that is known."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from demo_files import left_behind

from demos import plate as demo
from references.closed_forms.large_deflections import clamped_plate_frequency

SMALL = demo.Size(cells=4, loads=(402.0,), let_go=())


def test_the_whole_demo_passes_and_writes_its_files(tmp_path: Path) -> None:
    assert demo.main(tmp_path / "out", quick=True, progress=False) == 0
    checks = left_behind(tmp_path / "out", "plate", "pressed", "dying")
    assert len(checks) == 11
    assert checks["A/t = 1: frequency over the first"]["computed"] > 1.1


def test_without_membrane_energy_the_plate_goes_nearly_three_times_as_far() -> None:
    """The closed form of a plate that bends alone, and 4 % of coarse cells."""
    scene = demo.build(SMALL, progress=False)
    scene.body("plate").stiffening = False
    bent = float(demo.deflection(demo.press(scene, SMALL.loads, progress=False))[-1])
    assert bent == pytest.approx(402.0 * demo.SMALL, rel=0.08)
    full = demo.full_model(SMALL).w[-1]
    assert 2.7 < bent / full < 3.0


def test_cycles_of_a_known_swing() -> None:
    """A cosine that dies out by a hundredth a cycle."""
    t = np.linspace(0.0, 20.0, 1201)
    swing = demo.Swing(t, np.exp(-0.01 * t) * np.cos(2.0 * np.pi * t))
    A, f = swing.cycles
    np.testing.assert_allclose(f, 1.0, rtol=1e-4)
    np.testing.assert_allclose(A, np.exp(-0.01 * (np.arange(len(A)) + 1.25)), rtol=5e-3)
    assert swing.frequency(0.9) == pytest.approx(1.0, rel=1e-4)


def test_one_term_by_fourier_series() -> None:
    """V_m/V_b of w = (A/4)(1 + cos kx)(1 + cos ky): Airy's function solved on a grid, mean strains by mean slopes."""
    nu, n = 0.3, 32
    x = np.arange(n) / n
    X, Y = np.meshgrid(2.0 * np.pi * x, 2.0 * np.pi * x, indexing="ij")
    k = 2.0 * np.pi  # a = E = t = A = 1
    wx = -0.25 * k * np.sin(X) * (1.0 + np.cos(Y))
    wxx = -0.25 * k**2 * np.cos(X) * (1.0 + np.cos(Y))
    wxy = 0.25 * k**2 * np.sin(X) * np.sin(Y)
    load = np.fft.fft2(wxy**2 - wxx * wxx.T)
    m = k * np.fft.fftfreq(n, 1.0 / n)
    square = m[:, None] ** 2 + m[None] ** 2
    square[0, 0] = np.inf
    lap = np.fft.ifft2(load / -square).real
    strain = 0.5 * np.mean(wx**2)
    stretched = 0.5 * np.mean(lap**2) + strain**2 / (1.0 - nu)
    bent = np.pi**4 / (12.0 * (1.0 - nu**2))
    amplitude = 1e-2
    expected = 1.0 + 0.375 * 2.0 * stretched / bent * amplitude**2
    assert clamped_plate_frequency(amplitude, nu) - 1.0 == pytest.approx(expected - 1.0, rel=1e-3)
