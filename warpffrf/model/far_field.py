r"""What a body adds to the half-space under a patch of contact: the far field, kept with each contact surface.

Pressures on a grid that travels with the patch displace the surface by u = H p + P S P^T p: H the half-space of the
body's material, exact on any grid, and S what is left of the body's compliance when the half-space is taken out of it,
among the splines of `FarSplines`, which P evaluates. Both halves have the same half-space, which is

- cut off by `cutoff` of the angle between outward normals, so that it does not go round the body;
- a quarter space at the `ends` of the surface, see `warpffrf.offline.near_field.ends`.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from warpffrf.model.quarter_surface import QuarterSurface

Array = np.ndarray
# rad between the normals at two places: the half-space counts in full up to WHOLE, and not at all from NOTHING on.
# A patch spans less than WHOLE: at a half-width of R/4 Hertz's parabola is off by 2 % of the gap, too.
WHOLE, NOTHING = 0.5, 1.3


def cutoff(cosine: Any) -> Array:
    """c(phi), with a continuous curvature, of the cosine of the angle phi between outward normals."""
    x = np.clip((np.arccos(np.clip(cosine, -1.0, 1.0)) - WHOLE) / (NOTHING - WHOLE), 0.0, 1.0)
    return 1.0 - x**3 * (10.0 - 15.0 * x + 6.0 * x * x)


@dataclass(frozen=True)
class FreeEnd:
    """An end face at the place `z` [m] along the meridian, at right angles to the surface; `side` +1 at the upper end,
    -1 at the lower one."""

    z: float
    side: int


@dataclass(frozen=True, eq=False)
class FarField:
    """S among the splines of the surface's grid, `lags` [m/N] in the layout of `ContactSurface.lags`, symmetric; the
    half-space that was taken out: `youngs_modulus` [Pa], `poisson_ratio`, `ends`.

    `asymmetry`: largest difference of the half-space on the body's mesh from its transpose, over its largest entry.
    """

    lags: Array
    youngs_modulus: float
    poisson_ratio: float
    ends: tuple[FreeEnd, ...]
    asymmetry: float
    quarter: QuarterSurface | None = None  # what the ends add at the surface; None without ends

    def facts(self) -> dict[str, Any]:
        """Everything but the arrays, plain data."""
        return {
            "youngs_modulus": self.youngs_modulus,
            "poisson_ratio": self.poisson_ratio,
            "ends": [[end.z, end.side] for end in self.ends],
            "asymmetry": self.asymmetry,
        }

    def arrays(self) -> dict[str, Array]:
        """The arrays."""
        return {"lags": self.lags} | ({} if self.quarter is None else {"quarter": self.quarter.coefficients})

    @classmethod
    def restore(cls, arrays: dict[str, Array], facts: dict[str, Any]) -> FarField:
        """The far field of `facts` and `arrays`."""
        ends = tuple(FreeEnd(float(z), int(side)) for z, side in facts["ends"])
        quarter = QuarterSurface(arrays["quarter"]) if "quarter" in arrays else None
        rest = (facts["youngs_modulus"], facts["poisson_ratio"], ends, facts["asymmetry"], quarter)
        return cls(arrays["lags"], *rest)
