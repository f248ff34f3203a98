"""Bolted columns against the bolt diagram: a tightened bolt takes k_b/(k_b + k_c) of a load under head and nut.

Columns without Poisson's ratio between planes that stay plane deform like springs, k = E A/l, exactly: the frame that
is clamped, k_c, and the shank, k_b. The bolt is the shank of the mesh with a pretension section, a spring between two
interfaces of one body, or one between those of two bodies.
"""

from __future__ import annotations

import re
from typing import Any

import numpy as np
import pytest

from warpffrf.model import forces, joints, signals
from warpffrf.model import rotation as rot
from warpffrf.model.errors import InputError
from warpffrf.model.material import Material
from warpffrf.model.mesh import FacetSet, Mesh, grid
from warpffrf.model.reduced.body import ReducedBody
from warpffrf.model.scene import Scene
from warpffrf.offline import ReductionOptions, reduce
from warpffrf.online import GeneralizedAlpha, Settings, find_equilibrium, run
from warpffrf.online.stages import Stage
from warpffrf.output.modes_result import eigenmodes
from warpffrf.output.options import RunOptions
from warpffrf.output.simulate import equilibrium, simulate, static

E, LENGTH = 210e9, 20e-3
MATERIAL = Material(E, 0.0, 7800.0)
LINES = np.array([0.0, 5.0, 10.0, 20.0, 25.0, 30.0]) * 1e-3  # a shank of 10 x 10 mm, air around it, walls
HEIGHT = np.array([0.0, 10.0, 20.0, 30.0, 40.0]) * 1e-3  # a plate, the length that is clamped, a plate
BOLT, COLUMN = E * 1e-4 / LENGTH, E * 5e-4 / LENGTH  # N/m
TIGHT, LOAD = 2e4, 9e3  # N: F_0 and F_A
SHARE = BOLT / (BOLT + COLUMN)
EXACT = 1e-8  # relative: tolerance of static states and of dense solutions behind the reduction
AT_REST = 1e-6  # relative: what is left of a transient


def clamp(*, shank: bool, height: np.ndarray = HEIGHT) -> Mesh:
    """Plates on walls, and a shank between them or not; "nut" and "head" are the planes where the plates begin, or the
    ends of one that has no plate there."""
    filled = np.ones((5, 5, len(height) - 1), dtype=bool)
    clear = (height[:-1] >= HEIGHT[1]) & (height[1:] <= HEIGHT[3])
    filled[1:4, 1:4, clear] = False
    filled[2, 2, clear] = shank
    mesh = grid(LINES, LINES, height, filled=filled, order=1)
    sets = {}
    for name, z in (("nut", max(HEIGHT[1], height[0])), ("head", min(HEIGHT[3], height[-1]))):
        cells, (low, up) = mesh.cells["hex8"], ((0, 3, 2, 1), (4, 5, 6, 7))
        face = np.array(low if name == "nut" else up)
        inside = (mesh.points[cells].mean(axis=1)[:, 2] > HEIGHT[1]) & (
            mesh.points[cells].mean(axis=1)[:, 2] < HEIGHT[3]
        )
        at = inside & np.all(np.abs(mesh.points[cells[:, face], 2] - z) < 1e-9, axis=1)
        sets[name] = FacetSet({"quad4": cells[at][:, face]})
    return Mesh(mesh.points, mesh.cells, sets)


@pytest.fixture(scope="module")
def cut() -> ReducedBody:
    mesh = clamp(shank=True).cut("shank", point=(15e-3, 15e-3, 20e-3), normal=(0, 0, 1), radius=8e-3)
    interfaces = {"nut": "rigid", "head": "rigid", "shank_low": "average", "shank_high": "average"}
    return reduce(mesh, MATERIAL, interfaces=interfaces, modes=4, cache=False)


@pytest.fixture(scope="module")
def column() -> ReducedBody:
    return reduce(
        clamp(shank=False),
        MATERIAL,
        interfaces={"nut": "rigid", "head": "rigid"},
        modes=4,
        cache=False,
        options=ReductionOptions(stiffening=True),
    )


