r"""Bodies that carry a contact on their inside: a sleeve around a pin, an outer ring with a groove for balls.

Axis and frame as in `revolved`. The inner radius is constant for a sleeve; a groove is a circular arc of radius Rc in
every plane through the axis, deepest at y = 0,

    R(y) = R0 - (Rc - sqrt(Rc^2 - y^2)),      R0 = bore radius + groove depth,

between the two edges where it meets the bore. A node at fraction f of the wall has r = R(y) + f (R_o - R(y)); layers
grow from the inside outwards.

With a `fine_arc` the cells around are equal only within that angle on both sides of theta = 0 (+x) and grow towards
the back by `ARC_GROWTH`, up to `LARGEST_ANGLE`: for a contact that stays there. Such a mesh is not periodic.
"""

from __future__ import annotations

import numpy as np

from warpffrf.model.errors import InputError, require_count, require_number
from warpffrf.model.mesh.cyclic import Cyclic
from warpffrf.model.mesh.data import Mesh
from warpffrf.model.mesh.facets import FacetSet
from warpffrf.model.mesh.shapes.cell_count import require_cells
from warpffrf.model.mesh.shapes.lattice import KINDS, refined
from warpffrf.model.mesh.shapes.revolved import axial_lines, layer_depths, revolved_cells, revolved_points, tread_facets
from warpffrf.model.messages.named_arguments import named_arguments
from warpffrf.model.surfaces.fit import crown_drop

ARC_GROWTH = 1.3  # of cells behind the fine arc
LARGEST_ANGLE = np.radians(15.0)  # of a cell there: curved quadratic cells are round to 1e-5 then, linear ones to 1e-2


@named_arguments
def sleeve(
    inner_radius: float,
    outer_radius: float,
    width: float,
    *,
    sectors: int,
    axial: int,
    layers: int | None = None,
    grading: float | None = None,
    fine_arc: float | None = None,
    order: int = 2,
) -> Mesh:
    """A tube with axis y, centred in the origin, graded towards its bore: facet sets `bore`, `outside` and `ends`.

    Parameters (lengths in m)
    -------------------------
    inner_radius, outer_radius, width: of the bore, of the outside, and along the axis.
    sectors, axial, layers: cells around, along the axis, through the wall. `sectors` cells would fill the whole turn
        also where only a part of it is fine.
    grading: growth of the layer thickness from the bore outwards. `layers` and `grading` left out: a first layer as
        deep as the smaller side of a cell, growth 1.4 for chosen and solved for with given layers, as in `mesh.roller`.
    fine_arc: half the angle [rad] about +x that has cells of that size; behind it they grow. It adds the facet set
        `patch`, the bore within that arc. None: equal cells around, rotationally periodic.
    order: 1 for hex8, 2 for curved hex27.

    Raises `InputError` for impossible sizes.

    >>> tube = wf.mesh.sleeve(0.02, 0.03, 0.01, sectors=48, axial=2, order=1)  # m
    >>> sorted(tube.facet_sets)
    ['bore', 'ends', 'outside']
    """
    label = "sleeve"
    inside, outside = _radii(label, inner_radius, outer_radius)
    half = 0.5 * require_number(width, f"{label}: width", positive=True)
    _check_order(label, order)
    require_cells(label, sectors, layers, axial)
    y = refined(np.linspace(-half, half, require_count(axial, f"{label}: axial", 1) + 1), order)
    return _turned(label, np.full(len(y), inside), outside, y, sectors, layers, grading, fine_arc, order)


@named_arguments
def ring(
    bore_radius: float,
    outer_radius: float,
    width: float,
    *,
    groove_radius: float,
    groove_depth: float,
    sectors: int,
    axial: int,
    lands: int = 1,
    tread: float | None = None,
    layers: int | None = None,
    grading: float | None = None,
    fine_arc: float | None = None,
    order: int = 2,
) -> Mesh:
    """An outer ring with a groove on its inside: facet sets `groove`, `lands` (the bore beside it), `outside`, `ends`.

    Parameters (lengths in m)
    -------------------------
    bore_radius: of the lands, the smallest; the groove is deepest at `bore_radius + groove_depth`.
    groove_radius: of the arc in planes through the axis, above half the groove's width.
    axial: equal cells across the groove; lands: cells across each land.
    tread: width of a band in the middle of the groove that has all `axial` cells; beside it they grow. It adds the
        facet set `tread`.
    outer_radius, sectors, layers, grading, order, fine_arc: as for `sleeve`; `patch` is the groove, or its tread,
    within `fine_arc`.

    The groove's surface is the inside of a crowned cylinder of radius `bore_radius + groove_depth` and crown radius
    `groove_radius`. Raises `InputError` for impossible sizes.
    """
    label = "ring"
    inside, outside = _radii(label, bore_radius, outer_radius)
    half = 0.5 * require_number(width, f"{label}: width", positive=True)
    Rc = require_number(groove_radius, f"{label}: groove_radius", positive=True)
    deep = require_number(groove_depth, f"{label}: groove_depth", positive=True)
    _check_order(label, order)
    require_cells(label, sectors, layers, axial)
    require_cells(label, sectors, layers, lands)
    if deep >= Rc or inside + deep >= outside:
        raise InputError(
            f"{label}: groove_depth {deep:g} must be smaller than groove_radius {Rc:g} and than the wall "
            f"{outside - inside:g}"
        )
    edge = float(np.sqrt(deep * (2.0 * Rc - deep)))  # Rc - sqrt(Rc^2 - edge^2) = depth
    if edge >= half:
        raise InputError(f"{label}: the groove is {2.0 * edge:g} m wide, the ring {2.0 * half:g}; make it wider")
    middle = axial_lines(-edge, edge, require_count(axial, f"{label}: axial", 1), tread, label)
    beside = np.linspace(edge, half, require_count(lands, f"{label}: lands", 1) + 1)[1:]
    y = refined(np.concatenate([-beside[::-1], middle, beside]), order)
    # the edges' own rows lie on both surfaces
    radius = np.where(np.abs(y) < edge, inside + deep - crown_drop(np.clip(y, -edge, edge), 1.0 / Rc), inside)
    mesh = _turned(label, radius, outside, y, sectors, layers, grading, fine_arc, order)
    sets = dict(mesh.facet_sets)
    bore = sets.pop("bore")
    in_groove = np.abs(bore.centers(mesh.points)[:, 1]) < edge
    sets |= {"groove": bore.kept(in_groove), "lands": bore.kept(~in_groove)}
    if tread is not None:
        sets["tread"] = tread_facets(sets["groove"], mesh.points, tread)
    if "patch" in sets:
        sets["patch"] = tread_facets(sets["patch"], mesh.points, 2.0 * edge if tread is None else tread)
    return Mesh(mesh.points, mesh.cells, sets, mesh.cyclic, label)


