r"""A lap joint: two strips, two bolts, a cycle of load, and a vibration that dies out by what the joint takes.

Two steel strips of 160 x 30 x 8 mm lie on each other over 60 mm, and two bolts through both draw them together. The
lower strip is held at its end, that of the upper one sits on a carriage of 25 kg which a guide leaves free along x
alone. A bolt is a spring between the middles of its two heads, shorter than what it clamps. So it follows the heads
where strips bend, and leans where they slide. Nothing but friction holds the strips on each other.

**Load steps.** The carriage goes to and fro between -a and a about its place at rest, a little further with every
cycle, at last until the strips slide. Its force F over its place x draws loops, and

    sum p = sum of both bolts,       |F - sum N x/l| <= mu sum p,       D = oint F dx        loss per cycle,

N the tension of a bolt of length l that leans by x/l. Pressure, forces and losses are those of full finite elements of
the same meshes, which share no code with engine and reduction (`demos.lap_loops`). Masing's rule, by which the
first loading alone tells the loss, is for pressures that stay and joints that begin without tractions. Here strips bend
and press elsewhere as they are pulled, and tightening has left tractions. It is a check of the loop of full slip, where
both hardly matter, and drawn for the others.

**Ring-down.** Pulled to 80 % of the force of slip and let go, the carriage swings. Half a cycle begins at rest in
m + e and ends at rest in -(m - e), so that the force has done no work between. It is the half loop of amplitude m,
which takes D/2, but begun further out by e, with a force that is F_a'(m) e higher all the way of 2 m,

    D/2 = 2 m F_a' e,       so that in a cycle       D = m dF,       ln(F_n/F_(n+1)) = D/(m F) = D/(2 U),   U = m F/2.

It is the amplitude of the *force* that falls by pi 2 zeta with 2 zeta = D/(2 pi U) of the loop; that of the place falls
faster where the joint gets softer. Forces are those of the first loading at the tops that the carriage comes to. The
loops are made at the amplitudes that cycles of the vibration had, and what friction took in these cycles is D, too.

Swung so little that hardly a cell slips, the carriage has the frequency of the eigenmodes with cells that stick, f_0.
At larger amplitudes it falls with the secant stiffness k of the loops, (2 pi f)^2 = k/M, M the modal mass at the
carriage. `modes.equivalent_damping` takes the joint through cycles under the forces of inertia of the eigenmode.

**Ledger.** What the vibration loses is work of friction; the integrator takes little of it.
"""

from __future__ import annotations

import logging
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

import warpffrf as wf
from demos.checks import Check, finish, writable_folder
from demos.lap_loops import Bolt, Full, LoadPath, Loops, Swing
from warpffrf.output.laps import LapResult
from warpffrf.output.plots import laps as lap_plots
from warpffrf.output.plots.panels import Panel

log = logging.getLogger("warpffrf")

STEEL = wf.Material(youngs_modulus=210e9, poisson_ratio=0.3, density=7850, name="steel")
FREE, OVERLAP, WIDTH, THICKNESS = 0.1, 0.06, 0.03, 0.008  # m, of a strip: beside the other one, on it
BOLTS, HOLE, HEAD = (0.015, 0.045), 0.004, 0.008  # m: places along the overlap, half of hole and washer, square
TIGHTENED, SHANK = 8e3, 3.5e8  # N, N/m: of an M8 bolt, before the strips give way
FRICTION, CARRIAGE = 0.2, 25.0  # -, kg
PULL, TOUCH = 2300.0, 60.0  # N: forces that the carriage is let go from
SLIDES = 30e-6  # m, amplitude of the loop of full slip
SMALLER = (3e-6, 6.5e-6)  # m, amplitudes of the first loops
SHOWN = (1, 2, 3, 5, 8)  # cycles of the vibration at whose amplitudes loops are made
RHO_INF = 0.5  # damps what faces that open and close do in steps that do not resolve it
CLAMP, PULLED, COULOMB = 1e-4, 1e-4, 1e-3  # held ends carry the rest; linear full FE; some cells slip a little aside
PRESSURE, LOSS = (
    0.01,
    3e-3,
)  # full FE are linear: strips of the engine turn as a force that goes through both bends them
AREA, FULL_SLIP = 0.01, 0.03  # trapezoids of 16 chords; of pressures that change a little
DAMPING, TAKEN = 0.05, 0.03  # first order in what a cycle takes; loops about the place at rest, cycles drift off it
FREQUENCY = 5e-3  # the integrator's, with 60 steps a cycle
LEDGER = 0.01  # of the work of friction: what the integrator damps
JOINT = "joint"
END = OVERLAP + FREE  # m, where the carriage is


