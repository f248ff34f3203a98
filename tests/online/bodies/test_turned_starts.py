"""Every kind of start in frames of the world that are rotated against each other and shifted: found in each, and the
same."""

from __future__ import annotations

import functools
from collections.abc import Callable

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from warpffrf.model import films, forces, joints, oils, signals, surfaces
from warpffrf.model.contact import Contact
from warpffrf.model.films import Film
from warpffrf.model.material import Material
from warpffrf.model.mesh import box, roller, sleeve
from warpffrf.model.reduced.body import ReducedBody
from warpffrf.model.scene import Scene
from warpffrf.model.surfaces import Matched
from warpffrf.offline import reduce
from warpffrf.online import find_equilibrium, run
from warpffrf.online.engine import Engine
from warpffrf.online.start.consistent import start_consistently

STEEL = Material(210e9, 0.3, 7850.0)
FRAMES = [Rotation.random(rng=np.random.default_rng(seed)) for seed in range(4)] + [
    Rotation.from_euler("y", 30.0, degrees=True)
]
SHIFT = np.array([1.3, -2.0, 0.7])  # m
Array = np.ndarray


@functools.cache
def body(kind: str) -> ReducedBody:
    """A sleeve, two blocks with faces that meet, a wheel."""
    if kind == "sleeve":
        mesh = sleeve(0.025, 0.035, 0.02, sectors=16, order=1, axial=4)
        bore = {"bore": surfaces.Bore()}
        return reduce(mesh, STEEL, interfaces={"outside": "rigid"}, contact=bore, modes=4, cache=False, progress=False)
    if kind == "wheel":
        mesh, rim = roller(0.05, 0.015, 0.02, sectors=24, layers=2, axial=2, order=1), {"rim": surfaces.Cylinder()}
        return reduce(mesh, STEEL, interfaces={"bore": "rigid"}, contact=rim, modes=4, cache=False, progress=False)
    low, high = ("z_min", "z_max") if kind == "lower" else ("z_max", "z_min")
    mesh = box((0.06, 0.02, 0.02), (6, 2, 2), order=1)
    return reduce(
        mesh,
        STEEL,
        interfaces={low: "rigid"},
        contact={"face": Matched(first=high)},
        modes=6,
        cache=False,
        progress=False,
    )


def oiled(R: Rotation, t: Array, speed: float = 43.0) -> Scene:
    """A shaft that is rotated in its bearing, a little off the middle."""
    scene = Scene(gravity=(0.0, 0.0, 0.0))
    held = scene.add_body(body("sleeve"), name="sleeve", position=t, rotation=R.as_quat())
    journal = surfaces.Cylinder(radius=0.025 - 25e-6, axis_point=(0, 0, 0), axis_direction=(0, 1, 0))
    shaft = scene.add_rigid_body(
        0.5, (2e-4, 2e-4, 2e-4), name="shaft", position=R.apply([-3e-6, 0.0, 2e-6]) + t, rotation=R.as_quat(),
        angular_velocity=R.apply([0.0, speed, 0.0]), surfaces={"rim": journal},
    )  # fmt: skip
    middle, axis = shaft.at((0, 0, 0)), R.apply([0.0, 1.0, 0.0])
    scene.add(joints.Fixed(scene.ground, held["outside"], axis=axis))
    plane = scene.add(joints.Planar(scene.ground.at(t), middle, axis=axis))
    scene.add(joints.Drive(plane, signals.Constant(speed), quantity="velocity"))
    scene.add(forces.PointForce(middle, tuple(R.apply([1300.0, 0.0, 300.0]))))
    groove = films.AxialGroove(np.pi, 1e-4, 2e5)
    oil = oils.Newtonian(0.01)
    scene.add(Film(held["bore"], shaft["rim"], oil=oil, feeds=[groove], ambient_pressure=1e5, name="film"))
    return scene


def lapped(R: Rotation, t: Array) -> Scene:
    """A block that slides on another without friction, and is pressed on it."""
    scene = Scene(gravity=tuple(R.apply([0.0, 0.0, -9.81])))
    lower = scene.add_body(body("lower"), name="lower", position=R.apply([0, 0, 0.01]) + t, rotation=R.as_quat())
    upper = scene.add_body(body("upper"), name="upper", position=R.apply([0, 0, 0.03]) + t, rotation=R.as_quat())
    scene.add(joints.Fixed(scene.ground, lower["z_min"]))
    scene.add(Contact(upper["face"], lower["face"], sliding="small", friction=0.0, name="face"))
    scene.add(forces.PointForce(upper["z_max"], tuple(R.apply([0.0, 0.0, -2900.0]))))
    return scene


def pressed(R: Rotation, t: Array) -> Scene:
    """A wheel on a plane."""
    scene = Scene(gravity=tuple(R.apply([0.0, 0.0, -9.81])))
    wheel = scene.add_body(body("wheel"), name="wheel", position=R.apply([0, 0, 0.05]) + t, rotation=R.as_quat())
    floor = scene.ground.surface(surfaces.Plane(origin=t, outward=R.apply([0.0, 0.0, 1.0])), name="floor")
    scene.add(Contact(wheel["rim"], floor, name="contact"))
    scene.add(forces.PointForce(wheel["bore"], tuple(R.apply([0.0, 0.0, -500.0]))))
    return scene


@pytest.mark.parametrize("turned", range(len(FRAMES)))
def test_accelerations_of_a_film_at_the_start_are_found_in_every_frame(turned: int) -> None:
    """The start takes a tiny step, in which round-off of a gap, 1e-17 m, is a flow. Nothing of it may be what Newton's
    method waits for; accelerations agree as far as that flow goes."""
    found = []
    for R, t in ((Rotation.identity(), np.zeros(3)), (FRAMES[turned], np.zeros(3)), (FRAMES[turned], SHIFT)):
        engine = Engine(oiled(R, t))
        engine.initial_rates()
        start_consistently(engine, 2e-4)
        assert not np.any(engine.word("status"))
        assert engine.word("iteration")[0] <= 6  # Newton's method is quadratic as long as it sees no round-off
        found.append(R.inv().apply(engine.state.v_rate.numpy()[0, 1]))
    size = np.linalg.norm(found[0])
    assert np.linalg.norm(found[1] - found[0]) < 1e-5 * size
    assert np.linalg.norm(found[2] - found[0]) < 1e-3 * size  # places of metres have 4e-16 m


@pytest.mark.parametrize(("made", "name"), [(oiled, "shaft"), (lapped, "upper"), (pressed, "wheel")])
def test_equilibria_are_found_in_every_frame(made: Callable[[Rotation, Array], Scene], name: str) -> None:
    """What nothing resists, a block on its face, is held and said in each."""
    places = []
    for R, t in [(Rotation.identity(), np.zeros(3)), *((R, np.zeros(3)) for R in FRAMES), (FRAMES[0], SHIFT)]:
        history = find_equilibrium(made(R, t), progress=False)
        assert history.status == "completed", history.message
        if made is lapped:
            assert any("free to slide along a plane" in note for note in history.notes)
        places.append(R.inv().apply(history.bodies[name].position[-1] - t))
    np.testing.assert_allclose(places, [places[0]] * len(places), atol=1e-9)


def test_a_run_that_begins_at_rest_on_a_small_sliding_contact_without_friction_stays_there() -> None:
    history = run(lapped(FRAMES[0], np.zeros(3)), 2e-3, step=2e-4, start="equilibrium", progress=False)
    assert history.status == "completed", history.message
    moved = history.bodies["upper"].position - history.bodies["upper"].position[0]
    assert np.abs(moved).max() < 1e-9
