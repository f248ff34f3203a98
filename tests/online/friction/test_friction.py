"""Friction between two rollers: sliding, sticking, creep, and what it may do to energy and momentum."""

from __future__ import annotations

from itertools import pairwise
from typing import Any

import numpy as np
import pytest

import warpffrf as wf
from warpffrf.model.errors import InputError
from warpffrf.model.reduced.local_modes import dynamic_modes
from warpffrf.online.history.history import FrictionHistory

MU = 0.3
LOAD = 300e3  # N on a width of 10 mm: a half-width of 2.9 mm, four to five columns of cells across the patch
OMEGA = 10.0  # rad/s
STEP = 5e-4  # s: a twelfth of the way through the patch
CONVERGED = 1e-7  # tractions are converged to this part of the largest bound: so much slip is left where they stick
SAMPLES = 40  # of a cell, the same number on both sides of its node: exact for what is linear there
LATE = 5e-6  # of the traction: elastic softness of a cell just reached compared with the law's own, 5e-15 to 5e-9 m/Pa
SECOND_ORDER = 5e-3  # (a/R)^2: the tractions are tangents of a patch that is an arc


@pytest.fixture(scope="module")
def body() -> wf.ReducedBody:
    mesh = wf.mesh.roller(0.05, 0.015, 0.01, sectors=240, layers=5, axial=2, grading=1.6, order=1)
    return wf.reduce(
        mesh, wf.Material(210e9, 0.3, 7850.0), interfaces={"bore": "rigid"}, contact={"rim": wf.surfaces.Cylinder()},
        modes=0, grid=wf.ContactGrid(tangential=True, contact_fixed=False), cache=False, progress=False,
    )  # fmt: skip


def rollers(body: wf.ReducedBody, friction, creepage: float, load: float = LOAD) -> wf.Scene:
    """A lower roller driven, an upper one driven the other way a little slower, pressed on it through its axle."""
    scene = wf.Scene(gravity=(0.0, 0.0, 0.0))
    speed = -OMEGA * (1.0 - creepage)
    at = (0.0, 0.0, 0.1)
    lower = scene.add_body(body, name="lower", angular_velocity=(0.0, OMEGA, 0.0))
    upper = scene.add_body(body, name="upper", position=at, angular_velocity=(0.0, speed, 0.0))
    carriage = scene.add_rigid_body(1.0, (1e-3, 1e-3, 1e-3), name="carriage", position=at)
    first = scene.add(wf.joints.Revolute(scene.ground, lower["bore"], axis=(0, 1, 0), name="first"))
    second = scene.add(wf.joints.Revolute(carriage.at((0, 0, 0)), upper["bore"], axis=(0, 1, 0), name="second"))
    scene.add(wf.joints.Prismatic(scene.ground, carriage.at((0, 0, 0)), axis=(0, 0, 1), name="guide"))
    scene.add(wf.forces.PointForce(carriage.at((0, 0, 0)), (0.0, 0.0, -load)))
    scene.add(wf.joints.Drive(first, OMEGA, quantity="velocity"))
    scene.add(wf.joints.Drive(second, speed, quantity="velocity"))
    scene.add(wf.Contact(lower["rim"], upper["rim"], friction=friction, name="pair"))
    return scene


def run(scene: wf.Scene, steps: int, **options) -> wf.Result:
    result = wf.simulate(
        scene, steps * options.get("step", STEP), progress=False,
        **{"start": "equilibrium", "step": STEP, **options},
    )  # fmt: skip
    assert result.status == "completed", result.message
    return result


def rubbing(result: wf.Result) -> FrictionHistory:
    """Friction of the pair of a run."""
    found = result.history.contacts["pair"].friction
    assert found is not None
    return found


def bounding(body, pressure: np.ndarray) -> np.ndarray:
    """Half the way from the coefficients (columns, rows) of the nodes to the means of the nodes over the cells, in each
    direction: the means by sampling."""
    z = body.contact_surfaces["rim"].grid.z
    edges = np.concatenate([z[:1], 0.5 * (z[1:] + z[:-1]), z[-1:]])
    places = np.arange(len(pressure), dtype=float)
    found = pressure.copy()
    for k, (low, high) in enumerate(pairwise(edges)):
        t = low + (high - low) * (np.arange(SAMPLES) + 0.5) / SAMPLES
        found[:, k] += 0.5 * (np.mean([np.interp(t, z, row) for row in pressure], axis=1) - pressure[:, k])
    for j in range(len(pressure)):
        x = j - 0.5 + (np.arange(SAMPLES) + 0.5) / SAMPLES
        for k in range(len(z)):
            found[j, k] += 0.5 * (np.interp(x, places, pressure[:, k]).mean() - pressure[j, k])
    return found


