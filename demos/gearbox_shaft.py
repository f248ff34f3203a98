r"""A gearbox shaft on a locating ball bearing and a non-locating roller bearing, in a housing that yields as well.

A shaft of 40 mm runs in the end walls of a housing of cast iron: at one end in a deep groove ball bearing 6208, which
also takes the thrust, at the other in a cylindrical roller bearing NU 208, in which the shaft is free along its axis. A
helical gear between them is loaded tangentially, radially and along the axis at its pitch radius, so that the thrust
bends the shaft, too; a coupling takes its torque.

Shaft and housing are flexible bodies. The rings are rigid and mounted on interfaces of both, `inner=shaft["locating"]`,
`outer=housing["locating"]`; balls and rollers are in lumped contact with them. The inside of the bearings is an
estimate by their designations.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from scipy.spatial.transform import Rotation

import warpffrf as wf
from warpffrf.output.plots.panels import Panel, Polar, save_panels

STEEL = wf.Material(youngs_modulus=210e9, poisson_ratio=0.3, density=7850, name="steel")
IRON = wf.Material(youngs_modulus=110e9, poisson_ratio=0.27, density=7150, name="cast iron")
RADIUS, LENGTH, SEAT = 0.020, 0.26, 0.02  # m: of the shaft, and width of its seats and of the walls
PLACES = {"locating": -0.10, "gear": 0.02, "non-locating": 0.10}  # m: y along the shaft
BEARINGS = "locating", "non-locating"
TOOTH, FORCE = (0.06, 0.0, 0.0), (-1200.0, 1000.0, 3200.0)  # m from the middle of the gear, N
BORE, BOSS, INSIDE, OUTSIDE = 0.040, 0.050, 0.068, 0.080  # m: radii at a bore, half widths of the housing
FOOT = 0.05  # m from the middle, where the feet begin
COUPLING = 1e5  # N m/rad
BALL = wf.bearings.catalogue("6208", clearance=10e-6)
ROLLER = wf.bearings.catalogue("NU 208", clearance=20e-6)


@dataclass(frozen=True)
class Size:
    """Cells along the shaft, and of the housing around a bore and between its walls."""

    axial: int = 26
    sectors: int = 32
    between: int = 6


FULL, QUICK = Size(), Size(axial=13, sectors=16, between=3)


def shaft(size: Size = FULL) -> wf.mesh.Mesh:
    """The mesh of the shaft with the facet sets `locating`, `gear` and `non-locating` on its surface."""
    mesh = wf.mesh.roller(RADIUS, 0.0, LENGTH, sectors=8, layers=2, axial=size.axial)
    for name, y in PLACES.items():
        mesh = mesh.select(name, "rim", lambda x, y=y: np.abs(x[:, 1] - y) < 0.5 * SEAT)
    return mesh


def housing(size: Size = FULL) -> wf.mesh.Mesh:
    """The mesh of the housing, a square tube with end walls and open at the top, facet sets of the bores and `feet`.

    Three layers of cells around the bores become a boss, a wall and the tube, which alone remains between the walls.
    """
    along, layers = size.between + 2, [1.0, 2.0, 3.0, 4.0]
    sleeve = wf.mesh.sleeve(1.0, 4.0, along, sectors=size.sectors, axial=along, layers=3, grading=1.0)
    (x, y, z), cells = sleeve.points.T, sleeve.cells["hex27"]
    depth, angle = np.hypot(x, z), np.arctan2(z, x)
    middle = sleeve.points[cells].mean(axis=1)
    tube = (depth[cells].mean(axis=1) > 3.0) & (middle[:, 2] < np.abs(middle[:, 0]))
    used, cells = np.unique(cells[tube | (np.abs(middle[:, 1]) > 0.5 * along - 1.0)], return_inverse=True)
    square = 1.0 / np.maximum(np.abs(np.cos(angle)), np.abs(np.sin(angle)))  # radius over half width
    radius = np.interp(depth, layers, [BORE, BOSS, 0, 0]) + square * np.interp(depth, layers, [0, 0, INSIDE, OUTSIDE])
    ends = np.add.outer([PLACES[name] for name in BEARINGS], [-0.5 * SEAT, 0.5 * SEAT]).ravel()
    place = np.interp(y, [-0.5 * along, 1.0 - 0.5 * along, 0.5 * along - 1.0, 0.5 * along], ends)
    points = np.stack([radius * np.cos(angle), place, radius * np.sin(angle)], axis=1)[used]
    mesh = wf.mesh.Mesh(points, {"hex27": cells.reshape(-1, 27)}, name="housing")
    mesh = mesh.select_cylinder("bores", axis_point=(0, 0, 0), axis_direction=(0, 1, 0), radius=BORE)
    mesh = mesh.select_plane("bottom", point=(0, 0, -OUTSIDE), normal=(0, 0, -1))
    for name in BEARINGS:
        mesh = mesh.select(name, "bores", lambda x, y=PLACES[name]: np.abs(x[:, 1] - y) < 0.5 * SEAT)
    return mesh.select("feet", "bottom", lambda x: np.abs(x[:, 0]) > FOOT)


def build(size: Size = FULL, *, progress: bool = True) -> wf.Scene:
    """The scene: bodies `shaft` and `housing`, bearings `locating` and `non-locating`, force and torque `gear`."""
    places = dict.fromkeys([*PLACES, "end_high"], "average")
    rod = wf.reduce(shaft(size), STEEL, interfaces=places, modes=6, progress=progress)
    places = {**dict.fromkeys(BEARINGS, "average"), "feet": "rigid"}
    cast = wf.reduce(housing(size), IRON, interfaces=places, modes=6, progress=progress)
    scene = wf.Scene()
    axle, box = scene.add_body(rod, name="shaft"), scene.add_body(cast, name="housing")
    scene.add(wf.joints.Fixed(scene.ground, box["feet"], name="feet"))
    for name, geometry in zip(BEARINGS, (BALL, ROLLER), strict=True):
        rings: Any = {
            "position": (0.0, PLACES[name], 0.0),
            "first": (0, 0, -1),
            "inner": axle[name],
            "outer": box[name],
        }
        if isinstance(geometry, wf.bearings.RollerGeometry):  # NU: ribs on the outer ring
            scene.add_bearing(name, geometry, flanges=wf.bearings.Flanges(50e-6), **rings)
        else:
            scene.add_bearing(name, geometry, **rings)
    coupling = scene.ground.at((0.0, 0.5 * LENGTH, 0.0)), axle["end_high"]
    scene.add(wf.forces.Bushing(*coupling, (0.0, 0.0, 0.0, 0.0, COUPLING, 0.0), name="coupling"))
    scene.add(wf.forces.PointForce(axle["gear"], FORCE, name="gear"))
    scene.add(wf.forces.PointTorque(axle["gear"], tuple(np.cross(TOOTH, FORCE)), name="gear torque"))
    return scene


def bending(result: wf.Result) -> tuple[np.ndarray, np.ndarray]:
    """Places y (n,) [m] along the shaft and displacements (n, 3) [m] of its axis, means of the circles of its skin."""
    skin, body = result.skins()["shaft"], result.body("shaft")
    turn = Rotation.from_quat(body.rotation[-1])
    moved = body.position[-1] + turn.apply(skin.points + skin.displacement(-1)) - skin.points
    places, circle = np.unique(np.round(skin.points[:, 1], 6), return_inverse=True)
    rim = np.hypot(skin.points[:, 0], skin.points[:, 2]) > 0.99 * RADIUS
    return places, np.array([moved[rim & (circle == i)].mean(axis=0) for i in range(len(places))])


def panels(result: wf.Result) -> list[Panel]:
    """Load zones, the axis of the shaft, and the loads along the most loaded roller."""
    drawn: list[Panel] = []
    for name in BEARINGS:
        found = result.bearing(name)
        angle = np.append(found.angle[-1], found.angle[-1, 0])
        loads = {"outer ring": (angle, np.append(found.outer_load[-1], found.outer_load[-1, 0]) / 1e3)}
        drawn.append(Polar(f"Load zone, {name}", "angle from -z", "[kN]", loads))
    y, moved = bending(result)
    seats = np.array([PLACES[name] for name in BEARINGS])
    rings = np.array([result.body(f"{name} outer ring").position[-1] for name in BEARINGS])
    roller = int(np.argmax(result.bearing("non-locating").inner_load[-1])) + 1
    laminae = result.lumped_contact(f"non-locating inner {roller}").lamina_force[-1]
    width = ROLLER.roller_length / len(laminae)
    along = width * (np.arange(len(laminae)) - 0.5 * (len(laminae) - 1))
    return [
        *drawn,
        Panel("The shaft's axis, and the outer rings (points)", "y [mm]", "[µm]",
              {f"along {c}": (1e3 * y, 1e6 * moved[:, i]) for c, i in (("x", 0), ("z", 2))},
              points={f"outer rings, {c}": (1e3 * seats, 1e6 * rings[:, i]) for c, i in (("x", 0), ("z", 2))}),
        Panel(f"Load along roller {roller}, inner ring", "from its middle [mm]", "[N/mm]",
              {"roller": (1e3 * along, 1e-3 * laminae / width)}),
    ]  # fmt: skip


def main(out: str | Path = "out/gearbox_shaft", *, quick: bool = False, progress: bool = True) -> list[wf.Result]:
    """Write gearbox_shaft.h5, .rrd and .png into the folder `out` and print the figures; quick: fewer cells."""
    stem = Path(out) / "gearbox_shaft"
    result = wf.equilibrium(build(QUICK if quick else FULL, progress=progress), progress=progress)
    result.save(f"{stem}.h5", overwrite=True)
    wf.record(result, f"{stem}.rrd", overwrite=True)
    save_panels(panels(result), f"{stem}.png", overwrite=True)
    for name in BEARINGS:
        found = result.bearing(name)
        loaded, force = found.outer_load[-1] > 0.0, found.force[-1]
        print(f"{name:12} {np.count_nonzero(loaded)} of {loaded.size} loaded, at most {found.outer_load.max():6.1f} N, "
              f"radial {np.hypot(*force[:2]):6.1f} N, axial {abs(force[2]):6.1f} N, "
              f"tilt {1e3 * np.hypot(*found.tilt[-1, :2]):5.3f} mrad")  # fmt: skip
    y, moved = bending(result)
    at = int(np.argmax(np.hypot(moved[:, 0], moved[:, 2])))
    print(f"the shaft moves by at most {1e6 * np.hypot(*moved[at, ::2]):.1f} um across, at {1e3 * y[at]:.0f} mm")
    return [result]


if __name__ == "__main__":
    main()
