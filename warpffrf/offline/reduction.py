"""`reduce`: computes a `ReducedBody` from a mesh, a material, interfaces and contact surfaces."""

from __future__ import annotations

import logging
import time
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import asdict, dataclass, replace
from typing import Any

import numpy as np

import warpffrf.offline.cache as body_cache
from warpffrf.model.arguments import Matrix
from warpffrf.model.checks.plausibility import warn
from warpffrf.model.errors import InputError
from warpffrf.model.material import SolidMaterial
from warpffrf.model.mesh import Mesh
from warpffrf.model.mesh.periodicity import detect
from warpffrf.model.mesh.report import refuse_wrong_units
from warpffrf.model.messages.named_arguments import named_arguments
from warpffrf.model.messages.progress import speaking
from warpffrf.model.reduced.body import ReducedBody, library_versions
from warpffrf.model.reduced.contact_surface import ContactSurface
from warpffrf.model.reduced.data import DisplaySurface
from warpffrf.model.reduced.stress_field import StressPoints
from warpffrf.model.surfaces import Matched, Shape
from warpffrf.model.thermal import BodyTemperature
from warpffrf.offline.bases import Basis
from warpffrf.offline.contact.contact_choice import (
    depth_ratio,
    depth_warning,
    expected_grids,
    layer_depth,
    node_spacing,
    promised,
    spacings,
    wall,
)
from warpffrf.offline.contact.contact_grid import GridChoice, largest_radius
from warpffrf.offline.contact.cubature import choose_sampling
from warpffrf.offline.contact.local_mass import INDEPENDENCE, check_compliance, eigenvalue_ratio, held_nodes, may_slope
from warpffrf.offline.contact.mesh_error import axial_error, axial_warning, line_mesh_error, mesh_error_warning
from warpffrf.offline.contact.node_loads import ContactFacets
from warpffrf.offline.cyclic.path import axes_of, reduce_cyclic
from warpffrf.offline.fe import Assignment, assign, facet_material, formulation_notes, other_material, require_isotropic
from warpffrf.offline.general.checkpoint import Checkpoint
from warpffrf.offline.general.observers import SKIN
from warpffrf.offline.general.path import reduce_general
from warpffrf.offline.inertia.invariants import MODES
from warpffrf.offline.inertia.membrane import membrane_notes
from warpffrf.offline.interfaces import body_interfaces
from warpffrf.offline.near_field.far import find_far_field, is_coarse
from warpffrf.offline.options import ContactGrid, ReductionOptions
from warpffrf.offline.products import PathChoice, PathProduct, SurfaceProduct, choose_path, resolve_shapes
from warpffrf.offline.progress import Progress
from warpffrf.offline.quality import coupling, quality
from warpffrf.offline.settings import Settings, input_doubts, too_low
from warpffrf.offline.stress.fields import StressRecovery
from warpffrf.offline.stress.plan import stress_plans

logger = logging.getLogger("warpffrf.offline")
LIBRARIES = ("warpffrf", "numpy", "scipy", "scikit-fem")
# For thousands of small dense systems, BLAS threads only add overhead: the vibration modes of a roller with 302,400
# dofs took 0.09 s with one thread and 0.52 s with two. Threads run over harmonics, subtrees and blocks instead.
BLAS_THREADS = 1
SPACING_NOTED = 0.1  # relative to the requested spacing: larger differences are noted in the report


