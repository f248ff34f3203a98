"""What `reduce` says of materials whose volume hardly changes, kind of cell by kind of cell."""

from __future__ import annotations

import pytest
from element_meshes import crooked_block

from warpffrf.model.material import Material
from warpffrf.model.mesh import Mesh
from warpffrf.offline import reduce


def rubber(formulation: str | None = None) -> Material:
    return Material(5e6, 0.499, 1100.0, name="rubber", formulation=formulation)


def said(kind: str, material: Material, **settings) -> tuple[list[str], list[str]]:
    mesh: Mesh = crooked_block(kind)
    report = reduce(mesh, material, modes=4, cache=False, progress=False, **settings).report
    return [n for n in report["notes"] if "mixed" in n], [w for w in report["warnings"] if "rubber" in w]


@pytest.mark.parametrize("kind", ["hex8", "hex20", "hex27", "wedge15", "tet10"])
def test_the_mixed_formulation_is_named(kind: str) -> None:
    notes, warnings = said(kind, rubber())
    assert len(notes) == 1 and not warnings
    assert f"material 'rubber': {8 * (1, 2, 6)[('hex', 'wed', 'tet').index(kind[:3])]} {kind} cells" in notes[0]


@pytest.mark.parametrize("kind", ["wedge6", "tet4"])
def test_cells_that_lock_are_named(kind: str) -> None:
    notes, (warning,) = said(kind, rubber())
    assert not notes and f"{kind} cells have no mixed formulation and lock" in warning
    assert "hex8, hex20, hex27, wedge15, tet10 cells have one" in warning


def test_a_mixed_formulation_that_is_not_there() -> None:
    """Asked for where nothing would lock."""
    steel = Material(210e9, 0.3, 7850.0, name="rubber", formulation="mixed")
    notes, (warning,) = said("tet4", steel)
    assert not notes and "tet4 cells have no mixed formulation and use that of displacement alone" in warning


def test_who_forbids_it_is_reported() -> None:
    notes, (warning,) = said("hex8", rubber("displacement"))
    assert not notes and warning.endswith("leave out formulation='displacement'")


def test_stresses_that_waver_are_named() -> None:
    _, (warning,) = said("tet10", rubber(), stress={"skin": "skin"})
    assert "the mean stress in 48 tet10 cells oscillates" in warning and "use hex8, hex20 or hex27" in warning
    assert not said("hex20", rubber(), stress={"skin": "skin"})[1]
