r"""A cam and its roller follower, at a third of the speed at which the follower lifts off, below it, and above.

The cam lifts the follower by h within the angle b and lets it down again, both by the polynomial 4-5-6-7: with
x = phi/b, s = h (35 x^4 - 84 x^5 + 70 x^6 - 20 x^7), whose acceleration and jerk start and end at zero, so that the
contact hardly vibrates. A spring of stiffness k and preload F_0 presses the follower down; the roller, an elastic ring,
runs on its pin without friction. The section of the cam is the envelope of the roller's positions (`surfaces.cam`).

**Force.** With the pressure angle alpha, tan(alpha) = s'/(r_0 + r_f + s), of a follower of the mass m that moves along
a line through the axis of the cam

    N cos(alpha) = m omega^2 s'' + k s + F_0.

**Jump.** N vanishes where s'' < 0, at first where (k s + F_0)/(-m s'') is smallest: omega_j^2. Beyond it the follower
loses the cam after its highest acceleration and strikes it further on.

**What is modelled.** The ring of the roller is elastic, with its contact pressures; the cam is rigid. Nothing damps the
follower: it bounces on without loss once it has jumped.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

import warpffrf as wf
from warpffrf.output.plots.panels import Panel, save_panels

STEEL = wf.Material(youngs_modulus=206e9, poisson_ratio=0.3, density=7850, name="steel")
BASE, ROLLER, PIN, WIDTH = 18e-3, 9e-3, 4e-3, 8e-3  # m: radii of cam, roller and its bore; width of the roller
LIFT, RISE, DWELL = 8e-3, np.radians(60.0), np.radians(10.0)  # m, rad
MASS, STIFFNESS, PRELOAD = 0.25, 40e3, 300.0  # kg without the roller, N/m, N
SPEEDS = (1.0 / 3.0, 0.98, 1.1)  # of that of the jump
TURNS = 1.0


@dataclass(frozen=True)
class Size:
    """Columns and rows of the roller's mesh; steps per revolution and steps per saved row."""

    sectors: int = 240
    axial: int = 4
    steps: int = 3600
    save_every: int = 2


FULL, QUICK = Size(), Size(sectors=120, axial=2, steps=1800, save_every=2)


def law() -> wf.signals.Polynomial:
    """Lift [m] over the angle [rad] of the cam: dwell, rise, dwell, fall, dwell; the upper dwell opposite to 0."""
    low = np.pi - 0.5 * DWELL - RISE
    breaks = np.array([0.0, low, low + RISE, low + RISE + DWELL, low + 2.0 * RISE + DWELL, 2.0 * np.pi])
    c = np.zeros((5, 8))
    rise = LIFT * np.array([35.0, -84.0, 70.0, -20.0]) / RISE ** np.arange(4, 8)
    c[1, 4:], c[2, 0], c[3, 0], c[3, 4:] = rise, LIFT, LIFT, -rise
    return wf.signals.Polynomial(breaks, c)


