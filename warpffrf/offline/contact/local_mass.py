r"""Inertia of the local modes of a contact surface: Gram matrices of the residual static responses, for both paths.

The residual responses U (n, count) to the loads `B s` of unit coefficients give `N = U^T M U` and `W = Phi_g^T M U`,
projected like the compliance, so that they belong to unit forces of the functions:

    N := M_psi^-1 N M_psi^-1,      W := W M_psi^-1.

On a periodic body this is done in every harmonic, as for the compliance: the response to a unit load of sector 0 is 1/N
times the sum of the waves, so N is block-circulant with `lags[l] = 1/N sum_k N_k e^{i k l phi}`. A global mode
`sqrt(2/N) Re (phi e^{i k s phi})` overlaps with the response of sector s by `sqrt(2/N) Re ((u^H M_k phi) e^{i k s
phi})`: the wave `u^H M_k phi` becomes a real field just as a displacement of the modes does.

Consistent mass matrices throughout, or the one supplied with the mesh.

Slopes. The effect of pressures that deviate from the normal of the undeformed surface: the compliance of slopes.

Pressure acts along the normal of the deformed surface, and the gap is measured along it. If that normal is inclined to
the undeformed one by the angle G, towards the middle of the patch, a pressure p at the arc position x loads the body by
-p (n - G t) and its gap changes by -u.(n - G t), with t = e_theta and, for a narrow patch,

    G = kappa (x - x_c),

kappa the difference of the curvatures of the deformed and the undeformed surface. To first order in G the compliance
between two grid nodes is

    D_ij - G_i D^t_ij - G_j D^t_ji,          D^t_ij: displacement along t at node i under a normal load on node j.

Tangential displacement is odd: on a body of revolution D^t_ji = -D^t_ij. Then the middle x_c drops out,

    D_ij - kappa (x_i - x_j) D^t_ij = D_ij + kappa R S_ij,          S_ij = -(theta_i - theta_j) (D^t_ij - D^t_ji)/2,

which rotates with the body as D does: only the table of the compliance changes. S is stored for bodies so soft that
a patch can be a noticeable part of the radius (`SOFT`); kappa follows from the partner
(`warpffrf.model.reduced.local_modes`). Otherwise the even part of D^t is neglected. On a rigid plane kappa R = 1.
Second order, G_i G_j D^tt and the cosines of G, is up to 0.7 (b/R*)^2 of the line load, b the half-width, R*
the relative radius (tests/verification/partners/test_rubber_cover.py).

Independence. Whether the shape functions are independent on the surface mesh.

The contact problem is unique only if no combination of grid functions causes zero load on the mesh. A contact grid
finer than the mesh has such combinations: `C = (B psi)^T G (B psi)` becomes semidefinite (an eigenvalue ratio of
-1.5e-16 occurred, with a wrong contact force). Two ratios of a window of neighbouring columns are computed, because
dependence is local:

* the *traces*: with `b_ia = int psi_i N_a dA`, lumped areas `A_i = sum_a b_ia` of functions and `L_a = sum_i |b_ia|` of
  nodes (vertex functions of quadratic triangles have no area of their own), the smallest
  over the largest eigenvalue of `A^-1/2 b L^-1 b^T A^-1/2`. It depends on the two grids alone: at best about
  (1/9)^2 for a nodal grid, where b is the Gram matrix, and zero if there are more functions than nodes. The loads
  themselves are a weaker criterion: the normal rotates within a facet, so that a dependent combination still loads the
  mesh slightly, tangentially. The traces are known before any solve and are checked first;
* C itself, including the part of the global modes.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from warpffrf.model.errors import InputError
from warpffrf.model.material import Material
from warpffrf.model.mesh import Mesh
from warpffrf.model.reduced.contact_grid import SurfaceGrid
from warpffrf.model.reduced.local_mass import LocalMass
from warpffrf.offline.contact.contact_grid import GridPlan, too_fine
from warpffrf.offline.contact.node_loads import ContactFacets

if TYPE_CHECKING:
    from warpffrf.offline.contact.node_loads import KeptFunctions
    from warpffrf.offline.cyclic.surface import CyclicField

Array = np.ndarray


class HarmonicMass:
    """N and W of one field of a periodic body's contact surface, accumulated over the harmonics."""

    def __init__(self, field: CyclicField) -> None:
        self.field = field
        self._N = np.zeros((field.N // 2 + 1, field.count, field.count), dtype=complex)
        self._W: list[tuple[int, Array]] = []

    def add(self, k: int, M: Any, u: Array, Phi: Array) -> None:
        """Harmonic k: mass matrix M (n, n), residual responses u (n, count), global modes Phi (n, p; none: p = 0)."""
        inertia = M @ u
        half = self.field.without_gram(k, u.conj().T @ inertia)
        N = self.field.without_gram(k, half.conj().T)
        self._N[k] = 0.5 * (N + N.conj().T)
        if Phi.shape[1]:
            self._W.append((k, self.field.without_gram(k, inertia.conj().T @ Phi)))

    def product(self, combine: Callable[[list[Array]], Array]) -> LocalMass:
        """The stored part; `combine` forms real fields of the waves of the harmonics with global modes."""
        field = self.field
        lags = np.fft.irfft(self._N, n=field.N, axis=0)[:: field.stride]
        whole = len(lags) * field.c
        sampled = [field.sampled(k, wave, whole) for k, wave in self._W]
        overlap = combine(sampled) if sampled else np.zeros((whole * field.rows, 0))
        return LocalMass(np.ascontiguousarray(lags), np.ascontiguousarray(overlap))


def dense_mass(kept: KeptFunctions, N: Array, W: Array) -> LocalMass:
    """N (count, count) and W^T (count, m) of unit coefficients of the whole field, for forces of the functions
    `kept`."""
    projected = kept.without_gram(kept.without_gram(N).T)
    lags = np.ascontiguousarray(0.5 * (projected + projected.T))[None]
    return LocalMass(lags, np.ascontiguousarray(kept.without_gram(W)))


SOFT = 1e10  # Pa, E/(1 - nu^2): above it a half-width of 3 % of the radius requires a pressure of 150 MPa and more
AROUND = ("theta",)


def may_slope(shape: object, material: Material | None) -> bool:
    """Whether the compliance of slopes is stored for a surface of resolved `shape` on this material."""
    curved = not shape.profile().planar  # type: ignore[attr-defined]
    return curved and material is not None and material.plane_strain_modulus < SOFT


def slope_lags(along: Array, pitch: float, rows: int) -> Array:
    """S (L, c rows, c rows) [m/N] in the layout of `ContactSurface.lags`, from D^t in the same layout; L = 1: dense, on
    an arc; else a full revolution, `pitch` [rad] between columns."""
    count, side = along.shape[:2]
    c = side // rows
    column = np.repeat(np.arange(c), rows)
    angle = pitch * (c * np.arange(count)[:, None, None] + column[:, None] - column)
    if count > 1 or abs(pitch * c - 2.0 * np.pi) < 1e-9:
        angle = np.mod(angle + np.pi, 2.0 * np.pi) - np.pi
        angle[np.abs(np.abs(angle) - np.pi) < 0.5 * pitch] = 0.0  # opposite columns lie on neither side
    swapped = np.roll(along[::-1], 1, axis=0).swapaxes(1, 2)  # [l] = D^t[-l]^T
    return -0.5 * angle * (along - swapped)


# Nodal grids have 3e-3 to 1e-2, a grid 1.4 times as fine as linear facets 1e-6 or less: in between, increasingly
# towards the lower end, the pressure oscillates from node to node but is unique.
TRACES = 1e-4
# Smallest over largest eigenvalue of C on a window. Nodal grids have 1e-2 to 1e-6 (rows much longer than columns
# lower it).
INDEPENDENCE = 1e-10
WINDOW_COLUMNS = 24  # shows a grid finer by 10 %
WINDOW_NODES = 600  # at most, but `LEAST_COLUMNS` whole columns: the eigenvalues of the window take 0.1 s
LEAST_COLUMNS = 7


def window_columns(columns: int, rows: int) -> int:
    """Number of neighbouring columns that are checked."""
    return min(columns, max(LEAST_COLUMNS, min(WINDOW_COLUMNS, WINDOW_NODES // rows)))


def eigenvalue_ratio(window: np.ndarray) -> float:
    """Smallest over largest eigenvalue of the symmetric `window` (h, h); NaN if a value is not finite."""
    if not np.all(np.isfinite(window)):
        return np.nan
    values = np.linalg.eigvalsh(0.5 * (window + window.T))
    return float(values[0] / values[-1]) if values[-1] > 0.0 else -1.0


def trace_ratio(mesh: Mesh, name: str, shape, grid: SurfaceGrid) -> float:
    """Eigenvalue ratio of the traces of the grid's first columns on the facets of set `name` (module docstring).

    NaN if a function has no area.
    """
    facets = ContactFacets.of(mesh.points, mesh.facets(name), shape)
    chart = facets.chart
    count, rows = window_columns(grid.columns, grid.rows), grid.rows
    # the window alone as a grid on an arc, with a margin of columns that completes the lumped areas of its nodes (a
    # plane, which has no period, gets one as long as all of its columns, so that the margin is on both sides)
    turn = chart.turn if np.isfinite(chart.turn) else grid.pitch * np.ceil(np.ptp(chart.theta) / grid.pitch + 2.0)
    low = (chart.theta.min(axis=1) - grid.theta_start) % turn
    span = np.ptp(chart.theta, axis=1)
    reach = grid.pitch * count
    near = (low < reach) | (low + span > turn - grid.pitch)
    columns = int(np.ceil(turn / grid.pitch - 1e-6))
    plan = GridPlan(grid.theta_start, turn / columns, columns, True, grid.z, False)
    loads = facets.part(near).loads(plan, getattr(grid, "kind", "nodes"), "normal")
    column = loads.column % columns
    nodes, node = np.unique(loads.node, return_inverse=True)
    lumped = np.bincount(node, weights=np.abs(loads.area))
    inside = column < count
    b = np.zeros((count * rows, len(nodes)))
    np.add.at(b, (column[inside] * rows + loads.row[inside], node[inside]), loads.area[inside])
    areas = b.sum(axis=1)
    if not np.all(areas > 0.0):
        return np.nan
    scaled = b / np.sqrt(areas)[:, None] / np.sqrt(lumped)
    return eigenvalue_ratio(scaled @ scaled.T)


def check_traces(mesh: Mesh, name: str, shape, grid: SurfaceGrid) -> float:
    """`trace_ratio` of the grid; raises `InputError` if it is too small."""
    traces = trace_ratio(mesh, name, shape, grid)
    _require_finite(traces, name)
    if not traces > TRACES:
        edge = ContactFacets.of(mesh.points, mesh.facets(name), shape).chart.edge
        detail = f"eigenvalue ratio of the traces of a window {traces:.2g}, at least {TRACES:g} is needed"
        raise too_fine(detail, name, edge)
    return traces


def check_compliance(window: np.ndarray, name: str, edge: float, held: str = "") -> float:
    """The eigenvalue ratio of C; raises `InputError` if it is too small.

    Cures named in the message: the longest facet `edge` [m] as spacing, or the text of `held_nodes`.
    """
    ratio = eigenvalue_ratio(window)
    _require_finite(ratio, name)
    if not ratio > INDEPENDENCE:
        detail = f"eigenvalue ratio of the compliance of a window {ratio:.2g}, at least {INDEPENDENCE:g} is needed"
        if held:
            raise InputError(f"{held} ({detail})")
        raise too_fine(detail, name, edge)
    return ratio


def _require_finite(ratio: float, name: str) -> None:
    if np.isnan(ratio):
        raise InputError(
            f"contact {name!r}: functions of its grid have no area on the facets, or no finite one: the shape does "
            "not belong to them; give another shape in reduce(contact=...), or None for a fitted one"
        )


def held_nodes(mesh: Mesh, name: str, interfaces: Mapping[str, str]) -> str:
    """The fault if nodes of the contact surface are on a rigid or free interface, otherwise "".

    Tractions on them move only the interface: the local modes have no compliance there.
    """
    nodes = mesh.facets(name).node_set
    for other, kind in interfaces.items():
        shared = 0 if kind == "average" else len(np.intersect1d(nodes, mesh.facets(other).node_set))
        if shared:
            return (
                f"contact {name!r}: {shared} of its {len(nodes)} nodes are on the {kind} interface {other!r}, where "
                "local modes cannot deform the surface; separate the sets, or make the interface an 'average' one"
            )
    return ""
