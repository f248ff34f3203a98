r"""Effect of a free end face on a contact near it: the elastic quarter space under a point load.

Frame: the material is at depth `y >= 0` below the surface `y = 0` and at distance `zeta >= 0` from the free end face
`zeta = 0`; `s` runs along the edge. A force F pushes into the surface (towards +y) at `(s, zeta) = (0, d)`. Its
displacement is

    u = F/E [ b(s, zeta - d, y) + b(s, zeta + d, y) + w(s, zeta, y; d) ],

with Boussinesq's half-space solution b of the load and of its mirror image. Load and image together leave no shear on
the end face but twice the load's normal stress there; the *correction* w is the response of the quarter space to its
removal: traction `+2 sigma_zz(s, y; d)` along +zeta on the end face, free surface. It is smooth, as its source is at
least d away from the load, depends on Poisson's ratio alone and is homogeneous: `w(c x; c d) = w(x; d)/c`.

**One harmonic.** With z for zeta and `w_s = U sin ks`, `(w_z, w_y) = (Z, Y) cos ks` the problem is one in the quarter
*plane*,

    min int lam (kU + Z_z + Y_y)^2/2 + mu (k^2 U^2 + Z_z^2 + Y_y^2)
            + mu/2 [ (U_z - kZ)^2 + (U_y - kY)^2 + (Z_y + Y_z)^2 ] dA - int T(y; d, k) Z(0, y) dy.

By homogeneity one k suffices: the harmonic k of the load at d is the harmonic 1 of the load at kd. So *one* matrix is
factorised, for k = 1, and solved for many loads d from 1e-5 to 14. As the solutions decay like exp(-kr), truncating the
plane at 16 costs 1e-7 and no far boundary is required. The elements are of high order, which do not lock for
nearly incompressible materials, and grow geometrically from the edge.

The traction follows from Boussinesq's potential chi, `d chi/dy = 1/R`: `2 pi sigma_zz = 2 nu chi_yy - y chi_yzz -
(1 - 2 nu) chi_zz`. The transform of 1/R over s is `2 K0(kr)`, with r from the load's line, so that

    X_y = 2 K0(r),  X_yy = -2 y/r K1(r),  X = -pi exp(-d) + int_0^y 2 K0,  X_zz = X - X_yy,
    X_yzz = 2 d^2/r^2 K2(r) - 2 K1(r)/r = 2 d^2/r^2 K0(r) + 2 (2 d^2/r^2 - 1) K1(r)/r    (k = 1, z = d).

**Back to a point load.** `w = 1/pi int (U sin ks, Z cos ks, Y cos ks) dk`. The harmonics of a load near the edge decay
slowly near the edge; the factor `exp(-(k/30)^4)` truncates the integral. It smooths w along s over 1/30 of `d + |x|`,
yet reproduces polynomials of degree 3: w has no features that small. For k -> 0 the amplitudes vary like
`(1 - nu^2) (0, a, b) log k`: the plane is loaded by the force `F = -2/pi` of the tractions at its apex, balanced by
Michell's wedge of 90 deg, `sigma_r = (a cos + b sin)/r`, with `a = -(pi/4) F/D`, `b = F/(2 D)`, `D = pi^2/16 - 1/4`.

**The table.** `d + |x| = 1` is reached by scaling; with `t = |x|/(d + |x|)`, and the angles `theta` from the s axis and
`phi` from the surface towards the depth, `g(t, theta, phi) = (d + |x|) w` is bounded and smooth on a box. `t = 0` is
the edge next to the load, `t = 1` a load on the edge, or w far away. Quadratic splines interpolate in the volume, cubic
ones on the surface; `g_s/cos(theta)` is stored instead of `g_s`, which is odd in s.

Measured for nu 0, 0.3 and 0.49, relative to the displacement of half-space and image: 1.5e-4 on the surface (plane
strain, Michell's wedge and reciprocity), 4e-4 in the volume (a table with twice the nodes).
"""

from __future__ import annotations

import functools
import logging
import os
import zipfile
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import scipy.sparse as sp
from numpy.polynomial import legendre
from numpy.typing import ArrayLike
from scipy.interpolate import make_interp_spline
from scipy.ndimage import map_coordinates
from scipy.special import k0, k1

