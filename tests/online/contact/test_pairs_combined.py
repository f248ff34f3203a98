"""Several pairs on one surface together with everything else: three free bodies that collide, layers, few points,
dynamic local modes, friction of unlike bodies; runs that go on, worlds, and small motions about a state."""

from __future__ import annotations

import sys
from pathlib import Path as FilePath
from typing import Any

import numpy as np
import pytest
from scipy.linalg import null_space

from scenes.flat_settings import reduce_flat
from warpffrf.model import forces, joints, laws, surfaces
from warpffrf.model import rotation as rot
from warpffrf.model.contact import Contact
from warpffrf.model.integrators import GeneralizedAlpha
from warpffrf.model.material import Material
from warpffrf.model.mesh import roller
from warpffrf.model.reduced.body import ReducedBody
from warpffrf.model.scene import Scene
from warpffrf.online import Engine, Settings, find_equilibrium, run
from warpffrf.online.arrays.declaration import numbers_of
from warpffrf.online.history.history import History
from warpffrf.online.start.consistent import start_consistently
from warpffrf.online.start.static_equilibrium import settle
from warpffrf.online.vibrations.linearise import linearise
from warpffrf_kernels.core import control as k

sys.path.insert(0, str(FilePath(__file__).parents[1]))

STEP, STEPS = 2e-6, 90  # s: both contacts open, close and open again
SPEED, SPIN = 1.0, (20.0, -30.0, 40.0)  # m/s, rad/s
GAPS = (2e-7, 5e-6)  # m: the second contact closes while the first one is closed
EXACT = 1e-10  # of the momenta, and of forces and torques on both sides: promised
# torque on the second side at few points: they are not symmetric along the axis, bodies tilt by 1e-6, and what the
# second surface's loads sum to is exact for parallel axes only (docs/method.md)
FEW = 1e-5
SECOND_ORDER = 1e-6  # of the angular momentum at this step: bodies turn and shift, error of the integrator
GAINED = 0.01  # of the energy: promised


def body(sectors: int, radius: float, width: float, modulus: float, axial: int = 2, **more: Any) -> ReducedBody:
    mesh = roller(radius, 0.015, width, sectors=sectors, layers=2, axial=axial, grading=1.4, order=1)
    return reduce_flat(
        mesh, Material(modulus, 0.3, 7850.0), interfaces={"bore": "rigid"}, contact={"rim": surfaces.Cylinder()},
        max_frequency=15e3, contact_fixed=False, cache=False, progress=False, **more,
    )  # fmt: skip


@pytest.fixture(scope="module")
def unlike() -> tuple[ReducedBody, ReducedBody]:
    """Steel and aluminium, other radii and widths, grids that never match."""
    more = {"tangential": True, "sampling_error": 0.01, "local_dynamics": True}
    return body(144, 0.05, 0.02, 210e9, **more), body(132, 0.045, 0.026, 70e9, **more)


def three(
    bodies: tuple[ReducedBody, ReducedBody],
    middle_first: tuple[bool, bool],
    spin: tuple[float, ...] = SPIN,
    **more: Any,
) -> Scene:
    """A free spinning roller hit at two places of its rim by two others, one of them unlike."""
    scene = Scene(gravity=(0.0, 0.0, 0.0))
    middle = scene.add_body(
        bodies[0], name="middle", velocity=(0.1, 0.0, 0.05), angular_velocity=(0.0, spin[0], 0.0)
    )  # fmt: skip
    for angle, other, name, first, rate, gap in zip(
        (-60.0, 60.0), bodies[::-1], ("low", "high"), middle_first, spin[1:], GAPS, strict=True
    ):
        out = np.array([np.cos(np.radians(angle)), 0.0, np.sin(np.radians(angle))])
        away = 0.05 + other.contact_surfaces["rim"].shape.radius + gap
        striker = scene.add_body(
            other, name=name, position=away * out, velocity=-SPEED * out, angular_velocity=(0.0, rate, 0.0)
        )
        ends = (middle["rim"], striker["rim"]) if first else (striker["rim"], middle["rim"])
        scene.add(Contact(*ends, name=name, **more))
    return scene


