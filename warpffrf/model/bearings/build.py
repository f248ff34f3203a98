"""Common part of the builders of ball and roller bearings: rings, elements, contacts, cage, in this order.

Ball bearings: deep-groove, angular-contact, four-point, self-aligning and double-row ones. Roller bearings:
cylindrical, needle, tapered, spherical, toroidal and thrust ones. A kind is a geometry
(`warpffrf.model.bearings.geometry`).
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from warpffrf.model import laws, surfaces
from warpffrf.model.arguments import Vector
from warpffrf.model.bearings.bearing import ELEMENT_SURFACE, Bearing
from warpffrf.model.bearings.elements import STANDING, Cage, Elements, RigidElements, checked_elements
from warpffrf.model.bearings.flanges import Flanges
from warpffrf.model.bearings.geometry import SIDES, BallGeometry, RollerGeometry, Track, pair
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
        named = f"{bearing.name} {bearing.kind} {i}"
        bearing.elements.append(elements.add(scene, named, bearing, angle, track, float(diameter)))
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


KINDS = ("sphere", "crowned_cylinder")  # of surfaces of flexible elements


@named_arguments
def add_ball_bearing(
    scene: Scene,
    name: str,
    geometry: BallGeometry,
    *,
    position: Vector = (0.0, 0.0, 0.0),
    axis: Vector = (0.0, 1.0, 0.0),
    first: Vector | None = None,
    inner: Ring = None,
    outer: Ring = None,
    axial_preload: AxialPreload | None = None,
    cage: Cage | None = STANDING,
    contact: RollingContact = FRICTIONLESS,
    materials: Material | Materials = STEEL,
) -> Bearing:
    """Add a ball bearing: rings, balls, their contacts and a cage; returns them as a `Bearing`.

    geometry: `bearings.BallGeometry(...)`. position (3,) [m]: the centre, axis (3,), first (3,): direction of the first
    ball from the axis, world axes at the initial pose; first None: +x made perpendicular to the axis. inner, outer: a
    rigid body or `scene.ground`, which get a raceway; an interface `shaft["seat"]`, or a point of a rigid body, on
    which a rigid ring is mounted; a contact surface `body["rim"]` of a flexible body, whose contact is then
    distributed, two of them of a double-row bearing; None: a rigid ring, free. Rings that are made are called "<name>
    inner ring".
    axial_preload: `bearings.PreloadForce(newtons)` or `bearings.PreloadOffset(metres)`, the preload of ISO 5593,
    compressive and positive. cage: `bearings.PrescribedCage()`, stationary balls at equal angles,
    `bearings.PocketCage(...)` or None. contact: `bearings.RollingContact(...)`, law and friction of balls and raceways.
    materials: one material of rings and balls, or `bearings.Materials(...)`, also for flexible balls.

    Raises `InputError` for incompatible arguments.
    """
    label = f"bearing {name!r}"
    refuse_name(scene, name)
    checked(label, "geometry", geometry, BallGeometry)
    checked(label, "contact", contact, RollingContact)
    of = materials if isinstance(materials, Materials) else Materials(materials)
    pressed, sense = checked_preload(label, axial_preload), sense_of(geometry.contact_angle)
    place = Place.of(label, position, axis, first)
    bearing = Bearing(name, "ball", geometry, place, of.both)

    def element_of(diameter: float, axis: np.ndarray, track: Track) -> tuple[float, Any, Any]:
        ball = surfaces.Sphere(radius=0.5 * diameter, axis_point=(0.0, 0.0, 0.0), axis_direction=place.axis)
        return (*solid_ball(diameter, of.both[0]), ball)

    rigid = RigidElements(ELEMENT_SURFACE, element_of)
    assemble(
        scene, bearing, rings={"inner": inner, "outer": outer}, offset=sense * pressed.offset(label),
        elements=checked_elements(label, of.element_body, rigid, geometry, KINDS),
        laws=checked_laws(label, contact.law, laws.HertzPoint(*of.both)), contact=contact, cage=cage,
    )  # fmt: skip
    pressed.press(scene, bearing, sense)
    return bearing


ROLLER_KINDS = ("cylinder", "crowned_cylinder", "profiled_cylinder", "cone")  # of surfaces of flexible elements


@named_arguments
def add_roller_bearing(
    scene: Scene,
    name: str,
    geometry: RollerGeometry,
    *,
    position: Vector = (0.0, 0.0, 0.0),
    axis: Vector = (0.0, 1.0, 0.0),
    first: Vector | None = None,
    inner: Ring = None,
    outer: Ring = None,
    cage: Cage | None = STANDING,
    flanges: Flanges | None = None,
    contact: RollingContact = FRICTIONLESS,
    materials: Material | Materials = STEEL,
) -> Bearing:
    """Add a roller bearing: rings, rollers, their contacts and a cage; returns them as a `Bearing`.

    geometry: `bearings.RollerGeometry(...)`. flanges: `bearings.Flanges(...)`, ribs that stop the rollers along their
    axes, None for rollers that are free along them. As of `add_ball_bearing`: scene, name, position [m], axis and first
    (3,), directions in the world, inner, outer, cage, contact and materials; an element_body has a profile of its own.
    Raises `InputError` for incompatible arguments.
    """
    label = f"bearing {name!r}"
    refuse_name(scene, name)
    checked(label, "geometry", geometry, RollerGeometry)
    checked(label, "contact", contact, RollingContact)
    of = materials if isinstance(materials, Materials) else Materials(materials)
    place = Place.of(label, position, axis, first)
    bearing = Bearing(name, "roller", geometry, place, of.both)

    def element_of(diameter: float, axis: np.ndarray, track: Track) -> tuple[float, Any, Any]:
        shape = geometry.roller(diameter, track, {"axis_point": (0.0, 0.0, 0.0), "axis_direction": axis})
        return (*hollow_cylinder(0.0, diameter, geometry.roller_length, of.both[0], axis), shape)

    default = laws.IsoLamina(geometry.roller_length, profile=geometry.profile is None)
    if flanges is not None and not isinstance(flanges, Flanges):
        raise InputError(f"{label}: flanges must be bearings.Flanges(...) or None, got {flanges!r}")
    rigid = RigidElements(ELEMENT_SURFACE, element_of)
    assemble(
        scene, bearing, rings={"inner": inner, "outer": outer},
        elements=checked_elements(label, of.element_body, rigid, geometry, ROLLER_KINDS),
        laws=checked_laws(label, contact.law, default), contact=contact, cage=cage,
    )  # fmt: skip
    if flanges is not None:
        flanges.hold(scene, bearing)
    return bearing
