"""Blocks with faces that are extruded curves: arcs and flanks of teeth, which touch along lines.

The section of a block lies in the x-y plane, its curve is in these coordinates, and z is the axis.
"""

from __future__ import annotations

from typing import Any

import numpy as np

import warpffrf as wf
from warpffrf.model.mesh import Mesh, box
from warpffrf.model.surfaces import Curve, Extruded
from warpffrf.offline import ContactGrid, reduce

STEEL = wf.Material(210e9, 0.3, 7850.0, name="steel")
LENGTH, WIDTH, DEPTH = 10e-3, 14e-3, 6e-3  # m along the curve, along its axis, below it
COUNTS = (10, 7, 5)
ROUND_OFF = 1e-9  # m
OVER = 0.1  # of the length: how far the curve reaches beyond the face at either end


def arc(radius: float, length: float = (1.0 + 2.0 * OVER) * LENGTH) -> Curve:
    """An arc of the `radius` [m], negative: hollow; its middle in the origin, the material below."""
    half = 0.5 * length / radius
    start = (radius * np.sin(half), radius * (np.cos(half) - 1.0))
    return Curve.arcs(start, np.pi - half, [(length, radius)])


def involute(base: float, curvature: float, length: float = (1.0 + 2.0 * OVER) * LENGTH) -> Curve:
    """An involute of the circle of radius `base` [m] about the origin, the material counter-clockwise of it, its radius
    of curvature `curvature` [m] in its middle."""
    reach = length * base  # u = rho^2/(2 base)
    rho = np.sqrt(np.linspace(curvature**2 - reach, curvature**2 + reach, 81))
    xi = rho / base
    c, s = np.cos(xi), np.sin(xi)
    return Curve.through(base * np.stack([c + xi * s, s - xi * c], axis=1))


def mesh_below(curve: Curve, *, counts: Any = COUNTS, width: float = WIDTH, depth: float = DEPTH) -> Mesh:
    """The block below the middle of a curve, with facet sets `face` and `back`."""
    flat = box((1.0, 1.0, 1.0), counts)
    s, w, d = flat.points.T
    u = curve.knots[0] + curve.length * (0.5 + s / (1.0 + 2.0 * OVER))
    section = curve.at(u) + ((d - 0.5) * depth)[:, None] * curve.normal(u)
    sets = {"face": flat.facet_sets["z_max"], "back": flat.facet_sets["z_min"]}
    return Mesh(np.column_stack([section, width * w]), flat.cells, sets, name="block")


def extruded(curve: Curve, **place: Any) -> Extruded:
    """The surface along z with the section `curve`."""
    return Extruded(curve=curve, axis_direction=(0, 0, 1), x_direction=(1, 0, 0), **place)


def block(curve: Curve, *, tangential: bool = False, contact_fixed: bool = True, **mesh: Any) -> wf.ReducedBody:
    """The block below a curve, reduced, on a rigid back."""
    return reduce(
        mesh_below(curve, **mesh), STEEL, interfaces={"back": "rigid"}, contact={"face": extruded(curve)}, modes=0,
        grid=ContactGrid(contact_fixed=contact_fixed, tangential=tangential), progress=False,
    )  # fmt: skip


def twin(radius: float) -> wf.ReducedBody:
    """A block with two arcs next to each other along x, `left` and `right`, on one `back`."""
    flat = box((2.0 * LENGTH, DEPTH, WIDTH), (2 * COUNTS[0], COUNTS[2], COUNTS[1]), center=(0.0, -0.5 * DEPTH, 0.0))
    x, y, _ = flat.points.T
    top = np.sqrt(radius**2 - (np.abs(x) - 0.5 * LENGTH) ** 2) - radius
    points = flat.points + np.outer((1.0 + y / DEPTH) * top, (0.0, 1.0, 0.0))
    mesh = Mesh(points, flat.cells, {"back": flat.facet_sets["y_min"], "face": flat.facet_sets["y_max"]}, name="twin")
    mesh = mesh.select("left", "face", lambda p: p[:, 0] < ROUND_OFF)
    mesh = mesh.select("right", "face", lambda p: p[:, 0] > -ROUND_OFF)
    faces = {name: at * 0.5 * LENGTH for name, at in (("left", -1.0), ("right", 1.0))}
    return reduce(
        mesh, STEEL, interfaces={"back": "rigid"}, modes=0,
        contact={name: extruded(arc(radius), axis_point=(x, 0.0, 0.0)) for name, x in faces.items()},
        grid=ContactGrid(contact_fixed=True), progress=False,
    )  # fmt: skip


