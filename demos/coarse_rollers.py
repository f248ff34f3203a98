"""The two rollers of `two_rollers`, meshed as users mesh: 4 mm tetrahedra from a mesh generator.

Half of the contact is 0.6 mm wide: one seventh of an element. The mesh comes with the package (`data/roller_4mm.msh`,
Gmsh, second order); machine, loads and run are those of `two_rollers`, whose rollers have a mesh made for the contact,
with 4.6 elements a half-width. That run is made as well.

What to expect: the contact carries what statics asks for, on any mesh. Across the patch at mid-width the pressure is
Hertz's at the line load found there, as on the fine mesh: it stands on cells that travel with the patch, whose
compliance is the half-space's near by and the mesh's only from afar (docs/method.md). The largest von Mises stress
below it is Hertz's as well, in plane strain; the free ends let the stress along the axis go by a few percent of the
peak pressure. In the last 10 ms the rollers turn by a radian, over a dozen elements: the ripple of the peak pressure is
what the mesh does to the contact.
"""

from __future__ import annotations

import logging
import time
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

import warpffrf as wf
from demos import two_rollers as fine
from demos.checks import Check, finish, writable_folder
from references.closed_forms import LineContact

log = logging.getLogger("warpffrf")

STEEL = wf.Material(youngs_modulus=210e9, poisson_ratio=0.3, density=7850, name="steel")
MESH = Path(__file__).with_name("data") / "roller_4mm.msh"
DEPTHS = np.linspace(0.1, 1.0, 19) * 1e-3  # m below the rim, under the patch as the run begins
BALANCE = 1e-6  # of the force
HALF_WIDTH, PEAK = 0.01, 0.01  # of Hertz's, on nine strips
BETWEEN = 0.01  # of the fine run's peak pressure, which is itself 0.3 % off Hertz
MISES, MISES_DEPTH = 0.02, 0.02  # the mesh's own 1 %, and what the free ends let go of the axial stress
RIPPLE = 5e-4  # of the peak pressure
PAIR = fine.PAIR


@dataclass(frozen=True)
class Size:
    """The mesh of the other run, and how many frames the recording shows at most."""

    beside: fine.Size
    frames: int


FULL, QUICK = Size(fine.FULL, 300), Size(fine.QUICK, 60)


def build(*, progress: bool = True) -> wf.Scene:
    """The scene of `two_rollers.build`, its rollers read from the mesh file and reduced."""
    below = np.column_stack([0 * DEPTHS, 0 * DEPTHS, fine.OUTER_RADIUS - DEPTHS])
    roller = wf.reduce(
        wf.mesh.read(MESH, length_unit="mm"), STEEL, interfaces={"bore": "rigid"},
        contact={"rim": wf.surfaces.Cylinder()}, stress={"below": below}, contact_fixed=True,
        max_frequency=fine.MAX_FREQUENCY, cache=False, progress=progress,
    )  # fmt: skip
    return fine.machine(roller, load_step_at=fine.LOAD_STEP_AT)


def ripple(result: wf.Result) -> float:
    """How far the peak pressure at mid-width goes up and down over the last part of the run, of its mean [-]."""
    peak = result.contact(PAIR).mid_peak_pressure[result.time >= result.time[-1] - fine.SETTLED]
    return float(np.ptp(peak) / peak.mean())


def largest_mises(z: np.ndarray, values: np.ndarray) -> tuple[float, float]:
    """Largest value and its depth, of von Mises stresses `values` at depths `z`, by a curve through those around it."""
    near = np.abs(z - z[np.argmax(values)]) < 0.5 * z[np.argmax(values)]
    curve, at = np.polynomial.Polynomial.fit(z[near], values[near], 4), np.linspace(z[near][0], z[near][-1], 2001)
    return float(curve(at).max()), float(at[np.argmax(curve(at))])


def line_contact(result: wf.Result, i: int) -> LineContact:
    """Hertz's contact at the line load found in saved step `i`."""
    pair = result.contact(PAIR)
    return LineContact(float(pair.line_load[i]), pair.effective_radius, pair.effective_modulus)


def checks(scene: wf.Scene, coarse: wf.Result, beside: wf.Result) -> list[Check]:
    """Of the coarse run, beside statics, Hertz and the fine one."""
    rows = np.flatnonzero(coarse.time >= coarse.time[-1] - fine.SETTLED)
    pair, other = coarse.contact(PAIR), beside.contact(PAIR)
    hertz = [pair.hertz(int(i)) for i in rows]
    width, peak = (float(np.mean([getattr(h, what) for h in hertz])) for what in ("half_width", "peak_pressure"))
    last = beside.time >= beside.time[-1] - fine.SETTLED
    found = largest_mises(DEPTHS, coarse.stress("lower", "below").von_mises[0])
    exact = largest_mises(DEPTHS, line_contact(coarse, 0).von_mises(DEPTHS, STEEL.poisson_ratio))
    return [
        Check("contact force", float(pair.force_magnitude[rows].mean()),
              fine.static_force(scene, coarse, fine.LOAD_AFTER), "statics", BALANCE, "kN", 1e-3),
        Check("half-width", float(pair.half_width[rows].mean()), width, "Hertz", HALF_WIDTH, "um", 1e6),
        Check("peak pressure", float(pair.mid_peak_pressure[rows].mean()), peak, "Hertz", PEAK, "MPa", 1e-6),
        Check("peak pressure", float(pair.mid_peak_pressure[rows].mean()), float(other.mid_peak_pressure[last].mean()),
              "two_rollers", BETWEEN, "MPa", 1e-6),
        Check("line load at mid-width", float(pair.line_load[rows].mean()), float(other.line_load[last].mean()),
              "two_rollers", BETWEEN, "kN/m", 1e-3),
        Check("largest von Mises stress, at 20 kN", found[0], exact[0], "Hertz, plane strain", MISES, "MPa", 1e-6),
        Check("its depth", found[1], exact[1], "Hertz, plane strain", MISES_DEPTH, "um", 1e6),
        Check("ripple of the peak pressure", ripple(coarse), 0.0,
              f"the true rim is round; two_rollers {ripple(beside):.0e}", RIPPLE, scale=1.0),
    ]  # fmt: skip


