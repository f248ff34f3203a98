r"""`show_modes`: a mode of a reduced body, animated in rerun.

Modes of a free body are numbered as in finite-element programs: 1 to 3 are translations along x, y, z, 4 to 6 rotations
about x, y, z through the centre of mass, from 7 on elastic modes by frequency. The drawn position is

    x(t) = X + scale L sin(2 pi t/T) u/max|u|,

with the largest extent L of the body and the duration T of a cycle on the screen, the same for every mode. The colour
is the amplitude |u| over its largest value and is constant in time. The topology of the mesh is logged once, positions
in every frame, colours when the mode changes. Every array is passed as a fresh copy, because rerun sends data after the
call returns.
"""

from __future__ import annotations

import os
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from warpffrf.model.errors import InputError, require_count, require_number
from warpffrf.model.files.paths import checked_output_path, written_whole
from warpffrf.model.reduced.body import ReducedBody
from warpffrf.output.geometry.skin_nodes import vertex_normals
from warpffrf.output.plots.colors import ColorScale, legend_picture
from warpffrf.output.plots.modes import MODE_STOPS, ModeSkin, eye_axes, mode_skin
from warpffrf.output.recording.frames import BLENDED, close_stream, in_memory, new_stream
from warpffrf.output.recording.viewer import has_screen

RIGID_MODES = 6
RIGID_NAMES = ("translation x", "translation y", "translation z", "rotation x", "rotation y", "rotation z")
SCALE = 0.05  # of the largest extent: well visible and still a small displacement
CYCLE_SECONDS = 2.0  # on the screen
MAX_POINTS = 8000  # 96 kB a frame
MAX_MODES = 20  # shown in sequence: 20 modes of 60 frames of 8000 points are 115 MB
EYE_DISTANCE = 1.9  # from the middle, in largest extents of the body


@dataclass(frozen=True)
class ShownModes:
    """Result of `show_modes`: the .rrd file (None: in a viewer), mode numbers, their frequencies [Hz] (rigid: 0)."""

    path: Path | None
    modes: tuple[int, ...]
    frequencies: tuple[float, ...]


def show_modes(
    body: ReducedBody,
    mode: int | None = None,
    *,
    path: str | os.PathLike[str] | None = None,
    frames: int = 60,
    scale: float | None = None,
    overwrite: bool = False,
) -> ShownModes:
    """Animate mode number `mode`, see `ReducedBody.show`; None: the first `MAX_MODES` elastic modes, one cycle each.

    Raises `InputError` for a mode that the body does not have, fewer than 2 frames, a scale that is not positive, a
    body without skin, a path that cannot be written, and, without `path`, if there is no screen.
    """
    numbers = _numbers(body, mode)
    count = require_count(frames, "show: frames", 2)
    part = SCALE if scale is None else require_number(scale, "show: scale", positive=True)
    skin = mode_skin(body, MAX_POINTS)
    if not len(skin.triangles):
        raise InputError("show: this body has no skin to draw; reduce it from a mesh with cells or facets")
    shapes = [_shape(body, skin, n) for n in numbers]
    labels = [_label(body, n) for n in numbers]
    animation = _Animation(body, skin, labels, shapes, count, part)
    if path is None:
        _require_screen()
        animation.view()
        target = None
    else:
        target = checked_output_path(path, "show: path", overwrite=overwrite)
        with written_whole(target) as partial:
            animation.write(partial)
    return ShownModes(target, numbers, tuple(_frequency(body, n) for n in numbers))


def _numbers(body: ReducedBody, mode: int | None) -> tuple[int, ...]:
    elastic = len(body.frequencies)
    last = RIGID_MODES + elastic
    if mode is None:
        if not elastic:
            raise InputError("show: this body has no elastic modes; modes 1 to 6 are its rigid motions")
        return tuple(range(RIGID_MODES + 1, min(last, RIGID_MODES + MAX_MODES) + 1))
    number = require_count(mode, "show: mode", 1)
    if number > last:
        elastic_ones = f"7 to {last} are elastic" if elastic else "it has no elastic ones"
        raise InputError(f"show: this body has no mode {number}; 1 to 6 are the rigid motions, {elastic_ones}")
    return (number,)


def _frequency(body: ReducedBody, number: int) -> float:
    return 0.0 if number <= RIGID_MODES else float(body.frequencies[number - RIGID_MODES - 1])


def _label(body: ReducedBody, number: int) -> str:
    if number <= RIGID_MODES:
        return f"Mode {number}: {RIGID_NAMES[number - 1]}"
    return f"Mode {number}: {_frequency(body, number):.6g} Hz"


