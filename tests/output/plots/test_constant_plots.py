"""Axes never make a vibration of round-off, and runs of one row have numbers in the place of dots."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
import rubbing_run
import synthetic_run
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle
from rubbing_run import MU, SPEED, add_friction
from synthetic_run import PEAK, make_history

from warpffrf.model.reduced.body import ReducedBody
from warpffrf.output.plots.bearing import element_loads
from warpffrf.output.plots.figure import OVER_TIME, drawable, summary
from warpffrf.output.plots.films import gap as gap_map
from warpffrf.output.plots.panels import Overlaid, Panel
from warpffrf.output.recording.layout import _axis
from warpffrf.output.result import Result
from warpffrf.output.spectrum import frequency_spectrum
from warpffrf.output.waterfall import waterfall
from warpffrf.study.sweeps.reading.plot import _limits

SEEN = 1e-3  # of an axis: less is a flat line
KINDS = ("energy", "creepage", "spin", "t_gamma", "power")


def share_seen(ax: Axes) -> float:
    """How much of its axis the curve that moves most takes."""
    low, high = ax.get_ylim()
    curves = [np.asarray(line.get_ydata(), dtype=float) for line in ax.get_lines()]
    return max(float(np.nanmax(y) - np.nanmin(y)) / (high - low) for y in curves)


def drawn(result: Result, kind: str) -> list[Axes]:
    figure = Figure()
    result.plot(kind, figure.add_subplot())
    return figure.axes


def test_round_off_is_a_flat_line(body: ReducedBody) -> None:
    """Rollers that drive nothing: creepages, tractions and powers of 1e-16 of what full slip would make."""
    history = add_friction(make_history(body))
    (contact,) = history.contacts.values()
    friction = contact.friction
    assert friction is not None
    power, _ = drawn(Result(history), "power")  # Carter's, of which there is something to see
    assert power.get_ylim()[1] == pytest.approx(1.08 * friction.power.max()) and share_seen(power) > 0.2
    noise = 1e-16 * (-1.0) ** np.arange(len(history.time))
    friction.traction = friction.traction * noise[:, None, None, None]
    friction.slip_velocity = friction.slip_velocity * noise[:, None, None, None]
    friction.creep_velocity = SPEED * np.outer(noise, [1.0, 0.5])
    friction.power = MU * np.abs(contact.force[:, 2]) * SPEED * np.abs(noise)
    history.energy["numerical"] = noise
    result = Result(history)
    for kind in KINDS:
        for ax in drawn(result, kind):
            assert share_seen(ax) < SEEN, kind
    load = MU * np.abs(contact.force[:, 2]).max()
    power, wear = drawn(result, "power")
    assert power.get_ylim()[1] == pytest.approx(1.08e-6 * load * SPEED)
    assert wear.get_ylim()[1] == pytest.approx(
        1.08e-6 * result.contact("lower-upper").peak_pressure.max() * SPEED * 1e-6
    )


def test_a_panel_of_a_constant_is_flat() -> None:
    time = np.linspace(0.0, 1.0, 50)
    for size in (1e-9, -4e11):
        ax = Figure().add_subplot()
        Panel("", "t", "y", {"a": (time, size * (1.0 + 1e-12 * np.sin(40.0 * time)))}).draw(ax)
        low, high = ax.get_ylim()
        assert high - low == pytest.approx(1e-4 * abs(size), rel=1e-6) and low < size < high
    ax = Figure().add_subplot()
    Panel("", "t", "y", {"a": (time, 1.0 + 1e-3 * np.sin(40.0 * time))}).draw(ax)
    assert share_seen(ax) > 0.8


def test_a_map_of_one_gap_has_one_color() -> None:
    """Of gaps that differ by 1e-12; of those that differ by a tenth all colours."""
    for spread, share in ((1e-12, SEEN), (0.1, 1.0)):
        gap = 2e-5 * (1.0 + spread * np.linspace(0.0, 1.0, 12).reshape(1, 4, 3))
        plane = SimpleNamespace(shape=SimpleNamespace(profile=lambda: SimpleNamespace(planar=True)))
        film: Any = SimpleNamespace(
            name="film", time=np.zeros(1), gap=gap, fill=np.ones((1, 4, 3)), theta=np.linspace(0.0, 0.1, 4),
            z=np.linspace(0.0, 0.1, 3), view=SimpleNamespace(first=plane),
        )  # fmt: skip
        ax = Figure().add_subplot()
        gap_map(film, ax, 0)
        low, high = ax.collections[0].get_clim()
        assert np.ptp(gap) * 1e6 / (high - low) == pytest.approx(share, abs=SEEN)


def test_sweeps_do_not_magnify_round_off() -> None:
    for spread, share in ((1e-9, 0.0), (1e-3, 0.9)):
        numbers = 5.0 * (1.0 + spread * np.array([0.0, 1.0, 0.5]))
        values: Any = SimpleNamespace(numbers=numbers, has=np.ones(3, dtype=bool), shown=lambda: (1.0, "x [N]"))
        low, high = _limits(values, np.ones(3, dtype=bool))
        assert np.ptp(numbers) / (high - low) == pytest.approx(share, abs=0.05)


def test_scales_of_the_viewer_are_not_finer() -> None:
    """They show zero, and round-off as a flat line; only what varies about zero is left to the viewer."""
    for values, size in (([5.0, 5.0 + 1e-9], 0.0), ([1e-12, -1e-12], 2.0), ([np.nan, -3.0], 0.0), ([1.0, 1.001], 0.0)):
        seen = np.array(values)[np.isfinite(values)]
        low, high = (float(v) for v in _axis([np.array(values)], size).range.as_arrow_array()[0].as_py())
        assert low <= min(0.0, seen.min()) and high >= max(0.0, seen.max())
        assert np.ptp(seen) < 0.01 * (high - low)
    assert _axis([np.array([-1.0, 1.001])]) is None and _axis([np.full(2, np.nan)]) is None and _axis([]) is None


def test_loads_of_elements_begin_at_zero() -> None:
    load = 1e3 * (1.0 + 1e-9 * np.random.default_rng(1).standard_normal((20, 2)))
    bearing = SimpleNamespace(outer_load=load, time=np.linspace(0.0, 1.0, 20), kind="ball", name="bearing")
    ax = Figure().add_subplot()
    element_loads(bearing, ax, 0)  # type: ignore[arg-type]
    assert ax.get_ylim()[0] == 0.0 and share_seen(ax) < SEEN


def test_a_spectrum_of_round_off_says_so() -> None:
    time = np.arange(256) * 1e-3
    for ripple, doubted in ((1e-9, True), (1e-3, False)):
        values = 5.0 * (1.0 + ripple * np.sin(2.0 * np.pi * 50.0 * time))
        found = frequency_spectrum(time, values, "x", "N")
        assert ("may be round-off" in found.report()) == doubted
        for one in (found, waterfall(time, values, "x", "N")):
            ax = Figure().add_subplot()
            one.draw(ax)
            assert ("may be round-off" in ax.get_title()) == doubted
        ax = Figure().add_subplot()
        found.draw(ax)
        assert ax.get_ylim()[1] >= 5e-6 or not doubted


def test_two_equilibria_are_bars() -> None:
    at = np.zeros(1)
    ax = Figure().add_subplot()
    Overlaid("joint_force_z[a]", "N", "", (at, np.array([3.0])), (at, np.array([-4.0])), 1e-6).draw(ax, ("A", "B"))
    heights = [bar.get_height() for bar in ax.patches if isinstance(bar, Rectangle)]
    assert heights == [3.0, -4.0]
    assert {text.get_text() for text in ax.texts} == {"3", "-4"} and "[N]" in ax.get_ylabel()
    assert ax.get_legend_handles_labels()[1] == ["A", "B"]


def test_an_equilibrium_has_numbers_in_place_of_dots(body: ReducedBody, monkeypatch: pytest.MonkeyPatch) -> None:
    for module in (synthetic_run, rubbing_run):
        monkeypatch.setattr(module, "STEPS", 1)
    result = Result(add_friction(make_history(body)))
    assert not OVER_TIME & set(drawable(result))
    figure = summary(result)
    curves = [[len(np.ravel(line.get_xdata())) for line in ax.get_lines()] for ax in figure.axes if ax.get_lines()]
    assert len(curves) >= 3 and all(max(points) > 1 for points in curves)
    force, numbers = figure.axes[:2]
    (bar,) = (part for part in force.patches if isinstance(part, Rectangle))
    expected = float(result.contact("lower-upper").force_magnitude[0]) * 1e-3
    assert bar.get_width() == pytest.approx(expected) and "[kN]" in force.get_xlabel()
    assert [text.get_text() for text in force.get_yticklabels()] == ["lower-upper"]
    (table,) = numbers.tables
    cells: dict[tuple[int, int], Any] = table.get_celld()
    said = {cells[n, 0].get_text().get_text(): cells[n, 1].get_text().get_text() for n, part in cells if part == 0}
    contact = result.contact("lower-upper")
    assert said["half-width"] == f"{contact.half_width[0] * 1e3:.4g} mm"
    assert float(said["peak pressure"].removesuffix(" MPa")) == pytest.approx(PEAK * 1e-6, rel=0.02)
    assert 0.0 < float(said["tangential over normal load"]) < MU
    assert "1 saved row," in figure.get_suptitle()
