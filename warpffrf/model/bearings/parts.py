r"""Parts of a rigid bearing: its position, masses of its rings and elements, and a contact between two of them.

Masses are those of solid balls and rollers, and of rings that are hollow cylinders of steel: with the pitch diameter
d_pw, the diameter D of an element and the width b, the defaults are

    bore d_pw - 1.6 D,    outside diameter d_pw + 1.6 D,    shoulders at d_pw -+ 0.4 D,    width 1.5 D,

the proportions of a deep-groove bearing of the medium series; of rollers the width is their length and 0.4 D.

Axial preload of ball bearings: the rings are pressed against each other in the sense of the contact angle. It is the
preload of ISO 5593, a compressive load of the rolling elements by axial adjustment, positive; the preload of bolts and
springs in `warpffrf.forces` is a tension.

    PreloadForce     a force of given size: a spring between the rings
    PreloadOffset    raceways that are offset on their rings, as ground on paired bearings: rings whose faces
                     are flush, or that a nut pulls together, then press with the reaction of the balls

A kind of preload is a class with `offset`, the axial offset of the inner raceway from its free position, and `press`,
which adds forces. The sense is that in which thrust on the inner ring presses the bearing together: along the axis, or
against it where the contact angle is negative. With the distance A of groove centres that touch and the free angle
alpha_0, rings that are pressed by u along the axis have

    tan alpha = (A sin alpha_0 + u)/(A cos alpha_0),      Q = K ((A cos alpha_0)/cos alpha - A)^(3/2),      F = Z Q sin
    alpha.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from warpffrf.model.arguments import Vector
from warpffrf.model.bearings.geometry import Geometry, Track
from warpffrf.model.bearings.rating import is_thrust
from warpffrf.model.bodies import Body, Ground, Port, SurfacePort
from warpffrf.model.contact import Contact
from warpffrf.model.errors import InputError, require_array, require_direction, require_number
from warpffrf.model.forces import PointForce
from warpffrf.model.friction import FrictionLike
from warpffrf.model.joints import Fixed
from warpffrf.model.laws.lumped import LumpedLaw
from warpffrf.model.lumped_contact import LumpedContact
from warpffrf.model.material import Material
from warpffrf.model.messages.named_arguments import named_arguments
from warpffrf.model.moments import RollingResistance
from warpffrf.model.reduced.body import ReducedBody
from warpffrf.model.surfaces import Shape
from warpffrf.model.surfaces.fit import reference_direction
from warpffrf.model.surfaces.form_deviations import Form, RoundForm

if TYPE_CHECKING:
    from warpffrf.model.bearings.bearing import Bearing
    from warpffrf.model.scene import Scene

STEEL = Material(210e9, 0.3, 7850.0, name="steel")
DEEP, SHOULDER = 1.6, 0.4  # of the diameter of an element
PERPENDICULAR = 1e-6  # cosine of `first` and the axis: six digits typed


@dataclass(frozen=True)
class Place:
    """Position of a bearing in the world at the initial pose: `center` (3,) [m] and the rows of `axes` (3, 3): the
    direction of the first element, the one a quarter revolution further, and the axis."""

    center: np.ndarray
    axes: np.ndarray

    @classmethod
    def of(cls, label: str, center: Any, axis: Any, first: Any) -> Place:
        """A checked one; first: None for +x made perpendicular to the axis. Raises `InputError`."""
        at = require_array(center, f"{label}: position", (3,))
        along = require_direction(axis, f"{label}: axis")
        towards = reference_direction(along) if first is None else require_direction(first, f"{label}: first")
        cosine = float(towards @ along)
        if abs(cosine) > PERPENDICULAR:
            raise InputError(
                f"{label}: first, the direction of the first element from the axis, must be perpendicular to the axis"
            )
        towards = require_direction(towards - cosine * along, f"{label}: first")
        return cls(at, np.stack([towards, np.cross(along, towards), along]))

    @property
    def axis(self) -> np.ndarray:
        return self.axes[2]

    def outward(self, angle: float) -> np.ndarray:
        """Unit vector (3,) away from the axis at an angle [rad] from the first element."""
        return np.cos(angle) * self.axes[0] + np.sin(angle) * self.axes[1]

    def around(self, angle: float) -> np.ndarray:
        """Unit vector (3,) of increasing angle."""
        return np.cos(angle) * self.axes[1] - np.sin(angle) * self.axes[0]

    def in_user(self, body: Body | Ground, z: float) -> dict[str, Any]:
        """axis_point and axis_direction of a surface about the bearing's axis, user frame of `body`, `z` [m] along the
        axis from the centre."""
        at = self.center + z * self.axis
        return {"axis_point": body.to_user(at), "axis_direction": body.to_user(at + self.axis) - body.to_user(at)}


def solid_ball(diameter: float, material: Material) -> tuple[float, np.ndarray]:
    """Mass [kg] and inertia (3, 3) [kg m2]."""
    mass = material.density * np.pi * diameter**3 / 6.0
    return mass, 0.1 * mass * diameter**2 * np.eye(3)


def hollow_cylinder(
    inner: float, outer: float, length: float, material: Material, axis: np.ndarray
) -> tuple[float, np.ndarray]:
    """Mass [kg] and inertia (3, 3) [kg m2] about the centre, of diameters `inner` and `outer` [m]."""
    mass = material.density * 0.25 * np.pi * (outer**2 - inner**2) * length
    about = 0.125 * mass * (inner**2 + outer**2)
    across = 0.5 * about + mass * length**2 / 12.0
    return mass, across * np.eye(3) + (about - across) * np.outer(axis, axis)


def ring_mass(geometry: Geometry, side: str, material: Material, axis: np.ndarray) -> tuple[float, np.ndarray]:
    """Mass [kg] and inertia (3, 3) [kg m2] of the ring of a side. Raises `InputError` for a bore or an outside diameter
    beyond the shoulders."""
    D, pitch = geometry.diameter, geometry.pitch_diameter
    name, sign = ("bore", -1.0) if side == "inner" else ("outside_diameter", 1.0)
    shoulder, edge, given = pitch + sign * SHOULDER * D, pitch + sign * DEEP * D, getattr(geometry, name)
    width = geometry.default_width if geometry.width is None else geometry.width
    if is_thrust(geometry.inclination):  # washers on either side of the elements
        inside = max(pitch - DEEP * D, 0.0) if geometry.bore is None else geometry.bore
        outside = pitch + DEEP * D if geometry.outside_diameter is None else geometry.outside_diameter
        if not inside < pitch < outside:
            raise InputError(
                f"{geometry.label}: washers from {inside:g} to {outside:g} m do not contain the pitch circle of "
                f"{pitch:g} m; correct bore or outside_diameter"
            )
        return hollow_cylinder(inside, outside, max(0.5 * (width - D), SHOULDER * D), material, axis)
    if given is not None:
        edge = require_number(given, f"{geometry.label}: {name} [m]", positive=True)
        if sign * (edge - pitch) <= D:
            raise InputError(
                f"{geometry.label}: {name} {edge:g} m leaves no ring under the raceway, which lies "
                f"{'above' if side == 'inner' else 'below'} {pitch + sign * D:.4g} m"
            )
    edge = max(edge, 0.0)
    width += geometry.row_spacing if geometry.width is None else 0.0
    return hollow_cylinder(min(edge, shoulder), max(edge, shoulder), width, material, axis)


def ring_surfaces(
    scene: Scene, side: str, given: Any, bearing: Bearing, offset: float = 0.0
) -> tuple[Body | Ground, list[SurfacePort]]:
    """The body of a ring and its raceways, one of each track; offset [m]: along the axis, in the sense of each track.

    given: None for a rigid ring that is generated, an interface or a point of a body, `shaft["seat"]`, on which one is
    mounted, a rigid body or the ground, which get the raceways, or an existing contact surface, `body["rim"]`, of a
    flexible ring, two of them of a double-row bearing. Raises `InputError`.
    """
    name, place, geometry = bearing.name, bearing.place, bearing.geometry
    form: Form | None = getattr(geometry, f"{side}_form")
    label = f"bearing {name!r}: {side}"
    flexible = list(given) if isinstance(given, (tuple, list)) else [given]
    tracks = [replace(track, z=track.z + track.sense * offset) for track in geometry.tracks]
    if all(isinstance(port, SurfacePort) for port in flexible):
        return _flexible_ring(label, flexible, side, bearing, tracks)
    if given is None or isinstance(given, Port):
        seat: Port | None = given
        mass, inertia = ring_mass(geometry, side, bearing.materials[1], place.axis)
        given = scene.add_rigid_body(mass, inertia, name=f"{name} {side} ring", position=place.center)
        if seat is not None:
            _mount(scene, label, seat, given, side, bearing)
    if not isinstance(given, (Body, Ground)):
        raise InputError(
            f"{label} must be a rigid body of the scene, scene.ground, an interface of a body, body['seat'], a contact "
            f"surface of a flexible body, body['raceway'], or None for a new rigid ring, got {given!r}"
        )
    if isinstance(given, Body) and given.reduced is not None:
        places = ", ".join(f"body[{one!r}]" for one in given._places) or "none"
        raise InputError(
            f"{label}: body {given.name!r} is flexible; give one of its interfaces, on which a rigid ring is mounted, "
            f"or one of its contact surfaces, which is then the raceway, instead of the body, one of {places}"
        )
    ports = []
    for number, track in enumerate(tracks, start=1):
        shape, round_form = geometry.raceway(side, track, partial(place.in_user, given)), None
        if form is not None:
            begin = shape.chart(given.to_user(place.center + place.outward(0.0)))[0]
            round_form = RoundForm.of(form, shape, f"{label}_form").turned(float(begin))
        named = f"{name} {side} raceway" if number == 1 else f"{name} {side} raceway {number}"
        ports.append(given.surface(shape, name=named, form=round_form))
    return given, ports


def _mount(scene: Scene, label: str, seat: Port, ring: Body, side: str, bearing: Bearing) -> None:
    """Fix a rigid ring to the interface or the point that it is mounted on. Raises `InputError` for a seat that lies
    outside the bearing."""
    geometry, center = bearing.geometry, bearing.place.center
    apart = float(np.linalg.norm(seat.world_point() - center))
    if apart > 0.5 * geometry.pitch_diameter + geometry.row_spacing:
        raise InputError(
            f"{label}: {seat.label} lies {apart:.4g} m from the centre of the bearing at "
            f"({', '.join(f'{x:.6g}' for x in center)}) m; give position= [m] of the seat, "
            f"({', '.join(f'{x:.6g}' for x in seat.world_point())})"
        )
    joint = Fixed(seat, ring, axis=bearing.place.axis, point=center, name=f"{bearing.name} {side} seat")
    bearing.joints[f"{side}_seat"] = scene.add(joint)


def _flexible_ring(
    label: str, ports: list[SurfacePort], side: str, bearing: Bearing, tracks: list[Track]
) -> tuple[Body | Ground, list[SurfacePort]]:
    """`ring_surfaces` of given contact surfaces of a flexible body."""
    if len(ports) != len(tracks) or len({id(port.body) for port in ports}) > 1:
        raise InputError(
            f"{label}: the bearing has {len(tracks)} raceways on a ring, and {len(ports)} contact surfaces are given; "
            "give (body['first'], body['second']) of a double-row bearing, in the sense of the axis"
        )
    if getattr(bearing.geometry, f"{side}_form") is not None:
        raise InputError(
            f"{label}_form: {ports[0].label} is a surface of a flexible body, whose contact has no form deviation; "
            "leave it out, or make the ring rigid"
        )
    for port, track in zip(ports, tracks, strict=True):
        _refuse_other_raceway(
            label, port, bearing.geometry.raceway(side, track, partial(bearing.place.in_user, port.body))
        )
    return ports[0].body, ports


@named_arguments
@dataclass(frozen=True)
class Materials:
    """Materials of a bearing: `material` of rings and elements, `element_material` of other elements.

    element_body: the reduced body of every element, whose contact is distributed, None for rigid elements, whose
    contacts with a flexible ring have the compliance of the ring alone (`warpffrf.model.bearings.elements`).
    Raises `InputError` for invalid materials.
    """

    material: Material = STEEL
    element_material: Material | None = None
    element_body: ReducedBody | None = None

    def __post_init__(self) -> None:
        for name in ("material", "element_material"):
            value = getattr(self, name)
            if not isinstance(value, Material) and not (name == "element_material" and value is None):
                raise InputError(f"Materials: {name} must be a Material, got {value!r}")

    @property
    def both(self) -> tuple[Material, Material]:
        """The materials of the elements and of the rings."""
        return self.material if self.element_material is None else self.element_material, self.material


@named_arguments
@dataclass(frozen=True)
class RollingContact:
    """Contacts of rolling elements and raceways.

    law: a lumped law, or two, (inner, outer), None for laws.HertzPoint of the materials of balls and for
    laws.IsoLamina(roller_length) of rollers, which has the profile of ISO/TS 16281 unless the geometry has one.
    friction: as of `LumpedContact`, laws.RegularisedCoulomb for a traction that grows with the slip speed up to its
    bound. rolling_resistance, spin: of lumped contacts, moments against rolling and pivoting, as of `LumpedContact`;
    distributed contact has the friction of pivoting in its tractions.

    distributed: of `Materials(element_body=)`, the elements that are flexible: "all", numbers of elements from 1 on,
    (1, 2, 14), or "auto", those that carry half of the largest load or more under `load` (3,) [N], the force on
    the inner ring, world axes, between rigid rings that move in parallel. The others are rigid, with lumped contact of
    the same stiffness, or of `law` where it is given (`warpffrf.model.bearings.mixed`).
    """

    law: LumpedLaw | tuple[LumpedLaw, LumpedLaw] | None = None
    friction: FrictionLike = 0.0
    rolling_resistance: RollingResistance | None = None
    spin: bool = False
    distributed: str | Sequence[int] = "all"
    load: Vector | None = None

    def __post_init__(self) -> None:
        if isinstance(self.distributed, np.ndarray):  # which does not compare with a text
            object.__setattr__(self, "distributed", tuple(self.distributed.tolist()))


def contact_of(
    element: SurfacePort, ring: SurfacePort, law: LumpedLaw, rolling: RollingContact, name: str
) -> LumpedContact | Contact:
    """Between an element and a raceway: lumped where both are rigid, else distributed, the flexible one first. Raises
    `InputError` for losses that distributed contact does not have."""
    if element.rigid and ring.rigid:
        return LumpedContact(
            element, ring, law=law, friction=rolling.friction, rolling_resistance=rolling.rolling_resistance,
            spin=rolling.spin, name=name,
        )  # fmt: skip
    first, second = (element, ring) if ring.rigid else (ring, element)
    if rolling.rolling_resistance is not None:
        raise InputError(
            f"bearing contact {name!r}: {first.label} is flexible, and distributed contact has no rolling_resistance; "
            "leave it out, or make both rings and the elements rigid"
        )
    return Contact(first, second, friction=rolling.friction, name=name)


def _refuse_other_raceway(label: str, port: SurfacePort, wanted: Shape) -> None:
    """Raises `InputError` where a given contact surface is not a raceway of this bearing."""
    shape: Any = port.surface.shape
    kinds = (wanted.kind, "profiled_cylinder", "crowned_cylinder") if wanted.side > 0.0 else (wanted.kind,)
    radius = float(getattr(wanted, "radius", 0.0))
    if shape.kind not in kinds or abs(shape.radius - radius) > 1e-2 * radius:
        raise InputError(
            f"{label}: {port.label}, a {shape.kind} of radius {shape.radius:.6g} m, is no raceway of this bearing, "
            f"which is a {wanted.kind} of radius {radius:.6g} m; reduce the ring with that surface, or change the "
            "geometry"
        )


@dataclass(frozen=True)
class AxialPreload:
    """Common base of axial preloads of ball bearings; see the module."""

    kind: ClassVar[str] = ""

    def offset(self, label: str) -> float:
        """Offset [m] of the inner raceway from its free position, in the pressing sense; label: of the bearing, in
        messages. Raises `InputError`."""
        return 0.0

    def press(self, scene: Scene, bearing: Bearing, sense: float) -> None:
        """Add forces to `scene` and to `bearing.forces`; sense [-]: 1 along the axis, -1 against it. Raises
        `InputError`."""


@named_arguments
@dataclass(frozen=True)
class PreloadForce(AxialPreload):
    """The rings are pressed against each other along the axis by `force` [N], on each ring along its own axis.

    A fixed ring is loaded through its constraint. The forces are `bearing.forces["preload_inner"]` and
    ["preload_outer"], the latter unless the outer ring is the ground. Rings are rigid. Raises `InputError`.
    """

    force: float
    kind: ClassVar[str] = "preload_force"

    def press(self, scene: Scene, bearing: Bearing, sense: float) -> None:
        label = f"bearing {bearing.name!r}: PreloadForce"
        force = require_number(self.force, f"{label}: force [N]", positive=True)
        center, axis = bearing.place.center, bearing.place.axis
        for side, sign in (("inner", sense), ("outer", -sense)):
            body = getattr(bearing, side)
            if not isinstance(body, Body):
                continue
            if body.reduced is not None:
                raise InputError(
                    f"{label}: the {side} ring, {body.name!r}, is flexible, and a preload force requires an interface "
                    "of it; apply the force there, forces.PointForce(body['face'], ...)"
                )
            own = body.to_user(center + axis) - body.to_user(center)
            bearing.forces[f"preload_{side}"] = scene.add(
                PointForce(
                    body.at(body.to_user(center)), (sign * force, own), frame="body",
                    name=f"{bearing.name} preload {side}",
                )
            )  # fmt: skip


@named_arguments
@dataclass(frozen=True)
class PreloadOffset(AxialPreload):
    """The inner raceway is offset on its ring by `distance` [m], in the sense that presses the bearing together: a ring
    that is constrained at its free position is loaded from the start. Raises `InputError`."""

    distance: float
    kind: ClassVar[str] = "preload_offset"

    def offset(self, label: str) -> float:
        return require_number(self.distance, f"{label}: PreloadOffset: distance [m]", positive=True)


def checked_preload(label: str, preload: AxialPreload | None) -> AxialPreload:
    """Raises `InputError` for an object that is not a preload."""
    if preload is None:
        return AxialPreload()
    if not isinstance(preload, AxialPreload):
        raise InputError(
            f"{label}: axial_preload must be bearings.PreloadForce(newtons) or bearings.PreloadOffset(metres), got "
            f"{preload!r}; a radial one is a negative clearance"
        )
    return preload


def sense_of(angle: float) -> float:
    """1 where thrust on the inner ring along the axis presses a bearing of that contact angle [rad] together, else
    -1."""
    return -1.0 if np.sign(angle) < 0.0 else 1.0
