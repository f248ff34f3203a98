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

import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import brentq
from scipy.spatial.transform import Rotation

import warpffrf as wf
from warpffrf.output.contact.hertz import hertz_point
from warpffrf.output.plots.panels import Panel, save_panels

POISSON, SHEAR, FRICTION = 0.28, 82e9, 0.3  # -, Pa, -
STEEL = wf.Material(youngs_modulus=2.0 * SHEAR * (1.0 + POISSON), poisson_ratio=POISSON, density=7850, name="steel")
RADIUS, RUNNING_CIRCLE, GAUGE, GAUGE_DEPTH = 0.46, 0.75, 1.435, 14e-3  # m; the circle from the middle of the axle
MASS, INERTIA, LOAD, INCLINATION = 1200.0, (700.0, 100.0, 700.0), 100e3, 40.0  # kg, kg m2, N with the weight; 1:40
SPEED, YAW, WAY, RISE = 10.0, 2.4e-3, 4.8, 0.1  # m/s, rad at the start, m, s in which the load rises
SIDES = {"left": 1, "right": -1}
# m from the running circle: boundaries of cells along the profile, shorter where patches are
ROWS = 1e-3 * np.concatenate([[-20.0, -19.0, -18.0], np.linspace(-17.0, -2.0, 26), np.linspace(-0.8, 17.2, 16)])
SAMPLES, AWAY = 20001, 0.02  # of a profile; m, longest step of the kinematics
ONE_PLACE, MARKS = 1.5e-3, 24  # m, the displacement from which each wheel touches in one place; points of a picture


@dataclass(frozen=True)
class Size:
    """Strips of cells along the track; each `every`th of `ROWS`; way per step [m]; steps per saved row."""

    strips: int = 9
    every: int = 1
    step: float = 2.5e-3
    save_every: int = 4


FULL, QUICK = Size(), Size(strips=7, every=2, step=10e-3, save_every=2)


def profile(side: int) -> wf.surfaces.ProfiledCylinder:
    """A wheel; `side`: 1 on the left, -1 on the right."""
    return wf.surfaces.wheel_s1002(radius=RADIUS, axis_point=(0, side * RUNNING_CIRCLE, 0), axis_direction=(0, side, 0))


@cache
def profiles() -> tuple[np.ndarray, ...]:
    """s and R (n,) [m] of a wheel; y and z (n,) [m] of the left rail, its top at 0; the origin (2,) of its curve."""
    wheel, head = profile(1), wf.surfaces.rail_uic60()
    s = np.linspace(wheel.table[0, 0], wheel.table[0, -1], SAMPLES)
    e_x = np.array([INCLINATION, 1.0]) / np.hypot(INCLINATION, 1.0)
    y, z = (head.at(np.linspace(0.0, head.length, SAMPLES))[::-1] @ [e_x, [-e_x[1], e_x[0]]]).T
    top = int(np.argmax(z))
    origin = np.array([0.5 * GAUGE - np.interp(z[top] - GAUGE_DEPTH, z[:top], y[:top]), -z[top]])
    return s, np.asarray(wheel.radius_at(s)), y + origin[0], z + origin[1], origin


def touch(side: int, y: float, roll: float) -> np.ndarray:
    """Where a rigid wheel touches its rail (4,) [m], the wheelset at y [m] with the roll [rad], left wheel upwards:
    height of the axle's middle, rolling radius, s along the profile, y across the track."""
    s, R, rail_y, rail_z, _ = profiles()
    place = side * y + (RUNNING_CIRCLE + s) * np.cos(roll) + side * R * np.sin(roll)
    below = side * (RUNNING_CIRCLE + s) * np.sin(roll) - R * np.cos(roll)
    height = np.interp(place, rail_y, rail_z, left=-1.0, right=-1.0) - below
    i = int(np.argmax(height))
    return np.array([height[i], R[i], s[i], side * place[i]])


def roll(y: float) -> float:
    """The roll [rad] with which both wheels touch."""
    return brentq(lambda phi: touch(1, y, phi)[0] - touch(-1, y, phi)[0], -0.01, 0.01, xtol=1e-12)  # pyright: ignore


def kinematics(amplitude: float) -> tuple[np.ndarray, np.ndarray]:
    """x and y (n,) [m] of half a wave of this amplitude [m] of rolling without slip, from the middle of the track."""
    y = np.linspace(0.0, amplitude, 46)
    phi = [roll(at) for at in y]
    _, radii, _, apart = np.array([touch(1, *at) - touch(-1, *at) for at in zip(y, phi, strict=True)]).T
    rolls = 1.0 + RADIUS * np.gradient(phi, y)

    def rates(_: float, state: np.ndarray) -> list[float]:
        return [state[1] / np.interp(state[0], y, rolls), -np.interp(state[0], y, radii / apart) / RADIUS]

    found = solve_ivp(rates, (0.0, 20.0), [amplitude, 0.0], max_step=AWAY, events=lambda _, state: state[0])
    end = found.t_events[0][0]
    x, down = np.append(found.t[found.t < end], end), np.append(found.y[0][found.t < end], 0.0)
    return np.concatenate([end - x[::-1], end + x[1:]]), np.concatenate([down[::-1], down[1:]])


