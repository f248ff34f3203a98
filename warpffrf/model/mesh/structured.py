"""A hollow roller meshed in sectors: linear or curved quadratic hexahedra, numbered for cyclic reduction.

Cylindrical coordinates about the axis e_a = +y with e_0 = +x and e_1 = e_a x e_0 = -z:

    x(r, theta, y) = r (cos(theta) e_0 + sin(theta) e_1) + y e_a.

A cell's reference axes are (xi, eta, zeta) = (r, theta, y), right-handed because e_0 x e_1 = e_a. All nodes, those in
the middle of edges included, lie on the true circles: isoparametric quadratic cells then carry the round shape.

The outer radius follows the crown, R(y) = R - (Rc - sqrt(Rc^2 - y^2)); a node at fraction f of the wall thickness has
r = r_i + f (R(y) - r_i). Layer thicknesses grow from the rim inwards as h, g h, g^2 h, ... with n layers filling the
wall: h (g^n - 1)/(g - 1) = R - r_i.

Where no growth is given it is solved for so that the rim layer is as deep as a cell is wide around: cells deeper than
that make the surface too stiff to a narrow patch. With few layers g is then large and the layers behind the rim are the
coarse ones. Of all g that is still the best for the pressure: two steel rollers of 720 linear sectors and 4 layers, 4
cells per half-width, have half-width and peak pressure off by -40 % and +76 % with g = 1, -13 % and +13 % with g = 2,
-8 % and +6 % with the solved g = 3.9; enough layers for g = 1.3 give -3 % and +1 %.

Counts left out follow from the wanted contact half-width b. With weak gaps on linear cells the measured rolling ripple
is below 1 % from 2 cells per half-width on; quadratic cells carry the same number of nodes at 1 cell.
"""

from __future__ import annotations

import logging

import numpy as np

from warpffrf.model.errors import InputError, require_count, require_number
from warpffrf.model.mesh.data import Cyclic, FacetSet, Mesh
from warpffrf.model.mesh.elements import cell_kind
from warpffrf.model.surface_fit import crown_drop

logger = logging.getLogger(__name__)

CELLS_PER_HALF_WIDTH = {1: 2.0, 2: 1.0}  # around the rim, by order: equal node spacing of b/2
AXIAL_CELL = {1: 8.0, 2: 16.0}  # axial cell length in half-widths: a line contact varies slowly along its axis
LEAST_AXIAL = {1: 4, 2: 2}  # axial cells at least, so that pressure can vary along the axis
DEFAULT_GROWTH = 1.4  # layer growth when layers are chosen: neighbours within a factor 1.4 keep cells well shaped
# Growth above which few layers are worth a warning. The measured pair of the module docstring at g = 2, rim layer as
# deep as wide, has 1 % less half-width and 3 % less approach than at g = 1.3; at g = 4 it is 5 % and 9 %.
STEEP_GROWTH = 2.0


