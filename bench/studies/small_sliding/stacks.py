r"""Stacked sheets with joint interfaces: the engine's scenes and the full finite elements, of one and the same mesh.

Strips clamped at their root, pressed together by two bolts, which are pairs of forces on their heads or springs between
them, and loaded at the tip of the upper one. Loads F (dofs, 2) of the full model are one newton of each bolt and of the
tip; a path is its factors (n, 2). Heads of the engine rotate with their sheets, full finite elements are linear: the
differences (`bolts`) grow with the load, so that loads are small where joint interfaces are to be equal. Faces
touch without load, hence pressures, slips and gaps are proportional to the load in both.

A load step that the engine halves is two steps of friction: the full model follows the halves too.
"""

from __future__ import annotations

from copy import copy
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
from scipy.spatial import KDTree

from references.small_sliding.cells import Cells, facet_cells, node_cells, together
from references.small_sliding.full_model import FullModel, Part
from references.small_sliding.quasi_static import Followed, StaticSmallSliding
from references.small_sliding.sheets import ROOT, one_body, stack
from studies.small_sliding.bolts import UP, apart, shank, turning
from warpffrf.model import forces, joints, laws, sensors, signals
from warpffrf.model.contact import Contact
from warpffrf.model.material import Material
from warpffrf.model.mesh import Mesh
from warpffrf.model.reduced.body import ReducedBody
from warpffrf.model.scene import Scene
from warpffrf.model.small_sliding.sliding import cells_of
from warpffrf.model.surfaces import Matched
from warpffrf.offline import reduce
from warpffrf.online import History, Settings
from warpffrf.online.load_steps import run_static

Array = np.ndarray
STEEL = Material(210e9, 0.3, 7850.0, name="steel")
FRICTION = 0.2
HALF_WIDTH = 10e-3  # m, half of a bolt's head: a whole number of elements of 20, 30, 40, ... along 0.2 m
BOLTS = (0.25, 0.75)  # places along the sheets, of their length
SIZE = (0.2, 0.01, 0.016)  # m, of a stack
KINDS = {"nodes": node_cells, "facets": facet_cells}


