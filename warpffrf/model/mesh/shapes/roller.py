"""A roller meshed in hexahedra, linear or curved quadratic: a hollow one in sectors, numbered for cyclic reduction, a
solid one around a coarse core.

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

A solid roller has layers down to 0.4 of its radius, of which the deep ones halve the number of cells around, and a core
of a few square cells (`disc`). Nodes on its axis belong to no sector: it is not periodic and takes the general path.
A crown reduces the whole cross section, as above with r_i = 0: r = f R(y).

Counts not given follow from the requested contact half-width b. With weak gaps on linear cells the measured rolling
ripple is below 1 % from 2 cells per half-width on; quadratic cells carry the same number of nodes at 1 cell.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from warpffrf.model.errors import InputError, require_count, require_number
from warpffrf.model.mesh.data import Mesh
from warpffrf.model.mesh.periodicity import Cyclic
from warpffrf.model.mesh.shapes.cell_count import require_cells
from warpffrf.model.mesh.shapes.disc import CORE, LEAST_SECTORS, disc, refined, standing_cells, standing_points
from warpffrf.model.mesh.shapes.revolved import (
    axial_lines,
    layer_depths,
    profile_radius,
    revolved_cells,
    revolved_points,
    tread_facets,
)
from warpffrf.model.messages.named_arguments import named_arguments
from warpffrf.model.surfaces.fit import crown_drop

CELLS_PER_HALF_WIDTH = {1: 2.0, 2: 1.0}  # around the rim, by order: equal node spacing of b/2
AXIAL_CELL = {1: 8.0, 2: 16.0}  # axial cell length in half-widths: a line contact varies slowly along its axis
LEAST_AXIAL = {1: 4, 2: 2}  # axial cells at least, so that pressure can vary along the axis


@named_arguments
def roller(
    outer_radius: float,
    inner_radius: float,
    width: float,
    *,
    crown_radius: float | None = None,
    profile: Any = None,
    sectors: int | None = None,
    layers: int | None = None,
    axial: Any = None,
    tread: float | None = None,
    grading: float | None = None,
    order: int = 2,
    half_width: float | None = None,
) -> Mesh:
    """A roller with axis y, centred in the origin: facet sets `rim`, `ends` and, of a hollow one, `bore`.

    A solid roller, `inner_radius=0`, has sets for interfaces on its end faces too: `end_low` (y = -width/2) and
    `end_high`, and `journal_low` and `journal_high`, the circles of 0.4 of their radius in their middles. A rigid
    interface on a whole end face would hold the edge of the rim as well, which then cannot carry contact; one on a
    journal, or an "average" one, does not.

    Parameters (lengths in m)
    -------------------------
    outer_radius, inner_radius, width: the roller; `inner_radius=0` makes a solid one.
    crown_radius: radius of the crown's arc in a plane through the axis; None for a straight rim.
    profile: instead of a crown, the true radius of the rim along the axis: a surface shape (its `radius_at`), or a
        function of positions y (n,) [m] that returns radii (n,) [m]; for tables, cones and other profiles.
        `outer_radius` then only sets the size of the cells. `crown_radius=outer_radius` makes a ball with flat ends.
    sectors, layers, axial: cells around, through the wall, along the axis. Omitted numbers follow from `half_width`.
        `axial` may be the boundaries (n + 1,) of the cells, rising from -width/2 to width/2: a sharp end that carries
        pressure requires small cells there. Of a solid roller `sectors`, a multiple of 4 and at least 8, stand around
        in the rim layer, fewer behind it where layers are deep compared with their cells' width; `layers` counts those
        from the rim to 0.4 `outer_radius`, where the core begins.
    tread: width of a band in the middle that has all `axial` cells, equal ones; next to it cells grow. It adds the
        facet set `tread`: for a contact that is narrow compared with the roller, and for balls. None: the whole width.
        The rim layer is then as deep as the smaller side of a cell.
    grading: growth of the layer thickness from one layer to the next, from the rim inwards; 1.0 is uniform. None:
        graded towards the rim automatically, so that the rim layer is as deep as a cell is wide around (as the cell
        that `half_width` requires, where given): growth solved for given `layers`, 1.4 for chosen ones. Layers too few
        for that with a growth of 2 are logged as a warning.
    order: 1 for hex8, 2 for curved hex27 (isoparametric, nodes on the true circles).
    half_width: expected contact half-width; gives 2 linear or 1 quadratic cells per half-width around.

    The first node plane of sector 0 lies in the half plane x > 0, z = 0. In a plane nodes are numbered from the bore to
    the rim with the axial index fastest; a sector of hex27 holds a corner plane, then a mid plane. A solid roller is
    not periodic (`cyclic` None): `reduce` takes the general path.
    Raises `InputError` for impossible sizes and for missing counts without `half_width`.

    >>> mesh = wf.mesh.roller(0.02, 0.01, 0.01, sectors=96, layers=4, axial=2, order=1)  # m
    >>> sorted(mesh.facet_sets)
    ['bore', 'ends', 'rim']
    >>> round(mesh.volume() * 1e6, 2)  # cm3
    9.42
    """
    R = require_number(outer_radius, "roller: outer_radius", positive=True)
    r_i = require_number(inner_radius, "roller: inner_radius", non_negative=True)
    width = require_number(width, "roller: width", positive=True)
    if r_i >= R:
        raise InputError(f"roller: inner_radius {r_i:g} must be smaller than outer_radius {R:g}")
    if order not in CELLS_PER_HALF_WIDTH:
        raise InputError(f"roller: order must be 1 (hex8) or 2 (hex27), got {order!r}")
    if crown_radius is not None and profile is not None:
        raise InputError("roller: crown_radius and profile both shape the rim; give one of them")
    if crown_radius is not None:
        crown_radius = _checked_crown(crown_radius, R - r_i, width)
    solid = r_i == 0.0
    wall = R * (1.0 - CORE) if solid else R - r_i
    if half_width is None:
        left_out = [n for n, v in (("sectors", sectors), ("layers", layers), ("axial", axial)) if v is None]
        if left_out:
            raise InputError(f"roller: give {', '.join(left_out)}, or half_width to have the counts chosen")
        size = None
    else:
        size = require_number(half_width, "roller: half_width", positive=True) / CELLS_PER_HALF_WIDTH[order]
        if size > wall:
            raise InputError(f"roller: half_width {half_width:g} is as large as the wall; give the counts instead")
    if sectors is None and size is not None:
        sectors = max(int(np.ceil(2.0 * np.pi * R / size)), LEAST_SECTORS if solid else 3)
        sectors += -sectors % 4 if solid else 0
    if axial is None and half_width is not None:
        axial = max(int(np.ceil((tread or width) / (AXIAL_CELL[order] * half_width))), LEAST_AXIAL[order])
    sectors = require_count(sectors, "roller: sectors", LEAST_SECTORS if solid else 3)
    if solid and sectors % 4:
        raise InputError(
            f"roller: sectors of a solid roller must be a multiple of 4, got {sectors}; use {sectors + -sectors % 4}"
        )
    boundaries = axial is not None and np.ndim(axial) > 0
    cells_along: Any = axial if boundaries else require_count(axial, "roller: axial", 1)
    require_cells("roller", sectors, layers, cells_along)
    first = 2.0 * np.pi * R / sectors if size is None else size
    if tread is not None and not boundaries:
        first = min(first, require_number(tread, "roller: tread", positive=True) / cells_along)
    depth = layer_depths(wall, layers, grading, first)

    lines = axial_lines(-0.5 * width, 0.5 * width, cells_along, tread, "roller")
    y = refined(lines, order)
    if profile is not None:
        rim = profile_radius(profile, y, "roller: profile", above=r_i)
    else:
        rim = np.full(len(y), R) if crown_radius is None else R - crown_drop(y, 1.0 / crown_radius)
    if solid:
        section = disc(sectors, 1.0 - depth / R, order)
        cells, facets = standing_cells(section, len(lines) - 1, order)
        points, cyclic = standing_points(section.points, rim, y), None
    else:
        fractions = refined(1.0 - depth[::-1] / wall, order)  # of the wall, bore (0) to rim (1)
        radius = r_i + fractions[:, None] * (rim[None, :] - r_i)
        theta = 2.0 * np.pi * np.arange(order * sectors) / (order * sectors)
        cells, facets = revolved_cells(sectors, len(depth) - 1, len(lines) - 1, order)
        points = revolved_points(radius, theta, y)
        cyclic = Cyclic(sectors, np.zeros(3), np.array([0.0, 1.0, 0.0]))
    if tread is not None:
        facets["tread"] = tread_facets(facets["rim"], points, tread)
    return Mesh(points, cells, facets, cyclic, "roller")


def _checked_crown(crown_radius: float, wall: float, width: float) -> float:
    Rc = require_number(crown_radius, "roller: crown_radius", positive=True)
    if Rc <= 0.5 * width or float(crown_drop(np.array(0.5 * width), 1.0 / Rc)) >= wall:
        raise InputError(f"roller: crown_radius {Rc:g} is too small for width {width:g} and wall {wall:g}")
    return Rc
