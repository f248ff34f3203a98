"""Histories as a table: names, units, what is in it and what is not, and that it comes back from its file in full."""

from __future__ import annotations

import csv
import sys
from pathlib import Path

import numpy as np
import pytest
from rubbing_run import add_friction
from synthetic_run import make_history

from warpffrf.model.errors import InputError
from warpffrf.model.reduced.body import ReducedBody
from warpffrf.online.history.history import ForceHistory, JointFrictionHistory, SensorHistory
from warpffrf.output.files.table import histories
from warpffrf.output.result import Result


@pytest.fixture
def rubbing(body: ReducedBody) -> Result:
    history = add_friction(make_history(body, name="roller, on plate"))
    steps = len(history.time)
    history.joints["axle"].names = ("rotation",)
    friction = JointFrictionHistory(
        np.ones(steps, dtype=np.int8), np.ones((steps, 2)), np.full((steps, 2), 2.0), np.ones(steps), np.ones(steps)
    )
    history.forces = {
        "spring": ForceHistory(np.zeros((steps, 3)), np.zeros((steps, 3)), np.full((steps, 1), 3e-3)),
        "brake": ForceHistory(np.zeros((steps, 3)), np.zeros((steps, 3)), np.zeros((steps, 0)), friction),
    }
    history.sensors = {"tip": SensorHistory("stress", "Pa", "body", ("xx", "von_mises"), np.ones((steps, 2)))}
    return Result(history)


def test_a_table_has_histories_alone(rubbing: Result) -> None:
    pytest.importorskip("pandas")
    table = rubbing.to_dataframe()
    pair = "roller, on plate"
    contact = rubbing.contact(pair)
    assert table.index.name == "time" and np.array_equal(table.index, rubbing.time)
    expected = {
        f"contact_force_z[{pair}]": (contact.force[:, 2], "N"),
        f"contact_half_width[{pair}]": (contact.half_width, "m"),
        f"contact_creepage_e_theta[{pair}]": (contact.friction.creepage[:, 0], "1"),
        "joint_coordinate[axle]": (rubbing.joint("axle").named("rotation"), "rad"),
        "applied_deformation_0[spring]": (np.full(len(rubbing.time), 3e-3), "m or rad"),
        "joint_traction_around[brake]": (np.full(len(rubbing.time), 2.0), "N"),
        "body_rotation_w[upper]": (rubbing.body("upper").rotation[:, 3], "1"),
        "sensor_von_mises[tip]": (np.ones(len(rubbing.time)), "Pa"),
        "energy[kinetic]": (rubbing.energy["kinetic"], "J"),
    }
    for name, (values, unit) in expected.items():
        assert np.array_equal(table[name], values) and table.attrs["units"][name] == unit
    assert not [
        n for n in table if n.startswith(("body_modal", "contact_pressure", "contact_traction_e", "contact_wear_i"))
    ]
    assert "joint_second_coordinate[axle]" not in table  # the joint has one
    assert table.columns.is_unique and table.shape[0] == len(rubbing.time)


def test_a_csv_file_brings_every_number_back(rubbing: Result, tmp_path: Path) -> None:
    path = rubbing.to_csv(tmp_path / "run.csv")
    with path.open(newline="", encoding="utf-8") as file:
        header, *rows = csv.reader(file)
    assert header[:2] == ["time [s]", "step_size [s]"] and "contact_force_z[roller, on plate] [N]" in header
    columns = [values for series in histories(rubbing) for values in series.columns.values()]
    assert np.array_equal(np.array(rows, dtype=float), np.stack([rubbing.time, *columns], axis=1), equal_nan=True)


def test_only_tables_are_replaced(result: Result, tmp_path: Path) -> None:
    path = result.to_csv(tmp_path / "run.csv")
    with pytest.raises(InputError, match="exists"):
        result.to_csv(path)
    assert result.to_csv(path, overwrite=True) == path
    foreign = tmp_path / "mine.csv"
    foreign.write_text("time,a\n0,1\n")
    with pytest.raises(InputError, match="not written by warpffrf"):
        result.to_csv(foreign, overwrite=True)
    assert foreign.read_text() == "time,a\n0,1\n"
    with pytest.raises(InputError, match="must end in .csv"):
        result.to_csv(tmp_path / "run.xlsx")


def test_without_pandas_the_cure_is_named(result: Result, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "pandas", None)
    with pytest.raises(ImportError, match=r"warpffrf\[tables\].*to_csv"):
        result.to_dataframe()
