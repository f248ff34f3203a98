"""Laps of the engine beside full finite elements with contact and friction: cells at nodes, facets and fewer, motion.

`python -m warpffrf.study.lap_nodes [FOLDER]` writes docs/studies/lap_nodes.md. Five minutes. Scenes and full models are
those of `lap_stacks`.
"""

from __future__ import annotations

import sys
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from scipy.spatial import KDTree

from warpffrf.model import signals
from warpffrf.model.integrators import GeneralizedAlpha
from warpffrf.model.reduced_body import ReducedBody
from warpffrf.output.simulate import simulate
from warpffrf.study.lap_stacks import SIZE, Array, Cycle, Difference, Engine, Sheets, difference
from warpffrf.verification.laps.cells import Cells
from warpffrf.verification.laps.dynamics import Scheme, released
from warpffrf.verification.markdown import table

MADE = "Made by `python -m warpffrf.study.lap_nodes`; do not edit.\n"
PRELOAD = 4e3  # N, of each bolt
STEPS = (2, 8, 16)  # of preload, of a quarter and of half a cycle
SMALL = 1e-6  # of the loads, where laps are to be equal: what turning heads make is in proportion
FEWER = 1e-3  # of the loads where cells are fewer
# of the loads of two bodies: their places round off to 1e-17 m, which is 1e-7 N of a cell
APART = 0.1
TIP = {2: {"partial slip": 60.0, "near macro slip": 90.0}, 4: {"partial slip": 40.0, "near macro slip": 80.0}}  # N
ALONG = 20  # elements along the sheets; along squares of the coarse cells
SQUARES, NARROW = 60, SIZE[0] / 60  # elements along strips as wide as these are long, [m]
MODES = 10  # of the bodies in motion
RHO = 0.0  # of the integrator, see `motion_rows`
STEP, RUN = 2e-5, 400  # s, steps
GIVEN = ["sheets", "cells", "load", "pressure", "traction", "states that differ", "loss", "amplitude", "steps cut"]


def row(*names: str, found: Difference) -> list[str]:
    """A line of `GIVEN`."""
    return [
        *names, f"{found.pressure:.0e}", f"{found.traction:.0e}", f"{found.states} of {found.of}", f"{found.loss:+.0e}",
        f"{found.amplitude:+.0e}", f"{found.cut}",
    ]  # fmt: skip


def equal_rows(scale: float) -> list[list[str]]:
    """By sheets, cells and load: the engine with 4 vibration modes beside full finite elements."""
    rows = []
    for sheets, by, wide in ((2, "nodes", 1), (2, "nodes", 2), (4, "nodes", 1), (2, "facets", 1), (4, "facets", 1)):
        stacked = Sheets((ALONG, wide, 1), sheets)
        lap, body = stacked.condensed(by), stacked.reduced(4, by=by)
        for name, tip in TIP[sheets].items():
            if sheets == 4 and by == "nodes" and name != "partial slip":
                continue  # a minute of the full model
            cycle = Cycle.of(scale * PRELOAD, scale * tip, STEPS)
            found = difference(stacked.followed([body], cycle.path), lap, stacked.loads, cycle)
            rows.append(row(f"{sheets}, {wide} wide", f"{lap.cells.count} {by}", name, found=found))
    return rows


def modes_rows() -> list[list[str]]:
    """By sheets: static histories with 40 vibration modes, likewise."""
    rows = []
    for sheets, tips in TIP.items():
        stacked = Sheets((ALONG, 1, 1), sheets)
        lap, body = stacked.condensed("facets"), stacked.reduced(40, by="facets")
        for name, tip in tips.items():
            cycle = Cycle.of(SMALL * PRELOAD, SMALL * tip, STEPS)
            found = difference(stacked.followed([body], cycle.path), lap, stacked.loads, cycle)
            rows.append(row(f"{sheets}, 1 wide", f"{lap.cells.count} facets", name, found=found))
    return rows


