r"""Report of a mesh for its verification: size, volume, mass, shape of the cells, warnings.

Mass, centre and inertia about the centre are integrals over the isoparametric cells,

    m = int rho dV,    c = int rho x dV / m,    J = int rho (|d|^2 1 - d d^T) dV,   d = x - c,

by Gauss rules that are exact for linear cells and for quadratic ones with straight edges. Of a body that comes as
matrices they follow from the rigid motions `T` (n, 3), translations, and `S` (n, 3), rotations about the origin with
the fields e_i x x: `m = trace(T^T M T) / 3`, `S^T M T = m [c]x` (the matrix of c x), `S^T M S` is J about the origin.

*Scaled Jacobian* of a cell: at each corner the determinant of the three edge tangents over the product of their
lengths, divided by the value of the regular cell (1 for a cube, sqrt(3)/2 for a wedge on an equilateral triangle,
sqrt(1/2) for a regular tetrahedron); the smallest counts (Knupp 2000, Int. J. Numer. Meth. Eng. 48, 1165). *Aspect
ratio*: longest over shortest straight edge.

Unit errors are detectable without knowledge of the body: the speed of sound sqrt(E/rho) of every solid lies between
that of rubber and of diamond, its density between foam and osmium, and a machine part between 1 mm and 10 m.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from warpffrf.model.errors import InputError, unknown_name
from warpffrf.model.material import Material, Orthotropic, SolidMaterial
from warpffrf.model.mesh.checks import part_labels
from warpffrf.model.mesh.elements import CellKind, cell_kind, determinants, facet_kind
from warpffrf.model.mesh.elements.domains import hex_rule, tet_rule, wedge_rule

if TYPE_CHECKING:
    from warpffrf.model.mesh.data import Mesh

USUAL_SIZE = (1e-3, 10.0)  # m; outside it the length unit of a file was probably wrong
SPEED_REFUSED = 10.0, 30_000.0  # m/s: half of soft rubber's, and beyond diamond's, see `refuse_wrong_units`
SOUND_SPEEDS = (20.0, 20_000.0)  # m/s, bar waves: soft rubber (0.5 MPa) 21, diamond 18 km/s
USUAL_SPEEDS, USUAL_DENSITIES = (500.0, 14_000.0), (500.0, 20_000.0)  # of machine materials
PASCALS = {"Pa": 1.0, "GPa": 1e9, "MPa": 1e6}
DENSITY_UNITS = {"kg/m3": 1.0, "g/cm3": 1e3, "t/mm3": 1e12}
DENSITIES = (5.0, 23_000.0)  # kg/m3: polymer foam, osmium
BOX_DENSITY = 0.1  # kg/m3, mass over the volume of the bounding box: a steel frame filling 1e-4 of its box has 0.8
SLENDER_CELL = 1000.0  # aspect ratio; graded contact meshes reach some hundreds on purpose, beyond is no design
POOR_CELL = 0.1  # scaled Jacobian: below it solvers' conditioning and stresses of the cell suffer (Verdict manual 2006)
ROUND_OFF = 1e-12  # of the largest moment of inertia: products below it are rounding and printed as zero
MOMENT_POINTS = {
    1: 3,
    2: 4,
}  # Gauss points per direction by degree: x x^T det J of any linear, any straight quadratic cell
_RULES = {"hex": hex_rule, "wedge": wedge_rule, "tet": tet_rule}
_REGULAR = {"hex": 1.0, "wedge": np.sqrt(0.75), "tet": np.sqrt(0.5)}
_CHUNK = 20_000  # cells processed together: bounds the memory to some tens of MB

Array = np.ndarray
Vector = tuple[float, float, float]


@dataclass(frozen=True)
class MeshReport:
    """Summary of a mesh; `str()` gives readable lines. Lengths m, volume m3, mass kg, inertia (3, 3) kg m2 about the
    center, user frame.

    `name` of the mesh; `node_count`, and `cells` and `sets` of facets with their sizes by name, `cell_sets` likewise;
    `lower` and `upper` corner (3,) [m] of the box around it; `sectors` of its rotational periodicity, None without;
    `parts`: number of connected parts; worst `scaled_jacobian` and `aspect_ratio` [-] of its cells; shortest and
    longest of `edges` [m]; `warnings` on doubtful data, `notes` on data omitted by its reader.

    `mass`, `center` and `inertia` are None where no material is known, quality and edges None without cells.
    `center` without a material is None too. `rotations`: degrees of freedom of shell and beam nodes that rotate;
    `volume` is that of solid cells.
    """

    name: str
    node_count: int
    cells: dict[str, int]
    sets: dict[str, int]
    lower: Vector
    upper: Vector
    volume: float
    sectors: int | None
    warnings: tuple[str, ...] = ()
    cell_sets: dict[str, int] | None = None
    parts: int = 1
    edges: tuple[float, float] | None = None
    scaled_jacobian: float | None = None
    aspect_ratio: float | None = None
    mass: float | None = None
    center: Vector | None = None
    inertia: Array | None = None
    notes: tuple[str, ...] = ()
    rotations: int = 0

    def __str__(self) -> str:
        size = [b - a for a, b in zip(self.lower, self.upper, strict=True)]
        cells = (
            ", ".join(f"{count} {kind}" for kind, count in self.cells.items()) or "none, the body is given by matrices"
        )
        freedoms = 3 * self.node_count + self.rotations
        lines = [
            f"mesh {self.name or '(unnamed)'}: {self.node_count} nodes, {freedoms} degrees of freedom",
            f"  cells   {cells}" + (f", in {self.parts} disconnected parts" if self.parts > 1 else ""),
            "  sets    " + (", ".join(f"{name} ({count} facets)" for name, count in self.sets.items()) or "none"),
        ]
        if self.cell_sets:
            lines.append("  groups  " + ", ".join(f"{name} ({count} cells)" for name, count in self.cell_sets.items()))
        lines += [
            "  box     " + " x ".join(f"{s:.6g}" for s in size) + " m, from "
            f"({', '.join(f'{x:.6g}' for x in self.lower)}) to ({', '.join(f'{x:.6g}' for x in self.upper)})",
            f"  volume  {self.volume:.6g} m3" if self.volume else "  volume  unknown without solid cells",
        ]
        if self.mass is not None and self.center is not None and self.inertia is not None:
            lines.append(f"  mass    {self.mass:.6g} kg, center ({', '.join(f'{x:.6g}' for x in self.center)}) m")
            J = np.where(np.abs(self.inertia) > ROUND_OFF * np.abs(self.inertia).max(), self.inertia, 0.0)
            entries = ", ".join(f"{J[i, j]:.6g}" for i, j in ((0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (0, 2)))
            lines.append(f"  inertia xx, yy, zz, xy, yz, xz: {entries} kg m2 about the center")
        if self.edges is not None:
            lines.append(
                f"  quality edges {self.edges[0]:.4g} to {self.edges[1]:.4g} m, scaled Jacobian >= "
                f"{self.scaled_jacobian:.3g}, aspect ratio <= {self.aspect_ratio:.3g}"
            )
        lines.append(f"  cyclic  {f'{self.sectors} sectors' if self.sectors else 'no'}")
        lines += [f"  note: {n}" for n in self.notes]
        return "\n".join(lines + [f"  warning: {w}" for w in self.warnings])


def report(mesh: Mesh, material: SolidMaterial | Mapping[str, SolidMaterial] | None = None) -> MeshReport:
    """The report of `mesh`; with `material`, one or {cell set: Material}, mass and inertia too.

    Where `material` is None the materials of the mesh's file are used, if they cover every cell. Raises `InputError`
    for an unknown cell set and for cells without material.
    """
    if material is not None and (not isinstance(material, Material | Orthotropic | Mapping) or not material):
        raise InputError(f"mesh report: a Material or {{cell set: Material}} is needed, got {material!r}")
    lower, upper = mesh.points.min(axis=0), mesh.points.max(axis=0)
    shape = _Shape(mesh)
    given = material
    if given is None and mesh.materials and not _uncovered(mesh, mesh.materials):
        given = mesh.materials
    mass = center = inertia = None
    notes = mesh.notes
    if mesh.structure.parts:
        notes = (*notes, "mass and inertia of shells, beams and point masses are in the report of the reduced body")
    elif mesh.matrices is not None:
        mass, center, inertia = _from_matrix(mesh)
    elif given is not None:
        mass, center, inertia = _from_cells(mesh, _densities(mesh, given))
    materials = {} if given is None else {"": given} if isinstance(given, Material | Orthotropic) else dict(given)
    warnings = [
        *_size_warnings(upper - lower, mass),
        *(w for name, one in materials.items() for w in material_warnings(one, name)),
        *shape.warnings(),
    ]
    return MeshReport(
        name=mesh.name,
        node_count=len(mesh.points),
        cells={**{kind: len(nodes) for kind, nodes in mesh.cells.items()}, **mesh.structure.counts()},
        sets=mesh.sets,
        lower=_vector(lower),
        upper=_vector(upper),
        volume=mesh.volume(),
        sectors=mesh.cyclic.sectors if mesh.cyclic else None,
        warnings=tuple(warnings),
        cell_sets={name: len(members) for name, members in mesh.cell_sets.items()},
        parts=int(part_labels(len(mesh.points), mesh.cells).max()) + 1
        if mesh.cells and not mesh.structure.parts
        else 1,
        edges=shape.edges,
        scaled_jacobian=shape.scaled_jacobian,
        aspect_ratio=shape.aspect_ratio,
        mass=mass,
        center=center,
        inertia=inertia,
        notes=notes,
        rotations=3 * len(mesh.structure.rotating),
    )


def material_warnings(material: SolidMaterial, name: str = "") -> list[str]:
    """Warnings where density or sound speed sqrt(E/rho) of `material` is that of no solid: probably wrong units."""
    label = f"material {material.name!r}" if material.name else f"material of {name!r}" if name else "material"
    E, rho = stiffest(material), material.density
    speed = float(np.sqrt(E / rho))
    found = []
    if not SOUND_SPEEDS[0] <= speed <= SOUND_SPEEDS[1]:
        found.append(
            f"{label}: the speed of sound sqrt(E/rho) would be {speed:.3g} m/s, of solids it is {SOUND_SPEEDS[0]:g} to "
            f"{SOUND_SPEEDS[1]:g}; youngs_modulus is in Pa (steel 210e9), density in kg/m3 (steel 7850)"
            + _meant(E, rho)
        )
    if not DENSITIES[0] <= rho <= DENSITIES[1]:
        found.append(f"{label}: no solid has a density of {rho:.3g} kg/m3; t/mm3 times 1e12, g/cm3 times 1e3 is kg/m3")
    return found


def refuse_wrong_units(material: SolidMaterial | Mapping[str, SolidMaterial] | None) -> None:
    """Raises `InputError` for a speed of sound sqrt(E/rho) that no solid has, probably due to wrong units.

    A body too soft has a vast number of modes below any frequency. One too stiff or too light has few of them, and is a
    common idealisation (nearly rigid, nearly massless): it is refused only where another unit makes it a usual solid,
    and not in the consistent units N, mm, t. `material_warnings` reports the others.
    """
    named = {"": material} if isinstance(material, Material | Orthotropic) else material or {}
    for name, one in named.items():
        E, rho = stiffest(one), one.density
        speed = float(np.sqrt(E / rho))
        slip = _slip(E, rho)
        stiff = speed > SPEED_REFUSED[1] and slip not in (None, ("MPa", "t/mm3"))
        if speed < SPEED_REFUSED[0] or stiff:
            cure = "; of a body without mass the density is below 0.5 kg/m3" if stiff else ""
            raise InputError("reduce: " + "; ".join(material_warnings(one, name)) + cure)


def stiffest(material: SolidMaterial) -> float:
    """Young's modulus [Pa], of an orthotropic material the largest."""
    return material.youngs_modulus if isinstance(material, Material) else max(material.youngs_moduli)


