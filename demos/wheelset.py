r"""A free wheelset hunts on its track: wheels S1002 on rails UIC 60 inclined by 1:40, gauge 1,435 mm, all elastic.

A wheelset that is displaced towards the left rail rolls on a larger radius there than on the right one, and steers
back: while it runs along it oscillates sideways and in yaw. Here it starts in the middle of the track, yawed to the
left, and rolls for half a wave. Nothing guides it but its rails.

**Kinematics.** With the displacement y and the yaw psi of the wheelset, the rolling radii r_l and r_r and the positions
y_l and y_r of its contacts across the track, and the roll phi(y) with which both wheels touch, rolling without slip
means

    dy/dx = psi/(1 + r dphi/dy),      dpsi/dx = -(r_l - r_r)/(r (y_l - y_r)).

The profiles make r_l - r_r neither proportional to y nor smooth: 0.2 mm off the middle the place where the rigid left
wheel touches jumps by 10 mm towards its flange. So the wave becomes longer with its amplitude.

**What is modelled.** Wheels and rails are half-spaces under their patches, with friction, stick and slip in every cell.
The rows of cells are given, since near the middle of the track a patch covers both places at once.

**What to expect.** The patches move over instead of jumping, so that the wheelset steers later, runs further to the
side than a rigid one with the same yaw, and has a wave that is 2 % longer than a rigid one of the same amplitude. Where
a patch lies within zones of constant radii the largest pressure is Hertz's. The left contact is the steeper one,
and its normal force pushes the wheelset back by up to 4.5 kN; the spin of the patch causes a creep force that holds it.
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
from warpffrf.model import rotation
from warpffrf.output.contact.hertz import hertz_point
from warpffrf.output.plots.panels import Panel, save_panels

POISSON, SHEAR, FRICTION = 0.28, 82e9, 0.3  # -, Pa, -
STEEL = wf.Material(youngs_modulus=2.0 * SHEAR * (1.0 + POISSON), poisson_ratio=POISSON, density=7850, name="steel")
RADIUS, RUNNING_CIRCLE, GAUGE, GAUGE_DEPTH = 0.46, 0.75, 1.435, 14e-3  # m; the circle from the middle of the axle
INCLINATION = 40.0  # of the rails, 1:40
MASS, INERTIA, LOAD = 1200.0, (700.0, 100.0, 700.0), 100e3  # kg, kg m2, N with the weight
SPEED, YAW, RISE = 10.0, 2.4e-3, 0.1  # m/s, rad at the start, s in which the load rises
SIDES = {"left": 1, "right": -1}
# m from the running circle: boundaries of cells along the profile, shorter where patches are
ROWS = 1e-3 * np.concatenate(
    [np.linspace(-20.0, -17.0, 4)[:-1], np.linspace(-17.0, -2.0, 26), np.linspace(-0.8, 17.2, 16)]
)
RAIL = (-0.3, 0.3)  # m, of the rails beyond the way
SAMPLES = 20001  # of a profile
ONE_PLACE, MARKS = 1.5e-3, 24  # m, the displacement from which each wheel touches in one place; points of a picture
LONGEST, SAMPLE = 20.0, 0.02  # m, of the kinematics: the longest quarter of a wave, the longest step


@dataclass(frozen=True)
class Size:
    """Strips of cells along the track; of `ROWS` each `every`th boundary; way per step and in all [m]; steps per saved
    row."""

    strips: int = 9
    every: int = 1
    step: float = 2.5e-3
    way: float = 4.8
    save_every: int = 4


FULL, QUICK = Size(), Size(strips=7, every=2, step=10e-3, way=4.8, save_every=2)


def profile(side: int) -> wf.surfaces.ProfiledCylinder:
    """A wheel; `side`: 1 on the left, -1 on the right."""
    return wf.surfaces.wheel_s1002(radius=RADIUS, axis_point=(0, side * RUNNING_CIRCLE, 0), axis_direction=(0, side, 0))


@dataclass(frozen=True, eq=False)
class Profiles:
    """The wheel: R (n,) at s (n,) [m] along the axis from the running circle. The left rail's head: z over y (n,) [m]
    across the track, its top at z = 0, and the `origin` (y, z) of its curve."""

    s: np.ndarray
    R: np.ndarray
    y: np.ndarray
    z: np.ndarray
    origin: tuple[float, float]


@cache
def profiles() -> Profiles:
    """Wheel and rail as rigid bodies, sampled."""
    wheel, head = profile(1), wf.surfaces.rail_uic60()
    s = np.linspace(wheel.table[0, 0], wheel.table[0, -1], SAMPLES)
    e_x = np.array([INCLINATION, 1.0]) / np.hypot(INCLINATION, 1.0)
    y, z = (head.at(np.linspace(0.0, head.length, SAMPLES))[::-1] @ [e_x, [-e_x[1], e_x[0]]]).T
    top = int(np.argmax(z))
    y_0 = float(0.5 * GAUGE - np.interp(z[top] - GAUGE_DEPTH, z[:top], y[:top]))
    return Profiles(s, np.asarray(wheel.radius_at(s)), y + y_0, z - z[top], (y_0, -float(z[top])))


@dataclass(frozen=True)
class Touch:
    """Where a wheel touches its rail as a rigid body: the height [m] of the axle's middle, the rolling radius [m], and
    the place s [m] on the profile and y [m] across the track."""

    height: float
    radius: float
    s: float
    y: float


def across(side: int, y: np.ndarray | float, roll: np.ndarray | float, s: np.ndarray, R: np.ndarray) -> np.ndarray:
    """Distance [m] from the middle of the track, towards the field side, of places of a wheel."""
    return side * y + (RUNNING_CIRCLE + s) * np.cos(roll) + side * R * np.sin(roll)


def touch(side: int, y: float, roll: float) -> Touch:
    """The wheel of a wheelset at y [m] with the roll [rad], left wheel upwards."""
    found = profiles()
    place = across(side, y, roll, found.s, found.R)
    below = side * (RUNNING_CIRCLE + found.s) * np.sin(roll) - found.R * np.cos(roll)
    height = np.interp(place, found.y, found.z, left=-1.0, right=-1.0) - below
    i = int(np.argmax(height))
    return Touch(float(height[i]), float(found.R[i]), float(found.s[i]), float(side * place[i]))


def roll(y: float) -> float:
    """The roll [rad] with which both wheels touch."""

    def uneven(phi: float) -> float:
        return touch(1, y, phi).height - touch(-1, y, phi).height

    return float(brentq(uneven, -0.01, 0.01, xtol=1e-12))  # pyright: ignore[reportArgumentType]


def kinematics(amplitude: float) -> tuple[np.ndarray, np.ndarray]:
    """x and y (n,) [m] of half a wave of this amplitude [m] of rolling without slip, from the middle of the track."""
    y = np.linspace(0.0, amplitude, 46)
    phi = np.array([roll(at) for at in y])
    left, right = ([touch(side, at, p) for at, p in zip(y, phi, strict=True)] for side in (1, -1))
    steers = np.array([(a.radius - b.radius) / (a.y - b.y) for a, b in zip(left, right, strict=True)]) / RADIUS
    rolls = 1.0 + RADIUS * np.gradient(phi, y)

    def rates(_: float, state: np.ndarray) -> list[float]:
        return [state[1] / np.interp(state[0], y, rolls), -np.interp(state[0], y, steers)]

    def middle(_: float, state: np.ndarray) -> float:
        return state[0]

    middle.terminal = True  # pyright: ignore[reportFunctionMemberAccess]
    found = solve_ivp(rates, (0.0, LONGEST), [amplitude, 0.0], max_step=SAMPLE, events=middle)
    x, y = found.t, found.y[0]
    return np.concatenate([x[-1] - x[::-1], x[-1] + x[1:]]), np.concatenate([y[::-1], y[1:]])


def build(size: Size = FULL) -> wf.Scene:
    """The scene: bodies `wheelset`, `left_rail` and `right_rail`, contacts `left` and `right`, force `load`."""
    scene, shapes = wf.Scene(), {name: profile(side) for name, side in SIDES.items()}
    body = wf.half_space_body(MASS, INERTIA, STEEL, contact=shapes, free_ends=False)
    yawed, height = Rotation.from_euler("z", YAW), touch(1, 0.0, 0.0).height
    wheelset = scene.add_body(
        body, name="wheelset", position=(0, 0, height), rotation=yawed, velocity=yawed.apply((SPEED, 0, 0)),
        angular_velocity=yawed.apply((0, SPEED / RADIUS, 0)),
    )  # fmt: skip
    y, z = profiles().origin
    cells = (size.strips, ROWS[:: size.every])
    for name, side in SIDES.items():
        head = wf.surfaces.Extruded(
            curve=wf.surfaces.rail_uic60(), axis_point=(0, side * y, z), axis_direction=(1, 0, 0),
            x_direction=(0, INCLINATION, side),
        )  # fmt: skip
        limits = {"head": (RAIL[0], RAIL[1] + size.way)}
        half_space = wf.half_space_body(
            1.0, (1.0, 1.0, 1.0), STEEL, contact={"head": head}, extent=limits, free_ends=False
        )
        rail = scene.add_body(half_space, name=f"{name}_rail")
        scene.add(wf.joints.Fixed(scene.ground, rail["center"]))
        scene.add(wf.Contact(wheelset[name], rail["head"], friction=FRICTION, cells=cells, name=name))
    rising = wf.signals.SmoothStep(0.0, -LOAD, duration=RISE)
    scene.add(wf.forces.PointForce(wheelset["center"], (0, 0, rising), name="load"))
    return scene


def run(size: Size = FULL, progress: bool = True) -> wf.Result:
    """The way of this `size`."""
    options = wf.RunOptions(integrator=wf.integrators.GeneralizedAlpha(0.5), save_every=size.save_every)
    return wf.simulate(build(size), size.way / SPEED, step=size.step / SPEED, options=options, progress=progress)


@dataclass(frozen=True, eq=False)
class Way:
    """A run's distance x and displacement y (n,) [m], the roll (n,) [rad], the wavelength [m] and the amplitude [m]."""

    x: np.ndarray
    y: np.ndarray
    roll: np.ndarray
    wavelength: float
    amplitude: float


