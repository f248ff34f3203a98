"""Published bearings with rigid and with flexible elements and rings; some minutes.

Bearings with published load distributions, first with rigid rings and elements and the law that the publication takes,
then with flexible elements, a flexible outer ring in a stiff housing, or both: how loads, deflection and peak pressures
change, and why.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

import warpffrf as wf
from warpffrf.study.markdown import table

MM, UM = 1e-3, 1e-6
E210, E206 = (wf.Material(youngs_modulus=E, poisson_ratio=0.3, density=7850.0) for E in (210e9, 206e9))
NAME = "bearing"
WALL = 6 * MM  # of an outer ring behind the bottom of its raceway
MODES = 6
SUNK = 0.45  # of the way of the inner ring: elements
PLAIN = wf.bearings.RollingContact()
Made = tuple[wf.Scene, wf.bearings.Bearing]

WHY = {
    "rollers": "straight rollers of finite elements between rigid rings deform less than by Palmgren's law, which has "
    "profiled rollers and deformable rings in it: fewer share the load",
    "outer ring": "a wall of 6 mm held outside deforms less than one of Palmgren's two half-spaces; `reduce` "
    "warns that its cells err by about 2 % of the force at a given approach",
    "rollers and outer ring": "both, with Hertz's modulus of two bodies outside, of one inside",
    "balls": "rigid rings: Hertz with E/(1 - nu^2) of the ball alone in place of half of it; deflections are by "
    "2^(-2/3) smaller, peak pressures by 2^(2/3) larger at a load",
}


@dataclass(frozen=True)
class Case:
    """What is built: `made` -> scene and bearing; why: what the difference to the rigid one comes from."""

    bearing: str
    what: str
    made: Callable[[], Made]
    why: str = ""


def roller_body(*, coarse: bool = False) -> wf.ReducedBody:
    """A solid roller of P10."""
    cells = {"sectors": 12, "layers": 1, "axial": 2} if coarse else {"sectors": 24, "layers": 2, "axial": 4}
    mesh = wf.mesh.roller(5 * MM, 0.0, 9.6 * MM, **cells)
    return wf.reduce(
        mesh, E206, interfaces={"ends": "average"}, contact={"rim": wf.surfaces.Cylinder()}, modes=MODES,
        grid=wf.ContactGrid(contact_fixed=True), progress=False,
    )  # fmt: skip


def ball_body(diameter: float, material: wf.Material, *, coarse: bool = False) -> wf.ReducedBody:
    """A ball of finite elements, its contact on a band in its middle."""
    R, around, through = 0.5 * diameter, 12 if coarse else 16, 2 if coarse else 3
    mesh = wf.mesh.roller(R, 0.0, 1.8 * R, crown_radius=R, sectors=around, layers=through, axial=2, tread=0.94 * R)
    return wf.reduce(
        mesh, material, interfaces={"ends": "average"}, contact={"tread": wf.surfaces.Sphere(axis_direction=(0, 1, 0))},
        modes=MODES, grid=wf.ContactGrid(contact_fixed=True), progress=False,
    )  # fmt: skip


def roller_ring(bore: float) -> wf.ReducedBody:
    """An outer ring of P10."""
    mesh = wf.mesh.sleeve(bore, bore + WALL, 12 * MM, sectors=84, axial=2, layers=2)
    return wf.reduce(
        mesh, E206, interfaces={"outside": "rigid"}, contact={"bore": wf.surfaces.Bore()}, modes=MODES, progress=False
    )


def in_housing(scene: wf.Scene, ring: wf.ReducedBody, surface: str) -> Any:
    """The raceway of a flexible outer ring that is held all around its outside."""
    body = scene.add_body(ring, name="outer ring")
    scene.add(wf.joints.Fixed(scene.ground, body["outside"], name="housing"))
    return body[surface]


def p7(radial: float, axial: float, flexible: bool) -> Made:
    """Seven balls of 11.5 mm, ISO/TS 16281."""
    scene = wf.Scene()
    bearing = scene.add_bearing(
        NAME,
        wf.bearings.BallGeometry(
            elements=7, ball_diameter=11.5 * MM, pitch_diameter=43.5 * MM, osculation=(0.52, 0.53),
        ),
        first=(0, 0, -1), outer=scene.ground,
        materials=wf.bearings.Materials(E210, element_body=ball_body(11.5 * MM, E210) if flexible else None),
    )  # fmt: skip
    return loaded(scene, bearing, radial, axial)


def p8(flexible: bool, contact: wf.bearings.RollingContact = PLAIN, *, coarse: bool = False) -> Made:
    """A 209 ball bearing."""
    scene = wf.Scene()
    bearing = scene.add_bearing(
        NAME,
        wf.bearings.BallGeometry(
            elements=9, ball_diameter=12.7 * MM, pitch_diameter=64.9985 * MM, osculation=6.6 / 12.7, clearance=15 * UM,
        ),
        first=(0, 0, -1), outer=scene.ground, contact=contact,
        materials=wf.bearings.Materials(
            E206, element_body=ball_body(12.7 * MM, E206, coarse=coarse) if flexible else None
        ),
    )  # fmt: skip
    return loaded(scene, bearing, 8900.0, 0.0, near=40 * UM)


def p9(flexible: bool, contact: wf.bearings.RollingContact = PLAIN, *, coarse: bool = False) -> Made:
    """A 218 angular-contact bearing."""
    scene = wf.Scene()
    bearing = scene.add_bearing(
        NAME,
        wf.bearings.BallGeometry(
            elements=16, ball_diameter=22.23 * MM, pitch_diameter=125.3 * MM, osculation=0.5232,
            contact_angle=float(np.radians(40.0)),
        ),
        first=(0, 0, -1), outer=scene.ground, contact=contact,
        materials=wf.bearings.Materials(
            E206, element_body=ball_body(22.23 * MM, E206, coarse=coarse) if flexible else None
        ),
    )  # fmt: skip
    return loaded(scene, bearing, 0.0, 17800.0)


def p10(*, rollers: bool, ring: bool, contact: wf.bearings.RollingContact | None = None, coarse: bool = False) -> Made:
    """A 209 roller bearing; contact: None for Palmgren's law between rigid parts."""
    scene, clearance, length = wf.Scene(), 40.6 * UM, 9.6 * MM
    law = wf.bearings.RollingContact(law=wf.laws.PalmgrenLine(length, 3))
    bore = 0.5 * (64 * MM + 10 * MM) + 0.25 * clearance
    bearing = scene.add_bearing(
        NAME,
        wf.bearings.RollerGeometry(
            elements=14, roller_diameter=10 * MM, roller_length=length, pitch_diameter=64 * MM, clearance=clearance,
        ),
        first=(0, 0, -1), outer=in_housing(scene, roller_ring(bore), "bore") if ring else scene.ground,
        contact=law if contact is None else contact,
        materials=wf.bearings.Materials(E206, element_body=roller_body(coarse=coarse) if rollers else None),
    )  # fmt: skip
    return loaded(scene, bearing, 4450.0, 0.0, near=30 * UM)


