"""How deep the material behind a contact surface is: what Hertz's half-space must be held against."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from warpffrf.model import surfaces
from warpffrf.model.material import Material
from warpffrf.model.mesh import Mesh, box, roller
from warpffrf.offline import reduce

OUTER, BORE = 0.05, 0.03  # m
RUBBER, STEEL = Material(5e6, 0.4, 1100.0, name="rubber"), Material(210e9, 0.3, 7850.0, name="steel")
ROUND_OFF = 1e-9  # of a fitted radius


def wall(mesh: Mesh, name: str, shape: Any, material: Any = STEEL) -> float | None:
    body = reduce(mesh, material, contact={name: shape}, modes=2, cache=False, progress=False)
    return body.provenance["contact_walls"][name]


@pytest.fixture(scope="module")
def ring() -> Mesh:
    return roller(OUTER, BORE, 0.02, sectors=24, axial=4, layers=4, order=1, grading=1.0)


def test_a_ring_is_as_deep_as_its_wall(ring: Mesh) -> None:
    assert wall(ring, "rim", surfaces.Cylinder()) == pytest.approx(OUTER - BORE, rel=ROUND_OFF)
    assert wall(ring, "bore", surfaces.Bore()) == pytest.approx(OUTER - BORE, rel=ROUND_OFF)


def test_an_arc_looks_below_itself_alone(ring: Mesh) -> None:
    """Across the seam of the angles."""
    arc = ring.select("arc", "rim", lambda x: x[:, 0] < -0.3 * OUTER)
    assert wall(arc, "arc", surfaces.Cylinder()) == pytest.approx(OUTER - BORE, rel=ROUND_OFF)


def test_a_cover_is_as_deep_as_its_material(ring: Mesh) -> None:
    middle = ring.points[ring.cells["hex8"]].mean(axis=1)
    inside = np.hypot(middle[:, 0], middle[:, 2]) < 0.045
    mesh = replace(ring, cell_sets={"cover": np.flatnonzero(~inside), "core": np.flatnonzero(inside)})
    cover = {"cover": RUBBER, "core": STEEL}
    assert wall(mesh, "rim", surfaces.Cylinder(), cover) == pytest.approx(0.005, rel=ROUND_OFF)
    whole = {"cover": STEEL, "core": STEEL}
    assert wall(mesh, "rim", surfaces.Cylinder(), whole) == pytest.approx(OUTER - BORE, rel=ROUND_OFF)


def test_a_plate_is_as_deep_as_it_is_thick() -> None:
    plate = box((0.1, 0.08, 0.012), (6, 5, 2), order=1)
    assert wall(plate, "z_max", surfaces.Plane()) == pytest.approx(0.012, rel=ROUND_OFF)


def test_nothing_lies_below_the_rim_of_a_solid_shaft(ring: Mesh) -> None:
    """A cylinder without a bore: its cells are those of a box, the square pressed round."""
    block = box((2.0, 2.0, 1.0), (8, 8, 4), order=1)
    x, y, z = block.points.T
    longest, length = np.maximum(np.abs(x), np.abs(y)), np.hypot(x, y)
    round_ = np.stack([x, y, z], axis=1)
    round_[:, :2] *= (longest / np.where(length > 0.0, length, 1.0))[:, None] * 0.05
    shaft = replace(block, points=round_ * (1.0, 1.0, 0.03))
    sides = np.abs(np.hypot(shaft.points[:, 0], shaft.points[:, 1]) - 0.05) < 1e-9
    facets = {k: n[np.all(sides[n], axis=1)] for k, n in shaft.outer_facets().blocks.items()}
    shaft = replace(shaft, facet_sets={"rim": type(shaft.outer_facets())(facets)})
    assert wall(shaft, "rim", surfaces.Cylinder(axis_direction=(0.0, 0.0, 1.0))) is None
