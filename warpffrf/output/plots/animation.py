"""A run as an animation: .gif without further programs, or .mp4 by the program ffmpeg.

Frames are drawn (`scene_picture`), encoded and written one by one, so that memory holds only one of them. An
interrupted animation leaves no file.
"""

from __future__ import annotations

import os
import shutil
import subprocess
import tempfile
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np

from warpffrf.model.errors import MOST_COUNTED, InputError, require_count, require_number
from warpffrf.model.files.paths import check_ending, checked_output_path, written_whole
from warpffrf.model.messages.progress import Progress
from warpffrf.output.geometry.skin_nodes import frame_rows, rows_every
from warpffrf.output.plots.picture import write_picture
from warpffrf.output.plots.restyle import restyle
from warpffrf.output.plots.scene_picture import ScenePicture, row_at

MAX_FRAMES = 100  # default
ENDINGS = (".gif", ".mp4")
SIGNATURE = b"written by warpffrf"
COLORS = 256  # colours of a .gif frame
NEEDS_FFMPEG = (
    "animate: an .mp4 needs the program ffmpeg, which is not on the path; install it (Debian, Ubuntu: apt install "
    "ffmpeg), or write a .gif"
)

Frame = Callable[[np.ndarray], Any]  # takes pixels (height, width, 3) uint8


def write_still(
    result: Any, path: str | os.PathLike[str], field: str, *, time: float | None, factor: float | None,
    view: str | None, relative_to: str | None, theme: str, width: float | None, overwrite: bool,
) -> Path:  # fmt: skip
    """Draw the bodies at the saved step nearest to `time` [s]; see `Result.picture`."""
    i = row_at(result, time, "picture")
    picture = ScenePicture(
        result, field, np.array([i]), factor=factor, what="picture", view=view, relative_to=relative_to, theme=theme
    )
    figure = picture.figure()
    picture.draw(figure, i)
    if width is not None:
        restyle(figure, theme, width)
    return write_picture(figure, path, "picture", overwrite=overwrite)


def write_animation(
    result: Any, path: str | os.PathLike[str], field: str, *, every: int | None, fps: float, factor: float | None,
    view: str | None, relative_to: str | None, theme: str, overwrite: bool, progress: bool,
) -> Path:  # fmt: skip
    """Draw every `every`th saved step, None: about `MAX_FRAMES` frames; see `Result.animate`."""
    check_ending(path, "animate", ENDINGS)
    rate = require_number(fps, "animate: fps", positive=True)
    if every is not None:
        require_count(every, "animate: every", 1, most=MOST_COUNTED)
    row_at(result, None, "animate")
    target = checked_output_path(path, "animate", overwrite=overwrite)
    encoder = _gif if target.suffix.lower() == ".gif" else _mp4
    program = None if encoder is _gif else _ffmpeg()
    saved = len(result.time)
    rows = frame_rows(saved, MAX_FRAMES)[0] if every is None else rows_every(saved, every)
    bar = Progress("ranges of the animation", len(rows), enabled=progress, unit="frame")
    try:
        picture = ScenePicture(
            result, field, rows, factor=factor, what="animate", view=view, relative_to=relative_to, theme=theme,
            seen=bar.update,
        )  # fmt: skip
    finally:
        bar.close()
    figure = picture.figure()
    bar = Progress("animation", len(picture.rows), enabled=progress, unit="frame")
    try:
        with written_whole(target) as partial, encoder(partial, rate, program) as add:
            for done, i in enumerate(picture.rows):
                bar.update(done)
                picture.draw(figure, i)
                figure.canvas.draw()
                add(np.ascontiguousarray(np.asarray(figure.canvas.buffer_rgba())[..., :3]))
    finally:
        bar.close()
    return target


@contextmanager
def _gif(path: Path, fps: float, program: str | None) -> Iterator[Frame]:
    """Write a .gif that loops forever; each frame has its own colour table."""
    delay = max(round(100.0 / fps), 2)  # hundredths of a second; players slow down shorter ones to a tenth
    with path.open("wb") as file:
        first = True

        def add(pixels: np.ndarray) -> None:
            nonlocal first
            if first:
                file.write(_gif_start(pixels.shape[1], pixels.shape[0]))
                first = False
            file.write(_gif_frame(pixels, delay))

        yield add
        file.write(b"\x3b")


def _gif_start(width: int, height: int) -> bytes:
    """Signature, size without a global colour table, the loop, and the mark of warpffrf."""
    size = width.to_bytes(2, "little") + height.to_bytes(2, "little")
    loop = b"\x21\xff\x0bNETSCAPE2.0\x03\x01\x00\x00\x00"
    return b"GIF89a" + size + b"\x70\x00\x00" + loop + b"\x21\xfe" + bytes([len(SIGNATURE)]) + SIGNATURE + b"\x00"


def _gif_frame(pixels: np.ndarray, delay: int) -> bytes:
    """One frame: its delay, position, colour table and pixels, taken from a .gif of this frame alone."""
    from PIL import Image

    image = Image.fromarray(pixels).quantize(COLORS, dither=Image.Dither.NONE)
    single = BytesIO()
    image.save(single, "GIF", interlace=0)
    data = single.getvalue()
    table = 3 << ((data[10] & 7) + 1)  # bytes of the global colour table, which becomes the frame's
    at = 13 + table
    while data[at] == 0x21:  # extensions: a label and blocks; the last block is empty
        at += 2
        while data[at]:
            at += data[at] + 1
        at += 1
    place = data[at : at + 9] + bytes([0x80 | (data[10] & 7)])
    control = b"\x21\xf9\x04\x04" + delay.to_bytes(2, "little") + b"\x00\x00"
    return control + place + data[13 : 13 + table] + data[at + 10 : -1]


def _ffmpeg() -> str:
    program = shutil.which("ffmpeg")
    if program is None:
        raise InputError(NEEDS_FFMPEG)
    return program


@contextmanager
def _mp4(path: Path, fps: float, program: str | None) -> Iterator[Frame]:
    """Write an .mp4 with the encoder that ffmpeg provides, from raw frames."""
    process: subprocess.Popen | None = None
    with tempfile.TemporaryFile() as said:

        def add(pixels: np.ndarray) -> None:
            nonlocal process
            if process is None:
                height, width = pixels.shape[:2]
                command = [
                    str(program), "-loglevel", "error", "-y", "-f", "rawvideo", "-pix_fmt", "rgb24",
                    "-s", f"{width}x{height}", "-r", f"{fps:g}", "-i", "-", "-pix_fmt", "yuv420p",
                    "-metadata", f"comment={SIGNATURE.decode()}", "-f", "mp4", str(path),
                ]  # fmt: skip
                process = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=said, stderr=said)
            try:
                process.stdin.write(pixels.tobytes())  # type: ignore[union-attr]
            except BrokenPipeError:
                raise _failed(process, said) from None

        try:
            yield add
            if process is not None:
                process.stdin.close()  # type: ignore[union-attr]
                if process.wait():
                    raise _failed(process, said)
        finally:
            if process is not None and process.poll() is None:
                process.kill()
                process.wait()


def _failed(process: Any, said: Any) -> InputError:
    process.wait()
    said.seek(0)
    words = " ".join(said.read().decode(errors="replace").split())
    return InputError(f"animate: ffmpeg could not write the film ({words or 'no reason given'}); write a .gif")
