"""The catalogue: standard dimensions by designation, the relations of their series, and estimates of the inside."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import warpffrf as wf
from warpffrf.model.bearings import BallGeometry, RollerGeometry
from warpffrf.model.bearings.designations import SERIES, Boundary, _data, _named, _table, boundary, estimate
from warpffrf.model.errors import InputError

MM = 1e-3
SIZES = {
    "61810": (50, 65, 7), "61910": (50, 72, 12), "16010": (50, 80, 10), "6000": (10, 26, 8), "6205": (25, 52, 15),
    "6310": (50, 110, 27), "6403": (17, 62, 17), "6220": (100, 180, 34), "7210 B": (50, 90, 20), "3205": (25, 52, 20.6),
    "3308": (40, 90, 36.5), "QJ 310": (50, 110, 27), "NU 1010": (50, 80, 16), "N 209": (45, 85, 19),
    "NU 2210": (50, 90, 23), "NJ 2310": (50, 110, 40), "NUP 410": (50, 130, 31), "NA 4910": (50, 72, 22),
    "NA 6908": (40, 62, 40), "NA 4822": (110, 140, 30), "21310": (50, 110, 27), "22220": (100, 180, 46),
    "22316": (80, 170, 58), "23024": (120, 180, 46), "23122": (110, 180, 56), "23220": (100, 180, 60.3),
    "23930": (150, 210, 45), "24020": (100, 150, 50), "24122": (110, 180, 69), "C 2220": (100, 180, 46),
    "30205": (25, 52, 16.25), "31308": (40, 90, 25.25), "32008": (40, 68, 19), "33210": (50, 90, 32),
    "51110": (50, 70, 14), "51210": (50, 78, 22), "51310": (50, 95, 31), "51410": (50, 110, 43),
    "81210": (50, 78, 22), "29320": (100, 170, 42), "29420": (100, 210, 67),
}  # fmt: skip


@pytest.mark.parametrize("designation", SIZES)
def test_published_sizes(designation: str) -> None:
    found = boundary(designation)
    assert found.designation == designation
    assert (found.bore, found.outside_diameter, found.width) == pytest.approx([MM * x for x in SIZES[designation]])


def every() -> list[Boundary]:
    found = []
    for series, (_, plan, column) in SERIES.items():
        table = _table(plan, series if plan == "tapered" else column[-1])
        found += [boundary(_named(series, bore)) for bore, row in table.items() if column in row]
    return found


def test_sizes_grow_with_the_bore_and_with_the_series() -> None:
    """Outside diameters from bore to bore and from diameter series to diameter series, widths at least not less."""
    for plan, tables in _data().items():
        for series in tables:
            rows = _table(plan, series)
            columns = sorted({name for row in rows.values() for name in row} - {"angle", "C"})
            for name in columns:
                values = [row[name] for _, row in sorted(rows.items()) if name in row]
                assert np.all(np.diff(values) >= 0.0), (plan, series, name)
            for row in rows.values():
                widths = [row[name] for name in columns if name.isdigit() and name in row and plan == "radial"]
                assert widths == sorted(widths) and row["d"] < row["D"], (plan, series, row)
    for plan, order in (("radial", "8901234"), ("thrust", "1234")):
        for small, large in zip(order, order[1:], strict=False):
            common = _table(plan, small).keys() & _table(plan, large).keys()
            assert common and all(_table(plan, small)[d]["D"] < _table(plan, large)[d]["D"] for d in common)


def test_tapered_bearings_share_sizes_with_radial_ones() -> None:
    """ISO 355 has the outside diameters of ISO 15, and the inner rings of its older series the widths."""
    shared = {"302": "02", "322": "22", "303": "03", "323": "23", "320": "0", "330": "0", "329": "9", "332": "2"}
    for series, column in shared.items():
        for bore, row in _table("tapered", series).items():
            radial = _table("radial", column[-1])[bore]
            assert row["D"] == radial["D"] and row["C"] < row["T"] and row["B"] <= row["T"]
            assert len(column) == 1 or row["B"] == radial[column], (series, bore)
    assert boundary("32008").contact_angle == pytest.approx(np.radians(14.0 + 10.0 / 60.0))
    assert boundary("32008").outer_width == pytest.approx(14.5 * MM)


def test_every_bearing_has_an_inside_that_fits() -> None:
    """Elements that do not overlap, between bore and outside diameter; geometries of kinds that are built."""
    bearings = every()
    assert len(bearings) > 1800
    for found in bearings:
        inside = estimate(found)
        size, length = inside.get("ball_diameter", inside.get("roller_diameter")), inside.get("roller_length", 0.0)
        assert inside["elements"] * size < np.pi * inside["pitch_diameter"] and length < max(
            found.width, found.section / 2
        )
        if "thrust" not in found.kind:
            room = min(found.outside_diameter - inside["pitch_diameter"], inside["pitch_diameter"] - found.bore)
            assert size < 0.8 * room, found
        more = {"contact_angle": 0.3} if found.kind == "angular contact ball" else {}
        assert wf.bearings.catalogue(found.designation, **more).bore == found.bore


# Published insides: number, diameter, pitch diameter [mm]; the estimate is off by: elements, share of diameter.
# 6305 is P7, 6209 P8, 7218 B P9, N 209 P10; 6203 and 6205 are those of the test rig of Case Western Reserve University.
INSIDES: dict[str, tuple[int, float, float, int, float]] = {
    "6203": (8, 6.75, 28.5, 0, 0.04), "6205": (9, 7.94, 39.04, 0, 0.04), "6305": (7, 11.5, 43.5, 0, -0.02),
    "6209": (9, 12.7, 65.0, 1, -0.04), "7218 B": (16, 22.23, 125.3, 0, 0.0), "N 209": (14, 10.0, 64.0, 3, 0.0),
}  # fmt: skip


@pytest.mark.parametrize("designation", INSIDES)
def test_published_insides(designation: str) -> None:
    """Diameters within 4 %, pitch diameters within 1.6 %; a ball more in 6209, three rollers more in an old N 209."""
    elements, diameter, pitch, more, off = INSIDES[designation]
    found = wf.bearings.catalogue(designation)
    assert found.elements - elements == more
    assert found.diameter / (diameter * MM) - 1.0 == pytest.approx(off, abs=6e-3)
    assert found.pitch_diameter == pytest.approx(pitch * MM, rel=0.016)


def test_overrides() -> None:
    known: dict[str, Any] = {"elements": 9, "ball_diameter": 12.7e-3, "clearance": 15e-6}
    found = wf.bearings.catalogue("6209", **known)
    assert found == BallGeometry(
        **known, pitch_diameter=65e-3, osculation=(0.52, 0.53), width=19e-3, bore=45e-3, outside_diameter=85e-3
    )
    assert wf.bearings.catalogue("7218 B").contact_angle == pytest.approx(np.radians(40.0))
    assert wf.bearings.catalogue("7218", contact_angle=0.3).contact_angle == 0.3


def test_spelling_does_not_matter() -> None:
    assert wf.bearings.catalogue("nu2210") == wf.bearings.catalogue(" NU  2210 ") == wf.bearings.catalogue("NU 2210")


def test_builders_take_them() -> None:
    scene = wf.Scene()
    ball = scene.add_bearing("front", wf.bearings.catalogue("6310"))
    roller = scene.add_bearing("rear", wf.bearings.catalogue("NU 2210"))
    assert len(ball.elements) == 8 and isinstance(roller.geometry, RollerGeometry)
    ring = 7850.0 * np.pi / 4.0 * (0.11**2 - (0.08 + 0.4 * 0.0183) ** 2) * 0.027  # up to the shoulder
    assert ball.outer.mass == pytest.approx(ring, rel=1e-6)  # pyright: ignore[reportAttributeAccessIssue]


REFUSED: list[tuple[Any, dict[str, Any], str]] = [
    (6310, {}, "6310 is no designation, a series and two digits"),
    ("bearing", {}, "is no designation"),
    ("NU 2150", {}, r"the series 'NU 21' does not exist; did you mean 'NU 2'\? known: .*'NU 22'"),
    ("6999", {}, "the series '69' does not exist; did you mean '619'"),
    ("6341", {}, "the series 63 has no bore of 205 mm here, its bores are 10 to 200 mm; .* '6338' and '6340'"),
    ("NA 4921", {}, "the nearest are 'NA 4920' and 'NA 4922'"),
    ("6310 C3", {}, "the suffix 'C3' is not known, deep groove ball bearings have none here; .*clearance="),
    ("7210 D", {}, "angular contact ball bearings have C, AC, A, B here"),
    ("7210", {}, r"'7210': give the contact angle once, by a suffix, C \(15 degrees\)"),
    ("7210 B", {"contact_angle": 0.3}, "'7210 B': give the contact angle once"),
    ("7210 B", {"clearance": 1e-5}, "give the contact angle, .* or the diametral clearance, not both"),
    ("6310", {"bore": 0.05}, "bore is 0.05 m by the designation; leave it out"),
    ("6310", {"elements": 20}, "20 elements .* overlap .* use at most 13 elements"),
    ("6310", {"pitch_diameter": 0.06}, "do not fit between the bore of 0.05 m and the outside diameter of 0.11 m"),
    ("NU 2210", {"roller_length": 0.03}, "roller_length 0.03 m exceeds the width of 0.023 m"),
]


@pytest.mark.parametrize(("designation", "overrides", "said"), REFUSED)
def test_what_is_wrong_is_named(designation: Any, overrides: dict[str, Any], said: str) -> None:
    with pytest.raises(InputError, match=said):
        wf.bearings.catalogue(designation, **overrides)


def test_an_unknown_override_is_named() -> None:
    with pytest.raises(TypeError, match="there is no argument 'clearence'; did you mean 'clearance'"):
        wf.bearings.catalogue("6310", clearence=1e-5)
