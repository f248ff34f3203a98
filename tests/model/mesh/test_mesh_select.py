"""Facets chosen by plane, cylinder, sphere and by walking to the next edge."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from warpffrf.model import mesh as wfmesh
from warpffrf.model.errors import InputError
from warpffrf.model.mesh.elements import cell_kind
from warpffrf.model.mesh.facets import FacetSet

R, R_I, WIDTH = 0.05, 0.015, 0.02
AXIS: Any = {"axis_point": (0, 0, 0), "axis_direction": (0, 1, 0)}


def roller(order: int = 2, **more) -> wfmesh.Mesh:
    return wfmesh.roller(R, R_I, WIDTH, **{"sectors": 12, "layers": 2, "axial": 2, "order": order, **more})


def same_facets(a: FacetSet, b: FacetSet) -> bool:
    def rows(facets: FacetSet) -> set:
        return {(kind, *sorted(r)) for kind, nodes in facets.blocks.items() for r in nodes.tolist()}

    return rows(a) == rows(b)


def cut_block() -> wfmesh.Mesh:
    """Two unit cubes along x, the second one cut into two wedges: triangles and quadrilaterals on its sides."""
    x, y, z = (v.ravel() for v in np.meshgrid([0.0, 1.0, 2.0], [0.0, 1.0], [0.0, 1.0], indexing="ij"))

    def n(i: int, j: int, k: int) -> int:
        return 4 * i + 2 * j + k

    def cube(i: int) -> list[int]:
        flat = [(i, 0), (i + 1, 0), (i + 1, 1), (i, 1)]
        return [n(*c, 0) for c in flat] + [n(*c, 1) for c in flat]

    second = np.array(cube(1))
    wedges = second[np.array([(0, 1, 2, 4, 5, 6), (0, 2, 3, 4, 6, 7)])]
    return wfmesh.Mesh(np.stack([x, y, z], axis=1), {"hex8": np.array([cube(0)]), "wedge6": wedges}).check()


@pytest.mark.parametrize("order", [1, 2])
def test_the_sets_of_a_roller_by_geometry(order: int) -> None:
    mesh = roller(order)
    found = mesh.select_cylinder("a", **AXIS, radius=R).select_cylinder("b", **AXIS, radius=R_I)
    found = found.select_plane("c", point=(0, WIDTH / 2, 0), normal=(0, -3, 0))
    assert same_facets(found.facets("a"), mesh.facets("rim")) and same_facets(found.facets("b"), mesh.facets("bore"))
    upper = mesh.select("upper", "ends", lambda x: x[:, 1] > 0)
    assert same_facets(found.facets("c"), upper.facets("upper"))
    assert "a" not in mesh.sets


def test_an_end_face_is_no_part_of_the_cylinder_through_its_nodes() -> None:
    """One layer around a thin bore: every node of an end face lies on one of the two cylinders, within 1 mm."""
    mesh = roller(1, layers=1)
    thin = mesh.select_cylinder("rim again", **AXIS, radius=0.5 * (R + R_I), tolerance=0.6 * (R - R_I))
    assert thin.sets["rim again"] == mesh.sets["rim"] + mesh.sets["bore"]


def test_cylinder_fitted_to_a_set() -> None:
    Q = np.linalg.qr(np.random.default_rng(2).normal(size=(3, 3)))[0]
    mesh = roller()
    mesh = replace(mesh, points=mesh.points @ Q.T + [0.1, 0.2, 0.3])
    seed = Q @ [R_I, 0.0, 0.0] + [0.1, 0.2, 0.3]
    found = mesh.select_feature("patch", seed=seed).select_cylinder("round", from_set="patch")
    assert same_facets(found.facets("round"), mesh.facets("bore"))
    with pytest.raises(InputError, match="give axis_point, axis_direction and radius, or from_set"):
        mesh.select_cylinder("any", radius=R)
    with pytest.raises(InputError, match="no facet of 'ends' lies on the cylinder"):
        mesh.select_cylinder("any", from_set="ends")


def test_sphere() -> None:
    """The rim crowned by a sphere about the centre is part of it."""
    mesh = roller(2, crown_radius=R)
    found = mesh.select_sphere("ball", center=(0, 0, 0), radius=R)
    assert same_facets(found.facets("ball"), mesh.facets("rim"))
    with pytest.raises(InputError, match=r"no outer facet lies on the sphere; .* 0.0\d+ m away .* raise tolerance"):
        mesh.select_sphere("ball", center=(0, 0, 0), radius=2 * R)


def test_tolerance_and_the_nearest_miss() -> None:
    mesh = roller()
    with pytest.raises(InputError, match=r"on the plane; the nearest one .* 0.0001 m away \(tolerance 1.*e-06 m\)"):
        mesh.select_plane("top", point=(0, WIDTH / 2 + 1e-4, 0), normal=(0, 1, 0))
    near = mesh.select_plane("top", point=(0, WIDTH / 2 + 1e-4, 0), normal=(0, 1, 0), tolerance=2e-4)
    assert near.sets["top"] == mesh.sets["ends"] // 2
    with pytest.raises(InputError, match="no facet lies along it"):
        mesh.select_plane("side", point=(0, 0, 0), normal=(0, 1, 0), from_set="rim")


def test_several_kinds_of_facets() -> None:
    mesh = cut_block()
    top = mesh.select_plane("top", point=(0, 0, 1), normal=(0, 0, 1))
    assert {k: len(n) for k, n in top.facets("top").blocks.items()} == {"quad4": 1, "tri3": 2}
    walked = mesh.select_feature("walked", seed=(1.9, 0.1, 1.0), angle=10.0)
    assert same_facets(walked.facets("walked"), top.facets("top"))
    everything = mesh.select_feature("all", seed=(0.5, 0.5, 0.0), angle=95.0)
    assert everything.sets["all"] == len(mesh.outer_facets())


@pytest.mark.parametrize("order", [1, 2])
def test_walking_stops_at_edges(order: int) -> None:
    """Neighbouring facets of 12 around meet at 30 degrees; quadratic ones bend in themselves and meet at 15."""
    mesh = roller(order)
    angle = 31.0 if order == 1 else 16.0
    for name, seed in (("rim", (R, 0.001, 0.0)), ("bore", (0.0, 0.0, R_I))):
        found = mesh.select_feature("walked", seed=seed, angle=angle)
        assert same_facets(found.facets("walked"), mesh.facets(name))
    strip = mesh.select_feature("strip", seed=(R * np.cos(0.1), 0.001, -R * np.sin(0.1)), angle=angle - 5.0)
    assert strip.sets["strip"] == 2  # the two facets along the axis
    one_end = mesh.select_feature("end", seed=(0.03, WIDTH / 2, 0.0), from_set="ends")
    assert one_end.sets["end"] == mesh.sets["ends"] // 2


def test_bad_input() -> None:
    mesh = roller()
    with pytest.raises(InputError, match="seed .* away from the nearest facet"):
        mesh.select_feature("rim again", seed=(50.0, 0.0, 0.0))
    for angle in (0.0, 180.0, np.nan):
        with pytest.raises(InputError, match="angle"):
            mesh.select_feature("a", seed=(R, 0, 0), angle=angle)
    for call in (
        lambda: mesh.select_plane("rim", point=(0, 0, 0), normal=(0, 1, 0)),
        lambda: mesh.select_feature("bore", seed=(R, 0, 0)),
    ):
        with pytest.raises(InputError, match="exists already"):
            call()
    with pytest.raises(InputError, match="normal has zero length"):
        mesh.select_plane("a", point=(0, 0, 0), normal=(0, 0, 0))
    with pytest.raises(InputError, match="'tire'"):
        mesh.select_plane("a", point=(0, 0, 0), normal=(0, 1, 0), from_set="tire")
    with pytest.raises(InputError, match="tolerance"):
        mesh.select_sphere("a", center=(0, 0, 0), radius=1.0, tolerance=-1.0)


def test_selected_facets_keep_their_orientation() -> None:
    mesh = cut_block()
    top = mesh.select_plane("top", point=(0, 0, 1), normal=(0, 0, 1)).facets("top")
    for nodes in top.corners.values():
        x = mesh.points[nodes]
        assert np.all(np.cross(x[:, 1] - x[:, 0], x[:, 2] - x[:, 0])[:, 2] > 0.0)
    assert cell_kind("hex8").corner_count == 8


def test_box() -> None:
    """The upper end of a roller, a quarter of its rim, and boxes that contain nothing or are none."""
    mesh = roller()
    found = mesh.select_box("upper", low=(-np.inf, 0.4 * WIDTH, -np.inf), from_set="ends")
    known = mesh.select("known", "ends", lambda x: x[:, 1] > 0)
    assert same_facets(found.facets("upper"), known.facets("known"))
    quarter = mesh.select_box("quarter", low=(0.0, -1.0, 0.0), high=1.0, from_set="rim")
    assert quarter.sets["quarter"] == mesh.sets["rim"] // 4
    with pytest.raises(InputError, match="the centre of no facet of 'rim' lies in the box; they lie between"):
        mesh.select_box("none", low=1.0, from_set="rim")
    with pytest.raises(InputError, match="low must be three numbers"):
        mesh.select_box("none", low=(0.0, 0.0), from_set="rim")
