"""Writes docs/studies/joint_bases.md: `python -m warpffrf.study.joint_bases [FOLDER]`. Some minutes on one core.

Two ways of reducing a joint side by side: coordinates for the bodies (static and vibration modes, and trial vector
derivatives of the joint), or the flexibility of the relative motion of the joint's cells, all of them or fewer. Held
against full finite elements with contact and friction; every way goes through the same solver of the increment, so that
what differs is the space.
"""

from __future__ import annotations

import sys
import textwrap
import time
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import scipy.sparse as sp

from warpffrf.model.material import Material
from warpffrf.offline.bases.problem import lowest_modes
from warpffrf.offline.bases.tvd import joint_modes
from warpffrf.offline.elastic import ElasticModel
from warpffrf.offline.products import Limits
from warpffrf.offline.reduction import one_thread
from warpffrf.verification.laps.cells import Cells, facet_cells, gathered
from warpffrf.verification.laps.contact_program import SLIP
from warpffrf.verification.laps.full_model import FullModel, Part
from warpffrf.verification.laps.quasi_static import Followed, StaticLap, follow
from warpffrf.verification.laps.sheets import stack
from warpffrf.verification.markdown import table

Array = np.ndarray
STEEL = Material(210e9, 0.3, 7850.0, name="steel")
SIZE = (0.2, 0.01, 0.008)  # m, of a sheet
COUNTS = (160, 1, 2)  # hex27 of a sheet
BOLTS, HALF_WIDTH = (0.05, 0.15), 8e-3  # m: places of the bolts, half of their heads
PRELOAD = 4e3  # N, of each bolt
FRICTION = 0.2
LAYER = 2e14  # Pa/m, of both directions: what a space of few coordinates needs, to be able to press at all
TIP = {"partial slip": 60.0, "near macro slip": 90.0}  # N, amplitude at the tip
MODES = 20  # vibration modes beside the two static responses; of the open joint, many of them with no gap at all
TVD = (5, 10, 20, 40)  # joint modes from pressures, and as many from tractions
GROUPS = (2, 4, 8)  # facets in a cell
GROWTHS = (0.5, 0.25)  # of graded cells, over the distance from the nearest end or edge of a bolt's head
STEPS = (5, 15, 30)  # of preloading, of a quarter and of a half cycle


@dataclass(frozen=True, eq=False)
class Joint:
    """The full model: lap, cells, loads F (dofs, 2) (preload and tip), their responses, the base of static and
    vibration modes (dofs, m), and the model as the bases of `offline` see it (free dofs alone)."""

    lap: StaticLap
    loads: Array
    still: Array
    elastic: ElasticModel
    base: Array

    @property
    def cells(self) -> Cells:
        """One cell a facet."""
        return self.lap.cells


def two_sheets(counts: tuple[int, int, int] = COUNTS) -> Joint:
    """Two sheets clamped at x = 0, pressed together by two bolts, loaded at the tip of the upper one."""
    lower, upper = stack(SIZE, counts, 2)
    for k, place in enumerate(BOLTS):
        lower = lower.select(f"head{k}", "z_min", lambda c, x=place: np.abs(c[:, 0] - x) < HALF_WIDTH)
        upper = upper.select(f"head{k}", "z_max", lambda c, x=place: np.abs(c[:, 0] - x) < HALF_WIDTH)
    model = FullModel([Part(mesh, STEEL, ("x_min",)) for mesh in (lower, upper)])
    preload = np.zeros(model.size)
    for k in range(len(BOLTS)):
        preload += PRELOAD * (model.spread(0, f"head{k}", (0, 0, 1.0)) + model.spread(1, f"head{k}", (0, 0, -1.0)))
    loads = np.stack([preload, model.spread(1, "x_max", (0.0, 0.0, 1.0))], axis=1)
    cells = facet_cells(model, (0, "z_max"), (1, "z_min"))
    lap = StaticLap(model, cells, FRICTION, normal_compliance=1.0 / LAYER, tangential_compliance=1.0 / LAYER)
    free = model.free
    K, M = (sp.csr_matrix(A[free][:, free]) for A in (model.K, model.M))

    def solve(F: Array) -> Array:
        whole = np.zeros((model.size, F.shape[1]))
        whole[free] = F
        return model.solve(whole)[free]

    elastic = ElasticModel(K, M, np.zeros((len(free), 0)), solve)
    still = model.solve(loads)
    _, V, _ = lowest_modes(elastic, Limits(MODES, None), 1e-9)
    return Joint(lap, loads, still, elastic, np.concatenate([still[free], V], axis=1))


