r"""Joints with small sliding: two leaves, a bar on a base, a bolted joint, a press fit; equivalent damping.

Coulomb friction of coefficient mu under given pressures; strains are small. A cycle follows Masing's rule if all
points of a joint slip under the same bounds both ways: with the first loading b(F), after a reversal at (F1, d1)

    d = d1 - 2 b((F1 - F)/2)      (unloading; reloading likewise),     loss per cycle = 4 F1 b(F1) - 8 int_0^F1 b dF.

**Two leaves** (L. E. Goodman and J. H. Klumpp, J. Appl. Mech. 23 (1956) 421). Two strips L x b x h, clamped at x = 0,
pressed together by p, share the tip force P. While they stick they are one beam, I = 8 I1, I1 = b h^3/12,
whose shear traction at the joint is 3 P/(4 b h), uniform along it. So all of it slips at once, from P_s = 4/3 S
with S = mu p b h. During slip, each leaf has half of P and the couple of the traction, mu p b h/2 per length:

    stuck  w = P L^3/(24 E I1),      slipping  w = (P - S) L^3/(6 E I1),
    slip(x) = 6 (P - P_s)/(E b h^2) (L x - x^2/2),

the last of which is h w' less the strain of the leaves under the traction. The loop between -P and P is a parallelogram
with long sides 2 S apart; its area, also the work 2 mu p b int 2 slip dx of the traction, is

    D = 8 mu p L^3/(E h^2) (P - P_s),      largest for S = 3 P/8:  1.5 P^2 L^3/(E b h^3).

Timoshenko's shear (h/L)^2 is neglected, and Poisson's ratio at the clamp.

**Bar on a rigid base.** A bar of stiffness EA lies on a base that resists with at most t = mu p b [N/m]; F pulls at its
end. Slip begins there and extends over F/t, where the strain ends, u'' = t/EA:

    b(F) = F^2/(2 EA t),      D = 2 F^3/(3 EA t):  loss with the third power of force, as of every joint whose slip
    zone grows from nothing.

The range of validity ends when the whole length slips, F = t L.

**Bolted joint.** A bolt k_b and clamped parts k_c in parallel, preload F0; a force F_A separates them. Until it opens
F_b = F0 + F_A k_b/(k_b + k_c) and F_c = F0 - F_A k_c/(k_b + k_c); at F_A = F0 (k_b + k_c)/k_c F_c is zero, then
F_b = F_A (VDI 2230).

**Press fit** (G. Lame). A shaft (inner radius r_i, 0: solid) in a hub of outer radius r_o, joint at R, interference d
in radius, plane stress. The faces move by p R times

    hub    ((r_o^2 + R^2)/(r_o^2 - R^2) + nu)/E,      shaft  ((R^2 + r_i^2)/(R^2 - r_i^2) - nu)/E,

whose sum is d. For like materials and a solid shaft p = E d/(2 R) (1 - R^2/r_o^2). Torque slips at 2 pi R^2 b mu p.

**Equivalent damping.** A viscous damper of ratio zeta in resonance loses 2 pi (2 zeta) U in a cycle of peak strain
energy U, so that 2 zeta = D/(2 pi U): `equivalent_damping` is zeta = D/(4 pi U).
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass

import numpy as np

from warpffrf.model.errors import InputError, require_number
from warpffrf.model.material import Material

Array = np.ndarray


class Masing(ABC):
    """First loading b(F) and the resulting cycles by Masing's rule."""

    @abstractmethod
    def loading(self, force: Array | float) -> Array:
        """b(F), displacement [m] at first loading; odd in F."""

    def unloading(self, force: Array | float, peak: float) -> Array:
        """Displacement [m] at `force` on the way down from `peak` [N]."""
        return self.loading(peak) - 2.0 * self.loading(0.5 * (peak - np.asarray(force, dtype=float)))

    def reloading(self, force: Array | float, peak: float) -> Array:
        """Displacement [m] at `force` on the way up from `-peak` [N]."""
        return -self.unloading(-np.asarray(force, dtype=float), peak)

    @abstractmethod
    def cycle_loss(self, peak: float) -> float:
        """Work [J] lost in a cycle between -peak and peak [N]."""


