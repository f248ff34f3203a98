r"""A clamped plate that deflects by twice its thickness: under pressure, let go, and its frequency by amplitude.

A square plate a hundred times as wide as thick is clamped in a rigid rim. Under pressure it bends, and from about half
of its thickness on it stretches as well: to third order in its deflection w

    q = c_1 w + c_3 w^3,

the second term from a membrane force in proportion to w^2. At w = 2 t a plate that only bends would go nearly three
times as far. What stretches is held by the plate itself, and no load at an interface knows of it: the rim is one rigid
interface and does not move. So `stiffening=True` does nothing here, and `stiffening="membrane"` is all of it
(`warpffrf/offline/inertia/membrane.py`).

*Under pressure*, in load steps at the loads of S. Levy's table (NACA Report 740, 1942). The same mesh in full finite
elements of St. Venant-Kirchhoff's material (`tests/references/large_deflections`) has the same deflections. From
Levy's both differ alike: by their cells where loads are small, by 2.5 % at the largest load, where finer cells change
nothing any more; he states 2 % for his series, and his rim may move along itself.

*Let go* from two of these states, without damping: every mode swings, exchanges energy with the others, and the full
model, integrated in time, does the same. What the reduced plate leaves out is the inertia of its second-order motion.

*Dying out*: higher modes are damped soon, the first one slowly, so that the plate swings in its nonlinear first mode
with ever smaller amplitude A. Each cycle is a point of its frequency by A, beside the closed form of one term and
Duffing's equation (`tests/references/closed_forms/large_deflections.py`), which is right up to A = t, and too
stiff beyond, where the plate becomes flatter in its middle.
"""

from __future__ import annotations

import logging
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

import warpffrf as wf
from demos.checks import Check, finish, writable_folder
from references.closed_forms import CLAMPED_SQUARE, LEVY_CLAMPED_SQUARE, clamped_plate_frequency
from references.closed_forms.large_deflections import LEVY_POISSON
from references.large_deflections.body import StVenantKirchhoffBody
from references.large_deflections.motion import released
from references.large_deflections.statics import by_load
from warpffrf.output.plots.panels import Panel

log = logging.getLogger("warpffrf")

Array = np.ndarray
SIDE, THICKNESS = 0.4, 4e-3  # m
STEEL = wf.Material(youngs_modulus=210e9, poisson_ratio=LEVY_POISSON, density=7850, name="steel")
UNIT = STEEL.youngs_modulus * (THICKNESS / SIDE) ** 4  # Pa, of q a^4/(E t^4) = 1
BENDING = STEEL.youngs_modulus * THICKNESS**3 / (12.0 * (1.0 - LEVY_POISSON**2))  # N m
FREQUENCY = CLAMPED_SQUARE / (2.0 * np.pi * SIDE**2) * np.sqrt(BENDING / (STEEL.density * THICKNESS))  # Hz
SMALL = 0.00126 * UNIT * SIDE**4 / BENDING / THICKNESS  # w/t of a unit load, if it only bends (Timoshenko)
GRADED = 1.5  # power by which cells get smaller towards the rim
MODES = 20
LOADS = tuple(LEVY_CLAMPED_SQUARE)
LET_GO = (134.9, 402.0)  # q a^4/(E t^4) of the runs without damping
FIRST, HIGHER = 0.003, 0.05  # damping ratios
A_PERIOD = 60  # steps
STEP = float(1.0 / FREQUENCY / A_PERIOD)  # s; in the first one the pressure goes, as if at once in its middle
SHOWN = (0.3, 0.6, 1.0)  # A/t of the checks
LEVY, FULL_MODEL = 0.028, 4e-3  # see the module: his series, and what 20 modes are off by
CLAMPED = 0.015  # of the first frequency: a solid plate, and its cells
ONE_TERM = 0.01  # of f/f0 up to A = t
SWING = 0.015, 0.03  # rms over the amplitude, in the first period


