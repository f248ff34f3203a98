"""The crowned roller on a raceway: the whole demo, quick."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from checks import Check, both_sizes, left_behind, missed

import warpffrf as wf
from demos import crowned_on_raceway as demo
from demos.crowned_on_raceway import (
    CROWN,
    HEAVY,
    LIGHT,
    LOADING,
    PAIR,
    RADIUS,
    RING_RADIUS,
    SPIN_UP,
    STEEL,
    WAITING,
    at_ends,
    heavy_row,
)
from references.closed_forms import LineContact, contact_modulus
from references.closed_forms.elliptic import EllipticContact

MODULUS = contact_modulus(STEEL, STEEL)
ACROSS = 1.0 / (1.0 / RADIUS + 1.0 / RING_RADIUS)  # m, relative radius
BALANCE = 1e-6  # of the load
AXES, PEAK = 0.01, 0.01  # of half-axes and peak pressure: nine strips and a dozen rows in the ellipse
EDGE = 0.05  # of the peak: what the ends of the crowned roller may carry
SHARP = 1.3  # times the pressure in the middle, which a straight roller has in the row at its end, and more
RIPPLE = 1e-3  # of force and peak pressure over the cells that pass


def checks(crowned: wf.Result, straight: wf.Result) -> list[Check]:
    """The ellipse at the light load, the line at the heavy one, the ends, and what the mesh does to a turning ring."""
    pair, i = crowned.contact(PAIR), heavy_row(crowned)
    ellipse = EllipticContact(LIGHT, ACROSS, CROWN, MODULUS)
    line = LineContact(float(pair.line_load[i]), ACROSS, MODULUS)
    turning = crowned.time >= LOADING + WAITING + SPIN_UP
    force, peak = pair.force_magnitude[turning], pair.mid_peak_pressure[turning]
    a, b = ellipse.half_axes
    return [
        Check("light: force", float(pair.force_magnitude[0]), LIGHT, "statics", BALANCE, "N"),
        Check("light: half-axis across", float(pair.half_widths[0, 0]), a, "Hertz", AXES, "um", 1e6),
        Check("light: half-axis along", float(pair.half_widths[0, 1]), b, "Hertz", AXES, "mm", 1e3),
        Check("light: peak pressure", float(pair.peak_pressure[0]), ellipse.peak_pressure, "Hertz", PEAK, "MPa", 1e-6),
        Check("heavy: force", float(pair.force_magnitude[i]), HEAVY, "statics", BALANCE, "N"),
        Check("heavy: half-width at mid-width", float(pair.half_width[i]), line.half_width, "Hertz at the line load",
              AXES, "um", 1e6),
        Check("heavy: peak pressure at mid-width", float(pair.mid_peak_pressure[i]), line.peak_pressure,
              "Hertz at the line load", PEAK, "MPa", 1e-6),
        Check("pressure at the ends over the middle", at_ends(crowned, i), 0.0, "crowned", EDGE, scale=1.0),
        Check("of a straight roller, cut at", min(at_ends(straight, heavy_row(straight)), SHARP), SHARP,
              "edges", 0.0),
        Check("ripple of the force while it turns", float(np.ptp(force) / force.mean()), 0.0, "round rims", RIPPLE,
              scale=1.0),
        Check("ripple of the peak pressure", float(np.ptp(peak) / peak.mean()), 0.0, "round rims", RIPPLE, scale=1.0),
    ]  # fmt: skip


@both_sizes
def test_the_whole_demo(tmp_path: Path, quick: bool) -> None:
    crowned, straight = demo.main(tmp_path, quick=quick, progress=False)
    left_behind(tmp_path, "crowned_on_raceway", "straight")
    assert not missed(checks(crowned, straight))
