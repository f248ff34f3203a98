r"""A block with a small fine patch in the middle of its top face, for a contact whose place is known.

User frame: the top face lies in z = 0 with its middle in the origin, the body below it. A nest (`lattice`): a fine
brick under the patch, shells from it to the sides and the bottom. In corresponding points of brick and block the shells
run straight, so that all nodes on the top stay in z = 0.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from warpffrf.model.errors import InputError, require_array, require_number
from warpffrf.model.mesh.data import Mesh
from warpffrf.model.mesh.shapes.lattice import (
    assembled,
    depth_lines,
    nest_tops,
    nested,
    patch_counts,
    require_patch,
    shell_fractions,
)
from warpffrf.model.messages.named_arguments import named_arguments


@named_arguments
def block(
    size: Any,
    *,
    patch_half_width: Any,
    cell: float,
    depth: float | None = None,
    growth: float = 1.5,
    order: int = 2,
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

    Sets `patch` and `bottom` serve as contact surface (`surfaces.Plane`) and as interface. Raises `InputError` for
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
