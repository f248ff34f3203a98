"""Rigid bodies as triangle meshes: the surfaces that contacts know of them, closed to solids.

A rigid body has mass, inertia and surfaces, but no shape. Its surfaces are those of its contacts and oil films:

    ball               the whole ball
    plane              a plate below the places that are touched
    extruded           the prism of a closed curve, a wall below an open one, along the places that are touched
    gear               the whole gear of a gear pair, likewise
    outside form       (cylinder, crowned, profiled, groove, cone) the solid of revolution along its partners
    inside form        (bore, ring, cup) a wall around it, up to an outside form of the body about the same axis
    bearing            rings with lands and bore or outside diameter of the geometry, ribs; rollers of their length with
                       their ends; cage as a band between the rings, through which the elements protrude

Thin rods lead from the centre of mass to joints, forces and round outside forms that lie off it. A body without
surfaces is a marker: a small ball at its centre of mass with these rods. Lengths along an axis that no partner defines
are those of the cylinder with the body's inertia, where the inertia about the axis is that of a cylinder, else the
diameter.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from warpffrf.model.bearings.flanges import ENDS
from warpffrf.model.bearings.geometry import SIDES, BallGeometry, Track, from_description, pair
from warpffrf.model.bearings.parts import DEEP, SHOULDER
from warpffrf.output.geometry.gear_body import FLANK, gear_meshes
from warpffrf.output.geometry.places import Pose, grid_theta_offset
from warpffrf.output.geometry.scene_view import GROUND, BodyView, SceneView
from warpffrf.output.geometry.solids import Piece, TriangleMesh, ball, plate, prism, revolved, rod

ROWS = 60  # saved rows at which touched places are evaluated, at most
ALONG = 33  # points of a meridian
BEYOND = 0.15  # of the length along its partners that a solid of revolution extends beyond them, to either side
BESIDE = 0.3  # of the scene's size that a plane extends beyond the places that are touched
THICK = 0.04  # of the scene's size, of the plate of a plane
WALL = 0.2  # of the radius, of a wall around an inside form
HOLLOW = 0.7  # of the radius of an arc that an inside form or a groove extends from its middle
FACETS = 240  # along the curve of an extruded surface
SQUARES = 48  # each way on a surface over a plane
POLE = 1.0 - 1e-6  # of the radius of an arc: where it ends
COAXIAL = 1e-6  # of the radius, and of a unit vector: surfaces about the same axis
SOLID, THIN = 0.25, 1.05  # inertia about the axis over mass and radius squared, of a cylinder
MARKER, ROD = 0.02, 0.008  # radii of marker and rods, of the scene's size
RIB, WASHER = 0.1, 0.4  # height of a rib and thickness of a washer, of the diameter of an element
CAGE = 0.12, 0.3  # half height and half width of a cage, of the diameter of its elements
PLAIN_SIZE = 0.1  # m, of a scene without anything that has a size

Lines = list[Piece]


@dataclass(frozen=True, eq=False)
class RigidMesh(TriangleMesh):
    """A rigid body, user frame; of the ground in the world. marker: it has no known surface."""

    marker: bool = False


def rigid_meshes(result: Any, size: float | None = None) -> dict[str, RigidMesh]:
    """The mesh of each rigid body of a `Result`, of the ground where it has surfaces, by name.

    size [m]: of the scene, that of planes and markers; None: that of the largest body.
    """
    history, steps = result.history, len(result.time)
    rows = np.unique(np.linspace(0, steps - 1, min(steps, ROWS)).astype(int))
    columns = {name: contact.center_column for name, contact in history.contacts.items()}
    places = {name: contact.place for name, contact in history.lumped_contacts.items()}
    return _Scene(result.view, history.bodies, rows, columns, places).meshes(size)


def meshes_in_state(view: SceneView, bodies: Mapping[str, Any]) -> dict[str, RigidMesh]:
    """The mesh of each rigid body, as of a run, in one state without known patches: `bodies` have a `position` (1, 3)
    [m] and a `rotation` (1, 4). Second surfaces then extend along the whole contact grid of the first one."""
    meshes = _Scene(view, bodies, np.zeros(1, dtype=int), {}, {}).meshes(None)
    return {name: mesh for name, mesh in meshes.items() if name != GROUND}


class _Scene:
    """Surfaces of a scene, and where they are touched: at the columns (T,) of the middles of patches and at the places
    (T, 3) [m] of lumped contacts at `rows`."""

    def __init__(
        self, view: SceneView, motions: Mapping[str, Any], rows: np.ndarray, columns: Mapping[str, np.ndarray],
        places: Mapping[str, np.ndarray],
    ) -> None:  # fmt: skip
        self.view, self.motions, self.rows = view, motions, rows
        self.touched: dict[tuple[str, str], list[np.ndarray]] = {}  # places (n, 3) [m, user frame], by body and surface
        self.bodies = {name: body for name, body in view.bodies.items() if body.reduced is None}
        for name, met in view.pairs.items():
            self._distributed(met, columns.get(name))
        for met in view.films.values():
            self._distributed(met, None)
        for name, place in places.items():
            for body, surface in _sides(view.lumped[name]):
                self._touch(body, surface, [place[i][None] for i in self.rows], self.rows)
        for met in view.small_sliding.values():
            if met.second_body.reduced is None:
                self._keep(met.second_body, met.second_surface_name, met.partners)

    def meshes(self, size: float | None) -> dict[str, RigidMesh]:
        """See `rigid_meshes`."""
        view = self.view
        hidden = {name for bearing in view.bearings.values() for name in bearing["pockets"].values()}  # in a cage
        parts: dict[str, list[TriangleMesh]] = {}
        done: set[tuple[str, str]] = set()
        for bearing in view.bearings.values():
            for name, surfaces, mesh in _bearing(bearing, {**self.bodies, GROUND: self._ground()}):
                parts.setdefault(name, []).append(mesh)
                done |= {(name, surface) for surface in surfaces}
        ends = {at: self._along(*at) for at in self.touched if at[0] in self.bodies}
        for name, mesh in gear_meshes(view, ends).items():
            parts.setdefault(name, []).append(mesh)
            done |= {(name, surface) for surface in self.bodies[name].shapes if surface.startswith(FLANK)}
        flat = []
        for body in (*self.bodies.values(), self._ground()):
            open_shapes = {s: shape for s, shape in body.shapes.items() if (body.name, s) not in done}
            planes = {s: shape for s, shape in open_shapes.items() if shape.profile().planar}
            flat += [(body.name, s, shape) for s, shape in planes.items() if body.name not in hidden]
            done |= {(body.name, s) for s in planes}
            round_ones = {s: shape for s, shape in open_shapes.items() if s not in planes}
            found = self._round(body, round_ones)
            if found:
                parts.setdefault(body.name, []).extend(found)
        extents = [np.ptp(mesh.points, axis=0).max() for some in parts.values() for mesh in some]
        extents += [np.ptp(b.reduced.surface.points, axis=0).max() for b in view.bodies.values() if b.reduced]
        size = size or max([float(e) for e in extents], default=0.0) or self._spread() or PLAIN_SIZE
        for name, surface, shape in flat:
            profile = shape.profile()
            below = _plate if profile.flat else _extruded if profile.height is None else _below_height
            parts.setdefault(name, []).append(below(shape, self.touched.get((name, surface), []), size))
        meshes, within = {}, {n for b in view.bearings.values() for n in (*b["elements"], b["cage"])}
        for body in self.bodies.values():
            if body.name in hidden:
                continue
            center, marker = body.center_of_mass, body.name not in parts
            some = parts.pop(body.name, []) or [ball(center, np.eye(3), MARKER * size, 24)]
            ends = [] if body.name in within else [anchor.point for anchor in view.anchors if anchor.body == body.name]
            own = [shape for s, shape in body.shapes.items() if (body.name, s) not in done]
            ends += [shape.axis_point for shape in own if shape.side > 0.0]  # free space of inside forms
            far = [at for at in ends if np.linalg.norm(at - center) > MARKER * size]
            whole = TriangleMesh.of(
                some + [rod(center, at, ROD * size) for at in np.unique(np.reshape(far, (-1, 3)), axis=0)]
            )
            meshes[body.name] = RigidMesh(whole.points, whole.triangles, marker)
        for name, some in parts.items():
            whole = TriangleMesh.of(some)
            meshes[name] = RigidMesh(whole.points, whole.triangles)
        return meshes

    def _ground(self) -> BodyView:
        """The ground with the surfaces that pairs have of it."""
        touching = (self.view.pairs, self.view.films, self.view.lumped, self.view.small_sliding)
        for met in (one for some in touching for one in some.values()):
            for body, _ in _sides(met):
                if body.name == GROUND:
                    return body
        return BodyView(GROUND, None, 0.0, np.zeros(3))

    # --- places that are touched

    def _along(self, body: str, surface: str) -> tuple[float, float]:
        """First and last touched place [m] along the axis of a surface."""
        z = self.bodies[body].shapes[surface].chart(np.concatenate(self.touched[body, surface]))[1]
        return float(np.min(z)), float(np.max(z))

    def _pose(self, name: str, i: int) -> Pose:
        return Pose.of(self.motions, name, int(i))

    def _distributed(self, met: Any, center_column: np.ndarray | None) -> None:
        """The patches' middles at both ends of the first surface's grid, or the ends of a film, on a rigid second
        surface."""
        if met.second_body.reduced is not None:
            return
        surface = met.first
        grid = surface.grid
        rows, places = (self.rows if center_column is not None else self.rows[:1]), []
        for i in rows:
            column = np.arange(grid.columns) if center_column is None else np.atleast_1d(center_column[i])
            theta = grid.theta_start + grid_theta_offset(surface) + grid.pitch * column
            points = surface.shape.point(*np.meshgrid(theta, np.asarray(grid.z)[[0, -1]])).reshape(-1, 3)
            places.append(self._pose(met.first_body.name, i).to_world(points))
        self._touch(met.second_body, met.second_surface_name, places, rows)

    def _touch(self, body: BodyView, surface: str, world: list[np.ndarray], rows: np.ndarray) -> None:
        if body.reduced is None:
            own = [self._pose(body.name, i).to_user(points) for i, points in zip(rows, world, strict=True)]
            self._keep(body, surface, np.concatenate(own))

    def _keep(self, body: BodyView, surface: str, points: np.ndarray) -> None:
        finite = points[np.all(np.isfinite(points), axis=1)]
        self.touched.setdefault((body.name, surface), []).append(finite)

    # --- bodies

    def _spread(self) -> float:
        """Largest distance [m] between centres of mass and anchors at the start."""
        first = {name: self._pose(name, 0) for name in self.view.bodies}
        points = [pose.to_world(self.view.bodies[name].center_of_mass[None])[0] for name, pose in first.items()]
        for anchor in self.view.anchors:
            points.append((first[anchor.body] if anchor.body else Pose()).to_world(anchor.point[None])[0])
        return float(np.ptp(np.array(points), axis=0).max()) if points else 0.0

    def _round(self, body: BodyView, shapes: dict[str, Any]) -> list[TriangleMesh]:
        """The surfaces of revolution; an outside form that an inside form about the same axis lies within is hollow."""
        found, hollow = [], set()
        for name, shape in shapes.items():
            if shape.side > 0.0:
                continue
            around = [s for s, other in shapes.items() if other.side > 0.0 and _within(shape, other)]
            low, high = self._ends(body, name, shape)
            line = _line(shape, low, high)
            radius = np.max(line[0]) * (1.0 + WALL)
            outer: Piece = ([radius, radius], [high, low])
            if around:
                hollow.add(around[0])
                off = float((shape.axis_point - shapes[around[0]].axis_point) @ shapes[around[0]].e_a)
                r, z = _line(shapes[around[0]], low + off, high + off)
                outer = r[::-1], (z - off)[::-1]
            found.append(revolved(shape.axis_point, shape.frame, _closed([line], outer)))
        for name, shape in shapes.items():
            if shape.side < 0.0 or name in hollow:
                continue
            if shape.profile().spherical:
                found.append(ball(shape.axis_point, shape.frame, shape.radius))
                continue
            line = _line(shape, *self._ends(body, name, shape))
            ends = _face(0.0, line[0][0], line[1][0]), _face(line[0][-1], 0.0, line[1][-1])
            found.append(revolved(shape.axis_point, shape.frame, [ends[0], line, ends[1]]))
        return found

    def _ends(self, body: BodyView, surface: str, shape: Any) -> tuple[float, float]:
        """Ends [m] along the axis of a surface of revolution."""
        places = self.touched.get((body.name, surface), [])
        z = np.concatenate([np.asarray(shape.chart(points)[1]) for points in places] or [np.zeros(1)])
        low, high = float(z.min()), float(z.max())
        half = (0.5 + BEYOND) * (high - low)
        if half < 0.5 * shape.radius:  # touched at points
            half += _half_length(body, shape)
        middle = 0.5 * (low + high)
        return _on_arc(shape, middle - half, middle + half)


def _sides(met: Any) -> tuple[tuple[BodyView, str], tuple[BodyView, str]]:
    return (met.first_body, met.first_surface_name), (met.second_body, met.second_surface_name)


def _within(inside: Any, outside: Any) -> bool:
    """Whether an inside form lies within an outside form about the same axis."""
    across = outside.axis_point - inside.axis_point
    off = np.linalg.norm(np.cross(across, inside.e_a)) / outside.radius
    tilt = np.linalg.norm(np.cross(outside.e_a, inside.e_a))
    return bool(max(off, tilt) < COAXIAL and inside.radius < outside.radius)


def _half_length(body: BodyView, shape: Any) -> float:
    """Half the length [m] of the cylinder with the inertia of the body; the radius where it is no cylinder's."""
    if body.mass > 0.0:
        about = float(shape.e_a @ body.inertia @ shape.e_a)
        along = 1.5 * (float(np.trace(body.inertia)) - 2.0 * about) / body.mass  # half the length, squared
        if SOLID < about / (body.mass * shape.radius**2) < THIN and along > 0.0:
            return float(np.sqrt(along))
    return float(shape.radius)


