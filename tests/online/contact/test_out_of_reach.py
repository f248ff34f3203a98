"""Extruded surfaces that are out of reach of each other: their recorded gap, and that they are found when they meet."""

from __future__ import annotations

import numpy as np
import pytest

import warpffrf as wf
from scenes.gears import FZG, STEEL, WIDTH, on_shafts
from warpffrf.model.rotation import rotation_vector_matrix
from warpffrf.model.surfaces import Curve, Extruded

FLANK, OTHER = (gear.surfaces(("right",))["flank_right_1"] for gear in (FZG.gear_1, FZG.gear_2))
PLACES = 40
TILT = 0.05  # rad
ALONG, ACROSS = 3001, 15  # points of the brute force, 4 um apart along the curve
OFF = 2e-7  # m: of the distance to the nearest of them, at a curvature of 1/(0.1 mm), the rounded tip
ARC, HALF, FALL, SPEED, STEP = 0.02, 0.8, 4e-3, 1.0, 1e-4  # m, rad, m, m/s, s
KEPT = 1e-3  # of the speed: the impact takes about a step


def half_space(shape: Extruded) -> wf.ReducedBody:
    return wf.half_space_body(1.0, (1e-3,) * 3, STEEL, contact={"face": shape}, extent=(-0.5 * WIDTH, 0.5 * WIDTH))


@pytest.mark.parametrize("away", [0.03, 0.3])
def test_the_gap_of_two_flanks_in_any_pose(away: float) -> None:
    """Minus the recorded approach is the smallest distance, at most the length of the curve, 12 mm."""
    random, scene, made = np.random.default_rng(3), wf.Scene(gravity=(0, 0, 0)), half_space(FLANK)
    still, curve, expected = scene.add_body(half_space(OTHER), name="still"), FLANK.curve, []
    place, its = (np.mean(flank.curve.points, axis=0) for flank in (FLANK, OTHER))  # e_0 is x, e_1 is -z
    u, z = np.linspace(0.0, curve.length, ALONG), np.linspace(-0.5 * WIDTH, 0.5 * WIDTH, ACROSS)
    points = np.stack(np.broadcast_arrays(curve.at(u)[:, None, 0], z, -curve.at(u)[:, None, 1]), axis=-1)
    meeting = on_shafts(FZG, 0.0, 1.0).contacts[0].meeting
    while len(expected) < PLACES:
        turn = rotation_vector_matrix(np.array([0.0, random.uniform(-np.pi, np.pi), 0.0]))
        A = turn @ rotation_vector_matrix(random.uniform(-TILT, TILT, 3))
        r = random.uniform(-away, away, 3) * (1.0, 0.1, 1.0)
        r += (its[0], 0.0, -its[1]) - A @ (place[0], 0.0, -place[1])
        seen = points @ A.T + r
        gap = float(OTHER.curve.gap(seen[..., [0, 2]] * (1.0, -1.0)).min())
        if gap > 1e-4:
            name = f"pair {len(expected)}"
            body = scene.add_body(made, name=f"body {len(expected)}", position=r, rotation=A)
            contact = scene.add(wf.Contact(body["face"], still["face"], cells=(5, 5), name=name))
            contact.meeting = meeting
            expected.append(min(gap, curve.length))
    result = wf.simulate(scene, 1e-7, step=1e-7, progress=False)
    found = [-result.contact(f"pair {i}").approach[0] for i in range(PLACES)]
    assert (np.ptp(expected) > 0.5 * curve.length) == (away < 0.1), "both near and far ones, or far ones only"
    np.testing.assert_allclose(found, expected, rtol=0.0, atol=OFF)


def test_two_arcs_meet_and_part() -> None:
    """One falls on the other from out of reach, and leaves as fast as it came."""
    low = (-ARC * np.sin(HALF), ARC * (1.0 - np.cos(HALF)))
    arc = Curve.arcs(low, -HALF, [(2.0 * HALF * ARC, ARC)])
    made = half_space(Extruded(curve=arc, axis_direction=(0, 1, 0), x_direction=(1, 0, 0)))
    scene, over = wf.Scene(gravity=(0, 0, 0)), {"axis": (0, 1, 0), "angle": np.pi}
    still = scene.add_body(made, name="still")
    falls = scene.add_body(made, name="falls", position=(0, 0, FALL), rotation=over, velocity=(0, 0, -SPEED))
    scene.add(wf.joints.Fixed(scene.ground, still["center"]))
    scene.add(wf.joints.Prismatic(scene.ground, falls["center"], axis=(0, 0, 1)))
    scene.add(wf.Contact(falls["face"], still["face"], cells=(9, 5), name="pair"))
    result = wf.simulate(scene, 2.0 * FALL / SPEED, step=STEP, progress=False)
    speed = result.body("falls").velocity[:, 2]
    met = result.contact("pair").touching
    assert met.any() and not met[0] and not met[-1]
    assert abs(speed[-1] - SPEED) < KEPT * SPEED
