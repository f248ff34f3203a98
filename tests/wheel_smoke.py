"""A small scene with public names only: what CI runs with the installed wheel, from another folder.

Two steel rollers; the lower is driven on a fixed axle, the upper is pressed on it along a guide. Statics gives
the expected value: the contact carries the preload and the weight of the upper roller.
Run: python wheel_smoke.py
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np

import warpffrf as wf

PRELOAD = 20_000.0  # N
GRAVITY = 9.81  # m/s2
FORCE_TOLERANCE = 0.01  # two elements a half-width ripple, and the guide keeps a small oscillation


def build() -> wf.Scene:
    steel = wf.Material(youngs_modulus=210e9, poisson_ratio=0.3, density=7850)
    size = {"outer_radius": 0.05, "inner_radius": 0.015, "width": 0.02}  # m
    mesh = wf.mesh.roller(**size, sectors=1200, layers=14, axial=2, grading=1.3, order=1)
    roller = wf.reduce(
        mesh, steel, interfaces={"bore": "rigid"}, contact={"rim": wf.surfaces.Cylinder()}, max_frequency=20e3
    )
    scene = wf.Scene(gravity=(0, 0, -GRAVITY))
    lower = scene.add_body(roller, name="lower")
    upper = scene.add_body(roller, name="upper", position=(0, 0, 0.1))
    axle = scene.add(wf.joints.Revolute(scene.ground, lower["bore"], axis=(0, 1, 0)))
    scene.add(wf.joints.Drive(axle, wf.signals.SmoothStep(0.0, 10.0, duration=2e-3), quantity="velocity"))
    contact = scene.add(wf.Contact(lower["rim"], upper["rim"]))
    scene.close_gap(contact)
    guide = scene.add(wf.joints.Prismatic(scene.ground, upper["bore"], axis=(0, 0, 1)))
    scene.add(wf.forces.JointSpringDamper(guide, stiffness=1e5, damping=1e3, preload=PRELOAD))
    return scene


def main() -> int:
    scene = build()
    print(scene.check())
    result = wf.simulate(scene, duration=4e-3, step=1e-4, start="equilibrium", results="smoke.h5")
    force = -result.contact("lower-upper").force[:, 2]
    expected = PRELOAD + scene.body("upper").mass * GRAVITY
    print(result.report())
    print(f"warpffrf from {Path(wf.__file__).parent}: status {result.status}, contact force {force[-1]:.6g} N")
    fine = result.status == "completed" and np.all(np.abs(force / expected - 1.0) < FORCE_TOLERANCE)
    fine = fine and np.array_equal(wf.Result.load("smoke.h5").contact("lower-upper").force[:, 2], -force)
    return 0 if fine else 1


if __name__ == "__main__":
    sys.exit(main())
