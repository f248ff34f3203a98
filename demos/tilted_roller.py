r"""A crowned roller on a rigid plane, tilted by 0.5 mrad, then turned: where the load goes.

A small steel roller with a crown is pressed on a plane with 1 kN through a cradle that can tilt it. From the static
state the cradle tilts the roller's axis by phi = 0.5 mrad against the plane; then the roller is turned under its load.
Contact is frictionless.

What to expect. The crown is an arc of radius Rc about a point that lies Rc - R beyond the axis, on the line through the
middle of the roller; every normal of the crown in the plane of tilting goes through it. The normal that stands upright
when the roller is tilted is the one at

    z = Rc sin(phi)

along the axis, so that the patch moves there, and the cradle has to hold the torque P (Rc - R) sin(phi). The patch is
Hertz's ellipse, with R and Rc as relative radii, tilted or not; the load and its line of action stay when the roller
turns, and frictionless contact has no torque about the roller's axis.
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
RADIUS, BORE_RADIUS, WIDTH, TREAD, CROWN = 0.01, 0.003, 0.02, 0.011, 2.0  # m; TREAD: finely meshed, CROWN: Rc
LOAD, TILT = 1e3, 0.5e-3  # N, rad
HERTZ = EllipticContact(LOAD, RADIUS, CROWN, contact_modulus(STEEL))
SHIFT = CROWN * float(np.sin(TILT))  # m
CARRIAGE_MASS, CARRIAGE_INERTIA = 1.0, (1e-3, 1e-3, 1e-3)  # kg, kg m2
SPEED = 50.0  # rad/s
TILTING, WAITING, TURNING, STEP = 0.02, 0.005, 0.02, 2e-4  # s
RHO_INF = 0.5
PAIR, GUIDE, TILTS, AXLE = "roller-plane", "guide", "tilt", "axle"
BALANCE = 1e-6  # of the load at rest: what the tilted cradle still moves
SHAKES = 2e-3  # of the load while it turns: cells of the contact grid pass, and the carriage has inertia
PLACE = 0.01  # of the shift: the roller gives way under the torque
TORQUE = 0.01  # of P (Rc - R) sin(phi)
AXES, PEAK = 0.02, 0.02  # of half-axes and peak pressure: four nodes around and six along in a half-axis
ROUND = 0.01  # of the approach, by which the height may vary while the roller turns: cells of the contact grid pass


@dataclass(frozen=True)
class Size:
    """Quadratic cells of the roller, and how many frames the recording shows at most."""

    sectors: int = 1100  # four nodes in the half-axis across
    layers: int = 9
    axial: int = 12  # six nodes in the half-axis along
    frames: int = 100


FULL, QUICK = Size(), Size(sectors=900, layers=8, axial=10, frames=15)


def build(size: Size = FULL, *, progress: bool = True) -> wf.Scene:
    """The scene: bodies `roller`, `carriage`, `cradle`, joints `guide`, `tilt`, `axle`, contact pair `roller-plane`."""
    mesh = wf.mesh.roller(
        RADIUS, BORE_RADIUS, WIDTH, crown_radius=CROWN, sectors=size.sectors, layers=size.layers, axial=size.axial,
        tread=TREAD,
    )  # fmt: skip
    reduced = wf.reduce(
        mesh, STEEL, interfaces={"bore": "rigid"}, contact={"tread": wf.surfaces.CrownedCylinder(crown_radius=CROWN)},
        modes=0, progress=progress,
    )  # fmt: skip
    scene = wf.Scene()
    roller = scene.add_body(reduced, name="roller", position=(0, 0, RADIUS))
    plane = wf.surfaces.Plane(origin=(0, 0, 0), outward=(0, 0, 1), direction=(0, 1, 0))
    scene.add(wf.Contact(roller["tread"], scene.ground.surface(plane, name="plane"), name=PAIR))
    at = roller["bore"].world_point()
    carriage, cradle = (
        scene.add_rigid_body(CARRIAGE_MASS, CARRIAGE_INERTIA, name=name, position=at).at((0, 0, 0))
        for name in ("carriage", "cradle")
    )
    scene.add(wf.joints.Prismatic(scene.ground, carriage, axis=(0, 0, 1), name=GUIDE))
    tilt = scene.add(wf.joints.Revolute(carriage, cradle, axis=(-1, 0, 0), name=TILTS))
    axle = scene.add(wf.joints.Revolute(cradle, roller["bore"], axis=(0, 1, 0), name=AXLE))
    scene.add(wf.joints.Drive(tilt, wf.signals.SmoothStep(0.0, TILT, duration=TILTING), quantity="position"))
    spin = wf.signals.SmoothStep(0.0, SPEED, duration=0.5 * TURNING, delay=TILTING + WAITING)
    scene.add(wf.joints.Drive(axle, spin, quantity="velocity"))
    scene.add(wf.forces.PointForce(carriage, (0, 0, -LOAD), name="press"))
    return scene


def run(scene: wf.Scene, *, progress: bool = True) -> wf.Result:
    """Tilting, waiting and turning, from the static state of the level roller."""
    end, integrator = TILTING + WAITING + TURNING, wf.GeneralizedAlpha(RHO_INF)
    return wf.simulate(scene, end, step=STEP, start="equilibrium", integrator=integrator, progress=progress)


def checks(result: wf.Result) -> list[Check]:
    """The figures of a run: level, tilted, turning."""
    pair, t = result.contact(PAIR), result.time
    tilted = int(np.flatnonzero(t <= TILTING + WAITING + 0.5 * STEP)[-1])
    a, b = HERTZ.half_axes
    found = []
    for label, i, shift, balance in (
        ("level", 0, 0.0, BALANCE), ("tilted", tilted, SHIFT, BALANCE), ("turning", len(t) - 1, SHIFT, SHAKES)
    ):  # fmt: skip
        found += [
            Check(f"{label}: force upwards", float(pair.force[i, 2]), LOAD, "statics", balance, "N"),
            Check(f"{label}: patch along the axis", float(pair.center_of_pressure[i, 1]), shift, "Rc sin(phi)", PLACE,
                  "mm", 1e3, scale=SHIFT),
            Check(f"{label}: half-axis across", float(pair.half_widths[i, 0]), a, "Hertz", AXES, "um", 1e6),
            Check(f"{label}: half-axis along", float(pair.half_widths[i, 1]), b, "Hertz", AXES, "mm", 1e3),
            Check(f"{label}: peak pressure", float(pair.peak_pressure[i]), HERTZ.peak_pressure, "Hertz", PEAK, "MPa",
                  1e-6),
        ]  # fmt: skip
    torque = float(np.abs(result.joint(TILTS).torque[tilted, 0]))
    expected = LOAD * (CROWN - RADIUS) * float(np.sin(TILT))
    lowest = float(pair.history.pressure.min())
    turning = t > TILTING + WAITING + 0.5 * TURNING
    way = result.joint(GUIDE).coordinate[turning]
    return [
        *found,
        Check("torque of the cradle", torque, expected, "P (Rc - R) sin(phi)", TORQUE, "N m"),
        Check("lowest pressure", min(lowest, 0.0), 0.0, "unilateral", 0.0, "Pa", scale=HERTZ.peak_pressure),
        Check("height while turning varies by", float(np.ptp(way)), 0.0, "round roller, over the approach",
              ROUND, "nm", 1e9, scale=HERTZ.approach),
    ]  # fmt: skip


def panels(result: wf.Result) -> list:
    """Where the patch is, the torque that holds the tilt, and pressure along and across the patch."""
    from warpffrf.output.plots.panels import Panel

    pair, t = result.contact(PAIR), result.time
    tilted = int(np.flatnonzero(t <= TILTING + WAITING + 0.5 * STEP)[-1])
    phi = result.joint(TILTS).coordinate
    along, across, exact = {}, {}, {}
    for label, i in (("level", 0), ("tilted", tilted)):
        at = pair.pressure(i)
        middle = int(np.argmax(at.pressure.max(axis=1)))
        along[label] = (at.z * 1e3, at.pressure[middle] / 1e6)
        across[label] = (at.arc * 1e6, pair.mid_pressure[i] / 1e6)
        z = np.linspace(at.z[0], at.z[-1], 301)
        shift = CROWN * np.sin(phi[i])
        exact[f"Hertz, {label}"] = (z * 1e3, HERTZ.pressure(0.0 * z, z - shift) / 1e6)
    x = np.linspace(-1.5 * HERTZ.half_axes[0], 1.5 * HERTZ.half_axes[0], 201)
    return [
        Panel("Centre of pressure along the axis", "time [s]", "[mm]",
              {"run": (t, pair.center_of_pressure[:, 1] * 1e3)}, {"Rc sin(phi)": (t, CROWN * np.sin(phi) * 1e3)}),
        Panel("Torque that holds the tilt", "time [s]", "[N m]",
              {"run": (t, np.abs(result.joint(TILTS).torque[:, 0]))},
              {"P (Rc - R) sin(phi)": (t, LOAD * (CROWN - RADIUS) * np.sin(phi))}),
        Panel("Force less the load", "time [s]", "[N]", {"contact": (t, pair.force[:, 2] - LOAD)}),
        Panel("Pressure along the patch", "z [mm]", "[MPa]", along, exact),
        Panel("Pressure across the patch", "arc [um]", "[MPa]", across,
              {"Hertz": (x * 1e6, HERTZ.pressure(x, 0.0 * x) / 1e6)}),
    ]  # fmt: skip


def main(out: str | Path = "out/tilted_roller", *, quick: bool = False, progress: bool = True) -> int:
    """Run the demo and write tilted_roller.h5, .rrd, .png and summary.json into the folder `out`; 0 when all went well.

    quick: larger cells. Raises `InputError` for a folder that cannot be written.
    """
    folder = writable_folder(out)
    size = QUICK if quick else FULL
    log.info("tilted roller: %g mrad, crown of %g m, %g N", TILT * 1e3, CROWN, LOAD)
    result = run(build(size, progress=progress), progress=progress)
    if result.status != "completed":
        log.error("the run ended early, %s: %s", result.status, result.message)
        return 1
    return finish(folder / "tilted_roller", {"run": result}, checks(result), panels(result), frames=size.frames)
