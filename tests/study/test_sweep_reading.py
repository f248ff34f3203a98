"""Reading a sweep: surfaces, Sobol indices, pictures and the page; closed forms in memory, and a sweep of bobs."""

from __future__ import annotations

import itertools
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from matplotlib.colors import to_rgb
from sweep_scenes import IN_TIME, bob, rest, shy_bob

import warpffrf as wf
from page_reader import Page
from warpffrf import cli
from warpffrf.model.errors import InputError
from warpffrf.output.plots.restyle import INCH, PAPER
from warpffrf.study.sweeps.parameters import latin, saltelli
from warpffrf.study.sweeps.reading import surface as surfaces
from warpffrf.study.sweeps.reading.page import page
from warpffrf.study.sweeps.reading.plot import plot
from warpffrf.study.sweeps.reading.sensitivities import sensitivities
from warpffrf.study.sweeps.reading.surface import surface
from warpffrf.study.sweeps.reading.values import chosen_rows

ROUND_OFF = 1e-12


class Rows:
    """What reading asks of a sweep, in memory."""

    def __init__(
        self, parameters: dict[str, Any], outputs: dict[str, np.ndarray], *, sample: str = "", unit: str = "",
        failed: tuple[int, ...] = (), dims: tuple[str, ...] = (), **more: np.ndarray,
    ) -> None:  # fmt: skip
        self.columns = {**{k: np.asarray(v) for k, v in parameters.items()}, **outputs, **more}
        count = len(next(iter(self.columns.values())))
        self.columns |= {name: np.full(count, "", dtype=object) for name in ("message", "host", "device", "versions")}
        self.columns |= {"wall_seconds": np.ones(count), "set_up_seconds": np.full(count, 0.1)}
        status = np.full(count, "completed", dtype=object)
        status[list(failed)] = "failed"
        self.columns["status"], self.unit, self.dims = status, unit, dims
        self.parameter_names, self.output_names = list(parameters), list(outputs)
        self.definition = {
            "title": "rows", "call": "equilibrium", "sample": sample, "seed": 0, "options": {},
            "parameters": dict.fromkeys(parameters, "0:1"), "outputs": {name: f"last({name})" for name in outputs},
        }  # fmt: skip

    def __getitem__(self, name: str) -> np.ndarray:
        if name not in self.columns:
            raise InputError(name)
        return self.columns[name]

    def about(self, name: str) -> tuple[tuple[str, ...], str]:
        return (self.dims, self.unit) if name in self.output_names else ((), "")


def grid(**values: list[float]) -> dict[str, np.ndarray]:
    return dict(zip(values, np.array(list(itertools.product(*values.values()))).T, strict=True))


def drawn(figure: Any) -> list[Any]:
    """The axes of a figure without those of its colour bars."""
    return [ax for ax in figure.axes if ax.get_label() != "<colorbar>"]


def filled(ax: Any) -> list[Any]:
    """The lines of axes that have points."""
    return [line for line in ax.lines if len(line.get_xdata())]


# --- Sobol indices


def ishigami(sample: np.ndarray) -> np.ndarray:
    """sin x_1 + a sin^2 x_2 + b x_3^4 sin x_1, x uniform in (-pi, pi), a = 7, b = 0.1 (Ishigami and Homma, 1990)."""
    x = np.pi * (2.0 * sample - 1.0)
    return np.sin(x[:, 0]) + 7.0 * np.sin(x[:, 1]) ** 2 + 0.1 * x[:, 2] ** 4 * np.sin(x[:, 0])


def ishigami_rows(n: int, **options: Any) -> Rows:
    points = saltelli(n, 3, 0)
    return Rows(
        dict(zip(("x1", "x2", "x3"), points.T, strict=True)), {"y": ishigami(points)}, sample=f"saltelli:{n}", **options
    )


def test_sobol_indices_of_rows_are_those_of_ishigamis_function() -> None:
    """V_1 = (1 + b pi^4/5)^2/2, V_2 = a^2/8, V_13 = b^2 pi^8 (1/18 - 1/50); the intervals of 2048 points are as wide as
    0.06, which the exact indices stand in."""
    V1, V2, V13 = 0.5 * (1.0 + 0.1 * np.pi**4 / 5.0) ** 2, 49.0 / 8.0, 0.01 * np.pi**8 * (1.0 / 18.0 - 1.0 / 50.0)
    first, total = np.array([V1, V2, 0.0]), np.array([V1 + V13, V2, V13])
    found = sensitivities(ishigami_rows(2048), "y")
    for value, bounds, exact in (
        (found.first, found.first_bounds, first / (V1 + V2 + V13)),
        (found.total, found.total_bounds, total / (V1 + V2 + V13)),
    ):
        assert np.allclose(value, exact, atol=0.06)
        assert np.all((bounds[:, 0] <= exact) & (exact <= bounds[:, 1]))
        assert np.all(np.ptp(bounds, axis=1) < 0.15)
    assert not found.of_surface and found.report().splitlines()[2].startswith("x1")


