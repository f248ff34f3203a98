r"""Heat conduction of a body and its thermal expansion, reduced as its deformation is.

Of the finite elements, with the shape functions N of the displacements,

    K_T = int k grad N . grad N dV + sum int h N N dA,      C = int rho c N N dV,
    A_(a,i),b = int (2 mu + 3 lambda) alpha dN_a/dx_i N_b dV,

A theta the nodal loads of the stress D alpha theta that holds the body at its shape; in cells of the mixed formulation
the part of lambda loads the projected dilatation, as their stiffness does. Nodes of fixed temperature are eliminated,
theta = sum T_k on them. What is kept of it is described in `warpffrf.model.reduced.thermal`.

The modes Phi span the slowest eigenmodes of (K_T, C) and the responses (K_T + s C)^-1 w to each of a few loads w, s = 0
and `RATES` values of s above the slowest rate, `STEP` apart: a rational Krylov space, exact in each of these rates,
which resolves steps of w from 1/(fastest s) on. The loads w are fluxes into each contact surface, uniform and of the
first harmonics around, on a plane and along the axis linear; and C theta_k, by which surroundings and a uniform start
enter. Ritz vectors of their span are C-orthonormal and K_T-orthogonal.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import scipy.sparse as sp

from warpffrf.model.errors import InputError
from warpffrf.model.material import THERMAL, Material
from warpffrf.model.mesh import Mesh
from warpffrf.model.reduced.thermal import ReducedThermal
from warpffrf.model.thermal import BodyTemperature
from warpffrf.offline.bases.modes import vibration_modes
from warpffrf.offline.elastic import Array, ElasticModel, free_model
from warpffrf.offline.fe import (
    CHUNK_BYTES,
    STIFFNESS_DEGREE,
    Assignment,
    Sparse,
    is_mixed,
    physical_gradients,
    projected_dilatation,
    rule,
    scalar_mass,
    scatter,
)
from warpffrf.offline.general.unit_loads import GeneralSurface
from warpffrf.offline.interfaces import InterfaceSystem, facet_mass
from warpffrf.offline.progress import Progress

RATES, STEP = 6, 4.0  # shifts and their ratio: steps are resolved from 1/4096 of the largest time constant on
DEPENDENT = 1e-10  # of the largest: eigenvalue of the Gram matrix of unit vectors below which a direction is dropped
BLOCK = 64  # right-hand sides at a time


def require_thermal_input(mesh: Mesh, material: Any, wanted: Any, contact: Any) -> None:
    """Raises `InputError` for a body without the data that a temperature needs."""
    if not isinstance(wanted, BodyTemperature):
        raise InputError(f"reduce: thermal must be films.BodyTemperature(...) or None, got {wanted!r}")
    if mesh.structure.parts or not mesh.cells:
        raise InputError(
            "reduce: thermal= needs a mesh of solid cells: shells, beams and matrices have no conductivity; leave it "
            "out, or mesh the body with solids"
        )
    for one in material.values() if isinstance(material, Mapping) else [material]:
        label = f"material {one.name!r}" if one.name else "material"
        if not isinstance(one, Material):
            raise InputError(f"reduce: {label} is orthotropic, and thermal= needs isotropic materials; leave it out")
        for name in THERMAL:
            if getattr(one, name) is None:
                raise InputError(
                    f"reduce: {label} has no {name}, which thermal= needs; give Material(..., conductivity=50.0, "
                    "heat_capacity=460.0, expansion=12e-6), of steel"
                )
    for name in wanted.temperatures:
        mesh.facets(name)
    held = np.zeros(len(mesh.points), dtype=bool)
    for name in wanted.fixed:
        held[mesh.facets(name).node_set] = True
    for name in contact:
        if held[mesh.facets(name).node_set].all():
            raise InputError(
                f"reduce: all nodes of contact {name!r} have a fixed temperature, no heat of a film would warm it; "
                "give the film that temperature, films.FilmTemperature(wall_a=...), or take convection"
            )


@dataclass(frozen=True, eq=False)
class HeatMatrices:
    """`conduction` [W/K] without convection and `capacity` [J/K], (n, n), and `load` (3 n, n) [N/K], A."""

    conduction: Sparse
    capacity: Sparse
    load: Sparse


def heat_matrices(mesh: Mesh, assignment: Assignment) -> HeatMatrices:
    """Of the cells of a mesh whose materials have thermal data."""
    n = len(mesh.points)
    K, C, A = sp.csr_matrix((n, n)), sp.csr_matrix((n, n)), sp.csr_matrix((3 * n, n))
    for kind, all_cells in mesh.cells.items():
        for i, material in enumerate(assignment.materials):
            assert isinstance(material, Material)  # `require_thermal_input`
            cells = all_cells[assignment.of_cell[kind] == i]
            k = cells.shape[1]
            chunk = max(1, CHUNK_BYTES // (8 * 3 * (3 * k) ** 2))
            for start in range(0, len(cells), chunk):
                part = cells[start : start + chunk]
                x = mesh.points[part]
                slopes, weight = physical_gradients(x, kind)
                conduction = np.einsum("eqai,eqbi,eq->eab", slopes, slopes, weight, optimize=True)
                K = K + scatter(_given(material, "conductivity") * conduction, part, n)
                C = C + scatter(scalar_mass(x, kind, material.density * _given(material, "heat_capacity")), part, n)
                load = _expansion_load(x, kind, material, slopes, weight)  # (e, k, 3, k)
                rows = np.broadcast_to((3 * part[:, :, None] + np.arange(3))[..., None], load.shape)
                columns = np.broadcast_to(part[:, None, None, :], load.shape)
                A = A + sp.coo_matrix((load.ravel(), (rows.ravel(), columns.ravel())), shape=(3 * n, n)).tocsr()
    return HeatMatrices(sp.csr_matrix(K), sp.csr_matrix(C), sp.csr_matrix(A))


def _expansion_load(x: Array, kind: str, material: Material, slopes: Array, weight: Array) -> Array:
    lam, mu = material.lame
    dilatation = projected_dilatation(x, kind) if is_mixed(kind, material) else slopes
    stress = _given(material, "expansion") * (2.0 * mu * slopes + 3.0 * lam * dilatation)
    return np.einsum("eqai,qb,eq->eaib", stress, rule(kind, STIFFNESS_DEGREE[kind]).values, weight, optimize=True)


def _given(material: Material, name: str) -> float:
    value = getattr(material, name)
    if value is None:
        raise ValueError(f"the material has no {name}; ask require_thermal_input first")
    return value


def flux_loads(surface: GeneralSurface) -> Sparse:
    """B (n, count) [m2] of all functions of the plan of a surface, csr."""
    f = surface.fields[0]
    entries = f.facets.loads(f.plan, f.kind, "normal")
    function = (entries.column % f.columns) * f.rows + entries.row
    return sp.csr_matrix((entries.area, (entries.node, function)), shape=(surface.nodes, f.count))


def reduce_thermal(
    mesh: Mesh,
    assignment: Assignment,
    wanted: BodyTemperature,
    contacts: Sequence[GeneralSurface],
    skin: Array,
    model: ElasticModel,
    system: InterfaceSystem,
    omega: Array,
    Phi: Array,
    stages: Progress,
) -> tuple[ReducedThermal, dict[str, Any]]:
    """The reduced temperature and expansion of a body with these contact surfaces, `skin` nodes (k,) and the
    constrained elastic `model` with its global modes; and facts for the report."""
    with stages.stage("heat conduction"):
        conduction = _Conduction.of(mesh, assignment, wanted)
        areas = [flux_loads(s) for s in contacts]
        B = [b[:, s.kept[0].numbers] for s, b in zip(contacts, areas, strict=True)]
        loads = [_smooth(s, b) for s, b in zip(contacts, B, strict=True)]
        background = conduction.background
        rates, modes = conduction.ritz(np.column_stack([*loads, conduction.capacity @ background]), wanted.modes)
    flux: Any = sp.csc_matrix(sp.hstack(B)) if B else sp.csc_matrix((len(mesh.points), 0))
    seen = _Observed(contacts, areas, skin, model, system, omega, Phi, conduction)
    parts = [seen(background), seen(modes)]
    inflow = np.asarray((flux.T @ modes).T)
    starts = list(range(0, flux.shape[1], BLOCK))
    for start in stages.track(starts, "thermal responses"):
        here = slice(start, start + BLOCK)
        fields = conduction.solve(flux[:, here].toarray()) - modes @ (inflow[:, here] / rates[:, None])
        parts.append(seen(fields))
    joined = {name: np.concatenate([part[name] for part in parts], axis=1) for name in parts[0]}
    names = [s.name for s in contacts]
    total = float(conduction.capacity.sum())
    reduced = ReducedThermal(
        surroundings=wanted.temperatures,
        reference=wanted.reference,
        capacity=total,
        rates=rates,
        inflow=inflow,
        carried=np.asarray(modes.T @ (conduction.capacity @ background)),
        grids={s.name: (s.columns, s.fields[0].rows) for s in contacts},
        mean=joined["mean"] / total,
        skin=joined["skin"].astype(np.float32),
        surfaces={name: joined[f"temperature/{name}"] for name in names},
        modal=joined["modal"],
        expansion={name: joined[f"expansion/{name}"] for name in names},
        skin_expansion=joined["skin_expansion"].astype(np.float32),
    )
    return reduced, {"modes": len(rates), "time_constant": reduced.time, "capacity": total}


class _Conduction:
    """K_T with convection, C and A of a body, `background` (n, b) theta_k, and solutions on the nodes of free
    temperature."""

    def __init__(self, K: Sparse, matrices: HeatMatrices, free: Array, points: Array) -> None:
        self.capacity, self.load, self.free, self.points = matrices.capacity, matrices.load, free, points
        self.K = K
        self.inside = sp.csr_matrix(K[free][:, free]), sp.csr_matrix(self.capacity[free][:, free])
        self.model = self._model(0.0)
        self.background = np.zeros((len(points), 0))

    @classmethod
    def of(cls, mesh: Mesh, assignment: Assignment, wanted: BodyTemperature) -> _Conduction:
        matrices, n = heat_matrices(mesh, assignment), len(mesh.points)
        K, held, sources = matrices.conduction, np.zeros(n, dtype=bool), []
        for name, (h, _) in wanted.convection.items():
            W = h * facet_mass(mesh, name)[0]
            K = K + W
            sources.append(np.asarray(W.sum(axis=1)).ravel())
        K = sp.csr_matrix(K)
        fields = []
        for name in wanted.fixed:
            here = np.setdiff1d(mesh.facets(name).node_set, np.flatnonzero(held))
            held[here] = True
            fields.append(np.isin(np.arange(n), here).astype(float))
        made = cls(K, matrices, np.flatnonzero(~held), mesh.points)
        columns = [made.solve(source[:, None]) for source in sources]
        columns += [made.solve(-(K @ field)[:, None]) + field[:, None] for field in fields]
        made.background = np.concatenate(columns, axis=1)
        return made

    def _model(self, shift: float) -> ElasticModel:
        K, C = self.inside
        return free_model(K + shift * C, C, np.zeros((len(self.free), 0)), coordinates=self.points[self.free])

    def solve(self, loads: Array, model: ElasticModel | None = None) -> Array:
        """Fields (n, m) under `loads` (n, m), zero on nodes of fixed temperature."""
        found = np.zeros(loads.shape)
        found[self.free] = (model or self.model).solve(loads[self.free])
        return found

    def ritz(self, loads: Array, count: int) -> tuple[Array, Array]:
        """Rates (r,) [1/s], ascending, and modes (n, r), see the module."""
        count = min(count, len(self.free))
        omega, V = vibration_modes(self.model, count=max(count, 1))
        slowest = float(omega[0] ** 2)
        at = [self.model, *(self._model(slowest * STEP ** (k + 1)) for k in range(RATES))]
        V = np.concatenate([V[:, :count], *(self.solve(loads, model)[self.free] for model in at)], axis=1)
        K, C = self.inside
        for _ in range(2):  # the second pass removes the round-off of the first
            V = V / np.sqrt(np.einsum("ij,ij->j", V, C @ V))
            size, Q = np.linalg.eigh(V.T @ (C @ V))
            kept = size > DEPENDENT * size[-1]
            V = V @ (Q[:, kept] / np.sqrt(size[kept]))
        rates, Q = np.linalg.eigh(V.T @ (K @ V))
        modes = np.zeros((len(self.points), len(rates)))
        modes[self.free] = V @ Q
        return rates, modes


def _smooth(surface: GeneralSurface, B: Sparse) -> Array:
    """Loads (n, 4) of smooth fluxes into a surface."""
    plan = surface.plan
    theta = plan.theta_start + plan.pitch * (surface.first + np.arange(surface.columns))
    flat = surface.shape.profile().planar
    around = [theta - theta.mean()] if flat else [np.cos(theta), np.sin(theta)]
    ones, z = np.ones(len(theta)), plan.z - plan.z.mean()
    fields = [np.outer(f, np.ones(len(z))) for f in (ones, *around)] + [np.outer(ones, z)]
    return np.column_stack([B @ field.ravel() for field in fields])


class _Observed:
    """What is kept of temperature fields (n, m)."""

    def __init__(
        self, contacts: Sequence[GeneralSurface], areas: Sequence[Sparse], skin: Array, model: ElasticModel,
        system: InterfaceSystem, omega: Array, Phi: Array, conduction: _Conduction,
    ) -> None:  # fmt: skip
        self.contacts, self.areas, self.skin = contacts, areas, skin
        self.model, self.system, self.omega, self.Phi = model, system, omega, Phi
        self.capacity, self.load = conduction.capacity, conduction.load
        self.normal = [s.fields[0].loads(s.nodes) for s in contacts]
        shape = system.T @ Phi
        self.mode_normal = [s.kept[0].without_gram(B.T @ shape) for s, B in zip(contacts, self.normal, strict=True)]

    def __call__(self, fields: Array) -> dict[str, Array]:
        T = self.system.T
        f = np.asarray(T.T @ (self.load @ fields))
        modal = self.Phi.T @ f
        q = modal / self.omega[:, None] ** 2
        u = self.model.flexibility(f)
        whole, local = np.asarray(T @ u), np.asarray(T @ (u - self.Phi @ q))
        found = {
            "mean": np.asarray(self.capacity.sum(axis=0)).reshape(1, -1) @ fields,
            "skin": fields[self.skin],
            "modal": modal,
            "skin_expansion": local.reshape(-1, 3, local.shape[1])[self.skin].reshape(-1, local.shape[1]),
        }
        for i, s in enumerate(self.contacts):
            found[f"temperature/{s.name}"] = _coefficients(s, self.areas[i].T @ fields)
            # in addition to the global modes as the surface has them
            found[f"expansion/{s.name}"] = _coefficients(s, self.normal[i].T @ whole) - self.mode_normal[i] @ q
        return found


def _coefficients(surface: GeneralSurface, values: Array) -> Array:
    """Nodal coefficients (kept, m) of the field with these integrals (count, m): among all functions of the plan, since
    those kept vanish at the edges of an arc, where temperatures do not."""
    return surface.fields[0].without_gram(np.asarray(values))[surface.kept[0].numbers]
