"""Inertia "auto" of a shaft that a motor sets turning: compared with a Jeffcott rotor, and the same however the run is
cut."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import warpffrf as wf
from scenes.rollers import STEEL
from warpffrf.model import rotation as rot
from warpffrf.model.reduced.body import ReducedBody
from warpffrf.output.files import unfinished

LENGTH, SIDE = 0.5, 0.02  # m
DISC, OFF, J_P = 8.0, 1e-4, 5e-3  # kg, m of the disc's centre of mass from the axis, kg m2
TORQUE, DAMPING = 6.0, 150.0  # N m, N s/m: held in the world
STEP = 2.5e-4  # s, 0.15 rad at the critical speed
SIMPLE = 1e-2  # what one mode, and a step of that size, leave of peak and speed: 0.3 %; "constant" is off by 4 %


@pytest.fixture(scope="module")
def shaft() -> ReducedBody:
    mesh = wf.mesh.box((LENGTH, SIDE, SIDE), (8, 1, 1), order=2)
    ends = {name: "average" for name in ("x_min", "x_max", "y_max")}
    return wf.reduce(mesh, STEEL, interfaces=ends, modes=6, cache=False, progress=False)


def rotor(shaft: ReducedBody, torque: wf.signals.SignalLike, off: float = OFF, damping: float = DAMPING) -> wf.Scene:
    """A disc on the middle of a shaft on two points, at rest; a motor turns the disc about x."""
    scene = wf.Scene(gravity=(0, 0, 0))
    body = scene.add_body(shaft, name="shaft", damping=0.0)
    scene.add(wf.joints.Spherical(scene.ground, body["x_min"]))
    scene.add(wf.joints.PointOnLine(scene.ground.at((0.5 * LENGTH, 0, 0)), body["x_max"], axis=(1, 0, 0)))
    disc = scene.add_rigid_body(DISC, (J_P, 0.5 * J_P, 0.5 * J_P), name="disc", position=(0, 0, off))
    scene.add(wf.joints.Fixed(body["y_max"], disc.at((0, 0.5 * SIDE, -off))))
    center = disc.at((0, 0, -off))
    scene.add(wf.forces.BearingSpring(scene.ground, center, axis=(1, 0, 0), radial=1.0, radial_damping=damping))
    scene.add(wf.forces.PointTorque(center, (torque, 0, 0), name="motor"))
    return scene


def jeffcott(shaft: ReducedBody, frequency: float, duration: float) -> tuple[float, float]:
    """Largest deflection [m] of a rotor of one bending mode, `frequency` [rad/s], and the speed [rad/s] there. The face
    that carries the disc moves as its mean, 2/pi of the middle of the sine of mass m/2."""
    M = DISC + 0.5 * shaft.mass * (0.5 * np.pi) ** 2
    J = J_P + shaft.inertia[0, 0] + DISC * OFF**2

    def rates(_: float, y: np.ndarray) -> list[float]:
        e, n = np.array([-np.sin(y[2]), np.cos(y[2])]), np.array([-np.cos(y[2]), -np.sin(y[2])])  # n = de/dphi
        A = np.array([[M, 0, DISC * OFF * n[0]], [0, M, DISC * OFF * n[1]], [*(DISC * OFF * n), J]])
        pull = -M * frequency**2 * y[:2] - DAMPING * y[3:5] + DISC * OFF * y[5] ** 2 * e
        return [*y[3:], *np.linalg.solve(A, [*pull, TORQUE])]

    y = solve_ivp(rates, (0.0, duration), np.zeros(6), rtol=1e-8, atol=1e-12, max_step=1e-3).y
    deflection = np.hypot(y[0], y[1])
    return float(deflection.max()), float(y[5, np.argmax(deflection)])


def test_a_run_up_from_rest_peaks_as_a_jeffcott_rotor(shaft: ReducedBody) -> None:
    standing = wf.eigenmodes(rotor(shaft, 0.0, 0.0, 0.0), 8, about="initial", progress=False)
    bending = min(2.0 * np.pi * f for f in standing.frequencies if f > 10.0)
    exact, speed = jeffcott(shaft, bending, 0.55)
    result = wf.simulate(rotor(shaft, TORQUE), 0.55, step=STEP, progress=False)
    disc = result.history.bodies["disc"]
    center = disc.position - OFF * np.array([rot.matrix(p)[:, 2] for p in disc.rotation])
    deflection = np.hypot(center[:, 1], center[:, 2])
    assert deflection.max() == pytest.approx(exact, rel=SIMPLE)
    assert disc.angular_velocity[np.argmax(deflection), 0] == pytest.approx(speed, rel=0.3 * SIMPLE)
    said = next(note for note in result.history.notes if "'auto' chose 'constant'" in note)
    assert "then 'full', as it rotates faster than" in said and said in result.report(progress=False)


def test_modes_about_the_end_of_a_run_up_have_its_inertia(shaft: ReducedBody) -> None:
    end = wf.simulate(rotor(shaft, 100.0), 0.02, step=1e-3, progress=False)
    modes = wf.eigenmodes(end.scene, 4, about=end, progress=False)
    assert any("then 'full'" in note for note in modes.notes)


def test_a_run_up_is_the_same_however_it_is_cut(shaft: ReducedBody, tmp_path: Path) -> None:
    """In two runs, next to a machine that stays slow, and resumed after a stop before and after it has begun anew."""
    whole = wf.simulate(rotor(shaft, 100.0), 0.06, step=1e-3, progress=False)
    scene = rotor(shaft, 100.0)
    first = wf.simulate(scene, 0.03, step=1e-3, progress=False)
    then = wf.simulate(scene, 0.03, step=1e-3, start=first, progress=False)
    q = whole.history.bodies["shaft"].modal
    assert np.array_equal(then.history.bodies["shaft"].modal, q[31:])
    slow, fast = wf.simulate_worlds([rotor(shaft, 1e-3), rotor(shaft, 100.0)], 0.06, step=1e-3, progress=False)
    assert np.array_equal(fast.history.bodies["shaft"].modal, q) and any("then 'full'" in n for n in fast.history.notes)
    assert not any("then 'full'" in note for note in slow.history.notes)
    for looks in (1, 2, 4):
        asked = 0

        def due(self: unfinished.UnfinishedRun, looks: int = looks) -> bool:
            nonlocal asked
            asked += 1
            if asked == looks:
                raise KeyboardInterrupt
            return True

        path = tmp_path / f"{looks}.h5"
        with pytest.MonkeyPatch.context() as context:
            context.setattr(unfinished.UnfinishedRun, "due", due)
            part = wf.simulate(rotor(shaft, 100.0), 0.06, step=1e-3, results=path, progress=False)
        assert part.status == "interrupted"
        resumed = wf.simulate(rotor(shaft, 100.0), 0.06, step=1e-3, results=path, resume=True, progress=False)
        assert np.array_equal(resumed.history.bodies["shaft"].modal, q)


def test_a_run_that_turns_faster_than_the_one_it_continues_says_so(shaft: ReducedBody) -> None:
    scene = rotor(shaft, 1.0)
    first = wf.simulate(scene, 0.03, step=1e-3, progress=False)
    then = wf.simulate(scene, 0.3, step=1e-3, start=first, progress=False)
    assert not any("then 'full'" in note for note in first.history.notes)
    assert any("more inertia terms from here on" in note for note in then.history.notes)


def test_a_run_up_is_the_same_step_by_step(shaft: ReducedBody) -> None:
    """Begun anew with more inertia terms, with the changes of its input at the same steps; a result in between."""
    whole = wf.simulate(rotor(shaft, 100.0), 0.06, step=1e-3, progress=False)
    torque = wf.signals.Input("torque", 100.0)
    held = wf.Simulation(rotor(shaft, torque), step=1e-3)
    for n in range(60):
        held.step()
        if n == 17:
            held.result()
    found = held.result()
    assert np.array_equal(found.history.bodies["shaft"].modal, whole.history.bodies["shaft"].modal)
    assert any("then 'full'" in note for note in found.history.notes)
    torques = np.repeat([100.0, 150.0, 80.0], 20)
    table = wf.signals.Table(1e-3 * np.arange(61), [100.0, *torques], hold=True)
    known = wf.simulate(rotor(shaft, table), 0.06, step=1e-3, progress=False)
    changed = wf.Simulation(rotor(shaft, torque), step=1e-3)
    for value in torques:
        changed.inputs["torque"] = value
        changed.step()
    assert any("then 'full'" in note for note in changed.result().history.notes)
    speed = known.history.bodies["disc"].angular_velocity[:, 0]
    off = np.abs(changed.result().history.bodies["disc"].angular_velocity[:, 0] - speed).max()
    assert off <= 1e-9 * speed.max()  # round-off of the pieces, through the tolerance of the iteration
    assert np.array_equal(changed.result().force("motor").torque[:, 0], [100.0, *torques])
