"""Contact on smooth surfaces through nodes: the forces and pressures of the sphere, the cylinder and the arcs that the
nodes lie on, Hertz's ellipse in any direction, and what is refused."""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np
import pytest

import warpffrf as wf
from references.closed_forms import contact_modulus
from references.closed_forms.elliptic import EllipticContact
from scenes import curved_blocks as blocks
from warpffrf.model.errors import InputError
from warpffrf.offline import ContactGrid, reduce

STEEL = blocks.STEEL
RADIUS, BALL = 0.05, 0.02  # m
FACET = 2e-3  # m, about the width of the patches
FORCE, PRESSURE, RIPPLE = 5e-3, 1e-2, 5e-3
UP: Any = {"outward": (0, 0, 1), "direction": (0, 1, 0)}


def nodes(height: Any, half: tuple[float, float] = (0.012, 0.012), spacing: float = FACET) -> np.ndarray:
    """Points of z = height(x, y) at unequal distances of about `spacing` [m]."""
    x, y = np.meshgrid(*(np.linspace(-a, a, round(2.0 * a / spacing) + 1) for a in half), indexing="ij")
    rng = np.random.default_rng(1)
    inside = (np.abs(x) < 0.99 * half[0]) & (np.abs(y) < 0.99 * half[1])
    x, y = (v + 0.1 * spacing * inside * rng.normal(size=v.shape) for v in (x, y))
    return np.column_stack([x.ravel(), y.ravel(), height(x, y).ravel()])


def dome(x: Any, y: Any) -> Any:
    return np.sqrt(RADIUS**2 - x**2 - y**2) - RADIUS


def barrel(x: Any, y: Any) -> Any:
    return np.sqrt(RADIUS**2 - x**2) - RADIUS + 0.0 * y


AXIS: Any = {"axis_point": (0, 0, -RADIUS), "axis_direction": (0, 1, 0)}
CASES = {
    "sphere": (wf.surfaces.Sphere(radius=RADIUS, **AXIS), wf.surfaces.MeshSurface(**UP).fitted(nodes(dome))),
    "cylinder": (wf.surfaces.Cylinder(radius=RADIUS, **AXIS), wf.surfaces.MeshSurface(**UP).fitted(nodes(barrel))),
}


def body_of(shape: Any) -> wf.ReducedBody:
    return wf.half_space_body(0.1, (1e-5,) * 3, STEEL, contact={"face": shape}, extent=(-4e-3, 4e-3), free_ends=False)


def passed(shape: Any, kind: str, friction: float = 0.0) -> wf.Result:
    """A ball, or a roller, held at an overlap of 15 um over a body that rotates about the centre of its sphere, or its
    axis, by 6 degrees: 2.6 facets pass below it."""
    scene = wf.Scene(gravity=(0, 0, 0))
    round_ = wf.surfaces.Sphere if kind == "sphere" else wf.surfaces.Cylinder
    upper = scene.add_body(
        body_of(round_(radius=BALL, axis_point=(0, 0, 0), axis_direction=(0, 1, 0))),
        name="upper", position=(0, 0, BALL - 15e-6),
    )  # fmt: skip
    scene.add(wf.joints.Fixed(scene.ground, upper["center"]))
    lower = scene.add_rigid_body(1.0, (1e-3,) * 3, name="lower", surfaces={"face": shape})
    axle = scene.add(wf.joints.Revolute(scene.ground, lower.at((0, 0, -RADIUS)), axis=(0, 1, 0)))
    angle = wf.signals.SmoothStep(0.0, np.radians(6.0), duration=0.03)
    scene.add(wf.joints.Drive(axle, angle, quantity="position"))
    scene.add(wf.Contact(upper["face"], lower["face"], friction=friction, name="pair", overlap=1.0))
    result = wf.simulate(scene, 0.03, step=1e-3, progress=False)
    assert result.status == "completed", result.message
    return result


@pytest.mark.parametrize("kind", list(CASES))
def test_a_smoothed_mesh_is_the_surface_that_its_nodes_lie_on(kind: str) -> None:
    """Force and pressure while the patch passes over facets: those on the analytic surface, without ripple."""
    exact, smooth = (passed(shape, kind).contact("pair") for shape in CASES[kind])
    size = np.linalg.norm(exact.force, axis=1)
    assert np.abs(smooth.force - exact.force).max() < 0.1 * FORCE * size.max()
    assert np.abs(smooth.peak_pressure / exact.peak_pressure - 1.0).max() < 0.2 * PRESSURE
    assert np.ptp(np.linalg.norm(smooth.force, axis=1) / size) < 0.1 * RIPPLE


def test_friction_on_a_smoothed_mesh() -> None:
    exact, smooth = (passed(shape, "sphere", 0.2).contact("pair") for shape in CASES["sphere"])
    assert np.abs(exact.force[-1, 0]) > 0.15 * exact.force[-1, 2]  # it slides
    assert np.abs(smooth.force - exact.force).max() < 0.2 * FORCE * np.abs(exact.force).max()


def pressed(first: Any, second: Any, load: float) -> Any:
    """The contact of a half-space that hangs above a rigid surface, or another half-space, pressed down by `load`."""
    scene = wf.Scene(gravity=(0, 0, 0))
    upper = scene.add_body(body_of(first), name="upper", position=(0, 0, -1e-6))
    scene.add(wf.joints.Prismatic(scene.ground, upper["center"], axis=(0, 0, 1)))
    scene.add(wf.forces.PointForce(upper["center"], (0, 0, -load)))
    if isinstance(second, wf.surfaces.MeshSurface):
        lower = scene.add_body(body_of(second), name="lower")
        scene.add(wf.joints.Fixed(scene.ground, lower["center"]))
        face = lower["face"]
    else:
        face = scene.ground.surface(second, name="floor")
    scene.add(wf.Contact(upper["face"], face, name="pair"))
    return wf.equilibrium(scene, progress=False, check=True).contact("pair")


