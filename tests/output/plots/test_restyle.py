"""Themes and sizes of figures: contrast and hue of colours, fonts, legends, and pages without empty places."""

from __future__ import annotations

import colorsys

import numpy as np
import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.colors import to_rgb
from matplotlib.figure import Figure
from matplotlib.text import Text

from warpffrf.model.errors import InputError
from warpffrf.output.plots.colors import PRESSURE_STOPS, STATE_COLORS
from warpffrf.output.plots.panels import COLORS, Panel, page, panels_figure
from warpffrf.output.plots.restyle import FONTS, INK, PAPER, _covers, columns_in, darkened, restyle

READABLE, VISIBLE = 7.0, 3.0  # contrast of text and of lines, by the rules for web pages


def contrast(one: np.ndarray, other: np.ndarray) -> float:
    def luminance(rgb: np.ndarray) -> float:
        linear = np.where(rgb <= 0.04045, rgb / 12.92, ((rgb + 0.055) / 1.055) ** 2.4)
        return float(linear @ [0.2126, 0.7152, 0.0722])

    high, low = sorted((luminance(np.asarray(one)), luminance(np.asarray(other))), reverse=True)
    return (high + 0.05) / (low + 0.05)


def test_black_and_white_change_places() -> None:
    assert np.allclose(darkened("black")[0, :3], INK) and np.allclose(darkened("white")[0, :3], PAPER)
    assert contrast(INK, PAPER) > READABLE and contrast(darkened("0.35")[0, :3], PAPER) > VISIBLE
    assert darkened((0.0, 0.0, 0.0, 0.3))[0, 3] == pytest.approx(0.3)


@pytest.mark.parametrize("color", [*COLORS, *STATE_COLORS[1:], *(f"C{n}" for n in range(10))])
def test_lines_are_seen_and_keep_their_hue(color: str) -> None:
    dark = darkened(color)[0, :3]
    assert contrast(dark, PAPER) > VISIBLE
    hue, _, saturation = colorsys.rgb_to_hls(*to_rgb(color))
    if saturation > 0.4:
        off = abs(colorsys.rgb_to_hls(*dark)[0] - hue)
        assert min(off, 1.0 - off) < 0.04


def test_maps_keep_their_colors_but_for_the_grey_of_nothing() -> None:
    dark = darkened(PRESSURE_STOPS, of_map=True)[:, :3]
    grey, most = dark[0], dark[1:4]
    assert grey.max() < 0.4 and np.abs(most - np.array([to_rgb(c) for c in PRESSURE_STOPS[1:4]])).max() < 0.15


def figure_of_curves(width: float | None = None) -> Figure:
    """Three panels whose curves fill every corner, with long titles."""
    x = np.linspace(0.0, 1.0, 200)
    curves = {f"curve {n} with a long name": (x, np.sin(40.0 * x + n)) for n in range(3)}
    panel = Panel("A title that is longer than its panel is wide " * 2, "x [mm]", "y [mm]", curves)
    return panels_figure([panel] * 3, theme="light" if width is None else "dark", width=width)


@pytest.mark.parametrize("width", [None, 0.09, 0.18])
def test_legends_cover_nothing_and_text_is_legible(width: float | None) -> None:
    figure = figure_of_curves(width)
    figure.canvas.draw()
    assert width is None or figure.get_figwidth() * 0.0254 == pytest.approx(width)
    for ax in figure.axes:
        assert not _covers(ax.get_legend(), ax)
        assert ax.title.get_window_extent().width < 1.2 * ax.bbox.width
    sizes = [float(text.get_fontsize()) for text in figure.findobj(Text) if text.get_text()]
    assert width is None or (min(sizes) >= FONTS[0] and max(sizes) <= FONTS[1])


def test_dark_twice_is_dark() -> None:
    figure = restyle(figure_of_curves(), "dark")
    (line, *_) = figure.axes[0].get_lines()
    color = line.get_color()
    restyle(figure, "dark")
    assert np.array_equal(line.get_color(), color)
    ax = figure.axes[0]
    assert np.allclose(ax.xaxis.get_ticklabels()[0].get_color()[:3], INK, atol=1e-9)
    pixels = np.asarray(drawn(figure).buffer_rgba())[..., :3] / 255.0
    assert np.abs(pixels[0, 0] - PAPER).max() < 0.01 and np.mean(pixels.min(axis=2) > 0.9) < 0.05  # no white panels


def drawn(figure: Figure) -> FigureCanvasAgg:
    canvas = FigureCanvasAgg(figure)
    canvas.draw()
    return canvas


@pytest.mark.parametrize("count", range(1, 15))
def test_no_place_of_a_page_is_empty(count: int) -> None:
    """Places cover the page once, at most three side by side, in rows whose lengths differ by one."""
    _, places = page(count, 3, (5.0, 4.0))
    assert len(places) == count
    rows, columns = places[0].get_gridspec().get_geometry()
    covered, lengths = np.zeros((rows, columns), dtype=int), np.zeros(rows, dtype=int)
    for place in places:
        covered[place.rowspan.start : place.rowspan.stop, place.colspan.start : place.colspan.stop] += 1
        lengths[place.rowspan.start] += 1
    assert np.all(covered == 1) and lengths.max() <= 3 and np.ptp(lengths) <= 1


def test_columns_of_a_page() -> None:
    assert [columns_in(width, 3) for width in (None, 0.05, 0.09, 0.18, 0.3)] == [3, 1, 1, 2, 3]


def test_what_is_refused() -> None:
    figure = figure_of_curves()
    with pytest.raises(InputError, match="did you mean 'dark'"):
        restyle(figure, "drak")
    with pytest.raises(InputError, match="width"):
        restyle(figure, width=-0.09)
