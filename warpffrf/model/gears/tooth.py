r"""The section of one tooth: root land, fillet, involute with tip relief, tip rounding and tip land.

Polar coordinates (r, theta) about the axis of the gear with unit vectors e_r, e_theta, the tooth about theta = 0.
sigma = 1 for external and -1 for internal gears. The right flank runs from root to tip with the material to its left.

Involute. With the base radius r_b, the distance rho = r_b xi from the base circle along the tangent to it (xi the roll
angle), and C(rho) the relief, which is removed along the normal,

    c(rho) = r_b e_r(phi) - g e_theta(phi),    phi = theta_b + rho/r_b,    g = rho - sigma C,
    c' = (g/r_b) e_r + sigma C' e_theta,       theta_b = -sigma s/(2 r) - inv alpha,

s the tooth thickness at the reference radius r. A point at radius R has g^2 = R^2 - r_b^2.

Relief. C = C_a f(tau)/cos beta_b in the transverse section, tau = 1 - sigma (rho_a - rho)/L from its start to the tip
circle, rho_a of the tip circle without relief: f = tau^2 (parabolic), or a line that begins with a parabola, so that
the flank has no kink: f = tau^2/(2 w (1 - w/2)) up to tau = w, then (tau - w/2)/(1 - w/2).

Fillet of an external gear. The rack's tip arc has its centre at the depth d_c below its pitch line and at xi_c from the
middle of its tooth. In the transverse section of a helical gear it is the arc of an ellipse with the half-axes A =
rho_f/cos beta along the pitch line and B = rho_f, its point with the normal (cos psi, sin psi) at

    p = (A^2 cos psi, B^2 sin psi)/h,      h^2 = A^2 cos^2 psi + B^2 sin^2 psi,      p' = R (-sin psi, cos psi),
    R = A^2 B^2/h^3.

This point, psi from alpha_t at the flank to pi/2 at the root, touches the gear where its normal meets the pitch point.
The centre of the arc is then at u = (d_c + p_2) cot psi - p_1 from it, the gear has rotated by w/r with w = u - xi_c,
and relative to the gear

    c(psi) = Y e_r(phi) + X e_theta(phi),     X = u + p_1,     Y = r - d_c - p_2,
    phi = -pi/z - w/r,                        tangent: cos psi e_r(phi) + sin psi e_theta(phi).

(DIN 3960; Colbourne 1987, The Geometry of Involute Gears.) The fillet of an internal gear, which depends on its cutter,
is an arc that touches flank and root circle. An arc of signed radius R that starts in a point of the flank and ends on
a circle about the axis has its centre on the parallel curve of the flank.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np

from warpffrf.model.surfaces.curve import Curve

if TYPE_CHECKING:
    from warpffrf.model.gears.gear import Gear

Array = np.ndarray
Path = Callable[
    [Array], tuple[Array, Array, Array]
]  # parameter (n,) -> points (n, 2), unit tangents (n, 2), speeds (n,)
Pieces = tuple[Array, Array, Array]  # lengths (n,), points (n + 1, 2), tangents (n + 1, 2)

FLANK = (0.02, 2e-11)  # rad: largest angle of a piece, curvatures are exact to 3e-5; m: error in its middle
OTHERS = (0.05, 5e-10)  # of fillets, roundings and lands
FOOT_STEPS = 3  # Newton's method for it
RELIEF_STEPS = 20  # of a fixed-point iteration, each gains the factor C', some thousandths
GAUSS = 8  # points of Gauss's rule between two knots
BLEND = 0.1  # w, of the length of a linear relief


def polar(phi: Array | float, along: Array | float, across: Array | float) -> Array:
    """along e_r(phi) + across e_theta(phi), (..., 2)."""
    c, s = np.cos(phi), np.sin(phi)
    return np.stack([along * c - across * s, along * s + across * c], axis=-1)


def relief(gear: Gear, rho: Array) -> tuple[Array, Array]:
    """C [m] and its derivative by rho [-] at distances rho (n,) [m]."""
    if not gear.tip_relief:
        return np.zeros_like(rho), np.zeros_like(rho)
    tau = np.maximum(1.0 - gear.side * (gear.tip_rho - rho) / gear.tip_relief_length, 0.0)
    if gear.tip_relief_shape == "parabolic":
        f, slope = tau**2, 2.0 * tau
    else:
        rise = 1.0 / (1.0 - 0.5 * BLEND)
        f = rise * np.where(tau < BLEND, 0.5 * tau**2 / BLEND, tau - 0.5 * BLEND)
        slope = rise * np.minimum(tau / BLEND, 1.0)
    C_a = gear.tip_relief / np.cos(gear.base_helix_angle)
    return C_a * f, gear.side * C_a / gear.tip_relief_length * slope


def involute(gear: Gear) -> Path:
    """The right flank over sigma rho [m], from root to tip."""

    def path(t: Array) -> tuple[Array, Array, Array]:
        rho = gear.side * t
        C, slope = relief(gear, rho)
        phi, g, r_b = gear.base_angle + rho / gear.base_radius, rho - gear.side * C, gear.base_radius
        speed = np.hypot(g / r_b, slope)
        return polar(phi, r_b, -g), polar(phi, gear.side * g / r_b / speed, slope / speed), speed

    return path


def reach(gear: Gear, radius: float) -> float:
    """g = sqrt(R^2 - r_b^2) [m] at a radius R [m], 0 within the base circle."""
    return float(np.sqrt(max(radius**2 - gear.base_radius**2, 0.0)))


def rho_at(gear: Gear, radius: float) -> float:
    """rho [m] of the flank, with its relief, at a radius [m]."""
    rho = g = reach(gear, radius)
    for _ in range(RELIEF_STEPS):
        rho = g + gear.side * float(relief(gear, np.array(rho))[0])
    return rho


def rho_of_arc(gear: Gear, offset: float, radius: float, low: float, high: float) -> float | None:
    """rho [m], between low and high, of the point of the flank whose distance `offset` [m] along the normal leads to a
    circle of `radius` [m] about the axis; None where there is none."""
    from scipy.optimize import brentq

    path = involute(gear)

    def miss(rho: float) -> float:
        point, t, _ = path(np.array(gear.side * rho))
        return float(np.hypot(*(point + offset * np.array([t[1], -t[0]])))) - radius

    if miss(low) * miss(high) > 0.0:
        return None
    return float(brentq(miss, low, high, xtol=1e-15))  # pyright: ignore[reportArgumentType]


def tool_arc(gear: Gear, psi: Array) -> tuple[Array, Array]:
    """p (..., 2) and R (...) [m] of the rack's tip arc at inclinations psi (...) [rad] of its normal."""
    B = gear.root_radius * gear.module
    A, c, s = B / np.cos(gear.helix_angle), np.cos(psi), np.sin(psi)
    h = np.hypot(A * c, B * s)
    return np.stack([A**2 * c / h, B**2 * s / h], axis=-1), A**2 * B**2 / h**3


