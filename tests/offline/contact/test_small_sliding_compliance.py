"""The compliance of small-sliding contacts compared with full finite-element solutions, which share nothing with the
reduction.

The full model is scikit-fem's, solved as a dense saddle point, with the rigid interface by a dense constraint. Loads by
nodes are unit vectors; loads by facets are those whose resultants and work `test_small_sliding_cells` compares with
closed forms.
"""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from offline_bodies import STEEL
from reference_fe import free_response, matrices
from small_sliding_bodies import as_kind, slit_body, together

from scenes.flat_settings import reduce_flat
from warpffrf.model.errors import InputError
from warpffrf.model.material import Material
from warpffrf.model.mesh import Mesh, box
from warpffrf.model.mesh.data import Matrices
from warpffrf.model.mesh.facets import rigid_modes
from warpffrf.model.reduced.body import ReducedBody
from warpffrf.model.surfaces import Matched, Plane
from warpffrf.offline import reduce
from warpffrf.offline.fe import assemble, assign
from warpffrf.offline.general import unit_loads
from warpffrf.offline.small_sliding.compliance import MatchedFaces

EXACT = 1e-9  # of the largest displacement: round-off of two solutions of stiff systems
SINGLE = 2e-6  # stresses and the display transfer are stored in single precision

LAPS = {
    "lap": Matched("high", first="low"),
    "foot": Matched(first="z_min"),
    "nodes": Matched("high", first="low", by="nodes"),
}


def lapped(mesh: Mesh, matched: dict[str, Matched], **settings) -> Any:
    """The body reduced with small-sliding contacts; what it may lack is there."""
    given = {"interfaces": {"x_min": "rigid"}, "cache": False, "progress": False, "modes": 6}
    contact = {**settings.pop("contact", {}), **matched}
    return reduce_flat(mesh, STEEL, contact=contact, **{**given, **settings})


def full_response(mesh: Mesh, B, held: str | None):
    """Responses (3 n, count) of the free body under inertia relief to nodal loads B."""
    K, M = matrices(mesh, STEEL)
    points, n = mesh.points, len(mesh.points)
    rigid = np.zeros(0, dtype=int) if held is None else mesh.facets(held).node_set
    free = np.setdiff1d(np.arange(n), rigid)
    T = np.zeros((3 * n, 3 * len(free) + (6 if held else 0)))
    T[(3 * free[:, None] + np.arange(3)).ravel(), np.arange(3 * len(free))] = 1.0
    R = rigid_modes(points[free], np.zeros(3))
    if held:
        T[(3 * rigid[:, None] + np.arange(3)).ravel(), 3 * len(free) :] = rigid_modes(points[rigid], np.zeros(3))
        R = np.concatenate([R, np.eye(6)])
    return T @ free_response(T.T @ K @ T, T.T @ M @ T, R, T.T @ B)


def static(body: Any) -> np.ndarray:
    """All of the flexible compliance of the small-sliding contacts: that of the global modes and the residual one."""
    modes = np.concatenate([lap.modes for lap in body.matched.values()], axis=1)
    return body.matched_compliance + modes.T @ (modes / ((2.0 * np.pi * body.frequencies) ** 2)[:, None])


@pytest.fixture(scope="module")
def slit() -> Mesh:
    return slit_body()


@pytest.fixture(scope="module")
def loads(slit) -> np.ndarray:
    return MatchedFaces.of(slit, LAPS).loads().toarray()


@pytest.mark.parametrize("held", ["x_min", None])
@pytest.mark.parametrize("modes", [0, 6, 40])
def test_modes_and_compliance_make_the_full_response(slit, loads, held, modes) -> None:
    """Of three small-sliding contacts at once, with all blocks between them, for any number of modes."""
    body = lapped(slit, LAPS, modes=modes, interfaces={held: "rigid"} if held else {})
    expected = loads.T @ full_response(slit, loads, held)
    assert np.abs(static(body) - expected).max() < EXACT * np.abs(expected).max()
    C = body.matched_compliance
    assert np.array_equal(C, C.T)
    assert np.linalg.eigvalsh(C).min() > -1e-12 * np.abs(C).max()


def test_nodal_loads_are_unit_vectors(slit) -> None:
    """By nodes: +1 N on the node of the second face, -1 N on that of the first, of every direction."""
    body = lapped(slit, {"nodes": LAPS["nodes"]})
    lap = body.matched["nodes"]
    B = np.zeros((len(slit.points), 3, lap.unknowns))
    for c, x in enumerate(lap.points):
        distance = np.linalg.norm(slit.points - x, axis=1)
        across = np.linalg.norm(slit.points - x - np.array([0.0, 0.0, 0.5e-3]), axis=1)
        for i in range(3):
            B[np.argmin(across), :, 3 * c + i] += lap.frames[c, i]
            B[np.argmin(distance), :, 3 * c + i] -= lap.frames[c, i]
    B = B.reshape(3 * len(slit.points), -1)
    expected = B.T @ full_response(slit, B, "x_min")
    assert np.abs(static(body) - expected).max() < EXACT * np.abs(expected).max()


