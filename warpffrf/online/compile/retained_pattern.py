r"""Sparsity of the matrix of retained coordinates of a scene, and the order of its elimination
(`warpffrf_kernels.linear.retained_solve`).

The retained matrix [[S, C^T], [C, -E]] (`warpffrf_kernels.linear.retained`) couples few of its unknowns: S has a block
for each body (six rigid coordinates and the modes that carry inertia) and one for each two bodies that share a row; C
has in a row the blocks of its two bodies; E couples rows that end on one flexible body; the nodes of a contact pair,
which are eliminated first, couple its two bodies and the rows on their interfaces. With a good order the factors are
hardly larger: a chain or a tree of n bodies costs O(n).

Unknowns are grouped in *nodes*, one for each body and one for all rows between the same two bodies; rows between two
interfaces of one body are grouped with those between it and the ground, as they end on it alone. The order is computed
here once, before the numbers are known, and there is no pivoting outside a node. Existence of the pivots: take a
spanning tree over the bodies, from the ground, with a row node as edge (the *tree node* of the body below). Eliminate

    a body            after all bodies below it in the tree,
    its tree node     after the body,
    another row node  after all bodies on the paths from its two up to where they meet, and their tree nodes.

Let B be the bodies and R the rows eliminated so far. S is positive definite on B (inertia), and C restricted to R and B
has independent rows: the tree rows of a body connect it to the one above, so they are independent on its own columns
and those below have entries of their own; and the other rows depend on no joint that is not on their paths, so they are
independent of each other and of the tree's as they are in the whole (redundant rows were removed,
`warpffrf.model.checks.redundancy`). So [[S, C^T], [C, -E]] on B and R is regular at every stage, as a block
factorisation without pivoting requires. Springs make E positive and pressures add to S; both only help. Geometric
stiffness can make S indefinite, a characteristic with negative slope makes its entry of E negative; where that matters
the factorisation or its residual fails, and the dense inverse is used for that step and counted.

Among the admissible nodes, the one with the fewest neighbours (minimum degree) comes first.
"""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass
from typing import Any

import numpy as np
import warp as wp

from warpffrf.model.errors import InputError
from warpffrf.online.compile.scene import CompiledScene
from warpffrf.online.settings import LARGEST_INDEX
from warpffrf_kernels.linear.sparse_factor import Pattern

GROUND = -1


@dataclass(frozen=True)
class Node:
    """Unknowns that are eliminated together: those of a body, or of all rows between two bodies."""

    unknowns: np.ndarray  # indices in the retained vector
    bodies: tuple[int, ...]  # whose columns it involves, without the ground


@dataclass(frozen=True)
class RetainedPattern:
    """Order and indices of a sparse factorisation of the retained matrix; all arrays of int32.

    Node e, in the order of elimination, has `size[e]` unknowns from place `first[e]` on (places: positions in that
    order; `order[place]` is the position in the retained vector) and couples to `width[e]` places after it, `panel`,
    from `panel_start[e]` on. Its numbers lie from `start[e]` on in the factor: the diagonal block (size, size), then
    the coupling of its lines to the panel (size, width), then that of the panel's lines to it, transposed (size,
    width).
    """

    retained_count: int
    order: np.ndarray  # (retained_count,)
    size: np.ndarray  # (nodes,)
    width: np.ndarray
    first: np.ndarray
    start: np.ndarray
    panel_start: np.ndarray
    panel: np.ndarray  # places
    target_start: np.ndarray
    target: np.ndarray  # (width, width) per node: positions in the factor of its update of the panel's places
    # (factor_size,) line and column of the retained matrix of each number of the factor, -1: fill
    gather_line: np.ndarray
    gather_column: np.ndarray
    entry_start: np.ndarray  # (retained_count + 1,) the same by lines: columns of the entries of each line
    entry_column: np.ndarray
    row_start: np.ndarray  # (bodies + 1,) rows with entries on the columns of each body
    row: np.ndarray
    row_flexible: np.ndarray  # 1 where such a row ends on an interface of the body

    @property
    def factor_size(self) -> int:
        """Numbers in the factor."""
        return len(self.gather_line)

    @property
    def widest(self) -> int:
        """Largest `width`."""
        return int(self.width.max(initial=1))


NO_COUPLES = np.zeros((0, 2), dtype=int)


