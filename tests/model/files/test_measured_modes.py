"""Measured modes from universal files: files written here of finite elements with known changes, noise, faults; the
updated body compared with full finite elements."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import scipy.linalg

import warpffrf as wf
from warpffrf.model.errors import InputError
from warpffrf.model.mesh.facets import rigid_modes
from warpffrf.offline.fe import assign, fe_matrices

Array = np.ndarray
STEEL = wf.Material(youngs_modulus=210e9, poisson_ratio=0.3, density=7850)
SIX_DIGITS = 1e-9  # 1 - MAC of shapes in 6E13.5, of second order in their error
COUNT = 6
FACTORS = (0.97, 1.04, 1.01, 1.04, 0.98, 0.99)  # modes 3 and 4 change places
RATIOS = (0.002, 0.004, 0.001, 0.0125, 0.003, 0.02)
ORDER = [3, 0, 1, 5, 2, 4]  # of the modes in the file
AXIS, ANGLE = (1.0, 2.0, -0.5), 0.7  # rad
ORIGIN = np.array([0.03, -0.1, 0.2])


def text(number: int, lines: Sequence[str]) -> list[str]:
    return ["    -1", f"{number:6d}", *lines, "    -1"]


def integers(*values: int) -> str:
    return "".join(f"{v:10d}" for v in values)


def reals(values: Any) -> str:
    return "".join(f"{v:13.5E}" for v in values)


def nodes_15(points: Array, displaced: int = 0) -> list[str]:
    rows = [f"{integers(10 * n, 0, displaced, 1)}{reals(x)}" for n, x in enumerate(points.tolist(), start=1)]
    return text(15, rows)


def mode_55(frequency: float, ratio: float, shape: Array, *, hysteretic: bool = False) -> list[str]:
    """A mode of nodes 10, 20, ...; a complex shape by its eigenvalue."""
    if np.iscomplexobj(shape):
        w = 2.0 * np.pi * frequency
        head = [
            integers(1, 7, 2, 8, 5, 3),
            integers(2, 6, 1, 1),
            reals([-ratio * w, w * np.sqrt(1 - ratio**2), *4 * [0]]),
        ]
        values = np.stack([np.real(shape), np.imag(shape)], axis=2).reshape(len(shape), 6)
    else:
        damping = (0.0, 2.0 * ratio) if hysteretic else (ratio, 0.0)
        head = [integers(1, 2, 2, 12, 2, 3), integers(2, 4, 1, 1), reals([frequency, 1.0, *damping])]
        values = shape
    rows = [line for n, v in enumerate(values.tolist(), start=1) for line in (integers(10 * n), reals(v))]
    return text(55, [*5 * ["NONE"], *head, *rows])


def written(path: Path, *parts: list[str]) -> Path:
    path.write_text("\n".join(line for part in parts for line in part) + "\n")
    return path


@pytest.fixture(scope="module")
def plate() -> tuple[Any, Any, Array, Array]:
    """Mesh and reduced body, and frequencies and shapes (COUNT, n, 3) of its elements by a dense solver."""
    mesh = wf.mesh.box((0.2, 0.07, 0.01), (8, 3, 1), order=1)
    body = wf.reduce(mesh, STEEL, interfaces={"x_min": "average"}, modes=COUNT, cache=False, progress=False)
    K, M = (A.toarray() for A in fe_matrices(mesh, assign(mesh, STEEL)))
    values, V = scipy.linalg.eigh(K, M, subset_by_index=(6, 5 + COUNT))
    return mesh, body, np.sqrt(values) / (2.0 * np.pi), V.T.reshape(COUNT, -1, 3)


def six_digits(values: Array) -> Array:
    return np.array([float(f"{v:.5E}") for v in values])


def measured(
    plate: Any, path: Path, *, noise: float = 0.0, phase: float = 0.0, directions: Sequence[int] = (0, 1, 2)
) -> Path:
    """A file in mm in the axes of a measurement: every second node of the mesh, modes in another order, known changes
    of the frequencies. `noise`: of the root mean square of each shape; `phase` [rad]: of complex shapes."""
    mesh, _, frequencies, shapes = plate
    A = axes_of_measurement()
    points = 1e3 * (mesh.points[::2] - ORIGIN) @ A
    rng = np.random.default_rng(5)
    parts = [nodes_15(points)]
    for k in ORDER:
        u = shapes[k, ::2] @ A
        u = u / np.abs(u).max()
        u += noise * np.sqrt(np.mean(u**2)) * rng.standard_normal(u.shape)
        kept = np.zeros_like(u)
        kept[:, directions] = u[:, directions]
        shape = np.exp(1j * phase) * kept if phase else kept
        parts.append(mode_55(FACTORS[k] * frequencies[k], RATIOS[k], shape))
    return written(path, *parts)


def axes_of_measurement() -> Array:
    from scipy.spatial.transform import Rotation

    return Rotation.from_rotvec(ANGLE * np.array(AXIS) / np.linalg.norm(AXIS)).as_matrix()


def compared(body: Any, path: Path, **options: Any) -> Any:
    return body.compare_modes(
        path, length_unit="mm", position=ORIGIN, rotation={"axis": AXIS, "angle": ANGLE}, **options
    )


def test_shapes_and_frequencies_without_noise(plate: Any, tmp_path: Path) -> None:
    _, body, frequencies, _ = plate
    found = compared(body, measured(plate, tmp_path / "modes.unv"))
    assert dict(found.pairs) == dict(enumerate(ORDER))
    assert np.all(found.pair_mac > 1.0 - SIX_DIGITS) and np.all(found.pair_mac < 1.0 + 1e-12)
    told = six_digits(np.array(FACTORS) * frequencies)
    updated = found.updated_body()
    assert np.allclose(updated.frequencies[:COUNT], told, rtol=1e-12, atol=0.0)
    assert np.array_equal(updated.frequencies[COUNT:], body.frequencies[COUNT:])
    ratios = found.damping(rest=0.05)
    assert np.allclose(ratios[:COUNT], RATIOS, rtol=1e-12) and np.all(ratios[COUNT:] == 0.05)
    assert np.all(found.distances < 1e-6)  # coordinates have six digits
    assert "computed modes without a partner: none" in str(found)


def test_criterion_is_that_of_its_definition(plate: Any, tmp_path: Path) -> None:
    """All entries, from shapes at the nodes; off the diagonal it is not zero, as there is no mass in it."""
    *_, shapes = plate
    found = compared(plate[1], measured(plate, tmp_path / "modes.unv"))
    U = shapes[:, ::2].reshape(COUNT, -1)
    own = np.sum(U * U, axis=1)
    wanted = (U @ U.T) ** 2 / (own[:, None] * own)
    assert np.max(np.abs(found.mac - wanted[ORDER])) < 1e-5


def test_with_noise(plate: Any, tmp_path: Path) -> None:
    """Noise of 2 % of the root mean square: MAC = 1/(1 + 0.02^2) but for chance."""
    _, body, *_ = plate
    found = compared(body, measured(plate, tmp_path / "modes.unv", noise=0.02))
    assert dict(found.pairs) == dict(enumerate(ORDER))
    assert np.max(np.abs(1.0 - found.pair_mac - 0.02**2)) < 2e-4


def test_complex_modes_have_the_phase_out(plate: Any, tmp_path: Path) -> None:
    _, body, frequencies, _ = plate
    found = compared(body, measured(plate, tmp_path / "modes.unv", phase=1.1))
    assert dict(found.pairs) == dict(enumerate(ORDER)) and np.all(found.pair_mac > 1.0 - SIX_DIGITS)
    assert np.allclose(found.updated_body().frequencies[:COUNT], np.array(FACTORS) * frequencies, rtol=1e-5)
    assert np.allclose(found.damping(rest=0.0)[:COUNT], RATIOS, rtol=1e-5)


def test_one_direction_only(plate: Any, tmp_path: Path) -> None:
    """Accelerometers across a plate, in the body's own axes: in-plane modes have no partner."""
    mesh, body, frequencies, shapes = plate
    across = [k for k in range(COUNT) if np.abs(shapes[k, :, 2]).max() > 0.9 * np.abs(shapes[k]).max()]
    assert 3 <= len(across) < COUNT
    parts = [nodes_15(mesh.points[::2])]
    for k in across:
        parts.append(mode_55(frequencies[k], 0.01, shapes[k, ::2] * np.array([0.0, 0.0, 1.0]), hysteretic=True))
    found = body.compare_modes(written(tmp_path / "across.uff", *parts), length_unit="m")
    assert [k for _, k in found.pairs] == across and np.all(found.pair_mac > 1.0 - SIX_DIGITS)
    assert np.allclose(found.measured_damping, 0.01, rtol=1e-12)
    assert any("directions of the points were not measured" in note for note in found.notes)


