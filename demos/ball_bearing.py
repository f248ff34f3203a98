r"""A whole ball bearing under a radial load: at rest, then its inner ring turns, balls and cage driven by friction.

A 209 deep-groove bearing (Harris, Rolling Bearing Analysis): nine balls between rigid rings with 15 um of diametral
clearance, 8.9 kN across. The inner ring turns at 1,500 rpm; friction on the raceways makes the balls roll, and these
carry the cage along, a body with a pocket for each.

**Loads.** A ball at the angle phi from the load is pressed by the shift (x, z) of the inner ring together by

    delta = z cos phi + x sin phi - s/2,        Q = c_P delta^1.5,

c_P of both contacts in series, by Hertz's formulas in complete elliptic integrals; x and z balance the load for every
place of the cage, as inertia has no say at this speed beside the centrifugal force of a ball, 1.1 N. At rest, with a
ball under the load, loads and pressures are also published. As balls pass, the ring follows. What the equations leave
out is the cage, which the raceways press loaded balls against, on either side of the load, with some 10 N.

**Speeds.** Rolling without slip at the contact angle 0, gamma = D/d, has the cage turn with w (1 - gamma)/2, and a ball
against it with w d/(2 D) (1 - gamma^2), the other way round; only loaded balls are held to it.

**Losses.** Friction here is that of slip where balls and rings touch in a point, nearly none where they roll. A real
bearing has most of its friction from slip within the patch, from hysteresis and from oil.
"""

from __future__ import annotations

import logging
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

import warpffrf as wf
from demos.checks import Check, finish, writable_folder
from references.closed_forms.ball_bearing import BallBearing
from warpffrf.output.plots.panels import Panel, Polar

log = logging.getLogger("warpffrf")

STEEL = wf.Material(youngs_modulus=206e9, poisson_ratio=0.3, density=7850, name="steel")
COUNT, BALL, PITCH, GROOVE = 9, 12.7e-3, 64.9985e-3, 6.6e-3  # balls; m: diameters, radius of the grooves
CLEARANCE, LOAD, SPEED = 15e-6, 8900.0, 1500.0 * np.pi / 30.0  # m, N, rad/s
PLAY, TRACTION = 0.1e-3, wf.laws.RegularisedCoulomb(0.06, 0.01)  # m of a ball in its pocket
DAMPING = 1.0  # s/m of the contacts
NAME = "209"
GAMMA = BALL / PITCH
CAGE = 0.5 * SPEED * (1.0 - GAMMA)  # rad/s
ROLLING = 0.5 * SPEED / GAMMA * (1.0 - GAMMA**2)  # rad/s, against the cage
PASSAGE = 2.0 * np.pi / (COUNT * CAGE)  # s, of a ball after a ball
PUBLISHED = 1e-2  # of loads, deflection and pressures
LOADS, FOLLOWS, SPEEDS = 5e-3, 5e-3, 1e-2  # of the largest load: pockets push too; of the deflection; of the speeds
CENTRIFUGAL = 0.02  # of a ball's: 1 N beside 4.5 kN
LEDGER = 1e-2  # of the energy at hand
HEAVY = 0.1  # of the largest load: balls that are held to rolling
ALONE = 0.1  # N: what a pocket may push, whose cup presses balls inwards, where centrifugal forces are compared


@dataclass(frozen=True)
class Size:
    """Passages of a ball, steps of one, frames of the recording."""

    passages: int = 4
    steps: int = 400
    frames: int = 240


FULL, QUICK = Size(), Size(passages=1, frames=60)
SETTLING = 1.0 / 3.0  # of the run


