r"""What a curve of pressure against depth tells its readers.

p = P(d) rises from zero at the depth `begins`, negative for a layer that reaches out, and holds the energy W(d) =
int P dd. The separated solver wants the inverse y = P^-1 and has it on the device, by the *form* of the curve and its
numbers (`warpffrf_kernels.layers.layer_laws.FORMS`). Checks on the host and references of the tests use the methods
below, which share no code with that. P must rise strictly, with a slope that is nowhere zero: curves whose slope would
vanish at touch are shifted by a depth far below any of use, and say so.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import Any, ClassVar

import numpy as np


class Curve(ABC):
    """A curve p = P(d). Depths d [m] of any shape; what is below `begins` has no pressure.

    form: its name on the device. compliance [m/Pa]: yield of a straight line through touch, which is a constant and
    part of the bodies' compliance; 0 of all others. e_folding [m]: the depth over which the pressure grows by the
    factor e, of curves that are exponentials; else 0. convex: whether its slope never falls.
    """

    form: ClassVar[str]
    compliance: float = 0.0
    e_folding: float = 0.0
    convex: bool = True

    @property
    def begins(self) -> float:
        """The depth [m] from which on there is a pressure."""
        return 0.0

    @property
    def numbers(self) -> tuple[float, ...]:
        """What the form reads on the device, in its order."""
        return ()

    @property
    def table(self) -> np.ndarray:
        """Depth [m], pressure [Pa] and energy [J/m^2] (n, 3) of a tabulated curve, of others none."""
        return np.zeros((0, 3))

    @abstractmethod
    def pressure(self, depth: Any) -> np.ndarray:
        """P [Pa]."""

    @abstractmethod
    def slope(self, depth: Any) -> np.ndarray:
        """P' [Pa/m]; 0 up to `begins`."""

    @abstractmethod
    def energy(self, depth: Any) -> np.ndarray:
        """W [J/m^2]."""

    @abstractmethod
    def yielding(self, pressure: Any) -> tuple[np.ndarray, np.ndarray]:
        """Depth y [m] under pressures [Pa], of any shape, `begins` below 0, and its derivative y' [m/Pa]."""
