"""Force elements against closed forms: oscillators, static deflections, torsional pendulums, spinning rotors, loads on
flexible bodies."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from scenes.rollers import STEEL
from warpffrf.model import forces, joints, signals
from warpffrf.model import rotation as rot
from warpffrf.model.errors import InputError
from warpffrf.model.mesh import Mesh, roller
from warpffrf.model.mesh import box as mesh_box
from warpffrf.model.reduced.body import ReducedBody
from warpffrf.model.scene import Scene
from warpffrf.offline import reduce
from warpffrf.online import GeneralizedAlpha, find_equilibrium, run

MASS, INERTIA = 2.0, (0.1, 0.2, 0.25)
STIFFNESS = np.array([800.0, 1000.0, 1200.0, 30.0, 50.0, 70.0])
RATIO = 0.05  # damping of the oscillators
STATIC = 1e-7  # relative: Newton tolerance of a static state, forces against forces


def free_body(**motion: Any) -> tuple[Scene, Any]:
    scene = Scene()
    return scene, scene.add_rigid_body(MASS, INERTIA, name="body", **motion)


def run_checked(scene: Scene, duration: float, step: float, **options: Any) -> Any:
    history = run(scene, duration, step=step, integrator=GeneralizedAlpha(0.9), progress=False, **options)
    assert history.status == "completed", history.message
    return history


def damped(t: np.ndarray, rate: float, stiffness: float, damping: float, inertia: float) -> np.ndarray:
    """Free oscillation from rest position with an initial rate."""
    w, zeta = np.sqrt(stiffness / inertia), damping / (2.0 * np.sqrt(stiffness * inertia))
    w_d = w * np.sqrt(1.0 - zeta**2)
    return rate / w_d * np.exp(-zeta * w * t) * np.sin(w_d * t)


def oscillator(element: str, i: int, rate: float) -> tuple[Scene, float]:
    """A body that moves in coordinate i (0 to 2 along, 3 to 5 about x, y, z) against an element; inertia of that
    motion."""
    inertia = ([MASS] * 3 + list(INERTIA))[i]
    K = STIFFNESS
    D = 2.0 * RATIO * np.sqrt(K * inertia)
    start = {"velocity": rate * np.eye(3)[i]} if i < 3 else {"angular_velocity": rate * np.eye(3)[i - 3]}
    scene, body = free_body(**start)
    port, axis = body.at((0, 0, 0)), np.eye(3)[i % 3]
    if element == "bushing":
        scene.add(forces.Bushing(scene.ground, port, K, D, name="element"))
    elif element == "bearing":
        along, spring = np.eye(3)[(i + 1) % 3], dict(radial=K[i], tilt=K[i], radial_damping=D[i], tilt_damping=D[i])
        scene.add(forces.BearingSpring(scene.ground, port, axis=along, name="element", **spring))
    else:
        kinds = {"revolute": joints.Revolute, "prismatic": joints.Prismatic, "cylindrical": joints.Cylindrical}
        joint = scene.add(kinds[element](scene.ground, port, axis=axis))
        spring = forces.TorsionalSpringDamper if i > 2 else forces.JointSpringDamper
        more: dict[str, Any] = {} if i > 2 else {"coordinate": "translation"}
        scene.add(spring(joint, K[i], D[i], name="element", **more))
    return scene, inertia


OSCILLATORS = [
    *[("bushing", i) for i in range(6)],
    *[("bearing", i) for i in (0, 4)],
    ("revolute", 3),
    ("prismatic", 1),
    ("cylindrical", 2),
    ("cylindrical", 5),
]


@pytest.mark.parametrize(("element", "i"), OSCILLATORS)
def test_oscillator_has_its_frequency_and_damping(element: str, i: int) -> None:
    """m s.. + d s. + k s = 0; the bearing's tilt follows the sine, so it is kept small."""
    rate = 1e-3 if element == "bearing" else 1.0
    errors = []
    for step in (4e-3, 2e-3):
        scene, inertia = oscillator(element, i, rate)
        history = run_checked(scene, 0.5, step)
        D = 2.0 * RATIO * np.sqrt(STIFFNESS * inertia)
        exact = damped(history.time, rate, STIFFNESS[i], D[i], inertia)
        body = history.bodies["body"]
        found = body.position[:, i] if i < 3 else 2.0 * np.arcsin(body.rotation[:, i - 3])
        errors.append(float(np.abs(found - exact).max() / np.abs(exact).max()))
        c = history.forces["element"].deformation
        at = i if element == "bushing" else int(np.argmax(np.abs(c[-1])))
        # the first row comes from the tiny step that finds accelerations
        assert np.abs(np.abs(c[1:, at]) - np.abs(found[1:])).max() < 1e-6 * np.abs(found).max()
    assert np.log2(errors[0] / errors[1]) > 1.8
    assert errors[1] < 5e-3