def _meant(E: float, rho: float) -> str:
    """Modulus and density in the units that would be plausible for a solid, as text; "" if there are none."""
    slip = _slip(E, rho)
    if slip is None:
        return ""
    (unit, per), pascal, density = slip, PASCALS[slip[0]], DENSITY_UNITS[slip[1]]
    parts = [f"youngs_modulus {E:g} {unit} is {E * pascal:.4g} Pa"] if pascal > 1.0 else []
    parts += [f"density {rho:g} {per} is {rho * density:.4g} kg/m3"] if density > 1.0 else []
    return f"; {', '.join(parts)}"


def _slip(E: float, rho: float) -> tuple[str, str] | None:
    """The units of modulus and density in which they would be plausible for a solid."""
    for unit, pascal in PASCALS.items():
        for per, density in DENSITY_UNITS.items():
            usual = USUAL_DENSITIES[0] <= rho * density <= USUAL_DENSITIES[1]
            if usual and USUAL_SPEEDS[0] <= np.sqrt(E * pascal / (rho * density)) <= USUAL_SPEEDS[1]:
                return unit, per
    return None


def _size_warnings(size: Array, mass: float | None) -> list[str]:
    found = []
    largest = float(np.max(size))
    if not USUAL_SIZE[0] <= largest <= USUAL_SIZE[1]:
        found.append(
            f"the largest dimension is {largest:.3g} m, outside {USUAL_SIZE[0]:g} to {USUAL_SIZE[1]:g} m: is the "
            f"length unit right? {'mm' if largest > 1.0 else 'm'} were perhaps read as "
            f"{'m, coordinates are in m' if largest > 1.0 else 'mm'}"
        )
    box = float(np.prod(size))
    if mass is not None and box > 0.0 and not BOX_DENSITY <= mass / box <= DENSITIES[1]:
        found.append(
            f"a mass of {mass:.3g} kg in a box of {box:.3g} m3 is {mass / box:.3g} kg/m3, outside {BOX_DENSITY:g} to "
            f"{DENSITIES[1]:g}: length unit and unit of the density (or of the mass matrix) are inconsistent"
        )
    return found