def held(body: ReducedBody, **options: Any) -> tuple[Scene, Any]:
    """The body with its nut on the ground."""
    scene = Scene()
    b = scene.add_body(body, name="clamp", damping=0.7, **options)
    scene.add(joints.Fixed(scene.ground.at(b["nut"].world_point()), b["nut"], name="foot"))
    return scene, b


def tightened(body: ReducedBody, load: Any = 0.0, force: Any = TIGHT, lock_at: float | None = None) -> Scene:
    """The body with its shank under pretension."""
    scene, b = held(body)
    section = scene.add(joints.Prismatic(b["shank_low"], b["shank_high"], axis=(0, 0, 1), name="section"))
    scene.add(forces.Pretension(section, force, lock_at=lock_at, name="bolt"))
    scene.add(forces.PointForce(b["head"], (load, (0, 0, 1)), name="load"))
    return scene


def sprung(body: ReducedBody, load: float = LOAD) -> Scene:
    """The column with a spring for the bolt, whose preload F_0 is what is left when the column has yielded."""
    scene, b = held(body)
    axis = scene.add(joints.Prismatic(b["nut"], b["head"], axis=(0, 0, 1), name="axis"))
    preload = TIGHT * (BOLT + COLUMN) / COLUMN
    scene.add(forces.JointSpringDamper(axis, BOLT, preload=preload, name="bolt"))
    scene.add(forces.PointForce(b["head"], (load, (0, 0, 1)), name="load"))
    return scene


def tension(history: Any, row: int = -1) -> float:
    return -float(history.forces["bolt"].force[row, 2])


def test_pretension_shortens_the_shank_and_compresses_the_column(cut: ReducedBody) -> None:
    history = find_equilibrium(tightened(cut))
    assert history.status == "completed", history.message
    assert tension(history) == pytest.approx(TIGHT, rel=EXACT)
    shortening = -history.forces["bolt"].deformation[-1, 0]
    assert shortening == pytest.approx(TIGHT * (1.0 / BOLT + 1.0 / COLUMN), rel=EXACT)
    np.testing.assert_allclose(history.joints["section"].coordinate[-1], -shortening, rtol=1e-12)
    np.testing.assert_allclose(history.joints["foot"].force[-1], 0.0, atol=EXACT * TIGHT)


def test_a_force_that_stays_carries_none_of_the_load(cut: ReducedBody) -> None:
    """Without a lock the bolt is its force; the column alone takes the load."""
    history = find_equilibrium(tightened(cut, LOAD))
    head = history.bodies["clamp"].modal[-1] @ cut.interfaces["head"].modes[:, 2]
    nut = history.bodies["clamp"].modal[-1] @ cut.interfaces["nut"].modes[:, 2]
    assert tension(history) == pytest.approx(TIGHT, rel=EXACT)
    assert head - nut == pytest.approx((LOAD - TIGHT) / COLUMN, rel=EXACT)


def test_bolt_diagram_of_a_locked_section(cut: ReducedBody) -> None:
    scene = tightened(cut, signals.SmoothStep(0.0, LOAD, duration=1e-4), lock_at=0.0)
    history = run(scene, 4e-4, step=2e-6, start="equilibrium", integrator=GeneralizedAlpha(0.8), progress=False)
    assert history.status == "completed", history.message
    assert tension(history, 0) == pytest.approx(TIGHT, rel=EXACT)
    assert tension(history) == pytest.approx(TIGHT + LOAD * SHARE, rel=AT_REST)
    length = history.forces["bolt"].deformation[:, 0]
    assert np.ptp(length) < 1e-12 * LENGTH
    books = history.energy
    work = LOAD * LOAD / (BOLT + COLUMN)
    assert np.abs(books["numerical"]).max() < 0.02 * work  # of some steps a period of the stiffest modes


