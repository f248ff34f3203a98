r"""A friction drive with a speed controller: a load step, and an overload that is let go when the drive has slipped.

A motor drives a small roller, which drives a large one by friction alone. A PI controller holds the speed of the large
roller by the torque of the motor. A brake on the large roller is stepped to half of what friction can carry, later
beyond it: the patch slips, the large roller falls behind, the controller runs into its limit, and when a quarter of the
speed is lost the brake is let go. Neither the torque nor that time is known beforehand: a `Simulation` is stepped, with
a controller between an output and an input, and a function that is called before every step.

What to expect. As long as the surfaces roll on each other the machine has one inertia, J = J2 + i^2 J1 seen from the
large roller, i = R2/R1, and with critical damping, ki = J w^2/i and kp = 2 J w/i, a torque M stepped on it slows it by

    M/J t exp(-w t),        at most M/(e J w), at t = 1/w,

but for the creepage of the rollers, a thousandth, and the sampling of the controller. Afterwards the motor has M/i, and
the speed is the reference. In gross slip the large roller falls with (M - mu N R2)/J2.

The rollers are rigid with elastic surfaces, half-spaces, crowned so that the patch is a circle; friction is in cells
that travel with it, and it advances by nearly one cell per step.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

import warpffrf as wf
from warpffrf.output.plots.friction import StickSlipMap
from warpffrf.output.plots.panels import Panel, save_panels

STEEL = wf.Material(youngs_modulus=210e9, poisson_ratio=0.3, density=7850, name="steel")
RADII, CROWN, WIDTH = (0.05, 0.1), 1.0 / 15.0, 0.01  # m: 1/R1 + 1/R2 around is 2/CROWN along
INERTIAS, MASSES = (0.03, 0.15), (0.8, 3.0)  # kg m2, with motor and flywheel; kg
CARRIAGE_MASS, CARRIAGE_INERTIA = 2.0, (0.01, 0.01, 0.01)  # kg, kg m2
PRESS, FRICTION = 1500.0, 0.3  # N, -
HALF_WIDTH = float(np.cbrt(0.75 * PRESS * 0.5 * CROWN / (0.5 * 210e9 / (1.0 - 0.3**2))))  # m
RATIO = RADII[1] / RADII[0]
INERTIA = INERTIAS[1] + RATIO**2 * INERTIAS[0]  # kg m2, seen from the large roller
SPEED, SPIN_UP = 5.0, 0.15  # rad/s of the large roller, s
QUICKNESS = 40.0  # rad/s, w
KP, KI = 2.0 * INERTIA * QUICKNESS / RATIO, INERTIA * QUICKNESS**2 / RATIO  # N m s/rad, N m/rad
MOST_TORQUE = 25.0  # N m, of the motor
LIMIT = FRICTION * PRESS * RADII[1]  # N m on the large roller that friction carries
LOADED, OVERLOADED, END = 0.3, 0.6, 0.9  # s
LOAD, OVERLOAD = 0.5 * LIMIT, 1.2 * LIMIT  # N m
LOST = 0.75  # of the speed, at which the brake is let go
ADVANCE = 0.9  # cells by which the patch advances per step; above one friction is not resolved
PAIR, MEASURED = "small-large", "body_angular_velocity_y[large]"


@dataclass(frozen=True)
class Size:
    """Cells along and across the patch, which reach over 1.3 half-widths."""

    cells: tuple[int, int]

    @property
    def step(self) -> float:
        """s."""
        return ADVANCE * 2.6 * HALF_WIDTH / self.cells[0] / (SPEED * RADII[1])


FULL, QUICK = Size((15, 11)), Size((11, 7))


def roller(number: int) -> wf.ReducedBody:
    """The small roller, 0, or the large one, 1."""
    shape = wf.surfaces.CrownedCylinder(radius=RADII[number], axis_point=(0, 0, 0), axis_direction=(0, 1, 0),
                                        crown_radius=CROWN)  # fmt: skip
    J = INERTIAS[number]
    return wf.half_space_body(
        MASSES[number], (0.6 * J, J, 0.6 * J), STEEL, contact={"rim": shape}, extent=(-0.5 * WIDTH, 0.5 * WIDTH)
    )


def build(size: Size = FULL) -> wf.Scene:
    """The scene: bodies `small`, `large`, `carriage`; inputs `motor` and `brake` [N m]. The press is a force on the
    carriage of the large roller; there is no gravity."""
    motor, brake = wf.signals.Input("motor", unit="N m"), wf.signals.Input("brake", unit="N m")
    scene = wf.Scene()
    small = scene.add_body(roller(0), name="small")
    large = scene.add_body(roller(1), name="large", position=(0, 0, sum(RADII)))
    contact = wf.Contact(
        small["rim"], large["rim"], friction=FRICTION, grid="contact_fixed", cells=size.cells, name=PAIR
    )
    scene.close_gap(scene.add(contact))
    place = large["center"].world_point()
    carriage = scene.add_rigid_body(CARRIAGE_MASS, CARRIAGE_INERTIA, name="carriage", position=place)
    scene.add(wf.joints.Revolute(scene.ground, small["center"], axis=(0, 1, 0), name="motor_axle"))
    scene.add(wf.joints.Prismatic(scene.ground, carriage, axis=(0, 0, 1), name="guide"))
    scene.add(wf.joints.Revolute(carriage, large["center"], axis=(0, 1, 0), name="axle"))
    scene.add(wf.forces.PointForce(carriage, (0, 0, -PRESS), name="press"))
    scene.add(wf.forces.PointTorque(small["center"], (motor, (0, -1, 0)), name="motor"))
    scene.add(wf.forces.PointTorque(large["center"], (brake, (0, -1, 0)), name="brake"))
    return scene


class Operator:
    """Sets the brake before every step, and lets go for good when the speed is lost in the overload."""

    def __init__(self) -> None:
        self.let_go = False

    def __call__(self, sim: wf.Simulation) -> None:
        if sim.time >= OVERLOADED and float(sim.outputs[MEASURED]) < LOST * SPEED:
            self.let_go = True
        torque = 0.0 if sim.time < LOADED else LOAD if sim.time < OVERLOADED else OVERLOAD
        sim.inputs["brake"] = 0.0 if self.let_go else torque


def run(size: Size) -> wf.Result:
    """The whole run."""
    pi = wf.control.PID(
        MEASURED, "motor", reference=wf.signals.SmoothStep(0.0, SPEED, duration=SPIN_UP), kp=KP, ki=KI,
        limits=(-MOST_TORQUE, MOST_TORQUE),
    )  # fmt: skip
    sim = wf.Simulation(
        build(size), step=size.step, start="equilibrium", controllers=[pi], before_step=Operator(),
        options=wf.RunOptions(save_every=4),
    )  # fmt: skip
    sim.run(round(END / size.step) * size.step)
    return sim.result()


def dip(t: np.ndarray | float) -> np.ndarray:
    """By how much the load slows the large roller [rad/s] at the time `t` [s]."""
    late = np.maximum(t - LOADED, 0.0)
    return LOAD / INERTIA * late * np.exp(-QUICKNESS * late)


def let_go(result: wf.Result) -> float:
    """The time [s] of the last row at which the brake is on."""
    return float(result.time[np.flatnonzero(result.force("brake").torque[:, 1])[-1]])


def falling(result: wf.Result) -> float:
    """Deceleration [rad/s2] of the large roller in the second half of its slip."""
    t, end = result.time, let_go(result)
    within = (t > 0.5 * (OVERLOADED + end)) & (t <= end)
    return -float(np.polyfit(t[within], result.body("large").angular_velocity[within, 1], 1)[0])


def main(out: str | Path = "out/friction_drive", *, quick: bool = False, progress: bool = True) -> list[wf.Result]:
    """Write friction_drive.h5, .rrd and .png into the folder `out` and print the figures; quick: fewer cells."""
    stem = Path(out) / "friction_drive"
    result = run(QUICK if quick else FULL)
    result.save(f"{stem}.h5", overwrite=True)
    wf.record(result, f"{stem}.rrd", max_frames=60 if quick else 300, overwrite=True, progress=progress)

    t, large = result.time, result.body("large").angular_velocity[:, 1]
    motor, brake = -result.force("motor").torque[:, 1], -result.force("brake").torque[:, 1]
    pair, rolling = result.contact(PAIR), (t > SPIN_UP) & (t < OVERLOADED)
    share = np.abs(pair.friction.tangential_force[:, 0]) / (FRICTION * pair.normal_load)
    surface = {"small": -RADII[0] * result.body("small").angular_velocity[:, 1], "large": RADII[1] * large}
    loaded = int(np.flatnonzero(t < OVERLOADED)[-1])
    save_panels([
        Panel("Speeds of the surfaces", "time [s]", "[m/s]", {name: (t, v) for name, v in surface.items()}),
        Panel("Torques", "time [s]", "[N m]", {"motor": (t, motor), "brake": (t, brake)}),
        Panel("Large roller under the load step", "time [s]", "[rad/s]", {"run": (t[rolling], large[rolling])},
              {"one inertia": (t[rolling], SPEED - dip(t[rolling]))}),
        Panel("Friction used, Q/(mu N)", "time [s]", "[-]", {"run": (t, share)}),
        StickSlipMap("Stick and slip under the load", result, loaded),
    ], f"{stem}.png", overwrite=True)  # fmt: skip

    slowest = SPEED - float(large[rolling & (t > LOADED)].min())
    print(f"load step: slower by      {slowest:.4f} rad/s   one inertia  {dip(LOADED + 1.0 / QUICKNESS):.4f}")
    print(f"  then, speed             {large[loaded]:.4f} rad/s   reference    {SPEED:.4f}")
    print(f"  torque of the motor     {motor[loaded]:.4f} N m   statics     {LOAD / RATIO:.4f}")
    print(f"overload: falls with      {falling(result):.3f} rad/s2  Coulomb      "
          f"{(OVERLOAD - LIMIT) / INERTIAS[1]:.3f}")  # fmt: skip
    print(f"  let go at               {let_go(result):.4f} s")
    return [result]


if __name__ == "__main__":
    main()
