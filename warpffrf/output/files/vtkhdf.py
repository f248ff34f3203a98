"""A run as one VTKHDF file (version 2.1 of the format, docs.vtk.org): a temporal MultiBlockDataSet, for ParaView.

Each flexible body and each small-sliding contact is a block of its name, an UnstructuredGrid of triangles. Points are
the rigidly moved, undeformed skin in world axes; the point data `displacement` [m, world axes] (warp by this vector),
`pressure` [Pa], and of bodies with friction `traction` [Pa, world axes, on this body], `slip` speed [m/s], `wear` index
[W/m2] and `state` (0 open, 1 stick, 2 slip). Bodies that were reduced with stress points on their skin
(`reduce(..., stress={"skin": "skin"})`) also have `stress` [Pa, world axes: xx, yy, zz, xy, yz, zx, as ParaView takes
six components] and `von_mises` [Pa]; missing stresses, on nodes or whole bodies, are reported in the attribute `notes`
of the group VTKHDF and by the logger.

The cells of a small-sliding contact lie on the first body with the displacement of its skin, and have the cell data
`pressure` and `traction` [Pa, world axes, on the second face], `gap` [m], accumulated `slip` [m, world axes, of the
second face], `state`, accumulated `loss` [J/m2] and `cell`, the number of the cell. Bodies have the pressure of their
small-sliding contacts and, with friction, traction and state at the nodes.

Cells are written once; points and fields are those of all steps in sequence, to which the offsets in the group Steps
point: row `i` of a block with n points begins at i n. Steps are written one by one, so that memory does not grow with
their number.
"""

from __future__ import annotations

import logging
import os
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from warpffrf.model import rotation as rot
from warpffrf.model.errors import InputError
from warpffrf.model.files.paths import check_ending, checked_output_path
from warpffrf.model.files.sealed_file import streamed_sealed
from warpffrf.model.messages.progress import Progress
from warpffrf.model.reduced.stress_field import rotated, von_mises
from warpffrf.output.bodies.skin import Skin
from warpffrf.output.geometry.places import rotate
from warpffrf.output.small_sliding import CellsOnSkin, SmallSlidingResult

log = logging.getLogger("warpffrf")

Array = np.ndarray
VERSION = (2, 1)  # the first with blocks
TRIANGLE = 5  # VTK_TRIANGLE
COMPRESSION = {"compression": "gzip", "compression_opts": 1, "shuffle": True}


@dataclass(frozen=True, eq=False)
class Frame:
    """A block at one saved step: points (n, 3) [m, world axes] and fields, (n, ...) or of the triangles (t, ...)."""

    points: Array
    point_data: dict[str, Array]
    cell_data: dict[str, Array]


def write_time_series(
    result: Any, path: str | os.PathLike[str], *, stride: int = 1, overwrite: bool = False, progress: bool = False
) -> Path:
    """Write every `stride`-th saved step; see `Result.to_vtkhdf`."""
    import h5py

    check_ending(path, "to_vtkhdf", (".vtkhdf",))
    target = checked_output_path(path, "to_vtkhdf", overwrite=overwrite)
    if stride < 1:
        raise InputError(f"to_vtkhdf: stride is {stride}; it must be 1 or more")
    skins = result.skins()
    if not skins:
        raise InputError("to_vtkhdf: the scene has no flexible body, so there is no surface to write")
    incomplete = [skin.stress for skin in skins.values() if skin.stress.note]
    for stress in incomplete:
        log.info(
            "to_vtkhdf: written %s: %s", "with part of the stress" if stress.count else "without stress", stress.note
        )
    blocks = {name: (skin.triangles, partial(body_frame, result, name, skin)) for name, skin in skins.items()}
    for contact in (result.contact(name) for name in result.small_sliding_names):
        placed = CellsOnSkin(contact.view, skins[contact.view.first_body.name])
        name = f"{contact.name} (contact)" if contact.name in skins else contact.name
        triangles = np.arange(3 * len(placed.cell)).reshape(-1, 3)
        blocks[name] = (triangles, partial(cells_frame, result, contact, placed))
    rows = range(0, len(result.time), stride)
    with streamed_sealed(target) as (file, flush):
        root = file.create_group("VTKHDF", track_order=True)
        _typed(root, "MultiBlockDataSet")
        root.attrs["notes"] = [stress.note for stress in incomplete]
        assembly = root.create_group("Assembly", track_order=True)
        written = []
        for name, (triangles, frame_at) in blocks.items():
            group = root.create_group(f"block_{len(written)}")
            assembly[name] = h5py.SoftLink(group.name)
            written.append(_Block(group, triangles, result.time[::stride], frame_at))
        bar = Progress("VTKHDF steps", len(rows), enabled=progress)
        for done, i in enumerate(rows):
            bar.update(done)
            for block in written:
                block.write(done, i)
            flush()
        bar.close()
    return target


