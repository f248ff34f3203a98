"""Cells of small-sliding contacts: overlaps compared with closed forms, loads compared with the motion that they work
on, gathering, cells by nodes."""

from __future__ import annotations

import numpy as np
import pytest
from small_sliding_bodies import as_kind, moved, slit_body, together

from warpffrf.model.errors import InputError
from warpffrf.model.mesh import FacetSet, Mesh, box, grid, roller, sleeve
from warpffrf.model.surfaces import Matched
from warpffrf.offline.small_sliding.cells import make_cells
from warpffrf.offline.small_sliding.compliance import frames, unit_loads

ROUND_OFF = 1e-12  # relative: sums of a few thousand products


def turned(angle: float, shift=(0.0, 0.0, 0.0)):
    c, s = np.cos(angle), np.sin(angle)
    R = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
    return lambda x: x @ R.T + np.array(shift)


def stacked(place, counts=(3, 4, 1), orders=(1, 1), gap: float = 0.0) -> Mesh:
    """A unit plate, and above it another one that `place` moves: faces "a z_max" and "b z_min"."""
    a = box((1.0, 1.0, 0.2), (2, 2, 1), center=(0.0, 0.0, -0.1), order=orders[0])
    b = box((1.0, 1.0, 0.2), counts, center=(0.0, 0.0, 0.1 + gap), order=orders[1])
    return together(a=a, b=moved(b, place))


def both(mesh: Mesh, **how):
    return make_cells(mesh, "lap", Matched("b z_min", first="a z_max", **how))


@pytest.mark.parametrize("orders", [(1, 1), (2, 1), (1, 2), (2, 2)])
def test_shifted_squares(orders) -> None:
    cells = both(stacked(turned(0.0, (0.31, -0.27, 0.0)), orders=orders))
    assert cells.area.sum() == pytest.approx(0.69 * 0.73, rel=ROUND_OFF)
    assert cells.covered == pytest.approx((0.69 * 0.73, 0.69 * 0.73), rel=ROUND_OFF)
    centroid = cells.area @ cells.points / cells.area.sum()
    assert centroid == pytest.approx((0.155, -0.135, 0.0), abs=1e-13)
    assert "face each other" in cells.notes[0]


@pytest.mark.parametrize("angle", [0.0, 0.3, np.pi / 4, 2.0])
def test_rotated_squares(angle) -> None:
    """Two unit squares with one centre: an octagon around the circle of radius r = 1/2, whose sides have normals at the
    angles of both; between normals apart by b it has the area r^2 tan(b/2)."""
    cells = both(stacked(turned(angle)))
    quarter = angle % (np.pi / 2)
    half = 0.25 * (np.tan(quarter / 2.0) + np.tan((np.pi / 2 - quarter) / 2.0))
    assert cells.area.sum() == pytest.approx(4.0 * half, rel=ROUND_OFF)


def test_cells_sum_to_the_overlap_and_are_the_triangles() -> None:
    cells = both(stacked(turned(0.4, (0.2, 0.1, 0.0)), orders=(2, 1)))
    t = cells.triangles
    area = 0.5 * np.cross(t[:, 1] - t[:, 0], t[:, 2] - t[:, 0])
    assert np.all(area[:, 2] > 0.0)  # outwards
    by_cell = np.bincount(cells.cell, weights=area[:, 2], minlength=cells.count)
    assert by_cell == pytest.approx(cells.area, rel=ROUND_OFF)
    assert cells.count == 4


def ends(outer: float, inner: float, sectors: int, order: int, y: float, side: str) -> Mesh:
    mesh = roller(outer, inner, 0.01, sectors=sectors, layers=2, axial=1, order=order)
    mesh = moved(mesh, lambda x: x + np.array([0.0, y, 0.0]))
    sign = 1.0 if side == "top" else -1.0
    mesh = mesh.select_plane("end", point=(0.0, y + sign * 0.005, 0.0), normal=(0.0, sign, 0.0))
    return Mesh(mesh.points, mesh.cells, {"end": mesh.facets("end")})


