"""What small-sliding contacts do to skins and stresses: compared with full finite elements, a body without the joint,
and closed forms."""

from __future__ import annotations

from functools import lru_cache
from typing import Any

import numpy as np
import pytest
from scipy.spatial import KDTree
from scipy.spatial.transform import Rotation

import warpffrf as wf
from references.small_sliding.cells import facet_cells
from references.small_sliding.full_model import FullModel, Part
from references.small_sliding.sheets import graded_stack
from warpffrf import forces, joints, signals
from warpffrf.model import rotation as rot
from warpffrf.model.mesh import Mesh, box
from warpffrf.offline.fe import assign
from warpffrf.offline.stress.plan import StressPlan
from warpffrf.output.bodies.normal_loads import SmallSlidingLoads
from warpffrf.output.result import Result

STEEL = wf.Material(youngs_modulus=210e9, poisson_ratio=0.3, density=7850.0)
CORK = wf.Material(youngs_modulus=1e9, poisson_ratio=0.0, density=1000.0)
SINGLE = 1e-6  # of the largest: modes and responses of skin and stress are kept in single precision
SOLVED = 1e-6  # of a force: tolerance of an equilibrium
LOAD = 10.0  # N, small as full finite elements are linear: differences are in proportion to it
TURNED = 2e-4  # of the largest: what ends that turn make at it, with their forces
OWN = 5e-3  # of it: what cells yield by themselves, at the least


def in_world(result: Result, body: str, i: int) -> np.ndarray:
    """Displacement (n, 3) [m] of the nodes of a skin since the initial pose at the origin, rigid motion included."""
    skin, motion = result.skins()[body], result.body(body)
    moved = (skin.points + skin.displacement(i)) @ rot.matrix(motion.rotation[i]).T
    return moved + motion.position[i] - skin.points


def on_faces(result: Result, body: str, i: int) -> np.ndarray:
    """Forces (N,) [N] on all cells of a body's small-sliding contacts."""
    found = SmallSlidingLoads(result.history, result.view, body).forces(i)
    assert found is not None
    return found


# --- compared with full finite elements


LINES = (np.array([0.0, 6.0, 11.0, 18.0, 22.0, 30.0]) * 1e-3, np.array([0.0, 5.0, 9.0, 16.0]) * 1e-3, [0.0, 4e-3])
TIP = "x_max"


def sheets() -> list[Mesh]:
    """Two, on grid lines of no order, with a loaded part on the outside of each."""
    lower, upper = graded_stack(LINES, 4e-3, 2)
    return [
        lower.select("press", "z_min", lambda c: c[:, 0] > 0.01),
        upper.select("press", "z_max", lambda c: c[:, 0] > 0.01),
    ]


def points(k: int) -> np.ndarray:
    """Places in sheet k, two of them by and on the face of the small-sliding contact."""
    lower = np.array([[0.02, 0.007, 3.9e-3], [0.013, 0.004, 4e-3], [0.025, 0.012, 2e-3]])
    return lower if k == 0 else lower * [1.0, 1.0, -1.0] + [0.0, 0.0, 8e-3]


