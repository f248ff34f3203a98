"""Every kind of plot from a real run: something is drawn, all of it finite and in view, and axes say their units."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import drawn_runs
import matplotlib.pyplot as plt
import numpy as np
import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.collections import Collection, LineCollection, PathCollection, PolyCollection, QuadMesh, TriMesh
from matplotlib.figure import Figure
from matplotlib.text import Text

import warpffrf as wf
from warpffrf.output.contact.hertz import largest_below, largest_of
from warpffrf.output.plots.bearing import BEARING_PLOTS
from warpffrf.output.plots.figure import MACHINE_PLOTS, PLOTS, about_kinds, drawable
from warpffrf.output.plots.films import FILM_PLOTS
from warpffrf.output.plots.friction import FRICTION_PLOTS
from warpffrf.output.plots.gears import GEAR_PLOTS
from warpffrf.output.plots.panels import HISTORY_PLOTS
from warpffrf.output.plots.restyle import FONTS, PAPER, _covers
from warpffrf.output.plots.small_sliding import SMALL_SLIDING_PLOTS
from warpffrf.output.result import Result

PAIR_KINDS = [*PLOTS, *FRICTION_PLOTS]
CHANNEL, TURNS = "contact_force_z[lower-upper]", "lower"


@pytest.fixture(scope="module")
def loaded_bearing() -> Result:
    return drawn_runs.loaded_bearing()


@pytest.fixture(scope="module")
def gears() -> Result:
    return drawn_runs.gears()


@pytest.fixture(scope="module")
def rolling() -> Result:
    return drawn_runs.rolling()


@pytest.fixture(scope="module")
def oiled() -> Result:
    return drawn_runs.oiled()


@pytest.fixture(scope="module")
def rubbing_contact() -> Result:
    return drawn_runs.rubbing_contact()


def axes() -> Any:
    figure = Figure(figsize=(6.4, 4.8), layout="constrained")
    FigureCanvasAgg(figure)
    return figure.add_subplot()


def drawn_values(ax: Any) -> list[np.ndarray]:
    """Coordinates and coloured values of all that is on the axes."""
    found = [np.asarray(line.get_xydata(), dtype=float) for line in ax.get_lines()]
    found += [np.asarray(patch.get_path().vertices, dtype=float) for patch in ax.patches]
    for collection in ax.collections:
        assert isinstance(collection, Collection)
        if isinstance(collection, QuadMesh | TriMesh | PolyCollection) and collection.get_array() is not None:
            found.append(np.ma.filled(np.ma.asarray(collection.get_array(), dtype=float), 0.0))
        if isinstance(collection, LineCollection | PathCollection | PolyCollection):
            found += [np.asarray(path.vertices, dtype=float) for path in collection.get_paths()]
    return [values for values in found if values.size]


def check(drawn: Any, *, picture: bool = False, seen: bool = True) -> None:
    """`drawn`, axes or a figure. picture: of shapes, whose axes have no scales; seen: look at its pixels, too."""
    figure = getattr(drawn, "figure", None) or drawn
    panels = [ax for ax in figure.axes if ax.get_label() != "<colorbar>"]
    assert panels
    for ax in panels:
        values = drawn_values(ax)
        assert values, ax.get_title()
        # cells that are open or have not slipped have no value, and nothing is drawn there; all else is finite
        finite = np.concatenate([np.isfinite(v).ravel() for v in values])
        assert np.mean(finite) > 0.9, ax.get_title()
        assert np.all(np.isfinite([*ax.get_xlim(), *ax.get_ylim()]))
        if not picture:
            twin = any(other is not ax and other.bbox.bounds == ax.bbox.bounds for other in panels)
            assert "[" in ax.get_ylabel() and (twin or "[" in ax.get_xlabel()), ax.get_title()
    bars = [part for ax in figure.axes for part in (ax, *ax.child_axes) if part.get_label() == "<colorbar>"]
    for bar in bars:
        assert "[" in bar.get_ylabel() or any(":" in tick.get_text() for tick in bar.get_yticklabels())
    if not seen:
        return
    figure.canvas.draw()
    pixels = np.asarray(figure.canvas.buffer_rgba())[..., :3]
    assert np.mean(np.any(pixels != 255, axis=-1)) > 0.01


def all_finite(drawn: Any) -> None:
    assert all(np.all(np.isfinite(v)) for ax in drawn.figure.axes for v in drawn_values(ax))


def test_every_kind_is_here() -> None:
    made = {*PAIR_KINDS, *FILM_PLOTS, *SMALL_SLIDING_PLOTS, *BEARING_PLOTS, *GEAR_PLOTS, *HISTORY_PLOTS}
    made |= {*MACHINE_PLOTS, "summary"}
    assert made == set(about_kinds())


def test_the_runs_have_something_to_draw(rolling: Result, oiled: Result, rubbing_contact: Result) -> None:
    assert {result.status for result in (rolling, oiled, rubbing_contact)} == {"completed"}
    assert set(drawable(rolling)) == {*PAIR_KINDS, "joints", "energy"}
    assert set(drawable(oiled)) == {"force", "joints", "energy", *FILM_PLOTS}
    assert set(drawable(rubbing_contact)) == {"force", *MACHINE_PLOTS, *SMALL_SLIDING_PLOTS}


@pytest.mark.parametrize("kind", PAIR_KINDS)
def test_kinds_of_pairs(rolling: Result, kind: str) -> None:
    drawn = rolling.plot(kind, axes())
    check(drawn)
    if kind not in ("creepage", "spin", "t_gamma", "power"):  # rows before anything rolls have none
        all_finite(drawn)


@pytest.mark.parametrize("kind", BEARING_PLOTS)
def test_kinds_of_bearings(loaded_bearing: Result, kind: str) -> None:
    drawn = loaded_bearing.plot(kind)
    all_finite(drawn)
    assert len(drawn_values(drawn)) >= 2 and "[kN]" in drawn.get_title() + drawn.get_ylabel()


@pytest.mark.parametrize("kind", GEAR_PLOTS)
def test_kinds_of_gears(gears: Result, kind: str) -> None:
    drawn = gears.plot(kind, axes(), gear="mesh")
    check(drawn)
    all_finite(drawn)


def test_films_on_flanks(gears: Result) -> None:
    oil = wf.oils.Roelands(0.015, coefficient=2e-8)
    for roughness in (None, 0.4e-6):
        ax = axes()
        gears.gear("mesh").film_thickness(oil, roughness=roughness).draw(ax)
        assert len(drawn_values(ax)) >= 2 and "[µm]" in ax.get_ylabel()
        all_finite(ax)


def test_gears_of_one_row(gears: Result) -> None:
    """Plots over a rotation are left out of the page, and those that need rows say so."""
    row = gears.since(float(gears.time[-1]))
    assert not {*GEAR_PLOTS} & {*drawable(row)} and {*GEAR_PLOTS} <= {*drawable(gears)}
    for kind in GEAR_PLOTS:
        if kind in ("mesh_orders", "flank_pressure", "flank_wear"):
            with pytest.raises(wf.InputError, match="less than one|two saved steps"):
                row.plot(kind, axes())
        else:
            check(row.plot(kind, axes()))
    with pytest.raises(wf.InputError, match="no gear pair called 'none'"):
        row.plot("load_share", axes(), gear="none")


@pytest.mark.parametrize("kind", [*FILM_PLOTS, "force", "energy", "joints"])
def test_kinds_of_films(oiled: Result, kind: str) -> None:
    drawn = oiled.plot(kind, axes())
    check(drawn)
    all_finite(drawn)


@pytest.mark.parametrize("kind", [*SMALL_SLIDING_PLOTS, "force", *MACHINE_PLOTS])
def test_kinds_of_small_sliding(rubbing_contact: Result, kind: str) -> None:
    drawn = rubbing_contact.plot(kind, axes())
    check(drawn)
    all_finite(drawn)


@pytest.mark.parametrize("kind", list(HISTORY_PLOTS))
@pytest.mark.parametrize("speed", [None, TURNS])
def test_kinds_of_histories(rolling: Result, kind: str, speed: str | None) -> None:
    if kind == "spectrum" and speed is not None:
        with pytest.raises(wf.InputError, match="turns 0.0382 times about the axis"):  # 200 rad/s in 2.4 ms, from rest
            rolling.plot(kind, axes(), channel=CHANNEL, speed=speed)
        return
    drawn = rolling.plot(kind, axes(), channel=CHANNEL, speed=speed)
    check(drawn)
    all_finite(drawn)


@pytest.mark.parametrize("run", ["rolling", "oiled", "rubbing_contact"])
def test_summaries(run: str, request: pytest.FixtureRequest) -> None:
    """Their panels are those of the kinds, whose pixels are looked at one by one."""
    check(request.getfixturevalue(run).summary(), seen=False)


def test_pages_of_laps_and_loops(rubbing_contact: Result) -> None:
    check(rubbing_contact.small_sliding_page(), seen=False)
    loop = rubbing_contact.hysteresis(("push", "x"), ("tip", "x"))
    ax = axes()
    loop.draw(ax)
    check(ax)
    all_finite(ax)


def test_two_runs_overlaid(rolling: Result) -> None:
    found = wf.compare(rolling, rolling)
    check(found.figure(["contact_force[lower-upper]", "energy[kinetic]"]))


def test_modes_and_bodies(rolling: Result) -> None:
    modes = wf.eigenmodes(rolling.scene, 4, progress=False)
    bars = modes.plot()
    assert len(bars.patches) >= 4 and "[%]" in bars.get_xlabel()
    assert all("Hz" in tick.get_text() for tick in bars.get_yticklabels())
    check(modes.plot_shape(0), picture=True)
    check(modes.plot_shapes(4), picture=True)
    body = rolling.scene.body("lower").flexible
    check(body.plot_modes(2), picture=True)


def test_the_run_is_hertz_s_under_the_surface(rolling: Result) -> None:
    """Cells finer than the mesh: the largest von Mises stress and its depth are Hertz's to 1 %."""
    contact = rolling.contact("lower-upper")
    (below,) = rolling.stress_below()
    exact = largest_below(contact.hertz(len(rolling.time) - 1), 0.3)[0]
    assert largest_of(below.depth, below.von_mises) == pytest.approx(exact, rel=0.01)


