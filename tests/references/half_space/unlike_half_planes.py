r"""Two half-planes of unlike materials that press and slide on each other, in cells: normal and tangential coupled.

Pressure p and traction q (on the first body, along +x) constant on cells, everything at their centres, with N = G of
`influence_2d` and K of `coupling_2d`:

    gap   g = x^2/(2 R) - delta + N p + K q,     0 <= p  _|_  g >= 0,     sum p w = P',
    slip  s = [N q + K^T p]_new - [N q + K^T p]_old - D,     |q| <= mu p, Coulomb,

D the displacement of the first body's far part along x in the step (P' prescribed), or the total traction instead. The
two halves are solved alternately, each exactly, until both are stationary (Panagiotopoulos): the coupling enters as
beta mu, well below 1, so that an iteration reduces the error by that factor. K and K^T have opposite signs (K is
antisymmetric): the coupled problem has no potential and is not one program.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from references.closed_forms import contact_modulus
from references.finite_elements.contact import active_set
from references.half_space.friction_program import solve
from references.half_space.influence import coupling_2d, influence_2d
from warpffrf.model.errors import require_number
from warpffrf.model.material import Material

Array = np.ndarray
TURNS = 200  # maximum of alternations
SETTLED = 1e-11  # change of pressure and traction per alternation over the largest pressure


@dataclass(eq=False)
class Pair:
    """State of the pair. x (n,) [m] centres of the cells, p and q (n,) [Pa], slip (n,) [m] of the last step.

    first, second (None: rigid) materials; radius R [m]; friction mu; half_width [m] of the grid, cells n in it.
    """

    first: Material
    second: Material | None
    radius: float
    friction: float
    half_width: float
    cells: int
    p: Array = field(init=False)
    q: Array = field(init=False)
    slip: Array = field(init=False)
    turns: int = field(default=0, init=False)  # of the last step

    def __post_init__(self) -> None:
        require_number(self.friction, "friction", non_negative=True)
        n = self.cells
        self.width = 2.0 * require_number(self.half_width, "half-width of the grid", positive=True) / n
        self.x = self.width * (np.arange(n) - 0.5 * (n - 1))
        modulus = contact_modulus(self.first, self.second)
        self.N = influence_2d(n, self.width, modulus, 10.0 * self.half_width)
        self.K = coupling_2d(n, self.width, self.first, self.second)
        self.p, self.q, self.slip = np.zeros(n), np.zeros(n), np.zeros(n)

    @property
    def tangential(self) -> Array:
        """Relative tangential displacement (n,) [m] by the present p and q."""
        return self.N @ self.q + self.K.T @ self.p

    def step(self, load: float, shift: float) -> None:
        """To the load P' [N/m] while the far part of the first body moves by `shift` [m] along x."""
        require_number(load, "load", positive=True)
        was, p, q = self.tangential, self.p, self.q
        unit = np.eye(self.cells) * self.width
        for turn in range(1, TURNS + 1):
            gap = 0.5 * self.x**2 / self.radius + self.K @ q
            new, *_ = active_set(self.N / self.width, gap, np.ones(self.cells), unit, load, (0, -1))
            # the traction on the first body opposes its motion: s is its slip relative to the second
            s0 = self.K.T @ new - was + shift
            old = q
            q = solve(self.N, s0, self.friction * new, old)
            change, p = max(np.abs(new - p).max(), np.abs(q - old).max()), new
            if change <= SETTLED * p.max():
                self.p, self.q, self.slip, self.turns = p, q, self.N @ q + s0, turn
                return
        raise RuntimeError(f"normal and tangential contact did not settle in {TURNS} turns")