def panels(coarse: wf.Result, beside: wf.Result) -> list:
    """Pressure across the patch and along it at the end, stress below it at the start, peak pressure over time."""
    from warpffrf.output.plots.panels import Panel

    across, along, over_time = {}, {}, {}
    for name, result in (("4 mm tetrahedra, cells", coarse), ("fine mesh, hats", beside)):
        pair = result.contact(PAIR)
        z = np.atleast_2d(pair.rows)[-1]
        across[name] = (pair.arc[-1] * 1e3, pair.mid_pressure[-1] / 1e6)
        load = pair.history.pressure[-1].sum(axis=0) * np.atleast_1d(pair.spacing)[-1]
        along[name] = (z * 1e3, load / 1e6)
        over_time[name] = (result.time * 1e3, pair.mid_peak_pressure / 1e6)
    last = coarse.contact(PAIR).hertz(-1)
    x = np.linspace(-1.0, 1.0, 201) * last.half_width
    stress = coarse.stress("lower", "below").von_mises[0]
    exact = line_contact(coarse, 0).von_mises(DEPTHS, STEEL.poisson_ratio)
    pressure = last.peak_pressure * np.sqrt(np.maximum(1.0 - (x / last.half_width) ** 2, 0.0))
    return [
        Panel("Across the patch, at mid-width", "arc [mm]", "pressure [MPa]", across,
              {"Hertz": (x * 1e3, pressure / 1e6)}),
        Panel("Along the rollers", "z [mm]", "line load [kN/mm]", along),
        Panel("Below the patch, at 20 kN", "depth [mm]", "von Mises stress [MPa]",
              {"4 mm tetrahedra": (DEPTHS * 1e3, stress / 1e6)}, {"Hertz, plane strain": (DEPTHS * 1e3, exact / 1e6)}),
        Panel("Peak pressure at mid-width", "time [ms]", "[MPa]", over_time),
    ]  # fmt: skip


def cost(scenes: dict[str, wf.Scene], results: dict[str, wf.Result], seconds: dict[str, float]) -> str:
    """What both runs cost, as text; seconds: wall time of meshing and reducing, by name."""
    lines = [f"{'':<34}{'FE dofs a body':>15}{'unknowns':>10}{'reduction [s]':>15}{'step [us]':>11}"]
    for name, scene in scenes.items():
        pair, counters = results[name].contact(PAIR), results[name].history.counters
        step = counters["seconds_in_graph"] / max(int(counters["steps"]), 1)
        unknowns = float(np.mean(pair.history.active_hats))
        roller: Any = scene.body("lower").reduced
        dofs = int(roller.report["dofs"])
        lines.append(f"{name:<34}{dofs:>15d}{unknowns:>10.0f}{seconds[name]:>15.1f}{step * 1e6:>11.0f}")
    return "\n".join(lines)


def main(out: str | Path = "out/coarse_rollers", *, quick: bool = False, progress: bool = True) -> int:
    """Run the demo, write coarse_rollers.h5, .rrd, .png and summary.json into `out`; 0 when all checks passed.

    quick: fewer cells along the axis of the fine run and fewer frames. Raises `InputError` for a folder that cannot be
    written.
    """
    folder = writable_folder(out)
    size = QUICK if quick else FULL
    scenes, results, seconds = {}, {}, {}
    for n, name in enumerate(("coarse", "fine"), start=1):
        log.info("%d/3 the %s rollers: reduction, equilibrium and %g ms of rolling", n, name, fine.DURATION * 1e3)
        begin = time.perf_counter()
        scenes[name] = build(progress=progress) if name == "coarse" else fine.build(size.beside, progress=progress)
        seconds[name] = time.perf_counter() - begin
        results[name] = wf.simulate(scenes[name], fine.DURATION, step=fine.STEP, start="equilibrium", progress=progress)
        if not len(results[name].time):
            log.error("%s: %s", results[name].status, results[name].message)
            return 1
    log.info("3/3 writing results, recording and picture")
    coarse, beside = results["coarse"], results["fine"]
    code = finish(
        folder / "coarse_rollers", results, checks(scenes["coarse"], coarse, beside), panels(coarse, beside),
        frames=size.frames,
    )  # fmt: skip
    print(cost(scenes, results, seconds))
    return code
