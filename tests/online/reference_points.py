"""The contact problem of two surfaces of any shape in plain NumPy: every point of every cell, nodes as functions.

Written from the equations (module docstring of `at_points`), not from the kernels: points are built in the world
and looked at from B with the shape's own chart.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from reference_contact import Pose, Problem, full_gram, gauss, nodes_along
from scipy.optimize import minimize_scalar

SWEEPS = 4  # over column and z: they hardly depend on each other


def around(grid: Any, x: float) -> list[tuple[int, float]]:
    """(column, value) of the nodes at the grid coordinate x: wrapped around a turn, none beyond the ends of an arc."""
    j = int(np.floor(x))
    both = [(j, 1.0 - (x - j)), (j + 1, x - j)]
    if grid.periodic:
        return [(c % grid.columns, v) for c, v in both]
    return [(c, v) for c, v in both if 0 <= c < grid.columns]


def surface_point(shape: Any, grid: Any, theta: float, z: float) -> tuple[np.ndarray, np.ndarray, float, np.ndarray]:
    """Point [m], unit normal away from the material, area per dtheta dz [m], and the direction around the axis (zero of
    a plane), user frame."""
    if shape.profile().planar:
        return shape.axis_point + theta * shape.e_1 + z * shape.e_a, shape.e_0, 1.0, np.zeros(3)
    R, slope = float(shape.radius_at(z)), float(shape.slope_at(z))
    e_r = np.cos(theta) * grid.e_0 + np.sin(theta) * np.cross(shape.e_a, grid.e_0)
    stretch = np.sqrt(1.0 + slope**2)
    normal = shape.profile().side * (e_r - slope * shape.e_a) / stretch
    return shape.axis_point + z * shape.e_a + R * e_r, normal, R * stretch, np.cross(shape.e_a, e_r)


def opposite(surface: Any, x: np.ndarray) -> tuple[float, float, float, np.ndarray]:
    """theta counted from the grid's e_0, z, the signed distance, and the normal at the foot, of a point x (3,) in the
    user frame of B."""
    theta, z, distance = (float(v) for v in surface.shape.chart(x))
    normal = surface.shape.normal(theta, z)
    if surface.grid is not None and not surface.shape.profile().planar:
        local = x - surface.shape.axis_point
        theta = float(np.arctan2(local @ np.cross(surface.shape.e_a, surface.grid.e_0), local @ surface.grid.e_0))
    return theta, z, distance, normal


def skew(a: np.ndarray) -> np.ndarray:
    """The matrix of a x."""
    return np.array([[0.0, -a[2], a[1]], [a[2], 0.0, -a[0]], [-a[1], a[0], 0.0]])


def normal_slope(surface: Any, B: Pose, x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Normal of B at the foot of the point x [m, world], and its derivative by x [1/m]: principal curvatures kappa of
    the parallel surface, kappa/(1 + kappa d)."""
    shape = surface.shape
    theta, z, d = (float(v) for v in shape.chart(B.rotation.T @ (x - B.origin)))
    n = B.rotation @ shape.normal(theta, z)
    H = np.zeros((3, 3))
    tangents = (shape.around(np.array(theta)), shape.along(np.array(theta), np.array(z)))
    for tangent, kappa in zip(tangents, shape.curvatures(np.array(theta), np.array(z)), strict=True):
        b = B.rotation @ np.asarray(tangent).reshape(3)
        H += float(kappa) / (1.0 + float(kappa) * d) * np.outer(b, b)
    return n, H


def contact_frame(first: Any, second: Any, A: Pose, B: Pose, column: float, z: float) -> tuple[np.ndarray, np.ndarray]:
    """How a point of A's section z held in the frame of the contact is rotated about A's axis (of a sphere: its centre)
    by the motion of A against B: (n, 3) by translations and (n, 3) by turns about A's user origin, one line an axis of
    turning that leaves A where it is (all three of a sphere), world axes; and these axes (n, 3)."""
    shape = first.shape
    profile = shape.profile()
    if profile.planar:
        return np.zeros((0, 6)), np.zeros((0, 3))
    center = A.origin + A.rotation @ shape.axis_point
    if profile.crown == profile.radius and not len(profile.coefficients):
        n, H = normal_slope(second, B, center)
        e = -n
        by = np.zeros((3, 6))
        by[:, :3] = -np.cross(e, H.T).T  # -e x H tau
        if not second.shape.profile().planar:
            axis = B.rotation @ second.shape.e_a
            out = center - (B.origin + B.rotation @ second.shape.axis_point)
            radial = out - (out @ axis) * axis
            by[:, :3] += np.outer(e, np.cross(axis, radial)) * (e @ axis) / (radial @ radial)
        by[:, 3:] = -np.eye(3) + by[:, :3] @ -skew(center - A.origin)
        return by, np.eye(3)
    g = first.grid
    x, _, _, around = surface_point(shape, g, g.theta_start + column * g.pitch, z)
    x, around, axis = A.origin + A.rotation @ x, A.rotation @ around, A.rotation @ shape.e_a
    n, H = normal_slope(second, B, x)
    arm = x - center
    outward = arm - (arm @ axis) * axis
    N = around @ H @ around * np.linalg.norm(outward) - n @ outward / np.linalg.norm(outward)
    by = np.zeros((1, 6))
    by[0, :3] = -H @ around / N
    # h changes by (H (w x (x - O_A))).e + n.(w x e)
    by[0, 3:] = -(np.cross(x - A.origin, H @ around) + np.cross(around, n)) / N
    return by, axis[None]


