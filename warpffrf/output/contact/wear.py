r"""Wear of the surfaces of a contact during a run, by Archard's law.

With the specific wear coefficient k [m2/N, the same as m3/(N m)] of a surface, pressure p and slip velocity w, its
depth and volume are

    h = k int p |w| dt,      V = k int int p |w| dA dt = k W/mu,

with the friction work W where the coefficient of friction mu is constant (J. F. Archard, J. Appl. Phys. 24 (1953) 981).
The slip of a saved row is that of its step, and stands for the time since the row before; the first row counts for
nothing. Many passages distribute the wear around a surface of revolution, and along the axis of an extruded one, so
that what remains is a profile: h(z), the mean around, or h(u), the mean over the width that the contact covered. It is
given at nodes s_i by the shares of the volume in their linear shape functions psi_i,

    h_i = int psi_i dV / int psi_i dA,

so that the straight lines between h_i have exactly the volume V. The volume of a cell is spread evenly over its extent
along s, and over the way of the patch since the row before: int psi_i dV is then a second difference of the integral
W(s) of the volume below s, a quadratic for each cell.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from warpffrf.model.errors import InputError, require_array, require_number
from warpffrf.model.surfaces.form_deviations import MeasuredForm
from warpffrf.model.surfaces.worn import profile_coordinate
from warpffrf.output.geometry.places import Pose, grid_theta_offset, tangents

Array = np.ndarray
MOST = 512  # intervals between nodes
NEAR = 0.01  # of an interval: the worn range reaches an end of the surface
GAUSS = 4  # points per interval: integrals of R sqrt(1 + R'^2)

Forms = tuple[MeasuredForm | None, MeasuredForm | None]


class Cells(NamedTuple):
    """Loaded cells of all saved rows on one surface: chart coordinates (n, 2), half extents in them (n, 2), int p |w|
    dA dt (n,) [J], and row (n,)."""

    at: Array
    half: Array
    work: Array
    row: Array


def wear(contact: Any, time: Array, coefficient: Any, repetitions: float) -> Forms:
    """See `PairResult.wear`."""
    label = f"wear of contact '{contact.name}'"
    given = np.broadcast_to(np.asarray(coefficient, float), (2,)) if np.ndim(coefficient) == 0 else coefficient
    k = require_array(given, f"{label}: coefficient [m2/N]", (2,))
    if np.any(k < 0.0):
        raise InputError(f"{label}: coefficient must not be negative, got {k.tolist()} m2/N")
    count = require_number(repetitions, f"{label}: repetitions", positive=True)
    if len(time) < 2:
        raise InputError(f"{label}: two saved rows or more are needed, there are {len(time)}; save more of the run")
    first, second = contact.view.first, contact.view.second
    names = (contact.view.first_body.name, contact.view.second_body.name)
    if first.shape.profile().twist or second.shape.profile().twist:
        raise InputError(f"{label}: wear of helical surfaces is not supported, it differs over the width")
    labels = [f"{label}: {body}[{one.name!r}]" for body, one in zip(names, (first, second), strict=True)]
    along = [
        profile_coordinate(one.shape, name) if coefficient else None
        for one, name, coefficient in zip((first, second), labels, k, strict=True)
    ]
    cells = _cells(contact, np.diff(time, prepend=time[0]), labels[0])
    both = (cells, cells if along[1] is None else _opposite(contact, cells))
    found = [
        None if axis is None else _form(surface, axis, on, coefficient * count)
        for surface, axis, on, coefficient in zip((first, second), along, both, k, strict=True)
    ]
    return found[0], found[1]


def _cells(contact: Any, weight: Array, label: str) -> Cells:
    index = contact.friction.wear_index
    row, j, n = np.nonzero(index > 0.0)
    work = index[row, j, n] * contact.cell_areas[row, n] * weight[row]
    if not np.any(work > 0.0):
        raise InputError(f"{label}: nothing slips under load in the saved rows, there is no wear; roll or slide")
    edges = np.array([contact.cell_lines(i)[1] for i in range(len(index))])  # a node at an end has half a cell
    theta = contact.theta[row, j] + grid_theta_offset(contact.view.first)
    wide = np.abs(contact.theta[:, 1] - contact.theta[:, 0])[row]
    at = np.stack([theta, 0.5 * (edges[row, n] + edges[row, n + 1])], axis=1)
    return Cells(at, 0.5 * np.stack([wide, edges[row, n + 1] - edges[row, n]], axis=1), work, row)


def _opposite(contact: Any, cells: Cells) -> Cells:
    """The cells on the second surface."""
    first, second = contact.view.first.shape, contact.view.second.shape
    names = contact.view.first_body.name, contact.view.second_body.name
    at, half = np.empty_like(cells.at), np.empty_like(cells.half)
    starts = np.flatnonzero(np.append(True, np.diff(cells.row) > 0))
    for begin, end in zip(starts, [*starts[1:], len(cells.row)], strict=True):
        part = slice(begin, end)
        one, two = (Pose.of(contact.bodies, name, int(cells.row[begin])) for name in names)
        theta, z = cells.at[part].T
        places = second.chart(two.to_user(one.to_world(first.point(theta, z))))[:2]
        at[part] = np.stack(places, axis=1)
        own = tangents(first, theta, z)
        turned = np.stack([two.turned_back(one.turned(side)) for side in own])
        lengths = cells.half[part] * _metric(first, z)
        share = np.abs(np.einsum("and,bnd->nab", turned, tangents(second, *places)))
        half[part] = np.einsum("na,nab->nb", lengths, share) / _metric(second, at[part][:, 1])
    return cells._replace(at=at, half=half)


def _metric(shape: Any, z: Array) -> Array:
    """Metres (n, 2) per unit of theta and of z."""
    return np.stack([shape.radius_at(z), np.sqrt(1.0 + shape.slope_at(z) ** 2)], axis=-1)


def _form(surface: Any, axis: int, cells: Cells, scale: float) -> MeasuredForm:
    """Depth along the profile; axis: as of `profile_coordinate`; scale [m2/N]."""
    shape: Any = surface.shape
    curve = None if axis else shape.curve
    period = curve.length if curve is not None and curve.closed else None
    s = cells.at[:, axis]
    if curve is not None and period is not None:
        s = curve.knots[0] + np.remainder(s - curve.knots[0], period)
    way = _ways(s, cells, period)[cells.row]
    s, half = s - 0.5 * way, cells.half[:, axis] + 0.5 * np.abs(way)
    nodes = _nodes(s - half, s + half, float(np.median(2.0 * cells.half[:, axis])), _limits(surface, axis), period)
    volume = _shares(nodes, s, half, cells.work, period)
    if axis:
        depth = scale * volume / _areas(shape, nodes)
        return MeasuredForm(theta=[0.0], z=nodes, values=depth[None])
    z, dz = cells.at[:, 1], cells.half[:, 1]
    width = float(np.max(z + dz) - np.min(z - dz))
    h = np.diff(nodes)
    area = 0.5 * width * (np.append(h, 0.0) + np.insert(h, 0, 0.0))
    if period is not None:
        area[[0, -1]] = area[0] + area[-1]
        volume[[0, -1]] = volume[0] + volume[-1]
    return MeasuredForm(theta=nodes, z=[0.0], values=scale * (volume / area)[:, None], periodic=False)


def _ways(s: Array, cells: Cells, period: float | None) -> Array:
    """Way (T,) of the middle of the patch along the profile since the row before; to the next one where nothing slipped
    in the row before, as at the start of a run."""
    rows = int(cells.row[-1]) + 1
    count = np.bincount(cells.row, minlength=rows)
    first = s[np.searchsorted(cells.row, np.arange(rows)).clip(max=len(s) - 1)]
    off = s - first[cells.row]
    if period is not None:
        off -= period * np.round(off / period)
    middle = first + np.bincount(cells.row, off, rows) / np.maximum(count, 1)
    steps = np.diff(middle)
    if period is not None:
        steps -= period * np.round(steps / period)
    steps = np.where((count[1:] > 0) & (count[:-1] > 0), steps, 0.0)
    return np.where(np.insert(count[:-1] > 0, 0, False), np.insert(steps, 0, 0.0), np.append(steps, 0.0))


def _limits(surface: Any, axis: int) -> tuple[float, float]:
    if not axis:
        return float(surface.shape.curve.knots[0]), float(surface.shape.curve.knots[-1])
    if surface.grid is not None:
        return float(surface.grid.z[0]), float(surface.grid.z[-1])
    table = getattr(surface.shape, "table", None)
    return (-np.inf, np.inf) if table is None else (float(table[0, 0]), float(table[0, -1]))


def _nodes(low: Array, high: Array, h: float, limits: tuple[float, float], period: float | None) -> Array:
    """Nodes from the lowest to the highest place, one more where the surface continues, of the whole closed curve."""
    if period is not None:
        return np.linspace(*limits, int(np.clip(np.ceil(period / h), 8, MOST)) + 1)
    begin, end = max(float(np.min(low)), limits[0]), min(float(np.max(high)), limits[1])
    count = int(np.clip(np.round((end - begin) / h), 4, MOST))
    h = (end - begin) / count
    nodes = list(np.linspace(begin, end, count + 1))
    if begin - limits[0] > NEAR * h:
        nodes.insert(0, max(begin - h, limits[0]))
    if limits[1] - end > NEAR * h:
        nodes.append(min(end + h, limits[1]))
    return np.array(nodes)


def _shares(nodes: Array, s: Array, half: Array, work: Array, period: float | None) -> Array:
    """int psi_i dV at the nodes; what lies beyond the last one belongs to it."""
    if period is not None:
        s, half, work = (np.concatenate([s - period, s, s + period]), np.tile(half, 3), np.tile(work, 3))
        near = (s + half > nodes[0]) & (s - half < nodes[-1])
        s, half, work = s[near], half[near], work[near]
    total, below = np.zeros(len(nodes)), np.zeros(len(nodes))
    for i, node in enumerate(nodes):
        x = np.clip((node - s + half) / (2.0 * half), 0.0, None)
        inside = np.minimum(x, 1.0)
        below[i] = work @ inside  # V
        total[i] = (work * 2.0 * half) @ (0.5 * inside**2 + (x - inside))  # W
    mean = np.diff(total) / np.diff(nodes)
    first, last = (below[0], below[-1]) if period is not None else (0.0, float(work.sum()))
    return np.append(mean, last) - np.insert(mean, 0, first)


def _areas(shape: Any, nodes: Array) -> Array:
    """int psi_i dA all around, at the nodes along the axis."""
    x, weight = np.polynomial.legendre.leggauss(GAUSS)
    h, t = np.diff(nodes), 0.5 * (x + 1.0)
    area = np.pi * h[:, None] * weight * shape.measure_at(nodes[:-1, None] + h[:, None] * t)
    return np.append((area * (1.0 - t)).sum(axis=1), 0.0) + np.insert((area * t).sum(axis=1), 0, 0.0)
