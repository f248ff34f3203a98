"""Coupled normal and tangential contact of unlike half-planes compared with the closed form of sliding."""

from __future__ import annotations

import numpy as np
import pytest

from references.closed_forms import LineContact, SlidingLine, contact_modulus, coupling_ratio
from references.half_space.unlike_half_planes import Pair
from warpffrf.model.errors import InputError
from warpffrf.model.material import Material

STEEL, SOFT = Material(210e9, 0.3, 7800.0), Material(2e9, 0.1, 1000.0)
LOAD, RADIUS = 1e4, 0.02  # N/m, m
MODULUS = contact_modulus(SOFT, STEEL)
HALF_WIDTH = LineContact(LOAD, RADIUS, MODULUS).half_width


def pair(friction: float, cells: int, first: Material = SOFT, second: Material | None = STEEL) -> Pair:
    return Pair(first, second, RADIUS, friction, 1.4 * HALF_WIDTH, cells)


def centroid(x: np.ndarray, p: np.ndarray) -> float:
    return float(x @ p / p.sum())


def test_closed_form_carries_its_load_and_is_hertz_without_coupling() -> None:
    for friction, coupling in ((0.8, 0.4), (-0.3, 0.2), (0.5, 0.0)):
        s = SlidingLine(LOAD, RADIUS, MODULUS, coupling, friction)
        low, high = s.ends
        t = 0.5 * (1.0 - np.cos(np.pi * (np.arange(4000) + 0.5) / 4000))
        x = low + (high - low) * t
        measure = (high - low) * np.pi / 4000 * np.sqrt(t * (1.0 - t))
        assert measure @ s.pressure(x) == pytest.approx(LOAD, rel=1e-5)
    assert high == pytest.approx(HALF_WIDTH)
    assert np.allclose(s.pressure(x), LineContact(LOAD, RADIUS, MODULUS).pressure(x))


def test_coupling_ratio_is_that_of_dundurs() -> None:
    """By his own definition with kappa = 3 - 4 nu; a rigid partner is the limit of a hard one."""
    k = [3.0 - 4.0 * m.poisson_ratio for m in (SOFT, STEEL)]
    ratio = STEEL.lame[1] / SOFT.lame[1]
    wanted = (ratio * (k[0] - 1.0) - (k[1] - 1.0)) / (ratio * (k[0] + 1.0) + (k[1] + 1.0))
    assert coupling_ratio(SOFT, STEEL) == pytest.approx(wanted, rel=1e-12)
    assert coupling_ratio(STEEL, SOFT) == pytest.approx(-wanted, rel=1e-12)
    assert coupling_ratio(SOFT) == pytest.approx(coupling_ratio(SOFT, Material(1e20, 0.3, 1.0)), rel=1e-9)


@pytest.mark.parametrize("sense", [1.0, -1.0])
def test_sliding_pressure_leans_as_in_closed_form(sense: float) -> None:
    """The first body slides against x: traction on it along x. 80 cells, edges within one of them."""
    p = pair(0.8, 80)
    p.step(LOAD, 0.0)
    p.step(LOAD, -sense * HALF_WIDTH)
    exact = SlidingLine(LOAD, RADIUS, MODULUS, coupling_ratio(SOFT, STEEL), 0.8 * sense)
    low, high = exact.ends
    t = np.linspace(low, high, 20001)
    assert np.allclose(p.q, 0.8 * sense * p.p)
    assert centroid(p.x, p.p) == pytest.approx(centroid(t, exact.pressure(t)), rel=2e-3)
    on = p.x[p.p > 0.0]
    assert abs(on.min() - 0.5 * p.width - low) < p.width and abs(on.max() + 0.5 * p.width - high) < p.width
    inner = np.abs(p.x - centroid(p.x, p.p)) < 0.7 * HALF_WIDTH
    assert np.allclose(p.p[inner], exact.pressure(p.x[inner]), rtol=0.01)
    assert float(p.q @ p.slip) < 0.0


def test_pressing_unlike_bodies_is_symmetric_and_slips_outwards() -> None:
    """Pressure alone spreads the softer surface; friction holds it back, both ways alike, without a net force."""
    p = pair(0.3, 81)
    for load in LOAD * np.linspace(0.25, 1.0, 4):
        p.step(load, 0.0)
        assert float(p.q @ p.slip) <= 1e-15 * LOAD * HALF_WIDTH / p.width
    assert np.allclose(p.p, p.p[::-1], atol=1e-9 * p.p.max()) and np.allclose(p.q, -p.q[::-1], atol=1e-9 * p.p.max())
    assert np.abs(p.q).max() > 1e-2 * p.p.max() and p.turns > 1
    assert np.all(np.abs(p.q) <= 0.3 * p.p * (1.0 + 1e-12))


def test_like_bodies_do_not_couple() -> None:
    with pytest.raises(InputError, match="negative"):
        pair(-0.1, 40)
    line = LineContact(LOAD, RADIUS, contact_modulus(STEEL, STEEL))
    p = Pair(STEEL, STEEL, RADIUS, 0.3, 1.4 * line.half_width, 40)
    p.step(LOAD, 0.0)
    assert not p.q.any() and p.turns <= 2
    with pytest.raises(InputError, match="reaches the end"):
        p.step(4.0 * LOAD, 0.0)
