r"""Stress of one body over a run, at points named in its reduction.

    sigma(t) = sum_i modes_i q_i(t) + sum_pairs [T f(t) + W s(t)] + sum_i matched_i s_i(t) + sum_r membrane_r e_r(t)

with the global coordinates `q`; for every contact of the body, as first or second body, the outward nodal forces `f`
and, with friction, the tangential forces of the cells (`StressField`); for oil films on the body their pressure,
without their shear; for small-sliding contacts the forces `s` on their cells (`small_sliding_loads`); for a body with
membrane energy and stiffening its amplitudes `e_r = q.L_r q/2`. The tensor is in the axes of the body's user frame,
which rotates with the body; von Mises and principal stresses do not depend on axes. With membrane energy it is the
second Piola-Kirchhoff stress: along fibres of the undeformed body, which rotate with it, and equal to the Cauchy stress
except for a fraction of the size of strains.

On a contact's first body the traction is the nodal pressure of the contact; on the second it is that pressure projected
onto its own nodes. Both oscillate slightly from node to node about their weighted nodal mean, which contact results
report as pressure; a few elements below the surface this has decayed.

A pressure on cells that move with the patch, finer than the mesh, acts on the body through equivalent nodal forces, and
the stress near the patch is corrected by the half-space below it (`patch_stress`). Tractions on such cells are
distributed to the cells of the contact grid without correction: their stress is smeared over a node spacing near the
patch, and accurate a few spacings below.

Patch stress. Stress near a patch of cells that is finer than the mesh, which the contact grid does not resolve.

The cells act on a body through equivalent nodal forces (`normal_loads`): a load as wide as two columns of the grid,
whose stress the mesh has to a few tenths. The forces are spread to f over `SPREAD` spacings of the grid around each
node, a load that the mesh resolves; the remainder is computed in the half-space tangent to the body at the patch, cut
at its free ends,

    sigma = sigma_FE(f) + sigma_H(cells) - sigma_H(nodes of f),

both sigma_H in closed form (`half_space_stress`), the nodes with the pressure M^-1 f of the recovered stress
sigma_FE(f) at the surface. The difference between body and half-space is smooth over the depth of the material behind
the surface: f is spread by at most `WALL` of that depth. Far from the patch both sigma_H differ only by the second
moment of f; they are faded out.

Under the centre of long rollers and of balls the largest von Mises stress and its depth agree with Hertz to 0.5 % on
any mesh (docs/studies/coarse_points.md). In a roller of 20 mm, R = 50 mm, it is 1 % larger, because the free ends relax
sigma along the axis by a few percent of the peak pressure, which Hertz's theory does not include (`warpffrf demo
coarse-rollers`).

The half-space is flat: a point has as coordinates the arcs s along e_theta and t along the meridian from the centre of
the patch to its foot point, and its depth below the surface. On the second body the cells have the positions of the
first one's chart, rotated by the angle between the tangents of both. At a free end normal to the surface, image loads
behind it cancel the shear on the end plane; its normal stress remains: within the reach of the spread load from an end,
sigma along the meridian is partly that of plane strain.
"""

from __future__ import annotations

import logging
import os
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from warpffrf.model.arguments import Vector
from warpffrf.model.errors import InputError
from warpffrf.model.files.paths import size_text
from warpffrf.model.messages import reprs
from warpffrf.model.reduced.far_field import cutoff
from warpffrf.model.reduced.inertia import membrane_amplitudes, membrane_forms
from warpffrf.model.reduced.stress_field import StressField, max_shear, principal, rotated, von_mises
from warpffrf.online.history.history import History
from warpffrf.output.bodies.fatigue import SIGNED, StressCycles, rainflow, stress_csv
from warpffrf.output.bodies.half_space_stress import under_cells, under_nodes
from warpffrf.output.bodies.normal_loads import CellLoads, NormalLoads, SmallSlidingLoads, film_loads, normal_loads
from warpffrf.output.bodies.patch_on_skin import poses, tangential_forces
from warpffrf.output.geometry.places import grid_theta_offset, tangents, wrapped
from warpffrf.output.geometry.scene_view import SceneView

