"""A whole bearing in a scene: what the builders return, and what results need to know of it."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np

from warpffrf.model import looks
from warpffrf.model.bearings.geometry import BallRaceways, RollerRaceways
from warpffrf.model.bearings.parts import SIDES, Place
from warpffrf.model.bodies import Body, Ground
from warpffrf.model.contact import Contact
from warpffrf.model.forces import PointForce
from warpffrf.model.joints import Drive, Joint
from warpffrf.model.lumped_contact import LumpedContact
from warpffrf.model.material import Material

ELEMENT_SURFACE = "skin"


@dataclass(eq=False, repr=False)
class Bearing(looks.Shown):
    """A bearing as `scene.add_ball_bearing` and `scene.add_roller_bearing` make it, of parts that are the scene's own
    and may be changed.

    kind: "ball" or "roller". elements: rigid bodies, "<name> ball 1" onwards, counter-clockwise about the axis.
    inner, outer: bodies of the rings, or the ground. contacts: by "inner_1", "outer_1", ... and of pockets; joints: by
    "pocket_1", "cage_axle"; forces: "preload_inner", "preload_outer". name: as given; element_surface: what the surface
    of each element is called. cage: its body, drive: of its speed, None without. raceways: the geometry; place: where
    it stands; materials: of the elements and of the rings; shoulders: heights [m] of the inner and the outer ring's
    shoulders over the bottom of the raceway, None where they are not known.
    """

    name: str
    kind: str
    raceways: BallRaceways | RollerRaceways
    place: Place
    materials: tuple[Material, Material]
    shoulders: tuple[float | None, float | None] = (None, None)
    elements: list[Body] = field(default_factory=list)
    inner: Body | Ground = field(default_factory=Ground)
    outer: Body | Ground = field(default_factory=Ground)
    cage: Body | None = None
    drive: Drive | None = None
    contacts: dict[str, LumpedContact | Contact] = field(default_factory=dict)
    joints: dict[str, Joint] = field(default_factory=dict)
    forces: dict[str, PointForce] = field(default_factory=dict)
    element_surface: str = ELEMENT_SURFACE

    def _facts(self) -> dict[str, Any]:
        return {
            "name": self.name, "kind": f"{self.raceways.count} {self.kind}s", "inner": self.inner.name,
            "outer": self.outer.name, "cage": None if self.cage is None else self.cage.name,
        }  # fmt: skip

    def orbit_speed(self, inner: float = 0.0, outer: float = 0.0) -> float:
        """Speed [rad/s] of elements and cage about the axis where they roll without slip on rings that turn with the
        speeds `inner` and `outer` [rad/s], at the free contact angle.

        With gamma = D cos(alpha)/d_pw: (inner (1 - gamma) + outer (1 + gamma))/2.
        """
        angle = self.raceways.free_angle if isinstance(self.raceways, BallRaceways) else 0.0
        gamma = self.raceways.diameter * np.cos(angle) / self.raceways.pitch_diameter
        return float(0.5 * (inner * (1.0 - gamma) + outer * (1.0 + gamma)))

    def describe(self) -> dict[str, Any]:
        """Plain data that results files keep, and results are told by."""
        return {
            "name": self.name, "kind": self.kind, "raceways": self.raceways.describe(),
            "center": self.place.center.tolist(), "axes": self.place.axes.tolist(),
            "moduli": [m.plane_strain_modulus for m in self.materials], "shoulders": list(self.shoulders),
            "elements": [element.name for element in self.elements], "inner": self.inner.name,
            "outer": self.outer.name, "poses": {ring.name: _pose(ring) for ring in (self.inner, self.outer)},
            "cage": None if self.cage is None else self.cage.name,
            "contacts": {key: contact.name for key, contact in self.contacts.items()},
            "joints": {key: joint.name for key, joint in self.joints.items()},
        }  # fmt: skip

    def contacts_of(self, side: str) -> list[LumpedContact | Contact]:
        """Those with the ring of a side, "inner" or "outer", in the order of the elements."""
        if side not in SIDES:
            raise ValueError(side)
        return [self.contacts[f"{side}_{i}"] for i in range(1, self.raceways.count + 1)]


def _pose(body: Body | Ground) -> dict[str, Any]:
    return {"position": body.position.tolist(), "rotation": body.rotation.tolist()}


def without_cage(bearings: list[Bearing]) -> str:
    """What to do about bearings whose elements nothing keeps apart, "" where there are none."""
    loose = [repr(bearing.name) for bearing in bearings if bearing.cage is None]
    if not loose:
        return ""
    return (
        f"bearing {', '.join(loose)} has no cage, and loads squeeze its elements out of their zone; give it "
        "cage=bearings.Spaced(), or hold the elements by joints"
    )
