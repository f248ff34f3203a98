"""`reduce`: from a mesh, a material, interfaces and contact surfaces to a `ReducedBody`."""

from __future__ import annotations

import logging
import time
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import asdict
from typing import Any

import numpy as np

import warpffrf.offline.cache as body_cache
from warpffrf.model.errors import InputError, require_count, require_number
from warpffrf.model.material import Material
from warpffrf.model.mesh import Mesh
from warpffrf.model.reduced_body import (
    ContactSurface,
    DisplaySurface,
    Interface,
    ReducedBody,
    library_versions,
)
from warpffrf.offline.cell_depth import depth_ratio, depth_warning, layer_depth
from warpffrf.offline.contact_grid import facet_chart
from warpffrf.offline.cyclic import reduce_cyclic
from warpffrf.offline.general import reduce_general
from warpffrf.offline.independence import INDEPENDENCE, check_independence, eigenvalue_ratio, trace_ratio
from warpffrf.offline.interfaces import rigid_interfaces
from warpffrf.offline.materials import assign, facet_material
from warpffrf.offline.paths import choose_path, resolve_shapes
from warpffrf.offline.products import Limits, PathProduct, SurfaceProduct
from warpffrf.offline.progress import Progress

logger = logging.getLogger("warpffrf.offline")
INTERFACE_KINDS = ("rigid",)
BASES = ("free_free",)
LIBRARIES = ("warpffrf", "numpy", "scipy", "scikit-fem")
# Small dense systems by the thousand: the threads of a BLAS wait for each other. The vibration modes of a roller of
# 302,400 dofs took 0.09 s with one thread and 0.52 s with two.
BLAS_THREADS = 1


