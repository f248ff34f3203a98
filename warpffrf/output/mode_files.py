"""Modes of a scene in files: a universal file with the skins and a dataset 55 per mode, and glTF with morph targets."""

from __future__ import annotations

from typing import Any

import numpy as np

from warpffrf.output.files.gltf import Motion, MovingMesh, glb, turns
from warpffrf.output.files.universal import header_151, nodes_2411, shape_55, triangles_2412, units_164
from warpffrf.output.plots.modes import MovedSkin, outward

Array = np.ndarray
STANDING = 1e-6  # of the largest displacement: out-of-phase part of a mode that is real
DRAWN = 0.06  # largest displacement drawn, of the largest extent


def standing(u: Array, damping: float, undamped: float) -> bool:
    """Whether a mode is real: undamped, and all points in phase."""
    return abs(damping) < undamped and float(np.abs(np.imag(u)).max(initial=0.0)) <= STANDING * float(
        np.abs(u).max(initial=0.0)
    )


def universal_file(modes: Any, skins: list[list[MovedSkin]], undamped: float) -> str:
    """Text of a universal file: `skins` of each mode, of equal points."""
    first = skins[0]
    start = np.cumsum([0, *(len(skin.points) for skin in first)])
    parts = [
        header_151(f"modes about the {modes.about}"),
        units_164(),
        nodes_2411(np.concatenate([skin.points for skin in first])),
    ]
    triangles = np.concatenate([skin.triangles + n for skin, n in zip(first, start[:-1], strict=True)])
    of = np.concatenate([np.full(len(skin.triangles), n) for n, skin in enumerate(first, start=1)])
    parts.append(triangles_2412(triangles, of))
    for i, moved in enumerate(skins):
        u = np.concatenate([np.asarray(skin.displacement, dtype=complex) for skin in moved])
        f, zeta = float(modes.frequencies[i]), float(modes.damping_ratios[i])
        shape = np.real(u) if standing(u, zeta, undamped) else u
        title = f"mode {i} about the {modes.about}, {f:.6g} Hz, damping {100.0 * zeta:.4g} %"
        parts.append(shape_55(i + 1, f, zeta, complex(modes.eigenvalues[i]), shape, title))
    return "".join(parts)


def gltf_file(modes: Any, skins: list[list[MovedSkin]], undamped: float) -> bytes:
    """Bytes of a .glb file; the largest displacement of each mode is `DRAWN` of the extent of the scene."""
    extent = float(np.ptp(np.concatenate([skin.points for skin in skins[0]]), axis=0).max())
    targets: list[list[Array]] = [[] for _ in skins[0]]
    motions: list[tuple[str, int, bool]] = []  # name, first target, whether complex
    for i, moved in enumerate(skins):
        u = [np.asarray(skin.displacement, dtype=complex) for skin in moved]
        whole = np.concatenate(u)
        top = float(np.linalg.norm(whole, axis=1).max(initial=0.0))
        factor = DRAWN * extent / top if top > 0.0 else 0.0
        real = standing(whole, float(modes.damping_ratios[i]), undamped)
        motions.append((f"mode {i}: {modes.frequencies[i]:.5g} Hz", len(targets[0]), not real))
        for parts, own in zip(targets, u, strict=True):
            parts += [factor * np.real(own)] if real else [factor * np.real(own), -factor * np.imag(own)]
    count, angle = len(targets[0]), turns()
    animations = []
    for name, at, two in motions:
        weights = np.zeros((len(angle), count))
        weights[:, at] = np.cos(angle) if two else np.sin(angle)
        if two:
            weights[:, at + 1] = np.sin(angle)
        animations.append(Motion(name, weights))
    meshes = [
        MovingMesh(skin.name, skin.points, outward(skin).triangles, np.array(own))
        for skin, own in zip(skins[0], targets, strict=True)
    ]
    return glb(meshes, animations, f"modes about the {modes.about}")
