"""Contact surfaces and contact pairs in scene files: every kind of surface, rigid ones, and the options of a pair."""

from __future__ import annotations

import re

import numpy as np
import pytest

import warpffrf as wf
from warpffrf.model.friction import RegularisedCoulomb
from warpffrf.scene_file.load import load_scene, scene_of

MACHINE = """\
[materials.steel]
youngs_modulus = 210e9
poisson_ratio = 0.3
density = 7850

[meshes.roller]
kind = "roller"
outer_radius = 0.05
inner_radius = 0.015
width = 0.02
sectors = 24
layers = 1
axial = 2
order = 1

[reduced_bodies.roller]
mesh = "roller"
material = "steel"
contact = { rim = "cylinder" }
modes = 0
tangential = true
sampling_error = 0.5
cache = false

[ground.floor]
kind = "plane"
origin = [0, 0, 0]
outward = [0, 0, 1]

[bodies.roller]
body = "roller"
position = [0, 0, 0.05]

[bodies.wheel]
mass = 1.0
inertia_tensor = [1, 1, 1]
position = [0, 0, 0.15]
surfaces = { tread = { kind = "crowned_cylinder", radius = 0.05, crown_radius = 0.3, axis_point = [0, 0, 0], \
axis_direction = [0, 1, 0] } }

[contacts.below]
a = "roller.rim"
b = "ground.floor"
law = { kind = "linear_layer", stiffness = 1e13 }
friction = { kind = "regularised_coulomb", coefficient = 0.3, slip_velocity = 1e-3 }
quadrature = "reduced"
overlap = 1e-5
capacity = 200

[[arrange]]
kind = "close_gap"
contact = "below"
along = [0, 0, -1]
gap = 1e-6
"""
KINDS = {
    "cylinder": 'kind = "cylinder", radius = 0.05',
    "crowned_cylinder": 'kind = "crowned_cylinder", radius = 0.05, crown_radius = 0.3',
    "profiled_cylinder": (
        'kind = "profiled_cylinder", radius = 0.05, table = [[-0.01, 0, 0.01], [2e-5, 0, 2e-5]]'
    ),
    "groove": 'kind = "groove", radius = 0.03, groove_radius = 0.01',
    "sphere": 'kind = "sphere", radius = 0.01',
    "cone": 'kind = "cone", radius = 0.05, half_angle = "= radians(20)"',
    "bore": 'kind = "bore", radius = 0.05',
    "ring": 'kind = "ring", radius = 0.05, groove_radius = 0.01',
    "cup": 'kind = "cup", radius = 0.01',
    "conical_bore": 'kind = "conical_bore", radius = 0.05, half_angle = -0.1',
    "extruded": (
        'kind = "extruded", curve = { kind = "cam", base_radius = 0.02, roller_radius = 0.008, '
        'lift = { kind = "table", times = [0, 1, 2, 3, 6.2831853], values = [0, 2e-3, 2e-3, 0, 0], cubic = true } }'
    ),
    "plane": 'kind = "plane", origin = [0, 0, 1], outward = [0, 0, -1]',
    "mesh_surface": 'kind = "mesh_surface", mesh = "block", facet_set = "z_max"',
}  # fmt: skip


def wheel_with(surface: str) -> str:
    return (
        '[meshes.block]\nkind = "box"\nsize = [0.02, 0.02, 0.01]\ncounts = [5, 5, 2]\n'
        "[bodies.wheel]\nmass = 1.0\ninertia_tensor = [1, 1, 1]\n"
        f"surfaces = {{ face = {{ {surface} }} }}\n[ground.face]\n" + "\n".join(_lines(surface)) + "\n"
    )


def _lines(surface: str) -> list[str]:
    """Its keys, one a line; tables within it stay whole."""
    found: list[str] = []
    for part in re.split(r",\s*(?=\w+ =)", surface):
        if found and found[-1].count("{") > found[-1].count("}"):
            found[-1] += f", {part}"
        else:
            found.append(part.strip())
    return found


def test_every_kind_of_surface_can_be_written() -> None:
    assert set(KINDS) == set(wf.surfaces.SHAPES)
    for kind, text in KINDS.items():
        if kind not in ("plane", "mesh_surface"):
            text += ", axis_point = [0, 0, 0], axis_direction = [0, 1, 0]"
        scene = scene_of(wheel_with(text)).scene
        shape = scene.ground["face"].surface.shape
        assert shape.kind == kind and shape.resolved
        assert scene.body("wheel")["face"].surface.shape.describe() == shape.describe()
    cone = wf.surfaces.Cone(radius=0.05, half_angle=np.radians(20.0), axis_point=(0, 0, 0), axis_direction=(0, 1, 0))
    text = KINDS["cone"] + ", axis_point = [0, 0, 0], axis_direction = [0, 1, 0]"
    assert scene_of(wheel_with(text)).scene.ground["face"].surface.shape.describe() == cone.describe()


