"""Modes of scenes: pendulums, chains, taut strings, rotors, beams and rollers against closed forms and FE models."""

from __future__ import annotations

import numpy as np
import pytest
import scipy.linalg
import scipy.sparse.linalg as spla

from scenes.rollers import STEEL, guided_pair
from warpffrf.model import forces, joints, signals
from warpffrf.model import rotation as rot
from warpffrf.model.errors import InputError
from warpffrf.model.integrators import EnergyMomentum
from warpffrf.model.mesh import Mesh, box
from warpffrf.model.scene import Scene
from warpffrf.offline import reduce
from warpffrf.offline.fe import assemble, assign
from warpffrf.online import Engine, find_equilibrium, run
from warpffrf.online.start.consistent import start_consistently
from warpffrf.online.start.static_equilibrium import settle
from warpffrf.online.vibrations.eigenmodes import complex_modes, find_modes, null_space
from warpffrf.online.vibrations.linearise import linearise
from warpffrf.output.modes_result import eigenmodes
from warpffrf.output.options import RunOptions
from warpffrf.output.result import Result
from warpffrf.output.simulate import simulate

GRAVITY = 9.81
CLOSED = 1e-9  # of a frequency: differences of forces, 1e-11 of them, and the static state, 1e-12 m


def angular(values: np.ndarray) -> np.ndarray:
    """Frequencies [rad/s] of eigenvalues."""
    return np.abs(values)


def hanging() -> Scene:
    """A compound pendulum of 2 kg, its centre 0.5 m below a hinge."""
    scene = Scene(gravity=(0.0, 0.0, -GRAVITY))
    bob = scene.add_rigid_body(2.0, (0.02, 0.02, 0.02), name="bob", position=(0.0, 0.0, -0.5))
    scene.add(joints.Revolute(scene.ground, bob.at((0, 0, 0.5)), axis=(0, 1, 0), name="hinge"))
    return scene


def test_pendulum() -> None:
    modes = eigenmodes(hanging())
    exact = np.sqrt(2.0 * GRAVITY * 0.5 / (0.02 + 2.0 * 0.25))
    np.testing.assert_allclose(modes.frequencies, [exact / (2.0 * np.pi)], rtol=CLOSED)
    assert abs(modes.damping_ratios[0]) < CLOSED
    shape = modes.shape(0, "bob")  # turns about the hinge: the centre moves by 0.5 m x angle; kinetic energy 1/2 J
    np.testing.assert_allclose(shape.translation, np.cross(shape.rotation, (0.0, 0.0, -0.5)), atol=1e-9)
    np.testing.assert_allclose(abs(shape.rotation[1]), 1.0 / np.sqrt(0.52), rtol=1e-9)
    np.testing.assert_allclose(modes.energy_shares(0)["bob"], 1.0, rtol=1e-12)


def test_pendulum_on_its_head_grows() -> None:
    scene = Scene(gravity=(0.0, 0.0, GRAVITY))
    bob = scene.add_rigid_body(2.0, (0.02, 0.02, 0.02), name="bob", position=(0.0, 0.0, -0.5))
    scene.add(joints.Revolute(scene.ground, bob.at((0, 0, 0.5)), axis=(0, 1, 0)))
    modes = eigenmodes(scene, about="initial")
    exact = np.sqrt(2.0 * GRAVITY * 0.5 / 0.52)
    np.testing.assert_allclose(np.sort(np.real(modes.eigenvalues)), [-exact, exact], rtol=CLOSED)
    assert modes.damping_ratios.min() < -1.0 + CLOSED and "unstable" in modes.report()


def test_double_pendulum() -> None:
    """Two compound links: the mass and stiffness matrices of their absolute angles."""
    m1, m2, a1, a2, length, J1, J2 = 2.0, 1.5, 0.3, 0.35, 0.6, 0.06, 0.05
    scene = Scene(gravity=(0.0, 0.0, -GRAVITY))
    first = scene.add_rigid_body(m1, (J1,) * 3, name="first", position=(0, 0, -a1))
    second = scene.add_rigid_body(m2, (J2,) * 3, name="second", position=(0, 0, -length - a2))
    scene.add(joints.Revolute(scene.ground, first.at((0, 0, a1)), axis=(0, 1, 0)))
    scene.add(joints.Revolute(first.at((0, 0, a1 - length)), second.at((0, 0, a2)), axis=(0, 1, 0)))
    M = [[J1 + m1 * a1**2 + m2 * length**2, m2 * length * a2], [m2 * length * a2, J2 + m2 * a2**2]]
    K = np.diag([m1 * a1 + m2 * length, m2 * a2]) * GRAVITY
    exact = np.sqrt(scipy.linalg.eigh(K, np.array(M), eigvals_only=True))
    np.testing.assert_allclose(angular(find_modes(scene).eigenvalues), exact, rtol=CLOSED)


