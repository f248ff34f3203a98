"""What a contact pair accepts and refuses, rigid surfaces, and that all of it is part of what a scene is."""

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import pytest

from warpffrf.model import forces, surfaces
from warpffrf.model.contact import Contact
from warpffrf.model.errors import InputError
from warpffrf.model.friction import Coulomb, RegularisedCoulomb
from warpffrf.model.rigid_surface import RigidSurface
from warpffrf.model.scene import Scene

CUBE = (1.0, 1.0, 1.0)
WHEEL = surfaces.Cylinder(radius=0.05, axis_point=(0, 0, 0), axis_direction=(0, 1, 0))
FLOOR = surfaces.Plane(origin=(0, 0, 0), outward=(0, 0, 1))


def with_data(body, **data):
    """The body, its rim with tangential data or sampling points that only have to be there."""
    return replace(body, contact_surfaces={"rim": replace(body.contact_surfaces["rim"], **data)})


def machine(body) -> Scene:
    scene = Scene()
    scene.add_body(body, name="roller", position=(0, 0, 0.05))
    scene.add_body(body, name="other", position=(0, 0, 0.15))
    scene.add_rigid_body(1.0, CUBE, name="wheel", surfaces={"tread": WHEEL})
    scene.ground.surface(FLOOR, name="floor")
    return scene


def test_rigid_surfaces_are_named_like_flexible_ones(body_maker) -> None:
    scene = machine(body_maker())
    floor, tread = scene.ground["floor"], scene.body("wheel")["tread"]
    assert floor.rigid and tread.rigid and not scene.body("roller")["rim"].rigid
    assert (floor.label, tread.label) == ("ground['floor']", "wheel['tread']")
    assert isinstance(floor.surface, RigidSurface) and floor.surface.shape is FLOOR and floor.surface.grid is None
    flank = scene.body("wheel").surface(surfaces.Plane(origin=(0, 0.01, 0), outward=(0, 1, 0)), name="flank")
    assert flank.surface is scene.body("wheel")["flank"].surface


def test_rigid_surfaces_at_the_border(body_maker) -> None:
    scene = machine(body_maker())
    wheel = scene.body("wheel")
    with pytest.raises(InputError, match="body 'wheel': surface 'x' leaves something to be fitted"):
        wheel.surface(surfaces.Cylinder(radius=0.1), name="x")
    with pytest.raises(InputError, match="surface 'x' must be one of surfaces.Cylinder, .*surfaces.Cup"):
        wheel.surface("cylinder", name="x")  # pyright: ignore[reportArgumentType]
    with pytest.raises(InputError, match="ground: the name 'floor' of a surface is taken"):
        scene.ground.surface(FLOOR, name="floor")
    with pytest.raises(InputError, match="ground: the name of a surface must be a non-empty text"):
        scene.ground.surface(FLOOR, name="a/b")
    with pytest.raises(InputError, match="body 'roller' is flexible: name its surfaces in reduce"):
        scene.body("roller").surface(WHEEL, name="x")
    with pytest.raises(InputError, match="ground has no interface or surface 'wall'.*ground.surface"):
        _ = scene.ground["wall"]
    with pytest.raises(InputError, match="rigid body 'wheel' has no interface or surface 'rim'.*use .at.*surfaces="):
        _ = wheel["rim"]
    with pytest.raises(InputError, match="contact surface of a flexible body is needed"):
        forces.SurfaceLoad(wheel["tread"], 1e5)


def test_which_surfaces_make_a_pair(body_maker) -> None:
    scene = machine(body_maker())
    roller, wheel, ground = scene.body("roller"), scene.body("wheel"), scene.ground
    assert Contact(roller["rim"], wheel["tread"]).name == "roller-wheel"
    with pytest.raises(InputError, match=r"'wheel-ground'.*both rigid.*no pressure.*flexible body.*name it first"):
        Contact(wheel["tread"], ground["floor"])
    with pytest.raises(InputError, match=r"must be flexible, wheel\['tread'\] is rigid; name the flexible body first"):
        Contact(wheel["tread"], roller["rim"])
    with pytest.raises(InputError, match="in contact with itself"):
        Contact(roller["rim"], roller["rim"])
    # one surface may serve many pairs, rigid or flexible, but every pair only once
    scene.add(Contact(roller["rim"], ground["floor"], name="first"))
    scene.add(Contact(scene.body("other")["rim"], ground["floor"], name="second"))
    scene.add(Contact(roller["rim"], wheel["tread"], name="third"))
    with pytest.raises(InputError, match="are in contact already, as 'third'.*one contact covers all patches"):
        scene.add(Contact(roller["rim"], wheel["tread"], name="again"))


