"""A flexible body held at an interface, and a rigid or flexible partner that is pressed on it along a guide."""

from __future__ import annotations

from typing import Any

import numpy as np

from scenes.rollers import CARRIAGE_INERTIA, CARRIAGE_MASS, StaticPath
from warpffrf.model import joints, signals
from warpffrf.model.contact import Contact
from warpffrf.model.placement.gap import smallest_gap
from warpffrf.model.scene import Scene
from warpffrf.online import Settings
from warpffrf.output.result import Result

PAIR = "pair"
TOUCHES = 60  # moves until a body touches; each leaves the error of the direction
UNTOUCHED = 1e-13  # m


def pressed(
    first: Any,
    second: Any,
    approach: Any,
    *,
    angle: Any = 0.0,
    surface: str = "rim",
    interface: str = "bore",
    axis: tuple[float, float, float] = (0.0, 1.0, 0.0),
    along: tuple[float, float, float] = (0.0, 0.0, -1.0),
    rotation: Any = (0.0, 0.0, 0.0, 1.0),
    position: Any = (0.0, 0.0, 0.0),
    second_surface: str = "rim",
    second_interface: str = "bore",
) -> Scene:
    """`first`, a reduced body "first", pushed along `along` by `approach` (n,) [m] from first touch and rotated by
    `angle` (n,) [rad] about its own `axis` (user frame); state i of both at time i.

    second: a shape, on the ground; or a reduced body, held at its interface.
    """
    scene = Scene()
    body = scene.add_body(first, name="first", rotation=rotation, position=position)
    if hasattr(second, "frequencies"):
        other = scene.add_body(second, name="second")
        port: Any = other[second_surface]
        scene.add(joints.Fixed(scene.ground, other[second_interface], name="hold"))
    else:
        port = scene.ground.surface(second, name="face")
    contact = Contact(body[surface], port, name=PAIR, overlap=1.0)
    scene.add(contact)
    direction = np.asarray(along, float)
    for _ in range(TOUCHES):
        gap = smallest_gap(contact)[0]
        body.position = body.position + gap * direction
        if abs(gap) < UNTOUCHED:
            break
    approach, angle = np.broadcast_arrays(np.atleast_1d(np.asarray(approach, float)), angle)
    place = body[interface].world_point()
    carriage = scene.add_rigid_body(CARRIAGE_MASS, CARRIAGE_INERTIA, name="carriage", position=place)
    center = carriage.at((0.0, 0.0, 0.0))
    guide = scene.add(joints.Prismatic(scene.ground, center, axis=along, name="guide"))
    world_axis = body.to_world(np.asarray(axis)) - body.to_world(np.zeros(3))
    axle = scene.add(joints.Revolute(center, body[interface], axis=world_axis, name="axle"))
    times = np.arange(len(approach) + 1.0)
    for joint, values in ((guide, approach), (axle, angle)):
        table = signals.Table(times, np.append(values, values[-1]))
        scene.add(joints.Drive(joint, table, quantity="position"))
    return scene


def solved(scene: Scene, count: int, **settings: Any) -> Result:
    """Static states 0 to count - 1."""
    options = {"window_strain": 0.3, "residual_tolerance": 1e-10, **settings}
    return Result(StaticPath(scene, settings=Settings(**options)).solve(count))