class _Shape:
    """Extremes of edges [m], scaled Jacobian and aspect ratio over all cells; None where there are no cells."""

    def __init__(self, mesh: Mesh) -> None:
        self.edges: tuple[float, float] | None = None
        self.scaled_jacobian: float | None = None
        self.aspect_ratio: float | None = None
        self._poor = self._slender = 0
        if not mesh.cells:
            return
        shortest, longest, worst, ratio = np.inf, 0.0, np.inf, 1.0
        for kind, nodes in _chunks(mesh):
            cell = cell_kind(kind)
            pairs, neighbors = _corner_graph(cell)
            x = mesh.points[nodes]
            lengths = np.linalg.norm(x[:, pairs[:, 0]] - x[:, pairs[:, 1]], axis=2)
            low, high = lengths.min(axis=1), lengths.max(axis=1)
            aspect = high / np.maximum(low, np.finfo(float).tiny)
            quality = _scaled_jacobian(cell, x, neighbors)
            shortest, longest = min(shortest, float(low.min())), max(longest, float(high.max()))
            worst, ratio = min(worst, float(quality.min())), max(ratio, float(aspect.max()))
            self._poor += int(np.sum(quality < POOR_CELL))
            self._slender += int(np.sum(aspect > SLENDER_CELL))
        self.edges, self.scaled_jacobian, self.aspect_ratio = (shortest, longest), worst, ratio

    def warnings(self) -> list[str]:
        found = []
        if self._poor:
            found.append(
                f"{self._poor} cell(s) have a scaled Jacobian below {POOR_CELL:g}, the worst "
                f"{self.scaled_jacobian:.3g}: stresses near them are poor"
            )
        if self._slender:
            found.append(
                f"{self._slender} cell(s) have edges that differ by more than {SLENDER_CELL:g}, the worst by "
                f"{self.aspect_ratio:.3g}: linear cells lock in bending"
            )
        return found


