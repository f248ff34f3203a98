"""Rolling elements of a bearing: rigid ones, or one reduced body at all positions.

A flexible element is a body of revolution about its contact surface's axis with its centre of mass in the origin of its
mesh, as `mesh.roller(radius, 0.0, length, ...)` makes them, with `crown_radius=radius` and a `tread` a ball. It is
added with that axis along the bearing's, the surface's reference direction e_0 outwards; a ball of an angular-contact
bearing is tilted by the contact angle, so that both raceways press on its tread, where it rolls, too. Both press on the
one surface: two patches coupled through the element (`warpffrf.online.compile.patches.several`).

A cage guides an element at its centre; a flexible element, which has no points, at the interface whose reference point
is the centre, the mean motion of both ends of a roller, `interfaces={"ends": "average"}`.

Cages: separation of the rolling elements.

Without a cage, raceways push every loaded element that is off the line of the load out of the load zone, and there is
no equilibrium. A kind of cage is a class with `hold`, which adds its parts to the bearing.

    PrescribedCage    elements at equal angles in a frame whose rotation is prescribed: at rest, or with a given speed
    PocketCage        a body that rotates as elements push it: each has play in a pocket, and friction there

A pocket of `PocketCage` is a cup around a ball, and two planes before and behind a roller. On a flexible cage, which
has no points, the walls belong to small rigid bodies that are fixed to its interfaces: each wall to the nearest one, as
the pockets of a cage for balls or the bars between rollers.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import KW_ONLY, dataclass
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np
from scipy.spatial.transform import Rotation

from warpffrf.model import laws, surfaces
from warpffrf.model import rotation as rot
from warpffrf.model.bearings.geometry import Geometry, Track
from warpffrf.model.bearings.parts import RollingContact, contact_of
from warpffrf.model.bodies import Body, Port, PortLike, as_port
from warpffrf.model.errors import InputError, require_number
from warpffrf.model.friction import FrictionLike
from warpffrf.model.joints import Drive, Fixed, LineInPlane, PointInPlane, Revolute
from warpffrf.model.laws.lumped import LumpedLaw
from warpffrf.model.messages.named_arguments import named_arguments
from warpffrf.model.reduced.body import ReducedBody
from warpffrf.model.signals import SignalLike

if TYPE_CHECKING:
    from warpffrf.model.bearings.bearing import Bearing
    from warpffrf.model.scene import Scene

CENTRED = 1e-4  # of the diameter: tolerance of a mesh's centre of mass from the origin
SAME = 1e-3  # of the diameter
EDGE = 0.005  # of the length of a roller: at its ends, where it drops by as much


def with_ends(length: float) -> tuple[np.ndarray, np.ndarray]:
    """Table of a straight roller that drops within `EDGE` of its ends [m]."""
    edge, half = EDGE * length, 0.5 * length
    return np.array([-half, edge - half, half - edge, half]), np.array([edge, 0.0, 0.0, edge])


@dataclass(frozen=True)
class Elements(ABC):
    """Definition of the elements of a bearing; `surface` is the name of the contact surface of each."""

    surface: str

    @abstractmethod
    def add(self, scene: Scene, number: int, bearing: Bearing, angle: float, track: Track, diameter: float) -> Body:
        """Add that of a number, from 1, of the diameter [m] in the row `track` at `angle` [rad] on the pitch circle to
        the scene."""

    @staticmethod
    def name(number: int, bearing: Bearing) -> str:
        """Of its body."""
        return f"{bearing.name} {bearing.kind} {number}"


@dataclass(frozen=True)
class RigidElements(Elements):
    """Rigid bodies. of: mass, inertia and shape about its centre, world axes, of an element of a diameter [m], the
    direction (3,) of its axis and its row."""

    of: Callable[[float, np.ndarray, Track], tuple[float, Any, Any]]

    def add(self, scene: Scene, number: int, bearing: Bearing, angle: float, track: Track, diameter: float) -> Body:
        mass, inertia, shape = self.of(diameter, bearing.element_axis(angle, track), track)
        return scene.add_rigid_body(
            mass, inertia, name=self.name(number, bearing), position=bearing.element_center(angle, track),
            surfaces={self.surface: shape},
        )  # fmt: skip


@dataclass(frozen=True)
class FlexibleElements(Elements):
    """One reduced body at all positions, or at those of the numbers `distributed`: others are rigid, of its shape;
    end: whether straight ones end at their length, for raceways that are flexible and may be wider."""

    body: ReducedBody
    distributed: frozenset[int] | None = None
    end: bool = False

    def add(self, scene: Scene, number: int, bearing: Bearing, angle: float, track: Track, diameter: float) -> Body:
        body, surface = self.body, self.body.contact_surfaces[self.surface]
        shape: Any = surface.shape
        axis, around = bearing.element_axis(angle, track), bearing.place.around(angle)
        wanted = np.stack([np.cross(around, axis), around, axis])
        placed: Any = {
            "name": self.name(number, bearing), "position": bearing.element_center(angle, track),
            "rotation": Rotation.from_matrix(wanted.T @ shape.frame).as_quat(),
        }  # fmt: skip
        if self.distributed is None or number in self.distributed:
            return scene.add_body(body, **placed)
        if self.end and shape.kind == "cylinder":
            length = float(np.ptp(surface.grid.z))
            of = {"radius": shape.radius, "axis_point": shape.axis_point, "axis_direction": shape.e_a}
            shape = surfaces.ProfiledCylinder(table=with_ends(length), **of)
        center = body.center_of_mass
        return scene.add_rigid_body(
            body.mass, body.inertia, center_of_mass=center, surfaces={self.surface: shape}, **placed
        )


def checked_elements(
    label: str, given: Any, rigid: RigidElements, geometry: Geometry, kinds: tuple[str, ...]
) -> Elements:
    """`rigid` where `given`, the reduced body of all elements, is None. kinds: of the admissible surfaces. Raises
    `InputError` for elements that do not fit this bearing."""
    if given is None:
        return rigid
    name, diameter = f"{label}: element_body", geometry.diameter
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
    if np.any(geometry.diameters != diameter):
        raise InputError(
            f"{label}: diameter_deviations are of rigid elements; element_body is one body for all elements"
        )
    return FlexibleElements(surface, given)


def centre_of(element: Body, label: str) -> Port:
    """The port by which a cage guides an element. Raises `InputError` for a flexible one without."""
    if element.reduced is None:
        return element.at((0.0, 0.0, 0.0))
    surface = next(iter(element.reduced.contact_surfaces.values()))
    for name, interface in element.reduced.interfaces.items():
        if np.linalg.norm(interface.point) <= CENTRED * 2.0 * float(surface.shape.radius):
            return element[name]
    raise InputError(
        f"{label}: the flexible element {element.name!r} has no interface at its centre for the cage; reduce it with "
        'one whose nodes have their mean there, of a roller interfaces={"ends": "average"}, or leave the cage out'
    )


LIGHT = 0.2  # of the mass of all elements: a cage of sheet steel
POCKET_STIFFNESS = 1e9  # N/m^1.5: 10 N press 5 um into it
SMALL = 1e-6  # of the mass of a flexible cage: that of what carries the walls of a pocket
POCKET_LAMINAE = 5  # of a roller on the wall of its pocket, so that a skewed one is realigned


@dataclass(frozen=True)
class Cage(ABC):
    """Common base of cages: mass [kg], None for a fifth of that of the elements, distributed along the pitch circle;
    guide: the port that the cage rotates about (`body.at(point)`, `body["interface"]`), None for the outer ring, or the
    ground where that is flexible."""

    _: KW_ONLY
    mass: float | None = None
    guide: PortLike | None = None
    kind: ClassVar[str] = ""

    @abstractmethod
    def hold(self, scene: Scene, bearing: Bearing) -> None:
        """Add the cage to the scene and to `bearing`. Raises `InputError` for a cage that does not fit."""

    def ring(self, scene: Scene, bearing: Bearing) -> Body:
        """Add its body to the `scene`, a thin ring on the pitch circle, which becomes the cage of the `bearing`. Raises
        `InputError` for a mass that is not positive."""
        label = f"bearing {bearing.name!r}: cage"
        total = sum(element.mass for element in bearing.elements)
        mass = LIGHT * total if self.mass is None else require_number(self.mass, f"{label}: mass [kg]", positive=True)
        axis = bearing.place.axis
        about = mass * (0.5 * bearing.geometry.pitch_diameter) ** 2
        inertia = 0.5 * about * (np.eye(3) + np.outer(axis, axis))
        body = scene.add_rigid_body(mass, inertia, name=f"{bearing.name} cage", position=bearing.place.center)
        bearing.cage = body
        return body

    def axle(self, scene: Scene, bearing: Bearing, body: Body) -> Revolute:
        """Add the joint to the `scene` about which the `body` of the cage rotates, "cage_axle" of the `bearing`. Raises
        `InputError` for a guide that is no port."""
        label = f"bearing {bearing.name!r}: cage: guide"
        center, guide = bearing.place.center, self.guide
        if guide is None:
            outer = bearing.outer
            guide = scene.ground.at(center) if outer.reduced is not None else outer.at(outer.to_user(center))
        held = body.at(body.to_user(center)) if body.reduced is None else body[interface_at(body, center, bearing)]
        axle = Revolute(
            as_port(guide, label), held, axis=bearing.place.axis, point=center, name=f"{bearing.name} cage axle"
        )
        bearing.joints["cage_axle"] = scene.add(axle)
        return axle


@named_arguments
@dataclass(frozen=True)
class PrescribedCage(Cage):
    """Elements at equal angles in a frame that rotates with `speed` [rad/s], a number or a signal; 0 is stationary.

    The centre of an element stays in a plane through the axis, in which it is free; a roller's axis stays in it, too.
    The force of the element is the reaction of the joint `bearing.joints["pocket_3"]`. `bearing.drive.signal` may be
    changed afterwards. `bearing.orbit_speed(...)` is the speed of elements that roll.
    """

    speed: SignalLike = 0.0
    kind: ClassVar[str] = "prescribed_cage"

    def hold(self, scene: Scene, bearing: Bearing) -> None:
        body = self.ring(scene, bearing)
        axle = self.axle(scene, bearing, body)
        bearing.drive = scene.add(Drive(axle, self.speed, name=f"{bearing.name} cage drive"))
        place = bearing.place
        for i, (element, (angle, track)) in enumerate(zip(bearing.elements, bearing.geometry.places, strict=True), 1):
            ports = body.at((0.0, 0.0, 0.0)), centre_of(element, f"bearing {bearing.name!r}: PrescribedCage")
            name, across = f"{bearing.name} pocket {i}", place.around(angle)
            if bearing.kind == "roller":
                joint = LineInPlane(*ports, axis=across, line=bearing.element_axis(angle, track), name=name)
            else:
                joint = PointInPlane(*ports, axis=across, name=name)
            bearing.joints[f"pocket_{i}"] = scene.add(joint)


@named_arguments
@dataclass(frozen=True)
class PocketCage(Cage):
    """A body with a pocket for each element, with the diametral `clearance` [m].

    law: of the force of a rigid element in a pocket, a lumped law: of a ball None for PowerForce(1e9, 1.5), of a
    roller, whose laminae each meet the wall, None for PalmgrenLine; flexible ones have distributed contact. friction:
    of elements in their pockets. guided: whether the cage is kept on the axis by a joint without friction, as on a land
    of the guide; else its pockets alone support it, which is possible for balls. body: a body of the scene at the pose
    of the bearing that is the cage, None for a rigid ring of the `mass`. A flexible one, of `mesh.cage` or another
    mesh, has an interface on each pocket for balls, on each bar or wall for rollers, and one around the axis that
    guides it, "average" ones so that they stay elastic.

    Contacts are `bearing.contacts["pocket_3"]`, of rollers ["pocket_3_front"] and ["pocket_3_back"]; what fixes walls
    to the interface "bar_3" of a flexible body is `bearing.joints["seat_bar_3"]`.
    """

    clearance: float
    _: KW_ONLY
    law: LumpedLaw | None = None
    friction: FrictionLike = 0.0
    guided: bool = True
    body: Body | None = None
    kind: ClassVar[str] = "pocket_cage"

    def hold(self, scene: Scene, bearing: Bearing) -> None:
        """Add the cage to `scene` and `bearing`. Raises `InputError` for pockets that overlap, or smaller than the
        elements, and for a body without interfaces for them."""
        label = f"bearing {bearing.name!r}: PocketCage"
        play = require_number(self.clearance, f"{label}: clearance [m]")
        D, apart = bearing.geometry.diameter, bearing.geometry.apart
        if play < 0.0:
            raise InputError(
                f"{label}: pockets of {D + play:.6g} m are smaller than the elements, whose diameter is {D:g} m; the "
                "clearance is the pocket's size less the element's, and not negative"
            )
        if bearing.kind == "roller" and D + play > apart:
            raise InputError(
                f"{label}: pockets of {D + play:.4g} m overlap, the elements are {apart:.4g} m apart; use less "
                "clearance than their distance less their diameter"
            )
        if bearing.kind == "roller" and not self.guided:
            raise InputError(
                f"{label}: rollers do not guide a cage along their axes or against tilting; leave guided=True"
            )
        bearing.cage = body = self._given(label) or self.ring(scene, bearing)
        if self.guided:
            self.axle(scene, bearing, body)
        for i, element in enumerate(bearing.elements, start=1):
            for name, (at, outward) in self._walls(bearing, i, 0.5 * (D + play)).items():
                carrier = body if body.reduced is None else _seat(scene, bearing, body, at)
                turn = rot.matrix(carrier.rotation).T
                middle, axis = carrier.to_user(at), turn @ bearing.place.axis
                shape = (
                    surfaces.Cup(radius=0.5 * (D + play), axis_point=middle, axis_direction=axis)
                    if bearing.kind == "ball"
                    else surfaces.Plane(origin=middle, outward=turn @ outward, direction=axis)
                )
                contact = contact_of(
                    element[bearing.element_surface], carrier.surface(shape, name=name.replace("_", " ")),
                    self._law(bearing), RollingContact(friction=self.friction),
                    f"{bearing.name} {name.replace('_', ' ')}",
                )  # fmt: skip
                bearing.contacts[name] = scene.add(contact)

    def _given(self, label: str) -> Body | None:
        """`body`. Raises `InputError` for one that is no body, and for a mass that is given, too."""
        if self.body is not None and not isinstance(self.body, Body):
            raise InputError(
                f"{label}: body must be a body of the scene, scene.add_body(reduced, name=...), or None, got "
                f"{self.body!r}"
            )
        if self.body is not None and self.mass is not None:
            raise InputError(f"{label}: body {self.body.name!r} has a mass of its own; leave mass out")
        return self.body

    def _law(self, bearing: Bearing) -> LumpedLaw:
        if self.law is not None:
            return self.law
        if bearing.kind == "roller":
            return laws.PalmgrenLine(bearing.geometry.roller_length, POCKET_LAMINAE)  # pyright: ignore[reportAttributeAccessIssue]
        return laws.PowerForce(POCKET_STIFFNESS, 1.5)

    @staticmethod
    def _walls(bearing: Bearing, i: int, half: float) -> dict[str, tuple[np.ndarray, np.ndarray]]:
        """Walls of the pocket of element i: name -> middle (3,) [m] and direction (3,) towards the element, world."""
        angle, track = bearing.geometry.places[i - 1]
        around, center = bearing.place.around(angle), bearing.element_center(angle, track)
        if bearing.kind == "ball":
            return {f"pocket_{i}": (center, np.zeros(3))}
        sides = (("front", 1.0), ("back", -1.0))
        return {f"pocket_{i}_{name}": (center + sign * half * around, -sign * around) for name, sign in sides}


def interface_at(body: Body, at: np.ndarray, bearing: Bearing) -> str:
    """Name of the interface of a flexible cage that is nearest to a point (3,) [m, world]. Raises `InputError` for one
    that is further away than half a ball, or half the distance of two rollers, whose bars are thinner."""
    reach = 0.5 * (bearing.geometry.diameter if bearing.kind == "ball" else bearing.geometry.apart)
    away = {name: np.linalg.norm(body.to_world(one.point) - at) for name, one in body.flexible.interfaces.items()}
    name = min(away, key=lambda name: away[name], default="")
    if name and away[name] <= reach:
        return name
    needed = "each pocket" if bearing.kind == "ball" else "each bar"
    raise InputError(
        f"bearing {bearing.name!r}: PocketCage: body {body.name!r} has no interface near "
        f"({', '.join(f'{x:.4g}' for x in at)}) m; add it at the pose of the bearing, and reduce it with interfaces on "
        f"{needed}, and one that guides it, around the axis"
    )


def _seat(scene: Scene, bearing: Bearing, body: Body, at: np.ndarray) -> Body:
    """The rigid body on the interface of the flexible `body` of a cage that is nearest to a point (3,) [m, world]."""
    interface = interface_at(body, at, bearing)
    if interface not in bearing.pockets:
        mass, place = SMALL * body.mass, body.to_world(body.flexible.interfaces[interface].point)
        inertia = (mass * (0.5 * bearing.geometry.diameter) ** 2,) * 3
        part = scene.add_rigid_body(mass, inertia, name=f"{bearing.name} cage {interface}", position=place)
        fixed = Fixed(body[interface], part, axis=bearing.place.axis, name=f"{bearing.name} seat {interface}")
        bearing.joints[f"seat_{interface}"] = scene.add(fixed)
        bearing.pockets[interface] = part
    return bearing.pockets[interface]


STANDING = PrescribedCage()  # where no cage is given
