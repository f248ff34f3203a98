r"""Stress in an elastic half-space under normal pressure on rectangles of its surface, in closed form.

Coordinates (x, y) along the surface, z > 0 the depth below it; a positive pressure p acts into the material. With

    V = int p/r dA,      chi = int p ln(r + z) dA,      r^2 = X^2 + Y^2 + z^2,      X = x - xi,  Y = y - eta,

the stress (positive in tension) is (A. E. H. Love, Phil. Trans. R. Soc. A 228, 1929; K. L. Johnson, "Contact
Mechanics", 1985, section 3.4)

    2 pi sigma_x  = 2 nu V_z - (1 - 2 nu) chi_xx - z V_xx,          2 pi sigma_z  = V_z - z V_zz,
    2 pi tau_xy   = -(1 - 2 nu) chi_xy - z V_xy,                    2 pi tau_zx   = -z V_xz,

and with y for x. A pressure that is bilinear on a rectangle is, seen from (x, y),

    p = (c0 + c1 x + c2 y + c3 x y) - (c1 + c3 y) X - (c2 + c3 x) Y + c3 X Y,

so that the integrals over the rectangle of each kernel times 1, X, Y and X Y are needed. They are differences over the
corners of functions of (X, Y, z). Functions of one variable cancel in these differences and are omitted below. With

    L = ln(r + z),      T = atan(X Y/(z r)),      C_x = atan(Y/X) - atan(z Y/(X r)),      C_x + C_y = T,

    kernel    1                        X                          Y                       X Y
    -V_z      T                        -z ln(r + Y)               -z ln(r + X)            -z r
    V_xx      -X Y/((X^2 + z^2) r)     X [1] - ln(r + Y)          X/r                     X^2/r - r
    V_xy      1/r                      X/r - ln(r + X)            Y/r - ln(r + Y)         X Y/r - z T
    V_xz      -z Y/((X^2 + z^2) r)     X [1] + T                  z/r                     X z/r - z ln(r + X)
    chi_xx    C_x                      -Y L - z ln(r + Y)         X L                     ((X^2 - Y^2) L - z r)/2
    chi_xy    L                        -z ln(r + X) - Y C_y       -z ln(r + Y) - X C_x
                                                                  (X Y - X^2 C_x - Y^2 C_y - z^2 T)/2

([1] is the entry of the first column), V_zz = -V_xx - V_yy.
"""

from __future__ import annotations

import numpy as np

Array = np.ndarray
SHALLOWEST = 1e-6  # of the shortest side of a rectangle: smallest depth evaluated; edges have a logarithm at 0
TOGETHER = 2**20  # values per array, over all points and corners


def _logarithm(r: Array, a: Array, square: Array) -> Array:
    """ln(r + a) of r^2 = a^2 + `square` without the cancellation at a < 0."""
    positive = np.log(r + np.abs(a))
    return np.where(a < 0.0, np.log(square) - positive, positive)


def _stress(parts: dict[str, Array], z: Array, nu: float) -> Array:
    """(..., 6) xx yy zz xy yz zx of the second derivatives of V and chi, and V_z, under a unit pressure."""
    k, zz = 1.0 - 2.0 * nu, -(parts["xx"] + parts["yy"])
    found = (
        2.0 * nu * parts["z"] - k * parts["chi_xx"] - z * parts["xx"],
        2.0 * nu * parts["z"] - k * parts["chi_yy"] - z * parts["yy"],
        parts["z"] - z * zz,
        -k * parts["chi_xy"] - z * parts["xy"],
        -z * parts["yz"],
        -z * parts["xz"],
    )
    return np.stack(found, axis=-1) / (2.0 * np.pi)


