r"""`LapSurface`: the data of a lap's cells in a reduced body.

A cell c has a frame of rows (n, t_1, t_2), n the outward normal of the first face, and three forces s_c along it [N],
mean tractions times area. Of a *face* they act on it, and the displacement that they work on is that of the face,
positive outwards. Of a *pair* of faces of one body they act on the second face, and the opposite forces on the first:
s_n >= 0 presses them apart, and the displacement is

    delta_c = mean over the cell of (displacement of the second face - displacement of the first),

along the frame. With the columns b of unit loads, `b = d N_mean(second) - d N_mean(first)` along each direction d of
the frames (of a face `+ d N_mean`), loads and displacements are conjugate, and of all cells of all laps of the body

    delta = modes^T q_g + C s,        C = B^T G_res B,

C the `lap_compliance` of the body: the static flexibility under inertia relief without what the global modes do.

Lap cells. `LapCells`: the faces of a body that form a lap, and their partition into cells.

Face loads. Transformation of the forces of a lap's cells to the cells of its faces.

A body stores the response to forces on all cells of all its laps, `f` (N,), in the order of `ReducedBody.laps`, three
per cell along the rows of its frame (`LapSurface`). Of a lap in a scene the forces s (3 c,) act on the second face and
their opposite on the first, so that on a body

    f = P s,    P = 1 of a pair of faces of that body,    -1 of a first face,    w_cj F_j T F_c^T of a second one,

with the share w_cj of cell c that cell j of the second face carries (`pairing`), the frames F_c and F_j in the axes of
their bodies, and T from the axes of the first to those of the second. P^T maps displacements of cells of the body to
those of the lap.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, fields
from typing import Any

import numpy as np
import scipy.sparse as sp

from warpffrf.model.errors import InputError, require_number, unknown_name
from warpffrf.model.messages.named_arguments import named_arguments


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
    def restore(cls, name: str, arrays: dict[str, np.ndarray], facts: dict[str, Any]) -> LapSurface:
        """The cells of `arrays()` and `facts()`."""
        found: dict[str, Any] = {key: (float(facts[key][0]), float(facts[key][1])) for key in NUMBERS}
        found |= {key: arrays[key] for key in ARRAYS}
        return cls(name=name, pair=bool(facts["pair"]), by=str(facts["by"]), **found)


ARRAYS = ("points", "frames", "area", "gap", "modes", "triangles", "cell")
NUMBERS = ("covered", "distance", "size")


BY = ("facets", "nodes")


@named_arguments
@dataclass(frozen=True)
class LapCells:
    """Cells of the facet set `first`, or of where it faces the facet set `second` of the same body.

    Parameters
    ----------
    first, second: names of facet sets. With one, the cells are those of a face that will lie on another body's; with
        two, those of the overlap of two faces of one body, the first of which gives the cells and their frames.
    size [m]: facets are gathered into cells up to about this size; None: each facet is a cell, or as `growth` says.
    growth: cells grow away from the outline of the overlap, outer edges and holes alike: at a distance d from it they
        are as large as a facet plus `growth` times d, and at most `size`. None: the same size everywhere.
    fine: facet sets from whose outlines d is measured in the place of that of the overlap, seen along the normals of
        the first face: those under heads of bolts, at whose edges the pressure is steep, through the sheet.
    by: "facets": a cell is a facet of the first set, cut by the outline of the second, or several of them. "nodes": a
        cell is a node of the first set, its load a nodal force; the nodes of the second have to lie opposite.

    Raises `InputError` for invalid names, sizes that are not positive, sizes of cells by nodes, and `fine` without
    `growth`.
    """

    first: str
    second: str | None = None
    size: float | None = None
    growth: float | None = None
    by: str = "facets"
    fine: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        for name in (self.first, *(() if self.second is None else (self.second,))):
            if not isinstance(name, str) or not name:
                raise InputError(f"LapCells: a lap is between facet sets, given by name, got {name!r}")
        if self.first == self.second:
            raise InputError(
                f"LapCells: {self.first!r} cannot face itself; give two facet sets, or one for a face of this body "
                "that lies on another body's"
            )
        if self.by not in BY:
            raise unknown_name("LapCells: by", self.by, BY)
        for what, value in (("size", self.size), ("growth", self.growth)):
            if value is None:
                continue
            if self.by == "nodes":
                raise InputError(f"LapCells: {what} gathers facets; leave it out for cells by nodes")
            object.__setattr__(self, what, require_number(value, f"LapCells: {what}", positive=True))
        self._take_fine()

    def _take_fine(self) -> None:
        fine = (self.fine,) if isinstance(self.fine, str) else self.fine
        if not isinstance(fine, tuple | list) or not all(isinstance(name, str) and name for name in fine):
            raise InputError(f"LapCells: fine are names of facet sets, got {fine!r}")
        if fine and self.growth is None:
            raise InputError(f"LapCells: cells are fine at {fine[0]!r} if they grow away from there; give growth")
        object.__setattr__(self, "fine", tuple(fine))

    @property
    def sets(self) -> tuple[str, ...]:
        """The facet sets, one or two."""
        return (self.first,) if self.second is None else (self.first, self.second)

    def describe(self) -> dict[str, Any]:
        """Plain data, for provenance and the key of the cache."""
        found = {"sets": list(self.sets), "size": self.size, "growth": self.growth, "by": self.by}
        return {**found, "fine": list(self.fine)} if self.fine else found


def lap_cells(laps: Mapping[str, Any] | None) -> dict[str, LapCells]:
    """The laps of `reduce` by name: a facet set, two facet sets in a tuple or list, `LapCells`, or its arguments in a
    dict, as scene files have it. Raises `InputError` for anything else."""
    example = 'reduce: laps must be {name: ("facet set", "facet set")}, such as {"lap": ("top", "bottom")}'
    if laps is None:
        return {}
    if not isinstance(laps, Mapping) or not all(isinstance(name, str) and name for name in laps):
        raise InputError(f"{example}; got {laps!r}")
    found = {}
    for name, given in laps.items():
        if isinstance(given, LapCells):
            found[name] = given
        elif isinstance(given, str):
            found[name] = LapCells(given)
        elif isinstance(given, tuple | list) and len(given) == 2:
            found[name] = LapCells(*given)
        elif isinstance(given, Mapping):
            found[name] = _from_table(name, given)
        else:
            raise InputError(f"{example}, one facet set for a face, or LapCells; got {given!r} for {name!r}")
    return found


def _from_table(name: str, given: Mapping[str, Any]) -> LapCells:
    known = [field.name for field in fields(LapCells)]
    for key in given:
        if key not in known:
            raise unknown_name(f"reduce: lap {name!r}:", key, known)
    if "first" not in given:
        raise InputError(f"reduce: lap {name!r} needs first, the name of a facet set")
    return LapCells(**given)


Array = np.ndarray


def places(laps: Mapping[str, LapSurface]) -> dict[str, slice]:
    """Indices of each lap's forces among the N forces of a body."""
    ends = np.cumsum([0, *(surface.unknowns for surface in laps.values())])
    return {name: slice(int(a), int(b)) for name, a, b in zip(laps, ends[:-1], ends[1:], strict=True)}


