r"""A steel ball pressed on a rigid plane and pushed sideways: Hertz, then Cattaneo and Mindlin.

A ball of 10 mm radius is held in a slide that lets it move down and sideways but not turn. From the static state under
100 N it is pushed sideways slowly, up to half of what friction can give. The fine patch of the mesh is around the place
that touches; the load comes to the whole surface of the ball, evenly spread.

What to expect, with 1/E* = (1 - nu^2)/E and S = (2 - nu)/G of the ball alone:

    a^3 = 3 P R/(4 E*),    p0 = 3 P/(2 pi a^2),    delta = a^2/R,
    (c/a)^3 = 1 - Q/(mu P),    delta_t = (3 mu P/(16 a)) S (1 - (1 - Q/(mu P))^(2/3))

(K. L. Johnson, Contact Mechanics, 1985, sections 4.2 and 7.2): slip begins at the edge and leaves a stick zone of
radius c. Hertz and Mindlin have a half-space behind the patch; what the rest of a ball adds to the displacements is of
order a/R = 1.5 %. On a rigid plane tractions and pressure are coupled: the pressure leans a little.
"""

from __future__ import annotations

import logging
from dataclasses import dataclass
from pathlib import Path

import numpy as np

import warpffrf as wf
from demos.checks import Check, finish, writable_folder
from references.closed_forms import MindlinPoint, PointContact, contact_modulus, tangential_compliance

log = logging.getLogger("warpffrf")

STEEL = wf.Material(youngs_modulus=210e9, poisson_ratio=0.3, density=7800, name="steel")
RADIUS, LOAD, FRICTION, SHARE = 0.01, 100.0, 0.3, 0.5  # m, N, -, of the friction force
PUSH = SHARE * FRICTION * LOAD  # N
HERTZ = PointContact(LOAD, RADIUS, contact_modulus(STEEL))
MINDLIN = MindlinPoint(HERTZ, FRICTION, tangential_compliance(STEEL))
PATCH = (1.6, 1.3)  # half-widths of the fine patch over a: around and along; the window ends inside it
SLIDE_MASS, SLIDE_INERTIA = 0.1, (1e-4, 1e-4, 1e-4)  # kg, kg m2
DURATION, STEP = 0.02, 5e-4  # s: slow beside the ball on its contact, 2 kHz; longer steps would be halved
RHO_INF = 0.0  # no ringing is wanted
DOWN_ON_PLANE = (0.0, np.sqrt(0.5), 0.0, np.sqrt(0.5))  # turns the patch of the mesh, around +x, to -z
PAIR, DOWN, SIDE = "ball-plane", "down", "side"
SHAPE = 0.01  # of half-width and peak pressure, at five nodes in a half-width
REST_OF_BALL = 0.015  # of the approach: a/R
SIDEWAYS = 0.02  # of the tangential displacement: a/R, and cells at the edge


@dataclass(frozen=True)
class Size:
    """Quadratic cells in a half-width, and how many frames the recording shows at most."""

    cells: float = 2.0
    frames: int = 60


FULL, QUICK = Size(cells=2.5), Size(frames=20)


def reduced_ball(size: Size, *, progress: bool = True) -> wf.ReducedBody:
    """The ball with interface `outside`, the mean motion of its surface, and contact surface `patch` around +x."""
    a = HERTZ.half_width
    mesh = wf.mesh.ball(RADIUS, patch_half_width=(PATCH[0] * a, PATCH[1] * a), cell=a / size.cells)
    return wf.reduce(
        mesh, STEEL, interfaces={"outside": "average"}, contact={"patch": wf.surfaces.Sphere()}, modes=0,
        tangential=True, progress=progress,
    )  # fmt: skip


def build(size: Size = FULL, *, progress: bool = True) -> wf.Scene:
    """The scene: bodies `ball`, `lift`, `slide`, joints `down`, `side`, `hold`, contact pair `ball-plane`."""
    scene = wf.Scene()
    ball = scene.add_body(
        reduced_ball(size, progress=progress), name="ball", position=(0, 0, RADIUS), rotation=DOWN_ON_PLANE
    )
    plane = wf.surfaces.Plane(origin=(0, 0, 0), outward=(0, 0, 1))
    scene.add(wf.Contact(ball["patch"], scene.ground.surface(plane, name="plane"), friction=FRICTION, name=PAIR))
    at = ball["outside"].world_point()
    lift, slide = (
        scene.add_rigid_body(SLIDE_MASS, SLIDE_INERTIA, name=name, position=at).at((0, 0, 0))
        for name in ("lift", "slide")
    )
    scene.add(wf.joints.Prismatic(scene.ground, lift, axis=(0, 0, 1), name=DOWN))
    scene.add(wf.joints.Prismatic(lift, slide, axis=(1, 0, 0), name=SIDE))
    scene.add(wf.joints.Fixed(slide, ball["outside"], name="hold"))
    scene.add(wf.forces.PointForce(slide, (0, 0, -LOAD), name="press"))
    scene.add(wf.forces.PointForce(slide, (wf.signals.Ramp(0.0, PUSH, duration=DURATION), (1, 0, 0)), name="push"))
    return scene


