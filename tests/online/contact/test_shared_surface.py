"""One surface in several pairs: gaps with the loads of all of them, against dense NumPy; convergence; balances."""

from __future__ import annotations

import sys
from dataclasses import replace
from pathlib import Path as FilePath
from typing import Any

import numpy as np
import pytest

from warpffrf.model import forces, joints, surfaces
from warpffrf.model import rotation as rot
from warpffrf.model.contact import Contact
from warpffrf.model.errors import InputError
from warpffrf.model.material import Material
from warpffrf.model.mesh import roller
from warpffrf.model.reduced.body import ReducedBody
from warpffrf.model.scene import Scene
from warpffrf.offline import ContactGrid, reduce
from warpffrf.online import Engine, Settings, find_equilibrium, run
from warpffrf.online.compile import capacity
from warpffrf.online.start.consistent import start_consistently
from warpffrf.online.start.static_equilibrium import settle
from warpffrf_kernels.core import control as k

sys.path.insert(0, str(FilePath(__file__).parents[1]))
from made_bodies import made_body
from reference_contact import Pose, contact_problem, dense_compliance, full_gram
from reference_points import point_problem

SETTINGS = Settings(window_strain=0.5, residual_tolerance=1e-10)
LOAD = 1000e3  # N: some columns wide patches on grids of 3 degrees
AGREE = 1e-8  # of the depth: gaps at rest, by the tolerance above and phases frozen to 2e-7 columns


def stack(
    below: ReducedBody, middle: ReducedBody, above: ReducedBody, *, middle_first: tuple[bool, bool], **options: Any
) -> tuple[Scene, tuple[Contact, Contact]]:
    """Three rollers on top of each other, the lowest clamped, the others on vertical guides, pressed from above."""
    scene = Scene(gravity=(0.0, 0.0, -9.81))
    radii = [body.contact_surfaces["rim"].shape.radius for body in (below, middle, above)]
    heights = np.cumsum([0.0, radii[0] + radii[1], radii[1] + radii[2]])
    bodies = [
        scene.add_body(body, name=name, position=(0.0, 0.0, z))
        for body, name, z in zip((below, middle, above), ("below", "middle", "above"), heights, strict=True)
    ]
    scene.add(joints.Fixed(scene.ground, bodies[0]["bore"], name="clamp"))
    for body in bodies[1:]:
        scene.add(joints.Prismatic(scene.ground, body["bore"], axis=(0, 0, 1), name=f"{body.name} guide"))
    scene.add(forces.PointForce(bodies[2]["bore"], (0.0, 0.0, -LOAD)))
    pairs = []
    for other, first, name in zip((bodies[0], bodies[2]), middle_first, ("low", "high"), strict=True):
        ends = (bodies[1]["rim"], other["rim"]) if first else (other["rim"], bodies[1]["rim"])
        pairs.append(scene.add(Contact(*ends, name=name, **options)))
    return scene, (pairs[0], pairs[1])


@pytest.mark.parametrize("middle_first", [(False, True), (True, True), (False, False), (True, False)])
def test_gaps_are_those_under_the_loads_of_both_pairs(
    plain_body: ReducedBody, other_body: ReducedBody, middle_first: tuple[bool, bool]
) -> None:
    """No gap where there is pressure, none negative elsewhere, with D of the whole middle surface applied at once; the
    part of the other pair is no small one."""
    scene, contacts = stack(plain_body, other_body, plain_body, middle_first=middle_first)
    rest = find_equilibrium(scene, settings=SETTINGS)
    assert rest.status == "completed", rest.message
    surface = scene.body("middle")["rim"].surface
    D, M = dense_compliance(surface), full_gram(surface)
    problems, pressures, on_middle = [], [], []
    for contact, first in zip(contacts, middle_first, strict=True):
        record = rest.contacts[contact.name]
        poses = [
            Pose(m.position[0], rot.matrix(m.rotation[0]), m.modal[0])
            for m in (rest.bodies[port.body.name] for port in contact.ports)
        ]
        columns = record.first_column[0] + np.arange(record.pressure.shape[1])
        problem = contact_problem(
            contact.a.surface, contact.b.surface, poses[0], poses[1], columns,
            theta_points=SETTINGS.theta_points, z_points=SETTINGS.z_points,
        )  # fmt: skip
        s = record.pressure[0].ravel()
        flat = problem.index[:, 0] * contact.a.surface.grid.rows + problem.index[:, 1]
        problems.append(problem)
        pressures.append(s)
        on_middle.append(M[flat] if first else problem.load)  # (nodes, nodes of the middle): psi of each node
    for this, other in ((0, 1), (1, 0)):
        problem, s = problems[this], pressures[this]
        own = problem.gap + problem.G @ s
        crossed = on_middle[this] @ (D @ (on_middle[other].T @ pressures[other]))
        left = (own + crossed) / problem.area
        depth = np.abs(problem.gap / problem.area).max()
        assert np.abs(crossed / problem.area).max() > 1e-4 * depth  # else this test would see nothing
        assert np.abs(left[s > 0.0]).max() < AGREE * depth
        assert left.min() > -AGREE * depth


