r"""What elastic displacements are shown relative to: the user frames of the bodies, an interface, or their first poses.

A point X of a flexible body with the elastic displacement u is drawn, in the user frame at the saved step, at

    X + c + f (u - c),

with the magnification f and the rigid motion c(X) of the reference: zero for user frames, those of the reduction (mean
axes of a free body, an interface that carries them); the translation t and rotation theta of an interface at P, c = t +
theta x (X - P), which is then drawn where it is; and x_0 - X with the positions x_0 of the undeformed body at the first
saved step, in the user frame at the saved step, so that the whole motion since then is magnified.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from warpffrf.model.errors import unknown_name
from warpffrf.model.reduced.inertia import interface_motion
from warpffrf.output.geometry.places import Pose
from warpffrf.output.geometry.scene_view import BodyView

START = "start"


class Reference:
    """The reference `relative_to` of elastic displacements of the flexible ones of `bodies` with their `motions`: None,
    the name of an interface, for the bodies that have it, or `START`. Raises `InputError` naming `what` for another
    one."""

    def __init__(
        self, bodies: Mapping[str, BodyView], motions: Mapping[str, Any], relative_to: str | None, what: str
    ) -> None:
        self.bodies, self.motions, self.name = bodies, motions, relative_to
        known = dict.fromkeys(name for body in bodies.values() if body.reduced for name in body.reduced.interfaces)
        if relative_to is not None and relative_to not in (START, *known):
            raise unknown_name(f"{what}: relative_to", relative_to, (START, *known))
        self.of_start = relative_to == START and START not in known

    @property
    def words(self) -> str:
        """Text after "displacement", empty for user frames."""
        if self.name is None:
            return ""
        return " since the start" if self.of_start else f" relative to '{self.name}'"

    def motion(self, name: str, points: np.ndarray, i: int) -> np.ndarray:
        """Rigid motion (n, 3) [m, user axes] of the reference at points (n, 3) [m] of the body called `name` at saved
        step `i`."""
        body = self.bodies[name]
        if body.reduced is None or self.name is None:
            return np.zeros_like(points)
        if self.of_start:
            return Pose.of(self.motions, name, i).to_user(Pose.of(self.motions, name, 0).to_world(points)) - points
        if self.name not in body.reduced.interfaces:
            return np.zeros_like(points)
        moved = interface_motion(body, self.name, self.motions[name].modal[i])
        return moved[:3] + np.cross(moved[3:], points - body.reduced.interfaces[self.name].point)
