r"""A bearing in a scene: the return value of the builders, and its data for results.

Rating. Lives of rolling bearings, in 10^6 revolutions at 90 % reliability.

**Basic rating life** (ISO 281): L_10 = (C/P)^p, p = 3 of balls and 10/3 of rollers, P = X F_r + Y F_a.

**Basic reference life of radial ball bearings** (ISO/TS 16281:2008, section 4.2), from the load of every ball. With
gamma = D cos(alpha)/d_pw and i rows the loads of a raceway that give it a life of one million revolutions are

    h = 1.044 ((1 - gamma)/(1 + gamma))^1.72 ((r_i/r_e) (2 r_e - D)/(2 r_i - D))^0.41,
    Q_ci = C_r/(0.407 Z cos(alpha)^0.7 i^0.7) (1 + h^(10/3))^(3/10),
    Q_ce = C_r/(0.389 Z cos(alpha)^0.7 i^0.7) (1 + h^(-10/3))^(3/10),

the equivalent loads of a raceway that rotates relative to the load, and of one that is stationary,

    Q_e = (mean of Q_j^3)^(1/3),      Q_e = (mean of Q_j^(10/3))^(3/10),

and L_10r = ((Q_ci/Q_ei)^(-10/3) + (Q_ce/Q_ee)^(-10/3))^(-9/10). alpha is the nominal contact angle, 0 of a deep-groove
bearing whatever its clearance. Rows, of which each has its own equivalent loads, fail independently: their terms add.

**Basic reference life of radial roller bearings** (ISO/TS 16281:2008, section 5.3), from the load q_jk of every lamina
k, of n, on every roller j. With h = 1.038 ((1 - gamma)/(1 + gamma))^(143/108)

    Q_ci = C_r/(lambda nu 0.378 Z i^(7/9) cos(alpha)) (1 + h^(9/2))^(2/9),
    Q_ce = C_r/(lambda nu 0.364 Z i^(7/9) cos(alpha)) (1 + h^(-9/2))^(2/9),

lambda nu = 0.83 (ISO 281 has it in C_r for stresses that are not uniform, which enter individually here), laminae have
the ratings q_c = Q_c n^(-7/9), and with the factor of the stress at the edges

    f_k = 1 - 0.01/ln(1.985 |2 k - n - 1|/(2 n - 2)),      q_ek = (mean over j of (f_k q_jk)^w)^(1/w),

w = 4 for a raceway that rotates relative to the load and 9/2 for a stationary one,

    L_10r = (sum over k of (q_ci/q_eik)^(-9/2) + (q_ce/q_eek)^(-9/2))^(-8/9).

f is 1 in the middle and 2.3 at the ends: that of rollers with a usual profile. Without it, and with equally loaded
laminae, Lundberg and Palmgren's distribution under F_r = C_r/(lambda nu) has a life of one, as ISO 281's has under C_r.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from warpffrf.model import rotation as rot
from warpffrf.model.bearings.geometry import SIDES, BallGeometry, RollerGeometry, Track
from warpffrf.model.bearings.kinematics import Rolling, rolling
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

ELEMENT_SURFACE = "skin"  # of rigid elements


@dataclass(eq=False, repr=False)
class Bearing(reprs.Shown):
    """A bearing as created by `scene.add_ball_bearing` and `scene.add_roller_bearing`; its parts belong to the scene
    and may be changed.

    kind: "ball" or "roller". elements: bodies, "<name> ball 1" onwards, counter-clockwise about the axis.
    inner, outer: bodies of the rings, or the ground. contacts: by "inner_1", "outer_1", ... and of pockets; joints: by
    "pocket_1", "cage_axle"; forces: "preload_inner", "preload_outer". name: as given; element_surface: name of the
    surface of each element. cage: its body, drive: of its speed, None without. geometry: as given; place: its
    position and axes; materials: of the elements and of the rings.
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
    drive: Drive | None = None
    contacts: dict[str, LumpedContact | Contact] = field(default_factory=dict)
    joints: dict[str, Joint] = field(default_factory=dict)
    forces: dict[str, PointForce] = field(default_factory=dict)
    element_surface: str = ELEMENT_SURFACE

    def _facts(self) -> dict[str, Any]:
        return {
            "name": self.name, "kind": f"{len(self.elements)} {self.kind}s", "inner": self.inner.name,
            "outer": self.outer.name, "cage": None if self.cage is None else self.cage.name,
        }  # fmt: skip

    def element_center(self, angle: float, track: Track) -> np.ndarray:
        """Centre (3,) [m], world, of an element at `angle` [rad] in the row `track` at the initial pose."""
        radius = 0.5 * self.geometry.pitch_diameter
        return self.place.center + radius * self.place.outward(angle) + track.z * self.place.axis

    def element_axis(self, angle: float, track: Track) -> np.ndarray:
        """Direction (3,), world, of the axis of an element at `angle` [rad] in the row `track`: across the line between
        its contacts, in the plane through the bearing's axis."""
        tau = track.sense * self.geometry.inclination
        return float(np.cos(tau)) * self.place.axis - float(np.sin(tau)) * self.place.outward(angle)

    def orbit_speed(self, inner: float = 0.0, outer: float = 0.0, *, angle: float | None = None) -> float:
        """Speed [rad/s] of elements and cage about the axis where they roll without slip on rings that rotate with the
        speeds `inner` and `outer` [rad/s]; angle [rad]: contact angle, None for the free one, which holds under thrust.
        Under a purely radial load it is 0; results contain it as `inner_angle` and `outer_angle`.

        With gamma = D cos(alpha)/d_pw: (inner (1 - gamma) + outer (1 + gamma))/2. Raises `InputError` for an angle that
        is no number.
        """
        return self._rolling(inner, outer, self._contact_angle(angle, "orbit_speed"), "outer").orbit

    @property
    def angle(self) -> float:
        """Free contact angle [rad] of the first row, of rollers the inclination of their axes."""
        return self.geometry.free_angle if isinstance(self.geometry, BallGeometry) else self.geometry.inclination

    def roll(
        self, inner: float = 0.0, outer: float = 0.0, *, angle: float | None = None, control: str = "outer"
    ) -> Rolling:
        """Initial state with rings that rotate at `inner` and `outer` [rad/s] about the axis, elements that roll on
        them without slip, and the cage moving with them; returns the speeds of an element.

        Sets `velocity` and `angular_velocity` of the bodies, and the drive of a cage `PrescribedCage`. angle [rad]:
        contact angle, None for the free one; control: the raceway that balls do not pivot on, "outer" or "inner"
        (`warpffrf.model.bearings.geometry`). Drives of the rings are the scene's. Raises `InputError` for a speed of
        the ground.
        """
        label = f"bearing {self.name!r}: roll"
        speeds = {"inner": require_number(inner, f"{label}: inner [rad/s]"),
                  "outer": require_number(outer, f"{label}: outer [rad/s]")}  # fmt: skip
        nominal = self._contact_angle(angle, "roll")
        found = self._rolling(inner, outer, nominal, control)
        for side, speed in speeds.items():
            ring = getattr(self, side)
            if isinstance(ring, Body):
                self._turn(ring, speed)
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
        if self.cage is not None:
            self._turn(self.cage, found.orbit)
        if self.drive is not None:
            carrier = self.joints["cage_axle"].a.body
            known = {id(getattr(self, side)): speed for side, speed in speeds.items()}
            self.drive.signal = Constant(found.orbit - known.get(id(carrier), 0.0))
        return found

    def _contact_angle(self, angle: float | None, what: str) -> float:
        """The given one, or the free one [rad]."""
        return self.angle if angle is None else require_number(angle, f"bearing {self.name!r}: {what}: angle [rad]")

    def _rolling(self, inner: float, outer: float, angle: float, control: str) -> Rolling:
        D, pitch = self.geometry.diameter, self.geometry.pitch_diameter
        rollers = isinstance(self.geometry, RollerGeometry)
        return rolling(D, pitch, inner, outer, (angle, angle), "cage" if rollers else control)

    def _turn(self, body: Body, speed: float) -> None:
        """Set the initial rotation of `body` about the bearing's axis."""
        body.angular_velocity = speed * self.place.axis
        body.velocity = np.cross(body.angular_velocity, body.position - self.place.center)

    def describe(self) -> dict[str, Any]:
        """Plain data that results files store and results are evaluated from."""
        return {
            "name": self.name, "kind": self.kind, "geometry": self.geometry.describe(),
            "center": self.place.center.tolist(), "axes": self.place.axes.tolist(),
            "moduli": [m.plane_strain_modulus for m in self.materials],
            "elements": [self.elements[i].name for i, _ in self.geometry.contacts], "inner": self.inner.name,
            "outer": self.outer.name, "poses": {ring.name: _pose(ring) for ring in (self.inner, self.outer)},
            "inertia": [self._across(self.elements[i]) for i, _ in self.geometry.contacts],
            "cage": None if self.cage is None else self.cage.name,
            "contacts": {key: contact.name for key, contact in self.contacts.items()},
            "rings_first": [c.name for c in self.contacts.values() if c.a.body in (self.inner, self.outer)],
            "joints": {key: joint.name for key, joint in self.joints.items()},
        }  # fmt: skip

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


