r"""Rolling with friction on an elastic half-plane, in cells: the law of friction without a body around it.

Like materials, so that pressures do not move the surfaces tangentially: Hertz's contact is fixed at |x| <= a, its
pressure in hat functions (`node_pressures`), material moves through it from the leading edge x = a to x = -a. The
traction is constant on each cell of width w. In a step the material advances by A, the rigid surfaces creep by xi A
relative to each other, and the material now at x was at x + A before:

    s_i = u_new(x_i) - u_old(x_i + A) - xi A,      u(x) = sum_j g(x - x_j) tau_j   (`strip_mean`: over a cell about x),

xi A over the *whole* step also for cells that the patch reached during it. Those slide freely until then: with all
other tractions linear in time and their own growing from zero at the touch, at the part (1 - phi) of the step, "no slip
since the touch" is, divided by phi,

    s_i + k_i tau_i = 0,      k_i = (1 - phi)/phi c,      (1 - phi)/phi = A/(w d_i) - 1 where that is positive,

d_i w the distance from the node to the edge of the patch, plus w/8, since the front of a cell touches w/2 before its
node. c = 2 (g(0) - g(w)): the gain of a cell is the loss of its neighbours, and their common far field must cancel. The
factor 2 and the eighth are measured: with both the error is below 0.5 % at eight cells at every phase and at up to two
cells per step. Without the softness (`late=False`) it depends on the distance of the first outside node from the edge,
because that node is treated as if it stuck: see docs/studies/carter.md.

Each step is one `solve` of the friction program. Cells are either contact-fixed (`carried=False`) or body-fixed
(True, as the grid of a body: their phase relative to the patch changes from step to step). At phase 0 a
centre lies in the middle of the patch.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from scipy.optimize import brentq

from references.closed_forms import LineContact
from references.half_space.friction_program import solve
from references.half_space.influence import mean_2d, strip_mean
from references.half_space.node_pressures import bounding, edge_beyond, line_pressures
from warpffrf.model.errors import require_number

Array = np.ndarray
STICK = 1e-9  # of the bound: least distance of a sticking traction from it; the program is solved to 1e-13
AHEAD = 0.125  # columns by which a cell is touched before its node
JUST_REACHED = 0.02  # columns: a cell not yet reached counts as passed by this, so that gross slip loads it too
CREEP_ERROR = 1e-10  # of a prescribed force, over mu P


@dataclass(eq=False)
class Rolling:
    """State of a rolling line contact. Lengths m, pressures Pa.

    contact: Hertz, modulus E*; friction mu; cells per half-width (need not be whole); depth L of the fixed point in
    half-widths; phase: of the cells relative to the patch, in cells; carried, late: see the module.
    """

    contact: LineContact
    friction: float
    cells: float
    depth: float = 10.0
    phase: float = 0.0
    carried: bool = False
    late: bool = True
    pressure: Array = field(init=False)  # (n,) Pa, nodal coefficients at the centres
    traction: Array = field(init=False)  # (n,) by cell
    slip: Array = field(init=False)  # (n,) [m] in the last step
    least_loss: float = field(default=np.inf, init=False)  # smallest dissipation [J/m] of friction in a step

    def __post_init__(self) -> None:
        self.cells = require_number(self.cells, "cells per half-width", positive=True)
        a = self.contact.half_width
        self.width = a / self.cells
        self.count = 2 * int(np.ceil(self.cells)) + 7  # odd, and on each side one for the phase and two without load
        self.G = mean_2d(self.count, self.width, self.contact.modulus, self.depth * a)
        self.pressure = line_pressures(self.contact, self.centers, self.depth * a)
        self.traction = np.zeros(self.count)
        self.slip = np.zeros(self.count)

    @property
    def centers(self) -> Array:
        """x_i (n,) of the cells."""
        return self.width * (np.arange(self.count) - 0.5 * (self.count - 1) + self.phase)

    @property
    def bound(self) -> Array:
        """mu p (n,)."""
        return self.friction * bounding(self.pressure)

    @property
    def force(self) -> float:
        """Q [N/m]."""
        return float(self.traction.sum() * self.width)

    @property
    def share(self) -> float:
        """Q over mu P: at gross slip exactly 1."""
        return self.force / (self.friction * self.contact.load)

    @property
    def stick(self) -> Array:
        """Cells (n,) that stick: the traction is below its bound."""
        return np.abs(self.traction) < self.bound * (1.0 - STICK)

    def displacement(self, x: Array) -> Array:
        """u [m], mean over cells about x [m], by the present tractions."""
        offset = np.subtract.outer(x, self.centers)
        depth = self.depth * self.contact.half_width
        return strip_mean(offset, self.width, self.contact.modulus, depth) @ self.traction

    @property
    def lost(self) -> float:
        """Dissipation [J/m] of friction in the last step."""
        return float(-(self.traction * self.slip).sum() * self.width)

    def _enter(self, advance: float) -> Array:
        """Moves body-fixed cells; returns u_old (n,) at the previous positions of the material at their centres."""
        moved = self.phase - advance / self.width if self.carried else self.phase
        new = self.phase if not self.carried else moved - np.round(moved)
        was = self.displacement(self.centers + (new - self.phase) * self.width + advance)
        if new != self.phase:
            self.phase = new
            self.pressure = line_pressures(self.contact, self.centers, self.depth * self.contact.half_width)
        return was

    def _compliance(self, advance: float) -> Array:
        """G with the softness of cells that the patch has reached during the step."""
        ahead = edge_beyond(self.pressure) - np.arange(self.count) + AHEAD
        lag = np.maximum(advance / self.width / np.maximum(ahead, JUST_REACHED) - 1.0, 0.0)
        softness = 2.0 * (self.G[0, 0] - self.G[0, 1]) * lag if self.late else np.zeros(self.count)
        return self.G + np.diag(softness)

    def roll(self, advance: float, creepage: float) -> None:
        """One step: the material advances by `advance` [m] at the given creepage xi [-]."""
        s0 = -creepage * advance - self._enter(advance)
        self.traction = solve(self._compliance(advance), s0, self.bound, self.traction)
        self._book(s0)

    def roll_under(self, advance: float, force: float) -> float:
        """One step at the prescribed force [N/m]; returns the creepage of this step."""
        was = self._enter(advance)
        bound, G = self.bound, self._compliance(advance)
        # a step of creep beyond all elastic displacement slips completely
        most = float(np.abs(was).max() + np.abs(self.G @ bound).max()) / advance

        def excess(creepage: float) -> float:
            tau = solve(G, -creepage * advance - was, bound, self.traction)
            return float(tau.sum() * self.width - force) / (self.friction * self.contact.load)

        creepage = float(brentq(excess, -most, most, xtol=CREEP_ERROR * most))  # pyright: ignore[reportArgumentType]
        s0 = -creepage * advance - was
        self.traction = solve(G, s0, bound, self.traction)
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
