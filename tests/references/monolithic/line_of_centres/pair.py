r"""A contact pair in the monolithic system: gaps of its tests, the forces of their multipliers, and their derivatives.

With q the coordinates (global and local) of each body, Phi the traces on grid nodes and T the tests (`sampling`)

    g_i = sum_p T_pi (g_p(x) - N_p(x).Phi_B q_B) - W_i.Phi_A q_A,      N_p: B's shape functions at the point opposite p,

and multipliers s >= 0 act with the pressure `P_p = sum_i T_pi s_i` at the points: on the twelve rigid coordinates
`sum_p P_p Q_s(p)` (Q of the section, `frame`), on B's coordinates `-Phi_B^T N^T P`, on A's `-(W Phi_A)^T s`.
Law: 0 <= s, g + E s >= 0, s (g + E s) = 0; E = 0 for grid nodes, E = 1/(k a_i) for FE nodes of share a_i under a
surface layer of stiffness k [Pa/m].

Derivatives. All of g_p, the opposite point and Q depend on the rigid coordinates x, also through the angles at which
the line of centres meets the grids: `gap_slope` (n, 12) is the full dg/dx. It is not the transpose of the force,
because the wrench omits the change of those angles. `turning` are the derivatives of the forces on rigid
coordinates and on B's modes by x. With xi = (x_p - x_A) pitch, y = R_A sin xi, h = sqrt(R_B^2 - y^2) they follow from

    dxi = -pitch dx_A,  dy = R_A cos xi dxi,  dh = (R_B dR_B - y dy)/h,  dg_p = dd - dh + R_A sin xi dxi,
    place = x_B +- atan2(y, h)/pitch_B,  axial = axial_s + y t.e_B - h c.e_B.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from references.monolithic.core.local_coordinates import LocalCoordinates
from references.monolithic.core.state import Layout
from references.monolithic.line_of_centres.frame import RIGID, Side, Stations, side_of, stations
from references.monolithic.line_of_centres.sampling import NodalTests, NodeTests, Points, cells_of

LAWS = ("hats", "nodes")
STIFFER = 300.0  # layer over a node's own stiffness: a load on many nodes deflects more, so the force error is smaller
MARGIN = 3  # columns considered beyond the active ones
FIRST_HALF = 8  # columns on each side considered for a pair without contact


@dataclass(eq=False)
class PairData:
    """The constant data of a pair: sides, tests, traces and its unknowns.

    own (tests, n_A) = W Phi_A, other (nodes of B, n_B) = Phi_B; `columns`: unknowns, 12 rigid, then A's, then B's.
    """

    name: str
    a: Side
    b: Side
    tests: Any
    own: np.ndarray
    other: np.ndarray
    columns: np.ndarray
    layer: float  # Pa/m; 0: none (E = 0)
    half: int = FIRST_HALF
    rigid: int = RIGID  # number of rigid unknowns

    @property
    def widest(self) -> int:
        """Columns on each side of the line of centres with B's section opposite: a quarter revolution, less if B is
        the smaller of the two."""
        small = float(np.min(self.b.shape.radius_at(self.b.grid.z)))
        large = float(np.max(self.a.shape.radius_at(self.a.grid.z)))
        return max(int(np.arcsin(min(small / large, 1.0)) / self.a.grid.pitch) - 2, 1)


def pair_data(
    contact: Any,
    layout: Layout,
    surfaces: tuple[int, int],
    local: tuple[LocalCoordinates, LocalCoordinates],
    law: str,
    layer_stiffness: float | None,
) -> PairData:
    """The pair of `contact`, whose surfaces have the numbers `surfaces` in the layout."""
    a, b = side_of(contact.a), side_of(contact.b)
    first, second = contact.a.surface, contact.b.surface
    skin = contact.a.body.reduced.surface
    tests: Any = NodalTests(first) if law == "hats" else NodeTests(first, skin)
    phi_a = np.hstack([first.mode_normal, local[0].trace])
    phi_b = np.hstack([second.mode_normal, local[1].trace])
    layer = 0.0
    if law == "nodes":
        layer = default_layer(first) if layer_stiffness is None else float(layer_stiffness)
    unknowns = [6 * a.body + np.arange(6), 6 * b.body + np.arange(6)]
    for side, surface in ((a, surfaces[0]), (b, surfaces[1])):
        unknowns.append(6 * layout.bodies + layout.body_modes(side.body))
        unknowns.append(layout.of_surface(surface))
    own = np.ascontiguousarray(tests.own(phi_a))
    return PairData(contact.name, a, b, tests, own, phi_b, np.concatenate(unknowns), layer)


def default_layer(surface: Any) -> float:
    """Stiffness of the layer [Pa/m]: `STIFFER` times the stiffness of a node under its own pressure."""
    grid = surface.grid
    middle = np.array([grid.columns // 2])
    D = surface.compliance(middle)
    row = grid.rows // 2
    moment = grid.pitch * float(surface.gram_z[row].sum())
    return STIFFER / (float(D[row, row]) * moment)


@dataclass(eq=False)
class PairState:
    """A pair at a trial state: gap (n,), softness E (n,), area (n,), number (n,) of its tests; see the methods."""

    data: PairData
    points: Points
    frame: Stations
    gap: np.ndarray
    rigid_gap: np.ndarray
    softness: np.ndarray
    gap_slope: np.ndarray
    _first: int
    _load: np.ndarray
    _other: np.ndarray
    _place: tuple[np.ndarray, np.ndarray]
    _cells: tuple[np.ndarray, ...]
    _station_force: np.ndarray

    @property
    def number(self) -> np.ndarray:
        """Numbers (n,) of the tests, the same from step to step."""
        return self.points.number

    @property
    def area(self) -> np.ndarray:
        """Areas (n,) of the tests [m^2]; 0: nothing opposite."""
        return self.points.tests.area

    @property
    def first_other(self) -> int:
        """First column of B's grid in `loads`, on the branch of the opposite point."""
        return self._first

    def loads(self, tests: np.ndarray) -> np.ndarray:
        """N^T T (k, nodes): loads of B's grid nodes under unit multipliers of `tests`."""
        return self._load[tests]

    def rows(self, tests: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Gradients (k, columns) of the gaps of `tests`, and generalised forces (k, columns) of their multipliers."""
        by_modes = np.hstack([-self.data.own[self.number[tests]], -self.loads(tests) @ self._other])
        gradient = np.hstack([self.gap_slope[tests], by_modes])
        return gradient, np.hstack([self._station_force[tests], by_modes])

    def change(self, dz: np.ndarray) -> np.ndarray:
        """Linearised change (n,) of all gaps for the unknowns' changes dz (columns,) of the pair."""
        n_a = self.data.own.shape[1]
        by_a = self.data.own[self.number] @ dz[RIGID : RIGID + n_a]
        by_b = self._load @ (self._other @ dz[RIGID + n_a :])
        return self.gap_slope @ dz[:RIGID] - by_a - by_b

    def force(self, tests: np.ndarray, s: np.ndarray) -> np.ndarray:
        """Generalised force (columns,) of multipliers s of `tests`."""
        by_a = -(s @ self.data.own[self.number[tests]])
        by_b = -((s @ self._load[tests]) @ self._other)
        return np.concatenate([s @ self._station_force[tests], by_a, by_b])

    def turning(self, tests: np.ndarray, s: np.ndarray) -> np.ndarray:
        """Derivative (columns, 12) of `force` by the rigid coordinates."""
        n_a = self.data.own.shape[1]
        out = np.zeros((len(self.data.columns), RIGID))
        spread = np.zeros(len(self.number))
        spread[tests] = s
        P = self.points.tests.transposed.T @ spread
        out[:RIGID] = np.tensordot(s @ self.points.tests.by_station[tests], self.frame.d_force, 1)
        pressed = np.flatnonzero(P)
        around, along = (d[pressed] * P[pressed, None] for d in self._place)
        column, row, u, v = (c[pressed] for c in self._cells[:4])
        load = np.zeros((self._load.shape[1], RIGID))
        for step, part, d_part in ((0, 1.0 - u, -1.0), (1, u, 1.0)):
            for up, piece, d_piece in ((0, 1.0 - v, -1.0), (1, v, 1.0)):
                at = self._index(column + step, row + up)
                np.add.at(load, at, (d_part * piece)[:, None] * around + (d_piece * part)[:, None] * along)
        out[RIGID + n_a :] = -(self._other.T @ load)
        return out

    def _index(self, column: np.ndarray, row: np.ndarray) -> np.ndarray:
        """Position in B's window of its node (column, row)."""
        return (column - self._first) * self.data.b.grid.rows + row


def pair_state(
    data: PairData, r: np.ndarray, A: np.ndarray, q_a: np.ndarray, q_b: np.ndarray, *, derivatives: bool = True
) -> PairState:
    """The pair for bodies at r, A (B, ...) and coordinates q_a, q_b of its two sides."""
    a, b, tests = data.a, data.b, data.tests
    frame = stations(a, b, tests.z, r[a.body], A[a.body], r[b.body], A[b.body])
    middle = 0.5 * float(frame.x_a[0] + frame.x_a[-1])
    grid_a, grid_b, shape_a, shape_b = a.grid, b.grid, a.shape, b.shape
    points = tests.points(middle, min(data.half, data.widest), frame.faces)
    s = points.station
    xi = (points.x - frame.x_a[s]) * grid_a.pitch
    R = shape_a.radius_at(tests.z)[s]
    sine, cosine = np.sin(xi), np.cos(xi)
    y = R * sine
    R_s = shape_b.radius_at(frame.axial)[s]
    h = np.sqrt(R_s * R_s - y * y)
    axial = frame.axial[s] + y * frame.te[s] - h * frame.ce[s]
    crowned = shape_b.curvature != 0.0
    R_b = shape_b.radius_at(axial) if crowned else R_s
    h_b = np.sqrt(R_b * R_b - y * y) if crowned else h
    gap = frame.d[s] - h_b - R * cosine
    place = frame.x_b[s] + frame.sense * np.arctan2(y, h_b) / grid_b.pitch
    cells = cells_of(grid_b, place, axial)
    column, row, u, v, row_slope = cells
    first, wide = int(column.min()), int(column.max() - column.min()) + 2
    window = first + np.arange(wide)
    nodes = (np.mod(window, grid_b.columns)[:, None] * grid_b.rows + np.arange(grid_b.rows)).ravel()
    other = data.other[nodes]
    if not grid_b.periodic:
        other[np.repeat((window < 0) | (window >= grid_b.columns), grid_b.rows)] = 0.0
    T = points.tests
    corner = (column - first) * grid_b.rows + row
    steps = (0, 1, grid_b.rows, grid_b.rows + 1)
    parts = ((1.0 - u) * (1.0 - v), (1.0 - u) * v, u * (1.0 - v), u * v)
    at = T.test * len(nodes) + corner[T.point]
    size = len(T.area) * len(nodes)
    load = np.zeros(size)
    for shift, part in zip(steps, parts, strict=True):
        load += np.bincount(at + shift, T.value * part[T.point], size)
    load = load.reshape(len(T.area), len(nodes))
    field = other @ q_b
    rigid = T.transposed @ gap
    total = rigid - data.own[points.number] @ q_a - load @ field
    softness = np.zeros(len(total))
    if data.layer > 0.0:
        softness = 1.0 / (data.layer * T.area)
    station_force = T.by_station @ frame.force
    slope = np.zeros((len(total), RIGID))
    zero = np.zeros((0, RIGID))
    places = (zero, zero)
    if derivatives:
        d_xi = -grid_a.pitch * frame.d_x_a[s]
        d_y = (R * cosine)[:, None] * d_xi
        bend = shape_b.slope_at(frame.axial)[s]
        d_h = ((R_s * bend)[:, None] * frame.d_axial[s] - y[:, None] * d_y) / h[:, None]
        d_axial = frame.d_axial[s] + d_y * frame.te[s, None] + y[:, None] * frame.d_te[s]
        d_axial -= d_h * frame.ce[s, None] + h[:, None] * frame.d_ce[s]
        d_R = np.zeros_like(d_h)
        d_hb = d_h
        if crowned:
            d_R = shape_b.slope_at(axial)[:, None] * d_axial
            d_hb = (R_b[:, None] * d_R - y[:, None] * d_y) / h_b[:, None]
        d_gap = frame.d_d[s] - d_hb + (R * sine)[:, None] * d_xi
        d_place = (h_b[:, None] * d_y - y[:, None] * d_hb) / (R_b * R_b)[:, None] * (frame.sense / grid_b.pitch)
        d_place = d_place + frame.d_x_b[s]
        d_row = row_slope[:, None] * d_axial
        low = [field[corner + shift] for shift in steps]
        around = (1.0 - v) * (low[2] - low[0]) + v * (low[3] - low[1])
        along = (1.0 - u) * (low[1] - low[0]) + u * (low[3] - low[2])
        slope = T.transposed @ (d_gap - around[:, None] * d_place - along[:, None] * d_row)
        places = (d_place, d_row)
    return PairState(
        data, points, frame, total, rigid, softness, slope, first, load, other, places, cells, station_force
    )
