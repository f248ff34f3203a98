"""`wf.half_space_body`: rigid bodies whose surfaces are elastic half-spaces, against closed forms and CONTACT."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import warpffrf as wf
from references.closed_forms import LineContact, PointContact, contact_modulus
from references.closed_forms.rolling_tables import (
    EUROSPRINTER_FORCES,
    EUROSPRINTER_FRICTION,
    EUROSPRINTER_LOAD,
    EUROSPRINTER_PATCH,
    EUROSPRINTER_POISSON,
    EUROSPRINTER_RADII,
    EUROSPRINTER_SHEAR,
)
from warpffrf.model.reduced.body import ReducedBody

STEEL = wf.Material(youngs_modulus=210e9, poisson_ratio=0.3, density=7850)
BRONZE = wf.Material(youngs_modulus=105e9, poisson_ratio=0.34, density=8800)
RADIUS, HALF_WIDTH = 0.01, 0.005  # m
AXIS: Any = {"axis_point": (0, 0, 0), "axis_direction": (0, 1, 0)}
BALL = wf.surfaces.Sphere(radius=RADIUS, **AXIS)
ROLLER = wf.surfaces.Cylinder(radius=RADIUS, **AXIS)
PLANE = wf.surfaces.Plane(origin=(0, 0, 0), outward=(0, 0, 1), direction=(0, 1, 0))
FINE = 1e-3  # cell_error: then cells add less than this to the results, whose references are exact
CLOSE = 2e-3  # twice that
MIDDLE = 0.02  # of Hertz's line pressure in the middle of a roller with free ends: the load is not uniform along it
ROLLING = 0.015  # of mu N: CONTACT's own cells, as in the verification case eurosprinter
CELLS, SPEED, CROSSINGS = 13, 1.0, 4.0  # m/s, times that the material runs through the patch until rolling is steady


def body_of(shape: Any, extent: Any, material: wf.Material = STEEL, **options: Any) -> ReducedBody:
    return wf.half_space_body(
        0.03, (1e-6, 1e-6, 1e-6), material, contact={"skin": shape}, extent={"skin": extent}, **options
    )


def pressed(body: ReducedBody, load: float, onto: ReducedBody | None = None, **options: Any) -> wf.Result:
    """The body on the plane z = 0, guided along z; `onto`: elastic, else rigid."""
    scene = wf.Scene()
    ball = scene.add_body(body, name="ball", position=(0, 0, RADIUS - 1e-6))
    if onto is None:
        face: Any = scene.ground.surface(PLANE, name="face")
    else:
        table = scene.add_body(onto, name="table")
        scene.add(wf.joints.Fixed(scene.ground, table["center"]))
        face = table["skin"]
    scene.add(wf.joints.Prismatic(scene.ground, ball["center"], axis=(0, 0, 1), name="guide"))
    scene.add(wf.forces.PointForce(ball["center"], (0, 0, -load), name="load"))
    scene.add(wf.Contact(ball["skin"], face, name="touch", **options))
    return wf.equilibrium(scene, progress=False, check=True)


@pytest.mark.parametrize("load", [2.0, 200.0])
def test_a_ball_on_a_rigid_plane(load: float) -> None:
    found = pressed(body_of(BALL, (-HALF_WIDTH, HALF_WIDTH), free_ends=False), load, cell_error=FINE).contact("touch")
    exact = PointContact(load, RADIUS, contact_modulus(STEEL))
    assert found.peak_pressure[0] == pytest.approx(exact.peak_pressure, rel=CLOSE)
    assert found.approach[0] == pytest.approx(exact.approach, rel=CLOSE)
    assert found.half_widths[0] == pytest.approx([exact.half_width] * 2, rel=CLOSE)


def test_a_cap_presses_at_the_nearest_place_between_two_angles_of_the_scan() -> None:
    """Which are 15 degrees apart; their gaps are equal but for round-off."""
    radius, scene = 5 * RADIUS, wf.Scene()
    cap = wf.surfaces.Sphere(radius=radius, axis_point=(0, 0, -radius), axis_direction=(0, 1, 0))
    body = scene.add_body(
        body_of(cap, (-HALF_WIDTH, HALF_WIDTH), free_ends=False), name="body", position=(0, 0, -1e-6),
        rotation={"axis": (1, 0, 0), "angle": np.pi},
    )  # fmt: skip
    scene.add(wf.joints.Prismatic(scene.ground, body["center"], axis=(0, 0, 1)))
    scene.add(wf.forces.PointForce(body["center"], (0, 0, -200.0)))
    scene.add(wf.Contact(body["skin"], scene.ground.surface(PLANE, name="face"), name="touch", cell_error=FINE))
    found = wf.equilibrium(scene, progress=False).contact("touch")
    exact = PointContact(200.0, radius, contact_modulus(STEEL))
    assert found.peak_pressure[0] == pytest.approx(exact.peak_pressure, rel=CLOSE)


def test_two_elastic_bodies_of_unlike_materials() -> None:
    table = body_of(PLANE, ((-HALF_WIDTH, HALF_WIDTH), (-HALF_WIDTH, HALF_WIDTH)), BRONZE, free_ends=False)
    ball = body_of(BALL, (-HALF_WIDTH, HALF_WIDTH), free_ends=False)
    found = pressed(ball, 100.0, table, cell_error=FINE).contact("touch")
    exact = PointContact(100.0, RADIUS, contact_modulus(STEEL, BRONZE))
    assert found.peak_pressure[0] == pytest.approx(exact.peak_pressure, rel=CLOSE)
    assert found.approach[0] == pytest.approx(exact.approach, rel=CLOSE)
    assert found.effective_modulus == pytest.approx(exact.modulus, rel=1e-12)  # the same formula


def test_a_plane_that_carries_the_pressure() -> None:
    """The elastic plane is the first surface, and a rigid ball the second."""
    scene = wf.Scene()
    table = scene.add_body(
        body_of(PLANE, ((-HALF_WIDTH, HALF_WIDTH), (-HALF_WIDTH, HALF_WIDTH)), free_ends=False), name="table"
    )
    scene.add(wf.joints.Fixed(scene.ground, table["center"]))
    ball = scene.add_rigid_body(0.03, (1e-6, 1e-6, 1e-6), name="ball", surfaces={"skin": BALL}, position=(0, 0, RADIUS))
    scene.add(wf.joints.Prismatic(scene.ground, ball, axis=(0, 0, 1)))
    scene.add(wf.forces.PointForce(ball, (0, 0, -100.0)))
    scene.add(wf.Contact(table["skin"], ball["skin"], name="touch", cell_error=FINE))
    found = wf.equilibrium(scene, progress=False, check=True).contact("touch")
    exact = PointContact(100.0, RADIUS, contact_modulus(STEEL))
    assert found.peak_pressure[0] == pytest.approx(exact.peak_pressure, rel=CLOSE)


def test_a_roller_with_free_ends() -> None:
    """Free ends yield more: the pressure is lower there, and in the middle a little above that of a uniform load. A
    body that continues has a stamp's edges."""
    load = 5e3
    exact = LineContact(load / (4 * HALF_WIDTH), RADIUS, contact_modulus(STEEL))
    extent = (-2 * HALF_WIDTH, 2 * HALF_WIDTH)
    result = pressed(body_of(ROLLER, extent), load)
    free = result.contact("touch")
    continued = pressed(body_of(ROLLER, extent, free_ends=False), load).contact("touch")
    assert free.mid_peak_pressure[0] == pytest.approx(exact.peak_pressure, rel=MIDDLE)
    assert free.peak_pressure[0] < 1.05 * exact.peak_pressure < continued.peak_pressure[0]
    assert "have no depth" in result.report()  # on which the approach of a line depends


