r"""A cam and its follower: joints, spring and contact in one call, and the speed at which the follower jumps.

The follower slides along a direction or swings about a pivot, both in the plane of the cam, and a spring on that joint
presses it on the cam. In the axes of the cam, with the lift q (a length or an angle) of a follower that stays in
contact, phi the angle of the cam, M the mass or moment of inertia that moves, K and Q the stiffness and the load at
q = 0 with the weight, the contact opens where M omega^2 q'' + K q + Q < 0: at the jump speed

    omega_j^2 = min (K q + Q)/(-M q''),      q'' < 0.

q(phi) follows from the curve c(u) with its normal n. The centre p = c + r n of a roller lies at the distance |p| from
the axis, on the line or circle on which the centre is guided, where phi is the angle from p to that place. A flat face
across the motion has q = c.n - q_0, phi the angle from -n to its normal. Periodic splines through q(phi) have the
curvature q''.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from warpffrf.model import rotation as rot
from warpffrf.model.arguments import Vector
from warpffrf.model.bodies import Body, SurfacePort
from warpffrf.model.contact import Contact
from warpffrf.model.errors import InputError, require_array, require_direction, require_number
from warpffrf.model.forces import JointSpringDamper
from warpffrf.model.friction import FrictionLike
from warpffrf.model.joints import Drive, Prismatic, Revolute
from warpffrf.model.messages import reprs
from warpffrf.model.messages.named_arguments import named_arguments
from warpffrf.model.placement.gap import closing_distance, smallest_gap
from warpffrf.model.signals import Signal, SignalLike, as_signal
from warpffrf.model.surfaces import Extruded

if TYPE_CHECKING:
    from warpffrf.model.scene import Scene

Array = np.ndarray
ACROSS = 1e-6  # of a direction along the axis of the cam: sine of the angle between them
CLOSED = 1e-12  # m: gap of a swinging follower
ON_AXIS = 1e-6  # m: of an interface from the axis of its joint
SWINGS = 60  # steps until it is closed; each moves by the gap over the lever
FINE = 8  # places per degree: where the jump speed is searched


@dataclass(eq=False, repr=False)
class CamPair(reprs.Shown):
    """A cam and its follower, as made by `scene.add_cam`: their `contact`, the joints `shaft`, `guide` and `pin`, None
    without, the `spring`, and the `drive`, None without."""

    name: str
    contact: Contact
    cam: SurfacePort
    follower: SurfacePort
    moving: tuple[Body, ...]
    guide: Prismatic | Revolute
    spring: JointSpringDamper
    shaft: Revolute | None
    drive: Drive | None
    pin: Revolute | None
    direction: Array  # (3,) away from the cam, world, of a follower that slides
    pivot: Array | None  # (3,) m, world, of one that swings
    load: float  # N or N m, of the spring and the weight where it touches

    def _facts(self) -> dict[str, Any]:
        return {
            "name": self.name,
            "cam": self.cam.label,
            "follower": self.follower.label,
            "moves": "slides" if self.pivot is None else "swings",
        }

    @property
    def jump_speed(self) -> float:
        """omega_j [rad/s] of the cam above which a rigid follower leaves it, infinite where it never does. Without
        rotary inertia of a roller about its pin and without damping. Raises `InputError` for an open curve, and for
        followers other than rollers and sliding flat faces."""
        phi, q = self.lift()
        from scipy.interpolate import CubicSpline

        spline = CubicSpline(phi, q, bc_type="periodic")
        at = np.linspace(phi[0], phi[-1], 360 * FINE + 1)
        slows, load = -self._inertia * spline(at, 2), float(self.spring.stiffness) * spline(at) + self.load  # pyright: ignore[reportArgumentType]
        if np.any(load <= 0.0):
            return 0.0
        return float(np.sqrt(np.min(load[slows > 0.0] / slows[slows > 0.0], initial=np.inf)))

    def lift(self) -> tuple[Array, Array]:
        """Angles (n,) [rad] of the cam about its axis from the initial pose, a turn, and the lifts q (n,) [m, of a
        follower that swings rad] there. Raises `InputError` as `jump_speed`."""
        shape: Any = self.cam.surface.shape
        curve = shape.curve
        if not curve.closed:
            raise InputError(
                f"cam {self.name!r}: the curve of {self.cam.label} is open, no lift over a turn is defined"
            )
        u = np.sort(np.concatenate([curve.knots[:-1], curve.knots[:-1] + 0.5 * np.diff(curve.knots)]))
        c, n = curve.at(u), curve.normal(u)
        d = self._in_plane(self.direction, False)
        profile = self.follower.surface.shape.profile()
        center = self._in_plane(self.follower.body.to_world(np.asarray(self.follower.surface.shape.axis_point)), True)
        if profile.flat and self.pivot is None:
            m = self._in_plane(_world(self.follower.body, self.follower.surface.shape.normal(0.0, 0.0)), False)
            angle = np.arctan2(*(-m)[::-1]) - np.arctan2(n[:, 1], n[:, 0])
            q = (np.sum(c * n, axis=1) + center @ m) / -(d @ m)
        elif not profile.planar:
            p = c + float(profile.radius) * n
            square = np.sum(p**2, axis=1)
            if self.pivot is None:
                off = center - (center @ d) * d
                q = np.sign(center @ d) * np.sqrt(np.maximum(square - off @ off, 0.0))
                place, q = off + q[:, None] * d, q - center @ d
            else:
                at = self._in_plane(self.pivot, True)
                a, arm = -at, center - at  # from the pivot to the axis of the cam and to the roller
                la, lr = np.linalg.norm(a), np.linalg.norm(arm)
                alpha = np.arccos(np.clip((la**2 + lr**2 - square) / (2.0 * la * lr), -1.0, 1.0))
                start = np.arccos(np.clip(a @ arm / (la * lr), -1.0, 1.0))
                turned = np.sign(a[0] * arm[1] - a[1] * arm[0]) * alpha
                e = a / la
                place = at + lr * np.stack(
                    [np.cos(turned) * e[0] - np.sin(turned) * e[1], np.sin(turned) * e[0] + np.cos(turned) * e[1]],
                    axis=1,
                )
                q = alpha - start
            angle = np.arctan2(place[:, 1], place[:, 0]) - np.arctan2(p[:, 1], p[:, 0])
        else:
            raise InputError(
                f"cam {self.name!r}: the lift is known of rollers, and of flat faces that slide; {self.follower.label} "
                "is another follower"
            )
        order = np.argsort(angle := np.remainder(angle, 2.0 * np.pi))
        phi, q = angle[order], q[order]
        apart = np.append(np.diff(phi) > 1e-9, True)
        phi, q = phi[apart], q[apart]
        return np.append(phi, phi[0] + 2.0 * np.pi), np.append(q, q[0])

    @property
    def _inertia(self) -> float:
        """kg, of a follower that swings kg m2 about its pivot; a roller on its pin is a point there."""
        if self.pivot is None:
            return sum(float(body.mass) for body in self.moving)
        axis, total = _world(self.cam.body, self.cam.surface.shape.e_a), 0.0
        for body in self.moving:
            off = body.to_world(body.center_of_mass) - self.pivot
            total += float(body.mass) * float(off @ off - (off @ axis) ** 2)
            if self.pin is None or body is not self.follower.body:
                own = rot.matrix(body.rotation) @ np.asarray(body.inertia) @ rot.matrix(body.rotation).T
                total += float(axis @ own @ axis)
        return total

    def _in_plane(self, value: Array, point: bool) -> Array:
        """A world point, or a direction, in the axes of the curve (2,)."""
        shape: Any = self.cam.surface.shape
        value = value - self.cam.body.to_world(np.asarray(shape.axis_point)) if point else value
        return shape.frame[:2] @ (rot.matrix(self.cam.body.rotation).T @ value)


@named_arguments
def add_cam(
    scene: Scene,
    cam: SurfacePort,
    follower: SurfacePort,
    *,
    name: str,
    speed: SignalLike | None = None,
    carrier: Body | None = None,
    direction: Vector | None = None,
    pivot: Vector | None = None,
    stiffness: float = 0.0,
    damping: float = 0.0,
    preload: float | Signal = 0.0,
    friction: FrictionLike = 0.0,
    cells: tuple[int, Any] | None = None,
) -> CamPair:
    """Put a follower on a cam: joints, drive, spring and contact; returns them. The follower is moved until it touches.

    scene: with the bodies; name: of the contact; its joints, drive and spring are "NAME shaft", "guide", "pin",
    "drive" and "spring". cam: an extruded surface, about whose axis (through `axis_point`) its body rotates on the
    ground, driven with `speed` [rad/s], a number or a signal; None: shaft and drive are yours. follower: surface of a
    roller or of a flat or any other follower; one of both is flexible, or a half-space. carrier: rigid body that the
    roller rotates on, on a pin through its `axis_point`; None: the follower's own body is guided. direction (3,),
    world: along which the follower slides away from the cam, None: from the axis of the cam to the follower; or pivot
    (3,) [m], world: it swings about an axis there, parallel to that of the cam. stiffness, damping, preload: of the
    spring between ground and follower, `forces.JointSpringDamper`, in N/m, N s/m and N, with a pivot N m/rad, N m s/rad
    and N m; preload in the position in which it touches, positive onto the cam, a number or a signal. friction, cells:
    as for `Contact`. Joints are on those interfaces of flexible bodies that lie on their axes. Raises `InputError` for
    a cam that is no extruded surface, directions along the axis, bodies without such an interface, and a follower that
    misses the cam.
    """
    label = f"cam {name!r}"
    for port, what in ((cam, "cam"), (follower, "follower")):
        if not isinstance(port, SurfacePort) or not isinstance(port.body, Body):
            raise InputError(f"{label}: {what} must be a surface of a body, body['face'], got {port!r}")
    if not isinstance(cam.surface.shape, Extruded):
        raise InputError(
            f"{label}: {cam.label} is a {cam.surface.shape.kind}; a cam is surfaces.Extruded, with a curve such as "
            "surfaces.cam(lift, ...)"
        )
    if carrier is not None and (not isinstance(carrier, Body) or carrier.reduced is not None):
        raise InputError(f"{label}: carrier must be a rigid body of the scene, got {carrier!r}")
    if direction is not None and pivot is not None:
        raise InputError(
            f"{label}: give direction, for a follower that slides, or pivot, for one that swings, not both"
        )
    axis, center = _world(cam.body, cam.surface.shape.e_a), cam.body.to_world(np.asarray(cam.surface.shape.axis_point))
    contact = Contact(
        *((cam, follower) if follower.rigid else (follower, cam)), friction=friction, cells=cells, name=name
    )
    moving = (follower.body,) if carrier is None else (carrier, follower.body)
    place = follower.body.to_world(np.asarray(follower.surface.shape.axis_point))
    point = np.zeros(3)
    if pivot is None:
        along = _across(place - center if direction is None else direction, axis, f"{label}: direction")
        towards = along if contact.b is follower else -along
        _shift(moving, closing_distance(contact, towards, 0.0) * along)
    else:
        point = require_array(pivot, f"{label}: pivot", (3,))
        along = axis * float(np.sign(np.cross(axis, place - point) @ (place - center)) or 1.0)
        _swing(contact, moving, point, along, follower, label)
    place = follower.body.to_world(np.asarray(follower.surface.shape.axis_point))
    shaft = drive = pin = None
    if speed is not None:
        signal = as_signal(speed, f"{label}: speed")
        shaft = scene.add(Revolute(scene.ground, _port(cam.body, center, axis, label), axis=axis, name=f"{name} shaft"))
        drive = scene.add(Drive(shaft, signal, quantity="velocity", name=f"{name} drive"))
        cam.body.angular_velocity = float(signal(0.0)) * axis
    guided = moving[0]
    if pivot is None:
        guide: Any = Prismatic(scene.ground, _port(guided, place, None, label), axis=along, name=f"{name} guide")
    else:
        guide = Revolute(scene.ground, _port(guided, point, along, label), axis=along, name=f"{name} guide")
    scene.add(guide)
    if carrier is not None:
        bore = _port(follower.body, place, axis, label)
        pin = scene.add(Revolute(_port(carrier, place, axis, label), bore, axis=axis, name=f"{name} pin"))
    rate, load = require_number(stiffness, f"{label}: stiffness"), as_signal(preload, f"{label}: preload")
    spring = scene.add(JointSpringDamper(guide, rate, damping, preload=preload, name=f"{name} spring"))
    scene.add(contact)
    weight = 0.0
    for body in moving:
        arm = along if pivot is None else np.cross(along, body.to_world(body.center_of_mass) - point)
        weight -= float(body.mass) * float(scene.gravity @ arm)
    pair = CamPair(
        name, contact, cam, follower, moving, guide, spring, shaft, drive, pin, along,
        None if pivot is None else point, float(load(0.0)) + weight,
    )  # fmt: skip
    scene.cams.append(pair)
    return pair


def _world(body: Body, direction: Any) -> Array:
    return rot.matrix(body.rotation) @ np.asarray(direction)


def _across(direction: Any, axis: Array, label: str) -> Array:
    """The unit direction across the axis."""
    given = require_direction(direction, label)
    across = given - (given @ axis) * axis
    if np.linalg.norm(across) < ACROSS:
        raise InputError(f"{label} must not be along the axis of the cam; give one in its plane, away from the axis")
    return across / np.linalg.norm(across)


def _port(body: Body, point: Array, axis: Array | None, label: str) -> Any:
    """The port of a rigid body at a world point, of a flexible one the interface nearest to the line through it along
    `axis`, on which it must lie; None: anywhere."""
    if body.reduced is None:
        return body.at(body.to_user(point))
    places = body.to_world([interface.point for interface in body.reduced.interfaces.values()]) - point
    off = np.linalg.norm(places if axis is None else places - np.outer(places @ axis, axis), axis=1)
    if not len(off) or (axis is not None and off.min() > ON_AXIS):
        nearest = f"; the nearest is {off.min():.3g} m away" if len(off) else ""
        raise InputError(
            f"{label}: body {body.name!r} has no interface on the axis through {point.round(6).tolist()} m{nearest}; "
            "reduce it with one there (points={...} of a half-space), or give a roller a rigid carrier"
        )
    return body[list(body.reduced.interfaces)[int(np.argmin(off))]]


def _shift(bodies: tuple[Body, ...], shift: Array) -> None:
    for body in bodies:
        body.position = body.position + shift


def _swing(
    contact: Contact, bodies: tuple[Body, ...], pivot: Array, axis: Array, follower: SurfacePort, label: str
) -> None:
    """Rotates the bodies about the pivot until the surfaces touch."""
    for _ in range(SWINGS):
        gap = smallest_gap(contact)[0]
        if abs(gap) < CLOSED:
            return
        lever = follower.body.to_world(np.asarray(follower.surface.shape.axis_point)) - pivot
        lever = lever - (lever @ axis) * axis
        turn = rot.rotation_vector_matrix(-gap / float(np.linalg.norm(lever)) * axis)
        for body in bodies:
            body.position = pivot + turn @ (body.position - pivot)
            body.rotation = rot.quaternion(turn @ rot.matrix(body.rotation))
    raise InputError(
        f"{label}: the follower misses the cam when it swings about {pivot.round(6).tolist()} m; correct pivot, arm or "
        "the place of the cam"
    )