def nearest_place(first: Any, second: Any, A: Pose, B: Pose) -> np.ndarray:
    """Column and z [m] of the smallest gap of the whole grid."""
    grid = first.grid

    def gap(place: np.ndarray) -> float:
        x = surface_point(first.shape, grid, grid.theta_start + place[0] * grid.pitch, float(place[1]))[0]
        return float(second.shape.chart(B.rotation.T @ (A.origin + A.rotation @ x - B.origin))[2])

    looks = [np.array([c, z]) for c in np.arange(0, grid.columns, 0.5) for z in np.linspace(grid.z[0], grid.z[-1], 9)]
    best = min(looks, key=gap)
    for _ in range(SWEEPS):  # in turn, each to round-off of a minimum
        for i, (low, high) in enumerate(((best[0] - 1.0, best[0] + 1.0), (grid.z[0], grid.z[-1]))):

            def along(value: float, axis: int = i, at: np.ndarray = best) -> float:
                return gap(np.where(np.arange(2) == axis, value, at))

            found: Any = minimize_scalar(along, bounds=(low, high), method="bounded", options={"xatol": 1e-12})
            if found.fun < gap(best):
                best = np.where(np.arange(2) == i, found.x, best)
    return best


def point_problem(
    first: Any,
    second: Any,
    A: Pose,
    B: Pose,
    columns: np.ndarray,
    place: np.ndarray | None = None,
    *,
    theta_points: int,
    z_points: int,
) -> Problem:
    """The problem on the nodes of the grid `columns` (consecutive, not wrapped) of the surface `first`, nearest at
    `place` (column, z), looked for where not given; `second` may be rigid. `load` has no columns then. `wrench` about
    A's user origin."""
    place = nearest_place(first, second, A, B) if place is None else place
    center = A.origin + A.rotation @ first.shape.axis_point
    ga, gb = first.grid, second.grid
    rows, n, first_column = ga.rows, len(columns) * ga.rows, int(columns[0])
    gap, area, wrench = np.zeros(n), np.zeros(n), np.zeros((n, 6))
    load = np.zeros((n, 0 if gb is None else gb.columns * gb.rows))
    (xt, wt), (xz, wz) = gauss(theta_points), gauss(z_points)
    for j in range(first_column - 1, first_column + len(columns)):
        for k in range(rows - 1):
            for qt in range(theta_points):
                for qz in range(z_points):
                    dz = ga.z[k + 1] - ga.z[k]
                    z = ga.z[k] + xz[qz] * dz
                    theta = ga.theta_start + (j + xt[qt]) * ga.pitch
                    x, _, measure, _ = surface_point(first.shape, ga, theta, z)
                    x = A.origin + A.rotation @ x
                    theta_b, z_b, distance, normal = opposite(second, B.rotation.T @ (x - B.origin))
                    f = B.rotation @ normal
                    unit = np.concatenate([f, np.cross(x - A.origin, f)])
                    by, axes = contact_frame(first, second, A, B, float(place[0]), z)
                    unit += (axes @ np.cross(x - center, f)) @ by
                    on_b = []
                    if gb is not None:
                        if not gb.z[0] <= z_b <= gb.z[-1]:
                            continue
                        x_b = (theta_b - gb.theta_start) / gb.pitch
                        if not second.shape.profile().planar:
                            turn = 2.0 * np.pi / gb.pitch
                            middle = 0.5 * (gb.columns - 1)
                            x_b = (x_b - middle + 0.5 * turn) % turn - 0.5 * turn + middle
                        if not gb.periodic and not -1.0 <= x_b <= gb.columns:
                            continue
                        on_b = [(c * gb.rows + r, v * u) for c, v in around(gb, x_b) for r, u in nodes_along(gb.z, z_b)]
                    q = wt[qt] * ga.pitch * wz[qz] * dz * measure
                    for column, value in ((j, 1.0 - xt[qt]), (j + 1, xt[qt])):
                        if not 0 <= column - first_column < len(columns):
                            continue
                        if not ga.periodic and not 0 <= column < ga.columns:
                            continue
                        for row, along in ((k, 1.0 - xz[qz]), (k + 1, xz[qz])):
                            i = (column - first_column) * rows + row
                            w = q * value * along
                            gap[i] += w * distance
                            area[i] += w
                            wrench[i] += w * unit
                            for node, part in on_b:
                                load[i, node] += w * part
    index = np.array([(c % ga.columns if ga.periodic else c, r) for c in columns for r in range(rows)])
    inside = (index[:, 0] >= 0) & (index[:, 0] < ga.columns)
    flat = np.where(inside, index[:, 0] * rows + index[:, 1], 0)
    MA = full_gram(first)[flat] * inside[:, None]
    gap = gap - MA @ (first.mode_normal @ A.modal)
    G = MA @ first.compliance(np.arange(ga.columns)) @ MA.T
    if gb is not None:
        gap -= load @ (second.mode_normal @ B.modal)
        G += load @ second.compliance(np.arange(gb.columns)) @ load.T
    return Problem(index, gap, G, area, wrench, load)
