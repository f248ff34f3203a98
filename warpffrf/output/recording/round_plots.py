"""Pictures of rotors in a recording: polar load zones of bearings, and orbits of shafts.

Both are drawn with lines in planes of their own, seen along the axis: a load zone as the machine is seen, with the
axis from or towards the eye, an orbit in the directions of the part that carries the shaft. Lines and labels take
colours that are visible on black and on white.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from warpffrf.output.plots.colors import INK_RGB, largest
from warpffrf.output.recording.extent import seen_along
from warpffrf.output.recording.glyphs import force_text

CIRCLE = np.stack([np.cos(a := np.linspace(0.0, 2.0 * np.pi, 121)), -np.sin(a)], axis=1)
TRACE_COLOR, POINT_COLOR = (67, 162, 202), (230, 57, 70)
BEYOND = 1.2  # of the path that axes extend
LEAST_ORBIT = 1e-9  # of the pitch diameter: below is round-off
THICK, THIN = 3.0, 1.0  # points of the screen: radii of lines
AROUND = 1.15  # of what is drawn, that a view shows


def round_view(origin: str, title: str, reach: float) -> Any:
    """A view of everything within `reach` of the middle."""
    import rerun.blueprint as rrb

    ends = -AROUND * reach, AROUND * reach
    return rrb.Spatial2DView(origin=origin, name=title, visual_bounds=rrb.VisualBounds2D(x_range=ends, y_range=ends))


class LoadZone:
    """The loads of the elements of one bearing over their positions, on the raceway of the outer ring."""

    def __init__(self, recorder: Any, name: str) -> None:
        self.recorder, self.name = recorder, name
        self.bearing = recorder.result.bearing(name)
        self.top = largest([self.bearing.outer_load[recorder.rows[recorder.good]]])
        self.right, self.up = seen_along(self.bearing.axes[0][2])
        self.title = f"Load zone of '{name}'"

    def path(self, *parts: str) -> str:
        """Entity below that of the picture."""
        return self.recorder.path("load_zones", self.name, *parts)

    def view(self) -> Any:
        """The whole circle."""
        return round_view(self.path(), self.title, 1.0)

    def static(self) -> None:
        """Log the circles and what they stand for."""
        rr, log = self.recorder.rr, self.recorder.log_static
        log(self.path("circles"), rr.LineStrips2D(
            [0.5 * CIRCLE, CIRCLE], colors=[INK_RGB], radii=rr.Radius.ui_points(0.5 * THIN)
        ))  # fmt: skip
        place = np.array([0.5, 1.0])[:, None] * np.array([np.cos(0.8), -np.sin(0.8)])
        labels = [force_text(0.5 * self.top), force_text(self.top)]
        log(self.path("values"), rr.Points2D(place, labels=labels, show_labels=True, colors=[INK_RGB],
                                             radii=rr.Radius.ui_points(THIN)))  # fmt: skip

    def frame(self, i: int) -> None:
        """Log a spoke for each element, its length the load on the outer ring, and the line through their ends, one of
        each row."""
        rr, bearing = self.recorder.rr, self.bearing
        load = np.nan_to_num(bearing.outer_load[i]) / (self.top or 1.0)
        at = np.stack([self.recorder.result.history.bodies[e].position[i] for e in bearing.elements])
        away = at - bearing.center[i]
        ends = np.stack([away @ self.right, -(away @ self.up)], axis=1)
        ends *= (load / np.maximum(np.linalg.norm(ends, axis=1), 1e-300))[:, None]
        colors = self.recorder.rigid.scale.rgb(bearing.outer_load[i])
        spokes = np.stack([np.zeros_like(ends), ends], axis=1)
        log = self.recorder.stream.log
        log(self.path("loads"), rr.LineStrips2D(spokes, colors=colors, radii=rr.Radius.ui_points(THICK)))
        rows = np.split(ends, len(bearing.geometry.tracks))
        outline = rr.LineStrips2D(
            [[*row, row[0]] for row in rows], colors=[TRACE_COLOR], radii=rr.Radius.ui_points(THIN)
        )
        log(self.path("zone"), outline)


@dataclass(frozen=True, eq=False)
class Orbit:
    """The path (T, 2) [m] of a shaft's centre, right and up; limit [m]: the clearance, 0 without one."""

    recorder: Any
    name: str
    path_: np.ndarray
    limit: float
    directions: tuple[str, str]

    @property
    def title(self) -> str:
        return f"Orbit in '{self.name}'" + ("" if self.limit else ", about its mean")

    def path(self, *parts: str) -> str:
        """Entity below that of the picture."""
        return self.recorder.path("orbits", self.name, *parts)

    @property
    def points(self) -> np.ndarray:
        """The path (n, 2) [µm], right and downwards."""
        return 1e6 * self.path_[np.all(np.isfinite(self.path_), axis=1)] * [1.0, -1.0]

    @property
    def reach(self) -> float:
        """Length of the axes [µm]."""
        return 1e6 * self.limit or float(f"{BEYOND * largest([np.abs(self.points)]):.2g}")

    def view(self) -> Any:
        """The whole path and the circle."""
        return round_view(self.path(), self.title, max(self.reach, largest([np.abs(self.points)])))

    def static(self) -> None:
        """Log the whole path, the circle of the clearance, and axes with their length."""
        rr, log, reach = self.recorder.rr, self.recorder.log_static, self.reach
        line, thin = rr.Radius.ui_points(THIN), rr.Radius.ui_points(0.5 * THIN)
        log(self.path("path"), rr.LineStrips2D([self.points], colors=[TRACE_COLOR], radii=line))
        cross = [[[-reach, 0.0], [reach, 0.0]], [[0.0, -reach], [0.0, reach]]]
        lines = [*cross, *([reach * CIRCLE] if self.limit else [])]
        log(self.path("axes"), rr.LineStrips2D(lines, colors=[INK_RGB], radii=thin))
        labels = [f"{reach:.3g} µm along {direction}" for direction in self.directions]
        at = [[reach, 0.0], [0.0, -reach]]
        log(self.path("values"), rr.Points2D(at, labels=labels, show_labels=True, colors=[INK_RGB], radii=line))

    def frame(self, i: int) -> None:
        """Log the shaft's place at saved row i."""
        rr = self.recorder.rr
        at = 1e6 * self.path_[i] * [1.0, -1.0]
        point = rr.Points2D([at], colors=[POINT_COLOR], radii=rr.Radius.ui_points(2.0 * THICK))
        self.recorder.stream.log(self.path("now"), point)


