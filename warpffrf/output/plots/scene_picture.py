"""The bodies of a run at a saved step as a picture drawn without screen or graphics card: a parallel projection,
shaded, coloured by one field, with colour bar and time.

Flexible bodies are drawn as deformed skins with magnified elastic displacement; rigid motion is not magnified. Rigid
bodies are drawn as their boxes of inertia if no body is flexible. View, colours and magnification are the same for all
rows of a picture or an animation; a first pass determines them, so that only one row is in memory at a time.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from warpffrf.model.errors import InputError, require_number
from warpffrf.output.bodies.skin import DISPLACEMENT, ShownSkin, require_field
from warpffrf.output.geometry.inertia_box import inertia_box
from warpffrf.output.geometry.places import rotate
from warpffrf.output.geometry.skin_nodes import automatic_factor
from warpffrf.output.plots.colors import draw_bar, field_scale, largest
from warpffrf.output.plots.modes import MAX_TRIANGLES, eye_axes, paint, shaded

SIZE, DPI = (9.6, 7.2), 100  # inches, and dots per inch: 960 by 720 pixels, even as video encoders require
SCENE, BAR = (0.02, 0.13, 0.96, 0.80), (0.2, 0.055, 0.6, 0.025)  # axes, in fractions of the figure
RIGID_COLOR = (0.62, 0.66, 0.71)
FEWEST_POINTS = 500  # per body if there are many

Seen = Callable[[int], None]


def row_at(result: Any, time: float | None, what: str) -> int:
    """The saved step nearest to `time` [s], the last one if None. Raises `InputError` naming `what` for a time outside
    of the run and a run without saved steps."""
    times = np.asarray(result.time)
    if not len(times):
        raise InputError(f"{what}: the run has no saved row to draw")
    if time is None:
        return len(times) - 1
    wanted = require_number(time, f"{what}: time")
    if not times[0] <= wanted <= times[-1]:
        raise InputError(f"{what}: time is {wanted:g} s; the run has {times[0]:g} to {times[-1]:g} s")
    return int(np.argmin(np.abs(times - wanted)))


class ScenePicture:
    """Draws the bodies of `result` at any of `rows`, coloured by `field` of `Skin.fields` or "displacement".

    factor: magnification of the elastic displacement; None: chosen from 1, 2, 5, 10, ... seen: called with the number
    of rows processed by the first pass. Raises InputError for a field that no body has, a factor that is not positive,
    and a scene without anything to draw.
    """

    def __init__(
        self, result: Any, field: str, rows: np.ndarray, *, factor: float | None, what: str, seen: Seen | None = None
    ) -> None:
        if factor is not None:
            factor = require_number(factor, f"{what}: deformation_factor", positive=True)
        skins = result.skins()
        require_field(skins, field, f"{what}: field")
        self.result, self.field = result, field
        most = max(MAX_TRIANGLES // 2 // max(len(skins), 1), FEWEST_POINTS)
        self.skins = {name: ShownSkin(skin, most) for name, skin in skins.items()}
        self.boxes = {} if skins else self._boxes()
        if not self.skins and not self.boxes:
            raise InputError(f"{what}: the scene has no body to draw")
        self.rows = [int(i) for i in rows if self._is_finite(int(i))]
        if not self.rows:
            raise InputError(f"{what}: a value that is not finite stands in every row to draw")
        moved, tops, corners = 0.0, [0.0], []
        for done, i in enumerate(self.rows):
            if seen is not None:
                seen(done)
            for shown in self.skins.values():
                u = shown.displacement(i)
                moved = max(moved, largest([np.linalg.norm(u, axis=1)]))
                tops.append(largest([self._values(shown, u, i)]))
            places = np.concatenate([self._world(name, points, i) for name, points in self._undeformed().items()])
            corners += [places.min(axis=0), places.max(axis=0)]
        low, high = np.min(corners, axis=0), np.max(corners, axis=0)
        self.box = np.stack(np.meshgrid(*np.stack([low, high], axis=1), indexing="ij"), axis=-1).reshape(-1, 3)
        self.axes = eye_axes(self.box)
        smallest = min((shown.size for shown in self.skins.values()), default=0.0)
        self.factor = automatic_factor(moved, smallest) if factor is None else factor
        self.scale = field_scale(field, max(tops))

    def _boxes(self) -> dict[str, tuple[np.ndarray, np.ndarray]]:
        return {name: inertia_box(body).mesh() for name, body in self.result.view.bodies.items()}

    def _undeformed(self) -> dict[str, np.ndarray]:
        shown = {name: skin.points for name, skin in self.skins.items()}
        return shown | {name: points for name, (points, _) in self.boxes.items()}

    def _is_finite(self, i: int) -> bool:
        bodies = self.result.history.bodies
        shown = [bodies[name] for name in (*self.skins, *self.boxes)]
        arrays = [a[i] for m in shown for a in (m.position, m.rotation, m.modal)]
        return all(bool(np.isfinite(a).all()) for a in arrays)

    def _world(self, name: str, points: np.ndarray, i: int) -> np.ndarray:
        motion = self.result.history.bodies[name]
        return np.asarray(motion.position[i]) + rotate(motion.rotation[i], points)

    def _values(self, shown: ShownSkin, displacement: np.ndarray, i: int) -> np.ndarray:
        if self.field == DISPLACEMENT:
            return np.linalg.norm(displacement, axis=1)
        return shown.values(self.field, i)

    def figure(self) -> Any:
        """An empty matplotlib Figure for `draw`."""
        from matplotlib.backends.backend_agg import FigureCanvasAgg
        from matplotlib.figure import Figure

        figure = Figure(figsize=SIZE, dpi=DPI)
        FigureCanvasAgg(figure)
        return figure

    def draw(self, figure: Any, i: int) -> None:
        """Draw saved step `i` on `figure`, in place of what is there."""
        figure.clear()
        parts = []
        for name, shown in self.skins.items():
            u = shown.displacement(i)
            colors = self.scale.rgb(self._values(shown, u, i)) / 255.0
            points = self._world(name, shown.points + self.factor * u, i)
            parts.append(shaded(points, shown.triangles, self.axes, colors))
        for name, (points, triangles) in self.boxes.items():
            colors = np.tile(RIGID_COLOR, (len(points), 1))
            parts.append(shaded(self._world(name, points, i), triangles, self.axes, colors))
        paint(figure.add_axes(SCENE), parts, self.axes, self.box)
        words = f"t = {1e3 * float(self.result.time[i]):.6g} ms"
        if self.skins:
            words += f", elastic displacement drawn {self.factor:g} times"
            draw_bar(figure.add_axes(BAR), self.scale)
        figure.text(0.5, 0.955, words, ha="center", va="center", fontsize=11)