MUCH = 2e9  # byte; the size of larger results is logged before they are computed

log = logging.getLogger("warpffrf")


@dataclass(frozen=True, eq=False, repr=False)
class StressResult(reprs.Rows):
    """Stress at `points` (p, 3) [m, user frame, undeformed] at the saved steps `time` (T,) [s]; `tensor` (T, p, 6) [Pa]
    in the order xx, yy, zz, xy, yz, zx, axes of the body's user frame."""

    time: np.ndarray
    points: np.ndarray
    tensor: np.ndarray

    @cached_property
    def von_mises(self) -> np.ndarray:
        """Equivalent stress (T, p) [Pa]."""
        return von_mises(self.tensor)

    @cached_property
    def principal(self) -> np.ndarray:
        """Principal stresses (T, p, 3) [Pa], largest first."""
        return principal(self.tensor)

    @cached_property
    def max_shear(self) -> np.ndarray:
        """Largest shear stress (T, p) [Pa]."""
        return max_shear(self.tensor)

    def rainflow(self, point: int = 0, *, of: str | Vector = SIGNED) -> StressCycles:
        """Cycles of the history of the saved steps at a point, its index in `points`, by rainflow counting (ASTM
        E1049-85): ranges, means, counts.

        of: a component "xx" to "zx", "signed_von_mises" with the sign of the principal stress of largest magnitude, or
        a direction (3,) in the body's user frame, along which the normal stress counts. Peaks between saved steps are
        not seen. Raises `InputError` for an unknown point or quantity, and without the package rainflow (extra
        `fatigue`).
        """
        return rainflow(self, point, of)

    def to_csv(self, path: str | os.PathLike[str], *, overwrite: bool = False) -> Path:
        """Write the histories of all points, a row per saved step with six components for each, for programs of
        fatigue; returns the path. Raises `InputError` for a file that is not to be replaced."""
        return stress_csv(self, path, overwrite)


def surface_forces(loads: list[NormalLoads | PatchStress], i: int) -> dict[str, np.ndarray]:
    """Outward nodal forces [N] on each loaded contact surface of a body, by name, summed over the `loads` of its
    contacts at saved step `i`."""
    found: dict[str, np.ndarray] = {}
    for load in loads:
        forces, name = load.forces(i), load.surface.name
        found[name] = found[name] + forces if name in found else forces
    return found


def tangential_surface_forces(history: History, view: SceneView, body: str, i: int) -> dict[str, np.ndarray]:
    """Tangential forces (2, columns, rows) [N] on each contact surface of `body` with friction, summed over its
    contacts, at saved step `i`; see `patch_on_skin`."""
    found: dict[str, np.ndarray] = {}
    for pair in view.pairs.values():
        contact = history.contacts[pair.name]
        if body not in (pair.first_body.name, pair.second_body.name) or getattr(contact, "friction", None) is None:
            continue
        first = pair.first_body.name == body
        name = pair.first_surface_name if first else pair.second_surface_name
        forces = tangential_forces(pair, contact, history.bodies, i, first=first)
        found[name] = found[name] + forces if name in found else forces
    return found


def stress_field(view: SceneView, body: str, points: str) -> StressField:
    """The recovery called `points` of the body; raises `InputError` naming the bodies, or the available names."""
    if body not in view.bodies:
        known = ", ".join(f"'{n}'" for n in view.bodies) or "none"
        raise InputError(f"the result has no body called '{body}'; it has: {known}")
    reduced = view.bodies[body].reduced
    if reduced is None:
        raise InputError(f"body '{body}' is rigid and has no stress; add it as a flexible body, made by reduce(...)")
    if not isinstance(points, str) or points not in reduced.stress:
        known = ", ".join(f"'{n}'" for n in reduced.stress) or "none"
        raise InputError(
            f"body '{body}' has no stress points called {points!r}; it has: {known}. Name them when it is reduced: "
            "reduce(..., stress={name: points})"
        )
    if view.expands(body):
        raise InputError(
            f"body '{body}' has a thermal load: its stress is not known, because part of its strain is expansion; take "
            "the stress due to the other loads from a run without forces.ThermalLoad"
        )
    return reduced.stress[points]


