r"""The dilatation of cells whose material hardly changes its volume, so that they do not lock.

At nu -> 1/2 the energy `lambda/2 int (div u)^2 dV` allows only motion without any change of volume, and a cell has too
few of those: it locks, and is too stiff by as much as lambda exceeds mu. In the mixed formulation with a displacement u
and a pressure p (Herrmann 1965, AIAA J. 3, 1896), find the stationary point of

    int mu e:e dV + int p div u dV - int p^2/(2 lambda) dV,

p of each cell a polynomial of its own, `p = sum_i psi_i p_i`. Its equation gives `p = lambda P div u`, P the projection
on that polynomial, so that p never enters the system (Malkus and Hughes 1978, Comput. Methods Appl. Mech. Eng. 15, 63):

    K = int 2 mu e:e + lambda (P div u)^2 dV,     P div u = psi^T H^-1 sum_a b_a.u_a,
    H = int psi psi^T dV,     b_(a,c) = int psi dN_a/dx_c dV.

Where div u lies in the span of psi, P changes nothing: constant strain is exact in every cell. psi is written in x, the
place relative to the middle of the cell, not in the reference coordinates, so that this holds for cells of any shape
(Arnold, Boffi and Falk 2002, Math. Comput. 71, 909). The polynomial of each kind of cell is its `CellKind.dilatation`:
a constant of trilinear hexahedra, quadratic wedges and quadratic tetrahedra, linear of quadratic hexahedra. Of linear
tetrahedra and wedges there is none: a mesh of them has two to six times as many cells as nodes, so that with a constant
pressure of each cell there are more conditions than can be borne, and they lock all the same.
"""

from __future__ import annotations

import numpy as np

from warpffrf.model.material import NEARLY_INCOMPRESSIBLE, Material
from warpffrf.model.mesh.elements import CELL_KINDS, cell_kind
from warpffrf.model.mesh.elements.kinds import monomials
from warpffrf.offline.fe.materials import Assignment
from warpffrf.offline.fe.reference import STIFFNESS_DEGREE, physical_gradients, rule

Array = np.ndarray
PROJECTED = tuple(kind for kind in CELL_KINDS if cell_kind(kind).dilatation is not None)
WAVERING = "tet10"  # displacements converge, the mean stress hardly: measured 41 % off where hex20 cells are 6 %


def is_mixed(kind: str, material: Material) -> bool:
    """Whether cells of `kind` made of `material` take the projected dilatation."""
    return material.mixed and kind in PROJECTED


def formulation_notes(assignment: Assignment, stresses: bool) -> tuple[list[str], list[str]]:
    """Notes on the materials whose cells take the mixed formulation, and warnings of cells that lock, or whose
    `stresses`, where these are wanted, waver."""
    notes, warnings = [], []
    for i, material in enumerate(assignment.materials):
        label = f"material {material.name!r}" if material.name else "material"
        ratio = f"at Poisson's ratio {material.poisson_ratio:g}"
        nearly = material.poisson_ratio > NEARLY_INCOMPRESSIBLE
        count = {kind: int(np.sum(number == i)) for kind, number in assignment.of_cell.items()}
        able = [f"{n} {kind}" for kind, n in count.items() if n and kind in PROJECTED]
        unable = [f"{n} {kind}" for kind, n in count.items() if n and kind not in PROJECTED]
        lock = f"lock {ratio}, the body is too stiff, maybe by several times"
        if able and material.mixed:
            notes.append(
                f"{label}: {', '.join(able)} cells take the mixed formulation of displacement and pressure, which does "
                f"not lock {ratio}"
            )
        if able and nearly and not material.mixed:
            warnings.append(f"{label}: {', '.join(able)} cells {lock}; leave out formulation='displacement'")
        if unable and (nearly or material.mixed):
            meanwhile = lock if nearly else "take that of displacement alone"
            warnings.append(
                f"{label}: {', '.join(unable)} cells have no mixed formulation and {meanwhile}; "
                f"{', '.join(PROJECTED)} cells have one"
            )
        if stresses and count.get(WAVERING) and is_mixed(WAVERING, material):
            warnings.append(
                f"{label}: the mean stress in {count[WAVERING]} {WAVERING} cells wavers from cell to cell {ratio}, "
                "maybe by some tenths; use hex8, hex20 or hex27 cells for stresses"
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
    """P (e, p, q): values at the points at which stiffness is integrated to those of the nearest polynomial, of cells
    with node coordinates x (e, k, 3) [m], at points with shape functions `values` (p, k); None: at the same points."""
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
