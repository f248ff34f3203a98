"""Cages that yield: a bar pushed by a roller against finite elements, a cage of a hundredfold stiffness against a rigid
one, the speed of rolling, and rotation, ovalisation and expansion of a cage alone."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import warpffrf as wf
from references.finite_elements.shaft_in_housing import Elastic

MM = 1e-3
COUNT, D, PITCH, PLAY = 8, 8 * MM, 48 * MM, 0.05 * MM  # elements; m: diameter and length, pitch circle, clearance
INNER, OUTER, WIDTH, WINDOW = 22 * MM, 26 * MM, 12 * MM, 8.5 * MM  # m: radii of the cage, along the axis
SOFT = wf.Material(5e9, 0.35, 1350.0, name="polyamide with glass fibres")
STIFF = wf.Material(5e11, 0.35, 1350.0, name="hundredfold stiffness")
LAW = wf.laws.PalmgrenLine(D, 2, damping=0.5)


def cage_mesh(pockets: int = COUNT, window: float = WINDOW, width: float = D + PLAY, **options: Any) -> wf.mesh.Mesh:
    cells: dict[str, Any] = {"around": (2, 2), "axial": (1, 2), **options}
    return wf.mesh.cage(INNER, OUTER, WIDTH, pockets=pockets, pocket_width=width, pocket_length=window, **cells)


def reduced(material: wf.Material, mesh: wf.mesh.Mesh, walls: str, modes: int = 6) -> wf.ReducedBody:
    """With average interfaces at the ends and at the walls, "bar" or "pocket"."""
    places = [name for name in mesh.facet_sets if name.startswith(walls)]
    interfaces = dict.fromkeys(["ends", *places], "average")
    return wf.reduce(mesh, material, interfaces=interfaces, modes=modes, progress=False)


def rollers(**options: Any) -> wf.bearings.RollerGeometry:
    return wf.bearings.RollerGeometry(
        elements=COUNT, roller_diameter=D, roller_length=D, pitch_diameter=PITCH, **options
    )


def test_a_bar_yields_as_in_finite_elements() -> None:
    """A roller between raceways pushes a bar of a cage whose ends are held in the mean."""
    mesh, push = cage_mesh(), 20.0  # N
    scene = wf.Scene()
    body = scene.add_body(reduced(SOFT, mesh, "bar"), name="cage")
    bearing = scene.add_bearing(
        "b", rollers(clearance=-2e-6), outer=scene.ground, cage=wf.bearings.PocketCage(0.0, body=body)
    )
    scene.add(wf.joints.Fixed(scene.ground, bearing.inner, axis=(0, 1, 0), name="shaft"))
    scene.add(wf.joints.Drive(bearing.joints["cage_axle"], 0.0, name="held"))
    around = bearing.place.around(0.0)
    scene.add(wf.forces.PointForce(bearing.elements[0], tuple(push * around), name="push"))
    result = wf.equilibrium(scene, progress=False)
    assert result.status == "completed", result.message
    pressed = result.bearing("b").cage_force[-1]
    np.testing.assert_allclose(pressed, [-push, *(COUNT - 1) * [0.0]], rtol=1e-6, atol=1e-6 * push)
    found = result.body("b cage bar_1").position[-1] - bearing.pockets["bar_1"].position

    middle = body.flexible.interfaces["bar_1"].point
    elastic = Elastic.of(mesh, SOFT, {"ends": np.zeros(3), "bar_1": middle})
    wall = np.array([0.5 * PITCH, 0.0, 0.0]) + 0.5 * D * around
    load = np.concatenate([np.zeros(6), push * around, np.cross(wall - middle, push * around)])
    C, S = elastic.compliance, np.diag(elastic.springs)
    # q = C (load + reaction + S q), q = 0 and a reaction at the ends: unknown are that and the motion of the bar
    full = np.linalg.solve(np.hstack([-C[:, :6], (np.eye(12) - C @ S)[:, 6:]]), C @ load)[6:9]
    print(f"bar moves by {1e6 * found} um, finite elements {1e6 * full} um")
    assert np.linalg.norm(found - full) < 2e-3 * np.linalg.norm(full)
