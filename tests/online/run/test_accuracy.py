"""Steps halved by the local error allowed, and velocities projected onto what the joints allow."""

from __future__ import annotations

import numpy as np
import pytest

from warpffrf.model import forces, joints, signals
from warpffrf.model import rotation as rot
from warpffrf.model.errors import InputError
from warpffrf.model.integrators import HHT, GeneralizedAlpha, Newmark
from warpffrf.model.scene import Scene
from warpffrf.online.history.history import History
from warpffrf.online.run import run

GRAVITY, LENGTH = 9.81, 1.0


def pendulum() -> Scene:
    """A slender rod on a hinge at its end, let go from horizontal."""
    scene = Scene(gravity=(0.0, 0.0, -GRAVITY))
    rod = scene.add_rigid_body(2.0, (1e-3, 2.0 / 12.0, 2.0 / 12.0), name="rod", position=(0.5 * LENGTH, 0.0, 0.0))
    scene.add(joints.Revolute(scene.ground, rod.at((-0.5 * LENGTH, 0.0, 0.0)), axis=(0.0, 1.0, 0.0), name="hinge"))
    return scene


def speed_defect(history: History) -> float:
    """Largest speed of the hinge's point on the rod [m/s], which should stand still."""
    b = history.bodies["rod"]
    arm = np.array([rot.matrix(p) @ [-0.5 * LENGTH, 0.0, 0.0] for p in b.rotation])
    return float(np.abs(b.velocity + np.cross(b.angular_velocity, arm))[1:].max())


def energy_defect(history: History) -> float:
    """Largest change of the energy of the rod over its largest kinetic one."""
    b = history.bodies["rod"]
    w = np.linalg.norm(b.angular_velocity, axis=1)
    T = 0.5 * 2.0 * np.sum(b.velocity**2, axis=1) + 0.5 * 2.0 / 12.0 * w**2
    return float(np.abs(T + 2.0 * GRAVITY * b.position[:, 2])[1:].max() / T.max())


@pytest.mark.parametrize("make", [GeneralizedAlpha, HHT, Newmark])
def test_projected_velocities_agree_with_the_joints(make: type) -> None:
    """To round-off with projection, to the error of the step without; the motion keeps its order."""
    plain, projected = (
        run(pendulum(), 0.5, step=5e-3, integrator=make(project_velocities=flag), progress=False)
        for flag in (False, True)
    )
    assert speed_defect(projected) < 1e-8  # m/s; the matrix is that of the last Newton iterate but one
    assert speed_defect(plain) > 1e-7
    fine = run(pendulum(), 0.5, step=2.5e-3, integrator=make(project_velocities=True), progress=False)
    assert energy_defect(fine) < 0.3 * energy_defect(projected)


def test_projected_velocities_follow_a_drive() -> None:
    """A driven hinge, half-way up a smooth step: the rod turns with the rate of the signal."""
    scene = pendulum()
    signal = signals.SmoothStep(0.0, 1.0, duration=0.2)
    scene.add(joints.Drive(scene.joints[0], signal, quantity="position"))
    history = run(scene, 0.1, step=5e-3, integrator=GeneralizedAlpha(project_velocities=True), progress=False)
    expected = (signal(0.1 + 1e-6) - signal(0.1 - 1e-6)) / 2e-6
    assert history.bodies["rod"].angular_velocity[-1, 1] == pytest.approx(float(expected), rel=1e-7)


@pytest.mark.parametrize("make", [GeneralizedAlpha, HHT])
def test_projection_leaves_reactions_their_order(make: type) -> None:
    """The torque of a drive is J s'' to second order, and its work the kinetic energy: nothing lags behind the
    projected velocities."""

    def defects(step: float) -> np.ndarray:
        scene = Scene()
        rotor = scene.add_rigid_body(1.0, (1e-3, 1e-3, 1e-3), name="rotor")
        hinge = scene.add(joints.Revolute(scene.ground, rotor.at((0.0, 0.0, 0.0)), axis=(0.0, 1.0, 0.0), name="hinge"))
        speed = signals.SmoothStep(0.0, 100.0, duration=0.02)
        scene.add(joints.Drive(hinge, speed, quantity="velocity"))
        history = run(scene, 0.02, step=step, integrator=make(project_velocities=True), progress=False)
        wanted = 1e-3 * (speed(history.time + 1e-6) - speed(history.time - 1e-6)) / 2e-6
        middle = (history.time > 0.004) & (history.time < 0.016)  # s''' jumps at both ends of the signal
        torque = np.abs(history.joints["hinge"].torque[:, 1] - wanted)[middle]
        return np.array([torque.max() / np.abs(wanted).max(), abs(history.energy["numerical"][-1]) / 5.0])

    coarse, fine = defects(5e-4), defects(2.5e-4)
    assert np.all(fine < 0.3 * coarse) and np.all(fine < 2e-3)


def test_error_follows_the_accuracy_asked_for() -> None:
    """An eighth of the error allowed takes twice the steps (local error of third order) and keeps the energy better."""
    runs = [run(pendulum(), 1.0, step=0.05, step_error=a, progress=False) for a in (1e-4, 1e-4 / 8.0, 1e-4 / 64.0)]
    steps = np.array([history.counters["steps"] for history in runs])
    assert np.all(steps[1:] / steps[:-1] > 1.5) and np.all(steps[1:] / steps[:-1] < 2.6)
    defects = np.array([energy_defect(history) for history in runs])
    assert np.all(defects[1:] < 0.5 * defects[:-1])
    assert all(np.array_equal(history.time, runs[0].time) for history in runs)  # rows at the user's steps


def test_only_the_pulse_is_resolved() -> None:
    """A force that acts for three hundredths of the run: short steps there, the user's elsewhere."""
    scene = Scene(gravity=(0.0, 0.0, 0.0))
    body = scene.add_rigid_body(1.0, (0.01, 0.01, 0.01), name="body")
    pulse = signals.Table([0.0, 0.5, 0.515, 0.53, 1.0], [0.0, 0.0, 400.0, 0.0, 0.0])
    scene.add(forces.PointForce(body.at((0.0, 0.0, 0.0)), (pulse, 0.0, 0.0)))
    coarse = run(scene, 1.0, step=0.02, progress=False)
    fine = run(scene, 1.0, step=0.02, step_error=1e-5, progress=False)
    exact = 400.0 * 0.015
    assert fine.bodies["body"].velocity[-1, 0] == pytest.approx(exact, rel=1e-3)
    assert abs(coarse.bodies["body"].velocity[-1, 0] - exact) > 0.02 * exact
    assert fine.counters["steps"] < 400  # the whole in steps of the pulse would be some thousands
    assert fine.counters["coarse_steps"] == 0
    assert any("halved (step_error)" in note for note in fine.notes)


def test_halved_steps_are_reported_of_the_run_that_halved_them() -> None:
    """A run that goes on with the user's steps does not repeat the note of the one before."""
    first = run(pendulum(), 0.1, step=0.05, step_error=1e-5, progress=False)
    assert first.counters["rejected_steps"] and any("halved" in note for note in first.notes)
    second = run(pendulum(), 0.05, step=1e-3, start=first, progress=False)
    assert not any("halved" in note for note in second.notes)


def test_wrong_accuracy_is_refused() -> None:
    for value in (0.0, -1.0, float("nan"), "fine"):
        with pytest.raises(InputError, match="step_error"):
            run(pendulum(), 0.1, step=0.01, step_error=value, progress=False)  # type: ignore[arg-type]
