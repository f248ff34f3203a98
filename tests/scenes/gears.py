"""Gear pairs on shafts, half-spaces under their flanks: gear 1 pushes, the wheel stands or is moved; segments of
flexible teeth on rigid hubs."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np

import warpffrf as wf

STEEL = wf.Material(206e9, 0.3, 7850.0, name="steel")
PLAY, WIDTH = -50e-6, 14e-3  # m
FZG = wf.gears.GearPair(
    wf.gears.Gear(4.5e-3, 16, profile_shift=0.1817, tip_diameter=82.45e-3, thickness_allowance=PLAY),
    wf.gears.Gear(4.5e-3, 24, profile_shift=0.1715, tip_diameter=118.35e-3, thickness_allowance=PLAY),
    91.5e-3,
)
TIPS = {"tip_rounding": 0.2e-3, "tip_relief": 25e-6, "tip_relief_length": 3e-3}
RELIEVED = wf.gears.GearPair(replace(FZG.gear_1, **TIPS), replace(FZG.gear_2, **TIPS), 91.5e-3)
_SAME = wf.gears.Gear(4.5e-3, 20, thickness_allowance=PLAY)
EQUAL = wf.gears.GearPair(_SAME, _SAME, 90e-3)
CYCLE_TORQUE, CYCLE_STEPS = 100.0, 16  # N m


def helical(degrees: float, *, teeth: tuple[int, int] = (20, 30), **options: Any) -> wf.gears.GearPair:
    """Gears of module 4 mm with a helix angle [degrees] of gear 1, in touch at the reference circles."""
    beta = float(np.radians(degrees))
    one, two = (
        wf.gears.Gear(4e-3, z, helix_angle=sign * beta, thickness_allowance=PLAY, **options)
        for z, sign in zip(teeth, (1.0, -1.0), strict=True)
    )
    return wf.gears.GearPair(one, two, 0.5 * (one.reference_diameter + two.reference_diameter))


@cache
def half_space(gear: wf.gears.Gear, sides: tuple[str, ...] = ("right",), width: float = WIDTH) -> wf.ReducedBody:
    flanks: Any = gear.surfaces(sides)
    return wf.half_space_body(1.0, (1e-3,) * 3, STEEL, contact=flanks, extent=(-0.5 * width, 0.5 * width))


def about_y(angle: float) -> dict[str, Any]:
    return {"axis": (0, 1, 0), "angle": angle}


def on_shafts(
    pair: wf.gears.GearPair, angle: float, torque: float, *, moved: float | None = None, rotation: Any = (0.0, 0.0),
    flank: Any = "right", width: float = WIDTH, cells: Any = None,
) -> wf.Scene:  # fmt: skip
    """Gear 1 at an angle [rad] from the line of centres under a torque [N m] about -y, of its left flanks about +y; the
    wheel rotates by `moved` [rad] in 1 s, None: fixed. Joints `shaft_1` and `shaft_2`, gear pair `mesh`."""
    scene, s = wf.Scene(), 1.0 if flank == "right" else -1.0
    one = scene.add_body(half_space(pair.gear_1, (flank,), width), name="pinion", rotation=about_y(angle))
    two = scene.add_body(half_space(pair.gear_2, (flank,), width), name="wheel")
    place: Any = {"direction": (1, 0, 0), "rotation": rotation, "flank": flank, "cells": cells}
    scene.add_gear_pair(one["center"], two["center"], pair, name="mesh", **place)
    scene.add(wf.joints.Revolute(scene.ground, one["center"], axis=(0, 1, 0), name="shaft_1"))
    scene.add(wf.forces.PointTorque(one["center"], (0.0, -s * torque, 0.0)))
    if moved is None:
        scene.add(wf.joints.Fixed(scene.ground, two["center"], name="shaft_2"))
    else:
        shaft = scene.add(wf.joints.Revolute(scene.ground, two["center"], axis=(0, 1, 0), name="shaft_2"))
        scene.add(wf.joints.Drive(shaft, wf.signals.Table([0.0, 1.0], [0.0, moved]), quantity="position"))
    return scene


@cache
def cycle() -> wf.Result:
    """A pitch of the relieved pair under load, in load steps."""
    pitch = 2.0 * np.pi / RELIEVED.gear_1.teeth
    moved = pitch * RELIEVED.gear_1.teeth / RELIEVED.gear_2.teeth
    scene = on_shafts(RELIEVED, 0.05, CYCLE_TORQUE, moved=moved, rotation=(-1.1 * pitch, 0.0))
    result = wf.static(scene, 1.0, step=1.0 / CYCLE_STEPS, progress=False)
    assert result.status == "completed", result.message
    return result


def on_hubs(
    pair: wf.gears.GearPair, body: wf.ReducedBody, tooth: int, g: float, load: float, *, alone: bool = False
) -> wf.Result:
    """Segments of two equal gears at rest, gear 1 under a torque of `load` [N] times its base radius: its `tooth` k
    touches tooth k + 1 of gear 2 at g [m], and, unless the first pair is `alone`, tooth k + 1 tooth k a pitch earlier.
    Gear pair `mesh`; both bores are on rigid hubs."""
    scene, pitch = wf.Scene(gravity=(0, 0, 0)), 2.0 * np.pi / pair.gear_1.teeth
    facing = np.pi - (tooth - 0.25) * pitch + g / pair.gear_2.base_radius  # within the backlash
    turn = about_y(angle_at(pair, g) - (tooth - 1) * pitch), about_y(facing)
    one, two = (scene.add_body(body, name=name, rotation=how) for name, how in zip(("one", "two"), turn, strict=True))
    place: Any = {"name": "mesh", "direction": (1, 0, 0), "rotation": (0.0, 0.0)}
    mesh = scene.add_gear_pair(one["bore"], two["bore"], pair, **place)
    for teeth in [other for other in mesh.contacts if alone and other[1] != tooth]:
        scene.contacts.remove(mesh.contacts.pop(teeth))
    hubs = []
    for segment in (one, two):
        hub = scene.add_rigid_body(1.0, (1e-3,) * 3, name=f"hub of {segment.name}", position=segment.position)
        scene.add(wf.joints.Fixed(hub.at(segment["bore"].world_point() - segment.position), segment["bore"]))
        hubs.append(hub)
    scene.add(wf.joints.Revolute(scene.ground, hubs[0], axis=(0, 1, 0)))
    scene.add(wf.joints.Fixed(scene.ground, hubs[1]))
    scene.add(wf.forces.PointTorque(hubs[0], (0.0, -load * pair.gear_1.base_radius, 0.0)))
    result = wf.equilibrium(scene, progress=False)
    assert result.status == "completed", result.message
    return result


def rolling(pair: wf.gears.GearPair, g: float, torque: float, speed: float) -> wf.Scene:
    """Gears that rotate, gear 1 at `speed` [rad/s] about -y from where its tooth 1 touches at g [m], with friction; the
    wheel is driven, a torque [N m] about -y presses gear 1 on it. Gear pair `mesh`."""
    scene, other = wf.Scene(), speed * pair.gear_1.teeth / pair.gear_2.teeth
    turn = about_y(angle_at(pair, g))
    one = scene.add_body(half_space(pair.gear_1), name="pinion", rotation=turn, angular_velocity=(0, -speed, 0))
    two = scene.add_body(half_space(pair.gear_2), name="wheel", angular_velocity=(0, other, 0))
    options: Any = {"direction": (1, 0, 0), "rotation": (-0.45, 0.0), "friction": 0.05}
    scene.add_gear_pair(one["center"], two["center"], pair, name="mesh", **options)
    scene.add(wf.joints.Revolute(scene.ground, one["center"], axis=(0, 1, 0), name="shaft_1"))
    shaft = scene.add(wf.joints.Revolute(scene.ground, two["center"], axis=(0, 1, 0), name="shaft_2"))
    scene.add(wf.joints.Drive(shaft, other, quantity="velocity"))
    scene.add(wf.forces.PointTorque(one["center"], (0.0, -torque, 0.0)))
    return scene


def angle_at(pair: wf.gears.GearPair, g: float, flank: str = "right") -> float:
    """Rotation [rad] of gear 1 at which its tooth 1 touches at g [m] with a flank, in its middle section."""
    width = pair.gear_1.tooth_thickness(pair.working_diameters[0]) / pair.working_diameters[0]
    return (1.0 if flank == "right" else -1.0) * float(width - g / pair.gear_1.base_radius)
