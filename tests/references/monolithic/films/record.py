"""Saved results of a film: its force, its sums, and its fields at the nodes of the grid."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from references.monolithic.films.film import FilmData, FilmState

Array = np.ndarray
FILM_FIELDS = ("pressure", "gap", "void")
SUMS = (
    "smallest_gap", "largest_pressure", "pressure_loss", "friction_power", "feed_flow", "end_flow", "void_fraction",
    "oil_volume",
)  # fmt: skip
FILM_NUMBERS = 9 + len(SUMS)


@dataclass(frozen=True, eq=False)
class FilmRow:
    """numbers (FILM_NUMBERS,): force on A, moments on A and B about their centres of mass, own axes, then `SUMS`;
    fields (nodes,) by name."""

    numbers: Array
    fields: dict[str, Array]


def film_row(film: FilmState, void: Array) -> FilmRow:
    """Of a film at a step's end; void (functions,) [m]: cavity volume, unchanged by a tiny step of the start."""
    data, b, x = film.data, film.data.basis, film.x
    w, f, h, s = b.weight, film.fluid, film.gap, film.sight
    force = film.total[:3]
    moments = film.total[3:6]
    second = film.total[9:12] if data.b >= 0 else _about_origin(film)
    refill = film.refill(film.through)
    pushed = np.maximum(x.pressure, 0.0) if data.half else x.pressure
    loss = w @ (h**3 / (12.0 * f.viscosity) * np.sum(f.slope**2, axis=1))
    loss -= pushed @ refill + x.pressure[b.held] @ film.rest[b.held]
    space, empty = float(w @ h), float(b.area @ void)
    sums = [
        h.min(), x.pressure.max(), loss, w @ (film.sliding(h) * np.sum(s.slide**2, axis=1)),
        film.rest[b.held & b.fed].sum(), -film.rest[b.held & ~b.fed].sum(), empty / space, space - empty,
    ]  # fmt: skip
    sight = data.sight(film.pose, data.grid_nodes, film.rates.static)
    fields = {
        "pressure": b.to_grid @ x.pressure,
        "gap": sight.distance + data.node_form - film.displacement,
        "void": b.to_grid @ void,
    }
    return FilmRow(np.concatenate([force, moments, second, sums]), fields)


def _about_origin(film: FilmState) -> Array:
    """Moment (3,) on a second surface of the ground about the world's origin: the opposite of that on A."""
    force, A, r = film.total[:3], film.pose.A[0], film.pose.r[0]
    return -(A @ film.total[3:6] + np.cross(r, force))


def film_arrays(
    data: FilmData, numbers: Array, fields: list[Array], arms: list[Array], turns: list[Array]
) -> dict[str, Any]:
    """Fields of `FilmForces` of the rows (T, FILM_NUMBERS) of a film and its `fields` (T, nodes); of both bodies the
    vector (T, 3) [m] from the user origin to the centre of mass and the axes (T, 3, 3)."""
    T, force, grid = len(numbers), numbers[:, :3], data.film.grid
    first, second = (np.einsum("tij,tj->ti", turns[n], numbers[:, 3 + 3 * n : 6 + 3 * n]) for n in range(2))
    found = {name: numbers[:, 9 + n].copy() for n, name in enumerate(SUMS)}
    found |= {
        name: values.reshape(T, grid.columns, grid.rows) for name, values in zip(FILM_FIELDS, fields, strict=True)
    }
    return {
        "force": force.copy(), "torque": first + np.cross(arms[0], force),
        "torque_second": second - np.cross(arms[1], force), **found,
    }  # fmt: skip
