r"""A ball rolls in the groove of a ring: two bodies of a ball bearing.

A steel ball lies in the groove of a fixed outer ring. An arm that turns about the ring's axis carries a slide that
presses the ball outwards; the ball turns freely on the slide. At the start nothing moves. The arm is driven, and
friction in the groove makes the ball roll.

What to expect. The patch is Hertz's ellipse, long across the groove, with the relative radii

    1/R_x = 1/R - 1/R_o  along the groove,      1/R_y = 1/R - 1/R_g  across it

(ball R, bottom of the groove R_o, arc of the groove R_g, 1/E* = 2 (1 - nu^2)/E). On a circle of radius R_o - R about
the axis the centre moves with Omega (R_o - R); where the ball rolls, the point that touches is at rest, so that

    omega = -Omega (R_o - R)/R.

The groove is curved across: at a distance y from its middle the ball is by y^2/(2 R) thinner, and the patch cannot
roll everywhere at once. It slips one way in the middle and the other way at its ends (H. L. Heathcote, Proc. Inst.
Automobile Engineers 15, 1921), and the ball turns faster than that by about b^2/(10 R^2), the mean of y^2/(2 R^2) over
the pressure with the half-axis b across: by 0.13 % here. The speed of the arm adds the centrifugal force of ball and
slide to the load.
"""

from __future__ import annotations

import logging
from dataclasses import dataclass
from pathlib import Path

import numpy as np

import warpffrf as wf
from demos.checks import Check, finish, writable_folder
from references.closed_forms import contact_modulus
from references.closed_forms.elliptic import EllipticContact

log = logging.getLogger("warpffrf")

STEEL = wf.Material(youngs_modulus=210e9, poisson_ratio=0.3, density=7850, name="steel")
BALL, BALL_BORE, BALL_WIDTH = 0.006, 0.001, 0.008  # m: radius R, hole of the axle, width between its flat ends
BOTTOM, GROOVE, DEPTH = 0.03, 0.55 * 2.0 * BALL, 0.0015  # m: R_o, R_g, depth below the lands
RING_OUTSIDE, RING_WIDTH = 0.04, 0.012  # m
LOAD, FRICTION = 300.0, 0.1  # N, -
TREAD = 0.0022  # m, width of the finely meshed band on both
CARRIAGE_MASS, CARRIAGE_INERTIA = 0.1, (1e-4, 1e-4, 1e-4)  # kg, kg m2, of arm and slide
SPEED = 1.0  # m/s of the patch along the groove
SPIN_UP = 0.002  # s
ADVANCE = 0.9  # cells of the contact grid through which the patch moves in a step; above one friction is not resolved
CROSSINGS = 12  # of the patch, at full speed
SETTLED = 4  # of them, at the end, that are averaged
RHO_INF = 0.5
HERTZ = EllipticContact(
    LOAD, 1.0 / (1.0 / BALL - 1.0 / BOTTOM), 1.0 / (1.0 / BALL - 1.0 / GROOVE), contact_modulus(STEEL, STEEL)
)
AXES, PEAK = 0.02, 0.03  # of half-axes and peak pressure: four nodes along and five across in a half-axis
FORCE = 1e-3  # of the load, mean: cells of the contact grid pass, and the slide has inertia
RATIO = 5e-4  # of the ball's speed: where in the patch it rolls, a third of b^2/(10 R^2)
DISSIPATION = 1e-12  # of the work of friction: rounding
PAIR, ARM, AXLE = "ball-ring", "arm", "axle"


@dataclass(frozen=True)
class Size:
    """Quadratic cells of ball and ring, and how many frames the recording shows at most."""

    ball_sectors: int = 460  # four nodes in the half-axis along the groove
    ring_sectors: int = 2300
    layers: int = 8
    axial: int = 8  # in the tread: five nodes in the half-axis across
    frames: int = 40

    @property
    def step(self) -> float:
        """s."""
        return ADVANCE * np.pi * BALL / self.ball_sectors / SPEED


