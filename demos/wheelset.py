r"""A free wheelset hunts on its track: wheels S1002 on rails UIC 60 inclined by 1:40, gauge 1,435 mm, all elastic.

A wheelset that is displaced to the left rolls on a larger radius there than on the right rail, and steers back: it
oscillates sideways and in yaw. It starts in the middle of the track, yawed to the left, and rolls for half a wave.

**Kinematics.** With the displacement y, the yaw psi, the rolling radii r_l and r_r, the positions y_l and y_r of the
contacts across the track, and the roll phi(y) with which both wheels touch, rolling without slip means

    dy/dx = psi/(1 + r dphi/dy),      dpsi/dx = -(r_l - r_r)/(r (y_l - y_r)).

The profiles make r_l - r_r neither proportional to y nor smooth: 0.2 mm off the middle the place where the rigid left
wheel touches jumps by 10 mm towards its flange. So the wave becomes longer with its amplitude.

**What is modelled.** Wheels and rails are half-spaces under their patches, with friction, stick and slip in every cell;
rows of cells are given, since near the middle of the track a patch covers both places at once. Patches move over
instead of jumping: the wheelset steers later than a rigid one, and its wave is 2 % longer than a rigid one of the same
amplitude. The normal force of the steeper, left contact pushes the wheelset back by up to 4.5 kN; the spin of the patch
causes a creep force that holds it.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

import warpffrf as wf
from warpffrf.output.contact.hertz import hertz_point
from warpffrf.output.plots.panels import Panel, save_panels

POISSON, SHEAR, FRICTION = 0.28, 82e9, 0.3  # -, Pa, -
STEEL = wf.Material(youngs_modulus=2.0 * SHEAR * (1.0 + POISSON), poisson_ratio=POISSON, density=7850, name="steel")
RADIUS, MASS, INERTIA, LOAD = 0.46, 1200.0, (700.0, 100.0, 700.0), 100e3  # m, kg, kg m2, N with the weight
SPEED, YAW, WAY, RISE = 10.0, 2.4e-3, 4.8, 0.1  # m/s, rad at the start, m, s in which the load rises
SIDES = {"left": 1, "right": -1}
# m from the running circle: boundaries of cells along the profile, shorter where patches are
ROWS = 1e-3 * np.concatenate([[-20.0, -19.0, -18.0], np.linspace(-17.0, -2.0, 26), np.linspace(-0.8, 17.2, 16)])
ONE_PLACE, MARKS = 1.5e-3, 24  # m, the displacement from which each wheel touches in one place; points of a picture


@dataclass(frozen=True)
class Size:
    """Strips of cells along the track; each `every`th of `ROWS`; way per step [m]; steps per saved row."""

    strips: int = 9
    every: int = 1
    step: float = 2.5e-3
    save_every: int = 4


FULL, QUICK = Size(), Size(strips=7, every=2, step=10e-3, save_every=2)


def build(size: Size = FULL) -> wf.Scene:
    """The scene: wheelset `wheelset` with its contacts `wheelset left` and `wheelset right`, force `load`."""
    scene = wf.Scene()
    wheels = scene.add_wheelset(
        wf.surfaces.wheel_s1002(radius=RADIUS), wf.surfaces.rail_uic60(), name="wheelset", mass=MASS,
        inertia_tensor=INERTIA, material=STEEL, track=(-0.3, 0.3 + WAY), speed=SPEED, yaw=YAW, friction=FRICTION,
        cells=(size.strips, ROWS[:: size.every]),
    )  # fmt: skip
    down = (0.0, 0.0, wf.signals.SmoothStep(0.0, -LOAD, duration=RISE))
    scene.add(wf.forces.PointForce(wheels.body["center"], down, name="load"))
    return scene


@cache
def rigid() -> Any:
    """The wheelset with the kinematics of its rigid profiles."""
    return build(QUICK).wheelsets[0]


def run(size: Size = FULL, progress: bool = True) -> wf.Result:
    """The whole way."""
    options = wf.RunOptions(integrator=wf.integrators.GeneralizedAlpha(0.5), save_every=size.save_every)
    return wf.simulate(build(size), WAY / SPEED, step=size.step / SPEED, options=options, progress=progress)


def wavelength(result: wf.Result) -> float:
    """Of a run that began in the middle of the track and returned there [m]."""
    x, y = result.body("wheelset").position[:, :2].T
    i = int(np.flatnonzero(y > 0.0)[-1])
    return float(2.0 * (x[i] - y[i] * (x[i + 1] - x[i]) / (y[i + 1] - y[i])))


def hertz_peak(contact: wf.ContactResult, i: int) -> float:
    """Largest pressure [Pa] of Hertz's ellipse for load and radii of a saved row."""
    return hertz_point(float(contact.normal_load[i]), contact.curvature(i), contact.effective_modulus).peak_pressure


