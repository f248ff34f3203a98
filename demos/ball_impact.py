r"""A steel ball hits a steel half-space: Hertz's impact.

A ball of 10 mm radius arrives with 0.1 m/s. Of two like bodies one may stand for both: this one has half the modulus of
steel and hits a rigid plane, so that 1/E* = 2 (1 - nu^2)/E is that of steel on steel. It has no vibration modes and
its local modes are quasi-static: rigid but for the contact, as Hertz has it. (The lowest vibration of a steel ball of
this size has a twentieth of the time of the impact.)

What to expect, with K = (4/3) E* sqrt(R),

    delta_max = (5 m v^2/(4 K))^(2/5),    F_max = K delta_max^(3/2),    T = (4/5) B(2/5, 1/2) delta_max/v

(K. L. Johnson, Contact Mechanics, 1985, section 11.4), the impulse 2 m v, and the speed of arrival again at the end.
A half-space behind the patch leaves out what the rest of the ball adds to the approach, of order a/R = 2 %.
"""

from __future__ import annotations

import logging
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

import warpffrf as wf
from demos.checks import Check, finish, writable_folder
from references.closed_forms import HertzImpact, PointContact, contact_modulus

log = logging.getLogger("warpffrf")

STEEL = wf.Material(youngs_modulus=210e9, poisson_ratio=0.3, density=7800, name="steel")
FOR_BOTH = replace(STEEL, youngs_modulus=0.5 * STEEL.youngs_modulus, name="steel on steel")
RADIUS, SPEED = 0.01, 0.1  # m, m/s
IMPACT = HertzImpact(RADIUS, contact_modulus(STEEL, STEEL), STEEL.density * 4.0 / 3.0 * np.pi * RADIUS**3, SPEED)
WIDEST = PointContact(IMPACT.force, RADIUS, IMPACT.modulus).half_width  # m, of the patch
PATCH = (1.6, 1.3)  # half-widths of the fine patch over the widest: around and along; the window ends inside it
GAP = 1e-6  # m, at the start
STEPS = 160  # in Hertz's contact time
SPAN = 1.3  # contact times in a run
DOWN_ON_PLANE = (0.0, np.sqrt(0.5), 0.0, np.sqrt(0.5))  # turns the patch of the mesh, around +x, to -z
PAIR = "ball-plane"
HERTZ = 0.02  # of force and time: a/R, and five nodes in the widest half-width
KEPT = 2e-3  # of momentum and speed: what the cells of the contact grid and the steps take


@dataclass(frozen=True)
class Size:
    """Quadratic cells in the widest half-width, and how many frames the recording shows at most."""

    cells: float = 2.0
    frames: int = 100


FULL, QUICK = Size(), Size(cells=1.0, frames=30)


def build(size: Size = FULL, *, progress: bool = True) -> wf.Scene:
    """The scene: body `ball`, which moves freely, and contact pair `ball-plane`."""
    mesh = wf.mesh.ball(RADIUS, patch_half_width=(PATCH[0] * WIDEST, PATCH[1] * WIDEST), cell=WIDEST / size.cells)
    reduced = wf.reduce(mesh, FOR_BOTH, contact={"patch": wf.surfaces.Sphere()}, modes=0, progress=progress)
    scene = wf.Scene()
    ball = scene.add_body(
        reduced, name="ball", position=(0, 0, RADIUS + GAP), rotation=DOWN_ON_PLANE, velocity=(0, 0, -SPEED)
    )
    plane = wf.surfaces.Plane(origin=(0, 0, 0), outward=(0, 0, 1))
    scene.add(wf.Contact(ball["patch"], scene.ground.surface(plane, name="plane"), name=PAIR))
    return scene


def run(scene: wf.Scene, *, progress: bool = True) -> wf.Result:
    """From before the touch until after the ball has left."""
    step = IMPACT.duration / STEPS
    return wf.simulate(scene, GAP / SPEED + SPAN * IMPACT.duration, step=step, progress=progress)