def test_gross_sliding_transmits_the_coefficient_times_the_load(body) -> None:
    result = run(rollers(body, MU, 0.2), 20)
    contact = result.history.contacts["pair"]
    friction = rubbing(result)
    normal, across, along = -contact.force[-1, 2], contact.force[-1, 0], contact.force[-1, 1]
    assert across == pytest.approx(-MU * normal, rel=SECOND_ORDER)  # the faster lower surface is held back
    assert abs(along) < 1e-3 * MU * normal  # Poisson's sliding along the axis is antisymmetric
    touching = friction.state[-1] > 0
    assert touching.sum() >= contact.active_nodes[-1] and np.all(friction.state[-1][touching] == 2)
    # the bores are driven, the bodies behind them swing a little
    assert friction.creep_velocity[-1, 0] == pytest.approx(0.2 * OMEGA * 0.05, rel=0.02)
    assert friction.rolling_velocity[-1] == pytest.approx(0.9 * OMEGA * 0.05, rel=0.02)
    assert friction.power[-1] == pytest.approx(MU * normal * 0.2 * OMEGA * 0.05, rel=0.02)


def test_rolling_without_creep_sticks_and_transmits_nothing(body) -> None:
    result = run(rollers(body, MU, 0.0), 20)
    contact = result.history.contacts["pair"]
    assert np.all(np.abs(contact.force[1:, 0]) < 1e-3 * MU * LOAD)  # the grids are not mirror images: ripple
    inner = rubbing(result).state[-1][contact.pressure[-1] > 0.5 * contact.pressure[-1].max()]
    assert np.all(inner == 1)


def test_friction_takes_energy_in_every_step(body) -> None:
    for creepage in (8e-3, 0.05):
        result = run(rollers(body, MU, creepage), 30)
        work = np.diff(result.energy["friction"])
        scale = MU * LOAD * STEP * OMEGA * 0.05 * creepage
        assert np.all(work < CONVERGED * scale)
        assert result.energy["friction"][-1] < -0.01 * scale
        assert np.all(rubbing(result).power > -CONVERGED * scale / STEP)


def test_tractions_stay_within_the_bounds_and_against_the_slip(body) -> None:
    result = run(rollers(body, MU, 8e-3), 40)
    contact = result.history.contacts["pair"]
    friction = rubbing(result)
    bound = MU * bounding(body, contact.pressure[-1])
    size = np.linalg.norm(friction.traction[-1], axis=0)
    assert np.all(size <= bound * (1.0 + 1e-9))
    sliding = friction.state[-1] == 2
    assert sliding.any() and (friction.state[-1] == 1).any()
    np.testing.assert_allclose(size[sliding], bound[sliding], rtol=1e-9)
    opposite = np.sum(friction.traction[-1] * friction.slip_velocity[-1], axis=0)
    assert np.all(opposite <= 1e-9 * size.max() * OMEGA * 0.05)
    across = friction.traction[-1, 0] * friction.slip_velocity[-1, 1]
    np.testing.assert_allclose(  # parallel to the slip, where there is any to speak of
        across[sliding], (friction.traction[-1, 1] * friction.slip_velocity[-1, 0])[sliding],
        atol=1e-6 * size.max() * np.abs(friction.slip_velocity[-1]).max(),
    )  # fmt: skip


SPEEDS: dict[str, Any] = {  # slip in this patch is up to 5 mm/s
    "falls": wf.laws.Stribeck(0.4, 0.2, 0.2, exponent=1.0),
    "rises": wf.laws.TabulatedFriction((0.0, 0.01, 0.02), (0.1, 0.3, 0.5)),
    "rises late": wf.laws.TabulatedFriction((0.0, 0.001, 0.002), (0.3, 0.3, 0.5)),
}


