r"""A shallow arch that snaps through: by displacement along the whole path, by load with a jump there and one back.

An arch clamped at both ends, 2.5 times as high as thick, is pushed down at its crown. As it flattens, its thrust grows
and reduces the stiffness: at a limit load the tangent of the path F(w) is horizontal. Beyond it the equilibrium
force decreases, until the arch hangs down like a chain and stiffens. The load decreases between two limit points,

    F(w):   rises to F_1 at w_1,   falls to F_2 at w_2,   rises from there on.

*By displacement*, with the crown on a rod whose length is prescribed, each w has one equilibrium, and load steps follow
the whole path, including the falling branch. *By load* there is no equilibrium nearby once F_1 is reached: the arch
jumps to the second rising branch, where the force is F_1 again, and vibrates there until damping has stopped it. As the
load decreases it remains on that branch as far as F_2 and jumps back. The run in time has a load that rises and falls
slowly, so that it follows the equilibria between the jumps; it jumps slightly late, since the motion is slow where the
tangent is horizontal.

One flexible body with `stiffening` contains all of it: the instability is the work of the thrust, a load of the ends,
on the second-order motion of ends and crown. Full finite elements of the same mesh and St. Venant-Kirchhoff's material
have the limit loads 2472.0 N and 1737.1 N; the difference is of higher order in the angles by which the arch rotates
from its mean axes, 0.1 before the jump and 0.2 after it.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from scipy.interpolate import CubicSpline

import warpffrf as wf
from warpffrf.output.plots.panels import Panel, save_panels

SPAN, WIDTH, THICKNESS, RISE = 1.0, 0.03, 0.01, 0.025  # m
PATCH = 0.05  # m, half the length that the load is spread over
STEEL = wf.Material(youngs_modulus=210e9, poisson_ratio=0.3, density=7850, name="steel")
MODES, DAMPING = 40, 0.1
FARTHEST = 0.038  # m, of the crown, where the load is that of the jump again
LARGEST = 3000.0  # N, of the load that rises and falls: a fifth above the limit load
STEP = 5e-4  # s: 20 to a period of the first mode of the arch
MIDDLE = 0.02  # m of the crown: it jumps across this place, between the limit points


@dataclass(frozen=True)
class Size:
    """Quadratic cells along the arch (a multiple of 20), load steps of the path, seconds in which the load rises and
    falls."""

    cells: int = 20
    steps: int = 38
    seconds: float = 8.0


FULL, QUICK = Size(), Size(steps=19, seconds=2.0)


def mesh(size: Size = FULL) -> wf.mesh.Mesh:
    """The arch along x, a parabola, with the facet sets `x_min`, `x_max` and `crown` on its upper side."""
    bar = wf.mesh.box((SPAN, WIDTH, THICKNESS), (size.cells, 1, 1), name="arch")
    height = RISE * (1.0 - (2.0 * bar.points[:, 0] / SPAN) ** 2)
    arch = replace(bar, points=bar.points + height[:, None] * np.array([0.0, 0.0, 1.0]))
    return arch.select("crown", "z_max", lambda x: np.abs(x[:, 0]) < PATCH)


def clamped(size: Size = FULL, *, progress: bool = True) -> wf.Scene:
    """The scene without a load: body `arch` with the interfaces `x_min`, `x_max`, `crown`, the ends held; sensor
    `crown`."""
    arch = wf.reduce(
        mesh(size), STEEL, interfaces={"x_min": "rigid", "x_max": "rigid", "crown": "average"}, modes=MODES,
        options=wf.ReductionOptions(inertia_modes=MODES, stiffening=True), progress=progress,
    )  # fmt: skip
    scene = wf.Scene(gravity=(0.0, 0.0, 0.0))
    body = scene.add_body(arch, name="arch", damping=DAMPING, stiffening=True)
    for end in ("x_min", "x_max"):
        scene.add(wf.joints.Fixed(scene.ground, body[end], name=f"clamp_{end}"))
    scene.add(wf.sensors.Position(body["crown"], name="crown"))
    return scene


def build(size: Size = FULL, *, progress: bool = True) -> wf.Scene:
    """The arch under a load at its crown that rises to `LARGEST` and falls to zero again."""
    scene = clamped(size, progress=progress)
    push = wf.signals.Table([0.0, size.seconds, 2.0 * size.seconds], [0.0, -LARGEST, 0.0])
    scene.add(wf.forces.PointForce(scene.body("arch")["crown"], (0.0, 0.0, push), name="push"))
    return scene


def driven(size: Size = FULL, *, progress: bool = True) -> wf.Scene:
    """The arch on a rod, joint `rod`, from the ground to its crown, which becomes shorter by `FARTHEST`: a second per
    load step."""
    scene = clamped(size, progress=progress)
    crown = scene.body("arch")["crown"]
    foot = crown.point - [0.0, 0.0, SPAN]
    rod = scene.add(wf.joints.Distance(scene.ground.at(foot), crown, name="rod"))
    length = wf.signals.Table([0.0, float(size.steps)], [SPAN, SPAN - FARTHEST])
    scene.add(wf.joints.Drive(rod, length, quantity="position", name="spindle"))
    return scene


def crown_way(result: wf.Result) -> np.ndarray:
    """w (T,) [m] of the crown, downwards."""
    z = result.sensor("crown").values[:, 2]
    return z[0] - z


def main(out: str | Path = "out/snapping_arch", *, quick: bool = False, progress: bool = True) -> list[wf.Result]:
    """Write snapping_arch.h5, .rrd and .png of the run under the load, and snapping_arch.driven.h5 of that by
    displacement, into the folder `out` and print the figures; quick: fewer load steps, a load that rises faster."""
    stem, size = Path(out) / "snapping_arch", QUICK if quick else FULL
    steps = wf.static(driven(size, progress=progress), float(size.steps), step=1.0, progress=progress)
    snapped = wf.simulate(build(size, progress=progress), 2.0 * size.seconds, step=STEP, progress=progress)
    snapped.save(f"{stem}.h5", overwrite=True)
    steps.save(f"{stem}.driven.h5", overwrite=True)
    wf.record(snapped, f"{stem}.rrd", max_frames=40 if quick else 320, overwrite=True)

    t, w, path_w, path_F = snapped.time, crown_way(snapped), crown_way(steps), -steps.joint("rod").force[:, 2]
    force = LARGEST * np.minimum(t, 2.0 * size.seconds - t) / size.seconds
    path = CubicSpline(path_w, path_F)
    save_panels([
        Panel("Push at the crown", "down [mm]", "[kN]", {"by load, in time": (1e3 * w, 1e-3 * force)},
              points={"by displacement, at rest": (1e3 * path_w, 1e-3 * path_F)}),
        Panel("By load: crown over time", "time [s]", "down [mm]", {"crown": (t, 1e3 * w)}),
    ], f"{stem}.png", overwrite=True)  # fmt: skip

    limits = path(path.derivative().roots(extrapolate=False))
    beyond = np.flatnonzero(w > MIDDLE)
    print(f"by displacement: limit loads {limits[0]:.1f} N and {limits[-1]:.1f} N, full FE model 2472.0 N and 1737.1 N")
    print(f"by load: snaps through at {force[beyond[0]]:.1f} N, back at {force[beyond[-1]]:.1f} N")
    work, damping = (snapped.energy[line][-1] for line in ("force_work", "damping"))
    print(f"a cycle takes {work:.2f} J, damping {damping:.2f} J of it")
    return [snapped, steps]


if __name__ == "__main__":
    main()
