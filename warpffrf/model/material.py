"""A linear elastic, isotropic, homogeneous material."""

from __future__ import annotations

from dataclasses import dataclass, field

from warpffrf.model.errors import InputError, require_number, unknown_name
from warpffrf.model.messages.named_arguments import named_arguments

NEARLY_INCOMPRESSIBLE = 0.45  # Poisson's ratio above which elements use the mixed formulation by default
FORMULATIONS = ("displacement", "mixed")
THERMAL = ("conductivity", "heat_capacity", "expansion")
MOST_EXPANSION = 1e-3  # 1/K: rubber and plastics reach some 2e-4; 12 is that of steel in 1e-6/K


@named_arguments
@dataclass(frozen=True)
class Material:
    """A linear isotropic material: youngs_modulus E [Pa], poisson_ratio nu [-] in (-1, 0.5), density rho [kg/m3]; name:
    used in reports.

    `formulation` of its elements: "displacement", "mixed" (displacement and pressure, free of volumetric locking, see
    `warpffrf.offline.fe`), or None: mixed above `NEARLY_INCOMPRESSIBLE`.

    conductivity [W/(m K)], heat_capacity [J/(kg K)], expansion [1/K], of lengths: for temperatures of the body,
    `reduce(thermal=...)`; None: not known, and not needed without.

    Raises `InputError` for E, density, conductivity or heat_capacity <= 0, an unknown formulation and nu outside its
    range: at nu = 0.5 the material is incompressible, and its bulk modulus E / (3 (1 - 2 nu)) infinite; 0.49999 differs
    from it negligibly.

    >>> steel = wf.Material(youngs_modulus=210e9, poisson_ratio=0.3, density=7850)
    >>> steel.density  # kg/m3
    7850.0
    """

    youngs_modulus: float
    poisson_ratio: float
    density: float
    name: str = field(default="", kw_only=True)
    formulation: str | None = field(default=None, kw_only=True)
    conductivity: float | None = field(default=None, kw_only=True)
    heat_capacity: float | None = field(default=None, kw_only=True)
    expansion: float | None = field(default=None, kw_only=True)

    def __post_init__(self) -> None:
        label = f"material {self.name!r}" if self.name else "material"
        E = require_number(self.youngs_modulus, f"{label}: youngs_modulus", positive=True)
        nu = require_number(self.poisson_ratio, f"{label}: poisson_ratio")
        rho = require_number(self.density, f"{label}: density", positive=True)
        if not -1.0 < nu < 0.5:
            cure = "; for rubber use 0.49 to 0.499" if 0.5 <= nu < 0.6 else ""
            raise InputError(f"{label}: poisson_ratio must lie between -1 and 0.5 (excluded), got {nu:g}{cure}")
        if self.formulation not in (None, *FORMULATIONS):
            raise unknown_name(f"{label}: formulation", str(self.formulation), FORMULATIONS)
        for key in THERMAL:
            if (value := getattr(self, key)) is not None:
                value = require_number(value, f"{label}: {key}", positive=key != "expansion")
                object.__setattr__(self, key, value)
        if self.expansion is not None and abs(self.expansion) > MOST_EXPANSION:
            raise InputError(
                f"{label}: expansion is per kelvin, 12e-6 of steel, and at most {MOST_EXPANSION:g}, got "
                f"{self.expansion:g}"
            )
        object.__setattr__(self, "youngs_modulus", E)
        object.__setattr__(self, "poisson_ratio", nu)
        object.__setattr__(self, "density", rho)

    @property
    def lame(self) -> tuple[float, float]:
        """Lame's constants lambda and mu [Pa]: E nu / ((1 + nu)(1 - 2 nu)) and E / (2 (1 + nu))."""
        E, nu = self.youngs_modulus, self.poisson_ratio
        return E * nu / ((1.0 + nu) * (1.0 - 2.0 * nu)), E / (2.0 * (1.0 + nu))

    @property
    def mixed(self) -> bool:
        """Whether elements use the mixed formulation."""
        return self.formulation == "mixed" or (self.formulation is None and self.poisson_ratio > NEARLY_INCOMPRESSIBLE)

    @property
    def plane_strain_modulus(self) -> float:
        """E / (1 - nu^2) [Pa], the plane-strain modulus."""
        return self.youngs_modulus / (1.0 - self.poisson_ratio**2)
