r"""The power of a depth, p = k d^n, with a slope that does not vanish at touch.

For n > 1 the slope n k d^(n-1) is zero at d = 0: the inverse y(p) = (p/k)^(1/n) has an infinite one there, which no
compliance can hold. The power is taken of a depth that begins at `SHIFT` instead,

    P(d) = k [(d + e)^n - e^n],      e = SHIFT,
    W(d) = k {[(d + e)^(n+1) - e^(n+1)]/(n + 1) - e^n d},

which differs from k d^n by the fraction n e/d: 1.5e-6 at a depth of a micrometre and n = 1.5. At n = 1 it is k d.
"""

from __future__ import annotations

from typing import Any

import numpy as np

SHIFT = 1e-12  # m: far below the depth of any layer (an atom has 1e-10 m), far above round-off of its powers


def power_pressure(depth: Any, stiffness: float, exponent: float) -> np.ndarray:
    """P(d) [Pa] at the depths d [m], any shape; zero below 0. stiffness [Pa/m^exponent]."""
    d = np.maximum(np.asarray(depth, float), 0.0)
    return stiffness * ((d + SHIFT) ** exponent - SHIFT**exponent)


def power_energy(depth: Any, stiffness: float, exponent: float) -> np.ndarray:
    """W(d) [J/m^2] at the depths d [m], any shape."""
    d, n = np.maximum(np.asarray(depth, float), 0.0), exponent
    return stiffness * (((d + SHIFT) ** (n + 1.0) - SHIFT ** (n + 1.0)) / (n + 1.0) - SHIFT**n * d)
