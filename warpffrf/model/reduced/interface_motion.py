r"""How the modes move an interface: the one place on the host that says it.

Components d_c of the translation and rotation (u, theta) in body axes follow from the mode shapes Phi_c and, of a body
that loads stiffen, the geometric stiffness K_c of a unit load (`warpffrf.model.reduced.inertia.GeometricStiffness`),

    d_c = Phi_c.q - q.K_c q/2,      dd_c/dq = Phi_c - K_c q,

as the constraint rows see it (`warpffrf_kernels.bodies.interfaces`). The second part is what deflections shorten: the
work of a load F on it is the energy -F.d = F q.K q/2 of the prestress, so that one does not go without the other.

A *body* here is whatever has `reduced`, a reduced body, and `stiffening`, whether loads stiffen it: a body of a scene
or a `BodyView` of results.
"""

from __future__ import annotations

from typing import Any

import numpy as np

Array = np.ndarray


def interface_motion(body: Any, name: str, q: Array) -> Array:
    """Translation and rotation (..., 6) [m, rad] of interface `name` at modal coordinates q (..., m), body axes."""
    return q @ body.reduced.interfaces[name].modes - 0.5 * second_order(body, name, q, q)


def interface_slope(body: Any, name: str, q: Array) -> Array:
    """The derivative (m, 6) of `interface_motion` by the modal coordinates at q (m,): how modes move the interface."""
    slope = np.array(body.reduced.interfaces[name].modes, dtype=float)
    if body.stiffening:
        K = body.reduced.inertia_terms.stiffening.interfaces[name]
        k = K.shape[1]
        slope[:k] -= np.einsum("cij,j->ic", K, q[:k])
    return slope


def second_order(body: Any, name: str, x: Array, y: Array) -> Array:
    """x.K_c y (..., 6) for x, y (..., m) [m]; zeros of a body that loads do not stiffen."""
    if not body.stiffening:
        return np.zeros((*x.shape[:-1], 6))
    K = body.reduced.inertia_terms.stiffening.interfaces[name]
    k = K.shape[1]
    return np.einsum("...i,cij,...j->...c", x[..., :k], K, y[..., :k], optimize=True)