def _shape(body: ReducedBody, skin: ModeSkin, number: int) -> np.ndarray:
    """Displacement (n, 3) of the skin in mode `number`, scaled to a largest length of 1."""
    if number > RIGID_MODES:
        return skin.shape(body, number - RIGID_MODES - 1)
    axis = np.eye(3)[(number - 1) % 3]
    if number <= 3:
        return np.tile(axis, (len(skin.points), 1))
    u = np.cross(axis, skin.points - body.center_of_mass)
    return u / np.linalg.norm(u, axis=1).max()


def _require_screen() -> None:
    if not has_screen():
        raise InputError("show: there is no screen for the viewer; give path='mode.rrd' and open the file elsewhere")


class _Animation:
    """One recording of modes in sequence on the timeline "time"."""

    def __init__(
        self, body: ReducedBody, skin: ModeSkin, labels: list[str], shapes: list[np.ndarray], frames: int, scale: float
    ) -> None:
        import rerun as rr

        self.rr = rr
        self.stream = new_stream()
        self.name = str(body.provenance.get("mesh_name") or "body")
        self.skin, self.labels, self.shapes, self.frames, self.scale = skin, labels, shapes, frames, scale

    def write(self, file: Path) -> None:
        """Log everything to `file` and close the stream."""
        try:
            memory = in_memory(self.stream, self._blueprint())
            self._log()
            written = memory.drain_as_bytes()
        finally:
            close_stream(self)
        file.write_bytes(written)

    def view(self) -> None:
        """Open rerun's viewer and send everything to it."""
        self.stream.spawn(default_blueprint=self._blueprint())
        self._log()
        self.stream.flush()

    def _log(self) -> None:
        rr, stream = self.rr, self.stream
        colors = ColorScale("amplitude of the displacement over its largest value [-]", 1.0, 1.0, MODE_STOPS)
        stream.log("body", rr.ViewCoordinates.RIGHT_HAND_Z_UP, static=True)
        stream.log("legend", rr.Image(legend_picture([colors]), opacity=BLENDED), static=True)
        normals = vertex_normals(self.skin.points, self.skin.triangles).astype(np.float32)
        triangles = np.array(self.skin.triangles, dtype=np.uint32)
        mesh = rr.Mesh3D.from_fields(triangle_indices=triangles, vertex_normals=normals)
        stream.log("body/skin", mesh, static=True)
        stream.log("body/eye", rr.Transform3D(scale=self.skin.size), static=True)
        reach = self.scale * self.skin.size
        for m, (label, shape) in enumerate(zip(self.labels, self.shapes, strict=True)):
            packed = colors.packed(np.linalg.norm(shape, axis=1))
            for f in range(self.frames):
                # the cycle's last frame would repeat its first one
                stream.set_time("time", duration=CYCLE_SECONDS * (m + f / self.frames))
                if f == 0:
                    stream.log("about", rr.TextDocument(self._about(label), media_type=rr.MediaType.MARKDOWN))
                    stream.log("body/skin", rr.Mesh3D.from_fields(vertex_colors=packed))
                moved = self.skin.points + reach * np.sin(2.0 * np.pi * f / self.frames) * shape
                stream.log("body/skin", rr.Mesh3D.from_fields(vertex_positions=moved.astype(np.float32)))

    def _about(self, label: str) -> str:
        return (
            f"# {label}\n\n{self.name}: the largest displacement is drawn as {self.scale:.3g} of the largest extent, "
            f"{self.skin.size:.4g} m; a cycle takes {CYCLE_SECONDS:g} s on the screen.\n"
        )

    def _blueprint(self) -> Any:
        import rerun.blueprint as rrb

        _, up, eye = eye_axes(self.skin.points)
        low, high = self.skin.points.min(axis=0), self.skin.points.max(axis=0)
        middle = 0.5 * (low + high) / self.skin.size
        view = rrb.Spatial3DView(
            origin="/body/eye",  # scaled: the viewer draws nothing that is within centimetres of the eye
            contents="/body/**",
            name=self.labels[0] if len(self.labels) == 1 else f"{self.labels[0]} to {self.labels[-1]}",
            eye_controls=rrb.EyeControls3D(position=middle + EYE_DISTANCE * eye, look_target=middle, eye_up=tuple(up)),
            line_grid=False,
        )
        legend = rrb.Spatial2DView(origin="/legend", name="Colours")
        about = rrb.TextDocumentView(origin="/about", name="Mode")
        return rrb.Blueprint(
            rrb.Horizontal(view, rrb.Vertical(about, legend, row_shares=[2, 1]), column_shares=[3, 1]),
            rrb.BlueprintPanel(state="collapsed"),
            rrb.SelectionPanel(state="collapsed"),
            rrb.TimePanel(state="collapsed", timeline="time", loop_mode="all"),
            auto_views=False,
            auto_layout=False,
        )
