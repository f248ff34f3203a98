r"""Linear elastic, homogeneous materials: isotropic, and orthotropic with nine constants and a material frame.

With engineering constants about the material axes 1, 2, 3 the strains of a stress are (Lekhnitskii 1963, Theory of
elasticity of an anisotropic elastic body, section 5)

    e_11 = s_11/E_1 - nu_12 s_22/E_1 - nu_13 s_33/E_1,      2 e_12 = s_12/G_12,      2 e_13 = s_13/G_13,
    e_22 = -nu_12 s_11/E_1 + s_22/E_2 - nu_23 s_33/E_2,     2 e_23 = s_23/G_23,
    e_33 = -nu_13 s_11/E_1 - nu_23 s_22/E_2 + s_33/E_3:

nu_12 is the contraction along 2 under tension along 1, nu_21 = nu_12 E_2/E_1. The energy is positive where the
compliance of the normal strains is positive definite and the shear moduli are positive. With the axes in the rows of R
the stiffness in the body's frame is c_ijkl = R_ai R_bj R_ck R_dl c'_abcd.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import TypeAlias

import numpy as np

from warpffrf.model.arguments import Vector
from warpffrf.model.errors import InputError, require_array, require_direction, require_number, unknown_name
from warpffrf.model.messages.named_arguments import named_arguments

NEARLY_INCOMPRESSIBLE = 0.45  # Poisson's ratio above which elements use the mixed formulation by default
FORMULATIONS = ("displacement", "mixed")
ALONG = 1e-3  # sine of the angle between two axes below which they are parallel
DEFINITE = 1e-9  # least eigenvalue of the scaled compliance, of 1
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

    @staticmethod
    def orthotropic(
        youngs_moduli: Vector,
        poisson_ratios: Vector,
        shear_moduli: Vector,
        density: float,
        *,
        axes: tuple[Vector, Vector] = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0)),
        name: str = "",
    ) -> Orthotropic:
        """An orthotropic material of solid cells, for `reduce`: wood, fibre composites, laminated stacks.

        youngs_moduli: (E_1, E_2, E_3) [Pa]; poisson_ratios: (nu_12, nu_13, nu_23), nu_12 the contraction along 2 under
        tension along 1; shear_moduli: (G_12, G_13, G_23) [Pa]; density [kg/m3]. axes: the directions 1 and 2 in the
        body's user frame; of the second the part across the first counts. name: used in reports. Contact surfaces,
        shells and beams need isotropic materials. Raises `InputError` for constants that are not positive, or of no
        positive energy, and parallel axes.

        >>> ply = wf.Material.orthotropic((135e9, 10e9, 10e9), (0.3, 0.3, 0.45), (5e9, 5e9, 3.4e9), 1600)
        >>> ply.density
        1600.0
        """
        return Orthotropic(youngs_moduli, poisson_ratios, shear_moduli, density, axes, name)

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


@dataclass(frozen=True)
class Orthotropic:
    """A linear orthotropic material, made by `Material.orthotropic`, where its arguments are described."""

    youngs_moduli: Vector
    poisson_ratios: Vector
    shear_moduli: Vector
    density: float
    axes: tuple[Vector, Vector]
    name: str = ""

    def __post_init__(self) -> None:
        label = f"material {self.name!r}" if self.name else "material"
        for what in ("youngs_moduli", "poisson_ratios", "shear_moduli"):
            values = require_array(getattr(self, what), f"{label}: {what}", (3,))
            if what != "poisson_ratios" and not np.all(values > 0.0):
                raise InputError(f"{label}: {what} must be greater than zero, got {values.tolist()}")
            object.__setattr__(self, what, tuple(values.tolist()))
        object.__setattr__(self, "density", require_number(self.density, f"{label}: density", positive=True))
        if not isinstance(self.axes, Sequence | np.ndarray) or len(self.axes) != 2:
            raise InputError(f"{label}: axes are two directions, of the material axes 1 and 2, got {self.axes!r}")
        first, second = (require_direction(a, f"{label}: axes[{i}]") for i, a in enumerate(self.axes))
        across = second - (second @ first) * first
        if np.linalg.norm(across) < ALONG:
            raise InputError(f"{label}: axes 1 and 2 are parallel; give two directions across each other")
        axes = (tuple(first.tolist()), tuple((across / np.linalg.norm(across)).tolist()))
        object.__setattr__(self, "axes", axes)
        E = np.array(self.youngs_moduli)
        least = np.linalg.eigvalsh(self._compliance * np.sqrt(E[:, None] * E))[0]
        if not least > DEFINITE:
            limits = ", ".join(f"|nu_{i + 1}{j + 1}| < {np.sqrt(E[i] / E[j]):.4g}" for i, j in ((0, 1), (0, 2), (1, 2)))
            raise InputError(
                f"{label}: poisson_ratios (nu_12, nu_13, nu_23) = {self.poisson_ratios} let the energy of some "
                f"strain be negative or infinite; each alone must satisfy {limits}, and all together less. nu_12 is "
                "the contraction along 2 under tension along 1; nu_21 = nu_12 E_2/E_1"
            )

    @property
    def _compliance(self) -> np.ndarray:
        """Normal strains of the normal stresses (3, 3) [1/Pa], in material axes."""
        E, (nu_12, nu_13, nu_23) = self.youngs_moduli, self.poisson_ratios
        S = np.diag(1.0 / np.array(E))
        for i, j, nu in ((0, 1, nu_12), (0, 2, nu_13), (1, 2, nu_23)):
            S[i, j] = S[j, i] = -nu / E[i]
        return S

    @cached_property
    def stiffness(self) -> np.ndarray:
        """c_ijkl (3, 3, 3, 3) [Pa] in the body's frame: s_ij = c_ijkl e_kl."""
        c = np.zeros((3, 3, 3, 3))
        normal = np.linalg.inv(self._compliance)
        for i in range(3):
            for j in range(3):
                c[i, i, j, j] = normal[i, j]
        for (i, j), G in zip(((0, 1), (0, 2), (1, 2)), self.shear_moduli, strict=True):
            c[i, j, i, j] = c[j, i, i, j] = c[i, j, j, i] = c[j, i, j, i] = G
        R = np.array([*self.axes, np.cross(*self.axes)])
        return np.einsum("abcd,ai,bj,ck,dl->ijkl", c, R, R, R, R, optimize=True)

    @property
    def mixed(self) -> bool:
        """Its elements have displacements alone."""
        return False


SolidMaterial: TypeAlias = Material | Orthotropic  # of solid cells
