r"""One contact pair of a run: forces, and what the pressure on the hats says about the patch.

The pressure is piecewise linear around, `p(x) = sum_j p_j psi_j(x)`, with hats of spacing `h` at `x_j` along the arc.
Then, exactly,

    P' = int p dx = h sum_j p_j                          line load [N/m]
    c  = int p x dx / P' = sum_j p_j x_j / sum_j p_j     centre
    m2 = int p (x - c)^2 dx / P' = sum_j p_j ((x_j - c)^2 + h^2/6) / sum_j p_j

because the second moment of one hat about its own node is h^3/6. For Hertz's line pressure `p0 sqrt(1 - x^2/a^2)` the
second moment is `a^2/4`, hence the half-width `2 sqrt(m2)`: unlike the extent of the active set it does not jump with
the grid. Of a point contact the whole patch counts, `patch_moments`.

The hat coefficients themselves swing about the pressure from node to node: the second body follows a pressure of the
first grid's wavelength only in part, because its own grid does not resolve it. The mean over each hat, consistent nodal
force over nodal area,

    pbar_j = int p psi_j dx / int psi_j dx = (p_(j-1) + 4 p_j + p_(j+1)) / 6,

is free of that and exact for a linear pressure (a peak of curvature p0/a^2 is underestimated by h^2/(12 a^2), 0.5 % at
four hats in a half-width). It is what is reported as pressure and held against Hertz; force, torque and moments are
those of the hats, which the mean does not change.
"""

from __future__ import annotations

from functools import cached_property
from typing import Any, NamedTuple

import numpy as np

from warpffrf.output.contact.friction import FrictionResult
from warpffrf.output.contact.hertz import effective_modulus, effective_radius, hertz, pair_curvature, patch_kind
from warpffrf.output.contact.hertz_patch import HertzLine, HertzPoint
from warpffrf.output.contact.patch_moments import PatchMeasure, PatchMoments
from warpffrf.output.contact.stress_error import StressError, stress_errors
from warpffrf.output.geometry.scene_view import PairView


class PatchPressure(NamedTuple):
    """Pressure in the window of one saved step on the first body's contact grid."""

    theta: np.ndarray  # (columns,) rad (m on a plane), grid angle on the first surface, increasing, not wrapped
    arc: np.ndarray  # (columns,) m, along the mid-width circle, from the line of centres
    z: np.ndarray  # (rows,) m, along the axis of the first surface
    pressure: np.ndarray  # (columns, rows) Pa


def mid_width(z: np.ndarray) -> tuple[int, int, float]:
    """Rows `k, k + 1` beside mid-width and the weight of the second, for linear interpolation in z."""
    if len(z) == 1:
        return 0, 0, 0.0
    middle = 0.5 * (z[0] + z[-1])
    k = int(np.clip(np.searchsorted(z, middle, side="right") - 1, 0, len(z) - 2))
    return k, k + 1, float((middle - z[k]) / (z[k + 1] - z[k]))


