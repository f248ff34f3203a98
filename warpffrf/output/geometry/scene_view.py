"""Scene data needed by the output: names, reduced bodies, contacting surfaces, and a hash to distinguish scenes.

A live run takes it from the `Scene`; a results file stores it, so that pictures and derived quantities need no scene.

Anchors. Points of action of joints and forces on bodies, needed for pictures.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np
import scipy.sparse as sp

from warpffrf.model import rotation as rot
from warpffrf.model.forces import ThermalLoad
from warpffrf.model.reduced.inertia import interface_motion
from warpffrf.model.rigid_surface import RigidSurface
from warpffrf.model.small_sliding.sliding import cells_of

GROUND = "ground"


@dataclass(frozen=True)
class BodyView:
    """One body: its name, its reduced body (None if rigid), mass [kg], centre of mass [m, user frame] and inertia about
    it [kg m2, user axes]; `shapes`: contact surfaces of a rigid body, by name; `stiffening`: whether geometric
    stiffening and foreshortening are active."""

    name: str
    reduced: Any
    mass: float
    center_of_mass: np.ndarray
    inertia: np.ndarray = field(default_factory=lambda: np.zeros((3, 3)))
    shapes: dict[str, Any] = field(default_factory=dict)
    stiffening: bool = False

    def surface(self, name: str) -> Any:
        """The body's contact surface called `name`: a `ContactSurface`, for a rigid body a `RigidSurface`."""
        return RigidSurface(name, self.shapes[name]) if self.reduced is None else self.reduced.contact_surfaces[name]


@dataclass(frozen=True)
class PairView:
    """One contact: the two bodies (or the ground), the names of the contacting surfaces, coefficient of friction [-], 0
    also if it depends on the slip speed."""

    name: str
    first_body: BodyView
    first_surface_name: str
    second_body: BodyView
    second_surface_name: str
    friction: float = 0.0

    @property
    def first(self) -> Any:
        """ContactSurface of the first body, whose grid carries the pressure."""
        return self.first_body.surface(self.first_surface_name)

    @property
    def second(self) -> Any:
        """Contact surface of the second body; its `grid` is None if the body is rigid."""
        return self.second_body.surface(self.second_surface_name)


@dataclass(frozen=True)
class FilmView(PairView):
    """One oil film, on the contact grid of its first surface. clearance [m]: radius of the bore minus that of the
    shaft; None for planes and cones."""

    clearance: float | None = None


@dataclass(frozen=True, eq=False)
class SmallSlidingView:
    """One small-sliding contact: its bodies (for two faces of one body twice that body), the name of the first body's
    pair or face, that of the second face ("" for a pair), coefficient of friction [-], and its c cells at the initial
    pose: `cell` (c,) indices on the first face, `points` (c, 3) [m] and `frames` (c, 3, 3) with rows n, t_1, t_2 in
    user axes of the first body, `area` (c,) [m2] facing the second face; `partners` (c, 3) [m] and `partner_frames` (c,
    3, 3) the same points and directions in the user frame of the second body; for a second flexible face the `shares`
    (k,) of the forces of cells that cells of that face carry, and `share_cells` (k, 2) the indices of both, in the
    contact and on the face."""

    name: str
    first_body: BodyView
    first_surface_name: str
    second_body: BodyView
    second_surface_name: str
    friction: float
    cell: np.ndarray
    points: np.ndarray
    frames: np.ndarray
    area: np.ndarray
    partners: np.ndarray
    partner_frames: np.ndarray
    shares: np.ndarray
    share_cells: np.ndarray

    @property
    def first(self) -> Any:
        """`MatchedSurface` of the first body, which defines the cells."""
        return self.first_body.reduced.matched[self.first_surface_name]

    @property
    def second(self) -> Any:
        """`MatchedSurface` of the second body, None for a pair and for a rigid surface."""
        reduced = self.second_body.reduced
        return reduced.matched[self.second_surface_name] if reduced is not None and self.second_surface_name else None

    @property
    def weights(self) -> sp.csr_matrix:
        """The shares as a matrix (c, cells of the second face)."""
        shape = len(self.cell), self.second.cells
        return sp.csr_matrix((self.shares, (self.share_cells[:, 0], self.share_cells[:, 1])), shape=shape)

    @property
    def triangles(self) -> tuple[np.ndarray, np.ndarray]:
        """Corners (t, 3, 3) [m, user frame of the first body] of the cut facets of the cells, and the cell (t,) of
        each, numbered in this contact."""
        number = np.full(self.first.cells, -1)
        number[self.cell] = np.arange(len(self.cell))
        own = number[self.first.cell]
        return self.first.triangles[own >= 0], own[own >= 0]


