r"""A roller bearing whose thin outer ring stands on two feet: its ovalisation changes which rollers carry the load.

An N 209 cylindrical roller bearing: 14 rollers, 40.6 um of diametral clearance, 4,450 N on the inner ring. In a stiff
housing the roller under the load carries most, 1,956 N, the next ones 1,384 N, and three are loaded (T. A. Harris,
Rolling Bearing Analysis). Here the outer ring, 6 mm thick, is held at two feet, 50 degrees to either side of the load.
Between them it bends away from the load: the roller there passes its load on to the neighbours, and five are loaded.

The outer ring is a flexible body of quadratic cells with distributed contact: pressures on cells that travel with each
patch. Inner ring and rollers are rigid, with Palmgren's law between them. Rollers are not constrained along the axis:
they keep their axial position, and the notes state the small forces on them.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

import warpffrf as wf
from warpffrf.output.plots.panels import Panel, Polar, save_panels

STEEL = wf.Material(youngs_modulus=206e9, poisson_ratio=0.3, density=7850, name="steel")
COUNT, ROLLER, LENGTH, PITCH = 14, 0.01, 9.6e-3, 0.064  # rollers; m
CLEARANCE, LOAD = 40.6e-6, 4450.0  # m, N
BORE = 0.5 * (PITCH + ROLLER) + 0.25 * CLEARANCE  # m, of the outer ring
WALL, WIDTH = 6e-3, 12e-3  # m
FEET, HALF_FOOT = np.radians([-140.0, -40.0]), np.radians(12.0)  # rad from x to z; the load is at -90 degrees
SINKS = 1.5e-5, 3.7e-5  # m: start values of rollers and inner ring, about 1 um from the equilibrium
NAME, FEET_SET = "N 209", "feet"


@dataclass(frozen=True)
class Size:
    """Cells of the outer ring around, six per roller, along the axis and through the wall."""

    sectors: int = 84
    axial: int = 4
    layers: int = 2


FULL, QUICK = Size(), Size(axial=2)


def outer_ring(size: Size = FULL) -> wf.Mesh:
    """The mesh of the outer ring with the facet sets `foot 1`, `foot 2` and both as `feet`."""
    mesh = wf.mesh.sleeve(BORE, BORE + WALL, WIDTH, sectors=size.sectors, axial=size.axial, layers=size.layers)

    def near(x: np.ndarray, *feet: float) -> np.ndarray:
        angle = np.arctan2(x[:, 2], x[:, 0])
        return np.any([np.abs(np.angle(np.exp(1j * (angle - foot)))) < HALF_FOOT for foot in feet], axis=0)

    for k, foot in enumerate(FEET, start=1):
        mesh = mesh.select(f"foot {k}", "outside", lambda x, foot=foot: near(x, foot))
    return mesh.select(FEET_SET, "outside", lambda x: near(x, *FEET))


def build(size: Size = FULL, *, progress: bool = True) -> wf.Scene:
    """The scene: bearing `N 209` of the body `outer ring` and a rigid inner ring, force `load`."""
    feet = {f"foot {k}": "rigid" for k in range(1, len(FEET) + 1)}
    reduced = wf.reduce(
        outer_ring(size), STEEL, interfaces=feet, contact={"bore": wf.surfaces.Bore()}, modes=10, progress=progress
    )
    scene = wf.Scene()
    outer = scene.add_body(reduced, name="outer ring")
    for foot in feet:
        scene.add(wf.joints.Fixed(scene.ground, outer[foot], name=foot))
    bearing = _rollers(scene, outer["bore"])
    for roller in bearing.elements:
        out = roller.position / np.linalg.norm(roller.position)
        roller.position = roller.position + max(0.0, -SINKS[0] * out[2]) * out
    return scene


def stiff_housing() -> wf.Scene:
    """The same bearing, its outer ring the ground."""
    scene = wf.Scene()
    _rollers(scene, scene.ground)
    return scene


def _rollers(scene: wf.Scene, outer: Any) -> wf.bearings.Bearing:
    """The bearing, its inner ring guided in the plane across the axis, and the load."""
    bearing = scene.add_bearing(
        NAME,
        wf.bearings.RollerGeometry(
            elements=COUNT, roller_diameter=ROLLER, roller_length=LENGTH, pitch_diameter=PITCH, clearance=CLEARANCE,
        ),
        first=(0, 0, -1), outer=outer, contact=wf.bearings.RollingContact(law=wf.laws.PalmgrenLine(LENGTH, 3)),
        materials=STEEL,
    )  # fmt: skip
    inner: Any = bearing.inner
    inner.position = np.array([0.0, 0.0, -SINKS[1]])
    scene.add(wf.joints.Planar(scene.ground.at((0, 0, 0)), inner, axis=(0, 1, 0), name="plane"))
    scene.add(wf.forces.PointForce(inner, (0, 0, -LOAD), name="load"))
    return bearing


def main(out: str | Path = "out/roller_bearing", *, quick: bool = False, progress: bool = True) -> list[wf.Result]:
    """Write roller_bearing.h5, .rrd and .png, and roller_bearing.stiff.h5 of the bearing in a stiff housing, into the
    folder `out` and print the figures; quick: longer cells along the axis."""
    stem = Path(out) / "roller_bearing"
    feet = wf.equilibrium(build(QUICK if quick else FULL, progress=progress), progress=progress)
    stiff = wf.equilibrium(stiff_housing(), progress=progress)
    feet.save(f"{stem}.h5", overwrite=True)
    stiff.save(f"{stem}.stiff.h5", overwrite=True)
    wf.record(feet, f"{stem}.rrd", overwrite=True)

    loads = {"stiff housing": stiff.bearing(NAME).outer_load[-1], "two feet": feet.bearing(NAME).outer_load[-1]}
    angle = 2.0 * np.pi * np.arange(COUNT + 1) / COUNT
    shown = np.arange(COUNT // 2 + 1)
    save_panels([
        Polar("Load zone", "angle", "[kN]", {n: (angle, np.append(Q, Q[0]) / 1e3) for n, Q in loads.items()}),
        Panel("Loads", "angle from the load [deg]", "[kN]",
              {n: (np.degrees(angle[shown]), Q[shown] / 1e3) for n, Q in loads.items()}),
    ], f"{stem}.png", overwrite=True)  # fmt: skip

    for name, published in (("stiff housing", "published 1956 and 1384 N"), ("two feet", "the load goes to five")):
        print(f"{name:14} {', '.join(f'{Q:7.1f}' for Q in loads[name][:4])} N from the load on; {published}")
    along = float(loads["two feet"] @ np.cos(angle[:-1]))
    print(f"two feet: all loads along the load {along:.1f} N, statics {LOAD:.1f} N")
    return [feet, stiff]


if __name__ == "__main__":
    main()
