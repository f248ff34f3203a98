"""Dry friction with a coefficient given by a table of the slip speed, from a measurement: straight between the points,
and the last value beyond them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from warpffrf.model.errors import InputError, require_array
from warpffrf.model.friction.law import FrictionLaw
from warpffrf.model.messages.named_arguments import named_arguments


@named_arguments
@dataclass(frozen=True)
class TabulatedFriction(FrictionLaw):
    """Friction with tabulated `coefficients` (n,) [-], positive, at slip `speeds` (n,) [m/s], which rise from 0; the
    first is the coefficient of static friction. Raises `InputError` for a table that folds over itself."""

    speeds: tuple[float, ...]
    coefficients: tuple[float, ...]
    kind: ClassVar[str] = "tabulated_friction"

    def __post_init__(self) -> None:
        speeds = require_array(self.speeds, "TabulatedFriction: speeds [m/s]", (None,))
        coefficients = require_array(self.coefficients, "TabulatedFriction: coefficients", (None,))
        if len(speeds) != len(coefficients) or len(speeds) < 2:
            raise InputError(
                f"TabulatedFriction: as many coefficients as speeds are needed, two at least, got {len(speeds)} "
                f"speeds and {len(coefficients)} coefficients"
            )
        if speeds[0] != 0.0:
            raise InputError(
                f"TabulatedFriction: the first speed must be 0, got {speeds[0]:g} m/s; add the static coefficient"
            )
        folds = np.diff(speeds) <= 0.0
        if np.any(folds):
            i = int(np.argmax(folds))
            raise InputError(
                f"TabulatedFriction: the table folds over itself, speeds must rise strictly, got {speeds[i]:g} and "
                f"then {speeds[i + 1]:g} (points {i} and {i + 1})"
            )
        if np.any(coefficients <= 0.0):
            raise InputError(f"TabulatedFriction: coefficients must be positive, got {coefficients.min():g}")
        object.__setattr__(self, "speeds", tuple(float(v) for v in speeds))
        object.__setattr__(self, "coefficients", tuple(float(mu) for mu in coefficients))

    @property
    def breaks(self) -> tuple[float, ...]:
        """The speeds [m/s] of the points."""
        return self.speeds

    def coefficient_at(self, speed: Any) -> np.ndarray:
        return np.interp(np.asarray(speed, float), self.speeds, self.coefficients)

    def slope_at(self, speed: Any) -> np.ndarray:
        slopes = np.append(np.diff(self.coefficients) / np.diff(self.speeds), 0.0)
        return slopes[np.searchsorted(self.speeds, np.asarray(speed, float), side="right") - 1]