FULL, QUICK = Size(), Size(ball_sectors=350, ring_sectors=1750, axial=6, frames=10)


def duration() -> float:
    """Of a run [s]."""
    return SPIN_UP + CROSSINGS * 2.0 * HERTZ.half_axes[0] / SPEED


def build(size: Size = FULL, *, progress: bool = True) -> wf.Scene:
    """The scene: bodies `ball`, `ring`, `arm`, `slide`, joints `held`, `arm`, `slide`, `axle`, pair `ball-ring`."""
    ball_mesh = wf.mesh.roller(
        BALL, BALL_BORE, BALL_WIDTH, crown_radius=BALL, sectors=size.ball_sectors, layers=size.layers,
        axial=size.axial, tread=TREAD,
    )  # fmt: skip
    ring_mesh = wf.mesh.ring(
        BOTTOM - DEPTH, RING_OUTSIDE, RING_WIDTH, groove_radius=GROOVE, groove_depth=DEPTH,
        sectors=size.ring_sectors, layers=size.layers, axial=size.axial, tread=TREAD,
    )  # fmt: skip
    round_ball = wf.surfaces.Sphere(axis_direction=(0, 1, 0))
    reduced_ball = wf.reduce(
        ball_mesh, STEEL, interfaces={"bore": "rigid"}, contact={"tread": round_ball}, modes=0, tangential=True,
        progress=progress,
    )  # fmt: skip
    reduced_ring = wf.reduce(
        ring_mesh, STEEL, interfaces={"outside": "rigid"},
        contact={"tread": wf.surfaces.Ring(groove_radius=GROOVE)}, modes=0, tangential=True, progress=progress,
    )  # fmt: skip
    scene = wf.Scene()
    ball = scene.add_body(reduced_ball, name="ball", position=(0, 0, -(BOTTOM - BALL)))
    ring = scene.add_body(reduced_ring, name="ring")
    scene.add(wf.Contact(ball["tread"], ring["tread"], friction=FRICTION, name=PAIR))
    arm = scene.add_rigid_body(CARRIAGE_MASS, CARRIAGE_INERTIA, name="arm").at((0, 0, 0))
    slide = scene.add_rigid_body(
        CARRIAGE_MASS, CARRIAGE_INERTIA, name="slide", position=(0, 0, -(BOTTOM - BALL))
    ).at((0, 0, 0))  # fmt: skip
    scene.add(wf.joints.Fixed(scene.ground, ring["outside"], name="held"))
    turn = scene.add(wf.joints.Revolute(scene.ground, arm, axis=(0, 1, 0), name=ARM))
    scene.add(wf.joints.Prismatic(arm, slide, axis=(0, 0, -1), name="slide"))
    scene.add(wf.joints.Revolute(slide, ball["bore"], axis=(0, 1, 0), name=AXLE))
    spin = wf.signals.SmoothStep(0.0, SPEED / BOTTOM, duration=SPIN_UP)
    scene.add(wf.joints.Drive(turn, spin, quantity="velocity"))
    scene.add(wf.forces.PointForce(slide, (0, 0, -LOAD), frame="body", name="press"))
    return scene


def run(scene: wf.Scene, size: Size, *, progress: bool = True) -> wf.Result:
    """From rest, from the static state under the load."""
    integrator = wf.GeneralizedAlpha(RHO_INF)
    return wf.simulate(scene, duration(), step=size.step, start="equilibrium", integrator=integrator, progress=progress)


def speeds(result: wf.Result) -> tuple[np.ndarray, np.ndarray]:
    """Angular velocities about the axis of the ring (T,) [rad/s] of the arm and of the ball."""
    return result.body("arm").angular_velocity[:, 1], result.body("ball").angular_velocity[:, 1]