def find_pattern(
    body_count: int,
    dense: np.ndarray,
    rows: np.ndarray,
    flexible: np.ndarray,
    pairs: np.ndarray = NO_COUPLES,
    couples: np.ndarray = NO_COUPLES,
) -> RetainedPattern:
    """Pattern of a scene.

    dense (bodies,): retained modes of each body. rows (rows, 2): bodies of each row, -1 for the ground.
    flexible (rows, 2): true where the row ends on an interface of a flexible body. pairs (pairs, 2): bodies in contact.
    couples (couples, 2): bodies whose columns have a block in common without a row, -1 for the ground.
    """
    nodes = _nodes(body_count, np.asarray(dense), np.asarray(rows).reshape(-1, 2))
    ends = np.asarray(rows).reshape(-1, 2), np.asarray(flexible).reshape(-1, 2)
    near = _neighbours(nodes, body_count, *ends, np.asarray(pairs).reshape(-1, 2))
    for a, b in np.asarray(couples)[np.all(np.asarray(couples) != GROUND, axis=1)]:
        near[a].add(int(b))
        near[b].add(int(a))
    waits = _waits(nodes, body_count)
    sequence, later = _eliminate(nodes, near, waits)
    return _places(nodes, near, sequence, later, body_count, np.asarray(rows).reshape(-1, 2), np.asarray(flexible))


def pattern_of(compiled: CompiledScene) -> RetainedPattern:
    """Pattern of a compiled scene."""
    return find_pattern(compiled.model.bodies.count, *couplings(compiled))


def couplings(compiled: CompiledScene) -> tuple[np.ndarray, ...]:
    """Data that determine the pattern of a compiled scene, see `find_pattern`: dense, rows, flexible, pairs,
    couples.
    """
    m = compiled.model
    dense = m.bodies.dense_count.numpy()[: m.bodies.count] if m.dense.count else np.zeros(m.bodies.count, int)
    ends = np.stack([m.rows.a.numpy(), m.rows.b.numpy()], axis=1)[: m.rows.count]
    bodies, interfaces = m.markers.body.numpy(), m.markers.interface.numpy()
    of = m.surfaces.body.numpy()
    sides = np.stack([m.pairs.first.numpy(), m.pairs.second.numpy()], axis=1)[: m.pairs.count]
    couples = np.concatenate(
        [
            *(
                of[np.stack([kind.first.numpy(), kind.second.numpy()], axis=1)[: kind.count].astype(int)]
                for kind in (compiled.elements.lumped, compiled.films)
            ),
            _contacts_of(compiled),
        ]
    )
    return dense, bodies[ends], interfaces[ends] >= 0, of[sides.astype(int)], couples.astype(int)


def _contacts_of(compiled: CompiledScene) -> np.ndarray:
    """Pairs of bodies (pairs, 2) that small-sliding contacts couple: all of a group."""
    matched, m = compiled.matched, compiled.model
    found = [NO_COUPLES]
    for group in range(matched.count):
        start, end = matched.retained_start.numpy()[group : group + 2]
        retained = matched.retained.numpy()[start:end]
        rigid = retained[retained < 6 * m.bodies.count] // 6
        modal = m.dense.body.numpy()[retained[retained >= 6 * m.bodies.count] - 6 * m.bodies.count]
        bodies = np.unique(np.concatenate([rigid, modal]))
        found.append(np.array([(a, b) for a in bodies for b in bodies if a < b], dtype=int).reshape(-1, 2))
    return np.concatenate(found)


def on_device(pattern: RetainedPattern, device: str) -> tuple[Any, wp.array]:
    """The pattern on the device: the struct, which owns its arrays and must be kept, and an array of it."""
    p = Pattern()
    p.node_count, p.retained_count = len(pattern.size), pattern.retained_count
    p.factor_size, p.widest = pattern.factor_size, pattern.widest
    for name in (
        "order", "size", "width", "first", "start", "panel_start", "panel", "target_start", "target", "gather_line",
        "gather_column", "entry_start", "entry_column", "row_start", "row", "row_flexible",
    ):  # fmt: skip
        values = np.ascontiguousarray(getattr(pattern, name), dtype=np.int32)
        setattr(p, name, wp.array(values if values.size else np.zeros(1, np.int32), dtype=int, device=device))
    return p, wp.array([p], dtype=Pattern, device=device)


# --- the graph of nodes


def _nodes(body_count: int, dense: np.ndarray, rows: np.ndarray) -> list[Node]:
    nodes = []
    dense_start = 6 * body_count + np.concatenate([[0], np.cumsum(dense)]).astype(int)
    for b in range(body_count):
        unknowns = np.concatenate([np.arange(6 * b, 6 * b + 6), np.arange(dense_start[b], dense_start[b + 1])])
        nodes.append(Node(unknowns, (b,)))
    between: dict[tuple[int, ...], list[int]] = {}
    for r, pair in enumerate(rows):
        between.setdefault(tuple(sorted({int(b) for b in pair if b != GROUND})), []).append(r)
    row_offset = int(dense_start[-1])
    nodes += [Node(row_offset + np.array(r, dtype=int), bodies) for bodies, r in between.items()]
    return nodes


