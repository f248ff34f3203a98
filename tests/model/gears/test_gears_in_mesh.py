"""Gear pairs of a scene: flanks touch where they are placed, and contacts are those of the teeth that meet."""

from __future__ import annotations

import re
from dataclasses import replace
from typing import Any, cast

import numpy as np
import pytest

import warpffrf as wf
from scenes.gears import EQUAL, FZG, PLAY, STEEL, WIDTH, about_y, angle_at, half_space
from warpffrf.model.errors import InputError
from warpffrf.model.gears.mesh import ENTRY, GearMesh

TOUCH = 1e-10  # m
PLACE = np.array([0.1, -0.2, 0.3])  # m
SAMPLED = 1e-7  # m: of the distance of curves at 400 points
SMALL = wf.gears.Gear(4.5e-3, 20, profile_shift=0.4, thickness_allowance=PLAY)
RING = wf.gears.Gear(4.5e-3, 60, internal=True, profile_shift=-0.4, root_radius=0.25, tip_diameter=265e-3,
                     thickness_allowance=PLAY)  # fmt: skip
INTERNAL = wf.gears.GearPair(SMALL, RING, 89.9e-3)


def mesh_of(
    pair: wf.gears.GearPair, flank: Any, angle: float, *, wheel: float = 0.0, tilt: Any = None, **options: Any
) -> GearMesh:
    """A gear and a rigid one in a scene, rotated by `angle` and `wheel` [rad] about +y, the first instead by `tilt`."""
    scene = wf.Scene()
    sides = ("right", "left") if flank == "both" else (flank,)
    one = scene.add_body(half_space(pair.gear_1, sides), name="one", position=PLACE, rotation=tilt or about_y(angle))
    two = scene.add_rigid_body(
        1.0, (1e-3,) * 3, name="two", surfaces=pair.gear_2.surfaces(sides), rotation=about_y(wheel)
    )  # fmt: skip
    return scene.add_gear_pair(one["center"], two.at((0, 0, 0)), pair, name="mesh", flank=flank, **options)


def turned(points: np.ndarray, angle: float) -> np.ndarray:
    c, s = np.cos(angle), np.sin(angle)
    return points @ np.array([[c, s], [-s, c]])


def gap(contact: wf.Contact) -> float:
    """Least distance [m] of two flanks: that of points of the first to the second, refined about the nearest."""
    (one, first), (two, second) = (
        (port.body, port.body.surfaces[port.name].shape.curve if port.rigid else port.surface.shape.curve)
        for port in (contact.a, contact.b)
    )
    low, high = first.knots[0], first.knots[-1]
    for _ in range(3):
        u = np.linspace(low, high, 400)
        x, y = first.at(u).T
        at = two.to_user(one.to_world(np.stack([x, np.zeros_like(x), -y], axis=1)))
        assert np.abs(at[:, 1]).max() < TOUCH
        distance = second.gap(at[:, [0, 2]] * [1.0, -1.0])
        nearest = int(np.argmin(distance))
        low, high = u[max(nearest - 1, 0)], u[min(nearest + 1, 399)]
    return float(distance.min())  # pyright: ignore[reportPossiblyUnboundVariable]


@pytest.mark.parametrize("flank", ["right", "left"])
@pytest.mark.parametrize(
    ("pair", "direction"), [(FZG, None), (FZG, (1, 0, 0)), (INTERNAL, (0.3, 0.2, -1)), (EQUAL, (0, 5, 1))]
)
def test_flanks_touch(pair: wf.gears.GearPair, direction: Any, flank: str) -> None:
    """At any angle, in any direction, with any tilt of the axis: pairs of teeth between A and E touch, none overlap."""
    for angle in (0.0, 0.13, -2.5, 3.0):
        mesh = mesh_of(pair, flank, angle, direction=direction, rotation=(0.0, 0.0))
        assert mesh.contacts
        found = np.array([gap(contact) for contact in mesh.contacts.values()])
        assert found.min() > -TOUCH
        touching = np.count_nonzero(found < TOUCH)
        assert touching in (int(pair.contact_ratio), int(pair.contact_ratio) + 1)


