"""A run that fails names the body, joint or pair at fault, and keeps its results."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from scenes.rollers import PAIR, guided_pair, roller_body
from warpffrf.model import forces, joints, signals
from warpffrf.model.reduced.body import ReducedBody
from warpffrf.model.scene import Scene
from warpffrf.online import Engine, Settings, find_equilibrium, run
from warpffrf.online.diagnosis.failure_report import _fullest, failure_owner, row_owners
from warpffrf.online.outcome import describe
from warpffrf.online.start.consistent import start_consistently
from warpffrf.online.start.static_equilibrium import settle
from warpffrf_kernels.core import control as k


def chain() -> Scene:
    """Two rods hanging out sideways, hinge and elbow, and a spring on the second."""
    scene = Scene(gravity=(0.0, 0.0, -9.81))
    first = scene.add_rigid_body(1.0, (0.1, 0.1, 0.1), name="first", position=(1, 0, 0))
    second = scene.add_rigid_body(1.0, (0.1, 0.1, 0.1), name="second", position=(3, 0, 0))
    scene.add(joints.Revolute(scene.ground, first.at((-1, 0, 0)), axis=(0, 1, 0), name="hinge"))
    scene.add(joints.Spherical(first.at((1, 0, 0)), second.at((-1, 0, 0)), name="elbow"))
    scene.add(forces.SpringDamper(scene.ground.at((3, 1, 0)), second.at((0, 0, 0)), 10.0, name="spring"))
    return scene


def test_a_step_far_too_long_names_body_and_joint() -> None:
    scene = chain()
    blow = (signals.Ramp(0.0, 1e9, duration=1.0), (0.3, 0.2, 1.0))
    scene.add(forces.PointForce(scene.body("second").at((0, 0, 0)), blow, name="blow"))
    history = run(scene, 4.0, step=1.0, progress=False, settings=Settings(max_level=1))
    assert history.status == "not_converged" and len(history.time) == 1
    assert "(the largest residual: " in history.message
    assert "an unbalanced" in history.message and " on body '" in history.message
    assert "joint 'elbow' is violated by" in history.message or "joint 'hinge' is violated by" in history.message


def test_a_rope_pulled_beyond_reach_ends_the_run_with_its_results() -> None:
    """The point turns about (0, 0, 0) at radius 2, the rope from (0, 0, 1) is pulled to 4 > 3: it snaps at 3."""
    scene = Scene()
    bob = scene.add_rigid_body(1.0, (0.1, 0.1, 0.1), name="bob", position=(1, 0, 0))
    scene.add(joints.Spherical(scene.ground, bob.at((-1, 0, 0)), name="ball"))
    rope = scene.add(joints.Distance(scene.ground.at((0, 0, 1)), bob.at((1, 0, 0)), name="rope"))
    signal = signals.SmoothStep(np.sqrt(5.0), 4.0, duration=1.0)
    scene.add(joints.Drive(rope, signal, quantity="position", name="pull"))
    history = run(scene, 1.0, step=1e-2, progress=False)
    assert history.status != "completed" and "body 'bob'" in history.message
    assert 2.9 < history.joints["rope"].coordinate[-1] <= 3.0 + 1e-6
    assert len(history.time) > 10 and history.counters["rejected_steps"] > 0


def test_what_is_not_finite_is_named() -> None:
    engine = Engine(chain())
    start_consistently(engine)
    values = engine.state.v.numpy().copy()
    values[0, 1] = np.nan
    engine.state.v.assign(values)
    engine.enter(int(k.DYNAMIC), 1e-3)
    engine.replay(40)
    bits = int(engine.word("status")[0])
    assert bits & int(k.NOT_FINITE)
    said = failure_owner(engine, bits)
    assert "the motion of body 'second' is not finite" in said and "'spring'" not in said


def test_rows_have_owners() -> None:
    assert row_owners(Engine(chain())) == [*["joint 'hinge'"] * 5, *["joint 'elbow'"] * 3, "force 'spring'"]


@pytest.mark.parametrize(("unknown", "said"), [(7, "motion of body 'second'"), (13, "reaction of joint 'hinge'")])
def test_an_unknown_that_a_singular_system_leaves_open_is_named(unknown: int, said: str) -> None:
    """The row and column of one unknown of the retained system wiped out."""
    engine = Engine(chain())
    start_consistently(engine)
    A = np.diag(np.arange(1.0, 22.0))[None]
    A[0, unknown, unknown] = 0.0
    engine.scratch.tangent.assign(A)
    assert said in failure_owner(engine, int(k.SINGULAR))


def test_modes_with_inertia_terms_have_names_too(plain_body: ReducedBody) -> None:
    scene = Scene()
    ring = scene.add_body(plain_body, name="ring", inertia="full")
    scene.add(joints.Fixed(scene.ground, ring["bore"], name="clamp"))
    engine = Engine(scene)
    start_consistently(engine)
    m = engine.compiled.model
    assert m.dense.count > 0
    for unknown, said in ((6, "deformation of body 'ring'"), (m.retained.row_offset, "reaction of joint 'clamp'")):
        A = np.diag(np.arange(1.0, m.retained.count + 1.0))[None]
        A[0, unknown, unknown] = 0.0
        engine.scratch.tangent.assign(A)
        assert said in failure_owner(engine, int(k.SINGULAR))


def test_a_window_too_small_names_its_pair(plain_body: ReducedBody) -> None:
    scene = guided_pair(plain_body, plain_body, load=2e6, speed=20.0)
    scene.contacts[0].capacity = 8
    failed = find_equilibrium(scene)
    assert failed.status == "capacity" and failed.message.endswith(f"(at contact {PAIR!r})")


def test_the_fullest_pair_is_named() -> None:
    """The one with the most active nodes of those whose windows are wide open, of all where none is."""

    def array(values: Any) -> Any:
        return SimpleNamespace(numpy=lambda: np.asarray([values]))

    def engine(windows: list) -> Any:
        names = [SimpleNamespace(name=name) for name in ("first", "second", "third")]
        active = array([[1, 0, 0, 0], [1, 1, 1, 0], [1, 1, 0, 0]])
        compiled = SimpleNamespace(model=SimpleNamespace(window=SimpleNamespace(half=8)))
        scratch, state = SimpleNamespace(window=array(windows)), SimpleNamespace(active=active)
        return SimpleNamespace(
            scene=SimpleNamespace(finite_sliding=names), compiled=compiled, scratch=scratch, state=state
        )

    wide, narrow = (-8, 8), (-2, 2)
    assert _fullest(engine([wide, narrow, wide]), 0) == (
        "at contact 'third', which has 2 active nodes; further windows at full width: 1"
    )
    assert _fullest(engine([narrow, narrow, narrow]), 0) == "at contact 'second', which has 3 active nodes"
    assert _fullest(engine([wide, wide, wide]), 0) == "at contact 'second', which has 3 active nodes"


def test_tractions_that_do_not_settle_name_contact_and_cell() -> None:
    """The state of a step in which the traction of one cell is twice its bound."""
    body = roller_body(120, layers=4, axial=2, modes=0, tangential=True)
    engine = Engine(guided_pair(body, body, load=200e3, speed=20.0, friction=0.3))
    assert settle(engine)
    engine.enter(int(k.DYNAMIC), 1e-4)
    engine.control(every=1)
    engine.replay(1)
    traction, bound = engine.state.traction.numpy(), engine.scratch.bound.numpy()[0, 0]
    rows = engine.scene.contacts[0].a.surface.grid.rows
    column, row = divmod(int(bound.argmax()), rows)
    traction[0, 0, column * 2 * rows + row] = 2.0 * bound.max()
    engine.state.traction.assign(traction)
    said = failure_owner(engine, int(k.TRACTIONS))
    assert (
        f"tractions of contact {PAIR!r}" in said and f"at column {column}, row {row}; of 9 loaded cells 1 slide" in said
    )
    assert "interior-point" in describe(int(k.TRACTIONS), 0, "take fewer cells")[1]
