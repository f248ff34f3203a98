r"""Two half-planes of unlike materials in free rolling: the creepage at zero tangential force.

Cells, pressures and tractions of `unlike_half_planes.Pair`; material moves along -x by one cell per step, so that
the material now at x was at x + w before:

    s = [N q + K^T p]_new(x) - [N q + K^T p]_old(x + w) - xi w,      xi = (V1 - V2)/V,

positive s the slip of the first body along +x. In every step xi is chosen for sum q = 0: no body twists, and the
creepage is steady after a few crossings. Entering material receives the slip of a whole cell, an error of first order
in w. With friction that never slips it tends to continuous adhesion (R. H. Bentall, K. L. Johnson, Int. J. Mech. Sci. 9
(1967) 389).
"""

from __future__ import annotations

from typing import Any

import numpy as np
from scipy.optimize import brentq

from references.closed_forms import LineContact, contact_modulus
from references.finite_elements.contact import active_set
from references.half_space.friction_program import solve
from references.half_space.unlike_half_planes import Pair
from warpffrf.model.material import Material

PAD = 0.15  # half-widths of the grid beyond Hertz's patch
CROSSINGS = 3.0  # rolled distance in lengths of the patch
TURNS, SETTLED = 40, 1e-7  # alternations of pressures and tractions per step; their change over the largest pressure
NO_FORCE = 1e-5  # of the largest creepage looked for, mu a/R'


class RollingPair(Pair):
    """`Pair` that also rolls, along +x."""

    def roll_freely(self, load: float, most: float) -> float:
        """One cell further at the load P' [N/m] without a force; returns the creepage, sought within +-most."""
        before = self.tangential
        was = np.append(before[1:], before[-1])
        p, q, xi = self.p, self.q, 0.0
        unit = np.eye(self.cells) * self.width
        for _ in range(TURNS):
            gap = 0.5 * self.x**2 / self.radius + self.K @ q
            new, *_ = active_set(self.N / self.width, gap, np.ones(self.cells), unit, load, (0, -1))
            base, bound, old = self.K.T @ new - was, self.friction * new, q

            def traction(creepage: float, base: Any = base, bound: Any = bound, old: Any = old) -> Any:
                return solve(self.N, base - creepage * self.width, bound, old)

            xi = float(brentq(lambda c: float(traction(c).sum()), -most, most, xtol=NO_FORCE * most))  # pyright: ignore
            q = traction(xi)
            change, p = max(np.abs(new - p).max(), np.abs(q - old).max()), new
            if change <= SETTLED * p.max():
                break
        else:
            raise RuntimeError(f"normal and tangential contact did not settle in {TURNS} turns")
        self.p, self.q = p, q
        return xi


def free_rolling(
    first: Material, second: Material, radius: float, load: float, friction: float, cells: int,
    crossings: float = CROSSINGS,
) -> tuple[float, float]:  # fmt: skip
    """Mean force-free creepage of cylinders of two materials over the last half crossing, and its variation
    in it; R' [m], P' [N/m], with `cells` + 1/2 in Hertz's half-width: its ends lie between two, on any grid."""
    contact = LineContact(load, radius, contact_modulus(first, second))
    count = 2 * (cells + int(np.ceil(PAD * cells))) + 1
    width = contact.half_width / (cells + 0.5)
    pair = RollingPair(first, second, radius, friction, 0.5 * count * width, count)
    pair.step(load, 0.0)
    most = friction * contact.half_width / radius
    half = int(round(contact.half_width / pair.width))
    found = [pair.roll_freely(load, most) for _ in range(int(round(2.0 * crossings * half)))]
    last = np.array(found[-half:])
    return float(last.mean()), float(np.ptp(last))
