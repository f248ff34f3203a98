"""What all meshes of revolution share: layer depths, mid nodes, cells and facet sets numbered sector by sector.

Cylindrical coordinates about the axis e_a = +y with e_0 = +x and e_1 = e_a x e_0 = -z:

    x(r, theta, y) = r (cos(theta) e_0 + sin(theta) e_1) + y e_a.

A cell's reference axes are (xi, eta, zeta) = (r, theta, y), right-handed because e_0 x e_1 = e_a. All nodes, those in
the middle of edges included, lie on the true circles: isoparametric quadratic cells then carry the round shape.

Layer thicknesses grow from the contact side of the wall as h, g h, g^2 h, ... with n layers filling the wall:
h (g^n - 1)/(g - 1) = wall.
"""

from __future__ import annotations

import logging
from typing import Any

import numpy as np

from warpffrf.model.errors import InputError, require_array, require_count, require_number
from warpffrf.model.mesh.elements import cell_kind
from warpffrf.model.mesh.facets import FacetSet
from warpffrf.model.mesh.shapes.cell_count import require_cells

logger = logging.getLogger(__name__)

ON_AXIS = 1e-9  # of the width: a shape's axis this close to y is y
SAME_END = 1e-9  # of the width: boundaries that miss an end by round-off end there
BESIDE_GROWTH = 1.4  # of the cells beside a tread, along the axis
MOST_BESIDE = 0.25  # of the width beside it: largest cell there
DEFAULT_GROWTH = 1.4  # layer growth when layers are chosen: neighbours within a factor 1.4 keep cells well shaped
# Growth above which few layers are worth a warning. The measured pair of `structured` at g = 2, rim layer as
# deep as wide, has 1 % less half-width and 3 % less approach than at g = 1.3; at g = 4 it is 5 % and 9 %.
STEEP_GROWTH = 2.0


def layer_depths(
    wall: float, layers: int | None, grading: float | None, size: float, label: str = "roller"
) -> np.ndarray:
    """Depths of the layer boundaries (layers + 1,) behind the contact side, from 0 to `wall` [m].

    `size` [m]: wanted thickness of the first layer; `layers`, `grading`: number and growth of the layers, chosen where
    None; `label`: who asks, for messages. Raises `InputError` for a growth that never fills the wall.
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
    beside it; or the boundaries themselves. Raises `InputError` for a tread that does not fit, and for boundaries that
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
        raise InputError(f"{label}: axial says where all cells are; leave tread out")
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
    """Positions z (n,) [m] of a shape's meridian at `y`; raises `InputError` where its axis is not y, or still open."""
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
