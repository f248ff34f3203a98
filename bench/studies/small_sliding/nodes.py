"""Small-sliding contacts of the engine compared with full finite elements; five minutes.

Cells at nodes, facets and fewer, and motion; contact and friction. Scenes and full models are those of `stacks`.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import scipy.sparse as sp
from scipy.sparse.linalg import splu

from references.small_sliding.cells import Cells
from references.small_sliding.dynamics import Scheme, released
from references.small_sliding.full_model import FullModel
from references.small_sliding.quasi_static import StaticSmallSliding
from studies.small_sliding.stacks import (
    BOLTS,
    FRICTION,
    SIZE,
    Array,
    Cycle,
    Difference,
    Engine,
    Rows,
    Sheets,
    between,
    cell_of,
    difference,
)
from warpffrf.model import signals
from warpffrf.model.integrators import GeneralizedAlpha
from warpffrf.online import Settings
from warpffrf.output.options import RunOptions
from warpffrf.output.simulate import simulate, static
from warpffrf.study.markdown import table

PRELOAD = 4e3  # N, of each bolt
SHANK = 2.6e8  # N/m, steel of 5 mm diameter, as long as the stack is high
STEPS = (2, 8, 16)  # of preload, of a quarter and of half a cycle
SHORTER = (2, 20, 40)
SMALL = 1e-6  # of the loads, where joint interfaces are to be equal: what turning heads make is in proportion
FEWER = 1e-3  # of the loads where cells are fewer
# of the loads of two bodies: their places round off to 1e-17 m, which is 1e-7 N of a cell
APART = 0.1
TIP = {2: {"partial slip": 60.0, "near macro slip": 90.0}, 4: {"partial slip": 40.0, "near macro slip": 80.0}}  # N
ALONG = 20  # elements along the sheets; along squares of the coarse cells
SQUARES, NARROW = 60, SIZE[0] / 60  # elements along strips as wide as these are long, [m]
GROWTHS = (0.5, 1.0)  # of graded cells
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
    """By sheets, cells and load: the engine with 4 vibration modes against full finite elements."""
    rows = []
    for sheets, by, wide in ((2, "nodes", 1), (2, "nodes", 2), (4, "nodes", 1), (2, "facets", 1), (4, "facets", 1)):
        stacked = Sheets((ALONG, wide, 1), sheets)
        lap, body = stacked.condensed(by), stacked.reduced(4, by=by)
        for name, tip in TIP[sheets].items():
            cycle = Cycle.of(scale * PRELOAD, scale * tip, STEPS)
            found = difference(stacked.followed([body], cycle.path), lap, stacked.loads, cycle)
            rows.append(row(f"{sheets}, {wide} wide", f"{lap.cells.count} {by}", name, found=found))
    return rows


def modes_rows() -> list[list[str]]:
    """By sheets: static histories with 40 vibration modes against full finite elements and against 4 modes."""
    rows = []
    for sheets, tips in TIP.items():
        stacked = Sheets((ALONG, 1, 1), sheets)
        lap = stacked.condensed("facets")
        few, many = (stacked.reduced(modes, by="facets") for modes in (4, 40))
        for name, tip in tips.items():
            cycle = Cycle.of(SMALL * PRELOAD, SMALL * tip, SHORTER)
            found, other = (stacked.followed([body], cycle.path) for body in (many, few))
            which = (f"{sheets}, 1 wide", f"{lap.cells.count} facets", name)
            rows.append(row(*which, "full model", found=difference(found, lap, stacked.loads, cycle)))
            rows.append(row(*which, "4 modes", found=between(found, other, cycle)))
    return rows


class Reordered(FullModel):
    """A full model eliminated in another order: what that changes is round-off."""

    def factor(self, A: Any) -> Any:
        """Solver of free dofs."""
        return splu(sp.csc_matrix(A[self.free][:, self.free]), permc_spec="COLAMD")


def round_off_rows() -> list[list[str]]:
    """Four sheets by facets near macro slip: the engine, by tolerance of Newton's method, and the full model eliminated
    in another order, each against the full model."""
    stacked = Sheets((ALONG, 1, 1), 4)
    lap, body = stacked.condensed("facets"), stacked.reduced(4, by="facets")
    cycle = Cycle.of(SMALL * PRELOAD, SMALL * TIP[4]["near macro slip"], STEPS)
    rows = []
    for tolerance in (1e-9, 1e-10, 1e-11):
        found = stacked.followed([body], cycle.path, settings=Settings(residual_tolerance=tolerance))
        one = difference(found, lap, stacked.loads, cycle)
        rows.append([f"engine, tolerance {tolerance:g}", *row(found=one)[:4]])
    same = StaticSmallSliding(Reordered(stacked.full.parts), lap.cells, FRICTION)
    full, other = (each.follow(stacked.loads, cycle.path, stacked.loads[:, 1:]) for each in (lap, same))
    one = between(Rows.of(other), Rows.of(full), cycle)
    return [*rows, ["full model in another order", *row(found=one)[:4]]]


def whole_rows() -> list[list[str]]:
    """Two sheets by nodes under larger loads, by kind of bolts: against linear full finite elements, and those with
    the terms of bolts on sheets that rotate."""
    rows = []
    for name, shank, scales in (("forces", None, (FEWER, 1.0)), ("springs", SHANK, (1.0,))):
        stacked = Sheets((ALONG, 1, 1), shank=shank)
        lap, body = stacked.condensed("nodes"), stacked.reduced(4, by="nodes")
        for scale in scales:
            cycle = Cycle.of(
                scale * PRELOAD, scale * TIP[2]["partial slip"], STEPS if shank is None else (1, *STEPS[1:])
            )
            found = stacked.followed([body], cycle.path)
            beside = [("linear", lap)]
            if scale == 1.0:
                tension = np.full(len(BOLTS), PRELOAD) if shank is None else found.tension
                beside.append(("with rotation", StaticSmallSliding(stacked.turning(tension), lap.cells, FRICTION)))
            for what, one in beside:
                rows.append(row(name, f"{scale:g}", what, found=difference(found, one, stacked.loads, cycle)))
    return rows


def two_bodies_rows() -> list[list[str]]:
    """A body upon the other, meshes that match: against the one body of full finite elements."""
    rows = []
    stacked = Sheets((ALONG, 1, 1))
    lap, bodies = stacked.condensed("facets"), stacked.reduced_parts(4)
    for name, tip in TIP[2].items():
        cycle = Cycle.of(APART * PRELOAD, APART * tip, STEPS)
        found = difference(stacked.followed(bodies, cycle.path), lap, stacked.loads, cycle)
        rows.append(row("2, two bodies", f"{lap.cells.count} facets", name, found=found))
    return rows


def mismatch_rows() -> list[list[str]]:
    """By elements along the lower and the upper sheet: loss and amplitude against the finest full finite elements."""
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


def facet_means(facets: Cells, nodes: Cells) -> Array:
    """(facets, nodes): means over square facets of a strip of what stands at the nodes, biquadratic."""
    away = (nodes.points[None] - facets.points[:, None])[:, :, :2] / NARROW
    weight = np.where(np.abs(away) < 0.25, 4.0 / 6.0, np.where(np.abs(away) < 0.75, 1.0 / 6.0, 0.0))
    return weight.prod(axis=2)


def fewer_rows() -> list[list[str]]:
    """Strips of square facets: cells of some facets against full finite elements of every node and every facet."""
    stacked = Sheets((SQUARES, 1, 1), width=NARROW)
    share = FEWER * NARROW / SIZE[1]
    facets, nodes = stacked.condensed("facets"), stacked.condensed("nodes")
    fine = tuple(head for heads in stacked.bolted for head in heads)
    graded = {f"graded, growth {growth:g}": {"growth": growth, "fine": fine} for growth in GROWTHS}
    ways: dict[str, dict[str, Any]] = {"each facet": {}, **graded}
    ways |= {f"{n} facets": {"size": n * NARROW} for n in (2, 4)}
    bodies = {way: stacked.reduced(4, by="facets", **given) for way, given in ways.items()}
    over = facet_means(facets.cells, nodes.cells)
    rows = []
    for name, tip in TIP[2].items():
        cycle = Cycle.of(share * PRELOAD, share * tip, STEPS)
        every = facets.follow(stacked.loads, cycle.path, stacked.loads[:, 1:])
        finest = nodes.follow(stacked.loads, cycle.path, stacked.loads[:, 1:])
        for way, body in bodies.items():
            found = stacked.followed([body], cycle.path)
            p = found.pressure[-1][cell_of(body, facets.cells)]
            line = [way, f"{body.matched['lap0'].cells}", name]
            for full, exact in ((every, every.pressure[-1]), (finest, over @ finest.pressure[-1])):
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


def motion(stacked: Sheets, modes: int, scale: float, steps: int, shake: float = 0.0, *, turned: bool = False) -> Moved:
    """Tip force let go after a static history (shake 0), or from rest under preload a force at the tip of this
    frequency [Hz]; rotated: the full model has what bolts make where sheets turn."""
    lap, body = stacked.condensed("facets"), stacked.reduced(modes, by="facets")
    pre, tip = scale * PRELOAD, scale * TIP[2]["near macro slip"]
    pulled = 0.0 if shake else tip
    before = np.array([[pre, 0.0], [pre, 0.5 * pulled], [pre, pulled]])

    def force(t: float) -> float:
        return 0.25 * tip * np.sin(2.0 * np.pi * shake * t)

    rest = len(before) - 1.0
    after = STEP * np.arange(1, steps + 1)
    times = np.concatenate([np.arange(rest + 1.0), rest + after])
    bolt, pull = (
        signals.Table(times, np.concatenate([before[:, i], late]))
        for i, late in enumerate((np.full(steps, pre), np.array([force(t) for t in after])))
    )
    scene = stacked.scene([body], bolt if stacked.shank is None else pre, pull)
    held = static(scene, rest, step=1.0, progress=False)
    found = simulate(
        scene,
        steps * STEP,
        step=STEP,
        start=held,
        options=RunOptions(integrator=GeneralizedAlpha(rho_inf=RHO)),
        progress=False,
    ).history
    if found.status != "completed":
        raise RuntimeError(f"sheets: {found.status}: {found.message}")
    engine = Engine(found, SIZE[2] - 0.5 * stacked.height)
    if turned:
        tension = np.full(len(BOLTS), pre) if stacked.shank is None else Engine(held.history, 0.0).tension
        lap = StaticSmallSliding(stacked.turning(tension), lap.cells, FRICTION)
    full = released(
        lap, stacked.loads, before, lambda t: np.array([pre, force(t)]), steps=steps, step=STEP,
        scheme=Scheme.damped(RHO), observed=stacked.loads[:, 1:],
    )  # fmt: skip
    exact = full.observed[1:, 0]
    lost = engine.lost[-1] - Engine(held.history, 0.0).lost[-1]
    return Moved(
        float(np.linalg.norm(engine.tip - exact) / np.linalg.norm(exact - exact.mean())),
        float(lost / full.dissipated[-1] - 1.0), float(np.mean(engine.state != full.state[1:])),
    )  # fmt: skip


def motion_rows() -> list[list[str]]:
    """Release and shaking, with `MODES` vibration modes and more, under small loads and the whole ones."""
    pairs, sprung = Sheets((ALONG, 1, 1)), Sheets((ALONG, 1, 1), shank=SHANK)
    release, shaken = ("release", 0.0), ("shaken, 200 Hz", 200.0)
    cases = (
        (release, pairs, MODES, FEWER, False), (release, pairs, 40, FEWER, False), (shaken, pairs, MODES, FEWER, False),
        (release, pairs, MODES, 1.0, False), (release, pairs, MODES, 1.0, True),
        (release, sprung, MODES, 1.0, False), (release, sprung, MODES, 1.0, True),
    )  # fmt: skip
    rows = []
    for (name, shake), stacked, modes, scale, turned in cases:
        found = motion(stacked, modes, scale, RUN, shake, turned=turned)
        rows.append([
            name, "forces" if stacked.shank is None else "springs", f"{modes}", f"{scale:g}",
            "with rotation" if turned else "linear", f"{found.rms:.2%}", f"{found.loss:+.2%}", f"{found.states:.1%}",
        ])  # fmt: skip
    return rows


def compute() -> dict[str, list[list[str]]]:
    """The figures of the page."""
    return {
        "equal": equal_rows(SMALL),
        "round_off": round_off_rows(),
        "whole": whole_rows(),
        "modes": modes_rows(),
        "two_bodies": two_bodies_rows(),
        "mismatch": mismatch_rows(),
        "fewer": fewer_rows(),
        "motion": motion_rows(),
    }


def page(found: dict[str, list[list[str]]]) -> str:
    """Markdown."""
    return f"""# Small-sliding contact compared with full finite elements

