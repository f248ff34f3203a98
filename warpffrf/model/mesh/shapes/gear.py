r"""An involute gear in hexahedra, spur or helical, sector by sector.

Axis and frame as in `revolved`: the section's x runs along e_0 = +x, its y along e_1 = -z. Sections of a helical gear
are rotated by tau y about the axis, bore and rim with them. Half of a tooth, right of its axis of symmetry, with nodes
exactly on the curve of the flank:

        tip land
     T-----------.        skin:  N to T along the fillet and the flank, and on the tip land, `layers` cells deep
     | \  skin   |        core:  behind it, its lines across the tooth are arcs
     |  C--------|        root:  from the middle of the root to N, where the fillet is inclined by ROOT_SHARE of the
     s  |  core  |               angle of the root
     k  |        |        rim:   below the core, radial lines from D, the core's corner, to the bore
     i  |        |
     n  |        |        At N two cells meet in right angles, at D five cells meet.
   __N--D--------|
    root \  rim  |

From the point (X, -h) of the right flank, X along the tooth's axis, with the direction (-sin b, cos b) the arc is

    (X - h (cos(q b) - cos b)/sin b,  h sin(q b)/sin b),      -1 <= q <= 1.

b is the inclination of the normal in N, and fades with the power FADE of the way to the tip.
The sectors are copies of the first by rotation, the nodes on their common sides are one.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from warpffrf.model.errors import InputError, require_count, require_number
from warpffrf.model.gears.gear import Gear
from warpffrf.model.gears.tooth import curve, joined
from warpffrf.model.mesh.data import Mesh
from warpffrf.model.mesh.facets import FacetSet
from warpffrf.model.mesh.periodicity import Cyclic
from warpffrf.model.mesh.shapes.cell_count import require_cells
from warpffrf.model.mesh.shapes.disc import KINDS, Face, assembled, refined
from warpffrf.model.mesh.shapes.revolved import axial_lines, layer_depths
from warpffrf.model.messages.named_arguments import named_arguments

Array = np.ndarray

SKIN = 0.35  # of half the tooth's thickness: depth of the skin
SKIN_GROWTH = 1.4  # of its layers
ROOT_SHARE = 0.7  # of the angle between the root's normal and the across direction, at N
LEAN = 3  # power of the way along the flank with which the lines of the skin lean towards the corner C
FADE = 4
STRAIGHT = 1e-6  # rad: smallest angle of an arc
LEAST = 2  # cells along fillet and root
SAME = 1e-9  # cells: round-off of their number
LEAST_RIM = 0.2  # of the distance of D from the reference circle: thinnest rim below D


@named_arguments
def gear(
    gear: Gear,
    width: float,
    *,
    rim_radius: float,
    teeth: int | None = None,
    along: Any = 12,
    across: int = 4,
    layers: int = 2,
    rim_layers: int | None = None,
    axial: Any = 4,
    order: int = 2,
) -> Mesh:
    """An involute gear on a rim, axis y, centred in the origin, or a segment of it with `teeth` teeth.

    Parameters (lengths in m)
    -------------------------
    gear: `gears.Gear`; tooth 1 lies about +x, the others follow counter-clockwise about the axis, as the gear's curves
        in `surfaces.Extruded(curve=gear.flank("right", 3), axis_point=(0, 0, 0))`. Teeth of a helical gear are there
        in the middle of the width.
    width: along the axis; rim_radius: of the bore of an external gear, of the outside of an internal one.
    teeth: of a segment, from tooth 1 on; None: all teeth, rotationally periodic.
    along: cells along the involute, those on fillet and root are as long; or their boundaries (n + 1,) as shares of its
        length, rising from 0 at the fillet to 1: the last cell is as long as those on the rounding of the tip.
    across: cells across the tooth behind `layers` thin ones at each flank; rim_layers: below the teeth, None: growing
        by 1.4 from those at the flank.
    axial: cells along the axis, or their boundaries (n + 1,), rising from -width/2 to width/2.
    order: 1 for hex8, 2 for curved hex27, nodes on the true flanks.

    Facet sets, k from 1 on: `flank_right_k` and `flank_left_k`, the involute with its tip rounding; `roots`, fillets
    and root lands; `tips`; `bore`, or `outside` of an internal gear; `ends`; of a segment `side_low` and `side_high`.
    Raises `InputError` for a rim too thin for the mesh, inverted cells, and other impossible sizes.

    >>> pinion = wf.gears.Gear(4.5e-3, 16, profile_shift=0.1817)
    >>> mesh = wf.mesh.gear(pinion, 14e-3, rim_radius=15e-3, teeth=3, order=1)
    >>> mesh.sets["flank_right_3"]
    48
    """
    if not isinstance(gear, Gear):
        raise InputError(f"gear: gear must be a gears.Gear, got {gear!r}")
    half = 0.5 * require_number(width, "gear: width", positive=True)
    rim = require_number(rim_radius, "gear: rim_radius", positive=True)
    count = gear.teeth if teeth is None else require_count(teeth, "gear: teeth", 1, gear.teeth - 1)
    n = {name: require_count(value, f"gear: {name}", 1) for name, value in (("across", across), ("layers", layers))}
    shares = (
        np.asarray(along, float) if np.ndim(along) else np.linspace(0, 1, require_count(along, "gear: along", 1) + 1)
    )
    if (
        shares.ndim != 1
        or len(shares) < 2
        or shares[0] != 0.0
        or shares[-1] != 1.0
        or not np.all(np.diff(shares) > 0.0)
    ):
        raise InputError(f"gear: boundaries of along must rise from 0 to 1, got {along!r}")
    if order not in KINDS:
        raise InputError(f"gear: order must be 1 (hex8) or 2 (hex27), got {order!r}")
    cells_along: Any = axial if np.ndim(axial) else require_count(axial, "gear: axial", 1)
    require_cells("gear", count, 2 * len(shares), n["across"] + 2 * n["layers"], cells_along)
    y = refined(axial_lines(-half, half, cells_along, None, "gear"), order)
    flat, sets = _sector(gear, rim, shares, n, rim_layers, order)
    lattices = []
    c, s = np.cos(gear.twist * y), np.sin(gear.twist * y)
    for lattice in flat:
        u, v = lattice[..., :1], lattice[..., 1:]
        lattices.append(np.stack(np.broadcast_arrays(c * u - s * v, y, -s * u - c * v), axis=-1))
    sector = assembled(lattices, order, sets, "gear")
    try:
        sector.check()
    except InputError as error:
        raise InputError(
            "gear: the mesh has inverted cells, as tips are narrow or fillets tight; take another tip_diameter, a "
            "smaller tip_rounding or a larger root_radius"
        ) from error
    return _repeated(sector, gear.teeth, count)


def _sector(
    gear: Gear, rim: float, shares: Array, n: dict[str, int], rim_layers: int | None, order: int
) -> tuple[list[Array], dict[str, Sequence[Face]]]:
    """Lattices (a, b, 2) [m] of the sector of tooth 1, and its facet sets."""
    from scipy.optimize import brentq

    sign, parts = gear.side, gear.half
    contour = curve(joined([part for name, part in parts.items() if name != "tip"]))
    lengths = {name: float(part[0].sum()) for name, part in parts.items()}
    rounding, s_fillet = lengths.get("rounding", 0.0), lengths.get("root", 0.0)
    s_form = s_fillet + lengths["fillet"]
    s_end = s_form + lengths["involute"]
    s_tip = s_end + rounding
    size = lengths["involute"] / (len(shares) - 1)

    def inclination(s: float) -> float:
        """b [rad] of the true normal."""
        normal = sign * contour.normal(s)
        return float(np.arctan2(normal[0], -normal[1]))

    b_N = ROOT_SHARE * inclination(s_fillet)
    s_N = float(brentq(lambda s: inclination(s) - b_N, s_fillet, s_form))  # pyright: ignore[reportArgumentType]

    def places(start: float, end: float, least: int, size: float = size) -> Array:
        return refined(np.linspace(start, end, max(int(np.ceil((end - start) / size - SAME)), least) + 1), order)

    def arcs(s: Array, q: Array) -> Array:
        """Points (len(s), len(q), 2) of the arcs across the tooth."""
        X, h = (sign * contour.at(s) * [1.0, -1.0]).T[:, :, None]
        b = np.maximum(b_N * (1.0 - (s[:, None] - s_N) / (s_tip - s_N)) ** FADE, STRAIGHT)
        dip = h * (np.cos(q * b) - np.cos(b)) / np.sin(b)
        return sign * np.stack([X - dip, h * np.sin(q * b) / np.sin(b)], axis=-1)

    fillet = places(s_N, s_form, LEAST)
    outer = np.concatenate([fillet, refined(s_form + lengths["involute"] * shares, order)[1:]])
    if rounding:
        outer = np.concatenate([outer, places(s_end, s_tip, 1, lengths["involute"] * (shares[-1] - shares[-2]))[1:]])
    corner = contour.at(s_tip)
    lean = SKIN * abs(corner[1]) + rounding
    inner = outer - lean * ((outer - s_N) / (s_tip - s_N)) ** LEAN
    core = arcs(inner, (1.0 - SKIN) * np.linspace(-1.0, 1.0, order * n["across"] + 1))

    depth = np.concatenate([[0.0], np.cumsum(SKIN_GROWTH ** np.arange(n["layers"]))])
    fractions = refined(depth / depth[-1], order)[:, None]
    skin = _between(contour.at(outer), core[:, 0], fractions)
    polar = float(np.arctan2(corner[1], corner[0]))
    top = _between(_circle(0.5 * gear.tip_diameter, polar, -polar, core.shape[1]), core[-1], fractions)

    reach, deepest = float(np.hypot(*core[0, 0])), float(np.max(sign * -np.hypot(*core[0].T)))
    wall = sign * (reach - rim)
    if -sign * rim - deepest < LEAST_RIM * abs(reach - 0.5 * gear.reference_diameter):
        raise InputError(
            f"gear: rim_radius {rim:g} m leaves a rim too thin for the mesh, in which teeth reach to "
            f"{abs(deepest):.4g} m; make it {'smaller' if sign > 0 else 'larger'}"
        )
    last = float(np.linalg.norm(skin[0, -1] - skin[0, -1 - order]))
    down = refined(layer_depths(wall, rim_layers, None, last, "gear") / wall, order)[:, None]
    angle = float(np.arctan2(core[0, 0, 1], core[0, 0, 0]))
    under = _between(core[0], _circle(rim, angle, -angle, len(core[0])), down)
    inside = np.concatenate([skin[0], under[0, 1:]])
    way = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(inside, axis=0), axis=1))])
    foot, middle = contour.at(places(0.0, s_N, LEAST)), -sign * np.pi / gear.teeth
    side = _between(foot[:1], _circle(rim, middle, middle, 1), (way / way[-1])[:, None])[0]
    root = _filled(foot, _circle(rim, middle, angle, len(foot)), side, inside, way / way[-1])

    halves = [skin[: len(fillet)], skin[len(fillet) - 1 :], root]
    lattices = [*halves, *(part * [1.0, -1.0] for part in halves), top, core, under]
    low, high = ((2, 0, 0), (5, 0, 0))[::sign]
    sets: dict[str, Sequence[Face]] = {
        "flank_right": [(1, 1, 0)],
        "flank_left": [(4, 1, 0)],
        "roots": [(number, 1, 0) for number in (0, 2, 3, 5)],
        "tips": [(6, 1, 0)],
        "outside" if gear.internal else "bore": [(number, 1, 1) for number in (2, 5, 8)],
        "ends": [(number, 2, end) for number in range(len(lattices)) for end in (0, 1)],
        "side_low": [low],
        "side_high": [high],
    }
    return lattices, sets


def _circle(radius: float, start: float, end: float, count: int) -> Array:
    """Points (count, 2) on a circle about the axis between two polar angles."""
    polar = np.linspace(start, end, count)
    return radius * np.stack([np.cos(polar), np.sin(polar)], axis=1)


def _between(first: Array, second: Array, fractions: Array) -> Array:
    """Points (n, m, 2) at fractions (m, 1) of the lines from `first` to `second` (n, 2)."""
    return first[:, None] + fractions * (second - first)[:, None]


def _filled(top: Array, bottom: Array, left: Array, right: Array, v: Array) -> Array:
    """Points (n, m, 2) within four edges: top and bottom (n, 2), left and right (m, 2) at fractions v (m,) of the way
    down (Coons 1967)."""
    u, v = np.linspace(0.0, 1.0, len(top))[:, None, None], v[None, :, None]
    across = (1.0 - u) * left + u * right
    down = (1.0 - v) * top[:, None] + v * bottom[:, None]
    corners = (1.0 - v) * ((1.0 - u) * top[0] + u * top[-1]) + v * ((1.0 - u) * bottom[0] + u * bottom[-1])
    return across + down - corners


def _repeated(sector: Mesh, sectors: int, count: int) -> Mesh:
    """`count` copies of a sector of `sectors`, numbered sector by sector."""
    from scipy.spatial import KDTree

    pitch = 2.0 * np.pi / sectors

    def rotated(points: Array, k: int) -> Array:
        c, s = np.cos(pitch * k), np.sin(pitch * k)
        return points @ np.array([[c, 0.0, -s], [0.0, 1.0, 0.0], [s, 0.0, c]])

    low, high = sector.facet_sets["side_low"].node_set, sector.facet_sets["side_high"].node_set
    partner = low[KDTree(sector.points[low]).query(rotated(sector.points[high], -1))[1]]
    own = np.setdiff1d(np.arange(len(sector.points)), high)
    number = np.empty(len(sector.points), dtype=np.int64)
    number[own] = np.arange(len(own))
    number[high] = len(own) + number[partner]
    points = np.concatenate([rotated(sector.points[own], k) for k in range(count)])
    new = np.arange((count + 1) * len(own))
    whole = count == sectors
    if whole:
        new %= count * len(own)
    else:  # the far side of the last copy
        ends = np.sort(partner)
        new[count * len(own) + number[ends]] = len(points) + np.arange(len(ends))
        points = np.concatenate([points, rotated(sector.points[ends], count)])

    def copies(nodes: Array) -> list[Array]:
        return [new[number[nodes] + k * len(own)] for k in range(count)]

    ((kind, cells),) = sector.cells.items()
    sets: dict[str, FacetSet] = {}
    for name, facets in sector.facet_sets.items():
        facet, nodes = facets.single
        parts = copies(nodes)
        if name.startswith("flank"):
            sets.update({f"{name}_{k + 1}": FacetSet({facet: part}) for k, part in enumerate(parts)})
        elif not name.startswith("side"):
            sets[name] = FacetSet({facet: np.concatenate(parts)})
        elif not whole:
            sets[name] = FacetSet({facet: parts[0 if name == "side_low" else -1]})
    cyclic = Cyclic(sectors, np.zeros(3), np.array([0.0, 1.0, 0.0])) if whole else None
    return Mesh(points, {kind: np.concatenate(copies(cells))}, sets, cyclic, sector.name)