def _positive(what: str, **values: float) -> None:
    for name, value in values.items():
        require_number(value, f"{what}: {name}", positive=True)


@dataclass(frozen=True)
class TwoLeaves(Masing):
    """Two equal leaves: length L, width b, thickness h of one [m], E [Pa], mu [-], pressure p [Pa] between them.

    Raises `InputError` for values that are not positive.
    """

    length: float
    width: float
    thickness: float
    youngs_modulus: float
    friction: float
    pressure: float

    def __post_init__(self) -> None:
        _positive("two leaves", **vars(self))

    @property
    def bound(self) -> float:
        """S = mu p b h [N]."""
        return self.friction * self.pressure * self.width * self.thickness

    @property
    def slip_force(self) -> float:
        """P_s [N], above which the leaves slip."""
        return 4.0 / 3.0 * self.bound

    @property
    def leaf_compliance(self) -> float:
        """L^3/(6 E I1) [m/N] of two slipping leaves."""
        return 2.0 * self.length**3 / (self.youngs_modulus * self.width * self.thickness**3)

    def loading(self, force: Array | float) -> Array:
        """Tip displacement [m] at first loading; odd in the force [N]."""
        P = np.abs(np.asarray(force, dtype=float))
        return np.sign(force) * self.leaf_compliance * np.where(P <= self.slip_force, 0.25 * P, P - self.bound)

    def slip(self, x: Array | float, force: float) -> Array:
        """Slip [m] of the lower face of the upper leaf against the other at x [m] from the clamp, first loading; odd in
        the force."""
        beyond = max(abs(force) - self.slip_force, 0.0)
        x = np.asarray(x, dtype=float)
        slope = 6.0 * beyond / (self.youngs_modulus * self.width * self.thickness**2)
        return np.sign(force) * slope * (self.length * x - 0.5 * x**2)

    def cycle_loss(self, peak: float) -> float:
        """Work [J] lost in a cycle between -peak and peak [N]; 0 without slip."""
        scale = 8.0 * self.friction * self.pressure * self.length**3 / (self.youngs_modulus * self.thickness**2)
        return float(scale * max(abs(peak) - self.slip_force, 0.0))

    def largest_cycle_loss(self, peak: float) -> float:
        """Largest loss [J] of a cycle between -peak and peak [N], whatever the pressure; at `best_pressure`."""
        return 1.5 * peak**2 * self.length**3 / (self.youngs_modulus * self.width * self.thickness**3)

    def best_pressure(self, peak: float) -> float:
        """Pressure [Pa] at which a cycle between -peak and peak [N] loses most."""
        return 0.375 * abs(peak) / (self.friction * self.width * self.thickness)


@dataclass(frozen=True)
class BarOnBase(Masing):
    """A bar of `stiffness` EA [N] and `length` L [m] on a rigid base that resists with at most `resistance` t [N/m].

    Raises `InputError` for values that are not positive, and for forces beyond t L, at which the bar slides away.
    """

    stiffness: float
    length: float
    resistance: float

    def __post_init__(self) -> None:
        _positive("bar on a base", **vars(self))

    @property
    def limit(self) -> float:
        """t L [N]."""
        return self.resistance * self.length

    def slip_length(self, force: Array | float) -> Array:
        """Length [m] of the slip zone at first loading."""
        F = np.abs(np.asarray(force, dtype=float))
        if np.any(F > self.limit):
            raise InputError(
                f"bar on a base: force beyond t L = {self.limit:g} N, the bar slides away; lower the force"
            )
        return F / self.resistance

    def loading(self, force: Array | float) -> Array:
        """Displacement [m] of the pulled end at first loading; odd in the force [N]."""
        return np.sign(force) * self.resistance * self.slip_length(force) ** 2 / (2.0 * self.stiffness)

    def cycle_loss(self, peak: float) -> float:
        """Work [J] lost in a cycle between -peak and peak [N]."""
        return float(2.0 * self.resistance**2 * self.slip_length(peak) ** 3 / (3.0 * self.stiffness))


