"""The closed forms against the values of the verification cases, against each other and against direct integration."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from references.closed_forms import (
    BarImpact,
    CarterRolling,
    HertzImpact,
    LineContact,
    MindlinLine,
    MindlinPoint,
    PointContact,
    conformal_by_half_angle,
    conformal_by_load,
    contact_modulus,
    cylinder_approach,
    persson,
    tangential_compliance,
)
from references.half_space.influence import strip_displacement
from warpffrf.model.errors import InputError
from warpffrf.model.material import Material

STEEL = Material(210e9, 0.3, 7800.0, name="steel")
SOFT = Material(70e9, 0.2, 2700.0, name="soft")
DIGITS = 5e-6  # the verification cases are given to six digits
SOLVED = 1e-6  # what the conformal solution promises
LINE = LineContact(1e5, 0.025, contact_modulus(STEEL, STEEL))
POINT = PointContact(100.0, 0.01, contact_modulus(STEEL))


def test_hertz_line_and_point_have_the_values_of_c1_to_c3() -> None:
    assert pytest.approx([0.166093e-3, 383.291e6], rel=DIGITS) == [LINE.half_width, LINE.peak_pressure]
    assert cylinder_approach(1e5, 0.05, LINE.half_width, STEEL) == pytest.approx(1.81895e-6, rel=DIGITS)
    found = [POINT.half_width, POINT.peak_pressure, POINT.approach]
    assert pytest.approx([148.125e-6, 2176.13e6, 2.19410e-6], rel=DIGITS) == found
    tau, depth = LINE.largest_shear()
    assert tau / LINE.peak_pressure == pytest.approx(0.3003, rel=1e-4)
    assert depth / LINE.half_width == pytest.approx(0.786, rel=1e-3)


def test_stress_below_a_line_and_a_point() -> None:
    """On the surface -p0 and its share in the surface; below it Boussinesq's and Flamant's stress of the pressure; and
    Johnson's 0.31 p0 of shear at 0.48 a below a sphere, half of von Mises' stress there."""
    nu = STEEL.poisson_ratio
    a, p0 = POINT.half_width, POINT.peak_pressure
    assert [float(v) / p0 for v in POINT.on_axis(np.array(0.0), nu)] == pytest.approx([-0.5 - nu, -1.0], rel=1e-12)
    assert [float(v) / LINE.peak_pressure for v in LINE.on_axis(np.array(0.0))] == pytest.approx(
        [-1.0, -1.0], rel=1e-12
    )
    z = np.linspace(0.1, 2.0, 1901) * a
    mises = POINT.von_mises(z, nu)
    assert mises.max() / p0 == pytest.approx(0.62, abs=1e-3) and z[np.argmax(mises)] / a == pytest.approx(
        0.48, abs=2e-3
    )
    x, w = np.polynomial.legendre.leggauss(60)
    turn = 0.25 * np.pi * (x + 1.0)  # r = a sin(turn)
    depth = 0.7
    r = a * np.sin(turn)
    load = POINT.pressure(r) * 2.0 * np.pi * r * a * np.cos(turn) * 0.25 * np.pi * w
    R = np.hypot(r, depth * a)
    down = -3.0 * (depth * a) ** 3 / (2.0 * np.pi * R**5)
    trace = -(1.0 + nu) * depth * a / (np.pi * R**3)  # of sigma, Boussinesq
    around, below = POINT.on_axis(np.array(depth * a), nu)
    assert load @ down == pytest.approx(float(below), rel=1e-9)
    assert load @ (trace - down) == pytest.approx(2.0 * float(around), rel=1e-9)
    b = LINE.half_width
    s = b * np.sin(0.5 * np.pi * x)
    load = LINE.pressure(s) * b * np.cos(0.5 * np.pi * x) * 0.5 * np.pi * w
    square = s**2 + (depth * b) ** 2
    across, below = LINE.on_axis(np.array(depth * b))
    assert load @ (-2.0 * depth * b * s**2 / (np.pi * square**2)) == pytest.approx(float(across), rel=1e-9)
    assert load @ (-2.0 * (depth * b) ** 3 / (np.pi * square**2)) == pytest.approx(float(below), rel=1e-9)
    axial = nu * (across + below)
    wanted = np.sqrt(0.5 * ((across - axial) ** 2 + (axial - below) ** 2 + (below - across) ** 2))
    assert float(LINE.von_mises(np.array(depth * b), nu)) == pytest.approx(float(wanted), rel=1e-12)


def test_pressures_carry_the_load() -> None:
    t = np.cos(np.pi * (np.arange(2000) + 0.5) / 2000)  # Gauss-Chebyshev
    root = np.pi / 2000 * np.sqrt(1.0 - t**2)
    a = LINE.half_width
    assert a * root @ LINE.pressure(a * t) == pytest.approx(LINE.load, rel=1e-6)
    r = 0.5 * (t + 1.0) * POINT.half_width
    assert 0.5 * POINT.half_width * root @ (2.0 * np.pi * r * POINT.pressure(r)) == pytest.approx(POINT.load, rel=1e-5)


def test_mindlin_point_has_the_values_of_c4_and_c5() -> None:
    m = MindlinPoint(POINT, 0.3, tangential_compliance(STEEL))
    assert m.stick_ratio(15.0) == pytest.approx(0.79370, rel=DIGITS)
    assert float(m.loading(15.0)) == pytest.approx(0.295764e-6, rel=DIGITS)


@pytest.mark.parametrize("share", [0.2, 0.6, 1.0])
def test_mindlin_cycles_lose_the_area_they_enclose(share: float) -> None:
    for m in (MindlinPoint(POINT, 0.3, tangential_compliance(STEEL)), MindlinLine(LINE, 0.3, 10.0 * LINE.half_width)):
        peak = share * m.limit
        x, w = np.polynomial.legendre.leggauss(400)
        turn = 0.25 * np.pi * (x + 1.0) * 2.0  # Q = -peak cos(turn): smooth at both ends
        Q = -peak * np.cos(turn)
        measure = w * 0.5 * np.pi * peak * np.sin(turn)
        area = measure @ (m.unloading(Q, peak) - m.reloading(Q, peak))
        assert area == pytest.approx(m.cycle_loss(peak), rel=1e-6)
        assert float(m.unloading(-peak, peak)) == pytest.approx(-float(m.loading(peak)), rel=1e-12)
        assert float(m.loading(-peak)) == -float(m.loading(peak))


def test_mindlin_line_moves_its_stick_zone_evenly_by_what_it_says() -> None:
    """Displacement of its traction on fine strips: constant over the stick zone, and the backbone's value."""
    depth = 10.0 * LINE.half_width
    m = MindlinLine(LINE, 0.3, depth)
    force, n = 0.5 * m.limit, 4000
    w = 2.0 * LINE.half_width / n
    x = w * (np.arange(n) + 0.5) - LINE.half_width
    q = m.traction(x, force)
    assert w * q.sum() == pytest.approx(force, rel=1e-4)
    seen = np.linspace(-0.9, 0.9, 7) * m.stick_ratio(force) * LINE.half_width
    u = strip_displacement(np.subtract.outer(seen, x), w, LINE.modulus, depth) @ q
    assert np.allclose(u, float(m.loading(force)), rtol=1e-4)


