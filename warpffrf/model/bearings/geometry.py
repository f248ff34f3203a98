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
then just touch both rings; or alpha_0 is 0 and s is given, negative for an interference. The free contact angle that
such a bearing takes under thrust is arccos(1 - s/(2 A)). Thrust on the inner ring along the axis presses the bearing
together where alpha_0 is positive.

**Roller bearing.** Cylindrical raceways of the radii (d_pw - D)/2 - s/4 and (d_pw + D)/2 + s/4.

Rolling. Kinematics of elements that roll without slip on two raceways: orbit and spin from the speeds of the rings.

With e_r outward, e_t around and e_a along the axis of the bearing, an element orbits with w_c and rotates with omega =
w_r e_r + w_a e_a. Its surface at the contact with the outer raceway, D/2 n_o from its centre with n_o = cos(alpha_o)
e_r + sin(alpha_o) e_a, and with the inner one, -D/2 n_i, has their circumferential velocity:

    w_c d/2 + D/2 (w_a cos alpha_o - w_r sin alpha_o) = w_o (d/2 + D/2 cos alpha_o),
    w_c d/2 - D/2 (w_a cos alpha_i - w_r sin alpha_i) = w_i (d/2 - D/2 cos alpha_i),

d the pitch diameter, w_i and w_o the speeds of the rings. The pivoting remains undetermined, a rotation about the line
of contact, which no point contact resists. Raceway control (Jones 1959) has none at one of the rings, of the speed w
and the angle alpha:

    (omega - w e_a) . n = w_r cos alpha + (w_a - w) sin alpha = 0,

the outer one at high speed, where the centrifugal force presses there. At equal angles, gamma = D cos(alpha)/d,

    w_c = (w_i (1 - gamma) + w_o (1 + gamma))/2,

and the rolling against the cage is d/(2 D) (1 - gamma^2)(w_o - w_i). Rollers have alpha = 0 and w_r = 0. Rotating
w_r e_r with w_c requires the gyroscopic moment I w_c w_r about e_t, which friction must provide.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import Any

import numpy as np

from warpffrf.model.bearings import rating
from warpffrf.model.errors import InputError, require_array, require_count, require_number
from warpffrf.model.messages.named_arguments import named_arguments
from warpffrf.model.surfaces.form_deviations import Form

SIDES = ("inner", "outer")
STEEPEST = np.radians(80.0)  # contact angle up to which a groove that is open to the side carries
LARGEST_OSCULATION = 5.0  # groove radius over ball diameter: a larger value is a length instead of a ratio
LARGEST_DEVIATION = 1e-2  # of the diameter: beyond, it is the diameter itself
OSCULATION = 0.52  # of groove radius over ball diameter, where nothing is given: a deep-groove bearing's
BALL_WIDTH, ROLLER_OVERHANG = 1.5, 0.4  # of the diameter of an element
PLAIN = (int, float, tuple, type(None))  # of the values that results need


def pair(value: Any, name: str) -> tuple[Any, Any]:
    """(inner, outer), of one value for both sides or of two. Raises `InputError` for another number of them."""
    both = value if isinstance(value, (tuple, list)) else (value, value)
    if len(both) != 2:
        raise InputError(f"{name} is one value, or two, (inner, outer), got {len(both)}")
    return both[0], both[1]


class Geometry(ABC):
    """Common base of ball and roller bearings, whose dimensions are fields; see `BallGeometry`."""

    elements: int
    pitch_diameter: float
    clearance: float
    diameter_deviations: Any
    width: float | None

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

    def _check(self, *lengths: str) -> None:
        """lengths: names of the fields that are positive."""
        self._keep("elements", require_count(self.elements, f"{self.label}: elements", 2))
        for name in (*lengths, "pitch_diameter"):
            self._keep(name, require_number(getattr(self, name), f"{self.label}: {name} [m]", positive=True))
        self._keep("clearance", require_number(self.clearance, f"{self.label}: clearance [m]"))
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

    def _checked_deviations(self) -> tuple[float, ...]:
        found = require_array(self.diameter_deviations, f"{self.label}: diameter_deviations [m]", (self.elements,))
        most = LARGEST_DEVIATION * self.diameter
        if np.max(np.abs(found)) > most:
            raise InputError(
                f"{self.label}: diameter_deviations are what the elements differ by from their diameter, some "
                f"micrometres, got {found[np.argmax(np.abs(found))]:g} m, more than {most:.3g} m"
            )
        return tuple(found.tolist())

    @property
    def diameters(self) -> np.ndarray:
        """(elements,) m, of the elements with their deviations."""
        excess = np.zeros(self.elements) if self.diameter_deviations is None else np.array(self.diameter_deviations)
        return self.diameter + excess

    @property
    def angles(self) -> np.ndarray:
        """(elements,) rad, of the elements about the axis, from the first one."""
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

    def describe(self) -> dict[str, Any]:
        """Plain data, from which `from_description` restores it; without form deviations and profiles."""
        plain = {name: value for name, value in vars(self).items() if isinstance(value, PLAIN) and name != "profile"}
        return {"type": type(self).__name__, **plain}

    def _keep(self, name: str, value: Any) -> None:
        object.__setattr__(self, name, value)


