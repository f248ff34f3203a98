r"""Detection of rotational periodicity in a mesh: axis, number of sectors, and the images of nodes under rotation.

A body of N >= 3 equal sectors is mapped onto itself by a rotation by phi = 2 pi/N about its axis. So are its
nodes, hence

- the mean of the nodes lies on the axis, and the tensor of their second moments has it as an eigenvector, the two other
  eigenvalues being equal. Unequal ones exclude periodicity at the cost of one pass over the nodes;
- nodes at one radius and height about the axis form rings, and every ring holds a multiple of N nodes, every kind a
  multiple of N cells: N divides the greatest common divisor of all those counts. Its divisors are tried from the
  largest down;
- the rotation maps nodes onto nodes (nearest neighbours, a few nodes first) and cells onto cells. The sets of cells are
  compared by sums of random numbers assigned to the nodes: two different cells share a sum with probability 2^-64.

The nodes then fall into orbits of N. With x_s the s-th node of an orbit and c its mean, sum_s (x_s - c) x (x_{s+1} - c)
is parallel to the axis, exactly: summed over the orbits it gives the axis without the error of an eigenvector whose
eigenvalue is close to the others. Files carry few digits, so a node is replaced by the mean of its orbit's nodes
rotated back; the distance is reported, and refused above a tolerance.

A node on the axis is its own image and belongs to no sector: such bodies are treated as general ones.
`sector_numbering` chooses the sectors and numbers the body by them.

Cyclic. Numbering of a mesh of equal sectors, and their axis.

Sector numbering. A rotationally periodic body numbered sector by sector.

A node is identified by its orbit o and its index s in it: it is the orbit's first node rotated by s phi, at the angle
`u = k_o + f_o + s` in units of phi, k_o an integer and 0 <= f_o < 1. A numbering chooses one integer shift d_o for each
orbit; the node then belongs to sector `sigma = k_o + s - d_o` modulo N. The reduction needs every cell to use nodes of
two neighbouring sectors at most: over the nodes a, b of each cell

    sigma_a - sigma_b <= 1      for all a, b.

*Plane cuts*: `d_o = [f_o < c]` puts sector 0 between the half planes at c and c + 1. A cell no wider than phi then
meets two sectors at most. Cuts are tried in the widest gaps of f, and in front of its most frequent values (the node
planes of a body that was meshed sector by sector); the one across which the fewest nodes are shared is used.

*Bent cuts*, where cells are wider than a sector (skewed sectors): the inequalities are difference constraints on d, and
raising d where one is violated until none is solves them whenever they can be solved (Bellman 1958, Quart. Appl. Math.
16, 87).
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from warpffrf.model.errors import InputError, require_array, require_count, require_direction
from warpffrf.model.mesh.facets import FacetSet
from warpffrf.model.surfaces.fit import reference_direction, signed_axis

if TYPE_CHECKING:
    from warpffrf.model.mesh.data import Mesh

# Of the radius: how far a node may move onto its place. Coordinates with 6 digits stay below it, and a contact surface
# is accepted as round to the same fraction (surfaces.DEFAULT_FIT_FRACTION).
LARGEST_MOVE = 1e-5
SAME_PLACE = 4.0  # in LARGEST_MOVE: two nodes off by that much each, about an axis found from such nodes
SAME_MOMENT = 1e-5  # of the largest second moment: what coordinates off by LARGEST_MOVE change it by, at most
LEAST_SECTORS = 3  # with two, the axis is not an axis of symmetry of the moments, and harmonics 1 and N/2 coincide
PROBES = 64  # nodes rotated before all are: an N that is wrong for a fraction p of them passes with (1 - p)^64

Array = np.ndarray


@dataclass(frozen=True, eq=False)
class Detection:
    """A periodic body numbered by sectors, or the `reason` why it is none (`mesh` None).

    `node` (n,): number that each node of `mesh` had before. `largest_move` [m]: of a node onto its exact place.
    """

    mesh: Mesh | None
    reason: str
    node: Array
    largest_move: float


def detect(
    mesh: Mesh,
    *,
    axis_point: Any = None,
    axis_direction: Any = None,
    sectors: int | None = None,
    whole: Sequence[str] = (),
) -> Detection:
    """Detect rotational periodicity of the cells of `mesh`; axis and number of sectors are determined where None.

    `whole` names facet and cell sets that must be mapped onto themselves as well (interfaces, materials): the number of
    sectors is then the largest for which they are. Raises `InputError` for invalid arguments only.
    """
    point = None if axis_point is None else require_array(axis_point, "periodicity: axis_point", (3,))
    axis = None if axis_direction is None else require_direction(axis_direction, "periodicity: axis_direction")
    count = None if sectors is None else require_count(sectors, "periodicity: sectors", LEAST_SECTORS)
    for name in whole:
        if name not in mesh.facet_sets and name not in mesh.cell_sets:
            raise InputError(f"periodicity: {name!r} is neither a facet set nor a cell set of the mesh")
    try:
        return _detect(mesh, point, axis, count, whole)
    except NotPeriodic as reason:
        return Detection(None, str(reason), np.arange(len(mesh.points)), 0.0)


def find(mesh: Mesh) -> Cyclic | None:
    """Axis and largest number of equal sectors of the cells of `mesh`, or None."""
    if mesh.cyclic is not None:
        return mesh.cyclic
    found = detect(mesh).mesh
    return None if found is None else found.cyclic


def required(mesh: Mesh, *, axis_point: Any, axis_direction: Any, sectors: int | None) -> Mesh:
    """`mesh` numbered by sectors; raises `InputError` with the reason where it is not periodic."""
    found = detect(mesh, axis_point=axis_point, axis_direction=axis_direction, sectors=sectors)
    if found.mesh is None:
        raise InputError(f"mesh {mesh.name or '(unnamed)'} is not rotationally periodic: {found.reason}")
    return found.mesh


def _detect(mesh: Mesh, point: Array | None, axis: Array | None, count: int | None, whole: Sequence[str]) -> Detection:
    if mesh.structure.parts:
        raise NotPeriodic("it has shells, beams or other structural elements, whose periodicity is not detected")
    if not mesh.cells or mesh.matrices is not None:
        raise NotPeriodic("it is given by matrices, whose periodicity is not detected")
    center = mesh.points.mean(axis=0)
    reason: NotPeriodic | None = None
    for direction in _axes(mesh.points - center) if axis is None else [axis]:
        try:
            return _about(mesh, center, point, direction, axis is None, count, whole)
        except NotPeriodic as fault:
            reason = reason or fault
    raise reason or NotPeriodic("no axis was found")


def _axes(relative: Array) -> list[Array]:
    """Directions that can be the axis, for positions relative to the mean of all nodes."""
    w, V = np.linalg.eigh(relative.T @ relative)
    same = np.diff(w) <= SAME_MOMENT * w[2]
    if same.all():  # moments of a sphere: any direction can be the axis; bodies are mostly drawn along one of x, y, z
        return [*np.eye(3), *V.T]
    if same.any():
        return [signed_axis(V[:, 2] if same[0] else V[:, 0])]
    raise NotPeriodic(
        f"the second moments of its nodes are all different ({', '.join(f'{v / w[2]:.6f}' for v in w)}), so it has no "
        "axis of symmetry"
    )


def _about(
    mesh: Mesh,
    center: Array,
    point: Array | None,
    axis: Array,
    free_axis: bool,
    count: int | None,
    whole: Sequence[str],
) -> Detection:
    """Detection about one direction; the axis passes through `point`, or through `center` where that is None."""
    origin = center if point is None else point
    frame = _frame(axis)
    local = (mesh.points - origin) @ frame.T
    radius = np.hypot(local[:, 0], local[:, 1])
    R = float(radius.max())
    close = SAME_PLACE * LARGEST_MOVE * R
    off = (center - origin) - ((center - origin) @ axis) * axis
    if np.linalg.norm(off) > close:
        raise NotPeriodic(f"the mean of its nodes lies {np.linalg.norm(off):.3g} m off the axis")
    on_axis = int(np.sum(radius <= close))
    if on_axis:
        raise NotPeriodic(f"{on_axis} of its nodes lie on the axis and belong to no sector")
    reason = NotPeriodic("no number of sectors maps its nodes onto one another")
    for N in _counts(mesh, radius, local[:, 2], close, count):
        try:
            orbits = _orbits(mesh, local, N, close, whole)
            # orbits know the axis better than the moments do
            exact = orbits.axis(local) @ frame if free_axis else axis
            frame_N = _frame(exact)
            orbits = orbits.placed((mesh.points - origin) @ frame_N.T)
            if orbits.largest_move > LARGEST_MOVE * R:
                raise NotPeriodic(
                    f"its nodes would have to move by up to {orbits.largest_move:.3g} m to be periodic in {N} sectors, "
                    f"{LARGEST_MOVE * R:.3g} m is accepted"
                )
            by_sector, node = numbered(mesh, orbits, origin, frame_N)
        except NotPeriodic as fault:
            reason = fault
            continue
        return Detection(by_sector, f"{N} equal sectors", node, orbits.largest_move)
    raise reason


def _frame(axis: Array) -> Array:
    """Rows e_0, e_1, axis of a right-handed frame."""
    e_0 = reference_direction(axis)
    return np.stack([e_0, np.cross(axis, e_0), axis])


def _counts(mesh: Mesh, radius: Array, height: Array, close: float, count: int | None) -> Iterator[int]:
    """Numbers of sectors to try, the largest first."""
    by_radius = np.argsort(radius)
    band = np.empty(len(radius), dtype=np.int64)
    band[by_radius] = np.cumsum(np.diff(radius[by_radius], prepend=radius[by_radius[0]]) > close)
    order = np.lexsort((height, band))
    new_ring = (np.diff(band[order]) > 0) | (np.diff(height[order]) > close)
    rings = np.diff(np.flatnonzero(np.concatenate([[True], new_ring, [True]])))
    of_nodes = int(np.gcd.reduce(rings))
    common = int(np.gcd.reduce([of_nodes, *(len(nodes) for nodes in mesh.cells.values())]))
    if count is not None:
        if common % count:
            raise NotPeriodic(
                f"its rings of nodes about the axis and its cells come in multiples of {common}, not of {count}"
            )
        return iter([count])
    if common < LEAST_SECTORS:
        raise NotPeriodic(
            f"rings of nodes about the axis and cells have counts with the greatest common divisor {common}, fewer "
            f"than {LEAST_SECTORS} sectors"
        )
    low = [d for d in range(1, int(np.sqrt(common)) + 1) if common % d == 0]
    divisors = sorted({d for a in low for d in (a, common // a)}, reverse=True)
    return iter([d for d in divisors if d >= LEAST_SECTORS])


def _orbits(mesh: Mesh, local: Array, N: int, close: float, whole: Sequence[str]) -> Orbits:
    """Orbits of the nodes under a rotation by 2 pi/N that maps nodes, cells and `whole` sets onto themselves."""
    from scipy.spatial import KDTree

    n = len(local)
    moved = turned(local, 1, N)
    tree = KDTree(local)
    rng = np.random.default_rng(0)
    image = np.zeros(0, dtype=np.int64)
    for which in (rng.choice(n, min(n, PROBES), replace=False), np.arange(n)):
        distance, nearest = tree.query(moved[which], distance_upper_bound=close)
        image = np.asarray(nearest)
        missed = int(np.sum(~np.isfinite(distance)))
        if missed:
            raise NotPeriodic(
                f"rotated by 1/{N} of a revolution, {missed} of {len(which)} tested nodes meet no other node"
            )
    if np.any(np.bincount(image, minlength=n) != 1):
        raise NotPeriodic(f"rotated by 1/{N} of a revolution, two nodes meet the same node")
    tag = rng.integers(0, 2**64, n, dtype=np.uint64)
    groups = [(f"{kind} cells", nodes) for kind, nodes in mesh.cells.items()]
    for name in whole:
        if name in mesh.facet_sets:
            groups += [(f"facets of {name!r}", nodes) for nodes in mesh.facet_sets[name].blocks.values()]
        if name in mesh.cell_sets:
            marked = np.zeros(mesh.cell_count, dtype=bool)
            marked[mesh.cell_sets[name]] = True
            groups += [(f"cells of {name!r}", mesh.cells[kind][part]) for kind, part in mesh.by_block(marked)]
    for what, nodes in groups:
        before, after = (np.sort(sums(tags, nodes)) for tags in (tag, tag[image]))
        if not np.array_equal(before, after):
            raise NotPeriodic(f"rotated by 1/{N} of a revolution its nodes meet nodes, but not all {what} meet {what}")
    return Orbits.of(image, N)


@dataclass(frozen=True, eq=False)
class Cyclic:
    """Rotational periodicity: `sectors` equal sectors about the line `axis_point` + t `axis_direction` (user frame, m).

    Numbering is sector-major: with `nn` nodes per sector, node `s*nn + i` is node `i` rotated by `2 pi s / sectors`,
    right-handed about `axis_direction`; cells and full facet sets likewise.
    """

    sectors: int
    axis_point: np.ndarray
    axis_direction: np.ndarray

    def __post_init__(self) -> None:
        object.__setattr__(self, "sectors", require_count(self.sectors, "cyclic: sectors", 3))
        object.__setattr__(self, "axis_point", require_array(self.axis_point, "cyclic: axis_point", (3,)))
        direction = require_direction(self.axis_direction, "cyclic: axis_direction")
        object.__setattr__(self, "axis_direction", direction)


CUTS = (
    12  # widest gaps and most frequent angles tried each: a structured sector has as many planes, or a gap is as good
)
SAME_ANGLE = 1e-5  # of a sector: node planes that only the file's digits separate; cells are 1e-3 of it wide at least
MARGIN = 0.1  # of a sector: cells this far outside it are included, so that round-off loses none
ROUNDS = 500  # of raising shifts; each satisfies one more row of cells, and a bent cut is a few rows long


class NotPeriodic(Exception):
    """Why a mesh cannot be numbered by sectors."""


@dataclass(frozen=True, eq=False)
class Orbits:
    """`nodes` (N, nn): node s of orbit o is the orbit's first node rotated by s phi. `base` (nn, 3) [m]: position of
    the first node, the mean of all nodes rotated back, in axes whose third is the axis of rotation; `largest_move` [m]
    of a node to its exact position."""

    nodes: Array
    base: Array
    largest_move: float = 0.0

    @classmethod
    def of(cls, image: Array, N: int) -> Orbits:
        """Orbits of the permutation `image`; raises `NotPeriodic` unless all have N nodes."""
        from scipy.sparse import csr_matrix
        from scipy.sparse.csgraph import connected_components

        n = len(image)
        graph = csr_matrix((np.ones(n, dtype=np.int8), image, np.arange(n + 1)), shape=(n, n))
        count, label = connected_components(graph, directed=False)
        if count * N != n or np.any(np.bincount(label) != N):
            raise NotPeriodic(
                f"rotated by 1/{N} of a revolution some nodes return to their positions before a full revolution"
            )
        chain = [np.unique(label, return_index=True)[1]]
        for _ in range(N - 1):
            chain.append(image[chain[-1]])
        return cls(np.stack(chain), np.zeros((count, 3)))

    def axis(self, local: Array) -> Array:
        """Unit axis (3,) of rotation of the orbits, from positions `local` (n, 3), sign as the third axis."""
        x = local[self.nodes] - local[self.nodes].mean(axis=0)
        area = np.cross(x, np.roll(x, -1, axis=0)).sum(axis=(0, 1))
        return area / np.linalg.norm(area)

    def placed(self, local: Array) -> Orbits:
        """The same orbits with `base` and `largest_move` from positions `local` (n, 3) [m]."""
        N = len(self.nodes)
        back = np.stack([turned(local[row], -s, N) for s, row in enumerate(self.nodes)])
        base = back.mean(axis=0)
        return replace(self, base=base, largest_move=float(np.sqrt(np.max(np.sum((back - base) ** 2, axis=2)))))


def turned(x: Array, s: int, N: int) -> Array:
    """Positions (n, 3) rotated by s/N of a revolution about the third axis."""
    angle = 2.0 * np.pi * (s % N) / N
    c, sine = np.cos(angle), np.sin(angle)
    return np.stack([c * x[:, 0] - sine * x[:, 1], sine * x[:, 0] + c * x[:, 1], x[:, 2]], axis=1)


def numbered(mesh: Mesh, orbits: Orbits, origin: Array, frame: Array) -> tuple[Mesh, Array]:
    """`mesh` numbered by sectors about the third row of `frame` through `origin`, and each node's old number (n,).

    Sector 0 begins nearest to the first row of `frame`. Within a sector nodes are numbered by angle, radius and height.
    Cells, and facet sets that are mapped onto themselves, follow; other facet sets keep their order. Raises
    `NotPeriodic` where a cell needs more than two sectors.
    """
    N, nn = orbits.nodes.shape
    angle = np.arctan2(orbits.base[:, 1], orbits.base[:, 0]) * N / (2.0 * np.pi)
    gap = _widest_gap(angle % 1.0)
    whole = np.floor(angle - gap).astype(np.int64)
    f = angle - gap - whole
    cells = _one_sector(mesh, orbits, whole, f)
    cut, d = _best_cut(cells, f, gap)
    begin = gap + float(f[f >= cut].min())
    sector_0 = round(-begin)  # number, counted from `gap`, of the sector that begins nearest to e_0
    sector = (whole - d - sector_0)[None, :] + np.arange(N)[:, None]
    key = f + d - cut  # angle from the cut on
    rank = np.empty(nn, dtype=np.int64)
    radius = np.hypot(orbits.base[:, 0], orbits.base[:, 1])
    size = float(radius.max())
    order = np.lexsort((orbits.base[:, 2], _classes(radius, SAME_ANGLE * size), _classes(key, SAME_ANGLE)))
    rank[order] = np.arange(nn)

    new_number = np.empty(N * nn, dtype=np.int64)
    new_number[orbits.nodes] = (sector % N) * nn + rank
    old_number = np.argsort(new_number)
    first = np.empty((nn, 3))
    for s in np.unique(sector[0] % N):  # position of the orbit's node in sector 0: its first one rotated back
        which = sector[0] % N == s
        first[rank[which]] = turned(orbits.base[which], -int(s), N)
    points = np.concatenate([turned(first, s, N) for s in range(N)]) @ frame + origin

    blocks: dict[str, Array] = {}
    new_cell = np.empty(mesh.cell_count, dtype=np.int64)
    start = 0
    for kind, nodes in mesh.cells.items():
        rows = _by_sector(new_number[nodes], N, nn)
        if rows is None:
            raise NotPeriodic(f"its {kind} cells cannot be distinguished by sectors")
        blocks[kind], place = rows
        new_cell[start : start + len(nodes)] = start + place
        start += len(nodes)
    facet_sets = {}
    for name, facets in mesh.facet_sets.items():
        moved = facets.renumbered(new_number)
        ordered = {kind: _by_sector(nodes, N, nn) for kind, nodes in moved.blocks.items()}
        facet_sets[name] = FacetSet(
            {kind: nodes if (o := ordered[kind]) is None else o[0] for kind, nodes in moved.blocks.items()}
        )
    # + 0.0: no minus zero; round-off of a zero is removed
    where = ", ".join(f"{x + 0.0:.6g}" for x in np.round(origin / size, 9) * size)
    along = ", ".join(f"{x + 0.0:.6g}" for x in np.round(frame[2], 9))
    note = (
        f"numbered in {N} equal sectors about the axis through ({where}) m along ({along}); nodes moved by at most "
        f"{orbits.largest_move:.2g} m"
    )
    result = replace(
        mesh,
        points=points,
        cells=blocks,
        facet_sets=facet_sets,
        cyclic=Cyclic(N, origin, frame[2]),
        cell_sets={name: new_cell[members] for name, members in mesh.cell_sets.items()},
        notes=(*mesh.notes, note),
    )
    return result, old_number


def _widest_gap(fractions: Array) -> float:
    """Middle of the widest gap of angles on the circle of circumference 1."""
    x = np.sort(fractions)
    gaps = np.diff(x, append=x[0] + 1.0)
    i = int(np.argmax(gaps))
    return float(x[i] + 0.5 * gaps[i]) % 1.0


def _one_sector(mesh: Mesh, orbits: Orbits, whole: Array, f: Array) -> list[tuple[Array, Array]]:
    """Cells about sector 0, every cell of the body at least once up to a rotation: per kind the orbits (m, k) of their
    nodes, and their integer angles k_o + s (m, k), continuous across a full revolution."""
    N, nn = orbits.nodes.shape
    orbit, place = np.empty(N * nn, dtype=np.int64), np.empty(N * nn, dtype=np.int64)
    orbit[orbits.nodes] = np.arange(nn)
    place[orbits.nodes] = np.arange(N)[:, None]
    angle = (whole + f)[orbit] + place
    radius = np.hypot(orbits.base[:, 0], orbits.base[:, 1])[orbit]
    wave = radius * np.exp(2j * np.pi * angle / N)
    found = []
    for nodes in mesh.cells.values():
        middle = np.angle(wave[nodes].mean(axis=1)) * N / (2.0 * np.pi)
        near = nodes[(middle >= -MARGIN) & (middle <= 1.0 + MARGIN)]
        middle = middle[(middle >= -MARGIN) & (middle <= 1.0 + MARGIN)]
        turns = np.rint((middle[:, None] - angle[near]) / N).astype(np.int64)
        found.append((orbit[near], whole[orbit[near]] + place[near] + N * turns))
    return found


def _best_cut(cells: Sequence[tuple[Array, Array]], f: Array, gap: float) -> tuple[float, Array]:
    """The cut in the angles `f` and the orbits' shifts d (nn,)."""
    x = np.sort(f)
    # values of f that differ by more than round-off, how often each occurs, and the gap in front of it
    starts = np.flatnonzero(np.diff(x, prepend=-1.0) > SAME_ANGLE)
    often = np.diff(starts, append=len(x))
    before = np.where(starts > 0, x[starts] - x[starts - 1], 2.0)
    chosen = np.unique(np.concatenate([np.argsort(-before)[:CUTS], np.argsort(-often)[:CUTS]]))
    cuts = [0.5 * (x[starts[i]] + x[starts[i] - 1]) if starts[i] else 0.0 for i in chosen]
    # equally good cuts: the one whose first plane is nearest to the reference direction
    first = np.array([x[starts[i]] + gap for i in chosen])
    best: tuple[int, float] | None = None
    found, widest_found = 0.0, (np.inf, 0.0)
    for cut, nearness in zip(cuts, np.abs(first - np.rint(first)), strict=True):
        d = (f < cut).astype(np.int64)
        shared = np.zeros(len(f), dtype=bool)
        widest = 0
        for orbit, angle in cells:
            sigma = angle - d[orbit]
            low = sigma.min(axis=1, keepdims=True)
            widest = max(widest, int((sigma - low).max(initial=0)))
            shared[orbit[sigma > low]] = True
        widest_found = min(widest_found, (widest, float(cut)))
        score = (int(shared.sum()), round(float(nearness), 6))
        if widest <= 1 and (best is None or score < best):
            best, found = score, float(cut)
    if best is not None:
        return found, (f < found).astype(np.int64)
    return widest_found[1], _bent(cells, (f < widest_found[1]).astype(np.int64))


