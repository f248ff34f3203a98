"""Cages that yield: a bar pushed by a roller against finite elements, a cage of a hundredfold stiffness against a rigid
one, the speed of rolling, and rotation, ovalisation and expansion of a cage alone."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import scipy.sparse as sp
from scipy.sparse.linalg import eigsh, splu

import warpffrf as wf
from references.finite_elements.meshes import matrices
from references.finite_elements.shaft_in_housing import Elastic, seat

MM = 1e-3
COUNT, D, PITCH, PLAY = 8, 8 * MM, 48 * MM, 0.05 * MM  # elements; m: diameter and length, pitch circle, clearance
INNER, OUTER, WIDTH, WINDOW = 22 * MM, 26 * MM, 12 * MM, 8.5 * MM  # m: radii of the cage, along the axis
SOFT = wf.Material(5e9, 0.35, 1350.0, name="polyamide with glass fibres")
STIFF = wf.Material(5e11, 0.35, 1350.0, name="hundredfold stiffness")
STEEL = wf.Material(210e9, 0.3, 7850.0)
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
    mesh, push = cage_mesh(), 1.0  # N: the bar rotates by 0.4 mrad, and the force with it
    gap = 2e-6  # m: other rollers do not touch
    scene = wf.Scene()
    body = scene.add_body(reduced(SOFT, mesh, "bar"), name="cage")
    bearing = scene.add_bearing(
        "b", rollers(clearance=-2e-6), outer=scene.ground, cage=wf.bearings.PocketCage(2.0 * gap, body=body)
    )
    scene.add(wf.joints.Fixed(scene.ground, bearing.inner, axis=(0, 1, 0), name="shaft"))
    scene.add(wf.joints.Drive(bearing.joints["cage_axle"], 0.0, name="held"))
    around = bearing.place.around(0.0)
    bearing.elements[0].position = bearing.elements[0].position + gap * around
    scene.add(wf.forces.PointForce(bearing.elements[0], tuple(push * around), name="push"))
    result = wf.equilibrium(scene, progress=False)
    assert result.status == "completed", result.message
    pressed = result.bearing("b").cage_force[-1]
    np.testing.assert_allclose(pressed, [-push, *(COUNT - 1) * [0.0]], rtol=1e-6, atol=1e-6 * push)
    assert {name for name, c in result.history.lumped_contacts.items() if "pocket" in name and c.normal_force[-1]} == {
        "b pocket 1 front"
    }
    found = result.body("b cage bar_1").position[-1] - bearing.pockets["bar_1"].position

    middle = body.flexible.interfaces["bar_1"].point
    elastic = Elastic.of(mesh, SOFT, {"ends": np.zeros(3), "bar_1": middle})
    wall = np.array([0.5 * PITCH, 0.0, 0.0]) + (0.5 * D + gap) * around
    load = np.concatenate([np.zeros(6), push * around, np.cross(wall - middle, push * around)])
    C, S = elastic.compliance, np.diag(elastic.springs)
    # q = C (load + reaction + S q), q = 0 and a reaction at the ends: unknown are that and the motion of the bar
    full = np.linalg.solve(np.hstack([-C[:, :6], (np.eye(12) - C @ S)[:, 6:]]), C @ load)[6:9]
    print(f"bar moves by {1e6 * found} um, finite elements {1e6 * full} um")
    assert np.linalg.norm(found - full) < 2e-3 * np.linalg.norm(full)


def driven(geometry: Any, material: wf.Material | None, walls: str, law: Any, load: float) -> tuple[Any, float, float]:
    """Result, speed of rolling [rad/s] and drag [N m] at it: a bearing under radial load whose cage has drag, None for
    a rigid cage with the mass of the soft one."""
    speed, drag, friction = 200.0, 0.05, wf.laws.RegularisedCoulomb(0.05, 5e-3)
    window = WINDOW if walls == "bar" else D + PLAY
    scene, body = wf.Scene(), reduced(material or SOFT, cage_mesh(window=window), walls)
    cage = scene.add_rigid_body(body.mass, body.inertia, name="cage") if material is None else None
    cage = cage or scene.add_body(body, name="cage", damping=0.05)
    roll = wf.laws.HertzPoint(STEEL, STEEL, damping=0.5) if walls == "pocket" else LAW
    bearing = scene.add_bearing(
        "b", geometry, outer=scene.ground, cage=wf.bearings.PocketCage(PLAY, body=cage, law=law),
        contact=wf.bearings.RollingContact(law=roll, friction=friction),
    )  # fmt: skip
    axle = scene.add(wf.joints.Planar(scene.ground, bearing.inner, axis=(0, 1, 0), name="axle"))
    scene.add(wf.joints.Drive(axle, speed, coordinate="rotation", name="drive"))
    scene.add(wf.forces.PointForce(bearing.inner, (-load, 0, 0), name="load"))
    rolling = bearing.roll(speed, angle=0.0).orbit
    scene.add(wf.forces.JointSpringDamper(bearing.joints["cage_axle"], 0.0, drag / rolling, name="drag"))
    result = wf.simulate(scene, 3e-3, step=2e-5, start="equilibrium", progress=False)
    assert result.status == "completed", result.message
    assert np.ptp(result.energy_residual) < 1e-5  # of the energy: the ledger closes
    return result, rolling, drag


def test_a_stiff_cage_moves_as_a_rigid_one() -> None:
    """A cage that strikes its balls and rebounds: speed and forces in the pockets throughout, unlike the soft one."""
    balls = wf.bearings.BallGeometry(elements=COUNT, ball_diameter=D, pitch_diameter=PITCH)
    law = wf.laws.PowerForce(2e5, 1.0, damping=0.5)  # N/m: 2 % of the stiffness of the stiff cage's pockets
    runs = {of: driven(balls, of, "pocket", law, 1000.0) for of in (None, STIFF, SOFT)}
    speeds = {of: run[0].body("cage").angular_velocity[:, 1] / run[1] for of, run in runs.items()}
    forces = {of: run[0].bearing("b").cage_force for of, run in runs.items()}
    off = {of: np.abs(speeds[of] - speeds[None]).max() for of in (STIFF, SOFT)}
    force = {of: np.abs(forces[of] - forces[None]).max() / np.abs(forces[None]).max() for of in (STIFF, SOFT)}
    print(f"speed off by {off[STIFF]:.2g}, forces by {force[STIFF]:.2g}; soft {off[SOFT]:.2g}, {force[SOFT]:.2g}")
    assert off[STIFF] < 5e-4 and force[STIFF] < 1e-2
    assert off[SOFT] > 10.0 * off[STIFF] and force[SOFT] > 5.0 * force[STIFF]


def test_a_soft_cage_has_the_speed_of_rolling() -> None:
    """Rollers under high load drive it against its drag, all of which the pockets transfer."""
    result, rolling, drag = driven(rollers(), SOFT, "bar", wf.laws.PalmgrenLine(D, 2, damping=2.0), 2000.0)
    late = result.time > 1.5e-3
    speed = result.body("cage").angular_velocity[late, 1].mean() / rolling
    torque = -0.5 * PITCH * result.bearing("b").cage_force[late].sum(axis=1).mean() / drag
    print(f"speed {speed:.6f} of rolling, torque in the pockets {torque:.4f} of the drag")
    assert abs(speed - 1.0) < 1e-3
    assert torque == pytest.approx(1.0, abs=0.05)  # what the cage's inertia still contributes
    assert "cage: deflection against its mean motion at most" in result.bearing("b").report()


RADIUS, THICK, BALL = 24 * MM, 1 * MM, 1.4 * MM  # of a thin ring with windows so small that ring formulas hold
RING = wf.Material(5e9, 0.0, 1350.0, name="without lateral contraction")


def thin(speed: float, damping: float | None) -> tuple[wf.Scene, wf.bearings.Bearing, wf.mesh.Mesh]:
    """A bearing whose cage is a thin ring that rotates with `speed` [rad/s] and touches no ball."""
    mesh = wf.mesh.cage(
        RADIUS - 0.5 * THICK, RADIUS + 0.5 * THICK, WIDTH, pockets=COUNT, pocket_width=1.5 * MM,
        pocket_length=1.5 * MM, around=(4, 1), axial=(2, 1),
    )  # fmt: skip
    scene = wf.Scene()
    body = scene.add_body(reduced(RING, mesh, "pocket", 8), name="cage", damping=damping)
    balls = wf.bearings.BallGeometry(elements=COUNT, ball_diameter=BALL, pitch_diameter=2.0 * RADIUS)
    bearing = scene.add_bearing("b", balls, outer=scene.ground, cage=wf.bearings.PocketCage(0.1 * MM, body=body))
    axle = scene.add(wf.joints.Revolute(scene.ground, bearing.inner, axis=(0, 1, 0), name="axle"))
    inner = 2.0 * speed / (1.0 - 0.5 * BALL / RADIUS)
    scene.add(wf.joints.Drive(axle, inner, name="drive"))
    bearing.roll(inner)
    return scene, bearing, mesh


def test_a_fast_cage_expands() -> None:
    """rho omega^2 R^3/E of a thin ring, and finite elements with the windows, under the centrifugal load."""
    speed = 1000.0
    scene, bearing, mesh = thin(speed, 0.3)
    result = wf.simulate(scene, 3e-3, step=1e-5, progress=False)
    assert result.status == "completed", result.message
    found = np.array([moved[-1, 0] for moved in result.bearing("b").cage_deflection.values()])
    K, M = matrices(mesh, RING)
    out = mesh.points * [1.0, 0.0, 1.0]
    u = splu(sp.csc_matrix(K + M)).solve(speed**2 * (M @ out.reshape(-1)))  # M holds it softly; the load is in balance
    places = {name: np.array([x, 0.0, 0.0]) for name, x in (("pocket_1", RADIUS), ("pocket_5", -RADIUS))}
    full = 0.5 * float(np.subtract(*[(seat(mesh, name, at).T @ u)[0] for name, at in places.items()]))
    ring = RING.density * speed**2 * RADIUS**3 / RING.youngs_modulus
    print(f"{1e6 * found.mean():.5f} um, finite elements {1e6 * full:.5f} um, ring {1e6 * ring:.5f} um")
    np.testing.assert_allclose(found, full, rtol=1e-3)
    assert full == pytest.approx(ring, rel=2e-2)


def test_a_cage_rings_in_its_oval_mode() -> None:
    """Two opposite pockets are struck; sqrt(36/5 E I/(rho A R^4)) of a thin ring, and finite elements."""
    scene, bearing, mesh = thin(0.0, 0.0)
    strike = wf.signals.Table([0.0, 1e-4, 2e-4], [0.0, 0.1, 0.0], hold=True)  # N: pockets keep clear of the balls
    for name, sign in (("pocket_1", 1.0), ("pocket_5", -1.0)):
        scene.add(wf.forces.PointForce(bearing.pockets[name], (strike, (sign, 0, 0)), name=name))
    result = wf.simulate(scene, 1e-2, step=2e-5, progress=False)
    assert result.status == "completed", result.message
    moved = result.bearing("b").cage_deflection
    oval = moved["pocket_1"][:, 0] - moved["pocket_3"][:, 0]
    up = np.flatnonzero((oval[:-1] < 0.0) & (oval[1:] >= 0.0))
    at = result.time[up] - oval[up] * np.diff(result.time)[up] / np.diff(oval)[up]
    found = (len(at) - 1) / (at[-1] - at[0])
    K, M = matrices(mesh, RING)
    squares: Any = eigsh(K, k=7, M=M, sigma=-1e4, return_eigenvectors=False)  # rad2/s2, of six rigid motions first
    full = float(np.sqrt(squares.max()) / (2.0 * np.pi))
    E, rho = RING.youngs_modulus, RING.density
    ring = float(np.sqrt(7.2 * E * THICK**2 / 12.0 / rho) / RADIUS**2 / (2.0 * np.pi))
    print(f"{found:.3f} Hz over {len(at) - 1} periods, finite elements {full:.3f} Hz, ring {ring:.3f} Hz")
    assert found == pytest.approx(full, rel=2e-3)
    assert full == pytest.approx(ring, rel=2e-2)


def test_the_stiffness_of_a_bearing_is_not_that_of_its_cage() -> None:
    """The operator has the walls of the pockets in place, whatever they are fixed to."""
    found = []
    for flexible in (True, False):
        scene, body = wf.Scene(), reduced(SOFT, cage_mesh(window=D + PLAY), "pocket")
        rigid = None if flexible else scene.add_rigid_body(body.mass, body.inertia, name="cage")
        made = rigid or scene.add_body(body, name="cage")
        balls = wf.bearings.BallGeometry(elements=COUNT, ball_diameter=D, pitch_diameter=PITCH, contact_angle=0.4)
        bearing = scene.add_bearing("b", balls, outer=scene.ground, cage=wf.bearings.PocketCage(PLAY, body=made))
        scene.add(wf.joints.Cylindrical(scene.ground, bearing.inner, axis=(0, 1, 0), name="axle"))
        scene.add(wf.forces.PointForce(bearing.inner, (0, 300.0, 0), name="thrust"))
        found.append(wf.equilibrium(scene, progress=False).bearing_stiffness("b").matrix)
    axial = found[1][2, 2]
    assert axial > 1e7
    np.testing.assert_allclose(found[0][2, 2], axial, rtol=1e-6)
