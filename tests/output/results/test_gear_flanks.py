"""Gear pairs of runs on half-spaces: relief as transmission error, orders, line of action, sliding, films, lift-off."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import warpffrf as wf
from scenes.gears import CYCLE_TORQUE, FZG, RELIEVED, WIDTH, about_y, angle_at, cycle, half_space, on_shafts, rolling
from warpffrf.model.bearings.lubrication import film_of_lines
from warpffrf.model.gears.tooth import relief
from warpffrf.output.gears.gear_result import GearResult
from warpffrf.output.gears.orders import mesh_orders

PITCH = 2.0 * np.pi / 16  # rad of the pinion
SPEED = 150.0  # rad/s
# m: flanks as curves are exact to 2e-11, their normals over pieces of some 0.2 mm to 6e-7 rad, at a radius of 10 mm
ON_LINE = 6e-9
SLIGHT = {"tip_relief": 10e-6, "tip_relief_length": 4.5e-3, "tip_relief_shape": "parabolic"}
# m: slopes C' of a relief incline the normal, which shortens it by C'^2 rho/2; and the approach under 0.2 N m
SECOND_ORDER = 0.06e-6


def off_relief(gear: GearResult) -> np.ndarray:
    """Where (T, n) a pair of teeth carries on involutes that have no relief."""
    length = RELIEVED.gear_1.tip_relief_length
    low, high = RELIEVED.path["A"] + length, RELIEVED.path["E"] - length
    return (gear.load > 0.0) & (gear.place > low) & (gear.place < high)


@pytest.mark.parametrize("place", [0.05, 0.4, 0.5])
def test_a_known_relief_without_load(place: float) -> None:
    """Flanks that hardly press lag by the least sum of both reliefs of a pair of teeth; involutes do not lag."""
    tips: Any = SLIGHT
    slight = replace(
        FZG, gear_1=replace(FZG.gear_1, tip_rounding=0.2e-3, **tips),
        gear_2=replace(FZG.gear_2, tip_rounding=0.2e-3, **tips),
    )  # fmt: skip
    p = FZG.gear_1.base_pitch
    result = wf.equilibrium(on_shafts(slight, angle_at(slight, place * p), 0.2), progress=False)
    gear = result.gear("mesh")
    g = gear.place[0][(gear.place[0] > slight.path["A"]) & (gear.place[0] < slight.path["E"])]
    C = relief(slight.gear_1, slight.pitch_rho[0] + g)[0] + relief(slight.gear_2, slight.pitch_rho[1] - g)[0]
    assert gear.transmission_error[0] == pytest.approx(-C.min(), abs=SECOND_ORDER)
    if place == 0.5:
        assert C.min() > 10.0 * SECOND_ORDER
    plain = wf.equilibrium(on_shafts(FZG, angle_at(FZG, place * p), 0.2), progress=False).gear("mesh")
    assert plain.transmission_error[0] == pytest.approx(0.0, abs=SECOND_ORDER)


def signal(angle: np.ndarray) -> np.ndarray:
    x = 16.0 * angle
    return -9e-6 + 2e-6 * np.cos(x - 0.4) + 0.7e-6 * np.cos(2.0 * x + 1.1) + 0.1e-6 * np.cos(4.0 * x)


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_orders_of_a_known_signal(sign: float) -> None:
    """Amplitudes of a sum of cosines over unequal steps and a part of a pitch too many, which is left out."""
    turned = sign * PITCH * (3.4 * np.linspace(0.0, 1.0, 120) + 0.01 * np.sin(7.0 * np.linspace(0.0, 1.0, 120)))
    angle = np.remainder(3.0 + turned + np.pi, 2.0 * np.pi) - np.pi
    found = mesh_orders(np.linspace(0.0, 1.0, 120), angle, signal(angle), 16, 6)
    assert found.cycles == 3 and 0.0 < found.begin < 0.2 and not found.reason
    assert found.mean == pytest.approx(-9e-6, abs=1e-15)
    assert found.amplitude == pytest.approx(1e-6 * np.array([2.0, 0.7, 0.0, 0.1, 0.0, 0.0]), abs=1e-15)
    time = np.linspace(0.0, 1.0, 120)
    phi = turned - turned[np.searchsorted(time, found.begin)]
    waves = found.amplitude * np.cos(16.0 * np.outer(phi, found.order) - found.phase)
    assert (found.mean + waves.sum(axis=1))[time > found.begin] == pytest.approx(
        signal(angle)[time > found.begin], abs=1e-13
    )


def test_errors_of_orders_are_those_of_noise() -> None:
    """Over many draws the amplitudes scatter by the error that the fit states."""
    rng, angle = np.random.default_rng(1), PITCH * np.linspace(0.0, 4.0, 129)
    draws = [mesh_orders(angle, angle, signal(angle) + 0.05e-6 * rng.standard_normal(129), 16, 2) for _ in range(400)]
    scatter = np.std([draw.amplitude for draw in draws], axis=0)
    # order 4 is not fitted here: like noise it is left over, 0.1/sqrt(2) um, and known to be orthogonal
    expected = np.sqrt(2.0 / 128) * np.hypot(0.05e-6, 0.1e-6 / np.sqrt(2.0))
    assert np.mean([draw.error for draw in draws], axis=0) == pytest.approx(expected, rel=0.02)
    assert scatter == pytest.approx(np.sqrt(2.0 / 128) * 0.05e-6, rel=0.15)


def test_orders_that_cannot_be_computed() -> None:
    angle = PITCH * np.linspace(0.0, 0.9, 10)
    found = mesh_orders(angle, angle, signal(angle), 16, 3)
    assert found.cycles == 0 and np.all(np.isnan(found.amplitude)) and "0.9 pitches, less than one" in found.reason
    angle = PITCH * np.linspace(0.0, 1.0, 6)
    found = mesh_orders(angle, angle, signal(angle), 16, 4)
    assert np.isfinite(found.amplitude).tolist() == [True, True, False, False]  # five rows of a pitch
    assert np.all(np.isnan(found.error))  # as many coefficients
    with pytest.raises(wf.InputError, match="count"):
        mesh_orders(angle, angle, angle, 16, 0)


def test_involutes_touch_on_the_line_of_action() -> None:
    """At the place that the rotation gives, on both flanks; the centre of pressure within a hundredth of the patch."""
    gear = cycle().gear("mesh")
    where, found = off_relief(gear), gear.contact_path(nearest=True)
    assert np.count_nonzero(where) > 10
    assert found.offset[where] == pytest.approx(0.0, abs=ON_LINE)
    assert found.place[..., 0][where] == pytest.approx(gear.place[where], abs=1e-10)
    apart = found.place[..., 1] - found.place[..., 0]  # the approach of both teeth, which overlap
    total = np.broadcast_to(gear.transmission_error[:, None], where.shape)
    assert apart[where] == pytest.approx(total[where], abs=1e-10)
    pressed = gear.contact_path()
    widths = np.stack([cycle().contact(name).half_width for name in gear.contacts], axis=1)
    assert np.abs(pressed.offset[..., 0][where]).max() < 0.02 * widths[where].min()
    assert np.all(np.isnan(pressed.points[gear.load == 0.0]))
    relieved = (gear.load > 0.0) & ~where
    assert np.nanmax(np.abs(found.offset[relieved])) > 10e-6


def test_sliding_is_that_of_the_points_in_contact() -> None:
    """Velocities of both flanks at the contact, across the line of action: (w_1 + w_2) g, 0 at the pitch point."""
    gear = cycle().gear("mesh")
    where, path = off_relief(gear), gear.contact_path(nearest=True)
    alpha = RELIEVED.working_pressure_angle
    across = -np.array([np.cos(alpha), np.sin(alpha)])  # towards the axis of the pinion, which turns clockwise
    one = path.points[..., 0, :]
    two = one - [RELIEVED.center_distance, 0.0]
    velocity = [w * np.stack([-x[..., 1], x[..., 0]], axis=-1) for w, x in ((-SPEED, one), (SPEED * 16 / 24, two))]
    sliding = (velocity[0] - velocity[1]) @ across
    assert gear.sliding(SPEED)[where] == pytest.approx(sliding[where], abs=1e-5)  # 2e-9 m off the line, 20 nm/s
    assert gear.sliding(SPEED) == pytest.approx(SPEED * (1.0 + 16 / 24) * gear.place)
    assert not np.any(gear.sliding())  # load steps


def test_a_map_of_the_flank() -> None:
    gear = cycle().gear("mesh")
    found = gear.flank_map(speed=SPEED)
    assert len(found.step) == np.count_nonzero(gear.load) and np.all(np.diff(found.place, axis=0) >= 0.0)
    own = gear.peak_pressure[found.step, found.teeth]
    assert found.pressure.max(axis=1) == pytest.approx(own, rel=0.02)  # parabolas through the largest cell are higher
    assert np.abs(found.width).max() < 0.5 * WIDTH
    at = np.hypot(*np.moveaxis(gear.contact_path(nearest=True).points, -1, 0))[found.step, found.teeth, 0]
    flat = off_relief(gear)[found.step, found.teeth]
    assert found.radius[flat, 0, 0] == pytest.approx(at[flat], abs=1e-8)
    assert found.wear_index == pytest.approx(found.pressure * np.abs(found.sliding))
    assert len(gear.flank_map("right").step) == len(found.step)
    with pytest.raises(wf.InputError, match="flank 'left'"):
        gear.flank_map("left")


OIL = wf.oils.Roelands(0.015, coefficient=2e-8)


def test_films_at_the_pitch_point() -> None:
    """Both flanks move at w d_w/2 sin alpha_w; Dowson's line with the load over the width."""
    gear = wf.equilibrium(on_shafts(FZG, angle_at(FZG, 0.0), CYCLE_TORQUE), progress=False).gear("mesh")
    (i,) = np.flatnonzero(gear.load[0])
    found = gear.film_thickness(OIL, speed=SPEED, roughness=(0.3e-6, 0.4e-6))
    alpha, (d_1, d_2) = FZG.working_pressure_angle, FZG.working_diameters
    u, R = 0.5 * SPEED * d_1 * np.sin(alpha), 0.5 * np.sin(alpha) / (1.0 / d_1 + 1.0 / d_2)
    modulus = 0.5 * 206e9 / (1.0 - 0.3**2)
    line = CYCLE_TORQUE / FZG.gear_1.base_radius / WIDTH
    film = film_of_lines(OIL, speed=u, line_load=line, radius=R, modulus=modulus)
    assert found.minimum[0, i] == pytest.approx(film.minimum, rel=3e-3)  # cells end 0.4 % before the faces
    assert found.central[0, i] == pytest.approx(film.central, rel=3e-3)
    assert found.parameter[0, i] == pytest.approx(film.minimum / 0.5e-6, rel=3e-3)
    assert found.entrainment[0, i] == pytest.approx(u, rel=1e-3)
    warm = gear.film_thickness(OIL, speed=SPEED, thinning=0.04)
    assert warm.minimum[0, i] < found.minimum[0, i] and np.isnan(warm.parameter[0, i])
    assert np.all(np.isnan(np.delete(found.minimum[0], i)))
    with pytest.raises(wf.InputError, match="viscosity rises with pressure"):
        gear.film_thickness(wf.oils.Newtonian(0.01), speed=SPEED)
    with pytest.raises(wf.InputError, match="roughness"):
        gear.film_thickness(OIL, speed=SPEED, roughness=0.0)


