"""Whether the arrays of a reduced body fit together: finite numbers, shapes that agree, axes that are axes.

A file's content hash tells damage; a faulty writer gives the right hash to wrong arrays, and a run with them would be
completed with wrong numbers.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from warpffrf.model.errors import InputError
from warpffrf.model.reduced_body import ContactSurface, Interface, ReducedBody

UNIT = 1e-9  # of axes: what a file keeps of a unit vector
SYMMETRIC = 1e-9  # of the inertia

Wanted = tuple[int | None, ...]  # a shape; None: any number


def check_body(body: ReducedBody) -> None:
    """Raise `InputError` that names the first array which cannot be that of a body, and what it should be."""
    for name, array, shape in _arrays(body):
        _check(name, array, shape)
    if not body.mass > 0.0:
        raise InputError(f"reduced body: mass must be greater than zero, got {body.mass:g}")
    J = body.inertia
    if np.abs(J - J.T).max() > SYMMETRIC * np.abs(J).max() or np.linalg.eigvalsh(J)[0] <= 0.0:
        raise InputError("reduced body: inertia is not symmetric and positive; run the reduction again")
    f = body.frequencies
    if np.any(f < 0.0) or np.any(np.diff(f) < 0.0):
        raise InputError("reduced body: frequencies are not ascending from zero on; run the reduction again")
    t, n = body.surface.triangles, len(body.surface.points)
    if t.size and (t.min() < 0 or t.max() >= n):
        raise InputError(
            f"reduced body: surface/triangles name a point that is none of the {n}; run the reduction again"
        )
    for name, s in body.contact_surfaces.items():
        _check_axes(f"contact_surfaces/{name}/grid/e_0", s.grid.e_0[:, None])
        _check_axes(f"contact_surfaces/{name}/axes", s.recovery.axes)


def _arrays(body: ReducedBody) -> Iterator[tuple[str, Any, Wanted]]:
    """Name, array and shape of all arrays whose shape follows from the number of modes and the grids."""
    m = len(body.frequencies)
    yield "center_of_mass", body.center_of_mass, (3,)
    yield "inertia", body.inertia, (3, 3)
    yield "frequencies", body.frequencies, (m,)
    n = len(body.surface.points)
    yield "surface/points", body.surface.points, (n, 3)
    yield "surface/triangles", body.surface.triangles, (None, 3)
    yield "surface/modes", body.surface.modes, (m, n, 3)
    for name, interface in body.interfaces.items():
        yield from _interface(f"interfaces/{name}", interface, m)
    for name, surface in body.contact_surfaces.items():
        yield from _contact(f"contact_surfaces/{name}", surface, m)


def _interface(root: str, interface: Interface, m: int) -> Iterator[tuple[str, Any, Wanted]]:
    yield f"{root}/point", interface.point, (3,)
    yield f"{root}/modes", interface.modes, (m, 6)
    if interface.nodes is not None:
        k = len(interface.nodes)
        yield f"{root}/nodes", interface.nodes, (k, 3)
        yield f"{root}/node_modes", interface.node_modes, (m, k, 3)


def _contact(root: str, s: ContactSurface, m: int) -> Iterator[tuple[str, Any, Wanted]]:
    block = s.grid.columns_per_sector * s.grid.rows
    sectors = -(-s.grid.columns // s.grid.columns_per_sector)
    yield f"{root}/grid/e_0", s.grid.e_0, (3,)
    yield f"{root}/grid/z", s.grid.z, (s.grid.rows,)
    yield f"{root}/lags", s.lags, (sectors if s.grid.periodic else None, block, block)
    yield f"{root}/mode_normal", s.mode_normal, (s.local_modes, m)
    yield f"{root}/axes", s.recovery.axes, (3, 3)
    yield f"{root}/transfer", s.recovery.transfer, (None, None, None)
    if s.local_mass is not None:
        yield f"{root}/local_mass/lags_mass", s.local_mass.lags_mass, s.lags.shape
    if s.tangential is not None:
        t = s.tangential
        block, own = t.grid.columns_per_sector * t.grid.rows, 2 * t.grid.columns_per_sector * t.grid.rows
        yield f"{root}/tangential/lags_tt", t.lags_tt, (len(t.lags_tt), own, own)
        yield f"{root}/tangential/lags_nt", t.lags_nt, (len(t.lags_tt), block, own)
        yield f"{root}/tangential/mode_tangent", t.mode_tangent, (2, t.grid.columns * t.grid.rows, m)


def _check(name: str, array: Any, shape: Wanted) -> None:
    cure = "run the reduction again"
    if array is None:
        raise InputError(f"reduced body: {name} is missing; {cure}")
    got = np.shape(array)
    if len(got) != len(shape) or any(b is not None and a != b for a, b in zip(got, shape, strict=True)):
        wanted = ", ".join("any" if b is None else str(b) for b in shape)
        raise InputError(f"reduced body: {name} must have shape ({wanted}), got {got}; {cure}")
    if not np.all(np.isfinite(array)):
        raise InputError(f"reduced body: {name} holds NaN or infinite numbers; {cure}")


def _check_axes(name: str, columns: np.ndarray) -> None:
    gram = columns.T @ columns
    if np.abs(gram - np.eye(len(gram))).max() > UNIT:
        raise InputError(f"reduced body: {name} are not unit vectors at right angles; run the reduction again")
