r"""Flanges of cylindrical roller bearings: ribs of the rings that stop rollers along the axis.

**The model.** A rib is a plane across the axis of its ring, without an end. The end of a roller is a sphere of the
radius `end_radius` about a point of the roller's axis, so that its middle stands at half the length: rollers are ground
so, or nearly flat with a large radius. Between both is a lumped contact. A roller that is skewed by the angle psi
touches off its middle, at the distance

    e = (end_radius - length/2) psi

from its axis in the plane of the rib, and both ends together have used up (end_radius - length/2) psi^2 of the axial
play c: ribs on both sides stop the skew at

    psi_max = sqrt(c/(end_radius - length/2)),

where the forces of the two ends make a moment about 2 e F that turns the roller back. What a real rib has beyond
that, its height (the place of the contact is not held to it), its opening angle, an undercut, and the edge of a flat
end, is left out, and loads of the two ribs act at the roller's axis, not at the height of the ribs: rollers do not tilt
under thrust.
"""

from __future__ import annotations

from dataclasses import KW_ONLY, dataclass
from typing import TYPE_CHECKING

from warpffrf.model import surfaces
from warpffrf.model.bearings.geometry import RollerRaceways
from warpffrf.model.bodies import SurfacePort
from warpffrf.model.errors import InputError, require_number
from warpffrf.model.friction import FrictionLike
from warpffrf.model.laws import HertzPoint
from warpffrf.model.laws.lumped import LumpedLaw
from warpffrf.model.lumped_contact import LumpedContact
from warpffrf.model.named_arguments import named_arguments

if TYPE_CHECKING:
    from warpffrf.model.bearings.bearing import Bearing
    from warpffrf.model.scene import Scene

ENDS = {"front": 1.0, "back": -1.0}  # towards the axis direction, and against it
RIBS = {"both": ("front", "back"), "front": ("front",), "back": ("back",), None: ()}
END_RADIUS = 20.0  # of half the length, where nothing is given: nearly flat


@named_arguments
@dataclass(frozen=True)
class Flanges:
    """Ribs that stop rollers along the axis, with the play `clearance` [m] between both, half of it to either side.

    outer, inner: which ribs the rings have, "both", "front" (towards the axis direction), "back" or None; NU bearings
    have outer="both", N ones inner="both", NJ ones outer="both" and inner="front". end_radius [m]: of the rollers'
    spherical ends, None for twenty times half the length. law: of the force, a lumped law, None for laws.HertzPoint of
    the materials; friction: at the ribs. Contacts are `bearing.contacts["flange_outer_front_3"]`. Raises `InputError`.
    """

    clearance: float
    _: KW_ONLY
    outer: str | None = "both"
    inner: str | None = None
    end_radius: float | None = None
    law: LumpedLaw | None = None
    friction: FrictionLike = 0.0

    def hold(self, scene: Scene, bearing: Bearing) -> None:
        """Add the ribs, the ends and their contacts to the scene and to `bearing`. Raises `InputError`."""
        label = f"bearing {bearing.name!r}: Flanges"
        play = require_number(self.clearance, f"{label}: clearance [m]", non_negative=True)
        if not isinstance(bearing.raceways, RollerRaceways):
            raise InputError(f"{label}: only roller bearings have flanges; the grooves of balls are their stops")
        half = 0.5 * bearing.raceways.length
        radius = END_RADIUS * half
        if self.end_radius is not None:
            radius = require_number(self.end_radius, f"{label}: end_radius [m]", positive=True)
        if radius <= half:
            raise InputError(
                f"{label}: end_radius {radius:g} m must exceed half the length of a roller, {half:g} m, or the ends "
                "are more than half a ball"
            )
        if any(element.reduced is not None for element in bearing.elements):
            raise InputError(f"{label}: ribs stop rigid rollers, these are flexible; leave flanges or element_body out")
        ribs = self._ribs(label)
        if not ribs:
            raise InputError(f"{label}: neither outer nor inner has a rib; leave flanges out")
        ends = {end: self._ends(bearing, end, radius, half) for end in {end for _, end in ribs}}
        law = HertzPoint(*bearing.materials) if self.law is None else self.law
        place = bearing.place
        for side, end in ribs:
            body, sign = getattr(bearing, side), ENDS[end]
            if body.reduced is not None:
                raise InputError(
                    f"{label}: the {side} ring, {body.name!r}, is flexible, and its ribs are no plane of it; name "
                    "ribs on the other ring, or add a LumpedContact with a rigid part"
                )
            at = place.center + sign * (half + 0.5 * play) * place.axis
            outward = body.to_user(at - sign * place.axis) - body.to_user(at)
            rib = surfaces.Plane(origin=body.to_user(at), outward=outward)
            port = body.surface(rib, name=f"{bearing.name} {side} {end} rib")
            for i, element_end in enumerate(ends[end], start=1):
                contact = LumpedContact(
                    element_end, port, law=law, friction=self.friction, name=f"{bearing.name} flange {side} {end} {i}"
                )
                bearing.contacts[f"flange_{side}_{end}_{i}"] = scene.add(contact)

    def _ribs(self, label: str) -> list[tuple[str, str]]:
        """Side and end of every rib."""
        for name, given in (("outer", self.outer), ("inner", self.inner)):
            if given not in RIBS:
                raise InputError(f"{label}: {name} must be 'both', 'front', 'back' or None, got {given!r}")
        return [("outer", end) for end in RIBS[self.outer]] + [("inner", end) for end in RIBS[self.inner]]

    @staticmethod
    def _ends(bearing: Bearing, end: str, radius: float, half: float) -> list[SurfacePort]:
        """Of every roller."""
        axis = bearing.place.axis
        shape = surfaces.Sphere(
            radius=radius, axis_point=ENDS[end] * (half - radius) * axis, axis_direction=bearing.place.axes[0]
        )
        return [element.surface(shape, name=f"{end} end") for element in bearing.elements]
