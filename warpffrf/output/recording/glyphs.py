r"""Elements of a recording in addition to deforming skins: rigid bodies, and arrows of joint reactions and applied
forces.

A rigid body is drawn as its box of inertia (`geometry.inertia_box`), with a bar from its centre of mass to each anchor
of a joint or a force.

Rigid shapes. True shapes of rigid contact surfaces in a recording: they have no mesh, and are drawn as far as the
patches extend.

A plane extends `AROUND` of the largest body beyond the patches of the run, a surface of revolution as far along its
axis, over the full circumference; a sphere is drawn completely. The patch of an oil film is its grid.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from warpffrf.output.geometry.inertia_box import inertia_box
from warpffrf.output.geometry.places import Pose, grid_theta_offset, rotate
from warpffrf.output.geometry.scene_view import Anchor, BodyView, FilmView, PairView
from warpffrf.output.plots.colors import largest
from warpffrf.output.recording import frames as fr

BODY_COLORS = ((150, 160, 175), (190, 160, 120), (130, 170, 150), (170, 145, 175))
JOINT_COLOR, LOAD_COLOR, LUMPED_COLOR = (90, 200, 120), (235, 110, 60), (80, 130, 230)
ARROW_LENGTH = 0.45  # of the scene's largest body, for the largest force of the run
ARROW_RADIUS, BAR_RADIUS, POINT_RADIUS = 0.008, 0.01, 0.015  # of the largest body
LEAST_SHOWN = 1e-3  # of the largest force: shorter arrows are dots
MOST_LABELS = 8  # more names would hide the picture


class Glyphs:
    """Draws rigid bodies and arrows into a recording; `size` is the scene's largest body [m]."""

    def __init__(self, recorder: Any, size: float) -> None:
        self.recorder, self.result, self.size = recorder, recorder.result, size
        self.loaded = [a for a in self.result.view.anchors if a.loaded and self._force(a) is not None]
        rows = recorder.rows[recorder.good]
        self.lumped = self.result.history.lumped_contacts
        forces = [self._force(a) for a in self.loaded] + [contact.force for contact in self.lumped.values()]
        self.top_force = largest([np.linalg.norm(force[rows], axis=1) for force in forces])
        self.labelled = len(forces) <= MOST_LABELS
        # solid boxes would hide bodies in contact with them
        mode, touching = recorder.rr.components.FillMode, recorder.contacts or self.lumped or self.result.film_names
        self.fill = mode.MajorWireframe if touching else mode.Solid

    def _force(self, anchor: Anchor) -> Any:
        """Recorded force (T, 3) [N] at the anchor, world axes; None if the result does not have it."""
        owners = self.result.history.joints if anchor.kind == "joint" else self.result.history.forces
        return owners[anchor.name].force if anchor.name in owners else None

    def static(self) -> None:
        """Log boxes and bars of the rigid bodies, which move with their frames."""
        recorder = self.recorder
        rr = recorder.rr
        for n, body in enumerate(self.result.view.bodies.values()):
            if body.reduced is not None:
                continue
            box = inertia_box(body)
            color = BODY_COLORS[n % len(BODY_COLORS)]
            shape = rr.Boxes3D(
                centers=[box.center], half_sizes=[box.half], quaternions=[rr.Quaternion(xyzw=box.rotation)],
                colors=[color], fill_mode=self.fill,
            )  # fmt: skip
            recorder.log_static(recorder.path("world", body.name, "box"), shape)
            held = [a.point for a in self.result.view.anchors if a.body == body.name]
            bars = [[box.center, point] for point in held if np.linalg.norm(point - box.center) > 0.0]
            if bars:
                lines = rr.LineStrips3D(bars, colors=[color], radii=BAR_RADIUS * self.size)
                recorder.log_static(recorder.path("world", body.name, "bars"), lines)

    def frame(self, i: int) -> None:
        """Log the arrows of saved row i: forces on the second side of each joint, on each loaded anchor, and on the
        first body of each lumped contact."""
        for anchor in self.loaded:
            color = JOINT_COLOR if anchor.kind == "joint" else LOAD_COLOR
            self._arrow(anchor.kind, anchor.name, self._place(anchor, i), self._force(anchor)[i], color)
        for name, contact in self.lumped.items():
            self._arrow("lumped", name, contact.place[i].copy(), contact.force[i], LUMPED_COLOR)

    def _arrow(self, kind: str, name: str, at: np.ndarray, force: np.ndarray, color: tuple[int, int, int]) -> None:
        rr, stream = self.recorder.rr, self.recorder.stream
        scale = ARROW_LENGTH * self.size / self.top_force if self.top_force > 0.0 else 0.0
        size = float(np.linalg.norm(force))
        path = self.recorder.path("world", f"{kind}_arrows", name)
        stream.log(f"{path}/place", rr.Points3D([at], colors=[color], radii=POINT_RADIUS * self.size))
        if size <= LEAST_SHOWN * self.top_force:
            stream.log(f"{path}/force", rr.Arrows3D(vectors=np.zeros((0, 3))))
            return
        # an applied force ends at its anchor, a reaction starts there, so that neither hides the anchor
        vector = scale * force
        origin = at - vector if kind == "force" else at
        label = [f"{name} {force_text(size)}"] if self.labelled else None
        arrow = rr.Arrows3D(
            origins=[origin], vectors=[vector], colors=[color], radii=ARROW_RADIUS * self.size, labels=label,
            show_labels=self.labelled,
        )  # fmt: skip
        stream.log(f"{path}/force", arrow)

    def _place(self, anchor: Anchor, i: int) -> np.ndarray:
        if anchor.body is None:
            return anchor.point
        motion = self.result.history.bodies[anchor.body]
        local = anchor.local(self.result.view.bodies[anchor.body], motion.modal[i], self.recorder.factor)
        return motion.position[i] + rotate(motion.rotation[i], local[None])[0]