def build() -> wf.Scene:
    """The scene: bearing `209` with its outer ring the ground, joint `plane`, drive `drive`, force `load`."""
    scene = wf.Scene()
    bearing = scene.add_ball_bearing(
        NAME, elements=COUNT, ball_diameter=BALL, pitch_diameter=PITCH, osculation=GROOVE / BALL, clearance=CLEARANCE,
        first=(0, 0, -1), outer=scene.ground, cage=wf.bearings.PocketCage(PLAY, friction=TRACTION), friction=TRACTION,
        law=wf.laws.HertzPoint(STEEL, STEEL, damping=DAMPING), material=STEEL,
    )  # fmt: skip
    shaft: Any = bearing.inner
    plane = scene.add(wf.joints.Planar(scene.ground.at((0, 0, 0)), shaft.at((0, 0, 0)), axis=(0, 1, 0), name="plane"))
    scene.add(wf.joints.Drive(plane, SPEED, name="drive"))
    scene.add(wf.forces.PointForce(shaft.at((0, 0, 0)), (0, 0, -LOAD), name="load"))
    bearing.roll(SPEED, angle=0.0)
    return scene


def run(size: Size, *, progress: bool = True) -> wf.Result:
    """From the static state, rolling."""
    duration = size.passages * PASSAGE
    return wf.simulate(build(), duration, step=PASSAGE / size.steps, start="equilibrium", progress=progress)


