r"""A roller bearing with clearance of 40.6 um (case P10): fourteen light rollers in pockets, ten of them in no contact.

The inner ring, 0.3 kg, falls under its load on rollers of 4 g that lie loose between the rings. Dampers in the pockets
and under the ring take the energy of the fall; then the rollers share the load as the equations of bearings have it,
solved roller by roller (`scenes.lumped_bearings`).
"""

from __future__ import annotations

import numpy as np

from scenes.lumped_bearings import roller_209
from studies.hard_cases.case import Case, Finding
from warpffrf.model import forces
from warpffrf.model.scene import Scene
from warpffrf.output.result import Result

SETTLED = 0.05  # s
RING, POCKET = 2e4, 50.0  # N s/m


def build() -> Scene:
    """The bearing of the published case with dampers."""
    scene = roller_209().scene()
    for joint in scene.joints:
        damping = RING if joint.name == "slide" else POCKET
        scene.add(forces.JointSpringDamper(joint, stiffness=0.0, damping=damping, name=f"damper of {joint.name}"))
    return scene


def check(result: Result) -> list[Finding]:
    """No pull at any time; at rest the load on each roller, over the largest."""
    bearing = roller_209()
    outer = [result.lumped_contact(f"out {i}") for i in range(bearing.count)]
    found = [Finding("pull", max(-float(c.normal_force.min()) for c in outer) / bearing.load, 0.0, 1e-9)]
    if result.time[-1] > SETTLED:
        _, wanted = bearing.solved()
        forces_there = np.array([c.normal_force[-1] for c in outer])
        found.append(
            Finding("roller loads at rest", float(np.abs(forces_there - wanted).max() / wanted.max()), 5e-3, 5e-2)
        )
    return found


CASE = Case(
    "bearing with clearance",
    "An inner ring falls under its load on fourteen light rollers that lie loose in their clearance.",
    build, 0.06, check, middle=1e-5, most_steps=6000,
)  # fmt: skip
