"""The friction law in contact-fixed cells compared with Carter, Kalker and CONTACT; three minutes.

Every figure is computed here by the reference of the friction law on cells that stand with the patch
(`half_space/patch_rolling.py`), which shares nothing with the engine.
"""

from __future__ import annotations

from collections.abc import Iterable
from functools import cache

import numpy as np
from scipy.special import elliprd

from references.closed_forms import (
    CarterRolling,
    LineContact,
    MindlinPoint,
    PointContact,
    contact_modulus,
    tangential_compliance,
)
from references.closed_forms import rolling_tables as published
from references.closed_forms.elliptic import EllipticContact
from references.half_space.patch_rolling import RINGS, SPAN, HalfPlanes, HalfSpaces, PatchRolling, settle, to_edge
from studies.rolling.carter import FRICTION, LINE, SHARES
from warpffrf.model.material import Material
from warpffrf.study.markdown import table

Array = np.ndarray
ADVANCES = (0.1, 0.25, 0.5, 1.0, 1.5, 2.0, 2.5, 4.0)  # cells per step
PHASES = 8  # half-widths in cells between two whole numbers, so that the edge lies anywhere in a cell
WIDTHS = (5, 6, 8, 12, 20, 40)  # whole cells in a half-width
KALKER_COLUMNS = (17, 21, 25, 27)
SMOOTH = tuple(range(13, 35, 2))
NEARLY_HALF = 0.4999  # Poisson's ratio for Kalker's 1/2, which a material cannot have


def line(cells: float, *, order: int = 3, rings: int = RINGS, late: bool = True) -> PatchRolling:
    """Case C1 with that many cells in a half-width; the grid as wide as odd numbers allow, but the span of patches."""
    columns = 2 * int(SPAN * cells) + 1
    body = HalfPlanes.of(LINE)
    return PatchRolling(LINE, FRICTION, (columns,), body, order, rings, late, span=0.5 * columns / cells)


def carter_error(
    share: float, cells: float, advance: float, *, order: int = 3, rings: int = RINGS, late: bool = True
) -> float:
    """Steady Q at Carter's creepage against Carter's, over mu P, at `advance` cells per step."""
    rolling = line(cells, order=order, rings=rings, late=late)
    creepage = (-CarterRolling.from_share(LINE, FRICTION, share).creepage, 0.0, 0.0)
    rolling.begin(advance * rolling.grid.size[0], creepage)
    return float(settle(rolling, advance, creepage)[-1, 0]) - share


def spread(errors: Iterable[float]) -> str:
    """Least and largest, in percent."""
    found = list(errors)
    return f"{100 * min(found):+.2f} .. {100 * max(found):+.2f}"


def phases(width: int, count: int = PHASES) -> Array:
    """Cells in a half-width from `width` up to the next whole number."""
    return width + np.arange(count) / count


def carter_rows(late: bool, widths: tuple[int, ...], advances: tuple[float, ...] = ADVANCES) -> list[list[str]]:
    """Least and largest error over Q and phases: steps down, cells across. Fewer where there are many cells."""
    rows = []
    for c in advances:
        found = []
        for width in widths:
            count = PHASES if late and width < 8 else PHASES // 2 if width < 20 else 2
            cells = phases(width, count) if width < 40 else [40.25]
            shares = SHARES if width < 20 else (0.5, 0.99)
            slow = c < 0.25 and width >= 12
            found.append("" if slow else spread(carter_error(q, n, c, late=late) for n in cells for q in shares))
        rows.append([f"{c:g}", *found])
    return rows


def ring_rows() -> list[list[str]]:
    """Error by rings of cells around the grid."""
    rows = []
    for c in (2.0, 4.0):
        for rings in (0, 1, 2, 3, 6):
            found = [
                spread(carter_error(q, n, c, rings=rings) for n in phases(width, 4) for q in SHARES) for width in (5, 8)
            ]
            rows.append([f"{c:g}", str(rings), *found])
    return rows


