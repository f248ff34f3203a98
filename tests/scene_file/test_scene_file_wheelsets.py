"""Wheelsets on their track in scene files: the same scene as from Python, and refusals with their line."""

from __future__ import annotations

from pathlib import Path

import pytest

import warpffrf as wf
from warpffrf.model.errors import InputError
from warpffrf.scene_file import load_scene

FILE = """
[materials.steel]
youngs_modulus = 210e9
poisson_ratio = 0.28
density = 7850

[wheelsets.front]
wheel = { kind = "wheel_s1002", radius = 0.46 }
rail = { kind = "rail_uic60" }
mass = 1200.0
inertia_tensor = [700.0, 100.0, 700.0]
material = "steel"
track = [-1.0, 5.0]
speed = 10.0
yaw = 2.4e-3
friction = 0.3
cells = [9, [-20e-3, -10e-3, 0.0, 10e-3, 20e-3]]

[forces.load]
kind = "point_force"
port = "front.center"
force = [0, 0, -100e3]
"""


def written(folder: Path, text: str) -> Path:
    path = folder / "scene.toml"
    path.write_text(text, encoding="utf-8")
    return path


def test_a_file_has_the_bodies_and_contacts_of_the_call(tmp_path: Path) -> None:
    steel = wf.Material(youngs_modulus=210e9, poisson_ratio=0.28, density=7850, name="steel")
    scene = wf.Scene()
    front = scene.add_wheelset(
        wf.surfaces.wheel_s1002(radius=0.46), wf.surfaces.rail_uic60(), name="front", mass=1200.0,
        inertia_tensor=(700.0, 100.0, 700.0), material=steel, track=(-1.0, 5.0), speed=10.0, yaw=2.4e-3, friction=0.3,
        cells=(9, [-20e-3, -10e-3, 0.0, 10e-3, 20e-3]),
    )  # fmt: skip
    scene.add(wf.forces.PointForce(front.body["center"], (0, 0, -100e3), name="load"))
    assert load_scene(written(tmp_path, FILE)).scene.content_hash() == scene.content_hash()


def test_what_is_wrong_is_refused_with_its_line(tmp_path: Path) -> None:
    for wrong, right, message in (
        (
            'wheel = { kind = "rail_uic60" }',
            'wheel = { kind = "wheel_s1002", radius = 0.46 }',
            "wheelset 'front': wheel",
        ),
        ("track = [1.0, 5.0]", "track = [-1.0, 5.0]", "scene.toml:13: .*track must contain x = 0"),
        ('port = "frnt.center"', 'port = "front.center"', "scene.toml:.*there is no body 'frnt'"),
        ('rail = "rail_uic60"', 'rail = { kind = "rail_uic60" }', "scene.toml:.*rail"),
    ):
        with pytest.raises(InputError, match=message):
            load_scene(written(tmp_path, FILE.replace(right, wrong)))
