"""Thrust bearings in one call: fixed tapers compared with finite differences in polar coordinates, and tilting pads
about their pivots."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import scipy.sparse as sp
from scipy.sparse.linalg import spsolve

import warpffrf as wf
from warpffrf.model.errors import InputError

LOW, HIGH, ARC, COUNT = 0.04, 0.08, np.radians(50.0), 6  # m, m, rad
SPEED, VISCOSITY, GAP, TAPER = 300.0, 0.02, 20e-6, 25e-6  # rad/s, Pa s, m, m
SAME = 0.01  # of the load and its place: 24 x 13 nodes
SOFTLY = 5e-3  # of the smallest gap: pivots with a thousandth of the stiffness of a film
BALANCED = 1e-4  # of the mean radius

Array = np.ndarray


def bearing(gap: float = GAP, load: float | None = None, sense: int = 1, **given: Any) -> wf.Result:
    """The equilibrium of a collar, held at a gap or pressed down by a load [N]."""
    scene, y = wf.Scene(), (0, 1, 0)
    collar = wf.surfaces.Plane(origin=(0, 0, 0), outward=(0, -1, 0))
    shaft = scene.add_rigid_body(
        5.0, (0.1,) * 3, name="shaft", position=(0, gap, 0), angular_velocity=(0, sense * SPEED, 0),
        surfaces={"collar": collar},
    )  # fmt: skip
    pads = wf.films.pads(COUNT, ARC, offset=given.pop("offset", 0.5))
    scene.add_thrust_bearing(
        "t", shaft["collar"], pads, inner_radius=LOW, outer_radius=HIGH, oil=wf.oils.Newtonian(VISCOSITY), sense=sense,
        **given,
    )  # fmt: skip
    if load is None:
        spin = scene.add(wf.joints.Revolute(scene.ground, shaft, axis=y, name="spin"))
        scene.add(wf.joints.Drive(spin, sense * SPEED, quantity="velocity"))
    else:
        spin = scene.add(wf.joints.Cylindrical(scene.ground, shaft, axis=y, name="spin"))
        scene.add(wf.joints.Drive(spin, sense * SPEED, coordinate="rotation", quantity="velocity"))
        scene.add(wf.forces.PointForce(shaft, (0.0, -load, 0.0)))
    found = wf.equilibrium(scene, progress=False)
    assert found.status == "completed", found.message
    return found


def polar(gap: Any, columns: int, rows: int) -> tuple[float, float]:
    """Load [N] of a pad with the gap [m] at angles from its leading edge, and the angle [rad] of its centre: finite
    differences of d/dr(r h^3 p_r) + d/dt(h^3 p_t)/r = 6 mu w r h_t."""
    t, r = np.linspace(0.0, ARC, columns), np.linspace(LOW, HIGH, rows)
    dt, dr = t[1], r[1] - r[0]
    A, b = sp.lil_matrix((columns * rows,) * 2), np.zeros(columns * rows)
    for i in range(columns):
        for j in range(rows):
            k = i * rows + j
            A[k, k] = 1.0
            if 0 < i < columns - 1 and 0 < j < rows - 1:
                faces = {}
                for s in (1, -1):
                    faces[s * rows] = gap(t[i] + 0.5 * s * dt) ** 3 / (r[j] * dt**2)
                    faces[s] = gap(t[i]) ** 3 * (r[j] + 0.5 * s * dr) / dr**2
                    b[k] += s * 6.0 * VISCOSITY * SPEED * r[j] * gap(t[i] + 0.5 * s * dt) / dt
                A[k, k] = -sum(faces.values())
                for off, value in faces.items():
                    A[k, k + off] = value
    loads = spsolve(A.tocsr(), b).reshape(columns, rows) * r * dt * dr
    return float(loads.sum()), float((loads.sum(axis=1) @ t) / loads.sum())


@pytest.mark.parametrize(("land", "sense"), [(0.0, 1), (0.25, -1)])
def test_a_fixed_taper_carries_as_finite_differences_in_polar_coordinates(land: float, sense: int) -> None:
    def gap(angle: float) -> float:
        return GAP + TAPER * max(0.0, 1.0 - angle / ((1.0 - land) * ARC))

    coarse, (fine, place) = polar(gap, 25, 13)[0], polar(gap, 49, 25)
    exact = fine + (fine - coarse) / 3.0
    found = bearing(sense=sense, taper=TAPER, land=land)
    for i in range(COUNT):
        film, middle = found.film(f"t pad {i + 1}"), i * 2.0 * np.pi / COUNT
        np.testing.assert_allclose(film.force[-1, 1], -exact, rtol=SAME)
        x, _, z = np.cross([0.0, 1.0, 0.0], film.torque[-1]) / film.force[-1, 1]  # of the force, from the origin
        behind = np.arctan2(-z, x) - middle
        behind = np.remainder(behind + np.pi, 2.0 * np.pi) - np.pi
        assert sense * behind + 0.5 * ARC == pytest.approx(place, abs=SAME * ARC)


@pytest.mark.parametrize("pivot", ["line", "point"])
def test_tilting_pads_share_the_load_and_are_balanced_about_their_pivots(pivot: str) -> None:
    load, offset = 12e3, 0.6
    given: dict[str, Any] = {"tilting": wf.films.TiltingPads(0.012, pivot=pivot, tilt_stiffness=0.0), "offset": offset}
    found = bearing(40e-6, load, **given)
    for i, joint in enumerate(found.scene.joints[:COUNT], start=1):
        film = found.film(f"t pad {i}")
        F, M = film.force[-1], film.torque[-1]
        assert F[1] == pytest.approx(-load / COUNT, rel=1e-3)
        about = M - np.cross(joint.b.world_point() - found.body(f"t pad {i}").position[-1], F)
        angle = (i - 1) * 2.0 * np.pi / COUNT + (offset - 0.5) * ARC
        radial, around = np.array([np.cos(angle), 0, -np.sin(angle)]), np.array([-np.sin(angle), 0, -np.cos(angle)])
        assert abs(about @ radial) < BALANCED * 0.06 * load / COUNT
        assert pivot == "line" or abs(about @ around) < BALANCED * 0.06 * load / COUNT
        gap = film.gap[-1]
        assert gap[-1].mean() > 1.5 * gap[0].mean()  # angles of the chart run against those of the bearing


def test_soft_pivots_by_default_change_the_load_little() -> None:
    gaps = []
    for k in (None, 0.0):
        given: dict[str, Any] = {"tilting": wf.films.TiltingPads(0.012, tilt_stiffness=k), "offset": 0.6}
        gaps.append(bearing(40e-6, 12e3, **given).film("t pad 1").smallest_gap[-1])
    assert gaps[0] == pytest.approx(gaps[1], rel=SOFTLY)


def test_what_is_no_thrust_bearing_is_refused() -> None:
    with pytest.raises(InputError, match="inner_radius must be below outer_radius, and land below 1"):
        bearing(land=1.0)
    with pytest.raises(InputError, match=r"films.TiltingPads\(...\) without a taper"):
        bearing(taper=1e-5, tilting=wf.films.TiltingPads(0.01))
    with pytest.raises(InputError, match="runner must be a plane of the shaft"):
        scene = wf.Scene()
        ground: Any = scene.ground
        scene.add_thrust_bearing(
            "t", ground, wf.films.pads(3, 1.0), inner_radius=0.1, outer_radius=0.2, oil=wf.oils.Newtonian(0.1)
        )
