r"""The general path: any mesh, one sparse factorisation, blocks of right-hand sides.

The constrained model (rigid interfaces slaved) is factorised once with as many dofs held as there are rigid modes;
the same factors serve vibration modes, attachment modes and the static responses `u_i = G B psi_i` of all hats. Of
these only what is needed is kept: `C = (B psi)^T u`, the skin's part of `u`, both freed from the global modes; `D =
M^-1 C M^-1` is dense.
"""

from __future__ import annotations

import numpy as np
import scipy.sparse as sp

from warpffrf.model.errors import InputError
from warpffrf.model.mesh import Mesh
from warpffrf.model.mesh.facets import triangles
from warpffrf.model.reduced_body import ContactGrid, Recovery, axial_gram
from warpffrf.offline.assembly import fe_matrices, rigid_modes
from warpffrf.offline.contact_grid import GridPlan, facet_chart, nodal_plan, spaced_plan
from warpffrf.offline.elastic import Array, free_model
from warpffrf.offline.global_basis import attachment_modes, deflated, global_basis
from warpffrf.offline.hat_loads import hat_loads
from warpffrf.offline.independence import window_columns
from warpffrf.offline.interfaces import RigidInterface, constraint
from warpffrf.offline.materials import Assignment
from warpffrf.offline.modes import vibration_modes, whole_multiples
from warpffrf.offline.products import Limits, PathProduct, SurfaceProduct, mass_properties
from warpffrf.offline.progress import Progress

BLOCK = 64  # right-hand sides solved together; larger blocks gain little, single ones cost six times more a side
# arrays of the size of a block alive at once: load, projected load, permuted, solution, residual, response
BLOCK_COPIES = 6
COVERED = 0.02  # a hat counts as inside the facets when its area is covered to this: the error of a kinked quadrature
DEFAULT_MEMORY = 4 << 30  # bytes


