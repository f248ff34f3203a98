"""Convex polygons in the plane cut by one another (Sutherland and Hodgman 1974, Commun. ACM 17, 32), many at a time."""

from __future__ import annotations

import numpy as np

Array = np.ndarray


def clipped(polygons: Array, count: Array, windows: Array) -> tuple[Array, Array]:
    """The parts of convex polygons that lie inside convex windows, one window a polygon.

    `polygons` (p, k, 2), of which the first `count` (p,) corners count, and `windows` (p, l, 2), all corners, run
    counter-clockwise. Returns polygons (p, k', 2) and their count, 0 where nothing is left.
    """
    for edge in range(windows.shape[1]):
        a, b = windows[:, edge], windows[:, (edge + 1) % windows.shape[1]]
        polygons, count = _half(polygons, count, a, b)
    return polygons, count


def areas(polygons: Array, count: Array) -> Array:
    """Areas (p,) of polygons, counter-clockwise positive."""
    k = polygons.shape[1]
    there = np.arange(k) < count[:, None]
    x = np.where(there[:, :, None], polygons - polygons[:, :1], 0.0)
    following = np.take_along_axis(x, _next(k, count)[:, :, None], axis=1)
    twice = x[:, :, 0] * following[:, :, 1] - x[:, :, 1] * following[:, :, 0]
    return 0.5 * np.sum(np.where(there, twice, 0.0), axis=1)


def fans(polygons: Array, count: Array) -> tuple[Array, Array]:
    """Triangles (t, 3, d) that fill convex polygons (p, k, d), and the polygon (t,) of each."""
    k = polygons.shape[1]
    number, i = np.nonzero((np.arange(1, k - 1) + 1)[None, :] < count[:, None])
    i += 1
    return np.stack([polygons[number, 0], polygons[number, i], polygons[number, i + 1]], axis=1), number


def _half(polygons: Array, count: Array, a: Array, b: Array) -> tuple[Array, Array]:
    """What lies to the left of the line from a to b (p, 2)."""
    p, k = polygons.shape[:2]
    there = np.arange(k) < count[:, None]
    along = b - a
    x = polygons - a[:, None]
    side = along[:, None, 0] * x[:, :, 1] - along[:, None, 1] * x[:, :, 0]  # positive to the left
    following = _next(k, count)
    next_side = np.take_along_axis(side, following, axis=1)
    next_corner = np.take_along_axis(polygons, following[:, :, None], axis=1)
    inside = there & (side >= 0.0)
    crosses = there & ((side >= 0.0) != (next_side >= 0.0))
    share = np.where(crosses, side / np.where(crosses, side - next_side, 1.0), 0.0)
    crossing = polygons + share[:, :, None] * (next_corner - polygons)
    # each corner, then the crossing behind it, as far as they are kept
    kept = np.stack([inside, crosses], axis=2).reshape(p, 2 * k)
    corners = np.stack([polygons, crossing], axis=2).reshape(p, 2 * k, 2)
    remaining = kept.sum(axis=1)  # k + 1 at most, but for edges that coincide: round-off can cross those more often
    order = np.argsort(~kept, axis=1, kind="stable")[:, : max(remaining.max(initial=0), 1)]
    return np.take_along_axis(corners, order[:, :, None], axis=1), remaining


def _next(k: int, count: Array) -> Array:
    """Number (p, k) of the corner behind each, that behind the last being the first."""
    following = np.arange(1, k + 1)[None, :]
    return np.where(following < count[:, None], following, 0)
