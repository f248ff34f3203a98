r"""Two steel rollers with friction: one driven, the other carried along, then braked until it slips.

The lower roller rotates on a fixed axle and is driven. The upper one, with a flywheel on its shaft, rotates freely in a
carriage that is pressed down. Only friction in the contact drives it: while the lower roller speeds up from rest the
upper one is carried along; then they roll freely; then a brake on the flywheel rises in stairs, held on each until
the contact has settled; finally it exceeds the limit of friction, and the whole patch slips.

What to expect. Carried along and rolling freely, the surface speeds agree except for the creepage of the tangential
force. On every stair of the brake, Q = M/R, force and creepage are on Carter's curve,

    xi = (mu a/R') (1 - sqrt(1 - Q/(mu P))),    1/R' = 1/R1 + 1/R2,    a^2 = 4 P' R'/(pi E*)

(K. L. Johnson, Contact Mechanics, 1985, section 8.3), except for the free ends of the rollers: his are in plane strain,
these are as wide as eight patches. In gross slip the traction coefficient is mu.

The rollers are meshed in elements of 4 mm, seven times half of the patch: friction is in cells that travel with the
patch. It advances by nearly one cell per step, and on every stair of the brake it runs through its own length `HELD`
times, as creep requires to build up the elastic shift of the surfaces against their axles.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

import warpffrf as wf
from warpffrf.output.plots.friction import StickSlipMap
from warpffrf.output.plots.panels import Panel, save_panels

STEEL = wf.Material(youngs_modulus=210e9, poisson_ratio=0.3, density=7850, name="steel")
OUTER_RADIUS, BORE_RADIUS, WIDTH = 0.05, 0.015, 0.01  # m
LOAD, FRICTION = 13e3, 0.3  # N, -
CARRIAGE_MASS, CARRIAGE_INERTIA = 5.0, (0.01, 0.01, 0.01)  # kg, kg m2
FLYWHEEL_MASS, FLYWHEEL_INERTIA = 20.0, (0.1, 0.2, 0.1)  # kg, kg m2: with it slip grows slowly
SPEED = 10.0  # rad/s of the driven roller
SPIN_UP = 0.04  # s: the largest torque on the upper one is half of the limit of friction
RELATIVE_RADIUS = 0.5 * OUTER_RADIUS  # m, R'
MODULUS = STEEL.youngs_modulus / (2.0 * (1.0 - STEEL.poisson_ratio**2))  # Pa, E*
HALF_WIDTH = float(np.sqrt(4.0 * LOAD / WIDTH * RELATIVE_RADIUS / (np.pi * MODULUS)))  # m, a
CROSSING = 2.0 * HALF_WIDTH / (SPEED * OUTER_RADIUS)  # s, in which the material runs through the patch
FREE, RISE, HELD, LAST = 10, 8, 14, 6  # crossings: rolling freely, the brake rises, is held, the patch slips
SETTLED = 6  # crossings at the end of each of these parts that are averaged, three periods of the flywheel
SHARES, BEYOND = (0.25, 0.5, 0.75), 1.1  # of the limit of friction: where the brake waits, and its end
ADVANCE = 0.9  # cells by which the patch advances per step; above one friction is not resolved
PAIR, BRAKE = "lower-upper", "brake"


@dataclass(frozen=True)
class Size:
    """Quadratic hexahedra of a roller around, through the wall and along the axis; `patch`: cells across and along of
    a contact grid that travels with the patch, None for the grid of the mesh."""

    sectors: int = 2000  # eight nodes in a half-width
    layers: int = 9
    axial: int = 2
    patch: tuple[int, int] | None = None

    @property
    def spacing(self) -> float:
        """m, of the contact grid: the nodes of quadratic cells, or cells of the patch, which reach 1.3 half-widths."""
        if self.patch is not None:
            return 2.6 * HALF_WIDTH / self.patch[0]
        return np.pi * OUTER_RADIUS / self.sectors

    @property
    def step(self) -> float:
        """s."""
        return ADVANCE * self.spacing / (SPEED * OUTER_RADIUS)


BIG_CELLS = Size(sectors=78, layers=8, axial=3, patch=(13, 9))  # of 4 mm
QUICK = Size(sectors=78, layers=8, axial=2, patch=(11, 5))


@dataclass(frozen=True)
class Schedule:
    """Times [s]: end of rolling freely, ends of the waits on `SHARES`, end of the run."""

    free: float
    waits: tuple[float, ...]
    end: float


def schedule() -> Schedule:
    """The times of a run, from the crossings of the patch that its parts take."""
    free = SPIN_UP + FREE * CROSSING
    waits = tuple(free + n * (RISE + HELD) * CROSSING for n in range(1, len(SHARES) + 1))
    return Schedule(free, waits, waits[-1] + (RISE + LAST) * CROSSING)


def brake() -> wf.signals.Table:
    """Torque of the brake over time [N m]: smooth rises to `SHARES` of the limit of friction, then to `BEYOND` of it;
    a kink would excite the flywheel."""
    plan, x = schedule(), np.linspace(0.0, 1.0, 17)
    smooth = x**3 * (10.0 - 15.0 * x + 6.0 * x**2)
    times, shares, level = [], [], 0.0
    for start, share in zip((plan.free, *plan.waits), (*SHARES, BEYOND), strict=True):
        times.append(start + RISE * CROSSING * x)
        shares.append(level + (share - level) * smooth)
        level = share
    torque = np.concatenate(shares) * FRICTION * LOAD * OUTER_RADIUS
    return wf.signals.Table(np.concatenate(times), torque, hold=True)


def build(size: Size = BIG_CELLS, *, progress: bool = True) -> wf.Scene:
    """The scene: bodies `lower`, `upper`, `carriage`, `flywheel`, contact `lower-upper`, torque `brake`.

    The press is a force on the carriage; there is no gravity, so that the contact carries `LOAD`.
    """
    mesh = wf.mesh.roller(
        OUTER_RADIUS, BORE_RADIUS, WIDTH, sectors=size.sectors, layers=size.layers, axial=size.axial, order=2
    )
    roller = wf.reduce(
        mesh, STEEL, interfaces={"bore": "rigid"}, contact={"rim": wf.surfaces.Cylinder()}, modes=0,
        grid=wf.ContactGrid(tangential=True, contact_fixed=size.patch is not None), progress=progress,
    )  # fmt: skip
    scene = wf.Scene()
    lower = scene.add_body(roller, name="lower")
    upper = scene.add_body(roller, name="upper", position=(0, 0, 2 * OUTER_RADIUS))
    grid: dict[str, Any] = {} if size.patch is None else {"grid": "contact_fixed", "cells": size.patch}
    contact = scene.add(wf.Contact(lower["rim"], upper["rim"], friction=FRICTION, name=PAIR, **grid))
    scene.close_gap(contact)
    place = upper["bore"].world_point()
    carriage = scene.add_rigid_body(CARRIAGE_MASS, CARRIAGE_INERTIA, name="carriage", position=place)
    flywheel = scene.add_rigid_body(FLYWHEEL_MASS, FLYWHEEL_INERTIA, name="flywheel", position=place)
    axle = scene.add(wf.joints.Revolute(scene.ground, lower["bore"], axis=(0, 1, 0), name="axle"))
    scene.add(wf.joints.Prismatic(scene.ground, carriage, axis=(0, 0, 1), name="guide"))
    scene.add(wf.joints.Revolute(carriage, upper["bore"], axis=(0, 1, 0), name="upper_axle"))
    scene.add(wf.joints.Fixed(upper["bore"], flywheel, name="shaft"))
    spin = wf.signals.SmoothStep(0.0, SPEED, duration=SPIN_UP)
    scene.add(wf.joints.Drive(axle, spin, quantity="velocity"))
    scene.add(wf.forces.PointForce(carriage, (0, 0, -LOAD), name="press"))
    scene.add(wf.forces.PointTorque(flywheel, (brake(), (0, 1, 0)), name=BRAKE))
    return scene


def run(scene: wf.Scene, size: Size, *, progress: bool = True) -> wf.Result:
    """The whole schedule from the static state under the press."""
    end, options = schedule().end, wf.RunOptions(save_every=4)
    return wf.simulate(scene, end, step=size.step, start="equilibrium", options=options, progress=progress)


def settled(result: wf.Result, values: np.ndarray, end: float) -> float:
    """Mean of `values` (T,) over the last `SETTLED` crossings before `end` [s], weighted by sin^2: what remains of the
    flywheel's oscillation averages out."""
    x = (end - result.time) / (SETTLED * CROSSING)
    inside = (x > 0.0) & (x < 1.0)
    return float(np.average(values[inside], weights=np.sin(np.pi * x[inside]) ** 2))