def test_an_inclined_axis() -> None:
    mesh = mesh_of(FZG, "right", 0.0, tilt={"axis": (1, 2, 0.5), "angle": 0.8}, rotation=(0.0, 0.0))
    assert min(abs(gap(contact)) for contact in mesh.contacts.values()) < TOUCH


def test_the_wheel_keeps_its_teeth() -> None:
    """It is rotated by the least angle, less than half a pitch: of equal gears the teeth of its rotation meet."""
    pitch = 2.0 * np.pi / 24
    for tooth in (0, 5, 13):
        at = np.pi + pitch * (0.3 - tooth)
        mesh = mesh_of(FZG, "right", 0.0, wheel=at, direction=(1, 0, 0), rotation=(0.0, 0.0))
        axis = wf.Scene().add_rigid_body(1.0, (1.0,) * 3, name="b", rotation=about_y(at)).to_world((1, 0, 0))
        moved = mesh.hubs[1].body.to_world((1, 0, 0)) - mesh.hubs[1].body.position
        assert np.arccos(axis @ moved) < 0.5 * pitch + 1e-9
        assert {t for _, _, t in mesh.contacts} <= {(tooth + n) % 24 + 1 for n in (-1, 0, 1)}


@pytest.mark.parametrize("flank", ["right", "left"])
@pytest.mark.parametrize("pair", [FZG, INTERNAL])
def test_the_teeth_that_meet(pair: wf.gears.GearPair, flank: str) -> None:
    """Brute force: all pairs of teeth near the line of centres that touch at some angle of the range have a contact,
    and all that have one touch in a range that is larger by the earlier meeting of loaded teeth."""
    ratio, side = pair.gear_1.teeth / pair.gear_2.teeth, -pair.side
    start, end = 0.3, -0.25
    mesh = mesh_of(pair, flank, start, direction=(1, 0, 0), rotation=(0.0, end))
    two = mesh.hubs[1].body
    early = (ENTRY + 0.02) * pair.gear_1.base_pitch / pair.gear_1.base_radius

    curves = [[gear.flank(flank, k + 1) for k in range(gear.teeth)] for gear in (pair.gear_1, pair.gear_2)]
    center, towards = two.to_user(np.stack([PLACE, PLACE + [1.0, 0.0, 0.0]]))[:, [0, 2]] * [1.0, -1.0]
    line = float(np.arctan2(*(towards - center)[::-1]))  # of centres, in the frame of gear 2

    def touching(moves: Any) -> set[tuple[int, int]]:
        found = set()
        for moved in moves:
            for k, one in enumerate(curves[0]):
                p = turned(one.at(np.linspace(one.knots[0], one.knots[-1], 400)), start + moved)
                if pair.side * p[:, 0].mean() < 0.8 * np.hypot(*p.T).mean():
                    continue  # far from the line of centres
                q = turned(center + turned(p, line), -side * ratio * moved)
                for t, other in enumerate(curves[1]):
                    near = np.hypot(*(q[:, None] - other.at(other.knots[::4])).T).min() < 2e-3
                    if near and other.gap(q).min() < SAMPLED:
                        found.add((k + 1, t + 1))
        return found

    contacts = {(k, t) for _, k, t in mesh.contacts}
    assert touching(np.linspace(0.0, end, 12)) <= contacts
    assert contacts <= touching(np.linspace(early, end - early, 40))


def test_all_rotations() -> None:
    """Without a range every tooth meets every one that it ever meets: lcm(z_1, z_2) pairs."""
    assert len(mesh_of(FZG, "right", 0.0).contacts) == 48
    assert len(mesh_of(EQUAL, "both", 0.0).contacts) == 40


