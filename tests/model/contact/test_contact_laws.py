"""Contact laws as descriptions: pressure is the slope of the energy, limits, restitution, and what is refused."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from scipy.integrate import quad, solve_ivp

from warpffrf.model import laws
from warpffrf.model.errors import InputError
from warpffrf.model.laws.curves.curve import SHIFT
from warpffrf.model.laws.hunt_crossley import chi_times_speed

LAYERS = [
    laws.LinearLayer(1e12),
    laws.NonlinearLayer(1e15, 1.5),
    laws.NonlinearLayer(1e12, 1.0),
    laws.NonlinearLayer(1e25, 3.0),
    laws.TabulatedLayer((-4e-6, -2e-6, -1e-6, 0.5e-6), (9e6, 3e6, 1e6, 0.0)),
    laws.ExponentialAsperities(1e7, 1e-6),
    laws.ExponentialAsperities(1e7, 1e-6, cut=3e-6),
    laws.GreenwoodTripp(1e-6, 1e9, 5e-5, 1e11),
    laws.HuntCrossley(1e15, 1.5, damping=2.0),
]


@pytest.mark.parametrize("law", LAYERS, ids=lambda law: law.kind)
def test_pressure_is_the_slope_of_the_energy(law: Any) -> None:
    """W(g) = int_g^inf p dg', by quadrature; p falls with the gap, and ends."""
    ends = getattr(law, "end", max(getattr(law, "gaps", (0.0,))))
    kinks = -law.curve.table[1:, 0]
    for gap in (-3.7e-6, -1.2e-6, -1e-8):
        inside = kinks[kinks > gap]
        work, _ = quad(
            lambda g: float(law.pressure(g)), gap, ends, points=inside, epsabs=0.0, epsrel=1e-12,
            limit=400 + 2 * len(inside),
        )  # fmt: skip
        assert float(law.energy(gap)) == pytest.approx(work, rel=1e-9)
    g = np.linspace(-4e-6, ends, 500)
    assert np.all(np.diff(law.pressure(g)) < 0.0)
    beyond = law.pressure(np.array([ends, ends + 1e-9, 1.0]))
    assert np.abs(beyond).max() <= 1e-15 * law.pressure(g[0])
    assert np.abs(law.energy(np.array([ends, 1.0]))).max() <= 1e-15 * law.energy(g[0])


def test_powers_are_shifted_by_no_more_than_they_say() -> None:
    for exponent in (1.0, 1.5, 3.0):
        for depth in (1e-8, 1e-6, 1e-4):
            found = float(laws.NonlinearLayer(1e15, exponent).pressure(-depth))
            rounding = 4e-16 * depth / SHIFT  # of a difference of powers, at exponent 1
            assert abs(found / (1e15 * depth**exponent) - 1.0) < 1.01 * exponent * SHIFT / depth + rounding


def test_uniform_pressure_on_asperities() -> None:
    """g = lambda ln(p_0/p), the closed form of the law, over four decades of the pressure."""
    law = laws.ExponentialAsperities(1e7, 0.5e-6)
    for p in (1e4, 1e6, 1e8):
        gap = 0.5e-6 * np.log(1e7 / p)
        assert float(law.pressure(gap)) == pytest.approx(p, abs=1.01e-6 * 1e7)
    assert law.end == pytest.approx(0.5e-6 * np.log(1e6))


def test_a_table_goes_on_beyond_its_smallest_gap() -> None:
    law = laws.TabulatedLayer((-2e-6, -1e-6, 0.0), (5e6, 1e6, 0.0))
    assert float(law.pressure(-3e-6)) == pytest.approx(9e6)
    assert float(law.pressure(-0.5e-6)) == pytest.approx(0.5e6)


@pytest.mark.parametrize("restitution", [0.999, 0.8, 0.5, 0.1])
@pytest.mark.parametrize("power", [1.5, 2.5])
def test_restitution(restitution: float, power: float) -> None:
    """A mass on p = K d^power (1 + chi d_dot), integrated in time: it leaves with e v, whatever the power."""
    m, v, K = 2.0, 0.3, 1e9
    chi = laws.HuntCrossley(1.0, 1.0, restitution=restitution, impact_speed=v).chi

    def rate(_: float, y: np.ndarray) -> list[float]:
        return [y[1], -K * max(y[0], 0.0) ** power * max(1.0 + chi * y[1], 0.0) / m]

    def leaves(_: float, y: np.ndarray) -> float:
        return y[0]

    leaves.terminal, leaves.direction = True, -1.0  # type: ignore[attr-defined]
    found = solve_ivp(rate, (0.0, 1.0), (1e-12, v), events=leaves, rtol=1e-10, atol=1e-13)
    assert -found.y[1, -1] / v == pytest.approx(restitution, rel=1e-6)
    assert -found.y[1, -1] * chi < 1.0  # so that the pressure was never cut


