"""Packing of scenes as FMUs, and their instances, without the libraries that importing tools need."""

from __future__ import annotations

import json
import math
import sys
from pathlib import Path
from typing import Any

import pytest

import warpffrf as wf
from warpffrf import cli
from warpffrf.fmu import write_fmu
from warpffrf.fmu.instance import DEFINITION, SCENE, Instance, from_bytes, to_bytes
from warpffrf.fmu.units import base_powers
from warpffrf.fmu.write import _definition, _pack

ROLLER = """\
include = ["steel.toml"]
[signals.load]
kind = "input"
name = "load"
unit = "N"
initial = -100.0
[signals.course]
kind = "table"
times = [0.0, 1.0]
values = { file = "course.csv", column = 1 }
[meshes.block]
kind = "grid"
x = [0.0, 0.01, 0.02]
y = [0.0, 0.01]
z = [0.0, 0.01]
[reduced_bodies.block]
mesh = "block"
material = "steel"
modes = 2
[reduced_bodies.block.interfaces]
x_min = "rigid"
x_max = "rigid"
[bodies.block]
body = "block"
[joints.held]
kind = "fixed"
a = "ground"
b = "block.x_min"
[forces.push]
kind = "point_force"
port = "block.x_max"
force = ["load", "course", 0.0]
[sensors.end]
kind = "position"
port = "block.x_max"
[simulate]
duration = 0.5
step = 1e-4
start = "equilibrium"
results = "block.h5"
"""
STEEL = """\
[materials.steel]
youngs_modulus = 210e9
poisson_ratio = 0.3
density = 7850.0
"""


def test_units_in_base_units() -> None:
    for unit, powers in (
        ("N m", {"kg": 1, "m": 2, "s": -2}),
        ("rad/s2", {"rad": 1, "s": -2}),
        ("N s/m", {"kg": 1, "s": -1}),
        ("W/m2", {"kg": 1, "s": -3}),
        ("m3/s", {"m": 3, "s": -1}),
        ("1", {}),
        ("m or rad", None),
        ("rev/min", None),
        ("m/s/s", None),
    ):
        assert base_powers(unit) == powers, unit


@pytest.fixture
def packed(tmp_path: Path) -> Path:
    """A flexible block, a table from a file, an include and a start from an equilibrium, packed."""
    source, folder = tmp_path / "source", tmp_path / "packed"
    source.mkdir()
    folder.mkdir()
    (source / "block.toml").write_text(ROLLER)
    (source / "steel.toml").write_text(STEEL)
    (source / "course.csv").write_text("0.0,0.0\n1.0,50.0\n")
    loaded = wf.load_scene(source / "block.toml")
    _pack(loaded, folder, 1e-4, None)
    definition = _definition(wf.load_scene(folder / SCENE), "block", None, None)
    (folder / DEFINITION).write_text(json.dumps(definition))
    return folder


def test_a_packed_scene_needs_nothing_else(packed: Path) -> None:
    """No mesh, and the numbers of the scene itself: the same bits."""
    text = (packed / SCENE).read_text()
    assert "meshes" not in text
    assert str(packed.parent) not in text
    whole = wf.load_scene(packed.parent / "source" / "block.toml", settings=["signals.load.initial=-200.0"])
    sim = wf.Simulation(whole.scene, step=1e-4, start="equilibrium")
    for file in (packed.parent / "source").iterdir():
        file.unlink()
    messages: list[str] = []
    one = Instance(packed, messages.append)
    assert [each["name"] for each in one.definition["outputs"]] == [f"sensor_{a}[end]" for a in "xyz"]
    assert [each["unit"] for each in one.definition["outputs"]] == ["m"] * 3
    one.begin(0.0)
    one.set("load", -200.0)
    one.end_initialisation()
    assert one.get("sensor_x[end]") == sim.outputs["sensor_x[end]"] != 0.02
    one.set("load", 300.0)
    sim.inputs["load"] = 300.0
    assert one.step(0.0, 5e-4)
    sim.run(5e-4)
    assert one.get("sensor_x[end]") == sim.outputs["sensor_x[end]"]
    assert messages == []


def test_values_of_the_initialisation_are_initial_values(packed: Path) -> None:
    """Outputs may be read before it ends, and follow the inputs; so do states."""
    one = Instance(packed, [].append)
    places = []
    for load in (0.0, -1e3):
        one.set("load", load)
        places.append(one.get("sensor_x[end]"))
    assert places[1] < places[0]
    one.end_initialisation()
    state = one.state()
    other = Instance(packed, [].append)
    other.put(from_bytes(to_bytes(state)))
    assert other.get("load") == -1e3
    for each in (one, other):
        assert each.step(0.0, 2e-4)
    assert one.get("sensor_x[end]") == other.get("sensor_x[end]")


def test_an_instance_never_raises(packed: Path) -> None:
    messages: list[str] = []
    one = Instance(packed, messages.append)
    one.set("load", math.inf)
    assert math.isnan(one.get("sensor_x[end]"))
    one.end_initialisation()
    assert not one.step(0.0, 1e-4)
    assert not one.step(math.nan, 1e-4)
    one.put(from_bytes(b"\x00" * 100))
    one.put({"wrong": 1})  # type: ignore[dict-item]
    assert one.state() == {}
    assert all("'load' must be a finite number" in said or "state" in said for said in messages)
    one.set("load", 1.0)
    assert one.step(0.0, 1e-4)
    assert one.status == "completed"
    (packed / SCENE).write_text("no scene")
    other = Instance(packed, messages.append)
    assert not other.step(0.0, 1e-4)
    assert SCENE in other.status


@pytest.mark.parametrize(
    ("options", "said"),
    [
        ({"inputs": ["lod"]}, "input 'lod' does not exist; did you mean 'load'"),
        ({"outputs": ["sensor_w[end]"]}, "no quantity 'sensor_w"),
        ({"outputs": []}, "there is no output"),
        ({"step": 0.0}, "write_fmu: step"),
        ({"start": "rest"}, "start must be 'initial' or 'equilibrium'"),
    ],
)
def test_wrong_arguments(tmp_path: Path, options: dict[str, Any], said: str) -> None:
    pytest.importorskip("pythonfmu")
    (tmp_path / "block.toml").write_text(ROLLER.replace('include = ["steel.toml"]', STEEL))
    (tmp_path / "course.csv").write_text("0.0,0.0\n1.0,50.0\n")
    with pytest.raises(wf.InputError, match=said):
        write_fmu(tmp_path / "block.toml", tmp_path / "block.fmu", **options)
    assert not (tmp_path / "block.fmu").exists()


def test_files_and_libraries(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: Any) -> None:
    (tmp_path / "block.toml").write_text(ROLLER)
    with pytest.raises(wf.InputError, match="fmi must be one of '2.0', '3.0'"):
        write_fmu(tmp_path / "block.toml", tmp_path / "block.fmu", fmi="1.0")
    monkeypatch.setitem(sys.modules, "pythonfmu", None)
    assert cli.main(["fmu", str(tmp_path / "block.toml"), "-o", str(tmp_path / "block.fmu")]) == 1
    assert "pip install 'warpffrf[fmu]'" in capsys.readouterr().err
