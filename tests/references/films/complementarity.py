r"""Pressure or cavity volume at every node: the linear complementarity problem of a film with given gap.

    A p - T D = r,      p >= 0,  D >= 0,  p_i D_i = 0       on free nodes; p given, D = 0 on fixed ones.

For a known set of full nodes it is linear, columns of A for these and of -T for the others. A full node with negative
pressure becomes cavitated, a cavitated one with negative D becomes full, until the set is stationary (a Newton
method on min(p, D); A is symmetric and positive definite, T an M-matrix). By `mode`:

    jfo                 as above
    reynolds            a slack s >= 0 instead of T D: dp/dn = 0 at the rupture, no mass-conserving reformation
    half_sommerfeld     the whole film solved, negative pressures then set to zero: no rupture condition
    full_sommerfeld     the whole film
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import scipy.sparse as sp
from scipy.sparse.linalg import splu

from warpffrf.model.errors import InputError, unknown_name

Array = np.ndarray
Sparse = Any  # a matrix or array of scipy.sparse, which have no type in common
MODES = ("jfo", "reynolds", "half_sommerfeld", "full_sommerfeld")
MOST_SWEEPS = 400
NO_VOID = 1e-13  # of the largest cavity volume: nodes with neither pressure nor cavity would change sides for ever


@dataclass(frozen=True)
class FilmState:
    """pressure [Pa], cavity volume `void` [m] and full (bool) of all nodes; sweeps: number of checks of the set."""

    pressure: Array
    void: Array
    full: Array
    sweeps: int


def solve(
    A: Sparse, T: Sparse, right: Array, held: Array, pressure: Array, *, mode: str = "jfo",
    full: Array | None = None,
) -> FilmState:  # fmt: skip
    """The state of all nodes; `held` (nodes,) bool have the `pressure` (nodes,) given, `full`: an initial set. Raises
    `InputError` for an unknown mode and if sets do not become stationary in `MOST_SWEEPS`."""
    if mode not in MODES:
        raise unknown_name("film: cavitation", mode, MODES)
    free = np.flatnonzero(~held)
    p, D, known = np.where(held, pressure, 0.0), np.zeros(len(held)), np.ones(len(held), dtype=bool)
    matrix = A[free][:, free].tocsc()
    rest = (right - A @ p)[free]
    if mode in ("half_sommerfeld", "full_sommerfeld"):
        p[free] = splu(matrix).solve(rest)
        return FilmState(np.maximum(p, 0.0) if mode == "half_sommerfeld" else p, D, known, 1)
    carried = sp.identity(len(free), format="csc") if mode == "reynolds" else T[free][:, free].tocsc()
    on = np.ones(len(free), dtype=bool) if full is None else full[free].copy()
    for sweep in range(1, MOST_SWEEPS + 1):
        columns = matrix @ sp.diags(on.astype(float)) - carried @ sp.diags((~on).astype(float))
        size = np.asarray(abs(columns).max(axis=0).todense()).ravel()  # of p and D they differ by 1e12
        found = splu((columns @ sp.diags(1.0 / size)).tocsc()).solve(rest) / size
        least = NO_VOID * np.abs(found[~on]).max(initial=0.0)
        new = np.where(on, found > 0.0, found < -least)
        if np.array_equal(new, on):
            p[free], D[free] = np.where(on, found, 0.0), np.where(on, 0.0, found)
            known[free] = on
            return FilmState(p, np.zeros_like(D) if mode == "reynolds" else D, known, sweep)
        on = new
    raise InputError(f"film: pressure and void do not settle in {MOST_SWEEPS} sweeps; refine the grid or the step")
