r"""Cerruti's integrals: how a traction that is constant on a rectangle moves the surface of a half-space along itself,
and how pressures move it along.

V. Cerruti (1882), J. Boussinesq (1885); K. L. Johnson, "Contact Mechanics", 1985, section 3.6. With x, z from the
loaded place to the one that sees it, r^2 = x^2 + z^2, the shear modulus G and per unit force

    along x by a force along x: ((1 - nu)/r + nu x^2/r^3)/(2 pi G),      along z: nu x z/r^3/(2 pi G),
    along x by a force pushed into the material: -(1 - 2 nu)/(4 pi G) x/r^2,

and the last, with the other sign, is what a force along x pushes the surface into the material. Over a rectangle they
are sums over its corners of

    1/r: x asinh(z/|x|) + z asinh(x/|z|),    x^2/r^3: z asinh(x/|z|),    z^2/r^3: x asinh(z/|x|),    x z/r^3: -r,
    x/r^2: (z/2) ln r^2 + x atan(z/x).
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

Array = np.ndarray


def along_x(x: Any, z: Any, width: Any, length: Any) -> Array:
    """Integral of x^2/r^3 [m] over a rectangle of `width` along x and `length` along z about the origin, seen from
    (x, z)."""
    return _over(lambda a, b: _product(b, a), x, z, width, length)


def along_z(x: Any, z: Any, width: Any, length: Any) -> Array:
    """Integral of z^2/r^3 [m]."""
    return _over(_product, x, z, width, length)


def across(x: Any, z: Any, width: Any, length: Any) -> Array:
    """Integral of x z/r^3 [m]."""
    return _over(lambda a, b: -np.hypot(a, b), x, z, width, length)


def toward_x(x: Any, z: Any, width: Any, length: Any) -> Array:
    """Integral of x/r^2 [m]."""

    def corner(a: Array, b: Array) -> Array:
        r2 = a * a + b * b
        angle = np.arctan(b / np.where(a == 0.0, np.inf, a))
        return 0.5 * b * np.log(np.where(r2 == 0.0, 1.0, r2)) + a * angle

    return _over(corner, x, z, width, length)


def toward_z(x: Any, z: Any, width: Any, length: Any) -> Array:
    """Integral of z/r^2 [m]."""
    return toward_x(z, x, length, width)


def _product(s: Array, t: Array) -> Array:
    return s * np.arcsinh(t / np.where(s == 0.0, np.inf, np.abs(s)))


def _over(corner: Callable[[Array, Array], Array], x: Any, z: Any, width: Any, length: Any) -> Array:
    """Sum of `corner` over the corners of the rectangle."""
    a, b = 0.5 * width, 0.5 * length
    x, z, a, b = np.broadcast_arrays(x, z, a, b)
    return corner(x + a, z + b) - corner(x + a, z - b) - corner(x - a, z + b) + corner(x - a, z - b)
