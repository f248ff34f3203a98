"""A run as a VTK time series: one .vtu per saved step and flexible body or small-sliding contact, and one .pvd for all.

Points are the rigidly moved, undeformed skin in world axes; the point data `displacement` [m, world axes] (warp by this
vector), `pressure` [Pa], and of bodies with friction `traction` [Pa, world axes, on this body], `slip` speed [m/s],
`wear` index [W/m2] and `state` (0 open, 1 stick, 2 slip). Bodies that were reduced with stress points on their skin
(`reduce(..., stress={"skin": "skin"})`) also have `stress` [Pa, world axes: xx, yy, zz, xy, yz, zx, as ParaView takes
six components] and `von_mises` [Pa]; missing stresses, on nodes or whole bodies, are reported in a comment of the .pvd
and by the logger. ParaView and `pyvista.PVDReader` open the .pvd; one body is one part. Steps are written one by one,
so that memory does not grow with their number.

A small-sliding contact is also a part: the triangles of its cells, on the first body with the displacement of its skin,
with the cell data `pressure` and `traction` [Pa, world axes, on the second face], `gap` [m], accumulated `slip` [m,
world axes, of the second face], `state`, accumulated `loss` [J/m2] and `cell`, the number of the cell. Bodies have the
pressure of their small-sliding contacts and, with friction, traction and state at the nodes.
"""

from __future__ import annotations

import logging
import os
from functools import partial
from pathlib import Path
from typing import Any
from xml.sax.saxutils import quoteattr

import numpy as np

from warpffrf.model import rotation as rot
from warpffrf.model.errors import InputError
from warpffrf.model.files.paths import checked_output_path
from warpffrf.model.messages.progress import Progress
from warpffrf.model.reduced.stress_field import rotated, von_mises
from warpffrf.output.bodies.skin import Skin
from warpffrf.output.geometry.places import rotate
from warpffrf.output.small_sliding import CellsOnSkin, SmallSlidingResult

log = logging.getLogger("warpffrf")


def meshio_package() -> Any:
    """The package meshio. Raises InputError if it cannot be imported, such as versions before 5.3.5 with NumPy 2."""
    try:
        import meshio
    except (ImportError, AttributeError) as error:
        raise InputError(
            f"files of meshes need the package meshio, which cannot be imported ({type(error).__name__}: {error}); "
            'pip install "meshio>=5.3.5"'
        ) from error
    return meshio


def write_time_series(
    result: Any, path: str | os.PathLike[str], *, stride: int = 1, overwrite: bool = False, progress: bool = False
) -> Path:
    """Write every `stride`-th saved step; the .vtu files go into a folder named like the .pvd. Returns the .pvd path.
    progress: report the progress on stderr.

    Raises InputError for a path that does not end in .pvd or cannot be written, a stride below 1, a run without
    flexible bodies, and an existing .pvd, unless `overwrite` is set.
    """
    meshio = meshio_package()

    target = checked_output_path(path, "to_vtu", overwrite=overwrite)
    if target.suffix != ".pvd":
        raise InputError(f"to_vtu: '{target.name}' must end in .pvd")
    if stride < 1:
        raise InputError(f"to_vtu: stride is {stride}; it must be 1 or more")
    skins = result.skins()
    if not skins:
        raise InputError("to_vtu: the scene has no flexible body, so there is no surface to write")
    incomplete = [skin.stress for skin in skins.values() if skin.stress.note]
    notes = [stress.note for stress in incomplete]
    for stress in incomplete:
        log.info("to_vtu: written %s: %s", "with part of the stress" if stress.count else "without stress", stress.note)
    folder = target.with_suffix("")
    folder.mkdir(exist_ok=True)
    entries = []
    small_sliding = [result.contact(name) for name in result.small_sliding_names]
    parts = [(name, partial(body_mesh, result, name, skin)) for name, skin in skins.items()]
    for contact in small_sliding:
        placed = CellsOnSkin(contact.view, skins[contact.view.first_body.name])
        parts.append((contact.name, partial(cells_mesh, result, contact, placed)))
    rows = range(0, len(result.time), stride)
    bar = Progress("VTK files", len(rows), enabled=progress)
    for done, i in enumerate(rows):
        bar.update(done)
        for part, (name, mesh_at) in enumerate(parts):
            file = folder / f"{part}_{i:06d}.vtu"
            meshio.write(file, mesh_at(i))
            location = quoteattr(f"{folder.name}/{file.name}")
            entries.append(
                f'    <DataSet timestep="{result.time[i]:.17g}" part="{part}" name={quoteattr(name)} file={location}/>'
            )
    bar.close()
    lines = [
        '<?xml version="1.0"?>',
        "<!-- written by warpffrf -->",
        *(f"<!-- {note.replace('--', '- -')} -->" for note in notes),
        '<VTKFile type="Collection" version="0.1">',
        "  <Collection>",
        *entries,
    ]
    target.write_text("\n".join([*lines, "  </Collection>", "</VTKFile>", ""]), encoding="utf-8")
    return target


def body_mesh(result: Any, name: str, skin: Skin, i: int) -> Any:
    """The meshio mesh of one body at saved step `i`."""
    meshio = meshio_package()

    motion = result.history.bodies[name]
    rotation = motion.rotation[i]
    data: dict[str, Any] = {"displacement": rotate(rotation, skin.displacement(i)), "pressure": skin.pressure(i)}
    if skin.stress.count:
        tensor = skin.stress.tensor(i)
        data |= {"stress": rotated(tensor, rot.matrix(rotation)), "von_mises": von_mises(tensor)}
    for field in skin.contact_fields[1:]:
        data[field] = rotate(rotation, skin.traction(i)) if field == "traction" else skin.contact_field(field, i)
    return meshio.Mesh(
        points=np.asarray(motion.position[i]) + rotate(rotation, skin.points),
        cells=[("triangle", skin.triangles)],
        point_data=data,
    )


def cells_mesh(result: Any, contact: SmallSlidingResult, placed: CellsOnSkin, i: int) -> Any:
    """The meshio mesh of the cells of one small-sliding contact at saved step `i`."""
    meshio = meshio_package()

    motion, cell = result.history.bodies[contact.view.first_body.name], placed.cell
    rotation, along = motion.rotation[i], contact.frames[:, 1:]

    def in_world(components: np.ndarray) -> np.ndarray:
        return rotate(rotation, np.einsum("ck,ckd->cd", components, along))[cell]

    data = {
        "pressure": contact.pressure[i],
        "gap": contact.gap[i],
        "state": contact.state[i],
        "loss": contact.loss_density[i],
    }
    fields = {name: [values[cell]] for name, values in data.items()}
    fields |= {"traction": [in_world(contact.traction[i])], "slip": [in_world(contact.slip[i])], "cell": [cell]}
    return meshio.Mesh(
        points=np.asarray(motion.position[i]) + rotate(rotation, placed.corners.reshape(-1, 3)),
        cells=[("triangle", np.arange(3 * len(cell)).reshape(-1, 3))],
        point_data={"displacement": rotate(rotation, placed.displacement(i).reshape(-1, 3))},
        cell_data=fields,
    )
