r"""A spindle on a preloaded pair of angular contact ball bearings: preload and contact angles against speed.

Two bearings back to back, twelve balls at 15 degrees each. Three mountings:

    offset    raceways ground 10 um off the faces of the rings, which a nut pulls together
    warm      the same, with inner raceways that have grown by 3 um in radius against the outer ones
    spring    the outer ring of the rear bearing slides and is pushed by a spring of 120 N

At speed balls press on the outer ring by their centrifugal force and roll at a smaller contact angle there, a larger
one on the inner ring. Rings that are held then press more, those with a spring do not.

**Balance of one ball.** From the centre of the outer groove, (x, y) outwards and along the axis is the ball's centre,
(A cos alpha_0 + u, A sin alpha_0 + p) that of the inner groove, A their distance where balls touch, u the growth and p
the offset. Loads Q are Hertz's at the lengths of the lines between them, whose angles are alpha_o and alpha_i. A ball
that does not pivot on the outer ring orbits with

    w_c = w (1 - D cos(alpha_i)/d)/(1 + cos(alpha_i - alpha_o)).

Its axis goes around with it, which takes the moment M = (2/5) m r w_c^2 (d/2) sin alpha_o, r = D/2, of friction forces
mu Q on both rings, mu = M/(r (Q_i + Q_o)). Both forces Q (n + mu t) at n = (cos alpha, sin alpha), t = (-sin alpha, cos
alpha) balance with m (d/2) w_c^2.

**Runs** begin with rolling at the contact angles of an earlier one, two at each speed; friction, also of pivoting,
finds orbit and axis of the balls.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from scipy.optimize import root

import warpffrf as wf
from warpffrf.output.contact.hertz import hertz_point
from warpffrf.output.plots.panels import Panel, save_panels

STEEL = wf.Material(youngs_modulus=210e9, poisson_ratio=0.3, density=7850, name="steel")
COUNT, BALL, PITCH, GROOVE = 12, 8e-3, 50e-3, 4.24e-3  # balls; m: diameters, radius of the grooves
ANGLE, APART = np.radians(15.0), 60e-3  # rad, m between the bearings
OFFSET, GROWTH, SPRING, RATE = 10e-6, 3e-6, 120.0, 5e3  # m, m, N, N/m
MOUNTINGS = ("offset", "warm", "spring")
RPM = np.pi / 30.0  # rad/s
MASS = STEEL.density * np.pi * BALL**3 / 6.0  # kg, of a ball
CONTACT = wf.bearings.RollingContact(
    law=wf.laws.HertzPoint(STEEL, STEEL, damping=1.0), friction=wf.laws.RegularisedCoulomb(0.06, 0.03), spin=True
)


@dataclass(frozen=True)
class Size:
    """Speeds [rpm]; duration and step of each run [s]."""

    speeds: tuple[float, ...] = (1e3, 5e3, 10e3, 15e3, 20e3, 25e3, 30e3)
    duration: float = 3e-3
    step: float = 1e-5


FULL, QUICK = Size(), Size(speeds=(1e3, 10e3, 20e3))


def build(speed: float, mounting: str = "offset", angles: tuple[float, float] = (ANGLE, ANGLE)) -> wf.Scene:
    """The scene at `speed` [rad/s]: bearings `front` and `rear` on the body `shaft`; angles [rad]: contact angles of
    the balls at the start, on the inner and the outer ring."""
    scene = wf.Scene()
    shaft = scene.add_rigid_body(0.5, (5e-4, 1e-4, 5e-4), name="shaft")
    sleeve: Any = scene.ground
    if mounting == "spring":
        sleeve = scene.add_rigid_body(0.1, (5e-5, 1e-4, 5e-5), name="sleeve", position=(0, 0.5 * APART, 0))
        guide = scene.add(wf.joints.Prismatic(scene.ground, sleeve, axis=(0, 1, 0), name="guide"))
        scene.add(wf.forces.JointSpringDamper(guide, RATE, 2e3, preload=-SPRING, name="spring"))
    for name, sense, outer in (("front", 1.0, scene.ground), ("rear", -1.0, sleeve)):
        bearing = scene.add_bearing(
            name,
            wf.bearings.BallGeometry(
                elements=COUNT, ball_diameter=BALL, pitch_diameter=PITCH, osculation=GROOVE / BALL,
                contact_angle=sense * ANGLE, clearance=-2.0 * GROWTH if mounting == "warm" else 0.0,
            ),
            position=(0, -0.5 * sense * APART, 0), inner=shaft, outer=outer, cage=wf.bearings.PocketCage(0.1e-3),
            axial_preload=None if mounting == "spring" else wf.bearings.PreloadOffset(OFFSET), contact=CONTACT,
            materials=STEEL,
        )  # fmt: skip
        bearing.roll(speed, angle=(sense * angles[0], sense * angles[1]))
    axle = scene.add(wf.joints.Cylindrical(scene.ground, shaft, axis=(0, 1, 0), name="axle"))
    scene.add(wf.joints.Drive(axle, speed, coordinate="rotation", name="drive"))
    return scene


def by_hand(speed: float, mounting: str) -> np.ndarray:
    """Preload [N], loads of a ball [N] and angles of its forces [rad] on the inner and the outer ring: the balance
    above."""
    A, r, R = 2.0 * GROOVE - BALL, 0.5 * BALL, 0.5 * PITCH
    growth = GROWTH if mounting == "warm" else 0.0

    def forces(x: np.ndarray, w: float) -> tuple[np.ndarray, np.ndarray]:
        ball, centre = x[:2], A * np.array([np.cos(ANGLE), np.sin(ANGLE)]) + [growth, x[2]]
        Q, a = np.zeros(2), np.zeros(2)
        for k, line in enumerate((centre - ball, ball)):
            a[k] = np.arctan2(line[1], line[0])
            gamma = (1 - 2 * k) * BALL / PITCH * np.cos(a[k])
            curvature = np.diag([2.0 / BALL / (1.0 - gamma), 2.0 / BALL - 1.0 / GROOVE])
            unit = hertz_point(1.0, curvature, 0.5 * STEEL.plane_strain_modulus).approach
            Q[k] = (max(np.hypot(*line) - GROOVE + r, 0.0) / unit) ** 1.5
        orbit = w * (1.0 - r / R * np.cos(a[0])) / (1.0 + np.cos(a[0] - a[1]))
        share = 0.4 * MASS * R * orbit**2 * np.sin(a[1]) / Q.sum()
        F = Q * np.array([np.cos(a) - share * np.sin(a), np.sin(a) + share * np.cos(a)])
        found = np.array([COUNT * F[1, 0], *Q, *a])
        held = found[0] - SPRING if mounting == "spring" else 1e7 * (x[2] - OFFSET)
        return np.array([F[0, 0] - F[0, 1] + MASS * R * orbit**2, F[1, 0] - F[1, 1], held]), found

    x = np.array([0.5 * A * np.cos(ANGLE) + 0.5 * growth, 0.5 * A * np.sin(ANGLE) + 0.5 * OFFSET, OFFSET])
    for w in np.linspace(0.0, speed, 8):
        x = root(lambda x, w=w: forces(x, w)[0], x, tol=1e-13).x
    return forces(x, speed)[1]


def found_in(result: wf.Result) -> np.ndarray:
    """The same of the front bearing at the end of a run, means of its balls."""
    front = result.bearing("front")
    columns = (front.inner_load, front.outer_load, front.inner_angle, front.outer_angle)
    return np.array([-front.force[-1, 2], *(column[-1].mean() for column in columns)])


def sweep(mounting: str, size: Size = FULL, progress: bool = False) -> tuple[np.ndarray, wf.Result]:
    """`found_in` (speeds, 5) of the runs at all speeds, and the last run."""
    rows, angles, options = [], (ANGLE, ANGLE), wf.RunOptions(save_every=10)
    result: Any = None
    for rpm in size.speeds:
        for _ in range(2):
            scene = build(rpm * RPM, mounting, angles)
            result = wf.simulate(
                scene, size.duration, step=size.step, start="equilibrium", options=options, progress=progress
            )
            found = found_in(result)
            angles = (found[3], found[4])
        rows.append(found)
    return np.array(rows), result


def panels(size: Size, found: dict[str, np.ndarray], balanced: dict[str, np.ndarray]) -> list[Panel]:
    """Preload, contact angles and loads over the speed; found, balanced: (speeds, 5) by mounting, of the runs and by
    hand."""
    x = np.array(size.speeds) / 1e3

    def panel(title: str, unit: str, factor: float, columns: dict[str, tuple[str, int]]) -> Panel:
        curves = {name: (x, factor * found[of][:, k]) for name, (of, k) in columns.items()}
        points = np.concatenate([factor * balanced[of][:, k] for of, k in columns.values()])
        return Panel(title, "speed [1000 rpm]", unit, curves, points={"NumPy": (np.tile(x, len(columns)), points)})

    sides = {f"{of}, {side}": (of, k) for of in ("offset", "spring") for k, side in enumerate(("inner", "outer"))}
    return [
        panel("Preload of each bearing", "[N]", 1.0, {of: (of, 0) for of in MOUNTINGS}),
        panel(
            "Contact angles", "[deg]", float(np.degrees(1.0)), {name: (of, k + 3) for name, (of, k) in sides.items()}
        ),
        panel("Load of a ball on each ring", "[N]", 1.0, {name: (of, k + 1) for name, (of, k) in sides.items()}),
    ]


def main(out: str | Path = "out/spindle", *, quick: bool = False, progress: bool = True) -> list[wf.Result]:
    """Write spindle.h5, .rrd (of the raceways that are offset, at the last speed) and .png into the folder `out` and
    print the figures; quick: fewer speeds."""
    stem, size = Path(out) / "spindle", QUICK if quick else FULL
    sweeps = {mounting: sweep(mounting, size, progress) for mounting in MOUNTINGS}
    found = {mounting: rows for mounting, (rows, _) in sweeps.items()}
    balanced = {of: np.array([by_hand(rpm * RPM, of) for rpm in size.speeds]) for of in MOUNTINGS}
    result = sweeps["offset"][1]
    result.save(f"{stem}.h5", overwrite=True)
    wf.record(result, f"{stem}.rrd", overwrite=True)
    save_panels(panels(size, found, balanced), f"{stem}.png", overwrite=True)

    for of in MOUNTINGS:
        for row, (rpm, run, hand) in enumerate(zip(size.speeds, found[of], balanced[of], strict=True)):
            angles = np.degrees([run[3], hand[3], run[4], hand[4]])
            print(
                f"{of if row == 0 else '':6s} {rpm:7.0f} rpm: preload {run[0]:7.2f} N, NumPy {hand[0]:7.2f}; inner "
                f"{angles[0]:6.3f} deg, NumPy {angles[1]:6.3f}; outer {angles[2]:6.3f} deg, NumPy {angles[3]:6.3f}"
            )
    return [result]


if __name__ == "__main__":
    main()
