r"""Two steel rollers with friction: one driven, the other carried along, then braked until it slips.

The lower roller turns on a fixed axle and is driven. The upper one, with a flywheel on its shaft, turns freely in a
carriage that is pressed down. Nothing but friction in the contact turns it: while the lower roller speeds up from rest
the upper one is carried along; then they roll freely; then a brake on the flywheel rises in steps and waits on each
until the contact has settled; at last it asks for more than friction can give, and the whole patch slips.

What to expect. Carried along and rolling freely, the surface speeds agree but for the creepage that belongs to the
tangential force. On every step of the brake, Q = M/R, force and creepage are on Carter's curve,

    xi = (mu a/R') (1 - sqrt(1 - Q/(mu P))),    1/R' = 1/R1 + 1/R2,    a^2 = 4 P' R'/(pi E*)

(K. L. Johnson, Contact Mechanics, 1985, section 8.3), up to what the free ends of the rollers change: his rollers are
in plane strain, these are as wide as eight patches. With friction in cells the creepage that belongs to a force is too
small, by about half of the cell over the half-width squared; a second run with cells twice as large shows that, and
xi + (xi - xi_coarse)/3 is left with an error of higher order. In gross slip the traction coefficient is mu. Friction
never gives energy.

The same machine is run with rollers in elements of 4 mm as well, of which half of the patch is a seventh: friction is
in cells that travel with the patch there. The creepage is held against the finer run's and against Carter's at the mean
line load, since ends that are cells of their own let the middle carry 4 % more; no second grid is needed.

The patch advances by nearly one cell of the contact grid in a step, and on every step of the brake it runs through its
own length `HELD` times: creep winds up the elastic shift of the surfaces against their axles, which takes that long.
"""

from __future__ import annotations

import logging
import time
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

import warpffrf as wf
from demos.checks import Check, finish, writable_folder
from references.closed_forms import CarterRolling, LineContact, contact_modulus
from warpffrf.output.plots.friction import StickSlipMap

log = logging.getLogger("warpffrf")

STEEL = wf.Material(youngs_modulus=210e9, poisson_ratio=0.3, density=7850, name="steel")
OUTER_RADIUS, BORE_RADIUS, WIDTH = 0.05, 0.015, 0.01  # m
LOAD, FRICTION = 13e3, 0.3  # N, -
CARRIAGE_MASS, CARRIAGE_INERTIA = 5.0, (0.01, 0.01, 0.01)  # kg, kg m2
FLYWHEEL_MASS, FLYWHEEL_INERTIA = 20.0, (0.1, 0.2, 0.1)  # kg, kg m2: slip, once it is there, grows slowly
SPEED = 10.0  # rad/s of the driven roller
SPIN_UP = 0.04  # s: the largest torque on the upper one is half of what friction can give
RELATIVE_RADIUS = 0.5 * OUTER_RADIUS  # R'
HERTZ = LineContact(LOAD / WIDTH, RELATIVE_RADIUS, contact_modulus(STEEL, STEEL))
CROSSING = 2.0 * HERTZ.half_width / (SPEED * OUTER_RADIUS)  # s, in which the material runs through the patch
FREE, RISE, HELD, LAST = 10, 8, 14, 6  # crossings: rolling freely, the brake rises, it waits, the patch slips
SETTLED = 6  # crossings at the end of each of these parts that are averaged, three swings of the flywheel
SHARES = (0.25, 0.5, 0.75)  # of the friction force, on which the brake waits
BEYOND = 1.1  # of it, at last
RISE_SAMPLES = 17  # of the table of the torque in each rise, which is smooth: a kink makes the flywheel swing
ADVANCE = 0.9  # cells of the contact grid through which the patch moves in a step; above one friction is not resolved
SAVE_EVERY = 4  # steps
PAIR, BRAKE = "lower-upper", "brake"
AGREE = 5e-5  # of the surface speed: rolling freely, what is left of the flywheel's swinging
CELL_ERROR = 0.7  # of the creepage, times the square of the cells in a half-width: 0.5 at 5 of them, 0.4 at 7.6
EXTRAPOLATED = 0.015  # of the creepage, from two grids: ends of the rollers, and what is of higher order in the cell
ON_PATCH = 0.01  # of the creepage, from cells of the patch: ends of the rollers, thirteen cells
BESIDE = 0.02  # of the creepage, of both runs from each other
COEFFICIENT = 1e-3  # tractions are tangents of a patch that is an arc, (a/R)^2, and it slips with mu on all sides
DISSIPATION = 1e-12  # of the work of friction: rounding


