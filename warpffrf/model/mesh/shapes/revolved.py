r"""Common parts of meshes of revolution: layer depths, mid nodes, cells and facet sets numbered sector by sector.

Cylindrical coordinates about the axis e_a = +y with e_0 = +x and e_1 = e_a x e_0 = -z:

    x(r, theta, y) = r (cos(theta) e_0 + sin(theta) e_1) + y e_a.

A cell's reference axes are (xi, eta, zeta) = (r, theta, y), right-handed because e_0 x e_1 = e_a. All nodes, those in
the middle of edges included, lie on the true circles: isoparametric quadratic cells then carry the round shape.

Layer thicknesses grow from the contact side of the wall as h, g h, g^2 h, ... with n layers filling the wall:
h (g^n - 1)/(g - 1) = wall.

Sleeve. Bodies that carry a contact on their inside: a sleeve around a pin, an outer ring with a groove for balls.

Axis and frame as in `revolved`. The inner radius is constant for a sleeve; a groove is a circular arc of radius Rc in
every plane through the axis, deepest at y = 0,

    R(y) = R0 - (Rc - sqrt(Rc^2 - y^2)),      R0 = bore radius + groove depth,

between the two edges where it meets the bore. A node at fraction f of the wall has r = R(y) + f (R_o - R(y)); layers
grow from the inside outwards.

With a `fine_arc` the cells around are equal only within that angle on both sides of theta = 0 (+x) and grow towards
the back by `ARC_GROWTH`, up to `LARGEST_ANGLE`: for a contact that remains there. Such a mesh is not periodic.
"""

from __future__ import annotations

import logging
from typing import Any

import numpy as np

from warpffrf.model.errors import InputError, require_array, require_count, require_number
from warpffrf.model.mesh.data import Mesh
from warpffrf.model.mesh.elements import cell_kind
from warpffrf.model.mesh.facets import FacetSet
from warpffrf.model.mesh.periodicity import Cyclic
from warpffrf.model.mesh.shapes.cell_count import require_cells
from warpffrf.model.mesh.shapes.disc import KINDS, refined
from warpffrf.model.messages.named_arguments import named_arguments
from warpffrf.model.surfaces.fit import crown_drop

logger = logging.getLogger(__name__)

ON_AXIS = 1e-9  # of the width: a shape's axis this close to y is y
SAME_END = 1e-9  # of the width: boundaries that miss an end by round-off end there
BESIDE_GROWTH = 1.4  # of the cells next to a tread, along the axis
MOST_BESIDE = 0.25  # of the width next to it: largest cell there
DEFAULT_GROWTH = 1.4  # layer growth when layers are chosen: neighbours within a factor 1.4 keep cells well shaped
# Growth above which few layers are worth a warning. The measured pair of `structured` at g = 2, rim layer as
# deep as wide, has 1 % less half-width and 3 % less approach than at g = 1.3; at g = 4 it is 5 % and 9 %.
STEEP_GROWTH = 2.0