@dataclass(frozen=True)
class SceneView:
    """Scene data for results and pictures; `content_hash` determines whether a run can be continued. `description` is
    that of `Scene.describe`."""

    content_hash: str
    bodies: dict[str, BodyView] = field(default_factory=dict)
    pairs: dict[str, PairView] = field(default_factory=dict)
    joints: tuple[str, ...] = ()
    anchors: tuple[Anchor, ...] = ()
    lumped: dict[str, PairView] = field(default_factory=dict)
    films: dict[str, FilmView] = field(default_factory=dict)
    small_sliding: dict[str, SmallSlidingView] = field(default_factory=dict)
    bearings: dict[str, dict[str, Any]] = field(default_factory=dict)  # as in `model.bearings.Bearing.describe`
    gears: dict[str, dict[str, Any]] = field(default_factory=dict)  # as in `model.gears.GearMesh.describe`
    description: dict[str, Any] = field(default_factory=dict)

    def expands(self, body: str) -> bool:
        """Whether a thermal load acts on the body of this name: its strains are then not those of stresses alone."""
        loads = (force for force in self.description.get("forces", ()) if force["kind"] == ThermalLoad.kind)
        return any(load["body"] == body for load in loads)


def scene_view(scene: Any) -> SceneView:
    """The view of a live `Scene`; a `SceneView` is returned unchanged."""
    if isinstance(scene, SceneView):
        return scene
    shapes = rigid_shapes((*scene.contacts, *scene.lumped_contacts, *scene.films))
    bodies = {
        body.name: BodyView(
            body.name, body.reduced, float(body.mass), np.asarray(body.center_of_mass, dtype=float),
            np.asarray(body.inertia, dtype=float), shapes.get(body.name, {}), bool(body.stiffening),
        )
        for body in scene.bodies
    }  # fmt: skip
    known = {GROUND: ground_view(shapes.get(GROUND, {})), **bodies}
    pairs, lumped = _pairs(scene.finite_sliding, known), _pairs(scene.lumped_contacts, known)
    films = {
        film.name: FilmView(
            film.name, known[film.a.body.name], film.a.name, known[film.b.body.name], film.b.name,
            clearance=film.clearance(),
        )
        for film in scene.films
    }  # fmt: skip
    joints = tuple(joint.name for joint in scene.joints)
    small_sliding = {contact.name: _small_sliding(contact, known) for contact in scene.small_sliding}
    bearings = {bearing.name: bearing.describe() for bearing in scene.bearings}
    gears = {mesh.name: mesh.describe() for mesh in scene.gears}
    return SceneView(
        scene.content_hash(), bodies, pairs, joints, scene_anchors(scene), lumped, films, small_sliding, bearings,
        gears, scene.describe(),
    )  # fmt: skip


def _small_sliding(contact: Any, known: dict[str, BodyView]) -> SmallSlidingView:
    cells = cells_of(contact)
    other = contact.a if contact.b is None else contact.b
    turn = rot.matrix(other.body.rotation).T @ rot.matrix(contact.a.body.rotation)
    shares = sp.coo_matrix((len(cells.cell), 0)) if cells.weights is None else cells.weights.tocoo()
    return SmallSlidingView(
        contact.name,
        known[contact.a.body.name],
        contact.a.name,
        known[other.body.name],
        "" if contact.b is None else contact.b.name,
        contact.friction.static_coefficient,
        cells.cell,
        cells.points,
        cells.frames,
        cells.area,
        other.body.to_user(contact.a.body.to_world(cells.points)),
        cells.frames @ turn.T,
        shares.data,
        np.stack([shares.row, shares.col], axis=1).astype(np.int64),
    )