@dataclass(frozen=True)
class Size:
    """Edges (k,) [m] of cells along half of the overlap and across half of the width, cells along the rest of a strip;
    steps of a cycle, cycles; load steps of the eigenmode's cycle; frames of the recording."""

    along: tuple[float, ...] = (0.0, 0.004, 0.007, 0.009, 0.011, 0.015, 0.019, 0.021, 0.023, 0.026, 0.03)
    across: tuple[float, ...] = (0.0, 0.004, 0.006, 0.008, 0.011, 0.015)
    beside: int = 5
    steps: int = 100
    cycles: int = 9
    mode_steps: int = 32
    frames: int = 220


FULL = Size()
QUICK = Size((0.0, 0.007, 0.011, 0.019, 0.023, 0.03), (0.0, 0.004, 0.008, 0.015), 3, steps=60, mode_steps=16, frames=60)


# --- the scene


def strip(size: Size = FULL, *, upper: bool = False) -> wf.mesh.Mesh:
    """The lower strip in z < 0, its end at x = -FREE, or the upper one above it, its end at x = OVERLAP + FREE; facet
    sets `overlap`, `head0`, `head1`."""
    half = np.array(size.across)
    y = np.concatenate([-half[:0:-1], half])
    lap = np.concatenate([size.along, 0.5 * OVERLAP + np.array(size.along[1:])])
    x, z = np.concatenate([np.linspace(-FREE, 0.0, size.beside + 1)[:-1], lap]), np.array([-THICKNESS, 0.0])
    if upper:
        x, z = (OVERLAP - x)[::-1], -z[::-1]
    middle, side = 0.5 * (x[1:] + x[:-1]), np.abs(0.5 * (y[1:] + y[:-1]))
    hole = (np.abs(middle[:, None] - BOLTS).min(axis=1) < HOLE)[:, None] & (side < HOLE)
    name, touching, outer = ("upper", "z_min", "z_max") if upper else ("lower", "z_max", "z_min")
    mesh = wf.mesh.grid(x, y, z, filled=~hole[:, :, None], name=name)
    mesh = mesh.select("overlap", touching, lambda c: (c[:, 0] > 0.0) & (c[:, 0] < OVERLAP))
    for i, place in enumerate(BOLTS):
        mesh = mesh.select(f"head{i}", outer, lambda c, x=place: np.abs(c[:, :2] - (x, 0.0)).max(axis=1) < HEAD)
    return mesh


def bodies(size: Size = FULL, *, progress: bool = True) -> tuple[wf.ReducedBody, wf.ReducedBody]:
    """The lower strip and the upper one, reduced; cells of the lap are facets."""
    lower, upper = (
        wf.reduce(
            strip(size, upper=over), STEEL, interfaces={end: "rigid", "head0": "average", "head1": "average"},
            laps={"overlap": "overlap"}, modes=10, cache=False, progress=progress,
        )
        for over, end in ((False, "x_min"), (True, "x_max"))
    )  # fmt: skip
    return lower, upper


