"""What the output needs to know of a scene: names, reduced bodies, which surfaces touch, and a hash to tell scenes
apart.

A live run takes it from the `Scene`; a results file stores it, so that pictures and derived quantities need no scene.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np

from warpffrf.output.anchors import Anchor, scene_anchors


@dataclass(frozen=True)
class BodyView:
    """One body: its name, its reduced body (None when rigid), mass [kg], centre of mass [m, user frame] and inertia
    about it [kg m2, user axes]; None in an older results file."""

    name: str
    reduced: Any
    mass: float
    center_of_mass: np.ndarray
    inertia: np.ndarray | None = None

    def surface(self, name: str) -> Any:
        """The body's contact surface called `name`."""
        return self.reduced.contact_surfaces[name]


@dataclass(frozen=True)
class PairView:
    """One contact pair: the two bodies and the names of the surfaces that touch."""

    name: str
    first_body: BodyView
    first_surface_name: str
    second_body: BodyView
    second_surface_name: str

    @property
    def first(self) -> Any:
        """ContactSurface of the first body; the pressure lives on its grid."""
        return self.first_body.surface(self.first_surface_name)

    @property
    def second(self) -> Any:
        """ContactSurface of the second body."""
        return self.second_body.surface(self.second_surface_name)


@dataclass(frozen=True)
class SceneView:
    """A scene as far as results and pictures need it; `content_hash` tells whether a run can be continued."""

    content_hash: str
    bodies: dict[str, BodyView] = field(default_factory=dict)
    pairs: dict[str, PairView] = field(default_factory=dict)
    joints: tuple[str, ...] = ()
    anchors: tuple[Anchor, ...] = ()


def scene_view(scene: Any) -> SceneView:
    """The view of a live `Scene`; a `SceneView` passes through."""
    if isinstance(scene, SceneView):
        return scene
    bodies = {
        body.name: BodyView(
            body.name, body.reduced, float(body.mass), np.asarray(body.center_of_mass, dtype=float),
            np.asarray(body.inertia, dtype=float),
        )
        for body in scene.bodies
    }  # fmt: skip
    pairs = {}
    for contact in scene.contacts:
        a, b = contact.a, contact.b
        pairs[contact.name] = PairView(contact.name, bodies[a.body.name], a.name, bodies[b.body.name], b.name)
    joints = tuple(joint.name for joint in scene.joints)
    return SceneView(scene.content_hash(), bodies, pairs, joints, scene_anchors(scene))
