"""Two rollers of steel with a Poisson's ratio of 0.4999, pressed together: half-width and peak by Hertz.

Elements that lock would be far too stiff. The two figures are those at mid-width, against Hertz's line contact at the
line load found there (a comparison that the load itself does not enter).
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from references.closed_forms.hertz import LineContact
from scenes.rollers import PAIR, guided_pair, roller_body
from studies.hard_cases.case import Case, Finding
from warpffrf.model.material import Material
from warpffrf.model.reduced.body import ReducedBody
from warpffrf.model.scene import Scene
from warpffrf.output.contact.hertz import HertzLine
from warpffrf.output.result import Result

SOFT = Material(210e9, 0.4999, 7850.0, name="nearly incompressible steel")
LOAD, WIDTH, RADIUS = 60e3, 0.02, 0.05  # N, m, m


@lru_cache
def _body() -> ReducedBody:
    return roller_body(1440, layers=11, axial=2, grading=1.4, order=2, modes=4, material=SOFT)


def build() -> Scene:
    """The pair in equilibrium under its load."""
    return guided_pair(_body(), _body(), load=LOAD, gravity=0.0)


def check(result: Result) -> list[Finding]:
    """Half-width and peak at mid-width at the end; the force carried."""
    contact = result.contact(PAIR)
    hertz = contact.hertz(-1)
    if not isinstance(hertz, HertzLine):
        raise TypeError("two rollers make a line contact")
    exact = LineContact(hertz.line_load, 0.5 * RADIUS, 0.5 * SOFT.plane_strain_modulus)
    force = float(contact.force_magnitude[-1])
    guide = float(np.abs(result.joint("guide").coordinate[-1] - result.joint("guide").coordinate[0]))
    return [
        Finding("half-width", abs(float(contact.half_width[-1]) / exact.half_width - 1.0), 2e-2, 1e-1),
        Finding("peak pressure", abs(float(contact.mid_peak_pressure[-1]) / exact.peak_pressure - 1.0), 3e-2, 1e-1),
        Finding("force at rest", abs(force / float(contact.force_magnitude[0]) - 1.0), 1e-6, 1e-3),
        Finding("creep of the guide [m]", guide, 1e-10, 1e-7),
    ]


CASE = Case(
    "Poisson's ratio 0.4999",
    "Rollers of nearly incompressible steel under load: elements must not lock, Hertz holds.",
    build, 0.01, check, options={"start": "equilibrium"}, most_steps=200, middle=1e-4, tolerances=(1e-6,),
)  # fmt: skip
