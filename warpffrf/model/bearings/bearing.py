"""A bearing in a scene: the return value of the builders, and its data for results."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, TypeAlias

import numpy as np

from warpffrf.model import rotation as rot
from warpffrf.model.bearings.geometry import SIDES, BallGeometry, RollerGeometry, Track, pair
from warpffrf.model.bearings.kinematics import DefectFrequencies, Rolling, rolling
from warpffrf.model.bearings.parts import Place
from warpffrf.model.bodies import Body, Ground
from warpffrf.model.contact import Contact
from warpffrf.model.errors import InputError, require_number
from warpffrf.model.forces import PointForce
from warpffrf.model.joints import Drive, Joint
from warpffrf.model.lumped_contact import LumpedContact
from warpffrf.model.material import Material
from warpffrf.model.messages import reprs
from warpffrf.model.signals import Constant

Angle: TypeAlias = float | tuple[float, float] | None
ELEMENT_SURFACE = "skin"  # of rigid elements
UNRESISTED = 1e-8  # of all loads on a shaft, along its axis: round-off
SWIVELS = 1e-3  # of the larger one of thrust and radial load: below, equilibria are found


@dataclass(eq=False, repr=False)
class Bearing(reprs.Shown):
    """A bearing as created by `scene.add_bearing`; its parts belong to the scene
    and may be changed.

    kind: "ball" or "roller". elements: bodies, "<name> ball 1" onwards, counter-clockwise about the axis.
    inner, outer: bodies of the rings, or the ground. contacts: by "inner_1", "outer_1", ... and of pockets; joints: by
    "pocket_1", "cage_axle", "inner_seat" of a ring that is mounted on an interface; forces: "preload_inner",
    "preload_outer". name: as given; element_surface: name of the surface of each element. cage: its body, drive: of its
    speed, None without; pockets: by interface of a flexible cage, bodies that are fixed there and carry its walls.
    geometry: as given; place: its position and axes; materials: of the elements and of the rings. distributed: numbers,
    from 1, of the flexible elements where others are rigid, else None; load: the force [N] by which they were chosen,
    None where they are named.
    """

    name: str
    kind: str
    geometry: BallGeometry | RollerGeometry
    place: Place
    materials: tuple[Material, Material]
    elements: list[Body] = field(default_factory=list)
    inner: Body | Ground = field(default_factory=Ground)
    outer: Body | Ground = field(default_factory=Ground)
    cage: Body | None = None
    pockets: dict[str, Body] = field(default_factory=dict)
    drive: Drive | None = None
    contacts: dict[str, LumpedContact | Contact] = field(default_factory=dict)
    joints: dict[str, Joint] = field(default_factory=dict)
    forces: dict[str, PointForce] = field(default_factory=dict)
    element_surface: str = ELEMENT_SURFACE
    distributed: tuple[int, ...] | None = None
    load: tuple[float, ...] | None = None

    def _facts(self) -> dict[str, Any]:
        return {
            "name": self.name, "kind": f"{len(self.elements)} {self.kind}s", "inner": self.inner.name,
            "outer": self.outer.name, "cage": None if self.cage is None else self.cage.name,
        }  # fmt: skip

    @property
    def between(self) -> list[Body]:
        """The bodies between the rings: elements, cage and its pockets."""
        return [*self.elements, *([] if self.cage is None else [self.cage]), *self.pockets.values()]

    def element_center(self, angle: float, track: Track) -> np.ndarray:
        """Centre (3,) [m], world, of an element at `angle` [rad] in the row `track` at the initial pose."""
        radius = 0.5 * self.geometry.pitch_diameter
        return self.place.center + radius * self.place.outward(angle) + track.z * self.place.axis

    def element_axis(self, angle: float, track: Track) -> np.ndarray:
        """Direction (3,), world, of the axis of an element at `angle` [rad] in the row `track`: across the line between
        its contacts, in the plane through the bearing's axis."""
        tau = track.sense * self.geometry.inclination
        return float(np.cos(tau)) * self.place.axis - float(np.sin(tau)) * self.place.outward(angle)

    @property
    def locating(self) -> bool:
        """Whether it guides its rings along the axis, in one sense at least: cylindrical roller bearings do by ribs on
        both rings only."""
        ribs = all(any(key.startswith(f"flange_{side}") for key in self.contacts) for side in SIDES)
        return ribs or self.geometry.inclination != 0.0 or self.geometry.arc_radius("inner") is not None

    def orbit_speed(self, inner: float = 0.0, outer: float = 0.0, *, angle: Angle = None) -> float:
        """Speed [rad/s] of elements and cage about the axis where they roll without slip on rings that rotate with the
        speeds `inner` and `outer` [rad/s]; angle [rad]: contact angle, or (inner, outer), which differ under
        centrifugal load, None for the free one, which holds under thrust. Under a purely radial load it is 0; results
        contain it as `inner_angle` and `outer_angle`.

        With gamma = D cos(alpha)/d_pw: (inner (1 - gamma) + outer (1 + gamma))/2; at two angles balls do not pivot on
        the outer ring. Raises `InputError` for an angle that is no number.
        """
        return self._rolling(inner, outer, self._contact_angle(angle, "orbit_speed"), "outer").orbit

    def defect_frequencies(
        self, inner: float = 0.0, outer: float = 0.0, *, angle: float | None = None
    ) -> DefectFrequencies:
        """Frequencies [Hz] at which defects of raceways and elements show where elements roll without slip: `.bpfo`,
        `.bpfi`, `.bsf`, `.ftf`. inner, outer: speeds of the rings [rad/s]; angle: contact angle [rad], both as of
        `orbit_speed`. A double-row bearing has them in each row. Raises `InputError` for a value that is no number."""
        label = f"bearing {self.name!r}: defect_frequencies"
        w_i = require_number(inner, f"{label}: inner [rad/s]")
        w_o = require_number(outer, f"{label}: outer [rad/s]")
        alpha = self._contact_angle(angle, "defect_frequencies")
        w_c, Z = self._rolling(w_i, w_o, alpha, "outer").orbit, self.geometry.elements
        ratio = self.geometry.diameter / self.geometry.pitch_diameter
        spin = 0.5 / ratio * (1.0 - (ratio * np.cos(alpha[0])) ** 2) * (w_i - w_o)
        found = np.abs([Z * (w_c - w_o), Z * (w_i - w_c), spin, w_c]) / (2.0 * np.pi)
        return DefectFrequencies(*found.tolist())

    @property
    def angle(self) -> float:
        """Free contact angle [rad] of the first row, of rollers the inclination of their axes."""
        return self.geometry.free_angle if isinstance(self.geometry, BallGeometry) else self.geometry.inclination

    def roll(self, inner: float = 0.0, outer: float = 0.0, *, angle: Angle = None, control: str = "outer") -> Rolling:
        """Initial state with rings that rotate at `inner` and `outer` [rad/s] about the axis, elements that roll on
        them without slip, and the cage moving with them; returns the speeds of an element.

        Sets `velocity` and `angular_velocity` of the bodies, of those that rings are mounted on, too, and the drive of
        a cage `PrescribedCage`. angle [rad]: as of `orbit_speed`; control: the raceway that balls do not pivot on,
        "outer" or "inner" (`warpffrf.model.bearings.kinematics`). Drives of the rings are the scene's. Raises
        `InputError` for a speed of the ground.
        """
        label = f"bearing {self.name!r}: roll"
        speeds = {"inner": require_number(inner, f"{label}: inner [rad/s]"),
                  "outer": require_number(outer, f"{label}: outer [rad/s]")}  # fmt: skip
        if control not in SIDES:
            raise InputError(
                f'{label}: control must be "inner" or "outer", the raceway on which balls do not pivot, got {control!r}'
            )
        nominal = self._contact_angle(angle, "roll")
        found = self._rolling(inner, outer, nominal, control)
        for side, speed in speeds.items():
            ring = getattr(self, side)
            seat = self.joints.get(f"{side}_seat")
            for body in (ring,) if seat is None else (ring, seat.a.body):
                if isinstance(body, Body):
                    self._turn(body, speed)
                elif speed:
                    raise InputError(f"{label}: the {side} ring is the ground, which is fixed; rotate the other one")
        axis = self.place.axis
        for element, (_, track) in zip(self.elements, self.geometry.places, strict=True):
            of_row = self._rolling(inner, outer, track.sense * nominal, control)
            out = element.position - self.place.center
            out = out - (out @ axis) * axis
            out /= np.linalg.norm(out)
            element.velocity = found.orbit * np.cross(axis, element.position - self.place.center)
            element.angular_velocity = of_row.radial * out + of_row.axial * axis
        for body in self.between[len(self.elements) :]:
            self._turn(body, found.orbit)
        if self.drive is not None:
            carrier = self.joints["cage_axle"].a.body
            known = {id(getattr(self, side)): speed for side, speed in speeds.items()}
            self.drive.signal = Constant(found.orbit - known.get(id(carrier), 0.0))
        return found

    def _contact_angle(self, angle: Angle, what: str) -> np.ndarray:
        """(2,) rad, on the inner and on the outer ring: the given ones, or the free one."""
        label = f"bearing {self.name!r}: {what}: angle [rad]"
        return np.array([require_number(each, label) for each in pair(self.angle if angle is None else angle, label)])

    def _rolling(self, inner: float, outer: float, angles: np.ndarray, control: str) -> Rolling:
        D, pitch = self.geometry.diameter, self.geometry.pitch_diameter
        rollers = isinstance(self.geometry, RollerGeometry)
        return rolling(D, pitch, inner, outer, (angles[0], angles[1]), "cage" if rollers else control)

    def _turn(self, body: Body, speed: float) -> None:
        """Set the initial rotation of `body` about the bearing's axis."""
        body.angular_velocity = speed * self.place.axis
        body.velocity = np.cross(body.angular_velocity, body.position - self.place.center)

    def describe(self) -> dict[str, Any]:
        """Plain data that results files store and results are evaluated from."""
        moving = self.between[len(self.elements) :] if self.pockets else []
        return {
            "name": self.name, "kind": self.kind, "geometry": self.geometry.describe(),
            "center": self.place.center.tolist(), "axes": self.place.axes.tolist(),
            "moduli": [m.plane_strain_modulus for m in self.materials],
            "elements": [self.elements[i].name for i, _ in self.geometry.contacts], "inner": self.inner.name,
            "outer": self.outer.name, "poses": {body.name: _pose(body) for body in (self.inner, self.outer, *moving)},
            "inertia": [self._across(self.elements[i]) for i, _ in self.geometry.contacts],
            "cage": None if self.cage is None else self.cage.name,
            "pockets": {interface: body.name for interface, body in self.pockets.items()},
            "contacts": {key: contact.name for key, contact in self.contacts.items()},
            "rings_first": [c.name for c in self.contacts.values() if c.a.body in (self.inner, self.outer)],
            "joints": {key: joint.name for key, joint in self.joints.items()},
            "rigid_elements": None if self.distributed is None else {
                "columns": [k for k, (i, _) in enumerate(self.geometry.contacts) if i + 1 not in self.distributed],
                "moduli": {side: self._modulus(side) for side in SIDES},
            },
        }  # fmt: skip

    def _modulus(self, side: str) -> float:
        """E* [Pa] of flexible elements and the ring of a side, which may be rigid."""
        ring = getattr(self, side).reduced is not None
        return 1.0 / sum(1.0 / m.plane_strain_modulus for m in self.materials[: 1 + ring])

    def _across(self, element: Body) -> float:
        """Moment of inertia [kg m2] of an element about the radial direction."""
        direction = rot.matrix(element.rotation).T @ self.place.axes[0]
        return float(direction @ element.inertia @ direction)

    def contacts_of(self, side: str) -> list[LumpedContact | Contact]:
        """The contacts with the ring of a side, "inner" or "outer", in the order of rows and elements."""
        if side not in SIDES:
            raise ValueError(side)
        return [self.contacts[f"{side}_{i}"] for i in range(1, len(self.geometry.contacts) + 1)]


