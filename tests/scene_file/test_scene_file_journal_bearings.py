"""Journal and thrust bearings in scene files: the same scene as from Python, and refusals with their line."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import warpffrf as wf
from warpffrf.model.errors import InputError
from warpffrf.scene_file import load_scene

FILE = """
[bodies.shaft]
kind = "rigid"
mass = 20.0
inertia_tensor = [0.1, 0.1, 0.1]
angular_velocity = [0, 300, 0]
surfaces = { front = { kind = "cylinder", radius = 0.05, axis_point = [0, -0.2, 0], axis_direction = [0, 1, 0] }, back = { kind = "cylinder", radius = 0.05, axis_point = [0, 0.2, 0], axis_direction = [0, 1, 0] } }

[journal_bearings.front]
journal = "shaft.front"
pads = [
  { kind = "pad", middle = 0.0, arc = 2.8 },
  { kind = "pad", middle = 3.14, arc = 2.8, preload = 0.3, dam = { kind = "dam", depth = 5e-5, arc = 2.0 } },
]
clearance = 1e-4
length = 0.05
position = [0, -0.2, 0]
oil = { kind = "newtonian", viscosity = 0.02, thermal = { kind = "thermal", law = { kind = "walther_law", points = [[40, 32e-6], [100, 5e-6]] }, temperature = 50, heat_capacity = 2000 } }
temperature = { kind = "film_temperature", supply = 45, wall_a = 50 }

[journal_bearings.back]
journal = "shaft.back"
pads = { kind = "pads", count = 4, arc = 1.3, first = 0.785, preload = 0.4 }
clearance = 1e-4
length = 0.05
tilting = { kind = "tilting_pads", thickness = 0.015, pivot = "point" }
position = [0, 0.2, 0]
oil = { kind = "iso_vg", grade = 32, temperature = 50, heat_capacity = 2000 }
temperature = { kind = "film_temperature", supply = 40, carry_over = 0.8 }
support = "ground"
nodes = [24, 9]

[sensors.pad]
kind = "position"
port = "back pad 2.pivot"
"""  # noqa: E501


def written(folder: Path, text: str) -> Path:
    path = folder / "scene.toml"
    path.write_text(text, encoding="utf-8")
    return path


def test_a_file_has_the_bodies_and_films_of_the_calls(tmp_path: Path) -> None:
    scene, y = wf.Scene(), (0, 1, 0)
    journals = {
        name: wf.surfaces.Cylinder(radius=0.05, axis_point=(0, at, 0), axis_direction=y)
        for name, at in (("front", -0.2), ("back", 0.2))
    }
    shaft = scene.add_rigid_body(20.0, (0.1,) * 3, name="shaft", angular_velocity=(0, 300, 0), surfaces=journals)
    dam = wf.films.Dam(5e-5, 2.0)
    thermal = wf.oils.Thermal(wf.oils.WaltherLaw([(40, 32e-6), (100, 5e-6)]), 50, 2000)
    scene.add_journal_bearing(
        "front", shaft["front"], [wf.films.Pad(0.0, 2.8), wf.films.Pad(3.14, 2.8, preload=0.3, dam=dam)],
        clearance=1e-4, length=0.05, position=(0, -0.2, 0), oil=wf.oils.Newtonian(0.02, thermal=thermal),
        temperature=wf.films.FilmTemperature(45, wall_a=50),
    )  # fmt: skip
    bearing = scene.add_journal_bearing(
        "back", shaft["back"], wf.films.pads(4, 1.3, first=0.785, preload=0.4), clearance=1e-4, length=0.05,
        tilting=wf.films.TiltingPads(0.015, pivot="point"), position=(0, 0.2, 0),
        oil=wf.oils.iso_vg(32, temperature=50, heat_capacity=2000), nodes=(24, 9),
        temperature=wf.films.FilmTemperature(40, carry_over=0.8),
    )  # fmt: skip
    scene.add(wf.sensors.Position(bearing.bodies[1]["pivot"], name="pad"))
    loaded = load_scene(written(tmp_path, FILE)).scene
    assert loaded.content_hash() == scene.content_hash()
    # the shaft rotates from pad 1 to pad 2
    assert [getattr(film.temperature, "upstream", None) for film in loaded.films[1:]] == [
        f"back pad {n}" for n in (4, 1, 2, 3)
    ]
    assert np.allclose([film.clearance() for film in loaded.films], 1e-4)


def test_what_is_wrong_is_refused_with_its_line(tmp_path: Path) -> None:
    for right, wrong, message in (
        ('kind = "tilting_pads"', 'kind = "tilting"', "there is no kind 'tilting'"),
        ("arc = 1.3", "arc = 1.9", "pads overlap"),
        ("thickness = 0.015", "thickness = -0.015", "thickness"),
        ("supply = 45", "supply = 318", "from kelvins subtract 273.15"),
        ("temperature = 50, heat_capacity = 2000 }\n", "temperature = 50 }\n", "no heat capacity"),
    ):
        with pytest.raises(InputError, match=message):
            load_scene(written(tmp_path, FILE.replace(right, wrong)))


THRUST = """
[bodies.shaft]
kind = "rigid"
mass = 20.0
inertia_tensor = [0.1, 0.1, 0.1]
position = [0, 4e-5, 0]
angular_velocity = [0, 300, 0]
surfaces = { collar = { kind = "plane", origin = [0, 0, 0], outward = [0, -1, 0] } }

[thrust_bearings.t]
runner = "shaft.collar"
pads = { kind = "pads", count = 3, arc = 1.3, offset = 0.6 }
inner_radius = 0.04
outer_radius = 0.08
oil = { kind = "iso_vg", grade = 32, temperature = 50, heat_capacity = 2000 }
temperature = { kind = "film_temperature", supply = 40 }
tilting = { kind = "tilting_pads", thickness = 0.015 }

[sensors.pad]
kind = "position"
port = "t pad 2.pivot"
"""


def test_a_file_has_the_pads_of_a_thrust_bearing(tmp_path: Path) -> None:
    scene = wf.Scene()
    collar = wf.surfaces.Plane(origin=(0, 0, 0), outward=(0, -1, 0))
    shaft = scene.add_rigid_body(
        20.0, (0.1,) * 3, name="shaft", position=(0, 4e-5, 0), angular_velocity=(0, 300, 0), surfaces={"collar": collar}
    )
    films = scene.add_thrust_bearing(
        "t", shaft["collar"], wf.films.pads(3, 1.3, offset=0.6), inner_radius=0.04, outer_radius=0.08,
        oil=wf.oils.iso_vg(32, temperature=50, heat_capacity=2000), tilting=wf.films.TiltingPads(0.015),
        temperature=wf.films.FilmTemperature(40),
    )  # fmt: skip
    scene.add(wf.sensors.Position(films[1].a.body["pivot"], name="pad"))
    loaded = load_scene(written(tmp_path, THRUST)).scene
    assert loaded.content_hash() == scene.content_hash()
    assert [film.temperature.upstream for film in loaded.films if film.temperature] == [f"t pad {n}" for n in (3, 1, 2)]