def _on_arc(shape: Any, low: float, high: float) -> tuple[float, float]:
    """The ends within the arc of the surface; of inside forms and grooves within the part of it that is used."""
    profile = shape.profile()
    if not profile.crown:
        return low, high
    convex = profile.side > 0.0 and profile.crown > 0.0
    most = (POLE if convex else HOLLOW) * abs(profile.crown)
    return max(low, -most), min(high, most)


def _line(shape: Any, low: float, high: float) -> Piece:
    """Radii and positions of the meridian; of an arc at equal angles."""
    profile = shape.profile()
    crown = abs(profile.crown)
    z = np.linspace(low, high, ALONG if len(profile.breaks) else 2)
    if crown:
        first, last = np.arcsin(np.clip([low / crown, high / crown], -1.0, 1.0))
        z = crown * np.sin(np.linspace(first, last, ALONG))
    return np.maximum(shape.radius_at(z), 0.0), z


def _face(r_0: float, r_1: float, z: float) -> Piece:
    return [r_0, r_1], [z, z]


def _closed(line: Lines, other: Piece) -> Lines:
    """A ring between the pieces of `line`, upwards, and `other`, downwards."""
    (r_0, z_0), (r_1, z_1), (r, z) = line[0], line[-1], other
    return [*line, ([r_1[-1], r[0]], [z_1[-1], z[0]]), other, ([r[-1], r_0[0]], [z[-1], z_0[0]])]