def edge_rows() -> list[list[str]]:
    """Edge found from the pressures against Hertz's, in cells."""
    rows = []
    for width in (4, 5, 6, 8, 12, 20):
        errors = []
        for cells in phases(width, 40):
            rolling = line(cells)
            on = np.flatnonzero(rolling.on[:, 0])
            errors.append(float(on[-1] + to_edge(rolling.pressure)[on[-1], 0] - rolling.columns[0] // 2 - cells))
        rows.append([str(width), f"{min(errors):+.3f} .. {max(errors):+.3f}"])
    return rows


def swelling(columns: int, step: float, *, order: int = 3, late: bool = True) -> tuple[Array, Array]:
    """Rolling distances [half-widths] and Q/(mu P), at the creepage of Q = 0.9 mu P, the load P (1 + 0.6 sin) with a
    period of three half-widths; `step` in half-widths. P, half-width: of the mean."""
    a = LINE.half_width
    rolling = PatchRolling(LINE, FRICTION, (columns,), HalfPlanes.of(LINE, 6.0), order, late=late)
    creepage = CarterRolling.from_share(LINE, FRICTION, 0.9).creepage
    distance = step * np.arange(1, int(round(6.0 / step)) + 1)
    shares = []
    for s in distance:
        load = LINE.load * (1.0 + 0.6 * np.sin(2.0 * np.pi * s / 3.0))
        rolling.roll(step * a, (-creepage, 0.0, 0.0), LineContact(load, LINE.radius, LINE.modulus))
        shares.append(rolling.force[0] / (FRICTION * LINE.load))
    return distance, np.array(shares)


@cache
def swelling_reference() -> tuple[Array, Array]:
    """The same with 201 columns, one cell per step."""
    return swelling(201, 2.0 * SPAN / 201)


def swelling_error(columns: int, advance: float, *, order: int = 3, late: bool = True) -> tuple[float, float]:
    """Largest and root mean square error after the first 0.3 half-widths, over mu P."""
    s, found = swelling(columns, advance * 2.0 * SPAN / columns, order=order, late=late)
    error = (found - np.interp(s, *swelling_reference()))[s > 0.3]
    return float(np.abs(error).max()), float(np.sqrt(np.mean(error**2)))


def swelling_rows() -> list[list[str]]:
    """Steps down; rule and cubic, rule and linear, whole step and cubic."""
    rows = []
    for columns in (13, 21):
        for c in (0.25, 0.5, 1.0, 2.0):
            found = [
                swelling_error(columns, c),
                swelling_error(columns, c, order=1),
                swelling_error(columns, c, late=False),
            ]
            rows.append([str(columns), f"{c:g}", *(f"{100 * most:.2f}, {100 * mean:.2f}" for most, mean in found)])
    return rows


def ellipse(ratio: float, poisson: float) -> tuple[EllipticContact, Material]:
    """A contact with a/b = ratio, a in the rolling direction, of two like bodies."""
    material = Material(210e9, poisson, 7800.0)
    k2 = ratio**-2.0
    radius = 0.01 * float(elliprd(0.0, 1.0, k2) / elliprd(0.0, k2, 1.0))
    return EllipticContact(100.0, radius, 0.01, contact_modulus(material, material)), material


def coefficients(
    ratio: float, poisson: float, columns: int, advance: float = 1.0, *, angle: float = 0.0, late: bool = True
) -> Array:
    """C_11, C_22, C_23 of cells without slip at `advance` cells per step, rolling at an `angle` [rad] to the grid's x
    (circles only)."""
    contact, material = ellipse(ratio, poisson)
    rolling = PatchRolling(contact, FRICTION, (columns, columns), HalfSpaces(material, material), late=late)
    turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    way = advance * rolling.grid.size[0] * turn[:, 0]
    by_axis = rolling.without_slip((float(way[0]), float(way[1]))).sum(axis=1) * rolling.area  # (creepage, force)
    along = turn.T @ by_axis[0] * turn[0, 0] + turn.T @ by_axis[1] * turn[1, 0]
    across = turn.T @ by_axis[0] * turn[0, 1] + turn.T @ by_axis[1] * turn[1, 1]
    a, b = contact.half_axes
    size = np.sqrt(a * b)
    spin = turn.T @ by_axis[2]
    return -np.array([along[0], across[1], spin[1] / size]) / (material.lame[1] * size**2)


def kalker_error(ratio: float, poisson: float, columns: int, advance: float = 1.0, **kwargs) -> Array:
    """Relative errors of C_11, C_22, C_23 against Kalker's; kwargs: of `coefficients`."""
    at = published.KALKER_POISSON.index(poisson)
    wanted = np.array([row[at] for row in published.KALKER[ratio]])
    return coefficients(ratio, min(poisson, NEARLY_HALF), columns, advance, **kwargs) / wanted - 1.0


def _percents(errors: Array) -> list[str]:
    return [f"{e:+.1%}" for e in errors]


def kalker_rows() -> list[list[str]]:
    """Ellipses and Poisson's ratios down."""
    rows = []
    for ratio in published.KALKER:
        for nu in published.KALKER_POISSON:
            found = np.array([kalker_error(ratio, nu, n) for n in KALKER_COLUMNS])
            rows.append([f"{ratio:g}", f"{nu:g}", *(", ".join(_percents(e)) for e in found)])
    return rows


def smooth_rows() -> list[list[str]]:
    """Columns down, a circle."""
    rows = []
    for columns in SMOOTH:
        found = [", ".join(_percents(kalker_error(1.0, 0.25, columns, c))) for c in (0.25, 1.0, 2.0)]
        rows.append([str(columns), f"{columns / SPAN:.1f}", *found])
    return rows


def step_rows() -> list[list[str]]:
    """Steps down, 21 columns: with the rule and charged with the whole step; a circle at angles."""
    rows = []
    for c in (0.25, 0.5, 1.0, 2.0, 4.0):
        found = [kalker_error(1.0, 0.25, 21, c), kalker_error(1.0, 0.25, 21, c, late=False)]
        turned = [kalker_error(1.0, 0.25, 21, c, angle=np.radians(angle)) for angle in (15.0, 30.0, 45.0)]
        rows.append([f"{c:g}", *(", ".join(_percents(e)) for e in [*found, *turned])])
    return rows


def eurosprinter(columns: int, advance: float) -> Array:
    """F_x/(mu N) (9,) at the creepages of CONTACT's example."""
    g, nu = published.EUROSPRINTER_SHEAR, published.EUROSPRINTER_POISSON
    steel = Material(2.0 * g * (1.0 + nu), nu, 7800.0)
    contact = EllipticContact(
        published.EUROSPRINTER_LOAD, *published.EUROSPRINTER_RADII, contact_modulus(steel, steel)
    )  # fmt: skip
    body = HalfSpaces(steel, steel)
    rolling = PatchRolling(contact, published.EUROSPRINTER_FRICTION, (columns, columns), body)
    found = []
    for creepage, _ in published.EUROSPRINTER_FORCES:
        if not found:
            rolling.begin(advance * rolling.grid.size[0], (-creepage, 0.0, 0.0))
        found.append(settle(rolling, advance, (-creepage, 0.0, 0.0))[-1, 0])
    return np.array(found)


def eurosprinter_rows() -> list[list[str]]:
    """Grids and steps down: errors over mu N at the nine creepages."""
    wanted = np.array([share for _, share in published.EUROSPRINTER_FORCES])
    rows = []
    for columns, c in ((13, 1.0), (17, 0.5), (17, 1.0), (17, 2.0), (21, 1.0), (21, 2.0), (27, 2.0)):
        errors = eurosprinter(columns, c) - wanted
        rows.append([str(columns), f"{c:g}", *(f"{100 * e:+.2f}" for e in errors)])
    return rows


def cattaneo(columns: int) -> tuple[float, float]:
    """CONTACT's example of Cattaneo, 7/8 mu N: relative error of the shift; radius of the stick zone over a."""
    g, nu, load, radius, friction = 200e6, 0.42, 9.195, 1e-3, 0.4
    material = Material(2.0 * g * (1.0 + nu), nu, 1000.0)
    modulus = contact_modulus(material, material)
    sphere = PointContact(load, radius**3 * modulus / (0.75 * load), modulus)
    exact = MindlinPoint(sphere, friction, tangential_compliance(material, material))
    wanted = float(exact.loading(0.875 * exact.limit))
    contact = EllipticContact(load, sphere.radius, sphere.radius, modulus)
    patch = PatchRolling(contact, friction, (columns, columns), HalfSpaces(material, material))
    found = patch.shift_under(-0.875 * exact.limit, 2.0 * wanted)
    return found / wanted - 1.0, float(np.sqrt(patch.stick.sum() * patch.area / np.pi)) / radius


def cattaneo_rows() -> list[list[str]]:
    """Columns down."""
    found = {n: cattaneo(n) for n in (13, 17, 21, 27)}
    return [[str(n), f"{shift:+.2%}", f"{stick:.3f}"] for n, (shift, stick) in found.items()]


def compute() -> dict[str, list[list[str]]]:
    """The figures of the page."""
    return {
        "edge": edge_rows(),
        "carter": carter_rows(True, WIDTHS),
        "carter_2": carter_rows(False, (5, 8), (0.25, 0.5, 1.0, 2.0, 4.0)),
        "ring": ring_rows(),
        "swelling": swelling_rows(),
        "kalker": kalker_rows(),
        "smooth": smooth_rows(),
        "step": step_rows(),
        "eurosprinter": eurosprinter_rows(),
        "cattaneo": cattaneo_rows(),
    }


def page(found: dict[str, list[list[str]]]) -> str:
    """The whole page."""
    widths = [f"{n} to {n + 1}" for n in WIDTHS[:-2]]
    few = ["cells/step", *widths, "20, 20.5", "40.25"]
    creepages = [f"{1e3 * xi:g}" for xi, _ in published.EUROSPRINTER_FORCES]
    return f"""# Rolling friction on contact-fixed cells

A reference of the friction law without bodies (`half_space/patch_rolling.py`): exact elastic half-planes and
half-spaces, like materials; a uniform grid about the middle of the patch, 1.3 times its half-widths to each side, with
an odd number of cells; pressure and traction constant on a cell, bound μ times the cell's own pressure, slip judged at
its centre; displacements of the last step read from the grid and three rings of cells around it by cubic interpolation.
*Columns* counts cells across the grid: 13 columns are five in a half-width, 21 eight.

## The rule at the leading edge

With c cells advanced in the step and d cells from the centre of a cell to the edge ahead,

    s + k τ = 0,    k = 2 (g(0) - g(w)) min(c, 1) (max(c, 1)/d - 1), not below 0
    d = cells to the last one under pressure + e + 0.35 - 0.15 min(c, 1)
    e = -0.175 + 0.95 r + 0.6 r²,    r = pressure of the last cell over that of its neighbour, at most 0.75

r and e: by Hertz lines whose pressures are found on the cells, at all phases. Error of e, in cells, by the cells in a
half-width:

{table(["cells", "error of the edge"], found["edge"])}
## Carter: error of Q at his creepage, % of μP

Case C1, Q/μP of {", ".join(f"{q:g}" for q in SHARES)}: least and largest error over these and over the places of the
edge in its cell, by the cells in a half-width (above) and the cells advanced in a step.

{table(few, found["carter"])}
The same with cells at the edge charged with the whole step:

{table(["cells/step", "5 to 6", "8 to 9"], found["carter_2"])}
Below one cell a step these errors do not vanish with the step: interpolation between a cell under pressure and a free
one charges slip that went on before the edge.

## Rings

The same by the rings of cells on which displacements are kept, clamped beyond: three are enough to four cells a step.

{table(["cells/step", "rings", "5 to 6", "8 to 9"], found["ring"])}
## A patch that grows and shrinks

Load P (1 + 0.6 sin), period three half-widths, creepage of Q/μP = 0.9 at the mean; the grid follows the patch in every
step. Error of Q against 201 columns, % of μP: largest, root mean square. Cubic or linear: how displacements are read.

{table(["columns", "cells/step", "cubic", "linear", "cubic, whole step charged"], found["swelling"])}
## Kalker's coefficients

Steady rolling without slip, which small creepages tend to: C11, C22, C23 against Kalker's table, one cell per step, by
columns in each direction. The table is rounded to three digits, up to 0.5 %.

{table(["a/b", "ν", *(f"{n} columns" for n in KALKER_COLUMNS)], found["kalker"])}
Circle, ν = 0.25: by columns and cells across the patch, at three steps. What remains goes up and down with the area of
the cells that are under pressure at the sides; forces with slip (next section) differ by 0.3 % of μN between grids.

{table(["columns", "across", "0.25 cells/step", "1", "2"], found["smooth"])}
21 columns, by the cells advanced in a step: with the rule, charged with the whole step, and with the rule rolling at an
angle to the grid. Spin is taken in the middle of the way inside the patch.

{table(["cells/step", "rule", "whole step", "15°", "30°", "45°"], found["step"])}
## CONTACT's Eurosprinter

F_x at nine creepages (in 1e-3) against CONTACT's, % of μN, by columns and cells per step. CONTACT has cells, too: its
example of Carter is 0.8 % of μP high.

{table(["columns", "cells/step", *creepages], found["eurosprinter"])}
## Cattaneo

CONTACT's sphere on a plane at 7/8 μN: shift against the closed form, radius of the stick zone over a (exactly 0.5).

{table(["columns", "shift", "stick"], found["cattaneo"])}"""