@dataclass(frozen=True)
class Size:
    """Quadratic cells along half of a side, loads of the static run, loads to let go from, periods of the run that dies
    out."""

    cells: int = 8
    loads: tuple[float, ...] = LOADS
    let_go: tuple[float, ...] = LET_GO
    periods: int = 150


FULL, QUICK = Size(), Size(cells=6, loads=(17.79, 134.9, 402.0), let_go=LET_GO[:1], periods=120)


def half_lines(size: Size) -> Array:
    """Boundaries of cells (cells + 1,) [m] from the middle to the rim."""
    return 0.5 * SIDE * (1.0 - (1.0 - np.linspace(0.0, 1.0, size.cells + 1)) ** GRADED)


def plate_mesh(x: Array, size: Size) -> wf.mesh.Mesh:
    """A plate with cells between `x` along both sides, and the facet sets `rim`, of all sides at a distance of a/2, and
    `face`, its upper side but for the cells at the rim."""
    cells = wf.mesh.grid(x, x, [-0.5 * THICKNESS, 0.5 * THICKNESS])
    outer = cells.outer_facets()
    inner = half_lines(size)[-2]
    at = np.abs(outer.centers(cells.points))
    rim = outer.kept(at[:, :2].max(axis=1) > 0.5 * SIDE * (1.0 - 1e-9))
    plain = wf.mesh.Mesh(cells.points, cells.cells, {**cells.facet_sets, "rim": rim}, name="plate")
    return plain.select("face", "z_max", lambda y: np.abs(y[:, :2]).max(axis=1) < inner)


def pressed_area(size: Size) -> float:
    """m2 of `face`."""
    return float(2.0 * half_lines(size)[-2]) ** 2


def build(
    size: Size = FULL, *, loads: Sequence[float] | None = None, damped: bool = True, progress: bool = True
) -> wf.Scene:
    """The scene: body `plate` in its rim; pressure on its face takes each of the `loads` q a^4/(E t^4) after the other,
    a second each, and is gone then."""
    chosen = size.loads if loads is None else loads
    half = half_lines(size)
    reduced = wf.reduce(
        plate_mesh(np.concatenate([-half[:0:-1], half]), size), STEEL,
        interfaces={"rim": "rigid", "face": "average"}, modes=MODES, stiffening="membrane", membrane_modes=MODES,
        progress=progress,
    )  # fmt: skip
    scene = wf.Scene(gravity=(0.0, 0.0, 0.0))
    damping = np.r_[FIRST, np.full(len(reduced.frequencies) - 1, HIGHER)] if damped else 0.0
    plate = scene.add_body(reduced, name="plate", stiffening=True, damping=damping)
    scene.add(wf.joints.Fixed(scene.ground, plate["rim"], name="clamp"))
    n = float(len(chosen))
    forces = UNIT * pressed_area(size) * np.array([0.0, *chosen, 0.0, 0.0])
    push = wf.signals.Table([*np.arange(n + 1.0), n + STEP, n + 1e3], forces)
    scene.add(wf.forces.PointForce(plate["face"], (0.0, 0.0, push), name="pressure"))
    return scene


def deflection(result: wf.Result) -> Array:
    """w/t (T,) of the middle of the upper side."""
    body, motion = result.scene.body("plate").flexible, result.body("plate")
    middle = int(np.argmin(np.linalg.norm(body.surface.points - [0.0, 0.0, 0.5 * THICKNESS], axis=1)))
    shape = np.asarray(body.surface.modes[:, middle, 2], dtype=float)
    return (motion.position[:, 2] + motion.modal @ shape) / THICKNESS


