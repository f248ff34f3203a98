"""Formulas of lubrication, life and losses of rolling bearings, against published examples and tables."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import warpffrf as wf
from warpffrf.model.bearings import BallGeometry, RollerGeometry
from warpffrf.model.bearings.life import BasicLife, basic_life
from warpffrf.model.bearings.lubrication import FilmThickness, film_of_lines, film_of_points, starved, thermal_factor
from warpffrf.model.bearings.modified_life import (
    CLEANLINESS,
    fatigue_load_limit,
    life_factor,
    modified_life,
    reliability_factor,
    static_safety,
)
from warpffrf.model.errors import InputError

PUBLISHED = 3e-2  # of published films, which have two or three digits
UM, RPM = 1e-6, np.pi / 30.0
OIL = wf.oils.Barus(0.04, coefficient=2.3e-8)


def star(youngs_modulus: float, poisson_ratio: float = 0.3) -> float:
    """E* [Pa] of two equal bodies."""
    return 0.5 * youngs_modulus / (1.0 - poisson_ratio**2)


def test_film_of_a_209_ball_bearing() -> None:
    """B. J. Hamrock, Fundamentals of Fluid Film Lubrication (NASA RP-1255, 1991), example of the radial ball bearing:
    8.9 kN on nine balls, 400 rad/s, 0.04 Pa s, 2.3e-8 1/Pa; 0.557 um under the most loaded ball on the inner ring."""
    D, d, r = 0.0127, 0.5 * (0.052291 + 0.077706), 0.006604
    R = D * (d - D) / (2.0 * d)
    across = r * D / (2.0 * r - D)
    film = film_of_points(
        OIL, speed=400.0 * (d**2 - D**2) / (4.0 * d), load=5.0 * 8900.0 / 9.0, radius=R,
        ratio=1.0339 * (across / R) ** 0.636, modulus=star(200e9),
    )  # fmt: skip
    assert film.minimum == pytest.approx(0.557 * UM, rel=PUBLISHED) and film.central > film.minimum


def test_film_of_a_roller_by_the_formula_of_points() -> None:
    """The same, example of the cylindrical roller bearing: 4.8 kN on the most loaded roller of 16 mm, races of 64 and
    96 mm, 524 rad/s, 0.01 Pa s, 2.2e-8 1/Pa, the formula of ellipses without its end: 0.32 um on the inner ring."""
    oil, u = wf.oils.Barus(0.01, coefficient=2.2e-8), 524.0 * (0.08**2 - 0.016**2) / (4.0 * 0.08)
    film = film_of_points(
        oil, speed=u, load=4800.0, radius=0.0064, ratio=np.inf, modulus=star(207.5e9)
    )  # fmt: skip
    assert film.minimum == pytest.approx(0.32 * UM, rel=PUBLISHED)
    line = film_of_lines(oil, speed=u, line_load=4800.0 / 0.016, radius=0.0064, modulus=star(207.5e9))
    assert film.minimum < line.minimum < 1.3 * film.minimum  # the formulas of the time are that far apart


@pytest.mark.parametrize(("distance", "published"), [(0.01, 0.059), (1.0, 0.281)])
def test_film_of_a_ball_that_rolls_down_a_plate(distance: float, published: float) -> None:
    """G. W. Stachowiak and A. W. Batchelor, Engineering Tribology, problem of a 30 mm steel ball on a plate at 45
    degrees, 0.05 Pa s, 2.2e-8 1/Pa: h_0 after 1 cm and 1 m. The book's radius is half of R, its speed half the ball's,
    and its k of a circle 1.0339."""
    d, incline, E = 0.03, np.radians(45.0), star(210e9)
    v = np.sqrt(10.0 / 7.0 * 9.81 * np.sin(incline) * distance)
    load = 7800.0 * np.pi * d**3 / 6.0 * 9.81 * np.cos(incline)
    film = film_of_points(
        wf.oils.Barus(0.05, coefficient=2.2e-8), speed=0.5 * v, load=load, radius=0.25 * d, ratio=1.0339, modulus=E
    )
    assert film.minimum == pytest.approx(published * UM, rel=1e-2)


def test_a_line_is_dowsons_formula_of_1968() -> None:
    """H = 2.65 U^0.7 G^0.54/W'^0.13 at U = 1e-11, G = 5000, W' = 1e-4: 1.69e-5, by hand."""
    E, R = 0.5 * 200e9, 0.01
    oil = wf.oils.Barus(1e-11 * 200e9 * R / 2.0, coefficient=5000.0 / 200e9)
    film = film_of_lines(oil, speed=2.0, line_load=1e-4 * 200e9 * R, radius=R, modulus=E)
    by_hand = 2.65 * 10 ** (-7.7) * np.exp(0.54 * np.log(5000.0)) * 10**0.52
    assert film.minimum / R == pytest.approx(by_hand, rel=1e-12)
    assert film.minimum / film.central == pytest.approx(0.8, abs=0.1)  # the constriction at the outlet


def test_heat_and_starvation_only_thin_a_film() -> None:
    """No effect of slow rolling and of a far inlet; the factors of the published formulas in between."""
    film = FilmThickness(np.array([0.5 * UM]), np.array([0.3 * UM]))
    R, b = 0.005, 0.2e-3
    need = 1.0 + 3.06 * ((R / b) ** 2 * 0.5 * UM / R) ** 0.58
    far = starved(film, inlet=1.01 * need * b, half_axis=b, radius=R)
    assert far.central == pytest.approx(film.central)
    half = starved(film, inlet=(1.0 + 0.5 * (need - 1.0)) * b, half_axis=b, radius=R)
    assert half.central == pytest.approx(0.5**0.29 * film.central)

    def phi(u: float, slip: float) -> float:
        return float(thermal_factor(OIL, speed=u, slip=slip, peak_pressure=1e9, modulus=star(200e9), thinning=0.04))

    assert phi(0.0, 0.0) == 1.0 and phi(1e-3, 0.0) == pytest.approx(1.0, abs=2e-3)
    L = 0.04 * 0.04 * 100.0 / 0.14
    E = 2.0 * star(200e9)
    by_hand = (1.0 - 13.2 * 1e9 / E * L**0.42) / (1.0 + 0.213 * (1.0 + 2.23 * 0.1**0.83) * L**0.64)
    assert phi(10.0, 1.0) == pytest.approx(by_hand) and phi(10.0, 1.0) < phi(10.0, 0.0) < phi(5.0, 0.0)
    assert np.isnan(phi(1e3, 0.0))


def test_drag_of_elements_in_oil() -> None:
    """Stokes' drag of slow spheres; measured c_d of faster ones, 0.42 at Re = 8000, of cylinders 1.5 at 100 and 1.2
    at 1e4, which the formulas meet within 20 %."""
    ball = BallGeometry(elements=9, ball_diameter=0.0127, pitch_diameter=0.065)
    arm, D = 0.0325, 0.0127
    w, mu = 1e-4, 0.05
    slow = wf.bearings.drag_torque(ball, w, density=880.0, viscosity=mu)
    assert slow == pytest.approx(9 * arm * 3.0 * np.pi * mu * D * w * arm, rel=0.02)
    fast = wf.bearings.drag_torque(ball, [-200.0, 200.0], density=100.0, viscosity=1e-3)
    assert fast[1] == -fast[0] > 0.0
    assert fast[1] == pytest.approx(9 * arm * 0.5 * 100.0 * 0.42 * 0.25 * np.pi * D**2 * (200.0 * arm) ** 2, rel=0.2)
    rows = BallGeometry(elements=9, ball_diameter=D, pitch_diameter=0.065, contact_angle=0.5, rows=2, row_spacing=0.015)
    both = wf.bearings.drag_torque(rows, 200.0, density=100.0, viscosity=1e-3)
    assert both == pytest.approx(2.0 * fast[1])
    roller = RollerGeometry(elements=9, roller_diameter=D, roller_length=D, pitch_diameter=0.065)
    for Re, c_d in ((100.0, 1.5), (1e4, 1.2)):
        torque = wf.bearings.drag_torque(roller, Re * 1e-3 / (1000.0 * D * arm), density=1000.0, viscosity=1e-3)
        v = Re * 1e-3 / (1000.0 * D)
        assert torque == pytest.approx(9 * arm * 0.5 * 1000.0 * c_d * D**2 * v**2, rel=0.2)


def test_torque_of_the_catalogue() -> None:
    """A 6208 (d_pw 60 mm) at 3000 rpm with 20 mm2/s: 1e-7 f_0 (60000)^(2/3) 60^3 N mm and f_1 P d_pw, and the branch of
    slow bearings."""
    M_0, M_1 = wf.bearings.catalogue_torque(0.06, 3000.0 * RPM, viscosity=20e-6, load=2000.0, f0=2.0, f1=0.0004)
    assert M_0 == pytest.approx(66.2e-3, rel=1e-3) and M_1 == pytest.approx(48e-3)
    slow, _ = wf.bearings.catalogue_torque(0.06, 50.0 * RPM, viscosity=20e-6, load=2000.0, f0=2.0, f1=0.0004)
    assert slow == pytest.approx(160e-7 * 2.0 * 60.0**3 * 1e-3)


def test_reliability_factors_of_iso_281() -> None:
    """Table 12 of ISO 281:2007, of which 90 to 99 and 99.95 % also stand in NREL/TP-500-42362 (2009), table 8."""
    table = {
        90: 1.0, 95: 0.64, 96: 0.55, 97: 0.47, 98: 0.37, 99: 0.25, 99.2: 0.22, 99.4: 0.19, 99.6: 0.16, 99.8: 0.12,
        99.9: 0.093, 99.92: 0.087, 99.94: 0.080, 99.95: 0.077,
    }  # fmt: skip
    found = [reliability_factor(S) for S in table]
    assert found == pytest.approx(list(table.values()), abs=6e-3)


@pytest.mark.parametrize("kind", ["ball", "roller"])
def test_life_factor_is_continuous_and_has_its_limits(kind: str) -> None:
    """The constants of neighbouring ranges meet (a wrong digit would not); 0.1 where contamination governs, 50 at most,
    no more beyond kappa = 4; a thrust bearing has less."""
    for kappa in (0.4, 1.0):
        below, above = life_factor(kind, kappa * (1.0 - 1e-9), 0.2), life_factor(kind, kappa, 0.2)
        assert below == pytest.approx(above, rel=2e-3)
    kappas = np.linspace(0.1, 4.0, 40)
    assert np.all(np.diff([life_factor(kind, k, 0.2) for k in kappas]) >= 0.0)
    assert life_factor(kind, 2.0, 0.0) == pytest.approx(0.1) and life_factor(kind, 4.0, 5.0) == 50.0
    assert life_factor(kind, 7.0, 0.05) == life_factor(kind, 4.0, 0.05)
    assert life_factor(kind, 2.0, 0.2, thrust=True) < life_factor(kind, 2.0, 0.2)


def test_life_factor_of_radial_balls() -> None:
    """Read from the diagram of ISO 281 for radial ball bearings: at e_C C_u/P = 0.1 some 2.4 at kappa 1, 7 at 4."""
    assert life_factor("ball", 1.0, 0.1) == pytest.approx(2.4, rel=0.05)
    assert life_factor("ball", 4.0, 0.1) == pytest.approx(7.0, rel=0.05)


def test_viscosity_ratio() -> None:
    """nu_1 = 4500/sqrt(n d_pw), of d_pw 72.5 mm at 3000 rpm 9.65 mm2/s; both branches nearly meet at 1000 rpm."""
    kappa = wf.bearings.viscosity_ratio(20e-6, 3000.0 * RPM, 0.0725)
    assert kappa == pytest.approx(20.0 / 9.65, rel=1e-3)
    at = [wf.bearings.viscosity_ratio(20e-6, n * RPM, 0.0725) for n in (999.9, 1000.1)]
    assert at[0] == pytest.approx(at[1], rel=3e-2)


def test_contamination_is_within_the_guide_values() -> None:
    """ISO 281, table 13, from a pitch diameter of 100 mm on, and it falls from class to class."""
    for lubrication, classes in CLEANLINESS.items():
        for d in (0.05, 0.2, 0.6):
            found = [wf.bearings.contamination_factor(lubrication, name, 1.0, d) for name in classes]
            assert np.all(np.diff(found) <= 0.0) and 0.0 <= found[-1] < found[0] <= 1.0
    guide = {
        ("filtered", "-/13/10"): (0.8, 0.91), ("filtered", "-/15/12"): (0.6, 0.85),
        ("filtered", "-/17/14"): (0.35, 0.7),
        ("bath", "-/13/10"): (0.8, 0.9), ("bath", "-/15/12"): (0.4, 0.8), ("grease", "high"): (0.8, 0.9),
        ("grease", "normal"): (0.6, 0.8), ("grease", "slight"): (0.2, 0.6), ("grease", "severe"): (0.0, 0.2),
        ("grease", "very severe"): (0.0, 0.1),
    }  # fmt: skip
    for (lubrication, name), (low, high) in guide.items():
        assert low <= wf.bearings.contamination_factor(lubrication, name, 1.0, 0.2) <= high, (lubrication, name)


@pytest.mark.parametrize(
    ("cleanliness", "c", "g"),
    [("high", 0.0864, 0.6796), ("normal", 0.0432, 1.141), ("slight", 0.0177, 1.887), ("severe", 0.0115, 2.662),
     ("very severe", 0.00617, 4.06)],
)  # fmt: skip
def test_contamination_of_greases(cleanliness: str, c: float, g: float) -> None:
    """c and g of NREL/TP-500-42362 (2009), table 7, of d_pw = 216 mm, whose cube root is 6."""
    found = wf.bearings.contamination_factor("grease", cleanliness, 1.0, 0.216)
    assert found == pytest.approx(min(c * 216.0**0.55, 1.0) * (1.0 - g / 6.0))


def test_fatigue_load_limit() -> None:
    assert fatigue_load_limit("ball", 22e3, 0.08) == pytest.approx(1e3)
    assert fatigue_load_limit("ball", 22e3, 0.4) == pytest.approx(500.0)
    assert fatigue_load_limit("roller", 8.2e3, 0.2) == pytest.approx(1e3 * 0.5**0.3)


def test_modified_life_has_the_load_of_the_life_that_it_modifies() -> None:
    basic = basic_life("ball", 30e3, 3e3)
    found = modified_life("ball", basic, 900.0, 1.5, 0.4, reliability=95.0)
    assert found.load == pytest.approx(3e3) and found.reliability_factor == pytest.approx(0.64, abs=5e-3)
    expected = found.reliability_factor * life_factor("ball", 1.5, 0.4 * 900.0 / 3e3) * 1000.0
    assert found.revolutions == pytest.approx(expected)


def test_duty_cycle() -> None:
    """Of one point its own life; two halves with lives of 100 and 300: of every second each does its speed over its
    life; the mean of equal speeds is harmonic."""
    one = wf.bearings.duty_life([(1.0, 100.0, 50.0)])
    assert one.revolutions == pytest.approx(50.0) and one.time == pytest.approx(50e6 * 2.0 * np.pi / 100.0)
    two = wf.bearings.duty_life([(0.5, 100.0, 100.0), (0.5, -100.0, 300.0)])
    assert two.revolutions == pytest.approx(150.0) and two.shares == pytest.approx([0.75, 0.25])
    rests = wf.bearings.duty_life([(0.25, 0.0, 1.0), (0.75, 100.0, 50.0)])
    assert rests.revolutions == pytest.approx(50.0) and rests.time == pytest.approx(one.time / 0.75)


def test_static_safety() -> None:
    """P_0 of a deep-groove bearing is 0.6 F_r + 0.5 F_a, at least F_r."""
    assert static_safety(11.6e3, 2000.0, 500.0) == pytest.approx(5.8)
    assert static_safety(10e3, 1000.0, -2800.0) == pytest.approx(5.0)


@pytest.mark.parametrize(
    ("make", "said"),
    [
        (lambda: film_of_lines(wf.oils.Newtonian(0.04), speed=1.0, line_load=1.0, radius=1.0, modulus=1e9),
         r"viscosity rises with pressure is needed, oils.Barus\("),
        (lambda: starved(FilmThickness(*np.ones((2, 1))), inlet=1e-4, half_axis=2e-4, radius=0.01),
         "beyond its half-axis of 0.0002 m, got 0.0001"),
        (lambda: reliability_factor(0.99), "between 90 and 99.95 %"),
        (lambda: wf.bearings.viscosity_ratio(20.0, 100.0, 0.07), "46 mm2/s are 46e-6 m2/s"),
        (lambda: wf.bearings.viscosity_ratio(20e-6, 0.0, 0.07), "at rest has no film"),
        (lambda: wf.bearings.contamination_factor("oil", "-/15/12", 1.0, 0.1), "'bath', 'grease', got 'oil'"),
        (lambda: wf.bearings.contamination_factor("grease", "-/15/12", 1.0, 0.1), "cleanliness of 'grease' must"),
        (lambda: life_factor("ball", 0.05, 0.1), "kappa must be 0.1 at least, got 0.05"),
        (lambda: life_factor("needle", 1.0, 0.1), "kind must be 'ball' or 'roller', got 'needle'"),
        (lambda: modified_life("ball", BasicLife(1.0, 1.0, 1.0, 1.0, 0.0), 1.0, 1, 2), "between 0 and 1"),
        (lambda: wf.bearings.duty_life([(0.5, 100.0, 1.0)]), "add up to 0.5; make their sum 1"),
        (lambda: wf.bearings.duty_life([(1.0, 0.0, 1.0)]), "no point has a speed"),
        (lambda: wf.bearings.duty_life([(1.0, 2.0)]), r"must be \(share, speed"),  # type: ignore[list-item]
        (lambda: static_safety(1e3, 0.0), "the safety is unbounded"),
    ],
)  # fmt: skip
def test_what_has_no_answer_is_refused(make: Any, said: str) -> None:
    with pytest.raises(InputError, match=said):
        make()