def reduce(
    mesh: Mesh,
    material: Material | Mapping[str, Material] | None = None,
    *,
    interfaces: Mapping[str, str] | None = None,
    contact: Mapping[str, Any] | None = None,
    basis: str = "free_free",
    max_frequency: float | None = None,
    modes: int | None = None,
    traction_spacing: float | None = None,
    memory_limit: float | None = None,
    cache: bool = True,
    progress: bool = True,
) -> ReducedBody:
    """Reduce a finite-element body to global modes and residual local modes.

    Parameters
    ----------
    mesh: the body; its frame is the body's user frame.
    material: one material, or {cell set: Material} that covers every cell once. A mesh made of matrices needs none.
    interfaces: {facet set: "rigid"}; the nodes of a rigid interface move as one rigid body.
    contact: {facet set: shape}, a `warpffrf.surfaces` shape, or None to have a cylinder or crowned cylinder fitted.
    basis: "free_free": free-free vibration modes and inertia-relief attachment modes of the interfaces.
    max_frequency [Hz], modes: vibration modes up to this frequency, or this many, or the fewer of both; neither:
        none, the attachment modes alone. A pair of equal frequencies is never split (`report["notes"]` says so).
    traction_spacing [m]: spacing of the contact grid; None: the surface nodes of a structured mesh, else the longest
        facet edge.
    memory_limit [byte]: bound for dense operators and blocks of right-hand sides of the general path; None: 4 GiB.
    cache: look the result up in, and put it into, the user's cache.
    progress: a bar on a terminal.

    The static response to every load in the span of the hats is exact for any number of modes. A rotationally
    periodic mesh is reduced harmonic by harmonic, any other by one factorisation; `report["path"]` tells which, and
    why. Linear algebra runs on one thread (`report["blas_threads"]`). What makes a result doubtful, such as cells too
    deep for the contact grid, is put into `report["warnings"]` and logged. Raises `InputError` for bad settings,
    unknown sets, facets that do not fit their shape, a contact grid finer than the mesh.
    """
    start = time.perf_counter()
    kinds = dict(interfaces or {})
    shapes = dict(contact or {})
    limits = _checked(mesh, kinds, shapes, basis, max_frequency, modes, traction_spacing, memory_limit)
    assignment = assign(mesh, material)
    settings = {
        "mesh": mesh.content_hash(),
        "material": _material_settings(material),
        "interfaces": kinds,
        "contact": {name: None if s is None else s.describe() for name, s in shapes.items()},
        "basis": basis,
        "max_frequency": max_frequency,
        "modes": modes,
        "traction_spacing": traction_spacing,
        "memory_limit": memory_limit,
    }
    key = body_cache.cache_key(settings)
    if cache and (body := body_cache.load_cached(key)) is not None:
        body.report["cached"] = True
        body.report["seconds_cached"] = time.perf_counter() - start
        logger.info("reduced body taken from the cache, %.2f s", body.report["seconds_cached"])
        _log_warnings(body)
        return body

    stages = Progress(progress)
    with one_thread():
        with stages.stage("mesh check"):
            mesh.check()
        rigid = rigid_interfaces(mesh, list(kinds))
        resolved = resolve_shapes(mesh, shapes)
        choice = choose_path(mesh, list(kinds), resolved, assignment)
        if choice.patterns is not None:
            surfaces = [(name, choice.shapes[name], choice.patterns[name]) for name in shapes]
            product = reduce_cyclic(mesh, assignment, rigid, surfaces, limits, traction_spacing, stages)
            path = "cyclic"
        else:
            named = [(name, choice.shapes[name]) for name in shapes]
            limit = None if memory_limit is None else int(memory_limit)
            product = reduce_general(mesh, assignment, rigid, named, limits, traction_spacing, limit, stages)
            path = "general"
        report = _report(product, path, choice.reason, mesh, stages)
        surfaces_out = {}
        for (name, shape), s in zip(choice.shapes.items(), product.surfaces, strict=True):
            report["contact"][name], warnings = _judged(mesh, name, shape, s)
            report["warnings"] += warnings
            surfaces_out[name] = ContactSurface(name, shape, s.grid, s.lags, s.mode_normal, s.recovery)
    if len(surfaces_out) > 1:
        report["notes"].append(
            "a load on one contact surface moves another through the global modes only: the local modes of different "
            "surfaces are not coupled"
        )
    report["seconds"] = time.perf_counter() - start
    body = ReducedBody(
        mass=product.mass,
        center_of_mass=product.center,
        inertia=product.inertia,
        frequencies=product.omega / (2.0 * np.pi),
        interfaces={
            i.name: Interface(kinds[i.name], i.point, m) for i, m in zip(rigid, product.interface_modes, strict=True)
        },
        contact_surfaces=surfaces_out,
        surface=DisplaySurface(product.skin_points, product.skin_triangles, product.skin_modes),
        report=report,
        provenance={
            "mesh_name": mesh.name,
            "settings": settings,
            "contact_materials": {
                name: _described(facet_material(mesh, mesh.facets(name), assignment)) for name in shapes
            },
            "key": key,
            "versions": library_versions(LIBRARIES),
        },
    )
    body.provenance["content_hash"] = body.content_hash()
    _log_warnings(body)
    if cache and (fault := body_cache.store(key, body)):
        report["warnings"].append(fault)
    return body


@contextmanager
def one_thread() -> Iterator[None]:
    """Hold the BLAS of NumPy and SciPy to `BLAS_THREADS` inside the block; other work of the process too."""
    import scipy.linalg  # noqa: F401  SciPy brings a BLAS of its own, which must be loaded to be limited
    from threadpoolctl import threadpool_limits

    with threadpool_limits(limits=BLAS_THREADS, user_api="blas"):
        yield