def way(result: wf.Result) -> Way:
    """Of a run that began in the middle of the track, and returned there."""
    motion = result.body("wheelset")
    x, y = motion.position[:, :2].T
    i = int(np.flatnonzero(y > 0.0)[-1])
    half = x[i] - y[i] * (x[i + 1] - x[i]) / (y[i + 1] - y[i])
    axles = np.array([rotation.matrix(q)[:, 1] for q in motion.rotation])
    return Way(x, y, axles[:, 2], float(2.0 * half), float(y.max()))


def hertz_peak(contact: wf.ContactResult, i: int) -> float:
    """Largest pressure [Pa] of Hertz's ellipse for load and radii of a saved row."""
    return hertz_point(float(contact.normal_load[i]), contact.curvature(i), contact.effective_modulus).peak_pressure


def panels(result: wf.Result) -> list[Panel]:
    """Displacement, places of the patches on wheels and rails, largest pressures, forces, loss, over the distance."""
    found, origin = way(result), profiles().origin[0]
    loaded = np.flatnonzero(result.time > RISE)
    off = loaded[found.y[loaded] > ONE_PLACE]
    off = off[:: max(1, len(off) // MARKS)]
    wave_x, wave_y = kinematics(found.amplitude)
    few = np.linspace(0, len(wave_y) - 1, MARKS + 1).astype(int)[1:-1]
    curves: dict[str, dict] = {name: {} for name in ("wheel", "rail", "pressure", "force", "loss")}
    rigid: dict[str, dict] = {"wheel": {}, "rail": {}}
    hertz = {}
    for name, side in SIDES.items():
        contact = result.contact(name)
        s = contact.center_of_pressure[:, 1]
        rail = across(side, found.y, found.roll, s, np.interp(s, profiles().s, profiles().R)) - origin
        creep = contact.friction
        values = {"wheel": 1e3 * s, "rail": 1e3 * rail, "pressure": 1e-6 * contact.peak_pressure,
                  "force": 1e-3 * creep.tangential_force[:, 1], "loss": creep.power_per_metre}  # fmt: skip
        for key, value in values.items():
            curves[key][name] = found.x[loaded], value[loaded]
        touches = [touch(side, y, roll(y)) for y in wave_y[few]]
        rigid["wheel"][f"rigid, {name}"] = wave_x[few], 1e3 * np.array([at.s for at in touches])
        rigid["rail"][f"rigid, {name}"] = wave_x[few], 1e3 * np.array([side * at.y - origin for at in touches])
        hertz[f"Hertz, {name}"] = found.x[off], 1e-6 * np.array([hertz_peak(contact, i) for i in off])
    along = "distance [m]"
    moved = {"wheelset": (found.x, 1e3 * found.y)}
    rolls = {"rolling without slip": (wave_x, 1e3 * wave_y)}
    return [
        Panel("Displacement to the left", along, "[mm]", moved, reference=rolls),
        Panel("Patch on the wheel, from the running circle", along, "[mm]", curves["wheel"], points=rigid["wheel"]),
        Panel("Patch on the rail, from its middle", along, "[mm]", curves["rail"], points=rigid["rail"]),
        Panel("Largest pressure", along, "[MPa]", curves["pressure"], points=hertz),
        Panel("Creep force on the wheel to the field side", along, "[kN]", curves["force"]),
        Panel("Friction loss per metre", along, "[J/m]", curves["loss"]),
    ]


def main(out: str | Path = "out/wheelset", *, quick: bool = False, progress: bool = True) -> wf.Result:
    """Write wheelset.h5, .rrd and .png into the folder `out` and print the figures; quick: coarser."""
    stem = Path(out) / "wheelset"
    result = run(QUICK if quick else FULL, progress)
    found = way(result)
    top, rolls = int(np.argmax(found.y)), 2.0 * kinematics(found.amplitude)[0][-1]
    print(f"amplitude   {1e3 * found.amplitude:.3f} mm")
    print(
        f"wavelength  {found.wavelength:.3f} m, rolling without slip {rolls:.3f}: {found.wavelength / rolls - 1.0:+.1%}"
    )
    for name, side in SIDES.items():
        contact, rigid = result.contact(name), touch(side, found.y[top], roll(found.y[top]))
        print(f"{name:5} wheel  {1e3 * contact.center_of_pressure[top, 1]:+6.2f} mm from the running circle, rigid "
              f"{1e3 * rigid.s:+6.2f}; {contact.peak_pressure[top] / 1e6:6.1f} MPa, "
              f"Hertz {hertz_peak(contact, top) / 1e6:6.1f}")  # fmt: skip
    result.save(f"{stem}.h5", overwrite=True)
    wf.record(result, f"{stem}.rrd", max_frames=60 if quick else 240, overwrite=True)
    save_panels(panels(result), f"{stem}.png", overwrite=True)
    return result


if __name__ == "__main__":
    main()
