"""Parameters that change between steps: closed forms of what follows, the energy ledger, states, and refusals."""

from __future__ import annotations

import numpy as np
import pytest

import warpffrf as wf
from scenes.block_on_belt import LOAD, block, wheel_body
from scenes.block_on_belt import MASS as BLOCK
from scenes.connected_rotor import CLEARANCE, FORCES, SPEED, film_scene
from warpffrf.model.bodies import SurfacePort
from warpffrf.model.errors import InputError

MASS, STEP, G = 2.0, 1e-3, 9.81
SECOND_ORDER = 1e-3  # of motions of 0.1 s and more in steps of 1 ms: (omega h)^2 / 12 with omega h below 0.06


def oscillator(damping: float = 5.0) -> wf.Scene:
    """A slider of 2 kg on a guide, pulled by a constant force, on a spring of 800 N/m."""
    scene = wf.Scene()
    slider = scene.add_rigid_body(MASS, (0.1, 0.1, 0.1), name="slider")
    guide = scene.add(wf.joints.Prismatic(scene.ground, slider, axis=(1, 0, 0), name="guide"))
    scene.add(wf.forces.JointSpringDamper(guide, stiffness=800.0, damping=damping, name="strut"))
    scene.add(wf.forces.PointForce(slider.at((0, 0, 0)), (40.0, 0, 0), name="pull"))
    return scene


def exact(t: np.ndarray, x0: float, v0: float, k: float, c: float) -> np.ndarray:
    """x and x' (2, times) of m x'' + c x' + k x = 40 N."""
    A = np.array([[0.0, 1.0], [-k / MASS, -c / MASS]])
    lam, V = np.linalg.eig(A)
    z0 = np.linalg.solve(V, np.array([x0 - 40.0 / k, v0]))
    return np.real(V @ (z0[:, None] * np.exp(np.outer(lam, t)))) + [[40.0 / k], [0.0]]


@pytest.mark.parametrize(("name", "k", "c"), [("stiffness[strut]", 2400.0, 5.0), ("damping[strut]", 800.0, 60.0)])
def test_a_spring_changes_its_rate(name: str, k: float, c: float) -> None:
    """Half a step late, as a load that jumps at the beginning of a step: its acceleration ramps over the step, which
    leaves half of the work of the jump in the ledger."""
    sim = wf.Simulation(oscillator(), step=STEP, start="initial")
    sim.run(0.1)
    x0, v0 = (float(sim.outputs[f"body_{what}_x[slider]"]) for what in ("position", "velocity"))
    sim.parameters[name] = k if "stiffness" in name else c
    assert sim.parameters[name] == (k if "stiffness" in name else c)
    sim.run(0.2)
    result = sim.result()
    after = result.time >= 0.1 - 1e-9
    x_there, v_there = x0, v0
    x0, v0 = exact(np.array([0.5 * STEP]), x0, v0, 800.0, 5.0)[:, 0]
    expected = exact(result.time[after][1:] - 0.1 - 0.5 * STEP, x0, v0, k, c)[0]
    off = result.body("slider").position[after, 0][1:] - expected
    assert np.abs(off).max() < SECOND_ORDER * np.abs(expected).max()
    e = result.energy
    stored = e["kinetic"] + e["potential"] + e["damping"] - e["force_work"]
    at = np.argmin(np.abs(result.time - 0.1))
    assert np.abs(stored[:at] - stored[0]).max() < 1e-6 * result.energy_scale
    jump = (k - 800.0) * x_there + (c - 5.0) * v_there  # N
    assert np.abs(stored[at + 1 :] - stored[0]) == pytest.approx(0.5 * STEP * jump * v_there, rel=0.05)
    if "stiffness" in name:
        booked = np.diff(e["potential"])[at]
        assert booked == pytest.approx(0.5 * 1600.0 * x_there**2, rel=0.1)  # with the motion of the step


def sliding() -> wf.Scene:
    """A block that a force of 15 N draws along a guide, weight 19.6 N, mu 0.3."""
    scene = wf.Scene(gravity=(0.0, 0.0, -G))
    block = scene.add_rigid_body(MASS, (0.1, 0.1, 0.1), name="block")
    guide = scene.add(wf.joints.Prismatic(scene.ground, block, axis=(1, 0, 0), name="guide"))
    scene.add(wf.forces.PointForce(block.at((0, 0, 0)), (15.0, 0, 0), name="pull"))
    scene.add(wf.forces.PrismaticFriction(guide, 0.3, name="rub"))
    return scene


def test_a_brake_rubs_harder() -> None:
    """Acceleration (F - mu m g)/m before and after; it stops under the larger friction, and sticks."""
    sim = wf.Simulation(sliding(), step=STEP)
    sim.run(0.2)
    v = float(sim.outputs["body_velocity_x[block]"])
    assert v == pytest.approx(0.2 * (15.0 / MASS - 0.3 * G), rel=SECOND_ORDER * 10)
    sim.parameters["friction[rub]"] = 0.9
    sim.run(0.1)
    after = float(sim.outputs["body_velocity_x[block]"])
    assert after == pytest.approx(v + 0.1 * (15.0 / MASS - 0.9 * G), rel=SECOND_ORDER * 10)
    sim.run(1.0)
    assert abs(float(sim.outputs["body_velocity_x[block]"])) < 1e-9