def full_matrix(size: float = 1e5) -> np.ndarray:
    """Positive definite, every entry in use."""
    scale = np.sqrt(size) * np.array([1.0, 1.0, 1.0, 0.1, 0.1, 0.1])
    A = np.random.default_rng(7).normal(size=(6, 6))
    return scale[:, None] * (A @ A.T + 2.0 * np.eye(6)) * scale


def test_full_matrix_gives_its_eigenfrequencies() -> None:
    """Started along an eigenvector of (K, M) with a small amplitude, every coordinate swings with its frequency."""
    K = full_matrix()
    M = np.diag([MASS] * 3 + list(INERTIA))
    values, shapes = np.linalg.eigh(np.diag(M.diagonal() ** -0.5) @ K @ np.diag(M.diagonal() ** -0.5))
    for number in (0, 5):
        shape = shapes[:, number] / np.sqrt(M.diagonal())
        w, amplitude = np.sqrt(values[number]), 1e-5
        rates = amplitude * shape
        scene, body = free_body(velocity=rates[:3], angular_velocity=rates[3:])
        scene.add(forces.Bushing(scene.ground, body.at((0, 0, 0)), K, name="bush"))
        period = 2.0 * np.pi / w
        history = run_checked(scene, period, period / 400)
        found = history.forces["bush"].deformation
        exact = np.sin(w * history.time)[:, None] * rates / w
        assert np.abs(found - exact).max() < 1e-3 * np.abs(exact).max()


CORNERS = np.array([[0.4, 0.3, -0.1], [-0.4, 0.3, -0.1], [-0.4, -0.3, -0.1], [0.4, -0.3, -0.1]])


def test_body_on_four_bushings_sinks_and_tilts_as_its_stiffness_matrix_says() -> None:
    """Weight, a force off the centre and a torque; small, so that the linear matrix (assembled here) is exact to
    1e-6."""
    K = full_matrix(1e6)
    g, force, torque = 1e-4, np.array([2e-3, 0.0, -5e-3]), np.array([0.0, 1e-3, 3e-4])
    scene = Scene(gravity=(0.0, 0.0, -g))
    body = scene.add_rigid_body(MASS, INERTIA, name="body", position=(0.0, 0.0, 1.0))
    at = np.array([0.1, 0.2, 0.0])
    total = np.zeros((6, 6))
    for i, corner in enumerate(CORNERS):
        turn = rot.rotation_vector_matrix(np.array([0.0, 0.0, 0.5 * np.pi * i]))
        scene.add(forces.Bushing(scene.ground, body.at(corner), K, axes=turn, name=f"bush {i}"))
        x, y, z = corner
        B = np.block([[turn.T, -turn.T @ np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])], [np.zeros((3, 3)), turn.T]])
        total += B.T @ K @ B
    scene.add(forces.PointForce(body.at(at), force))
    scene.add(forces.PointTorque(body.at(at), torque))
    load = np.concatenate([force + [0.0, 0.0, -MASS * g], np.cross(at, force) + torque])
    exact = np.linalg.solve(total, load)
    rest = find_equilibrium(scene)
    assert rest.status == "completed", rest.message
    motion = rest.bodies["body"]
    found = np.concatenate([motion.position[-1] - [0.0, 0.0, 1.0], 2.0 * motion.rotation[-1, :3]])
    assert found == pytest.approx(exact, abs=1e-6 * np.abs(exact).max())
    carried = sum(rest.forces[f"bush {i}"].force[-1] for i in range(4))
    assert carried == pytest.approx(-load[:3], rel=STATIC)
    moment = sum(
        rest.forces[f"bush {i}"].torque[-1] + np.cross(corner, rest.forces[f"bush {i}"].force[-1])
        for i, corner in enumerate(CORNERS)
    )
    assert moment == pytest.approx(-load[3:], rel=1e-5)