def test_two_columns_pressed_apart() -> None:
    """Two columns without Poisson's effect on one rigid frame, whose ends face each other: under a uniform pressure p
    each gives way by p L/E, so that delta = 2 p L/E in every cell, from meshes that do not match."""
    E, L, p = 70e9, 0.05, 1e6
    material = Material(E, 0.0, 2700.0)
    low = box((0.02, 0.03, L), (2, 3, 3), center=(0.0, 0.0, -L / 2), order=1)
    high = box((0.02, 0.03, L), (3, 2, 4), center=(0.0, 0.0, L / 2 + 1e-4), order=2)
    both = together(low=low, high=high)
    K, M = assemble(both.points, both.cells, assign(both, material))
    z = both.points[:, 2]
    frame = {f"{part} {side}": both.facets(f"{part} {side}") for part, side in (("low", "z_min"), ("high", "z_max"))}
    blocks = {kind: nodes for facets in frame.values() for kind, nodes in facets.blocks.items()}
    assert len(blocks) == 2 and z.min() < -0.049
    facets = {**both.facet_sets, "frame": type(both.facets("low z_min"))(blocks)}
    mesh = Mesh(both.points, {}, facets, matrices=Matrices(K, M))
    body = reduce(
        mesh,
        None,
        interfaces={"frame": "rigid"},
        contact={"lap": Matched("high z_min", first="low z_max")},
        modes=2,
        cache=False,
        progress=False,
    )
    lap = body.matched["lap"]
    forces = np.zeros(lap.unknowns)
    forces[::3] = p * lap.area
    delta = static(body) @ forces
    # the two columns weigh the same but for the gap, yet inertia does not come in: the loads are in equilibrium
    assert delta[::3] == pytest.approx(np.full(lap.cells, 2.0 * p * L / E), rel=1e-9)
    assert np.abs(delta[1::3]).max() < 1e-9 * delta.max() and np.abs(delta[2::3]).max() < 1e-9 * delta.max()


@pytest.mark.parametrize("kind", ["hex20", "hex27", "tet10"])
def test_quadratic_cells(kind) -> None:
    """The compliance of a small-sliding contact of quadratic facets does not depend on how much of it the modes
    hold."""
    mesh = as_kind(slit_body(order=2, along=4), kind)
    few, many = (lapped(mesh, {"lap": Matched("high", first="low")}, modes=m) for m in (2, 30))
    assert np.abs(static(few) - static(many)).max() < EXACT * np.abs(static(few)).max()
    assert np.abs(few.matched_compliance).max() > np.abs(many.matched_compliance).max()