def _bent(cells: Sequence[tuple[Array, Array]], d: Array) -> Array:
    """Shifts that keep every cell within two sectors, raised from `d`; raises `NotPeriodic` where there are none."""
    d = d.copy()
    for _ in range(ROUNDS):
        settled = True
        for orbit, angle in cells:
            sigma = angle - d[orbit]
            excess = sigma - sigma.min(axis=1, keepdims=True) - 1
            wide = excess > 0
            if wide.any():
                settled = False
                np.maximum.at(d, orbit[wide], d[orbit[wide]] + excess[wide])
        if settled:
            return d
    raise NotPeriodic("its cells reach over more than two sectors")


def _by_sector(nodes: Array, N: int, nn: int) -> tuple[Array, Array] | None:
    """Rows of node numbers (m, k) ordered sector by sector, each with the local order of sector 0's, and the new index
    of each row (m,). None where they are not N rotated copies of one another."""
    sector = nodes // nn
    home = sector[:, 0]
    home = np.where(((sector - home[:, None]) % N == N - 1).any(axis=1), home - 1, home) % N
    own = (nodes - nn * home[:, None])[home == 0]
    if np.any((sector - home[:, None]) % N > 1) or len(own) * N != len(nodes):
        return None
    turned_back = (nodes - nn * home[:, None]) % (N * nn)
    tags = np.random.default_rng(1).integers(0, 2**64, 2 * nn, dtype=np.uint64)
    order = np.argsort(sums(tags, own))
    key, known = sums(tags, turned_back), sums(tags, own[order])
    match = order[np.minimum(np.searchsorted(known, key), len(own) - 1)]
    if not np.array_equal(np.sort(turned_back, axis=1), np.sort(own, axis=1)[match]):
        return None
    place = home * len(own) + match
    if np.any(np.bincount(place, minlength=len(nodes)) != 1):
        return None
    shift = nn * np.arange(N)[:, None, None]
    return ((own[None] + shift) % (N * nn)).reshape(nodes.shape), place


def sums(tags: Array, nodes: Array) -> Array:
    """Sum (m,) modulo 2^64 of the tags of each row's nodes: the same for the same nodes in any order."""
    return tags[nodes].sum(axis=1, dtype=np.uint64)


def _classes(values: Array, close: float) -> Array:
    """Number (n,) of the group of nearly equal values that each one belongs to, groups in ascending order."""
    order = np.argsort(values)
    group = np.empty(len(values), dtype=np.int64)
    group[order] = np.cumsum(np.diff(values[order], prepend=values[order[0]]) > close)
    return group