def test_equal_frequencies_in_any_combination(tmp_path: Path) -> None:
    """A square bar bends in two directions at one frequency; measured at 30 degrees to the computed ones."""
    mesh = wf.mesh.box((0.2, 0.01, 0.01), (8, 2, 2), order=1)
    body = wf.reduce(mesh, STEEL, modes=4, cache=False, progress=False)
    assert body.frequencies[1] == pytest.approx(body.frequencies[0], rel=1e-9)
    K, M = (A.toarray() for A in fe_matrices(mesh, assign(mesh, STEEL)))
    V = scipy.linalg.eigh(K, M, subset_by_index=(6, 7))[1].T.reshape(2, -1, 3)
    c, s = np.cos(np.pi / 6), np.sin(np.pi / 6)
    V = V[:, (skin := mesh.outer_facets().node_set)]
    parts = [
        nodes_15(mesh.points[skin]),
        mode_55(505.0, 0.02, s * V[0] - c * V[1]),
        mode_55(500.0, 0.01, c * V[0] + s * V[1]),
    ]
    found = body.compare_modes(written(tmp_path / "bar.unv", *parts), length_unit="m")
    assert dict(found.pairs) == {0: 1, 1: 0} and np.all(found.pair_mac > 1.0 - SIX_DIGITS)
    assert np.allclose(found.updated_body().frequencies[:2], [500.0, 505.0])


