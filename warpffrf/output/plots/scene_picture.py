"""The bodies of a run at a saved step as a picture drawn without screen or graphics card: a parallel projection,
shaded, coloured by one field, with colour bar and time.

Flexible bodies are drawn as deformed skins with magnified elastic displacement; rigid motion is not magnified. Rigid
bodies are drawn as their surfaces (`geometry.rigid_mesh`). Loads of contacts lie between bodies: where a field of a
contact is not zero, its colours are seen through the bodies in front. View, colours and magnification are the same for
all rows of a picture or an animation; a first pass determines them, so that only one row is in memory at a time.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from warpffrf.model.errors import MOST_COUNTED, InputError, require_number, unknown_name
from warpffrf.output.bodies.skin import CONTACT_FIELDS, DISPLACEMENT, ShownSkin, require_field
from warpffrf.output.geometry.places import Pose, grid_theta_offset
from warpffrf.output.geometry.reference import Reference
from warpffrf.output.geometry.rigid_mesh import rigid_meshes
from warpffrf.output.geometry.skin_nodes import automatic_factor
from warpffrf.output.plots.colors import ColorClasses, draw_bar, field_scale, instant, largest
from warpffrf.output.plots.modes import MAX_TRIANGLES, eye_axes
from warpffrf.output.plots.raster import lit, paint
from warpffrf.output.plots.restyle import THEMES, darken, require_theme

SIZE, DPI = (9.6, 7.2), 100  # inches, and dots per inch: 960 by 720 pixels, even as video encoders require
SCENE, BAR = (0.02, 0.13, 0.96, 0.80), (0.2, 0.055, 0.6, 0.025)  # axes, in fractions of the figure
TONES = np.array([[0.62, 0.66, 0.71], [0.76, 0.73, 0.66], [0.60, 0.68, 0.66], [0.69, 0.68, 0.69]])  # of rigid bodies
FEWEST_POINTS = 500  # per body if there are many
MARGIN = 0.04  # around the picture, of its size
VIEWS = {  # towards the viewer, and up
    "front": ((0.0, -1.0, 0.0), (0.0, 0.0, 1.0)),
    "side": ((1.0, 0.0, 0.0), (0.0, 0.0, 1.0)),
    "top": ((0.0, 0.0, 1.0), (0.0, 1.0, 0.0)),
    "iso": ((1.0, -1.0, 1.0), (0.0, 0.0, 1.0)),
}
PATCH = 10.0  # half widths of a patch that a close-up shows to either side
LUMPED = 0.25  # likewise of a lumped contact, of the extent of its smaller body

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

    factor: magnification of the elastic displacement `relative_to` a reference (`Reference`); None: chosen from 1, 2,
    5, 10, ..., 1 in a close-up. view: one of
    `VIEWS`, or the name of a contact or film for a close-up; None: that suits the extents. seen: called with the number
    of rows processed by the first pass. Raises InputError for a field that no body has, a factor that is not positive,
    an unknown view or theme, and a scene without anything to draw.
    """

    def __init__(
        self, result: Any, field: str, rows: np.ndarray, *, factor: float | None, what: str, view: str | None = None,
        relative_to: str | None = None, theme: str = "light", seen: Seen | None = None,
    ) -> None:  # fmt: skip
        require_theme(theme)
        if factor is not None:
            factor = require_number(factor, f"{what}: deformation_factor", positive=True)
        near = (*result.contact_names, *result.lumped_contact_names, *result.film_names)
        if view is not None and view not in (*VIEWS, *near):
            raise unknown_name(f"{what}: view", view, (*VIEWS, *near))
        skins = result.skins()
        require_field(skins, field, f"{what}: field")
        self.result, self.field, self.theme = result, field, theme
        self.near = view if view in near else None
        most = MOST_COUNTED if self.near else max(MAX_TRIANGLES // 2 // max(len(skins), 1), FEWEST_POINTS)
        self.reference = Reference(result.view.bodies, result.history.bodies, relative_to, what)
        self.skins = {name: ShownSkin(skin, most, self.reference) for name, skin in skins.items()}
        self.rigid = rigid_meshes(result)
        sizes = {name: (mesh.points.shape, float(f"{mesh.volume:.6g}")) for name, mesh in self.rigid.items()}
        alike = list(dict.fromkeys(sizes.values()))
        self.tones = {name: alike.index(size) for name, size in sizes.items()}  # bodies of one shape look alike
        if not self.skins and not self.rigid:
            raise InputError(f"{what}: the scene has no body to draw")
        self.rows = [int(i) for i in rows if self._is_finite(int(i))]
        if not self.rows:
            raise InputError(f"{what}: a value that is not finite stands in every row to draw")
        box = np.concatenate([_ends(np.concatenate(self._bodies(i))) for i in self.rows])
        self.axes = _view_axes(view, box)
        moved, tops, corners = 0.0, [0.0], []
        for done, i in enumerate(self.rows):
            if seen is not None:
                seen(done)
            places = []
            for name, shown in self.skins.items():
                u = shown.displacement(i)
                moved = max(moved, largest([np.linalg.norm(u, axis=1)]))
                tops.append(largest([self._values(shown, u, i)]))
                drawn = shown.points + shown.carried(i) + (factor or 1.0) * u  # a chosen factor stays within the margin
                places.append(self._pose(name, i).to_world(drawn))
            places += [self._pose(name, i).to_world(mesh.points) for name, mesh in self.rigid.items()]
            places = [self._close_up(i)] if self.near else places
            corners.append(_ends(np.concatenate(places) @ self.axes[:2].T))
        low, high = _ends(np.concatenate(corners))
        pad = MARGIN * float((high - low).max())
        self.low, self.high = low - pad, high + pad
        smallest = min((shown.size for shown in self.skins.values()), default=0.0)
        self.moved = moved > 0.0  # not of rigid bodies on half-spaces
        self.factor = factor or (1.0 if self.near else automatic_factor(moved, smallest))
        self.scale = field_scale(field, max(tops))

    def _pose(self, name: str, i: int) -> Pose:
        return Pose.of(self.result.history.bodies, name, i)

    def _bodies(self, i: int) -> list[np.ndarray]:
        """Points of the undeformed bodies in the world."""
        meshes = {**self.skins, **self.rigid}
        return [self._pose(name, i).to_world(mesh.points) for name, mesh in meshes.items()]

    def _close_up(self, i: int) -> np.ndarray:
        """Points (n, 3) [m] in the world that a close-up shows."""
        result, name = self.result, str(self.near)
        if name in result.small_sliding_names:
            view = result.view.small_sliding[name]
            return self._pose(view.first_body.name, i).to_world(view.points)
        if name in result.lumped_contact_names:
            view, place = result.view.lumped[name], result.history.lumped_contacts[name].place[i]
            meshes = {**self.skins, **self.rigid}
            sizes = [np.ptp(meshes[body.name].points, axis=0).max() for body in (view.first_body, view.second_body)]
            return _cube(place, LUMPED * min(sizes))
        if name in result.film_names:
            film = result.film(name)
            at = np.meshgrid(film.theta, film.z)
            return self._pose(film.view.first_body.name, i).to_world(film.view.first.shape.point(*at).reshape(-1, 3))
        contact = result.contact(name)
        surface, (theta, z) = contact.view.first, contact.patch_center[i]
        place = surface.shape.point(theta + grid_theta_offset(surface), z).reshape(1, 3)
        return _cube(
            self._pose(contact.view.first_body.name, i).to_world(place)[0], PATCH * largest([contact.half_width])
        )

    def _is_finite(self, i: int) -> bool:
        bodies = self.result.history.bodies
        arrays = [a[i] for m in bodies.values() for a in (m.position, m.rotation, m.modal)]
        return all(bool(np.isfinite(a).all()) for a in arrays)

    def _values(self, shown: ShownSkin, displacement: np.ndarray, i: int) -> np.ndarray:
        if self.field == DISPLACEMENT:
            return np.linalg.norm(displacement, axis=1)
        return shown.values(self.field, i)

    def _colors(self, values: np.ndarray) -> np.ndarray:
        return self.scale.rgb(values) / 255.0

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
        figure.set_facecolor("white")
        parts, loads = [], []
        for name, shown in self.skins.items():
            u = shown.displacement(i)
            points = self._pose(name, i).to_world(shown.points + shown.carried(i) + self.factor * u)
            values, classes = self._values(shown, u, i), isinstance(self.scale, ColorClasses)
            parts.append(lit(points, shown.triangles, self.axes, values, self._colors, nearest=classes))
            loaded = shown.triangles[np.any(values[shown.triangles] > 0.0, axis=1)]
            if self.field in CONTACT_FIELDS and len(loaded):
                loads.append(lit(points, loaded, self.axes, values, self._colors, nearest=classes))
        for name, mesh in self.rigid.items():
            pose, tone = self._pose(name, i), np.full(len(mesh.points), self.tones[name])
            points, normals = pose.to_world(mesh.points), pose.turned(mesh.normals)
            parts.append(lit(points, mesh.triangles, self.axes, tone, _tones, normals))
        top = getattr(self.scale, "top", 1.0)
        paint(figure.add_axes(SCENE), parts, self.low, self.high, loads, top)
        words = f"t = {instant(float(self.result.time[i]))}"
        if self.near:
            words += f", '{self.near}'"
        if self.moved:
            words += f", elastic displacement{self.reference.words} "
            words += "to scale" if self.factor == 1.0 else f"drawn {self.factor:g} times"
        if self.skins and (self.moved or self.field != DISPLACEMENT):
            draw_bar(figure.add_axes(BAR), self.scale)
        figure.text(0.5, 0.955, words, ha="center", va="center", fontsize=11)
        if self.theme != THEMES[0]:
            darken(figure)


def _tones(numbers: np.ndarray) -> np.ndarray:
    return TONES[np.round(numbers).astype(int) % len(TONES)]


def _view_axes(view: str | None, points: np.ndarray) -> np.ndarray:
    """Rows (3, 3): right, up, towards the viewer."""
    if view not in VIEWS:
        return eye_axes(points)
    eye, up = (np.array(v) / np.linalg.norm(v) for v in VIEWS[view])
    right = np.cross(up, eye)
    right /= np.linalg.norm(right)
    return np.stack([right, np.cross(eye, right), eye])


def _ends(points: np.ndarray) -> np.ndarray:
    """The smallest and the largest coordinates (2, k) of points (n, k)."""
    return np.stack([points.min(axis=0), points.max(axis=0)])


def _cube(middle: np.ndarray, half: float) -> np.ndarray:
    """Corners (8, 3) of the cube about `middle` (3,)."""
    return middle + half * np.array([[x, y, z] for x in (-1.0, 1.0) for y in (-1.0, 1.0) for z in (-1.0, 1.0)])
