r"""Rolling bearings by designation: standardised boundary dimensions, and an estimate of the inside.

Bore d, outside diameter D and width B (height T of thrust bearings) are those of ISO 15, ISO 355 and ISO 104
[`boundary_dimensions.toml`], common to all makers: "NU 2210" is a series, NU 22, with the widths of the dimension
series 22, and a code of the bore, 10, which is 50 mm.

**The inside is an estimate.** No standard has it, and it differs between makers and generations. With the mean diameter
d_m = (d + D)/2, the pitch diameter except of needles, where it is F + D_w, F the inner raceway of ISO 1206:

| kind | diameter D_w | length | number Z |
|---|---|---|---|
| deep groove ball | 0.305 (D - d), series 160: 0.24 (D - d) | | nearest to 1 + psi/(2 arcsin(D_w/d_m)) |
| angular and four-point contact ball | 0.3175 (D - d) | | spacing 1.1 D_w |
| double-row angular contact ball | 0.28 (D - d) | | spacing 1.15 D_w |
| cylindrical roller | 0.25 (D - d) | B - 0.7 D_w, series 10: B - 1.1 D_w | spacing 1.2 D_w |
| needle roller | (D - F)/4 | 0.7 B | spacing 1.3 D_w |
| tapered roller, C the width of the outer ring | 0.25 (D - d) | 0.8 C/cos(alpha) | spacing 1.15 D_w |
| spherical roller, two rows, sin(alpha) = 0.28 B/((d_m + D_w)/2) | 0.28 (D - d) | 0.4 B at most | spacing 1.15 D_w |
| toroidal roller, raceways of the radius 2 d_m in the axial section | 0.25 (D - d) | 0.75 B | spacing 1.15 D_w |
| thrust ball | 0.52 T | | spacing 1.15 D_w |
| thrust cylindrical roller | 0.42 T | 0.3 (D - d) | spacing 1.4 D_w |
| thrust spherical roller, alpha = 50 deg | 0.22 (D - d) | 0.6 T | spacing 1.3 D_w |

Rows of balls are 1.15 D_w apart; barrel-shaped rollers are at most 0.95 as long as the room of their row; barrel-shaped
rollers have the crown radius 0.97 of that of their raceways, both of which have the radius of the outer sphere. psi =
186 degrees is the filling angle of balls, which are inserted between eccentric rings. Grooves have the radii 0.52 D_w
and 0.53 D_w (thrust: 0.535 D_w), for which ISO 281 and ISO 76 rate bearings. Shares and spacings are rounded values
from published insides, and from the ratings of catalogues: docs/method/18_rolling_bearings.md.
"""

from __future__ import annotations

import re
import tomllib
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any, cast

import numpy as np

from warpffrf.model.bearings.geometry import BallGeometry, RollerGeometry
from warpffrf.model.errors import InputError, suggestion

MM = 1e3  # in a metre
FILLING = np.radians(186.0)  # angle from the first to the last ball in an eccentric gap between the rings
CODES = {"00": 10, "01": 12, "02": 15, "03": 17}  # of bores [mm]; others are a fifth of the bore
ANGLES = {"C": 15.0, "AC": 25.0, "A": 30.0, "B": 40.0}  # degrees, by the suffix of angular contact ball bearings
BARREL = 0.97  # crown radius of barrel-shaped rollers over the radius of their raceways
DIMENSIONS = ("bore", "outside_diameter", "width")