@pytest.mark.parametrize("name", list(SPEEDS))
def test_a_coefficient_of_the_slip_speed_in_every_cell(body, name: str) -> None:
    """|tau| = mu(|w|) p where a cell slides, w its slip velocity with all deformation, and no more than mu(0) p else;
    also where the bound rises steeply, and from a kink on."""
    law = SPEEDS[name]
    result = run(rollers(body, law, 8e-3), 40)
    contact, friction = result.history.contacts["pair"], rubbing(result)
    pressure = bounding(body, contact.pressure[-1])
    size, speed = (np.linalg.norm(x[-1], axis=0) for x in (friction.traction, friction.slip_velocity))
    slides, sticks = friction.state[-1] == 2, friction.state[-1] == 1
    np.testing.assert_allclose(size[slides], (law.coefficient_at(speed) * pressure)[slides], rtol=CONVERGED)
    assert np.all(size[sticks] <= law.static_coefficient * pressure[sticks] * (1.0 + CONVERGED))
    assert slides.any() and sticks.any() and speed[slides].max() > 7e-4
    assert np.all(np.diff(result.energy["friction"]) <= 0.0)


def test_the_regularised_law_is_viscous_below_its_velocity(body) -> None:
    """tau = -mu p w/v in every cell, w the slip velocity with all deformation."""
    speed = 1e3
    result = run(rollers(body, wf.laws.RegularisedCoulomb(MU, speed), 0.2), 20)
    contact = result.history.contacts["pair"]
    friction = rubbing(result)
    bound = MU * bounding(body, contact.pressure[-1])
    expected = -bound * friction.slip_velocity[-1] / speed
    np.testing.assert_allclose(friction.traction[-1], expected, rtol=LATE, atol=1e-8 * np.abs(expected).max())
    assert np.abs(expected).max() > 0.0 and not np.any(friction.state == 2)


def test_the_regularised_law_tends_to_coulomb(body) -> None:
    creepage = 4e-3
    exact = run(rollers(body, MU, creepage), 25).history.contacts["pair"].force[-1, 0]
    speeds = (1e-3, 1e-4, 1e-5)  # m/s compared with a creep of 2 mm/s
    errors = []
    for speed in speeds:
        law = wf.laws.RegularisedCoulomb(MU, speed)
        errors.append(abs(run(rollers(body, law, creepage), 25).history.contacts["pair"].force[-1, 0] / exact - 1.0))
    assert errors[0] > errors[1] > errors[2] and errors[2] < 1e-2


@pytest.mark.parametrize("law", [MU, wf.laws.RegularisedCoulomb(MU, 1e-3)], ids=["Coulomb", "regularised"])
def test_a_pair_that_hardly_carries_does_not_hold_up_one_that_does(body, law) -> None:
    """Next to a loaded pair, one with a millionth of its load: slips have round-off, which is a part of its bound that
    no iteration takes away. The loaded pair is the one alone, and no step is halved."""
    alone, both = rollers(body, law, 0.002), rollers(body, law, 0.002)
    for name, source in (("lower 2", "lower"), ("upper 2", "upper")):
        of = both.body(source)
        both.add_body(body, name=name, position=of.position + [0, 1, 0], angular_velocity=of.angular_velocity)
    slide = both.add_rigid_body(1.0, (1e-3, 1e-3, 1e-3), name="slide", position=(0, 1, 0.1))
    for axle, (a, b) in {
        "third": (both.ground, both.body("lower 2")["bore"]),
        "fourth": (slide.at((0, 0, 0)), both.body("upper 2")["bore"]),
    }.items():
        joint = both.add(wf.joints.Revolute(a, b, axis=(0, 1, 0), name=axle))
        both.add(wf.joints.Drive(joint, OMEGA if axle == "third" else -OMEGA * 0.998, quantity="velocity"))
    both.add(wf.joints.Prismatic(both.ground, slide.at((0, 0, 0)), axis=(0, 0, 1), name="guide 2"))
    both.add(wf.forces.PointForce(slide.at((0, 0, 0)), (0.0, 0.0, -1e-6 * LOAD)))
    both.add(wf.Contact(both.body("lower 2")["rim"], both.body("upper 2")["rim"], friction=law, name="idle"))
    expected, found = run(alone, 6), run(both, 6)
    assert found.history.counters["rejected_steps"] == 0
    forces = [r.contact("pair").friction.tangential_force for r in (expected, found)]
    np.testing.assert_allclose(forces[1], forces[0], atol=1e-4 * MU * LOAD)