def trochoid(gear: Gear) -> Path:
    """The right fillet of an external gear over -psi [rad], from root to flank."""
    r, d_c, xi_c = 0.5 * gear.reference_diameter, *gear.tool_center

    def path(t: Array) -> tuple[Array, Array, Array]:
        psi = -t
        p, R = tool_arc(gear, psi)
        depth = d_c + p[..., 1]
        X, Y = depth / np.tan(psi), r - depth
        u, du = X - p[..., 0], R / np.sin(psi) - depth / np.sin(psi) ** 2
        phi = -np.pi / gear.teeth - (u - xi_c) / r
        along = -R * np.cos(psi) + X * du / r  # dc/dpsi
        across = du - R * np.sin(psi) - Y * du / r
        speed = -(along * np.cos(psi) + across * np.sin(psi))
        return polar(phi, Y, X), polar(phi, np.cos(psi), np.sin(psi)), speed

    return path


def arc(center: Array, radius: float, heading: float) -> Path:
    """An arc over its length [m], its first tangent at the angle `heading`; a positive radius turns to the left."""

    def path(t: Array) -> tuple[Array, Array, Array]:
        tangent = polar(heading + t / radius, 1.0, 0.0)
        return center + radius * np.stack([tangent[:, 1], -tangent[:, 0]], axis=1), tangent, np.ones_like(t)

    return path


def pieces(path: Path, start: float, end: float, angle: float, fineness: tuple[float, float] = FLANK) -> Pieces:
    """Knots on a path between two parameters, whose direction changes by `angle` [rad], at the `fineness`: the
    largest angle [rad] of a piece, and how far [m] its middle may be off the path."""
    step, error = fineness
    t = np.linspace(start, end, max(int(np.ceil(abs(angle) / step)), 1) + 1)
    x, weight = np.polynomial.legendre.leggauss(GAUSS)
    while True:
        half = 0.5 * np.diff(t)
        places = t[:-1, None] + half[:, None] * (x + 1.0)
        lengths = half * (path(places.ravel())[2].reshape(places.shape) @ weight)
        points, tangents, _ = path(t)
        middles = 0.5 * (points[:-1] + points[1:]) + 0.125 * lengths[:, None] * (tangents[:-1] - tangents[1:])
        at = 0.5 * (t[:-1] + t[1:])
        for _ in range(FOOT_STEPS):
            point, tangent, speed = path(at)
            at = at + np.sum((middles - point) * tangent, axis=1) / speed
        point, tangent, _ = path(at)
        miss = np.abs(np.sum((middles - point)[:, ::-1] * tangent * [1.0, -1.0], axis=1))
        if np.all(miss < error):
            return lengths, points, tangents
        t = np.sort(np.concatenate([t, 0.5 * (t[:-1] + t[1:])[miss >= error]]))


