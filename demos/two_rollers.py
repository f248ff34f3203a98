"""Two hollow steel rollers, pressed together and rolling under a load step.

The lower roller rotates on a fixed axle. The upper one rotates in a carriage that slides on a sprung vertical guide and
is pressed down by a force. The run starts from the static equilibrium under that force; both axles are driven smoothly
to equal and opposite speeds; then, while they roll, the force rises smoothly to its second value. The contact is
frictionless.

What to expect: the contact carries the force on the carriage and the weight above it, less the force of the guide's
spring. At mid-width the pressure is close to Hertz's line contact at the line load P' found there,

    a^2 = 4 P' R / (pi E*),   p0 = 2 P' / (pi a),   1/R = 1/R1 + 1/R2,   E* = E / (2 (1 - nu^2))

(K. L. Johnson, Contact Mechanics, 1985, section 4.2); the ends of the rollers carry less than the middle.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

import warpffrf as wf

OUTER_RADIUS, BORE_RADIUS, WIDTH = 0.05, 0.015, 0.02  # m
GRADING = 1.3  # thickness of a layer over that of its outer neighbour; with 17 layers the cells at the rim are square
MAX_FREQUENCY = 20e3  # Hz, of the vibration modes
GRAVITY = 9.81  # m/s2
CARRIAGE_MASS, CARRIAGE_INERTIA = 5.0, (0.01, 0.01, 0.01)  # kg, kg m2
GUIDE_STIFFNESS, GUIDE_DAMPING = 1e6, 2e3  # N/m, N s/m: soft compared with the contact (about 1e9 N/m)
LOAD, LOAD_AFTER = 20e3, 26e3  # N, on the carriage, before and after the load step
LOAD_STEP_AT, LOAD_STEP_TAKES = 0.055, 0.010  # s
SPEED, SPIN_UP = 100.0, 0.02  # rad/s reached within s
DURATION, STEP = 0.1, 1e-4  # s
SETTLED = 0.01  # s at the end of the run, over which the figures are averaged
PAIR, GUIDE = "lower-upper", "guide"


@dataclass(frozen=True)
class Size:
    """Linear hexahedra of a roller around, through the wall and along the axis."""

    sectors: int
    layers: int
    axial: int


FULL, QUICK = Size(sectors=2400, layers=17, axial=6), Size(sectors=2400, layers=17, axial=4)  # four cells a half-width


def build(size: Size = FULL, *, load: float = LOAD, load_after: float = LOAD_AFTER, progress: bool = True) -> wf.Scene:
    """The scene, with its roller meshed and reduced; `load` and `load_after` [N] press the carriage down."""
    return machine(roller_body(size, progress=progress), load=load, load_after=load_after, load_step_at=LOAD_STEP_AT)


def roller_body(
    size: Size = FULL, *, contact_fixed: bool | None = None, local_dynamics: bool = False, progress: bool = True
) -> wf.ReducedBody:
    """The reduced roller, with interface `bore` and contact surface `rim`; the options as of `reduce`."""
    steel = wf.Material(youngs_modulus=210e9, poisson_ratio=0.3, density=7850, name="steel")
    mesh = wf.mesh.roller(
        OUTER_RADIUS, BORE_RADIUS, WIDTH, sectors=size.sectors, layers=size.layers, axial=size.axial, grading=GRADING,
        order=1,
    )  # fmt: skip
    return wf.reduce(
        mesh, steel, interfaces={"bore": "rigid"}, contact={"rim": wf.surfaces.Cylinder()}, max_frequency=MAX_FREQUENCY,
        grid=wf.ContactGrid(contact_fixed=contact_fixed), options=wf.ReductionOptions(local_dynamics=local_dynamics),
        cache=False, progress=progress,
    )  # fmt: skip


def machine(
    roller: wf.ReducedBody, *, load: float = LOAD, load_after: float = LOAD_AFTER, load_step_at: float,
    speed: float = SPEED,
) -> wf.Scene:  # fmt: skip
    """The scene of `build` around a roller that is already reduced: bodies `lower`, `upper`, `carriage`; joints `axle`,
    `guide`, `upper_axle`; contact `lower-upper`. The force changes from `load_step_at` [s] on; `speed` [rad/s]."""
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
    for joint, end in ((axle, speed), (upper_axle, -speed)):
        spin = wf.signals.SmoothStep(0.0, end, duration=SPIN_UP)
        scene.add(wf.joints.Drive(joint, spin, quantity="velocity"))
    press = wf.signals.SmoothStep(load, load_after, duration=LOAD_STEP_TAKES, delay=load_step_at)
    scene.add(wf.forces.PointForce(carriage, (press, (0, 0, -1))))
    return scene


def static_force(scene: wf.Scene, result: wf.Result, load: float) -> float:
    """The force of the contact at the end by statics [N]: load and weight above it, less the spring of the guide."""
    above = scene.body("upper").mass + scene.body("carriage").mass
    return load + above * GRAVITY + GUIDE_STIFFNESS * settled(result, result.joint(GUIDE).coordinate)


def settled(result: wf.Result, values: np.ndarray) -> float:
    """Mean over the last `SETTLED` seconds of a run."""
    return float(np.mean(values[result.time >= result.time[-1] - SETTLED]))


def main(out: str | Path = "out/two_rollers", *, quick: bool = False, progress: bool = True) -> list[wf.Result]:
    """Write two_rollers.h5, .rrd and .png into the folder `out` and print the figures; quick: fewer cells."""
    stem = Path(out) / "two_rollers"
    scene = build(QUICK if quick else FULL, progress=progress)
    result = wf.simulate(scene, DURATION, step=STEP, start="equilibrium", progress=progress)
    print(result.report())
    result.save(f"{stem}.h5", overwrite=True)  # after the report, so that the file has the error budget
    wf.record(result, f"{stem}.rrd", max_frames=60 if quick else 300, overwrite=True)
    result.summary().savefig(f"{stem}.png")

    contact = result.contact(PAIR)
    rows = np.flatnonzero(result.time >= result.time[-1] - SETTLED)
    width, peak = np.mean([(h.half_width, h.peak_pressure) for h in map(contact.hertz, rows.tolist())], axis=0)
    print(f"contact force {settled(result, contact.force_magnitude):10.2f} N    "
          f"statics {static_force(scene, result, LOAD_AFTER):9.2f}")  # fmt: skip
    print(f"half-width    {settled(result, contact.half_width) * 1e6:10.2f} um   Hertz {width * 1e6:11.2f}")
    print(f"peak pressure {settled(result, contact.mid_peak_pressure) / 1e6:10.2f} MPa  Hertz {peak / 1e6:11.2f}")
    return [result]


if __name__ == "__main__":
    main()
