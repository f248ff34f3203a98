"""Friction laws as descriptions: coefficients and their slopes, what the device is given of them, what is refused."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
import pytest

from warpffrf.model import laws, oils
from warpffrf.model.errors import InputError
from warpffrf.model.friction import (
    FRICTION_LAWS,
    TOLERANCE,
    as_friction,
    as_lumped_friction,
    as_pair_friction,
    cubic_pieces,
)

FALLING: list[Any] = [
    laws.Stribeck(0.4, 0.2, 0.05),
    laws.Stribeck(0.4, 0.2, 0.05, exponent=1.0),
    laws.Stribeck(0.4, 0.2, 0.05, exponent=1.5),
    laws.TabulatedFriction((0.0, 0.01, 0.1, 0.5), (0.4, 0.3, 0.1, 0.25)),
    laws.TractionCurve(0.06, 0.02, 0.03, 0.3),
    laws.EyringTraction(0.005, 1e-3, 0.03),
]
SAME: list[Any] = [laws.Coulomb(0.3), laws.RegularisedCoulomb(0.3, 1e-3)]


@dataclass(frozen=True)
class Viscous(laws.FrictionLaw):
    """A law of one's own: mu(v) = mu_0 + c v up to a speed."""

    coefficient: float
    slope: float
    fastest: float
    kind: ClassVar[str] = "viscous"

    @property
    def breaks(self) -> tuple[float, ...]:
        return 0.0, self.fastest

    def coefficient_at(self, speed: Any) -> np.ndarray:
        return self.coefficient + self.slope * np.minimum(np.asarray(speed, float), self.fastest)

    def slope_at(self, speed: Any) -> np.ndarray:
        return np.where(np.asarray(speed, float) < self.fastest, self.slope, 0.0)


def test_stribeck_falls_from_static_to_kinetic() -> None:
    """By the factor e of their difference at the decay velocity, whatever the exponent."""
    for law in FALLING[:3]:
        found = law.coefficient_at([0.0, 0.05, 10.0])
        assert found == pytest.approx([0.4, 0.2 + 0.2 * np.exp(-1.0), 0.2], rel=1e-12)
        assert (law.static_coefficient, law.largest_coefficient) == (0.4, 0.4)
        assert law.least_coefficient == pytest.approx(0.2, rel=1e-11)


@pytest.mark.parametrize("law", [*FALLING, Viscous(0.1, 0.5, 2.0)], ids=lambda law: law.kind)
def test_slopes_are_those_of_the_coefficient(law: Any) -> None:
    v = np.linspace(1e-3, 1.3 * law.breaks[-1], 301)
    v = v[np.abs(v[:, None] - np.array(law.breaks)).min(axis=1) > 1e-6]
    d = 1e-7
    difference = (law.coefficient_at(v + d) - law.coefficient_at(v - d)) / (2.0 * d)
    np.testing.assert_allclose(law.slope_at(v), difference, rtol=1e-5, atol=1e-7)


@pytest.mark.parametrize("law", [*FALLING, Viscous(0.1, 0.5, 2.0)], ids=lambda law: law.kind)
def test_pieces_are_the_law(law: Any) -> None:
    """At any speed, and few of them; of a table its own lines."""
    pieces = cubic_pieces(law, "pair")
    v = np.concatenate([np.linspace(0.0, 1.2 * law.breaks[-1], 20001), np.geomspace(1e-12, 10.0, 500)])
    row = pieces[np.searchsorted(pieces[:, 0], v, side="right") - 1]
    x = v - row[:, 0]
    value = row[:, 1] + x * (row[:, 2] + x * (row[:, 3] + x * row[:, 4]))
    assert np.abs(value - law.coefficient_at(v)).max() < 2.0 * TOLERANCE * law.largest_coefficient
    assert len(pieces) == (len(law.breaks) if law.kind in ("tabulated_friction", "viscous") else len(pieces)) < 1000


def test_laws_that_do_not_depend_on_speed() -> None:
    for law in SAME:
        assert law.breaks == () and law.static_coefficient == law.largest_coefficient == law.least_coefficient == 0.3
        assert np.array_equal(law.coefficient_at([0.0, 1e-4, 5.0]), [0.3] * 3) and not law.slope_at([0.0, 1.0]).any()
    assert (SAME[0].creep_limit, SAME[1].creep_limit) == (0.0, 1e-3)
    assert not laws.Coulomb(0.0).acts and all(law.acts for law in (*SAME, *FALLING))


def test_every_law_is_registered_and_described() -> None:
    assert {law.kind for law in (*SAME, *FALLING)} == set(FRICTION_LAWS)
    described = [repr(law.describe()) for law in (*SAME, *FALLING)]
    assert len(set(described)) == len(described)
    assert FALLING[3].describe()["speeds"] == [0.0, 0.01, 0.1, 0.5]
    own = Viscous(0.1, 0.5, 2.0)
    assert as_friction(own, "pair") is own and own.describe()["slope"] == 0.5


