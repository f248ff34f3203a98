"""Arrows of a recording: reactions of joints, applied forces and forces of lumped contacts, and the triad, whose arrows
have a round length that is written next to them.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from warpffrf.output.geometry.places import rotate
from warpffrf.output.geometry.scene_view import Anchor
from warpffrf.output.plots.colors import largest
from warpffrf.output.recording.extent import length_text, round_length

JOINT_COLOR, LOAD_COLOR, LUMPED_COLOR = (50, 155, 85), (225, 100, 50), (80, 130, 230)
ARROW_LENGTH = 0.3  # of the scene's largest body, for the largest force of the run
ARROW_RADIUS, POINT_RADIUS = 0.008, 0.012  # of the largest body
TRIAD, TRIAD_RADIUS = 0.4, 0.012  # of the radius of what is shown: longest arrow, and its radius
TRIAD_PLACE = np.array([-0.25, -0.1, -0.1])  # of the radius, from the lowest corner
TRIAD_COLORS = [(230, 80, 80), (90, 180, 90), (90, 130, 255)]  # x, y, z
LEAST_SHOWN = 1e-3  # of the largest force: shorter arrows are dots
MOST_LABELS = 8  # more names would hide the picture


class Glyphs:
    """Draws arrows into a recording; `size` is the scene's largest body [m]."""

    def __init__(self, recorder: Any, size: float) -> None:
        self.recorder, self.result, self.size = recorder, recorder.result, size
        bearings = self.result.view.bearings.values()  # colours and load zones show their forces
        inner = {name for b in bearings for name in (*b["joints"].values(), *b["contacts"].values())}
        anchors = [a for a in self.result.view.anchors if a.loaded and a.name not in inner]
        self.loaded = [a for a in anchors if self._force(a) is not None]
        rows = recorder.rows[recorder.good]
        lumped = self.result.history.lumped_contacts
        self.lumped = {name: contact for name, contact in lumped.items() if name not in inner}
        forces = [self._force(a) for a in self.loaded] + [contact.force for contact in self.lumped.values()]
        self.top_force = largest([np.linalg.norm(force[rows], axis=1) for force in forces])
        self.labelled = len(forces) <= MOST_LABELS

    def _force(self, anchor: Anchor) -> Any:
        """Recorded force (T, 3) [N] at the anchor, world axes; None if the result does not have it."""
        owners = self.result.history.joints if anchor.kind == "joint" else self.result.history.forces
        return owners[anchor.name].force if anchor.name in owners else None

    def static(self) -> None:
        """Log the triad."""
        recorder, radius = self.recorder, self.recorder.radius
        origin, tips, label = triad(recorder.outermost)
        recorder.log_static(recorder.path("world", "triad"), recorder.rr.Arrows3D(
            origins=[recorder.middle + origin] * 3, vectors=tips - origin, colors=TRIAD_COLORS,
            radii=TRIAD_RADIUS * radius, labels=[f"x, {label}", "y", "z"], show_labels=True,
        ))  # fmt: skip

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


def triad(points: np.ndarray) -> tuple[np.ndarray, np.ndarray, str]:
    """Origin (3,) [m] of the triad, to the left in front of `points` (n, 3) [m], tips (3, 3) [m] of its arrows, their
    length as text."""
    radius = float(np.linalg.norm(points, axis=1).max())
    length, origin = round_length(TRIAD * radius), points.min(axis=0) + radius * TRIAD_PLACE
    return origin, origin + length * np.eye(3), length_text(length)


def force_text(value: float) -> str:
    """A force [N] as text, N or kN."""
    return f"{value * 1e-3:.3g} kN" if value >= 1e3 else f"{value:.3g} N"
