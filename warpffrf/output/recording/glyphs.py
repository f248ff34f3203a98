r"""What a recording draws besides deforming skins: rigid bodies, and arrows of joint reactions and applied forces.

A rigid body is drawn as its box of inertia (`geometry.inertia_box`), and a bar from its centre of mass to every place
where a joint or a force holds it.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from warpffrf.output.geometry.anchors import Anchor
from warpffrf.output.geometry.grid_places import rotate
from warpffrf.output.geometry.inertia_box import inertia_box
from warpffrf.output.geometry.scene_view import BodyView
from warpffrf.output.plots.colors import largest

BODY_COLORS = ((150, 160, 175), (190, 160, 120), (130, 170, 150), (170, 145, 175))
JOINT_COLOR, LOAD_COLOR, LUMPED_COLOR = (90, 200, 120), (235, 110, 60), (80, 130, 230)
ARROW_LENGTH = 0.45  # of the scene's largest body, for the largest force of the run
ARROW_RADIUS, BAR_RADIUS, POINT_RADIUS = 0.008, 0.01, 0.015  # of the largest body
LEAST_SHOWN = 1e-3  # of the largest force: shorter arrows are dots
MOST_LABELS = 8  # more names in a picture hide it


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
        # solid boxes would hide what touches beside them
        mode, touching = recorder.rr.components.FillMode, recorder.contacts or self.lumped or self.result.film_names
        self.fill = mode.MajorWireframe if touching else mode.Solid

    def _force(self, anchor: Anchor) -> Any:
        """Recorded force (T, 3) [N] at the anchor, world; None for one that is not in the result."""
        owners = self.result.history.joints if anchor.kind == "joint" else self.result.history.forces
        return owners[anchor.name].force if anchor.name in owners else None

    def static(self) -> None:
        """Boxes and bars of the rigid bodies, which move with their frames."""
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
        """Arrows of saved row i: what acts on the second side of each joint, on each loaded place, and on the first
        body of each lumped contact."""
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
        # a push ends where it acts, a reaction begins there: neither hides the place
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
    """A force [N] in words, N or kN."""
    return f"{value * 1e-3:.3g} kN" if value >= 1e3 else f"{value:.3g} N"


def rigid_size(body: BodyView, anchors: tuple[Anchor, ...]) -> float:
    """Largest extent [m] of a rigid body as drawn."""
    box = inertia_box(body)
    corners = np.array(np.meshgrid(*[[-1.0, 1.0]] * 3)).reshape(3, -1).T * box.half
    points = [a.point for a in anchors if a.body == body.name] + list(box.center + rotate(box.rotation, corners))
    return float(np.ptp(np.array(points), axis=0).max())