def build(size: Size = FULL) -> wf.Scene:
    """The scene: bodies `wheelset`, `left_rail` and `right_rail`, contacts `left` and `right`, force `load`."""
    scene, shapes = wf.Scene(), {name: profile(side) for name, side in SIDES.items()}
    body = wf.half_space_body(MASS, INERTIA, STEEL, contact=shapes, free_ends=False)
    yawed, height = Rotation.from_euler("z", YAW), touch(1, 0.0, 0.0)[0]
    wheelset = scene.add_body(
        body, name="wheelset", position=(0, 0, height), rotation=yawed, velocity=yawed.apply((SPEED, 0, 0)),
        angular_velocity=yawed.apply((0, SPEED / RADIUS, 0)),
    )  # fmt: skip
    y, z = profiles()[-1]
    cells = (size.strips, ROWS[:: size.every])
    for name, side in SIDES.items():
        curve, at, lean = wf.surfaces.rail_uic60(), (0, side * y, z), (0, INCLINATION, side)
        head = wf.surfaces.Extruded(curve=curve, axis_point=at, axis_direction=(1, 0, 0), x_direction=lean)
        extent = {"head": (-0.3, 0.3 + WAY)}
        iron = wf.half_space_body(1.0, (1, 1, 1), STEEL, contact={"head": head}, extent=extent, free_ends=False)
        rail = scene.add_body(iron, name=f"{name}_rail")
        scene.add(wf.joints.Fixed(scene.ground, rail["center"]))
        scene.add(wf.Contact(wheelset[name], rail["head"], friction=FRICTION, cells=cells, name=name))
    down = (0.0, 0.0, wf.signals.SmoothStep(0.0, -LOAD, duration=RISE))
    scene.add(wf.forces.PointForce(wheelset["center"], down, name="load"))
    return scene


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
    phi = Rotation.from_quat(result.body("wheelset").rotation).apply((0.0, 1.0, 0.0))[:, 2]
    loaded = np.flatnonzero(result.time > RISE)
    off = loaded[y[loaded] > ONE_PLACE][:: len(x) // MARKS]
    wave_x, wave_y = kinematics(y.max())
    few = np.linspace(0, len(wave_y) - 1, MARKS + 1).astype(int)[1:-1]
    curves, points = [{} for _ in range(5)], [{} for _ in range(5)]
    for name, side in SIDES.items():
        contact, friction = result.contact(name), result.contact(name).friction
        rigid = np.array([touch(side, at, roll(at)) for at in wave_y[few]]).T
        s = contact.center_of_pressure[:, 1]
        rail = side * y + RUNNING_CIRCLE + s + side * RADIUS * phi - profiles()[-1][0]
        values = (1e3 * s, 1e3 * rail, 1e-6 * contact.peak_pressure, 1e-3 * friction.tangential_force[:, 1],
                  friction.power_per_metre)  # fmt: skip
        for of, value in zip(curves, values, strict=True):
            of[name] = x[loaded], value[loaded]
        points[0][f"rigid, {name}"] = wave_x[few], 1e3 * rigid[2]
        points[1][f"rigid, {name}"] = wave_x[few], 1e3 * (side * rigid[3] - profiles()[-1][0])
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
    top, found, rolls = int(np.argmax(y)), wavelength(result), 2.0 * kinematics(y.max())[0][-1]
    print(f"wave of {1e3 * y[top]:.3f} mm: {found:.3f} m, rolling without slip {rolls:.3f}: {found / rolls - 1.0:+.1%}")
    for name, side in SIDES.items():
        contact, s = result.contact(name), touch(side, y[top], roll(y[top]))[2]
        print(f"{name:5} wheel  {1e3 * contact.center_of_pressure[top, 1]:+6.2f} mm from the running circle, rigid "
              f"{1e3 * s:+6.2f}; {contact.peak_pressure[top] / 1e6:6.1f} MPa, "
              f"Hertz {hertz_peak(contact, top) / 1e6:6.1f}")  # fmt: skip
    result.save(f"{stem}.h5", overwrite=True)
    wf.record(result, f"{stem}.rrd", max_frames=60 if quick else 240, overwrite=True)
    save_panels(panels(result), f"{stem}.png", overwrite=True)
    return result


if __name__ == "__main__":
    main()