def checks(scene: wf.Scene, result: wf.Result) -> list[Check]:
    """The figures of a run: at rest, and means over the last crossings."""
    pair, t = result.contact(PAIR), result.time
    rows = t > t[-1] - SETTLED * 2.0 * HERTZ.half_axes[0] / SPEED
    a, b = HERTZ.half_axes
    arm, ball = (float(values[rows].mean()) for values in speeds(result))
    mass = scene.body("ball").mass + scene.body("slide").mass
    carried = LOAD + mass * arm**2 * (BOTTOM - BALL)
    rolls = -arm * (BOTTOM - BALL) / BALL * (1.0 + b**2 / (10.0 * BALL**2))
    work = result.energy["friction"]
    return [
        Check("half-axis along the groove", float(pair.half_widths[0, 0]), a, "Hertz", AXES, "um", 1e6),
        Check("half-axis across", float(pair.half_widths[0, 1]), b, "Hertz", AXES, "um", 1e6),
        Check("peak pressure", float(pair.peak_pressure[0]), HERTZ.peak_pressure, "Hertz", PEAK, "MPa", 1e-6),
        Check("force while rolling", float(pair.force_magnitude[rows].mean()), carried, "load, centrifugal force",
              FORCE, "N"),
        Check("speed of the ball over the arm's", ball / arm, rolls / arm, "rolling", RATIO),
        Check("largest gain from friction", max(float(np.diff(work).max()), 0.0), 0.0, "takes energy only",
              DISSIPATION, "J", scale=float(np.ptp(work))),
    ]  # fmt: skip


def panels(result: wf.Result) -> list:
    """Speeds, friction, and the patch at the end: pressure and slip along the groove, across the patch."""
    from warpffrf.output.plots.panels import Panel

    pair, t = result.contact(PAIR), result.time * 1e3
    friction = pair.friction
    arm, ball = speeds(result)
    i = len(t) - 1
    middle = int(np.argmax(pair.mean_pressure[i].max(axis=1)))
    z = pair.rows[i]
    fine = np.linspace(z[0], z[-1], 201)
    moving = np.abs(arm) > 0.01 * np.abs(arm).max()
    return [
        Panel("Speed of the ball", "time [ms]", "[rad/s]", {"ball": (t, -ball)},
              {"arm (R_o - R)/R": (t, arm * (BOTTOM - BALL) / BALL)}),
        Panel("Speed over that of rolling, less 1", "time [ms]", "[-]",
              {"run": (t[moving], -ball[moving] / (arm[moving] * (BOTTOM - BALL) / BALL) - 1.0)},
              {"b^2/(10 R^2)": (t[moving], np.full(int(moving.sum()), HERTZ.half_axes[1] ** 2 / (10.0 * BALL**2)))}),
        Panel("Pressure across the groove", "z [mm]", "[MPa]", {"run": (z * 1e3, pair.mean_pressure[i, middle] / 1e6)},
              {"Hertz": (fine * 1e3, HERTZ.pressure(0.0 * fine, fine) / 1e6)}),
        Panel("Tractions along the groove, across it", "z [mm]", "[MPa]",
              {"traction": (z * 1e3, friction.traction[i, 0, middle] / 1e6)}),
        Panel("Areas", "time [ms]", "[mm2]",
              {"stick": (t, friction.stick_area * 1e6), "slip": (t, friction.slip_area * 1e6)}),
        Panel("Friction power", "time [ms]", "[mW]", {"power": (t, friction.power * 1e3)}),
    ]  # fmt: skip


def main(out: str | Path = "out/ball_in_ring", *, quick: bool = False, progress: bool = True) -> int:
    """Run the demo and write ball_in_ring.h5, .rrd, .png and summary.json into the folder `out`; 0 when all went well.

    quick: larger cells. Raises `InputError` for a folder that cannot be written.
    """
    folder = writable_folder(out)
    size = QUICK if quick else FULL
    log.info("ball in ring: %g N, %g crossings of the patch in steps of %.3g s", LOAD, CROSSINGS, size.step)
    scene = build(size, progress=progress)
    result = run(scene, size, progress=progress)
    if result.status != "completed":
        log.error("the run ended early, %s: %s", result.status, result.message)
        return 1
    return finish(folder / "ball_in_ring", {"run": result}, checks(scene, result), panels(result), frames=size.frames)