def test_traction_of_an_oil() -> None:
    """Newtonian at first, mu_p v/h over p; then the Eyring stress times asinh, up to the limiting shear stress."""
    oil, p, h = oils.Roelands(0.04, coefficient=2e-8), 0.8e9, 0.4e-6
    law = laws.EyringTraction.of_oil(oil, pressure=p, film=h, limit=0.05, eyring_stress=5e6)
    mu = float(oil.viscosity_at(p))
    v = law.creep_limit
    assert law.coefficient_at(0.0) * p == pytest.approx(mu * v / h, rel=2e-2)  # and below in proportion
    rate = 0.1 / h
    assert law.coefficient_at(0.1) * p == pytest.approx(5e6 * np.arcsinh(mu * rate / 5e6), rel=1e-12)
    assert law.coefficient_at(1e4) == pytest.approx(0.05) and law.largest_coefficient == pytest.approx(0.05)
    early = laws.EyringTraction(0.01, 1e-3, 1e-3)  # the limit is reached before the oil thins
    assert early.coefficient_at([0.0, 1.0]) == pytest.approx([1e-3, 1e-3]) and early.breaks == (0.0, early.creep_limit)


REFUSED: list[tuple[Any, str]] = [
    (lambda: laws.Stribeck(0.2, 0.4, 0.1), r"kinetic must be at most static, .*; .*laws.TabulatedFriction"),
    (lambda: laws.Stribeck(0.4, 0.0, 0.1), r"Stribeck: kinetic must be greater than zero"),
    (lambda: laws.Stribeck(0.4, 0.2, 0.0), r"decay_velocity \[m/s\] must be greater than zero"),
    (lambda: laws.Stribeck(0.4, 0.2, 0.1, exponent=0.5), r"exponent must be at least 1, got 0.5"),
    (lambda: laws.TractionCurve(0.03, 0.1, 0.06, 0.1), r"limit must be at most peak"),
    (lambda: laws.TractionCurve(0.06, 0.0, 0.03, 0.1), r"peak_velocity \[m/s\] must be greater than zero"),
    (lambda: as_pair_friction(laws.TractionCurve(0.06, 0.1, 0.03, 0.1), "c"), r"c: laws.TractionCurve is a law"),
    (lambda: laws.EyringTraction(1e-4, 1e-3, 0.05), r"not reached at any speed with the stress_ratio 0.0001; .*over"),
    (lambda: laws.EyringTraction(0.005, 0.0, 0.05), r"EyringTraction: velocity \[m/s\] must be greater than zero"),
    (lambda: as_pair_friction(laws.EyringTraction(0.005, 1e-3, 0.05), "c"), r"c: laws.EyringTraction is a law"),
    (lambda: as_lumped_friction(laws.Stribeck(0.4, 0.2, 0.1), "c"), r"on the slip speed, .*TractionCurve"),
    (lambda: laws.TabulatedFriction((0.0,), (0.3,)), r"two at least"),
    (lambda: laws.TabulatedFriction((0.0, 1.0), (0.3, 0.2, 0.1)), r"as many coefficients as speeds"),
    (lambda: laws.TabulatedFriction((0.1, 1.0), (0.3, 0.2)), r"first speed must be 0, got 0.1"),
    (lambda: laws.TabulatedFriction((0.0, 1.0, 0.5), (0.3, 0.2, 0.1)), r"is not monotonic, speeds must rise"),
    (lambda: laws.TabulatedFriction((0.0, 1.0), (0.3, 0.0)), r"coefficients must be positive, got 0"),
    (lambda: cubic_pieces(Viscous(0.1, -0.5, 2.0), "contact 'a'"), r"contact 'a': viscous has a .* that is negative"),
]  # fmt: skip


@pytest.mark.parametrize("index", range(len(REFUSED)))
def test_what_is_refused(index: int) -> None:
    make, message = REFUSED[index]
    with pytest.raises(InputError, match=message):
        make()


def test_a_coefficient_that_jumps_is_refused() -> None:
    class Jumping(Viscous):
        def coefficient_at(self, speed: Any) -> np.ndarray:
            return np.where(np.asarray(speed, float) < 1.2, 0.4, 0.2)

    with pytest.raises(InputError, match="pair: the coefficient of viscous jumps near 1.2 m/s"):
        cubic_pieces(Jumping(0.1, 0.0, 2.0), "pair")


def test_a_coefficient_with_an_extreme_that_is_not_named_is_refused() -> None:
    class Humped(Viscous):
        def coefficient_at(self, speed: Any) -> np.ndarray:
            return 0.2 + 0.1 * np.sin(np.pi * np.minimum(np.asarray(speed, float) / self.fastest, 1.0))

    with pytest.raises(InputError, match="pair: the coefficient of viscous rises and falls .* add the speed"):
        cubic_pieces(Humped(0.2, 0.0, 2.0), "pair")
