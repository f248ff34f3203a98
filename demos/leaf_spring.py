r"""A leaf spring of four leaves, clamped in its middle: leaves that rub, a loop, and what a load cycle loses.

The leaves are straight and lie flat on each other. A dowel in the middle holds them together, one body from where it
is, and the spring is cut along the leaves elsewhere (`Mesh.cut`). U-bolts, a spring with preload between the axle below
and the uppermost leaf, press 8 cm of the middle together; the axle holds the lowest leaf there and is the ground. The
frame of the car presses the ends of the longest leaf down, to and fro between a fifth and all of the load.

What to expect: bent, the leaves touch at the tips of the shorter ones alone, and open in between. Pressures at the tips
grow with the load, and with them friction, so that load against deflection is a bow: one straight line through the
origin while the load grows, one below it while it falls. When it turns, tips stick at first, and the spring is five
times as stiff. Four beams that touch at the tips have all of that (`tests/references/closed_forms/
leaf_spring.py`). They are held rigidly at the edge of the clamp. Here they slip at its rim, which makes the spring 3 to
4 % softer and adds 29 % to the loss of the tips, and yield a little behind it: with leaves that are bonded in the
clamp, the spring is 1.7 % softer than the beams (`tests/demos/test_leaf_spring.py`).

Full finite elements of the same mesh with the same cells (`references.small_sliding`) know neither modes nor a moving
body and have the same deflections, pressures and losses to eight digits.

Energy: with forces that are straight lines between load steps, those of cells, too, the work of the loads less what is
stored is the work of the cells. The loss of a lap has the friction at the end of each step instead, which is more by
half of what friction grows in the step.
"""

from __future__ import annotations

import logging
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

import warpffrf as wf
from demos.checks import Check, finish, writable_folder
from references.closed_forms import LeafSpring
from references.small_sliding.cells import facet_cells, together
from references.small_sliding.full_model import FullModel, Part
from references.small_sliding.quasi_static import Followed, StaticLap
from warpffrf.output.plots.panels import COLORS, Panel

log = logging.getLogger("warpffrf")

STEEL = wf.Material(youngs_modulus=210e9, poisson_ratio=0.0, density=7850, name="steel, bent as beams are")
HALF = np.array([0.40, 0.31, 0.22, 0.13])  # m, of the leaves from the middle, from the uppermost down
THICK, WIDE, CLAMP, DOWEL = 0.01, 0.06, 0.04, 0.01  # m; the last two from the middle to either side
FRICTION = 0.3
BOLTS, PRELOAD, FEET = 1e9, 160e3, 0.2  # N/m, N; m below the top
LOAD, LEAST = 3e3, 0.2  # N at either end; of it
NUDGE = 0.999  # of the load, just after it has turned
MODES = 24  # pictures show what modes bend; nothing else depends on how many there are
JOINTS = [f"joint{i}" for i in range(1, len(HALF))]
ENDS = ("x_min", "x_max")
BEAMS = LeafSpring(tuple(HALF - CLAMP), WIDE, THICK, STEEL.youngs_modulus, FRICTION)
SOFT = 0.08  # the clamp, see above, in the larger cells
TIPS, LOST = 0.07, 0.05  # of forces and losses at the tips: one cell long, where beams have points
SAME = 1e-7  # beside full finite elements: residuals of equilibria
LEDGER = 1e-7  # of the loss: residuals, of energies ten times as large


@dataclass(frozen=True)
class Size:
    """Length of the cells along the leaves [m], load steps from one load to the other, frames of the recording."""

    cell: float = 0.005
    steps: int = 16
    frames: int = 120


FULL, QUICK = Size(), Size(cell=0.01, steps=8, frames=40)


def path(size: Size) -> np.ndarray:
    """The loads of the load steps [N]: up, a cycle, and once more down and up."""
    up = np.linspace(LEAST, 1.0, size.steps + 1)[1:]
    down = up[::-1] - (1.0 - LEAST) / size.steps
    nudged = np.concatenate([[NUDGE], down])
    return LOAD * np.concatenate([np.linspace(0.0, 1.0, size.steps + 1), down, up, nudged, up])


