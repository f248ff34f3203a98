"""Two rollers that roll on each other under a load, the upper one a little slower: part of the patch may stick.

Both bores are driven; the upper one is on a guide under the load that gives the half-width. The scene of
`bench/step/friction_step.py` and of the study of the contact problem.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

import warpffrf as wf

STEEL = wf.Material(210e9, 0.3, 7850.0, name="steel")
RADIUS, BORE = 0.05, 0.015  # m
SPEED = 10.0  # rad/s
FRICTION = 0.3


@dataclass(frozen=True)
class Rollers:
    """A pair: `width` and half-width of the contact [m], mesh, cells of a patch or None for the grid of the material;
    `steps` a crossing of the patch."""

    name: str
    width: float
    half_width: float
    mesh: dict[str, Any]
    cells: tuple[int, int] | None
    steps: int

    @property
    def step(self) -> float:
        """Size of a step [s]."""
        return 2.0 * self.half_width / self.steps / (SPEED * RADIUS)


def body(pair: Rollers, material: wf.Material = STEEL) -> wf.ReducedBody:
    """A roller with tangential modes."""
    mesh = wf.mesh.roller(RADIUS, BORE, pair.width, **pair.mesh)
    return wf.reduce(
        mesh, material, interfaces={"bore": "rigid"}, contact={"rim": wf.surfaces.Cylinder()}, modes=0,
        grid=wf.ContactGrid(tangential=True, contact_fixed=pair.cells is not None), progress=False,
    )  # fmt: skip


def scene(
    pair: Rollers, roller: wf.ReducedBody, friction: float, saturation: float, other: wf.ReducedBody | None = None
) -> wf.Scene:
    """The pair at a creepage of `saturation` times that of the limit of gross sliding, mu a/R', of Carter's closed
    form Q/(mu P) = 1 - (1 - saturation)^2; `other`: the upper roller, if it is not the same."""
    modulus = STEEL.youngs_modulus / (2.0 * (1.0 - STEEL.poisson_ratio**2))
    load = np.pi * modulus * pair.half_width**2 / (4.0 * 0.5 * RADIUS) * pair.width
    creepage = saturation * FRICTION * pair.half_width / (0.5 * RADIUS)
    found, slower, at = wf.Scene(gravity=(0, 0, 0)), -SPEED * (1.0 - creepage), (0.0, 0.0, 2.0 * RADIUS)
    lower = found.add_body(roller, name="lower", angular_velocity=(0, SPEED, 0))
    upper = found.add_body(other or roller, name="upper", position=at, angular_velocity=(0, slower, 0))
    carriage = found.add_rigid_body(1.0, (1e-3, 1e-3, 1e-3), name="carriage", position=at)
    first = found.add(wf.joints.Revolute(found.ground, lower["bore"], axis=(0, 1, 0), name="first"))
    second = found.add(wf.joints.Revolute(carriage.at((0, 0, 0)), upper["bore"], axis=(0, 1, 0), name="second"))
    found.add(wf.joints.Prismatic(found.ground, carriage.at((0, 0, 0)), axis=(0, 0, 1), name="guide"))
    found.add(wf.forces.PointForce(carriage.at((0, 0, 0)), (0.0, 0.0, -load)))
    found.add(wf.joints.Drive(first, SPEED, quantity="velocity"))
    found.add(wf.joints.Drive(second, slower, quantity="velocity"))
    grid = "body_fixed" if pair.cells is None else "contact_fixed"
    found.add(wf.Contact(lower["rim"], upper["rim"], friction=friction, name="pair", grid=grid, cells=pair.cells))
    return found
