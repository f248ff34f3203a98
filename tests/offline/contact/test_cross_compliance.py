"""What loads on one contact surface of a body do to its others: against full finite elements, the other direction, the
other path, and operators of finer grids."""

from __future__ import annotations

from dataclasses import replace
from itertools import combinations
from pathlib import Path

import numpy as np
import pytest
from offline_bodies import STEEL, reduced
from reference_fe import free_response, matrices

from warpffrf.model.errors import InputError
from warpffrf.model.mesh import Mesh, box, roller
from warpffrf.model.mesh.facets import rigid_modes
from warpffrf.model.reduced.body import ReducedBody
from warpffrf.model.reduced.contact_surface import FUNCTIONS, CrossCompliance
from warpffrf.model.surfaces import Bore, Cylinder
from warpffrf.offline.general.unit_loads import results_bytes
from warpffrf.offline.quality import coupling

EXACT = 1e-9  # static responses are exact for any number of modes; what is left is two solvers' rounding
QUADRATURE = 1e-8  # coarse functions take other rules for the normal, which turns within a facet
SYMMETRIC = 1e-11  # solves of one factorised matrix: rounding times its condition
RING = {"rim": Cylinder(), "bore": Bore()}
FACES = ("z_max", "z_min", "y_max")  # two that face each other, and one at a right angle with a common edge


@pytest.fixture(scope="module")
def sheet() -> Mesh:
    return box((0.03, 0.02, 0.006), (5, 3, 2), order=1)


@pytest.fixture(scope="module")
def ring() -> Mesh:
    return roller(0.05, 0.03, 0.02, sectors=18, layers=2, axial=2, order=1)


def of_sheet(mesh: Mesh, held: list[str], **settings) -> ReducedBody:
    given = {"contact": dict.fromkeys(FACES), "interfaces": dict.fromkeys(held, "rigid"), "tangential": "nodes"}
    return reduced(mesh, **{**given, **settings})


def own(body: ReducedBody, name: str) -> np.ndarray:
    """The compliance of one surface for forces (normal, around, along): its tangential part with it, where it is."""
    s = body.contact_surfaces[name]
    columns = np.arange(s.grid.columns)
    D = s.compliance(columns)
    if s.tangential is None:
        return D
    D_nt = s.tangential.coupling(columns, columns)
    return np.block([[D, D_nt], [D_nt.T, s.tangential.compliance(columns)]])


def between(body: ReducedBody, target: str, source: str) -> np.ndarray:
    """The same of two surfaces."""
    cross = body.cross_compliance(target, source)
    assert cross is not None
    if cross.lags_tt is None:
        return cross.whole()
    return np.block([[cross.whole(), cross.whole("lags_nt")], [cross.whole("lags_tn"), cross.whole("lags_tt")]])


def relative(a: np.ndarray, b: np.ndarray) -> float:
    return float(np.abs(a - b).max() / np.abs(b).max())


# --- against full finite elements ---


def node_mass(nodes: np.ndarray) -> np.ndarray:
    """Mass matrix of the piecewise linear functions on the line of `nodes`."""
    M = np.zeros((len(nodes), len(nodes)))
    for i, h in enumerate(np.diff(nodes)):
        M[i : i + 2, i : i + 2] += h / 6.0 * np.array([[2.0, 1.0], [1.0, 2.0]])
    return M


def face_loads(mesh: Mesh, body: ReducedBody, name: str) -> tuple[np.ndarray, np.ndarray]:
    """On a face of linear hexahedra the nodes are the shape functions: loads B (3 n, 3 shape functions) of unit normal
    pressures and tangential tractions, and the Gram matrix of the nodes."""
    s = body.contact_surfaces[name]
    theta = s.grid.theta
    whole = np.concatenate([[theta[0] - s.grid.pitch], theta, [theta[-1] + s.grid.pitch]])
    M = np.kron(node_mass(whole), node_mass(s.grid.z))  # all nodes of the face
    places = s.shape.point(*np.meshgrid(whole, s.grid.z, indexing="ij")).reshape(-1, 3)
    node = [int(np.argmin(np.linalg.norm(mesh.points - x, axis=1))) for x in places]
    assert np.abs(mesh.points[node] - places).max() < 1e-12
    kept = slice(s.grid.rows, -s.grid.rows)
    B = np.zeros((len(mesh.points), 3, 3, s.local_modes))
    for d, vector in enumerate((s.shape.normal(0.0, 0.0), s.shape.around(0.0), s.shape.along(0.0, 0.0))):
        B[node, :, d] = vector[:, None] * M[:, None, kept]
    return B.reshape(3 * len(mesh.points), -1), np.kron(np.eye(3), M[kept, kept])


