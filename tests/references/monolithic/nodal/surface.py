"""The two surfaces of a pair with the law at nodes: FE nodes of the first, true shape and contact grid of the second.

Positions are about the centres of mass, in body axes. Displacements of both surfaces are given on their grids, along
normal and tangents (`warpffrf.model.reduced.contact_surface`), by global modes and local coordinates, and are
interpolated at a node or at the opposite point.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from references.monolithic.core.local_coordinates import LocalCoordinates
from references.monolithic.line_of_centres.sampling import ON_SURFACE, _node_values, _shares
from warpffrf.model.errors import InputError
from warpffrf.model.placement.gap import theta_offset

AT_END = 1e-6  # of a grid spacing: nodes on the outermost lines of a grid lie on it despite round-off


@dataclass(frozen=True, eq=False)
class NodeSide:
    """The nodes of a first surface: centre of mass (3,) in the body's user frame, positions (n, 3) [m], normals and
    tangents e_theta, t_z (n, 3), shares (n,) [m2] of the area, grid columns x (n,), values `grid_nodes` (n, nodes)
    there, and displacements (3, n, columns of A) along normal and tangents per coordinate, the last two zero without
    friction. `turn`: columns of a full revolution, 0 on an arc."""

    body: int
    center: np.ndarray
    grid: Any
    shape: Any
    place: np.ndarray
    normal: np.ndarray
    tangent: np.ndarray  # (2, n, 3)
    share: np.ndarray
    x: np.ndarray
    z: np.ndarray
    grid_nodes: Any
    field: np.ndarray
    turn: float

    @property
    def axis_point(self) -> np.ndarray:
        """The origin of the shape's axis (3,) [m] about the centre of mass."""
        return self.shape.axis_point - self.center


@dataclass(frozen=True, eq=False)
class PartnerSide:
    """A second surface: body (-1 the ground), centre of mass (3,) in its user frame, shape, grid (None if rigid),
    angle of the grid's theta = 0 in the shape's chart, and displacements (3, nodes, columns of B)."""

    body: int
    center: np.ndarray
    shape: Any
    grid: Any
    offset: float
    field: np.ndarray

    @property
    def rigid(self) -> bool:
        return self.grid is None


def node_side(port: Any, local: LocalCoordinates, friction: bool, label: str) -> NodeSide:
    """Nodes of the body's skin on the surface of `port`. Raises `InputError` naming `label` if there are none."""
    surface, skin = port.surface, port.body.reduced.surface
    grid, shape = surface.grid, surface.shape
    planar = shape.profile().planar
    theta, z, distance = shape.chart(skin.points)
    width = float(grid.z[-1] - grid.z[0])
    size = shape.size or max(width, float(grid.pitch * grid.columns))
    on = np.abs(distance) < ON_SURFACE * size
    steps = np.diff(grid.z)
    on &= (z > grid.z[0] - AT_END * steps[0]) & (z < grid.z[-1] + AT_END * steps[-1])
    x = (theta - (0.0 if planar else theta_offset(surface)) - grid.theta_start) / grid.pitch
    full = 0.0 if planar else 2.0 * np.pi / grid.pitch
    if full:
        x = x - full * np.floor((x - 0.5 * (grid.columns - 1)) / full + 0.5)
    if not grid.periodic:
        on &= (x > -AT_END) & (x < grid.columns - 1 + AT_END)
    if not np.any(on):
        raise InputError(
            f"{label}: at_nodes has the law at the nodes of {port.label}, and none of the body's skin lies on "
            "it; reduce the body again, or use at_nodes=False"
        )
    if not grid.periodic:
        x = np.clip(x, 0.0, grid.columns - 1)
    share = _shares(skin, on)[on]
    x, z, theta = x[on], np.clip(z[on], grid.z[0], grid.z[-1]), theta[on]
    grid_nodes = _node_values(grid, x, z)
    field = np.stack([grid_nodes @ f for f in _fields(surface, local, friction)])
    return NodeSide(
        port.body.index, np.asarray(port.body.center_of_mass), grid, shape,
        shape.point(theta, z) - port.body.center_of_mass, shape.normal(theta, z),
        np.stack([shape.around(theta), shape.along(theta, z)]), share, x, z, grid_nodes, field,
        full if grid.periodic else 0.0,
    )  # fmt: skip


def partner_side(port: Any, local: LocalCoordinates | None, friction: bool) -> PartnerSide:
    """The second surface of a pair."""
    surface, shape = port.surface, port.surface.shape
    center = np.zeros(3) if port.on_ground else np.asarray(port.body.center_of_mass)
    if surface.grid is None or local is None:
        return PartnerSide(port.body.index, center, shape, None, 0.0, np.zeros((3, 0, 0)))
    offset = 0.0 if shape.profile().planar else theta_offset(surface)
    field = np.stack(_fields(surface, local, friction))
    return PartnerSide(port.body.index, center, shape, surface.grid, offset, field)


def _fields(surface: Any, local: LocalCoordinates, friction: bool) -> list[np.ndarray]:
    """Displacements (nodes, coordinates) of a surface along its normal and its two tangents."""
    normal = np.hstack([surface.mode_normal, local.trace])
    if not friction:
        return [normal, np.zeros_like(normal), np.zeros_like(normal)]
    shear = surface.tangential
    return [normal, *(np.hstack([shear.mode_tangent[i], local.shear[i]]) for i in range(2))]