def test_through_the_backlash() -> None:
    """The wheel is rotated away from the flanks that drive until its teeth press on the back side."""
    pressed, pair = 2e-6, RELIEVED  # m
    scene = wf.Scene()
    bodies = [half_space(gear, ("right", "left")) for gear in (pair.gear_1, pair.gear_2)]
    one = scene.add_body(bodies[0], name="pinion", rotation=about_y(angle_at(pair, 0.0)))
    two = scene.add_body(bodies[1], name="wheel")
    options: Any = {"flank": "both", "direction": (1, 0, 0), "rotation": (0.0, 0.0)}
    scene.add_gear_pair(one["center"], two["center"], pair, name="mesh", **options)
    scene.add(wf.joints.Fixed(scene.ground, one["center"]))
    shaft = scene.add(wf.joints.Revolute(scene.ground, two["center"], axis=(0, 1, 0)))
    play = pair.backlash * np.cos(pair.working_pressure_angle)
    error = np.array([0.0, -pressed, play + pressed])
    turn = wf.signals.Table([0.0, 0.25, 1.0], error / pair.gear_2.base_radius)
    scene.add(wf.joints.Drive(shaft, turn, quantity="position"))
    result = wf.static(scene, 1.0, step=1.0 / 64, progress=False)
    assert result.status == "completed", result.message
    gear = result.gear("mesh")
    known = np.interp(gear.time, [0.0, 0.25, 1.0], error)
    assert gear.transmission_error == pytest.approx(known, abs=1e-9)
    apart = gear.time[known > 1e-8]
    (lifted,), (back,) = gear.open_intervals()[-1:], gear.back_intervals()
    assert lifted == pytest.approx([apart[0], 1.0])
    assert back == pytest.approx([gear.time[known > play + 1e-8][0], 1.0])
    behind = np.array([flank == "left" for flank, _, _ in gear.teeth])
    assert not np.any(gear.load[known < play][:, behind]) and not np.any(gear.load[known > 1e-8][:, ~behind])
    assert len(gear.flank_map("left").step) == np.count_nonzero(gear.load[:, behind])


