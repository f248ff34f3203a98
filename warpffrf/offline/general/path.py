r"""The general path: any mesh, one sparse factorisation, blocks of right-hand sides.

The constrained model (rigid interfaces eliminated) is factorised once with as many dofs fixed as there are rigid modes;
the same factors serve vibration modes, attachment modes and the static responses `u_i = G B psi_i` of all unit loads.
Stored are `C = (B psi)^T u` and the observed values of `u`, the skin first, both without the part of the global modes;
`D = M^-1 C M^-1` is dense. Finished parts are written to a work file, from which an interrupted run is resumed.
"""

from __future__ import annotations

import json
from collections.abc import Collection, Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import scipy.sparse as sp

from warpffrf.model.errors import InputError
from warpffrf.model.mesh import Mesh
from warpffrf.model.mesh.facets import triangles
from warpffrf.model.surfaces import Matched
from warpffrf.model.thermal import BodyTemperature
from warpffrf.offline.bases import Basis
from warpffrf.offline.bases.build import GlobalBasis, build_basis
from warpffrf.offline.elastic import Array, ElasticModel, free_model
from warpffrf.offline.fe import Assignment
from warpffrf.offline.general.checkpoint import Checkpoint
from warpffrf.offline.general.observers import SKIN, Observer, node_observer, require_observers, widened
from warpffrf.offline.general.unit_loads import (
    GeneralSurface,
    ResponseSolver,
    UnitLoads,
    cross_compliance,
    results_bytes,
)
from warpffrf.offline.inertia.invariants import (
    Prestress,
    covered_modes,
    covering_turning,
    left_out,
    prestress_stiffness,
    turning_response,
)
from warpffrf.offline.inertia.membrane import MEMBRANE, membrane_terms
from warpffrf.offline.inertia.second_order import lifted_stiffness
from warpffrf.offline.interfaces import BodyInterface, InterfaceSystem, rigid_links
from warpffrf.offline.products import Limits, MembraneTerms, PathProduct, mass_properties
from warpffrf.offline.progress import Progress
from warpffrf.offline.quality import sampled_residual
from warpffrf.offline.small_sliding.compliance import MatchedFaces
from warpffrf.offline.structure.assembly import beam_surface, body_matrices, rigid_motions
from warpffrf.offline.thermal import reduce_thermal

DEFAULT_MEMORY = 8 << 30  # bytes


