r"""What happens on the flanks of a gear pair: pressures and sliding over the flank, path of contact, film thickness.

**Sliding.** At g on the path of contact the flanks have the radii of curvature rho_1 and rho_2 of `GearPair`. With the
angular velocities w_1 and w_2 of the gears about their axes, in the directions in which gear 1 pushes and gear 2 is
pushed, their surfaces move along the flanks at

    u_1 = w_1 rho_1,   u_2 = w_2 rho_2,      v_g = g (w_1 + sigma w_2),      u = (u_1 + u_2)/2,

v_g the sliding of flank 1 against flank 2, which is u_1 - u_2 where the ratio of the speeds is that of the teeth, and u
the entrainment of oil; sections of helical gears have g of their own. Load steps of a static run have no speeds: there
the speed of gear 1 is given.

**Path of contact.** The line of action touches both base circles and contains the pitch point. Involutes touch on it;
the centre of the pressure lies off it where the curvature varies across the patch, with tip relief, at edges, and
where shafts give way.

**Films** are those of line contacts (`model.bearings.lubrication`) with the load of a pair of teeth over the width of
the contact, the entrainment u, and the radius of relative curvature at g of involutes without relief and tip rounding.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from warpffrf.model.bearings.lubrication import film_of_lines, thermal_factor
from warpffrf.model.errors import InputError, require_number
from warpffrf.model.gears.mesh import advance
from warpffrf.model.oils import Oil
from warpffrf.output.bearings.films import Films, combined_roughness
from warpffrf.output.geometry.places import Pose, grid_theta_offset

if TYPE_CHECKING:
    from warpffrf.output.gears.gear_result import GearResult

Array = np.ndarray


@dataclass(frozen=True)
class FlankMap:
    """Flank of gear 1 over a run: a row for each saved step and pair of teeth under load, in the order of their places;
    all pairs of teeth are superposed.

    step (m,): saved steps; teeth (m,): indices of pairs of teeth; width (m, w) [m], along the axis of the first flank;
    place (m, w) [m] on the path of contact, of a spur gear one over the width; roll_angle (m, w) [rad] of gear 1;
    radius (m, w, 2) [m] of gears 1 and 2; pressure (m, w) [Pa], the largest across the patch; sliding (m, w) [m/s],
    v_g.
    """

    step: Array
    teeth: Array
    place: Array
    roll_angle: Array
    radius: Array
    width: Array
    pressure: Array
    sliding: Array

    @property
    def wear_index(self) -> Array:
        """(m, w) W/m2, pressure times the amount of the sliding velocity."""
        return self.pressure * np.abs(self.sliding)

    def draw(self, ax: Any) -> None:
        """Draw the pressure over roll angle and width on matplotlib axes. Raises `InputError` for fewer than two
        rows."""
        from warpffrf.output.plots.flanks import flank_field

        flank_field(self, ax, "pressure")


@dataclass(frozen=True)
class FlankFilms(Films):
    """`Films` (T, n) of the pairs of teeth, over the roll angle (T, n) [rad] of gear 1."""

    roll_angle: Array

    def draw(self, ax: Any) -> None:
        """Draw least thickness and film parameter over the roll angle on matplotlib axes."""
        from warpffrf.output.plots.flanks import film

        film(self, ax)


@dataclass(frozen=True)
class ContactPath:
    """Where the flanks touch, in the plane across the axis, for each pair of teeth on gears 1 and 2; NaN without load.

    points (T, n, 2, 2) [m], along the line of centres and across it, from the initial centre of gear 1; place (T, n, 2)
    [m] along the line of action from the pitch point, towards the tip of gear 1; offset (T, n, 2) [m] from the line of
    action, positive away from the axis of gear 1.
    """

    points: Array
    place: Array
    offset: Array


def speeds(gear: GearResult, speed: float | None) -> tuple[Array, Array]:
    """w_1 and w_2 (T, n) [rad/s]; speed: see `GearResult.sliding`."""
    s, side, axis = gear._signs, gear.pair.side, gear.axes[2]
    if speed is None:
        one, two = (gear.result.history.bodies[name].angular_velocity @ axis for name in gear.description["bodies"])
    else:
        w = require_number(speed, f"gear pair {gear.name!r}: speed [rad/s]")
        one = np.full(len(gear.time), -s[0] * w)
        two = -side * one * gear.pair.gear_1.teeth / gear.pair.gear_2.teeth
    return -s * one[:, None], side * s * two[:, None]


def sliding(gear: GearResult, speed: float | None) -> Array:
    """See `GearResult.sliding`."""
    one, two = speeds(gear, speed)
    return gear.place * (one + gear.pair.side * two)


def flank_map(gear: GearResult, flank: str, speed: float | None) -> FlankMap:
    """See `GearResult.flank_map`."""
    pair, load = gear.pair, np.where([side == flank for side, _, _ in gear.teeth], gear.load, 0.0)
    step, teeth = np.nonzero(load > 0.0)
    order = np.argsort(gear.place[step, teeth], kind="stable")
    step, teeth = step[order], teeth[order]
    contacts = [gear.result.contact(name) for name in gear.contacts]
    rows = max((contacts[i].rows.shape[1] for i in np.unique(teeth)), default=0)
    width, pressure = np.zeros((2, len(step), rows))
    for m, (t, i) in enumerate(zip(step, teeth, strict=True)):
        z, p = contacts[i].rows[t], contacts[i].mean_pressure[t].max(axis=0)
        width[m] = z if len(z) == rows else np.linspace(z[0], z[-1], rows)
        pressure[m] = np.interp(width[m], z, p)
    g = gear.place[step, teeth][:, None] + advance(pair, flank, width)
    rho = np.stack([pair.pitch_rho[0] + g, pair.pitch_rho[1] - pair.side * g], axis=2)
    radius = np.hypot(rho, [pair.gear_1.base_radius, pair.gear_2.base_radius])
    one, two = (w[step] for w in speeds(gear, speed))
    v_g = g * (one + pair.side * two)[np.arange(len(step)), teeth, None]
    return FlankMap(step, teeth, g, pair.roll_angle(g), radius, width, pressure, v_g)


def contact_path(gear: GearResult, *, nearest: bool) -> ContactPath:
    """See `GearResult.contact_path`."""
    (e_0, e_1, _), pair = gear.axes, gear.pair
    alpha, pitch_point = pair.working_pressure_angle, [0.5 * pair.working_diameters[0], 0.0]
    points = np.full((len(gear.time), len(gear.contacts), 2, 2), np.nan)
    across = np.stack([e_0, e_1], axis=1)
    for n, name in enumerate(gear.contacts):
        contact = gear.result.contact(name)
        views = (contact.view.first_body.name, contact.view.first), (contact.view.second_body.name, contact.view.second)
        first, grid = contact.view.first, contact.view.first.grid
        arc = 0.0 * gear.time if nearest else contact.moments.center[:, 0] / contact.view.first.shape.radius_at(0.0)
        theta = grid.theta_start + grid_theta_offset(first) + grid.pitch * contact.history.center_column + arc
        z = contact.moments.center[:, 1]
        order = 1 if views[0][0] == gear.description["bodies"][0] else -1
        for t in np.flatnonzero(gear.load[:, n] > 0.0):
            theta[t] += contact.places.shift_at(int(t), z[t])
            own, other = (Pose.of(contact.bodies, body, int(t)) for body, _ in views)
            at = own.to_world(np.reshape(first.shape.point(theta[t], z[t]), (1, 3)))
            shape = contact.view.second.shape
            there = other.to_world(np.reshape(shape.point(*shape.chart(other.to_user(at))[:2]), (1, 3)))
            both = np.concatenate([at, there])[::order] - gear.description["centers"][0]
            points[t, n] = both @ across
    s = gear._signs[:, None, None]
    away = points - pitch_point
    along = np.concatenate([np.sin(alpha) + 0.0 * s, -s * np.cos(alpha)], axis=2)  # (n, 1, 2)
    normal = np.concatenate([np.cos(alpha) + 0.0 * s, s * np.sin(alpha)], axis=2)
    return ContactPath(points, np.sum(away * along, axis=-1), np.sum(away * normal, axis=-1))


def film_thickness(
    gear: GearResult, oil: Oil, roughness: float | Sequence[float] | None, speed: float | None,
    thinning: float | None, conductivity: float,
) -> FlankFilms:  # fmt: skip
    """See `GearResult.film_thickness`."""
    label, pair, g = f"gear pair {gear.name!r}: film_thickness", gear.pair, gear.place
    if pair.base_helix_angle:
        raise InputError(f"{label}: the load varies along lines of contact of helical gears; it is for spur gears only")
    both, (w_1, w_2) = combined_roughness(roughness, label), speeds(gear, speed)
    rho_1, rho_2 = pair.pitch_rho[0] + g, pair.pitch_rho[1] - pair.side * g
    touching = (gear.load > 0.0) & (rho_1 > 0.0) & (rho_2 > 0.0)
    rho_1, rho_2 = np.where(touching, rho_1, np.nan), np.where(touching, rho_2, np.nan)
    u, slip = np.abs(0.5 * (w_1 * rho_1 + w_2 * rho_2)), w_1 * rho_1 - w_2 * rho_2
    contacts: list[Any] = [gear.result.contact(name) for name in gear.contacts]
    ends = [np.ptp(contact.cell_lines(0)[1]) if len(gear.time) else np.nan for contact in contacts]
    modulus = contacts[0].effective_modulus
    line, radius = gear.load / np.array(ends), 1.0 / (1.0 / rho_1 + pair.side / rho_2)
    film = film_of_lines(oil, speed=u, line_load=np.where(touching, line, np.nan), radius=radius, modulus=modulus)
    factor: Any = 1.0
    if thinning is not None:
        factor = thermal_factor(
            oil, speed=u, slip=slip, peak_pressure=gear.peak_pressure, modulus=modulus, thinning=thinning,
            conductivity=conductivity,
        )  # fmt: skip
    least = factor * film.minimum
    return FlankFilms(factor * film.central, least, u, slip, least / both, gear.roll_angle)