def by_the_equations(phi: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Of balls at `phi` (T, Z) [rad] from the load: loads (T, Z) [N], and the shift of the ring along the load (T,)
    [m]. Raises RuntimeError where it fails."""
    stiffness = BallBearing(COUNT, BALL, PITCH, GROOVE, GROOVE, CLEARANCE, 206e9).stiffness
    loads, shifts, shift = [], [], np.array([60e-6, 0.0])
    for angles in phi:
        toward = np.stack([np.cos(angles), np.sin(angles)])
        for _ in range(40):  # Newton's method
            root = np.sqrt(np.maximum(shift @ toward - 0.5 * CLEARANCE, 0.0))
            lacking = toward @ (stiffness * root**3) - np.array([LOAD, 0.0])
            if np.abs(lacking).max() < 1e-9 * LOAD:
                break
            shift = shift - np.linalg.solve(1.5 * stiffness * (toward * root) @ toward.T, lacking)
        else:
            raise RuntimeError("the equations of the ball bearing were not solved")
        loads.append(stiffness * root**3)
        shifts.append(shift[0])
    return np.array(loads), np.array(shifts)


def checks(result: wf.Result) -> list[Check]:
    """At rest beside what is published, then the last two thirds of the run beside equations and kinematics."""
    found, rest = result.bearing(NAME), "published"
    Q, peaks = found.outer_load[0], (found.inner_patches.peak_pressure[0], found.outer_patches.peak_pressure[0])
    rows = np.flatnonzero(result.time > SETTLING * result.time[-1])
    exact, shift = by_the_equations(found.angle[rows])
    inner, outer = found.inner_load[rows], found.outer_load[rows]
    loaded = exact > HEAVY * exact.max()
    alone = loaded & (np.abs(found.cage_force[rows]) < ALONE)
    thrown = result.scene.body(f"{NAME} ball 1").mass * 0.5 * PITCH * found.orbit_speed[rows] ** 2
    cage = result.body(f"{NAME} cage").angular_velocity[rows, 1]
    against = (found.spin[rows][..., 2] - cage[:, None])[loaded]
    power = np.sum([each.sum(axis=1) for each in found.friction_power.values()], axis=0)
    work = result.energy["friction"][-1]
    equations, kinematics = "equations of ISO/TS 16281", "rolling without slip"
    return [
        Check("at rest: ball under the load", float(Q[0]), 4527.0, rest, PUBLISHED, "N"),
        Check("at rest: the next one", float(Q[1]), 2841.0, rest, PUBLISHED, "N"),
        Check("at rest: deflection", float(found.displacement[0, 0]), 60.5e-6, rest, PUBLISHED, "um", 1e6),
        Check("at rest: peak pressure, inner ring", float(peaks[0][0]), 3072e6, rest, PUBLISHED, "MPa", 1e-6),
        Check("at rest: peak pressure, outer ring", float(peaks[1][0]), 2567e6, rest, PUBLISHED, "MPa", 1e-6),
        Check("turning: loads of all balls off by", float(np.abs(inner - exact).max()), 0.0, equations, LOADS, "N",
              scale=float(exact.max())),
        Check("turning: mean deflection", float(found.displacement[rows, 0].mean()), float(shift.mean()), equations,
              FOLLOWS, "um", 1e6),
        Check("turning: outer load less inner", float((outer - inner)[alone].mean()), float(thrown[alone].mean()),
              "centrifugal force", CENTRIFUGAL, "N"),
        Check("turning: speed of the cage", float(cage.mean()), CAGE, kinematics, SPEEDS, "rad/s"),
        Check("turning: loaded balls against it", float(against.mean()), -ROLLING, kinematics, SPEEDS, "rad/s"),
        Check("friction: power summed", -float(np.trapezoid(power, result.time)), float(work), "energy ledger", 0.1,
              "mJ", 1e3),
        Check("energy lacking", float(np.ptp(result.energy_residual)), 0.0, "energy ledger", LEDGER, scale=1.0),
    ]  # fmt: skip


def panels(result: wf.Result) -> list:
    """The load zone, the loads of a ball as it goes around, the ring, and the cage."""
    found, t = result.bearing(NAME), result.time * 1e3
    around = np.linspace(-np.pi, np.pi, 181)
    exact, _ = by_the_equations(found.angle[:1])
    each = 20
    loads, shift = by_the_equations(found.angle[::each])
    order = np.argsort(found.angle, axis=None)
    phi, Q = found.angle.ravel()[order], found.outer_load.ravel()[order]
    closed = np.append(found.angle[0], found.angle[0, 0])
    first = by_the_equations(around[:, None] + 2.0 * np.pi * np.arange(COUNT) / COUNT)[0][:, 0]
    cage = result.body(f"{NAME} cage").angular_velocity[:, 1]
    orbits = found.orbit_speed.copy()
    orbits[found.inner_load < HEAVY * found.inner_load.max()] = np.nan
    return [
        Polar("Load zone at rest", "angle", "[kN]",
              {"inner ring": (closed, np.append(found.inner_load[0], found.inner_load[0, 0]) / 1e3),
               "outer ring": (closed, np.append(found.outer_load[0], found.outer_load[0, 0]) / 1e3)},
              points={"equations": (found.angle[0], exact[0] / 1e3)}),
        Panel("Loads on the outer ring, all balls, all steps", "angle from the load [deg]", "[kN]",
              {"run": (np.degrees(phi), Q / 1e3)}, {"equations": (np.degrees(around), first / 1e3)}),
        Panel("The inner ring along the load", "time [ms]", "[um]", {"run": (t, found.displacement[:, 0] * 1e6)},
              {"equations, place by place": (t[::each], shift * 1e6)}),
        Panel("Speeds over those of rolling, less 1", "time [ms]", "[%]",
              {"cage": (t, 100.0 * (cage / CAGE - 1.0)),
               "loaded balls, mean": (t, 100.0 * (np.nanmean(orbits, axis=1) / CAGE - 1.0))}),
        Panel("Loads on the outer ring", "time [ms]", "[kN]", {"balls": _in_one(t, found.outer_load / 1e3)},
              {"equations": _in_one(t[::each], loads / 1e3)}),
        Panel("Forces of the cage on balls", "time [ms]", "[N]", {"balls": _in_one(t, found.cage_force)}),
    ]  # fmt: skip


def _in_one(t: np.ndarray, columns: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Columns (T, n) over t (T,) as one curve with gaps."""
    gap = np.full((1, columns.shape[1]), np.nan)
    return np.tile(np.append(t, np.nan), columns.shape[1]), np.concatenate([columns, gap]).T.ravel()


def main(out: str | Path = "out/ball_bearing", *, quick: bool = False, progress: bool = True) -> int:
    """Run the demo and write ball_bearing.h5, .rrd, .png and summary.json into the folder `out`; 0 when all went well.

    quick: fewer passages. Raises `InputError` for a folder that cannot be written.
    """
    folder = writable_folder(out)
    size = QUICK if quick else FULL
    log.info("ball bearing: %g N, %g rpm, %d passages of a ball", LOAD, SPEED * 30.0 / np.pi, size.passages)
    result = run(size, progress=progress)
    if result.status != "completed":
        log.error("the run ended early, %s: %s", result.status, result.message)
        return 1
    log.info(result.bearing(NAME).report())
    return finish(folder / "ball_bearing", {"run": result}, checks(result), panels(result), frames=size.frames)
