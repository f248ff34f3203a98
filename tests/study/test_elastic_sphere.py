"""The elastic sphere of case C3: its harmonics by finite differences, and what it tends to."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.special import eval_legendre

from references.closed_forms.elastic_sphere import approach_correction, harmonic
from warpffrf.model.errors import InputError
from warpffrf.model.material import Material

STEEL = Material(210e9, 0.3, 7800.0)
STEP = 1e-3  # of the differences, on a unit sphere


def displacement(x: np.ndarray, n: int) -> np.ndarray:
    """u (3,) of harmonic n at x, axis z."""
    A, B = harmonic(n, STEEL)
    nu = STEEL.poisson_ratio
    r = np.linalg.norm(x)
    c = x[2] / r
    s = np.sqrt(1.0 - c * c)
    slope = -s * n * (c * eval_legendre(n, c) - eval_legendre(n - 1, c)) / (c * c - 1.0)  # dP_n/dtheta
    radial = (A * (n + 1) * (n - 2 + 4.0 * nu) * r ** (n + 1) + B * n * r ** (n - 1)) * eval_legendre(n, c)
    around = (A * (n + 5 - 4.0 * nu) * r ** (n + 1) + B * r ** (n - 1)) * slope
    e_r = x / r
    e_t = (c * e_r - np.array([0.0, 0.0, 1.0])) / s
    return radial * e_r + around * e_t


def stress(x: np.ndarray, n: int) -> np.ndarray:
    lame, G = STEEL.lame
    grad = np.array([
        (displacement(x + STEP * e, n) - displacement(x - STEP * e, n)) / (2.0 * STEP) for e in np.eye(3)
    ])  # fmt: skip
    return G * (grad + grad.T) + lame * np.trace(grad) * np.eye(3)


@pytest.mark.parametrize("n", [2, 3, 5])
def test_harmonics(n: int) -> None:
    """Traction P_n along the normal, none across it, and no body force inside."""
    for angle in (0.4, 1.3):
        normal = np.array([np.sin(angle), 0.0, np.cos(angle)])
        traction = stress(normal, n) @ normal
        np.testing.assert_allclose(traction, eval_legendre(n, np.cos(angle)) * normal, atol=1e-4)
        x = 0.6 * normal
        force = sum(
            (stress(x + STEP * e, n)[i] - stress(x - STEP * e, n)[i]) / (2.0 * STEP) for i, e in enumerate(np.eye(3))
        )
        np.testing.assert_allclose(force, 0.0, atol=1e-4)


def test_a_small_patch_sees_a_half_space() -> None:
    """The correction is (a/R)(alpha + beta ln(a/R)): that of a point load, and of the curvature of the sphere."""
    small, large = (approach_correction(a, 0.01, STEEL) for a in (2.5e-5, 1e-4))
    assert -0.01 < large < small < 0.0
    middle = approach_correction(5e-5, 0.01, STEEL)
    slopes = np.array([small / 2.5e-5, middle / 5e-5, large / 1e-4])
    assert slopes[1] - slopes[0] == pytest.approx(slopes[2] - slopes[1], abs=0.02 * abs(slopes[1]))
    assert approach_correction(1e-4, 0.02, STEEL) == pytest.approx(middle, rel=1e-3)  # of a/R alone
    with pytest.raises(InputError, match="not small"):
        approach_correction(3e-3, 0.01, STEEL)
