r"""One contact of a run: forces, and quantities of the patch from the nodal pressures.

The pressure is piecewise linear around, `p(x) = sum_j p_j psi_j(x)`, with nodes of spacing `h` at `x_j` along the arc.
Then, exactly,

    P' = int p dx = h sum_j p_j                          line load [N/m]
    c  = int p x dx / P' = sum_j p_j x_j / sum_j p_j     centre
    m2 = int p (x - c)^2 dx / P' = sum_j p_j ((x_j - c)^2 + h^2/6) / sum_j p_j

because the second moment of one shape function about its node is h^3/6. For the Hertz line pressure `p0 sqrt(1 -
x^2/a^2)` the second moment is `a^2/4`, hence the half-width `2 sqrt(m2)`: unlike the extent of the active set it does
not jump with the grid. For a point contact the whole patch is used, `patch_moments`.

The nodal values oscillate about the pressure from node to node: the second body responds only in part to a pressure of
the first grid's wavelength, because its own grid does not resolve it. The weighted mean at each node, consistent nodal
force over nodal area,

    pbar_j = int p psi_j dx / int psi_j dx = (p_(j-1) + 4 p_j + p_(j+1)) / 6,

is free of that and exact for a linear pressure (a peak of curvature p0/a^2 is underestimated by h^2/(12 a^2), 0.5 % at
four nodes in a half-width). It is reported as the pressure and compared with Hertz; force, torque and moments are those
of the nodal values, which the mean does not change.

Film result. One oil film of a run: forces on its bodies, fields, and positions of its nodes.
"""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from warpffrf.model.errors import require_number
from warpffrf.model.messages import reprs
from warpffrf.model.reduced.contact_grid import cell_edges
from warpffrf.online.history.history import FilmHistory
from warpffrf.output.contact.hertz import HertzLine
from warpffrf.output.contact.pair_result import LineMoments, PairResult, PatchPressure, section_moments
from warpffrf.output.contact.patch_moments import PatchMeasure, PatchMoments, axial_integrals
from warpffrf.output.contact.stress_error import StressError, stress_errors
from warpffrf.output.exposed_histories import Recorded
from warpffrf.output.geometry.places import grid_theta_offset
from warpffrf.output.geometry.scene_view import FilmView

if TYPE_CHECKING:
    from warpffrf.online.vibrations.film_coefficients import FilmCoefficients

__all__ = ["ContactResult", "HertzLine", "PatchPressure"]
OWN = 1.0 / 6.0  # second moment of a shape function about its node, over the square of the spacing


def line_moments(x: np.ndarray, p: np.ndarray, h: float) -> LineMoments:
    """Line load, centre and half-width of piecewise linear pressures p (T, n) [Pa] at x (T, n) or (n,) [m]; h: node
    spacing [m]."""
    return section_moments(x, p, h, OWN)


def node_means(p: np.ndarray) -> np.ndarray:
    """Weighted nodal means across the patch (see the module) of the nodal values p (T, columns, rows) [Pa]."""
    padded = np.pad(p, ((0, 0), (1, 1), (0, 0)))
    return (padded[:, :-2] + 4.0 * padded[:, 1:-1] + padded[:, 2:]) / 6.0


