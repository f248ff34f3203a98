"""The obstacle course of shells: meshes, loads and solutions of its problems, and closed bodies of shells.

R. H. MacNeal and R. L. Harder, Finite Elem. Anal. Des. 1 (1985) 3; R. D. Cook (1974). Units are those of the sources.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Any

import numpy as np
import scipy.sparse as sp
import scipy.sparse.linalg as spla

from warpffrf.model.material import Material
from warpffrf.model.mesh import Beam, Mesh, Shell
from warpffrf.model.mesh.elements import cell_kind
from warpffrf.offline.fe import Assignment
from warpffrf.offline.structure.assembly import BodyMatrices, body_matrices
from warpffrf.offline.structure.shell import rule, shape

Array = np.ndarray
STEEL = Material(210e9, 0.3, 7850.0)
KINDS = ("tri3", "quad4", "tri6", "quad8")
QUADRATIC = ("tri6", "quad8")
_QUAD = [(0, 0), (2, 0), (2, 2), (0, 2), (1, 0), (2, 1), (1, 2), (0, 1)]
_TRIS = [[(0, 0), (2, 0), (2, 2), (1, 0), (2, 1), (1, 1)], [(0, 0), (2, 2), (0, 2), (1, 1), (1, 2), (0, 1)]]


@dataclass(frozen=True, eq=False)
class Patch:
    """Elements of a surface x(u, v): `points` (n, 3), `nodes` (m, k), and the parameters `uv` (n, 2) of the points."""

    kind: str
    points: Array
    nodes: Array
    uv: Array

    def at(self, u: float | None = None, v: float | None = None) -> Array:
        """Nodes with these parameters."""
        wanted = np.ones(len(self.points), dtype=bool)
        for i, value in enumerate((u, v)):
            if value is not None:
                wanted &= np.isclose(self.uv[:, i], value)
        return np.flatnonzero(wanted)


def patch(kind: str, along_u: int, along_v: int, surface: Callable[[Array, Array], Array]) -> Patch:
    """`along_u` by `along_v` elements of the surface, u and v from 0 to 1; triangles: two for each."""
    nodes_u, nodes_v = 2 * along_u + 1, 2 * along_v + 1
    number = np.arange(nodes_u * nodes_v).reshape(nodes_u, nodes_v)
    u, v = np.meshgrid(np.linspace(0, 1, nodes_u), np.linspace(0, 1, nodes_v), indexing="ij")
    width = {"tri3": 3, "quad4": 4, "tri6": 6, "quad8": 8}[kind]
    shapes = [_QUAD[:width]] if kind.startswith("quad") else [one[:width] for one in _TRIS]
    rows = [
        [number[i + a, j + b] for a, b in one]
        for i in range(0, nodes_u - 1, 2)
        for j in range(0, nodes_v - 1, 2)
        for one in shapes
    ]
    used, nodes = np.unique(np.array(rows), return_inverse=True)
    uv = np.stack([u.ravel(), v.ravel()], axis=1)[used]
    return Patch(kind, surface(uv[:, 0], uv[:, 1]), nodes.reshape(len(rows), width), uv)


def dofs(count: int, nodes: Iterable[int], components: Iterable[int]) -> Array:
    """Positions of components (0 to 2 displacements, 3 to 5 rotations) of nodes, all `count` of which rotate."""
    a, c = np.meshgrid(np.fromiter(nodes, int), np.fromiter(components, int), indexing="ij")
    return np.where(c < 3, 3 * a + c, 3 * (count + a) + c - 3).ravel()


def matrices(points: Array, parts: list[Any]) -> BodyMatrices:
    """K and M of a body of structural elements."""
    return body_matrices(Mesh(points, {}, structure=parts), Assignment((), {}))


def solved(points: Array, part: Shell | Beam, fixed: Array, load: Array) -> Array:
    """Displacements and rotations (6 n,) with the dofs `fixed` at zero."""
    K = matrices(points, [part]).K
    free = np.setdiff1d(np.arange(K.shape[0]), fixed)
    u = np.zeros(K.shape[0])
    u[free] = np.asarray(spla.spsolve(sp.csc_matrix(K[free][:, free]), load[free]))
    return u


def surface_load(p: Patch, force: Array) -> Array:
    """Nodal load (6 n,) of a constant force per area (3,)."""
    points, weights = rule(p.kind)
    N, dN = shape(p.kind, points)
    a = np.einsum("qda,eai->eqdi", dN, p.points[p.nodes])
    area = np.linalg.norm(np.cross(a[:, :, 0], a[:, :, 1]), axis=2) * weights
    load = np.zeros((2 * len(p.points), 3))
    np.add.at(load, p.nodes, np.einsum("eq,qa,i->eai", area, N, force))
    return load.ravel()


def edge_load(p: Patch, nodes: Array, total: Array) -> Array:
    """Nodal load (6 n,) of `total` (3,), evenly over a straight row of `nodes` at even distances."""
    ordered = nodes[np.lexsort(p.uv[nodes].T)]
    share = np.zeros(len(ordered))
    if p.kind in QUADRATIC:
        for i in range(0, len(ordered) - 1, 2):
            share[i : i + 3] += np.array([1.0, 4.0, 1.0]) / 6.0
    else:
        for i in range(len(ordered) - 1):
            share[i : i + 2] += 0.5
    load = np.zeros((2 * len(p.points), 3))
    load[ordered] = share[:, None] / share.sum() * total
    return load.ravel()


def _symmetry(count: int, nodes: Array, normal: int) -> Array:
    """The dofs that are zero on a plane of symmetry."""
    return dofs(count, nodes, [normal, *(3 + c for c in range(3) if c != normal)])


def scordelis_lo(kind: str, count: int) -> float:
    """Deflection of the middle of the free edge of the Scordelis-Lo roof, over 0.3024."""
    R, L, half = 25.0, 50.0, np.radians(40.0)
    p = patch(kind, count, count, lambda u, v: np.stack([R * np.sin(half * u), 0.5 * L * v, R * np.cos(half * u)], 1))
    n = len(p.points)
    fixed = [dofs(n, p.at(v=1.0), [0, 2]), _symmetry(n, p.at(v=0.0), 1), _symmetry(n, p.at(u=0.0), 0)]
    part = Shell(p.nodes, 0.25, Material(4.32e8, 0.0, 1.0))
    u = solved(p.points, part, np.unique(np.concatenate(fixed)), surface_load(p, np.array([0.0, 0.0, -90.0])))
    return -float(u[3 * p.at(1.0, 0.0)[0] + 2]) / 0.3024


def pinched_cylinder(kind: str, count: int) -> float:
    """Deflection under the load of the pinched cylinder with rigid diaphragms, over 1.8248e-5."""
    R, L, right = 300.0, 600.0, 0.5 * np.pi
    p = patch(kind, count, count, lambda u, v: np.stack([R * np.sin(right * u), 0.5 * L * v, R * np.cos(right * u)], 1))
    n = len(p.points)
    fixed = [dofs(n, p.at(v=1.0), [0, 2]), _symmetry(n, p.at(v=0.0), 1)]
    fixed += [_symmetry(n, p.at(u=0.0), 0), _symmetry(n, p.at(u=1.0), 2)]
    load = np.zeros(6 * n)
    under = 3 * p.at(0.0, 0.0)[0] + 2
    load[under] = -0.25
    u = solved(p.points, Shell(p.nodes, 3.0, Material(3e6, 0.3, 1.0)), np.unique(np.concatenate(fixed)), load)
    return -float(u[under]) / 1.8248e-5


def twisted_beam(kind: str, count: int, direction: int) -> float:
    """Tip displacement of the beam twisted by 90 degrees under a unit force at its end along z (2, in its plane) or y
    (1), over 5.424e-3 or 1.754e-3; `count` elements over the width, an even number of nodes' rows."""
    L, width = 12.0, 1.1

    def surface(u: Array, v: Array) -> Array:
        turn, y = 0.5 * np.pi * u, width * (v - 0.5)
        return np.stack([L * u, y * np.cos(turn), y * np.sin(turn)], axis=1)

    p = patch(kind, 6 * count, count, surface)
    force = np.eye(3)[direction]
    load = edge_load(p, p.at(u=1.0), force)
    part = Shell(p.nodes, 0.32, Material(29e6, 0.22, 1.0))
    u = solved(p.points, part, dofs(len(p.points), p.at(u=0.0), range(6)), load)
    return float(u[3 * p.at(1.0, 0.5)[0] + direction]) / {2: 5.424e-3, 1: 1.754e-3}[direction]


