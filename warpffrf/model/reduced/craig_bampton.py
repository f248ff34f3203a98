r"""Craig-Bampton matrices of a reduced body: stiffness and mass over the motions of its interfaces and fixed-interface
modes, for other programs (Craig, Bampton 1968, AIAA Journal 6, 1313).

A reduced body has rigid motions about its centre of mass c and modes orthogonal to them: over x = (d, theta, q)

    M_x = diag(m 1, J, 1),      K_x = diag(0, 0, omega^2),      u = B x,

u (6 per interface) translation and rotation at its point p: `d + theta x (p - c) + sum_k q_k phi_k` and `theta + ...`.
With N a basis of the null space of B and X any solution of B X = 1,

    Psi = X - N (N^T K_x N)^-1 N^T K_x X              constraint modes: the least energy at given u
    N^T K_x N v = lambda N^T M_x N v,  Phi = N V      fixed-interface modes

x = Psi u + Phi eta exactly, since (Psi, Phi) is square: nothing is lost, and free frequencies remain those of the body.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from warpffrf.model.errors import InputError
from warpffrf.model.files.paths import check_ending, checked_output_path, written_whole

Array = np.ndarray
COMPONENTS = ("x", "y", "z", "rx", "ry", "rz")
RANK = 1e-9  # of the largest singular value of B, rotations scaled by the body's size
NAMES = {"KAAX": "stiffness", "MAAX": "mass"}  # of the matrices in files, as superelements of Nastran have them


@dataclass(frozen=True, eq=False)
class CraigBampton:
    """Matrices (n, n) in SI units over the interfaces, six coordinates each, then modal ones of modal mass 1 kg.

    `coordinates` (n,) names them: "bore x" to "bore rz", translations [m] and rotations [rad] at the interface's point
    in user axes, then "mode 0", ... `frequencies` [Hz] are those of the body with all interfaces clamped.
    """

    stiffness: Array
    mass: Array
    coordinates: tuple[str, ...]
    frequencies: Array

    def to_op4(self, path: str | Path) -> Path:
        """Write KAAX and MAAX to a binary OUTPUT4 file of Nastran, in double precision; returns the path. Raises
        `InputError` without pyYeti (extra `matrices`), and for a file that exists."""
        check_ending(path, "to_op4", (".op4",))
        target = checked_output_path(path, "to_op4", overwrite=False)
        try:
            from pyyeti.nastran import op4
        except ImportError:
            raise InputError(
                "to_op4: writing OUTPUT4 needs pyYeti; pip install 'warpffrf[matrices]', or use to_mtx"
            ) from None
        with written_whole(target) as partial:
            op4.write(str(partial), {name: getattr(self, role) for name, role in NAMES.items()}, forms=6)
        return target

    def to_mtx(self, stiffness: str | Path, mass: str | Path, *, overwrite: bool = False) -> tuple[Path, Path]:
        """Write the `stiffness` and the `mass` to two Matrix Market files of these names, all digits, with the
        coordinates as comments; returns both paths. Raises `InputError` for files that exist, unless `overwrite` is
        set and warpffrf wrote them."""
        from scipy.io import mmwrite

        found = []
        for path, role in ((stiffness, "stiffness"), (mass, "mass")):
            check_ending(path, "to_mtx", (".mtx",))
            target = checked_output_path(path, "to_mtx", overwrite=overwrite)
            lines = [f"written by warpffrf: Craig-Bampton {role}, SI units", *self.coordinates]
            with written_whole(target) as partial, open(partial, "wb") as stream:
                mmwrite(stream, getattr(self, role), comment="\n".join(lines), precision=17, symmetry="symmetric")
            found.append(target)
        return found[0], found[1]


def craig_bampton(body: Any) -> CraigBampton:
    """See `ReducedBody.craig_bampton`."""
    if not body.interfaces:
        raise InputError("craig_bampton: the body has no interfaces; give them in reduce(interfaces=)")
    count = len(body.frequencies)
    omega = 2.0 * np.pi * body.frequencies
    K = np.diag(np.concatenate([np.zeros(6), omega**2]))
    M = np.zeros((6 + count, 6 + count))
    M[:3, :3], M[3:6, 3:6], M[6:, 6:] = body.mass * np.eye(3), body.inertia, np.eye(count)
    B = np.concatenate([_motion(body, interface) for interface in body.interfaces.values()])
    size = np.sqrt(np.trace(body.inertia) / body.mass)  # m: makes rotations and translations comparable
    scale = np.tile(np.repeat([1.0, size], 3), len(body.interfaces))
    _, s, Vt = np.linalg.svd(scale[:, None] * B / np.sqrt(np.diag(M)))
    rank = int(np.sum(s > RANK * s[0]))
    if rank < len(B):
        raise InputError(
            f"craig_bampton: the {count} modes and 6 rigid motions allow {rank} independent motions of the "
            f"{len(body.interfaces)} interfaces, {len(B)} are needed; reduce with more modes, or with fewer interfaces"
        )
    root = 1.0 / np.sqrt(np.diag(M))
    N = root[:, None] * Vt[rank:].T
    X = root[:, None] * np.linalg.pinv(B * root)
    k, m = N.T @ K @ N, N.T @ M @ N
    Psi = X - N @ np.linalg.solve(k, N.T @ K @ X)
    import scipy.linalg

    values, V = scipy.linalg.eigh(k, m)
    T = np.concatenate([Psi, N @ V], axis=1)
    stiffness, mass = (0.5 * (A + A.T) for A in (T.T @ K @ T, T.T @ M @ T))
    own = slice(len(B), None)
    stiffness[own, : len(B)] = stiffness[: len(B), own] = 0.0  # zero but for round-off
    stiffness[own, own], mass[own, own] = np.diag(values), np.eye(len(values))
    names = [f"{name} {component}" for name in body.interfaces for component in COMPONENTS]
    names += [f"mode {i}" for i in range(len(values))]
    return CraigBampton(stiffness, mass, tuple(names), np.sqrt(np.maximum(values, 0.0)) / (2.0 * np.pi))


def _motion(body: Any, interface: Any) -> Array:
    """Translation and rotation (6, 6 + m) of an interface per rigid motion and mode."""
    a, b, c = interface.point - body.center_of_mass
    B = np.zeros((6, 6 + len(body.frequencies)))
    B[:, :6] = np.eye(6)
    B[:3, 3:6] = [[0.0, c, -b], [-c, 0.0, a], [b, -a, 0.0]]  # theta x r
    B[:, 6:] = interface.modes.T
    return B
