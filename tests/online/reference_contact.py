"""The contact problem of two bodies of revolution in plain NumPy: dense, every node of a window, every cell, no reuse.

Written from the equations (module docstrings of `line_of_centres` and `contact_compliance`), not from the kernels:
positions of
points are built in the world, the gap is found as the root of a quadratic, nodes are evaluated as functions. The
complementarity problem 0 <= s, g + G s >= 0, s.(g + G s) = 0 is the optimality condition of min s.G.s/2 + g.s over s
>= 0, and with
G = U^T U of the non-negative least squares problem |U s + U^-T g|.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.linalg import cholesky, solve_triangular
from scipy.optimize import nnls


@dataclass(frozen=True, eq=False)
class Pose:
    """A flexible body in the world: user origin (3,), rotation matrix (3, 3), modal coordinates (m,)."""

    origin: np.ndarray
    rotation: np.ndarray
    modal: np.ndarray


def gauss(count: int) -> tuple[np.ndarray, np.ndarray]:
    """Gauss points and weights on (0, 1)."""
    x, w = np.polynomial.legendre.leggauss(count)
    return 0.5 * (x + 1.0), 0.5 * w


def nodes_around(grid: Any, x: float) -> list[tuple[int, float]]:
    """(column, value) of the nodes at the grid coordinate x, columns wrapped around the turn."""
    j = int(np.floor(x))
    return [(j % grid.columns, 1.0 - (x - j)), ((j + 1) % grid.columns, x - j)]


def nodes_along(z_nodes: np.ndarray, z: float) -> list[tuple[int, float]]:
    """(row, value) of the nodes at the axial position z, extended linearly beyond the ends."""
    k = int(np.clip(np.searchsorted(z_nodes, z, side="right") - 1, 0, len(z_nodes) - 2))
    e = (z - z_nodes[k]) / (z_nodes[k + 1] - z_nodes[k])
    return [(k, 1.0 - e), (k + 1, e)]


def dense_compliance(surface: Any) -> np.ndarray:
    """D of all nodes of a surface."""
    return surface.compliance(np.arange(surface.grid.columns))


def full_gram(surface: Any) -> np.ndarray:
    """M of all nodes."""
    return np.kron(surface.grid.gram_theta(), surface.gram_z)


@dataclass(frozen=True, eq=False)
class Problem:
    """Weak gaps (n,), compliance G (n, n), areas (n,), wrench of a unit hat pressure on A (n, 6: force, moment about
    A's
    user origin) and load on B's nodes (n, nodes of B), for the nodes `index` (n, 2: column, row) of A."""

    index: np.ndarray
    gap: np.ndarray
    G: np.ndarray
    area: np.ndarray
    wrench: np.ndarray
    load: np.ndarray

    def pressures(self) -> np.ndarray:
        """The solution s (n,) [Pa]."""
        scale = 1.0 / np.sqrt(np.diag(self.G))
        U = cholesky(self.G * scale[:, None] * scale[None, :])
        y = solve_triangular(U, -self.gap * scale, trans=1)
        size = np.abs(y).max()
        s, _ = nnls(U, y / size, maxiter=50 * len(y))
        active = s > 0.0  # once more on the active set, to round-off
        s[active] = np.linalg.solve((U.T @ U)[np.ix_(active, active)], (-self.gap * scale)[active] / size)
        return s * scale * size


