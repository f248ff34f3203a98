"""Membrane energy: against the full energy of St. Venant-Kirchhoff's material, free beams that have none, all kinds."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
import scipy.sparse as sp
from offline_bodies import STEEL
from plates import plate

from references.large_deflections.body import StVenantKirchhoffBody
from references.membrane import membrane_energy, membrane_gradient, membrane_tangent
from scenes.flat_settings import reduce_flat
from warpffrf.model.errors import InputError
from warpffrf.model.material import Material
from warpffrf.model.mesh import from_matrices
from warpffrf.model.mesh.elements import CELL_KINDS
from warpffrf.model.mesh.facets import rigid_modes
from warpffrf.model.reduced.body import ReducedBody
from warpffrf.offline import ReductionOptions, reduce
from warpffrf.offline.elastic import free_model
from warpffrf.offline.fe import assemble, assign, physical_gradients, projection
from warpffrf.offline.inertia import membrane, second_order
from warpffrf.offline.inertia.invariants import Prestress, prestress_stiffness
from warpffrf.offline.inertia.membrane import LOCKING, membrane_terms
from warpffrf.offline.inertia.second_order import SecondOrderStrain, lifted_stiffness, second_order_motion
from warpffrf.offline.interfaces import AverageInterface, InterfaceSystem, body_interfaces

SIDE, THICK = 0.4, 4e-3  # m
BEAM = (1.0, 0.03, 0.01)  # m
QUADRATIC = [kind for kind in CELL_KINDS if kind in ("hex20", "hex27", "wedge15", "tet10")]
NO_LIMIT = 1 << 40
SHIFT = -1e4  # (rad/s)^2, below the rigid modes and small compared with the first elastic one, 3e5 to 4e6


class Free:
    """The free constrained body behind `reduce`, its lowest modes, and their second-order strain."""

    def __init__(self, mesh, interfaces: dict[str, str], modes: int, material: Material = STEEL, chunk: int = 1 << 26):
        self.mesh, self.assignment = mesh, assign(mesh, material)
        self.system = InterfaceSystem(mesh.points, body_interfaces(mesh, interfaces))
        self.K, self.M = assemble(mesh.points, mesh.cells, self.assignment)
        T = self.system.T
        K, M = sp.csr_matrix(T.T @ self.K @ T), sp.csr_matrix(T.T @ self.M @ T)
        self.center = mesh.points.mean(axis=0)  # all meshes here are symmetric
        self.model = free_model(K, M, self.system.rigid(self.center), self.system.pinned, self.system.coordinates)
        start = np.random.default_rng(0).standard_normal(self.system.size)
        values, vectors = sp.linalg.eigsh(K, k=modes + 6, M=M, sigma=SHIFT, v0=start)
        order = np.argsort(values)[6:]
        self.omega = np.sqrt(values[order])
        self.Phi = self.model.without_rigid(vectors[:, order])
        self.U = T @ self.Phi
        self.turns = self.system.rotations(self.Phi)
        self.strain = SecondOrderStrain(mesh.points, mesh.cells, self.assignment, self.U / self.omega, chunk)
        unit = {name: turn / self.omega[:, None] for name, turn in self.turns.items()}
        self.theta, self.bare = second_order_motion(
            self.strain, self.model, self.system, self.M, unit, memory_limit=NO_LIMIT
        )

    def terms(self, **options):
        given = {"modes": None, "memory_limit": NO_LIMIT, **options}
        return membrane_terms(
            self.mesh,
            self.assignment,
            self.model,
            self.system,
            self.M,
            self.U,
            self.omega,
            rotations=self.turns,
            **given,
        )


@pytest.fixture(scope="module")
def rimmed() -> Free:
    """A plate with a rigid rim."""
    return Free(plate("hex27", (SIDE, SIDE, THICK), (4, 4, 1)), {"rim": "rigid"}, 8)


@pytest.mark.parametrize("interfaces", [{"rim": "rigid"}, {"low": "average", "high": "rigid"}])
def test_energy_along_a_parabola(interfaces) -> None:
    """V(Phi q s + Theta(q, q) s^2) of the full model is a polynomial in s: V2 s^2, no s^3, and V4 s^4 besides the work
    sigma_1 : H_1^T H_Theta of bending stress, which is named as left out."""
    body = Free(plate("hex27", (SIDE, 0.7 * SIDE, THICK), (4, 3, 1)), interfaces, 6)
    full = StVenantKirchhoffBody(body.mesh, STEEL)
    rng = np.random.default_rng(4)
    z = rng.standard_normal(6)
    z *= np.sqrt(20.0 / np.max(body.bare)) / np.linalg.norm(z)  # stretching counts
    r = body.strain.pairs.products(z)
    u1, u2 = body.strain.Z @ z, body.theta @ r
    s = np.linspace(-1.0, 1.0, 17)
    series = np.polynomial.Polynomial.fit(s, [full.energy(a * u1 + a * a * u2) for a in s], 8).convert().coef
    v2, v4 = 0.5 * z @ z, 0.5 * r @ body.strain.energies(body.theta) @ r
    H1, H2 = full.gradient(u1), full.gradient(u2)
    sigma = np.zeros_like(H1)
    lam, mu = STEEL.lame
    sigma += mu * (H1 + H1.swapaxes(2, 3)) + lam * np.trace(H1, axis1=2, axis2=3)[..., None, None] * np.eye(3)
    bent = np.einsum("eqab,eqca,eqcb,eq", sigma, H1, H2, full.weight, optimize=True)
    assert series[2] == pytest.approx(v2, rel=1e-8)
    assert abs(series[3]) < 1e-7 * v2  # round-off of K_f^+
    assert series[4] == pytest.approx(v4 + bent, rel=1e-6, abs=1e-8 * v2)
    assert v4 > 0.01 * v2 and abs(bent) < 0.05 * v4  # (t/L)^2 times slopes: small compared with it


@pytest.mark.parametrize(("kind", "lifted"), [("average", True), ("rigid", True), ("rigid", False)])
def test_free_beam_has_none(kind, lifted, monkeypatch) -> None:
    """Table B5: V4/V2 < 2e-3 at a deflection of the ends of L/10; without the lift of rigid ends it is above one."""
    if not lifted:
        monkeypatch.setattr(second_order, "lift", lambda *_: None)
    body = Free(plate("hex27", BEAM, (24, 1, 1)), {"low": kind, "high": kind}, 2)
    z_moves = np.abs(body.U[2::3]).max(axis=0) > np.abs(body.U[1::3]).max(axis=0)
    first = int(np.flatnonzero(z_moves)[0])
    tip = int(np.argmax(body.mesh.points[:, 0]))
    z = np.zeros(2)
    z[first] = 0.1 * BEAM[0] * body.omega[first] / abs(body.U[3 * tip + 2, first])
    r = body.strain.pairs.products(z)
    ratio = float(r @ body.strain.energies(body.theta) @ r / (z @ z))
    assert (ratio < 2e-3) if lifted else (ratio > 1.0)


def test_interfaces_move_as_their_loads_stiffen() -> None:
    """-q.K_k q/2, from stresses of unit loads and the virial of rigid interfaces, is the interfaces' part of Theta."""
    body = Free(plate("hex27", (SIDE, 0.7 * SIDE, 0.1 * SIDE), (3, 2, 1)), {"low": "rigid", "high": "average"}, 5)
    prestress = Prestress.of(body.model, body.system, body.M, body.center)
    K = prestress_stiffness(body.mesh.points, body.mesh.cells, body.assignment, prestress.static, body.U)
    lift = lifted_stiffness(prestress, body.model, body.system, body.K, body.M, body.turns, 5)
    pairs = body.strain.pairs
    alone, moved = np.zeros_like(body.theta), []
    unit = {name: turn / body.omega[:, None] for name, turn in body.turns.items()}
    second_order.lift(body.system, unit, pairs, alone)
    for interface in body.system.interfaces:
        if isinstance(interface, AverageInterface):
            moved.append(interface.S @ body.theta[interface.dofs])
            continue
        X = rigid_modes(body.mesh.points[interface.nodes], interface.point)
        motion, residual, *_ = np.linalg.lstsq(X, (body.theta - alone)[interface.dofs], rcond=None)
        assert residual.max() < 1e-16 * (body.theta**2).sum(axis=0).max()  # less the lift it is rigid
        moved.append(motion)
    scale = body.omega[pairs.first] * body.omega[pairs.second] / pairs.weight
    for found, motion in zip((K + lift)[6:].reshape(2, 6, 5, 5), moved, strict=True):
        expected = -2.0 * motion * scale
        got = found[:, pairs.first, pairs.second]
        np.testing.assert_allclose(got, expected, atol=1e-7 * np.abs(got).max(axis=1, keepdims=True).max())
    assert np.abs(lift).max() > 1e-3 * np.abs(K).max()


