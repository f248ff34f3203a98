"""A rerun recording of a run: `show` and `streams` import rerun when needed.

Entities: `/world/<body>` carries the rigid motion as a transform; its child `surface` is the deforming skin in the user
frame with the displacement times the deformation factor, coloured by displacement; `solid` that of a rigid body, see
`rigid_bodies`; `frame` its user frame, hidden at first. `/world/joint_arrows`, `/world/force_arrows`,
`/world/lumped_arrows` show forces of joints, force elements and lumped contacts, `/world/triad` axes and scale, see
`glyphs`. `/world/contacts/<pair>` is a frame that follows the patch (x along the arc, y along the axis, z outwards) and
carries the pressure relief, `/patch_map/<pair>` is the unwrapped patch, see `contact_scene`; `/world/forces/<pair>` has
the contact's arrows; `/world/<body>/<film>` and `/film_map/<film>` an oil film, see `film_scene`;
`/world/small_sliding/<contact>` the cells of a small-sliding contact, see `small_sliding_scene`; `/world/gears/<pair>`
is the frame of a view of flanks, see `gear_scene`; `/load_zones` and `/orbits` those of bearings and shafts, see
`round_plots`; `/plots` and `/solver` are scalars over all saved rows.
Entities called `eye` scale what a view shows to one unit, see `extent`.

Pictures are transparent, with lines and text in a grey that is visible on black and on white, and no view has a
background of its own, so that a recording follows the viewer's theme.

Every array is passed as a fresh copy: rerun sends data after the call returns, so a buffer modified in between would be
sent modified.
"""

from __future__ import annotations

import os
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from warpffrf.model.errors import MOST_COUNTED, InputError, require_count
from warpffrf.model.files.paths import checked_output_path, written_whole
from warpffrf.model.messages.named_arguments import named_arguments
from warpffrf.model.messages.progress import Progress
from warpffrf.online.history.history import History
from warpffrf.output.bodies.normal_loads import left_out
from warpffrf.output.bodies.skin import DISPLACEMENT, VON_MISES, Skin, require_field
from warpffrf.output.geometry.reference import Reference
from warpffrf.output.geometry.scene_view import GROUND
from warpffrf.output.geometry.skin_nodes import automatic_factor, frame_rows, round_factor, rows_every, vertex_normals
from warpffrf.output.plots.colors import (
    ColorClasses,
    ColorScale,
    displacement_scale,
    field_scale,
    largest,
    legend_picture,
)
from warpffrf.output.recording import frames as fr
from warpffrf.output.recording.contact_scene import ContactColors, ContactScene, contact_series, machine_series
from warpffrf.output.recording.extent import EYE, extent
from warpffrf.output.recording.film_scene import FilmColors, FilmScene
from warpffrf.output.recording.frames import close_stream, in_memory, new_stream
from warpffrf.output.recording.gear_scene import GearScene
from warpffrf.output.recording.glyphs import Glyphs, force_text
from warpffrf.output.recording.layout import blueprint
from warpffrf.output.recording.magnification import largest_factor
from warpffrf.output.recording.rigid_bodies import RigidBodies
from warpffrf.output.recording.round_plots import LoadZone, orbits
from warpffrf.output.recording.small_sliding_scene import SMALL_SLIDING_TEXT, SmallSlidingColors, SmallSlidingScene
from warpffrf.output.result import Result

MAX_POINTS = 8000  # per body: 16 bytes per point and frame, so 300 frames of two bodies stay below 80 MB
MAX_SERIES = 4000  # points of a scalar plot: more than the pixels of a screen
AXES_LENGTH = 0.58  # of the largest body: extends beyond a roller's rim
AXES_COLORS = [(230, 80, 80), (90, 200, 90), (90, 130, 255)]  # x, y, z
COLOR_NAMES = {VON_MISES: "von Mises stress", "slip": "slip speed", "wear": "wear index"}
CONTACT_TEXT = (
    "The close-up travels with the patch on the first body: the height of the relief is the pressure, and a bar along "
    "the arc has the length that its title says. The patch map is "
    "the same patch unwrapped, the arc to the right along e_theta and the axis of the first body upwards."
)
FILM_TEXT = (
    "Oil films are shown on their first surface, without its body, and unwrapped: pressure, gap, and the fraction of "
    "the gap that is filled. The orbit is the path of the shaft's centre in the circle of the clearance, in directions "
    "that rotate with the first body."
)
GEAR_TEXT = (
    "The flanks of a gear pair are those of its gear 1 at the pitch point, seen from gear 2, which is left out; the "
    "pressure on them has the colours of the contacts."
)
FRICTION_TEXT = (
    "With friction every cell, of the contact grid or of those that travel with the patch, is open, sticks or slips. "
    "Arrows in the map of the traction are the traction on the first body. Creepages, forces and the spin moment are "
    "those of the first body: longitudinal is along e_theta, lateral along its axis. T-gamma is the energy that they "
    "take per metre rolled. The wear index is pressure times slip speed. Material runs through the patch along e_theta "
    "where the rolling velocity is positive, and enters it on the left."
)