def test_action_equals_reaction_with_friction(body) -> None:
    contact = run(rollers(body, MU, 0.02), 20).history.contacts["pair"]
    size = np.linalg.norm(contact.force, axis=1).max()
    np.testing.assert_allclose(contact.force, -contact.force_second, atol=1e-10 * size, rtol=0.0)


def test_momentum_of_two_free_rollers_that_collide_spinning(body) -> None:
    scene = wf.Scene(gravity=(0.0, 0.0, 0.0))
    first = scene.add_body(body, name="first", angular_velocity=(0.0, 200.0, 0.0))
    second = scene.add_body(body, name="second", position=(0.0, 0.0, 0.1 + 5e-6), velocity=(0.0, 0.0, -0.5))
    scene.add(wf.Contact(first["rim"], second["rim"], friction=MU, name="pair"))
    result = run(scene, 60, step=2e-6, start="initial")
    assert np.abs(result.history.contacts["pair"].force).max() > 1e3
    mass = body.mass
    bodies = result.history.bodies
    p = mass * (bodies["first"].velocity + bodies["second"].velocity)
    assert np.abs(p - p[0]).max() < 1e-10 * mass * 0.5
    assert abs(bodies["second"].angular_velocity[-1, 1]) > 0.1  # friction has set it turning
    assert abs(bodies["second"].velocity[-1, 0]) > 1e-3
    assert np.all(np.diff(result.energy["friction"]) <= 1e-12)


def test_a_run_with_friction_is_continued_bit_for_bit(body) -> None:
    scene = rollers(body, MU, 4e-3)
    whole = run(scene, 12)
    half = run(scene, 6)
    rest = run(scene, 6, start=half)
    np.testing.assert_array_equal(rubbing(rest).traction[-1], rubbing(whole).traction[-1])
    np.testing.assert_array_equal(rest.history.contacts["pair"].force[-1], whole.history.contacts["pair"].force[-1])


def test_friction_needs_tangential_modes() -> None:
    mesh = wf.mesh.roller(0.05, 0.015, 0.01, sectors=48, layers=2, axial=1, grading=1.5, order=1)
    plain = wf.reduce(
        mesh, wf.Material(210e9, 0.3, 7850.0), interfaces={"bore": "rigid"}, contact={"rim": wf.surfaces.Cylinder()},
        modes=0, cache=False, progress=False,
    )  # fmt: skip
    scene = wf.Scene()
    a, b = scene.add_body(plain, name="a"), scene.add_body(plain, name="b", position=(0.0, 0.0, 0.1))
    with pytest.raises(InputError, match="tangential=True"):
        wf.Contact(a["rim"], b["rim"], friction=0.1)
    with pytest.raises(InputError, match="friction"):
        wf.Contact(a["rim"], b["rim"], friction=-0.1)


def test_friction_with_dynamic_local_modes_is_refused() -> None:
    """Also where only bodies that do not rub have any: an impulsive step is one of the whole scene."""
    mesh = wf.mesh.roller(0.05, 0.015, 0.01, sectors=48, layers=2, axial=1, grading=1.5, order=1)
    soft, stiff = (
        wf.reduce(
            mesh, wf.Material(E, 0.3, 7850.0), interfaces={"bore": "rigid"}, contact={"rim": wf.surfaces.Cylinder()},
            modes=0, grid=wf.ContactGrid(tangential=True, contact_fixed=False),
            options=wf.ReductionOptions(local_dynamics=True), cache=False, progress=False,
        )
        for E in (210e9, 2100e9)
    )  # fmt: skip
    with pytest.raises(InputError, match="local_modes='quasi_static'"):
        wf.simulate(rollers(soft, 0.1, 0.0), STEP, step=STEP, options=wf.RunOptions(local_modes="hht"), progress=False)
    between = 2.0 * dynamic_modes(soft.contact_surfaces["rim"]).omega[0] / (2.0 * np.pi)  # Hz: below all of the stiff
    scene = rollers(stiff, 0.1, 0.0)
    pair = [scene.add_body(soft, name=name, position=(1.0, 0.0, z)) for name, z in (("c", 0.0), ("d", 0.1))]
    scene.add(wf.Contact(pair[0]["rim"], pair[1]["rim"], name="smooth"))
    with pytest.raises(InputError, match="'pair': friction needs quasi-static local modes in the whole scene"):
        local = wf.LocalModes("hht", max_frequency=between)
        wf.simulate(scene, STEP, step=STEP, options=wf.RunOptions(local_modes=local), progress=False)


