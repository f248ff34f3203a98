r"""Fields of a lap at the nodes of the skin of either of its bodies.

A face carries the tractions of its cells, those of the lap's cells on the first face, the opposite ones on the second
face of a pair, and on the second face of another body the forces that its own cells have (`model.laps.face_loads`) over
their areas, so that both bodies carry the same force also where their meshes differ. A node has the mean of the cells
that meet in it (`SkinNodes`); the state is that of the one nearest to sliding.
"""

from __future__ import annotations

import numpy as np
import scipy.sparse as sp

from warpffrf.model.laps.face_loads import places
from warpffrf.online.history.history import History, LapHistory
from warpffrf.output.bodies.lap_loads import cell_forces, on_second
from warpffrf.output.geometry.scene_view import LapView, SceneView
from warpffrf.output.geometry.skin_nodes import SkinNodes

Array = np.ndarray


class LapFace:
    """One face of a lap on the skin of its body."""

    def __init__(
        self, lap: LapHistory, view: LapView, tractions: sp.csr_matrix, normals: Array, at: sp.csr_matrix, owner: Array
    ) -> None:
        """tractions (3 k, 3 c): from the forces of the lap's cells to tractions on the k cells of the face, user axes;
        normals (k, 3) of these, outwards; at (n, k): means of cells at nodes; owner (k,): the cell of the lap that
        each has its state of, -1 none."""
        self._lap, self._area, self._tractions, self._normals = lap, view.area, tractions, normals
        self._at, self._owner = at, owner
        self.rubs = view.friction > 0.0

    def _on_cells(self, i: int) -> tuple[Array, Array]:
        """Pressure (k,) and tangential traction (k, 3) [Pa]."""
        t = (self._tractions @ cell_forces(self._lap, self._area, i)).reshape(-1, 3)
        pressure = -np.einsum("ki,ki->k", t, self._normals)
        return pressure, t + pressure[:, None] * self._normals

    def pressure(self, i: int) -> Array:
        """Pressure (n,) [Pa] at all nodes of the skin, zero off the face, at saved step `i`."""
        return self._at @ self._on_cells(i)[0]

    def traction(self, i: int) -> Array:
        """Tangential traction (n, 3) [Pa] on this body, user axes, at saved step `i`."""
        return self._at @ self._on_cells(i)[1]

    def state(self, i: int) -> Array:
        """State (n,) of the cells around each node, the largest of 0 open, 1 stick, 2 slip, at saved step `i`."""
        own = np.where(self._owner >= 0, self._lap.state[i][self._owner], 0)
        around = sp.csr_matrix((own[self._at.indices], self._at.indices, self._at.indptr), self._at.shape, copy=True)
        return around.max(axis=1).toarray().ravel().astype(np.int8)


def lap_faces(history: History, view: SceneView, body: str, points: Array, triangles: Array) -> list[LapFace]:
    """All faces of laps on a flexible body with the skin `points` (n, 3) [m, user frame], `triangles` (t, 3)."""
    skin, found = SkinNodes(points, triangles), []
    for name, lap in view.laps.items():
        own = history.laps[name]
        if lap.first_body.name == body:
            corners, cell = lap.triangles
            every = np.arange(len(lap.cell))
            out = _vectors(lap.frames, -1.0 / lap.area)
            found.append(LapFace(own, lap, out, lap.frames[:, 0], skin.on(corners, cell, len(every)), every))
            if lap.first.pair:
                across = skin.across(corners, cell, lap.first.gap[lap.cell])
                found.append(LapFace(own, lap, -out, -lap.frames[:, 0], across, every))
        if lap.second is not None and lap.second_body.name == body:
            found.append(_on_partner(own, lap, skin))
    return found


def _on_partner(history: LapHistory, lap: LapView, skin: SkinNodes) -> LapFace:
    """The second face, of another body."""
    face = lap.second
    own = places(lap.second_body.reduced.laps)[lap.second_surface_name]
    tractions = sp.csr_matrix(_vectors(face.frames, 1.0 / face.area) @ on_second(lap)[own])
    carried = sp.csc_matrix(lap.weights.multiply(lap.area[:, None]))
    most = np.asarray(carried.argmax(axis=0)).ravel()
    owner = np.where(carried.max(axis=0).toarray().ravel() > 0.0, most, -1)
    at = skin.on(face.triangles, face.cell, face.cells)
    return LapFace(history, lap, tractions, face.frames[:, 0], at, owner)


def _vectors(frames: Array, factor: Array) -> sp.csr_matrix:
    """(3 k, 3 k) from components along the rows of frames (k, 3, 3) to vectors, times factor (k,)."""
    return sp.csr_matrix(sp.block_diag(list(np.swapaxes(frames, 1, 2) * factor[:, None, None]), format="csr"))
