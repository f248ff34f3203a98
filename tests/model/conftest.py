"""A reduced body that needs no reduction: rigid interface, round rim, made-up modes. Only for tests of descriptions."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from warpffrf.model import surfaces
from warpffrf.model.reduced.body import ReducedBody
from warpffrf.model.reduced.contact_grid import SurfaceGrid
from warpffrf.model.reduced.contact_surface import ContactSurface, Recovery
from warpffrf.model.reduced.data import DisplaySurface, Interface


def make_body(
    radius: float = 0.05,
    width: float = 0.02,
    *,
    crown_radius: float | None = None,
    modes: int = 0,
    columns: int = 12,
    rows: int = 3,
    axis: tuple[float, float, float] = (0.0, 1.0, 0.0),
) -> ReducedBody:
    rng = np.random.default_rng(7)
    given = {"radius": radius, "axis_point": (0, 0, 0), "axis_direction": axis}
    shape = surfaces.Cylinder(**given)
    if crown_radius is not None:
        shape = surfaces.CrownedCylinder(**given, crown_radius=crown_radius)
    z = np.linspace(-0.5 * width, 0.5 * width, rows)
    grid = SurfaceGrid(shape.e_0, 0.0, 2 * np.pi / columns, columns, True, z, 1)
    lags = np.zeros((columns, rows, rows))
    lags[0] = 1e-9 * np.eye(rows)
    recovery = Recovery(np.zeros((columns // 2 + 1, 3, rows), dtype=np.complex64), columns, np.eye(3))
    surface = ContactSurface("rim", shape, grid, lags, np.zeros((columns * rows, modes)), recovery)
    return ReducedBody(
        mass=1.2,
        center_of_mass=np.zeros(3),
        inertia=np.diag([1e-3, 1.5e-3, 1e-3]),
        frequencies=np.linspace(1000.0, 9000.0, modes),
        interfaces={"bore": Interface("rigid", np.array([0.0, 0.001, 0.0]), rng.normal(size=(modes, 6)))},
        contact_surfaces={"rim": surface},
        surface=DisplaySurface(np.zeros((3, 3)), np.array([[0, 1, 2]]), np.zeros((modes, 3, 3))),
    )


@pytest.fixture
def body_maker() -> Callable[..., ReducedBody]:
    return make_body