from warpffrf.model.errors import InputError
from warpffrf.model.half_space import DEGREE as SURFACE_DEGREE
from warpffrf.model.half_space import QuarterSurface, require_inside
from warpffrf.offline.cache import cache_folder
from warpffrf.offline.solvers import factorise

__all__ = ["FULL", "QuarterSpace", "Resolution"]

logger = logging.getLogger("warpffrf.offline")
VERSION = 1  # incremented whenever a table gets other numbers for the same Poisson ratio
LARGEST_RATIO = 0.495  # beyond it the Lame constant 1/(1 - 2 nu) costs too many digits of the matrix
EXTENT = 16.0  # size of the quarter plane of the harmonic 1: solutions have decayed to exp(-16)
NEAREST, FARTHEST = 1e-5, 14.0  # loads solved; farther ones leave exp(-14)
LIMIT = 5e-3  # d / (d + |x|) of the loads from which the limit d = 0, in which w is linear, is extrapolated
LONGEST = NEAREST / LIMIT  # harmonic below which the limit of long waves is taken
TAPER = 30.0  # harmonic at which the transform is tapered, for d + |x| = 1
VOLUME_DEGREE = 2  # of the splines; quadratic ones cost half as much in three dimensions as cubic ones
LAST = 2.2 * TAPER  # where the taper has fallen to exp(-23)

Array = np.ndarray


@dataclass(frozen=True)
class Resolution:
    """Resolution of a table.

    `order` of the elements; `growth` of their size from the edge, at most `largest` (wavelengths over 2 pi); `loads`
    solved per decade of d; `harmonics` per point in the transform; `nodes` of the table along t, theta and phi.
    """

    order: int = 6
    growth: float = 2.2
    largest: float = 2.0
    loads: int = 10
    harmonics: int = 120
    nodes: tuple[int, int, int] = (33, 21, 17)


FULL = Resolution()


class QuarterSpace:
    """The correction w of a quarter space of one Poisson ratio (module docstring: frame, signs, equations).

    All lengths are in one unit, such as m; results are per unit load and *times Young's modulus*: multiply by F/E for a
    displacement. `QuarterSpace(nu)` reads its table from the cache folder, or computes it (some 8 s) and stores it
    there; `cached=False` neither reads nor writes. Raises `InputError` unless `0 <= poisson_ratio <= 0.495`.
    """

    def __init__(self, poisson_ratio: float, resolution: Resolution = FULL, *, cached: bool = True) -> None:
        if not 0.0 <= poisson_ratio <= LARGEST_RATIO:
            raise InputError(f"quarter space: Poisson's ratio must be in [0, {LARGEST_RATIO}], got {poisson_ratio}")
        self.poisson_ratio = float(poisson_ratio)
        path = _table_file(self.poisson_ratio) if cached and resolution == FULL else None
        table = _load(path) if path else None
        if table is None:
            table = _table(self.poisson_ratio, resolution)
            if path:
                _store(path, table)
        self._steps = np.array(table.shape[1:]) - 1
        self._volume = [_spline(g, VOLUME_DEGREE) for g in table]
        self.on_surface = QuarterSurface(_spline(table[2][:, :, 0], SURFACE_DEGREE))

    def displacement(self, s: ArrayLike, zeta: ArrayLike, y: ArrayLike, d: ArrayLike) -> Array:
        """Correction (3, ...) [1/m] along s, zeta and depth at points `(s, zeta, y)` [m] of loads at `zeta = d` [m].

        The arguments are broadcast together. The edge (`zeta = y = 0`) and a load on it (`d = 0`) are allowed, but not
        both at one point, where w is infinite (the result is not finite there). Raises `InputError` for points or loads
        outside the material.
        """
        x, z, depth, load = np.broadcast_arrays(*(np.asarray(a, float) for a in (s, zeta, y, d)))
        require_inside(z, depth, load)
        across = np.hypot(z, depth)
        radius = np.hypot(x, across)
        places = [radius / (radius + load), np.arctan2(across, np.abs(x)) / (np.pi / 2)]
        places.append(np.arctan2(depth, z) / (np.pi / 2))
        at = [place * n + 1.0 for place, n in zip(places, self._steps, strict=True)]
        w = np.stack([_read(c, at, VOLUME_DEGREE) for c in self._volume])
        w[0] *= np.divide(x, radius, out=np.zeros_like(radius), where=radius > 0.0)
        return w / (radius + load)

    def surface(self, s: ArrayLike, zeta: ArrayLike, d: ArrayLike) -> Array:
        """Depth component (...) [1/m] of w at the points `(s, zeta)` [m] of the surface, of loads at `zeta = d` [m].

        Exactly symmetric in `zeta` and `d` (Maxwell-Betti): the mean of both evaluations of the table. Arguments and
        errors as in `displacement`.
        """
        return self.on_surface.displacement(s, zeta, d)