def spring_mesh(cell: float) -> wf.mesh.Mesh:
    """The leaves below z = 0: facet sets `jointN_high` and `jointN_low` of the cuts, `seat` under the bolts and `base`
    on the axle, `x_min` and `x_max` the ends of the longest leaf."""
    leaves = len(HALF)
    x = np.linspace(-HALF[0], HALF[0], 2 * round(HALF[0] / cell) + 1)
    middle = 0.5 * (x[1:] + x[:-1])
    filled = np.abs(middle)[:, None, None] < HALF[::-1]
    mesh = wf.mesh.grid(
        x, (-0.5 * WIDE, 0.5 * WIDE), THICK * np.arange(-leaves, 1.0), filled=filled, name="leaf spring"
    )
    along = mesh.points[mesh.single[1]].mean(axis=1)[:, 0]
    mesh = replace(mesh, cell_sets={"arms": np.flatnonzero(np.abs(along) > DOWEL)})
    for i, name in enumerate(JOINTS):
        mesh = mesh.cut(name, point=(0.0, 0.0, -THICK * (i + 1)), normal=(0.0, 0.0, 1.0), cells="arms")

    def clamped(centers: np.ndarray) -> np.ndarray:
        return np.abs(centers[:, 0]) < CLAMP

    return mesh.select("seat", "z_max", clamped).select("base", "z_min", clamped)


def build(size: Size = FULL, *, progress: bool = True) -> wf.Scene:
    """The scene: body `spring` on the joint `axle`, spring `bolts`, laps `joint1` (uppermost) to `joint3`, loads
    `x_min` and `x_max`; a second a load step."""
    laps = {name: (f"{name}_high", f"{name}_low") for name in JOINTS}
    interfaces = {"base": "rigid", **dict.fromkeys(("seat", *ENDS), "average")}
    body = wf.reduce(spring_mesh(size.cell), STEEL, interfaces=interfaces, laps=laps, modes=MODES, progress=progress)
    loads = path(size)
    by_step = wf.signals.Table(np.arange(len(loads), dtype=float), -loads)
    scene = wf.Scene(gravity=(0.0, 0.0, 0.0))
    spring = scene.add_body(body, name="spring")
    scene.add(wf.joints.Fixed(scene.ground, spring["base"], name="axle"))
    feet = scene.ground.at((0.0, 0.0, -FEET))
    scene.add(wf.forces.SpringDamper(feet, spring["seat"], BOLTS, free_length=FEET - PRELOAD / BOLTS, name="bolts"))
    for end in ENDS:
        scene.add(wf.forces.PointForce(spring[end], (0.0, 0.0, by_step), name=end))
        scene.add(wf.sensors.Position(spring[end], name=end))
    for name in JOINTS:
        scene.add(wf.Lap(spring[name], friction=FRICTION, name=name))
    return scene


def run(scene: wf.Scene, size: Size = FULL, *, progress: bool = True) -> wf.Result:
    """All load steps, from the clamped spring without load."""
    return wf.simulate(scene, float(len(path(size)) - 1), step=1.0, kind="static", progress=progress)


