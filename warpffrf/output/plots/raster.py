r"""Triangles in space as pixels: a parallel projection with a depth for every pixel, so that bodies that intersect or
reach around each other hide each other where they really do. Values are linear over each triangle, and then coloured.

A pixel belongs to the triangle nearest to the viewer that contains its centre; several samples per pixel of the picture
smooth the edges. Each line of pixels of a triangle is a range, as the weights of its corners are linear along it; whole
arrays of lines, and of `CHUNK` pixels, are processed at once.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

SAMPLES = 2  # per pixel, in either direction
CHUNK = 1_000_000  # pixels of triangles
VOID = (0.75, 0.77, 0.80)  # colour of transparent pixels, which edges are mixed with
LIGHT = (0.35, 0.55, 0.76)  # from the right, from above, from the eye
CLOSED = 1e-6  # of the area: the area vectors of a closed skin cancel to this
AMBIENT = 0.6  # brightness of a face that points away from the light
SEEN_THROUGH, VISIBLE = 0.85, 0.1  # largest opacity of a face behind others, from this share of its scale on
BEHIND = 1e-3  # of the depth of the picture
EDGE = 1e-9  # of a triangle: pixel centres on its edges belong to it

Colors = Callable[[np.ndarray], np.ndarray]  # values (n,) -> (n, 3) in 0 to 1


@dataclass(frozen=True, eq=False)
class Faces:
    """Triangles to draw: corners (t, 3, 3), right, up and towards the viewer, `values` (t, 3) and brightness (t, 3) at
    the corners, and the colours of values; nearest: values are those of the nearest corner, as of classes."""

    corners: np.ndarray
    values: np.ndarray
    brightness: np.ndarray
    colors: Colors
    nearest: bool = False


def lit(
    points: np.ndarray, triangles: np.ndarray, axes: np.ndarray, values: np.ndarray, colors: Colors,
    normals: np.ndarray | None = None, *, nearest: bool = False,
) -> Faces:  # fmt: skip
    """Triangles (t, 3) over `points` (n, 3), seen along `axes` (3, 3), right, up and towards the viewer, with `values`
    (n,) of `colors`, under a light; normals (n, 3): of a smooth surface at its points, None: of the facets."""
    corners = (points @ axes.T)[triangles]
    flat = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    near = facing(corners, flat)
    triangles, corners, flat = triangles[near], corners[near], flat[near]
    n = flat[:, None].repeat(3, axis=1) if normals is None else (normals @ axes.T)[triangles]
    length = np.linalg.norm(n, axis=2, keepdims=True)
    n = n / np.where(length > 0.0, length, 1.0)
    n = n * np.where(n[..., 2:] < 0.0, -1.0, 1.0)  # a face seen from behind is lit like its front
    brightness = AMBIENT + (1.0 - AMBIENT) * np.clip(n @ np.array(LIGHT), 0.0, 1.0)
    return Faces(corners, values[triangles], brightness, colors, nearest)


def facing(corners: np.ndarray, normals: np.ndarray) -> np.ndarray:
    """(t,) whether triangles with `corners` (t, 3, 3) and area vectors `normals` (t, 3) may be seen: those on the far
    side of a closed body are not."""
    if np.abs(normals.sum(axis=0)).max(initial=0.0) >= CLOSED * np.abs(normals).sum():
        return np.ones(len(normals), dtype=bool)
    inwards = np.einsum("ti,ti->", corners.mean(axis=1) - corners.mean(axis=(0, 1)), normals) < 0.0
    return normals[:, 2] < 0.0 if inwards else normals[:, 2] > 0.0


def paint(
    ax: Any, faces: Sequence[Faces], low: np.ndarray, high: np.ndarray, through: Sequence[Faces] = (), top: float = 1.0
) -> None:
    """Fill the matplotlib axes `ax` with the picture of `faces` between the corners `low` and `high` (2,), right and
    up; of `through`, with values up to `top`, also what is behind others."""
    size = np.array([ax.bbox.width, ax.bbox.height])
    middle, pitch = 0.5 * (low + high), float(np.max((high - low) / size))
    low, high = middle - 0.5 * pitch * size, middle + 0.5 * pitch * size
    shape = int(round(SAMPLES * size[0])), int(round(SAMPLES * size[1]))
    depth, _, rgb = colored(faces, low, high, shape)
    found = np.isfinite(depth)
    if through:
        at, values, over = colored(through, low, high, shape)
        seen = depth[found]
        behind = at < depth - BEHIND * (seen.max() - seen.min() if len(seen) else 0.0)
        share = SEEN_THROUGH * np.clip(values / (VISIBLE * top or 1.0), 0.0, 1.0)
        rgb += np.where(behind & np.isfinite(at), share, 0.0)[..., None] * (over - rgb)
    image = np.concatenate([np.clip(rgb, 0.0, 1.0), found[..., None]], axis=2)
    ax.imshow(image, extent=(low[0], high[0], low[1], high[1]), origin="lower")
    ax.set_axis_off()


def colored(
    faces: Sequence[Faces], low: np.ndarray, high: np.ndarray, shape: tuple[int, int]
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Depths, values (height, width) and colours (height, width, 3) of the nearest faces."""
    width, height = shape
    depth, face, weights = rasterized(np.concatenate([f.corners for f in faces]), low, high, shape)
    values, rgb, begin = np.zeros(len(face)), np.tile(VOID, (len(face), 1)), 0
    for part in faces:
        own = np.flatnonzero((face >= begin) & (face < begin + len(part.corners)))
        t, w = face[own] - begin, weights[own]
        if part.nearest:
            values[own] = part.values[t, w.argmax(axis=1)]
        else:
            values[own] = np.einsum("pc,pc->p", w, part.values[t])
        light = np.einsum("pc,pc->p", w, part.brightness[t])
        rgb[own] = part.colors(values[own]) * light[:, None]
        begin += len(part.corners)
    return depth.reshape(height, width), values.reshape(height, width), rgb.reshape(height, width, 3)


