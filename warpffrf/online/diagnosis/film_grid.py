r"""What the grid of a film leaves of its load, flow and friction: the same film on twice the rows, and on twice the
columns.

In the last state of a run the gap, its rate of filling and the sliding are held as they are at the film's own points,
and a Newton's method on the host balances the oil with hats of the grid and of two finer ones, whose places between
nodes that are held are held too. Hats err by the square of their spacing, so that of what doubling changes 4/3 is the
error; what the borders of voids add goes with the spacing, and is caught within a factor of two.

What is held is the gap: of a film that yields to its own pressure, and of one that carries a given load, this is more
than what its place and its pressures err by. Walls count as smooth.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import scipy.sparse as sp
from scipy.sparse.linalg import splu

from warpffrf.model.films import Film
from warpffrf.online.compile.films.bases import ACROSS, ALONG, Basis, basis_of
from warpffrf.online.diagnosis.film_hats import MOST_ITERATIONS, NO_VOID, SETTLED, transport
from warpffrf.online.engine import Engine
from warpffrf_kernels.films.sampling import FILLING, GAP, NORMAL

Array = np.ndarray
NOTED = 0.01  # of the load: more is worth a finer grid
OF_CHANGE = 4.0 / 3.0  # see the module
STAYS = 1e-3  # of the rate at which voids pass nodes: what they keep of where they were, which finer grids do not know
HELD = 0.999  # of a node between two that are held


@dataclass(frozen=True)
class FilmGridError:
    """Errors of the last state by the grid, as fractions: of the `load` (as a vector), of the oil that flows through,
    `flow`, and of the `torque` by shear; NaN where no finer film was found. rows, columns: parts of that of the load.
    """

    load: float
    flow: float
    torque: float
    rows: float
    columns: float

    @property
    def finer(self) -> str:
        """Along which coordinate the grid is coarse."""
        return "along" if self.rows > self.columns else "around"

    def note(self, film: Film) -> str:
        """The line for the report, "" where nothing was found or all is small."""
        if not max(self.load, self.flow, self.torque) > NOTED:
            return ""
        return (
            f"{film.label}: its grid of {film.grid.columns} columns and {film.grid.rows} rows errs by about "
            f"{self.load:.2g} of the load ({self.rows:.2g} by rows, {self.columns:.2g} by columns), {self.flow:.2g} of "
            f"the flow and {self.torque:.2g} of the torque, at a given gap; reduce with a finer mesh {self.finer}"
        )


def film_grid_errors(engine: Engine) -> dict[str, FilmGridError]:
    """By name, of films of hats, at the state of the last attempt of world 0."""
    films = enumerate(engine.scene.films)
    return {str(film.name): _error_of(engine, i, film) for i, film in films if film.evaluation == "semi"}


class _Finer:
    """A film on `by` = (columns, rows) times as many, 1 or 2 each."""

    feeds = ()

    def __init__(self, film: Film, by: tuple[int, int]) -> None:
        self.a, self.by, grid = film.a, by, film.grid
        self.periodic = grid.periodic
        z = self.nodes(np.broadcast_to(grid.z, (grid.columns, grid.rows)).copy())
        pitch = grid.pitch / by[0]
        self.grid = replace(grid, pitch=pitch, columns=len(z), z=z[0], columns_per_sector=1)
        self.theta = film.theta[0] + pitch * np.arange(len(z))
        held, given = film.held()
        self._held, self._given = self.nodes(held.astype(float)) > HELD, self.nodes(given)

    def nodes(self, field: Array) -> Array:
        """A field of the film's own nodes (columns, rows) at those of the finer grid, linear between."""
        for axis, times in enumerate(self.by):
            if times == 2:
                middle = 0.5 * (field + np.roll(field, -1, axis=axis))
                both = np.stack([field, middle], axis=axis + 1)
                field = both.reshape(*field.shape[:axis], -1, *field.shape[axis + 1 :])
                if axis == 1 or not self.periodic:
                    field = np.delete(field, -1, axis=axis)
        return field

    def points(self, field: Array) -> Array:
        """One of the film's own points (points, k) at those of the finer grid, by the polynomials through the points of
        each cell."""
        strips, k = len(self.theta) - (not self.periodic), field.shape[1]
        own = field.reshape(strips // self.by[0], ACROSS, -1, ALONG, k)
        around, along = (_through(n, times) for n, times in zip((ACROSS, ALONG), self.by, strict=True))
        found = np.einsum("sai,tbj,cirjk->csartbk", around, along, own)
        return found.reshape(-1, k)

    def held(self) -> tuple[Array, Array]:
        """As of a film."""
        return self._held, self._given


def _through(count: int, times: int) -> Array:
    """(times, count, count): values at Gauss points of each part of a cell, of the polynomial through those of all."""
    at = 0.5 * (np.polynomial.legendre.leggauss(count)[0] + 1.0)
    whole = np.vander(at, count)
    return np.stack([np.vander((part + at) / times, count) @ np.linalg.inv(whole) for part in range(times)])


def _error_of(engine: Engine, i: int, film: Film) -> FilmGridError:
    own, rows, columns = (_figures(engine, i, film, by) for by in ((1, 1), (1, 2), (2, 1)))
    if own is None or rows is None or columns is None:
        return FilmGridError(*[np.nan] * 5)
    by_rows, by_columns = (OF_CHANGE * (found - own) for found in (rows, columns))
    most = np.maximum(np.abs(own), np.finfo(float).tiny)
    load = np.linalg.norm(most[:3])
    flow, torque = np.abs(by_rows + by_columns)[3:5].max() / most[3:5].max(), abs((by_rows + by_columns)[5]) / most[5]
    parts = [float(np.linalg.norm(part[:3]) / load) for part in (by_rows + by_columns, by_rows, by_columns)]
    return FilmGridError(parts[0], float(flow), float(torque), *parts[1:])


def _figures(engine: Engine, i: int, film: Film, by: tuple[int, int]) -> Array | None:
    """Load (3,) [N], oil in through feeds and out at the ends [m3/s], shear around [N] of a film on a finer grid; None
    where it is not found."""
    films, state, scratch = engine.compiled.films, engine.state, engine.scratch
    functions, points = (
        slice(*(int(n) for n in getattr(films, f"{name}_start").numpy()[i : i + 2])) for name in ("function", "point")
    )
    finer, own = _Finer(film, by), basis_of(film)
    basis: Basis = basis_of(finer, "semi")  # type: ignore[arg-type]
    shape = film.grid.columns, film.grid.rows

    def nodes(values: Array) -> Array:
        return finer.nodes(values.reshape(shape)).ravel()

    line = scratch.film_line.numpy()[0, points]
    numbers = np.column_stack([line[:, int(GAP)], line[:, int(FILLING)] / own.weight, line[:, int(NORMAL) :][:, :3]])
    h, filling, *normal = finer.points(numbers).T
    of_nodes = scratch.film_carried.numpy()[0, functions]
    carried = np.column_stack([nodes(way) for way in of_nodes.T])
    void = state.film_void.numpy()[0, 0, functions]
    travels, may_void = film.cavitation == "jfo", film.cavitation in ("jfo", "reynolds")
    T = transport(basis, carried)
    passes = float(np.abs(carried).max()) / np.sqrt(basis.area.mean())  # 1/s: voids, from node to node
    a0 = float(scratch.film_rates.numpy()[0, 0])
    keeps = (min(a0, STAYS * passes) if passes > 0.0 else a0) * basis.area
    began, rate = np.zeros((2, basis.functions))
    if travels:
        refill = scratch.film_refill.numpy()[0, functions] - transport(own, of_nodes) @ void
        began, rate = nodes(void), nodes(np.divide(refill, own.area, out=np.zeros_like(void), where=own.area > 0.0))
    else:  # a slack: any size does
        T, keeps = 0.0 * T, np.maximum(keeps, np.abs(carried).max() * film.grid.pitch)
    place = np.repeat(np.arange(len(h)), basis.function.shape[1]), basis.function.ravel()
    value, x, z = (
        sp.csr_matrix((v.ravel(), place), shape=(len(h), basis.functions))
        for v in (basis.value, basis.around, basis.along)
    )
    w, u_x, u_z = basis.weight, *(value @ carried).T
    p = nodes(state.film_pressure.numpy()[0, 0, functions])
    p[basis.held] = basis.given[basis.held]
    full, D = basis.held | (p > 0.0) | (not may_void), np.where((p > 0.0) | basis.held, 0.0, began)
    free, settled = np.flatnonzero(~basis.held), False
    for _ in range(MOST_ITERATIONS):
        at = np.maximum(value @ p, 0.0)
        mu, r, p_x, p_z = film.oil.viscosity_at(at), film.oil.density_at(at), x @ p, z @ p
        k = h**3 / (12.0 * mu)
        rest = x.T @ (w * r * (k * p_x - h * u_x)) + z.T @ (w * r * (k * p_z - h * u_z)) + value.T @ (w * filling)
        rest -= basis.area * rate + keeps * (D - began) + T @ D
        if settled:
            break
        thinner = r * k * film.oil.viscosity_slope(at) / mu
        by_x = w * (film.oil.density_slope(at) * (k * p_x - h * u_x) - thinner * p_x)
        by_z = w * (film.oil.density_slope(at) * (k * p_z - h * u_z) - thinner * p_z)
        A = x.T @ (sp.diags(w * r * k) @ x + sp.diags(by_x) @ value)
        A = A + z.T @ (sp.diags(w * r * k) @ z + sp.diags(by_z) @ value)
        J = A @ sp.diags(full.astype(float)) - (T + sp.diags(keeps)) @ sp.diags((~full).astype(float))
        try:
            change = np.zeros(len(p))
            change[free] = splu(J.tocsc()[free][:, free]).solve(-rest[free])
        except RuntimeError:  # how SciPy tells that it is singular
            return None
        dp, dD = np.where(full, change, 0.0), np.where(full, 0.0, change)
        leaves = full & ~basis.held & may_void & (p + dp <= 0.0)
        enters = ~full & (D + dD < -NO_VOID * float(np.median(h)))
        p, D = np.where(leaves, 0.0, p + dp), np.where(enters, 0.0, D + dD)
        full = (full & ~leaves) | enters
        settled = not np.any(leaves | enters) and bool(np.abs(dp).max() <= SETTLED * np.abs(p).max(initial=1.0))
    else:
        return None
    here = value @ (np.maximum(p, 0.0) if film.cavitation == "half_sommerfeld" else p)
    shear = w @ (2.0 * mu * u_x / h * np.clip(1.0 - (value @ D) / h, 0.0, 1.0) + 0.5 * h * (x @ p))
    fed = basis.held & (finer.nodes(own.fed.reshape(shape).astype(float)).ravel() > 0.0)
    flows = rest[fed].sum(), -rest[basis.held & ~fed].sum()
    return np.array([*(w * here @ np.column_stack(normal)), *flows, shear])


def film_grid_notes(engine: Engine, found: dict[str, FilmGridError]) -> list[str]:
    """One note for each film whose grid is coarse."""
    films: list[Any] = [film for film in engine.scene.films if str(film.name) in found]
    return [note for film in films if (note := found[str(film.name)].note(film))]