@dataclass(frozen=True, eq=False)
class Sheets:
    """`layers` sheets that make a stack of `SIZE`, of `counts` (3,) of hex27 each; `second`: elements along the upper
    sheet of two where they are two bodies, None: as below; `width` [m]: across, loads below are for that of `SIZE`;
    `shank` [N/m]: stiffness of the bolts as springs, None: they are pairs of forces; `half_width` [m] of the bolts'
    heads; `layer` [Pa/m]: stiffness of a layer between the faces, along and across, None: there is none."""

    counts: tuple[int, int, int]
    layers: int = 2
    second: int | None = None
    width: float = SIZE[1]
    shank: float | None = None
    half_width: float = HALF_WIDTH
    layer: float | None = None

    @property
    def height(self) -> float:
        """Of a sheet [m]."""
        return SIZE[2] / self.layers

    @cached_property
    def parts(self) -> list[Mesh]:
        """Sheets with the facet sets `head0` and `head1` on the outer faces."""
        size = (SIZE[0], self.width, self.height)
        sheets = stack(size, self.counts, self.layers)
        if self.second is not None:
            sheets[-1] = stack(size, (self.second, *self.counts[1:]), self.layers)[-1]
        for i, place in enumerate(BOLTS):

            def head(c: Array, x: float = place * SIZE[0]) -> Array:
                return np.abs(c[:, 0] - x) < self.half_width

            sheets[0] = sheets[0].select(f"head{i}", "z_min", head)
            sheets[-1] = sheets[-1].select(f"head{i}", "z_max", head)
        return sheets

    @cached_property
    def mesh(self) -> Mesh:
        """All in one body."""
        return one_body(self.parts)

    @property
    def heads(self) -> list[tuple[int, str, float]]:
        """Sheets and facet sets of the bolts' heads, and the direction along z of their forces."""
        ends = ((0, 1.0), (self.layers - 1, -1.0))
        return [(k, f"head{i}", sign) for i in range(len(BOLTS)) for k, sign in ends]

    @property
    def faces(self) -> dict[str, tuple[str, str]]:
        """Joint interfaces of the one body by name: lower and upper face."""
        return {f"lap{k}": (f"sheet{k}_z_max", f"sheet{k + 1}_z_min") for k in range(self.layers - 1)}

    @property
    def bolted(self) -> list[tuple[str, str]]:
        """Facet sets of the one body under the heads of each bolt, the lower and the upper one."""
        return [(f"sheet0_head{i}", f"sheet{self.layers - 1}_head{i}") for i in range(len(BOLTS))]

    @cached_property
    def full(self) -> FullModel:
        """The full finite elements of the one body, shanks of bolts included."""
        model = FullModel([Part(self.mesh, STEEL, (ROOT,))])
        if self.shank is None:
            return model
        return model.with_springs(*((apart(model, *heads, UP), self.shank) for heads in self.bolted))

    def turning(self, tension: Array) -> FullModel:
        """`full` with what bolts under `tension` (bolts,) [N] make where sheets turn, see `bolts`."""
        springs = turning(self.full, self.bolted, SIZE[2], tension, line=self.shank is not None)
        return replace(self.full, springs=(*self.full.springs, *springs))

    @cached_property
    def loads(self) -> Array:
        """F (dofs, 2)."""
        tip = self.full.spread(0, f"sheet{self.layers - 1}_x_max", (0.0, 0.0, 1.0))
        bolts = [-apart(self.full, *heads, UP) for heads in self.bolted]
        return np.stack([np.sum(bolts, axis=0), tip], axis=1)

    def cells(self, by: str) -> Cells:
        """Of all joint interfaces, one after the other."""
        return together([KINDS[by](self.full, (0, a), (0, b)) for a, b in self.faces.values()])

    def condensed(self, by: str, friction: float = FRICTION) -> StaticSmallSliding:
        """The full model on its cells."""
        yields = 0.0 if self.layer is None else 1.0 / self.layer
        return StaticSmallSliding(
            self.full, self.cells(by), friction, normal_compliance=yields, tangential_compliance=yields
        )

    def reduced(self, modes: int, **cells: Any) -> ReducedBody:
        """The one body with joint interfaces; cells: `by`, `size` and `growth` of `Matched`."""
        loaded = [f"sheet{k}_{name}" for k, name, _ in self.heads] + [f"sheet{self.layers - 1}_x_max"]
        return reduce(
            self.mesh, STEEL, interfaces={ROOT: "rigid"} | dict.fromkeys(loaded, "average"), modes=modes, cache=False,
            progress=False, contact={n: Matched(b, first=a, **cells) for n, (a, b) in self.faces.items()},
        )  # fmt: skip

    def reduced_parts(self, modes: int) -> list[ReducedBody]:
        """Two bodies with cells by facets, one upon the other."""
        found = []
        for mesh, face, more in zip(self.parts, ("z_max", "z_min"), ((), ("x_max",)), strict=True):
            loaded = ("head0", "head1", *more)
            found.append(reduce(
                mesh, STEEL, interfaces={"x_min": "rigid"} | dict.fromkeys(loaded, "average"), modes=modes,
                cache=False, progress=False, contact={"face": Matched(first=face)},
            ))  # fmt: skip
        return found

    def scene(self, bodies: list[ReducedBody], preload: Any, tip: Any, friction: float = FRICTION) -> Scene:
        """One body, or two, with these forces [N], a number where bolts are springs; sensor `tip`."""
        scene = Scene(gravity=(0.0, 0.0, 0.0))
        law = laws.Unilateral() if self.layer is None else laws.LinearLayer(self.layer)
        sheets = [scene.add_body(body, name=f"body{i}") for i, body in enumerate(bodies)]
        if len(bodies) == 1:
            scene.add(joints.Fixed(scene.ground, sheets[0][ROOT]))
            for name in self.faces:
                scene.add(Contact(sheets[0][name], sliding="small", friction=friction, law=law, name=name))
            sets = {(k, name): sheets[0][f"sheet{k}_{name}"] for k, name, _ in self.heads}
            end = sheets[0][f"sheet{self.layers - 1}_x_max"]
        else:
            for sheet in sheets:
                scene.add(joints.Fixed(scene.ground, sheet["x_min"]))
            scene.add(
                Contact(sheets[0]["face"], sheets[1]["face"], sliding="small", friction=friction, law=law, name="lap0")
            )
            sets = {(k, name): sheets[k][name] for k, name, _ in self.heads}
            end = sheets[1]["x_max"]
        if self.shank is None:
            for k, name, sign in self.heads:
                scene.add(forces.PointForce(sets[k, name], (preload, (0.0, 0.0, sign))))
        else:
            for i, (low, high) in enumerate(self.bolted):
                scene.add(shank(sheets[0][low], sheets[0][high], self.shank, preload, name=f"bolt{i}"))
        scene.add(forces.PointForce(end, (0.0, 0.0, tip)))
        scene.add(sensors.Position(end, name="tip"))
        return scene

    def followed(
        self, bodies: list[ReducedBody], path: Array, *, friction: float = FRICTION, settings: Settings | None = None
    ) -> Engine:
        """The engine's static history through a path (n, 2), a row a second, from an equilibrium under the first."""
        times = np.arange(float(len(path)))
        preload, tip = (signals.Table(times, path[:, i]) for i in range(2))
        scene = self.scene(bodies, preload if self.shank is None else float(path[0, 0]), tip, friction)
        found = run_static(scene, float(times[-1]), step=1.0, progress=False, settings=settings)
        if found.status != "completed":
            raise RuntimeError(f"sheets: {found.status}: {found.message}")
        return Engine(found, SIZE[2] - 0.5 * self.height)


