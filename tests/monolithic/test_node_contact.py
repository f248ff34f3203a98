"""The law at nodes by true shapes: flat punches on layers, gross slip, energy, momentum, continued runs, refusals."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from node_bodies import PAIR, on_half_space

from references import monolithic
from references.half_space.bodies import half_space
from references.monolithic.core.linear import VARIANTS
from references.monolithic.line_of_centres.pair import default_layer
from references.monolithic.results import simulate
from references.stick_slip import BeltOscillator
from scenes.rigid_cylinder import with_nodes
from scenes.rollers import roller_body
from warpffrf.model import forces, joints, laws, signals, surfaces
from warpffrf.model.contact import Contact
from warpffrf.model.errors import InputError
from warpffrf.model.friction import Coulomb, RegularisedCoulomb
from warpffrf.model.material import Material
from warpffrf.model.reduced.body import ReducedBody
from warpffrf.model.rotation import matrix
from warpffrf.model.scene import Scene
from warpffrf.online import GeneralizedAlpha, Newmark

RIGID = Material(2.1e20, 0.3, 7850.0)  # yields a billionth of what steel does: only the layer is left
STEEL = Material(210e9, 0.3, 7850.0)
PITCH, COLUMNS, ROWS = 1e-3, 7, 5
AREA = (COLUMNS - 1) * (ROWS - 1) * PITCH**2
FLAT = surfaces.Plane(origin=(0.0, 0.0, 0.0), outward=(0.0, 0.0, -1.0), direction=(0.0, 1.0, 0.0))
BALL = surfaces.Sphere(radius=0.01, axis_point=(0.0, 0.0, 0.0), axis_direction=(0.0, 1.0, 0.0))
LOAD, MASS = 600.0, 0.1  # N, kg
AT_NODES: dict[str, Any] = {"at_nodes": True, "progress": False}
LAYERS = {
    "linear_layer": laws.LinearLayer(1e13),
    "nonlinear_layer": laws.NonlinearLayer(1e16, 1.5),
    "tabulated_layer": laws.TabulatedLayer((-4e-6, -1e-6, 0.5e-6), (9e7, 1e7, 0.0)),
    "exponential_asperities": laws.ExponentialAsperities(1e8, 3e-7),
    "greenwood_tripp": laws.GreenwoodTripp(1e-7, 1e10, 5e-5, 1e11),
    "hunt_crossley": laws.HuntCrossley(1e16, 1.5, damping=20.0),
}


@pytest.fixture(scope="module")
def rigid_space() -> ReducedBody:
    return with_nodes(half_space(COLUMNS, ROWS, PITCH, RIGID))


@pytest.fixture(scope="module")
def steel_space() -> ReducedBody:
    return with_nodes(half_space(7, 7, 8e-5, STEEL))


def guided(scene: Scene, partner: Any) -> Any:
    """The partner does not turn: a lift along z and a slide along x; the joint of the slide."""
    lift = scene.add_rigid_body(MASS, (1e-4, 1e-4, 1e-4), name="lift", position=partner.position)
    centers = [body.at((0.0, 0.0, 0.0)) for body in (lift, partner)]
    scene.add(joints.Prismatic(scene.ground, centers[0], axis=(0.0, 0.0, 1.0), name="down"))
    return scene.add(joints.Prismatic(*centers, axis=(1.0, 0.0, 0.0), name="side"))


@pytest.mark.parametrize("variant", ["full", "low_rank"])
@pytest.mark.parametrize("kind", list(LAYERS))
def test_flat_punch_on_a_layer(kind: str, variant: str, rigid_space: ReducedBody) -> None:
    """p = F/A everywhere, so the punch sinks to where the law has that pressure; also from far above."""
    law: Any = LAYERS[kind]
    scene, partner = on_half_space(rigid_space, FLAT, LOAD, law=law)
    guided(scene, partner)
    if variant == "full":
        for body in scene.bodies[1:]:
            body.position = body.position + np.array([0.0, 0.0, 2e-5])
    found = monolithic.run(scene, 1e-5, step=1e-5, start="equilibrium", variant=variant, **AT_NODES)
    assert found.status == "completed", found.message
    z = float(found.bodies["partner"].position[0, 2])
    assert float(law.pressure(z)) == pytest.approx(LOAD / AREA, rel=1e-7)
    record = found.contacts[PAIR]
    assert record.force[0] == pytest.approx([0.0, 0.0, -LOAD], abs=1e-6 * LOAD)
    inner = record.pressure[0][record.pressure[0].any(axis=1)][1:-1]  # at the corners the shares of nodes differ
    np.testing.assert_allclose(inner, LOAD / AREA, rtol=1e-6)
    assert found.energy["contact"][0] == pytest.approx(AREA * float(law.energy(z)), rel=1e-6)


def test_every_layer_is_tested() -> None:
    assert {*LAYERS, "unilateral"} == set(laws.LAWS)


def dragged(body: ReducedBody, friction: Any, pull: Any, stick: float, steps: int, step: float) -> Any:
    """The flat punch, pulled along x by `pull` [N] (number or signal)."""
    scene, partner = on_half_space(body, FLAT, LOAD, law=laws.LinearLayer(1e13), friction=friction)
    guided(scene, partner)
    scene.add(forces.PointForce(partner.at((0.0, 0.0, 0.0)), (pull, (1.0, 0.0, 0.0))))
    found = simulate(
        scene, steps * step, step=step, start="equilibrium", integrator=GeneralizedAlpha(0.0), variant="low_rank",
        stick_stiffness=stick, **AT_NODES,
    )  # fmt: skip
    assert found.status == "completed", found.message
    return found


def test_a_punch_sticks_on_its_stretch(rigid_space: ReducedBody) -> None:
    """Q below mu F: it stands Q/(A k_t) aside, every node sticks, and nothing is lost but by the way there."""
    k_t, Q = 2e12, 100.0
    result = dragged(rigid_space, Coulomb(0.3), signals.Ramp(0.0, Q, duration=0.02), k_t, 40, 1e-3)
    aside = float(result.history.bodies["partner"].position[-1, 0])
    assert aside == pytest.approx(Q / (AREA * k_t), rel=1e-6)
    rub = result.history.contacts[PAIR].friction
    assert rub is not None and set(np.unique(rub.state[-1])) == {0, 1}
    assert result.history.contacts[PAIR].force[-1, 0] == pytest.approx(Q, rel=1e-6)
    assert np.all(result.history.energy["friction"] == 0.0)


@pytest.mark.slow
def test_a_punch_sticks_and_slips(rigid_space: ReducedBody) -> None:
    """Pulled by a spring whose other end runs ahead: amplitude and period of an event-driven solution."""
    k, V, step, end = 1e5, 0.5, 1e-4, 0.017
    law = laws.Stribeck(0.4, 0.2, 0.5)
    scene, punch = on_half_space(rigid_space, FLAT, LOAD, law=laws.LinearLayer(1e13), friction=law)
    scene.add(forces.JointSpringDamper(guided(scene, punch), stiffness=k))
    pull = signals.Ramp(0.0, k * V * end, duration=end)  # with the spring together k (V t - x)
    scene.add(forces.PointForce(punch.at((0.0, 0.0, 0.0)), (pull, (1.0, 0.0, 0.0))))
    result = simulate(
        scene, end, step=step, start="equilibrium", integrator=GeneralizedAlpha(0.0), variant="low_rank",
        stick_stiffness=1e13, **AT_NODES,
    )  # fmt: skip
    assert result.status == "completed", result.message
    y = V * result.time - result.history.bodies["partner"].position[:, 0]
    case = BeltOscillator(MASS, k, LOAD, V)
    amplitude, period = case.cycle(lambda v: float(law.coefficient_at(v)))
    i = np.flatnonzero((y[1:-1] > y[:-2]) & (y[1:-1] >= y[2:])) + 1
    bend, rise = y[i + 1] - 2.0 * y[i] + y[i - 1], 0.5 * (y[i + 1] - y[i - 1])
    tops, at = y[i] - 0.5 * rise**2 / bend, result.time[i] - step * rise / bend
    later = result.time > at[0]
    found = 0.5 * (tops.mean() - y[later].min()), np.diff(at).mean()
    print(f"amplitude {found[0] / amplitude - 1.0:+.1e}, period {found[1] / period - 1.0:+.1e}")
    assert len(tops) >= 2 and found == pytest.approx((amplitude, period), rel=0.01)
    pair = result.history.contacts[PAIR]
    assert np.abs(pair.force[1:, 0] / pair.force[1:, 2]).max() == pytest.approx(0.4, rel=1e-3)
    assert np.diff(result.history.energy["friction"]).max() <= 0.0


@pytest.mark.parametrize("law", [Coulomb(0.3), RegularisedCoulomb(0.3, 1e-4)])
def test_a_punch_that_slides(law: Any, rigid_space: ReducedBody) -> None:
    """Q above mu F: it accelerates by (Q - mu F)/m, friction takes mu F times the way; slip points along x."""
    Q, step, steps = 400.0, 1e-4, 40
    result = dragged(rigid_space, law, signals.Ramp(0.0, Q, duration=1e-3), 1e14, steps, step)
    x, v = result.history.bodies["partner"].position[:, 0], result.history.bodies["partner"].velocity[:, 0]
    limit = 0.3 * LOAD
    late = slice(20, None)
    np.testing.assert_allclose(np.diff(v[late]) / step, (Q - limit) / MASS, rtol=1e-4)  # after the ramp
    rub = result.history.contacts[PAIR].friction
    assert rub is not None
    np.testing.assert_allclose(rub.power[late], limit * np.diff(x)[19:] / step, rtol=1e-6)
    np.testing.assert_allclose(-np.diff(result.history.energy["friction"]) / step, rub.power[1:], rtol=1e-9)
    # the first surface is that of the space, and theta runs along x
    np.testing.assert_allclose(rub.creep_velocity[late, 0], -np.diff(x)[19:] / step, rtol=1e-9)
    assert np.all(rub.state[late][result.history.contacts[PAIR].pressure[late] > 0.0] == 2)
    assert np.all(rub.traction[late, 0] >= 0.0)


@pytest.mark.slow
def test_restitution_of_a_damped_layer(rigid_space: ReducedBody) -> None:
    """A flat punch that hits the layer with the speed the restitution was given for leaves it with that part of it."""
    speed, e, errors = 0.1, 0.7, []
    for steps in (100, 200):
        law = laws.HuntCrossley(1e16, 1.5, restitution=e, impact_speed=speed)
        scene, partner = on_half_space(rigid_space, FLAT, 0.0, law=law)
        scene.forces.clear()
        scene.add(joints.Prismatic(scene.ground, partner.at((0.0, 0.0, 0.0)), axis=(0.0, 0.0, 1.0), name="down"))
        partner.position, partner.velocity = (0.0, 0.0, 1e-8), (0.0, 0.0, -speed)
        found = monolithic.run(scene, 1.2e-4, step=1.2e-4 / steps, variant="low_rank", integrator=Newmark(), **AT_NODES)
        assert found.status == "completed", found.message
        assert not found.contacts[PAIR].active[-1]  # apart again
        errors.append(abs(found.bodies["partner"].velocity[-1, 2] / speed - e))
        assert found.energy["layer"][-1] == pytest.approx(0.5 * MASS * speed**2 * (1.0 - e * e), rel=0.02)
        print(f"{steps} steps: restitution off by {errors[-1]:.1e}")
    assert errors[1] < 5e-3 and errors[1] < 0.7 * errors[0]


@pytest.mark.slow
def test_energy_of_a_ball_that_bounces_askew(steel_space: ReducedBody) -> None:
    """A free ball that comes down with a sideways velocity and a spin: what it has and what friction and layer took is
    what it had, the better the smaller the step, and neither ever gives."""
    off = []
    for steps in (40, 80):
        law = laws.HuntCrossley(3e21, 1.5, damping=2.0)
        scene, partner = on_half_space(steel_space, BALL, 0.0, law=law, friction=0.2)
        partner.position = (0.0, 0.0, 0.01 + 1e-7)
        partner.velocity, partner.angular_velocity = (0.05, 0.02, -0.1), (3.0, 0.0, 1.0)
        found = monolithic.run(scene, 8e-5, step=8e-5 / steps, variant="low_rank", integrator=Newmark(), **AT_NODES)
        assert found.status == "completed", found.message
        e = found.energy
        assert np.all(np.diff(e["friction"]) <= 0.0) and np.all(np.diff(e["layer"]) >= 0.0)
        total = e["kinetic"] + e["strain"] + e["contact"] + e["potential"] - e["friction"] + e["layer"]
        lost = e["layer"][-1] - e["friction"][-1]
        assert lost > 0.01 * total[0]
        off.append(abs(total[-1] - total[0]) / lost)
        assert found.bodies["partner"].velocity[-1, 2] > 0.0  # it is on its way back
        print(f"{steps} steps: ledger off by {off[-1]:.1%} of what was lost, {lost / total[0]:.1%}")
    assert off[1] < 0.05 and off[1] < 0.7 * off[0]


@pytest.mark.slow
def test_momentum_of_two_free_bodies() -> None:
    """Flexible rollers that meet askew with friction: linear and angular momentum stay."""
    body = roller_body(40, layers=2, axial=2, grading=1.6, modes=3, tangential=True, contact_fixed=False, cache=False)
    scene = Scene()
    scene.add_body(body, name="lower", inertia="constant")
    scene.add_body(
        body, name="upper", position=(0.0, 0.002, 0.1), velocity=(0.3, 0.0, -0.4), angular_velocity=(0.0, 9.0, 1.0),
        inertia="constant",
    )  # fmt: skip
    k = 0.01 * default_layer(body.contact_surfaces["rim"])
    rims = scene.body("lower")["rim"], scene.body("upper")["rim"]
    scene.add(Contact(*rims, law=laws.LinearLayer(k), friction=0.3, name=PAIR))
    found = monolithic.run(scene, 1e-4, step=2e-6, variant="low_rank", **AT_NODES)
    assert found.status == "completed", found.message
    force = found.contacts[PAIR].force
    assert np.abs(force[:, 0]).max() > 0.1 * np.abs(force[:, 2]).max() > 1.0  # friction, not the normal force alone
    assert np.abs(force + found.contacts[PAIR].force_second).max() < 1e-12 * np.abs(force).max()
    momentum = body.mass * np.sum([motion.velocity for motion in found.bodies.values()], axis=0)
    assert np.abs(momentum - momentum[0]).max() < 1e-9 * body.mass * 0.5
    total = np.zeros_like(momentum)
    for name, motion in found.bodies.items():
        r, v = motion.position, motion.velocity  # the centre of mass is the origin of a roller's user frame
        assert np.abs(scene.body(name).center_of_mass).max() < 1e-12
        for t in range(len(r)):
            A = matrix(motion.rotation[t])
            total[t] += np.cross(r[t], body.mass * v[t]) + A @ body.inertia @ A.T @ motion.angular_velocity[t]
    size = float(np.abs(found.contacts[PAIR].torque).max()) * 1e-4
    assert np.abs(total - total[0]).max() < 0.02 * size  # of the integrator, which conserves linear momentum only


@pytest.mark.slow
def test_two_wheels_on_the_ground() -> None:
    """One at rest, one that slides with spin: while it slides, tractions are mu p all over its patch and slow it down;
    a run that goes on from another is one run."""
    body = roller_body(40, layers=2, axial=2, grading=1.6, modes=3, tangential=True, contact_fixed=False, cache=False)
    scene = Scene(gravity=(0.0, 0.0, -9.81))
    plane = surfaces.Plane(origin=(0.0, 0.0, 0.0), outward=(0.0, 0.0, 1.0), direction=(0.0, 1.0, 0.0))
    floor = scene.ground.surface(plane, name="floor")
    rest = scene.add_body(body, name="rest", position=(0.0, 0.0, 0.05), inertia="constant")
    wheel = scene.add_body(
        body, name="wheel", position=(0.3, 0.0, 0.05), velocity=(0.5, 0.0, 0.0), angular_velocity=(0.0, 5.0, 0.0),
        inertia="constant",
    )  # fmt: skip
    layer = laws.LinearLayer(0.01 * default_layer(body.contact_surfaces["rim"]))
    law = RegularisedCoulomb(0.2, 1e-3)
    scene.add(Contact(rest["rim"], floor, law=layer, friction=0.3, name="stands"))
    scene.add(Contact(wheel["rim"], floor, law=layer, friction=law, name="slides"))
    more: dict[str, Any] = {"step": 1e-4, "variant": "low_rank", **AT_NODES}
    whole = simulate(scene, 2e-3, **more)
    rest_of_it = monolithic.run(scene, 1e-3, start=monolithic.run(scene, 1e-3, **more), **more)
    assert whole.status == rest_of_it.status == "completed", whole.message + rest_of_it.message
    c = whole.history.contacts["slides"]
    assert c.friction is not None
    for t in range(1, len(c.force)):
        size = np.linalg.norm(c.friction.traction[t], axis=0)
        np.testing.assert_allclose(size, 0.2 * c.pressure[t], rtol=1e-6, atol=1.0)
    assert c.force[-1, 2] > 1.0 and np.all(c.friction.power[1:] >= 0.0) and c.friction.power[-1] > 0.0
    assert whole.history.bodies["wheel"].velocity[-1, 0] < 0.5 and np.abs(c.friction.creep_velocity[1:, 0]).min() > 0.2
    other = rest_of_it.contacts["slides"]
    assert other.friction is not None and other.friction["state"].shape == other.pressure.shape
    assert np.abs(other.force[-1] - c.force[-1]).max() < 1e-6 * np.abs(c.force[-1]).max()
    stands = whole.history.contacts["stands"]
    assert np.abs(stands.force[:, :2]).max() < 1e-6 * np.abs(stands.force[:, 2]).max()


@pytest.mark.parametrize("variant", VARIANTS)
def test_variants_agree(variant: str, steel_space: ReducedBody) -> None:
    """The same equations in three ways, with friction."""
    found = []
    for way in ("low_rank", variant):
        scene, partner = on_half_space(steel_space, BALL, 20.0, law=laws.LinearLayer(1e16), friction=0.3)
        guided(scene, partner)
        scene.add(forces.PointForce(partner.at((0.0, 0.0, 0.0)), (signals.Ramp(0.0, 4.0, duration=1e-3), (1.0, 0, 0))))
        found.append(monolithic.run(scene, 5e-4, step=1e-4, start="equilibrium", variant=way, **AT_NODES))
        assert found[-1].status == "completed", found[-1].message
    a, b = (history.contacts[PAIR].force for history in found)
    assert np.abs(a - b).max() < 1e-7 * np.abs(a).max()


def test_a_run_goes_on_with_what_its_nodes_remember(steel_space: ReducedBody) -> None:
    def scene() -> Scene:
        made, partner = on_half_space(steel_space, BALL, 20.0, law=laws.LinearLayer(1e16), friction=0.3)
        guided(made, partner)
        made.add(forces.PointForce(partner.at((0.0, 0.0, 0.0)), (signals.Ramp(0.0, 4.0, duration=1e-3), (1.0, 0, 0))))
        return made

    more: dict[str, Any] = {"step": 1e-4, "variant": "low_rank", **AT_NODES}
    whole = monolithic.run(scene(), 8e-4, start="equilibrium", **more)
    half = monolithic.run(scene(), 4e-4, start="equilibrium", **more)
    rest = monolithic.run(scene(), 4e-4, start=half, **more)
    assert half.status == rest.status == "completed"
    a, b = (history.contacts[PAIR].force[-1] for history in (whole, rest))
    assert np.abs(a - b).max() < 1e-8 * np.abs(a).max()
    rubs = [history.contacts[PAIR].friction for history in (whole, rest)]
    tau = [np.sort(rub["traction"][-1].ravel())[-20:] for rub in rubs if rub is not None]
    np.testing.assert_allclose(tau[0], tau[1], rtol=1e-5, atol=1e-6 * tau[0].max())
    assert rest.energy["friction"][-1] == pytest.approx(whole.energy["friction"][-1], rel=1e-6)


def test_what_it_refuses(steel_space: ReducedBody, rigid_space: ReducedBody) -> None:
    def refused(scene: Scene, word: str, **options: Any) -> None:
        with pytest.raises(InputError, match=word):
            monolithic.run(scene, 1e-4, step=1e-5, **{**AT_NODES, **options})

    scene, _ = on_half_space(steel_space, BALL, 1.0, law=laws.Unilateral())
    refused(scene, "has no unilateral; use laws.LinearLayer")
    grid_nodes = {"at_nodes": False}
    refused(scene, "a rigid partner, partner\\['face'\\], with the law at nodes only; use at_nodes=True", **grid_nodes)
    scene.contacts[0].kinematics = "closest_point"
    refused(scene, 'has kinematics="closest_point" with the law at nodes only', **grid_nodes)
    scene.contacts[0].friction = 0.1
    refused(scene, "has friction with the law at nodes only; use at_nodes=True", **grid_nodes)
    scene, _ = on_half_space(steel_space, BALL, 1.0, law=laws.LinearLayer(1e16), friction=0.1)
    refused(scene, "friction is there for quasi-static local modes only", local="hht")
    refused(scene, "stick_stiffness", stick_stiffness=0.0)
    refused(scene, "leave layer_stiffness out", law="nodes", layer_stiffness=1e13)
    without = half_space(5, 5, PITCH, STEEL)
    without.surface.points[:] += 1.0
    bare, _ = on_half_space(without, BALL, 1.0, law=laws.LinearLayer(1e16))
    refused(bare, "none of the body's skin lies on it")
