r"""Nearest points of two rigid surfaces at the initial pose, for laws that require the curvatures there and for checks.

The least signed distance of the points of one surface from the other is the gap, of surfaces that overlap minus the
depth. A ball's is that of its centre less its radius; else the points of a chart are searched on a lattice that is
refined around the best one. The kernels use another method (`warpffrf_kernels.lumped.places`).

With the curvature tensors B of both surfaces there (positive where convex) the gap of points that lie opposite each
other is g + 1/2 t . (B_1 + B_2) t at the distance t across the normal: the eigenvalues of the sum are the relative
principal curvatures. A form deviation (`warpffrf.model.surfaces.form_deviations`) adds to the gap at the point;
curvatures are those of the ideal surfaces.

Assembly. Bodies that move together with a shifted body, so that the joints between them remain closed.

A joint constrains some directions of the relative motion of its sides. If a shift has a component along one of them,
the body on the other side moves too, and so on from joint to joint. The ground is fixed, and so is every body joined to
a body that must not move: the rest of the chain then cannot follow, and the body moves alone.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any
from weakref import WeakKeyDictionary

import numpy as np

from warpffrf.model.bodies import GROUND_INDEX, Body, Ground, SurfacePort
from warpffrf.model.joints import Joint

if TYPE_CHECKING:
    from warpffrf.model.scene import Scene

LATTICE = (73, 41)  # points around and along: every 5 degrees
FINER = (13, 13)  # of the rounds after the first
ROUNDS, CLOSER = 24, 3.0  # refinement factor per round: to 1e-11; the error of the gap is of second order
EDGE = 1.0 - 1e-9  # of a crown's radius: its chart ends there


@dataclass(frozen=True)
class Nearest:
    """The smallest gap [m], negative where the surfaces overlap, the point (3,) [m] in the world, the normal (3,) of
    the second surface there, and the relative principal curvatures [1/m], the smaller one first."""

    gap: float
    place: np.ndarray
    normal: np.ndarray
    curvatures: tuple[float, float]


def nearest(a: SurfacePort, b: SurfacePort) -> Nearest:
    """Nearest points of two rigid surfaces at the initial pose of their bodies."""
    x, y, gap = _opposite(a, b)
    gap += _missing(a, x) + _missing(b, y)
    bend = _tensor(a, x) + _tensor(b, y)
    n = _normal(b, y)
    values, vectors = np.linalg.eigh(bend)
    across = np.argsort(np.abs(vectors.T @ n))[:2]  # the third eigenvector is the normal
    small, large = sorted(float(values[i]) for i in across)
    return Nearest(float(gap), 0.5 * (x + y), n, (small, large))


def is_ball(port: SurfacePort) -> bool:
    """True of the outside of a sphere."""
    profile = port.surface.shape.profile()
    return profile.spherical and profile.side > 0.0


def lamina_gap(roller: SurfacePort, other: SurfacePort, z: np.ndarray, drop: np.ndarray) -> float:
    """Smallest gap [m] of laminae of a roller at z (m,) [m], with the drop (m,) [m] of its profile."""
    shape, width = roller.surface.shape, np.pi
    theta = np.zeros(len(z))
    gap = np.full(len(z), np.inf)
    for i in range(ROUNDS):
        tried = theta[:, None] + width * np.linspace(-1.0, 1.0, FINER[0] if i else LATTICE[0])
        world = roller.body.to_world(shape.point(tried, z[:, None]))
        distance = other.surface.shape.gap(other.body.to_user(world)) + _missing(other, world)
        best = np.argmin(distance, axis=1)
        theta, gap = tried[np.arange(len(z)), best], distance[np.arange(len(z)), best]
        width /= CLOSER
    return float(np.min(gap + drop))


def _least(one: SurfacePort, other: SurfacePort) -> tuple[float, float]:
    """Chart coordinates of the point of `one` with the least distance from `other`."""
    shape, opposite = one.surface.shape, other.surface.shape
    middle = one.body.to_user(other.body.to_world(opposite.axis_point))
    reach = float(np.linalg.norm(middle - shape.axis_point)) + float(shape.radius) + float(opposite.size)
    low, high = _meridian_ends(one.surface, reach)
    center, half = (0.0, 0.5 * (low + high)), (np.pi, 0.5 * (high - low))
    first, last = -np.inf, np.inf
    if (ends := _ends(one)) is not None:
        center, half = (0.5 * (ends[0] + ends[1]), center[1]), (0.5 * (ends[1] - ends[0]), half[1])
        first, last = ends
    for tried in range(ROUNDS):
        counts = FINER if tried else LATTICE
        around, along = (c + h * np.linspace(-1.0, 1.0, n) for c, h, n in zip(center, half, counts, strict=True))
        around, along = np.clip(around, first, last), np.clip(along, low, high)
        world = one.body.to_world(shape.point(around[:, None], along[None, :]))
        distance = opposite.gap(other.body.to_user(world))
        i, j = np.unravel_index(np.argmin(distance), distance.shape)
        center, half = (float(around[i]), float(along[j])), (half[0] / CLOSER, half[1] / CLOSER)
    return center


def _meridian_ends(surface: Any, reach: float) -> tuple[float, float]:
    """The limits [m] of a surface's meridian: of its grid or its table, of others of its arc and `reach` [m]."""
    if surface.grid is not None:
        return float(surface.grid.z[0]), float(surface.grid.z[-1])
    if (height := surface.shape.profile().height) is not None:
        return -float(height.half[1]), float(height.half[1])
    table = getattr(surface.shape, "table", None)
    if table is not None:
        return float(table[0, 0]), float(table[0, -1])
    limit = min(reach, abs(surface.shape.profile().crown) * EDGE or np.inf)
    return -limit, limit


