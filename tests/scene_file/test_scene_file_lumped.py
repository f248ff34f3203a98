"""Lumped contacts in scene files: the same scene as from Python, and refusals with their line."""

from __future__ import annotations

from pathlib import Path

import pytest

from warpffrf.model import laws, surfaces
from warpffrf.model.errors import InputError
from warpffrf.model.lumped_contact import LumpedContact
from warpffrf.model.material import Material
from warpffrf.model.scene import Scene
from warpffrf.scene_file import load_scene, run_scene

TEXT = """
[materials.steel]
youngs_modulus = 210e9
poisson_ratio = 0.3
density = 7800

[ground.floor]
kind = "plane"
origin = [0, 0, 0]
outward = [0, 0, 1]

[bodies.ball]
mass = 0.03
inertia_tensor = [1.2e-6, 1.2e-6, 1.2e-6]
position = [0, 0, 0.0101]
surfaces = { skin = { kind = "sphere", radius = 0.01, axis_point = [0, 0, 0] } }

[scene]
gravity = [0, 0, -9.81]

[lumped_contacts.landing]
a = "ball.skin"
b = "ground.floor"
law = { kind = "hertz_point", material_a = "steel", material_b = "steel", damping = 0.5 }
friction = { kind = "regularised_coulomb", coefficient = 0.2, slip_velocity = 1e-3 }
rolling_resistance = { kind = "rolling_hysteresis", loss = 0.02, rolling_speed = 0.1 }
spin = true

[simulate]
duration = 1e-3
step = 1e-4
"""


def written(folder: Path, text: str) -> Path:
    file = folder / "scene.toml"
    file.write_text(text)
    return file


def test_the_same_scene_as_from_python(tmp_path: Path) -> None:
    steel = Material(210e9, 0.3, 7800.0, name="steel")
    scene = Scene(gravity=(0, 0, -9.81))
    floor = scene.ground.surface(surfaces.Plane(origin=(0, 0, 0), outward=(0, 0, 1)), name="floor")
    skin = surfaces.Sphere(radius=0.01, axis_point=(0, 0, 0))
    ball = scene.add_rigid_body(0.03, (1.2e-6,) * 3, name="ball", position=(0, 0, 0.0101), surfaces={"skin": skin})
    law, friction = laws.HertzPoint(steel, steel, damping=0.5), laws.RegularisedCoulomb(0.2, 1e-3)
    resistance = laws.RollingHysteresis(0.02, 0.1)
    scene.add(
        LumpedContact(
            ball["skin"], floor, law=law, friction=friction, rolling_resistance=resistance, spin=True, name="landing"
        )
    )
    file = written(tmp_path, TEXT)
    assert load_scene(file).scene.content_hash() == scene.content_hash()
    result = run_scene(file, out=tmp_path, progress=False)["simulate"]
    assert result.status == "completed" and result.lumped_contact("landing").force.shape == (11, 3)


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ('kind = "hertz_point"', 'kind = "hertz_pint"', "hertz_point"),
        ('material_a = "steel"', 'material_a = "steal"', "steel"),
        (
            'kind = "hertz_point", material_a = "steel", material_b = "steel"',
            'kind = "linear_layer", stiffness = 1e9',
            "kind",
        ),
        (
            "rolling_resistance = { kind",
            "rolling_resistance = { kin",
            "a table {kind = ...}, kind one of 'rolling_resistance_arm'",
        ),
        ("loss = 0.02", "loss = 2.0", "loss must be at most 1"),
        ("coefficient = 0.2", "coefficient = -0.2", "coefficient"),
        ('b = "ground.floor"', 'b = "ground.flor"', "floor"),
    ],
)
def test_errors_name_the_line(tmp_path: Path, old: str, new: str, said: str) -> None:
    text = TEXT.replace(old, new)
    line = next(n for n, row in enumerate(text.splitlines(), start=1) if new in row)
    with pytest.raises(InputError, match=said) as caught:
        load_scene(written(tmp_path, text))
    assert f"scene.toml:{line}: " in str(caught.value)