@lru_cache(maxsize=1)
def pressed_sheets() -> tuple[Result, np.ndarray, np.ndarray]:
    """The run of two bodies, and the displacements (n, 3 nodes) of full finite elements under the same loads and the
    forces that the run found in the small-sliding contact."""
    meshes = sheets()
    held = [
        wf.reduce(
            mesh,
            STEEL,
            interfaces={"x_min": "rigid", "press": "average", TIP: "average"},
            modes=3,
            contact={"face": wf.surfaces.Matched(first=face)},
            stress={"near": points(k)},
            cache=False,
            progress=False,
        )
        for k, (mesh, face) in enumerate(zip(meshes, ("z_max", "z_min"), strict=True))
    ]
    scene = wf.Scene(gravity=(0.0, 0.0, 0.0))
    bodies = [scene.add_body(body, name=name) for body, name in zip(held, ("lower", "upper"), strict=True)]
    for body in bodies:
        scene.add(joints.Fixed(scene.ground, body["x_min"]))
    scene.add(wf.Contact(bodies[0]["face"], bodies[1]["face"], sliding="small", friction=0.3, name="lap"))
    path = LOAD * np.array(
        [[1, 1, 0, 0, 0], [1, 1, 0.1, 0.1, -0.1], [0.9, 1, 0.3, -0.2, 0.1], [0.9, 1.1, -0.3, -0.2, 0.2]]
    )
    given = [(0, "press", 2, 1.0), (1, "press", 2, -1.0), *((1, TIP, axis, 1.0) for axis in range(3))]
    model = FullModel([Part(mesh, STEEL, ("x_min",)) for mesh in meshes])
    times, columns = np.arange(float(len(path))), []
    for n, (k, name, axis, sign) in enumerate(given):
        direction = sign * np.eye(3)[axis]
        scene.add(forces.PointForce(bodies[k][name], (signals.Table(times, path[:, n]), direction)))
        columns.append(model.spread(k, name, direction))
    run = wf.static(scene, times[-1], step=1.0, progress=False)
    loads = np.stack(columns, axis=1) @ path.T
    cells = facet_cells(model, (0, "z_max"), (1, "z_min"))
    lap = run.contact("lap")
    s = np.concatenate([lap.pressure[:, :, None], -lap.traction], axis=2) * lap.area[:, None]
    u = model.solve(loads + cells.loads @ s.reshape(len(path), -1).T)
    return run, u[: 3 * model.offsets[1]].T, u[3 * model.offsets[1] :].T


@pytest.mark.parametrize(("k", "name"), [(0, "lower"), (1, "upper")])
def test_all_nodes_move_as_those_of_full_finite_elements(k: int, name: str) -> None:
    """With three vibration modes; without what cells yield by themselves displacements are off by a percent or more."""
    run, *full = pressed_sheets()
    mesh = sheets()[k]
    nodes = np.unique(np.concatenate([block.ravel() for block in mesh.outer_facets().blocks.values()]))
    np.testing.assert_array_equal(run.skins()[name].points, mesh.points[nodes])
    assert {0, 1, 2} <= set(run.contact("lap").state.ravel())
    body = run.view.bodies[name].reduced
    for i in range(len(run.time)):
        exact = full[k][i].reshape(-1, 3)[nodes]
        size = np.abs(exact).max()
        found = in_world(run, name, i)
        assert np.abs(found - exact).max() < TURNED * size
        assert np.abs(np.tensordot(on_faces(run, name, i), body.surface.matched, 1)).max() > OWN * size


@pytest.mark.parametrize(("k", "name"), [(0, "lower"), (1, "upper")])
def test_stresses_are_those_of_full_finite_elements(k: int, name: str) -> None:
    run, *full = pressed_sheets()
    mesh = sheets()[k]
    operator = StressPlan(mesh, assign(mesh, STEEL), "near", points(k)).operator()
    exact = (operator @ full[k].T).T.reshape(len(run.time), -1, 6)
    np.testing.assert_allclose(run.stress(name, "near").tensor, exact, atol=TURNED * np.abs(exact).max())


# --- blocks that stick


EDGE, HIGH = 0.02, 0.01  # m
PRESSURE, SHEAR = 2e6, 0.5e4  # Pa


def block(
    material: wf.Material, ends: dict[str, str], face: Any, cells: tuple[int, int, int], size: Any, where: Any
) -> Any:
    return wf.reduce(
        box(size, cells, order=1),
        material,
        interfaces=ends,
        contact={"face": face},
        modes=4,
        stress={"inside": where},
        cache=False,
        progress=False,
    )


def stuck(lower: Any, upper: Any, size: Any, load: Any, turn: Any = (0.0, 0.0, 0.0), spin: float = 0.0) -> Result:
    """One block on the other, with friction that nothing overcomes; the world rotated about its origin by the vector
    `turn` (3,) [rad], the upper block by `spin` [rad] about the normal of its face."""
    whole = Rotation.from_rotvec(turn)
    A, own = whole.as_matrix(), whole * Rotation.from_rotvec([0.0, 0.0, spin])
    scene = wf.Scene(gravity=(0.0, 0.0, 0.0))
    base = scene.add_body(lower, name="lower", position=A @ [0.0, 0.0, -0.5 * size[2]], rotation=whole.as_quat())
    top = scene.add_body(upper, name="upper", position=A @ [0.0, 0.0, 0.5 * size[2]], rotation=own.as_quat())
    scene.add(joints.Fixed(scene.ground, base["z_min"]))
    scene.add(wf.Contact(base["face"], top["face"], sliding="small", friction=50.0, name="lap"))
    scene.add(forces.PointForce(top["z_max"], tuple(A @ load)))
    return wf.equilibrium(scene)