@named_arguments
@dataclass(frozen=True, kw_only=True)
class BallGeometry(Geometry):
    """Geometry of a ball bearing, see the module.

    elements: number of balls; ball_diameter, pitch_diameter [m]. osculation: groove radius over ball diameter, above
    0.5, one number or (inner, outer). contact_angle [rad], at which the balls just touch both rings, positive where
    thrust on the inner ring along the axis presses the bearing together; or clearance [m], diametral, negative for an
    interference, a radial preload. shoulders [m]: height over the bottom of the groove, one or (inner, outer), from
    which results compute the truncated fraction of a patch.

    inner_form, outer_form: form deviation of a rigid raceway around its axis, of `warpffrf.films`, positive where
    material is missing, angles from the first ball: films.LobedForm(5e-6, 2) is oval. diameter_deviations (elements,)
    [m]: excess diameter of each ball. width, bore, outside_diameter [m]: boundary dimensions, for the masses of rings
    that the builder makes; None: those of the medium series.

    Raises `InputError` for elements that overlap or that reach to the axis, grooves as narrow as the balls, contact
    angles at which a groove cannot carry, a clearance larger than grooves and balls permit, and where both angle and
    clearance are given.
    """

    elements: int
    ball_diameter: float
    pitch_diameter: float
    osculation: float | tuple[float, float] = OSCULATION
    contact_angle: float = 0.0
    clearance: float = 0.0
    shoulders: float | tuple[float | None, float | None] | None = None
    inner_form: Form | None = None
    outer_form: Form | None = None
    diameter_deviations: Any = None
    width: float | None = None
    bore: float | None = None
    outside_diameter: float | None = None

    def __post_init__(self) -> None:
        self._check("ball_diameter")
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
        self._keep("contact_angle", require_number(self.contact_angle, f"{self.label}: contact_angle [rad]"))
        if abs(self.contact_angle) > STEEPEST:
            raise InputError(
                f"{self.label}: contact_angle must lie between -{STEEPEST:.3g} and {STEEPEST:.3g} rad, got "
                f"{self.contact_angle:g}; angles are in radians, np.radians(40) is 0.698"
            )
        if self.contact_angle and self.clearance:
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
        return rating.ball_dynamic(*self._rated, self.osculation)  # pyright: ignore[reportArgumentType]

    @property
    def static_rating(self) -> float:
        return rating.ball_static(*self._rated, self.osculation)  # pyright: ignore[reportArgumentType]

    def load_factors(self, radial: float, axial: float) -> tuple[float, float]:
        return rating.ball_load_factors(self.elements, self.diameter, self.contact_angle, radial, axial)

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
        if self.contact_angle or self.clearance <= 0.0:
            return self.contact_angle
        return float(np.arccos(1.0 - self.clearance / (2.0 * self.reach)))

    def centre(self, side: str) -> tuple[float, float]:
        """Radius and axial position [m] of the circle of groove centres, side "inner" or "outer"."""
        sign = 1.0 if side == "inner" else -1.0
        beyond = self.groove(side) - 0.5 * self.diameter
        across, along = beyond * np.cos(self.contact_angle), beyond * np.sin(self.contact_angle)
        radius = 0.5 * self.pitch_diameter + sign * (across - 0.25 * self.clearance)
        return float(radius), float(sign * along)

    def groove(self, side: str) -> float:
        """Groove radius [m], side "inner" or "outer"."""
        return self.osculation[SIDES.index(side)] * self.diameter  # pyright: ignore[reportIndexIssue]

    def bottom(self, side: str) -> float:
        """Radius [m] of the bottom of the groove, side "inner" or "outer"."""
        sign = -1.0 if side == "inner" else 1.0
        return self.centre(side)[0] + sign * self.groove(side)

    def curvatures(self, side: str, angle: Any) -> tuple[np.ndarray, np.ndarray]:
        """Relative curvatures (...) [1/m] of ball and raceway, side "inner" or "outer", across and along the groove,
        where they touch at the contact angle (...) [rad]: 2/D - 1/r, and 2/D +- cos(angle)/(R_c -+ r cos(angle)), R_c
        the radius of the groove centres."""
        sign = 1.0 if side == "inner" else -1.0
        c = np.cos(np.asarray(angle, dtype=float))
        around = sign * c / (self.centre(side)[0] - sign * self.groove(side) * c)
        across = np.full(c.shape, 2.0 / self.diameter - 1.0 / self.groove(side))
        return across, 2.0 / self.diameter + around


