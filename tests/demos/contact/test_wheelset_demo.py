"""A wheelset S1002 on rails UIC 60: kinematics by brute force, wavelength, places and pressures of the patches."""

from __future__ import annotations

from functools import cache
from pathlib import Path

import numpy as np
import pytest
from checks import Check, both_sizes, left_behind, missed

import warpffrf as wf
from demos import wheelset as demo
from references.wheel_rail import Wheelset
from warpffrf.model import rotation

AMPLITUDE = 3e-3  # m
KINEMATICS = 2e-4  # of the wavelength: 46 displacements in the demo
WAVE, LIGHT_WAVE = 0.03, 0.01  # under the load and a fifth of it: patches move over where rigid profiles jump
PLACE = 5e-4  # m, of a patch's centre from the place of the rigid profiles, where it lies within zones of unlike radii
HERTZ = 0.03  # likewise
ROLL = 0.06  # the sharper one of both contacts yields by 10 um more, 7e-6 rad
LOAD = 1e-3  # of the load
MIDPOINTS = 100


@cache
def rigid() -> Wheelset:
    return Wheelset(demo.rigid().body["left"].surface.shape, wf.surfaces.rail_uic60())


def wavelength(amplitude: float) -> float:
    """By quadrature: psi^2 = 2 int S W dy from y to the amplitude, dx = W dy/psi, with W = 1 + r dphi/dy and the rate
    S = -dpsi/dx, in y = A sin(a)."""
    step = 0.5 * np.pi / MIDPOINTS
    a = step * (np.arange(MIDPOINTS) + 0.5)
    edges = amplitude * np.sin(step * np.arange(MIDPOINTS + 1))
    y = amplitude * np.sin(a)
    roll = np.array([rigid().roll(at) for at in edges])
    W = 1.0 + demo.RADIUS * np.diff(roll) / np.diff(edges)
    S = np.zeros(MIDPOINTS)
    for i, at in enumerate(y):
        phi = rigid().roll(at)
        left, right = (rigid().touch(side, at, phi, 0.0) for side in (1, -1))
        S[i] = (left.radius - right.radius) / (left.y - right.y) / demo.RADIUS
    work = S * W * np.diff(edges)
    beyond = np.append(np.cumsum(work[:0:-1])[::-1], 0.0) + S * W * (edges[1:] - y)
    return 4.0 * float(np.sum(W * amplitude * np.cos(a) * step / np.sqrt(2.0 * beyond)))


def compare(result: wf.Result) -> list[Check]:
    """Wavelength; where the wheelset is furthest to the left, places of the patches and largest pressures."""
    assert result.status == "completed", result.message
    y = result.body("wheelset").position[:, 1]
    top, amplitude = int(np.argmax(y)), float(y.max())
    axle = rotation.matrix(result.body("wheelset").rotation[top])[:, 1]
    roll = rigid().roll(amplitude)
    found = [
        Check("wavelength", demo.wavelength(result), wavelength(amplitude), "rolling without slip", WAVE, "m"),
        Check("roll", axle[2], roll, "rigid profiles", ROLL, "mrad", 1e3),
    ]
    for name, side in demo.SIDES.items():
        contact = result.contact(f"wheelset {name}")
        s, peak = contact.center_of_pressure[top, 1], contact.peak_pressure[top]
        touch = rigid().touch(side, amplitude, roll, 0.0)
        found += [
            Check(f"{name}: place", s, touch.s, "rigid profiles", PLACE, "mm", 1e3, scale=1.0),
            Check(f"{name}: pressure", peak, demo.hertz_peak(contact, top), "Hertz", HERTZ, "MPa", 1e-6),
        ]
    held = result.time > 2.0 * demo.RISE
    upwards = float(np.mean(sum(result.contact(f"wheelset {name}").force[held, 2] for name in demo.SIDES)))
    return [*found, Check("mean force upwards", upwards, demo.LOAD, "load", LOAD, "N")]


@pytest.mark.parametrize("y", [0.0, 1e-3, AMPLITUDE])
def test_the_rigid_profiles_touch_where_brute_force_finds_them(y: float) -> None:
    """Yawed, as the wheelset is, they touch there, too."""
    roll = demo.rigid().roll(y)
    assert roll == pytest.approx(rigid().roll(y), abs=1e-9)
    for side in (1, -1):
        found, expected = demo.rigid().touch(side, y, roll), rigid().touch(side, y, roll, demo.YAW)
        assert found == pytest.approx([expected.height, expected.radius, expected.s, expected.y], abs=4e-5)


def test_the_wave_of_rolling_without_slip() -> None:
    assert 2.0 * demo.rigid().wave(AMPLITUDE)[0][-1] == pytest.approx(wavelength(AMPLITUDE), rel=KINEMATICS)


def test_the_wheelset_hunts_in_coarse_cells() -> None:
    assert missed(compare(demo.run(demo.QUICK, progress=False))) == []


@pytest.mark.slow
def test_under_a_light_load_it_hunts_like_a_rigid_one(monkeypatch: pytest.MonkeyPatch) -> None:
    """Its patches are small: they jump as the profiles do."""
    monkeypatch.setattr(demo, "LOAD", 0.2 * demo.LOAD)
    result = demo.run(demo.FULL, progress=False)
    amplitude = result.body("wheelset").position[:, 1].max()
    assert demo.wavelength(result) == pytest.approx(wavelength(amplitude), rel=LIGHT_WAVE)


@both_sizes
def test_the_whole_demo(tmp_path: Path, quick: bool) -> None:
    result = demo.main(tmp_path, quick=quick, progress=False)
    left_behind(tmp_path, "wheelset")
    assert missed(compare(result)) == []
