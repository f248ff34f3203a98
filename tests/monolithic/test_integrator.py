"""The integrators on the reference: order 2 (D8), and what is refused. Their spectra: tests/online/test_integrators."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from references import monolithic
from references.monolithic.core.integrator import coefficients_of
from warpffrf.model import forces, joints
from warpffrf.model.errors import InputError
from warpffrf.model.integrators import HHT, GeneralizedAlpha, Newmark, RungeKutta4
from warpffrf.model.scene import Scene


def oscillator(step: float, duration: float, integrator: Any) -> float:
    """Error of the place of a mass on a spring after `duration` [s], of the amplitude; 7 rad/s, 1 m."""
    mass, omega = 2.0, 7.0
    scene = Scene()
    body = scene.add_rigid_body(mass, (0.1, 0.1, 0.1), name="b", velocity=(omega, 0.0, 0.0))
    slide = scene.add(joints.Prismatic(scene.ground, body.at((0, 0, 0)), axis=(1, 0, 0), name="slide"))
    scene.add(forces.JointSpringDamper(slide, mass * omega**2))
    history = monolithic.run(scene, duration, step=step, integrator=integrator, progress=False)
    assert history.status == "completed", history.message
    return abs(float(history.bodies["b"].position[-1, 0]) - np.sin(omega * duration))


@pytest.mark.slow
@pytest.mark.parametrize("integrator", [None, HHT(-0.1), GeneralizedAlpha(0.8), Newmark()], ids=str)
def test_order_two_on_an_oscillator(integrator: Any) -> None:
    """D8: measured orders 2 within 0.1; None is HHT, alpha = -0.3."""
    errors = [oscillator(h, 1.0, integrator) for h in (8e-3, 4e-3, 2e-3)]
    assert np.abs(np.log2(np.array(errors[:-1]) / errors[1:]) - 2.0).max() < 0.1


@pytest.mark.parametrize("wrong", ["fast", 0.8, RungeKutta4()], ids=str)
def test_what_has_no_coefficients_is_refused(wrong: Any) -> None:
    with pytest.raises(InputError, match="alpha_m"):
        coefficients_of(wrong)