def _plate(shape: Any, places: list[np.ndarray], size: float) -> TriangleMesh:
    """The material below a plane, `BESIDE` of the size beyond the places that are touched."""
    theta, z, _ = shape.chart(np.concatenate([*places, shape.axis_point[None]] if not places else places))
    thick = 0.5 * THICK * size
    middle = shape.point(0.5 * (theta.min() + theta.max()), 0.5 * (z.min() + z.max())) - thick * shape.e_0
    half = np.array([thick, 0.5 * np.ptp(theta) + BESIDE * size, 0.5 * np.ptp(z) + BESIDE * size])
    return plate(middle, np.stack([shape.e_0, shape.e_1, shape.e_a]), half)


def _extruded(shape: Any, places: list[np.ndarray], size: float) -> TriangleMesh:
    """The prism of a closed curve, or the material below an open one, `BEYOND` of the touched width beyond it."""
    z = np.concatenate([np.asarray(shape.chart(points)[1]) for points in places] or [np.zeros(1)])
    half = (0.5 + BEYOND) * np.ptp(z) or BESIDE * size
    low, high = 0.5 * (z.min() + z.max()) + half * np.array([-1.0, 1.0])
    curve = shape.curve
    u = np.linspace(curve.knots[0], curve.knots[-1], FACETS + 1)
    if curve.closed:
        return prism(curve.at(u[:-1]), shape.axis_point, shape.frame, low, high)
    upper, lower = curve.at(u), curve.at(u) - THICK * size * curve.normal(u)
    walls = [np.array([lower[i], upper[i], upper[i + 1], lower[i + 1]]) for i in range(FACETS)]
    return TriangleMesh.of([prism(wall, shape.axis_point, shape.frame, low, high) for wall in walls])