def _judged(mesh: Mesh, name: str, shape: Any, s: SurfaceProduct) -> tuple[dict[str, Any], list[str]]:
    """Figures of a contact surface for the report, and warnings; raises `InputError` where its hats depend."""
    edge = facet_chart(mesh.points, *mesh.facets(name).single, shape).edge
    traces = trace_ratio(mesh, name, shape, s.grid)
    ratio = check_independence(traces, s.window, name, edge)
    residual = eigenvalue_ratio(s.residual_window)
    depth = layer_depth(mesh, name, shape)
    in_spacings = depth_ratio(depth, shape, s.grid)
    warnings = []
    if not residual > INDEPENDENCE:
        warnings.append(
            f"contact {name!r}: the global modes hold nearly all that the mesh can do, too little is left to "
            f"the local modes (eigenvalue ratio {residual:.2g}); use fewer modes or a finer mesh"
        )
    if text := depth_warning(name, depth, in_spacings):
        warnings.append(text)
    figures = {
        "columns": s.grid.columns,
        "rows": s.grid.rows,
        "trace_ratio": traces,
        "eigenvalue_ratio": ratio,
        "residual_eigenvalue_ratio": residual,
        "longest_facet_edge": edge,
        "layer_depth": depth,
        "layer_depth_in_spacings": in_spacings,
        "deviation": shape.deviation,
    }
    return figures, warnings


def _log_warnings(body: ReducedBody) -> None:
    for text in body.report["warnings"]:
        logger.warning("%s", text)


def _described(material: Material | None) -> dict[str, Any] | None:
    """Plain data of a material."""
    return None if material is None else asdict(material)


def _material_settings(material: Material | Mapping[str, Material] | None) -> Any:
    """Plain data of what was given, for the cache key: names of materials do not count."""
    if isinstance(material, Material):
        return [material.youngs_modulus, material.poisson_ratio, material.density]
    return None if material is None else {name: _material_settings(one) for name, one in material.items()}


def _checked(
    mesh: Mesh,
    kinds: dict[str, str],
    shapes: dict[str, Any],
    basis: str,
    max_frequency: float | None,
    modes: int | None,
    spacing: float | None,
    memory_limit: float | None,
) -> Limits:
    """Refuse settings that cannot be used; returns the limits of the vibration modes."""
    if not isinstance(mesh, Mesh):
        raise InputError(
            f"reduce: a mesh is needed, made by mesh.roller, mesh.read or mesh.from_matrices, got {mesh!r}"
        )
    for name, kind in kinds.items():
        mesh.facets(name)
        if kind not in INTERFACE_KINDS:
            raise InputError(
                f"interface {name!r}: kind {kind!r} is not available, use one of {', '.join(INTERFACE_KINDS)}"
            )
    for name, shape in shapes.items():
        mesh.facets(name)
        if name in kinds:
            raise InputError(f"set {name!r} cannot be a rigid interface and a contact surface at once; use two sets")
        if shape is not None and not hasattr(shape, "fitted"):
            raise InputError(f"contact {name!r}: {shape!r} is no surface shape; use surfaces.Cylinder() or None")
    if basis not in BASES:
        raise InputError(f"basis {basis!r} is not available, use one of {', '.join(BASES)}")
    omega_max = None
    if max_frequency is not None:
        omega_max = 2.0 * np.pi * require_number(max_frequency, "reduce: max_frequency", positive=True)
    count = None if modes is None else require_count(modes, "reduce: modes", 0)
    if spacing is not None:
        require_number(spacing, "reduce: traction_spacing", positive=True)
    if memory_limit is not None:
        require_number(memory_limit, "reduce: memory_limit", positive=True)
    return Limits(count, omega_max)


def _report(product: PathProduct, path: str, reason: str, mesh: Mesh, stages: Progress) -> dict[str, Any]:
    facts = dict(product.facts)
    notes = facts.pop("notes", [])
    dropped = facts.get("dependent_directions_dropped", 0)
    if dropped:
        notes = [*notes, f"{dropped} dependent direction(s) of attachment and vibration modes were dropped"]
    return {
        "path": path,
        "path_reason": reason,
        "nodes": len(mesh.points),
        "dofs": 3 * len(mesh.points),
        "stage_seconds": dict(stages.seconds),
        "contact": {},
        "notes": notes,
        "warnings": list(mesh.report().warnings),
        "cached": False,
        "blas_threads": BLAS_THREADS,
        **facts,
    }
