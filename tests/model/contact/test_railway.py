"""Wheel S1002 and rail UIC 60: published points, dimensions of flange and head, where a wheelset touches its rails."""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np
import pytest

import warpffrf as wf
from references.wheel_rail import BENCHMARK, BENCHMARK_ENDS, Wheelset
from warpffrf.model.surfaces.railway import head_of_arcs

# s and depth below the running circle [mm] of the S1002 of the Manchester Contact Benchmark (Shackleton and Iwnicki
# 2008), file MBench_S1002_v3 of the open program CONTACT
POINTS = np.array([
    (-61.865167, 25.842215), (-54.505121, 27.989791), (-47.145076, 25.258602), (-41.878937, 19.871063),
    (-39.375371, 14.606324), (-36.043359, 7.9420277), (-31.460184, 4.5279391), (-25.896931, 2.7162302),
    (-12.396505, 0.71685104), (3.6066289, -0.10208223), (20.177456, -0.31451189), (34.200979, -0.91574478),
    (54.073240, -2.2405570),
])  # fmt: skip
DIGITS = 1e-8  # m, of these points, their s in seven digits at a slope of 70 degrees
TABLE = 1.5e-7  # m: published gaps between zones
UPRIGHT: dict[str, Any] = {"axis_point": (0, 0, 0), "axis_direction": (0, 1, 0)}
R = 0.46
# mm, off the centre of a loaded patch, which on a flat tread is large; of two places it is between them
PLACE = {"two places": 3.0, "tread": 0.25, "flange": 0.05}


def wheel():
    return wf.surfaces.wheel_s1002(radius=R, **UPRIGHT)


def test_the_wheel_has_its_published_points() -> None:
    assert np.abs(wheel().radius_at(1e-3 * POINTS[:, 0]) - R - 1e-3 * POINTS[:, 1]).max() < TABLE + DIGITS


def test_the_flange_has_its_dimensions() -> None:
    """Height 28 mm at 15 mm from the back, thickness 32.5 mm at 10 mm below the running circle, and the flank's qR of
    10.8 mm, across the axis between there and 2 mm below the tip; slopes of zones agree where they meet."""
    shape = wheel()
    s = np.linspace(-0.055, 0.0, 200001)
    depth = shape.radius_at(s) - R
    at_10, at_26 = (float(np.interp(-d, -depth, s)) for d in (0.010, 0.026))
    assert float(shape.radius_at(-0.055)) - R == pytest.approx(0.028, abs=1e-9)
    assert at_10 + 0.07 == pytest.approx(0.0325, abs=2e-6)
    assert at_10 - at_26 == pytest.approx(0.0108, abs=2e-5)
    assert abs(float(shape.slope_at(-0.039))) == pytest.approx(np.tan(np.radians(70.0)), rel=1e-7)
    for meet in (-62.764705882, -49.662510381, -39.764473993, -38.426669071, -35.0, -26.0, 32.15796):
        before, after = 1e-3 * meet + 2e-6 * np.array([[-2.0, -1.0], [1.0, 2.0]])
        slopes = [float(np.diff(shape.radius_at(pair))[0] / 2e-6) for pair in (before, after)]
        bends = np.abs(shape.profile().bend_at(np.concatenate([before, after])))
        assert abs(slopes[1] - slopes[0]) < 1e-5 + 6e-6 * float(bends.max()), meet


def test_the_rail_has_its_dimensions() -> None:
    """The head is 72 mm wide 14.1 mm below the top; arcs meet in 10.228 and 26.0265 mm; sides are inclined by 1:20."""
    curve = wf.surfaces.rail_uic60()
    middle = 0.5 * curve.length
    u = middle + np.linspace(0.0, middle, 400001)
    x, y = curve.at(u).T
    assert curve.at(middle) == pytest.approx((0.0, 0.0), abs=1e-12)
    assert -2.0 * float(np.interp(0.0141, -y, x)) == pytest.approx(0.072, abs=3e-5)
    kappa = curve.curvature(u)
    for low, high, radius in ((0.0, 10.228, 300.0), (10.228, 26.0265, 80.0), (26.0265, 35.9, 13.0)):
        inside = (-x > 1e-3 * low + 1e-6) & (-x < 1e-3 * high - 1e-6)
        assert np.abs(1e-3 * radius * kappa[inside] - 1.0).max() < 1e-4
    assert curve.at(curve.length, 1) == pytest.approx(np.array([-1.0, -20.0]) / np.hypot(1.0, 20.0), abs=1e-12)
    assert y[-1] == pytest.approx(-0.03, abs=1e-12)


@cache
def benchmark_wheelset() -> Wheelset:
    return Wheelset(wheel(), head_of_arcs(BENCHMARK_ENDS))


@pytest.mark.parametrize("part", list(BENCHMARK))
def test_a_wheelset_touches_its_rails_as_in_the_benchmark(part: str) -> None:
    """The roll too, which the benchmark prescribes."""
    for case in BENCHMARK[part]:
        touch = benchmark_wheelset().touch(1, *case.pose)
        assert 1e3 * touch.y == pytest.approx(case.across, abs=PLACE[part]), case
        assert 1e3 * touch.s == pytest.approx(case.s, abs=PLACE[part]), case
        assert benchmark_wheelset().roll(1e-3 * case.y, 1e-3 * case.yaw) == pytest.approx(case.roll, rel=0.02, abs=6e-6)


def test_both_are_in_scene_files() -> None:
    from warpffrf.scene_file.load import scene_of

    text = (
        '[ground.rail]\nkind = "extruded"\ncurve = { kind = "rail_uic60" }\naxis_direction = [1, 0, 0]\n'
        "x_direction = [0, 40, 1]\n[ground.wheel]\nkind = \"wheel_s1002\"\nradius = 0.46\naxis_point = [0, 0, 0]\n"
        "axis_direction = [0, 1, 0]\n"
    )  # fmt: skip
    scene = scene_of(text).scene
    assert scene.ground["wheel"].surface.shape.describe() == wheel().describe()
    rail = wf.surfaces.Extruded(curve=wf.surfaces.rail_uic60(), axis_direction=(1, 0, 0), x_direction=(0, 40, 1))
    assert scene.ground["rail"].surface.shape.describe() == rail.describe()