def force_text(value: float) -> str:
    """A force [N] as text, N or kN."""
    return f"{value * 1e-3:.3g} kN" if value >= 1e3 else f"{value:.3g} N"


def rigid_size(body: BodyView, anchors: tuple[Anchor, ...]) -> float:
    """Largest extent [m] of a rigid body as drawn."""
    box = inertia_box(body)
    corners = np.array(np.meshgrid(*[[-1.0, 1.0]] * 3)).reshape(3, -1).T * box.half
    points = [a.point for a in anchors if a.body == body.name] + list(box.center + rotate(box.rotation, corners))
    return float(np.ptp(np.array(points), axis=0).max())


AROUND = 0.6  # of the largest body
POINTS = (97, 25)  # around and along
POLE = 1.0 - 1e-6  # of the radius of an arc: the last ring before the pole
Reach = tuple[tuple[float, float], tuple[float, float]]  # ranges of theta and z
GROOVE = 0.7  # of the radius of a groove: more would let a ring enclose the balls
COLOR = (168, 176, 186, 255)


class RigidShapes:
    """Draws the rigid surfaces of the recording's contacts, lumped contacts and oil films as children of their bodies,
    so that they move with them."""

    def __init__(self, recorder: Any) -> None:
        self.recorder = recorder
        rigid = {self._path(c.view): c for c in recorder.contacts if c.view.second.grid is None}
        self._contacts = rigid  # one contact per surface: it locates the patches
        self._lumped: dict[str, tuple[Any, str, Any]] = {}  # path -> shape, body, one of its contacts
        for name, view in recorder.result.view.lumped.items():
            for body, surface in (
                (view.first_body, view.first_surface_name),
                (view.second_body, view.second_surface_name),
            ):
                path = recorder.path("world", body.name, surface)
                if path not in rigid:
                    contact = recorder.result.history.lumped_contacts[name]
                    self._lumped.setdefault(path, (body.shapes[surface], body.name, contact))
        films = {self._path(view): view for view in recorder.result.view.films.values() if view.second.grid is None}
        self._films = {path: view for path, view in films.items() if path not in (*rigid, *self._lumped)}

    def _path(self, view: PairView) -> str:
        return self.recorder.path("world", view.second_body.name, view.second_surface_name)

    def paths(self) -> list[str]:
        """Entities of the surfaces."""
        return [*self._contacts, *self._lumped, *self._films]

    def static(self) -> None:
        """Log every surface once."""
        for path, contact in self._contacts.items():
            self._log(path, contact.view.second.shape, self._reach(contact))
        for path, (shape, body, contact) in self._lumped.items():
            self._log(path, shape, self._lumped_reach(shape, body, contact))
        for path, view in self._films.items():
            self._log(path, view.second.shape, self._film_reach(view))

    def _log(self, path: str, shape: Any, reach: Reach) -> None:
        rr = self.recorder.rr
        points, normals, triangles = shape_mesh(shape, *reach)
        mesh = rr.Mesh3D(
            vertex_positions=points.astype(np.float32), vertex_normals=normals.astype(np.float32),
            triangle_indices=triangles.astype(np.uint32), albedo_factor=COLOR,
        )  # fmt: skip
        self.recorder.log_static(path, mesh)

    def _lumped_reach(self, shape: Any, body: str, contact: Any) -> Reach:
        """As `_reach`, from the contact points of a lumped contact."""
        recorder = self.recorder
        rows = [int(i) for i in recorder.rows[recorder.good]]
        own = [Pose.of(recorder.result.history.bodies, body, i).to_user(contact.place[i][None])[0] for i in rows]
        theta, z, _ = shape.chart(np.array(own).reshape(-1, 3))
        return self._around([(float(t), float(s)) for t, s in zip(theta, z, strict=True)])

    def _film_reach(self, view: FilmView) -> Reach:
        """As `_reach`, from the corners of the film's grid in the first row that is drawn."""
        recorder, first = self.recorder, view.first
        i = int(recorder.rows[recorder.good][0]) if np.any(recorder.good) else 0
        own, other = (
            Pose.of(recorder.result.history.bodies, body.name, i) for body in (view.first_body, view.second_body)
        )
        theta = first.grid.theta[[0, -1]] + grid_theta_offset(first)
        corners = first.shape.point(*np.meshgrid(theta, first.grid.z[[0, -1]])).reshape(-1, 3)
        theta, z, _ = view.second.shape.chart(other.to_user(own.to_world(corners)))
        return self._around(list(zip(theta.tolist(), z.tolist(), strict=True)))

    def _reach(self, contact: Any) -> Reach:
        """Ranges of theta [rad, m on a plane] and z [m] on the rigid surface that contain the patches of the run, with
        a margin."""
        recorder, shape = self.recorder, contact.view.second.shape
        places = []
        for i in recorder.rows[recorder.good]:
            own = Pose.of(contact.bodies, contact.view.second_body.name, int(i))
            origin = fr.patch_frame(recorder.result, contact, int(i)).origin
            theta, z, _ = shape.chart(own.to_user(origin[None]))
            places.append((float(theta[0]), float(z[0])))
        return self._around(places)

    def _around(self, places: list[tuple[float, float]]) -> Reach:
        found = np.asarray(places) if places else np.zeros((1, 2))
        low, high = found.min(axis=0), found.max(axis=0)
        more = AROUND * self.recorder.size
        return (low[0] - more, high[0] + more), (low[1] - more, high[1] + more)