# Kind -> general plan, and series:dimension series; the series of tapered roller bearings are tables of their own.
CYLINDRICAL = ("10:10", "2:02", "22:22", "3:03", "23:23", "4:04")
PLANS = {
    "deep groove ball": ("radial", "618:18 619:19 160:00 60:10 62:02 63:03 64:04"),
    "angular contact ball": ("radial", "70:10 72:02 73:03"),
    "double-row angular contact ball": ("radial", "32:32 33:33"),
    "four-point contact ball": ("radial", "QJ_2:02 QJ_3:03"),
    "cylindrical roller": ("radial", " ".join(f"{t}_{s}" for t in ("NU", "NJ", "NUP", "N") for s in CYLINDRICAL)),
    "needle roller": ("radial", "NA_48:48 NA_49:49 NA_69:69"),
    "tapered roller": ("tapered", "302:T 303:T 313:T 320:T 322:T 323:T 329:T 330:T 331:T 332:T"),
    "spherical roller": ("radial", "213:03 222:22 223:23 230:30 231:31 232:32 239:39 240:40 241:41"),
    "toroidal roller": ("radial", "C_22:22 C_23:23 C_30:30 C_31:31 C_32:32 C_40:40 C_41:41"),
    "thrust ball": ("thrust", "511:11 512:12 513:13 514:14"),
    "thrust cylindrical roller": ("thrust", "811:11 812:12"),
    "thrust spherical roller": ("thrust", "293:93 294:94"),
}
SERIES = {
    name.replace("_", " "): (kind, plan, column)
    for kind, (plan, series) in PLANS.items()
    for name, column in (one.split(":") for one in series.split())
}


@dataclass(frozen=True)
class Boundary:
    """Boundary dimensions [m] of a bearing: bore, outside diameter, width (of both rings together, height of a thrust
    bearing); inner_width, outer_width: of the rings of tapered roller bearings; raceway: diameter of the inner one of
    needle roller bearings; contact_angle [rad], None where the designation has none. kind, series: as in SERIES."""

    designation: str
    kind: str
    series: str
    bore: float
    outside_diameter: float
    width: float
    inner_width: float | None = None
    outer_width: float | None = None
    raceway: float | None = None
    contact_angle: float | None = None

    @property
    def section(self) -> float:
        """D - d [m]."""
        return self.outside_diameter - self.bore


def catalogue(designation: str, **overrides: Any) -> Any:
    """The geometry of a bearing of standard size: catalogue("6310"), ("7210 B"), ("NU 2210"), ("N 209"), ("NA 4910").

    It is a `BallGeometry` or a `RollerGeometry`, which `scene.add_bearing` take.
    Boundary dimensions are those of ISO 15, the inside is an estimate (`warpffrf.model.bearings.designations`) with the
    clearance 0. overrides: fields of `BallGeometry` or `RollerGeometry` that are known better: catalogue("6310",
    elements=8, ball_diameter=19.05e-3, clearance=12e-6); the others remain as they are estimated.

    designation: series and code of the bore, 00, 01, 02, 03 for 10, 12, 15, 17 mm, then a fifth of it, up to 200 mm.
    Angular contact ball bearings have the suffix C, AC, A or B (15, 25, 30, 40 degrees), or a contact_angle [rad].
    Rings of N, NU, NJ and NUP differ in their ribs, which `bearings.Flanges` describes. Raises `InputError` for an
    unknown designation, naming the nearest ones, and for elements that do not fit.
    """
    found = boundary(designation)
    label = f"catalogue: {found.designation!r}"
    described = BallGeometry if found.kind.endswith("ball") else RollerGeometry
    if given := [name for name in DIMENSIONS if name in overrides]:
        raise InputError(
            f"{label}: {given[0]} is {getattr(found, given[0]):g} m by the designation; leave it out, or describe the "
            f"bearing by bearings.{described.__name__}(...)"
        )
    if found.kind == "angular contact ball" and (found.contact_angle is None) != ("contact_angle" in overrides):
        known = ", ".join(f"{suffix} ({angle:g} degrees)" for suffix, angle in ANGLES.items())
        raise InputError(f"{label}: give the contact angle once, by a suffix, {known}, or by contact_angle= [rad]")
    dimensions = {name: getattr(found, name) for name in DIMENSIONS}
    geometry = described(**{**estimate(found), **dimensions, **overrides})
    pitch, size = geometry.pitch_diameter, geometry.diameter
    if size >= min(found.outside_diameter - pitch, pitch - found.bore):
        raise InputError(
            f"{label}: elements of diameter {size:g} m on a pitch circle of {pitch:g} m do not fit between the bore of "
            f"{found.bore:g} m and the outside diameter of {found.outside_diameter:g} m; correct one of the two"
        )
    length = getattr(geometry, "roller_length", 0.0)
    if length > found.width:
        raise InputError(f"{label}: roller_length {length:g} m exceeds the width of {found.width:g} m; correct it")
    return geometry


