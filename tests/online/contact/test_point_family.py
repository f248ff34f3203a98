"""Contact at points, solved: dense NumPy solutions, the line of centres, edges, and two patches in a window."""

from __future__ import annotations

import sys
from pathlib import Path as FilePath
from typing import Any

import numpy as np
import pytest

from scenes.rollers import STEEL, Path, StaticPath, prescribed_pair, roller_body
from warpffrf.model import joints, surfaces
from warpffrf.model import rotation as rot
from warpffrf.model.contact import Contact
from warpffrf.model.mesh import roller
from warpffrf.model.reduced.body import ReducedBody
from warpffrf.model.scene import Scene
from warpffrf.offline import reduce
from warpffrf.online import Settings
from warpffrf.output.result import Result

sys.path.insert(0, str(FilePath(__file__).parents[1]))
from made_bodies import made_body
from partner_scenes import PAIR, pressed, solved
from reference_contact import Pose, Problem
from reference_points import point_problem

ACROSS = (0.0, 1.0, 0.0)  # axis of the rollers
AGREE = 1e-8  # the engine stops at 1e-10 of forces and penetration; one pressure among many may be off by more
REACTION = 1e-12


def cylinder(kind: Any, radius: float, height: float, direction: Any = ACROSS, **others: Any) -> Any:
    return kind(radius=radius, axis_point=(0.0, 0.0, height), axis_direction=direction, **others)


# below a roller of 50 mm around the origin
PARTNERS = {
    "plane": surfaces.Plane(origin=(0.0, 0.0, -0.05), outward=(0.0, 0.0, 1.0), direction=ACROSS),
    "skew plane": surfaces.Plane(origin=(0.0, 0.0, -0.05), outward=(0.0, 0.0, 1.0), direction=(0.4, 1.0, 0.0)),
    "tilted plane": surfaces.Plane(origin=(0.0, 0.0, -0.05), outward=(0.0, 5e-4, 1.0), direction=ACROSS),
    "cylinder": cylinder(surfaces.Cylinder, 0.03, -0.08),
    "crossed cylinder": cylinder(surfaces.Cylinder, 0.05, -0.1, (1.0, 0.1, 0.0)),
    "bore": cylinder(surfaces.Bore, 0.08, 0.03),
    "ball": cylinder(surfaces.Sphere, 0.06, -0.11),
    "cone": cylinder(surfaces.Cone, 0.06, -0.11, half_angle=0.02),
    "groove": cylinder(surfaces.Groove, 0.05, -0.1, (1.0, 0.0, 0.0), groove_radius=0.08),
}


@pytest.fixture(scope="module")
def fine_rows() -> ReducedBody:
    """Eleven rows of nodes 2 mm apart, 2.1 mm around: patches of points too are seen by some of them."""
    return roller_body(150, layers=4, axial=10, grading=1.6, order=1, max_frequency=12e3, cache=False)


@pytest.fixture(scope="module")
def ring_body() -> ReducedBody:
    """A ring with a contact surface inside, held outside; its grid matches no roller's."""
    mesh = roller(0.075, 0.055, 0.024, sectors=96, layers=3, axial=4, grading=1.0)
    return reduce(
        mesh, STEEL, interfaces={"rim": "rigid"}, contact={"bore": surfaces.Bore()}, max_frequency=12e3, cache=False,
        progress=False,
    )  # fmt: skip


def pose(result: Result, name: str, i: int) -> Pose:
    motion = result.history.bodies[name]
    return Pose(motion.position[i], rot.matrix(motion.rotation[i]), motion.modal[i])


def contact_of(result: Result) -> Any:
    scene: Any = result.history.scene
    return scene.contacts[0]


