r"""Tangential loading of a patch at rest in cells, on the half-plane and the half-space: cases C4 and C5.

Hertz's contact is fixed, its pressure in hat functions (`node_pressures`); the far parts of the two bodies are shifted
relative to each other by increments D (n cells, tractions constant on each, bounds of `bounding`, means over cells):

    s_i = u_new,i - u_old,i - D,      u = G tau,

one `solve` of the friction program each. A given force is found by its shift. Half-space: both components of
traction, so that slip may deviate from the direction of the shift, which Cattaneo and Mindlin neglect.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from scipy.optimize import brentq

from references.closed_forms import LineContact, PointContact
from references.half_space.friction_program import solve
from references.half_space.influence import mean_2d, mean_3d
from references.half_space.node_pressures import bounding, line_pressures, point_pressures
from references.half_space.rolling import STICK
from warpffrf.model.material import Material

Array = np.ndarray
BEYOND = 3  # columns outside Hertz's patch, so that the outermost are free of traction
FORCE_ERROR = 1e-9  # of a prescribed force, over mu P


@dataclass(eq=False)
class Patch:
    """centers (n, d) [m] for d = 1, 2; G (n d, n d) [m/Pa]; bound (n,) [Pa]; area (n,) [m2 or m] of the cells."""

    centers: Array
    G: Array
    bound: Array
    area: float
    traction: Array = field(init=False)  # (n, d) [Pa]
    shift: float = 0.0  # of the far parts along direction 0 so far [m]
    lost: float = 0.0  # work [J or J/m] of friction so far
    least_loss: float = field(default=np.inf, init=False)  # of a step

    def __post_init__(self) -> None:
        self.traction = np.zeros(self.centers.shape)

    @property
    def limit(self) -> float:
        """mu P [N or N/m] of the cells."""
        return float(self.bound.sum() * self.area)

    @property
    def force(self) -> float:
        """Q along direction 0 [N or N/m]."""
        return float(self.traction[:, 0].sum() * self.area)

    @property
    def stick(self) -> Array:
        """Cells (n,) whose traction is below its bound."""
        return np.linalg.norm(self.traction, axis=1) < self.bound * (1.0 - STICK)

    @property
    def stick_size(self) -> float:
        """Half-width or radius c [m] of the stick zone by its measure."""
        measure = float(self.stick.sum() * self.area)
        return 0.5 * measure if self.centers.shape[1] == 1 else float(np.sqrt(measure / np.pi))

    def _solve(self, increment: float) -> tuple[Array, Array]:
        s0 = -(self.G @ self.traction.ravel()).reshape(self.traction.shape)
        s0[:, 0] -= increment
        tau = solve(self.G, s0, self.bound, self.traction)
        return tau, (self.G @ tau.ravel()).reshape(tau.shape) + s0

    def move(self, increment: float) -> None:
        """One step by the shift `increment` [m]."""
        self.traction, slip = self._solve(increment)
        loss = float(-(self.traction * slip).sum() * self.area)
        self.shift += increment
        self.lost += loss
        self.least_loss = min(self.least_loss, loss)

    def move_under(self, force: float, reach: float) -> None:
        """One step to the force Q [N or N/m], |Q| < mu P; its shift is sought within +-reach [m]."""

        def excess(increment: float) -> float:
            return (float(self._solve(increment)[0][:, 0].sum() * self.area) - force) / self.limit

        found = brentq(excess, -reach, reach, xtol=FORCE_ERROR * reach)
        self.move(float(found))  # pyright: ignore[reportArgumentType]


def line_patch(contact: LineContact, friction: float, cells: int, depth: float = 10.0) -> Patch:
    """Half-plane, like materials: `cells` per half-width, one in the middle; depth L in half-widths."""
    w, depth = contact.half_width / cells, depth * contact.half_width
    x = w * np.arange(-cells - BEYOND, cells + BEYOND + 1)
    bound = friction * bounding(line_pressures(contact, x, depth))
    on = bound > 0.0
    return Patch(x[on][:, None], mean_2d(int(on.sum()), w, contact.modulus, depth), bound[on], w)


def point_patch(
    contact: PointContact, friction: float, cells: float, first: Material, second: Material | None = None
) -> Patch:
    """Half-space in square cells, `cells` per radius; only cells with a bound. `second` None: rigid.

    The pressure is Hertz's also between unlike materials: its coupling with the tractions is neglected, as in C4.
    """
    w, n = contact.half_width / cells, int(np.ceil(cells)) + BEYOND
    k = w * np.arange(-n, n + 1)
    nodes = np.stack(np.meshgrid(k, k, indexing="ij"), axis=-1)
    bound = friction * bounding(point_pressures(contact, nodes))
    on = bound > 0.0
    return Patch(nodes[on], mean_3d(nodes[on], (w, w), first, second), bound[on], w * w)


def cycle_loss(patch: Patch, peak: float, steps: int) -> float:
    """Work [J or J/m] lost in a cycle between shifts +-peak [m], in `steps` steps each way; the patch is at
    +peak before."""
    before = patch.lost
    for way in (-1.0, 1.0):
        for _ in range(steps):
            patch.move(way * 2.0 * peak / steps)
    return patch.lost - before
