r"""A steel ball pressed on a rigid plane and pushed sideways: Hertz, then Cattaneo and Mindlin.

A ball of 10 mm radius is held in a slide that lets it move down and sideways but not rotate. From the static state
under 100 N it is pushed sideways slowly, up to half of the friction limit. The load is spread evenly over the
surface of the ball.

What to expect, with 1/E* = (1 - nu^2)/E and S = (2 - nu)/G of the ball alone:

    a^3 = 3 P R/(4 E*),    p0 = 3 P/(2 pi a^2),    delta = a^2/R,
    (c/a)^3 = 1 - Q/(mu P),    delta_t = (3 mu P/(16 a)) S (1 - (1 - Q/(mu P))^(2/3))

(K. L. Johnson, Contact Mechanics, 1985, sections 4.2 and 7.2): slip begins at the edge and leaves a stick zone of
radius c. Hertz and Mindlin have a half-space behind the patch; the rest of a ball adds displacements of order
a/R = 1.5 %. On a rigid plane tractions and pressure are coupled: the pressure is slightly unsymmetric.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

import warpffrf as wf
from warpffrf.output.plots.panels import Panel, save_panels

STEEL = wf.Material(youngs_modulus=210e9, poisson_ratio=0.3, density=7800, name="steel")
RADIUS, LOAD, FRICTION, SHARE = 0.01, 100.0, 0.3, 0.5  # m, N, -, of the friction force
PUSH = SHARE * FRICTION * LOAD  # N
HALF_WIDTH = float(np.cbrt(0.75 * LOAD * RADIUS * (1.0 - STEEL.poisson_ratio**2) / STEEL.youngs_modulus))  # m, a
PEAK = 1.5 * LOAD / (np.pi * HALF_WIDTH**2)  # Pa, p0
COMPLIANCE = (2.0 - STEEL.poisson_ratio) * 2.0 * (1.0 + STEEL.poisson_ratio) / STEEL.youngs_modulus  # 1/Pa, S
PATCH = (1.6, 1.3)  # half-widths of the fine patch of the mesh over a: around and along
SLIDE_MASS, SLIDE_INERTIA = 0.1, (1e-4, 1e-4, 1e-4)  # kg, kg m2
DURATION, STEP = 0.02, 5e-4  # s: slow compared with the ball on its contact, 2 kHz
RHO_INF = 0.0  # for a quasi-static motion
DOWN_ON_PLANE = (0.0, np.sqrt(0.5), 0.0, np.sqrt(0.5))  # rotates the fine patch of the mesh from +x to -z
PAIR, DOWN, SIDE = "ball-plane", "down", "side"


@dataclass(frozen=True)
class Size:
    """Quadratic cells in a half-width."""

    cells: float = 2.0


FULL, QUICK = Size(cells=2.5), Size()


def reduced_ball(size: Size, *, progress: bool = True) -> wf.ReducedBody:
    """The ball with interface `outside`, the mean motion of its surface, and contact surface `patch` around +x."""
    mesh = wf.mesh.ball(
        RADIUS, patch_half_width=(PATCH[0] * HALF_WIDTH, PATCH[1] * HALF_WIDTH), cell=HALF_WIDTH / size.cells
    )
    return wf.reduce(
        mesh, STEEL, interfaces={"outside": "average"}, contact={"patch": wf.surfaces.Sphere()}, modes=0,
        grid=wf.ContactGrid(tangential=True, contact_fixed=False), progress=progress,
    )  # fmt: skip


def build(size: Size = FULL, *, progress: bool = True) -> wf.Scene:
    """The scene: bodies `ball`, `lift`, `slide`, joints `down`, `side`, `hold`, contact `ball-plane`."""
    scene = wf.Scene()
    ball = scene.add_body(
        reduced_ball(size, progress=progress), name="ball", position=(0, 0, RADIUS), rotation=DOWN_ON_PLANE
    )
    plane = wf.surfaces.Plane(origin=(0, 0, 0), outward=(0, 0, 1))
    scene.add(wf.Contact(ball["patch"], scene.ground.surface(plane, name="plane"), friction=FRICTION, name=PAIR))
    at = ball["outside"].world_point()
    lift, slide = (
        scene.add_rigid_body(SLIDE_MASS, SLIDE_INERTIA, name=name, position=at) for name in ("lift", "slide")
    )
    scene.add(wf.joints.Prismatic(scene.ground, lift, axis=(0, 0, 1), name=DOWN))
    scene.add(wf.joints.Prismatic(lift, slide, axis=(1, 0, 0), name=SIDE))
    scene.add(wf.joints.Fixed(slide, ball["outside"], name="hold"))
    scene.add(wf.forces.PointForce(slide, (0, 0, -LOAD), name="press"))
    scene.add(wf.forces.PointForce(slide, (wf.signals.Ramp(0.0, PUSH, duration=DURATION), (1, 0, 0)), name="push"))
    return scene


def mindlin(push: np.ndarray | float) -> np.ndarray:
    """Tangential displacement [m] under a push [N]."""
    limit = FRICTION * LOAD
    return 3.0 * limit / (16.0 * HALF_WIDTH) * COMPLIANCE * (1.0 - (1.0 - push / limit) ** (2 / 3))


def panels(result: wf.Result) -> list[Panel]:
    """Pressure and Hertz, tractions, displacement and Mindlin, stick and slip."""
    contact, friction, a = result.contact(PAIR), result.contact(PAIR).friction, HALF_WIDTH
    profile, t = friction.profile(len(result.time) - 1, FRICTION), result.time * 1e3
    x, Q = np.linspace(-1.3, 1.3, 201), np.linspace(0.0, PUSH, 101)
    return [
        Panel("Pressure before the push", "arc over a", "[MPa]",
              {"pressure": (contact.arc[0] / a, contact.mid_pressure[0] / 1e6)},
              {"Hertz": (x, PEAK / 1e6 * np.sqrt(np.maximum(1.0 - x**2, 0.0)))}),
        Panel("Traction at the end of the push", "arc over a", "[MPa]",
              {"traction": (profile["arc"] / a, np.abs(profile["traction"]) / 1e6),
               "mu p": (profile["arc"] / a, profile["bound"] / 1e6)}),
        Panel("Force sideways", "displacement [µm]", "[N]",
              {"run": (result.joint(SIDE).coordinate * 1e6, np.abs(contact.force[:, 0]))},
              {"Mindlin": (mindlin(Q) * 1e6, Q)}),
        Panel("Areas over pi a^2", "time [ms]", "[-]", {"stick": (t, friction.stick_area / (np.pi * a**2)),
                                                        "slip": (t, friction.slip_area / (np.pi * a**2))}),
    ]  # fmt: skip


def main(out: str | Path = "out/ball_on_plane", *, quick: bool = False, progress: bool = True) -> list[wf.Result]:
    """Write ball_on_plane.h5, .rrd and .png into the folder `out` and print the figures; quick: larger cells."""
    stem = Path(out) / "ball_on_plane"
    result = wf.simulate(
        build(QUICK if quick else FULL, progress=progress), DURATION, step=STEP, start="equilibrium",
        options=wf.RunOptions(integrator=wf.integrators.GeneralizedAlpha(RHO_INF)), progress=progress,
    )  # fmt: skip
    result.save(f"{stem}.h5", overwrite=True)
    wf.record(result, f"{stem}.rrd", max_frames=20 if quick else 60, overwrite=True)
    save_panels(panels(result), f"{stem}.png", overwrite=True)

    contact, a = result.contact(PAIR), HALF_WIDTH
    approach, side = -result.joint(DOWN).coordinate[0], result.joint(SIDE).coordinate[-1]
    stick = np.sqrt(contact.friction.stick_area[-1] / np.pi)
    print(f"half-width               {contact.half_widths[0, 0] * 1e6:8.5g} um   Hertz   {a * 1e6:8.5g}")
    print(f"peak pressure            {contact.peak_pressure[0] / 1e6:8.5g} MPa  Hertz   {PEAK / 1e6:8.5g}")
    print(f"approach                 {approach * 1e6:8.5g} um   Hertz   {a**2 / RADIUS * 1e6:8.5g}")
    print(f"radius of the stick zone {stick * 1e6:8.5g} um   Mindlin {np.cbrt(1.0 - SHARE) * a * 1e6:8.5g}")
    print(f"tangential displacement  {side * 1e6:8.5g} um   Mindlin {mindlin(PUSH) * 1e6:8.5g}")
    return [result]


if __name__ == "__main__":
    main()
