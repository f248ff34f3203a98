r"""Two meshing gears: path of contact, curvature, sliding, backlash, contact ratios and Hertz's pressure.

sigma = 1 for two external gears, -1 where gear 2 is internal. With the working pressure angle alpha_w,
a cos alpha_w = r_b2 + sigma r_b1, a place on the path of contact is g [m], its distance from the pitch point C,
positive towards the tip of gear 1:

    rho_1 = r_b1 tan alpha_w + g,      rho_2 = r_b2 tan alpha_w - sigma g,      1/rho = 1/rho_1 + sigma/rho_2.

Contact begins at A, the tip of gear 2, and ends at E, the tip of gear 1; one pair of teeth carries between B and D, a
base pitch from the ends. The roll angle of gear 1 is rho_1/r_b1. The backlash on the working pitch circle is
j = p_w - s_w1 - s_w2. Hertz's pressure of a width b under the normal force F = T_1/r_b1 is

    p = sqrt(F E*/(pi b rho)),      half-width sqrt(4 F rho/(pi b E*)),      1/E* = (1 - nu_1^2)/E_1 + (1 - nu_2^2)/E_2.

Helical gears. All this is in the transverse sections, of which each meshes as a spur gear, that at z at g - s r_b1
tau_1 z = g - s z tan beta_b1 on the path, s = 1 on right and -1 on left flanks: lines of contact are straight, in the
plane of action, at beta_b to the axis. Along one of them the normal of the flanks is constant and at beta_b to the
sections, and their radii of curvature are rho/cos beta_b. With F_bn the normal force and b the width

    F_bn = T_1/(r_b1 cos beta_b),      F_a = F_bn sin beta_b = F_wt tan beta_w,      F_wt = 2 T_1/d_w1,

and a line over the whole width, b/cos beta_b long, has the line load T_1/(r_b1 b) of the spur gear. The overlap ratio
is eps_beta = b sin beta/(pi m_n) = b tan beta_b/p_bt.

Interference of the tips of an internal pair: Colbourne 1987, The Geometry of Involute Gears, section 8.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from warpffrf.model.errors import InputError, require_number, unknown_name
from warpffrf.model.gears.gear import FLANKS, Gear, involute_function
from warpffrf.model.gears.tooth import reach
from warpffrf.model.material import Material
from warpffrf.model.messages.named_arguments import named_arguments

SAME_PITCH = 1e-9  # relative: base pitches that differ by less are equal
NO_BACKLASH = 1e-4  # of the module: pairs without backlash have overlaps of that much where x has four digits
STEEL = Material(youngs_modulus=206e9, poisson_ratio=0.3, density=7850.0)


@named_arguments
@dataclass(frozen=True, eq=False)
class GearPair:
    """Two gears at a distance of their axes; gear 2 may be internal. Lengths in metres, angles in radians.

    gear_1, gear_2: `Gear`s of one base pitch and one base helix angle, of opposite hands, of an internal pair of the
    same hand; center_distance: a [m], positive for internal pairs too. The axis of gear 2 lies at +x of that of gear 1,
    of an internal gear 2 at -x, so that the teeth meet at +x of gear 1.

    Raises `InputError` where the pair does not mesh: unequal base pitches or helix angles, negative backlash, tips that
    touch the roots or each other, tips that reach below the involute, a contact ratio below 1: the transverse one.

    >>> import numpy as np
    >>> pinion = wf.gears.Gear(4.5e-3, 16, profile_shift=0.1817, tip_diameter=82.45e-3, thickness_allowance=-50e-6)
    >>> wheel = wf.gears.Gear(4.5e-3, 24, profile_shift=0.1715, tip_diameter=118.35e-3, thickness_allowance=-50e-6)
    >>> pair = wf.gears.GearPair(pinion, wheel, 91.5e-3)
    >>> print(f"{np.degrees(pair.working_pressure_angle):.2f} degrees, {pair.contact_ratio:.3f}")
    22.44 degrees, 1.436
    """

    gear_1: Gear
    gear_2: Gear
    center_distance: float

    def __post_init__(self) -> None:
        for name in ("gear_1", "gear_2"):
            if not isinstance(getattr(self, name), Gear):
                raise InputError(f"gear pair: {name} must be a gears.Gear, got {getattr(self, name)!r}")
        a = require_number(self.center_distance, "gear pair: center_distance", positive=True)
        object.__setattr__(self, "center_distance", a)
        self._check()

    @property
    def side(self) -> int:
        """sigma: 1 for two external gears, -1 where gear 2 is internal."""
        return self.gear_2.side

    @property
    def base_helix_angle(self) -> float:
        """beta_b [rad], with the sign of gear 1."""
        return self.gear_1.base_helix_angle

    @property
    def working_pressure_angle(self) -> float:
        """alpha_wt [rad], in the transverse section."""
        return float(np.arccos(self._base_distance / self.center_distance))

    @property
    def working_diameters(self) -> tuple[float, float]:
        """d_w1, d_w2 [m], of the working pitch circles."""
        c = np.cos(self.working_pressure_angle)
        return float(self.gear_1.base_diameter / c), float(self.gear_2.base_diameter / c)

    @property
    def path(self) -> dict[str, float]:
        """g [m] of the points "A", "B", "C", "D", "E" of the path of contact.

        The part of the flanks with tip relief is included; roundings of tips are not.
        """
        rho_1, rho_2 = self.pitch_rho
        ends = [reach(gear, 0.5 * gear.tip_form_diameter) for gear in (self.gear_1, self.gear_2)]
        A, E = self.side * (rho_2 - ends[1]), ends[0] - rho_1
        p = self.gear_1.base_pitch
        return {"A": A, "B": E - p, "C": 0.0, "D": A + p, "E": E}

    @property
    def contact_ratio(self) -> float:
        """epsilon_alpha [-], the transverse contact ratio."""
        return (self.path["E"] - self.path["A"]) / self.gear_1.base_pitch

    def overlap_ratio(self, width: float) -> float:
        """epsilon_beta [-] of a common `width` b [m]; 0 of spur gears. The sum with `contact_ratio` is the total one,
        epsilon_gamma."""
        b = require_number(width, "overlap_ratio: width", positive=True)
        return b * abs(float(np.tan(self.base_helix_angle))) / self.gear_1.base_pitch

    @property
    def backlash(self) -> float:
        """j_wt [m], on the working pitch circle; along the normal it is j_bn = j_wt cos alpha_wt cos beta_b."""
        s_1, s_2 = (
            gear.tooth_thickness(d) for gear, d in zip((self.gear_1, self.gear_2), self.working_diameters, strict=True)
        )
        return float(np.pi * self.working_diameters[0] / self.gear_1.teeth) - s_1 - s_2

    @property
    def tip_clearances(self) -> tuple[float, float]:
        """Distances [m] of the tip circles of gears 1 and 2 from the root circle of the other gear."""
        a, sign = self.center_distance, self.side
        (tip_1, root_1), (tip_2, root_2) = (
            (0.5 * gear.tip_diameter, 0.5 * gear.root_diameter) for gear in (self.gear_1, self.gear_2)
        )
        return sign * (a - root_2) - tip_1, sign * (a - tip_2) - root_1

    def roll_angle(self, g: Any) -> Any:
        """xi_1 [rad] of gear 1 where contact is at g [m]: 0 on its base circle."""
        return (self.pitch_rho[0] + np.asarray(g, float)) / self.gear_1.base_radius

    def curvature_radii(self, g: Any) -> tuple[Any, Any]:
        """rho_1 and rho_2 [m] of the flanks, without tip relief, at g [m], in the transverse section; rho_2 is negative
        on an internal gear."""
        rho_1, rho_2 = self.pitch_rho
        g = np.asarray(g, float)
        return rho_1 + g, self.side * rho_2 - g

    def sliding_speed(self, g: Any, speed: float) -> Any:
        """v_g [m/s] of flank 1 against flank 2 at g [m], where gear 1 rotates at `speed` [rad/s]."""
        return np.asarray(g, float) * speed * (1.0 + self.side * self.gear_1.teeth / self.gear_2.teeth)

    def hertz(
        self, torque: float, width: float, g: Any = 0.0, *, materials: tuple[Material, Material] = (STEEL, STEEL)
    ) -> tuple[Any, Any]:
        """Largest pressure [Pa] and half-width [m] of one pair of teeth that carries the whole torque on gear 1 [N m],
        evenly on a line over the width.

        width: of the contact, b [m]; g: its place on the path of contact [m]; materials: of gears 1 and 2, steel with
        206 GPa and 0.3 where not given.
        """
        force = require_number(torque, "hertz: torque", positive=True) / self.gear_1.base_radius
        line = force / require_number(width, "hertz: width", positive=True)
        rho_1, rho_2 = self.curvature_radii(g)
        rho = 1.0 / (1.0 / rho_1 + 1.0 / rho_2) / np.cos(self.base_helix_angle)
        modulus = 1.0 / sum((1.0 - m.poisson_ratio**2) / m.youngs_modulus for m in materials)
        return np.sqrt(line * modulus / (np.pi * rho)), np.sqrt(4.0 * line * rho / (np.pi * modulus))

    @named_arguments
    def mating_angle(self, angle: float, flank: str = "right") -> float:
        """Rotation [rad] of gear 2 at which its flanks, right or left, touch those of gear 1, rotated by `angle` [rad].

        Both are counter-clockwise from where tooth 1 lies about +x. Of flanks with tip relief those without it would
        touch. Raises `InputError` for an unknown flank.
        """
        if flank not in FLANKS:
            raise unknown_name("mating_angle: flank", flank, FLANKS)
        z_1, z_2, sign = self.gear_1.teeth, self.gear_2.teeth, self.side
        start = np.pi + np.pi / z_2 if sign > 0 else np.pi / z_2
        play = self.backlash / self.working_diameters[1] * (1.0 if flank == "right" else -1.0)
        return float(start - sign * (angle * z_1 / z_2 + play))

    # --- inside

    @property
    def _base_distance(self) -> float:
        return self.gear_2.base_radius + self.side * self.gear_1.base_radius

    @property
    def pitch_rho(self) -> tuple[float, float]:
        """Distances [m] of the pitch point from the base circles along the path of contact, both positive."""
        t = float(np.tan(self.working_pressure_angle))
        return self.gear_1.base_radius * t, self.gear_2.base_radius * t

    def _check(self) -> None:
        one, two, a = self.gear_1, self.gear_2, self.center_distance
        if one.internal:
            cure = "one gear must be external" if two.internal else "exchange gear_1 and gear_2"
            raise InputError(f"gear pair: gear_1 is internal; {cure}")
        if two.internal and two.teeth <= one.teeth:
            raise InputError(
                f"gear pair: an internal gear needs more teeth than its pinion, got {two.teeth} and {one.teeth}"
            )
        if abs(one.base_helix_angle + self.side * two.base_helix_angle) > SAME_PITCH:
            beta, other = (float(np.degrees(gear.helix_angle)) for gear in (one, two))
            hands = "two external gears need opposite hands" if self.side > 0 else "an internal pair needs one hand"
            raise InputError(
                f"gear pair: helix angles of {beta:.6g} and {other:.6g} degrees do not mesh, {hands}; make helix_angle "
                f"of gear_2 {-self.side * beta:.6g} degrees, in rad"
            )
        if abs(one.base_pitch - two.base_pitch) > SAME_PITCH * one.base_pitch:
            raise InputError(
                f"gear pair: the base pitches {one.base_pitch:.6g} and {two.base_pitch:.6g} m differ; use one module "
                "and one pressure_angle"
            )
        if a <= self._base_distance:
            raise InputError(
                f"gear pair: at center_distance {a:.6g} m the base circles leave no path of contact; it must be larger "
                f"than {self._base_distance:.6g} m"
            )
        if self.backlash < -NO_BACKLASH * one.module:
            raise InputError(
                f"gear pair: the backlash is {self.backlash:.3g} m, the teeth jam; give thickness_allowance below "
                f"{0.5 * (self.backlash + one.thickness_allowance + two.thickness_allowance):.2g} m to both gears, or "
                f"make center_distance {'larger' if self.side > 0 else 'smaller'}"
            )
        for (tip, root), clearance in zip(((1, 2), (2, 1)), self.tip_clearances, strict=True):
            if clearance <= 0.0:
                raise InputError(
                    f"gear pair: the tip circle of gear_{tip} cuts into the root circle of gear_{root} by "
                    f"{-clearance:.3g} m; correct its tip_diameter or center_distance"
                )
        rho_1, rho_2 = self.pitch_rho
        for name, other, rho, form in (
            ("gear_2", "gear_1", rho_1 + self.path["A"], one.root_form_rho),
            ("gear_1", "gear_2", two.side * (rho_2 - self.side * self.path["E"]), two.side * two.root_form_rho),
        ):
            if rho < form:
                raise InputError(
                    f"gear pair: the tips of {name} reach {form - rho:.3g} m along the path of contact beyond the "
                    f"involute of {other}; correct the tip_diameter of {name}, or take more profile_shift on {other}"
                )
        if self.contact_ratio < 1.0:
            raise InputError(
                f"gear pair: the contact ratio is {self.contact_ratio:.3f}, below 1; make center_distance "
                f"{'smaller' if self.side > 0 else 'larger'}, or the tips longer"
            )
        if self.side < 0:
            self._check_tips()

    def _check_tips(self) -> None:
        """Raises `InputError` where the tips of an internal pair meet outside the path of contact."""
        a, z_1, z_2 = self.center_distance, self.gear_1.teeth, self.gear_2.teeth
        tip_1, tip_2 = 0.5 * self.gear_1.tip_diameter, 0.5 * self.gear_2.tip_diameter
        if a + tip_1 <= tip_2:
            return
        angle_1 = np.arccos((tip_2**2 - tip_1**2 - a**2) / (2.0 * a * tip_1))
        angle_2 = np.arccos((tip_2**2 - tip_1**2 + a**2) / (2.0 * a * tip_2))
        inv_1 = involute_function(np.arccos(self.gear_1.base_radius / tip_1))
        inv_2 = involute_function(np.arccos(self.gear_2.base_radius / tip_2))
        inv_w = involute_function(self.working_pressure_angle)
        if z_1 * (inv_1 + angle_1) + (z_2 - z_1) * inv_w - z_2 * (inv_2 + angle_2) <= 0.0:
            raise InputError(
                f"gear pair: the tips of {z_1} and {z_2} teeth interfere; take fewer teeth on gear_1, or a larger "
                "tip_diameter of gear_2"
            )