@dataclass(frozen=True, eq=False)
class Engine:
    """What the engine found: `history`, rows as those of a path; `height` [m] of the middle of the loaded end."""

    history: History
    height: float

    @cached_property
    def pressure(self) -> Array:
        """(n, c) [Pa] of the cells of all joint interfaces."""
        return np.concatenate([lap.pressure for lap in self.history.small_sliding.values()], axis=1)

    @cached_property
    def traction(self) -> Array:
        """(n, c, 2) [Pa], on the second faces."""
        return -np.concatenate([lap.traction for lap in self.history.small_sliding.values()], axis=1)

    @cached_property
    def state(self) -> Array:
        """(n, c)."""
        return np.concatenate([lap.state for lap in self.history.small_sliding.values()], axis=1)

    @property
    def tip(self) -> Array:
        """Deflection (n,) [m]."""
        return self.history.sensors["tip"].values[:, 2] - self.height

    @property
    def lost(self) -> Array:
        """Work of friction (n,) [J] in all so far."""
        return np.sum([lap.loss.sum(axis=1) for lap in self.history.small_sliding.values()], axis=0)

    def loss(self, first: int, last: int) -> float:
        """Work [J] of friction after row `first` up to and with row `last`."""
        return float(self.lost[last] - self.lost[first])

    @property
    def tension(self) -> Array:
        """Tension (bolts,) [N] of springs in row 0."""
        springs = [self.history.forces[f"bolt{i}"].force[0] for i in range(len(BOLTS))]
        return np.linalg.norm(springs, axis=1)

    @property
    def parts(self) -> Array:
        """Into how many equal parts each row's load step was cut (n,)."""
        return np.rint(1.0 / np.minimum(self.history.step_size, 1.0)).astype(int)


def cell_of(body: ReducedBody, cells: Cells) -> Array:
    """Cell of the first small-sliding contact of a body (c,) in which each of `cells` lies."""
    surface = body.matched["lap0"]
    found = KDTree(surface.triangles.mean(axis=1)[:, :2]).query(cells.points[:, :2])[1]
    return surface.cell[found]


