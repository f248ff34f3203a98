"""Tables of coefficients, and the host integrators against sums over point masses, closed forms and each other."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from point_mass_body import PointMasses, momenta, point_masses, reduced_points

from references.oscillator import errors, roots
from studies.bodies.free_flight import deviations
from warpffrf.model import forces, joints, signals
from warpffrf.model import rotation as rot
from warpffrf.model.errors import InputError
from warpffrf.model.integrators import (
    HHT,
    INTEGRATORS,
    EnergyMomentum,
    GeneralizedAlpha,
    Newmark,
    RungeKutta4,
    roots_at_infinity,
)
from warpffrf.model.reduced.body import ReducedBody
from warpffrf.model.reduced.inertia import LEVELS, GeometricStiffness, body_torque, modal_forces
from warpffrf.model.scene import Scene
from warpffrf.online import History, run
from warpffrf.online.compile.inertia_plan import InertiaPlan
from warpffrf.online.free_flight import check_run
from warpffrf.online.free_flight.check_run import run_check
from warpffrf.online.free_flight.free_bodies import Motion, free_body
from warpffrf.scene_file.forms import snake_case

STEPPERS = [
    GeneralizedAlpha(0.0), GeneralizedAlpha(0.5), GeneralizedAlpha(0.8), GeneralizedAlpha(1.0),
    HHT(0.0), HHT(-0.1), HHT(-0.3), HHT(-1.0 / 3.0), Newmark(), Newmark(0.5, 0.3), Newmark(0.7, 0.36),
]  # fmt: skip
SECOND_ORDER = [i for i in STEPPERS if not (isinstance(i, Newmark) and i.gamma > 0.5)]
ORDER = 0.1  # a measured order is within this of the method's
ROUND_OFF = 1e-12  # relative, after some hundred steps
FREQUENCIES = np.array([3.0, 5.0, 8.0, 13.0])  # Hz
INFINITE = 1e5  # omega h


# --- coefficients


@pytest.mark.parametrize("integrator", STEPPERS, ids=str)
def test_no_root_lies_outside_the_unit_circle(integrator: Any) -> None:
    for frequency in np.logspace(-2, 4, 61):
        for ratio in (0.0, 0.1):
            assert np.abs(roots(integrator.coefficients, frequency, ratio)).max() < 1.0 + 1e-7


@pytest.mark.parametrize("integrator", STEPPERS, ids=str)
def test_roots_of_the_amplification_matrix_tend_to_those_of_the_closed_form(integrator: Any) -> None:
    """Coefficients of the characteristic polynomial: the roots themselves are double, and lose half of the digits."""
    found = np.poly(roots(integrator.coefficients, INFINITE))
    assert found == pytest.approx(np.poly(roots_at_infinity(integrator.coefficients)), abs=1e-8)


def test_hht_at_infinite_frequency() -> None:
    """alpha = -0.3: -(1 + alpha)/(1 - alpha) = -0.538, double, and alpha/(1 + alpha) = -0.429."""
    found = np.sort(np.real(roots(HHT(-0.3).coefficients, INFINITE)))
    assert found == pytest.approx([-0.7 / 1.3, -0.7 / 1.3, -0.3 / 0.7], abs=1e-4)


@pytest.mark.parametrize("rho", [0.0, 0.3, 0.8, 1.0])
def test_generalized_alpha_has_the_spectral_radius_it_is_called_by(rho: float) -> None:
    assert np.abs(roots_at_infinity(GeneralizedAlpha(rho).coefficients)) == pytest.approx(rho, abs=1e-7)


@pytest.mark.parametrize("integrator", SECOND_ORDER, ids=str)
@pytest.mark.parametrize("ratio", [0.0, 0.05])
def test_second_order_on_an_oscillator(integrator: Any, ratio: float) -> None:
    e = errors(integrator.coefficients, [1000, 2000, 4000], ratio)
    assert np.log2(e[:-1] / e[1:]) == pytest.approx(2.0, abs=ORDER)


def test_newmark_with_more_gamma_is_of_first_order() -> None:
    e = errors(Newmark(0.7, 0.36).coefficients, [1000, 2000, 4000], 0.05)
    assert np.log2(e[:-1] / e[1:]) == pytest.approx(1.0, abs=ORDER)


@pytest.mark.parametrize("integrator", [GeneralizedAlpha(0.8), HHT(-0.1), HHT(-0.3), Newmark()], ids=str)
def test_second_order_in_the_step_graph(integrator: Any) -> None:
    """A slider on a spring and damper, let go: the graph uses the same coefficients, at position level."""
    mass, k, d, z0 = 2.0, 800.0, 8.0, 0.01
    w, zeta = np.sqrt(k / mass), d / (2.0 * np.sqrt(k * mass))
    w_d = w * np.sqrt(1.0 - zeta**2)
    found = []
    for count in (100, 200, 400):
        scene = Scene(gravity=(0.0, 0.0, -k * z0 / mass))
        slider = scene.add_rigid_body(mass, (0.1,) * 3, name="slider")
        guide = scene.add(joints.Prismatic(scene.ground, slider.at((0, 0, 0)), axis=(0, 0, 1), name="guide"))
        scene.add(forces.JointSpringDamper(guide, k, d))
        history = run(scene, 0.4, step=0.4 / count, integrator=integrator, save_every=count // 10, progress=False)
        t = history.time
        exact = -z0 * (1.0 - np.exp(-zeta * w * t) * (np.cos(w_d * t) + zeta * w / w_d * np.sin(w_d * t)))
        found.append(np.linalg.norm(history.joints["guide"].coordinate - exact))
    assert np.log2(found[-2] / found[-1]) == pytest.approx(2.0, abs=ORDER)


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: GeneralizedAlpha(1.2), "rho_inf must lie between 0 and 1"),
        (lambda: HHT(0.1), "alpha must lie between -1/3 and 0"),
        (lambda: HHT(-0.5), "alpha must lie between -1/3 and 0"),
        (lambda: Newmark(0.4), "gamma must be at least 1/2"),
        (lambda: Newmark(1.5, 1.0), "gamma must be at most 1"),
        (lambda: Newmark(0.6, 0.25), "beta must be at least gamma/2 = 0.3"),
        (lambda: Newmark(float("nan")), "gamma must be finite"),
        (lambda: HHT(-0.1, project_velocities=1), "project_velocities must be True or False"),  # type: ignore[arg-type]
    ],
)
def test_wrong_parameters_are_refused(make: Any, message: str) -> None:
    with pytest.raises(InputError, match=message):
        make()


def test_every_integrator_is_known_by_its_name_in_scene_files() -> None:
    assert all(snake_case(cls.__name__) == name for name, cls in INTEGRATORS.items())


# --- free flight on the host


@pytest.fixture(scope="module")
def points() -> PointMasses:
    return point_masses()


@pytest.fixture(scope="module")
def body(points: PointMasses) -> ReducedBody:
    return reduced_points(points, FREQUENCIES)


def tumbling(body: ReducedBody, level: str = "full", **options: Any) -> Scene:
    scene = Scene(gravity=options.pop("gravity", (0.0, 0.0, 0.0)))
    given = {"position": (0.3, -0.2, 0.1), "rotation": (0.1, 0.7, -0.1, 0.7), "damping": 0.0, **options}
    scene.add_body(body, name="body", velocity=(1.0, 2.0, 0.5), angular_velocity=(3, -2, 4), inertia=level, **given)
    return scene


def flight(scene: Scene, step: float, integrator: Any, duration: float = 0.4, rows: int = 4) -> History:
    every = int(round(duration / step / rows))
    history = run_check(scene, duration, step=step, integrator=integrator, save_every=every, progress=False)
    assert history.status == "completed", history.message
    return history


def place(history: History) -> np.ndarray:
    """Where the body is at the end, in one vector."""
    m = history.bodies["body"]
    return np.concatenate([m.position[-1], rot.matrix(m.rotation[-1]).ravel(), m.modal[-1]])


def mechanical(history: History) -> np.ndarray:
    return history.energy["kinetic"] + history.energy["strain"] + history.energy["potential"]


@pytest.mark.parametrize("level", LEVELS)
@pytest.mark.parametrize("step", [0.1, 0.01])
def test_energy_is_kept_at_any_step_and_level(body: ReducedBody, level: str, step: float) -> None:
    history = flight(tumbling(body, level, gravity=(0.5, 0.0, -9.81)), step, EnergyMomentum(), duration=2.0)
    total = mechanical(history)
    assert np.abs(total - total[0]).max() < ROUND_OFF * np.abs(history.energy["kinetic"]).max()
    assert np.abs(history.energy["numerical"]).max() < ROUND_OFF * np.abs(history.energy["kinetic"]).max()
    assert np.abs(history.bodies["body"].modal[-1]).max() > 0.0 or level == "constant"


@pytest.mark.parametrize("step", [0.1, 0.01])
def test_momenta_of_the_points_are_kept_at_any_step(points: PointMasses, body: ReducedBody, step: float) -> None:
    """Sums over the points' own velocities, which know nothing of inertia terms; 10 % of the shape is deformed."""
    history = flight(tumbling(body), step, EnergyMomentum(), duration=2.0)
    start = momenta(points, history.bodies["body"], 0)
    assert np.abs(history.bodies["body"].modal).max() > 0.05
    for row in range(1, len(history.time)):
        now = momenta(points, history.bodies["body"], row)
        for value, first in zip(now[:2], start[:2], strict=True):
            assert np.abs(value - first).max() < ROUND_OFF * np.abs(first).max()
        assert now[2] == pytest.approx(history.energy["kinetic"][row], rel=ROUND_OFF)