# The table: computation, storage, interpolation ---------------------------------------------------------------------


@functools.lru_cache(maxsize=4)  # cache folders that cannot be written, or change, do not cause another computation
def _table(nu: float, resolution: Resolution) -> Array:
    """g (3, t, theta, phi), its first component divided by cos(theta)."""
    plane = _QuarterPlane(nu, resolution)
    t, theta, phi = (np.linspace(0.0, 1.0, n) for n in resolution.nodes)
    theta, phi = np.meshgrid(theta * np.pi / 2, phi * np.pi / 2, indexing="ij")
    along, zeta, y = np.cos(theta), np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi)
    g = np.stack([_at_points(plane, radius, along, zeta, y, resolution.harmonics) for radius in t[:-1]], axis=1)
    near, nearer = (_at_points(plane, 1.0 - e, along, zeta, y, resolution.harmonics) for e in (2.0 * LIMIT, LIMIT))
    return np.concatenate([g, (2.0 * nearer - near)[:, None]], axis=1)


def _at_points(plane: _QuarterPlane, t: float, along: Array, zeta: Array, y: Array, harmonics: int) -> Array:
    """g (3, ...) for loads at d = 1 - t and points at `t (along, zeta, y)`; the first component divided by `along`."""
    x, weights = legendre.leggauss(harmonics)
    x, weights = (1.0 + x) / 2, weights / 2
    k = LAST * x**3  # the harmonics vary like log k for k -> 0
    weights = weights * 3.0 * LAST * x**2 * np.exp(-((k / TAPER) ** 4)) / np.pi
    use = k * (1.0 - t) <= FARTHEST
    k, weights = k[use], weights[use]
    solved = np.maximum(k, LONGEST)
    far = solved * t
    grid_node = plane.read(
        plane.fields(solved * (1.0 - t)), np.multiply.outer(far, zeta.ravel()), np.multiply.outer(far, y.ravel())
    )
    grid_node += plane.long_waves[:, None, None] * np.log(k / solved)[:, None]
    phase = np.multiply.outer(k * t, along.ravel())
    even = np.cos(phase) * weights[:, None]
    odd = (k * t)[:, None] * np.sinc(phase / np.pi) * weights[:, None]
    return np.einsum("ckp,ckp->cp", grid_node, np.stack([odd, even, even])).reshape(3, *along.shape)


def _table_file(nu: float) -> Path:
    return cache_folder() / f"quarter_space_{VERSION}_{float(nu).hex()}.npz"


def _load(path: Path) -> Array | None:
    """The table in `path`, or None if there is none or it cannot be read."""
    if not path.is_file():
        return None
    try:
        with np.load(path) as file:
            table = file["g"]
    except (OSError, ValueError, KeyError, EOFError, zipfile.BadZipFile) as error:
        logger.warning("table of the quarter space dropped: %s", error)
        return None
    if table.shape != (3, *FULL.nodes) or not np.isfinite(table).all():
        logger.warning("table of the quarter space dropped: %s does not hold one", path)
        return None
    return table


def _store(path: Path, table: Array) -> None:
    """Write `table`; a concurrent reader gets the old file or the new one. A failure is only reported."""
    part = path.with_suffix(f".{os.getpid()}.part")
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        with part.open("wb") as file:
            np.savez(file, g=table)
        part.replace(path)
    except OSError as error:
        logger.warning("the table of the quarter space could not be cached: %s", error)