def panels(result: wf.Result) -> list[Panel]:
    """Displacement, places of the patches on wheels and rails, largest pressures, forces, loss, over the distance."""
    x, y = result.body("wheelset").position[:, :2].T
    loaded = np.flatnonzero(result.time > RISE)
    off = loaded[y[loaded] > ONE_PLACE][:: len(x) // MARKS]
    wave_x, wave_y = rigid().wave(y.max())
    head, rail_at = wf.surfaces.rail_uic60(), rigid().rails["left"].surface.shape.axis_point[1]
    few = np.linspace(0, len(wave_y) - 1, MARKS + 1).astype(int)[1:-1]
    curves, points = [{} for _ in range(5)], [{} for _ in range(5)]
    for name, side in SIDES.items():
        contact, friction = result.contact(f"wheelset {name}"), result.contact(f"wheelset {name}").friction
        touch = np.array([rigid().touch(side, at, rigid().roll(at)) for at in wave_y[few]]).T
        s, rail = contact.center_of_pressure[:, 1], side * head.at(contact.second_place[:, 0])[:, 0]
        values = (1e3 * s, 1e3 * rail, 1e-6 * contact.peak_pressure, 1e-3 * friction.tangential_force[:, 1],
                  friction.power_per_metre)  # fmt: skip
        for of, value in zip(curves, values, strict=True):
            of[name] = x[loaded], value[loaded]
        points[0][f"rigid, {name}"] = wave_x[few], 1e3 * touch[2]
        points[1][f"rigid, {name}"] = wave_x[few], 1e3 * (side * touch[3] - rail_at)
        points[2][f"Hertz, {name}"] = x[off], 1e-6 * np.array([hertz_peak(contact, i) for i in off])
    titles = {"Patch on the wheel, from the running circle": "[mm]", "Patch on the rail, from its middle": "[mm]",
              "Largest pressure": "[MPa]", "Creep force on the wheel to the field side": "[kN]",
              "Friction loss per metre": "[J/m]"}  # fmt: skip
    along, way = "distance [m]", {"wheelset": (x, 1e3 * y)}
    first = Panel("Displacement to the left", along, "[mm]", way, {"rolling without slip": (wave_x, 1e3 * wave_y)})
    rest = zip(titles.items(), curves, points, strict=True)
    return [first, *(Panel(title, along, unit, of, points=at) for (title, unit), of, at in rest)]


def main(out: str | Path = "out/wheelset", *, quick: bool = False, progress: bool = True) -> wf.Result:
    """Write wheelset.h5, .rrd and .png into the folder `out` and print the figures; quick: coarser."""
    stem, result = Path(out) / "wheelset", run(QUICK if quick else FULL, progress)
    y = result.body("wheelset").position[:, 1]
    top, found, rolls = int(np.argmax(y)), wavelength(result), 2.0 * rigid().wave(y.max())[0][-1]
    print(f"wave of {1e3 * y[top]:.3f} mm: {found:.3f} m, rolling without slip {rolls:.3f}: {found / rolls - 1.0:+.1%}")
    for name, side in SIDES.items():
        contact, s = result.contact(f"wheelset {name}"), rigid().touch(side, y[top], rigid().roll(y[top]))[2]
        print(f"{name:5} wheel  {1e3 * contact.center_of_pressure[top, 1]:+6.2f} mm from the running circle, rigid "
              f"{1e3 * s:+6.2f}; {contact.peak_pressure[top] / 1e6:6.1f} MPa, "
              f"Hertz {hertz_peak(contact, top) / 1e6:6.1f}")  # fmt: skip
    result.save(f"{stem}.h5", overwrite=True)
    wf.record(result, f"{stem}.rrd", max_frames=60 if quick else 240, overwrite=True)
    save_panels(panels(result), f"{stem}.png", overwrite=True)
    return result


if __name__ == "__main__":
    main()
