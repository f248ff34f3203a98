r"""Grid errors of the load, flow and friction of a film: the same film on twice the rows, and on twice the columns.

In the last state of a run the gap, its rate of filling and the sliding are fixed at the film's own points. Newton's
method on the host balances the oil with nodes of the grid and of two finer ones, whose nodes between prescribed nodes
are prescribed, too. The error of nodes falls with the square of their spacing, so that 4/3 of the change by doubling is
the error; the borders of cavities add an error proportional to the spacing, which is estimated within a factor of two.

The gap is fixed. For a film that deforms under its own pressure, or carries a given load, the estimate therefore
exceeds the error of its position and pressures. Walls count as smooth.

Film nodes. A film of all nodes in a fixed state, on the host: the reference for a few axial profiles.

Given are the positions and velocities of both bodies, the global modes of the first, and the rates of the step,
delta_t(r h) at points and delta_t D at nodes (docstring of `films.sampling`). Unknown are the pressures p of the nodes
that are full and the cavity fractions D of the others,

    R_i = sum_k [psi_i,x f_x + psi_i,z f_z + psi_i delta_t(r h)] - m_i (delta_t D_i + a_0 (D_i - D_i,0)) - (T D)_i = 0,

f = r (k grad p - h U), h including the opening G p by p. Newton's method makes one change of the set per iteration and
eliminates cavity fractions first: T between cavitated nodes is sparse. The rates are fixed so far that the film is as
slow as in the run: D_0 are the cavity fractions at the end of the step.

*At the same force*: the second body is displaced along `ways` until the force is a given one, which adds as many
unknowns d and the equations F = F_0, with dh = -n.way dd. Of F only the pressures are differentiated; shear is c/R of
it.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
import scipy.linalg as la
import scipy.sparse as sp
from scipy.sparse.linalg import splu

from warpffrf.model.films import Film
from warpffrf.online.compile.compliance_tables import node_gram
from warpffrf.online.compile.films.bases import ACROSS, ALONG, Basis, basis_of
from warpffrf.online.engine import Engine
from warpffrf.online.history.films import narrowest
from warpffrf_kernels.films.sampling import FILLING, GAP, NORMAL

Array = np.ndarray
NOTED = 0.01  # of the load: above it a finer grid is recommended
OF_CHANGE = 4.0 / 3.0  # see the module
# of the rate at which cavity fractions pass nodes: memory of their position, which finer grids do not have
STAYS = 1e-3
HELD = 0.999  # of a node between two prescribed ones


@dataclass(frozen=True)
class FilmGridError:
    """Grid errors of the last state, as fractions: of the `load` (as a vector), of the oil that flows through, `flow`,
    and of the `torque` by shear; NaN where no finer film was found. rows, columns: parts of that of the load.
    """

    load: float
    flow: float
    torque: float
    rows: float
    columns: float

    @property
    def finer(self) -> str:
        """Coordinate along which the grid is coarse."""
        return "along" if self.rows > self.columns else "around"

    def note(self, film: Film) -> str:
        """The line for the report, "" where nothing was found or all errors are small."""
        if not max(self.load, self.flow, self.torque) > NOTED:
            return ""
        return (
            f"{film.label}: its grid of {film.grid.columns} columns and {film.grid.rows} rows has an error of about "
            f"{self.load:.2g} of the load ({self.rows:.2g} by rows, {self.columns:.2g} by columns), {self.flow:.2g} of "
            f"the flow and {self.torque:.2g} of the torque, at a given gap; reduce with a finer mesh {self.finer}"
        )


def film_grid_errors(engine: Engine) -> dict[str, FilmGridError]:
    """Errors by name, of films of nodes, at the state of the last attempt of world 0."""
    films = enumerate(engine.scene.films)
    return {str(film.name): _error_of(engine, i, film) for i, film in films if film.quadrature == "full"}


class _Finer:
    """A film with `by` = (columns, rows) times as many, 1 or 2 each."""

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
        """Prescribed nodes, as of a film."""
        return self._held, self._given


def _through(count: int, times: int) -> Array:
    """(times, count, count): values at Gauss points of each part of a cell, of the polynomial through those of the
    cell.
    """
    at = 0.5 * (np.polynomial.legendre.leggauss(count)[0] + 1.0)
    whole = np.vander(at, count)
    return np.stack([np.vander((part + at) / times, count) @ np.linalg.inv(whole) for part in range(times)])


def _error_of(engine: Engine, i: int, film: Film) -> FilmGridError:
    own, rows, columns = (film_figures(engine, i, film, by) for by in ((1, 1), (1, 2), (2, 1)))
    if own is None or rows is None or columns is None:
        return FilmGridError(*[np.nan] * 5)
    by_rows, by_columns = (OF_CHANGE * (found - own) for found in (rows, columns))
    most = np.maximum(np.abs(own), np.finfo(float).tiny)
    load = max(float(np.linalg.norm(most[:3])), np.finfo(float).tiny)
    flow, torque = np.abs(by_rows + by_columns)[3:5].max() / most[3:5].max(), abs((by_rows + by_columns)[5]) / most[5]
    parts = [float(np.linalg.norm(part[:3]) / load) for part in (by_rows + by_columns, by_rows, by_columns)]
    return FilmGridError(parts[0], float(flow), float(torque), *parts[1:])


def film_figures(
    engine: Engine, i: int, film: Film, by: tuple[int, int], moved: tuple[Array, int] | None = None
) -> Array | None:
    """Load (3,) [N], oil in through feeds and out at the ends [m3/s], shear around [N], moment (3,) [N m] of the load
    about A's centre of mass, of a film on a finer grid; None where it is not found. moved: translation and rotation
    (6,) of A about this centre, in its axes, and whether it is a displacement [m, rad] (0) or a velocity [m/s, rad/s]
    (1); the film is then at rest otherwise."""
    films, state, scratch = engine.compiled.films, engine.state, engine.scratch
    functions, points = (
        slice(*(int(n) for n in getattr(films, f"{name}_start").numpy()[i : i + 2])) for name in ("function", "point")
    )
    finer, own = _Finer(film, by), basis_of(film)
    basis: Basis = basis_of(finer, "full")  # type: ignore[arg-type]
    shape = film.grid.columns, film.grid.rows

    def nodes(values: Array) -> Array:
        return finer.nodes(values.reshape(shape)).ravel()

    line = scratch.film_line.numpy()[0, points]
    numbers = np.column_stack([line[:, int(GAP)], line[:, int(FILLING)] / own.weight, line[:, int(NORMAL) :][:, :3]])
    h, filling, *normal = finer.points(numbers).T
    place = film.a.surface.shape.point(basis.theta, basis.z) - film.a.body.center_of_mass
    along_normal = np.concatenate([np.array(normal), np.cross(place, np.array(normal).T).T])  # (6, points)
    if moved is not None:
        opening = moved[0] @ along_normal
        h, filling = (h + opening, 0.0 * h) if moved[1] == 0 else (h, opening)
    of_nodes = scratch.film_carried.numpy()[0, functions]
    carried = np.column_stack([nodes(way) for way in of_nodes.T])
    void = state.film_void.numpy()[0, 0, functions]
    travels, may_void = film.cavitation == "jfo", film.cavitation in ("jfo", "reynolds")
    T = transport(basis, carried)
    # 1/s: transport of cavity fractions from node to node
    passes = float(np.abs(carried).max()) / np.sqrt(basis.area.mean())
    a0 = float(scratch.film_rates.numpy()[0, 0])
    keeps = (min(a0, STAYS * passes) if passes > 0.0 else a0) * basis.area
    began, rate = np.zeros((2, basis.functions))
    if travels and moved is not None:
        began, keeps = nodes(void), STAYS * passes * basis.area
    elif travels:
        refill = scratch.film_refill.numpy()[0, functions] - transport(own, of_nodes) @ void
        began, rate = nodes(void), nodes(np.divide(refill, own.area, out=np.zeros_like(void), where=own.area > 0.0))
    else:  # a slack: any size does
        T, keeps = 0.0 * T, np.maximum(keeps, np.abs(carried).max() * film.grid.pitch)
    entries = np.repeat(np.arange(len(h)), basis.function.shape[1]), basis.function.ravel()
    value, x, z = (
        sp.csr_matrix((v.ravel(), entries), shape=(len(h), basis.functions))
        for v in (basis.value, basis.around, basis.along)
    )
    w, u_x, u_z = basis.weight, *(value @ carried).T
    warm, thin = slice(*(int(n) for n in films.heat_start.numpy()[i : i + 2])), np.zeros(len(h))
    if warm.stop > warm.start:
        thin = value @ nodes(state.film_thinning.numpy()[0, warm])
    p = nodes(state.film_pressure.numpy()[0, 0, functions])
    p[basis.held] = basis.given[basis.held]
    full, D = basis.held | (p > 0.0) | (not may_void), np.where((p > 0.0) | basis.held, 0.0, began)
    free, settled = np.flatnonzero(~basis.held), False
    for _ in range(MOST_ITERATIONS):
        at = np.maximum(value @ p, 0.0)
        mu, r, p_x, p_z = film.oil.thinned(at, thin), film.oil.density_at(at), x @ p, z @ p
        k = h**3 / (12.0 * mu)
        rest = x.T @ (w * r * (k * p_x - h * u_x)) + z.T @ (w * r * (k * p_z - h * u_z)) + value.T @ (w * filling)
        rest -= basis.area * rate + keeps * (D - began) + T @ D
        if settled:
            break
        thinner = r * k * film.oil.viscosity_slope(at) / film.oil.viscosity_at(at)
        by_x = w * (film.oil.density_slope(at) * (k * p_x - h * u_x) - thinner * p_x)
        by_z = w * (film.oil.density_slope(at) * (k * p_z - h * u_z) - thinner * p_z)
        A = x.T @ (sp.diags(w * r * k) @ x + sp.diags(by_x) @ value)
        A = A + z.T @ (sp.diags(w * r * k) @ z + sp.diags(by_z) @ value)
        J = A @ sp.diags(full.astype(float)) - (T + sp.diags(keeps)) @ sp.diags((~full).astype(float))
        try:
            change = np.zeros(len(p))
            change[free] = splu(J.tocsc()[free][:, free]).solve(-rest[free])
        except RuntimeError:  # SciPy's error for a singular matrix
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
    wrench = along_normal @ (w * here)
    return np.array([*wrench[:3], *flows, shear, *wrench[3:]])


def film_grid_notes(engine: Engine, found: dict[str, FilmGridError]) -> list[str]:
    """One note for each film whose grid is coarse."""
    films: list[Any] = [film for film in engine.scene.films if str(film.name) in found]
    return [note for film in films if (note := found[str(film.name)].note(film))]


MOST_ITERATIONS = 30
SETTLED = 1e-4  # of the largest pressure: a last change that is a hundredth of the least error that is reported
CLOSEST = 0.2  # of the smallest gap: the least fraction that an iteration leaves
NO_VOID = 1e-13  # of the median gap: round-off of a cavity fraction


@dataclass(frozen=True)
class Pose:
    """Both bodies: axes in the world, position of A's centre of mass from B's [m]; velocities of these [m/s], angular
    velocities [rad/s], A's in its axes and B's in the world; A's rotation about its own axis that U has in addition to
    half of the sliding; global coordinates of A.
    """

    turn_a: Array
    turn_b: Array
    from_b: Array
    v_a: Array
    v_b: Array
    omega_a: Array
    omega_b: Array
    spin: Array
    q: Array

    def sliding(self, place: Array) -> Array:
        """(n, 3) m/s u_B - u_A at points (n, 3) of A from its centre of mass, in A's axes."""
        at_b = self.v_b + np.cross(self.omega_b, self.from_b + place @ self.turn_a.T)
        return (at_b - self.v_a) @ self.turn_a - np.cross(self.omega_a, place)

    def moved(self, way: Array) -> Pose:
        """With B moved by `way` (3,) [m]."""
        return replace(self, from_b=self.from_b - way)


