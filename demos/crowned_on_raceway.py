r"""A crowned roller on a raceway, in cells five to ten times as wide as its contact: what a crown is for.

A solid steel roller (R 7.5 mm, 15 mm long, crown of 1 m) is pressed on the inner ring of a bearing (R 30 mm, bore
20 mm) that is wider than the roller, as in every roller bearing. Its journals hang in a guide; the load rises from
300 N to 6 kN, then the ring turns. Both bodies are meshed in quadratic cells of 2 mm (4 mm with `--quick`), the contact
is 0.17 to 0.46 mm wide.

What to expect. At 300 N the crown carries on an ellipse in the middle of the roller: Hertz's, with the relative radii
1/(1/R1 + 1/R2) across and the crown's along. At 6 kN the crown is pressed flat nearly to the ends, the contact is a
line, and its pressure across is Hertz's of a cylinder at the line load found there. At the ends the crown
carries next to nothing. The same machine with a straight roller shows what that is for: its ends are edges that press
into a ring which goes on beside them, where the pressure of a corner is infinite (docs/studies/roller_end.md), and in a
row of cells at the end a third larger than in the middle. While the ring turns, neither force nor pressure knows the
mesh.
"""

from __future__ import annotations

import logging
from dataclasses import dataclass
from pathlib import Path

import numpy as np

import warpffrf as wf
from demos.checks import Check, finish, writable_folder
from references.closed_forms import LineContact, contact_modulus
from references.closed_forms.elliptic import EllipticContact

log = logging.getLogger("warpffrf")

STEEL = wf.Material(youngs_modulus=210e9, poisson_ratio=0.3, density=7850, name="steel")
RADIUS, LENGTH, CROWN = 0.0075, 0.015, 1.0  # m, of the roller
RING_RADIUS, BORE_RADIUS, WIDTH = 0.03, 0.02, 0.02  # m
LIGHT, HEAVY = 300.0, 6e3  # N
MODULUS = contact_modulus(STEEL, STEEL)
ACROSS = 1.0 / (1.0 / RADIUS + 1.0 / RING_RADIUS)  # m, relative radius
CARRIAGE_MASS, CARRIAGE_INERTIA = 1.0, (1e-3, 1e-3, 1e-3)  # kg, kg m2
LOADING, WAITING, SPIN_UP, TURNING = 0.02, 0.005, 0.005, 0.02  # s
SPEED = 30.0  # rad/s of the ring: 9 cells in the last 20 ms
RHO_INF = 0.5
PAIR, GUIDE = "roller-raceway", "guide"
BALANCE = 1e-6  # of the load
AXES, PEAK = 0.01, 0.01  # of half-axes and peak pressure: nine strips and a dozen rows in the ellipse
EDGE = 0.05  # of the peak: what the ends of the crowned roller may carry
SHARP = 1.3  # times the pressure in the middle, which a straight roller has in the row at its end, and more
RIPPLE = 1e-3  # of force and peak pressure over the cells that pass


@dataclass(frozen=True)
class Size:
    """Cells of the meshes, the step, and how many frames the recording shows at most."""

    cell: float  # m, around and along
    layers: tuple[int, int]  # below the rims of roller and ring
    step: float  # s
    frames: int


FULL, QUICK = Size(2e-3, (3, 4), 1e-4, 200), Size(4e-3, (2, 2), 5e-4, 30)


