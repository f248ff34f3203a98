"""Love's integral: how a pressure that is constant on a rectangle moves the surface of a half-space.

A. E. H. Love (1929), "The stress produced in a semi-infinite solid by pressure on part of the boundary"; K. L. Johnson,
"Contact Mechanics", 3.4. The displacement is (1 - nu^2)/(pi E) times the pressure times the integral.
"""

from __future__ import annotations

from typing import Any

import numpy as np

Array = np.ndarray


def rectangle(x: Any, z: Any, width: Any, length: Any) -> Array:
    """Integral of 1/r [m] over a rectangle about the origin, seen from (x, z)."""
    a, b = 0.5 * width, 0.5 * length
    return _corner(x + a, z + b) - _corner(x + a, z - b) - _corner(x - a, z + b) + _corner(x - a, z - b)


def _corner(x: Array, z: Array) -> Array:
    """The integral over the rectangle between the origin and (x, z), odd in both."""

    def part(s: Array, t: Array) -> Array:
        return s * np.arcsinh(t / np.where(s == 0.0, np.inf, np.abs(s)))

    return part(x, z) + part(z, x)
