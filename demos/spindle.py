r"""A spindle on a preloaded pair of angular contact ball bearings: preload and contact angles against speed.

Two bearings back to back, twelve balls at 15 degrees each. Three mountings:

    offset    raceways ground 10 um off the faces of the rings, which a nut pulls together
    warm      the same, with inner raceways that have grown by 3 um in radius against the outer ones
    spring    the outer ring of the rear bearing slides and is pushed by a spring of 120 N

At speed balls press on the outer ring by their centrifugal force and roll at a smaller contact angle there, a larger
one on the inner ring. Rings that are held then press more, those with a spring do not.

**Runs** begin with rolling at the contact angles of an earlier one, two at each speed; friction, also of pivoting,
finds orbit and axis of the balls.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

import warpffrf as wf
from warpffrf.output.plots.panels import Panel, save_panels

STEEL = wf.Material(youngs_modulus=210e9, poisson_ratio=0.3, density=7850, name="steel")
COUNT, BALL, PITCH, GROOVE = 12, 8e-3, 50e-3, 4.24e-3  # balls; m: diameters, radius of the grooves
ANGLE, APART = np.radians(15.0), 60e-3  # rad, m between the bearings
OFFSET, GROWTH, SPRING, RATE = 10e-6, 3e-6, 120.0, 5e3  # m, m, N, N/m
MOUNTINGS = ("offset", "warm", "spring")
RPM = np.pi / 30.0  # rad/s
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


def found_in(result: wf.Result) -> np.ndarray:
    """Preload [N], loads of a ball [N] and contact angles [rad] on the inner and the outer ring, of the front bearing
    at the end of a run: means of its balls."""
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


def panels(size: Size, found: dict[str, np.ndarray]) -> list[Panel]:
    """Preload, contact angles and loads over the speed; found: (speeds, 5) by mounting."""
    x = np.array(size.speeds) / 1e3

    def panel(title: str, unit: str, factor: float, columns: dict[str, tuple[str, int]]) -> Panel:
        curves = {name: (x, factor * found[of][:, k]) for name, (of, k) in columns.items()}
        return Panel(title, "speed [1000 rpm]", unit, curves)

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
    result = sweeps["offset"][1]
    result.save(f"{stem}.h5", overwrite=True)
    wf.record(result, f"{stem}.rrd", overwrite=True)
    save_panels(panels(size, found), f"{stem}.png", overwrite=True)

    for of in MOUNTINGS:
        for row, (rpm, run) in enumerate(zip(size.speeds, found[of], strict=True)):
            inner, outer = np.degrees(run[3:])
            print(
                f"{of if row == 0 else '':6s} {rpm:7.0f} rpm: preload {run[0]:7.2f} N, contact angles {inner:6.3f} deg "
                f"on the inner ring, {outer:6.3f} deg on the outer ring"
            )
    return [result]


if __name__ == "__main__":
    main()
