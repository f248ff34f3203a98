"""Line contact with friction and slip along the axis: a roller on a plane, which is no like half-space.

Three cases: a rubber roller that a force at its hub carries along, free otherwise; a driven one with 1 % lateral creep,
of a material without lateral contraction, whose tractions open gaps most; steel at 1 MN/m with 0.5 %. Tractions and
pressures answer to each other there: an iteration that solves for one with the other held takes as many iterations
whatever the step, and fails.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pytest

import warpffrf as wf

RADIUS, WIDTH, FRICTION = 0.05, 0.02, 0.3
FEW = 8  # iterations of a step, 5 to 6 on the average: bounds follow the pressures once in each
AGREE = 0.01  # of the force, linear against quadratic cells with the same columns
GIVEN = 1e-5  # of the work: slip that the iteration leaves of cells that stick, which the ledger leaves out
PUSH, GRAVITY = 0.268, 9.66  # N, m/s2


@dataclass(frozen=True)
class Case:
    material: wf.Material
    speed: float  # m/s
    creep: float  # lateral, of the speed; 0: free, pushed by a force
    load: float  # N
    mass: float  # kg, of the carriage
    modes: int
    columns: int
    layers: int  # of linear cells
    step: float  # s, in which the patch moves by half a column or so
    duration: float  # s, to where the force is steady, or the push is long at its full size


CASES = {
    "carried along": Case(wf.Material(1e7, 0.3, 1100.0), 0.0, 0.0, 0.0, 0.0, 0, 960, 10, 5e-4, 0.3),
    "rubber": Case(wf.Material(2e8, 0.0, 1100.0), 0.2, 0.01, 120.0, 1.0, 0, 960, 10, 1e-3, 0.2),
    "steel": Case(wf.Material(210e9, 0.3, 7850.0), 0.1, 0.005, 20e3, 100.0, 10, 1920, 12, 8e-4, 0.15),
}


def roller(case: Case, order: int, axial: int, columns: int, layers: int) -> wf.ReducedBody:
    mesh = wf.mesh.roller(
        RADIUS, 0.015, WIDTH, sectors=columns // order, layers=layers // order, axial=axial, order=order
    )
    return wf.reduce(
        mesh, case.material, interfaces={"bore": "rigid"}, contact={"rim": wf.surfaces.Cylinder()}, modes=case.modes,
        grid=wf.ContactGrid(tangential=True, contact_fixed=False), cache=False, progress=False,
    )  # fmt: skip


def scene_of(case: Case, body: wf.ReducedBody) -> wf.Scene:
    scene = wf.Scene(gravity=(0.0, 0.0, 0.0 if case.creep else -GRAVITY))
    plane = scene.ground.surface(wf.surfaces.Plane(origin=(0, 0, 0), outward=(0, 0, 1)), name="plane")
    along, across = (case.speed, 0.0, 0.0), (case.speed, case.creep * case.speed, 0.0)
    at, center = (0.0, 0.0, RADIUS), (0.0, 0.0, 0.0)
    wheel = scene.add_body(
        body, name="wheel", position=at, velocity=across, angular_velocity=(0.0, case.speed / RADIUS, 0.0)
    )
    scene.add(wf.Contact(wheel["rim"], plane, friction=FRICTION, name="pair"))
    if not case.creep:
        scene.add(wf.forces.PointForce(wheel["bore"], (wf.signals.SmoothStep(0.0, PUSH, duration=0.02), (1, 0, 0))))
        return scene
    inertia = (1e-3 * case.mass,) * 3
    x, y, z = (
        scene.add_rigid_body(case.mass, inertia, name=name, position=at, velocity=velocity).at(center)
        for name, velocity in (("x", along), ("y", across), ("z", across))
    )
    forward = scene.add(wf.joints.Prismatic(scene.ground, x, axis=(1, 0, 0)))
    sideways = scene.add(wf.joints.Prismatic(x, y, axis=(0, 1, 0)))
    scene.add(wf.joints.Prismatic(y, z, axis=(0, 0, 1)))
    scene.add(wf.joints.Revolute(z, wheel["bore"], axis=(0, 1, 0)))
    scene.add(wf.joints.Drive(forward, case.speed, quantity="velocity"))
    scene.add(wf.joints.Drive(sideways, case.creep * case.speed, quantity="velocity"))
    scene.add(wf.forces.PointForce(z, (0.0, 0.0, -case.load)))
    return scene


def rubbed(case: Case, body: wf.ReducedBody, duration: float, step: float) -> wf.Result:
    """A run to its end in a few iterations a step, in which friction takes energy everywhere and at all times."""
    result = wf.simulate(scene_of(case, body), duration, step=step, start="equilibrium", progress=False)
    counters = result.history.counters
    assert result.status == "completed", result.message
    assert counters["rejected_steps"] == 0 and counters["max_iterations"] <= FEW
    assert np.all(np.diff(result.energy["friction"]) <= 0.0) and result.energy["friction"][-1] < 0.0
    friction = result.history.contacts["pair"].friction
    assert friction is not None
    work = np.sum(friction.traction * friction.slip_velocity, axis=1)
    assert np.maximum(work, 0.0).sum() <= GIVEN * -work.sum()
    return result


def force_of(case: Case, result: wf.Result) -> float:
    """Tangential force, of creep over the normal one; mean of the last quarter."""
    force = result.contact("pair").force
    late = force[len(force) * 3 // 4 :]
    return float(np.mean(late[:, 1] / late[:, 2]) if case.creep else np.mean(late[:, 0]))


@pytest.mark.parametrize("order", [1, pytest.param(2, marks=pytest.mark.slow)])
@pytest.mark.parametrize("name", CASES)
def test_it_runs_on_coarse_grids(name: str, order: int) -> None:
    """With a patch of two to four columns, through the transient; at a tenth of the step too."""
    case = CASES[name]
    body = roller(case, order, 4, case.columns // 2, case.layers - 2)
    for part in (1.0, 0.1):
        rubbed(case, body, (0.2 if not case.creep else 0.02) * part**0.5, part * case.step / 2.0)


@pytest.mark.slow
@pytest.mark.parametrize("axial", [1, 4, 8])
@pytest.mark.parametrize("name", CASES)
def test_linear_and_quadratic_cells_agree(name: str, axial: int) -> None:
    case = CASES[name]
    forces, bodies = [], [roller(case, order, axial, case.columns, case.layers) for order in (1, 2)]
    for body in bodies:
        result = rubbed(case, body, case.duration, case.step)
        forces.append(force_of(case, result))
    print(f"{name}, axial {axial}: {forces[0]:.5f} of linear cells, {forces[1]:.5f} of quadratic ones")
    assert abs(forces[0] / forces[1] - 1.0) < AGREE
    if not case.creep:  # the ground's share of the push in rolling
        mass, about = bodies[1].mass, bodies[1].inertia[1, 1] / RADIUS**2
        assert abs(forces[1] / (-PUSH * about / (mass + about)) - 1.0) < AGREE
