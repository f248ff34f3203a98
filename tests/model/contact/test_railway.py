"""Wheel S1002 and rail UIC 60: published points, dimensions of flange and head, where a wheelset touches its rails."""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np
import pytest

import warpffrf as wf
from references.wheel_rail import Wheelset
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
# Right wheel: lateral shift [mm], yaw [mrad], roll [rad], and y [mm] of the patch on the rail by CONTACT (E. A. H.
# Vollebregt, case, examples/mbench_a22_right), left wheel the same; loaded by 10 kN, whose patch has its centre
# off the place where the rigid profiles touch: by 0.25 mm on the flat tread, hardly in the flange's root.
BENCHMARK = (
    (2.0, 4.8, 1.128e-4, 740.9147, -756.5056), (3.0, 7.2, 1.803e-4, 739.9698, -757.2358),
    (4.0, 9.6, 2.557e-4, 738.7381, -757.6645), (6.0, 14.4, 6.272e-4, 725.1371, -758.0210),
    (7.5, 18.0, 7.642e-3, 719.4632, -758.4440), (8.5, 20.4, 9.408e-3, 720.1709, -757.9681),
    (10.0, 24.0, 1.126e-2, 721.0880, -757.0975),
)  # fmt: skip


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
    """Of the benchmark, whose rail has its arcs of 300 and 80 mm end at 10.500 and 25.986 mm (its 495 points to 2e-5
    mm) and is inclined by 1:40."""
    return Wheelset(wheel(), head_of_arcs((10.500, 25.986)))


@pytest.mark.parametrize(("y", "yaw", "roll", "right", "left"), BENCHMARK)
def test_a_wheelset_touches_its_rails_as_in_the_benchmark(y, yaw, roll, right, left) -> None:
    wheelset = benchmark_wheelset()
    found = wheelset.roll(1e-3 * y, 1e-3 * yaw)
    assert found == pytest.approx(roll, rel=0.01, abs=4e-6)
    flange = y > 7.0
    places = [1e3 * wheelset.touch(side, 1e-3 * y, roll, 1e-3 * yaw).y for side in (1, -1)]
    assert places[0] == pytest.approx(right, abs=0.01 if flange else 0.1)
    assert places[1] == pytest.approx(left, abs=0.25)


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
