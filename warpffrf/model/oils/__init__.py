"""Oils of a film. One file a law; `oil` has what they share.

With the pressure p >= 0 [Pa] above that of the cavity

    Newtonian            mu = mu_0
    Barus                mu = mu_0 exp(alpha p)
    Roelands             mu = mu_0 exp((ln mu_0 + 9.67)((1 + p/196.2 MPa)^z - 1))
    DowsonHigginson      rho/rho_0 = 1 + a p/(1 + b p), beside any of them

Temperature is a parameter: `vogel`, `walther` and `iso_vg` give the viscosity at one. An oil of one's own is a subclass
of one of them: the kernels evaluate mu(p) in these forms.
"""

from __future__ import annotations

from typing import Any

from warpffrf.model.errors import InputError
from warpffrf.model.oils.barus import Barus
from warpffrf.model.oils.dowson_higginson import DowsonHigginson
from warpffrf.model.oils.iso_vg import iso_vg
from warpffrf.model.oils.newtonian import Newtonian
from warpffrf.model.oils.oil import FORMS, Oil
from warpffrf.model.oils.roelands import Roelands
from warpffrf.model.oils.temperature import vogel, walther

OILS = {oil.kind: oil for oil in (Newtonian, Barus, Roelands)}

__all__ = ["OILS", "Barus", "DowsonHigginson", "Newtonian", "Oil", "Roelands", "as_oil", "iso_vg", "vogel", "walther"]


def __dir__() -> list[str]:
    return __all__


def as_oil(value: Any, label: str) -> Oil:
    """`value` if it is an oil of a form that kernels evaluate; raises `InputError` naming `label`, with the oils there
    are."""
    names = ", ".join(f"oils.{oil.__name__}" for oil in OILS.values())
    if not isinstance(value, Oil):
        raise InputError(f"{label}: oil must be one of {names}, or made by oils.iso_vg, got {value!r}")
    if value.form not in FORMS:
        raise InputError(
            f"{label}: the oil {value.label} has the form {value.form!r}; the kernels evaluate {', '.join(FORMS)}; "
            f"make it a subclass of one of {names}"
        )
    return value