def _corner_graph(cell: CellKind) -> tuple[Array, list[list[int]]]:
    """Edges (e, 2) between corners, and the three corners next to each one."""
    edges = set()
    for name, faces in cell.faces.items():
        corners = faces[:, : facet_kind(name).corner_count]
        for face in corners.tolist():
            edges |= {tuple(sorted(pair)) for pair in zip(face, face[1:] + face[:1], strict=True)}
    pairs = np.array(sorted(edges))
    return pairs, [[int(a + b - c) for a, b in pairs if c in (a, b)] for c in range(cell.corner_count)]


def _scaled_jacobian(cell: CellKind, x: Array, neighbors: list[list[int]]) -> Array:
    """Smallest over the corners (m,) for cells with node coordinates (m, k, 3)."""
    gradients = cell.shape(cell.nodes[: cell.corner_count])[1]
    worst = np.full(len(x), np.inf)
    for corner, others in enumerate(neighbors):
        along = (cell.nodes[others] - cell.nodes[corner]).T  # reference directions of the three edges, in columns
        tangents = np.tensordot(x, gradients[corner] @ along, axes=([1], [0]))  # (m, 3, 3 edges)
        lengths = np.prod(np.linalg.norm(tangents, axis=1), axis=1)
        sign = np.sign(determinants(along))
        worst = np.minimum(worst, sign * determinants(tangents) / np.maximum(lengths, np.finfo(float).tiny))
    return worst / _REGULAR[cell.domain]


