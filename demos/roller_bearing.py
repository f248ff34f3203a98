r"""A roller bearing whose thin outer ring stands on two feet: its ovalisation changes which rollers carry the load.

An N 209 cylindrical roller bearing: 14 rollers, 40.6 um of diametral clearance, 4,450 N on the inner ring. In a stiff
housing (Harris, Rolling Bearing Analysis) the roller under the load takes the most, 1,956 N, and three carry. Here the
outer ring, 6 mm thick, is held at two feet, 50 degrees to either side of the load. Between them it bends away from the
load: the roller there gives its load to the neighbours, and five carry.

The outer ring is a flexible body of quadratic cells, its contact with the rollers distributed: pressures on cells that
travel with each patch. Inner ring and rollers are rigid, with Palmgren's law between them; rollers reach over the
whole width of the outer ring. Nothing stops them along the axis: they are left where they are, and the notes say what
little drives them.

**References.** The rigid housing: Palmgren's law at both rings, the equations of the load zone. The ring on feet: full
finite elements assembled by scikit-fem, pressed by line loads, with Weber's approach of a cylinder and a wall
(`references.finite_elements.ring_on_feet`). How far rollers sink into the ring is its deflection and that
approach together.
"""

from __future__ import annotations

import logging
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from scipy.optimize import brentq

import warpffrf as wf
from demos.checks import Check, finish, writable_folder
from references.finite_elements.ring_on_feet import RingOnFeet, compliance
from warpffrf.output.plots.panels import Panel, Polar

log = logging.getLogger("warpffrf")

STEEL = wf.Material(youngs_modulus=206e9, poisson_ratio=0.3, density=7850, name="steel")
COUNT, ROLLER, LENGTH, PITCH = 14, 0.01, 9.6e-3, 0.064  # rollers; m
CLEARANCE, LOAD = 40.6e-6, 4450.0  # m, N
BORE = 0.5 * (PITCH + ROLLER) + 0.25 * CLEARANCE  # m, of the outer ring
WALL, WIDTH = 6e-3, 12e-3  # m
FEET, HALF_FOOT = np.radians([-140.0, -40.0]), np.radians(12.0)  # rad from x to z; the load is at -90 degrees
SINKS = 1.5e-5, 3.7e-5  # m: where rollers and inner ring start, some 1 um from where they come to rest
NAME, FEET_SET = "N 209", "feet"
LOADS, DEFLECTION = 0.03, 0.02  # of the largest load; of the largest deflection
PUBLISHED = 1e-2


@dataclass(frozen=True)
class Size:
    """Cells of the outer ring around, six to a roller, along the axis and through the wall."""

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
    bearing = _rollers(scene, outer["bore"], law=wf.laws.PalmgrenLine(LENGTH, 3))
    for roller in bearing.elements:
        out = roller.position / np.linalg.norm(roller.position)
        roller.position = roller.position + max(0.0, -SINKS[0] * out[2]) * out
    return scene


def stiff_housing() -> wf.Scene:
    """The same bearing, its outer ring the ground."""
    scene = wf.Scene()
    _rollers(scene, scene.ground, law=wf.laws.PalmgrenLine(LENGTH, 3))
    return scene


def _rollers(scene: wf.Scene, outer: Any, law: Any) -> wf.bearings.Bearing:
    """The bearing, its inner ring guided in the plane across the axis, and the load."""
    bearing = scene.add_roller_bearing(
        NAME, elements=COUNT, roller_diameter=ROLLER, roller_length=LENGTH, pitch_diameter=PITCH, clearance=CLEARANCE,
        first=(0, 0, -1), outer=outer, law=law, material=STEEL,
    )  # fmt: skip
    inner: Any = bearing.inner
    inner.position = np.array([0.0, 0.0, -SINKS[1]])
    center = inner.at((0, 0, 0))
    scene.add(wf.joints.Planar(scene.ground.at((0, 0, 0)), center, axis=(0, 1, 0), name="plane"))
    scene.add(wf.forces.PointForce(center, (0, 0, -LOAD), name="load"))
    return bearing


def palmgren(Q: np.ndarray) -> np.ndarray:
    """Approach [m] of a roller and the inner ring under loads [N]: 3.84e-5 Q^0.9/l^0.8 in mm."""
    return 3.84e-8 * np.maximum(Q, 0.0) ** 0.9 / (1e3 * LENGTH) ** 0.8


def rigid_loads() -> np.ndarray:
    """(COUNT,) N, in a stiff housing: two contacts in series."""
    phi = 2.0 * np.pi * np.arange(COUNT) / COUNT

    def loads(shift: float) -> np.ndarray:
        together = np.maximum(shift * np.cos(phi) - 0.5 * CLEARANCE, 0.0)
        return (together / (2.0 * palmgren(np.ones(1))[0])) ** (10.0 / 9.0)

    shift: Any = brentq(lambda s: float(loads(s) @ np.cos(phi)) - LOAD, 0.0, 1e-3, xtol=1e-15)
    return loads(shift)


