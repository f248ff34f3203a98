r"""An outer ring on feet, pressed by the rollers of a bearing: full finite elements and laws of line contact.

The ring is fixed at its feet. Roller j applies Q_j along its length l at the angle theta_j. With the compliance
C (n, n) of the ring, radial displacements of its outside opposite the rollers under unit forces at its bore, and the
approach of a rigid cylinder to a point at the depth h, the wall, below it (Weber; Johnson, Contact Mechanics, 5.6),

    d(Q) = 2 q/(pi E*) (ln(2 h/b) - nu/(2 (1 - nu))),      q = Q/l,  b^2 = 4 q R/(pi E*),  E* = E/(1 - nu^2),

an inner ring displaced by s, with every loaded roller, satisfies

    s cos phi_j - c/2 = a(Q_j) + d(Q_j) + sum_k C_jk Q_k,      sum Q_j cos phi_j = F,

phi_j from the load, c the diametral clearance, a(Q) the approach at the inner ring by its law. s is found by
bisection, the loads by Newton's method on the loaded rollers.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, TypeAlias

import numpy as np
import numpy.typing as npt
from scipy.optimize import brentq
from scipy.sparse.linalg import splu

from references.finite_elements.meshes import matrices
from warpffrf.model.material import Material
from warpffrf.model.mesh import Mesh

Array: TypeAlias = npt.NDArray[np.float64]
ON = 1e-6  # of a radius, and rad: nodes that lie on a circle, on a line
LEAST = 1e-2  # N: a roller with less is unloaded
SETTLED = 1e-7  # N, of a step of Newton's method


def compliance(
    mesh: Mesh, material: Material, radii: tuple[float, float], held: str, angles: Array, length: float
) -> Array:
    """C (n, n) [m/N] of a tube about y of hex27 cells whose bore and outside have the `radii` [m], fixed at the facet
    set `held`: outside displacements over the `length` [m] opposite lines at the bore."""
    K, _ = matrices(mesh, material)
    fixed = np.zeros(len(mesh.points), dtype=bool)
    fixed[mesh.facet_sets[held].node_set] = True
    free = np.flatnonzero(np.repeat(~fixed, 3))
    loads, seen = (np.stack([_line(mesh, r, a, length) for a in angles], axis=1) for r in radii)
    moved = np.zeros_like(loads)
    moved[free] = splu(K[free][:, free].tocsc()).solve(loads[free])
    return seen.T @ moved


def _line(mesh: Mesh, radius: float, angle: float, length: float) -> Array:
    """(3 nodes,): a unit radial force, even over the middle `length` of the line of nodes at `angle` from x to z."""
    x = mesh.points
    off = np.angle(np.exp(1j * (np.arctan2(x[:, 2], x[:, 0]) - angle)))
    nodes = np.flatnonzero((np.abs(np.hypot(x[:, 0], x[:, 2]) - radius) < ON * radius) & (np.abs(off) < ON))
    nodes = nodes[np.argsort(x[nodes, 1])]
    y, shares = x[nodes, 1], np.zeros(len(nodes))
    points, weights = np.polynomial.legendre.leggauss(4)
    for e in range(0, len(nodes) - 2, 2):
        low, high = max(y[e], -0.5 * length), min(y[e + 2], 0.5 * length)
        if high > low:
            s = (0.5 * (low + high) + 0.5 * (high - low) * points - y[e + 1]) / (0.5 * (y[e + 2] - y[e]))
            shapes = np.stack([0.5 * s * (s - 1.0), 1.0 - s**2, 0.5 * s * (s + 1.0)])
            shares[e : e + 3] += shapes @ weights * 0.5 * (high - low) / length
    found = np.zeros(3 * len(x))
    found[3 * nodes], found[3 * nodes + 2] = np.cos(angle) * shares, np.sin(angle) * shares
    return found


@dataclass(frozen=True)
class RingOnFeet:
    """compliance (n, n) [m/N], phi (n,) [rad] from the load, `wall` h, `length` l and `relative_radius` R [m],
    diametral `clearance` [m]; `inner`: approach (n,) [m] at the inner ring of loads (n,) [N]."""

    compliance: Array
    phi: Array
    wall: float
    length: float
    relative_radius: float
    clearance: float
    material: Material
    inner: Callable[[Array], Array]

    def local(self, Q: Array) -> Array:
        """d(Q) [m]."""
        E, nu = self.material.plane_strain_modulus, self.material.poisson_ratio
        q = np.maximum(Q, LEAST * LEAST) / self.length
        b = np.sqrt(4.0 * q * self.relative_radius / (np.pi * E))
        return 2.0 * q / (np.pi * E) * (np.log(2.0 * self.wall / b) - nu / (2.0 * (1.0 - nu)))

    def sinks(self, Q: Array) -> Array:
        """(n,) m: penetration of the rollers into the undeformed ring."""
        return self.local(Q) + self.compliance @ Q

    def loads(self, shift: float) -> Array:
        """(n,) N, for an inner ring displaced by `shift` [m]. Raises RuntimeError if they are not found."""
        free = shift * np.cos(self.phi) - 0.5 * self.clearance
        on = free > 0.0
        Q = np.where(on, 100.0, 0.0)
        for _ in range(200):
            at = np.flatnonzero(on)
            if not len(at):
                return Q
            h = 1e-4 * Q[at]
            own = [self.inner(Q[at] + x) + self.local(Q[at] + x) for x in (h, -h)]
            lacking = (self.inner(Q) + self.sinks(Q) - free)[at]
            slope = self.compliance[np.ix_(at, at)] + np.diag((own[0] - own[1]) / (2.0 * h))
            step = -np.linalg.solve(slope, lacking)
            Q[at] = np.maximum(Q[at] + step, 0.1 * Q[at])
            if np.any(Q[at] < LEAST):
                on[at[Q[at] < LEAST]] = False
                Q[~on] = 0.0
            elif np.abs(step).max() < SETTLED:
                return Q
        raise RuntimeError("the rollers of the ring on feet were not found")

    def solve(self, load: float, largest: float) -> tuple[float, Array]:
        """Shift s [m], up to `largest`, and loads (n,) [N] under `load` [N]."""

        def lacking(shift: float) -> float:
            return float(self.loads(shift) @ np.cos(self.phi)) - load

        shift: Any = brentq(lacking, 0.5 * self.clearance, largest, xtol=1e-12)
        return shift, self.loads(shift)
