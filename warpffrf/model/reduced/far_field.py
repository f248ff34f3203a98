r"""Difference of a body from the half-space under a contact patch: the far field, stored with each contact surface.

Pressures on a contact-fixed grid displace the surface by u = H p + P S P^T p: H the half-space of the body's material,
exact on any grid, and S the body's compliance minus the half-space, in the splines of `FarSplines`, which P evaluates.
Both parts use the same half-space, which is

- cut off by `cutoff` of the angle between outward normals, so that it does not extend around the body;
- a quarter space at the `ends` of the surface, see `warpffrf.offline.near_field.window`.

Tangential tractions have a far field, too (`FarTangential`), among the same splines. Their half-space is Cerruti's with
mirror images at the ends, of the same sign around and along, and without coupling of these directions; the effect of a
free end beyond the images is in S, as far as splines resolve it: not of tractions within about a spacing of the grid
from an end (`warpffrf.offline.near_field.half_space`). The tangential displacement under normal loads is taken in the
frame of the load: a near field that neglects the rotation of the tangents, as H of a flat patch does, lacks u_n/R of
the half-space in its strain du/ds, and a strain from S includes u_n/R of the remainder.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from warpffrf.model.half_space import QuarterSurface

Array = np.ndarray
# rad between the normals at two points: the half-space has full weight up to WHOLE, and none from NOTHING on.
# A patch spans less than WHOLE: at a half-width of R/4 Hertz's parabola is off by 2 % of the gap, too.
WHOLE, NOTHING = 0.5, 1.3


def cutoff(cosine: Any) -> Array:
    """c(phi), with a continuous curvature, of the cosine of the angle phi between outward normals."""
    x = np.clip((np.arccos(np.clip(cosine, -1.0, 1.0)) - WHOLE) / (NOTHING - WHOLE), 0.0, 1.0)
    return 1.0 - x**3 * (10.0 - 15.0 * x + 6.0 * x * x)


# Grid spacing along over that across, from which patches of cells are refused: at 38 pressures err by 1.2 %, at 61 by
# 8 to 18 %, or their compliance is not positive definite, although the far field equals that at 38 to 1e-4 of the whole
# (docs/studies/pressure_ends.md); the cause is unknown.
LONGEST = 40.0
# Of `FarField.asymmetry`: beyond ASYMMETRIC the mesh's error near a load differs between the directions, beyond
# UNUSABLE the far field is unknown.
ASYMMETRIC, UNUSABLE = 0.02, 0.25


@dataclass(frozen=True)
class FreeEnd:
    """An end face at `z` [m] along the meridian, at right angles to the surface; `side` +1 at the upper end, -1 at the
    lower one."""

    z: float
    side: int


@dataclass(frozen=True, eq=False)
class FarTangential:
    """S of tangential tractions and displacements among the splines, in the layouts of `Tangential`: with the flat
    index `d*c*r + j*r + k` of direction d, spline column j and row k, `lags_tt (sectors, 2 c r, 2 c r)`, symmetric, and
    `lags_nt (sectors, c r, 2 c r)` [m/N], the normal displacement under tangential loads and, transposed, the
    tangential one under normal loads. `asymmetry`: of T_tt, as that of `FarField`.
    """

    lags_tt: Array
    lags_nt: Array
    asymmetry: float


@dataclass(frozen=True, eq=False)
class FarField:
    """S among the splines of the surface's grid, `lags` [m/N] in the layout of `ContactSurface.lags`, symmetric; the
    subtracted half-space: `youngs_modulus` [Pa], `poisson_ratio`, `ends`.

    `asymmetry`: largest difference of the half-space on the body's mesh from its transpose, over its largest entry.
    """

    lags: Array
    youngs_modulus: float
    poisson_ratio: float
    ends: tuple[FreeEnd, ...]
    asymmetry: float
    quarter: QuarterSurface | None = None  # contribution of the ends at the surface; None without ends
    tangential: FarTangential | None = None  # None: of bodies without tangential tractions on cells

    def facts(self) -> dict[str, Any]:
        """Everything except the arrays, plain data."""
        tangential = {} if self.tangential is None else {"tangential": {"asymmetry": self.tangential.asymmetry}}
        return {
            "youngs_modulus": self.youngs_modulus,
            "poisson_ratio": self.poisson_ratio,
            "ends": [[end.z, end.side] for end in self.ends],
            "asymmetry": self.asymmetry,
            **tangential,
        }

    def arrays(self) -> dict[str, Array]:
        """The arrays."""
        found = {"lags": self.lags}
        if self.quarter is not None:
            found["quarter"] = self.quarter.coefficients
        if (t := self.tangential) is not None:
            found |= {"tangential/lags_tt": t.lags_tt, "tangential/lags_nt": t.lags_nt}
        return found

    @classmethod
    def restore(cls, arrays: dict[str, Array], facts: dict[str, Any]) -> FarField:
        """The far field of `facts` and `arrays`."""
        ends = tuple(FreeEnd(float(z), int(side)) for z, side in facts["ends"])
        quarter = QuarterSurface(arrays["quarter"]) if "quarter" in arrays else None
        tangential = None
        if (t := facts.get("tangential")) is not None:
            tangential = FarTangential(arrays["tangential/lags_tt"], arrays["tangential/lags_nt"], t["asymmetry"])
        rest = (facts["youngs_modulus"], facts["poisson_ratio"], ends, facts["asymmetry"], quarter, tangential)
        return cls(arrays["lags"], *rest)
