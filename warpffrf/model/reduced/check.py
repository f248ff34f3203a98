"""Consistency checks of the arrays of a reduced body: finite numbers, matching shapes, orthonormal axes.

A file's content hash detects damage; a faulty writer assigns the right hash to wrong arrays, and a run with them would
complete with wrong results.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping

import numpy as np

from warpffrf.model.errors import InputError
from warpffrf.model.reduced.contact_surface import FUNCTIONS, ContactSurface, CrossCompliance
from warpffrf.model.reduced.data import ReducedBodyData

SYMMETRIC_COMPLIANCE = 1e-12  # of its largest entry: written symmetric
UNIT = 1e-9  # of axes: precision of a stored unit vector
SYMMETRIC = 1e-9  # of the inertia

Wanted = tuple[int | None, ...]  # a shape; None: any number


def check_body(body: ReducedBodyData, arrays: Mapping[str, np.ndarray]) -> None:
    """Raise `InputError` naming the first invalid one of the stored `arrays`, by path, and the reason."""
    for name, array in arrays.items():
        if not np.all(np.isfinite(array)):
            raise InputError(f"{name} holds NaN or infinite numbers")
    for name, wanted in _shapes(body):
        got = arrays[name].shape
        if len(got) != len(wanted) or any(b is not None and a != b for a, b in zip(got, wanted, strict=True)):
            should = ", ".join("any" if b is None else str(b) for b in wanted)
            raise InputError(f"{name} must have shape ({should}), got {got}")
    if not body.mass > 0.0:
        raise InputError(f"mass must be greater than zero, got {body.mass:g}")
    J = body.inertia
    if np.abs(J - J.T).max() > SYMMETRIC * np.abs(J).max() or np.linalg.eigvalsh(J)[0] <= 0.0:
        raise InputError("inertia is not symmetric and positive")
    f = body.frequencies
    if np.any(f < 0.0) or (np.any(np.diff(f) < 0.0) and "computed_frequencies" not in body.provenance):
        raise InputError("frequencies are not ascending from zero on")
    t, n = body.surface.triangles, len(body.surface.points)
    if t.size and (t.min() < 0 or t.max() >= n):
        raise InputError(f"surface/triangles name a point that is none of the {n}")
    _check_matched(body)
    if body.thermal is not None and not np.all(body.thermal.rates > 0.0):
        raise InputError("thermal/rates must be greater than zero")
    for name, s in body.contact_surfaces.items():
        if s.far is not None and s.far.quarter is not None and min(s.far.quarter.coefficients.shape) < 4:
            raise InputError(f"contact_surfaces/{name}/far/quarter has too few numbers for a spline")
        rows, both = s.grid.rows, s.grid.columns_per_sector * s.grid.rows
        root = f"contact_surfaces/{name}"
        _check_compliance(f"{root}/lags", s.lags, lambda i, r=rows: f"column {i // r}, row {i % r}")
        if s.tangential is not None:
            tangential = s.tangential.lags_tt
            _check_compliance(
                f"{root}/tangential/lags_tt", tangential,
                lambda i, r=rows, n=both: f"direction {i // n}, column {i % n // r}, row {i % r}",
            )  # fmt: skip
        _check_axes(f"contact_surfaces/{name}/grid/e_0", s.grid.e_0[:, None])
        _check_axes(f"contact_surfaces/{name}/recovery/axes", s.recovery.axes)


def _check_matched(body: ReducedBodyData) -> None:
    """Raise `InputError` for invalid cells or frames, and a compliance that is not symmetric."""
    for name, face in body.matched.items():
        if np.any(face.area <= 0.0):
            raise InputError(f"matched/{name}/area must be greater than zero")
        gram = np.einsum("cij,ckj->cik", face.frames, face.frames)
        if np.abs(gram - np.eye(3)).max(initial=0.0) > UNIT:
            raise InputError(f"matched/{name}/frames are not unit vectors at right angles")
        if face.cell.size and (face.cell.min() < 0 or face.cell.max() >= face.cells):
            raise InputError(f"matched/{name}/cell names a cell that is none of the {face.cells}")
    if body.matched_compliance is not None:
        C = body.matched_compliance
        _check_compliance("matched_compliance", C[None], lambda i: f"cell {i // 3}, force {i % 3}")


def _check_compliance(name: str, lags: np.ndarray, place: Callable[[int], str]) -> None:
    """Raise `InputError` for a block-circulant compliance (sectors, n, n) that is not symmetric, or has an entry that
    no positive definite one has: D_ii <= 0, or D_ij^2 > D_ii D_jj; zero is that of a rigid surface. `place`: names a
    line."""
    if not lags.any():
        return
    off = np.abs(lags - np.swapaxes(lags[-np.arange(len(lags))], 1, 2))
    if off.max() > SYMMETRIC_COMPLIANCE * np.abs(lags).max():
        _, i, j = np.unravel_index(off.argmax(), off.shape)
        raise InputError(f"{name} is not symmetric: {place(int(i))} and {place(int(j))} displace each other unequally")
    own = np.diagonal(lags[0])
    if own.min() <= 0.0:
        raise InputError(f"{name} is not positive definite: {place(int(own.argmin()))} moves against its own force")
    excess = np.abs(lags) / np.sqrt(own[:, None] * own)
    if excess.max() > 1.0 + UNIT:
        _, i, j = np.unravel_index(excess.argmax(), excess.shape)
        raise InputError(f"{name} is not positive definite: {place(int(i))} moves more by {place(int(j))} than itself")


def _matched_shapes(body: ReducedBodyData) -> Iterator[tuple[str, Wanted]]:
    m, forces = len(body.frequencies), 0
    for name, face in body.matched.items():
        root, c, t = f"matched/{name}", len(face.area), len(face.cell)
        yield from ((f"{root}/area", (None,)), (f"{root}/cell", (None,)))
        yield from ((f"{root}/points", (c, 3)), (f"{root}/frames", (c, 3, 3)), (f"{root}/gap", (c,)))
        yield from ((f"{root}/modes", (m, 3 * c)), (f"{root}/triangles", (t, 3, 3)))
        forces += 3 * c
    if body.matched and body.matched_compliance is None:
        raise InputError("matched faces have no matched_compliance")
    for name, field in body.stress.items():
        if field.matched is not None:
            yield f"stress/{name}/matched", (forces, len(field.points), 6)
    if body.surface.matched is not None:
        yield "surface/matched", (forces, len(body.surface.points), 3)
    if body.matched_compliance is not None:
        yield "matched_compliance", (forces, forces)


def _shapes(body: ReducedBodyData) -> Iterator[tuple[str, Wanted]]:
    """Path and shape of the arrays whose shape follows from the number of modes and the grids."""
    m = len(body.frequencies)
    yield from (("center_of_mass", (3,)), ("inertia", (3, 3)), ("frequencies", (m,)))
    n = len(body.surface.points)
    yield from (("surface/points", (n, 3)), ("surface/triangles", (None, 3)), ("surface/modes", (m, n, 3)))
    for name, interface in body.interfaces.items():
        root = f"interfaces/{name}"
        yield from ((f"{root}/point", (3,)), (f"{root}/modes", (m, 6)))
        if interface.nodes is not None:
            k = len(interface.nodes)
            yield from ((f"{root}/nodes", (k, 3)), (f"{root}/node_modes", (m, k, 3)))
    for name, surface in body.contact_surfaces.items():
        yield from _contact_shapes(f"contact_surfaces/{name}", surface, m)
        yield f"contact_surfaces/{name}/recovery/transfer", _transfer_shape(surface, n)
    for cross in body.cross:
        yield from _cross_shapes(f"cross/{cross.target}/{cross.source}", body, cross)
    yield from _matched_shapes(body)
    stiffening = None if body.inertia_terms is None else body.inertia_terms.stiffening
    rank = 0 if stiffening is None or stiffening.membrane is None else len(stiffening.membrane)
    for name, field in body.stress.items():
        if field.membrane is not None:
            yield f"stress/{name}/membrane", (rank, len(field.points), 6)
    yield from _thermal_shapes(body, m, n)
    motion = None if stiffening is None else stiffening.motion
    if motion is not None and body.surface.second_order is None:
        raise InputError("second-order motion has amplitudes, but the surface has no shapes of it")
    if body.surface.second_order is not None:
        yield "surface/second_order", (0 if motion is None else len(motion.forms), n, 3)


def _thermal_shapes(body: ReducedBodyData, m: int, n: int) -> Iterator[tuple[str, Wanted]]:
    heat = body.thermal
    if heat is None:
        return
    if heat.grids != {name: (s.grid.columns, s.grid.rows) for name, s in body.contact_surfaces.items()}:
        raise InputError("thermal has other contact surfaces or grids than the body")
    r, b, nodes = len(heat.rates), len(heat.surroundings), heat.size
    x = b + r + nodes
    yield from (("thermal/rates", (None,)), ("thermal/inflow", (r, nodes)), ("thermal/carried", (r, b)))
    yield from (("thermal/mean", (1, x)), ("thermal/skin", (n, x)), ("thermal/skin_expansion", (3 * n, x)))
    yield "thermal/modal", (m, x)
    for name, (columns, rows) in heat.grids.items():
        for key in ("surfaces", "expansion"):
            yield f"thermal/{key}/{name}", (columns * rows, x)


def _contact_shapes(root: str, s: ContactSurface, m: int) -> Iterator[tuple[str, Wanted]]:
    block, sectors = s.grid.columns_per_sector * s.grid.rows, len(s.lags)
    turn = -(-s.grid.columns // s.grid.columns_per_sector)
    yield from ((f"{root}/grid/e_0", (3,)), (f"{root}/grid/z", (s.grid.rows,)))
    yield f"{root}/lags", (turn if s.grid.periodic else None, block, block)
    yield f"{root}/mode_normal", (s.local_modes, m)
    if s.slope_lags is not None:
        yield f"{root}/slope_lags", s.lags.shape
    if s.far is not None:
        yield f"{root}/far/lags", s.lags.shape
        if s.far.tangential is not None:
            yield f"{root}/far/tangential/lags_tt", (sectors, 2 * block, 2 * block)
            yield f"{root}/far/tangential/lags_nt", (sectors, block, 2 * block)
        if s.far.quarter is not None:
            yield f"{root}/far/quarter", (None, None)
    yield f"{root}/recovery/axes", (3, 3)
    if s.local_mass is not None:
        yield f"{root}/local_mass/lags_mass", s.lags.shape
        yield f"{root}/local_mass/overlap", (sectors * block, m)
    if s.tangential is not None:
        t = s.tangential
        block = t.grid.columns_per_sector * t.grid.rows
        yield f"{root}/tangential/lags_tt", (len(t.lags_tt), 2 * block, 2 * block)
        yield f"{root}/tangential/lags_nt", (len(t.lags_tt), block, 2 * block)
        yield f"{root}/tangential/mode_tangent", (2, t.grid.columns * t.grid.rows, m)


def _transfer_shape(s: ContactSurface, points: int) -> Wanted:
    """Of `Recovery.transfer`, for a skin of that many points."""
    N = s.recovery.sectors
    columns = s.grid.columns if N == 1 else s.grid.columns_per_sector
    return N // 2 + 1, 3 * points // N, columns * s.grid.rows


def _cross_shapes(root: str, body: ReducedBodyData, cross: CrossCompliance) -> Iterator[tuple[str, Wanted]]:
    surfaces = [body.contact_surfaces.get(name) for name in (cross.target, cross.source)]
    sectors = len(cross.lags)
    if any(s is None or not sectors or s.grid.columns % sectors for s in surfaces):
        raise InputError(f"{root} is not between two contact surfaces, or their columns do not make {sectors} sectors")
    target, source = (s.local_modes // sectors for s in surfaces if s is not None)
    for key in cross.arrays():
        a, b = FUNCTIONS[key]
        yield f"{root}/{key}", (sectors, a * target, b * source)


def _check_axes(name: str, columns: np.ndarray) -> None:
    gram = columns.T @ columns
    if np.abs(gram - np.eye(len(gram))).max() > UNIT:
        raise InputError(f"{name} are not unit vectors at right angles")