def _radii(label: str, inner: float, outer: float) -> tuple[float, float]:
    inside = require_number(inner, f"{label}: inner radius", positive=True)
    outside = require_number(outer, f"{label}: outer_radius", positive=True)
    if inside >= outside:
        raise InputError(f"{label}: inner radius {inside:g} must be smaller than outer_radius {outside:g}")
    return inside, outside


def _check_order(label: str, order: int) -> None:
    if order not in KINDS:
        raise InputError(f"{label}: order must be 1 (hex8) or 2 (hex27), got {order!r}")


def _turned(
    label: str,
    inside: np.ndarray,
    outside: float,
    y: np.ndarray,
    sectors: int,
    layers: int | None,
    grading: float | None,
    fine_arc: float | None,
    order: int,
) -> Mesh:
    """The body between `inside` (rows,) [m] and `outside` [m] around, with sets `bore`, `outside`, `ends` (`patch`)."""
    sectors = require_count(sectors, f"{label}: sectors", 3)
    pitch = 2.0 * np.pi / sectors
    corners = pitch * np.arange(sectors) if fine_arc is None else _arc_lines(label, fine_arc, pitch)
    theta = corners
    if order == 2:
        after = np.append(corners[1:], corners[0] + 2.0 * np.pi)
        theta = np.stack([corners, 0.5 * (corners + after)], axis=1).ravel()
    wall = outside - float(inside.max())
    side = min(pitch * float(inside.max()), order * float(np.diff(y).min()))  # of the smallest cell on the inside
    depth = layer_depths(wall, layers, grading, side, label)
    fraction = refined(depth / wall, order)
    radius = inside + fraction[:, None] * (outside - inside)
    cells, facets = revolved_cells(len(corners), len(depth) - 1, (len(y) - 1) // order, order)
    sets = {"bore": facets["bore"], "outside": facets["rim"], "ends": facets["ends"]}
    cyclic = Cyclic(sectors, np.zeros(3), np.array([0.0, 1.0, 0.0])) if fine_arc is None else None
    if fine_arc is not None:
        ((kind, nodes),) = sets["bore"].blocks.items()
        by_column = nodes.reshape(len(corners), -1, nodes.shape[1])
        sets["patch"] = FacetSet({kind: by_column[: _fine_columns(fine_arc, pitch)].reshape(-1, nodes.shape[1])})
    return Mesh(revolved_points(radius, theta, y), cells, sets, cyclic, label)


def _fine_columns(fine_arc: float, pitch: float) -> int:
    """Equal cells in the fine arc: an even number that fills it."""
    return 2 * max(int(np.ceil(fine_arc / pitch - 1e-9)), 1)


def _arc_lines(label: str, fine_arc: float, pitch: float) -> np.ndarray:
    """Angles [rad] of the cells' first sides, from the start of the fine arc on around: `pitch` in it, growing behind.

    The cells behind the arc are mirror images of each other about the back.
    """
    half = require_number(fine_arc, f"{label}: fine_arc", positive=True)
    fine = _fine_columns(half, pitch)
    rest = np.pi - 0.5 * fine * pitch
    if rest <= pitch:
        raise InputError(f"{label}: fine_arc {half:g} rad leaves nothing to grow in; leave it out for equal cells")
    sizes, size = [], pitch
    while sum(sizes) < rest:
        size = max(min(size * ARC_GROWTH, LARGEST_ANGLE), pitch)
        sizes.append(size)
    sizes = np.array(sizes) * rest / sum(sizes)
    behind = 0.5 * fine * pitch + np.cumsum(np.concatenate([sizes, sizes[::-1]]))
    return np.concatenate([pitch * (np.arange(fine + 1) - 0.5 * fine), behind[:-1]])