def test_updated_body_is_that_of_the_changed_stiffness(plate: Any, tmp_path: Path) -> None:
    """K' = K + M Phi diag(w^2 - omega^2) Phi^T M of all elements: its frequencies, and its static response to a load on
    the interface under inertia relief, which the modes and attachment modes of the body hold."""
    mesh, body, _, shapes = plate
    found = compared(body, measured(plate, tmp_path / "modes.unv"))
    updated = found.updated_body()
    K, M = (A.toarray() for A in fe_matrices(mesh, assign(mesh, STEEL)))
    MPhi = M @ shapes.reshape(COUNT, -1).T
    w2, omega2 = ((2.0 * np.pi * f[:COUNT]) ** 2 for f in (updated.frequencies, body.frequencies))
    changed = K + MPhi * (w2 - omega2) @ MPhi.T
    values = scipy.linalg.eigh(changed, M, eigvals_only=True, subset_by_index=(6, 5 + COUNT))
    assert np.allclose(np.sqrt(values), np.sort(2.0 * np.pi * updated.frequencies[:COUNT]), rtol=1e-7)
    R = rigid_modes(mesh.points, body.center_of_mass)
    held = M @ R
    system = np.block([[changed, 1e9 * held], [1e9 * held.T, np.zeros((6, 6))]])  # rigid accelerations as multipliers
    at = mesh.facets("x_min").node_set
    ends = np.abs(np.abs(mesh.points[at, 1]) - 0.035) < 1e-9
    for axis in (0, 2):
        f = np.zeros((len(mesh.points), 3))
        f[at, axis] = np.where(ends, 1.0, 2.0) / 12.0  # a uniform traction on 3 x 1 bilinear facets
        u = np.linalg.solve(system, np.append(f.ravel(), np.zeros(6)))[:-6]
        per_force = updated.interfaces["x_min"].modes[:, axis] ** 2 / (2.0 * np.pi) ** 2
        assert f.ravel() @ u == pytest.approx(np.sum(per_force / updated.frequencies**2), rel=1e-7)
        if axis == 2:
            assert f.ravel() @ u != pytest.approx(np.sum(per_force / body.frequencies**2), rel=1e-2)