def shares(result: wf.Result) -> np.ndarray:
    """Q/(mu P) (T,) with which the lower roller drives the upper one."""
    pair = result.contact(PAIR)
    return -pair.friction.tangential_force[:, 0] / (FRICTION * pair.normal_load)


def carter(share: np.ndarray | float) -> np.ndarray:
    """Creepage at Q/(mu P) and the mean line load."""
    return FRICTION * HALF_WIDTH / RELATIVE_RADIUS * (1.0 - np.sqrt(1.0 - share))


def main(out: str | Path = "out/rolling_friction", *, quick: bool = False, progress: bool = True) -> list[wf.Result]:
    """Write rolling_friction.h5, .rrd and .png into the folder `out` and print the figures; quick: fewer cells."""
    stem, size = Path(out) / "rolling_friction", QUICK if quick else BIG_CELLS
    result = run(build(size, progress=progress), size, progress=progress)
    result.save(f"{stem}.h5", overwrite=True)
    wf.record(result, f"{stem}.rrd", max_frames=60 if quick else 200, overwrite=True)

    plan, t, found = schedule(), result.time, shares(result)
    creepage, q = result.contact(PAIR).friction.creepage[:, 0], np.linspace(0.0, 1.0, 101)
    braked = (t > plan.free) & (creepage < 1.5 * FRICTION * HALF_WIDTH / RELATIVE_RADIUS)
    at = [(settled(result, found, end), settled(result, creepage, end)) for end in plan.waits]
    speeds = {name: (t, OUTER_RADIUS * np.abs(result.body(name).angular_velocity[:, 1])) for name in ("lower", "upper")}
    second = int(np.flatnonzero(t <= plan.waits[1])[-1])
    save_panels([
        Panel("Surface speeds", "time [s]", "[m/s]", speeds),
        Panel("Tangential force over mu P", "time [s]", "[-]", {"run": (t, found)},
              {"brake": (t, brake()(t) / (FRICTION * LOAD * OUTER_RADIUS))}),
        Panel("Tangential force against creepage", "creepage [-]", "Q/(mu P) [-]",
              {"run": (creepage[braked], found[braked])}, {"Carter": (carter(q), q)},
              points={"settled": (np.array([xi for _, xi in at]), np.array([share for share, _ in at]))}),
        StickSlipMap("Stick and slip at half of the limit", result, second),
    ], f"{stem}.png", overwrite=True)  # fmt: skip

    for share, xi in at:
        print(f"Q/(mu P) = {share:.4f}: creepage {xi * 1e3:.4f}e-3, Carter {carter(share) * 1e3:.4f}e-3")
    force = result.contact(PAIR).force[-1]
    print(f"gross slip: traction coefficient {np.hypot(force[0], force[1]) / abs(force[2]):.5f}, Coulomb {FRICTION}")
    return [result]


if __name__ == "__main__":
    main()