@named_arguments
def reduce(
    mesh: Mesh,
    material: SolidMaterial | Mapping[str, SolidMaterial] | None = None,
    *,
    interfaces: Mapping[str, str] | None = None,
    contact: Mapping[str, Shape | Matched | None] | None = None,
    basis: str | Basis = "free_free",
    max_frequency: float | None = None,
    modes: int | None = None,
    stress: Mapping[str, str | Matrix | StressPoints] | None = None,
    grid: ContactGrid = ContactGrid(),  # noqa: B008 (immutable)
    options: ReductionOptions = ReductionOptions(),  # noqa: B008
    thermal: BodyTemperature | None = None,
    cache: bool = True,
    progress: bool = True,
) -> ReducedBody:
    """Reduce a finite-element body to global modes and residual local modes.

    Parameters
    ----------
    mesh: the body; its frame is the body's user frame.
    material: one material, or {cell set: Material} that covers every cell once (`mesh.materials` if they were read from
        a file), isotropic or `Material.orthotropic`. Not required for a mesh made of matrices.
    interfaces: {facet set: kind}. "rigid": the nodes move as one rigid body (RBE2); "average": the interface is the
        mean motion of nodes that deform freely (RBE3); "free": every node keeps its own displacement.
    contact: {facet set: shape}: a `warpffrf.surfaces` shape, None to fit a cylinder or crowned cylinder, or
        `surfaces.Matched(...)` for small-sliding contact (joint interfaces), on the general path.
    basis: source of the global modes: a name or options object of `warpffrf.bases`. "free_free": vibration modes of the
        free body and inertia-relief attachment modes of the interfaces.
    max_frequency [Hz], modes: for "free_free", vibration modes up to this frequency, or this number of modes, or the
        fewer of the two if both are given; if neither is given, attachment modes only. Pairs of equal frequencies are
        never split (see `report["notes"]`). The other bases define the meaning of both arguments.
    stress: {name: points} at which stresses can be recovered (`Result.stress`): points (p, 3) [m], the name of a
        facet set, "skin", "all", or `StressPoints` for one side of an interface between materials.
    grid: the grid of tractions on the contact surfaces: its spacing, or the half-width of the contact patches expected;
        functions of normal and tangential tractions; data for a contact-fixed grid and for reduced quadrature.
    options: settings that are rarely needed: inertia terms, stiffening, solver, memory.
    thermal: also the temperature of the body and its thermal expansion, `films.BodyTemperature(...)`; the material then
        requires conductivity, heat_capacity and expansion. On the general path.
    cache: look the result up in the user's cache and store it there. An interrupted reduction leaves a work file in
        the cache and is resumed by the next call.
    progress: report progress on stderr: bars on a terminal, lines elsewhere. Warnings are issued in any case.

    The static response to every load in the span of the traction functions and on the interfaces is exact for any
    number of modes. A rotationally periodic mesh is reduced harmonic by harmonic, any other mesh by one factorisation;
    `report["path"]` states which, and why. `report["quality"]` contains the quality measures of the body. Conditions
    that make a result doubtful, such as cells too deep for the contact grid, are added to `report["warnings"]` and
    logged. Raises `InputError` for invalid settings, unknown sets, facets that do not fit their shape, a contact grid
    finer than the mesh, a material in wrong units, and a memory limit too small for one unit load.

    With `mesh` and `steel` as in `mesh.roller` and `Material`:

    >>> roller = wf.reduce(
    ...     mesh, steel, interfaces={"bore": "rigid"}, contact={"rim": wf.surfaces.Cylinder()}, modes=6, progress=False
    ... )
    >>> round(roller.mass, 4)  # kg
    0.0739
    >>> list(roller.interfaces), list(roller.contact_surfaces)
    (['bore'], ['rim'])
    """
    start = time.perf_counter()
    if not isinstance(mesh, Mesh):
        raise InputError(f"reduce: a mesh is needed, from mesh.roller, mesh.read or mesh.from_matrices, got {mesh!r}")
    settings = Settings.of(
        material=material,
        interfaces=interfaces,
        contact=contact,
        basis=basis,
        max_frequency=max_frequency,
        modes=modes,
        stress=stress,
        grid=grid,
        options=options,
        thermal=thermal,
    )
    settings.check_against(mesh)
    assignment = assign(mesh, material)
    for name in settings.contact:
        require_isotropic(mesh, name, assignment)
    refuse_wrong_units(material)
    described = settings.describe(mesh)
    key = body_cache.cache_key(described)
    name = f"'{mesh.name}'" if mesh.name else "a body"
    with speaking(progress):
        if cache and (body := body_cache.load_cached(key)) is not None:
            body.report["cached"] = True
            body.report["seconds_cached"] = time.perf_counter() - start
            logger.info("reduce: %s is in the cache, read in %.2f s", name, body.report["seconds_cached"])
            warn(body.report["warnings"])
            return body
        count = len(settings.contact)
        faces = f"{count} contact surface{'' if count == 1 else 's'}"
        logger.info("reduce: %s, %d nodes, %s", name, len(mesh.points), faces)
        doubts = input_doubts(mesh, settings)
        warn(doubts)  # before the computation begins
        with one_thread(), Checkpoint(body_cache.work_file(key) if cache else None) as checkpoint:
            body = _reduced(mesh, settings, checkpoint, Progress(progress))
            body.provenance.update(settings=described, key=key, versions=library_versions(LIBRARIES))
            body.provenance["content_hash"] = body.content_hash()
            body.report["seconds"] = time.perf_counter() - start
            warn(body.report["warnings"])
            body.report["warnings"] = doubts + body.report["warnings"]
            if cache and (fault := body_cache.store(key, body)):
                body.report["warnings"].append(fault)
        logger.info("reduce: %s done in %.2f s, %d modes", name, body.report["seconds"], len(body.frequencies))
    return body


