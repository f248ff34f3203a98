"""Common part of the builders of ball and roller bearings: rings, elements, contacts, cage, in this order.

Ball bearings: deep-groove, angular-contact, four-point, self-aligning, double-row and thrust ones. Roller bearings:
cylindrical, needle, tapered, spherical, toroidal and thrust ones. A kind is a geometry
(`warpffrf.model.bearings.geometry`).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from warpffrf.model import laws, surfaces
from warpffrf.model.arguments import Vector
from warpffrf.model.bearings.bearing import ELEMENT_SURFACE, Bearing
from warpffrf.model.bearings.elements import STANDING, Cage, Elements, RigidElements, checked_elements, with_ends
from warpffrf.model.bearings.flanges import Flanges
from warpffrf.model.bearings.geometry import SIDES, BallGeometry, RollerGeometry, Track, pair
from warpffrf.model.bearings.mixed import mixed
from warpffrf.model.bearings.parts import (
    STEEL,
    AxialPreload,
    Materials,
    Place,
    RollingContact,
    checked_preload,
    contact_of,
    hollow_cylinder,
    ring_surfaces,
    sense_of,
    solid_ball,
)
from warpffrf.model.bodies import Body, Ground, Port, SurfacePort
from warpffrf.model.errors import InputError
from warpffrf.model.laws.lumped import LumpedLaw, as_lumped_law
from warpffrf.model.material import Material
from warpffrf.model.messages.named_arguments import named_arguments

if TYPE_CHECKING:
    from warpffrf.model.scene import Scene

FRICTIONLESS = RollingContact()
Ring = Body | Ground | Port | SurfacePort | tuple[SurfacePort, SurfacePort] | None


def checked_laws(label: str, law: Any, default: LumpedLaw) -> tuple[LumpedLaw, LumpedLaw]:
    """The laws on the inner and on the outer ring. Raises `InputError`."""
    first, second = (as_lumped_law(default if one is None else one, label) for one in pair(law, f"{label}: law"))
    return first, second


def checked(label: str, name: str, value: Any, kind: type) -> Any:
    """`value` if it is a `kind`. Raises `InputError`."""
    if not isinstance(value, kind):
        raise InputError(f"{label}: {name} must be bearings.{kind.__name__}(...), got {value!r}")
    return value


def refuse_name(scene: Scene, name: Any) -> None:
    """Raises `InputError` for a name that is not a text, or is used by another bearing."""
    if not isinstance(name, str) or not name or "/" in name:
        raise InputError(f"scene: the name of a bearing must be a non-empty text without '/', got {name!r}")
    if name in [bearing.name for bearing in scene.bearings]:
        raise InputError(f"scene: the name {name!r} of a bearing is taken, choose another")


def assemble(
    scene: Scene,
    bearing: Bearing,
    *,
    rings: dict[str, Any],
    offset: float = 0.0,
    elements: Elements,
    laws: tuple[LumpedLaw, LumpedLaw],
    contact: RollingContact,
    cage: Cage | None,
) -> Bearing:
    """Add the parts of `bearing` to the scene and return it.

    offset [m]: of the inner raceways in the sense of their contact angles.
    """
    if cage is not None and not isinstance(cage, Cage):
        raise InputError(
            f"bearing {bearing.name!r}: cage must be bearings.PrescribedCage(...), bearings.PocketCage(...) or None, "
            f"got {cage!r}"
        )
    geometry = bearing.geometry
    bearing.element_surface = elements.surface
    ports: dict[str, list[SurfacePort]] = {}
    for side in SIDES:
        moved = offset if side == "inner" else 0.0
        body, ports[side] = ring_surfaces(scene, side, rings[side], bearing, moved)
        setattr(bearing, side, body)
    if bearing.inner is bearing.outer:
        raise InputError(f"bearing {bearing.name!r}: inner and outer are both {bearing.inner.name!r}; name two bodies")
    for i, ((angle, track), diameter) in enumerate(zip(geometry.places, geometry.diameters, strict=True), start=1):
        bearing.elements.append(elements.add(scene, i, bearing, angle, track, float(diameter)))
    for i, (number, row) in enumerate(geometry.contacts, start=1):
        element = bearing.elements[number]
        for side, law in zip(SIDES, laws, strict=True):
            name = f"{bearing.name} {side} {i}"
            made = contact_of(element[bearing.element_surface], ports[side][row], law, contact, name)
            bearing.contacts[f"{side}_{i}"] = scene.add(made)
    if cage is not None:
        cage.hold(scene, bearing)
    scene.bearings.append(bearing)
    return bearing


@dataclass(frozen=True)
class Kind:
    """What differs between balls and rollers: mass [kg], inertia and surface of an element of a diameter [m], the
    direction of its axis and its row; its law of contact; kinds of surfaces that a flexible one may have."""

    element: Callable[[float, np.ndarray, Track], tuple[float, Any, Any]]
    law: LumpedLaw
    surfaces: tuple[str, ...]


@named_arguments
def add_bearing(
    scene: Scene,
    name: str,
    geometry: BallGeometry | RollerGeometry,
    *,
    position: Vector = (0.0, 0.0, 0.0),
    axis: Vector = (0.0, 1.0, 0.0),
    first: Vector | None = None,
    inner: Ring = None,
    outer: Ring = None,
    axial_preload: AxialPreload | None = None,
    cage: Cage | None = STANDING,
    flanges: Flanges | None = None,
    contact: RollingContact = FRICTIONLESS,
    materials: Material | Materials = STEEL,
) -> Bearing:
    """Add a rolling bearing: rings, elements, their contacts and a cage; returns them as a `Bearing`.

    geometry: `bearings.BallGeometry(...)`, `bearings.RollerGeometry(...)`, or one of these by designation,
    `bearings.catalogue("6310")`. position (3,) [m]: the centre, axis (3,), first (3,): direction of the first element
    from the axis, world axes at the initial pose; first None: +x made perpendicular to the axis. inner, outer: a rigid
    body or `scene.ground`, which get a raceway; an interface `shaft["seat"]`, or a point of a rigid body, on which a
    rigid ring is mounted; a contact surface `body["rim"]` of a flexible body, whose contact is then distributed, two of
    them of a double-row bearing; None: a rigid ring, free. Rings that are made are called "<name> inner ring".
    axial_preload: of a bearing with a contact angle or clearance, `bearings.PreloadForce(newtons)` or
    `bearings.PreloadOffset(metres)`, the preload of ISO 5593, compressive and positive. cage:
    `bearings.PrescribedCage()`, stationary elements at equal angles, `bearings.PocketCage(...)` or None. flanges:
    `bearings.Flanges(...)`, ribs that stop rollers along their axes, None for rollers that are free along them.
    contact: `bearings.RollingContact(...)`, law and friction of elements and raceways. materials: one material of rings
    and elements, or `bearings.Materials(...)`, also for flexible elements, which have a profile of their own.

    Straight rigid rollers on a flexible raceway that is wider end sharply at `roller_length`, others where the table of
    their profile does. Raises `InputError` for incompatible arguments.

    >>> spindle = wf.Scene()
    >>> support = spindle.add_bearing("6310", wf.bearings.catalogue("6310"), outer=spindle.ground)
    >>> len(support.elements), support.inner.name
    (8, '6310 inner ring')
    """
    label = f"bearing {name!r}"
    refuse_name(scene, name)
    if not isinstance(geometry, (BallGeometry, RollerGeometry)):
        raise InputError(
            f"{label}: geometry must be bearings.BallGeometry(...), bearings.RollerGeometry(...) or "
            f'bearings.catalogue("6310"), got {geometry!r}'
        )
    checked(label, "contact", contact, RollingContact)
    if flanges is not None:
        checked(label, "flanges", flanges, Flanges)
    of = materials if isinstance(materials, Materials) else Materials(materials)
    pressed, sense = checked_preload(label, axial_preload), sense_of(geometry.contact_angle)
    if axial_preload is not None and isinstance(geometry, RollerGeometry) and not geometry.contact_angle:
        raise InputError(f"{label}: rollers without a contact angle carry no axial preload; leave axial_preload out")
    place = Place.of(label, position, axis, first)
    if isinstance(geometry, BallGeometry):
        if geometry.washers and (of.element_body is not None or SurfacePort in map(type, (inner, outer))):
            raise InputError(
                f"{label}: balls between washers have lumped contacts; mount rigid washers on interfaces of the "
                "flexible bodies, outer=housing['seat'], and leave element_body out"
            )
        bearing, kind = Bearing(name, "ball", geometry, place, of.both), _balls(of, place)
    else:
        bearing, kind = Bearing(name, "roller", geometry, place, of.both), _rollers(geometry, of, (inner, outer))
    rigid = RigidElements(ELEMENT_SURFACE, kind.element)
    elements, law = checked_elements(label, of.element_body, rigid, geometry, kind.surfaces), contact.law
    if contact.distributed != "all" or contact.load is not None:
        elements, law = mixed(label, elements, bearing, contact, (inner, outer), cage)
    assemble(
        scene, bearing, rings={"inner": inner, "outer": outer}, offset=sense * pressed.offset(label),
        elements=elements, laws=checked_laws(label, law, kind.law), contact=contact, cage=cage,
    )  # fmt: skip
    pressed.press(scene, bearing, sense)
    if flanges is not None:
        flanges.hold(scene, bearing)
    return bearing


def _balls(of: Materials, place: Place) -> Kind:
    def element(diameter: float, axis: np.ndarray, track: Track) -> tuple[float, Any, Any]:
        ball = surfaces.Sphere(radius=0.5 * diameter, axis_point=(0.0, 0.0, 0.0), axis_direction=place.axis)
        return (*solid_ball(diameter, of.both[0]), ball)

    return Kind(element, laws.HertzPoint(*of.both), ("sphere", "crowned_cylinder"))


ROUND_OFF = 1e-6  # of the length of a roller


def _rollers(geometry: RollerGeometry, of: Materials, rings: tuple[Any, Any]) -> Kind:
    shaped, length = geometry, geometry.roller_length
    straight = geometry.profile is None and not geometry.taper
    if straight and any(_width(ring) > length * (1.0 + ROUND_OFF) for ring in rings):
        shaped = replace(geometry, profile=with_ends(length))

    def element(diameter: float, axis: np.ndarray, track: Track) -> tuple[float, Any, Any]:
        shape = shaped.roller(diameter, track, {"axis_point": (0.0, 0.0, 0.0), "axis_direction": axis})
        return (*hollow_cylinder(0.0, diameter, length, of.both[0], axis), shape)

    law = laws.IsoLamina(length, profile=geometry.profile is None)
    return Kind(element, law, ("cylinder", "crowned_cylinder", "profiled_cylinder", "cone"))


def _width(ring: Any) -> float:
    """Of a flexible raceway along its axis [m]; 0 of others."""
    grid = ring.surface.grid if isinstance(ring, SurfacePort) else None
    return 0.0 if grid is None else float(np.ptp(grid.z))
