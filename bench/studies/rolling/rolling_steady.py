"""Steady rolling of rollers with friction on contact-fixed cells: the rows of `rolling_patches` on Carter,
CONTACT's Eurosprinter and Kalker's coefficients.

Every function makes one table or one figure of it. What is prescribed is in `scenes.rolling_pairs`; forces are means
over the last crossing of the patch. `strips`: of the grid, 1.3 half-widths either way.
"""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np
from scipy.optimize import brentq
from scipy.special import elliprd

from references.closed_forms import CarterRolling
from references.closed_forms import rolling_tables as published
from references.half_space.patch_rolling import HalfSpaces, PatchRolling, settle
from scenes.rolling_pairs import (
    FRICTION,
    LASTS,
    PAIR,
    PLANE_STEEL,
    SPEED,
    WIDTH,
    Drives,
    R,
    Rolled,
    elliptic_contact,
    line_contact,
    pair,
    reduced,
    roll,
    roller,
    run,
)
from warpffrf.model.material import Material
from warpffrf.model.reduced.body import ReducedBody
from warpffrf.model.signals import Table
from warpffrf.online.compile.patches.plan import span_of
from warpffrf.study.markdown import table

Array = np.ndarray
SIZE = 4e-3  # m, of the cells of meshes unless given
APPROACH, HALF_WIDTH = 8e-6, 2.6e-4  # m, of straight rollers of steel
STRIPS = (11, 15, 21, 31, 52)
ADVANCES = (0.5, 1.0, 1.37, 2.0, 2.5)  # strips per step
CREEPAGES = (6e-4, 1.5e-3)  # 0.35 and 0.73 mu N
LONG, SHORT = 25.0, 8.0  # crossings after which line and point contacts are steady to 2e-4
FINE = (52, 1.0)  # strips, strips per step of the solution that transients are compared with
STANDING, WOUND = 1e-3, 1.5e-6  # s of standing in which the lower roller is held back by that way [m]
BESIDE = 10.0  # crossings of a transient
NO_SLIP = 20.0  # coefficient of friction for Kalker's coefficients
SMALL, TILT = 1e-4, 5e-3  # creepage, and rad
CROWN = 0.14216  # m, of the Eurosprinter at R


# --- Carter ---


@cache
def straight() -> ReducedBody:
    """The straight roller in plane strain on 4 mm."""
    return reduced(roller(SIZE), PLANE_STEEL)


@cache
def carter_error(strips: int, advance: float, creepage: float, crossings: float = LONG) -> tuple[float, Rolled]:
    """Q of two rollers against Carter's, over mu N, and what was found."""
    body = straight()
    scene = pair(body, body, APPROACH, Drives(creepage=creepage), cells=(strips, 5))
    found = roll(scene, HALF_WIDTH, strips, advance, crossings)
    carter = CarterRolling(line_contact(found.load, PLANE_STEEL, PLANE_STEEL), FRICTION, creepage)
    return abs(float(found.share[0])) - carter.share, found


def carter_rows() -> list[list[str]]:
    """Steps down; by strips: errors at both creepages, and the same against the finest cells."""
    rows = []
    finest = {xi: abs(float(carter_error(STRIPS[-1], 1.0, xi)[1].share[0])) for xi in CREEPAGES}
    for advance in ADVANCES:
        row = [f"{advance:g}"]
        for strips in STRIPS:
            if advance < 1.0 and strips > 21:  # many steps
                row.append("")
                continue
            both = [carter_error(strips, advance, xi) for xi in CREEPAGES]
            beside = [abs(float(found.share[0])) - finest[xi] for (_, found), xi in zip(both, CREEPAGES, strict=True)]
            row.append(", ".join(f"{100 * e:+.2f}" for e, _ in both) + " (" + _percents(beside) + ")")
        rows.append(row)
    return rows