@named_arguments
@dataclass(frozen=True, kw_only=True)
class RollerGeometry(Geometry):
    """Geometry of a cylindrical roller bearing.

    elements: number of rollers; roller_diameter, pitch_diameter [m]; roller_length [m]: the effective one. clearance
    [m]: diametral, negative for an interference. profile: of the rollers in addition to that of the contact law: the
    crown radius [m], a table (z, drop), two arrays (n,) [m] from the middle, as of `surfaces.ProfiledCylinder`, or None
    for straight ones. inner_form, outer_form, diameter_deviations (elements,) [m], width, bore and outside_diameter [m]
    as of `BallGeometry`.

    Raises `InputError` for elements that overlap or that reach to the axis, and a clearance beyond the size of the
    rollers.
    """

    elements: int
    roller_diameter: float
    roller_length: float
    pitch_diameter: float
    clearance: float = 0.0
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

    @property
    def diameter(self) -> float:
        return self.roller_diameter

    @property
    def default_width(self) -> float:
        return self.roller_length + ROLLER_OVERHANG * self.roller_diameter

    @property
    def dynamic_rating(self) -> float:
        return rating.roller_dynamic(self.elements, self.diameter, self.roller_length, self.pitch_diameter)

    @property
    def static_rating(self) -> float:
        return rating.roller_static(self.elements, self.diameter, self.roller_length, self.pitch_diameter)

    def load_factors(self, radial: float, axial: float) -> tuple[float, float]:
        return rating.roller_load_factors(0.0, radial, axial)

    def bottom(self, side: str) -> float:
        """Radius [m] of a raceway, side "inner" or "outer"."""
        sign = -1.0 if side == "inner" else 1.0
        return 0.5 * self.pitch_diameter + sign * (0.5 * self.diameter + 0.25 * self.clearance)

    def curvature(self, side: str) -> float:
        """Relative curvature [1/m] of roller and raceway, side "inner" or "outer"."""
        sign = 1.0 if side == "inner" else -1.0
        return 2.0 / self.diameter + sign / self.bottom(side)


def from_description(description: dict[str, Any]) -> BallGeometry | RollerGeometry:
    """The geometry from the output of `describe`."""
    kinds: dict[str, Any] = {kind.__name__: kind for kind in (BallGeometry, RollerGeometry)}
    fields = dict(description)
    return kinds[fields.pop("type")](**fields)


@dataclass(frozen=True)
class Rolling:
    """Speeds [rad/s] of an element: `orbit` about the axis, and its rotation, `radial` outward and `axial` along the
    axis, not against the cage but in the world."""

    orbit: float
    radial: float
    axial: float


def rolling(
    diameter: float, pitch: float, inner: float, outer: float, angles: tuple[float, float], control: str = "outer"
) -> Rolling:
    """Without slip on rings of the speeds `inner` and `outer` [rad/s] at the contact angles (inner, outer) [rad], not
    pivoting on the raceway `control`. Raises `InputError` for another name."""
    if control not in SIDES:
        raise InputError(f'rolling: control must be "inner" or "outer", the raceway without pivoting, got {control!r}')
    (c_i, c_o), (s_i, s_o) = np.cos(angles), np.sin(angles)
    R, r = 0.5 * pitch, 0.5 * diameter
    speed, c, s = (inner, c_i, s_i) if control == "inner" else (outer, c_o, s_o)
    rows = np.array([[R, -r * s_o, r * c_o], [R, r * s_i, -r * c_i], [0.0, c, s]])
    known: Any = np.array([outer * (R + r * c_o), inner * (R - r * c_i), speed * s])
    orbit, radial, axial = np.linalg.solve(rows, known)
    return Rolling(float(orbit), float(radial), float(axial))