def orbits(recorder: Any) -> list[Orbit]:
    """Those of shafts in round films, and of the inner rings of bearings that move."""
    result, found = recorder.result, []
    for name, view in result.view.films.items():
        path = result.history.films[name].eccentricity
        if view.clearance and np.all(np.isfinite(path[recorder.rows[recorder.good]])):
            found.append(Orbit(recorder, name, path, view.clearance, ("e_0", "e_1")))
    for name in result.view.bearings:
        bearing = result.bearing(name)
        right, up = seen_along(bearing.axes[0][2])
        turn = bearing.axes[0][:2] @ np.stack([right, up], axis=1)
        words = _direction(right), _direction(up)
        path = bearing.displacement[:, :2] @ turn
        path = path - np.nanmean(path, axis=0)
        if largest([np.abs(path)]) > LEAST_ORBIT * bearing.geometry.pitch_diameter:
            found.append(Orbit(recorder, name, path, 0.0, words))
    return found


def _direction(vector: np.ndarray) -> str:
    """An axis of the world, or the components of a direction."""
    k = int(np.argmax(np.abs(vector)))
    if abs(vector[k]) > 1.0 - 1e-9:
        return f"{'-' if vector[k] < 0.0 else ''}{'xyz'[k]}"
    return "({:.2g}, {:.2g}, {:.2g})".format(*vector)