def test_annulus_on_annulus_of_the_same_sectors() -> None:
    """Radii 10 to 40 and 20 to 50 mm: the overlap is the ring 20 to 40 mm of the polygons."""
    n = 24
    mesh = together(a=ends(0.04, 0.01, n, 1, 0.0, "top"), b=ends(0.05, 0.02, n, 1, 0.01, "bottom"))
    cells = make_cells(mesh, "lap", Matched("b end", first="a end"))
    ring = 0.5 * n * np.sin(2.0 * np.pi / n) * (0.04**2 - 0.02**2)
    assert cells.area.sum() == pytest.approx(ring, rel=1e-11)
    assert np.linalg.norm(cells.points, axis=1).max() < 0.05 and cells.gap == pytest.approx(np.zeros(cells.count))


def test_annuli_of_other_sectors_converge_with_the_square() -> None:
    errors = []
    for n in (12, 24, 48):
        mesh = together(a=ends(0.04, 0.01, n, 1, 0.0, "top"), b=ends(0.05, 0.02, n + n // 2, 1, 0.01, "bottom"))
        cells = make_cells(mesh, "lap", Matched("b end", first="a end"))
        errors.append(abs(cells.area.sum() / (np.pi * (0.04**2 - 0.02**2)) - 1.0))
    assert np.log2(np.array(errors[:-1]) / errors[1:]) == pytest.approx(2.0, abs=0.15)


def test_a_curved_edge_of_quadratic_facets_is_followed() -> None:
    """A quadratic ring on itself: all of it is covered, with the area of the true circles to the fourth order."""
    errors = []
    for n in (12, 24):
        mesh = together(a=ends(0.04, 0.02, n, 2, 0.0, "top"), b=ends(0.04, 0.02, n, 2, 0.01, "bottom"))
        cells = make_cells(mesh, "lap", Matched("b end", first="a end"))
        errors.append(abs(cells.area.sum() / (np.pi * (0.04**2 - 0.02**2)) - 1.0))
        assert cells.covered == pytest.approx((1.0, 1.0), abs=1e-9) and not cells.notes
    assert np.log2(errors[0] / errors[1]) == pytest.approx(4.0, abs=0.1)


@pytest.mark.slow
@pytest.mark.parametrize("order", [1, 2])
def test_a_pin_in_a_bore(order) -> None:
    """A pin of radius 20 mm, 30 mm long, in a bore of 20.05 mm, 40 mm long, with other sectors."""
    pin = roller(0.02, 0.005, 0.03, sectors=40, layers=2, axial=3, order=order)
    hub = sleeve(0.02005, 0.04, 0.04, sectors=48, axial=4, layers=2, order=order)
    cells = make_cells(together(pin=pin, hub=hub), "fit", Matched("hub bore", first="pin rim"))
    sagitta = 0.02 * (1.0 - np.cos(np.pi / 40)) if order == 1 else 1e-6
    assert cells.area.sum() == pytest.approx(2.0 * np.pi * 0.02 * 0.03, rel=3e-3 if order == 1 else 1e-4)
    assert cells.covered == pytest.approx((1.0, 0.75), abs=0.01)
    assert cells.gap == pytest.approx(np.full(cells.count, 5e-5), abs=2.0 * sagitta)
    radial = cells.points * np.array([1.0, 0.0, 1.0])
    assert np.einsum("ci,ci->c", cells.normals, radial / np.linalg.norm(radial, axis=1, keepdims=True)) == (
        pytest.approx(np.ones(cells.count), abs=1e-12)
    )
    axes = frames(cells.normals)
    assert axes[:, 1] == pytest.approx(np.tile([0.0, 1.0, 0.0], (cells.count, 1)))  # along the axis
    assert np.linalg.det(axes) == pytest.approx(np.ones(cells.count))


@pytest.mark.slow
@pytest.mark.parametrize("order", [1, 2])
def test_the_bore_first(order) -> None:
    """Seen from the bore the normals lean together: nothing is counted twice but for kinks, which do not matter."""
    pin = roller(0.02, 0.005, 0.03, sectors=40, layers=2, axial=3, order=order)
    hub = sleeve(0.02005, 0.04, 0.04, sectors=48, axial=4, layers=2, order=order)
    cells = make_cells(together(pin=pin, hub=hub), "fit", Matched("pin rim", first="hub bore"))
    assert cells.area.sum() == pytest.approx(2.0 * np.pi * 0.02005 * 0.03, rel=6e-3)
    assert cells.covered == pytest.approx((0.75, 1.0), abs=0.01)


@pytest.mark.parametrize("kind", ["hex8", "hex20", "hex27", "tet4", "tet10"])
@pytest.mark.parametrize("by", ["facets", "nodes"])
def test_resultants_and_linear_motion(kind, by) -> None:
    """Equal and opposite resultants to round-off; of a linear displacement field u = G x both faces see the same, so
    that delta is what the gap makes of it, whatever the cells are made of."""
    mesh = as_kind(slit_body(order=2, along=6), kind)
    cells = make_cells(mesh, "lap", Matched("high", first="low", by=by))
    axes = frames(cells.normals)
    B = unit_loads(cells, axes)
    forces = np.asarray(B.toarray()).reshape(len(mesh.points), 3, -1)
    assert np.abs(forces.sum(axis=0)).max() < 1e-13
    face = unit_loads(make_cells(mesh, "face", Matched(first="low", by=by)), axes_of(mesh, by))
    total = np.asarray(face.toarray()).reshape(len(mesh.points), 3, -1).sum(axis=0)
    assert np.linalg.norm(total, axis=0) == pytest.approx(np.ones(total.shape[1]), abs=1e-13)
    G = np.random.default_rng(3).standard_normal((3, 3))
    delta = B.T @ (mesh.points @ G.T).ravel()
    expected = np.einsum("cki,ij,cj->ck", axes, G, cells.gap[:, None] * cells.normals).ravel()
    assert delta == pytest.approx(expected, abs=1e-14)
    if by == "facets":
        assert cells.area.sum() == pytest.approx(0.05 * 0.02, rel=ROUND_OFF)


def axes_of(mesh: Mesh, by: str):
    return frames(make_cells(mesh, "face", Matched(first="low", by=by)).normals)


def test_the_displacement_of_a_face_is_its_mean() -> None:
    """Of a quadratic field on hex27 the mean over each cell, with a cut across the facets, compared with its closed
    form."""
    mesh = stacked(turned(0.0, (0.25, 0.0, 0.0)), orders=(2, 2))
    cells = both(mesh)
    u = (mesh.points[:, 0] ** 2 + mesh.points[:, 0] * mesh.points[:, 1]) * (mesh.points[:, 2] < 1e-9)
    # cells are [-0.25, 0] and [0, 0.5] along x, two rows along y
    low, high = np.where(cells.points[:, 0] < 0.0, -0.25, 0.0), np.where(cells.points[:, 0] < 0.0, 0.0, 0.5)
    mean_x, mean_y = 0.5 * (low + high), np.where(cells.points[:, 1] < 0.0, -0.25, 0.25)
    assert cells.first @ u == pytest.approx((high**3 - low**3) / (3.0 * (high - low)) + mean_x * mean_y, abs=1e-14)


def test_meshes_that_do_not_match() -> None:
    """A constant displacement of the second face is seen whole, a linear one on average over each cell."""
    mesh = stacked(turned(0.3), counts=(5, 3, 1))
    cells = both(mesh)
    assert cells.second is not None
    assert cells.second @ np.ones(len(mesh.points)) == pytest.approx(np.ones(cells.count), abs=1e-13)
    assert cells.second @ mesh.points == pytest.approx(cells.points, abs=1e-13)


def test_size_gathers_facets() -> None:
    mesh = box((0.08, 0.04, 0.01), (16, 8, 1), order=1)
    every = make_cells(mesh, "face", Matched(first="z_max"))
    coarse = make_cells(mesh, "face", Matched(first="z_max", size=0.01))
    assert (every.count, coarse.count) == (128, 32)
    assert coarse.area == pytest.approx(np.full(32, 1e-4))
    turned_mesh = moved(mesh, turned(0.7))  # cells follow the rows of the mesh, not the axes
    assert make_cells(turned_mesh, "face", Matched(first="z_max", size=0.01)).area == pytest.approx(np.full(32, 1e-4))


def test_long_facets_are_gathered_along_their_short_sides() -> None:
    """Facets of 1 x 8 mm: cells of 4 mm have four of them and are as wide as a facet is, whichever way they lie."""
    for lengths, counts in (((0.064, 0.008, 0.01), (64, 1, 1)), ((0.008, 0.064, 0.01), (1, 64, 1))):
        mesh = box(lengths, counts, order=1)
        assert make_cells(mesh, "face", Matched(first="z_max", size=4e-3)).area == pytest.approx(np.full(16, 3.2e-5))
        assert make_cells(mesh, "face", Matched(first="z_max", size=9e-3)).area == pytest.approx(np.full(8, 6.4e-5))


def test_slivers_go_to_the_cell_next_to_them() -> None:
    """A face shifted by nine tenths of a facet leaves a tenth of each in one row, which makes no cells of its own."""
    for shift, count in ((0.55, 2), (0.45, 2), (0.05, 4)):
        cells = both(stacked(turned(0.0, (shift, 0.0, 0.0))))
        assert cells.count == count and cells.area.sum() == pytest.approx(1.0 - shift, rel=ROUND_OFF)
    cells = both(stacked(turned(0.0, (0.45, 0.0, 0.0))))
    assert cells.area == pytest.approx([0.275, 0.275]) and cells.points[:, 0] == pytest.approx([0.225, 0.225])


def test_growth_grades_cells_from_edges_and_holes() -> None:
    """A plate of 40 x 40 cells with a hole: small cells along its edges and around the hole, larger ones between."""
    line = np.linspace(0.0, 0.04, 41)
    filled = np.ones((40, 40, 1), dtype=bool)
    filled[18:22, 18:22] = False
    mesh = grid(line, line, [0.0, 0.001], filled=filled, order=1)
    cells = make_cells(mesh, "face", Matched(first="z_max", growth=0.5, size=4e-3))
    assert cells.area.sum() == pytest.approx(0.04**2 - 0.004**2, rel=ROUND_OFF)
    edge = np.sqrt(cells.area)
    x = cells.points[:, :2]
    outer = np.minimum(x, 0.04 - x).min(axis=1)
    hole = np.abs(x - 0.02).max(axis=1) - 0.002
    away = np.minimum(outer, hole)
    assert edge[away < 0.6e-3] == pytest.approx(np.full(np.sum(away < 0.6e-3), 1e-3), rel=0.5)
    assert 2.5e-3 < edge.max() < 4.01e-3 and cells.count < 0.5 * 1584
    assert np.all(edge <= 1e-3 + 0.5 * (away + 1.5e-3) + 1e-9)


@pytest.mark.parametrize(("thick", "angle"), [(1e-3, 0.0), (8e-3, 0.7)])
def test_cells_are_fine_at_the_edges_of_a_head_through_the_sheet(thick: float, angle: float) -> None:
    """A strip of 60 facets of 1 mm with a head from 20 to 30 mm beneath: cells grow away from these two lines alone,
    however thick the strip is, and not from its sides."""
    mesh = box((0.06, 0.001, thick), (60, 1, 1), center=(0.03, 0.0, 0.0), order=1)
    mesh = mesh.select("head", "z_min", lambda c: np.abs(c[:, 0] - 0.025) < 0.005)
    cells = make_cells(moved(mesh, turned(angle)), "face", Matched(first="z_max", growth=0.5, fine=("head",)))
    length = cells.area / 1e-3
    x = np.linalg.norm(cells.points[:, :2], axis=1)
    away = np.minimum(np.abs(x - 0.02), np.abs(x - 0.03))
    near = np.maximum(away - 0.5 * length, 0.0)  # of the facet that is nearest
    assert length.sum() == pytest.approx(0.06, rel=ROUND_OFF) and 12 < cells.count < 30
    assert length[away < 0.6e-3] == pytest.approx(np.full(4, 1e-3)) and length.max() > 4e-3
    assert np.all(length <= 1e-3 + 0.5 * near + 1e-9)


def test_a_closed_set_has_no_outline_to_be_fine_at() -> None:
    mesh = roller(0.02, 0.01, 0.01, sectors=12, layers=1, axial=1, order=1)
    every = FacetSet({"quad4": np.concatenate([one.blocks["quad4"] for one in mesh.facet_sets.values()])})
    mesh = Mesh(mesh.points, mesh.cells, {"rim": mesh.facets("rim"), "all": every})
    with pytest.raises(InputError, match="contact 'face': 'all' has no outline"):
        make_cells(mesh, "face", Matched(first="rim", growth=0.5, fine="all"))  # pyright: ignore[reportArgumentType]


def test_cells_do_not_turn_corners() -> None:
    """Around a roller a size as large as the body still leaves cells whose normals stay together."""
    mesh = roller(0.02, 0.01, 0.01, sectors=36, layers=1, axial=1, order=1)
    cells = make_cells(mesh, "face", Matched(first="rim", size=1.0))
    assert 12 <= cells.count <= 18 and cells.area.sum() > 0.0


def test_nodes_have_the_area_of_the_face() -> None:
    for kind in ("hex8", "hex20", "hex27", "tet4", "tet10"):
        mesh = as_kind(slit_body(order=2), kind)
        cells = make_cells(mesh, "lap", Matched("high", first="low", by="nodes"))
        shared = np.intersect1d(mesh.facets("low").node_set, mesh.facets("high").node_set)
        assert not len(shared) and cells.count == len(mesh.facets("low").node_set)
        assert cells.area.sum() == pytest.approx(0.05 * 0.02, rel=ROUND_OFF) and cells.area.min() > 0.0
        assert cells.gap == pytest.approx(np.full(cells.count, 0.5e-3))
        t = cells.triangles
        area = 0.5 * np.cross(t[:, 1] - t[:, 0], t[:, 2] - t[:, 0])[:, 2]
        assert area.sum() == pytest.approx(0.05 * 0.02, rel=ROUND_OFF) and area.min() > 0.0
        if kind == "hex8":
            assert np.bincount(cells.cell, weights=area) == pytest.approx(cells.area, rel=ROUND_OFF)


def test_nodes_where_the_faces_hang_together_make_no_cells() -> None:
    """A crack: both faces share the nodes of its front."""
    mesh = moved(slit_body(), lambda x: x)
    low, high = mesh.facets("low"), mesh.facets("high")
    front = low.node_set[mesh.points[low.node_set, 0] < 0.0101]
    above = high.node_set[mesh.points[high.node_set, 0] < 0.0101]
    number = np.arange(len(mesh.points))
    number[above] = front
    closed = Mesh(mesh.points, mesh.cells, {"low": low, "high": high.renumbered(number)})
    cells = make_cells(closed, "crack", Matched("high", first="low", by="nodes"))
    assert cells.count == len(low.node_set) - len(front) and "hang together" in cells.notes[0]


@pytest.mark.parametrize(
    ("sets", "says"),
    [
        (("z_max", "z_min"), "do not face each other.*apart.*back to back"),
        (("z_max", "x_min"), "do not face each other: 0 and 0.*90 degrees"),
    ],
)
def test_faces_of_a_box_do_not_face_each_other(sets, says) -> None:
    with pytest.raises(InputError, match=says):
        make_cells(box((1.0, 1.0, 0.2), (2, 2, 1), order=1), "lap", Matched(sets[1], first=sets[0]))


def test_faces_side_by_side() -> None:
    mesh = stacked(turned(0.0, (1.5, 0.0, 0.0)))
    with pytest.raises(InputError, match="'lap'.*'a z_max' and 'b z_min'.*corners are 0.5 m apart.*side by side"):
        both(mesh)


def test_nodes_that_do_not_match() -> None:
    with pytest.raises(InputError, match="by='nodes'.*'b z_min'.*9 have none.*misses the nearest by 0.167 m"):
        both(stacked(turned(0.0)), by="nodes")
    with pytest.raises(InputError, match="nothing opposite"):
        make_cells(box((1.0, 1.0, 0.2), (2, 2, 1), order=1), "lap", Matched("z_min", first="z_max", by="nodes"))


def test_interference_is_a_negative_gap() -> None:
    cells = both(stacked(turned(0.0), gap=-1e-4))
    assert cells.gap == pytest.approx(np.full(cells.count, -1e-4))
