"""The undeformed gap between the true shapes of a contact pair, and the distance to move a body to close it.

Gap. A point of the first true surface at chart coordinates (theta, z) is x_1(theta, z) in the world. Its gap is its
signed normal distance from the second surface, positive in the free space: the chart of the second shape gives it, and
with it the nearest point there. A point whose nearest point lies outside the second surface's grid has none; a rigid
surface has no end. Two points *face* each other where n_1.n_2 < 0: the back of a roller does not face the plate it
lies on. The smallest gap over the part of the first surface that faces the second is the initial gap of the pair. It is
found on a grid that is refined about the best point; since the gap is flat there, an error e of the position causes an
error of e^2/(2 R) of the value only.

Closing from outside. m(s), the smallest gap when the second body is moved by s along a direction, changes by at most ds
when s does: from an open gap a step of m(s) - gap never passes the first touch (sphere tracing). Nor does the chord
through the last two positions while m is convex, as it is between convex bodies, and it is much faster along a
direction that hardly closes the gap. In a hollow m is concave and the chord passes the touch, which then lies between.

Closing from within. A pin in a bore is never outside: where a surface is an inside form the search begins where the
bodies are, along the direction first, then against it. Where they overlap there, the position of the largest gap is
found first (m is concave in s for a body within a convex hollow), and the search returns from there.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from warpffrf.model.bodies import Body, Ground, SurfacePort
from warpffrf.model.contact import Contact
from warpffrf.model.errors import InputError, require_direction, require_number

ZOOM_POINTS = (73, 33)  # grid around and along: 5 degrees first, enough to bracket the one minimum of convex surfaces
ZOOM_FACTOR = 8.0  # each refinement shrinks the searched rectangle by this
ZOOM_ROUNDS = 9  # 8^8 below the first spacing: the position to 1e-8 rad, the value to round-off
CLOSE_TOLERANCE = 1e-12  # of the size of the surfaces: round-off of coordinates times the condition of the distance
CLOSE_STEPS = 200  # chords need about ten; more where m bends, as past an edge
FURTHER_STARTS = 12  # doublings of the reach: a direction at 0.02 degrees to a plane still leaves it
DIRECTION_DIGITS = 3  # of a direction that a message names: 0.03 degrees
GOLDEN = 0.5 * (np.sqrt(5.0) - 1.0)
GOLDEN_STEPS = 50  # 0.618^50 = 4e-11 of the bracket: a hollow that is open by less is full
UPHILL_STEPS = 40  # doublings from the overlap: it is no larger than the bodies
SAMPLES = (72, 5)  # points around and along: every 5 degrees

Nearest = tuple[float, float, float]  # smallest gap [m] and its position theta, z on the first surface


@dataclass(frozen=True)
class GapSamples:
    """Gaps (n,) [m] at points (n, 3) of the first surface in the world, and the second one's normals (n, 3)
    opposite."""

    gap: np.ndarray
    place: np.ndarray
    normal: np.ndarray

    def below(self, gap: float) -> GapSamples:
        """Those with a gap of less than `gap` [m]."""
        near = self.gap < gap
        return GapSamples(self.gap[near], self.place[near], self.normal[near])


def undeformed_gap(contact: Contact, theta: Any, z: Any, offset: Any = (0.0, 0.0, 0.0)) -> np.ndarray:
    """Gap [m] at chart coordinates theta [rad, of a plane m], z [m] of the first surface, at the initial pose; positive
    is open.

    `offset` (3,) [m] moves the second body in the world. NaN where a point lies outside the second surface's grid.
    """
    return _gap(contact, theta, z, offset)[0]


def smallest_gap(contact: Contact, offset: Any = (0.0, 0.0, 0.0)) -> tuple[float, float, float]:
    """Smallest undeformed gap [m] and its position (theta [rad, of a plane m], z [m]) on the first surface; negative is
    interference.

    `offset` (3,) [m] moves the second body in the world. Raises `InputError` where the surfaces do not face each other.
    """
    found = facing_gap(contact, offset)
    if found is None:
        raise InputError(
            f"contact {contact.name!r}: the surfaces {contact.a.label} and {contact.b.label} do not face each "
            "other anywhere along their width; move a body"
        )
    return found


def gap_samples(contact: Contact, nearest: Nearest) -> GapSamples:
    """Gaps all over the part of the first surface that faces the second, at the initial pose, the smallest one too."""
    (theta, half_theta), (z, half_z) = _first_patch(contact)
    around, along = (
        middle + half * np.linspace(-1.0, 1.0, count)
        for middle, half, count in zip((theta, z), (half_theta, half_z), SAMPLES, strict=True)
    )
    place = np.array([*((t, s) for t in around for s in along), nearest[1:]])
    gap, facing = _gap(contact, place[:, 0], place[:, 1], np.zeros(3))
    place = place[use := facing & np.isfinite(gap)]
    body, second = contact.b.body, contact.b.surface.shape
    world = contact.a.body.to_world(contact.a.surface.shape.point(place[:, 0], place[:, 1]))
    normal = body.to_world(second.normal(*second.chart(body.to_user(world))[:2])) - body.position
    return GapSamples(gap[use], world, normal)


def facing_gap(contact: Contact, offset: Any = (0.0, 0.0, 0.0)) -> Nearest | None:
    """As `smallest_gap`, None where the surfaces do not face each other."""
    grid = contact.a.surface.grid
    (theta, half_theta), (z, half_z) = _first_patch(contact)
    low, high = theta - half_theta, theta + half_theta
    best = np.nan
    for _ in range(ZOOM_ROUNDS):
        around = theta + half_theta * np.linspace(-1.0, 1.0, ZOOM_POINTS[0])
        if not grid.periodic:
            around = np.clip(around, low, high)
        along = np.clip(z + half_z * np.linspace(-1.0, 1.0, ZOOM_POINTS[1]), grid.z[0], grid.z[-1])
        gaps, facing = _gap(contact, around[:, None], along[None, :], offset)
        gaps = np.where(facing, gaps, np.nan)
        if np.all(np.isnan(gaps)):
            return None
        i, j = np.unravel_index(np.nanargmin(gaps), gaps.shape)
        best, theta, z = float(gaps[i, j]), float(around[i]), float(along[j])
        half_theta, half_z = half_theta / ZOOM_FACTOR, half_z / ZOOM_FACTOR
    return best, theta, z


def closing_distance(contact: Contact, along: Any, gap: float) -> float:
    """Distance [m] to move the second body along the direction `along` (3,), world, until the smallest gap is `gap`
    [m].

    Of several such positions it is the one reached from far out on the side of `along`; where a surface is an inside
    form, the first one from the body's position, along the direction if there is one, else against it. Raises
    `InputError` where the second body passes the first without touching.
    """
    label = f"contact {contact.name!r}: close_gap"
    direction = require_direction(along, f"{label}: along")
    gap = require_number(gap, f"{label}: gap")

    s = _distance(contact, direction, gap)
    if s is None:
        how = f"{moved_body(contact).name!r} along {shown_direction(direction)}"
        if contact.b.on_ground:
            how = f"{moved_body(contact).name!r} against along={shown_direction(direction)}, as the ground stays,"
        if _closes(contact, -direction, gap):
            cure = f"along={shown_direction(-direction)} does"
        else:
            inside = _inside(contact)
            cure = "choose a direction " + (
                "along which the body can move" if inside else "that points from the first body to the second"
            )
        raise InputError(f"{label}: moving {how} never brings the gap to {gap:g} m; {cure}")
    return s


def passed(contact: Contact, along: Any, distance: float) -> list[str]:
    """A doubt about bodies with outside forms that moving by `distance` [m] along the direction `along` takes to the
    other side of each other; none otherwise."""
    a, b = contact.a.body, contact.b.body
    if contact.a.on_ground or contact.b.on_ground or _inside(contact):
        return []
    direction = require_direction(along, "close_gap: along")
    before = float(np.dot(np.subtract(b.position, a.position), direction))
    if before * (before + distance) >= 0.0:
        return []
    return [
        f"contact {contact.name!r}: close_gap moved {b.name!r} by {distance:.4g} m past {a.name!r}, to its other side; "
        f"if it should stay where it is, give along={shown_direction(-direction)}, or the contact its surfaces in the "
        "other order"
    ]


def closing_direction(contact: Contact, theta: float, z: float) -> str | None:
    """A direction for `closing_distance`, as text, of overlapping surfaces with the deepest point at theta, z of the
    first: along its normal there, or against it. None where neither leads to contact."""
    first = contact.a.body
    normal = first.to_world(contact.a.surface.shape.normal(theta, z)) - first.position
    for direction in (np.round(normal, DIRECTION_DIGITS), np.round(-normal, DIRECTION_DIGITS)):
        if _closes(contact, direction / np.linalg.norm(direction), 0.0):
            return shown_direction(direction)
    return None


def moved_body(contact: Contact) -> Body | Ground:
    """The body that `Scene.close_gap` moves: the second, or opposite the ground the first."""
    return contact.a.body if contact.b.on_ground else contact.b.body


def shown_direction(direction: np.ndarray) -> str:
    """A direction for messages, (0, 0, -1)."""
    return "(" + ", ".join(f"{d + 0.0:.4g}" for d in direction) + ")"


def theta_offset(surface: Any) -> float:
    """Angle [rad] of the grid's theta = 0 in the chart of the shape; 0 of a plane."""
    shape, e_0 = surface.shape, surface.grid.e_0
    return float(np.arctan2(e_0 @ shape.e_1, e_0 @ shape.e_0))