def _reduced(given: Mesh, settings: Settings, checkpoint: Checkpoint, stages: Progress) -> ReducedBody:
    """The reduction itself; `given` is the user's mesh."""
    # mesh, materials, shapes and interfaces; choice of the cyclic or the general path
    with stages.stage("mesh check"):
        given.check()
        mesh, found = _periodic(given, settings)
    assignment = assign(mesh, settings.material)
    shapes = resolve_shapes(mesh, settings.contact)
    joints = body_interfaces(mesh, settings.interfaces)
    choice = choose_path(mesh, list(settings.interfaces), shapes, assignment, settings.general_reason or found.reason)
    cyclic = choice.patterns is not None
    with stages.stage("stress points"):
        plans = stress_plans(mesh, assignment, settings.stress, choice.shapes)
        recovery = StressRecovery(plans, axes_of(mesh) if cyclic else None)
    expected = expected_grids(mesh, choice.shapes, settings)
    product = _product(mesh, assignment, settings, joints, choice, expected, recovery, checkpoint, stages)

    # report of the path
    report = _report(product, choice, given, settings, stages)
    formulations, locking = formulation_notes(assignment, bool(settings.stress))
    report["notes"] += formulations
    report["warnings"] += locking
    report["notes"] += _not_used(settings, cyclic)
    if (stiffening := settings.options.stiffening) and given.cyclic is not None:
        report["notes"].append(f"stiffening={stiffening!r}: the periodic body was reduced on the general path")
    if settings.thermal is not None and given.cyclic is not None:
        report["notes"].append("thermal=: the periodic body was reduced on the general path")
    if membrane := product.facts.get("membrane"):
        notes, warnings = membrane_notes(membrane, mesh)
        report["notes"] += notes
        report["warnings"] += warnings
    report["notes"] += [*found.notes, *(note for plan in plans for note in plan.notes)]
    # contact surfaces with their assessment, sampling points and far fields
    surfaces: dict[str, ContactSurface] = {}
    for (name, shape), s in zip(choice.shapes.items(), product.surfaces, strict=True):
        report["contact"][name], warnings = _judged(mesh, name, shape, s, settings)
        report["warnings"] += warnings
        report["notes"] += _other_spacing(name, shape, s, settings)
        if name in expected:
            kept = promised(expected[name], s.grid, shape, mesh)
            report["contact"][name]["expected"] = kept.facts()
            too_coarse = kept.warning(name)
        else:
            too_coarse = None if warnings else mesh_error_warning(name, report["contact"][name]["line_mesh_error"])
        surfaces[name] = ContactSurface(
            name,
            shape,
            s.grid,
            s.lags,
            np.ascontiguousarray(s.mode_normal),
            s.recovery,
            s.tangential,
            s.local_mass,
            slope_lags=s.slope_lags,
        )
        if settings.grid.sampling_error is not None:
            with stages.stage("sampling points"):
                points = choose_sampling(surfaces[name], settings.grid.sampling_error, label=name)
            surfaces[name] = replace(surfaces[name], sampling=points)
            report["contact"][name]["sampling"] = {"points": points.count, **points.facts()}
            report["stage_seconds"] = dict(stages.seconds)
        surfaces[name] = _with_far_field(surfaces[name], mesh, assignment, settings, checkpoint, stages, report)
        if too_coarse and surfaces[name].far is None:
            report["warnings"].append(too_coarse)
        elif too_coarse:
            report["notes"].append(f"{too_coarse}; pressures on contact-fixed cells do not require that")
    report["notes"] += _between_surfaces(product, settings)
    if product.matched is not None:
        report["matched"] = {name: {"cells": s.cells, **s.facts()} for name, s in product.matched.surfaces.items()}
        report["notes"] += product.matched.notes
        if SKIN not in product.matched.observed:
            report["notes"].append(
                "the skin for pictures follows the matched faces by the global modes only, to keep the file small"
            )
        report["warnings"] += product.matched.warnings
    # coupling of surfaces, materials behind them
    for cross in product.cross:
        share = coupling(cross, surfaces[cross.target], surfaces[cross.source])
        report["contact"][cross.target]["coupling"][cross.source] = share
        report["contact"][cross.source]["coupling"][cross.target] = share
    materials = {name: facet_material(mesh, mesh.facets(name), assignment) for name in settings.contact}
    axial = {name: axial_error(s.shape, s.grid, materials[name]) for name, s in surfaces.items()}
    report["warnings"] += [said for name, error in axial.items() if (said := axial_warning(name, error))]
    for name, error in axial.items():
        report["contact"][name]["axial_error"] = error
    report["notes"] += [
        f"contact {name!r}: {100.0 * share:.3g} % of the facets are of another material than the one used for the "
        "surface in comparisons with Hertz"
        for name in settings.contact
        if (share := other_material(mesh, mesh.facets(name), assignment)) > 0.0
    ]
    body = ReducedBody(
        mass=product.mass,
        center_of_mass=product.center,
        inertia=product.inertia,
        frequencies=product.omega / (2.0 * np.pi),
        interfaces=product.interfaces,
        contact_surfaces=surfaces,
        surface=DisplaySurface(
            product.skin_points,
            product.skin_triangles,
            np.ascontiguousarray(product.skin_modes),
            None if product.matched is None else product.matched.by_force(SKIN, 3),
            product.skin_second_order,
        ),
        stress=recovery.fields(product, surfaces),
        report=report,
        provenance={
            "mesh_name": mesh.name,
            "contact_materials": {name: None if m is None else asdict(m) for name, m in materials.items()},
            "contact_walls": {
                name: wall(mesh, name, s.shape, s.grid, assignment) for name, s in surfaces.items() if materials[name]
            },
            "contact_node_spacings": {name: node_spacing(mesh, name, s.shape, s.grid) for name, s in surfaces.items()},
        },
        inertia_terms=product.inertia_terms,
        cross=tuple(product.cross),
        matched={} if product.matched is None else product.matched.surfaces,
        matched_compliance=None if product.matched is None else product.matched.compliance,
        thermal=product.thermal,
    )
    report["quality"] = quality(body, product.surfaces, settings.limits)
    return body


