"""Displacement of the corners of a lap's cells, from that of the first body's skin, for pictures."""

from __future__ import annotations

import numpy as np
from scipy.spatial import KDTree

from warpffrf.output.bodies.skin import Skin
from warpffrf.output.geometry.scene_view import LapView
from warpffrf.output.geometry.skin_nodes import SkinNodes

NEAREST = 3  # nodes of the face beside a corner; a corner on a node has its displacement


class LapOnSkin:
    """The corners (t, 3, 3) of the triangles that the cells of a lap consist of, on the deformed skin of the first
    body: each moves as the nodes of the skin next to it, weighed by the inverse of their distance squared."""

    def __init__(self, view: LapView, skin: Skin) -> None:
        self.skin = skin
        self.corners, self.cell = view.triangles
        own = np.flatnonzero(
            SkinNodes(skin.points, skin.triangles).on(self.corners, self.cell, len(view.cell)).sum(axis=1)
        )
        distance, near = KDTree(skin.points[own]).query(self.corners.reshape(-1, 3), k=NEAREST)
        self._nodes = own[near]
        least = 1e-12 * float(np.ptp(skin.points, axis=0).max())
        weight = 1.0 / np.maximum(distance, least) ** 2
        self._weight = weight / weight.sum(axis=1, keepdims=True)

    def displacement(self, i: int) -> np.ndarray:
        """(t, 3, 3) [m, user axes of the first body] of the corners at saved step `i`."""
        moved = self.skin.displacement(i)[self._nodes]
        return np.einsum("nk,nkd->nd", self._weight, moved).reshape(self.corners.shape)