def _neighbours(
    nodes: list[Node], body_count: int, rows: np.ndarray, flexible: np.ndarray, pairs: np.ndarray
) -> list[set[int]]:
    """Nodes with a block in common with each node."""
    near: list[set[int]] = [set() for _ in nodes]
    ends_on: dict[int, set[int]] = {}  # flexible body -> row nodes on its interfaces
    row_offset = min((int(n.unknowns[0]) for n in nodes[body_count:]), default=0)
    for e in range(body_count, len(nodes)):
        group = set(nodes[e].bodies) | {e}
        for x in group:
            near[x] |= group - {x}
        for r in nodes[e].unknowns - row_offset:
            for side in range(2):
                if flexible[r, side] and rows[r, side] != GROUND:
                    ends_on.setdefault(int(rows[r, side]), set()).add(e)
    touching = [{int(b) for b in pair if b != GROUND} for pair in pairs]
    touching = [group.union(*(ends_on.get(b, set()) for b in group)) for group in touching]
    for group in [*ends_on.values(), *touching]:
        for x in group:
            near[x] |= group - {x}
    return near


def _waits(nodes: list[Node], body_count: int) -> list[set[int]]:
    """Nodes that must be eliminated before each node, see above."""
    parent, edge, depth = _spanning_tree(nodes, body_count)
    waits: list[set[int]] = [set() for _ in nodes]
    for b in range(body_count):
        if parent[b] >= 0:
            waits[parent[b]].add(b)
            if edge[b] >= 0:
                waits[edge[b]].add(b)
        elif edge[b] >= 0:
            waits[edge[b]].add(b)
    tree = set(edge)
    for e in range(body_count, len(nodes)):
        if e in tree:
            continue
        ends = [*nodes[e].bodies, GROUND][:2]
        a, b = ends
        while a != b:  # climb to where the paths meet
            if (depth[a] if a != GROUND else -1) < (depth[b] if b != GROUND else -1):
                a, b = b, a
            waits[e] |= {a} | ({edge[a]} if edge[a] >= 0 else set())
            a = parent[a]
    return waits


def _spanning_tree(nodes: list[Node], body_count: int) -> tuple[list[int], list[int], list[int]]:
    """Parent, row node towards it, and depth of each body, breadth first; a part without ground has a body as root.

    The ground is the parent -1; so it is of a root body, which has no row node (-1).
    """
    touching: list[list[int]] = [[] for _ in range(body_count)]
    for e in range(body_count, len(nodes)):
        for b in nodes[e].bodies:
            touching[b].append(e)
    parent, edge, depth = [GROUND] * body_count, [-1] * body_count, [-1] * body_count
    queue: deque[int] = deque()
    for e in range(body_count, len(nodes)):
        if len(nodes[e].bodies) == 1 and depth[nodes[e].bodies[0]] < 0:
            (b,) = nodes[e].bodies
            edge[b], depth[b] = e, 0
            queue.append(b)
    for root in range(-1, body_count):
        if root >= 0:
            if depth[root] >= 0:
                continue
            depth[root] = 0
            queue.append(root)
        while queue:
            b = queue.popleft()
            for e in touching[b]:
                for other in nodes[e].bodies:
                    if depth[other] < 0:
                        parent[other], edge[other], depth[other] = b, e, depth[b] + 1
                        queue.append(other)
    return parent, edge, depth


def _eliminate(nodes: list[Node], near: list[set[int]], waits: list[set[int]]) -> tuple[list[int], list[set[int]]]:
    """Order of elimination, and the later nodes that each node couples to, fill included."""
    graph = [set(n) for n in near]
    waiting = [set(x) for x in waits]
    left = set(range(len(nodes)))
    sequence: list[int] = []
    later: list[set[int]] = [set() for _ in nodes]
    while left:
        free = [e for e in left if not waiting[e]]
        if not free:
            raise InputError("scene: the order of elimination of its joints has a loop; report this scene")
        e = min(free, key=lambda x: (sum(len(nodes[y].unknowns) for y in graph[x]), x))
        later[e] = graph[e]
        for x in graph[e]:
            graph[x] |= graph[e] - {x}
            graph[x].discard(e)
        left.discard(e)
        sequence.append(e)
        for x in left:
            waiting[x].discard(e)
    return sequence, later


