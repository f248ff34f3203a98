r"""Displacements due to constant tractions on cells of an elastic half-plane and half-space: exact, at the centres of
cells and in the mean over cells.

Half-plane in plane strain (K. L. Johnson, Contact Mechanics, 1985, section 2.4), z into the body, traction q along x
and pressure p along z; L is the depth of the fixed point:

    u_x = -(2 (1 - nu^2)/(pi E)) int q ln(|x - t|/L) dt - k (int_{t<x} p dt - int_{t>x} p dt),
    u_z = -(2 (1 - nu^2)/(pi E)) int p ln(|x - t|/L) dt + k (int_{t<x} q dt - int_{t>x} q dt),
    k = (1 - 2 nu)(1 + nu)/(2 E).

Half-space (section 3.6, Cerruti and Boussinesq), r^2 = X^2 + Y^2 the distance in the surface, G the shear modulus:

    q_x:  u_x = int q_x ((1 - nu)/r + nu X^2/r^3) dA/(2 pi G),   u_y = int q_x nu X Y/r^3 dA/(2 pi G),
          u_z = int q_x (1 - 2 nu) X/r^2 dA/(4 pi G);
    p:    u_z = int p (1 - nu)/r dA/(2 pi G),   u_x = -int p (1 - 2 nu) X/r^2 dA/(4 pi G).

Over a rectangle they are differences over its corners of

    1/r: X ln(Y + r) + Y ln(X + r),   X^2/r^3: Y ln(X + r),   X Y/r^3: -r,   X/r^2: (Y/2) ln(X^2 + Y^2) + X atan(Y/X).

*Mean over a cell* equal to the loaded one: by one more integration, second differences with the step of a cell in each
direction, of (linear terms in a coordinate drop out)

    ln|x|: x^2 (ln|x| - 3/2)/2,     1/r: (X Y^2 ln(X + r) + X^2 Y ln(Y + r))/2 - r^3/6,
    X^2/r^3: X Y^2 ln(X + r)/2 + X^2 r/2 - r^3/3,     X Y/r^3: -(2 X Y r + X^3 ln(Y + r) + Y^3 ln(X + r))/6.

Means are symmetric in the loaded and the observed cell, and are the data of cells of a reduced body.

Two bodies in contact have opposite tractions: *relative* displacements add the direct terms, with
1/E* = sum (1 - nu^2)/E, and subtract the coupling between normal and tangential, which vanishes for like bodies.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from warpffrf.model.errors import require_count, require_number
from warpffrf.model.material import Material

Array = np.ndarray


def strip_displacement(x: Array, width: float, modulus: float, depth: float) -> Array:
    """Relative displacement [m/Pa] at x [m] due to a unit traction on the strip |x| < width/2, along that traction.

    modulus E* [Pa], depth L [m]. Normal and tangential are equal.
    """

    def F(t: Array) -> Array:
        safe = np.where(t == 0.0, 1.0, np.abs(t))
        return t * (np.log(safe / depth) - 1.0)

    x = np.asarray(x, dtype=float)
    return -2.0 / (np.pi * modulus) * (F(x + 0.5 * width) - F(x - 0.5 * width))


def influence_2d(count: int, width: float, modulus: float, depth: float) -> Array:
    """G (count, count) [m/Pa]: relative displacement at the centre of strip i by a unit traction on strip j.

    count adjacent strips of `width` [m], modulus E* [Pa], depth L [m], which must exceed count * width for G to be
    positive definite.
    """
    n = require_count(count, "count of strips", 1)
    w = require_number(width, "width of a strip", positive=True)
    offset = w * np.subtract.outer(np.arange(n), np.arange(n))
    return strip_displacement(offset, w, modulus, depth)


def strip_mean(x: Array, width: float, modulus: float, depth: float) -> Array:
    """Mean relative displacement [m/Pa] over a strip of `width` about x [m] by a unit traction on the strip
    |x| < width/2, along that traction; modulus E* [Pa], depth L [m]."""

    def F(t: Array) -> Array:
        safe = np.where(t == 0.0, 1.0, np.abs(t))
        return 0.5 * t * t * (np.log(safe / depth) - 1.5)

    x = np.asarray(x, dtype=float)
    return -2.0 / (np.pi * modulus * width) * (F(x + width) - 2.0 * F(x) + F(x - width))


def mean_2d(count: int, width: float, modulus: float, depth: float) -> Array:
    """G (count, count) [m/Pa]: as `influence_2d`, mean relative displacement over strip i."""
    n = require_count(count, "count of strips", 1)
    w = require_number(width, "width of a strip", positive=True)
    return strip_mean(w * np.subtract.outer(np.arange(n), np.arange(n)), w, modulus, depth)


def coupling_2d(count: int, width: float, first: Material, second: Material | None = None) -> Array:
    """K (count, count) [m/Pa]: separation of the surfaces at the centre of strip i along the first body's inward normal
    (first minus second) due to unit tangential tractions on strip j of the first body; `second` None: rigid.

    Pressures move the surfaces tangentially by K.T = -K (first minus second).
    """
    n = require_count(count, "count of strips", 1)

    def k(m: Material | None) -> float:
        return 0.0 if m is None else (1.0 - 2.0 * m.poisson_ratio) * (1.0 + m.poisson_ratio) / (2.0 * m.youngs_modulus)

    return (k(first) - k(second)) * width * np.sign(np.subtract.outer(np.arange(n), np.arange(n)))


def _rectangle(X: Array, Y: Array, size: tuple[float, float], kind: str) -> Array:
    """Integrals of the module over a rectangle centred at the origin, evaluated at (X, Y)."""
    total = np.zeros(np.broadcast(X, Y).shape)
    for sx in (1.0, -1.0):
        for sy in (1.0, -1.0):
            x, y = X + 0.5 * sx * size[0], Y + 0.5 * sy * size[1]
            r = np.hypot(x, y)
            # ln(t + r) = asinh(t/|s|) + ln|s|, s the other coordinate: no cancellation where t < 0
            if kind == "1/r":
                value = x * (np.arcsinh(y / np.abs(x)) + np.log(np.abs(x)))
                value = value + y * (np.arcsinh(x / np.abs(y)) + np.log(np.abs(y)))
            elif kind == "xx":
                value = y * (np.arcsinh(x / np.abs(y)) + np.log(np.abs(y)))
            elif kind == "xy":
                value = -r
            else:
                value = y * np.log(r) + x * np.arctan(y / x)
            total += sx * sy * value
    return total


def _mean_rectangle(X: Array, Y: Array, size: tuple[float, float], kind: str) -> Array:
    """Mean over a rectangle about (X, Y) of the integrals of `_rectangle`; X and Y whole numbers of `size`."""

    def log(
        s: Array, t: Array
    ) -> Array:  # ln(s + r) less ln|t|, whose terms drop out; 0 where a factor t^2 makes it so
        return np.where(t == 0.0, 0.0, np.arcsinh(s / np.where(t == 0.0, 1.0, np.abs(t))))

    total = np.zeros(np.broadcast(X, Y).shape)
    for i, a in zip((-1, 0, 1), (1.0, -2.0, 1.0), strict=True):
        for j, b in zip((-1, 0, 1), (1.0, -2.0, 1.0), strict=True):
            # exact zeros where sides meet
            x = size[0] * np.rint(X / size[0] + i)
            y = size[1] * np.rint(Y / size[1] + j)
            r = np.hypot(x, y)
            if kind == "1/r":
                value = 0.5 * (x * y * y * log(x, y) + x * x * y * log(y, x)) - r**3 / 6.0
            elif kind == "xx":
                value = 0.5 * (x * y * y * log(x, y) + x * x * r) - r**3 / 3.0
            else:
                value = -(2.0 * x * y * r + x**3 * log(y, x) + y**3 * log(x, y)) / 6.0
            total += a * b * value
    return total / (size[0] * size[1])


def _cells(centers: Array) -> tuple[Array, Array]:
    """Differences (n, n) of the coordinates of observed and loaded cells, centers (n, 2)."""
    x, y = np.asarray(centers, dtype=float).T
    return np.subtract.outer(x, x), np.subtract.outer(y, y)


def influence_3d(centers: Array, size: tuple[float, float], first: Material, second: Material | None = None) -> Array:
    """G (2 n, 2 n) [m/Pa], rows and columns by (cell, direction): relative tangential displacement at the centres of
    equal rectangular cells by unit tangential tractions. `second` None: rigid.

    centers (n, 2) [m] of cells on one regular grid, size (2,) [m] of a cell.
    """
    return _tangential(_rectangle, centers, size, first, second)


def mean_3d(centers: Array, size: tuple[float, float], first: Material, second: Material | None = None) -> Array:
    """G (2 n, 2 n) [m/Pa]: as `influence_3d`, mean relative displacements over the cells."""
    return _tangential(_mean_rectangle, centers, size, first, second)


def _tangential(
    seen: Callable[..., Array], centers: Array, size: tuple[float, float], first: Material, second: Material | None
) -> Array:
    """Cerruti's part of the module with the integrals of `seen`."""
    X, Y = _cells(centers)
    n = len(X)
    return _cerruti(seen, X, Y, size, first, second).transpose(0, 2, 1, 3).reshape(2 * n, 2 * n)