def line_moments(x: np.ndarray, p: np.ndarray, h: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Line load, centre and half-width of piecewise linear pressures.

    x: (T, n) m or (n,); p: (T, n) Pa; h: hat spacing m. Returns P' [N/m], centre [m] and `2 sqrt(second moment)` [m],
    each (T,); all zero where nothing touches.
    """
    total = p.sum(axis=-1)
    touching = total > 0.0
    safe = np.where(touching, total, 1.0)
    center = np.where(touching, (p * x).sum(axis=-1) / safe, 0.0)
    second = (p * ((x - center[..., None]) ** 2 + h * h / 6.0)).sum(axis=-1) / safe
    half_width = np.where(touching, 2.0 * np.sqrt(np.maximum(second, 0.0)), 0.0)
    return h * total, center, half_width


def hat_means(p: np.ndarray) -> np.ndarray:
    """Means over the hats across the patch (see the module) of the coefficients p (T, columns, rows) [Pa]."""
    padded = np.pad(p, ((0, 0), (1, 1), (0, 0)))
    return (padded[:, :-2] + 4.0 * padded[:, 1:-1] + padded[:, 2:]) / 6.0


class ContactResult:
    """One contact pair of a run; arrays have one row per saved step.

    Forces act on the pair's first body in world axes, torques about that body's user origin. `friction` holds
    tractions, slip and creepage of a pair with friction.
    """

    def __init__(self, history: Any, view: PairView, bodies: dict[str, Any] | None = None) -> None:
        """bodies: motions by name, `History.bodies`; without them both user frames are taken at the world's origin."""
        self.history = history
        self.view = view
        self.name = view.name
        self.bodies = bodies or {}
        self.force = history.force  # (T, 3) N, on the first body
        self.torque = history.torque  # (T, 3) N m
        self.force_second = history.force_second  # (T, 3) N, on the second body, integrated on its own surface
        self.torque_second = history.torque_second  # (T, 3) N m
        self.approach = history.approach  # (T,) m
        self.active_hats = history.active_hats  # (T,)

    @property
    def force_magnitude(self) -> np.ndarray:
        """(T,) N."""
        return np.linalg.norm(self.force, axis=1)

    @property
    def has_friction(self) -> bool:
        """True where the pair was run with friction, so that `friction` answers."""
        return getattr(self.history, "friction", None) is not None

    @cached_property
    def friction(self) -> FrictionResult:
        """Tractions, slip, stick and slip areas, creepage, power and wear index; raises `InputError` for a pair without
        friction."""
        return FrictionResult(self)

    # --- the grid on the first surface ---

    @cached_property
    def z(self) -> np.ndarray:
        """(rows,) m, along the axis of the first surface."""
        return np.asarray(self.view.first.grid.z, dtype=float)

    @cached_property
    def measure(self) -> PatchMeasure:
        """Areas of the hats and cells of the first surface's grid."""
        return PatchMeasure(self.view.first)

    @cached_property
    def mid_radius(self) -> float:
        """Metres of arc per unit of theta on the first surface at mid-width: its radius; 1 on a plane."""
        return float(self.view.first.shape.radius_at(0.5 * (self.z[0] + self.z[-1])))

    @property
    def side(self) -> float:
        """+1 where e_theta of the first surface, direction 0 of tractions, points to growing arc, -1 on an inside form,
        where it points against it."""
        return float(self.view.first.shape.side)

    @property
    def spacing(self) -> float:
        """Arc length between two hats at mid-width [m]."""
        return self.mid_radius * float(self.view.first.grid.pitch)

    @cached_property
    def _offset(self) -> np.ndarray:
        """(T, columns) columns of the window, counted from the line of centres."""
        grid = self.view.first.grid
        offset = self.history.first_column - self.history.center_column
        if grid.periodic:  # both are counted modulo the columns of the full turn: take the near way round
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

    # --- pressure ---

    @cached_property
    def touching(self) -> np.ndarray:
        """(T,) bool, whether anything presses."""
        return np.any(self.history.pressure > 0.0, axis=(1, 2))

    @cached_property
    def mean_pressure(self) -> np.ndarray:
        """(T, columns, rows) Pa, pressure of each node: the mean over its hat across the patch."""
        return hat_means(self.history.pressure)

    @cached_property
    def _section(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Rows (T,) beside the section of each saved step and the weight of the second: mid-width, of a point contact
        the centre of pressure."""
        k, k1, w = mid_width(self.z)
        steps = np.ones(len(self.touching))
        if self.patch_kind != "point" or len(self.z) == 1:
            return (k * steps).astype(int), (k1 * steps).astype(int), w * steps
        z = np.where(self.touching, self.moments.center[:, 1], 0.5 * (self.z[0] + self.z[-1]))
        at = np.clip(np.searchsorted(self.z, z, side="right") - 1, 0, len(self.z) - 2)
        return at, at + 1, (z - self.z[at]) / (self.z[at + 1] - self.z[at])

    def in_section(self, values: np.ndarray, steps: slice = slice(None)) -> np.ndarray:
        """(n, columns) of values (n, columns, rows) at the saved `steps`: along the arc at mid-width, of a point
        contact through the centre of pressure."""
        k, k1, w = (part[steps] for part in self._section)
        i = np.arange(len(values))
        return (1.0 - w)[:, None] * values[i, :, k] + w[:, None] * values[i, :, k1]

    def section_row(self, i: int) -> int:
        """The grid row nearest to the section at saved step `i`."""
        k, k1, w = (part[i] for part in self._section)
        return int(k1 if w > 0.5 else k)

    @cached_property
    def mid_pressure(self) -> np.ndarray:
        """(T, columns) Pa, pressure of the nodes at mid-width, of a point contact through the centre of pressure."""
        return self.in_section(self.mean_pressure)

    @cached_property
    def moments(self) -> PatchMoments:
        """Load, centre and covariance of the whole patch."""
        return PatchMoments(self.measure, self.history.pressure, self.view.first.grid.pitch * self._offset)

    @cached_property
    def _line(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        return line_moments(self.arc, self.in_section(self.history.pressure), self.spacing)

    @property
    def normal_load(self) -> np.ndarray:
        """(T,) N, integral of the pressure over the surface."""
        return self.moments.load

    @property
    def line_load(self) -> np.ndarray:
        """(T,) N/m, integral of the pressure across the patch at mid-width, of a point contact through its centre."""
        return self._line[0]

    @property
    def center(self) -> np.ndarray:
        """(T,) m of arc, centre of the pressure at mid-width, of a point contact of the whole patch, from the line of
        centres."""
        return self.moments.center[:, 0] if self.patch_kind == "point" else self._line[1]

    @property
    def center_of_pressure(self) -> np.ndarray:
        """(T, 2) m, of the whole patch: arc from the line of centres, and z; (0, mid-width) where nothing touches."""
        return self.moments.center

    @property
    def half_width(self) -> np.ndarray:
        """(T,) m, along the arc: twice the root of the second moment of the mid-width pressure; of a point contact or
        a flat one that of the whole patch, `half_widths[:, 0]`; of a line along the arc `half_widths[:, 1]`; 0 where
        nothing touches."""
        if self.patch_kind == "line":
            return self._line[2]
        return self.half_widths[:, 1 if self.patch_kind == "line_around" else 0]

    @cached_property
    def half_widths(self) -> np.ndarray:
        """(T, 2) m, along e_theta and t_z, from the second moments of the whole patch; 0 where nothing touches. Of a
        skewed ellipse these are the sides of its bounding rectangle; see `semi_axes`."""
        return self.moments.half_widths(self.patch_kind)

    @property
    def semi_axes(self) -> np.ndarray:
        """(T, 2) m, the larger first, of the ellipse of a point contact with the patch's second moments."""
        return self.moments.principal()[0]

    @property
    def patch_angle(self) -> np.ndarray:
        """(T,) rad, of the larger of `semi_axes`, from e_theta towards t_z."""
        return self.moments.principal()[1]

    @cached_property
    def patch_area(self) -> np.ndarray:
        """(T,) m2, area of the cells whose pressure is positive: to within half a cell along the rim of the patch."""
        return (self.history.pressure > 0.0).sum(axis=1) @ self.measure.cell_area

    @cached_property
    def peak_pressure(self) -> np.ndarray:
        """(T,) Pa, largest pressure of a node anywhere in the patch."""
        return self.mean_pressure.max(axis=(1, 2), initial=0.0)

    @cached_property
    def mid_peak_pressure(self) -> np.ndarray:
        """(T,) Pa, largest pressure of a node in `mid_pressure`: the number to hold against Hertz."""
        return self.mid_pressure.max(axis=1, initial=0.0)

    def pressure(self, i: int) -> PatchPressure:
        """Pressure of the nodes in the window of saved step `i`, with positions."""
        return PatchPressure(self.theta[i], self.arc[i], self.z, self.mean_pressure[i])

    # --- against Hertz ---

    def curvature(self, i: int) -> np.ndarray:
        """(2, 2) 1/m, relative curvature of the true surfaces along (e_theta, t_z) under the patch of saved step `i`:
        the gap is 1/2 x.K.x."""
        return pair_curvature(self, i)

    @cached_property
    def patch_kind(self) -> str:
        """ "line", "line_around" (the line lies along the arc), "point" or "flat", see `hertz`; at the largest
        load of the run."""
        return patch_kind(self)

    @cached_property
    def effective_radius(self) -> float:
        """1/(1/R1 + 1/R2) across the patch [m], of inside forms with their sign, at the largest load of the run."""
        return effective_radius(self)

    @cached_property
    def effective_modulus(self) -> float:
        """E* [Pa] of the pair, from the materials in the reduced bodies' provenance; a rigid partner adds nothing."""
        return effective_modulus(self.view)

    def hertz(self, i: int) -> HertzLine | HertzPoint:
        """Hertz's contact in saved step `i`: of a line at the line load found at mid-width, of a point at the load.

        Raises `InputError` where nothing touches, and where Hertz's theory does not apply: flat faces, surfaces that
        conform, a line that lies along the arc, a cover that is thin beside the patch.
        """
        return hertz(self, i)

    def stress_errors(self, i: int) -> dict[str, StressError]:
        """How right the von Mises stress below the line is in saved step `i`, and the depth of its maximum, by flexible
        body; bodies whose cells at the surface are no hexahedra are left out.

        Raises `InputError` where nothing touches, where the contact is no line, and where the mesh is too coarse to
        tell.
        """
        return stress_errors(self, i)

    def hertz_pressure(self, i: int, x: np.ndarray) -> np.ndarray:
        """Hertz's pressure [Pa] at arc positions `x` [m] in the section of `mid_pressure`, about the centre found in
        step `i`."""
        found = self.hertz(i)
        reach = found.section if isinstance(found, HertzPoint) else found.half_width
        return found.peak_pressure * np.sqrt(np.maximum(0.0, 1.0 - ((x - self.center[i]) / reach) ** 2))