def build(crown: float | None = CROWN, *, size: Size = FULL, progress: bool = True) -> wf.Scene:
    """The scene, the roller with or without a crown [m]: bodies `roller`, `ring`, `carriage`, pair
    `roller-raceway`."""
    cell, (of_solid, of_wall) = size.cell, size.layers

    def sectors(radius: float) -> int:
        return round(0.5 * np.pi * radius / cell) * 4

    ring = wf.mesh.roller(
        RING_RADIUS, BORE_RADIUS, WIDTH, sectors=sectors(RING_RADIUS), layers=of_wall, axial=round(WIDTH / cell),
        order=2,
    )  # fmt: skip
    rolling = wf.mesh.roller(
        RADIUS, 0.0, LENGTH, sectors=sectors(RADIUS), layers=of_solid, axial=round(LENGTH / cell), crown_radius=crown,
        order=2,
    )  # fmt: skip
    rim = wf.surfaces.Cylinder() if crown is None else wf.surfaces.CrownedCylinder(crown_radius=crown)
    of_ring = wf.reduce(
        ring, STEEL, interfaces={"bore": "rigid"}, contact={"rim": wf.surfaces.Cylinder()}, modes=0, contact_fixed=True,
        progress=progress,
    )  # fmt: skip
    of_roller = wf.reduce(
        rolling, STEEL, interfaces={"journal_low": "average", "journal_high": "average"}, contact={"rim": rim},
        modes=0, contact_fixed=True, progress=progress,
    )  # fmt: skip
    scene = wf.Scene()
    lower = scene.add_body(of_ring, name="ring")
    upper = scene.add_body(of_roller, name="roller", position=(0, 0, RING_RADIUS + RADIUS))
    scene.add(wf.Contact(upper["rim"], lower["rim"], name=PAIR))
    centre = (0.0, 0.0, upper.position[2])
    carriage = scene.add_rigid_body(CARRIAGE_MASS, CARRIAGE_INERTIA, name="carriage", position=centre)
    axle = scene.add(wf.joints.Revolute(scene.ground, lower["bore"], axis=(0, 1, 0), name="axle"))
    scene.add(wf.joints.Drive(axle, wf.signals.SmoothStep(0.0, SPEED, duration=SPIN_UP, delay=LOADING + WAITING),
                              quantity="velocity"))  # fmt: skip
    scene.add(wf.joints.Prismatic(scene.ground, carriage.at((0, 0, 0)), axis=(0, 0, 1), name=GUIDE))
    for name, side in (("journal_low", -0.5), ("journal_high", 0.5)):
        bush = carriage.at((0.0, side * LENGTH, 0.0))
        scene.add(wf.joints.Spherical(bush, upper[name], name=name))
    press = wf.signals.SmoothStep(LIGHT, HEAVY, duration=LOADING)
    scene.add(wf.forces.PointForce(carriage.at((0, 0, 0)), (press, (0, 0, -1)), name="press"))
    return scene


def run(scene: wf.Scene, *, size: Size = FULL, progress: bool = True) -> wf.Result:
    """From the static state at the light load: loading, waiting, and turning."""
    end, integrator = LOADING + WAITING + SPIN_UP + TURNING, wf.GeneralizedAlpha(RHO_INF)
    return wf.simulate(scene, end, step=size.step, start="equilibrium", integrator=integrator, progress=progress)


def heavy_row(result: wf.Result) -> int:
    """The last saved step under the full load before the ring turns."""
    return int(np.flatnonzero(result.time <= LOADING + WAITING + 1e-6)[-1])


