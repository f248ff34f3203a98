"""The closed forms of joints against the verification cases, direct discretisations with friction, and each other."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.optimize import brentq

from references.closed_forms import BarOnBase, BoltedJoint, PressFit, TwoLeaves, equivalent_damping
from references.small_sliding.contact_program import solve
from warpffrf.model.errors import InputError
from warpffrf.model.material import Material

STEEL = Material(210e9, 0.3, 7850.0, name="steel")
ALUMINIUM = Material(70e9, 0.33, 2700.0, name="aluminium")
LEAVES = TwoLeaves(0.2, 0.01, 2e-3, 210e9, 0.3, 1e6)
BAR = BarOnBase(210e9 * 1e-4, 0.5, 2e4)
FIT = PressFit(0.02, 0.04, 10e-6, 0.02, 0.15, STEEL)
CELLS = 100


def cycle(peak: float, steps: int = 10) -> np.ndarray:
    up = np.linspace(0.0, peak, steps + 1)
    return np.concatenate([up[1:], up[:-1][::-1], -up[1:], -up[:-1][::-1], up[1:]])


def followed(G: np.ndarray, per_force: np.ndarray, bound: np.ndarray, forces: np.ndarray) -> tuple[np.ndarray, float]:
    """Tractions (steps, n) of cells with compliance G and free slip `per_force` a unit of force, through `forces`; and
    the work lost in the last four fifths of them. What presses the cells together yields, so that it does not change.
    """
    n = len(bound)
    whole = np.zeros((n, 3, n, 3))
    whole[:, 1, :, 1] = G
    for k in (0, 2):
        whole[np.arange(n), k, np.arange(n), k] = np.diag(G)
    slipped, s = np.zeros(n), None
    found, lost = [], []
    for F in forces:
        b = np.stack([-bound * np.diag(G), per_force * F - slipped, np.zeros(n)], axis=1)
        step = solve(whole.reshape(3 * n, 3 * n), b, 1.0, s)
        s = step.force
        lost.append(step.dissipated)
        slipped = slipped + step.motion[:, 1]
        found.append(s[:, 1])
    return np.array(found), float(np.sum(lost[len(lost) // 5 :]))


def middles(length: float) -> np.ndarray:
    return length * (np.arange(CELLS) + 0.5) / CELLS


@pytest.mark.slow
def test_leaves_against_cells_along_the_joint() -> None:
    """Bernoulli's leaves, the traction unknown in cells: slip = h w' less the strain, which is 8 min(x, y)/(E b h)."""
    j, x = LEAVES, middles(LEAVES.length)
    E, b, h, L = j.youngs_modulus, j.width, j.thickness, j.length
    I1 = b * h**3 / 12.0
    least = np.minimum.outer(x, x)
    ends = (L * x - 0.5 * x**2) * h / (2.0 * E * I1)
    bound = np.full(CELLS, j.friction * j.pressure * b * L / CELLS)
    for peak in (1.2, 2.0):
        forces = cycle(peak * j.slip_force)
        t, lost = followed(8.0 / (E * b * h) * least, ends, bound, forces)
        tip = forces * L**3 / (6.0 * E * I1) + t @ ends
        first, down, up = tip[:10], tip[9:30], tip[29:50]
        scale = abs(tip).max()
        # the traction of cells is a step function of a smooth one: second order, and the clamped end sticks last
        assert np.abs(first - j.loading(forces[:10])).max() < 2e-4 * scale
        assert np.abs(down - j.unloading(forces[9:30], peak * j.slip_force)).max() < 2e-4 * scale
        assert np.abs(up - j.reloading(forces[29:50], peak * j.slip_force)).max() < 2e-4 * scale
        assert lost == pytest.approx(j.cycle_loss(peak * j.slip_force), rel=2e-3)
        loop = -np.trapezoid(tip[9:], forces[9:])
        assert loop == pytest.approx(j.cycle_loss(peak * j.slip_force), rel=0.1)  # corners of ten forces a quarter


def test_leaves_are_continuous_and_lose_most_at_the_best_pressure() -> None:
    j = LEAVES
    stuck, slips = j.loading(np.array([1.0 - 1e-12, 1.0 + 1e-12]) * j.slip_force)
    assert stuck == pytest.approx(slips, rel=1e-10) and j.cycle_loss(j.slip_force) == 0.0
    assert j.loading(0.5 * j.slip_force) == pytest.approx(
        0.5 * j.slip_force * j.length**3 / (24.0 * j.youngs_modulus * j.width * j.thickness**3 / 12.0)
    )
    # the work of the traction along the joint, both halves of a cycle
    peak = 1.7 * j.slip_force
    x, w = np.polynomial.legendre.leggauss(5)
    x, w = 0.5 * j.length * (x + 1.0), 0.5 * j.length * w
    change = 2.0 * peak - 2.0 * j.slip_force  # slips after the reversal
    work = 2.0 * j.friction * j.pressure * j.width * (w @ j.slip(x, j.slip_force + change))
    assert work == pytest.approx(j.cycle_loss(peak), rel=1e-12)
    losses = [
        TwoLeaves(j.length, j.width, j.thickness, j.youngs_modulus, j.friction, p).cycle_loss(peak)
        for p in np.linspace(0.9, 1.1, 21) * j.best_pressure(peak)
    ]
    assert np.argmax(losses) == 10 and losses[10] == pytest.approx(j.largest_cycle_loss(peak), rel=1e-12)


@pytest.mark.slow
def test_bar_against_cells_along_it() -> None:
    j, x = BAR, middles(BAR.length)
    G = np.minimum.outer(x, x) / j.stiffness
    bound = np.full(CELLS, j.resistance * j.length / CELLS)
    losses = []
    for peak in (0.4, 0.8):
        forces = cycle(peak * j.limit, 8)
        t, lost = followed(G, x / j.stiffness, bound, forces)
        end = (forces * j.length + t @ x) / j.stiffness
        scale = abs(end).max()
        assert np.abs(end[:8] - j.loading(forces[:8])).max() < 1e-3 * scale
        assert np.abs(end[7:24] - j.unloading(forces[7:24], peak * j.limit)).max() < 1e-3 * scale
        assert np.abs(end[23:40] - j.reloading(forces[23:40], peak * j.limit)).max() < 1e-3 * scale
        assert lost == pytest.approx(j.cycle_loss(peak * j.limit), rel=5e-3)
        losses.append(lost)
    assert np.log2(losses[1] / losses[0]) == pytest.approx(3.0, abs=0.01)
    assert j.cycle_loss(0.8 * j.limit) / j.cycle_loss(0.4 * j.limit) == pytest.approx(8.0, rel=1e-12)


def test_masing_loops_close_and_have_the_stated_area() -> None:
    for j, peak in ((BAR, 0.7 * BAR.limit), (LEAVES, 1.6 * LEAVES.slip_force)):
        F = np.linspace(-peak, peak, 200_001)
        area = np.trapezoid(j.unloading(F, peak) - j.reloading(F, peak), F)
        assert area == pytest.approx(j.cycle_loss(peak), rel=1e-8)
        assert j.unloading(-peak, peak) == pytest.approx(-float(j.loading(peak)), rel=1e-12)
    with pytest.raises(InputError, match=r"t L = 10000 N.*lower the force"):
        BAR.loading(1.01 * BAR.limit)


def test_bolted_joint_against_two_springs_with_unilateral_contact() -> None:
    j = BoltedJoint(4e8, 1.6e9, 50e3)
    assert j.opening_force == pytest.approx(62.5e3)
    for F in np.linspace(-30e3, 90e3, 13):

        def balance(x: float, F: float = F) -> float:
            return j.preload + j.bolt * x - max(j.preload - j.clamped * x, 0.0) - F

        x = float(np.asarray(brentq(balance, -1e-3, 1e-3, xtol=1e-18)))
        assert j.parting(F) == pytest.approx(x, rel=1e-9, abs=1e-15)
        assert j.bolt_force(F) == pytest.approx(j.preload + j.bolt * x, rel=1e-9)
        assert j.clamp_force(F) == pytest.approx(max(j.preload - j.clamped * x, 0.0), rel=1e-9, abs=1e-6)


def widening(inner: float, outer: float, material: Material, at_outer: bool, cells: int = 800) -> float:
    """Radial displacement [m/Pa] of the loaded face of a ring in plane stress under a unit pressure there, by linear
    elements along the radius."""
    E, nu = material.youngs_modulus, material.poisson_ratio
    C = E / (1.0 - nu**2) * np.array([[1.0, nu], [nu, 1.0]])
    r = np.linspace(inner, outer, cells + 1)
    K = np.zeros((cells + 1, cells + 1))
    for e in range(cells):
        h = r[e + 1] - r[e]
        for g in (-1.0, 1.0):
            s = 0.5 + 0.5 * g / np.sqrt(3.0)
            R = r[e] + s * h
            B = np.array([[-1.0 / h, 1.0 / h], [(1.0 - s) / R, s / R]])
            K[e : e + 2, e : e + 2] += B.T @ C @ B * R * 0.5 * h
    f = np.zeros(cells + 1)
    f[-1 if at_outer else 0] = outer if at_outer else inner
    return float(np.linalg.solve(K, f)[-1 if at_outer else 0])


def test_press_fit_has_the_values_of_the_case_and_those_of_rings() -> None:
    assert pytest.approx([39.375e6, 296.8805], rel=1e-6) == [FIT.pressure, FIT.slip_torque]
    assert FIT.slip_force == pytest.approx(FIT.slip_torque / 0.02)
    hollow = PressFit(0.02, 0.035, 8e-6, 0.02, 0.15, STEEL, hub=ALUMINIUM, bore=0.006)
    both = widening(0.02, 0.035, ALUMINIUM, False) + widening(0.006, 0.02, STEEL, True)
    assert hollow.pressure == pytest.approx(8e-6 / both, rel=1e-5)  # linear elements of 1/800 of the wall
    r = np.linspace(0.02, 0.04, 2001)
    radial, hoop = FIT.hub_stress(r)
    assert radial[[0, -1]] == pytest.approx([-FIT.pressure, 0.0], abs=1e-6 * FIT.pressure)
    balance = np.gradient(r * radial, r, edge_order=2) - hoop
    assert np.abs(balance).max() < 1e-5 * FIT.pressure  # second differences of 2000 pieces
    assert hoop[0] / FIT.pressure == pytest.approx((0.04**2 + 0.02**2) / (0.04**2 - 0.02**2))
    with pytest.raises(InputError, match="radii must ascend"):
        PressFit(0.02, 0.02, 10e-6, 0.02, 0.15, STEEL)


def test_equivalent_damping_is_that_of_a_viscous_damper() -> None:
    """x = cos(omega t) with omega = sqrt(k/m): the damper 2 zeta sqrt(k m) loses pi c omega."""
    k, m, zeta = 3e5, 2.0, 0.013
    omega = np.sqrt(k / m)
    t = np.linspace(0.0, 2.0 * np.pi / omega, 4001)
    loss = np.trapezoid(2.0 * zeta * np.sqrt(k * m) * (omega * np.sin(omega * t)) ** 2, t)
    assert equivalent_damping(float(loss), 0.5 * k) == pytest.approx(zeta, rel=1e-9)
    with pytest.raises(InputError, match="peak strain energy"):
        equivalent_damping(1.0, 0.0)
