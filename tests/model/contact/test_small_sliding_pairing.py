"""Faces of two bodies: which cells lie on each other, with which weights, and how far apart."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from warpffrf.model.errors import InputError
from warpffrf.model.small_sliding.facing import Triangles, areas, clipped, facing, pair_faces


def plate(counts: tuple[int, int], up: bool, shift=(0.0, 0.0, 0.0)):
    """Triangles of a unit square in squares of its own, looking up or down, and the square of each."""
    x, y = (np.linspace(0.0, 1.0, n + 1) for n in counts)
    triangles, cell = [], []
    for i in range(counts[0]):
        for j in range(counts[1]):
            a, b, c, d = ((x[i], y[j]), (x[i + 1], y[j]), (x[i + 1], y[j + 1]), (x[i], y[j + 1]))
            for corners in ((a, b, c), (a, c, d)):
                triangles.append([(*p, 0.0) for p in (corners if up else corners[::-1])])
                cell.append(i * counts[1] + j)
    normals = np.tile([0.0, 0.0, 1.0 if up else -1.0], (counts[0] * counts[1], 1))
    return np.array(triangles) + np.array(shift), np.array(cell), normals


def test_weights_are_shared_areas_where_cells_nest() -> None:
    """Halves on quarters along x."""
    first, cell, normals = plate((2, 1), True)
    second, other, _ = plate((4, 1), False, (0.0, 0.0, 0.01))
    found = pair_faces("contact 'l'", first, cell, normals, second, other)
    assert found.weights.toarray() == pytest.approx(np.array([[1, 1, 0, 0], [0, 0, 1, 1]]) / 2.0, abs=1e-14)
    assert found.gap == pytest.approx([0.01, 0.01])
    assert found.covered == pytest.approx([1.0, 1.0]) and found.shares == pytest.approx((1.0, 1.0))


@pytest.mark.parametrize("counts", [((2, 1), (3, 1)), ((6, 4), (3, 2)), ((5, 3), (7, 4)), ((7, 4), (4, 3))])
def test_weights_are_exact_for_linear_displacements(counts) -> None:
    """Forces act where their cells are, and faces that turn together do not part, whatever the cells: shared areas
    alone would put the force of half a face 1/12 of its cell next to it, on thirds."""
    first, cell, normals = plate(counts[0], True)
    second, other, _ = plate(counts[1], False, (0.0, 0.0, 0.01))
    W = pair_faces("contact 'l'", first, cell, normals, second, other).weights
    middles = [
        np.array([t[c == i].mean(axis=(0, 1)) for i in range(c.max() + 1)]) for t, c in ((first, cell), (second, other))
    ]
    assert W.sum(axis=1) == pytest.approx(1.0, abs=1e-14)
    assert (W @ middles[1])[:, :2] == pytest.approx(middles[0][:, :2], abs=1e-14)
    assert np.abs(W.toarray()).max() < 1.5


def test_a_tilted_face_has_its_mean_distance() -> None:
    first, cell, normals = plate((4, 1), True)
    second, other, _ = plate((1, 1), False)
    second[..., 2] = 0.01 + 0.02 * second[..., 0]
    found = pair_faces("contact 'l'", first, cell, normals, second, other)
    assert found.gap == pytest.approx(0.01 + 0.02 * np.array([0.125, 0.375, 0.625, 0.875]), abs=1e-15)
    assert found.shares == pytest.approx((1.0, 1.0))


def test_cells_off_the_other_face_are_left_out() -> None:
    first, cell, normals = plate((4, 1), True)
    second, other, _ = plate((1, 1), False, (0.375, 0.0, 0.0))
    found = pair_faces("contact 'l'", first, cell, normals, second, other)
    assert found.cell.tolist() == [1, 2, 3] and found.covered == pytest.approx([0.5, 1.0, 1.0])
    assert found.shares == pytest.approx((0.625, 0.625))


@pytest.mark.parametrize(
    ("second", "says"),
    [
        (plate((1, 1), False, (2.0, 0.0, 0.0))[0], "nearest corners are 1 m apart, they lie side by side"),
        (plate((1, 1), False, (0.0, 0.0, 0.8))[0], "0 and 0 of their areas.*0.8 m apart.*far apart"),
        (plate((1, 1), False, (0.0, 0.0, -0.1))[0], "back to back with material between"),
        (plate((1, 1), True, (0.0, 0.0, 0.01))[0], "their outward normals look the same way"),
    ],
)
def test_faces_that_do_not_face_each_other(second, says) -> None:
    first, cell, normals = plate((2, 1), True)
    with pytest.raises(InputError, match=f"contact 'l': the faces do not face each other: .*{says}"):
        pair_faces("contact 'l'", first, cell, normals, second, np.zeros(2, dtype=int))


def test_pieces_fill_what_is_covered_for_any_turn() -> None:
    """The covered area does not depend on which of two surfaces is looked from, where they are parallel."""
    rng = np.random.default_rng(1)
    first, second = plate((5, 4), True)[0], plate((3, 7), False)[0]
    for angle in rng.uniform(0.0, 2.0 * np.pi, 5):
        c, s = np.cos(angle), np.sin(angle)
        turned = (second - 0.5) @ np.array([[c, s, 0.0], [-s, c, 0.0], [0.0, 0.0, 1.0]]) + np.array([0.6, 0.5, 0.52])
        a, b = Triangles.of(first), Triangles.of(turned)
        there, back = facing(a, b), facing(b, a)
        assert there.area.sum() == pytest.approx(back.area.sum(), rel=1e-12)
        assert there.covered == pytest.approx(back.covered[::-1], rel=1e-12)
        assert np.abs(there.weights.sum(axis=2) - 1.0).max() < 1e-12 and there.weights.min() > -1e-12


def test_edges_that_coincide_but_for_round_off_are_cut() -> None:
    """Corners on a window's edge, to and fro across it by round-off: more crossings than a convex polygon has."""
    wave = 1e-17 * np.array([1.0, -1.0, 1.0, -1.0])
    bottom = np.column_stack([[0.0, 0.25, 0.5, 1.0], wave])
    polygon = np.vstack([bottom, [[0.5, 1.0]]])[None]
    window = np.array([[[-1.0, 0.0], [2.0, 0.0], [0.5, 3.0]]])
    pieces, count = clipped(polygon, np.array([5]), window)
    assert areas(pieces, count)[0] == pytest.approx(0.5, rel=1e-15)


def test_free_meshes_of_one_outline_cover_each_other() -> None:
    """What a flange is: edges of both along the same lines, in oblique axes, cut by one another."""
    rng = np.random.default_rng(5)
    turn = Rotation.from_rotvec([0.3, 0.7, -0.2]).as_matrix()
    faces = []
    for sign, cuts in ((1, 7), (-1, 11)):
        x = np.concatenate([[0.0], np.sort(rng.uniform(0.0, 1.0, cuts)), [1.0]])
        rim = np.vstack(
            [np.column_stack([a, b]) for a, b in ((x, 0 * x), (1 + 0 * x, x), (1 - x, 1 + 0 * x), (0 * x, 1 - x))]
        )
        ends = np.roll(rim, -1, axis=0)
        fan = np.stack([np.broadcast_to([0.5, 0.5], rim.shape), rim, ends], axis=1)
        fan = fan[np.linalg.norm(ends - rim, axis=1) > 0][:, ::sign]
        faces.append(Triangles.of(np.dstack([fan, np.zeros(fan.shape[:2])]) @ turn.T))
    first, second = faces
    found = facing(first, second)
    assert found.covered == pytest.approx((1.0, 1.0), abs=1e-12)
