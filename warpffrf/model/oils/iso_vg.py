r"""Mineral oils by their ISO viscosity grade (ISO 3448: the grade is the kinematic viscosity at 40 degrees in mm2/s).

With mu_40 = rho nu_40, Vogel's equation with c = 95 K and all oils meeting in one viscosity,

    mu = mu_40 exp(b (1/(T + 95) - 1/135)),      b = 159.56 K ln(mu_40/1.8e-4 Pa s),

is how standards for plain bearings describe mineral oils of viscosity index 95 to 100. With a measured viscosity at 100
degrees, `at_100`, Walther's line through the two points takes its place.
"""

from __future__ import annotations

import numpy as np

from warpffrf.model.errors import InputError, require_number
from warpffrf.model.messages.named_arguments import named_arguments
from warpffrf.model.oils.newtonian import Newtonian
from warpffrf.model.oils.temperature import temperature_of, walther

GRADES = (2, 3, 5, 7, 10, 15, 22, 32, 46, 68, 100, 150, 220, 320, 460, 680, 1000, 1500, 2200, 3200)
VOGEL_SHIFT, VOGEL_RISE, VOGEL_POLE = 95.0, 159.55787, 1.8e-4  # K, K, Pa s
REFERENCE = 40.0  # degrees Celsius
DENSITY = 880.0  # kg/m3


@named_arguments
def iso_vg(grade: int, *, temperature: float, at_100: float | None = None, density: float = DENSITY) -> Newtonian:
    """The oil of ISO VG `grade` at `temperature` [degrees Celsius]; at_100: kinematic viscosity at 100 degrees [m2/s],
    of an oil whose viscosity index is another than about 95; density [kg/m3]. Raises `InputError`."""
    label = f"oils.iso_vg({grade!r})"
    if grade not in GRADES:
        raise InputError(f"{label}: no such grade; known: {', '.join(map(str, GRADES))}")
    T = temperature_of(temperature, label)
    rho = require_number(density, f"{label}: density [kg/m3]", positive=True)
    nu_40 = 1e-6 * grade
    if at_100 is not None:
        return Newtonian(walther(T, points=[(REFERENCE, nu_40), (100.0, at_100)], density=rho))
    mu_40 = rho * nu_40
    b = VOGEL_RISE * np.log(mu_40 / VOGEL_POLE)
    return Newtonian(float(mu_40 * np.exp(b * (1.0 / (T + VOGEL_SHIFT) - 1.0 / (REFERENCE + VOGEL_SHIFT)))))
