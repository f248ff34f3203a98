"""Pressed and rolling rollers: Hertz, ripple, convergence, torque, action and reaction."""

from __future__ import annotations

import numpy as np
import pytest

from references.pressure_wrench import pressure_wrench
from scenes.rollers import PAIR, Path, roller_body, solve_path
from studies.contact.convergence import rates, refine
from studies.contact.hertz import hertz_phases
from studies.contact.ripple import approach_for, element_size, ripples, window_for, worst
from warpffrf.model.reduced.body import ReducedBody

HALF_WIDTH_ERROR, PEAK_ERROR = 0.02, 0.01  # promised at 4 elements per half-width
RIPPLES = {2.0: 1e-2, 4.0: 1.5e-3}  # promised, peak to peak over mean
TORQUE = 1e-6  # of force times radius
REACTION = 1e-10


@pytest.mark.slow
def test_mid_plane_follows_hertz(fine_body: ReducedBody) -> None:
    """4 elements per half-width, 8 phases, rolling and sliding. a/R = 0.07: Hertz's parabola is right to (a/R)^2."""
    for sense, errors in hertz_phases(fine_body, 4.0).items():
        width, peak = errors.worst()
        print(f"{sense}: {errors.elements.mean():.2f} elements, half-width {width:.2%}, peak {peak:.2%}")
        assert len(errors.peak) == 8
        assert width < HALF_WIDTH_ERROR
        assert peak < PEAK_ERROR


@pytest.mark.slow
@pytest.mark.parametrize("elements", [4.0, 4.5, 5.0, 6.0])
def test_mid_plane_follows_hertz_with_more_rows(elements: float) -> None:
    """Four elements along the axis, at several sizes of the patch: the promise is for 4 *or more* elements."""
    body = roller_body(720, layers=9, axial=4, grading=1.4, order=2, modes=0)
    for sense, errors in hertz_phases(body, elements).items():
        width, peak = errors.worst()
        print(f"{sense}: {errors.elements.mean():.2f} elements, half-width {width:.2%}, peak {peak:.2%}")
        assert width < HALF_WIDTH_ERROR
        assert peak < PEAK_ERROR


@pytest.mark.parametrize("elements", list(RIPPLES))
def test_force_hardly_ripples_at_constant_approach(fine_body: ReducedBody, elements: float) -> None:
    """12 positions in a pitch, both senses, two relative phases."""
    sweeps = ripples(fine_body, elements, phases=2)
    found = worst(sweeps)
    print(f"{elements} elements: {found}")
    assert found.value < RIPPLES[elements]


@pytest.mark.slow
@pytest.mark.parametrize("elements", list(RIPPLES))
def test_force_hardly_ripples_over_sizes_and_phases(elements: float) -> None:
    """5 % about the size, 5 relative phases: the ripple is not monotone in the size."""
    body = roller_body(720, layers=9, axial=2, grading=1.4, order=2)
    found = worst(ripples(body, elements * np.linspace(0.95, 1.05, 5), phases=5))
    print(f"{elements} elements: {found}")
    assert found.value < RIPPLES[elements]


@pytest.mark.slow
@pytest.mark.parametrize("order", [1, 2])
def test_force_converges_at_the_rate_of_the_elements(order: int) -> None:
    """Linear: h^2. Quadratic: between h^2 and h^3, see `study.convergence`; three levels, the last with 2 elements a
    half-width (quadratic) or 4 (linear)."""
    levels = refine(order, 3, phases=4, cache=False)
    (rate,) = rates(levels)
    print(f"order {order}: forces {[level.force for level in levels]}, rate {rate:.2f}")
    assert rate > 1.7


def test_frictionless_torque_vanishes_and_action_equals_reaction(fine_body: ReducedBody) -> None:
    """Torque about each axle: of the pressure on the true surfaces, and the reaction of the driven axle."""
    size = element_size(fine_body)
    turn = size / 0.05 * np.linspace(0.0, 1.0, 5)
    approach = approach_for(fine_body, 2.0)[0]
    path = Path.of(np.full(5, approach), turn, 0.3 * turn)
    result = solve_path(fine_body, fine_body, path, settings=window_for(fine_body, 2.0))
    c = result.contact(PAIR)
    F, R = c.force_magnitude, 0.05
    axis = np.array([0.0, 1.0, 0.0])
    force, torque = pressure_wrench(result, PAIR)
    assert np.abs(torque @ axis).max() / (F.max() * R) < TORQUE
    assert np.abs(np.linalg.norm(force, axis=1) / F - 1.0).max() < (0.06) ** 2  # of the order of (a/R)^2
    for name in ("axle", "upper_axle"):
        assert np.abs(result.joint(name).torque @ axis).max() / (F.max() * R) < TORQUE
    assert np.abs(c.force + c.force_second).max() / F.max() < REACTION
    # torques about one point: the lower roller's origin
    arm = result.body("upper").position - result.body("lower").position
    moment = c.torque + c.torque_second + np.cross(arm, c.force_second)
    assert np.abs(moment).max() / (F.max() * R) < REACTION