def two_bodies_rows() -> list[list[str]]:
    """A body upon the other, meshes that match: beside the one body of full finite elements."""
    rows = []
    stacked = Sheets((ALONG, 1, 1))
    lap, bodies = stacked.condensed("facets"), stacked.reduced_parts(4)
    for name, tip in TIP[2].items():
        cycle = Cycle.of(APART * PRELOAD, APART * tip, STEPS)
        found = difference(stacked.followed(bodies, cycle.path), lap, stacked.loads, cycle)
        rows.append(row("2, two bodies", f"{lap.cells.count} facets", name, found=found))
    return rows


def mismatch_rows() -> list[list[str]]:
    """By elements along the lower and the upper sheet: loss and amplitude beside the finest full finite elements."""
    fine = Sheets((160, 1, 1))
    rows = []
    cycle = Cycle.of(APART * PRELOAD, APART * TIP[2]["partial slip"], STEPS)
    full = fine.condensed("facets").follow(fine.loads, cycle.path, fine.loads[:, 1:])
    for along, above in ((20, 20), (20, 30), (40, 40), (40, 60), (60, 40), (80, 80), (80, 120), (80, 40)):
        stacked = Sheets((along, 1, 1), second=above)
        found = stacked.followed(stacked.reduced_parts(4), cycle.path)
        loss = found.loss(cycle.first, cycle.last) / full.loss(cycle.first, cycle.last) - 1.0
        swing = np.ptp(found.tip[cycle.first :]) / np.ptp(full.observed[cycle.first :, 0]) - 1.0
        rows.append([f"{along} and {above}", f"{loss:+.2%}", f"{swing:+.3%}"])
    return rows


def cell_of(body: ReducedBody, cells: Cells) -> Array:
    """Cell of the lap of a body (c,) in which each of `cells` lies."""
    surface = body.laps["lap0"]
    found = KDTree(surface.triangles.mean(axis=1)[:, :2]).query(cells.points[:, :2])[1]
    return surface.cell[found]


def facet_means(facets: Cells, nodes: Cells) -> Array:
    """(facets, nodes): means over square facets of a strip of what stands at the nodes, biquadratic."""
    away = (nodes.points[None] - facets.points[:, None])[:, :, :2] / NARROW
    weight = np.where(np.abs(away) < 0.25, 4.0 / 6.0, np.where(np.abs(away) < 0.75, 1.0 / 6.0, 0.0))
    return weight.prod(axis=2)


def fewer_rows() -> list[list[str]]:
    """Strips of square facets: cells of some facets beside full finite elements of every node and every facet."""
    stacked = Sheets((SQUARES, 1, 1), width=NARROW)
    share = FEWER * NARROW / SIZE[1]
    facets, nodes = stacked.condensed("facets"), stacked.condensed("nodes")
    bodies = {n: stacked.reduced(4, by="facets", size=n * NARROW) for n in (1, 2, 4)}
    over = facet_means(facets.cells, nodes.cells)
    rows = []
    for name, tip in TIP[2].items():
        cycle = Cycle.of(share * PRELOAD, share * tip, STEPS)
        fine = facets.follow(stacked.loads, cycle.path, stacked.loads[:, 1:])
        finest = nodes.follow(stacked.loads, cycle.path, stacked.loads[:, 1:])
        for n, body in bodies.items():
            found = stacked.followed([body], cycle.path)
            p = found.pressure[-1][cell_of(body, facets.cells)]
            line = [f"{body.laps['lap0'].cells}", f"{n}", name]
            for full, exact in ((fine, fine.pressure[-1]), (finest, over @ finest.pressure[-1])):
                lost, swing = full.loss(cycle.first, cycle.last), np.ptp(full.observed[cycle.first :, 0])
                line += [
                    f"{np.linalg.norm(p - exact) / np.linalg.norm(exact):.1%}",
                    f"{found.loss(cycle.first, cycle.last) / lost - 1.0:+.1%}",
                    f"{np.ptp(found.tip[cycle.first :]) / swing - 1.0:+.2%}",
                ]
            rows.append(line)
    return rows


