r"""A disc of quadrilaterals, fine at its rim and coarse in its middle: the cross section of a solid roller.

Plane coordinates (p, q) in radii of the disc; quadrilaterals run round counter-clockwise. Three parts, from the rim in:

- *Rings* of `sectors` cells, whose layers grow inwards. A layer that is deep compared with the width of its cells
  has a *transition*: every four cells outside, p0 to p4, meet two inside, A, M and B,

        p0    p1    p2    p3    p4
        |      \    |    /      |
        |  q1 --- q2 --- q3     |          six quadrilaterals instead of four
        |  /        |      \    |
        A --------- M --------- B

  so that the number of cells around halves while their size doubles. Cells in excess of a multiple of four continue
  unchanged, distributed between the blocks. The quarters of the disc have equal meshes, and its inertia is that of a
  round body.
- A *core* of k x k cells that fills a square with bulging sides, one side for each quarter of the revolution,

        p = s u sqrt(1 - B v^2/2),     q = s v sqrt(1 - B u^2/2),       -1 <= u, v <= 1,

  rotated by 45 degrees so that its corners lie on the axes p and q. Its lines end at equal angles.
- A few rings between the core and the circle of radius `CORE`. Three cells meet at a corner of the square; B makes
  their angles there nearly equal.

Nodes in the middle of edges and cells have the mean radius and angle in the rings, so that all circles are true ones,
and the mean position in the core.

Lattice. Meshes assembled from lattices: bricks of points, hexahedra between them, equal points merged.

A lattice (a, b, c, 3) holds the nodes of (a - 1)/o x (b - 1)/o x (c - 1)/o hexahedra of order o, at positions given by
a smooth map; a left-handed one is reversed. Neighbouring lattices share the points of their common face, found by
their coordinates, so that no numbering is required.

A *nest* is the mesh around a small contact patch: a fine brick of equal cells under the patch, and shells around it
whose cells grow outwards. Five lattices, one on each face of the brick but the top, run from it to the faces of a large
brick: with corresponding points I and O of both and fractions f of the way,

    X(f) = (1 - f) I + f O,

in the coordinates of the map. The number of cells remains that of the patch throughout, while their size grows: a patch
of n x n cells requires 3 n^2 cells per shell, and the shells grow in number with the logarithm of the body's size.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from warpffrf.model.errors import InputError, require_array, require_count, require_number
from warpffrf.model.mesh.data import Mesh
from warpffrf.model.mesh.elements import cell_kind
from warpffrf.model.mesh.facets import FacetSet
from warpffrf.model.mesh.shapes.cell_count import require_cells

Array = np.ndarray

CORE = 0.4  # radius of the circle around the core: its cells there are as large as those of layers that grow by 1.4
SQUARE = 0.55  # s over CORE: the ring between is then as wide as the cells on both sides of it
BULGE = 0.45  # B: the core's corner has 124 degrees, the two cells outside it 118 each
DEEP = 1.6  # depth over width of a cell from which a layer has a transition: its own cells are half as deep
LEAST_QUARTER = 4  # cells in a quarter that can still be halved
LEAST_SECTORS = 8  # two core cells per side


@dataclass(frozen=True, eq=False)
class Disc:
    """`points` (n, 2) in radii; `cells` (m, o + 1, o + 1) node numbers of order o, first axis outwards or along u,
    second one counter-clockwise. The first `sectors` cells, in the order of their angle, are those at the rim, those
    from number `core` on lie within the radius `CORE`."""

    points: Array
    cells: Array
    sectors: int
    core: int


def disc(sectors: int, radii: Array, order: int) -> Disc:
    """The disc with `sectors` cells around, a multiple of 4 and at least 8, and layers between `radii` (l + 1,), which
    fall from 1 to `CORE`."""
    plan = _Plan()
    around = plan.ring(radii[0], sectors)
    for layer, (outer, inner) in enumerate(zip(radii[:-1], radii[1:], strict=True)):
        steps = _transitions(outer, inner, len(around)) if layer else 0
        if not steps:
            around = plan.plain(around, inner)
            continue
        # each is twice as deep as the one outside it, as its cells are twice as wide
        ends = outer + (inner - outer) * (2.0 ** np.arange(steps + 1) - 1.0) / (2.0**steps - 1.0)
        for above, below in zip(ends[:-1], ends[1:], strict=True):
            around = plan.transition(around, above, below)
    return plan.finished(sectors, around, order)


def _transitions(outer: float, inner: float, count: int) -> int:
    """Number of transitions of a layer with `count` cells at its outer radius."""
    width = 2.0 * np.pi * outer / count
    found = 0
    while outer - inner >= DEEP * (2.0 ** (found + 1) - 1.0) * width and count >= 4 * LEAST_QUARTER:
        count -= 8 * (count // 16)
        found += 1
    return found


class _Plan:
    """Corners and cells in the order of construction; corners of the rings have a radius and an angle."""

    def __init__(self) -> None:
        self.polar: list[Array] = []  # (m, 2): radius, angle
        self.count = 0
        self.cells: list[Array] = []  # (m, 4), counter-clockwise from the inner corner at the smaller angle

    def nodes(self, radius: float, angle: Array) -> Array:
        self.polar.append(np.stack([np.full(len(angle), radius), angle], axis=1))
        self.count += len(angle)
        return np.arange(self.count - len(angle), self.count)

    def ring(self, radius: float, count: int) -> Array:
        return self.nodes(radius, 2.0 * np.pi * np.arange(count) / count)

    def plain(self, outer: Array, radius: float) -> Array:
        """One cell inside every cell of the ring `outer`; the ring at `radius`."""
        inner = self.ring(radius, len(outer))
        self.cells.append(_between(inner, outer))
        return inner

    def transition(self, outer: Array, above: float, radius: float) -> Array:
        """Two cells inside every four of the ring `outer` at radius `above`, except for the remaining ones; the ring at
        `radius`."""
        n = len(outer)
        quarter = n // 4
        block = np.array(_spread(quarter // 4, quarter % 4) * 4)  # four and two cells where True, one and one else
        first_o = np.cumsum(np.where(block, 4, 1)) - np.where(block, 4, 1)
        first_i = np.cumsum(np.where(block, 2, 1)) - np.where(block, 2, 1)
        m = n - 2 * int(block.sum())
        inner = self.ring(radius, m)
        single = ~block
        o, i = first_o[single], first_i[single]
        self.cells.append(np.stack([inner[i], outer[o], outer[(o + 1) % n], inner[(i + 1) % m]], axis=1))

        o, i = first_o[block][:, None], first_i[block][:, None]
        p = outer[(o + np.arange(5)) % n]
        A, M, B = inner[(i + np.arange(3)) % m].T
        # in a deep layer, half a cell width above A: well-shaped angles at A and B
        middle = radius + min(0.5 * (above - radius), np.pi * radius / m)
        angle = np.pi * ((o + np.arange(1, 4)) / n + (i + np.array([0.5, 1.0, 1.5])) / m)  # means of both rings
        q = self.nodes(middle, angle.ravel()).reshape(angle.shape)
        quads = [
            (A, p[:, 0], p[:, 1], q[:, 0]),
            (q[:, 0], p[:, 1], p[:, 2], q[:, 1]),
            (q[:, 1], p[:, 2], p[:, 3], q[:, 2]),
            (q[:, 2], p[:, 3], p[:, 4], B),
            (A, q[:, 0], q[:, 1], M),
            (M, q[:, 1], q[:, 2], B),
        ]
        self.cells += [np.stack(quad, axis=1) for quad in quads]
        return inner

    def finished(self, sectors: int, circle: Array, order: int) -> Disc:
        """The disc of the rings so far, the innermost of which is `circle`, and the core."""
        polar = np.concatenate(self.polar)
        places = [_plane(polar[:, 0], polar[:, 1])]
        k, layered = len(circle) // 4, sum(len(c) for c in self.cells)
        core = _core(k)
        number = self.count + np.arange((k + 1) ** 2).reshape(k + 1, k + 1)
        places.append(core.reshape(-1, 2))
        used = self.count + (k + 1) ** 2
        side = np.concatenate([number[-1, :-1], number[:0:-1, -1], number[0, :0:-1], number[:-1, 0]])
        start, end = places[0][circle], core.reshape(-1, 2)[side - self.count]
        gap = float(np.mean(np.linalg.norm(start - end, axis=1)))
        rings = max(round(gap / (2.0 * np.pi * CORE / len(circle))), 1)
        outer = circle
        for share in np.arange(1, rings) / rings:
            inner = used + np.arange(len(circle))
            places.append((1.0 - share) * start + share * end)
            used += len(circle)
            self.cells.append(_between(inner, outer))
            outer = inner
        self.cells.append(_between(side, outer))
        corners = [number[:-1, :-1], number[1:, :-1], number[1:, 1:], number[:-1, 1:]]
        self.cells.append(np.stack([c.ravel() for c in corners], axis=1))
        points, quads = np.concatenate(places), np.concatenate(self.cells)
        if order == 1:
            return Disc(points, quads[:, [[0, 3], [1, 2]]], sectors, layered)
        return Disc(*_quadratic(points, quads, polar[:, 0]), sectors, layered)


def _spread(blocks: int, others: int) -> list[bool]:
    """`blocks` times True and `others` times False, distributed evenly."""
    total = blocks + others
    row = [True] * total
    for i in range(others):
        row[(2 * i + 1) * total // (2 * others)] = False
    return row


def _between(inner: Array, outer: Array) -> Array:
    """Cells (n, 4) between two rings of n nodes."""
    return np.stack([inner, outer, np.roll(outer, -1), np.roll(inner, -1)], axis=1)


def _plane(radius: Array, angle: Array) -> Array:
    return radius[..., None] * np.stack([np.cos(angle), np.sin(angle)], axis=-1)


def _core(k: int) -> Array:
    """Corners (k + 1, k + 1, 2) of the core's cells."""
    slope = np.tan(np.linspace(-0.25 * np.pi, 0.25 * np.pi, k + 1))
    line = slope / np.sqrt(1.0 - 0.5 * BULGE * (1.0 - slope**2))  # whose ends on the sides lie at these slopes
    u, v = np.meshgrid(line, line, indexing="ij")
    s = SQUARE * CORE * np.sqrt(0.5)  # times cos and sin of 45 degrees
    p, q = u * np.sqrt(1.0 - 0.5 * BULGE * v**2), v * np.sqrt(1.0 - 0.5 * BULGE * u**2)
    return s * np.stack([p - q, p + q], axis=-1)