def loaded(scene: wf.Scene, bearing: wf.bearings.Bearing, radial: float, axial: float, *, near: float = 0.0) -> Made:
    """With the load [N] on the inner ring, radial or axial, along which alone it moves; near [m]: how far it goes,
    about, from where its equilibrium is looked for."""
    inner: Any = bearing.inner
    inner.position = near * np.array([0.0, float(axial > 0.0), -float(radial > 0.0)])
    for element in bearing.elements:
        out = element.position / np.linalg.norm(element.position)
        way = max(0.0, -float(out[2])) * out if radial else np.array([0.0, 1.0, 0.0])
        element.position = element.position + SUNK * near * way
    along, middle = (0, 0, -1) if radial else (0, 1, 0), (0.0, 0.0, 0.0)
    scene.add(wf.joints.Prismatic(scene.ground.at(middle), inner.at(middle), axis=along, name="guide"))
    scene.add(wf.forces.PointForce(inner.at(middle), (0.0, axial, -radial), name="load"))
    return scene, bearing


CASES = {
    "p7": Case("P7, 1 kN radial", "rigid", lambda: p7(1e3, 0.0, False)),
    "p7-balls": Case("P7, 1 kN radial", "balls", lambda: p7(1e3, 0.0, True), WHY["balls"]),
    "p8": Case("P8", "rigid", lambda: p8(False)),
    "p8-balls": Case("P8", "balls", lambda: p8(True), WHY["balls"]),
    "p9": Case("P9", "rigid", lambda: p9(False)),
    "p9-balls": Case("P9", "balls", lambda: p9(True), WHY["balls"]),
    "p10": Case("P10", "rigid", lambda: p10(rollers=False, ring=False)),
    "p10-rollers": Case("P10", "rollers", lambda: p10(rollers=True, ring=False), WHY["rollers"]),
    "p10-ring": Case("P10", "outer ring", lambda: p10(rollers=False, ring=True), WHY["outer ring"]),
    "p10-both": Case(
        "P10", "rollers and outer ring", lambda: p10(rollers=True, ring=True), WHY["rollers and outer ring"]
    ),
}  # fmt: skip


