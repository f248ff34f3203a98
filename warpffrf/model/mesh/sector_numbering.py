r"""A rotationally periodic body numbered sector by sector.

A node is known by its orbit o and its place s in it: it is the orbit's first node turned by s phi, at the angle
`u = k_o + f_o + s` in units of phi, k_o whole and 0 <= f_o < 1. A numbering chooses one whole shift d_o for every
orbit; the node then belongs to sector `sigma = k_o + s - d_o` modulo N. The reduction needs every cell to use nodes of
two neighbouring sectors at most: over the nodes a, b of each cell

    sigma_a - sigma_b <= 1      for all a, b.

*Plane cuts*: `d_o = [f_o < c]` puts sector 0 between the half planes at c and c + 1. A cell no wider than phi then
meets two sectors at most. Cuts are tried in the widest gaps of f, and in front of its most frequent values (the node
planes of a body that was meshed sector by sector); the one across which the fewest nodes are shared wins.

*Bent cuts*, where cells are wider than a sector (skewed sectors): the inequalities are difference constraints on d, and
raising d where one is violated until none is solves them whenever they can be solved (Bellman 1958, Quart. Appl. Math.
16, 87).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from warpffrf.model.mesh.cyclic import Cyclic
from warpffrf.model.mesh.facets import FacetSet

if TYPE_CHECKING:
    from warpffrf.model.mesh.data import Mesh

CUTS = (
    12  # widest gaps and most frequent angles tried each: a structured sector has as many planes, or a gap is as good
)
SAME_ANGLE = 1e-5  # of a sector: node planes that only the file's digits separate; cells are 1e-3 of it wide at least
MARGIN = 0.1  # of a sector: cells this far outside it are looked at too, so that round-off loses none
ROUNDS = 500  # of raising shifts; each settles one more row of cells, and a bent cut is a few rows long

Array = np.ndarray


class NotPeriodic(Exception):
    """Why a mesh cannot be numbered by sectors."""


@dataclass(frozen=True, eq=False)
class Orbits:
    """`nodes` (N, nn): node s of orbit o is the orbit's first turned by s phi. `base` (nn, 3) [m]: the first node's
    place, the mean of all turned back, in axes whose third is the axis; `largest_move` [m] of a node onto its place."""

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
            raise NotPeriodic(f"turned by 1/{N} of a turn some nodes come back to themselves before a full turn")
        chain = [np.unique(label, return_index=True)[1]]
        for _ in range(N - 1):
            chain.append(image[chain[-1]])
        return cls(np.stack(chain), np.zeros((count, 3)))

    def axis(self, local: Array) -> Array:
        """Unit axis (3,) that the orbits turn about, from positions `local` (n, 3), sign as the third axis."""
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
    """Positions (n, 3) turned by s/N of a turn about the third axis."""
    angle = 2.0 * np.pi * (s % N) / N
    c, sine = np.cos(angle), np.sin(angle)
    return np.stack([c * x[:, 0] - sine * x[:, 1], sine * x[:, 0] + c * x[:, 1], x[:, 2]], axis=1)


def numbered(mesh: Mesh, orbits: Orbits, origin: Array, frame: Array) -> tuple[Mesh, Array]:
    """`mesh` numbered by sectors about the third row of `frame` through `origin`, and each node's old number (n,).

    Sector 0 begins nearest to the first row of `frame`. Within a sector nodes are numbered by angle, radius and height.
    Cells, and facet sets that turn into themselves, follow; other facet sets keep their order. Raises `NotPeriodic`
    where a cell needs more than two sectors.
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
    for s in np.unique(sector[0] % N):  # place of the orbit's node in sector 0: its first one turned back by its sector
        which = sector[0] % N == s
        first[rank[which]] = turned(orbits.base[which], -int(s), N)
    points = np.concatenate([turned(first, s, N) for s in range(N)]) @ frame + origin

    blocks: dict[str, Array] = {}
    new_cell = np.empty(mesh.cell_count, dtype=np.int64)
    start = 0
    for kind, nodes in mesh.cells.items():
        rows = _by_sector(new_number[nodes], N, nn)
        if rows is None:
            raise NotPeriodic(f"its {kind} cells cannot be told apart by sectors")
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
    # + 0.0: no minus zero, and round-off of a zero is no news
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
    """Cells about sector 0, every cell of the body at least once up to a turn: per kind the orbits (m, k) of their
    nodes, and their whole angles k_o + s (m, k), counted on without a jump at a full turn."""
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
    """Rows of node numbers (m, k) ordered sector by sector, each with the local order of sector 0's, and the new place
    of each row (m,). None where they are not N turned copies of one another."""
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
