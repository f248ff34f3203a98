r"""One contact pair of a run: forces, and what the pressure on the hats says about the patch.

The pressure is piecewise linear around, `p(x) = sum_j p_j psi_j(x)`, with hats of spacing `h` at `x_j` along the arc.
Then, exactly,

    P' = int p dx = h sum_j p_j                          line load [N/m]
    c  = int p x dx / P' = sum_j p_j x_j / sum_j p_j     centre
    m2 = int p (x - c)^2 dx / P' = sum_j p_j ((x_j - c)^2 + h^2/6) / sum_j p_j

because the second moment of one hat about its own node is h^3/6. For Hertz's line pressure `p0 sqrt(1 - x^2/a^2)` the
second moment is `a^2/4`, hence the half-width `2 sqrt(m2)`: unlike the extent of the active set it does not jump with
the grid.

The hat coefficients themselves swing about the pressure from node to node: the second body follows a pressure of the
first grid's wavelength only in part, because its own grid does not resolve it. The mean over each hat, consistent nodal
force over nodal area,

    pbar_j = int p psi_j dx / int psi_j dx = (p_(j-1) + 4 p_j + p_(j+1)) / 6,

is free of that and exact for a linear pressure (a peak of curvature p0/a^2 is underestimated by h^2/(12 a^2), 0.5 % at
four hats in a half-width). It is what is reported as pressure and held against Hertz; force, torque and moments are
those of the hats, which the mean does not change.

Hertz (K. L. Johnson, Contact Mechanics, 1985, section 4.2): `a^2 = 4 P' R / (pi E*)`, `p0 = 2 P' / (pi a)`,
`1/R = 1/R1 + 1/R2`, `1/E* = (1 - nu1^2)/E1 + (1 - nu2^2)/E2`.
"""

from __future__ import annotations

from functools import cached_property
from typing import Any, NamedTuple

import numpy as np

from warpffrf.model.errors import InputError
from warpffrf.output.scene_view import PairView


class PatchPressure(NamedTuple):
    """Pressure in the window of one saved step on the first body's contact grid."""

    theta: np.ndarray  # (columns,) rad, chart of the first surface, increasing, not wrapped
    arc: np.ndarray  # (columns,) m, along the mid-width circle, from the line of centres
    z: np.ndarray  # (rows,) m, along the axis of the first surface
    pressure: np.ndarray  # (columns, rows) Pa


