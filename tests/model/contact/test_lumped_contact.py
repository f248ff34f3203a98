"""Lumped contacts as they are described: laws, where surfaces are nearest, and refusals with their cures."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from references.closed_forms.elliptic import EllipticContact
from references.closed_forms.hertz import contact_modulus
from warpffrf.model import films, laws, surfaces
from warpffrf.model.bearings import BallGeometry, RollingContact
from warpffrf.model.bearings.parts import contact_of
from warpffrf.model.contact import Contact
from warpffrf.model.errors import InputError
from warpffrf.model.laws.lumped import LUMPED_LAWS, as_lumped_law
from warpffrf.model.laws.lumped.base import Meeting
from warpffrf.model.laws.lumped.hertz_point import iso_profile
from warpffrf.model.lumped_contact import LumpedContact, refuse_lumped_overlap
from warpffrf.model.material import Material
from warpffrf.model.reduced.body import ReducedBody
from warpffrf.model.scene import Scene

STEEL, BRASS = Material(210e9, 0.3, 7800.0), Material(100e9, 0.35, 8500.0)
ORIGIN, Y = (0.0, 0.0, 0.0), (0.0, 1.0, 0.0)
HERTZ = laws.HertzPoint(STEEL, STEEL)
EXAMPLES = {
    "hertz_point": HERTZ,
    "palmgren_line": laws.PalmgrenLine(0.01),
    "iso_lamina": laws.IsoLamina(0.01),
    "power_force": laws.PowerForce(1e9, 1.2),
    "tabulated_force": laws.TabulatedForce((-1e-6, 1e-6, 4e-6), (0.0, 10.0, 60.0)),
}


def scene_of(first: Any, second: Any, height: float) -> tuple[Scene, Any, Any]:
    """Two rigid bodies, the first one `height` [m] above the second."""
    scene = Scene()
    b = scene.add_rigid_body(1.0, (1e-3,) * 3, name="below", surfaces={"skin": second})
    a = scene.add_rigid_body(1.0, (1e-3,) * 3, name="above", position=(0, 0, height), surfaces={"skin": first})
    return scene, a["skin"], b["skin"]


def ball(radius: float = 0.01) -> Any:
    return surfaces.Sphere(radius=radius, axis_point=ORIGIN)


def roller(radius: float = 0.005) -> Any:
    return surfaces.Cylinder(radius=radius, axis_point=ORIGIN, axis_direction=Y)


def floor() -> Any:
    return surfaces.Plane(origin=ORIGIN, outward=(0, 0, 1))


def test_every_law_has_an_example_and_describes_itself() -> None:
    assert set(EXAMPLES) == set(LUMPED_LAWS)
    for law in EXAMPLES.values():
        assert as_lumped_law(law, "contact") is law
        assert law.describe()["kind"] == law.kind


@pytest.mark.parametrize("radii", [(0.01, 0.01), (0.01, 0.05), (0.006, 0.4)])
@pytest.mark.parametrize("other", [STEEL, BRASS, None])
def test_hertz_is_that_of_the_half_space(radii: tuple[float, float], other: Material | None) -> None:
    """Against the elliptic patch of an independent solution."""
    law = laws.HertzPoint(STEEL, other).approach(Meeting("contact", (1.0 / radii[1], 1.0 / radii[0]), 0.0))
    load = 250.0
    wanted = EllipticContact(load, radii[1], radii[0], contact_modulus(STEEL, other)).approach
    assert abs(law.stiffness * wanted**1.5 / load - 1.0) < 1e-12
    if other is STEEL:  # Mindlin: like materials
        assert abs(law.shear - 2.0 * (1.0 - 0.3) / (2.0 - 0.3)) < 1e-14


def test_palmgren_gives_his_approach_back() -> None:
    law = laws.PalmgrenLine(9.6e-3).approach(Meeting("contact", (0.0, 0.0), 0.005))
    F = law.stiffness * (3.84e-8 * 1956.0**0.9 / 9.6**0.8) ** law.exponent
    assert abs(F - 1956.0) < 1e-9


def test_profile_of_the_standard() -> None:
    """Zero in the middle, the same from both sides, and for long rollers flat up to 2.5 diameters from the ends."""
    x = np.linspace(-0.0049, 0.0049, 9)
    short = iso_profile(x, 0.01, 0.01)
    assert short[4] == 0.0
    np.testing.assert_allclose(short, short[::-1], rtol=1e-12)
    assert abs(short[0] - 0.00035 * 0.01 * np.log(1.0 / (1.0 - 0.98**2))) < 1e-18
    long = iso_profile(np.array([0.0, 0.002, 0.014]), 0.03, 0.01)
    assert np.all(long[:2] == 0.0)
    assert abs(long[2] - 0.0005 * 0.01 * np.log(1.0 / (1.0 - ((0.028 - 0.005) / 0.025) ** 2))) < 1e-18


def test_nearest_places() -> None:
    scene, a, b = scene_of(ball(), floor(), 0.0103)
    found = scene.add(LumpedContact(a, b, law=HERTZ)).nearest()
    assert abs(found.gap - 3e-4) < 1e-15
    np.testing.assert_allclose(found.place, (0.0, 0.0, 1.5e-4), atol=1e-12)
    np.testing.assert_allclose(found.curvatures, (100.0, 100.0), rtol=1e-12)
    groove = surfaces.Groove(radius=0.026, groove_radius=0.0066, axis_point=ORIGIN, axis_direction=Y)
    scene, a, b = scene_of(ball(0.00635), groove, 0.026 + 0.00635)
    found = LumpedContact(a, b, law=HERTZ).nearest()
    wanted = sorted((1 / 0.00635 - 1 / 0.0066, 1 / 0.00635 + 1 / 0.026))
    np.testing.assert_allclose(found.curvatures, wanted, rtol=1e-9)
    scene, a, b = scene_of(roller(), roller(0.02), 0.0251)
    scene.bodies[1].rotation = np.array([0.0, 0.0, np.sin(np.pi / 8), np.cos(np.pi / 8)])  # crossed by 45 degrees
    found = LumpedContact(a, b, law=HERTZ).nearest()
    assert abs(found.gap - 1e-4) < 1e-12
    # Johnson 4.1: A + B = (1/R_1 + 1/R_2)/2, B - A = |..| with the angle between the axes
    sum_, cross = 200.0 + 50.0, np.sqrt(200.0**2 + 50.0**2 + 2.0 * 200.0 * 50.0 * np.cos(np.pi / 2))
    np.testing.assert_allclose(found.curvatures, (0.5 * (sum_ - cross), 0.5 * (sum_ + cross)), rtol=1e-9)


def test_check_shows_gaps_support_and_overlap() -> None:
    scene, a, b = scene_of(ball(), ball(), 0.0199)
    scene.add(LumpedContact(a, b, law=HERTZ, name="balls"))
    base = scene.ground.surface(floor(), name="floor")
    scene.add(LumpedContact(b, base, law=HERTZ, overlap=0.02, name="base"))
    check = scene.check()
    assert abs(check.gaps["balls"] + 1e-4) < 1e-12
    assert check.unsupported == ()
    assert len(check.overlaps) == 0
    refuse_lumped_overlap(scene.lumped_contacts)
    scene.bodies[1].position = (0.0, 0.0, 0.0195)
    assert "balls" in str(scene.check())
    with pytest.raises(InputError, match=r"'balls'.*overlap at the start by 0.0005 m.*overlap=0.00053"):
        refuse_lumped_overlap(scene.lumped_contacts)


def test_scenes_without_keep_their_hash_and_those_with_have_another() -> None:
    hashes = []
    for law in (HERTZ, laws.HertzPoint(STEEL, BRASS), None):
        scene, a, b = scene_of(ball(), floor(), 0.01)
        if law is not None:
            scene.add(LumpedContact(a, b, law=law))
        hashes.append(scene.content_hash())
    assert len(set(hashes)) == 3


def test_flexible_partners_are_refused(body_maker: Callable[..., ReducedBody]) -> None:
    scene = Scene()
    soft = scene.add_body(body_maker(), name="soft")
    hard = scene.add_rigid_body(1.0, (1e-3,) * 3, name="hard", surfaces={"skin": ball()})
    for pair in ((soft["rim"], hard["skin"]), (hard["skin"], soft["rim"])):
        with pytest.raises(InputError, match=r"lumped contact .*soft\['rim'\].* flexible .*use Contact\("):
            LumpedContact(*pair, law=HERTZ)


def test_two_rigid_surfaces_are_referred_to_lumped_contacts() -> None:
    _, a, b = scene_of(ball(), floor(), 0.01)
    with pytest.raises(InputError, match=r"both rigid.*LumpedContact\(above\['skin'\], below\['skin'\]"):
        Contact(a, b)


@pytest.mark.parametrize(
    ("first", "second", "law", "message"),
    [
        (floor, floor, HERTZ, "both planes"),
        (
            floor,
            roller,
            laws.PalmgrenLine(0.01),
            r"outside of a roller.*LumpedContact\(below\['skin'\], above\['skin'\]",
        ),
        (ball, floor, laws.LinearLayer(1e9), r"law must be one of laws.HertzPoint"),
        (ball, floor, 3.0, "law must be one of"),
    ],
)
def test_what_a_law_does_not_hold_for(first: Any, second: Any, law: Any, message: str) -> None:
    _, a, b = scene_of(first(), second(), 0.01)
    with pytest.raises(InputError, match=message):
        LumpedContact(a, b, law=law)


def test_what_a_pose_does_not_allow() -> None:
    _, a, b = scene_of(roller(), floor(), 0.005)
    contact = LumpedContact(a, b, law=HERTZ)
    with pytest.raises(InputError, match=r"touch along a line.*laws.PalmgrenLine"):
        contact.approach()
    cup = surfaces.Cup(radius=0.009, axis_point=ORIGIN, axis_direction=Y)
    _, a, b = scene_of(ball(), cup, -0.001)
    with pytest.raises(InputError, match="is too conformal to"):
        LumpedContact(a, b, law=HERTZ).approach()


def test_a_pair_is_named_once() -> None:
    scene, a, b = scene_of(ball(), floor(), 0.01)
    scene.add(LumpedContact(a, b, law=HERTZ, name="one"))
    with pytest.raises(InputError, match="in contact already"):
        scene.add(LumpedContact(b, a, law=HERTZ, name="two"))
    assert scene.lumped_contact("one").friction.static_coefficient == 0.0
    with pytest.raises(InputError, match="'one'"):
        scene.lumped_contact("other")
    with pytest.raises(InputError, match="contact with itself"):
        LumpedContact(a, a, law=HERTZ)
    with pytest.raises(InputError, match="first surface must be a surface"):
        LumpedContact(scene.bodies[0].at(ORIGIN), b, law=HERTZ)  # pyright: ignore[reportArgumentType]


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (
            lambda: laws.TabulatedForce((0.0, 1.0, 0.5), (0.0, 1.0, 2.0)),
            "approaches must rise strictly, got 1 and then 0.5",
        ),
        (lambda: laws.TabulatedForce((0.0, 1.0), (0.0, -1.0)), "forces must rise strictly"),
        (lambda: laws.TabulatedForce((0.0, 1.0), (1.0, 2.0)), "first force must be 0"),
        (lambda: laws.TabulatedForce((0.0,), (0.0,)), "two at least"),
        (lambda: laws.PowerForce(1e9, 0.5), "at least 1"),
        (lambda: laws.PowerForce(-1.0), "stiffness"),
        (lambda: laws.HertzPoint(210e9, STEEL), "material_a must be a Material"),  # pyright: ignore[reportArgumentType]
        (lambda: laws.HertzPoint(STEEL, restitution=0.5), "belong together"),
        (lambda: laws.HertzPoint(STEEL, restitution=1.5, impact_speed=1.0), "at most 1"),
        (lambda: laws.PalmgrenLine(0.01, 0), "laminae"),
        (lambda: laws.IsoLamina(0.0), "length"),
        (lambda: laws.PowerForce(1e9, damping=-1.0), "damping"),
    ],
)
def test_bad_numbers_are_refused(make: Any, message: str) -> None:
    with pytest.raises(InputError, match=message):
        make()


def test_a_contact_states_where_a_lumped_law_belongs(body_maker: Callable[..., ReducedBody]) -> None:
    scene = Scene()
    soft = scene.add_body(body_maker(), name="soft")
    hard = scene.add_rigid_body(1.0, (1e-3,) * 3, name="hard", surfaces={"skin": ball()})
    with pytest.raises(InputError, match=r"laws.HertzPoint gives a force.*LumpedContact"):
        Contact(soft["rim"], hard["skin"], law=HERTZ)  # pyright: ignore[reportArgumentType]


def test_what_only_lumped_contacts_see_is_refused_by_a_contact(body_maker: Callable[..., ReducedBody]) -> None:
    """A form deviation, and a cone that is nearly a disc, of the rigid partner; rolling resistance of a bearing whose
    ring is flexible."""
    scene = Scene()
    soft = scene.add_body(body_maker(), name="soft")
    hard = scene.add_rigid_body(1.0, (1e-3,) * 3, name="hard")
    about: dict[str, Any] = {"axis_point": ORIGIN, "axis_direction": Y}
    wavy = hard.surface(surfaces.Cylinder(radius=0.01, **about), name="wavy", form=films.LobedForm(1e-6, 3))
    with pytest.raises(InputError, match=r"hard\['wavy'\] has a form deviation, which only lumped contacts support"):
        Contact(soft["rim"], wavy)
    disc = hard.surface(surfaces.Cone(radius=0.01, half_angle=1.55, **about), name="disc")
    with pytest.raises(InputError, match=r"hard\['disc'\] is a cone too flat for distributed contact"):
        Contact(soft["rim"], disc)
    losses = RollingContact(rolling_resistance=laws.RollingResistanceArm(1e-5, 1.0))
    with pytest.raises(InputError, match=r"soft\['rim'\] is flexible, and distributed contact has no rolling_res"):
        contact_of(hard.surface(ball(), name="skin"), soft["rim"], HERTZ, losses, "pair")


@pytest.mark.parametrize("grooves", [((9, 12.7e-3, 65e-3), 0.0), ((16, 22.23e-3, 125.3e-3), np.radians(40.0))])
def test_hertz_stiffness_hardly_changes_with_the_contact_angle(grooves: Any) -> None:
    """It stays that of the initial pose: within 4e-3 of that at 10 degrees more or less, of a 209 and a 218 bearing,
    and the other way round on the other ring."""
    (count, D, pitch), angle = grooves
    geometry = BallGeometry(
        elements=count, ball_diameter=D, pitch_diameter=pitch, osculation=0.5232, contact_angle=angle
    )

    def stiffness(side: str, at: float) -> float:
        small, large = sorted(float(c) for c in geometry.curvatures(side, at))
        return HERTZ.approach(Meeting("pair", (small, large), 0.0)).stiffness

    for turn in (-np.radians(10.0), np.radians(10.0)):
        inner, outer = (stiffness(side, angle + turn) / stiffness(side, angle) - 1.0 for side in ("inner", "outer"))
        assert max(abs(inner), abs(outer)) < 4e-3 and inner * outer < 0.0