NARROW = 0.09  # m, a column of a journal


def legible_and_dark(drawn: Any) -> None:
    """Text of at least 6.5 points that lies in the figure, on dark paper, and legends next to the curves."""
    figure = drawn.figure
    plt.close(figure)
    figure.canvas.draw()
    assert figure.get_figwidth() * 0.0254 == pytest.approx(NARROW) and np.allclose(figure.get_facecolor()[:3], PAPER)
    page, slack = figure.bbox, 0.02 * figure.bbox.width
    for text in figure.findobj(Text):
        if text.get_text() and text.get_visible():
            assert text.get_fontsize() >= FONTS[0]
    for ax in figure.axes:
        for text in (ax.title, ax.xaxis.label, ax.yaxis.label):
            box = text.get_window_extent()
            assert box.x0 > page.x0 - slack and box.x1 < page.x1 + slack, text.get_text()
        legend = ax.get_legend()
        assert legend is None or ax.name != "rectilinear" or not _covers(legend, ax), ax.get_title()


@pytest.mark.parametrize("kind", PAIR_KINDS)
def test_pairs_in_the_dark_theme_and_a_column(rolling: Result, kind: str) -> None:
    legible_and_dark(rolling.plot(kind, theme="dark", width=NARROW))


@pytest.mark.parametrize("kind", FILM_PLOTS)
def test_films_in_the_dark_theme_and_a_column(oiled: Result, kind: str) -> None:
    legible_and_dark(oiled.plot(kind, theme="dark", width=NARROW))


