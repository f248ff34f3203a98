r"""Finite-element matrices: quadrature, materials of cells, assembly.

Assembly. Stiffness and mass matrices of linear elasticity on isoparametric cells.

With scalar shape functions `N_a` and `g_ab^ij = int dN_a/dx_i dN_b/dx_j dV` the stiffness of an isotropic and of an
orthotropic material is

    K_(a,i),(b,j) = lambda g_ab^ij + mu g_ab^ji + mu delta_ij sum_k g_ab^kk,      K_(a,i),(b,k) = c_ijkl g_ab^jl,

and the consistent mass `M_(a,i),(b,j) = delta_ij rho int N_a N_b dV`: everything follows from *scalar* integrals,
batched over components and cells. Dofs are node-interleaved, `3*node + component`, in mesh numbering.

Dilatation. The dilatation of nearly incompressible cells, treated so that they do not lock.

At nu -> 1/2 the energy `lambda/2 int (div u)^2 dV` allows only isochoric motion, and a cell has too few such motions:
it locks, and is too stiff by the ratio of lambda to mu. In the mixed formulation with a displacement u
and a pressure p (Herrmann 1965, AIAA J. 3, 1896), find the stationary point of

    int mu e:e dV + int p div u dV - int p^2/(2 lambda) dV,

p a polynomial in each cell, `p = sum_i psi_i p_i`. Its equation gives `p = lambda P div u`, P the projection onto that
polynomial, so that p is eliminated (Malkus and Hughes 1978, Comput. Methods Appl. Mech. Eng. 15, 63):

    K = int 2 mu e:e + lambda (P div u)^2 dV,     P div u = psi^T H^-1 sum_a b_a.u_a,
    H = int psi psi^T dV,     b_(a,c) = int psi dN_a/dx_c dV.

If div u lies in the span of psi, P changes nothing: constant strain is exact in every cell. psi is written in x, the
position relative to the middle of the cell, not in the reference coordinates, so that this holds for cells of any shape
(Arnold, Boffi and Falk 2002, Math. Comput. 71, 909). The polynomial of each kind of cell is its `CellKind.dilatation`:
constant for trilinear hexahedra, quadratic wedges and quadratic tetrahedra, linear for quadratic hexahedra. Linear
tetrahedra and wedges have none: such a mesh has two to six times as many cells as nodes, so that a constant pressure
per cell imposes too many conditions, and they still lock.

Materials. The material of each cell of a mesh.

Reference. Quadrature on reference cells and facets, with the shape functions of `warpffrf.model.mesh.elements` at its
points.

The points and weights are scikit-fem's. Those of hexahedra and quadrilaterals are mapped from its [0, 1] to the [-1, 1]
of the elements here; a wedge uses the product of its triangle's and its line's points (scikit-fem's own rule for wedges
has weights that sum to half the volume).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np
import scipy.sparse as sp

from warpffrf.model.errors import InputError, unknown_name
from warpffrf.model.material import NEARLY_INCOMPRESSIBLE, Material, Orthotropic, SolidMaterial
from warpffrf.model.mesh import FacetSet, Mesh
from warpffrf.model.mesh.elements import CELL_KINDS, FACET_KINDS, cell_kind, determinants, facet_kind
from warpffrf.model.mesh.elements.kinds import monomials

Sparse = Any  # a scipy.sparse csr matrix; the stubs of scipy lose its type on every product and slice
CHUNK_BYTES = 1 << 26  # element matrices processed together: 64 MiB keeps the peak far below that of a factorisation


def fe_matrices(mesh: Mesh, assignment: Assignment) -> tuple[Sparse, Sparse]:
    """K [N/m] and M [kg] of the body: the mesh's own matrices, or those assembled from its cells."""
    if mesh.matrices is not None:
        return mesh.matrices.stiffness, mesh.matrices.mass
    return assemble(mesh.points, mesh.cells, assignment)