def _first_patch(contact: Contact) -> tuple[tuple[float, float], tuple[float, float]]:
    """Middle and half of the extent of the first surface's grid in its chart, in theta and in z."""
    first = contact.a.surface
    grid = first.grid
    z = (0.5 * (grid.z[0] + grid.z[-1]), 0.5 * (grid.z[-1] - grid.z[0]))
    if grid.periodic:
        return (0.0, 0.5 * first.shape.profile().turn), z
    half = 0.5 * grid.pitch * (grid.columns - 1)
    return (grid.theta_start + theta_offset(first) + half, half), z


def _inside(contact: Contact) -> bool:
    return any(port.surface.shape.side < 0.0 for port in contact.ports)


def _distance(contact: Contact, direction: np.ndarray, gap: float) -> float | None:
    """`closing_distance` along the unit vector `direction`, None where there is no touch."""
    return (_from_within if _inside(contact) else _from_outside)(contact, direction, gap)


def _closes(contact: Contact, direction: np.ndarray, gap: float) -> bool:
    """Whether `closing_distance` finds a position. For messages."""
    try:
        return _distance(contact, direction, gap) is not None
    except InputError:
        return False


def _gap(contact: Contact, theta: Any, z: Any, offset: Any) -> tuple[np.ndarray, np.ndarray]:
    """Gap [m], NaN outside the second grid, and whether the surfaces face each other there."""
    first, second = contact.a.surface.shape, contact.b.surface.shape
    body_a, body_b = contact.a.body, contact.b.body
    theta, z = np.broadcast_arrays(np.asarray(theta, float), np.asarray(z, float))
    world = body_a.to_world(first.point(theta, z)) - np.asarray(offset, float)
    local = body_b.to_user(world)
    (theta_b, z_b, _), distance = second.chart(local), second.gap(local)
    n_a = body_a.to_world(first.normal(theta, z)) - body_a.position
    n_b = body_b.to_world(second.normal(theta_b, z_b)) - body_b.position
    facing = np.einsum("...i,...i->...", n_a, n_b) < 0.0
    return np.where(_beside(contact.b.surface, theta_b, z_b), np.nan, distance), facing


