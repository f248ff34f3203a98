"""Helical gears in mesh on half-spaces: forces, pressures along the inclined line of contact, transmission error."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
import pytest

import warpffrf as wf
from scenes.gears import about_y, angle_at, half_space, helical, on_shafts
from warpffrf.model.errors import InputError
from warpffrf.output.recording.frames import _local_frame, relief

ROUNDED: Any = {"tip_rounding": 0.2e-3}
RELIEVED: Any = {"tip_rounding": 0.2e-3, "tip_relief": 25e-6, "tip_relief_length": 3e-3}
FEW = (9, 15)  # cells
LIGHT, LOADED = 0.5, 200.0  # N m: flanks approach by 30 nm, and by 10 um
SMALL = replace(helical(18.0, **ROUNDED).gear_1, profile_shift=0.4, tip_diameter=None)
RING = wf.gears.Gear(
    4e-3, 60, internal=True, profile_shift=-0.4, root_radius=0.25, tip_diameter=0.248, helix_angle=SMALL.helix_angle,
    thickness_allowance=-50e-6, tip_rounding=0.2e-3,
)  # fmt: skip
INSIDE = wf.gears.GearPair(SMALL, RING, 0.5 * (RING.reference_diameter - SMALL.reference_diameter) - 90e-6)


@cache
def pressed(pair: wf.gears.GearPair, g: float, torque: float, flank: str = "right", **options: Any) -> wf.Result:
    """Equilibrium where tooth 1 of gear 1 touches at g [m] in the middle of the width."""
    result = wf.equilibrium(on_shafts(pair, angle_at(pair, g, flank), torque, flank=flank, **options), progress=False)
    assert result.status == "completed", result.message
    return result


def reversed_pair(pair: wf.gears.GearPair) -> wf.gears.GearPair:
    return wf.gears.GearPair(pair.gear_2, pair.gear_1, pair.center_distance)


PAIRS = {
    "right hand": (helical(20.0, **ROUNDED), "right"),
    "left hand": (helical(-20.0, **ROUNDED), "left"),
    "wheel drives": (reversed_pair(helical(20.0, **ROUNDED)), "left"),
    "wheel drives, left hand": (reversed_pair(helical(-20.0, **ROUNDED)), "right"),
    "internal": (INSIDE, "right"),
}


@pytest.mark.parametrize("name", list(PAIRS))
def test_forces_of_gears_that_hardly_deform(name: str) -> None:
    """F_bn = T/(r_b cos beta_b) in all, torques as the teeth, the axial force F_t tan beta in the direction of hand and
    flank, the moment about the other axes that of these forces."""
    pair, flank = PAIRS[name]
    s, one = (1.0 if flank == "right" else -1.0), pair.gear_1
    for g in (-3e-3, 2e-3) if pair.side > 0 else (-1e-3, 1e-3):
        result = pressed(pair, g, LIGHT, flank, width=20e-3, cells=FEW)
        gear = result.gear("mesh")
        contacts = [result.contact(name) for name in gear.contacts]
        assert np.count_nonzero(gear.load) > 1
        assert gear.load.sum() == pytest.approx(LIGHT / (one.base_radius * np.cos(one.base_helix_angle)), rel=1e-6)
        force, torque, other = np.sum([(c.force[0], c.torque[0], c.history.torque_second[0]) for c in contacts], axis=0)
        assert torque[1] == pytest.approx(s * LIGHT, rel=1e-9)
        assert other[1] == pytest.approx(pair.side * torque[1] * pair.gear_2.teeth / one.teeth, rel=1e-6)
        tangential = 2.0 * LIGHT / pair.working_diameters[0]
        lead = np.pi * pair.working_diameters[0] * one.twist / (2.0 * np.pi)  # tan beta on the working pitch circle
        assert force[1] == pytest.approx(-s * tangential * lead, rel=1e-6)
        assert np.hypot(force[0], force[2]) == pytest.approx(LIGHT / one.base_radius, rel=1e-6)
        apart = np.array([pair.center_distance, 0.0, 0.0])
        assert other == pytest.approx(-torque + np.cross(apart, force), abs=1e-6 * LIGHT)  # about either centre


def test_a_mirrored_pair_is_the_same() -> None:
    """Mirrored at the plane of both axes a right hand is a left one, and right flanks are left ones; at the middle
    section hands change alone."""
    loads = []
    for degrees, flank in ((20.0, "right"), (-20.0, "left"), (-20.0, "right")):
        gear = pressed(helical(degrees, **RELIEVED), 3e-3, LOADED, flank, width=20e-3, cells=FEW).gear("mesh")
        loads.append((np.sort(gear.load[0]), gear.transmission_error[0], np.sort(gear.peak_pressure[0])))
    for other in loads[1:]:
        for value, known in zip(other, loads[0], strict=True):
            assert value == pytest.approx(known, rel=1e-7)


def test_pressures_at_the_pitch_point_of_wide_gears() -> None:
    """Those of Hertz under the line load of each row, of cylinders with the radii of the normal section; the line loads
    along the line of contact, 1/cos beta_b as long as the width, are the force."""
    pair, width = helical(20.0, **RELIEVED), 30e-3
    result = pressed(pair, 0.0, 2.0 * LOADED, width=width)
    gear = result.gear("mesh")
    name = gear.contacts[gear.teeth.index(next(t for t in gear.teeth if t[1] == 1))]
    contact = result.contact(name)
    cells, pressure = contact.history.cells, contact.mean_pressure[0]
    line = pressure.sum(axis=0) * 2.0 * cells.half_width[0] / len(pressure)
    z = cells.z[0]
    place = -np.tan(pair.base_helix_angle) * z
    rho_1, rho_2 = pair.curvature_radii(place)
    rho = rho_1 * rho_2 / (rho_1 + rho_2) / np.cos(pair.base_helix_angle)
    known = np.sqrt(line * contact.effective_modulus / (np.pi * rho))
    inner = np.abs(z) < 0.3 * width
    assert inner.sum() >= 5
    assert pressure.max(axis=0)[inner] == pytest.approx(known[inner], rel=0.01)
    middle = int(np.argmin(np.abs(z)))
    one_pair = pair.hertz(float(line[middle]) * width * pair.gear_1.base_radius, width)[0]
    assert pressure[:, middle].max() == pytest.approx(one_pair, rel=0.01)
    total = float(np.sum(line * cells.length[0])) / np.cos(pair.base_helix_angle)
    assert total == pytest.approx(contact.normal_load[0], rel=1e-6)
    assert np.linalg.norm(contact.force[0]) == pytest.approx(contact.normal_load[0], rel=3e-5)  # but for reliefs
    # the line of contact on the flank: rows are centred on it
    shape, grid = contact.view.first.shape, contact.view.first.grid
    at = shape.point(grid.theta_start + grid.pitch * (cells.column[0] + cells.row_shift[0]), z)
    reach = np.sqrt(at[:, 0] ** 2 + at[:, 2] ** 2 - pair.gear_1.base_radius**2) - pair.pitch_rho[0]
    assert reach[inner] == pytest.approx(place[inner], abs=2e-5)  # the gears have approached


STEPS = 12


@cache
def cycle(degrees: float, torque: float) -> wf.Result:
    pair = helical(degrees, **(RELIEVED if torque > LIGHT else ROUNDED))
    pitch = 2.0 * np.pi / pair.gear_1.teeth
    scene = on_shafts(
        pair, 0.05, torque, moved=pitch * 20 / 30, rotation=(-1.1 * pitch, 0.0), width=20e-3, cells=FEW
    )  # fmt: skip
    result = wf.static(scene, 1.0, step=1.0 / STEPS, progress=False)
    assert result.status == "completed", result.message
    return result


def test_transmission_errors() -> None:
    """Of a pitch: without load the ratio of the speeds is constant, with load the helical pair's error varies less than
    the spur pair's."""
    light = cycle(20.0, 0.02 * LIGHT).gear("mesh")
    one, two = np.unwrap(light.angle), np.unwrap(light._angle(1))
    assert np.diff(two) == pytest.approx(-np.diff(one) * 20 / 30, rel=1e-6)
    spur, other = (cycle(degrees, 0.5 * LOADED).gear("mesh") for degrees in (0.0, 20.0))
    assert 0.0 < np.ptp(other.transmission_error) < 0.7 * np.ptp(spur.transmission_error)
    assert not len(other.open_intervals())