def reference(size: Size = FULL) -> RingOnFeet:
    """The ring on feet by full finite elements."""
    phi = 2.0 * np.pi * np.arange(COUNT) / COUNT
    C = compliance(outer_ring(size), STEEL, (BORE, BORE + WALL), FEET_SET, phi - 0.5 * np.pi, WIDTH)
    return RingOnFeet(C, phi, WALL, WIDTH, 1.0 / (2.0 / ROLLER - 1.0 / BORE), CLEARANCE, STEEL, palmgren)


def sinks(result: wf.Result) -> np.ndarray:
    """(COUNT,) m: how far rollers sink into the undeformed outer ring, negative where they are apart from it."""
    place = np.array([result.body(f"{NAME} roller {i + 1}").position[-1] for i in range(COUNT)])
    return np.hypot(place[:, 0], place[:, 2]) + 0.5 * ROLLER - BORE


def checks(results: dict[str, wf.Result], ring: RingOnFeet) -> list[Check]:
    """Loads and deflections beside the references."""
    Q = results["feet"].bearing(NAME).outer_load[-1]
    stiff = results["stiff"].bearing(NAME).outer_load[-1]
    shift, exact = ring.solve(LOAD, 1e-4)
    deep, deepest = sinks(results["feet"]), ring.sinks(exact)
    moved = -float(results["feet"].body(f"{NAME} inner ring").position[-1, 2])
    source, largest = "full finite elements", float(exact.max())
    loads = [
        Check(f"on feet: {name}", float(Q[i]), float(exact[i]), source, LOADS, "N", scale=largest)
        for i, name in enumerate(("roller under the load", "the next one", "the third one"))
    ]
    return [
        Check("stiff housing: roller under the load", float(stiff[0]), 1956.0, "published", PUBLISHED, "N"),
        Check("stiff housing: the next one", float(stiff[1]), 1384.0, "published", PUBLISHED, "N"),
        *loads,
        Check("on feet: all loads along the load", float(Q @ np.cos(ring.phi)), LOAD, "statics", 1e-3, "N"),
        Check("on feet: a roller sinks into the ring", float(deep[0]), float(deepest[0]), source, DEFLECTION, "um",
              1e6),
        Check("on feet: the next one sinks", float(deep[1]), float(deepest[1]), source, DEFLECTION, "um", 1e6,
              scale=float(deepest[0])),
        Check("on feet: the inner ring moves", moved, shift, source, DEFLECTION, "um", 1e6),
    ]  # fmt: skip


def panels(results: dict[str, wf.Result], ring: RingOnFeet) -> list:
    """Load zones, and how far rollers sink."""
    found, stiff = (results[name].bearing(NAME) for name in ("feet", "stiff"))
    _, exact = ring.solve(LOAD, 1e-4)
    degrees = np.degrees(np.angle(np.exp(1j * ring.phi)))
    order = np.argsort(degrees)
    closed = np.append(ring.phi, ring.phi[0])

    def around(load: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        return closed, np.append(load, load[0]) / 1e3

    deep = np.where(exact > 0.0, sinks(results["feet"]), np.nan) * 1e6
    sinking = np.where(exact > 0.0, ring.sinks(exact), np.nan) * 1e6
    return [
        Polar("Load zone", "angle", "[kN]",
              {"stiff housing": around(stiff.outer_load[-1]), "two feet": around(found.outer_load[-1])},
              points={"full finite elements": (ring.phi, exact / 1e3)}),
        Panel("Loads", "angle from the load [deg]", "[kN]",
              {"stiff housing": (degrees[order], stiff.outer_load[-1][order] / 1e3),
               "two feet": (degrees[order], found.outer_load[-1][order] / 1e3)},
              points={"full finite elements": (degrees, exact / 1e3), "Palmgren": (degrees, rigid_loads() / 1e3)}),
        Panel("How far loaded rollers sink into the ring on feet", "angle from the load [deg]", "[um]",
              {"run": (degrees[order], deep[order])}, points={"full finite elements": (degrees, sinking)}),
    ]  # fmt: skip


def main(out: str | Path = "out/roller_bearing", *, quick: bool = False, progress: bool = True) -> int:
    """Run the demo and write roller_bearing.h5, .rrd, .png and summary.json into the folder `out`; 0 when all went
    well.

    roller_bearing.stiff.h5 is the bearing in a stiff housing. quick: longer cells along the axis. Raises `InputError`
    for a folder that cannot be written.
    """
    folder = writable_folder(out)
    size = QUICK if quick else FULL
    log.info("roller bearing: %g N on %d rollers, in a stiff housing and on two feet", LOAD, COUNT)
    results = {
        "feet": wf.equilibrium(build(size, progress=progress), progress=progress),
        "stiff": wf.equilibrium(stiff_housing(), progress=progress),
    }
    for name, result in results.items():
        if result.status != "completed":
            log.error("the equilibrium '%s' was not found, %s: %s", name, result.status, result.message)
            return 1
    ring = reference(QUICK)
    return finish(folder / "roller_bearing", results, checks(results, ring), panels(results, ring), frames=1)
