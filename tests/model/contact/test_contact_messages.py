"""What is said of contact input that cannot be used: the thing at fault, and a cure that works when it is followed."""

from __future__ import annotations

import re
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from warpffrf.model import laws, surfaces
from warpffrf.model.checks.contacts import refuse_overlap
from warpffrf.model.contact import Contact
from warpffrf.model.errors import InputError, require_number
from warpffrf.model.friction import Coulomb, as_friction
from warpffrf.model.placement.gap import smallest_gap
from warpffrf.model.scene import Scene

CUBE = (1.0, 1.0, 1.0)
FLOOR = surfaces.Plane(origin=(0, 0, 0), outward=(0, 0, 1))
PLACED: dict[str, Any] = {"axis_point": (0, 0, 0), "axis_direction": (0, 1, 0)}


def on_floor(body, height: float) -> tuple[Scene, Contact]:
    """A roller of radius 50 mm with its axis at `height` [m] over the ground."""
    scene = Scene()
    roller = scene.add_body(body, name="roller", position=(0, 0, height))
    return scene, scene.add(Contact(roller["rim"], scene.ground.surface(FLOOR, name="floor"), name="c"))


def named_direction(message: str) -> tuple[float, ...]:
    found = re.search(r"along=\(([^)]*)\)(?=\)| does)", message)
    assert found, message
    return tuple(float(x) for x in found[1].split(","))


def grid_points(shape, half_width: float, rows: int) -> np.ndarray:
    theta = np.linspace(0.0, 2.0 * np.pi, 60, endpoint=False)
    return shape.point(*np.meshgrid(theta, np.linspace(-half_width, half_width, rows))).reshape(-1, 3)


# --- who moves, and where to


def test_an_overlap_with_the_ground_is_cured_as_it_says(body_maker) -> None:
    scene, contact = on_floor(body_maker(), 0.045)
    with pytest.raises(InputError, match=r"more than the 0.0005 m that are allowed; move 'roller' with") as caught:
        refuse_overlap(scene)
    assert named_direction(str(caught.value)) == (0.0, 0.0, -1.0)
    scene.close_gap(contact, along=named_direction(str(caught.value)))
    assert scene.body("roller").position[2] == pytest.approx(0.05, abs=1e-12)
    refuse_overlap(scene)


def test_an_overlap_of_a_pin_in_a_bore_is_cured_as_it_says(body_maker) -> None:
    bore = surfaces.Bore(radius=0.0505, **PLACED)
    scene = Scene()
    pin = scene.add_body(body_maker(), name="pin", position=(0.0, 0.0, 0.003))
    housing = scene.add_rigid_body(1.0, CUBE, name="housing", surfaces={"bore": bore})
    contact = scene.add(Contact(pin["rim"], housing["bore"]))
    with pytest.raises(InputError, match="move 'housing' with scene.close_gap") as caught:
        refuse_overlap(scene)
    scene.close_gap(contact, along=named_direction(str(caught.value)))
    assert smallest_gap(contact)[0] == pytest.approx(0.0, abs=1e-12)
    refuse_overlap(scene)


def test_close_gap_names_the_body_that_moves_and_the_other_sign(body_maker) -> None:
    scene, contact = on_floor(body_maker(), 0.07)
    with pytest.raises(InputError, match="moving 'roller' against .*as the ground stays, never brings") as caught:
        scene.close_gap(contact, along=(0, 0, 1))
    scene.close_gap(contact, along=named_direction(str(caught.value)))
    assert scene.body("roller").position[2] == pytest.approx(0.05, abs=1e-12)
    with pytest.raises(InputError, match=r"along=\(1, 0, 0\).*choose a direction that points from the first"):
        scene.close_gap(contact, along=(1, 0, 0), gap=1e-3)


def test_scene_check_says_what_a_run_refuses(body_maker) -> None:
    scene, contact = on_floor(body_maker(), 0.045)
    assert len(scene.check().overlaps) == 1
    assert "overlap too much at the start: c (0.005 m, 0.0005 m are allowed); simulate refuses" in str(scene.check())
    contact.overlap = 0.006
    assert scene.check().overlaps == () and "overlap too much" not in str(scene.check())
    contact.overlap = None
    scene.body("roller").position = (0, 0, 0.0496)  # 0.4 mm of the 0.5 mm
    assert scene.check().overlaps == ()


