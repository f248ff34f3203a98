"""Half-width, peak and line load against Hertz, and the Hertz helpers against Johnson's formulas."""

from __future__ import annotations

import numpy as np
import pytest
from synthetic_run import DURATION, E_MODULUS, HALF_WIDTH, PEAK, PITCH, POISSON, TURN, WIDTH, R, make_history

from warpffrf.output.contact.hertz import HertzLine
from warpffrf.output.contact.result import line_moments, node_means
from warpffrf.output.result import Result

FINE_QUADRATURE = 200_001


@pytest.mark.parametrize("phase", np.linspace(0.0, 0.875, 8))
def test_moments_are_exact_for_piecewise_linear_pressure(phase: float) -> None:
    h = 0.3
    x = h * (np.arange(15) - 7 - phase)
    p = np.sqrt(np.maximum(0.0, 1.0 - x**2))
    load, center, half_width = line_moments(x[None], p[None], h)
    fine = np.linspace(x[0] - h, x[-1] + h, FINE_QUADRATURE)
    field = np.interp(fine, x, p, left=0.0, right=0.0)
    expected = np.trapezoid(field, fine)
    middle = np.trapezoid(field * fine, fine) / expected
    second = np.trapezoid(field * (fine - middle) ** 2, fine) / expected
    assert load[0] == pytest.approx(expected, rel=1e-8)  # trapezoid rule across the kinks
    assert center[0] == pytest.approx(middle, abs=1e-8)
    assert half_width[0] == pytest.approx(2.0 * np.sqrt(second), rel=1e-8)


def test_half_width_of_a_finely_sampled_hertz_pressure_is_its_half_width() -> None:
    x = np.linspace(-1.5, 1.5, 3001)
    p = np.sqrt(np.maximum(0.0, 1.0 - x**2))
    load, center, half_width = line_moments(x[None], p[None], x[1] - x[0])
    assert half_width[0] == pytest.approx(1.0, rel=1e-4)  # the root singularity at the edge limits the sum
    assert load[0] == pytest.approx(0.5 * np.pi, rel=1e-4)
    assert center[0] == pytest.approx(0.0, abs=1e-12)


def test_node_means_are_integrals_over_the_nodes() -> None:
    p = np.random.default_rng(1).random((2, 9, 3))
    x = np.linspace(-4.0, 4.0, 80001)
    grid_nodes = np.maximum(0.0, 1.0 - np.abs(x[:, None] - np.arange(-4, 5)))
    field = np.einsum("xj,tjk->txk", grid_nodes, p)
    means = np.einsum("xj,txk->tjk", grid_nodes, field) * (x[1] - x[0])
    inside = slice(1, -1)  # the outermost nodes reach beyond the window, where there is no pressure
    assert node_means(p)[:, inside] == pytest.approx(means[:, inside], rel=1e-7)  # trapezoidal rule on 1e-4


def test_node_means_keep_a_linear_pressure_and_the_load() -> None:
    p = np.zeros((1, 12, 1))
    p[0, 3:9, 0] = 2.0 + 0.5 * np.arange(6)
    assert node_means(p)[0, 4:8, 0] == pytest.approx(p[0, 4:8, 0], rel=1e-15)
    assert node_means(p).sum() == pytest.approx(p.sum(), rel=1e-15)


def test_no_pressure_gives_zeros_not_nan() -> None:
    p = np.zeros((2, 5))
    assert all(np.all(v == 0.0) for v in line_moments(np.arange(5.0), p, 1.0))
    assert np.all(node_means(p[:, :, None]) == 0.0)


def test_contact_of_a_hertz_run(result: Result) -> None:
    contact = result.contact("lower-upper")
    # an L2 projection on 4 shape functions a half-width keeps load and centre; the root singularity at the edge costs a
    # percent elsewhere
    assert contact.half_width == pytest.approx(np.full(len(result.time), HALF_WIDTH), rel=0.01)
    assert contact.mid_peak_pressure == pytest.approx(PEAK * (1.0 + result.time / DURATION), rel=0.02)
    # the patch lies symmetrically about the line of centres, also where its column number wraps around
    assert contact.center == pytest.approx(np.zeros(len(result.time)), abs=1e-3 * HALF_WIDTH)
    patch = contact.pressure(3)
    assert patch.pressure.shape == (len(patch.theta), len(patch.z))
    assert np.diff(patch.arc) == pytest.approx(np.full(len(patch.arc) - 1, R * PITCH))


def test_the_peak_stays_on_top_of_a_roller_that_rotates(result: Result) -> None:
    """In the user frame of the roller, which rotates by +angle about y, the top moves back by the angle."""
    angle = TURN * result.time / DURATION
    x, y, z = result.contact("lower-upper").peak_position.T
    assert np.hypot(x, z) == pytest.approx(np.full(len(angle), R), rel=1e-12) and np.all(np.abs(y) <= 0.5 * WIDTH)
    assert np.unwrap(np.arctan2(-x, z)) == pytest.approx(angle, abs=0.05 * PITCH)
    assert angle[-1] > 5.0 * PITCH


def test_hertz_helper_is_johnsons_formula(result: Result) -> None:
    contact = result.contact("lower-upper")
    line = contact.hertz(0)
    assert isinstance(line, HertzLine)
    modulus = E_MODULUS / (2.0 * (1.0 - POISSON**2))
    assert line.modulus == pytest.approx(modulus)
    assert line.radius == pytest.approx(0.5 * R)
    assert line.half_width**2 == pytest.approx(4.0 * line.line_load * line.radius / (np.pi * modulus))
    assert line.half_width == pytest.approx(HALF_WIDTH, rel=0.01)
    assert line.peak_pressure == pytest.approx(PEAK, rel=0.02)
    x = contact.center[0] + np.linspace(-1.0, 1.0, 20_001) * line.half_width
    assert np.trapezoid(contact.hertz_pressure(0, x), x) == pytest.approx(line.line_load, rel=1e-5)


def test_hertz_steel_pair_of_the_verification_table() -> None:
    """C1: two steel cylinders R = 50 mm, 100 N/mm."""
    P, Reff, Estar = 1e5, 0.025, 210e9 / (2 * (1 - 0.3**2))
    a = np.sqrt(4 * P * Reff / (np.pi * Estar))
    assert a == pytest.approx(0.166093e-3, rel=1e-5)
    x = np.linspace(-1.2, 1.2, 4801) * a
    p = 383.291e6 * np.sqrt(np.maximum(0.0, 1.0 - (x / a) ** 2))
    load, _, half_width = line_moments(x[None], p[None], x[1] - x[0])
    assert load[0] == pytest.approx(P, rel=1e-4)
    assert half_width[0] == pytest.approx(a, rel=1e-4)


def test_missing_material_is_named(body) -> None:
    from dataclasses import replace

    bare = replace(body, provenance={})
    contact = Result(make_history(bare)).contact("lower-upper")
    assert "body 'lower' has no material data" in contact.hertz(0).reason
