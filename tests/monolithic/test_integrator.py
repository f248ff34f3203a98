"""Coefficients: spectra at infinite frequency, order 2 (D8), and what is refused."""

from __future__ import annotations

import numpy as np
import pytest

from warpffrf import monolithic
from warpffrf.model import forces, joints
from warpffrf.model.errors import InputError
from warpffrf.model.scene import Scene
from warpffrf.monolithic.integrator import Coefficients, amplification, coefficients_of, generalized_alpha, hht, newmark
from warpffrf.online import GeneralizedAlpha

INFINITE = 1e8  # omega h; eigenvalues differ from the limit by its inverse, double ones by its root


def roots(c: Coefficients, omega_h: float = INFINITE) -> np.ndarray:
    """Eigenvalues of a step, the trivial zero left out."""
    found = np.linalg.eigvals(amplification(c, omega_h))
    return found[np.argsort(-np.abs(found))][:3]


def test_roots_of_hht_at_infinity() -> None:
    """D8: alpha = -0.3: -0.538 twice, -0.429; in general (1 + alpha)/(alpha - 1) twice and alpha/(1 + alpha)."""
    for alpha in (-0.3, -0.1, -0.05):
        expected = [(1.0 + alpha) / (alpha - 1.0)] * 2 + [alpha / (1.0 + alpha)]
        assert np.abs(np.sort(np.real(roots(hht(alpha)))) - np.sort(expected)).max() < 1e-3
    assert np.abs(np.sort(np.real(roots(hht(-0.3)))) - [-0.538, -0.538, -0.429]).max() < 1e-3


def test_spectral_radius_of_generalized_alpha_at_infinity() -> None:
    for rho in (0.0, 0.5, 0.8, 1.0):
        assert np.abs(roots(generalized_alpha(rho))).max() == pytest.approx(rho, abs=1e-3)


def test_no_frequency_is_amplified() -> None:
    for c in (hht(), hht(0.0), generalized_alpha(0.8), newmark()):
        assert max(np.abs(roots(c, s)).max() for s in np.geomspace(1e-3, 1e6, 60)) < 1.0 + 1e-9


def oscillator(step: float, duration: float, integrator: object) -> float:
    """Error of the place of a mass on a spring after `duration` [s], of the amplitude; 7 rad/s, 1 m."""
    mass, omega = 2.0, 7.0
    scene = Scene()
    body = scene.add_rigid_body(mass, (0.1, 0.1, 0.1), name="b", velocity=(omega, 0.0, 0.0))
    slide = scene.add(joints.Prismatic(scene.ground, body.at((0, 0, 0)), axis=(1, 0, 0), name="slide"))
    scene.add(forces.JointSpringDamper(slide, mass * omega**2))
    history = monolithic.run(scene, duration, step=step, integrator=integrator, progress=False)
    assert history.status == "completed", history.message
    return abs(float(history.bodies["b"].position[-1, 0]) - np.sin(omega * duration))


@pytest.mark.parametrize("integrator", [hht(-0.3), hht(-0.1), generalized_alpha(0.8), newmark()])
def test_order_two_on_an_oscillator(integrator: Coefficients) -> None:
    """D8: measured orders 2 within 0.1."""
    errors = [oscillator(h, 1.0, integrator) for h in (8e-3, 4e-3, 2e-3)]
    assert np.abs(np.log2(np.array(errors[:-1]) / errors[1:]) - 2.0).max() < 0.1


def test_coefficients_of_the_separated_integrator_are_the_same() -> None:
    c, g = generalized_alpha(0.7), coefficients_of(GeneralizedAlpha(0.7))
    assert (c.alpha_m, c.alpha_f, c.beta, c.gamma) == pytest.approx((g.alpha_m, g.alpha_f, g.beta, g.gamma), abs=1e-15)
    assert coefficients_of(None) == hht(-0.3)


def test_bad_coefficients_are_refused() -> None:
    for wrong in (lambda: hht(-0.5), lambda: hht(0.1), lambda: generalized_alpha(1.2), lambda: newmark(beta=0.0)):
        with pytest.raises(InputError):
            wrong()
    with pytest.raises(InputError, match="alpha_m"):
        coefficients_of("fast")