# --- what is set later is checked as what is given


def test_a_pair_is_checked_when_it_is_changed(body_maker) -> None:
    plain = body_maker()
    rim = replace(plain.contact_surfaces["rim"], tangential=SimpleNamespace())
    _, contact = on_floor(replace(plain, contact_surfaces={"rim": rim}), 0.05)
    contact.friction = 0.1
    assert contact.friction == Coulomb(0.1)
    contact.law = laws.LinearLayer(1e12)
    contact.capacity, contact.overlap = 30.0, 1e-4
    assert (contact.capacity, contact.overlap) == (30, 1e-4)
    wrong: dict[str, Any] = {
        "friction": -1, "law": 1e12, "capacity": 0, "overlap": -1e-6, "quadrature": "reduced",
    }  # fmt: skip
    for name, value in wrong.items():
        kept = getattr(contact, name)
        with pytest.raises(InputError, match=f"contact 'c': {name}"):
            setattr(contact, name, value)
        assert getattr(contact, name) is kept
    _, without = on_floor(plain, 0.05)
    with pytest.raises(InputError, match="friction needs tangential modes.*tangential=True"):
        without.friction = 0.1


# --- numbers


@pytest.mark.parametrize("value", [0.3, np.float32(0.3), np.float64(0.3), np.array(0.3), 1, np.int64(1), np.array(1)])
def test_every_number_is_a_coefficient(value: Any) -> None:
    law = as_friction(value, "pair")
    assert isinstance(law, Coulomb) and law == Coulomb(float(value)) and type(law.coefficient) is float


@pytest.mark.parametrize("value", [True, np.True_, "0.3", [0.3], np.array([0.3]), None, 0.3j])
def test_what_is_no_number_is_no_coefficient(value: Any) -> None:
    with pytest.raises(InputError, match="pair: friction must be a coefficient or one of laws.Coulomb"):
        as_friction(value, "pair")


def test_text_and_truth_values_are_no_numbers() -> None:
    makers: list[Any] = [
        lambda: laws.LinearLayer("1e12"),  # type: ignore[arg-type]
        lambda: laws.NonlinearLayer(1e12, "1.5"),  # type: ignore[arg-type]
        lambda: laws.ExponentialAsperities("1e6", 1e-6),  # type: ignore[arg-type]
        lambda: laws.HuntCrossley("1e12", 1.5, damping=1.0),  # type: ignore[arg-type]
        lambda: laws.HuntCrossley(1e12, 1.5, damping=True),
        lambda: laws.Coulomb(True),
        lambda: laws.Coulomb("0.1"),  # type: ignore[arg-type]
        lambda: surfaces.Cylinder(radius="0.05"),  # type: ignore[arg-type]
        lambda: require_number(np.True_, "it"),
    ]
    for make in makers:
        with pytest.raises(InputError, match="must be a number, got"):
            make()


def test_laws_keep_floats() -> None:
    f: Any = np.float32
    made = [
        laws.LinearLayer(f(1e12)),
        laws.NonlinearLayer(f(1e12), np.int64(2)),  # type: ignore[arg-type]
        laws.ExponentialAsperities(f(1e6), f(1e-6), cut=f(1e-5)),
        laws.HuntCrossley(f(1e12), 2, restitution=f(0.5), impact_speed=1),
        laws.HuntCrossley(f(1e12), 2, damping=np.array(3)),  # type: ignore[arg-type]
    ]
    for law in made:
        kept = [value for value in vars(law).values() if value is not None]
        assert kept and all(type(value) is float for value in kept)


# --- shapes


def test_surfaces_of_a_rigid_body_are_a_mapping() -> None:
    with pytest.raises(InputError, match=r"body 'w': surfaces must be a mapping of names to shapes, \{'tread': "):
        Scene().add_rigid_body(1.0, CUBE, name="w", surfaces=[FLOOR])  # type: ignore[arg-type]


