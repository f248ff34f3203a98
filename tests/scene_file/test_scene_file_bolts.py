"""Bolts in scene files: a cut mesh, a joint between two interfaces of one body, and pretension."""

from __future__ import annotations

import numpy as np
import pytest

from warpffrf.model.errors import InputError
from warpffrf.model.forces import Pretension
from warpffrf.scene_file.load import scene_of

BOLT = """\
[materials.steel]
youngs_modulus = 210e9
poisson_ratio = 0.3
density = 7800

[meshes.plate]
kind = "box"
size = [0.04, 0.04, 0.02]
counts = [8, 8, 2]

[meshes.cut]
kind = "cut"
mesh = "plate"
name = "slit"
point = [0, 0, 0]
normal = [0, 0, 1]
radius = 0.012

[reduced_bodies.plate]
mesh = "cut"
material = "steel"
interfaces = { slit_low = "average", slit_high = "average", x_min = "rigid" }
modes = 2
cache = false

[bodies.plate]
body = "plate"

[joints.section]
kind = "prismatic"
a = "plate.slit_low"
b = "plate.slit_high"
axis = [0, 0, 1]

[joints.foot]
kind = "fixed"
a = "ground"
b = "plate.x_min"

[forces.bolt]
kind = "pretension"
joint = "section"
preload = { kind = "smooth_step", start_value = 0, end_value = 500, duration = 1e-3 }
lock_at = 2e-3
"""


def test_a_bolt_from_a_scene_file() -> None:
    scene = scene_of(BOLT).scene
    (bolt,) = scene.forces
    assert isinstance(bolt, Pretension) and bolt.lock_at == 2e-3
    assert bolt.preload(2e-3) == 500.0
    joint = scene.joint("section")
    assert joint.a.body is joint.b.body
    np.testing.assert_allclose(joint.world_point(), 0.0, atol=1e-12)


@pytest.mark.parametrize(
    ("old", "new", "told"),
    [
        ('mesh = "plate"', 'mesh = "cut"', r"\[meshes.cut\] depends on itself"),
        ("point = [0, 0, 0]", "point = [0, 0, 4e-3]", r"scene.toml:\d+.*'slit': the plane goes through.*0.004 m off"),
        ('b = "plate.slit_high"', 'b = "plate.slit_low"', r"scene.toml:\d+.*take two interfaces"),
        ('kind = "prismatic"', 'kind = "revolute"', r"scene.toml:\d+.*leaves no length free; take a Prismatic joint"),
    ],
)  # fmt: skip
def test_refusals_name_the_line(old: str, new: str, told: str) -> None:
    assert old in BOLT
    with pytest.raises(InputError, match=told):
        scene_of(BOLT.replace(old, new))