@pytest.mark.parametrize("level", LEVELS)
def test_angular_momentum_of_each_level_is_its_own(body: ReducedBody, level: str) -> None:
    _, linear, angular = deviations(flight(tumbling(body, level), 0.02, EnergyMomentum(), duration=1.0), "body")
    assert linear < ROUND_OFF and angular < ROUND_OFF


@pytest.mark.parametrize(
    ("integrator", "wanted", "steps"),
    [(EnergyMomentum(), 2.0, (1e-3, 5e-4)), (RungeKutta4(), 4.0, (4e-3, 2e-3))],
    ids=["energy-momentum", "Runge-Kutta"],
)
@pytest.mark.parametrize("level", ["deformed", "full"])
def test_orders(body: ReducedBody, integrator: Any, wanted: float, steps: tuple[float, float], level: str) -> None:
    exact = place(flight(tumbling(body, level), 5e-4, RungeKutta4()))
    e = [float(np.linalg.norm(place(flight(tumbling(body, level), h, integrator)) - exact)) for h in steps]
    assert np.log2(e[0] / e[1]) == pytest.approx(wanted, abs=0.3)  # two terms are seen at these steps


@pytest.mark.parametrize("level", LEVELS)
def test_accelerations_obey_the_equations_of_motion(body: ReducedBody, level: str) -> None:
    """Against `body_torque` and `modal_forces`, which assemble the same equations in another way; some modes carry no
    inertia terms."""
    few = reduced_points(point_masses(), FREQUENCIES, carrying=3)
    scene = tumbling(few, level, damping=0.02)
    one = free_body(scene, scene.bodies[0], InertiaPlan.of(scene).bodies[0])
    rng = np.random.default_rng(5)
    q, qd, w = 0.1 * rng.normal(size=4), rng.normal(size=4), rng.normal(size=3)
    rates = one.rates(Motion(np.zeros(3), np.array([0.0, 0.0, 0.0, 1.0]), np.zeros(3), w, q, qd), 0.0)
    assert few.inertia_terms is not None
    torque = body_torque(few.inertia_terms, few.inertia, q, qd, rates.qd, w, rates.w, level)
    modal = rates.qd + modal_forces(few.inertia_terms, q, qd, w, rates.w, level)
    assert torque == pytest.approx(0.0, abs=1e-12)
    assert modal + one.damping * qd + one.stiffness * q == pytest.approx(0.0, abs=1e-10)