def test_sobol_indices_of_other_rows_are_those_of_their_surface() -> None:
    """y = u + 2 v: V_v = 4 V_u. Thin plates with a linear part have a plane exactly; points are as even as 2048 are."""
    points = latin(30, 2, 0)
    found = sensitivities(Rows({"u": points[:, 0], "v": points[:, 1]}, {"y": points @ [1.0, 2.0]}), "y")
    assert found.of_surface and "response surface through 30 rows" in found.method
    assert np.allclose(found.first, [0.2, 0.8], atol=0.02) and np.allclose(found.total, [0.2, 0.8], atol=0.02)


def test_sobol_indices_need_all_rows_and_some_variance() -> None:
    with pytest.raises(InputError, match=r"2 of 20 rows have no value \(2 failed\).*narrow the ranges"):
        sensitivities(ishigami_rows(4, failed=(3, 7)), "y")
    rows = ishigami_rows(4)
    rows.columns["y"] = np.ones(20)
    with pytest.raises(InputError, match="no variance"):
        sensitivities(rows, "y")
    alone = np.linspace(0.0, 1.0, 6)
    with pytest.raises(InputError, match="u varies alone"):
        sensitivities(Rows({"u": alone}, {"y": alone**2}), "y")


# --- response surfaces


def test_a_surface_through_a_grid_has_polynomials_exactly_and_finds_their_least_value() -> None:
    """Splines of degree min(3, n - 1) have y = (x - 1.3)^2 + z; so have four of five values, for those held out."""
    at = grid(x=[0.0, 1.0, 2.0, 3.0, 4.0], z=[1.0, 2.0])
    found = surface(Rows(at, {"y": (at["x"] - 1.3) ** 2 + at["z"]}), "y")
    assert found({"x": np.array([0.5, 3.7]), "z": 1.25}) == pytest.approx([0.64 + 1.25, 2.4**2 + 1.25], rel=ROUND_OFF)
    assert found.error == pytest.approx(0.0, abs=ROUND_OFF)
    least, largest = found.minimum(), found.maximum()
    assert least.value == pytest.approx(1.0, abs=1e-9) and least.parameters["x"] == pytest.approx(1.3, abs=1e-4)
    assert largest.value == pytest.approx(2.7**2 + 2.0, rel=ROUND_OFF) and largest.parameters == {"x": 4.0, "z": 2.0}
    with pytest.raises(InputError, match=r"x is swept from 0 to 4.*got 4\.5"):
        found({"x": 4.5, "z": 1.0})
    with pytest.raises(InputError, match="give z too"):
        found({"x": 1.0})


def test_the_error_of_a_surface_is_that_of_left_out_rows() -> None:
    """Of sin(3 u) + v^2 the error elsewhere is computed: less than what leaving rows out says, of which those at the
    rim are extrapolated, and not by more than a power of ten. Of a grid cells are twice as wide then: up to 2^4."""
    points, elsewhere = latin(40, 2, 0), 0.02 + 0.96 * np.random.default_rng(1).random((200, 2))

    def y(u: Any, v: Any) -> Any:
        return np.sin(3.0 * u) + v**2

    def true_error(found: Any) -> float:
        u, v = elsewhere.T
        return float(np.sqrt(np.mean((found({"u": u, "v": v}) - y(u, v)) ** 2)))

    ends = np.array([[0.0, 0.0], [0.0, 1.0], [1.0, 0.0], [1.0, 1.0]])  # so that elsewhere is within
    of_sample = np.concatenate([points, ends])
    found = surface(Rows(dict(zip("uv", of_sample.T, strict=True)), {"y": y(*of_sample.T)}), "y")
    assert found.method == "thin-plate splines" and true_error(found) < found.error < 10.0 * true_error(found)
    at = grid(u=np.linspace(0, 1, 7).tolist(), v=np.linspace(0, 1, 5).tolist())
    of_grid = surface(Rows(at, {"y": y(at["u"], at["v"])}), "y")
    assert true_error(of_grid) < of_grid.error < 20.0 * true_error(of_grid)


