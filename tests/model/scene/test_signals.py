"""Signals: values, derivatives, integrals, and the border."""

from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import quad
from scipy.interpolate import CubicSpline

from warpffrf.model import signals
from warpffrf.model.errors import InputError

EXAMPLES = {
    "constant": signals.Constant(2.5),
    "ramp": signals.Ramp(1.0, 4.0, duration=0.3, delay=0.1),
    "smooth": signals.SmoothStep(-1.0, 2.0, duration=0.5, delay=0.2),
    "table": signals.Table([0.1, 0.3, 0.35, 1.0], [1.0, -2.0, 0.5, 0.7]),
    "step": signals.Step(-1.0, 2.0, at=0.25),
    "sine": signals.Sine(2.0, 4.0, duration=1.5, phase=0.3, mean=1.0),
    "chirp": signals.Chirp(2.0, 0.0, 8.0, duration=1.5),
    "cubic": signals.Table([-0.2, 0.3, 0.55, 1.0], [1.0, -2.0, 0.5, 0.7], cubic=True),
}


@pytest.mark.parametrize("signal", EXAMPLES.values(), ids=EXAMPLES)
def test_pieces_have_the_agreed_form(signal: signals.Signal) -> None:
    breaks, c = signal.polynomial()
    assert c.shape == (len(breaks) - 1, 8) and np.all(np.diff(breaks) > 0.0) and np.all(np.isfinite(breaks))
    np.testing.assert_allclose(signal(breaks[0] - 5.0), c[0, 0])
    # evaluated independently, piece by piece
    t = np.linspace(breaks[0], breaks[-1] + 1.0, 101)
    i = np.clip(np.searchsorted(breaks, t, side="right") - 1, 0, len(c) - 1)
    np.testing.assert_allclose(signal(t), [np.polyval(c[k][::-1], x - breaks[k]) for k, x in zip(i, t, strict=True)])


@pytest.mark.parametrize("signal", EXAMPLES.values(), ids=EXAMPLES)
def test_integral_is_the_antiderivative_from_zero(signal: signals.Signal) -> None:
    integral = signal.integral()
    assert float(integral(0.0)) == 0.0
    kinks = signal.polynomial()[0]
    for t in (0.05, 0.2, 0.33, 0.7, 1.5):
        inside = [k for k in kinks if 0.0 < k < t]
        expected = quad(lambda x: float(signal(x)), 0.0, t, points=inside or None, epsabs=1e-13, limit=400)[0]
        assert float(integral(t)) == pytest.approx(expected, abs=1e-11)
    np.testing.assert_allclose(signal.scaled(-3.0).integral()(0.8), -3.0 * integral(0.8), rtol=1e-13)


def test_ramp_and_smooth_step_values() -> None:
    ramp, smooth = EXAMPLES["ramp"], EXAMPLES["smooth"]
    np.testing.assert_allclose(ramp([0.0, 0.1, 0.25, 0.4, 9.0]), [1.0, 1.0, 2.5, 4.0, 4.0])
    np.testing.assert_allclose(smooth([0.0, 0.2, 0.45, 0.7, 9.0]), [-1.0, -1.0, 0.5, 2.0, 2.0])
    # one quarter: 6/1024 - 15/256 + 10/64
    assert float(smooth(0.325)) == pytest.approx(-1.0 + 3.0 * (6 / 1024 - 15 / 256 + 10 / 64))


def over_an_angle(t: np.ndarray) -> np.ndarray:
    """Two orders of an angle that is straight up to 0.3 s, and straight with another slope from there on."""
    angle = np.interp(t, [0.0, 0.3, 1.0], [0.0, 6.0, 40.0])
    return 0.5 + 2.0 * np.cos(angle) + 0.3 * np.sin(2.0 * angle)


CLOSED = {
    "sine": (EXAMPLES["sine"], lambda t: 1.0 + 2.0 * np.sin(8.0 * np.pi * t + 0.3), 2.0, 1.5),
    "chirp": (EXAMPLES["chirp"], lambda t: 2.0 * np.sin(np.pi * 8.0 / 1.5 * t**2), 2.0, 1.5),
    "falling chirp": (
        signals.Chirp(1.0, 9.0, 3.0, duration=2.0, phase=1.0),
        lambda t: np.sin(2.0 * np.pi * (9.0 * t - 1.5 * t**2) + 1.0), 1.0, 2.0,
    ),
    "harmonics": (
        signals.Harmonics(
            (2.0,), (0.0, 0.3), angle=signals.Table([0.0, 0.3, 1.0], [0.0, 6.0, 40.0]), duration=1.0, mean=0.5
        ),
        over_an_angle, 2.3, 1.0,
    ),
}  # fmt: skip


