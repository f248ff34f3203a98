"""The frame on its bushings: statics, closed-form frequencies by symmetry, momentum; its references against others."""

from __future__ import annotations

from pathlib import Path

import frame_reference as reference
import numpy as np
import pytest
from checks import Check, both_sizes, left_behind, missed

import warpffrf as wf
from demos import frame_on_bushings as demo
from demos.frame_on_bushings import (
    ALUMINIUM,
    GRAVITY,
    MOUNT_STIFFNESS,
    MOUNTS,
    PANEL_LOAD,
    PUSH,
    PUSH_TAKES,
    Cells,
    bushings,
    frame_mesh,
)

STATIC = 1e-5  # of the sink: the turning of the mounts, 1e-4 rad or less, is of first order in the full model
IMPULSE = 5e-5  # of the push: sums over steps instead of integrals
RIGID_STEP, RIGID_DURATION = 1e-4, 0.6  # s
FREQUENCY = 5e-5  # (omega h)^2/12, the period error of the integrator, is 2.4e-5 for the highest of the six
KICK = 1e-3  # m/s over the root of the mass: amplitudes of some micrometres, far from large rotations


def momentum(scene: wf.Scene, result: wf.Result) -> tuple[np.ndarray, np.ndarray]:
    """Momentum gained and impulse of all forces up to each saved step, each (T, 3) [N s].

    The frame's deformation does not move its centre of mass in its frame of reference, so the momentum is m times the
    velocity of that point.
    """
    from warpffrf.output.geometry.places import rotate

    body, motion, t = scene.body("frame"), result.body("frame"), result.time
    arm = np.stack([rotate(p, body.center_of_mass[None])[0] for p in motion.rotation])
    p = body.mass * (motion.velocity + np.cross(motion.angular_velocity, arm))
    force = sum((result.force(name).force for name in (*MOUNTS, "panel", "push")), body.mass * scene.gravity)
    steps = 0.5 * np.diff(t)[:, None] * (force[1:] + force[:-1])
    return p - p[0], np.concatenate([np.zeros((1, 3)), np.cumsum(steps, axis=0)])


def rigid_frequencies(scene: wf.Scene) -> tuple[np.ndarray, np.ndarray]:
    r"""Six frequencies (6,) [Hz] of the frame as a rigid body on undamped bushings: found in a run, and exact.

    About the centre of mass C, with the bushings at X_b - C = r_b and the rigid motion
    u_b = [1, -r_b^] (v, theta) = R_b (v, theta),

        sum_b R_b^T K_b R_b x = lambda diag(m 1, J) x.

    They are found again in the motion of a rigid body that starts in all six of its modes at once: the coordinate of
    each mode is then a cosine whose frequency is fitted.
    """
    frame = scene.body("frame")
    center = frame.center_of_mass
    ports = {name: frame[name].point for name in MOUNTS}
    exact, modes = reference.rigid_modes(
        frame.mass, frame.inertia, np.array(list(ports.values())) - center, MOUNT_STIFFNESS
    )
    rates = KICK * modes.sum(axis=1)
    rigid = wf.Scene()
    body = rigid.add_rigid_body(
        frame.mass, frame.inertia, name="frame", center_of_mass=center, angular_velocity=rates[3:],
        velocity=rates[:3] - np.cross(rates[3:], center),
    )  # fmt: skip
    bushings(rigid, lambda name: body.at(ports[name]), None)
    result = wf.simulate(
        rigid,
        RIGID_DURATION,
        step=RIGID_STEP,
        options=wf.RunOptions(integrator=wf.integrators.GeneralizedAlpha(1.0), save_every=5),
        progress=False,
    )
    motion = result.body("frame")
    turned = 2.0 * motion.rotation[:, :3]  # rotation vector, to second order in it
    moved = motion.position + np.cross(turned, center)
    coordinates = np.hstack([moved, turned]) @ np.vstack([frame.mass * modes[:3], frame.inertia @ modes[3:]])
    return np.array([reference.fitted_frequency(result.time, q) for q in coordinates.T]), exact


