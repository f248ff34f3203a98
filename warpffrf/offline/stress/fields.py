r"""From stress plans to the stress fields of a reduced body: observers for either path, and fields of their results.

Membrane. Stress of the membrane energy at the points of a stress plan.

The second-order strain of a body is `E2 = sum_r e_r (eps(motion_r) + sum_ij products_rij sym(H_i^T H_j)/2)`
(`offline.inertia.membrane`), so that its stress, second Piola-Kirchhoff's, is `sum_r e_r sigma_r` with

    sigma_r = C (eps(motion_r) + sum_ij products_rij sym(H_i^T H_j)/2).

The two parts nearly cancel across a plate, where they are products of slopes and no strain remains. So the sum is
formed in cells, at their recovery points, extrapolated to the nodes by the polynomial through them, averaged over the
cells of one material that share a node, and interpolated between nodes: smoothing each part separately with patches
left a stress across the plate of a fifth of that along it. Components are along fibres of the body, which
rotate with it. On a contact surface sigma_r has no traction: the applied traction is in the other parts.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import scipy.sparse as sp

from warpffrf.model.material import Material
from warpffrf.model.reduced.contact_surface import ContactSurface
from warpffrf.model.reduced.stress_field import GridSpan, StressField
from warpffrf.offline.cyclic.inertia import CyclicObserver, ObservedModes
from warpffrf.offline.fe import CHUNK_BYTES, STIFFNESS_DEGREE, gradients_at, is_mixed, projection, rule
from warpffrf.offline.general.observers import Observer
from warpffrf.offline.inertia.second_order import FIRST, SECOND, SHEAR, hooke, strain_of
from warpffrf.offline.products import MembraneTerms
from warpffrf.offline.stress.plan import StressPlan
from warpffrf.offline.stress.recovery_points import recovery_points, to_nodes


class StressRecovery:
    """The plans of one reduction and their observers; `axes` (3, 3) of sector 0 for the cyclic path, None for the
    general one."""

    def __init__(self, plans: Sequence[StressPlan], axes: np.ndarray | None = None) -> None:
        self.plans = plans
        self._sectors = [None if axes is None else plan.sector_operator(axes) for plan in plans]

    def observers(self) -> list[Any]:
        """`CyclicObserver` or `Observer` of each plan, for the path's `observers`."""
        return [
            Observer(_label(plan), plan.operator()) if at is None else CyclicObserver(_label(plan), at.blocks)
            for plan, at in zip(self.plans, self._sectors, strict=True)
        ]

    def fields(self, product: Any, contact: Mapping[str, ContactSurface]) -> dict[str, StressField]:
        """Fields by name from the path's `product` and the finished `contact` surfaces, in the order of
        `product.surfaces`."""
        found = {}
        for plan, sectors in zip(self.plans, self._sectors, strict=True):
            label = _label(plan)
            seen = product.observed_modes[label]
            if isinstance(seen, ObservedModes):
                if sectors is None:
                    raise ValueError("a cyclic product needs the axes of sector 0")
                seen = seen.real(sectors.sampled)
            normal, tangential = {}, {}
            for name, s in zip(contact, product.surfaces, strict=True):
                span = GridSpan(s.first_column, s.whole_columns, sectors is not None or s.grid.periodic)
                normal[name] = (s.observed[label], span)
                if label in s.observed_tangential:
                    tangential[name] = (s.observed_tangential[label], span)
            field = plan.field(seen, contact, normal, tangential, sectors)
            if product.matched is not None:
                field = replace(field, matched=product.matched.by_force(label, 6))
            if product.membrane is not None:
                field = replace(field, membrane=membrane_stress(plan, product.membrane))
            found[plan.name] = field
        return found


def _label(plan: StressPlan) -> str:
    return f"stress/{plan.name}"


Array = np.ndarray


def membrane_stress(plan: StressPlan, terms: MembraneTerms) -> Array:
    """sigma_r (R, p, 6) [Pa/sqrt(J)] at the points of `plan`, user axes, single precision."""
    mesh, assignment, slots = plan.mesh, plan.assignment, plan.slots
    rank, n = len(terms.forms), len(mesh.points)
    if not rank:
        return np.zeros((0, len(plan.points), 6), dtype=np.float32)
    total, shared = np.zeros((len(slots), 6 * rank)), np.zeros(len(slots))
    for kind, cells in plan.cells.items():
        for i in range(len(assignment.materials)):
            slot = np.full(n, -1)
            own = np.flatnonzero(slots.material == i)
            slot[slots.node[own]] = own
            here = cells[plan.of_cell[kind] == i]
            here = here[np.any(slot[here] >= 0, axis=1)]
            points = len(recovery_points(kind)[0])
            chunk = max(1, CHUNK_BYTES // (8 * 9 * points * (4 * rank + terms.modes.shape[1])))
            for start in range(0, len(here), chunk):
                nodes = here[start : start + chunk]
                S = to_nodes(kind) @ _at_recovery_points(plan, terms, kind, i, nodes).reshape(len(nodes), points, -1)
                cell, a = np.nonzero(slot[nodes] >= 0)
                rows = slot[nodes[cell, a]]
                gather = sp.csr_matrix((np.ones(len(rows)), (rows, np.arange(len(rows)))), (len(slots), len(rows)))
                total += gather @ S[cell, a]
                shared += np.bincount(rows, minlength=len(slots))
    found = plan.weights @ (total / np.maximum(shared, 1.0)[:, None])
    return plan.without_traction(np.moveaxis(found.reshape(-1, 6, rank), 2, 0)).astype(np.float32)


def _at_recovery_points(plan: StressPlan, terms: MembraneTerms, kind: str, number: int, nodes: Array) -> Array:
    """sigma_r (e, q, 6, R) in the cells `nodes` (e, a) of material `number`."""
    x, material = plan.mesh.points[nodes], plan.assignment.materials[number]
    N, dN = recovery_points(kind)
    E = _strain(terms, nodes, gradients_at(x, dN)[0])
    S = hooke(E, material)
    if isinstance(material, Material) and is_mixed(kind, material):
        inside = _strain(terms, nodes, gradients_at(x, rule(kind, STIFFNESS_DEGREE[kind]).gradients)[0])
        trace = np.einsum("epq,eqcr->epr", projection(x, kind, N), inside[:, :, :3])
        S[:, :, :3] += material.lame[0] * (trace - E[:, :, :3].sum(axis=2))[:, :, None]
    return S / SHEAR[:, None]


def _strain(terms: MembraneTerms, nodes: Array, slopes: Array) -> Array:
    """E2 of each amplitude (e, q, 6, R) at points with `slopes` (e, q, a, 3) [1/m], shear times sqrt 2."""
    U = terms.modes.reshape(-1, 3, terms.modes.shape[1])[nodes]
    H = np.einsum("eack,eqad->eqcdk", U, slopes, optimize=True)
    half = np.einsum("eqcdi,rij->eqcdrj", H, 0.5 * terms.products, optimize=True)
    both = np.einsum("eqcarj,eqcbj->eqabr", half, H, optimize=True)
    E = 0.5 * SHEAR[:, None] * (both[:, :, FIRST, SECOND] + both[:, :, SECOND, FIRST])
    return E + strain_of(terms.motion.reshape(-1, 3, E.shape[3])[nodes], slopes)
