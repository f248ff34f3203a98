"""Curves of one contact pair for a recording."""

from __future__ import annotations

from typing import Any

import numpy as np

from warpffrf.output.recording.machine_series import Series

CONTACT_PLOTS = {
    "force": "Contact force [kN]",
    "peak_pressure": "Largest pressure [MPa]",
    "half_width": "Half-widths of the patch [µm]",
}
FRICTION_PLOTS = {
    "traction_coefficient": "Tangential over normal load [-]",
    "creepage": "Longitudinal and lateral creepage [-]",
    "spin_creepage": "Spin creepage [rad/m]",
    "creep_force": "Creep forces Fx, Fy on the first body [N]",
    "spin_moment": "Spin moment Mz on the first body [N m]",
    "t_gamma": "T-gamma, energy per metre rolled [N]",
    "friction_power": "Friction power [W]",
    "contact_area": "Contact, stick and slip area [mm²]",
    "wear": "Largest wear index, pressure times slip [W/mm²]",
    "cells_per_step": "Columns that the patch advances a step [-]",
}


def contact_series(contact: Any) -> list[Series]:
    """Entities `plots/<kind>/<pair>` and `solver/active_hats/<pair>`; NaN where a quantity has no meaning."""
    name = contact.name
    found: list[Series] = [
        (("plots", "force", name), f"{name} [kN]", contact.force_magnitude * 1e-3),
        (("plots", "peak_pressure", name), f"{name} [MPa]", contact.peak_pressure * 1e-6),
        (("plots", "half_width", name), f"{name} along the arc [µm]", contact.half_width * 1e6),
        (("solver", "active_hats", name), f"{name} active {contact.loaded}", contact.active_hats),
    ]
    if contact.patch_kind == "point":
        along = contact.half_widths[:, 1] * 1e6
        found.append((("plots", "half_width", name, "axial"), f"{name} along the axis [µm]", along))
    return found + (_friction_series(name, contact) if contact.has_friction else [])


def _friction_series(name: str, contact: Any) -> list[Series]:
    friction = contact.friction
    curves = (
        ("traction_coefficient", "", f"{name}", friction.traction_coefficient),
        ("creepage", "around", f"{name} longitudinal, along e_theta", friction.creepage[:, 0]),
        ("creepage", "axial", f"{name} lateral, along the axis", friction.creepage[:, 1]),
        ("spin_creepage", "", f"{name} [rad/m]", friction.spin_creepage),
        ("creep_force", "around", f"{name} Fx, along e_theta [N]", friction.tangential_force[:, 0]),
        ("creep_force", "axial", f"{name} Fy, along the axis [N]", friction.tangential_force[:, 1]),
        ("spin_moment", "", f"{name} [N m]", friction.spin_moment),
        ("t_gamma", "", f"{name} [N]", friction.t_gamma),
        ("friction_power", "", f"{name} [W]", friction.power),
        ("contact_area", "patch", f"{name} touches [mm²]", contact.patch_area * 1e6),
        ("contact_area", "stick", f"{name} sticks [mm²]", friction.stick_area * 1e6),
        ("contact_area", "slip", f"{name} slips [mm²]", friction.slip_area * 1e6),
        ("wear", "", f"{name} [W/mm²]", friction.wear_peak * 1e-6),
        ("cells_per_step", "", f"{name}", friction.cells_per_step),
    )
    return [
        (("plots", kind, name, *([part] if part else [])), label, np.asarray(values, dtype=float))
        for kind, part, label, values in curves
    ]
