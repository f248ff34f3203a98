r"""Cams: the section whose follower moves by a law.

A follower moves along a line through the axis of the cam; its lift is s(phi), phi the angle of the cam's own polar
coordinates, counter-clockwise. On the base circle s = 0. With r = r_0 + s, of a *roller* of radius r_f its centre runs
on the pitch curve, relative to the cam

    p = (r_f + r) e_r,        p' = s' e_r + (r_f + r) e_phi,        c = p - r_f n,        n = (p'_y, -p'_x)/|p'|,

and c' = (1 - r_f kappa_p) p', kappa_p the curvature of p. Of a *flat* face across the line of motion

    c = r e_r + s' e_phi,        c' = (r + s'') e_phi.

A factor of p', or r + s'', that is not positive is an undercut: the follower would cut off part of the curve that other
places need. The curve is exact at its knots in point and tangent; the arc length between them is by Gauss's rule.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from warpffrf.model import signals
from warpffrf.model.errors import InputError, require_number
from warpffrf.model.messages.named_arguments import named_arguments
from warpffrf.model.surfaces.curve import Curve

COUNT = 720  # knots, half a degree apart; pieces end at those of the law too
SAME = 1e-9  # rad: knots nearer than that are one, and values of a turn's ends relative to the base radius
GAUSS = 8  # points of Gauss's rule between two knots


@named_arguments
def cam(lift: Any, *, base_radius: float, roller_radius: float | None = None) -> Curve:
    """The section of a cam that moves its follower along a line through its axis by `lift`.

    lift: a signal (any of `warpffrf.signals`) of the angle phi [rad] of the cam's polar coordinates from x towards y,
    for one turn from 0 to 2 pi, in metres above the base circle. base_radius [m]: of the cam. roller_radius [m]: of
    the follower; None for a flat face across the line of motion. Where the cam rotates by an angle alpha about its
    axis, the follower at the polar angle beta is lifted by lift(beta - alpha). Raises `InputError` where the lift does
    not return to its value after one turn, and where the follower undercuts the cam.

    >>> import numpy as np
    >>> lift = wf.signals.Table([0.0, 1.0, 2.0, 3.0, 2 * np.pi], [0.0, 2e-3, 2e-3, 0.0, 0.0], cubic=True)
    >>> section = wf.surfaces.cam(lift, base_radius=0.02, roller_radius=0.008)
    >>> f"{section.extent:.4f} m"
    '0.0419 m'
    """
    from scipy.interpolate import PPoly

    r_0 = require_number(base_radius, "cam: base_radius", positive=True)
    r_f = None if roller_radius is None else require_number(roller_radius, "cam: roller_radius", positive=True)
    breaks, c = signals.require_fixed(signals.as_signal(lift, "cam: lift"), "cam: lift").polynomial()
    law = PPoly(c[:, ::-1].T, breaks)
    turn = 2.0 * np.pi
    own = breaks[(breaks > SAME) & (breaks < turn - SAME)]
    phi = np.sort(np.concatenate([turn * np.arange(COUNT + 1) / COUNT, own]))
    phi = phi[np.append(True, np.diff(phi) > SAME)]
    phi[-1] = turn

    def lifted(at: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """s, s' and s''; the values at both ends hold beyond them."""
        inside = (at >= breaks[0]) & (at <= breaks[-1])
        near = np.clip(at, breaks[0], breaks[-1])
        return law(near), np.where(inside, law(near, 1), 0.0), np.where(inside, law(near, 2), 0.0)

    def speed(at: np.ndarray) -> np.ndarray:
        """|c'| per angle, with a sign: negative of an undercut."""
        s, ds, dds = lifted(at)
        if r_f is None:
            return r_0 + s + dds
        r = r_f + r_0 + s
        square = r**2 + ds**2
        return np.sqrt(square) * (1.0 - r_f * (r**2 + 2.0 * ds**2 - r * dds) / square**1.5)

    s, ds, _ = lifted(phi)
    if max(abs(s[-1] - s[0]), abs(ds[-1] - ds[0])) > 1e3 * SAME * r_0:
        raise InputError(
            f"cam: the lift must return to its value and slope after one turn, it is {s[0]:.6g} m with "
            f"{ds[0]:.3g} m/rad at 0 and {s[-1]:.6g} m with {ds[-1]:.3g} m/rad at 2 pi"
        )
    x, weight = np.polynomial.legendre.leggauss(GAUSS)
    half = 0.5 * np.diff(phi)
    rates = speed(phi[:-1, None] + half[:, None] * (x + 1.0))
    if np.any(rates <= 0.0):
        at = phi[np.argmin(rates.min(axis=1))]
        cure = "a larger base_radius or a gentler lift" + ("" if r_f is None else ", or a smaller roller_radius")
        raise InputError(f"cam: the follower undercuts the cam at {at:.3g} rad; take {cure}")
    e_r = np.stack([np.cos(phi), np.sin(phi)], axis=1)
    e_phi = np.stack([-e_r[:, 1], e_r[:, 0]], axis=1)
    if r_f is None:
        tangents = e_phi
        points = (r_0 + s)[:, None] * e_r + ds[:, None] * e_phi
    else:
        r = (r_f + r_0 + s)[:, None]
        tangents = ds[:, None] * e_r + r * e_phi
        tangents /= np.linalg.norm(tangents, axis=1, keepdims=True)
        points = r * e_r - r_f * np.stack([tangents[:, 1], -tangents[:, 0]], axis=1)
    points[-1], tangents[-1] = points[0], tangents[0]
    knots = np.concatenate([[0.0], np.cumsum(half * (rates @ weight))])
    return Curve(knots=knots, points=points, tangents=tangents, closed=True)