def test_two_balls_under_a_plate_that_is_an_arc() -> None:
    """The same at points, on a surface that does not close, with partners that do not yield."""
    plane = surfaces.Plane(origin=(0.0, 0.0, -0.02), outward=(0.0, 0.0, -1.0), direction=(0.0, 1.0, 0.0))
    body = made_body(plane, np.linspace(-6e-3, 6e-3, 7), pitch=2e-3, columns=15)
    scene = Scene()
    plate = scene.add_body(body, name="plate")
    scene.add(joints.Fixed(scene.ground, plate["hold"], name="clamp"))
    contacts = []
    for x, depth, name in ((-7e-3, 1.5e-3, "left"), (6e-3, 2e-3, "right")):
        ball = surfaces.Sphere(radius=0.06, axis_point=(x, 0.0, -0.08 + depth), axis_direction=(0.0, 1.0, 0.0))
        port = scene.ground.surface(ball, name=name)
        contacts.append(scene.add(Contact(plate["face"], port, name=name, overlap=1.0)))
    rest = find_equilibrium(scene, settings=SETTINGS)
    assert rest.status == "completed", rest.message
    motion, ground = rest.bodies["plate"], Pose(np.zeros(3), np.eye(3), np.zeros(0))
    pose = Pose(motion.position[0], rot.matrix(motion.rotation[0]), motion.modal[0])
    surface = plate["face"].surface
    D, M, rows = dense_compliance(surface), full_gram(surface), surface.grid.rows
    problems, pressures, grid_nodes = [], [], []
    for contact in contacts:
        record = rest.contacts[contact.name]
        columns = record.first_column[0] + np.arange(record.pressure.shape[1])
        inside = (columns >= 0) & (columns < surface.grid.columns)
        problem = point_problem(
            surface, contact.b.surface, pose, ground, columns[inside],
            theta_points=SETTINGS.theta_points, z_points=SETTINGS.z_points,
        )  # fmt: skip
        problems.append(problem)
        pressures.append(record.pressure[0][inside].ravel())
        grid_nodes.append(M[problem.index[:, 0] * rows + problem.index[:, 1]])
    for this, other in ((0, 1), (1, 0)):
        problem, s = problems[this], pressures[this]
        crossed = grid_nodes[this] @ (D @ (grid_nodes[other].T @ pressures[other]))
        left = (problem.gap + problem.G @ s + crossed) / problem.area
        depth = np.abs(problem.gap / problem.area).max()
        assert (s > 0.0).sum() >= 4 and np.abs(crossed / problem.area).max() > 1e-2 * depth
        assert np.abs(left[s > 0.0]).max() < AGREE * depth
        assert left.min() > -AGREE * depth


def test_a_pair_twice_is_refused(plain_body: ReducedBody) -> None:
    scene, (low, _) = stack(plain_body, plain_body, plain_body, middle_first=(False, True))
    with pytest.raises(InputError, match="in contact already, as 'low'"):
        scene.add(Contact(low.b, low.a, name="again"))


MU = 0.3
OMEGA = 10.0  # rad/s
STEP = 2e-4  # s
ROLLING_LOAD = 300e3  # N
ROUND_OFF = 1e-10  # of the largest displacement: sums of some hundred terms, differences of the two surfaces


