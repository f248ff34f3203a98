r"""Are the traces of the hats independent on the surface mesh?

`C = (B psi)^T G (B psi)` is definite only if no combination of hats loads the mesh with nothing: a contact grid finer
than the mesh makes it semidefinite (an eigenvalue ratio of -1.5e-16 was met, with a wrong contact force). Eigenvalues
of a window of C tell, at far less cost than C of the whole grid: a grid finer by a fraction e becomes dependent in a
window of about 2/e columns. Finer grids by less than that are caught by counting: more hats than surface nodes cannot
be independent.
"""

from __future__ import annotations

import numpy as np

from warpffrf.model.errors import InputError

# Smallest over largest eigenvalue of C on a window. Nodal grids have 1e-3 to 1e-6 (rows much longer than columns
# lower it), a grid twice as fine as the mesh 1e-16 or less; in between the pressure oscillates but the solution is
# unique.
INDEPENDENCE = 1e-10

WINDOW_COLUMNS = 24  # finds a grid finer by 10 %
WINDOW_HATS = 600  # at most, whole columns and 7 of them at least: the eigenvalues of the window take 0.1 s
LEAST_COLUMNS = 7


def window_columns(columns: int, rows: int) -> int:
    """Number of neighbouring columns that are judged."""
    return min(columns, max(LEAST_COLUMNS, min(WINDOW_COLUMNS, WINDOW_HATS // rows)))


def eigenvalue_ratio(window: np.ndarray) -> float:
    """Smallest over largest eigenvalue of the symmetric `window` (h, h)."""
    values = np.linalg.eigvalsh(0.5 * (window + window.T))
    return float(values[0] / values[-1]) if values[-1] > 0.0 else -1.0


def check_independence(window: np.ndarray, name: str, edge: float, hats: int, nodes: int) -> float:
    """The eigenvalue ratio; raises `InputError` below `INDEPENDENCE`, or with more `hats` than surface `nodes`.

    `edge` is the longest facet edge [m], named as the cure.
    """
    ratio = eigenvalue_ratio(window)
    cure = f"use traction_spacing >= {edge:.3g} m, or a finer mesh"
    if hats > nodes:
        raise InputError(
            f"contact {name!r}: contact grid finer than the surface mesh ({hats} hats on {nodes} surface nodes); {cure}"
        )
    if not ratio > INDEPENDENCE:
        raise InputError(
            f"contact {name!r}: contact grid finer than the surface mesh (eigenvalue ratio {ratio:.2g} of a "
            f"window, at least {INDEPENDENCE:g} is needed); {cure}"
        )
    return ratio
