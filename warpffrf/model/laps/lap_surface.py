r"""`LapSurface`: what of a lap's cells a reduced body knows.

A cell c has a frame of rows (n, t_1, t_2), n the outward normal of the first face, and three forces s_c along it [N],
mean tractions times area. Of a *face* they act on it, and the displacement that they work on is that of the face,
positive outwards. Of a *pair* of faces of one body they act on the second face, and the opposite forces on the first:
s_n >= 0 presses them apart, and the displacement is

    delta_c = mean over the cell of (displacement of the second face - displacement of the first),

along the frame. With the columns b of unit loads, `b = d N_mean(second) - d N_mean(first)` along each direction d of
the frames (of a face `+ d N_mean`), loads and displacements are conjugate, and of all cells of all laps of the body

    delta = modes^T q_g + C s,        C = B^T G_res B,

C the `lap_compliance` of the body: the static flexibility under inertia relief without what the global modes do.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np


@dataclass(frozen=True, eq=False)
class LapSurface:
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
    by: str = "facets"  # what a cell is made of: "facets" or "nodes"

    @property
    def cells(self) -> int:
        """Number of cells."""
        return len(self.points)

    @property
    def unknowns(self) -> int:
        """Number of forces, three a cell."""
        return 3 * len(self.points)

    def arrays(self) -> dict[str, np.ndarray]:
        """The arrays by name; `restore` reads them back."""
        return {name: getattr(self, name) for name in ARRAYS}

    def facts(self) -> dict[str, Any]:
        """What is no array, as JSON."""
        numbers = {name: [float(v) for v in getattr(self, name)] for name in NUMBERS}
        return {"pair": bool(self.pair), "by": self.by, **numbers}

    @classmethod
    def restore(cls, name: str, arrays: dict[str, np.ndarray], facts: dict[str, Any]) -> LapSurface:
        """The cells of `arrays()` and `facts()`."""
        found: dict[str, Any] = {key: (float(facts[key][0]), float(facts[key][1])) for key in NUMBERS}
        found |= {key: arrays[key] for key in ARRAYS}
        return cls(name=name, pair=bool(facts["pair"]), by=str(facts["by"]), **found)


ARRAYS = ("points", "frames", "area", "gap", "modes", "triangles", "cell")
NUMBERS = ("covered", "distance", "size")