def _beside(surface: Any, theta: np.ndarray, z: np.ndarray) -> np.ndarray:
    """True where chart coordinates lie outside the grid of the surface; a rigid surface has none."""
    grid = surface.grid
    if grid is None:
        return np.zeros(z.shape, dtype=bool)
    beside = (z < grid.z[0]) | (z > grid.z[-1])
    if grid.periodic:
        return beside
    # the outermost nodes reach a pitch beyond the outermost columns
    half = 0.5 * grid.pitch * (grid.columns + 1)
    off = theta - theta_offset(surface) - grid.theta_start - 0.5 * grid.pitch * (grid.columns - 1)
    turn = surface.shape.profile().turn
    if np.isfinite(turn):
        off = np.remainder(off + 0.5 * turn, turn) - 0.5 * turn
    return beside | (np.abs(off) > half)


def _trace(open_by: Callable[[float], float], s: float, sign: float, reach: float, tolerance: float) -> float | None:
    """First touch, to `tolerance` [m], from the open position `s` towards `sign`, within `reach` [m]; None where there
    is none."""
    start, value = s, open_by(s)
    last, last_value = s, -np.inf
    for _ in range(CLOSE_STEPS):
        if abs(value) <= tolerance:
            return s
        step = value
        if 0.0 < value < last_value < np.inf:
            chord = value * abs(s - last) / (last_value - value)
            step = chord if abs(s + sign * chord - start) <= reach else value
        ahead = s + sign * step
        if abs(ahead - start) > reach:
            return None
        value_ahead = open_by(ahead)
        if value > 0.0 and value_ahead < -tolerance:
            return _between(open_by, s, value, ahead, value_ahead, tolerance)
        last, last_value, s, value = s, value, ahead, value_ahead
    return None


def _between(
    open_by: Callable[[float], float], a: float, value_a: float, b: float, value_b: float, tolerance: float
) -> float | None:
    """Touch between the open position `a` and the closed position `b` (false position, Illinois)."""
    for _ in range(CLOSE_STEPS):
        s = b - value_b * (b - a) / (value_b - value_a)
        value = open_by(s)
        if abs(value) <= tolerance:
            return s
        if value * value_b < 0.0:
            a, value_a = b, value_b
        else:
            value_a *= 0.5
        b, value_b = s, value
    return None


