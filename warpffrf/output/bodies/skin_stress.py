"""Stress at the nodes of a skin, of bodies that were reduced with stress points there.

`reduce(..., stress={"skin": "skin"})` names all of the skin's nodes, a facet set or a list of points those that it has.
A node takes its stress from the points at its own place. Nodes of faces that lie on each other share a place: there the
nodes and the points are taken in their order, and a place where their numbers differ has no stress, because nobody
knows which belongs to which. Nodes without points are NaN, which viewers leave out.
"""

from __future__ import annotations

from functools import cached_property
from typing import Any

import numpy as np
from scipy.spatial import KDTree

from warpffrf.model.reduced.stress_field import von_mises
from warpffrf.output.bodies.stress import BodyStress
from warpffrf.output.geometry.scene_view import SceneView

SAME = 1e-9  # of the extent of a skin: places of one node
CURE = "reduce(..., stress={'skin': 'skin'}) gives it"


class SkinStress:
    """Stress at the nodes `points` (n, 3) [m, user frame] of the skin of the body called `body`."""

    def __init__(self, history: Any, view: SceneView, body: str, points: np.ndarray) -> None:
        self.history, self.view, self.body, self.points = history, view, body, points

    @cached_property
    def _parts(self) -> list[tuple[str, np.ndarray, np.ndarray]]:
        """Of each name of stress points that is needed: the nodes that have theirs from it, and which points."""
        free, found = np.ones(len(self.points), dtype=bool), []
        fields = self.view.bodies[self.body].reduced.stress
        matches = {name: same_places(self.points, field.points) for name, field in fields.items()}
        for name, match in sorted(matches.items(), key=lambda item: -np.count_nonzero(item[1] >= 0)):
            nodes = np.flatnonzero(free & (match >= 0))
            if len(nodes):
                found.append((name, nodes, match[nodes]))
                free[nodes] = False
        return found

    @cached_property
    def _sources(self) -> list[BodyStress]:
        return [BodyStress(self.history, self.view, self.body, name) for name, _, _ in self._parts]

    @property
    def count(self) -> int:
        """Nodes of the skin that have a stress."""
        return sum(len(nodes) for _, nodes, _ in self._parts)

    @property
    def note(self) -> str:
        """What is missing and how to get it; empty where every node has its stress."""
        whole = len(self.points)
        if self.count == whole:
            return ""
        part = f"stress at {self.count} of {whole} nodes of its skin" if self.count else "no stress on its skin"
        return f"body '{self.body}' has {part}; {CURE}"

    def tensor(self, i: int) -> np.ndarray:
        """Stress (n, 6) [Pa] in the order xx, yy, zz, xy, yz, zx, user axes, at saved step `i`; NaN where there is
        none."""
        found = np.full((len(self.points), 6), np.nan)
        for source, (_, nodes, points) in zip(self._sources, self._parts, strict=True):
            found[nodes] = source.tensor(i)[points]
        return found

    def von_mises(self, i: int) -> np.ndarray:
        """Equivalent stress (n,) [Pa] at saved step `i`; NaN where there is none."""
        return von_mises(self.tensor(i))


def same_places(nodes: np.ndarray, points: np.ndarray) -> np.ndarray:
    """Which of `points` (p, 3) [m] lies at each of `nodes` (n, 3) [m]: numbers (n,), -1 for none."""
    found = np.full(len(nodes), -1)
    if nodes.shape == points.shape and np.array_equal(nodes, points):
        return np.arange(len(nodes))
    if not len(nodes) or not len(points):
        return found
    reach = SAME * float(np.ptp(nodes, axis=0).max())
    here = KDTree(points).query_ball_point(nodes, reach, return_sorted=True)
    beside = KDTree(nodes).query_ball_point(nodes, reach, return_sorted=True)
    for n, (at, among) in enumerate(zip(here, beside, strict=True)):
        if len(at) == len(among):
            found[n] = at[among.index(n)]
    return found