def test_blocks_of_few_loads_and_a_tight_memory(slit, monkeypatch) -> None:
    """The same numbers in small blocks; a limit below what the compliance takes is refused with its size."""
    body = lapped(slit, LAPS)
    monkeypatch.setattr(unit_loads, "BLOCK", 7)
    few = lapped(slit, LAPS)
    assert few.report["worst_load_residual"] < 1e-9
    assert (
        np.abs(few.matched_compliance - body.matched_compliance).max() < 1e-13 * np.abs(body.matched_compliance).max()
    )
    size = 3 * 8 * sum(s.unknowns for s in body.matched.values()) ** 2
    with pytest.raises(
        InputError, match=r"matched faces: the compliance of .* bytes.*surfaces.Matched\(size=, growth=\)"
    ):
        lapped(slit, LAPS, memory_limit=size // 2)


def test_stress_of_small_sliding(slit) -> None:
    """The stress of the residual response: at any number of modes, the sum is that of the full response."""
    points = np.array([[0.03, 0.01, 0.003], [0.005, 0.005, 0.005]])
    few, many = (lapped(slit, LAPS, modes=m, stress={"inside": points}) for m in (2, 60))
    forces = np.random.default_rng(2).standard_normal(few.matched_compliance.shape[0]) * 100.0
    found = []
    for body in (few, many):
        modes = np.concatenate([lap.modes for lap in body.matched.values()], axis=1)
        q = modes @ forces / (2.0 * np.pi * body.frequencies) ** 2
        field = body.stress["inside"]
        assert field.matched is not None and field.matched.shape == (len(forces), 2, 6)
        found.append((field.evaluate(q, {}, matched=forces), np.tensordot(forces, body.surface.matched, axes=1)))
        found[-1] += (np.tensordot(q, body.surface.modes, axes=1) + found[-1][1],)
    scale = np.abs(found[0][0]).max()
    assert np.abs(found[0][0] - found[1][0]).max() < 1e-5 * scale and scale > 0.0
    skin = found[0][2]
    assert np.abs(skin - found[1][2]).max() < 1e-5 * np.abs(skin).max()
    with pytest.raises(InputError, match="forces on matched faces must be"):
        few.stress["inside"].evaluate(np.zeros(len(few.frequencies)), {}, matched=np.ones(3))


def test_saved_and_loaded(slit, tmp_path: Path) -> None:
    body = lapped(slit, LAPS, stress={"inside": np.array([[0.03, 0.01, 0.003]])})
    again: Any = ReducedBody.load(body.save(tmp_path / "body.h5"))
    assert again.content_hash() == body.content_hash()
    assert list(again.matched) == list(LAPS) and np.array_equal(again.matched_compliance, body.matched_compliance)
    for name, lap in body.matched.items():
        for key, array in lap.arrays().items():
            assert np.array_equal(getattr(again.matched[name], key), array)
        assert again.matched[name].facts() == lap.facts()
    assert np.array_equal(again.stress["inside"].matched, body.stress["inside"].matched)
    assert "matched face    lap: 10 cells by facets" in again.info() and "matched='lap', 'foot', 'nodes'" in repr(again)
    assert again.report["matched"]["lap"]["cells"] == 10
    changed = replace(body, matched_compliance=2.0 * body.matched_compliance)
    assert changed.content_hash() != body.content_hash()


@pytest.fixture(scope="module")
def plain(slit) -> ReducedBody:
    return lapped(slit, {"lap": Matched("high", first="low")})


WRONG = {
    "matched/lap/frames are not unit": lambda b: with_face(b, frames=2.0 * b.matched["lap"].frames),
    "matched/lap/area must be greater": lambda b: with_face(b, area=-b.matched["lap"].area),
    "matched/lap/cell names a cell": lambda b: with_face(b, cell=b.matched["lap"].cell + 1),
    "matched/lap/modes must have shape": lambda b: with_face(b, modes=b.matched["lap"].modes[:, 1:]),
    "matched_compliance must have shape": lambda b: replace(b, matched_compliance=b.matched_compliance[1:, 1:]),
    "matched_compliance is not symmetric": lambda b: replace(b, matched_compliance=np.triu(b.matched_compliance)),
    "matched faces have no matched_compliance": lambda b: replace(
        b, matched_compliance=None, surface=replace(b.surface, matched=None)
    ),
    "surface/matched must have shape": lambda b: replace(b, surface=replace(b.surface, matched=b.surface.matched[1:])),
}


def with_face(body: Any, **changes) -> ReducedBody:
    return replace(body, matched={"lap": replace(body.matched["lap"], **changes)})


@pytest.mark.parametrize("says", WRONG)
def test_a_file_that_does_not_fit_together(plain, tmp_path: Path, says) -> None:
    path = WRONG[says](plain).save(tmp_path / "wrong.h5")
    with pytest.raises(InputError, match=says):
        ReducedBody.load(path)


def test_what_small_sliding_cannot_be_combined_with(slit) -> None:
    with pytest.raises(InputError, match="contact 'lap'.*'lwo' does not exist.*'low'"):
        lapped(slit, {"lap": Matched("high", first="lwo")})
    with pytest.raises(InputError, match="contact 'lap'.*'heda' does not exist.*'low'"):
        lapped(slit, {"lap": Matched("high", first="low", growth=0.5, fine=("heda",))})
    with pytest.raises(InputError, match="contact 'lap': 10 facets of 'low' belong to contact surface 'low'"):
        lapped(slit, {"lap": Matched("high", first="low")}, contact={"low": Plane()})
    with pytest.raises(InputError, match="'x_min' is a rigid interface"):
        lapped(slit, {"lap": Matched("x_min", first="low")})
    with pytest.raises(InputError, match="share 10 facets"):
        lapped(slit.select("also", "low", lambda x: x[:, 0] > 0.0), {"lap": Matched("also", first="low")})


def test_notes_and_warnings(slit) -> None:
    body = lapped(slit, {"lap": Matched("high", first="low")})
    assert "contact 'lap': the faces are 0.0005 m apart in the mean, 0.0005 m at most" in body.report["notes"]
    assert body.report["path"] == "general" and "surfaces.Matched" in body.report["path_reason"]
    beside = lapped(slit, {"lap": Matched("high", first="low")}, contact={"z_max": Plane()})
    assert any("through the global modes only" in note for note in beside.report["notes"])
    # more facets than nodes: triangles of linear cells
    many = lapped(as_kind(slit_body(order=2, along=12), "tet4"), {"lap": Matched("high", first="low")})
    assert any("cells depend on the others" in text for text in many.report["warnings"])
    assert not any("depend on the others" in text for text in body.report["warnings"])
    # nodes of a rigid interface do not give way
    held = slit.select_plane("front", point=(0.06, 0, 0), normal=(1, 0, 0))
    stuck = lapped(held, {"lap": Matched("high", first="low", by="nodes")}, interfaces={"front": "rigid"})
    assert any("3 of 18 cells hardly give way" in text for text in stuck.report["warnings"])
    assert all("end the face a row of facets before" in text for text in stuck.report["warnings"])