def test_friction(body_maker) -> None:
    plain = machine(body_maker())
    ready = machine(with_data(body_maker(), tangential=SimpleNamespace()))
    rim, floor = ready.body("roller")["rim"], ready.ground["floor"]
    assert Contact(rim, floor).friction == Coulomb(0.0)
    assert Contact(rim, floor, friction=0.3).friction == Coulomb(0.3)
    law = RegularisedCoulomb(0.3, slip_velocity=1e-3)
    assert Contact(rim, floor, friction=law).friction is law
    without = plain.body("roller")["rim"]
    assert Contact(without, plain.ground["floor"], friction=0.0).friction.static_coefficient == 0.0
    with pytest.raises(
        InputError,
        match="contact 'roller-ground': friction needs tangential modes, body 'roller' was reduced without them; "
        "reduce.*tangential=True",
    ):
        Contact(without, plain.ground["floor"], friction=0.1)
    mixed = Scene()
    a = mixed.add_body(with_data(body_maker(), tangential=SimpleNamespace()), name="a")
    b = mixed.add_body(body_maker(), name="b")
    with pytest.raises(InputError, match="body 'b' was reduced without them"):
        Contact(a["rim"], b["rim"], friction=0.1)
    for wrong in (-0.1, "rough", float("nan")):
        with pytest.raises(InputError, match="contact 'roller-ground': friction"):
            Contact(rim, floor, friction=wrong)  # pyright: ignore[reportArgumentType]


def test_evaluation_capacity_overlap(body_maker) -> None:
    scene = machine(body_maker())
    rim, floor = scene.body("roller")["rim"], scene.ground["floor"]
    assert Contact(rim, floor).quadrature == "full"
    with pytest.raises(InputError, match="quadrature 'best' does not exist; known: 'full', 'reduced'"):
        Contact(rim, floor, quadrature="best")  # pyright: ignore[reportArgumentType]
    with pytest.raises(InputError, match="'reduced' needs points chosen offline.*sampling_error=0.01"):
        Contact(rim, floor, quadrature="reduced")
    sampled = machine(with_data(body_maker(), sampling=SimpleNamespace()))
    assert Contact(sampled.body("roller")["rim"], sampled.ground["floor"], quadrature="reduced").quadrature == "reduced"
    wrong: list[tuple[str, Any]] = [("capacity", 0), ("overlap", -1e-6), ("overlap", float("inf"))]
    for name, value in wrong:
        with pytest.raises(InputError, match=f"contact 'roller-ground': {name}"):
            Contact(rim, floor, **{name: value})


def test_everything_that_matters_is_hashed(body_maker) -> None:
    body = with_data(body_maker(), tangential=SimpleNamespace(), sampling=SimpleNamespace())
    options: tuple[dict[str, Any], ...] = (
        {},
        {"friction": 0.2},
        {"quadrature": "reduced"},
        {"overlap": 1e-4},
        {"capacity": 60},
    )
    hashes = []
    for option in options:
        scene = machine(body)
        scene.add(Contact(scene.body("roller")["rim"], scene.ground["floor"], **option))
        hashes.append(scene.content_hash())
    scene = machine(body)
    scene.add(Contact(scene.body("roller")["rim"], scene.ground["floor"]))
    assert scene.content_hash() == hashes[0]
    scene.ground.surface(surfaces.Plane(origin=(0, 0, 1), outward=(0, 0, -1)), name="ceiling")
    hashes.append(scene.content_hash())
    scene.body("wheel").surface(FLOOR, name="flank")
    hashes.append(scene.content_hash())
    assert len(set(hashes)) == len(hashes)