def _cerruti(
    seen: Callable[..., Array], X: Array, Y: Array, size: tuple[float, float], first: Material, second: Material | None
) -> Array:
    turned = (size[1], size[0])
    direct, xy = seen(X, Y, size, "1/r"), seen(X, Y, size, "xy")
    xx, yy = seen(X, Y, size, "xx"), seen(Y, X, turned, "xx")
    total = np.zeros((*np.shape(direct), 2, 2))
    for m in [first] if second is None else [first, second]:
        nu, scale = m.poisson_ratio, 1.0 / (2.0 * np.pi * m.lame[1])
        total[..., 0, 0] += scale * ((1.0 - nu) * direct + nu * xx)
        total[..., 1, 1] += scale * ((1.0 - nu) * direct + nu * yy)
        total[..., 0, 1] += scale * nu * xy
        total[..., 1, 0] += scale * nu * xy
    return total


def rectangle_displacement(
    X: Array, Y: Array, size: tuple[float, float], first: Material, second: Material | None = None
) -> Array:
    """Relative tangential displacements (..., 2, 2) [m/Pa], by (direction, direction of the traction), at X, Y (...)
    [m] from the centre of a rectangle of `size` [m] under unit tractions. `second` None: rigid."""
    return _cerruti(_rectangle, np.asarray(X, dtype=float), np.asarray(Y, dtype=float), size, first, second)


