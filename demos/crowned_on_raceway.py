r"""A crowned roller on a raceway, in cells five to ten times as wide as its contact: the effect of a crown.

A solid steel roller (R 7.5 mm, 15 mm long, crown of 1 m) is pressed on the inner ring of a bearing (R 30 mm, bore
20 mm) that is wider than the roller, as in every roller bearing. Its journals are held in a guide; the load rises from
300 N to 6 kN, then the ring rotates. Both bodies are meshed in quadratic cells of 2 mm (4 mm with `--quick`); the
contact is 0.17 to 0.46 mm wide.

What to expect. At 300 N the crown carries on Hertz's ellipse in the middle of the roller, with the relative radii
1/(1/R1 + 1/R2) across and the crown's along. At 6 kN the crown is pressed flat nearly to the ends, the contact is a
line, and its pressure across is Hertz's of a cylinder at the line load found there. At the ends the crown carries
almost no load. The same machine with a straight roller shows the effect of the crown: its ends are edges that press
into a wider ring, where the pressure of a corner is infinite (docs/studies/roller_end.md), and by a third larger than
in the middle in a row of cells at the end. While the ring rotates, neither force nor pressure follows the mesh.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

import warpffrf as wf
from warpffrf.output.plots.panels import Panel, save_panels

STEEL = wf.Material(youngs_modulus=210e9, poisson_ratio=0.3, density=7850, name="steel")
RADIUS, LENGTH, CROWN = 0.0075, 0.015, 1.0  # m, of the roller
RING_RADIUS, BORE_RADIUS, WIDTH = 0.03, 0.02, 0.02  # m
LIGHT, HEAVY = 300.0, 6e3  # N
CARRIAGE_MASS, CARRIAGE_INERTIA = 1.0, (1e-3, 1e-3, 1e-3)  # kg, kg m2
LOADING, WAITING, SPIN_UP, TURNING = 0.02, 0.005, 0.005, 0.02  # s
SPEED = 30.0  # rad/s of the ring: 9 cells in the last 20 ms
RHO_INF = 0.5
PAIR, GUIDE = "roller-raceway", "guide"


@dataclass(frozen=True)
class Size:
    """Size of the cells [m], layers below the rims of roller and ring, time step [s]."""

    cell: float
    layers: tuple[int, int]
    step: float


FULL, QUICK = Size(2e-3, (3, 4), 1e-4), Size(4e-3, (2, 2), 5e-4)


def build(crown: float | None = CROWN, *, size: Size = FULL, progress: bool = True) -> wf.Scene:
    """The scene, the roller with or without a crown [m]: bodies `roller`, `ring`, `carriage`, contact
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
        ring, STEEL, interfaces={"bore": "rigid"}, contact={"rim": wf.surfaces.Cylinder()}, modes=0,
        grid=wf.ContactGrid(contact_fixed=True), progress=progress,
    )  # fmt: skip
    of_roller = wf.reduce(
        rolling, STEEL, interfaces={"journal_low": "average", "journal_high": "average"}, contact={"rim": rim},
        modes=0, grid=wf.ContactGrid(contact_fixed=True), progress=progress,
    )  # fmt: skip
    scene = wf.Scene()
    lower = scene.add_body(of_ring, name="ring")
    upper = scene.add_body(of_roller, name="roller", position=(0, 0, RING_RADIUS + RADIUS))
    scene.add(wf.Contact(upper["rim"], lower["rim"], name=PAIR))
    carriage = scene.add_rigid_body(
        CARRIAGE_MASS, CARRIAGE_INERTIA, name="carriage", position=(0.0, 0.0, upper.position[2])
    )
    axle = scene.add(wf.joints.Revolute(scene.ground, lower["bore"], axis=(0, 1, 0), name="axle"))
    spin = wf.signals.SmoothStep(0.0, SPEED, duration=SPIN_UP, delay=LOADING + WAITING)
    scene.add(wf.joints.Drive(axle, spin, quantity="velocity"))
    scene.add(wf.joints.Prismatic(scene.ground, carriage, axis=(0, 0, 1), name=GUIDE))
    for name, side in (("journal_low", -0.5), ("journal_high", 0.5)):
        bush = carriage.at((0.0, side * LENGTH, 0.0))
        scene.add(wf.joints.Spherical(bush, upper[name], name=name))
    press = wf.signals.SmoothStep(LIGHT, HEAVY, duration=LOADING)
    scene.add(wf.forces.PointForce(carriage, (press, (0, 0, -1)), name="press"))
    return scene