def lift(angle: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """s [m], s' and s'' [m/rad, m/rad2] of the follower where the cam has rotated by `angle` [rad]."""
    x = (0.5 * DWELL + RISE - np.abs(np.remainder(angle, 2.0 * np.pi) - np.pi)) / RISE  # 1 in the upper dwell
    x, falls = np.clip(x, 0.0, 1.0), np.remainder(angle, 2.0 * np.pi) > np.pi
    s = LIFT * x**4 * (35.0 - 84.0 * x + 70.0 * x**2 - 20.0 * x**3)
    ds = LIFT / RISE * 140.0 * x**3 * (1.0 - x) ** 3 * np.where(falls, -1.0, 1.0)
    dds = LIFT / RISE**2 * 420.0 * x**2 * (1.0 - x) ** 2 * (1.0 - 2.0 * x)
    return s, ds, dds


def force(angle: np.ndarray, speed: float, mass: float) -> np.ndarray:
    """N [N] of a rigid follower of this `mass` [kg] at the `speed` [rad/s] of the cam."""
    s, ds, dds = lift(angle)
    r = BASE + ROLLER + s
    return (mass * speed**2 * dds + STIFFNESS * s + PRELOAD) * np.hypot(r, ds) / r


def jump_speed(mass: float) -> float:
    """omega_j [rad/s]."""
    s, _, dds = lift(np.linspace(0.0, 2.0 * np.pi, 20001))
    slows = dds < 0.0
    return float(np.sqrt(np.min((STIFFNESS * s[slows] + PRELOAD) / (-mass * dds[slows]))))


def roller(size: Size = FULL) -> wf.ReducedBody:
    """The follower's ring, reduced."""
    mesh = wf.mesh.roller(ROLLER, PIN, WIDTH, sectors=size.sectors, layers=6, axial=size.axial, order=2)
    return wf.reduce(
        mesh, STEEL, interfaces={"bore": "rigid"}, contact={"rim": wf.surfaces.Cylinder()}, modes=6, progress=False
    )


def build(body: wf.ReducedBody, speed: float) -> wf.Scene:
    """The scene: bodies `cam`, `roller` and `follower`, contact and cam `valve`; `speed` [rad/s]."""
    scene = wf.Scene(gravity=(0, 0, 0))
    top = (0.0, 0.0, BASE + ROLLER)
    section = wf.surfaces.cam(law(), base_radius=BASE, roller_radius=ROLLER)
    face = wf.surfaces.Extruded(curve=section, axis_direction=(0, 1, 0), x_direction=(0, 0, 1))
    cam = scene.add_rigid_body(0.5, np.eye(3) * 1e-4, name="cam", surfaces={"face": face})
    ring = scene.add_body(body, name="roller", position=top)
    follower = scene.add_rigid_body(MASS, np.eye(3) * 1e-4, name="follower", position=top)
    scene.add_cam(
        cam["face"], ring["rim"], name="valve", speed=speed, carrier=follower, stiffness=STIFFNESS, preload=PRELOAD
    )
    return scene


def run(body: wf.ReducedBody, speed: float, size: Size = FULL, progress: bool = True) -> wf.Result:
    """One revolution at a constant `speed` [rad/s] of the cam, from the lower dwell."""
    step = 2.0 * np.pi / speed / size.steps
    return wf.simulate(
        build(body, speed), TURNS * 2.0 * np.pi / speed, step=step, start="equilibrium",
        options=wf.RunOptions(save_every=size.save_every), progress=progress,
    )  # fmt: skip


def panels(results: dict[float, wf.Result], mass: float) -> list[Panel]:
    """Lift, contact force and largest pressure over the angle of the cam."""
    angle = np.linspace(0.0, 2.0 * np.pi, 61)
    heights, forces, pressures, rigid = {}, {}, {}, {}
    for speed, result in results.items():
        name, at = f"{speed:.0f} rad/s", np.degrees(speed * result.time)
        contact = result.contact("valve")
        heights[name] = at, (result.body("follower").position[:, 2] - BASE - ROLLER) * 1e3
        if speed < jump_speed(mass):
            forces[name], pressures[name] = (at, contact.force[:, 2]), (at, contact.peak_pressure / 1e6)
            s, ds, _ = lift(angle)
            upwards = force(angle, speed, mass) * (BASE + ROLLER + s) / np.hypot(BASE + ROLLER + s, ds)
            rigid[f"rigid, {name}"] = np.degrees(angle), upwards
    law = {"law": (np.degrees(angle), lift(angle)[0] * 1e3)}
    return [
        Panel("Lift of the follower", "angle of the cam [degrees]", "[mm]", heights, points=law),
        Panel("Contact force upwards", "angle of the cam [degrees]", "[N]", forces, points=rigid),
        Panel("Largest pressure", "angle of the cam [degrees]", "[MPa]", pressures),
    ]


def main(out: str | Path = "out/cam_follower", *, quick: bool = False, progress: bool = True) -> list[wf.Result]:
    """Write cam_follower.h5, .rrd and .png into the folder `out` and print the figures; quick: coarser."""
    stem, size, results = Path(out) / "cam_follower", QUICK if quick else FULL, {}
    body = roller(size)
    mass = MASS + body.mass
    limit = jump_speed(mass)
    print(f"jump at {limit:.1f} rad/s, {limit * 30.0 / np.pi:.0f} rpm, by the law of the cam")
    for part in SPEEDS:
        speed = part * limit
        results[speed] = result = run(body, speed, size, progress)
        contact = result.contact("valve")
        force_found, opened = contact.force_magnitude, np.degrees(speed * np.ptp(contact.open_times, axis=1).sum())
        print(f"{speed:6.1f} rad/s: force {force_found.min():6.1f} to {force_found.max():7.1f} N, "
              f"open for {opened:5.1f} degrees")  # fmt: skip
    last = list(results.values())[-1]
    last.save(f"{stem}.h5", overwrite=True)
    wf.record(last, f"{stem}.rrd", max_frames=60 if quick else 240, overwrite=True)
    save_panels(panels(results, mass), f"{stem}.png", overwrite=True)
    return list(results.values())


if __name__ == "__main__":
    main()