def test_pendulum_comes_to_rest_below_its_hinge() -> None:
    """No elastic stiffness at all: the geometric one alone finds the static state, from 70 degrees away."""
    scene = Scene(gravity=(0.0, 0.0, -9.81))
    a = np.radians(70.0)
    body = scene.add_rigid_body(MASS, INERTIA, name="bob", position=(np.sin(a), 0.0, -np.cos(a)))
    hinge = scene.add(joints.Revolute(scene.ground, body.at((-np.sin(a), 0.0, np.cos(a))), axis=(0, 1, 0)))
    rest = find_equilibrium(scene)
    assert rest.status == "completed", rest.message
    assert rest.bodies["bob"].position[-1] == pytest.approx([0.0, 0.0, -1.0], abs=1e-8)
    assert rest.joints[str(hinge.name)].force[-1] == pytest.approx([0.0, 0.0, MASS * 9.81], abs=1e-6)


def test_spring_hung_body_finds_its_place() -> None:
    """A weight on a linear spring, 40 degrees off the vertical at first, hangs plumb below: l = l_0 + m g / k."""
    k, g = 400.0, 9.81
    scene = Scene(gravity=(0.0, 0.0, -g))
    body = scene.add_rigid_body(MASS, INERTIA, name="bob", position=(0.6, 0.0, -0.75))
    scene.add(forces.SpringDamper(scene.ground.at((0, 0, 0)), body.at((0, 0, 0.1)), k, free_length=0.8, name="rope"))
    rest = find_equilibrium(scene)
    assert rest.status == "completed", rest.message
    assert rest.forces["rope"].deformation[-1, 0] == pytest.approx(0.8 + MASS * g / k, rel=1e-8)
    assert rest.bodies["bob"].position[-1, 2] == pytest.approx(-(0.9 + MASS * g / k), rel=1e-6)


def test_run_from_equilibrium_stays_there() -> None:
    scene = Scene(gravity=(0.0, 0.0, -9.81))
    body = scene.add_rigid_body(MASS, INERTIA, name="body")
    for corner in CORNERS:
        scene.add(forces.Bushing(scene.ground, body.at(corner), full_matrix(1e5), 1e-3 * full_matrix(1e5)))
    history = run_checked(scene, 0.1, 1e-3, start="equilibrium")
    assert np.abs(history.bodies["body"].position - history.bodies["body"].position[0]).max() < 1e-10
    assert history.energy["kinetic"].max() < 1e-12


@pytest.mark.parametrize("size", [1e-3, 4e3])
def test_forces_that_cancel_on_a_body_leave_it_at_rest(size: float) -> None:
    """As those of a bolt: what round-off leaves of them is no load that nothing carries."""
    strip = mesh_box((0.2, 0.01, 0.008), (8, 1, 1), center=(0.1, 0.0, 0.004))
    for side in ("z_min", "z_max"):
        strip = strip.select(f"head {side}", side, lambda c: np.abs(c[:, 0] - 0.1) < 0.03)
    interfaces = {"x_min": "rigid", "head z_min": "average", "head z_max": "average"}
    reduced = reduce(strip, STEEL, interfaces=interfaces, modes=2, cache=False, progress=False)
    scene = Scene(gravity=(0.0, 0.0, 0.0))
    body = scene.add_body(reduced, name="strip")
    scene.add(joints.Fixed(scene.ground, body["x_min"]))
    for name, sign in (("head z_min", 1.0), ("head z_max", -1.0)):
        scene.add(forces.PointForce(body[name], (size, (0.0, 0.0, sign))))
    rest = find_equilibrium(scene)
    assert rest.status == "completed", rest.message
    assert np.abs(rest.joints["fixed_1"].force[-1]).max() < 1e-9 * size


