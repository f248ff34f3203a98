r"""The largest magnification of elastic displacements that draws no surfaces into each other.

A node of the first surface of a contact or an oil film is at the distance g from the second surface where both bodies
are undeformed at their present poses, moved with the references of displacements, and at g + e with their displacements
relative to these, e = (u_1 - u_2).n along the normal n of the second surface. Drawn with the factor f it is at g + f e:
where e is negative, surfaces approach each other, up to f = g/(-e). Depths below `INVISIBLE` of the body are admitted.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from scipy.spatial import KDTree

from warpffrf.output.geometry.places import Pose, SkinSurface
from warpffrf.output.recording.frames import BodyFrames

INVISIBLE = 2e-3  # of the size of the first body: about a pixel
MOST_FRAMES = 60  # frames that are examined


def largest_factor(result: Any, bodies: dict[str, BodyFrames], rows: np.ndarray, drawn: np.ndarray) -> float:
    """Factor [-] for `bodies`, drawn at the frames `drawn` of the saved `rows`; infinite without a limit. Small-sliding
    contacts, whose gaps open with the displacement itself, give none."""
    most = np.inf
    frames = drawn[:: -(-len(drawn) // MOST_FRAMES)] if len(drawn) else drawn
    for met in (*result.view.pairs.values(), *result.view.films.values()):
        first = bodies.get(met.first_body.name)
        if first is None:
            continue
        nodes = SkinSurface(met.first, first.points).nodes
        second, tree, others = bodies.get(met.second_body.name), None, np.zeros(0, dtype=int)
        if second is not None:
            others = SkinSurface(met.second, second.points).nodes
            tree = KDTree(second.points[others]) if len(others) else None
        shape = met.second.shape
        for f in frames:
            poses = [Pose.of(result.history.bodies, b.name, int(rows[f])) for b in (met.first_body, met.second_body)]
            at = poses[1].to_user(poses[0].to_world(first.points[nodes]))
            theta, z, gap = shape.chart(at)
            normal, opening = shape.normal(theta, z), []
            beside = None if tree is None else others[tree.query(at)[1]]
            for field in ("carried", "displacement"):
                moved = poses[1].turned_back(poses[0].turned(getattr(first, field)[f, nodes].astype(float)))
                if beside is not None:
                    moved = moved - getattr(second, field)[f, beside]
                opening.append(np.einsum("ni,ni->n", moved, normal))
            closing, room = -opening[1], np.maximum(gap + opening[0], 0.0) + INVISIBLE * first.size
            most = min(most, float(np.min(room[closing > 0.0] / closing[closing > 0.0], initial=np.inf)))
    return most
