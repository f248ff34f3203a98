"""Small-sliding contacts in scene files: the same scene as from Python, and refusals with their line."""

from __future__ import annotations

from pathlib import Path

import pytest

import warpffrf as wf
from warpffrf.model import joints, laws, mesh
from warpffrf.model.errors import InputError
from warpffrf.model.small_sliding.sliding import cells_of
from warpffrf.scene_file import load_scene

TEXT = """
[materials.steel]
youngs_modulus = 210e9
poisson_ratio = 0.3
density = 7800

[meshes.block]
kind = "box"
size = [0.04, 0.02, 0.02]
counts = [4, 2, 2]
order = 1

[reduced_bodies.lower]
mesh = "block"
material = "steel"
interfaces = { z_min = "rigid" }
contact = { z_max = "matched" }
modes = 4
cache = false

[reduced_bodies.upper]
mesh = "block"
material = "steel"
interfaces = { z_max = "rigid" }
contact = { face = { kind = "matched", first = "z_min", size = 0.02 } }
modes = 4
cache = false

[bodies.lower]
body = "lower"
position = [0, 0, 0.01]

[bodies.upper]
body = "upper"
position = [0, 0, 0.03]

[joints.foot]
kind = "fixed"
a = "ground"
b = "lower.z_min"

[contacts.joint]
a = "upper.face"
b = "lower.z_max"
friction = 0.15
law = { kind = "linear_layer", stiffness = 1e14 }
sliding = { kind = "small_sliding", interference = 1e-6 }
"""


def written(folder: Path, text: str) -> Path:
    file = folder / "scene.toml"
    file.write_text(text)
    return file


def test_the_same_scene_as_from_python(tmp_path: Path) -> None:
    steel = wf.Material(210e9, 0.3, 7800.0, name="steel")
    block = mesh.box((0.04, 0.02, 0.02), (4, 2, 2), order=1)
    both = [
        wf.reduce(block, steel, interfaces={foot: "rigid"}, contact=face, modes=4, cache=False, progress=False)
        for foot, face in (
            ("z_min", {"z_max": wf.surfaces.Matched()}),
            ("z_max", {"face": wf.surfaces.Matched(first="z_min", size=0.02)}),
        )
    ]
    scene = wf.Scene()
    lower = scene.add_body(both[0], name="lower", position=(0, 0, 0.01))
    upper = scene.add_body(both[1], name="upper", position=(0, 0, 0.03))
    scene.add(joints.Fixed(scene.ground, lower["z_min"], name="foot"))
    layer = laws.LinearLayer(1e14)
    sliding = wf.SmallSliding(interference=1e-6)
    scene.add(wf.Contact(upper["face"], lower["z_max"], sliding=sliding, friction=0.15, law=layer, name="joint"))
    loaded = load_scene(written(tmp_path, TEXT)).scene
    assert loaded.content_hash() == scene.content_hash()
    assert loaded.contact("joint").friction.static_coefficient == 0.15
    assert len(cells_of(loaded.contact("joint")).area) < 8


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ('a = "upper.face"', 'a = "upper.z_max"', "the first surface, a, must be a face"),
        ("friction = 0.15", "frictions = 0.15", "did you mean 'friction'"),
        ('kind = "linear_layer", stiffness = 1e14', 'kind = "exponential_asperities", stiffness = 1', "law"),
        ("size = 0.02", "sice = 0.02", "did you mean 'size'"),
        ("friction = 0.15", 'friction = "much"', "friction must be a number or a table"),
        ('b = "lower.z_max"', 'b = "base.z_max"', "there is no body 'base'"),
        (
            'sliding = { kind = "small_sliding", interference = 1e-6 }',
            'sliding = "tiny"',
            "sliding must be 'finite', 'sm",
        ),
        ("interference = 1e-6", "interferences = 1e-6", "did you mean 'interference'"),
        ("interference = 1e-6 }", 'interference = 1e-6 }\ngrid = "body_fixed"', "grid is an option of finite sliding"),
    ],
)
def test_refusals_name_the_line(old: str, new: str, words: str, tmp_path: Path) -> None:
    assert TEXT.count(old) == 1
    text = TEXT.replace(old, new)
    line = 1 + TEXT[: TEXT.index(old)].count("\n")
    with pytest.raises(InputError, match=rf"scene.toml:{line}.*{words}"):
        load_scene(written(tmp_path, text))
