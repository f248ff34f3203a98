r"""What pressures do that are not along the normal of the undeformed surface: the compliance of slopes.

Pressure acts along the normal of the deformed surface, and the gap opens along it. Where that normal leans from the
undeformed one by the angle G, towards the middle of the patch, a pressure p at the arc position x loads the body by
-p (n - G t) and its gap moves by -u.(n - G t), with t = e_theta and, of a narrow patch,

    G = kappa (x - x_c),

kappa the difference of the curvatures of the deformed and the undeformed surface. To first order in G the compliance
between two hats is

    D_ij - G_i D^t_ij - G_j D^t_ji,          D^t_ij: displacement along t at hat i under a normal load on hat j.

Sideways displacement is odd: on a body of revolution D^t_ji = -D^t_ij. Then the middle x_c drops out,

    D_ij - kappa (x_i - x_j) D^t_ij = D_ij + kappa R S_ij,          S_ij = -(theta_i - theta_j) (D^t_ij - D^t_ji)/2,

which turns with the body as D does: nothing but the table of the compliance changes. S is kept of bodies so soft that
a patch can be a noticeable part of the radius (`SOFT`); kappa follows from the partner
(`warpffrf.model.reduced.slopes`). Of other bodies the even part of D^t is left out. On a rigid plane kappa R = 1.
Second order, G_i G_j D^tt and what the cosines of G make, is up to 0.7 (b/R*)^2 of the line load, b the half-width, R*
the relative radius (tests/verification/test_rubber_cover.py).
"""

from __future__ import annotations

import numpy as np

from warpffrf.model.material import Material

Array = np.ndarray
SOFT = 1e10  # Pa, E/(1 - nu^2): above it a half-width of 3 % of the radius takes a pressure of 150 MPa and more
AROUND = ("theta",)


def may_slope(shape: object, material: Material | None) -> bool:
    """Whether the compliance of slopes is kept of a surface of resolved `shape` on this material."""
    curved = not shape.profile().planar  # type: ignore[attr-defined]
    return curved and material is not None and material.plane_strain_modulus < SOFT


def slope_lags(along: Array, pitch: float, rows: int) -> Array:
    """S (L, c rows, c rows) [m/N] in the layout of `ContactSurface.lags`, of D^t in the same layout; L = 1: dense, on
    an arc; else a full turn, `pitch` [rad] between columns."""
    count, side = along.shape[:2]
    c = side // rows
    column = np.repeat(np.arange(c), rows)
    angle = pitch * (c * np.arange(count)[:, None, None] + column[:, None] - column)
    if count > 1 or abs(pitch * c - 2.0 * np.pi) < 1e-9:
        angle = np.mod(angle + np.pi, 2.0 * np.pi) - np.pi
        angle[np.abs(np.abs(angle) - np.pi) < 0.5 * pitch] = 0.0  # opposite columns lie on neither side
    swapped = np.roll(along[::-1], 1, axis=0).swapaxes(1, 2)  # [l] = D^t[-l]^T
    return -0.5 * angle * (along - swapped)