@dataclass(frozen=True, eq=False)
class Swing:
    """A run that is let go at t = 0: times t (T,) [s] and w/t (T,) of the middle."""

    t: Array
    w: Array

    @property
    def cycles(self) -> tuple[Array, Array]:
        """Amplitudes A/t (n,) and frequencies (n,) [Hz] of the cycles from one upward crossing of zero to the next."""
        i = np.flatnonzero((self.w[:-1] < 0.0) & (self.w[1:] >= 0.0))
        cross = self.t[i] - self.w[i] * (self.t[i + 1] - self.t[i]) / (self.w[i + 1] - self.w[i])
        heights = [np.ptp(self.w[a:b]) for a, b in zip(i[:-1], i[1:], strict=True)]
        return 0.5 * np.array(heights), 1.0 / np.diff(cross)

    def frequency(self, amplitude: float) -> float:
        """Hz at an amplitude A/t."""
        A, f = self.cycles
        return float(np.interp(amplitude, A[::-1], f[::-1]))


def let_go(pressed: wf.Result, periods: float, *, progress: bool = True) -> tuple[wf.Result, Swing]:
    """The run that goes on from load steps, `periods` of the linear first mode long."""
    run = wf.simulate(pressed.scene, round(periods * A_PERIOD) * STEP, step=STEP, start=pressed,
                      progress=progress)  # fmt: skip
    return run, Swing(run.time - pressed.time[-1] - 0.5 * STEP, deflection(run))


def press(scene: wf.Scene, loads: Sequence[float], *, progress: bool = True) -> wf.Result:
    """The load steps of a scene of `build`."""
    return wf.simulate(scene, float(len(loads)), step=1.0, kind="static", progress=progress)


@dataclass(frozen=True, eq=False)
class FullModel:
    """A quarter of the plate in full finite elements: w/t (n,) under the loads, and swings by the load let go."""

    w: Array
    swings: dict[float, Swing] = field(default_factory=dict)


def full_model(size: Size = FULL) -> FullModel:
    """Statics, and motion over one linear period, by symmetry."""
    mesh = plate_mesh(half_lines(size), size)
    body = StVenantKirchhoffBody(mesh, STEEL)
    mirrors = [3 * np.flatnonzero(np.isclose(mesh.points[:, c], 0.0)) + c for c in (0, 1)]
    held = np.unique(np.concatenate([*mirrors, body.held("rim")]))
    load = body.spread("face", (0.0, 0.0, 0.25 * UNIT * pressed_area(size)))
    middle = 3 * body.nearest_node((0.0, 0.0, 0.5 * THICKNESS)) + 2
    states = by_load(body, held, load, size.loads)
    swings = {}
    for chosen in size.let_go:
        begin = states[size.loads.index(chosen)].u
        motion = released(body, held, begin, 1.0 / FREQUENCY, A_PERIOD)
        swings[chosen] = Swing(motion.t, motion.u[:, middle] / THICKNESS)
    return FullModel(np.array([s.u[middle] for s in states]) / THICKNESS, swings)


@dataclass(frozen=True, eq=False)
class Runs:
    """All runs: the static one and the one that dies out, those without damping by the load let go from, and f0 [Hz]
    of the scene's eigenmodes."""

    pressed: wf.Result
    dying: wf.Result
    swing: Swing
    free: dict[float, tuple[wf.Result, Swing]]
    linear: float

    @property
    def results(self) -> dict[str, wf.Result]:
        """By the names of their files; the first is the one recorded."""
        last = max(self.free)
        return {"free": self.free[last][0], "pressed": self.pressed, "dying": self.dying}


def run(size: Size = FULL, *, progress: bool = True) -> Runs:
    """The load steps, and what swings from them."""
    scene = build(size, progress=progress)
    linear = float(wf.eigenmodes(scene, 1, about="initial").frequencies[0])
    pressed = press(scene, size.loads, progress=progress)
    dying, swing = let_go(pressed, size.periods, progress=progress)
    free = {}
    for load in size.let_go:
        loads = [q for q in size.loads if q <= load]
        begin = press(build(size, loads=loads, damped=False, progress=progress), loads, progress=progress)
        free[load] = let_go(begin, 2.0, progress=progress)
    return Runs(pressed, dying, swing, free, linear)