def test_bolt_diagram_of_a_spring_between_places_of_one_body(column: ReducedBody) -> None:
    assert tension(find_equilibrium(sprung(column, 0.0))) == pytest.approx(TIGHT, rel=EXACT)
    history = find_equilibrium(sprung(column))
    assert tension(history) == pytest.approx(TIGHT + LOAD * SHARE, rel=EXACT)
    stretched = history.joints["axis"].coordinate[-1]
    assert stretched == pytest.approx((LOAD - tension(history)) / COLUMN, rel=EXACT)


def test_bolt_diagram_of_a_spring_between_two_bodies() -> None:
    """Halves of the column, fixed to each other; the bolt leads from the nut of one to the head of the other."""
    scene, halves = Scene(), []
    for name, height in (("lower", HEIGHT[:3]), ("upper", HEIGHT[2:])):
        body = reduce(
            clamp(shank=False, height=height),
            MATERIAL,
            interfaces={"nut": "rigid", "head": "rigid"},
            modes=3,
            cache=False,
        )
        halves.append(scene.add_body(body, name=name, damping=0.7))
    lower, upper = halves
    scene.add(joints.Fixed(scene.ground.at(lower["nut"].world_point()), lower["nut"]))
    scene.add(joints.Fixed(lower["head"], upper["nut"], name="between"))
    axis = scene.add(joints.Prismatic(lower["nut"], upper["head"], axis=(0, 0, 1)))
    scene.add(forces.JointSpringDamper(axis, BOLT, preload=TIGHT * (BOLT + COLUMN) / COLUMN, name="bolt"))
    scene.add(forces.PointForce(upper["head"], (0.0, 0.0, LOAD)))
    history = find_equilibrium(scene)
    assert history.status == "completed", history.message
    assert tension(history) == pytest.approx(TIGHT + LOAD * SHARE, rel=EXACT)
    pressed = -history.joints["between"].force[-1, 2]  # on the upper half, which is pressed down on the lower
    assert abs(pressed) == pytest.approx(TIGHT - LOAD * (1.0 - SHARE), rel=EXACT)


def test_shortening_of_a_bar_that_a_spring_ties(column: ReducedBody) -> None:
    """A preload F and a stiffness k between the ends of a bar: it is shortened by F L/(E A + k L)."""
    scene, b = held(column)
    scene.add(forces.SpringDamper(b["nut"], b["head"], BOLT, free_length=LENGTH - TIGHT / BOLT, name="tie"))
    history = find_equilibrium(scene)
    area, tie = COLUMN * LENGTH / E, BOLT
    expected = TIGHT * LENGTH / (E * area + tie * LENGTH)
    assert LENGTH - history.forces["tie"].deformation[-1, 0] == pytest.approx(expected, rel=1e-7)


@pytest.mark.parametrize("level", ["constant", "full"])
def test_rows_on_one_body_leave_a_free_body_its_momentum(column: ReducedBody, level: str) -> None:
    scene = Scene()
    b = scene.add_body(
        column,
        name="clamp",
        inertia=level,
        damping=0.05,
        velocity=(3.0, -2.0, 1.0),
        angular_velocity=(40.0, -70.0, 90.0),
    )
    axis = scene.add(joints.Cylindrical(b["nut"], b["head"], axis=(0, 0, 1), point=(0.03, 0.0, 0.01)))
    scene.add(forces.JointSpringDamper(axis, BOLT, 50.0, coordinate="translation", preload=TIGHT))
    scene.add(forces.Bushing(b["nut"], b["head"], [1e7] * 3 + [300.0] * 3, point=(0.0, 0.05, 0.0)))
    scene.add(forces.SpringDamper(b["nut"], b["head"], 1e7, free_length=0.015))
    history = run(
        scene, 2e-3, step=1e-5, integrator=GeneralizedAlpha(0.9), progress=False,
        settings=Settings(residual_tolerance=1e-11),
    )  # fmt: skip
    assert history.status == "completed", history.message
    body = history.bodies["clamp"]
    assert np.abs(body.modal[-1]).max() > 1e-8  # it has been pressed together
    A = np.array([rot.matrix(q) for q in body.rotation])
    center = body.velocity + np.cross(body.angular_velocity, A @ column.center_of_mass)
    assert np.abs(center - center[0]).max() < 1e-10 * np.abs(center).max()


