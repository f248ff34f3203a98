r"""Are the cells behind a contact surface shallow enough for the pressures that its grid can carry?

A pressure that varies over a length a deforms the body down to a depth of about a. Cells deeper than that cannot
follow: the surface is too stiff to short waves, the patch too narrow and the pressure too high, without any other
sign. What counts is the distance between layers of nodes, `depth / degree` of the cells, against the spacing of the
hats, the shortest length that the pressure can vary over.
"""

from __future__ import annotations

import numpy as np

from warpffrf.model.mesh import Mesh
from warpffrf.model.mesh.elements import cell_kind, facet_kind
from warpffrf.model.reduced.contact_grid import ContactGrid
from warpffrf.offline.contact.contact_grid import largest_radius

# First layer of nodes in spacings of the grid. Two equal steel rollers, 35 mm wall, layers growing by 1.3 inwards,
# worst of four phases: errors of half-width and of peak pressure at mid-width against Hertz.
#
#     depth / spacing                       0.5           1            2            4            8
#     hex8,  2 spacings a half-width     -7, -4 %     -8, +4 %    -11, +10 %   -19, +19 %   -41, +68 %
#     hex8,  4                           -3,  0       -3, +1       -5,  +2     -10,  +7     -18, +21
#     hex27, 2                           -6, -6       -6, -6       -7,  -5     -12, +10     -37, +41
#     hex27, 4                           -2, -1       -2, -1       -2,  -1      -5,  +3
#
# The limit costs up to 4 % of the half-width and 6 % of the peak; twice the limit three times as much.
DEEPEST = 2.0


def layer_depth(mesh: Mesh, name: str, shape) -> float:
    """Largest distance [m] between the surface and the first layer of nodes behind the facets of set `name`.

    The depth of a cell is that of its deepest node under the true surface `shape`, divided by the degree of the cell.
    """
    deepest = 0.0
    for kind, cells in _behind(mesh, name).items():
        _, _, height = shape.chart(mesh.points[cells.ravel()])
        deepest = max(deepest, float(np.max(-height)) / cell_kind(kind).degree)
    return deepest


def node_spacing(mesh: Mesh, name: str, shape, grid: ContactGrid) -> float | None:
    """Distance [m] of nodes and of the columns of the `grid`, along the surface or into the depth, whichever is larger;
    None where there are cells behind the facets that are no hexahedra."""
    kinds = _behind(mesh, name)
    if not kinds or any(cell_kind(kind).corner_count != 8 for kind in kinds):
        return None
    return max(layer_depth(mesh, name, shape), grid.pitch * largest_radius(shape, grid.z))


def _behind(mesh: Mesh, name: str) -> dict[str, np.ndarray]:
    """The cells behind the facets of set `name`, by kind."""
    on_set = np.zeros(len(mesh.points), dtype=bool)
    on_set[mesh.facets(name).node_set] = True
    found = {}
    for kind, cells in mesh.cells.items():
        cell = cell_kind(kind)
        shared = min(facet_kind(facet).corner_count for facet in cell.faces)
        behind = cells[on_set[cells[:, : cell.corner_count]].sum(axis=1) >= shared]
        if len(behind):
            found[kind] = behind
    return found


def depth_ratio(depth: float, shape, grid: ContactGrid) -> float:
    """`depth` [m] over the smaller spacing of the grid, around the largest circle or along the axis."""
    around = grid.pitch * largest_radius(shape, grid.z)
    return depth / min(around, float(np.min(np.diff(grid.z))))


def depth_warning(name: str, depth: float, ratio: float) -> str | None:
    """What to tell the user where the cells are too deep, else None."""
    if ratio <= DEEPEST:
        return None
    return (
        f"contact {name!r}: the first layer of nodes lies {depth:.3g} m behind the surface, {ratio:.3g} spacings of "
        f"the contact grid, where at most {DEEPEST:g} is good: patches come out too narrow and their pressure too "
        "high; grade the mesh towards the surface (mesh.roller: leave grading out, or more layers), or use "
        f"traction_spacing >= {depth / DEEPEST:.3g} m"
    )