@dataclass(frozen=True)
class RecordingInfo:
    """Summary of the recording: path, frames shown, stride in saved rows, deformation factor, rows omitted because they
    are not finite."""

    path: Path
    frames: int
    stride: int
    deformation_factor: float
    skipped_rows: list[int] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)


@named_arguments
def record(
    result: Result | History | str | os.PathLike[str],
    path: str | os.PathLike[str],
    *,
    deformation_factor: float | None = None,
    relative_to: str | None = None,
    max_frames: int = 300,
    every: int | None = None,
    max_points: int = MAX_POINTS,
    color: str = DISPLACEMENT,
    overwrite: bool = False,
    progress: bool = False,
) -> RecordingInfo:
    """Write a .rrd of a result, or of a results file (.h5), that `warpffrf view FILE` or `rerun FILE` opens.

    color: quantity of the surface colours: "displacement"; for contacts, oil films and small-sliding contacts
    "pressure", with friction "traction" and "state", and for contacts with friction "slip" and "wear"; "von_mises" for
    bodies reduced with `stress={"skin": "skin"}` (surfaces without stress are dark grey).

    deformation_factor [-]: magnification of the elastic displacement; None: chosen from 1, 2, 5, 10, ... so that no
    surfaces of contacts and films are drawn into each other; rigid motion is never magnified. relative_to: name of an
    interface, whose motion is then neither shown as displacement nor magnified, of the bodies that have it; "start":
    the whole motion of flexible bodies since the first saved step; None: their user frames. Every `every`th saved row
    and the last are drawn; None: at most `max_frames` rows; at most `max_points` points of each body's surface. Rows
    with non-finite values are omitted and listed in the return value and in the recording. progress: report the
    progress on stderr. Raises InputError for a path that cannot be written, a factor or count that is not positive, a
    colour that the run does not have, a run without saved rows, and an existing file, unless `overwrite` is set and
    warpffrf wrote it.

    >>> info = wf.record(result, "rollers.rrd", max_frames=20)
    """
    result = _result(result)
    if deformation_factor is not None and not deformation_factor > 0.0:
        raise InputError(f"record: deformation_factor is {deformation_factor}; it must be positive")
    if max_frames < 1 or max_points < 4:
        raise InputError(
            f"record: max_frames is {max_frames} and max_points {max_points}; they must be at least 1 and 4"
        )
    if every is not None:
        require_count(every, "record: every", 1, most=MOST_COUNTED)
    if len(result.time) == 0:
        raise InputError("record: the run has no saved row to draw")
    target = checked_output_path(path, "record", overwrite=overwrite)
    skins = result.skins()
    require_field(skins, color, "record: color")
    reference = Reference(result.view.bodies, result.history.bodies, relative_to, "record")
    saved = len(result.time)
    rows, stride = frame_rows(saved, max_frames) if every is None else (rows_every(saved, every), every)
    with np.errstate(invalid="ignore"):
        bodies = fr.body_frames(skins, rows, max_points, color, reference, progress)
    good = np.array([row_is_finite(result, bodies, f, int(i)) for f, i in enumerate(rows)])
    skipped = [int(i) for i in rows[~good]]
    with written_whole(target) as partial:
        recorder = Recorder(result, skins, bodies, rows, good, stride, deformation_factor, color, reference)
        recorder.write(partial, skipped, progress)
    return RecordingInfo(target, int(good.sum()), stride, recorder.factor, skipped, recorder.notes)


