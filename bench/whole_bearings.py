"""Whole roller bearings between flexible rings, with and without friction.

`python bench/whole_bearings.py [--json FILE] [--only NAME ...] [--share OF_DURATION]`.

One geometry: rollers of 8.4 mm by 11 mm, raceways of 36 mm and 52.8 mm, 6 kN on the shaft, from equilibrium; by default
a fiftieth of each run, `--share 1` is the whole. *ms/step* is time in the program of a step over the steps asked for,
with all halves and repetitions. *energy* is the range of the ledger's residual, of the largest energy. *carried* is the
sum of the loads on the outer ring along the load, over it, at the end. A row that does not complete is printed with its
message.
"""

from __future__ import annotations

import argparse
import json
import time
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

from warpffrf.model import bearings, forces, joints, laws, signals, surfaces
from warpffrf.model.contact import Contact
from warpffrf.model.material import Material
from warpffrf.model.mesh import roller, sleeve
from warpffrf.model.reduced.body import ReducedBody
from warpffrf.model.scene import Scene
from warpffrf.offline import ContactGrid, reduce
from warpffrf.output.options import RunOptions
from warpffrf.output.simulate import simulate
from warpffrf.study.machine import machine

STEEL = Material(210e9, 0.3, 7850.0)
INNER, SHAFT, RADIUS, LENGTH, WALL = 0.018, 0.011, 0.0042, 0.011, 0.009  # m: raceway, bore; roller; outer ring
OUTER, PITCH = INNER + 2.0 * RADIUS, 2.0 * (INNER + RADIUS)
HALF_WIDTH = 1.2e-4  # m: of the most loaded contact; fine meshes have linear elements of half of it
LOAD = 6e3  # N
CLEARANCE, NEAR = 5e-6, 20e-6  # m; the inner ring begins displaced in the direction of the load
FRICTION = 0.05
CAPPED = (9, 5)  # strips across, rows along: five rows serve forces, 21 the pressure at the ends
LAMINAE = 5


@dataclass(frozen=True)
class Case:
    """A bearing and its run; rotated from rest to `speed` [rad/s] in `ramp` [s], or rolling from the start."""

    elements: int
    speed: float
    duration: float
    step: float
    friction: float = FRICTION
    cells: tuple[int, int] | None = CAPPED
    flexible: tuple[str, ...] = ("inner", "outer")
    fine: bool = False
    ramp: float = 0.0
    clearance: float = 0.0
    pockets: float = 0.0  # clearance of a pocket cage [m]; 0: a prescribed cage


RPM = 2.0 * np.pi / 60.0
RUN_UP = Case(9, 700.0 * RPM, 0.012, 4e-5, ramp=0.006)
REVOLUTION = Case(12, 1500.0 * RPM, 0.04, 4e-5, flexible=("outer",), clearance=CLEARANCE)
CASES = {
    "run-up, two rings": RUN_UP,
    "run-up, two rings, body-fixed": replace(RUN_UP, fine=True, cells=None),
    "run-up, two rings, frictionless, default cells": replace(RUN_UP, friction=0.0, cells=None),
    "revolution, outer ring": REVOLUTION,
    "revolution, outer ring, frictionless": replace(REVOLUTION, friction=0.0),
    "revolution, outer ring, default cells": replace(REVOLUTION, cells=None),
    "revolution, rings and rollers": replace(REVOLUTION, flexible=("inner", "outer", "rollers")),
    "revolution, rings and rollers, pocket cage": replace(
        REVOLUTION, flexible=("inner", "outer", "rollers"), pockets=1e-4
    ),
}


@cache
def body(part: str, fine: bool, tangential: bool) -> ReducedBody:
    """A ring or a roller, of elements of 1.3 to 1.8 mm, or with `fine` as the contact demands."""
    grid = ContactGrid(tangential=tangential, contact_fixed=not fine)
    if part == "inner":
        mesh = (
            roller(INNER, SHAFT, LENGTH, half_width=HALF_WIDTH, order=1, axial=4)
            if fine
            else roller(INNER, SHAFT, LENGTH, sectors=80, layers=4, axial=6)
        )
        return reduce(
            mesh, STEEL, interfaces={"bore": "rigid"}, contact={"rim": surfaces.Cylinder()}, modes=10, grid=grid,
            progress=False,
        )  # fmt: skip
    if part == "outer":
        mesh = (
            sleeve(OUTER, OUTER + WALL, LENGTH, sectors=int(4.0 * np.pi * OUTER / HALF_WIDTH), order=1, axial=4)
            if fine
            else sleeve(OUTER, OUTER + WALL, LENGTH, sectors=112, layers=5, axial=6)
        )
        return reduce(
            mesh, STEEL, interfaces={"outside": "rigid"}, contact={"bore": surfaces.Bore()}, modes=10, grid=grid,
            progress=False,
        )  # fmt: skip
    mesh = roller(RADIUS, 0.0, LENGTH, sectors=24, layers=2, axial=6)
    return reduce(
        mesh, STEEL, interfaces={"ends": "average"}, contact={"rim": surfaces.Cylinder()}, modes=6, grid=grid,
        progress=False,
    )  # fmt: skip