def drifts(scene: Scene, history: History) -> tuple[float, float]:
    """Largest change of the linear and angular momentum of all bodies, of the sums of their sizes."""
    P, L, size, turning = np.zeros(3), np.zeros(3), 0.0, 0.0
    for b in scene.bodies:
        motion = history.bodies[b.name]
        A = np.array([rot.matrix(q) for q in motion.rotation])
        v = motion.velocity + np.cross(motion.angular_velocity, A @ b.center_of_mass)
        spin = np.einsum("tij,tj->ti", A @ b.inertia @ A.transpose(0, 2, 1), motion.angular_velocity)
        orbit = b.mass * np.cross(motion.position + A @ b.center_of_mass, v)
        P, L = P + b.mass * v, L + orbit + spin
        size += b.mass * float(np.linalg.norm(v[0]))
        turning += float(np.linalg.norm(spin[0])) + b.mass * SPEED * 0.1
    return float(np.abs(P - P[0]).max()) / size, float(np.abs(L - L[0]).max()) / turning


def balance(scene: Scene, history: History) -> tuple[float, float]:
    """Force and torque (about the world's origin) of both sides of a contact, what is left of their sum."""
    left = np.zeros(2)
    for contact in scene.contacts:
        c = history.contacts[contact.name]
        at, there = (history.bodies[p.body.name].position for p in contact.ports)
        torque = c.torque + np.cross(at, c.force) + c.torque_second + np.cross(there, c.force_second)
        size = np.abs(c.force).max()
        left = np.maximum(left, [np.abs(c.force + c.force_second).max() / size, np.abs(torque).max() / (0.1 * size)])
    return float(left[0]), float(left[1])


LINEAR, STIFFER = laws.LinearLayer(1e13), laws.LinearLayer(3e14)
POWER, ROUGH = laws.NonlinearLayer(1e20, 2.0), laws.ExponentialAsperities(1e7, 1e-6)
DAMPED = laws.HuntCrossley(1e17, 1.5, restitution=0.7, impact_speed=SPEED)
CASES: dict[str, dict[str, Any]] = {
    "plain": {},
    "one layer": {"law": (LINEAR, laws.Unilateral())},
    "two layers": {"law": (LINEAR, STIFFER)},
    "nonlinear": {"law": (POWER, ROUGH)},
    "damped": {"law": (DAMPED, POWER), "friction": (0.0, 0.2)},
    "friction": {"friction": (0.3, 0.3)},
    "friction on one": {"friction": (0.3, 0.0)},
    "reduced": {"quadrature": "reduced", "friction": (0.2, 0.2)},
    "reduced layers": {"quadrature": "reduced", "law": (POWER, LINEAR)},
    "hht": {"local": "hht"},
    "hht layers": {"local": "hht", "law": (ROUGH, LINEAR)},
    "exponential": {"local": "exponential"},
}


@pytest.mark.parametrize("middle_first", [(True, True), (False, True), (False, False)])
@pytest.mark.parametrize("case", CASES)
def test_three_free_bodies_collide(
    unlike: tuple[ReducedBody, ReducedBody], case: str, middle_first: tuple[bool, bool]
) -> None:
    """Momenta, action and reaction on both sides, no energy from nowhere, work of friction never positive."""
    options = dict(CASES[case])
    local = options.pop("local", "quasi_static")
    spin = SPIN if "friction" in options else (0.0, 0.0, 0.0)  # without, the grids turn under patches of two columns
    scene = three(unlike, middle_first, spin, quadrature=options.get("quadrature", "full"))
    for n, contact in enumerate(scene.contacts):
        contact.law = options.get("law", (contact.law, contact.law))[n]
        contact.friction = laws.Coulomb(options.get("friction", (0.0, 0.0))[n])
    history = run(scene, STEPS * STEP, step=STEP, local_modes=local, progress=False)
    assert history.status == "completed", history.message
    for c in history.contacts.values():
        on = np.abs(c.force).max(axis=1) > 0.0
        assert on.sum() > 8 and (not on[0] or "law" in options)  # asperities reach over the gap
    linear, angular = drifts(scene, history)
    assert linear < EXACT and angular < SECOND_ORDER
    force, torque = balance(scene, history)
    assert force < EXACT and torque < (FEW if "reduced" in case else EXACT)
    energy = np.sum([history.energy[name] for name in ("kinetic", "strain", "contact")], axis=0)
    assert energy.max() < (1.0 + GAINED) * energy[0]
    assert np.diff(history.energy["friction"]).max() <= 0.0
    assert history.counters["impulsive_steps"] > 0 and (
        history.counters["repeated_steps"] > 0 or local == "quasi_static"
    )


