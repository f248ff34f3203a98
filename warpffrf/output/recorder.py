"""A rerun recording of a run: one of the two modules that import rerun (`show` is the other).

Entities: `/world/<body>` carries the rigid motion as a transform, its child `surface` the deforming skin in the user
frame with the displacement times the deformation factor, coloured by displacement, or its children `box` and `bars`
where it is rigid; `/world/joint_arrows`, `/world/force_arrows` what joints and forces do, see `glyphs`;
`/world/contacts/<pair>` is a frame that stays with the patch (x along the arc, y along the axis, z outwards) and
carries the pressure relief; `/world/forces/<pair>` its arrows; `/plots`, `/solver` scalars over all saved rows;
`/patch_map/<pair>` the unwrapped pressure.

Every array is handed over as a fresh copy: rerun sends later than it is called, and a buffer changed in between is
sent changed.
"""

from __future__ import annotations

import os
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from warpffrf.model.errors import InputError
from warpffrf.output import frames as fr
from warpffrf.output.colors import DISPLACEMENT_STOPS, PRESSURE_STOPS, ColorScale, legend_picture, map_axes_picture
from warpffrf.output.glyphs import Glyphs, force_text, rigid_size
from warpffrf.output.machine_series import machine_series
from warpffrf.output.paths import checked_output_path, written_whole
from warpffrf.output.thinning import vertex_normals

MAX_POINTS = 8000  # a body: 16 bytes a point and frame, so 300 frames of two bodies stay under 80 MB
MAX_SERIES = 4000  # points of a scalar plot: more than a screen has pixels
PLAYBACK_SECONDS = 12.0  # how long the viewer takes to play a run, however short the run
MAP_SHAPE = (220, 480)  # pixels (height, width) of the patch map
ARROW_LENGTH = 0.6  # of the largest body, for the largest force of the run
AXES_LENGTH = 0.58  # of the largest body: out of a roller's rim
RIGID_AXES_LENGTH = 0.2  # where nothing hides them
AXES_COLORS = [(230, 80, 80), (90, 200, 90), (90, 130, 255)]  # x, y, z
FIRST_COLOR, SECOND_COLOR = (120, 190, 255), (255, 170, 90)


@dataclass(frozen=True)
class RecordingInfo:
    """What was written: path, frames shown, stride in saved rows, deformation factor, rows left out because they
    are not finite."""

    path: Path
    frames: int
    stride: int
    deformation_factor: float
    skipped_rows: list[int] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)


def record(
    result: Any,
    path: str | os.PathLike[str],
    *,
    deformation_factor: float | None = None,
    max_frames: int = 300,
    max_points: int = MAX_POINTS,
) -> RecordingInfo:
    """Write a .rrd of a Result (or History) that `rerun FILE` opens.

    deformation_factor: magnification of the elastic displacement, chosen from 1, 2, 5, 10, ... when None; rigid
    motion is never magnified. At most `max_frames` saved rows are drawn, at most `max_points` points of each body's
    surface. Rows with a value that is not finite are left out and listed in the answer and in the recording. Raises
    InputError for a path that cannot be written, a factor or count that is not positive, and a run without saved
    rows.
    """
    from warpffrf.output.result import Result

    result = result if isinstance(result, Result) else Result(result)
    if deformation_factor is not None and not deformation_factor > 0.0:
        raise InputError(f"record: deformation_factor is {deformation_factor}; it must be positive")
    if max_frames < 1 or max_points < 4:
        raise InputError(
            f"record: max_frames is {max_frames} and max_points {max_points}; they must be at least 1 and 4"
        )
    if len(result.time) == 0:
        raise InputError("record: the run has no saved row to draw")
    target = checked_output_path(path, "record")
    rows, stride = fr.frame_rows(len(result.time), max_frames)
    with np.errstate(invalid="ignore"):
        bodies = fr.body_frames(result, rows, max_points)
    good = np.array([_row_is_finite(result, bodies, f, int(i)) for f, i in enumerate(rows)])
    skipped = [int(i) for i in rows[~good]]
    with written_whole(target) as partial:
        recorder = _Recorder(result, bodies, rows, good, stride, deformation_factor)
        recorder.write(partial, skipped)
    return RecordingInfo(target, int(good.sum()), stride, recorder.factor, skipped, recorder.notes)


