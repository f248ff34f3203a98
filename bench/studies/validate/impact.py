"""Verification: impact, and the ledger of energy."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from references.closed_forms import contact_modulus
from scenes.rollers import roller_body
from studies.contact import coarse_points as points
from studies.contact import colliding_bars as bars
from studies.contact.impact import drop
from studies.validate.case import Row, case

ROOM = "Impact"


@case(ROOM, "H. Hertz (1882); K. L. Johnson, Contact Mechanics (1985), section 11.4")
def ball_strikes_half_space() -> Iterator[Row]:
    """C7: a steel ball of R 10 mm strikes a steel half-space at 0.1 m/s; a ball of finite elements of half the modulus,
    five elements on the radius, on a rigid plane"""
    both = replace(points.STEEL, youngs_modulus=0.5 * points.STEEL.youngs_modulus)
    modulus = contact_modulus(points.STEEL, points.STEEL)
    result, exact = points.struck([points.ball(both, points.PLAIN)], modulus, points.SPEED)
    force, duration, approach, speed = points.impact_errors(result, exact)
    yield Row("largest force", 110.025 * (1.0 + force), 110.025, 0.02, "N")
    yield Row("time of contact", 109.253 * (1.0 + duration), 109.253, 0.02, "µs")
    yield Row("largest approach", 3.71195 * (1.0 + approach), 3.71195, 0.02, "µm")
    yield Row("speed after over before", 1.0 + speed, 1.0, 0.02)


@case(ROOM, "B. de Saint-Venant, J. Math. Pures Appl. 12 (1867) 237: time 2L/c, a rectangle of force")
def colliding_bars() -> Iterator[Row]:
    """C8: two equal steel bars of 1 m collide at 0.1 m/s; 50 modes, damped by default, worst of three phases"""
    found = [bars.measured(bars.collide(50, phase=phase)) for phase in (0.0, 0.37, 0.71)]
    time, impulse, mean = (max((getattr(f, key) for f in found), key=abs) for key in ("duration", "impulse", "mean"))
    yield Row("time of contact", 385.45 * (1.0 + time), 385.45, 0.02, "µs")
    stress = 1e-6 * bars.EXACT.stress
    yield Row("stress, mean of the plateau", stress * (1.0 + mean), stress, 0.02, "MPa")
    yield Row("impulse over the closed form's", 1.0 + impulse, 1.0, 0.02)
    yield Row("energy gained", max(f.gained for f in found), 0.0, 1e-2, scale=1.0)


@case(ROOM, "Energy: no gain; the bounce of the finest step")
def dropped_roller() -> Iterator[Row]:
    """C10: a roller dropped by 1 mm on another, steps of 10 µs to 1 ms, two phases of the touch in a step, the worst"""
    body = roller_body(180, layers=5, axial=2, grading=1.6, order=2, cache=False)
    finest, _ = drop(body, body, step=1e-6)
    found = [drop(body, body, step=h, phase=p)[0] for h in (1e-5, 1e-4, 1e-3) for p in (0.0, 0.5)]
    bounce = max((one.restitution for one in found), key=lambda e: abs(e - finest.restitution))
    yield Row("energy gained over that at hand", max(one.rise for one in found), 0.0, 0.01, scale=1.0)
    yield Row("restitution, against that at 1 µs", bounce, finest.restitution, 0.03)