def test_a_run_says_that_friction_does_not_act_in_the_equilibrium(body) -> None:
    result = run(rollers(body, MU, 0.0), 1)
    assert any("friction of 'pair' does not act in the equilibrium" in note for note in result.history.notes)


# --- gross slip of a wide patch ---

SOFT = wf.Material(5e6, 0.3, 1100.0)
WIDE = 0.6  # coefficient of friction
EXACT, TURNED = 5e-4, 0.02  # of mu N, and degrees between friction and what it should be perpendicular to


@pytest.fixture(scope="module")
def soft_roller():
    mesh = wf.mesh.roller(0.05, 0.02, 0.02, sectors=240, layers=6, axial=1, order=1)
    return wf.reduce(
        mesh,
        SOFT,
        interfaces={"bore": "rigid"},
        contact={"rim": wf.surfaces.Cylinder()},
        modes=0,
        grid=wf.ContactGrid(tangential=True, contact_fixed=False),
        cache=False,
        progress=False,
    )


@pytest.mark.parametrize("partner", ["plane", "rigid roller", "soft roller"])
def test_gross_slip_of_a_wide_patch_transmits_mu_times_the_load(soft_roller, partner: str) -> None:
    """Half-widths of 0.06 to 0.09 R, moved aside by friction: the force is N sqrt(1 + mu^2) all the same, on a plane
    rotated from its normal by arctan mu. (Of rollers it also turns with the line between rims that give way sideways;
    pressure along the normals of a rigid roller sums to less than the load, by a half-width^2 / 10 R^2.)"""
    R, press, speed = 0.05, 6e-4, 4.0
    scene = wf.Scene()
    if partner == "plane":
        second = scene.ground.surface(wf.surfaces.Plane(origin=(0.0, 0.0, -R), outward=(0.0, 0.0, 1.0)), name="ground")
    elif partner == "rigid roller":
        form = wf.surfaces.Cylinder(axis_point=(0.0, 0.0, -2.0 * R), axis_direction=(0.0, 1.0, 0.0), radius=R)
        second = scene.ground.surface(form, name="ground")
    else:
        below = scene.add_body(soft_roller, name="below", position=(0.0, 0.0, -2.0 * R))
        scene.add(wf.joints.Fixed(scene.ground.at((0.0, 0.0, -2.0 * R)), below["bore"]))
        second, press = below["rim"], 2.0 * press
    spin = (0.0, speed, 0.0)
    turning = scene.add_body(soft_roller, name="roller", position=(0.0, 0.0, -press), angular_velocity=spin)
    axle = scene.add(wf.joints.Revolute(scene.ground.at((0.0, 0.0, -press)), turning["bore"], axis=(0.0, 1.0, 0.0)))
    scene.add(wf.joints.Drive(axle, speed, quantity="velocity"))
    scene.add(wf.Contact(turning["rim"], second, friction=WIDE, name="pair", overlap=3e-3))
    result = wf.simulate(scene, 0.02, step=1e-3, progress=False)
    assert result.status == "completed", result.message
    contact = result.contact("pair")
    width = contact.half_width[-1] / R
    assert width > (0.055 if partner == "rigid roller" else 0.085)
    short = 0.1 * width**2 if partner == "rigid roller" else 0.0
    expected = np.hypot(1.0, WIDE) * contact.normal_load[-1] * (1.0 - short)
    assert np.linalg.norm(contact.force[-1]) == pytest.approx(expected, rel=EXACT)
    if partner == "plane":
        across, _, normal = np.abs(contact.force[-1])
        assert across == pytest.approx(WIDE * normal, rel=EXACT)
        assert np.degrees(np.arctan2(across, normal) - np.arctan(WIDE)) == pytest.approx(0.0, abs=TURNED)
