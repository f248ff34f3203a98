"""xarray, VTK and figures: names and units, and that other programs read what is written."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from warpffrf.model.errors import InputError
from warpffrf.output.geometry.places import rotate
from warpffrf.output.plots.figure import PLOTS, write_figure
from warpffrf.output.result import Result


def test_xarray_has_names_units_and_values(result: Result) -> None:
    data = result.to_xarray()
    force = data["contact_force"]
    assert force.dims == ("time", "pair", "axis") and force.attrs["units"] == "N"
    assert np.array_equal(force.sel(pair="lower-upper").values, result.contact("lower-upper").force)
    assert data["energy"].sel(energy_line="kinetic").values == pytest.approx(result.energy["kinetic"])
    assert data["contact_pressure_lower-upper"].dims == ("time", "column_lower-upper", "row_lower-upper")
    assert all("units" in data[name].attrs and "frame" in data[name].attrs for name in data.data_vars)
    assert data.attrs["status"] == "completed"


def test_pyvista_opens_the_time_series(result: Result, tmp_path: Path) -> None:
    pyvista = pytest.importorskip("pyvista")
    path = result.to_vtu(tmp_path / "run.pvd", stride=4)
    reader = pyvista.PVDReader(str(path))
    assert reader.time_values == pytest.approx(list(result.time[::4]))
    i = 4
    reader.set_active_time_value(reader.time_values[1])
    blocks = reader.read()
    assert len(blocks) == 2
    for name, block in zip(result.skins(), blocks, strict=True):
        skin, motion = result.skins()[name], result.body(name)
        points = motion.position[i] + rotate(motion.rotation[i], skin.points)
        assert np.asarray(block.points) == pytest.approx(points, abs=1e-9)
        assert np.asarray(block["pressure"]) == pytest.approx(skin.pressure(i))
        expected = rotate(motion.rotation[i], skin.displacement(i))
        assert np.asarray(block["displacement"]) == pytest.approx(expected, abs=1e-15)


def test_vtu_refuses_wrong_arguments(result: Result, tmp_path: Path) -> None:
    with pytest.raises(InputError, match="must end in .pvd"):
        result.to_vtu(tmp_path / "run.vtu")
    with pytest.raises(InputError, match="stride is 0"):
        result.to_vtu(tmp_path / "run.pvd", stride=0)


def test_every_plot_has_axes_with_units(result: Result) -> None:
    figure = result.summary()
    labelled = [axes for axes in figure.axes if axes.get_xlabel()]
    assert len(labelled) == len(PLOTS) + 1  # and the energy
    for axes in labelled:
        assert "[" in axes.get_xlabel() and "[" in axes.get_ylabel()
        assert axes.has_data()


def test_a_single_plot_draws_on_given_axes(result: Result) -> None:
    from matplotlib.figure import Figure

    axes = Figure().add_subplot()
    assert result.plot("across", axes) is axes
    line = axes.get_lines()[0]
    assert line.get_ydata() == pytest.approx(result.contact("lower-upper").mid_pressure[-1] * 1e-6)
    with pytest.raises(InputError, match="unknown kind 'nonsense'; known: force"):
        result.plot("nonsense")


def test_figure_file(result: Result, tmp_path: Path) -> None:
    path = write_figure(result, tmp_path / "new" / "run.png", dpi=40)
    assert path.read_bytes().startswith(b"\x89PNG")
    with pytest.raises(InputError, match="figure"):
        write_figure(result, tmp_path / "run.nonsense", dpi=40)


def test_figure_of_a_run_that_never_touches(result: Result, tmp_path: Path) -> None:
    contact = result.history.contacts["lower-upper"]
    contact.pressure[:] = 0.0
    contact.load_second[:] = 0.0
    write_figure(Result(result.history), tmp_path / "open.png", dpi=40)


def test_report_names_status_notes_and_hertz(result: Result) -> None:
    result.history.status, result.history.message = "capacity", "contact 'lower-upper': raise capacity to >= 812"
    text = result.report()
    for part in ("capacity: contact 'lower-upper': raise capacity", "a term was dropped", "Hertz", "energy residual"):
        assert part in text


def test_energy_residual_is_relative_to_the_energy_at_hand(result: Result) -> None:
    assert result.energy_scale == pytest.approx(result.energy["kinetic"].max())
    assert result.energy_residual == pytest.approx(result.energy["numerical"] / result.energy_scale)
