"""The two surfaces of a pair on a contact-fixed grid, as the pair loads them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from warpffrf.model.reduced.contact_surface import ContactSurface
from warpffrf.model.rigid_surface import RigidSurface

Surface = ContactSurface | RigidSurface
PARALLEL = 1e-9  # sine of the angle between two axes


@dataclass(frozen=True, eq=False)
class PatchSide:
    """A surface as a patch of cells loads it: no nodes, no operators; `number` of the surface among those compiled,
    `rows` of cells on the first side, 0 on the second.
    """

    real: Surface
    number: int
    rows: int

    @property
    def shape(self) -> Any:
        """That of the surface."""
        return self.real.shape


def meridian(contact: Any, port: Any) -> tuple[float, float]:
    """Sign and offset [m] of the z of the surface of `port` as a function of z of the first surface, where they face
    each other at the start.
    """
    shape, own = contact.a.surface.shape, port.surface.shape
    places = [port.body.to_user(contact.a.body.to_world(shape.axis_point + z * shape.e_a)) for z in (0.0, 1.0)]
    z = [float((place - own.axis_point) @ own.e_a) for place in places]
    lean = float(levers(contact)[0] @ in_world(port, own.e_a)) if port is contact.b else 0.0
    return (1.0 if z[1] >= z[0] else -1.0), z[0] + lean


def levers(contact: Any) -> Any:
    """From the axis of each surface, in its middle, to the point where it faces the other one at the start (2, 3) [m],
    in world axes; zero from planes, and all zero for parallel axes, along which they have no effect.
    """
    ports, found = contact.ports, np.zeros((2, 3))
    shapes = [port.surface.shape for port in ports]
    axes = [in_world(port, shape.e_a) for port, shape in zip(ports, shapes, strict=True)]
    if np.linalg.norm(np.cross(*axes)) <= PARALLEL:
        return found
    planar = [shape.profile().planar for shape in shapes]
    middles = [middle_of(port.surface) for port in ports]
    places = [
        port.body.to_world(shape.axis_point + z * shape.e_a)
        for port, shape, z in zip(ports, shapes, middles, strict=True)
    ]
    for i, way in enumerate((places[1] - places[0], places[0] - places[1])):
        if planar[i]:
            continue
        if planar[1 - i]:
            towards = -in_world(ports[1 - i], facing(ports[1 - i], ports[i]))
        else:
            towards = shapes[1 - i].side * way
        across = towards - (towards @ axes[i]) * axes[i]
        length = float(np.linalg.norm(across))
        if length > 0.0:
            found[i] = float(shapes[i].radius_at(middles[i])) / length * across
    return found


def facing(port: Any, other: Any) -> np.ndarray:
    """Normal (3,), user frame, of the plane or extruded surface `port` where it is nearest to the middle of another."""
    shape, round_ = port.surface.shape, other.surface.shape
    middle = other.body.to_world(round_.axis_point + middle_of(other.surface) * round_.e_a)
    theta, z, _ = shape.chart(port.body.to_user(middle))
    return shape.normal(theta, z)


def in_world(port: Any, vector: Any) -> Any:
    """A vector (3,) in the user frame of the body of `port`, in world axes at the start."""
    return port.body.to_world(vector) - port.body.to_world(np.zeros(3))


def middle_of(surface: Surface) -> float:
    """The middle [m] of the meridian of a surface."""
    return 0.0 if surface.grid is None else float(np.mean(np.asarray(surface.grid.z)[[0, -1]]))
