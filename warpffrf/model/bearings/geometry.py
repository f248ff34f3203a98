r"""The geometry of rolling bearings: positions of raceways and elements, and checks of the dimensions.

**Ball bearing.** Balls of diameter D lie on the pitch circle of diameter d_pw; the grooves of the rings have the radii
r_i and r_e across, f_i = r_i/D and f_e = r_e/D are their osculations. A ball touches both rings where their groove
centres lie

    A = r_i + r_e - D

apart. With the free contact angle alpha_0 and the diametral clearance s of a bearing whose grooves are opposite each
other, the circles of the groove centres have the radii and axial positions

    R_i = d_pw/2 + (r_i - D/2) cos alpha_0 - s/4,      z_i = +(r_i - D/2) sin alpha_0,
    R_e = d_pw/2 - (r_e - D/2) cos alpha_0 + s/4,      z_e = -(r_e - D/2) sin alpha_0,

so that the bottoms of the grooves have the radii R_i - r_i and R_e + r_e. Either alpha_0 is given and s is 0, the balls
then just touch both rings; or alpha_0 is 0 and s is given, negative for an interference. Both describe rings that have
grown towards each other, s = -2 u of an inner ring that is warmer or rotates fast and has grown by u in radius. The
free contact angle under thrust is arccos(cos alpha_0 - s/(2 A)). Thrust on the inner ring along the axis presses the
bearing together where alpha_0 is positive.

A four-point bearing has two arcs on each ring, those of contact angles +alpha_0 and -alpha_0, which meet in the middle.
Thrust ball bearings have alpha_0 = pi/2: the grooves of their washers have their centres on the pitch circle.

**Roller bearing.** Rollers of the diameter D at their middle lie on the pitch circle, inclined by tau to the axis in
the plane through it: their axes are a = cos tau e_a - sin tau e_r, and they touch the raceways at +-D/2 m from their
middle, m = cos tau e_r + sin tau e_a. Rollers whose radius falls along a by tan nu are tapered; raceways are straight,
inclined by tau - nu (inner) and tau + nu (outer), so that the contact angle of the outer raceway is

    alpha = tau + nu,        tan nu = D sin(tau)/d_pw

where all axes meet in one point of the bearing's axis and rollers roll without slip along their whole length (Harris).
Special cases are cylindrical rollers, tau = nu = 0, with raceways of the radii (d_pw -+ D)/2 -+ s/4, and cylindrical
rollers between the washers of a thrust bearing, tau = pi/2, nu = 0. Raceways that are circles in the axial section, of
barrel-shaped rollers, have centres as the grooves of balls, alpha = tau: an outer raceway of the radius r_e = (D +
d_pw/cos alpha)/2 is a sphere about the bearing's centre, where the rows are d_pw tan alpha apart.

**Rows.** The contact angle of the second row of a double-row bearing is the opposite one. Rows are at -+b/2 along the
axis, b = `row_spacing`: a positive contact angle is a back-to-back arrangement, a negative one face-to-face.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.optimize import brentq

from warpffrf.model import surfaces
from warpffrf.model.bearings import rating
from warpffrf.model.errors import InputError, require_array, require_count, require_number
from warpffrf.model.messages.named_arguments import named_arguments
from warpffrf.model.surfaces import Shape
from warpffrf.model.surfaces.form_deviations import Form

SIDES = ("inner", "outer")
STEEPEST = np.radians(80.0)  # contact angle up to which a groove that is open to the side carries; others are washers
LARGEST_OSCULATION = 20.0  # groove radius over ball diameter, of a self-aligning outer ring; larger is no ratio
LARGEST_DEVIATION = 1e-2  # of the diameter: beyond, it is the diameter itself
FLAT = 0.5 * np.pi + 1e-9  # contact angle [rad] of a thrust bearing, with round-off
THRUST = np.radians(89.9)  # a raceway that is steeper is a plane
CENTRED = 1e-9  # of the pitch diameter: round-off of an outer raceway whose centre is on the axis
OSCULATION = 0.52  # of groove radius over ball diameter, where nothing is given: a deep-groove bearing's
BALL_WIDTH, ROLLER_OVERHANG = 1.5, 0.4  # of the diameter of an element
PLAIN = (int, float, tuple, type(None))  # of the values that results need


def pair(value: Any, name: str, order: str = "(inner, outer)") -> tuple[Any, Any]:
    """Two values in this `order`, of one for both or of two. Raises `InputError` for another number of them."""
    both = value if isinstance(value, (tuple, list)) else (value, value)
    if len(both) != 2:
        raise InputError(f"{name} is one value, or two, {order}, got {len(both)}")
    return both[0], both[1]


@dataclass(frozen=True)
class Track:
    """Raceways of a row of contacts: axial position z [m] of the row's middle from the bearing's, and the sense [-] of
    its contact angle, 1 or -1."""

    z: float
    sense: float


class Geometry(ABC):
    """Common base of ball and roller bearings, whose dimensions are fields; see `BallGeometry`."""

    elements: int
    pitch_diameter: float
    contact_angle: float
    clearance: float
    rows: int
    row_spacing: float
    diameter_deviations: Any
    width: float | None
    bore: float | None
    outside_diameter: float | None

    @property
    def label(self) -> str:
        """For messages."""
        return type(self).__name__

    @property
    @abstractmethod
    def diameter(self) -> float:
        """D [m], of an element."""

    @property
    @abstractmethod
    def default_width(self) -> float:
        """Width [m] of rings for which none is given."""

    @property
    def inclination(self) -> float:
        """tau [rad]: of the line between both contacts of an element from the radial direction, of the first row."""
        return self.contact_angle

    @property
    def tracks(self) -> tuple[Track, ...]:
        """The rows of contacts, those of the first row of elements first."""
        if self.rows == 1:
            return (Track(0.0, 1.0),)
        return Track(-0.5 * self.row_spacing, 1.0), Track(0.5 * self.row_spacing, -1.0)

    @property
    def places(self) -> list[tuple[float, Track]]:
        """Angle [rad] about the axis and row of each element."""
        return [(float(angle), track) for track in self.tracks[: self.rows] for angle in self.angles]

    @property
    def contacts(self) -> list[tuple[int, int]]:
        """Element and track of each contact with a ring, by number: columns of results."""
        shared = len(self.tracks) > self.rows  # by the same elements
        return [
            (i + (0 if shared else row * self.elements), row)
            for row in range(len(self.tracks))
            for i in range(self.elements)
        ]

    def _check(self, *lengths: str) -> None:
        """lengths: names of the fields that are positive."""
        self._keep("elements", require_count(self.elements, f"{self.label}: elements", 2))
        for name in (*lengths, "pitch_diameter"):
            self._keep(name, require_number(getattr(self, name), f"{self.label}: {name} [m]", positive=True))
        self._keep("clearance", require_number(self.clearance, f"{self.label}: clearance [m]"))
        self._keep("contact_angle", require_number(self.contact_angle, f"{self.label}: contact_angle [rad]"))
        self._keep("rows", require_count(self.rows, f"{self.label}: rows", 1))
        self._keep("row_spacing", require_number(self.row_spacing, f"{self.label}: row_spacing [m]", non_negative=True))
        if self.rows > 2 or (self.rows == 2) != (self.row_spacing > 0.0):
            raise InputError(
                f"{self.label}: a double-row bearing has rows=2 and their distance row_spacing [m], a single-row one "
                f"neither; got rows={self.rows} and row_spacing={self.row_spacing:g} m"
            )
        if self.width is not None:
            self._keep("width", require_number(self.width, f"{self.label}: width [m]", positive=True))
        if self.diameter_deviations is not None:
            self._keep("diameter_deviations", self._checked_deviations())
        D, pitch = self.diameter, self.pitch_diameter
        if D >= 0.5 * pitch:
            raise InputError(
                f"{self.label}: elements of diameter {D:g} m leave no inner ring on a pitch circle of {pitch:g} m; the "
                "pitch diameter is that of the circle through their centres, and at least twice theirs"
            )
        apart = self.apart
        if apart < D:
            most = int(np.pi / np.arcsin(D / pitch))
            raise InputError(
                f"{self.label}: {self.elements} elements of diameter {D:g} m overlap on a pitch circle of {pitch:g} m, "
                f"where their centres are {apart:.4g} m apart; use at most {most} elements, smaller ones, or a larger "
                f"pitch diameter, {D / np.sin(np.pi / self.elements):.4g} m or more"
            )

    def _check_rows(self, least: float) -> None:
        """Raises `InputError` for rows that are less than `least` [m] apart."""
        if self.rows == 2 and self.row_spacing < least:
            raise InputError(
                f"{self.label}: the elements of two rows that are {self.row_spacing:g} m apart overlap; row_spacing "
                f"must be {least:.4g} m or more"
            )

    def _checked_deviations(self) -> tuple[float, ...]:
        found = require_array(
            self.diameter_deviations, f"{self.label}: diameter_deviations [m]", (self.rows * self.elements,)
        )
        most = LARGEST_DEVIATION * self.diameter
        if np.max(np.abs(found)) > most:
            raise InputError(
                f"{self.label}: diameter_deviations are what the elements differ by from their diameter, some "
                f"micrometres, got {found[np.argmax(np.abs(found))]:g} m, more than {most:.3g} m"
            )
        return tuple(found.tolist())

    @property
    def diameters(self) -> np.ndarray:
        """(rows * elements,) m, of the elements with their deviations."""
        excess = (
            np.zeros(self.rows * self.elements)
            if self.diameter_deviations is None
            else np.array(self.diameter_deviations)
        )
        return self.diameter + excess

    @property
    def angles(self) -> np.ndarray:
        """(elements,) rad, of the elements of a row about the axis, from the first one."""
        return 2.0 * np.pi * np.arange(self.elements) / self.elements

    @property
    @abstractmethod
    def dynamic_rating(self) -> float:
        """Basic dynamic load rating [N] of ISO 281, radial up to a contact angle of 45 degrees, axial beyond
        (`warpffrf.model.bearings.rating`)."""

    @property
    @abstractmethod
    def static_rating(self) -> float:
        """Basic static load rating [N] of ISO 76, in the same direction."""

    @abstractmethod
    def load_factors(self, radial: float, axial: float) -> tuple[float, float]:
        """X and Y [-] of ISO 281 in the equivalent load X F_r + Y F_a under the forces `radial` and `axial` [N]."""

    @property
    def apart(self) -> float:
        """Distance [m] of the centres of neighbours."""
        return self.pitch_diameter * float(np.sin(np.pi / self.elements))

    @abstractmethod
    def arc_radius(self, side: str) -> float | None:
        """Radius [m] of a raceway in the axial section, side "inner" or "outer", None for a straight one."""

    @property
    def self_aligning(self) -> bool:
        """Whether the outer raceway is a sphere about a point of the axis."""
        radius = self.arc_radius("outer")
        across = np.inf if radius is None else (radius - 0.5 * self.diameter) * np.cos(self.contact_angle)
        return bool(abs(0.5 * self.pitch_diameter - across) < CENTRED * self.pitch_diameter)

    def play(self, side: str) -> float:
        """Distance [m] by which the raceway of a side, "inner" or "outer", lies away from elements in their middle: a
        quarter of the diametral clearance each, half of it the inner one where the outer is a sphere, which stays
        one."""
        return self.clearance * ((0.5 if side == "inner" else 0.0) if self.self_aligning else 0.25)

    def arc_centre(self, side: str, track: Track) -> tuple[float, float]:
        """Radius and axial position [m] of the circle of centres of the raceway of a side, "inner" or "outer", and a
        track, which is an arc in the axial section."""
        radius = self.arc_radius(side)
        assert radius is not None
        sign, beyond = (1.0 if side == "inner" else -1.0), radius - 0.5 * self.diameter
        across = sign * (beyond * np.cos(self.contact_angle) - self.play(side))
        along = sign * track.sense * beyond * np.sin(self.contact_angle)
        return float(0.5 * self.pitch_diameter + across), float(track.z + along)

    def raceway(self, side: str, track: Track, where: Callable[[float], dict[str, Any]]) -> Shape:
        """The surface of the raceway of a side, "inner" or "outer", and a track; where: axis_point and axis_direction
        from the position [m] along the axis."""
        radius, (across, along) = self.arc_radius(side), self.arc_centre(side, track)
        assert radius is not None
        if side == "inner":
            return surfaces.Groove(radius=across - radius, groove_radius=radius, **where(along))
        return surfaces.Ring(radius=across + radius, groove_radius=radius, **where(along))

    def describe(self) -> dict[str, Any]:
        """Plain data, from which `from_description` restores it; without form deviations and tables of profiles."""
        plain = {name: value for name, value in vars(self).items() if isinstance(value, PLAIN)}
        if not isinstance(plain.get("profile"), (int, float)):
            plain.pop("profile", None)
        return {"type": type(self).__name__, **plain}

    def _keep(self, name: str, value: Any) -> None:
        object.__setattr__(self, name, value)


@named_arguments
@dataclass(frozen=True, kw_only=True)
class BallGeometry(Geometry):
    """Geometry of a ball bearing, see the module.

    elements: number of balls; ball_diameter, pitch_diameter [m]. osculation: groove radius over ball diameter, above
    0.5, one number or (inner, outer). contact_angle [rad], at which the balls just touch both rings, positive where
    thrust on the inner ring along the axis presses the bearing together, pi/2 of a thrust bearing; or clearance [m],
    diametral, negative for an interference, a radial preload or growth of rings, also with a contact angle. rows,
    row_spacing [m]: 2 and the distance of the rows of a double-row bearing, of which the first has the contact angle
    and the second the opposite one. four_point: whether balls of one row touch two arcs on either ring, at the contact
    angle and at the opposite one. shoulders [m]: height over the bottom of the groove, one or (inner, outer), from
    which results compute the truncated fraction of a patch.

    inner_form, outer_form: form deviation of a rigid raceway around its axis, of `warpffrf.films`, positive where
    material is missing, angles from the first ball: films.LobedForm(5e-6, 2) is oval. diameter_deviations (elements,)
    [m]: excess diameter of each ball. width, bore, outside_diameter [m]: boundary dimensions, for the masses of rings
    that the builder makes; None: those of the medium series.

    Raises `InputError` for elements that overlap or that reach to the axis, grooves as narrow as the balls, contact
    angles at which a groove cannot carry, a clearance larger than grooves and balls permit, and where both angle and
    positive clearance are given.
    """

    elements: int
    ball_diameter: float
    pitch_diameter: float
    osculation: float | tuple[float, float] = OSCULATION
    contact_angle: float = 0.0
    clearance: float = 0.0
    rows: int = 1
    row_spacing: float = 0.0
    four_point: bool = False
    shoulders: float | tuple[float | None, float | None] | None = None
    inner_form: Form | None = None
    outer_form: Form | None = None
    diameter_deviations: Any = None
    width: float | None = None
    bore: float | None = None
    outside_diameter: float | None = None

    def __post_init__(self) -> None:
        self._check("ball_diameter")
        self._check_rows(self.ball_diameter)
        given = pair(self.osculation, f"{self.label}: osculation")
        ratios = tuple(require_number(f, f"{self.label}: osculation", positive=True) for f in given)
        self._keep("osculation", ratios)
        for side, ratio in zip(SIDES, ratios, strict=True):
            if not 0.5 < ratio <= LARGEST_OSCULATION:
                raise InputError(
                    f"{self.label}: the osculation of the {side} ring, groove radius over ball diameter, must be above "
                    f"0.5, a groove that is wider than the ball, and is hardly above 0.6, got {ratio:g}"
                )
        name = f"{self.label}: shoulders [m]"
        heights = pair(self.shoulders, name)
        self._keep("shoulders", tuple(None if h is None else require_number(h, name, positive=True) for h in heights))
        if self.four_point and (self.rows != 1 or not self.contact_angle > 0.0):
            raise InputError(
                f"{self.label}: a four-point bearing has one row and a positive contact angle, of both arcs, got "
                f"rows={self.rows} and contact_angle={self.contact_angle:g} rad; 0.6 rad (35 degrees) is usual"
            )
        if not (abs(self.contact_angle) <= STEEPEST or THRUST < abs(self.contact_angle) <= FLAT):
            raise InputError(
                f"{self.label}: contact_angle must lie between -{STEEPEST:.3g} and {STEEPEST:.3g} rad, or be pi/2 of a "
                f"thrust bearing, got {self.contact_angle:g}; angles are in radians, np.radians(40) is 0.698"
            )
        if self.contact_angle and self.clearance > 0.0:
            same = 2.0 * self.reach * (1.0 - np.cos(self.contact_angle))
            raise InputError(
                f"{self.label}: give the contact angle, at which the balls just touch both rings, or the diametral "
                f"clearance, not both; a clearance of {same:.3g} m has this angle under thrust"
            )
        if self.clearance >= 2.0 * self.reach:
            raise InputError(
                f"{self.label}: a clearance of {self.clearance:g} m is beyond the geometry: grooves and balls leave 2 "
                f"(r_i + r_e - D) = {2.0 * self.reach:.4g} m, beyond that the rings pass over the balls; use less "
                "clearance, or wider grooves"
            )
        if -self.clearance >= self.diameter:
            raise InputError(f"{self.label}: an interference of {-self.clearance:g} m is more than a whole ball")

    @property
    def diameter(self) -> float:
        return self.ball_diameter

    @property
    def default_width(self) -> float:
        return BALL_WIDTH * self.ball_diameter

    @property
    def dynamic_rating(self) -> float:
        return rating.ball_dynamic(*self._rated, self.osculation, self.rows)  # pyright: ignore[reportArgumentType]

    @property
    def static_rating(self) -> float:
        return rating.ball_static(*self._rated, self.osculation, self.rows)  # pyright: ignore[reportArgumentType]

    def load_factors(self, radial: float, axial: float) -> tuple[float, float]:
        if self.rows == 2 and self.contact_angle:
            return rating.double_row_load_factors(self.contact_angle, radial, axial, self.self_aligning)
        return rating.ball_load_factors(self.rows * self.elements, self.diameter, self.contact_angle, radial, axial)

    @property
    def _rated(self) -> tuple[int, float, float, float]:
        return self.elements, self.diameter, self.pitch_diameter, self.contact_angle

    @property
    def reach(self) -> float:
        """A [m]: distance of the groove centres where the balls touch both rings."""
        return self.groove("inner") + self.groove("outer") - self.diameter

    @property
    def free_angle(self) -> float:
        """Free contact angle [rad]: that of the balls under thrust, before any deformation."""
        if not self.clearance:
            return self.contact_angle
        cosine = np.cos(self.contact_angle) - self.clearance / (2.0 * self.reach)
        return float(np.copysign(np.arccos(min(cosine, 1.0)), self.contact_angle))

    @property
    def tracks(self) -> tuple[Track, ...]:
        return (Track(0.0, 1.0), Track(0.0, -1.0)) if self.four_point else super().tracks

    @property
    def washers(self) -> bool:
        """Whether the rings are those of a thrust bearing, whose grooves have their bottom at 90 degrees."""
        return abs(self.contact_angle) > THRUST

    def groove(self, side: str) -> float:
        """Groove radius [m], side "inner" or "outer"."""
        return self.osculation[SIDES.index(side)] * self.diameter  # pyright: ignore[reportIndexIssue]

    def arc_radius(self, side: str) -> float:
        return self.groove(side)

    def bottom(self, side: str) -> float:
        """Radius [m] of the bottom of the groove, side "inner" or "outer"."""
        sign = -1.0 if side == "inner" else 1.0
        return self.arc_centre(side, self.tracks[0])[0] + sign * self.groove(side)

    def curvatures(self, side: str, angle: Any) -> tuple[np.ndarray, np.ndarray]:
        """Relative curvatures (...) [1/m] of ball and raceway, side "inner" or "outer", across and along the groove,
        where they touch at the contact angle (...) [rad]: 2/D - 1/r, and 2/D +- cos(angle)/(R_c -+ r cos(angle)), R_c
        the radius of the groove centres."""
        sign = 1.0 if side == "inner" else -1.0
        c = np.cos(np.asarray(angle, dtype=float))
        around = sign * c / (self.arc_centre(side, self.tracks[0])[0] - sign * self.groove(side) * c)
        across = np.full(c.shape, 2.0 / self.diameter - 1.0 / self.groove(side))
        return across, 2.0 / self.diameter + around


@named_arguments
@dataclass(frozen=True, kw_only=True)
class RollerGeometry(Geometry):
    """Geometry of a roller bearing: cylindrical, needle, tapered, spherical, toroidal or thrust, see the module.

    elements: number of rollers of a row; roller_diameter [m]: in the middle; pitch_diameter [m]; roller_length [m]: the
    effective one. contact_angle [rad]: of the outer raceway, pi/2 of a thrust bearing. taper [rad]: half the angle
    between opposite sides of a roller, None for that of rolling without slip of tapered rollers, 0 where raceways are
    cylinders, planes or arcs. raceway_radii [m]: of the raceways in the axial section, one or (inner, outer), of
    barrel-shaped rollers; None for straight ones. clearance [m]: diametral, negative for an interference.
    rows, row_spacing [m]: as of `BallGeometry`; of a spherical roller bearing the contact angle is negative.
    profile: of the rollers in addition to that of the contact law: the crown radius [m], a table (z, drop), two arrays
    (n,) [m] from the middle, as of `surfaces.ProfiledCylinder`, or None for straight ones. inner_form, outer_form,
    diameter_deviations (rows * elements,) [m], width, bore and outside_diameter [m] as of `BallGeometry`.

    Raises `InputError` for elements that overlap or that reach to the axis, a clearance beyond the size of the rollers,
    and profiles and raceways that do not fit each other.
    """

    elements: int
    roller_diameter: float
    roller_length: float
    pitch_diameter: float
    contact_angle: float = 0.0
    taper: float | None = None
    raceway_radii: float | tuple[float, float] | None = None
    clearance: float = 0.0
    rows: int = 1
    row_spacing: float = 0.0
    profile: float | Any | None = None
    inner_form: Form | None = None
    outer_form: Form | None = None
    diameter_deviations: Any = None
    width: float | None = None
    bore: float | None = None
    outside_diameter: float | None = None

    def __post_init__(self) -> None:
        self._check("roller_diameter", "roller_length")
        if abs(self.clearance) >= self.diameter:
            raise InputError(
                f"{self.label}: a clearance of {self.clearance:g} m is beyond the geometry, whose rollers are "
                f"{self.diameter:g} m thick; it is the play of a ring across the bearing, some hundredths of a mm"
            )
        if abs(self.contact_angle) > FLAT:
            raise InputError(
                f"{self.label}: contact_angle must lie between -pi/2 and pi/2 rad, that of a thrust bearing, got "
                f"{self.contact_angle:g}; angles are in radians, np.radians(15) is 0.262"
            )
        if self.raceway_radii is not None:
            self._check_arcs()
        sides = self.raceway_radii is not None or not THRUST > abs(self.contact_angle) > 0.0
        if self.taper is None:
            self._keep("taper", 0.0 if sides else self._rolling_taper())
        self._keep("taper", require_number(self.taper, f"{self.label}: taper [rad]", non_negative=True))
        if self.taper and self.profile is not None:
            raise InputError(
                f"{self.label}: tapered rollers have the profile of their contact law; leave profile out, or give "
                "contact=bearings.RollingContact(law=...)"
            )
        if self.taper and (self.raceway_radii is not None or self.taper >= abs(self.contact_angle)):
            raise InputError(
                f"{self.label}: a taper of {self.taper:g} rad, half the angle of a roller, must be below the contact "
                f"angle of the outer raceway, {abs(self.contact_angle):g} rad, and raceways straight"
            )

        tau = abs(self.inclination)
        self._check_rows(float(self.roller_length * np.cos(tau) + self.diameter * np.sin(tau)))

    def _check_arcs(self) -> None:
        name = f"{self.label}: raceway_radii [m]"
        radii = tuple(require_number(r, name, positive=True) for r in pair(self.raceway_radii, name))
        self._keep("raceway_radii", radii)
        if not isinstance(self.profile, (int, float)) or not 0.0 < self.profile <= min(radii):
            raise InputError(
                f"{self.label}: raceways that are arcs of radii {radii[0]:g} and {radii[1]:g} m need barrel-shaped "
                f"rollers: profile, their crown radius [m], somewhat smaller than both, got {self.profile!r}"
            )
        if self.arc_centre("inner", self.tracks[0])[0] <= radii[0]:
            raise InputError(
                f"{self.label}: an inner raceway of the radius {radii[0]:g} m in the axial section reaches the axis of "
                "the bearing at this contact angle; use a smaller radius"
            )

    def _rolling_taper(self) -> float:
        """nu [rad] with tan nu = D sin(alpha - nu)/d_pw, of rollers whose axes meet the raceways' on the bearing's."""
        alpha, ratio = abs(self.contact_angle), self.diameter / self.pitch_diameter
        root: Any = brentq(lambda nu: np.tan(nu) - ratio * np.sin(alpha - nu), 0.0, alpha)
        return float(root)

    @property
    def diameter(self) -> float:
        return self.roller_diameter

    @property
    def default_width(self) -> float:
        return self.roller_length + ROLLER_OVERHANG * self.roller_diameter

    @property
    def inclination(self) -> float:
        assert self.taper is not None
        return float(np.copysign(abs(self.contact_angle) - self.taper, self.contact_angle))

    def arc_radius(self, side: str) -> float | None:
        return None if self.raceway_radii is None else self.raceway_radii[SIDES.index(side)]  # pyright: ignore[reportIndexIssue]

    def axis(self, track: Track) -> tuple[float, float]:
        """Radial and axial component [-] of the direction of the axis of a roller of a track."""
        tau = self.inclination * track.sense
        return float(-np.sin(tau)), float(np.cos(tau))

    def angle_at(self, side: str) -> float:
        """Contact angle [rad] of a raceway in the middle of the rollers, of the first row, side "inner" or "outer"."""
        assert self.taper is not None
        away = self.taper if side == "outer" else -self.taper
        return float(np.copysign(abs(self.inclination) + away, self.contact_angle))

    @property
    def dynamic_rating(self) -> float:
        thrust = rating.is_thrust(self.contact_angle)
        b_m = 1.15 if self.raceway_radii is not None else 1.0 if thrust else rating.ROLLER_B_M
        return rating.roller_dynamic(*self._size, self.contact_angle, self.rows, b_m)

    @property
    def static_rating(self) -> float:
        return rating.roller_static(*self._size, self.contact_angle, self.rows)

    def load_factors(self, radial: float, axial: float) -> tuple[float, float]:
        return rating.roller_load_factors(self.contact_angle, radial, axial, self.rows)

    @property
    def _size(self) -> tuple[int, float, float, float]:
        return self.elements, self.diameter, self.roller_length, self.pitch_diameter

    def bottom(self, side: str) -> float:
        """Radius [m] of a raceway in the middle of the rollers, side "inner" or "outer"."""
        sign = -1.0 if side == "inner" else 1.0
        return float(
            0.5 * self.pitch_diameter + sign * (0.5 * self.diameter * np.cos(self.inclination) + self.play(side))
        )

    def raceway(self, side: str, track: Track, where: Callable[[float], dict[str, Any]]) -> Shape:
        if self.raceway_radii is not None:
            return super().raceway(side, track, where)
        sign, angle = (-1.0 if side == "inner" else 1.0), self.angle_at(side) * track.sense
        at = where(track.z + sign * 0.5 * self.diameter * float(np.sin(self.inclination * track.sense)))
        if abs(angle) > THRUST:
            outward = -sign * np.sign(angle) * np.asarray(at["axis_direction"])
            return surfaces.Plane(origin=at["axis_point"], outward=outward)
        if not angle:
            return (surfaces.Cylinder if side == "inner" else surfaces.Bore)(radius=self.bottom(side), **at)
        kind = surfaces.Cone if side == "inner" else surfaces.ConicalBore
        return kind(radius=self.bottom(side), half_angle=-angle, **at)

    def roller(self, diameter: float, track: Track, where: dict[str, Any]) -> Shape:
        """The surface of a roller of the diameter [m] and a track; where: axis_point and axis_direction."""
        if self.taper:
            half_angle = -self.taper * track.sense * np.sign(self.contact_angle)
            return surfaces.Cone(radius=0.5 * diameter, half_angle=float(half_angle), **where)
        if self.profile is None:
            return surfaces.Cylinder(radius=0.5 * diameter, **where)
        if isinstance(self.profile, (int, float)):
            return surfaces.CrownedCylinder(radius=0.5 * diameter, crown_radius=float(self.profile), **where)
        return surfaces.ProfiledCylinder(radius=0.5 * diameter, table=self.profile, **where)

    def curvature(self, side: str) -> float:
        """Relative curvature [1/m] of roller and raceway across their line of contact, side "inner" or "outer"."""
        sign = 1.0 if side == "inner" else -1.0
        assert self.taper is not None
        return float(2.0 / self.diameter * np.cos(self.taper) + sign * np.cos(self.angle_at(side)) / self.bottom(side))


def from_description(description: dict[str, Any]) -> BallGeometry | RollerGeometry:
    """The geometry from the output of `describe`."""
    kinds: dict[str, Any] = {kind.__name__: kind for kind in (BallGeometry, RollerGeometry)}
    fields = dict(description)
    return kinds[fields.pop("type")](**fields)
