r"""A deformed skin as a flat, shaded picture: a parallel projection whose triangles are drawn from back to front.
Matplotlib's own 3-D axes sort and shade far more slowly and leave wide margins.

Mode shapes. Pictures of mode shapes: the deformed skins of bodies in colour over the undeformed ones in grey.

A mode of a scene is complex: its motion is Re(u exp(i w t)). It is drawn at the instant of the largest displacement of
the point with the largest amplitude, Re(u exp(-i arg u_max)). Displacements are scaled so that the largest is a given
fraction of the extent of the drawing; colours show amplitudes |u| over the largest. Rigid bodies are drawn as the
solids of a run (`rigid_mesh`).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from types import SimpleNamespace
from typing import Any

import numpy as np

from warpffrf.model import rotation as rot
from warpffrf.model.reduced.body import ReducedBody
from warpffrf.model.reduced.inertia import skin_displacement
from warpffrf.output.geometry.places import Pose
from warpffrf.output.geometry.rigid_mesh import meshes_in_state
from warpffrf.output.geometry.scene_view import scene_view
from warpffrf.output.geometry.skin_nodes import thinned
from warpffrf.output.plots.colors import ColorScale
from warpffrf.output.plots.raster import LIGHT, facing

MAX_TRIANGLES = 20_000  # per picture: more would be smaller than a few pixels
# View direction: mainly along the shortest extent of a body, so that discs show their face, oblique to the other two;
# components of the unit direction along the longest, middle and shortest extent
EYE_SHARES = (0.35, 0.5, 0.8)
# from rest to the largest displacement; bright colours, because they are shaded
MODE_STOPS = ("#d9e2ea", "#7cc6dd", "#8fd694", "#f7d65a", "#e8563f")
AMBIENT = 0.7  # brightness of a face that points away from the light
MARGIN = 0.04  # around the picture, of its size


@dataclass(frozen=True, eq=False)
class ModeSkin:
    """The skin of a body, thinned for pictures: points (n, 3) [m], triangles (t, 3), indices (n,) of the points in the
    body's skin, and the largest extent of the whole body [m]."""

    points: np.ndarray
    triangles: np.ndarray
    kept: np.ndarray
    size: float

    def shape(self, body: ReducedBody, mode: int) -> np.ndarray:
        """Displacement (n, 3) of elastic mode `mode` (0 the first), scaled to a largest length of 1."""
        u = np.asarray(body.surface.modes[mode][self.kept], dtype=float)
        top = float(np.linalg.norm(u, axis=1).max(initial=0.0))
        return u / top if top > 0.0 else u


def mode_skin(body: ReducedBody, max_points: int | None = None) -> ModeSkin:
    """The skin of `body` with at most `max_points` points; None: with at most about `MAX_TRIANGLES` triangles."""
    surface = body.surface
    if max_points is None:  # a closed surface has two triangles per point
        max_points = MAX_TRIANGLES // 2 if len(surface.triangles) > MAX_TRIANGLES else max(len(surface.points), 1)
    sectors = max((s.recovery.sectors for s in body.contact_surfaces.values()), default=1)
    kept, triangles = thinned(surface.points, surface.triangles, max_points, sectors)
    size = float(np.ptp(surface.points, axis=0).max()) if len(surface.points) else 0.0
    return ModeSkin(surface.points[kept], triangles, kept, size)


def eye_axes(points: np.ndarray) -> np.ndarray:
    """Rows (3, 3): right, up, towards the viewer, for a view that suits the extents of `points` (n, 3)."""
    extents = np.ptp(points, axis=0)
    order = np.argsort(-np.round(extents / max(extents.max(), np.finfo(float).tiny), 3), kind="stable")
    eye = np.zeros(3)
    eye[order] = EYE_SHARES
    eye /= np.linalg.norm(eye)
    up = np.eye(3)[1]
    if order[2] != 2:  # z is up and y points away from the viewer; a body that is flat in z is seen with y up
        up, eye[1] = np.eye(3)[2], -eye[1]
    right = np.cross(up, eye)
    right /= np.linalg.norm(right)
    return np.stack([right, np.cross(eye, right), eye])