def _from_outside(contact: Contact, direction: np.ndarray, gap: float) -> float | None:
    def open_by(s: float) -> float:
        return smallest_gap(contact, s * direction)[0] - gap

    centers = [port.body.to_world(port.surface.shape.axis_point) for port in contact.ports]
    if contact.b.rigid:
        centers[1] = _abreast(contact.b, centers[0])
    # start where the bodies are apart for certain, and stop when they are on the other side
    size = sum(_extent(port) for port in contact.ports)
    reach, tolerance = size + max(gap, 0.0), CLOSE_TOLERANCE * size
    beside = float((centers[0] - centers[1]) @ direction)
    if not contact.b.rigid:
        return _trace(open_by, beside + reach, -1.0, 2.0 * reach, tolerance)
    for _ in range(FURTHER_STARTS):  # a plane at an angle to the direction has to move further
        if open_by(beside + reach) > 0.0:
            break
        reach *= 2.0
    else:
        return None
    apart = float(np.linalg.norm(centers[0] - centers[1]))
    return _trace(open_by, beside + reach, -1.0, 2.0**FURTHER_STARTS * (reach + apart), tolerance)


def _from_within(contact: Contact, direction: np.ndarray, gap: float) -> float | None:
    def open_by(s: float) -> float:
        """Infinite where the surfaces cease to face each other: a pin that has left its bore."""
        found = facing_gap(contact, s * direction)
        return np.inf if found is None else found[0] - gap

    size = sum(_extent(port) for port in contact.ports)
    reach, tolerance = 2.0 * size + abs(gap), CLOSE_TOLERANCE * size
    here = smallest_gap(contact)[0] - gap
    if here >= -tolerance:
        towards = _trace(open_by, 0.0, 1.0, reach, tolerance)
        return _trace(open_by, 0.0, -1.0, reach, tolerance) if towards is None else towards
    start = _open_place(open_by, here)
    return None if start is None else _trace(open_by, start, -float(np.sign(start)), reach, tolerance)


def _open_place(open_by: Callable[[float], float], here: float) -> float | None:
    """An open position along the direction, from 0, where the gap is short by `here` < 0; None where there is none:
    increasing in doubled steps, then golden section between the last ones."""
    step = -here
    sides = [open_by(step), open_by(-step)]
    low, high = -step, step
    if max(sides) > here:
        step, value = (step, sides[0]) if sides[0] >= sides[1] else (-step, sides[1])
        low, high = 0.0, 2.0 * step
        for _ in range(UPHILL_STEPS):
            further = open_by(high)
            if value >= 0.0 or not further > value:
                break
            low, step, high, value = step, high, 2.0 * high, further
        if value >= 0.0:
            return step
    inner = [high - GOLDEN * (high - low), low + GOLDEN * (high - low)]
    values = [open_by(s) for s in inner]
    for _ in range(GOLDEN_STEPS):
        best = int(np.argmax(values))
        if values[best] >= 0.0:
            return inner[best]
        if best == 0:
            high, inner[1], values[1] = inner[1], inner[0], values[0]
            inner[0] = high - GOLDEN * (high - low)
            values[0] = open_by(inner[0])
        else:
            low, inner[0], values[0] = inner[0], inner[1], values[1]
            inner[1] = low + GOLDEN * (high - low)
            values[1] = open_by(inner[1])
    return None


def _extent(port: SurfacePort) -> float:
    """Radius [m] of a sphere about the axis point that contains the surface; of a rigid one its extent across."""
    surface = port.surface
    shape, grid = surface.shape, surface.grid
    profile = shape.profile()
    if profile.height is not None:
        return shape.size
    if profile.curve is not None:
        across = float(np.linalg.norm(profile.curve.points, axis=1).max())
    elif grid is None:
        return shape.size if profile.planar else float(shape.radius)
    else:
        across = float(np.max(np.abs(grid.theta)) if profile.planar else np.max(shape.radius_at(grid.z)))
    return float(np.hypot(across, 0.0 if grid is None else np.max(np.abs(grid.z))))


def _abreast(port: SurfacePort, point: np.ndarray) -> np.ndarray:
    """The point (3,) [m], world, of the axis or the plane of an infinite surface nearest to `point`; of a crown its
    centre."""
    shape = port.surface.shape
    c, user = shape.axis_point, port.body.to_user(point)
    if shape.profile().flat:
        return port.body.to_world(user - ((user - c) @ shape.e_0) * shape.e_0)
    if shape.profile().crown or shape.profile().height is not None:  # it has a middle
        return port.body.to_world(c)
    return port.body.to_world(c + ((user - c) @ shape.e_a) * shape.e_a)
