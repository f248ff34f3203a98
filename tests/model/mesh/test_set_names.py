"""Names of sets are found in capitals or not, where that distinguishes them."""

from __future__ import annotations

import numpy as np
import pytest

from warpffrf.model.errors import InputError
from warpffrf.model.material import Material
from warpffrf.model.mesh import Mesh, box
from warpffrf.model.mesh.files.set_names import SetNames


def test_capitals() -> None:
    names = SetNames({"BOTTOM": 1, "Top": 2, "top": 3})
    assert names["bottom"] == names["BOTTOM"] == 1 and "Bottom" in names
    assert names["Top"] == 2 and names["top"] == 3
    assert "TOP" not in names and "side" not in names and 3 not in names
    assert "bottom" not in names.keys()  # as it is written
    with pytest.raises(KeyError):
        names["TOP"]  # which of the two?


def test_sets_of_a_mesh() -> None:
    mesh = box((0.1, 0.1, 0.1), (1, 1, 1))
    deck = Mesh(mesh.points, mesh.cells, {"BOTTOM": mesh.facets("z_min")}, cell_sets={"ALL": np.array([0])})
    assert deck.facets("bottom") is deck.facets("BOTTOM") and deck.sets == {"BOTTOM": 1}
    assert deck.report({"all": Material(210e9, 0.3, 7850)}).mass == pytest.approx(7.85)
    with pytest.raises(InputError, match="facet set 'botom' does not exist; known: 'BOTTOM'"):
        deck.facets("botom")
    assert deck.select("bottom", "BOTTOM", lambda centers: centers[:, 2] < 0.0).sets == {"BOTTOM": 1, "bottom": 1}