@pytest.mark.parametrize(("creepage", "share"), EUROSPRINTER_FORCES[1:8:3])
def test_rolling_with_creepage(creepage: float, share: float) -> None:
    """Wheel and rail of CONTACT's example as two equal crowned rollers of twice the radii: then the velocities of both
    surfaces differ by the creepage everywhere in the patch."""
    material = wf.Material(
        youngs_modulus=2.0 * EUROSPRINTER_SHEAR * (1.0 + EUROSPRINTER_POISSON), poisson_ratio=EUROSPRINTER_POISSON,
        density=7850,
    )  # fmt: skip
    radius, crown = (2.0 * r for r in EUROSPRINTER_RADII)
    a, b, peak, approach = EUROSPRINTER_PATCH
    tread = wf.surfaces.CrownedCylinder(radius=radius, crown_radius=crown, **AXIS)
    roller = body_of(tread, (-0.06, 0.06), material, free_ends=False)
    scene = wf.Scene()
    lower = scene.add_body(roller, name="lower", angular_velocity=(0, -SPEED / radius, 0))
    spin = SPEED * (1.0 + creepage) / radius
    place = (0, 0, 2.0 * radius - approach)
    upper = scene.add_body(roller, name="upper", position=place, angular_velocity=(0, spin, 0))
    fork = scene.add_rigid_body(1.0, (1.0, 1.0, 1.0), name="fork", position=place)
    scene.add(wf.joints.Prismatic(scene.ground, fork, axis=(0, 0, 1)))
    axle = scene.add(wf.joints.Revolute(scene.ground, lower["center"], axis=(0, 1, 0)))
    axle_above = scene.add(wf.joints.Revolute(fork, upper["center"], axis=(0, 1, 0)))
    scene.add(wf.joints.Drive(axle, -SPEED / radius))
    scene.add(wf.joints.Drive(axle_above, spin))
    scene.add(wf.forces.PointForce(fork, (0, 0, -EUROSPRINTER_LOAD)))
    contact = wf.Contact(upper["skin"], lower["skin"], friction=EUROSPRINTER_FRICTION, cells=(CELLS, CELLS))
    scene.add(contact)
    result = wf.simulate(
        scene, CROSSINGS * 2.0 * a / SPEED, step=2.6 * a / CELLS / SPEED, start="equilibrium", progress=False,
        check=True, options=wf.RunOptions(integrator=wf.integrators.GeneralizedAlpha(0.5)),
    )  # fmt: skip
    found = result.contact(contact.name)
    force = -found.friction.tangential_force[-1] / (EUROSPRINTER_FRICTION * found.normal_load[-1])
    assert force[0] == pytest.approx(share, abs=ROLLING)
    assert abs(force[1]) < 1e-9  # by symmetry
    assert found.peak_pressure[-1] == pytest.approx(peak, rel=0.01)  # of 13 cells
    assert found.half_widths[-1] == pytest.approx([a, b], rel=0.01)