@cache
def transient(strips: int, advance: float, creepage: float = CREEPAGES[1]) -> tuple[Array, Array]:
    """Time [s] and Q/(mu N): pressed, wound up while it stands (Cattaneo), then rolling at a creepage (Carter)."""
    step = advance * 2.0 * span_of(strips) * HALF_WIDTH / strips / SPEED
    hold, rise = STANDING, 0.5 * STANDING
    rate = -WOUND / (0.5 * hold) / SPEED
    times = [0.0, 0.5 * hold, hold, hold + rise, LASTS]
    lower = Table(times, [0.0, 0.0, 0.0, 1.0, 1.0])
    upper = Table(times, [0.0, rate, 0.0, 1.0 - creepage, 1.0 - creepage])
    body = straight()
    scene = pair(body, body, APPROACH, Drives(speeds=(lower, upper)), cells=(strips, 5))
    steps = int(np.ceil((hold + rise + BESIDE * 2.0 * HALF_WIDTH / SPEED) / step))
    result = run(scene, steps, step)
    contact: Any = result.contact(PAIR)
    return result.time, contact.friction.tangential_force[:, 0] / (FRICTION * contact.normal_load)


def transient_error(strips: int, advance: float) -> float:
    """Largest difference at any instant from the fine solution, over mu N."""
    fine, (t, q) = transient(*FINE), transient(strips, advance)
    return float(np.abs(q - np.interp(t, *fine)).max())


def transient_rows() -> list[list[str]]:
    """Steps down, strips across."""
    return [[f"{c:g}", *(f"{100 * transient_error(n, c):.2f}" for n in (11, 15, 21))] for c in (0.5, 1.0, 1.37, 2.0)]


# --- Eurosprinter ---


@cache
def crowned(size: float = SIZE, order: int = 2) -> ReducedBody:
    """A roller that is CONTACT's Eurosprinter, for a pair of equal ones."""
    return reduced(roller(size, order=order, crown_radius=CROWN), rail_steel(), crowned=True)


def rail_steel() -> Material:
    """Of wheel and rail."""
    nu = published.EUROSPRINTER_POISSON
    return Material(2.0 * published.EUROSPRINTER_SHEAR * (1.0 + nu), nu, 7850.0, name="rail")


def eurosprinter(creepage: float, cells: int) -> tuple[float, float]:
    """F_x/(mu N) of the rollers, and of the law without bodies on the same cells."""
    scale = 0.5 * R / published.EUROSPRINTER_RADII[0]
    half_width, approach = published.EUROSPRINTER_PATCH[0] * scale, published.EUROSPRINTER_PATCH[3] * scale
    body, mu = crowned(), published.EUROSPRINTER_FRICTION
    scene = pair(body, body, 1.006 * approach, Drives(creepage=creepage), cells=(cells, cells), friction=mu)
    found = roll(scene, half_width, cells, 1.0, SHORT, friction=mu)
    contact = elliptic_contact(found.load, CROWN, rail_steel())
    law = PatchRolling(contact, mu, (cells, cells), HalfSpaces(rail_steel(), rail_steel()))
    law.begin(law.grid.size[0], (-creepage, 0.0, 0.0))
    return abs(float(found.share[0])), abs(float(settle(law, 1.0, (-creepage, 0.0, 0.0))[-1, 0]))


def eurosprinter_rows() -> list[list[str]]:
    """Creepages down: CONTACT, rollers, difference, law."""
    rows = []
    for creepage, wanted in published.EUROSPRINTER_FORCES:
        for cells in (13, 21) if creepage in (4e-4, 1.6e-3) else (13,):
            found, law = eurosprinter(creepage, cells)
            rows.append([f"{creepage:g}", str(cells), f"{wanted:.4f}", f"{found:.4f}", f"{100 * (found - wanted):+.2f}",
                         f"{100 * (found - law):+.2f}"])  # fmt: skip
    return rows


# --- Kalker ---


