r"""Two gears in mesh by full finite elements: segments of curved quadratic hexahedra, fine along the lines of contact,
no modes, no half-space, no functions of the engine but the mesh, its element matrices and the linear solver.

Half of the width is modelled, between a free end and the plane of symmetry. Pressures p of bilinear functions psi_i on
the corners of a strip of each flank give by one factorisation of each gear the mean normal displacements A p. With the
line of contact of the pair k at g_k on the path of contact, delta the approach along it, F the normal force,

    int psi_i (s^2/2 (1/rho_1 + 1/rho_2) - delta) + (A_1 + A_2) p >= 0    _|_    p >= 0,      sum over all k of p = F/2,

by the active set of `contact`; the strip of gear 2 is that of gear 1 reversed, s -> -s.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from references.finite_elements.contact import active_set
from warpffrf.model.gears import GearPair
from warpffrf.model.material import Material
from warpffrf.model.mesh import gear as gear_mesh
from warpffrf.model.mesh.elements import facet_kind
from warpffrf.offline.fe import assemble, assign
from warpffrf.offline.solvers import factorise

Array = np.ndarray
STRIP, CELL = 0.42e-3, 0.07e-3  # m: half the width of a strip, and its cells
COARSE, GROWTH = 0.7e-3, 1.8  # m: cells between strips
AXIAL = (0.0, 0.05, 0.15, 0.33, 0.62, 1.0)  # of half the width, from its free end
POINTS = 4
BLOCK = 64  # right-hand sides solved at once
AT = 1e-9  # m
Spot = tuple[int, float]  # tooth, g [m] as seen by this gear: positive towards its tip


@dataclass(frozen=True)
class Meshed:
    """Approach along the path of contact [m] and shares (n,) of the pairs of teeth."""

    approach: float
    shares: Array


def meshed(
    pair: GearPair, material: Material, width: float, rim: float, teeth: int, spots: Sequence[tuple[Spot, Spot]],
    loads: Sequence[float],
) -> list[Meshed]:  # fmt: skip
    """Two equal gears of the `pair` without relief; spots: of each pair of teeth, on gear 1 and on gear 2."""
    strips: dict[tuple[float, ...], _Segment] = {}
    A = []
    for own in zip(*spots, strict=True):
        places = tuple(sorted({g for _, g in own}))
        if places not in strips:
            strips[places] = _Segment(pair, material, width, rim, teeth, places)
        A.append(strips[places].compliance(own))
    one = next(iter(strips.values()))
    s, y = one.across, one.along
    reverse = np.arange(A[0].shape[0]).reshape(len(spots), len(s), len(y))[:, ::-1].ravel()
    x, w = np.polynomial.legendre.leggauss(POINTS)
    at = (0.5 * (s[1:] + s[:-1])[:, None] + 0.5 * np.diff(s)[:, None] * x).ravel()
    weight = (0.5 * np.diff(s)[:, None] * w).ravel()
    functions, step = _hats(s, at), np.diff(y)
    axial = 0.5 * (np.append(step, 0.0) + np.append(0.0, step))
    gaps, areas = [], []
    for (_, g), _ in spots:
        rho_1, rho_2 = pair.curvature_radii(g)
        gaps.append(np.outer(functions.T @ (weight * 0.5 * at**2 * (1.0 / rho_1 + 1.0 / rho_2)), axial).ravel())
        areas.append(np.outer(functions.T @ weight, axial).ravel())
    gap, area = np.concatenate(gaps), np.concatenate(areas)
    edge = np.zeros((len(spots), len(s), len(y)), dtype=bool)
    edge[:, [0, -1]] = True
    found = []
    for load in loads:
        pressure, _, approach, _ = active_set(
            A[0] + A[1][np.ix_(reverse, reverse)], gap, area, np.eye(len(gap)), 0.5 * load,
            np.flatnonzero(edge.ravel()).tolist(),
        )  # fmt: skip
        forces = (area * pressure).reshape(len(spots), -1).sum(axis=1)
        found.append(Meshed(approach, forces / forces.sum()))
    return found


class _Segment:
    """Half of a segment of a gear, held at its bore, fine about `places` g [m] on the flanks of all its teeth."""

    def __init__(
        self, pair: GearPair, material: Material, width: float, rim: float, teeth: int, places: Sequence[float]
    ) -> None:
        self.pair, self.gear = pair, pair.gear_1
        self.start, end = self._arc(self.gear.root_form_rho), self._arc(self.gear.tip_form_rho)
        self.lines = _lines([self._arc(self._rho(g)) - self.start for g in places], end - self.start)
        self.along = 0.5 * width * (np.array(AXIAL) - 0.5)
        self.mesh = gear_mesh(
            self.gear, 0.5 * width, rim_radius=rim, teeth=teeth, along=self.lines / self.lines[-1], across=2,
            layers=5, axial=self.along, rim_layers=3,
        )  # fmt: skip
        points = self.mesh.points
        K, _ = assemble(points, self.mesh.cells, assign(self.mesh, material))
        held = np.zeros((len(points), 3), dtype=bool)
        held[self.mesh.facet_sets["bore"].node_set] = True
        held[np.abs(points[:, 1] - self.along[-1]) < AT, 1] = True
        self.free = np.flatnonzero(~held.ravel())
        self.factor = factorise(K[self.free][:, self.free].tocsc(), coordinates=np.repeat(points, 3, axis=0)[self.free])

    @property
    def across(self) -> Array:
        """Places (n,) [m] of the corners of a strip, from its middle."""
        return np.linspace(-STRIP, STRIP, round(2.0 * STRIP / CELL) + 1)

    def compliance(self, spots: Sequence[Spot]) -> Array:
        """A of the strips, in the order spots, across, along."""
        loads = np.hstack([self._loads(*spot) for spot in spots])[self.free]
        moved = np.hstack([self.factor.solve(loads[:, i : i + BLOCK]) for i in range(0, loads.shape[1], BLOCK)])
        A = loads.T @ moved
        return 0.5 * (A + A.T)

    def _loads(self, tooth: int, g: float) -> Array:
        name = f"flank_right_{tooth}"
        shape = self.gear.surfaces(("right",), (tooth,))[name]
        r = float(np.hypot(self.gear.base_radius, self._rho(g)))
        polar = 2.0 * np.pi * (tooth - 1) / self.gear.teeth - 0.5 * self.gear.tooth_thickness(2.0 * r) / r
        ((middle,), _, (off,)) = shape.chart(r * np.array([[np.cos(polar), 0.0, -np.sin(polar)]]))
        assert abs(off) < AT
        facet, nodes = self.mesh.facet_sets[name].single
        x, w = np.polynomial.legendre.leggauss(POINTS)
        N, slopes = facet_kind(facet).shape(np.stack(np.meshgrid(x, x, indexing="ij"), axis=-1).reshape(-1, 2))
        weight = np.outer(w, w).ravel()
        load = np.zeros((len(self.mesh.points), 3, len(self.across) * len(self.along)))
        for face in nodes:
            places = N @ self.mesh.points[face]
            u = shape.chart(places)[0]
            if np.abs(u.mean() - middle) > STRIP:
                continue
            tangents = np.einsum("qki,kj->qij", slopes, self.mesh.points[face])
            area = weight * np.linalg.norm(np.cross(tangents[:, 0], tangents[:, 1]), axis=1)
            psi = _hats(self.across, u - middle)[:, :, None] * _hats(self.along, places[:, 1])[:, None]
            psi = psi.reshape(len(u), -1)
            load[face] += np.einsum("q,qk,qj,qc->kcj", area, N, psi, -shape.normal(u, 0.0))
        return load.reshape(-1, load.shape[2])

    def _rho(self, g: float) -> float:
        return float(self.pair.curvature_radii(0.0)[0]) + g

    def _arc(self, rho: float) -> float:
        """Length [m] of the involute from the base circle."""
        return rho**2 / self.gear.base_diameter


def _lines(middles: Sequence[float], length: float) -> Array:
    """Boundaries [m] of cells along an involute: strips about `middles`, growing cells between them."""
    lines = [np.zeros(1)]
    for middle in middles:
        lines += [_growing(lines[-1][-1], middle - STRIP, len(lines) > 1, True)]
        lines += [np.linspace(middle - STRIP, middle + STRIP, round(2.0 * STRIP / CELL) + 1)[1:]]
    return np.concatenate([*lines, _growing(lines[-1][-1], length, True, False)])


def _growing(low: float, high: float, fine_low: bool, fine_high: bool) -> Array:
    """Boundaries after `low`, up to `high`."""
    sizes: list[list[float]] = [[], []]
    following = CELL * GROWTH
    while True:
        added = [min(following, COARSE) if fine else 0.0 for fine in (fine_low, fine_high)]
        if sum(map(sum, sizes)) + sum(added) > high - low:
            break
        for part, size in zip(sizes, added, strict=True):
            part += [size] if size else []
        following *= GROWTH
    steps = np.array([*sizes[0], *sizes[1][::-1]] or [1.0])
    return low + (high - low) * np.cumsum(steps) / steps.sum()


def _hats(grid: Array, x: Array) -> Array:
    """Values (p, n) at x (p,) of the linear functions of a `grid` (n,)."""
    cell = np.clip(np.searchsorted(grid, x) - 1, 0, len(grid) - 2)
    share = np.clip((x - grid[cell]) / (grid[cell + 1] - grid[cell]), 0.0, 1.0)
    values, row = np.zeros((len(x), len(grid))), np.arange(len(x))
    values[row, cell], values[row, cell + 1] = 1.0 - share, share
    return values
