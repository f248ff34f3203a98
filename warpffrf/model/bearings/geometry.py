r"""The geometry of rolling bearings: positions of raceways and elements, and checks of the dimensions.

**Ball bearing.** Balls of diameter D lie on the pitch circle of diameter d_pw; the grooves of the rings have the radii
r_i and r_e across, f_i = r_i/D and f_e = r_e/D are their osculations. A ball touches both rings where their groove
centres lie

    A = r_i + r_e - D

apart. With the free contact angle alpha_0 and the diametral clearance s of a bearing whose grooves stand opposite each
other, the circles of the groove centres have the radii and axial places

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

and the rolling against the cage is d/(2 D) (1 - gamma^2)(w_o - w_i). Rollers have alpha = 0 and w_r = 0. Turning
w_r e_r around with w_c requires the gyroscopic moment I w_c w_r about e_t, which friction must provide.
"""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from warpffrf.model.errors import InputError, require_count, require_number

STEEPEST = np.radians(80.0)  # contact angle up to which a groove that is open to the side carries
LARGEST_OSCULATION = 5.0  # groove radius over ball diameter: a wider one is a length in the place of a ratio


@dataclass(frozen=True)
class Raceways:
    """Common base of ball and roller bearings: `count` elements of `diameter` D [m] on a circle of `pitch_diameter`
    [m], diametral `clearance` s [m].

    Raises `InputError`, naming `label`, for elements that overlap, or that reach to the axis.
    """

    label: str
    count: int
    diameter: float
    pitch_diameter: float
    clearance: float

    def __post_init__(self) -> None:
        object.__setattr__(self, "count", require_count(self.count, f"{self.label}: elements", 2))
        for name in ("diameter", "pitch_diameter"):
            self._keep(name, require_number(getattr(self, name), f"{self.label}: {name} [m]", positive=True))
        self._keep("clearance", require_number(self.clearance, f"{self.label}: clearance [m]"))
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
                f"{self.label}: {self.count} elements of diameter {D:g} m overlap on a pitch circle of {pitch:g} m, "
                f"where their centres are {apart:.4g} m apart; use at most {most} elements, smaller ones, or a larger "
                f"pitch diameter, {D / np.sin(np.pi / self.count):.4g} m or more"
            )

    @property
    def angles(self) -> np.ndarray:
        """(count,) rad, of the elements about the axis, from the first one."""
        return 2.0 * np.pi * np.arange(self.count) / self.count

    @property
    def apart(self) -> float:
        """Distance [m] of the centres of neighbours."""
        return self.pitch_diameter * float(np.sin(np.pi / self.count))

    def describe(self) -> dict[str, Any]:
        """Plain data, to be made again of by `from_description`."""
        return {"type": type(self).__name__, **asdict(self)}

    def _keep(self, name: str, value: Any) -> None:
        object.__setattr__(self, name, value)


@dataclass(frozen=True)
class BallRaceways(Raceways):
    """Of a ball bearing: groove radii r_i, r_e [m] and free contact angle alpha_0 [rad], see the module.

    Raises `InputError` for grooves as narrow as the balls, contact angles that a groove cannot carry at, a clearance
    beyond what grooves and balls leave, and where both angle and clearance are given.
    """

    inner_groove: float
    outer_groove: float
    contact_angle: float

    def __post_init__(self) -> None:
        super().__post_init__()
        for name in ("inner_groove", "outer_groove"):
            radius = require_number(getattr(self, name), f"{self.label}: {name} [m]", positive=True)
            self._keep(name, radius)
            ratio = radius / self.diameter
            if not 0.5 < ratio <= LARGEST_OSCULATION:
                raise InputError(
                    f"{self.label}: the osculation of the {name.split('_')[0]} ring, groove radius over ball diameter, "
                    f"must be above 0.5, a groove that is wider than the ball, and is hardly above 0.6, got {ratio:g}"
                )
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
    def reach(self) -> float:
        """A [m]: how far apart the groove centres are where the balls touch both rings."""
        return self.inner_groove + self.outer_groove - self.diameter

    @property
    def free_angle(self) -> float:
        """Free contact angle [rad]: that of the balls under thrust, before any deformation."""
        if self.contact_angle or self.clearance <= 0.0:
            return self.contact_angle
        return float(np.arccos(1.0 - self.clearance / (2.0 * self.reach)))

    def centre(self, side: str) -> tuple[float, float]:
        """Radius and axial place [m] of the circle of groove centres, side "inner" or "outer"."""
        sign = 1.0 if side == "inner" else -1.0
        beyond = self.groove(side) - 0.5 * self.diameter
        across, along = beyond * np.cos(self.contact_angle), beyond * np.sin(self.contact_angle)
        radius = 0.5 * self.pitch_diameter + sign * (across - 0.25 * self.clearance)
        return float(radius), float(sign * along)

    def groove(self, side: str) -> float:
        """Groove radius [m], side "inner" or "outer"."""
        return self.inner_groove if side == "inner" else self.outer_groove

    def bottom(self, side: str) -> float:
        """Radius [m] of the bottom of the groove."""
        sign = -1.0 if side == "inner" else 1.0
        return self.centre(side)[0] + sign * self.groove(side)

    def curvatures(self, side: str, angle: Any) -> tuple[np.ndarray, np.ndarray]:
        """Relative curvatures [1/m] of ball and raceway across and along the groove, where they touch at the contact
        angle [rad]: 2/D - 1/r, and 2/D +- cos(angle)/(R_c -+ r cos(angle)), R_c the radius of the groove centres."""
        sign = 1.0 if side == "inner" else -1.0
        c = np.cos(np.asarray(angle, dtype=float))
        around = sign * c / (self.centre(side)[0] - sign * self.groove(side) * c)
        across = np.full(c.shape, 2.0 / self.diameter - 1.0 / self.groove(side))
        return across, 2.0 / self.diameter + around


@dataclass(frozen=True)
class RollerRaceways(Raceways):
    """Of a cylindrical roller bearing: `length` [m] of a roller.

    Raises `InputError` for a clearance beyond the size of the rollers.
    """

    length: float

    def __post_init__(self) -> None:
        super().__post_init__()
        self._keep("length", require_number(self.length, f"{self.label}: roller_length [m]", positive=True))
        if abs(self.clearance) >= self.diameter:
            raise InputError(
                f"{self.label}: a clearance of {self.clearance:g} m is beyond the geometry, whose rollers are "
                f"{self.diameter:g} m thick; it is the play of a ring across the bearing, some hundredths of a mm"
            )

    def bottom(self, side: str) -> float:
        """Radius [m] of a raceway, side "inner" or "outer"."""
        sign = -1.0 if side == "inner" else 1.0
        return 0.5 * self.pitch_diameter + sign * (0.5 * self.diameter + 0.25 * self.clearance)

    def curvature(self, side: str) -> float:
        """Relative curvature [1/m] of roller and raceway."""
        sign = 1.0 if side == "inner" else -1.0
        return 2.0 / self.diameter + sign / self.bottom(side)


def from_description(description: dict[str, Any]) -> BallRaceways | RollerRaceways:
    """The geometry from the output of `describe`."""
    kinds = {kind.__name__: kind for kind in (BallRaceways, RollerRaceways)}
    numbers = dict(description)
    return kinds[numbers.pop("type")](**numbers)


SIDES = ("inner", "outer")


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