@pytest.mark.parametrize("kind", [*SMALL_SLIDING_PLOTS, *MACHINE_PLOTS])
def test_small_sliding_in_the_dark_theme_and_a_column(rubbing_contact: Result, kind: str) -> None:
    legible_and_dark(rubbing_contact.plot(kind, theme="dark", width=NARROW))


@pytest.mark.parametrize("kind", BEARING_PLOTS)
def test_bearings_in_the_dark_theme_and_a_column(loaded_bearing: Result, kind: str) -> None:
    legible_and_dark(loaded_bearing.plot(kind, theme="dark", width=NARROW))


@pytest.mark.parametrize("kind", GEAR_PLOTS)
def test_gears_in_the_dark_theme_and_a_column(gears: Result, kind: str) -> None:
    legible_and_dark(gears.plot(kind, theme="dark", width=NARROW))


def test_a_page_shows_the_bearing_and_not_each_of_its_contacts(loaded_bearing: Result) -> None:
    titles = [ax.get_title() for ax in loaded_bearing.summary().figure.axes]
    assert any("loads [kN]" in title for title in titles) and "Contact force" not in titles


def test_the_docs_list_every_kind() -> None:
    text = (Path(__file__).resolve().parents[3] / "docs" / "plots.md").read_text(encoding="utf-8")
    rows = dict(re.findall(r"^\| `(\w+)` \| [^|]+ \| (.+) \|$", text, flags=re.MULTILINE))
    assert rows == about_kinds()
