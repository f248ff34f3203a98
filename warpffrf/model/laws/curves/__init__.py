"""Curves of pressure against depth that laws are made of. One file a form; `curve` says what all of them tell.

    Straight       p = k d, a constant yield
    Power          p = k d^n
    Exponential    p = p_0 exp(d/lambda), cut at a gap
    Table          straight between points

A law names its curve (`warpffrf.model.laws.law`). A new form is one file here, one in `warpffrf_kernels.layers`, and
its line in `layer_laws.FORMS`.
"""

from __future__ import annotations

from warpffrf.model.laws.curves.curve import Curve
from warpffrf.model.laws.curves.exponential import Exponential
from warpffrf.model.laws.curves.power import Power
from warpffrf.model.laws.curves.straight import Straight
from warpffrf.model.laws.curves.table import Table

__all__ = ["Curve", "Exponential", "Power", "Straight", "Table"]