def loose_ring(bearings: list[Bearing], items: list[Any], body: Body) -> str:
    """Text about a bearing that `body` is part of and one of whose rings is supported by its elements only, so that it
    carries no load for the other ring; "" where there is none. `items`: all that connects bodies."""
    for bearing in bearings:
        within = [*bearing.elements, *([] if bearing.cage is None else [bearing.cage])]
        for side, other in ((bearing.outer, bearing.inner), (bearing.inner, bearing.outer)):
            if not isinstance(side, Body) or not isinstance(other, Body) or body not in (*within, side, other):
                continue
            links = [[port.body for port in item.ports] for item in items]
            if not any(side in link and any(b is not side and b not in within for b in link) for link in links):
                return f"body {side.name!r} is supported by nothing but the elements of bearing {bearing.name!r}"
    return ""


EXPONENTS = {"ball": 3.0, "roller": 10.0 / 3.0}
TURNS, STANDS = 3.0, 10.0 / 3.0  # exponents of equivalent loads
TURNS_LINE, STANDS_LINE = 4.0, 4.5
UNIFORM = 0.83  # lambda nu
FLATTEST = 0.1  # cosine of the contact angle of a radial roller bearing
FEWEST = 30  # laminae of a roller


@dataclass(frozen=True)
class BasicLife:
    """L_10 in 10^6 revolutions, with the capacity C and the equivalent load P [N], P = X F_r + Y F_a."""

    revolutions: float
    capacity: float
    load: float
    X: float
    Y: float