def joined(parts: list[Pieces]) -> Pieces:
    """Parts that continue one another."""
    first, *others = parts
    points = np.concatenate([first[1], *(part[1][1:] for part in others)])
    tangents = np.concatenate([first[2], *(part[2][1:] for part in others)])
    return np.concatenate([part[0] for part in parts]), points, tangents


def mirrored(part: Pieces) -> Pieces:
    """The mirror image of a part of the right flank on the left one, the material to its left again."""
    lengths, points, tangents = part
    return lengths[::-1], (points * [1.0, -1.0])[::-1], (tangents * [-1.0, 1.0])[::-1]


def rotated(part: Pieces, angle: float) -> Pieces:
    c, s = np.cos(angle), np.sin(angle)
    R = np.array([[c, s], [-s, c]])  # rows
    return part[0], part[1] @ R, part[2] @ R


def curve(part: Pieces, *, closed: bool = False, depth: float | None = None) -> Curve:
    lengths, points, tangents = part
    if closed:
        points[-1], tangents[-1] = points[0], tangents[0]
    knots = np.concatenate([[0.0], np.cumsum(lengths)])
    return Curve(knots=knots, points=points, tangents=tangents, closed=closed, depth=depth)


def angle_of(vector: Array) -> float:
    return float(np.arctan2(vector[1], vector[0]))


def right_half(gear: Gear) -> dict[str, Pieces]:
    """The parts of half a tooth, from the middle of the root to that of the tip: "root", "fillet", "involute",
    "rounding" and "tip", those that it has, in this order."""
    sign, origin = gear.side, np.zeros(2)
    path, middle = involute(gear), -sign * np.pi / gear.teeth
    found: dict[str, Pieces] = {}

    def land(name: str, diameter: float, first: float, last: float) -> None:
        angle = sign * (last - first)
        if angle > 0.0:
            R = 0.5 * diameter
            found[name] = pieces(arc(origin, sign * R, first + 0.5 * sign * np.pi), 0.0, R * angle, angle, OTHERS)

    start, end = gear.root_form_rho, gear.tip_form_rho
    if gear.internal:
        R = gear.root_radius * gear.module
        point, tangent, _ = path(np.array(sign * start))
        center = point + R * np.array([tangent[1], -tangent[0]])
        land("root", gear.root_diameter, middle, angle_of(center))
        heading = angle_of(center) - 0.5 * np.pi
        angle = np.remainder(heading - angle_of(tangent), 2.0 * np.pi)
        found["fillet"] = pieces(arc(center, -R, heading), 0.0, R * angle, angle, OTHERS)
    else:
        land("root", gear.root_diameter, middle, middle + gear.tool_center[1] / (0.5 * gear.reference_diameter))
        alpha = gear.transverse_pressure_angle
        rolled = gear.tool_center[0] / np.tan(alpha) / (0.5 * gear.reference_diameter)
        found["fillet"] = pieces(trochoid(gear), -0.5 * np.pi, -alpha, 0.5 * np.pi - alpha + abs(rolled), OTHERS)
    breaks = np.array([start, end])  # of the curvature
    if gear.tip_relief:
        begin = gear.tip_rho - sign * gear.tip_relief_length * np.array([1.0, 1.0 - BLEND])
        breaks = np.concatenate([breaks, begin[: 1 if gear.tip_relief_shape == "parabolic" else 2]])
    breaks = np.unique(sign * np.clip(breaks, min(start, end), max(start, end)))
    flank = [pieces(path, a, b, (b - a) / gear.base_radius) for a, b in zip(breaks[:-1], breaks[1:], strict=True)]
    found["involute"] = joined(flank)
    point, tangent, _ = path(np.array(sign * end))
    if gear.tip_rounding:
        R = gear.tip_rounding
        center = point - R * np.array([tangent[1], -tangent[0]])
        heading = angle_of(tangent)
        angle = np.remainder(angle_of(center) + 0.5 * sign * np.pi - heading, 2.0 * np.pi)
        found["rounding"] = pieces(arc(center, R, heading), 0.0, R * angle, angle, OTHERS)
        point = center
    land("tip", gear.tip_diameter, angle_of(point), 0.0)
    return found