def test_carter_has_the_values_of_c6() -> None:
    wanted = [2.6703e-4, 5.8377e-4, 9.9656e-4, 1.7938e-3]
    found = [CarterRolling.from_share(LINE, 0.3, q).creepage for q in (0.25, 0.5, 0.75, 0.99)]
    assert found == pytest.approx(wanted, rel=2.5e-5)  # given to five digits


@pytest.mark.parametrize("share", [-0.3, 0.75])
def test_carter_sticks_from_the_leading_edge(share: float) -> None:
    """In the stick zone the strain of the traction is the creepage; behind it the traction is full."""
    c = CarterRolling.from_share(LINE, 0.3, share)
    assert c.share == pytest.approx(share, rel=1e-12)
    a, n = LINE.half_width, 4000
    w = 2.0 * a / n
    x = w * (np.arange(n) + 0.5) - a
    q = c.traction(x)
    assert w * q.sum() == pytest.approx(c.force, rel=1e-4)
    behind = x < c.stick_end
    assert np.allclose(np.abs(q[behind]), 0.3 * LINE.pressure(x[behind]))
    seen = np.linspace(c.stick_end + 0.05 * a, 0.95 * a, 9)
    u = strip_displacement(np.subtract.outer(seen, x), w, LINE.modulus, 10.0 * a) @ q
    assert np.allclose(-np.diff(u) / np.diff(seen), c.creepage, rtol=2e-3)


def test_mindlin_and_carter_refuse_more_than_friction_can_carry() -> None:
    with pytest.raises(InputError, match="mu P"):
        MindlinLine(LINE, 0.3, 1.0).loading(0.31 * LINE.load)
    with pytest.raises(InputError, match="share"):
        CarterRolling.from_share(LINE, 0.3, 1.01)
    assert CarterRolling(LINE, 0.3, 1.0).share == 1.0


def test_hertz_impact_has_the_values_of_c7_and_solves_its_equation() -> None:
    mass = 7800.0 * 4.0 / 3.0 * np.pi * 0.01**3
    hit = HertzImpact(0.01, contact_modulus(STEEL, STEEL), mass, 0.1)
    found = [hit.approach, hit.force, hit.duration]
    assert pytest.approx([3.71195e-6, 110.025, 109.253e-6], rel=DIGITS) == found

    def motion(_t: float, y: np.ndarray) -> list[float]:
        return [y[1], -hit.stiffness / mass * max(y[0], 0.0) ** 1.5]

    def leaves(t: float, y: np.ndarray) -> float:
        return y[0] if t > 0.5 * hit.duration else 1.0

    leaves.terminal = True  # pyright: ignore[reportFunctionMemberAccess]
    run = solve_ivp(motion, (0.0, 2.0 * hit.duration), [0.0, 0.1], rtol=1e-10, atol=1e-16, events=leaves)
    assert run.t[-1] == pytest.approx(hit.duration, rel=1e-6)
    assert mass * (0.1 - run.y[1, -1]) == pytest.approx(hit.impulse, rel=1e-6)


