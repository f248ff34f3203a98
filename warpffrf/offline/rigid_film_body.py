"""Rigid bodies with surfaces that carry the nodes of oil films.

A film is discretised on the grid of a reduced body's surface. Here that body is rigid, without finite elements: it has
no global modes, its surfaces no compliance, and their grids have as many nodes as the film requires. Bores, pads and
sliders that are much stiffer than their film.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from warpffrf.model.arguments import Matrix, Vector
from warpffrf.model.errors import InputError, require_array, require_count, require_inertia, require_number
from warpffrf.model.messages.named_arguments import named_arguments
from warpffrf.model.reduced.body import ReducedBody
from warpffrf.model.reduced.contact_grid import SurfaceGrid
from warpffrf.model.reduced.contact_surface import ContactSurface, Recovery
from warpffrf.model.reduced.data import DisplaySurface, Interface
from warpffrf.model.surfaces import Shape
from warpffrf.offline.half_space_body import SKIN_COLUMNS, SKIN_ROWS, Patch, skin_of, triangles_of

FEWEST = 3  # nodes each way of a grid


@named_arguments
def rigid_film_body(
    mass: float,
    inertia_tensor: Vector | Matrix,
    *,
    contact: Mapping[str, Shape],
    extent: Mapping[str, Vector | Matrix] | Vector | Matrix,
    nodes: tuple[int, int] = (64, 9),
    thickness: float | None = None,
    points: Mapping[str, Vector] | None = None,
    center_of_mass: Vector = (0.0, 0.0, 0.0),
) -> ReducedBody:
    """A rigid body whose surfaces carry oil films, as first surface of a `Film`; not for contacts.

    mass [kg]; inertia_tensor (3, 3), or its diagonal (3,) [kg m2], about the centre of mass; center_of_mass (3,) [m].
    contact: {name: shape} of `warpffrf.surfaces` with all parameters given. extent: {name: limits}, without names: of
    all surfaces; (low, high) [m] along the axis from `axis_point`, all around, or ((low, high), (low, high)), first
    angles [rad] of an arc, of a plane lengths [m], then along. nodes: (columns, rows) of the grids, around and along.
    thickness [m]: of the walls behind the surfaces in pictures, None for surfaces alone.
    points: {name: (3,) [m]}, ports for joints and forces, by default {"center": center_of_mass}. User frame.

    Returns a `ReducedBody` without modes, for `Scene.add_body`. Raises `InputError` for a shape with parameters left to
    be fitted, missing limits, and an impossible inertia.

    >>> bore = wf.surfaces.Bore(radius=0.025, axis_point=(0, 0, 0), axis_direction=(0, 1, 0))
    >>> pad = wf.rigid_film_body(
    ...     0.2, (1e-4,) * 3, contact={"pad": bore}, extent=((-0.6, 0.6), (-0.0125, 0.0125)), nodes=(24, 9)
    ... )
    >>> pad.contact_surfaces["pad"].grid.columns, list(pad.interfaces)
    (24, ['center'])
    """
    label = "rigid_film_body"
    if not contact:
        raise InputError(f"{label}: contact names no surface; add a body without any by scene.add_rigid_body")
    if not isinstance(extent, Mapping):
        extent = dict.fromkeys(contact, extent)
    if unknown := [name for name in extent if name not in contact]:
        raise InputError(f"{label}: extent names {unknown[0]!r}, which is no surface of contact")
    columns, rows = (require_count(n, f"{label}: nodes", FEWEST) for n in nodes)
    patches = {name: Patch.of(name, shape, extent.get(name), label, arcs=True) for name, shape in contact.items()}
    skin = skin_of(patches) if thickness is None else _walls(patches, require_number(thickness, f"{label}: thickness"))
    center = require_array(center_of_mass, f"{label}: center_of_mass", (3,))
    return ReducedBody(
        mass=require_number(mass, f"{label}: mass", positive=True),
        center_of_mass=center,
        inertia=require_inertia(inertia_tensor, f"{label}: inertia_tensor"),
        frequencies=np.zeros(0),
        interfaces={
            name: Interface("rigid", require_array(point, f"{label}: points[{name!r}]", (3,)), np.zeros((0, 6)))
            for name, point in (points or {"center": center}).items()
        },
        contact_surfaces={
            name: _surface(name, patch, columns, rows, len(skin.points)) for name, patch in patches.items()
        },
        surface=skin,
        report={"path": "rigid", "notes": [], "warnings": []},
        provenance={"mesh_name": "rigid"},
    )


def _surface(name: str, patch: Patch, columns: int, rows: int, skin_points: int) -> ContactSurface:
    theta, z = patch.chart(columns, rows)
    periodic, functions = patch.across is None, columns * rows
    per_sector = 1 if periodic else columns
    pitch, start, block = float(theta[1] - theta[0]), float(theta[0]), per_sector * rows
    grid = SurfaceGrid(np.asarray(patch.shape.e_0), start, pitch, columns, periodic, z, per_sector)
    recovery = Recovery(np.zeros((1, 3 * skin_points, functions), np.float32), 1, np.eye(3))
    compliance = np.zeros((columns // per_sector, block, block))
    return ContactSurface(name, patch.shape, grid, compliance, np.zeros((functions, 0)), recovery)


def _walls(patches: Mapping[str, Patch], thickness: float) -> DisplaySurface:
    """Walls behind the surfaces, closed."""
    points: list[np.ndarray] = []
    triangles: list[np.ndarray] = []
    for patch in patches.values():
        theta, z = patch.chart(SKIN_COLUMNS, SKIN_ROWS)
        at = np.broadcast_arrays(theta[:, None], z[None, :])
        front = patch.shape.point(*at)
        index = sum(map(len, points)) + np.arange(2 * at[0].size).reshape(2, *at[0].shape)
        points += [face.reshape(-1, 3) for face in (front, front - thickness * patch.shape.normal(*at))]
        if patch.across is None:
            index = np.concatenate([index, index[:, :1]], axis=1)
        faces = [index[0], index[1, :, ::-1], index[::-1, :, 0].T, index[:, :, -1].T]
        if patch.across is not None:
            faces += [index[:, 0], index[::-1, -1]]
        triangles += [triangles_of(face) for face in faces]
    count = sum(map(len, points))
    return DisplaySurface(np.concatenate(points), np.concatenate(triangles), np.zeros((0, count, 3)))
