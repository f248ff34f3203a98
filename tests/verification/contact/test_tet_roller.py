"""The Gmsh roller of quadratic tetrahedra, tilted and off-centre in its file, through the whole chain."""

from __future__ import annotations

import numpy as np
import pytest

from scenes.rollers import PAIR, STEEL, roller_body
from warpffrf import examples
from warpffrf.model import forces, joints, signals
from warpffrf.model import rotation as rot
from warpffrf.model.contact import Contact
from warpffrf.model.mesh import read
from warpffrf.model.reduced.body import ReducedBody
from warpffrf.model.scene import Scene
from warpffrf.offline import reduce
from warpffrf.online import find_equilibrium, run

FILE = examples.path("roller") / "roller.msh"
LOAD = 400e3  # N: a half-width of some millimetres, as the 7 mm elements need


@pytest.fixture(scope="module")
def tet_body() -> ReducedBody:
    mesh = read(FILE, length_unit="mm")
    return reduce(
        mesh,
        STEEL,
        interfaces={"bore": "rigid"},
        contact={"rim": None},
        max_frequency=15e3,
        cache=False,
        progress=False,
    )


@pytest.fixture(scope="module")
def round_body() -> ReducedBody:
    """A cyclic roller of the same size and about the same nodes."""
    return roller_body(44, layers=3, axial=1, grading=1.4, order=2, max_frequency=15e3, cache=False)


def upright(body: ReducedBody) -> np.ndarray:
    """Rotation (quaternion) that turns the roller's own axis to +y."""
    e_a = np.asarray(body.contact_surfaces["rim"].shape.e_a)
    e_a = e_a if e_a[1] > 0.0 else -e_a
    y = np.array([0.0, 1.0, 0.0])
    v = np.cross(e_a, y)
    return rot.unit_quaternion(np.append(v, 1.0 + e_a @ y) / np.linalg.norm(np.append(v, 1.0 + e_a @ y)), "upright")


def stacked(lower: ReducedBody, upper: ReducedBody, load: float, speed: float = 20.0) -> Scene:
    """`upper` on a guide, pressed on `lower`; both upright, centres above each other, driven."""
    scene = Scene(gravity=(0.0, 0.0, -9.81))
    bodies = []
    for name, body, z in (("lower", lower, 0.0), ("upper", upper, 0.11)):
        handle = scene.add_body(body, name=name, rotation=upright(body))
        handle.position = handle.position + np.array([0.0, 0.0, z]) - handle.to_world(body.center_of_mass)
        bodies.append(handle)
    contact = Contact(bodies[0]["rim"], bodies[1]["rim"], name=PAIR, capacity=120)
    scene.add(contact)
    scene.close_gap(contact, along=(0, 0, 1))
    carriage = scene.add_rigid_body(5.0, (0.01,) * 3, name="carriage", position=bodies[1]["bore"].world_point())
    center = carriage.at((0, 0, 0))
    axles = [
        scene.add(joints.Revolute(scene.ground, bodies[0]["bore"], axis=(0, 1, 0), name="axle")),
        scene.add(joints.Revolute(center, bodies[1]["bore"], axis=(0, 1, 0), name="upper_axle")),
    ]
    guide = scene.add(joints.Prismatic(scene.ground, center, axis=(0, 0, 1), name="guide"))
    for axle, sense in zip(axles, (1.0, -1.0), strict=True):
        scene.add(joints.Drive(axle, signals.SmoothStep(0.0, sense * speed, duration=0.01)))
    scene.add(forces.JointSpringDamper(guide, 1e5, 1e3))
    scene.add(forces.PointForce(center, (0.0, 0.0, -load)))
    return scene


@pytest.mark.slow
def test_the_roller_is_read_and_reduced_as_one_of_its_size(tet_body: ReducedBody, round_body: ReducedBody) -> None:
    assert tet_body.report["path"] == "general"
    assert tet_body.mass == pytest.approx(round_body.mass, rel=5e-3)  # curved tetrahedra, 7 mm
    assert np.allclose(np.linalg.eigvalsh(tet_body.inertia), np.linalg.eigvalsh(round_body.inertia), rtol=1e-2)
    assert np.allclose(tet_body.center_of_mass, np.array([12.0, -7.0, 31.0]) * 1e-3, atol=2e-5)
    assert tet_body.contact_surfaces["rim"].shape.radius == pytest.approx(0.05, rel=1e-4)


@pytest.mark.parametrize("tet", ["lower", "upper"])
def test_equilibrium_on_a_cyclic_roller(tet_body: ReducedBody, round_body: ReducedBody, tet: str) -> None:
    """Force balance, and a sink near that of two cyclic rollers.

    The weak gap of a node of spacing h is h^2/(12 R) wider than the gap at its middle (1/R = 1/R1 + 1/R2): with the
    8 mm nodes of the tetrahedra as the first surface the sink is that much larger.
    """
    pair = (tet_body, round_body) if tet == "lower" else (round_body, tet_body)
    sinks = {}
    for name, bodies in (("mixed", pair), ("round", (round_body, round_body))):
        scene = stacked(*bodies, LOAD)
        rest = find_equilibrium(scene)
        assert rest.status == "completed", rest.message
        sinks[name] = scene.body("carriage").position[2] - rest.bodies["carriage"].position[-1, 2]
        weight = (bodies[1].mass + 5.0) * 9.81
        force = np.linalg.norm(rest.contacts[PAIR].force[-1])
        assert force == pytest.approx(LOAD + weight - 1e5 * sinks[name], rel=1e-6)
        F, G = rest.contacts[PAIR].force[-1], rest.contacts[PAIR].force_second[-1]
        assert np.abs(F + G).max() < 1e-10 * force
    print(sinks)
    spacing = pair[0].contact_surfaces["rim"].grid.pitch * 0.05
    own = round_body.contact_surfaces["rim"].grid.pitch * 0.05
    widened = (spacing**2 - own**2) / (12.0 * 0.025)
    assert sinks["mixed"] == pytest.approx(sinks["round"] + widened, rel=0.1)


def test_it_rolls(tet_body: ReducedBody, round_body: ReducedBody) -> None:
    scene = stacked(round_body, tet_body, LOAD)
    history = run(scene, 0.02, step=5e-4, start="equilibrium", progress=False)
    assert history.status == "completed", history.message
    turned = history.joints["axle"].coordinate[-1]
    assert turned == pytest.approx(0.3, abs=1e-7)  # 20 rad/s, half of it during the step up
    assert np.ptp(history.time) == pytest.approx(0.02)
