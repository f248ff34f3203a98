"""Data of a recording, computed before logging, so that colour ranges and magnification are fixed for the whole run.

Streams. Recording streams of rerun that release their resources when they are closed.

By default rerun (0.41) keeps four threads and more than a megabyte of every recording saved with a blueprint until the
process ends: two threads of a disconnected stream, and two of the blueprint's own, whose stream and memory refer to
each other.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from warpffrf.model.messages.progress import Progress
from warpffrf.output.bodies.skin import DISPLACEMENT, ShownSkin, Skin
from warpffrf.output.contact.cell_result import CellContactResult
from warpffrf.output.geometry.places import grid_theta_offset, rotate, tangents
from warpffrf.output.geometry.reference import Reference

BLENDED = 0.999  # opacity of transparent pictures: the viewer draws those of opacity 1 on black
RELIEF_HEIGHT = 0.35  # height of the pressure relief over the patch, as part of the length shown along the arc


@dataclass
class BodyFrames:
    """The thinned skin of one body over the frames."""

    points: np.ndarray  # (n, 3) m, user frame
    triangles: np.ndarray  # (t, 3)
    displacement: np.ndarray  # (F, n, 3) m, float32, user frame, relative to the reference
    carried: np.ndarray  # (F, n, 3) m, float32, likewise, with the reference
    size: float  # m, largest extent
    kept: np.ndarray  # (n,) nodes of the skin that the points are
    values: np.ndarray | None = None  # (F, n) float32, another field in SI units, if requested


def body_frames(
    skins: dict[str, Skin], rows: np.ndarray, max_points: int, field: str, reference: Reference, progress: bool = False
) -> dict[str, BodyFrames]:
    """The `skins` of all flexible bodies at the given rows with a `field` of `Skin.fields`, and displacements relative
    to a `reference`; progress: report the progress."""
    frames = {}
    bar = Progress("skins of the recording", len(skins) * len(rows), enabled=progress, unit="skin")
    for done, (name, skin) in enumerate(skins.items()):
        shown = ShownSkin(skin, max_points, reference)
        shape = len(rows), len(shown.points), 3
        displacement = np.empty(shape, dtype=np.float32)
        carried = np.broadcast_to(np.float32(0.0), shape) if reference.name is None else np.empty_like(displacement)
        values = None if field == DISPLACEMENT else np.empty((len(rows), len(shown.points)), dtype=np.float32)
        for f, i in enumerate(rows):
            bar.update(done * len(rows) + f)
            displacement[f] = shown.displacement(i)
            if reference.name is not None:
                carried[f] = shown.carried(i)
            if values is not None:
                values[f] = shown.values(field, i)
        frames[name] = BodyFrames(shown.points, shown.triangles, displacement, carried, shown.size, shown.kept, values)
    bar.close()
    return frames


@dataclass
class PatchFrame:
    """Frame of the patch of one contact, at mid-width at the line of centres on the first surface."""

    origin: np.ndarray  # (3,) m, world
    axes: np.ndarray  # (3, 3), columns: e_theta, t_z, outward normal; world


def _local_frame(contact: Any, i: int) -> tuple[np.ndarray, np.ndarray]:
    """Origin (3,) [m] and axes (3, 3), in rows, of the patch frame in the first body's user frame."""
    surface = contact.view.first
    grid, shape = surface.grid, surface.shape
    theta = grid.theta_start + grid_theta_offset(surface) + grid.pitch * float(contact.history.center_column[i])
    middle = 0.5 * (float(grid.z[0]) + float(grid.z[-1]))
    e_theta, t_z = tangents(shape, theta, middle)[:, 0]
    return np.ravel(shape.point(theta, middle)), np.stack([e_theta, t_z, np.cross(e_theta, t_z)])


def patch_frame(result: Any, contact: Any, i: int) -> PatchFrame:
    """The frame of the close-up view at saved step `i`."""
    motion = result.history.bodies[contact.view.first_body.name]
    point, local = _local_frame(contact, i)
    origin = np.asarray(motion.position[i]) + rotate(motion.rotation[i], point[None])[0]
    return PatchFrame(origin, rotate(motion.rotation[i], local).T)


