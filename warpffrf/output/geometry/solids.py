"""Closed triangle meshes of simple solids: bodies of revolution, plates and rods.

A body of revolution is given by its meridian, a closed line of smooth pieces (r, z), or a line from axis to axis.
Neighbouring pieces have vertices of their own at their common edge, so that normals of vertices show the edge; the
positions there coincide, and the mesh is watertight. Vertices lie on the true surface, facets within it.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from warpffrf.output.geometry.skin_nodes import vertex_normals

AROUND = 96  # facets around an axis
NEAR = 1e-9  # of the largest radius: vertices closer to the axis lie on it, pieces that are shorter are left out
SIDES = np.array([[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]])  # from outside
CORNERS = np.array([[x, y, z] for x in (-1.0, 1.0) for y in (-1.0, 1.0) for z in (-1.0, 1.0)])

Piece = tuple[Any, Any]  # r (k,) and z (k,) [m] of a smooth piece of a meridian


@dataclass(frozen=True, eq=False)
class TriangleMesh:
    """points (n, 3) [m] and triangles (t, 3), counter-clockwise as seen from outside."""

    points: np.ndarray
    triangles: np.ndarray

    @property
    def normals(self) -> np.ndarray:
        """(n, 3), outwards."""
        return vertex_normals(self.points, self.triangles)

    @property
    def volume(self) -> float:
        """Enclosed volume [m3]."""
        a, b, c = np.moveaxis(self.points[self.triangles], 1, 0)
        return float(np.einsum("ti,ti->", a, np.cross(b, c)) / 6.0)

    @classmethod
    def of(cls, parts: list[TriangleMesh]) -> TriangleMesh:
        """All parts as one mesh; they may overlap."""
        first = np.cumsum([0, *(len(part.points) for part in parts)])
        triangles = [part.triangles + n for part, n in zip(parts, first[:-1], strict=True)]
        return cls(np.concatenate([part.points for part in parts]), np.concatenate(triangles))


def revolved(origin: Any, frame: Any, pieces: list[Piece], around: int = AROUND) -> TriangleMesh:
    """The body of revolution about the axis through `origin` (3,) [m] along the third row of `frame` (3, 3), from the
    pieces of its meridian in order, each beginning where the one before ends."""
    angle = 2.0 * np.pi * np.arange(around) / around
    directions = np.stack([np.cos(angle), np.sin(angle)], axis=1) @ np.asarray(frame)[:2]
    largest = max(float(np.max(r)) for r, _ in pieces)
    parts = []
    for r, z in pieces:
        r, z = np.asarray(r, dtype=float), np.asarray(z, dtype=float)
        if max(np.ptp(r), np.ptp(z)) <= NEAR * largest:
            continue
        r = np.where(r > NEAR * largest, r, 0.0)
        points = origin + r[None, :, None] * directions[:, None] + z[None, :, None] * np.asarray(frame)[2]
        parts.append(TriangleMesh(points.reshape(-1, 3), _around(around, r)))
    mesh = TriangleMesh.of([part for part in parts if len(part.triangles)])
    return mesh if mesh.volume > 0.0 else TriangleMesh(mesh.points, mesh.triangles[:, ::-1])


def _around(around: int, r: np.ndarray) -> np.ndarray:
    """Triangles of a piece: two for each field, one where the field ends on the axis."""
    j, k = np.meshgrid(np.arange(around), np.arange(len(r) - 1), indexing="ij")
    after = (j + 1) % around
    a, b, c, d = (x.ravel() for x in (j * len(r) + k, after * len(r) + k, after * len(r) + k + 1, j * len(r) + k + 1))
    low, high = (r[:-1][k] > 0.0).ravel(), (r[1:][k] > 0.0).ravel()
    return np.concatenate([np.stack([a, b, d], axis=1)[low], np.stack([b, c, d], axis=1)[high]])


def ball(center: Any, frame: Any, radius: float, around: int = AROUND) -> TriangleMesh:
    """A ball about `center` (3,) [m] with its poles along the third row of `frame`."""
    latitude = np.linspace(-0.5 * np.pi, 0.5 * np.pi, around // 2 + 1)
    return revolved(center, frame, [(radius * np.cos(latitude), radius * np.sin(latitude))], around)


def plate(center: Any, frame: Any, half: Any) -> TriangleMesh:
    """A cuboid about `center` (3,) [m] with the half lengths (3,) [m] along the rows of `frame`."""
    points = center + (CORNERS * half) @ np.asarray(frame)
    first = 4 * np.arange(len(SIDES))[:, None, None]
    return TriangleMesh(points[SIDES.ravel()], (first + np.array([[0, 1, 2], [0, 2, 3]])).reshape(-1, 3))


def prism(section: Any, origin: Any, frame: Any, low: float, high: float, center: Any = None) -> TriangleMesh:
    """The body between `low` and `high` [m] along the third row of `frame` (3, 3), of a `section` (n, 2) [m]: a polygon
    counter-clockwise about `center` (2,), its mean where None, from which all of it is seen."""
    section = np.asarray(section, dtype=float)
    middle = section.mean(axis=0) if center is None else np.asarray(center)
    n = len(section)
    i = np.arange(n)
    after = (i + 1) % n
    plane = origin + np.concatenate([section, middle[None]]) @ np.asarray(frame)[:2]
    ends = [plane + z * np.asarray(frame)[2] for z in (low, high)]
    side = np.concatenate([ends[0][:n], ends[1][:n]])
    lateral = np.concatenate([np.stack([i, after, n + after], axis=1), np.stack([i, n + after, n + i], axis=1)])
    fan = np.stack([np.full(n, n), i, after], axis=1)
    return TriangleMesh.of(
        [TriangleMesh(side, lateral), TriangleMesh(ends[0], fan[:, ::-1]), TriangleMesh(ends[1], fan)]
    )


def rod(start: Any, end: Any, radius: float, around: int = 24) -> TriangleMesh:
    """A round rod between two points (3,) [m] that are apart."""
    axis = np.asarray(end, dtype=float) - start
    length = float(np.linalg.norm(axis))
    axis /= length
    e_0 = np.cross(axis, np.eye(3)[np.argmin(np.abs(axis))])
    e_0 /= np.linalg.norm(e_0)
    frame = np.stack([e_0, np.cross(axis, e_0), axis])
    r = [0.0, radius], [radius, radius], [radius, 0.0]
    z = [0.0, 0.0], [0.0, length], [length, length]
    return revolved(start, frame, list(zip(r, z, strict=True)), around)
