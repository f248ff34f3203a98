"""Joints and drives that stages release and hold again: closed forms of motions, impacts, held loads."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import warpffrf as wf
from warpffrf.model.errors import InputError

G, MASS, INERTIA, ARM = 9.81, 2.0, 0.02, 0.3
ROUND_OFF = 1e-9  # of positions of 0.1 m over 100 steps, whose Newton iterations end at 1e-12
SECOND_ORDER = 2e-4  # of a tenth of a period in 100 steps: (omega h)^2 / 12, with omega h below 0.01, times some

Overrides = dict[str, object]


def pendulum(*latch: str) -> wf.Scene:
    """An arm, horizontal, that a pin and a latch hold, in that order or the other."""
    scene = wf.Scene(gravity=(0.0, 0.0, -G))
    arm = scene.add_rigid_body(MASS, (0.01, INERTIA, 0.03), name="arm", position=(ARM, 0.0, 0.0))
    holds = {
        "pin": wf.joints.Revolute(scene.ground, arm.at((-ARM, 0, 0)), axis=(0, 1, 0), name="pin"),
        "latch": wf.joints.Fixed(scene.ground, arm.at((0.1, 0, 0)), name="latch"),
    }
    for name in latch or ("pin", "latch"):
        scene.add(holds[name])
    return scene


def stage(name: str, *released: str, duration: float = 0.1, step: float = 1e-3, kind: str = "dynamic") -> wf.Stage:
    return wf.Stage(name, duration, step, {"released": list(released)} if released else {}, kind)


def run(scene: wf.Scene, *stages: wf.Stage, **options: object) -> wf.Result:
    return wf.simulate(scene, list(stages), progress=False, check=True, **options)  # type: ignore[arg-type]


@pytest.mark.parametrize("order", [("pin", "latch"), ("latch", "pin")])
def test_a_released_latch_lets_the_pendulum_swing(order: tuple[str, str]) -> None:
    """As a pendulum without it, whichever of the redundant constraints the held stage leaves out."""
    result = run(pendulum(*order), stage("held"), stage("swing", "latch"))
    free = wf.simulate(pendulum("pin"), 0.1, step=1e-3, progress=False)
    held, swing = result.stages["held"].body("arm"), result.stages["swing"]  # type: ignore[attr-defined]
    assert np.abs(held.position - [ARM, 0, 0]).max() < ROUND_OFF
    assert np.abs(swing.body("arm").position - free.body("arm").position[1:]).max() < ROUND_OFF
    assert np.abs(swing.joint("latch").force).max() < ROUND_OFF * MASS * G
    assert np.allclose(swing.joint("pin").force, free.joint("pin").force[1:], atol=1e-6 * MASS * G)


def test_a_pin_that_catches_a_flying_arm_is_a_plastic_impact() -> None:
    """Angular momentum about the pin is kept, (I + m a^2) omega+ = I omega + m (a x v), and the energy that is lost is
    booked as damping."""
    result = run(pendulum(), stage("swing", "latch"), stage("fly", "latch", "pin"), stage("caught", "latch"))
    before = result.stages["fly"].body("arm")  # type: ignore[attr-defined]
    caught = result.stages["caught"]  # type: ignore[attr-defined]
    angle = 2.0 * np.arctan2(before.rotation[-1, 1], before.rotation[-1, 3])  # about y
    arm = ARM * np.array([np.cos(angle), 0.0, -np.sin(angle)])
    v, omega = before.velocity[-1], before.angular_velocity[-1, 1]
    expected = (INERTIA * omega + MASS * np.cross(arm, v)[1]) / (INERTIA + MASS * ARM**2)
    lost = 0.5 * (MASS * v @ v + INERTIA * omega**2 - (INERTIA + MASS * ARM**2) * expected**2)
    first = caught.body("arm").angular_velocity[0, 1]
    assert first == pytest.approx(expected, rel=1e-2)  # a step later
    assert caught.energy["damping"][-1] == pytest.approx(lost, rel=1e-6)
    assert abs(result.energy["numerical"][-1]) < SECOND_ORDER * lost
    assert np.abs(np.diff(np.linalg.norm(caught.joint("pin").force, axis=1))[:20]).max() < 1.0  # N, of 41: smooth
    assert any(f"{lost:.4g}"[:4] in note for note in result.history.notes)


def test_a_clutch_and_a_motor() -> None:
    """A motor turns a shaft and is let go; a clutch then makes both shafts turn at I_1 omega / (I_1 + I_2); the motor
    takes over again."""
    scene = wf.Scene()
    shafts = [scene.add_rigid_body(1.0, (i, i, i), name=f"shaft {i}", position=(0, i, 0)) for i in (0.1, 0.3)]
    pins = [
        scene.add(wf.joints.Revolute(scene.ground, s.at((0, 0, 0)), axis=(0, 1, 0), name=f"pin {s.name}"))
        for s in shafts
    ]
    scene.add(wf.joints.Drive(pins[0], 20.0, quantity="velocity", name="motor"))
    scene.add(wf.joints.Fixed(shafts[0].at((0, 0.1, 0)), shafts[1].at((0, -0.1, 0)), name="clutch"))
    result = run(
        scene, stage("spin", "clutch"), stage("coast", "clutch", "motor"), stage("together", "motor"), stage("on")
    )
    speeds = {
        name: [part.body(s.name).angular_velocity[-1, 1] for s in shafts]
        for name, part in result.stages.items()  # type: ignore[attr-defined]
    }
    assert speeds["spin"] == pytest.approx([20.0, 0.0], abs=ROUND_OFF)
    assert speeds["coast"] == pytest.approx([20.0, 0.0], abs=ROUND_OFF)
    assert speeds["together"] == pytest.approx([5.0, 5.0], abs=ROUND_OFF)
    assert speeds["on"] == pytest.approx([20.0, 20.0], abs=ROUND_OFF)
    spin = result.joint("pin shaft 0.1").coordinate
    assert spin[-1] == pytest.approx(20.0 * 0.3 + 5.0 * 0.1, abs=1e-2)  # continuous; the impact is half a step early


def test_what_is_pressed_together_is_held_where_it_stands() -> None:
    """A spring of 1 kN/m is compressed by 50 N, clamped there, and released: static positions F/k, F/k, 0."""
    scene = wf.Scene()
    block = scene.add_rigid_body(1.0, (0.1, 0.1, 0.1), name="block")
    guide = scene.add(wf.joints.Prismatic(scene.ground, block, axis=(1, 0, 0), name="guide"))
    scene.add(wf.forces.JointSpringDamper(guide, stiffness=1e3, damping=1.0, name="spring"))
    scene.add(wf.forces.PointForce(block.at((0, 0, 0)), (50.0, 0, 0), name="push"))
    scene.add(wf.joints.Fixed(scene.ground, block, name="clamp"))
    off = wf.forces.PointForce(block.at((0, 0, 0)), (0.0, 0, 0), name="push")
    parts = [
        wf.Stage("press", 1.0, 0.5, {"released": ["clamp"]}, "static"),
        wf.Stage("clamp", 1.0, 0.5, {"forces": {"push": off}}, "static"),
        wf.Stage("hold", 0.01, 1e-3, {"forces": {"push": off}}),
        wf.Stage("open", 1.0, 0.5, {"forces": {"push": off}, "released": ["clamp"]}, "static"),
    ]
    result = run(scene, *parts)
    ends = [part.body("block").position[-1, 0] for part in result.stages.values()]  # type: ignore[attr-defined]
    assert ends == pytest.approx([0.05, 0.05, 0.05, 0.0], abs=ROUND_OFF)
    held = result.stages["hold"].joint("clamp").force  # type: ignore[attr-defined]
    guided = result.stages["hold"].joint("guide").force  # type: ignore[attr-defined]
    assert np.abs(held[:, 0]) == pytest.approx(50.0, rel=1e-6)
    assert np.abs(guided[:, 0]).max() < 1e-6


def test_a_run_goes_on_where_a_stage_ended(tmp_path: Path) -> None:
    """From a file too; without stages it is refused, because the joints do not hold as they were built."""
    scene = pendulum()
    whole = run(scene, stage("held"), stage("swing", "latch"), stage("stop"))
    run(scene, stage("held"), stage("swing", "latch"), results=tmp_path / "swing.h5")
    later = wf.simulate(
        scene, [stage("stop"), stage("swing again", "latch", duration=2e-3)], start=tmp_path / "swing.h5",
        progress=False,
    )  # fmt: skip
    stop = whole.stages["stop"].body("arm").position  # type: ignore[attr-defined]
    assert np.array_equal(later.stages["stop"].body("arm").position, stop)  # type: ignore[attr-defined]
    with pytest.raises(InputError, match="it ends with joints or drives that are released"):
        wf.simulate(scene, 0.01, step=1e-3, start=tmp_path / "swing.h5", progress=False)


def test_names_and_positions_that_jump_are_refused() -> None:
    scene = pendulum()
    pin = next(joint for joint in scene.joints if joint.name == "pin")
    scene.add(wf.joints.Drive(pin, 0.0, quantity="position", name="motor"))
    with pytest.raises(InputError, match="released joint or drive 'latsh' does not exist; did you mean 'latch'"):
        run(scene, stage("a", "latsh"))
    with pytest.raises(InputError, match="must be a list of names"):
        run(scene, wf.Stage("a", 0.1, 1e-3, {"released": "latch"}))
    with pytest.raises(InputError, match="stage 'b': drive 'motor' prescribes a position and was released before"):
        run(scene, stage("a", "motor", "latch"), stage("b", "latch"))


def test_a_beam_that_is_let_go_keeps_the_energy_that_bent_it() -> None:
    """A flexible bar, held at both ends and loaded, static; let go at one end it vibrates, and no energy is lost but
    by the integrator."""
    bar = wf.reduce(
        wf.mesh.box((0.2, 0.01, 0.01), (10, 1, 1), order=2), wf.Material(210e9, 0.3, 7850.0),
        interfaces={"x_min": "rigid", "x_max": "rigid"}, modes=6, progress=False,
    )  # fmt: skip
    scene = wf.Scene()
    body = scene.add_body(bar, name="bar")
    scene.add(wf.joints.Fixed(scene.ground, body["x_min"], name="wall"))
    scene.add(wf.joints.Fixed(scene.ground, body["x_max"], name="grip"))
    scene.add(wf.forces.PointForce(body["x_max"], (0.0, 0.0, -20.0), name="load"))
    first = float(bar.frequencies[bar.frequencies > 1.0][0])
    step = 0.005 / first
    parts = [
        stage("bend", "grip", duration=2.0, step=1.0, kind="static"), stage("grip", duration=20 * step, step=step),
        wf.Stage(
            "let go", 200 * step, step,
            {"released": ["grip"], "forces": {"load": wf.forces.PointForce(body["x_max"], (0, 0, 0), name="load")}},
        ),
    ]  # fmt: skip
    result = run(scene, *parts, options=wf.RunOptions(integrator=wf.integrators.GeneralizedAlpha(rho_inf=1.0)))
    held, free = (result.stages[name] for name in ("grip", "let go"))  # type: ignore[attr-defined]
    assert np.abs(np.diff(held.body("bar").modal, axis=0)).max() < 1e-6 * np.abs(held.body("bar").modal).max()
    total = free.energy["kinetic"] + free.energy["strain"]
    bent = held.energy["strain"][-1]
    assert bent > 0.0 and total == pytest.approx(bent, rel=1e-3)  # of second order in steps of 1/1200 of the period
    assert free.energy["kinetic"].max() > 0.3 * bent


def test_a_stage_in_which_nothing_moves_has_no_error_of_energy() -> None:
    """Energies of 1e-70 J are round-off: the budget has no share of them, that of the swing has."""
    result = run(pendulum(), stage("held"), stage("swing", "latch"))
    lines = {name: part.error_budget() for name, part in result.stages.items()}  # type: ignore[attr-defined]
    assert [line for line in lines["held"] if line.source == "energy ledger"] == []
    (swing,) = (line for line in lines["swing"] if line.source == "energy ledger")
    assert swing.size < SECOND_ORDER
