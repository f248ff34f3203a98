r"""A roller of finite width on a rigid plane, its free end included: full finite elements in three dimensions.

Quadratic (27-node) curved cells of scikit-fem, fine towards the line of contact and towards the end; no modes. The hub
is a rigid circle that approaches the plane by delta. Half of the width (z = 0 the mid-plane, z = w/2 the end) and
half of the ring (y >= 0, contact along +x) are modelled, with symmetry conditions on their planes. The contact is that
of `contact`: pressure functions on the corner nodes of the rim, tensor products of those of angle and width, weak gap
R (1 - cos t) - delta + u_x, active set. Two equal rollers in contact are equivalent: the plane between them is
one of symmetry.

Far from the end the state is plane strain. At the end the material is unsupported, and with a plane that extends
beyond it the wedge between free end and rigid frictionless plane mirrors to a smooth free surface: the pressure there
is finite, lower than in the middle, and converges.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from skfem import Basis, ElementHex2, ElementVector, MeshHex, MeshHex2
from skfem.models.elasticity import linear_elasticity

from references.finite_elements.contact import SAME_PLACE, active_set, pressure_rows
from references.finite_elements.pin_in_bore import graded
from warpffrf.model.errors import InputError, require_number
from warpffrf.model.material import Material
from warpffrf.offline.solvers import factorise

Array = np.ndarray
GROWTH_FROM_PATCH = 1.7  # of cells away from the patch and from the end
MARGIN = 1.4  # half-widths within which nodes can carry pressure and cells are fine


@dataclass(frozen=True)
class Roller:
    """Lengths [m]: outer and inner radius, width w."""

    material: Material
    outer_radius: float
    inner_radius: float
    width: float


@dataclass(frozen=True, eq=False)
class EndPressure:
    """Radius [m], angles (k,) [rad] and z (m,) [m] of the nodes, pressure (k, m) [Pa], delta [m], dofs of the model."""

    radius: float
    angles: Array
    z: Array
    pressure: Array
    approach: float
    dofs: int

    @property
    def middle(self) -> float:
        """Pressure [Pa] on the line of contact in the mid-plane."""
        return float(self.pressure[0, 0])

    @property
    def end(self) -> float:
        """Pressure [Pa] on the line of contact at the end."""
        return float(self.pressure[0, -1])

    def along(self, inside: float) -> float:
        """Pressure [Pa] on the line of contact, `inside` [m] from the end."""
        return float(np.interp(self.z[-1] - inside, self.z, self.pressure[0]))

    def mean_line_load(self, inside: float) -> float:
        """[N/m], mean over the last `inside` [m] at the end, of the line loads, which are linear between the nodes."""
        start = self.z[-1] - inside
        z = np.append(start, self.z[self.z > start])
        return float(np.trapezoid(np.interp(z, self.z, self._line_load), z) / inside)

    @property
    def _line_load(self) -> Array:
        """Load per width (m,) [N/m] at the nodes' z, of both halves."""
        return 2.0 * self.radius * (np.diff(self.angles) @ (0.5 * (self.pressure[1:] + self.pressure[:-1])))

    @property
    def middle_line_load(self) -> float:
        """[N/m] in the mid-plane."""
        return float(self._line_load[0])

    @property
    def end_line_load(self) -> float:
        """Load per width at the end over that in the mid-plane [-]."""
        return float(self._line_load[-1] / self._line_load[0])


def press_roller(roller: Roller, load: float, half_width: float, cells: float, end_cell: float) -> EndPressure:
    """The roller under the load [N] on a rigid plane; expected half_width a [m], `cells` in it, first cell at the end
    with the width `end_cell` times a: for the mesh only."""
    return _pressed([roller], load, half_width, cells, _from_the_end(roller, end_cell * half_width))


def press_pair(
    short: Roller, long: Roller, load: float, half_width: float, cells: float, end_cell: float
) -> EndPressure:
    """As `press_roller`, the short roller on a longer one of the same radius; approach of the two hubs. Raises
    `InputError` if the second is not longer, or has another radius."""
    if not long.width > short.width or long.outer_radius != short.outer_radius:
        raise InputError("roller end: the second roller must be wider than the first, and of the same radius")
    return _pressed([short, long], load, half_width, cells, _from_the_end(short, end_cell * half_width))


def press_crowned(
    roller: Roller, crown_radius: float, load: float, half_axes: tuple[float, float], cells: float
) -> EndPressure:
    """As `press_roller`, the rim with a crown of `crown_radius` [m], whose middle is in contact on an ellipse of
    about the `half_axes` [m] across and along, with `cells` in each of them: for the mesh only. The crown is in the
    gap, not in the mesh: a drop over the patch of 1e-4 of the radius. Raises `InputError` if the ellipse reaches
    the end."""
    w, along = 0.5 * roller.width, half_axes[1]
    carries = MARGIN * along
    if not carries < w:
        raise InputError("crowned roller: the patch reaches the ends")
    step = carries / np.ceil(MARGIN * cells)
    fine = step * np.arange(int(np.ceil(MARGIN * cells)) + 1)
    z = np.append(fine, fine[-1] + graded(GROWTH_FROM_PATCH * step, w - fine[-1], growth=GROWTH_FROM_PATCH)[1:])
    return _pressed([roller], load, half_axes[0], cells, z, (fine[-1], crown_radius))


