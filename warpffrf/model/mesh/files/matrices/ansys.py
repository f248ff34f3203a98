"""Matrices of Ansys in its binary .full file, through ansys-mapdl-reader (extra `ansys`).

The library reads them in a process of its own, since a damaged file can end it. Rows of constrained dofs are empty.
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


def read_full(file: Path, name: str | None, role: str) -> FileMatrix:
    """The stiffness or mass matrix of a .full file. Raises `InputError` without the library, for a damaged file, and
    for one without the matrix."""
    if name is not None:
        raise InputError(f"matrix file {file.name}: a .full file has no names of matrices; choose one by role")
    read_named(file, "matrix file")
    with TemporaryDirectory() as folder:
        out = Path(folder) / "matrix.npz"
        command = [sys.executable, "-c", _LOAD, str(file), str(out), role]
        try:
            done = subprocess.run(command, capture_output=True, text=True, timeout=SECONDS)
        except (subprocess.TimeoutExpired, OSError) as error:
            raise InputError(f"matrix file {file.name}: cannot be read ({error}); write it again (WRFULL)") from None
        if "No module named 'ansys" in done.stderr:
            raise InputError(
                f"matrix file {file.name}: reading it needs ansys-mapdl-reader; install the extra, pip install "
                "'warpffrf[ansys]', or export Matrix Market"
            )
        if done.returncode or not out.exists():
            reason = (done.stderr.strip().splitlines() or ["the reader crashes on it"])[-1][:200]
            raise InputError(f"matrix file {file.name}: cannot be read ({reason}); write it again (WRFULL)")
        with np.load(out) as found:
            parts = {key: found[key] for key in found}
    if not len(parts.get("value", ())):
        raise InputError(
            f"matrix file {file.name}: it holds no {role} matrix; write that of a modal analysis (ANTYPE,MODAL, WRFULL)"
        )
    dofs = parts["dofs"].astype(np.int64)
    rows, columns = parts["row"], parts["column"]
    if max(rows.max(), columns.max()) >= len(dofs):
        raise InputError(f"matrix file {file.name}: it has more rows than dofs; write it again (WRFULL)")
    return FileMatrix(from_triplets(rows, columns, parts["value"], len(dofs)), dofs, file.name)