def test_a_profile_comes_from_a_file(tmp_path) -> None:
    z = np.linspace(-0.01, 0.01, 11)
    np.savetxt(tmp_path / "profile.csv", np.stack([z, 0.1 * z**2], axis=1), delimiter=",", fmt="%.17g")
    text = (
        '[ground.face]\nkind = "profiled_cylinder"\nradius = 0.05\naxis_point = [0, 0, 0]\naxis_direction = [0, 1, 0]\n'
        'table = [{ file = "profile.csv", column = 0 }, { file = "profile.csv", column = 1 }]\n'
    )
    (tmp_path / "scene.toml").write_text(text, encoding="utf-8")
    shape = load_scene(tmp_path / "scene.toml").scene.ground["face"].surface.shape
    np.testing.assert_allclose(shape.radius_at(z), 0.05 - 0.1 * z**2, rtol=1e-15)


def test_a_pair_with_its_options_is_that_of_python() -> None:
    loaded = scene_of(MACHINE)
    pair = loaded.scene.contact("below")
    assert pair.friction == RegularisedCoulomb(0.3, slip_velocity=1e-3) and pair.law.kind == "linear_layer"
    assert (pair.quadrature, pair.overlap, pair.capacity) == ("reduced", 1e-5, 200)
    assert loaded.scene.body("roller").position[2] == pytest.approx(0.050001, abs=1e-11)
    scene = wf.Scene()
    floor = scene.ground.surface(wf.surfaces.Plane(origin=(0, 0, 0), outward=(0, 0, 1)), name="floor")
    roller = scene.add_body(loaded.scene.body("roller").reduced, name="roller", position=(0, 0, 0.05))
    tread = wf.surfaces.CrownedCylinder(radius=0.05, crown_radius=0.3, axis_point=(0, 0, 0), axis_direction=(0, 1, 0))
    scene.add_rigid_body(1.0, (1, 1, 1), name="wheel", position=(0, 0, 0.15), surfaces={"tread": tread})
    law, friction = wf.laws.LinearLayer(1e13), RegularisedCoulomb(0.3, slip_velocity=1e-3)
    options = {"quadrature": "reduced", "overlap": 1e-5, "capacity": 200, "name": "below"}
    scene.close_gap(scene.add(wf.Contact(roller["rim"], floor, law=law, friction=friction, **options)),
                    along=(0, 0, -1), gap=1e-6)  # fmt: skip
    assert loaded.scene.content_hash() == scene.content_hash()


STRIBECK = 'kind = "stribeck", static = 0.4, kinetic = 0.2, decay_velocity = 0.1, exponent = 1'
TABLE = 'kind = "tabulated_friction", speeds = [0, 0.1], coefficients = [0.4, 0.2]'
FALLING = {
    STRIBECK: wf.laws.Stribeck(0.4, 0.2, 0.1, exponent=1.0),
    TABLE: wf.laws.TabulatedFriction((0.0, 0.1), (0.4, 0.2)),
}


@pytest.mark.parametrize("table", list(FALLING))
def test_friction_that_depends_on_speed(table: str) -> None:
    found = scene_of(MACHINE.replace(FRICTION, f"friction = {{ {table} }}")).scene.contacts[0].friction
    assert found == FALLING[table]


FRICTION = 'friction = { kind = "regularised_coulomb", coefficient = 0.3, slip_velocity = 1e-3 }'
WRONG = [
    ('kind = "plane"', 'kind = "plan"', "there is no kind 'plan'; did you mean 'plane'?"),
    ("outward = [0, 0, 1]", "normal = [0, 0, 1]", "unknown key 'normal'"),
    ("outward = [0, 0, 1]", "outward = [0, 0, 0]", "outward has zero length"),
    ('b = "ground.floor"', 'b = "ground.wall"', "the ground has no surface 'wall'; known: 'floor'"),
    ('b = "ground.floor"', 'b = "ground.flor"', "no surface 'flor'; did you mean 'floor'? known: 'floor'; a table"),
    ('b = "ground.floor"', 'b = "wheel.flank"', "rigid body 'wheel' has no interface or surface 'flank'"),
    ("coefficient = 0.3", "coefficient = -0.3", "coefficient must not be negative"),
    ('"regularised_coulomb"', '"rough"', "there is no kind 'rough'; known: 'coulomb', 'regularised_coulomb'"),
    ('"regularised_coulomb", c', '"linear_layer", c', "there is no kind 'linear_layer'; known: 'coulomb', 'reg"),
    ('kind = "linear_layer"', 'kind = "coulomb"', "there is no kind 'coulomb'; known: 'unilateral', 'linear_layer'"),
    (FRICTION, 'friction = "high"', "friction must be a number or a table {kind = ...}, kind one of 'coulomb'"),
    (FRICTION, "friction = { coefficient = 0.3 }", "friction must be a number or a table {kind = ...}, kind one of"),
    (FRICTION, "friction = true", "friction must be a coefficient or one of"),
    ('law = { kind = "linear_layer", stiffness = 1e13 }', 'law = "linear_layer"', "law must be a table {kind = ...}"),
    ('kind = "crowned_cylinder"', 'kind = "coulomb"', "there is no kind 'coulomb'; known: 'cylinder', 'crowned_cyl"),
    ('quadrature = "reduced"', 'quadrature = "best"', "quadrature 'best' does not exist"),
    ("overlap = 1e-5", "overlap = -1e-5", "overlap must not be negative"),
    ('a = "roller.rim"', 'a = "wheel.tread"', "both rigid"),
    ('contact = { rim = "cylinder" }', 'contact = { rim = "cilinder" }', "no surface 'cilinder'; did you mean"),
]  # fmt: skip


