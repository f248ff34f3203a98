"""The frame on its bushings by other ways: the full finite-element model, and a rigid body on springs.

Matrices of the mesh come from the assembly that reductions use too; everything
after that (rigid mounts, springs, loads, solution) is done here, with all nodes and without modes.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import scipy.linalg as sla
import scipy.sparse as sp
from scipy.optimize import least_squares
from scipy.sparse.linalg import spsolve

import warpffrf as wf
from warpffrf.offline.fe import assemble, assign

# Mean over a rectangular facet of functions bilinear (quad4) or biquadratic (quad9) in it: Simpson's rule.
_MEAN = {"quad4": np.full(4, 0.25), "quad9": np.array([1, 1, 1, 1, 4, 4, 4, 4, 16]) / 36.0}
FFT_PADDING = 8  # times the samples: start values within an eighth of a line of the spectrum


def skew(r: np.ndarray) -> np.ndarray:
    """The matrix (3, 3) of `r x`."""
    return np.array([[0.0, -r[2], r[1]], [r[2], 0.0, -r[0]], [-r[1], r[0], 0.0]])


def static_displacement(
    mesh: wf.mesh.Mesh, material: wf.Material, mounts: Mapping[str, np.ndarray], stiffness: Sequence[float],
    gravity: np.ndarray, panel: tuple[str, Sequence[float]],
) -> np.ndarray:  # fmt: skip
    """Displacement (n, 3) [m] of all nodes of the full model at rest.

    mounts: {facet set: reference point (3,) [m]}, held rigid, each on springs `stiffness` (6,); gravity (3,) [m/s2];
    panel: a facet set and a force [N] that its nodes share equally.
    """
    K, M = assemble(mesh.points, mesh.cells, assign(mesh, material))
    n = len(mesh.points)
    f = (M @ np.tile(gravity, n)).reshape(n, 3)
    nodes = mesh.facets(panel[0]).node_set
    f[nodes] += np.asarray(panel[1]) / len(nodes)
    T, springs = _on_mounts(mesh, mounts, stiffness)
    return (T @ spsolve(sp.csc_matrix(T.T @ K @ T + springs), T.T @ f.ravel())).reshape(n, 3)


def _on_mounts(
    mesh: wf.mesh.Mesh, mounts: Mapping[str, np.ndarray], stiffness: Sequence[float]
) -> tuple[sp.csr_matrix, Any]:
    """`T` (3 n, d) from the free dofs and six of each mount to all dofs, and the springs (d, d) on the mounts."""
    n = len(mesh.points)
    held = {name: mesh.facets(name).node_set for name in mounts}
    free = np.setdiff1d(np.arange(n), np.concatenate(list(held.values())))
    dofs = (3 * free[:, None] + np.arange(3)).ravel()
    T = sp.lil_matrix((3 * n, len(dofs) + 6 * len(mounts)))
    T[dofs, np.arange(len(dofs))] = 1.0
    for m, (name, point) in enumerate(mounts.items()):
        first = len(dofs) + 6 * m
        for node in held[name]:
            T[3 * node : 3 * node + 3, first : first + 6] = np.hstack([np.eye(3), -skew(mesh.points[node] - point)])
    springs = np.concatenate([np.zeros(len(dofs)), np.tile(stiffness, len(mounts))])
    return sp.csr_matrix(T), sp.diags(springs)


def facet_mean(mesh: wf.mesh.Mesh, name: str, u: np.ndarray) -> np.ndarray:
    """Mean (3,) of displacements u (n, 3) over the equal rectangular facets of a set."""
    ((kind, nodes),) = mesh.facets(name).blocks.items()
    return np.einsum("k,fkc->c", _MEAN[kind], u[nodes]) / len(nodes)


def rigid_modes(
    mass: float, inertia: np.ndarray, arms: np.ndarray, stiffness: Sequence[float]
) -> tuple[np.ndarray, np.ndarray]:
    """Frequencies (6,) [Hz] and modes (6, 6), mass 1, of a rigid body on springs at `arms` (b, 3) [m] from its centre.

    Columns of the modes: displacement of the centre of mass and rotation.
    """
    K = np.zeros((6, 6))
    for r in arms:
        R = np.block([[np.eye(3), -skew(r)], [np.zeros((3, 3)), np.eye(3)]])
        K += R.T @ np.diag(stiffness) @ R
    values, modes = sla.eigh(K, sla.block_diag(mass * np.eye(3), inertia))
    return np.sqrt(values) / (2.0 * np.pi), modes


def fitted_frequency(t: np.ndarray, q: np.ndarray) -> float:
    """Frequency [Hz] of the cosine nearest to samples q (T,) at equally spaced times t (T,) [s], by least squares.

    Starts from the largest line of the spectrum.
    """
    count = FFT_PADDING * len(t)
    line = int(np.argmax(np.abs(np.fft.rfft(q * np.hanning(len(t)), count))))
    start = 2.0 * np.pi * line / (count * (t[1] - t[0]))
    size = float(np.abs(q).max())

    def left(x: np.ndarray) -> np.ndarray:
        return x[1] * np.cos(x[0] * start * t) + x[2] * np.sin(x[0] * start * t) - q / size

    return float(least_squares(left, (1.0, 0.5, 0.5), xtol=1e-14, ftol=1e-14).x[0] * start / (2.0 * np.pi))
