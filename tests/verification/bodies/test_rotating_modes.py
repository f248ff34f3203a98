"""Modes of turning bodies: a spinning ring (D3) and a rotating cantilever (D7), with the terms that make them and
without."""

from __future__ import annotations

import numpy as np
import pytest

from scenes.rotating_modes import FLAP, SPIN, THIN_RING, first_flap, in_plane, slender_beam, spinning, thin_ring

THIN = 2e-3  # of a ring's frequencies and lags: shear and rotary inertia at h/R = 0.02 are of order (n h/R)^2
SLENDER = 3e-4  # of lambda_1: 32 cells leave 1.4e-4, and 48 4e-5; the axial strain at gamma = 10 is 7e-5


def test_ring_frequencies_and_the_lag_of_their_patterns() -> None:
    """D3: the two waves around a slowly spinning ring differ by 2 n times the rate at which the pattern falls behind
    the material, 2 SPIN/(n^2 + 1); with constant inertia they do not differ (negative control)."""
    with_terms, without = spinning(thin_ring(), "gyroscopic"), spinning(thin_ring(), "constant")
    for n, frequency in THIN_RING.items():
        low, high = in_plane(with_terms, n)
        lag = (high - low) / (2.0 * n)
        mean = 0.25 * (low + high) / np.pi
        print(f"n = {n}: {mean:.3f} Hz of {frequency}, lag {lag / SPIN:.5f} of {2 / (n * n + 1):.5f}")
        np.testing.assert_allclose(mean, frequency, rtol=THIN)
        np.testing.assert_allclose(lag, 2.0 * SPIN / (n * n + 1), rtol=THIN)
        low, high = in_plane(without, n)
        assert (high - low) / (2.0 * n) < 1e-3 * SPIN
    assert "axes that rotate" in with_terms.report()


@pytest.mark.parametrize("gamma", list(FLAP))
def test_rotating_cantilever_stiffens(gamma: float) -> None:
    """D7."""
    found = first_flap(slender_beam(), gamma, level="full", stiffening=True)
    print(f"gamma = {gamma}: lambda_1 = {found:.5f} of {FLAP[gamma]}")
    np.testing.assert_allclose(found, FLAP[gamma], rtol=SLENDER)


@pytest.mark.parametrize(("gamma", "most"), [(2.0, 0.97), (10.0, 0.89)])
def test_rotating_cantilever_fails_without_stiffening(gamma: float, most: float) -> None:
    """The negative control of D7: of the stiffening by turning, linear deformation knows the part of the floating
    frame, which turns as the beam does on the mean, and misses the part of bending within it."""
    found = first_flap(slender_beam(), gamma, level="full", stiffening=False)
    print(f"gamma = {gamma}: lambda_1 = {found:.5f} of {FLAP[gamma]} without stiffening")
    assert found < most * FLAP[gamma]