def _pose(body: Body | Ground) -> dict[str, Any]:
    return {"position": body.position.tolist(), "rotation": body.rotation.tolist()}


def without_cage(bearings: list[Bearing]) -> str:
    """Cure for bearings whose elements are not separated by a cage, "" where there are none."""
    loose = [repr(bearing.name) for bearing in bearings if bearing.cage is None]
    if not loose:
        return ""
    return (
        f"bearing {', '.join(loose)} has no cage, and loads push its elements out of the load zone; give it "
        "cage=bearings.PrescribedCage(), or constrain the elements by joints"
    )


def _seats(bearings: list[Bearing]) -> list[Joint]:
    return [joint for bearing in bearings for key, joint in bearing.joints.items() if key.endswith("_seat")]


def _shaft(bearings: list[Bearing], items: list[Any], body: Body) -> tuple[set[Any], list[Bearing], bool]:
    """Rigid parts of the shaft that `body` belongs to, the bearings on it, and whether one of `items` connects it with
    anything else."""
    group = {body}
    for _ in SIDES:  # from a ring to its shaft, and to the other rings
        group |= {p.body for seat in _seats(bearings) for p in seat.ports if any(q.body in group for q in seat.ports)}
    on = [bearing for bearing in bearings if bearing.inner in group or bearing.outer in group]
    within = group.union(*(bearing.between for bearing in on))
    links = [{port.body for port in item.ports} for item in items]
    return group, on, any(link & group and link - within for link in links)


