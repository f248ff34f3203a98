"""The two surfaces of a pair whose pressures stand on cells that travel with the patch, as the pair loads them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from warpffrf.model.contact_surface import ContactSurface
from warpffrf.model.rigid_surface import RigidSurface

Surface = ContactSurface | RigidSurface


@dataclass(frozen=True, eq=False)
class PatchSide:
    """A surface as a patch of cells loads it: no hats, no operators; `number` of the surface among those compiled,
    `rows` of cells on the first side, 0 on the second."""

    real: Surface
    number: int
    rows: int

    @property
    def shape(self) -> Any:
        """That of the surface."""
        return self.real.shape


def meridian(contact: Any, port: Any) -> tuple[float, float]:
    """Sign and offset [m] of the z that the surface of `port` counts at z of the first surface, at the start."""
    shape, own = contact.a.surface.shape, port.surface.shape
    places = [port.body.to_user(contact.a.body.to_world(shape.axis_point + z * shape.e_a)) for z in (0.0, 1.0)]
    z = [float((place - own.axis_point) @ own.e_a) for place in places]
    return (1.0 if z[1] >= z[0] else -1.0), z[0]