def test_a_surface_through_many_rows_is_local(monkeypatch: pytest.MonkeyPatch) -> None:
    """A plane is exact through any neighbours; a bend is not, and rows that are left out say so."""
    monkeypatch.setattr(surfaces, "MANY", 30)
    monkeypatch.setattr(surfaces, "NEIGHBOURS", 12)
    points = latin(60, 2, 0)
    of = dict(zip("uv", points.T, strict=True))
    plane, bend = (surface(Rows(of, {"y": y}), "y") for y in (points @ [1.0, 2.0], np.abs(points[:, 0] - 0.5)))
    assert "12 nearest" in plane.method and plane({"u": 0.4, "v": 0.7}) == pytest.approx(1.8, rel=1e-9)
    assert plane.error < 1e-9 < 1e-3 < bend.error


def test_a_surface_says_which_rows_it_leaves_out_and_refuses_what_it_cannot_do() -> None:
    at = grid(x=[0.0, 1.0, 2.0], z=[0.0, 1.0, 2.0])
    found = surface(Rows(at, {"y": at["x"] - at["z"]}, failed=(4,)), "y")
    assert "1 failed" in found.note and "thin-plate" in found.method and found.rows == 8
    assert found({"x": 1.0, "z": 1.0}) == pytest.approx(0.0, abs=ROUND_OFF)  # a plane is exact where the row failed too
    line = np.linspace(0.0, 1.0, 6)
    with pytest.raises(InputError, match="on a line or a plane"):
        surface(Rows({"x": line, "z": 2.0 * line}, {"y": line}), "y")
    words = np.array(["dry", "oil"] * 3, dtype=object)
    with pytest.raises(InputError, match=r"law is a text.*where=\{'law': 'dry'\}"):
        surface(Rows({"law": words, "x": line}, {"y": line}), "y")
    assert surface(Rows({"law": words, "x": line}, {"y": line}), "y", where={"law": "dry"}).rows == 3
    with pytest.raises(InputError, match="nearest value is 0.4"):
        surface(Rows({"law": words, "x": line}, {"y": line}), "y", where={"x": 0.45})


# --- pictures


def test_rows_that_differ_along_x_alone_are_a_line_and_rows_without_a_value_are_marked() -> None:
    at = grid(load=[1.0, 2.0, 4.0], friction=[0.1, 0.2], tilt=[0.0, 1.0])
    rows = Rows(at, {"peak": 1e6 * (at["load"] + at["friction"])}, unit="Pa", failed=(3, 4))
    left, right = drawn(plot(rows, "peak", x="load", hue="friction", col="tilt"))
    assert left.get_ylabel() == "peak [MPa]" and "1 failed" in left.get_title() and left.get_title().startswith("tilt")
    low, high, cross = filled(left)
    assert low.get_xdata().tolist() == [1.0, 4.0] and high.get_xdata().tolist() == [1.0, 2.0, 4.0]
    assert high.get_ydata() == pytest.approx([1.2, 2.2, 4.2]) and low.get_color() != high.get_color()
    assert cross.get_marker() == "x" and cross.get_xdata().tolist() == [2.0]
    assert filled(right)[-1].get_xdata().tolist() == [1.0]
    names = [text.get_text() for text in left.get_legend().get_texts()]
    assert names == ["friction = 0.1", "friction = 0.2", "without a value"]


def test_a_map_has_the_values_of_its_grid_and_marks_the_least_and_the_largest() -> None:
    at = grid(x=[0.0, 1.0, 3.0], z=[1.0, 10.0, 100.0, 1000.0])
    y = (at["x"] - 1.0) ** 2 + np.log10(at["z"])
    (ax,) = drawn(plot(Rows(at, {"y": y}, failed=(1,)), "y", kind="map"))
    (mesh,) = ax.collections
    shown = np.ma.filled(mesh.get_array(), np.nan).reshape(4, 3)
    assert np.isnan(shown[1, 0]) and np.nansum(shown) == pytest.approx(y.sum() - y[1])
    assert shown[2, 1] == pytest.approx(2.0) and ax.get_yscale() == "log" and ax.get_xscale() == "linear"
    marks = {line.get_label(): (line.get_xdata()[0], line.get_ydata()[0]) for line in ax.lines}
    assert marks == {"without a value": (0.0, 10.0), "least: 0": (1.0, 1.0), "largest: 7": (3.0, 1000.0)}


def test_a_map_of_a_sample_joins_its_rows_but_not_where_more_varies() -> None:
    from matplotlib.collections import PathCollection
    from matplotlib.tri import TriContourSet

    points = latin(20, 3, 0)
    flat = Rows({"u": points[:, 0], "v": points[:, 1]}, {"y": points[:, 0]})
    assert isinstance(drawn(plot(flat, "y", kind="map"))[0].collections[0], TriContourSet)
    deep = Rows(dict(zip("uvw", points.T, strict=True)), {"y": points[:, 0]})
    (ax,) = drawn(plot(deep, "y", x="u", y="w"))
    assert isinstance(ax.collections[0], PathCollection) and ax.get_title() == "all values of v"


