r"""A tread pressed against its mirror image, pressures on contact-fixed cells (`Contact(grid="contact_fixed")`).

The same bodies, layers and forces as in `pressing`, by the program itself: two rollers whose bores are held, at rest,
rotated so that the line of centres stands at a given angle of the lower one's grid and at the opposite angle of the
upper one's, which makes them mirror images. The approach is found for which the pressures carry the wanted force.

Cells are strips of 2 W/strips, W = 1.3 half-widths, in rows; their pressure p is constant in each. To be compared
with pressures of nodes it is averaged over the nodes of the bodies' grid: the force of the node i

    f_i = int psi_i p dA = R sum over cells  p_cell  int_strip psi_a dtheta  int_row psi_b dz,     i = (a, b),

exact, because the nodes are products and their integrals over an interval are differences of a parabola by pieces.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from scenes.rollers import PAIR
from studies.contact.pressing import Pressing, carrying
from studies.speed.step_time import RADIUS
from warpffrf.model import joints
from warpffrf.model.contact import Contact
from warpffrf.model.errors import InputError
from warpffrf.model.laws import LinearLayer
from warpffrf.model.scene import Scene
from warpffrf.online import History
from warpffrf.output.simulate import equilibrium

SETTLED = 1e-6  # of the force: an equilibrium ends at a residual that is not much smaller
ROWS = 21  # along: as many as the program takes with eleven strips


class Refused(RuntimeError):
    """The program takes no such cells, or found no state of rest; says why."""


@dataclass(frozen=True)
class OnPatch:
    """The bodies of `pressing`, reduced with `contact_fixed=True`, in contact on so many `strips` of ROWS cells."""

    pressing: Pressing
    strips: int

    @property
    def name(self) -> str:
        """What a column of a table is called."""
        return f"patch {self.strips}"

    def scene(self, k: float, center: float, delta: float) -> Scene:
        """Both rollers `delta` [m] too near, line of centres at the angle `center`; k [Pa/m] of the layer."""
        scene = Scene(gravity=(0.0, 0.0, 0.0))
        bodies = []
        for name, turn, height in (("lower", -1.0, 0.0), ("upper", 1.0, 2.0 * RADIUS - delta)):
            half = 0.5 * turn * (0.5 * np.pi + center)
            body = scene.add_body(
                self.pressing.body, name=name, position=(0.0, 0.0, height),
                rotation=(0.0, np.sin(half), 0.0, np.cos(half)),
            )  # fmt: skip
            scene.add(joints.Fixed(scene.ground, body["bore"]))
            bodies.append(body)
        lower, upper = (body["tread"] for body in bodies)
        scene.add(Contact(lower, upper, law=LinearLayer(k), grid="contact_fixed", cells=(self.strips, ROWS), name=PAIR))
        return scene

    def at(self, k: float, center: float, delta: float) -> np.ndarray:
        """Forces (nodes,) [N] of the nodes at the approach `delta` [m]. Raises `Refused` where the bodies take no cells
        that travel, and where there is no state of rest."""
        try:
            result = equilibrium(self.scene(k, center, delta))
        except InputError as error:
            raise Refused(f"{self.name}: {error}") from error
        if result.status != "completed":
            raise Refused(f"{self.name}: {result.status}: {result.message}")
        return node_forces(self.pressing, result.history)

    def forces(self, k: float, center: float, load: float) -> np.ndarray:
        """Forces (nodes,) [N] of the nodes under the total force `load` [N]; arguments as of `scene`."""
        return carrying(lambda delta: self.at(k, center, delta), load, SETTLED, self.name)


def node_forces(pressing: Pressing, history: History) -> np.ndarray:
    """Forces (nodes,) [N] of the nodes at the last saved step, of a run on contact-fixed cells."""
    record = history.contacts[PAIR]
    cells = record.cells
    if cells is None:
        raise ValueError(f"contact {PAIR!r} has its pressures on the material grid; give it grid='contact_fixed'")
    W, grid = float(cells.half_width[-1]), pressing.grid
    pressure = record.pressure[-1]
    middle = (float(cells.column[-1]) - pressing.middle) * grid.pitch
    strips = middle + np.linspace(-W, W, len(pressure) + 1) / RADIUS
    rows = np.append(cells.z[-1] - 0.5 * cells.length[-1], cells.z[-1][-1] + 0.5 * cells.length[-1][-1])
    around = RADIUS * nodes_over(pressing.angle, strips)
    return (around @ pressure @ nodes_over(np.asarray(grid.z), rows).T).ravel()


def nodes_over(lines: np.ndarray, edges: np.ndarray) -> np.ndarray:
    """Integrals (n, m) of the nodes on `lines` (n,) over the m intervals between `edges` (m + 1,)."""
    steps = np.diff(lines)
    inside = np.clip((edges - lines[:-1, None]) / steps[:, None], 0.0, 1.0)
    rising = 0.5 * steps[:, None] * inside**2  # up to each edge, of the node at the upper line of a step
    falling = steps[:, None] * (inside - 0.5 * inside**2)
    up_to = np.zeros((len(lines), len(edges)))
    up_to[1:] += rising
    up_to[:-1] += falling
    return np.diff(up_to, axis=1)