def rasterized(
    corners: np.ndarray, low: np.ndarray, high: np.ndarray, shape: tuple[int, int]
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """For each of the `shape` (width, height) pixels between `low` and `high`, from the lowest line up: depth towards
    the viewer, -inf of an empty one, the index of its triangle among `corners` (t, 3, 3), -1 of none, and the weights
    (pixels, 3) of the corners."""
    width, height = shape
    depth, face = np.full(height * width, -np.inf), np.full(height * width, -1)
    weights = np.zeros((height * width, 3))
    xy = (corners[..., :2] - low) * np.array([width, height]) / (high - low) - 0.5  # centres at whole numbers
    edge_1, edge_2 = xy[:, 1] - xy[:, 0], xy[:, 2] - xy[:, 0]
    area = edge_1[:, 0] * edge_2[:, 1] - edge_1[:, 1] * edge_2[:, 0]
    first = np.clip(np.ceil(xy[..., 1].min(axis=1)), 0.0, height).astype(int)
    last = np.clip(np.floor(xy[..., 1].max(axis=1)), -1.0, height - 1).astype(int)
    ids = np.flatnonzero((area != 0.0) & (last >= first))
    t, k = _expanded(last[ids] - first[ids] + 1)  # lines of pixels of each triangle
    t, y = ids[t], first[ids[t]] + k
    dy = y - xy[t, 0, 1]
    v_0, w_0 = -dy * edge_2[t, 0] / area[t], dy * edge_1[t, 0] / area[t]  # weights at the first corner's x
    v_x, w_x = edge_2[t, 1] / area[t], -edge_1[t, 1] / area[t]
    begin, end = -xy[t, 0, 0], width - 1.0 - xy[t, 0, 0]  # of each line, from the first corner
    for at, slope in ((v_0, v_x), (w_0, w_x), (1.0 - v_0 - w_0, -v_x - w_x)):
        with np.errstate(divide="ignore", invalid="ignore"):
            crossing = -(at + EDGE) / slope
        begin = np.where(slope > 0.0, np.maximum(begin, crossing), begin)
        end = np.where(slope < 0.0, np.minimum(end, crossing), end)
        end = np.where((slope == 0.0) & (at < -EDGE), -np.inf, end)
    from_x = np.ceil(begin + xy[t, 0, 0])
    count = np.maximum(np.floor(end + xy[t, 0, 0]) - from_x + 1.0, 0.0).astype(int)
    lines = np.flatnonzero(count)
    for part in np.split(lines, np.flatnonzero(np.diff(np.cumsum(count[lines]) // CHUNK)) + 1):
        of_line, k = _expanded(count[part])
        line = part[of_line]
        x = from_x[line].astype(int) + k
        dx, triangle = x - xy[t[line], 0, 0], t[line]
        v, w = v_0[line] + dx * v_x[line], w_0[line] + dx * w_x[line]
        of = np.stack([1.0 - v - w, v, w], axis=1)
        z = np.einsum("pc,pc->p", of, corners[triangle, :, 2])
        pixel = y[line] * width + x
        best = np.flatnonzero(z > depth[pixel])
        best = best[np.argsort(z[best], kind="stable")]  # of several writes to a pixel the last remains
        depth[pixel[best]], face[pixel[best]], weights[pixel[best]] = z[best], triangle[best], of[best]
    return depth, face, weights


def _expanded(counts: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """For `counts` (n,) of items: the index of the owner of each item, and its number there."""
    owner = np.repeat(np.arange(len(counts)), counts)
    return owner, np.arange(len(owner)) - np.repeat(np.cumsum(counts) - counts, counts)