@pytest.mark.parametrize("old, new, said", WRONG, ids=[f"{w[1][:20]}: {w[2][:30]}" for w in WRONG])
def test_errors_name_the_line_and_the_cure(old: str, new: str, said: str) -> None:
    text = MACHINE.replace(old, new, 1)
    line = text[: text.index(new)].count("\n") + 1
    with pytest.raises(wf.InputError, match=re.escape(said)) as caught:
        scene_of(text)
    assert str(caught.value).startswith(f"scene.toml:{line}: "), caught.value


@pytest.mark.parametrize(
    "curve",
    [
        '{ kind = "through", points = [[0.05, 0], [0, 0.04], [-0.05, 0], [0, -0.04]], closed = true }',
        '{ kind = "arcs", start = [0, 0], heading = 0.1, pieces = [[0.02, inf], [0.01, 0.05]] }',
    ],
)
def test_curves_of_extruded_surfaces(curve: str) -> None:
    text = f'[ground.face]\nkind = "extruded"\naxis_direction = [1, 0, 0]\ncurve = {curve}\n'
    shape = scene_of(text).scene.ground["face"].surface.shape
    known = (
        wf.surfaces.Curve.through([[0.05, 0.0], [0.0, 0.04], [-0.05, 0.0], [0.0, -0.04]], closed=True)
        if "through" in curve
        else wf.surfaces.Curve.arcs((0.0, 0.0), 0.1, [(0.02, np.inf), (0.01, 0.05)])
    )
    assert shape.curve.describe() == known.describe()


def test_gears() -> None:
    """A flank and a section as curves of extruded surfaces, meshes of a gear and a cam."""
    numbers = "module = 4.5e-3, teeth = 16, profile_shift = 0.18, tip_rounding = 2e-4"
    text = f"""
        [meshes.pinion]
        kind = "gear"
        gear = {{ kind = "gear", {numbers} }}
        width = 14e-3
        rim_radius = 15e-3
        teeth = 2
        order = 1
        [meshes.disc]
        kind = "cam"
        curve = {{ kind = "through", points = [[0.05, 0], [0, 0.04], [-0.05, 0], [0, -0.04]], closed = true }}
        width = 0.01
        bore_radius = 0.01
        sectors = 24
        axial = 1
        order = 1
        [ground.flank]
        kind = "extruded"
        curve = {{ kind = "gear_flank", {numbers}, side = "left", tooth = 3 }}
        [ground.wheel]
        kind = "extruded"
        curve = {{ kind = "gear_section", {numbers} }}
        """
    loaded = scene_of(text)
    gear = wf.gears.Gear(4.5e-3, 16, profile_shift=0.18, tip_rounding=2e-4)
    for name, curve in (("flank", gear.flank("left", 3)), ("wheel", gear.section())):
        assert loaded.scene.ground[name].surface.shape.curve.describe() == curve.describe()
    known = wf.mesh.gear(gear, 14e-3, rim_radius=15e-3, teeth=2, order=1)
    assert loaded.made["meshes"]["pinion"].content_hash() == known.content_hash()
    assert loaded.made["meshes"]["disc"].sets["rim"] == 24
    with pytest.raises(wf.InputError, match="scene.toml:4: .* 16 teeth with profile_shift -0.5 .* are undercut"):
        scene_of(text.replace("profile_shift = 0.18", "profile_shift = -0.5"))


def test_facet_sets_of_meshes() -> None:
    """Facets of a generated mesh by a box, and parameters that are tables."""
    text = """
        [parameters]
        tooth = { kind = "gear", module = 4.5e-3, teeth = 16, profile_shift = 0.18 }
        [meshes.shaft]
        kind = "roller"
        outer_radius = 0.02
        inner_radius = 0.0
        width = 0.1
        sectors = 8
        layers = 1
        axial = 10
        order = 1
        sets = { seat = { from_set = "rim", low = [-inf, 0.02, -inf] } }
        [meshes.pinion]
        kind = "gear"
        gear = "= tooth"
        width = 14e-3
        rim_radius = 15e-3
        teeth = 2
        order = 1
        """
    made = scene_of(text).made["meshes"]
    assert made["shaft"].sets["seat"] == 3 * 8
    gear = wf.gears.Gear(4.5e-3, 16, profile_shift=0.18)
    known = wf.mesh.gear(gear, 14e-3, rim_radius=15e-3, teeth=2, order=1)
    assert made["pinion"].content_hash() == known.content_hash()
    with pytest.raises(wf.InputError, match="scene.toml.*: sets: 'seat' must be a table with low, high, from_set"):
        scene_of(text.replace("from_set =", "of ="))
    with pytest.raises(wf.InputError, match="scene.toml.*select 'seat': the centre of no facet of 'rim' lies in"):
        scene_of(text.replace("0.02, -inf]", "0.2, -inf]"))