def _spline(values: Array, degree: int) -> Array:
    """Coefficients (n + 2 along each axis) of the spline of `degree` 2 or 3 through `values` at whole numbers.

    The free parameters at each end are chosen so that polynomials of that degree are interpolated exactly.
    """
    at_node = {2: (1 / 8, 6 / 8, 1 / 8), 3: (1 / 6, 4 / 6, 1 / 6)}[degree]
    at_end = {2: (1.0, -3.0, 3.0, -1.0), 3: (1.0, -4.0, 6.0, -4.0, 1.0)}[degree]
    for axis, n in enumerate(values.shape):
        matrix = np.zeros((n + 2, n + 2))
        for i in range(n):
            matrix[i + 1, i : i + 3] = at_node
        matrix[0, : degree + 2] = matrix[-1, -degree - 2 :] = at_end
        right = np.zeros((n + 2, *np.delete(values.shape, axis)))
        right[1:-1] = np.moveaxis(values, axis, 0)
        solved = np.linalg.solve(matrix, right.reshape(n + 2, -1)).reshape(right.shape)
        values = np.moveaxis(solved, 0, axis)
    return np.ascontiguousarray(values)


def _read(coefficients: Array, at: list[Array], degree: int) -> Array:
    """The spline (...) at the points `at`, one array (...) per axis, 1 at the first node of each."""
    flat = [a.ravel() for a in at]
    return map_coordinates(coefficients, flat, order=degree, prefilter=False).reshape(at[0].shape)


# The harmonic 1 in the quarter plane ---------------------------------------------------------------------------------


class _QuarterPlane:
    """Amplitudes (U, Z, Y) of the harmonic 1 for loads at any distance d from the end face."""

    def __init__(self, nu: float, resolution: Resolution) -> None:
        self.line = _Line(resolution)
        force = -2.0 / np.pi  # of the tractions that a line load leaves on the end face
        stress = np.array([0.0, -np.pi / 4, 0.5]) * force / (np.pi**2 / 16 - 0.25)
        self.long_waves = (1.0 - nu**2) * stress  # times log k gives the amplitudes for k -> 0
        n = self.line.size
        count = round(resolution.loads * np.log10(FARTHEST / NEAREST)) + 1
        d = np.geomspace(NEAREST, FARTHEST, count)
        loads = np.zeros((3, n, n, count))
        loads[1, 0] = self.line.load(d, nu)
        inner = np.zeros((n, n), bool)
        inner[:-1, :-1] = True
        free = np.tile(inner.ravel(), 3)
        K = _stiffness(self.line, nu)[free][:, free]
        u = np.zeros((3 * n * n, count))
        u[free] = factorise(K).solve(loads.reshape(3 * n * n, count)[free])
        self._spline: Any = make_interp_spline(np.log(d), u.T, k=5)

    def fields(self, d: Array) -> Array:
        """Amplitudes (m, 3, n, n) at the nodes of the plane (z, y) of loads at d (m,)."""
        at = np.log(np.clip(d, NEAREST, FARTHEST))
        return self._spline(at).reshape(len(d), 3, self.line.size, self.line.size)

    def read(self, fields: Array, z: Array, y: Array) -> Array:
        """Amplitudes (3, m, p) of `fields` (m, 3, n, n) at the points z, y (m, p) of each; none outside the plane."""
        (i, a), (j, b) = self.line.values(z), self.line.values(y)
        which = np.arange(len(fields))[:, None]
        out = np.zeros((3, *z.shape))
        for p in range(a.shape[-1]):
            for q in range(b.shape[-1]):
                at = fields.transpose(0, 2, 3, 1)[which, i + p, j + q]
                out += np.moveaxis(at, -1, 0) * (a[..., p] * b[..., q])
        return out


