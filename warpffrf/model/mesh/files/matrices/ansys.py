"""Matrices of Ansys in its binary files .full and .emat, through ansys-mapdl-reader (extra `ansys`).

The library reads them in a process of its own, since a damaged file can end it. Rows of constrained dofs are empty in a
.full file; an .emat file has the matrices of the elements, without constraints.
"""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from warpffrf.model.errors import InputError
from warpffrf.model.files.paths import read_named
from warpffrf.model.mesh.files.matrices.formats import FileMatrix, from_triplets

SECONDS = 600.0  # for a million of dofs it takes some ten
_LOAD = """
import sys, warnings
warnings.simplefilter("ignore")
import numpy as np
from ansys.mapdl import reader
dofs, K, M = reader.read_binary(sys.argv[1]).load_km(as_sparse=True, sort=False)
A = M if sys.argv[3] == "mass" else K
A = None if A is None else A.tocoo()
found = {} if A is None else {"row": A.row, "column": A.col, "value": A.data, "dofs": dofs}
np.savez(sys.argv[2], **found)
"""

# Element matrices are full by rows, or lower triangles by rows, of which the other half is added
_ASSEMBLE = """
import sys, warnings
warnings.simplefilter("ignore")
import numpy as np
from ansys.mapdl import reader
from ansys.mapdl.reader.common import read_table
e = reader.read_binary(sys.argv[1])
with open(sys.argv[1], "rb") as f:
    f.seek(4 * int(e.header["ptrDOF"]))
    kinds = read_table(f)
wanted = "mass" if sys.argv[3] == "mass" else "stress"
row, column, value = [], [], []
for i in range(e.n_elements):
    at, found = e.read_element(i)
    A, n = found.get(wanted), len(at)
    if A is None:
        continue
    if len(A) == n * n:
        r, c = np.divmod(np.arange(n * n), n)
    elif len(A) == n * (n + 1) // 2:
        r, c = np.tril_indices(n)
        off = r != c
        r, c, A = np.r_[r, c[off]], np.r_[c, r[off]], np.r_[A, A[off]]
    else:
        raise ValueError(f"element {i + 1} has {len(A)} numbers for {n} dofs")
    row.append(at[r])
    column.append(at[c])
    value.append(A)
joined = [np.concatenate(part) if part else np.zeros(0) for part in (row, column, value)]
np.savez(
    sys.argv[2], row=joined[0], column=joined[1], value=joined[2], nodes=e.neqv, kinds=kinds,
    constraints=e.header["numCE"],
)
"""
EMAT = "write it again (EMATWRITE,YES in a modal analysis)"


def read_full(file: Path, name: str | None, role: str) -> FileMatrix:
    """The stiffness or mass matrix of a .full file. Raises `InputError` without the library, for a damaged file, and
    for one without the matrix."""
    if name is not None:
        raise InputError(f"matrix file {file.name}: a .full file has no names of matrices; choose one by role")
    parts = loaded(file, "matrix file", _LOAD, "write it again (WRFULL)", role)
    if not len(parts.get("value", ())):
        raise InputError(
            f"matrix file {file.name}: it holds no {role} matrix; write that of a modal analysis (ANTYPE,MODAL, WRFULL)"
        )
    dofs = parts["dofs"].astype(np.int64)
    rows, columns = parts["row"], parts["column"]
    if max(rows.max(), columns.max()) >= len(dofs):
        raise InputError(f"matrix file {file.name}: it has more rows than dofs; write it again (WRFULL)")
    return FileMatrix(from_triplets(rows, columns, parts["value"], len(dofs)), dofs, file.name)


def read_emat(file: Path, name: str | None, role: str) -> FileMatrix:
    """The stiffness or mass matrix of the free body, assembled from the element matrices of an .emat file. Raises
    `InputError` without the library, for a damaged file, for one without the matrix, with constraint equations within
    elements, and with other dofs than displacements and rotations."""
    if name is not None:
        raise InputError(f"matrix file {file.name}: an .emat file has no names of matrices; choose one by role")
    parts = loaded(file, "matrix file", _ASSEMBLE, EMAT, role)
    if not len(parts["value"]):
        raise InputError(f"matrix file {file.name}: its elements have no {role} matrix; {EMAT}")
    if parts["constraints"] or parts["kinds"].tolist() not in ([1, 2, 3], [1, 2, 3, 4, 5, 6]):
        what = "internal constraint equations" if parts["constraints"] else "dofs that are not UX to UZ, ROTX to ROTZ"
        raise InputError(f"matrix file {file.name}: it has {what}, which are not read; write a .full file (WRFULL)")
    width = len(parts["kinds"])
    nodes = parts["nodes"].astype(np.int64)
    dofs = np.stack([np.repeat(nodes, width), np.tile(np.arange(width), len(nodes))], axis=1)
    rows, columns = parts["row"].astype(np.int64), parts["column"].astype(np.int64)
    if not 0 <= min(rows.min(), columns.min()) <= max(rows.max(), columns.max()) < len(dofs):
        raise InputError(f"matrix file {file.name}: elements have dofs that no node has; {EMAT}")
    return FileMatrix(from_triplets(rows, columns, parts["value"], len(dofs)), dofs, file.name)


def loaded(file: Path, kind: str, script: str, cure: str, *more: str) -> dict[str, np.ndarray]:
    """The arrays that `script`, with the arguments of the file, of its output and `more`, saves of a `kind` of file.
    Raises `InputError` with the name of the file and the `cure`."""
    read_named(file, kind)
    with TemporaryDirectory() as folder:
        out = Path(folder) / "found.npz"
        command = [sys.executable, "-c", script, str(file), str(out), *more]
        try:
            done = subprocess.run(command, capture_output=True, text=True, timeout=SECONDS)
        except (subprocess.TimeoutExpired, OSError) as error:
            raise InputError(f"{kind} {file.name}: cannot be read ({error}); {cure}") from None
        if "No module named 'ansys" in done.stderr:
            raise InputError(
                f"{kind} {file.name}: reading it needs ansys-mapdl-reader; install the extra, pip install "
                "'warpffrf[ansys]', or use another format"
            )
        if done.returncode or not out.exists():
            reason = (done.stderr.strip().splitlines() or ["the reader crashes on it"])[-1][:200]
            raise InputError(f"{kind} {file.name}: cannot be read ({reason}); {cure}")
        with np.load(out) as found:
            return {key: found[key] for key in found}
