"""VTK's XML files of unstructured grids (.vtu): a strict reader (VTK file formats, vtk.org).

meshio keeps the cells of the last piece only, drops unsupported cells, and unpacks arrays of any declared size. Here
the length of each array follows from the numbers of points and cells of its piece and is compared with the sizes in
its blocks before they are unpacked. Pieces of a file are one grid, divided for writing: their cells are concatenated,
and points of several pieces with the same coordinates are merged.
"""

from __future__ import annotations

import base64
import binascii
import lzma
import zlib
from dataclasses import replace
from pathlib import Path
from xml.etree import ElementTree as ET

import numpy as np

from warpffrf.model.mesh.files.raw_mesh import RawMesh
from warpffrf.model.mesh.files.vtk_cells import Fault, guarded, numbers, raw_mesh, whole

Array = np.ndarray

DTYPES = {"Int8": "i1", "Int16": "i2", "Int32": "i4", "Int64": "i8", "UInt8": "u1", "UInt16": "u2", "UInt32": "u4",
          "UInt64": "u8", "Float32": "f4", "Float64": "f8"}  # fmt: skip
PLAIN = "save it with vtkZLibDataCompressor or without compression (ParaView: Compressor Type)"
RATIO, FEW = 64, 1 << 26  # bytes unpacked: up to that multiple of the file's size, or that number