def not_guided(bearings: list[Bearing], items: list[Any], body: Body) -> str:
    """Text about a shaft, `body` or what it is mounted on, that only bearings support of which none guides it along the
    axis; "" where there is none. `items`: what else may guide it."""
    _, on, held = _shaft(bearings, items, body)
    if not on or held or any(bearing.locating for bearing in on):
        return ""
    carrier = next((seat.a.body for seat in _seats(bearings) if seat.b.body is body), body)
    return (
        f"nothing guides body {carrier.name!r} along the axis, as its bearings are non-locating: "
        f"{', '.join(repr(bearing.name) for bearing in on)}; make one a ball bearing, or give it Flanges with ribs on "
        "both rings"
    )


def swivelling(bearings: list[Bearing], items: list[Any], body: Body) -> str:
    """Text about the inner ring of a self-aligning bearing, `body` or an element of it, whose axis nothing else keeps;
    "" where there is none. `items`: what else may keep it."""
    for bearing in bearings:
        if not bearing.geometry.self_aligning or not isinstance(bearing.inner, Body):
            continue
        group, on, held = _shaft(bearings, items, bearing.inner)
        if len(on) == 1 and not held and body in group.union(bearing.elements):
            return (
                f"bearing {bearing.name!r} is self-aligning, and nothing else keeps the axis of its inner ring, which "
                "swivels about the centre of the bearing until the load is radial; support the shaft by another "
                "bearing, or keep its direction by two joints.Prismatic in series, along and across it"
            )
    return ""