def bearing(case: Case) -> Scene:
    """Its scene; the contacts on the outer ring are "b outer 1", ..."""
    scene = Scene(gravity=(0.0, 0.0, -9.81))
    here = (0.0, 0.0, 0.0)

    def reduced(part: str) -> ReducedBody:
        return body(part, case.fine, case.friction > 0.0)

    housing = scene.add_body(reduced("outer"), name="outer")
    scene.add(joints.Fixed(scene.ground, housing["outside"], name="housing"))
    shaft = scene.add_body(reduced("inner"), name="inner") if "inner" in case.flexible else None
    orbit = case.speed * INNER / (INNER + OUTER)

    def turning(speed: float) -> Any:
        return signals.SmoothStep(0.0, speed, duration=case.ramp) if case.ramp > 0.0 else speed

    one = scene.add_bearing(
        "b",
        bearings.RollerGeometry(
            elements=case.elements, roller_diameter=2.0 * RADIUS - 0.5 * case.clearance, roller_length=LENGTH,
            pitch_diameter=PITCH, clearance=case.clearance,
        ),
        first=(0, 0, -1), inner=None if shaft is None else shaft["rim"], outer=housing["bore"],
        cage=bearings.PocketCage(case.pockets, friction=case.friction)
        if case.pockets
        else bearings.PrescribedCage(speed=turning(orbit)),
        contact=bearings.RollingContact(law=laws.PalmgrenLine(LENGTH, LAMINAE), friction=case.friction),
        materials=bearings.Materials(STEEL, element_body=reduced("rollers") if "rollers" in case.flexible else None),
    )  # fmt: skip
    for contact in one.contacts.values():
        if isinstance(contact, Contact):
            contact.cells = case.cells
    across = scene.add_rigid_body(0.5, (1e-3,) * 3, name="across")
    hub = scene.add_rigid_body(0.5, (1e-3,) * 3, name="hub")
    slides = (
        scene.add(joints.Prismatic(scene.ground, across.at(here), axis=(1, 0, 0), name="slide x")),
        scene.add(joints.Prismatic(across.at(here), hub.at(here), axis=(0, 0, 1), name="slide z")),
    )
    for slide in slides:
        scene.add(forces.JointSpringDamper(slide, stiffness=1e4, damping=200.0, name=f"{slide.name} spring"))
    if case.clearance:
        one.inner.position = hub.position = np.array([0.0, 0.0, -NEAR])
        for element in one.elements:
            out = element.position / np.linalg.norm(element.position)
            element.position = element.position + max(0.0, -0.45 * NEAR * out[2]) * out
    port = one.inner.at(here) if shaft is None else shaft["bore"]
    axle = scene.add(joints.Revolute(hub.at(here), port, axis=(0, 1, 0), name="shaft"))
    if case.ramp == 0.0:
        one.roll(case.speed, 0.0)
    scene.add(joints.Drive(axle, turning(case.speed), quantity="velocity", name="drive"))
    scene.add(forces.PointForce(hub.at(here), (0.0, 0.0, -LOAD), name="load"))
    return scene


def run(name: str, case: Case, share: float) -> dict:
    """Figures of its run, over `share` of its duration."""
    scene = bearing(case)
    begun, used = time.perf_counter(), time.process_time()
    steps = max(round(share * case.duration / case.step), 1)
    result = simulate(
        scene,
        steps * case.step,
        step=case.step,
        start="equilibrium",
        options=RunOptions(project_start=True),
        progress=False,
    )
    row: dict[str, Any] = {
        "case": name, "status": result.status, "message": result.message, "wall_seconds": time.perf_counter() - begun,
        "cpu_seconds": time.process_time() - used,
    }  # fmt: skip
    counters = result.history.counters
    row["asked"], row["done"] = steps, max(len(result.time) - 1, 0)
    row["seconds_per_step"] = counters["seconds_in_graph"] / max(row["done"], 1)
    row["iterations"], row["halved"] = counters["mean_iterations"], int(counters["rejected_steps"])
    row["largest"] = row["carried"] = row["energy"] = float("nan")
    if len(result.time):
        pushed = [result.contact(f"b outer {i + 1}").force[-1] for i in range(case.elements)]
        row["largest"] = float(np.linalg.norm(pushed, axis=1).max())
        row["carried"] = float(abs(np.sum(pushed, axis=0)[2]) / LOAD)
        row["energy"] = float(np.ptp(result.energy_residual))
    return row


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--json", type=Path, help="write machine, versions and rows to this file")
    parser.add_argument("--only", nargs="*", help="names of cases", choices=list(CASES), default=list(CASES))
    parser.add_argument("--share", type=float, default=0.02, help="of the duration of each run")
    given = parser.parse_args()
    about = machine()
    print(f"U = {about['unit_seconds'] * 1e6:.1f} us")
    rows = []
    for name in given.only:
        row = run(name, CASES[name], given.share)
        rows.append(row)
        print(
            f"{name:50s} {row['status']:14s} {row['done']:5d}/{row['asked']:<5d} {row['cpu_seconds']:7.1f} s CPU "
            f"{row['seconds_per_step'] * 1e3:8.1f} ms/step {row['iterations']:6.2f} it {row['halved']:4d} halved "
            f"{row['largest']:7.1f} N at most, carried {row['carried']:.4f}, energy {row['energy']:.1e}",
            flush=True,
        )
        if row["message"]:
            print("   ", row["message"], flush=True)
    if given.json:
        given.json.write_text(json.dumps({**about, "rows": rows}, indent=1) + "\n")


if __name__ == "__main__":
    main()