def test_natural_frequencies_with_a_spring_between_places_of_one_body(column: ReducedBody) -> None:
    """omega^2 of diag(omega_i^2) + k c c^T, c the modes' stretch; rigid motion stays free."""
    scene = Scene()
    b = scene.add_body(column, name="clamp", damping=0.0)
    scene.add(forces.Bushing(b["nut"], b["head"], [0.0, 0.0, BOLT, 0.0, 0.0, 0.0], point=(15e-3, 15e-3, 20e-3)))
    lever = np.array([15e-3, 15e-3, 20e-3])
    c = np.zeros(len(column.frequencies))
    for sign, name in ((1.0, "head"), (-1.0, "nut")):
        modes = column.interfaces[name].modes
        c += sign * (modes[:, 2] + np.cross(modes[:, 3:], lever - column.interfaces[name].point)[:, 2])
    K = np.diag((2.0 * np.pi * column.frequencies) ** 2) + BOLT * np.outer(c, c)
    expected = np.sqrt(np.linalg.eigvalsh(K)) / (2.0 * np.pi)
    found = eigenmodes(scene, count=6 + len(expected)).frequencies
    np.testing.assert_allclose(np.sort(found)[6:], expected, rtol=1e-6)


@pytest.mark.slow
def test_natural_frequencies_of_a_section_that_pulls_and_of_one_that_is_locked(cut: ReducedBody) -> None:
    """A pull leaves the section free, a lock holds it as a weld does; a small one, which stiffens nothing."""
    scene = tightened(cut, force=1.0, lock_at=0.0)
    locked = simulate(scene, 2e-6, step=1e-6, start="equilibrium", progress=False)
    welded, free = held(cut), held(cut)
    welded[0].add(joints.Fixed(welded[1]["shank_low"], welded[1]["shank_high"], axis=(0, 0, 1)))
    free[0].add(joints.Prismatic(free[1]["shank_low"], free[1]["shank_high"], axis=(0, 0, 1)))
    for found, (expected, _) in ((eigenmodes(scene, count=8), free), (eigenmodes(scene, 8, about=locked), welded)):
        np.testing.assert_allclose(found.frequencies, eigenmodes(expected, count=8).frequencies, rtol=1e-5)


def test_a_locked_section_stays_locked_through_checkpoints_and_stages(cut: ReducedBody, tmp_path: Any) -> None:
    """Tightened, locked and loaded in one run, in two, and in stages with a force that differs: the same in the end."""
    load = signals.SmoothStep(0.0, LOAD, duration=1e-4, delay=1.2e-4)
    scene = tightened(cut, load, signals.SmoothStep(0.0, TIGHT, duration=5e-5), lock_at=1e-4)
    options: dict[str, Any] = dict(options=RunOptions(integrator=GeneralizedAlpha(0.8)), progress=False)
    whole = simulate(scene, 4e-4, step=2e-6, **options)
    first = simulate(scene, 1.4e-4, step=2e-6, **options)
    second = simulate(scene, 2.6e-4, step=2e-6, start=first, **options)
    np.testing.assert_array_equal(second.force("bolt").force[-1], whole.force("bolt").force[-1])
    section = scene.joint("section")
    stages = [
        Stage("tighten", 1.4e-4, 2e-6),
        Stage("load", 2.6e-4, 2e-6, {"forces": {"bolt": forces.Pretension(section, 0.0)}}),
    ]
    staged = simulate(scene, stages, **options)
    np.testing.assert_allclose(staged.force("bolt").force[-1], whole.force("bolt").force[-1], rtol=1e-9)
    locked = whole.force("bolt").deformation[whole.time > 1e-4, 0]
    assert np.ptp(locked) < 1e-12 * LENGTH
    rest = -float(whole.force("bolt").force[np.argmin(np.abs(whole.time - 1.2e-4)), 2])
    assert tension(whole.history) == pytest.approx(rest + LOAD * SHARE, rel=1e-3)


