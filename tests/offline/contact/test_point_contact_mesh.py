"""A rigid sphere on a reduced block: which mesh is fine, deep and large enough for a point contact.

Hertz: steel half-space, sphere of R = 10 mm, 100 N. The contact is solved here, by an active set on the whole contact
grid with the compliance of the reduced body: `g = int psi (r^2/2R - delta) + C s`, `0 <= s, 0 <= g`, `s.g = 0`.
"""

from __future__ import annotations

import numpy as np
import pytest
from offline_bodies import STEEL

from warpffrf.model.mesh import block
from warpffrf.model.reduced.body import ReducedBody
from warpffrf.model.surfaces import Plane
from warpffrf.offline import reduce

R, LOAD = 0.01, 100.0
MODULUS = 210e9 / (1.0 - 0.3**2)  # the sphere is rigid
HALF_WIDTH = (0.75 * LOAD * R / MODULUS) ** (1.0 / 3.0)
APPROACH = HALF_WIDTH**2 / R
# of the patch: the outermost columns of an arc are left out of the grid, and those next to them are to stay open
WIDTHS = np.array([1.5, 1.25])
PEAK = 1.5 * LOAD / (np.pi * HALF_WIDTH**2)


def held_compliance(body: ReducedBody) -> np.ndarray:
    """Displacement coefficients of the patch per force of its functions, with the bottom held.

    Of the free body, u = D f + N l + R q and the bottom moves by w = N^T f + F l + q, with the reactions l on it; l
    balances f, l = -R^T f, and q is the rigid motion that keeps w = 0.
    """
    s, bottom = body.contact_surfaces["patch"], body.interfaces["bottom"]
    omega = 2.0 * np.pi * body.frequencies
    on_patch, on_bottom = s.mode_normal / omega, bottom.modes / omega[:, None]
    D = s.compliance(np.arange(s.grid.columns)) + on_patch @ on_patch.T
    N, F = on_patch @ on_bottom, on_bottom.T @ on_bottom
    theta, z = np.meshgrid(s.grid.theta, s.grid.z, indexing="ij")
    x, n = s.shape.point(theta.ravel(), z.ravel()), s.shape.normal(theta.ravel(), z.ravel())
    rigid = np.hstack([n, np.cross(x - bottom.point, n)])
    return D - N @ rigid.T + rigid @ (F @ rigid.T - N.T)


def node_integrals(nodes: np.ndarray, outer: bool) -> tuple[np.ndarray, np.ndarray]:
    """int psi_i dx and int psi_i x^2 dx of the nodes on equally spaced `nodes`; `outer`: the outermost reach beyond."""
    step = nodes[1] - nodes[0]
    line = np.concatenate([[nodes[0] - step], nodes, [nodes[-1] + step]]) if outer else nodes
    q, w = np.polynomial.legendre.leggauss(3)
    q, w = 0.5 * (q + 1.0), 0.5 * w * step
    x = line[:-1, None] + step * q
    found = []
    for f in (np.ones_like(x), x**2):
        total = np.zeros(len(line))
        total[:-1] += f @ (w * (1.0 - q))
        total[1:] += f @ (w * q)
        found.append(total[1:-1] if outer else total)
    return found[0], found[1]


def pressed(C: np.ndarray, gap: np.ndarray) -> np.ndarray:
    """Coefficients s >= 0 (n,) of the pressure with gap + C s >= 0 by an active set."""
    active = gap < 0.0
    for _ in range(50):
        s = np.zeros(len(gap))
        s[active] = np.linalg.solve(C[np.ix_(active, active)], -gap[active])
        changed = np.where(active, s > 0.0, gap + C @ s < 0.0)
        if np.array_equal(changed, active):
            return s
        active = changed
    pytest.fail("the active set does not settle")


def rigid_sphere_on(body: ReducedBody) -> tuple[float, float, float]:
    """Force [N] at Hertz's approach, half-width from the second moment [m] and peak pressure [Pa]."""
    s = body.contact_surfaces["patch"]
    around, squares_around = node_integrals(s.grid.theta, True)
    along, squares_along = node_integrals(s.grid.z, False)
    area = np.outer(around, along).ravel()
    squares = (np.outer(squares_around, along) + np.outer(around, squares_along)).ravel()
    gram = np.kron(s.grid.gram_theta(), s.gram_z)
    C = gram @ held_compliance(body) @ gram
    p = pressed(0.5 * (C + C.T), squares / (2.0 * R) - APPROACH * area)
    force = float(area @ p)
    return force, float(np.sqrt(2.5 * (squares @ p) / force)), float(p.max())


@pytest.mark.slow
@pytest.mark.parametrize(
    ("size", "cells", "accuracy"),
    [
        (0.02, 2, (0.012, 0.005, 0.005)),  # the nearer sides and bottom make it stiffer by 0.4 %
        (0.04, 2, (0.008, 0.005, 0.005)),
    ],
)
def test_rigid_sphere_on_a_block(size, cells, accuracy):
    """Force within 1 % of Hertz at his approach; half-width and peak within half a per cent of his at that force.

    Two quadratic cells a half-width, four nodes, are enough. The rest of the force is half the finite block (an error
    of a/size) and half the shells behind the patch.
    """
    a = HALF_WIDTH
    mesh = block((2.0 * size, 2.0 * size, size), patch_half_width=WIDTHS * HALF_WIDTH, cell=a / cells)
    body = reduce(
        mesh, STEEL, interfaces={"bottom": "rigid"}, contact={"patch": Plane()}, modes=0, cache=False, progress=False
    )
    force, half_width, peak = rigid_sphere_on(body)
    scale = (force / LOAD) ** (1.0 / 3.0)
    assert abs(force / LOAD - 1.0) < accuracy[0]
    assert abs(half_width / (scale * a) - 1.0) < accuracy[1]
    assert abs(peak / (scale * PEAK) - 1.0) < accuracy[2]


def test_coarse_patch_is_seen_to_be_coarse():
    """One quadratic cell a half-width: the approach is right, but the peak is some ten per cent off."""
    a = HALF_WIDTH
    mesh = block((0.02, 0.02, 0.01), patch_half_width=WIDTHS * HALF_WIDTH, cell=a, growth=2.0)
    body = reduce(
        mesh, STEEL, interfaces={"bottom": "rigid"}, contact={"patch": Plane()}, modes=0, cache=False, progress=False
    )
    force, _, peak = rigid_sphere_on(body)
    assert abs(force / LOAD - 1.0) < 0.05
    assert 0.05 < peak / ((force / LOAD) ** (1.0 / 3.0) * PEAK) - 1.0 < 0.3
