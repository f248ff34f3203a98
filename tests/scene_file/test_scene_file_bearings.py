"""Bearings in scene files: the same scene as from Python, their bodies by name, and refusals with their line."""

from __future__ import annotations

from pathlib import Path

import pytest

from warpffrf.examples import path
from warpffrf.model import films, forces, laws
from warpffrf.model.bearings import (
    BallGeometry,
    Flanges,
    PocketCage,
    PreloadForce,
    RollerGeometry,
    RollingContact,
    catalogue,
)
from warpffrf.model.errors import InputError
from warpffrf.model.material import Material
from warpffrf.model.scene import Scene
from warpffrf.scene_file import load_scene

BALL = """
[materials.steel]
youngs_modulus = 210e9
poisson_ratio = 0.3
density = 7800

[bodies.shaft]
mass = 1.0
inertia_tensor = [1e-3, 1e-3, 1e-3]

[bearings.a]
kind = "ball"
elements = 8
ball_diameter = 0.01
pitch_diameter = 0.05
osculation = [0.52, 0.53]
contact_angle = 0.4
axial_preload = { kind = "preload_force", force = 300.0 }
inner = "shaft"
cage = { kind = "pocket_cage", clearance = 2e-4 }
friction = { kind = "traction_curve", peak = 0.06, peak_velocity = 0.02, limit = 0.03, decay_velocity = 0.5 }
outer_form = { kind = "lobed_form", amplitude = 2e-6, count = 2 }
material = "steel"

[bearings.b]
kind = "roller"
elements = 10
roller_diameter = 0.008
roller_length = 0.01
pitch_diameter = 0.05
position = [0, 0.05, 0]
outer = "ground"
flanges = { kind = "flanges", clearance = 5e-5 }

[forces.load]
kind = "point_force"
port = { body = "b inner ring", point = [0, 0, 0] }
force = [0, 0, -100]
"""


def loaded(folder: Path, text: str) -> Scene:
    file = folder / "scene.toml"
    file.write_text(text)
    return load_scene(file).scene


def test_the_same_scene_as_from_python(tmp_path: Path) -> None:
    steel = Material(210e9, 0.3, 7800.0, name="steel")
    scene = Scene()
    shaft = scene.add_rigid_body(1.0, (1e-3,) * 3, name="shaft")
    scene.add_bearing(
        "a",
        BallGeometry(
            elements=8, ball_diameter=0.01, pitch_diameter=0.05, osculation=(0.52, 0.53), contact_angle=0.4,
            outer_form=films.LobedForm(2e-6, 2),
        ),
        axial_preload=PreloadForce(300.0), inner=shaft, cage=PocketCage(2e-4),
        contact=RollingContact(friction=laws.TractionCurve(0.06, 0.02, 0.03, 0.5)), materials=steel,
    )  # fmt: skip
    b = scene.add_bearing(
        "b", RollerGeometry(elements=10, roller_diameter=0.008, roller_length=0.01, pitch_diameter=0.05),
        position=(0, 0.05, 0), outer=scene.ground, flanges=Flanges(5e-5),
    )  # fmt: skip
    scene.add(forces.PointForce(b.inner.at((0, 0, 0)), (0, 0, -100), name="load"))
    read = loaded(tmp_path, BALL)
    assert read.content_hash() == scene.content_hash()
    assert [bearing.name for bearing in read.bearings] == ["a", "b"]


REFUSED = [
    ("elements = 10", "elements = 30", r"scene.toml:\d+: \[bearings.b\]: RollerGeometry: 30 elements .* overlap"),
    ('outer = "ground"', 'outer = "housing"', r"there is no body 'housing'"),
    ('"b inner ring"', '"b outer ring"', r"there is no body 'b outer ring'"),
    ('"pocket_cage"', '"pocket"', r"there is no kind 'pocket'; did you mean 'pocket_cage'"),
    ("clearance = 5e-5", "clearance = -5e-5", r"\[bearings.b.*Flanges: clearance"),
    ("roller_length = 0.01", "length = 0.01", r"\[bearings.b\]: unknown key 'length'"),
]


@pytest.mark.parametrize(("old", "new", "said"), REFUSED)
def test_what_is_wrong_is_named(tmp_path: Path, old: str, new: str, said: str) -> None:
    assert old in BALL
    with pytest.raises(InputError, match=said):
        loaded(tmp_path, BALL.replace(old, new))


