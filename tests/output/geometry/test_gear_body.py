"""Gears in pictures: closed outlines that lie on the flanks, for half-spaces and rigid bodies of gear pairs."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import warpffrf as wf
from scenes.gears import FZG, PLAY, RELIEVED, about_y, angle_at, half_space, helical
from warpffrf.output.geometry.gear_body import BEYOND, BORE, gear_mesh
from warpffrf.output.geometry.rigid_mesh import rigid_meshes

SMALL = wf.gears.Gear(4.5e-3, 20, profile_shift=0.4, thickness_allowance=PLAY)
RING = wf.gears.Gear(
    4.5e-3, 60, internal=True, profile_shift=-0.4, root_radius=0.25, tip_diameter=265e-3, thickness_allowance=PLAY
)
HALF = 7e-3  # m
ON = 1e-12


def section_area(gear: wf.gears.Gear) -> float:
    """Of a gear with rounded tips, without a bore [m2]."""
    section = gear.section()
    x, y = section.at(np.linspace(section.knots[0], section.knots[-1], 40001)).T
    return 0.5 * float(np.sum(x[:-1] * y[1:] - x[1:] * y[:-1]))


@pytest.mark.parametrize("gear", [RELIEVED.gear_1, helical(-25.0, tip_rounding=0.2e-3).gear_1])
def test_the_volume_is_that_of_the_section(gear: wf.gears.Gear) -> None:
    """Faces lie a thousandth of the width beyond the flanks at either end: that much more."""
    mesh = gear_mesh(gear, -HALF, HALF, [("right", 3)])
    area = section_area(gear) - np.pi * (BORE * 0.5 * gear.root_diameter) ** 2
    assert mesh.volume / (2.0 * HALF * area) - 1.0 == pytest.approx(BEYOND, abs=1.5 * BEYOND)


@pytest.mark.parametrize("gear", [FZG.gear_1, RELIEVED.gear_2, RING, helical(25.0).gear_2])
def test_points_lie_on_the_flanks_and_face_outwards(gear: wf.gears.Gear) -> None:
    mesh = gear_mesh(gear, -HALF, HALF, [("left", 2)])
    normals = mesh.normals
    for name, flank in gear.surfaces(teeth=(1, 2, gear.teeth)).items():
        u, z, distance = flank.chart(mesh.points)
        on = (np.abs(distance) < ON) & (np.abs(z) <= HALF)
        assert np.count_nonzero(on) >= (17 * 90 if name == "flank_left_2" else 10), name
        inner = on & (u > flank.curve.knots[0] + 1e-3) & (u < flank.curve.knots[-1] - 1e-3)
        outwards = np.einsum("ni,ni->n", normals[inner], flank.normal(u[inner], z[inner]))
        assert outwards.min() > 0.95, name
    assert mesh.volume > 0.0


def pressed(ring: bool) -> wf.Result:
    """A pinion on half-spaces in a rigid ring, or on a wheel on half-spaces."""
    pair = wf.gears.GearPair(SMALL, RING, 89.9e-3) if ring else FZG
    scene = wf.Scene()
    one = scene.add_body(half_space(pair.gear_1), name="pinion", rotation=about_y(angle_at(pair, 0.0)))
    if ring:
        two = scene.add_rigid_body(1.0, (1e-3,) * 3, name="wheel", surfaces=pair.gear_2.surfaces(("right",)))
    else:
        two = scene.add_body(half_space(pair.gear_2), name="wheel")
    hub: Any = two.at((0, 0, 0)) if ring else two["center"]
    scene.add_gear_pair(one["center"], hub, pair, name="mesh", direction=(pair.side, 0, 0), rotation=(0.0, 0.0))
    scene.add(wf.joints.Revolute(scene.ground, one["center"], axis=(0, 1, 0)))
    scene.add(wf.joints.Fixed(scene.ground, hub))
    scene.add(wf.forces.PointTorque(one["center"], (0.0, -100.0, 0.0)))
    return wf.equilibrium(scene, progress=False)


def test_half_spaces_are_drawn_as_gears_with_their_pressure() -> None:
    """The skin is the whole gear, without displacement; pressure lies on the flanks in contact, not on the faces."""
    result = pressed(ring=False)
    gear, skins = result.gear("mesh"), result.skins()
    for n, name in enumerate(("pinion", "wheel")):
        skin, own = skins[name], (FZG.gear_1, FZG.gear_2)[n]
        size = np.hypot(skin.points[:, 0], skin.points[:, 2])
        assert size.max() == pytest.approx(0.5 * own.tip_diameter, rel=1e-6)
        assert not np.any(skin.displacement(0))
        p = skin.pressure(0)
        assert p.max() == pytest.approx(gear.peak_pressure[0].max(), rel=0.1)  # at nodes, not in the middle
        assert np.abs(skin.points[p > 0.0, 1]).max() <= HALF
        (i,) = np.flatnonzero(gear.load[0])
        flank, *teeth = gear.teeth[i]
        surface = own.surfaces((flank,), (teeth[n],))[f"flank_{flank}_{teeth[n]}"]
        assert np.abs(surface.chart(skin.points[p > 0.0])[2]).max() < ON
    assert not rigid_meshes(result)


def test_a_rigid_ring() -> None:
    mesh = rigid_meshes(pressed(ring=True))["wheel"]
    size = np.hypot(mesh.points[:, 0], mesh.points[:, 2])
    assert size.min() == pytest.approx(0.5 * RING.tip_diameter, rel=1e-6)
    assert np.ptp(mesh.points[:, 1]) == pytest.approx(2.0 * HALF * (1.0 + 2.0 * BEYOND), rel=1e-3)
    assert not mesh.marker