@dataclass(frozen=True)
class ReferenceLife:
    """L_10r in 10^6 revolutions, with loads of the raceways [N]: those for a life of one, and the equivalent ones, for
    rollers those of the most critical lamina, times the number of laminae."""

    revolutions: float
    capacity: float
    inner_rating: float  # Q_ci
    outer_rating: float  # Q_ce
    inner_load: float  # Q_ei
    outer_load: float  # Q_ee


def basic_life(
    kind: str, capacity: float, radial: float, axial: float = 0.0, *, X: float = 1.0, Y: float = 0.0
) -> BasicLife:
    """ISO 281's L_10 of a "ball" or "roller" bearing of dynamic capacity [N] under forces [N]; X, Y: factors of the
    catalogue. Raises `InputError` for loads without a positive equivalent."""
    C = require_number(capacity, "basic life: capacity [N]", positive=True)
    load = X * abs(radial) + Y * abs(axial)
    if load <= 0.0:
        raise InputError(
            f"basic life: the equivalent load X F_r + Y F_a is {load:g} N, and the life is unbounded; give X and Y of "
            "the catalogue where the load is axial"
        )
    return BasicLife(float((C / load) ** EXPONENTS[kind]), C, load, X, Y)


def reference_life(
    geometry: Any, capacity: float, inner: np.ndarray, outer: np.ndarray, *, turning: str = "inner"
) -> ReferenceLife:
    """ISO/TS 16281's L_10r from the loads [N] of elements on either raceway, of balls (Z,), of rollers (Z, n) of their
    laminae, row by row; capacity [N]; turning: the ring that rotates relative to the load, the other one is
    stationary. Raises `InputError`."""
    if turning not in ("inner", "outer"):
        raise InputError(f"reference life: turning must be 'inner' or 'outer', got {turning!r}")
    C = require_number(capacity, "reference life: capacity [N]", positive=True)
    if max(float(np.max(Q, initial=0.0)) for Q in (inner, outer)) <= 0.0:
        raise InputError("reference life: no element is loaded, and the life is unbounded")
    if isinstance(geometry, BallGeometry):
        return _of_balls(geometry, C, inner, outer, turning)
    if np.shape(inner)[1] < FEWEST:
        raise InputError(
            f"reference life: ISO/TS 16281 has {FEWEST} laminae at least on a roller, and there are "
            f"{np.shape(inner)[1]}; give them in the law, laws.IsoLamina(length)"
        )
    return _of_rollers(geometry, C, inner, outer, turning)


