"""Wheelsets in one call: where the profiles touch, conicity of cones, pose at the start, and refusals.

The profiles S1002 and UIC 60 are compared with brute force in the tests of the demo `wheelset`, the hunting of cones
with exact kinematics in `scenes.hunting`.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import warpffrf as wf
from scenes import hunting
from warpffrf.model import rotation as rot
from warpffrf.model.wheelset import SIDES

STEEL = wf.Material(youngs_modulus=210e9, poisson_ratio=0.28, density=7850, name="steel")
SAMPLED = 1e-9  # m: heights, by samples 6 um apart
GIVEN: dict[str, Any] = {
    "name": "set", "mass": 1200.0, "inertia_tensor": (700, 100, 700), "material": STEEL, "track": (-1.0, 5.0),
}  # fmt: skip


def test_cones_touch_round_rails_where_lines_touch_circles() -> None:
    wheels = hunting.wheelset().wheelsets[0]
    kappa, conicity, b, r = hunting.kinematics()
    y = 1e-3
    assert wheels.roll(y) == pytest.approx(kappa * y, rel=1e-3)
    left, right = (wheels.touch(side, y, wheels.roll(y)) for side in (1, -1))
    assert left[0] == pytest.approx(right[0], abs=SAMPLED)
    assert (left[1] - right[1]) / (2.0 * y) == pytest.approx(conicity, rel=0.01)  # samples of the radius, 5 % of 5 um
    assert 0.5 * (left[3] - right[3]) == pytest.approx(b, abs=20e-6)
    # the wave of b, r, conicity and roll, but for 0.75 m instead of b in the definition
    expected = conicity / (1.0 + kappa * r) * hunting.HALF_GAUGE * hunting.RADIUS / (b * r)
    assert wheels.conicity(2e-3) == pytest.approx(expected, rel=3e-3)


def test_it_begins_rolling_on_both_rails_with_its_yaw() -> None:
    scene = wf.Scene()
    wheels = scene.add_wheelset(
        wf.surfaces.wheel_s1002(radius=0.46), wf.surfaces.rail_uic60(), speed=10.0, y=1e-3, yaw=2e-3, **GIVEN
    )
    axes = rot.matrix(wheels.body.rotation)
    assert np.arctan2(axes[1, 0], axes[0, 0]) == pytest.approx(2e-3, rel=1e-6)
    assert axes[2, 1] == pytest.approx(np.sin(wheels.roll(1e-3)), rel=1e-9)
    assert wheels.body.velocity == pytest.approx(0.46 * np.cross(wheels.body.angular_velocity, [0, 0, 1]), abs=0.01)
    assert np.abs(list(scene.check().gaps.values())).max() < 2e-6  # m, of the yaw
    assert [body.name for body in scene.bodies] == ["set", "set left rail", "set right rail"]
    for name, side in SIDES.items():
        rail: Any = wheels.rails[name].surface.shape
        head = rail.point(np.linspace(0.0, rail.curve.length, 4001), 0.0)
        inner = side * head[:, 1] - 0.5 * 1.435
        assert head[:, 2].max() == pytest.approx(0.0, abs=1e-7)
        below = np.abs(head[:, 2] + 14e-3) < 20e-6
        assert np.abs(inner[below]).min() < 2e-6  # 1,435 mm apart, 14 mm below the tops


def test_what_is_no_wheelset_is_refused() -> None:
    scene, wheel, rail = wf.Scene(), wf.surfaces.wheel_s1002(radius=0.46), wf.surfaces.rail_uic60()
    refused: tuple[tuple[Any, dict[str, Any], str], ...] = (
        ((rail, rail), {}, "wheel must be a surface of revolution"),
        ((wf.surfaces.wheel_s1002(radius=0.46, axis_point=(0, 0, 0)), rail), {}, "without axis_point"),
        ((wheel, wheel), {}, "rail must be an open"),
        ((wheel, rail), {"track": (0.1, 5.0)}, "track must contain x = 0"),
        ((wheel, rail), {"gauge_depth": 0.05}, "make it longer"),
        ((wheel, rail), {"y": 0.2}, "does not touch its rail"),
    )
    for arguments, options, message in refused:
        given: Any = {**GIVEN, **options}
        with pytest.raises(wf.InputError, match=message):
            scene.add_wheelset(*arguments, **given)
    assert not scene.contacts and not scene.bodies