def test_its_file(tmp_path: Path) -> None:
    body = body_of(ROLLER, (-HALF_WIDTH, HALF_WIDTH), points={"left": (0, -0.01, 0), "right": (0, 0.01, 0)})
    loaded = ReducedBody.load(body.save(tmp_path / "roller.h5"))
    assert loaded.content_hash() == body.content_hash()
    assert list(loaded.interfaces) == ["left", "right"]
    assert "half-space" in body.info()


def test_a_scene_file(tmp_path: Path) -> None:
    path = tmp_path / "ball.toml"
    path.write_text(
        """
[materials.steel]
youngs_modulus = 210e9
poisson_ratio = 0.3
density = 7850
[reduced_bodies.ball]
kind = "half_space"
mass = 0.03
inertia_tensor = [1e-6, 1e-6, 1e-6]
material = "steel"
contact.skin = { kind = "sphere", radius = 0.01, axis_point = [0, 0, 0], axis_direction = [0, 1, 0] }
extent.skin = [-0.005, 0.005]
free_ends = false
[bodies.ball]
body = "ball"
"""
    )
    ball = wf.load_scene(path).scene.body("ball").flexible
    assert ball.content_hash() == body_of(BALL, (-HALF_WIDTH, HALF_WIDTH), free_ends=False).content_hash()


def test_what_is_refused() -> None:
    extent = (-HALF_WIDTH, HALF_WIDTH)
    with pytest.raises(wf.InputError, match=r"surface 'skin' has no ends; give extent=\{'skin': \(low, high\)\}"):
        wf.half_space_body(1.0, (1, 1, 1), STEEL, contact={"skin": BALL})
    with pytest.raises(wf.InputError, match="extent must be ascending"):
        body_of(BALL, (0.1, 0.0))
    with pytest.raises(wf.InputError, match="extent names 'other', which is no surface"):
        wf.half_space_body(1.0, (1, 1, 1), STEEL, contact={"skin": BALL}, extent={"skin": extent, "other": extent})
    with pytest.raises(wf.InputError, match="give radius"):
        body_of(wf.surfaces.Cylinder(axis_point=(0, 0, 0), axis_direction=(0, 1, 0)), extent)
    with pytest.raises(wf.InputError, match="largest exceeds the sum of the other two"):
        wf.half_space_body(1.0, (1, 1, 3), STEEL, contact={"skin": BALL}, extent={"skin": extent})
    with pytest.raises(wf.InputError, match=r"is a half-space, which is elastic only under the cells"):
        pressed(body_of(BALL, extent), 1.0, grid="body_fixed")


@pytest.mark.parametrize("shape", [BALL, PLANE], ids=["ball", "plane"])
def test_forces_move_no_point_of_a_picture(shape: Any) -> None:
    """Normal and tangential ones on all nodes: the body is rigid but for its half-spaces."""
    extent = (-HALF_WIDTH, HALF_WIDTH)
    body = body_of(shape, (extent, extent) if shape is PLANE else extent)
    surface = body.contact_surfaces["skin"]
    loads = np.ones((2, surface.grid.columns, surface.grid.rows))
    assert body.surface is not None and surface.tangential is not None
    for found in (surface.recover(loads[0]), surface.tangential.recover(loads)):
        assert found.shape == body.surface.points.shape
        assert not np.any(found)