@pytest.fixture(scope="module")
def rubbing_body() -> ReducedBody:
    mesh = roller(0.05, 0.015, 0.01, sectors=120, layers=4, axial=2, grading=1.6, order=1)
    return reduce(
        mesh, Material(210e9, 0.3, 7850.0), interfaces={"bore": "rigid"}, contact={"rim": surfaces.Cylinder()}, modes=4,
        grid=ContactGrid(tangential=True, contact_fixed=False), cache=False, progress=False,
    )  # fmt: skip


def train(body: ReducedBody, middle_first: tuple[bool, bool], friction: tuple[float, float]) -> Scene:
    """A driven roller between two others that it carries along, off a straight line: the patches stand at 120 degrees
    of the middle roller's rim. The outer ones are pressed on along guides."""
    scene = Scene(gravity=(0.0, 0.0, 0.0))
    middle = scene.add_body(body, name="middle", angular_velocity=(0.0, OMEGA, 0.0))
    hinge = scene.add(joints.Revolute(scene.ground, middle["bore"], axis=(0, 1, 0), name="hinge"))
    scene.add(joints.Drive(hinge, OMEGA, quantity="velocity"))
    for angle, name, first, mu in zip((-60.0, 60.0), ("low", "high"), middle_first, friction, strict=True):
        out = np.array([np.cos(np.radians(angle)), 0.0, np.sin(np.radians(angle))])
        other = scene.add_body(body, name=name, position=0.1 * out, angular_velocity=(0.0, -0.99 * OMEGA, 0.0))
        carriage = scene.add_rigid_body(1.0, (1e-3, 1e-3, 1e-3), name=f"{name} carriage", position=0.1 * out)
        center = carriage.at((0, 0, 0))
        axle = scene.add(joints.Revolute(center, other["bore"], axis=(0, 1, 0), name=f"{name} axle"))
        scene.add(joints.Drive(axle, -0.99 * OMEGA, quantity="velocity"))
        scene.add(joints.Prismatic(scene.ground, center, axis=out, name=f"{name} guide"))
        scene.add(forces.PointForce(center, -ROLLING_LOAD * out))
        ends = (middle["rim"], other["rim"]) if first else (other["rim"], middle["rim"])
        scene.add(Contact(*ends, friction=mu, name=name))
    return scene


def dense_forces(engine: Engine, number: int) -> tuple[np.ndarray, np.ndarray]:
    """Loads of a pair on its surface `number`: inward normal ones (nodes,) and tangential ones (2, columns, rows) [N]
    on all nodes of its grid."""
    m, x, s = engine.compiled.model, engine.scratch, engine.state
    pair, side = divmod(number, 2)
    grid = engine.scene.contacts[pair].ports[side].surface.grid
    half = m.window.second_half if side else m.window.half
    columns = (int(x.center.numpy()[0, pair, side]) - half + np.arange(2 * half + 1)) % grid.columns
    normal, along = np.zeros((grid.columns, grid.rows)), np.zeros((2, grid.columns, grid.rows))
    size = len(columns) * grid.rows
    if side:
        pressed = x.second_load.numpy()[0, pair, :size].reshape(-1, grid.rows)
        rubbed = x.second_force.numpy()[0, pair, : 2 * size].reshape(-1, 2, grid.rows)
    else:
        pressed = (s.pressure.numpy() * s.active.numpy())[0, pair, :size].reshape(-1, grid.rows)
        area = x.cell_area.numpy()[0, pair, :size].reshape(-1, 1, grid.rows)
        rubbed = area * s.traction.numpy()[0, pair, : 2 * size].reshape(-1, 2, grid.rows)
    assert len(np.unique(columns)) == len(columns)
    normal[columns] = pressed
    along[:, columns] = rubbed.transpose(1, 0, 2)
    if not side:
        surface = engine.scene.contacts[pair].a.surface
        normal = (full_gram(surface) @ normal.ravel()).reshape(normal.shape)
    return normal.ravel(), along


