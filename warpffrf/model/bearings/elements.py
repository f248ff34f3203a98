"""Rolling elements of a bearing: rigid ones, or a reduced body that stands at every place.

A flexible element is a body of revolution about its contact surface's axis with its centre of mass in the origin of its
mesh, as `mesh.roller(radius, 0.0, length, ...)` makes them, with `crown_radius=radius` and a `tread` a ball. It is
added with that axis along the bearing's, the surface's reference direction e_0 outwards; a ball of an angular-contact
bearing is tilted by the contact angle, so that both raceways press on its tread, where it rolls, too. Both press on the
one surface: two patches that feel each other through the element (`warpffrf.online.compile.patches.several`).

A cage holds an element by its centre. A flexible body has no points: there it takes the interface whose reference point
is the centre, the mean motion of both ends of a roller, `interfaces={"ends": "average"}`.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from scipy.spatial.transform import Rotation

from warpffrf.model.bearings.parts import Place
from warpffrf.model.bodies import Body, Port
from warpffrf.model.errors import InputError
from warpffrf.model.reduced.body import ReducedBody

if TYPE_CHECKING:
    from warpffrf.model.scene import Scene

CENTRED = 1e-4  # of the diameter: what a mesh makes of a centre that is the origin
SAME = 1e-3  # of the diameter


@dataclass(frozen=True)
class Elements(ABC):
    """What the elements of a bearing are; `surface` is what the contact surface of each is called."""

    surface: str

    @abstractmethod
    def add(self, scene: Scene, name: str, place: Place, radius: float, angle: float, diameter: float) -> Body:
        """Add one at `angle` [rad] on the circle of `radius` [m] to the scene."""


@dataclass(frozen=True)
class RigidElements(Elements):
    """Rigid bodies. of: mass, inertia and shape of an element of a diameter [m] about its centre, world axes."""

    of: Callable[[float], tuple[float, Any, Any]]

    def add(self, scene: Scene, name: str, place: Place, radius: float, angle: float, diameter: float) -> Body:
        mass, inertia, shape = self.of(diameter)
        return scene.add_rigid_body(
            mass, inertia, name=name, position=place.center + radius * place.outward(angle),
            surfaces={self.surface: shape},
        )  # fmt: skip


@dataclass(frozen=True)
class FlexibleElements(Elements):
    """One reduced body at all places; tilt [rad]: of its axis from the bearing's, that of the line of contact from the
    radius."""

    body: ReducedBody
    tilt: float = 0.0

    def add(self, scene: Scene, name: str, place: Place, radius: float, angle: float, diameter: float) -> Body:
        shape = self.body.contact_surfaces[self.surface].shape
        c, s, out = np.cos(self.tilt), np.sin(self.tilt), place.outward(angle)
        wanted = np.stack([c * out + s * place.axis, place.around(angle), c * place.axis - s * out])
        return scene.add_body(
            self.body, name=name, position=place.center + radius * place.outward(angle),
            rotation=Rotation.from_matrix(wanted.T @ shape.frame).as_quat(),
        )  # fmt: skip


def checked_elements(
    label: str,
    given: Any,
    rigid: RigidElements,
    diameter: float,
    kinds: tuple[str, ...],
    deviations: np.ndarray,
    tilt: float = 0.0,
) -> Elements:
    """`rigid` where `given`, the reduced body of all elements, is None. kinds: of the surfaces that go; tilt
    [rad]: of a flexible one's axis. Raises `InputError` for what is no element of this bearing."""
    if given is None:
        return rigid
    name = f"{label}: element_body"
    if not isinstance(given, ReducedBody):
        raise InputError(f"{name} must be a reduced body, reduce(mesh, material, contact=...), or None, got {given!r}")
    if len(given.contact_surfaces) != 1:
        raise InputError(
            f"{name}: an element has one contact surface all around, {given} has {len(given.contact_surfaces)}"
        )
    surface, shape = next((name, one.shape) for name, one in given.contact_surfaces.items())
    if shape.kind not in kinds or abs(2.0 * shape.radius - diameter) > SAME * diameter:
        raise InputError(
            f"{name}: its surface is a {shape.kind} of diameter {2.0 * shape.radius:.6g} m, and the elements have "
            f"{diameter:.6g} m and are one of {', '.join(kinds)}"
        )
    along = shape.e_a if shape.kind != "sphere" else np.zeros(3)  # a sphere has a centre, a cylinder none
    off = shape.axis_point - (shape.axis_point @ along) * along
    apart = max(float(np.linalg.norm(given.center_of_mass)), float(np.linalg.norm(off)))
    if apart > CENTRED * diameter:
        raise InputError(
            f"{name}: its centre of mass and its surface's centre must be the origin of its mesh, they are {apart:.3g} "
            "m off; move the mesh"
        )
    if np.any(deviations):
        raise InputError(f"{label}: diameter_deviations are of rigid elements; element_body is one body for all places")
    return FlexibleElements(surface, given, tilt)


def centre_of(element: Body, label: str) -> Port:
    """The place by which a cage holds an element. Raises `InputError` for a flexible one without."""
    if element.reduced is None:
        return element.at((0.0, 0.0, 0.0))
    surface = next(iter(element.reduced.contact_surfaces.values()))
    for name, interface in element.reduced.interfaces.items():
        if np.linalg.norm(interface.point) <= CENTRED * 2.0 * float(surface.shape.radius):
            return element[name]
    raise InputError(
        f"{label}: the flexible element {element.name!r} has no interface at its centre to be held by; reduce it with "
        'one whose nodes have their mean there, of a roller interfaces={"ends": "average"}, or leave the cage out'
    )
