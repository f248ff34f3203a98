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

COLORS = {"joint": (50, 155, 85), "force": (225, 100, 50), "lumped": (80, 130, 230)}
ARROW_LENGTH = 0.3  # of the scene's largest body, for the largest force of the run
ARROW_RADIUS, POINT_RADIUS = 0.008, 0.012  # of the largest body
TRIAD, TRIAD_RADIUS = 0.4, 0.012  # of the radius of what is shown: longest arrow, and its radius
TRIAD_PLACE = np.array([-0.25, -0.1, -0.1])  # of the radius, from the lowest corner
TRIAD_COLORS = [(230, 80, 80), (90, 180, 90), (90, 130, 255)]  # x, y, z
LEAST_SHOWN = 1e-3  # of the largest force: shorter arrows are dots
MOST_LABELS = 8  # more names would hide the picture
LABEL_ROOM = 0.1  # of the largest body: labels closer to each other would cover each other


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
        """Log the arrows of saved row i, which end where the forces act: on the second side of each joint, on each
        loaded anchor, and on the first body of each lumped contact."""
        drawn = [(anchor.kind, anchor.name, self._place(anchor, i), self._force(anchor)[i]) for anchor in self.loaded]
        drawn += [("lumped", name, contact.place[i].copy(), contact.force[i]) for name, contact in self.lumped.items()]
        scale = ARROW_LENGTH * self.size / self.top_force if self.top_force > 0.0 else 0.0
        sizes = [float(np.linalg.norm(force)) for *_, force in drawn]
        words = [
            f"{name} {force_text(size)}" if size > LEAST_SHOWN * self.top_force else ""
            for (_, name, *_), size in zip(drawn, sizes, strict=True)
        ]
        labels = joined(words, [at - 0.5 * scale * force for *_, at, force in drawn], LABEL_ROOM * self.size)
        rr, stream = self.recorder.rr, self.recorder.stream
        for (kind, name, at, force), said, label in zip(drawn, words, labels, strict=True):
            path, color = self.recorder.path("world", f"{kind}_arrows", name), COLORS[kind]
            stream.log(f"{path}/place", rr.Points3D([at], colors=[color], radii=POINT_RADIUS * self.size))
            if not said:
                stream.log(f"{path}/force", rr.Arrows3D(vectors=np.zeros((0, 3))))
                continue
            shown = self.labelled and bool(label)
            arrow = rr.Arrows3D(
                origins=[at - scale * force], vectors=[scale * force], colors=[color], radii=ARROW_RADIUS * self.size,
                labels=[label] if shown else None, show_labels=shown,
            )  # fmt: skip
            stream.log(f"{path}/force", arrow)

    def _place(self, anchor: Anchor, i: int) -> np.ndarray:
        if anchor.body is None:
            return anchor.point
        motion = self.result.history.bodies[anchor.body]
        moved = anchor.displacement(self.result.view.bodies[anchor.body], motion.modal[i])
        carried = self.recorder.reference.motion(anchor.body, anchor.point[None], i)[0]
        local = anchor.point + carried + self.recorder.factor * (moved - carried)
        return motion.position[i] + rotate(motion.rotation[i], local[None])[0]


def triad(points: np.ndarray) -> tuple[np.ndarray, np.ndarray, str]:
    """Origin (3,) [m] of the triad, to the left in front of `points` (n, 3) [m], tips (3, 3) [m] of its arrows, their
    length as text."""
    radius = float(np.linalg.norm(points, axis=1).max())
    length, origin = round_length(TRIAD * radius), points.min(axis=0) + radius * TRIAD_PLACE
    return origin, origin + length * np.eye(3), length_text(length)


def joined(words: list[str], places: list[np.ndarray], room: float) -> list[str]:
    """Labels of `words` at `places` (3,) [m]: of those closer than `room` [m] to the first of them that has one, all in
    one label with a line each, and "" for the others."""
    labels = [""] * len(words)
    for n, word in enumerate(words):
        near = (m for m in range(n) if labels[m] and np.linalg.norm(places[m] - places[n]) < room)
        at = next(near, n)
        labels[at] = "\n".join(filter(None, (labels[at], word)))
    return labels


def force_text(value: float) -> str:
    """A force [N] as text, N or kN."""
    return f"{value * 1e-3:.3g} kN" if value >= 1e3 else f"{value:.3g} N"
