"""Plots of many pairs and of tractions of both signs: nothing is hidden, nothing is cut off."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from rubbing_run import MU, add_friction
from synthetic_run import make_history

from warpffrf.model.reduced.body import ReducedBody
from warpffrf.output.result import Result

PAIRS = 24


def texts_of(ax: Axes) -> list[str]:
    legend = ax.get_legend()
    assert legend is not None
    return [text.get_text() for text in legend.get_texts()]


@pytest.fixture
def crowded(body: ReducedBody) -> Result:
    """The synthetic run with its pair under 24 names, as of a bearing of twelve rollers."""
    history = make_history(body)
    names = [f"roller {n // 2 + 1} on {'inner' if n % 2 else 'outer'} ring" for n in range(PAIRS)]
    (contact,), (pair,) = history.contacts.values(), history.scene.pairs.values()
    scaled = [replace(contact, force=contact.force * (1.0 + 0.1 * n)) for n in range(PAIRS)]
    history.contacts = dict(zip(names, scaled, strict=True))
    history.scene = replace(history.scene, pairs={name: replace(pair, name=name) for name in names})
    return Result(history)


def test_a_legend_of_24_pairs_hides_no_curve_and_stays_in_the_picture(crowded: Result) -> None:
    figure = Figure(figsize=(6.4, 4.8), layout="constrained")
    FigureCanvasAgg(figure)
    ax = crowded.plot("force", figure.add_subplot())
    figure.canvas.draw()
    legend = ax.get_legend()
    assert legend is not None
    assert [text.get_text() for text in legend.get_texts()] == crowded.contact_names
    box, axes, page = legend.get_window_extent(), ax.get_window_extent(), figure.bbox
    assert box.x0 >= axes.x1 and box.x1 <= page.x1 and page.y0 <= box.y0 and box.y1 <= page.y1
    assert axes.width > 0.25 * page.width  # the curves keep room of their own
    looks = {(line.get_color(), line.get_linestyle()) for line in ax.get_lines()}
    assert len(looks) == PAIRS


def test_two_pairs_have_their_legend_inside(crowded: Result) -> None:
    history = crowded.history
    few = dict(list(history.contacts.items())[:2])
    view = replace(history.scene, pairs={name: history.scene.pairs[name] for name in few})
    ax = Result(replace(history, contacts=few, scene=view)).plot("force", Figure().add_subplot())
    assert len(texts_of(ax)) == 2


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_tractions_of_both_signs_are_inside_the_axes(body: ReducedBody, sign: float) -> None:
    history = add_friction(make_history(body))
    (contact,) = history.contacts.values()
    friction = contact.friction
    assert friction is not None
    turned = np.where(np.arange(friction.traction.shape[2]) % 3 == 0, -sign, sign)
    friction.traction = friction.traction * turned[:, None]
    ax = Result(history).plot("traction", Figure().add_subplot())
    low, high = ax.get_ylim()
    values = np.concatenate([np.asarray(line.get_ydata(), dtype=float) for line in ax.get_lines()])
    assert low < np.nanmin(values) < 0.0 < np.nanmax(values) < high
    dashed = [line for line in ax.get_lines() if line.get_linestyle() == "--"]
    assert np.array_equal(dashed[0].get_ydata(), -np.asarray(dashed[1].get_ydata()))
    assert f"±{MU:g} p" in texts_of(ax)


def test_on_a_page_the_names_stand_below_the_panels(crowded: Result) -> None:
    figure = crowded.summary()
    figure.canvas.draw()
    (legend,) = figure.legends
    box, panels = legend.get_window_extent(), [ax.get_window_extent() for ax in figure.axes if ax.get_xlabel()]
    assert len(legend.get_texts()) == PAIRS and box.y1 <= min(panel.y0 for panel in panels)
    assert 0.0 <= box.x0 and box.x1 <= figure.bbox.x1 and figure.axes[0].get_legend() is None
    assert min(panel.width for panel in panels) > 0.15 * figure.bbox.width  # of three columns with their labels


def test_ripple_fills_its_axes(body: ReducedBody) -> None:
    """Five rows in the second half, of a force 1 + e, 1 - e, ...: their mean is 1 + e/5."""
    history = make_history(body)
    (contact,) = history.contacts.values()
    e, rows = 1e-3, np.arange(len(history.time))
    contact.force = np.outer(2e3 * (1.0 + e * (-1.0) ** rows), [0.0, 0.0, -1.0])
    ax = Result(history).plot("ripple", Figure().add_subplot())
    force = ax.get_lines()[0]
    assert np.array_equal(force.get_xdata(), history.time[4:] * 1e3)
    mean = 1.0 + e / 5.0
    expected = 100.0 * ((1.0 + e * (-1.0) ** rows[4:]) / mean - 1.0)
    assert force.get_ydata() == pytest.approx(expected, rel=1e-9)  # 13 digits of 1 + e
    assert texts_of(ax)[0] == "force, 0.2 % from end to end"
    low, high = ax.get_ylim()
    drawn = np.concatenate([np.asarray(line.get_ydata(), dtype=float) for line in ax.get_lines()])
    assert low < drawn.min() and drawn.max() < high and high - low < 2.0 * np.ptp(drawn)


@pytest.mark.parametrize(
    ("ripple", "cut", "said"), [(0.02, True, "varies by 2 %"), (0.5, False, ""), (1e-9, False, ""), (0.0, False, "")]
)
def test_axes_from_zero_are_cut_where_values_vary_little(
    body: ReducedBody, ripple: float, cut: bool, said: str
) -> None:
    """Nine rows 1 - r/2, 1, 1 + r/2, ...: from end to end r of a mean of 1."""
    history = make_history(body)
    (contact,) = history.contacts.values()
    rows = np.arange(len(history.time))
    contact.force = np.outer(2e3 * (1.0 + 0.5 * ripple * (rows % 3 - 1)), [0.0, 0.0, -1.0])
    ax = Result(history).plot("force", Figure().add_subplot())
    low, high = ax.get_ylim()
    assert (low > 0.0) == cut and ("axis cut" in ax.get_ylabel()) == cut and ax.get_ylabel().endswith(said)
    assert low < 2.0 * (1.0 - 0.5 * ripple) and 2.0 * (1.0 + 0.5 * ripple) < high
    if cut:
        assert high - low == pytest.approx(1.2 * 2.0 * ripple, rel=1e-9)


def test_round_off_is_no_ripple(body: ReducedBody) -> None:
    history = make_history(body)
    (contact,) = history.contacts.values()
    contact.pressure = np.repeat(contact.pressure[:1], len(history.time), axis=0)
    contact.first_column, contact.center_column = (
        np.repeat(v[:1], len(history.time), axis=0) for v in (contact.first_column, contact.center_column)
    )
    contact.force = np.outer(2e3 * (1.0 + 1e-9 * np.arange(len(history.time))), [0.0, 0.0, -1.0])
    low, high = Result(history).plot("ripple", Figure().add_subplot()).get_ylim()
    assert low == pytest.approx(-1e-3) and high == pytest.approx(1e-3)  # per cent