@dataclass(frozen=True)
class BoltedJoint:
    """A bolt of `bolt` k_b and clamped parts of `clamped` k_c [N/m], `preload` F0 [N].

    Raises `InputError` for values that are not positive.
    """

    bolt: float
    clamped: float
    preload: float

    def __post_init__(self) -> None:
        _positive("bolted joint", **vars(self))

    @property
    def opening_force(self) -> float:
        """Separating force [N] at which the clamped parts are unloaded."""
        return self.preload * (self.bolt + self.clamped) / self.clamped

    def bolt_force(self, force: Array | float) -> Array:
        """Tension [N] of the bolt under the separating force [N] (negative: pressed together)."""
        F = np.asarray(force, dtype=float)
        return np.where(F < self.opening_force, self.preload + F * self.bolt / (self.bolt + self.clamped), F)

    def clamp_force(self, force: Array | float) -> Array:
        """Force [N] between the clamped parts."""
        return self.bolt_force(force) - np.asarray(force, dtype=float)

    def parting(self, force: Array | float) -> Array:
        """Lengthening [m] of bolt and clamped length beyond the preloaded state."""
        return (self.bolt_force(force) - self.preload) / self.bolt


@dataclass(frozen=True)
class PressFit:
    """A shaft in a hub, plane stress; lengths [m].

    radius R of the joint; outer_radius r_o of the hub; interference d, radial; width b along the axis; friction mu;
    shaft and hub: materials (`hub` None: as the shaft); bore r_i of the shaft, 0 where it is solid.
    Raises `InputError` for values that are not positive and for radii that do not ascend.
    """

    radius: float
    outer_radius: float
    interference: float
    width: float
    friction: float
    shaft: Material
    hub: Material | None = None
    bore: float = 0.0

    def __post_init__(self) -> None:
        names = ("radius", "outer_radius", "interference", "width", "friction")
        _positive("press fit", **{name: getattr(self, name) for name in names})
        if not 0.0 <= self.bore < self.radius < self.outer_radius:
            raise InputError(
                f"press fit: radii must ascend from the bore ({self.bore:g} m) over the joint ({self.radius:g} m) to "
                f"the outside ({self.outer_radius:g} m)"
            )

    @property
    def pressure(self) -> float:
        """p [Pa] at the joint."""
        hub = self.hub or self.shaft
        R, out, bore = self.radius**2, self.outer_radius**2, self.bore**2
        widens = ((out + R) / (out - R) + hub.poisson_ratio) / hub.youngs_modulus
        shrinks = ((R + bore) / (R - bore) - self.shaft.poisson_ratio) / self.shaft.youngs_modulus
        return self.interference / (self.radius * (widens + shrinks))

    @property
    def slip_torque(self) -> float:
        """2 pi R^2 b mu p [N m]."""
        return 2.0 * np.pi * self.radius**2 * self.width * self.friction * self.pressure

    @property
    def slip_force(self) -> float:
        """2 pi R b mu p [N] along the axis."""
        return self.slip_torque / self.radius

    def hub_stress(self, r: Array | float) -> tuple[Array, Array]:
        """Radial and hoop stress [Pa] of the hub at r [m]."""
        R, out = self.radius**2, self.outer_radius**2
        mean, swing = R / (out - R) * self.pressure, R * out / ((out - R) * np.asarray(r, dtype=float) ** 2)
        return mean - swing * self.pressure, mean + swing * self.pressure


def equivalent_damping(loss: float, peak_energy: float) -> float:
    """zeta = D/(4 pi U) [-]: the viscous damping ratio that loses D = `loss` [J] in a cycle of peak strain energy
    U = `peak_energy` [J]. Raises `InputError` for an energy that is not positive and a negative loss."""
    require_number(loss, "equivalent damping: loss per cycle", non_negative=True)
    return loss / (4.0 * np.pi * require_number(peak_energy, "equivalent damping: peak strain energy", positive=True))
