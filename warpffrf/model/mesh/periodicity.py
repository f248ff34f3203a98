r"""Rotational periodicity found in a mesh: axis, number of sectors, and which node is which one turned.

A body of N >= 3 equal sectors turns into itself under a rotation by phi = 2 pi/N about its axis. So do its nodes, hence

- the mean of the nodes lies on the axis, and the tensor of their second moments has it as an eigenvector, the two other
  eigenvalues being equal. Unequal ones say no at the cost of one pass over the nodes;
- nodes at one radius and height about the axis form rings, and every ring holds a multiple of N nodes, every kind a
  multiple of N cells: N divides the greatest common divisor of all those counts. Its divisors are tried from the
  largest down;
- turning maps nodes onto nodes (nearest neighbours, a few nodes first) and cells onto cells. Whether the sets of cells
  agree is seen from sums of random numbers given to the nodes: two different cells share a sum with probability 2^-64.

The nodes then fall into orbits of N. With x_s the s-th node of an orbit and c its mean, sum_s (x_s - c) x (x_{s+1} - c)
is parallel to the axis, exactly: summed over the orbits it gives the axis without the error of an eigenvector whose
eigenvalue is close to the others. Files carry few digits, so a node becomes the mean of its orbit's nodes turned back;
how far nodes move by that is reported, and refused above a tolerance.

A node on the axis is its own image and belongs to no sector: such bodies take the general path.
`sector_numbering` chooses the sectors and numbers the body by them.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from warpffrf.model.errors import InputError, require_array, require_count, require_direction
from warpffrf.model.mesh import sector_numbering
from warpffrf.model.mesh.cyclic import Cyclic
from warpffrf.model.mesh.sector_numbering import NotPeriodic, Orbits
from warpffrf.model.surfaces.fit import reference_direction, signed_axis

if TYPE_CHECKING:
    from warpffrf.model.mesh.data import Mesh

# Of the radius: how far a node may move onto its place. Files with 6 digits stay below it, and a contact surface is
# accepted as round to the same fraction (surfaces.DEFAULT_FIT_FRACTION).
LARGEST_MOVE = 1e-5
SAME_PLACE = 4.0  # in LARGEST_MOVE: two nodes off by that much each, about an axis found from such nodes
SAME_MOMENT = 1e-5  # of the largest second moment: what coordinates off by LARGEST_MOVE change it by, at most
LEAST_SECTORS = 3  # with two, the axis is not an axis of symmetry of the moments, and harmonics 1 and N/2 coincide
PROBES = 64  # nodes turned before all are: an N that is wrong for a fraction p of them passes with (1 - p)^64

Array = np.ndarray


@dataclass(frozen=True, eq=False)
class Detection:
    """A periodic body numbered by sectors, or the `reason` why it is none (`mesh` None).

    `node` (n,): number that each node of `mesh` had before. `largest_move` [m]: of a node onto its exact place.
    """

    mesh: Mesh | None
    reason: str
    node: Array
    largest_move: float


def detect(
    mesh: Mesh,
    *,
    axis_point: Any = None,
    axis_direction: Any = None,
    sectors: int | None = None,
    whole: Sequence[str] = (),
) -> Detection:
    """Look for rotational periodicity of the cells of `mesh`; what is None of axis and number of sectors is found.

    `whole` names facet and cell sets that must turn into themselves as well (interfaces, materials): the number of
    sectors is then the largest for which they do. Raises `InputError` for arguments that make no sense only.
    """
    point = None if axis_point is None else require_array(axis_point, "periodicity: axis_point", (3,))
    axis = None if axis_direction is None else require_direction(axis_direction, "periodicity: axis_direction")
    count = None if sectors is None else require_count(sectors, "periodicity: sectors", LEAST_SECTORS)
    for name in whole:
        if name not in mesh.facet_sets and name not in mesh.cell_sets:
            raise InputError(f"periodicity: {name!r} is neither a facet set nor a cell set of the mesh")
    try:
        return _detect(mesh, point, axis, count, whole)
    except NotPeriodic as reason:
        return Detection(None, str(reason), np.arange(len(mesh.points)), 0.0)


def find(mesh: Mesh) -> Cyclic | None:
    """Axis and largest number of equal sectors of the cells of `mesh`, or None."""
    if mesh.cyclic is not None:
        return mesh.cyclic
    found = detect(mesh).mesh
    return None if found is None else found.cyclic


def required(mesh: Mesh, *, axis_point: Any, axis_direction: Any, sectors: int | None) -> Mesh:
    """`mesh` numbered by sectors; raises `InputError` with the reason where it is not periodic."""
    found = detect(mesh, axis_point=axis_point, axis_direction=axis_direction, sectors=sectors)
    if found.mesh is None:
        raise InputError(f"mesh {mesh.name or '(unnamed)'} is not rotationally periodic: {found.reason}")
    return found.mesh


def _detect(mesh: Mesh, point: Array | None, axis: Array | None, count: int | None, whole: Sequence[str]) -> Detection:
    if not mesh.cells or mesh.matrices is not None:
        raise NotPeriodic("it comes as matrices, whose periodicity is not looked for")
    center = mesh.points.mean(axis=0)
    reason: NotPeriodic | None = None
    for direction in _axes(mesh.points - center) if axis is None else [axis]:
        try:
            return _about(mesh, center, point, direction, axis is None, count, whole)
        except NotPeriodic as fault:
            reason = reason or fault
    raise reason or NotPeriodic("no axis was found")


def _axes(relative: Array) -> list[Array]:
    """Directions that can be the axis, for positions relative to the mean of all nodes."""
    w, V = np.linalg.eigh(relative.T @ relative)
    same = np.diff(w) <= SAME_MOMENT * w[2]
    if same.all():  # moments of a sphere: any direction can be the axis; bodies are mostly drawn along one of x, y, z
        return [*np.eye(3), *V.T]
    if same.any():
        return [signed_axis(V[:, 2] if same[0] else V[:, 0])]
    raise NotPeriodic(
        f"the second moments of its nodes are all different ({', '.join(f'{v / w[2]:.6f}' for v in w)}), so it has no "
        "axis of symmetry"
    )


def _about(
    mesh: Mesh,
    center: Array,
    point: Array | None,
    axis: Array,
    free_axis: bool,
    count: int | None,
    whole: Sequence[str],
) -> Detection:
    """Detection about one direction; the axis passes through `point`, or through `center` where that is None."""
    origin = center if point is None else point
    frame = _frame(axis)
    local = (mesh.points - origin) @ frame.T
    radius = np.hypot(local[:, 0], local[:, 1])
    R = float(radius.max())
    close = SAME_PLACE * LARGEST_MOVE * R
    off = (center - origin) - ((center - origin) @ axis) * axis
    if np.linalg.norm(off) > close:
        raise NotPeriodic(f"the mean of its nodes lies {np.linalg.norm(off):.3g} m off the axis")
    on_axis = int(np.sum(radius <= close))
    if on_axis:
        raise NotPeriodic(f"{on_axis} of its nodes lie on the axis and belong to no sector")
    reason = NotPeriodic("no number of sectors maps its nodes onto one another")
    for N in _counts(mesh, radius, local[:, 2], close, count):
        try:
            orbits = _orbits(mesh, local, N, close, whole)
            # orbits know the axis better than the moments do
            exact = orbits.axis(local) @ frame if free_axis else axis
            frame_N = _frame(exact)
            orbits = orbits.placed((mesh.points - origin) @ frame_N.T)
            if orbits.largest_move > LARGEST_MOVE * R:
                raise NotPeriodic(
                    f"its nodes would have to move by up to {orbits.largest_move:.3g} m to be periodic in {N} sectors, "
                    f"{LARGEST_MOVE * R:.3g} m is accepted"
                )
            by_sector, node = sector_numbering.numbered(mesh, orbits, origin, frame_N)
        except NotPeriodic as fault:
            reason = fault
            continue
        return Detection(by_sector, f"{N} equal sectors", node, orbits.largest_move)
    raise reason


def _frame(axis: Array) -> Array:
    """Rows e_0, e_1, axis of a right-handed frame."""
    e_0 = reference_direction(axis)
    return np.stack([e_0, np.cross(axis, e_0), axis])


def _counts(mesh: Mesh, radius: Array, height: Array, close: float, count: int | None) -> Iterator[int]:
    """Numbers of sectors to try, the largest first."""
    by_radius = np.argsort(radius)
    band = np.empty(len(radius), dtype=np.int64)
    band[by_radius] = np.cumsum(np.diff(radius[by_radius], prepend=radius[by_radius[0]]) > close)
    order = np.lexsort((height, band))
    new_ring = (np.diff(band[order]) > 0) | (np.diff(height[order]) > close)
    rings = np.diff(np.flatnonzero(np.concatenate([[True], new_ring, [True]])))
    of_nodes = int(np.gcd.reduce(rings))
    common = int(np.gcd.reduce([of_nodes, *(len(nodes) for nodes in mesh.cells.values())]))
    if count is not None:
        if common % count:
            raise NotPeriodic(
                f"its rings of nodes about the axis and its cells come in multiples of {common}, not of {count}"
            )
        return iter([count])
    if common < LEAST_SECTORS:
        raise NotPeriodic(
            f"rings of nodes about the axis and cells have counts with the greatest common divisor {common}, fewer "
            f"than {LEAST_SECTORS} sectors"
        )
    low = [d for d in range(1, int(np.sqrt(common)) + 1) if common % d == 0]
    divisors = sorted({d for a in low for d in (a, common // a)}, reverse=True)
    return iter([d for d in divisors if d >= LEAST_SECTORS])


def _orbits(mesh: Mesh, local: Array, N: int, close: float, whole: Sequence[str]) -> Orbits:
    """Orbits of the nodes under a turn by 2 pi/N, once it maps nodes, cells and `whole` sets onto themselves."""
    from scipy.spatial import KDTree

    n = len(local)
    moved = sector_numbering.turned(local, 1, N)
    tree = KDTree(local)
    rng = np.random.default_rng(0)
    image = np.zeros(0, dtype=np.int64)
    for which in (rng.choice(n, min(n, PROBES), replace=False), np.arange(n)):
        distance, nearest = tree.query(moved[which], distance_upper_bound=close)
        image = np.asarray(nearest)
        missed = int(np.sum(~np.isfinite(distance)))
        if missed:
            raise NotPeriodic(f"turned by 1/{N} of a turn, {missed} of {len(which)} nodes looked at meet no other node")
    if np.any(np.bincount(image, minlength=n) != 1):
        raise NotPeriodic(f"turned by 1/{N} of a turn, two nodes meet the same node")
    tag = rng.integers(0, 2**64, n, dtype=np.uint64)
    groups = [(f"{kind} cells", nodes) for kind, nodes in mesh.cells.items()]
    for name in whole:
        if name in mesh.facet_sets:
            groups += [(f"facets of {name!r}", nodes) for nodes in mesh.facet_sets[name].blocks.values()]
        if name in mesh.cell_sets:
            marked = np.zeros(mesh.cell_count, dtype=bool)
            marked[mesh.cell_sets[name]] = True
            groups += [(f"cells of {name!r}", mesh.cells[kind][part]) for kind, part in mesh.by_block(marked)]
    for what, nodes in groups:
        before, after = (np.sort(sector_numbering.sums(tags, nodes)) for tags in (tag, tag[image]))
        if not np.array_equal(before, after):
            raise NotPeriodic(f"turned by 1/{N} of a turn its nodes meet nodes, but not all {what} meet {what}")
    return Orbits.of(image, N)