def dense(result: Result, i: int = 0) -> tuple[Problem, np.ndarray, np.ndarray]:
    """The reference problem of the pose of row i on the window, its pressures, and the engine's."""
    contact = contact_of(result)
    history = result.history.contacts[PAIR]
    grid = contact.a.surface.grid
    active = np.flatnonzero(history.pressure[i].any(axis=1))
    low, high = max(active[0] - 3, 0), min(active[-1] + 4, history.pressure.shape[1])
    columns = history.first_column[i] + np.arange(low, high)
    if not grid.periodic:
        inside = (columns >= 0) & (columns < grid.columns)
        columns, low, high = columns[inside], low + int(np.argmax(inside)), low + int(np.argmax(inside)) + inside.sum()
    ground = Pose(np.zeros(3), np.eye(3), np.zeros(0))
    second = ground if contact.b.rigid else pose(result, "second", i)
    problem = point_problem(
        contact.a.surface, contact.b.surface, pose(result, "first", i), second, columns, theta_points=3, z_points=2
    )
    return problem, problem.pressures(), history.pressure[i, low:high].ravel()


def assert_solution(result: Result, i: int = 0) -> Problem:
    """Pressures, force and torque of row i are those of the dense solution; action equals reaction."""
    assert result.status == "completed", result.message
    c = result.history.contacts[PAIR]
    problem, exact, found = dense(result, i)
    assert (exact > 0.0).sum() >= 4 and np.array_equal(exact > 0.0, found > 0.0)
    worst = np.abs(exact - found).max() / exact.max()
    print(f"{(exact > 0.0).sum()} active, pressures agree to {worst:.1e}")
    assert worst < AGREE
    wrench = found @ problem.wrench
    F = np.linalg.norm(wrench[:3])
    assert np.abs(wrench[:3] - c.force[i]).max() < AGREE * F
    assert np.abs(wrench[3:] - c.torque[i]).max() < AGREE * F * 0.05
    assert np.abs(c.force[i] + c.force_second[i]).max() < REACTION * F
    if not contact_of(result).b.rigid:
        assert (found @ problem.load).sum() == pytest.approx(c.load_second[i].sum(), rel=1e-12)
    return problem


@pytest.mark.parametrize("name", list(PARTNERS))
def test_on_rigid_shapes(name: str, fine_rows: ReducedBody) -> None:
    """At two angles of the roller: the dense solution, no torque about the axle, and the ground's reaction."""
    result = solved(pressed(fine_rows, PARTNERS[name], [500e-6, 500e-6], angle=[0.02, 0.9]), 2)
    for i in range(2):
        assert_solution(result, i)
    c = result.history.contacts[PAIR]
    F = np.linalg.norm(c.force, axis=1)
    motion = result.history.bodies["first"]  # the user origin lies on the roller's axis, its y axis
    axes = np.array([rot.matrix(q)[:, 1] for q in motion.rotation])
    assert np.abs(np.sum(c.torque * axes, axis=1)).max() < 1e-14 * F.max()
    # about the world's origin, where the ground's moments are taken
    about = c.torque + np.cross(motion.position, c.force)
    assert np.abs(about + c.torque_second).max() < REACTION * F.max() * 0.05


def test_pin_in_a_flexible_bore(fine_rows: ReducedBody, ring_body: ReducedBody) -> None:
    """Two grids that never match, one inside the other."""
    scene = pressed(fine_rows, ring_body, 150e-6, angle=0.03, second_surface="bore", second_interface="rim")
    assert_solution(solved(scene, 1))


def test_bore_over_a_rigid_pin(ring_body: ReducedBody) -> None:
    """The inside surface carries the grid."""
    pin = cylinder(surfaces.Cylinder, 0.05, 0.0)
    scene = pressed(ring_body, pin, 150e-6, surface="bore", interface="rim", position=(0.0, 0.0, 1e-3))
    result = solved(scene, 1)
    assert_solution(result)
    assert result.history.contacts[PAIR].force[0, 2] > 0.0  # pushed down onto the pin, the ring is pushed up