class ContactResult(PairResult):
    """One contact whose pressure is given at the nodes of the first body's contact grid, see `PairResult`; arrays have
    one row per saved step."""

    @cached_property
    def z(self) -> np.ndarray:
        """(rows,) m, along the axis of the first surface."""
        return np.asarray(self.view.first.grid.z, dtype=float)

    @cached_property
    def measure(self) -> PatchMeasure:
        """Areas of the nodes and cells of the first surface's grid."""
        return PatchMeasure(self.view.first)

    @cached_property
    def mid_radius(self) -> float:
        """Metres of arc per unit of theta on the first surface at mid-width: its radius; 1 on a plane."""
        return float(self.view.first.shape.radius_at(0.5 * (self.z[0] + self.z[-1])))

    @property
    def rows(self) -> np.ndarray:
        """(T, rows) m, `z` in every saved step."""
        return np.broadcast_to(self.z, (len(self.history.pressure), len(self.z)))

    @property
    def window(self) -> float:
        """Half the arc [m] of the window of nodes."""
        return 0.5 * self.spacing * self.history.pressure.shape[1]

    @property
    def spacing(self) -> float:
        """Arc length between two nodes at mid-width [m]."""
        return self.mid_radius * float(self.view.first.grid.pitch)

    @cached_property
    def _offset(self) -> np.ndarray:
        """(T, columns) columns of the window, counted from the line of centres."""
        grid = self.view.first.grid
        offset = self.history.first_column - self.history.center_column
        if grid.periodic:  # modulo the columns of the full revolution: the shortest way round
            offset = (offset + 0.5 * grid.columns) % grid.columns - 0.5 * grid.columns
        return offset[:, None] + np.arange(self.history.pressure.shape[1])

    @cached_property
    def arc(self) -> np.ndarray:
        """(T, columns) m, positions of the window's columns along the mid-width circle, from the line of centres."""
        return self.spacing * self._offset

    @cached_property
    def theta(self) -> np.ndarray:
        """(T, columns) rad (m on a plane), positions of the window's columns on the first surface's grid."""
        grid = self.view.first.grid
        return grid.theta_start + grid.pitch * (
            self.history.first_column[:, None] + np.arange(self.history.pressure.shape[1])
        )

    @property
    def cell_areas(self) -> np.ndarray:
        """(T, rows) m2, of the cells around the nodes of one column, the same in every saved step."""
        return np.broadcast_to(self.measure.cell_area, (len(self.history.pressure), len(self.z)))

    @cached_property
    def patch_center(self) -> np.ndarray:
        """(T, 2) theta and z: the line of centres at mid-width, for a point contact at the height of the centre of
        pressure."""
        grid = self.view.first.grid
        theta = grid.theta_start + grid.pitch * np.asarray(self.history.center_column, dtype=float)
        z = np.full(len(theta), 0.5 * (self.z[0] + self.z[-1]))
        if self.patch_kind == "point":
            z = np.where(self.touching, self.moments.center[:, 1], z)
        return np.stack([theta, z], axis=1)

    @cached_property
    def creep_place(self) -> np.ndarray:
        """(T, 2) theta and z: the middle row, in the column of the window nearest to the line of centres."""
        nearest = np.take_along_axis(self._offset, np.abs(self._offset).argmin(axis=1)[:, None], axis=1)[:, 0]
        theta = self.patch_center[:, 0] + self.view.first.grid.pitch * nearest
        return np.stack([theta, np.full(len(theta), self.z[len(self.z) // 2])], axis=1)

    def cell_lines(self, i: int) -> tuple[np.ndarray, np.ndarray]:
        """Lines arc (columns + 1,) and z (rows + 1,) [m] between the cells around the nodes in saved step `i`."""
        arc, half = self.arc[i], 0.5 * self.spacing
        return np.append(arc - half, arc[-1:] + half), cell_edges(self.z)

    def reaches_ends(self, i: int) -> bool:
        """True if the patch of saved step `i` reaches both ends of an arc, to within a column (the outermost nodes may
        be inactive)."""
        grid = self.view.first.grid
        columns = self.history.first_column[i] + np.flatnonzero(np.any(self.history.pressure[i] > 0.0, axis=1))
        return not grid.periodic and len(columns) > 0 and columns[0] <= 1 and columns[-1] >= grid.columns - 2

    # --- pressure ---

    @cached_property
    def mean_pressure(self) -> np.ndarray:
        """(T, columns, rows) Pa, pressure of each node: its weighted mean across the patch."""
        return node_means(self.history.pressure)

    @cached_property
    def moments(self) -> PatchMoments:
        """Load, centre and covariance of the whole patch."""
        return PatchMoments(self.measure, self.history.pressure, self.view.first.grid.pitch * self._offset)

    @cached_property
    def _line(self) -> LineMoments:
        return line_moments(self.arc, self.in_section(self.history.pressure), self.spacing)

    @cached_property
    def patch_area(self) -> np.ndarray:
        """(T,) m2, area of the cells with positive pressure: to within half a cell along the edge of the patch."""
        return (self.history.pressure > 0.0).sum(axis=1) @ self.measure.cell_area

    @cached_property
    def peak_pressure(self) -> np.ndarray:
        """(T,) Pa, largest nodal pressure in the patch."""
        return self.mean_pressure.max(axis=(1, 2), initial=0.0)

    @cached_property
    def mid_peak_pressure(self) -> np.ndarray:
        """(T,) Pa, largest nodal pressure in `mid_pressure`: for comparison with Hertz."""
        return self.mid_pressure.max(axis=1, initial=0.0)

    def pressure_resultants(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """For the nodes: (T,) [-], (T,) [rad] and (T, 3, rows) [m2, m2, m3], see `PairResult`."""
        h, steps = float(self.view.first.grid.pitch), np.ones(len(self.history.pressure))
        rings = np.stack(axial_integrals(self.view.first.shape, self.z))
        return 2.0 * (1.0 - np.cos(h)) / h * steps, h * steps, np.broadcast_to(rings, (len(steps), *rings.shape))

    def stress_errors(self, i: int) -> dict[str, StressError]:
        """Errors of the von Mises stress below the line in saved step `i`, and of the depth of its maximum, by flexible
        body; bodies whose cells at the surface are not hexahedra are omitted.

        NaN, with the `reason`, without contact, if the contact is not a line, and if the mesh is too coarse for the
        rule.
        """
        return stress_errors(self, i)


class FilmResult(reprs.Shown):
    """One oil film of a run; arrays have one row per saved step, SI units.

    Forces act on the film's first body in world axes, torques about that body's user origin; their opposites act on the
    second. Fields are given at the nodes (columns, rows) of the contact grid of the first surface, at `theta` and `z`.
    """

    _hidden = frozenset(
        {"history", "view", "load_second", "result", "temperature", "inlet_temperature", "heat_generated",
         "heat_carried", "heat_to_a", "heat_to_b", "heat_stored"}
    )  # fmt: skip

    force = Recorded("(T, 3) N, on the first body, shear included, world axes.")
    torque = Recorded("(T, 3) N m, on the first body about its user origin, world axes.")
    torque_second = Recorded("(T, 3) N m, on the second body, about its user origin.")
    smallest_gap = Recorded("(T,) m, the smallest film thickness.")
    largest_pressure = Recorded("(T,) Pa, of the oil.")
    pressure_loss = Recorded("(T,) W, by flow under pressure, closing cavities and feeds.")
    friction_power = Recorded("(T,) W, friction power of sliding.")
    feed_flow = Recorded("(T,) m3/s, in through feeds.")
    end_flow = Recorded("(T,) m3/s, out at the ends.")
    void_fraction = Recorded("(T,) [-] volume of the cavities over that of the gap.")
    oil_volume = Recorded("(T,) m3 of oil in the film, at the density without pressure.")
    asperity_force = Recorded("(T,) N, normal force of the asperities.")
    largest_asperity_pressure = Recorded("(T,) Pa, of the asperities.")
    eccentricity = Recorded("(T, 2) m, inner axis against the outer one, along e_0 and e_1.")
    pressure = Recorded("(T, columns, rows) Pa, of the oil.")
    gap = Recorded("(T, columns, rows) m, film thickness.")
    void = Recorded("(T, columns, rows) m, volume of the cavities per area.")
    asperity = Recorded("(T, columns, rows) Pa, pressure of the asperities, in addition to that of the oil.")

    def __init__(self, history: FilmHistory, view: FilmView, result: Any) -> None:
        self.history = history
        self.result = result
        self.view = view
        self.name = view.name
        self.time = result.time  # (T,) s
        self.clearance = view.clearance  # m, radius of the bore minus that of the shaft; None for planes and cones
        # (T, columns2, rows2) N, nodal forces on a flexible second surface, inwards; None for a rigid one
        self.load_second = history.load_second
        # of films with a temperature, None of isothermal ones
        self.temperature: Any = history.temperature  # (T, columns, rows) degC, mean across the gap
        self.inlet_temperature: Any = history.inlet_temperature  # (T,) degC, of oil entering at feeds and leading edges
        self.heat_generated: Any = history.heat_generated  # (T,) W, by sliding, flow, closing cavities and asperities
        self.heat_carried: Any = history.heat_carried  # (T,) W, by oil that leaves, less that of oil entering
        self.heat_to_a: Any = history.heat_to_a  # (T,) W, conducted into the first surface
        self.heat_to_b: Any = history.heat_to_b  # (T,) W, into the second surface
        self.heat_stored: Any = history.heat_stored  # (T,) W, by the oil in the film

    def _facts(self) -> dict[str, Any]:
        rows, *grid = self.pressure.shape
        return {"name": self.name, "rows": rows, "grid": f"{grid[0]} x {grid[1]}"}

    def coefficients(self, frequency: float = 0.0) -> FilmCoefficients:
        """Stiffness and damping of a film between a shaft and a bore about the last saved step, for small motions of
        `frequency` [Hz], 0 for slow ones; with the critical mass, the whirl there, and the errors due to the grid of
        the film. See `warpffrf.online.vibrations.film_coefficients`.

        Raises InputError for films between planes or cones, a first body that rotates, and a result from a file.
        """
        from warpffrf.online.vibrations.film_coefficients import film_coefficients

        frequency = require_number(frequency, "coefficients: frequency [Hz]", non_negative=True)
        return film_coefficients(self.result.scene, self.name, self.result.history, frequency)

    @property
    def force_magnitude(self) -> np.ndarray:
        """(T,) N."""
        return np.linalg.norm(self.force, axis=1)

    @property
    def fill(self) -> np.ndarray:
        """(T, columns, rows) [-] film fraction, 1 without cavitation."""
        return self.history.fill

    @cached_property
    def theta(self) -> np.ndarray:
        """(columns,) rad, m for a plane: positions of the columns in the chart of the first surface, from its direction
        e_0."""
        return np.asarray(self.view.first.grid.theta) + grid_theta_offset(self.view.first)

    @property
    def z(self) -> np.ndarray:
        """(rows,) m along the axis of the first surface."""
        return np.asarray(self.view.first.grid.z, dtype=float)
