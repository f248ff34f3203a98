r"""Bodies of rectangular cells: a box, and everything that can be cut from a grid of boxes (beams, frames, trusses).

Grid lines x_0 < x_1 < ..., y_0 < ..., z_0 < ... define cells; `filled[i, j, k]` states whether the one between x_i and
x_(i+1), y_j and y_(j+1), z_k and z_(k+1) exists. Nodes that no cell uses are omitted. The map of every cell to its
reference cube is linear, so volume and mass are exact for any order of cells.

Block. A block with a small fine patch in the middle of its top face, for a contact at a known position.

User frame: the top face lies in z = 0 with its middle in the origin, the body below it. A nest (`lattice`): a fine
brick under the patch, shells from it to the sides and the bottom. Between corresponding points of brick and block the
shells are straight, so that all nodes on the top stay in z = 0.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from warpffrf.model.errors import InputError, require_array, require_count, require_number
from warpffrf.model.mesh.data import FacetSet, Mesh
from warpffrf.model.mesh.elements import cell_kind
from warpffrf.model.mesh.shapes.cell_count import require_cells
from warpffrf.model.mesh.shapes.disc import (
    KINDS,
    assembled,
    depth_lines,
    nest_tops,
    nested,
    patch_counts,
    refined,
    require_patch,
    shell_fractions,
)
from warpffrf.model.messages.named_arguments import named_arguments

SIDES = ("x_min", "x_max", "y_min", "y_max", "z_min", "z_max")  # in the order of a hexahedron's faces


@named_arguments
def box(size: Any, counts: Any, *, center: Any = (0.0, 0.0, 0.0), order: int = 2, name: str = "box") -> Mesh:
    """A box along the axes with facet sets `x_min`, `x_max`, `y_min`, `y_max`, `z_min`, `z_max`, its six sides.

    size: (3,) [m] along x, y, z; counts: three numbers of equal cells; center: (3,) [m]; order: 1 for hex8, 2 for
    hex27; name: of the mesh. Raises `InputError` for sizes that are not positive and counts below 1.

    >>> bar = wf.mesh.box((0.1, 0.02, 0.01), (10, 2, 1), order=1)  # m
    >>> bar.cell_count
    20
    """
    extent = require_array(size, f"{name}: size", (3,))
    middle = require_array(center, f"{name}: center", (3,))
    if np.any(extent <= 0.0):
        raise InputError(f"{name}: size must be greater than zero along x, y and z, got {extent.tolist()}")
    if np.ndim(counts) != 1 or len(counts) != 3:
        raise InputError(f"{name}: counts must be three numbers of cells, along x, y and z, got {counts!r}")
    numbers = [require_count(n, f"{name}: counts along {axis}", 1) for n, axis in zip(counts, "xyz", strict=True)]
    require_cells(name, *numbers)
    lines = [m + s * np.linspace(-0.5, 0.5, n + 1) for m, s, n in zip(middle, extent, numbers, strict=True)]
    return grid(*lines, order=order, name=name)


@named_arguments
def grid(x: Any, y: Any, z: Any, *, filled: Any = None, order: int = 2, name: str = "grid") -> Mesh:
    """The filled cells of a rectangular grid as one body.

    x, y, z: increasing grid lines [m], (nx + 1,), (ny + 1,), (nz + 1,); filled: (nx, ny, nz) bool, None for all of
    them; order: 1 for hex8, 2 for hex27; name: of the mesh. Facet sets `x_min` to `z_max` are the sides on the
    outermost used planes; further ones are cut out by `select_plane` and `select` of the mesh. Cells that meet only in
    an edge or a corner form a hinge; `Mesh.check()` refuses a body in several pieces. Raises `InputError` for lines
    that do not increase, a `filled` of another shape, and a grid with no cell filled.
    """
    if order not in KINDS:
        raise InputError(f"{name}: order must be 1 (hex8) or 2 (hex27), got {order!r}")
    lines = [_increasing(values, f"{name}: {axis}") for values, axis in zip((x, y, z), "xyz", strict=True)]
    shape = tuple(len(line) - 1 for line in lines)
    require_cells(name, *shape)
    there = np.ones(shape, dtype=bool) if filled is None else np.asarray(filled)
    if there.dtype != bool or there.shape != shape:
        raise InputError(f"{name}: filled must be a bool array {shape}, got {there.dtype} {there.shape}")
    if not there.any():
        raise InputError(f"{name}: no cell is filled")
    kind = cell_kind(KINDS[order])
    # reference coordinates -1, 0, 1 become offsets 0, (1,) order on the refined grid
    offset = np.rint(0.5 * order * (kind.nodes + 1.0)).astype(np.int64)
    place = np.argwhere(there)
    fine = [refined(line, order) for line in lines]
    node = order * place[:, None, :] + offset[None]
    number = np.ravel_multi_index(tuple(np.moveaxis(node, -1, 0)), tuple(len(f) for f in fine))
    used, cells = np.unique(number, return_inverse=True)
    at = np.unravel_index(used, tuple(len(f) for f in fine))
    points = np.stack([f[i] for f, i in zip(fine, at, strict=True)], axis=1)
    cells = cells.reshape(number.shape)
    return Mesh(points, {kind.name: cells}, _sides(place, cells, kind), name=name)


def _sides(place: np.ndarray, cells: np.ndarray, kind: Any) -> dict[str, FacetSet]:
    ((facet, faces),) = kind.faces.items()  # order of faces: x-, x+, y-, y+, z-, z+
    sets = {}
    for f, side in enumerate(SIDES):
        axis, upper = divmod(f, 2)
        outermost = place[:, axis].max() if upper else place[:, axis].min()
        sets[side] = FacetSet({facet: cells[place[:, axis] == outermost][:, faces[f]]})
    return sets


def _increasing(values: Any, label: str) -> np.ndarray:
    line = require_array(values, label, (None,))
    if len(line) < 2 or np.any(np.diff(line) <= 0.0):
        raise InputError(f"{label}: at least two grid lines, increasing, are needed, got {line.tolist()}")
    return line


@named_arguments
def block(
    size: Any, *, patch_half_width: Any, cell: float, depth: float | None = None, growth: float = 1.5, order: int = 2
) -> Mesh:
    """A block below z = 0 with facet sets `patch`, `top` (all of it), `bottom` and `sides`.

    Parameters (lengths in m)
    -------------------------
    size: (3,) along x, y, z.
    patch_half_width: of the fine rectangle in the middle of the top, one number or (2,) along x and y.
    cell: largest edge of the equal cells in it; with `order=2` nodes are half as far apart.
    depth: of the fine brick; None: the smaller half-width.
    growth [-]: of the shells around it, above 1.
    order: 1 for hex8, 2 for hex27.

    Sets `patch` and `bottom` are for a contact surface (`surfaces.Plane`) and an interface. Raises `InputError` for
    impossible sizes.
    """
    extent = require_array(size, "block: size", (3,))
    if np.any(extent <= 0.0):
        raise InputError(f"block: size must be greater than zero along x, y and z, got {extent.tolist()}")
    half, edge, rate = require_patch("block", patch_half_width, cell, order, growth)
    below = float(np.min(half)) if depth is None else require_number(depth, "block: depth", positive=True)
    if np.any(half >= 0.5 * extent[:2]) or below >= extent[2]:
        raise InputError(
            f"block: the fine patch of half-widths {half.tolist()} and depth {below:g} does not fit into a block of "
            f"{extent.tolist()}; make it smaller, or use mesh.box"
        )
    counts = patch_counts("block", half, edge)
    x, y = (np.linspace(-1.0, 1.0, order * n + 1) for n in counts)
    down = depth_lines(edge, below, order) / below
    unit = np.stack(np.meshgrid(x, y, -down, indexing="ij"), axis=-1)
    outer = np.array([0.5 * extent[0], 0.5 * extent[1], extent[2]])
    start, end = float(np.min(half)), float(np.min(outer))
    fractions = shell_fractions(start, end, edge, rate, order)
    lattices = nested(unit * np.array([*half, below]), unit * outer, fractions)
    sets = {
        "patch": [(0, 2, 0)],
        "top": nest_tops(),
        "bottom": [(5, 2, 1)],
        "sides": [(shell, 2, 1) for shell in range(1, 5)],
    }
    return assembled(lattices, order, sets, "block")