def at_ends(result: wf.Result, i: int) -> float:
    """Pressure in the rows at both ends over that in the middle, the larger one [-]."""
    along = result.contact(PAIR).mean_pressure[i].max(axis=0)
    return float(max(along[0], along[-1]) / along[len(along) // 2])


def checks(crowned: wf.Result, straight: wf.Result) -> list[Check]:
    """The ellipse at the light load, the line at the heavy one, the ends, and what the mesh does to a turning ring."""
    pair, i = crowned.contact(PAIR), heavy_row(crowned)
    ellipse = EllipticContact(LIGHT, ACROSS, CROWN, MODULUS)
    line = LineContact(float(pair.line_load[i]), ACROSS, MODULUS)
    turning = crowned.time >= LOADING + WAITING + SPIN_UP
    force, peak = pair.force_magnitude[turning], pair.mid_peak_pressure[turning]
    a, b = ellipse.half_axes
    return [
        Check("light: force", float(pair.force_magnitude[0]), LIGHT, "statics", BALANCE, "N"),
        Check("light: half-axis across", float(pair.half_widths[0, 0]), a, "Hertz", AXES, "um", 1e6),
        Check("light: half-axis along", float(pair.half_widths[0, 1]), b, "Hertz", AXES, "mm", 1e3),
        Check("light: peak pressure", float(pair.peak_pressure[0]), ellipse.peak_pressure, "Hertz", PEAK, "MPa", 1e-6),
        Check("heavy: force", float(pair.force_magnitude[i]), HEAVY, "statics", BALANCE, "N"),
        Check("heavy: half-width at mid-width", float(pair.half_width[i]), line.half_width, "Hertz at the line load",
              AXES, "um", 1e6),
        Check("heavy: peak pressure at mid-width", float(pair.mid_peak_pressure[i]), line.peak_pressure,
              "Hertz at the line load", PEAK, "MPa", 1e-6),
        Check("pressure at the ends over the middle", at_ends(crowned, i), 0.0, "crowned", EDGE, scale=1.0),
        Check("of a straight roller, cut at", min(at_ends(straight, heavy_row(straight)), SHARP), SHARP,
              "edges", 0.0),
        Check("ripple of the force while it turns", float(np.ptp(force) / force.mean()), 0.0, "round rims", RIPPLE,
              scale=1.0),
        Check("ripple of the peak pressure", float(np.ptp(peak) / peak.mean()), 0.0, "round rims", RIPPLE, scale=1.0),
    ]  # fmt: skip


def panels(crowned: wf.Result, straight: wf.Result) -> list:
    """Pressure along the roller at both loads, across it, and over time."""
    from warpffrf.output.plots.panels import Panel

    along: dict = {}
    for name, result in (("crown of 1 m", crowned), ("straight", straight)):
        pair, i = result.contact(PAIR), heavy_row(result)
        along[name] = (np.atleast_2d(pair.rows)[i] * 1e3, pair.mean_pressure[i].max(axis=0) / 1e6)
    pair, i = crowned.contact(PAIR), heavy_row(crowned)
    ellipse = EllipticContact(LIGHT, ACROSS, CROWN, MODULUS)
    line = LineContact(float(pair.line_load[i]), ACROSS, MODULUS)
    z = np.linspace(-3e-3, 3e-3, 301)
    rows = np.atleast_2d(pair.rows)[0]
    shown = np.abs(rows) < 3e-3
    x = np.linspace(-1.3, 1.3, 261) * line.half_width
    return [
        Panel("Along the roller, 6 kN", "z [mm]", "largest pressure [MPa]", along),
        Panel("Along the roller, 300 N", "z [mm]", "largest pressure [MPa]",
              {"crown of 1 m": (rows[shown] * 1e3, pair.mean_pressure[0].max(axis=0)[shown] / 1e6)},
              {"Hertz": (z * 1e3, ellipse.pressure(0.0 * z, z) / 1e6)}),
        Panel("Across, at mid-width, 6 kN", "arc [um]", "pressure [MPa]",
              {"cells": (pair.arc[i] * 1e6, pair.mid_pressure[i] / 1e6)},
              {"Hertz at the line load": (x * 1e6, line.pressure(x) / 1e6)}),
        Panel("Peak pressure at mid-width", "time [ms]", "[MPa]",
              {"run": (crowned.time * 1e3, pair.mid_peak_pressure / 1e6)}),
    ]  # fmt: skip


def main(out: str | Path = "out/crowned_on_raceway", *, quick: bool = False, progress: bool = True) -> int:
    """Run the demo, write crowned_on_raceway.h5, .rrd, .png and summary.json into `out`; 0 when all checks passed.

    quick: cells twice as wide, longer steps, fewer frames. Raises `InputError` for a folder that cannot be written.
    """
    folder = writable_folder(out)
    size = QUICK if quick else FULL
    results = {}
    for name, crown in (("crowned", CROWN), ("straight", None)):
        log.info("a %s roller on a raceway: %g to %g N", name, LIGHT, HEAVY)
        results[name] = run(build(crown, size=size, progress=progress), size=size, progress=progress)
        if results[name].status != "completed":
            log.error("the run ended early, %s: %s", results[name].status, results[name].message)
            return 1
    sharp = at_ends(results["straight"], heavy_row(results["straight"]))
    log.info("rows at the ends of the straight roller carry %.2f times the pressure in the middle", sharp)
    found = checks(results["crowned"], results["straight"])
    stem = folder / "crowned_on_raceway"
    return finish(stem, results, found, panels(results["crowned"], results["straight"]), frames=size.frames)