def off(mine: Swing, full: Swing) -> float:
    """rms of the difference over that of the full model, in its time."""
    return float(np.sqrt(np.mean((np.interp(full.t, mine.t, mine.w) - full.w) ** 2) / np.mean(full.w**2)))


def checks(runs: Runs, full: FullModel, size: Size) -> list[Check]:
    """The figures of all runs."""
    found = []
    w = deflection(runs.pressed)[1:]
    for i, load in enumerate(size.loads):
        name = f"qa4/Et4 = {load:g}: w/t"
        found.append(Check(name, float(w[i]), LEVY_CLAMPED_SQUARE[load], "Levy", LEVY))
        found.append(Check(f"{name}, same cells", float(w[i]), float(full.w[i]), "full FE model", FULL_MODEL))
    found.append(Check("first frequency", runs.linear, FREQUENCY, "thin plate", CLAMPED, "Hz"))
    for A in SHOWN:
        exact = clamped_plate_frequency(A, LEVY_POISSON)
        ratio = runs.swing.frequency(A) / runs.linear
        found.append(Check(f"A/t = {A:g}: frequency over the first", ratio, exact, "one term, Duffing", ONE_TERM))
    for (load, (_, swing)), bound in zip(runs.free.items(), SWING, strict=False):
        reference = full.swings[load]
        name = f"let go at w/t = {reference.w[0]:.2f}: w off by"
        found.append(Check(name, off(swing, reference), 0.0, "full FE model, a period, rms over rms", bound, scale=1.0))
    return found


def panels(runs: Runs, full: FullModel, size: Size) -> Sequence[Any]:
    """Deflection by load; swings beside the full model; frequency by amplitude."""
    q, w = np.array([0.0, *size.loads]), np.array([0.0, *full.w])
    A, f = runs.swing.cycles
    amplitudes = np.linspace(0.0, float(A.max()), 100)
    one_term = np.array([clamped_plate_frequency(a, LEVY_POISSON) for a in amplitudes])
    swings, reference = {}, {}
    for load, (_, swing) in runs.free.items():
        swings[f"from w/t = {swing.w[0]:.2f}"] = (1e3 * swing.t, swing.w)
        reference[f"full FE model, {swing.w[0]:.2f}"] = (1e3 * full.swings[load].t, full.swings[load].w)
    return [
        Panel("Middle under pressure", "qa⁴/Et⁴ [-]", "w/t [-]",
              {"plate": (q, deflection(runs.pressed)), "bending alone": (q, SMALL * q)},
              {"full FE model": (q, w)}, limits=(0.0, 2.5),
              points={"Levy": (np.array(LOADS), np.array([LEVY_CLAMPED_SQUARE[x] for x in LOADS]))}),
        Panel("Let go, without damping", "time [ms]", "w/t [-]", swings, reference),
        Panel("Frequency of a cycle by its amplitude", "A/t [-]", "f/f0 [-]", {"dying out": (A, f / runs.linear)},
              {"one term, Duffing": (amplitudes, one_term)}),
    ]  # fmt: skip


def main(out: str | Path = "out/plate", *, quick: bool = False, progress: bool = True) -> int:
    """Run the demo and write plate.h5, .rrd, .png and summary.json into the folder `out`; 0 when all went well.

    quick: larger cells, fewer loads, one swing. Raises `InputError` for a folder that cannot be written.
    """
    folder = writable_folder(out)
    size = QUICK if quick else FULL
    log.info("plate: %d load steps, then %d periods that die out", len(size.loads), size.periods)
    runs = run(size, progress=progress)
    for result in runs.results.values():
        if result.status != "completed":
            log.error("a run ended early, %s: %s", result.status, result.message)
            return 1
    log.info("full finite elements: %d loads, %d swings", len(size.loads), len(size.let_go))
    full = full_model(size)
    frames = len(runs.results["free"].time)
    return finish(folder / "plate", runs.results, checks(runs, full, size), panels(runs, full, size), frames=frames)