def test_a_state_has_the_parameters() -> None:
    """Saved, changed, restored: the same bits; in another Simulation too."""
    first = wf.Simulation(oscillator(), step=STEP)
    first.parameters["damping[strut]"] = 50.0
    first.run(0.05)
    state = first.state
    first.run(0.05)
    there = first.outputs["body_position_x[slider]"]
    first.parameters["damping[strut]"] = 1.0
    first.run(0.05)
    for sim in (first, wf.Simulation(oscillator(), step=STEP)):
        sim.state = state
        assert sim.parameters["damping[strut]"] == 50.0
        sim.run(0.05)
        assert np.array_equal(sim.outputs["body_position_x[slider]"], there)


def test_semi_active_damping() -> None:
    """A damper that a function sets at each step to 0.4 N s/m per m/s: as one with that quadratic law."""

    def harder(sim: wf.Simulation) -> None:
        sim.parameters["damping[strut]"] = max(400.0 * abs(float(sim.outputs["body_velocity_x[slider]"])), 1e-9)

    sim = wf.Simulation(oscillator(1.0), step=1e-4, before_step=harder)
    sim.run(0.1)
    x, v, h = 0.0, 0.0, 1e-6
    for _ in range(100_000):
        v += h * (40.0 - 800.0 * x - 400.0 * abs(v) * v) / MASS
        x += h * v
    assert float(sim.outputs["body_position_x[slider]"]) == pytest.approx(x, rel=2e-3)  # late by half a step


def test_oil_becomes_warm() -> None:
    """An isothermal film at another temperature is that of a scene with the oil there, of Roelands' law too."""
    law = wf.oils.RoelandsLaw(1.2)
    oil = wf.oils.Roelands(0.05, coefficient=2e-8, thermal=wf.oils.Thermal(law, 40.0, 2000.0))
    found = []
    for used, temperature in ((oil, 70.0), (oil.at(70.0), None)):
        scene, centre = film_scene((0.6 * CLEARANCE, 0.0), (32, 5))
        scene.films[0].oil = used
        hinge = scene.add(wf.joints.Revolute(scene.ground.at((0.6 * CLEARANCE, 0, 0)), centre, axis=(0, 1, 0)))
        scene.add(wf.joints.Drive(hinge, SPEED, quantity="velocity"))
        sim = wf.Simulation(scene, step=1e-4)
        if temperature is not None:
            assert sim.parameters["oil_temperature[film]"] == 40.0
            sim.parameters["oil_temperature[film]"] = temperature
        sim.run(2e-3)
        found.append([float(sim.outputs[name]) for name in FORCES])
    assert np.hypot(*found[0]) > 10.0  # N
    assert found[0] == pytest.approx(found[1], rel=1e-6)  # what the start at 40 degrees leaves in the cavities


def floor(scene: wf.Scene) -> SurfacePort:
    return scene.ground.surface(wf.surfaces.Plane(origin=(0.0, 0.0, 0.0), outward=(0.0, 0.0, 1.0)), name="floor")


def test_contact_rubs_harder() -> None:
    """A block that slides on a plane decelerates by mu N/m: three times the coefficient, three times that."""
    body = wheel_body(240)
    scene, _, along = block(body, 0.5)
    scene.add(wf.Contact(scene.body("block")["rim"], floor(scene), friction=0.05, name="pair"))
    sim = wf.Simulation(scene, step=2e-4, start="equilibrium")
    speed = "body_velocity_x[slide]"
    slopes = []
    for mu in (0.05, 0.15):
        sim.parameters["friction[pair]"] = mu
        sim.run(4e-3)  # the patch slips as a whole again
        before = float(sim.outputs[speed])
        sim.run(4e-3)
        slopes.append((before - float(sim.outputs[speed])) / 4e-3)
    assert str(along.name) == "along"
    assert slopes[0] == pytest.approx(0.05 * LOAD / (BLOCK + body.mass), rel=0.01)  # the block bounces a little
    assert slopes[1] == pytest.approx(3.0 * slopes[0], rel=0.01)


@pytest.mark.parametrize(
    ("name", "value", "message"),
    [
        ("stiffness[strat]", 1.0, "parameter 'stiffness.strat.' does not exist; did you mean 'stiffness.strut.'"),
        ("stiffness[strut]", 0.0, "must be positive, got 0"),
        ("damping[strut]", -1.0, "must be positive, got -1"),
        ("damping[strut]", float("nan"), "finite"),
    ],
)
def test_wrong_values_are_refused(name: str, value: float, message: str) -> None:
    sim = wf.Simulation(oscillator(), step=STEP)
    with pytest.raises(InputError, match=message):
        sim.parameters[name] = value