def test_spiral_spring_counts_its_turns() -> None:
    """A torsional pendulum wound up by two and a half turns swings back and forth through half turns unharmed."""
    k, wound = 3.0, 5.0 * np.pi
    errors = []
    for step in (4e-3, 2e-3):
        scene, body = free_body()
        hinge = scene.add(joints.Revolute(scene.ground, body.at((0, 0, 0)), axis=(0, 0, 1), name="hinge"))
        scene.add(forces.TorsionalSpringDamper(hinge, k, reference=wound, name="spiral"))
        history = run_checked(scene, 4.0, step)
        exact = wound * (1.0 - np.cos(np.sqrt(k / INERTIA[2]) * history.time))
        errors.append(float(np.abs(history.forces["spiral"].deformation[:, 0] - exact).max() / wound))
        assert history.joints["hinge"].coordinate == pytest.approx(
            history.forces["spiral"].deformation[:, 0], abs=1e-6 * wound
        )
        # of a generalised-alpha run: the energy that the integrator takes, at most
        stored = history.energy["kinetic"] + history.energy["potential"]
        assert np.abs(stored / stored[0] - 1.0).max() < 1e-2
    assert np.log2(errors[0] / errors[1]) > 1.8 and errors[1] < 2e-3


def test_bearing_holds_a_spinning_rotor_still() -> None:
    """Forty turns under weight: deflection m g / k, speed lost by spin damping alone, exp(-d t / J)."""
    k, d, g, speed = 2e5, 0.02, 9.81, 250.0
    scene = Scene(gravity=(0.0, 0.0, -g))
    body = scene.add_rigid_body(MASS, INERTIA, name="rotor", angular_velocity=(0.0, speed, 0.0))
    scene.add(forces.BearingSpring(
        scene.ground, body.at((0, 0, 0)), axis=(0, 1, 0), radial=k, axial=k, tilt=1e3, radial_damping=50.0,
        spin_damping=d, name="bearing",
    ))  # fmt: skip
    history = run_checked(scene, 1.0, 1e-3, start="equilibrium")
    rotor = history.bodies["rotor"]
    assert rotor.position[:, 2] == pytest.approx(-MASS * g / k, rel=1e-6)
    exact = speed * np.exp(-d / INERTIA[1] * history.time)
    assert rotor.angular_velocity[:, 1] == pytest.approx(exact, rel=1e-5)
    assert history.forces["bearing"].force[:, 2] == pytest.approx(MASS * g, rel=1e-6)


def test_bearing_may_be_a_damper_alone() -> None:
    """Without stiffness a body coasts down, exp(-d t/m)."""
    d, speed = 20.0, 0.5
    scene = Scene()
    body = scene.add_rigid_body(MASS, INERTIA, name="body", velocity=(speed, 0.0, 0.0))
    scene.add(forces.BearingSpring(scene.ground, body, axis=(0, 1, 0), radial=0.0, radial_damping=d))
    history = run_checked(scene, 0.2, 5e-4)
    exact = speed * np.exp(-d / MASS * history.time)
    assert history.bodies["body"].velocity[:, 0] == pytest.approx(exact, rel=1e-5)


def test_cross_stiffness_drives_forward_whirl() -> None:
    """m z.. + d z. + (k - i c) z = 0 with z = x + i y: a forward whirl grows with Re(lambda); its work is the energy
    that comes in."""
    k, c, d = 8e3, 400.0, 2.0
    s = np.roots([MASS, d, k - 1j * c])
    grow = s[np.argmax(s.real)]
    assert grow.real > 0.0 and grow.imag > 0.0
    errors = []
    for step in (1e-3, 5e-4):
        scene = Scene()
        x0 = 1e-3
        rate = grow * x0
        body = scene.add_rigid_body(MASS, INERTIA, name="body", velocity=(rate.real, rate.imag, 0.0))
        scene.add(forces.BearingSpring(
            scene.ground, body.at((-x0, 0, 0)), axis=(0, 0, 1), radial=k, cross=c, radial_damping=d, tilt=1e3,
            point=(0, 0, 0),
        ))  # fmt: skip
        # the bearing is unloaded at the initial pose: a constant force makes the offset instead
        axes = np.stack(_bearing_axes())
        x, y, _ = axes @ np.array([x0, 0.0, 0.0])
        local = np.array([k * x + c * y, -c * x + k * y, 0.0])
        scene.add(forces.PointForce(body.at((0, 0, 0)), -(axes.T @ local)))
        history = run_checked(scene, 0.5, step)
        z = history.bodies["body"].position
        found = x0 + z[:, 0] + 1j * z[:, 1]
        exact = x0 * np.exp(grow * history.time)
        errors.append(float(np.abs(found - exact).max() / np.abs(exact).max()))
        e = history.energy
        gained = np.diff(e["kinetic"] + e["potential"]).sum() + e["damping"][-1] - e["force_work"][-1]
        assert abs(gained) < 1e-2 * np.abs(e["force_work"]).max()
    assert np.log2(errors[0] / errors[1]) > 1.8 and errors[1] < 2e-2


