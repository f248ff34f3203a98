r"""Profiles of railways: the wheel S1002 and the head of the rail UIC 60.

Wheel S1002 (UIC 510-2; EN 13715). Seen along the axis, s [mm] is counted from the nominal running circle, 70 mm from
the back of the flange, towards the field side, and R = R_0 + F(s):

    A    32.15796 to 60          F = 1.364323640 - 0.066666667 s
    B    -26 to 32.15796         polynomial of degree 8, F(0) = 0
    C    -35 to -26              polynomial of degree 7
    D    -38.426669071 to -35    hollow arc of 13 mm, the root of the flange
    E    -39.764473993 to ...    straight, 70 degrees steep
    F    -49.662510381 to ...    arc of 20.5 less 0.5 mm, G and H of 12 and 20.5 mm, to the back of the flange at -70

The tip of the flange lies at s = -55, 28 mm beyond the running circle. The ten digits of the coefficients of C leave
gaps of 0.04 and 0.12 um at its ends, which a straight line closes.

Rail UIC 60 (60E1 of EN 13674-1). Arcs of 300, 80 and 13 mm follow one another without a kink, up to 10.228 and 26.0265
mm from the middle, and the sides of the head, inclined by 1:20, 72 mm apart.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.polynomial import Polynomial

from warpffrf.model.messages.named_arguments import named_arguments
from warpffrf.model.surfaces.curve import Curve
from warpffrf.model.surfaces.profiled_cylinder import ProfiledCylinder

MM = 1e-3
STEP = np.radians(1.0)  # of an arc per piece: error 1e-9 m at 70 degrees
SAME = 1e-6  # mm: points of two zones that are nearer than that are one
PIECE = 1.0  # mm: of a polynomial per piece

_A = Polynomial([1.364323640, -0.066666667])
_B = Polynomial([0.0, -3.358537058e-2, 1.565681624e-3, -2.810427944e-5, 5.844240864e-8, -1.562379023e-8,
                 5.309217349e-15, -5.957839843e-12, 2.646656573e-13])  # fmt: skip
_C = Polynomial([-4.320221063e3, -1.038384026e3, -1.065501873e2, -6.051367875, -2.054332446e-1, -4.169739389e-3,
                 -4.687195829e-5, -2.252755540e-7])  # fmt: skip
_C_FROM, _C_TO, _B_TO, _A_TO = -35.0, -26.0, 32.15796, 60.0
# Arcs from s to s: (s and F of the centre, radius) [mm], the last negative of a hollow one
_H = (-69.0, -62.764705882, -49.5, 9.519259302, 20.5)
_G = (-62.764705882, -49.662510381, -55.0, 16.0, 12.0)
_F = (-49.662510381, -39.764473993, -58.558326413, 8.834924130, 20.0)
_D = (-38.426669071, _C_FROM, -26.210665, 16.446, -13.0)

RAIL_RADII = (300.0, 80.0, 13.0)  # mm
RAIL_ENDS = (10.228, 26.0265)  # mm from the middle: of the arcs of 300 and 80 mm
RAIL_SIDE, RAIL_DEPTH = 20.0, 30.0  # inclination 1:20 of the sides; mm below the top at which they end


@named_arguments
def wheel_s1002(
    *,
    radius: float | None = None,
    axis_point: Any = None,
    axis_direction: Any = None,
    fit_tolerance: float | None = None,
) -> ProfiledCylinder:
    """The tread and flange of a wheel with the profile S1002 (EN 13715), flange height 28 mm, thickness 32.5 mm.

    radius [m] of the nominal running circle, at axis_point (3,) [m], 70 mm from the back of the flange. axis_direction
    (3,) points away from the flange, to the field side; both in the user frame of the body. The profile reaches from
    -69 mm, on the far side of the flange, where it is 72 degrees steep, to 60 mm. Parameters that are None are fitted
    to the nodes, within fit_tolerance [m], as of a `ProfiledCylinder`.

    >>> tread = wf.surfaces.wheel_s1002(radius=0.46, axis_point=(0, 0, 0), axis_direction=(0, 1, 0))
    >>> f"{1e3 * (tread.radius_at(-0.055) - 0.46):.3f} mm"  # the tip of the flange
    '28.000 mm'
    """
    zones = [_arc(*_H), _arc(*_G), _arc(*_F), _arc(*_D), _root()]
    zones += [_polynomial(_B, _C_TO, _B_TO), _polynomial(_A, _B_TO, _A_TO)]
    s, f, slope = np.concatenate(zones, axis=1)
    first = np.append(True, np.diff(s) > SAME)  # of two zones that meet
    table = (MM * s[first], -MM * f[first], -slope[first])
    return ProfiledCylinder(
        radius=radius, table=table, axis_point=axis_point, axis_direction=axis_direction, fit_tolerance=fit_tolerance
    )


@named_arguments
def rail_uic60() -> Curve:
    """The section of the head of a rail UIC 60, 60E1 of EN 13674-1, for `Extruded`: x across, y upwards, the origin in
    the middle of the top, the sides down to 30 mm below it.

    With `axis_direction` (1, 0, 0) along the track and z upwards, x_direction (0, 40, 1) inclines a rail at y > 0 by
    1:40 towards the middle of the track, (0, 40, -1) one at y < 0.

    >>> head = wf.surfaces.rail_uic60()
    >>> rail = wf.surfaces.Extruded(curve=head, axis_direction=(1, 0, 0), x_direction=(0, 40, 1))
    >>> f"{1e3 * head.extent:.2f} mm"
    '73.57 mm'
    """
    return head_of_arcs(RAIL_ENDS)


def head_of_arcs(ends: tuple[float, float]) -> Curve:
    """A rail's head of arcs of 300, 80 and 13 mm, of which the first two end at `ends` [mm] from the middle."""
    angles, center = [0.0], 0.0  # from the vertical; x of the centre of the next arc
    for R, inner, end in zip(RAIL_RADII, RAIL_RADII[1:], ends, strict=False):
        angles.append(float(np.arcsin((end - center) / R)))
        center += (R - inner) * np.sin(angles[-1])
    angles.append(float(np.arctan(RAIL_SIDE)))
    arcs = [(R * (b - a), R) for R, a, b in zip(RAIL_RADII, angles, angles[1:], strict=False)]
    fall = sum(R * (np.cos(a) - np.cos(b)) for R, a, b in zip(RAIL_RADII, angles, angles[1:], strict=False))
    side = (RAIL_DEPTH - fall) / np.sin(angles[-1])
    x = center + RAIL_RADII[-1] * np.sin(angles[-1]) + side * np.cos(angles[-1])
    pieces = [(side, np.inf), *reversed(arcs), *arcs, (side, np.inf)]
    start = MM * np.array([x, -RAIL_DEPTH])
    return Curve.arcs(start, np.pi - angles[-1], [(MM * length, MM * R) for length, R in pieces])


def _arc(start: float, end: float, s_0: float, f_0: float, radius: float) -> np.ndarray:
    """s, F and slope (3, n) of an arc, at equal angles."""
    first, last = (np.arcsin((s - s_0) / radius) for s in (start, end))
    angle = np.linspace(first, last, int(np.ceil(abs(last - first) / STEP)) + 1)
    return np.stack([s_0 + radius * np.sin(angle), f_0 + radius * np.cos(angle), -np.tan(angle)])


def _polynomial(zone: Polynomial, start: float, end: float) -> np.ndarray:
    """s, F and slope (3, n) of a polynomial."""
    s = np.linspace(start, end, int(np.ceil((end - start) / PIECE)) + 1)
    return np.stack([s, zone(s), zone.deriv()(s)])


def _root() -> np.ndarray:
    """Zone C, its ends on those of D and B."""
    gaps = [_arc(*_D)[1, -1] - _C(_C_FROM), _B(_C_TO) - _C(_C_TO)]
    line = Polynomial.fit([_C_FROM, _C_TO], gaps, 1).convert()
    return _polynomial(_C + line, _C_FROM, _C_TO)
