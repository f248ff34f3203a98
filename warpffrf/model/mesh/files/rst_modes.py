"""Mode shapes of Ansys in the result file .rst of a modal analysis, through ansys-mapdl-reader (extra `ansys`)."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from warpffrf.model.errors import InputError
from warpffrf.model.mesh.files.matrices.ansys import loaded
from warpffrf.model.mesh.files.raw_mesh import places
from warpffrf.model.mesh.files.unv_modes import KIND, ShapesRead

MODAL = 2  # analysis type of the file's header
TRANSLATIONS = ["UX", "UY", "UZ"]
CURE = "write it again (ANTYPE,MODAL, MXPAND)"
_LOAD = """
import sys, warnings
warnings.simplefilter("ignore")
import numpy as np
from ansys.mapdl import reader
r = reader.read_binary(sys.argv[1])
head = r._resultheader
steps = range(r.n_results)
solutions = [r.nodal_solution(i) for i in steps]
np.savez(
    sys.argv[2], kind=type(r).__name__, analysis=head["kan"], is_complex=head.get("cpxrst", 0),
    dofs=np.array([str(name) for name in r.result_dof(0)]) if len(steps) else [],
    frequencies=r.time_values[: len(steps)], places=r.mesh.nnum, points=r.mesh.nodes[:, :3],
    numbers=solutions[0][0] if len(steps) else [], shapes=np.array([u[:, :3] for _, u in solutions]),
    skin=r.grid.extract_surface(nonlinear_subdivision=0)["ansys_node_num"],
)
"""


def read_rst(path: Path) -> ShapesRead:
    """Corner nodes of the surface and mode shapes of a modal analysis, in global axes. Raises `InputError`
    without the library, for damaged files, other analyses, complex modes, sectors, and shells without translations."""
    found = loaded(path, KIND, _LOAD, CURE)
    why = {
        "it is of no modal analysis": found["analysis"] != MODAL,
        "its modes are those of a sector, or distributed": found["kind"] != "Result",
        "its modes are complex": found["is_complex"] != 0,
        "it holds no modes": not len(found["frequencies"]),
        "its nodes have no three translations": found["dofs"][:3].tolist() != TRANSLATIONS,
    }
    for reason, applies in why.items():
        if applies:
            raise InputError(f"{KIND} {path.name}: {reason}; {CURE}")
    numbers, shapes = found["numbers"].astype(np.int64), found["shapes"]
    at = places(found["places"].astype(np.int64), numbers)
    used = np.all(np.isfinite(shapes), axis=(0, 2)) & (at >= 0) & np.isin(numbers, found["skin"])
    if not used.any():
        raise InputError(f"{KIND} {path.name}: no node of its surface has a motion in all modes; {CURE}")
    notes = (
        "an .rst file states no damping ratios",
        f"used are {np.sum(used)} of {len(used)} nodes, the corners of elements on the surface",
    )
    count = len(shapes)
    return ShapesRead(
        numbers[used], found["points"][at[used]], found["frequencies"], np.zeros(count), shapes[:, used], notes
    )