def test_what_happens_on_the_flanks() -> None:
    """The map has places of their own over the width; the points of contact lie on the line of action, in their
    sections; a pair of teeth is in mesh before and after it is in the middle section."""
    gear = cycle(20.0, 0.5 * LOADED).gear("mesh")
    pair, found = gear.pair, gear.flank_map(speed=100.0)
    slope = np.diff(found.place, axis=1) / np.diff(found.width, axis=1)
    assert slope == pytest.approx(np.full(slope.shape, -np.tan(pair.base_helix_angle)))
    assert found.sliding == pytest.approx(100.0 * found.place * (1.0 + 20 / 30))
    assert found.wear_index.shape == found.pressure.shape == found.roll_angle.shape
    inner = (found.place > pair.path["A"] + 3.2e-3) & (found.place < pair.path["E"] - 3.2e-3)
    assert np.all(found.pressure[inner & (np.abs(found.width) < 8e-3)] > 0.0)
    beyond = (found.place < pair.path["A"] - 1e-4) | (found.place > pair.path["E"] + 1e-4)
    assert beyond.any() and not np.any(found.pressure[beyond])
    path = gear.contact_path(nearest=True)
    center = np.stack([gear.result.contact(name).moments.center[:, 1] for name in gear.contacts], axis=1)
    at = gear.place - np.tan(pair.base_helix_angle) * center
    flat = (gear.load > 0.0) & (at > pair.path["A"] + 3.5e-3) & (at < pair.path["E"] - 3.5e-3)
    assert flat.sum() > 8
    assert path.place[..., 0][flat] == pytest.approx(at[flat], abs=1.5e-5)  # straight from row to row
    assert path.offset[flat] == pytest.approx(0.0, abs=6e-6)
    middle = (gear.place >= pair.path["A"]) & (gear.place <= pair.path["E"])
    assert np.all(gear.within[middle]) and np.any((gear.load > 0.0) & ~middle) and np.all(gear.within[gear.load > 0.0])
    with pytest.raises(InputError, match="load varies along lines of contact of helical gears"):
        gear.film_thickness(wf.oils.Roelands(0.015, coefficient=2e-8), speed=100.0)


