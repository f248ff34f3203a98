"""xarray, VTKHDF and figures: names and units, and that other programs read what is written."""

from __future__ import annotations

import errno
import subprocess
import sys
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest

from vtkhdf_reader import read_vtkhdf
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


def expected_frame(result: Result, name: str, i: int) -> dict[str, np.ndarray]:
    """Points, triangles and fields of a body at saved step `i`, world axes."""
    skin, motion = result.skins()[name], result.body(name)
    rotation = motion.rotation[i]
    return {
        "points": motion.position[i] + rotate(rotation, skin.points),
        "triangles": skin.triangles,
        "displacement": rotate(rotation, skin.displacement(i)),
        "pressure": skin.pressure(i),
    }


def test_vtkhdf_has_the_layout_of_its_specification(result: Result, tmp_path: Path) -> None:
    """VTKHDF 2.1, docs.vtk.org: types and versions, an assembly in order of creation, offsets of each step."""
    with h5py.File(result.to_vtkhdf(tmp_path / "run.vtkhdf", stride=4)) as opened:
        file: Any = opened
        root = file["VTKHDF"]
        assert root.attrs["Type"] == b"MultiBlockDataSet" and list(root.attrs["Version"]) == [2, 1]
        assert root["Assembly"].id.get_create_plist().get_link_creation_order() & h5py.h5p.CRT_ORDER_TRACKED
        assert list(root["Assembly"]) == list(result.skins())
        for name in result.skins():
            assert isinstance(root["Assembly"].get(name, getlink=True), h5py.SoftLink)
            block, steps = root["Assembly"][name], root["Assembly"][name]["Steps"]
            assert block.attrs["Type"] == b"UnstructuredGrid" and list(block.attrs["Version"]) == [2, 1]
            assert h5py.check_string_dtype(block.attrs.get_id("Type").dtype).encoding == "ascii"  # type: ignore[union-attr]
            assert np.array_equal(steps["Values"], result.time[::4]) and steps.attrs["NSteps"] == len(result.time[::4])
            for step, i in enumerate(range(0, len(result.time), 4)):
                part = steps["PartOffsets"][step]
                n, cells = block["NumberOfPoints"][part], block["NumberOfCells"][part]
                expected = expected_frame(result, name, i)
                at = steps["CellOffsets"][step] + part
                ends = block["Offsets"][at : at + cells + 1]
                assert steps["NumberOfParts"][step] == 1 and np.array_equal(ends, 3 * np.arange(cells + 1))
                assert np.all(block["Types"][at - part : at - part + cells] == 5)  # VTK_TRIANGLE
                start = steps["ConnectivityIdOffsets"][step]
                corners = block["Connectivity"][start : start + block["NumberOfConnectivityIds"][part]]
                assert np.array_equal(corners.reshape(-1, 3), expected["triangles"])
                start = steps["PointOffsets"][step]
                assert np.array_equal(block["Points"][start : start + n], expected["points"])
                assert set(block["PointData"]) == set(steps["PointDataOffsets"]) == {"displacement", "pressure"}
                for field in block["PointData"]:
                    start = steps["PointDataOffsets"][field][step]
                    assert np.array_equal(block["PointData"][field][start : start + n], expected[field])


def test_pyvista_opens_the_file_of_a_run(result: Result, tmp_path: Path) -> None:
    path = result.to_vtkhdf(tmp_path / "run.vtkhdf", stride=4)
    for step, i in enumerate(range(0, len(result.time), 4)):
        blocks, time = read_vtkhdf(path, step)
        assert time == list(result.time[::4]) and blocks.keys() == list(result.skins())
        for name in result.skins():
            expected, block = expected_frame(result, name, i), blocks[name]
            assert np.array_equal(block.points, expected["points"])
            assert np.array_equal(block.cells_dict[5], expected["triangles"])
            assert set(block.point_data) == {"displacement", "pressure"}
            for field in block.point_data:
                assert np.array_equal(block[field], expected[field])


def test_vtkhdf_refuses_wrong_arguments(result: Result, tmp_path: Path) -> None:
    with pytest.raises(InputError, match="must end in .vtkhdf"):
        result.to_vtkhdf(tmp_path / "run.pvd")
    with pytest.raises(InputError, match="stride is 0"):
        result.to_vtkhdf(tmp_path / "run.vtkhdf", stride=0)
    result.to_vtkhdf(tmp_path / "run.vtkhdf", stride=8)
    with pytest.raises(InputError, match="exists"):
        result.to_vtkhdf(tmp_path / "run.vtkhdf")
    result.to_vtkhdf(tmp_path / "run.vtkhdf", stride=8, overwrite=True)


FULL = """
import resource, sys
from warpffrf.output.result import Result
result = Result.load(sys.argv[1])
resource.setrlimit(resource.RLIMIT_FSIZE, (20_000, 20_000))
try:
    result.to_vtkhdf(sys.argv[2], progress=False)
except OSError as error:
    print("refused", error.errno)
"""


def test_a_full_disk_is_an_error_and_leaves_no_file(result: Result, tmp_path: Path) -> None:
    """With HDF5's own writing the process ends by a crash."""
    saved = result.save(tmp_path / "run.h5")
    ended = subprocess.run(
        [sys.executable, "-c", FULL, saved, tmp_path / "run.vtkhdf"], capture_output=True, text=True, check=False
    )
    assert ended.returncode == 0 and f"refused {errno.EFBIG}" in ended.stdout, ended.stderr
    assert [file.name for file in tmp_path.iterdir()] == ["run.h5"]


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