Steel sheets, {SIZE[0] * 1e3:g} mm long and {SIZE[2] * 1e3:g} mm high together, in one body that hangs together at its
clamped root, {ALONG} hex27 along each; two bolts as pairs of forces of {PRELOAD * 1e-3:g} kN, friction 0.2, a force at
the tip of the upper sheet that goes up, down and up again (`studies.small_sliding.stacks`). Compared with
`references.small_sliding`, which has every node of the same mesh and shares no code with engine or reduction.
Pressures and tractions of all cells in all load steps, differences over the largest pressure; loss of the last cycle
and amplitude at the tip relative. *Steps cut*: load steps that the engine cut in parts, which the full model follows.

## The same cells

Loads are {SMALL:g} of the above. Targets: 1e-6 at all nodes, 1e-8 with the same facets (pressures).

{table(GIVEN, found["equal"])}
What stands of four sheets is round-off of stiff cells between slender sheets, not Newton's tolerance. Four sheets by
facets near macro slip, compared with the full model, which eliminated in another order differs from itself:

{table(["found", *GIVEN[3:7]], found["round_off"])}
## Larger loads

Two sheets, cells at nodes, partial slip. Bolts of the engine follow their heads or do not while sheets rotate, which
linear finite elements do not know, and differences grow with the load: *forces* are pairs that keep their direction,
*springs* shanks of {1e-6 * SHANK:g} N/µm between the heads that pull with {PRELOAD * 1e-3:g} kN before anything
deforms. *With rotation*: the full finite elements have the quadratic part of the potential of either in addition,
two stiffnesses of rank one (`studies.small_sliding.bolts` derives them).

