"""D9: the separated solver and the monolithic one, written apart, give the same motion at the same coefficients."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from mass_point_body import mass_point_body

from references import monolithic
from references.monolithic.results import to_history
from warpffrf.model import forces, joints, signals
from warpffrf.model import rotation as rot
from warpffrf.model.scene import Scene
from warpffrf.online import GeneralizedAlpha, Settings, run
from warpffrf.online.history.history import History

RHO = 0.8
TIGHT = 1e-12  # tolerance of both, of the forces
AGREE = 1e-10  # of the largest value of a history: D9, round-off of some hundred steps
# accelerations and reactions: 1e-16 of the coordinates times ACC, about 1e6/s^2, against some ten m/s^2
AGREE_FORCES = 1e-8
PLAY = 0.02  # rad
SECOND = ("acceleration", "reaction", "torque")


def both(
    scene: Scene, duration: float, step: float, *, tolerance: float = TIGHT, **more: Any
) -> tuple[History, monolithic.MonolithicHistory]:  # fmt: skip
    """The two histories."""
    a = run(
        scene, duration, step=step, integrator=GeneralizedAlpha(RHO), progress=False,
        settings=Settings(residual_tolerance=tolerance), **more,
    )  # fmt: skip
    b = monolithic.run(
        scene, duration, step=step, integrator=GeneralizedAlpha(RHO), progress=False, tolerance=tolerance,
        **more,
    )  # fmt: skip
    assert a.status == "completed", a.message
    assert b.status == "completed", b.message
    return a, b


def difference(a: History, b: monolithic.MonolithicHistory) -> dict[str, float]:
    """Largest difference of every kind of history, of its largest value over all bodies or joints."""
    found = {}
    names = ("position", "rotation", "velocity", "angular_velocity", "modal", "modal_velocity", "acceleration")
    for name in names:
        pairs = [(getattr(a.bodies[n], name), getattr(b.bodies[n], name)) for n in a.bodies]
        size = max(np.abs(x).max(initial=0.0) for x, _ in pairs)
        found[name] = max(np.abs(x - y).max(initial=0.0) for x, y in pairs) / max(size, 1e-300)
    forces_of = [(j.force, b.reactions[n][0]) for n, j in a.joints.items()]
    if forces_of:
        size = max(np.abs(x).max() for x, _ in forces_of)
        found["reaction"] = max(np.abs(x - y).max() for x, y in forces_of) / size
        torques = [(j.torque, b.reactions[n][1]) for n, j in a.joints.items()]
        found["torque"] = max(np.abs(x - y).max() for x, y in torques) / size
    return found


def check(scene: Scene, duration: float, step: float) -> None:
    """Both solvers on `scene`, compared."""
    check_difference(difference(*both(scene, duration, step)))


def check_difference(worst: dict[str, float]) -> None:
    """Differences as round-off leaves them."""
    first = max(value for name, value in worst.items() if name not in SECOND)
    second = max((worst[name] for name in SECOND if name in worst), default=0.0)
    assert first < AGREE and second < AGREE_FORCES, worst


def four_bar() -> Scene:
    """Three links between two grounded hinges, driven by gravity, one hinge spherical so that nothing is redundant."""
    scene = Scene(gravity=(0.0, 0.0, -9.81))
    places = [np.array(p) for p in ((0, 0, 0), (0.1, 0, 0.25), (0.6, 0, 0.35), (0.55, 0, 0.0))]
    links = []
    for n, (p, q) in enumerate(zip(places[:-1], places[1:], strict=True)):
        links.append(scene.add_rigid_body(0.5 + n, (0.01, 0.02, 0.015), name=f"link{n}", position=0.5 * (p + q)))
    chain = [scene.ground, *links, scene.ground]
    for n, p in enumerate(places):
        a, b = chain[n], chain[n + 1]
        ports = [x.at(x.to_user(p)) if x is not scene.ground else scene.ground.at(p) for x in (a, b)]
        if n == 1:
            scene.add(joints.Spherical(*ports, name="j1"))
        elif n == 2:
            scene.add(joints.Universal(*ports, axis=(0, 1, 0), second_axis=(1, 0, 0), name="j2"))
        else:
            scene.add(joints.Revolute(*ports, axis=(0, 1, 0), name=f"j{n}"))
    return scene


def flexible(level: str, stiffening: bool = False, squares: int = 0) -> Scene:
    """A flexible body that is spun on an axle at one interface, with a bushing and a rigid body at the other."""
    scene = Scene(gravity=(0.0, 0.0, -9.81))
    body = mass_point_body(5, stiffening=stiffening, squares=squares)
    a = scene.add_body(body, name="a", inertia=level, stiffening=stiffening, damping=0.01)
    pin = a["left"].world_point()
    axle = scene.add(joints.Revolute(scene.ground.at(pin), a["left"], axis=(0.0, 0.6, 0.8), name="axle"))
    scene.add(joints.Drive(axle, signals.SmoothStep(0.0, 15.0, duration=0.05), quantity="velocity"))
    place = a["right"].world_point()
    b = scene.add_rigid_body(0.4, (2e-3, 3e-3, 4e-3), name="b", position=place + np.array([0.05, 0.0, 0.02]))
    stiffness, damping = np.diag([2e4] * 3 + [50.0] * 3), np.diag([20.0] * 3 + [0.05] * 3)
    scene.add(forces.Bushing(a["right"], b.at(b.to_user(place)), stiffness, damping))
    scene.add(forces.PointForce(a["right"], (2.0, -1.0, 0.5), frame="body"))
    return scene


def test_pendulum() -> None:
    scene = Scene(gravity=(0.0, 0.0, -9.81))
    bob = scene.add_rigid_body(
        2.0, (0.02, 0.03, 0.025), name="bob", position=(0.9, 0.0, 0.0), center_of_mass=(0.05, 0.0, 0.02)
    )
    scene.add(joints.Revolute(scene.ground, bob.at((-0.9, 0.0, 0.0)), axis=(0, 1, 0), name="pivot"))
    check(scene, 0.5, 2e-3)


def test_four_bar() -> None:
    check(four_bar(), 0.3, 2e-3)


@pytest.mark.parametrize("level", ["constant", "deformed", "gyroscopic", "full"])
def test_flexible_body_on_joints_and_a_bushing(level: str) -> None:
    check(flexible(level), 0.05, 5e-4)


def on_characteristics() -> Scene:
    """A flexible body on a hinge with play and drag, a rigid one on a rubber mount at its end, a hardening line between
    that and the ground."""
    scene = Scene(gravity=(0.0, 0.0, -9.81))
    a = scene.add_body(mass_point_body(5), name="a", inertia="full", damping=0.01)
    pin = a["left"].world_point()
    hinge = scene.add(joints.Revolute(scene.ground.at(pin), a["left"], axis=(0.0, 0.6, 0.8), name="hinge"))
    play = forces.ForceTable([(-3.0 * PLAY, -60.0), (-PLAY, 0.0), (PLAY, 0.0), (3.0 * PLAY, 60.0)])
    scene.add(forces.TorsionalSpringDamper(hinge, play, forces.PowerLaw(0.05, 2.0), name="play"))
    place = a["right"].world_point()
    b = scene.add_rigid_body(0.4, (2e-3, 3e-3, 4e-3), name="b", position=place + np.array([0.05, 0.0, 0.02]))
    rubber = forces.ForceTable([(-1e-4, -3.0), (-5e-5, -1.0), (0.0, 0.0), (5e-5, 1.5), (1e-4, 5.0)], smooth=True)
    twist = forces.ForcePolynomial([50.0, 0.0, 500.0])
    scene.add(forces.Bushing(
        a["right"], b.at(b.to_user(place)), [rubber] * 3 + [twist] * 3, [forces.PowerLaw(20.0, 1.5)] * 3 + [0.05] * 3,
        name="mount",
    ))  # fmt: skip
    line = forces.ForcePolynomial([200.0, 0.0, 4e4])
    ends = scene.ground.at(place + 0.3), b.at((0.0, 0.0, 0.0))
    scene.add(forces.SpringDamper(*ends, line, free_length=0.5, name="line"))
    return scene


@pytest.mark.slow
def test_springs_and_dampers_with_characteristics() -> None:
    """Forces and deformations too; the play is left and entered, so that the kinks are met."""
    scene = on_characteristics()
    ours, theirs = both(scene, 0.15, 5e-4)
    check_difference(difference(ours, theirs))
    other = to_history(theirs, [])
    angle = ours.forces["play"].deformation[:, 0]
    assert np.sum(np.diff(np.abs(angle) > PLAY) != 0) >= 2
    for name, own in ours.forces.items():
        for field, within in (("deformation", AGREE), ("force", AGREE_FORCES)):
            a, b = getattr(own, field), getattr(other.forces[name], field)
            assert np.abs(a - b).max() <= within * np.abs(a).max(), (name, field)
    potential = ours.energy["potential"] - other.energy["potential"]
    assert np.abs(potential).max() < AGREE * np.ptp(ours.energy["potential"])
    assert [note for note in ours.notes if "table" in note] == [note for note in other.notes if "table" in note] != []


@pytest.mark.slow
def test_geometric_stiffening() -> None:
    check(flexible("full", stiffening=True), 0.05, 5e-4)


@pytest.mark.slow
def test_membrane_energy() -> None:
    """Squares that stiffen the modes by as much as they are stiff themselves."""
    scene = flexible("full", stiffening=True, squares=3)
    check(scene, 0.05, 5e-4)
    found = run(scene, 0.05, step=5e-4, progress=False)
    body = scene.bodies[0].flexible
    linear = 0.5 * (found.bodies["a"].modal ** 2) @ (2.0 * np.pi * body.frequencies) ** 2
    assert (found.energy["strain"] - linear).max() > 0.1 * linear.max()


@pytest.mark.slow
def test_free_rigid_body_follows_its_closed_form() -> None:
    """D4 at order 2: w(10 s) of I = (1, 2, 3) from (1e-3, 5, 1e-3)."""
    exact, errors = np.array([4.510627138, -2.157369653, 2.604211920]), []
    for step in (1e-2, 5e-3):
        scene = Scene()
        scene.add_rigid_body(1.0, (1, 2, 3), name="b", angular_velocity=(1e-3, 5, 1e-3))
        integrator = GeneralizedAlpha(1.0)
        history = monolithic.run(scene, 10.0, step=step, integrator=integrator, save_every=100, progress=False)
        motion = history.bodies["b"]
        w = rot.matrix(motion.rotation[-1]).T @ motion.angular_velocity[-1]
        errors.append(float(np.abs(w - exact).max()))
    assert np.log2(errors[0] / errors[1]) == pytest.approx(2.0, abs=0.1)
    assert errors[1] < 1e-2


def test_free_flight_keeps_momentum_and_energy_at_order_two() -> None:
    """A flexible body thrown with everything in motion, full inertia: linear momentum to round-off."""
    drift = []
    for step in (2e-3, 1e-3):
        scene = Scene()
        scene.add_body(
            mass_point_body(4, lowest=20.0), name="a", inertia="full", damping=0.0, velocity=(1.0, 2.0, 3.0),
            angular_velocity=(3.0, 8.0, -2.0),
        )  # fmt: skip
        integrator = GeneralizedAlpha(1.0)
        h = monolithic.run(scene, 0.4, step=step, integrator=integrator, progress=False, tolerance=1e-11)
        v = h.bodies["a"].velocity  # the user origin is the centre of mass
        assert np.abs(v - v[0]).max() < 1e-10 * np.linalg.norm(v[0])
        energy = h.energy["kinetic"] + h.energy["strain"]
        drift.append(np.abs(energy - energy[0]).max() / energy[0])
    assert np.log2(drift[0] / drift[1]) == pytest.approx(2.0, abs=0.3)