def test_elements_of_a_reduced_body(tmp_path: Path) -> None:
    roller = """
[meshes.roller]
kind = "roller"
outer_radius = 0.004
inner_radius = 0.0
width = 0.01
sectors = 8
layers = 1
axial = 1
order = 1

[reduced_bodies.roller]
mesh = "roller"
material = "steel"
interfaces = { ends = "average" }
contact = { rim = { kind = "cylinder" } }
spacing = 0.01
"""
    text = BALL.replace('flanges = { kind = "flanges", clearance = 5e-5 }', 'element_body = "roller"')
    elements = loaded(tmp_path, text + roller).bearing("b").elements
    assert len({id(element.reduced) for element in elements}) == 1 and elements[0].reduced is not None
    some = text.replace('element_body = "roller"', 'element_body = "roller"\ndistributed = [3, 1]')
    with pytest.raises(InputError, match="has no far field.*reduce it with grid=ContactGrid"):
        loaded(tmp_path, some + roller)
    fine = roller.replace("spacing = 0.01", "contact_fixed = true").replace("order = 1", "order = 2")
    assert loaded(tmp_path, some + fine).bearing("b").distributed == (1, 3)
    by_load = some.replace("distributed = [3, 1]", 'distributed = "auto"\nload = [0, 0, -500.0]')
    found = loaded(tmp_path, by_load + fine).bearing("b")
    assert found.load == (0.0, 0.0, -500.0) and len(found.distributed or ()) == 4  # 18 and 54 deg from the load
    with pytest.raises(InputError, match=r"there is no 'rollers' in \[reduced_bodies\]; did you mean 'roller'"):
        loaded(tmp_path, text.replace('"roller"', '"rollers"').replace('kind = "rollers"', 'kind = "roller"') + roller)


FLEXIBLE_CAGE = """
[meshes.cage]
kind = "cage"
inner_radius = 0.023
outer_radius = 0.027
width = 0.014
pockets = 8
pocket_width = 0.0102
pocket_length = 0.0102
around = [1, 1]
axial = [1, 1]
order = 1

[reduced_bodies.cage]
mesh = "cage"
material = "steel"
interfaces = { ends = "average", %s }

[bodies.cage]
body = "cage"
"""


def test_a_flexible_cage(tmp_path: Path) -> None:
    walls = ", ".join(f'pocket_{i + 1} = "average"' for i in range(8))
    text = BALL.replace("clearance = 2e-4", 'clearance = 2e-4, body = "cage"') + FLEXIBLE_CAGE % walls
    scene = loaded(tmp_path, text)
    bearing = scene.bearing("a")
    assert bearing.cage is next(body for body in scene.bodies if body.name == "cage") and len(bearing.pockets) == 8
    with pytest.raises(InputError, match=r"\[bearings.a\].*cage' has no interface near"):
        loaded(tmp_path, text.replace('pocket_4 = "average"', 'bar_4 = "average"'))


MOUNTED = """
[materials.steel]
youngs_modulus = 210e9
poisson_ratio = 0.3
density = 7800

[meshes.arm]
kind = "box"
size = [0.02, 0.1, 0.02]
counts = [1, 2, 1]
order = 1

[reduced_bodies.arm]
mesh = "arm"
material = "steel"
interfaces = { y_min = "average", y_max = "rigid" }

[bodies.shaft]
body = "arm"

[bearings.a]
kind = "ball"
catalogue = "6208"
position = [0, -0.05, 0]
inner = "shaft.y_min"
outer = "ground"

[forces.load]
kind = "point_force"
port = "a inner ring"
force = [0, 0, -100]
"""


def test_rings_on_interfaces(tmp_path: Path) -> None:
    scene = loaded(tmp_path, MOUNTED)
    seat = scene.bearing("a").joints["inner_seat"]
    assert seat.a.label == "shaft['y_min']" and seat.b.body is scene.bearing("a").inner
    for old, new, said in (
        ("shaft.y_min", "shaft.seat", r"interface or contact surface 'seat'"),
        ("[0, -0.05, 0]", "[0, 0.05, 0]", r"\[bearings.a\]: bearing 'a': inner: shaft\['y_min'\] lies 0.1 m from"),
        ('"a inner ring"', '"a outer ring"', r"there is no body 'a outer ring'"),
    ):
        with pytest.raises(InputError, match=said):
            loaded(tmp_path, MOUNTED.replace(old, new))
    whole = MOUNTED.replace("shaft.y_min", "shaft").replace("a inner ring", "a ball 1")
    with pytest.raises(InputError, match=r"body 'shaft' is flexible; give one of its interfaces, .* body\['y_min'\]"):
        loaded(tmp_path, whole)


def test_the_example_is_read() -> None:
    scene = load_scene(path("ball-bearing") / "ball_bearing.toml").scene
    assert len(scene.bearing("main").elements) == 9


LISTED = """
[bearings.a]
kind = "ball"
catalogue = "6310"
clearance = 12e-6
outer = "ground"

[sensors.last]
kind = "position"
port = "a ball 8"
"""


def test_bearings_of_the_catalogue(tmp_path: Path) -> None:
    geometry = loaded(tmp_path, LISTED).bearing("a").geometry
    assert geometry == catalogue("6310", clearance=12e-6)
    for old, new, said in (
        ("6310", "6399", r"\[bearings.a\]: catalogue: '6399': the series 63 has no bore of 495 mm"),
        ("6310", "NU 2210", r"\[bearings.a\]: catalogue: 'NU 2210' is a RollerGeometry, not a BallGeometry"),
        ('catalogue = "6310"', "", r"\[bearings.a\]: the key 'elements' is missing; give it, or a designation"),
    ):
        with pytest.raises(InputError, match=said):
            loaded(tmp_path, LISTED.replace(old, new).replace("a ball 8", "a cage"))
