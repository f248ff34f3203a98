r"""The stress in a block with a round top pressed on its mirror image, by finite elements: a quarter of one block on a
rigid frictionless plane, quadratic hexahedra of scikit-fem, no modes and nothing of the engine but the solver of a
linear system.

Pressures are bilinear functions N_j of the corners of the top, gaps are weighed by the same, and the active set is that
of `contact`. The displacement of a pressure is what one factorisation gives, A_ij the weighed displacement of i by j.
The block's sides are those of a prism, its bottom slides on its plane, below `depth` it is of another material.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from skfem import (
    Basis,
    BilinearForm,
    ElementHex1,
    ElementHex2,
    ElementVector,
    FacetBasis,
    LinearForm,
    MeshHex,
    MeshHex2,
)
from skfem.helpers import ddot, sym_grad, trace

from references.finite_elements.contact import active_set
from warpffrf.model.material import Material
from warpffrf.offline.solvers import factorise

Array = np.ndarray
AT = 1e-9  # m, and of the height: nodes this close to a plane lie on it
BLOCK = 64  # right-hand sides solved at once


@dataclass(frozen=True)
class Block:
    """Radius [m] of the top, half the width across [m], length along the contact [m], height [m]; depth [m] of the
    upper material, which with the lower one makes `materials`."""

    radius: float
    half: float
    length: float
    height: float
    depth: float
    materials: tuple[Material, Material]


@dataclass(frozen=True)
class Pressed:
    """Largest pressure [Pa] and the von Mises stress [Pa] at the depths [m] below the middle of the contact."""

    peak: float
    stress: Array


def graded(first: float, largest: float, growth: float, length: float) -> Array:
    """Places from 0 to `length` of cells from about `first` on, each `growth` times the one before, up to `largest`."""
    sizes = [first]
    while sum(sizes) < length:
        sizes.append(min(sizes[-1] * growth, largest))
    return np.append(0.0, np.cumsum(sizes)) * length / sum(sizes)


def pressed(block: Block, load: float, size: float, reach: float, depths: Array) -> Pressed:
    """What `load` [N] makes, cells across of `size` [m] over the `reach` [m] that pressures may have."""
    fine = size * np.arange(round(reach / size) + 1)
    x = np.append(fine, fine[-1] + graded(size, 8.0 * size, 1.6, block.half - fine[-1])[1:])
    y = 0.5 * block.length - graded(2.0 * size, 5.0 * size, 1.3, 0.5 * block.length)[::-1]
    upper = graded(size, 20.0 * size, 1.4, block.depth)
    lower = block.depth + graded(20.0 * size, 40.0 * size, 1.4, block.height - block.depth)
    flat = MeshHex.init_tensor(x, y, np.append(upper, lower[1:]) / block.height)
    curved = MeshHex2.from_mesh(flat)
    X, Y, T = curved.doflocs
    Z = -_drop(block, X) * (1.0 - T) - block.height * T
    mesh = MeshHex2(np.stack([X, Y, Z]), curved.t)
    basis = Basis(mesh, ElementVector(ElementHex2()), intorder=4)
    is_upper = block.height * flat.p[2][flat.t].mean(axis=0) < block.depth
    lame = np.where(is_upper, *(np.array(m.lame)[:, None] for m in block.materials))  # (2, cells)
    K = _stiffness.assemble(basis, **{n: v[:, None] + 0.0 * basis.dx for n, v in zip(("lam", "mu"), lame, strict=True)})

    at, component = np.asarray(basis.doflocs), _components(basis)
    planes = ((at[0], 0), (at[1], 1), (at[2] + block.height, 2))
    held = np.any([(np.abs(v) < AT * block.height) & (component == k) for v, k in planes], axis=0)
    free = np.flatnonzero(~held)
    factor = factorise(K.tocsc()[free][:, free], coordinates=np.ascontiguousarray(at[:, free].T))

    top = flat.facets_satisfying(lambda p: np.abs(p[2]) < AT, boundaries_only=True)
    pressures = FacetBasis(flat, ElementHex1(), facets=top, intorder=6)
    above = FacetBasis(mesh, basis.elem, facets=top, intorder=6)
    nodes = np.flatnonzero((flat.p[2] == 0.0) & (flat.p[0] <= fine[-1] + AT))
    loads = BilinearForm(lambda u, v, w: -u * v[2]).assemble(pressures, above).tocsc()[free][:, nodes].toarray()
    gap = LinearForm(lambda v, w: v * _drop(block, w.x[0])).assemble(pressures)[nodes]
    area = LinearForm(lambda v, w: v).assemble(pressures)[nodes]
    moved = np.hstack([factor.solve(loads[:, i : i + BLOCK]) for i in range(0, len(nodes), BLOCK)])
    guards = np.flatnonzero(flat.p[0][nodes] > fine[-1] - AT).tolist()
    pressure = active_set(loads.T @ moved, gap, area, np.eye(len(nodes)), 0.25 * load, guards)[0]

    u = np.zeros(basis.N)
    u[free] = moved @ pressure
    stress = [_von_mises(basis, flat, u, lame, depth / block.height) for depth in depths]
    return Pressed(float(pressure.max()), np.array(stress))


def _drop(block: Block, x: Any) -> Any:
    return block.radius - np.sqrt(block.radius**2 - x**2)


@BilinearForm
def _stiffness(u: Any, v: Any, w: Any) -> Any:
    strain = sym_grad(u)
    return w.lam * trace(strain) * trace(sym_grad(v)) + 2.0 * w.mu * ddot(strain, sym_grad(v))


def _components(basis: Basis) -> Array:
    """The axis (n,) of each dof."""
    found = np.empty(basis.N, dtype=int)
    for dofs in (basis.nodal_dofs, basis.edge_dofs, basis.facet_dofs, basis.interior_dofs):
        for k in range(3):
            found[np.asarray(dofs)[k::3]] = k
    return found


def _von_mises(basis: Basis, flat: MeshHex, u: Array, lame: Array, place: float) -> float:
    """On the line x = y = 0, at `place` of the height, in the cell above."""
    low, high = (f(np.asarray(flat.p)[:, flat.t], axis=1) for f in (np.min, np.max))  # (3, cells)
    cell = np.flatnonzero((low[0] == 0.0) & (low[1] < AT) & (high[2] >= place - AT))
    cell = cell[[np.argmin(high[2][cell])]]
    local = flat.mapping().invF(np.array([0.0, 0.0, place])[:, None, None], tind=cell)[:, 0]
    there: Any = Basis(basis.mesh, basis.elem, elements=cell, quadrature=(local, np.ones(1))).interpolate(u)
    grad = there.grad[:, :, 0, 0]
    strain = 0.5 * (grad + grad.T)
    deviator = 2.0 * lame[1, cell[0]] * (strain - np.trace(strain) / 3.0 * np.eye(3))
    return float(np.sqrt(1.5 * (deviator**2).sum()))