def _below_height(shape: Any, _: list[np.ndarray], size: float) -> TriangleMesh:
    """The material below a surface over a plane, on all of its rectangle."""
    height = shape.profile().height
    u, v = (np.linspace(-a, a, SQUARES + 1) for a in height.half)
    n, top = SQUARES + 1, shape.point(u[:, None], v[None, :]).reshape(-1, 3)
    bottom = top - ((top - shape.axis_point) @ shape.e_0)[:, None] * shape.e_0
    bottom += (height.at(u[:, None], v[None, :])[0].min() - THICK * size) * shape.e_0
    i, j = (k.ravel() for k in np.meshgrid(np.arange(SQUARES), np.arange(SQUARES), indexing="ij"))
    a, b, c, d = i * n + j, (i + 1) * n + j, (i + 1) * n + j + 1, i * n + j + 1
    faces = np.concatenate([np.stack([a, b, c], axis=1), np.stack([a, c, d], axis=1)])
    k, last = np.arange(SQUARES), SQUARES
    rim = np.concatenate([k * n, last * n + k, (last - k) * n + last, last - k])
    after, m = np.roll(rim, -1), n * n
    walls = np.concatenate([np.stack([rim, m + rim, m + after], axis=1), np.stack([rim, m + after, after], axis=1)])
    return TriangleMesh(np.concatenate([top, bottom]), np.concatenate([faces, m + faces[:, ::-1], walls]))