def checks(cells: Cells, scene: wf.Scene, result: wf.Result, still: wf.Result) -> list[Check]:
    """The figures of the run `result` and of its static state `still`, with the full model K + sum C_b^T K_b C_b = f,
    the mounts held rigid; the bushings' laws are linear in displacement and rotation, whose squares are neglected."""
    mesh, body = frame_mesh(cells), scene.body("frame")
    mounts = {name: body[name].point for name in MOUNTS}
    u = reference.static_displacement(mesh, ALUMINIUM, mounts, MOUNT_STIFFNESS, scene.gravity, ("panel", PANEL_LOAD))
    seat = reference.facet_mean(mesh, "seat", u)
    sink = still.sensor("seat").values[-1] - body["seat"].point
    carried = sum(still.force(name).force[-1, 2] for name in MOUNTS)
    gained, impulse = momentum(scene, result)
    pushed = 0.5 * PUSH_TAKES * float(np.linalg.norm(PUSH))  # mean of sin^2
    t, push_force = result.time, result.force("push").force
    found, exact = rigid_frequencies(scene)
    weight = body.mass * GRAVITY - PANEL_LOAD[2]
    return [
        Check("static: bushings carry", float(carried), weight, "weight and load", 1e-8, "N"),
        Check("static: sink of the seat", float(sink[2]), float(seat[2]), "full FE model", STATIC, "mm", 1e3),
        *(
            Check(f"rigid frequency {i + 1}", float(f), float(e), "closed form", FREQUENCY, "Hz")
            for i, (f, e) in enumerate(zip(found, exact, strict=True))
        ),
        Check("impulse of the push", float(np.linalg.norm(np.trapezoid(push_force, t, axis=0))), pushed, "closed form",
              IMPULSE, "N s"),
        Check("momentum less impulse, largest", float(np.abs(gained - impulse).max()), 0.0, "balance, over the push",
              IMPULSE, "N s", scale=pushed),
    ]  # fmt: skip


SMALL = demo.QUICK


@pytest.fixture(scope="module")
def scene() -> wf.Scene:
    return demo.build(SMALL, progress=False)


def test_the_mesh_is_the_cage(scene: wf.Scene) -> None:
    (Lx, Ly, Lz), b = demo.SIZE, demo.BAR
    bars = 4 * Lx + 6 * (Ly - 2 * b) + 6 * (Lz - 2 * b)
    assert scene.body("frame").mass == pytest.approx(bars * b**2 * demo.ALUMINIUM.density, rel=1e-12)


def test_the_figures_of_the_demo(scene: wf.Scene) -> None:
    still = wf.equilibrium(scene)
    result = wf.simulate(
        scene,
        0.08,
        step=demo.STEP,
        start="equilibrium",
        options=wf.RunOptions(integrator=wf.integrators.GeneralizedAlpha(demo.RHO_INF)),
        progress=False,
    )
    assert still.status == result.status == "completed"
    found = checks(SMALL, scene, result, still)
    assert not missed(found)


def test_rigid_frequencies_of_a_symmetric_body() -> None:
    """Springs at the corners of a rectangle in the plane of the centre of mass: all six decouple."""
    m, J, (a, b) = 50.0, np.diag([4.0, 9.0, 12.0]), (0.7, 0.4)
    k = (1.5e5, 1.0e5, 2.0e5, 60.0, 50.0, 40.0)
    arms = np.array([[x, y, 0.0] for x in (-a, a) for y in (-b, b)])
    values = [
        4 * k[0] / m, 4 * k[1] / m, 4 * k[2] / m,
        4 * (k[2] * b**2 + k[3]) / 4.0, 4 * (k[2] * a**2 + k[4]) / 9.0, 4 * (k[0] * b**2 + k[1] * a**2 + k[5]) / 12.0,
    ]  # fmt: skip
    found, modes = reference.rigid_modes(m, J, arms, k)
    assert found == pytest.approx(np.sort(np.sqrt(values)) / (2.0 * np.pi), rel=1e-12)
    assert np.count_nonzero(np.abs(modes) > 1e-9) == 6


def test_the_fit_finds_a_frequency_far_below_a_line_of_the_spectrum() -> None:
    t = np.arange(0.0, 0.6, 5e-4)
    for f in (11.23456, 30.7):
        assert reference.fitted_frequency(t, 3e-6 * np.cos(2 * np.pi * f * t + 0.7)) == pytest.approx(f, rel=1e-10)


def test_a_load_of_the_panel_reaches_the_mounts_in_the_full_model(scene: wf.Scene) -> None:
    """Without gravity and with stiff springs, the full model's mean panel displacement is linear in the load."""
    mesh, body = demo.frame_mesh(SMALL), scene.body("frame")
    mounts = {name: body[name].point for name in demo.MOUNTS}
    answers = [
        reference.static_displacement(mesh, demo.ALUMINIUM, mounts, demo.MOUNT_STIFFNESS, np.zeros(3), ("panel", load))
        for load in ((0.0, 0.0, -1.0), (0.0, 0.0, -2.0))
    ]
    assert answers[1] == pytest.approx(2.0 * answers[0], rel=1e-9, abs=1e-18)
    sink = [reference.facet_mean(mesh, name, answers[0])[2] for name in demo.MOUNTS]
    assert -demo.MOUNT_STIFFNESS[2] * np.sum(sink) == pytest.approx(1.0, rel=1e-9)


@both_sizes
def test_the_whole_demo(tmp_path: Path, quick: bool) -> None:
    (result,) = demo.main(tmp_path, quick=quick, progress=False)
    left_behind(tmp_path, "frame_on_bushings")
    still = wf.equilibrium(result.scene)
    assert not missed(checks(demo.QUICK if quick else demo.FULL, result.scene, result, still))
