"""Rigid bodies of a recording: their meshes, coloured by load where they carry.

The load of a rigid body is the largest force of its lumped contacts; in a bearing that of the rolling elements alone,
as rings carry the sum of all of them. A dark line along the first surface of each body shows its rotation.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from warpffrf.output.geometry.rigid_mesh import RigidMesh, rigid_meshes
from warpffrf.output.geometry.scene_view import GROUND
from warpffrf.output.plots.colors import PRESSURE_STOPS, ColorScale, largest

STEEL, GROUND_COLOR, CAGE_COLOR, MARKER_COLOR = (176, 184, 194), (128, 134, 142), (188, 160, 110), (170, 145, 175)
SEEN_THROUGH = 70  # alpha of outer rings of bearings, which enclose their elements
LINE, DARKER = (105, 105, 110), 0.6  # colour of the line that shows the rotation, of steel and of colours
HALF_LINE, OFF_AXIS = 0.04, 1e-6  # rad; of the size


class RigidBodies:
    """Logs the rigid bodies of a recorder's result."""

    def __init__(self, recorder: Any) -> None:
        self.recorder = recorder
        result = recorder.result
        self.meshes: dict[str, RigidMesh] = rigid_meshes(result)
        self.cages = {bearing["cage"] for bearing in result.view.bearings.values()}
        self.outer = {bearing["outer"] for bearing in result.view.bearings.values()}
        self.loads = _loads(result)
        rows = recorder.rows[recorder.good]
        self.top = largest([load[rows] for load in self.loads.values()])
        unit, per_newton = ("kN", 1e-3) if self.top >= 1e3 else ("N", 1.0)
        self.scale = ColorScale(f"largest contact force of a rigid body [{unit}]", self.top, per_newton, PRESSURE_STOPS)

    @property
    def shows_loads(self) -> bool:
        """Whether the colours of at least one body are those of `scale`."""
        return self.top > 0.0

    def path(self, name: str) -> str:
        """Entity of the mesh, which moves with the body."""
        return self.recorder.path("world", name, "solid")

    def static(self) -> None:
        """Log all meshes."""
        rr = self.recorder.rr
        for name, mesh in self.meshes.items():
            colors: dict[str, Any] = {"vertex_colors": self._colors(name, mesh)}
            if name in self.outer:
                colors = {"albedo_factor": (*STEEL, SEEN_THROUGH)}
            elif self.shows_loads and name in self.loads:
                colors = {}  # those of each frame, which static ones would replace
            self.recorder.log_static(self.path(name), rr.Mesh3D(
                vertex_positions=mesh.points.astype(np.float32), vertex_normals=mesh.normals.astype(np.float32),
                triangle_indices=mesh.triangles.astype(np.uint32), **colors,
            ))  # fmt: skip

    def frame(self, i: int) -> None:
        """Log the colours of loads at saved row i."""
        if not self.shows_loads:
            return
        for name, load in self.loads.items():
            rgb = self.scale.rgb(load[i : i + 1])
            rgb = np.where(self._line(name)[:, None], DARKER * rgb, rgb).astype(np.uint8)
            mesh = self.recorder.rr.Mesh3D.from_fields(vertex_colors=rgb)
            self.recorder.stream.log(self.path(name), mesh)

    def bounded(self, name: str) -> bool:
        """Whether a mesh belongs into the view as a whole: a plate of the ground extends as far as it pleases."""
        bearings = self.recorder.result.view.bearings.values()
        return name != GROUND or any(GROUND in (b["inner"], b["outer"]) for b in bearings)

    def _colors(self, name: str, mesh: RigidMesh) -> np.ndarray:
        color = CAGE_COLOR if name in self.cages else GROUND_COLOR if name == GROUND else STEEL
        color = MARKER_COLOR if mesh.marker else color
        return np.where(self._line(name)[:, None], LINE, np.array(color)).astype(np.uint8)

    def _line(self, name: str) -> np.ndarray:
        """Vertices (n,) of the line, none on the ground and on markers."""
        mesh, body = self.meshes[name], self.recorder.result.view.bodies.get(name)
        shapes = [] if body is None else [s for s in body.shapes.values() if not s.profile().planar]
        if mesh.marker or not shapes:
            return np.zeros(len(mesh.points), dtype=bool)
        away = mesh.points - shapes[0].axis_point
        x, y = away @ shapes[0].e_0, away @ shapes[0].e_1
        return (np.abs(np.arctan2(y, x)) < HALF_LINE) & (x > OFF_AXIS * np.abs(away).max())


def _loads(result: Any) -> dict[str, np.ndarray]:
    """Loads (T,) [N] of rigid bodies."""
    view, found = result.view, {}
    within: set[str] = set()
    for name, bearing in view.bearings.items():
        within |= {*bearing["contacts"].values()}
        loads = result.bearing(name)
        for k, element in enumerate(bearing["elements"]):
            if view.bodies[element].reduced is None:
                found[element] = np.maximum(loads.inner_load[:, k], loads.outer_load[:, k])
    for name, met in view.lumped.items():
        for body in (met.first_body, met.second_body):
            if name not in within and body.reduced is None and body.name != GROUND:
                force = np.linalg.norm(result.history.lumped_contacts[name].force, axis=1)
                found[body.name] = np.maximum(found.get(body.name, 0.0), force)
    return found