# --- bearings


def _bearing(description: dict[str, Any], bodies: dict[str, BodyView]) -> list[tuple[str, list[str], TriangleMesh]]:
    """Name of the body, its surfaces that are drawn, and mesh of each rigid part of a bearing."""
    geometry: Any = from_description(description["geometry"])
    found = []
    for side in SIDES:
        body = bodies.get(description[side])
        if body is None:
            continue
        own = f"{description['name']} {side} "
        names = [n for n in body.shapes if n.startswith(own) and n.removeprefix(own).split()[0] in ("raceway", *ENDS)]
        if any(n.startswith(f"{own}raceway") for n in names):
            found.append((body.name, names, _ring(description, geometry, side, body)))
    if description["kind"] == "roller":
        for name in dict.fromkeys(description["elements"]):
            if name in bodies and bodies[name].shapes:
                mesh = _roller(bodies[name].shapes, geometry.roller_length)
                found.append((name, list(bodies[name].shapes), mesh))
    cage = bodies.get(description["cage"])
    if cage is not None:
        axes, (height, width) = np.asarray(description["axes"]), np.array(CAGE) * geometry.diameter
        if description["kind"] == "roller":
            width = 0.5 * geometry.roller_length - height
        for track in geometry.tracks[: geometry.rows]:
            found.append(
                (cage.name, list(cage.shapes), revolved(np.zeros(3), axes, _band(geometry, track, height, width)))
            )
    return found


def _band(geometry: Any, track: Track, height: float, width: float) -> Lines:
    """Section of a cage around the row `track`, of half the height and half the width [m], inclined as its elements."""
    middle, tau = np.array([0.5 * geometry.pitch_diameter, track.z]), geometry.inclination * track.sense
    if isinstance(geometry, BallGeometry) and not geometry.washers:
        tau = 0.0
    along, across = np.array([-np.sin(tau), np.cos(tau)]), np.array([np.cos(tau), np.sin(tau)])
    corners = [middle + i * width * along + j * height * across for i, j in ((-1, -1), (1, -1), (1, 1), (-1, 1))]
    return _polygon(corners)


