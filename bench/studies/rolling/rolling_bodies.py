"""Friction on contact-fixed cells, by bodies: the rows of `rolling_patches` on meshes, unlike bodies that roll freely,
and gross slip. As `rolling_steady`.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from typing import Any

import numpy as np

from references.closed_forms import CarterRolling, LineContact, contact_modulus, coupling_ratio
from references.half_space.patch_rolling import HalfSpaces, PatchRolling, settle
from references.half_space.unlike_rolling import free_rolling
from scenes.rolling_pairs import (
    FRICTION,
    LASTS,
    PAIR,
    STEEL,
    WIDTH,
    Drives,
    R,
    Rolled,
    elliptic_contact,
    line_contact,
    pair,
    reduced,
    roll,
    roller,
    run,
)
from scenes.user_meshes import cut_into_tets, gmsh_roller
from studies.rolling.rolling_steady import APPROACH, CROWN, HALF_WIDTH, LONG, SHORT, SIZE, crowned
from warpffrf.model.material import Material
from warpffrf.model.mesh import Mesh
from warpffrf.model.reduced.body import ReducedBody
from warpffrf.model.signals import Table
from warpffrf.study.markdown import table

Array = np.ndarray
FREE = 12.0  # crossings of a pair without a force, the second half of which counts
ALUMINIUM = Material(70e9, 0.33, 2700.0, name="aluminium")
UNLIKE_APPROACHES = (1.5e-6, 3e-6, 6e-6, 12e-6)  # m
COARSE_ROWS, FINE_ROWS = 5, 29  # along the axis; the second as many as 15 strips have by themselves
SLIDING = 5e-4  # m/s: slow, else the rollers swing on their bores
DIRECTIONS = (0.0, 30.0, 45.0, 90.0, -120.0)  # degrees


# --- meshes ---

MESHES: dict[str, Callable[[float | None], Mesh]] = {
    "hex8, 4 mm": lambda crown: roller(4e-3, order=1, crown_radius=crown),
    "hex27, 4 mm": lambda crown: roller(4e-3, crown_radius=crown),
    "tet10, 4 mm": lambda crown: cut_into_tets(roller(4e-3, crown_radius=crown)),
    "hex8, 2 mm": lambda crown: roller(2e-3, order=1, crown_radius=crown),
    "hex8, 1 mm": lambda crown: roller(1e-3, order=1, crown_radius=crown),
}
FINEST = ("hex8, 1 mm", "hex8, 2 mm")  # of straight and of crowned rollers
BY_GMSH = "tet10, 4 mm, Gmsh"


@cache
def on_mesh(name: str, crown: float | None, creepage: float) -> Rolled:
    """What two rollers of steel on that mesh come to."""
    mesh = gmsh_roller() if name == BY_GMSH else MESHES[name](crown)
    body = reduced(mesh, STEEL, crowned=crown is not None)
    cells = (15, 9) if crown is None else (13, 13)
    approach = APPROACH if crown is None else 3e-6
    scene = pair(body, body, approach, Drives(creepage=creepage), cells=cells)
    return roll(scene, HALF_WIDTH, cells[0], 1.0, LONG if crown is None else SHORT)


def mesh_rows() -> list[list[str]]:
    """Shapes, creepages and meshes down: Q/(mu N), against the finest mesh, against the half-space; Q against the
    finest."""
    rows = []
    for crown in (None, CROWN):
        names = [*MESHES][:-1] if crown else [*MESHES, BY_GMSH]
        last = FINEST[crown is not None]
        for creepage in (4e-4, 1.2e-3):
            finest = on_mesh(last, crown, creepage)
            for name in names:
                found = on_mesh(name, crown, creepage)
                share = abs(float(found.share[0]))
                if crown is None:
                    wanted = CarterRolling(line_contact(found.load, STEEL, STEEL), FRICTION, creepage).share
                else:
                    law = PatchRolling(elliptic_contact(found.load, crown, STEEL), FRICTION, (27, 27),
                                       HalfSpaces(STEEL, STEEL))  # fmt: skip
                    law.begin(law.grid.size[0], (-creepage, 0.0, 0.0))
                    wanted = abs(float(settle(law, 1.0, (-creepage, 0.0, 0.0))[-1, 0]))
                force = share * found.load / abs(float(finest.share[0]) * finest.load) - 1.0
                rows.append(["straight" if crown is None else "crowned", f"{creepage:g}", name, f"{share:.4f}",
                             f"{100 * (share - abs(float(finest.share[0]))):+.2f}", f"{100 * (share - wanted):+.2f}",
                             f"{force:+.2%}"])  # fmt: skip
    return rows


# --- unlike bodies ---


@cache
def unlike(size: float, order: int = 2, width: float = WIDTH) -> tuple[ReducedBody, ReducedBody]:
    """A roller of steel and one of aluminium."""
    mesh = roller(size, order=order, width=width)
    return reduced(mesh, STEEL), reduced(mesh, ALUMINIUM)


def free_pair(
    size: float, approach: float, strips: int, *, order: int = 2, friction: float = FRICTION, turned: bool = False,
    width: float = WIDTH, rows: int = COARSE_ROWS,
) -> tuple[float, LineContact]:  # fmt: skip
    """Creepage without force of steel (driven; `turned`: aluminium) with the other one free, and Hertz's contact."""
    bodies = unlike(size, order, width)
    first, second = bodies[::-1] if turned else bodies
    sign, relative = (-1.0 if turned else 1.0), np.sqrt(approach / 12e-6)
    drives = Drives(free=True, creepage=-9e-4 * sign * relative)
    scene = pair(first, second, approach, drives, cells=(strips, rows), friction=friction)
    found = roll(scene, 3.3e-4 * float(relative), strips, 1.0, FREE, friction=friction)
    contact: Any = found.result.contact(PAIR)
    creepage = contact.friction.creepage[:, 0]
    hertz = LineContact(float(contact.line_load[-1]), 0.5 * R, contact_modulus(STEEL, ALUMINIUM))
    return sign * float(creepage[len(creepage) // 2 :].mean()), hertz


def scaled(creepage: float, hertz: LineContact) -> float:
    """-xi R'/(a beta), 2/pi with continuous adhesion."""
    return -creepage * hertz.radius / (hertz.half_width * abs(coupling_ratio(STEEL, ALUMINIUM)))


def unlike_rows() -> list[list[str]]:
    """Half-widths and strips down: -xi R'/(a beta) by rollers and by half-planes of as many cells."""
    rows = []
    for approach in UNLIKE_APPROACHES:
        creepage, hertz = free_pair(SIZE, approach, 21, friction=0.1, width=2.0 * WIDTH)
        rows.append([f"{1e6 * hertz.half_width:.0f}", "21", "0.1", f"{scaled(creepage, hertz):.4f}"])
    for friction in (0.1, FRICTION):
        for strips in (15, 31):
            creepage, hertz = free_pair(SIZE, 12e-6, strips, friction=friction, width=2.0 * WIDTH)
            found = f"{scaled(creepage, hertz):.4f}"
            rows.append([f"{1e6 * hertz.half_width:.0f}", str(strips), f"{friction:g}", found])
    return rows


def half_plane_rows() -> list[list[str]]:
    """Friction and cells in a half-width down: -xi R'/(a beta) of half-planes."""
    hertz = LineContact(1.9e5, 0.5 * R, contact_modulus(STEEL, ALUMINIUM))
    rows = []
    for friction, cells in ((0.1, 8), (0.1, 20), (FRICTION, 8), (FRICTION, 20), (FRICTION, 40), (10.0, 20), (10.0, 40)):
        xi, _ = free_rolling(STEEL, ALUMINIUM, hertz.radius, hertz.load, friction, cells)
        rows.append([f"{friction:g}", str(cells), f"{scaled(xi, hertz):.4f}"])
    return rows


UNLIKE_MESHES = {"hex8, 6 mm": (6e-3, 1), "hex27, 4 mm": (4e-3, 2), "hex8, 2 mm": (2e-3, 1), "hex8, 1 mm": (1e-3, 1),
                 "hex8, 0.6 mm": (0.6e-3, 1)}  # fmt: skip
FINEST_UNLIKE = "hex8, 0.6 mm"


@cache
def unlike_on(name: str, rows: int = FINE_ROWS, *, turned: bool = False) -> tuple[float, float]:
    """Creepage without a force at the approach of 12 µm on that mesh, and -xi R'/(a beta), the same at its load."""
    size, order = UNLIKE_MESHES[name]
    creepage, hertz = free_pair(size, 12e-6, 15, order=order, turned=turned, rows=rows)
    return creepage, scaled(creepage, hertz)


UNLIKE_HEAD = ["mesh", "steel driven", "against 0.6 mm", "at one load", "aluminium driven", "against 0.6 mm",
               "at one load", f"{COARSE_ROWS} rows", "against 0.6 mm"]  # fmt: skip


def unlike_mesh_rows() -> list[list[str]]:
    """Meshes down: creepage without force at one approach, against the finest; the same over that of half-planes at the
    load found; steel driven and aluminium driven; with few rows."""
    rows = []
    for name in UNLIKE_MESHES:
        row = [name]
        for turned in (False, True):
            found, finest = unlike_on(name, turned=turned), unlike_on(FINEST_UNLIKE, turned=turned)
            row += [f"{1e3 * found[0]:.5f}", f"{found[0] / finest[0] - 1.0:+.2%}", f"{found[1] / finest[1] - 1.0:+.2%}"]
        few, finest = unlike_on(name, COARSE_ROWS)[0], unlike_on(FINEST_UNLIKE, COARSE_ROWS)[0]
        rows.append([*row, f"{1e3 * few:.5f}", f"{few / finest - 1.0:+.2%}"])
    return rows


# --- gross slip ---


def gross(longitudinal: float, lateral: float) -> tuple[float, float]:
    """While rolling: |Q|/(mu N) - 1, and the angle [degrees] between force and creepage."""
    body = crowned()
    scene = pair(body, body, 3e-6, Drives(creepage=longitudinal, lateral_creepage=lateral), cells=(13, 13))
    found = roll(scene, HALF_WIDTH, 13, 1.0, 5.0)
    return float(np.linalg.norm(found.share)) - 1.0, _angle(-found.share, (longitudinal, lateral))


def slid(angle: float) -> tuple[float, float]:
    """The same of the lower roller pulled sideways at that angle [degrees] to x, nothing rolling."""
    way = np.array([np.cos(np.radians(angle)), np.sin(np.radians(angle)), 0.0])
    body = crowned()
    drives = Drives(speed=0.0, way=Table([0.0, LASTS], [0.0, SLIDING * LASTS]), along=(way[0], way[1], 0.0))
    contact: Any = run(pair(body, body, 3e-6, drives, cells=(13, 13)), 50, 4e-4).contact(PAIR)
    force = contact.friction.tangential_force[-1]
    return float(np.hypot(*force) / (FRICTION * contact.normal_load[-1])) - 1.0, _angle(-contact.force[-1, :2], way[:2])


def gross_rows() -> list[list[str]]:
    """Ways to slip down: error of the force, and of its direction."""
    rows = []
    for creepage in ((0.1, 0.0), (0.1, 0.1), (0.0, 0.1), (-0.05, 0.0866), (-0.1, -0.03)):
        error, angle = gross(*creepage)
        rows.append([f"rolling, creepages {creepage[0]:g}, {creepage[1]:g}", f"{error:+.1e}", f"{angle:+.3f}"])
    for direction in DIRECTIONS:
        error, angle = slid(direction)
        rows.append([f"sliding at {direction:g}°", f"{error:+.1e}", f"{angle:+.3f}"])
    return rows


def _angle(found: Any, wanted: Any) -> float:
    cross = found[0] * wanted[1] - found[1] * wanted[0]
    return float(np.degrees(np.arctan2(-cross, found[0] * wanted[0] + found[1] * wanted[1])))


def compute() -> dict[str, list[list[str]]]:
    """The figures of the page."""
    return {
        "half_plane": half_plane_rows(),
        "unlike": unlike_rows(),
        "unlike_mesh": unlike_mesh_rows(),
        "mesh": mesh_rows(),
        "gross": gross_rows(),
    }


def section(found: dict[str, list[list[str]]]) -> str:
    """What the page says on bodies."""
    return f"""## Unlike bodies

Steel driven, aluminium free to rotate: the creepage xi without a force. Half-planes with continuous adhesion have
-xi R'/(a beta) = 2/pi = {2 / np.pi:.4f} (beta small); half-planes in cells (`half_space.unlike_rolling`) have an error
that goes away slowly where friction hardly slips, for the trailing edge is singular then:

{table(["friction", "cells in a", "half-planes"], found["half_plane"])}
Rollers of finite size have less the larger their patch is, in proportion to a/R. What is to be compared is their limit
at a/R = 0: a line through 322 and 104 µm ends 1 % below half-planes of as many cells (21 strips are 8 in a half-width):
all rows creep alike, and the line load at mid-width, for which this is scaled, is 2.5 % above the mean of the width.

{table(["a [µm]", "strips", "friction", "rollers"], found["unlike"])}
By meshes, {WIDTH * 1e3:g} mm wide, 15 strips, {FINE_ROWS} rows along the axis: xi in 1e-3 at an approach of 12 µm,
compared with the finest mesh as it is, and at the same load (a mesh makes bodies stiffer or softer as a whole). Far
fields are read and loaded in the middle of a row: rows longer than some three spacings of the contact grid, as
{COARSE_ROWS} on these rollers (5 mm in the middle), leave out what lies between, which is seen on fine meshes.

{table(UNLIKE_HEAD, found["unlike_mesh"])}
## Meshes

Steel with its Poisson's ratio. Q/(mu N), its difference from the finest mesh and from half-spaces (Carter; the law on
27 x 27 cells) in percent of mu N, and Q itself compared with the finest mesh at the same approach.

{table(["rollers", "creepage", "mesh", "Q/(mu N)", "against finest", "against half-spaces", "Q"], found["mesh"])}
## Gross slip

|Q|/(mu N) - 1, and the angle between force and slip in degrees.

{table(["way", "force", "angle"], found["gross"])}
"""