def test_restitution_near_one_is_the_first_order_formula() -> None:
    for e in (1.0 - 1e-4, 1.0 - 1e-7, 1.0 - 1e-10):
        second = 1.5 * (1.0 - e**2) / (1.0 + e**3)
        assert chi_times_speed(e) == pytest.approx(second, rel=1e-3 * (1.0 - e) + 1e-6)
    assert chi_times_speed(1.0) == 0.0


def test_damped_pressure_is_never_tensile() -> None:
    law = laws.HuntCrossley(1e15, 1.5, damping=2.0)
    gap, speed = np.meshgrid(np.linspace(-1e-5, 1e-6, 40), np.linspace(-5.0, 5.0, 40))
    p = law.pressure(gap, speed)
    assert p.min() == 0.0
    elastic = law.pressure(gap)
    assert np.all((p - elastic) * speed >= 0.0)  # what is not elastic takes energy


REFUSED = [
    (lambda: laws.NonlinearLayer(-1.0, 1.5), r"NonlinearLayer: stiffness .* greater than zero"),
    (lambda: laws.NonlinearLayer(1.0, 0.5), r"NonlinearLayer: exponent must be at least 1, got 0.5; .*TabulatedLayer"),
    (lambda: laws.NonlinearLayer(1.0, float("nan")), r"NonlinearLayer: exponent must be finite"),
    (lambda: laws.HuntCrossley(0.0, 1.5, damping=1.0), r"HuntCrossley: stiffness"),
    (lambda: laws.HuntCrossley(1.0, 1.5, damping=-1.0), r"HuntCrossley: damping .* must not be negative"),
    (lambda: laws.HuntCrossley(1.0, 1.5), r"give damping, or restitution with its impact_speed"),
    (lambda: laws.HuntCrossley(1.0, 1.5, damping=1.0, restitution=0.5), r"give damping, or restitution"),
    (lambda: laws.HuntCrossley(1.0, 1.5, restitution=0.5), r"restitution and impact_speed belong together"),
    (lambda: laws.HuntCrossley(1.0, 1.5, restitution=1.2, impact_speed=1.0), r"restitution must be at most 1"),
    (lambda: laws.HuntCrossley(1.0, 1.5, restitution=0.0, impact_speed=1.0), r"restitution must be greater than zero"),
    (lambda: laws.ExponentialAsperities(-1e6, 1e-6), r"pressure_at_zero \[Pa\] must be greater than zero"),
    (lambda: laws.ExponentialAsperities(1e6, 0.0), r"decay_length \[m\] must be greater than zero"),
    (lambda: laws.ExponentialAsperities(1e6, 1e-6, cut=-1e-6), r"cut \[m\] must be greater than zero"),
    (lambda: laws.ExponentialAsperities(1e6, 1e-6, cut=1.0), r"cut must be at most 300 decay lengths"),
    (lambda: laws.TabulatedLayer((0.0,), (0.0,)), r"two at least"),
    (lambda: laws.TabulatedLayer((-1e-6, 0.0), (1e6, 5e5, 0.0)), r"as many pressures as gaps"),
    (lambda: laws.TabulatedLayer((0.0, -1e-6), (1e6, 0.0)), r"is not monotonic, gaps must rise"),
    (lambda: laws.TabulatedLayer((-2e-6, -1e-6, 0.0), (1e6, 2e6, 0.0)), r"is not monotonic, pressures must fall"),
    (lambda: laws.TabulatedLayer((-1e-6, 0.0), (1e6, 1e5)), r"last pressure must be 0"),
]


@pytest.mark.parametrize("index", range(len(REFUSED)))
def test_what_is_refused(index: int) -> None:
    make, message = REFUSED[index]
    with pytest.raises(InputError, match=message):
        make()


def test_every_law_is_registered_and_described() -> None:
    made = [laws.Unilateral(), *LAYERS]
    assert {law.kind for law in made} == set(laws.LAWS)
    described = [repr(law.describe()) for law in made]
    assert len(set(described)) == len(described)
    assert all(law.compliance == 0.0 or law.bent is None for law in made)
    same = laws.HuntCrossley(1e15, 1.5, restitution=0.7, impact_speed=0.2)
    again = laws.HuntCrossley(1e15, 1.5, damping=same.chi)
    assert same.describe() == again.describe()