def roller(
    outer_radius: float,
    inner_radius: float,
    width: float,
    *,
    crown_radius: float | None = None,
    sectors: int | None = None,
    layers: int | None = None,
    axial: int | None = None,
    grading: float | None = None,
    order: int = 2,
    half_width: float | None = None,
) -> Mesh:
    """A hollow roller with axis y, centred in the origin, with facet sets `rim`, `bore` and `ends`.

    Parameters (lengths in m)
    -------------------------
    outer_radius, inner_radius, width: the roller; `inner_radius` > 0.
    crown_radius: radius of the crown's arc in a plane through the axis; None for a straight rim.
    sectors, layers, axial: cells around, through the wall, along the axis. What is left out follows `half_width`.
    grading: growth of the layer thickness from one layer to the next, from the rim inwards; 1.0 is uniform. None:
        graded towards the rim by itself, so that the rim layer is as deep as a cell is wide around (as the cell that
        `half_width` asks for, where given): growth solved for given `layers`, 1.4 for chosen ones. Layers too few for
        that with a growth of 2 are logged as a warning.
    order: 1 for hex8, 2 for curved hex27 (isoparametric, nodes on the true circles).
    half_width: wanted contact half-width; gives 2 linear or 1 quadratic cells per half-width around.

    The first node plane of sector 0 lies in the half plane x > 0, z = 0. In a plane nodes are numbered from the bore to
    the rim with the axial index fastest; a sector of hex27 holds a corner plane, then a mid plane.
    Raises `InputError` for impossible sizes and for counts left out without `half_width`.
    """
    R = require_number(outer_radius, "roller: outer_radius", positive=True)
    r_i = require_number(inner_radius, "roller: inner_radius", positive=True)
    width = require_number(width, "roller: width", positive=True)
    if r_i >= R:
        raise InputError(f"roller: inner_radius {r_i:g} must be smaller than outer_radius {R:g}")
    if order not in CELLS_PER_HALF_WIDTH:
        raise InputError(f"roller: order must be 1 (hex8) or 2 (hex27), got {order!r}")
    if crown_radius is not None:
        crown_radius = _checked_crown(crown_radius, R - r_i, width)
    if half_width is None:
        left_out = [n for n, v in (("sectors", sectors), ("layers", layers), ("axial", axial)) if v is None]
        if left_out:
            raise InputError(f"roller: give {', '.join(left_out)}, or half_width to have the counts chosen")
        size = None
    else:
        size = require_number(half_width, "roller: half_width", positive=True) / CELLS_PER_HALF_WIDTH[order]
        if size > R - r_i:
            raise InputError(f"roller: half_width {half_width:g} is as large as the wall; give the counts instead")
    if sectors is None and size is not None:
        sectors = max(int(np.ceil(2.0 * np.pi * R / size)), 3)
    if axial is None and half_width is not None:
        axial = max(int(np.ceil(width / (AXIAL_CELL[order] * half_width))), LEAST_AXIAL[order])
    sectors = require_count(sectors, "roller: sectors", 3)
    axial = require_count(axial, "roller: axial", 1)
    depth = _layer_depths(R - r_i, layers, grading, 2.0 * np.pi * R / sectors if size is None else size)

    fractions = _refined(1.0 - depth[::-1] / (R - r_i), order)  # of the wall, bore (0) to rim (1)
    y = _refined(np.linspace(-0.5 * width, 0.5 * width, axial + 1), order)
    rim = np.full(len(y), R) if crown_radius is None else R - crown_drop(y, 1.0 / crown_radius)
    radius = r_i + fractions[:, None] * (rim[None, :] - r_i)
    theta = 2.0 * np.pi * np.arange(order * sectors) / (order * sectors)
    points = np.empty((len(theta), *radius.shape, 3))
    points[..., 0] = np.cos(theta)[:, None, None] * radius
    points[..., 1] = y
    points[..., 2] = -np.sin(theta)[:, None, None] * radius

    cells, facets = _topology(sectors, len(depth) - 1, axial, order)
    return Mesh(
        points=points.reshape(-1, 3),
        cells=cells,
        facet_sets=facets,
        cyclic=Cyclic(sectors, np.zeros(3), np.array([0.0, 1.0, 0.0])),
        name="roller",
    )


def _checked_crown(crown_radius: float, wall: float, width: float) -> float:
    Rc = require_number(crown_radius, "roller: crown_radius", positive=True)
    if Rc <= 0.5 * width or float(crown_drop(np.array(0.5 * width), 1.0 / Rc)) >= wall:
        raise InputError(f"roller: crown_radius {Rc:g} is too small for width {width:g} and wall {wall:g}")
    return Rc


