"""A deformed skin as a flat, shaded picture: a parallel projection whose triangles are drawn from the back to the
front. Matplotlib's own 3-D axes sort and shade far more slowly and leave wide margins."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from warpffrf.model.reduced.body import ReducedBody
from warpffrf.output.geometry.thinning import thinned

MAX_TRIANGLES = 20_000  # of a picture: smaller ones than a few pixels are wasted
# The eye looks along the shortest extent of a body most of all, so that discs show their face, and sees the other two
# aslant; shares of the unit direction along the longest, middle and shortest extent
EYE_SHARES = (0.35, 0.5, 0.8)
# from rest to the largest displacement; bright colours, because they are shaded
MODE_STOPS = ("#d9e2ea", "#7cc6dd", "#8fd694", "#f7d65a", "#e8563f")
LIGHT = (0.35, 0.55, 0.76)  # from the right, from above, from the eye
AMBIENT = 0.7  # brightness of a face turned away from the light
CLOSED = 1e-6  # of the area: the area vectors of a closed skin cancel to this
MARGIN = 0.04  # around the picture, of its size


@dataclass(frozen=True, eq=False)
class ModeSkin:
    """The skin of a body, thinned to what a picture needs: points (n, 3) [m], triangles (t, 3), which points of the
    body's skin they are (n,), and the largest extent of the whole body [m]."""

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
    if max_points is None:  # a closed surface has two triangles a point
        max_points = MAX_TRIANGLES // 2 if len(surface.triangles) > MAX_TRIANGLES else max(len(surface.points), 1)
    sectors = max((s.recovery.sectors for s in body.contact_surfaces.values()), default=1)
    kept, triangles = thinned(surface.points, surface.triangles, max_points, sectors)
    size = float(np.ptp(surface.points, axis=0).max()) if len(surface.points) else 0.0
    return ModeSkin(surface.points[kept], triangles, kept, size)


def eye_axes(points: np.ndarray) -> np.ndarray:
    """Rows (3, 3): to the right, upwards, towards the eye, for a view that suits the extents of `points` (n, 3)."""
    extents = np.ptp(points, axis=0)
    order = np.argsort(-np.round(extents / max(extents.max(), np.finfo(float).tiny), 3), kind="stable")
    eye = np.zeros(3)
    eye[order] = EYE_SHARES
    eye /= np.linalg.norm(eye)
    up = np.eye(3)[1]
    if order[2] != 2:  # z is upwards, and y away from the eye; a body that is flat in z is seen with y upwards
        up, eye[1] = np.eye(3)[2], -eye[1]
    right = np.cross(up, eye)
    right /= np.linalg.norm(right)
    return np.stack([right, np.cross(eye, right), eye])


@dataclass(frozen=True, eq=False)
class Faces:
    """Triangles as they are painted: corners (t, 3, 3), to the right, upwards and towards the eye, and colours (t, 3)
    in 0 to 1."""

    corners: np.ndarray
    colors: np.ndarray


def shaded(points: np.ndarray, triangles: np.ndarray, axes: np.ndarray, colors: np.ndarray) -> Faces:
    """What is seen of triangles (t, 3) over `points` (n, 3) along `axes` (3, 3), with `colors` (n, 3) in 0 to 1 of the
    points."""
    corners = (points @ axes.T)[triangles]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    area = np.abs(normals).sum()
    if np.abs(normals.sum(axis=0)).max() < CLOSED * area:  # faces on the far side of a closed body cannot be seen
        inwards = np.einsum("ti,ti->", corners.mean(axis=1) - corners.mean(axis=(0, 1)), normals) < 0.0
        near = normals[:, 2] < 0.0 if inwards else normals[:, 2] > 0.0
        triangles, corners, normals = triangles[near], corners[near], normals[near]
    length = np.linalg.norm(normals, axis=1, keepdims=True)
    normals /= np.where(length > 0.0, length, 1.0)
    normals *= np.where(normals[:, 2:] < 0.0, -1.0, 1.0)  # a face seen from behind is lit as if turned round
    light = AMBIENT + (1.0 - AMBIENT) * np.clip(normals @ np.array(LIGHT), 0.0, 1.0)
    return Faces(corners, colors[triangles].mean(axis=1) * light[:, None])


def paint(ax: Any, parts: list[Faces], axes: np.ndarray, box: np.ndarray, *, alpha: float = 1.0) -> None:
    """Paint `parts` on `ax` from the back to the front, seen along `axes` (3, 3); `alpha` of what is behind a face is
    covered. `box` (k, 3): points that shall lie inside the picture."""
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
