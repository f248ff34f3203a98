"""Pictures of panels: one file, the ending chooses the format, bad input is named."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from warpffrf.model.errors import InputError
from warpffrf.output.plots.panels import Panel, save_panels

X = np.linspace(0.0, 1.0, 11)
PANEL = Panel("title", "x", "y", {"a": (X, X), "b": (X, X**2)}, {"exact": (X[:1], X[:1])}, (0.0, 2.0))


@pytest.mark.parametrize("count", [1, 2, 3, 4])
def test_panels_make_a_picture(count: int, tmp_path: Path) -> None:
    path = save_panels([PANEL] * count, tmp_path / "p.png")
    assert path.read_bytes().startswith(b"\x89PNG")


def test_a_panel_draws_its_curves_and_references() -> None:
    from matplotlib.figure import Figure

    axes = Figure().add_subplot()
    PANEL.draw(axes)
    drawn = {str(line.get_label()): np.asarray(line.get_xydata()) for line in axes.lines}
    assert set(drawn) == {"a", "b", "exact"} and drawn["b"] == pytest.approx(np.stack([X, X**2], axis=1))
    assert axes.get_ylim() == (0.0, 2.0)


def test_bad_input_is_named(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="nothing to draw"):
        save_panels([], tmp_path / "p.png")
    with pytest.raises(InputError, match="p.xyz"):
        save_panels([PANEL], tmp_path / "p.xyz")