def _result(given: Result | History | str | os.PathLike[str]) -> Result:
    if isinstance(given, str | os.PathLike):
        return Result.load(given)
    return given if isinstance(given, Result) else Result(given)


def row_is_finite(result: Any, bodies: dict[str, fr.BodyFrames], f: int, i: int) -> bool:
    history = result.history
    arrays = [b.displacement[f] for b in bodies.values()]
    arrays += [a[i] for m in history.bodies.values() for a in (m.position, m.rotation)]
    owners = (*history.joints.values(), *history.forces.values(), *history.lumped_contacts.values())
    arrays += [a.force[i] for a in owners]
    arrays += [a[i] for f in history.films.values() for a in (f.force, f.pressure)]
    arrays += [
        a[i] for contact in history.small_sliding.values() for a in (contact.force, contact.pressure, contact.loss)
    ]
    arrays += [a[i] for c in history.contacts.values() for a in (c.force, c.pressure, c.center_column)]
    rubbing = [c.friction for c in history.contacts.values() if getattr(c, "friction", None) is not None]
    arrays += [a[i] for f in rubbing for a in (f.traction, f.slip_velocity)]
    return all(bool(np.all(np.isfinite(a))) for a in arrays)


class Recorder:
    """Writes one recording; the constructor fixes the colour ranges and the factor."""

    def __init__(
        self,
        result: Any,
        skins: dict[str, Skin],
        bodies: dict[str, fr.BodyFrames],
        rows: np.ndarray,
        good: np.ndarray,
        stride: int,
        factor: float | None,
        color: str,
        reference: Reference,
        stream: Any = None,
    ) -> None:
        import rerun as rr

        self.rr = rr
        self.stream = new_stream() if stream is None else stream
        self.result, self.skins, self.bodies, self.rows, self.good, self.stride = (
            result,
            skins,
            bodies,
            rows,
            good,
            stride,
        )
        self.reference = reference
        self.contacts = [result.contact(name) for name in result.finite_sliding_names]
        drawn = np.flatnonzero(good)  # row by row: a copy of all rows would double the memory
        shown = [np.linalg.norm(b.displacement[f], axis=-1) for b in bodies.values() for f in drawn]
        top = largest(shown)
        self.rigid = RigidBodies(self)
        self.middle, self.outermost = extent(self)
        self.radius = float(np.linalg.norm(self.outermost, axis=1).max())
        rigid = [float(np.ptp(m.points, axis=0).max()) for n, m in self.rigid.meshes.items() if n != GROUND]
        self.size = max([b.size for b in bodies.values()] + rigid, default=0.0) or self.radius
        smallest = min((b.size for b in bodies.values()), default=0.1)
        self.apart = largest_factor(result, bodies, rows, drawn)
        automatic = round_factor(min(automatic_factor(top, smallest), self.apart))
        self.factor = float(factor) if factor is not None else automatic
        self.top_force = largest([c.force_magnitude[rows[good]] for c in self.contacts])
        films = list(result.history.films.values())
        small_sliding = [result.contact(name) for name in result.small_sliding_names]
        self.color, self.contact_colors = color, ContactColors(self.contacts, films, small_sliding, rows[good])
        self.skin_scale, self.moves = self._skin_scale(top), top > 0.0  # not rigid bodies on half-spaces
        self.scenes = [ContactScene(self, contact) for contact in self.contacts]
        self.film_colors = FilmColors(films, rows[good], self.contact_colors.scale("pressure"))
        self.film_scenes = [FilmScene(self, name) for name in result.view.films]
        self.small_sliding_colors = SmallSlidingColors(small_sliding, rows[good])
        self.small_sliding_scenes = [
            SmallSlidingScene(self, contact, skins[contact.view.first_body.name]) for contact in small_sliding
        ]
        self.gear_scenes = [GearScene(self, name) for name in result.view.gears]
        self.load_zones, self.orbits = [LoadZone(self, name) for name in result.view.bearings], orbits(self)
        self.drawings = [
            *self.scenes, *self.film_scenes, *self.small_sliding_scenes, *self.gear_scenes,
            *self.load_zones, *self.orbits, Glyphs(self, self.size),
        ]  # fmt: skip
        self.glyphs = self.drawings[-1]
        fields = self.contact_colors.fields
        self.scales: list[ColorScale | ColorClasses] = [self.contact_colors.scale(name) for name in fields]
        if bodies and color not in fields and (self.moves or color != DISPLACEMENT):
            self.scales.insert(0, self.skin_scale)
        self.scales += [self.film_colors.scale(name) for name in self.film_colors.fields]
        self.scales += [self.small_sliding_colors.scale(name) for name in self.small_sliding_colors.fields]
        self.scales += [self.rigid.scale] * self.rigid.shows_loads
        self.scales = list({scale.label: scale for scale in self.scales}.values())  # films and contacts share pressure
        self.notes = self._notes()

    def _skin_scale(self, top: float) -> ColorScale | ColorClasses:
        """Colours of the skins; top: the largest displacement [m]."""
        if self.color == DISPLACEMENT:
            return displacement_scale(top)
        if self.color == VON_MISES:
            stresses = [b.values[self.good] for b in self.bodies.values() if b.values is not None]
            return field_scale(VON_MISES, largest(stresses))
        return self.contact_colors.scale(self.color)

    def path(self, *parts: str) -> str:
        """Entity path with every part escaped."""
        return self.rr.new_entity_path(list(parts))

    def write(self, file: Path, skipped: list[int], progress: bool = False) -> None:
        """Log everything to `file` and close the stream."""
        try:
            memory = in_memory(self.stream, blueprint(self))
            self._log(skipped, progress)
            written = memory.drain_as_bytes()
        finally:
            close_stream(self)
        file.write_bytes(written)

    def _log(self, skipped: list[int], progress: bool) -> None:
        if skipped:
            self.notes.append(f"left out because a value is not finite: saved rows {', '.join(map(str, skipped))}")
        self._static()
        self._series()
        bar = Progress("recording", len(self.rows), enabled=progress, unit="frame")
        for f, i in enumerate(self.rows):
            bar.update(f)
            if self.good[f]:
                self.stream.set_time("time", duration=float(self.result.time[i]))
                self.log_bodies(f, int(i))
                self.rigid.frame(int(i))
                for drawing in self.drawings:
                    drawing.frame(int(i))
        bar.close()

    # --- once ---

    def _notes(self) -> list[str]:
        notes = [
            f"{int(self.good.sum())} of {len(self.result.time)} saved rows are drawn, stride {self.stride}; "
            f"plots use up to {MAX_SERIES}"
        ]
        if self.moves:
            notes.insert(
                0,
                f"elastic displacement{self.reference.words} is magnified {self.factor:g} times, rigid motion is not, "
                "so touching surfaces are drawn apart",
            )
        if self.factor > max(self.apart, 1.0):
            notes.insert(
                1,
                f"above a magnification of {max(self.apart, 1.0):.3g} some surfaces are drawn into each other; "
                "deformation_factor=None stays below",
            )
        shown = {name: (len(b.points), b) for name, b in self.bodies.items()}
        for name, (count, _) in shown.items():
            full = len(self.skins[name].points)
            if count < full:
                notes.append(f"surface of '{name}' drawn with {count} of {full} points")
        if self.color == VON_MISES:
            notes += [skin.stress.note for skin in self.skins.values() if skin.stress.note]
        return [*notes, *left_out(self.result.view.bodies.values()), *self.result.history.notes]

    def log_geometry(self) -> None:
        """Log what does not change of bodies."""
        rr, log = self.rr, self.log_static
        log("world", rr.ViewCoordinates.RIGHT_HAND_Z_UP)
        log(self.path("world", EYE), rr.Transform3D(translation=self.middle, scale=self.radius))
        for name in self.result.history.bodies:  # the user frame shows the rotation of a round body
            lines = [[[0.0, 0.0, 0.0], axis] for axis in (AXES_LENGTH * self.size * np.eye(3)).tolist()]
            strips = rr.LineStrips3D(lines, colors=AXES_COLORS, radii=0.004 * self.size)
            log(self.path("world", name, "frame"), strips)
        for name, body in self.bodies.items():
            normals = vertex_normals(body.points, body.triangles).astype(np.float32)
            triangles = np.array(body.triangles, dtype=np.uint32)
            log(
                self.path("world", name, "surface"),
                rr.Mesh3D.from_fields(triangle_indices=triangles, vertex_normals=normals),
            )
        self.rigid.static()

    def _static(self) -> None:
        rr, log = self.rr, self.log_static
        self.log_geometry()
        for drawing in self.drawings:
            drawing.static()
        if self.scales:
            log("legend", rr.Image(legend_picture(self.scales), opacity=fr.BLENDED))
        log("about", rr.TextDocument(self._about(), media_type=rr.MediaType.MARKDOWN))

    def log_static(self, path: str, *archetypes: Any) -> None:
        """Log data for the whole recording."""
        self.stream.log(path, *archetypes, static=True)

    def _about(self) -> str:
        contacts = [
            f"- **{c.name}**: force on '{c.view.first_body.name}' (blue) and on '{c.view.second_body.name}' (orange)"
            for c in self.contacts
        ]
        parts = (
            "# What this shows",
            f"Flexible bodies are coloured by {COLOR_NAMES.get(self.color, self.color)}, contact patches by pressure; "
            "the ranges hold for the whole run. Rigid bodies are drawn by the surfaces that their contacts have, "
            "rolling elements and other bodies in lumped contact coloured by their largest contact force; a dark line "
            "shows their rotation. Bodies without surfaces are small balls with rods to their joints and forces. "
            "The red, green and blue arrows are x, y and z of the world, of the length that is written there; the user "
            "frame of each body is the entity `frame` below it, hidden at first.",
            "Green arrows are reactions of joints on their second body, orange ones forces on the body that they load, "
            "blue ones those of lumped contacts on their first body; "
            f"one length for all, the largest is {force_text(self.glyphs.top_force)}.",
            *([CONTACT_TEXT] if self.contacts else []),
            *([GEAR_TEXT] if self.gear_scenes else []),
            *([FILM_TEXT] if self.result.film_names else []),
            *([SMALL_SLIDING_TEXT] if self.small_sliding_scenes else []),
            *([FRICTION_TEXT] if any(c.has_friction for c in self.contacts) else []),
            "\n".join(contacts),
            "## Notes",
            "\n".join(f"- {note}" for note in self.notes),
            "## Report",
            f"```\n{self.result.report()}\n```",
        )  # fmt: skip
        return "\n\n".join(parts) + "\n"

    def _series(self) -> None:
        rr, result, history = self.rr, self.result, self.result.history
        step = -(-len(result.time) // MAX_SERIES)
        rows = np.unique(np.append(np.arange(0, len(result.time), step), len(result.time) - 1))
        series = machine_series(result)
        for c in self.contacts:
            series += contact_series(c)
        series.append((("solver", "iterations"), "Newton iterations per step", history.iterations))
        series.append((("solver", "factorisations"), "factorisations a step", history.factorisations))
        series.append((("solver", "energy_residual"), "energy residual over the energy scale", result.energy_residual))
        series.append((("solver", "step_size"), "step size [s]", history.step_size))
        for parts, label, values in series:
            path = self.path(*parts)
            use = rows[np.isfinite(np.asarray(values, dtype=float)[rows])]
            if not len(use):  # the viewer panics at a column without rows
                continue
            self.log_static(path, rr.SeriesLines(names=[label]))
            times = rr.TimeColumn("time", duration=np.asarray(result.time)[use].copy())
            self.stream.send_columns(path, [times], rr.Scalars.columns(scalars=np.array(values, dtype=float)[use]))

    # --- every frame ---

    def log_bodies(self, f: int, i: int) -> None:
        """Log poses and surfaces of frame f, saved row i."""
        rr = self.rr
        for name, motion in self.result.history.bodies.items():
            pose = rr.Transform3D(
                translation=motion.position[i].copy(), quaternion=rr.Quaternion(xyzw=motion.rotation[i].copy())
            )
            self.stream.log(self.path("world", name), pose)
            if name not in self.bodies:
                continue
            body = self.bodies[name]
            positions = (body.points + body.carried[f] + self.factor * body.displacement[f]).astype(np.float32)
            values = np.linalg.norm(body.displacement[f], axis=-1) if body.values is None else body.values[f]
            colors = self.skin_scale.packed(values)
            mesh = rr.Mesh3D.from_fields(vertex_positions=positions, vertex_colors=colors)
            self.stream.log(self.path("world", name, "surface"), mesh)