@dataclass(frozen=True)
class Moved:
    """One motion of both: rms of the difference at the tip over the rms of the tip's motion about its mean, work of
    friction relative, and cells that differ in state, a share."""

    rms: float
    loss: float
    states: float


def motion(stacked: Sheets, modes: int, scale: float, steps: int, shake: float = 0.0) -> Moved:
    """Tip force let go after a static history (shake 0), or from rest under preload a force at the tip of this
    frequency [Hz]."""
    lap, body = stacked.condensed("facets"), stacked.reduced(modes, by="facets")
    pre, tip = scale * PRELOAD, scale * TIP[2]["near macro slip"]
    pulled = 0.0 if shake else tip
    before = np.array([[0.5 * pre, 0.0], [pre, 0.0], [pre, 0.5 * pulled], [pre, pulled]])

    def force(t: float) -> float:
        return 0.25 * tip * np.sin(2.0 * np.pi * shake * t)

    full = released(
        lap, stacked.loads, before, lambda t: np.array([pre, force(t)]), steps=steps, step=STEP,
        scheme=Scheme.damped(RHO), observed=stacked.loads[:, 1:],
    )  # fmt: skip
    rest = len(before) - 1.0
    after = STEP * np.arange(1, steps + 1)
    times = np.concatenate([np.arange(rest + 1.0), rest + after])
    bolt, pull = (
        signals.Table(times, np.concatenate([before[:, i], late]))
        for i, late in enumerate((np.full(steps, pre), np.array([force(t) for t in after])))
    )
    scene = stacked.scene([body], bolt, pull)
    held = simulate(scene, rest, step=1.0, kind="static", progress=False)
    found = simulate(
        scene, steps * STEP, step=STEP, start=held, integrator=GeneralizedAlpha(rho_inf=RHO), progress=False
    ).history
    if found.status != "completed":
        raise RuntimeError(f"sheets: {found.status}: {found.message}")
    engine = Engine(found, SIZE[2] - 0.5 * stacked.height)
    exact = full.observed[1:, 0]
    lost = engine.lost[-1] - Engine(held.history, 0.0).lost[-1]
    return Moved(
        float(np.linalg.norm(engine.tip - exact) / np.linalg.norm(exact - exact.mean())),
        float(lost / full.dissipated[-1] - 1.0), float(np.mean(engine.state != full.state[1:])),
    )  # fmt: skip


def motion_rows() -> list[list[str]]:
    """Release and shaking, with `MODES` vibration modes and more, under small loads and the whole ones."""
    stacked = Sheets((ALONG, 1, 1))
    cases = (
        ("release", MODES, FEWER, 0.0), ("release", 40, FEWER, 0.0), ("shaken, 200 Hz", MODES, FEWER, 200.0),
        ("release", MODES, 1.0, 0.0),
    )  # fmt: skip
    rows = []
    for name, modes, scale, shake in cases:
        found = motion(stacked, modes, scale, RUN, shake)
        rows.append([
            name, f"{modes}", f"{scale:g}", f"{found.rms:.2%}", f"{found.loss:+.2%}", f"{found.states:.1%}",
        ])  # fmt: skip
    return rows


