r"""Errors of a Hertz contact on a contact grid, for any position of the patch over the grid.

The body is an exact half-plane or half-space (`half_space.compliances`), so that the grid is all that is wrong.
Functions psi_i of the grid, coefficients f of a pressure, `G_ij = a(psi_i, psi_j)`, Hertz's pressure p with
displacement u inside the patch and `a(p, p)` known in closed form:

* **compliance**: the best the functions can do in energy, `1 - c^T G^-1 c / a(p, p)` with `c_i = int psi_i u`, over
  all functions that reach the patch, whatever their sign. Also the error of the mean approach under p.
* **contact**: at Hertz's approach, `0 <= f, 0 <= g + G f, f (g + G f) = 0` with the weak gaps
  `g_i = int psi_i (curvature - approach)`. The force, the largest mean pressure of a function as results report it
  (of a node: weighted with its shape function), the half-width from the second moment of the pressure, and the whole
  field of pressures in the L2 norm against Hertz's.

Two bodies: the one that carries the pressures takes them as they are, the other as the L2 projection on its own grid,
whose position is free (`compliances.facing`). Two equal bodies have the mean of both compliances.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import scipy.linalg as la
from scipy.ndimage import convolve1d

from references.half_space.compliances import Array, EllipsePatch, LinePatch, facing, toeplitz

Patch = LinePatch | EllipsePatch
MARGIN = 2  # functions beyond the patch on each side: the contact on a coarse grid is up to one and a half wider
SECOND_MOMENT = {"nodes": 6.0, "cells": 12.0}  # of one function about its middle: s^2 over this
REACH = {"nodes": 1.0, "cells": 0.5}  # spacings from the middle of a function to its end
HERTZ_MOMENT = {1: 4.0, 2: 5.0}  # second moment of the Hertz pressure: (semi-axis)^2 over this, by dimension
GAUSS, PARTS = 4, {1: 8, 2: 2}  # quadrature of weak displacements, parts of a spacing by dimension
ITERATIONS = 100  # of the active set; a dozen is usual


class GridErrors(NamedTuple):
    """Relative errors; signs as computed minus exact, but the compliance, which is always missing."""

    compliance: float
    force: float
    peak_pressure: float
    half_width: float  # the larger of both directions
    pressure: float  # L2 norm of the difference over that of Hertz's pressure


def grid_errors(
    patch: Patch,
    traction: str,
    spacing: tuple[float, ...],
    position: tuple[float, ...],
    opposite: tuple[float, ...] | None = None,
) -> GridErrors:
    """Errors on a grid of `spacing` in half-widths; `position` of the middle of the patch off a function's middle and
    `opposite`, of the other body's grid off this one, in spacings, one number a direction. None: a single body."""
    x = _middles(patch, spacing, position)
    table = patch.table(traction, spacing, tuple(map(len, x)))
    if opposite is not None:
        table = 0.5 * (table + _seen(patch, traction, spacing, opposite, table.shape))
    G = toeplitz(table)

    mesh = list(np.meshgrid(*x, indexing="ij"))
    area = float(np.prod(spacing))
    gap = np.full(table.shape, -patch.approach)
    for X, s, curvature in zip(mesh, spacing, patch.curvature, strict=True):
        gap += curvature * (X**2 + s**2 / SECOND_MOMENT[traction])
    f = contact_pressures(G, area * gap.ravel()).reshape(table.shape)
    mean = f
    if traction == "nodes":
        for axis in range(f.ndim):
            mean = convolve1d(mean, np.array([1.0, 4.0, 1.0]) / 6.0, axis=axis, mode="constant")

    near = _reaches(patch, traction, mesh, spacing).ravel()
    c = weak_displacement(patch, traction, x, spacing).ravel()[near]
    best = la.solve(G[np.ix_(near, near)], c, assume_a="pos")
    widths = []
    for X, s, axis in zip(mesh, spacing, patch.axes, strict=True):
        middle = (f * X).sum() / f.sum()
        moment = (f * (X - middle) ** 2).sum() / f.sum() + s**2 / SECOND_MOMENT[traction]
        widths.append(np.sqrt(HERTZ_MOMENT[f.ndim] * moment) / axis - 1.0)
    return GridErrors(
        float(1.0 - c @ best / patch.energy),
        float(area * f.sum() / patch.force - 1.0),
        float(mean.max() - 1.0),
        float(max(widths, key=abs)),
        field_error(patch, traction, x, spacing, f),
    )


def put_on_grid(patch: LinePatch, traction: str, spacing: float, position: float) -> tuple[float, float]:
    """Errors of the mean approach when the given pressure itself is put on the grid: by its values at the middles of
    the functions, and by L2 projection. Neither is a best approximation in energy."""
    x = _middles(patch, (spacing,), (position,))
    G = toeplitz(patch.table(traction, (spacing,), (len(x[0]),)))
    reach = weak_displacement(patch, traction, x, (spacing,), patch.pressure)
    M = spacing * np.eye(len(reach))
    if traction == "nodes":
        M = toeplitz(spacing * np.pad([2.0 / 3.0, 1.0 / 6.0], (0, len(reach) - 2)))
    found = [patch.pressure(x[0]), np.linalg.solve(M, reach)]
    return tuple(float(f @ G @ f / patch.energy - 1.0) for f in found)  # pyright: ignore[reportReturnType]


