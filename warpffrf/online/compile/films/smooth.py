r"""The compliance under a film in two parts, near and smooth: what the films' linear systems contain of it.

Pressures x of the lines of a film's system open the gap at the nodes by G x. G is dense; for the increments of a Newton
iteration, whose residual is exact, an approximation suffices,

    G ~ N + Phi C V^T,      V^T = Phi^T F,

F x the nodal forces of x, and Phi r smooth functions on the grid: harmonics around (polynomials on an arc) times
polynomials along, fewer for higher harmonics. C (r, r) is symmetric and fits the compliance D beyond a few columns,
where it is smooth,

    minimise  sum over nodes farther apart than these columns  (Phi C Phi^T - D)^2,

by conjugate gradients, whose early end leaves out what the fit does not determine. The columns are two, or more where
they have few lines, and eight on arcs: the skirt of a piston is thin, and what it gives is neither near nor smooth
(with two columns its iterations do not converge). N is the rest within one column more, so that the product with the
derivative of a line by the gap, which has the nodes of two cells, is exact within them. Increments are off by 2 to 6 %
of what they change (big end of a connecting rod; steel sleeves of 64 x 9 and 128 x 17 nodes).

The same functions give the motions that the film is coupled to, so that they are completed by what the global modes
are next to them. With the outward normal n of the first surface, motions of the bodies open the gap by -n and its
moments, and global modes by their normal displacements; their coefficients in Phi, by least squares, are exact, for
rigid ones on a cylinder up to the tilt of the second surface.

Openings are interpolated from *stations*: the nodes, or, of profiles, their few points. A compliant second surface B
moves along them. Its smooth functions come next to those of A, Phi = (Phi_A, S Phi_B), S the seats of the stations on
B; N has its near part S N_B S^T F besides, N_B = D_B - Phi_B C_B Phi_B^T, and C is block diagonal
(`warpffrf_kernels.films.smooth`).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import scipy.sparse as sp
from scipy.linalg import block_diag

from warpffrf.model.films import Film
from warpffrf.model.reduced.contact_surface import ContactSurface
from warpffrf.online.compile.compliance_tables import node_gram
from warpffrf.online.compile.films.bases import Basis

Array = np.ndarray
REACH, NEAR = 2, 24  # columns within which the compliance is exact, and lines, at least
ARC = 8  # columns on an arc
ALONG = 5, 5, 5, 3, 3, 3, 2, 2, 2  # polynomials along by harmonic, or by the degree of that around
BESIDE = 0.03  # of a mode: what may be missing of it
ITERATIONS, ENOUGH = 40, 1e-8  # of the fit; of the squared residual


@dataclass(frozen=True)
class Lines:
    """Where the lines of a film's system are: at (columns, width), -1 for none, those of a column one behind the other;
    column (lines,); reach: columns within which the compliance is exact; seam: the first of as many that are
    eliminated last where columns go around.
    """

    at: Array
    column: Array
    reach: int
    seam: int

    @property
    def most_band(self) -> int:
        """Lines within these columns, on either side, at most."""
        return (self.reach + 1) * self.at.shape[1] - 1


@dataclass(frozen=True)
class Stations:
    """Places of which openings are interpolated at points, column by column: the nodes, or the points themselves where
    there are few. at and part (points, 4), rows of a column, seat of the first one, of_nodes, matrix (stations, nodes).
    """

    at: Array
    part: Array
    rows: int
    seat: int
    of_nodes: Any

    @property
    def count(self) -> int:
        """Their number."""
        return self.of_nodes.shape[0]


def stations_of(film: Film, basis: Basis) -> Stations:
    """Points of "reduced", else nodes."""
    grid, points = film.grid, len(basis.weight)
    nodes = grid.columns * grid.rows
    if film.quadrature != "reduced":
        return Stations(basis.grid_node, basis.between, grid.rows, points, sp.identity(nodes, format="csr"))
    part = np.zeros((points, 4))
    part[:, 0] = 1.0
    to = sp.csr_matrix(
        (basis.between.ravel(), (np.repeat(np.arange(points), 4), basis.grid_node.ravel())), (points, nodes)
    )
    return Stations(np.tile(np.arange(points)[:, None], 4), part, points // (grid.columns - (not grid.periodic)), 0, to)


def lines_of(film: Film, basis: Basis, rough: int) -> Lines:
    """Lines column by column; those of `rough` nodes behind the pressures of their column."""
    columns, free = film.grid.columns, ~basis.held
    number = np.where(free, np.cumsum(free) - 1, -1).reshape(columns, -1)
    if rough:
        number = np.hstack([number, np.count_nonzero(free) + np.arange(rough).reshape(columns, -1)])
    column = np.zeros(np.count_nonzero(free) + rough, dtype=int)
    owner = np.repeat(np.arange(columns), number.shape[1])
    column[number.ravel()[number.ravel() >= 0]] = owner[number.ravel() >= 0]
    count = np.bincount(column, minlength=columns)
    most = (columns - 3) // 2 if film.grid.periodic else columns - 1  # no column is in it twice
    least = REACH if film.grid.periodic else ARC
    reach = max(1, min(most, max(least, -(-NEAR // number.shape[1]) - 1)))
    beside = sum(np.roll(count, -k) for k in range(reach))
    return Lines(number, column, reach, int(np.argmin(beside)) if film.grid.periodic else 0)


def rooms(basis: Basis, lines: Lines, owner: Array, point: Array) -> Array:
    """Places (entries, some) of the functions at each `point` of a function `owner`, in its room: (column next to its
    own + 1, place), -1 where the pressure is given."""
    columns, width = lines.at.shape
    each = basis.functions // columns
    other = basis.function[point]
    beside = (other // each - (owner // each)[:, None] + 1) % columns
    return np.where((other >= 0) & ~basis.held[other], beside * width + other % each, -1)


def smooth_functions(surface: ContactSurface) -> Array:
    """Phi (nodes, r), completed by what the global modes add to it."""
    grid = surface.grid
    if grid.periodic:
        angle = 2.0 * np.pi * np.arange(grid.columns) / grid.columns
        harmonics = range(1, min(len(ALONG), (grid.columns + 3) // 4))
        around = [np.ones((grid.columns, 1))]
        around += [np.stack([np.cos(k * angle), np.sin(k * angle)], axis=1) for k in harmonics]
    else:
        degree = min(len(ALONG), (grid.columns + 1) // 2) - 1
        around = list(np.polynomial.legendre.legvander(np.linspace(-1.0, 1.0, grid.columns), degree).T[:, :, None])
    z = 2.0 * (grid.z - grid.z[0]) / (grid.z[-1] - grid.z[0]) - 1.0
    along = np.polynomial.legendre.legvander(z, grid.rows - 1)
    Phi = np.hstack([np.kron(one, along[:, :some]) for one, some in zip(around, ALONG, strict=False)])
    shape = _shapes(surface)
    size = np.linalg.norm(shape, axis=0)
    shape = shape[:, size > BESIDE * size.max(initial=0.0)] / size[size > BESIDE * size.max(initial=0.0)]
    directions, sizes, _ = np.linalg.svd(shape - Phi @ (np.linalg.pinv(Phi) @ shape), full_matrices=False)
    return np.hstack([Phi, directions[:, sizes > BESIDE] * np.sqrt(len(Phi))])


def _apart(columns: int, periodic: bool) -> Array:
    """Number of columns between two (columns, columns), the shorter way."""
    apart = np.abs(np.subtract.outer(np.arange(columns), np.arange(columns)))
    return np.minimum(apart, columns - apart) if periodic else apart


def fit(D: Array, functions: Array, near: Array) -> Array:
    """C (r, r): `functions` C `functions`^T is nearest to D where `near` is false."""
    inverse = np.linalg.pinv(functions.T @ functions, rcond=1e-10)

    def project(X: Array) -> Array:
        return functions.T @ np.where(near, 0.0, X) @ functions

    C = np.zeros_like(inverse)
    rest = project(D)
    scaled = direction = inverse @ rest @ inverse
    size = first = float(np.sum(rest * scaled))
    for _ in range(ITERATIONS):
        if not size > ENOUGH * first:
            break
        product = project(functions @ direction @ functions.T)
        step = size / float(np.sum(direction * product))
        C, rest = C + step * direction, rest - step * product
        scaled = inverse @ rest @ inverse
        size, before = float(np.sum(rest * scaled)), size
        direction = scaled + size / before * direction
    return 0.5 * (C + C.T)


def _parts(surface: ContactSurface, reach: int) -> tuple[Array, Array, Array]:
    """Phi, C, and D - Phi C Phi^T."""
    grid, Phi = surface.grid, smooth_functions(surface)
    D = surface.compliance(np.arange(grid.columns))
    near = np.kron(_apart(grid.columns, grid.periodic) <= reach, np.ones((grid.rows, grid.rows), dtype=bool))
    C = fit(D, Phi, near)
    return Phi, C, D - Phi @ C @ Phi.T


def smooth_tables(film: Film, stations: Stations, lines: Lines, G: Array, forces: Array) -> dict[str, Any]:
    """Tables of `core.films`: of G (nodes, lines) [m/Pa], whose lines exert `forces` (nodes, lines) [m2]."""
    surface, grid = film.a.surface, film.grid
    Phi, C, _ = _parts(surface, lines.reach)
    V = Phi.T @ forces
    near = _near(lines, stations.of_nodes @ (G - Phi @ (C @ V)), stations, grid.periodic)
    theta, z = (v.ravel() for v in np.meshgrid(film.theta, grid.z, indexing="ij"))
    normal, place = -surface.shape.normal(theta, z), surface.shape.point(theta, z) - film.a.body.center_of_mass
    motions = np.linalg.pinv(Phi) @ np.hstack([normal, np.cross(place, normal), -_shapes(surface)])
    second, count = film.b.surface, 0
    more = dict.fromkeys(("second_smooth", "second_near", "second_smooth_motion", "nodal_force"), np.zeros(0))
    if isinstance(second, ContactSurface):
        of_columns = grid.pitch * _radius(surface) / (second.grid.pitch * _radius(second))
        Phi_B, C_B, rest = _parts(second, max(1, round(lines.reach * of_columns)))
        C, count = block_diag(C, C_B), Phi_B.shape[1]
        more = {
            "second_smooth": Phi_B, "second_near": rest,
            "second_smooth_motion": -np.linalg.pinv(Phi_B) @ _shapes(second),
            "nodal_force": _beside(forces, lines, grid.rows),
        }  # fmt: skip
    parts = more | {
        "close": near, "smooth": stations.of_nodes @ Phi, "smooth_load": V.T, "smooth_compliance": C,
        "smooth_motion": motions, "line_at": lines.at,
    }  # fmt: skip
    return {
        "parts": {name: np.ravel(values) for name, values in parts.items()},
        "ones": {"smooth_count": Phi.shape[1], "second_smooth_count": count},
    }


def _shapes(surface: ContactSurface) -> Array:
    """Normal displacements of the global modes (nodes, modes)."""
    return np.asarray(surface.mode_normal).reshape(surface.grid.columns * surface.grid.rows, -1)


def _beside(forces: Array, lines: Lines, rows: int) -> Array:
    """Forces (lines, 3, rows) of lines on the nodes of their column, the one before and the one behind."""
    column = (lines.column[:, None] + np.arange(-1, 2)) % len(lines.at)
    node = column[:, :, None] * rows + np.arange(rows)
    return forces[node, np.arange(len(column))[:, None, None]]


def _places(lines: Lines) -> Array:
    """Lines (columns, 2 reach + 3, width) in the columns around each, -1 for none; of a grid that ends none beyond."""
    offset = np.arange(-lines.reach - 1, lines.reach + 2)
    return lines.at[np.add.outer(np.arange(len(lines.at)), offset) % len(lines.at)]


def _near(lines: Lines, rest: Array, stations: Stations, periodic: bool) -> Array:
    """Entries (stations, 2 reach + 3, width) of `rest` (stations, lines) in the columns around theirs."""
    columns, rows = len(lines.at), stations.rows
    own = len(rest) // rows  # columns of stations
    place = np.repeat(_places(lines)[:own], rows, axis=0)
    found = rest[np.arange(len(rest))[:, None, None], np.maximum(place, 0)]
    found[place < 0] = 0.0
    if not periodic:
        at = np.add.outer(np.arange(own), np.arange(-lines.reach - 1, lines.reach + 2))
        found[np.repeat((at < 0) | (at >= columns), rows, axis=0)] = 0.0
    return found


def _radius(surface: ContactSurface) -> float:
    """Length per theta in the middle of a surface: R, of a plane 1."""
    if surface.shape.profile().planar:
        return 1.0
    grid = surface.grid
    return float(np.ravel(surface.shape.radius_at(np.array([0.5 * (grid.z[0] + grid.z[-1])])))[0])


def nodal_forces(film: Film, basis: Basis, rough: int) -> Array:
    """F (nodes, lines) [m2]."""
    M = node_gram(film.a.surface, 1)[0]
    of_functions = np.asarray((basis.to_nodes.T @ M.T).T)
    return np.hstack([of_functions[:, ~basis.held], M[:, :rough]])
