r"""A rigid wheelset on two rigid rails: where they touch, by brute force.

The rails lie along x at y > 0 and y < 0, z upwards. A rail is extruded along x, so that the normal where a wheel
touches it has no component along x. With the axis a of the wheelset, rolled by phi about x and yawed by psi about z,
the normal of a wheel at s along the axis, of the radius R and the slope R', is along e_r - R' a, e_r across a: its x
vanishes at

    cos(theta) = R' a_x/sqrt(1 - a_x^2),

theta from the direction of greatest x across a. These points, one for each s, are the outline of the wheel seen along
the track; wheel and rail touch where the vertical distance of outline and section is least. With the roll that makes
these distances equal, both wheels touch.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.optimize import brentq

Array = np.ndarray
GAUGE, GAUGE_DEPTH = 1.435, 14e-3  # m; below the top of the inclined rail
RUNNING_CIRCLE = 0.75  # m from the middle of the axle: 1,360 mm between the flanges' backs, 70 mm on each side
SAMPLES = 20001  # of a wheel's profile, 6 um, and of a rail's section
ROLL = 0.05  # rad, bound


@dataclass(frozen=True)
class Benchmark:
    """A wheel of case A-2.2 of the Manchester Contact Benchmark (P. Shackleton and S. Iwnicki, Vehicle System Dynamics
    46 (2008) 129): S1002 of radius 460 mm on UIC 60, 10 kN on a wheel, by CONTACT (E. A. H. Vollebregt, open program,
    examples mbench_a22_left and _right). side: 1 where the wheelset moves towards the rail, -1 on the other one; y
    [mm], yaw [mrad] and roll [rad] of the wheelset; the contact angle [rad], normal force [N], largest pressure [MPa],
    and the centre of the patch: s [mm] of the wheel's profile, y [mm] across the track.
    """

    side: int
    y: float
    yaw: float
    roll: float
    angle: float
    force: float
    peak: float
    s: float
    across: float

    @property
    def pose(self) -> tuple[float, float, float]:
        """y [m], roll and yaw [rad], mirrored for the other wheel, so that the wheel is at y > 0."""
        return self.side * 1e-3 * self.y, self.side * self.roll, self.side * 1e-3 * self.yaw

    @property
    def load(self) -> float:
        """The vertical part of the normal force [N]: friction carries the rest of 10 kN."""
        return self.force * float(np.cos(self.angle))


# The benchmark's rail: arcs of 300 and 80 mm end at 10.500 and 25.986 mm, as its 495 points, to 2e-5 mm
BENCHMARK_ENDS = (10.500, 25.986)
BENCHMARK = {
    "two places": (
        Benchmark(1, 0.0, 0.0, 0.0, 0.0290, 9997.0, 338.3, 1.8726, 751.8726),
        Benchmark(1, 0.5, 1.2, 2.304e-5, 0.0568, 9870.0, 632.5, -6.0075, 744.5026),
        Benchmark(1, 5.0, 12.0, 3.554e-4, 0.2905, 9619.0, 1556.0, -28.0471, 727.0855),
    ),
    "tread": (
        Benchmark(-1, 2.0, 4.8, 1.128e-4, 0.0134, 10040.0, 465.9, 8.5660, 756.5056),
        Benchmark(-1, 4.0, 9.6, 2.557e-4, 0.0096, 10030.0, 527.2, 11.8167, 757.6645),
        Benchmark(-1, 6.0, 14.4, 6.272e-4, 0.0084, 10020.0, 578.5, 14.3878, 758.0210),
        Benchmark(-1, 8.0, 19.2, 8.606e-3, 0.0077, 10020.0, 701.1, 20.3458, 758.2223),
        Benchmark(1, 3.5, 8.4, 2.168e-4, 0.0994, 9760.0, 691.6, -14.1700, 739.4071),
        Benchmark(1, 4.5, 10.8, 2.977e-4, 0.1185, 9726.0, 625.5, -16.7104, 737.8905),
    ),
    "flange": (
        Benchmark(1, 6.0, 14.4, 6.272e-4, 0.4176, 9709.0, 1149.0, -31.1222, 725.1371),
        Benchmark(1, 7.0, 16.8, 6.393e-3, 1.0634, 14030.0, 2622.0, -41.1389, 719.0445),
        Benchmark(1, 8.5, 20.4, 9.408e-3, 0.9065, 12310.0, 2638.0, -42.9279, 720.1709),
    ),
}


@dataclass(frozen=True)
class Touch:
    """Where a wheel touches its rail: s [m] of its profile, y [m] across the track, the radius [m], the contact angle
    [rad] from the horizontal, and its height above the rail, of its centre [m]."""

    s: float
    y: float
    radius: float
    angle: float
    height: float


class Wheelset:
    """Two wheels of a `shape` with a table, s away from the flange, on rails of a section (n, 2) [m] with y to the
    field side, inclined by 1:`inclination`, at the gauge of 1,435 mm."""

    def __init__(self, shape: Any, section: Any, inclination: float = 40.0) -> None:
        self.s = np.linspace(shape.table[0, 0], shape.table[0, -1], SAMPLES)
        self.R, self.slope = shape.radius_at(self.s), shape.slope_at(self.s)
        upright, lean = np.array([inclination, 1.0]) / np.hypot(inclination, 1.0)
        points = section.at(np.linspace(0.0, section.length, SAMPLES))[::-1] @ [[upright, lean], [-lean, upright]]
        top = int(np.argmax(points[:, 1]))
        self.top = float(points[top, 1])  # above the origin of the section
        face = np.interp(self.top - GAUGE_DEPTH, points[:top, 1], points[:top, 0])
        self.rail_at = float(0.5 * GAUGE - face)  # y of the origin of the section
        self.rail = points[:, 0] + self.rail_at, points[:, 1] - self.top

    def touch(self, side: int, y: float, roll: float, yaw: float) -> Touch:
        """The wheel at y > 0 (`side` 1) or y < 0 (-1) of a wheelset moved by y, that at y > 0 raised by the roll."""
        a = np.array([-np.sin(yaw) * np.cos(roll), np.cos(yaw) * np.cos(roll), np.sin(roll)])
        ahead = np.array([1.0, 0.0, 0.0]) - a[0] * a
        ahead /= np.linalg.norm(ahead)
        cosine = side * self.slope * a[0] / np.sqrt(1.0 - a[0] ** 2)
        radial = cosine[:, None] * ahead + np.sqrt(1.0 - cosine**2)[:, None] * np.cross(ahead, a) * -1.0
        outline = side * (RUNNING_CIRCLE + self.s)[:, None] * a + self.R[:, None] * radial
        across = side * (outline[:, 1] + y)
        gap = outline[:, 2] - np.interp(across, *self.rail, left=-1.0, right=-1.0)
        i = int(np.argmin(gap))
        rise = np.diff(np.interp(across[i] + np.array([-1e-6, 1e-6]), *self.rail))[0] / 2e-6
        return Touch(
            float(self.s[i]), float(side * across[i]), float(self.R[i]), float(np.arctan(rise)), -float(gap[i])
        )

    def roll(self, y: float, yaw: float = 0.0) -> float:
        """The roll [rad] with which both wheels touch."""

        def uneven(roll: float) -> float:
            return self.touch(1, y, roll, yaw).height - self.touch(-1, y, roll, yaw).height

        return float(brentq(uneven, -ROLL, ROLL, xtol=1e-12))  # pyright: ignore[reportArgumentType]
