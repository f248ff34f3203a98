"""Rollers on extruded curves: a circle is a cylinder, a straight line a plane; what extruded surfaces refuse."""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np
import pytest

import warpffrf as wf
from scenes.rollers import roller_body
from warpffrf.model.errors import InputError
from warpffrf.model.surfaces import Curve, Cylinder, Extruded, Plane

DRUM, LOAD, SPEED = 0.05, 20e3, 5.0  # m, N, rad/s
CIRCLE = Curve.arcs((DRUM, 0.0), 0.5 * np.pi, [(2.0 * np.pi * DRUM, DRUM)], closed=True)
LINE = Curve.arcs((-0.1, 0.0), 0.0, [(0.2, np.inf)])  # e_1 points down, where the material is
AS_ROUND = 1e-6  # of the largest: cubic pieces of 0.02 rad are off a circle by 4e-10 R, and bent by 3e-5 more or less
AS_FLAT = 1e-11  # friction iterates to round-off on different operations


@cache
def body(tangential: bool) -> wf.ReducedBody:
    return roller_body(120, layers=4, axial=2, order=2, modes=4, tangential=tangential, contact_fixed=True)


def rolled(shape: Any, friction: float, grid: Any) -> wf.Result:
    """A roller pressed on a drum that rotates, or on a fixed plane under its own rotation, from equilibrium."""
    scene, size, drum = wf.Scene(gravity=(0, 0, 0)), 0.05, not isinstance(shape, Plane) and shape is not FLAT
    top = (0.0, 0.0, size + (DRUM if drum else 0.0))
    roller = scene.add_body(body(friction > 0.0), name="roller", position=top)
    carriage = scene.add_rigid_body(1.0, (1e-3,) * 3, name="carriage", position=top)
    scene.add(wf.joints.Prismatic(scene.ground, carriage.at((0, 0, 0)), axis=(0, 0, 1)))
    axle = scene.add(wf.joints.Revolute(carriage.at((0, 0, 0)), roller["bore"], axis=(0, 1, 0)))
    if drum:
        other = scene.add_rigid_body(1.0, (1e-3,) * 3, name="drum", surfaces={"face": shape})
        axle = scene.add(wf.joints.Revolute(scene.ground, other.at((0, 0, 0)), axis=(0, 1, 0)))
        face = other["face"]
    else:
        face = scene.ground.surface(shape, name="face")
    scene.add(wf.joints.Drive(axle, wf.signals.SmoothStep(0.0, SPEED, duration=5e-3), quantity="velocity"))
    scene.add(wf.forces.PointForce(carriage.at((0, 0, 0)), (0.0, 0.0, -LOAD)))
    scene.add(wf.Contact(roller["rim"], face, friction=friction, grid=grid, name="pair"))
    result = wf.simulate(scene, 0.01, step=2e-4, start="equilibrium", progress=False)
    assert result.status == "completed", result.message
    return result


ROUND = Cylinder(radius=DRUM, axis_point=(0, 0, 0), axis_direction=(0, 1, 0))
ROUND_CURVE = Extruded(curve=CIRCLE, axis_direction=(0, 1, 0))
PLANE = Plane(origin=(0, 0, 0), outward=(0, 0, 1), direction=(0, 1, 0))
FLAT = Extruded(curve=LINE, axis_direction=(0, 1, 0), x_direction=(1, 0, 0))


@pytest.mark.parametrize("grid", ["body_fixed", "contact_fixed"])
@pytest.mark.parametrize("friction", [0.0, 0.2])
@pytest.mark.parametrize(("curve", "known", "tolerance"), [(ROUND_CURVE, ROUND, AS_ROUND), (FLAT, PLANE, AS_FLAT)])
def test_a_known_shape(curve: Extruded, known: Any, tolerance: float, friction: float, grid: str) -> None:
    """Forces, torques, positions and rotations are those of a cylinder, and of a plane."""
    found, expected = rolled(curve, friction, grid), rolled(known, friction, grid)
    force, other = found.contact("pair").force, expected.contact("pair").force
    assert np.abs(force - other).max() < tolerance * LOAD
    own, same = found.body("roller"), expected.body("roller")
    assert np.abs(own.position - same.position).max() < tolerance * DRUM
    turned = np.abs(own.angular_velocity - same.angular_velocity).max()
    assert turned < tolerance * max(np.abs(same.angular_velocity).max(), SPEED)
    if friction:
        assert np.abs(force[:, 0]).max() > 1e-3 * LOAD


def test_a_lumped_contact_is_refused() -> None:
    with pytest.raises(InputError, match="is of kind extruded, which a lumped contact does not support"):
        _lumped()


def _lumped() -> None:
    scene = wf.Scene()
    ball = scene.add_rigid_body(
        1.0,
        (1.0,) * 3,
        name="ball",
        surfaces={"ball": wf.surfaces.Sphere(radius=0.01, axis_point=(0, 0, 0), axis_direction=(0, 0, 1))},
    )
    floor = scene.ground.surface(FLAT, name="floor")
    scene.add(
        wf.LumpedContact(
            ball["ball"], floor, law=wf.laws.HertzPoint(wf.Material(2e11, 0.3, 7850.0), wf.Material(2e11, 0.3, 7850.0))
        )
    )
