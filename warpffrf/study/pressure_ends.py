r"""Which of "semi" and "full" is wrong where a patch ends: both beside the law itself, on that mesh and a finer one.

`python -m warpffrf.study.pressure_ends` writes docs/studies/pressure_ends.md. Two minutes.

Two equal treads (`evaluations.tread`) are pressed together by a given force F, mirror images of each other, so that the
nodes of both lie opposite and the gap at the angle t from the line of centres is `g_0 = 2 R (1 - cos t) - delta`, delta
the approach. With D the compliance of the hats of one roller, global modes included, u = 2 D f opens the gap under the
forces f of the hats. Between the rollers lies a layer p = k d. Its law is met in four ways, all of them minima of
convex energies, on the same displacements u:

    nodes    "full":  f = k a <-(g_0 + u)>  at the nodes, a their areas
    hats     "semi":  p = sum s_j psi_j, f = M s, 0 <= s, 0 <= w + 2 M D M s + M s/k, w the weak gaps of g_0
    cells    as hats, with functions that are constant in a cell around each node instead: f = B s, B_ij = int psi_i dA
             over the cell j
    points   f_i = int psi_i k <-(g_0 + sum_j psi_j u_j)> dA by Gauss points: the law itself, on bodies of that mesh

None of this uses the engine. The *reference* is `points` on a mesh of REFINED times as many sectors. Pressures are
compared as everywhere, meaned over the hats of the coarse grid, f_i/a_i, which is what its forces can tell, in the L2
norm of the surface; the reference's forces are shared between the hats of the coarse grid by their values there. The
stress is that of `evaluations`, von Mises at points under the patch, the largest difference over the largest; it is
compared on one mesh only, because close to the surface the cells themselves err by more than the pressures.
"""

from __future__ import annotations

import sys
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from warpffrf.model.reduced_body import ReducedBody
from warpffrf.model.stress_field import von_mises
from warpffrf.study.evaluations import POINTS, STIFFER, layer_of, tread
from warpffrf.study.step_time import RADIUS
from warpffrf.verification.markdown import table

MADE = "Made by `python -m warpffrf.study.pressure_ends`; do not edit.\n"
REFINED = 4  # times as many sectors of the reference: with errors of the order 3/2 it errs by an eighth
GRADED = 5  # layers more, so that its outermost cells are square too: 1.3^5 is about 4
PHASES = np.linspace(0.0, 0.5, 5)  # of a column: line of centres on a node, and half way between two
HALF_WIDTH = 0.45  # over sqrt(approach R): where the stress points lie, as in bench/evaluations.py
WIDER, BESIDE = 1.25, 6  # times the half-width, and columns beside it, that the tread has on each side
MESHES = ((2400, 17), (3840, 20))  # sectors, layers; 4 cells along the axis
APPROACHES = (40e-6, 60e-6)  # m
HARD = 300.0
WAYS = ("nodes", "hats", "cells", "points")
SETTLED = 1e-10  # of the force: the secant over the approach
ROUNDS = 60  # of an active set; a handful in practice
GAUSS = 6, 2  # points around and along a cell: "semi" has 3 x 2, which miss the corner where pressure begins