def _layer_depths(wall: float, layers: int | None, grading: float | None, size: float) -> np.ndarray:
    """Depths below the rim of the layer boundaries (layers + 1,), from 0 to `wall` [m]; `size` [m] of the rim layer."""
    if grading is not None:
        grading = require_number(grading, "roller: grading", positive=True)
    if layers is None:
        growth = DEFAULT_GROWTH if grading is None else grading
        reach = 1.0 + wall * (growth - 1.0) / size
        if reach <= 0.0:
            raise InputError(f"roller: layers shrinking by {growth:g} from {size:g} never fill the wall; raise grading")
        count = wall / size if growth == 1.0 else np.log(reach) / np.log(growth)
        layers = max(int(np.ceil(count)), 1)
    else:
        layers = require_count(layers, "roller: layers", 1)
        growth = _growth_for(wall / size, layers) if grading is None else grading
        if grading is None and growth > STEEP_GROWTH:
            logger.warning(
                "roller: with layers=%d each is %.3g times as deep as the one outside it, which makes the rim too "
                "stiff; use layers >= %d",
                layers,
                growth,
                _layers_for(wall / size, STEEP_GROWTH),
            )
    thickness = growth ** np.arange(layers, dtype=float)
    depth = np.concatenate([[0.0], np.cumsum(thickness)])
    return wall * depth / depth[-1]


def _layers_for(ratio: float, growth: float) -> int:
    """Least n with 1 + g + ... + g^(n-1) = (g^n - 1)/(g - 1) >= `ratio`."""
    return int(np.ceil(np.log1p(ratio * (growth - 1.0)) / np.log(growth)))


def _growth_for(ratio: float, layers: int) -> float:
    """Growth g >= 1 with 1 + g + ... + g^(layers-1) = `ratio`; 1 where uniform layers are already fine enough."""
    if layers == 1 or ratio <= layers:
        return 1.0
    from scipy.optimize import brentq

    # the last layer alone must not exceed the wall: g^(layers-1) <= ratio bounds the root
    upper = ratio ** (1.0 / (layers - 1))
    root = brentq(lambda g: float(np.sum(g ** np.arange(layers, dtype=float))) - ratio, 1.0, upper)
    return float(root)  # pyright: ignore[reportArgumentType]


def _refined(corners: np.ndarray, order: int) -> np.ndarray:
    """Corner positions, with the midpoints between them for order 2: mid nodes in the middle keep det J positive."""
    if order == 1:
        return corners
    nodes = np.empty(2 * len(corners) - 1)
    nodes[::2] = corners
    nodes[1::2] = 0.5 * (corners[1:] + corners[:-1])
    return nodes


def _topology(sectors: int, layers: int, axial: int, order: int) -> tuple[dict, dict[str, FacetSet]]:
    """Cells and facet sets, sector-major, from one sector's by shifting node numbers by the nodes of a sector."""
    kind = cell_kind("hex8" if order == 1 else "hex27")
    rows, columns = order * layers + 1, order * axial + 1
    plane = rows * columns
    per_sector = order * plane
    # reference coordinates -1, 0, 1 become grid offsets 0, (1,) order
    offset = np.rint(0.5 * order * (kind.nodes + 1.0)).astype(np.int64)
    i, j = np.meshgrid(np.arange(layers), np.arange(axial), indexing="ij")
    row = order * i.ravel()[:, None] + offset[None, :, 0]
    column = order * j.ravel()[:, None] + offset[None, :, 2]
    sector_cells = offset[None, :, 1] * plane + row * columns + column
    shift = per_sector * np.arange(sectors, dtype=np.int64)[:, None, None]
    nodes = (sector_cells[None] + shift) % (sectors * per_sector)
    by_place = nodes.reshape(sectors, layers, axial, -1)
    ((facet_kind, face),) = kind.faces.items()  # order of faces: xi-, xi+, eta-, eta+, zeta-, zeta+
    bore = by_place[:, 0][..., face[0]]
    rim = by_place[:, -1][..., face[1]]
    ends = np.concatenate([by_place[:, :, 0][..., face[4]], by_place[:, :, -1][..., face[5]]], axis=1)
    width = face.shape[1]
    facets = {
        name: FacetSet({facet_kind: f.reshape(-1, width)}) for name, f in (("rim", rim), ("bore", bore), ("ends", ends))
    }
    return {kind.name: nodes.reshape(-1, nodes.shape[-1])}, facets