def test_both_flanks_have_the_backlash_between_them() -> None:
    mesh = mesh_of(FZG, "both", 0.05, direction=(1, 0, 0), rotation=(0.0, 0.0))
    gaps = {side: min(gap(c) for (s, _, _), c in mesh.contacts.items() if s == side) for side in ("right", "left")}
    assert abs(gaps["right"]) < TOUCH
    assert gaps["left"] == pytest.approx(FZG.backlash * np.cos(FZG.working_pressure_angle), rel=1e-3)


def test_what_is_refused() -> None:
    scene = wf.Scene()
    gear = half_space(FZG.gear_1)
    one, two = (scene.add_body(gear, name=name) for name in ("one", "two"))
    hubs: Any = one["center"], two["center"]
    ground, front = cast("Any", scene.ground), cast("Any", "front")
    some = scene.add_rigid_body(1.0, (1e-3,) * 3, name="some", surfaces=FZG.gear_2.surfaces(("right",), (1, 2)))
    for call, message in (
        (lambda: scene.add_gear_pair(hubs[0], hubs[1], FZG, name="m", direction=(0, 1, 0)), "not be along the axis"),
        (lambda: scene.add_gear_pair(hubs[0], some.at((0, 0, 0)), FZG, name="m"),
         "body 'some' has no surface 'flank_right_"),
        (lambda: scene.add_gear_pair(hubs[0], some.at((0, 0, 0)), FZG, name="m", flank="left"),
         "body 'one' has no surface 'flank_left_"),
        (lambda: scene.add_gear_pair(one["flank_right_1"], hubs[1], FZG, name="m"), "gear_1 must be the hub of a body"),
        (lambda: scene.add_gear_pair(hubs[0], ground, FZG, name="m"), "gear_2 must be the hub of a body"),
        (lambda: scene.add_gear_pair(hubs[0], hubs[1], FZG, name="m", flank=front), "flank 'front'"),
        (lambda: scene.add_gear_pair(hubs[0], hubs[1], FZG, name="m", rotation=1.0), "rotation must"),
        (lambda: scene.add_gear_pair(hubs[0], hubs[1], replace(FZG, center_distance=0.2), name="m"), "contact ratio"),
    ):  # fmt: skip
        with pytest.raises(InputError, match=re.escape(message)):
            call()
    assert not scene.gears


def test_contact_grids_that_end_within_the_path_are_named(caplog: pytest.LogCaptureFixture) -> None:
    """Those of flexible flanks end a cell before the flank; half-spaces have no grid that matters."""
    pinion, wheel = FZG.gear_1, FZG.gear_2
    mesh = wf.mesh.gear(
        pinion, WIDTH, rim_radius=20e-3, teeth=1, along=6, across=2, layers=2, axial=3, rim_layers=1, order=1
    )
    flexible = wf.reduce(
        mesh, STEEL, interfaces={"bore": "rigid"}, contact=pinion.surfaces(("right",), (1,)),
        grid=wf.ContactGrid(contact_fixed=True), progress=False,
    )  # fmt: skip
    scene = wf.Scene()
    one = scene.add_body(flexible, name="one", rotation=about_y(angle_at(FZG, 0.0)))
    two = scene.add_body(half_space(wheel), name="two")
    caplog.clear()
    pair = scene.add_gear_pair(one["bore"], two["center"], FZG, name="m", direction=(1, 0, 0), rotation=(0.0, 0.0))
    (contact,) = pair.contacts.values()
    grid, curve = contact.a.surface.grid, contact.a.surface.shape.curve
    radius = np.linalg.norm(curve.at(grid.theta[[0, -1]]), axis=1)
    low, high = 1e3 * (np.sqrt(radius**2 - pinion.base_radius**2) - FZG.pitch_rho[0])
    assert f"contact grids of flanks end at {low:.2f} and {high:.2f} mm" in caplog.text