class Pressing:
    """A tread against its mirror image; see the module. `columns` of the grid about its middle are looked at."""

    def __init__(self, body: ReducedBody, columns: int) -> None:
        surface = body.contact_surfaces["tread"]
        grid = surface.grid
        self.body, self.grid, self.gram_z = body, grid, np.asarray(surface.gram_z)
        self.middle = grid.columns // 2
        half = min(columns // 2, self.middle)
        self.columns = np.arange(self.middle - half, self.middle + half + 1)
        nodes = (self.columns[:, None] * grid.rows + np.arange(grid.rows)).ravel()
        self.phi = surface.mode_normal[nodes] / (2.0 * np.pi * np.asarray(body.frequencies))
        self.D = 2.0 * (surface.compliance(self.columns) + self.phi @ self.phi.T)
        n = len(self.columns)
        around = np.diag(np.full(n, 2.0 / 3.0)) + np.diag(np.full(n - 1, 1.0 / 6.0), 1)
        self.M = grid.pitch * np.kron(around + np.triu(around, 1).T, self.gram_z)
        self.area = np.tile(grid.pitch * self.gram_z.sum(axis=1), n)
        around = in_cells(np.ones(n + 1))[1:-1, 1:-1]  # the grid goes on beyond the columns
        self.in_cells = self.grid.pitch * np.kron(around, RADIUS * in_cells(np.diff(grid.z)))
        self.angle = (self.columns - self.middle) * grid.pitch
        self._sample()

    def _sample(self) -> None:
        """Values (points, nodes) of the hats at the Gauss points, their areas and angles."""
        (x, wx), (z, wz) = ((0.5 * (p + 1.0), 0.5 * w) for p, w in map(np.polynomial.legendre.leggauss, GAUSS))
        n, rows = len(self.columns), self.grid.rows
        hat_x = np.zeros((n - 1, len(x), n))
        hat_z = np.zeros((rows - 1, len(z), rows))
        for j in range(n - 1):
            hat_x[j, :, j], hat_x[j, :, j + 1] = 1.0 - x, x
        for k in range(rows - 1):
            hat_z[k, :, k], hat_z[k, :, k + 1] = 1.0 - z, z
        self.psi = np.kron(hat_x.reshape(-1, n), hat_z.reshape(-1, rows))
        along = (np.diff(self.grid.z)[:, None] * wz).ravel() * RADIUS * self.grid.pitch
        self.dA = np.kron(np.tile(wx, n - 1), along)
        self.at = np.repeat(((np.arange(n - 1)[:, None] + x).ravel() - (n - 1) // 2) * self.grid.pitch, len(along))

    def norm(self, p: np.ndarray) -> float:
        """Root of the sum over columns of p.M_z p of means (nodes,)."""
        line = p.reshape(-1, self.grid.rows)
        return float(np.sqrt(np.einsum("jk,kl,jl->", line, self.gram_z, line)))

    def means(self, forces: np.ndarray, angle: np.ndarray) -> np.ndarray:
        """Pressures (nodes,) meaned over the hats, of `forces` (n, rows) at the columns' angles (n,)."""
        place = (angle - self.angle[0]) / self.grid.pitch
        column = np.floor(place + 1e-9).astype(int)
        out = np.zeros((len(self.columns), self.grid.rows))
        for step, part in ((0, 1.0 - (place - column)), (1, place - column)):
            inside = (column + step >= 0) & (column + step < len(out))
            np.add.at(out, (column + step)[inside], forces[inside] * part[inside, None])
        return out.ravel() / self.area

    def stress(self, forces: np.ndarray) -> np.ndarray:
        """Von Mises stress [Pa] at the points of the body under inward hat `forces` (nodes,)."""
        load = np.zeros((self.grid.columns, self.grid.rows))
        load[self.columns] = -forces.reshape(-1, self.grid.rows)
        q = self.phi.T @ load[self.columns].ravel() / (2.0 * np.pi * np.asarray(self.body.frequencies))
        return von_mises(self.body.stress[POINTS].evaluate(q, {"tread": load}))

    def forces(self, way: str, k: float, center: float, load: float) -> np.ndarray:
        """Forces (nodes,) of the hats under the total force `load` [N], line of centres at the angle `center`; k [Pa/m]
        of the layer."""

        def at(delta: float) -> np.ndarray:
            return getattr(self, f"by_{way}")(k, center, delta)

        low, high = 30e-6, 45e-6
        f_low, found = float(at(low).sum()), at(high)
        for _ in range(ROUNDS):
            total = float(found.sum())
            if abs(total - load) < SETTLED * load:
                return found
            low, high, f_low = high, high + (load - total) * (high - low) / (total - f_low), total
            found = at(high)
        raise RuntimeError(f"{way}: no approach carries {load:.4g} N")

    def gap(self, angle: np.ndarray, center: float, delta: float) -> np.ndarray:
        """g_0 [m]."""
        return 2.0 * RADIUS * (1.0 - np.cos(angle - center)) - delta

    def by_nodes(self, k: float, center: float, delta: float) -> np.ndarray:
        """Forces (nodes,) at the approach `delta` [m] with the law at the nodes."""
        gap = np.repeat(self.gap(self.angle, center, delta), self.grid.rows)
        return active_set(self.D + np.diag(1.0 / (k * self.area)), gap)

    def by_hats(self, k: float, center: float, delta: float) -> np.ndarray:
        """Forces (nodes,) at the approach `delta` [m] of pressures in hats."""
        weak = self.psi.T @ (self.dA * self.gap(self.at, center, delta))
        return self.M @ active_set(self.M @ self.D @ self.M + self.M / k, weak)

    def by_cells(self, k: float, center: float, delta: float) -> np.ndarray:
        """Forces (nodes,) at the approach `delta` [m] of pressures that are constant in cells around the nodes."""
        x, w = np.polynomial.legendre.leggauss(GAUSS[0])
        angle = self.angle[:, None] + 0.5 * self.grid.pitch * x
        weak = np.repeat(self.gap(angle, center, delta) @ (0.5 * w), self.grid.rows) * self.area
        B = self.in_cells
        return B @ active_set(B.T @ self.D @ B + np.diag(self.area) / k, weak)

    def _pressed(self, k: float, on: np.ndarray, gap: np.ndarray) -> np.ndarray:
        """f = -k (int_on psi g_0 + M_on u), u = D f, for a given set of pressed points."""
        psi = self.psi[on]
        nodes = np.flatnonzero(psi.any(axis=0))
        psi, dA = psi[:, nodes], self.dA[on]
        held = k * (psi.T * dA) @ psi
        f = np.zeros(len(self.area))
        f[nodes] = np.linalg.solve(
            np.eye(len(nodes)) + held @ self.D[np.ix_(nodes, nodes)], -k * (psi.T @ (dA * gap[on]))
        )
        return f

    def by_points(self, k: float, center: float, delta: float) -> np.ndarray:
        """Forces (nodes,) at the approach `delta` [m] with the law at Gauss points."""
        gap = self.gap(self.at, center, delta)
        on = gap + self.psi @ (self.D @ self.by_nodes(k, center, delta)) < 0.0
        for _ in range(ROUNDS):
            f = self._pressed(k, on, gap)
            pressed = gap + self.psi @ (self.D @ f) < 0.0
            if np.array_equal(pressed, on):
                return f
            on = pressed
        raise RuntimeError("points: the set of pressed points does not settle")


def in_cells(steps: np.ndarray) -> np.ndarray:
    """Integrals of hats (lines) over the cells around their nodes (columns), half way to the next: a half cell of step
    h holds 3/8 h of its own node's hat and 1/8 h of the next one's. Cells at both ends are halves."""
    n = len(steps) + 1
    out = np.zeros((n, n))
    j = np.arange(n - 1)
    for a in (0, 1):
        for b in (0, 1):
            out[j + a, j + b] += (3.0 if a == b else 1.0) / 8.0 * steps
    return out


def active_set(A: np.ndarray, b: np.ndarray) -> np.ndarray:
    """x >= 0 with A x + b >= 0 and x (A x + b) = 0, A symmetric positive definite, by the primal-dual active set."""
    active = b < 0.0
    for _ in range(ROUNDS):
        x, inside = np.zeros(len(b)), np.flatnonzero(active)
        x[inside] = np.linalg.solve(A[np.ix_(inside, inside)], -b[inside])
        chosen = np.where(active, x > 0.0, A @ x + b < 0.0)
        if np.array_equal(chosen, active):
            return x
        active = chosen
    raise RuntimeError("the active set does not settle")


@dataclass(frozen=True)
class Ends:
    """Worst of all phases, fractions, by way: pressure against the `reference`, pressure and stress against `points`
    on the same mesh, and against `nodes`."""

    half_width: float  # columns
    reference: dict[str, float]
    points: dict[str, float]
    nodes: dict[str, float]
    stress_points: dict[str, float]
    stress_nodes: dict[str, float]


def ends(coarse: Pressing, fine: Pressing, k: float, approach: float) -> Ends:
    """Errors of the three ways with a layer of stiffness k [Pa/m], under the force of "full" at `approach` [m]."""
    load = float(coarse.by_nodes(k, 0.0, approach).sum())
    kinds = ("reference", "points", "nodes", "stress_points", "stress_nodes")
    worst: dict[str, dict[str, float]] = {kind: {} for kind in kinds}
    widths = []

    def note(kind: str, way: str, value: float) -> None:
        worst[kind][way] = max(worst[kind].get(way, 0.0), value)

    for phase in PHASES * coarse.grid.pitch:
        f = fine.forces("points", k, phase, load)
        true = coarse.means(f.reshape(-1, fine.grid.rows), fine.angle)
        size = coarse.norm(true)
        forces = {way: coarse.forces(way, k, phase, load) for way in WAYS}
        p = {way: force / coarse.area for way, force in forces.items()}
        stress = {way: coarse.stress(force) for way, force in forces.items()}
        line = true.reshape(-1, coarse.grid.rows) @ coarse.gram_z.sum(axis=1)
        second = line @ (coarse.angle - phase) ** 2 / line.sum()
        widths.append(2.0 * np.sqrt(second) / coarse.grid.pitch)
        for way in WAYS:
            note("reference", way, coarse.norm(p[way] - true) / size)
            for other in ("points", "nodes"):
                note(other, way, coarse.norm(p[way] - p[other]) / size)
                note(f"stress_{other}", way, float(np.abs(stress[way] - stress[other]).max() / stress[other].max()))
    return Ends(float(np.mean(widths)), **worst)


def pressing(sectors: int, layers: int, approach: float, finer: int = 1) -> Pressing:
    """A tread for patches of `approach` [m]; with `finer` times as many columns, the cells at its rim are as square."""
    half_width = HALF_WIDTH * float(np.sqrt(approach * RADIUS))
    wide = 2.0 * (half_width / (2.0 * np.pi * RADIUS / sectors) * WIDER + BESIDE)
    columns = 2 * (int(wide) * finer // 2) + 1
    body = tread(
        columns + 1, sectors=finer * sectors, layers=layers + (GRADED if finer > 1 else 0), axial=4,
        half_width=half_width if finer == 1 else None,
    )  # fmt: skip
    return Pressing(body, columns)


def study() -> list[tuple[int, float, float, Ends]]:
    """Sectors, approach [m], layer over a hat, and what was found."""
    rows = []
    for sectors, layers in MESHES:
        fine = pressing(sectors, layers, max(APPROACHES), REFINED)
        for approach in APPROACHES:
            coarse = pressing(sectors, layers, approach)
            for stiffer in (STIFFER, HARD):
                k = layer_of(coarse.body, stiffer).stiffness
                rows.append((sectors, approach, stiffer, ends(coarse, fine, k, approach)))
    return rows


def page(rows: list[tuple[int, float, float, Ends]]) -> str:
    """The page of docs/studies."""
    fixed = ["sectors", "approach [µm]", "layer", "columns"]
    of_law, of_full = WAYS[:-1], WAYS[1:]
    sides = [f"{way} / law" for way in of_law] + [f"{way} / full" for way in of_full]
    pressure, stress = [], []
    for sectors, approach, stiffer, e in rows:
        line = [str(sectors), f"{approach * 1e6:.0f}", f"{stiffer:g}", f"{e.half_width:.1f}"]
        values = (
            [e.reference[way] for way in WAYS] + [e.points[way] for way in of_law] + [e.nodes[way] for way in of_full]
        )
        pressure.append(line + [f"{value:.2%}" for value in values])
        values = [e.stress_points[way] for way in of_law] + [e.stress_nodes[way] for way in of_full]
        stress.append(line + [f"{value:.2%}" for value in values])
    head = [*fixed, *(f"{way} / reference" for way in WAYS), *sides]
    return f"""# Where a patch ends: "semi" and "full" beside the law itself

{MADE}
Two equal steel rollers, R = {RADIUS * 1e3:.0f} mm, linear cells, pressed together by the force that "full" has
at the approach, with a layer so many times as stiff as the surface under a hat. *Columns* of the grid, which is the
mesh, in a half-width. The law of the layer is met at the *nodes* ("full"), by pressures in *hats* ("semi"), by
pressures constant in *cells* around the nodes, or at *points* inside the elements; the last is the law itself on bodies
of that mesh. Worst of {len(PHASES)} places of the patch on the grid.

Pressure, meaned over the hats, L2 norm: against the *reference*, the law at points of {REFINED} times as many sectors;
against the *law* at points of the same mesh; against *full* on the same mesh.

{table(head, pressure)}
Stress under the patch, von Mises, the largest difference over the largest, on the same mesh:

{table([*fixed, *sides], stress)}
What to read from it. Nodes err where a patch ends between two of them: a node has its whole share of the surface or
nothing. Hats that are not negative cannot end inside a cell: the outermost one reaches beyond the patch, or is missing,
and its neighbours make up for it. Under a layer that yields like the penalties of practice both err by about the same,
in different ways, so that their difference is larger than either error; an evaluation without error would differ from
"full" by as much as "full" errs. Under a layer that is hardly there nodes are the better ones, and most of the
difference is an error of "semi": it excludes tension at every point of the surface, not only in the sum at a node.
Pressures in cells have less of it. The law at points, in hats that are cut off at the edge of the patch, would have
none, at a price: products of hats over a part of a cell are no constants of a body, so that no compliance of the
pressures could be tabulated when it is reduced, and any change of the edge would need rows of the local solve again.
"""


def main(folder: Path) -> None:
    """Writes the page to `folder`."""
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "pressure_ends.md").write_text(page(study()), encoding="utf-8")


if __name__ == "__main__":
    main(Path(sys.argv[1]) if len(sys.argv) > 1 else Path("docs/studies"))
