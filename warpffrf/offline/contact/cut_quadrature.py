r"""Quadrature over facets that are cut by the lines of a contact grid.

The functions of a contact grid have kinks (hats) or jumps (cells) at its lines, which run anywhere through the facets
of an unstructured mesh. Facets are split into triangles of their reference domain, and each triangle is cut along the
lines that cross it, as they run through the triangle if theta and z are taken as linear in it. That is exact where they
are (triangles with straight edges, quadrilaterals that are parallelograms in the chart), and no piece then holds a
kink: a Gauss rule on each is exact for polynomials. Other facets are split until a line is off by at most `BEND` of a
spacing. The pieces fill every facet whatever they are, so that areas and loads are complete in any case.
"""

from __future__ import annotations

import numpy as np

from warpffrf.model.mesh.elements import facet_kind
from warpffrf.offline.fe.reference import rule

Array = np.ndarray
# Degree of the rule on a piece: 4 of node function times hat, the rest for the turning normal (1e-9 over 20 degrees).
# On facets split in three and more the pieces are small, and the bend limits what is gained.
DEGREE, DEGREE_OF_SMALL, SMALL_PIECES = 8, 5, 3
TOUCHES = 1e-9  # of the distance between lines: a line this close to a vertex does not cut
# Distance of a cut from its true line, in spacings of the lines: that much of the area of a cell, and less of that of a
# hat, which vanishes at its outer lines, is counted with its neighbour.
BEND = 2e-3
MOST_PIECES = 4  # along an edge of a facet; a mesh that would need more is distorted beyond use


def cut_points(kind: str, x: Array, z: Array, columns: tuple[int, int], rows: Array) -> tuple[Array, ...]:
    """Facet number (p,), reference point (p, 2) and reference weight (p,) of a rule without kinks in its pieces, and
    the numbers (p,) of the column and of the row of lines below the piece that each point belongs to.

    `x`, `z` (m, k): chart coordinates of the facets' nodes, x counted in columns of the grid, whose lines are all
    integers from `columns[0]` to `columns[1]`; `rows`: the ascending lines of z.
    """
    pieces = _pieces(kind, x, z / np.min(np.diff(rows)))
    corners = _triangles(kind, pieces)  # (t, 3, 2) reference
    N, _ = facet_kind(kind).shape(corners.reshape(-1, 2))
    m, t = len(x), len(corners)
    facet = np.repeat(np.arange(m), t)
    place = np.tile(corners, (m, 1, 1))  # (m t, 3, 2)
    chart = np.stack([(v @ N.T).reshape(m * t, 3) for v in (x, z)], axis=2)
    lines = (np.arange(columns[0], columns[1] + 1, dtype=float), np.asarray(rows, dtype=float))
    for axis in (0, 1):
        facet, place, chart = _cut(facet, place, chart, axis, lines[axis])
    r = rule("tri3", DEGREE if pieces < SMALL_PIECES else DEGREE_OF_SMALL)
    points = np.einsum("qv,pvd->pqd", r.values, place)
    a, b = place[:, 1] - place[:, 0], place[:, 2] - place[:, 0]
    size = np.abs(a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0])
    middle = chart.mean(axis=1)
    column = np.floor(middle[:, 0]).astype(np.int64)
    row = np.clip(np.searchsorted(rows, middle[:, 1], side="right") - 1, 0, len(rows) - 2)
    facet, column, row = (np.repeat(v, len(r.weights)) for v in (facet, column, row))
    return facet, points.reshape(-1, 2), np.outer(size, r.weights).ravel(), column, row


def _pieces(kind: str, x: Array, z: Array) -> int:
    """Pieces along an edge of the facets with chart coordinates x, z (m, k) in spacings.

    A triangle's bend, the distance of the middle of its edges from straight, falls with the square of their number.
    """
    corners = _triangles(kind, 1)
    middles = 0.5 * (corners + np.roll(corners, 1, axis=1))
    shape = facet_kind(kind).shape
    at, between = (shape(v.reshape(-1, 2))[0].reshape(*v.shape[:2], -1) for v in (corners, middles))
    off = between - 0.5 * (at + np.roll(at, 1, axis=1))  # (t, 3, k)
    bend = max(float(np.abs(v @ off.reshape(-1, off.shape[2]).T).max(initial=0.0)) for v in (x, z))
    return int(np.clip(np.ceil(np.sqrt(bend / BEND)), 1, MOST_PIECES))


def _triangles(kind: str, n: int) -> Array:
    """Triangles (t, 3, 2) that fill the reference domain of a facet with n pieces along each edge."""
    if facet_kind(kind).domain == "quad":
        line = np.linspace(-1.0, 1.0, n + 1)
        low = np.array([(line[i], line[j]) for i in range(n) for j in range(n)])
        a, b, c, d = (low + np.array(step) * (2.0 / n) for step in ((0, 0), (1, 0), (1, 1), (0, 1)))
        return np.concatenate([np.stack([a, b, c], axis=1), np.stack([a, c, d], axis=1)])
    up = [((i, j), (i + 1, j), (i, j + 1)) for i in range(n) for j in range(n - i)]
    down = [((i + 1, j + 1), (i, j + 1), (i + 1, j)) for i in range(n) for j in range(n - 1 - i)]
    return np.array(up + down, dtype=float) / n


def _cut(facet: Array, place: Array, chart: Array, axis: int, lines: Array) -> tuple[Array, Array, Array]:
    """Cut triangles along `lines` of one chart coordinate; each pass halves the lines that cross a triangle."""
    slack = TOUCHES * np.min(np.diff(lines)) if len(lines) > 1 else 0.0
    done = []
    while len(facet):
        v = chart[:, :, axis]
        first = np.searchsorted(lines, v.min(axis=1) + slack, side="right")
        last = np.searchsorted(lines, v.max(axis=1) - slack, side="left")
        whole = last <= first
        done.append((facet[whole], place[whole], chart[whole]))
        facet, place, chart = facet[~whole], place[~whole], chart[~whole]
        at = lines[(first[~whole] + last[~whole]) // 2]
        order = np.argsort(chart[:, :, axis], axis=1)[:, :, None]
        both = np.take_along_axis(np.concatenate([place, chart], axis=2), order, axis=1)  # a <= b <= c, (n, 3, 4)
        a, b, c = both[:, 0], both[:, 1], both[:, 2]
        va, vb, vc = (both[:, i, 2 + axis] for i in range(3))
        above = (at >= vb)[:, None]
        # the vertex alone on its side, and the two others
        tip, one, two = np.where(above, c, a), np.where(above, a, b), np.where(above, b, c)
        vt, v1, v2 = (np.where(above[:, 0], *pair) for pair in ((vc, va), (va, vb), (vb, vc)))
        p = tip + (one - tip) * ((at - vt) / (v1 - vt))[:, None]
        q = tip + (two - tip) * ((at - vt) / (v2 - vt))[:, None]
        p[:, 2 + axis] = q[:, 2 + axis] = at
        split = np.concatenate([np.stack(t, axis=1) for t in ((tip, p, q), (p, one, two), (p, two, q))])
        facet = np.tile(facet, 3)
        place, chart = split[:, :, :2], split[:, :, 2:]
    return tuple(np.concatenate(parts) for parts in zip(*done, strict=True))  # type: ignore[return-value]