def run(scene: wf.Scene, *, progress: bool = True) -> wf.Result:
    """The push from the static state under the load."""
    integrator = wf.GeneralizedAlpha(RHO_INF)
    return wf.simulate(scene, DURATION, step=STEP, start="equilibrium", integrator=integrator, progress=progress)


def checks(result: wf.Result) -> list[Check]:
    """The figures of a run."""
    pair = result.contact(PAIR)
    friction = pair.friction
    grid = pair.spacing / HERTZ.half_width
    stick = float(np.sqrt(friction.stick_area[-1] / np.pi)) / HERTZ.half_width
    work = result.energy["friction"]
    return [
        Check("half-width around", float(pair.half_widths[0, 0]), HERTZ.half_width, "Hertz", SHAPE, "um", 1e6),
        Check("half-width along", float(pair.half_widths[0, 1]), HERTZ.half_width, "Hertz", SHAPE, "um", 1e6),
        Check("peak pressure", float(pair.peak_pressure[0]), HERTZ.peak_pressure, "Hertz", SHAPE, "MPa", 1e-6),
        Check("approach", -float(result.joint(DOWN).coordinate[0]), HERTZ.approach, "Hertz", REST_OF_BALL, "um", 1e6),
        Check("force sideways", abs(float(pair.force[-1, 0])), PUSH, "statics", 1e-3, "N"),
        Check("stick radius over half-width", stick, MINDLIN.stick_ratio(PUSH), "Mindlin, to a grid spacing", grid,
              scale=1.0),
        Check("tangential displacement", float(result.joint(SIDE).coordinate[-1]), float(MINDLIN.loading(PUSH)),
              "Mindlin", SIDEWAYS, "um", 1e6),
        Check("largest gain from friction", max(float(np.diff(work).max()), 0.0), 0.0, "takes energy only",
              1e-12, "J", scale=float(np.ptp(work))),
    ]  # fmt: skip


def panels(result: wf.Result) -> list:
    """Pressure beside Hertz, tractions and displacement beside Mindlin, stick and slip."""
    from warpffrf.output.plots.panels import Panel

    pair = result.contact(PAIR)
    friction, a = pair.friction, HERTZ.half_width
    profile = friction.profile(len(result.time) - 1, FRICTION)
    x = profile["arc"]
    fine = np.linspace(-1.3 * a, 1.3 * a, 201)
    pushed = -pair.force[:, 0]
    Q = np.linspace(0.0, PUSH, 101)
    mean = {"pressure": (pair.arc[0] / a, pair.mid_pressure[0] / 1e6)}
    way = result.joint(SIDE).coordinate
    return [
        Panel("Pressure before the push", "arc over a", "[MPa]", mean,
              {"Hertz": (fine / a, HERTZ.pressure(fine) / 1e6)}),
        Panel("Traction at the end of the push", "arc over a", "[MPa]",
              {"traction": (x / a, np.abs(profile["traction"]) / 1e6), "mu p": (x / a, profile["bound"] / 1e6)},
              {"Mindlin": (fine / a, MINDLIN.traction(fine, PUSH) / 1e6)}),
        Panel("Force sideways", "displacement [um]", "[N]", {"run": (way * 1e6, np.abs(pushed))},
              {"Mindlin": (MINDLIN.loading(Q) * 1e6, Q)}),
        Panel("Areas over pi a^2", "time [ms]", "[-]",
              {"stick": (result.time * 1e3, friction.stick_area / (np.pi * a**2)),
               "slip": (result.time * 1e3, friction.slip_area / (np.pi * a**2))}),
    ]  # fmt: skip


def main(out: str | Path = "out/ball_on_plane", *, quick: bool = False, progress: bool = True) -> int:
    """Run the demo and write ball_on_plane.h5, .rrd, .png and summary.json into the folder `out`; 0 when all went well.

    quick: larger cells. Raises `InputError` for a folder that cannot be written.
    """
    folder = writable_folder(out)
    size = QUICK if quick else FULL
    log.info("ball on plane: %g quadratic cells in a half-width; pushed up to %g N", size.cells, PUSH)
    result = run(build(size, progress=progress), progress=progress)
    if result.status != "completed":
        log.error("the run ended early, %s: %s", result.status, result.message)
        return 1
    return finish(folder / "ball_on_plane", {"run": result}, checks(result), panels(result), frames=size.frames)