def test_stiffening_is_a_stiffness_times_products_of_the_angular_velocity(body: ReducedBody) -> None:
    rng = np.random.default_rng(6)
    K, F = rng.normal(size=(2, 6, 4, 4))
    K, F = K + K.transpose(0, 2, 1), F + F.transpose(0, 2, 1)
    terms = body.inertia_terms
    assert terms is not None
    stiff = GeometricStiffness(K, {"tip": F})
    soft = replace(body, inertia_terms=replace(terms, stiffening=stiff))
    q, w = 0.1 * rng.normal(size=4), rng.normal(size=3)
    force = np.array([3.0, -1.0, 2.0])
    found = []
    for stiffening in (False, True):
        scene = tumbling(soft, "full", stiffening=stiffening)
        scene.add(forces.PointForce(scene.bodies[0]["tip"], force, frame="body"))
        one = free_body(scene, scene.bodies[0], InertiaPlan.of(scene).bodies[0])
        state = Motion(np.zeros(3), np.array([0.0, 0.0, 0.0, 1.0]), np.zeros(3), w, q, np.zeros(4))
        rates = one.rates(state, 0.0)
        L_rate = one.inertia(q, one.slopes(q)) @ rates.w + rates.qd @ one.coupling(q)
        found.append((L_rate, rates.qd + one.coupling(q) @ rates.w))
        J = one.inertia(q, one.slopes(q))
        arm = one.loads[0].arm + q @ one.loads[0].shift - 0.5 * stiffening * np.einsum("i,cij,j->c", q, F[:3], q)
        assert L_rate == pytest.approx(np.cross(arm, force) - np.cross(w, J @ w), abs=1e-10)
    load = {"tip": np.concatenate([force, np.zeros(3)])}
    assert found[1][1] - found[0][1] == pytest.approx(-stiff.matrix(w, load) @ q, abs=1e-10)