@pytest.mark.parametrize("middle_first", [(False, True), (True, True), (False, False)])
@pytest.mark.parametrize("friction", [(MU, MU), (MU, 0.0)])
def test_cells_and_gaps_move_by_the_loads_of_both_pairs(
    rubbing_body: ReducedBody, middle_first: tuple[bool, bool], friction: tuple[float, float]
) -> None:
    """Differences of displacement of the cells, and openings of the gaps, by the local modes in a rolling step, against
    dense operators of whole surfaces under the loads of all pairs."""
    scene = train(rubbing_body, middle_first, friction)
    engine = Engine(scene)
    assert settle(engine)
    engine.initial_rates()
    start_consistently(engine)
    engine.control(every=1)
    engine.enter(k.DYNAMIC, STEP, target=6)
    engine.replay(24)
    assert engine.word("step")[0] == 6 and not engine.word("status").any()
    m, x = engine.compiled.model, engine.scratch
    loads = [dense_forces(engine, number) for number in range(4)]
    places = [(port.body.name, port.name) for contact in scene.contacts for port in contact.ports]
    surface: Any = rubbing_body.contact_surfaces["rim"]
    tangential, grid = surface.tangential, surface.grid
    every = np.arange(grid.columns)
    D_nt, D_tt = tangential.coupling(every, every), tangential.compliance(every)
    D, M = dense_compliance(surface), full_gram(surface)
    shape = (2, grid.columns, grid.rows)

    def displaced(number: int) -> tuple[np.ndarray, np.ndarray]:
        """Normal (nodes,) inward and tangential (2, columns, rows) displacement of the surface."""
        same = [n for n in range(4) if places[n] == places[number]]
        normal, along = (np.sum([loads[n][part] for n in same], axis=0) for part in (0, 1))
        return D @ normal - D_nt @ along.ravel(), (D_tt @ along.ravel() - D_nt.T @ normal).reshape(shape)

    centers = x.center.numpy()[0]
    for pair in range(2):
        low, high = x.window.numpy()[0, pair] + m.window.half
        columns = (centers[pair, 0] - m.window.half + np.arange(m.window.columns)) % grid.columns
        second = (centers[pair, 1] - m.window.second_half + np.arange(m.window.second_columns)) % grid.columns
        (n_a, t_a), (n_b, t_b) = displaced(2 * pair), displaced(2 * pair + 1)
        inside = slice(low, high + 1)
        grid_nodes = engine.state.active.numpy()[0, pair].reshape(m.window.columns, -1)[:, : grid.rows] != 0
        weak = (M @ n_a).reshape(grid.columns, grid.rows)[columns]
        stencil = x.stencil.numpy()[0, pair].reshape(
            m.window.columns, grid.rows, m.window.stencil_columns, m.window.stencil_rows
        )
        at = x.stencil_at.numpy()[0, pair].reshape(m.window.columns, grid.rows, 2)
        on_b = n_b.reshape(grid.columns, grid.rows)[second]
        opened = (x.opened.numpy() - x.gap.numpy())[0, pair].reshape(m.window.columns, grid.rows)
        for j, row in np.argwhere(grid_nodes):
            c, r = at[j, row]
            held = (
                stencil[j, row]
                * np.pad(on_b, ((0, 9), (0, 9)))[c : c + m.window.stencil_columns, r : r + m.window.stencil_rows]
            )
            assert opened[j, row] == pytest.approx(weak[j, row] + held.sum(), rel=ROUND_OFF)
        if friction[pair] == 0.0:
            continue
        turn = x.cell_turn.numpy()[0, pair].reshape(m.window.columns, grid.rows, 2, 2)
        share = x.share.numpy()[0, pair].reshape(
            m.window.columns, grid.rows, m.window.share_columns, m.window.share_rows
        )
        share_at = x.share_at.numpy()[0, pair].reshape(m.window.columns, grid.rows, 2)
        found = x.elastic_local.numpy()[0, pair].reshape(m.window.columns, 2, grid.rows)[inside]
        expected = t_a[:, columns].transpose(1, 0, 2)[inside].copy()
        wide = np.pad(t_b[:, second], ((0, 0), (0, 9), (0, 9)))
        for j in range(low, high + 1):
            for row in range(grid.rows):
                c, r = share_at[j, row]
                if share[j, row].any():
                    part = wide[:, c : c + m.window.share_columns, r : r + m.window.share_rows]
                    expected[j - low, :, row] -= turn[j, row] @ (share[j, row] * part).sum(axis=(1, 2))
        loaded = x.bound.numpy()[0, pair].reshape(m.window.columns, grid.rows)[inside].any(axis=1)
        assert loaded.sum() >= 2
        np.testing.assert_allclose(found[loaded], expected[loaded], atol=ROUND_OFF * np.abs(expected).max(), rtol=0.0)