def _bearing_axes() -> tuple[np.ndarray, ...]:
    from warpffrf.model.surfaces.fit import reference_direction

    e_a = np.array([0.0, 0.0, 1.0])
    e_x = reference_direction(e_a)
    return e_x, np.cross(e_a, e_x), e_a


def test_a_bushing_of_lower_rank_leaves_its_free_directions_alone() -> None:
    """Stiffness along one slanted direction only, damping along another: a body slides freely across both."""
    u, v = np.array([1.0, 1.0, 0.0]) / 2**0.5, np.array([1.0, -1.0, 0.0]) / 2**0.5
    K, D = np.zeros((6, 6)), np.zeros((6, 6))
    K[:3, :3], D[:3, :3] = 900.0 * np.outer(u, u), 4.0 * np.outer(v, v)
    scene, body = free_body(velocity=u + v + np.array([0.0, 0.0, 1.0]), angular_velocity=(0.0, 0.0, 2.0))
    scene.add(forces.Bushing(scene.ground, body.at((0, 0, 0)), K, D, name="slide"))
    history = run_checked(scene, 0.5, 1e-3)
    t, x = history.time, history.bodies["body"].position
    w = np.sqrt(900.0 / MASS)
    assert x @ u == pytest.approx(np.sin(w * t) / w, abs=2e-3 / w)
    assert x @ v == pytest.approx(MASS / 4.0 * (1.0 - np.exp(-4.0 / MASS * t)), rel=1e-5, abs=1e-9)
    assert x[:, 2] == pytest.approx(t, abs=1e-10)
    assert history.bodies["body"].angular_velocity[:, 2] == pytest.approx(2.0, rel=1e-9)
    rest = find_equilibrium(_with_ground_springs(K, D))
    assert rest.status == "completed", rest.message  # a pure damper carries nothing at rest


def _with_ground_springs(K: np.ndarray, D: np.ndarray) -> Scene:
    scene = Scene(gravity=(0.0, -9.81, 0.0))
    body = scene.add_rigid_body(MASS, INERTIA, name="body")
    scene.add(forces.Bushing(scene.ground, body.at((0, 0, 0)), K, D))
    scene.add(forces.Bushing(scene.ground, body.at((0.1, 0, 0)), 10.0 * STIFFNESS))
    return scene


def test_preload_of_a_bushing_pushes_at_the_initial_pose() -> None:
    """The force on the second body is minus the law, in the axes of the first port's marker."""
    axes = rot.rotation_vector_matrix(np.array([0.2, 0.5, -0.3]))
    preload = np.array([3.0, -2.0, 1.0, 0.1, 0.2, -0.3])
    scene, body = free_body()
    scene.add(forces.Bushing(scene.ground, body.at((0, 0, 0)), STIFFNESS, axes=axes, preload=preload, name="bush"))
    history = run_checked(scene, 1e-3, 1e-3)
    bush = history.forces["bush"]
    assert bush.force[0] == pytest.approx(-axes @ preload[:3], rel=1e-6)
    assert bush.torque[0] == pytest.approx(-axes @ preload[3:], rel=1e-6)
    assert history.bodies["body"].acceleration[0] == pytest.approx(-axes @ preload[:3] / MASS, rel=1e-6)


@pytest.mark.parametrize("frame", ["world", "body"])
def test_torque_spins_a_body_up_and_works(frame: Any) -> None:
    """About a principal axis: omega = T t / J, work = J omega^2 / 2 exactly, for a ramped torque T = r t: r t^2/2J."""
    turn = np.array([0.0, 0.0, np.sin(0.3), np.cos(0.3)])
    scene = Scene()
    body = scene.add_rigid_body(MASS, INERTIA, name="body", rotation=turn)
    rate = 40.0
    signal = signals.Ramp(0.0, rate, duration=1.0)
    scene.add(forces.PointTorque(body.at((0.3, 0, 0)), (0.0, 0.0, signal), frame=frame, name="motor"))
    history = run_checked(scene, 1.0, 5e-3)
    omega = history.bodies["body"].angular_velocity[:, 2]
    assert omega == pytest.approx(0.5 * rate * history.time**2 / INERTIA[2], abs=1e-3)
    e = history.energy
    assert e["force_work"][-1] == pytest.approx(e["kinetic"][-1], rel=1e-3)
    assert history.forces["motor"].torque[:, 2] == pytest.approx(rate * history.time)