def test_a_run_has_frequencies_and_damping(plate: Any, tmp_path: Path) -> None:
    """The modes of a scene with the updated body, which its file keeps, are the measured ones."""
    _, body, frequencies, _ = plate
    found = compared(body, measured(plate, tmp_path / "modes.unv"))
    path = found.updated_body().save(tmp_path / "plate.h5")
    updated = wf.ReducedBody.load(path)
    assert np.any(np.diff(updated.frequencies) < 0.0)
    assert updated.content_hash() != body.content_hash() and "measured frequencies" in updated.info()
    scene = wf.Scene(gravity=(0, 0, 0))
    scene.add_body(updated, name="plate", damping=found.damping(rest=0.0))
    modes = wf.eigenmodes(scene, 6 + COUNT, about="initial", progress=False)
    order = np.argsort(np.array(FACTORS) * frequencies)
    moving = modes.frequencies > 1.0
    assert np.allclose(modes.frequencies[moving], (np.array(FACTORS) * frequencies)[order], rtol=1e-5)
    assert np.allclose(modes.damping_ratios[moving], np.array(RATIOS)[order], rtol=1e-5)


def test_files_of_pyuff(plate: Any, tmp_path: Path) -> None:
    pyuff = pytest.importorskip("pyuff")
    mesh, body, frequencies, shapes = plate
    x, path = mesh.points[::2], tmp_path / "pyuff.uff"
    file, numbers = pyuff.UFF(str(path)), np.arange(1, len(x) + 1)
    systems = {key: np.zeros(len(x), int) for key in ("def_cs", "disp_cs", "color")}
    file.write_sets({"type": 15, "node_nums": numbers, **systems, "x": x[:, 0], "y": x[:, 1], "z": x[:, 2]}, "add")
    for k, u in enumerate(shapes[:, ::2]):
        of = {"type": 55, "model_type": 1, "analysis_type": 2, "data_ch": 2, "spec_data_type": 8, "data_type": 2}
        of |= {"n_data_per_node": 3, "load_case": 1, "mode_n": k + 1, "freq": frequencies[k], "modal_m": 1.0}
        of |= {"modal_damp_vis": 0.01, "modal_damp_his": 0.0, "node_nums": numbers}
        file.write_sets({**of, "r1": u[:, 0], "r2": u[:, 1], "r3": u[:, 2]}, "add")
    found = body.compare_modes(path, length_unit="m")
    assert dict(found.pairs) == {k: k for k in range(COUNT)} and np.all(found.pair_mac > 1.0 - SIX_DIGITS)
    assert np.allclose(found.measured_frequencies, frequencies, rtol=1e-5)


def test_modes_of_a_scene_are_read_back(plate: Any, tmp_path: Path) -> None:
    """What `Modes.to_uff` writes: rigid motions have no partner, elastic modes themselves."""
    _, body, frequencies, _ = plate
    scene = wf.Scene(gravity=(0, 0, 0))
    scene.add_body(body, name="plate", damping=0.01)
    path = wf.eigenmodes(scene, 12, about="initial", progress=False).to_uff(tmp_path / "own.uff")
    found = body.compare_modes(path, length_unit="m")
    assert dict(found.pairs) == {6 + k: k for k in range(6)} and np.all(found.pair_mac > 1.0 - SIX_DIGITS)
    assert np.allclose(found.measured_damping[6:], 0.01, rtol=1e-5)
    assert np.allclose(found.updated_body().frequencies[:6], frequencies, rtol=1e-5)


POINTS = np.array([(-0.1, -0.035, 0.0), (0.1, -0.035, 0.0), (0.1, 0.035, 0.0)])
SHAPE = np.eye(3)


def changed(old: str, new: str) -> list[str]:
    return [line.replace(old, new) for line in mode_55(9.0, 0.0, SHAPE)]


