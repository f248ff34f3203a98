"""Curves of pressure against depth, of which laws are composed.

    Straight       p = k d, constant compliance
    Power          p = k d^n
    Exponential    p = p_0 exp(d/lambda), cut at a gap
    Table          straight between points

A law names its curve (`warpffrf.model.laws.layers`). A new form requires a module here, one in
`warpffrf_kernels.layers`, and a line in `layer_laws.FORMS`.
"""

from __future__ import annotations

from warpffrf.model.laws.curves.curve import Curve, Exponential, Power, Straight, Table

__all__ = ["Curve", "Exponential", "Power", "Straight", "Table"]
