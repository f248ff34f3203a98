"""The wrench of the recorded pressure against brute-force quadrature, also on a crowned, tilted, off-centre surface."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from rubbing_run import make_rubbing_history
from shape_runs import contact_of, grid_of, still
from synthetic_run import COLUMNS, ROWS, R, make_history

from references.pressure_wrench import pressure_wrench, traction_wrench
from warpffrf.model.reduced.body import ReducedBody
from warpffrf.model.surfaces import Bore, Cone, CrownedCylinder, Cylinder, Plane
from warpffrf.output.geometry.places import rotate, spread
from warpffrf.output.result import Result

FINE = (
    24  # midpoint intervals to a node's support in each direction: relative error about (1/24)^2 / 12 of the curvature
)


def test_force_of_hertz_on_the_lower_roller(result: Result) -> None:
    force, torque = pressure_wrench(result, "lower-upper")
    # the recorded force is the flat sum; on the round surface the pressure at the edge pushes a little sideways
    assert force == pytest.approx(result.contact("lower-upper").force, rel=4e-3, abs=1e-4 * float(np.abs(force).max()))
    # about the axle (the user origin lies on it): nothing, to round-off
    assert np.abs(torque @ [0.0, 1.0, 0.0]).max() < 1e-12 * np.abs(force).max() * 0.05


def test_crowned_tilted_surface_against_quadrature(body: ReducedBody) -> None:
    axis = np.array([0.2, 0.9, -0.3]) / np.linalg.norm([0.2, 0.9, -0.3])
    shape = CrownedCylinder(radius=0.05, axis_point=(0.01, -0.02, 0.03), axis_direction=axis, crown_radius=0.2)
    rim = body.contact_surfaces["rim"]
    grid = replace(rim.grid, e_0=shape.radial(0.4), theta_start=0.1)
    odd = replace(body, contact_surfaces={"rim": replace(rim, shape=shape, grid=grid)})
    result = Result(make_history(odd))
    i = 3
    force, torque = pressure_wrench(result, "lower-upper")
    history = result.history.contacts["lower-upper"]
    whole = spread(odd.contact_surfaces["rim"], history.first_column[i], history.pressure[i])
    j = (np.arange(COLUMNS * FINE) + 0.5) / FINE
    k = (np.arange((ROWS - 1) * FINE) + 0.5) / FINE
    low_j, low_k = np.floor(j).astype(int), np.floor(k).astype(int)
    s, t = (j - low_j)[:, None], (k - low_k)[None, :]
    at = [whole[np.ix_((low_j + a) % COLUMNS, low_k + b)] for a in (0, 1) for b in (0, 1)]
    p = (1 - s) * (1 - t) * at[0] + (1 - s) * t * at[1] + s * (1 - t) * at[2] + s * t * at[3]
    z = np.interp(k, np.arange(ROWS), grid.z)
    theta = grid.theta_start + 0.4 + grid.pitch * j
    x, n = shape.point(theta[:, None], z[None, :]), shape.normal(theta[:, None], z[None, :])
    measure = shape.radius_at(z) * np.sqrt(1.0 + shape.slope_at(z) ** 2) * grid.pitch / FINE * (z[1] - z[0])
    traction = -n * (p * measure)[..., None]
    q = result.body("lower").rotation[i]
    expected_force = rotate(q, traction.sum(axis=(0, 1))[None])[0]
    expected_torque = rotate(q, np.cross(x, traction).sum(axis=(0, 1))[None])[0]
    assert force[i] == pytest.approx(expected_force, rel=1e-4, abs=1e-4 * float(np.linalg.norm(expected_force)))
    assert torque[i] == pytest.approx(expected_torque, rel=1e-4, abs=1e-4 * float(np.linalg.norm(expected_torque)))


SHAPES = {
    "bore": Bore(radius=0.04, axis_point=(0.01, 0.0, 0.0), axis_direction=(0, 1, 0)),
    "cone": Cone(radius=0.04, half_angle=0.3, axis_point=(0.0, 0.01, 0.0), axis_direction=(0, 1, 0)),
    "plane": Plane(origin=(0.01, 0.02, 0.03), outward=(0.0, 0.6, 0.8)),
}


@pytest.mark.parametrize("kind", SHAPES)
def test_other_shapes_against_quadrature(kind: str) -> None:
    """The pressure of nodes over the chart, summed over small squares of the surface: -int p n dA, -int p x x n dA."""
    shape: Any = SHAPES[kind]
    metric = 1.0 if kind == "plane" else 0.04
    grid = grid_of(shape, 1e-3 / metric, 12, np.linspace(-4e-3, 5e-3, 4), middle=0.0)
    values = np.zeros((12, 4))
    values[1:-1] = np.random.default_rng(7).random((10, 4))
    rotation = np.array([0.0, np.sin(0.2), 0.0, np.cos(0.2)])
    contact = contact_of(shape, grid, shape, lambda t, z: values, bodies={"a": still((1.0, 2.0, 3.0), rotation)})
    result = SimpleNamespace(contact=lambda name: contact, history=SimpleNamespace(bodies=contact.bodies))
    force, torque = pressure_wrench(result, "a-b")
    j, k = (np.arange(11 * FINE) + 0.5) / FINE, (np.arange(3 * FINE) + 0.5) / FINE
    z, theta = np.interp(k, np.arange(4), grid.z), grid.theta_start + grid.pitch * j
    along = np.stack([np.interp(k, np.arange(4), v) for v in values])
    p = np.stack([np.interp(j, np.arange(12), v) for v in along.T], axis=1)
    x, n = shape.point(theta[:, None], z[None, :]), shape.normal(theta[:, None], z[None, :])
    measure = shape.radius_at(z) * np.sqrt(1.0 + shape.slope_at(z) ** 2) * grid.pitch * np.diff(grid.z)[0] / FINE**2
    traction = -n * (p * measure)[..., None]
    expected = traction.sum(axis=(0, 1)), np.cross(x, traction).sum(axis=(0, 1))
    for found, value in zip((force[0], torque[0]), expected, strict=True):
        turned = rotate(rotation, value[None])[0]
        assert found == pytest.approx(turned, abs=1e-4 * float(np.linalg.norm(turned)))


def test_tractions_drive_the_lower_roller(body: ReducedBody) -> None:
    result = Result(make_rubbing_history(body))
    force, torque = traction_wrench(result, "lower-upper")
    friction = result.contact("lower-upper").friction
    # e_theta is +x at the top of the lower roller, and turns by x/R towards the ends of the patch
    assert force[:, 0] == pytest.approx(friction.tangential_force[:, 0], rel=0.01)
    assert np.all(force[:, 0] > 0.0) and np.abs(force[:, 1]).max() < 1e-9 * force[:, 0].max()
    # about the axle it is the sum of the tractions times R, exactly; +x at +z turns about +y
    assert torque[:, 1] == pytest.approx(R * friction.tangential_force[:, 0], rel=1e-12)


def test_tractions_along_the_axis_push_along_it(body: ReducedBody) -> None:
    history = make_rubbing_history(body)
    friction = history.contacts["lower-upper"].friction
    assert friction is not None
    friction.traction = friction.traction[:, ::-1].copy()
    result = Result(history)
    force, torque = traction_wrench(result, "lower-upper")
    sums = result.contact("lower-upper").friction.tangential_force[:, 1]
    assert force[:, 1] == pytest.approx(sums, rel=1e-12) and np.abs(force[:, [0, 2]]).max() < 1e-9 * sums.max()
    assert np.abs(torque[:, 1]).max() < 1e-12 * R * sums.max()
    assert isinstance(result.contact("lower-upper").view.first.shape, Cylinder)
