"""A roller on rigid ground: Hertz's line contact, rolling, reaction, tilt, and patches that run off an end."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from scenes.rollers import CARRIAGE_INERTIA, CARRIAGE_MASS, STEEL, StaticPath, roller_body
from warpffrf.model import joints, signals, surfaces
from warpffrf.model import rotation as rot
from warpffrf.model.contact import Contact
from warpffrf.model.reduced.body import ReducedBody
from warpffrf.model.scene import Scene
from warpffrf.online import Settings
from warpffrf.output.result import Result
from warpffrf.output.simulate import simulate

RADIUS = 0.05
ACROSS = (0.0, 1.0, 0.0)
MODULUS = STEEL.youngs_modulus / (1.0 - STEEL.poisson_ratio**2)  # E* where one body alone deforms, plane strain
HALF_WIDTH_ERROR, PEAK_ERROR = 0.02, 0.01  # promised at 4 or more elements in a half-width
REACTION = 1e-12
ENERGY = 1e-3  # of the energy stored: the defects of the grid and of the steps over forty rows of points
TORQUE = 1e-12  # of force times radius


def grounded(body: ReducedBody, shape: Any, approach: Any, angle: Any = 0.0, *, along: Any = (0.0, 0.0, -1.0)) -> Scene:
    """The roller on a driven axle along y, moved by `approach` (n,) [m] along `along` from its place in the world and
    rotated by `angle` (n,) [rad]; state i at time i. `shape` is a surface of the ground."""
    scene = Scene()
    roller = scene.add_body(body, name="roller")
    scene.add(Contact(roller["rim"], scene.ground.surface(shape, name="face"), name="pair", overlap=1.0))
    place = roller["bore"].world_point()
    carriage = scene.add_rigid_body(CARRIAGE_MASS, CARRIAGE_INERTIA, name="carriage", position=place)
    center = carriage.at((0.0, 0.0, 0.0))
    guide = scene.add(joints.Prismatic(scene.ground, center, axis=along, name="guide"))
    axle = scene.add(joints.Revolute(center, roller["bore"], axis=ACROSS, name="axle"))
    approach, angle = np.broadcast_arrays(np.atleast_1d(np.asarray(approach, float)), angle)
    times = np.arange(len(approach) + 1.0)
    for joint, values in ((guide, approach), (axle, angle)):
        table = signals.Table(times, np.append(values, values[-1]))
        scene.add(joints.Drive(joint, table, quantity="position"))
    return scene


def states(scene: Scene, count: int, strain: float) -> Result:
    return Result(StaticPath(scene, settings=Settings(window_strain=strain)).solve(count))


def line_at_middle(result: Result, i: int) -> tuple[float, float, float]:
    """Line load [N/m], half-width [m] (twice the root of the second moment) and largest pressure [Pa] at mid-width.

    Nodes are linear: int y^2 psi_j dy = h (y_j^2 + h^2/6).
    """
    history = result.history.contacts["pair"]
    scene: Any = result.history.scene
    grid = scene.contacts[0].a.surface.grid
    h = grid.pitch * RADIUS
    p = history.pressure[i, :, grid.rows // 2]
    y = h * np.arange(len(p))
    load = h * p.sum()
    middle = h * (p @ y) / load
    second = h * (p @ ((y - middle) ** 2 + h**2 / 6.0)) / load
    return load, 2.0 * np.sqrt(second), p.max()


def test_hertz_on_a_plane(fine_body: ReducedBody) -> None:
    """5 elements in a half-width, 6 angles in a pitch: half-width and peak follow the line load found, the force is
    constant, the ground reacts, and no torque turns the roller."""
    pitch = fine_body.contact_surfaces["rim"].grid.pitch
    angle = 0.3 + np.append(pitch * np.arange(6) / 6.0, 2.0)
    plane = surfaces.Plane(origin=(0.0, 0.0, -RADIUS), outward=(0.0, 0.0, 1.0), direction=ACROSS)
    result = states(grounded(fine_body, plane, np.full(7, 150e-6), angle), 7, 0.09)
    assert result.status == "completed", result.message
    c = result.history.contacts["pair"]
    for i in range(7):
        load, half_width, peak = line_at_middle(result, i)
        a = np.sqrt(4.0 * load * RADIUS / (np.pi * MODULUS))
        p0 = 2.0 * load / (np.pi * a)
        elements = a / (2.0 * np.pi * RADIUS / 720)
        print(f"{elements:.2f} elements, half-width {half_width / a - 1.0:.2%}, peak {peak / p0 - 1.0:.2%}")
        assert elements > 4.0
        assert abs(half_width / a - 1.0) < HALF_WIDTH_ERROR
        assert abs(peak / p0 - 1.0) < PEAK_ERROR + 0.5 * (0.25 / elements) ** 2  # the parabola between two nodes
    F = np.linalg.norm(c.force, axis=1)
    assert np.ptp(F) / F.mean() < 1.5e-3  # promised at 4 elements
    assert np.abs(c.force + c.force_second).max() < REACTION * F.max()
    motion = result.history.bodies["roller"]
    axes = np.array([rot.matrix(q)[:, 1] for q in motion.rotation])
    assert np.abs(np.sum(c.torque * axes, axis=1)).max() < TORQUE * F.max() * RADIUS
    about = c.torque + np.cross(motion.position, c.force)  # about the world's origin, as the ground's
    assert np.abs(about + c.torque_second).max() < REACTION * F.max() * RADIUS
    assert c.approach == pytest.approx(np.full(7, 150e-6), rel=0.2)  # the rim follows the bore, but for the modes


@pytest.mark.parametrize(
    "radius", [0.055, pytest.param(0.08, marks=pytest.mark.slow), pytest.param(0.4, marks=pytest.mark.slow)]
)
def test_hertz_in_a_bore(fine_body: ReducedBody, radius: float) -> None:
    """1/R = 1/R_1 - 1/R_2: the closer the fit, the wider the patch. Hertz's half-plane is right to (a/R_1)^2 of the
    pressure, in a bore the more so as a grows."""
    effective = 1.0 / (1.0 / RADIUS - 1.0 / radius)
    bore = surfaces.Bore(radius=radius, axis_point=(0.0, 0.0, radius - RADIUS), axis_direction=ACROSS)
    deep = 2.2e-3**2 / (2.0 * effective)  # of the undeformed overlap with the half-width of 5 elements
    result = states(grounded(fine_body, bore, 2.2 * deep, 0.3), 1, 0.09 * RADIUS / effective)
    assert result.status == "completed", result.message
    load, half_width, peak = line_at_middle(result, 0)
    a = np.sqrt(4.0 * load * effective / (np.pi * MODULUS))
    p0 = 2.0 * load / (np.pi * a)
    print(f"R_2 = {radius}: a/R {a / RADIUS:.3f}, half-width {half_width / a - 1.0:.2%}, peak {peak / p0 - 1.0:.2%}")
    bound = HALF_WIDTH_ERROR + (a / RADIUS) ** 2
    assert abs(half_width / a - 1.0) < bound
    assert abs(peak / p0 - 1.0) < PEAK_ERROR + bound


def test_a_ball_leaves_over_the_end() -> None:
    """A rigid ball under the roller, which slides along its axis until the patch has run off its end: pressures stay
    non-negative and bounded, the force falls to zero, no energy is lost, and no step fails."""
    body = roller_body(180, layers=4, axial=14, grading=1.6, order=1, max_frequency=12e3, cache=False)
    ball = surfaces.Sphere(radius=0.06, axis_point=(0.0, 0.0, -RADIUS - 0.06 + 150e-6), axis_direction=ACROSS)
    scene = Scene()
    roller = scene.add_body(body, name="roller")
    scene.add(Contact(roller["rim"], scene.ground.surface(ball, name="ball"), name="pair", overlap=1.0))
    carriage = scene.add_rigid_body(CARRIAGE_MASS, CARRIAGE_INERTIA, name="carriage")
    center = carriage.at((0.0, 0.0, 0.0))
    slide = scene.add(joints.Prismatic(scene.ground, center, axis=ACROSS, name="slide"))
    scene.add(joints.Revolute(center, roller["bore"], axis=ACROSS, name="axle"))
    scene.add(joints.Drive(slide, signals.SmoothStep(0.0, 0.016, duration=0.02), quantity="position"))
    result = simulate(scene, 0.02, step=1e-4, start="equilibrium", progress=False)
    assert result.status == "completed", result.message
    c = result.history.contacts["pair"]
    F = np.linalg.norm(c.force, axis=1)
    peak = c.pressure.max(axis=(1, 2))
    assert c.pressure.min() >= 0.0
    assert F[0] > 1e3 and F[-1] == 0.0
    assert peak.max() < 1.6 * peak[0]  # at the end the material yields on one side only
    # what the drive gets back is what the contact and the modes had stored: the axial force of the edge on the ball
    stored = result.energy["contact"][0] + result.energy["strain"][0]
    lost = stored + result.energy["drive_work"][-1]
    print(f"stored {stored:.3g} J, lost {lost / stored:.1e}")
    assert abs(lost) < ENERGY * stored
    assert np.abs(c.force + c.force_second).max() < REACTION * F.max()