# --- from nodes to numbers


def _places(
    nodes: list[Node],
    near: list[set[int]],
    sequence: list[int],
    later: list[set[int]],
    body_count: int,
    rows: np.ndarray,
    flexible: np.ndarray,
) -> RetainedPattern:
    rank = {e: i for i, e in enumerate(sequence)}
    size = np.array([len(nodes[e].unknowns) for e in sequence], dtype=int)
    first = np.concatenate([[0], np.cumsum(size)]).astype(int)
    order = np.concatenate([nodes[e].unknowns for e in sequence])
    n = len(order)
    panels = []
    for e in sequence:
        after = sorted(rank[x] for x in later[e])
        panels.append(np.concatenate([np.zeros(0, int)] + [np.arange(int(first[x]), int(first[x + 1])) for x in after]))
    width = np.array([len(p) for p in panels], dtype=int)
    start = np.concatenate([[0], np.cumsum(size**2 + 2 * size * width)]).astype(int)
    if max(start[-1], (width.astype(np.int64) ** 2).sum()) > LARGEST_INDEX:
        raise InputError("scene: its joints couple too many coordinates for one factorisation; use fewer modes")
    node_of = np.repeat(np.arange(len(sequence)), size)
    known = _known(nodes, near, sequence, rank)
    gather_line, gather_column = np.full(start[-1], -1), np.full(start[-1], -1)
    targets = []
    at = np.full(n, -1)  # of a place in the panel of the current node
    for e, panel in enumerate(panels):
        own = np.arange(int(first[e]), int(first[e + 1]))
        blocks = (
            (start[e], np.repeat(own, size[e]), np.tile(own, size[e])),
            (start[e] + size[e] ** 2, np.repeat(own, width[e]), np.tile(panel, size[e])),
            (start[e] + size[e] ** 2 + size[e] * width[e], np.tile(panel, size[e]), np.repeat(own, width[e])),
        )
        for begin, line, column in blocks:
            there = np.array([(a, b) in known for a, b in zip(node_of[line], node_of[column], strict=True)], dtype=bool)
            here = begin + np.flatnonzero(there)
            gather_line[here], gather_column[here] = order[line[there]], order[column[there]]
        # position of entry (i, j) of the Schur complement of this node: in the earlier of the two nodes
        target = np.zeros((width[e], width[e]), dtype=int)
        owners = node_of[panel]
        for f in np.unique(owners):
            at[panels[f]] = np.arange(int(width[f]))
            mine = np.flatnonzero(owners == f)
            rest = np.flatnonzero(owners > f)
            local = panel[mine] - first[f]
            target[np.ix_(mine, mine)] = start[f] + local[:, None] * size[f] + local[None, :]
            upper = start[f] + size[f] ** 2 + local[:, None] * width[f] + at[panel[rest]][None, :]
            target[np.ix_(mine, rest)] = upper
            target[np.ix_(rest, mine)] = (upper + size[f] * width[f]).T
            at[panels[f]] = -1
        targets.append(target.ravel())
    by_line = np.lexsort((gather_column, gather_line))
    by_line = by_line[np.count_nonzero(gather_line < 0) :]
    counts = np.bincount(gather_line[by_line], minlength=n)
    row_lists = [np.flatnonzero((rows == b).any(axis=1)) for b in range(body_count)]
    on_interface = [((rows[r] == b) & flexible[r]).any(axis=1) for b, r in enumerate(row_lists)]
    return RetainedPattern(
        retained_count=n,
        order=order,
        size=size,
        width=width,
        first=first[:-1],
        start=start[:-1],
        panel_start=np.concatenate([[0], np.cumsum(width)])[:-1],
        panel=np.concatenate(panels),
        target_start=np.concatenate([[0], np.cumsum(width**2)])[:-1],
        target=np.concatenate(targets),
        gather_line=gather_line,
        gather_column=gather_column,
        entry_start=np.concatenate([[0], np.cumsum(counts)]),
        entry_column=gather_column[by_line],
        row_start=np.concatenate([[0], np.cumsum([len(r) for r in row_lists])]),
        row=np.concatenate([np.zeros(0, int), *row_lists]),
        row_flexible=np.concatenate([np.zeros(0, bool), *on_interface]),
    )


def _known(nodes: list[Node], near: list[set[int]], sequence: list[int], rank: dict[int, int]) -> set[tuple[int, int]]:
    """Pairs of nodes, by rank, with a block of the matrix itself."""
    pairs = {(rank[e], rank[x]) for e in sequence for x in near[e]}
    return pairs | {(i, i) for i in range(len(nodes))}