def test_refusals(cut: ReducedBody) -> None:
    scene, b = held(cut)
    section = scene.add(joints.Prismatic(b["shank_low"], b["shank_high"], axis=(0, 0, 1), name="section"))
    with pytest.raises(InputError, match=r"both ports are clamp\['nut'\]; take two interfaces"):
        joints.Prismatic(b["nut"], b["nut"], axis=(0, 0, 1))
    with pytest.raises(InputError, match="a length that joint 'foot'|is fixed and has no coordinate"):
        forces.Pretension(scene.joint("foot"), TIGHT)
    turning = scene.add(joints.Revolute(b["nut"], b["shank_low"], axis=(0, 0, 1), point=(0, 0, 0), name="turning"))
    with pytest.raises(InputError, match="leaves no length free; take a Prismatic joint"):
        forces.Pretension(turning, TIGHT)
    scene.add(joints.Drive(section, 0.0, quantity="position", name="hold"))
    with pytest.raises(InputError, match="is driven already, by 'hold'"):
        scene.add(forces.Pretension(section, TIGHT))


def test_a_preload_without_a_load_path_is_named(column: ReducedBody) -> None:
    scene, b = held(column)
    cap = scene.add_rigid_body(0.1, (1e-5, 1e-5, 1e-5), name="cap", position=b["head"].world_point())
    axis = scene.add(joints.Prismatic(b["head"], cap.at((0, 0, 0)), axis=(0, 0, 1), name="axis"))
    spring = scene.add(forces.JointSpringDamper(axis, BOLT, preload=TIGHT, name="spring"))
    told = r"spring.*no load path, only joint 'axis' connects 'clamp' and 'cap'; add the contact or joint"
    assert re.search(told, scene.check().loose_preloads["spring"])
    assert re.search(told, str(scene.check()))
    assert find_equilibrium(scene).status == "completed"  # the spring alone finds its length
    spring.preload = 0.0
    assert not scene.check().loose_preloads
    scene.add(forces.Pretension(axis, TIGHT, name="bolt"))
    assert not scene.check().loose_preloads  # the spring is the column that the bolt presses together
    rest = find_equilibrium(scene)
    assert rest.joints["axis"].coordinate[-1] == pytest.approx(-TIGHT / BOLT, rel=EXACT)
    spring.stiffness, spring.damping = 0.0, 1.0  # a damper holds nothing at rest
    with pytest.raises(InputError, match="equilibrium: pretension 'bolt': its tension has no load path"):
        find_equilibrium(scene)
    scene.add(forces.Bushing(b["nut"], cap.at((0, 0, 0)), [COLUMN] * 6, point=b["head"].world_point()))
    assert not scene.check().loose_preloads
    assert find_equilibrium(scene).status == "completed"


STIFF = 1e6  # N/m: of a column that a bolt without mass presses
PULL = 1e3  # N


def pressed(column: str, force: Any = PULL, lock_at: float | None = None) -> Scene:
    """A head on a spring, drawn to the ground by a bolt; loaded away from it from 0.5 s on."""
    scene = Scene(gravity=(0, 0, 0))
    head = scene.add_rigid_body(1.0, (0.01,) * 3, name="head")
    axis = scene.add(joints.Prismatic(scene.ground, head.at((0, 0, 0)), axis=(0, 0, 1), name="axis"))
    if column == "bushing":
        stiffness, damping = [1e9, 1e9, *[STIFF] * 4], [0.0, 0.0, 2e3, 0.0, 0.0, 0.0]
        scene.add(forces.Bushing(scene.ground, head.at((0, 0, 0)), stiffness, damping, name="column"))
    else:
        scene.add(forces.JointSpringDamper(axis, STIFF, 2e3, name="column"))
    scene.add(forces.Pretension(axis, force, lock_at=lock_at, name="bolt"))
    pull = signals.Table([0.0, 0.5, 1.0], [0.0, 0.0, 600.0])
    scene.add(forces.PointForce(head.at((0, 0, 0)), (pull, (0, 0, 1)), name="pull"))
    return scene