def layer_depths(
    wall: float, layers: int | None, grading: float | None, size: float, label: str = "roller"
) -> np.ndarray:
    """Depths of the layer boundaries (layers + 1,) behind the contact side, from 0 to `wall` [m].

    `size` [m]: required thickness of the first layer; `layers`, `grading`: number and growth of the layers, chosen if
    None; `label`: the caller, for messages. Raises `InputError` for a growth that never fills the wall.
    """
    if grading is not None:
        grading = require_number(grading, f"{label}: grading", positive=True)
    if layers is None:
        growth = DEFAULT_GROWTH if grading is None else grading
        reach = 1.0 + wall * (growth - 1.0) / size
        if reach <= 0.0:
            raise InputError(
                f"{label}: layers shrinking by {growth:g} from {size:g} never fill the wall; raise grading"
            )
        count = wall / size if growth == 1.0 else np.log(reach) / np.log(growth)
        layers = max(int(np.ceil(count)), 1)
        require_cells(label, layers)
    else:
        layers = require_count(layers, f"{label}: layers", 1)
        growth = _growth_for(wall / size, layers) if grading is None else grading
        if grading is None and growth > STEEP_GROWTH:
            logger.warning(
                "%s: with layers=%d each is %.3g times as deep as the one outside it, which makes the rim too "
                "stiff; use layers >= %d",
                label,
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


def axial_lines(low: float, high: float, cells: Any, tread: float | None, label: str) -> np.ndarray:
    """Boundaries (n + 1,) [m] of the cells from `low` to `high` [m] along the axis.

    `cells`: how many equal ones, or, with a `tread` [m], that many in a band of that width about 0 and growing ones
    next to it; or the boundaries themselves. Raises `InputError` for a tread that does not fit, and for boundaries that
    do not rise from `low` to `high`.
    """
    if np.ndim(cells):
        return _given_lines(low, high, cells, tread, label)
    if tread is None:
        return np.linspace(low, high, cells + 1)
    half = 0.5 * require_number(tread, f"{label}: tread", positive=True)
    if half >= min(-low, high):
        raise InputError(f"{label}: tread {2.0 * half:g} is as wide as the surface; leave it out for equal cells")
    middle = np.linspace(-half, half, cells + 1)
    beside = [half + _growing(end - half, 2.0 * half / cells) for end in (-low, high)]
    return np.concatenate([-beside[0][::-1], middle, beside[1]])


def _given_lines(low: float, high: float, places: Any, tread: float | None, label: str) -> np.ndarray:
    if tread is not None:
        raise InputError(f"{label}: axial defines all cells; leave tread out")
    lines = require_array(places, f"{label}: axial", (None,))
    reach = SAME_END * (high - low)
    if len(lines) < 2 or abs(lines[0] - low) > reach or abs(lines[-1] - high) > reach or np.any(np.diff(lines) <= 0.0):
        raise InputError(
            f"{label}: axial must be a number of cells, or their boundaries, rising from {low:g} to {high:g} m"
        )
    return lines


def _growing(length: float, size: float) -> np.ndarray:
    """Ends (n,) [m] of cells that fill `length` [m], the first somewhat larger than `size` [m]."""
    largest, sizes = max(MOST_BESIDE * length, size), []
    while sum(sizes) < length:
        size = min(size * BESIDE_GROWTH, largest)
        sizes.append(size)
    return np.cumsum(sizes) * length / sum(sizes)


def tread_facets(facets: FacetSet, points: np.ndarray, tread: float) -> FacetSet:
    """The facets whose middles lie within the band of width `tread` [m] about y = 0."""
    return facets.kept(np.abs(facets.centers(points)[:, 1]) < 0.5 * tread)


def profile_radius(profile: Any, y: np.ndarray, label: str, *, above: float) -> np.ndarray:
    """Radii (n,) [m] of a `profile`, a shape with `radius_at` or a function, at axial positions `y` (n,) [m].

    Raises `InputError` where they are not all larger than `above` [m].
    """
    function, z = getattr(profile, "radius_at", profile), y
    if not callable(function):
        raise InputError(f"{label} must be a surface shape or a function of the axial position, got {profile!r}")
    if hasattr(profile, "radius_at") and hasattr(profile, "resolved"):
        z = _along(profile, y, label)
    given: Any = function(z)
    radius = require_array(np.broadcast_to(given, y.shape), label, (len(y),))
    if not np.all(radius > above):
        raise InputError(f"{label}: its smallest radius {radius.min():g} m leaves no wall above {above:g} m")
    return radius


def _along(shape: Any, y: np.ndarray, label: str) -> np.ndarray:
    """Positions z (n,) [m] of a shape's meridian at `y`; raises `InputError` where its axis is not y, or not given."""
    if not shape.resolved:
        raise InputError(
            f"{label}: the shape must be complete; give radius, axis_point=(0, 0, 0), axis_direction=(0, 1, 0)"
        )
    c, e_a = shape.axis_point, shape.e_a
    if abs(abs(e_a[1]) - 1.0) > ON_AXIS or np.hypot(c[0], c[2]) > ON_AXIS * float(np.max(np.abs(y))):
        raise InputError(f"{label}: the axis of the shape must be the body's, y; use axis_direction=(0, 1, 0)")
    return (y - c[1]) * e_a[1]


def revolved_points(radius: np.ndarray, theta: np.ndarray, y: np.ndarray) -> np.ndarray:
    """Points (n, 3) [m] at `radius` (layers, rows) [m], `theta` (t,) [rad], `y` (rows,) [m]: plane by plane."""
    points = np.empty((len(theta), *radius.shape, 3))
    points[..., 0] = np.cos(theta)[:, None, None] * radius
    points[..., 1] = y
    points[..., 2] = -np.sin(theta)[:, None, None] * radius
    return points.reshape(-1, 3)


def revolved_cells(sectors: int, layers: int, axial: int, order: int) -> tuple[dict, dict[str, FacetSet]]:
    """Cells and facet sets "rim" (outermost), "bore" and "ends" of nodes numbered by sector, plane, layer, axial row.

    Sector-major: one sector's cells, shifted by the nodes of a sector. The last sector closes on the first.
    """
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
    sectors, axial, layers: cells around, along the axis, through the wall. `sectors` cells would fill a full
        revolution, also where only a part of it is fine.
    grading: growth of the layer thickness from the bore outwards. `layers` and `grading` not given: a first layer as
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
    """An outer ring with a groove on its inside: facet sets `groove`, `lands` (the bore next to it), `outside`, `ends`.

    Parameters (lengths in m)
    -------------------------
    bore_radius: of the lands, the smallest; the groove is deepest at `bore_radius + groove_depth`.
    groove_radius: of the arc in planes through the axis, above half the groove's width.
    axial: equal cells across the groove; lands: cells across each land.
    tread: width of a band in the middle of the groove that has all `axial` cells; next to it they grow. It adds the
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
        raise InputError(
            f"{label}: fine_arc {half:g} rad leaves no room for growing cells; leave it out for equal cells"
        )
    sizes, size = [], pitch
    while sum(sizes) < rest:
        size = max(min(size * ARC_GROWTH, LARGEST_ANGLE), pitch)
        sizes.append(size)
    sizes = np.array(sizes) * rest / sum(sizes)
    behind = 0.5 * fine * pitch + np.cumsum(np.concatenate([sizes, sizes[::-1]]))
    return np.concatenate([pitch * (np.arange(fine + 1) - 0.5 * fine), behind[:-1]])
