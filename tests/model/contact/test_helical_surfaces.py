"""Curves extruded with a twist: distances against the least over the surface, normals and curvatures by differences."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from scipy.optimize import minimize

import warpffrf as wf
from warpffrf.model.errors import InputError
from warpffrf.model.gears import Gear
from warpffrf.model.surfaces import Curve, Extruded

GEAR = Gear(4.5e-3, 23, helix_angle=np.radians(-25.0))
SKEW: Any = {"axis_point": (0.01, -0.02, 0.005), "axis_direction": (1, 2, 0.5), "x_direction": (0, 0, 1)}
ANGLES = np.linspace(0.0, 2.0 * np.pi, 60, endpoint=False)
SURFACES = {
    "flank": Extruded(curve=GEAR.flank("left", 3), twist=GEAR.twist, **SKEW),
    "screw": Extruded(
        curve=Curve.through([[0.03 + 8e-3 * np.cos(a), 12e-3 * np.sin(a)] for a in ANGLES], closed=True), twist=25.0
    ),
}


def places(shape: Extruded) -> tuple[np.ndarray, np.ndarray]:
    """u, z (n,) [m]; on the involute of the flank."""
    rng = np.random.default_rng(2)
    u, z = rng.uniform(0.0, shape.curve.length, 400), rng.uniform(-8e-3, 8e-3, 400)
    r = np.hypot(*shape.curve.at(u).T)
    limits = 0.5 * GEAR.root_form_diameter + 2e-4, 0.5 * GEAR.tip_diameter - 2e-4
    on = (r > limits[0]) & (r < limits[1]) if not shape.curve.closed else np.full(400, True)
    return u[on], z[on]


@pytest.mark.parametrize("name", list(SURFACES))
def test_places_and_frames(name: str) -> None:
    """Tangents by differences span the plane across the normal; the chart returns points of the surface."""
    shape, h = SURFACES[name], 1e-6
    u, z = places(shape)
    n, along = shape.normal(u, z), shape.along(u, z)
    for du, dz in ((h, 0.0), (0.0, h)):
        t = (shape.point(u + du, z + dz) - shape.point(u - du, z - dz)) / (2.0 * h)
        assert np.abs(np.sum(t * n, axis=1)).max() < 1e-6
    assert np.cross(shape.around(u, z), along) == pytest.approx(n, abs=1e-12)
    theta, height, distance = shape.chart(shape.point(u, z))
    assert np.abs(distance).max() < 1e-13 and np.abs(height - z).max() < 1e-13
    assert np.abs(theta - u).max() < 1e-9
    turned = shape.twist * 2e-3  # of a section 2 mm further
    c, s = np.cos(turned), np.sin(turned)
    local = [(shape.point(u, at) - shape.axis_point) @ shape.frame.T for at in (0.0, 2e-3)]
    assert local[1] == pytest.approx(local[0] @ np.array([[c, s, 0], [-s, c, 0], [0, 0, 1]]) + [0, 0, 2e-3], abs=1e-15)


@pytest.mark.parametrize("name", list(SURFACES))
def test_curvatures(name: str) -> None:
    """The normal rotates along the surface as the tensor states; along the generators of a flank not at all."""
    shape, h = SURFACES[name], 1e-6
    u, z = places(shape)
    tensor = shape.curvature_tensor(u, z)
    for du, dz in ((h, 0.0), (0.0, h)):
        both = [(u + du, z + dz), (u - du, z - dz)]
        t, bent = ((f(*both[0]) - f(*both[1])) / (2.0 * h) for f in (shape.point, shape.normal))
        known = np.einsum("nij,nj->ni", tensor, t)
        assert bent == pytest.approx(known, abs=1e-4 * np.abs(known).max())
    around, along = shape.curvatures(u, z)
    if name == "flank":
        rho = np.sqrt(np.sum(shape.curve.at(u) ** 2, axis=1) - GEAR.base_radius**2)
        assert around == pytest.approx(np.cos(GEAR.base_helix_angle) / rho, rel=1e-3)
        assert np.abs(along).max() < 1e-4 * around.min()  # as exact as curvatures of pieces
        assert shape.measure_at(0.0) == pytest.approx(1.0 / np.cos(GEAR.base_helix_angle), rel=1e-6)
    else:
        assert np.abs(along).max() > 0.1 * around.max()


@pytest.mark.parametrize(
    "name, gap, tolerance", [("flank", 1e-3, 1e-10), ("flank", -1e-3, 1e-10), ("screw", 1e-6, 1e-9)]
)
def test_the_distance_is_the_least(name: str, gap: float, tolerance: float) -> None:
    """Over the surface; exactly from a flank, to the second order in the gap from others."""
    shape = SURFACES[name]
    for u, z in zip(*(values[:20] for values in places(shape)), strict=True):
        x = shape.point(u, z) + gap * shape.normal(u, z)
        scale = 1e-3

        def off(at: np.ndarray, x=x, u=u, z=z, scale=scale) -> float:
            return 1e6 * float(np.sum((shape.point(u + scale * at[0], z + scale * at[1]) - x) ** 2))

        best: Any = minimize(off, [0.1, 0.1], method="Nelder-Mead", options={"xatol": 1e-10, "fatol": 1e-16})
        assert np.sqrt(best.fun * 1e-6) == pytest.approx(abs(gap), abs=1e-9)
        assert float(shape.chart(x)[2]) == pytest.approx(gap, abs=tolerance)
        assert float(shape.gap(x)) == pytest.approx(gap, abs=tolerance)


def test_nodes_and_descriptions() -> None:
    """Nodes of a helical gear fit its flanks and not those of the other hand; the description returns the surface."""
    body = wf.mesh.gear(GEAR, 10e-3, rim_radius=25e-3, teeth=1, along=4, axial=2, order=1)
    facets = body.facets("flank_left_1")
    nodes, normals = body.points[facets.node_set], facets.node_normals(body.points)
    shape = GEAR.surfaces(("left",), (1,))["flank_left_1"]
    assert shape.fitted(nodes, normals).deviation < 1e-10
    other = Extruded(curve=shape.curve, twist=-shape.twist)
    with pytest.raises(InputError, match="beyond the ends of the curve"):
        other.fitted(nodes, normals)
    described = {key: value for key, value in shape.describe().items() if key != "kind"}
    assert Extruded(**described).point(1e-3, 4e-3) == pytest.approx(shape.point(1e-3, 4e-3), abs=1e-16)


def test_what_is_refused() -> None:
    shape = GEAR.surfaces(("left",), (1,))
    with pytest.raises(InputError, match="twist must be a"):
        Extruded(curve=shape["flank_left_1"].curve, twist="right")  # pyright: ignore[reportArgumentType]
    body = wf.mesh.gear(GEAR, 10e-3, rim_radius=25e-3, teeth=1, along=4, axial=2, order=1)
    with pytest.raises(
        InputError, match="helical surfaces of finite elements carry no contact; use wf.half_space_body"
    ):
        wf.reduce(body, wf.Material(2e11, 0.3, 7850.0), contact=shape, progress=False)