def test_body_torque_turns_with_the_body_and_a_world_one_does_not() -> None:
    """A wheel spins at a held speed about z; a body torque about x then averages to nothing, a world one does not."""
    frames: Any = (("world", True), ("body", False))
    for frame, grows in frames:
        scene = Scene()
        body = scene.add_rigid_body(MASS, (0.1, 0.1, 0.1), name="body", angular_velocity=(0.0, 0.0, 20.0 * np.pi))
        scene.add(forces.PointTorque(body.at((0, 0, 0)), (1e-2, 0.0, 0.0), frame=frame))
        history = run_checked(scene, 0.1, 1e-4)  # one turn
        omega = history.bodies["body"].angular_velocity[-1, :2]
        expected = np.array([1e-2 * 0.1 / 0.1, 0.0]) if grows else np.zeros(2)
        assert omega == pytest.approx(expected, abs=1e-5)


# --- flexible bodies


def softly_held(body: ReducedBody, K: np.ndarray) -> tuple[Scene, Any]:
    scene = Scene()
    roller = scene.add_body(body, name="roller", damping=0.05)
    scene.add(forces.Bushing(scene.ground, roller["bore"], K, 1e-4 * K, name="bush"))
    return scene, roller


HOLD = np.diag([1e7, 1e7, 1e7, 1e4, 1e4, 1e4])


def test_torque_on_a_flexible_interface_is_balanced_there(plain_body: ReducedBody) -> None:
    """A force and a torque on the interface that the bushing holds: nothing else bends; the marker's rotation is
    M/k."""
    scene, roller = softly_held(plain_body, HOLD)
    load, torque = np.array([50.0, 0.0, -80.0]), np.array([2.0, 0.5, -1.0])
    scene.add(forces.PointForce(roller["bore"], load))
    scene.add(forces.PointTorque(roller["bore"], torque))
    rest = find_equilibrium(scene)
    assert rest.status == "completed", rest.message
    bush = rest.forces["bush"]
    assert bush.force[-1] == pytest.approx(-load, rel=STATIC)
    assert bush.torque[-1] == pytest.approx(-torque, rel=1e-4)  # both act at x_b up to the bushing's own rotation
    assert bush.deformation[-1, :3] == pytest.approx(load / 1e7, abs=1e-3 * np.abs(load).max() / 1e7)
    assert bush.deformation[-1, 3:] == pytest.approx(torque / 1e4, rel=1e-3)
    assert np.abs(rest.bodies["roller"].modal[-1]).max() < 1e-9


def test_cosine_pressure_is_carried_with_its_resultant(plain_body: ReducedBody) -> None:
    """p cos(theta) on the rim: resultant -pi R L p, less the factor (sin(h/2)/(h/2))^2 of nodes of pitch h; its modal
    forces are the virtual work of the modes, summed here by independent quadrature."""
    p = 1e5
    surface = plain_body.contact_surfaces["rim"]
    e_0 = np.asarray(surface.grid.e_0)
    scene, roller = softly_held(plain_body, HOLD)
    axis_point, R = np.asarray(surface.shape.axis_point), surface.shape.radius
    load = forces.SurfaceLoad(roller["rim"], p, distribution=lambda x: (x - axis_point) @ e_0 / R, name="wind")
    scene.add(load)
    length, h = np.ptp(surface.grid.z), surface.grid.pitch
    resultant = -np.pi * R * length * p * (np.sin(0.5 * h) / (0.5 * h)) ** 2 * e_0
    rest = find_equilibrium(scene)
    assert rest.status == "completed", rest.message
    assert rest.forces["wind"].force[-1] == pytest.approx(resultant, abs=1e-7 * np.abs(resultant).max())
    assert rest.forces["bush"].force[-1] == pytest.approx(-resultant, abs=1e-6 * np.abs(resultant).max())
    modal = load.load().modal
    columns = surface.grid.columns
    phi = np.asarray(surface.mode_normal).reshape(columns, surface.grid.rows, -1)
    fine, expected = 12, np.zeros(phi.shape[2])
    x, w = np.polynomial.legendre.leggauss(fine)
    x, w = 0.5 * (x + 1.0), 0.5 * w
    cosine = np.cos(surface.grid.theta_start + h * np.arange(columns + 1))
    for a, wa in zip(x, w, strict=True):
        pressure = (1 - a) * cosine[:-1] + a * cosine[1:]
        along = (1 - a) * phi + a * np.roll(phi, -1, axis=0)
        for k, dz in enumerate(np.diff(surface.grid.z)):
            normal = 0.5 * (along[:, k] + along[:, k + 1])  # linear along z, constant pressure
            expected -= wa * h * dz * R * pressure @ normal
    assert modal == pytest.approx(expected, abs=1e-10 * np.abs(expected).max())