def constraint(mesh: Mesh, held: list[str]) -> tuple[np.ndarray, np.ndarray]:
    """T (3 n, n^) with the sets `held` rigid, and the rigid modes (n^, 6)."""
    groups = [mesh.facets(name).node_set for name in held]
    free = np.setdiff1d(np.arange(len(mesh.points)), np.concatenate([*groups, []]))
    T = np.zeros((3 * len(mesh.points), 3 * len(free) + 6 * len(groups)))
    T[(3 * free[:, None] + np.arange(3)).ravel(), np.arange(3 * len(free))] = 1.0
    R = [rigid_modes(mesh.points[free], np.zeros(3))]
    for i, nodes in enumerate(groups):
        first = 3 * len(free) + 6 * i
        T[(3 * nodes[:, None] + np.arange(3)).ravel(), first : first + 6] = rigid_modes(mesh.points[nodes], np.zeros(3))
        R.append(np.eye(6))
    return T, np.concatenate(R)


@pytest.mark.parametrize("held", [[], ["x_min"], ["x_min", "x_max"]], ids=["free", "one end", "both ends"])
def test_the_answer_of_another_surface_is_that_of_full_finite_elements(sheet: Mesh, held: list[str]) -> None:
    """Normal and tangential loads on each face, seen on each: modes and local modes together, for 0 and more modes."""
    K, M = matrices(sheet, STEEL)
    T, R = constraint(sheet, held)
    bodies = [of_sheet(sheet, held, modes=modes) for modes in (0, 4, 30)]
    B, gram = zip(*(face_loads(sheet, bodies[0], name) for name in FACES), strict=True)
    u = [T @ free_response(T.T @ K @ T, T.T @ M @ T, R, T.T @ b) for b in B]
    for body in bodies:
        stiffness = (2.0 * np.pi * body.frequencies) ** 2
        traces = []
        for name in FACES:
            s = body.contact_surfaces[name]
            assert s.tangential is not None
            traces.append(np.concatenate([s.mode_normal, *s.tangential.mode_tangent]))
        for t, target in enumerate(FACES):
            for s, source in enumerate(FACES):
                D = own(body, target) if t == s else between(body, target, source)
                total = (D + (traces[t] / stiffness) @ traces[s].T) @ gram[s]  # per traction
                assert relative(total, np.linalg.solve(gram[t], B[t].T @ u[s])) < EXACT


# --- symmetry, order, definiteness ---


def test_both_directions_are_one_operator(sheet: Mesh) -> None:
    """Surfaces in the other order: the other direction is computed."""
    body = of_sheet(sheet, ["x_min"], modes=6)
    turned = of_sheet(sheet, ["x_min"], modes=6, contact=dict.fromkeys(reversed(FACES)))
    pairs = [(c.target, c.source) for c in body.cross]
    assert pairs == list(combinations(FACES, 2))
    assert {(c.source, c.target) for c in turned.cross} == set(pairs)
    for target, source in pairs:
        computed, other = body.cross_compliance(target, source), turned.cross_compliance(target, source)
        assert computed is not None and other is not None
        assert any(computed is c for c in body.cross) and not any(other is c for c in turned.cross)
        for key in FUNCTIONS:
            assert relative(other.whole(key), computed.whole(key)) < SYMMETRIC


@pytest.mark.parametrize("general", [False, True])
def test_own_and_foreign_compliances_are_one_definite_matrix(ring: Mesh, general: bool) -> None:
    body = reduced(ring, contact=RING, interfaces={}, modes=10, tangential="nodes", general=general)
    D = np.block([[own(body, t) if t == s else between(body, t, s) for s in RING] for t in RING])
    assert np.abs(D - D.T).max() < SYMMETRIC * D.max()
    values = np.linalg.eigvalsh(0.5 * (D + D.T))
    assert values[0] > -1e-13 * values[-1]  # rounding of eigenvalues
    assert 0.0 < coupling(body.cross[0], *body.contact_surfaces.values()) < 1.0


def test_transposed_blocks() -> None:
    """Of a block-circulant operator between unlike grids, with all functions: the whole matrix transposed."""
    random = np.random.default_rng(3)
    shapes = {"lags": (4, 6), "lags_tt": (8, 12), "lags_nt": (4, 12), "lags_tn": (8, 6)}
    cross = CrossCompliance("a", "b", **{key: random.standard_normal((5, *shape)) for key, shape in shapes.items()})
    turned = cross.transposed()
    assert (turned.target, turned.source) == ("b", "a")
    swapped = {"lags": "lags", "lags_tt": "lags_tt", "lags_nt": "lags_tn", "lags_tn": "lags_nt"}
    for key, other in swapped.items():
        assert np.array_equal(turned.whole(other), cross.whole(key).T)
        assert np.array_equal(turned.transposed().arrays()[key], cross.arrays()[key])


