r"""A complete ball bearing under a radial load: at rest, then rotating, balls and cage driven by friction.

A 209 deep-groove bearing (T. A. Harris, Rolling Bearing Analysis): nine balls between rigid rings with 15 um of
diametral clearance, 8.9 kN radial load. The inner ring rotates at 1,500 rpm; friction on the raceways makes the balls
roll, and the balls drive the cage, a body with a pocket for each ball.

**Loads.** A ball at the angle phi from the load is compressed by the shift (x, z) of the inner ring by

    delta = z cos phi + x sin phi - s/2,        Q = c_P delta^1.5,

c_P of both contacts in series; x and z balance the load for every position of the cage. At rest, with a ball under the
load, loads and pressures are published: 4,527 N and 2,841 N on the first two balls, 60.5 um of deflection.

**Speeds.** Rolling without slip at the contact angle 0, gamma = d/D (diameters of balls and pitch circle), the cage
rotates with w (1 - gamma)/2, and a ball relative to it with w D/(2 d) (1 - gamma^2) in the opposite sense; only loaded
balls follow it.

**Losses.** Friction here results from slip at point contacts of balls and rings and nearly vanishes in rolling. In a
real bearing most friction results from slip within the patch, from hysteresis and from oil.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

import warpffrf as wf
from warpffrf.output.plots.panels import Panel, Polar, save_panels

STEEL = wf.Material(youngs_modulus=206e9, poisson_ratio=0.3, density=7850, name="steel")
COUNT, BALL, PITCH, GROOVE = 9, 12.7e-3, 64.9985e-3, 6.6e-3  # balls; m: diameters, radius of the grooves
CLEARANCE, LOAD, SPEED = 15e-6, 8900.0, 1500.0 * np.pi / 30.0  # m, N, rad/s
PLAY, TRACTION = 0.1e-3, wf.laws.RegularisedCoulomb(0.06, 0.01)  # m, clearance of a ball in its pocket
DAMPING = 1.0  # s/m of the contacts
NAME = "209"
GAMMA = BALL / PITCH
CAGE = 0.5 * SPEED * (1.0 - GAMMA)  # rad/s
ROLLING = 0.5 * SPEED / GAMMA * (1.0 - GAMMA**2)  # rad/s, of a ball relative to the cage
PASSAGE = 2.0 * np.pi / (COUNT * CAGE)  # s, from one ball under the load to the next
HEAVY = 0.1  # of the largest load: balls above it roll


@dataclass(frozen=True)
class Size:
    """Passages of a ball, steps per passage."""

    passages: int = 4
    steps: int = 400


FULL, QUICK = Size(), Size(passages=1)


def build() -> wf.Scene:
    """The scene: bearing `209` whose outer ring is the ground, joint `plane`, drive `drive`, force `load`."""
    scene = wf.Scene()
    bearing = scene.add_bearing(
        NAME,
        wf.bearings.BallGeometry(
            elements=COUNT, ball_diameter=BALL, pitch_diameter=PITCH, osculation=GROOVE / BALL, clearance=CLEARANCE,
        ),
        first=(0, 0, -1), outer=scene.ground, cage=wf.bearings.PocketCage(PLAY, friction=TRACTION),
        contact=wf.bearings.RollingContact(friction=TRACTION, law=wf.laws.HertzPoint(STEEL, STEEL, damping=DAMPING)),
        materials=STEEL,
    )  # fmt: skip
    shaft: Any = bearing.inner
    plane = scene.add(wf.joints.Planar(scene.ground.at((0, 0, 0)), shaft, axis=(0, 1, 0), name="plane"))
    scene.add(wf.joints.Drive(plane, SPEED, name="drive"))
    scene.add(wf.forces.PointForce(shaft, (0, 0, -LOAD), name="load"))
    bearing.roll(SPEED, angle=0.0)
    return scene


def panels(result: wf.Result) -> list[Panel]:
    """The load zone, the loads of a ball as it goes around, the ring, and the cage."""
    found, t = result.bearing(NAME), result.time * 1e3
    closed = np.append(found.angle[0], found.angle[0, 0])
    order = np.argsort(found.angle, axis=None)
    cage = result.body(f"{NAME} cage").angular_velocity[:, 1]
    balls = {f"ball {i + 1}": (t, found.cage_force[:, i]) for i in range(COUNT)}
    return [
        Polar("Load zone at rest", "angle", "[kN]",
              {"inner ring": (closed, np.append(found.inner_load[0], found.inner_load[0, 0]) / 1e3),
               "outer ring": (closed, np.append(found.outer_load[0], found.outer_load[0, 0]) / 1e3)}),
        Panel("Loads on the outer ring, all balls, all steps", "angle from the load [deg]", "[kN]",
              {"run": (np.degrees(found.angle.ravel()[order]), found.outer_load.ravel()[order] / 1e3)}),
        Panel("The inner ring along the load", "time [ms]", "[µm]", {"run": (t, found.displacement[:, 0] * 1e6)}),
        Panel("Speed of the cage over that of rolling, less 1", "time [ms]", "[%]",
              {"cage": (t, 100.0 * (cage / CAGE - 1.0))}),
        Panel("Forces of the cage on balls", "time [ms]", "[N]", balls),
    ]  # fmt: skip


def main(out: str | Path = "out/ball_bearing", *, quick: bool = False, progress: bool = True) -> list[wf.Result]:
    """Write ball_bearing.h5, .rrd and .png into the folder `out` and print the figures; quick: fewer passages."""
    stem, size = Path(out) / "ball_bearing", QUICK if quick else FULL
    step = PASSAGE / size.steps
    result = wf.simulate(build(), size.passages * PASSAGE, step=step, start="equilibrium", progress=progress)
    result.save(f"{stem}.h5", overwrite=True)
    wf.record(result, f"{stem}.rrd", max_frames=60 if quick else 240, overwrite=True)
    save_panels(panels(result), f"{stem}.png", overwrite=True)

    found, later = result.bearing(NAME), result.time > result.time[-1] / 3.0
    loaded = found.inner_load[later] > HEAVY * found.inner_load.max()
    cage = result.body(f"{NAME} cage").angular_velocity[later, 1]
    against = (found.spin[later][..., 2] - cage[:, None])[loaded].mean()
    print(found.report())
    print(f"at rest: ball under the load       {found.outer_load[0, 0]:8.5g} N      published 4527")
    print(f"at rest: the next one              {found.outer_load[0, 1]:8.5g} N      published 2841")
    print(f"at rest: deflection                {found.displacement[0, 0] * 1e6:8.5g} um     published 60.5")
    print(f"rotating: cage                     {cage.mean():8.5g} rad/s  rolling {CAGE:8.5g}")
    print(f"rotating: loaded balls against it  {against:8.5g} rad/s  rolling {-ROLLING:8.5g}")
    return [result]


if __name__ == "__main__":
    main()
