"""Gears as triangle meshes, for pictures: bodies of gear pairs without a mesh, rigid ones and half-spaces.

The outline is that of the tooth, fillet and flanks with the lands between them, straight or helical between the ends of
the flanks, around a bore, of an internal gear within a rim; neither is known, their radii are chosen. Flanks with
contacts have finer facets, so that patches are seen on them. Faces lie slightly beyond the flanks: they take no
pressure.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np

from warpffrf.model.gears.gear import FLANKS, Gear
from warpffrf.output.geometry.solids import TriangleMesh

Array = np.ndarray
FLANK = "flank_"  # begin of the names of flanks, as of `Gear.surfaces`
BORE, RIM = 0.4, 2.5  # of the root radius; modules beyond the root circle of an internal gear
POINTS, FEWEST, OUTLINE = 12, 5, 800  # of a flank, most and fewest, and of an outline
FINE, ROWS, FACETS = 96, 17, 8000  # of a flank with contact, along and across; of all of these
LAND = 3  # points of an arc between flanks
ANGLE = 0.02  # rad: rotation of a helical gear from one row of points to the next
BEYOND = 1e-3  # of the width


def gear_meshes(view: Any, ends: Mapping[tuple[str, str], tuple[float, float]]) -> dict[str, TriangleMesh]:
    """The gears of each body of the gear pairs of a `SceneView`, user frame, by name; ends: those of its flanks along
    the axis [m], by body and surface, bodies without any are left out."""
    found: dict[str, list[TriangleMesh]] = {}
    for pair in view.gears.values():
        for n, (data, body) in enumerate(zip(pair["gears"], pair["bodies"], strict=True)):
            touching = {(side, teeth[n]) for side, *teeth, _ in pair["contacts"]}
            known = [ends[body, name] for s, t in touching if (body, name := f"{FLANK}{s}_{t}") in ends]
            if known:
                low, high = np.median(known, axis=0)
                found.setdefault(body, []).append(gear_mesh(Gear(**data), low, high, touching))
    return {body: TriangleMesh.of(meshes) for body, meshes in found.items()}


def half_space_gear(view: Any, body: Any) -> TriangleMesh | None:
    """The gears of a flexible body of a `SceneView`, None where it has none, or a mesh of its own."""
    surfaces = body.reduced.contact_surfaces
    if not all(surface.half_space for surface in surfaces.values()):
        return None
    ends = {(body.name, name): tuple(surface.grid.z[[0, -1]]) for name, surface in surfaces.items()}
    mesh = gear_meshes(view, ends).get(body.name)
    if mesh is None or all(name.startswith(FLANK) for name in surfaces):
        return mesh
    skin = body.reduced.surface
    return TriangleMesh.of([mesh, TriangleMesh(skin.points, skin.triangles)])


def gear_mesh(gear: Gear, low: float, high: float, touching: Iterable[tuple[str, int]] = ()) -> TriangleMesh:
    """A gear about the y axis between `low` and `high` [m]; touching: flanks, ("right", 3), with fine facets."""
    fine = set(touching)
    coarse = int(np.clip((OUTLINE / gear.teeth - 2 * LAND) / 2.0, FEWEST, POINTS))
    dense = int(np.clip(FACETS / ROWS / max(len(fine), 1), coarse, FINE))
    along = {}
    for side in FLANKS:
        curve = gear.flank(side)
        along[side] = {n: curve.at(np.linspace(curve.knots[0], curve.knots[-1], n)) for n in (coarse, dense)}
    pitch = 2.0 * np.pi / gear.teeth
    rows = 2 + int(abs(gear.twist) * (high - low) / ANGLE)
    width = np.linspace(low, high, rows)
    parts, outline = [], []
    for k in range(gear.teeth):
        tooth = gear.side * k
        flank: dict[str, Array] = {}
        for side in FLANKS:
            loaded = (side, tooth % gear.teeth + 1) in fine
            flank[side] = _turned(along[side][dense if loaded else coarse], pitch * tooth)
            parts.append(_strip(flank[side], np.linspace(low, high, max(ROWS, rows)) if loaded else width))
        begin = _turned(along["right"][coarse][0], pitch * gear.side * (k + 1))
        lands = _arc(flank["right"][-1], flank["left"][0]), _arc(flank["left"][-1], begin)
        parts += [_strip(land, width) for land in lands]
        outline += [flank["right"], lands[0][1:-1], flank["left"], lands[1][1:-1]]
    line = np.concatenate(outline)
    root = 0.5 * gear.root_diameter
    radius = root + RIM * gear.module if gear.internal else BORE * root
    ring = radius * line / np.linalg.norm(line, axis=1, keepdims=True)
    beyond = BEYOND * (high - low)
    parts.append(_strip(np.concatenate([ring, ring[:1]])[::-1], np.array([low, high])))
    parts += [_face(line, ring, low - beyond, -1), _face(line, ring, high + beyond, 1)]
    mesh = TriangleMesh.of(parts)
    if not gear.twist:
        return mesh
    x, y, z = mesh.points.T
    angle = gear.twist * np.clip(y, low, high)
    c, s = np.cos(angle), np.sin(angle)
    return TriangleMesh(np.stack([c * x + s * z, y, c * z - s * x], axis=1), mesh.triangles)


def _turned(points: Array, angle: float) -> Array:
    c, s = np.cos(angle), np.sin(angle)
    return points @ np.array([[c, s], [-s, c]])


def _arc(begin: Array, end: Array) -> Array:
    """Points (LAND, 2) about the axis between two at one radius, the shorter way."""
    first, last = (float(np.arctan2(y, x)) for x, y in (begin, end))
    angle = first + np.linspace(0.0, 1.0, LAND) * (np.remainder(last - first + np.pi, 2.0 * np.pi) - np.pi)
    return np.linalg.norm(begin) * np.stack([np.cos(angle), np.sin(angle)], axis=1)


def _in_space(section: Array, z: Any) -> Array:
    """Points of the section (..., 2) at z along the y axis, whose section has the axes x and -z."""
    x, y, z = np.broadcast_arrays(section[..., 0], section[..., 1], z)
    return np.stack([x, z, -y], axis=-1)


def _strip(line: Array, z: Array) -> TriangleMesh:
    """The surface over a line (n, 2) with the material to its left, at z (k,)."""
    i, j = np.meshgrid(np.arange(len(line) - 1), np.arange(len(z) - 1), indexing="ij")
    a = (i * len(z) + j).ravel()
    b, c, d = a + len(z), a + len(z) + 1, a + 1
    triangles = np.concatenate([np.stack([a, b, c], axis=1), np.stack([a, c, d], axis=1)])
    return TriangleMesh(_in_space(line[:, None], z).reshape(-1, 3), triangles)


def _face(line: Array, ring: Array, z: float, sense: int) -> TriangleMesh:
    """The face between a closed line (n, 2) and the ring within it, or around it, as seen along `sense` times y."""
    n, i = len(line), np.arange(len(line))
    after = (i + 1) % n
    triangles = np.concatenate([np.stack([i, after, n + after], axis=1), np.stack([i, n + after, n + i], axis=1)])
    return TriangleMesh(_in_space(np.concatenate([line, ring]), z), triangles[:, ::sense])
