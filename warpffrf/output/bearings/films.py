r"""Film thickness of the rolling contacts of a run, by formula (`model.bearings.lubrication`).

**Entrainment.** With the unit vector n from an element to the raceway at the contact angle, the point of contact p is
D/2 n from the centre of the element, and moves with it about the axis of the outer ring at the orbital speed w_c. The
surfaces there have the velocities v_1 and v_2 of element and ring in the world, and around the axis the film is drawn
in with

    u = e_t . ((v_1 + v_2)/2 - w_c e_a x (p - c)),      slip = e_t . (v_1 - v_2),

whatever the rings' speeds. Balls are point contacts with the curvatures at their contact angle, rollers line contacts
with their mean load per length.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from warpffrf.model.bearings.geometry import SIDES, BallGeometry
from warpffrf.model.bearings.lubrication import film_of_lines, film_of_points, starved, thermal_factor
from warpffrf.model.errors import InputError, require_number
from warpffrf.model.oils import Oil
from warpffrf.output.bearings.patches import ball_patches, roller_patches


@dataclass(frozen=True)
class Films:
    """Films of all elements on one raceway, or of all pairs of teeth (T, Z), nan without a load: thickness [m] at the
    centre and its least value, entrainment and slip speed [m/s] around the axis, of teeth along the flank, and the film
    parameter [-], Lambda, the least thickness over the roughness of both surfaces together; nan where not given."""

    central: np.ndarray
    minimum: np.ndarray
    entrainment: np.ndarray
    slip: np.ndarray
    parameter: np.ndarray


def entrainment(bearing: Any, side: str) -> tuple[np.ndarray, np.ndarray]:
    """Entrainment and slip speed (T, Z) [m/s] around the axis; nan without a load."""
    sign = 1.0 if side == "outer" else -1.0
    angle = bearing._angles(side)
    axes = bearing._element_axes  # outward, around, along
    n = sign * (np.cos(angle)[..., None] * axes[:, :, 0] + np.sin(angle)[..., None] * axes[:, :, 2])
    arm = 0.5 * bearing.geometry.diameter * n
    bodies = [bearing.history.bodies[name] for name in bearing.elements]
    at = np.stack([body.position for body in bodies], axis=1) + arm
    spin = np.stack([body.angular_velocity for body in bodies], axis=1)
    first = np.stack([body.velocity for body in bodies], axis=1) + np.cross(spin, arm)
    ring = bearing._body(bearing.description[side])
    second = np.zeros_like(first)
    if ring is not None:
        second = ring.velocity[:, None] + np.cross(ring.angular_velocity[:, None], at - ring.position[:, None])
    center, moved = bearing.center[:, None], bearing._carried_velocity(bearing.description["outer"])[:, None]
    point = moved + np.cross(bearing.orbit_speed[..., None] * axes[:, :, 2], at - center)
    around = axes[:, :, 1]
    return (
        np.abs(np.einsum("tzi,tzi->tz", 0.5 * (first + second) - point, around)),
        np.einsum("tzi,tzi->tz", first - second, around),
    )


def combined_roughness(roughness: float | Sequence[float] | None, label: str) -> float:
    """Rq [m] of both surfaces together, nan where None; raises `InputError` naming `label`."""
    if roughness is None:
        return np.nan
    heights = [require_number(Rq, f"{label}: roughness [m]", non_negative=True) for Rq in np.atleast_1d(roughness)]
    both = float(np.linalg.norm(heights))
    if both <= 0.0:
        raise InputError(f"{label}: roughness [m] is zero; give the Rq of both surfaces, or None")
    return both


def film_thickness(
    bearing: Any, oil: Oil, roughness: float | Sequence[float] | None, thinning: float | None, conductivity: float,
    inlet: float | None,
) -> dict[str, Films]:  # fmt: skip
    """See `BearingResult.film_thickness`."""
    label = f"bearing {bearing.name!r}: film_thickness"
    both = combined_roughness(roughness, label)
    geometry, modulus, found = bearing.geometry, bearing._modulus, {}
    if inlet is not None and not isinstance(geometry, BallGeometry):
        raise InputError(f"{label}: inlet is for balls, the formula of starvation is that of points; leave it out")
    for side in SIDES:
        u, slip = entrainment(bearing, side)
        angle, load = bearing._angles(side), bearing._loads(side)
        load = np.where(np.isnan(angle), np.nan, load)
        if isinstance(geometry, BallGeometry):
            patches = ball_patches(geometry, side, np.nan_to_num(load), np.nan_to_num(angle), modulus)
            b = np.where(patches.half_axis_around > 0.0, patches.half_axis_around, np.nan)
            R = 1.0 / geometry.curvatures(side, angle)[1]
            film = film_of_points(
                oil, speed=u, load=load, radius=R, ratio=patches.half_axis_across / b, modulus=modulus
            )  # fmt: skip
            if inlet is not None:
                film = starved(film, inlet=inlet, half_axis=b, radius=R)
        else:
            line = load / geometry.roller_length
            patches = roller_patches(geometry, side, np.nan_to_num(load)[..., None], modulus)
            film = film_of_lines(oil, speed=u, line_load=line, radius=1.0 / geometry.curvature(side), modulus=modulus)
        factor: Any = 1.0
        if thinning is not None:
            factor = thermal_factor(
                oil, speed=u, slip=slip, peak_pressure=patches.peak_pressure, modulus=modulus, thinning=thinning,
                conductivity=conductivity,
            )  # fmt: skip
        least = factor * film.minimum
        found[side] = Films(factor * film.central, least, u, slip, least / both)
    return found