def refuse_unguided_thrust(bearings: list[Bearing], items: list[Any], forces: list[Any], gravity: np.ndarray) -> None:
    """Raises `InputError` for a shaft that only bearings without friction support, `items` as of `not_guided`, where
    `forces` and `gravity` [m/s2] at time 0 drive it along the axis of non-locating ones, or let it swivel in a
    self-aligning one."""
    for body in [side for bearing in bearings for side in (bearing.inner, bearing.outer) if isinstance(side, Body)]:
        slides, swivels = not_guided(bearings, items, body), swivelling(bearings, items, body)
        group, on, _ = _shaft(bearings, items, body)
        rubs = any(contact.friction.acts for bearing in on for contact in bearing.contacts.values())
        if rubs or not (slides or swivels):
            continue
        loads = [each.mass * np.asarray(gravity) for each in group if isinstance(each, Body)]
        for force in forces:
            if isinstance(force, PointForce) and force.port.body in group:
                given = np.array([signal(0.0) for signal in force.components])
                loads.append(rot.matrix(force.port.body.rotation) @ given if force.frame == "body" else given)
        thrust, radial = _split(np.sum(loads, axis=0), on[0].place.axis)
        if slides and thrust > UNRESISTED * float(np.linalg.norm(loads, axis=1).sum()):
            raise InputError(f"equilibrium: {thrust:.3g} N of thrust have no load path: {slides}")
        if swivels and min(thrust, radial) > SWIVELS * max(thrust, radial):
            raise InputError(f"equilibrium, under {thrust:.3g} N of thrust and {radial:.3g} N across: {swivels}")


def _split(load: np.ndarray, axis: np.ndarray) -> tuple[float, float]:
    """Sizes of the parts of a load (3,) along and across an axis."""
    along = float(load @ axis)
    return abs(along), float(np.linalg.norm(load - along * axis))


def loose_ring(bearings: list[Bearing], items: list[Any], body: Body) -> str:
    """Text about a bearing that `body` is part of and one of whose rings is supported by its elements only, so that it
    carries no load for the other ring; "" where there is none. `items`: all that connects bodies."""
    for bearing in bearings:
        within = bearing.between
        for side, other in ((bearing.outer, bearing.inner), (bearing.inner, bearing.outer)):
            if not isinstance(side, Body) or not isinstance(other, Body) or body not in (*within, side, other):
                continue
            links = [[port.body for port in item.ports] for item in items]
            if not any(side in link and any(b is not side and b not in within for b in link) for link in links):
                return f"body {side.name!r} is supported by nothing but the elements of bearing {bearing.name!r}"
    return ""
