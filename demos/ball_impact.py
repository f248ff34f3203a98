r"""A steel ball hits a steel half-space: Hertz's impact.

A ball of 10 mm radius arrives at 0.1 m/s. One of two equal bodies may represent both: this one has half the modulus of
steel and hits a rigid plane, so that 1/E* = 2 (1 - nu^2)/E is that of steel on steel. It has no vibration modes and
its local modes are quasi-static: it is rigid except for the contact, as in Hertz's theory.

What to expect, with K = (4/3) E* sqrt(R),

    delta_max = (5 m v^2/(4 K))^(2/5),    F_max = K delta_max^(3/2),    T = (4/5) B(2/5, 1/2) delta_max/v

(K. L. Johnson, Contact Mechanics, 1985, section 11.4), the impulse 2 m v, and a rebound at the speed of arrival.
A half-space behind the patch neglects the contribution of the rest of the ball to the approach, of order a/R = 2 %.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import gamma
from pathlib import Path

import numpy as np

import warpffrf as wf
from warpffrf.output.plots.panels import Panel, save_panels

STEEL = wf.Material(youngs_modulus=210e9, poisson_ratio=0.3, density=7800, name="steel")
FOR_BOTH = replace(STEEL, youngs_modulus=0.5 * STEEL.youngs_modulus, name="steel on steel")
RADIUS, SPEED = 0.01, 0.1  # m, m/s
MASS = STEEL.density * 4.0 / 3.0 * np.pi * RADIUS**3  # kg
MODULUS = STEEL.youngs_modulus / (2.0 * (1.0 - STEEL.poisson_ratio**2))  # Pa, E*
STIFFNESS = 4.0 / 3.0 * MODULUS * np.sqrt(RADIUS)  # N/m^1.5, K
APPROACH = (1.25 * MASS * SPEED**2 / STIFFNESS) ** 0.4  # m
FORCE = STIFFNESS * APPROACH**1.5  # N
DURATION = 0.8 * gamma(0.4) * gamma(0.5) / gamma(0.9) * APPROACH / SPEED  # s
WIDEST = np.cbrt(0.75 * FORCE * RADIUS / MODULUS)  # m, largest half-width a of the patch
PATCH = (1.6, 1.3)  # half-widths of the fine patch of the mesh over a: around and along
GAP = 1e-6  # m, at the start
DOWN_ON_PLANE = (0.0, np.sqrt(0.5), 0.0, np.sqrt(0.5))  # rotates the fine patch of the mesh from +x to -z
PAIR = "ball-plane"


@dataclass(frozen=True)
class Size:
    """Quadratic cells in the largest half-width."""

    cells: float = 2.0


FULL, QUICK = Size(), Size(cells=1.0)


def build(size: Size = FULL, *, progress: bool = True) -> wf.Scene:
    """The scene: body `ball`, which moves freely, and contact `ball-plane`."""
    mesh = wf.mesh.ball(RADIUS, patch_half_width=(PATCH[0] * WIDEST, PATCH[1] * WIDEST), cell=WIDEST / size.cells)
    reduced = wf.reduce(mesh, FOR_BOTH, contact={"patch": wf.surfaces.Sphere()}, modes=0, progress=progress)
    scene = wf.Scene()
    ball = scene.add_body(
        reduced, name="ball", position=(0, 0, RADIUS + GAP), rotation=DOWN_ON_PLANE, velocity=(0, 0, -SPEED)
    )
    plane = wf.surfaces.Plane(origin=(0, 0, 0), outward=(0, 0, 1))
    scene.add(wf.Contact(ball["patch"], scene.ground.surface(plane, name="plane"), name=PAIR))
    return scene


def panels(result: wf.Result) -> list[Panel]:
    """Force, height and energies over time, pressure at the largest force."""
    contact, t = result.contact(PAIR), result.time * 1e6
    i = int(np.argmax(contact.normal_load))
    height = (result.body("ball").position[:, 2] - RADIUS) * 1e6
    x = np.linspace(-1.3 * WIDEST, 1.3 * WIDEST, 201)
    hertz = 1.5 * FORCE / (np.pi * WIDEST**2) * np.sqrt(np.maximum(1.0 - (x / WIDEST) ** 2, 0.0))
    return [
        Panel("Force", "time [µs]", "[N]", {"force": (t, contact.normal_load)},
              {"Hertz, largest": (np.array([t[i]]), np.array([FORCE]))}),
        Panel("Height of the lowest point, undeformed", "time [µs]", "[µm]", {"height": (t, height)},
              {"Hertz, lowest": (np.array([t[i]]), np.array([-APPROACH * 1e6]))}),
        Panel("Energies", "time [µs]", "[µJ]", {n: (t, result.energy[n] * 1e6) for n in ("kinetic", "contact")}),
        Panel("Pressure at the largest force", "arc [mm]", "[MPa]",
              {"pressure": (contact.arc[i] * 1e3, contact.mid_pressure[i] / 1e6)},
              {"Hertz": (x * 1e3, hertz / 1e6)}),
    ]  # fmt: skip


def main(out: str | Path = "out/ball_impact", *, quick: bool = False, progress: bool = True) -> list[wf.Result]:
    """Write ball_impact.h5, .rrd and .png into the folder `out` and print the figures; quick: larger cells."""
    stem = Path(out) / "ball_impact"
    scene = build(QUICK if quick else FULL, progress=progress)
    result = wf.simulate(scene, GAP / SPEED + 1.3 * DURATION, step=DURATION / 160, progress=progress)
    result.save(f"{stem}.h5", overwrite=True)
    wf.record(result, f"{stem}.rrd", max_frames=30 if quick else 100, overwrite=True)
    save_panels(panels(result), f"{stem}.png", overwrite=True)

    contact, velocity = result.contact(PAIR), result.body("ball").velocity[:, 2]
    touching = result.time[contact.normal_load > 0.0]
    print(f"largest force       {contact.normal_load.max():8.4g} N     Hertz {FORCE:8.4g}")
    print(f"largest approach    {contact.approach.max() * 1e6:8.4g} um    Hertz {APPROACH * 1e6:8.4g}")
    print(f"time of contact     {np.ptp(touching) * 1e6:8.4g} us    Hertz {DURATION * 1e6:8.4g}")
    print(f"force over time     {np.trapezoid(contact.force[:, 2], result.time) * 1e3:8.4g} mN s  "
          f"2 m v {2.0 * MASS * SPEED * 1e3:8.4g}")  # fmt: skip
    print(f"speed after/before  {-velocity[-1] / velocity[0]:8.5f}       no vibration: 1")
    return [result]


if __name__ == "__main__":
    main()