@pytest.mark.parametrize("held", [True, False])
def test_chain_of_masses_with_dampers(held: bool) -> None:
    """Three masses in a line, non-classical dampers, one overdamped; free ends leave a motion at 0 Hz."""
    m, k, c = np.array([1.0, 2.0, 0.5]), [4e4, 1e5, 2e5], [3.0, 500.0, 7.0]
    scene = Scene()
    ports = [scene.ground.at((0, 0, 0))]
    for i in range(3):
        body = scene.add_rigid_body(m[i], (1, 1, 1), name=f"m{i}", position=(i + 1.0, 0, 0))
        scene.add(joints.Prismatic(scene.ground, body.at((0, 0, 0)), axis=(1, 0, 0)))
        ports.append(body.at((0, 0, 0)))
    B = np.eye(3) - np.eye(3, k=-1)  # stretches of the springs
    on = [held, True, True]
    for i in range(3):
        if on[i]:
            scene.add(forces.SpringDamper(ports[i], ports[i + 1], k[i], c[i]))
    K, D = (B.T @ np.diag(np.array(x) * on) @ B for x in (k, c))
    A = np.block([[np.zeros((3, 3)), np.eye(3)], [-K / m[:, None], -D / m[:, None]]])
    exact = np.linalg.eigvals(A)
    exact = exact[exact.imag >= -1e-9]
    exact = exact[np.argsort(np.abs(exact))]
    found = find_modes(scene, about="initial").eigenvalues
    if not held:
        assert found[0] == 0.0
        exact, found = exact[np.abs(exact) > 1.0], found[1:]
    assert len(found) == len(exact)
    np.testing.assert_allclose(found, exact, rtol=1e-8)