class _Corners:
    """Functions of the distances X, Y [m] to corners and of the depth z [m] > 0, arrays that broadcast."""

    def __init__(self, X: Array, Y: Array, z: Array, nu: float) -> None:
        X, Y, z = np.broadcast_arrays(X, Y, z)
        self.X, self.Y, self.z, self.nu = X, Y, z, nu
        self.x2, self.y2, z2 = X * X, Y * Y, z * z
        self.r = np.sqrt(self.x2 + self.y2 + z2)
        self.xz, self.yz = self.x2 + z2, self.y2 + z2
        self.L = np.log(self.r + z)
        self.T = np.arctan2(X * Y, z * self.r)
        over = X * Y * (self.x2 + self.y2) / (self.r + z)  # X Y (r - z)
        self.Cx = np.arctan2(over, self.x2 * self.r + z * self.y2)
        self.Cy = np.arctan2(over, self.y2 * self.r + z * self.x2)

    def uniform(self) -> Array:
        """(..., 6) of a unit pressure."""
        X, Y, z, r = self.X, self.Y, self.z, self.r
        self.one = {
            "z": -self.T, "xx": -X * Y / (self.xz * r), "yy": -X * Y / (self.yz * r), "xy": 1.0 / r,
            "xz": -z * Y / (self.xz * r), "yz": -z * X / (self.yz * r),
            "chi_xx": self.Cx, "chi_yy": self.Cy, "chi_xy": self.L,
        }  # fmt: skip
        return _stress(self.one, z, self.nu)

    def moments(self) -> tuple[Array, Array, Array, Array]:
        """(..., 6) each, of a unit pressure, of X, of Y and of X Y."""
        X, Y, z, r, L, T = self.X, self.Y, self.z, self.r, self.L, self.T
        uniform, one = self.uniform(), self.one
        lx, ly = _logarithm(r, X, self.yz), _logarithm(r, Y, self.xz)
        by_x = {
            "z": z * ly, "xx": X * one["xx"] - ly, "yy": Y / r, "xy": X / r - lx,
            "xz": X * one["xz"] + T, "yz": z / r,
            "chi_xx": -Y * L - z * ly, "chi_yy": Y * L, "chi_xy": -z * lx - Y * self.Cy,
        }  # fmt: skip
        by_y = {
            "z": z * lx, "xx": X / r, "yy": Y * one["yy"] - lx, "xy": Y / r - ly,
            "xz": z / r, "yz": Y * one["yz"] + T,
            "chi_xx": X * L, "chi_yy": -X * L - z * lx, "chi_xy": -z * ly - X * self.Cx,
        }  # fmt: skip
        difference = (self.x2 - self.y2) * L
        both = {
            "z": z * r, "xx": self.x2 / r - r, "yy": self.y2 / r - r, "xy": X * Y / r - z * T,
            "xz": X * z / r - z * lx, "yz": Y * z / r - z * ly,
            "chi_xx": 0.5 * (difference - z * r), "chi_yy": 0.5 * (-difference - z * r),
            "chi_xy": 0.5 * (X * Y - self.x2 * self.Cx - self.y2 * self.Cy - z * z * T),
        }  # fmt: skip
        nu = self.nu
        return uniform, _stress(by_x, z, nu), _stress(by_y, z, nu), _stress(both, z, nu)


def _differences(values: Array) -> Array:
    """Weights of the corners of a grid of rectangles, (columns + 1, rows + 1), from values (columns, rows)."""
    return np.diff(np.diff(np.pad(values, 1), axis=0), axis=1)


def under_cells(points: Array, x: Array, y: Array, pressure: Array, poisson_ratio: float) -> Array:
    """Stress (n, 6) [Pa] at points (n, 3) [m], x, y and depth, under pressures (columns, rows) [Pa] that are constant
    between the lines x (columns + 1,) and y (rows + 1,) [m], ascending."""
    weight = _differences(pressure)
    return _summed(points, x, y, lambda corners, *_: np.einsum("njkc,jk->nc", corners.uniform(), weight), poisson_ratio)


def under_nodes(points: Array, x: Array, y: Array, pressure: Array, poisson_ratio: float) -> Array:
    """Stress (n, 6) [Pa] at points (n, 3) [m] under a pressure that is bilinear between its values (columns, rows) [Pa]
    at the nodes x (columns,), y (rows,) [m], ascending, at least two each; 0 outside of them."""
    dx, dy = np.diff(x)[:, None], np.diff(y)[None, :]
    low, right, up, both = pressure[:-1, :-1], pressure[1:, :-1], pressure[:-1, 1:], pressure[1:, 1:]
    px, py, pxy = (right - low) / dx, (up - low) / dy, (both - right - up + low) / (dx * dy)
    x0, y0 = x[:-1, None], y[None, :-1]
    coefficients = (low - px * x0 - py * y0 + pxy * x0 * y0, px - pxy * y0, py - pxy * x0, pxy)
    w = np.stack([_differences(c) for c in coefficients])

    def total(corners: _Corners, s: Array, t: Array) -> Array:
        one, by_x, by_y, by_both = corners.moments()
        s, t = s[:, None, None], t[:, None, None]
        shares = (w[0] + w[1] * s + w[2] * t + w[3] * s * t, -(w[1] + w[3] * t), -(w[2] + w[3] * s))
        found = np.einsum("njkc,jk->nc", by_both, w[3])
        for share, values in zip(shares, (one, by_x, by_y), strict=True):
            found = found + np.einsum("njkc,njk->nc", values, share)
        return found

    return _summed(points, x, y, total, poisson_ratio)


def _summed(points: Array, x: Array, y: Array, total: object, poisson_ratio: float) -> Array:
    """`total` of the corners (lines x and y), evaluated for blocks of the points."""
    least = SHALLOWEST * min(float(np.diff(x).min()), float(np.diff(y).min()))
    found = np.empty((len(points), 6))
    count = max(1, TOGETHER // (len(x) * len(y)))
    for start in range(0, len(points), count):
        part = points[start : start + count]
        s, t, depth = part[:, 0], part[:, 1], np.maximum(part[:, 2], least)
        corners = _Corners(s[:, None, None] - x[:, None], t[:, None, None] - y, depth[:, None, None], poisson_ratio)
        found[start : start + count] = total(corners, s, t)  # pyright: ignore[reportCallIssue]
    return found