def rectangle_approach(X: Array, Y: Array, size: tuple[float, float], modulus: float) -> Array:
    """Relative normal displacement (...) [m/Pa] at X, Y [m] from the centre of a rectangle under a unit pressure;
    modulus E* [Pa]."""
    return _rectangle(np.asarray(X, dtype=float), np.asarray(Y, dtype=float), size, "1/r") / (np.pi * modulus)


def normal_3d(centers: Array, size: tuple[float, float], modulus: float) -> Array:
    """N (n, n) [m/Pa]: relative normal displacement at the centres by unit pressures on cells; modulus E* [Pa]."""
    X, Y = _cells(centers)
    return _rectangle(X, Y, size, "1/r") / (np.pi * modulus)


def coupling_3d(centers: Array, size: tuple[float, float], first: Material, second: Material | None = None) -> Array:
    """K (n, 2 n) [m/Pa]: as in `coupling_2d`, normal displacement by tangential tractions (cell, direction)."""
    X, Y = _cells(centers)

    def k(m: Material | None) -> float:
        return 0.0 if m is None else (1.0 - 2.0 * m.poisson_ratio) / (4.0 * np.pi * m.lame[1])

    parts = [_rectangle(X, Y, size, "x"), _rectangle(Y, X, (size[1], size[0]), "x")]
    return (k(first) - k(second)) * np.stack(parts, axis=2).reshape(len(X), -1)
