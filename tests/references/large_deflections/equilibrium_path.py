"""The path of an arch through two limit points: displacement-controlled, in full finite elements."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from references.large_deflections.body import StVenantKirchhoffBody
from references.large_deflections.statics import by_displacement
from warpffrf.model.material import Material
from warpffrf.model.mesh import Mesh


@dataclass(frozen=True, eq=False)
class EquilibriumPath:
    """Equilibria of the arch: displacements w (n,) [m] of its crown, growing, forces F (n,) [N] down; cubic between."""

    w: np.ndarray
    F: np.ndarray

    def __call__(self, w: np.ndarray | float) -> np.ndarray:
        """F at w, or at many."""
        return self._spline(w)

    @cached_property
    def _spline(self) -> Any:
        from scipy.interpolate import CubicSpline

        return CubicSpline(self.w, self.F)

    @cached_property
    def limits(self) -> tuple[float, float]:
        """w_1, w_2 [m] of the two limit points."""
        roots = self._spline.derivative().roots(extrapolate=False)
        bends = self._spline.derivative(2)(roots)
        return float(roots[bends < 0.0][0]), float(roots[bends > 0.0][-1])

    @property
    def loads(self) -> tuple[float, float]:
        """F_1, F_2 [N]."""
        w_1, w_2 = self.limits
        return float(self(w_1)), float(self(w_2))

    def rising(self, force: float, *, behind: bool) -> float:
        """w [m] at a force on the rising branch before the first limit point, or behind the second one."""
        roots = self._spline.solve(force, extrapolate=False)
        w_1, w_2 = self.limits
        return float(roots[roots > w_2][0] if behind else roots[roots < w_1][-1])

    @property
    def work_of_a_cycle(self) -> float:
        """J, dissipated by the jumps there and back: int (F_1 - F) dw from w_1 to its landing point, and
        int (F - F_2) dw from its landing point to w_2."""
        (w_1, w_2), (F_1, F_2) = self.limits, self.loads
        there, back = self.rising(F_1, behind=True), self.rising(F_2, behind=False)
        up, down = self._spline.integrate(w_1, there), self._spline.integrate(back, w_2)
        return float(F_1 * (there - w_1) - up + down - F_2 * (w_2 - back))


def pushed_arch(
    mesh: Mesh, material: Material, top: tuple[float, float, float], farthest: float, steps: int
) -> EquilibriumPath:
    """The path of an arch fixed at its facet sets `x_min` and `x_max` and pushed down at `crown`, of St. Venant-
    Kirchhoff's material, in `steps` of the displacement `farthest` [m] of the node at `top` [m] and one more; w is the
    mean over the crown."""
    body = StVenantKirchhoffBody(mesh, material)
    load = body.spread("crown", (0.0, 0.0, -1.0))
    middle = 3 * body.nearest_node(top) + 2
    ways = -farthest * np.arange(1, steps + 2) / steps
    states = by_displacement(body, body.held("x_min", "x_max"), load, middle, ways)
    w, F = np.array([(0.0, 0.0), *((load @ s.u, s.factor) for s in states)]).T
    return EquilibriumPath(w, F)