@dataclass(frozen=True)
class _Found:
    """Result of the search for periodicity: the reason if none was found, notes otherwise."""

    reason: str | None = None
    notes: tuple[str, ...] = ()


def _periodic(mesh: Mesh, settings: Settings) -> tuple[Mesh, _Found]:
    """The mesh renumbered by sectors if periodicity is admissible and found, otherwise the mesh itself."""
    if mesh.cyclic is not None or not mesh.cells or settings.general_reason is not None or mesh.structure.parts:
        return mesh, _Found()
    materials = settings.material if isinstance(settings.material, Mapping) else {}
    detection = detect(mesh, whole=[*settings.interfaces, *materials])
    if detection.mesh is None or detection.mesh.cyclic is None:
        return mesh, _Found(detection.reason)
    move = f", nodes moved by up to {detection.largest_move:.2g} m" if detection.largest_move > 0.0 else ""
    return detection.mesh, _Found(notes=(f"found to be periodic: {detection.mesh.cyclic.sectors} sectors{move}",))


def _product(
    mesh: Mesh,
    assignment: Assignment,
    settings: Settings,
    joints: list[Any],
    choice: PathChoice,
    expected: dict[str, GridChoice],
    recovery: StressRecovery,
    checkpoint: Checkpoint,
    stages: Progress,
) -> PathProduct:
    """Run the chosen path."""
    how: dict[str, Any] = {
        "traction": settings.grid.traction,
        "tangential": settings.grid.tangential_kind,
        "observers": recovery.observers(),
        "sloping": [
            n for n, s in choice.shapes.items() if may_slope(s, facet_material(mesh, mesh.facets(n), assignment))
        ],
        "local_dynamics": settings.options.local_dynamics,
        "inertia_modes": settings.options.inertia_modes,
        "centrifugal": settings.options.centrifugal,
    }
    spacing = spacings(mesh, choice.shapes, settings, expected)
    limits = settings.limits
    if choice.patterns is not None:
        most = 3 * (len(mesh.points) - sum(len(i.nodes) for i in joints)) + 6 * len(joints) - 6
        if limits.count is not None and limits.count > most:
            raise InputError(
                f"basis {settings.basis.kind!r}: {limits.count} vibration modes are more than the model has ({most}); "
                "request fewer, or refine the mesh"
            )
        cyclic = [(name, shape, choice.patterns[name]) for name, shape in choice.shapes.items()]
        return reduce_cyclic(mesh, assignment, joints, cyclic, limits, spacing, stages, **how)
    how |= {
        "stiffening": settings.options.stiffening,
        "membrane_modes": settings.options.membrane_modes,
        "matched": settings.matched,
        "solver": settings.options.solver,
        "checkpoint": checkpoint,
        "thermal": settings.thermal,
    }
    named = list(choice.shapes.items())
    memory = None if settings.options.memory_limit is None else int(settings.options.memory_limit)
    return reduce_general(mesh, assignment, joints, named, settings.basis, limits, spacing, memory, stages, **how)


