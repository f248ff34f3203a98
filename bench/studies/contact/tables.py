"""Writes the tables of docs/studies: `python -m studies.contact.tables [FOLDER]`. Some minutes.

Every figure in the tables is computed by this script; the text around them says what was done.
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np

from scenes.rollers import roller_body
from studies.contact.convergence import rates, refine
from studies.contact.hertz import hertz_phases
from studies.contact.impact import Drop, drop
from studies.contact.ripple import SENSES, ripples, worst
from warpffrf.study.markdown import table

MADE = "Made by `python -m studies.contact.tables`; do not edit.\n"
MESHES = {  # equal layers and rows of hats; linear cells need twice as many for the same spacing of hats
    1: {"sectors": 720, "layers": 14, "axial": 4, "grading": 1.3},
    2: {"sectors": 720, "layers": 9, "axial": 2, "grading": 1.4},
}
NAMES = {1: "linear", 2: "quadratic"}


def convergence_page() -> str:
    """Force against approach under refinement."""
    rows = []
    for order, levels in ((1, 4), (2, 3)):
        found = refine(order, levels)
        observed = [np.nan, np.nan, *rates(found)]
        for level, rate in zip(found, observed, strict=True):
            shown = "" if np.isnan(rate) else f"{rate:.2f}"
            force, size = f"{level.force:.1f}", f"{level.elements:.2f}"
            rows.append([NAMES[order], str(level.sectors), str(level.dofs), size, force, f"{level.ripple:.2%}", shown])
    head = ["elements", "sectors", "FE dofs", "per half-width", "force [N]", "ripple", "rate"]
    return f"""# Force against approach under refinement

{MADE}
Two equal steel rollers (R 50 mm, bore 15 mm, width 20 mm) at an approach of 0.8 mm, axles fixed. All counts double from
level to level, the grading of the layers keeps the same map; the force is the mean over 8 phases of the grid. Rate:
log2 of the ratio of successive differences of the force. Linear elements promise 2. Quadratic ones are limited by the
square root in which the pressure ends at the edge of the patch, to between 2 and 3.

{table(head, rows)}"""


def hertz_page() -> str:
    """Mid-plane beside Hertz, and ripple."""
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
    head = ["elements", "per half-width", "sense", "half-width error", "peak error", "largest hat's error"]
    wave_head = ["elements", "per half-width", "sense", "worst ripple", "at", "phase"]
    return f"""# Mid-plane beside Hertz, and ripple

{MADE}
Mid-plane of a 3-D pair of equal steel rollers against Hertz's line contact at the line load found there; worst of 8
phases of the contact grid. Half-width (twice the root of the second moment) and peak as results report them.
*rolling*: opposite turns, the two grids keep their relative phase; *sliding*: every relative phase occurs. Quadratic
elements carry two hats each.

{table(head, rows)}
Peak-to-peak ripple of the force at constant approach over its mean: 12 positions in a pitch, 5 relative phases, sizes
of the patch within 5 % of the one named; worst of all, and where.

{table(wave_head, waves)}"""


def impact_page() -> str:
    """Restitution and ledger of a dropped roller."""
    body = roller_body(180, layers=5, axial=2, grading=1.6, order=2)
    finest, _ = drop(body, body, step=1e-7)
    rows = []
    for step in (1e-6, 1e-5, 1e-4, 1e-3):
        found: list[Drop] = [drop(body, body, step=step, phase=i / 20.0)[0] for i in range(20)]
        e = np.array([d.restitution for d in found])
        rise, loss = max(d.rise for d in found), min(d.loss for d in found)
        steps = f"{np.mean([d.accepted for d in found]):.0f}"
        rows.append([f"{step:g}", f"{e.min():.4f} to {e.max():.4f}", f"{rise:.2%}", f"{loss:.2%}", steps])
    head = ["step [s]", "restitution", "largest rise of the ledger", "largest loss", "accepted steps"]
    return f"""# A roller dropped through 1 mm

{MADE}
The upper roller with its carriage falls on the lower one; 20 phases of the impact within a step. Restitution of the
first bounce: speed of the common centre of mass of roller and carriage after over before; what is missing to 1 rings
in the rollers. With a step of 1e-7 s it is {finest.restitution:.4f}. Ledger: all energy that no force accounts for
(lines `numerical` and `contact_grid`), over the energy at hand.

{table(head, rows)}"""


PAGES = {"convergence.md": convergence_page, "hertz_and_ripple.md": hertz_page, "impact.md": impact_page}


def main() -> None:
    folder = Path(sys.argv[1] if len(sys.argv) > 1 else "docs/studies")
    folder.mkdir(parents=True, exist_ok=True)
    for name, page in PAGES.items():
        (folder / name).write_text(page())
        print(folder / name)


if __name__ == "__main__":
    main()
