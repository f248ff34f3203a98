"""A run as a VTK time series: one .vtu a flexible body and saved step, bound together by one .pvd.

Points are the rigidly moved, undeformed skin in world axes; the point data `displacement` [m, world axes] (warp by
this vector), `pressure` [Pa], and of bodies with friction `traction` [Pa, world axes, on this body], `slip` speed
[m/s], `wear` index [W/m2] and `state` (0 open, 1 stick, 2 slip). ParaView and `pyvista.PVDReader` open the .pvd; one
body is one part.
"""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any
from xml.sax.saxutils import quoteattr

import numpy as np

from warpffrf.model.errors import InputError
from warpffrf.model.mesh.meshio_files import meshio_package
from warpffrf.model.output_paths import checked_output_path
from warpffrf.output.bodies.skin import Skin
from warpffrf.output.geometry.grid_places import rotate


def write_time_series(result: Any, path: str | os.PathLike[str], *, stride: int = 1, overwrite: bool = False) -> Path:
    """Write every `stride`-th saved step; the .vtu files go into a folder named like the .pvd. Returns the .pvd path.

    Raises InputError for a path without the ending .pvd or one that cannot be written, for a stride below 1, and for
    a run without flexible bodies, and for a .pvd that exists where `overwrite` is not set.
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
    folder = target.with_suffix("")
    folder.mkdir(exist_ok=True)
    entries = []
    for i in range(0, len(result.time), stride):
        for part, (name, skin) in enumerate(skins.items()):
            file = folder / f"{part}_{i:06d}.vtu"
            meshio.write(file, body_mesh(result, name, skin, i))
            location = quoteattr(f"{folder.name}/{file.name}")
            entries.append(
                f'    <DataSet timestep="{result.time[i]:.17g}" part="{part}" name={quoteattr(name)} file={location}/>'
            )
    lines = [
        '<?xml version="1.0"?>',
        "<!-- written by warpffrf -->",
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
    for field in skin.contact_fields[1:]:
        data[field] = rotate(rotation, skin.traction(i)) if field == "traction" else skin.contact_field(field, i)
    return meshio.Mesh(
        points=np.asarray(motion.position[i]) + rotate(rotation, skin.points),
        cells=[("triangle", skin.triangles)],
        point_data=data,
    )
