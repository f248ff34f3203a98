r"""`ContactSurface`: the data of a reduced body's contact surface for the simulation.

Symbols: `Phi_g` global modes with coordinates `q_g`, `psi_i` bilinear shape functions of the contact grid's nodes, `n`
outward normal of the true surface. The elastic displacement of a body is

    u = Phi_g q_g + (local part driven by the contact load)

and on a contact surface, as nodal coefficients of the outward normal displacement (L2 projection with the Gram matrix
`M` of the shape functions),

    u_n = mode_normal q_g + D f,      f_i = int psi_i p dA   (outward nodal forces, N),      D = M^-1 C M^-1.

On a body of N equal sectors `D` couples sectors by their distance only (block-circulant), so one block row is stored:
`D[(j,k),(j',k')] = lags[(j//c - j'//c) mod N][(j%c) rows + k, (j'%c) rows + k']`, `c` grid columns per sector.

Tangential compliance of a contact surface: required for friction in addition to the normal compliance.

Tangential tractions have two directions, 0: `e_theta`, around the axis, and 1: `t_z = (R' e_r + e_a)/sqrt(1 + R'^2)`,
along the meridian; with the outward normal `e_theta x t_z = n`. On their own grid (bilinear functions or cells, on the
nodes of the normal one) the coefficients of the tangential displacement, and their contribution to the normal one, are

    u_t = mode_tangent q_g + D_tt f_t + D_nt^T f_n,      u_n = mode_normal q_g + D f_n + D_nt f_t,

f_t forces [N] `int psi_i tau dA` of both directions, `D_tt = M_t^-1 C_tt M_t^-1`, `D_nt = M_n^-1 C_nt M_t^-1`. For a
cell the coefficient is the mean displacement and the force the traction times the area.

Recovery. Displacements of points of a body from the nodal forces of one of its contact surfaces.

Sampling. Reduced quadrature points of a contact surface: `Contact(quadrature="reduced")`.

The strip between two columns of a contact grid is periodic around the surface, so that one list of points serves every
strip. Point p lies at the fraction x_p of a column, and zeta_p between the rows row_p and row_p + 1; its weight w_p > 0
[m^2] is its share of the area of the strip. Integrals of a function f with the shape functions psi of the grid become

    int psi_i f dA  ~  sum over strips, sum_p w_p psi_i(x_p) f(x_p),

and shape functions add up to one, so that the weights of the points around a node add up to that node's area. The
points are chosen in `warpffrf.offline.contact.cubature`.

Cross compliance. Compliance between two contact surfaces of one body: the effect of loads on one on the other through
the local modes.

A load on one surface deforms the whole body. The part of the global modes is in their coordinates; the remainder is the
residual response, which also defines a surface's own compliance. At another surface t under a load on s, in the
coefficients and forces of `ContactSurface` and `Tangential`,

    u_n^t += D_ts f_n^s + D_nt f_t^s,      u_t^t += D_tn f_n^s + D_tt f_t^s,

    D_ts = M_t^-1 C_ts M_s^-1,      C_ts = (B psi)_t^T G_res (B psi)_s,      G_res = G - Phi_g omega^-2 Phi_g^T,

normals outward on each surface, tangential directions those of each surface. G_res is symmetric, so the other
direction is the transpose, and own and foreign compliances are together the Gram matrix of G_res,

    [D_tt^own  D_ts; D_ts^T  D_ss^own]   symmetric positive semidefinite,      |D_ts,ij|^2 <= D_tt,ii D_ss,jj.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np

from warpffrf.model.errors import InputError
from warpffrf.model.half_space import FarSplines
from warpffrf.model.messages import reprs
from warpffrf.model.reduced.contact_grid import SurfaceGrid
from warpffrf.model.reduced.far_field import FarField
from warpffrf.model.reduced.local_mass import LocalMass


@dataclass(frozen=True, eq=False, repr=False)
class ContactSurface(reprs.Shown):
    """A contact surface of a reduced body: its true shape, its grid, and the normal compliance (module docstring)."""

    name: str
    shape: Any  # resolved surface of revolution, see `warpffrf.model.surfaces`
    grid: SurfaceGrid
    lags: np.ndarray  # (sectors, c rows, c rows) m/N
    mode_normal: np.ndarray  # (columns rows, m) m per unit modal coordinate
    recovery: Recovery
    tangential: Tangential | None = None
    local_mass: LocalMass | None = None  # inertia of the local modes, see `warpffrf.model.reduced.local_modes`
    sampling: Sampling | None = (
        None  # reduced quadrature points, see `warpffrf.model.reduced.contact_surface`; None: not chosen
    )
    slope_lags: np.ndarray | None = (
        None  # change of D with tilted normals, `warpffrf.model.reduced.local_modes`; None: stiff bodies
    )
    far: FarField | None = (
        None  # for patches finer than the mesh, see `warpffrf.model.reduced.far_field`; None: not computed
    )

    def _facts(self) -> dict[str, Any]:
        grid = f"{self.grid.columns} x {self.grid.rows}"
        return {"name": self.name, "shape": type(self.shape).__name__, "grid": grid}

    @property
    def local_modes(self) -> int:
        """Number of normal local modes: one per node."""
        return self.grid.columns * self.grid.rows

    @property
    def half_space(self) -> bool:
        """Whether the body under it is rigid but for the half-space of a patch (`wf.half_space_body`)."""
        return self.far is not None and not self.lags.any()

    @property
    def unyielding(self) -> bool:
        """Whether the body under it is rigid altogether (`wf.rigid_film_body`)."""
        return self.far is None and not self.lags.any()

    @cached_property
    def splines(self) -> FarSplines:
        """The splines of the far field, with the transformation from nodal coefficients."""
        return FarSplines(self.grid, self.shape, self._turn)

    @cached_property
    def tangential_splines(self) -> FarSplines:
        """The same splines, with the transformation from the functions of tangential tractions. Raises `TypeError`
        without any."""
        if self.tangential is None:
            raise TypeError(f"contact surface {self.name!r} has no tangential tractions")
        return FarSplines(self.tangential.grid, self.shape, self._turn)

    @cached_property
    def mode_tangent_splines(self) -> np.ndarray:
        """Tangential displacement of the global modes (2, columns rows, m) [m per unit modal coordinate], splines.
        Raises `TypeError` without tangential tractions."""
        splines = self.tangential_splines
        assert self.tangential is not None
        return np.stack([splines.of_functions(modes) for modes in self.tangential.mode_tangent])

    @property
    def _turn(self) -> int:
        """Columns of the full revolution that the grid is part of, 0 if none."""
        turning = len(self.lags) > 1 or self.grid.periodic
        return len(self.lags) * self.grid.columns_per_sector if turning else 0

    @cached_property
    def gram_z(self) -> np.ndarray:
        """M_z (rows, rows) [m^2/rad], see `meridian_gram`."""
        return self.grid.gram_z(self.shape)

    def recover(self, forces: np.ndarray) -> np.ndarray:
        """Local displacement (n, 3) [m], user axes, of the display surface's points under outward nodal forces
        (columns, rows) [N]. Global modes are not included."""
        return self.recovery.apply(np.asarray(forces, dtype=np.float64), self.grid.columns_per_sector)

    def compliance(self, columns: np.ndarray) -> np.ndarray:
        """D (w rows, w rows) [m/N] of the nodes of the given grid `columns` (w,)."""
        c, rows = self.grid.columns_per_sector, self.grid.rows
        sector, part = columns // c, columns % c
        lag = (sector[:, None] - sector[None, :]) % len(self.lags)
        blocks = self.lags.reshape(len(self.lags), c, rows, c, rows)
        D = blocks[lag, part[:, None], :, part[None, :], :]
        return D.transpose(0, 2, 1, 3).reshape(len(columns) * rows, -1)


@dataclass(frozen=True, eq=False)
class Tangential:
    """Tangential part of a contact surface, block-circulant like its normal compliance.

    With `c` columns and `r` rows of a sector and the flat index `d*c*r + j*r + k` of direction d within a sector:
    `lags_tt (L, 2 c r, 2 c r)`, `lags_nt (L, c r, 2 c r)` [m/N], rows of the latter normal coefficients;
    block (s, s') of the operators is `lags[(s - s') mod L]`. Columns and rows are those of the normal grid.
    """

    grid: SurfaceGrid
    lags_tt: np.ndarray
    lags_nt: np.ndarray
    mode_tangent: np.ndarray  # (2, columns rows, m) m per unit modal coordinate
    recovery: Recovery  # its transfer has 2 c r columns per sector

    def compliance(self, columns: np.ndarray) -> np.ndarray:
        """D_tt (2 w r, 2 w r) [m/N] of the given grid `columns` (w,), ordered by direction, column, row."""
        c, r = self.grid.columns_per_sector, self.grid.rows
        lags = self.lags_tt.reshape(len(self.lags_tt), 2, c, r, 2, c, r)
        sector, part = columns // c, columns % c
        lag = (sector[:, None] - sector[None, :]) % len(lags)
        blocks = lags[lag, :, part[:, None], :, :, part[None, :], :]  # (w, w, 2, r, 2, r)
        return blocks.transpose(2, 0, 3, 4, 1, 5).reshape(2 * len(columns) * r, -1)

    def coupling(self, normal_columns: np.ndarray, columns: np.ndarray) -> np.ndarray:
        """D_nt (v r, 2 w r) [m/N]: normal coefficients at `normal_columns` (v,) per force on `columns` (w,)."""
        c, r = self.grid.columns_per_sector, self.grid.rows
        lags = self.lags_nt.reshape(len(self.lags_nt), c, r, 2, c, r)
        lag = (normal_columns[:, None] // c - columns[None, :] // c) % len(lags)
        blocks = lags[lag, (normal_columns % c)[:, None], :, :, (columns % c)[None, :], :]  # (v, w, r, 2, r)
        return blocks.transpose(0, 2, 3, 1, 4).reshape(len(normal_columns) * r, -1)

    def recover(self, forces: np.ndarray) -> np.ndarray:
        """Displacement (n, 3) [m], user axes, of the display points under forces (2, columns, rows) [N]."""
        r, recovery = self.grid.rows, self.recovery
        c = self.grid.columns_per_sector if recovery.sectors > 1 else self.grid.columns
        whole = np.zeros((2, c * recovery.sectors, r))
        place = recovery.offset + recovery.stride * np.arange(self.grid.columns)
        whole[:, place % whole.shape[1]] = forces
        by_sector = whole.reshape(2, recovery.sectors, c, r).transpose(1, 0, 2, 3).reshape(-1, r)
        return replace(recovery, offset=0, stride=1).apply(by_sector, 2 * c)


@dataclass(frozen=True, eq=False)
class Recovery:
    """Displacement of the display points under nodal forces: block-circulant, applied by FFT over the sectors.

    `transfer` (N//2 + 1, 3 p, c rows) complex64: displacement of one sector's `p` display points, in that sector's own
    axes, per harmonic amplitude of the nodal forces. `axes` (3, 3): columns are the axes of sector 0 in user axes, the
    third is the axis of rotation. A body without periodicity has one sector and a real transfer (1, 3 n, nodes). Grid
    column j is column `offset + j*stride` of the `c*N` columns that the harmonics count.
    """

    transfer: np.ndarray
    sectors: int
    axes: np.ndarray
    offset: int = 0
    stride: int = 1

    def apply(self, forces: np.ndarray, columns_per_sector: int) -> np.ndarray:
        """Displacement (n, 3) [m], user axes, of nodal forces (columns, rows) [N]."""
        N = self.sectors
        columns, rows = forces.shape
        whole = np.zeros((columns_per_sector * N, rows)) if N > 1 else np.zeros((columns, rows))
        whole[(self.offset + self.stride * np.arange(columns)) % len(whole)] = forces
        blocks = whole.reshape(N, -1)
        if N == 1:
            return (self.transfer[0] @ blocks[0].astype(self.transfer.dtype)).reshape(-1, 3).astype(np.float64)
        amplitudes = np.fft.rfft(blocks, axis=0)
        response = np.einsum("hpi,hi->hp", self.transfer, amplitudes)
        u = np.fft.irfft(response, n=N, axis=0).reshape(N, -1, 3)
        return sector_to_user(u, self.axes)


def sector_to_user(u: np.ndarray, axes: np.ndarray) -> np.ndarray:
    """Vectors (N, p, 3) given in the axes of their own sectors -> (N p, 3) in user axes.

    Sector s is sector 0 rotated by `2 pi s/N` about the third of `axes` (3, 3, columns = axes of sector 0).
    """
    N = len(u)
    angle = 2.0 * np.pi * np.arange(N)[:, None] / N
    c, s = np.cos(angle), np.sin(angle)
    turned = np.stack([c * u[..., 0] - s * u[..., 1], s * u[..., 0] + c * u[..., 1], u[..., 2]], axis=-1)
    return turned.reshape(-1, 3) @ axes.T


ALL_AROUND = 3  # Gauss points across a grid cell: the second grid's shape functions have kinks inside the cell
ALL_ALONG = 2  # Gauss points along a grid cell: exact for products of two linear functions


@dataclass(frozen=True, eq=False)
class Sampling:
    """Points of a strip: `fraction` (n,) of a column in [0, 1), `row` (n,) int, `zeta` (n,) in [0, 1], `weight` (n,)
    [m^2]; and their training data.

    `wanted_error`, `training_error`: of the integrals of a training family, against those by all points and over their
    size; requested, and the largest found. `mean_error`: root of the mean square over the families. `families`: their
    number.
    """

    fraction: np.ndarray
    row: np.ndarray
    zeta: np.ndarray
    weight: np.ndarray
    wanted_error: float
    training_error: float
    mean_error: float
    families: int

    def __post_init__(self) -> None:
        """Raises `InputError` for points outside a strip and for weights that are not positive."""
        n = len(self.fraction)
        if n == 0 or any(len(a) != n for a in (self.row, self.zeta, self.weight)):
            raise InputError("sampling: fraction, row, zeta and weight must have one entry a point, at least one")
        if np.any(self.fraction < 0.0) or np.any(self.fraction >= 1.0):
            raise InputError("sampling: a point's fraction of a column must be in [0, 1)")
        if np.any(self.row < 0) or np.any(self.zeta < 0.0) or np.any(self.zeta > 1.0):
            raise InputError("sampling: a point must lie between two rows, row >= 0 and zeta in [0, 1]")
        if not np.all(self.weight > 0.0):
            raise InputError("sampling: the weight of every point must be positive [m^2]")

    @property
    def count(self) -> int:
        """Number of points of a strip."""
        return len(self.fraction)

    @property
    def area(self) -> float:
        """Area of the strip [m^2], the sum of the weights."""
        return float(self.weight.sum())

    def axial(self, z: np.ndarray) -> np.ndarray:
        """Axial positions (n,) [m] of the points between the rows z (rows,) [m] of the grid."""
        return z[self.row] + self.zeta * (z[self.row + 1] - z[self.row])

    def arrays(self) -> dict[str, np.ndarray]:
        """Its arrays, for a file."""
        return {"fraction": self.fraction, "row": self.row, "zeta": self.zeta, "weight": self.weight}

    def facts(self) -> dict[str, Any]:
        """Its scalars, for a file and a report."""
        return {
            "wanted_error": float(self.wanted_error),
            "training_error": float(self.training_error),
            "mean_error": float(self.mean_error),
            "families": int(self.families),
        }

    @classmethod
    def restore(cls, arrays: dict[str, np.ndarray], facts: dict[str, Any]) -> Sampling:
        """The sampling stored in `arrays` and `facts`. Raises `InputError` as the constructor does."""
        return cls(**arrays, **facts)


def gauss_points(rows: int, around: int, along: int) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Tensor Gauss points of a strip between `rows` rows: fraction, row, zeta (n,) and the share (n,) of the area of a
    cell of the chart, whose sum is 1 per cell. Quadrature "full" has `ALL_AROUND` x `ALL_ALONG` of them."""
    (x, wx), (z, wz) = ((0.5 * (p + 1.0), 0.5 * w) for p, w in map(np.polynomial.legendre.leggauss, (around, along)))
    cell = np.arange(rows - 1)
    row, zeta, fraction = (a.ravel() for a in np.meshgrid(cell, z, x, indexing="ij"))
    share = np.broadcast_to(wz[:, None] * wx, (rows - 1, along, around)).ravel()
    return fraction, row.astype(np.int64), zeta, share.copy()


Array = np.ndarray
# Directions of the functions of target and source, by array: 1 normal, 2 tangential.
FUNCTIONS = {"lags": (1, 1), "lags_tt": (2, 2), "lags_nt": (1, 2), "lags_tn": (2, 1)}


@dataclass(frozen=True, eq=False)
class CrossCompliance:
    """Displacement of contact surface `target` under loads on contact surface `source` of the same body, by the local
    modes, in the layout of `ContactSurface.lags`:

        D[(j,k),(j',k')] = lags[(j//c_t - j'//c_s) mod sectors][(j%c_t) rows_t + k, (j'%c_s) rows_s + k'],

    c_t, c_s columns of a sector of both grids, `columns = sectors c`. Two full revolutions of a periodic body with the
    same column period keep their sectors; everywhere else `sectors` is 1 and c all columns. Tangential functions of a
    sector are numbered by direction, column, row.
    """

    target: str
    source: str
    lags: Array  # (sectors, c_t rows_t, c_s rows_s) m/N: normal per normal force
    lags_tt: Array | None = None  # (sectors, 2 c_t rows_t, 2 c_s rows_s) m/N: tangential per tangential force
    lags_nt: Array | None = None  # (sectors, c_t rows_t, 2 c_s rows_s) m/N: normal at target per tangential on source
    lags_tn: Array | None = None  # (sectors, 2 c_t rows_t, c_s rows_s) m/N: tangential at target per normal on source

    def transposed(self) -> CrossCompliance:
        """The same with target and source swapped: D_st = D_ts^T."""
        of_directions = {directions: key for key, directions in FUNCTIONS.items()}
        swapped = {}
        for key, lags in self.arrays().items():
            a, b = FUNCTIONS[key]
            swapped[of_directions[b, a]] = _swapped(lags)
        return CrossCompliance(self.source, self.target, **swapped)

    def arrays(self) -> dict[str, Array]:
        """The existing arrays, by name."""
        return {key: lags for key in FUNCTIONS if (lags := getattr(self, key)) is not None}

    def whole(self, key: str = "lags") -> Array:
        """The operator of the array `key`, all functions of the target by all of the source, [m/N], each numbered by
        direction, column, row."""
        lags = self.arrays()[key]
        sector = np.arange(len(lags))
        blocks = lags[(sector[:, None] - sector) % len(lags)]  # (target's sector, source's sector, rows, columns)
        (a, b), (L, _, m, n) = FUNCTIONS[key], blocks.shape
        return blocks.reshape(L, L, a, m // a, b, n // b).transpose(2, 0, 3, 4, 1, 5).reshape(L * m, L * n)


def _swapped(lags: Array) -> Array:
    """Blocks of the transpose: [l] = lags[-l]^T."""
    return np.ascontiguousarray(np.roll(lags[::-1], 1, axis=0).swapaxes(1, 2))
