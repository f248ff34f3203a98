r"""Flanges of roller bearings: ribs of the rings that stop rollers along their axes.

**The model.** The end of a roller is a sphere of the radius R_s = `end_radius` about a point of the roller's axis,
whose middle lies at half the length l: rollers are ground in this way, or nearly flat with a large radius. A rib's face
leans back by the opening angle beta, a cone about the axis of its ring; between both is a lumped contact. For an
aligned roller they touch along the common normal, at R_s sin(beta) from the roller's axis towards the ring that has the
rib: of a roller of the diameter D

    h = D/2 - R_s sin(beta),      beta = arcsin((D/2 - h)/R_s)

over the raceway, the `height`. Forces on ends pass through the centres of their spheres, R_s - l/2 beyond the middle of
the roller: thrust F of a roller that an inner rib pushes against an outer one is a couple about the direction around, 2
(R_s - l/2) F sin(beta - theta)/cos(beta) of a roller tilted by theta, which its laminae carry (T. A. Harris, Rolling
Bearing Analysis, on roller bearings under thrust). The play c is that along the axis, c cos(beta) along the normals.
Without a height the ribs are planes, touched at the roller's axis, and rollers do not tilt under thrust. Faces for
inclined rollers follow in the same way in the axial section: they are normal to the common normal where ends touch.

A roller that is skewed by the angle psi touches off its middle, at the distance

    e = (R_s - l/2) psi

from its axis in the plane of a rib, and both ends together reduce the play by (R_s - l/2) psi^2: ribs on both
sides stop the skew at

    psi_max = sqrt(c/(R_s - l/2)),

where the forces of the two ends form a moment about 2 e F that realigns the roller. A rib has no end (the position
of the contact is not limited to a real rib); an undercut, and the edge of a flat end, are neglected.
"""

from __future__ import annotations

from dataclasses import KW_ONLY, dataclass
from typing import TYPE_CHECKING

import numpy as np

from warpffrf.model import surfaces
from warpffrf.model.bearings.geometry import RollerGeometry, Track
from warpffrf.model.bodies import Body, Ground, SurfacePort
from warpffrf.model.errors import InputError, require_number
from warpffrf.model.friction import FrictionLike
from warpffrf.model.laws import HertzPoint
from warpffrf.model.laws.lumped import LumpedLaw
from warpffrf.model.lumped_contact import LumpedContact
from warpffrf.model.messages.named_arguments import named_arguments
from warpffrf.model.surfaces.round import FLATTEST, STEEPEST

if TYPE_CHECKING:
    from warpffrf.model.bearings.bearing import Bearing
    from warpffrf.model.scene import Scene

ENDS = {"front": 1.0, "back": -1.0}  # towards the axis direction, and opposite
RIBS = {"both": ("front", "back"), "front": ("front",), "back": ("back",), None: ()}
END_RADIUS = 20.0  # of half the length, where nothing is given: nearly flat