@dataclass(frozen=True)
class Rates:
    """filling (points,) [m/s], void (nodes,) [m/s], and a_0 [1/s]."""

    filling: Array
    void: Array
    a0: float


@dataclass
class NodeState:
    """pressure [Pa], void [m], full of all nodes; whether it was found, the smallest gap [m] of the nodes, the force on
    A (3,) [N] in the world, oil in through feeds and out at the ends [m3/s].
    """

    pressure: Array
    void: Array
    full: Array
    found: bool = False
    smallest_gap: float = np.nan
    force: Array = field(default_factory=lambda: np.zeros(3))
    feed_flow: float = np.nan
    end_flow: float = np.nan

    @property
    def largest_pressure(self) -> float:
        """Pa, at a node."""
        return float(self.pressure.max())


def transport(basis: Basis, carried: Array) -> Any:
    """T (functions, functions) [m2/s] of cavity fractions transported with U (functions, 2) [m/s] upwind through the
    faces.
    """
    n = basis.functions
    T = sp.csr_matrix((n, n))
    for way, name in enumerate(("around", "along")):
        after, width = basis.neighbours[f"next_{name}"], basis.neighbours[f"face_{name}"]
        at = np.flatnonzero(after >= 0)
        to = after[at]
        flow = 0.5 * width[at] * (carried[at, way] + carried[to, way])
        ahead, back = np.maximum(flow, 0.0), np.maximum(-flow, 0.0)
        T = T + sp.csr_matrix(
            (
                np.concatenate([ahead, -ahead, back, -back]),
                (np.concatenate([at, to, to, at]), np.concatenate([at, at, to, to])),
            ),
            shape=(n, n),
        )
    return T