@dataclass(frozen=True, eq=False)
class Faces:
    """Triangles as painted: corners (t, 3, 3), right, up and towards the viewer, and colours (t, 3) in 0 to 1."""

    corners: np.ndarray
    colors: np.ndarray


def shaded(points: np.ndarray, triangles: np.ndarray, axes: np.ndarray, colors: np.ndarray) -> Faces:
    """The visible faces of triangles (t, 3) over `points` (n, 3) along `axes` (3, 3), with `colors` (n, 3) in 0 to 1 of
    the points."""
    corners = (points @ axes.T)[triangles]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    near = facing(corners, normals)
    triangles, corners, normals = triangles[near], corners[near], normals[near]
    length = np.linalg.norm(normals, axis=1, keepdims=True)
    normals /= np.where(length > 0.0, length, 1.0)
    normals *= np.where(normals[:, 2:] < 0.0, -1.0, 1.0)  # a face seen from behind is lit like its front
    light = AMBIENT + (1.0 - AMBIENT) * np.clip(normals @ np.array(LIGHT), 0.0, 1.0)
    return Faces(corners, colors[triangles].mean(axis=1) * light[:, None])


def paint(ax: Any, parts: list[Faces], axes: np.ndarray, box: np.ndarray, *, alpha: float = 1.0) -> None:
    """Paint `parts` on `ax` from back to front, seen along `axes` (3, 3); `alpha`: opacity of the faces. `box` (k, 3):
    points that must lie inside the picture."""
    from matplotlib.collections import PolyCollection

    corners, colors = np.concatenate([p.corners for p in parts]), np.concatenate([p.colors for p in parts])
    order = np.argsort(corners[:, :, 2].mean(axis=1))
    ax.add_collection(
        PolyCollection(
            list(corners[order][:, :, :2]),
            facecolors=colors[order],
            edgecolors=colors[order] if alpha == 1.0 else "none",  # closes the hairlines between neighbours
            linewidths=0.3,
            alpha=alpha,
            rasterized=True,
        )
    )
    frame = box @ axes.T
    low, high = frame.min(axis=0), frame.max(axis=0)
    pad = MARGIN * float((high - low).max())
    ax.set(xlim=(low[0] - pad, high[0] + pad), ylim=(low[1] - pad, high[1] + pad), aspect="equal")
    ax.set_axis_off()


def draw_skin(
    ax: Any,
    points: np.ndarray,
    triangles: np.ndarray,
    axes: np.ndarray,
    colors: np.ndarray,
    box: np.ndarray,
    *,
    alpha: float = 1.0,
) -> None:
    """Draw one skin on `ax`, as `shaded` and `paint` do."""
    paint(ax, [shaded(points, triangles, axes, colors)], axes, box, alpha=alpha)


DRAWN = 0.06  # largest displacement drawn, of the largest extent
GREY, THROUGH = (0.62, 0.65, 0.69), 0.35  # of the undeformed skin
COLUMNS, PANEL = 4, (3.6, 3.1)  # of a page of shapes; inches
CORNERS = np.array([[i, j, k] for i in (-0.5, 0.5) for j in (-0.5, 0.5) for k in (-0.5, 0.5)])


@dataclass(frozen=True, eq=False)
class MovedSkin:
    """A skin, undeformed: points (n, 3) [m], triangles (t, 3), and the displacements (n, 3) of a mode, real or complex,
    all in one frame."""

    points: np.ndarray
    triangles: np.ndarray
    displacement: np.ndarray
    name: str = ""  # of the body


