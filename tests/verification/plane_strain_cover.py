r"""A rubber cover on a rigid core, pressed on a rigid plane, in plane strain: an independent solution for the load.

Displacement and pressure (Taylor-Hood: biquadratic, bilinear continuous) on a strip of the cover around the contact,
graded towards it. Contact without friction at the surface nodes: a node at the angle theta from the line of centres,
moved outwards by u_r and forwards by u_t, lies above the plane by

    cos(theta) g = R - d - (R + u_r) cos(theta) + u_t sin(theta),

d the approach, and the plane pushes it upwards. Along the undeformed normal, as the program has it, u_t is left out and
the push is radial: `exact=False`. The compliance of the nodes comes from one factorisation; the active set is that of a
complementarity problem. Converged to 0.1 % of the load (`test_rubber_cover.test_the_reference_has_converged`).
"""

from __future__ import annotations

from typing import Any

import numpy as np
import scipy.sparse as sp
import scipy.sparse.linalg as spla
from skfem import Basis, BilinearForm, ElementQuad1, ElementQuad2, ElementVector, MeshQuad, MeshQuad2
from skfem.helpers import ddot, div, sym_grad

from warpffrf.model.material import Material

STRIP = 7.0  # walls to either side, as far as there is a turn: beyond, an incompressible cover moves no more
MOST_ANGLE = np.radians(170.0)
REACH = np.radians(60.0)  # where the plane may be touched
GRADING = 0.65  # share of the cube in the map of the angles


def pressed_cover(
    radius: float, core: float, material: Material, approach: float, around: int, through: int, *, exact: bool = False
) -> tuple[float, float, float]:
    """Line load [N/m], peak pressure [Pa] and half-width [m] from its second moment, on `around` by `through` cells."""
    s = np.linspace(-1.0, 1.0, around + 1)
    angles = min(STRIP * (radius - core) / radius, MOST_ANGLE) * ((1.0 - GRADING) * s + GRADING * s**3)
    flat = MeshQuad2.from_mesh(MeshQuad.init_tensor(angles, np.linspace(core, radius, through + 1)))
    theta, r = flat.doflocs
    mesh = MeshQuad2(np.array([r * np.sin(theta), -r * np.cos(theta)]), flat.t)
    u: Any = Basis(mesh, ElementVector(ElementQuad2()), intorder=5)
    p = u.with_element(ElementQuad1())
    lam, mu = material.lame
    A: Any = BilinearForm(lambda u, v, _: 2.0 * mu * ddot(sym_grad(u), sym_grad(v))).assemble(u)
    B: Any = BilinearForm(lambda u, q, _: div(u) * q).assemble(u, p)
    C = BilinearForm(lambda p, q, _: -p * q / lam).assemble(p)
    K: Any = sp.bmat([[A, B.T], [B, C]], format="csc")
    place = np.array(u.doflocs)
    distance, angle = np.hypot(*place), np.arctan2(place[0], -place[1])
    held = np.flatnonzero(distance < core * (1.0 + 1e-6))
    free = np.setdiff1d(np.arange(K.shape[0]), held)
    across = np.flatnonzero((distance > radius * (1.0 - 1e-7)) & (np.abs(angle) < REACH))
    across = across[np.argsort(angle[across], kind="stable")].reshape(-1, 2)  # x and y of each surface node
    theta = angle[across[:, 0]]
    outward = np.zeros((K.shape[0], len(theta)))
    component = np.where(np.isin(across, _along_x(u)), 0, 1)
    normal = np.zeros_like(theta) if exact else theta  # against the vertical
    direction = np.stack([np.sin(normal), -np.cos(normal)], axis=1)
    for side in range(2):
        outward[across[:, side], np.arange(len(theta))] = direction[np.arange(len(theta)), component[:, side]]
    response = np.zeros_like(outward)
    response[free] = spla.splu(K[free][:, free]).solve(outward[free])
    compliance = outward.T @ response
    gap = (radius * (1.0 - np.cos(theta)) - approach) / np.cos(normal)
    force = _complementary(compliance, gap)
    weight = np.zeros(len(theta))  # Simpson's rule on the arc
    arc = radius * theta
    for i in range(0, len(theta) - 2, 2):
        weight[i : i + 3] += (arc[i + 2] - arc[i]) * np.array([1.0, 4.0, 1.0]) / 6.0
    middle = np.argsort(np.abs(theta))[:7]
    peak = np.polyfit(theta[middle] ** 2, (force / weight)[middle], 1)[-1]
    upwards = force * np.cos(normal)
    half_width = 2.0 * np.sqrt(upwards @ arc**2 / upwards.sum())
    return float(upwards.sum()), float(peak), float(half_width)


def _along_x(basis: Any) -> np.ndarray:
    """Dofs of the displacement along x."""
    return np.concatenate([part[0] for part in (basis.nodal_dofs, basis.facet_dofs, basis.interior_dofs)])


def _complementary(compliance: np.ndarray, gap: np.ndarray) -> np.ndarray:
    """Forces f >= 0 inwards with g + C f >= 0 and their product zero."""
    active = gap < 0.0
    for _ in range(100):
        f = np.zeros(len(gap))
        f[active] = np.linalg.solve(compliance[np.ix_(active, active)], -gap[active])
        after = (active & (f > 0.0)) | (~active & (gap + compliance @ f < 0.0))
        if np.array_equal(after, active):
            return f
        active = after
    raise RuntimeError("the active set does not settle")