def _with_far_field(
    surface: ContactSurface,
    mesh: Mesh,
    assignment: Assignment,
    settings: Settings,
    checkpoint: Checkpoint,
    stages: Progress,
    report: dict[str, Any],
) -> ContactSurface:
    """The surface with its far field, if requested and available; notes and figures are added to the `report`."""
    name, shape, grid = surface.name, surface.shape, surface.grid
    if settings.grid.contact_fixed is False:
        return surface
    material = facet_material(mesh, mesh.facets(name), assignment)
    if settings.grid.contact_fixed is None and not is_coarse(
        mesh, name, shape, grid, settings.grid.expected_half_width, material
    ):
        return surface
    own = surface.lags, surface.tangential
    found = find_far_field(mesh, name, shape, grid, *own, material, assignment, checkpoint, stages)
    report["notes"] += found.notes
    report["warnings"] += found.warnings
    report["stage_seconds"] = dict(stages.seconds)
    if found.far is None:
        if settings.grid.contact_fixed:
            raise InputError(found.notes[-1])
        return surface
    report["contact"][name]["far_field"] = found.facts
    return replace(surface, far=found.far)


@contextmanager
def one_thread() -> Iterator[None]:
    """Limit the BLAS of NumPy and SciPy to `BLAS_THREADS` inside the block, for the whole process."""
    import scipy.linalg  # noqa: F401  SciPy brings a BLAS of its own, which must be loaded to be limited
    from threadpoolctl import threadpool_limits

    with threadpool_limits(limits=BLAS_THREADS, user_api="blas"):
        yield


def _judged(
    mesh: Mesh, name: str, shape: Any, s: SurfaceProduct, settings: Settings
) -> tuple[dict[str, Any], list[str]]:
    """Figures of a contact surface for the report, and warnings; raises `InputError` if its functions are dependent."""
    edge = ContactFacets.of(mesh.points, mesh.facets(name), shape).chart.edge
    held = held_nodes(mesh, name, settings.interfaces)
    ratio = check_compliance(s.window, name, edge, held)
    residual = eigenvalue_ratio(s.residual_window)
    depth = layer_depth(mesh, name, shape)
    in_spacings = depth_ratio(depth, shape, s.grid)
    warnings = [held] if held else []
    if not residual > INDEPENDENCE and not held:
        warnings.append(
            f"contact {name!r}: the global modes span nearly all deformations of the mesh, too few are left to the "
            f"local modes (eigenvalue ratio {residual:.2g}); use fewer modes or a finer mesh"
        )
    if text := depth_warning(name, depth, in_spacings):
        warnings.append(text)
    figures = {
        "columns": s.grid.columns,
        "rows": s.grid.rows,
        "trace_ratio": s.traces,
        "eigenvalue_ratio": ratio,
        "residual_eigenvalue_ratio": residual,
        "longest_facet_edge": edge,
        "layer_depth": depth,
        "layer_depth_in_spacings": in_spacings,
        "deviation": shape.deviation,
        "line_mesh_error": line_mesh_error(mesh, shape, s.grid),
        "coupling": {},
    }
    return figures, warnings