class HertzLine(NamedTuple):
    """Hertz's line contact at the line load found at mid-width."""

    half_width: float  # m
    peak_pressure: float  # Pa
    line_load: float  # N/m
    radius: float  # m, 1/(1/R1 + 1/R2) at mid-width
    modulus: float  # Pa, E*


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

    Forces act on the pair's first body in world axes, torques about that body's user origin.
    """

    def __init__(self, history: Any, view: PairView) -> None:
        self.history = history
        self.view = view
        self.name = view.name
        self.force = history.force  # (T, 3) N, on the first body
        self.torque = history.torque  # (T, 3) N m
        self.force_second = history.force_second  # (T, 3) N, on the second body, integrated on its own surface
        self.torque_second = history.torque_second  # (T, 3) N m
        self.approach = history.approach  # (T,) m
        self.active_modes = history.active_modes  # (T,)

    @property
    def force_magnitude(self) -> np.ndarray:
        """(T,) N."""
        return np.linalg.norm(self.force, axis=1)

    @cached_property
    def mid_radius(self) -> float:
        """Radius of the first surface at mid-width [m]."""
        z = np.asarray(self.view.first.grid.z)
        return float(self.view.first.shape.radius_at(0.5 * (z[0] + z[-1])))

    @property
    def spacing(self) -> float:
        """Arc length between two hats at mid-width [m]."""
        return self.mid_radius * float(self.view.first.grid.pitch)

    @cached_property
    def arc(self) -> np.ndarray:
        """(T, columns) m, positions of the window's columns along the mid-width circle, from the line of centres."""
        grid = self.view.first.grid
        offset = self.history.first_column - self.history.center_column
        if grid.periodic:  # both are counted modulo the columns of the full turn: take the near way round
            offset = (offset + 0.5 * grid.columns) % grid.columns - 0.5 * grid.columns
        return self.spacing * (offset[:, None] + np.arange(self.history.pressure.shape[1]))

    @cached_property
    def theta(self) -> np.ndarray:
        """(T, columns) rad, positions of the window's columns in the chart of the first surface."""
        grid = self.view.first.grid
        return grid.theta_start + grid.pitch * (
            self.history.first_column[:, None] + np.arange(self.history.pressure.shape[1])
        )

    @cached_property
    def mean_pressure(self) -> np.ndarray:
        """(T, columns, rows) Pa, pressure of each node: the mean over its hat across the patch."""
        return hat_means(self.history.pressure)

    def _at_mid_width(self, values: np.ndarray) -> np.ndarray:
        k, k1, w = mid_width(np.asarray(self.view.first.grid.z))
        return (1.0 - w) * values[:, :, k] + w * values[:, :, k1]

    @cached_property
    def mid_pressure(self) -> np.ndarray:
        """(T, columns) Pa, pressure of the nodes at mid-width."""
        return self._at_mid_width(self.mean_pressure)

    @cached_property
    def _moments(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        return line_moments(self.arc, self._at_mid_width(self.history.pressure), self.spacing)

    @property
    def line_load(self) -> np.ndarray:
        """(T,) N/m, integral of the pressure across the patch at mid-width."""
        return self._moments[0]

    @property
    def center(self) -> np.ndarray:
        """(T,) m, centre of the pressure at mid-width, from the line of centres."""
        return self._moments[1]

    @property
    def half_width(self) -> np.ndarray:
        """(T,) m, twice the root of the second moment of the mid-width pressure; 0 where nothing touches."""
        return self._moments[2]

    @cached_property
    def peak_pressure(self) -> np.ndarray:
        """(T,) Pa, largest pressure of a node anywhere in the patch."""
        return self.mean_pressure.max(axis=(1, 2), initial=0.0)

    @cached_property
    def mid_peak_pressure(self) -> np.ndarray:
        """(T,) Pa, largest pressure of a node at mid-width: the number to hold against Hertz."""
        return self.mid_pressure.max(axis=1, initial=0.0)

    def pressure(self, i: int) -> PatchPressure:
        """Pressure of the nodes in the window of saved step `i`, with positions."""
        return PatchPressure(self.theta[i], self.arc[i], np.asarray(self.view.first.grid.z), self.mean_pressure[i])

    @cached_property
    def effective_radius(self) -> float:
        """1/(1/R1 + 1/R2) at mid-width [m]."""
        z = np.asarray(self.view.second.grid.z)
        R2 = float(self.view.second.shape.radius_at(0.5 * (z[0] + z[-1])))
        return 1.0 / (1.0 / self.mid_radius + 1.0 / R2)

    @cached_property
    def effective_modulus(self) -> float:
        """E* [Pa] of the pair, from the materials in the reduced bodies' provenance."""
        compliance = 0.0
        for body, surface in (
            (self.view.first_body, self.view.first),
            (self.view.second_body, self.view.second),
        ):
            material = body.reduced.provenance.get("contact_materials", {}).get(surface.name)
            if not material:
                raise InputError(
                    f"contact '{self.name}': body '{body.name}' does not say its material, so Hertz cannot be "
                    "computed; reduce the body again with this version"
                )
            compliance += (1.0 - material["poisson_ratio"] ** 2) / material["youngs_modulus"]
        return 1.0 / compliance

    def hertz(self, i: int) -> HertzLine:
        """Hertz's line contact at the line load found at mid-width in saved step `i`."""
        P = float(self.line_load[i])
        R, E = self.effective_radius, self.effective_modulus
        a = float(np.sqrt(4.0 * P * R / (np.pi * E)))
        return HertzLine(a, 2.0 * P / (np.pi * a) if a > 0.0 else 0.0, P, R, E)

    def hertz_pressure(self, i: int, x: np.ndarray) -> np.ndarray:
        """Hertz's pressure [Pa] at arc positions `x` [m] about the centre found in step `i`."""
        line = self.hertz(i)
        if line.half_width == 0.0:
            return np.zeros_like(x)
        return line.peak_pressure * np.sqrt(np.maximum(0.0, 1.0 - ((x - self.center[i]) / line.half_width) ** 2))