def test_layout_of_the_blocks() -> None:
    """As the class says it, entry by entry."""
    sectors, c_t, rows_t, c_s, rows_s = 3, 2, 2, 1, 3
    lags = np.random.default_rng(1).standard_normal((sectors, c_t * rows_t, c_s * rows_s))
    D = CrossCompliance("a", "b", lags).whole()
    for j, k, i, m in np.ndindex(sectors * c_t, rows_t, sectors * c_s, rows_s):
        entry = lags[(j // c_t - i // c_s) % sectors][(j % c_t) * rows_t + k, (i % c_s) * rows_s + m]
        assert D[j * rows_t + k, i * rows_s + m] == entry


@pytest.mark.parametrize("general", [False, True])
def test_a_surface_that_is_there_twice_sees_itself(ring: Mesh, general: bool) -> None:
    """Between two surfaces on the same facets the compliance is their own."""
    mesh = ring.select("again", "rim", lambda centers: np.ones(len(centers), dtype=bool))
    contact = {"rim": Cylinder(), "again": Cylinder()}
    body = reduced(mesh, contact=contact, modes=4, tangential=True, general=general)
    assert relative(between(body, "again", "rim"), own(body, "rim")) < SYMMETRIC
    assert body.report["contact"]["rim"]["coupling"] == {"again": pytest.approx(1.0)}


# --- cyclic path ---


@pytest.mark.parametrize(
    ("sectors", "order", "kinds"),
    [(18, 1, ("nodes", "cells")), (9, 2, ("nodes", "nodes")), (12, 1, ("cells", "cells"))],
)
@pytest.mark.parametrize("modes", [0, 10])
def test_both_paths_agree(sectors: int, order: int, kinds: tuple[str, str], modes: int) -> None:
    mesh = roller(0.05, 0.03, 0.02, sectors=sectors, layers=2, axial=2 // order, order=order)
    how = {"contact": RING, "interfaces": {}, "modes": modes, "traction": kinds[0], "tangential": kinds[1]}
    cyclic, general = reduced(mesh, **how), reduced(mesh, general=True, **how)
    assert (cyclic.report["path"], general.report["path"]) == ("cyclic", "general")
    ((one,), (other,)) = cyclic.cross, general.cross
    assert (one.target, one.source) == (other.target, other.source) == ("rim", "bore")
    assert len(one.lags) == sectors and len(other.lags) == 1
    for key in FUNCTIONS:
        assert relative(one.whole(key), other.whole(key)) < EXACT


def test_an_arc_has_its_part_of_the_full_turn(ring: Mesh) -> None:
    """Of full turns and arcs, arcs across the first sector with them."""
    mesh = ring.select("arc", "bore", lambda c: c[:, 0] > 0.4 * np.hypot(c[:, 0], c[:, 2]))
    settings = {"interfaces": {}, "modes": 5, "tangential": True}
    full = reduced(mesh, contact=RING, **settings)
    part = reduced(mesh, contact={"rim": Cylinder(), "arc": Bore()}, **settings)
    assert (full.report["path"], part.report["path"]) == ("cyclic", "cyclic")
    arc, turn = part.contact_surfaces["arc"].grid, full.contact_surfaces["bore"].grid
    steps = (arc.theta[:, None] - turn.theta) / (2.0 * np.pi)
    columns = np.argmin(np.abs(steps - np.round(steps)), axis=1)
    assert 1 < len(columns) < turn.columns and not arc.periodic
    for key, (a, b) in FUNCTIONS.items():
        cross, whole = part.cross_compliance("rim", "arc"), full.cross_compliance("rim", "bore")
        assert cross is not None and whole is not None and len(cross.lags) == 1
        D = whole.whole(key).reshape(len(whole.whole(key)), b, turn.columns, -1)[:, :, columns]
        assert relative(cross.whole(key), D.reshape(len(D), -1)) < SYMMETRIC
        assert a * 18 * 3 == len(D)


@pytest.mark.parametrize(
    ("inner", "planes", "strides", "sectors"), [(0.02, 1.0, (1, 2), 1), (0.02, 3.0, (3, 3), 6), (0.045, 2.3, (2, 2), 9)]
)
def test_grids_coarser_than_the_sectors(inner: float, planes: float, strides: tuple[int, int], sectors: int) -> None:
    """Hats of several sectors are sums of fine ones: the compliance of coarse grids follows from that of fine ones,
    with one stride on both surfaces, and with two."""
    mesh = roller(0.05, inner, 0.02, sectors=18, layers=2, axial=1, order=1)
    settings = {"contact": RING, "interfaces": {}, "modes": 5}
    fine = reduced(mesh, **settings)
    coarse = reduced(mesh, spacing=planes * 2.0 * np.pi / 18.0 * 0.05, **settings)
    assert coarse.report["path"] == "cyclic" and len(coarse.cross[0].lags) == sectors
    sums = []
    for name, stride in zip(RING, strides, strict=True):
        s = fine.contact_surfaces[name]
        assert coarse.contact_surfaces[name].grid.columns == 18 // stride
        sums.append(_sums(s.grid.columns, stride, s.grid.rows) @ np.kron(s.grid.gram_theta(), s.gram_z))
    grams = [np.kron(s.grid.gram_theta(), s.gram_z) for s in coarse.contact_surfaces.values()]
    C = sums[0] @ between(fine, "rim", "bore") @ sums[1].T
    expected = np.linalg.solve(grams[1], np.linalg.solve(grams[0], C).T).T
    assert relative(between(coarse, "rim", "bore"), expected) < QUADRATURE


def _sums(columns: int, stride: int, rows: int) -> np.ndarray:
    """Coarse nodes (columns/stride rows) as sums of fine ones, around."""
    place = np.arange(columns)
    away = np.abs(place[:, None] - place[::stride])
    away = np.minimum(away, columns - away)
    return np.kron(np.maximum(0.0, 1.0 - away / stride).T, np.eye(rows))


# --- the body that keeps it ---


def test_one_surface_has_none(ring: Mesh) -> None:
    body = reduced(ring)
    assert body.cross == () and body.report["contact"]["rim"]["coupling"] == {}
    assert "coupling" not in body.info()
    with pytest.raises(InputError, match="'rim' and 'rim' are not two contact surfaces of this body; it has 'rim'"):
        body.cross_compliance("rim", "rim")


def test_file_and_report(ring: Mesh, tmp_path: Path) -> None:
    body = reduced(ring, contact=RING, interfaces={}, modes=6, tangential=True)
    again = ReducedBody.load(body.save(tmp_path / "body.h5"))
    assert again.content_hash() == body.content_hash()
    for target, source in (("rim", "bore"), ("bore", "rim")):
        a, b = body.cross_compliance(target, source), again.cross_compliance(target, source)
        assert a is not None and b is not None and (b.target, b.source) == (target, source)
        assert all(np.array_equal(b.arrays()[key], a.arrays()[key]) for key in FUNCTIONS)
    assert body.report["quality"]["memory"]["cross/rim/bore/lags_tt"] == body.cross[0].arrays()["lags_tt"].nbytes
    assert f"rim with those of bore {body.report['contact']['rim']['coupling']['bore']:.2g}" in body.info()
    changed = replace(body.cross[0], lags=2.0 * body.cross[0].lags)
    assert replace(body, cross=(changed,)).content_hash() != body.content_hash()


WRONG = {
    "a row less": (
        {"lags": np.zeros((18, 2, 3))},
        r"cross/rim/bore/lags must have shape \(18, 3, 3\), got \(18, 2, 3\)",
    ),
    "sectors that columns do not make": ({"lags": np.zeros((4, 3, 3))}, "cross/rim/bore .* do not make 4 sectors"),
    "no contact surface": ({"source": "ends"}, "cross/rim/ends is not between two contact surfaces"),
}


@pytest.mark.parametrize("what", list(WRONG))
def test_what_does_not_fit_is_refused(ring: Mesh, tmp_path: Path, what: str) -> None:
    changes, message = WRONG[what]
    body = reduced(ring, contact=RING, interfaces={}, modes=2)
    path = replace(body, cross=(replace(body.cross[0], **changes),)).save(tmp_path / "body.h5")
    with pytest.raises(InputError, match=message):
        ReducedBody.load(path)


def test_memory_counts_pairs_of_surfaces(sheet: Mesh) -> None:
    """Each dense operator with two working copies; a limit that one surface fits into is too small for all."""
    assert results_bytes([3, 5, 7], []) == 8 * 3 * (3 * 3 + 5 * 5 + 7 * 7 + 3 * 5 + 3 * 7 + 5 * 7)
    counts = [3 * 6 * 4, 3 * 6 * 4, 3 * 6 * 3]  # loads of the faces, with their edges
    skin = 3 * len(sheet.outer_facets().node_set) * 4  # of a load, single precision
    alone = sum(results_bytes([n], []) + skin * n for n in counts)
    with pytest.raises(InputError, match="the dense compliance of 198 functions of contact grids needs"):
        of_sheet(sheet, [], memory_limit=alone)


def test_what_is_left_out_between_surfaces_is_noted(ring: Mesh) -> None:
    body = reduced(ring, contact=RING, interfaces={}, modes=2, local_dynamics=True)
    assert any("mass of local modes is that of each contact surface alone" in note for note in body.report["notes"])
    assert not any("each contact surface alone" in n for n in reduced(ring, local_dynamics=True).report["notes"])