class _Line:
    """Elements of high order on [0, EXTENT], refined towards 0, with their one-dimensional integrals."""

    def __init__(self, resolution: Resolution) -> None:
        self.order = p = resolution.order
        ends = [0.0, 0.5 * NEAREST]
        while ends[-1] < EXTENT:
            ends.append(ends[-1] + min((resolution.growth - 1.0) * ends[-1], resolution.largest))
        self.ends = np.array(ends) * EXTENT / ends[-1]
        basis = legendre.Legendre.basis(p)
        self.nodes = np.concatenate([[-1.0], np.sort(np.real(basis.deriv().roots())), [1.0]])  # Gauss-Lobatto
        self.vandermonde = np.linalg.inv(legendre.legvander(self.nodes, p))
        x, weights = legendre.leggauss(p + 1)
        N = self._shapes(x)
        dN = np.stack([legendre.legval(x, legendre.legder(c)) for c in self.vandermonde.T], axis=-1)
        self.mass = self._assemble(N.T @ (N * weights[:, None]), 1)
        self.mixed = self._assemble(N.T @ (dN * weights[:, None]), 0)  # int N_a dN_b
        self.stiffness = self._assemble(dN.T @ (dN * weights[:, None]), -1)

    @property
    def size(self) -> int:
        """Number of nodes."""
        return (len(self.ends) - 1) * self.order + 1

    def _shapes(self, x: Array) -> Array:
        return legendre.legvander(x, self.order) @ self.vandermonde

    def _assemble(self, local: Array, power: int) -> Any:
        half = np.diff(self.ends) / 2
        dofs = self.order * np.arange(len(half))[:, None] + np.arange(self.order + 1)
        data = half[:, None, None] ** power * local
        rows = np.broadcast_to(dofs[:, :, None], data.shape)
        columns = np.broadcast_to(dofs[:, None, :], data.shape)
        return sp.coo_matrix((data.ravel(), (rows.ravel(), columns.ravel())), shape=(self.size, self.size)).tocsr()

    def values(self, x: Array) -> tuple[Array, Array]:
        """First node (...) of the element around each x, and its shape functions (..., order + 1); 0 beyond the end."""
        e = np.clip(np.searchsorted(self.ends, x, side="right") - 1, 0, len(self.ends) - 2)
        left, right = self.ends[e], self.ends[e + 1]
        N = self._shapes(np.clip((2.0 * x - left - right) / (right - left), -1.0, 1.0))
        return self.order * e, N * (x <= self.ends[-1])[..., None]

    def load(self, d: Array, nu: float) -> Array:
        """int N_a T(y; d) dy (n, m) for loads at d (m,)."""
        points = 2 * self.order + 4
        x, weights = legendre.leggauss(points)
        # integrals of the interpolation polynomial from -1 to each point
        powers = np.linalg.inv(legendre.legvander(x, points - 1))
        upto = np.stack([legendre.legval(x, legendre.legint(c, lbnd=-1)) for c in powers.T], axis=-1)
        half = np.diff(self.ends) / 2
        y = (self.ends[:-1, None] + half[:, None] * (1.0 + x)).ravel()
        r = np.hypot(y[:, None], d)
        near, slope = 2.0 * k0(r), 2.0 * k1(r) / r  # X_y and -X_yy/y
        parts = near.reshape(len(half), points, len(d)) * half[:, None, None]
        before = np.cumsum(np.einsum("q,eqm->em", weights, parts), axis=0)
        before = np.concatenate([np.zeros((1, len(d))), before[:-1]])
        X = -np.pi * np.exp(-d) + (before[:, None] + np.einsum("pq,eqm->epm", upto, parts)).reshape(r.shape)
        X_yy = -y[:, None] * slope
        share = (d / r) ** 2
        X_yzz = share * near + (2.0 * share - 1.0) * slope
        traction = (2.0 * nu * X_yy - y[:, None] * X_yzz - (1.0 - 2.0 * nu) * (X - X_yy)) / np.pi
        local = np.einsum(
            "qa,eqm->eam", self._shapes(x) * weights[:, None], traction.reshape(parts.shape) * half[:, None, None]
        )
        out = np.zeros((self.size, len(d)))
        for e in range(len(half)):
            out[self.order * e : self.order * (e + 1) + 1] += local[e]
        return out


def _stiffness(line: _Line, nu: float) -> Any:
    """Matrix (3 n^2, 3 n^2) of the harmonic 1 for E = 1; dofs (U, Z, Y), each over the nodes (z, y)."""
    lam, mu = nu / ((1.0 + nu) * (1.0 - 2.0 * nu)), 0.5 / (1.0 + nu)
    M, C, S = line.mass, line.mixed, line.stiffness

    def product(a: Any, b: Any) -> Any:
        return sp.kron(a, b, format="csr")

    MM, SM, MS = product(M, M), product(S, M), product(M, S)
    UZ = lam * product(C, M) - mu * product(C.T, M)
    UY = lam * product(M, C) - mu * product(M, C.T)
    ZY = lam * product(C.T, C) + mu * product(C, C.T)
    UU = (lam + 2.0 * mu) * MM + mu * (SM + MS)
    ZZ = (lam + 2.0 * mu) * SM + mu * (MM + MS)
    YY = (lam + 2.0 * mu) * MS + mu * (MM + SM)
    return sp.bmat([[UU, UZ, UY], [UZ.T, ZZ, ZY], [UY.T, ZY.T, YY]], format="csr")
