r"""What all oils have in common: viscosity and density against pressure, at one temperature.

A film is solved for pressures, by Newton's method; so an oil tells both and their derivatives,

    mu(p) [Pa s],    mu'(p) [s],    r(p) = rho(p)/rho_0 [-],    r'(p) [1/Pa],

of the pressure above that of the cavity. Both rise with p. The cavity has pressure zero and an oil of mu(0), r(0) = 1.

The kernels evaluate mu(p) by the `form` of an oil, one of FORMS, and its `numbers`; another form needs a kernel.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import KW_ONLY, dataclass, fields
from typing import Any, ClassVar

import numpy as np

from warpffrf.model.errors import InputError, require_number
from warpffrf.model.oils.dowson_higginson import DowsonHigginson

Array = np.ndarray
# Pa s: air has 2e-5, and bitumen at room temperature 1e5
LEAST, MOST = 1e-6, 1e4
FORMS = ("newtonian", "barus", "roelands")  # that `warpffrf_kernels.films.oil` evaluates


@dataclass(frozen=True)
class Oil(ABC):
    """An oil of `viscosity` [Pa s] at zero pressure, and compressible where it has a law of `density`. Raises
    `InputError` for a viscosity that no oil has and a density that is no law.

    An oil of one's own is a subclass of `Newtonian`, `Barus` or `Roelands`, whose form the kernels evaluate.
    """

    viscosity: float
    _: KW_ONLY
    density: DowsonHigginson | None = None
    kind: ClassVar[str]
    form: ClassVar[str] = ""

    def __post_init__(self) -> None:
        viscosity = require_number(self.viscosity, f"{self.label}: viscosity [Pa s]", positive=True)
        if not LEAST <= viscosity <= MOST:
            raise InputError(
                f"{self.label}: viscosity must lie between {LEAST:g} and {MOST:g} Pa s, got {viscosity:g}; an oil of "
                "46 mm2/s has about 0.04 Pa s"
            )
        if self.density is not None and not isinstance(self.density, DowsonHigginson):
            raise InputError(
                f"{self.label}: density must be oils.DowsonHigginson(...) or None, of an oil that is not compressible, "
                f"got {self.density!r}"
            )
        object.__setattr__(self, "viscosity", viscosity)

    @property
    def label(self) -> str:
        """For messages."""
        return f"oils.{type(self).__name__}"

    @property
    def numbers(self) -> tuple[float, float, float]:
        """What the form reads on the device: coefficient [1/Pa], rise and exponent [-], 0 where it has none."""
        return 0.0, 0.0, 0.0

    @abstractmethod
    def viscosity_at(self, pressure: Any) -> Array:
        """mu [Pa s] at pressures [Pa], any shape."""

    @abstractmethod
    def viscosity_slope(self, pressure: Any) -> Array:
        """mu' [s] at pressures [Pa], any shape."""

    def density_at(self, pressure: Any) -> Array:
        """rho/rho_0 [-] at pressures [Pa], any shape."""
        p = np.asarray(pressure, dtype=float)
        return np.ones_like(p) if self.density is None else self.density.ratio(p)

    def density_slope(self, pressure: Any) -> Array:
        """Its derivative [1/Pa] at pressures [Pa], any shape."""
        p = np.asarray(pressure, dtype=float)
        return np.zeros_like(p) if self.density is None else self.density.slope(p)

    def describe(self) -> dict[str, Any]:
        """Plain data for hashing."""
        numbers = {f.name: getattr(self, f.name) for f in fields(self) if f.name not in ("density", "_")}
        return {"kind": self.kind, **numbers, "density": None if self.density is None else self.density.describe()}
