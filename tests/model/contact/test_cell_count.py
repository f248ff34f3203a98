"""Meshes that no memory holds are refused before any of it is taken."""

from __future__ import annotations

import tracemalloc
from collections.abc import Callable

import pytest

from warpffrf.model import mesh
from warpffrf.model.errors import InputError
from warpffrf.model.mesh.shapes.cell_count import MOST_CELLS, require_cells

SLEEVE = {"outer_radius": 0.05, "width": 0.02, "sectors": 9, "layers": 2, "axial": 99_999_999}
RING = {"groove_radius": 0.02, "groove_depth": 0.001, "lands": 2}

MESHES: dict[str, Callable[[], object]] = {
    "box": lambda: mesh.box((1, 1, 1), (1000, 1000, 1000)),
    "roller": lambda: mesh.roller(0.05, 0.01, 0.02, sectors=3, layers=900_000_000, axial=1),
    "sleeve": lambda: mesh.sleeve(inner_radius=0.01, **SLEEVE),
    "ring": lambda: mesh.ring(bore_radius=0.01, **{**SLEEVE, **RING}),
    "block": lambda: mesh.block((1, 1, 1), patch_half_width=0.1, cell=1e-9),
    "ball": lambda: mesh.ball(1.0, patch_half_width=0.1, cell=1e-9),
}


@pytest.mark.parametrize("kind", list(MESHES))
def test_too_many_cells(kind: str) -> None:
    tracemalloc.start()
    with pytest.raises(InputError, match=rf"{kind}: .* cells are more than 5e\+07; make the cells larger"):
        MESHES[kind]()
    assert tracemalloc.get_traced_memory()[1] < 1 << 20
    tracemalloc.stop()


def test_what_is_no_number_is_left_to_others() -> None:
    require_cells("mesh", None, "many", MOST_CELLS, True, 1)
    with pytest.raises(InputError):
        require_cells("mesh", MOST_CELLS, 2)