class NodeFilm:
    """All nodes of a film at all points, whatever its own quadrature is."""

    def __init__(self, film: Film) -> None:
        surface, body = film.a.surface, film.a.body
        self.film, self.basis = film, basis_of(film, "full")
        basis = self.basis
        columns = np.arange(film.grid.columns)
        self.opening = surface.compliance(columns) @ node_gram(surface, 1)[0]  # (nodes, nodes) m/Pa
        self.shape = np.asarray(surface.mode_normal).reshape(basis.functions, -1)
        points = len(basis.weight)
        at = (np.repeat(np.arange(points), basis.function.shape[1]), basis.function.ravel())
        self.value, self.x, self.z = (
            sp.csr_matrix((values.ravel(), at), shape=(points, basis.functions))
            for values in (basis.value, basis.around, basis.along)
        )
        self.place = surface.shape.point(basis.theta, basis.z) - body.center_of_mass
        self.at_grid_nodes = surface.shape.point(*basis.at.T) - body.center_of_mass
        self.around, self.along = _tangents(film, basis.theta, basis.z)
        self.ways_of_nodes = _tangents(film, *basis.at.T)
        self.form, self.form_of_nodes = film.gap_form(basis.theta, basis.z), film.gap_form(*basis.at.T)
        self.can_void = film.cavitation in ("jfo", "reynolds")
        self.travels = film.cavitation == "jfo"

    def seen(self, pose: Pose, place: Array) -> tuple[Array, Array]:
        """Gap (n,) [m] of the true shapes without the form of A at points (n, 3) of A, and its gradient (n, 3) in the
        world.
        """
        shape = self.film.b.surface.shape
        theta, z, distance = shape.chart((pose.from_b + place @ pose.turn_a.T) @ pose.turn_b + _center(self.film.b))
        return distance + self.film.second_form(theta, z), np.asarray(shape.normal(theta, z)) @ pose.turn_b.T

    def at_nodes(self, pose: Pose, pressure: Array) -> Array:
        """Gap (columns, rows) [m] at the nodes."""
        gap = (
            self.seen(pose, self.at_grid_nodes)[0] + self.form_of_nodes + self.opening @ pressure - self.shape @ pose.q
        )
        return gap.reshape(self.film.grid.columns, -1)

    def least(self, pose: Pose, pressure: Array) -> float:
        """The smallest of them."""
        return float(narrowest(self.at_nodes(pose, pressure)[None], periodic=self.film.grid.periodic)[0])

    def solve(
        self, pose: Pose, rates: Rates, start: NodeState, ways: Array | None = None, force: Array | None = None
    ) -> NodeState:
        """The film in a fixed state, from `start`; with `ways` (3, n), world directions along which the second body is
        displaced until the force along them is that of `force` (3,) [N].
        """
        ways = np.zeros((3, 0)) if ways is None or force is None else ways
        held = _Held(self, pose, rates, start, ways)
        free = np.flatnonzero(~self.basis.held)
        p, D, full = start.pressure.copy(), start.void.copy(), start.full.copy()
        at = self.basis.held
        p[at], D[at], full[at] = self.basis.given[at], 0.0, True
        shift, found = np.zeros(ways.shape[1]), False
        now = held.flow(p, D, shift)
        for _ in range(MOST_ITERATIONS):
            if not now.h.min() > 0.0:
                break
            change = held.change(now, p, free[full[free]], free[~full[free]], force)
            if change is None:
                break
            dp, dD, move = change
            dh = self.value @ (self.opening @ dp) + held.towards @ move
            part = 1.0
            if (now.h + dh).min() < CLOSEST * now.h.min():
                part = (1.0 - CLOSEST) * float(now.h.min()) / float((-dh).max())
            leaves = full & ~at & self.can_void & (p + dp <= 0.0)
            enters = ~full & (D + dD < -NO_VOID * float(np.median(now.h)))
            p, D, shift = p + part * dp, D + part * dD, shift + part * move
            p[leaves], full[leaves], D[enters], full[enters] = 0.0, False, 0.0, True
            now = held.flow(p, D, shift)
            settled = float(np.abs(dp).max()) <= SETTLED * float(np.abs(p).max())
            if part == 1.0 and settled and not np.any(leaves | enters):
                found = bool(now.h.min() > 0.0)
                break
        fed, end = self.basis.fed, at & ~self.basis.fed
        least = self.least(pose.moved(ways @ shift), p)
        return NodeState(p, D, full, found, least, now.force, float(now.rest[fed].sum()), -float(now.rest[end].sum()))


