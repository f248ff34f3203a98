"""The spun-up beam against the beam equation with tension; without stiffening it must fail the same checks."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from checks import Check, both_sizes, left_behind, missed

from demos import spinning_beam as demo
from demos.spinning_beam import AXIAL_STIFFNESS, BENDING_STIFFNESS, LENGTH, LINE_MASS, SPEED, SPIN_UP

POLYNOMIALS, MODES_OF_REFERENCE = 8, 3  # x^2 to x^9, and the natural modes of the clamped beam made of them
LAG, ELONGATION = 0.01, 1e-3


def hub_motion(t: Any) -> tuple[Any, Any, Any]:
    """Angle [rad], speed [rad/s] and angular acceleration [rad/s2] of the hub at times t [s]."""
    x = np.clip(np.asarray(t, float) / SPIN_UP, 0.0, 1.0)
    angle = SPEED * SPIN_UP * x**4 * (2.5 - 3.0 * x + x**2) + SPEED * np.maximum(np.asarray(t, float) - SPIN_UP, 0.0)
    return angle, SPEED * x**3 * (10.0 - 15.0 * x + 6.0 * x**2), SPEED / SPIN_UP * 30.0 * (x * (1.0 - x)) ** 2


def beam_tip(t: np.ndarray, *, tension: bool = True) -> np.ndarray:
    """Deflection of the tip (T,) [m] in the plane, in the hub's frame, by the equation of the demo.

    Galerkin's method with polynomials in x that are clamped at the hub, and SciPy in time.
    """
    from scipy.integrate import solve_ivp
    from scipy.linalg import eigh

    xi, weights = np.polynomial.legendre.leggauss(POLYNOMIALS + 4)  # exact for products with (L^2 - x^2)
    x, weights = 0.5 * (xi + 1.0), 0.5 * weights  # of the length
    p = np.arange(2, 2 + POLYNOMIALS, dtype=float)[:, None]
    shape, slope, bend = x**p, p * x ** (p - 1.0), p * (p - 1.0) * x ** (p - 2.0)

    def integral(a: np.ndarray, b: np.ndarray) -> np.ndarray:
        return (a * weights) @ b.T

    M = LINE_MASS * LENGTH * integral(shape, shape)
    K = BENDING_STIFFNESS / LENGTH**3 * integral(bend, bend)
    K_N = 0.5 * LINE_MASS * LENGTH * integral(slope * (1.0 - x**2), slope) * float(tension)  # times omega^2
    F = LINE_MASS * LENGTH**2 * (shape * weights) @ x  # times -alpha
    modes = eigh(K, M)[1][:, :MODES_OF_REFERENCE]
    K, K_N, F = modes.T @ K @ modes, modes.T @ K_N @ modes, modes.T @ F

    def rates(time: float, y: np.ndarray) -> np.ndarray:
        w, v = np.split(y, 2)
        _, omega, alpha = hub_motion(time)
        return np.concatenate([v, -K @ w - omega**2 * (K_N @ w - w) - alpha * F])

    start = np.zeros(2 * MODES_OF_REFERENCE)
    found = solve_ivp(rates, (0.0, t[-1]), start, t_eval=t, rtol=1e-7, atol=1e-9, method="DOP853")
    return modes.sum(axis=0) @ found.y[:MODES_OF_REFERENCE]


def checks(t: np.ndarray, elongation: np.ndarray, deflection: np.ndarray, beam: np.ndarray) -> list[Check]:
    """The figures of the stiffened beam; elongation, deflection (T,) m of its tip, and that of the beam equation."""
    k = SPEED * np.sqrt(LINE_MASS / AXIAL_STIFFNESS)
    lag = float(-beam.min())
    return [
        Check("largest lag of the tip", float(-deflection.min()), lag, "beam equation", LAG, "m"),
        Check("largest difference of the deflection", float(np.abs(deflection - beam).max()), 0.0,
              "beam equation, over the lag", LAG, "m", scale=lag),
        Check("elongation at the final speed", float(elongation[t > SPIN_UP].mean()),
              float(np.tan(k * LENGTH) / k - LENGTH), "tan(kL)/k - L", ELONGATION, "mm", 1e3),
    ]  # fmt: skip


SHORT = demo.QUICK
FIRST = 3.516015  # lambda of a clamped beam, omega = lambda sqrt(EI / (rho A L^4))


def test_the_reference_has_the_frequency_and_the_lag_of_a_clamped_beam() -> None:
    """At a speed that rises slowly from zero the lag is that under -rho A alpha x, 11/120 rho A alpha L^5 / EI."""
    t = np.linspace(0.0, 2.0, 400)
    slow = beam_tip(t)
    static = -11.0 / 120.0 * demo.LINE_MASS * hub_motion(t)[2] * demo.LENGTH**5 / demo.BENDING_STIFFNESS
    late = t > 1.0
    omega_1 = FIRST * np.sqrt(demo.BENDING_STIFFNESS / demo.LINE_MASS) / demo.LENGTH**2
    # an oscillator under a load that rises as t^2 follows it up to 2/omega_1^2 of its curvature and as much ringing
    curvature = np.abs(np.gradient(np.gradient(static, t), t)).max()
    assert np.abs(slow - static)[late].max() < 4.0 * curvature / omega_1**2
    assert slow[late].mean() == pytest.approx(static[late].mean(), rel=0.2)


@pytest.fixture(scope="module")
def runs() -> dict[bool, list]:
    found = {}
    for stiffening in (True, False):
        scene, result = demo.run(SHORT, stiffening=stiffening, progress=False)
        assert result.status == "completed", result.message
        u, w = demo.tip_in_hub_frame(scene, result)
        found[stiffening] = checks(result.time, u, w, beam_tip(result.time))
    return found


@pytest.mark.slow
def test_the_stiffened_beam_follows_the_beam_equation(runs: dict[bool, list]) -> None:
    assert not missed(runs[True])


def test_without_stiffening_the_lag_is_wrong(runs: dict[bool, list]) -> None:
    lag, difference, _ = runs[False]
    assert lag.error > 0.1 and difference.error > 0.2


@both_sizes
def test_the_whole_demo(tmp_path: Path, quick: bool) -> None:
    result, bare = demo.main(tmp_path, quick=quick, progress=False)
    left_behind(tmp_path, "spinning_beam")
    assert bare.status == "completed"
    u, w = demo.tip_in_hub_frame(result.scene, result)
    assert not missed(checks(result.time, u, w, beam_tip(result.time)))
