r"""Rolling with friction on contact-fixed cells: line contacts and elliptic point contacts on exact
elastic half-planes and half-spaces, the law of friction without a body around it.

Like materials. Pressure and traction are constant on each cell of a uniform grid about the middle of the patch, half
widths 1.3 times those of the patch. *Pressures* make the gap vanish at the centres of the cells under pressure and
leave it open at the others, at a given load (`pressed`). The bound of a cell is mu times its own pressure, its slip
is evaluated at its centre:

    s_i = w_i + e_new(x_i) - e_old(x_i + A),      e(x) = sum_j g(x - x_j) tau_j,

A the advance: the material now at x was at x + A before; w_i the rigid slip of the whole step: velocities
V (xi - phi y, eta + phi x), taken in the middle of the way inside the patch, x_i + min(A, d w)/2 (d below); spin taken
at x_i is 17 % low on 17 columns at one cell a step. Tractions oppose it: positive creepages give negative forces.
e_old is stored at the centres of the old grid and of three rings of cells around it and interpolated by cubic
Lagrange polynomials in each direction, clamped beyond; the old patch may have been of another size.

**Cells at the leading edge** receive the full rigid slip, and the elastic slip relative to free cells beyond the edge,
although they were in contact for a part of the step only. Along a row let c be the cells advanced and d the
distance from a cell to the edge ahead, in cells. Material that sticks from the touch on has accumulated

    s + k tau = 0,     k = 2 (g(0) - g(w)) min(c, 1) (max(c, 1)/d - 1) where that is positive, else 0.

For c >= 1: the cell touches when the part 1 - d/c of the step is over, as in `rolling`. For c < 1 the cell is in
contact all the time, but history is interpolated between it and a free cell ahead: a part c of their difference is
included, d of it would be correct. So it is in proportion to c and zero when the patch is at rest. The factor 2: a
cell's gain is the loss of its neighbour. The edge is e cells beyond the last centre under pressure, whose pressure is r
of its neighbour's (`edge_beyond`); `ahead` is added to d, for the front of a cell touches before its centre. These are
measured (docs/studies/patch_rolling.md).
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from scipy.optimize import brentq

from references.closed_forms import LineContact, contact_modulus
from references.closed_forms.elliptic import EllipticContact
from references.half_space.friction_program import project, solve
from references.half_space.influence import rectangle_approach, rectangle_displacement, strip_displacement
from references.half_space.rolling import STICK
from warpffrf.model.errors import InputError, require_count, require_number
from warpffrf.model.material import Material

Array = np.ndarray
SPAN = 1.3  # half-widths of the grid over those of the patch
RINGS = 3  # of cells around the grid at which displacements are stored: sufficient up to four cells per step
EDGE = (
    -0.175,
    0.95,
    0.6,
)  # cells from the last centre to the edge by powers of r; 0.02 off from 8 cells per half-width on
LARGEST_RATIO = 0.75  # r beyond which the next cell would be under pressure
LONE_EDGE = 0.5  # cells from the centre of a cell without neighbours under pressure to the edge
BOTH = 2.0  # the gain of a cell is the loss of its neighbour
AHEAD, AHEAD_SLOW = 0.2, 0.15  # cells by which a cell touches before its centre: 0.2, up to 0.35 at slow advance
LEAST_DISTANCE = 0.02  # cells: lower limit of the distance of loaded cells from the edge; keeps the divisor positive
STILL, MOST = 1e-4, 30.0  # change of the share per half-width that counts as none; half-widths rolled at most
DEPTH = 3.0  # half-widths at which a half-plane is fixed by default: above 2 SPAN, and transients are short
TRIALS = 60
OPEN = 1e-9  # of the approach: a smaller gap is closed
FORCE_ERROR = 1e-9  # of the largest slip, if one is sought


def lagrange(position: Array, count: int, order: int = 3) -> Array:
    """Weights (n, count) of values at 0, 1, ..., count - 1 in the value at `position` (n,), clamped to that range, by
    the polynomial of `order` 1 or 3 through the nodes around it."""
    q = np.clip(position, 0.0, count - 1.0)
    before = (order - 1) // 2
    first = np.clip(np.floor(q).astype(int) - before, 0, count - 1 - order)
    weights = np.zeros((len(q), count))
    t = q - first
    for i in range(order + 1):
        others = [j for j in range(order + 1) if j != i]
        weights[np.arange(len(q)), first + i] = np.prod([(t - j) / (i - j) for j in others], axis=0)
    return weights


def edge_beyond(last: Array, following: Array) -> Array:
    """Cells from the centre of the last cell under pressure to the edge of the patch; pressures of the last cell and
    of the one behind it, 0 where that is free."""
    ratio = np.minimum(last / np.where(following > 0.0, following, 1.0), LARGEST_RATIO)
    return np.where(following > 0.0, EDGE[0] + EDGE[1] * ratio + EDGE[2] * ratio**2, LONE_EDGE)


def to_edge(pressure: Array) -> Array:
    """Cells (n, m) from centres to the end of the patch ahead, along +x, of pressures (n, m); infinite where free."""
    n = len(pressure)
    found = np.full(pressure.shape, np.inf)
    nothing = np.zeros(pressure.shape[1])
    for i in range(n - 1, -1, -1):
        before = found[i + 1] if i + 1 < n else nothing + np.inf
        own = edge_beyond(pressure[i], pressure[i - 1] if i > 0 else nothing)
        found[i] = np.where(pressure[i] > 0.0, np.where(np.isfinite(before), before + 1.0, own), np.inf)
    return found


def ahead(cells: float) -> float:
    """Term added to the distance to the edge, in cells, at an advance of `cells`."""
    return AHEAD + AHEAD_SLOW * (1.0 - min(cells, 1.0))


def distance(pressure: Array, advance: tuple[float, float]) -> Array:
    """d (n, m): cells from centres to the edge in the direction of an advance in cells along x and y, by pressures
    (n, m), with `ahead`; infinite at free cells and if the patch is at rest.

    The edge is taken as straight between the points ahead along x and along y: 1/d = (c_x/d_x + c_y/d_y)/c.
    """
    inverse = np.zeros(pressure.shape)
    way = float(np.hypot(*advance))
    for axis, cells in enumerate(advance):
        if cells != 0.0:
            p = np.moveaxis(pressure, axis, 0)
            d = to_edge(p) if cells > 0.0 else to_edge(p[::-1])[::-1]
            d = np.maximum(d + ahead(way) * float(np.abs(advance).sum()) / way, LEAST_DISTANCE)
            inverse += np.moveaxis(abs(cells) / way / d, 0, axis)
    return 1.0 / np.maximum(inverse, np.finfo(float).tiny)


def lag(cells: float, d: Array) -> Array:
    """min(c, 1) (max(c, 1)/d - 1), not below 0, at an advance of c `cells` and the distance d (n,)."""
    return min(cells, 1.0) * np.maximum(max(cells, 1.0) / d - 1.0, 0.0)


@dataclass(frozen=True)
class Grid:
    """Cells of a patch: half-axes (d,) [m] of the patch, d = 1, 2; odd numbers of cells (d,) across 2 span of them."""

    half_axes: tuple[float, ...]
    columns: tuple[int, ...]
    span: float = SPAN

    @property
    def size(self) -> tuple[float, ...]:
        """Widths (d,) [m] of a cell."""
        return tuple(2.0 * self.span * a / n for a, n in zip(self.half_axes, self.columns, strict=True))

    def axis(self, k: int, rings: int = 0) -> Array:
        """Centres [m] along axis k, with rings; 0 for the second axis of a line."""
        if k >= len(self.columns):
            return np.zeros(1)
        half = (self.columns[k] - 1) // 2 + rings
        return self.size[k] * np.arange(-half, half + 1)

    def centers(self, rings: int = 0) -> Array:
        """Centres (n, m, 2) [m]."""
        return np.stack(np.meshgrid(self.axis(0, rings), self.axis(1, rings), indexing="ij"), axis=-1)


@dataclass(frozen=True)
class HalfPlanes:
    """Two half-planes in plane strain: modulus E* [Pa], depth L [m] of the fixed point."""

    modulus: float
    depth: float

    @classmethod
    def of(cls, contact: LineContact, depth: float = DEPTH) -> HalfPlanes:
        """depth: in half-widths."""
        return cls(contact.modulus, depth * contact.half_width)

    def normal(self, offset: Array, size: tuple[float, ...]) -> Array:
        """Displacement (...) [m/Pa] at `offset` (..., 2) [m] by a unit pressure on a cell."""
        return strip_displacement(offset[..., 0], size[0], self.modulus, self.depth)

    def tangential(self, offset: Array, size: tuple[float, ...]) -> Array:
        """Displacement (..., 1, 1) [m/Pa] by a unit traction on a cell."""
        return self.normal(offset, size)[..., None, None]


@dataclass(frozen=True)
class HalfSpaces:
    """Two half-spaces; `second` None: rigid. The coupling of unlike ones is neglected."""

    first: Material
    second: Material | None = None

    def normal(self, offset: Array, size: tuple[float, ...]) -> Array:
        """Displacement (...) [m/Pa] at `offset` (..., 2) [m] by a unit pressure on a cell."""
        return rectangle_approach(offset[..., 0], offset[..., 1], _pair(size), contact_modulus(self.first, self.second))

    def tangential(self, offset: Array, size: tuple[float, ...]) -> Array:
        """Displacements (..., 2, 2) [m/Pa] by unit tractions on a cell."""
        return rectangle_displacement(offset[..., 0], offset[..., 1], _pair(size), self.first, self.second)


def _pair(size: tuple[float, ...]) -> tuple[float, float]:
    return size[0], size[1]


def between(table: Array, shape: tuple[int, int], rings: tuple[int, int], on: Array) -> Array:
    """Responses (n + 2 r, m + 2 s, k, ...) at all cells of a grid of `shape` (n, m) and `rings` (r, s) around it by
    the k loaded ones `on` (n, m). table (2 (n + r) - 1, 2 (m + s) - 1, ...) by offsets, the cell itself
    in the middle.
    """
    i, j = np.nonzero(on)
    seen_i = np.arange(-rings[0], shape[0] + rings[0])[:, None, None]
    seen_j = np.arange(-rings[1], shape[1] + rings[1])[None, :, None]
    return table[seen_i - i + shape[0] + rings[0] - 1, seen_j - j + shape[1] + rings[1] - 1]


def pressed(contact: LineContact | EllipticContact, grid: Grid, body: HalfPlanes | HalfSpaces) -> Array:
    """Pressures (n, m) [Pa] of the contact on the cells. Raises InputError if the patch reaches the outermost."""
    centers = grid.centers()
    shape: tuple[int, int] = centers.shape[:2]
    radii = (contact.radius,) if isinstance(contact, LineContact) else (contact.radius_x, contact.radius_y)
    free, scaled = np.zeros(shape), np.zeros(shape)
    for k, (radius, half_axis) in enumerate(zip(radii, grid.half_axes, strict=True)):
        free += centers[..., k] ** 2 / (2.0 * radius)
        scaled += (centers[..., k] / half_axis) ** 2
    table = body.normal(_offsets(grid, 0), grid.size)
    active, load = scaled < 1.0, contact.load / float(np.prod(grid.size))
    for _ in range(TRIALS):
        G = between(table, shape, (0, 0), active)  # (n, m, k)
        k = G.shape[2]
        system = np.block([[G[active], np.full((k, 1), -1.0)], [np.ones((1, k)), np.zeros((1, 1))]])
        solution = np.linalg.solve(system, np.append(-free[active], load))
        p = np.zeros(shape)
        p[active] = solution[:-1]
        approach = float(solution[-1])
        found = np.where(active, p > 0.0, G @ solution[:-1] + free - approach < -OPEN * abs(approach))
        if np.array_equal(found, active):
            if active[[0, -1]].any() or (len(radii) > 1 and active[:, [0, -1]].any()):
                raise InputError("pressures on cells: the patch reaches the outermost cells")
            return p
        active = found
    raise RuntimeError("pressures on cells: no active set found")


def _offsets(grid: Grid, rings: int) -> Array:
    """Offsets (., ., 2) [m] between cells of the grid with rings and cells of the grid."""
    axes: list[Array] = [np.zeros(1), np.zeros(1)]
    for k, (w, n) in enumerate(zip(grid.size, grid.columns, strict=True)):
        axes[k] = w * np.arange(1 - n - rings, n + rings)
    return np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1)


@dataclass(eq=False)
class PatchRolling:
    """State of a rolling contact. Lengths m, pressures Pa; d = 1 or 2 directions, k cells under pressure.

    contact: Hertz, rolling along x; friction mu; columns: odd numbers of cells (d,) across 2 span half-axes; body: of
    the moduli of `contact`; order 1 or 3 of the history interpolation; its rings; late False: no softness at the edge.
    """

    contact: LineContact | EllipticContact
    friction: float
    columns: tuple[int, ...]
    body: HalfPlanes | HalfSpaces
    order: int = 3
    rings: int = RINGS
    late: bool = True
    span: float = SPAN
    grid: Grid = field(init=False)
    pressure: Array = field(init=False)  # (n, m) Pa
    traction: Array = field(init=False)  # (k, d)
    slip: Array = field(init=False)  # (k, d) [m] in the last step
    field_old: Array = field(init=False)  # (n + 2 r, m + 2 s, d) [m], s = 0 for lines
    least_loss: float = field(default=np.inf, init=False)  # smallest dissipation [J or J/m] of friction in a step

    def __post_init__(self) -> None:
        if any(require_count(n, "cells across a patch", 3) % 2 == 0 for n in self.columns):
            raise InputError(f"numbers of cells across a patch must be odd, got {self.columns}")
        require_number(self.friction, "friction", positive=True)
        self._lay()
        self.traction = np.zeros((int(self.on.sum()), len(self.columns)))
        self.slip = np.zeros_like(self.traction)
        self.field_old = np.zeros((*self._around, len(self.columns)))

    @property
    def _around(self) -> tuple[int, int]:
        n, m = self.pressure.shape
        return n + 2 * self.rings, m + 2 * self._ring_pair[1]

    @property
    def _ring_pair(self) -> tuple[int, int]:
        return self.rings, self.rings if len(self.columns) > 1 else 0

    def _lay(self) -> None:
        axes = (self.contact.half_width,) if isinstance(self.contact, LineContact) else self.contact.half_axes
        self.grid = Grid(axes, self.columns, self.span)
        self.pressure = pressed(self.contact, self.grid, self.body)
        table = self.body.tangential(_offsets(self.grid, self.rings), self.grid.size)
        if len(self.columns) == 1:
            table = table[:, :1]
        r, s = self._ring_pair
        responses = between(table, (self.pressure.shape[0], self.pressure.shape[1]), (r, s), self.on)
        self._responses = responses.swapaxes(2, 3)  # (., ., d, k, d)
        inner = self._responses[r : r + self.on.shape[0], s : s + self.on.shape[1]][self.on]
        k, d = inner.shape[:2]
        self.G = inner.reshape(k * d, k * d)
        middle = [n // 2 for n in table.shape[:2]]
        own = np.diagonal(table[middle[0], middle[1]])
        self._apart = np.array(
            [own - np.diagonal(table[middle[0] + (a == 0), middle[1] + (a == 1)]) for a in range(d)]
        )  # (axis, direction) g(0) - g(w)

    @property
    def on(self) -> Array:
        """Cells (n, m) under pressure."""
        return self.pressure > 0.0

    @property
    def centers(self) -> Array:
        """x, y (k, 2) [m] of the cells under pressure."""
        return self.grid.centers()[self.on]

    @property
    def area(self) -> float:
        """Of a cell [m2 or m]."""
        return float(np.prod(self.grid.size))

    @property
    def bound(self) -> Array:
        """mu p (k,)."""
        return self.friction * self.pressure[self.on]

    @property
    def force(self) -> Array:
        """(d,) [N or N/m]."""
        return self.traction.sum(axis=0) * self.area

    @property
    def share(self) -> Array:
        """Force (d,) over mu P: at gross slip of length 1."""
        return self.force / (self.friction * self.contact.load)

    @property
    def stick(self) -> Array:
        """Cells (k,) whose traction is below its bound."""
        return np.linalg.norm(self.traction, axis=1) < self.bound * (1.0 - STICK)

    def _weights(self, grid: Grid, advance: tuple[float, float]) -> list[Array]:
        """Weights by axis of the values stored on `grid` at the centres of the present grid plus the advance."""
        weights = [np.ones((1, 1))] * 2
        for a, n in enumerate(grid.columns):
            count = n + 2 * self.rings
            at = (self.grid.axis(a) + advance[a]) / grid.size[a] + (count - 1) // 2
            weights[a] = lagrange(at, count, self.order)
        return weights

    def _cells(self, advance: tuple[float, float]) -> tuple[float, float]:
        """Advance in cells along x and y."""
        size = self.grid.size
        return advance[0] / size[0], advance[1] / size[1] if len(size) > 1 else 0.0

    def _softened(self, advance: tuple[float, float]) -> Array:
        """G and the softness of cells at the leading edge."""
        cells = self._cells(advance)
        way = float(np.hypot(*cells))
        if not self.late or way == 0.0:
            return self.G
        lags = lag(way, distance(self.pressure, cells)[self.on])
        share = np.square(cells[: len(self.columns)]) / way**2
        return self.G + np.diag(np.outer(BOTH * lags, share @ self._apart).ravel())

    def _rigid(self, advance: tuple[float, float], creepage: tuple[float, float, float]) -> Array:
        """w (k, d) [m]: xi, eta [-], spin phi [1/m]."""
        cells = self._cells(advance)
        inside = np.ones(int(self.on.sum()))  # the part of the path inside the patch
        if self.late and any(advance):
            inside = np.minimum(distance(self.pressure, cells)[self.on] / np.hypot(*cells), 1.0)
        x, y = (self.centers + 0.5 * np.outer(inside, advance)).T
        way = float(np.hypot(*advance))
        slip = np.stack([creepage[0] - creepage[2] * y, creepage[1] + creepage[2] * x], axis=1) * way
        return slip[:, : len(self.columns)]

    def roll(
        self,
        advance: float | tuple[float, float],
        creepage: tuple[float, float, float],
        contact: LineContact | EllipticContact | None = None,
    ) -> None:
        """One step: the material advances by `advance` [m] along x, or along x and y, at creepages xi, eta [-] and spin
        phi [1/m]; `contact`: as it is at the end of the step."""
        way = _along_x(advance)
        was = self._enter(way, contact)
        self._slide(self._softened(way), self._rigid(way, creepage) - was)

    def shift(self, way: tuple[float, ...]) -> None:
        """One step of a patch at rest: rigid slip (d,) [m] everywhere, no rolling."""
        self._slide(self.G, np.array(way) - self._enter((0.0, 0.0), None))

    def shift_under(self, force: float, most: float) -> float:
        """One step of a patch at rest to the force [N or N/m] along x; returns the slip [m], sought within +-most."""
        was = self._enter((0.0, 0.0), None)
        along = np.eye(len(self.columns))[0]

        def excess(way: float) -> float:
            tau = solve(self.G, way * along - was, self.bound, self.traction)
            return (float(tau[:, 0].sum() * self.area) - force) / (self.friction * self.contact.load)

        way = float(brentq(excess, -most, most, xtol=FORCE_ERROR * most))  # pyright: ignore[reportArgumentType]
        self._slide(self.G, way * along - was)
        return way

    def _enter(self, advance: tuple[float, float], contact: LineContact | EllipticContact | None) -> Array:
        """The patch at the end of the step; returns e_old (k, d) [m] at the previous positions of the material."""
        old = self.grid
        if contact is not None:
            start = np.zeros((*self.pressure.shape, len(self.columns)))
            start[self.on] = self.traction
            self.contact = contact
            self._lay()
            self.traction = start[self.on]
        first, second = self._weights(old, advance)
        return np.einsum("ia,jb,abd->ijd", first, second, self.field_old, optimize=True)[self.on]

    def _slide(self, G: Array, s0: Array) -> None:
        self.traction = solve(G, s0, self.bound, self.traction)
        self.slip = (self.G @ self.traction.ravel()).reshape(s0.shape) + s0
        self._keep()
        self.least_loss = min(self.least_loss, float(-(self.traction * self.slip).sum() * self.area))

    def _keep(self) -> None:
        self.field_old = self._responses.reshape(*self._responses.shape[:3], -1) @ self.traction.ravel()

    def without_slip(self, advance: float | tuple[float, float]) -> Array:
        """Steady tractions (3, k, d) [Pa] per unit of xi, eta and phi if all cells stick: the limit of the law for
        small creepages."""
        way = _along_x(advance)
        first, second = self._weights(self.grid, way)
        r = self._responses
        was = np.einsum("ia,abdm->ibdm", first, r.reshape(*r.shape[:3], -1), optimize=True)
        was = np.einsum("jb,ibdm->ijdm", second, was, optimize=True)[self.on].reshape(self.G.shape)
        slips = np.array([self._rigid(way, (xi, eta, phi)).ravel() for xi, eta, phi in np.eye(3)])
        return np.linalg.solve(self._softened(way) - was, -slips.T).T.reshape(3, *self.traction.shape)

    def begin(self, advance: float | tuple[float, float], creepage: tuple[float, float, float]) -> None:
        """Starts from the steady tractions without slip, cut at the bounds: nearer to the steady state than rest."""
        self.traction = project(np.tensordot(creepage, self.without_slip(advance), axes=1), self.bound)
        self._keep()


def _along_x(advance: float | tuple[float, float]) -> tuple[float, float]:
    return advance if isinstance(advance, tuple) else (advance, 0.0)


def settle(
    rolling: PatchRolling, cells: float, creepage: tuple[float, float, float], still: float = STILL, most: float = MOST
) -> Array:
    """Rolls along x by `cells` per step until the share changes by less than `still` per half-width, `most` half-widths
    at most; returns the shares (steps, d)."""
    advance = cells * rolling.grid.size[0]
    each = max(int(np.ceil(rolling.grid.half_axes[0] / advance)), 1)
    shares = [rolling.share]
    for step in range(1, int(most * each) + 1):
        rolling.roll(advance, creepage)
        shares.append(rolling.share)
        if step >= 2 * each and np.abs(shares[-1] - shares[-1 - each]).max() < still:
            break
    return np.array(shares[1:])