def _between_surfaces(product: PathProduct, settings: Settings) -> list[str]:
    """Notes on the couplings that the compliance between contact surfaces neglects."""
    notes = []
    if product.matched is not None and product.surfaces:
        notes.append(
            "loads on contact surfaces move the matched faces of this body through the global modes only, and these "
            "them; where that matters, as for a ring that its fit widens, name parts of the contact surface as "
            "'average' interfaces (Mesh.select), whose mean motions are among the global modes"
        )
    if product.cross and settings.options.local_dynamics:
        notes.append(
            "local_dynamics=True: the mass of local modes is that of each contact surface alone; with inertia, loads "
            "on one surface move the others through the global modes only"
        )
    if product.cross and any(s.slope_lags is not None for s in product.surfaces):
        notes.append(
            "normals that rotate under load change the compliance of each contact surface alone, not that of one "
            "surface under loads on another"
        )
    return notes


def _not_used(settings: Settings, cyclic: bool) -> list[str]:
    """Notes on settings that the chosen path does not use."""
    if not cyclic:
        return []
    given = {"solver": settings.options.solver, "memory_limit": settings.options.memory_limit}
    return [
        f"{name} was not used: a periodic body is reduced harmonic by harmonic, with separate factors; periodic=False "
        "disables that"
        for name, value in given.items()
        if value is not None
    ]


def _other_spacing(name: str, shape: Any, s: SurfaceProduct, settings: Settings) -> list[str]:
    """A note if the column spacing of the grid differs from the requested one."""
    wanted = settings.grid.spacing
    actual = s.grid.pitch * largest_radius(shape, s.grid.z)
    if wanted is None or abs(actual - wanted) <= SPACING_NOTED * wanted:
        return []
    return [
        f"contact {name!r}: columns are {actual:.3g} m apart, spacing={wanted:g}: they divide a full "
        "revolution, or a sector, evenly"
    ]


def _report(
    product: PathProduct, choice: PathChoice, mesh: Mesh, settings: Settings, stages: Progress
) -> dict[str, Any]:
    facts = dict(product.facts)
    notes = [*mesh.notes, *facts.pop("notes", [])]
    dropped = facts.get("dependent_directions_dropped", 0)
    if dropped:
        notes.append(f"{dropped} dependent direction(s) of attachment and vibration modes were dropped")
    covered = 0 if product.inertia_terms is None else product.inertia_terms.modes
    if settings.options.centrifugal and settings.options.inertia_modes is None and covered > MODES:
        notes.append(
            f"centrifugal=True: {covered} modes have inertia terms, so that they contain the response to rotation; "
            f"inertia_modes={MODES} would be faster, and omit part of it"
        )
    return {
        "path": "general" if choice.patterns is None else "cyclic",
        "path_reason": choice.reason,
        "nodes": len(mesh.points),
        "dofs": 3 * (len(mesh.points) + len(mesh.structure.rotating)),
        "stage_seconds": dict(stages.seconds),
        "contact": {},
        "notes": notes,
        "warnings": too_low(product.omega, settings),
        "cached": False,
        "blas_threads": BLAS_THREADS,
        "inertia": {
            "modes": covered,
            "of": len(product.omega),
            "stiffening": bool(settings.options.stiffening),
            "membrane": facts.pop("membrane", None),
            "centrifugal": settings.options.centrifugal,
            "centrifugal_left_out": facts.pop("centrifugal_left_out"),
        },
        **facts,
    }
