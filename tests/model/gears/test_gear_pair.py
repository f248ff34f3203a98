"""Pairs of gears against the data of FZG test gears, the law of gearing and sections that roll on each other."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from scipy.optimize import minimize_scalar

from warpffrf.model.errors import InputError
from warpffrf.model.gears import Gear, GearPair

M = 4.5e-3  # m
A = 91.5e-3  # m
PLAY = -40e-6  # m
PINION = Gear(M, 16, profile_shift=0.1817, tip_diameter=82.45e-3)  # FZG C
WHEEL = Gear(M, 24, profile_shift=0.1715, tip_diameter=118.35e-3)
FZG = GearPair(PINION, WHEEL, A)
RING = Gear(M, 60, internal=True, profile_shift=-0.4, root_radius=0.25, tip_diameter=265e-3, thickness_allowance=PLAY)
STUB = Gear(M, 60, internal=True, addendum=0.8, root_radius=0.3, thickness_allowance=PLAY)
SMALL = Gear(M, 20, profile_shift=0.4, thickness_allowance=PLAY)
BETA = np.radians(17.0)
HELICAL = GearPair(
    Gear(M, 20, helix_angle=BETA, thickness_allowance=PLAY), Gear(M, 31, helix_angle=-BETA, thickness_allowance=PLAY),
    25.55 * M / float(np.cos(BETA)),
)  # fmt: skip
IN_A_RING = GearPair(
    replace(SMALL, helix_angle=BETA, tip_diameter=None), replace(RING, helix_angle=BETA, tip_diameter=0.2775),
    89.9e-3 / float(np.cos(BETA)),
)  # fmt: skip
PAIRS = {
    "helical": HELICAL,
    "helical internal": IN_A_RING,
    "FZG": FZG,
    "with play": GearPair(replace(PINION, thickness_allowance=PLAY), replace(WHEEL, thickness_allowance=PLAY), 91.7e-3),
    "internal": GearPair(SMALL, RING, 89.9e-3),
    "of nearly equal teeth": GearPair(Gear(M, 52, thickness_allowance=PLAY), STUB, 4.0 * M - 5e-6),
}
STAGES = [(70.0, 795), (98.9, 945), (132.5, 1094), (171.6, 1245), (215.6, 1395), (265.1, 1547)]  # N m, MPa
CONTACT = 1e-10  # m


def rotated(points: np.ndarray, angle: float) -> np.ndarray:
    c, s = np.cos(angle), np.sin(angle)
    return points @ np.array([[c, s], [-s, c]])


def test_the_data_of_fzg_gears() -> None:
    """Published for type C with their last digits; the stages of load are from other roundings."""
    assert np.degrees(FZG.working_pressure_angle) == pytest.approx(22.44, abs=0.005)
    assert FZG.working_diameters == pytest.approx((73.2e-3, 109.8e-3), abs=1e-9)
    assert FZG.contact_ratio == pytest.approx(1.44, abs=0.005)
    assert PINION.root_diameter == pytest.approx(M * (16 + 2 * (0.1817 - 1.25)))
    assert replace(PINION, tip_diameter=None).tip_diameter == pytest.approx(M * (16 + 2 * 1.1817))
    pressure, half_width = FZG.hertz(200.0, 14e-3)  # of steel with 206 GPa and 0.3
    assert pressure == pytest.approx(1347.3e6, rel=1e-4)
    assert half_width == pytest.approx(199.6e-6, rel=5e-4)
    for torque, stage in STAGES:
        assert FZG.hertz(torque, 14e-3)[0] == pytest.approx(1e6 * stage, rel=4e-3)


def test_the_path_of_contact() -> None:
    """The flanks at its ends are those on the tip circles; curvatures are those of the flanks; sliding is zero at C."""
    path = FZG.path
    for g, gear, index in ((path["E"], PINION, 0), (path["A"], WHEEL, 1)):
        rho = FZG.curvature_radii(g)[index]
        assert np.hypot(gear.base_radius, rho) == pytest.approx(0.5 * gear.tip_diameter)
    assert path["E"] - path["B"] == pytest.approx(PINION.base_pitch)
    assert path["A"] < path["B"] < path["C"] < path["D"] < path["E"]
    flank, g = PINION.flank("right"), np.linspace(0.5 * path["A"], path["E"], 9)
    r = np.hypot(PINION.base_radius, FZG.curvature_radii(g)[0])
    theta = [-0.5 * PINION.tooth_thickness(2.0 * radius) / radius for radius in r]
    u, _ = flank.foot(r[:, None] * np.stack([np.cos(theta), np.sin(theta)], axis=1))
    assert 1.0 / flank.curvature(u) == pytest.approx(FZG.curvature_radii(g)[0], rel=1e-3)
    assert FZG.roll_angle(g) == pytest.approx(np.sqrt((r / PINION.base_radius) ** 2 - 1.0))
    # sliding: the difference of the velocities' components along the flanks, rho omega
    rho_1, rho_2 = FZG.curvature_radii(g)
    assert FZG.sliding_speed(g, 100.0) == pytest.approx(100.0 * (rho_1 - rho_2 * 16 / 24))
    assert FZG.sliding_speed(0.0, 100.0) == 0.0


def test_sliding_of_an_internal_pair() -> None:
    pair = PAIRS["internal"]
    g = np.linspace(pair.path["A"], pair.path["E"], 5)
    rho_1, rho_2 = pair.curvature_radii(g)
    assert np.all(rho_2 < 0.0)
    assert pair.sliding_speed(g, 100.0) == pytest.approx(100.0 * (rho_1 + rho_2 * 20 / 60))


def nearest_point(pair: GearPair, flank: str, angle: float) -> tuple[float, np.ndarray]:
    """Distance [m] of the flanks of gear 2 from that of tooth 1, where both are in mesh, and the place on the latter in
    axes that rotate with gear 1."""
    first, rotation = pair.gear_1.flank(flank), pair.mating_angle(angle, flank)
    at_pitch_point = (0.5 * (1 + pair.side) * np.pi - rotation) * pair.gear_2.teeth / (2.0 * np.pi)
    found = []
    for number in round(at_pitch_point) + np.arange(-1, 2):
        second = pair.gear_2.flank(flank, int(number) % pair.gear_2.teeth + 1)

        def gap(u: Any, second=second) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
            moved = rotated(second.at(u), rotation) + [pair.side * pair.center_distance, 0.0]
            place = rotated(moved, -angle)
            return *first.foot(place), place

        u = np.linspace(0.0, second.length, 400)
        foot, distance, _ = gap(u)
        distance[(foot <= 0.0) | (foot >= first.length)] = np.inf
        k = int(np.clip(np.argmin(distance), 1, len(u) - 2))
        best: Any = minimize_scalar(
            lambda u, gap=gap: gap(u)[1], bounds=(u[k - 1], u[k + 1]), method="bounded", options={"xatol": 1e-10}
        )
        found.append((abs(best.fun), gap(best.x)[2]))
    return min(found, key=lambda one: one[0])


@pytest.mark.parametrize("flank, sense", [("right", 1.0), ("left", -1.0)])
@pytest.mark.parametrize("name", list(PAIRS))
def test_the_law_of_gearing(name: str, flank: str, sense: float) -> None:
    """Flanks rotated by z_1/z_2 remain in contact, at the place on the path of contact that belongs to the roll angle,
    and the torques of the normal force are as the numbers of teeth."""
    pair = PAIRS[name]
    alpha, first = pair.working_pressure_angle, pair.gear_1.flank(flank)
    line = np.array([np.sin(alpha), -sense * np.cos(alpha)])
    for part in (0.02, 0.3, 0.5, 0.8, 0.98):
        g = pair.path["A"] + part * (pair.path["E"] - pair.path["A"])
        # the tangent from the pitch point to the base circle ends at alpha: there the involute unrolls
        angle = sense * (alpha - pair.gear_1.base_angle - float(pair.roll_angle(g)))
        distance, place = nearest_point(pair, flank, angle)
        assert distance < CONTACT
        n, point = rotated(first.normal(first.foot(place)[0]), angle), rotated(place, angle)
        assert point == pytest.approx(np.array([0.5 * pair.working_diameters[0], 0.0]) + g * line, abs=1e-7)
        assert np.abs(n - line).max() < 1e-6
        levers = (point, point - [pair.side * pair.center_distance, 0.0])
        torques = [lever[0] * n[1] - lever[1] * n[0] for lever in levers]
        assert abs(torques[1] / torques[0]) == pytest.approx(pair.gear_2.teeth / pair.gear_1.teeth, rel=1e-6)


@pytest.mark.parametrize("name", list(PAIRS))
def test_sections_do_not_overlap(name: str) -> None:
    """Over a pitch no point of one section lies within the other, with the backlash at the other flank."""
    pair = PAIRS[name]
    one, two = (replace(gear, tip_rounding=0.2e-3) for gear in (pair.gear_1, pair.gear_2))
    section, other = one.section(), two.section()
    points = other.at(np.linspace(0.0, other.length, 40 * two.teeth * 10))
    normal_play = pair.backlash * np.cos(pair.working_pressure_angle)
    for angle in np.linspace(0.0, 2.0 * np.pi / one.teeth, 7):
        moved = rotated(points, pair.mating_angle(angle)) + [pair.side * pair.center_distance, 0.0]
        near = moved[np.hypot(*moved.T) < 0.5 * one.tip_diameter + 1e-4]
        distance = section.foot(rotated(near, -angle))[1]
        assert -1e-9 + min(normal_play, 0.0) < distance.min() < 1e-7
        # reversed onto the left flanks
        moved = rotated(points, pair.mating_angle(angle, "left")) + [pair.side * pair.center_distance, 0.0]
        distance = section.foot(rotated(moved[np.hypot(*moved.T) < 0.5 * one.tip_diameter + 1e-4], -angle))[1]
        assert -1e-9 + min(normal_play, 0.0) < distance.min() < 1e-7


@pytest.mark.parametrize("flank, sense", [("right", 1.0), ("left", -1.0)])
@pytest.mark.parametrize("name", ["helical", "helical internal"])
def test_lines_of_contact(name: str, flank: str, sense: float) -> None:
    """The line at beta_b to the axis in the plane of action lies on both flanks, with opposite normals, the same all
    along: the force of a pressure is in the plane, torques are as the teeth, and the axial force is that of beta on the
    pitch circle."""
    pair, width = PAIRS[name], 6e-3
    one, two = (gear.surfaces((flank,), (1,))[f"flank_{flank}_1"] for gear in (pair.gear_1, pair.gear_2))
    alpha, beta_b = pair.working_pressure_angle, pair.gear_1.base_helix_angle
    line, (rho, _) = np.array([np.sin(alpha), -sense * np.cos(alpha)]), pair.pitch_rho
    angle = sense * (alpha - pair.gear_1.base_angle - float(pair.roll_angle(0.0)))
    z = np.linspace(-width, width, 9)
    g = -sense * np.tan(beta_b) * z
    assert np.ptp(g) < pair.path["E"] - pair.path["A"] and np.all(rho + g > 0.0)
    section = np.array([0.5 * pair.working_diameters[0], 0.0]) + g[:, None] * line

    def user(points: np.ndarray, angle: float, pair_center: float = 0.0) -> np.ndarray:
        x, y = rotated(points - [pair_center, 0.0], -angle).T
        return np.stack([x, z, -y], axis=1)

    turned = pair.mating_angle(angle, flank)
    center = pair.side * pair.center_distance
    teeth = pair.gear_2.teeth
    on = {}
    for number, at in (
        ("one", user(section, angle)),
        *((str(k), user(section, turned + 2.0 * np.pi * k / teeth, center)) for k in range(teeth)),
    ):
        shape = one if number == "one" else two
        theta, _, distance = shape.chart(at)
        if np.abs(distance).max() < CONTACT:
            on[number] = shape.normal(theta, z)
    assert set(on) > {"one"} and len(on) == 2
    first = on.pop("one")
    (number, second) = on.popitem()
    x, y = rotated(first[:, [0, 2]] * [1.0, -1.0], angle).T
    n = np.stack([x, y, first[:, 1]], axis=1)
    known = np.array([*(np.cos(beta_b) * line), sense * np.sin(beta_b)])
    assert n == pytest.approx(np.tile(known, (9, 1)), abs=2e-6)
    x, y = rotated(second[:, [0, 2]] * [1.0, -1.0], turned + 2.0 * np.pi * int(number) / teeth).T
    assert np.stack([x, y, second[:, 1]], axis=1) == pytest.approx(-n, abs=2e-6)
    levers = section, section - [center, 0.0]
    torques = [lever[:, 0] * n[:, 1] - lever[:, 1] * n[:, 0] for lever in levers]
    assert np.abs(torques[1] / torques[0]) == pytest.approx(np.full(9, teeth / pair.gear_1.teeth), rel=1e-6)
    tangential = torques[0] / (0.5 * pair.working_diameters[0])
    lead = 2.0 * np.pi / pair.gear_1.twist
    assert -n[:, 2] / tangential == pytest.approx(np.full(9, np.pi * pair.working_diameters[0] / lead), rel=2e-6)


def test_ratios_and_pressure_of_helical_gears() -> None:
    """The overlap ratio is b sin beta/(pi m_n); Hertz's pressure that of cylinders with the radii of the normal
    section, found from the flanks, under the force on a line b/cos beta_b long."""
    width, torque = 30e-3, 250.0
    assert HELICAL.overlap_ratio(width) == pytest.approx(width * np.sin(BETA) / (np.pi * M))
    assert FZG.overlap_ratio(width) == 0.0
    bend = 0.0
    for gear, rho in zip((HELICAL.gear_1, HELICAL.gear_2), HELICAL.curvature_radii(0.0), strict=True):
        shape = gear.surfaces(("right",), (1,))["flank_right_1"]
        at = shape.curve.at(np.linspace(0.0, shape.curve.length, 20001))
        u = shape.curve.length * np.argmin(np.abs(np.hypot(*at.T) - np.hypot(gear.base_radius, rho))) / 20000
        around, along = shape.curvatures(u, 3e-3)
        assert abs(along) < 1e-6 * around
        bend += float(around)
    beta_b = HELICAL.gear_1.base_helix_angle
    line = torque / (HELICAL.gear_1.base_radius * np.cos(beta_b)) / (width / np.cos(beta_b))
    modulus = 206e9 / (1.0 - 0.3**2) / 2.0
    assert HELICAL.hertz(torque, width)[0] == pytest.approx(np.sqrt(line * modulus * bend / np.pi), rel=1e-4)


WRONG = [
    ((HELICAL.gear_1, replace(HELICAL.gear_2, helix_angle=BETA)), A,
     "helix angles of 17 and 17 degrees do not mesh, two external gears need opposite hands; make .* -17 degrees"),
    ((HELICAL.gear_1, replace(RING, helix_angle=-BETA)), A, "an internal pair needs one hand; make .* 17 degrees"),
    ((HELICAL.gear_1, WHEEL), A, "helix angles of 17 and 0 degrees do not mesh"),
    ((RING, PINION), A, "gear_1 is internal; exchange gear_1 and gear_2"),
    ((RING, RING), A, "gear_1 is internal; one gear must be external"),
    ((replace(SMALL, teeth=70, tip_diameter=None), RING), A, "needs more teeth than its pinion, got 60 and 70"),
    ((PINION, Gear(5e-3, 24)), A, "the base pitches .* differ; use one module"),
    ((PINION, WHEEL), 80e-3, "it must be larger than 0.0845723 m"),
    ((PINION, WHEEL), 91e-3, "the backlash is .* the teeth jam; give thickness_allowance below"),
    ((replace(PINION, tip_diameter=86e-3), WHEEL), A, "the tip circle of gear_1 cuts into the root circle of gear_2"),
    ((Gear(M, 20), Gear(M, 60, addendum=1.2)), 180.1e-3, "the tips of gear_2 reach .* beyond the involute of gear_1"),
    ((PINION, WHEEL), 95e-3, "the contact ratio is 0.* below 1; make center_distance smaller"),
    ((SMALL, replace(RING, tip_diameter=262.5e-3)), 90e-3, "the tips of gear_2 reach .* beyond the involute of gear_1"),
    (("pinion", WHEEL), A, "gear_1 must be a gears.Gear, got 'pinion'"),
]  # fmt: skip


@pytest.mark.parametrize("gears, distance, message", WRONG, ids=[text[:30] for _, _, text in WRONG])
def test_pairs_that_do_not_mesh_are_refused(gears: tuple[Any, Any], distance: float, message: str) -> None:
    with pytest.raises(InputError, match=message):
        GearPair(*gears, distance)


def test_tips_of_an_internal_pair_that_meet_are_refused() -> None:
    """52 and 60 teeth pass each other, as their sections show; of 53 the sections overlap by 7 um far from the path of
    contact."""
    with pytest.raises(InputError, match="the tips of 53 and 60 teeth interfere; take fewer teeth on gear_1"):
        GearPair(Gear(M, 53, thickness_allowance=PLAY), STUB, 3.5 * M - 5e-6)