@dataclass(frozen=True, eq=False)
class Bent:
    """A run by its load steps."""

    result: wf.Result
    size: Size

    @property
    def load(self) -> np.ndarray:
        """(T,) N at either end."""
        return path(self.size)

    @property
    def deflection(self) -> np.ndarray:
        """(T,) m, mean of both ends, since the load began."""
        z = np.mean([self.result.sensor(end).values[:, 2] for end in ENDS], axis=0)
        return z[0] - z

    @property
    def peak(self) -> int:
        """The load step at which the load is all there for the first time."""
        return self.size.steps

    @property
    def cycle(self) -> slice:
        """The load steps of the last cycle, from peak to peak."""
        return slice(3 * self.size.steps, len(self.load))

    def slope(self, row: int) -> float:
        """dP/dw [N/m] of the step that led to `row`."""
        return float(np.diff(self.load[row - 1 : row + 1])[0] / np.diff(self.deflection[row - 1 : row + 1])[0])

    def tip(self, name: str) -> np.ndarray:
        """Cells (c,) bool of a lap that are at its tips, not in the clamp."""
        return np.abs(self.result.lap(name).points[:, 0]) > CLAMP + 3.0 * THICK

    def pressing(self, name: str) -> np.ndarray:
        """(T,) N, force at either tip of a lap."""
        lap = self.result.lap(name)
        return 0.5 * lap.pressure @ np.where(self.tip(name), lap.area, 0.0)

    def loss(self, name: str) -> tuple[float, float]:
        """J at both tips and in the clamp, in the last cycle."""
        lost = np.diff(self.result.lap(name).cell_loss[[self.cycle.start, -1]], axis=0)[0]
        return float(lost[self.tip(name)].sum()), float(lost[~self.tip(name)].sum())

    @property
    def work_of_cells(self) -> float:
        """J in the last cycle, of tractions and pressures that are straight lines between load steps."""
        work = 0.0
        for name in JOINTS:
            lap = self.result.lap(name)
            forces = np.concatenate([lap.pressure[self.cycle, :, None], lap.traction[self.cycle]], axis=2)
            moved = np.diff(np.concatenate([lap.gap[self.cycle, :, None], lap.slip[self.cycle]], axis=2), axis=0)
            work -= float(np.einsum("tck,tck,c->", 0.5 * (forces[1:] + forces[:-1]), moved, lap.area))
        return work

    @property
    def work_of_loads(self) -> float:
        """J in the last cycle, less what bolts, leaves and cells have stored by then."""
        energy = self.result.energy
        stored = sum(energy[line] for line in ("strain", "contact", "potential"))
        return float(np.diff((energy["force_work"] - stored)[[self.cycle.start, -1]])[0])

    @property
    def loop(self) -> Any:
        """The last cycle of the loads at both ends against the deflection."""
        begin, end = float(self.cycle.start), float(len(self.load) - 1)
        return self.result.hysteresis(2.0 * self.load, self.deflection).loop(begin, end)


# --- full finite elements


def followed(size: Size) -> Followed:
    """Load steps up and down for the first time, `observed` the deflection of an end [m], without modes."""
    mesh = spring_mesh(size.cell)
    free = FullModel([Part(mesh, STEEL, held=("base",))])
    seat = free.spread(0, "seat", (0.0, 0.0, 1.0))
    down = [free.spread(0, end, (0.0, 0.0, -1.0)) for end in ENDS]
    model = free.with_springs((seat, BOLTS))
    cells = together([facet_cells(model, (0, f"{name}_high"), (0, f"{name}_low")) for name in JOINTS])
    loads = path(size)[: 2 * size.steps + 1]
    steps = np.column_stack([np.full(len(loads), -PRELOAD), loads])
    return StaticLap(model, cells, FRICTION).follow(np.column_stack([seat, sum(down)]), steps, down[1][:, None])


def reference_checks(bent: Bent, exact: Followed) -> list[Check]:
    """A run beside the same mesh and the same cells."""
    rows = slice(0, len(exact.observed))
    expected = exact.observed[:, 0] - exact.observed[0, 0]
    away = float(np.abs(bent.deflection[rows] - expected).max())
    laps = [bent.result.lap(name) for name in JOINTS]
    pressed = np.concatenate([lap.pressure[rows] for lap in laps], axis=1)
    pressed_away = float(np.abs(np.sort(pressed) - np.sort(exact.pressure)).max())
    begin, end = bent.peak, rows.stop - 1
    lost = sum(lap.loss_between(float(begin), float(end)) for lap in laps)
    source = "full finite elements"
    return [
        Check(f"{len(pressed.T)} cells: deflections off by", away, 0.0, f"{source}, over the largest", SAME, "nm", 1e9,
              scale=float(expected.max())),
        Check(f"{len(pressed.T)} cells: pressures off by", pressed_away, 0.0, f"{source}, over the largest", SAME, "Pa",
              scale=float(exact.pressure.max())),
        Check(f"{len(pressed.T)} cells: loss of the first fall", lost, exact.loss(begin, end), source, SAME, "J"),
    ]  # fmt: skip


# --- beams