def load_path(amplitude: float) -> Array:
    """Factors (n, 2) of preload and tip force: preload, up, down, up; the last two halves are the cycle."""
    first, quarter, half = STEPS
    tip = np.concatenate(
        [
            np.zeros(first),
            np.linspace(0.0, amplitude, quarter + 1)[1:],
            np.linspace(amplitude, -amplitude, half + 1)[1:],
            np.linspace(-amplitude, amplitude, half + 1)[1:],
        ]
    )
    preload = np.ones(len(tip))
    preload[:first] = np.linspace(0.0, 1.0, first + 1)[1:]
    return np.stack([preload, tip], axis=1)


@dataclass(frozen=True, eq=False)
class Space:
    """One way of reducing the joint: name, number of unknowns, static solves that it costs, flexibility of its cells,
    their motion per load, tip motion per load (2,) and per force of a cell, `group` (fine cells,): the cell each fine
    cell lies in."""

    name: str
    unknowns: int
    solves: int
    cells: Cells
    flexibility: Array
    moved: Array
    tip: tuple[Array, Array]
    own: Array
    group: Array

    def follow(self, path: Array) -> Followed:
        """The history through `path`."""
        layers = np.repeat(1.0 / (LAYER * self.cells.area), 3)
        seen = (self.tip[0][None], self.tip[1][None])
        return follow(self.flexibility, self.cells, FRICTION, layers, self.moved, path, seen, self.own)


def of_cells(joint: Joint, group: Array, name: str) -> Space:
    """The flexibility of the relative motion of larger cells, `group` (c,) of the facets."""
    cells = gathered(joint.cells, group)
    if cells.count == joint.cells.count:
        responses = joint.lap.responses
    else:
        responses = joint.lap.model.solve(cells.loads)
    C = cells.loads.T @ responses
    unknowns = 3 * cells.count
    moved, own = cells.loads.T @ joint.still, joint.loads.T @ joint.still
    tip = (joint.loads[:, 1] @ joint.still, joint.loads[:, 1] @ responses)
    return Space(name, unknowns, unknowns + 2, cells, 0.5 * (C + C.T), moved, tip, own, group)


def of_modes(joint: Joint, Q: Array, name: str, solves: int) -> Space:
    """Coordinates for the columns of Q (free dofs, m); the cells are the facets. Directions that others hold go."""
    K, free = joint.elastic.K, joint.lap.model.free
    Q = Q / np.sqrt(np.einsum("nm,nm->m", Q, K @ Q))
    values, vectors = np.linalg.eigh(Q.T @ (K @ Q))
    keep = values > 1e-11 * values[-1]
    Q = Q @ (vectors[:, keep] / np.sqrt(values[keep]))
    on_cells, on_loads = joint.cells.loads[free].T @ Q, joint.loads[free].T @ Q
    tip = (on_loads @ on_loads[1], on_cells @ on_loads[1])
    group = np.arange(joint.cells.count)
    moved = on_cells @ on_loads.T
    return Space(name, Q.shape[1], solves, joint.cells, on_cells @ on_cells.T, moved, tip, on_loads @ on_loads.T, group)


def graded(joint: Joint, growth: float) -> Array:
    """Groups (c,) of facets along x: a cell is about `growth` times as long as it is away from the nearest end of the
    sheets or edge of a bolt's head, and a facet at least."""
    x = joint.cells.points[:, 0]
    marks = np.array([0.0, SIZE[0], *(b + s * HALF_WIDTH for b in BOLTS for s in (-1.0, 1.0))])
    order = np.argsort(x)
    group = np.empty(len(x), dtype=int)
    number, start = -1, -np.inf
    facet = SIZE[0] / len(x)
    for i in order:
        size = facet + growth * np.abs(marks - x[i]).min()
        if x[i] + 0.5 * facet - start > size + 1e-9:
            number, start = number + 1, x[i] - 0.5 * facet
        group[i] = number
    return group


