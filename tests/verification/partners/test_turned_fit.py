"""The closed form of a rotated press fit compared with sections in a row, joined by springs and Coulomb elements."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from references.closed_forms import PressFit, TurnedFit
from warpffrf.model.errors import InputError
from warpffrf.model.material import Material

STEEL = Material(youngs_modulus=210e9, poisson_ratio=0.3, density=7850)
FIT = PressFit(radius=0.02, outer_radius=0.03, interference=1e-5, width=0.04, friction=0.15, shaft=STEEL)
TURNED = TurnedFit(FIT)
SECTIONS = 400  # in a row: 0.1 mm each
CLOSE = 1e-3  # of the closed form: zones end between two sections


def ring_compliance() -> float:
    """C [rad/N], by quadrature of the shear of Saint-Venant's torsion and of means with the weight r^3."""
    G, R, out = STEEL.lame[1], FIT.radius, FIT.outer_radius
    found = 0.0
    for low, high, seat, flux in (
        (0.0, R, -1, lambda r: r**4 / R**4),
        (R, out, 0, lambda r: (out**4 - r**4) / (out**4 - R**4)),
    ):
        r = np.linspace(low, high, 20001)[1:]
        slope = flux(r) / (2.0 * np.pi * G * r**3)  # of psi, outwards of what goes in at the seat
        psi = np.concatenate([[0.0], np.cumsum(0.5 * (slope[1:] + slope[:-1]) * np.diff(r))])
        mean = np.trapezoid(psi * r**3, r) / np.trapezoid(r**3, r)
        found += abs(psi[seat] - mean)
    return found


def in_a_row(torque: float) -> tuple[float, np.ndarray, np.ndarray]:
    """Angle [rad], torque per length [N] and slip [m] (sections,) at first loading, by trying which sections slip."""
    n, h, m = SECTIONS, FIT.width / SECTIONS, TURNED.limit
    G, R, out = STEEL.lame[1], FIT.radius, FIT.outer_radius
    shaft, hub = G * 0.5 * np.pi * R**4, G * 0.5 * np.pi * (out**4 - R**4)
    C, S = ring_compliance(), 1.0 / shaft + 1.0 / hub
    # s_(i+1) - s_i = -S h (T_s - torque hub's share) with T_s = torque - h (q_0 + ... + q_i), and all of it goes over
    step = np.eye(n, k=1)[:-1] - np.eye(n)[:-1]
    before = np.tril(np.ones((n, n)))[:-1] * h
    of_q = np.vstack([C * step - S * h * before, np.full(n, h)])
    of_slip = np.vstack([step, np.zeros(n)])
    right = np.append(np.full(n - 1, -S * h * torque * (1.0 - shaft / (shaft + hub))), torque)
    slips = np.zeros(n, dtype=bool)
    for _ in range(n):
        found = np.linalg.solve(np.where(slips, of_slip, of_q), right - m * of_q[:, slips].sum(axis=1))
        q, slip = np.where(slips, m, found), np.where(slips, found, 0.0)
        new = np.where(slips, slip > 0.0, q > m)
        if np.array_equal(new, slips):
            between = torque - h * np.cumsum(q)[:-1]
            last = C * q[-1] + slip[-1] + 0.5 * S * h * torque * shaft / (shaft + hub)
            return float((between.sum() + 0.5 * torque) * h / shaft + last), q, R * slip
        slips = new
    raise AssertionError("the sections that slip were not found")


@pytest.mark.parametrize("share", [0.1, 0.3, 0.55, 0.8, 0.95])
def test_sections_in_a_row_have_the_same_angle_friction_and_slip(share: float) -> None:
    torque = share * FIT.slip_torque
    angle, q, slip = in_a_row(torque)
    y = FIT.width * (np.arange(SECTIONS) + 0.5) / SECTIONS
    assert angle == pytest.approx(float(TURNED.loading(torque)), rel=CLOSE)
    assert np.abs(q - TURNED.carried(y, torque)).max() < 10.0 * CLOSE * TURNED.limit
    assert np.abs(slip - TURNED.slip(y, torque)).max() < CLOSE * TURNED.slip(np.zeros(1), FIT.slip_torque)[0]
    a, c = TURNED.zones(torque)
    assert (slip > 0.0).sum() / SECTIONS == pytest.approx((a + c) / FIT.width, abs=2.0 / SECTIONS)
    assert (c > 0.0) == (slip[-1] > 0.0)


def test_slip_begins_at_the_entry_and_ends_with_all_of_the_seat() -> None:
    first = TURNED.first_slip
    assert TURNED.zones(0.999 * first) == (0.0, 0.0)
    assert TURNED.zones(1.001 * first)[0] > 0.0
    assert TURNED.carried(0.0, first) == pytest.approx(TURNED.limit, rel=1e-9)
    a, c = TURNED.zones((1.0 - 1e-12) * FIT.slip_torque)
    assert a + c == pytest.approx(FIT.width, rel=1e-3)
    with pytest.raises(InputError, match="all of it slips at"):
        TURNED.zones(1.01 * FIT.slip_torque)


def test_without_shear_of_the_rings_it_is_the_parabola_of_rods() -> None:
    """A seat of 40 radii, compared with which the shear lag is a two-hundredth."""
    long = TurnedFit(replace(FIT, width=0.8))
    k, torque = long.share, 0.7 * long.fit.slip_torque
    shaft, hub = (STEEL.lame[1] * 0.5 * np.pi * J for J in (FIT.radius**4, FIT.outer_radius**4 - FIT.radius**4))
    rods = torque * 0.8 / (shaft + hub) + torque**2 / (2.0 * long.limit) * ((1.0 - k) ** 2 / shaft + k**2 / hub)
    assert long.loading(torque) == pytest.approx(rods, rel=2e-4)
    assert sum(long.zones(torque)) == pytest.approx(torque / long.limit - 2.0 * long.decay, rel=1e-9)


def test_the_loss_is_what_friction_takes_in_a_cycle() -> None:
    """From one end of a cycle to the other the seat slips by twice the slip of half the torque's range, under m."""
    peak = 0.8 * FIT.slip_torque
    x, w = np.polynomial.legendre.leggauss(400)
    y = 0.5 * FIT.width * (1.0 + x)
    work = 0.5 * FIT.width * w @ TURNED.slip(y, peak) * TURNED.limit / FIT.radius
    assert TURNED.cycle_loss(peak) == pytest.approx(4.0 * work, rel=1e-3)
    assert TURNED.cycle_loss(0.9 * TURNED.first_slip) == 0.0


def test_shafts_that_it_does_not_hold_for_are_refused() -> None:
    with pytest.raises(InputError, match="solid shaft"):
        TurnedFit(replace(FIT, bore=0.01))
    with pytest.raises(InputError, match="stiffer in torsion"):
        TurnedFit(replace(FIT, outer_radius=0.021))
