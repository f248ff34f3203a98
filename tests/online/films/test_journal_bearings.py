"""Journal bearings in one call: the gaps of their pads, tilting pads about their pivots, and pads without load."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import warpffrf as wf
from warpffrf.model.errors import InputError

R, C, LENGTH = 0.05, 148e-6, 0.07  # m
VISCOSITY, SPEED, LOAD = 0.0277, 100.0 * np.pi, 10e3  # Pa s, rad/s, N
QUARTER = np.radians(75.0)
TRUE = 1.5  # the largest factor between an estimate and the difference to a much finer grid
SAME = 0.01  # of the stiffness, between differences of equilibria and the derivative

Array = np.ndarray


def journal(scene: wf.Scene, at: tuple[float, float] = (0.1, 0.0)) -> Any:
    """The surface of a shaft that begins `at` so many clearances along e_0 and e_1."""
    surface = wf.surfaces.Cylinder(radius=R, axis_point=(0, 0, 0), axis_direction=(0, 1, 0))
    shaft = scene.add_rigid_body(
        20.0, (0.1,) * 3, name="shaft", surfaces={"journal": surface}, angular_velocity=(0, SPEED, 0),
        position=(at[0] * C, 0, -at[1] * C),
    )  # fmt: skip
    return shaft["journal"]


def tilting(
    preload: float = 0.47, load: tuple[float, float] = (LOAD, 0.0), nodes: Any = None, **given: Any
) -> wf.Result:
    """The equilibrium under a load along e_0 and e_1 of four pads, the load between two pivots."""
    scene = wf.Scene()
    surface = journal(scene)
    pads = wf.films.pads(4, QUARTER, first=0.25 * np.pi, preload=preload)
    scene.add_journal_bearing(
        "b", surface, pads, clearance=C, length=LENGTH, oil=wf.oils.Newtonian(VISCOSITY), nodes=nodes,
        tilting=wf.films.TiltingPads(0.02, **given),
    )  # fmt: skip
    shaft = scene.body("shaft")
    plane = scene.add(wf.joints.Planar(scene.ground, shaft, axis=(0, 1, 0), name="plane"))
    scene.add(wf.joints.Drive(plane, SPEED, quantity="velocity"))
    scene.add(wf.forces.PointForce(shaft, (load[0], 0.0, -load[1])))
    found = wf.equilibrium(scene, progress=False)
    assert found.status == "completed", found.message
    return found


def fixed(pads: Any, at: tuple[float, float] = (0.2, 0.1), **given: Any) -> Any:
    """The film of a bearing with fixed pads."""
    scene = wf.Scene()
    bearing = scene.add_journal_bearing(
        "b", journal(scene, at), pads, clearance=C, length=LENGTH, oil=wf.oils.Newtonian(VISCOSITY), **given
    )
    return bearing.films[0]


def test_gaps_are_those_of_the_pads() -> None:
    """c - m c cos(theta - theta_p) - e.n, to the square of the eccentricity over the radius; dams in addition."""
    at, theta = (0.2, 0.1), np.radians([30.0, 70.0, 150.0, 200.0, 320.0])
    e = C * np.array(at)
    half = [wf.films.Pad(middle, 2.8, preload=0.4, offset=1.0) for middle in (0.5 * np.pi, 1.5 * np.pi)]
    middle = np.where(theta < np.pi, 0.5 * np.pi, 1.5 * np.pi)
    for pads, shift in (
        (wf.films.pads(1, 6.0, first=np.pi), np.zeros(5)),
        (wf.films.pads(2, np.radians(160.0), first=0.5 * np.pi, preload=0.5), 0.5 * np.abs(np.sin(theta))),
        (half, 0.4 * np.cos(theta - middle - 1.4)),
    ):
        film = fixed(pads, at)
        expected = C * (1.0 - shift) - np.stack([np.cos(theta), np.sin(theta)], axis=1) @ e
        np.testing.assert_allclose(film.gap_at(theta, 0.0), expected, rtol=1e-3)
    dam = wf.films.Dam(5e-5, np.radians(120.0), width=0.5)
    film = fixed([wf.films.Pad(np.pi, np.radians(160.0), dam=dam), wf.films.Pad(0.0, np.radians(160.0))], (0.0, 0.0))
    angles = np.radians([101.0, 219.0, 221.0, 300.0])
    np.testing.assert_allclose(film.gap_at(angles, 0.2 * LENGTH) - C, [5e-5, 5e-5, 0.0, 0.0], atol=1e-9)
    np.testing.assert_allclose(film.gap_at(angles, 0.3 * LENGTH) - C, 0.0, atol=1e-9)
    assert film.feeds[0].width == pytest.approx(np.radians(20.0) * (R + C), rel=1e-4)
    back = fixed([wf.films.Pad(np.pi, np.radians(160.0), dam=dam)], (0.0, 0.0), sense=-1)
    np.testing.assert_allclose(back.gap_at(angles, 0.0) - C, [0.0, 5e-5, 5e-5, 0.0], atol=1e-9)


@pytest.mark.parametrize("pivot", ["line", "point"])
def test_tilting_pads_are_balanced_about_their_pivots(pivot: str) -> None:
    found = tilting(pivot=pivot, tilt_stiffness=0.0)
    total = np.zeros(3)
    for i, joint in enumerate(found.scene.joints[:4], start=1):
        film = found.film(f"b pad {i}")
        F, M = film.force[-1], film.torque[-1]
        about = M - np.cross(joint.b.world_point() - found.body(f"b pad {i}").position[-1], F)
        assert abs(about[1]) < 1e-4 * R * np.linalg.norm(F)
        total += F
    np.testing.assert_allclose(total, (LOAD, 0.0, 0.0), atol=1e-3 * LOAD)
    gaps = [found.film(f"b pad {i}").smallest_gap[-1] for i in (1, 2, 3, 4)]
    assert max(gaps[0], gaps[3]) < 0.4 * min(gaps[1], gaps[2])


def test_stiffness_of_tilting_pads_is_that_of_equilibria_and_has_no_cross_coupling() -> None:
    found, d = tilting(), 50.0
    slow, whirling = found.bearing_coefficients("b", 0.0), found.bearing_coefficients("b")
    moved = []
    for way in d * np.eye(2):
        x = [tilting(load=(LOAD + s * way[0], s * way[1])).body("shaft").position[-1, [0, 2]] for s in (1.0, -1.0)]
        moved.append((x[0] - x[1]) * (1.0, -1.0) / (2.0 * d))
    K = np.linalg.inv(np.stack(moved, axis=1))
    np.testing.assert_allclose(slow.stiffness, K, atol=SAME * K.max())
    for each in (slow, whirling):
        assert abs(each.stiffness[0, 1] - each.stiffness[1, 0]) < SAME * each.stiffness[0, 0]
    assert whirling.critical_mass == np.inf
    assert whirling.stiffness[0, 0] < 0.9 * slow.stiffness[0, 0]  # the pads follow in part


def test_errors_of_the_grids_of_all_pads_are_true() -> None:
    """Of a shaft in the middle, whose place no grid changes, and pads that follow its whirl in part."""
    coarse, fine = (tilting(load=(0.0, 0.0), nodes=nodes).bearing_coefficients("b") for nodes in ((12, 5), (32, 13)))
    for name in ("stiffness", "damping"):
        said = getattr(coarse, f"{name}_error").max()
        true = np.abs(getattr(coarse, name) - getattr(fine, name)).max()
        print(f"{name}: said {said:.4g}, true {true:.4g}, of {getattr(fine, name).max():.4g}")
        assert true / TRUE < said < TRUE * true


@pytest.mark.parametrize("preload", [0.0, 0.2])
def test_pads_without_load_stay_off_the_shaft(preload: float) -> None:
    """The two upper pads carry nothing; the soft stiffness of the pivots keeps them from touching."""
    found = tilting(preload)
    for i in (2, 3):
        assert np.linalg.norm(found.film(f"b pad {i}").force[-1]) < 2e-3 * LOAD
        assert found.film(f"b pad {i}").smallest_gap[-1] > 0.2 * C
    stiffer = tilting(preload, tilt_stiffness=2.0 * found.scene.journal_bearings[0].tilt_stiffness)
    own, other = (each.body("shaft").position[-1, 0] for each in (found, stiffer))
    assert own == pytest.approx(other, rel=2e-3)


def test_what_is_no_bearing_is_refused() -> None:
    with pytest.raises(InputError, match="pads overlap"):
        wf.films.pads(3, 2.2)
    with pytest.raises(InputError, match="preload below 1"):
        wf.films.Pad(0.0, 1.0, preload=1.0)
    with pytest.raises(InputError, match="its dam ends at"):
        wf.films.Pad(0.0, 1.0, dam=wf.films.Dam(1e-5, 1.2))
    with pytest.raises(InputError, match="has a dam"):
        scene = wf.Scene()
        scene.add_journal_bearing(
            "b", journal(scene), [wf.films.Pad(0.0, 1.0, dam=wf.films.Dam(1e-5, 0.5))], clearance=C, length=LENGTH,
            tilting=wf.films.TiltingPads(0.02), oil=wf.oils.Newtonian(VISCOSITY),
        )  # fmt: skip
    with pytest.raises(InputError, match=r"tilting must be films.TiltingPads\(...\) or None"):
        fixed(wf.films.pads(3, 1.7), tilting=0.02)
    with pytest.raises(InputError, match="pivot"):
        tilting(pivot="ball")
    with pytest.raises(InputError, match="no journal bearing called|journal bearing"):
        tilting().bearing_coefficients("c")