def machine(
    strips: tuple[wf.ReducedBody, wf.ReducedBody], *, pull: wf.signals.Table | None = None,
    place: wf.signals.Table | None = None,
) -> wf.Scene:  # fmt: skip
    """The scene around strips that are reduced already: bodies `lower`, `upper`, `carriage`, joint `guide`, springs
    `bolt0`, `bolt1`, lap `joint`; with a force `pull` [N] along the guide, or carried to `place` [m]."""
    scene = wf.Scene(gravity=(0.0, 0.0, 0.0))
    lower, upper = (scene.add_body(body, name=name) for body, name in zip(strips, ("lower", "upper"), strict=True))
    middle, inertia = (END, 0.0, 0.5 * THICKNESS), (0.05, 0.05, 0.05)
    carriage = scene.add_rigid_body(CARRIAGE, inertia, name="carriage", position=middle).at((0, 0, 0))
    scene.add(wf.joints.Fixed(scene.ground, lower["x_min"], name="clamp"))
    scene.add(wf.joints.Fixed(carriage, upper["x_max"], name="grip"))
    guide = scene.add(wf.joints.Prismatic(scene.ground, carriage, axis=(1, 0, 0), name="guide"))
    for name in ("0", "1"):
        heads = lower[f"head{name}"], upper[f"head{name}"]
        length = 2.0 * THICKNESS - TIGHTENED / SHANK
        scene.add(wf.forces.SpringDamper(*heads, SHANK, free_length=length, name=f"bolt{name}"))
    scene.add(wf.Lap(lower["overlap"], upper["overlap"], friction=FRICTION, name=JOINT))
    if pull is not None:
        scene.add(wf.forces.PointForce(carriage, (pull, 0.0, 0.0), name="pull"))
    if place is not None:
        scene.add(wf.joints.Drive(guide, place, quantity="position", name="drive"))
    return scene


def let_go(force: float) -> wf.signals.Table:
    """Pulled to `force` [N] in a second of load steps, and let go."""
    return wf.signals.Table([0.0, 1.0, 1.0 + 1e-9, 10.0], [0.0, force, 0.0, 0.0])


def build(size: Size = FULL, *, progress: bool = True) -> wf.Scene:
    """The scene that is pulled and let go."""
    return machine(bodies(size, progress=progress), pull=let_go(PULL))


# --- the vibration


def swing(
    strips: tuple[wf.ReducedBody, wf.ReducedBody], force: float, frequency: float, size: Size, *, progress: bool = True
) -> tuple[wf.Result, Swing]:
    """Load steps up to `force` [N] and the cycles after it is let go, about those of `frequency` [Hz]."""
    scene = machine(strips, pull=let_go(force))
    pulled = wf.simulate(scene, 1.0, step=0.1, kind="static", progress=progress)
    result = wf.simulate(
        scene, (size.cycles + 0.6) / frequency, step=1.0 / (size.steps * frequency), start=pulled,
        integrator=wf.GeneralizedAlpha(RHO_INF), progress=progress,
    )  # fmt: skip
    rest = float(pulled.body("carriage").position[0, 0])
    place = result.body("carriage").position[:, 0] - rest
    return result, Swing(result.time - result.time[0], place, result.lap(JOINT).loss, rest - END)


# --- load steps


def followed(
    strips: tuple[wf.ReducedBody, wf.ReducedBody], path: LoadPath, rest: float, *, progress: bool = True
) -> tuple[wf.Result, Loops]:
    """The engine through a path about the place `rest` [m]."""
    times = np.arange(len(path.places), dtype=float)
    scene = machine(strips, place=wf.signals.Table(times, rest + path.places))
    result = wf.simulate(scene, times[-1], step=1.0, kind="static", progress=progress)
    rows = len(result.time)
    lost = np.append(result.lap(JOINT).loss, np.full(len(times) - rows, np.nan))
    force = np.append(result.joint("guide").force[:, 0], np.full(len(times) - rows, np.nan))
    return result, Loops(path, force, lost[path.loops[:, 1]] - lost[path.loops[:, 0]])


def tensions(result: wf.Result) -> np.ndarray:
    """Of both bolts (T, 2) [N]."""
    return np.stack([np.linalg.norm(result.force(f"bolt{i}").force, axis=1) for i in range(2)], axis=1)


def full_elements(size: Size, path: LoadPath, rest: float, tension: float) -> Full:
    """Full finite elements of the same meshes; `tension` [N] of a bolt at rest, by which it resists leaning."""
    bolt = Bolt(TIGHTENED, SHANK, 2.0 * THICKNESS, tension)
    meshes = strip(size), strip(size, upper=True)
    return Full.of(meshes, STEEL, FRICTION, bolt, len(BOLTS), path, rest)


# --- what is checked


