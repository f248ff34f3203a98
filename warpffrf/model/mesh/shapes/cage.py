r"""A cage of a rolling bearing: a tube with a window for each element, bars between them and a ring on either side.

Axis and frame as in `revolved`, the middle of the first window in the half plane x > 0, z = 0. The walls of a window
are parallel: with its width w a wall is at theta = +-asin(w/(2 r)) from the middle.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from warpffrf.model.errors import InputError, require_array, require_count, require_number
from warpffrf.model.mesh.data import Mesh
from warpffrf.model.mesh.elements import cell_kind
from warpffrf.model.mesh.facets import FacetSet
from warpffrf.model.mesh.periodicity import Cyclic
from warpffrf.model.mesh.shapes.cell_count import require_cells
from warpffrf.model.mesh.shapes.disc import KINDS, refined
from warpffrf.model.mesh.shapes.revolved import revolved_cells
from warpffrf.model.messages.named_arguments import named_arguments


@named_arguments
def cage(
    inner_radius: float,
    outer_radius: float,
    width: float,
    *,
    pockets: int,
    pocket_width: float,
    pocket_length: float,
    around: Any = (2, 4),
    axial: Any = (1, 4),
    layers: int = 1,
    order: int = 2,
) -> Mesh:
    """A window cage with axis y, centred in the origin, the first pocket at +x, counter-clockwise about the axis.

    Parameters (lengths in m)
    -------------------------
    inner_radius, outer_radius, width: of the bore, of the outside, and along the axis.
    pockets: their number; pocket_width, pocket_length: their size around and along the axis.
    around: cells of a bar and of a pocket; axial: of a side ring and of a pocket; layers: from bore to outside.
    order: 1 for hex8, 2 for curved hex27.

    Facet sets `bore`, `outside`, `ends`, and of each pocket, from 1 on: `pocket_3`, its four walls, and `bar_3`, the
    two walls of the bar between it and the next one. Raises `InputError` for impossible sizes.

    >>> cage = wf.mesh.cage(0.022, 0.026, 0.012, pockets=14, pocket_width=0.0081, pocket_length=0.0085, order=1)  # m
    >>> len([name for name in cage.facet_sets if name.startswith("bar_")])
    14
    """
    inside = require_number(inner_radius, "cage: inner_radius", positive=True)
    outside = require_number(outer_radius, "cage: outer_radius", positive=True)
    width = require_number(width, "cage: width", positive=True)
    half = 0.5 * require_number(pocket_width, "cage: pocket_width", positive=True)
    length = require_number(pocket_length, "cage: pocket_length", positive=True)
    Z = require_count(pockets, "cage: pockets", 2)
    n_bar, n_window = _two(around, "around")
    n_ring, n_length = _two(axial, "axial")
    layers = require_count(layers, "cage: layers", 1)
    if order not in KINDS:
        raise InputError(f"cage: order must be 1 (hex8) or 2 (hex27), got {order!r}")
    if inside >= outside:
        raise InputError(f"cage: inner_radius {inside:g} must be smaller than outer_radius {outside:g}")
    if length >= width:
        raise InputError(f"cage: pocket_length {length:g} leaves no rings of the width {width:g}")
    if half >= inside * np.sin(np.pi / Z):
        raise InputError(
            f"cage: {Z} pockets of pocket_width {2.0 * half:g} leave no bars at the bore; use less than "
            f"{2.0 * inside * np.sin(np.pi / Z):.4g} m"
        )
    n, n_axial = n_bar + n_window, 2 * n_ring + n_length
    require_cells("cage", Z, n, layers, n_axial)

    ends = np.linspace(0.5 * length, 0.5 * width, n_ring + 1)
    lines = np.concatenate([-ends[::-1], np.linspace(-0.5 * length, 0.5 * length, n_length + 1)[1:-1], ends])
    y, radius = refined(lines, order), np.linspace(inside, outside, order * layers + 1)
    wall = np.arcsin(half / radius)  # and the bar after it, up to the next pocket
    window = np.arcsin(np.linspace(-1.0, 1.0, order * n_window + 1)[:-1, None] * half / radius)
    share = np.linspace(0.0, 1.0, order * n_bar + 1)[:-1, None]
    sector = np.concatenate([window, wall + share * (2.0 * np.pi / Z - 2.0 * wall)])  # (planes, layers)
    theta = (sector + 2.0 * np.pi / Z * np.arange(Z)[:, None, None]).reshape(-1, len(radius))
    points = np.empty((*theta.shape, len(y), 3))
    points[..., 0], points[..., 2] = (radius * np.cos(theta))[..., None], -(radius * np.sin(theta))[..., None]
    points[..., 1] = y

    kind = cell_kind(KINDS[order])
    ((facet, face),) = kind.faces.items()  # order of faces: r-, r+, theta-, theta+, y-, y+
    blocks, _ = revolved_cells(Z * n, layers, n_axial, order)
    cells = blocks[kind.name].reshape(Z, n, layers, n_axial, -1)
    along, low, high = slice(n_ring, n_ring + n_length), n_ring - 1, n_ring + n_length
    there = np.ones(cells.shape[:4], dtype=bool)
    there[:, :n_window, :, along] = False
    used, numbers = np.unique(cells[there], return_inverse=True)
    new = np.full(points.size // 3, -1)
    new[used] = np.arange(len(used))

    def facets(*parts: tuple[np.ndarray, int]) -> FacetSet:
        """Of cells and the number of their faces."""
        return FacetSet({facet: np.concatenate([new[c[..., face[f]].reshape(-1, face.shape[1])] for c, f in parts])})

    sets = {
        "bore": facets((cells[:, :, 0][there[:, :, 0]], 0)),
        "outside": facets((cells[:, :, -1][there[:, :, -1]], 1)),
        "ends": facets((cells[:, :, :, 0], 4), (cells[:, :, :, -1], 5)),
    }
    for k in range(Z):
        front, back = (cells[k, n_window, :, along], 2), (cells[k, -1, :, along], 3)
        sides = (cells[k, :n_window, :, low], 5), (cells[k, :n_window, :, high], 4)
        sets[f"pocket_{k + 1}"] = facets(front, (cells[k - 1, -1, :, along], 3), *sides)
        sets[f"bar_{k + 1}"] = facets(front, back)
    cyclic = Cyclic(Z, np.zeros(3), np.array([0.0, 1.0, 0.0]))
    return Mesh(points.reshape(-1, 3)[used], {kind.name: numbers.reshape(-1, cells.shape[-1])}, sets, cyclic, "cage")


def _two(counts: Any, name: str) -> tuple[int, int]:
    """Raises `InputError` for anything but two numbers of cells."""
    first, second = require_array(counts, f"cage: {name}", (2,))
    return require_count(int(first), f"cage: {name}", 1), require_count(int(second), f"cage: {name}", 1)
