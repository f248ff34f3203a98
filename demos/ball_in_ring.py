r"""A ball rolls in the groove of a ring: two bodies of a ball bearing.

A steel ball lies in the groove of a fixed outer ring. An arm that rotates about the ring's axis carries a slide that
presses the ball outwards; the ball rotates freely on the slide. At the start nothing moves. The arm is driven, and
friction in the groove makes the ball roll.

What to expect. The patch is Hertz's ellipse, long across the groove, with the relative radii

    1/R_x = 1/R - 1/R_o  along the groove,      1/R_y = 1/R - 1/R_g  across it

(ball R, bottom of the groove R_o, arc of the groove R_g). The centre of the ball moves with Omega (R_o - R); where the
ball rolls, the point of contact is at rest, so that

    omega = -Omega (R_o - R)/R.

The groove is curved across: at a distance y from its middle the ball is thinner by y^2/(2 R), and the patch cannot roll
everywhere at once. It slips one way in the middle and the other way at its ends (H. L. Heathcote, Proc. Inst.
Automobile Engineers 15, 1921), and the ball rotates faster by about b^2/(10 R^2), the mean of y^2/(2 R^2) over the
pressure with the half-axis b across: by 0.13 % here. The centrifugal force of ball and slide adds to the load.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

import warpffrf as wf
from warpffrf.output.plots.panels import Panel, save_panels

STEEL = wf.Material(youngs_modulus=210e9, poisson_ratio=0.3, density=7850, name="steel")
BALL, BALL_BORE, BALL_WIDTH = 0.006, 0.001, 0.008  # m: radius R, hole of the axle, width between its flat ends
BOTTOM, GROOVE, DEPTH = 0.03, 0.55 * 2.0 * BALL, 0.0015  # m: R_o, R_g, depth below the lands
RING_OUTSIDE, RING_WIDTH = 0.04, 0.012  # m
LOAD, FRICTION = 300.0, 0.1  # N, -
TREAD = 0.0022  # m, width of the finely meshed band on both
CARRIAGE_MASS, CARRIAGE_INERTIA = 0.1, (1e-4, 1e-4, 1e-4)  # kg, kg m2, of arm and slide
SPEED, SPIN_UP, DURATION = 1.0, 0.002, 0.0059  # m/s of the patch along the groove, s, s: twelve patch lengths
ADVANCE = 0.9  # cells of the contact grid by which the patch advances per step; above one friction is not resolved
RHO_INF = 0.5
PAIR, ARM, AXLE = "ball-ring", "arm", "axle"


@dataclass(frozen=True)
class Size:
    """Quadratic cells of ball and ring around, through the depth, and along the axis in the tread."""

    ball_sectors: int = 460  # four nodes in the half-axis along the groove
    ring_sectors: int = 2300
    layers: int = 8
    axial: int = 8  # five nodes in the half-axis across

    @property
    def step(self) -> float:
        """s."""
        return ADVANCE * np.pi * BALL / self.ball_sectors / SPEED


FULL, QUICK = Size(), Size(ball_sectors=350, ring_sectors=1750, axial=6)


def build(size: Size = FULL, *, progress: bool = True) -> wf.Scene:
    """The scene: bodies `ball`, `ring`, `arm`, `slide`, joints `held`, `arm`, `slide`, `axle`, contact `ball-ring`."""
    ball_mesh = wf.mesh.roller(
        BALL, BALL_BORE, BALL_WIDTH, crown_radius=BALL, sectors=size.ball_sectors, layers=size.layers,
        axial=size.axial, tread=TREAD,
    )  # fmt: skip
    ring_mesh = wf.mesh.ring(
        BOTTOM - DEPTH, RING_OUTSIDE, RING_WIDTH, groove_radius=GROOVE, groove_depth=DEPTH,
        sectors=size.ring_sectors, layers=size.layers, axial=size.axial, tread=TREAD,
    )  # fmt: skip
    reduced_ball = wf.reduce(
        ball_mesh, STEEL, interfaces={"bore": "rigid"}, contact={"tread": wf.surfaces.Sphere(axis_direction=(0, 1, 0))},
        modes=0, grid=wf.ContactGrid(tangential=True), progress=progress,
    )  # fmt: skip
    reduced_ring = wf.reduce(
        ring_mesh, STEEL, interfaces={"outside": "rigid"}, contact={"tread": wf.surfaces.Ring(groove_radius=GROOVE)},
        modes=0, grid=wf.ContactGrid(tangential=True), progress=progress,
    )  # fmt: skip
    scene, at = wf.Scene(), (0, 0, -(BOTTOM - BALL))
    ball = scene.add_body(reduced_ball, name="ball", position=at)
    ring = scene.add_body(reduced_ring, name="ring")
    scene.add(wf.Contact(ball["tread"], ring["tread"], friction=FRICTION, name=PAIR))
    arm = scene.add_rigid_body(CARRIAGE_MASS, CARRIAGE_INERTIA, name="arm")
    slide = scene.add_rigid_body(CARRIAGE_MASS, CARRIAGE_INERTIA, name="slide", position=at)
    scene.add(wf.joints.Fixed(scene.ground, ring["outside"], name="held"))
    pivot = scene.add(wf.joints.Revolute(scene.ground, arm, axis=(0, 1, 0), name=ARM))
    scene.add(wf.joints.Prismatic(arm, slide, axis=(0, 0, -1), name="slide"))
    scene.add(wf.joints.Revolute(slide, ball["bore"], axis=(0, 1, 0), name=AXLE))
    spin = wf.signals.SmoothStep(0.0, SPEED / BOTTOM, duration=SPIN_UP)
    scene.add(wf.joints.Drive(pivot, spin, quantity="velocity"))
    scene.add(wf.forces.PointForce(slide, (0, 0, -LOAD), frame="body", name="press"))
    return scene


def run(scene: wf.Scene, size: Size, *, progress: bool = True) -> wf.Result:
    """From rest, from the static state under the load."""
    integrator = wf.integrators.GeneralizedAlpha(RHO_INF)
    return wf.simulate(
        scene,
        DURATION,
        step=size.step,
        start="equilibrium",
        options=wf.RunOptions(integrator=integrator),
        progress=progress,
    )


def speeds(result: wf.Result) -> tuple[np.ndarray, np.ndarray]:
    """Angular velocities about the axis of the ring (T,) [rad/s] of the arm and of the ball."""
    return result.body("arm").angular_velocity[:, 1], result.body("ball").angular_velocity[:, 1]


def panels(result: wf.Result) -> list[Panel]:
    """Speeds, friction, and the patch at the end: pressure and traction across the groove."""
    contact, t, (arm, ball) = result.contact(PAIR), result.time * 1e3, speeds(result)
    friction, z = contact.friction, contact.rows[-1] * 1e3
    middle = int(np.argmax(contact.mean_pressure[-1].max(axis=1)))
    return [
        Panel("Speed of the ball", "time [ms]", "[rad/s]", {"ball": (t, -ball)},
              {"arm (R_o - R)/R": (t, arm * (BOTTOM - BALL) / BALL)}),
        Panel("Pressure across the groove", "z [mm]", "[MPa]", {"run": (z, contact.mean_pressure[-1, middle] / 1e6)}),
        Panel("Tractions along the groove, across it", "z [mm]", "[MPa]",
              {"traction": (z, friction.traction[-1, 0, middle] / 1e6)}),
        Panel("Areas", "time [ms]", "[mm2]",
              {"stick": (t, friction.stick_area * 1e6), "slip": (t, friction.slip_area * 1e6)}),
    ]  # fmt: skip


def main(out: str | Path = "out/ball_in_ring", *, quick: bool = False, progress: bool = True) -> list[wf.Result]:
    """Write ball_in_ring.h5, .rrd and .png into the folder `out` and print the figures; quick: larger cells."""
    stem, size = Path(out) / "ball_in_ring", QUICK if quick else FULL
    result = run(build(size, progress=progress), size, progress=progress)
    result.save(f"{stem}.h5", overwrite=True)
    wf.record(result, f"{stem}.rrd", max_frames=10 if quick else 40, overwrite=True)
    save_panels(panels(result), f"{stem}.png", overwrite=True)

    contact, (arm, ball) = result.contact(PAIR), speeds(result)
    hertz: Any = contact.hertz(0)
    found = contact.half_widths[0] * 1e6
    faster = -ball[-20:].mean() / arm[-20:].mean() * BALL / (BOTTOM - BALL) - 1.0
    print(f"half-axis along the groove {found[0]:8.5g} um   Hertz {hertz.semi_axes[1] * 1e6:8.5g}")
    print(f"half-axis across           {found[1]:8.5g} um   Hertz {hertz.semi_axes[0] * 1e6:8.5g}")
    peak = contact.peak_pressure[0] / 1e6
    print(f"peak pressure              {peak:8.5g} MPa  Hertz {hertz.peak_pressure / 1e6:8.5g}")
    print(f"ball faster than rolling   {faster * 100:8.3f} %    Heathcote "
          f"{hertz.semi_axes[0]**2 / (10.0 * BALL**2) * 100:.3f}")  # fmt: skip
    return [result]


if __name__ == "__main__":
    main()