def test_a_rigid_shape_names_what_it_lacks() -> None:
    ground = Scene().ground
    lacking: list[tuple[Any, str]] = [
        (surfaces.Cylinder(radius=0.1), "give axis_point and axis_direction in Cylinder"),
        (surfaces.Plane(outward=(0, 0, 1)), "give origin in Plane"),
        (surfaces.Groove(radius=0.1, **PLACED), "give groove_radius in Groove"),
        (surfaces.Cone(radius=0.1, axis_point=(0, 0, 0)), "give axis_direction and half_angle in Cone"),
        (surfaces.Sphere(radius=0.1), "give axis_point in Sphere"),
    ]
    for shape, said in lacking:
        with pytest.raises(InputError, match=said):
            ground.surface(shape, name="x")


@pytest.mark.parametrize("kind", [surfaces.Sphere, surfaces.Cup])
def test_a_rigid_ball_needs_no_axis(kind) -> None:
    shape = Scene().ground.surface(kind(radius=0.1, axis_point=(0, 0, 1)), name="ball").surface.shape
    np.testing.assert_array_equal(shape.e_a, [0, 1, 0])
    x = np.random.default_rng(3).normal(size=(20, 3)) + [0, 0, 1]
    np.testing.assert_allclose(shape.chart(x)[2], kind.side * (np.linalg.norm(x - [0, 0, 1], axis=1) - 0.1), atol=1e-14)
    given = surfaces.Sphere(radius=0.1, axis_point=(0, 0, 1), axis_direction=(1, 0, 0))
    assert Scene().ground.surface(given, name="ball").surface.shape is given


@pytest.mark.parametrize("rows", [2, 3, 9])
@pytest.mark.parametrize(("radius", "half_width"), [(0.05, 0.01), (0.05, 2.5e-4), (1.0, 0.005)])
def test_a_straight_profile_shows_no_arc(radius: float, half_width: float, rows: int) -> None:
    nodes = grid_points(surfaces.Cylinder(radius=radius, **PLACED), half_width, rows)
    noise = np.random.default_rng(5).normal(size=nodes.shape)
    for kind, said in (
        (surfaces.Groove, r"no groove; use Cylinder\(\)"),
        (surfaces.CrownedCylinder, r"no crown; use Cylinder\(\)"),
        (surfaces.Ring, r"no groove; use Bore\(\)"),
    ):
        for size in (0.0, 1e-12 * radius):
            with pytest.raises(InputError, match=said):
                kind(axis_direction=(0, 1, 0)).fitted(nodes + size * noise)


@pytest.mark.parametrize("arc", [0.5, 50.0])
def test_a_slight_arc_is_found_all_the_same(arc: float) -> None:
    """Rc = 50 m over 20 mm drops by a micrometre, 2e-5 of the radius."""
    given: dict[str, Any] = {"radius": 0.05, **PLACED}
    groove = surfaces.Groove(axis_direction=(0, 1, 0)).fitted(
        grid_points(surfaces.Groove(groove_radius=arc, **given), 0.01, 5)
    )
    crown = surfaces.CrownedCylinder(axis_direction=(0, 1, 0)).fitted(
        grid_points(surfaces.CrownedCylinder(crown_radius=arc, **given), 0.01, 5)
    )
    assert (groove.groove_radius, crown.crown_radius) == pytest.approx((arc, arc), rel=1e-6)


def test_an_arc_that_is_nearly_straight_has_the_area_of_a_cylinder() -> None:
    z = np.array([-0.01, 0.0, 0.01])
    for arc in (1e6, 1e15, 1e25):
        flat = surfaces.Groove(radius=0.05, groove_radius=arc, **PLACED)
        np.testing.assert_allclose(flat.measure_at(z), flat.radius_at(z) * np.hypot(1.0, flat.slope_at(z)), rtol=1e-14)


def test_a_level_table_is_a_cylinder() -> None:
    z = np.array([-0.012, 0.0, 0.01])
    nodes = grid_points(surfaces.Cylinder(radius=0.05, **PLACED), 0.01, 5) + [0.0, 0.3, 0.0]
    for drop, radius in ((0.0, None), (1e-3, None), (1e-3, 0.051)):
        table = (z, np.full(3, drop))
        found = surfaces.ProfiledCylinder(table=table, radius=radius).fitted(nodes)
        assert found.radius == pytest.approx(0.05 + drop) and found.deviation < 1e-15
        np.testing.assert_allclose(found.axis_point, [0.0, 0.301, 0.0], atol=1e-12)
