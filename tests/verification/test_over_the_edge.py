"""Patches that run off a body, with friction: a tilted roller over its end, a ball over an edge and over a corner."""

from __future__ import annotations

import numpy as np
import pytest

from warpffrf.model import joints, signals, surfaces
from warpffrf.model.contact import Contact
from warpffrf.model.mesh import box, roller
from warpffrf.model.reduced_body import ReducedBody
from warpffrf.model.scene import Scene
from warpffrf.offline import reduce
from warpffrf.output.result import Result
from warpffrf.output.simulate import simulate
from warpffrf.verification.scenes.rollers import CARRIAGE_INERTIA, CARRIAGE_MASS, STEEL

FRICTION, TILT = 0.2, 5e-4  # rad
ACROSS = (0.0, 1.0, 0.0)
REACTION = 1e-10
BOUNDED = 2.5  # of the peak of the whole patch: half of the material is gone at an edge, three quarters at a corner
STEP = 2e-4  # s
GAIN = 1e-9


@pytest.fixture(scope="module")
def slab() -> ReducedBody:
    mesh = box((0.02, 0.02, 0.008), (12, 12, 4), center=(0.0, 0.0, -0.004), order=1)
    top = surfaces.Plane(origin=(0.0, 0.0, 0.0), outward=(0.0, 0.0, 1.0), direction=ACROSS)
    return reduce(
        mesh, STEEL, interfaces={"z_min": "rigid"}, contact={"z_max": top}, modes=0,
        tangential=True, patch_grid=False, cache=False,
        progress=False,
    )  # fmt: skip


def judged(result: Result) -> tuple[np.ndarray, np.ndarray]:
    """Force (T,) and peak (T,); pressures, reaction and friction as they must be."""
    assert result.status == "completed", result.message
    c = result.history.contacts["pair"]
    F, peak = np.linalg.norm(c.force, axis=1), c.pressure.max(axis=(1, 2))
    assert c.pressure.min() >= 0.0
    assert np.isfinite(c.pressure).all()
    assert np.abs(c.force + c.force_second).max() < REACTION * F.max()
    work = result.energy["friction"]
    assert np.all(np.diff(work) <= GAIN * abs(work[-1]))
    print(
        f"largest peak over the first {peak.max() / peak[0]:.2f}, rejected {result.history.counters['rejected_steps']}"
    )
    return F, peak


@pytest.mark.parametrize("way", [(1.0, 0.0), (0.0, 1.0), (0.8, 0.8), (-1.0, 0.3)])
def test_a_ball_slides_over_edge_and_corner(slab: ReducedBody, way: tuple[float, float]) -> None:
    """A rigid ball, 40 um deep, leaves the slab over each kind of its edges, and over the corner."""
    radius = 0.06
    place = (0.0, 0.0, radius - 40e-6)
    scene = Scene()
    block = scene.add_body(slab, name="slab")
    scene.add(joints.Fixed(scene.ground, block["z_min"], name="hold"))
    shape = surfaces.Sphere(radius=radius, axis_point=(0.0, 0.0, 0.0), axis_direction=ACROSS)
    ball = scene.add_rigid_body(
        CARRIAGE_MASS, CARRIAGE_INERTIA, name="ball", position=place, surfaces={"face": shape}
    )  # fmt: skip
    along = np.array([*way, 0.0])
    slide = scene.add(joints.Prismatic(scene.ground, ball.at((0.0, 0.0, 0.0)), axis=along, name="slide"))
    path = signals.SmoothStep(0.0, 0.0135 * float(np.linalg.norm(along)), duration=0.02)
    scene.add(joints.Drive(slide, path, quantity="position"))
    scene.add(Contact(block["z_max"], ball["face"], friction=FRICTION, name="pair", overlap=1.0))
    result = simulate(scene, 0.02, step=STEP, start="equilibrium", progress=False)
    F, peak = judged(result)
    assert F[0] > 1e3 and F[-1] == 0.0
    assert peak.max() < BOUNDED * peak[0]


def test_a_tilted_roller_runs_off_its_end() -> None:
    """Tilted by 0.5 mrad against a rigid plate that it slides along until it has left it over its end, and turning."""
    mesh = roller(0.05, 0.015, 0.02, sectors=180, layers=4, axial=10, grading=1.6, order=1)
    body = reduce(
        mesh, STEEL, interfaces={"bore": "rigid"}, contact={"rim": surfaces.Cylinder()}, modes=0,
        tangential=True, patch_grid=False,
        cache=False, progress=False,
    )  # fmt: skip
    scene = Scene()
    tilted = (np.sin(0.5 * TILT), 0.0, 0.0, np.cos(0.5 * TILT))
    turning = scene.add_body(body, name="roller", rotation=tilted)
    # a short rigid roller below, barrelled, so that it ends nowhere itself
    partner = surfaces.CrownedCylinder(
        radius=0.05, crown_radius=0.5, axis_point=(0.0, 0.0, -0.1 + 60e-6), axis_direction=ACROSS
    )
    scene.add(
        Contact(
            turning["rim"], scene.ground.surface(partner, name="barrel"), friction=FRICTION, name="pair", overlap=1.0
        )
    )
    carriage = scene.add_rigid_body(CARRIAGE_MASS, CARRIAGE_INERTIA, name="carriage")
    center = carriage.at((0.0, 0.0, 0.0))
    axis = (0.0, np.cos(TILT), np.sin(TILT))
    slide = scene.add(joints.Prismatic(scene.ground, center, axis=ACROSS, name="slide"))
    axle = scene.add(joints.Revolute(center, turning["bore"], axis=axis, name="axle"))
    scene.add(joints.Drive(slide, signals.SmoothStep(0.0, 0.022, duration=0.02), quantity="position"))
    scene.add(joints.Drive(axle, signals.SmoothStep(0.0, 1.0, duration=0.02), quantity="position"))
    result = simulate(scene, 0.02, step=STEP, start="equilibrium", progress=False)
    F, peak = judged(result)
    assert F[0] > 1e3 and F[-1] == 0.0
    assert peak.max() < BOUNDED * peak[0]