def static_checks(result: wf.Result, loops: Loops, full: Full) -> list[Check]:
    """Clamp force, slip, and every loop beside full finite elements."""
    lap, pulls = result.lap(JOINT), tensions(result)
    clamp = lap.normal_force
    top = int(loops.path.loops[-1, 0])  # the strips slide
    lean = float(result.force("bolt0").force[top, 0] + result.force("bolt1").force[top, 0])
    peak = full.cells.pressure.max()
    off = float(np.abs(lap.pressure - full.cells.pressure).max())
    source = "full FE model"
    checks = [
        Check("tightened: clamp force", float(clamp[0]), float(pulls[0].sum()), "pull of both bolts", CLAMP, "kN",
              1e-3),
        Check("tightened: pull of a bolt", float(pulls[0, 0]), float(full.tension[0, 0]), source, PULLED, "kN", 1e-3),
        Check("tightened: peak pressure", float(lap.pressure[0].max()), float(full.cells.pressure[0].max()), source,
              PRESSURE, "MPa", 1e-6),
        Check("all loops: pressures differ by", off, 0.0, f"{source}, over the peak", PRESSURE, "MPa", 1e-6,
              scale=float(peak)),
        Check("sliding: force of friction", float(abs(lap.force[top, 0])), FRICTION * float(clamp[top]), "Coulomb",
              COULOMB, "kN", 1e-3),
        Check("sliding: force on the carriage", float(loops.force[top]), FRICTION * float(clamp[top]) + abs(lean),
              "Coulomb, bolts that lean", COULOMB, "kN", 1e-3),
    ]  # fmt: skip
    for a, loss, exact in zip(loops.path.amplitudes, loops.loss, full.loops.loss, strict=True):
        name = f"loss of a loop of {a * 1e6:.1f} um"
        checks.append(Check(name, float(loss), float(exact), source, LOSS, "mJ", 1e3))
    last = loops.all[-1]
    return [
        *checks,
        Check("its area, full slip", last.loss, float(loops.loss[-1]), "loss by friction", AREA, "mJ", 1e3),
        Check("its loss from the first loading", float(loops.masing[-1]), float(loops.loss[-1]), "Masing's rule",
              FULL_SLIP, "mJ", 1e3),
    ]  # fmt: skip


@dataclass(frozen=True, eq=False)
class Vibration:
    """The swing `large`, with its `result`, and the one `small` that hardly rubs, the first eigenmode about rest:
    frequency [Hz], modal mass [kg] at the carriage, `equivalent` damping of some amplitudes."""

    result: wf.Result
    large: Swing
    small: Swing
    frequency: float
    mass: float
    equivalent: Any


def small_frequency(vibration: Vibration) -> float:
    """Mean [Hz] of the cycles after the first, which begins with a jump of the force."""
    return float(vibration.small.frequency[1:].mean())


def swing_damping(swung: Swing, loops: Loops) -> np.ndarray:
    """2 zeta (n,) of the cycles by the amplitude of the force, that of the first loading."""
    rows = loops.path.first_loading
    force = np.interp(swung.turns()[1], loops.path.places[rows], loops.force[rows])
    return (np.log(force[:-1] / force[1:]) / np.pi)[: len(swung.amplitude)]


def loop_frequency(loops: Loops, mass: float) -> np.ndarray:
    """By the secant stiffness of each loop (k,) [Hz]."""
    return np.sqrt(loops.stiffness / mass) / (2.0 * np.pi)


def energies(result: wf.Result) -> tuple[np.ndarray, np.ndarray]:
    """What a vibration has lost (T,) [J] and the work of friction (T,) [J] so far."""
    energy = result.energy
    kept = np.sum([energy[line] for line in ("kinetic", "strain", "contact", "potential", "contact_grid")], axis=0)
    return kept[0] - kept, energy["friction"][0] - energy["friction"]


