r"""Stress near a patch of cells that is finer than the mesh: what the hats of the contact grid cannot say.

A body feels the cells through the hat forces that are equivalent to them (`normal_loads`): a load as wide as two
columns of the grid, whose stress the mesh has to a few parts in ten. Spread to forces f over `SPREAD` spacings of the
grid around each hat, a load that the mesh does resolve, the rest is that of the half-space that the body is around the
patch, cut at its free ends,

    sigma = sigma_FE(f) + sigma_H(cells) - sigma_H(hats of f),

both sigma_H in closed form (`half_space_stress`), the hats with the pressure M^-1 f that the recovered stress
sigma_FE(f) has at the surface. What the body adds to the half-space is smooth over its depth behind the surface: f
stays within `WALL` of that. Far from the patch both sigma_H are the same but for the second moment of f; they are faded
out.

Under the middle of long rollers and of balls the largest von Mises stress and its depth are Hertz's to 0.5 % on any
mesh (docs/studies/coarse_points.md). In a roller of 20 mm, R = 50 mm, it is 1 % larger, as the free ends let sigma
along the axis go by some percent of the peak pressure, which Hertz does not know (`warpffrf demo coarse-rollers`).

The half-space lies flat: a point has the arcs s along e_theta and t along the meridian of its foot from the middle of
the patch, and its depth below the surface. On the second body the cells lie as they do in the first one's chart, turned
by the angle between the tangents of both. At a free end, at right angles to the surface, loads have their images behind
it, which take the shear off the end plane; its normal stress stays: within the reach of the spread load from an end
sigma along the meridian is that of plane strain in part.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from warpffrf.model.reduced.far_field import cutoff
from warpffrf.model.reduced.stress_field import StressField, rotated
from warpffrf.output.bodies.half_space_stress import under_cells, under_hats
from warpffrf.output.bodies.normal_loads import CellLoads
from warpffrf.output.bodies.patch_on_skin import poses
from warpffrf.output.geometry.grid_places import grid_theta_offset
from warpffrf.output.geometry.poses import tangents

SPREAD, WALL = 6.0, 0.6  # spacings of the grid around a hat; of the depth of the material behind the surface
SHORT = 0.8  # of the width of the surface: cells under pressure that reach less far are spread along the meridian, too
WHOLE, NOTHING = 1.5, 2.5  # reaches of the spread load from the patch: the half-space in full, and not at all
MERIDIAN_POINTS = 24  # of the rule for arcs of a meridian: 1e-9 of a crown's, with a crown of 1 rad
ENDS = np.array([1.0, -1.0, 1.0])  # a reflection at an end plane: t changes its sign
SHEARED = np.array([1.0, 1.0, 1.0, -1.0, -1.0, 1.0])  # and with it xy and yz


def meridian_arc(shape: Any, start: float, z: np.ndarray) -> np.ndarray:
    """Lengths [m] along the meridian from `start` to the places z [m]."""
    x, w = np.polynomial.legendre.leggauss(MERIDIAN_POINTS)
    half = 0.5 * (np.asarray(z, dtype=float) - start)
    at = start + half[..., None] * (1.0 + x)
    return half * (np.sqrt(1.0 + shape.slope_at(at) ** 2) @ w)


def parabola(distance: np.ndarray, reach: float) -> np.ndarray:
    """Weights 1 - (distance/reach)^2 [-] within the reach [m]."""
    return np.maximum(1.0 - (distance / reach) ** 2, 0.0)


class PatchStress:
    """Of one pair's cells at the points of a stress field of its first or second body."""

    def __init__(self, loads: CellLoads, field: StressField, wall: float | None) -> None:
        """wall: depth [m] of the material behind the surface, None where it is not known."""
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
        """(columns, columns) parts of each column's forces that every column gets."""
        grid = self.surface.grid
        away = np.abs(np.arange(grid.columns)[:, None] - np.arange(grid.columns))
        if grid.periodic:
            away = np.minimum(away, grid.columns - away)
        parts = parabola(spacing * away, self.reach)
        return parts / parts.sum(axis=0)

    def _over_rows(self) -> np.ndarray:
        """(rows, rows) parts of each row's forces that every row gets, in proportion to the rows' areas."""
        z = np.asarray(self.surface.grid.z)
        parts = parabola(np.abs(z[:, None] - z), self.reach) * self.surface.gram_z.sum(axis=1)[:, None]
        return parts / parts.sum(axis=0)

    def forces(self, i: int) -> np.ndarray:
        """Outward hat forces (columns, rows) [N] of saved step `i`, spread."""
        forces = self._around @ self.loads.forces(i)
        rows = np.flatnonzero(np.any(self.loads.contact.pressure[i] > 0.0, axis=0))
        z = self.surface.grid.z
        if not len(rows):
            return forces
        lines = self.loads.places.z_edges[i]
        short = lines[rows[-1] + 1] - lines[rows[0]] < SHORT * float(z[-1] - z[0])
        return forces @ self._along.T if short else forces

    def at(self, i: int, forces: np.ndarray) -> np.ndarray:
        """Stress (p, 6) [Pa], user axes, of saved step `i`, to be added to that of the hat forces `forces(i)`."""
        found = np.zeros((len(self.theta), 6))
        if not np.any(forces):
            return found
        loads, surface, places = self.loads, self.surface, self.loads.places
        shape = surface.shape
        theta, z = (float(v[0]) for v in loads.on_surface(i, places.center[i : i + 1], places.middle[i : i + 1]))
        theta_c, radius = theta + grid_theta_offset(surface), float(shape.radius_at(z))
        turn = self.theta - theta_c
        if shape.kind != "plane":
            turn = (turn + np.pi) % (2.0 * np.pi) - np.pi
        s, t = shape.side * radius * turn, meridian_arc(shape, z, self.z)
        share = self._share(i, s, t) * cutoff(self.normals @ shape.normal(theta_c, z))
        near = np.flatnonzero(share > 0.0)
        if not len(near):
            return found
        points = np.stack([s[near], t[near], self.depth[near]], axis=1)
        far = surface.far
        nu, cells, hats = far.poisson_ratio, self._cells(i, theta_c, z), self._hats(theta, z, radius, forces)
        total = cells(points, nu) - hats(points, nu)
        for end in far.ends:
            mirrored = points * ENDS + np.array([0.0, 2.0 * float(meridian_arc(shape, z, np.array(end.z))), 0.0])
            total += SHEARED * (cells(mirrored, nu) - hats(mirrored, nu))
        found[near] = share[near, None] * rotated(total, self.axes[near])
        return found

    def _share(self, i: int, s: np.ndarray, t: np.ndarray) -> np.ndarray:
        """(p,) 1 near the patch, falling to 0 with a continuous curvature."""
        cells = self.loads.contact.cells
        half = float(cells.half_width[i]), 0.5 * float(np.sum(cells.length[i]))
        if not self.loads.first:  # turned by any angle
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

    def _hats(self, theta: float, z: float, radius: float, forces: np.ndarray) -> Any:
        """The stress (n, 6) of the hats at points (n, 3) of this body's flat chart; theta on its grid."""
        surface, shape = self.surface, self.surface.shape
        grid = surface.grid
        whole = -self.span.coefficients(forces[None], "hats", grid.pitch, surface.gram_z)[0]
        middle = (theta - grid.theta_start) / grid.pitch
        loaded = np.flatnonzero(np.any(forces != 0.0, axis=1))
        away = loaded - middle
        turn = 2.0 * np.pi / grid.pitch if shape.kind != "plane" else np.inf
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
            return under_hats(points, x, y, values, nu)

        return stress