def reduce_general(
    mesh: Mesh,
    assignment: Assignment,
    interfaces: list[RigidInterface],
    surfaces: list[tuple[str, object]],
    limits: Limits,
    spacing: float | None,
    memory_limit: int | None,
    progress: Progress,
) -> PathProduct:
    """Reduce any mesh; `surfaces` are name and resolved shape. See the module docstring."""
    contacts = [_Surface(mesh, name, shape, spacing) for name, shape in surfaces]
    faces = mesh.outer_facets()
    skin = faces.node_set
    skin_dofs = (3 * skin[:, None] + np.arange(3)).ravel()
    limit = DEFAULT_MEMORY if memory_limit is None else memory_limit
    _check_memory(contacts, len(skin_dofs), limit)

    K, M = fe_matrices(mesh, assignment)
    middle = mesh.points.mean(axis=0)
    R = rigid_modes(mesh.points, middle)
    mass, center, inertia = mass_properties(R.T @ (M @ R), middle)
    T, free = constraint(mesh.points, interfaces)
    size = T.shape[1]
    first = 3 * len(free)
    coordinates = np.full((size, 3), np.nan)
    coordinates[:first] = np.repeat(mesh.points[free], 3, axis=0)
    rigid = [R[(3 * free[:, None] + np.arange(3)).ravel()]]
    for interface in interfaces:  # translation of its point, and the rotation itself
        rigid.append(np.concatenate([rigid_modes(interface.point[None], middle), np.eye(3, 6, 3)]))
    pinned = first + np.arange(6) if interfaces else None
    with progress.stage("factorisation"):
        model = free_model(
            sp.csr_matrix(T.T @ K @ T), sp.csr_matrix(T.T @ M @ T), np.concatenate(rigid), pinned, coordinates
        )

    with progress.stage("vibration modes"):
        # more, to see whether a pair would be split
        wanted = limits.count if limits.count is None else limits.count + 4
        omega, V = vibration_modes(model, count=wanted, omega_max=limits.omega_max)
        notes = []
        if limits.count is not None:
            kept = whole_multiples(omega, limits.count)
            if kept > limits.count:
                notes = [f"modes={limits.count} would split a pair of equal frequencies: {kept} are kept"]
            V = V[:, :kept]
        F = np.zeros((size, 6 * len(interfaces)))
        F[first:] = np.eye(6 * len(interfaces))
        omega, Phi, dropped = global_basis(model, V, attachment_modes(model, F))

    products = []
    shape = T @ Phi
    width = int(np.clip(limit // (8 * BLOCK_COPIES * 3 * len(mesh.points)), 1, BLOCK))
    TS = sp.csr_matrix(T[skin_dofs])
    for s in contacts:
        loads = sp.csc_matrix(T.T @ s.B)
        hats = s.hats
        C = np.zeros((hats, hats))
        transfer = np.zeros((len(skin_dofs), hats), dtype=np.float32)
        for start in progress.track(range(0, hats, width), f"static responses of {s.name}"):
            part = slice(start, start + width)
            f = loads[:, part].toarray()
            response, _ = deflated(model.flexibility(f), f, omega, Phi)
            C[:, part] = loads.T @ response
            transfer[:, part] = TS @ response
        products.append(s.product(0.5 * (C + C.T), transfer, s.B.T @ shape, omega))

    return PathProduct(
        mass=mass,
        center=center,
        inertia=inertia,
        omega=omega,
        interface_modes=[Phi[first + 6 * j : first + 6 * j + 6].T.copy() for j in range(len(interfaces))],
        surfaces=products,
        skin_points=mesh.points[skin],
        skin_triangles=np.searchsorted(skin, triangles(faces)),
        skin_modes=shape[skin_dofs].T.reshape(len(omega), -1, 3).astype(np.float32),
        facts={"dependent_directions_dropped": dropped, "notes": notes, "block": width},
    )


def _check_memory(contacts: list[_Surface], skin_dofs: int, limit: int) -> None:
    hats = [s.hats for s in contacts]
    # C, D and a working copy; display transfer in float32
    needed = sum(8 * 3 * n * n + 4 * n * skin_dofs for n in hats)
    if needed > limit:
        raise InputError(
            f"the dense compliance of {sum(hats)} hats needs {needed / 2**30:.3g} GiB, memory_limit is "
            f"{limit / 2**30:.3g} GiB; raise memory_limit or traction_spacing, or use a rotationally periodic mesh"
        )


class _Surface:
    """Grid and loads of one contact surface; `B` (3 n, hats) over the whole rectangle of the plan."""

    def __init__(self, mesh: Mesh, name: str, shape, spacing: float | None) -> None:
        self.name, self.shape = name, shape
        kind, nodes = mesh.facets(name).single
        chart = facet_chart(mesh.points, kind, nodes, shape)
        plan = nodal_plan(chart, name) if spacing is None and kind.startswith("quad") else None
        if plan is None:
            plan = spaced_plan(chart, shape, name, chart.edge if spacing is None else spacing)
        self.plan: GridPlan = plan
        self.edge = chart.edge
        rows = len(plan.z)
        self.hats = plan.columns * rows
        loads = hat_loads(kind, nodes, chart, shape, plan)
        hat = (loads.column % plan.columns) * rows + loads.row
        dofs = (3 * loads.node[:, None] + np.arange(3)).ravel()
        self.B = sp.csr_matrix(
            (loads.value.ravel(), (dofs, np.repeat(hat, 3))), shape=(3 * len(mesh.points), self.hats)
        )
        self.gram_z = axial_gram(shape, plan.z)
        full = ContactGrid(
            np.asarray(shape.e_0, float),
            plan.theta_start,
            plan.pitch,
            plan.columns,
            plan.periodic,
            plan.z,
            plan.columns,
        )
        gram = full.gram_theta()
        if not plan.periodic:  # the hats on the edges of the arc are half hats
            gram[0, 0] = gram[-1, -1] = plan.pitch / 3.0
        self.gram_theta = gram
        area = np.bincount(hat, weights=loads.area, minlength=self.hats)
        self.grid, self.first = self._grid(full, area.reshape(plan.columns, rows))

    def _grid(self, full: ContactGrid, area: Array) -> tuple[ContactGrid, int]:
        """The columns whose hats lie inside the facets, and the first of them. Raises `InputError` where there are
        holes."""
        expected = np.outer(self.gram_theta.sum(axis=1), self.gram_z.sum(axis=1))
        covered = np.all(np.abs(area / expected - 1.0) < COVERED, axis=1)
        if self.plan.periodic:
            if not covered.all():
                raise InputError(self._holes(int(np.sum(~covered))))
            return full, 0
        inside = covered.copy()
        inside[[0, -1]] = False
        kept = np.flatnonzero(inside)
        if not len(kept) or len(kept) != kept[-1] - kept[0] + 1:
            raise InputError(self._holes(int(np.sum(~inside))))
        grid = ContactGrid(
            full.e_0,
            full.theta_start + full.pitch * kept[0],
            full.pitch,
            len(kept),
            False,
            full.z,
            len(kept),
        )
        return grid, int(kept[0])

    def _holes(self, columns: int) -> str:
        return (
            f"contact {self.name!r}: the facets leave part of {columns} of {self.plan.columns} grid columns uncovered; "
            "choose facets that cover the surface between two angles over its whole width"
        )

    def _without_gram(self, values: Array) -> Array:
        """M^-1 values (hats, m), with M = M_theta (x) M_z."""
        columns, rows = self.plan.columns, len(self.plan.z)
        around = np.linalg.solve(self.gram_theta, values.reshape(columns, -1)).reshape(columns, rows, -1)
        return np.linalg.solve(self.gram_z, around).reshape(columns * rows, -1)

    def product(self, C: Array, transfer: Array, loads_on_modes: Array, omega: Array) -> SurfaceProduct:
        """D and its companions, restricted to the columns of the grid."""
        rows = len(self.plan.z)
        kept = slice(self.first * rows, (self.first + self.grid.columns) * rows)
        D = self._without_gram(self._without_gram(C).T)
        D = 0.5 * (D + D.T)[kept, kept]
        normal = self._without_gram(loads_on_modes)[kept]
        display = self._without_gram(transfer.T.astype(np.float64)).T[:, kept].astype(np.float32)
        judged = slice(kept.start, kept.start + window_columns(self.grid.columns, rows) * rows)
        on_modes = loads_on_modes[judged] / omega
        return SurfaceProduct(
            grid=self.grid,
            lags=np.ascontiguousarray(D)[None],
            mode_normal=normal,
            recovery=Recovery(display[None], 1, np.eye(3)),
            window=C[judged, judged] + on_modes @ on_modes.T,
            residual_window=C[judged, judged],
        )
