r"""Functions of the pressure of a film, and the points where its equations are evaluated.

*Nodes* ("full"): one function per node of the grid, each with its own cavity fraction; Gauss points, `ACROSS` x `ALONG`
in each cell, on the true surface.

*Strips* ("reduced"): circumferential nodal functions times axial polynomials, with zeta from -1 to 1 between the ends,

    phi_jm = psi_j(theta) (1 - zeta^2) (zeta^m - c_m),

which are zero at both ends; c_0 = 0, the others make the axial mean of all but m = 0 zero. So the cavity fraction of a
column, constant over the width, is the multiplier of a nonnegative mean pressure: it enters only the equation of m = 0.
Few Gauss points per strip between columns, one around and two along for each power.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import scipy.sparse as sp

from warpffrf.model.films import Film
from warpffrf.model.reduced.contact_grid import cell_edges
from warpffrf.model.reduced.contact_surface import ContactSurface

Array = np.ndarray
ACROSS, ALONG = 3, 2  # Gauss points of a cell: h^3 of a cell's gap and its squared slopes


@dataclass(frozen=True)
class Basis:
    """theta, z, weight [m2] (points,); of the functions at a point (points, some): number, -1 for none, value, slopes
    [1/m], and the part of its cavity fraction there; nodes at a point (points, 4) and their values. Of the functions:
    to_hats (nodes, functions), held and given [Pa], fed by a feed, whether it may cavitate, where its cavity fraction
    is (theta, z), its area [m2], neighbours around and along, -1 for none, and widths of the faces to the next [m]. Of
    the nodes: functions there, their values, and the one whose cavity fraction is there.
    """

    theta: Array
    z: Array
    weight: Array
    function: Array
    value: Array
    around: Array
    along: Array
    void: Array
    grid_node: Array
    between: Array
    to_nodes: Any
    held: Array
    given: Array
    fed: Array
    voids: Array
    at: Array
    area: Array
    neighbours: dict[str, Array]
    node_support: Array
    node_value: Array
    node_function: Array

    @property
    def functions(self) -> int:
        """Their number."""
        return len(self.given)


def basis_of(film: Film, quadrature: str | None = None) -> Basis:
    """The basis for the given quadrature of a film, its own or another one."""
    return _strips(film, film.axial_degrees) if (quadrature or film.quadrature) == "reduced" else _grid_nodes(film)


def radius_at(surface: ContactSurface, z: Array) -> Array:
    """R(z) [m], of a plane 1."""
    return np.broadcast_to(np.asarray(surface.shape.radius_at(z), dtype=float), np.shape(z))


def stretch_at(surface: ContactSurface, z: Array) -> Array:
    """Arc length of the meridian per z."""
    return np.sqrt(1.0 + np.broadcast_to(np.asarray(surface.shape.slope_at(z), dtype=float), np.shape(z)) ** 2)


def _fed(film: Film) -> Array:
    """Nodes (columns, rows) at feed pressure."""
    found = np.zeros((film.grid.columns, film.grid.rows), dtype=bool)
    for feed in film.feeds:
        found |= feed.nodes(film.a.surface.shape, film.theta, film.grid.z)[0]
    return found


def _cells(film: Film, fraction: Array, z: Array) -> tuple[Array, Array, Array, Array]:
    """For points at `fraction` (k,) of the pitch after each column that has a next one, and z (k,): theta, z, nodes (4)
    and their values, column by column.
    """
    grid = film.grid
    columns = np.arange(grid.columns if grid.periodic else grid.columns - 1)[:, None]
    row = np.clip(np.searchsorted(grid.z, z, side="right") - 1, 0, grid.rows - 2)
    v = (z - grid.z[row]) / np.diff(grid.z)[row]
    left, right = columns * grid.rows + row, (columns + 1) % grid.columns * grid.rows + row
    grid_node = np.stack([left, left + 1, right, right + 1], axis=-1).reshape(-1, 4)
    u = fraction
    between = np.stack([(1 - u) * (1 - v), (1 - u) * v, u * (1 - v), u * v], axis=-1)
    theta = (film.theta[columns] + fraction * grid.pitch).ravel()
    return theta, np.tile(z, len(columns)), grid_node, np.tile(between, (len(columns), 1))


def _grid_nodes(film: Film) -> Basis:
    surface, grid = film.a.surface, film.grid
    grid_nodes = grid.columns * grid.rows
    a, wa = np.polynomial.legendre.leggauss(ACROSS)
    b, wb = np.polynomial.legendre.leggauss(ALONG)
    dz = np.diff(grid.z)
    rows = np.arange(grid.rows - 1)
    row = np.tile(np.repeat(rows, ALONG), ACROSS)
    a, b = np.repeat(0.5 * (a + 1.0), ALONG * len(rows)), np.tile(0.5 * (b + 1.0), ACROSS * len(rows))
    w = 0.25 * (wa[:, None, None] * np.ones(grid.rows - 1)[None, :, None] * wb[None, None, :]).ravel() * dz[row]
    theta, z, grid_node, between = _cells(film, a, grid.z[row] + b * dz[row])
    strips = len(theta) // len(a)
    radius, stretch = radius_at(surface, z), stretch_at(surface, z)
    by_a = np.stack([-(1 - b), -b, 1 - b, b], axis=1)
    by_b = np.stack([-(1 - a), 1 - a, -a, a], axis=1) / dz[row][:, None]
    held, given = film.held()
    number = np.arange(grid_nodes)
    return Basis(
        theta, z, np.tile(w, strips) * grid.pitch * radius * stretch, grid_node, between,
        np.tile(by_a, (strips, 1)) / (radius * grid.pitch)[:, None], np.tile(by_b, (strips, 1)) / stretch[:, None],
        between, grid_node, between, sp.identity(grid_nodes, format="csr"), held.ravel(), given.ravel(),
            _fed(film).ravel(),
        np.ones(grid_nodes, dtype=bool), np.stack([np.repeat(film.theta, grid.rows), np.tile(grid.z, grid.columns)],
            axis=1),
        *_boxes(film), number[:, None], np.ones((grid_nodes, 1)), number,
    )  # fmt: skip


def _boxes(film: Film) -> tuple[Array, dict[str, Array]]:
    """Areas of the boxes around nodes, their neighbours, and the widths of the faces."""
    surface, grid = film.a.surface, film.grid
    columns, rows = grid.columns, grid.rows
    number = np.arange(columns * rows).reshape(columns, rows)
    edges = cell_edges(grid.z)
    wide = np.full(columns, grid.pitch)
    if not grid.periodic:
        wide[[0, -1]] *= 0.5
    middle = 0.5 * (edges[1:] + edges[:-1])
    length = np.diff(edges) * stretch_at(surface, middle)
    next_along, before_along = np.full_like(number, -1), np.full_like(number, -1)
    next_along[:, :-1], before_along[:, 1:] = number[:, 1:], number[:, :-1]
    face_along = np.zeros((columns, rows))
    face_along[:, :-1] = wide[:, None] * radius_at(surface, edges[1:-1])[None, :]
    neighbours = {
        **_around(number, grid.periodic), "next_along": next_along.ravel(), "before_along": before_along.ravel(),
        "face_around": np.tile(length, columns), "face_along": face_along.ravel(),
    }  # fmt: skip
    return np.outer(wide, length * radius_at(surface, middle)).ravel(), neighbours


def _around(number: Array, periodic: bool) -> dict[str, Array]:
    """Circumferential neighbours of functions numbered (columns, some)."""
    after, before = np.roll(number, -1, axis=0), np.roll(number, 1, axis=0)
    if not periodic:
        after[-1], before[0] = -1, -1
    return {"next_around": after.ravel(), "before_around": before.ravel()}


def _strips(film: Film, powers: tuple[int, ...]) -> Basis:
    surface, grid = film.a.surface, film.grid
    columns, n = grid.columns, len(powers)
    middle, half = 0.5 * float(grid.z[0] + grid.z[-1]), 0.5 * float(grid.z[-1] - grid.z[0])
    zeta, w = np.polynomial.legendre.leggauss(2 * n)
    mean = np.array([0.0 if m % 2 else 2.0 / (m + 1) - 2.0 / (m + 3) for m in powers])  # of (1 - zeta^2) zeta^m
    even = np.eye(n)
    even[0, 1:] = -mean[1:] / mean[0]

    def along(at: Array) -> Array:
        return ((1.0 - at**2)[:, None] * at[:, None] ** np.array(powers)[None, :]) @ even

    slopes = np.stack([m * zeta ** max(m - 1, 0) * (m > 0) - (m + 2) * zeta ** (m + 1) for m in powers], axis=1) @ even
    theta, z, grid_node, between = _cells(film, np.full(2 * n, 0.5), middle + half * zeta)
    strips = len(theta) // (2 * n)
    radius, stretch = radius_at(surface, z), stretch_at(surface, z)
    first = np.repeat(np.arange(strips), 2 * n)
    number = np.arange(n)
    function = np.concatenate([first[:, None] * n + number, (first[:, None] + 1) % columns * n + number], axis=1)
    values, rises = np.tile(along(zeta), (strips, 1)), np.tile(slopes, (strips, 1))
    slope = values / (radius * grid.pitch)[:, None]
    steep = rises / (half * stretch)[:, None]
    alone = np.zeros((strips * 2 * n, n))
    alone[:, 0] = 0.5
    at_rows = along((grid.z - middle) / half)
    held_nodes, given_nodes = film.held()
    held = np.all(held_nodes, axis=1)
    # a prescribed column: the profile nearest to the pressures of its nodes
    fit = np.linalg.lstsq(at_rows, given_nodes[held].T, rcond=None)[0].T if np.any(held) else np.zeros((0, n))
    given = np.zeros((columns, n))
    given[held] = fit
    fed = np.repeat(held & _fed(film).any(axis=1), n)
    wide = np.full(columns, grid.pitch)
    if not grid.periodic:
        wide[[0, -1]] *= 0.5
    area, voids = np.zeros((columns, n)), np.zeros((columns, n), dtype=bool)
    area[:, 0] = wide * half * mean[0] * float(radius_at(surface, np.array([middle]))[0])
    voids[:, 0] = True
    none = np.full((columns, n), -1)
    neighbours = {"next_along": none.ravel(), "before_along": none.ravel(), "face_along": np.zeros(columns * n)}
    neighbours["face_around"] = np.full(columns * n, half * mean[0])
    heads = np.arange(columns)[:, None] * n
    for name, others in _around(heads, grid.periodic).items():
        table = none.copy()
        table[:, 0] = others
        neighbours[name] = table.ravel()
    owner = np.repeat(np.arange(columns), grid.rows)[:, None] * n + number
    return Basis(
        theta, z, np.tile(w, strips) * half * grid.pitch * radius * stretch, function,
        0.5 * np.concatenate([values, values], axis=1), np.concatenate([-slope, slope], axis=1),
        0.5 * np.concatenate([steep, steep], axis=1), np.concatenate([alone, alone], axis=1), grid_node, between,
        sp.kron(sp.identity(columns), at_rows).tocsr(), np.repeat(held, n), given.ravel(), fed, voids.ravel(),
        np.stack([np.repeat(film.theta, n), np.full(columns * n, middle)], axis=1), area.ravel(), neighbours,
        owner, np.tile(at_rows, (columns, 1)), np.repeat(np.arange(columns) * n, grid.rows),
    )  # fmt: skip