def pressed(
    lower: wf.ReducedBody, upper: wf.ReducedBody, load: float, *, faces: Any = (("face", "face"),), **contact: Any
) -> wf.Scene:
    """A block on the ground, another, upside down, on a vertical guide, pressed down by `load` [N]; contacts `pair`,
    `pair_2` of their `faces`."""
    scene = wf.Scene(gravity=(0, 0, 0))
    one = scene.add_body(lower, name="lower")
    other = scene.add_body(upper, name="upper", rotation={"axis": (0, 0, 1), "angle": np.pi})
    scene.add(wf.joints.Fixed(scene.ground, one["back"]))
    scene.add(wf.joints.Prismatic(scene.ground, other["back"], axis=(0, 1, 0), name="guide"))
    scene.add(wf.forces.PointForce(other["back"], (0.0, -load, 0.0)))
    for number, (first, second) in enumerate(faces):
        name = f"pair_{number + 1}" if number else "pair"
        scene.add(wf.Contact(one[first], other[second], name=name, **contact))
    return scene


BASES, ANGLE = (40e-3, 60e-3), np.radians(22.0)  # of two gears: radii of the base circles [m], pressure angle


def tooth(number: int, **options: Any) -> wf.ReducedBody:
    """A tooth of one of two gears, about its pitch point."""
    base = BASES[number]
    return block(
        involute(base, base * np.tan(ANGLE), 0.5 * LENGTH), counts=(6, 7, 5), width=8e-3, depth=4e-3, **options
    )


def teeth(first: wf.ReducedBody, second: wf.ReducedBody, torque: float, speed: float = 0.0, **contact: Any) -> wf.Scene:
    """Two teeth that touch at their pitch points, on hubs; the first rotates clockwise at the `speed` [rad/s], against
    the `torque` [N m] that presses the second against it."""
    scene = wf.Scene(gravity=(0, 0, 0))
    place, bodies = ((0.0, 0.0, 0.0), (sum(BASES) / np.cos(ANGLE), 0.0, 0.0)), []
    for i, (reduced, name) in enumerate(((first, "first"), (second, "second"))):
        turned = {"axis": (0, 0, 1), "angle": i * np.pi - (np.tan(ANGLE) - ANGLE)}
        at = {"position": place[i], "angular_velocity": (0.0, 0.0, (speed * BASES[0] / BASES[1]) if i else -speed)}
        body = scene.add_body(reduced, name=name, rotation=turned, **at)
        hub = scene.add_rigid_body(1.0, (1e-3, 1e-3, 1e-3), name=f"hub_{name}", **at)
        scene.add(wf.joints.Fixed(hub.at(body["back"].world_point() - np.array(place[i])), body["back"]))
        axle = scene.add(wf.joints.Revolute(scene.ground, hub.at((0, 0, 0)), axis=(0, 0, 1), name=f"axle_{name}"))
        bodies.append((body, hub, axle))
    (one, _, axle), (other, hub, _) = bodies
    scene.add(wf.joints.Drive(axle, -speed, quantity="velocity", name="drive"))
    scene.add(wf.forces.PointTorque(hub.at((0, 0, 0)), (0.0, 0.0, -torque), name="load"))
    scene.add(wf.Contact(one["face"], other["face"], name="pair", **contact))
    return scene
