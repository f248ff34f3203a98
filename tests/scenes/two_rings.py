"""Rollers between two rings, a roller bearing with its cage at rest: many pairs on few surfaces.

The rollers are at equal angles, each on a radial guide, thicker by an interference than the space between the rings,
so that all pairs are loaded at all times. Rings and rollers are driven so that they roll on each other.
"""

from __future__ import annotations

from collections.abc import Collection

import numpy as np

from warpffrf.model import joints
from warpffrf.model.bodies import Body, PortLike
from warpffrf.model.contact import Contact
from warpffrf.model.errors import InputError, require_count, require_number
from warpffrf.model.joints.base import Joint
from warpffrf.model.reduced.body import ReducedBody
from warpffrf.model.scene import Scene

SLIDE_MASS, SLIDE_INERTIA = 0.1, (1e-4, 1e-4, 1e-4)  # kg, kg m2
SPEED = 10.0  # rad/s, of the inner ring
BOTH = ("inner", "outer")


def two_rings(
    inner: ReducedBody,
    roller: ReducedBody,
    outer: ReducedBody,
    count: int,
    *,
    rings: Collection[str] = BOTH,
    friction: float = 0.0,
    creepage: float = 0.0,
) -> Scene:
    """`count` rollers "roller 1", ... between the rings "inner" and "outer"; pairs "inner 1", "outer 1", ...

    inner, roller: reduced with the interface "bore" and the contact surface "rim"; outer: with the interface "outside"
    and the contact surface "bore", of a radius below that of `inner` and the roller's diameter; axes along y. rings:
    one of them alone has the rollers fixed in place, with half the interference. The rollers are driven slower than in
    pure rolling by `creepage` (a fraction). Raises `InputError` for a count below 1, too thin rollers, other rings.
    """
    count = require_count(count, "two_rings: count", 1)
    if not rings or set(rings) - set(BOTH):
        raise InputError(f"two_rings: rings must be one or both of {', '.join(BOTH)}, got {rings!r}")
    radius = inner.contact_surfaces["rim"].shape.radius
    own = roller.contact_surfaces["rim"].shape.radius
    bore = outer.contact_surfaces["bore"].shape.radius
    interference = require_number(
        radius + 2.0 * own - bore, "two_rings: interference of the rollers [m]", positive=True
    )
    scene = Scene(gravity=(0.0, 0.0, 0.0))
    middle = 0.5 * (radius + bore)
    places = {"inner": radius + own - 0.5 * interference, "outer": bore - own + 0.5 * interference}
    spins = {"inner": SPEED, "outer": -SPEED * radius / bore}
    surfaces = {}
    for name, body, port, surface in (("inner", inner, "bore", "rim"), ("outer", outer, "outside", "bore")):
        if name in rings:
            ring = scene.add_body(body, name=name, angular_velocity=(0.0, spins[name], 0.0))
            _driven(scene, scene.ground, ring, port, spins[name])
            surfaces[name] = ring[surface]
    back = -SPEED * (1.0 - creepage) * radius / own
    for i in range(count):
        angle = 2.0 * np.pi * i / count
        out = np.array([np.cos(angle), 0.0, np.sin(angle)])
        at = (middle if len(surfaces) == 2 else places[next(iter(surfaces))]) * out
        body = scene.add_body(roller, name=f"roller {i + 1}", position=at, angular_velocity=(0.0, back, 0.0))
        slide = scene.add_rigid_body(SLIDE_MASS, SLIDE_INERTIA, name=f"slide {i + 1}", position=at)
        center = slide.at((0.0, 0.0, 0.0))
        _driven(scene, center, body, "bore", back)
        if len(surfaces) == 2:
            scene.add(joints.Prismatic(scene.ground, center, axis=tuple(out), name=f"guide {i + 1}"))
        else:
            scene.add(joints.Fixed(scene.ground, center, name=f"guide {i + 1}"))
        for name, surface in surfaces.items():
            scene.add(
                Contact(body["rim"], surface, friction=friction, overlap=2.0 * interference, name=f"{name} {i + 1}")
            )
    return scene


def _driven(scene: Scene, holder: PortLike, body: Body, port: str, speed: float) -> None:
    axle: Joint = scene.add(joints.Revolute(holder, body[port], axis=(0, 1, 0), name=f"{body.name} axle"))
    scene.add(joints.Drive(axle, speed, quantity="velocity"))