def _row_is_finite(result: Any, bodies: dict[str, fr.BodyFrames], f: int, i: int) -> bool:
    history = result.history
    arrays = [b.displacement[f] for b in bodies.values()]
    arrays += [a[i] for m in history.bodies.values() for a in (m.position, m.rotation)]
    arrays += [a.force[i] for a in (*history.joints.values(), *history.forces.values())]
    arrays += [a[i] for c in history.contacts.values() for a in (c.force, c.pressure, c.center_column)]
    return all(bool(np.all(np.isfinite(a))) for a in arrays)


class _Recorder:
    """Writes one recording; the colour ranges and the factor are fixed in the constructor."""

    def __init__(
        self,
        result: Any,
        bodies: dict[str, fr.BodyFrames],
        rows: np.ndarray,
        good: np.ndarray,
        stride: int,
        factor: float | None,
    ) -> None:
        import rerun as rr

        self.rr = rr
        self.stream = rr.RecordingStream("warpffrf")
        self.result, self.bodies, self.rows, self.good, self.stride = result, bodies, rows, good, stride
        self.contacts = [result.contact(name) for name in result.contact_names]
        shown = [np.linalg.norm(b.displacement[good], axis=-1) for b in bodies.values()]
        top = fr.largest(shown)
        view = result.view
        # where bodies touch the view is that of the flexible ones: invented inertias of carriages would rule it
        seen = [b for b in view.bodies.values() if b.reduced is None and not (self.contacts and bodies)]
        rigid = [rigid_size(b, view.anchors) for b in seen]
        self.size = max([b.size for b in bodies.values()] + rigid, default=0.0) or 0.1
        smallest = min((b.size for b in bodies.values()), default=0.1)
        automatic = fr.round_factor(fr.SHOWN_DISPLACEMENT * smallest / top) if top > 0.0 else 1.0
        self.factor = float(factor) if factor is not None else automatic
        unit, per_metre = ("mm", 1e3) if top > 1e-3 else ("µm", 1e6)
        self.moved = ColorScale(f"elastic displacement of the bodies [{unit}]", top, per_metre, DISPLACEMENT_STOPS)
        peak = fr.largest([c.peak_pressure[rows[good]] for c in self.contacts])
        self.pressed = ColorScale("contact pressure [MPa]", peak, 1e-6, PRESSURE_STOPS)
        self.top_force = fr.largest([c.force_magnitude[rows[good]] for c in self.contacts])
        self.glyphs = Glyphs(self, self.size)
        self.scales = [self.moved] * bool(bodies) + [self.pressed] * bool(self.contacts)
        self.notes = self._notes()

    def path(self, *parts: str) -> str:
        """Entity path with every part escaped."""
        return self.rr.new_entity_path(list(parts))

    def write(self, file: Path, skipped: list[int]) -> None:
        """Log everything to `file`."""
        from warpffrf.output.recording_layout import blueprint

        self.stream.save(str(file), default_blueprint=blueprint(self))
        if skipped:
            self.notes.append(f"left out because a value is not finite: saved rows {', '.join(map(str, skipped))}")
        self._static()
        self._series()
        for f, i in enumerate(self.rows):
            if self.good[f]:
                self.stream.set_time("time", duration=float(self.result.time[i]))
                self._bodies(f, int(i))
                self.glyphs.frame(int(i))
                for contact in self.contacts:
                    self._contact(contact, int(i))
        self.stream.flush()
        self.stream.disconnect()

    # --- once ---

    def _notes(self) -> list[str]:
        notes = [
            f"{int(self.good.sum())} of {len(self.result.time)} saved rows are drawn, stride {self.stride}; "
            f"plots use up to {MAX_SERIES}"
        ]
        if self.bodies:
            notes.insert(
                0,
                f"elastic displacement is magnified {self.factor:g} times, rigid motion is not, so touching surfaces "
                "are drawn apart",
            )
        shown = {name: (len(b.points), b) for name, b in self.bodies.items()}
        for name, (count, _) in shown.items():
            full = len(self.result.view.bodies[name].reduced.surface.points)
            if count < full:
                notes.append(f"surface of '{name}' drawn with {count} of {full} points")
        return [*notes, *self.result.history.notes]

    def _static(self) -> None:
        rr, log = self.rr, self.log_static
        log("world", rr.ViewCoordinates.RIGHT_HAND_Z_UP)
        for name in self.result.history.bodies:  # the user frame shows how a round body turns
            length = (AXES_LENGTH if self.contacts else RIGID_AXES_LENGTH) * self.size
            lines = [[[0.0, 0.0, 0.0], axis] for axis in (length * np.eye(3)).tolist()]
            strips = rr.LineStrips3D(lines, colors=AXES_COLORS, radii=0.004 * self.size)
            log(self.path("world", name, "frame"), strips)
        for name, body in self.bodies.items():
            normals = vertex_normals(body.points, body.triangles).astype(np.float32)
            triangles = np.array(body.triangles, dtype=np.uint32)
            log(
                self.path("world", name, "surface"),
                rr.Mesh3D.from_fields(triangle_indices=triangles, vertex_normals=normals),
            )
        for contact in self.contacts:
            shape = (contact.history.pressure.shape[1], contact.history.pressure.shape[2])
            triangles = fr.grid_triangles(*shape).astype(np.uint32)
            log(
                self.path("world", "contacts", contact.name, "relief"),
                rr.Mesh3D.from_fields(triangle_indices=triangles),
            )
            self._map_axes(contact)
        self.glyphs.static()
        if self.scales:
            log("legend", rr.Image(legend_picture(self.scales)))
        log("about", rr.TextDocument(self._about(), media_type=rr.MediaType.MARKDOWN))

    def log_static(self, path: str, *archetypes: Any) -> None:
        """Log something that holds for the whole recording."""
        self.stream.log(path, *archetypes, static=True)

    def _about(self) -> str:
        contacts = [
            f"- **{c.name}**: force on '{c.view.first_body.name}' (blue) and on '{c.view.second_body.name}' (orange)"
            for c in self.contacts
        ]
        parts = (
            "# What this shows",
            "Flexible bodies are coloured by elastic displacement, contact patches by pressure; the ranges hold for "
            "the whole run. The red, green and blue lines are x, y, z of each body's user frame and turn with it. "
            "A rigid body is the box with its mass and moments of inertia, with bars to the places that hold it.",
            "Green arrows are reactions of joints on their second body, orange ones forces on the body that they load; "
            f"one length for all, the largest is {force_text(self.glyphs.top_force)}.",
            *(["The close-up travels with the patch on the first body: the height of the relief is the pressure."]
              if self.contacts else []),
            "\n".join(contacts),
            "## Notes",
            "\n".join(f"- {note}" for note in self.notes),
            "## Report",
            f"```\n{self.result.report()}\n```",
        )  # fmt: skip
        return "\n\n".join(parts) + "\n"

    def patch_reach(self, contact: Any) -> float:
        """Half length [m] of arc that the patch map shows."""
        width = fr.largest([contact.half_width[self.rows[self.good]]])
        return fr.PATCH_VIEW * width if width > 0.0 else 0.5 * contact.spacing * contact.history.pressure.shape[1]

    def _map_axes(self, contact: Any) -> None:
        """The patch map's axes as a still picture; the pressure picture is laid into its frame."""
        rr = self.rr
        z = np.asarray(contact.view.first.grid.z)
        picture, (left, top) = map_axes_picture(self.patch_reach(contact), float(z[0]), float(z[-1]), MAP_SHAPE)
        self.log_static(self.path("patch_map", contact.name, "axes"), rr.Image(picture, draw_order=0.0))
        self.log_static(self.path("patch_map", contact.name, "pressure"), rr.Transform3D(translation=[left, top, 0.0]))

    def _series(self) -> None:
        rr, result, history = self.rr, self.result, self.result.history
        step = -(-len(result.time) // MAX_SERIES)
        rows = np.unique(np.append(np.arange(0, len(result.time), step), len(result.time) - 1))
        series = machine_series(result)
        for c in self.contacts:
            series.append((("plots", "force", c.name), f"{c.name} [kN]", c.force_magnitude * 1e-3))
            series.append((("plots", "peak_pressure", c.name), f"{c.name} [MPa]", c.peak_pressure * 1e-6))
            series.append((("plots", "half_width", c.name), f"{c.name} [µm]", c.half_width * 1e6))
            series.append((("solver", "active_modes", c.name), f"{c.name} active modes", c.active_modes))
        series.append((("solver", "iterations"), "Newton iterations a step", history.iterations))
        series.append((("solver", "factorisations"), "factorisations a step", history.factorisations))
        series.append(
            (("solver", "energy_residual"), "energy residual over the largest energy at hand", result.energy_residual)
        )
        series.append((("solver", "step_size"), "step size [s]", history.step_size))
        for parts, label, values in series:
            path = self.path(*parts)
            self.log_static(path, rr.SeriesLines(names=[label]))
            use = rows[np.isfinite(np.asarray(values, dtype=float)[rows])]
            times = rr.TimeColumn("time", duration=np.asarray(result.time)[use].copy())
            self.stream.send_columns(path, [times], rr.Scalars.columns(scalars=np.array(values, dtype=float)[use]))

    # --- every frame ---

    def _bodies(self, f: int, i: int) -> None:
        rr = self.rr
        for name, motion in self.result.history.bodies.items():
            pose = rr.Transform3D(
                translation=motion.position[i].copy(), quaternion=rr.Quaternion(xyzw=motion.rotation[i].copy())
            )
            self.stream.log(self.path("world", name), pose)
            if name not in self.bodies:
                continue
            body = self.bodies[name]
            positions = (body.points + self.factor * body.displacement[f]).astype(np.float32)
            colors = self.moved.packed(np.linalg.norm(body.displacement[f], axis=-1))
            mesh = rr.Mesh3D.from_fields(vertex_positions=positions, vertex_colors=colors)
            self.stream.log(self.path("world", name, "surface"), mesh)

    def relief_height(self, contact: Any) -> float:
        """Height [m] that the largest pressure of the run is drawn with."""
        return fr.RELIEF_HEIGHT * 2.0 * self.patch_reach(contact)

    def _contact(self, contact: Any, i: int) -> None:
        rr = self.rr
        frame = fr.patch_frame(self.result, contact, i)
        self.stream.log(
            self.path("world", "contacts", contact.name), rr.Transform3D(translation=frame.origin, mat3x3=frame.axes)
        )
        vertices = fr.relief(contact, i, self.pressed.top, self.relief_height(contact))
        colors = self.pressed.packed(contact.history.pressure[i].reshape(-1))
        mesh = rr.Mesh3D.from_fields(vertex_positions=vertices.astype(np.float32), vertex_colors=colors)
        self.stream.log(self.path("world", "contacts", contact.name, "relief"), mesh)
        picture = self.pressed.rgb(fr.patch_map(contact, i, self.patch_reach(contact), MAP_SHAPE))
        self.stream.log(self.path("patch_map", contact.name, "pressure"), rr.Image(picture, draw_order=1.0))
        self._arrows(contact, frame, i)

    def _arrows(self, contact: Any, frame: fr.PatchFrame, i: int) -> None:
        """Both forces, drawn beside the bodies' end so that no body hides them."""
        rr = self.rr
        z = np.asarray(contact.view.first.grid.z)
        origin = frame.origin - frame.axes[:, 1] * 0.75 * (z[-1] - z[0])
        scale = ARROW_LENGTH * self.size / self.top_force if self.top_force > 0.0 else 0.0
        vectors = np.stack([contact.force[i], contact.force_second[i]]) * scale
        newton = [float(np.linalg.norm(contact.force[i])), float(np.linalg.norm(contact.force_second[i]))]
        names = (contact.view.first_body.name, contact.view.second_body.name)
        labels = [f"on {name}: {value * 1e-3:.4g} kN" for name, value in zip(names, newton, strict=True)]
        arrows = rr.Arrows3D(
            origins=np.stack([origin, origin]),
            vectors=vectors,
            colors=[FIRST_COLOR, SECOND_COLOR],
            radii=0.012 * self.size,
            labels=labels,
            show_labels=True,
        )
        self.stream.log(self.path("world", "forces", contact.name), arrows)
