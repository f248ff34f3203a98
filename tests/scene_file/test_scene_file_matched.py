"""Faces of small-sliding contacts in scene files."""

from __future__ import annotations

from pathlib import Path

import pytest

import warpffrf as wf

SCENE = """
[materials.steel]
youngs_modulus = 210e9
poisson_ratio = 0.3
density = 7850.0
[meshes.plate]
kind = "box"
size = [1.0, 1.0, 0.2]
counts = [4, 4, 1]
order = 1
[reduced_bodies.plate]
mesh = "plate"
material = "steel"
cache = false
contact = FACES
[bodies.plate]
body = "plate"
"""


def written(tmp_path: Path, faces: str) -> Path:
    path = tmp_path / "scene.toml"
    path.write_text(SCENE.replace("FACES", faces))
    return path


def test_names_and_tables(tmp_path: Path) -> None:
    loaded = wf.load_scene(
        written(tmp_path, '{ foot = { kind = "matched", first = "z_min", size = 0.5 }, z_max = "matched" }')
    )
    matched = loaded.scene.bodies[0].reduced.matched
    assert {name: lap.cells for name, lap in matched.items()} == {"foot": 4, "z_max": 16}


def test_what_does_not_exist_is_named(tmp_path: Path) -> None:
    with pytest.raises(wf.InputError, match="scene.toml:15: .*foot.*unknown key 'edge'; known: 'second'"):
        wf.load_scene(written(tmp_path, '{ foot = { kind = "matched", first = "z_min", edge = 0.5 } }'))
    with pytest.raises(wf.InputError, match="contact 'z_mid': .*'z_mid' does not exist"):
        wf.load_scene(written(tmp_path, '{ z_mid = "matched" }'))
    with pytest.raises(wf.InputError, match="unknown key 'laps'; it is called 'contact' now"):
        wf.load_scene(written(tmp_path, '{}\nlaps = { foot = "z_min" }'))