def curvatures_on(one: SurfacePort, other: SurfacePort) -> tuple[float, float]:
    """Relative curvatures [1/m] of both where the ideal surfaces are nearest, along the circle about the axis of `one`
    and along its meridian."""
    return facing_place(one, other).curvatures


@dataclass(frozen=True)
class FacingPlace:
    """Where two surfaces are nearest, in the directions along the circle about the axis of the first and along its
    meridian: the relative `curvatures` [1/m], those of the `sharper` surface [1/m, absolute]; z [m] and the `slope`
    dR/dz of the first, of a helical one that of its generator to the axis, and the angle `lean` [rad] of its normal to
    the plane that it is a height over."""

    curvatures: tuple[float, float]
    sharper: tuple[float, float]
    z: float
    slope: float
    lean: float = 0.0


def facing_place(one: SurfacePort, other: SurfacePort) -> FacingPlace:
    """The place where the ideal surfaces are nearest."""
    x, y, _ = _opposite(one, other)
    shape: Any = one.surface.shape
    theta, z, _ = shape.chart(one.body.to_user(x))
    bends = np.stack([_tensor(one, x), _tensor(other, y)])
    directions = np.stack([_turned(one, direction) for direction in (shape.around(theta, z), shape.along(theta, z))])
    own = np.einsum("di,sij,dj->sd", directions, bends, directions)
    (around, along), sharper = own.sum(axis=0), np.abs(own).max(axis=0)
    lean = 0.0 if shape.profile().height is None else float(np.arccos(min(shape.normal(theta, z) @ shape.e_0, 1.0)))
    slope = float(shape.slope_at(z))
    if shape.profile().twist:
        axial = float(shape.normal(theta, z) @ shape.e_a)
        slope = axial / np.sqrt(1.0 - axial**2)
    return FacingPlace((float(around), float(along)), (float(sharper[0]), float(sharper[1])), float(z), slope, lean)


_KNOWN: WeakKeyDictionary[Any, tuple[bytes, FacingPlace]] = WeakKeyDictionary()


def meeting_place(contact: Any) -> FacingPlace:
    """The place where the surfaces of a contact are nearest, or will meet where it has `meeting`; found once for the
    poses of the bodies."""
    if contact.meeting is not None:
        return contact.meeting
    poses = b"".join(np.append(port.body.position, port.body.rotation).tobytes() for port in contact.ports)
    if _KNOWN.get(contact, (b"",))[0] != poses:
        _KNOWN[contact] = poses, facing_place(*contact.ports)
    return _KNOWN[contact][1]


def _opposite(a: SurfacePort, b: SurfacePort) -> tuple[np.ndarray, np.ndarray, float]:
    """Nearest points (3,) of both ideal surfaces, world, and the gap [m]."""
    if not is_ball(a) and (is_ball(b) or a.surface.shape.profile().planar):
        y, x, gap = _from(b, a)
        return x, y, gap
    return _from(a, b)


