"""Writing a matplotlib figure to a file that is marked as written by warpffrf."""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path
from typing import Any

from warpffrf.model.errors import InputError
from warpffrf.model.files.paths import checked_output_path, written_whole
from warpffrf.output.plots.restyle import require_theme, restyle

SIGNATURE = {".png": "Software", ".pdf": "Creator", ".svg": "Creator"}


def write_picture(
    figure: Any, path: str | os.PathLike[str], what: str, *, overwrite: bool = False, dpi: int | None = None
) -> Path:
    """Write `figure`; the ending selects the format (.png, .pdf, .svg). Raises InputError naming `what` for an unknown
    ending, a path that cannot be written, and an existing file, unless `overwrite` is set and warpffrf wrote it."""
    target = checked_output_path(path, what, overwrite=overwrite)
    ending = target.suffix.lower()
    if ending not in SIGNATURE:
        raise InputError(f"{what}: '{target.name}' must end in {', '.join(SIGNATURE)}")
    with written_whole(target) as partial:
        options = {} if dpi is None else {"dpi": dpi}
        figure.savefig(partial, format=ending[1:], metadata={SIGNATURE[ending]: "warpffrf"}, **options)
    return target


def write_drawing(
    draw: Callable[[Any], Any], path: str | os.PathLike[str], what: str, *, theme: str = "light",
    width: float | None = None, overwrite: bool = False, dpi: int = 130, projection: str | None = None,
) -> Path:  # fmt: skip
    """Write what `draw` draws on new axes, of a `projection`, as `write_picture`; theme, width: as of `restyle`."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    require_theme(theme)
    figure = Figure(layout="constrained")
    FigureCanvasAgg(figure)
    draw(figure.add_subplot(projection=projection))
    return write_picture(restyle(figure, theme, width), path, what, overwrite=overwrite, dpi=dpi)
