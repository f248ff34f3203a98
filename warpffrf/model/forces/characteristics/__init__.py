"""Characteristics: forces of springs and dampers that are not in proportion to deformation or rate. One file a kind.

    ForcePolynomial   F = k_1 x + k_2 x^2 + k_3 x^3 + ...
    PowerLaw          F = c sgn(x) |x|^n
    ForceTable        points, joined straight or smoothly; play, stops, kinks

They stand where a stiffness or a damping would: `SpringDamper(a, b, stiffness=PowerLaw(1e9, 1.5))`.
"""

from __future__ import annotations

from warpffrf.model.forces.characteristics.characteristic import Characteristic, Pieces
from warpffrf.model.forces.characteristics.polynomial import ForcePolynomial
from warpffrf.model.forces.characteristics.power_law import PowerLaw
from warpffrf.model.forces.characteristics.table import ForceTable

CHARACTERISTICS = {kind.kind: kind for kind in (ForcePolynomial, PowerLaw, ForceTable)}

__all__ = ["CHARACTERISTICS", "Characteristic", "ForcePolynomial", "ForceTable", "Pieces", "PowerLaw"]