{table(["bolts", "of the loads", "full model", *GIVEN[3:]], found["whole"])}
## 40 vibration modes in place of 4

Target: the same to 1e-6. Load steps are {STEPS[1] / SHORTER[1]:g} times as long as above: in longer ones Newton's
method runs in circles with 40 modes and four sheets, and steps are cut, in parts of unequal length.

{table([*GIVEN[:3], "compared with", *GIVEN[3:]], found["modes"])}
## Two bodies, one upon the other

Meshes that match, compared with the full finite elements of the sheets together, {APART:g} of the loads:

{table(GIVEN, found["two_bodies"])}
Elements along the lower sheet, whose facets are the cells, and along the upper one, compared with full finite elements
with 160 along both; partial slip, {APART:g} of the loads.

{table(["elements", "loss", "amplitude"], found["mismatch"])}
## Fewer cells

A strip of {SQUARES} square facets, {NARROW * 1e3:.3g} mm wide, loads in proportion to the width. Compared with full
finite elements with every facet, and with every node (two along a facet, three across). *Graded*: cells grow away from
the edges of the bolts' heads through the sheet, `surfaces.Matched(growth=, fine=heads)`. Targets: pressure 5 % (L2),
    loss
15 % in partial slip and 1 % near macro slip, amplitude 0.5 %.

