r"""Rolling with friction on an elastic half-plane, in cells: the law of friction without a body around it.

Like materials, so that pressures do not move the surfaces tangentially: Hertz's pressure stands over |x| <= a, material
runs through it from the leading edge x = a to x = -a. The traction is constant on each cell of width w; the bound mu p
and the slip are taken at its centre. In a step the material advances by A, the rigid surfaces creep by xi A against
each other, and what is at x now was at x + A before:

    s_i = u_new(x_i) - u_old(x_i + A) - xi A,      u(x) = sum_j g(x - x_j) tau_j   (`strip_displacement`),

xi A over the *whole* step also for cells that entered during it. Each step is one `solve` of the friction program.

Cells either stand with the patch (`carried=False`) or travel with the material (True, as the grid of a body does:
their phase against the patch changes from step to step). At phase 0 a centre lies in the middle of the patch. The
error of Q is of first order in w and in A, and how much of it there is depends on how far beyond the leading edge the
first centre outside lies, because that one is carried as if it stuck: see docs/studies/carter.md.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from scipy.optimize import brentq

from warpffrf.model.errors import require_number
from warpffrf.study.closed_forms import LineContact
from warpffrf.study.friction_program import solve
from warpffrf.study.influence import influence_2d, strip_displacement

Array = np.ndarray
STICK = 1e-9  # of the bound: what a sticking traction is below it at least; the program is solved to 1e-13
CREEP_ERROR = 1e-10  # of a prescribed force, over mu P


@dataclass(eq=False)
class Rolling:
    """State of a rolling line contact. Lengths m, pressures Pa.

    contact: Hertz, modulus E*; friction mu; cells per half-width (need not be whole); depth L of the fixed point in
    half-widths; phase: of the cells against the patch, in cells; carried: see the module.
    """

    contact: LineContact
    friction: float
    cells: float
    depth: float = 10.0
    phase: float = 0.0
    carried: bool = False
    traction: Array = field(init=False)  # (n,) by cell
    slip: Array = field(init=False)  # (n,) [m] in the last step
    least_loss: float = field(default=np.inf, init=False)  # smallest work [J/m] that friction took in a step

    def __post_init__(self) -> None:
        self.cells = require_number(self.cells, "cells per half-width", positive=True)
        a = self.contact.half_width
        self.width = a / self.cells
        self.count = 2 * int(np.ceil(self.cells)) + 3  # odd, and one more on each side for the phase
        self.G = influence_2d(self.count, self.width, self.contact.modulus, self.depth * a)
        self.traction = np.zeros(self.count)
        self.slip = np.zeros(self.count)

    @property
    def centers(self) -> Array:
        """x_i (n,) of the cells."""
        return self.width * (np.arange(self.count) - 0.5 * (self.count - 1) + self.phase)

    @property
    def bound(self) -> Array:
        """mu p (n,) at the centres."""
        return self.friction * self.contact.pressure(self.centers)

    @property
    def force(self) -> float:
        """Q [N/m]."""
        return float(self.traction.sum() * self.width)

    @property
    def share(self) -> float:
        """Q over mu times the sum of the pressures at the centres: at gross slip exactly 1."""
        return self.force / float(self.bound.sum() * self.width)

    @property
    def stick(self) -> Array:
        """Cells (n,) that stick: the traction is below its bound."""
        return np.abs(self.traction) < self.bound * (1.0 - STICK)

    def displacement(self, x: Array) -> Array:
        """u [m] at x [m] by the present tractions."""
        offset = np.subtract.outer(x, self.centers)
        return strip_displacement(offset, self.width, self.contact.modulus, self.depth * self.contact.half_width) @ (
            self.traction
        )

    @property
    def lost(self) -> float:
        """Work [J/m] that friction took in the last step."""
        return float(-(self.traction * self.slip).sum() * self.width)

    def _enter(self, advance: float) -> Array:
        """Moves cells that travel; returns u_old (n,) where the material at their centres was."""
        moved = self.phase - advance / self.width if self.carried else self.phase
        new = self.phase if not self.carried else moved - np.round(moved)
        was = self.displacement(self.centers + (new - self.phase) * self.width + advance)
        self.phase = new
        return was

    def roll(self, advance: float, creepage: float) -> None:
        """One step: the material advances by `advance` [m] at the given creepage xi [-]."""
        s0 = -creepage * advance - self._enter(advance)
        self.traction = solve(self.G, s0, self.bound, self.traction)
        self._book(s0)

    def roll_under(self, advance: float, force: float) -> float:
        """One step at the prescribed force [N/m]; returns the creepage of this step."""
        was = self._enter(advance)
        bound = self.bound
        # a step of creep beyond all elastic displacement slips as a whole
        most = float(np.abs(was).max() + np.abs(self.G @ bound).max()) / advance

        def excess(creepage: float) -> float:
            tau = solve(self.G, -creepage * advance - was, bound, self.traction)
            return float(tau.sum() * self.width - force) / (self.friction * self.contact.load)

        creepage = float(brentq(excess, -most, most, xtol=CREEP_ERROR * most))  # pyright: ignore[reportArgumentType]
        s0 = -creepage * advance - was
        self.traction = solve(self.G, s0, bound, self.traction)
        self._book(s0)
        return creepage

    def _book(self, s0: Array) -> None:
        self.slip = self.G @ self.traction + s0
        self.least_loss = min(self.least_loss, self.lost)


def settle(rolling: Rolling, creepage: float, *, steps: int, crossings: float = 10.0) -> list[float]:
    """Rolls `crossings` widths 2 a of the patch, `steps` steps in each; Q/(mu P) after every step."""
    advance = 2.0 * rolling.contact.half_width / steps
    history = []
    for _ in range(int(round(crossings * steps))):
        rolling.roll(advance, creepage)
        history.append(rolling.share)
    return history
