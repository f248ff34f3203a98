"""Frequency responses: two oscillators in closed form, a beam and a jointed frame by their finite elements; files."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import scipy.sparse.linalg as spla

import warpffrf as wf
from warpffrf.model.errors import InputError
from warpffrf.model.mesh.facets import rigid_modes
from warpffrf.offline.fe import assign, fe_matrices

STEEL = wf.Material(youngs_modulus=210e9, poisson_ratio=0.3, density=7850)
Z = (0.0, 0.0, 1.0)


def oscillators(damping: float = 30.0) -> tuple[wf.Scene, Any, Any]:
    scene = wf.Scene(gravity=(0, 0, 0))
    a, b = (scene.add_rigid_body(m, (0.1, 0.1, 0.1), name=n) for m, n in ((2.0, "a"), (3.0, "b")))
    for body in (a, b):
        scene.add(wf.joints.Prismatic(scene.ground, body, axis=Z, name=f"guide {body.name}"))
    for ends, k, c in (((scene.ground, a), 2e5, 2.0 * damping), ((a, b), 1e5, damping)):
        guide = scene.add(wf.forces.Bushing(*ends, stiffness=(0, 0, k, 0, 0, 0), damping=(0, 0, c, 0, 0, 0)))
        assert guide is not None
    return scene, a, b


def exact(f: np.ndarray, c: float = 30.0) -> np.ndarray:
    """(f, 2, 2) m/N."""
    w = 2.0 * np.pi * f[:, None, None]
    K, D = np.array([[3e5, -1e5], [-1e5, 1e5]]), c * np.array([[3.0, -1.0], [-1.0, 1.0]])
    return np.linalg.inv(K + 1j * w * D - w**2 * np.diag([2.0, 3.0]))


def test_two_oscillators_respond_as_their_closed_form() -> None:
    scene, a, b = oscillators()
    f = np.linspace(0.0, 120.0, 241)
    modes = wf.eigenmodes(scene, 2, progress=False)
    response = modes.frequency_response((a, (0, 0, 2)), [(a, Z), (b, Z), (b, (0, 0, -1))], f)
    H = exact(f)
    for found, expected in zip(response.receptance, (H[:, 0, 0], H[:, 0, 1], -H[:, 0, 1]), strict=True):
        assert np.max(np.abs(found - expected)) < 1e-7 * np.max(np.abs(expected))
    assert np.allclose(response.of("acceleration"), -((2.0 * np.pi * f) ** 2) * response.receptance)
    assert response.force == "a.at(0, 0, 0) along z" and response.responses[2] == "b.at(0, 0, 0) along -z"


def beam() -> tuple[wf.Scene, Any, Any]:
    mesh = wf.mesh.box((0.2, 0.02, 0.01), (10, 2, 2), order=1)
    body = wf.reduce(
        mesh, STEEL, interfaces={"x_min": "rigid", "x_max": "rigid"}, modes=20, cache=False, progress=False
    )
    scene = wf.Scene(gravity=(0, 0, 0))
    placed = scene.add_body(body, name="beam", damping=0.0)
    scene.add(wf.joints.Fixed(scene.ground, placed["x_min"]))
    return scene, placed, mesh


def direct(mesh: Any, f: np.ndarray) -> np.ndarray:
    """(f, 6, 6): motion of the rigid end at x_max per force and moment, the other end clamped, by the elements."""
    import scipy.sparse as sp

    matrices: Any = fe_matrices(mesh, assign(mesh, STEEL))
    ends = [mesh.facets(name).node_set for name in ("x_min", "x_max")]
    point = np.array([0.1, 0.0, 0.0])
    free = np.setdiff1d(np.arange(len(mesh.points)), np.concatenate(ends))
    dofs, tip = ((3 * nodes[:, None] + np.arange(3)).ravel() for nodes in (free, ends[1]))
    T: Any = sp.lil_matrix((3 * len(mesh.points), len(dofs) + 6))
    T[dofs, np.arange(len(dofs))] = 1.0
    T[tip, len(dofs) :] = rigid_modes(mesh.points[ends[1]], point)
    T = T.tocsr()
    k, m = (sp.csc_matrix(T.T @ A @ T) for A in matrices)
    loads = np.zeros((len(dofs) + 6, 6))
    loads[-6:] = np.eye(6)
    return np.array([spla.splu(sp.csc_matrix(k - (2 * np.pi * x) ** 2 * m)).solve(loads)[-6:] for x in f])


def test_a_clamped_beam_responds_as_its_elements() -> None:
    """Below, between and above its first bending frequencies, in all directions: 0.1 % of the largest entry."""
    scene, placed, mesh = beam()
    f = np.array([0.0, 50.0, 150.0, 500.0, 900.0, 1500.0])
    modes = wf.eigenmodes(scene, 4, progress=False)
    expected = direct(mesh, f)
    for i in range(3):
        axes = [(placed["x_max"], e) for e in np.eye(3)]
        found = modes.frequency_response(axes[i], axes, f).receptance
        for n in range(len(f)):
            assert np.max(np.abs(found[:, n] - expected[n, :3, i])) < 1e-3 * np.max(np.abs(expected[n, :3, i]))


def test_written_functions_are_read_back_by_pyuff(tmp_path: Path) -> None:
    pyuff = pytest.importorskip("pyuff")
    scene, a, b = oscillators()
    modes = wf.eigenmodes(scene, 2, progress=False)
    for number, f in enumerate((np.linspace(1.0, 101.0, 201), np.array([1.0, 2.0, 7.5, 50.0]))):
        response = modes.frequency_response((a, Z), [(a, Z), (b, (0, 0, -1)), (b, (0, 1, 1))], f)
        path = response.to_uff(tmp_path / f"{number}.uff", quantity="acceleration")
        sets = pyuff.UFF(str(path)).read_sets()
        assert [s["rsp_dir"] for s in sets] == [3, -3, 0] and [s["rsp_node"] for s in sets] == [1, 2, 2]
        for found, h in zip(sets, response.of("acceleration"), strict=True):
            assert (found["func_type"], found["ref_node"], found["ref_dir"]) == (4, 1, 3)
            assert (found["ordinate_spec_data_type"], found["orddenom_spec_data_type"]) == (12, 13)
            assert np.allclose(found["x"], f, rtol=1e-5) and np.max(np.abs(found["data"] - h)) < 1e-12 * np.abs(h).max()
    with pytest.raises(InputError, match="exists"):
        response.to_uff(path)
    assert response.to_uff(path, overwrite=True) == path


def test_table_plot_and_csv(tmp_path: Path) -> None:
    scene, a, _ = oscillators()
    f = np.array([5.0, 30.0])
    response = wf.eigenmodes(scene, 2, progress=False).frequency_response((a, Z), (a, Z), f)
    report = response.report("velocity")
    assert report.splitlines()[0] == "velocity [m/(s N)] per force at a.at(0, 0, 0) along z, about the equilibrium"
    assert f"{abs(response.of('velocity')[0, 1]):.5g}" in report
    axes = response.plot()
    assert np.array_equal(axes[0].lines[0].get_ydata(), np.abs(response.receptance[0]))
    table = np.loadtxt(response.to_csv(tmp_path / "h.csv"), delimiter=",", skiprows=2)
    assert np.array_equal(table[:, 1] + 1j * table[:, 2], response.receptance[0])


@pytest.mark.parametrize(
    ("force", "responses", "f", "message"),
    [
        ("a", ("a", Z), [1.0], "is \\(port, direction\\)"),
        (("a", (0, 0, 0)), ("a", Z), [1.0], "a direction must not be zero"),
        (("ground", Z), ("a", Z), [1.0], "a place on a body that moves"),
        (("a", Z), [], [1.0], "responses are \\(port, direction\\)"),
        (("a", Z), ("a", Z), [-1.0], "none negative"),
    ],
)
def test_wrong_input_is_refused(force: Any, responses: Any, f: list[float], message: str) -> None:
    scene, a, _ = oscillators()
    named = {"a": a, "ground": scene.ground}

    def placed(given: Any) -> Any:
        return (named[given[0]], given[1]) if isinstance(given, tuple) else given

    with pytest.raises(InputError, match=message):
        wf.eigenmodes(scene, 1, progress=False).frequency_response(placed(force), placed(responses), f)


def test_a_body_that_nothing_holds_has_no_response_at_rest() -> None:
    scene = wf.Scene(gravity=(0, 0, 0))
    body = scene.add_rigid_body(2.0, (0.1, 0.1, 0.1), name="a")
    modes = wf.eigenmodes(scene, 1, about="initial", progress=False)
    found = modes.frequency_response((body, Z), (body, Z), [10.0]).receptance[0, 0]
    assert found == pytest.approx(-1.0 / (2.0 * (2.0 * np.pi * 10.0) ** 2), rel=1e-9)
    with pytest.raises(InputError, match="infinite at one of the frequencies"):
        modes.frequency_response((body, Z), (body, Z), [0.0])


def rollers(load: float) -> tuple[wf.Scene, Any]:
    """Two coarse rollers pressed together: the lower on the ground, the upper guided along z under `load` [N]."""
    mesh = wf.mesh.roller(0.05, 0.015, 0.02, sectors=48, layers=3, axial=1, order=1)
    contact = {"rim": wf.surfaces.Cylinder()}
    body = wf.reduce(mesh, STEEL, interfaces={"bore": "rigid"}, contact=contact, modes=8, cache=False, progress=False)
    scene = wf.Scene(gravity=(0, 0, 0))
    low, top = (scene.add_body(body, name=name, position=(0, 0, z)) for name, z in (("low", 0.0), ("top", 0.1 - 2e-6)))
    scene.add(wf.joints.Fixed(scene.ground, low["bore"]))
    scene.add(wf.joints.Prismatic(scene.ground, top["bore"], axis=Z, name="guide"))
    scene.add(wf.forces.PointForce(top["bore"], (0, 0, -load)))
    scene.add(wf.Contact(low["rim"], top["rim"], cells=(31, 7), name="pair"))
    return scene, top


def test_two_rollers_in_contact_respond_as_their_equilibria_at_two_loads() -> None:
    """At 0 Hz the response of the bore is the difference of two equilibria over that of their loads. Small motions hold
    the patch, which follows the load in equilibria: 0.5 % with the cells that are chosen by default, less with more."""
    load, step = 2000.0, 1.0
    places = []
    for n in (1, -1):
        scene, _ = rollers(load + n * step)
        places.append(wf.equilibrium(scene, progress=False).joint("guide").coordinate[-1])
    scene, top = rollers(load)
    found = wf.eigenmodes(scene, 1, progress=False).frequency_response((top["bore"], Z), (top["bore"], Z), [0.0])
    slope = (places[1] - places[0]) / (2.0 * step)
    assert found.receptance[0, 0].real == pytest.approx(slope, rel=1e-3) and slope > 1e-10