def contact_pressures(G: Array, gap: Array) -> Array:
    """f >= 0 with `gap + G f >= 0` and one of both zero, G (n, n) positive definite: primal-dual active set."""
    active = gap < 0.0
    for _ in range(ITERATIONS):
        f = np.zeros(len(gap))
        held = np.flatnonzero(active)
        f[held] = la.solve(G[np.ix_(held, held)], -gap[held], assume_a="pos")
        after = np.where(active, f > 0.0, gap + G[:, held] @ f[held] < 0.0)
        if np.array_equal(after, active):
            return f
        active = after
    raise RuntimeError("the active set of the study's contact problem does not settle")


def weak_displacement(
    patch: Patch, traction: str, x: tuple[Array, ...], spacing: tuple[float, ...], field=None
) -> Array:
    """`int psi_i field` over the functions with middles `x`, composite Gauss; field: the patch's displacement."""
    points, functions, weights = _quadrature(traction, x, spacing)
    values = (field or patch.displacement)(*np.meshgrid(*points, indexing="ij", sparse=True))
    for axis, (psi, weight) in enumerate(zip(functions, weights, strict=True)):
        values = np.moveaxis(np.tensordot(psi * weight, values, axes=(1, axis)), 0, axis)
    return values


def field_error(patch: Patch, traction: str, x: tuple[Array, ...], spacing: tuple[float, ...], f: Array) -> float:
    """L2 norm of `sum f_i psi_i` less Hertz's pressure, over that of Hertz's pressure."""
    points, functions, weights = _quadrature(traction, x, spacing)
    hertz = patch.pressure(*np.meshgrid(*points, indexing="ij", sparse=True))
    found = f
    for axis, psi in enumerate(functions):
        found = np.moveaxis(np.tensordot(psi, found, axes=(0, axis)), 0, axis)
    area = weights[0] if len(weights) == 1 else np.multiply.outer(*weights)
    return float(np.sqrt(np.sum(area * (found - hertz) ** 2) / np.sum(area * hertz**2)))


def _quadrature(
    traction: str, x: tuple[Array, ...], spacing: tuple[float, ...]
) -> tuple[list[Array], list[Array], list[Array]]:
    """Points (q,), functions (n, q) there and weights (q,) of composite Gauss in each direction."""
    t, w = np.polynomial.legendre.leggauss(GAUSS)
    parts = PARTS[len(x)]
    points, functions, weights = [], [], []
    for middles, s in zip(x, spacing, strict=True):
        start = middles[0] - s
        cuts = start + s * np.arange((len(middles) + 1) * parts) / parts
        at = (cuts[:, None] + 0.5 * (t + 1.0) * s / parts).ravel()
        away = np.abs(at[None] - middles[:, None]) / s
        points.append(at)
        functions.append(np.maximum(1.0 - away, 0.0) if traction == "nodes" else (away < 0.5) * 1.0)
        weights.append(np.tile(0.5 * w * s / parts, len(cuts)))
    return points, functions, weights


def _middles(patch: Patch, spacing: tuple[float, ...], position: tuple[float, ...]) -> tuple[Array, ...]:
    """Middles of the functions in each direction, the patch at the origin."""
    found = []
    for s, shift, axis in zip(spacing, position, patch.axes, strict=True):
        count = int(np.ceil(axis / s)) + MARGIN
        found.append(s * (np.arange(-count, count + 1) + shift))
    return tuple(found)


def _reaches(patch: Patch, traction: str, mesh: list[Array], spacing: tuple[float, ...]) -> Array:
    """Which functions' supports reach into the patch."""
    away = np.zeros(mesh[0].shape)
    for X, s, axis in zip(mesh, spacing, patch.axes, strict=True):
        away += (np.maximum(np.abs(X) - REACH[traction] * s, 0.0) / axis) ** 2
    return away < 1.0


def _seen(
    patch: Patch, traction: str, spacing: tuple[float, ...], opposite: tuple[float, ...], shape: tuple[int, ...]
) -> Array:
    """Table of the body opposite, which sees the pressures on its own nodes."""
    kernels = [facing(shift) for shift in opposite]
    reach = len(kernels[0]) // 2
    table = patch.table(traction, spacing, tuple(n + reach for n in shape))
    for axis, kernel in enumerate(kernels):
        mirrored = np.concatenate([np.flip(table, axis), np.delete(table, 0, axis)], axis)
        seen = convolve1d(mirrored, kernel, axis=axis, mode="constant")
        table = np.take(seen, np.arange(shape[axis]) + table.shape[axis] - 1, axis)
    return table