def test_drawn_pressures_lie_on_the_line_of_contact() -> None:
    """Of recordings: the relief of the pressure stands on the flank, at the places on the path of contact."""
    result = pressed(helical(20.0, **RELIEVED), 0.0, LOADED, width=20e-3, cells=FEW)
    gear = result.gear("mesh")
    contact = result.contact(gear.contacts[int(np.argmax(gear.load[0]))])
    flat = relief(contact, 0, 1.0, 0.0).reshape(-1, 3)
    origin, axes = _local_frame(contact, 0)
    points = origin + flat @ axes
    assert np.abs(contact.view.first.shape.chart(points)[2]).max() < 1e-12
    r = np.hypot(points[:, 0], points[:, 2])
    g = np.sqrt(r**2 - gear.pair.gear_1.base_radius**2) - gear.pair.pitch_rho[0]
    assert np.abs(g + np.tan(gear.pair.base_helix_angle) * points[:, 1]).max() < 1e-3  # some half-widths


def test_teeth_that_meet_in_any_section() -> None:
    """By brute force over sections: the pairs of teeth that touch anywhere on the width have a contact."""
    pair, width = helical(25.0, **ROUNDED), 40e-3
    scene = on_shafts(pair, 0.07, LIGHT, width=width)
    (mesh,) = scene.gears
    one, two = (hub.body for hub in mesh.hubs)
    first, second = pair.gear_1.surfaces(("right",)), pair.gear_2.surfaces(("right",))
    found = set()
    for k, name in enumerate(first, 1):
        shape: Any = first[name]
        u, z = np.meshgrid(np.linspace(0.0, shape.curve.length, 200), np.linspace(-0.5 * width, 0.5 * width, 41))
        world = one.to_world(shape.point(u, z))
        if np.linalg.norm(world - two.position, axis=-1).min() > 0.5 * pair.gear_2.tip_diameter:
            continue
        at = two.to_user(world)
        for t, other in enumerate(second.values(), 1):
            if np.min(other.gap(at)) < 1e-7:
                found.add(("right", k, t))
    assert len(found) > 2 and found <= set(mesh.contacts)


