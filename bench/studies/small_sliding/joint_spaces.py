"""A jointed pair of sheets and ways of reducing its joint, `Space`s that go through one solver: for `joint_bases`."""

from __future__ import annotations

import time
from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp

from references.small_sliding.cells import Cells, facet_cells, gathered
from references.small_sliding.full_model import FullModel, Part
from references.small_sliding.quasi_static import Followed, StaticSmallSliding, follow
from references.small_sliding.sheets import stack
from warpffrf.model.material import Material
from warpffrf.offline.bases.modes import lowest_modes
from warpffrf.offline.bases.trial_vector_derivatives import joint_modes
from warpffrf.offline.elastic import ElasticModel
from warpffrf.offline.products import Limits

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
    """The full model: small-sliding contact, cells, loads F (dofs, 2) (preload and tip), their responses, the base of
    static and vibration modes (dofs, m), and the model as the bases of `offline` see it (free dofs alone)."""

    lap: StaticSmallSliding
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
    lap = StaticSmallSliding(model, cells, FRICTION, normal_compliance=1.0 / LAYER, tangential_compliance=1.0 / LAYER)
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
    return beside(space, found, reference, (time.process_time() - start) / len(path) * 1e3)


def beside(space: Space, found: Followed, reference: Followed, milliseconds: float) -> Entry:
    """The errors of what was found, in cells of `space`."""
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

    last = len(reference.force) - 1
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
