"""Full finite elements of a pin in a bore compared with Persson's conformal solution; the pieces of the contact
solve."""

from __future__ import annotations

import numpy as np
import pytest

from references.closed_forms import conformal_by_half_angle
from references.finite_elements.contact import HalfRing, pressure_rows, quadratic_rows
from references.finite_elements.pin_in_bore import STEEL, Pin, errors, graded, solve_pin
from warpffrf.model.errors import InputError
from warpffrf.model.material import Material

PEAK, ARC = 0.02, 0.03  # promised against Persson


@pytest.mark.parametrize("ratio", [1e-3, 1e-2])
@pytest.mark.parametrize("degree", [10.0, 30.0, 60.0])
def test_finite_elements_follow_persson(ratio: float, degree: float) -> None:
    """The patch must end within half a cell (1/16) and the geometry of second order (the ratio) of his half-angle."""
    peak, arc, low, high = errors(Pin(clearance=0.01 * ratio), np.deg2rad(degree), 16)
    print(f"{ratio:g}, {degree:g} degrees: peak {peak:+.2%}, arc {arc:+.2%}, ends between {low:.3f} and {high:.3f}")
    assert abs(peak) < PEAK and abs(arc) < ARC
    assert low < 1.0 + ratio and high > 1.0 - ratio


def test_refinement_converges() -> None:
    """Differences between levels fall by at least 2.5: the pressure ends in a square root, which costs an order."""
    case, eps = Pin(), np.deg2rad(30.0)
    load = conformal_by_half_angle(eps, case.radius, case.clearance, STEEL, STEEL).load
    found = [solve_pin(case, load, eps, cells) for cells in (8, 16, 32)]
    arcs = np.diff([f.moment_angle for f in found])
    assert abs(arcs[0]) > 2.5 * abs(arcs[1])
    assert abs(found[2].peak_pressure / found[1].peak_pressure - 1.0) < 1e-3


def test_rigid_bore_follows_the_equation_of_unlike_bodies() -> None:
    peak, arc, *_ = errors(Pin(bore=None), np.deg2rad(45.0), 16)
    assert abs(peak) < 2e-3 and abs(arc) < 2e-3


def test_solution_is_complementary_and_carries_the_load() -> None:
    case, eps = Pin(clearance=1e-4), np.deg2rad(30.0)
    load = conformal_by_half_angle(eps, case.radius, case.clearance, STEEL, STEEL).load
    f = solve_pin(case, load, eps, 16)
    assert f.pressure.min() >= 0.0 and f.gap.min() >= 0.0
    assert np.all((f.pressure > 0.0) != (f.gap > 0.0))
    mean = 0.5 * (f.pressure[1:] + f.pressure[:-1])
    carried = 2.0 * case.radius * np.sum(mean * (np.sin(f.angles[1:]) - np.sin(f.angles[:-1])))
    assert carried == pytest.approx(load, rel=2e-3)  # cos t over each node's half, and dR/R of the normals


def test_a_shaft_that_holds_the_pin_stiffens_it() -> None:
    """A rigid shaft of half the radius carries the middle: higher pressure on a smaller patch than a free ring."""
    eps = np.deg2rad(30.0)
    load = conformal_by_half_angle(eps, 0.01, 1e-5, STEEL, STEEL).load
    ring = Pin(inner_radius=0.005)
    held = Pin(inner_radius=0.005, held=True)
    free, stiff = solve_pin(ring, load, eps, 12), solve_pin(held, load, eps, 12)
    assert stiff.peak_pressure > 1.01 * free.peak_pressure
    assert stiff.moment_angle < free.moment_angle


def test_bad_input_is_refused() -> None:
    with pytest.raises(InputError, match="rigid"):
        solve_pin(Pin(pin=None, bore=None), 1e5, 0.5)
    with pytest.raises(InputError, match="load"):
        solve_pin(Pin(), 0.0, 0.5)
    with pytest.raises(InputError, match="reaches the end"):
        solve_pin(Pin(), 1e6, np.deg2rad(5.0), 8)


def test_interpolation_and_pressure_rows_are_exact_for_what_they_span() -> None:
    angles = np.sort(np.append(np.linspace(0.0, 1.0, 6), np.linspace(0.1, 0.9, 5)))
    places = np.linspace(0.0, 1.0, 37)
    rows = quadratic_rows(angles, places)
    assert np.allclose(rows @ angles**2, places**2) and np.allclose(rows.sum(axis=1), 1.0)
    B = pressure_rows(angles, 2.0)
    corners = angles[::2]
    assert B.sum() == pytest.approx(2.0)
    assert (angles**2) @ B @ corners == pytest.approx(2.0 / 4.0)  # int t^2 t dt, times the radius


def test_ring_under_pressure_is_lame_s() -> None:
    """All around the bore of a thick ring fixed outside, plane strain: u = A r + B/r."""
    inner, outer, p = 1.0, 2.0, 1e6
    material = Material(70e9, 0.25, 2700.0)
    ring = HalfRing(material, inner + graded(0.05, outer - inner), np.linspace(0.0, np.pi, 25))
    angles, dofs = ring.on_circle(inner)
    E = np.zeros((ring.basis.N, len(angles)))
    for k, part in enumerate((np.cos, np.sin)):
        E[dofs[:, k], np.arange(len(angles))] = part(angles)
    load = pressure_rows(angles, inner).sum(axis=1) * p
    u = ring.flexibility(E, np.ravel(ring.on_circle(outer)[1])) @ load
    lam, mu = material.lame
    # sigma_r = 2 (lam + mu) A - 2 mu B/r^2 = -p at r = 1, A r + B/r = 0 at r = 2
    A = -p / (2.0 * (lam + mu) + 2.0 * mu * outer**2)
    assert np.allclose(u, A * (1.0 - outer**2), rtol=1e-4)