def _pairs(contacts: Any, known: dict[str, BodyView]) -> dict[str, PairView]:
    found = {}
    for contact in contacts:
        a, b = contact.a, contact.b
        friction = 0.0 if contact.friction.breaks else contact.friction.static_coefficient
        names = known[a.body.name], a.name, known[b.body.name], b.name
        found[contact.name] = PairView(contact.name, *names, friction)
    return found


def rigid_shapes(contacts: Any) -> dict[str, dict[str, Any]]:
    """Shapes of the rigid surfaces in contacts, films and small-sliding contacts of a live scene, {body: {surface:
    shape}}."""
    found: dict[str, dict[str, Any]] = {}
    for contact in contacts:
        for port in (contact.a, contact.b):
            if port is not None and port.body.reduced is None:
                found.setdefault(port.body.name, {})[port.name] = port.surface.shape
    return found


def ground_view(shapes: dict[str, Any]) -> BodyView:
    """The ground with its surfaces: it has no mass of its own and does not move."""
    return BodyView(GROUND, None, 0.0, np.zeros(3), shapes=shapes)


@dataclass(frozen=True, eq=False)
class Anchor:
    """A point of a body at which a joint or a force element acts.

    kind: "joint" or "force"; name: of the joint or element; body: its name, None for the ground; interface: the name of
    the interface whose deformation it follows, or None; point (3,) [m, user frame, world for the ground]; loaded: the
    recorded force acts here (on a joint's or spring's second side), its opposite on the other side.
    """

    kind: str
    name: str
    body: str | None
    interface: str | None
    point: np.ndarray
    loaded: bool

    def describe(self) -> list[Any]:
        """Plain data for a results file; `Anchor.of` reads it."""
        return [self.kind, self.name, self.body, self.interface, [float(x) for x in self.point], self.loaded]

    @classmethod
    def of(cls, data: list[Any]) -> Anchor:
        """The anchor that `describe` gave."""
        kind, name, body, interface, point, loaded = data
        return cls(kind, name, body, interface, np.array(point, dtype=float), bool(loaded))

    def displacement(self, body: Any, modal: np.ndarray) -> np.ndarray:
        """Displacement (3,) [m, user axes] with the interface of `body`, its `BodyView`, at modal coordinates (m,)."""
        if self.interface is None or body.reduced is None or not len(modal):
            return np.zeros(3)
        motion = interface_motion(body, self.interface, modal)
        return motion[:3] + np.cross(motion[3:], self.point - body.reduced.interfaces[self.interface].point)


def scene_anchors(scene: Any) -> tuple[Anchor, ...]:
    """Anchors of the joints and forces of a live `Scene`, from its initial pose."""
    found = [anchor for joint in scene.joints for anchor in _sides("joint", joint.name, joint.ports, joint.frames())]
    for force in scene.forces:
        joint = getattr(force, "joint", None)
        if joint is not None:
            found += _sides("force", force.name, joint.ports, joint.frames())
            continue
        ports = [port for port in force.ports if getattr(port, "point", None) is not None]
        at = force.world_point() if hasattr(force, "world_point") else None  # elements whose two sides coincide
        for n, port in enumerate(ports):
            point = port.point if at is None else port.body.to_user(at)
            found.append(_anchor("force", force.name, port, point, n == len(ports) - 1))
    return tuple(found)


def _sides(kind: str, name: str, ports: Any, frames: Any) -> list[Anchor]:
    return [_anchor(kind, name, p, f.point, n == 1) for n, (p, f) in enumerate(zip(ports, frames, strict=True))]


def _anchor(kind: str, name: str, port: Any, point: np.ndarray, loaded: bool) -> Anchor:
    body = None if port.body.index < 0 else port.body.name
    return Anchor(kind, name, body, port.interface_name, np.array(point, dtype=float), loaded)
