"""Two tubes pressed into each other, rotating and warm: finite elements along the radius, plane stress."""

from __future__ import annotations

from typing import Any

import numpy as np

from warpffrf.model.material import Material

NODES = 401


def tube(seat: float, other: float, material: Material, warming: float, speed: float) -> tuple[Any, Any, Any]:
    """Radii (n,), stiffness (n, n) per radian and width and loads (n,) of linear elements in plane stress between two
    diameters [m]."""
    E, nu = material.youngs_modulus, material.poisson_ratio
    D = E / (1.0 - nu**2) * np.array([[1.0, nu], [nu, 1.0]])
    r = 0.5 * np.linspace(min(seat, other), max(seat, other), NODES)
    K, f = np.zeros((NODES, NODES)), np.zeros(NODES)
    for i in range(NODES - 1):
        h, middle = r[i + 1] - r[i], 0.5 * (r[i] + r[i + 1])
        B = np.array([[-1.0 / h, 1.0 / h], [0.5 / middle, 0.5 / middle]])
        own = slice(i, i + 2)
        K[own, own] += B.T @ D @ B * middle * h
        f[own] += (B.T @ D @ [warming, warming] + 0.5 * material.density * speed**2 * middle) * middle * h
    return r, K, f


def pressed(inner: tuple[Any, Any, Any], outer: tuple[Any, Any, Any], interference: float) -> tuple[float, Any, Any]:
    """Pressure [Pa] and displacements (n,) of two tubes whose radii differ by half the interference."""
    (r, K, f), (_, L, g) = inner, outer
    n = len(r)
    both, loads = np.zeros((2 * n + 1, 2 * n + 1)), np.concatenate([f, g, [0.5 * interference]])
    both[:n, :n], both[n:-1, n:-1] = K, L
    both[-1, [n - 1, n]] = both[[n - 1, n], -1] = [-1.0, 1.0]
    u = np.linalg.solve(both, loads)
    return -u[-1] / r[-1], u[:n], u[n:-1]
