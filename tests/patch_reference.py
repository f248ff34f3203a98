"""Contact on a patch of cells by a dense NumPy reference: one body, held at an interface, on a rigid plane.

u = (H + P S P^T + modes) f at the centres of cells, f >= 0 their forces, H by Love's integrals over rectangles, with
mirror images and the quarter space at the ends; approach delta: gap g_0(x) - delta + u >= 0.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.linalg import cho_factor, cho_solve

from warpffrf.model.laws.curves import Curve
from warpffrf.model.reduced.body import ReducedBody
from warpffrf.model.reduced.far_field import cutoff

Array = np.ndarray
LEAST = 1.0  # Pa: where the slope of a power's yield is taken at most


def corner(X: Array, Z: Array) -> Array:
    """Integral of 1/r over the rectangle between the origin and (X, Z), signed."""

    def part(s, t):
        return s * np.arcsinh(t / np.where(s == 0.0, np.inf, np.abs(s)))

    return part(X, Z) + part(Z, X)


def rectangle(x: Array, z: Array, width: float, length: Array) -> Array:
    """Integral of 1/r over a rectangle centred at the origin, seen from (x, z)."""
    a, b = 0.5 * width, 0.5 * length
    return corner(x + a, z + b) - corner(x + a, z - b) - corner(x - a, z + b) + corner(x - a, z - b)


def line_edges(width: float, first: float, largest: float) -> Array:
    """Edges of rows that grow from both ends of a line contact of `width` [m]."""
    steps = [first]
    while sum(steps) + steps[-1] * 1.25 < 0.5 * width - largest:
        steps.append(min(1.25 * steps[-1], largest))
    rest = 0.5 * width - sum(steps)
    count = int(np.ceil(rest / largest))
    half = 0.5 * width - np.concatenate([[0.0], np.cumsum(steps + [rest / count] * count)])
    return np.concatenate([-half, half[::-1][1:]])


@dataclass
class Patch:
    """Cells over `columns` strips of `strip` [m] around the angle theta [rad] of a surface, rows between
    `edges` [m]."""

    body: ReducedBody
    surface: str
    interface: str
    theta: float
    columns: int
    strip: float
    edges: Array

    def __post_init__(self) -> None:
        s = self.body.contact_surfaces[self.surface]
        far, splines = s.far, s.splines
        assert far is not None
        rows = 0.5 * (self.edges[1:] + self.edges[:-1])
        lengths = np.diff(self.edges)
        x = self.strip * (np.arange(self.columns) - 0.5 * (self.columns - 1))
        self.x, self.z = np.repeat(x, len(rows)), np.tile(rows, self.columns)
        self.areas = np.tile(self.strip * lengths, self.columns)
        radius = float(s.shape.radius_at(0.0))
        theta = self.theta + self.x / radius

        # H, per unit pressure of a cell, by the distance in columns
        k = self.strip * np.arange(self.columns)[:, None, None]
        seen, loaded = rows[None, :, None], rows[None, None, :]
        c = (1.0 - far.poisson_ratio**2) / np.pi
        H = c * rectangle(k, seen - loaded, self.strip, lengths)
        for end in far.ends:
            assert far.quarter is not None
            quarter = far.quarter
            a, b = end.side * (end.z - seen), end.side * (end.z - loaded)
            H = H + c * rectangle(k, a + b, self.strip, lengths)
            H = H + quarter.displacement(k, a, b) * self.strip * lengths
        H = H / (far.youngs_modulus * self.strip * lengths)
        j = np.arange(self.columns)
        H = H[np.abs(j[:, None] - j)].transpose(0, 2, 1, 3).reshape(len(theta), -1)

        P = (splines.around(theta)[:, :, None] * splines.along(self.z)[:, None, :]).reshape(len(theta), -1)
        used = np.flatnonzero(np.abs(P).sum(axis=0) > 0.0)
        S = spline_matrix(s, far.lags, used)
        self.spread = P

        # global modes with the interface held: they move the body so that it stays
        held = self.body.interfaces[self.interface]
        places, normals = s.shape.point(theta, self.z), s.shape.normal(theta, self.z)
        rigid = np.concatenate([normals, np.cross(places - held.point, normals)], axis=1)
        modes = P @ splines.of_nodes(s.mode_normal) - rigid @ held.modes.T
        omega = 2.0 * np.pi * self.body.frequencies
        self.near = 0.5 * (H + H.T)
        self.far = P[:, used] @ S @ P[:, used].T
        self.modes = (modes / omega**2) @ modes.T
        self.traces, self.omega = modes, omega

    def under(self, other: Patch) -> Array:
        """Displacement (cells, cells) [m/N] of these cells under forces on those of another patch of the surface: the
        half-space from cell to cell, as far as it counts, far field and modes."""
        s = self.body.contact_surfaces[self.surface]
        far = s.far
        assert far is not None
        radius = float(s.shape.radius_at(0.0))
        turn = self.theta - other.theta + (self.x[:, None] - other.x) / radius
        d = radius * np.abs(turn)
        c = (1.0 - far.poisson_ratio**2) / np.pi
        H = c / np.hypot(d, self.z[:, None] - other.z)
        for end in far.ends:
            assert far.quarter is not None
            a, b = end.side * (end.z - self.z)[:, None], end.side * (end.z - other.z)
            H = H + c / np.hypot(d, a + b) + far.quarter.displacement(d, a, b)
        H = H * cutoff(np.cos(turn)) / far.youngs_modulus
        used = np.flatnonzero(np.abs(self.spread).sum(axis=0) + np.abs(other.spread).sum(axis=0) > 0.0)
        S = spline_matrix(s, far.lags, used)
        return H + self.spread[:, used] @ S @ other.spread[:, used].T + (self.traces / self.omega**2) @ other.traces.T

    def press(self, gap: Array, approach: float, layer: Curve | None = None) -> Array:
        """Forces (cells,) [N] at the `approach` [m], of the undeformed `gap` (cells,) [m]; of half of a `layer` on the
        plane between two equal bodies."""
        G = self.near + self.far + self.modes
        if layer is None:
            return pressed(G, gap - approach)
        return self.areas * layered(G * self.areas, gap - approach, layer)


def press_both(one: Patch, other: Patch, gap: Array, approach: float) -> Array:
    """As `Patch.press`, of two patches of one surface, one after the other; `gap` of both."""
    across = one.under(other)
    G = np.block([[p.near + p.far + p.modes if p is q else across if p is one else across.T for q in (one, other)]
                  for p in (one, other)])  # fmt: skip
    return pressed(G, gap - approach)


def pressed(G: Array, open_by: Array) -> Array:
    """Forces f >= 0 (n,) with open_by + G f >= 0, one of both 0."""
    active = open_by < 0.0
    for _ in range(60):
        f = np.zeros(len(open_by))
        f[active] = cho_solve(cho_factor(G[np.ix_(active, active)]), -open_by[active])
        now = np.where(active, f > 0.0, open_by + G @ f < -1e-16)
        if np.array_equal(now, active):
            return f
        active = now
    raise AssertionError("the active set did not settle")


def layered(G: Array, open_by: Array, layer: Curve) -> Array:
    """Pressures p >= 0 (n,) with open_by + G p + y(p)/2 >= 0, one of both 0, y the layer's yield: Newton's method."""
    p = np.where(open_by + 0.5 * layer.begins < 0.0, 1e8, 0.0)
    for _ in range(60):
        y, slope = layer.yielding(np.maximum(p, LEAST))
        y = np.where(p > 0.0, y, layer.begins)
        r = open_by + G @ p + 0.5 * y
        active = np.flatnonzero((p > 0.0) | (r < 0.0))
        dp = np.zeros(len(p))
        dp[active] = np.linalg.solve((G + np.diag(0.5 * slope))[np.ix_(active, active)], -r[active])
        # what would pull leaves, a part of the way at a time: a power has no slope at 0
        new = np.where(p + dp < 0.0, 0.2 * p * (p > 10.0 * LEAST), p + dp)
        change, p = np.max(np.abs(new - p)), new
        if change < 1e-9 * p.max():
            return p
    raise AssertionError("the pressures did not settle")


def spline_matrix(surface, lags: Array, numbers: Array) -> Array:
    """Entries of S among the splines `numbers`, of its block-circulant layout."""
    c, rows = surface.grid.columns_per_sector, surface.grid.rows
    j, k = numbers // rows, numbers % rows
    own = (j % c) * rows + k
    return lags[(j[:, None] // c - j // c) % len(lags), own[:, None], own]