def test_a_motion_without_stiffness_counts_once_whatever_its_round_off() -> None:
    """Its double eigenvalue 0 comes out as a pair, whose shapes may have imaginary parts of round-off."""
    noise = 1e-21j * np.array([0.0, 1.0])
    pair = np.stack([np.array([1.0, 0.0]) + noise, np.array([1.0, 0.0]) - noise], axis=1)

    def solved(*_: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        return np.array([1e-15 + 3e-6j, 1e-15 - 3e-6j]), pair

    values, shapes = complex_modes(np.eye(2), np.zeros((2, 2)), np.zeros((2, 2)), np.zeros((0, 2)), solve=solved)
    assert len(values) == 1 and values[0] == 0.0
    assert np.linalg.norm(shapes) > 0.0


def test_taut_string_holds_a_mass_sideways() -> None:
    """Geometric stiffness: two springs of tension T and length L hold a mass sideways by 2 T/L."""
    k, length, free, mass = 1e5, 0.4, 0.39, 0.3
    scene = Scene()
    bead = scene.add_rigid_body(mass, (1e-4,) * 3, name="bead")
    scene.add(forces.SpringDamper(scene.ground.at((-length, 0, 0)), bead.at((0, 0, 0)), k, free_length=free))
    scene.add(forces.SpringDamper(scene.ground.at((length, 0, 0)), bead.at((0, 0, 0)), k, free_length=free))
    modes = eigenmodes(scene, about="initial")
    tension = k * (length - free)
    exact = [0.0, 0.0, 0.0, *np.sqrt(np.array([2.0 * tension / length] * 2 + [2.0 * k]) / mass)]
    np.testing.assert_allclose(modes.frequencies * 2.0 * np.pi, exact, rtol=1e-8)


def test_bushing_with_full_matrices() -> None:
    """A rigid body on a bushing: the pair (K, M) and the damping matrix as given; the centre is on its point."""
    rng = np.random.default_rng(3)
    X, Y = rng.normal(size=(2, 6, 6))
    K, D = 1e6 * (X @ X.T + np.eye(6)), 1e2 * (Y @ Y.T)
    J = (0.3, 0.4, 0.5)
    scene = Scene()
    body = scene.add_rigid_body(3.0, J, name="body")
    scene.add(forces.Bushing(scene.ground.at((0, 0, 0)), body.at((0, 0, 0)), stiffness=K, damping=D))
    M = np.diag([3.0, 3.0, 3.0, *J])
    exact, _ = complex_modes(M, D, K, np.zeros((0, 6)))
    A = np.block([[np.zeros((6, 6)), np.eye(6)], [-np.linalg.solve(M, K), -np.linalg.solve(M, D)]])
    direct = np.linalg.eigvals(A)
    direct = direct[direct.imag > 0]
    np.testing.assert_allclose(exact, direct[np.argsort(np.abs(direct))], rtol=1e-10)
    np.testing.assert_allclose(find_modes(scene, about="initial").eigenvalues, exact, rtol=1e-8)


def test_differences_agree_with_the_tangent_of_the_step() -> None:
    """ACC M + VEL D + K with the springs condensed is the retained matrix of the kernels, joints loaded, at rest."""
    scene = Scene(gravity=(0.5, -1.0, -GRAVITY))
    turn = rot.quaternion(rot.rotation_vector_matrix(np.array([0.3, -0.2, 0.5])))
    a = scene.add_rigid_body(2.0, (0.05, 0.06, 0.07), name="a", position=(0.1, 0, 0), rotation=turn)
    b = scene.add_rigid_body(1.0, (0.02, 0.03, 0.04), name="b", position=(0.5, 0.2, 0))
    c = scene.add_rigid_body(1.0, (0.02, 0.03, 0.04), name="c", position=(0.5, 0.9, 0))
    scene.add(joints.Spherical(scene.ground, a.at((0.1, 0.05, 0))))
    scene.add(joints.Distance(a.at((0.2, 0, 0)), b.at((0, 0, 0.1))))
    scene.add(joints.Revolute(b.at((0, 0.3, 0)), c.at((0, -0.4, 0)), axis=(0.6, 0.8, 0)))
    scene.add(forces.SpringDamper(scene.ground.at((0, 1, 1)), b.at((0.1, 0, 0)), 2e3, 30.0, free_length=0.7))
    scene.add(forces.SpringDamper(scene.ground.at((1, 0, 1)), b.at((0, 0.1, 0)), 3e3, 20.0))
    scene.add(forces.SpringDamper(scene.ground.at((0, 0, 1)), a.at((0.1, 0, 0.1)), 4e3, 10.0, free_length=1.1))
    engine = Engine(scene)
    engine.initial_rates()
    start_consistently(engine)
    linear = linearise(engine)
    acc, vel = 1e6, 1e3
    engine.control(run=1, moved=1, refresh=1, iteration=0)
    engine.clock(h=1e-20)
    engine.coefficients(acc=acc, vel=vel, beta=1.0, gamma=0.0, alpha_m=1.0, alpha_f=0.0)
    for name in ("dx", "psi"):
        getattr(engine.scratch, name).zero_()
    engine.graph.iterate()
    full = engine.scratch.tangent.numpy()[0]
    rigid = engine.compiled.model.rows.rigid.numpy()[: engine.compiled.row_count]
    soft = 18 + np.flatnonzero(rigid == 0)
    S = full[:18, :18] - full[:18, soft] @ np.linalg.solve(full[np.ix_(soft, soft)], full[soft, :18])
    S = linear.T.T @ S @ linear.T - acc * linear.M  # what springs and joints make, and gyroscopic terms
    np.testing.assert_allclose(vel * linear.D + linear.K, S, atol=1e-9 * np.abs(S).max())


def test_spinning_rotor_splits_forward_and_backward() -> None:
    """A symmetric rotor on anisotropic springs against its four equations of tilting; world axes serve."""
    J_p, J_t, spin, k_x, k_y = 0.02, 0.013, 300.0, 400.0, 900.0
    scene = Scene()
    rotor = scene.add_rigid_body(1.0, (J_t, J_t, J_p), name="rotor", angular_velocity=(0, 0, spin))
    arm = 0.1  # m: springs far away hold the tip of the axle, four of them
    scene.add(joints.Spherical(scene.ground, rotor.at((0, 0, 0))))
    for direction, k in (((1, 0, 0), k_x), ((0, 1, 0), k_y)):
        D = np.array(direction, float)
        for sign in (1.0, -1.0):
            far = scene.ground.at(sign * 1e3 * D + np.array([0, 0, arm]))
            scene.add(forces.SpringDamper(far, rotor.at((0, 0, arm)), 0.5 * k / arm**2))
    modes = eigenmodes(scene, about="initial")
    K, G = np.diag([k_y, k_x]), J_p * spin * np.array([[0.0, 1.0], [-1.0, 0.0]])
    A = np.block([[np.zeros((2, 2)), np.eye(2)], [-K / J_t, -G / J_t]])
    exact = np.sort(np.abs(np.linalg.eigvals(A)))[::2]
    np.testing.assert_allclose(angular(modes.eigenvalues), [0.0, *exact], rtol=1e-6, atol=1e-6)
    assert "world axes" in modes.report()


@pytest.mark.parametrize(("axis", "stable"), [(0, True), (1, False), (2, True)])
def test_free_body_spins_stably_about_its_outer_axes(axis: int, stable: bool) -> None:
    """Euler's equations in body axes: lambda^2 = -w^2 (J_a - J_b)(J_a - J_c)/(J_b J_c); +-i w is the turning of the
    axes themselves; positions in axes that turn go round at i w."""
    J, w = np.array([1.0, 2.0, 2.7]), 5.0
    scene = Scene()
    spin = np.zeros(3)
    spin[axis] = w
    turn = rot.quaternion(rot.rotation_vector_matrix(np.array([0.3, -0.2, 0.5])))
    scene.add_rigid_body(3.0, J, name="top", angular_velocity=rot.matrix(turn) @ spin, rotation=turn)
    values = find_modes(scene, about="initial").eigenvalues
    b, c = [i for i in range(3) if i != axis]
    square = -(w**2) * (J[axis] - J[b]) * (J[axis] - J[c]) / (J[b] * J[c])
    wobble = np.sqrt(complex(square))
    assert np.abs(values - wobble).min() < 1e-6 and np.abs(values - 1j * w).min() < 1e-6
    assert (np.real(values).max() < 1e-4) == stable


def beam_mesh(cells: int, length: float) -> Mesh:
    """hex8 beam along z from the origin, its end there `z_min`."""
    return box((0.02, 0.03, length), (1, 1, cells), center=(0.0, 0.0, 0.5 * length), order=1)


def beam_modes(mesh: Mesh, count: int) -> np.ndarray:
    """Frequencies [Hz] of the finite-element model with its end at z = 0 clamped."""
    K, M = assemble(mesh.points, mesh.cells, assign(mesh, STEEL))
    free = np.setdiff1d(np.arange(len(mesh.points)), np.flatnonzero(mesh.points[:, 2] < 1e-9))
    dofs = (3 * free[:, None] + np.arange(3)).ravel()
    K, M = K.tocsc()[dofs][:, dofs], M.tocsc()[dofs][:, dofs]
    values = spla.eigsh(K, count, M, sigma=0.0, return_eigenvectors=False)
    return np.sqrt(np.sort(values)) / (2.0 * np.pi)


def test_clamped_beam_converges_to_the_clamped_finite_element_model_from_above() -> None:
    """A free body on a Fixed joint: its attachment modes carry the clamp, more vibration modes the rest."""
    mesh = beam_mesh(10, 0.5)
    exact = beam_modes(mesh, 4)
    errors = []
    for count in (4, 12, 40):
        body = reduce(mesh, STEEL, interfaces={"z_min": "rigid"}, modes=count, cache=False, progress=False)
        scene = Scene()
        beam = scene.add_body(body, name="beam", damping=0.0, inertia="constant")
        scene.add(joints.Fixed(scene.ground, beam["z_min"]))
        modes = eigenmodes(scene, 4)
        errors.append(modes.frequencies / exact - 1.0)
        assert np.abs(modes.damping_ratios).max() < 1e-9
    assert np.min(errors) > -1e-8  # from above, to the accuracy of the differences
    assert np.all(errors[0] > errors[1]) and np.all(errors[1] > errors[2])
    assert errors[2].max() < 1e-6
    tip = np.argmax(body.surface.points[:, 2])
    u = modes.displacement(0, "beam")
    assert np.linalg.norm(u[tip]) > 0.99 * np.linalg.norm(u, axis=1).max()
    assert np.linalg.norm(u[body.surface.points[:, 2] < 1e-9], axis=1).max() < 1e-6 * np.linalg.norm(u[tip])


def test_modal_damping_shows_in_a_free_body() -> None:
    """A free body's elastic modes keep their ratios and frequencies, after six motions at 0 Hz."""
    body = reduce(beam_mesh(6, 0.3), STEEL, modes=5, cache=False, progress=False)
    ratios = np.array([0.0, 0.02, 0.3, 0.05, 0.01])
    scene = Scene()
    scene.add_body(body, name="beam", damping=ratios, inertia="constant")
    modes = eigenmodes(scene, about="initial")
    np.testing.assert_allclose(modes.frequencies, [*np.zeros(6), *body.frequencies], rtol=1e-9, atol=1e-6)
    np.testing.assert_allclose(modes.damping_ratios[6:], ratios, atol=1e-9)


def test_two_rollers_in_contact(plain_body) -> None:
    """Against the scene itself: the static stiffness is that of equilibria under neighbouring loads, and a small
    step of the load rings at the first frequency."""
    load, step = 5e3, 5.0
    deflection = []
    for more in (-step, step):
        history = find_equilibrium(guided_pair(plain_body, plain_body, load=load + more))
        deflection.append(history.bodies["carriage"].position[-1, 2])
    compliance = (deflection[0] - deflection[1]) / (2.0 * step)
    scene = guided_pair(plain_body, plain_body, load=load)
    engine = Engine(scene)
    assert settle(engine)
    linear = linearise(engine)
    S = 1.0 / np.sqrt(np.diag(linear.M))
    N = S[:, None] * null_space(linear.C * S)
    e = np.zeros(len(linear.M))
    e[6 * scene.body("carriage").index + 2] = 1.0
    static = e @ N @ np.linalg.lstsq(N.T @ linear.K @ N, N.T @ e, rcond=1e-14)[0]
    np.testing.assert_allclose(static, compliance, rtol=2e-4)  # the contact hardens: 1e-3 of the load to either side

    modes = eigenmodes(scene)
    first = int(np.argmax(modes.frequencies > 100.0))
    assert "closed contacts" in modes.report()
    pulse = signals.SmoothStep(load, load + step, duration=1e-4)
    moved = run(guided_pair(plain_body, plain_body, load=pulse), 4e-3, step=5e-6, start="equilibrium", progress=False)
    assert moved.status == "completed"
    late = moved.time > 2e-4
    z, time = moved.bodies["carriage"].position[late, 2], moved.time[late]
    z = z - deflection[1]
    before = np.flatnonzero((z[:-1] < 0.0) & (z[1:] >= 0.0))
    crossings = time[before] - z[before] * (time[1] - time[0]) / (z[before + 1] - z[before])
    period = np.diff(crossings).mean()
    np.testing.assert_allclose(1.0 / period, abs(modes.eigenvalues[first].imag) / (2.0 * np.pi), rtol=0.01)


def test_state_of_a_result() -> None:
    """About a run: its last positions; about an equilibrium: the equilibrium."""
    scene = hanging()
    rest = Result(find_equilibrium(scene))
    np.testing.assert_allclose(eigenmodes(scene, about=rest).eigenvalues, eigenmodes(scene).eigenvalues, rtol=1e-9)
    swung = Result(run(scene, 0.01, step=1e-3, progress=False))
    np.testing.assert_allclose(eigenmodes(scene, about=swung).eigenvalues, eigenmodes(scene).eigenvalues, rtol=1e-6)
    with pytest.raises(InputError, match="another scene"):
        eigenmodes(Scene(), about=rest)
    other = Scene()
    other.add_rigid_body(1.0, (1, 1, 1), name="stone")
    with pytest.raises(InputError, match="cannot be linearised; it must come .* with local_modes='quasi_static'"):
        eigenmodes(
            other,
            about=simulate(other, 0.01, step=1e-3, options=RunOptions(integrator=EnergyMomentum()), progress=False),
        )


def test_bad_input() -> None:
    scene = hanging()
    with pytest.raises(InputError, match="count must be a whole number of at least 1"):
        eigenmodes(scene, 0)
    with pytest.raises(InputError, match="about must be None"):
        eigenmodes(scene, about="rest")
    with pytest.raises(InputError, match="a Scene is needed"):
        eigenmodes(42)  # pyright: ignore[reportArgumentType]
    modes = eigenmodes(scene)
    with pytest.raises(InputError, match="mode 1 does not exist"):
        modes.shape(1, "bob")
    with pytest.raises(InputError, match="body 'bop' does not exist"):
        modes.shape(0, "bop")
    falling = Scene(gravity=(0, 0, -GRAVITY))
    falling.add_rigid_body(1.0, (1, 1, 1), name="stone")
    with pytest.raises(InputError, match="no equilibrium"):
        eigenmodes(falling)


def test_report_and_plot(plain_body) -> None:
    modes = eigenmodes(hanging())
    assert "bob 100 %" in modes.report() and "equilibrium" in repr(modes)
    ax = modes.plot()
    assert len(ax.patches) == 1 and "Hz" in ax.get_yticklabels()[0].get_text()
