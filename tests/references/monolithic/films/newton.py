r"""A Newton correction of the whole system with films: coordinates, rows, pressures and cavity volumes at once.

With K the Jacobian of the system without films, z its unknowns, x pressures of full functions and cavity volumes
of the others, F the generalised forces of the films and R their balances,

    [ K - dF/dz   -dF/dx ] [dz]       [ r - F ]
    [ dR/dz        dR/dx ] [dx]  =  - [   R   ].

Nothing is condensed: the matrix is dense and factored by LAPACK. Columns of pressures and cavity volumes, which differ
by twelve orders, are scaled to one, and so are the rows of R. No gap is reduced below `CLOSEST` of the smallest; the
set changes once per iteration: functions without pressure become cavitated, those without cavity volume become full.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from scipy.linalg import lapack as _lapack

from references.monolithic.core.equations import Increment
from references.monolithic.core.linear import SingularError, _scales
from references.monolithic.films.film import FilmSlopes, FilmState, Unknowns

lapack: Any = _lapack  # routines made at import, unknown to type checkers
Array = np.ndarray
CLOSEST = 0.2  # of the smallest gap: lower limit of the gap after an iteration
GUARD = 0.5  # of the gaps at the beginning of a step: lower limit of the prediction
NO_VOID = 1e-13  # of the clearance: round-off of a cavity volume
MAX_ITERATIONS = 60  # sets change once per iteration, fronts by few functions in each


def correction(
    K: Array, coordinates: int, residual: Array, films: list[FilmState], slopes: list[FilmSlopes]
) -> tuple[Array, list[Array]]:
    """Changes of the unknowns of the system, and for each film those (functions,) of pressures or cavity volumes.
    Raises `SingularError`, and `FloatingPointError` for overflow."""
    n = len(K)
    sizes = [film.data.count for film in films]
    whole = np.zeros((n + sum(sizes),) * 2, order="F")
    whole[:n, :n] = K
    right = np.zeros(len(whole))
    right[:n] = -residual
    first = n
    for film, slope, size in zip(films, slopes, sizes, strict=True):
        at, free, mine = film.data.columns, film.data.free, slice(first, first + size)
        full = film.x.full[free]
        whole[np.ix_(at, at)] -= _square(slope, len(at))
        whole[at, mine] = -np.where(full, slope.F_p[:, free], slope.F_D[:, free])
        whole[mine, at] = slope.R_y[free]
        whole[mine, mine] = np.where(full, slope.R_p[np.ix_(free, free)], slope.R_D[np.ix_(free, free)])
        right[mine] = -film.rest[free]
        first += size
    columns, rows = np.ones(len(whole)), np.ones(len(whole))
    columns[:n] = rows[:n] = _scales(whole[:n, :n], coordinates)
    whole[:n] *= rows[:n, None]
    whole[:, :n] *= columns[:n]
    for scale, axis in ((columns, 0), (rows, 1)):
        block = np.abs(whole[:, n:] if axis == 0 else whole[n:]).max(axis=axis, initial=0.0)
        scale[n:] = 1.0 / np.where(block > 0.0, block, 1.0)
        if axis == 0:
            whole[:, n:] *= scale[n:]
        else:
            whole[n:] *= scale[n:, None]
    if not np.all(np.isfinite(whole)):
        raise FloatingPointError("a number beyond all bounds in the Jacobian")
    _, _, found, info = lapack.dgesv(whole, rows * right, overwrite_a=True)
    if info != 0:
        raise SingularError
    found = columns * found
    changes, first = [], n
    for film, size in zip(films, sizes, strict=True):
        change = np.zeros(film.data.basis.functions)
        change[film.data.free] = found[first : first + size]
        changes.append(change)
        first += size
    return found[:n], changes


def _square(slope: FilmSlopes, n: int) -> Array:
    """Derivative (n, n) of the forces of a film by its columns; those on A's modes depend on pressures alone."""
    block = np.zeros((n, n))
    block[: len(slope.F_y)] = slope.F_y
    return block


def part_of(films: list[FilmState], slopes: list[FilmSlopes], z: Array) -> float:
    """Largest fraction of the changes for which no gap closes."""
    part = 1.0
    for film, slope in zip(films, slopes, strict=True):
        data, own = film.data, z[film.data.columns]
        opened = slope.h_x @ own[: data.rigid] - data.basis.deform @ (data.phi @ own[data.rigid :])
        least = float(film.gap.min())
        if float((film.gap + opened).min()) < CLOSEST * least:
            part = min(part, (1.0 - CLOSEST) * least / float(-opened.min()))
    return part


def taken(film: FilmState, change: Array, part: float) -> tuple[Unknowns, bool]:
    """The result of the fraction `part` of the change, and whether the set changed."""
    data, x = film.data, film.x
    unknown = ~data.basis.held
    full = x.full & unknown
    empty = ~x.full & unknown
    leave = full & (x.pressure + change <= 0.0) if data.travels else np.zeros_like(full)
    fill = empty & (x.void + change < -NO_VOID * data.thickness)
    pressure = np.where(full, np.where(leave, 0.0, x.pressure + part * change), x.pressure)
    void = np.where(empty, np.where(fill, 0.0, x.void + part * change), x.void)
    return Unknowns(pressure, void, (x.full & ~leave) | fill), bool(np.any(leave | fill))


def guard(gaps: list[tuple[Array, Array]], x: Increment) -> None:
    """Limit predicted increments to `GUARD` of the gaps; gaps: of each film before, and at the increments."""
    part = 1.0
    for before, ahead in gaps:
        closing = before - ahead
        close = closing > (1.0 - GUARD) * before
        if np.any(close):
            part = min(part, float(((1.0 - GUARD) * before[close] / closing[close]).min()))
    if part < 1.0:
        for step in (x.dx, x.psi, x.dq):
            step *= part