def test_bars_have_the_values_of_c8_and_exchange_their_speeds() -> None:
    bars = BarImpact(STEEL, 1.0, 1e-4, 2.0)
    assert bars.duration == pytest.approx(385.45e-6, rel=DIGITS)
    assert bars.impulse == pytest.approx(STEEL.density * 1e-4 * 1.0 * 2.0, rel=1e-12)  # all momentum of one


@pytest.mark.parametrize("degree", [1.0, 10.0, 30.0, 60.0, 80.0])
def test_conformal_solution_of_like_bodies_is_persson_s(degree: float) -> None:
    eps = np.deg2rad(degree)
    theta = np.linspace(0.0, 0.999, 41) * eps
    found = conformal_by_half_angle(eps, 0.01, 1e-5, STEEL, STEEL)
    ratio, pressure = persson(eps, theta)
    assert found.modulus * 1e-5 / found.load == pytest.approx(ratio, rel=SOLVED)
    assert np.allclose(found.pressure(theta), pressure * found.load / 0.01, rtol=SOLVED)


@pytest.mark.parametrize("bore", [STEEL, SOFT, None])
def test_conformal_gap_closes_in_the_patch_and_nowhere_else(bore: Material | None) -> None:
    """The gap by Michell's harmonics one by one, which the solution itself sums in closed form."""
    R, clearance, eps = 0.01, 1e-5, np.deg2rad(40.0)
    found = conformal_by_half_angle(eps, R, clearance, STEEL, bore)
    N, points = 1500, 40000
    turn = np.pi * (np.arange(points) + 0.5) / points
    angles = eps * np.cos(turn)  # crowded where the root is
    measure = np.pi / points * eps * np.sin(turn)
    p = found.pressure(angles) * measure
    p_n = np.array([np.cos(n * angles) @ p for n in range(N)]) / np.pi
    p_n[0] *= 0.5
    n = np.arange(2, N)
    k1, G1 = 3.0 - 4.0 * STEEL.poisson_ratio, STEEL.lame[1]
    disc = -p_n[2:] / (4.0 * G1) * (1.0 / (n - 1) + k1 / (n + 1))
    level, shape = p_n[0] * (k1 - 1.0) / (4.0 * G1), -disc
    if bore is not None:
        k2, G2 = 3.0 - 4.0 * bore.poisson_ratio, bore.lame[1]
        level += p_n[0] / (2.0 * G2)
        shape = shape + p_n[2:] / (4.0 * G2) * (1.0 / (n + 1) + k2 / (n - 1))
    theta = np.linspace(0.0, np.pi, 181)
    moved = clearance + R * (level + np.cos(np.outer(theta, n)) @ shape)
    inside = theta < 0.97 * eps
    delta = moved[0]
    gap = moved - delta * np.cos(theta)
    assert np.abs(gap[inside]).max() < 1e-4 * clearance  # of the series cut at N
    assert gap[theta > 1.05 * eps].min() > 0.0
    assert np.pi * R * p_n[1] == pytest.approx(found.load, rel=1e-6)


def test_conformal_solution_tends_to_hertz_with_the_square_of_the_angle() -> None:
    R, clearance = 0.01, 1e-5
    worst = []
    for eps in (0.1, 0.05, 0.025):
        found = conformal_by_half_angle(eps, R, clearance, STEEL, STEEL)
        line = LineContact(found.load, R * R / clearance, found.modulus)
        worst.append(abs(line.peak_pressure / found.peak_pressure - 1.0))
        assert found.moment_angle == pytest.approx(eps, rel=eps**2)
    assert np.allclose(np.log2(np.array(worst[:-1]) / worst[1:]), 2.0, atol=0.05)


@pytest.mark.parametrize("bore", [STEEL, None])
def test_conformal_solution_is_found_by_its_load(bore: Material | None) -> None:
    for eps in (0.05, 0.5, 1.3):
        load = conformal_by_half_angle(eps, 0.01, 1e-5, STEEL, bore).load
        assert conformal_by_load(load, 0.01, 1e-5, STEEL, bore).half_angle == pytest.approx(eps, rel=1e-9)


def test_conformal_solution_has_persson_s_largest_angle_and_refuses_nonsense() -> None:
    """ln(1 + b^2) + 2 b^4 = 2: no load of a pin with clearance reaches this half-angle."""
    most = 2.0 * np.arctan(np.sqrt(0.8351))
    assert conformal_by_half_angle(most - 0.01, 1.0, 1e-3, STEEL, STEEL).load > 0.0
    assert conformal_by_half_angle(most + 0.01, 1.0, 1e-3, STEEL, STEEL).load < 0.0
    assert conformal_by_load(1e15, 1.0, 1e-3, STEEL, STEEL).half_angle < most
    with pytest.raises(InputError, match="clearance"):
        conformal_by_half_angle(0.5, 1.0, 0.0, STEEL)
    with pytest.raises(InputError, match="Hertz"):
        conformal_by_load(1e-3, 1.0, 1e-3, STEEL)
