"""Contact grids and compliances on extruded curves: a circle is a cylinder, facets of any length have a grid."""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np
import pytest

import warpffrf as wf
from scenes import curved_blocks as blocks
from warpffrf.model.mesh import Mesh, roller
from warpffrf.model.surfaces import Curve, Cylinder, Extruded
from warpffrf.offline import ContactGrid, reduce
from warpffrf.offline.contact.node_loads import ContactFacets

RADIUS = 0.05
AXIS: dict[str, Any] = {"axis_point": (0.0, 0.0, 0.0), "axis_direction": (0.0, 1.0, 0.0)}
CIRCLE = Curve.arcs((RADIUS, 0.0), 0.5 * np.pi, [(2.0 * np.pi * RADIUS, RADIUS)], closed=True)


@cache
def body(kind: str) -> wf.ReducedBody:
    mesh = roller(RADIUS, 0.015, 0.02, sectors=16, layers=3, axial=1, order=2)
    shape = Cylinder(radius=RADIUS, **AXIS) if kind == "cylinder" else Extruded(curve=CIRCLE, **AXIS)
    return reduce(
        mesh, blocks.STEEL, interfaces={"bore": "rigid"}, contact={"rim": shape}, modes=2, progress=False,
        grid=ContactGrid(contact_fixed=True, tangential=True), options=wf.ReductionOptions(periodic=False),
    )  # fmt: skip


def test_a_circle_has_the_compliance_of_a_cylinder() -> None:
    """Of nodes, far field and tractions, on a grid that closes around; on the general path by itself."""
    surfaces: list[Any] = [body(kind).contact_surfaces["rim"] for kind in ("curve", "cylinder")]
    own, known = surfaces
    assert own.grid.periodic and own.grid.columns == known.grid.columns
    assert own.grid.pitch == pytest.approx(RADIUS * known.grid.pitch)
    for found, same in (
        (own.lags, known.lags), (own.far.lags, known.far.lags), (own.tangential.lags_tt, known.tangential.lags_tt),
        (own.tangential.lags_nt, known.tangential.lags_nt), (own.far.tangential.lags_nt, known.far.tangential.lags_nt),
        (own.mode_normal, known.mode_normal),
    ):  # fmt: skip
        assert np.abs(found - same).max() < 5e-5 * np.abs(same).max()  # cubic pieces are bent by 3e-5 more or less
    assert [end.z for end in own.far.ends] == pytest.approx([end.z for end in known.far.ends])
    free = reduce(
        roller(RADIUS, 0.015, 0.02, sectors=16, layers=2, axial=1), blocks.STEEL, interfaces={"bore": "rigid"},
        contact={"rim": Extruded(curve=CIRCLE, **AXIS)}, modes=0, progress=False,
    )  # fmt: skip
    assert free.contact_surfaces["rim"].lags.shape[0] == 1  # not harmonic by harmonic: no rotation maps a curve


def test_a_file_keeps_the_curve(tmp_path) -> None:
    body("curve").save(tmp_path / "circle.body")
    shape = wf.ReducedBody.load(tmp_path / "circle.body").contact_surfaces["rim"].shape
    assert shape.describe() == body("curve").contact_surfaces["rim"].shape.describe()


def test_grids_follow_the_facets() -> None:
    """Equally spaced nodes are the grid; otherwise it is as fine as the longest facets, in each direction."""
    curve, shape = blocks.arc(15e-3), blocks.extruded(blocks.arc(15e-3))
    mesh = blocks.mesh_below(curve, counts=(10, 4, 2))
    facets = ContactFacets.of(mesh.points, mesh.facets("face"), shape)
    plan = facets.plan("face", None, 1000)
    assert plan.nodal and (plan.columns, len(plan.z)) == (21, 9)
    points = mesh.points + np.array([1e-4, 0.0, 0.0]) * np.sin(mesh.points[:, :1] * 300.0)
    theta, z, _ = shape.chart(points)
    moved = Mesh(shape.point(theta, z), mesh.cells, mesh.facet_sets)  # only its face is of interest
    facets = ContactFacets.of(moved.points, moved.facets("face"), shape)
    plan = facets.plan("face", None, 1000)
    longest = np.ptp(facets.chart.theta, axis=1).max()
    assert not plan.nodal and len(plan.z) == 5
    assert plan.pitch >= longest * (1.0 - 1e-9) and plan.columns == int(blocks.LENGTH / longest + 1e-9) + 1
