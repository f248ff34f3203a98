"""Make connecting_rod.msh and piston.msh, the meshes of an engine, and gas_force.csv. Lengths in m.

The rod, of quadratic tetrahedra, has its big end about the origin and its small end at +x, their axes along y; facet
groups `bore` (of the big end) and `eye` (of the small end). Both eyes are rings of two layers of cells, the shank
between them has half of their width. The piston, of quadratic hexahedra, has the axis of the cylinder along x and that
of the pin along y, both through the origin; facet groups `thrust` (z < 0) and `anti-thrust` (z > 0) on the skirt,
`crown`, and `pin`, the inner faces of the bosses. The force of the gas on the piston of a four-stroke engine, above the
ambient pressure, is one of compressed and expanded gas between the valves, its pressure raised by burning; crank angles
are counted from the dead centre where the gas is exchanged, and the gas burns after 360 degrees.
Run: python demos/data/make_engine.py
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import permutations
from pathlib import Path
from typing import Any

import meshio
import numpy as np
from scipy.spatial import KDTree

import warpffrf as wf
from warpffrf.model.mesh.elements import cell_kind
from warpffrf.model.mesh.shapes.disc import assembled, refined

CRANK, ROD, PISTON_RADIUS = 0.040, 0.140, 0.040  # m: of the crank, between the axes of both eyes, of the piston
BIG, BIG_OUTER, SMALL, SMALL_OUTER, WIDTH = 0.024, 0.033, 0.011, 0.018, 0.024  # m: radii of the eyes, along their axes
SECTORS, WIDE, LONG = 32, 4, 8  # cells around the big eye (half as many around the small one), along it, along the rod
SKIRT_RADIUS, WALL = 0.040 - 40e-6 - 60e-6, 0.004  # m: bore less clearance and oval; thickness of skirt and belt
SKIRT, WALLS, BOSSES = (-0.022, 0.012), (-0.012, 0.022), (-0.012, 0.012)  # m, along the cylinder, from the pin
BELT, CROWN = (0.012, 0.022), (0.022, 0.030)  # m: the rings' belt (without its grooves)
ROWS = (-0.022, -0.017, -0.012, -0.006, 0.0, 0.006, 0.012, 0.017, 0.022, 0.026, 0.030)  # m: rows of cells end there
CORE, BULGE = 0.025, 0.225  # m, -: the bulging square within
ACROSS, BESIDE = 8, 1  # cells in a quarter of the circumference; of the skirt beyond it
AMBIENT, RATIO, EXPONENT, BURNED = 1e5, 10.5, 1.32, 5.0  # Pa; volumes; p V^n; times the pressure by burning
BURNING, INLET_SHUTS, OUTLET_OPENS = (340.0, 400.0), (180.0, 200.0), (500.0, 560.0)  # deg
FOLDER = Path(__file__).parent


def rod_mesh() -> wf.mesh.Mesh:
    """The mesh with its facet sets."""
    around, y = np.pi / SECTORS, np.linspace(-0.5, 0.5, 2 * WIDE + 1) * WIDTH  # nodes, in the middle of cells too
    part = np.arange(2 * SECTORS + 1)
    big = _ring(BIG, BIG_OUTER, around * part, 0.0, y)
    small = _ring(SMALL, SMALL_OUTER, -2.0 * around * part[: SECTORS + 1], ROD, y)
    across, along = around * np.arange(-4, 5), np.linspace(0.0, 1.0, 2 * LONG + 1)[:, None, None]
    begin = BIG_OUTER * np.stack([np.cos(across), np.sin(across)], axis=1)
    end = SMALL_OUTER * np.stack([-np.cos(2.0 * across), np.sin(2.0 * across)], axis=1) + (ROD, 0.0)
    shank = _standing((1.0 - along) * begin + along * end, y[WIDE // 2 : -(WIDE // 2)])
    mesh, axis = tetrahedra([big, small, shank], "rod"), (0, 1, 0)
    mesh = mesh.select_cylinder("bore", axis_point=(0, 0, 0), axis_direction=axis, radius=BIG)
    return mesh.select_cylinder("eye", axis_point=(ROD, 0, 0), axis_direction=axis, radius=SMALL)


def _ring(inner: float, outer: float, theta: np.ndarray, x: float, y: np.ndarray) -> np.ndarray:
    """Lattice of a ring of two layers."""
    radius = np.linspace(inner, outer, 5)[:, None]
    return _standing(np.stack([x + radius * np.cos(theta), radius * np.sin(theta)], axis=-1), y)


def _standing(section: np.ndarray, y: np.ndarray) -> np.ndarray:
    """The lattice (a, b, c, 3) over points (a, b, 2) x, z of a cross section, at y (c,)."""
    lattice = np.empty((*section.shape[:2], len(y), 3))
    lattice[..., [0, 2]], lattice[..., 1] = section[:, :, None, :], y
    return lattice


def tetrahedra(lattices: Sequence[np.ndarray], name: str) -> wf.mesh.Mesh:
    """Quadratic tetrahedra on `lattices` (a, b, c, 3) [m] of nodes, odd numbers of them: six to each cube of 3 x 3 x 3.

    They share the cube's diagonal from its first to its last corner, one for each order of the axes along the way. So
    each face is cut from its first to its last corner, and lattices fit together that are numbered along a common face
    in the same direction, or both reversed. Nodes at equal points are merged.
    """
    kind, cells, start = cell_kind("tet10"), [], 0
    for lattice in lattices:
        shape = lattice.shape[:3]
        cubes = np.stack(np.meshgrid(*[np.arange(0, n - 1, 2) for n in shape], indexing="ij"), axis=-1)
        cubes = cubes.reshape(-1, 1, 3)
        for way in permutations(range(3)):
            corners = np.vstack([np.zeros(3, dtype=int), np.cumsum(2 * np.eye(3, dtype=int)[list(way)], axis=0)])
            sides = np.diff(lattice[tuple(corners.T)], axis=0)
            if np.linalg.det(sides) < 0.0:
                corners = corners[[0, 2, 1, 3]]
            nodes = np.rint(kind.nodes @ (corners[1:] - corners[0])).astype(int)
            cells.append(start + np.ravel_multi_index(tuple(np.moveaxis(cubes + nodes, -1, 0)), shape))
        start += int(np.prod(shape))
    points = np.concatenate([lattice.reshape(-1, 3) for lattice in lattices])
    near = KDTree(points).query_ball_point(points, 1e-9 * float(np.ptp(points, axis=0).max()))
    kept, number = np.unique([min(same) for same in near], return_inverse=True)
    return wf.mesh.Mesh(points[kept], {"tet10": number[np.concatenate(cells)]}, name=name)


def piston_mesh() -> wf.mesh.Mesh:
    """Crown, belt of the rings, two arcs of a skirt and the walls between them with the bosses of the pin."""
    outer = SKIRT_RADIUS
    part = np.linspace(-1.0, 1.0, 2 * ACROSS + 1)
    core = CORE * np.stack(_bulging(*np.meshgrid(part, part, indexing="ij")), axis=-1)
    around = np.array([np.sin(0.25 * np.pi * part), np.cos(0.25 * np.pi * part)]).T
    inside = _between(core[:, -1], (outer - WALL) * around, 2)
    ring = _between((outer - WALL) * around, outer * around, 1)
    lattices, sets = [], {"thrust": [], "anti-thrust": [], "crown": [], "pin": []}

    def add(section: np.ndarray, rows: tuple[float, float], face: str = "", *, axis: int = 0, end: int = 0) -> None:
        if face:
            sets[face].append((len(lattices), axis, end))
        lattices.append(_standing_piston(section, rows))

    add(core, CROWN, "crown", axis=2, end=1)
    for quarter in range(4):  # of the revolution, from z over y
        turn = np.array([[0.0, -1.0], [1.0, 0.0]])
        turn = np.linalg.matrix_power(turn, quarter)
        blend, shell = inside @ turn, ring @ turn
        add(blend, CROWN, "crown", axis=2, end=1)
        add(shell, CROWN, "crown", axis=2, end=1)
        add(shell, BELT)
        if quarter % 2 == 0:
            add(shell, SKIRT, _side(shell), end=1)
            continue
        for cells in (slice(None, 2 * BESIDE + 1), slice(-2 * BESIDE - 1, None)):
            add(shell[:, cells], SKIRT, _side(shell[:, cells]), end=1)
        add(blend[2:], WALLS)
        add(blend[:3, ACROSS // 2 : -(ACROSS // 2)], BOSSES, "pin", end=0)
    return assembled(lattices, 2, sets, "piston")


def _bulging(u: np.ndarray, v: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """A square with bulging sides, -1 <= u, v <= 1, the middles of its sides at 1."""
    return u * np.sqrt(1.0 - BULGE * v**2), v * np.sqrt(1.0 - BULGE * u**2)


def _between(low: np.ndarray, high: np.ndarray, cells: int) -> np.ndarray:
    """The lattice (2 cells + 1, n, 2) between two lines (n, 2)."""
    part = np.linspace(0.0, 1.0, 2 * cells + 1)[:, None, None]
    return (1.0 - part) * low + part * high


def _standing_piston(section: np.ndarray, ends: tuple[float, float]) -> np.ndarray:
    """The lattice (a, b, c, 3) over points (a, b, 2) y, z of a cross section, on the rows between two x [m]."""
    rows = refined(np.array([x for x in ROWS if ends[0] <= x <= ends[1]]), 2)
    lattice = np.empty((*section.shape[:2], len(rows), 3))
    lattice[..., 1:], lattice[..., 0] = section[:, :, None, :], rows
    return lattice


def _side(shell: np.ndarray) -> str:
    return "thrust" if shell[..., 1].mean() < 0.0 else "anti-thrust"


def gas_force(theta: np.ndarray) -> np.ndarray:
    """N, at crank angles (T,) [rad]; the same after two revolutions."""
    degrees, area = np.mod(np.degrees(theta), 720.0), np.pi * PISTON_RADIUS**2
    swept = 2.0 * CRANK * area
    least = swept / (RATIO - 1.0)
    piston = CRANK * np.cos(theta) + ROD * np.sqrt(1.0 - (CRANK / ROD * np.sin(theta)) ** 2)
    volume = least + area * (CRANK + ROD - piston)
    closed = ((least + swept) / volume) ** EXPONENT * (1.0 + (BURNED - 1.0) * _rise(degrees, *BURNING))
    shut = _rise(degrees, *INLET_SHUTS) * (1.0 - _rise(degrees, *OUTLET_OPENS))
    return area * AMBIENT * (closed - 1.0) * shut


def _rise(x: np.ndarray, begin: float, end: float) -> np.ndarray:
    """From 0 to 1, twice differentiable."""
    s = np.clip((x - begin) / (end - begin), 0.0, 1.0)
    return s**3 * (10.0 - 15.0 * s + 6.0 * s**2)


def write(mesh: wf.mesh.Mesh, cells: str, facets: str, file: Path) -> None:
    """Gmsh's format 2.2 with the facet sets of the mesh as groups; `cells`, `facets`: their names in meshio."""
    groups = [mesh.facets(name).single[1] for name in mesh.sets]
    blocks: Any = [(cells, mesh.single[1]), *((facets, group) for group in groups)]
    numbers = [np.full(len(block), n, dtype=np.int32) for n, (_, block) in enumerate(blocks)]
    data: Any = {"gmsh:physical": numbers, "gmsh:geometrical": [number + 1 for number in numbers]}
    names = {name: np.array([n, 2]) for n, name in enumerate(mesh.sets, start=1)}
    meshio.write(file, meshio.Mesh(mesh.points, blocks, cell_data=data, field_data=names), "gmsh22", binary=True)


if __name__ == "__main__":
    write(rod_mesh(), "tetra10", "triangle6", FOLDER / "connecting_rod.msh")
    write(piston_mesh(), "hexahedron27", "quad9", FOLDER / "piston.msh")
    angles = np.arange(720.0)
    table = np.column_stack([angles, gas_force(np.radians(angles))])
    header = "crank angle [deg],force of the gas on the piston [N]"
    np.savetxt(FOLDER / "gas_force.csv", table, fmt=("%d", "%.6f"), delimiter=",", header=header, comments="")