def _chunks(mesh: Mesh) -> Iterator[tuple[str, Array]]:
    for kind, nodes in mesh.cells.items():
        for start in range(0, len(nodes), _CHUNK):
            yield kind, nodes[start : start + _CHUNK]


def _uncovered(mesh: Mesh, materials: Mapping[str, SolidMaterial]) -> int:
    """Number of cells that are in none of the cell sets."""
    covered = np.zeros(mesh.cell_count, dtype=bool)
    for name in materials:
        if name not in mesh.cell_sets:
            raise unknown_name(f"mesh {mesh.name or '(unnamed)'}: cell set", name, mesh.cell_sets)
        covered[mesh.cell_sets[name]] = True
    return int(np.sum(~covered))


def _densities(mesh: Mesh, material: SolidMaterial | Mapping[str, SolidMaterial]) -> Array:
    """Density of each cell (cell_count,) [kg/m3]."""
    if isinstance(material, Material | Orthotropic):
        return np.full(mesh.cell_count, material.density)
    bare = _uncovered(mesh, material)
    if bare:
        raise InputError(
            f"mesh report: {bare} of {mesh.cell_count} cells are in none of the sets {', '.join(material)}; give every "
            "cell a material"
        )
    density = np.zeros(mesh.cell_count)
    for name, one in material.items():
        density[mesh.cell_sets[name]] = one.density
    return density


def _from_cells(mesh: Mesh, density: Array) -> tuple[float, Vector, Array]:
    """Mass [kg], centre [m], inertia about it [kg m2], by quadrature."""
    origin = mesh.points.mean(axis=0)  # moments about a point inside: no cancellation far from the origin
    m, first, second = 0.0, np.zeros(3), np.zeros((3, 3))
    at = 0
    for kind, nodes in _chunks(mesh):
        cell = cell_kind(kind)
        x = mesh.points[nodes] - origin
        xi, weights = _RULES[cell.domain](MOMENT_POINTS[cell.degree])
        dm = cell.jacobians(x, xi) * weights * density[at : at + len(nodes), None]
        at += len(nodes)
        place = np.einsum("qa,maj->mqj", cell.shape(xi)[0], x, optimize=True)
        m += float(dm.sum())
        first += np.einsum("mq,mqj->j", dm, place)
        second += np.einsum("mq,mqi,mqj->ij", dm, place, place, optimize=True)
    d = first / m
    second -= m * np.outer(d, d)
    return m, _vector(origin + d), np.trace(second) * np.eye(3) - second


def _from_matrix(mesh: Mesh) -> tuple[float, Vector, Array]:
    """Mass [kg], centre [m], inertia about it [kg m2], of the mass matrix."""
    if mesh.matrices is None:
        raise ValueError("_from_matrix needs a mesh with matrices")
    M, n = mesh.matrices.mass, len(mesh.points)
    origin = mesh.points.mean(axis=0)
    x = mesh.points - origin
    T = np.tile(np.eye(3), (n, 1))
    S = np.stack([np.cross(axis, x).ravel() for axis in np.eye(3)], axis=1)
    m = float(np.trace(T.T @ (M @ T))) / 3.0
    coupling = S.T @ (M @ T)  # m [c]x, skew
    c = (
        0.5
        / m
        * np.array([coupling[2, 1] - coupling[1, 2], coupling[0, 2] - coupling[2, 0], coupling[1, 0] - coupling[0, 1]])
    )
    J = S.T @ (M @ S) - m * (c @ c * np.eye(3) - np.outer(c, c))
    return m, _vector(origin + c), 0.5 * (J + J.T)


def _vector(x: Array) -> Vector:
    return float(x[0]), float(x[1]), float(x[2])
