r"""Two steel balls meet head-on at 10 m/s: Hertz's impact (`closed_forms.HertzImpact`), 27 us long.

They exchange their velocities, whatever the step; the largest force is looked at where a step is a twentieth of the
impact at most. With a step of 1e-2 s the balls move by more than their diameter in a step.
"""

from __future__ import annotations

import numpy as np

from references.closed_forms.impact import HertzImpact
from studies.hard_cases.case import Case, Finding
from warpffrf.model import laws, surfaces
from warpffrf.model.lumped_contact import LumpedContact
from warpffrf.model.material import Material
from warpffrf.model.scene import Scene
from warpffrf.output.result import Result

STEEL = Material(210e9, 0.3, 7800.0, name="steel")
RADIUS, SPEED, GAP = 0.01, 10.0, 2e-4  # m, m/s, m
MASS = STEEL.density * 4.0 / 3.0 * np.pi * RADIUS**3
IMPACT = HertzImpact(0.5 * RADIUS, 0.5 * STEEL.plane_strain_modulus, 0.5 * MASS, SPEED)
RESOLVED = 20.0  # steps in the impact


def build() -> Scene:
    """Two balls on the x axis."""
    scene = Scene()
    skins = []
    for name, side in (("left", -1.0), ("right", 1.0)):
        skin = surfaces.Sphere(radius=RADIUS, axis_point=(0.0, 0.0, 0.0))
        ball = scene.add_rigid_body(
            MASS, (0.4 * MASS * RADIUS**2,) * 3, name=name, position=(side * (RADIUS + 0.5 * GAP), 0.0, 0.0),
            velocity=(-0.5 * side * SPEED, 0.0, 0.0), surfaces={"skin": skin},
        )  # fmt: skip
        skins.append(ball["skin"])
    scene.add(LumpedContact(*skins, law=laws.HertzPoint(STEEL, STEEL), name="pair"))
    return scene


def check(result: Result) -> list[Finding]:
    """Velocities once the impact is over, momentum, and the largest force where steps resolve it."""
    velocity = [result.body(name).velocity[:, 0] for name in ("left", "right")]
    momentum = float(np.abs(velocity[0] + velocity[1]).max()) / SPEED
    found = [Finding("momentum", momentum, 1e-10, 1e-6)]
    step = result.history.step_size[1:].max()
    over = GAP / SPEED + IMPACT.duration
    if result.time[-1] > 1.2 * over:
        left = velocity[0][result.time > 1.2 * over][-1]
        found.append(Finding("restitution", abs(left / (-0.5 * SPEED) - 1.0), 2e-3, 2e-2))
        if step < IMPACT.duration / RESOLVED:
            force = float(result.lumped_contact("pair").normal_force.max())
            found.append(Finding("largest force", abs(force / IMPACT.force - 1.0), 1e-2, 5e-2))
    return found


CASE = Case(
    "impact at 10 m/s",
    "Steel balls meet at 10 m/s: steps from 1/270 of the impact to 370 impacts, in which they move by ten radii.",
    build, 1e-3, check, middle=1e-6, energies=(1e-5,), quick=True,
)  # fmt: skip