def test_an_output_over_time_has_a_line_a_row_and_shows_which_ended_early() -> None:
    time, gain = np.linspace(0.0, 0.02, 5), np.arange(1.0, 9.0)
    force = gain[:, None] * time
    force[2, 3:] = force[5] = np.nan
    rows = Rows({"gain": gain}, {"force": force}, unit="N", failed=(2, 5), dims=("time",), time=time)
    figure = plot(rows, "force")
    (ax,) = drawn(figure)
    lines = filled(ax)
    assert len(lines) == 7 + 1 and ax.get_xlabel() == "time [ms]" and "2 failed" in ax.get_title()
    cross = next(line for line in lines if line.get_marker() == "x")
    assert cross.get_xdata() == pytest.approx([10.0]) and len(figure.axes) == 2  # eight gains share a colour bar
    with pytest.raises(InputError, match=r"'max\(last\(force\)\)'"):
        plot(rows, "force", kind="map")


def test_a_colour_bar_keeps_the_colours_of_its_curves_in_the_dark_theme() -> None:
    time, gain = np.linspace(0.0, 0.02, 5), np.arange(1.0, 13.0)
    rows = Rows({"gain": gain}, {"force": gain[:, None] * time}, unit="N", dims=("time",), time=time)
    figure = plot(rows, "force", theme="dark", width=0.09)
    assert figure.get_facecolor()[:3] == pytest.approx(PAPER) and figure.get_figwidth() == pytest.approx(0.09 / INCH)
    (ax,) = drawn(figure)
    (bar,) = (one for one in figure.axes if one is not ax)
    shown = bar.collections[-1].get_cmap()
    for line, value in zip(filled(ax), (gain - 1.0) / 11.0, strict=True):
        assert to_rgb(line.get_color()) == pytest.approx(shown(value)[:3], abs=0.02)


@pytest.mark.parametrize("failed", [(), (1,)])
def test_maps_of_grids_and_samples_begin_dark_in_the_dark_theme(failed: tuple[int, ...]) -> None:
    points = latin(20, 2, 0)
    for at in (grid(u=[0.0, 1.0], v=[0.0, 1.0, 2.0]), {"u": points[:, 0], "v": points[:, 1]}):
        figure = plot(Rows(at, {"y": at["u"]}, failed=failed), "y", kind="map", theme="dark")
        colors = drawn(figure)[0].collections[0].get_cmap()
        assert sum(colors(0.0)[:3]) < 0.2 < 2.0 < sum(colors(1.0)[:3])
    with pytest.raises(InputError, match="theme is 'drak'"):
        plot(Rows(at, {"y": at["u"]}), "y", theme="drak")


def test_vectors_need_a_component_and_names_are_looked_up() -> None:
    rows = Rows({"gain": [1.0, 2.0]}, {"force": np.array([[1.0, 2, 3], [4, 5, 6]])}, unit="N", dims=("axis",))
    assert filled(drawn(plot(rows, "force", component="z"))[0])[0].get_ydata().tolist() == [3.0, 6.0]
    with pytest.raises(InputError, match="component=, 'x', 'y', 'z'"):
        plot(rows, "force")
    with pytest.raises(InputError, match="no component 'w'"):
        plot(rows, "force", component="w")
    with pytest.raises(InputError, match="did you mean 'gain'"):
        plot(rows, "force", x="gian", component="z")
    with pytest.raises(InputError, match="no row has gain = 3; the nearest value is 2"):
        plot(rows, "force", component="z", where={"gain": 3})
    with pytest.raises(InputError, match="gain is a number in all rows, got 'abc'"):
        plot(rows, "force", component="z", where={"gain": "abc"})
    fine = np.array([1.0, 1.000001])
    assert chosen_rows(Rows({"gain": fine}, {"y": fine}), {"gain": 1.000001}).tolist() == [False, True]
    with pytest.raises(InputError, match="given twice"):
        plot(rows, "force", x="gain", hue="gain", component="z")
    nothing = Rows({"gain": [1.0, 2.0]}, {"force": np.full(2, np.nan)}, failed=(0, 1))
    with pytest.raises(InputError, match=r"no row has a value of 'force' to draw \(2 failed\)"):
        plot(nothing, "force")


# --- the page