def kalker(ratio: float, poisson: float, cells: int) -> Array:
    """C_11, C_22, C_23 of two crowned rollers with a/b = ratio over Kalker's, less 1; spin by a tilted axle."""
    material = Material(210e9, poisson, 7850.0)
    k2 = ratio**-2.0
    crown = R * float(elliprd(0.0, k2, 1.0) / elliprd(0.0, 1.0, k2))
    body = reduced(roller(SIZE, crown_radius=crown, width=min(WIDTH, 0.6 * crown)), material, crowned=True)
    size = 2.5e-4

    def excess(load: float) -> float:
        return float(np.prod(elliptic_contact(load, crown, material).half_axes)) / size**2 - 1.0

    load: Any = brentq(excess, 1.0, 1e5)
    contact = elliptic_contact(load, crown, material)
    found = []
    cases = ((Drives(creepage=SMALL), SMALL, 0), (Drives(lateral_creepage=SMALL), SMALL, 1),
             (Drives(tilt=TILT), np.sin(TILT) / R, 1))  # fmt: skip
    for k, (drives, size_of, axis) in enumerate(cases):
        scene = pair(body, body, 1.005 * contact.approach, drives, cells=(cells, cells), crown_radius=crown,
                     friction=NO_SLIP)  # fmt: skip
        rolled = roll(scene, contact.half_axes[0], cells, 1.0, SHORT, friction=NO_SLIP)
        mean = float(np.sqrt(np.prod(elliptic_contact(rolled.load, crown, material).half_axes)))
        force = abs(float(rolled.share[axis])) * NO_SLIP * rolled.load
        found.append(force / (material.lame[1] * mean**2 * size_of * (mean if k == 2 else 1.0)))
    # three ratios of Poisson, a parabola between
    wanted = [np.polyval(np.polyfit(published.KALKER_POISSON, row, 2), poisson) for row in published.KALKER[ratio]]
    return np.array(found) / np.array(wanted) - 1.0


def kalker_rows(cells: int = 21) -> list[list[str]]:
    """Ellipses and Poisson's ratios down: errors."""
    rows = []
    for ratio in published.KALKER:
        for poisson in (0.0, 0.25, 0.49):
            rows.append([f"{ratio:g}", f"{poisson:g}", *(f"{e:+.1%}" for e in kalker(ratio, poisson, cells))])
    return rows


def _percents(values: list[float]) -> str:
    return ", ".join(f"{100 * v:+.2f}" for v in values)


def compute() -> dict[str, list[list[str]]]:
    """The figures of the page."""
    return {
        "carter": carter_rows(),
        "transient": transient_rows(),
        "eurosprinter": eurosprinter_rows(),
        "kalker": kalker_rows(),
    }


def section(found: dict[str, list[list[str]]]) -> str:
    """What the page says on steady rolling."""
    return f"""## Carter

Two straight rollers without Poisson's ratio (plane strain), half-width {HALF_WIDTH * 1e3:.2f} mm, 4 mm mesh. Error of Q
against Carter's at the prescribed creepages {CREEPAGES[0]:g} and {CREEPAGES[1]:g}, of mu N in percent, in brackets
against {STRIPS[-1]} strips at one per step. Strips across over 1.3 of 2 a, steps in strips down.

{table(["strips per step", *(str(n) for n in STRIPS)], found["carter"])}
From pressing through standing (Cattaneo, about 0.6 mu N against the later creep) to rolling (Carter): largest
difference at any instant from {FINE[0]} strips at {FINE[1]:g} per step, of mu N in percent.

{table(["strips per step", "11", "15", "21"], found["transient"])}
## CONTACT's Eurosprinter

Two crowned rollers that are the Eurosprinter by similarity (R 50, crown {1e3 * CROWN:.1f} mm): F_x/(mu N); differences
from CONTACT and from the law without bodies on the same cells, of mu N in percent.

{table(["creepage", "cells", "CONTACT", "rollers", "from CONTACT", "from the law"], found["eurosprinter"])}
## Kalker's coefficients

Two crowned rollers, friction {NO_SLIP:g}, 21 x 21 cells, a b = (0.25 mm)^2; C_22 by a lateral speed, C_23 by an upper
axle tilted by {1e3 * TILT:g} mrad. Relative errors compared with the table (a parabola between its Poisson's ratios).

{table(["a/b", "Poisson", "C11", "C22", "C23"], found["kalker"])}
"""