@pytest.mark.parametrize(("signal", "exact", "amplitude", "end"), CLOSED.values(), ids=CLOSED)
def test_sines_are_their_closed_forms_within_the_tolerance(signal, exact, amplitude: float, end: float) -> None:
    t = np.linspace(0.0, end, 20011)
    error = np.abs(signal(t) - exact(t)).max()
    assert 1e-3 * signals.TOLERANCE * amplitude < error < 1.02 * signals.TOLERANCE * amplitude
    breaks, c = signal.polynomial()
    assert breaks[0] == 0.0 and breaks[-1] == pytest.approx(end)
    if "harmonics" not in repr(signal).lower():  # whose angle has a kink
        for k in (1, 2):  # slope and curvature go on from piece to piece
            ends = [np.polynomial.Polynomial(p).deriv(k)(h) for p, h in zip(c, np.diff(breaks), strict=True)]
            begins = c[:, k] * k
            np.testing.assert_allclose(ends[:-1], begins[1:], atol=1e-9 * np.abs(begins).max())


def test_a_sine_takes_thirty_two_pieces_per_period() -> None:
    assert len(signals.Sine(1.0, 50.0, duration=0.1).polynomial()[1]) == 5 * 32


def test_a_step_is_a_jump() -> None:
    np.testing.assert_array_equal(EXAMPLES["step"]([0.0, 0.2499, 0.25, 9.0]), [-1.0, -1.0, 2.0, 2.0])


def test_a_table_of_a_file(tmp_path) -> None:
    columns: Any
    for text, columns in (
        ("# of a bench\ntime [s];speed;load\n0;5;1.5\n0.2;6;2.5\n", {"time": "time [s]", "value": "load"}),
        ("0, 1.5\n\n0.2, 2.5\n", {}),
        ("9 0 1.5\n9 2e-1 2.5\n", {"time": 1, "value": 2}),
    ):
        (tmp_path / "load.csv").write_text(text)
        found = signals.from_csv(tmp_path / "load.csv", **columns)
        np.testing.assert_array_equal([found.times, found.values], [[0.0, 0.2], [1.5, 2.5]])
    for text, columns, said in (
        ("time;load\n0;1\n1;1,5\n", {}, "'load.csv': line 3 has no number in column 1"),
        ("time;load\n0;1\n", {"value": "lod"}, "value 'lod' does not exist.*did you mean 'load'"),
        ("time;load\n", {}, "at least two times"),
    ):
        (tmp_path / "load.csv").write_text(text)
        with pytest.raises(InputError, match=said):
            signals.from_csv(tmp_path / "load.csv", **columns)
    with pytest.raises(InputError, match="'.*none.csv' does not exist; check the path"):
        signals.from_csv(tmp_path / "none.csv")


def test_units_and_cycles_of_a_file(tmp_path) -> None:
    """A cycle over the crank angle [deg] in kN, at 3000 revolutions per minute."""
    angle = np.arange(0.0, 720.0, 10.0)
    path = tmp_path / "gas.csv"
    np.savetxt(path, np.stack([angle, np.cos(np.radians(angle))], axis=1), delimiter=",")
    gas = signals.from_csv(path, time_factor=1.0 / (6.0 * 3000.0), factor=1e3, period=0.04, duration=0.1, cubic=True)
    t = np.linspace(0.0, 0.1, 1001)
    np.testing.assert_allclose(gas(t), 1e3 * np.cos(100.0 * np.pi * t), atol=1e3 * np.radians(10.0) ** 4 / 100.0)
    assert gas.covers == (-np.inf, 0.1)
    wrong: Any
    for wrong, said in (({"time_factor": 0.0}, "time_factor must be greater than zero"), ({"factor": "kN"}, "factor")):
        with pytest.raises(InputError, match=said):
            signals.from_csv(path, **wrong)


@pytest.mark.parametrize("cubic", [False, True])
@pytest.mark.parametrize("begin", [0.0, 0.07, -1.3])
def test_a_table_that_repeats(cubic: bool, begin: float) -> None:
    """Equal at times a period apart, and the table within a cycle, whether it contains the end of the cycle or not; a
    spline is smooth across it."""
    x, y = begin + np.array([0.0, 0.1, 0.25, 0.4]), np.array([1.0, -2.0, 0.5, 1.5])
    for times, values in ((x[:-1], y[:-1]), (x, y)):
        found = signals.Table(times, values, cubic=cubic, period=0.4, duration=3.0)
        t = np.linspace(0.0, 2.5, 51)
        np.testing.assert_allclose(found(t + 0.4), found(t), atol=1e-12)
        np.testing.assert_allclose(found(x[:-1] + 2.0), y[:-1], atol=1e-12)
        np.testing.assert_allclose(found(x[0] + 2.4), y[0], atol=1e-12)
        slopes = found.integral().polynomial()[1][:, 1]
        assert np.all(np.isfinite(slopes)) and found.covers == (-np.inf, 3.0)
        assert signals.Table(times, values, period=0.4, duration=3.0, hold=True).covers == (-np.inf, np.inf)


@pytest.mark.parametrize("given, said", [
    ({"period": 0.2, "duration": 1.0}, r"times span 0.3 s, more than the period of 0.2 s"),
    ({"period": 0.4}, r"needs the duration \[s\]"), ({"duration": 1.0}, "give its period too"),
    ({"period": -1.0, "duration": 1.0}, "period must be greater than zero"),
    ({"period": 0.3, "duration": 1e6}, "more than 262144 pieces; shorten duration"),
])  # fmt: skip
def test_cycles_that_cannot_be_are_refused(given: Any, said: str) -> None:
    with pytest.raises(InputError, match=said):
        signals.Table([0.0, 0.1, 0.3], [0.0, 1.0, 0.0], **given)