def test_chunks_and_blocks_change_nothing(rimmed, monkeypatch) -> None:
    """To round-off of sums in another order."""
    whole = rimmed.terms()
    monkeypatch.setattr(second_order, "BLOCK_BYTES", 1)  # one pair at a time
    parts = rimmed.terms(chunk_bytes=1)  # one cell at a time
    assert len(parts.forms) == len(whole.forms)
    scale = np.abs(whole.forms).max()
    gram = np.einsum("rij,rkl->ijkl", whole.forms, whole.forms)
    np.testing.assert_allclose(np.einsum("rij,rkl->ijkl", parts.forms, parts.forms), gram, atol=1e-9 * scale**2)


def test_squares_are_the_energy_but_for_the_truncation(rimmed) -> None:
    """V4 of random states: never more than all of it, less by at most the fraction stated of the largest."""
    terms, A = rimmed.terms(), rimmed.strain.energies(rimmed.theta)
    rng = np.random.default_rng(6)
    values = np.linalg.eigvalsh(A)
    assert values[0] >= -1e-12 * values[-1]  # table B6
    assert terms.facts["rank"] == len(terms.forms) == int(np.sum(values > membrane.TRUNCATION * values[-1]))
    np.testing.assert_array_equal(terms.forms, terms.forms.transpose(0, 2, 1))
    for _ in range(20):
        z = rng.standard_normal(8)
        r = rimmed.strain.pairs.products(z)
        assert r @ r == pytest.approx((z @ z) ** 2)
        exact, kept = 0.5 * r @ A @ r, membrane_energy(terms.forms, z / rimmed.omega)
        assert -1e-12 * exact <= exact - kept <= terms.facts["truncation"] * 0.5 * values[-1] * (z @ z) ** 2
    # without truncation it is all of it
    every = dataclasses.replace(rimmed.strain)
    forms = every.pairs.forms(np.eye(len(every.pairs)))
    assert np.einsum("rij,i,j->r", forms, z, z) == pytest.approx(r)