@pytest.mark.slow
def test_two_patches_merge() -> None:
    """A flexible slab on a rigid bar with two humps: two patches apart in one window, then one; the dense solution all
    the way, there and back."""
    slab = made_body(
        surfaces.Plane(origin=(0.0, 0.0, 0.0), outward=(0.0, 0.0, -1.0), direction=ACROSS),
        np.linspace(-4e-3, 4e-3, 7), pitch=1.2e-3, columns=31,
    )  # fmt: skip
    z = np.linspace(-0.03, 0.03, 61)
    bar = surfaces.ProfiledCylinder(
        radius=0.2, axis_point=(0.0, 0.0, -0.2), axis_direction=(1.0, 0.0, 0.0),
        table=np.stack([z, 20e-6 * (1.0 + np.cos(2.0 * np.pi * z / 0.016)) + 0.5 * z**2]),
    )  # fmt: skip
    approach = [40e-6, 60e-6, 120e-6, 60e-6, 40e-6]
    result = solved(pressed(slab, bar, approach, surface="face", interface="hold"), 5)
    patches = []
    for i in range(5):
        assert_solution(result, i)
        column = result.history.contacts[PAIR].pressure[i].any(axis=1).astype(int)
        patches.append(int((np.diff(np.concatenate([[0], column])) == 1).sum()))
    assert patches[0] == patches[-1] == 2 and patches[2] == 1
    force = np.linalg.norm(result.history.contacts[PAIR].force, axis=1)
    assert force[[3, 4]] == pytest.approx(force[[1, 0]], rel=1e-8)


def test_families_agree(fine_rows: ReducedBody) -> None:
    """Two rollers, gaps along the line of centres and at points: they differ by the square of half-width over radius,
    by which the one gap is longer and the pressure leans."""
    radius, differences = 0.05, []
    for approach in (40e-6, 160e-6, 640e-6):
        scene = prescribed_pair(fine_rows, fine_rows, Path.of([approach], 0.021, -0.013))
        force = []
        for points in (False, True):
            settings = Settings(window_strain=0.3, residual_tolerance=1e-10, force_points=points)
            result = Result(StaticPath(scene, settings=settings).solve(1))
            assert result.status == "completed", result.message
            (c,) = result.history.contacts.values()
            force.append(np.linalg.norm(c.force[0]))
            wide = c.pressure[0].any(axis=1).sum()
        half = 0.5 * (wide + 1) * contact_of(result).a.surface.grid.pitch * radius
        differences.append((abs(force[1] / force[0] - 1.0), (half / radius) ** 2))
    print(differences)
    for difference, expected in differences:
        assert difference < expected


def test_both_families_in_one_scene(fine_rows: ReducedBody) -> None:
    """A pair on the line of centres and a roller on the ground, far apart: each as if it were alone, although they
    share windows."""

    def on_the_ground(scene: Scene) -> Any:
        turned = (0.0, np.sin(0.2), 0.0, np.cos(0.2))
        third = scene.add_body(fine_rows, name="third", position=(1.0, 0.0, 0.0), rotation=turned)
        plane = surfaces.Plane(origin=(1.0, 0.0, -0.05 + 300e-6), outward=(0.0, 0.0, 1.0), direction=ACROSS)
        scene.add(joints.Fixed(scene.ground, third["bore"], name="held"))
        return scene.add(Contact(third["rim"], scene.ground.surface(plane, name="floor"), name=PAIR, overlap=1.0))

    def pair() -> Scene:
        return prescribed_pair(fine_rows, fine_rows, Path.of([200e-6], 0.021, -0.013))

    both, alone = pair(), Scene()
    on_the_ground(both)
    on_the_ground(alone)
    together = solved(both, 1).history
    assert together.status == "completed", together.message
    for name, scene in ((pair().contacts[0].name, pair()), (PAIR, alone)):
        single, found = solved(scene, 1).history.contacts[name], together.contacts[name]
        assert found.force[0] == pytest.approx(single.force[0], rel=1e-8, abs=1e-6 * abs(single.force[0]).max())
        assert found.approach[0] == pytest.approx(single.approach[0], abs=1e-12)
        assert found.active_nodes[0] == single.active_nodes[0] > 10
