"""Frames of a run while it is stepped, sent to a rerun stream: `Simulation.stream_to`.

Entities are those of a recording (`recorder`): `/world/<body>` with the rigid motion, `surface` and `solid` below it,
and `/plots/outputs/<name>`. What a recording scales over the whole run, relief of patches and arrows of forces, is left
out, because the run is not known. The colours cover twice the largest displacement when the range was chosen, and the
range is chosen anew when that is exceeded.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from warpffrf.model.errors import InputError, require_number
from warpffrf.output.bodies.skin import DISPLACEMENT
from warpffrf.output.geometry.reference import Reference
from warpffrf.output.plots.colors import displacement_scale, legend_picture
from warpffrf.output.recording import frames as fr
from warpffrf.output.recording.layout import live_blueprint
from warpffrf.output.recording.recorder import MAX_POINTS, Recorder, row_is_finite
from warpffrf.output.result import Result

MARGIN = 2.0  # of the range of colours over the largest displacement when it is chosen


class Live:
    """Frames of a run in `stream`, a `rerun.RecordingStream` of the caller. result: one row, the present; labels: of
    the outputs by name. Raises `InputError`."""

    def __init__(self, stream: Any, result: Result, labels: Mapping[str, list[str]], deformation_factor: float) -> None:
        import rerun as rr

        if not isinstance(stream, rr.RecordingStream):
            raise InputError(f"stream_to: stream must be a rerun.RecordingStream, got {stream!r}")
        factor = require_number(deformation_factor, "stream_to: deformation_factor", positive=True)
        self.rr, self.stream, self.labels = rr, stream, labels
        only, reference = (
            np.zeros(1, dtype=int),
            Reference(result.view.bodies, result.history.bodies, None, "stream_to"),
        )
        skins = result.skins()
        bodies = fr.body_frames(skins, only, MAX_POINTS, DISPLACEMENT, reference)
        self.recorder = Recorder(
            result, skins, bodies, only, np.ones(1, dtype=bool), 1, factor, DISPLACEMENT, reference, stream
        )
        self.recorder.moves, self.recorder.rigid.top = bool(bodies), 0.0
        self._range = 0.0  # m, of the colours
        self.stream.send_blueprint(live_blueprint(self.recorder, list(labels)))
        self.recorder.log_geometry()
        for name, lines in labels.items():
            self.recorder.log_static(self._plot(name), rr.SeriesLines(names=lines))

    def _plot(self, name: str) -> str:
        return self.recorder.path("plots", "outputs", name)

    def frame(self, result: Result, outputs: Mapping[str, Any]) -> bool:
        """Send the present, the one row of `result`; whether all of it is finite, otherwise nothing is sent."""
        recorder = self.recorder
        recorder.result = result
        for name, skin in result.skins().items():
            body = recorder.bodies[name]
            body.displacement = skin.displacement(0)[body.kept][None].astype(np.float32)
        values = {name: np.ravel(np.asarray(outputs[name], dtype=float)) for name in self.labels}
        if not row_is_finite(result, recorder.bodies, 0, 0) or not all(np.all(np.isfinite(v)) for v in values.values()):
            return False
        self.stream.set_time("time", duration=float(result.time[0]))
        self._choose_colors()
        recorder.log_bodies(0, 0)
        for name, value in values.items():
            self.stream.log(self._plot(name), self.rr.Scalars(value.copy()))
        return True

    def _choose_colors(self) -> None:
        shown = [np.linalg.norm(b.displacement[0], axis=1).max() for b in self.recorder.bodies.values()]
        top = float(max(shown, default=0.0))
        if top > self._range:
            self._range = MARGIN * top
            self.recorder.skin_scale = scale = displacement_scale(self._range)
            self.stream.log("legend", self.rr.Image(legend_picture([scale]), opacity=fr.BLENDED))