def test_gradient_and_tangent_are_derivatives(rimmed) -> None:
    forms = rimmed.terms().forms
    q = np.concatenate([np.random.default_rng(7).standard_normal(8) / rimmed.omega, [1.0]])  # one mode more, without
    steps = [(1e-4 / w, unit) for w, unit in zip(rimmed.omega, np.eye(9)[:8], strict=True)]
    g = [(membrane_energy(forms, q + a * d) - membrane_energy(forms, q - a * d)) / (2 * a) for a, d in steps]
    np.testing.assert_allclose(membrane_gradient(forms, q), g, rtol=1e-6)
    H = [(membrane_gradient(forms, q + a * d) - membrane_gradient(forms, q - a * d)) / (2 * a) for a, d in steps]
    K = membrane_tangent(forms, q)
    np.testing.assert_allclose(K, H, atol=1e-6 * np.abs(K).max())
    np.testing.assert_array_equal(K, K.T)


def first_mode(kind: str, thick: float, counts: tuple[int, int, int]):
    """The body of a plate with a rigid rim, and V4 of its first mode at q = 1."""
    mesh = plate(kind, (SIDE, SIDE, thick), counts)
    body = reduce(
        mesh,
        STEEL,
        interfaces={"rim": "rigid"},
        modes=4,
        options=ReductionOptions(stiffening="membrane"),
        cache=False,
        progress=False,
    )
    assert body.inertia_terms is not None and body.inertia_terms.stiffening is not None
    forms = body.inertia_terms.stiffening.membrane
    facts = body.report["inertia"]["membrane"]
    assert forms is not None and len(forms) == facts["rank"] > 0
    assert facts["least_eigenvalue"] >= -1e-12  # table B6
    return body, membrane_energy(forms, np.eye(len(body.frequencies))[0])