def skins_of(modes: Any, i: int) -> list[MovedSkin]:
    """Mode `i` of `Modes` of a scene: skins of the flexible bodies in the reference state of the modes, and solids of
    the rigid ones, world axes."""
    found = []
    flexible = [body for body in modes.scene.bodies if body.reduced is not None and len(body.reduced.surface.triangles)]
    for body in flexible:
        skin = mode_skin(body.reduced, MAX_TRIANGLES // 2 // len(flexible))
        A, origin = rot.matrix(modes.found.rotation[body.name]), modes.found.position[body.name]
        still = skin.points + skin_displacement(body, modes.found.modal[body.name])[skin.kept]
        found.append(
            MovedSkin(origin + still @ A.T, skin.triangles, modes.displacement(i, body.name)[skin.kept], body.name)
        )
    poses = {name: Pose(modes.found.position[name], modes.found.rotation[name]) for name in modes.found.position}
    state = {name: SimpleNamespace(position=[pose.position], rotation=[pose.rotation]) for name, pose in poses.items()}
    for name, mesh in meshes_in_state(scene_view(modes.scene), state).items():
        shape, arms = modes.shape(i, name), poses[name].turned(mesh.points)
        moved = shape.translation + np.cross(shape.rotation, arms)
        found.append(MovedSkin(poses[name].position + arms, mesh.triangles, moved, name))
    return found


def draw_shape(ax: Any, skins: Sequence[MovedSkin], title: str, *, drawn: float = DRAWN) -> None:
    """Draw a mode on the matplotlib axes `ax`; drawn: its largest displacement, as a fraction of the largest extent."""
    skins = [outward(skin) for skin in skins]
    first = np.cumsum([0, *(len(skin.points) for skin in skins)])
    points = np.concatenate([skin.points for skin in skins])
    triangles = np.concatenate([skin.triangles + n for skin, n in zip(skins, first[:-1], strict=True)])
    u = np.concatenate([np.asarray(skin.displacement, dtype=complex) for skin in skins])
    size = np.linalg.norm(u, axis=1)
    top = float(size.max(initial=0.0))
    if top > 0.0:
        at = u[int(np.argmax(size))]
        u, size = u * (np.exp(-1j * np.angle(at[np.argmax(np.abs(at))])) / top), size / top
    reach = drawn * float(np.ptp(points, axis=0).max())
    low, high = points.min(axis=0) - reach, points.max(axis=0) + reach
    box, axes = low + (CORNERS + 0.5) * (high - low), eye_axes(points)
    grey = np.tile(GREY, (len(points), 1))
    draw_skin(ax, points, triangles, axes, grey, box, alpha=THROUGH)
    colors = ColorScale("", 1.0, 1.0, MODE_STOPS).rgb(size) / 255.0
    draw_skin(ax, points + reach * np.real(u), triangles, axes, colors, box)
    ax.set_title(title, fontsize=10)


def outward(skin: MovedSkin) -> MovedSkin:
    """The skin with triangles oriented so that the normals of a closed one point outwards, by the sign of its
    volume."""
    corners = skin.points[skin.triangles] - skin.points.mean(axis=0)
    volume = np.einsum("ti,ti->", corners[:, 0], np.cross(corners[:, 1], corners[:, 2]))
    return skin if volume >= 0.0 else replace(skin, triangles=skin.triangles[:, ::-1])


def shapes_figure(modes: Sequence[tuple[str, Sequence[MovedSkin]]], title: str, *, drawn: float = DRAWN) -> Any:
    """A matplotlib Figure with a picture of each of `modes`, given as title and skins."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    columns = min(COLUMNS, len(modes))
    rows = -(-len(modes) // columns)
    figure = Figure(figsize=(PANEL[0] * columns, PANEL[1] * rows + 0.4), layout="constrained")
    FigureCanvasAgg(figure)
    for n, (name, skins) in enumerate(modes):
        draw_shape(figure.add_subplot(rows, columns, n + 1), skins, name, drawn=drawn)
    figure.suptitle(title, fontsize=11)
    return figure