@pytest.mark.parametrize("integrator", [EnergyMomentum(), RungeKutta4()], ids=["energy-momentum", "Runge-Kutta"])
def test_damping_takes_what_the_ledger_says(body: ReducedBody, integrator: Any) -> None:
    history = flight(tumbling(body, damping=0.05), 1e-3, integrator)
    assert history.energy["damping"][-1] > 0.1 * history.energy["strain"].max()
    assert np.abs(history.energy["numerical"]).max() < 1e-7 * history.energy["damping"][-1]  # of fourth order, or exact


def test_several_bodies_and_stages_of_a_flight(body: ReducedBody) -> None:
    """A rigid body next to the flexible one; two halves are the whole, and a device run goes on on the host."""

    def scene() -> Scene:
        found = tumbling(body, gravity=(0.0, 0.0, -9.81))
        found.add_rigid_body(
            2.0, (1.0, 2.0, 3.0), name="rigid", angular_velocity=(1.0, 5.0, 0.5), center_of_mass=(1, 0, 0)
        )
        return found

    whole = flight(scene(), 0.01, EnergyMomentum())
    options: dict[str, Any] = {"step": 0.01, "integrator": EnergyMomentum(), "save_every": 10, "progress": False}
    one = scene()
    half = run_check(one, 0.2, **options)
    rest = run_check(one, 0.2, start=half, **options)
    assert rest.time == pytest.approx([0.3, 0.4])
    for name in ("body", "rigid"):
        assert rest.bodies[name].position[-1] == pytest.approx(whole.bodies[name].position[-1], abs=1e-14)
        assert rest.bodies[name].modal[-1] == pytest.approx(whole.bodies[name].modal[-1], abs=1e-14)
    assert rest.energy["kinetic"][-1] == pytest.approx(whole.energy["kinetic"][-1], rel=1e-14)
    device = run(one, 0.2, step=1e-3, save_every=20, progress=False)
    after = run_check(one, 0.2, start=device, **{**options, "step": 1e-3})
    assert after.time[-1] == pytest.approx(0.4)
    assert after.bodies["rigid"].position[-1] == pytest.approx(whole.bodies["rigid"].position[-1], abs=1e-3)
    assert (
        np.abs(after.energy["numerical"] - device.energy["numerical"][-1]).max() < 1e-12 * device.energy["kinetic"][0]
    )