class BodyStress:
    """Stress of one body at the `points` named in its reduction, one saved step at a time. Raises `InputError` as
    `stress_field`."""

    def __init__(self, history: History, view: SceneView, body: str, points: str) -> None:
        self.history, self.view, self.body = history, view, body
        self.field = stress_field(view, body, points)
        self._squares = membrane_forms(view.bodies[body])
        walls = view.bodies[body].reduced.provenance.get("contact_walls", {})
        self._loads: list[NormalLoads | PatchStress] = []
        for pair in view.pairs.values():
            if body in (pair.first_body.name, pair.second_body.name):
                load = normal_loads(pair, history, first=pair.first_body.name == body)
                is_fine = isinstance(load, CellLoads)
                self._loads.append(PatchStress(load, self.field, walls.get(load.surface.name)) if is_fine else load)
        self._loads += film_loads(view.films.values(), history, body)
        self._small_sliding = SmallSlidingLoads(history, view, body)

    def tensor(self, i: int) -> np.ndarray:
        """Stress (p, 6) [Pa] in the order xx, yy, zz, xy, yz, zx, axes of the body's user frame, at saved step `i`."""
        modal, loads = self.history.bodies[self.body].modal[i], self._loads
        rubbing = tangential_surface_forces(self.history, self.view, self.body, i)
        stretched = None if self._squares is None else membrane_amplitudes(self._squares, modal)
        tensor = self.field.evaluate(modal, surface_forces(loads, i), rubbing, self._small_sliding.forces(i), stretched)
        for load in loads:
            if isinstance(load, PatchStress):
                tensor = tensor + load.at(i, load.forces(i))
        return tensor


def stress_result(
    result: Any, body: str, points: str, rows: Sequence[int] | np.ndarray | None, only: Sequence[int] | None
) -> StressResult:
    """Stress of `body` at the `points` named in its reduction, at the saved steps `rows` (r,) and at the points with
    indices `only` (p,), None: all. Raises `InputError`."""
    source, count = BodyStress(result.history, result.view, body, points), len(result.time)
    shown = np.arange(count) if rows is None else numbers(rows, count, "stress: rows")
    every = len(source.field.points)
    wanted = np.arange(every) if only is None else numbers(only, every, "stress: only", "points", f"{points!r} has")
    shape = len(shown), len(wanted), 6
    size = 8 * int(np.prod(shape))
    if size > MUCH:
        log.warning("stress: '%s' of '%s' takes %s; name the saved steps wanted, rows=", points, body, size_text(size))
    tensor = np.empty(shape)
    for n, i in enumerate(shown):
        tensor[n] = source.tensor(int(i))[wanted]
    return StressResult(result.time[shown], source.field.points[wanted], tensor)


def numbers(given: Any, count: int, what: str, of: str = "saved steps", holder: str = "the run has") -> np.ndarray:
    """Non-negative indices (r,) for `given` (r,), where negative ones count from the end; raises `InputError` naming
    `what` for values that are not integers, and for one beyond the `count` items of the `holder`."""
    found = np.atleast_1d(np.asarray(given))
    if found.ndim != 1 or not np.issubdtype(found.dtype, np.integer):
        raise InputError(f"{what} must be whole numbers of {of}, got {given!r}")
    if len(found) and not -count <= found.min() <= found.max() < count:
        raise InputError(f"{what}: {holder} {of} 0 to {count - 1}, got {found.min()} to {found.max()}")
    return found % max(count, 1)


SPREAD, WALL = 6.0, 0.6  # spacings of the grid around a node; of the depth of the material behind the surface
SHORT = 0.8  # of the width of the surface: a shorter loaded zone is also spread along the meridian
WHOLE, NOTHING = 1.5, 2.5  # reaches of the spread load from the patch: full weight of the half-space, and zero weight
MERIDIAN_POINTS = 24  # of the rule for arcs of a meridian: error 1e-9 for a crown of 1 rad
ENDS = np.array([1.0, -1.0, 1.0])  # a reflection at an end plane: t changes its sign
SHEARED = np.array([1.0, 1.0, 1.0, -1.0, -1.0, 1.0])  # and with it xy and yz


