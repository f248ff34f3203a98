"""The start of a run: accelerations and reactions of the first row against closed forms, to round-off."""

from __future__ import annotations

import numpy as np
import pytest

from warpffrf.model import forces, joints, signals, surfaces
from warpffrf.model import rotation as rot
from warpffrf.model.contact import Contact
from warpffrf.model.errors import InputError
from warpffrf.model.reduced.body import ReducedBody
from warpffrf.model.scene import Scene
from warpffrf.online import Engine, GeneralizedAlpha, run
from warpffrf.online.compile.inertia_plan import InertiaPlan
from warpffrf.online.free_flight.free_bodies import free_body, initial_motion
from warpffrf.online.start.consistent import start_consistently

EXACT = 1e-11  # relative: round-off of positions of some metres, and of central differences
GRAVITY = np.array([0.5, -0.2, -9.81])


def relative(found: np.ndarray, wanted: np.ndarray) -> float:
    return float(np.abs(found - wanted).max() / np.abs(wanted).max())


def first_row(scene: Scene, **options):
    history = run(scene, 1e-3, step=1e-3, progress=False, **options)
    assert history.status == "completed", history.message
    return history


@pytest.mark.parametrize("seed", range(4))
def test_a_compound_pendulum_in_a_skew_pose(seed: int) -> None:
    """Axis n through a point, arm c to the centre of mass, J about it: alpha = n.(c x m g)/(n.J n + m |n x c|^2)."""
    random = np.random.default_rng(seed)
    n, c, pivot = random.standard_normal(3), random.standard_normal(3), 5.0 * random.standard_normal(3)
    n /= np.linalg.norm(n)
    A = rot.rotation_vector_matrix(random.standard_normal(3))
    m, J = 7.0, np.array([[0.5, 0.05, 0.02], [0.05, 0.7, -0.03], [0.02, -0.03, 0.9]])
    omega = 3.0 * n
    scene = Scene(gravity=GRAVITY)
    body = scene.add_rigid_body(
        m, J, name="body", position=pivot + c, rotation=rot.quaternion(A), velocity=np.cross(omega, c),
        angular_velocity=omega,
    )  # fmt: skip
    scene.add(joints.Revolute(scene.ground, body.at(-A.T @ c), axis=n, name="hinge"))
    history = first_row(scene)
    world = A @ J @ A.T
    about = n @ world @ n + m * (c @ c - (n @ c) ** 2)
    alpha = n * (n @ np.cross(c, m * GRAVITY)) / about
    a = np.cross(alpha, c) + np.cross(omega, np.cross(omega, c))
    force = m * (a - GRAVITY)
    torque = world @ alpha + np.cross(omega, world @ omega) + np.cross(c, force)
    assert relative(history.bodies["body"].angular_acceleration[0], alpha) < EXACT
    assert relative(history.joints["hinge"].force[0], force) < EXACT
    assert relative(history.joints["hinge"].torque[0], torque) < EXACT


def test_the_heavy_top() -> None:
    """D5 of the verification cases: (J + m X x . x X) omega' = X x m g - omega x J_tip omega about the fixed tip."""
    X, omega = np.array([0.0, 1.0, 0.0]), np.array([0.0, 150.0, -4.61538])
    m, J, g = 15.0, np.diag([0.234375, 0.46875, 0.234375]), np.array([0.0, 0.0, -9.81])
    scene = Scene(gravity=g)
    top = scene.add_rigid_body(m, J, name="top", position=X, velocity=np.cross(omega, X), angular_velocity=omega)
    scene.add(joints.Spherical(scene.ground, top.at(-X), name="tip"))
    history = first_row(scene, integrator=GeneralizedAlpha(0.9))
    tip = J + m * (X @ X * np.eye(3) - np.outer(X, X))
    alpha = np.linalg.solve(tip, np.cross(X, m * g) - np.cross(omega, tip @ omega))
    force = m * (np.cross(alpha, X) + np.cross(omega, np.cross(omega, X)) - g)
    assert relative(history.bodies["top"].angular_acceleration[0], alpha) < EXACT
    assert relative(history.joints["tip"].force[0], force) < EXACT