def test_pulsating_pressure_works_on_the_modes(plain_body: ReducedBody) -> None:
    """A free roller under a pressure that comes and goes: no resultant, energy from the ledger's work of forces."""
    p = signals.Table([0.0, 2e-4, 4e-4, 6e-4], [0.0, 5e6, 1e6, 1e6], cubic=True)
    drifts = []
    for step in (4e-6, 2e-6):
        scene = Scene()
        roller = scene.add_body(plain_body, name="roller", damping=0.02)
        e_0 = np.asarray(plain_body.contact_surfaces["rim"].grid.e_0)
        two_lobes = forces.SurfaceLoad(roller["rim"], p, distribution=lambda x, e=e_0: (x @ e) ** 2 / 0.05**2)
        scene.add(two_lobes)
        history = run_checked(scene, 6e-4, step)
        e = history.energy
        assert np.abs(history.bodies["roller"].position).max() < 1e-10
        assert np.abs(e["force_work"]).max() > 0.0
        drifts.append(float(np.abs(e["numerical"]).max() / np.abs(e["strain"]).max()))
    assert drifts[1] < 1e-2 and drifts[1] < drifts[0] / 3.0


@pytest.fixture(scope="module")
def open_body() -> ReducedBody:
    """A coarse roller: one end of the bore keeps its nodes, the other is rigid; the rim can be loaded."""
    mesh = roller(0.05, 0.015, 0.06, sectors=12, layers=2, axial=4)
    bore = mesh.facets("bore")
    y = bore.centers(mesh.points)[:, 1]
    sets = {"rim": mesh.facets("rim"), "left": bore.kept(y < -0.02), "right": bore.kept(y > 0.02)}
    kinds = {"left": "free", "right": "rigid"}
    mesh = Mesh(mesh.points, mesh.cells, sets)
    return reduce(mesh, STEEL, interfaces=kinds, max_frequency=15e3, cache=False, progress=False)


def test_nodal_load_on_a_free_interface_works_on_all_its_nodes(open_body: ReducedBody) -> None:
    """Forces that pull the bore oval have no resultant but deform the body: energy in equals strain at rest times 2."""
    scene = Scene()
    body = scene.add_body(open_body, name="body", damping=0.3)
    interface = open_body.interfaces["left"]
    assert interface.nodes is not None and interface.node_modes is not None
    pull = interface.nodes * np.array([1.0, 0.0, -1.0]) * 1e5
    item = scene.add(forces.NodalLoad(body["left"], pull, name="oval"))
    load = item.load()
    assert load.modal == pytest.approx(np.einsum("mki,ki->m", interface.node_modes, pull))
    scene.add(forces.Bushing(scene.ground, body["right"], HOLD))
    rest = find_equilibrium(scene)
    assert rest.status == "completed", rest.message
    omega = 2.0 * np.pi * open_body.frequencies
    assert rest.bodies["body"].modal[-1] == pytest.approx(
        load.modal / omega**2, abs=1e-6 * np.abs(load.modal / omega**2).max()
    )
    assert np.abs(rest.forces["oval"].force[-1]).max() < 1e-6 * np.abs(pull).max()


# --- refused