def test_intervals_without_contact() -> None:
    gear = cycle().gear("mesh")
    assert not len(gear.open_intervals()) and not len(gear.back_intervals())
    (within,) = gear.open_intervals(gear.teeth[1])
    rows = (gear.time >= within[0]) & (gear.time <= within[1])
    assert not np.any(gear.load[rows, 1]) and np.all(gear.place[rows, 1] > RELIEVED.path["A"])
    with pytest.raises(wf.InputError, match="teeth"):
        gear.open_intervals(("left", 1, 2))


def test_speeds_of_a_run() -> None:
    """Slip of a contact with friction, the mean over a step and the patch, is the sliding in the middle of the step."""
    scene = rolling(RELIEVED, -2e-3, CYCLE_TORQUE, SPEED)
    result = wf.simulate(scene, 8e-5, step=1e-5, start="equilibrium", progress=False)
    gear = result.gear("mesh")
    (i,) = np.flatnonzero(gear.load[-1])
    contact = result.contact(gear.contacts[i])
    p, slip = contact.mean_pressure, contact.friction.slip_velocity[:, 0]  # e_theta of a right flank is to its tip
    mean = -np.sum(slip * p, axis=(1, 2))[1:] / p.sum(axis=(1, 2))[1:]
    middle = gear.film_thickness(OIL).slip[:, i]
    middle = 0.5 * (middle[1:] + middle[:-1])
    lag = SPEED * (1.0 + 16 / 24) * np.abs(gear.transmission_error).max()  # m/s, of the approach of the flanks
    assert mean == pytest.approx(middle, abs=lag)
    assert np.abs(mean).min() > 50.0 * lag
