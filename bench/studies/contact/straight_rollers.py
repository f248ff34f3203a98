"""Straight rollers: pressure compared with Hertz, ripple, convergence, impact; some minutes."""

from __future__ import annotations

from typing import Any

import numpy as np

from scenes.rollers import roller_body
from studies.contact.convergence import rates, refine
from studies.contact.hertz import hertz_phases
from studies.contact.impact import Drop, drop
from studies.contact.ripple import SENSES, ripples, worst
from warpffrf.study.markdown import table

MESHES = {  # equal layers and rows of nodes; linear cells need twice as many for the same spacing of nodes
    1: {"sectors": 720, "layers": 14, "axial": 4, "grading": 1.3},
    2: {"sectors": 720, "layers": 9, "axial": 2, "grading": 1.4},
}
NAMES = {1: "linear", 2: "quadratic"}


def convergence_rows() -> list[list[str]]:
    """Force against approach under refinement."""
    rows = []
    for order, levels in ((1, 4), (2, 3)):
        found = refine(order, levels)
        observed = [np.nan, np.nan, *rates(found)]
        for level, rate in zip(found, observed, strict=True):
            shown = "" if np.isnan(rate) else f"{rate:.2f}"
            force, size = f"{level.force:.1f}", f"{level.elements:.2f}"
            rows.append([NAMES[order], str(level.sectors), str(level.dofs), size, force, f"{level.ripple:.2%}", shown])
    return rows


def hertz_rows() -> tuple[list[list[str]], list[list[str]]]:
    """Mid-plane compared with Hertz, and ripple."""
    rows, waves = [], []
    for order, mesh in MESHES.items():
        body = roller_body(**mesh, order=order)
        for elements in (2.0, 4.0, 5.0, 6.0):
            for sense, e in hertz_phases(body, elements).items():
                width, peak = e.worst()
                nodal = float(np.abs(e.nodal_peak).max())
                shown = [f"{e.elements.mean():.2f}", sense, f"{width:.2%}", f"{peak:.2%}", f"{nodal:.2%}"]
                rows.append([NAMES[order], *shown])
        for elements in (2.0, 4.0):
            found = ripples(body, elements * np.linspace(0.95, 1.05, 5))
            for sense in SENSES:
                w = worst([r for r in found if r.sense == sense])
                waves.append(
                    [NAMES[order], f"{elements:g}", sense, f"{w.value:.3%}", f"{w.half_width:.2f}", f"{w.phase:g}"]
                )
    return rows, waves


def impact_rows() -> tuple[list[list[str]], float]:
    """Restitution and ledger of a dropped roller by the step, and the restitution with a step of 1e-7 s."""
    body = roller_body(180, layers=5, axial=2, grading=1.6, order=2)
    finest, _ = drop(body, body, step=1e-7)
    rows = []
    for step in (1e-6, 1e-5, 1e-4, 1e-3):
        found: list[Drop] = [drop(body, body, step=step, phase=i / 20.0)[0] for i in range(20)]
        e = np.array([d.restitution for d in found])
        rise, loss = max(d.rise for d in found), min(d.loss for d in found)
        steps = f"{np.mean([d.accepted for d in found]):.0f}"
        rows.append([f"{step:g}", f"{e.min():.4f} to {e.max():.4f}", f"{rise:.2%}", f"{loss:.2%}", steps])
    return rows, finest.restitution


def compute() -> dict[str, Any]:
    """The figures of the page."""
    hertz, ripple = hertz_rows()
    impact, restitution = impact_rows()
    return {
        "hertz": hertz, "ripple": ripple, "convergence": convergence_rows(), "impact": impact,
        "restitution": restitution,
    }  # fmt: skip


def page(found: dict[str, Any]) -> str:
    """The whole page."""
    head = ["elements", "per half-width", "sense", "half-width error", "peak error", "largest nodal error"]
    wave_head = ["elements", "per half-width", "sense", "worst ripple", "at", "phase"]
    force_head = ["elements", "sectors", "FE dofs", "per half-width", "force [N]", "ripple", "rate"]
    drop_head = ["step [s]", "restitution", "largest rise of the ledger", "largest loss", "accepted steps"]
    return f"""# Straight rollers: Hertz, ripple, convergence and impact

Two equal steel rollers (R 50 mm, bore 15 mm, width 20 mm).

## Mid-plane compared with Hertz, and ripple

Mid-plane of the 3-D pair against Hertz's line contact at the line load found there; worst of 8 phases of the contact
grid. Half-width (twice the root of the second moment) and peak as results report them. *rolling*: opposite rotations,
the two grids keep their relative phase; *sliding*: every relative phase occurs. Quadratic elements carry two grid nodes
each.

{table(head, found["hertz"])}
Peak-to-peak ripple of the force at constant approach over its mean: 12 positions in a pitch, 5 relative phases, sizes
of the patch within 5 % of the one named; worst of all, and where.

{table(wave_head, found["ripple"])}
## Force against approach under refinement

The rollers at an approach of 0.8 mm, axles fixed. All counts double from level to level, the grading of the layers
keeps the same map; the force is the mean over 8 phases of the grid. Rate: log2 of the ratio of successive differences
of the force. Linear elements promise 2. Quadratic ones are limited by the square root in which the pressure ends at the
edge of the patch, to between 2 and 3.

{table(force_head, found["convergence"])}
## A roller dropped through 1 mm

The upper roller with its carriage falls on the lower one; 20 phases of the impact within a step. Restitution of the
first bounce: speed of the common centre of mass of roller and carriage after over before; what is missing to 1 rings
in the rollers. With a step of 1e-7 s it is {found["restitution"]:.4f}. Ledger: all energy that no force accounts for
(lines `numerical` and `contact_grid`), over the energy at hand.

{table(drop_head, found["impact"])}"""
