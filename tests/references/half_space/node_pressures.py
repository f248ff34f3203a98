r"""Hertz's contacts with hat functions on the exact half-plane and half-space, and the friction bounds of cells.

The pressure is p = sum s_j psi_j with hat functions psi on a uniform grid, s >= 0, and the weak gap of every node is
complementary to it:

    G s + M_0 (x^2/(2 R) - delta) >= 0,    s >= 0,    s_i gap_i = 0,    A sum s = load,

G the compliance between nodes (`compliances`), M_0 the load of a function, A its area, x^2 its mean over the function
(the node's own plus h^2/6 in each direction). The active set is found by trial.

The end of the patch is not a node. As the edge moves from one node to the next, the coefficient of the last node grows
in proportion, to 0.91 of its neighbour's (0.89 to 0.91 from 5 to 12 cells per half-width): `edge_beyond`.

The bound on a cell is halfway between the coefficient of its node and the mean pressure over the cell,
(1, 6, 1)/8 in each direction: an exchange of 1/16 with each neighbour (`bounding`).
"""

from __future__ import annotations

import numpy as np

from references.closed_forms import LineContact, PointContact
from references.half_space.compliances import plane_table, space_table, toeplitz
from warpffrf.model.errors import InputError

Array = np.ndarray
SPREAD = 1.0 / 16.0  # of the difference to each neighbour
COLUMNS_PER_RATIO = 1.1  # edge beyond the last node, in columns, over its pressure's ratio to the next; at most 1
TRIALS = 60
OPEN = 1e-9  # of the approach: a smaller gap is closed


def line_pressures(contact: LineContact, x: Array, depth: float) -> Array:
    """Coefficients (n,) [Pa] at the nodes x (n,) [m], uniform and wider than the patch; depth L [m]. Raises InputError
    if the patch reaches the outermost nodes."""
    w = float(x[1] - x[0])
    G = toeplitz(plane_table("nodes", w, len(x), depth)) / contact.modulus
    return _inside(_pressed(G, w, x * x + w * w / 6.0, contact.radius, contact.load))


def point_pressures(contact: PointContact, nodes: Array) -> Array:
    """Coefficients (n, m) [Pa] at `nodes` (n, m, 2) [m] of a square grid wider than the patch. Raises InputError
    if the patch reaches the outermost nodes."""
    w = float(nodes[1, 0, 0] - nodes[0, 0, 0])
    G = toeplitz(space_table("nodes", (w, w), nodes.shape[:2])) / contact.modulus
    square = (nodes**2).sum(axis=2).ravel() + w * w / 3.0
    return _inside(_pressed(G, w * w, square, contact.radius, contact.load).reshape(nodes.shape[:2]))


def _inside(pressure: Array) -> Array:
    edges = [np.take(pressure, (0, -1), axis) for axis in range(pressure.ndim)]
    if any(np.any(edge > 0.0) for edge in edges):
        raise InputError("pressures in nodes: the patch reaches the outermost nodes; give nodes beyond it")
    return pressure


def _pressed(G: Array, area: float, square: Array, radius: float, load: float) -> Array:
    free = area * square / (2.0 * radius)
    active = square <= np.sort(square)[len(square) // 2]
    for _ in range(TRIALS):
        on = np.flatnonzero(active)
        k = len(on)
        system = np.block([[G[np.ix_(on, on)], np.full((k, 1), -area)], [np.full((1, k), area), np.zeros((1, 1))]])
        solution = np.linalg.solve(system, np.append(-free[on], load))
        s = np.zeros(len(G))
        s[on] = solution[:-1]
        approach = float(solution[-1])
        gap = G @ s + free - area * approach
        found = np.where(active, s > 0.0, gap < -OPEN * area * abs(approach))
        if np.array_equal(found, active):
            return s
        active = found
    raise RuntimeError("pressures in nodes: no active set found")


def edge_beyond(pressure: Array) -> float:
    """Columns from node 0 to the end of the patch beyond the last node under pressure; coefficients (n,)."""
    last = int(np.flatnonzero(pressure > 0.0)[-1])
    before = pressure[last - 1] if last > 0 else 0.0
    return last + (min(COLUMNS_PER_RATIO * float(pressure[last] / before), 1.0) if before > 0.0 else 1.0)


def bounding(pressure: Array) -> Array:
    """Pressures (n,) or (n, m) of which mu times is the bound, from coefficients on a uniform grid whose outermost
    nodes are zero; the sum is conserved."""
    found = np.array(pressure, dtype=float)
    for axis in range(pressure.ndim):
        for way in (1, -1):
            found += SPREAD * (np.roll(pressure, way, axis) - pressure)
    return found