def test_what_is_refused() -> None:
    pair = helical(20.0)
    scene = wf.Scene()
    rigid = [
        scene.add_rigid_body(1.0, (1e-3,) * 3, name=f"r{i}", surfaces=gear.surfaces(("right",)), rotation=about_y(0.1))
        for i, gear in enumerate((pair.gear_1, pair.gear_2))
    ]
    with pytest.raises(InputError, match="one of two helical gears must be elastic; use wf.half_space_body"):
        scene.add_gear_pair(rigid[0].at((0, 0, 0)), rigid[1].at((0, 0, 0)), pair, name="m")


def test_friction_of_gears_that_rotate() -> None:
    """Its power is mu p v_g over the flanks, v_g of each section, but for cells about the pitch point that do not slide
    all over; energy is kept. Wear differs over the width."""
    pair, speed, mu, turn = helical(20.0, **RELIEVED), 20.0, 0.05, 0.1
    scene = wf.Scene()
    bodies = []
    for gear, name, w, angle in (
        (pair.gear_1, "pinion", -speed, angle_at(pair, -4e-3)), (pair.gear_2, "wheel", speed * 20 / 30, 0.0)
    ):  # fmt: skip
        options: Any = {"rotation": about_y(angle), "angular_velocity": (0, w, 0)}
        bodies.append(scene.add_body(half_space(gear, ("right",), 20e-3), name=name, **options)["center"])
    place: Any = {"direction": (1, 0, 0), "rotation": (-turn, 0.0), "cells": FEW, "friction": mu}
    scene.add_gear_pair(bodies[0], bodies[1], pair, name="mesh", **place)
    shafts = [scene.add(wf.joints.Revolute(scene.ground, body, axis=(0, 1, 0))) for body in bodies]
    scene.add(wf.joints.Drive(shafts[1], speed * 20 / 30, quantity="velocity"))
    scene.add(wf.forces.PointTorque(bodies[0], (0.0, -0.5 * LOADED, 0.0)))
    result = wf.simulate(scene, turn / speed, step=turn / speed / 30, start="equilibrium", progress=False)
    assert result.status == "completed", result.message
    gear = result.gear("mesh")
    contacts = [result.contact(name) for name in gear.contacts]
    power = np.sum([contact.friction.power for contact in contacts], axis=0)
    known = np.zeros(len(result.time))
    found = gear.flank_map()
    for row, teeth, sliding in zip(found.step, found.teeth, found.sliding, strict=True):
        forces = contacts[teeth].mean_pressure[row].sum(axis=0) * contacts[teeth].cell_areas[row]
        known[row] += mu * float(np.abs(sliding) @ forces)
    assert power[5:] == pytest.approx(known[5:], rel=0.05)
    assert power[5:].mean() == pytest.approx(known[5:].mean(), rel=0.02)  # flanks approach and part, too
    assert np.abs(result.energy_residual).max() < 1e-5
    with pytest.raises(InputError, match="wear of helical surfaces is not supported"):
        contacts[int(np.argmax(gear.load[-1]))].wear(1e-15)


def test_the_transmission_error_with_axial_play() -> None:
    """A pinion that gives way along its axis lags more, in rotation; the error is still the approach of the flanks over
    cos beta_b."""
    pair, stiffness = helical(20.0, **RELIEVED), 5e7  # N/m
    scene = on_shafts(pair, angle_at(pair, 0.0), LOADED, cells=FEW)
    scene.joints.clear()
    one, two = scene.bodies
    scene.add(wf.joints.Cylindrical(scene.ground, one["center"], axis=(0, 1, 0)))
    scene.add(wf.joints.Fixed(scene.ground, two["center"]))
    scene.add(wf.forces.Bushing(scene.ground, one["center"], (0.0, stiffness, 0.0, 0.0, 0.0, 0.0)))
    result = wf.equilibrium(scene, progress=False)
    assert result.status == "completed", result.message
    gear = result.gear("mesh")
    contact = result.contact(gear.contacts[int(np.argmax(gear.load[0]))])
    moved = float(result.history.bodies["pinion"].position[0, 1])
    assert moved == pytest.approx(contact.force[0, 1] / stiffness, rel=1e-6) and abs(moved) > 2e-5
    error = gear.transmission_error[0] * np.cos(pair.base_helix_angle)
    assert error == pytest.approx(-contact.approach[0], rel=2e-3)
    assert gear.stiffness[0] == pytest.approx(gear.load.sum() / contact.approach[0], rel=2e-3)