def test_smooth_step_is_twice_differentiable() -> None:
    breaks, c = EXAMPLES["smooth"].polynomial()
    T = breaks[1] - breaks[0]
    first, second = (np.polynomial.Polynomial(c[0]).deriv(k) for k in (1, 2))
    for slope in (first, second):
        assert abs(slope(0.0)) < 1e-12 and abs(slope(T)) < 1e-10


def test_double_integral_of_a_smooth_step() -> None:
    # mean of the step over its duration is 1/2; the second integral of the held value grows with t^2/2
    T = 0.5
    twice = signals.SmoothStep(0.0, 1.0, duration=T).integral().integral()
    velocity = signals.SmoothStep(0.0, 1.0, duration=T).integral()
    assert float(velocity(T)) == pytest.approx(T / 2)
    late = float(twice(T)) + float(velocity(T)) * 1.0 + 0.5
    assert float(twice(T + 1.0)) == pytest.approx(late)
    with pytest.raises(InputError, match="degree 7"):
        twice.integral()


def test_cubic_table_against_scipy() -> None:
    table = EXAMPLES["cubic"]
    spline = CubicSpline([-0.2, 0.3, 0.55, 1.0], [1.0, -2.0, 0.5, 0.7], bc_type="clamped")
    t = np.linspace(-0.2, 1.0, 57)
    np.testing.assert_allclose(table(t), spline(t), atol=1e-12)
    np.testing.assert_allclose(table([-3.0, 3.0]), [1.0, 0.7], atol=1e-12)


@settings(max_examples=40, deadline=None)
@given(
    st.lists(st.tuples(st.floats(0.01, 1.0), st.floats(-5.0, 5.0)), min_size=2, max_size=6),
    st.floats(-2.0, 1.0),
    st.booleans(),
)
def test_any_table_passes_through_its_points(steps, start, cubic) -> None:
    times = start + np.cumsum([s for s, _ in steps])
    values = np.array([v for _, v in steps])
    table = signals.Table(times, values, cubic=cubic)
    np.testing.assert_allclose(table(times), values, atol=1e-9)
    h = 1e-6
    integral = table.integral()
    for t in (0.5, 1.7):
        slope = (float(integral(t + h)) - float(integral(t - h))) / (2 * h)
        assert slope == pytest.approx(float(table(t)), abs=1e-3)


def test_border() -> None:
    with pytest.raises(InputError, match="signal table: values must be numbers"):
        signals.Table([0.0, 1.0], ["a", "b"])  # pyright: ignore[reportArgumentType]
    with pytest.raises(InputError, match=r"signal table: values\[1\] is nan, numbers must be finite"):
        signals.Table([0.0, 1.0, 2.0], [0.0, np.nan, 1.0])
    with pytest.raises(InputError, match=r"times\[2\]"):
        signals.Table([0.0, 1.0, 0.5], [0.0, 1.0, 2.0])
    with pytest.raises(InputError, match="two times"):
        signals.Table([0.0], [1.0])
    with pytest.raises(InputError, match="values must have shape"):
        signals.Table([0.0, 1.0], [1.0])
    with pytest.raises(InputError, match="Ramp: duration"):
        signals.Ramp(0.0, 1.0, duration=0.0)
    for end, duration in ((1.0, 1e-320), (1e300, 1e-20)):
        with pytest.raises(InputError, match="duration .* is too short to be computed with"):
            signals.SmoothStep(0.0, end, duration=duration)
    with pytest.raises(InputError, match="value must be finite"):
        signals.Constant(10**5000)
    with pytest.raises(InputError, match="SmoothStep: delay"):
        signals.SmoothStep(0.0, 1.0, duration=1.0, delay=-1.0)
    with pytest.raises(InputError, match="force"):
        signals.as_signal("much", "force")
    assert isinstance(signals.as_signal(3, "force"), signals.Constant)


def test_a_short_path_visits_every_point_once() -> None:
    rng = np.random.default_rng(4)
    points = np.stack([rng.uniform(0.0, 1e4, 400), rng.uniform(-1.0, 1.0, 400), np.full(400, 7.0)], axis=1)
    order = signals.short_path(points)
    assert order[0] == 0 and sorted(order) == list(range(400))
    scaled = points / [1e4, 2.0, 1.0]
    steps = [np.linalg.norm(np.diff(one, axis=0), axis=1).sum() for one in (scaled, scaled[order])]
    assert steps[1] < 1.5 * np.sqrt(400.0) < 0.2 * steps[0]  # about 0.9 root(n A) for the greedy path
    assert signals.short_path([[2.0, 1.0]]).tolist() == [0]
    for wrong, said in ((np.ones(2), "must have shape"), (np.zeros((0, 2)), "points is empty")):
        with pytest.raises(InputError, match=said):
            signals.short_path(wrong)
