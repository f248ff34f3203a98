r"""A solid ball with a small fine patch around +x, for a contact at a known position on the ball.

User frame: centre in the origin. On the patch nodes lie on lines of equal theta and of equal z of the sphere's chart
about the axis y, with e_0 = +x and e_1 = -z as for every body of revolution about y,

    x = R D,      D = cos(phi) cos(theta) e_0 + cos(phi) sin(theta) e_1 + sin(phi) e_y,      sin(phi) = z/R,

so that they are the contact grid. The rest is a ball in seven parts: a cube in the middle and a part on each of its
faces, with nodes on the rays D = c/|c| of the points c of a cube whose lines are at equal angles, on the face +x
c = (1, tan a, tan b) along e_0, e_1, e_y. That part is a nest (`lattice`): a fine brick under the patch, with shells to
the part's other five sides, made in the coordinates (D, r): lines between the unit vectors, scaled back to unit length,
and between the radii. Nodes of the surface lie exactly on the sphere.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from warpffrf.model.errors import InputError, require_number
from warpffrf.model.mesh.data import Mesh
from warpffrf.model.mesh.shapes.disc import (
    Array,
    assembled,
    depth_lines,
    nest_tops,
    nested,
    patch_counts,
    require_patch,
    shell_fractions,
)
from warpffrf.model.messages.named_arguments import named_arguments

CORE = 0.4  # half the side of the cube in the middle, in radii: its corners lie at 0.69 R
ACROSS = 4  # cells along x of the cube and of the parts next to it: far from the patch, and coarse
LARGEST_PATCH = 0.4  # rad, half-width: the faces of the cube reach to pi/4, the shells need room


@named_arguments
def ball(radius: float, *, patch_half_width: Any, cell: float, growth: float = 1.5, order: int = 2) -> Mesh:
    """A ball of `radius` about the origin with facet sets `patch`, around +x, and `outside`, the whole surface.

    Parameters (lengths in m)
    -------------------------
    patch_half_width: of the fine patch, one number or (2,): along the equator and along the axis y.
    cell: largest edge of the cells in it; with `order=2` nodes are half as far apart.
    growth: of the shells around it, above 1.
    order: 1 for hex8, 2 for curved hex27.

    `surfaces.Sphere` on `patch` has the nodes as its contact grid. For a ball that rolls farther, a roller with
    `crown_radius=outer_radius` is fine all around. Raises `InputError` for impossible sizes.
    """
    R = require_number(radius, "ball: radius", positive=True)
    half, edge, rate = require_patch("ball", patch_half_width, cell, order, growth)
    if float(np.max(half)) >= LARGEST_PATCH * R:
        raise InputError(
            f"ball: patch_half_width {float(np.max(half)):g} is not below {LARGEST_PATCH:g} of the radius; for a "
            "wide fine band use mesh.roller with crown_radius=outer_radius"
        )
    counts = patch_counts("ball", half, edge)
    a, b = (np.linspace(-1.0, 1.0, order * n + 1) for n in counts)
    below = float(np.min(half))
    down = depth_lines(edge, below, order)
    inner = np.concatenate([_chart_directions(a * half[0] / R, b * half[1] / R, len(down)), _fill(R - down, a, b)], -1)
    shares = np.linspace(0.0, 1.0, len(down))
    outer = _part(np.ones(1), a, b, shares, R)  # (1, a, b, s, 4)
    lattices = [
        _cartesian(lattice) for lattice in nested(inner, outer[0], shell_fractions(below, CORE * R, edge, rate, order))
    ]
    along = np.linspace(-1.0, 1.0, order * ACROSS + 1)
    lattices += [
        _cartesian(_part(-np.ones(1), a, b, shares, R)[0]),
        *(_cartesian(_part(along, np.array([side]), b, shares, R)[:, 0]) for side in (-1.0, 1.0)),
        *(_cartesian(_part(along, a, np.array([side]), shares, R)[:, :, 0]) for side in (-1.0, 1.0)),
        _user_axes(CORE * R * _cube(along, a, b)),
    ]
    sets = {"patch": [(0, 2, 0)], "outside": [*nest_tops(), *((part, 2, 0) for part in range(6, 11))]}
    return assembled(lattices, order, sets, "ball")


def _chart_directions(theta: Array, sine: Array, layers: int) -> Array:
    """Directions D (a, b, layers, 3) at angles `theta` (a,) [rad] and heights `sine` (b,) in radii."""
    cosine = np.sqrt(1.0 - sine**2)
    D = np.stack(
        [
            np.outer(np.cos(theta), cosine),
            np.outer(np.sin(theta), cosine),
            np.broadcast_to(sine, (len(theta), len(sine))),
        ],
        axis=-1,
    )
    return np.repeat(D[:, :, None], layers, axis=2)


def _fill(values: Array, a: Array, b: Array) -> Array:
    """`values` (s,) of every layer as (a, b, s, 1)."""
    return np.broadcast_to(values[None, None, :, None], (len(a), len(b), len(values), 1))


def _cube(a: Array, b: Array, c: Array) -> Array:
    """Points (a, b, c, 3) of the cube [-1, 1]^3 at fractions of 45 degrees seen from its middle."""
    return np.stack(np.meshgrid(*(np.tan(0.25 * np.pi * v) for v in (a, b, c)), indexing="ij"), axis=-1)


def _part(a: Array, b: Array, c: Array, shares: Array, R: float) -> Array:
    """(D, r) (a, b, c, s, 4) on the rays through the cube's points, from the sphere (share 0) to the cube (share 1)."""
    cube = _cube(a, b, c)
    length = np.linalg.norm(cube, axis=-1)
    r = R + shares * (CORE * R * length[..., None] - R)
    D = np.broadcast_to((cube / length[..., None])[..., None, :], (*r.shape, 3))
    return np.concatenate([D, r[..., None]], axis=-1)


def _cartesian(values: Array) -> Array:
    """Points (..., 3) [m], user axes, of directions along e_0, e_1, e_y, of any length, and radii (..., 4)."""
    D = values[..., :3]
    return _user_axes(values[..., 3:] * D / np.linalg.norm(D, axis=-1, keepdims=True))


def _user_axes(points: Array) -> Array:
    """Points (..., 3) along e_0 = +x, e_1 = -z, e_y in user axes."""
    return np.stack([points[..., 0], points[..., 2], -points[..., 1]], axis=-1)
