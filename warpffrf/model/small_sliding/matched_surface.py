r"""`MatchedSurface`: the data of a small-sliding contact's cells in a reduced body.

A cell c has a frame of rows (n, t_1, t_2), n the outward normal of the first face, and three forces s_c along it [N],
mean tractions times area. Of a *face* they act on it, and the displacement that they work on is that of the face,
positive outwards. Of a *pair* of faces of one body they act on the second face, and the opposite forces on the first:
s_n >= 0 presses them apart, and the displacement is

    delta_c = mean over the cell of (displacement of the second face - displacement of the first),

along the frame. With the columns b of unit loads, `b = d N_mean(second) - d N_mean(first)` along each direction d of
the frames (of a face `+ d N_mean`), loads and displacements are conjugate, and of all cells of all matched faces of the
body

    delta = modes^T q_g + C s,        C = B^T G_res B,

C the `matched_compliance` of the body: the static flexibility under inertia relief without the part of the global
modes.

Face loads. Transformation of the forces of a small-sliding contact's cells to the cells of its faces.

A body stores the response to forces on all cells of all its matched faces, `f` (N,), in the order of
`ReducedBody.matched`, three per cell along the rows of its frame (`MatchedSurface`). Of a matched face in a scene the
forces s (3 c,) act on the second face and their opposite on the first, so that on a body

    f = P s,    P = 1 of a pair of faces of that body,    -1 of a first face,    w_cj F_j T F_c^T of a second one,

with the share w_cj of cell c that cell j of the second face carries (`pairing`), the frames F_c and F_j in the axes of
their bodies, and T from the axes of the first to those of the second. P^T maps displacements of cells of the body to
those of the matched face.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
import scipy.sparse as sp


@dataclass(frozen=True, eq=False)
class MatchedSurface:
    """The cells of a face, or of the overlap of two faces, of a reduced body (module docstring)."""

    name: str
    pair: bool
    points: np.ndarray  # (c, 3) m, user frame: the area centroids of the cells on the first face, or their nodes
    frames: np.ndarray  # (c, 3, 3): rows n, t_1, t_2, user axes
    area: np.ndarray  # (c,) m2, on the first face
    gap: np.ndarray  # (c,) m: of pairs the mean distance along n at the start, negative: overlap; of faces zero
    modes: np.ndarray  # (m, 3 c) mean displacement along the frames per unit modal coordinate, 3*cell + component
    triangles: np.ndarray  # (t, 3, 3) m: corners of the cut facets that the cells consist of, outwards
    cell: np.ndarray  # (t,) int: the cell of each triangle
    covered: tuple[float, float]  # of pairs the share of each face's area that faces the other one; of faces 1, 1
    distance: tuple[float, float]  # m: mean and largest of `gap`
    size: tuple[float, float]  # m: smallest and largest edge of a square of a cell's area
    by: str = "facets"  # kind of cells: "facets" or "nodes"

    @property
    def cells(self) -> int:
        """Number of cells."""
        return len(self.points)

    @property
    def unknowns(self) -> int:
        """Number of forces, three per cell."""
        return 3 * len(self.points)

    def arrays(self) -> dict[str, np.ndarray]:
        """The arrays by name; `restore` reads them back."""
        return {name: getattr(self, name) for name in ARRAYS}

    def facts(self) -> dict[str, Any]:
        """The data other than arrays, as JSON."""
        numbers = {name: [float(v) for v in getattr(self, name)] for name in NUMBERS}
        return {"pair": bool(self.pair), "by": self.by, **numbers}

    @classmethod
    def restore(cls, name: str, arrays: dict[str, np.ndarray], facts: dict[str, Any]) -> MatchedSurface:
        """The cells of `arrays()` and `facts()`."""
        found: dict[str, Any] = {key: (float(facts[key][0]), float(facts[key][1])) for key in NUMBERS}
        found |= {key: arrays[key] for key in ARRAYS}
        return cls(name=name, pair=bool(facts["pair"]), by=str(facts["by"]), **found)


ARRAYS = ("points", "frames", "area", "gap", "modes", "triangles", "cell")
NUMBERS = ("covered", "distance", "size")


Array = np.ndarray


def places(matched: Mapping[str, MatchedSurface]) -> dict[str, slice]:
    """Indices of each face's forces among the N forces of a body."""
    ends = np.cumsum([0, *(surface.unknowns for surface in matched.values())])
    return {name: slice(int(a), int(b)) for name, a, b in zip(matched, ends[:-1], ends[1:], strict=True)}


def count(matched: Mapping[str, MatchedSurface]) -> int:
    """N, the number of forces on all matched faces of a body."""
    return sum(surface.unknowns for surface in matched.values())


def on_own(matched: Mapping[str, MatchedSurface], name: str, cell: Array) -> sp.csr_matrix:
    """P (N, 3 c) on the body of the first face, or of both, whose matched face `name` has the cells with the numbers
    `cell` (c,)."""
    n = 3 * len(cell)
    rows = places(matched)[name].start + (3 * np.asarray(cell)[:, None] + np.arange(3)).ravel()
    sign = 1.0 if matched[name].pair else -1.0
    return sp.csr_matrix((np.full(n, sign), (rows, np.arange(n))), shape=(count(matched), n))


def on_partner(
    matched: Mapping[str, MatchedSurface], name: str, weights: sp.csr_matrix, frames: Array
) -> sp.csr_matrix:
    """P (N, 3 c) on the body of the second face, its matched face `name`; weights (c, cells of that face), frames (c,
    3, 3) of the contact's cells, in rows, in the axes of this body."""
    shares = sp.coo_matrix(weights)
    blocks = (
        np.einsum("kai,kbi->kab", matched[name].frames[shares.col], frames[shares.row]) * shares.data[:, None, None]
    )
    rows = places(matched)[name].start + 3 * shares.col[:, None, None] + np.arange(3)[:, None] + np.zeros((3, 3), int)
    columns = 3 * shares.row[:, None, None] + np.arange(3)[None, :] + np.zeros((3, 3), int)
    shape = count(matched), 3 * len(frames)
    return sp.csr_matrix((blocks.ravel(), (rows.ravel(), columns.ravel())), shape=shape)
