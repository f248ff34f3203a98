"""The space that a recording shows: directions to look from, sizes, and the frames that views are drawn in.

The viewer draws nothing that is closer to the eye than some centimetres, so that bodies of 10 mm seen from near by
would vanish. Every three-dimensional view therefore has as its origin an entity whose scale makes what it shows one
unit large; all data remain in metres.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from warpffrf.output.geometry.places import Pose

FRONT = np.array([0.55, -1.3, 0.45])  # towards the eye: from the front right, slightly above
ALONG, ASIDE, ABOVE = 1.3, 0.25, 0.15  # the same about the axis of a bearing
UP = np.array([0.0, 0.0, 1.0])
EYE = "eye"  # entity that scales a view
HALF_FIELD = 0.47  # height of a view over twice the distance of what fills it: the viewer's 55 degrees, less a margin
FIELD = 2.2  # distance of the eye over the radius of what is seen
ROUND = (5.0, 2.0, 1.0)
EMPTY = 0.05  # m, radius of a scene without bodies


def round_length(length: float) -> float:
    """The largest of 1, 2, 5 times a power of ten not above `length`."""
    decade = 10.0 ** np.floor(np.log10(length) + 1e-12)
    return float(next(m * decade for m in ROUND if m * decade <= length * (1.0 + 1e-9)))


def length_text(length: float) -> str:
    """A length [m] as text."""
    unit, per_metre = next((u, p) for u, p in (("m", 1.0), ("mm", 1e3), ("µm", 1e6)) if length * p >= 0.999 or p == 1e6)
    return f"{length * per_metre:.6g} {unit}"


def seen_along(axis: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Directions (3,) to the right and upwards of a picture seen along an axis, from its side that faces the front."""
    towards = axis if axis @ FRONT > 0.0 else -axis
    up = UP if abs(towards @ UP) < 0.9 else np.array([0.0, 1.0, 0.0])
    right = np.cross(up, towards)
    right /= np.linalg.norm(right)
    return right, np.cross(towards, right)


def extent(recorder: Any) -> tuple[np.ndarray, np.ndarray]:
    """Middle (3,) [m] of all bodies over the frames, plates of the ground left out, and their outermost points (n, 3)
    [m] from there."""
    bodies = recorder.result.history.bodies
    meshes = {name: mesh.points for name, mesh in recorder.rigid.meshes.items() if recorder.rigid.bounded(name)}
    meshes |= {name: body.points for name, body in recorder.bodies.items()}
    outer = {name: points[np.unique(np.argmax(points @ OUTWARDS, axis=0))] for name, points in meshes.items()}
    places = [
        Pose.of(bodies, name, int(i)).to_world(points)
        for i in recorder.rows[recorder.good] for name, points in outer.items()
    ]  # fmt: skip
    if not places:
        return np.zeros(3), EMPTY * OUTWARDS.T
    found = np.concatenate(places)
    middle = 0.5 * (found.min(axis=0) + found.max(axis=0))
    found = found - middle
    return middle, found[np.unique(np.argmax(found @ OUTWARDS, axis=0))]


def distance(points: np.ndarray, towards: np.ndarray, up: np.ndarray, aspect: float) -> float:
    """Distance [m] of an eye from the middle, in a direction (3,), at which a view of a width over height shows all
    `points` (n, 3) [m]."""
    depth = towards / np.linalg.norm(towards)
    right = np.cross(up, depth)
    right /= np.linalg.norm(right)
    x, y = points @ right, points @ np.cross(depth, right)
    return float(np.max(points @ depth + np.maximum(np.abs(x) / aspect, np.abs(y)) / HALF_FIELD))


def _directions(count: int) -> np.ndarray:
    """(3, count) unit vectors, evenly spread (a Fibonacci spiral)."""
    z = 1.0 - 2.0 * (np.arange(count) + 0.5) / count
    angle = np.pi * (1.0 + np.sqrt(5.0)) * np.arange(count)
    return np.stack([np.sqrt(1.0 - z**2) * np.cos(angle), np.sqrt(1.0 - z**2) * np.sin(angle), z])


OUTWARDS = _directions(100)