@pytest.mark.parametrize("stiffness", [1e3, 1e6, 1e9])
def test_a_stretched_spring_and_a_damper(stiffness: float) -> None:
    """m a = -k e - d v along a guide in a skew direction; the guide takes the rest of the weight."""
    m, e, v, d = 2.0, 1e-3, 0.4, 30.0
    n = np.array([2.0, -1.0, 2.0]) / 3.0
    scene = Scene(gravity=GRAVITY)
    start = 1.5 * n
    body = scene.add_rigid_body(m, (0.1, 0.2, 0.2), name="body", position=start, velocity=v * n)
    scene.add(joints.Prismatic(scene.ground, body.at((0, 0, 0)), axis=n, name="guide"))
    port = scene.ground.at((0, 0, 0))
    scene.add(forces.SpringDamper(port, body.at((0, 0, 0)), stiffness, damping=d, free_length=1.5 - e, name="spring"))
    history = first_row(scene)
    a = n * (GRAVITY @ n - (stiffness * e + d * v) / m)
    assert relative(history.bodies["body"].acceleration[0], a) < 10.0 * EXACT
    assert relative(history.joints["guide"].force[0], -m * (GRAVITY - n * (n @ GRAVITY))) < 1e-15 * stiffness + EXACT
    assert history.forces["spring"].force[0] @ n == pytest.approx(-(stiffness * e + d * v), rel=1e-9)


def test_a_drive_that_speeds_up() -> None:
    """Velocity s(t) of a drive: the first acceleration is s'(0), the torque J s'(0), and the velocity s(0)."""
    scene = Scene()
    wheel = scene.add_rigid_body(1.0, (0.1, 0.3, 0.2), name="wheel", rotation=(0.0, 0.6, 0.0, 0.8))
    axle = scene.add(joints.Revolute(scene.ground, wheel.at((0, 0, 0)), axis=(0, 1, 0), name="axle"))
    scene.add(joints.Drive(axle, signals.Ramp(3.0, 13.0, duration=0.5), name="motor"))
    history = first_row(scene)
    motion = history.bodies["wheel"]
    assert relative(motion.angular_velocity[0], np.array([0.0, 3.0, 0.0])) < EXACT
    assert relative(motion.angular_acceleration[0], np.array([0.0, 20.0, 0.0])) < EXACT
    assert relative(history.joints["axle"].torque[0], np.array([0.0, 6.0, 0.0])) < EXACT
    assert any("'wheel'" in note and "3 rad/s" in note for note in history.notes)


def test_a_flexible_body_and_its_velocity_at_a_joint(plain_body: ReducedBody) -> None:
    """A roller on a hinge at its flexible bore, sagging in its own weight from rest: the hinge's point has no
    acceleration, and the reaction carries what the centre of mass does not take."""
    scene = Scene(gravity=GRAVITY)
    roller = scene.add_body(plain_body, name="roller", rotation=(0.0, 0.6, 0.0, 0.8))
    x = roller["bore"].world_point()
    scene.add(joints.Fixed(scene.ground.at(x), roller["bore"], name="wall"))
    history = first_row(scene)
    motion, interface = history.bodies["roller"], plain_body.interfaces["bore"]
    A = rot.matrix(roller.rotation)
    swing = np.cross(motion.angular_acceleration[0], A @ interface.point)
    point = motion.acceleration[0] + swing + A @ (motion.modal_acceleration[0] @ interface.modes[:, :3])
    assert np.abs(point).max() < 1e-9 * np.abs(motion.acceleration[0]).max() + 1e-9
    center = motion.acceleration[0] + np.cross(motion.angular_acceleration[0], A @ roller.center_of_mass)
    assert relative(history.joints["wall"].force[0], roller.mass * (center - GRAVITY)) < EXACT


@pytest.mark.parametrize("level", ["constant", "deformed", "gyroscopic", "full"])
def test_a_deformed_body_in_free_flight(plain_body: ReducedBody, level: str) -> None:
    """Accelerations of a body that spins, is deformed and vibrates, against its equations of motion in NumPy."""
    scene = Scene(gravity=GRAVITY)
    v, omega = (1.0, 2.0, 3.0), (300.0, -200.0, 500.0)
    skew = (0.0, 0.6, 0.0, 0.8)
    body = scene.add_body(plain_body, name="body", rotation=skew, inertia=level, velocity=v, angular_velocity=omega)
    engine = Engine(scene)
    for name, factor in (("q", 1e-4), ("qd", 0.1)):
        values = getattr(engine.state, name).numpy().copy()
        values[0] = factor * np.cos(np.arange(values.shape[1]))
        getattr(engine.state, name).assign(values)
    q, qd = (getattr(engine.state, name).numpy()[0].copy() for name in ("q", "qd"))
    start_consistently(engine)
    equations = free_body(scene, body, InertiaPlan.of(scene).bodies[0])
    rates = equations.rates(initial_motion(body)._replace(q=q, qd=qd), 0.0)
    found = engine.state
    for name, wanted in (("v_rate", rates.v), ("omega_rate", rates.w)):
        assert relative(getattr(found, name).numpy()[0, 0], wanted) < EXACT, name
    assert relative(found.qd_rate.numpy()[0], rates.qd) < EXACT
    assert np.array_equal(found.qd.numpy()[0], qd)