def swing_checks(vibration: Vibration, loops: Loops) -> list[Check]:
    """Cycles of the vibration beside loops at their amplitudes, eigenmodes and the ledger."""
    swung, found = vibration.large, swing_damping(vibration.large, loops)
    nearest = {n: loops.nearest(swung.amplitude[n - 1]) for n in SHOWN}
    checks = [
        Check(f"cycle {n}: 2 zeta of the force", float(found[n - 1]), float(loops.damping[k]), "loop, D/(2 pi U)",
              DAMPING)
        for n, k in nearest.items()
    ]  # fmt: skip
    checks += [
        Check(
            f"cycle {n}: taken by friction", float(swung.taken[n - 1]), float(loops.loss[k]), "loop", TAKEN, "mJ", 1e3
        )
        for n, k in nearest.items()
    ]
    mode = vibration.equivalent
    for zeta, a in zip(mode.damping_ratio, mode.amplitude, strict=True):
        exact = float(loops.damping[loops.nearest(a)])
        checks.append(Check(f"mode at {a * 1e6:.1f} um: 2 zeta", 2.0 * float(zeta), exact, "loop, D/(2 pi U)", DAMPING))
    n = SHOWN[1]
    secant = float(loop_frequency(loops, vibration.mass)[nearest[n]])
    lost, rubbed = energies(vibration.result)
    return [
        *checks,
        Check("small motion: frequency", small_frequency(vibration), vibration.frequency, "eigenmode, cells stick",
              FREQUENCY, "Hz"),
        Check(f"cycle {n}: frequency", float(swung.frequency[n - 1]), secant, "secant of the loop", FREQUENCY, "Hz"),
        Check("energy that the vibration loses", float(lost[-1]), float(rubbed[-1]), "work of friction", LEDGER, "mJ",
              1e3),
    ]  # fmt: skip


# --- what is drawn


@dataclass(frozen=True)
class Map:
    """The "pressure" or the "state" of the cells in a saved row."""

    lap: LapResult
    row: int
    what: str
    title: str

    def draw(self, ax: object) -> None:
        """Draw on matplotlib axes."""
        axes: Any = ax
        (lap_plots.pressure if self.what == "pressure" else lap_plots.state)(self.lap, axes, self.row)
        axes.set_title(self.title, fontsize=10)


def joined(curves: list[tuple[np.ndarray, np.ndarray]]) -> tuple[np.ndarray, np.ndarray]:
    """Curves as one, with gaps between."""
    gap = np.array([np.nan])
    x, y = (np.concatenate([part for c in curves for part in (c[i], gap)]) for i in range(2))
    return x, y


def envelope(swung: Swing, loops: Loops) -> tuple[np.ndarray, np.ndarray]:
    """Times [ms] and places [um] of the tops, if the force fell from cycle to cycle as the loops say."""
    zeta = np.interp(swung.amplitude, loops.path.amplitudes, loops.damping)
    force = PULL * np.exp(-np.pi * np.append(0.0, np.cumsum(zeta)))
    rows = loops.path.first_loading
    return swung.turns()[0][: len(force)] * 1e3, np.interp(force, loops.force[rows], loops.path.places[rows]) * 1e6