@dataclass(frozen=True)
class Size:
    """How fine a roller is meshed, in quadratic hexahedra, and how many frames the recording shows at most.

    layers: through the wall; they grow towards the bore. patch: cells across and along of a grid that travels with the
    patch; None for the contact grid of the mesh.
    """

    sectors: int = 2000  # eight nodes in a half-width
    layers: int = 9
    axial: int = 2
    frames: int = 200
    patch: tuple[int, int] | None = None

    @property
    def coarse(self) -> Size:
        """Half as many cells around."""
        return replace(self, sectors=self.sectors // 2)

    @property
    def spacing(self) -> float:
        """m, of the contact grid: the nodes of quadratic cells, or cells of the patch, which reach 1.3 half-widths."""
        if self.patch is not None:
            return 2.6 * HERTZ.half_width / self.patch[0]
        return np.pi * OUTER_RADIUS / self.sectors

    @property
    def step(self) -> float:
        """s."""
        return ADVANCE * self.spacing / (SPEED * OUTER_RADIUS)


FULL, QUICK = Size(), Size(sectors=1500, frames=60)
BIG_CELLS = Size(sectors=78, layers=8, axial=3, patch=(13, 9))  # of 4 mm


@dataclass(frozen=True)
class Schedule:
    """When what happens [s]: end of rolling freely, ends of the waits on `SHARES`, end of the run."""

    free: float
    waits: tuple[float, ...]
    end: float


def schedule() -> Schedule:
    """The times of a run, from the crossings of the patch that its parts take."""
    free = SPIN_UP + FREE * CROSSING
    waits = tuple(free + n * (RISE + HELD) * CROSSING for n in range(1, len(SHARES) + 1))
    return Schedule(free, waits, waits[-1] + (RISE + LAST) * CROSSING)


def brake() -> wf.signals.Table:
    """Torque of the brake over time [N m]: smooth steps to `SHARES` of what friction gives, then to `BEYOND` of it."""
    plan = schedule()
    x = np.linspace(0.0, 1.0, RISE_SAMPLES)
    smooth = x**3 * (10.0 - 15.0 * x + 6.0 * x**2)
    times, shares, level = [], [], 0.0
    for start, share in zip((plan.free, *plan.waits), (*SHARES, BEYOND), strict=True):
        times.append(start + RISE * CROSSING * x)
        shares.append(level + (share - level) * smooth)
        level = share
    torque = np.concatenate(shares) * FRICTION * LOAD * OUTER_RADIUS
    return wf.signals.Table(np.concatenate(times), torque, hold=True)


def build(size: Size = FULL, *, progress: bool = True) -> wf.Scene:
    """The scene: bodies `lower`, `upper`, `carriage`, `flywheel`, contact pair `lower-upper`, torque `brake`.

    The press is a force on the carriage; there is no gravity, so that the contact carries `LOAD`.
    """
    mesh = wf.mesh.roller(
        OUTER_RADIUS, BORE_RADIUS, WIDTH, sectors=size.sectors, layers=size.layers, axial=size.axial, order=2
    )
    roller = wf.reduce(
        mesh, STEEL, interfaces={"bore": "rigid"}, contact={"rim": wf.surfaces.Cylinder()}, modes=0, tangential=True,
        contact_fixed=size.patch is not None, progress=progress,
    )  # fmt: skip
    scene = wf.Scene()
    lower = scene.add_body(roller, name="lower")
    upper = scene.add_body(roller, name="upper", position=(0, 0, 2 * OUTER_RADIUS))
    grid: dict[str, Any] = {} if size.patch is None else {"grid": "contact_fixed", "cells": size.patch}
    contact = scene.add(wf.Contact(lower["rim"], upper["rim"], friction=FRICTION, name=PAIR, **grid))
    scene.close_gap(contact)
    place = upper["bore"].world_point()
    carriage = scene.add_rigid_body(CARRIAGE_MASS, CARRIAGE_INERTIA, name="carriage", position=place)
    flywheel = scene.add_rigid_body(FLYWHEEL_MASS, FLYWHEEL_INERTIA, name="flywheel", position=place)
    center, disc = carriage.at((0, 0, 0)), flywheel.at((0, 0, 0))
    axle = scene.add(wf.joints.Revolute(scene.ground, lower["bore"], axis=(0, 1, 0), name="axle"))
    scene.add(wf.joints.Prismatic(scene.ground, center, axis=(0, 0, 1), name="guide"))
    scene.add(wf.joints.Revolute(center, upper["bore"], axis=(0, 1, 0), name="upper_axle"))
    scene.add(wf.joints.Fixed(upper["bore"], disc, name="shaft"))
    spin = wf.signals.SmoothStep(0.0, SPEED, duration=SPIN_UP)
    scene.add(wf.joints.Drive(axle, spin, quantity="velocity"))
    scene.add(wf.forces.PointForce(center, (0, 0, -LOAD), name="press"))
    scene.add(wf.forces.PointTorque(disc, (brake(), (0, 1, 0)), name=BRAKE))
    return scene


def run(scene: wf.Scene, size: Size, *, progress: bool = True) -> wf.Result:
    """The whole schedule from the static state under the press."""
    return wf.simulate(
        scene, schedule().end, step=size.step, start="equilibrium", save_every=SAVE_EVERY, progress=progress
    )


def _settled(result: wf.Result, values: np.ndarray, end: float) -> float:
    """Mean of `values` (T,) over the last `SETTLED` crossings before `end` [s].

    Weighted by sin^2, which is zero at both ends, so that what is left of the flywheel's swinging averages out.
    """
    x = (end - result.time) / (SETTLED * CROSSING)
    inside = (x > 0.0) & (x < 1.0)
    return float(np.average(values[inside], weights=np.sin(np.pi * x[inside]) ** 2))


def shares(result: wf.Result) -> np.ndarray:
    """Q/(mu P) (T,) with which the lower roller drives the upper one."""
    pair = result.contact(PAIR)
    return -pair.friction.tangential_force[:, 0] / (FRICTION * pair.normal_load)


def on_carters_curve(result: wf.Result, *, line_load: float | None = None) -> list[tuple[float, float, float]]:
    """At the end of each wait of the brake: share of the friction force, creepage found, and Carter's at that share.

    Carter's is that of `line_load` [N/m], unless given the one found at mid-width, which is a little above the mean.
    """
    pair, found = result.contact(PAIR), shares(result)
    values = []
    for end in schedule().waits:
        load = _settled(result, pair.line_load, end) if line_load is None else line_load
        line = LineContact(load, RELATIVE_RADIUS, HERTZ.modulus)
        share = _settled(result, found, end)
        creepage = _settled(result, pair.friction.creepage[:, 0], end)
        values.append((share, creepage, CarterRolling.from_share(line, FRICTION, share).creepage))
    return values


def extrapolated(fine: wf.Result, coarse: wf.Result) -> list[float]:
    """Creepage at the end of each wait from two grids, of which one has cells twice as large."""
    found = zip(on_carters_curve(fine), on_carters_curve(coarse), strict=True)
    return [xi + (xi - carter * xi_coarse / carter_coarse) / 3.0
            for (_, xi, carter), (_, xi_coarse, carter_coarse) in found]  # fmt: skip


def checks(result: wf.Result, coarse: wf.Result, size: Size) -> list[Check]:
    """The figures of a run, and of one with cells twice as large."""
    found = _free("", result)
    of_cells = CELL_ERROR * (size.spacing / HERTZ.half_width) ** 2
    for (share, xi, carter), best in zip(on_carters_curve(result), extrapolated(result, coarse), strict=True):
        label = f"creepage at {share:.2f} mu P"
        found += [
            Check(label, xi, carter, "Carter", of_cells),
            Check(f"{label}, two grids", best, carter, "Carter", EXTRAPOLATED),
        ]
    return [*found, *_slipping("", result)]


def checks_on_patch(result: wf.Result, fine: wf.Result, coarse: wf.Result) -> list[Check]:
    """The figures of the run on cells of the patch, also beside the two others."""
    found = _free("4 mm: ", result)
    settled = on_carters_curve(result, line_load=LOAD / WIDTH)
    for (share, xi, carter), best in zip(settled, extrapolated(fine, coarse), strict=True):
        label = f"4 mm: creepage at {share:.2f} mu P"
        found += [
            Check(label, xi, carter, "Carter, mean line load", ON_PATCH),
            Check(label, xi, best, "the other mesh, two grids", BESIDE),
        ]
    return [*found, *_slipping("4 mm: ", result)]


def _free(label: str, result: wf.Result) -> list[Check]:
    free = _settled(result, result.contact(PAIR).friction.creepage[:, 0], schedule().free)
    return [Check(f"{label}rolling freely: speeds differ by", free, 0.0, "no torque, over the speed", AGREE, scale=1.0)]


def _slipping(label: str, result: wf.Result) -> list[Check]:
    pair = result.contact(PAIR)
    force = np.hypot(pair.force[-1, 0], pair.force[-1, 1]) / pair.force[-1, 2]
    stick, work = float((pair.friction.state[-1] == 1).sum()), result.energy["friction"]
    return [
        Check(f"{label}traction coefficient in gross slip", abs(float(force)), FRICTION, "Coulomb", COEFFICIENT),
        Check(f"{label}cells that stick then", stick, 0.0, "all slip", 0.0, scale=1.0),
        Check(f"{label}largest gain from friction", max(float(np.diff(work).max()), 0.0), 0.0,
              "takes energy only, over all work", DISSIPATION, "J", scale=float(np.ptp(work))),
    ]  # fmt: skip


def side_by_side(results: dict[str, wf.Result], seconds: dict[str, tuple[float, float]]) -> str:
    """Forces, creepages and costs of the runs as text; seconds: wall time of reduction and run, by name."""
    labels = [f"at {share:.2f} mu P [1e-3]" for share in SHARES]
    lines = [f"{'creepage':<20}{'Q/(mu P)':>18}{''.join(f'{label:>21}' for label in labels)}"
             f"{'steps':>8}{'step [ms]':>11}{'reduction, run [s]':>20}"]  # fmt: skip
    for name, result in results.items():
        settled, counters = on_carters_curve(result), result.history.counters
        mean = on_carters_curve(result, line_load=LOAD / WIDTH)
        forces = ", ".join(f"{share:.3f}" for share, _, _ in settled)
        found = [f"{xi * 1e3:.4f} ({xi / carter - 1.0:+.1%})" for _, xi, carter in mean]
        step = 1e3 * counters["seconds_in_graph"] / max(int(counters["steps"]), 1)
        cost = f"{int(counters['steps']):>8d}{step:>11.2f}{f'{seconds[name][0]:.0f}, {seconds[name][1]:.0f}':>20}"
        lines.append(f"{name:<20}{forces:>18}" + "".join(f"{text:>21}" for text in found) + cost)
    return "\n".join([*lines, "(in brackets: over Carter's at the mean line load)"])


def panels(result: wf.Result, on_patch: wf.Result) -> list:
    """Speeds and force over time, creepage against force, tractions on the second wait of the brake; of the run on the
    grid of the mesh and of that on cells of the patch."""
    from warpffrf.output.plots.panels import Panel

    plan, both = schedule(), {"fine mesh": result, "4 mm, cells of the patch": on_patch}
    forces, curves, powers, tractions = {}, {}, {}, {}
    for name, run_ in both.items():
        friction, share, t = run_.contact(PAIR).friction, shares(run_), run_.time
        braked = (t > plan.free) & (friction.creepage[:, 0] < 1.5 * FRICTION * HERTZ.half_width / RELATIVE_RADIUS)
        forces[name] = (t, share)
        curves[name] = (friction.creepage[braked, 0], share[braked])
        powers[name] = (t, friction.power)
        profile = friction.profile(_second_wait(run_), FRICTION)
        tractions[name] = (profile["arc"] * 1e3, -profile["traction"] / 1e6)
    points = {
        f"settled, {name}": (
            np.array([c for _, c, _ in on_carters_curve(run_)]),
            np.array([s for s, _, _ in on_carters_curve(run_)]),
        )
        for name, run_ in both.items()
    }
    q = np.linspace(0.0, 1.0, 101)
    curve = np.array([CarterRolling.from_share(HERTZ, FRICTION, x).creepage for x in q])
    pair, t, i = result.contact(PAIR), result.time, _second_wait(result)
    speeds = {name: (t, OUTER_RADIUS * np.abs(result.body(name).angular_velocity[:, 1])) for name in ("lower", "upper")}
    line = LineContact(float(pair.line_load[i]), RELATIVE_RADIUS, HERTZ.modulus)
    share = float(shares(result)[i])
    x = np.linspace(-2.0, 2.0, 401) * line.half_width
    exact = CarterRolling.from_share(line, FRICTION, share).traction(-x)
    return [
        Panel("Surface speeds", "time [s]", "[m/s]", speeds),
        Panel("Tangential force over mu P", "time [s]", "[-]", forces,
              {"brake": (t, brake()(t) / (FRICTION * LOAD * OUTER_RADIUS))}),
        Panel("Tangential force against creepage", "creepage [-]", "Q/(mu P) [-]", curves, {"Carter": (curve, q)},
              points=points),
        Panel(f"Tractions at Q/(mu P) = {share:.2f}, material enters on the left", "arc [mm]", "[MPa]", tractions,
              {"Carter": (x * 1e3, exact / 1e6), "mu p, Hertz": (x * 1e3, FRICTION * line.pressure(x) / 1e6)}),
        Panel("Friction power", "time [s]", "[W]", powers),
        StickSlipMap("4 mm: stick and slip then, tractions on the lower roller", on_patch, _second_wait(on_patch)),
    ]  # fmt: skip


def _second_wait(result: wf.Result) -> int:
    """The last saved step before the end of the second wait."""
    return int(np.flatnonzero(result.time <= schedule().waits[1])[-1])


def main(out: str | Path = "out/rolling_friction", *, quick: bool = False, progress: bool = True) -> int:
    """Run the demo and write rolling_friction.h5, .rrd, .png and summary.json into the folder `out`; 0 when all went
    well.

    quick: fewer cells around and fewer frames. Raises `InputError` for a folder that cannot be written.
    """
    folder = writable_folder(out)
    size = QUICK if quick else FULL
    results, seconds = {}, {}
    for name, cells in (("fine", size), ("coarse", size.coarse), ("patch", BIG_CELLS)):
        plan = schedule()
        log.info("rolling friction: %s, %g s in steps of %.3g s", name, plan.end, cells.step)
        begin = time.perf_counter()
        scene = build(cells, progress=progress)
        built = time.perf_counter()
        results[name] = run(scene, cells, progress=progress)
        seconds[name] = (built - begin, time.perf_counter() - built)
        if results[name].status != "completed":
            log.error("the run '%s' ended early, %s: %s", name, results[name].status, results[name].message)
            return 1
    found = checks(results["fine"], results["coarse"], size)
    found += checks_on_patch(results["patch"], results["fine"], results["coarse"])
    pictures = panels(results["fine"], results["patch"])
    code = finish(folder / "rolling_friction", results, found, pictures, frames=size.frames)
    print(side_by_side(results, seconds))
    return code