def run(scene: wf.Scene, *, size: Size = FULL, progress: bool = True) -> wf.Result:
    """From the static state at the light load: loading, waiting, and rotating."""
    end, integrator = LOADING + WAITING + SPIN_UP + TURNING, wf.integrators.GeneralizedAlpha(RHO_INF)
    return wf.simulate(
        scene, end, step=size.step, start="equilibrium", options=wf.RunOptions(integrator=integrator), progress=progress
    )


def heavy_row(result: wf.Result) -> int:
    """The last saved step under the full load before the ring rotates."""
    return int(np.flatnonzero(result.time <= LOADING + WAITING + 1e-6)[-1])


def at_ends(result: wf.Result, i: int) -> float:
    """Pressure in the rows of cells at the ends over that in the middle, the larger one [-]."""
    along = result.contact(PAIR).mean_pressure[i].max(axis=0)
    return float(max(along[0], along[-1]) / along[len(along) // 2])


def main(out: str | Path = "out/crowned_on_raceway", *, quick: bool = False, progress: bool = True) -> list[wf.Result]:
    """Write crowned_on_raceway.h5, .rrd and .png, and crowned_on_raceway.straight.h5, into the folder `out` and print
    the figures; quick: cells twice as wide, longer steps."""
    stem, size = Path(out) / "crowned_on_raceway", QUICK if quick else FULL
    crowned, straight = (run(build(crown, size=size, progress=progress), size=size, progress=progress)
                         for crown in (CROWN, None))  # fmt: skip
    crowned.save(f"{stem}.h5", overwrite=True)
    straight.save(f"{stem}.straight.h5", overwrite=True)
    wf.record(crowned, f"{stem}.rrd", max_frames=30 if quick else 200, overwrite=True)

    contact, i = crowned.contact(PAIR), heavy_row(crowned)
    along = {
        name: (r.contact(PAIR).rows[i] * 1e3, r.contact(PAIR).mean_pressure[i].max(axis=0) / 1e6)
        for name, r in (("crown of 1 m", crowned), ("straight", straight))
    }
    light = {"crown of 1 m": (contact.rows[0] * 1e3, contact.mean_pressure[0].max(axis=0) / 1e6)}
    save_panels([
        Panel("Along the roller, 6 kN", "z [mm]", "largest pressure [MPa]", along),
        Panel("Along the roller, 300 N", "z [mm]", "largest pressure [MPa]", light),
        Panel("Peak pressure at mid-width", "time [ms]", "[MPa]",
              {"crown of 1 m": (crowned.time * 1e3, contact.mid_peak_pressure / 1e6)}),
    ], f"{stem}.png", overwrite=True)  # fmt: skip

    ellipse = contact.hertz(0).peak_pressure
    line = np.sqrt(contact.line_load[i] * contact.effective_modulus / (np.pi * contact.effective_radius))
    print(f"300 N: peak pressure {contact.peak_pressure[0] / 1e6:9.5g} MPa  Hertz's ellipse {ellipse / 1e6:.5g}")
    print(f"6 kN: at mid-width   {contact.mid_peak_pressure[i] / 1e6:9.5g} MPa  Hertz's line {line / 1e6:.5g}")
    print(f"6 kN: ends over middle {at_ends(crowned, i):.3g} with the crown, {at_ends(straight, i):.3g} without")
    return [crowned, straight]


if __name__ == "__main__":
    main()