PLACES = np.array([[0.0, 0.0, 0.5], [0.3, -0.2, 0.5], [0.5, 0.5, 0.5], [0.2, 0.1, 0.2], [-0.4, 0.3, -0.1]])  # of size


@lru_cache(maxsize=4)
def patch(by: str, other: int) -> Result:
    """Two blocks of steel that are pressed evenly; `other` cells along the edges of the upper."""
    size, along = (EDGE, EDGE, HIGH), PLACES * [EDGE, EDGE, HIGH]
    lower = block(STEEL, {"z_min": "average"}, wf.surfaces.Matched(first="z_max", by=by), (4, 4, 2), size, along)
    upper = block(
        STEEL,
        {"z_max": "average"},
        wf.surfaces.Matched(first="z_min", by=by),
        (other, other, 2),
        size,
        along * [1, 1, -1],
    )
    return stuck(lower, upper, size, (0.0, 0.0, -PRESSURE * EDGE**2), (0.4, -0.9, 0.2), 0.5 * np.pi)


@pytest.mark.parametrize(("by", "other"), [("facets", 4), ("nodes", 4), ("facets", 8)])
def test_an_even_pressure_is_an_even_stress(by: str, other: int) -> None:
    """sigma_zz = -p alone, on the faces too, and displacements are linear: both blocks widen alike."""
    run = patch(by, other)
    exact = np.array([0.0, 0.0, -PRESSURE, 0.0, 0.0, 0.0])
    strain = PRESSURE / STEEL.youngs_modulus
    for name in ("lower", "upper"):
        tensor = run.stress(name, "inside").tensor[0]
        np.testing.assert_allclose(tensor, np.tile(exact, (len(tensor), 1)), atol=10.0 * SINGLE * PRESSURE)
        skin = run.skins()[name]
        linear = skin.points * [0.3 * strain, 0.3 * strain, -strain]
        apart = skin.displacement(0) - linear
        design = np.concatenate([np.tile(np.eye(3), (len(apart), 1)), _turns(skin.points)], axis=1)
        rest = apart.ravel() - design @ np.linalg.lstsq(design, apart.ravel(), rcond=None)[0]
        assert np.abs(rest).max() < 10.0 * SINGLE * strain * EDGE


def _turns(points: np.ndarray) -> np.ndarray:
    """(3 n, 3): small turns of places."""
    return np.swapaxes(np.cross(np.eye(3)[None], points[:, None, :]), 1, 2).reshape(-1, 3)


@pytest.mark.parametrize(("by", "other"), [("facets", 4), ("nodes", 4), ("facets", 8)])
def test_both_faces_show_the_pressure(by: str, other: int) -> None:
    run = patch(by, other)
    for name, z in (("lower", 0.5 * HIGH), ("upper", -0.5 * HIGH)):
        skin = run.skins()[name]
        on = np.abs(skin.points[:, 2] - z) < 1e-9
        np.testing.assert_allclose(skin.pressure(0), np.where(on, PRESSURE, 0.0), atol=10.0 * SOLVED * PRESSURE)
        np.testing.assert_array_equal(skin.state(0), on)  # all stick
        assert skin.contact_fields == ("pressure", "traction", "state")


@pytest.mark.parametrize("other", [4, 8])
def test_forces_on_both_bodies_cancel(other: int) -> None:
    """And so do their moments, whatever the meshes are."""
    run = patch("facets", other)
    force, moment = np.zeros(3), np.zeros(3)
    for name in ("lower", "upper"):
        body, motion = run.view.bodies[name].reduced, run.body(name)
        face = body.matched["face"]
        A = rot.matrix(motion.rotation[0])
        own = np.einsum("ck,cki->ci", on_faces(run, name, 0).reshape(-1, 3), face.frames) @ A.T
        force += own.sum(axis=0)
        moment += np.cross(face.points @ A.T + motion.position[0], own).sum(axis=0)
    total = PRESSURE * EDGE**2
    assert np.abs(force).max() < 1e-12 * total and np.abs(moment).max() < SOLVED * total * EDGE


