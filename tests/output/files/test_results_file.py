"""Results files: everything comes back, every dataset says unit and frame, damaged and foreign files are refused."""

from __future__ import annotations

from dataclasses import fields
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest
from synthetic_run import make_history

from warpffrf.model.errors import InputError
from warpffrf.model.files.sealed_file import seal
from warpffrf.output.files.fields import BODY_FIELDS, CONTACT_FIELDS, JOINT_FIELDS
from warpffrf.output.files.results import SCHEMA_VERSION
from warpffrf.output.result import Result


@pytest.fixture
def saved(result: Result, tmp_path: Path) -> Path:
    return result.save(tmp_path / "run.h5")


def test_everything_comes_back(result: Result, saved: Path) -> None:
    before, after = result.history, Result.load(saved).history
    for name in ("time", "step_size", "iterations", "factorisations"):
        assert np.array_equal(getattr(before, name), getattr(after, name))
    for group, table in (("bodies", BODY_FIELDS), ("joints", JOINT_FIELDS), ("contacts", CONTACT_FIELDS)):
        owners, loaded = getattr(before, group), getattr(after, group)
        assert list(owners) == list(loaded)
        for name, owner in owners.items():
            for record_field in fields(owner):
                if record_field.name in ("friction", "cells"):  # tables of their own, of pairs that have them
                    assert (
                        getattr(owner, record_field.name) is None and getattr(loaded[name], record_field.name) is None
                    )
                    continue
                expected, got = getattr(owner, record_field.name), getattr(loaded[name], record_field.name)
                assert np.array_equal(expected, got, equal_nan=True)
            # a field that the history gains must be given a name, a unit and a frame
            assert {f.name for f in fields(owner)} - {"friction", "cells"} == {f.attribute for f in table}
    assert {k: v.tolist() for k, v in before.energy.items()} == {k: v.tolist() for k, v in after.energy.items()}
    assert (before.status, before.message, before.counters, before.notes) == (
        after.status,
        after.message,
        after.counters,
        after.notes,
    )
    assert all(np.array_equal(before.checkpoint[k], after.checkpoint[k]) for k in before.checkpoint)


def test_derived_quantities_need_no_scene(result: Result, saved: Path) -> None:
    loaded = Result.load(saved)
    a, b = result.contact("lower-upper"), loaded.contact("lower-upper")
    assert np.array_equal(a.half_width, b.half_width)
    assert a.hertz(0) == b.hertz(0)
    i = len(result.time) - 1
    for name, skin in result.skins().items():
        assert np.array_equal(skin.displacement(i), loaded.skins()[name].displacement(i))
        assert np.array_equal(skin.pressure(i), loaded.skins()[name].pressure(i))
    assert loaded.report() == result.report()


def test_every_dataset_has_unit_and_frame(saved: Path) -> None:
    def check(name: str, item: Any) -> None:
        if isinstance(item, h5py.Dataset):
            assert {"units", "frame", "dims"} <= set(item.attrs), name

    with h5py.File(saved) as opened:
        opened.visititems(check)
        file: Any = opened
        assert file["contact_force"].shape == (9, 1, 3)
        assert file["contact_force"].attrs["units"] == "N"
        assert file["contact_pressure_theta/lower-upper"].shape == (9, 17)
        assert len(file["reduced"]) == 1  # both rollers are the same reduced body, stored once


def test_odd_names_survive(body, tmp_path: Path) -> None:
    name = "a/b. ü-c"
    path = Result(make_history(body, name=name)).save(tmp_path / "run.h5")
    assert Result.load(path).contact_names == [name]


def test_a_run_without_rows_is_saved(result: Result, tmp_path: Path) -> None:
    for array in ("time", "step_size", "iterations", "factorisations"):
        setattr(result.history, array, getattr(result.history, array)[:0])
    for group in (result.history.bodies, result.history.joints, result.history.contacts):
        for owner in group.values():
            for record_field in fields(owner):
                if getattr(owner, record_field.name) is None:  # friction, cells
                    continue
                setattr(owner, record_field.name, getattr(owner, record_field.name)[:0])
    result.history.energy = {k: v[:0] for k, v in result.history.energy.items()}
    result.history.status, result.history.message = "not_converged", "the first step failed; reduce step"
    empty = Result(result.history)
    loaded = Result.load(empty.save(tmp_path / "run.h5"))
    assert loaded.status == "not_converged" and len(loaded.time) == 0
    assert "no step was saved" in loaded.report()


def test_saving_does_not_touch_the_old_file_when_it_fails(result: Result, saved: Path) -> None:
    before = saved.read_bytes()
    result.history.counters = {"steps": object()}  # pyright: ignore[reportAttributeAccessIssue]
    with pytest.raises(TypeError):
        result.save(saved, overwrite=True)
    assert saved.read_bytes() == before
    assert [p.name for p in saved.parent.iterdir()] == [saved.name]


def test_missing_damaged_foreign_and_newer_files_are_refused(saved: Path, tmp_path: Path) -> None:
    with pytest.raises(InputError, match="does not exist"):
        Result.load(tmp_path / "nothing.h5")
    text = tmp_path / "text.h5"
    text.write_text("no HDF5")
    with pytest.raises(InputError, match="damaged"):
        Result.load(text)
    foreign = tmp_path / "foreign.h5"
    h5py.File(foreign, "w").close()
    with pytest.raises(InputError, match="no file of warpffrf"):
        Result.load(foreign)
    with h5py.File(saved, "a") as file:
        del file["contact_force"]
    with pytest.raises(InputError, match="another program has changed it"):
        Result.load(saved)
    seal(saved)
    with pytest.raises(InputError, match="damaged .*missing"):
        Result.load(saved)
    with h5py.File(saved, "a") as file:
        file.attrs["schema_version"] = SCHEMA_VERSION + 1
    seal(saved)
    with pytest.raises(InputError, match=f"schema {SCHEMA_VERSION + 1}, .*write it again with this version"):
        Result.load(saved)


def test_unknown_names_list_the_known(result: Result) -> None:
    for ask, kind in ((result.body, "body"), (result.joint, "joint"), (result.contact, "contact")):
        with pytest.raises(InputError, match=f"no {kind} called 'nobody'; it has: '"):
            ask("nobody")