def reduce_general(
    mesh: Mesh,
    assignment: Assignment,
    interfaces: Sequence[BodyInterface],
    surfaces: Sequence[tuple[str, object]],
    options: Basis,
    limits: Limits,
    spacing: Mapping[str, float | None],
    memory_limit: int | None,
    progress: Progress,
    *,
    traction: str = "nodes",
    tangential: str | None = None,
    observers: Sequence[Observer] = (),
    sloping: Collection[str] = (),
    local_dynamics: bool = False,
    inertia_modes: int | None = None,
    stiffening: bool | str = False,
    membrane_modes: int | None = None,
    centrifugal: bool = False,
    matched: Mapping[str, Matched] | None = None,
    solver: str | None = None,
    checkpoint: Checkpoint | None = None,
    thermal: BodyTemperature | None = None,
) -> PathProduct:
    """Reduce any mesh; `surfaces` are name and resolved shape. See the module docstring.

    `spacing` of the contact grid by surface [m] (None: the mesh's own); `options`: the basis of the global modes;
    `traction`, `tangential`: kind of the functions of normal and of tangential tractions ("nodes", "cells"; None: no
    tangential ones); `observers`: observed quantities of modes and responses in addition to the skin;
    `sloping`: surfaces for which the compliance of slopes is stored; `local_dynamics`: also compute the mass of the
    normal local modes; `inertia_modes`: number of modes with inertia terms (None: `invariants.MODES`); `stiffening`:
    also their geometric stiffness, "membrane": and the membrane energy of the first `membrane_modes` (None:
    `membrane.MODES`); `centrifugal`: also attachment modes of rotation; `matched`: joint faces with cells, by name;
    `solver`: a name in `solvers.SOLVERS`, None: the default; `checkpoint`: work file of finished parts, whose context
    is entered by the caller; `thermal`: also temperature and expansion. Raises `InputError` for a memory limit that is
    too small, a model that can move without deforming, a solver that is not installed.
    """
    # contact grids and observers; results that exceed the memory limit are refused first
    checkpoint = checkpoint or Checkpoint()
    limit = DEFAULT_MEMORY if memory_limit is None else memory_limit
    with progress.stage("contact grids"):
        contacts = [
            GeneralSurface(mesh, n, shape, spacing.get(n), traction, tangential, n in sloping) for n, shape in surfaces
        ]
    faces = mesh.outer_facets()
    skin = faces.node_set
    drawn, drawn_triangles, drawn_motion = beam_surface(mesh)
    seen = [node_observer(SKIN, skin, len(mesh.points)), *observers]
    seen += [observer for s in contacts if (observer := s.observer()) is not None]
    rotating = mesh.structure.rotating
    require_observers(seen, len(mesh.points), len(rotating))
    seen = [widened(o, 3 * (len(mesh.points) + len(rotating))) for o in seen]
    if len(drawn):
        seen[0] = Observer(SKIN, sp.csr_matrix(sp.vstack([seen[0].operator, drawn_motion], format="csr")))
    massed = [s.fields[0].count if local_dynamics else 0 for s in contacts]
    _check_results([s.count for s in contacts], seen, massed, limit)
    wanted_faces, beside_matched = None, []
    if matched:
        with progress.stage("cells of matched faces"):
            wanted_faces = MatchedFaces.of(mesh, matched)
            moved = [o for o in observers if o.operator.shape[1] == 3 * len(mesh.points)]
            beside_matched = wanted_faces.observers(node_observer(SKIN, skin, len(mesh.points)), moved)
            wanted_faces.require_room(beside_matched, limit)

    # constrained model: K and M of the nodes, rigid interfaces eliminated by T, one factorisation
    with progress.stage("assembly"):
        body = body_matrices(mesh, assignment)
        K, M = body.K, body.M
    middle = mesh.points.mean(axis=0)
    R = rigid_motions(mesh.points, body.rotating, middle)
    mass, center, inertia = mass_properties(R.T @ (M @ R), middle)
    system = InterfaceSystem(mesh.points, interfaces, rigid_links(mesh, interfaces), body.rotating)
    T, whole = system.T, system.whole
    with progress.stage("factorisation"):
        nodal_stiffness, nodal_mass = K, M
        K, M = sp.csr_matrix(whole.T @ K @ whole), sp.csr_matrix(whole.T @ M @ whole)
        places = system.coordinates
        model = free_model(K, M, system.rigid(middle), system.pinned, places, solver=solver, memory_limit=limit)
    factor = model.factor
    facts: dict[str, Any] = {"backward_error": model.backward_error}
    if factor is not None:
        facts |= {"solver": factor.name, "factor_entries": factor.fill, "factor_bytes": factor.bytes}
        watched = [(o.name, o.rows, o.dtype.str) for o in seen]
        checkpoint.begin({"solver": factor.name, "observers": watched, "massed": massed})

    # global modes, and the inertia terms of the lowest `kept` of them
    with progress.stage("global modes"):
        turning = np.asarray(whole.T @ body.rotation_load(mesh.points, center))
        basis = _global_modes(options, model, system, limits, turning if centrifugal else None, mesh, checkpoint)
        omega, Phi = basis.omega, basis.Phi
    with progress.stage("inertia terms"):
        turned = turning_response(model, turning, omega, Phi)
        kept = covered_modes(omega, inertia_modes)

        def lacking(limit: float) -> float:
            return left_out(turned.beyond(limit), inertia)

        if centrifugal and inertia_modes is None:
            kept = covering_turning(omega, kept, lacking)
        facts["centrifugal_left_out"] = lacking(float(omega[kept - 1]) if kept else 0.0)
        U = T @ Phi[:, :kept]
        terms = body.inertia_terms(whole @ Phi[:, :kept], mesh.points, center)
    # geometric stiffness of these modes, and their membrane energy
    membrane: MembraneTerms | None = None
    if stiffening:
        with progress.stage("geometric stiffness"):
            prestress = Prestress.of(model, system, nodal_mass, center)
            by_load = prestress_stiffness(mesh.points, mesh.cells, assignment, prestress.static, U)
        if stiffening == MEMBRANE:
            with progress.stage("membrane energy"):
                turns = system.rotations(Phi[:, :kept])
                by_load += lifted_stiffness(prestress, model, system, nodal_stiffness, nodal_mass, turns, kept)
                membrane = membrane_terms(
                    mesh, assignment, model, system, nodal_mass, U, omega[:kept], membrane_modes, turns,
                    memory_limit=limit,
                )  # fmt: skip
                facts["membrane"] = membrane.facts
        stiffness = prestress.by_load(by_load)
        if membrane is not None:
            stiffness = replace(stiffness, membrane=membrane.forms, motion=membrane.second_order)
        terms = replace(terms, stiffening=stiffness)
    del nodal_stiffness, nodal_mass, U

    # unit loads of all contact surfaces, the accuracy of their responses, and the residual compliances
    with progress.stage("unit loads"):
        B = [s.loads() for s in contacts]
        loads = [UnitLoads(s.name, sp.csc_matrix(T.T @ b), n) for s, b, n in zip(contacts, B, massed, strict=True)]
    with progress.stage("residuals"):
        tested = [*(u.loads for u in loads), system.loads, turning]
        tested += [] if wanted_faces is None else [sp.csc_matrix(T.T @ wanted_faces.loads())]
        facts["worst_load_residual"] = max((sampled_residual(model, F) for F in tested), default=0.0)
    responses = ResponseSolver(model, omega, Phi, whole, loads, seen, limit) if loads else None
    products = []
    cross = []
    shape = T @ Phi
    for i, s in enumerate(contacts):
        if responses is not None:
            found = responses.responses(i, progress, checkpoint)
            transfers = {o.name: t for o, t in zip(seen, found.transfers, strict=True)}
            with progress.stage(f"operators of {s.name}"):
                product = s.product(found.compliance, transfers, B[i].T @ shape, omega)
                product.local_mass = s.local_mass(found.mass, found.overlap) if local_dynamics else None
                products.append(product)
                cross += [cross_compliance(t, s, C) for t, C in zip(contacts[:i], found.cross, strict=True)]

    matched_product = None
    if wanted_faces is not None:
        matched_product = wanted_faces.product(model, omega, Phi, T, beside_matched, limit, progress, checkpoint)
    warm = None
    if thermal is not None:
        warm, facts["thermal"] = reduce_thermal(
            mesh, assignment, thermal, contacts, skin, model, system, omega, Phi, progress
        )
    if responses is not None:
        facts |= {"block": responses.width, "threads": responses.workers}
    shape = whole @ Phi
    modes = {o.name: o.operator @ shape for o in seen[: 1 + len(observers)]}
    points = np.concatenate([mesh.points[skin], drawn])
    bent = None if membrane is None else (seen[0].operator @ membrane.shapes).T.reshape(-1, len(skin), 3)
    return PathProduct(
        mass=mass,
        center=center,
        inertia=inertia,
        omega=omega,
        interfaces=system.products(Phi),
        surfaces=products,
        skin_points=points,
        skin_triangles=np.concatenate([np.searchsorted(skin, triangles(faces)), len(skin) + drawn_triangles]),
        skin_modes=modes[SKIN].T.reshape(len(omega), len(points), 3).astype(np.float32),
        facts={**basis.facts, **facts},
        observed_modes=modes,
        inertia_terms=terms,
        cross=cross,
        matched=matched_product,
        membrane=membrane,
        thermal=warm,
        skin_second_order=None if bent is None else bent.astype(np.float32),
    )