def page() -> str:
    """Markdown."""
    return f"""# Laps beside full finite elements

{MADE}
Steel sheets, {SIZE[0] * 1e3:g} mm long and {SIZE[2] * 1e3:g} mm high together, in one body that hangs together at its
clamped root, {ALONG} hex27 along each; two bolts as pairs of forces of {PRELOAD * 1e-3:g} kN, friction 0.2, a force at
the tip of the upper sheet that goes up, down and up again (`warpffrf.study.lap_stacks`). Held against
`warpffrf.verification.laps`, which has every node of the same mesh and shares no code with engine or reduction.
Pressures and tractions of all cells in all load steps, differences over the largest pressure; loss of the last cycle
and amplitude at the tip relative. *Steps cut*: load steps that the engine cut in parts, which the full model follows.

## The same cells

Loads are {SMALL:g} of the above. Targets: 1e-6 at all nodes, 1e-8 with the same facets (pressures).

{table(GIVEN, equal_rows(SMALL))}
The same under {FEWER:g} of the loads and the whole loads: differences grow with the load, as bolts of the engine keep
their direction while their heads turn and move against each other, which linear finite elements do not know.

{table(["of the loads", *GIVEN], [[f"{s:g}", *line] for s in (FEWER, 1.0) for line in large_rows(s)])}
## 40 vibration modes in place of 4

Target: the same to 1e-6.

{table(GIVEN, modes_rows())}
## Two bodies, one upon the other

Meshes that match, beside the full finite elements of the sheets together, {APART:g} of the loads:

{table(GIVEN, two_bodies_rows())}
Elements along the lower sheet, whose facets are the cells, and along the upper one, beside full finite elements with
160 along both; partial slip, {APART:g} of the loads.

{table(["elements", "loss", "amplitude"], mismatch_rows())}
## Fewer cells

A strip of {SQUARES} square facets, {NARROW * 1e3:.3g} mm wide, loads in proportion to the width. Beside full finite
elements with every facet, and with every node (two along a facet, three across). Targets: pressure 5 %
(L2), loss 15 % in partial slip and 1 % near macro slip, amplitude 0.5 %.

{table(["cells", "facets in each", "load", "pressure", "loss", "amplitude", "pressure, nodes", "loss, nodes",
        "amplitude, nodes"], fewer_rows())}
## Motion

Generalized-alpha of spectral radius {RHO:g} in both, steps of {STEP * 1e6:g} µs, {RUN} of them. Targets: 3 % of the
rms of the motion, 3 % of the work of friction.

{table(["motion", "modes", "of the loads", "rms", "work of friction", "states that differ"], motion_rows())}
{READ}"""  # fmt: skip


def large_rows(scale: float) -> list[list[str]]:
    """Two sheets by nodes under larger loads."""
    stacked = Sheets((ALONG, 1, 1))
    lap, body = stacked.condensed("nodes"), stacked.reduced(4, by="nodes")
    cycle = Cycle.of(scale * PRELOAD, scale * TIP[2]["partial slip"], STEPS)
    found = difference(stacked.followed([body], cycle.path), lap, stacked.loads, cycle)
    return [row("2, 1 wide", f"{lap.cells.count} nodes", "partial slip", found=found)]


READ = """\
With the same cells the engine is the full finite elements, to Newton's tolerance times what cells beside each other are
stiffer than one alone. What is left of losses where the engine cut load steps are cuts of unequal length, which the
full model takes as equal: pressures and tractions come together again, lost work does not. Under the whole loads the
difference is that of the bolts: as pairs of forces that keep their direction they turn sheets that slide past each
other, 1 % of the amplitude here, 5 % of the rms of a motion.

Two bodies agree as well; that their loads are larger is for round-off of their places. Cells need not match: of meshes
that do not, the coarser one sets the error, and 20 elements are too coarse for partial slip in themselves. Facets of
3.3 mm, half of the nodes along the strip, meet all targets beside the nodes. Cells of two facets miss that of the
pressure, which is steep under the edges of the heads, and nearly meet that of the loss near macro slip (1.1 %, 1.6 %
beside the nodes); cells of four have lost partial slip.

Motion: with a spectral radius of 0.8 the full finite elements themselves blow up, as faces that are open chatter in
steps that do not resolve them; with 0 both agree.
"""


def main(folder: Path) -> None:
    """Writes the page to `folder`."""
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "lap_nodes.md").write_text(page(), encoding="utf-8")


if __name__ == "__main__":
    main(Path(sys.argv[1]) if len(sys.argv) > 1 else Path("docs/studies"))
