"""Signals: values, derivatives, integrals, and the border."""

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
        expected = quad(lambda x: float(signal(x)), 0.0, t, points=inside or None, epsabs=1e-13)[0]
        assert float(integral(t)) == pytest.approx(expected, abs=1e-11)
    np.testing.assert_allclose(signal.scaled(-3.0).integral()(0.8), -3.0 * integral(0.8), rtol=1e-13)


def test_ramp_and_smooth_step_values() -> None:
    ramp, smooth = EXAMPLES["ramp"], EXAMPLES["smooth"]
    np.testing.assert_allclose(ramp([0.0, 0.1, 0.25, 0.4, 9.0]), [1.0, 1.0, 2.5, 4.0, 4.0])
    np.testing.assert_allclose(smooth([0.0, 0.2, 0.45, 0.7, 9.0]), [-1.0, -1.0, 0.5, 2.0, 2.0])
    # one quarter: 6/1024 - 15/256 + 10/64
    assert float(smooth(0.325)) == pytest.approx(-1.0 + 3.0 * (6 / 1024 - 15 / 256 + 10 / 64))


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
