"""Sections of involute gears against the involute's properties, the motion of the rack, and each other."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from warpffrf.model.errors import InputError
from warpffrf.model.gears import Gear
from warpffrf.model.surfaces import Curve

M = 4.5e-3  # m
ALPHA = np.radians(20.0)
PINION = Gear(M, 16, profile_shift=0.1817, tip_diameter=82.45e-3)
SHIFTED = Gear(M, 12, profile_shift=0.7, tip_diameter=69.4e-3, thickness_allowance=-60e-6, tip_rounding=0.1e-3)
LARGE = Gear(M, 73, pressure_angle=np.radians(22.5), tip_rounding=0.4e-3)
INTERNAL = Gear(M, 60, internal=True, profile_shift=0.2, root_radius=0.3, tip_rounding=0.3e-3)
HELICAL = Gear(M, 23, profile_shift=0.3, helix_angle=np.radians(-22.0), tip_rounding=0.2e-3, thickness_allowance=-60e-6)
GEARS = {"pinion": PINION, "shifted": SHIFTED, "large": LARGE, "internal": INTERNAL, "helical": HELICAL}
EXACT = 1e-10  # m: flanks are made to 2e-11
FILLET = 1e-9  # m: fillets are made to 5e-10


def rotated(points: np.ndarray, angle: float) -> np.ndarray:
    c, s = np.cos(angle), np.sin(angle)
    return points @ np.array([[c, s], [-s, c]])


@pytest.mark.parametrize("name", list(GEARS))
def test_flanks_are_involutes(name: str) -> None:
    """The tangent to the base circle from each point of the flank is normal to it, and as long as that part of the base
    circle from the start of the involute; the thickness is that of the table."""
    gear = GEARS[name]
    curve, sign = gear.flank("right"), gear.side
    u = np.linspace(0.0, curve.length, 4001)
    points = curve.at(u)
    r = np.hypot(*points.T)
    ends = 0.5 * np.sort([gear.root_form_diameter, gear.tip_form_diameter])
    on = (r > ends[0] + 1e-6) & (r < ends[1] - 1e-6)
    r, points, normal = r[on], points[on], curve.normal(u[on])
    reach = np.abs(points[:, 0] * normal[:, 1] - points[:, 1] * normal[:, 0])  # distance of the normal from the axis
    assert np.abs(reach - gear.base_radius).max() < 3e-7 * gear.base_radius  # so exact are torques
    s = np.array([gear.tooth_thickness(2.0 * radius) for radius in r])
    assert np.abs(np.arctan2(points[:, 1], points[:, 0]) * r + sign * 0.5 * s).max() < EXACT


@pytest.mark.parametrize("gear", [PINION, SHIFTED, LARGE, HELICAL], ids=["pinion", "shifted", "large", "helical"])
def test_the_span_over_teeth(gear: Gear) -> None:
    """W_k = m_n cos alpha_n (pi (k - 1/2) + z inv alpha_t) + 2 x m_n sin alpha_n (DIN 3960), in the transverse section
    over cos beta_b, for every inclination of the faces between which k teeth fit."""
    a, z, k = gear.pressure_angle, gear.teeth, round(gear.teeth / 9.0 + 0.5)
    a_t = np.arctan(np.tan(a) / np.cos(gear.helix_angle))
    known = M * np.cos(a) * (np.pi * (k - 0.5) + z * (np.tan(a_t) - a_t)) + 2.0 * gear.generating_shift * M * np.sin(a)
    known /= np.sqrt(1.0 - (np.sin(gear.helix_angle) * np.cos(a)) ** 2)
    right, left = gear.flank("right"), gear.flank("left", k)
    middle = np.pi * (k - 1) / z  # between the teeth, and the normal to the faces
    for tilt in (-0.05, 0.0, 0.05):
        d, reach = np.array([-np.sin(middle + tilt), np.cos(middle + tilt)]), []
        for curve in (left, right):
            points = curve.at(np.linspace(0.0, curve.length, 40001))
            reach.append(points[np.hypot(*points.T) > 0.5 * gear.root_form_diameter] @ d)
        assert abs(reach[0].max() - reach[1].min() - known) < 1e-9


@pytest.mark.parametrize("gear", [PINION, SHIFTED, LARGE, HELICAL, Gear(M, 24, profile_shift=1.0, tip_diameter=0.122)])
def test_the_rack_that_rolls_on_the_pitch_circle_leaves_the_root(gear: Gear) -> None:
    """Every point of root and fillet is touched by the tooth of the rack in one position, and cut in none; that of a
    helical gear by the rack whose normal section is stretched by 1/cos beta."""
    rho, x, a = gear.root_radius * M, gear.generating_shift * M, gear.pressure_angle
    below = gear.dedendum * M - rho  # the centre of the arc, below the datum line
    land = 0.25 * np.pi * M - below * np.tan(a) - rho / np.cos(a)
    flank = 2.0 * M
    # half of the tool's tooth, seen from the gear's axis, the tool to the left: the flank towards the tip, arc, land
    start = np.array([land + rho * np.cos(a) + flank * np.sin(a), -below - rho * np.sin(a) + flank * np.cos(a)])
    pieces = [(flank, np.inf), (rho * (0.5 * np.pi - a), -rho)] + [(land + 1e-4, np.inf)]
    tool = Curve.arcs(start, -0.5 * np.pi - a, pieces)  # clockwise: the tool lies to the right
    curve = gear.flank("right")
    points = curve.at(np.linspace(0.0, curve.length, 60))
    form = 0.5 * gear.root_form_diameter
    points = points[np.hypot(*points.T) < form]
    assert len(points) > 10
    r, pitch = 0.5 * gear.reference_diameter, np.pi / gear.teeth
    up = rotated(points, pitch + 0.5 * np.pi) * [-1.0, 1.0]  # the space upwards, its side that the tool's x points to
    for point in up:
        middle = 0.0
        for step in (1e-3, 2e-5):  # rad
            angles = middle + step * np.arange(-500, 501)
            # the gear rotates clockwise, the tool moves along +x
            c, s = np.cos(angles), np.sin(angles)
            place = np.stack([c * point[0] + s * point[1] - r * angles, c * point[1] - s * point[0] - r - x], axis=1)
            place[:, 0] *= np.cos(gear.helix_angle)
            near = (place[:, 0] > 0.0) & (place[:, 1] < start[1])
            distance = -tool.foot(place[near])[1]  # positive outside of the tool
            middle = angles[near][np.argmin(distance)]
        assert abs(distance.min()) < 3e-9  # of the step: r (1e-5)^2/2


def test_the_angles_of_a_helical_gear() -> None:
    """Of ISO 21771, by other paths: m_t, alpha_t, the lead of the helix, which is one on all cylinders, and the relief,
    which is along the normal."""
    beta, alpha = np.radians(-22.0), HELICAL.pressure_angle
    assert HELICAL.reference_diameter == pytest.approx(M * 23 / np.cos(beta))
    assert np.tan(HELICAL.transverse_pressure_angle) == pytest.approx(np.tan(alpha) / np.cos(beta))
    assert 2.0 * np.pi / HELICAL.twist == pytest.approx(np.pi * HELICAL.reference_diameter / np.tan(beta))
    assert np.tan(HELICAL.base_helix_angle) == pytest.approx(HELICAL.twist * HELICAL.base_radius, rel=1e-14)
    assert np.cos(HELICAL.base_helix_angle) * HELICAL.base_pitch == pytest.approx(np.pi * M * np.cos(alpha))  # p_en
    assert HELICAL.root_diameter == pytest.approx(
        HELICAL.reference_diameter + 2.0 * M * (HELICAL.generating_shift - 1.25)
    )
    relieved = replace(HELICAL, tip_rounding=0.0, tip_relief=20e-6, tip_relief_length=3e-3)
    tip = relieved.surfaces(("right",), (1,))["flank_right_1"]
    plain = replace(HELICAL, tip_rounding=0.0).surfaces(("right",), (1,))["flank_right_1"]
    assert plain.chart(tip.point(tip.curve.length, 2e-3))[2] == pytest.approx(-20e-6, rel=1e-2)


@pytest.mark.parametrize("name", list(GEARS))
def test_the_parts_continue_one_another(name: str) -> None:
    parts = [part for key, part in GEARS[name].half.items() if key != "tip" or GEARS[name].tip_rounding]
    for (_, points, tangents), (_, others, headings) in zip(parts[:-1], parts[1:], strict=True):
        assert np.abs(points[-1] - others[0]).max() < 1e-15
        assert np.abs(tangents[-1] - headings[0]).max() < 1e-12


def test_curves_are_exact_between_their_knots() -> None:
    from warpffrf.model.gears import tooth

    for gear in GEARS.values():
        curve = gear.flank("right")
        flank, _, _ = tooth.involute(gear)(gear.side * np.linspace(gear.root_form_rho, gear.tip_form_rho, 5001))
        assert np.abs(curve.foot(flank)[1]).max() < EXACT
        if not gear.internal:
            fillet, _, _ = tooth.trochoid(gear)(-np.linspace(gear.transverse_pressure_angle, 0.5 * np.pi, 5001))
            assert np.abs(curve.foot(fillet)[1]).max() < FILLET


def test_the_flanks_of_an_internal_gear_are_those_of_the_spaces() -> None:
    """Of an external gear with the opposite shift, half a pitch away."""
    external = Gear(M, 60, profile_shift=-0.2)
    angle = np.pi / 60.0
    flank = INTERNAL.flank("right")
    other = external.flank("right", 1)
    points = rotated(flank.at(np.linspace(0.0, flank.length, 500)), -angle)
    r = np.hypot(*points.T)
    low = 0.5 * max(external.root_form_diameter, INTERNAL.tip_form_diameter)
    on = (r > low) & (r < 0.5 * min(external.tip_diameter, INTERNAL.root_form_diameter))
    assert on.sum() > 200
    assert np.abs(other.foot(points[on])[1]).max() < EXACT


@pytest.mark.parametrize("name", ["shifted", "large", "internal"])
def test_sections(name: str) -> None:
    """The closed curve has the flanks of every tooth, between root and tip circle, the axis on the right side."""
    gear = GEARS[name]
    section = gear.section()
    for tooth, side in ((1, "right"), (3, "left"), (gear.teeth, "right")):
        flank = gear.flank(side, tooth)
        assert np.abs(section.foot(flank.at(np.linspace(0.0, flank.length, 300)))[1]).max() < EXACT
        assert np.all(
            np.sum(section.normal(section.foot(flank.points[1:-1])[0]) * flank.normal(flank.knots[1:-1])) > 0.9
        )
    r = np.hypot(*section.at(np.linspace(0.0, section.length, 20001)).T)
    ends = 0.5 * np.sort([gear.root_diameter, gear.tip_diameter])
    assert np.abs([r.min() - ends[0], r.max() - ends[1]]).max() < FILLET
    assert section.foot(np.array([1e-5, 0.0]))[1] * gear.side < 0.0


@pytest.mark.parametrize("shape, middle", [("parabolic", 0.25), ("linear", 0.45 / 0.95)])
@pytest.mark.parametrize("plain", [PINION, replace(INTERNAL, tip_rounding=0.0)], ids=["external", "internal"])
def test_tip_relief(plain: Gear, shape: str, middle: float) -> None:
    """It removes the amount along the normal at the tip, its share half-way and nothing below."""
    length = 4e-3
    relieved = replace(plain, tip_relief=30e-6, tip_relief_length=length, tip_relief_shape=shape)
    rho = plain.tip_rho - plain.side * length * np.array([0.0, 0.5, 1.0, 1.2])
    u = 0.5 * np.abs(rho**2 - plain.root_form_rho**2) / plain.base_radius  # arc length of an involute
    flank = plain.flank("right")
    points, normals = flank.at(u + flank.length - u[0]), flank.normal(u + flank.length - u[0])
    removed = relieved.flank("right").foot(points - np.array([30e-6, 30e-6 * middle, 0.0, 0.0])[:, None] * normals)[1]
    assert np.abs(removed).max() < EXACT
    assert relieved.tip_form_diameter == pytest.approx(plain.tip_diameter, abs=1e-12)


def test_a_rounding_may_be_longer_than_the_relief() -> None:
    for gear in (PINION, INTERNAL):
        short = replace(gear, tip_rounding=0.5e-3, tip_relief=20e-6, tip_relief_length=0.3e-3)
        plain = replace(gear, tip_rounding=0.5e-3)
        curve = short.flank("right")
        assert np.abs(plain.flank("right").foot(curve.at(np.linspace(0.0, curve.length, 500)))[1]).max() < 20e-6


WRONG: list[tuple[dict[str, Any], str]] = [
    ({"teeth": 12}, "12 teeth with profile_shift 0 .* are undercut; make it larger than 0.298"),
    ({"teeth": 9, "profile_shift": 0.8}, "the teeth are pointed within the tip circle"),
    ({"teeth": 20, "root_radius": 0.5}, "root_radius 0.5 does not fit the tooth of the rack; make it at most 0.472"),
    ({"teeth": 20, "tip_rounding": 5e-3}, "tip_rounding 0.005 .* is too large"),
    ({"teeth": 20, "tip_diameter": 80e-3}, "lies within the base circle of 0.0845723 m"),
    ({"teeth": 60, "tip_diameter": 0.257}, "must lie beyond the root circle"),
    ({"teeth": 60, "tip_diameter": 0.26}, "leaves no involute above the fillet"),
    ({"teeth": 20, "pressure_angle": 20.0}, "pressure_angle must be at most 45 degrees, in rad"),
    ({"teeth": 20, "helix_angle": 20.0}, "helix_angle must be within .*45 degrees, in rad"),
    ({"teeth": 20, "tip_relief": 1e-5}, "tip_relief and tip_relief_length belong together"),
    ({"teeth": 20, "tip_relief": 1e-5, "tip_relief_length": 0.03}, "tip_relief_length 0.03 m must be shorter"),
    ({"teeth": 20, "tip_relief_shape": "round"}, "tip_relief_shape 'round' does not exist"),
    ({"teeth": 4}, "teeth must be a whole number of at least 5"),
    ({"teeth": 20, "internal": True}, "lies within the base circle of .* where no involute exists; take a larger tip_"),
    ({"teeth": 60, "internal": True, "tip_diameter": 0.3}, "tip_diameter 0.3 m must lie within the root circle"),
    ({"teeth": 60, "internal": True, "profile_shift": -0.8}, "root_radius 0.38 .* two fillets between teeth overlap"),
]  # fmt: skip


@pytest.mark.parametrize("arguments, message", WRONG, ids=[text[:30] for _, text in WRONG])
def test_impossible_gears_are_refused(arguments: dict[str, Any], message: str) -> None:
    with pytest.raises(InputError, match=message):
        Gear(M, **arguments)


def test_sharp_edges_and_unknown_flanks_are_refused() -> None:
    with pytest.raises(InputError, match="smooth curve only with rounded tip edges; give tip_rounding"):
        PINION.section()
    with pytest.raises(InputError, match="flank 'rigth' does not exist; did you mean 'right'"):
        PINION.flank("rigth")
    with pytest.raises(InputError, match="tooth must be a whole number of at most 16"):
        PINION.flank("left", 17)
    with pytest.raises(InputError, match="the flanks begin at the base circle"):
        PINION.tooth_thickness(60e-3)
