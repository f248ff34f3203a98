"""The picture of a run or scene in a notebook: small, and of the last saved step."""

from __future__ import annotations

import base64
import io
from typing import Any

import numpy as np

from warpffrf.output.bodies.skin import DISPLACEMENT
from warpffrf.output.plots.scene_picture import ScenePicture, row_at

DPI = 50  # half the size of a picture in a file


def picture_html(result: Any) -> str:
    """The bodies as an HTML image. Raises InputError where there is nothing to draw."""
    row = row_at(result, None, "picture")
    picture = ScenePicture(result, DISPLACEMENT, np.array([row]), factor=None, what="picture")
    figure = picture.figure()
    picture.draw(figure, row)
    stream = io.BytesIO()
    figure.savefig(stream, format="png", dpi=DPI)
    data = base64.b64encode(stream.getvalue()).decode("ascii")
    return f'<img alt="the bodies at {result.time[row]:.6g} s" src="data:image/png;base64,{data}">'