def _quadratic(corners: Array, quads: Array, radius: Array) -> tuple[Array, Array]:
    """Points and cells (m, 3, 3) with nodes in the middle of edges and cells; `radius` (n,) of the corners that belong
    to rings, which are the first ones."""
    pairs = quads[:, [[0, 1], [1, 2], [2, 3], [3, 0]]]
    edges, number = np.unique(np.sort(pairs.reshape(-1, 2), axis=1), axis=0, return_inverse=True)
    number = len(corners) + number.reshape(-1, 4)
    middles = corners[edges].mean(axis=1)
    turned = np.all(edges < len(radius), axis=1)
    middles[turned] = _mean_polar(corners, radius, edges[turned])
    points = np.concatenate([corners, middles])
    # the middle of the four edges, the mean of the corners where the edges are straight
    centers = 0.5 * points[number].sum(axis=1) - 0.25 * corners[quads].sum(axis=1)
    turned = np.all(quads < len(radius), axis=1)
    centers[turned] = _mean_polar(corners, radius, quads[turned])
    center = len(points) + np.arange(len(quads))
    cells = np.empty((len(quads), 3, 3), dtype=np.int64)
    cells[:, [0, 2, 2, 0], [0, 0, 2, 2]] = quads
    cells[:, [1, 2, 1, 0], [0, 1, 2, 1]] = number
    cells[:, 1, 1] = center
    return np.concatenate([points, centers]), cells