RUNS: dict[str, dict[str, Any]] = {
    "friction": {"friction": 0.3},
    "every third": {"friction": 0.3, "save_every": 3},
    "projected": {"friction": 0.3, "integrator": GeneralizedAlpha(0.8, project_velocities=True)},
    "adaptive": {"friction": 0.3, "step_error": 1e-5},
    "impulsive": {"local_modes": "hht"},
    "damped": {"law": DAMPED},
}
CONTACT = ("law", "friction")


@pytest.mark.parametrize("case", RUNS)
def test_a_run_goes_on_bit_for_bit(unlike: tuple[ReducedBody, ReducedBody], case: str) -> None:
    """From before, within and after the contacts: everything that the state holds, but for the reasons of steps that
    were halved, which are those of the run."""
    options = RUNS[case]
    scene = three(unlike, (False, True), **{name: v for name, v in options.items() if name in CONTACT})
    how = {name: v for name, v in options.items() if name not in CONTACT}
    whole = run(scene, STEPS * STEP, step=STEP, progress=False, **how)
    assert whole.status == "completed", whole.message
    for steps in (21, 36, 60):
        part = run(scene, steps * STEP, step=STEP, progress=False, **how)
        rest = run(scene, (STEPS - steps) * STEP, step=STEP, start=part, progress=False, **how)
        for name, value in whole.checkpoint.items():
            found = rest.checkpoint[name].copy()
            if name == "ctl":
                found["reason"] = value["reason"]
            assert np.array_equal(numbers_of(found), numbers_of(value), equal_nan=True), (steps, name)


def test_worlds_give_the_numbers_of_one(unlike: tuple[ReducedBody, ReducedBody]) -> None:
    """Also where room for nodes grows on the way, of all worlds at once."""
    scene = three(unlike, (False, True), friction=0.3)
    rows = []
    for worlds in (1, 3):
        engine = Engine(scene, worlds=worlds)
        engine.initial_rates()
        start_consistently(engine)
        engine.control(every=1)
        engine.enter(k.DYNAMIC, STEP, target=STEPS)
        engine.replay(4 * STEPS)
        assert (engine.word("step") == STEPS).all() and not engine.word("status").any()
        rows += [engine.saved(w) for w in range(worlds)]
    for other in rows[1:]:
        for name, row in rows[0].items():
            assert np.array_equal(row, other[name], equal_nan=True), name


LOAD, MORE, LIGHT = 1000e3, 100.0, 300e3  # N
WIDE, NARROW, OTHER = 0.04, 0.01, 0.045  # m


def side_by_side(wide: ReducedBody, narrow: ReducedBody, middle_first: tuple[bool, bool], apart: float) -> Scene:
    """Two narrow rollers pressed on a wide one that is clamped, `apart` [m] between their ends."""
    scene = Scene()
    below = scene.add_body(wide, name="wide")
    scene.add(joints.Fixed(scene.ground, below["bore"], name="clamp"))
    for sign, name, first in zip((-0.5, 0.5), ("left", "right"), middle_first, strict=True):
        out = np.array([0.0, 0.0, 1.0])
        place = (0.05 + OTHER) * out + np.array([0.0, sign * (NARROW + apart), 0.0])
        above = scene.add_body(narrow, name=name, position=place)
        scene.add(joints.Prismatic(scene.ground, above["bore"], axis=out, name=f"{name} guide"))
        scene.add(forces.PointForce(above["bore"], -LIGHT * out))
        ends = (below["rim"], above["rim"]) if first else (above["rim"], below["rim"])
        scene.add(Contact(*ends, name=name))
    return scene


