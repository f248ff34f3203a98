"""Cams with their followers in scene files: the same scene as from Python, and refusals with their line."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import warpffrf as wf
from warpffrf.model.errors import InputError
from warpffrf.scene_file import load_scene

FILE = """
[materials.steel]
youngs_modulus = 210e9
poisson_ratio = 0.3
density = 7850

[signals.lift]
kind = "table"
times = [0, 1, 2, 3, 6.283185307179586]
values = [0, 2e-3, 2e-3, 0, 0]
cubic = true

[reduced_bodies.ring]
kind = "half_space"
mass = 0.1
inertia_tensor = [1e-4, 1e-4, 1e-4]
material = "steel"
extent = [-4e-3, 4e-3]
contact = { rim = { kind = "cylinder", radius = 8e-3, axis_point = [0, 0, 0], axis_direction = [0, 1, 0] } }

[bodies.cam]
mass = 0.5
inertia_tensor = [1e-4, 1e-4, 1e-4]
[bodies.cam.surfaces.face]
kind = "extruded"
axis_direction = [0, 1, 0]
x_direction = [0, 0, 1]
curve = { kind = "cam", base_radius = 20e-3, roller_radius = 8e-3, lift = "lift" }

[bodies.roller]
body = "ring"
position = [0, 0, 0.03]

[bodies.tappet]
mass = 0.2
inertia_tensor = [1e-4, 1e-4, 1e-4]
position = [0, 0, 0.03]

[cams.valve]
cam = "cam.face"
follower = "roller.rim"
carrier = "tappet"
speed = 50.0
stiffness = 40e3
preload = 300.0
friction = 0.1
"""


def written(folder: Path, text: str) -> Path:
    path = folder / "scene.toml"
    path.write_text(text, encoding="utf-8")
    return path


def by_hand() -> wf.Scene:
    steel = wf.Material(youngs_modulus=210e9, poisson_ratio=0.3, density=7850, name="steel")
    lift = wf.signals.Table([0, 1, 2, 3, 2.0 * np.pi], [0, 2e-3, 2e-3, 0, 0], cubic=True)
    section = wf.surfaces.cam(lift, base_radius=20e-3, roller_radius=8e-3)
    face = wf.surfaces.Extruded(curve=section, axis_direction=(0, 1, 0), x_direction=(0, 0, 1))
    rim = wf.surfaces.Cylinder(radius=8e-3, axis_point=(0, 0, 0), axis_direction=(0, 1, 0))
    ring = wf.half_space_body(0.1, (1e-4,) * 3, steel, contact={"rim": rim}, extent=(-4e-3, 4e-3))
    scene = wf.Scene()
    cam = scene.add_rigid_body(0.5, (1e-4,) * 3, name="cam", surfaces={"face": face})
    roller = scene.add_body(ring, name="roller", position=(0, 0, 0.03))
    tappet = scene.add_rigid_body(0.2, (1e-4,) * 3, name="tappet", position=(0, 0, 0.03))
    scene.add_cam(
        cam["face"],
        roller["rim"],
        name="valve",
        carrier=tappet,
        speed=50.0,
        stiffness=40e3,
        preload=300.0,
        friction=0.1,
    )
    return scene


def test_a_file_has_the_joints_spring_and_contact_of_the_call(tmp_path: Path) -> None:
    scene = load_scene(written(tmp_path, FILE)).scene
    assert scene.describe() == by_hand().describe()
    assert scene.cams[0].jump_speed == by_hand().cams[0].jump_speed > 0.0


def test_what_is_wrong_is_refused_with_its_line(tmp_path: Path) -> None:
    for wrong, right, message in (
        ('cam = "roller.rim"', 'cam = "cam.face"', "scene.toml:.*cams.valve.*a cam is surfaces.Extruded"),
        ('carrier = "tapet"', 'carrier = "tappet"', "scene.toml:.*there is no body 'tapet'"),
        ("stifness = 40e3", "stiffness = 40e3", "scene.toml:.*unknown key 'stifness'"),
        ('friction = "rough"', "friction = 0.1", "scene.toml:.*friction must be a number or a table"),
    ):
        with pytest.raises(InputError, match=message):
            load_scene(written(tmp_path, FILE.replace(right, wrong)))