def count(laps: Mapping[str, LapSurface]) -> int:
    """N, the number of forces on all laps of a body."""
    return sum(surface.unknowns for surface in laps.values())


def on_own(laps: Mapping[str, LapSurface], name: str, cell: Array) -> sp.csr_matrix:
    """P (N, 3 c) on the body of the first face, or of both, whose lap `name` has the cells with the numbers `cell`
    (c,)."""
    n = 3 * len(cell)
    rows = places(laps)[name].start + (3 * np.asarray(cell)[:, None] + np.arange(3)).ravel()
    sign = 1.0 if laps[name].pair else -1.0
    return sp.csr_matrix((np.full(n, sign), (rows, np.arange(n))), shape=(count(laps), n))


def on_partner(laps: Mapping[str, LapSurface], name: str, weights: sp.csr_matrix, frames: Array) -> sp.csr_matrix:
    """P (N, 3 c) on the body of the second face, its lap `name`; weights (c, cells of that face), frames (c, 3, 3) of
    the lap's cells, in rows, in the axes of this body."""
    shares = sp.coo_matrix(weights)
    blocks = np.einsum("kai,kbi->kab", laps[name].frames[shares.col], frames[shares.row]) * shares.data[:, None, None]
    rows = places(laps)[name].start + 3 * shares.col[:, None, None] + np.arange(3)[:, None] + np.zeros((3, 3), int)
    columns = 3 * shares.row[:, None, None] + np.arange(3)[None, :] + np.zeros((3, 3), int)
    shape = count(laps), 3 * len(frames)
    return sp.csr_matrix((blocks.ravel(), (rows.ravel(), columns.ravel())), shape=shape)