def _of_balls(geometry: BallGeometry, C: float, inner: np.ndarray, outer: np.ndarray, turning: str) -> ReferenceLife:
    D, Z, c = geometry.diameter, geometry.rows**0.7 * geometry.elements, float(np.cos(geometry.contact_angle))
    gamma, r_i, r_e = D * c / geometry.pitch_diameter, geometry.groove("inner"), geometry.groove("outer")
    h = 1.044 * ((1.0 - gamma) / (1.0 + gamma)) ** 1.72 * (r_i / r_e * (2.0 * r_e - D) / (2.0 * r_i - D)) ** 0.41
    ratings = [
        C / (factor * Z * c**0.7) * (1.0 + h ** (sign * 10.0 / 3.0)) ** 0.3
        for factor, sign in ((0.407, 1.0), (0.389, -1.0))
    ]
    powers = (TURNS, STANDS) if turning == "inner" else (STANDS, TURNS)
    harm, worst = 0.0, []
    for Q, power, rating in zip((inner, outer), powers, ratings, strict=True):
        of_row = np.reshape(Q, (-1, geometry.elements))
        loads = np.mean(of_row**power, axis=1) ** (1.0 / power)
        harm += float(np.sum((loads / rating) ** (10.0 / 3.0)))
        worst.append(float(loads.max()))
    return ReferenceLife(harm**-0.9, C, *ratings, *worst)


def edge_factor(count: int) -> np.ndarray:
    """f (count,) of the stress of laminae from end to end, see the module; 1 of a single one."""
    if count < 2:
        return np.ones(count)
    off = np.abs(2.0 * np.arange(1, count + 1) - count - 1.0) / (2.0 * count - 2.0)
    return np.array([1.0 - 0.01 / np.log(1.985 * x) if x > 0.0 else 1.0 for x in off])


def _of_rollers(
    geometry: RollerGeometry, C: float, inner: np.ndarray, outer: np.ndarray, turning: str,
    edges: Callable[[int], np.ndarray] = edge_factor,
) -> ReferenceLife:  # fmt: skip
    c, rows = float(np.cos(geometry.contact_angle)), geometry.rows
    if c < FLATTEST:
        raise InputError("reference life: formulas of thrust roller bearings are not built; take basic_life")
    gamma, Z = geometry.diameter * c / geometry.pitch_diameter, geometry.elements * rows ** (7.0 / 9.0) * c
    h = 1.038 * ((1.0 - gamma) / (1.0 + gamma)) ** (143.0 / 108.0)
    ratings = [
        C / (UNIFORM * factor * Z) * (1.0 + h ** (sign * 4.5)) ** (2.0 / 9.0)
        for factor, sign in ((0.378, 1.0), (0.364, -1.0))
    ]
    powers = (TURNS_LINE, STANDS_LINE) if turning == "inner" else (STANDS_LINE, TURNS_LINE)
    harm, worst = 0.0, []
    for q, power, rating in zip((inner, outer), powers, ratings, strict=True):
        n = np.shape(q)[1]
        of_row = np.reshape(q, (-1, geometry.elements, n))
        equivalent = np.mean((edges(n) * of_row) ** power, axis=1) ** (1.0 / power)
        harm += float(np.sum((equivalent / (rating * n ** (-7.0 / 9.0))) ** 4.5))
        worst.append(float(equivalent.max()) * n)
    return ReferenceLife(harm ** (-8.0 / 9.0), C, *ratings, *worst)