def boundary(designation: str) -> Boundary:
    """The boundary dimensions of a designation. Raises `InputError` for an unknown one, with the nearest."""
    label = f"catalogue: {designation!r}"
    text = " ".join(designation.upper().split()) if isinstance(designation, str) else ""
    parts = re.fullmatch(r"([A-Z]*)[ ]?(\d+)(\d\d)(?!\d)[ ]?(.*)", text)
    if parts is None:
        raise InputError(
            f"{label} is no designation, a series and two digits for the bore: '6310', 'NU 2210', 'NA 4910'"
        )
    letters, digits, code, suffix = parts.groups()
    series, bore = f"{letters} {digits}".strip(), CODES.get(code, 5 * int(code))
    if series not in SERIES:
        raise InputError(f"{label}: the series {series!r} does not exist{suggestion(series, list(SERIES))}")
    kind, plan, column = SERIES[series]
    allowed = list(ANGLES) if kind == "angular contact ball" else []
    if suffix and suffix not in allowed:
        raise InputError(
            f"{label}: the suffix {suffix!r} is not known, {kind} bearings have {', '.join(allowed) or 'none'} here; "
            "leave it out, and give what it means by a keyword, such as clearance="
        )
    table = _table(plan, series if plan == "tapered" else column[-1])
    rows = {known: row for known, row in table.items() if column in row}
    if bore not in rows:
        close = sorted(sorted(rows, key=lambda known: abs(known - bore))[:2])
        raise InputError(
            f"{label}: the series {series} has no bore of {bore} mm here, its bores are {min(rows)} to {max(rows)} mm; "
            f"the nearest are {' and '.join(repr(_named(series, known)) for known in close)}"
        )
    row, more = rows[bore], cast(dict[str, Any], {})
    if plan == "tapered":
        degrees, minutes = divmod(round(100.0 * row["angle"]), 100)
        more = {"inner_width": row["B"] / MM, "outer_width": row["C"] / MM}
        more["contact_angle"] = float(np.radians(degrees + minutes / 60.0))
    elif kind == "needle roller":
        more = {"raceway": row["F"] / MM}
    elif suffix:
        more = {"contact_angle": float(np.radians(ANGLES[suffix]))}
    name = f"{_named(series, bore)} {suffix}".strip()
    return Boundary(name, kind, series, bore / MM, row["D"] / MM, row[column] / MM, **more)


def _named(series: str, bore: int) -> str:
    """The designation of a bore [mm] of a series."""
    return series + next((code for code, known in CODES.items() if known == bore), f"{bore // 5:02d}")


@cache
def _data() -> dict[str, dict[str, str]]:
    return tomllib.loads(Path(__file__).with_name("boundary_dimensions.toml").read_text(encoding="utf-8"))


@cache
def _table(plan: str, series: str) -> dict[int, dict[str, float]]:
    """Bore [mm] -> column -> value, of the columns that the size has."""
    names, *lines = (line.split() for line in _data()[plan][series].strip().splitlines())
    rows = [dict(zip(names, line, strict=True)) for line in lines]
    return {int(row["d"]): {name: float(cell) for name, cell in row.items() if cell != "-"} for row in rows}


def estimate(found: Boundary) -> dict[str, Any]:
    """The inside of a bearing by the rules of the module: elements (of a row), ball_diameter or roller_diameter (in the
    middle) and roller_length, pitch_diameter [m]; rows, contact_angle [rad] and osculation where the kind has them."""
    return RULES[found.kind](found)


def _inside(
    found: Boundary, diameter: float, spacing: float, length: float | None = None, **more: Any
) -> dict[str, Any]:
    """Elements on the mean diameter; diameter and length [m], spacing of their centres in diameters."""
    pitch = 0.5 * (found.bore + found.outside_diameter)
    inside = {"elements": int(np.pi * pitch / (spacing * diameter)), "pitch_diameter": pitch}
    size = {"ball_diameter": diameter} if length is None else {"roller_diameter": diameter, "roller_length": length}
    return {**inside, **size, **more}


GROOVES: dict[str, Any] = {"osculation": (0.52, 0.53)}
UPRIGHT: dict[str, Any] = {"contact_angle": 0.5 * np.pi}