def assemble(points: np.ndarray, cells: Mapping[str, np.ndarray], assignment: Assignment) -> tuple[Sparse, Sparse]:
    """K [N/m] and M [kg], both (3 n, 3 n) sparse, of the `cells` {kind: (m, k)} over the nodes `points` (n, 3) [m]."""
    n = len(points)
    K = sp.csr_matrix((3 * n, 3 * n))
    m = sp.csr_matrix((n, n))
    for kind, all_cells in cells.items():
        for i, material in enumerate(assignment.materials):
            here = all_cells[assignment.of_cell[kind] == i]
            k = here.shape[1]
            chunk = max(1, CHUNK_BYTES // (8 * 3 * (3 * k) ** 2))
            for start in range(0, len(here), chunk):
                part = here[start : start + chunk]
                x = points[part]
                dofs = (3 * part[:, :, None] + np.arange(3)).reshape(len(part), -1)
                K = K + scatter(_stiffness(x, kind, material), dofs, 3 * n)
                m = m + scatter(scalar_mass(x, kind, material.density), part, n)
    return sp.csr_matrix(K), sp.csr_matrix(sp.kron(m, sp.identity(3), format="csr"))


def scatter(local: np.ndarray, dofs: np.ndarray, size: int) -> Sparse:
    """(size, size) csr: the sum of the cells' matrices `local` (e, k, k) at their `dofs` (e, k)."""
    k = dofs.shape[1]
    rows = np.repeat(dofs, k, axis=1).ravel().astype(np.int32)
    columns = np.tile(dofs, (1, k)).ravel().astype(np.int32)
    return sp.coo_matrix((local.ravel(), (rows, columns)), shape=(size, size)).tocsr()


def _stiffness(x: np.ndarray, kind: str, material: SolidMaterial) -> np.ndarray:
    slopes, weight = physical_gradients(x, kind)
    e, q, k, _ = slopes.shape
    flat = slopes.reshape(e, q, 3 * k)
    g = np.matmul((flat * weight[..., None]).transpose(0, 2, 1), flat).reshape(e, k, 3, k, 3)
    if isinstance(material, Orthotropic):
        return np.einsum("ijkl,eajbl->eaibk", material.stiffness, g, optimize=True).reshape(e, 3 * k, 3 * k)
    lam, mu = material.lame
    trace = np.einsum("eaibi->eab", g)
    K = mu * g.transpose(0, 1, 4, 3, 2)
    if is_mixed(kind, material):
        D = projected_dilatation(x, kind).reshape(e, q, 3 * k)
        K += lam * np.matmul((D * weight[..., None]).transpose(0, 2, 1), D).reshape(e, k, 3, k, 3)
    else:
        K += lam * g
    for i in range(3):
        K[:, :, i, :, i] += mu * trace
    return K.reshape(e, 3 * k, 3 * k)


def scalar_mass(x: np.ndarray, kind: str, density: float) -> np.ndarray:
    """density int N_a N_b dV (e, k, k) of cells with node coordinates x (e, k, 3)."""
    r = rule(kind, MASS_DEGREE[kind])
    J = np.einsum("eai,qaj->eqij", x, r.gradients)
    weight = determinants(J) * r.weights * density
    return np.einsum("qa,qb,eq->eab", r.values, r.values, weight, optimize=True)


Array = np.ndarray
PROJECTED = tuple(kind for kind in CELL_KINDS if cell_kind(kind).dilatation is not None)
WAVERING = "tet10"  # displacements converge, the mean stress hardly: measured error 41 %, that of hex20 cells 6 %


def is_mixed(kind: str, material: SolidMaterial) -> bool:
    """Whether cells of `kind` made of `material` use the projected dilatation."""
    return material.mixed and kind in PROJECTED


def formulation_notes(assignment: Assignment, stresses: bool) -> tuple[list[str], list[str]]:
    """Notes on materials whose cells use the mixed formulation, and warnings of cells that lock, or whose requested
    `stresses` oscillate."""
    notes, warnings = [], []
    for i, material in enumerate(assignment.materials):
        if isinstance(material, Orthotropic):
            continue
        label = f"material {material.name!r}" if material.name else "material"
        ratio = f"at Poisson's ratio {material.poisson_ratio:g}"
        nearly = material.poisson_ratio > NEARLY_INCOMPRESSIBLE
        count = {kind: int(np.sum(number == i)) for kind, number in assignment.of_cell.items()}
        able = [f"{n} {kind}" for kind, n in count.items() if n and kind in PROJECTED]
        unable = [f"{n} {kind}" for kind, n in count.items() if n and kind not in PROJECTED]
        lock = f"lock {ratio}, the body is too stiff, possibly several times"
        if able and material.mixed:
            notes.append(
                f"{label}: {', '.join(able)} cells use the mixed formulation of displacement and pressure, which does "
                f"not lock {ratio}"
            )
        if able and nearly and not material.mixed:
            warnings.append(f"{label}: {', '.join(able)} cells {lock}; leave out formulation='displacement'")
        if unable and (nearly or material.mixed):
            meanwhile = lock if nearly else "use that of displacement alone"
            warnings.append(
                f"{label}: {', '.join(unable)} cells have no mixed formulation and {meanwhile}; "
                f"{', '.join(PROJECTED)} cells have one"
            )
        if stresses and count.get(WAVERING) and is_mixed(WAVERING, material):
            warnings.append(
                f"{label}: the mean stress in {count[WAVERING]} {WAVERING} cells oscillates from cell to cell "
                f"{ratio}, possibly by some tenths; use hex8, hex20 or hex27 cells for stresses"
            )
    return notes, warnings


def projected_dilatation(x: Array, kind: str, values: Array | None = None) -> Array:
    """P div u per nodal displacement, (e, p, k, 3) [1/m], of cells with node coordinates x (e, k, 3) [m], at reference
    points with shape functions `values` (p, k); None: at the points at which stiffness is integrated."""
    r = rule(kind, STIFFNESS_DEGREE[kind])
    values = r.values if values is None else values
    slopes, weight = physical_gradients(x, kind)
    psi = _pressures(x, kind, r.values)
    H = np.einsum("eqm,eqn,eq->emn", psi, psi, weight)
    b = np.einsum("eqm,eqac,eq->emac", psi, slopes, weight, optimize=True)
    e, m, k, _ = b.shape
    at = np.linalg.solve(H, b.reshape(e, m, 3 * k))
    return np.matmul(_pressures(x, kind, values), at).reshape(e, len(values), k, 3)


def projection(x: Array, kind: str, values: Array | None = None) -> Array:
    """P (e, p, q): values at the stiffness quadrature points to those of the nearest polynomial, of cells with node
    coordinates x (e, k, 3) [m], at points with shape functions `values` (p, k); None: at the same points."""
    r = rule(kind, STIFFNESS_DEGREE[kind])
    _, weight = physical_gradients(x, kind)
    psi = _pressures(x, kind, r.values)
    weighted = (psi * weight[:, :, None]).transpose(0, 2, 1)
    at = psi if values is None else _pressures(x, kind, values)
    return np.matmul(at, np.linalg.solve(np.matmul(weighted, psi), weighted))


def _pressures(x: Array, kind: str, values: Array) -> Array:
    """psi (e, p, m) at reference points with shape functions `values` (p, k)."""
    powers = cell_kind(kind).dilatation
    if powers is None:
        raise ValueError(f"cells of kind {kind} have no projected dilatation, ask is_mixed")
    middle = x.mean(axis=1, keepdims=True)
    size = np.ptp(x, axis=1).max(axis=1)
    place = (np.einsum("pa,eai->epi", values, x) - middle) / size[:, None, None]
    return monomials(place.reshape(-1, 3), powers).reshape(*place.shape[:2], len(powers))


@dataclass(frozen=True)
class Assignment:
    """`materials`, and for each block of cells the number of its cells' material (m,)."""

    materials: tuple[SolidMaterial, ...]
    of_cell: dict[str, np.ndarray]


def assign(mesh: Mesh, material: SolidMaterial | Mapping[str, SolidMaterial] | None) -> Assignment:
    """Assign one material, or {cell set: material}, to the cells of `mesh`.

    Raises `InputError` for an unknown cell set, a cell without material or with two, and if a mesh of cells has no
    material. A mesh with its own matrices needs no material; if given, it is used for results only.
    """
    if material is None:
        if mesh.matrices is None and mesh.cells:
            raise InputError("reduce: a material is needed, made by Material, or {cell set: Material}")
        return Assignment((), {})
    if isinstance(material, Material | Orthotropic):
        return Assignment((material,), {kind: np.zeros(len(c), dtype=np.int64) for kind, c in mesh.cells.items()})
    if not isinstance(material, Mapping) or not material:
        raise InputError(f"reduce: a material is needed, made by Material, or {{cell set: Material}}, got {material!r}")
    number = np.full(mesh.cell_count, -1, dtype=np.int64)
    for i, (name, one) in enumerate(material.items()):
        if not isinstance(one, Material | Orthotropic):
            raise InputError(f"material of cell set {name!r}: a Material is needed, got {one!r}")
        if name not in mesh.cell_sets:
            raise unknown_name(f"mesh {mesh.name or '(unnamed)'}: cell set", name, mesh.cell_sets)
        cells = mesh.cell_sets[name]
        taken = cells[number[cells] >= 0]
        if len(taken):
            other = list(material)[int(number[taken[0]])]
            raise InputError(
                f"materials of cell sets {other!r} and {name!r}: {len(taken)} cells are in both, the first is number "
                f"{taken[0]}; give each cell one material"
            )
        number[cells] = i
    bare = np.flatnonzero(number < 0)
    if len(bare):
        raise InputError(
            f"material: {len(bare)} of {mesh.cell_count} cells are in none of the sets {', '.join(material)}, the "
            f"first is number {bare[0]}; give every cell a material"
        )
    return Assignment(tuple(material.values()), dict(mesh.by_block(number)))


def facet_material(mesh: Mesh, facets: FacetSet, assignment: Assignment) -> Material | None:
    """The material below most of the facets, isotropic (`require_isotropic`); None for a mesh without materials."""
    if len(assignment.materials) < 2:
        found = assignment.materials[0] if assignment.materials else None
    else:
        found = assignment.materials[int(np.argmax(_cells_behind(mesh, facets, assignment)))]
    return None if isinstance(found, Orthotropic) else found


def require_isotropic(mesh: Mesh, name: str, assignment: Assignment) -> None:
    """Raises `InputError` if the facet set `name`, a contact surface, is on orthotropic cells."""
    behind = _cells_behind(mesh, mesh.facets(name), assignment)
    for count, material in zip(behind, assignment.materials, strict=True):
        if isinstance(material, Orthotropic) and count:
            of = f" {material.name!r}" if material.name else ""
            raise InputError(
                f"contact {name!r}: {int(count)} cells below it are of the orthotropic material{of}; half-spaces, "
                "Hertz and the stress below tractions need isotropic ones: give the layer of cells there a Material"
            )


def other_material(mesh: Mesh, facets: FacetSet, assignment: Assignment) -> float:
    """Share (0 to 1) of the cells behind the facets whose material is not `facet_material`."""
    if len(assignment.materials) < 2:
        return 0.0
    behind = _cells_behind(mesh, facets, assignment)
    return float(1.0 - behind.max() / max(behind.sum(), 1.0))


def _cells_behind(mesh: Mesh, facets: FacetSet, assignment: Assignment) -> np.ndarray:
    """Number of cells with a face on the facets, by material: a face has three corners or more, an edge two."""
    on_set = np.zeros(len(mesh.points), dtype=bool)
    on_set[facets.node_set] = True
    found = np.zeros(len(assignment.materials))
    for kind, cells in mesh.cells.items():
        behind = on_set[cells[:, : cell_kind(kind).corner_count]].sum(axis=1) >= 3
        found += np.bincount(assignment.of_cell[kind][behind], minlength=len(found))
    return found


# Polynomial degree that the rule integrates exactly, per kind: stiffness and mass. Degrees count per direction for
# quadrilaterals, hexahedra and the axis of wedges. Stiffness: full integration. Mass: hex8 and hex20 by 2 x 2 x 2 and
# 3 x 3 x 3 points, as FE programs do, so that frequencies on the same mesh agree; the others N_a N_b det J.
STIFFNESS_DEGREE = {"hex8": 3, "hex20": 5, "hex27": 5, "wedge6": 3, "wedge15": 5, "tet4": 1, "tet10": 4}
MASS_DEGREE = {"hex8": 3, "hex20": 5, "hex27": 7, "wedge6": 4, "wedge15": 7, "tet4": 2, "tet10": 6}
FACET_DEGREE = {"quad4": 7, "quad8": 7, "quad9": 7, "tri3": 5, "tri6": 6}


@dataclass(frozen=True)
class Rule:
    """Quadrature on a reference cell: shape functions (q, k), gradients (q, k, dim), weights (q,)."""

    values: np.ndarray
    gradients: np.ndarray
    weights: np.ndarray


@cache
def rule(kind: str, degree: int, pieces: int = 1) -> Rule:
    """Quadrature of `degree` on the reference cell of `kind`, split into `pieces` along each edge (facets only).

    Splitting is for integrands with kinks inside the cell, such as the shape functions of a contact grid over a facet.
    """
    element = facet_kind(kind) if kind in FACET_KINDS else cell_kind(kind)
    X, W = _points(element.domain, degree)
    if pieces > 1:
        X, W = _split(X, W, pieces, triangle=element.domain == "tri")
    if element.domain in ("hex", "quad"):
        X, W = 2.0 * X - 1.0, W * 2.0 ** len(X)
    values, gradients = element.shape(X.T)
    return Rule(values, gradients, W)


def physical_gradients(x: np.ndarray, kind: str) -> tuple[np.ndarray, np.ndarray]:
    """dN_a/dx_i (e, q, k, 3) and volumes (e, q) at the stiffness points of cells with node coordinates x (e, k, 3)."""
    r = rule(kind, STIFFNESS_DEGREE[kind])
    slopes, J = gradients_at(x, r.gradients)
    return slopes, determinants(J) * r.weights


def gradients_at(x: np.ndarray, reference: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """dN_a/dx_i (e, q, k, 3) and the Jacobians dx_i/dxi_j (e, q, 3, 3) of cells with node coordinates x (e, k, 3) at
    points with `reference` gradients dN_a/dxi_j (q, k, 3)."""
    J = np.einsum("eai,qaj->eqij", x, reference)
    return np.einsum("qaj,eqji->eqai", reference, np.linalg.inv(J)), J


def _points(domain: str, degree: int) -> tuple[np.ndarray, np.ndarray]:
    """Points (dim, q) and weights (q,) on scikit-fem's reference domain; the axis of a wedge on [-1, 1]."""
    from skfem.quadrature import get_quadrature
    from skfem.refdom import RefHex, RefLine, RefQuad, RefTet, RefTri

    if domain == "wedge":
        (flat, area), (line, length) = get_quadrature(RefTri, degree), get_quadrature(RefLine, degree)
        along = np.tile(2.0 * line[0] - 1.0, flat.shape[1])
        return np.vstack([np.repeat(flat, line.shape[1], axis=1), along]), np.outer(area, 2.0 * length).ravel()
    return get_quadrature({"hex": RefHex, "tet": RefTet, "quad": RefQuad, "tri": RefTri}[domain], degree)


def _split(X: np.ndarray, W: np.ndarray, pieces: int, triangle: bool) -> tuple[np.ndarray, np.ndarray]:
    n = pieces
    points = []
    for i in range(n):
        for j in range(n):
            if not triangle:
                points.append((X + np.array([[i], [j]])) / n)
                continue
            if i + j <= n - 1:
                points.append((X + np.array([[i], [j]])) / n)
            if i + j <= n - 2:
                points.append((np.array([[i + 1.0], [j + 1.0]]) - X) / n)
    return np.concatenate(points, axis=1), np.tile(W, len(points)) / n**2