def _from(one: SurfacePort, other: SurfacePort) -> tuple[np.ndarray, np.ndarray, float]:
    """`_opposite` by a search on `one`; a ball needs none."""
    shape = one.surface.shape
    if is_ball(one):
        center = one.body.to_world(shape.axis_point)
        foot, distance = _foot(other, center)
        return center - shape.radius * _normal(other, foot), foot, distance - float(shape.radius)
    theta, z = _least(one, other)
    x = one.body.to_world(shape.point(theta, z))
    return x, *_foot(other, x)


def _missing(port: SurfacePort, x: np.ndarray) -> Any:
    """Depth [m] of the form deviation of a surface at world points (..., 3), 0 without one."""
    form = port.surface.form
    if form is None:
        return 0.0
    return form.at(port.surface.shape.chart(port.body.to_user(x))[0])[0]


def _foot(port: SurfacePort, x: np.ndarray) -> tuple[np.ndarray, float]:
    """The nearest point of a surface (3,), world, and the signed distance of x from it [m]."""
    theta, z, distance = port.surface.shape.chart(port.body.to_user(x))
    return port.body.to_world(port.surface.shape.point(theta, z)), float(distance)


def _normal(port: SurfacePort, x: np.ndarray) -> np.ndarray:
    shape = port.surface.shape
    return _turned(port, shape.normal(*shape.chart(port.body.to_user(x))[:2]))


def _ends(port: SurfacePort) -> tuple[float, float] | None:
    """theta [m] between which an extruded surface, or one over a plane, can be touched: those of its curve or its
    rectangle, or of the contact grid on it; None of other surfaces."""
    surface, profile = port.surface, port.surface.shape.profile()
    curve = profile.curve
    if profile.height is not None:
        return -float(profile.height.half[0]), float(profile.height.half[0])
    if curve is None:
        return None
    along = curve.knots if surface.grid is None or surface.grid.periodic else surface.grid.theta
    return float(along[0]), float(along[-1])


def _closes(port: SurfacePort) -> bool:
    """Whether an extruded surface has no ends along its curve."""
    grid, curve = port.surface.grid, port.surface.shape.profile().curve
    return curve is not None and (curve.closed if grid is None else grid.periodic)


def _tensor(port: SurfacePort, x: np.ndarray) -> np.ndarray:
    """Curvature tensor (3, 3) [1/m] of a surface at its point nearest x, world axes."""
    shape: Any = port.surface.shape
    theta, z, _ = shape.chart(port.body.to_user(x))
    if (ends := _ends(port)) is not None and not _closes(port):
        middle, turn = 0.5 * (ends[0] + ends[1]), shape.profile().turn
        if np.isfinite(turn):
            theta = middle + np.remainder(theta - middle + 0.5 * turn, turn) - 0.5 * turn
        theta = np.clip(theta, *ends)
    axes = np.stack([_turned(port, axis) for axis in np.eye(3)], axis=1)
    return axes @ shape.curvature_tensor(theta, z) @ axes.T


def _turned(port: SurfacePort, direction: np.ndarray) -> np.ndarray:
    return port.body.to_world(direction) - port.body.position


HELD = 1e-9  # of a shift: component along a constrained direction, above round-off of typed axes


def joined_bodies(scene: Scene, body: Body, stays: Body | Ground, shift: np.ndarray) -> list[Body]:
    """`body` and those that joints move with it when it moves by `shift` (3,) [m], world; `body` alone if joints
    connect it to the one that `stays` as well."""
    moved = [body]
    for one in moved:  # extended within the loop
        for joint in scene.joints:
            a, b = (port.body for port in joint.ports)
            other = b if a is one else a if b is one else None
            if other is None or other.index == GROUND_INDEX or other in moved or not holds(joint, shift):
                continue
            if other is stays:
                return [body]
            moved.append(other)
    return moved


def holds(joint: Joint, shift: np.ndarray) -> bool:
    """Whether the sides of `joint` cannot move apart by `shift` (3,) [m], world, at the initial pose."""
    along = np.abs(shift @ joint.axes())
    kinds = {(row.kind, row.i) for row in joint.rows}
    least = HELD * float(np.linalg.norm(shift))
    return any(kind == "distance" or (kind == "translation" and along[i] > least) for kind, i in kinds)


def shift_bodies(scene: Scene, bodies: list[Body], shift: np.ndarray) -> None:
    """Move `bodies` by `shift` (3,) [m], world, and with them the points of the joints between them."""
    for body in bodies:
        body.position = body.position + shift
    for joint in scene.joints:
        if joint.point is not None and all(any(port.body is b for b in bodies) for port in joint.ports):
            joint.point = joint.point + shift