def at_rest(case: Case) -> tuple[wf.bearings.Bearing, wf.Result]:
    """The equilibrium. Raises RuntimeError where there is none."""
    scene, bearing = case.made()
    result = wf.equilibrium(scene, progress=False)
    if result.status != "completed":
        raise RuntimeError(f"{case.bearing}, {case.what}: {result.message}")
    return bearing, result


def row(case: Case) -> list[str]:
    """Of the table."""
    began = time.perf_counter()
    bearing, result = at_rest(case)
    took = time.perf_counter() - began
    found = result.bearing(NAME)
    Q = np.sort(found.outer_load[-1])[::-1]
    moved = found.displacement[-1]
    radial = abs(found.force[-1, 0]) > abs(found.force[-1, 2])
    start = np.abs(bearing.inner.position).max()  # along the load
    way = start + (moved[0] if radial else moved[2])
    peaks = [1e-6 * float(found.peak_pressure[side][-1].max()) for side in ("inner", "outer")]
    angle = np.degrees(np.nanmax(np.abs(found.outer_angle[-1])))
    return [
        case.bearing, case.what, f"{Q[0]:,.0f}", f"{Q[1]:,.0f}", f"{way / UM:.2f}", f"{angle:.2f}",
        *(f"{p:,.0f}" for p in peaks), f"{took:.0f}", case.why,
    ]  # fmt: skip


HEAD = ["bearing", "flexible", "largest load [N]", "next [N]", "deflection [um]", "contact angle [deg]",
        "peak inside [MPa]", "outside [MPa]", "s", "reason of the difference"]  # fmt: skip


def compute(*cases: str) -> list[list[str]]:
    """Rows of the named cases, or of all. Raises `InputError` for a case that does not exist."""
    for name in cases:
        if name not in CASES:
            raise wf.InputError(f"there is no case {name!r}; choose from {', '.join(CASES)}")
    rows = []
    for name in cases or CASES:
        rows.append(row(CASES[name]))
        print(f"{name}: {', '.join(rows[-1][2:9])}", flush=True)
    return rows


def page(rows: list[list[str]]) -> str:
    """The study."""
    return f"""# Bearings with flexible elements and rings

Bearings P7 to P10 (ISO/TS 16281; Harris, Rolling Bearing Analysis) under their loads, along which alone the inner ring
moves. Rigid parts have the published law between them (Hertz, Palmgren at P10), flexible ones distributed contact on
contact-fixed cells. Loads are those on the outer ring, peak pressures of rigid parts Hertz's at these loads; seconds
with body and equilibrium, on a machine of two cores with other work.

{table(HEAD, rows)}"""
