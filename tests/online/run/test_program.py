"""The program of a step: launches by name, participants and their order, and scratch that carries nothing over."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import warp as wp

import warpffrf as wf
from launch_order.check import bound_of, complaints
from scenes.rollers import guided_pair, roller_body
from warpffrf.model import laws
from warpffrf.model.friction import Stribeck
from warpffrf.model.integrators import GeneralizedAlpha
from warpffrf.model.reduced.body import ReducedBody
from warpffrf.offline.contact.cubature import choose_sampling
from warpffrf.online import Engine, Settings
from warpffrf.online.arrays import Scratch, State
from warpffrf.online.arrays.axes import NAMES
from warpffrf.online.arrays.declaration import Arrays, numbers_of
from warpffrf.online.arrays.ring import Ring, SavedRows
from warpffrf.online.arrays.table import markdown, topics
from warpffrf.online.compile.constants import Constants
from warpffrf.online.start.consistent import start_consistently
from warpffrf.online.start.static_equilibrium import settle
from warpffrf.online.step import phases, snapshot
from warpffrf.online.step.launches import DECLARED, blocks, threads
from warpffrf.online.step.phases import Participant
from warpffrf.online.step.program import PARTICIPANTS, WHOLE
from warpffrf_kernels.bodies import membrane, motion
from warpffrf_kernels.core import control as k
from warpffrf_kernels.core.declaration import Declaration, integers, parts, reals, vectors
from warpffrf_kernels.core.model import Model

STEP, STEPS = 2e-5, 8
IMPACT_STEP = 1e-4  # s: a step that is taken again, with impulsive pairs
POISON = {wp.float64: np.nan, wp.vec3d: np.nan, wp.mat33d: np.nan, wp.quatd: np.nan, wp.int32: 3}

Bodies = dict[str, ReducedBody]


@pytest.fixture(scope="module")
def bodies(plain_body: ReducedBody, other_body: ReducedBody, crowned_body: ReducedBody) -> Bodies:
    rim = plain_body.contact_surfaces["rim"]
    few = replace(plain_body, contact_surfaces={"rim": replace(rim, sampling=choose_sampling(rim, 0.01))})
    rubbing = roller_body(
        120, layers=4, axial=2, grading=1.6, order=1, max_frequency=15e3, tangential=True, contact_fixed=False,
            cache=False
    )  # fmt: skip
    patched = {
        name: wf.reduce(
            wf.mesh.roller(0.05, 0.015, 0.02, sectors=36, layers=2, axial=2, order=1), wf.Material(modulus, nu, 7850.0),
            interfaces={"bore": "rigid"}, contact={"rim": wf.surfaces.Cylinder()}, max_frequency=12e3,
            grid=wf.ContactGrid(tangential=True, contact_fixed=True), cache=False, progress=False,
        )
        for name, modulus, nu in (("patched", 210e9, 0.3), ("softer", 70e9, 0.34))
    }  # fmt: skip
    bore = wf.reduce(
        wf.mesh.sleeve(0.025, 0.035, 0.02, sectors=16, order=1, axial=4), wf.Material(210e9, 0.3, 7850.0),
        interfaces={"outside": "rigid"}, contact={"bore": wf.surfaces.Bore()}, modes=4, cache=False, progress=False,
    )  # fmt: skip
    made = {"plain": plain_body, "other": other_body, "crowned": crowned_body, "few": few, "rubbing": rubbing}
    shaft = wf.reduce(
        wf.mesh.roller(0.025 - 25e-6, 0.015, 0.02, sectors=16, layers=2, order=1, axial=4),
        wf.Material(210e9, 0.3, 7850.0), interfaces={"bore": "rigid"}, contact={"rim": wf.surfaces.Cylinder()},
        modes=4, cache=False, progress=False,
    )  # fmt: skip
    return made | patched | {"bore": bore, "shaft": shaft}


def pendulum(bodies: Bodies) -> wf.Scene:
    """Two links: no contact, so that the retained matrix is factored sparsely."""
    scene = wf.Scene()
    links = [
        scene.add_rigid_body(1.0, (1e-2, 1e-2, 1e-2), name=name, position=(x, 0.0, 0.0))
        for name, x in (("one", 0.1), ("two", 0.3))
    ]
    scene.add(wf.joints.Revolute(scene.ground, links[0].at((-0.1, 0, 0)), axis=(0, 1, 0), name="hinge"))
    scene.add(wf.joints.Revolute(links[0].at((0.1, 0, 0)), links[1].at((-0.1, 0, 0)), axis=(0, 1, 0), name="elbow"))
    return scene


def rubbing_pendulum(bodies: Bodies) -> wf.Scene:
    """The same, one joint slipping, the other holding."""
    scene = pendulum(bodies)
    hinge, elbow = scene.joints
    scene.add(wf.forces.RevoluteFriction(hinge, 0.2, pin_radius=0.01, name="slips"))
    scene.add(wf.forces.RevoluteFriction(elbow, 0.0, load_independent=10.0, name="sticks"))
    return scene


def layered(bodies: Bodies) -> wf.Scene:
    scene = guided_pair(bodies["plain"], bodies["other"], speed=60.0, ramp=0.02)
    scene.contacts[0].law = laws.HuntCrossley(1e15, 1.5, damping=50.0)
    return scene


def few_points(bodies: Bodies) -> wf.Scene:
    scene = guided_pair(bodies["few"], bodies["other"], speed=60.0, ramp=0.02)
    scene.contacts[0].quadrature = "reduced"
    return scene


def rolling(bodies: Bodies, second: str, friction: Any = 0.3) -> wf.Scene:
    """Friction on cells that travel with the patch, soon by half a strip a step."""
    scene = guided_pair(bodies["patched"], bodies[second], load=20e3, speed=60.0, ramp=1e-4, friction=friction)
    scene.contacts[0].grid, scene.contacts[0].cells = "contact_fixed", (7, 7)
    return scene


def rolling_ball(bodies: Bodies) -> wf.Scene:
    """A rigid ball that is pressed on a roller, which turns and travels along its axis: rows follow."""
    scene = wf.Scene()
    carriage = scene.add_rigid_body(1.0, (1e-2,) * 3, name="carriage")
    roller = scene.add_body(bodies["patched"], name="roller")
    slide = scene.add(wf.joints.Prismatic(scene.ground, carriage.at((0, 0, 0)), axis=(0, 1, 0)))
    axle = scene.add(wf.joints.Revolute(carriage.at((0, 0, 0)), roller["bore"], axis=(0, 1, 0)))
    for joint, speed in ((slide, 1.0), (axle, 20.0)):
        scene.add(wf.joints.Drive(joint, wf.signals.SmoothStep(0.0, speed, duration=1e-4), quantity="velocity"))
    ball = scene.add_rigid_body(0.3, (5e-5,) * 3, name="ball", position=(0, 1e-3, 0.07 - 1e-5))
    scene.add(wf.joints.Spherical(scene.ground, ball.at((0, 0, 0))))
    shape = wf.surfaces.Sphere(radius=0.02, axis_point=(0, 0, 0), axis_direction=(0, 1, 0))
    face = ball.surface(shape, name="face")
    scene.add(wf.Contact(roller["rim"], face, friction=0.3, grid="contact_fixed", cells=(7, 7)))
    return scene


def oiled(bodies: Bodies, yields: bool = False) -> wf.Scene:
    """A shaft that a load presses into a film of oil, in a bore that yields; it may yield too."""
    scene = wf.Scene(gravity=(0.0, 0.0, 0.0))
    bore = scene.add_body(bodies["bore"], name="bore")
    scene.add(wf.joints.Fixed(scene.ground, bore["outside"], axis=(0, 1, 0)))
    shape = wf.surfaces.Cylinder(radius=0.025 - 25e-6, axis_point=(0, 0, 0), axis_direction=(0, 1, 0))
    turning = {"name": "shaft", "angular_velocity": (0.0, 300.0, 0.0)}
    if yields:
        shaft = scene.add_body(bodies["shaft"], **turning)
    else:
        shaft = scene.add_rigid_body(0.5, (2e-4,) * 3, surfaces={"rim": shape}, **turning)
    middle = shaft["bore"] if yields else shaft.at((0, 0, 0))
    plane = scene.add(wf.joints.Planar(scene.ground.at((0, 0, 0)), middle, axis=(0, 1, 0)))
    scene.add(wf.joints.Drive(plane, wf.signals.Constant(300.0), quantity="velocity"))
    scene.add(wf.forces.PointForce(middle, (wf.signals.Table((0.0, 1e-4, 1.0), (2e3, 4e3, 0.0)), 0, 0)))
    feeds = [wf.films.AxialGroove(np.pi, 1e-4, 1e5)]
    scene.add(wf.Film(bore["bore"], shaft["rim"], oil=wf.oils.Newtonian(0.01), feeds=feeds))
    return scene


SCENES: dict[str, Callable[[Bodies], wf.Scene]] = {
    "line": lambda b: guided_pair(b["plain"], b["other"], speed=60.0, ramp=0.02),
    "impulsive": lambda b: guided_pair(b["plain"], b["other"], speed=60.0, ramp=5e-4),
    "points": lambda b: guided_pair(b["crowned"], b["plain"], speed=60.0, ramp=0.02),
    "few points": few_points,
    "layer": layered,
    "friction": lambda b: guided_pair(b["rubbing"], b["rubbing"], load=60e3, speed=60.0, ramp=0.02, friction=0.3),
    "rolling": lambda b: rolling(b, "patched"),
    "unlike rolling": lambda b: rolling(b, "softer"),
    "rolling, falling friction": lambda b: rolling(b, "patched", Stribeck(0.4, 0.2, 1e-2)),
    "rolling ball": rolling_ball,
    "sparse": pendulum,
    "joint friction": rubbing_pendulum,
    "film": oiled,
    "film between two": lambda b: oiled(b, yields=True),
}


def steps(scene: wf.Scene, step: float, poison: bool, **options: Any) -> tuple[SavedRows, SavedRows]:
    """State and saved rows after some steps, each attempt replayed by itself, with scratch made unusable between."""
    engine = Engine(scene, settings=Settings(), **options)
    assert not (scene.contacts or scene.films) or settle(engine)
    engine.initial_rates()
    start_consistently(engine)
    engine.control(every=1)
    engine.enter(k.DYNAMIC, step, target=STEPS)
    for _ in range(4 * STEPS):
        if poison:
            make_unusable(engine)
        engine.replay(1)
    assert engine.word("status")[0] == 0 and engine.word("step")[0] == STEPS
    return engine.state.to_numpy(), engine.saved()


def make_unusable(engine: Engine) -> None:
    """NaN, and numbers that mean nothing, in all scratch arrays that are not declared to carry anything over."""
    set_by_some = {name for launch in engine.graph.program.launches() for name in bound_of(launch).written}
    for name, declaration in Scratch.declarations.items():
        if declaration.carried or declaration.dtype not in POISON:
            continue
        if declaration.zero_without and name not in set_by_some:
            continue
        array = getattr(engine.scratch, name)
        if not any(array is getattr(engine.state, other) for other in State.declarations):
            array.fill_(POISON[declaration.dtype])


@pytest.mark.parametrize("name", SCENES)
def test_scratch_carries_nothing_from_step_to_step(name: str, bodies: Bodies) -> None:
    options = {"integrator": GeneralizedAlpha(project_velocities=True)} if name == "points" else {}
    step = IMPACT_STEP if name == "impulsive" else STEP
    clean, rows = steps(SCENES[name](bodies), step, False, **options)
    other, other_rows = steps(SCENES[name](bodies), step, True, **options)
    assert (clean["ctl"]["repeated"][0] > 0) == (name == "impulsive")
    for key, values in clean.items():
        assert np.array_equal(numbers_of(values), numbers_of(other[key]), equal_nan=True), key
    for row, array in rows.items():
        assert np.array_equal(array, other_rows[row]), row


# --- what is refused


def wrong(*participants: Participant, declared: dict[str, Declaration] | None = None) -> list[str]:
    """Complaints about the order of participants in a scene that has everything."""
    placed = [(phase, phases.collect(participants, phase)) for phase in WHOLE]
    return complaints(placed, dict.fromkeys(NAMES, 3), declared or DECLARED)


def test_the_order_of_all_participants_is_right() -> None:
    assert not wrong(*PARTICIPANTS)


def test_reading_what_nobody_sets_is_refused() -> None:
    found = wrong(*[p for p in PARTICIPANTS if p.name != "contact"])
    assert any(line.startswith("phase 'sum': cell_forces.add_friction reads window") for line in found), found


def test_changing_what_nobody_has_set_is_refused() -> None:
    """Multipliers are added to forces that the motion of bodies sets; here nothing moves."""
    found = wrong(*[p for p in PARTICIPANTS if p.name != "motion"])
    assert any("retained.pull changes residual, which nothing has set before" in line for line in found), found


def test_reading_before_it_is_set_anew_is_refused() -> None:
    """In one phase: bodies are predicted after their increments have been read."""
    late = Participant("late", predict=[threads(motion.hold_motions), blocks(motion.predict_bodies)])
    declared = {name: replace(d, carried=name not in ("dx", "psi")) for name, d in DECLARED.items()}
    found = wrong(late, declared=declared)
    assert "phase 'predict': motion.predict_bodies sets dx anew after motion.hold_motions has read it; give them " in (
        "\n".join(found)
    )


def test_a_phase_that_is_none_is_refused() -> None:
    with pytest.raises(TypeError, match="participant 'x': 'somewhen' is no phase; choose from begin, predict"):
        Participant("x", somewhen=[])


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ({"q1": "no_such"}, r"launch of membrane.stretch_fibres: no array is called 'no_such'; declare it in"),
        ({"nothing": "q"}, "it takes no array nothing"),
        ({"run": "q"}, "it takes no array run"),
        ({"q1": "dx"}, "dx does not have the type of parameter q1"),
        ({"membrane_amplitude": "load"}, "parameter membrane_amplitude has 2 axes, load is declared with 3"),
        ({"when": "nowhere"}, "'nowhere' is no axis"),
    ],
)
def test_a_launch_that_does_not_fit_is_refused(given: dict[str, str], message: str) -> None:
    blocks(membrane.stretch_fibres, q1="qd")  # other arrays of the same form fit
    with pytest.raises(TypeError, match=message):
        blocks(membrane.stretch_fibres, **given)


def test_declarations_that_do_not_fit_are_refused() -> None:
    class One(Arrays):
        x = reals("world", "body")

    class Other(Arrays):
        x = integers("world")

    with pytest.raises(TypeError, match="Both: x declared twice"):
        type("Both", (One, Other), {})
    with pytest.raises(ValueError, match="'3 bodies' is no axis"):
        reals("3 bodies").shape({"body": 1})


def test_constants_that_do_not_fit_each_other_are_refused() -> None:
    constants, model = Constants("cpu"), Model()
    constants.fill(model.rows, kind=[0, 1], a=[0, 0], vector=np.zeros((2, 6)))
    with pytest.raises(TypeError, match="b: 3 entries along 'row', 2 were expected"):
        constants.fill(model.rows, b=[0, 1, 2])
    with pytest.raises(TypeError, match="vector: 5 entries along 6, 6 were expected"):
        constants.fill(model.rows, vector=np.zeros((2, 5)))
    with pytest.raises(TypeError, match="is no array of 1 axes"):
        constants.fill(model.rows, j=np.zeros((2, 2)))


def test_axes_are_known() -> None:
    constants = {f"{name}.{array}": d for name, topic in topics().items() for array, d in topic.declarations.items()}
    for name, declaration in {**DECLARED, **constants}.items():
        for axis in declaration.axes:
            assert isinstance(axis, int) or parts(axis)[1] in NAMES, (name, axis)


def test_the_table_of_arrays_is_that_of_the_declarations() -> None:
    """Made anew by `python -m warpffrf.online.arrays.table > docs/arrays.md`."""
    docs = Path(__file__).resolve().parents[3] / "docs" / "arrays.md"
    assert docs.read_text() == markdown()


def test_only_numbers_of_pairs_can_be_restored(monkeypatch: pytest.MonkeyPatch) -> None:
    for wrong_one in (vectors("world", "pair"), reals("world", "body"), reals("world", 3)):
        monkeypatch.setattr(snapshot, "RESTORED", {"x": wrong_one})
        with pytest.raises(TypeError, match="x: only reals and integers with the axes 'world' and 'pair'"):
            snapshot.copies("{}", "{}_before", rejected=0)


def test_the_ring_is_taken_to_the_host_once_for_all_worlds(bodies: Bodies, monkeypatch: pytest.MonkeyPatch) -> None:
    asked, plain = [], Ring.on_host
    monkeypatch.setattr(Ring, "on_host", lambda self: (asked.append(1), plain(self))[1])
    engine = Engine(SCENES["line"](bodies), worlds=3)
    engine.save_now()
    assert len(asked) == 1 and [len(chunks) for chunks in engine.chunks] == [1, 1, 1]
