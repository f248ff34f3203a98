"""The two rollers of `two_rollers` in a coarse mesh: 4 mm tetrahedra from a mesh generator.

Half of the contact is 0.6 mm wide: one seventh of an element. The mesh is included in the package
(`data/roller_4mm.msh`, Gmsh, second order). The lower roller rotates on a fixed axle, the upper one in a carriage on a
sprung vertical guide; both are driven to 100 rad/s, and while they roll the force on the carriage rises from 20 to 26
kN.

What to expect: the contact carries the static load on any mesh. Across the patch at mid-width the pressure is Hertz's
at the line load found there: it is discretised on cells that move with the patch, whose compliance is that of the
half-space nearby and of the mesh at a distance (docs/method.md). The largest von Mises stress below it, in plane strain
0.558 p0 at a depth of 0.70 a, is Hertz's as well. In the last 10 ms the rollers rotate by a radian, over a dozen
elements: the ripple of the peak pressure is the effect of the mesh on the contact.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

import warpffrf as wf
from warpffrf.output.plots.panels import Panel, save_panels

STEEL = wf.Material(youngs_modulus=210e9, poisson_ratio=0.3, density=7850, name="steel")
MESH = Path(__file__).with_name("data") / "roller_4mm.msh"
OUTER_RADIUS = 0.05  # m
MAX_FREQUENCY = 20e3  # Hz, of the vibration modes
DEPTHS = np.linspace(0.1, 1.0, 19) * 1e-3  # m below the rim, under the patch at the start
GRAVITY, CARRIAGE_MASS, CARRIAGE_INERTIA = 9.81, 5.0, (0.01, 0.01, 0.01)  # m/s2, kg, kg m2
GUIDE_STIFFNESS, GUIDE_DAMPING = 1e6, 2e3  # N/m, N s/m
LOAD, LOAD_AFTER, LOAD_STEP_AT, LOAD_STEP_TAKES = 20e3, 26e3, 0.055, 0.010  # N, N, s, s
SPEED, SPIN_UP = 100.0, 0.02  # rad/s reached within s
DURATION, STEP, SETTLED = 0.1, 1e-4, 0.01  # s; the figures are averaged over the last of these
PAIR, GUIDE = "lower-upper", "guide"


def build(*, progress: bool = True) -> wf.Scene:
    """The scene: bodies `lower`, `upper`, `carriage`; joints `axle`, `guide`, `upper_axle`; contact `lower-upper`."""
    below = np.column_stack([0 * DEPTHS, 0 * DEPTHS, OUTER_RADIUS - DEPTHS])
    roller = wf.reduce(
        wf.mesh.read(MESH, length_unit="mm"), STEEL, interfaces={"bore": "rigid"},
        contact={"rim": wf.surfaces.Cylinder()}, stress={"below": below}, grid=wf.ContactGrid(contact_fixed=True),
        max_frequency=MAX_FREQUENCY, cache=False, progress=progress,
    )  # fmt: skip
    scene = wf.Scene(gravity=(0, 0, -GRAVITY))
    lower = scene.add_body(roller, name="lower")
    upper = scene.add_body(roller, name="upper", position=(0, 0, 2 * OUTER_RADIUS))
    contact = scene.add(wf.Contact(lower["rim"], upper["rim"], name=PAIR))
    scene.close_gap(contact)
    carriage = scene.add_rigid_body(
        CARRIAGE_MASS, CARRIAGE_INERTIA, name="carriage", position=upper["bore"].world_point()
    )
    axle = scene.add(wf.joints.Revolute(scene.ground, lower["bore"], axis=(0, 1, 0), name="axle"))
    guide = scene.add(wf.joints.Prismatic(scene.ground, carriage, axis=(0, 0, 1), name=GUIDE))
    upper_axle = scene.add(wf.joints.Revolute(carriage, upper["bore"], axis=(0, 1, 0), name="upper_axle"))
    scene.add(wf.forces.JointSpringDamper(guide, GUIDE_STIFFNESS, GUIDE_DAMPING))
    for joint, end in ((axle, SPEED), (upper_axle, -SPEED)):
        scene.add(wf.joints.Drive(joint, wf.signals.SmoothStep(0.0, end, duration=SPIN_UP), quantity="velocity"))
    press = wf.signals.SmoothStep(LOAD, LOAD_AFTER, duration=LOAD_STEP_TAKES, delay=LOAD_STEP_AT)
    scene.add(wf.forces.PointForce(carriage, (press, (0, 0, -1))))
    return scene


def main(out: str | Path = "out/coarse_rollers", *, quick: bool = False, progress: bool = True) -> list[wf.Result]:
    """Write coarse_rollers.h5, .rrd and .png into the folder `out` and print the figures; quick: fewer frames."""
    stem, scene = Path(out) / "coarse_rollers", build(progress=progress)
    result = wf.simulate(scene, DURATION, step=STEP, start="equilibrium", progress=progress)
    result.save(f"{stem}.h5", overwrite=True)
    wf.record(result, f"{stem}.rrd", max_frames=60 if quick else 300, overwrite=True)

    contact, mises = result.contact(PAIR), result.stress("lower", "below").von_mises[0]
    start, end = contact.hertz(0), contact.hertz(-1)
    x = np.linspace(-1.0, 1.0, 201)
    pressure = end.peak_pressure * np.sqrt(1.0 - x**2)
    deepest = np.array([0.70 * start.half_width]) * 1e3, np.array([0.558 * start.peak_pressure]) / 1e6
    save_panels([
        Panel("Across the patch, at mid-width", "arc [mm]", "pressure [MPa]",
              {"run": (contact.arc[-1] * 1e3, contact.mid_pressure[-1] / 1e6)},
              {"Hertz": (x * end.half_width * 1e3, pressure / 1e6)}),
        Panel("Below the patch, at 20 kN", "depth [mm]", "von Mises stress [MPa]",
              {"run": (DEPTHS * 1e3, mises / 1e6)}, points={"Hertz, largest": deepest}),
        Panel("Peak pressure at mid-width", "time [ms]", "[MPa]",
              {"run": (result.time * 1e3, contact.mid_peak_pressure / 1e6)}),
    ], f"{stem}.png", overwrite=True)  # fmt: skip

    rows = np.flatnonzero(result.time >= result.time[-1] - SETTLED)
    lift = GUIDE_STIFFNESS * result.joint(GUIDE).coordinate[rows].mean()
    static = LOAD_AFTER + (scene.body("upper").mass + CARRIAGE_MASS) * GRAVITY + lift
    peak, hertz = contact.mid_peak_pressure[rows], np.mean([contact.hertz(int(i)).peak_pressure for i in rows])
    print(f"contact force          {contact.force_magnitude[rows].mean():9.2f} N    statics {static:9.2f}")
    print(f"peak pressure          {peak.mean() / 1e6:9.2f} MPa  Hertz   {hertz / 1e6:9.2f}")
    print(f"its ripple             {np.ptp(peak) / peak.mean():9.1e}      round rim       0")
    print(f"von Mises below, 20 kN {mises.max() / 1e6:9.2f} MPa  Hertz   {deepest[1][0]:9.2f}")
    return [result]


if __name__ == "__main__":
    main()
