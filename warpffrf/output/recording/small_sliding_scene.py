"""One small-sliding contact in a recording: its cells as coloured triangles on the first body, for each of its fields.

Below `/world/small_sliding/<contact>`, which moves with the first body, are `pressure`, `state` and, with friction,
`loss`: the triangles of the cells, displaced with the skin times the deformation factor, one colour per cell. Each has
a view of its own, because the faces hide them where all bodies are drawn.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from warpffrf.output.contact.friction import STATES
from warpffrf.output.plots.colors import PRESSURE_STOPS, STATE_COLORS, WEAR_STOPS, ColorClasses, ColorScale, largest
from warpffrf.output.recording.extent import EYE
from warpffrf.output.small_sliding import CellsOnSkin, SmallSlidingResult

TITLES = {"pressure": "Pressure", "state": "Stick and slip", "loss": "Loss by friction"}
DISTANCE = 1.3  # from the eye to the cells, in extents of the contact
SIDEWAYS = 0.35  # of the distance, so that the curvature of faces is visible
SMALL_SLIDING_TEXT = (
    "Cells of small-sliding contacts lie on their first body, in views of their own, as faces that touch hide them: "
    "their pressure, which ones are open, stick and slip, and the energy per area that friction has taken so far. In a "
    "recording with color='pressure', 'traction' or 'state' the faces of both bodies have the colours of the contact, "
    "too."
)


class SmallSlidingColors:
    """Colours of the fields of small-sliding contacts, one range for the whole run; `fields` are those that at least
    one of them has."""

    def __init__(self, small_sliding: list[SmallSlidingResult], rows: np.ndarray) -> None:
        rubbing = any(contact.friction > 0.0 for contact in small_sliding)
        self.fields = [f for f in TITLES if f != "loss" or rubbing] if small_sliding else []
        pressure, loss = (largest([a[rows] for a in of]) for of in (
            [contact.peak_pressure for contact in small_sliding], [contact.loss_density for contact in small_sliding],
        ))  # fmt: skip
        self._scales: dict[str, ColorScale | ColorClasses] = {
            "pressure": ColorScale("pressure of small-sliding contacts [MPa]", pressure, 1e-6, PRESSURE_STOPS),
            "state": ColorClasses("state of the cells of small-sliding contacts", STATES, STATE_COLORS),
            "loss": ColorScale("accumulated friction loss of contacts [J/m²]", loss, 1.0, WEAR_STOPS),
        }

    def scale(self, field: str) -> ColorScale | ColorClasses:
        """The colours of one field."""
        return self._scales[field]


class SmallSlidingScene:
    """Logs one small-sliding contact into a recording."""

    def __init__(self, recorder: Any, contact: SmallSlidingResult, skin: Any) -> None:
        self.recorder, self.contact = recorder, contact
        self.fields = [
            field for field in recorder.small_sliding_colors.fields if field != "loss" or contact.friction > 0.0
        ]
        self._on = CellsOnSkin(contact.view, skin)

    def path(self, *parts: str) -> str:
        """Entity below the contact's frame."""
        return self.recorder.path("world", "small_sliding", self.contact.name, *parts)

    def static(self) -> None:
        """Log the topology: triangles without shared corners, so that each has one colour."""
        rr = self.recorder.rr
        triangles = np.arange(3 * len(self._on.cell), dtype=np.uint32).reshape(-1, 3)
        normals = np.repeat(self.contact.frames[self._on.cell, 0], 3, axis=0).astype(np.float32)
        for field in self.fields:
            mesh = rr.Mesh3D.from_fields(triangle_indices=triangles.copy(), vertex_normals=normals.copy())
            self.recorder.log_static(self.path(field), mesh)
        corners = self._on.corners.reshape(-1, 3)
        middle, size = corners.mean(axis=0), float(np.ptp(corners, axis=0).max())
        self.recorder.log_static(self.path(EYE), rr.Transform3D(translation=middle, scale=size))

    def frame(self, i: int) -> None:
        """Log pose, positions and colours of saved row `i`."""
        recorder, contact = self.recorder, self.contact
        rr, log = recorder.rr, recorder.stream.log
        motion = recorder.result.history.bodies[contact.view.first_body.name]
        pose = rr.Transform3D(
            translation=motion.position[i].copy(), quaternion=rr.Quaternion(xyzw=motion.rotation[i].copy())
        )
        log(self.path(), pose)
        corners = self._on.corners.reshape(-1, 3)
        carried = recorder.reference.motion(contact.view.first_body.name, corners, i)
        moved = self._on.displacement(i).reshape(-1, 3)
        places = (corners + carried + recorder.factor * (moved - carried)).astype(np.float32)
        values = {"pressure": contact.pressure, "state": contact.state, "loss": contact.loss_density}
        for field in self.fields:
            colors = recorder.small_sliding_colors.scale(field).packed(values[field][i])[self._on.cell].repeat(3)
            log(self.path(field), rr.Mesh3D.from_fields(vertex_positions=places.copy(), vertex_colors=colors))

    def view(self, field: str) -> Any:
        """A view of one field in the frame of the first body, from outside of its face."""
        import rerun.blueprint as rrb

        contact = self.contact
        normal = contact.area @ contact.frames[:, 0] / contact.area.sum()
        if np.linalg.norm(normal) < SIDEWAYS:  # closed around the axis: from the side of any cell
            normal = contact.frames[0, 0]
        up = np.eye(3)[np.argmin(np.abs(normal))]
        eye = normal / np.linalg.norm(normal) + SIDEWAYS * up
        several = f" '{contact.name}'" if len(self.recorder.small_sliding_scenes) > 1 else ""
        return rrb.Spatial3DView(
            origin=self.path(EYE),
            contents=[f"+ {self.path(field)}"],
            name=f"{TITLES[field]} of the contact{several}, on '{contact.view.first_body.name}'",
            eye_controls=rrb.EyeControls3D(
                position=DISTANCE * eye, look_target=(0.0, 0.0, 0.0), eye_up=tuple(up.tolist())
            ),
            line_grid=False,
        )