def _deep_groove(found: Boundary) -> dict[str, Any]:
    inside = _inside(found, (0.24 if found.series == "160" else 0.305) * found.section, 1.0, **GROOVES)
    half = np.arcsin(inside["ball_diameter"] / inside["pitch_diameter"])
    return {**inside, "elements": round(1.0 + FILLING / (2.0 * half))}


def _angular(found: Boundary, share: float = 0.3175, spacing: float = 1.1, **more: Any) -> dict[str, Any]:
    return _inside(found, share * found.section, spacing, **{**GROOVES, "contact_angle": found.contact_angle, **more})


def _cylindrical(found: Boundary) -> dict[str, Any]:
    diameter = 0.25 * found.section
    return _inside(found, diameter, 1.2, found.width - (1.1 if found.series.endswith(" 10") else 0.7) * diameter)


def _needle(found: Boundary) -> dict[str, Any]:
    raceway = cast(float, found.raceway)
    diameter = 0.25 * (found.outside_diameter - raceway)
    pitch = raceway + diameter
    inside = _inside(found, diameter, 1.3, 0.7 * found.width)
    return {**inside, "pitch_diameter": pitch, "elements": int(np.pi * pitch / (1.3 * diameter))}


def _tapered(found: Boundary) -> dict[str, Any]:
    angle, width = cast(float, found.contact_angle), cast(float, found.outer_width)
    return _inside(found, 0.25 * found.section, 1.15, 0.8 * width / np.cos(angle), contact_angle=angle)


def _spherical(found: Boundary) -> dict[str, Any]:
    inside = _inside(found, 0.28 * found.section, 1.15, 0.4 * found.width, rows=2)
    pitch, diameter = inside["pitch_diameter"], inside["roller_diameter"]
    angle = float(np.arcsin(0.28 * found.width / (0.5 * (pitch + diameter))))
    spacing = pitch * float(np.tan(angle))
    room = 0.95 * (spacing - diameter * float(np.sin(angle))) / float(np.cos(angle))
    rows = {"contact_angle": -angle, "row_spacing": spacing, "roller_length": min(0.4 * found.width, room)}
    return {**inside, **rows, **_sphere(inside, angle)}


def _sphere(inside: dict[str, Any], angle: float) -> dict[str, Any]:
    """Raceways and profile [m] of barrel-shaped rollers in a sphere at the contact angle [rad]."""
    radius = 0.5 * (inside["pitch_diameter"] / np.cos(angle) + inside["roller_diameter"])
    return {"raceway_radii": float(radius), "profile": BARREL * float(radius)}


def _thrust_spherical(found: Boundary) -> dict[str, Any]:
    angle = float(np.radians(50.0))
    inside = _inside(found, 0.22 * found.section, 1.3, 0.6 * found.width, contact_angle=angle)
    return {**inside, **_sphere(inside, angle)}


def _toroidal(found: Boundary) -> dict[str, Any]:
    inside = _inside(found, 0.25 * found.section, 1.15, 0.75 * found.width)
    radius = 2.0 * inside["pitch_diameter"]
    return {**inside, "raceway_radii": radius, "profile": BARREL * radius}


def _two_rows(found: Boundary) -> dict[str, Any]:
    inside = _angular(found, 0.28, 1.15, rows=2, contact_angle=float(np.radians(30.0)))
    return {**inside, "row_spacing": 1.15 * inside["ball_diameter"]}


RULES: dict[str, Callable[[Boundary], dict[str, Any]]] = {
    "deep groove ball": _deep_groove,
    "angular contact ball": _angular,
    "double-row angular contact ball": _two_rows,
    "four-point contact ball": lambda b: _angular(b, contact_angle=float(np.radians(35.0)), four_point=True),
    "cylindrical roller": _cylindrical,
    "needle roller": _needle,
    "tapered roller": _tapered,
    "spherical roller": _spherical,
    "toroidal roller": _toroidal,
    "thrust ball": lambda b: _inside(b, 0.52 * b.width, 1.15, osculation=(0.535, 0.535), **UPRIGHT),
    "thrust cylindrical roller": lambda b: _inside(b, 0.42 * b.width, 1.4, 0.3 * b.section, **UPRIGHT),
    "thrust spherical roller": _thrust_spherical,
}  # fmt: skip