def spaces(joint: Joint) -> list[Space]:
    """All rows of the page, the full model first."""
    c, base = joint.cells.count, joint.base
    free = joint.lap.model.free
    relative = sp.csr_matrix(joint.cells.loads[free].T)
    found = [of_cells(joint, np.arange(c), "all cells (full model)")]
    found.append(of_modes(joint, base, f"statics + {MODES} modes", 2))
    m = base.shape[1]
    derivatives = m * (m + 1) // 2 + m * m
    for count in TVD:
        modes = joint_modes(joint.elastic, base, relative, joint.cells.area, count, count)
        Q = np.concatenate([base, modes.columns], axis=1)
        left = " and ".join(f"{v:.1%}" for v in modes.left_out)
        found.append(of_modes(joint, Q, f"+ {2 * count} TVD (leave out {left})", 2 + derivatives))
    order = np.argsort(np.argsort(joint.cells.points[:, 0]))
    for n in reversed(GROUPS):
        found.append(of_cells(joint, order // n, f"cells of {n} facets"))
    for growth in GROWTHS:
        found.append(of_cells(joint, graded(joint, growth), f"graded cells, growth {growth:g}"))
    return found


@dataclass(frozen=True)
class Entry:
    """One space under one load: relative errors, of pressure, friction and range of slip in the last cycle in L2, of
    loss per cycle and of amplitude; milliseconds an increment took; None in place of all where no state was found."""

    space: Space
    pressure: float
    traction: float
    slip: float
    loss: float
    amplitude: float
    milliseconds: float


def measure(space: Space, path: Array, reference: Followed) -> Entry | None:
    """Follow the path and compare with `reference`, cell by cell; None where the solver finds no state."""
    start = time.process_time()
    try:
        found = space.follow(path)
    except RuntimeError:
        return None
    milliseconds = (time.process_time() - start) / len(path) * 1e3
    area, group = reference.area, space.group
    cycle = slice(-2 * STEPS[2] - 1, None)
    shut = reference.force[-1, :, 0] > 0.0

    def error(mine: Array, theirs: Array) -> float:
        weight = area if mine.ndim == 1 else area[:, None]
        return float(np.sqrt(np.sum(weight * (mine - theirs) ** 2) / np.sum(weight * theirs**2)))

    def swing(one: Followed) -> Array:
        return np.ptp(one.slip[cycle, :, 0], axis=0)

    def amplitude(one: Followed) -> float:
        return float(np.ptp(one.observed[cycle, 0]))

    last = len(path) - 1
    losses = [one.loss(last - 2 * STEPS[2], last) for one in (found, reference)]
    return Entry(
        space,
        error(found.pressure[-1][group], reference.pressure[-1]),
        error(found.traction[-1][group], reference.traction[-1]),
        error(np.where(shut, swing(found)[group], 0.0), np.where(shut, swing(reference), 0.0)),
        losses[0] / losses[1] - 1.0,
        amplitude(found) / amplitude(reference) - 1.0,
        milliseconds,
    )


@dataclass(frozen=True, eq=False)
class Compared:
    """One load: its name, tip force [N], the full model's history, an entry a space (None: no state found)."""

    name: str
    force: float
    reference: Followed
    entries: list[Entry | None]


def compared(joint: Joint, found: Sequence[Space], tip: dict[str, float] | None = None) -> list[Compared]:
    """All spaces under all loads; the first is the reference."""
    results = []
    for name, force in (TIP if tip is None else tip).items():
        path = load_path(force)
        reference = found[0].follow(path)
        results.append(Compared(name, force, reference, [measure(space, path, reference) for space in found]))
    return results


def page(joint: Joint, found: Sequence[Space], results: Sequence[Compared]) -> str:
    """The Markdown page."""
    parts = []
    for one in results:
        rows = []
        for space, entry in zip(found, one.entries, strict=True):
            row = [space.name, str(space.unknowns), str(space.solves)]
            if entry is None:
                rows.append([*row, "no state found", "", "", "", "", ""])
                continue
            shares = (entry.pressure, entry.traction, entry.slip)
            row += [f"{v:.1%}" for v in shares] + [f"{entry.loss:+.1%}", f"{entry.amplitude:+.2%}"]
            rows.append([*row, f"{entry.milliseconds:.1f}"])
        head = ["space", "unknowns", "solves", "pressure", "friction", "slip", "loss", "amplitude", "ms"]
        last = len(one.reference.force) - 1
        slips = np.mean(one.reference.state[last] == SLIP) / max(np.mean(one.reference.state[last] > 0), 1e-9)
        swing = np.ptp(one.reference.observed[-2 * STEPS[2] - 1 :, 0])
        loss = one.reference.loss(last - 2 * STEPS[2], last)
        text = (
            f"Tip force ±{one.force:g} N: amplitude {0.5e6 * swing:.1f} µm, loss per cycle {1e3 * loss:.3f} mJ; at the "
            f"peak {slips:.0%} of the cells that touch slip, {np.mean(one.reference.state[last] == 0):.0%} are open."
        )
        parts.append(f"## {one.name.capitalize()}\n\n{textwrap.fill(text, 120)}\n\n{table(head, rows)}")
    what = f"""Two steel sheets of {SIZE[0] * 1e3:g} x {SIZE[1] * 1e3:g} x {SIZE[2] * 1e3:g} mm lie on each other,
clamped at one end, pressed together by two bolts ({PRELOAD / 1e3:g} kN each, as forces under heads of
{2e3 * HALF_WIDTH:g} mm at {BOLTS[0] * 1e3:g} and {BOLTS[1] * 1e3:g} mm), and bent by a force at the tip of the upper
one: {joint.lap.model.size} dofs of hex27, {joint.cells.count} facets in the joint, friction {FRICTION:g}, a layer of
{LAYER:g} Pa/m, which spaces of few coordinates need. The full model has every facet as a cell and the full
flexibility between them. *Statics + modes*: the responses to preload and tip force, and the lowest modes of the open
joint. *TVD*: with trial vector derivatives (`wf.bases.TrialVectorDerivatives`), half from pressures, half from
tractions; what they leave out of the derivatives stands beside them, which says how far the set of derivatives is
used up, not how good it is. *Cells*: the flexibility of the relative motion of larger cells, uniform tractions on
each; graded ones grow with the distance from the ends and the edges of the heads, by "growth" times it. Errors in L2 at
the peak, of slip that of its range in the last cycle where cells touch; loss and amplitude of that cycle. Solves:
static ones before the first increment. Milliseconds an increment with the dense solver that all go through, in which
the forces of the cells are the unknowns; a space of m coordinates still has all of them."""
    return f"""# Reducing a joint: coordinates for the bodies or cells of the joint

Made by `python -m warpffrf.study.joint_bases`; do not edit.

{textwrap.fill(what, 120)}

{chr(10).join(parts)}
## What to take from it

{_reading(results)}"""


def _reading(results: Sequence[Compared]) -> str:
    """Sentences whose figures are those of the tables."""

    def told(one: Compared, begins: str, value: str, form: str) -> str:
        entries = [e for e in one.entries if e is not None and e.space.name.startswith(begins)]
        return ", ".join(f"{getattr(e, value):{form}} ({e.space.unknowns})" for e in entries) or "no state found"

    points = []
    for one in results:
        points.append(
            f"{one.name.capitalize()}, error of pressure by unknowns: statics + modes "
            f"{told(one, 'statics', 'pressure', '.0%')}; with TVD {told(one, '+', 'pressure', '.0%')}; cells "
            f"{told(one, 'cells', 'pressure', '.1%')}; graded {told(one, 'graded', 'pressure', '.1%')}."
        )
        points.append(
            f"Loss per cycle there: statics + modes {told(one, 'statics', 'loss', '+.0%')}; with TVD "
            f"{told(one, '+', 'loss', '+.0%')}; cells {told(one, 'cells', 'loss', '+.1%')}; graded "
            f"{told(one, 'graded', 'loss', '+.1%')}."
        )
    points.append(
        "A basis cannot press where no mode presses: its errors of pressure stay, and do not fall evenly with its "
        "size. The flexibility of the cells is exact for the tractions that the cells can have, at the price of "
        "one solve an unknown, and what is lost by larger cells is known: it is where the slip zone ends inside a "
        "cell."
    )
    wrapped = (textwrap.fill(p, 120, initial_indent="- ", subsequent_indent="  ") for p in points)
    return "\n".join(wrapped) + "\n"


def main(arguments: Sequence[str] | None = None) -> None:
    """Make the page."""
    given: Sequence[Any] = sys.argv[1:] if arguments is None else arguments
    folder = Path(given[0] if given else "docs/studies")
    folder.mkdir(parents=True, exist_ok=True)
    with one_thread():
        joint = two_sheets()
        found = spaces(joint)
        results = compared(joint, found)
    (folder / "joint_bases.md").write_text(page(joint, found, results))
    print(folder / "joint_bases.md")


if __name__ == "__main__":
    main()