def _polygon(corners: list[np.ndarray]) -> Lines:
    """A section of straight sides between corners (radius, axial position) [m]."""
    pairs = zip(corners, [*corners[1:], corners[0]], strict=True)
    return [([p[0], q[0]], [p[1], q[1]]) for p, q in pairs]


def _ring(description: dict[str, Any], geometry: Any, side: str, body: BodyView) -> TriangleMesh:
    """A ring between its raceways, with lands or ribs next to them, and its bore or outside diameter."""
    sign = -1.0 if side == "inner" else 1.0
    first = body.shapes[f"{description['name']} {side} raceway"]
    center = Pose(**description["poses"][body.name]).to_user(np.asarray(description["center"])[None])[0]
    D, pitch = geometry.diameter, geometry.pitch_diameter
    given = geometry.bore if side == "inner" else geometry.outside_diameter
    half = 0.5 * (geometry.default_width if geometry.width is None else geometry.width)
    if first.profile().planar:
        return _washer(geometry, center, first)
    if isinstance(geometry, BallGeometry) and geometry.washers:
        return _grooved_washer(geometry, side, center, first)
    low, high = -half, half
    if geometry.rows == 2 and geometry.width is None:
        low, high = low - 0.5 * geometry.row_spacing, high + 0.5 * geometry.row_spacing
    line: Lines = []
    at = low
    for shape, begin, stop in _raceways(description, geometry, side, body, center, (low, high)):
        begin = max(begin, at)  # two rows in one sphere overlap
        if stop <= begin:
            continue
        off = float((center - shape.axis_point) @ shape.e_a)
        r, z = _line(shape, begin + off, stop + off)
        land = _land(geometry, sign, float(r[0]) if begin > at else float(r[-1]))
        if begin > at:
            line += [*_step(line, land, at), ([land, land], [at, begin])]
        line += [*_step(line, float(r[0]), begin), (r, z - off)]
        at = stop
    if at < high:
        land = _land(geometry, sign, float(line[-1][0][-1]))
        line += [*_step(line, land, at), ([land, land], [at, high])]
    far = max(sign * np.concatenate([r for r, _ in line]))
    edge = 0.5 * given if given is not None else sign * max(0.5 * sign * (pitch + sign * DEEP * D), far + RIB * D)
    edge = max(edge, 0.0)
    return revolved(center, first.frame, _closed(line, ([edge, edge], [high, low])))


def _step(line: Lines, radius: float, z: float) -> Lines:
    """The face that leads from the end of `line` to a radius [m] at z [m]; none at its beginning or without a step."""
    return [_face(float(line[-1][0][-1]), radius, z)] if line and line[-1][0][-1] != radius else []


def _land(geometry: Any, sign: float, radius: float) -> float:
    """Radius [m] of the land or rib next to a raceway that ends at a radius [m]."""
    land = 0.5 * (geometry.pitch_diameter + sign * SHOULDER * geometry.diameter)
    if isinstance(geometry, BallGeometry):
        height = pair(geometry.shoulders, "shoulders")[0 if sign < 0.0 else 1]
        side = SIDES[0 if sign < 0.0 else 1]
        return land if height is None else geometry.bottom(side) - sign * height
    if geometry.inclination:
        return radius - sign * RIB * geometry.diameter
    return land