def test_friction_on_both_sides_of_a_roller_takes_energy_and_converges(rubbing_body: ReducedBody) -> None:
    history = run(
        train(rubbing_body, (False, True), (MU, MU)), 20 * STEP, step=STEP, start="equilibrium", progress=False
    )
    assert history.status == "completed", history.message
    assert history.counters["rejected_steps"] == 0
    work = np.diff(history.energy["friction"])
    assert work.max() <= 1e-7 * np.abs(work).max() and work.min() < 0.0
    for name in ("low", "high"):
        contact = history.contacts[name]
        size = np.linalg.norm(contact.force, axis=1)
        assert np.abs(contact.force + contact.force_second).max() < 1e-6 * size.max()


def test_room_for_nodes_grows_without_a_trace(rubbing_body: ReducedBody, monkeypatch: pytest.MonkeyPatch) -> None:
    """A run that begins with room for a single hat of each pair gives the numbers of one that never is short, bit for
    bit; and a capacity that is asked for stays."""
    scene = train(rubbing_body, (False, True), (MU, MU))
    plain = run(scene, 6 * STEP, step=STEP, start="equilibrium", progress=False)
    monkeypatch.setattr(capacity, "LEAST_SLOTS", 1)
    monkeypatch.setattr(capacity, "USUAL_PATCH", 10**6)
    assert Engine(scene).compiled.model.capacity.slots == 3
    grown = run(scene, 6 * STEP, step=STEP, start="equilibrium", progress=False)
    assert plain.status == grown.status == "completed"
    assert grown.counters["rejected_steps"] == plain.counters["rejected_steps"]
    for name in ("low", "high"):
        assert np.array_equal(plain.contacts[name].pressure, grown.contacts[name].pressure)
        assert np.array_equal(plain.contacts[name].force, grown.contacts[name].force)
    for contact in scene.contacts:
        contact.capacity = 1
    short = run(scene, STEP, step=STEP, start="equilibrium", progress=False)
    assert short.status == "capacity" and "raise capacity" in short.message


def test_two_surfaces_of_one_body_are_named(rubbing_body: ReducedBody) -> None:
    """What a surface does to another one of its body by local modes is left out: the report says so."""
    rim = rubbing_body.contact_surfaces["rim"]
    twice = replace(rubbing_body, contact_surfaces={"rim": rim, "other": replace(rim, name="other")})
    scene = Scene()
    body = scene.add_body(twice, name="body")
    for name, height in (("rim", -0.05), ("other", 0.05)):
        plane = surfaces.Plane(origin=(0.0, 0.0, height), outward=(0.0, 0.0, -np.sign(height)))
        scene.add(Contact(body[name], scene.ground.surface(plane, name=f"under {name}"), name=name, grid="body_fixed"))
    assert any("'body': its contact surfaces other, rim" in note for note in Engine(scene).compiled.notes)


def test_a_pair_that_never_touches_does_not_keep_the_others_from_rest(
    plain_body: ReducedBody, other_body: ReducedBody
) -> None:
    """The outer rollers of a stack as a third pair, a roller's diameter apart: the first step of the equilibrium, long
    and with nothing closed, would carry one through the other."""
    scene, _ = stack(plain_body, other_body, plain_body, middle_first=(False, False))
    alone = find_equilibrium(scene)
    scene.add(Contact(scene.body("below")["rim"], scene.body("above")["rim"], name="far"))
    rest = find_equilibrium(scene)
    assert rest.status == "completed", rest.message
    assert np.all(rest.contacts["far"].force == 0.0)
    for name in ("low", "high"):
        np.testing.assert_allclose(rest.contacts[name].force, alone.contacts[name].force, atol=1e-8 * LOAD)