def _mean_polar(corners: Array, radius: Array, nodes: Array) -> Array:
    """Points (m, 2) at the mean radius and, of angles that are close, the mean angle of `nodes` (m, k)."""
    first = corners[nodes[:, :1]]
    x = corners[nodes]
    cross = first[..., 0] * x[..., 1] - first[..., 1] * x[..., 0]
    turn = np.arctan2(cross, np.sum(first * x, axis=-1)).mean(axis=1)
    angle = np.arctan2(first[:, 0, 1], first[:, 0, 0]) + turn
    return _plane(radius[nodes].mean(axis=1), angle)


# --- the solid over a disc ---


def standing_points(points: Array, radius: Array, y: Array) -> Array:
    """Points (n * rows, 3) [m] of the disc's `points` (n, 2) at `y` (rows,) [m], where it has `radius` (rows,) [m]."""
    p, q = np.multiply.outer(points.T, radius)
    return np.stack([p, np.broadcast_to(y, p.shape), -q], axis=-1).reshape(-1, 3)  # q runs along e_1 = -z


def standing_cells(section: Disc, axial: int, order: int) -> tuple[dict[str, Array], dict[str, FacetSet]]:
    """Cells, and facet sets `rim`, `ends`, `end_low`, `end_high`, `journal_low`, `journal_high`, of nodes numbered by
    node of the disc and axial row: `axial` cells on each of the disc's."""
    kind = cell_kind(KINDS[order])
    # reference coordinates -1, 0, 1 become grid offsets 0, (1,) order
    offset = np.rint(0.5 * order * (kind.nodes + 1.0)).astype(np.int64)
    row = order * np.arange(axial)[:, None] + offset[:, 2]
    nodes = section.cells[:, None, offset[:, 0], offset[:, 1]] * (order * axial + 1) + row
    ((facet, faces),) = kind.faces.items()  # order of faces: xi-, xi+, eta-, eta+, zeta-, zeta+
    low, high = nodes[:, 0][:, faces[4]], nodes[:, -1][:, faces[5]]
    sides = {
        "rim": nodes[: section.sectors][..., faces[1]].reshape(-1, faces.shape[1]),
        "ends": np.concatenate([low, high]),
        "end_low": low,
        "end_high": high,
        "journal_low": low[section.core :],
        "journal_high": high[section.core :],
    }
    cells = {kind.name: nodes.reshape(-1, nodes.shape[-1])}
    return cells, {name: FacetSet({facet: side}) for name, side in sides.items()}


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

    The third axis runs down from the top, which both share. `outer` has the shape of `inner`; only its five faces are
    used; `fractions` (s,) run from 0 to 1. Lattice axes of the shells: two along the face, then outwards.
    """
    faces = [np.s_[0, :, :], np.s_[-1, :, :], np.s_[:, 0, :], np.s_[:, -1, :], np.s_[:, :, -1]]
    f = fractions[:, None]
    return [inner, *((1.0 - f) * inner[face][:, :, None] + f * outer[face][:, :, None] for face in faces)]


def nest_tops(first: int = 0) -> list[Face]:
    """Faces of a nest's lattices, numbered from `first`, that form its top: the brick's, and those of the shells."""
    return [(first, 2, 0), *((first + shell, 1, 0) for shell in range(1, 5))]


def shell_fractions(start: float, end: float, cell: float, growth: float, order: int) -> Array:
    """Fractions (s,) of the distance from half-width `start` to `end` [m] at which shells, and their mid nodes, lie.

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