def _raceways(
    description: dict[str, Any], geometry: Any, side: str, body: BodyView, center: np.ndarray, ends: tuple[float, float]
) -> list[tuple[Any, float, float]]:
    """Shape, begin and end [m] along the axis from the centre of each raceway, in ascending order within the `ends`."""
    name, found = description["name"], []
    for number, track in enumerate(geometry.tracks, start=1):
        suffix = "" if number == 1 else f" {number}"
        shape = body.shapes[f"{name} {side} raceway{suffix}"]
        middle = float((shape.axis_point - center) @ shape.e_a)
        if isinstance(geometry, BallGeometry):
            r, land = geometry.groove(side), _land(geometry, -1.0 if side == "inner" else 1.0, 0.0)
            reach = float(np.sqrt(max(r**2 - max(r - abs(shape.radius - land), 0.0) ** 2, 0.0)))
            begin, stop = middle - reach, middle + reach
            if geometry.four_point:
                begin, stop = (begin, 0.0) if middle > 0.0 else (0.0, stop)
        else:
            along = 0.5 * geometry.roller_length * float(np.cos(geometry.inclination))
            if geometry.raceway_radii is not None:
                sign = -1.0 if side == "inner" else 1.0
                middle = track.z + sign * 0.5 * geometry.diameter * float(np.sin(geometry.inclination * track.sense))
            ribs = {ENDS[end] * track.sense for end in ENDS if f"{name} {side} {end} rib{suffix}" in body.shapes}
            inward = 0.0 if geometry.rows == 1 else -np.sign(track.z)
            open_low, open_high = (0.0 if s == inward else e for s, e in zip((-1.0, 1.0), ends, strict=True))
            begin = middle - along if -1.0 in ribs else open_low
            stop = middle + along if 1.0 in ribs else open_high
        found.append((shape, max(begin, ends[0]), min(stop, ends[1])))
    found.sort(key=lambda one: one[1])
    return found


def _washer(geometry: Any, center: np.ndarray, plane: Any) -> TriangleMesh:
    """The washer of a thrust bearing below its plane raceway."""
    top = float((plane.axis_point - center) @ plane.e_0)
    bottom = top - WASHER * geometry.diameter
    inside, outside = 0.5 * geometry.pitch_diameter + 0.5 * (1.0 + RIB) * geometry.roller_length * np.array([-1.0, 1.0])
    corners = [np.array(at) for at in ((inside, top), (outside, top), (outside, bottom), (inside, bottom))]
    return revolved(center, np.stack([plane.e_1, plane.e_a, plane.e_0]), _polygon(corners))


def _grooved_washer(geometry: BallGeometry, side: str, center: np.ndarray, groove: Any) -> TriangleMesh:
    """The washer of a thrust ball bearing, from its bore to its outside diameter, with a groove."""
    D, pitch, r = geometry.diameter, geometry.pitch_diameter, geometry.groove(side)
    height = pair(geometry.shoulders, "shoulders")[SIDES.index(side)]
    across, along = geometry.arc_centre(side, geometry.tracks[0])
    sense = -np.sign(along)  # from the balls to the washer
    land = r - 0.5 * (1.0 - SHOULDER) * D if height is None else r - height  # from the arc's centre
    angle = np.linspace(-1.0, 1.0, ALONG) * np.arccos(land / r)
    inside = 0.5 * (max(pitch - DEEP * D, 0.0) if geometry.bore is None else geometry.bore)
    outside = 0.5 * (pitch + DEEP * D if geometry.outside_diameter is None else geometry.outside_diameter)
    back = sense * 0.5 * (geometry.default_width if geometry.width is None else geometry.width)
    arc = across + r * np.sin(angle), along + sense * r * np.cos(angle)
    face = float(arc[1][0])
    line: Lines = [_face(inside, float(arc[0][0]), face), arc, _face(float(arc[0][-1]), outside, face)]
    return revolved(center, groove.frame, _closed(line, ([outside, inside], [back, back])))


def _roller(shapes: dict[str, Any], length: float) -> TriangleMesh:
    """A roller of its length, with flat or spherical ends."""
    skin = next(shape for shape in shapes.values() if not shape.profile().spherical)
    faces = {}
    for end, sign in ENDS.items():
        dome, z = shapes.get(f"{end} end"), 0.5 * sign * length
        r = np.linspace(0.0, float(skin.radius_at(z)), 2 if dome is None else ALONG)
        drop = 0.0 * r if dome is None else dome.radius - np.sqrt(dome.radius**2 - r**2)
        faces[end] = r, z - sign * drop
    line = _line(skin, faces["back"][1][-1], faces["front"][1][-1])
    faces["back"][0][-1], faces["front"][0][-1] = line[0][0], line[0][-1]  # a rim, on the surface of both
    r, z = faces["front"]
    return revolved(skin.axis_point, skin.frame, [faces["back"], line, (r[::-1], z[::-1])])
