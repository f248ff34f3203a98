"""glTF 2.0, binary (.glb): bodies with the modes as morph targets, and an animation of each mode.

Each body is a mesh whose morph targets are the displacements of the modes at full amplitude; the animation of a mode is
one period, in which its weight runs through a sine and the others are 0. Complex modes have two targets, their real and
imaginary parts, weighed by cosine and sine. Viewers of the format show it: browsers with three.js or model-viewer,
Windows' and Apple's own, Blender.
"""

from __future__ import annotations

import json
import struct
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

Array = np.ndarray
FLOAT, UNSIGNED = 5126, 5125  # types of components
VERTICES, INDICES = 34962, 34963  # targets of views
KEYS, PERIOD = 25, 2.0  # of an animation: times of a period; seconds on the screen
PALETTE = ((0.30, 0.50, 0.70), (0.80, 0.50, 0.25), (0.40, 0.62, 0.42), (0.62, 0.42, 0.60), (0.55, 0.55, 0.58))


@dataclass(frozen=True, eq=False)
class MovingMesh:
    """A body: points (n, 3) [m], triangles (t, 3), and displacements (k, n, 3) [m] of k targets."""

    name: str
    points: Array
    triangles: Array
    targets: Array


@dataclass(frozen=True, eq=False)
class Motion:
    """An animation: weights (KEYS, k) of the targets over a period."""

    name: str
    weights: Array


def turns() -> Array:
    """Angles (KEYS,) [rad] of an animation's times."""
    return np.linspace(0.0, 2.0 * np.pi, KEYS)


def glb(meshes: Sequence[MovingMesh], motions: Sequence[Motion], title: str) -> bytes:
    """The bytes of a .glb file."""
    store = _Store()
    tree: dict[str, Any] = {
        "asset": {"version": "2.0", "generator": "written by warpffrf"},
        "scene": 0,
        "scenes": [{"name": title, "nodes": [*range(len(meshes))]}],
        "nodes": [{"name": mesh.name, "mesh": i} for i, mesh in enumerate(meshes)],
        "meshes": [_mesh(store, mesh, i) for i, mesh in enumerate(meshes)],
        "materials": [
            {
                "pbrMetallicRoughness": {
                    "baseColorFactor": [*color, 1.0],
                    "metallicFactor": 0.1,
                    "roughnessFactor": 0.6,
                },
                "doubleSided": True,
            }
            for color in PALETTE
        ],
    }
    if motions:
        times = store.add(np.linspace(0.0, PERIOD, KEYS).astype(np.float32), "SCALAR", bounds=True)
        tree["animations"] = []
        for motion in motions:
            weights = store.add(motion.weights.astype(np.float32).ravel(), "SCALAR")
            channels = [{"sampler": 0, "target": {"node": i, "path": "weights"}} for i in range(len(meshes))]
            samplers = [{"input": times, "output": weights, "interpolation": "LINEAR"}]
            tree["animations"].append({"name": motion.name, "channels": channels, "samplers": samplers})
    tree |= {"accessors": store.accessors, "bufferViews": store.views, "buffers": [{"byteLength": len(store.data)}]}
    text = json.dumps(tree, separators=(",", ":")).encode()
    text += b" " * (-len(text) % 4)
    size = 12 + 8 + len(text) + 8 + len(store.data)
    head = struct.pack("<4sII", b"glTF", 2, size)
    return (
        head
        + struct.pack("<I4s", len(text), b"JSON")
        + text
        + struct.pack("<I4s", len(store.data), b"BIN\0")
        + store.data
    )


class _Store:
    """The binary part, and its tables."""

    def __init__(self) -> None:
        self.data = bytearray()
        self.views: list[dict[str, Any]] = []
        self.accessors: list[dict[str, Any]] = []

    def add(self, array: Array, kind: str, target: int | None = None, *, bounds: bool = False) -> int:
        """The number of a new accessor of `array`."""
        view: dict[str, Any] = {"buffer": 0, "byteOffset": len(self.data), "byteLength": array.nbytes}
        if target is not None:
            view["target"] = target
        self.views.append(view)
        self.data += np.ascontiguousarray(array).tobytes()
        found = {"bufferView": len(self.views) - 1, "count": len(array), "type": kind}
        found["componentType"] = UNSIGNED if array.dtype == np.uint32 else FLOAT
        if bounds:
            rows = array.reshape(len(array), -1)
            found |= {"min": rows.min(axis=0).tolist(), "max": rows.max(axis=0).tolist()}
        self.accessors.append(found)
        return len(self.accessors) - 1


def _mesh(store: _Store, mesh: MovingMesh, number: int) -> dict[str, Any]:
    def vectors(values: Array) -> int:
        return store.add(values.astype(np.float32), "VEC3", VERTICES, bounds=True)

    primitive = {
        "attributes": {"POSITION": vectors(mesh.points), "NORMAL": vectors(_normals(mesh.points, mesh.triangles))},
        "indices": store.add(mesh.triangles.astype(np.uint32).ravel(), "SCALAR", INDICES),
        "targets": [{"POSITION": vectors(u)} for u in mesh.targets],
        "material": number % len(PALETTE),
    }
    if not len(mesh.targets):
        del primitive["targets"]
        return {"name": mesh.name, "primitives": [primitive]}
    return {"name": mesh.name, "primitives": [primitive], "weights": [0.0] * len(mesh.targets)}


def _normals(points: Array, triangles: Array) -> Array:
    """Unit normals (n, 3) at the points, of the triangles around weighed by area."""
    x = points[triangles]
    area = np.cross(x[:, 1] - x[:, 0], x[:, 2] - x[:, 0])
    total = np.zeros_like(points)
    for corner in range(3):
        np.add.at(total, triangles[:, corner], area)
    length = np.linalg.norm(total, axis=1, keepdims=True)
    return np.where(length > 0.0, total / np.where(length > 0.0, length, 1.0), (0.0, 0.0, 1.0))
