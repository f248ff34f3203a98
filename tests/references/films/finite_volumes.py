r"""A steady film of a journal on finite volumes: pressure and cavity volume at the cell centres.

The flow over each face of a cell, with the gap h_f in the face's middle and the cells i and j on both sides, is

    Q = U h_f b - U D_up b - h_f^3/(12 mu) (p_j - p_i)/d b,

b the length of the face, d the distance of the centres (half of it at an end, where p = 0), D_up the cavity volume of
the cell upstream. The flows out of a cell sum to zero. It shares only the law with the nodal formulation.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp

from references.films.complementarity import solve

Array = np.ndarray


@dataclass(frozen=True)
class VolumeFilm:
    """Force on the shaft [N] along and across the eccentricity, attitude [rad], largest pressure [Pa]."""

    along: float
    across: float
    largest: float

    @property
    def load(self) -> float:
        """[N]."""
        return float(np.hypot(self.along, self.across))

    @property
    def attitude(self) -> float:
        """Between the load and the line of centres [rad]."""
        return float(np.arctan2(self.across, -self.along))


def steady_journal(
    radius: float, length: float, clearance: float, viscosity: float, speed: float, eccentricity: float, *,
    columns: int, rows: int, mode: str, feed: float | None = None,
) -> VolumeFilm:  # fmt: skip
    """A shaft at `eccentricity` [-] towards theta = 0, rotating with `speed` [rad/s], on columns x rows cells; feed: an
    angle [rad]; the nearest face, over the whole length, has the pressure zero."""
    U, dx, dz = 0.5 * speed * radius, 2.0 * np.pi * radius / columns, length / rows
    turn = 2.0 * np.pi / columns

    def gap(theta: Array) -> Array:
        return clearance * (1.0 - eccentricity * np.cos(theta))

    number = np.arange(columns * rows).reshape(columns, rows)
    middle, face = turn * (np.arange(columns) + 0.5), turn * (np.arange(columns) + 1.0)
    h_face = np.repeat(gap(face), rows)  # between column j and the next
    one, other = number.ravel(), np.roll(number, -1, axis=0).ravel()
    conductance = h_face**3 / (12.0 * viscosity) / dx * dz
    sourced, carried = U * h_face * dz, np.full_like(h_face, U * dz)
    fed = np.zeros(columns, dtype=bool)
    if feed is not None:
        fed[np.argmin(np.abs(np.mod(face - feed + np.pi, 2.0 * np.pi) - np.pi))] = True
    fed = np.repeat(fed, rows)

    n = columns * rows
    inner = ~fed
    A = sp.coo_matrix(
        (
            np.concatenate([conductance[inner], conductance[inner], -conductance[inner], -conductance[inner],
                            2.0 * conductance[fed], 2.0 * conductance[fed]]),
            (np.concatenate([one[inner], other[inner], one[inner], other[inner], one[fed], other[fed]]),
             np.concatenate([one[inner], other[inner], other[inner], one[inner], one[fed], other[fed]])),
        ),
        shape=(n, n),
    ).tocsr()  # fmt: skip
    # along the axis: inner faces, and half a distance to the ends
    h_cell = np.repeat(gap(middle), rows).reshape(columns, rows)
    axial = h_cell**3 / (12.0 * viscosity) * dx / dz
    a, b, c = number[:, :-1].ravel(), number[:, 1:].ravel(), axial[:, :-1].ravel()
    ends, at_ends = np.concatenate([number[:, 0], number[:, -1]]), 2.0 * np.concatenate([axial[:, 0], axial[:, -1]])
    A = (
        A
        + sp.coo_matrix(
            (
                np.concatenate([c, c, -c, -c, at_ends]),
                (np.concatenate([a, b, a, b, ends]), np.concatenate([a, b, b, a, ends])),
            ),
            shape=(n, n),
        ).tocsr()
    )
    # the cavity volume moves with the oil; at a feed it is filled
    T = sp.coo_matrix(
        (
            np.concatenate([carried, -carried[inner]]),
            (np.concatenate([one, other[inner]]), np.concatenate([one, one[inner]])),
        ),
        shape=(n, n),
    ).tocsr()
    right = np.zeros(n)
    np.add.at(right, one, -sourced)
    np.add.at(right, other, sourced)
    state = solve(A, T, right, np.zeros(n, dtype=bool), np.zeros(n), mode=mode)
    p = state.pressure.reshape(columns, rows).sum(axis=1) * dx * dz
    return VolumeFilm(-float(p @ np.cos(middle)), -float(p @ np.sin(middle)), float(state.pressure.max()))