@pytest.mark.parametrize("frame", ["world", "body"])
def test_point_loads_do_what_they_do_on_the_device(body: ReducedBody, frame: Any) -> None:
    """A growing force and a torque at an interface that moves: one motion, and the ledger closes."""

    def scene() -> Scene:
        found = tumbling(body, gravity=(0.0, 0.0, -9.81))
        tip = found.bodies[0]["tip"]
        found.add(forces.PointForce(tip, (signals.Ramp(0.0, 60.0, duration=0.5), (1.0, 2.0, -1.0)), frame=frame))
        found.add(forces.PointTorque(tip, (2.0, 0.0, -3.0), frame=frame, name="twist"))
        return found

    host = flight(scene(), 1e-3, RungeKutta4())
    scale = mechanical(host).max()
    assert host.energy["force_work"][-1] > 0.1 * scale
    assert np.abs(host.energy["numerical"]).max() < 1e-8 * scale
    found = []
    for step in (2e-3, 1e-3):
        device = run(scene(), 0.4, step=step, save_every=int(round(0.1 / step)), progress=False)
        found.append(float(np.linalg.norm(place(device) - place(host))))
    assert found[1] < 1e-3 and np.log2(found[0] / found[1]) == pytest.approx(2.0, abs=0.3)
    assert host.forces["twist"].torque[-1] == pytest.approx(device.forces["twist"].torque[-1], abs=1e-3)
    ours, theirs = host.bodies["body"], device.bodies["body"]
    assert ours.acceleration[-1] == pytest.approx(theirs.acceleration[-1], rel=1e-2)
    assert ours.angular_velocity[-1] == pytest.approx(theirs.angular_velocity[-1], rel=1e-3)


def test_a_ball_thrown_with_a_side_wind_flies_a_parabola() -> None:
    """Exact for both methods: constant forces at the centre of mass, which is not the origin."""
    scene = Scene(gravity=(0.0, 0.0, -9.81))
    ball = scene.add_rigid_body(2.0, (1.0, 1.0, 1.0), name="ball", center_of_mass=(0.1, 0, 0), velocity=(3.0, 0.0, 4.0))
    t = 0.5
    scene.add(forces.PointForce(ball.at((0.1, 0.0, 0.0)), (0.0, 4.0, 0.0)))
    history = run_check(scene, t, step=0.1, integrator=RungeKutta4(), progress=False)
    exact = [3.0 * t, 0.5 * 2.0 * t**2, 4.0 * t - 0.5 * 9.81 * t**2]
    assert history.bodies["ball"].position[-1] == pytest.approx(exact, abs=1e-14)
    assert history.energy["force_work"][-1] == pytest.approx(4.0 * exact[1], rel=1e-14)


# --- what cannot be


def refused(scene: Scene, integrator: Any, **options: Any) -> str:
    with pytest.raises(InputError) as caught:
        run_check(scene, 0.1, **{"step": 1e-2, "integrator": integrator, "progress": False, **options})
    return str(caught.value)


