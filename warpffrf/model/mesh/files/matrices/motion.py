r"""The test of the order of nodes and dofs: rigid motion, which costs no energy and carries the whole mass.

With R (3 n, 6) the rigid motions of the nodes, `K R = 0`; each row of K R is a sum that must cancel, so it is compared
with the sum of its magnitudes, `|K R|_r <= RIGID (|K| |R|)_r`. Nodes or components in another order than the rows break
it: translations see exchanged components, rotations exchanged nodes too. The mass of a body is the same in the three
directions, `R_t^T M R_t = m I`. An M whose nodes have another order than those of K shows in entries that couple nodes
which K does not couple; a lumped M tells nothing of that kind.

Neither test sees a wrong unit of length: lengths and stiffnesses together are judged by `plausibility`.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from warpffrf.model.errors import InputError
from warpffrf.model.mesh.rigid import rigid_modes

RIGID = 1e-5  # of the sum of magnitudes: coordinates written with six digits; a wrong order gives 1e-3 to 1
RIGID_NOTE = 1e-9  # above it the body is told to come from rounded files: double precision leaves 1e-12
SAME_MASS = 1e-6  # of the mass: matrices in single precision sum to it
FOREIGN = 0.1  # of M's couplings may lie where K has none: exact zeros of K are few, a wrong order makes nearly all
USUAL_DENSITY = (10.0, 3e4)  # kg/m3 of mass over bounding box: foams to heavy metals; thin rings fill little of it
USUAL_SPEED = (30.0, 3e5)  # m/s, rubber to diamond, and what the estimate of the node distance leaves open
NAMES = (
    "translation along x",
    "translation along y",
    "translation along z",
    "rotation about x",
    "rotation about y",
    "rotation about z",
)


def require_free(K: Any, M: Any, points: np.ndarray) -> float:
    """Largest residual of K R (see above). Raises `InputError` above `RIGID`, naming the motion and the nodes."""
    R = rigid_modes(points, points.mean(axis=0))
    residual = _relative(K, R)
    worst = float(residual.max())
    if not worst > RIGID:
        return worst
    if float(_relative(M, R).max()) <= RIGID:
        raise InputError(
            "M and K look exchanged: M vanishes for rigid motions and K does not; call from_matrices(M, K)"
        )
    motion = int(np.argmax(residual.max(axis=0) > RIGID))  # translations first: they say more
    bad = np.unique(np.flatnonzero(residual[:, motion] > RIGID) // 3)
    raise InputError(
        f"K does not vanish for a rigid {NAMES[motion]}: residual {residual[:, motion].max():.2g} of the sum of "
        f"magnitudes, allowed {RIGID:g}, at {len(bad)} of {len(points)} nodes, the first is number {bad[0]}; the "
        "order of nodes or dofs does not match the matrices (nodes, dof_map, node_numbers), or the model is held by "
        "supports or springs"
    )


def require_mass(M: Any, points: np.ndarray) -> float:
    """Total mass [kg]. Raises `InputError` where it is not positive or not the same in the three directions."""
    R = rigid_modes(points, points.mean(axis=0))[:, :3]
    m = R.T @ (M @ R)
    mass = float(np.trace(m)) / 3.0
    if not mass > 0.0:
        raise InputError(f"M is not positive: the total mass is {mass:.3g}; export it again")
    if float(np.max(np.abs(m - mass * np.eye(3)))) > SAME_MASS * mass:
        text = ", ".join(f"{x:.6g}" for x in np.diag(m))
        raise InputError(
            f"M: the mass along x, y, z is {text} kg, it must be the same and uncoupled; the order of dofs does not "
            "match (dof_map), or dofs are missing"
        )
    return mass


def require_one_body(K: Any, M: Any) -> None:
    """Raise `InputError` where K falls apart into several bodies, or M couples nodes that K does not."""
    import scipy.sparse as sp
    from scipy.sparse.csgraph import connected_components

    stiff, heavy = _couplings(K), _couplings(M)
    count, label = connected_components(stiff, directed=False)
    if count > 1:
        sizes = ", ".join(str(n) for n in np.sort(np.bincount(label))[::-1][:5])
        raise InputError(
            f"K falls apart into {count} bodies, the largest of {sizes} nodes; a body is one part: export one, or "
            "leave out nodes without elements"
        )
    foreign = heavy - heavy.multiply(stiff)
    off_diagonal = heavy.nnz - heavy.shape[0]
    share = sp.csr_matrix(foreign).count_nonzero() / max(off_diagonal, 1)
    if share > FOREIGN:
        raise InputError(
            f"M couples nodes that K does not ({100 * share:.0f} % of its couplings); the nodes of M and K have "
            "different orders: export both from one run"
        )


def plausibility(K: Any, M: Any, points: np.ndarray, mass: float) -> list[str]:
    """Warnings where mass, size and stiffness look wrong together; empty where they do not.

    Density over the bounding box, and the speed `h sqrt(trace K / trace M)` over the typical distance `h = (box/n)^1/3`
    of nodes: of the order of the speed of sound, within a factor of ten on graded meshes and thin bodies.
    """
    box = float(np.prod(np.ptp(points, axis=0)))
    if not box > 0.0:
        return []
    density = mass / box
    speed = (box / len(points)) ** (1.0 / 3.0) * float(np.sqrt(K.diagonal().sum() / M.diagonal().sum()))
    found = []
    if not USUAL_DENSITY[0] <= density <= USUAL_DENSITY[1]:
        found.append(f"mass over bounding box is {density:.3g} kg/m3: are length_unit and matrix_units right?")
    if not USUAL_SPEED[0] <= speed <= USUAL_SPEED[1]:
        found.append(f"waves would run at about {speed:.2g} m/s: are length_unit and matrix_units right?")
    return found


def _relative(A: Any, R: np.ndarray) -> np.ndarray:
    """|A R| over |A| |R|, zero where both vanish."""
    scale = abs(A) @ np.abs(R)
    value = np.abs(A @ R)
    return np.divide(value, scale, out=np.zeros_like(value), where=scale > 0.0)


def _couplings(A: Any) -> Any:
    """Which nodes A couples: csr (n, n) of ones."""
    import scipy.sparse as sp

    entries = sp.coo_matrix(A)
    n = A.shape[0] // 3
    nodes = sp.coo_matrix((np.ones(entries.nnz), (entries.row // 3, entries.col // 3)), shape=(n, n)).tocsr()
    nodes.data = np.ones_like(nodes.data)
    return nodes
