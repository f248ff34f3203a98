"""Bodies with shells, beams, masses, springs and rigid links: mixed with solids, reduced, moved."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest

import warpffrf as wf
from scenes.shells import closed_box, housing, matrices, patch
from warpffrf.model.errors import InputError
from warpffrf.model.material import Material
from warpffrf.model.mesh import Beam, BeamSection, Mesh, PointMass, RigidLink, Shell, Spring
from warpffrf.offline import reduce
from warpffrf.offline.fe import Assignment
from warpffrf.offline.inertia.invariants import from_moments
from warpffrf.offline.structure.assembly import body_matrices, rigid_motions

STEEL = Material(210e9, 0.3, 7850.0)
ROUND_OFF = 1e-10


def rod(count: int = 4, length: float = 1.0) -> tuple[np.ndarray, np.ndarray]:
    """Nodes along x and the beams between them."""
    points = np.zeros((count + 1, 3))
    points[:, 0] = np.linspace(0.0, length, count + 1)
    return points, np.stack([np.arange(count), np.arange(1, count + 1)], axis=1)


def reduced(mesh: Mesh, material: Material | None = None, **more) -> wf.ReducedBody:
    return reduce(mesh, material, cache=False, progress=False, **more)


def test_a_shell_cover_on_a_solid_housing_is_that_of_solids() -> None:
    """Mass, centre and inertia exactly; the frequencies of this mesh, whose cover of one cell is too stiff, are above
    by a few per cent (1 % with finer meshes, docs/verification.md)."""
    solid = reduced(housing(6, 0.005, solid_cover=True), STEEL, modes=4)
    cover = reduced(housing(6, 0.005, solid_cover=False), STEEL, modes=4, stress={"out": "top"})
    assert cover.mass == pytest.approx(solid.mass, rel=ROUND_OFF)
    assert cover.center_of_mass == pytest.approx(solid.center_of_mass, abs=ROUND_OFF)
    assert np.abs(cover.inertia - solid.inertia).max() < ROUND_OFF * solid.inertia.max()
    assert cover.frequencies[:3] == pytest.approx(solid.frequencies[:3], rel=0.05)
    assert np.all(cover.frequencies < solid.frequencies)
    assert cover.stress["out"].points[:, 2] == pytest.approx(0.03 + 0.005, abs=1e-12)


def test_inertia_invariants_are_those_of_the_moving_material() -> None:
    """Moments of the modes by quadrature over the volume of a plate of shells, with rotary inertia and offset."""
    p = patch("quad8", 3, 2, lambda u, v: np.stack([0.4 * u, 0.3 * v, 0.02 * u * v], axis=1))
    shell = Shell(p.nodes, 0.03, STEEL, offset=0.02)
    mesh = Mesh(p.points, {}, structure=[shell])
    body = body_matrices(mesh, Assignment((), {}))
    U = np.random.default_rng(3).standard_normal((body.M.shape[0], 3))
    assert body.inertia is not None
    at = body.inertia
    X, m = at.positions, at.mass.diagonal()
    V = (at.motion @ U).reshape(-1, 3, 3)
    center = m @ X / m.sum()
    first = np.einsum("p,pa,pbk->kab", m, X - center, V)
    second = np.einsum("p,pak,pbl->klab", m, V, V)
    mine, theirs = body.inertia_terms(U, p.points, center), from_moments(first.transpose(0, 2, 1), second)
    for name in ("second", "gyroscopic"):
        a, b = getattr(mine, name), getattr(theirs, name)
        assert np.abs(a - b).max() < ROUND_OFF * np.abs(b).max()
    R = rigid_motions(p.points, body.rotating, center)
    assert (at.motion @ R).reshape(-1, 3, 6)[:, :, 3] == pytest.approx(np.cross([1.0, 0.0, 0.0], X - center), abs=1e-12)
    assert U.T @ (body.M @ U) == pytest.approx(np.einsum("klaa->kl", second), rel=ROUND_OFF)


def test_a_point_mass_on_an_arm_and_a_rigid_link() -> None:
    """A rod with a block at the end of a rigid arm: mass, centre, inertia in closed form, also where the block hangs on
    the free end of a rigid link."""
    points, nodes = rod()
    section = BeamSection.circle(0.01)
    J = np.diag([0.02, 0.03, 0.04])
    arm = np.array([0.1, 0.2, 0.0])
    rodmass = 7850.0 * section.area
    total = rodmass + 3.0
    center = (rodmass * np.array([0.5, 0.0, 0.0]) + 3.0 * (points[-1] + arm)) / total
    own = rodmass * np.diag([0.5e-4, 1 / 12 + 0.25e-4, 1 / 12 + 0.25e-4])
    exact = own + J
    for mass, place in ((rodmass, np.array([0.5, 0.0, 0.0])), (3.0, points[-1] + arm)):
        d = place - center
        exact = exact + mass * (d @ d * np.eye(3) - np.outer(d, d))
    beam = Beam(nodes, section, STEEL, (0.0, 1.0, 0.0))
    found = []
    for mesh in (
        Mesh(points, {}, structure=[beam, PointMass(4, 3.0, inertia=J, offset=arm)]),
        Mesh(
            np.concatenate([points, [points[-1] + arm]]), {},
            structure=[beam, RigidLink([5, 4]), PointMass(5, 3.0, inertia=J)], node_sets={"block": [5]},
        ),
    ):  # fmt: skip
        kinds = dict.fromkeys(mesh.node_sets, "rigid")
        body = reduced(mesh, modes=4, interfaces=kinds)
        assert body.mass == pytest.approx(total, rel=ROUND_OFF)
        assert body.center_of_mass == pytest.approx(center, abs=ROUND_OFF)
        assert np.abs(body.inertia - exact).max() < ROUND_OFF * exact.max()
        if kinds:
            assert body.interfaces["block"].point == pytest.approx(points[-1] + arm)
        found.append(body.frequencies[:3])
    assert found[1] == pytest.approx(found[0], rel=1e-6)  # within the tolerance of the eigensolver


def test_two_rods_on_a_spring() -> None:
    """Stiff rods joined by an axial spring: root(k (1/m_1 + 1/m_2))/2 pi; by a torsional one: root(k 2/I)/2 pi."""
    points, nodes = rod(1)
    apart = np.concatenate([points, points + [1.0, 0.0, 0.0]])
    section, stiff = BeamSection.circle(0.05), Material(210e9, 0.3, 7850.0)
    beams = Beam(np.concatenate([nodes, nodes + 2]), section, stiff, (0.0, 1.0, 0.0))
    stiffness = np.array([1e4, 1e9, 1e9, 20.0, 1e9, 1e9])
    body = matrices(apart, [beams, Spring((1, 2), stiffness)])
    K, M = body.K.toarray(), body.M.toarray()
    values = np.linalg.eigvals(np.linalg.solve(M, K))
    omega = np.sqrt(np.abs(np.sort(np.real(values))))[6:8]
    m = 7850.0 * section.area
    expected = np.sort([np.sqrt(2e4 / m), np.sqrt(40.0 / (m * 0.05**2 / 2.0))])
    assert omega == pytest.approx(expected, rel=1e-3)  # the rods stretch and twist


def test_stress_of_a_bent_plate_on_top_middle_and_bottom() -> None:
    """The first bending mode of a free plate: opposite stresses on both faces, none in the middle, 6 M/t^2 by the
    curvature of the mode."""
    p = patch("quad4", 24, 6, lambda u, v: np.stack([0.6 * u, 0.05 * v, 0.0 * u], axis=1))
    mesh = Mesh(p.points, {}, structure=[Shell(p.nodes, 0.004, STEEL)])
    body = reduced(mesh, modes=1, stress={"t": "top", "m": "middle", "b": "bottom"})
    top, middle, bottom = (body.stress[name].modes[0] for name in "tmb")
    assert np.abs(top + bottom).max() < 1e-6 * np.abs(top).max()  # stored in single precision
    assert np.abs(middle).max() < 0.02 * np.abs(top).max()  # transverse shear only
    here = int(np.argmin(np.linalg.norm(body.stress["t"].points - [0.3, 0.025, 0.002], axis=1)))
    x = body.surface.points[:, 0]
    w = body.surface.modes[0, :, 2]
    row = np.isclose(body.surface.points[:, 1], 0.025)
    order = np.argsort(x[row])
    fitted = np.polynomial.Polynomial.fit(x[row][order], w[row][order], 10)
    curvature = fitted.deriv(2)(body.stress["t"].points[here, 0])
    assert top[here, 0] == pytest.approx(-210e9 * 0.002 * curvature, rel=0.02)  # anticlastic bending across the strip
    with pytest.raises(InputError, match="'top', 'middle'"):
        reduced(mesh, modes=1, stress={"skin": "skin"})


def test_a_box_of_shells_swings_and_keeps_its_energy() -> None:
    """A closed box hinged at one corner node, at the full level of inertia: the energy residual over the energy."""
    points, nodes = closed_box("quad4", 4, (0.4, 0.3, 0.2))
    corner = int(np.argmin(points.sum(axis=1)))
    mesh = Mesh(points, {}, structure=[Shell(nodes, 0.002, STEEL)], node_sets={"corner": [corner]})
    body = reduced(mesh, modes=8, interfaces={"corner": "rigid"})
    scene = wf.Scene(gravity=(0.0, 0.0, -9.81))
    box = scene.add_body(body, name="box", inertia="full", damping=0.0)
    scene.add(wf.joints.Revolute(scene.ground, box["corner"], axis=(0.0, 1.0, 0.0)))
    result = wf.simulate(scene, 0.05, step=2e-4, progress=False)
    assert str(result.status) == "completed"
    energy = result.energy["kinetic"] + result.energy["strain"] + result.energy["potential"]
    assert np.max(result.energy["kinetic"]) > 0.1
    assert np.abs(energy - energy[0]).max() < 1e-4 * np.max(result.energy["kinetic"])  # damping of the integrator


@pytest.mark.parametrize(
    ("parts", "text"),
    [
        ([PointMass(1, 1.0, offset=(0.1, 0.0, 0.0))], "no rotation"),
        ([Spring((0, 1), [0, 0, 0, 1.0, 0, 0])], "rotational stiffness"),
        ([3.0], "structure holds"),
    ],
)
def test_parts_on_nodes_without_rotation_are_refused(parts: list, text: str) -> None:
    block = wf.mesh.box((0.1, 0.1, 0.1), (1, 1, 1), order=1)
    with pytest.raises(InputError, match=text):
        reduced(Mesh(block.points, block.cells, structure=parts), STEEL, modes=1)


def test_what_a_body_of_shells_does_not_have_is_refused() -> None:
    p = patch("quad4", 2, 2, lambda u, v: np.stack([0.1 * u, 0.1 * v, 0.0 * u], axis=1))
    shell = Shell(p.nodes, 0.001, STEEL, name="plate")
    facets = {"plate": wf.mesh.FacetSet({"quad4": p.nodes})}
    mesh = Mesh(p.points, {}, facets, structure=[shell], node_sets={"a": [0]})
    with pytest.raises(InputError, match="needs? solid cells"):
        reduced(mesh, contact={"plate": wf.surfaces.Plane()})
    with pytest.raises(InputError, match="a node set is a rigid interface"):
        reduced(mesh, interfaces={"a": "average"})
    with pytest.raises(InputError, match="geometric stiffness of shells"):
        reduced(mesh, options=wf.ReductionOptions(stiffening=True))
    with pytest.raises(InputError, match="disconnected"):
        two = np.concatenate([p.points, p.points + [1.0, 0.0, 0.0]])
        both = Shell(np.concatenate([p.nodes, p.nodes + len(p.points)]), 0.001, STEEL)
        reduced(Mesh(two, {}, structure=[both]))
    with pytest.raises(InputError, match="belong to no solid, shell"):
        reduced(Mesh(np.concatenate([p.points, [[9.0, 9.0, 9.0]]]), {}, structure=[shell]))
    with pytest.raises(InputError, match="no body has the inertia"):
        PointMass(0, 1.0, inertia=np.diag([1.0, 1.0, 3.0]))
    with pytest.raises(InputError, match="two different nodes"):
        RigidLink([3, 3])


def test_pyvista_gets_every_shell_and_beam_once() -> None:
    """Also those in a set."""
    pytest.importorskip("pyvista")
    p = patch("quad8", 2, 2, lambda u, v: np.stack([0.1 * u, 0.1 * v, 0.0 * u], axis=1))
    beam = Beam([[0, 1]], BeamSection.circle(0.001), STEEL, (0.0, 0.0, 1.0))
    facets = {"part": wf.mesh.FacetSet({"quad8": p.nodes[:1]})}
    grid = Mesh(p.points, {}, facets, structure=[Shell(p.nodes, 0.001, STEEL), beam]).to_pyvista()
    assert sorted(grid.celltypes.tolist()) == [3, 23, 23, 23, 23] and grid.cell_data["part"].sum() == 1


def test_a_body_is_told_from_another_by_its_parts() -> None:
    """The hash of the cache."""
    points, nodes = rod()
    made = [
        Mesh(points, {}, structure=[Beam(nodes, BeamSection.circle(r), STEEL, y)]).content_hash()
        for r, y in ((0.01, (0.0, 1.0, 0.0)), (0.011, (0.0, 1.0, 0.0)), (0.01, (0.0, 0.0, 1.0)))
    ]
    assert len(set(made)) == 3


def test_the_example_of_the_page_runs(capsys: pytest.CaptureFixture[str]) -> None:
    """Its mass is that of plate, rib and motor."""
    page = (Path(__file__).parents[3] / "docs" / "structures.md").read_text(encoding="utf-8")
    (block,) = re.findall(r"```py\n(.*?)```", page, re.DOTALL)
    names: dict = {}
    exec(compile(block.replace("modes=6", "modes=6, cache=False, progress=False"), "structures.md", "exec"), names)
    mass = 7850.0 * (0.4 * 0.3 * 0.003 + 0.01 * 0.02 * 0.4) + 1.2
    assert names["panel"].mass == pytest.approx(mass, rel=ROUND_OFF)
    assert capsys.readouterr().out