def contact_problem(
    first: Any, second: Any, A: Pose, B: Pose, columns: np.ndarray, *, theta_points: int, z_points: int
) -> Problem:
    """The problem on the nodes of the grid `columns` (consecutive, not wrapped) of the surface `first`."""
    ga, gb = first.grid, second.grid
    rows = ga.rows
    n = len(columns) * rows
    e_A, e_B = A.rotation @ first.shape.e_a, B.rotation @ second.shape.e_a
    O_A = A.origin + A.rotation @ first.shape.axis_point
    O_B = B.origin + B.rotation @ second.shape.axis_point
    gap, area = np.zeros(n), np.zeros(n)
    wrench, load = np.zeros((n, 6)), np.zeros((n, gb.columns * gb.rows))
    xt, wt = gauss(theta_points)
    xz, wz = gauss(z_points)
    first_column = int(columns[0])
    for k in range(rows - 1):
        for qz in range(z_points):
            z = ga.z[k] + xz[qz] * (ga.z[k + 1] - ga.z[k])
            R_A = float(first.shape.radius_at(z))
            measure_z = wz[qz] * (ga.z[k + 1] - ga.z[k]) * R_A * np.sqrt(1.0 + float(first.shape.slope_at(z)) ** 2)
            a = O_A + z * e_A
            # b on B's axis in the section e_A.(x - a) = 0
            axial_b = np.dot(e_A, a - O_B) / np.dot(e_A, e_B)
            b = O_B + axial_b * e_B
            d = float(np.linalg.norm(b - a))
            c = (b - a) / d
            t = np.cross(e_A, c)
            N = c - e_A * np.dot(c, e_B) / np.dot(e_A, e_B)
            f = N + e_A * float(second.shape.slope_at(axial_b)) / np.dot(e_A, e_B)
            towards_b = A.rotation.T @ c  # angle of the line of centres on A
            e_1 = np.cross(first.shape.e_a, ga.e_0)
            theta_A = np.arctan2(towards_b @ e_1, towards_b @ ga.e_0)
            towards_a = -(B.rotation.T @ c)
            f_1 = np.cross(second.shape.e_a, gb.e_0)
            theta_B = np.arctan2(towards_a @ f_1, towards_a @ gb.e_0)
            for j in range(first_column - 1, first_column + len(columns)):
                for qt in range(theta_points):
                    x = j + xt[qt]
                    theta = ga.theta_start + x * ga.pitch
                    xi = (theta - theta_A + np.pi) % (2.0 * np.pi) - np.pi
                    y = R_A * np.sin(xi)
                    # opposite point of B: at -h along c seen from b, at y along t; its radius is that at its own
                    # axial station
                    R_B = float(second.shape.radius_at(axial_b))
                    h = np.sqrt(R_B**2 - y**2)
                    axial = axial_b + (y * t - h * c) @ e_B
                    R_B = float(second.shape.radius_at(axial))
                    h = np.sqrt(R_B**2 - y**2)
                    g = d - h - R_A * np.cos(xi)
                    turned = -np.sign(np.dot(e_A, e_B)) * np.arctan2(y, h)
                    x_B = (theta_B + turned - gb.theta_start) / gb.pitch
                    if not gb.z[0] <= axial_b <= gb.z[-1]:
                        continue
                    q = wt[qt] * ga.pitch * measure_z
                    on_b = [
                        (cb * gb.rows + rb, vb * ub)
                        for cb, vb in nodes_around(gb, x_B)
                        for rb, ub in nodes_along(gb.z, float(np.clip(axial, gb.z[0], gb.z[-1])))
                    ]
                    for column, value in ((j, 1.0 - xt[qt]), (j + 1, xt[qt])):
                        if not 0 <= column - first_column < len(columns):
                            continue
                        for row, along in ((k, 1.0 - xz[qz]), (k + 1, xz[qz])):
                            i = (column - first_column) * rows + row
                            w = q * value * along
                            gap[i] += w * g
                            area[i] += w
                            wrench[i, :3] -= w * f
                            wrench[i, 3:] -= w * np.cross(b - A.origin, f)
                            for node, part in on_b:
                                load[i, node] += w * part
    index = np.array([(c % ga.columns, r) for c in columns for r in range(rows)])
    flat = index[:, 0] * rows + index[:, 1]
    M = full_gram(first)
    MA = M[flat]
    gap = gap - MA @ (first.mode_normal @ A.modal) - load @ (second.mode_normal @ B.modal)
    G = MA @ dense_compliance(first) @ MA.T + load @ dense_compliance(second) @ load.T
    return Problem(index, gap, G, area, wrench, load)
