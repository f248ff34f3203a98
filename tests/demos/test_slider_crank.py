"""The slider-crank: its rigid kinematics against differences, its rod against the beam equation."""

from __future__ import annotations

import numpy as np
import pytest

import warpffrf as wf
from demos import slider_crank as demo

SHORT = demo.Size(cells=10, turns=1, frames=5)


def test_kinematics_are_their_own_derivatives() -> None:
    h = 1e-5
    t = np.arange(0.0, 0.15, h)
    m = demo.kinematics(t)
    second = (m.piston[2:] - 2.0 * m.piston[1:-1] + m.piston[:-2]) / h**2
    assert second == pytest.approx(m.piston_acceleration[1:-1], abs=1e-4 * np.abs(m.piston_acceleration).max())
    omega = np.gradient(m.theta, h)[1:-1]
    assert omega == pytest.approx(np.asarray(demo.spin()(t))[1:-1], abs=1e-4 * demo.SPEED)
    lean = np.arcsin(-demo.CRANK / demo.ROD * np.sin(m.theta))
    assert np.gradient(lean, h)[1:-1] == pytest.approx(m.rod_rate[1:-1], abs=1e-4 * np.abs(m.rod_rate).max())
    pin = demo.CRANK * np.stack([np.cos(m.theta), np.sin(m.theta)])
    a = (pin[:, 2:] - 2.0 * pin[:, 1:-1] + pin[:, :-2]) / h**2
    across = -np.sin(lean[1:-1]) * a[0] + np.cos(lean[1:-1]) * a[1]
    along = np.cos(lean[1:-1]) * a[0] + np.sin(lean[1:-1]) * a[1]
    assert across == pytest.approx(m.pin_across[1:-1], abs=1e-4 * np.abs(m.pin_across).max())
    assert along == pytest.approx(m.pin_along[1:-1], abs=1e-4 * np.abs(m.pin_along).max())


@pytest.mark.parametrize(("inertia", "stiffening"), [("full", True), ("constant", False)])
def test_the_rod_bends_as_the_beam_equation_says(inertia: str, stiffening: bool) -> None:
    scene, result = demo.run(SHORT, inertia=inertia, stiffening=stiffening, progress=False)
    assert result.status == "completed", result.message
    beam = demo.beam_deflection(result.time, inertia_terms=stiffening, axial_force=stiffening)
    found = demo.checks(result, demo.midspan(scene, result), beam, inertia)
    assert all(check.passed for check in found), [(c.name, c.error) for c in found]


def test_the_slower_mechanism_bends_less_by_the_square_of_its_speed() -> None:
    """Quasi-static bending is that of the inertia of the straight rod, proportional to omega^2."""
    scene = demo.build(SHORT, progress=False)
    slow = wf.simulate(scene, 0.02, step=demo.STEP, progress=False)
    w = demo.midspan(scene, slow)
    m = demo.kinematics(slow.time)
    k = np.pi / demo.ROD
    omega_1 = k**2 * np.sqrt(demo.STEEL.youngs_modulus * demo.SECTION**2 / 12.0 / demo.STEEL.density)
    static = -2.0 / np.pi * (m.pin_across + m.piston_across) / omega_1**2
    last = slow.time > 0.01
    assert w[last] == pytest.approx(static[last], abs=0.05 * np.abs(static).max())


def test_the_machine_at_rest_has_the_modes_of_a_pinned_rod() -> None:
    """No load acts, so that the forces of the static state are round-off, and it is found all the same. The pins hold
    the rod in the plane as they do in the beam equation: pi/l is its wave number."""
    modes = wf.eigenmodes(demo.build(SHORT, progress=False), count=1)
    slender = np.sqrt(demo.STEEL.youngs_modulus / demo.STEEL.density) * demo.SECTION / np.sqrt(12.0)
    assert modes.frequencies[0] == pytest.approx(0.5 * np.pi * slender / demo.ROD**2, rel=0.01)