@named_arguments
@dataclass(frozen=True)
class Flanges:
    """Ribs that stop rollers along the axis, with the play `clearance` [m] between both, half of it to either side.

    outer, inner: which ribs the rings have, "both", "front" (towards the axis direction), "back" or None, mirrored in a
    second row; NU bearings have outer="both", N ones inner="both", NJ ones outer="both" and inner="front", tapered ones
    of a positive contact angle outer=None and inner="back", at the rollers' large ends. end_radius [m]: of the rollers'
    spherical ends, None for twenty times half the length. height [m]: over the raceway, where ends meet the ribs, whose
    faces lean back accordingly, so that thrust tilts rollers; None for flat ribs, met at the rollers' axes. law: of the
    force, a lumped law, None for laws.HertzPoint of the materials; friction: at the ribs. Contacts are
    `bearing.contacts["flange_outer_front_3"]`. Raises `InputError`.
    """

    clearance: float
    _: KW_ONLY
    outer: str | None = "both"
    inner: str | None = None
    end_radius: float | None = None
    height: float | None = None
    law: LumpedLaw | None = None
    friction: FrictionLike = 0.0

    def hold(self, scene: Scene, bearing: Bearing) -> None:
        """Add the ribs, the ends and their contacts to the scene and to `bearing`. Raises `InputError`."""
        label = f"bearing {bearing.name!r}: Flanges"
        play = require_number(self.clearance, f"{label}: clearance [m]", non_negative=True)
        if not isinstance(bearing.geometry, RollerGeometry):
            raise InputError(f"{label}: only roller bearings have flanges; balls are guided by their grooves")
        half = 0.5 * bearing.geometry.roller_length
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
        lever = self._lever(label, 0.5 * bearing.geometry.diameter, radius)
        ribs = self._ribs(label)
        if not ribs:
            raise InputError(f"{label}: neither outer nor inner has a rib; leave flanges out")
        ends = {end: self._ends(bearing, end, radius, half) for end in {end for _, end in ribs}}
        law = HertzPoint(*bearing.materials) if self.law is None else self.law
        geometry = bearing.geometry
        for side, end in ribs:
            body = getattr(bearing, side)
            if body.reduced is not None:
                raise InputError(
                    f"{label}: the {side} ring, {body.name!r}, is flexible, and its ribs are no plane of it; name "
                    "ribs on the other ring, or add a LumpedContact with a rigid part"
                )
            for row, track in enumerate(geometry.tracks):
                face = self._face(bearing, side, body, track, ENDS[end] * track.sense, half + 0.5 * play, radius, lever)
                named = f"{bearing.name} {side} {end} rib" + (f" {row + 1}" if row else "")
                port = body.surface(face, name=named)
                for i in range(row * geometry.elements + 1, (row + 1) * geometry.elements + 1):
                    contact = LumpedContact(
                        ends[end][i - 1], port, law=law, friction=self.friction,
                        name=f"{bearing.name} flange {side} {end} {i}",
                    )  # fmt: skip
                    bearing.contacts[f"flange_{side}_{end}_{i}"] = scene.add(contact)

    def _lever(self, label: str, half_diameter: float, radius: float) -> float:
        """Distance [m] from the roller's axis at which ends of the radius [m] touch the ribs."""
        if self.height is None:
            return 0.0
        height = require_number(self.height, f"{label}: height [m]", non_negative=True)
        if height >= half_diameter:
            raise InputError(
                f"{label}: height {height:g} m over the raceway is beyond the axis of the rollers, whose radius is "
                f"{half_diameter:g} m; ribs reach to some tenths of that"
            )
        lever = half_diameter - height
        least, most = np.cos(FLATTEST) * radius, np.cos(STEEPEST) * radius
        if not least < lever < most:
            raise InputError(
                f"{label}: ends of the radius {radius:g} m meet ribs {lever:g} m from the roller's axis where these "
                f"are inclined by {np.degrees(np.arcsin(min(lever / radius, 1.0))):.3g} degrees; usual are 0.01 to 10 "
                f"degrees; choose an end_radius between {lever / np.cos(STEEPEST):.3g} and "
                f"{lever / np.cos(FLATTEST):.3g} m"
            )
        return lever

    @staticmethod
    def _face(
        bearing: Bearing, side: str, body: Body | Ground, track: Track, sign: float, apex: float, radius: float,
        lever: float,
    ) -> surfaces.Shape:  # fmt: skip
        """Face of a rib of the row `track`, user frame of `body`: of ends of the radius whose apex lies `apex` [m] from
        the rollers' middle along their axes times `sign`, and that meet it `lever` [m] off these axes."""
        geometry = bearing.geometry
        assert isinstance(geometry, RollerGeometry)
        along = sign * np.array(geometry.axis(track))  # radial and axial component
        across = np.array([along[1], -along[0]]) * sign * (1.0 if side == "outer" else -1.0)
        lean = np.arcsin(lever / radius)
        normal = np.cos(lean) * along + np.sin(lean) * across  # into the rib
        middle = np.array([0.5 * geometry.pitch_diameter, track.z])
        at = middle + (apex - radius) * along + radius * normal
        where = bearing.place.in_user(body, float(at[1]))
        if abs(normal[0]) < np.cos(FLATTEST):
            outward = -np.sign(normal[1]) * np.asarray(where["axis_direction"])
            return surfaces.Plane(origin=where["axis_point"], outward=outward)
        kind = surfaces.Cone if normal[0] < 0.0 else surfaces.ConicalBore
        return kind(radius=float(at[0]), half_angle=float(np.arctan(-normal[1] / normal[0])), **where)

    def _ribs(self, label: str) -> list[tuple[str, str]]:
        """Side and end of every rib."""
        for name, given in (("outer", self.outer), ("inner", self.inner)):
            if given not in RIBS:
                raise InputError(f"{label}: {name} must be 'both', 'front', 'back' or None, got {given!r}")
        return [("outer", end) for end in RIBS[self.outer]] + [("inner", end) for end in RIBS[self.inner]]

    @staticmethod
    def _ends(bearing: Bearing, end: str, radius: float, half: float) -> list[SurfacePort]:
        """Of every roller."""
        found = []
        for element, (angle, track) in zip(bearing.elements, bearing.geometry.places, strict=True):
            middle = ENDS[end] * track.sense * (half - radius) * bearing.element_axis(angle, track)
            shape = surfaces.Sphere(radius=radius, axis_point=middle, axis_direction=bearing.place.around(angle))
            found.append(element.surface(shape, name=f"{end} end"))
        return found