@pytest.mark.parametrize("middle_first", [(True, True), (False, True), (False, False)])
@pytest.mark.parametrize("apart", [0.002, 0.01])
def test_patches_side_by_side(middle_first: tuple[bool, bool], apart: float) -> None:
    """Along the axis in the same columns of the grid: rest is found, steps take a few iterations, none is
    halved. (A compliance between the middles of the nodes was indefinite here.)"""
    wide = body(96, 0.05, WIDE, 210e9, axial=8)
    narrow = body(80, OTHER, NARROW, 210e9)
    scene = side_by_side(wide, narrow, middle_first, apart)
    rest = find_equilibrium(scene)
    assert rest.status == "completed", rest.message
    for contact in rest.contacts.values():
        assert np.linalg.norm(contact.force[0]) == pytest.approx(LIGHT, rel=1e-6)
    history = run(scene, 2e-4, step=2e-6, settings=Settings(energy_tolerance=1e9, gain_limit=0.0), progress=False)
    assert history.status == "completed", history.message
    assert history.counters["mean_iterations"] < 4.5 and history.counters["rejected_steps"] == 0


@pytest.mark.parametrize("middle_first", [(False, True), (True, True), (False, False)])
def test_static_stiffness_is_that_of_neighbouring_equilibria(middle_first: tuple[bool, bool]) -> None:
    """A stack of three pressed from above: how both upper rollers give way, by the linearised scene and by differences.
    Nodes stay the same over the load's change."""
    plain, other = body(120, 0.05, 0.02, 210e9), body(96, 0.045, 0.026, 210e9)
    settings = Settings(residual_tolerance=1e-12)

    def stack(load: float) -> Scene:
        scene = Scene()
        rollers = [scene.add_body(b, name=n, position=(0.0, 0.0, z)) for b, n, z in (
            (plain, "below", 0.0), (other, "middle", 0.095), (plain, "above", 0.19)
        )]  # fmt: skip
        scene.add(joints.Fixed(scene.ground, rollers[0]["bore"], name="clamp"))
        for roll in rollers[1:]:
            scene.add(joints.Prismatic(scene.ground, roll["bore"], axis=(0, 0, 1), name=f"{roll.name} guide"))
        scene.add(forces.PointForce(rollers[2]["bore"], (0.0, 0.0, -load)))
        for beside, first in ((rollers[0], middle_first[0]), (rollers[2], middle_first[1])):
            ends = (rollers[1]["rim"], beside["rim"])
            scene.add(Contact(*(ends if first else ends[::-1]), name=beside.name))
        return scene

    heights = []
    for load in (LOAD - MORE, LOAD + MORE):
        rest = find_equilibrium(stack(load), settings=settings)
        assert rest.status == "completed", rest.message
        heights.append([rest.bodies[name].position[0, 2] for name in ("middle", "above")])
    given = (np.array(heights[1]) - heights[0]) / (2.0 * MORE)
    scene = stack(LOAD)
    engine = Engine(scene, settings=settings)
    assert settle(engine)
    linear = linearise(engine)
    S = 1.0 / np.sqrt(np.diag(linear.M))
    N = S[:, None] * null_space(linear.C * S)
    above = scene.body("above")
    pull = np.zeros(len(S))
    pull[6 * above.index + 2] = -1.0
    pull[-above.mode_count :] = -plain.interfaces["bore"].modes[:, 2]
    found = linear.T @ N @ np.linalg.lstsq(N.T @ linear.K @ N, N.T @ pull, rcond=1e-14)[0]
    np.testing.assert_allclose(found[[8, 14]], given, rtol=1e-7)