PLANE = wf.surfaces.Plane(origin=(0, 0, 0), **UP)
DOWN: Any = {"outward": (0, 0, -1), "direction": (0, 1, 0)}


def cap(angle: float, radii: tuple[float, float] = (0.04, 0.12), depth: float = 0.03) -> Any:
    """The lowest part of an ellipsoid of these radii [m] there, its axes rotated by an angle in the chart."""
    c, s = np.cos(angle), np.sin(angle)

    def height(x: Any, y: Any) -> Any:
        u, v = c * x + s * y, c * y - s * x
        return depth * (1.0 - np.sqrt(1.0 - u**2 / (radii[0] * depth) - v**2 / (radii[1] * depth)))

    return wf.surfaces.MeshSurface(**DOWN).fitted(nodes(height, spacing=1.5e-3))


@pytest.mark.parametrize("degrees", [0.0, 30.0, 45.0, 90.0])
def test_hertz_on_an_ellipsoid_in_any_direction(degrees: float) -> None:
    """As the first surface, whose cells lie along its chart: force is given, approach and pressure are Hertz's."""
    found = pressed(cap(np.radians(degrees)), PLANE, 3000.0)
    exact = EllipticContact(3000.0, 0.04, 0.12, contact_modulus(STEEL))
    assert found.approach[-1] == pytest.approx(exact.approach, rel=FORCE)
    assert found.peak_pressure[-1] == pytest.approx(exact.peak_pressure, rel=PRESSURE)


def test_two_smoothed_meshes() -> None:
    """Two domes of equal radii are one of half the radius on a plane, half as stiff."""
    hung = wf.surfaces.MeshSurface(**DOWN).fitted(nodes(lambda x, y: -dome(x, y)))
    one, both = pressed(hung, PLANE, 3000.0), pressed(hung, CASES["sphere"][1], 3000.0)
    assert both.peak_pressure[-1] == pytest.approx(one.peak_pressure[-1], rel=1e-3)
    assert both.approach[-1] == pytest.approx(2.0 * one.approach[-1], rel=1e-3)


@cache
def block(radius: float, kind: str) -> wf.ReducedBody:
    curve = blocks.arc(radius)
    shape = blocks.extruded(curve) if kind == "arc" else wf.surfaces.MeshSurface(direction=(0, 0, 1))
    return reduce(
        blocks.mesh_below(curve), STEEL, interfaces={"back": "rigid"}, contact={"face": shape}, modes=0,
        grid=ContactGrid(contact_fixed=True), progress=False,
    )  # fmt: skip


@pytest.mark.parametrize("kinds", [("arc", "mesh"), ("mesh", "arc"), ("mesh", "mesh")], ids="-".join)
def test_flexible_blocks(kinds: tuple[str, str]) -> None:
    """Of finite elements, fitted to their nodes, as the first surface and the second: the line contact of two arcs."""
    found, exact = (
        wf.equilibrium(
            blocks.pressed(block(0.05, first), block(0.08, second), 4e3, grid="contact_fixed"), progress=False
        ).contact("pair")
        for first, second in (kinds, ("arc", "arc"))
    )
    assert found.approach[-1] == pytest.approx(exact.approach[-1], rel=FORCE)
    assert found.peak_pressure[-1] == pytest.approx(exact.peak_pressure[-1], rel=0.1 * PRESSURE)
    assert found.half_widths[-1] == pytest.approx(exact.half_widths[-1], rel=FORCE)


def test_what_is_refused() -> None:
    scene = wf.Scene()
    upper = scene.add_body(
        body_of(CASES["sphere"][1]), name="upper", rotation={"axis": (0, 1, 0), "angle": np.pi - 0.2}
    )
    floor = scene.ground.surface(PLANE, name="floor")
    upper.position = np.array([0.0, 0.0, RADIUS]) + RADIUS * np.array([np.sin(-0.2), 0.0, -np.cos(0.2)])
    scene.add(wf.Contact(upper["face"], floor, name="pair", overlap=1.0))
    with pytest.raises(InputError, match=r"leans by 0\.2 rad to its plane.*give it outward"):
        wf.simulate(scene, 1e-3, step=1e-3, progress=False)
    ball = scene.add_rigid_body(
        1.0, (1.0,) * 3, name="ball", surfaces={"ball": wf.surfaces.Sphere(radius=0.01, axis_point=(0, 0, 0))}
    )
    cushion = scene.ground.surface(CASES["sphere"][1], name="cushion")
    with pytest.raises(InputError, match="is of kind mesh_surface, which a lumped contact does not support"):
        scene.add(wf.LumpedContact(ball["ball"], cushion, law=wf.laws.HertzPoint(STEEL, STEEL)))


def test_a_body_fixed_grid_is_refused() -> None:
    scene = blocks.pressed(block(0.05, "arc"), block(0.08, "mesh"), 4e3, grid="body_fixed")
    with pytest.raises(InputError, match='is of kind mesh_surface, whose contact is on the cells of grid="contact_fix'):
        wf.equilibrium(scene, progress=False)