class _File:
    """The tree of a file, its appended data, and the number of bytes that may still be unpacked."""

    def __init__(self, content: bytes) -> None:
        self.appended, self.raw = b"", False
        text = content
        begin = content.find(b"<AppendedData")
        if begin >= 0:
            head = content.find(b">", begin)
            end = content.rfind(b"</AppendedData>")
            mark = content.find(b"_", head)
            if head < 0 or not head < mark < end:
                raise Fault("its appended data has no end")
            text = content[: head + 1] + content[end:]
            self.appended = content[mark + 1 : end]
        if b"<!DOCTYPE" in text or b"<!ENTITY" in text:
            raise Fault("it declares a type of document")
        try:
            self.root = ET.fromstring(text)
        except (ET.ParseError, ValueError, LookupError, RecursionError) as error:
            raise Fault(f"no valid XML: {error}") from None
        if self.root.tag != "VTKFile" or self.root.get("type") != "UnstructuredGrid":
            raise Fault("it is no UnstructuredGrid of VTK")
        tag = self.root.find("AppendedData")
        encoding = "base64" if tag is None else tag.get("encoding", "base64")
        if encoding not in ("raw", "base64"):
            raise Fault(f"appended data in {encoding!r}")
        self.raw = encoding == "raw"
        self.order = {"LittleEndian": "<", "BigEndian": ">"}.get(self.root.get("byte_order", "LittleEndian"), "")
        self.head = {"UInt32": "u4", "UInt64": "u8"}.get(self.root.get("header_type", "UInt32"), "")
        if not self.order or not self.head:
            raise Fault("it does not declare its byte order or its header type")
        self.compressor = self.root.get("compressor")
        self.left = max(RATIO * len(content), FEW)

    def array(self, tag: ET.Element, count: int, what: str) -> Array:
        """The `count` numbers of a DataArray."""
        kind = DTYPES.get(tag.get("type", ""))
        if kind is None:
            raise Fault(f"{what} is of type {tag.get('type')!r}")
        dtype = np.dtype(self.order + kind)
        self.left -= count * dtype.itemsize
        if self.left < 0:
            raise Fault(f"{what} has {count} numbers, far more than fit into the file")
        form = tag.get("format", "ascii")
        if form == "ascii":
            words = (tag.text or "").split()
            if len(words) != count:
                raise Fault(f"{what} has {len(words)} numbers, not {count}")
            return numbers(words, dtype.kind == "f", what)
        if form == "binary":
            data = self._bytes(
                (tag.text or "").strip().encode("latin-1", "replace"), False, count * dtype.itemsize, what
            )
        elif form == "appended":
            at = whole(tag.get("offset", ""), f"the offset of {what}")
            if at >= len(self.appended):
                raise Fault(f"{what} lies behind the end of the file")
            data = self._bytes(self.appended[at:], self.raw, count * dtype.itemsize, what)
        else:
            raise Fault(f"{what} is in the format {form!r}")
        return np.frombuffer(data, dtype).astype(dtype.newbyteorder("="))

    def _bytes(self, stream: bytes, raw: bool, size: int, what: str) -> bytes:
        """The `size` bytes of an array that `stream` begins with."""
        item = int(self.head[1])
        if self.compressor is None:
            found = self._part(stream, raw, 0, item + size, what)
            if len(found) != item + size or self._heads(found[:item])[0] != size:
                raise Fault(f"{what} does not have {size} bytes")
            return found[item:]
        unpack = {"vtkZLibDataCompressor": _zlib, "vtkLZMADataCompressor": _lzma}.get(self.compressor)
        if unpack is None:
            raise Fault(f"its arrays are compressed by {self.compressor[:40]}, which is not read: {PLAIN}")
        blocks, full, last = self._heads(self._part(stream, raw, 0, 3 * item, what, exact=True))
        if blocks > len(stream) or (blocks and (blocks - 1) * full + (last or full) != size) or (not blocks and size):
            raise Fault(f"{what} does not have {size} bytes")
        heads = (3 + blocks) * item
        sizes = self._heads(self._part(stream, raw, 0, heads, what, exact=True))[3:]
        begin = heads if raw else -(-heads // 3) * 4
        data = self._part(stream[begin:], raw, 0, sum(sizes), what, exact=True)
        parts, at = [], 0
        for number, packed in enumerate(sizes):
            wanted = (last or full) if number == blocks - 1 else full
            try:
                part = unpack(data[at : at + packed], wanted)
            except (zlib.error, lzma.LZMAError, EOFError) as error:
                raise Fault(f"{what} cannot be unpacked: {error}") from None
            if len(part) != wanted:
                raise Fault(f"{what} does not have {size} bytes")
            parts.append(part)
            at += packed
        return b"".join(parts)

    def _heads(self, data: bytes) -> list[int]:
        return np.frombuffer(data, self.order + self.head).tolist()

    def _part(self, stream: bytes, raw: bool, begin: int, size: int, what: str, exact: bool = False) -> bytes:
        """`size` bytes of a stream, which is in base64 where it is not raw."""
        if raw:
            found = stream[begin : begin + size]
        else:
            try:
                found = base64.b64decode(stream[: -(-size // 3) * 4], validate=True)[:size]
            except (binascii.Error, ValueError):
                raise Fault(f"{what} is no base64") from None
        if exact and len(found) != size:
            raise Fault(f"{what} ends too early")
        return found


def _zlib(data: bytes, size: int) -> bytes:
    return zlib.decompressobj().decompress(data, size + 1)


def _lzma(data: bytes, size: int) -> bytes:
    return lzma.LZMADecompressor(memlimit=1 << 28).decompress(data, size + 1)


def read_vtu(path: Path) -> RawMesh:
    """Contents of a .vtu file; raises as `guarded` does."""
    return guarded(path, _read, "export it again")


def _read(label: str, content: bytes) -> RawMesh:
    file = _File(content)
    grids = file.root.findall("UnstructuredGrid")
    pieces = grids[0].findall("Piece") if len(grids) == 1 else []
    if not pieces:
        raise Fault("it has not one grid with a piece at least")
    points, nodes, ends, types = [], [], [], []
    arrays: dict[str, list[Array]] = {}
    unused: dict[str, None] = {}
    start = end = 0
    for number, piece in enumerate(pieces):
        counts = [whole(piece.get(name, ""), name) for name in ("NumberOfPoints", "NumberOfCells")]
        if sum(counts) > file.left:
            raise Fault(f"it declares {sum(counts)} points and cells, far more than fit into it")
        if number and not sum(counts):
            continue
        x, cells = _geometry(file, piece, *counts)
        points.append(x)
        nodes.append(cells["connectivity"] + start)
        ends.append(cells["offsets"] + end)
        types.append(cells["types"])
        start, end = start + len(x), end + len(cells["connectivity"])
        for name, values in _cell_arrays(file, piece, counts[1], unused).items():
            arrays.setdefault(name, []).append(values)
        unused |= dict.fromkeys(f"{tag.get('Name', '?')} (points)" for tag in piece.findall("PointData/DataArray"))
    for name in [name for name, parts in arrays.items() if len(parts) < len(points)]:
        raise Fault(f"array {name!r} is in some of its {len(points)} pieces only")
    number, notes = _seams(points)
    raw = raw_mesh(
        label,
        np.concatenate(points),
        number[np.concatenate(nodes)],
        np.concatenate(ends),
        np.concatenate(types),
        {name: np.concatenate(parts) for name, parts in arrays.items()},
        list(unused),
    )
    return replace(raw, notes=(*raw.notes, *notes))


def _seams(pieces: list[Array]) -> tuple[Array, list[str]]:
    """For each point of all pieces the number of the point it is merged with: the first at its position if several
    pieces have one point there each. Two points of one piece at one position remain separate."""
    count = sum(len(points) for points in pieces)
    number = np.arange(count)
    if len(pieces) == 1:
        return number, []
    of = np.repeat(np.arange(len(pieces)), [len(points) for points in pieces])
    place = np.unique(np.concatenate(pieces), axis=0, return_inverse=True)[1].ravel()
    pairs, times = np.unique(np.column_stack([place, of]), axis=0, return_counts=True)
    doubled = np.isin(place, pairs[times > 1, 0])
    first = np.unique(place, return_index=True)[1]
    number = np.where(doubled, number, first[place])
    merged = int(np.sum(number != np.arange(count)))
    return number, [f"the file has {len(pieces)} pieces: {merged} points at their seams are those of another piece"]


def _geometry(file: _File, piece: ET.Element, points: int, cells: int) -> tuple[Array, dict[str, Array]]:
    """Points (points, 3), and connectivity, ends and types of the cells of a piece."""
    places = piece.findall("Points/DataArray")
    if len(places) != 1 or places[0].get("NumberOfComponents") != "3":
        raise Fault("its points have not three coordinates")
    x = file.array(places[0], 3 * points, "the table of points").astype(float).reshape(points, 3)
    if not np.isfinite(x).all():
        raise Fault("a coordinate of a point is not finite")
    tags = {tag.get("Name", ""): tag for tag in piece.findall("Cells/DataArray")}
    if not {"connectivity", "offsets", "types"} <= set(tags):
        raise Fault("its cells have not connectivity, offsets and types")
    found = {name: file.array(tags[name], cells, name).astype(np.int64) for name in ("offsets", "types")}
    ends = found["offsets"]
    if len(ends) and (ends[0] < 0 or np.any(np.diff(ends) < 0)):
        raise Fault("offsets do not ascend")
    found["connectivity"] = file.array(tags["connectivity"], int(ends[-1]) if len(ends) else 0, "connectivity")
    found["connectivity"] = found["connectivity"].astype(np.int64)
    if len(found["connectivity"]) and not 0 <= found["connectivity"].min() <= found["connectivity"].max() < points:
        raise Fault("a cell refers to a node that the file does not contain")
    return x, found


def _cell_arrays(file: _File, piece: ET.Element, cells: int, unused: dict[str, None]) -> dict[str, Array]:
    """The integer arrays of one component on the cells of a piece; others are named in `unused`."""
    found = {}
    for tag in piece.findall("CellData/*"):
        name, width = tag.get("Name", ""), tag.get("NumberOfComponents") or "1"
        if tag.tag != "DataArray" or not DTYPES.get(tag.get("type", ""), "f").startswith(("i", "u")) or width != "1":
            unused[f"{name or '?'} (cells)"] = None
            continue
        values = file.array(tag, cells, f"array {name!r}")
        if name in found:
            raise Fault(f"there are two arrays {name!r}")
        if len(values) and int(values.max()) > np.iinfo(np.int64).max:
            raise Fault(f"array {name!r} contains numbers beyond 63 bits")
        found[name] = values.astype(np.int64)
    return found