def contact_time(result: wf.Result) -> float:
    """Time from touch to separation [s]; NaN where the ball does not leave.

    F^(2/3) is proportional to the approach, which is nearly linear in time at both ends: each is where the line through
    the two outermost values above zero meets zero.
    """
    force = result.contact(PAIR).normal_load
    touching = np.flatnonzero(force > 0.0)
    if len(touching) < 4 or touching[-1] == len(force) - 1:
        return float("nan")
    ends = []
    for i, j in ((touching[0], touching[1]), (touching[-1], touching[-2])):
        (t, u), (f, g) = result.time[[i, j]], force[[i, j]] ** (2.0 / 3.0)
        ends.append(t - f * (u - t) / (g - f))
    return float(ends[1] - ends[0])


def checks(result: wf.Result) -> list[Check]:
    """The figures of a run."""
    pair, motion = result.contact(PAIR), result.body("ball")
    scene_mass = float(result.history.scene.body("ball").mass)  # pyright: ignore[reportAttributeAccessIssue]
    impulse = scene_mass * float(motion.velocity[-1, 2] - motion.velocity[0, 2])
    area = float(np.trapezoid(pair.force[:, 2], result.time))
    return [
        Check("largest force", float(pair.normal_load.max()), IMPACT.force, "Hertz", HERTZ, "N"),
        Check("time of contact", contact_time(result), IMPACT.duration, "Hertz", HERTZ, "us", 1e6),
        Check("largest approach", float(pair.approach.max()), IMPACT.approach, "Hertz", HERTZ, "um", 1e6),
        Check("force over time", area, IMPACT.impulse, "2 m v", KEPT, "mN s", 1e3),
        Check("momentum gained", impulse, area, "force over time", KEPT, "mN s", 1e3),
        Check("speed after over before", -float(motion.velocity[-1, 2] / motion.velocity[0, 2]), 1.0,
              "no vibration", KEPT),
    ]  # fmt: skip


def panels(result: wf.Result) -> list:
    """Force, height and energies over time, pressure at the largest force."""
    from warpffrf.output.plots.panels import Panel

    pair, t = result.contact(PAIR), result.time * 1e6
    i = int(np.argmax(pair.normal_load))
    hertz = PointContact(float(pair.normal_load[i]), RADIUS, IMPACT.modulus)
    x = np.linspace(-1.3 * WIDEST, 1.3 * WIDEST, 201)
    height = (result.body("ball").position[:, 2] - RADIUS) * 1e6
    lines = {name: (t, result.energy[name] * 1e6) for name in ("kinetic", "contact")}
    peak = {"Hertz, largest": (np.array([t[i]]), np.array([IMPACT.force]))}
    return [
        Panel("Force", "time [us]", "[N]", {"force": (t, pair.normal_load)}, peak),
        Panel("Height of the lowest point, undeformed", "time [us]", "[um]", {"height": (t, height)},
              {"Hertz, lowest": (np.array([t[i]]), np.array([-IMPACT.approach * 1e6]))}),
        Panel("Energies", "time [us]", "[uJ]", lines),
        Panel("Pressure at the largest force", "arc [mm]", "[MPa]",
              {"pressure": (pair.arc[i] * 1e3, pair.mid_pressure[i] / 1e6)},
              {"Hertz": (x * 1e3, hertz.pressure(x) / 1e6)}),
    ]  # fmt: skip


def main(out: str | Path = "out/ball_impact", *, quick: bool = False, progress: bool = True) -> int:
    """Run the demo and write ball_impact.h5, .rrd, .png and summary.json into the folder `out`; 0 when all went well.

    quick: larger cells. Raises `InputError` for a folder that cannot be written.
    """
    folder = writable_folder(out)
    size = QUICK if quick else FULL
    log.info("ball impact: %g m/s, %g quadratic cells in the widest half-width", SPEED, size.cells)
    result = run(build(size, progress=progress), progress=progress)
    if result.status != "completed":
        log.error("the run ended early, %s: %s", result.status, result.message)
        return 1
    return finish(folder / "ball_impact", {"run": result}, checks(result), panels(result), frames=size.frames)