def meridian_arc(shape: Any, start: float, z: np.ndarray) -> np.ndarray:
    """Lengths [m] along the meridian from `start` to the positions z [m]."""
    x, w = np.polynomial.legendre.leggauss(MERIDIAN_POINTS)
    half = 0.5 * (np.asarray(z, dtype=float) - start)
    at = start + half[..., None] * (1.0 + x)
    return half * (np.sqrt(1.0 + shape.slope_at(at) ** 2) @ w)


def parabola(distance: np.ndarray, reach: float) -> np.ndarray:
    """Weights 1 - (distance/reach)^2 [-] within the reach [m]."""
    return np.maximum(1.0 - (distance / reach) ** 2, 0.0)


class PatchStress:
    """Stress correction for one contact's cells at the points of a stress field of its first or second body."""

    def __init__(self, loads: CellLoads, field: StressField, wall: float | None) -> None:
        """wall: depth [m] of the material behind the surface, None if unknown."""
        self.loads, self.surface = loads, loads.surface
        shape, grid = self.surface.shape, self.surface.grid
        self.theta, self.z, distance = shape.chart(field.points)
        self.depth = np.maximum(-distance, 0.0)
        self.normals = shape.normal(self.theta, self.z)
        e_theta, t_z = tangents(shape, self.theta, self.z)
        self.axes = np.stack([e_theta, t_z, -self.normals], axis=-1)  # (p, 3, 3) in columns: s, t, depth
        self.span = field.normal[self.surface.name].span
        spacing = float(shape.radius_at(np.mean(grid.z))) * float(grid.pitch)
        self.reach = min(SPREAD * spacing, np.inf if wall is None else WALL * wall)
        self._around = self._over_columns(spacing)
        self._along = self._over_rows()

    def _over_columns(self, spacing: float) -> np.ndarray:
        """(columns, columns) fractions of each column's forces that every column receives."""
        grid = self.surface.grid
        away = np.abs(np.arange(grid.columns)[:, None] - np.arange(grid.columns))
        if grid.periodic:
            away = np.minimum(away, grid.columns - away)
        parts = parabola(spacing * away, self.reach)
        return parts / parts.sum(axis=0)

    def _over_rows(self) -> np.ndarray:
        """(rows, rows) fractions of each row's forces that every row receives, proportional to the rows' areas."""
        z = np.asarray(self.surface.grid.z)
        parts = parabola(np.abs(z[:, None] - z), self.reach) * self.surface.gram_z.sum(axis=1)[:, None]
        return parts / parts.sum(axis=0)

    def forces(self, i: int) -> np.ndarray:
        """Outward nodal forces (columns, rows) [N] of saved step `i`, spread."""
        forces = self._around @ self.loads.forces(i)
        rows = np.flatnonzero(np.any(self.loads.contact.pressure[i] > 0.0, axis=0))
        z = self.surface.grid.z
        if not len(rows):
            return forces
        lines = self.loads.places.z_edges[i]
        short = lines[rows[-1] + 1] - lines[rows[0]] < SHORT * float(z[-1] - z[0])
        return forces @ self._along.T if short else forces

    def at(self, i: int, forces: np.ndarray) -> np.ndarray:
        """Stress (p, 6) [Pa], user axes, of saved step `i`, to be added to that of the nodal forces `forces(i)`."""
        found = np.zeros((len(self.theta), 6))
        if not np.any(forces):
            return found
        loads, surface, places = self.loads, self.surface, self.loads.places
        shape = surface.shape
        theta, z = (float(v[0]) for v in loads.on_surface(i, places.center[i : i + 1], places.middle[i : i + 1]))
        theta_c, radius = theta + grid_theta_offset(surface), float(shape.radius_at(z))
        turn = wrapped(self.surface, self.theta - theta_c, 0.0)
        s, t = shape.side * radius * turn, meridian_arc(shape, z, self.z)
        share = self._share(i, s, t) * cutoff(self.normals @ shape.normal(theta_c, z))
        near = np.flatnonzero(share > 0.0)
        if not len(near):
            return found
        points = np.stack([s[near], t[near], self.depth[near]], axis=1)
        far = surface.far
        nu, cells, grid_nodes = (
            far.poisson_ratio,
            self._cells(i, theta_c, z),
            self._grid_nodes(theta, z, radius, forces),
        )
        total = cells(points, nu) - grid_nodes(points, nu)
        for end in far.ends:
            mirrored = points * ENDS + np.array([0.0, 2.0 * float(meridian_arc(shape, z, np.array(end.z))), 0.0])
            total += SHEARED * (cells(mirrored, nu) - grid_nodes(mirrored, nu))
        found[near] = share[near, None] * rotated(total, self.axes[near])
        return found

    def _share(self, i: int, s: np.ndarray, t: np.ndarray) -> np.ndarray:
        """(p,) 1 near the patch, decreasing to 0 with continuous curvature."""
        cells = self.loads.contact.cells
        half = float(cells.half_width[i]), 0.5 * float(np.sum(cells.length[i]))
        if not self.loads.first:  # rotated by any angle
            half = max(half), max(half)
        beside = [np.maximum(np.abs(x) - h, 0.0) for x, h in zip((s, t), half, strict=True)]
        distance = np.sqrt(beside[0] ** 2 + beside[1] ** 2 + self.depth**2)
        x = np.clip((distance / self.reach - WHOLE) / (NOTHING - WHOLE), 0.0, 1.0)
        return 1.0 - x**3 * (10.0 - 15.0 * x + 6.0 * x * x)

    def _cells(self, i: int, theta: float, z: float) -> Any:
        """The stress (n, 6) of the cells at points (n, 3) of this body's flat chart."""
        loads, places = self.loads, self.loads.places
        first = loads.pair.first
        middle = float(places.middle[i])
        x = float(places.width[i]) * (np.arange(places.columns + 1) - 0.5 * places.columns)
        y = meridian_arc(first.shape, middle, places.z_edges[i])
        pressure = loads.contact.pressure[i][:: 1 if first.shape.side > 0.0 else -1]
        axes = np.eye(3)
        if not loads.first:
            own, other = poses(loads.pair, loads.bodies, i)
            mine = own.turned(tangents(first.shape, float(places.center[i]) + grid_theta_offset(first), middle)[:, 0])
            axes[:2, :2] = mine @ other.turned(tangents(self.surface.shape, theta, z)[:, 0]).T

        def stress(points: np.ndarray, nu: float) -> np.ndarray:
            return rotated(under_cells(points @ axes.T, x, y, pressure, nu), axes.T)

        return stress

    def _grid_nodes(self, theta: float, z: float, radius: float, forces: np.ndarray) -> Any:
        """The stress (n, 6) of the nodal pressures at points (n, 3) of this body's flat chart; theta on its grid."""
        surface, shape = self.surface, self.surface.shape
        grid = surface.grid
        whole = -self.span.coefficients(forces[None], "nodes", grid.pitch, surface.gram_z)[0]
        middle = (theta - grid.theta_start) / grid.pitch
        loaded = np.flatnonzero(np.any(forces != 0.0, axis=1))
        away = loaded - middle
        turn = shape.profile().turn / grid.pitch
        if np.isfinite(turn):
            away = (away + 0.5 * turn) % turn - 0.5 * turn
        low, high = int(np.floor(middle + away.min())) - 1, int(np.ceil(middle + away.max())) + 1
        columns = np.arange(low, high + 1)
        if not self.span.closed:
            columns = columns[(columns >= -self.span.first) & (columns < len(whole) - self.span.first)]
        values = whole[(self.span.first + columns) % len(whole)]
        x = shape.side * radius * grid.pitch * (columns - middle)
        y = meridian_arc(shape, z, np.asarray(grid.z))
        if shape.side < 0.0:
            x, values = x[::-1], values[::-1]

        def stress(points: np.ndarray, nu: float) -> np.ndarray:
            return under_nodes(points, x, y, values, nu)

        return stress
