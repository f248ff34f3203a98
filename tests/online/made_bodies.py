"""Flexible bodies that are made up, with any contact surface: a compliance that decays with distance, random modes.

Nothing is solved for them: they are small, and as general as the engine allows (a dense compliance that is not
circulant, modes without symmetry, a centre of mass off the axis).
"""

from __future__ import annotations

from typing import Any

import numpy as np

from warpffrf.model.reduced.body import ReducedBody
from warpffrf.model.reduced.contact_grid import SurfaceGrid
from warpffrf.model.reduced.contact_surface import ContactSurface, Recovery
from warpffrf.model.reduced.data import DisplaySurface, Interface

SOFTNESS = 2e-10  # m/N of a node on itself: about steel under a node of a few millimetres
DECAY = 6e-3  # m
MODES = 3


def grid_points(shape: Any, grid: SurfaceGrid) -> np.ndarray:
    """Nodes (columns, rows, 3) [m, user frame] of the grid on the true surface."""
    theta, z = np.meshgrid(grid.theta, grid.z, indexing="ij")
    if shape.profile().planar:
        return shape.axis_point + theta[..., None] * shape.e_1 + z[..., None] * shape.e_a
    e_1 = np.cross(shape.e_a, grid.e_0)
    radial = np.cos(theta)[..., None] * grid.e_0 + np.sin(theta)[..., None] * e_1
    return shape.axis_point + z[..., None] * shape.e_a + shape.radius_at(z)[..., None] * radial


def made_body(shape: Any, z: Any, *, pitch: float, columns: int, periodic: bool = False, seed: int = 1) -> ReducedBody:
    """A body with the contact surface "face" of `shape` (resolved), its grid centred on theta = 0 or all around.

    z (rows,) [m], pitch [rad, of a plane m]; a periodic grid has the pitch that its columns ask for.
    """
    rng = np.random.default_rng(seed)
    pitch = 2.0 * np.pi / columns if periodic else pitch
    start = 0.3 * pitch if periodic else -0.5 * (columns - 1) * pitch
    grid = SurfaceGrid(np.asarray(shape.e_0), start, pitch, columns, periodic, np.asarray(z, float), columns)
    nodes = grid_points(shape, grid).reshape(-1, 3)
    distance = np.linalg.norm(nodes[:, None] - nodes[None], axis=-1)
    lags = SOFTNESS * np.exp(-distance / DECAY)[None]
    m = len(nodes)
    mode_normal = 0.05 * rng.normal(size=(m, MODES))
    recovery = Recovery(np.zeros((1, 9, m), np.float32), 1, np.eye(3))
    surface = ContactSurface("face", shape, grid, lags, mode_normal, recovery)
    skin = DisplaySurface(nodes[:3], np.array([[0, 1, 2]]), np.zeros((MODES, 3, 3)))
    hold = Interface("rigid", np.array([0.001, -0.002, 0.003]), np.zeros((MODES, 6)))
    center = np.array([0.002, 0.001, -0.0015])
    return ReducedBody(
        2.0, center, np.diag([3e-3, 4e-3, 5e-3]), np.array([8e3, 9e3, 11e3]), {"hold": hold}, {"face": surface}, skin
    )