def grid_triangles(columns: int, rows: int) -> np.ndarray:
    """Triangles (2 (columns - 1)(rows - 1), 3) of a structured grid with the row index fastest, counter-clockwise as
    seen from outside."""
    j, k = np.meshgrid(np.arange(columns - 1), np.arange(rows - 1), indexing="ij")
    a = (j * rows + k).ravel()
    b, c, d = a + rows, a + rows + 1, a + 1
    return np.concatenate([np.stack([a, b, c], axis=1), np.stack([a, c, d], axis=1)])


def _beside(loaded: np.ndarray, count: int) -> tuple[int, int]:
    """First and last of `count` lines that are not empty, extended by one on either side; (0, 0) for none."""
    return (max(int(loaded[0]) - 1, 0), min(int(loaded[-1]) + 1, count - 1)) if len(loaded) else (0, 0)


def relief_values(contact: Any, values: np.ndarray) -> np.ndarray:
    """`values` (columns, rows) at the vertices of the contact's relief: those of the nodes, or each cell's value at its
    four corners (2 columns, 2 rows), with vertical walls between the cells."""
    return values.repeat(2, axis=0).repeat(2, axis=1) if isinstance(contact, CellContactResult) else values


def _relief_lines(contact: Any, i: int) -> tuple[np.ndarray, np.ndarray]:
    """theta of the first surface's shape and z of the vertices of the relief at saved step `i`."""
    offset = grid_theta_offset(contact.view.first)
    if isinstance(contact, CellContactResult):
        lines = contact.places.theta_edges[i] + offset, contact.places.z_edges[i]
        return lines[0].repeat(2)[1:-1], lines[1].repeat(2)[1:-1]
    return contact.theta[i] + offset, contact.z


def relief(contact: Any, i: int, top: float, height: float) -> np.ndarray:
    """Vertices (vertices, 3) [m] of the pressure relief in the patch frame, p/top * height above the true surface, in
    the order of `relief_values`.

    Columns and rows beyond the first without pressure are collapsed onto it, so that only the patch is visible.
    """
    shape = contact.view.first.shape
    pressure = relief_values(contact, contact.mean_pressure[i])
    around, along = _relief_lines(contact, i)
    first, last = _beside(np.flatnonzero(np.any(pressure > 0.0, axis=1)), len(around))
    low, high = _beside(np.flatnonzero(np.any(pressure > 0.0, axis=0)), len(along))
    theta, z = np.meshgrid(
        np.clip(around, around[first], around[last]), np.clip(along, along[low], along[high]), indexing="ij"
    )
    if isinstance(contact, CellContactResult):
        theta += contact.places.shift_at(i, z)
    lift = np.maximum(pressure, 0.0) / top * height if top > 0.0 else np.zeros_like(pressure)
    points = shape.point(theta, z) + lift[..., None] * shape.normal(theta, z)
    origin, axes = _local_frame(contact, i)
    return ((points - origin) @ axes.T).reshape(-1, 3)


APPLICATION = "warpffrf"


def new_stream() -> Any:
    """A stream without a sink; the owner stores it as `stream` and closes it with `close_stream`."""
    import rerun as rr

    return rr.RecordingStream(APPLICATION)


def in_memory(stream: Any, blueprint: Any) -> Any:
    """Send `stream`, which opens with `blueprint`, to memory; `drain_as_bytes` of the return value is a .rrd file.

    A stream to a file never returns if the disk is full. The blueprint is sent as by
    `stream.send_blueprint(blueprint)`, but through a stream that can be disconnected. This uses private names of rerun;
    in versions without them the public function is called.
    """
    import rerun as rr
    import rerun_bindings as native

    memory = stream.memory_recording()
    try:
        own = native.new_blueprint(APPLICATION, make_default=False, make_thread_default=False)
        beside = rr.RecordingStream._from_native(own)
        beside.set_time("blueprint", sequence=0)
        blueprint._log_to_stream(beside)
        storage = beside.memory_recording().storage  # type: ignore[attr-defined]
        native.send_blueprint(storage, True, True, recording=stream.to_native())
        beside.disconnect()
    except (AttributeError, TypeError):
        stream.send_blueprint(blueprint)
    return memory


def close_stream(owner: Any) -> None:
    """Flush `owner.stream`, close it and remove it from the owner.

    rerun ends the threads of unreferenced streams when it is initialised again, which creates no recording here and
    does not affect the user's recordings.
    """
    import rerun as rr

    try:
        owner.stream.flush()
    finally:
        owner.stream.disconnect()
        del owner.stream
        rr.init(APPLICATION, init_logging=False)
