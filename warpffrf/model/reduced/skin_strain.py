r"""Strains of a body's skin, from the motion of its nodes.

An edge X of a triangle that goes over into X + u is stretched, of second order, by

    e = (X.u + v.v/2)/|X|^2,      u of Phi q + Theta(q, q),      v of Phi q,

v.v/2 less what Theta relieves of it (`warpffrf.model.reduced.second_order_motion`); of bodies without Theta by the
linear strain, as in their equations. It is the mean of the strain along the edge, right on quadratic cells that bend,
where shears of flat triangles are not: across a deep bend of cells much longer than thick these would be several times
the strain there is. Pressures on contact surfaces, local modes and notches inside are not in it, and of shear only what
is along edges.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from warpffrf.model.reduced.second_order_motion import motion_of, skin_displacement

Array = np.ndarray


def skin_strain(body: Any, q: Array) -> Array:
    """Strains (t, 3) [-] of the edges of each triangle of the skin of a flexible body at modal coordinates q (m,) [m].
    A *body* is whatever has `reduced` and `stiffening`."""
    surface = body.reduced.surface
    corners = np.asarray(surface.triangles)

    def edges(x: Array) -> Array:
        at = np.asarray(x, dtype=float)[corners]
        return np.roll(at, -1, axis=1) - at  # (t, 3, 3)

    X = edges(surface.points)
    stretch = np.einsum("tei,tei->te", X, edges(skin_displacement(body, q)))
    if motion_of(body) is not None:
        stretch += 0.5 * np.sum(edges(np.tensordot(q, surface.modes, 1)) ** 2, axis=2)
    return stretch / np.sum(X * X, axis=2)