LONG, FLAT = 0.08, (0.08, 0.02, 0.004)
HELD = 2e4  # Pa, presses blocks that are sheared; gaps are linear, places turn: shears are of 1e-5


@lru_cache(maxsize=1)
def sheared() -> tuple[Result, Result]:
    """Flat blocks of cork, pressed and sheared; and the same in one piece."""
    load = (SHEAR * LONG * FLAT[1], 0.0, -HELD * LONG * FLAT[1])
    cells, where = (16, 3, 2), np.array([[0.0, 0.0, 0.25], [0.1, 0.2, 0.4], [0.0, 0.0, 0.5]]) * FLAT
    lower = block(CORK, {"z_min": "rigid"}, wf.surfaces.Matched(first="z_max", by="nodes"), cells, FLAT, where)
    upper = block(
        CORK, {"z_max": "rigid"}, wf.surfaces.Matched(first="z_min", by="nodes"), cells, FLAT, where * [1, 1, -1]
    )
    one = wf.reduce(
        box((LONG, FLAT[1], 2.0 * FLAT[2]), (*cells[:2], 4), order=1), CORK, modes=4,
        interfaces={"z_min": "rigid", "z_max": "rigid"}, cache=False, progress=False,
    )  # fmt: skip
    scene = wf.Scene(gravity=(0.0, 0.0, 0.0))
    whole = scene.add_body(one, name="whole")
    scene.add(joints.Fixed(scene.ground, whole["z_min"]))
    scene.add(forces.PointForce(whole["z_max"], load))
    return stuck(lower, upper, FLAT, load), wf.equilibrium(scene)


def test_faces_that_stick_move_together() -> None:
    run, _ = sheared()
    nodes = []
    for name, z in (("lower", 0.5 * FLAT[2]), ("upper", -0.5 * FLAT[2])):
        skin, motion = run.skins()[name], run.body(name)
        on = np.abs(skin.points[:, 2] - z) < 1e-9
        nodes.append(((skin.points + skin.displacement(0)) @ rot.matrix(motion.rotation[0]).T + motion.position[0])[on])
    moved = SHEAR / CORK.youngs_modulus * FLAT[2]
    away, partner = (np.asarray(found) for found in KDTree(nodes[0]).query(nodes[1]))
    assert np.array_equal(np.sort(partner), np.arange(len(partner))) and len(partner) == 17 * 4
    assert away.max() < 10.0 * SINGLE * moved


def test_blocks_that_stick_move_as_one() -> None:
    """Every node of the outside, where the joint of the two is in the middle of a block of the same elements."""
    run, one = sheared()
    skin, motion = one.skins()["whole"], one.body("whole")
    moved = (skin.points + skin.displacement(0)) @ rot.matrix(motion.rotation[0]).T + motion.position[0] - skin.points
    for name, up in (("lower", -0.5 * FLAT[2]), ("upper", 0.5 * FLAT[2])):
        part, at = run.skins()[name], run.body(name)
        places = part.points + [0.0, 0.0, up]
        found = (part.points + part.displacement(0)) @ rot.matrix(at.rotation[0]).T + at.position[0] - places
        away, node = KDTree(skin.points).query(places)
        outside = away < 1e-9
        assert outside.sum() > 0.5 * len(places)
        assert np.abs(found - moved[node])[outside].max() < 10.0 * SINGLE * np.abs(moved).max()


def test_shear_is_even_away_from_the_ends() -> None:
    """Without Poisson's ratio, by St Venant: ends of a flat block are felt as far as it is high."""
    run, _ = sheared()
    for name in ("lower", "upper"):
        tensor = run.stress(name, "inside").tensor[0]
        np.testing.assert_allclose(tensor[:, 5], SHEAR, rtol=0.03)
        np.testing.assert_allclose(tensor[:, 2], -HELD, rtol=0.03)
        skin = run.skins()[name]
        sign = -1.0 if name == "upper" else 1.0
        on = (np.abs(skin.points[:, 2] - sign * 0.5 * FLAT[2]) < 1e-9) & (np.abs(skin.points[:, 0]) < 0.01)
        np.testing.assert_allclose(
            skin.traction(0)[on], np.tile([sign * SHEAR, 0.0, 0.0], (on.sum(), 1)), atol=0.03 * SHEAR
        )