{table(["cells", "count", "load", "pressure", "loss", "amplitude", "pressure, nodes", "loss, nodes",
        "amplitude, nodes"], found["fewer"])}
## Motion

Generalized-alpha of spectral radius {RHO:g} in both, steps of {STEP * 1e6:g} µs, {RUN} of them. Targets: 3 % of the
rms of the motion, 3 % of the work of friction.

{table(["motion", "bolts", "modes", "of the loads", "full model", "rms", "work of friction", "states that differ"],
       found["motion"])}
{READ}"""  # fmt: skip


READ = """\
With the same cells the engine is the full finite elements, to round-off times what adjacent cells are stiffer than one
alone: pressures to 1e-8, tractions of four sheets to 6e-8, where the full model repeats itself to 1e-8. Larger loads:
what differs from linear finite elements is the rotation of bolts, and with its two stiffnesses of rank one the engine
is the full model again to the next order, in statics and in motion. As pairs of forces that keep their direction bolts
bend sheets on, +1.1 % of the amplitude and 4.7 % of the rms of a motion; as springs, which bolts are, they rotate with
the sheets, and -0.15 % and 1.7 % are left, for the straight lines of small displacements in a frame that has not
rotated as far. Pressures under springs differ by the squares of the rotations too, which stretch them and change their
tension.

Two bodies agree as well; that their loads are larger is for round-off of their places. Cells need not match: of meshes
that do not, the coarser one sets the error, and 20 elements are too coarse for partial slip in themselves. Facets of
3.3 mm, half of the nodes along the strip, meet all targets compared with the nodes, and so do 32
cells that are graded from the edges of the heads, where the pressure is steep. As many cells that are alike, of two
facets, miss the target of the pressure; cells of four have lost partial slip.

Motion: with a spectral radius of 0.8 the full finite elements themselves blow up, as faces that are open chatter in
steps that do not resolve them; with 0 both agree.
"""