def _global_modes(
    options: Basis,
    model: ElasticModel,
    system: InterfaceSystem,
    limits: Limits,
    turning: Array | None,
    mesh: Mesh,
    checkpoint: Checkpoint,
) -> GlobalBasis:
    """The global modes: from the work file, or computed."""
    if (known := checkpoint.get("global modes")) is not None:
        return GlobalBasis(known["omega"], known["Phi"], json.loads(str(known["facts"])))
    basis = build_basis(options, model, system, limits, turning, mesh)
    # as read from a work file: the same products, bit for bit
    basis = GlobalBasis(basis.omega, np.ascontiguousarray(basis.Phi), basis.facts)
    arrays = {"omega": basis.omega, "Phi": basis.Phi, "facts": np.array(json.dumps(basis.facts))}
    checkpoint.put("global modes", arrays)
    return basis


def _check_results(counts: list[int], observers: list[Observer], massed: list[int], limit: int) -> None:
    """Refuse results that do not fit before the computation begins."""
    needed = results_bytes(counts, observers, massed)
    if needed > limit:
        raise InputError(
            f"the dense compliance of {sum(counts)} functions of contact grids needs {needed / 2**30:.3g} GiB, "
            f"memory_limit is {limit / 2**30:.3g} GiB; raise memory_limit or the spacing of the grids, or use a "
            "rotationally periodic mesh"
        )
