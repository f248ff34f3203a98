"""The wrench of the recorded pressure against brute-force quadrature, also on a crowned, tilted, off-centre surface."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from synthetic_run import COLUMNS, ROWS, make_history

from warpffrf.model.reduced_body import ReducedBody
from warpffrf.model.surfaces import CrownedCylinder
from warpffrf.output.pressure_wrench import pressure_wrench
from warpffrf.output.result import Result
from warpffrf.output.skin import rotate, spread

FINE = (
    24  # midpoint intervals to a hat's support in each direction: relative error about (1/24)^2 / 12 of the curvature
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