FAULTS = {
    "no mode shapes": [nodes_15(POINTS)],
    "no nodes": [mode_55(100.0, 0.01, SHAPE)],
    "node 30 of the modes has no place": [nodes_15(POINTS[:2]), mode_55(100.0, 0.01, SHAPE)],
    "has other nodes than the first one": [nodes_15(POINTS), mode_55(100.0, 0.0, SHAPE), mode_55(90.0, 0.0, SHAPE[:2])],
    "coordinate system 4, which no": [nodes_15(POINTS, displaced=4), mode_55(100.0, 0.0, SHAPE)],
    "does not move any point": [nodes_15(POINTS), mode_55(100.0, 0.0, SHAPE), mode_55(90.0, 0.0, 0.0 * SHAPE)],
    "damping ratio 1.2 is none": [nodes_15(POINTS), mode_55(100.0, 1.2, SHAPE)],
    "-5 Hz": [nodes_15(POINTS), mode_55(-5.0, 0.0, SHAPE)],
    "is cut off": [nodes_15(POINTS), text(55, [*5 * ["NONE"], integers(1, 2, 2, 8, 2, 3)])],
    "a node has 2 lines": [nodes_15(POINTS), [*mode_55(100.0, 0.0, SHAPE)[:-2], "    -1"]],
    "values per node are not 3": [nodes_15(POINTS), changed(integers(2, 3), integers(2, 6))],
    "node of a mode 10 is given twice": [nodes_15(POINTS), changed(integers(20), integers(10))],
    "from the body, of 0.2 m extent": [nodes_15(1e3 * POINTS), mode_55(100.0, 0.0, SHAPE)],
}  # fmt: skip


@pytest.mark.parametrize("said", FAULTS)
def test_wrong_files(plate: Any, tmp_path: Path, said: str) -> None:
    path = written(tmp_path / "wrong.unv", *FAULTS[said])
    with pytest.raises(InputError, match=said.replace(".", r"\.")):
        plate[1].compare_modes(path, length_unit="m")


def test_wrong_arguments(plate: Any, tmp_path: Path) -> None:
    body, path = plate[1], measured(plate, tmp_path / "modes.unv")
    for options, said in (
        ({"length_unit": "furlong"}, "length unit"),
        ({"least_mac": 1.5}, "least_mac must lie between 0 and 1"),
        ({"least_mac": 0.0}, "least_mac"),
        ({"rotation": (1.0, 0.0, 1.0)}, "rotation"),
    ):
        with pytest.raises(InputError, match=said):
            body.compare_modes(path, **{"length_unit": "mm", **options})
    with pytest.raises(InputError, match="does not exist"):
        body.compare_modes(tmp_path / "none.unv", length_unit="mm")
    with pytest.raises(InputError, match="no measured mode corresponds"):
        body.compare_modes(written(tmp_path / "one.unv", nodes_15(POINTS), mode_55(9.0, 0.0, SHAPE)), length_unit="m",
                           least_mac=1.0).updated_body()  # fmt: skip
    negative = written(tmp_path / "negative.unv", nodes_15(plate[0].points), mode_55(9.0, -0.1, plate[3][0]))
    with pytest.raises(InputError, match="negative ratio -0.1"):
        body.compare_modes(negative, length_unit="m").damping()


def test_modes_and_nodes_that_are_missing_are_noted(plate: Any, tmp_path: Path) -> None:
    """Where modes are numbered, and where nodes have no motion; both of a file from which datasets were removed."""
    mesh, body, frequencies, shapes = plate

    def numbered(n: int, k: int) -> list[str]:
        return [
            line.replace(integers(2, 4, 1, 1), integers(2, 4, 1, n)) for line in mode_55(frequencies[k], 0, shapes[k])
        ]

    more = nodes_15(np.vstack([mesh.points, [[9.0, 9.0, 9.0]]]))
    all_there = written(tmp_path / "all.unv", nodes_15(mesh.points), numbered(2, 1), numbered(1, 0))
    assert not any("not in the file" in note or "no motion" in note for note in notes_of(body, all_there))
    parts = written(tmp_path / "parts.unv", more, numbered(2, 0), numbered(5, 1))
    notes = notes_of(body, parts)
    assert "modes are numbered up to 5, without 1, 3, 4: they are not in the file" in notes
    assert f"1 of {len(mesh.points) + 1} nodes have no motion in the modes; they are not used" in notes
    alike = written(tmp_path / "alike.unv", nodes_15(mesh.points), numbered(3, 0), numbered(3, 1))
    assert not any("not in the file" in note for note in notes_of(body, alike))


def notes_of(body: Any, path: Path) -> tuple[str, ...]:
    return body.compare_modes(path, length_unit="m").notes
