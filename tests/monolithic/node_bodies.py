"""Scenes of the tests of laws at nodes."""

from __future__ import annotations

from typing import Any

from warpffrf.model import forces, joints
from warpffrf.model.contact import Contact
from warpffrf.model.reduced.body import ReducedBody
from warpffrf.model.scene import Scene

PAIR = "pair"


def on_ground(body: ReducedBody, partner: Any, *, friction: Any = 0.0, law: Any, **pose: Any) -> tuple[Scene, Any]:
    """A free flexible `body` with its one contact surface against the shape `partner` of the ground."""
    scene = Scene()
    held = scene.add_body(body, name="body", inertia="constant", **pose)
    (surface,) = body.contact_surfaces
    face = scene.ground.surface(partner, name="face")
    scene.add(Contact(held[surface], face, friction=friction, law=law, name=PAIR, overlap=1.0))
    return scene, held


def on_half_space(
    body: ReducedBody, shape: Any, load: float, *, friction: Any = 0.0, law: Any, mass: float = 0.1
) -> tuple[Scene, Any]:
    """A rigid body with the surface `shape` about its origin, pressed down by `load` [N] on a held half-space."""
    scene = Scene()
    space = scene.add_body(body, name="space")
    (surface,), (interface,) = body.contact_surfaces, body.interfaces
    scene.add(joints.Fixed(scene.ground, space[interface], name="hold"))
    radius = getattr(shape, "radius", 0.0)
    partner = scene.add_rigid_body(
        mass, (1e-4, 1e-4, 1e-4), name="partner", position=(0.0, 0.0, radius), surfaces={"face": shape}
    )
    scene.add(forces.PointForce(partner.at((0.0, 0.0, 0.0)), (0.0, 0.0, -load)))
    scene.add(Contact(space[surface], partner["face"], friction=friction, law=law, name=PAIR, overlap=1.0))
    return scene, partner
