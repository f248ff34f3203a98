"""The slider-crank: its rigid kinematics against differences, its rod against the beam equation."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest
from checks import Check, both_sizes, left_behind, missed

import warpffrf as wf
from demos import slider_crank as demo
from demos.slider_crank import CRANK, PISTON_MASS, ROD, SECTION, SPEED, SPIN_UP, STEEL

MODES_OF_REFERENCE = (1, 3)  # the even ones have a node at midspan, the fifth answers with 3e-4 of the first
DEFLECTION = 0.006  # of its amplitude: the beam equation leaves out coupling of the modes and feedback on a(s)
STRETCH = 5e-4  # of the crank radius: piston and rod pull 3 kN out of a rod of 84 MN, 3e-5 of its length


@dataclass(frozen=True)
class Kinematics:
    """The rigid mechanism at times t (T,): crank angle and rates, angle of the rod (from +x, about -y), piston."""

    theta: np.ndarray
    rod_rate: np.ndarray
    piston: np.ndarray
    piston_acceleration: np.ndarray
    pin_across: np.ndarray  # (T,) m/s2, acceleration of the crank pin across the rod
    piston_across: np.ndarray  # (T,) m/s2, of the piston
    pin_along: np.ndarray  # (T,) m/s2, of the crank pin along the rod


def kinematics(t: np.ndarray) -> Kinematics:
    """Rigid motion under the drive: with (c, s) of the crank and (C, S) of the rod, r s + l S = 0."""
    # the quintic's integral and derivative in closed form
    x = np.clip(t / SPIN_UP, 0.0, 1.0)
    omega = SPEED * x**3 * (10.0 - 15.0 * x + 6.0 * x**2)
    alpha = SPEED / SPIN_UP * 30.0 * x**2 * (1.0 - x) ** 2
    theta = SPEED * SPIN_UP * x**4 * (2.5 - 3.0 * x + x**2) + SPEED * np.maximum(t - SPIN_UP, 0.0)
    c, s = np.cos(theta), np.sin(theta)
    S = -CRANK / ROD * s
    C = np.sqrt(1.0 - S**2)
    phi_1 = -CRANK / ROD * c * omega / C  # of r s + l S = 0, differentiated once and twice
    phi_2 = (-CRANK / ROD * (c * alpha - s * omega**2) + S * phi_1**2) / C
    pin = CRANK * np.array([-s * alpha - c * omega**2, c * alpha - s * omega**2])  # x, z
    piston = pin[0] + ROD * (-S * phi_2 - C * phi_1**2)
    return Kinematics(
        theta, phi_1, CRANK * c + ROD * C, piston,
        pin_across=-S * pin[0] + C * pin[1], piston_across=-S * piston, pin_along=C * pin[0] + S * pin[1],
    )  # fmt: skip


def beam_deflection(t: np.ndarray, *, inertia_terms: bool = True, axial_force: bool = True) -> np.ndarray:
    r"""Deflection at midspan (T,) [m], towards +z of a rod that points along +x, by the equations of the demo.

    The frequencies of a pinned beam with rotary inertia and shear (S. Timoshenko, Vibration Problems in Engineering,
    1937, section 54; k = n pi/l, kappa of G. R. Cowper, J. Appl. Mech. 33, 1966, 335) are

        omega_n^2 = E I k^4 / (rho A (1 + k^2 I/A (1 + E/(kappa G)))),

    and the axial force N(s) in the rod adds S_n = (2/(rho A l)) int N (n pi/l)^2 cos(n pi s/l)^2 ds. N(s) pushes the
    piston and the part of the rod between s and the piston. The modes are coupled by N a little; that is neglected, and
    so is the effect of the bending on a(s). The deflection at midspan is w_1 - w_3.
    """
    from scipy.integrate import solve_ivp

    E, G, rho = STEEL.youngs_modulus, STEEL.youngs_modulus / (2.0 * (1.0 + STEEL.poisson_ratio)), STEEL.density
    A, I_A = SECTION**2, SECTION**2 / 12.0
    kappa = 10.0 * (1.0 + STEEL.poisson_ratio) / (12.0 + 11.0 * STEEL.poisson_ratio)
    n = np.array(MODES_OF_REFERENCE, dtype=float)
    k = n * np.pi / ROD
    stiffness = E * I_A * k**4 / (rho * (1.0 + k**2 * I_A * (1.0 + E / (kappa * G))))  # omega_n^2
    s = np.linspace(0.0, ROD, 41)
    shape = 2.0 / (rho * A * ROD) * (k[:, None] * np.cos(k[:, None] * s)) ** 2

    def rates(time: float, y: np.ndarray) -> np.ndarray:
        m = kinematics(np.array(time))
        w, v = np.split(y, 2)
        added = np.zeros(len(n))
        if inertia_terms:
            added = added - m.rod_rate**2
        if axial_force:
            added = added + np.trapezoid(shape * _axial_force(m, s, rho * A), s, axis=1)
        return np.concatenate([v, -2.0 / (n * np.pi) * (m.pin_across + m.piston_across) - (stiffness + added) * w])

    found = solve_ivp(rates, (t[0], t[-1]), np.zeros(2 * len(n)), t_eval=t, rtol=1e-7, atol=1e-10, method="DOP853")
    return np.sin(0.5 * n * np.pi) @ found.y[: len(n)]


def _axial_force(m: Kinematics, s: np.ndarray, line_mass: float) -> np.ndarray:
    """Tension N(s) [N] of the rigid rod: N(l) cos(phi) pulls the piston as the transverse force on it allows.

    Along the rod the point at s has a_0 - phi'^2 s. At the piston end the transverse force V follows from the moments
    about the crank pin, V l = -int rho A a(s) s ds, and the piston from N cos(phi) - V sin(phi) = -m a_p.
    """
    S = -CRANK / ROD * np.sin(m.theta)
    C = np.sqrt(1.0 - S**2)
    V = -line_mass * ROD * (m.pin_across / 6.0 + m.piston_across / 3.0)  # of the rod on the piston
    end = (-PISTON_MASS * m.piston_acceleration - V * S) / C
    along = m.pin_along * (ROD - s) - 0.5 * m.rod_rate**2 * (ROD**2 - s**2)  # int_s^l (a_0 - phi'^2 s) ds
    return end - line_mass * along


def checks(result: wf.Result, deflection: np.ndarray, reference: np.ndarray, label: str) -> list[Check]:
    """The figures of one run over the last turn; deflection, reference: (T,) m of its rod and of the beam equation."""
    last = result.time > result.time[-1] - 2.0 * np.pi / SPEED
    amplitude = float(np.abs(reference[last]).max())
    apart = float(np.abs(deflection - reference)[last].max())
    piston = np.abs(result.body("piston").position[:, 0] - kinematics(result.time).piston).max()
    return [
        Check(f"midspan deflection, {label}", float(np.abs(deflection[last]).max()), amplitude, "beam equation",
              DEFLECTION, "mm", 1e3),
        Check(f"its largest difference, {label}", apart, 0.0, "beam equation, over the amplitude", DEFLECTION, "mm",
              1e3, scale=amplitude),
        Check(f"piston, largest difference, {label}", float(piston), 0.0, "rigid kinematics, over the crank radius",
              STRETCH, "mm", 1e3, scale=CRANK),
    ]  # fmt: skip


SHORT = demo.Size(cells=10, turns=1)


def test_kinematics_are_their_own_derivatives() -> None:
    h = 1e-5
    t = np.arange(0.0, 0.15, h)
    m = kinematics(t)
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


@pytest.mark.slow
@pytest.mark.parametrize(("inertia", "stiffening"), [("full", True), ("constant", False)])
def test_the_rod_bends_as_the_beam_equation_says(inertia: str, stiffening: bool) -> None:
    scene, result = demo.run(SHORT, inertia=inertia, stiffening=stiffening, progress=False)
    assert result.status == "completed", result.message
    beam = beam_deflection(result.time, inertia_terms=stiffening, axial_force=stiffening)
    found = checks(result, demo.midspan(scene, result), beam, inertia)
    assert not missed(found)


def test_the_slower_mechanism_bends_less_by_the_square_of_its_speed() -> None:
    """Quasi-static bending is that of the inertia of the straight rod, proportional to omega^2."""
    scene = demo.build(SHORT, progress=False)
    slow = wf.simulate(scene, 0.02, step=demo.STEP, progress=False)
    w = demo.midspan(scene, slow)
    m = kinematics(slow.time)
    k = np.pi / demo.ROD
    omega_1 = k**2 * np.sqrt(demo.STEEL.youngs_modulus * demo.SECTION**2 / 12.0 / demo.STEEL.density)
    static = -2.0 / np.pi * (m.pin_across + m.piston_across) / omega_1**2
    last = slow.time > 0.01
    assert w[last] == pytest.approx(static[last], abs=0.05 * np.abs(static).max())


@pytest.mark.slow
def test_the_machine_at_rest_has_the_modes_of_a_pinned_rod() -> None:
    """No load acts, so that the forces of the static state are round-off, and it is found all the same. The pins hold
    the rod in the plane as they do in the beam equation: pi/l is its wave number."""
    modes = wf.eigenmodes(demo.build(SHORT, progress=False), count=1)
    slender = np.sqrt(demo.STEEL.youngs_modulus / demo.STEEL.density) * demo.SECTION / np.sqrt(12.0)
    assert modes.frequencies[0] == pytest.approx(0.5 * np.pi * slender / demo.ROD**2, rel=0.01)


@both_sizes
def test_the_whole_demo(tmp_path: Path, quick: bool) -> None:
    full, plain = demo.main(tmp_path, quick=quick, progress=False)
    left_behind(tmp_path, "slider_crank", "constant")
    for result, terms, label in ((full, True, "all terms"), (plain, False, "constant")):
        beam = beam_deflection(result.time, inertia_terms=terms, axial_force=terms)
        assert not missed(checks(result, demo.midspan(result.scene, result), beam, label))
