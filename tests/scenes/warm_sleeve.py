"""A journal bearing whose sleeve conducts the heat of its oil film to its surroundings, and expands."""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np

import warpffrf as wf
from scenes import film_bearing, warm_slider

STEEL = wf.Material(210e9, 0.3, 7850.0, conductivity=45.0, heat_capacity=460.0, expansion=12e-6)
RADIUS, WALL, LENGTH = film_bearing.RADIUS, film_bearing.WALL, film_bearing.LENGTH
OUTER = RADIUS + WALL
H, AMBIENT = 300.0, 30.0  # W/(m2 K), degrees Celsius, outside


@cache
def sleeve(h: float = H, columns: int = 32, rows: int = 7) -> wf.ReducedBody:
    """Free to expand, with its dimensions at AMBIENT."""
    mesh = wf.mesh.sleeve(RADIUS, OUTER, LENGTH, sectors=columns, order=1, axial=rows - 1)
    return wf.reduce(
        mesh, STEEL, interfaces={"outside": "average"}, contact={"bore": wf.surfaces.Bore()}, modes=6,
        thermal=wf.films.BodyTemperature(convection={"outside": (h, AMBIENT)}, reference=AMBIENT),
        grid=wf.ContactGrid(contact_fixed=False), progress=False,
    )  # fmt: skip


def bore_rise(heat: float) -> float:
    """Mean temperature [K] of the bore above the surroundings under `heat` [W], of a ring of any distribution of it."""
    outside = heat / (H * 2.0 * np.pi * OUTER * LENGTH)
    return float(outside + heat * np.log(OUTER / RADIUS) / (2.0 * np.pi * STEEL.conductivity * LENGTH))  # type: ignore[operator]


def bearing(
    *, load: Any = (2e3, 0.0), speed: float = film_bearing.SPEED, slope: float = 0.03, body: Any = None,
    viscosity: float = film_bearing.VISCOSITY, temperature: Any = None,
) -> wf.Scene:  # fmt: skip
    """A shaft in the `sleeve`; oil with the `viscosity` [Pa s] at the supply's temperature."""
    heat = wf.films.FilmTemperature(warm_slider.SUPPLY) if temperature is None else temperature
    return film_bearing.bearing(
        sleeve() if body is None else body, load, speed=speed, oil=warm_slider.oil(slope, viscosity),
        feeds=[film_bearing.GROOVE], temperature=heat,
    )  # fmt: skip