@pytest.fixture(scope="module")
def by_hex27():
    return first_mode("hex27", 4 * THICK, (8, 8, 1))[1]


@pytest.mark.parametrize("kind", [k for k in QUADRATIC if k != "hex27"])
def test_quadratic_cells_agree(kind, by_hex27) -> None:
    """Within 2 %; the frequency of the mode differs by up to 4 % between them on these meshes."""
    body, energy = first_mode(kind, 4 * THICK, (8, 8, 1))
    assert energy == pytest.approx(by_hex27, rel=0.02)
    assert not body.report["warnings"]


@pytest.mark.parametrize("kind", LOCKING)
def test_linear_cells_lock_and_say_so(kind, monkeypatch) -> None:
    with pytest.raises(InputError, match=f"use quadratic cells, as {kind} cells lock in bending"):
        first_mode(kind, 2 * THICK, (3, 3, 1))
    monkeypatch.setattr(membrane, "BENDING", np.inf)
    body, _ = first_mode(kind, 2 * THICK, (3, 3, 1))
    assert any(f"{kind} cells cannot relieve second-order strain" in w for w in body.report["warnings"])


def test_mixed_cells() -> None:
    """The projection keeps polynomials of its own; V4 of mixed cells at nu 0.3 is that of plain ones within 2 %, and of
    nearly incompressible ones no infinite number."""
    mesh = plate("hex27", (SIDE, SIDE, 4 * THICK), (6, 6, 1))
    (x,) = (mesh.points[cells] for cells in mesh.cells.values())
    P = projection(x, "hex27")
    np.testing.assert_allclose(P @ P, P, atol=1e-10)
    slopes, _ = physical_gradients(x, "hex27")
    linear = np.einsum("eqai,eai->eq", slopes, x**2) / 2.0  # div of x^2/2: x + y + z
    np.testing.assert_allclose(np.einsum("epq,eq->ep", P, linear), linear, atol=1e-10 * np.abs(linear).max())
    found = []
    for nu, formulation in ((0.3, "displacement"), (0.3, "mixed"), (0.49, None)):
        material = Material(210e9, nu, 7850.0, formulation=formulation)
        body = Free(mesh, {"rim": "rigid"}, 1, material)
        found.append(float(body.strain.energies(body.theta)[0, 0] * body.omega[0] ** 4))
    assert found[1] == pytest.approx(found[0], rel=0.02)
    # a clamped membrane that is stretched in its plane has E/(1 - nu^2)
    assert found[2] / found[0] == pytest.approx((1 - 0.3**2) / (1 - 0.49**2), rel=0.15)


def test_memory_limit_names_what_fits(rimmed) -> None:
    size = rimmed.U.shape[0]
    with pytest.raises(InputError, match=r"8 modes has 36 fields.*membrane_modes=3 or raise memory_limit"):
        rimmed.terms(memory_limit=8 * size * 6)


def made_plate(**settings):
    mesh = plate("hex27", (SIDE, SIDE, THICK), (3, 3, 1))
    given = {"interfaces": {"rim": "rigid"}, "modes": 3, "stiffening": "membrane", "cache": False, "progress": False}
    return reduce_flat(mesh, STEEL, **{**given, **settings})