def cook(kind: str, count: int) -> float:
    """Deflection of the middle of the loaded end of Cook's membrane, over 23.96."""

    def surface(u: Array, v: Array) -> Array:
        return np.stack([48.0 * u, 44.0 * u + (44.0 - 28.0 * u) * v, 0.0 * u], axis=1)

    p = patch(kind, count, count, surface)
    n = len(p.points)
    fixed = np.union1d(dofs(n, p.at(u=0.0), range(6)), dofs(n, range(n), [2, 3, 4]))
    part = Shell(p.nodes, 1.0, Material(1.0, 1.0 / 3.0, 1.0))
    u = solved(p.points, part, fixed, edge_load(p, p.at(u=1.0), np.array([0.0, 1.0, 0.0])))
    return float(u[3 * p.at(1.0, 0.5)[0] + 1]) / 23.96


def square_plate(kind: str, count: int, thickness: float) -> float:
    """Deflection of the middle of a simply supported square plate of side 1 under pressure, over that of Navier's
    series with the shear of Reissner and Mindlin: `sum 16/(pi^2 m n) (1/(D k^2) + 1/(5/6 G t k))` with the signs of
    sin(m pi/2) sin(n pi/2), k = pi^2 (m^2 + n^2), m and n odd."""
    p = patch(kind, count, count, lambda u, v: np.stack([u, v, 0.0 * u], axis=1))
    total = len(p.points)
    fixed = [dofs(total, range(total), [0, 1, 5])]
    for u, v, along in ((0.0, None, 3), (1.0, None, 3), (None, 0.0, 4), (None, 1.0, 4)):
        fixed.append(dofs(total, p.at(u, v), [2, along]))
    load = surface_load(p, np.array([0.0, 0.0, 1.0]))
    w = solved(p.points, Shell(p.nodes, thickness, STEEL), np.unique(np.concatenate(fixed)), load)
    m, n = np.meshgrid(np.arange(1, 400, 2), np.arange(1, 400, 2))
    sign = (-1.0) ** ((m - 1) // 2 + (n - 1) // 2)
    D, S, k = 210e9 * thickness**3 / 12.0 / 0.91, 5.0 / 6.0 * 210e9 / 2.6 * thickness, np.pi**2 * (m**2 + n**2)
    exact = float(np.sum(sign * 16.0 / (np.pi**2 * m * n) * (1.0 / (D * k**2) + 1.0 / (S * k))))
    return float(w[3 * p.at(0.5, 0.5)[0] + 2]) / exact


def merged(patches: list[Patch]) -> tuple[Array, Array]:
    """Points and nodes of several patches, with one node where points coincide."""
    first = np.cumsum([0, *(len(p.points) for p in patches)])
    points = np.concatenate([p.points for p in patches])
    nodes = np.concatenate([p.nodes + start for p, start in zip(patches, first, strict=False)])
    size = np.ptp(points, axis=0).max()
    _, keep, number = np.unique(np.round(points / size, 9), axis=0, return_index=True, return_inverse=True)
    return points[keep], number.ravel()[nodes]


def tube(kind: str, around: int, along: int, radius: float, length: float) -> tuple[Array, Array]:
    """Points and nodes of an open cylinder about z."""

    def surface(u: Array, v: Array) -> Array:
        turn = 2.0 * np.pi * u
        return np.stack([radius * np.cos(turn), radius * np.sin(turn), length * v], axis=1)

    return merged([patch(kind, around, along, surface)])


def closed_box(kind: str, count: int, size: tuple[float, float, float]) -> tuple[Array, Array]:
    """Points and nodes of a closed box of six walls, normals outward."""
    a, b, c = size

    def wall(origin: Array, e_u: Array, e_v: Array) -> Patch:
        return patch(kind, count, count, lambda u, v: origin + u[:, None] * e_u + v[:, None] * e_v)

    x, y, z = np.diag([a, b, c]).astype(float)
    zero = np.zeros(3)
    walls = [(zero, y, x), (z, x, y), (zero, x, z), (y, z, x), (zero, z, y), (x, y, z)]
    return merged([wall(*one) for one in walls])


# MacNeal and Harder's patch: corners and inner nodes, and its quadrilaterals
PATCH = np.array(
    [[0, 0], [0.24, 0], [0.24, 0.12], [0, 0.12], [0.04, 0.02], [0.18, 0.03], [0.16, 0.08], [0.08, 0.08]], dtype=float
)
QUADS = np.array([[0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7], [4, 5, 6, 7]])


def patch_of(kind: str) -> tuple[np.ndarray, np.ndarray]:
    """Points (n, 3) and elements of the patch; mid nodes on straight sides."""
    corners = QUADS if kind.startswith("quad") else np.concatenate([QUADS[:, [0, 1, 2]], QUADS[:, [0, 2, 3]]])
    points, rows, middle = [*PATCH], [], {}
    for one in corners:
        row = one.tolist()
        if kind in ("tri6", "quad8"):
            for a, b in zip(one, np.roll(one, -1), strict=True):
                key = (min(a, b), max(a, b))
                if key not in middle:
                    middle[key] = len(points)
                    points.append(0.5 * (PATCH[a] + PATCH[b]))
                row.append(middle[key])
        rows.append(row)
    flat = np.array(points)
    return np.concatenate([flat, np.zeros((len(flat), 1))], axis=1), np.array(rows)


def patch_test(kind: str, field: str) -> tuple[Array, Array, Array, Mesh]:
    """The patch with a prescribed border: solution and exact solution (6 n,), exact stress (6,) on the top, mesh."""
    points, nodes = patch_of(kind)
    x, y, _ = points.T
    n, zero = len(points), np.zeros(len(points))
    if field == "membrane":
        exact = 1e-3 * np.stack([x + 0.5 * y, y + 0.5 * x, zero, zero, zero, zero], axis=1)
        stress = np.array([4000.0 / 3.0, 4000.0 / 3.0, 0.0, 400.0, 0.0, 0.0])
    else:
        w = 0.5 * (x * x + x * y + y * y)
        exact = 1e-3 * np.stack([zero, zero, w, y + 0.5 * x, -x - 0.5 * y, zero], axis=1)
        stress = -np.array([2.0 / 3.0, 2.0 / 3.0, 0.0, 0.2, 0.0, 0.0])
    exact = np.concatenate([exact[:, :3], exact[:, 3:]]).ravel()
    shell = Shell(nodes, 1e-3, Material(1e6, 0.25, 1.0))
    K = matrices(points, [shell]).K
    edge = np.flatnonzero((x == 0.0) | (x == 0.24) | (y == 0.0) | (y == 0.12))
    held = np.sort(dofs(n, edge, range(6)))
    free = np.setdiff1d(np.arange(6 * n), held)
    u = exact.copy()
    u[free] = np.asarray(spla.spsolve(sp.csc_matrix(K[free][:, free]), -K[free][:, held] @ exact[held]))
    return u, exact, stress, Mesh(points, {}, structure=[shell])


HEX20 = (cell_kind("hex20").nodes + 1.0).astype(int)  # positions on the grid of half cells


def hexes(lines: list[Array], keep: Callable[[int, int, int], bool]) -> tuple[np.ndarray, np.ndarray]:
    """Nodes of a grid of half cells between `lines`, and hex20 cells (i, j, k) that `keep` accepts."""
    fine = [np.sort(np.concatenate([x, 0.5 * (x[1:] + x[:-1])])) for x in lines]
    number = np.arange(np.prod([len(x) for x in fine])).reshape([len(x) for x in fine])
    cells = [
        number[tuple((2 * np.array(ijk) + HEX20).T)] for ijk in np.ndindex(*(len(x) - 1 for x in lines)) if keep(*ijk)
    ]
    return np.stack(np.meshgrid(*fine, indexing="ij"), axis=-1).reshape(-1, 3), np.array(cells)


def housing(count: int, thickness: float, *, solid_cover: bool) -> Mesh:
    """An open box of 200 x 150 x 30 mm with walls and bottom of 12 mm, and a cover, of solids or of shells."""
    a, b, h, wall, rim = 0.2, 0.15, 0.03, 0.012, 2

    def across(length: float) -> np.ndarray:
        ends = np.linspace(0.0, wall, rim + 1)
        middle = np.linspace(wall, length - wall, count + 1)
        return np.concatenate([ends[:-1], middle, length - ends[:-1][::-1]])

    z = [0.0, wall, 0.5 * (wall + h), h] + ([h + thickness] if solid_cover else [])
    lines = [across(a), across(b), np.array(z)]
    m, top = len(lines[0]) - 1, len(z) - 2 if solid_cover else -1

    def keep(i: int, j: int, k: int) -> bool:
        inside = rim <= i < m - rim and rim <= j < m - rim
        return not inside or k in (0, top)

    points, cells = hexes(lines, keep)
    blocks = [cells]
    if not solid_cover:
        ny, nz = 2 * len(lines[1]) - 1, 2 * len(z) - 1
        order = np.array([(0, 0), (2, 0), (2, 2), (0, 2), (1, 0), (2, 1), (1, 2), (0, 1)])
        rows = [
            [((2 * i + p) * ny + 2 * j + q) * nz + nz - 1 for p, q in order]
            for i in range(m)
            for j in range(len(lines[1]) - 1)
        ]
        blocks.append(np.array(rows))
    used = np.unique(np.concatenate([block.ravel() for block in blocks]))
    number = np.full(len(points), -1)
    number[used] = np.arange(len(used))
    parts = [] if solid_cover else [Shell(number[blocks[1]], thickness, STEEL, offset=0.5 * thickness, name="cover")]
    return Mesh(points[used], {"hex20": number[cells]}, structure=parts)
