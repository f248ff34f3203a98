"""A disc with a bore within a closed curve that every ray from the axis meets once: cams.

Axis and frame as in `revolved`: the curve's x runs along e_0 = +x, its y along e_1 = -z. Lines from the bore to the
curve are radial.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from warpffrf.model.errors import InputError, require_count, require_number
from warpffrf.model.mesh.data import Mesh
from warpffrf.model.mesh.shapes.cell_count import require_cells
from warpffrf.model.mesh.shapes.disc import KINDS, refined
from warpffrf.model.mesh.shapes.revolved import axial_lines, layer_depths, revolved_cells
from warpffrf.model.messages.named_arguments import named_arguments
from warpffrf.model.surfaces.curve import Curve


@named_arguments
def cam(
    curve: Curve,
    width: float,
    *,
    bore_radius: float,
    sectors: int,
    axial: Any,
    layers: int | None = None,
    grading: float | None = None,
    order: int = 2,
) -> Mesh:
    """A disc within a closed curve, with a bore about the curve's origin, axis y: facet sets `rim`, `bore`, `ends`.

    Parameters (lengths in m)
    -------------------------
    curve: a closed `surfaces.Curve` about its origin, counter-clockwise, which every ray from the origin meets once;
        its x runs along +x, as that of `surfaces.Extruded(curve=curve, axis_point=(0, 0, 0))`.
    width: along the axis; bore_radius: of the bore.
    sectors: cells around, of equal length along the curve; axial: cells along the axis, or their boundaries (n + 1,),
        rising from -width/2 to width/2.
    layers, grading: as in `mesh.roller`, from the curve inwards; the wall is the thinnest one.
    order: 1 for hex8, 2 for curved hex27, nodes on the curve.

    Raises `InputError` for a curve that is open, clockwise or not star-shaped, and a bore that does not fit.

    >>> oval = wf.surfaces.Curve.through([[0.05, 0], [0, 0.04], [-0.05, 0], [0, -0.04]], closed=True)
    >>> disc = wf.mesh.cam(oval, 0.01, bore_radius=0.01, sectors=48, axial=2, order=1)
    >>> sorted(disc.facet_sets)
    ['bore', 'ends', 'rim']
    """
    if not isinstance(curve, Curve) or not curve.closed:
        raise InputError(f"cam: curve must be a closed surfaces.Curve, got {curve!r}")
    half = 0.5 * require_number(width, "cam: width", positive=True)
    r_i = require_number(bore_radius, "cam: bore_radius", positive=True)
    count = require_count(sectors, "cam: sectors", 3)
    if order not in KINDS:
        raise InputError(f"cam: order must be 1 (hex8) or 2 (hex27), got {order!r}")
    cells_along: Any = axial if np.ndim(axial) else require_count(axial, "cam: axial", 1)
    require_cells("cam", count, layers, cells_along)
    u = curve.knots[0] + curve.length * np.arange(order * count) / (order * count)
    every = np.concatenate([u, curve.knots])
    points, tangents = curve.at(every), curve.at(every, 1)
    if np.any(points[:, 0] * tangents[:, 1] - points[:, 1] * tangents[:, 0] <= 0.0):
        raise InputError(
            "cam: the curve must run counter-clockwise about its origin and meet every ray from there once; shift or "
            "reverse its points"
        )
    radius = np.hypot(*points.T)
    if radius.min() <= r_i:
        raise InputError(f"cam: bore_radius {r_i:g} m does not fit; make it smaller than {radius.min():.4g} m")
    wall = float(radius.min() - r_i)
    depth = layer_depths(wall, layers, grading, curve.length / count, "cam")
    lines = axial_lines(-half, half, cells_along, None, "cam")
    y = refined(lines, order)
    fractions = refined(1.0 - depth[::-1] / wall, order)[:, None]  # bore (0) to rim (1)
    rim = points[: len(u)]
    bore = r_i * rim / radius[: len(u), None]
    flat = bore[:, None] + fractions * (rim - bore)[:, None]
    place = np.empty((*flat.shape[:2], len(y), 3))
    place[..., 0], place[..., 1], place[..., 2] = flat[..., :1], y, -flat[..., 1:]
    cells, facets = revolved_cells(count, len(depth) - 1, len(lines) - 1, order)
    return Mesh(place.reshape(-1, 3), cells, facets, None, "cam")
