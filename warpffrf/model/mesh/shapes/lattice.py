r"""Meshes put together from lattices: bricks of points, hexahedra between them, equal points merged.

A lattice (a, b, c, 3) holds the nodes of (a - 1)/o x (b - 1)/o x (c - 1)/o hexahedra of order o, wherever a smooth map
has put them; a left-handed one is turned round. Neighbouring lattices share the points of their common face, found by
their place, so that whoever makes them need not number anything.

A *nest* is what a small contact patch needs: a fine brick of equal cells under the patch, and shells around it whose
cells grow outwards. Five lattices, one on each face of the brick but the top, run from it to the faces of a large
brick: with corresponding points I and O of both and fractions f of the way,

    X(f) = (1 - f) I + f O,

in whatever coordinates the map takes. The number of cells stays that of the patch all the way, while their size grows:
a patch of n x n cells costs 3 n^2 cells a shell, and the shells grow in number with the logarithm of the body's size.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from warpffrf.model.errors import InputError, require_array, require_count, require_number
from warpffrf.model.mesh.data import Mesh
from warpffrf.model.mesh.elements import cell_kind
from warpffrf.model.mesh.facets import FacetSet
from warpffrf.model.mesh.shapes.cell_count import require_cells

Array = np.ndarray
Face = tuple[int, int, int]  # lattice, axis, end (0 or 1)
KINDS = {1: "hex8", 2: "hex27"}
SAME_POINT = 1e-9  # of the body's size: points this close are one node; the finest cells are 1e-5 of it
FIRST_SHELL = 1.5  # thickness of the first shell in cells of the patch
DEPTH_GROWTH = 1.25  # of the layers of the fine brick downwards: the stress varies more slowly there


def refined(corners: np.ndarray, order: int) -> np.ndarray:
    """Corner positions (n,); for order 2 with the midpoints between them: mid nodes there keep det J positive."""
    if order == 1:
        return corners
    nodes = np.empty(2 * len(corners) - 1)
    nodes[::2] = corners
    nodes[1::2] = 0.5 * (corners[1:] + corners[:-1])
    return nodes


def assembled(lattices: Sequence[Array], order: int, sets: Mapping[str, Sequence[Face]], name: str) -> Mesh:
    """The mesh of `lattices` (a, b, c, 3) [m] with facet sets {name: faces (lattice, axis, end)}."""
    kind = cell_kind(KINDS[order])
    offset = np.rint(0.5 * order * (kind.nodes + 1.0)).astype(np.int64)
    ((facet, faces),) = kind.faces.items()  # order of faces: low and high end of each axis
    cells, sides, points, start = [], {}, [], 0
    for number, given in enumerate(lattices):
        mirrored = _left_handed(given)
        lattice = given[::-1] if mirrored else given
        shape = lattice.shape[:3]
        corner = np.stack(np.meshgrid(*[np.arange(0, n - 1, order) for n in shape], indexing="ij"), axis=-1)
        node = corner[..., None, :] + offset
        numbers = start + np.asarray(np.ravel_multi_index(tuple(np.moveaxis(node, -1, 0)), shape))
        for axis in range(3):
            for end in range(2):
                wanted = end if axis or not mirrored else 1 - end
                on_side = np.take(numbers, -1 if wanted else 0, axis=axis)
                sides[number, axis, end] = on_side[..., faces[2 * axis + wanted]].reshape(-1, faces.shape[1])
        cells.append(numbers.reshape(-1, len(kind.nodes)))
        points.append(lattice.reshape(-1, 3))
        start += int(np.prod(shape))
    place, merged = _merged(np.concatenate(points))
    facet_sets = {
        key: FacetSet({facet: merged[np.concatenate([sides[face] for face in of])]}) for key, of in sets.items()
    }
    return Mesh(place, {kind.name: merged[np.concatenate(cells)]}, facet_sets, name=name)


def _left_handed(lattice: Array) -> bool:
    a, b, c = (lattice[place] - lattice[0, 0, 0] for place in ((1, 0, 0), (0, 1, 0), (0, 0, 1)))
    return float(np.dot(np.cross(a, b), c)) < 0.0


def _merged(points: Array) -> tuple[Array, Array]:
    """Distinct points (n, 3), in the order of their first occurrence, and the number (m,) of each of `points`."""
    from scipy.sparse import coo_matrix
    from scipy.sparse.csgraph import connected_components
    from scipy.spatial import KDTree

    close = SAME_POINT * float(np.max(np.ptp(points, axis=0)))
    pairs = KDTree(points).query_pairs(close, output_type="ndarray")
    graph = coo_matrix((np.ones(len(pairs), dtype=np.int8), (pairs[:, 0], pairs[:, 1])), shape=2 * (len(points),))
    label = connected_components(graph, directed=False)[1]
    _, first, inverse = np.unique(label, return_index=True, return_inverse=True)
    rank = np.empty(len(first), dtype=np.int64)
    rank[np.argsort(first, kind="stable")] = np.arange(len(first))
    return points[np.sort(first)], rank[inverse.ravel()]


# --- nests ---


def nested(inner: Array, outer: Array, fractions: Array) -> list[Array]:
    """The brick `inner` (a, b, c, k) and the five shells' lattices around it, in the coordinates of the two arrays.

    The third axis runs down from the top, which both share. `outer` has the shape of `inner`, of which only the five
    faces count; `fractions` (s,) run from 0 to 1. Lattice axes of the shells: two along the face, then outwards.
    """
    faces = [np.s_[0, :, :], np.s_[-1, :, :], np.s_[:, 0, :], np.s_[:, -1, :], np.s_[:, :, -1]]
    f = fractions[:, None]
    return [inner, *((1.0 - f) * inner[face][:, :, None] + f * outer[face][:, :, None] for face in faces)]


def nest_tops(first: int = 0) -> list[Face]:
    """Faces of a nest's lattices, numbered from `first`, that make its top: the brick's, and those of the shells."""
    return [(first, 2, 0), *((first + shell, 1, 0) for shell in range(1, 5))]


def shell_fractions(start: float, end: float, cell: float, growth: float, order: int) -> Array:
    """Fractions (s,) of the way from half-width `start` to `end` [m] at which shells, and their mid nodes, lie.

    Thicknesses begin at `FIRST_SHELL` cells of size `cell` and grow by `growth`, but not beyond the share `growth - 1`
    of the distance from the middle: farther out the cells' sides grow at that rate too, and they keep their shape.
    """
    reach, thickness, lines = start, FIRST_SHELL * cell, [start]
    while reach < end:
        reach += min(thickness, reach * (growth - 1.0))
        thickness *= growth
        lines.append(reach)
    if len(lines) > 2 and lines[-1] - end > end - lines[-2]:
        lines.pop()  # the last line but one is nearer to the end
    line = np.array(lines)
    return refined((line - start) / (line[-1] - start), order)


def depth_lines(cell: float, depth: float, order: int) -> Array:
    """Depths [m] of the layers of a fine brick, and of their mid nodes: from `cell` on growing by `DEPTH_GROWTH`."""
    count = max(int(np.ceil(np.log1p(depth / cell * (DEPTH_GROWTH - 1.0)) / np.log(DEPTH_GROWTH))), 2)
    line = np.concatenate([[0.0], np.cumsum(DEPTH_GROWTH ** np.arange(count, dtype=float))])
    return refined(depth * line / line[-1], order)


def patch_counts(label: str, half: Array, cell: float) -> list[int]:
    """Even numbers of cells of at most `cell` [m] over a patch of half-widths `half` (2,) [m]."""
    counts = [2 * require_count(int(np.ceil(h / cell - 1e-9)), f"{label}: cells of half the patch", 1) for h in half]
    require_cells(label, *counts)
    return counts


def require_patch(
    label: str, patch_half_width: object, cell: object, order: int, growth: object
) -> tuple[Array, float, float]:
    """Half-widths (2,) [m], cell size [m] and growth, all checked; raises `InputError`."""
    if order not in KINDS:
        raise InputError(f"{label}: order must be 1 (hex8) or 2 (hex27), got {order!r}")
    both = patch_half_width if np.ndim(patch_half_width) else (patch_half_width, patch_half_width)  # type: ignore[arg-type]
    half = require_array(both, f"{label}: patch_half_width", (2,))
    if not np.all(half > 0.0):
        raise InputError(f"{label}: patch_half_width must be greater than zero, got {patch_half_width!r}")
    size = require_number(cell, f"{label}: cell", positive=True)
    if size > float(np.min(half)):
        raise InputError(
            f"{label}: cell {size:g} is larger than half the patch {float(np.min(half)):g}; make it smaller"
        )
    rate = require_number(growth, f"{label}: growth", positive=True)
    if not rate > 1.0:
        raise InputError(f"{label}: growth of the shells must be above 1, got {rate:g}; 1.5 is usual")
    return half, size, rate