def with_halves(path: Array, parts: Array) -> tuple[Array, Array]:
    """The path with the rows between that steps cut into `parts` (n,) have, and the numbers of the old rows in it."""
    rows, at = [path[:1]], [0]
    for i in range(1, len(path)):
        share = np.arange(1, parts[i] + 1)[:, None] / parts[i]
        rows.append(path[i - 1] + share * (path[i] - path[i - 1]))
        at.append(at[-1] + int(parts[i]))
    return np.concatenate(rows), np.array(at)


@dataclass(frozen=True, eq=False)
class Cycle:
    """Tip force up, down and up again under preload: path (n, 2) [N] and the row where the cycle begins."""

    path: Array
    first: int

    @classmethod
    def of(cls, preload: float, amplitude: float, steps: tuple[int, int, int]) -> Cycle:
        """Preload in steps[0] rows, then up in steps[1], down and up in steps[2] each; the last two are the cycle."""
        before, quarter, half = steps
        tip = np.concatenate([
            np.zeros(before), np.linspace(0.0, amplitude, quarter + 1)[1:],
            np.linspace(amplitude, -amplitude, half + 1)[1:], np.linspace(-amplitude, amplitude, half + 1)[1:],
        ])  # fmt: skip
        pressed = np.full(len(tip), preload)
        pressed[:before] = np.linspace(0.0, preload, before + 1)[1:]
        return cls(np.stack([pressed, tip], axis=1), before + quarter - 1)

    @property
    def last(self) -> int:
        """Number of the last row."""
        return len(self.path) - 1


@dataclass(frozen=True)
class Difference:
    """Of the engine from the full model, or of two histories: pressure and traction, the largest of all rows and cells
    over the largest pressure; numbers of states that differ and of cells in all rows; loss per cycle and amplitude at
    the tip, relative; parts: load steps that the engine cut."""

    pressure: float
    traction: float
    states: int
    of: int
    loss: float
    amplitude: float
    cut: int


@dataclass(frozen=True, eq=False)
class Rows:
    """A history: pressure (n, c) and traction (n, c, 2) [Pa], state (n, c), tip (n,) [m], work of friction lost (n,)
    [J] so far."""

    pressure: Array
    traction: Array
    state: Array
    tip: Array
    lost: Array

    @classmethod
    def of(cls, full: Followed, at: Any = slice(None)) -> Rows:
        """Rows `at` of a full model whose first observed is the tip."""
        lost = np.cumsum(full.dissipated)
        return cls(full.pressure[at], full.traction[at], full.state[at], full.observed[at, 0], lost[at])


def between(found: Rows | Engine, exact: Rows | Engine, cycle: Cycle, cut: int = 0) -> Difference:
    """The difference of two histories of the same cells, of which one has `cut` load steps."""
    top = exact.pressure.max()
    loss = [one.lost[cycle.last] - one.lost[cycle.first] for one in (found, exact)]
    swing = [np.ptp(one.tip[cycle.first :]) for one in (found, exact)]
    return Difference(
        float(np.abs(found.pressure - exact.pressure).max() / top),
        float(np.abs(found.traction - exact.traction).max() / top),
        int(np.sum(found.state != exact.state)), exact.state.size,
        float(loss[0] / loss[1] - 1.0), float(swing[0] / swing[1] - 1.0), cut,
    )  # fmt: skip


def difference(engine: Engine, lap: StaticSmallSliding, loads: Array, cycle: Cycle) -> Difference:
    """Cells in the same order; the full model takes the engine's gaps, in which round-off of places is none."""
    path, at = with_halves(cycle.path, engine.parts)
    same = copy(lap)
    same.cells = replace(
        lap.cells, gap=np.concatenate([cells_of(one).gap for one in engine.history.scene.small_sliding])
    )
    full = same.follow(loads, path, loads[:, 1:])
    return between(engine, Rows.of(full, at), cycle, int(np.sum(engine.parts > 1)))