def test_the_page_of_a_sweep_stands_by_itself_and_shows_texts_as_texts() -> None:
    at = grid(load=[1.0, 2.0, 3.0], tilt=[0.0, 1.0, 2.0])
    rows = Rows(at, {"y": at["load"] + at["tilt"] ** 2}, failed=(4,))
    rows.columns["message"][4] = "<script>alert(1)</script> & more"
    rows.definition |= {"title": "<b>bold</b>", "error_budget": True}
    sources = np.array(["time step", "contact grid"], dtype=object)
    rows.columns |= {"error_source": sources, "error_budget": np.outer(np.ones(9), [0.25, np.nan])}
    read = Page(page(rows))
    assert "script" not in read.tags and "b" not in read.tags
    assert "<script>alert(1)</script> & more" in read.text and "Sweep: <b>bold</b>" in read.text
    assert "9 rows of equilibrium: 8 completed, 1 failed." in read.text
    assert len(read.pictures) == 2 + 1 + 1  # over each parameter, the map, Sobol indices
    assert "time step0.250.259" in read.text and "contact gridnot foundnot found0" in read.text
    assert "wf.study.sweep(" in read.text and "left out in turn" in read.text


# --- a sweep


@pytest.fixture(scope="module")
def swept(tmp_path_factory: pytest.TempPathFactory) -> Any:
    """Bobs at rest, of which the stiffest does not want to be."""
    return wf.study.sweep(
        shy_bob, {"stiffness": [1000.0, 2000.0, 3000.0, 4000.0]}, outputs={"rest": "last(body_position_z[bob])"},
        run=wf.equilibrium, store=tmp_path_factory.mktemp("reading") / "bob.sweep", progress=False,
    )  # fmt: skip


def test_a_sweep_is_read_from_its_folder(swept: Any, tmp_path: Path) -> None:
    found = swept.response("rest")
    assert found({"stiffness": 2000.0}) == pytest.approx(rest(2000.0), rel=1e-9) and "1 failed" in found.note
    figure = swept.plot("rest", path=tmp_path / "rest.png")
    assert drawn(figure)[0].get_ylabel() == "rest [mm]" and (tmp_path / "rest.png").is_file()
    written = swept.page(tmp_path / "bob.html")
    text = written.read_text(encoding="utf-8")
    assert "far too stiff" in text and Page(text).pictures
    swept.page(written, overwrite=True)
    with pytest.raises(InputError, match="exists"):
        swept.page(written)
    with pytest.raises(InputError, match=r"\.html"):
        swept.page(tmp_path / "bob.pdf")


def test_a_sweep_is_read_from_the_command_line(swept: Any, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    written, folder = tmp_path / "bob.html", str(swept.path)
    assert cli.main(["info", folder, "--page", str(written)]) == 0
    said = capsys.readouterr().out
    assert "3 completed, 1 failed" in said and "far too stiff" in said and str(written) in said
    picture = tmp_path / "rest.svg"
    chosen = ["--where", "stiffness=1000", "--x", "stiffness", "--out", str(picture)]
    assert cli.main(["sweep-plot", folder, "rest", *chosen]) == 0
    assert f"written to {picture}" in capsys.readouterr().out and "<svg" in picture.read_text(encoding="utf-8")
    assert cli.main(["sweep-plot", folder, "rest", "--where", "stiffness", "--out", str(picture)]) == 1
    assert "NAME=VALUE" in capsys.readouterr().err
    for value in ("", "abc", "1,2"):
        assert cli.main(["sweep-plot", folder, "rest", "--where", f"stiffness={value}", "--out", str(picture)]) == 1
        assert "stiffness" in capsys.readouterr().err
    assert cli.main(["sweep-plot", folder, "rast", "--out", str(picture), "--overwrite"]) == 1
    assert "did you mean 'rest'" in capsys.readouterr().err
    assert cli.main(["info", str(tmp_path)]) == 1


def test_histories_and_vectors_of_a_sweep_are_known_as_such(tmp_path: Path) -> None:
    swept = wf.study.sweep(
        bob, {"stiffness": [1000.0, 2000.0]}, outputs={"velocity": "body_velocity[bob]"}, run=IN_TIME,
        store=tmp_path / "bob.sweep", progress=False,
    )  # fmt: skip
    assert swept.about("velocity") == (("time", "axis"), "m/s") and swept.about("stiffness") == ((), "")
    (ax,) = drawn(swept.plot("velocity", component="z"))
    assert [line.get_ydata().tolist() for line in filled(ax)] == swept["velocity"][:, :, 2].tolist()
    assert ax.get_ylabel() == "velocity, z [m/s]"
    with pytest.raises(InputError, match="nearest|unknown|did you mean"):
        swept.about("velocty")