STATIC_WAYS = {
    "run": {"duration": 1.0, "step": 0.125},
    "stages": {"duration": [Stage("tighten", 0.5, 0.125, kind="static"), Stage("pull", 0.5, 0.125, kind="static")]},
    "static, then in time": {"duration": [Stage("tighten", 0.5, 0.125, kind="static"), Stage("pull", 0.5, 1e-3)]},
    "in time, then static": {"duration": [Stage("tighten", 0.5, 1e-3), Stage("pull", 0.5, 0.125, kind="static")]},
    "from an equilibrium": {"duration": 1.0, "step": 0.125, "start": True},
}


@pytest.mark.parametrize(("way", "column"), [*((way, "bushing") for way in STATIC_WAYS), ("run", "spring")])
def test_a_bolt_locks_in_static_runs(way: str, column: str) -> None:
    """Locked at 0.5 s its length stays F/k, and a bolt that is rigid by itself takes the whole load."""
    scene = pressed(column, lock_at=0.5)
    options = dict(STATIC_WAYS[way])
    if "start" in options:
        options["start"] = equilibrium(scene, friction=True, progress=False)
    result = (static if "step" in options else simulate)(scene, progress=False, **options)
    assert result.status == "completed", result.message
    assert not any("halved" in note for note in result.history.notes)
    after = result.time >= 0.5 - 1e-9
    expected = PULL + 600.0 * (result.time[after] - 0.5) / 0.5
    close = AT_REST if "time" in way else EXACT
    np.testing.assert_allclose(-result.force("bolt").force[after, 2], expected, rtol=close)
    np.testing.assert_allclose(result.body("head").position[after, 2], -PULL / STIFF, rtol=close)


def test_a_tension_that_grows_is_followed_in_static_runs() -> None:
    """The bolt pulls with F(t), and the work of the last force is what an equilibrium may rise by."""
    scene = pressed("spring", signals.Table([0.0, 0.5], [0.0, PULL], hold=True), lock_at=0.5)
    result = static(scene, 1.0, step=0.125, progress=False)
    assert result.status == "completed", result.message
    expected = np.interp(result.time, [0.0, 0.5, 1.0], [0.0, PULL, PULL + 600.0])
    np.testing.assert_allclose(-result.force("bolt").force[:, 2], expected, rtol=EXACT, atol=EXACT * PULL)


def test_friction_in_a_joint_between_places_of_one_body(cut: ReducedBody) -> None:
    """The section rubs: its tension is less by the friction while it tightens, where modes carry inertia, too."""
    bound = 0.2 * TIGHT
    scene, b = held(cut, inertia="full")
    section = scene.add(joints.Prismatic(b["shank_low"], b["shank_high"], axis=(0, 0, 1), name="section"))
    scene.add(forces.Pretension(section, signals.SmoothStep(0.0, TIGHT, duration=4e-3), name="bolt"))
    scene.add(forces.PrismaticFriction(section, 0.0, load_independent=bound, name="rub"))
    history = run(scene, 4.4e-3, step=2e-5, integrator=GeneralizedAlpha(0.8), progress=False)
    assert history.status == "completed", history.message
    shortening = -history.joints["section"].coordinate
    at = int(np.argmin(np.abs(history.time - 2e-3)))  # half-way, where it slips
    assert shortening[at] == pytest.approx((0.5 * TIGHT - bound) * (1.0 / BOLT + 1.0 / COLUMN), rel=0.01)
    assert shortening[-1] == pytest.approx((TIGHT - bound) * (1.0 / BOLT + 1.0 / COLUMN), rel=AT_REST)
    assert np.abs(history.forces["rub"].force[:, 2]).max() <= bound * (1.0 + 1e-6)
