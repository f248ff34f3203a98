"""Gear pairs of runs on half-spaces: ratio of torques, Hertz's pressure, transmission error, shares, files."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.optimize import brentq

import warpffrf as wf
from scenes.gears import CYCLE_STEPS, CYCLE_TORQUE, EQUAL, FZG, RELIEVED, WIDTH, angle_at, cycle, on_shafts
from warpffrf.online.stages import last_rows
from warpffrf.output.gears.gear_result import GearResult

PITCH = 2.0 * np.pi / 16  # rad of the pinion
LIGHT = 5.0  # N m
RIGID = 1e-6  # the deviation of the ratio is proportional to the load, 1.4e-5 at 200 N m
STEEL = wf.Material(youngs_modulus=210e9, poisson_ratio=0.3, density=7850)
ALONG_RELIEF = 1e-4  # where the wheel is relieved, the normal is off the line of action by 6e-6/1e-3, with a cosine


def settled(scene: wf.Scene) -> wf.Result:
    result = wf.equilibrium(scene, progress=False)
    assert result.status == "completed", result.message
    return result


def test_the_ratio_of_torques() -> None:
    """z_2/z_1 over the path of one pair of teeth, where the other pairs have left or not yet met."""
    for g in np.linspace(0.9 * FZG.path["B"], 0.9 * FZG.path["D"], 4):
        torque = settled(on_shafts(FZG, angle_at(FZG, g), LIGHT)).joint("shaft_2").torque[-1]
        assert abs(torque[1]) / LIGHT == pytest.approx(24 / 16, rel=RIGID)


def test_hertz_at_the_pitch_point() -> None:
    """Free ends raise the pressure in the middle of a contact of this length by 1.9 %."""
    result = settled(on_shafts(FZG, angle_at(FZG, 0.0), 200.0))
    gear = result.gear("mesh")
    (carrying,) = np.flatnonzero(gear.load[0] > 1.0)
    assert gear.load[0, carrying] == pytest.approx(200.0 / FZG.gear_1.base_radius, rel=1e-4)
    assert gear.place[0, carrying] == pytest.approx(0.0, abs=20e-6)
    contact = result.contact(gear.contacts[carrying])
    peak, _ = FZG.hertz(200.0, WIDTH)
    assert gear.peak_pressure[0, carrying] == contact.peak_pressure[0]
    assert contact.mid_peak_pressure[0] == pytest.approx(peak * 1.019, rel=5e-3)
    assert gear.load_share[0, carrying] == pytest.approx(1.0)


LONG = replace(
    RELIEVED, **{name: replace(getattr(RELIEVED, name), tip_relief_length=4.5e-3) for name in ("gear_1", "gear_2")}
)


def lag_of_flanks(angle: float) -> float:
    """Transmission error [m] of the relieved flanks as curves, free of load: gear 2 is rotated until they touch."""
    one, two = LONG.gear_1, LONG.gear_2
    k = min(
        range(1, 17), key=lambda k: abs(np.remainder(2.0 * np.pi * (k - 1) / 16 + angle + np.pi, 2 * np.pi) - np.pi)
    )
    curves = [one.flank("right", (k + n - 1) % 16 + 1) for n in (-1, 0, 1)]

    def distance(lag: float) -> float:
        turned, least = LONG.mating_angle(angle) + lag, np.inf
        for curve in curves:
            low, high = curve.knots[0], curve.knots[-1]
            for _ in range(3):
                u = np.linspace(low, high, 200)
                p = rotated(rotated(curve.at(u), angle) - [LONG.center_distance, 0.0], -turned)
                p = rotated(p, -PITCH_2 * np.round(np.arctan2(p[:, 1], p[:, 0]).mean() / PITCH_2))
                d = np.min([two.flank("right", t).gap(p) for t in (24, 1, 2)], axis=0)
                low, high = u[max(np.argmin(d) - 1, 0)], u[min(np.argmin(d) + 1, 199)]
            least = min(least, float(d.min()))  # pyright: ignore[reportPossiblyUnboundVariable]
        return least

    far = -60e-6 / two.base_radius
    return two.base_radius * float(brentq(distance, far, 20e-6 / two.base_radius, xtol=1e-12))  # pyright: ignore


PITCH_2 = 2.0 * np.pi / 24


def rotated(points: np.ndarray, angle: Any) -> np.ndarray:
    c, s = np.cos(angle), np.sin(angle)
    return points @ np.array([[c, s], [-s, c]])


def test_the_transmission_error_without_load() -> None:
    """That of the flanks as curves: none where one pair touches off the relief, and micrometres where all have it."""
    expected = []
    for place in (0.05, 0.47, 0.53):
        gear = settled(on_shafts(LONG, angle_at(LONG, place * LONG.gear_1.base_pitch), 0.2)).gear("mesh")
        expected.append(lag_of_flanks(float(gear.angle[0])))
        assert gear.transmission_error[0] == pytest.approx(expected[-1], abs=0.1e-6)
    assert expected[0] == pytest.approx(0.0, abs=1e-9)
    assert max(expected[1:]) < -3e-6


def test_equal_gears_share_equally() -> None:
    """Half a pitch on either side of the pitch point both pairs of teeth of equal gears carry half."""
    half = 0.5 * EQUAL.gear_1.base_pitch
    gear = settled(on_shafts(EQUAL, angle_at(EQUAL, half), 100.0)).gear("mesh")
    share = gear.load_share[0]
    assert sorted(gear.place[0][share > 0.0]) == pytest.approx([-half, half], abs=20e-6)
    assert share[share > 0.0] == pytest.approx([0.5, 0.5], abs=1e-3)
    assert gear.stiffness[0] == pytest.approx(gear.load[0].sum() / -gear.transmission_error[0])


def test_a_cycle() -> None:
    """Loads sum up to the torque over the base radius, shares to 1; one pitch later everything is as before; orders
    are those of a discrete Fourier transform."""
    gear = cycle().gear("mesh")
    assert len(gear.time) == CYCLE_STEPS + 1
    assert gear.load.sum(axis=1) == pytest.approx(
        CYCLE_TORQUE / RELIEVED.gear_1.base_radius, rel=2e-3
    )  # relief inclines it
    assert gear.load_share.sum(axis=1) == pytest.approx(1.0)
    error = gear.transmission_error
    assert error[-1] == pytest.approx(error[0], abs=1e-8)
    assert np.ptp(error) > 1e-6
    carried = gear.load > 0.0
    assert np.all(gear.place[carried] > RELIEVED.path["A"] - 0.15 * RELIEVED.gear_1.base_pitch)
    assert np.all(gear.place[carried] < RELIEVED.path["E"] + 0.15 * RELIEVED.gear_1.base_pitch)
    spectrum = 2.0 * np.abs(np.fft.rfft(error[:-1])) / CYCLE_STEPS
    assert gear.orders(3).amplitude == pytest.approx(spectrum[1:4], rel=1e-3)
    assert (gear.orders(3).cycles, gear.orders().peak_to_peak) == (1, pytest.approx(np.ptp(error[1:])))
    assert np.nanmax(gear.stiffness) < 2e9


def test_a_file_keeps_the_pair(tmp_path: Path) -> None:
    cycle().save(tmp_path / "cycle.h5")
    read, known = wf.Result.load(tmp_path / "cycle.h5"), cycle()
    assert read.gear_names == known.gear_names == ["mesh"]
    one, other = read.gear("mesh"), known.gear("mesh")
    assert (one.teeth, one.contacts) == (other.teeth, other.contacts)
    assert one.pair.gear_1.half.keys() == other.pair.gear_1.half.keys()
    for name in ("load", "place", "peak_pressure", "transmission_error", "angle"):
        assert getattr(one, name) == pytest.approx(getattr(other, name), rel=1e-6, abs=1e-12)


def test_a_pair_of_no_rows() -> None:
    """A run that keeps no row has the pair, and nothing in it."""
    known = cycle().history
    gear = GearResult(wf.Result(last_rows(known, len(known.time))), cycle().view.gears["mesh"])
    assert gear.load.shape == gear.load_share.shape == gear.place.shape == (0, len(gear.teeth))
    assert gear.transmission_error.shape == gear.stiffness.shape == (0,)
    assert gear.orders(3).cycles == 0 and gear.open_intervals().shape == gear.back_intervals().shape == (0, 2)
    assert gear.flank_map().pressure.shape[0] == 0 and gear.contact_path().points.shape[0] == 0


@pytest.mark.parametrize("angle", [-3.6e-3, -3.65e-3, -3.725e-3, -3.8e-3])
def test_teeth_that_touch_near_the_root_carry_the_torque(angle: float) -> None:
    """The curvature of the pinion changes there within half a column of its grid, over which nearest places were found
    by secants: they were not exact enough for forces to balance."""
    form: Any = {"tip_relief": 15e-6, "tip_relief_length": 2.6e-3, "tip_relief_shape": "parabolic"}
    gears = [wf.gears.Gear(3e-3, z, tip_rounding=1.5e-4, thickness_allowance=-30e-6, **form) for z in (20, 60)]
    pair = wf.gears.GearPair(gears[0], gears[1], 0.12)
    scene = wf.Scene()
    one, two = (
        scene.add_body(
            wf.half_space_body(
                1.0, (1e-3, 2e-3, 1e-3), STEEL, contact=gear.surfaces(("left",)), extent=(-0.015, 0.015)
            ),
            name=name,
        )
        for name, gear in (("pinion", pair.gear_1), ("wheel", pair.gear_2))
    )
    options: Any = {"direction": (1, 0, 0), "rotation": (-0.02, 0.02), "flank": "left", "cells": (7, 9)}
    scene.add_gear_pair(one["center"], two["center"], pair, name="mesh", **options)
    scene.add(wf.joints.Revolute(scene.ground, one["center"], axis=(0, 1, 0)))
    shaft = scene.add(wf.joints.Revolute(scene.ground, two["center"], axis=(0, 1, 0)))
    scene.add(wf.joints.Drive(shaft, angle, quantity="position"))
    scene.add(wf.forces.PointTorque(one["center"], (0, 80.0, 0)))
    load = settled(scene).gear("mesh").load[-1]
    assert np.count_nonzero(load) == 2
    assert load.sum() == pytest.approx(80.0 / pair.gear_1.base_radius, rel=ALONG_RELIEF)


def test_an_unknown_pair() -> None:
    with pytest.raises(wf.InputError, match="no gear pair called 'gear'"):
        cycle().gear("gear")


def test_all_pairs_of_teeth_of_a_revolution_are_no_faults() -> None:
    """Each flank meets several teeth; those of other angles neither face each other nor close, which is no note."""
    scene = on_shafts(RELIEVED, angle_at(RELIEVED, 6e-3), 200.0, rotation=None)
    assert len(scene.contacts) == 48
    result = wf.equilibrium(scene, progress=False)
    assert np.count_nonzero(result.gear("mesh").load[-1]) == 2
    needless = ("face each other", "not closed", "apart")
    assert not [note for note in result.history.notes if any(words in note for words in needless)]
    checks = result.history.cell_checks
    assert len(checks) == 2 and len({id(check) for check in checks.values()}) == 1  # equal teeth, compared once