def shape_mesh(
    shape: Any, theta: tuple[float, float], z: tuple[float, float]
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Points (n, 3) [m], outward normals (n, 3) and triangles (t, 3) of a shape over ranges of theta and z; a surface
    of revolution over the full circumference and at most to the ends of its arc, a sphere completely, a groove as far
    as raceways extend."""
    profile = shape.profile()
    around, along = theta, z
    if not profile.planar:
        around = (0.0, 2.0 * np.pi)
        if profile.crown:
            whole = profile.crown == profile.radius
            hollow = profile.side * profile.crown < 0.0 and not whole
            end = (GROOVE if hollow else POLE) * abs(profile.crown)
            along = (-end, end) if whole else (max(z[0], -end), min(z[1], end))
    t, s = np.meshgrid(np.linspace(*around, POINTS[0]), _spread(along, profile, POINTS[1]), indexing="ij")
    t, s = t.ravel(), s.ravel()
    triangles = fr.grid_triangles(*POINTS)
    points, normals = shape.point(t, s), shape.normal(t, s)
    corners = points[triangles[len(triangles) // 4]]
    outwards = np.cross(corners[1] - corners[0], corners[2] - corners[0]) @ normals[triangles[len(triangles) // 4, 0]]
    return points, normals, triangles if outwards > 0.0 else triangles[:, ::-1]


def _spread(along: tuple[float, float], profile: Any, count: int) -> np.ndarray:
    """Positions along the axis: equal steps; for an arc equal steps of its angle."""
    if not profile.crown:
        return np.linspace(*along, count)
    radius = abs(profile.crown)
    return radius * np.sin(np.linspace(np.arcsin(along[0] / radius), np.arcsin(along[1] / radius), count))