def refused() -> dict[str, tuple[Any, str]]:
    scene, body = free_body()
    port = body.at((0, 0, 0))
    ball = joints.Spherical(scene.ground, port, name="ball")
    slide = joints.Cylindrical(scene.ground, port, axis=(0, 0, 1), name="slide")
    bad = np.diag(STIFFNESS)
    bad[0, 1] = bad[1, 0] = 2e3
    bare = np.zeros((6, 6))
    bare[0, 0], bare[0, 3] = 1.0, 1.0
    return {
        "negative": (lambda: forces.Bushing(scene.ground, port, bad), "must not be negative in any direction"),
        "bare": (lambda: forces.Bushing(scene.ground, port, bare), r"entry \(3, 3\) is zero"),
        "nothing": (lambda: forces.Bushing(scene.ground, port, np.zeros(6)), "both zero"),
        "left-handed": (
            lambda: forces.Bushing(scene.ground, port, STIFFNESS, axes=np.diag([1, 1, -1])), "right-handed",
        ),
        "same body": (lambda: forces.Bushing(port, body.at((1, 0, 0)), STIFFNESS), "which does not deform"),
        "shape": (lambda: forces.Bushing(scene.ground, port, np.ones(3)), r"must have shape \(6"),
        "no axis": (lambda: forces.BearingSpring(scene.ground, port, axis=(0, 0, 0), radial=1.0), "zero length"),
        "coupling": (
            lambda: forces.BearingSpring(scene.ground, port, axis=(0, 0, 1), radial=1.0, tilt=1.0, radial_tilt=2.0),
            "must be below",
        ),
        "no spring": (lambda: forces.BearingSpring(scene.ground, port, axis=(0, 0, 1), radial=0.0), "no stiffness or"),
        "skew alone": (
            lambda: forces.BearingSpring(
                scene.ground, port, axis=(0, 0, 1), radial=0.0, cross=1.0, radial_damping=1.0
            ),
            "requires radial above zero",
        ),
        "no coordinate": (lambda: forces.TorsionalSpringDamper(ball, 1.0), "has none"),
        "which": (lambda: forces.JointSpringDamper(slide, 1.0), "coordinate="),
        "unknown coordinate": (lambda: forces.JointSpringDamper(slide, 1.0, coordinate="twist"), "translation"),
        "torque on ground": (lambda: forces.PointTorque(scene.ground, (0, 0, 1)), "has no effect"),
        "no surface": (lambda: forces.SurfaceLoad(port, 1.0), "contact surface of a flexible body"),
        "no nodes": (lambda: forces.NodalLoad(port, (0, 0, 1)), "keeps no nodes"),
    }  # fmt: skip


@pytest.mark.parametrize("case", sorted(refused()))
def test_wrong_elements_are_refused(case: str) -> None:
    make, message = refused()[case]
    with pytest.raises(InputError, match=message):
        make()


def test_a_bushing_between_ports_apart_asks_for_a_point() -> None:
    scene, body = free_body(position=(0.0, 0.0, 1.0))
    item = scene.add(forces.Bushing(scene.ground.at((0, 0, 0)), body.at((0, 0, 0)), STIFFNESS, name="gap"))
    with pytest.raises(InputError, match="1 m apart"):
        item.law()
    slack = forces.Bushing(scene.ground, body.at((0, 0, 0)), STIFFNESS, preload=np.ones(6), name="no rotation")
    slack.stiffness[3:, 3:] = 0.0
    with pytest.raises(InputError, match="preload acts in a direction"):
        slack.law()


def test_a_bushing_rotated_too_far_is_noted() -> None:
    """Its law jumps at half a turn; one that resists displacement alone may turn for ever."""
    for stiffness, torque, noted in (
        ((1, 1, 1, 1, 1, 1), 50.0, True),
        ((1, 1, 1, 1, 1, 1), 0.1, False),
        ((1, 1, 1, 0, 0, 0), 50.0, False),
    ):
        scene = Scene()
        body = scene.add_rigid_body(1.0, (1.0, 1.0, 1.0), name="body")
        scene.add(forces.Bushing(scene.ground, body.at((0, 0, 0)), stiffness, name="mount"))
        scene.add(forces.PointTorque(body.at((0, 0, 0)), (0.0, 0.0, torque)))
        notes = run(scene, 0.5, step=1e-2, progress=False).notes
        assert any("bushing 'mount': its ports rotated by" in note for note in notes) == noted
