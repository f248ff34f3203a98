"""A fast heavy top on a ball joint: the standard test of integrators on the rotation group.

A thin disc of 15 kg and 0.25 m radius spins at 150 rad/s about its axis, which is held in a fixed point 1 m from the
disc. The axis starts level and rotates about the vertical at -4.61538 rad/s; gravity pulls it down, and it swings
around and up again (O. Bruels and A. Cardona, On the use of Lie group time integrators in multibody dynamics, J.
Comput. Nonlinear Dyn. 5, 2010, 031002).

What to expect: the position of the centre of mass after 1 s is known to nine digits from integrations with much smaller
steps; the error falls as the square of the step, so that half the step and Richardson's extrapolation

    x = x_(h/2) + (x_(h/2) - x_h) / 3

leave an error of fourth order. The energy remains that of the start,

    T + V = 1/2 m |omega x X|^2 + 1/2 omega.J omega + m g z = 5435.6967909 J    (z = 0 at the start),

up to the small part that the numerical dissipation takes.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

import warpffrf as wf
from warpffrf.output.plots.panels import Panel, save_panels

MASS, INERTIA = 15.0, (0.234375, 0.46875, 0.234375)  # kg, kg m2: m R^2/4, m R^2/2, m R^2/4 with R = 0.25 m
ARM = np.array([0.0, 1.0, 0.0])  # m, from the ball joint to the centre of mass
SPIN = np.array([0.0, 150.0, -4.61538])  # rad/s
GRAVITY = 9.81  # m/s2
DURATION, STEP, QUICK_STEP = 1.0, 5e-5, 2e-4  # s
SAVED = 1000  # rows of a run
RHO_INF = 0.9
AFTER_ONE_SECOND = np.array([0.173343964, 0.640088592, -0.748490791])  # m, centre of mass, published
ENERGY = 5435.6967909  # J


def build() -> wf.Scene:
    """The scene: body `top`, its user origin in the centre of mass, and joint `tip`."""
    scene = wf.Scene(gravity=(0, 0, -GRAVITY))
    top = scene.add_rigid_body(
        MASS, INERTIA, name="top", position=ARM, velocity=np.cross(SPIN, ARM), angular_velocity=SPIN
    )
    scene.add(wf.joints.Spherical(scene.ground, top.at(-ARM), name="tip"))
    return scene


def run(step: float) -> wf.Result:
    """One second of the top at a fixed `step` [s]."""
    save_every = max(round(DURATION / step) // SAVED, 1)
    return wf.simulate(
        build(),
        DURATION,
        step=step,
        options=wf.RunOptions(integrator=wf.GeneralizedAlpha(RHO_INF), save_every=save_every),
        progress=False,
    )


def main(out: str | Path = "out/heavy_top", *, quick: bool = False, progress: bool = True) -> list[wf.Result]:
    """Write heavy_top.h5, .rrd and .png, and heavy_top.coarse.h5 with twice the step, into the folder `out` and print
    the figures; quick: longer steps."""
    stem, step = Path(out) / "heavy_top", QUICK_STEP if quick else STEP
    coarse, fine = run(step), run(step / 2)
    fine.save(f"{stem}.h5", overwrite=True)
    coarse.save(f"{stem}.coarse.h5", overwrite=True)
    wf.record(fine, f"{stem}.rrd", overwrite=True)

    t, x = fine.time, fine.body("top").position
    energy = {f"step {h:g} s": (r.time, (r.energy["kinetic"] + r.energy["potential"]) / ENERGY - 1.0)
              for h, r in ((step, coarse), (step / 2, fine))}  # fmt: skip
    save_panels([
        Panel("Centre of mass", "time [s]", "[m]", {axis: (t, x[:, i]) for i, axis in enumerate("xyz")}),
        Panel("Its path from above", "x [m]", "y [m]", {"path": (x[:, 0], x[:, 1])},
              {"published, after 1 s": (AFTER_ONE_SECOND[:1], AFTER_ONE_SECOND[1:2])}),
        Panel("Kinetic and potential energy, over that of the start, less 1", "time [s]", "[-]", energy),
    ], f"{stem}.png", overwrite=True)  # fmt: skip

    x_h, x_half = coarse.body("top").position[-1], x[-1]
    best = x_half + (x_half - x_h) / 3.0
    off = [float(np.linalg.norm(p - AFTER_ONE_SECOND)) for p in (x_h, x_half, best)]
    print(f"published after 1 s {AFTER_ONE_SECOND} m, extrapolated {best} m")
    print(f"error at {step:g} s {off[0]:.2e} m, at {step / 2:g} s {off[1]:.2e} m, extrapolated {off[2]:.1e} m")
    print(f"order of the error {np.log2(off[0] / off[1]):.4f}, of the integrator 2")
    return [fine, coarse]


if __name__ == "__main__":
    main()
