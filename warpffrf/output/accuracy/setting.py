"""Settings chosen for a run: its step, energy tolerance and treatment of local modes, and options of bodies and
contacts.

The user's scene is not modified: a run has its own copy, with the same reduced bodies.
"""

from __future__ import annotations

import copy
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from warpffrf.model.scene import Scene

INERTIA, STIFFENING = "inertia", "stiffening"  # of bodies
GRID, CELL_ERROR, KINEMATICS = "grid", "cell_error", "kinematics"  # of contacts
AUTO = "auto"  # chosen by the program
BODY_FIXED = "body_fixed"  # a grid


@dataclass(frozen=True)
class Setting:
    """`steps` of the whole run, treatment of `local_modes`, `options` {(option, name of body or contact): value}, and
    the `energy_tolerance` of impact steps; options not listed are those of the scene, no tolerance means the default.
    """

    steps: int
    local_modes: Any
    options: Mapping[tuple[str, str], Any] = field(default_factory=dict)
    energy_tolerance: float | None = None

    def scene(self, scene: Scene) -> Scene:
        """A copy of `scene` with the options."""
        shared = {id(body.reduced): body.reduced for body in scene.bodies if body.reduced is not None}
        found = copy.deepcopy(scene, shared)
        for (option, name), value in self.options.items():
            if option == INERTIA:
                found.body(name).level = value
            elif option == STIFFENING:
                found.body(name).stiffening = value
            else:
                setattr(found.contact(name), option, value)
        return found