def test_file_and_report(tmp_path) -> None:
    body = made_plate(membrane_modes=2, stress={"top": "skin"})
    again = ReducedBody.load(body.save(tmp_path / "plate.h5"))
    assert again.content_hash() == body.content_hash()
    for one in (body, again):
        assert one.inertia_terms is not None and one.inertia_terms.stiffening is not None
        forms = one.inertia_terms.stiffening.membrane
        assert forms is not None and forms.shape[1:] == 2 * (len(body.frequencies),)
        assert not forms[:, 2:].any() and forms[:, :2, :2].any()
        motion, second = one.inertia_terms.stiffening.motion, one.surface.second_order
        assert motion is not None and second is not None
        assert len(motion.forms) == len(second) == body.report["inertia"]["membrane"]["shapes"] == 3
        assert not motion.forms[:, 2:].any()
        field = one.stress["top"].membrane
        assert field is not None and field.shape == (len(forms), len(one.stress["top"].points), 6)
    facts = body.report["quality"]["membrane"]
    assert facts == body.report["inertia"]["membrane"] and facts["modes"] == 2 and facts["pairs"] == 3
    assert f"membrane energy in {facts['rank']} squares" in body.info()
    assert f"{facts['rank']} squares of 2 modes (3 products), error below" in body.info()
    assert any(
        "second-order motion on 3 shapes" in note and "inertia is neglected" in note for note in body.report["notes"]
    )
    with pytest.raises(InputError, match="amplitudes of the membrane energy must be"):
        body.stress["top"].evaluate(np.zeros(len(body.frequencies)), {}, membrane=np.zeros(99))


def test_true_and_false_are_as_they_were(tmp_path) -> None:
    plain = made_plate(stiffening=True)
    assert plain.inertia_terms is not None and plain.inertia_terms.stiffening is not None
    assert plain.inertia_terms.stiffening.membrane is None and plain.report["inertia"]["membrane"] is None
    again = ReducedBody.load(plain.save(tmp_path / "plate.h5"))
    assert again.inertia_terms is not None and again.inertia_terms.stiffening is not None
    assert again.inertia_terms.stiffening.membrane is None
    without = made_plate(stiffening=False)
    assert without.inertia_terms is not None and without.inertia_terms.stiffening is None


def test_free_beams_keep_nothing() -> None:
    mesh = plate("hex27", (1.0, 0.03, 0.02), (12, 1, 1))
    body = reduce(
        mesh,
        STEEL,
        modes=4,
        options=ReductionOptions(stiffening="membrane"),
        stress={"top": "skin"},
        cache=False,
        progress=False,
    )
    assert body.report["inertia"]["membrane"]["rank"] == 0
    q = np.ones(len(body.frequencies))
    field = body.stress["top"]
    np.testing.assert_array_equal(field.evaluate(q, {}, membrane=np.zeros(0)), field.evaluate(q, {}))
    assert any("no membrane energy is kept; stiffening=True is equivalent" in n for n in body.report["notes"])
    assert "no energy kept" in body.info()


def test_bad_input() -> None:
    with pytest.raises(InputError, match="stiffening must be True or False, or 'membrane', got 'yes'"):
        made_plate(stiffening="yes")
    with pytest.raises(InputError, match="membrane_modes is a number of modes of stiffening='membrane'"):
        made_plate(stiffening=True, membrane_modes=3)
    with pytest.raises(InputError, match="membrane_modes=0 is a membrane basis without bending modes"):
        made_plate(membrane_modes=0)
    with pytest.raises(InputError, match="membrane_modes=99, of a body with .* modes that have inertia terms"):
        made_plate(membrane_modes=99)
    with pytest.raises(InputError, match="a membrane basis without bending modes: stretching is significant in none"):
        reduce(
            plate("hex27", (1, 1, 1), (2, 2, 2)),
            STEEL,
            modes=4,
            options=ReductionOptions(stiffening="membrane"),
            cache=False,
            progress=False,
        )
    for none in ({"modes": 0, "interfaces": {}}, {"inertia_modes": 0}):
        with pytest.raises(InputError, match="bending modes: the body has no modes with inertia terms; request some"):
            made_plate(**none)
    mesh = plate("hex8", (0.01, 0.01, 0.03), (1, 1, 2))
    K, M = assemble(mesh.points, mesh.cells, assign(mesh, STEEL))
    bare = from_matrices(sp.csr_matrix(M), sp.csr_matrix(K), mesh.points)
    with pytest.raises(InputError, match="stiffening='membrane' needs the stresses in cells of a known material"):
        reduce(bare, modes=2, options=ReductionOptions(stiffening="membrane"), cache=False, progress=False)


