"""The outer skin of a mesh as triangles: quadrilaterals split, quadratic faces split at their own nodes."""

from __future__ import annotations

import numpy as np

from warpffrf.model.mesh.elements import FACET_CORNERS, cell_kind

_SPLIT = {
    "quad4": ((0, 1, 2), (0, 2, 3)),
    "quad9": ((0, 4, 8), (0, 8, 7), (4, 1, 5), (4, 5, 8), (8, 5, 2), (8, 2, 6), (7, 8, 6), (7, 6, 3)),
    "tri3": ((0, 1, 2),),
    "tri6": ((0, 3, 5), (3, 1, 4), (5, 4, 2), (3, 4, 5)),
}


def outer_faces(kind: str, cells: np.ndarray, inner: int | None = None) -> np.ndarray:
    """Faces (f, kf) of `cells` (m, k) that belong to one cell only, outward.

    With `inner`, only the faces of the first `inner` cells are returned; the others serve as their neighbours.
    """
    reference = cell_kind(kind)
    faces = cells[:, reference.faces].reshape(-1, reference.faces.shape[1])
    corners = np.sort(faces[:, : FACET_CORNERS[reference.facet_kind]], axis=1)
    _, inverse, counts = np.unique(corners, axis=0, return_inverse=True, return_counts=True)
    single = counts[inverse.ravel()] == 1
    if inner is not None:
        single[inner * len(reference.faces) :] = False
    return faces[single]


def triangles(kind: str, faces: np.ndarray) -> np.ndarray:
    """Triangles (t, 3) of outward `faces` of the cell `kind`, outward."""
    split = np.array(_SPLIT[cell_kind(kind).facet_kind])
    return faces[:, split].reshape(-1, 3)
