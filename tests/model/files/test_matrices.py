"""Bodies from matrices: the order of rows, units, facets, and every refusal with its cure."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import scipy.sparse as sp
from scipy.io import mmwrite

from warpffrf.model import mesh as wfmesh
from warpffrf.model.errors import InputError
from warpffrf.model.material import Material
from warpffrf.model.mesh import FacetSet, Mesh
from warpffrf.model.mesh.files.matrices import from_matrices
from warpffrf.model.mesh.files.matrices.build import require_semidefinite
from warpffrf.model.mesh.files.matrices.inner_side import RIGID
from warpffrf.offline.fe import assemble, assign

STEEL = Material(210e9, 0.3, 7850.0)
rng = np.random.default_rng(11)


@pytest.fixture(scope="module")
def body() -> tuple[Mesh, Any, Any]:
    """A roller of 8 x 2 x 2 hexahedra with its K and M."""
    mesh = wfmesh.roller(0.05, 0.015, 0.02, sectors=8, layers=2, axial=2, order=1)
    K, M = assemble(mesh.points, mesh.cells, assign(mesh, STEEL))
    return mesh, K, M


def dofs_in_order(n: int) -> np.ndarray:
    return np.stack([np.repeat(np.arange(n), 3), np.tile(np.arange(3), n)], axis=1)


def equal(a: Mesh, K: Any, M: Any, tolerance: float = 1e-15) -> None:
    assert a.matrices is not None
    assert abs(a.matrices.stiffness - K).max() <= tolerance * abs(K).max()
    assert abs(a.matrices.mass - M).max() <= tolerance * abs(M).max()


def test_arrays_and_sparse_matrices(body: tuple[Mesh, Any, Any]) -> None:
    mesh, K, M = body
    made = from_matrices(M, K, mesh.points, facets=mesh.facet_sets, name="roller")
    equal(made, K, M)
    assert made.cells == {} and made.sets == mesh.sets and made.name == "roller"
    assert made.matrices is not None and made.matrices.mass.shape == (3 * len(mesh.points),) * 2
    equal(from_matrices(M.toarray(), sp.coo_array(K), mesh.points.tolist()), K, M)
    assert made.check() is made
    assert made.content_hash() != mesh.content_hash()


def test_any_order_of_rows(body: tuple[Mesh, Any, Any]) -> None:
    mesh, K, M = body
    n = len(mesh.points)
    order = rng.permutation(3 * n)
    mixed = [A[order][:, order] for A in (M, K)]
    equal(from_matrices(mixed[0], mixed[1], mesh.points, dof_map=dofs_in_order(n)[order]), K, M)
    by_component = np.argsort(np.tile(np.arange(3), n), kind="stable")  # all x, then all y, then all z
    mixed = [A[by_component][:, by_component] for A in (M, K)]
    equal(from_matrices(mixed[0], mixed[1], mesh.points, dof_map=dofs_in_order(n)[by_component]), K, M)


def test_empty_rows_of_rotations_are_left_out(body: tuple[Mesh, Any, Any]) -> None:
    mesh, K, M = body
    n = len(mesh.points)
    place = (6 * np.arange(n)[:, None] + np.arange(3)).ravel()
    widen = sp.csr_matrix((np.ones(3 * n), (place, np.arange(3 * n))), shape=(6 * n, 3 * n))
    wide_M, wide_K = (sp.csr_matrix(widen @ A @ widen.T) for A in (M, K))
    made = from_matrices(wide_M, wide_K, mesh.points)
    equal(made, K, M)
    assert any("empty rows of rotations" in note for note in made.notes)
    stiff = wide_K.tolil()
    stiff[6 * 4 + 4, 6 * 4 + 4] = 1.0
    with pytest.raises(InputError, match="K: row 28, the rotation about y of node 4.*condense the rotations"):
        from_matrices(wide_M, stiff, mesh.points)


@pytest.mark.parametrize(("unit", "length", "force"), [("mm", 1e-3, 1.0), ("in", 0.0254, 4.4482216152605)])
def test_units(body: tuple[Mesh, Any, Any], unit: str, length: float, force: float) -> None:
    mesh, K, M = body
    factor = length / force
    made = from_matrices(factor * M, factor * K, mesh.points / length, length_unit=unit)
    equal(made, K, M, 1e-14)
    np.testing.assert_allclose(made.points, mesh.points, rtol=1e-15)
    equal(from_matrices(factor * M, factor * K, mesh.points, matrix_units=unit), K, M, 1e-14)
    assert made.notes == ()
    wrong = from_matrices(factor * M, factor * K, mesh.points / length)
    assert any("length_unit" in note for note in wrong.notes)
    with pytest.raises(InputError, match="length_unit 'furlong'.*'mm'"):
        from_matrices(M, K, mesh.points, length_unit="furlong")


def test_files_with_numbered_nodes(body: tuple[Mesh, Any, Any], tmp_path: Path) -> None:
    """Abaqus' lines carry node numbers: the order of `nodes` need not be theirs."""
    mesh, K, M = body
    n = len(mesh.points)
    numbers = 7 + 3 * rng.permutation(n)
    for name, A in (("job_MASS1", M), ("job_STIF1", K)):
        entries = sp.coo_matrix(sp.tril(A))
        rows = zip(entries.row, entries.col, entries.data, strict=True)
        text = "".join(f"{numbers[i // 3]},{i % 3 + 1}, {numbers[j // 3]},{j % 3 + 1}, {x:.17e}\n" for i, j, x in rows)
        (tmp_path / f"{name}.mtx").write_text(text)
    files = tmp_path / "job_MASS1.mtx", str(tmp_path / "job_STIF1.mtx")
    equal(from_matrices(*files, mesh.points, node_numbers=numbers), K, M)
    with pytest.raises(InputError, match=r"job_MASS1.mtx\): node \d+ is not among the 72 node_numbers"):
        from_matrices(*files, mesh.points)
    with pytest.raises(InputError, match="leave dof_map out"):
        from_matrices(*files, mesh.points, node_numbers=numbers, dof_map=dofs_in_order(n))
    with pytest.raises(InputError, match="node_numbers: a number occurs twice"):
        from_matrices(*files, mesh.points, node_numbers=numbers // 100)


def test_matrix_market_files(body: tuple[Mesh, Any, Any], tmp_path: Path) -> None:
    mesh, K, M = body
    for name, A in (("M", M), ("K", K)):
        mmwrite(tmp_path / f"{name}.mtx", A, precision=17, symmetry="symmetric")
    equal(from_matrices(tmp_path / "M.mtx", tmp_path / "K.mtx", mesh.points), K, M)


def test_slightly_unsymmetric_is_mended_and_reported(body: tuple[Mesh, Any, Any]) -> None:
    mesh, K, M = body
    noisy = K.copy()
    noisy.data = noisy.data * (1.0 + 1e-9 * rng.standard_normal(K.nnz))
    made = from_matrices(M, noisy, mesh.points)
    assert made.matrices is not None
    assert abs(made.matrices.stiffness - made.matrices.stiffness.T).max() == 0.0
    assert any("K: made symmetric" in note for note in made.notes)


def test_rounded_matrices_are_taken_and_reported(body: tuple[Mesh, Any, Any]) -> None:
    mesh, K, M = body
    single = K.astype(np.float32).astype(np.float64)
    assert any("rounded" in note for note in from_matrices(M, single, mesh.points).notes)


def spoilt(A: Any, row: int, column: int, value: float) -> Any:
    changed = A.tolil(copy=True)
    changed[row, column] = value
    return changed.tocsr()


def test_sizes_and_numbers(body: tuple[Mesh, Any, Any]) -> None:
    mesh, K, M = body
    x = mesh.points
    cases: list[tuple[Any, Any, Any, str]] = [
        (M[:-3, :-3], K, x, "M is 213 x 213 and K is 216 x 216: unequal sizes"),
        (M[:-3, :-3], K[:-3, :-3], x, "M has 213 rows, 72 nodes have 216 displacements"),
        (M, K[:, :-1], x, "K must be square, got 216 x 215"),
        (M, spoilt(K, 3, 4, np.nan), x, "K holds NaN"),
        (M, 1j * K, x, "K must be real"),
        (M, "nowhere.mtx", x, "'nowhere.mtx' does not exist"),
        (M, [["a"]], x, "K must be a SciPy sparse matrix"),
        (M, 0.0 * K, x, "K is zero"),
        (M, K, x[:3], "at least 4 nodes"),
        (M, K, x[:, :2], r"nodes must have shape \(n, 3\)"),
    ]
    for mass, stiffness, nodes, message in cases:
        with pytest.raises(InputError, match=message):
            from_matrices(mass, stiffness, nodes)


def test_unsymmetric(body: tuple[Mesh, Any, Any]) -> None:
    mesh, K, M = body
    with pytest.raises(InputError, match="K is not symmetric.*friction"):
        from_matrices(M, spoilt(K, 0, 5, 2.0 * abs(K).max()), mesh.points)
    with pytest.raises(InputError, match="only one triangle is there"):
        from_matrices(M, sp.triu(K), mesh.points)


def test_indefinite(body: tuple[Mesh, Any, Any]) -> None:
    mesh, K, M = body
    with pytest.raises(InputError, match="K is not positive: 216 of 216 diagonal"):
        from_matrices(M, -K, mesh.points)
    with pytest.raises(InputError, match="M is not positive: 1 of 216 .*component 2 of node 1.*density"):
        from_matrices(spoilt(M, 5, 5, 0.0), K, mesh.points)
    a, b = 30, 33  # neighbours on the same line
    stretch = sp.csr_matrix(([1.0, 1.0, -1.0, -1.0], ([a, b, a, b], [b, a, a, b])), shape=M.shape)  # no mass in total
    with pytest.raises(InputError, match="M is indefinite, it has 1 negative eigenvalue"):
        from_matrices(M + 0.8 * M.diagonal().min() * stretch, K, mesh.points)


@pytest.mark.parametrize("size", [60, 6000])
def test_negative_eigenvalues_are_found(size: int) -> None:
    """A chain of springs with one negative one, found by count in a small matrix and by Lanczos in a large one."""

    def chain(middle: float) -> Any:
        k = np.ones(size - 1)
        k[size // 2] = middle
        beside = sp.csr_matrix((-k, (np.arange(size - 1), np.arange(1, size))), shape=(size, size))
        return beside + beside.T + sp.diags_array(np.append(k, 0) + np.append(0, k), format="csr")

    with pytest.raises(InputError, match="chain is indefinite"):
        require_semidefinite(chain(-0.4), "chain")
    require_semidefinite(chain(1.0), "chain")


def test_order_of_nodes(body: tuple[Mesh, Any, Any]) -> None:
    mesh, K, M = body
    x = mesh.points.copy()
    x[[3, 4]] = x[[4, 3]]
    with pytest.raises(InputError, match=r"rigid rotation about .* nodes, the first is number \d+; the order of nodes"):
        from_matrices(M, K, x)
    with pytest.raises(InputError, match="K does not vanish for a rigid translation.*dof_map"):
        order = np.argsort(np.tile(np.arange(3), len(x)), kind="stable")
        from_matrices(M[order][:, order], K[order][:, order], mesh.points)
    with pytest.raises(InputError, match="M and K look exchanged"):
        from_matrices(K, M, mesh.points)
    near = mesh.points + 1e-8 * rng.standard_normal(x.shape)  # rounded to nanometres: below the tolerance
    assert from_matrices(M, K, near).notes
    assert 1e-8 / 0.1 < RIGID


def test_mass_in_another_order_than_stiffness(body: tuple[Mesh, Any, Any]) -> None:
    mesh, K, M = body
    order = (3 * rng.permutation(len(mesh.points))[:, None] + np.arange(3)).ravel()
    with pytest.raises(InputError, match="M couples nodes that K does not.*one run"):
        from_matrices(M[order][:, order], K, mesh.points)
    order = np.arange(M.shape[0])
    order[:9] = order[:9].reshape(3, 3)[:, [2, 0, 1]].ravel()
    heavy = M + sp.diags_array(np.tile([0.0, 0.0, 1e-3], len(mesh.points)))
    with pytest.raises(InputError, match="M: the mass along x, y, z is .* must be the same"):
        from_matrices(heavy, K, mesh.points)


def test_supports(body: tuple[Mesh, Any, Any]) -> None:
    mesh, K, M = body
    with pytest.raises(InputError, match="diagonal entries are above 1e[+]30, the first at node 2: Abaqus"):
        from_matrices(M, spoilt(K, 7, 7, 1e36), mesh.points)
    springs = K + sp.diags_array(np.where(np.arange(K.shape[0]) < 9, 1e8, 0.0))
    with pytest.raises(InputError, match="at 3 of 72 nodes, the first is number 0; .*held by supports"):
        from_matrices(M, springs, mesh.points)


def test_several_bodies_and_mechanisms(body: tuple[Mesh, Any, Any]) -> None:
    mesh, K, M = body
    two = [sp.block_diag([A, A], format="csr") for A in (M, K)]
    with pytest.raises(InputError, match="K consists of 2 unconnected bodies, the largest of 72, 72 nodes"):
        from_matrices(two[0], two[1], np.concatenate([mesh.points, mesh.points + [0.0, 0.1, 0.0]]))
    # two cells that share an edge: a hinge
    x = np.array([(i, j, k) for k in (0, 1) for j in (0, 1) for i in (0, 1)], float)
    beyond = [(2, 1, 0), (2, 2, 0), (1, 2, 0), (2, 1, 1), (2, 2, 1), (1, 2, 1)]
    points = np.concatenate([x, np.array(beyond, float)])
    cells = np.array([[0, 1, 3, 2, 4, 5, 7, 6], [3, 8, 9, 10, 7, 11, 12, 13]])
    hinge = Mesh(points, {"hex8": cells}).check()
    K, M = assemble(hinge.points, hinge.cells, assign(hinge, STEEL))
    with pytest.raises(InputError, match="K has 7 motions without energy"):
        from_matrices(M, K, points)


def test_dof_map(body: tuple[Mesh, Any, Any]) -> None:
    mesh, K, M = body
    dofs = dofs_in_order(len(mesh.points))
    cases = [
        (dofs[:-1], r"integers of shape \(216, 2\)"),
        (dofs.astype(float), "float64"),
        (np.where(dofs == 71, 72, dofs), r"row 213 is \[72, 0\]; nodes count from 0"),
        (np.where(dofs == 2, 6, dofs), r"row 2 is \[0, 6\]; components are 0, 1, 2"),
        (np.concatenate([dofs[:1], dofs[:1], dofs[2:]]), "rows 0 and 1 are both component 0 of node 0"),
    ]
    for dof_map, message in cases:
        with pytest.raises(InputError, match=message):
            from_matrices(M, K, mesh.points, dof_map=dof_map)
    with pytest.raises(InputError, match="M: 3 of 216 displacements have no row, the first is component 0 of node 71"):
        from_matrices(M[:-3, :-3], K[:-3, :-3], mesh.points, dof_map=dofs[:-3])


def test_facets_by_width_and_kind(body: tuple[Mesh, Any, Any]) -> None:
    mesh, K, M = body
    kind, rim = mesh.facets("rim").single
    given = {"a": rim, "b": {kind: mesh.facets("bore").single[1]}, "c": mesh.facets("ends")}
    made = from_matrices(M, K, mesh.points, facets=given)
    assert made.sets == {"a": len(rim), "b": mesh.sets["bore"], "c": mesh.sets["ends"]}
    assert len(made.outer_facets()) == len(mesh.outer_facets())
    np.testing.assert_array_equal(made.facets("a").single[1], rim)


def test_bad_facets(body: tuple[Mesh, Any, Any]) -> None:
    mesh, K, M = body
    rim = mesh.facets("rim").single[1]
    one_turned = rim.copy()
    one_turned[0] = one_turned[0, ::-1]
    whole = {name: facets.single[1] for name, facets in mesh.facet_sets.items()}
    cases: list[tuple[Any, str]] = [
        (["rim"], "facets must be {set name: nodes .m, k.}, got list"),
        ({"rim": rim + 1}, r"facets 'rim': node numbers must lie in 0 to 71, got .* to 72; they count"),
        ({"rim": rim[:, [0, 1, 2, 3, 0]]}, r"shape \(m, k\).*3 \(tri3\), 4 \(quad4\)"),
        ({"rim": rim.astype(float)}, "must be integers"),
        ({"rim": {"quad5": rim}}, "facet kind 'quad5' does not exist"),
        ({"rim": rim[:0]}, "the set is empty"),
        ({"rim": rim[:, [0, 1, 0, 1]]}, "without area, the first is number 0"),
        ({"rim": one_turned}, "facets 'rim': two facets pass the edge from node"),
        ({**whole, "rim": rim[:, ::-1]}, "'ends' together: two facets pass the edge"),
        ({name: nodes[:, ::-1] for name, nodes in whole.items()}, "enclose a negative volume.*reverse"),
        ({"rim": rim[:, ::-1]}, "facets 'rim': the normals point into the body; reverse"),
        ({"rim": np.array([[0, 20, 40, 60]])}, "facets 'rim': 1 quad4 facet.s. are no face of a cell"),
    ]
    for facets, message in cases:
        with pytest.raises(InputError, match=message):
            from_matrices(M, K, mesh.points, facets=facets)
    repeated = {**whole, "part of the rim": FacetSet({"quad4": rim[:3]})}  # a facet in two sets is no fault
    assert from_matrices(M, K, mesh.points, facets=repeated).sets["part of the rim"] == 3