class _Block:
    """An UnstructuredGrid in a group of the file, whose steps are written in sequence."""

    def __init__(self, group: Any, triangles: Array, time: Array, frame_at: Callable[[int], Frame]) -> None:
        self.group, self.frame_at, self.count = group, frame_at, len(time)
        _typed(group, "UnstructuredGrid")
        cells = len(triangles)
        group["NumberOfCells"], group["NumberOfConnectivityIds"] = np.array([cells]), np.array([3 * cells])
        group["Types"] = np.full(cells, TRIANGLE, dtype=np.uint8)
        group["Offsets"] = np.arange(cells + 1, dtype=np.int64) * 3
        group["Connectivity"] = np.asarray(triangles, dtype=np.int64).ravel()
        self.steps = steps = group.create_group("Steps")
        steps.attrs["NSteps"] = self.count
        steps["Values"] = np.asarray(time, dtype=np.float64)
        steps["NumberOfParts"] = np.ones(self.count, dtype=np.int64)
        for name in ("PartOffsets", "CellOffsets", "ConnectivityIdOffsets"):  # the same cells in all steps
            steps[name] = np.zeros(self.count, dtype=np.int64)

    def write(self, step: int, i: int) -> None:
        """Write the saved step `i` as the `step`-th of the file."""
        frame = self.frame_at(i)
        if not step:
            self.group["NumberOfPoints"] = np.array([len(frame.points)])
        self._rows(step, "Points", frame.points, "PointOffsets")
        for kind, fields in (("PointData", frame.point_data), ("CellData", frame.cell_data)):
            for name, values in fields.items():
                self._rows(step, f"{kind}/{name}", values, f"{kind}Offsets/{name}")

    def _rows(self, step: int, name: str, values: Array, offsets: str) -> None:
        n = len(values)
        if not step:
            shape = (self.count * n, *values.shape[1:])
            self.group.create_dataset(name, shape, values.dtype, chunks=(n, *values.shape[1:]), **COMPRESSION)
            self.steps[offsets] = np.arange(self.count, dtype=np.int64) * n
        self.group[name][step * n : (step + 1) * n] = values


def _typed(group: Any, kind: str) -> None:
    """Version and type, as a string of ASCII characters of fixed length."""
    group.attrs["Version"] = np.array(VERSION, dtype=np.int64)
    group.attrs["Type"] = np.bytes_(kind)


def body_frame(result: Any, name: str, skin: Skin, i: int) -> Frame:
    """One body at saved step `i`."""
    motion = result.history.bodies[name]
    rotation = motion.rotation[i]
    data = {"displacement": rotate(rotation, skin.displacement(i)), "pressure": skin.pressure(i)}
    if skin.stress.count:
        tensor = skin.stress.tensor(i)
        data |= {"stress": rotated(tensor, rot.matrix(rotation)), "von_mises": von_mises(tensor)}
    for field in skin.contact_fields[1:]:
        data[field] = rotate(rotation, skin.traction(i)) if field == "traction" else skin.contact_field(field, i)
    return Frame(np.asarray(motion.position[i]) + rotate(rotation, skin.points), data, {})


def cells_frame(result: Any, contact: SmallSlidingResult, placed: CellsOnSkin, i: int) -> Frame:
    """The cells of one small-sliding contact at saved step `i`."""
    motion, cell = result.history.bodies[contact.view.first_body.name], placed.cell
    rotation, along = motion.rotation[i], contact.frames[:, 1:]

    def in_world(components: Array) -> Array:
        return rotate(rotation, np.einsum("ck,ckd->cd", components, along))[cell]

    data = {
        "pressure": contact.pressure[i],
        "gap": contact.gap[i],
        "state": contact.state[i],
        "loss": contact.loss_density[i],
    }
    fields = {name: values[cell] for name, values in data.items()}
    fields |= {"traction": in_world(contact.traction[i]), "slip": in_world(contact.slip[i]), "cell": cell}
    return Frame(
        np.asarray(motion.position[i]) + rotate(rotation, placed.corners.reshape(-1, 3)),
        {"displacement": rotate(rotation, placed.displacement(i).reshape(-1, 3))},
        fields,
    )