def test_every_world_starts_alike() -> None:
    scene = Scene(gravity=GRAVITY)
    body = scene.add_rigid_body(1.0, (0.1, 0.2, 0.2), name="body", position=(1.0, 0.2, 0.3))
    scene.add(joints.Spherical(scene.ground, body.at((-1.0, -0.2, -0.3)), name="ball"))
    engine = Engine(scene, worlds=3)
    start_consistently(engine)
    for name in ("v_rate", "v_alg", "omega_rate", "lam", "lam0", "stretch"):
        values = getattr(engine.state, name).numpy()
        assert np.array_equal(values, np.broadcast_to(values[:1], values.shape)), name
    assert np.abs(engine.state.lam.numpy()).max() > 1.0


def test_velocities_that_pull_a_joint_apart_are_refused_or_projected() -> None:
    """Projection changes velocities least in the metric of masses: a rod's end is stopped, momentum about it stays."""
    m, J, arm = 3.0, 0.5, 0.8
    scene = Scene()
    rod = scene.add_rigid_body(m, (J, J, J), name="rod", position=(arm, 0, 0), velocity=(0, 1.0, 0))
    scene.add(joints.Revolute(scene.ground, rod.at((-arm, 0, 0)), axis=(0, 0, 1), name="hinge"))
    with pytest.raises(InputError, match="joint 'hinge' by 1 m/s; give velocities that fit .* project_start=True"):
        run(scene, 1e-3, step=1e-3, progress=False)
    history = first_row(scene, project_start=True)
    spin = m * arm * 1.0 / (J + m * arm**2)
    assert relative(history.bodies["rod"].angular_velocity[0], np.array([0.0, 0.0, spin])) < EXACT
    assert relative(history.bodies["rod"].velocity[0], np.array([0.0, spin * arm, 0.0])) < EXACT
    assert any("did not agree" in note for note in history.notes)


def test_undamped_reactions_are_pointed_out() -> None:
    scene = Scene(gravity=GRAVITY)
    body = scene.add_rigid_body(1.0, (0.1, 0.2, 0.2), name="body", position=(1.0, 0.0, 0.0))
    free = first_row(scene, integrator=GeneralizedAlpha(1.0))
    assert not any("hardly damps" in note for note in free.notes)
    scene.add(joints.Spherical(scene.ground, body.at((-1.0, 0.0, 0.0)), name="ball"))
    assert any("hardly damps" in n for n in first_row(scene, integrator=GeneralizedAlpha(1.0)).notes)
    assert not any("hardly damps" in n for n in first_row(scene, integrator=GeneralizedAlpha(0.9)).notes)


@pytest.mark.parametrize("partner", ["ground", "cup", "another"])
def test_contact_forces_of_the_first_row_are_those_of_its_pose(plain_body: ReducedBody, partner: str) -> None:
    """A roller turns on a fixed axle, pressed on a partner below: the force of the first row is along the normal, and
    the partner feels its opposite. (The step that finds the pressures turns the roller by omega h, 2e-5 here.)"""
    across = (0.0, 1.0, 0.0)
    scene = Scene(gravity=(0.0, 0.0, 0.0))
    roller = scene.add_body(plain_body, name="roller", angular_velocity=(0.0, 200.0, 0.0))
    radius = plain_body.contact_surfaces["rim"].shape.radius
    deep = 2e-3 * radius
    if partner == "another":
        other = scene.add_body(plain_body, name="other", position=(0.0, 0.0, deep - 2.0 * radius))
        scene.add(joints.Fixed(scene.ground, other["bore"]))
        port = other["rim"]
    else:
        plane = surfaces.Plane(origin=(0.0, 0.0, deep - radius), outward=(0.0, 0.0, 1.0), direction=across)
        bore = surfaces.Bore(radius=3.0 * radius, axis_point=(0.0, 0.0, 2.0 * radius + deep), axis_direction=across)
        port = scene.ground.surface(plane if partner == "ground" else bore, name="face")
    scene.add(Contact(roller["rim"], port, name="pair", overlap=1.0))
    scene.add(joints.Revolute(scene.ground, roller["bore"], axis=across))
    found = first_row(scene).contacts["pair"]
    size = np.linalg.norm(found.force[0])
    assert size > 0.0 and abs(found.force[0, 1]) < 1e-9 * size
    assert np.abs(found.force[0] + found.force_second[0]).max() < 1e-12 * size
