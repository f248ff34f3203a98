r"""A contact surface of a rotationally periodic body: grid, loads per harmonic, Gram matrix per harmonic.

Hats of sector o load the nodes of sector 0 by `B_o` (in that sector's axes); a wave of hat coefficients
`s_o = s e^{i k o phi}` loads it by `B_k s`, `B_k = sum_o B_o e^{i k o phi}`, and `B_k^H u` are the conjugate
displacements. A grid coarser than the sectors, one column in q of them, has hats that are sums of fine ones with
weights `w_a = 1 - |a|/q`; stuffed with zeros it is a periodic signal on the fine columns, so `B_k` is multiplied by
`w_k = sum_a w_a e^{i k a phi}` and results are read at every q-th column: everything stays one harmonic at a time.

A facet set on an arc uses the operators of the full turn, of which it is a part: its hats keep their whole support, and
D and the projection of displacements are those of the full turn restricted to the hats of the arc.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from warpffrf.model.errors import InputError
from warpffrf.model.mesh import Mesh
from warpffrf.model.mesh.elements import facet_kind
from warpffrf.model.reduced_body import ContactGrid, axial_gram
from warpffrf.offline.contact_grid import (
    FEWEST_COLUMNS,
    ROUND_SPACING,
    SAME_PLACE,
    GridPlan,
    facet_chart,
    nodal_plan,
    thinned_rows,
)
from warpffrf.offline.hat_loads import HatLoads, hat_loads
from warpffrf.offline.sector import Sector, phase, turned

Array = np.ndarray


@dataclass(frozen=True)
class FacetPattern:
    """Facets of one sector `nodes` (u, k) (numbers below 2 nn), and the run of sectors that carry them."""

    nodes: np.ndarray
    first: int
    count: int


def facet_pattern(mesh: Mesh, name: str) -> FacetPattern | str:
    """How the facet set repeats from sector to sector, or why it does not."""
    if mesh.cyclic is None:
        return "the mesh is not marked as rotationally periodic"
    N, n = mesh.cyclic.sectors, len(mesh.points)
    nn = n // N
    if len(mesh.facets(name).blocks) > 1:
        return f"facet set {name!r} holds facets of several kinds"
    nodes = mesh.facets(name).single[1]
    sector = nodes // nn
    low, high = sector.min(axis=1), sector.max(axis=1)
    own = np.where((low == 0) & (high == N - 1), N - 1, low)
    local = (nodes - nn * own[:, None]) % n
    if local.max() >= 2 * nn:
        return f"facets of {name!r} reach over more than two sectors"
    unique, kind = np.unique(local, axis=0, return_inverse=True)
    present = np.unique(own)
    if len(nodes) != len(present) * len(unique) or len(np.unique(own * len(unique) + kind.ravel())) != len(nodes):
        return f"facet set {name!r} differs from sector to sector"
    breaks = np.flatnonzero((present + 1) % N != np.roll(present, -1))
    if len(breaks) > 1:
        return f"facet set {name!r} covers more than one run of sectors"
    first = 0 if len(present) == N else int(present[(breaks[0] + 1) % len(present)])
    return FacetPattern(unique, first, len(present))


class CyclicSurface:
    """Grid, loads and Gram matrix of one contact surface, harmonic by harmonic."""

    def __init__(self, mesh: Mesh, sector: Sector, name: str, shape, pattern: FacetPattern, spacing: float | None):
        self.name, self.shape = name, shape
        self.N, nn = sector.count, sector.nodes
        kind = mesh.facets(name).single[0]
        corners = facet_kind(kind).corner_count
        chart = facet_chart(mesh.points, kind, pattern.nodes, shape)
        shift = nn * np.arange(self.N)[:, None, None]
        whole = (pattern.nodes[None] + shift).reshape(-1, pattern.nodes.shape[1]) % len(mesh.points)
        whole_chart = facet_chart(mesh.points, kind, whole, shape)
        first = float(chart.theta.min())
        self.edge = chart.edge
        pitch = 2.0 * np.pi / self.N
        arc = pitch * float(np.max(shape.radius_at(chart.z)))
        self.stride, plan = 1, None
        if spacing is None:
            plan = nodal_plan(whole_chart, name, first)
            if plan is not None and plan.columns % self.N:
                plan = None
            spacing = chart.edge
        if plan is None:
            per_sector = int(arc / spacing * (1.0 + ROUND_SPACING))
            if per_sector < 1:
                reach = spacing * (1.0 + SAME_PLACE)
                strides = range(2, self.N // FEWEST_COLUMNS + 1)
                self.stride = max([q for q in strides if not self.N % q and q * arc <= reach], default=1)
            rows = thinned_rows(chart.z[:, :corners], spacing)
            columns = self.N * max(per_sector, 1)
            plan = GridPlan(first, 2.0 * np.pi / columns, columns, True, rows, False)
        self.c = plan.columns // self.N
        self.rows = len(plan.z)
        self.z = plan.z
        self.gram_z = axial_gram(shape, plan.z)
        self.pitch = plan.pitch * self.stride
        self._B = self._loads(hat_loads(kind, pattern.nodes, chart, shape, plan), sector, nn)
        self.grid, self.offset = self._grid(plan, pattern)

    @property
    def hats(self) -> int:
        """Hats of one sector."""
        return self.c * self.rows

    def _loads(self, loads: HatLoads, sector: Sector, nn: int) -> dict[int, Array]:
        of_node, node = loads.node // nn, loads.node % nn
        of_hat, part = loads.column // self.c, loads.column % self.c
        B: dict[int, Array] = {}
        for s in (0, 1):
            axes = np.stack([turned(a[None], sector.axes, s * sector.phi)[0] for a in sector.axes.T], axis=1)
            for o in np.unique(of_hat[of_node == s]):
                here = (of_node == s) & (of_hat == o)
                block = B.setdefault(int(o) - s, np.zeros((nn, 3, self.hats)))
                hat = part[here] * self.rows + loads.row[here]
                for d in range(3):
                    np.add.at(block[:, d], (node[here], hat), loads.value[here] @ axes[:, d])
        return {o: block.reshape(3 * nn, self.hats) for o, block in B.items()}

    def _grid(self, plan: GridPlan, pattern: FacetPattern) -> tuple[ContactGrid, int]:
        q, c, N = self.stride, self.c, self.N
        full = pattern.count == N
        if full:
            first, columns = 0, plan.columns // q
        elif q > 1:
            first = -(-pattern.first // q) + 1
            columns = (pattern.first + pattern.count) // q - first
        else:
            first, columns = c * (pattern.first + 1), c * (pattern.count - 1)
        if columns < 1:
            raise InputError(
                f"contact {self.name!r}: the facets span {pattern.count} sectors, too short for one hat; "
                "choose a longer arc or a smaller traction_spacing"
            )
        e_0 = np.asarray(self.shape.e_0, dtype=float)
        start = plan.theta_start + first * self.pitch
        return ContactGrid(e_0, start, self.pitch, columns, full, self.z, c), first * q

    def load(self, k: int) -> Array:
        """B_k (3 nn, hats)."""
        total = sum(phase(k * o, self.N) * block for o, block in self._B.items())
        q = self.stride
        weight = sum((1.0 - abs(a) / q) * np.cos(2.0 * np.pi * k * a / self.N) for a in range(1 - q, q))
        return np.asarray(total) * weight

    def without_gram(self, k: int, values: Array) -> Array:
        """M_k^-1 `values` (hats, m), M_k the Gram matrix of the hats in harmonic k."""
        c, rows = self.c, self.rows
        M = np.zeros((c, c), dtype=complex)
        for a in range(c):
            for d, entry in ((-1, 1.0 / 6.0), (0, 2.0 / 3.0), (1, 1.0 / 6.0)):
                M[a, (a + d) % c] += self.pitch * entry * phase(self.stride * k * ((a + d) // c), self.N)
        around = np.linalg.solve(M, values.reshape(c, -1)).reshape(c, rows, -1)
        return np.linalg.solve(self.gram_z, around).reshape(c * rows, -1)

    def sampled(self, k: int, amplitude: Array) -> Array:
        """Waves `amplitude` (hats, m) e^{i k s phi} at the columns of the grid: (columns rows, m), complex."""
        fine = self.offset + self.stride * np.arange(self.grid.columns)
        wave = np.array([phase(k * int(s), self.N) for s in fine // self.c])
        parts = amplitude.reshape(self.c, self.rows, -1)[fine % self.c]
        return (parts * wave[:, None, None]).reshape(len(fine) * self.rows, -1)
