"""Friction and rigid partners in results files, datasets and VTKHDF files."""

from __future__ import annotations

from dataclasses import fields
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest
from rubbing_run import MU, make_rubbing_history
from shape_runs import on_the_floor
from synthetic_run import COLUMNS, ROWS, STEPS, WINDOW, R, make_history

from vtkhdf_reader import read_vtkhdf
from warpffrf.model.errors import InputError
from warpffrf.online.history.history import FrictionHistory
from warpffrf.output.files.fields import FRICTION_DERIVED, FRICTION_FIELDS
from warpffrf.output.geometry.places import rotate
from warpffrf.output.geometry.scene_view import SceneView
from warpffrf.output.result import Result


@pytest.fixture
def rubbing(body) -> Result:
    return Result(make_rubbing_history(body))


def test_friction_comes_back(rubbing: Result, tmp_path: Path) -> None:
    loaded = Result.load(rubbing.save(tmp_path / "run.h5"))
    before, after = rubbing.contact("lower-upper").friction, loaded.contact("lower-upper").friction
    for field in fields(FrictionHistory):
        expected, got = getattr(before.history, field.name), getattr(after.history, field.name)
        assert np.array_equal(expected, got) and expected.dtype == got.dtype
    # a field that the history gains must be given a name, a unit and a frame
    assert {f.name for f in fields(FrictionHistory)} == {f.attribute for f in FRICTION_FIELDS}
    assert loaded.contact("lower-upper").view.friction == MU
    assert loaded.report() == rubbing.report()
    assert np.array_equal(before.wear_index, after.wear_index)


def test_a_file_says_units_and_directions(rubbing: Result, tmp_path: Path) -> None:
    with h5py.File(rubbing.save(tmp_path / "run.h5")) as opened:
        file: Any = opened
        traction = file["contact_traction/lower-upper"]
        assert traction.shape == (STEPS, 2, WINDOW, ROWS) and traction.attrs["units"] == "Pa"
        assert traction.attrs["dims"] == "time direction column row"
        assert file["contact_friction_power"].attrs["dims"] == "time friction_pair"
        assert file["contact_half_widths"].attrs["dims"] == "time pair direction"
        for field in (*FRICTION_FIELDS, *FRICTION_DERIVED):
            assert field.name in file


def test_a_file_without_friction_has_none_of_it(result: Result, tmp_path: Path) -> None:
    with h5py.File(result.save(tmp_path / "run.h5")) as file:
        assert not {f.name for f in FRICTION_FIELDS} & set(file)


def test_a_pair_with_and_one_without_friction(body, tmp_path: Path) -> None:
    history, other = make_rubbing_history(body), make_history(body, name="plain")
    view, more = history.scene, other.scene
    assert isinstance(view, SceneView) and isinstance(more, SceneView)
    history.scene = SceneView("hash", view.bodies, {"plain": more.pairs["plain"], **view.pairs})
    history.contacts = {"plain": other.contacts["plain"], **history.contacts}
    loaded = Result.load(Result(history).save(tmp_path / "run.h5"))
    assert [loaded.contact(n).has_friction for n in loaded.contact_names] == [False, True]
    title = loaded.summary().get_suptitle()  # the panels show one pair each: which is said
    assert "contact 'plain', the first of 2" in title and "friction of 'lower-upper'" in title
    assert "contact 'lower-upper'" in loaded.summary(contact="lower-upper").get_suptitle()
    assert [line.get_label() for line in loaded.plot("force", contact="lower-upper").lines] == ["lower-upper"]
    with pytest.raises(InputError, match="no contact called 'upper-lower'; did you mean 'lower-upper' .the order c"):
        loaded.contact("upper-lower")
    with pytest.raises(InputError, match="no contact called 'other'; it has: 'plain', 'lower-upper'"):
        loaded.plot("patch", contact="other")
    with pytest.raises(InputError, match="no contact pair of the run has friction"):
        loaded.plot("traction", contact="plain")
    power = loaded.contact("lower-upper").friction.power
    assert np.array_equal(power, history.contacts["lower-upper"].friction.power)  # type: ignore[union-attr]
    data = Result(history).to_xarray()
    assert data["contact_force"].sizes["pair"] == 2 and data["contact_creepage"].sizes["friction_pair"] == 1


def test_xarray_has_friction_with_directions(rubbing: Result) -> None:
    data = rubbing.to_xarray()
    friction = rubbing.contact("lower-upper").friction
    around = data["contact_creepage"].sel(friction_pair="lower-upper", direction="e_theta")
    assert np.array_equal(around.values, friction.creepage[:, 0])
    traction = data["contact_traction_lower-upper"]
    assert traction.dims == ("time", "direction", "column_lower-upper", "row_lower-upper")
    assert np.array_equal(traction.sel(direction="t_z").values, friction.traction[:, 1])
    assert all("units" in data[name].attrs and "frame" in data[name].attrs for name in data.data_vars)


def test_vtkhdf_carries_traction_slip_and_state(rubbing: Result, tmp_path: Path) -> None:
    blocks, _ = read_vtkhdf(rubbing.to_vtkhdf(tmp_path / "run.vtkhdf", stride=4), 1)
    for name in ("lower", "upper"):
        mesh = blocks[name]
        skin = rubbing.skins()[name]
        expected = rotate(rubbing.body(name).rotation[4], skin.traction(4))
        assert mesh.point_data["traction"] == pytest.approx(expected)
        assert set(np.unique(mesh.point_data["state"])) == {0, 1, 2}
        assert mesh.point_data["wear"].max() > 0.0 and mesh.point_data["slip"].max() > 0.0


def test_a_rigid_partner_comes_back(body, tmp_path: Path) -> None:
    before = Result(on_the_floor(body))
    loaded = Result.load(before.save(tmp_path / "run.h5"))
    a, b = before.contact("lower-upper"), loaded.contact("lower-upper")
    assert b.view.second_body.name == "ground" and b.view.second.grid is None
    assert b.view.second.shape.describe() == a.view.second.shape.describe()
    assert b.effective_radius == a.effective_radius == pytest.approx(R)
    assert b.hertz(0) == a.hertz(0) and a.hertz(0).modulus == pytest.approx(2.0 * _pair_modulus(body))
    assert len(loaded.skins()) == 1 and COLUMNS == b.view.first.grid.columns
    assert np.array_equal(loaded.skins()["lower"].displacement(3), before.skins()["lower"].displacement(3))


def _pair_modulus(body: Any) -> float:
    """E* of two such bodies."""
    return Result(make_history(body)).contact("lower-upper").effective_modulus