def without_forms(body: ReducedBody) -> ReducedBody:
    """The body without amplitudes of its second-order motion."""
    assert body.inertia_terms is not None and body.inertia_terms.stiffening is not None
    stiffening = dataclasses.replace(body.inertia_terms.stiffening, motion=None)
    return dataclasses.replace(body, inertia_terms=dataclasses.replace(body.inertia_terms, stiffening=stiffening))


@pytest.mark.parametrize("kept", ["forms", "shapes"])
def test_half_of_a_second_order_motion_is_refused(kept, tmp_path) -> None:
    """Forms without shapes are shown by nothing, shapes without forms have no amplitudes."""
    body = made_plate(membrane_modes=2)
    if kept == "forms":
        half = dataclasses.replace(body, surface=dataclasses.replace(body.surface, second_order=None))
    else:
        half = without_forms(body)
    path = half.save(tmp_path / "plate.h5")
    with pytest.raises(InputError, match=r"second.order"):
        ReducedBody.load(path)


def test_shapes_are_those_of_all_pairs(rimmed) -> None:
    """Orthonormal in the mass; the motion of random states to the fraction stated of the largest root mean square of
    the same strain energy."""
    terms, rng = rimmed.terms(), np.random.default_rng(8)
    gram = terms.shapes.T @ (rimmed.M @ terms.shapes)
    np.testing.assert_allclose(gram, np.eye(len(gram)), atol=1e-9)
    largest = np.sqrt(np.linalg.eigvalsh(rimmed.theta.T @ (rimmed.M @ rimmed.theta))[-1])
    for _ in range(20):
        z = rng.standard_normal(8)
        exact = rimmed.theta @ rimmed.strain.pairs.products(z)
        error = exact - terms.shapes @ terms.second_order.amplitudes(z / rimmed.omega)
        assert np.sqrt(error @ (rimmed.M @ error)) <= 1.000001 * terms.facts["motion_left_out"] * largest * (z @ z)
    np.testing.assert_allclose(terms.second_order.overlap, rimmed.U.T @ (rimmed.M @ terms.shapes), atol=1e-12)


def test_kinetic_energy_of_second_order_motion(rimmed) -> None:
    """Of the full model's mass with the velocity Phi qd + dTheta/dt, to what was left out."""
    terms, rng = rimmed.terms(), np.random.default_rng(9)
    pairs, omega = rimmed.strain.pairs, rimmed.omega
    for _ in range(5):
        z, zd = 30.0 * rng.standard_normal((2, 8))
        rate = pairs.weight * (z[pairs.first] * zd[pairs.second] + zd[pairs.first] * z[pairs.second])
        second = rimmed.theta @ rate
        v = rimmed.U @ (zd / omega) + second
        expected = 0.5 * v @ (rimmed.M @ v) - 0.5 * np.sum((zd / omega) ** 2)
        found = terms.second_order.kinetic_energy(z / omega, zd / omega)
        # left out in the mass, once next to the modes and once next to itself
        speed = np.sqrt(second @ (rimmed.M @ second))
        scale = speed * (np.linalg.norm(zd / omega) + speed)
        assert abs(found - expected) < 10.0 * terms.facts["motion_left_out"] * scale
        assert abs(expected) > 100.0 * abs(found - expected)