def _from_the_end(roller: Roller, end_cell: float) -> Array:
    """z (m,) [m] of lines from the middle to the end, the last cell `end_cell` [m] wide."""
    w = 0.5 * roller.width
    return np.sort(w - graded(end_cell, w, growth=GROWTH_FROM_PATCH))


def _pressed(
    rollers: list[Roller],
    load: float,
    half_width: float,
    cells: float,
    z: Array,
    crown: tuple[float, float] | None = None,
) -> EndPressure:
    """One roller on a plane, or two; the first has the pressure nodes, on lines z (m,) [m]: all, or up to the first of
    `crown`, whose second is the radius."""
    require_number(load, "load", positive=True)
    R, w = rollers[0].outer_radius, 0.5 * rollers[0].width
    carries, arc = (w, np.inf) if crown is None else crown
    h = half_width / R / cells
    fine = h * np.arange(int(np.ceil(MARGIN * cells)) + 1)
    angles = np.append(fine, fine[-1] + graded(GROWTH_FROM_PATCH * h, np.pi - fine[-1], growth=GROWTH_FROM_PATCH)[1:])
    parts = []
    for roller in rollers:
        beyond = 0.5 * roller.width - w
        lines = z
        if beyond > 0.0:
            lines = np.append(z, w + graded(z[-1] - z[-2], beyond, growth=GROWTH_FROM_PATCH)[1:])
        parts.append(_rim(roller, angles, lines, h, fine[-1], carries))
    turn, wide = parts[0][:2]
    A = np.sum([part[2] for part in parts], axis=0)
    drop = 1.0 - np.cos(np.repeat(turn, len(wide)))
    gap = drop * sum(roller.outer_radius for roller in rollers) + np.tile(0.5 * wide**2 / arc, len(turn))
    B = np.kron(pressure_rows(turn, R), pressure_rows(wide, 1.0))
    z = z[z < carries + SAME_PLACE * R]
    last = list(range((len(fine) - 1) * len(z), len(fine) * len(z)))
    if crown is not None:
        last += range(len(z) - 1, len(fine) * len(z), len(z))
    s, _, delta, _ = active_set(A, gap, np.ones(len(gap)), B, 0.25 * load, last)
    return EndPressure(R, fine, z, s.reshape(len(fine), len(z)), delta, sum(part[3] for part in parts))


def _rim(roller: Roller, angles: Array, z: Array, h: float, reach: float, w: float) -> tuple[Array, Array, Array, int]:
    """A quarter of a roller, cells of `h` [rad] at the rim: angles (k,) up to `reach` [rad] and z (m,) up to `w` [m] of
    the nodes of its rim, their displacement towards the other side per unit forces (k m, k m), and its dofs."""
    R = roller.outer_radius
    depth = graded(R * h, R - roller.inner_radius, growth=GROWTH_FROM_PATCH)
    flat = MeshHex2.from_mesh(MeshHex.init_tensor(np.sort(R - depth), angles, z))
    r, theta, along = np.asarray(flat.doflocs)
    mesh = MeshHex2(np.stack([r * np.cos(theta), r * np.sin(theta), along]), flat.t)
    basis = Basis(mesh, ElementVector(ElementHex2()), intorder=5)
    K = linear_elasticity(*roller.material.lame).assemble(basis).tocsc()
    x = basis.doflocs
    component = np.zeros(basis.N, dtype=int)
    for rows in (basis.nodal_dofs, basis.edge_dofs, basis.facet_dofs, basis.interior_dofs):
        if rows is not None:
            for k in range(3):
                component[rows[k]] = k
    tiny, radius = SAME_PLACE * R, np.hypot(x[0], x[1])
    angle = np.arctan2(np.abs(x[1]), x[0])  # of y = -0 it would be -pi
    held = np.abs(radius - roller.inner_radius) < tiny
    held |= (np.abs(x[1]) < tiny) & (component == 1) | (np.abs(x[2]) < tiny) & (component == 2)
    on = (np.abs(radius - R) < tiny) & (component == 0)
    on &= (angle < reach + 0.1 * h) & (x[2] < w + tiny)
    rows = np.flatnonzero(on)
    rows = rows[np.lexsort((x[2, rows], np.round(angle[rows] / (1e-3 * h))))]
    free = np.flatnonzero(~held)
    at = np.full(basis.N, -1)
    at[free] = np.arange(len(free))
    loads = np.zeros((len(free), len(rows)))
    loads[at[rows], np.arange(len(rows))] = 1.0
    A = factorise(K[free][:, free], coordinates=x[:, free].T).solve(loads)[at[rows]]
    count = int(np.sum(np.abs(angle[rows]) < 0.1 * h))  # nodes of a line of constant angle
    turn, wide = angle[rows].reshape(-1, count)[:, 0], x[2, rows].reshape(-1, count)[0]
    return turn, wide, 0.5 * (A + A.T), len(free)


STEEL_ROLLER = Roller(Material(210e9, 0.3, 7800.0, name="steel"), 0.05, 0.015, 0.02)  # m
LINE_LOAD = 2e6  # N/m: a/R = 0.015, a patch of 1/13 of half the width
