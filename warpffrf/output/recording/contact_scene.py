"""One contact pair in a recording: the relief on the patch and the unwrapped map, by every field that the run has.

Below `/world/contacts/<pair>`, a frame that stays with the patch, `relief` shows the pressure as height and colour, and
with friction `relief_traction`, `relief_slip`, `relief_state`, `relief_wear` the same height in other colours. Below
`/patch_map/<pair>` lie the labelled axes, once, and a picture for each field; the map of the traction has its arrows.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from warpffrf.output.plots.colors import (
    ColorClasses,
    ColorScale,
    field_scale,
    largest,
    map_axes_picture,
)
from warpffrf.output.recording import frames as fr
from warpffrf.output.recording.glyphs import LEAST_SHOWN, MOST_LABELS
from warpffrf.output.recording.patch_map import cell_map, map_window, pixels, pressure_map

MAP_SHAPE = (220, 480)  # pixels (height, width) of the patch map
COARSER = 2  # pixels of a map to one of the pictures of friction: constant cells need no more
ARROW_LENGTH = 0.6  # of the largest body, for the largest force of the run
ARROW_CELLS = 1.5  # columns of cells that the arrow of the largest traction is long
ARROW_COLOR = (20, 20, 20)
FIRST_COLOR, SECOND_COLOR = (120, 190, 255), (255, 170, 90)
FRICTION_FIELDS = ("traction", "state", "slip", "wear")
TITLES = {
    "pressure": "Pressure",
    "traction": "Traction",
    "state": "Stick and slip",
    "slip": "Slip speed",
    "wear": "Wear index",
}


def relief_name(field: str) -> str:
    """Entity of the relief that is coloured by `field`."""
    return "relief" if field == "pressure" else f"relief_{field}"


class ContactColors:
    """Colours of the contact fields, one range for all pairs of a run; `fields` are those that some pair has."""

    def __init__(self, contacts: list[Any], films: list[Any], laps: list[Any], rows: np.ndarray) -> None:
        """films, laps: their pressures, and the tractions of laps, have the colours of those of contacts."""
        rubbing = [c.friction for c in contacts if c.has_friction]
        pressing = "contact" if contacts else "film" if films else "lap"
        self.fields = (["pressure"] if contacts else []) + (list(FRICTION_FIELDS) if rubbing else [])

        def top(arrays: list[np.ndarray]) -> float:
            return largest([a[rows] for a in arrays])

        tops = {
            "pressure": top([c.peak_pressure for c in contacts] + [o.pressure for o in (*films, *laps)]),
            "traction": top([o.traction_magnitude for o in (*rubbing, *laps)]),
            "slip": top([f.slip_speed for f in rubbing]),
            "wear": top([f.wear_index for f in rubbing]),
            "state": 0.0,
        }
        self._scales = {field: field_scale(field, most, pressing) for field, most in tops.items()}
        self.top_pressure = top([c.peak_pressure for c in contacts])
        self.top_traction = top([f.traction_magnitude for f in rubbing])

    def scale(self, field: str) -> ColorScale | ColorClasses:
        """The colours of one field."""
        return self._scales[field]


def field_window(contact: Any, field: str, i: int) -> np.ndarray:
    """(columns, rows) of one field of the pair at saved step `i`, SI units."""
    if field == "pressure":
        return contact.mean_pressure[i]
    friction = contact.friction
    return {
        "traction": friction.traction_magnitude,
        "slip": friction.slip_speed,
        "wear": friction.wear_index,
        "state": friction.state,
    }[field][i]


class ContactScene:
    """Logs one pair into a recording."""

    def __init__(self, recorder: Any, contact: Any) -> None:
        self.recorder, self.contact = recorder, contact
        self.fields = ("pressure", *(FRICTION_FIELDS if contact.has_friction else ()))
        self.window = map_window(contact, recorder.rows[recorder.good])
        self.height = fr.RELIEF_HEIGHT * 2.0 * self.window.reach

    def world(self, *parts: str) -> str:
        """Entity below the patch's frame."""
        return self.recorder.path("world", "contacts", self.contact.name, *parts)

    def map(self, *parts: str) -> str:
        """Entity below the patch's map."""
        return self.recorder.path("patch_map", self.contact.name, *parts)

    def static(self) -> None:
        """Topology of the reliefs, and the map's axes as a still picture that the fields' pictures are laid into."""
        rr, log = self.recorder.rr, self.recorder.log_static
        shape = fr.relief_values(self.contact, self.contact.history.pressure[0]).shape
        triangles = fr.grid_triangles(*shape).astype(np.uint32)
        for field in self.fields:
            log(self.world(relief_name(field)), rr.Mesh3D.from_fields(triangle_indices=triangles))
        window = self.window
        picture, self.corner = map_axes_picture(window.reach, window.low, window.high, MAP_SHAPE)
        left, top = self.corner
        log(self.map("axes"), rr.Image(picture, draw_order=0.0))
        for field in self.fields:
            scale = 1.0 if field == "pressure" else float(COARSER)
            log(self.map(field), rr.Transform3D(translation=[left, top, 0.0], scale=scale))

    def frame(self, i: int) -> None:
        """Relief, maps and arrows of saved row i."""
        recorder, contact = self.recorder, self.contact
        rr, log, colors = recorder.rr, recorder.stream.log, recorder.contact_colors
        frame = fr.patch_frame(recorder.result, contact, i)
        log(self.world(), rr.Transform3D(translation=frame.origin, mat3x3=frame.axes))
        vertices = fr.relief(contact, i, colors.top_pressure, self.height).astype(np.float32)
        for field in self.fields:
            values, scale = field_window(contact, field, i), colors.scale(field)
            colored = scale.packed(fr.relief_values(contact, values).reshape(-1))
            mesh = rr.Mesh3D.from_fields(vertex_positions=vertices.copy(), vertex_colors=colored)
            log(self.world(relief_name(field)), mesh)
            if field == "pressure":
                picture = pressure_map(contact, i, values, self.window, MAP_SHAPE)
            else:
                coarse = MAP_SHAPE[0] // COARSER, MAP_SHAPE[1] // COARSER
                picture = cell_map(contact, i, values, self.window, coarse)
            log(self.map(field), rr.Image(scale.rgb(picture), draw_order=1.0))
        if contact.has_friction:
            log(self.map("traction_arrows"), self._tractions(i))
        self._forces(frame, i)

    def _tractions(self, i: int) -> Any:
        """Arrows of the tractions on the first body in the pixels of the map; of the largest a cell long."""
        rr, contact = self.recorder.rr, self.contact
        picture, (left, top) = pixels(contact, i, self.window, MAP_SHAPE), self.corner
        tau, most = contact.friction.traction[i], self.recorder.contact_colors.top_traction
        inside = np.all((picture >= 0.0) & (picture <= np.array(MAP_SHAPE)[::-1]), axis=-1)
        shown = inside & np.any(tau != 0.0, axis=0)
        width = float(np.abs(np.diff(contact.cell_lines(i)[0])).max())
        cell = width / self.window.reach * 0.5 * MAP_SHAPE[1]
        scale = ARROW_CELLS * cell / most if most > 0.0 else 0.0
        # the picture's y runs downwards
        vectors = scale * np.stack([tau[0][shown], -tau[1][shown]], axis=-1)
        origins = picture[shown] + np.array([left, top])
        return rr.Arrows2D(
            vectors=vectors, origins=origins - 0.5 * vectors, colors=[ARROW_COLOR], radii=1.0, draw_order=2.0
        )

    def _forces(self, frame: fr.PatchFrame, i: int) -> None:
        """Both forces, drawn beside the bodies' end so that no body hides them; none of a pair that carries nothing,
        and no numbers where many pairs would write over each other."""
        recorder, contact = self.recorder, self.contact
        low, high = contact.ends
        origin = frame.origin - frame.axes[:, 1] * 0.75 * (high - low)
        scale = ARROW_LENGTH * recorder.size / recorder.top_force if recorder.top_force > 0.0 else 0.0
        vectors = np.stack([contact.force[i], contact.force_second[i]]) * scale
        newton = [float(np.linalg.norm(contact.force[i])), float(np.linalg.norm(contact.force_second[i]))]
        path = recorder.path("world", "forces", contact.name)
        if max(newton) <= LEAST_SHOWN * recorder.top_force:
            recorder.stream.log(path, recorder.rr.Arrows3D(vectors=np.zeros((0, 3))))
            return
        labelled = len(recorder.contacts) <= MOST_LABELS
        names = (contact.view.first_body.name, contact.view.second_body.name)
        labels = [f"on {name}: {value * 1e-3:.4g} kN" for name, value in zip(names, newton, strict=True)]
        arrows = recorder.rr.Arrows3D(
            origins=np.stack([origin, origin]),
            vectors=vectors,
            colors=[FIRST_COLOR, SECOND_COLOR],
            radii=0.012 * recorder.size,
            labels=labels if labelled else None,
            show_labels=labelled,
        )
        recorder.stream.log(path, arrows)
