"""A linear elastic, isotropic, homogeneous material."""

from __future__ import annotations

from dataclasses import dataclass, field

from warpffrf.model.errors import InputError, require_number


@dataclass(frozen=True)
class Material:
    """Young's modulus E [Pa], Poisson ratio nu [-] in (-1, 0.5), density rho [kg/m3].

    Raises `InputError` for E <= 0, density <= 0 and nu outside its range: at nu = 0.5 the material is incompressible
    and the displacement formulation has no bulk modulus, E / (3 (1 - 2 nu)).
    """

    youngs_modulus: float
    poisson_ratio: float
    density: float
    name: str = field(default="", kw_only=True)

    def __post_init__(self) -> None:
        label = f"material {self.name!r}" if self.name else "material"
        E = require_number(self.youngs_modulus, f"{label}: youngs_modulus", positive=True)
        nu = require_number(self.poisson_ratio, f"{label}: poisson_ratio")
        rho = require_number(self.density, f"{label}: density", positive=True)
        if not -1.0 < nu < 0.5:
            raise InputError(f"{label}: poisson_ratio must lie between -1 and 0.5 (excluded), got {nu:g}")
        object.__setattr__(self, "youngs_modulus", E)
        object.__setattr__(self, "poisson_ratio", nu)
        object.__setattr__(self, "density", rho)

    @property
    def lame(self) -> tuple[float, float]:
        """Lame's constants lambda and mu [Pa]: E nu / ((1 + nu)(1 - 2 nu)) and E / (2 (1 + nu))."""
        E, nu = self.youngs_modulus, self.poisson_ratio
        return E * nu / ((1.0 + nu) * (1.0 - 2.0 * nu)), E / (2.0 * (1.0 + nu))

    @property
    def plane_strain_modulus(self) -> float:
        """E / (1 - nu^2) [Pa], the modulus of a half-plane in plane strain."""
        return self.youngs_modulus / (1.0 - self.poisson_ratio**2)