def panels(result: wf.Result, loops: Loops, full: Full, vibration: Vibration) -> list:
    """Loops, damping, maps of cells, the vibration, its frequency and energies."""
    lap, path, swung = result.lap(JOINT), loops.path, vibration.large
    um, kilo = 1e6, 1e-3
    place, force = "place of the carriage [um]", "force [kN]"
    drawn = [(one.displacement * um, one.force * kilo) for one in loops.all]
    exact = [(one.displacement * um, one.force * kilo) for one in full.loops.all]
    soft = um / loops.stuck
    larger = range(len(drawn) - 1 - len(SHOWN), len(drawn) - 1)
    slid = {f"{path.amplitudes[k] * um:.1f} um": (drawn[k][0] - drawn[k][1] * soft / kilo, drawn[k][1]) for k in larger}
    bound = FRICTION * lap.normal_force[0] * kilo * np.array([1.0, 1.0, np.nan, -1.0, -1.0])
    across = SLIDES * um * np.array([-1.0, 1.0, np.nan, -1.0, 1.0])
    size, part = path.amplitudes[:-1] * um, slice(None, -1)
    mode, tip = vibration.equivalent, int(path.loops[-2, 0])
    begins = int(path.loops[len(SMALLER), 0])
    on = slice(1, None)
    lost, rubbed = energies(vibration.result)
    return [
        Panel("Loops of load steps", place, force, {"partial slip": joined(drawn[:-1]), "full slip": drawn[-1]},
              {"full FE model": joined(exact), "friction of all cells": (across, bound)}, limits=(-3.4, 5.4)),
        Panel("The same, less what strips that stick yield", "slid [um]", force, slid,
              {"full FE model": joined([(exact[k][0] - exact[k][1] * soft / kilo, exact[k][1]) for k in larger])}),
        Panel("Damping against amplitude", "amplitude of the carriage [um]", "2 zeta [%]",
              {"loops, D/(2 pi U)": (size, 100.0 * loops.damping[part])},
              {"loops of the full FE model": (size, 100.0 * full.loops.damping[part])},
              points={"cycles of the vibration": (swung.amplitude * um, 100.0 * swing_damping(swung, loops)),
                      "eigenmode, equivalent": (mode.amplitude * um, 200.0 * mode.damping_ratio),
                      "first loading, Masing": (size, 100.0 * (loops.damping * loops.masing / loops.loss)[part])}),
        Map(lap, 0, "pressure", "Pressure when tightened"),
        Map(lap, begins, "state", f"Cells at {loops.force[begins] * kilo:.2f} kN"),
        Map(lap, tip, "state", f"Cells at {loops.force[tip] * kilo:.2f} kN"),
        Panel("Let go", "time [ms]", place, {"run": (swung.time * 1e3, swung.place * um)},
              {"tops by the damping of the loops": envelope(swung, loops)}),
        Panel("Frequency against amplitude", "amplitude of the carriage [um]", "frequency [Hz]",
              {"secant of the loops": (size, loop_frequency(loops, vibration.mass)[part])},
              {"eigenmode, cells stick": (np.array([0.0, size[-1]]), np.full(2, vibration.frequency))},
              points={"cycles of the vibration": (swung.amplitude[on] * um, swung.frequency[on]),
                      "of the small one": (vibration.small.amplitude[on] * um, vibration.small.frequency[on])}),
        Panel("Energy of the vibration", "time [ms]", "energy [mJ]", {"lost": (swung.time * 1e3, lost * 1e3)},
              {"work of friction": (swung.time * 1e3, rubbed * 1e3)}),
    ]  # fmt: skip


def main(out: str | Path = "out/lap_joint", *, quick: bool = False, progress: bool = True) -> int:
    """Run the demo and write lap_joint.h5, .rrd, .png and summary.json into the folder `out`; 0 when all went well.

    Those are of the load steps; the vibration and a small one are in lap_joint.swing.h5 and .small.h5. quick: larger
    cells and steps. Raises `InputError` for a folder that cannot be written.
    """
    folder = writable_folder(out)
    size = QUICK if quick else FULL
    strips = bodies(size, progress=progress)
    scene = machine(strips)
    modes = wf.eigenmodes(scene)
    frequency, moves = float(modes.frequencies[0]), float(np.real(modes.shape(0, "carriage").translation[0]))
    log.info("lap joint: let go from %g and %g N, then load steps through loops, and full finite elements", PULL, TOUCH)
    ringing, large = swing(strips, PULL, frequency, size, progress=progress)
    touched, small = swing(strips, TOUCH, frequency, replace(size, cycles=3), progress=progress)
    if len(large.amplitude) < max(SHOWN):
        log.error("the vibration ended early, %s: %s", ringing.status, ringing.message)
        return 1
    path = LoadPath.of(np.concatenate([SMALLER, np.sort(large.amplitude[[n - 1 for n in SHOWN]]), [SLIDES]]))
    result, loops = followed(strips, path, large.rest, progress=progress)
    results = {"loops": result, "swing": ringing, "small": touched}
    for name, run in results.items():
        if run.status != "completed":
            log.error("the run '%s' ended early, %s: %s", name, run.status, run.message)
            return 1
    full = full_elements(size, path, large.rest, float(tensions(result)[0].mean()))
    equivalent = modes.equivalent_damping(
        0, path.amplitudes[[len(SMALLER) - 1, -2]], at=scene.body("carriage").at((0, 0, 0)), steps=size.mode_steps
    )
    vibration = Vibration(ringing, large, small, frequency, moves**-2, equivalent)
    checks = [*static_checks(result, loops, full), *swing_checks(vibration, loops)]
    drawn = panels(result, loops, full, vibration)
    return finish(folder / "lap_joint", results, checks, drawn, frames=size.frames)