def checks(bent: Bent) -> list[Check]:
    """The figures of a run beside beams that touch at their tips."""
    n = bent.size.steps
    w, f = BEAMS.follow(bent.load)
    lost = 2.0 * BEAMS.cycle_loss(LOAD, LEAST * LOAD)
    source = "beams"
    found = [
        Check("deflection under all of the load", float(bent.deflection[n]), float(w[n]), source, SOFT, "mm", 1e3),
        Check("stiffness, load grows", bent.slope(n), BEAMS.stiffness(1.0), source, SOFT, "N/mm", 1e-3),
        Check("stiffness, load falls", bent.slope(2 * n), BEAMS.stiffness(-1.0), source, SOFT, "N/mm", 1e-3),
        Check("stiffness, all stuck", bent.slope(3 * n + 1), BEAMS.stuck_stiffness, source, SOFT, "N/mm", 1e-3),
    ]
    for i, name in enumerate(JOINTS):
        press = float(bent.pressing(name)[n])
        found.append(Check(f"tip of leaf {i + 2}: force", press, float(f[n, 1 + i]), source, TIPS, "N"))
    for i, name in enumerate(JOINTS):
        found.append(
            Check(f"tips of leaf {i + 2}: loss per cycle", bent.loss(name)[0], float(lost[i]), source, LOST, "J")
        )
    work, of_cells = bent.work_of_loads, bent.work_of_cells
    return [
        *found,
        Check("work of the loads in a cycle, less stored", work, of_cells, "work of the cells", LEDGER, "J"),
    ]


# --- pictures


@dataclass(frozen=True, eq=False)
class Side:
    """The spring seen from the side at a load step, as it bends, and the forces that press its leaves together."""

    bent: Bent
    row: int

    def draw(self, ax: Any) -> None:
        """Draw on matplotlib axes."""
        from matplotlib.collections import PolyCollection

        skin = self.bent.result.skins()["spring"]
        front = np.flatnonzero(np.abs(skin.points[:, 1] - 0.5 * WIDE) < 1e-9)
        shown = skin.triangles[np.isin(skin.triangles, front).all(axis=1)]
        leaf = np.floor(-skin.points[shown][:, :, 2].mean(axis=1) / THICK).astype(int)
        place = self.bent.result.body("spring").position
        still, bent = skin.points, skin.points + skin.displacement(self.row) + (place[self.row] - place[0])
        flat, curved = (list(1e3 * x[shown][:, :, [0, 2]]) for x in (still, bent))
        ax.add_collection(PolyCollection(flat, facecolors="0.9", linewidths=0.0))
        colors = np.array(LEAF_COLORS)[leaf]
        ax.add_collection(PolyCollection(curved, facecolors=colors, edgecolors=colors, linewidths=0.2))
        for i, name in enumerate(JOINTS, start=1):
            force = f"{1e-3 * self.bent.pressing(name)[self.row]:.1f} kN"
            for side in (-1.0, 1.0):
                tip = np.argmin(np.linalg.norm(still[front] - (side * HALF[i], 0.5 * WIDE, -i * THICK), axis=1))
                ax.annotate(
                    force, 1e3 * bent[front[tip], [0, 2]], (0, -36), textcoords="offset points", fontsize=7,
                    ha="center", arrowprops={"arrowstyle": "->", "lw": 0.8},
                )  # fmt: skip
        ax.set(xlim=(-420.0, 420.0), ylim=(-60.0, 10.0), xlabel="along the spring [mm]", ylabel="height [mm]")
        load = self.bent.load[self.row]
        ax.set_title(f"{2e-3 * load:.3g} kN: leaves touch at their tips (height drawn larger)", fontsize=10)


