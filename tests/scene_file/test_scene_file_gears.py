"""Gear pairs in scene files: the same scene as from Python, and refusals with their line."""

from __future__ import annotations

from dataclasses import asdict
from pathlib import Path

import pytest

import warpffrf as wf
from scenes.gears import FZG, helical, on_shafts
from warpffrf.model.errors import InputError
from warpffrf.scene_file import load_scene

GEARS = [
    "{ kind = 'gear', module = 4.5e-3, teeth = 16, profile_shift = 0.1817, tip_diameter = 82.45e-3, "
    "thickness_allowance = -50e-6 }",
    "{ kind = 'gear', module = 4.5e-3, teeth = 24, profile_shift = 0.1715, tip_diameter = 118.35e-3, "
    "thickness_allowance = -50e-6 }",
]
BODY = """
[reduced_bodies.NAME]
kind = "half_space"
mass = 1.0
inertia_tensor = [1e-3, 1e-3, 1e-3]
material = "steel"
extent = [-7e-3, 7e-3]
contact = { kind = "gear_surfaces", sides = ["right"], gear = GEAR }

[bodies.NAME]
body = "NAME"
"""
REST = """
[materials.steel]
youngs_modulus = 206e9
poisson_ratio = 0.3
density = 7850

[gear_pairs.mesh]
gear_1 = "pinion.center"
gear_2 = "wheel.center"
direction = [1, 0, 0]
rotation = [0, 0]
[gear_pairs.mesh.pair]
kind = "gear_pair"
gear_1 = GEAR_1
gear_2 = GEAR_2
center_distance = 91.5e-3

[joints.shaft_1]
kind = "revolute"
a = "ground"
b = "pinion.center"
axis = [0, 1, 0]

[joints.shaft_2]
kind = "fixed"
a = "ground"
b = "wheel.center"

[forces.torque]
kind = "point_torque"
port = "pinion.center"
torque = [0, -200, 0]
"""


def text() -> str:
    bodies = [
        BODY.replace("NAME", name).replace("GEAR", gear) for name, gear in zip(("pinion", "wheel"), GEARS, strict=True)
    ]
    return "".join(bodies) + REST.replace("GEAR_1", GEARS[0]).replace("GEAR_2", GEARS[1])


def test_the_same_scene_as_from_python(tmp_path: Path) -> None:
    file = tmp_path / "gears.toml"
    file.write_text(text())
    loaded, known = load_scene(file).scene, on_shafts(FZG, 0.0, 200.0)
    (read,), (made,) = loaded.gears, known.gears
    assert read.describe() == made.describe()
    assert asdict(read.pair.gear_1) == asdict(FZG.gear_1)
    assert [contact.name for contact in loaded.contacts] == [contact.name for contact in known.contacts]
    assert loaded.bodies[1].position == pytest.approx(known.bodies[1].position)


def test_helical_gears(tmp_path: Path) -> None:
    """Both hands, as from Python; one hand in both is named."""
    file, degrees = tmp_path / "gears.toml", 12.0
    pair = helical(degrees)
    said = text().replace("center_distance = 91.5e-3", f"center_distance = {pair.center_distance!r}")
    for gear, known in zip(GEARS, (pair.gear_1, pair.gear_2), strict=True):
        made = f"{{ kind = 'gear', module = 4e-3, teeth = {known.teeth}, thickness_allowance = -50e-6, "
        said = said.replace(gear, f"{made}helix_angle = {known.helix_angle!r} }}")
    file.write_text(said)
    loaded, known = load_scene(file).scene, on_shafts(pair, 0.0, 200.0)
    assert loaded.gears[0].describe() == known.gears[0].describe()
    assert loaded.bodies[0]["flank_right_1"].surface.shape.twist == pytest.approx(pair.gear_1.twist)
    file.write_text(said.replace(repr(pair.gear_2.helix_angle), repr(pair.gear_1.helix_angle)))
    with pytest.raises(InputError, match="two external gears need opposite hands"):
        load_scene(file)


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ('gear_2 = "wheel.center"', 'gear_2 = "wheel.bore"', "'bore' does not exist"),
        ('kind = "gear_pair"', 'kind = "gear_pairs"', "there is no kind 'gear_pairs'"),
        ("center_distance = 91.5e-3", "center_distance = 0.2", "center_distance"),
        ("direction = [1, 0, 0]", "direction = [0, 1, 0]", "must not be along the axis of gear_1"),
        ("rotation = [0, 0]", "rotations = [0, 0]", "unknown key 'rotations'"),
        ('kind = "gear_surfaces", sides', 'kind = "cylinder", sides', "there is no kind 'cylinder'"),
    ],
)
def test_what_is_wrong_is_named(tmp_path: Path, old: str, new: str, said: str) -> None:
    file = tmp_path / "gears.toml"
    assert old in text()
    file.write_text(text().replace(old, new, 1))
    with pytest.raises(InputError, match=r"gears\.toml:\d+: .*") as caught:
        load_scene(file)
    assert said in str(caught.value)


def test_limits_of_all_surfaces() -> None:
    flanks = FZG.gear_1.surfaces(("right",), (1, 2))
    steel = wf.Material(206e9, 0.3, 7850.0)
    one, other = (
        wf.half_space_body(1.0, (1.0,) * 3, steel, contact=flanks, extent=extent)
        for extent in ((-7e-3, 7e-3), dict.fromkeys(flanks, (-7e-3, 7e-3)))
    )
    for name, surface in one.contact_surfaces.items():
        assert surface.grid.z == pytest.approx(other.contact_surfaces[name].grid.z)