@dataclass(frozen=True)
class _Flow:
    """For pressures and cavity fractions: gap [m], slopes [Pa/m], viscosity [Pa s], r, their derivatives by pressure,
    flows over r [m2/s] and k at points; R of nodes [m3/s]; the force on A (3,) [N], world.
    """

    h: Array
    p_x: Array
    p_z: Array
    r: Array
    thick: Array
    stiff: Array
    flow_x: Array
    flow_z: Array
    k: Array
    rest: Array
    force: Array


class _Held:
    """Constants of the solution of a film."""

    def __init__(self, of: NodeFilm, pose: Pose, rates: Rates, start: NodeState, ways: Array) -> None:
        basis = of.basis
        self.of, self.pose, self.rates, self.ways = of, pose, rates, ways
        axis_point = of.film.a.surface.shape.axis_point - _center(of.film.a)
        self.slide = pose.sliding(of.place)
        carried = 0.5 * self.slide + np.cross(pose.spin, of.place - axis_point)
        self.u_x, self.u_z = (_along(carried, way) for way in (of.around, of.along))
        at_grid_nodes = 0.5 * pose.sliding(of.at_grid_nodes) + np.cross(pose.spin, of.at_grid_nodes - axis_point)
        self.T = transport(basis, np.stack([_along(at_grid_nodes, way) for way in of.ways_of_nodes], axis=1))
        self.keeps = rates.a0 * basis.area
        if not of.travels:  # a slack: any size does
            self.T = sp.csr_matrix(self.T.shape)
            self.keeps = np.maximum(self.keeps, np.abs(self.u_x).max() * of.film.grid.pitch)
        without = basis.held | (not of.travels)
        self.began, self.rate = (np.where(without, 0.0, values) for values in (start.void, rates.void))
        opened, self.normal = of.seen(pose, of.place)
        self.opened = opened + of.form - of.value @ (of.shape @ pose.q)
        self.towards = -self.normal @ ways

    def flow(self, p: Array, D: Array, shift: Array) -> _Flow:
        """Flows of pressures and cavity fractions, with the second body displaced by `shift` (n,) [m] along the
        ways.
        """
        of, w, oil = self.of, self.of.basis.weight, self.of.film.oil
        h = self.opened + self.towards @ shift + of.value @ (of.opening @ p)
        p_x, p_z, here = of.x @ p, of.z @ p, of.value @ p
        at = np.maximum(here, 0.0)
        mu, r = oil.viscosity_at(at), oil.density_at(at)
        k = h**3 / (12.0 * mu)
        flow_x, flow_z = k * p_x - h * self.u_x, k * p_z - h * self.u_z
        rest = of.x.T @ (w * r * flow_x) + of.z.T @ (w * r * flow_z) + of.value.T @ (w * self.rates.filling)
        rest -= of.basis.area * self.rate + self.keeps * (D - self.began) + self.T @ D
        drag = mu * np.clip(1.0 - (of.value @ D) / h, 0.0, 1.0) / h
        shear = sum(
            (w * (drag * _along(self.slide, way) + 0.5 * h * slope)) @ way
            for way, slope in ((of.around, p_x), (of.along, p_z))
        )
        force = (w * here) @ self.normal + self.pose.turn_a @ np.asarray(shear)
        thick, stiff = oil.viscosity_slope(at) / mu, oil.density_slope(at)
        return _Flow(h, p_x, p_z, r, thick, stiff, flow_x, flow_z, k, rest, force)

    def change(
        self, now: _Flow, p: Array, wet: Array, dry: Array, force: Array | None
    ) -> tuple[Array, Array, Array] | None:
        """Newton's increments of pressures, cavity fractions and the displacement of the second body; None of a
        singular system.
        """
        of, w, n = self.of, self.of.basis.weight, len(p)
        by_gap = of.x.T @ sp.diags(w * now.r * (3.0 * now.k / now.h * now.p_x - self.u_x))
        by_gap = (by_gap + of.z.T @ sp.diags(w * now.r * (3.0 * now.k / now.h * now.p_z - self.u_z))).tocsr()
        A = of.x.T @ sp.diags(w * now.r * now.k) @ of.x + of.z.T @ sp.diags(w * now.r * now.k) @ of.z
        if np.any(now.thick) or np.any(now.stiff):
            thinner = now.r * now.k * now.thick
            A = A + of.x.T @ sp.diags(w * (now.stiff * now.flow_x - thinner * now.p_x)) @ of.value
            A = A + of.z.T @ sp.diags(w * (now.stiff * now.flow_z - thinner * now.p_z)) @ of.value
        A, by_shape_functions, by_way = A.tocsr(), by_gap @ of.value, by_gap @ self.towards
        opening = of.opening[:, wet]

        def lines(at: Array) -> Array:
            """J of wet columns, then right-hand sides."""
            J = A[at][:, wet].toarray() + by_shape_functions[at] @ opening
            return np.concatenate([J, -now.rest[at][:, None], -by_way[at]], axis=1)

        whole, below, count = lines(wet), lines(dry), len(wet)
        if len(dry):
            M = -(self.T + sp.diags(self.keeps)).tocsr()
            try:
                below = splu(M[dry][:, dry].tocsc()).solve(below)
            except RuntimeError:  # SciPy's error for a singular matrix
                return None
            whole = whole - M[wet][:, dry] @ below
        try:
            x = la.solve(whole[:, :count], whole[:, count:], check_finite=False)
            move = np.zeros(self.ways.shape[1])
            if len(move) and force is not None:
                lever = (of.value.T @ (w[:, None] * (self.normal @ self.ways)))[wet]  # force of pressures
                move = la.solve(lever.T @ x[:, 1:], (force - now.force) @ self.ways - lever.T @ x[:, 0])
        except la.LinAlgError:
            return None
        dp, dD = np.zeros(n), np.zeros(n)
        dp[wet] = x[:, 0] + x[:, 1:] @ move
        dD[dry] = below[:, count] + below[:, count + 1 :] @ move - below[:, :count] @ dp[wet]
        return dp, dD, move


def _along(vectors: Array, ways: Array) -> Array:
    return np.einsum("ij,ij->i", vectors, ways)


def _center(port: Any) -> Array:
    return np.asarray(getattr(port.body, "center_of_mass", np.zeros(3)))


def _tangents(film: Film, theta: Array, z: Array) -> tuple[Array, Array]:
    """Unit vectors (n, 3) of A along theta, for either side, and along z."""
    shape = film.a.surface.shape
    side = 1.0 if shape.profile().planar else shape.side
    around = side * np.broadcast_to(np.asarray(shape.around(theta)), (len(theta), 3))
    return around, np.broadcast_to(np.asarray(shape.along(theta, z)), (len(theta), 3))