@dataclass(frozen=True, eq=False)
class Rubbing:
    """Friction of one lap in the clamp over load steps, in colours from -1 to 1 of what it can be, white where the
    leaves are apart."""

    bent: Bent
    name: str

    def draw(self, ax: Any) -> None:
        """Draw on matplotlib axes."""
        lap = self.bent.result.lap(self.name)
        order = np.argsort(lap.points[:, 0])
        order = order[lap.points[order, 0] > 0.0]
        along = np.einsum("ckx,x->ck", lap.frames[order, 1:], (1.0, 0.0, 0.0))
        share = np.einsum("tck,ck->tc", lap.traction[:, order], along)
        bound = FRICTION * lap.pressure[:, order]
        share = np.where(bound > 0.0, share / np.where(bound > 0.0, bound, 1.0), np.nan)
        cell = float(np.diff(lap.points[order, 0]).max())
        edges = 1e3 * np.append(lap.points[order, 0] - 0.5 * cell, lap.points[order[-1], 0] + 0.5 * cell)
        steps = np.arange(len(share) + 1) - 0.5
        colors = ax.pcolormesh(steps, edges, share.T, cmap="RdBu_r", vmin=-1.0, vmax=1.0)
        ax.figure.colorbar(colors, ax=ax, label="friction along, over mu p [-]")
        ax.axhline(1e3 * CLAMP, color="0.1", lw=0.9, ls="--")
        ax.set(xlabel="load step", ylabel="along the spring [mm]", ylim=(1e3 * DOWEL, 1e3 * (CLAMP + 2.0 * THICK)))
        ax.set_title(f"Leaves 1 and 2 in the clamp, whose edge is at {1e3 * CLAMP:g} mm", fontsize=10)


LEAF_COLORS = tuple(COLORS[:4])


def panels(bent: Bent) -> list[Any]:
    """The loop; stiffness; forces at tips; the spring from the side; friction along it; where it is lost."""
    load, w = bent.load, bent.deflection
    beams, f = BEAMS.follow(load)
    pressed = {f"leaf {i + 2}": (1e-3 * load, 1e-3 * bent.pressing(name)) for i, name in enumerate(JOINTS)}
    by_beams = {f"beams, {i + 2}": (1e-3 * load, 1e-3 * f[:, 1 + i]) for i in range(len(JOINTS))}
    slopes = np.diff(load) / np.diff(w)
    exact = np.diff(load) / np.diff(beams)
    steps = np.arange(1, len(load))
    lost = {}
    for i, name in enumerate(JOINTS):
        lap = bent.result.lap(name)
        order = np.argsort(lap.points[:, 0])
        order = order[lap.points[order, 0] > 0.0]
        gone = np.diff(lap.cell_loss[[bent.cycle.start, -1]], axis=0)[0, order] / lap.area[order]
        lost[f"leaves {i + 1}, {i + 2}"] = (1e3 * lap.points[order, 0], gone)
    return [
        Panel("Load on both ends", "deflection [mm]", "load [kN]", {"run": (1e3 * w, 2e-3 * load)},
              {"beams": (1e3 * beams, 2e-3 * load)}),
        Panel("Stiffness of each load step", "load step", "[N/mm]", {"run": (steps, 2e-3 * slopes)},
              {"beams": (steps, 2e-3 * exact)}),
        Panel("Forces at the tips", "load at either end [kN]", "[kN]", pressed, by_beams),
        Side(bent, bent.size.steps),
        Rubbing(bent, JOINTS[0]),
        Panel("Where a cycle loses energy", "along the spring [mm]", "loss [J/m2]", lost),
    ]  # fmt: skip


def main(out: str | Path = "out/leaf_spring", *, quick: bool = False, progress: bool = True) -> int:
    """Run the demo and write leaf_spring.h5, .rrd, .png and summary.json into the folder `out`; 0 when all went well.

    A run in larger cells, which full finite elements follow, is in leaf_spring.coarse.h5. quick: those cells
    throughout. Raises `InputError` for a folder that cannot be written.
    """
    folder = writable_folder(out)
    size = QUICK if quick else FULL
    results: dict[str, wf.Result] = {}
    for name, cells in {"fine": size, "coarse": QUICK}.items():
        if results and cells == size:
            results[name] = results["fine"]
            continue
        log.info("leaf spring: cells of %g mm, %d load steps", 1e3 * cells.cell, len(path(cells)) - 1)
        result = results[name] = run(build(cells, progress=progress), cells, progress=progress)
        if result.status != "completed":
            log.error("the run '%s' ended early, %s: %s", name, result.status, result.message)
            return 1
    log.info("leaf spring: full finite elements")
    bent = Bent(results["fine"], size)
    found = [*checks(bent), *reference_checks(Bent(results["coarse"], QUICK), followed(QUICK))]
    return finish(folder / "leaf_spring", results, found, panels(bent), frames=size.frames)
