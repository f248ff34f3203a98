"""VTK's legacy files of unstructured grids (.vtk), versions 1 to 5, as text or binary: a strict reader.

meshio reads 32-bit integers of binary files as 64-bit ones, drops unsupported cells and has no sets of `SCALARS`. Here
each table has as many numbers as its heading declares (VTK file formats, vtk.org).
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from warpffrf.model.mesh.files.raw_mesh import RawMesh
from warpffrf.model.mesh.files.vtk_cells import Fault, guarded, numbers, raw_mesh, whole

Array = np.ndarray

DTYPES = {
    "bit": "", "char": "i1", "signed_char": "i1", "unsigned_char": "u1", "short": "i2", "unsigned_short": "u2",
    "int": "i4", "unsigned_int": "u4", "long": "i8", "unsigned_long": "u8", "vtktypeint64": "i8",
    "vtktypeuint64": "u8", "vtkidtype": "i4", "float": "f4", "double": "f8",
}  # fmt: skip
SHOWN = 60  # characters of a bad line in a message
_WIDTHS = {"VECTORS": 3, "NORMALS": 3, "TENSORS": 9, "TENSORS6": 6}


class _Scanner:
    """The content of a file from `at` on."""

    def __init__(self, content: bytes) -> None:
        self.content, self.at = content, 0
        head = self.line(), self.line(), self.line().strip().upper()
        if not head[0].startswith(b"# vtk DataFile Version ") or head[2] not in (b"ASCII", b"BINARY"):
            raise Fault("its first line is not that of a VTK file")
        self.binary = head[2] == b"BINARY"

    def line(self) -> bytes:
        end = self.content.find(b"\n", self.at)
        end = len(self.content) if end < 0 else end
        found = self.content[self.at : end]
        self.at = end + 1
        return found

    def words(self) -> list[str]:
        """The words of the next nonempty line; none at the end."""
        while self.at < len(self.content):
            words = self.line().decode("latin-1").split()
            if words:
                return words
        return []

    def table(self, count: int, kind: str, what: str) -> Array:
        """`count` numbers of the type that VTK calls `kind`."""
        name = DTYPES.get(kind.lower())
        if name is None:
            raise Fault(f"{what} is of type {kind[:SHOWN]!r}")
        if not 0 <= count <= 8 * len(self.content):
            raise Fault(f"{what} has {count} numbers, more than fit into the file")
        if self.binary:
            size = -(-count // 8) if not name else count * np.dtype(name).itemsize
            data = self.content[self.at : self.at + size]
            if len(data) < size:
                raise Fault(f"{what} ends too early")
            self.at += size
            if not name:
                return np.unpackbits(np.frombuffer(data, np.uint8))[:count].astype(np.int64)
            return np.frombuffer(data, ">" + name).astype(name)
        words: list[bytes] = []
        while len(words) < count:
            if self.at >= len(self.content):
                raise Fault(f"{what} has {len(words)} numbers, not {count}")
            words += self.line().split()
        if len(words) > count:
            raise Fault(f"{what} has more than {count} numbers")
        return numbers(words, name.startswith("f"), what)


def read_vtk(path: Path) -> RawMesh:
    """Contents of a .vtk file; raises as `guarded` does."""
    return guarded(path, _read, "save it as .vtu")


def _read(label: str, content: bytes) -> RawMesh:
    scan = _Scanner(content)
    found: dict[str, Array] = {}
    arrays: dict[str, Array] = {}
    unused: list[str] = []
    where, count = "", 0  # CELL_DATA or POINT_DATA, and of how many
    words = scan.words()
    if [w.upper() for w in words] != ["DATASET", "UNSTRUCTURED_GRID"]:
        raise Fault("its DATASET is no UNSTRUCTURED_GRID")
    while words := scan.words():
        key = words[0].upper()
        if key == "POINTS" and len(words) == 3 and key not in found:
            found[key] = scan.table(3 * whole(words[1], "points"), words[2], "the table of points").astype(float)
        elif key == "CELLS" and len(words) == 3 and "ends" not in found:
            found["nodes"], found["ends"] = _cells(scan, whole(words[1], "cells"), whole(words[2], "cells"))
        elif key == "CELL_TYPES" and len(words) == 2 and key not in found:
            found[key] = scan.table(whole(words[1], "types"), "int", "the table of types").astype(np.int64)
        elif key in ("CELL_DATA", "POINT_DATA") and len(words) == 2:
            where, count = key, whole(words[1], "data")
            if where == "CELL_DATA" and count != len(found.get("ends", ())):
                raise Fault(f"it has data of {count} cells and {len(found.get('ends', ()))} cells")
        elif key == "METADATA":
            _metadata(scan)
        elif key == "FIELD" and len(words) == 3:
            for _ in range(whole(words[2], "arrays")):
                head = scan.words()
                while head and head[0].upper() == "METADATA":
                    _metadata(scan)
                    head = scan.words()
                if len(head) != 4:
                    raise Fault("an array of a field has no name, sizes and type")
                width, length = whole(head[1], "components"), whole(head[2], "entries")
                if head[3].lower() == "string":
                    raise Fault("arrays of text are not read")
                values = scan.table(width * length, head[3], f"array {head[0][:SHOWN]!r}")
                _keep(arrays, unused, where, count, head[0], values, width)
        elif where and key in ("SCALARS", *_WIDTHS, "COLOR_SCALARS", "TEXTURE_COORDINATES", "LOOKUP_TABLE",
                               "GLOBAL_IDS", "PEDIGREE_IDS"):  # fmt: skip
            _attribute(scan, key, words, arrays, unused, where, count)
        else:
            raise Fault(f"{' '.join(words)[:SHOWN]!r} is not supported")
    if not {"POINTS", "nodes", "CELL_TYPES"} <= set(found):
        raise Fault("POINTS, CELLS or CELL_TYPES is missing")
    if not np.isfinite(found["POINTS"]).all():
        raise Fault("a coordinate of a point is not finite")
    points = found["POINTS"].reshape(-1, 3)
    return raw_mesh(label, points, found["nodes"], found["ends"], found["CELL_TYPES"], arrays, unused)


def _cells(scan: _Scanner, first: int, second: int) -> tuple[Array, Array]:
    """Concatenated nodes of the cells, and where each ends: version 5 has two tables, older ones a count before
    the nodes of each cell."""
    begin = scan.at
    words = scan.words()
    if words and words[0].upper() == "OFFSETS" and len(words) == 2:
        offsets = scan.table(first, words[1], "the table of offsets").astype(np.int64)
        words = scan.words()
        if len(words) != 2 or words[0].upper() != "CONNECTIVITY":
            raise Fault("OFFSETS without CONNECTIVITY")
        nodes = scan.table(second, words[1], "the table of cells").astype(np.int64)
        if not len(offsets) or offsets[0] != 0:
            raise Fault("the offsets of its cells do not begin with 0")
        return nodes, offsets[1:]
    scan.at = begin
    table = scan.table(second, "int", "the table of cells").astype(np.int64)
    keep, ends, at = np.ones(second, dtype=bool), np.zeros(first, dtype=np.int64), 0
    for i in range(first):
        if at >= second or not 0 <= table[at] <= second - at - 1:
            raise Fault(f"cell {i} does not have its declared number of nodes")
        keep[at] = False
        at += int(table[at]) + 1
        ends[i] = at - i - 1
    if at != second:
        raise Fault(f"its {first} cells have {at} numbers, not {second}")
    return table[keep], ends


def _metadata(scan: _Scanner) -> None:
    """Lines up to an empty one."""
    while scan.at < len(scan.content) and scan.line().strip():
        pass


def _attribute(
    scan: _Scanner, key: str, words: list[str], arrays: dict, unused: list[str], where: str, count: int
) -> None:
    if len(words) < 3:
        raise Fault(f"{' '.join(words)[:SHOWN]!r} is not supported")
    name, width, kind = words[1], 1, words[2]
    if key == "SCALARS":
        width = whole(words[3], "components") if len(words) > 3 else 1
        begin = scan.at
        if (scan.words() or [""])[0].upper() != "LOOKUP_TABLE":
            scan.at = begin
    elif key in _WIDTHS:
        width = _WIDTHS[key]
    elif key == "TEXTURE_COORDINATES" and len(words) == 4:
        width, kind = whole(words[2], "components"), words[3]
    elif key in ("COLOR_SCALARS", "LOOKUP_TABLE"):
        width, kind = whole(words[2], "components"), "unsigned_char" if scan.binary else "float"
        if key == "LOOKUP_TABLE":
            scan.table(4 * width, kind, "a table of colours")
            return
    values = scan.table(width * count, kind, f"array {name[:SHOWN]!r}")
    _keep(arrays, unused, where, count, name, values, width)


def _keep(
    arrays: dict[str, Array], unused: list[str], where: str, count: int, name: str, values: Array, width: int
) -> None:
    """Integers of one component on the cells; others are named in `unused`."""
    if where != "CELL_DATA" or values.dtype.kind not in "iu" or width != 1 or len(values) != count:
        unused.append(f"{name} ({'cells' if where == 'CELL_DATA' else 'points' if where else 'the file'})")
        return
    if name in arrays:
        raise Fault(f"there are two arrays {name!r}")
    if len(values) and int(values.max()) > np.iinfo(np.int64).max:
        raise Fault(f"array {name!r} contains numbers beyond 63 bits")
    arrays[name] = values.astype(np.int64)