def test_scenes_of_more_than_free_bodies_are_refused(body: ReducedBody) -> None:
    scene = tumbling(body)
    tip = scene.bodies[0]["tip"]
    push = scene.add(forces.PointForce(tip, (1.0, 0.0, 0.0), name="push"))
    assert refused(scene, EnergyMomentum()).startswith("EnergyMomentum: point_force 'push': of all loads only gravity")
    scene.forces.remove(push)
    scene.add(forces.SpringDamper(scene.ground.at((0, 0, 0)), tip, 10.0, name="band"))
    found = refused(scene, RungeKutta4())
    assert "RungeKutta4: spring_damper 'band'" in found and "GeneralizedAlpha, HHT or Newmark" in found
    scene.add(joints.Spherical(scene.ground, tip, name="hook"))
    assert "EnergyMomentum: spherical 'hook': only scenes of free bodies" in refused(scene, EnergyMomentum())
    assert "there are no bodies" in refused(Scene(), EnergyMomentum())


def test_steps_beyond_the_stability_limit_are_refused(body: ReducedBody) -> None:
    """13 Hz: 2 sqrt(2)/(2 pi 13) = 0.0346 s."""
    assert "beyond the stability limit of body 'body'" in refused(tumbling(body), RungeKutta4(), step=0.035)
    assert flight(tumbling(body), 0.034, RungeKutta4(), duration=0.34, rows=1).status == "completed"


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"step": -1.0}, "step must be greater than zero"),
        ({"step": 0.5}, "step 0.5 s is longer than the duration"),
        ({"save_every": 0}, "save_every must be a whole number of at least 1"),
        ({"start": "equilibrium"}, "free bodies have no equilibrium"),
        ({"integrator": HHT()}, r"a check runs with RungeKutta4\(\) or EnergyMomentum\(\)"),
    ],
)
def test_wrong_arguments_are_refused(body: ReducedBody, options: dict[str, Any], message: str) -> None:
    with pytest.raises(InputError, match=message):
        run_check(tumbling(body), 0.1, **{"step": 1e-2, "integrator": EnergyMomentum(), "progress": False, **options})


def test_a_checkpoint_of_another_scene_is_refused(body: ReducedBody) -> None:
    scene = Scene()
    scene.add_rigid_body(1.0, (1.0, 2.0, 3.0), name="body")
    other = flight(scene, 0.01, EnergyMomentum())
    assert "the checkpoint does not hold q (4,)" in refused(tumbling(body), EnergyMomentum(), start=other)
    other.checkpoint["r"] = np.full((1, 1, 3), np.nan)
    assert "the checkpoint does not hold r" in refused(scene, EnergyMomentum(), start=other)


def test_an_interrupted_flight_keeps_its_rows(body: ReducedBody, monkeypatch: pytest.MonkeyPatch) -> None:
    class Impatient(check_run.Progress):
        def update(self, done: int) -> None:
            if done == 7:
                raise KeyboardInterrupt

    monkeypatch.setattr(check_run, "Progress", Impatient)
    scene = tumbling(body)
    history = run_check(scene, 1.0, step=0.01, integrator=EnergyMomentum(), progress=False)
    assert history.status == "interrupted" and history.time == pytest.approx(np.arange(8) * 0.01)
    monkeypatch.undo()
    rest = run_check(scene, 0.03, step=0.01, integrator=EnergyMomentum(), start=history, progress=False)
    whole = run_check(scene, 0.1, step=0.01, integrator=EnergyMomentum(), progress=False)
    assert place(rest) == pytest.approx(place(whole), abs=1e-13)


def test_a_step_without_a_solution_is_a_status(body: ReducedBody) -> None:
    """A hundred turns a step: Newton's method loses its way, rows so far are kept."""
    scene = tumbling(body)
    scene.bodies[0].angular_velocity = np.array([300.0, -200.0, 400.0])
    history = run_check(scene, 10.0, step=1.0, integrator=EnergyMomentum(), progress=False)
    assert history.status in ("not_converged", "singular") and "reduce step" in history.message
    assert len(history.time) >= 1 and np.all(np.isfinite(history.bodies["body"].position))
