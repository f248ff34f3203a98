"""Curves of pressure against depth that laws are made of.

    Straight       p = k d, a constant yield
    Power          p = k d^n
    Exponential    p = p_0 exp(d/lambda), cut at a gap
    Table          straight between points

A law names its curve (`warpffrf.model.laws.layers`). A new form is one file here, one in `warpffrf_kernels.layers`, and
its line in `layer_laws.FORMS`.
"""

from __future__ import annotations

from warpffrf.model.laws.curves.curve import Curve, Exponential, Power, Straight, Table

__all__ = ["Curve", "Exponential", "Power", "Straight", "Table"]
