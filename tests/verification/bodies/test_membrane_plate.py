"""Reduced plates with membrane energy compared with full finite elements of the same mesh: deflections and stresses."""

from __future__ import annotations

import copy

import numpy as np
import pytest
from skfem import Basis

from references.finite_elements.meshes import scalar_basis
from references.large_deflections.body import StVenantKirchhoffBody
from references.large_deflections.statics import by_load
from references.membrane import membrane_gradient, membrane_tangent
from scenes.flat_settings import reduce_flat
from warpffrf.model import joints
from warpffrf.model.material import Material
from warpffrf.model.mesh import FacetSet, Mesh, box
from warpffrf.model.reduced.body import ReducedBody
from warpffrf.model.reduced.inertia import membrane_amplitudes
from warpffrf.model.reduced.stress_field import von_mises
from warpffrf.model.scene import Scene
from warpffrf.output.simulate import equilibrium

SIDE, THICK = 0.4, 4e-3  # m
MATERIAL = Material(210e9, 0.316, 7850.0)
LOADS = (17.79, 134.9, 402.0)  # q a^4/(E t^4): w/t 0.22, 1.07 and 1.80
UNIT = MATERIAL.youngs_modulus * THICK**3 / (SIDE**4 * MATERIAL.density)  # m/s^2 of q a^4/(E t^4) = 1
DEFLECTION = 0.005  # of the full model's
# of the largest membrane stress: nodal means on cells an eighth of the side long, against values inside of them
STRESS = 0.02
# of the largest stress: that of the modes, second-order bending stress, and the truncation of the membrane energy
RESULT_STRESS = 0.03
STEPS = 60


class Plate:
    """A square plate in a rigid rim under pressure, by full finite elements, and points inside of its cells."""

    def __init__(self) -> None:
        plain = box((SIDE, SIDE, THICK), (8, 8, 1))
        sides = [plain.facets(name) for name in ("x_min", "x_max", "y_min", "y_max")]
        rim = FacetSet({kind: np.concatenate([s.blocks[kind] for s in sides]) for kind in sides[0].blocks})
        self.mesh = Mesh(plain.points, plain.cells, {"rim": rim})
        self.full = StVenantKirchhoffBody(self.mesh, MATERIAL)
        self.middle = self.full.nearest_node((0.0, 0.0, 0.5 * THICK))
        load = self.full.body_force((0.0, 0.0, UNIT))
        self.states = by_load(self.full, self.full.held("rim"), load, LOADS)
        self.deflections = np.array([s.u[3 * self.middle + 2] for s in self.states])

    def reduced(self, **settings) -> ReducedBody:
        given = {"interfaces": {"rim": "rigid"}, "stiffening": "membrane", "cache": False, "progress": False}
        return reduce_flat(self.mesh, MATERIAL, **{**given, **settings})


@pytest.fixture(scope="module")
def plate() -> Plate:
    return Plate()


def held_equilibrium(body: ReducedBody, load: float, q: np.ndarray, membrane: bool = True) -> np.ndarray:
    """q at rest with the rim held under a uniform acceleration `load` along z, from `q`.

    The rim moves by Phi q; held, the body goes back by that. By symmetry only along z: the load's work is
    -m a (Phi q)_z, and geometric stiffness does nothing, as no load on the rim is along the plate.
    """
    stiffness = (2.0 * np.pi * body.frequencies) ** 2
    force = -body.mass * load * body.interfaces["rim"].modes[:, 2]
    assert body.inertia_terms is not None and body.inertia_terms.stiffening is not None
    L = body.inertia_terms.stiffening.membrane
    assert L is not None
    k = L.shape[1]
    for _ in range(STEPS):
        gradient, tangent = stiffness * q - force, np.diag(stiffness)
        if membrane:
            gradient[:k] += membrane_gradient(L, q)
            tangent[:k, :k] += membrane_tangent(L, q)
        step = np.linalg.solve(tangent, gradient)
        q = q - step
        if np.linalg.norm(step) < 1e-10 * np.linalg.norm(q):
            return q
    raise AssertionError("no equilibrium of the reduced plate")


def deflections(plate: Plate, body: ReducedBody, membrane: bool = True) -> np.ndarray:
    """w in the middle relative to the rim, at each of the loads."""
    at = int(np.argmin(np.linalg.norm(body.surface.points - plate.mesh.points[plate.middle], axis=1)))
    shape = body.surface.modes[:, at, 2] - body.interfaces["rim"].modes[:, 2]
    q, found = np.zeros(len(body.frequencies)), []
    for load in LOADS:
        q = held_equilibrium(body, load * UNIT, q, membrane)
        found.append(shape @ q)
    return np.array(found)


@pytest.mark.parametrize(("modes", "membrane_modes"), [(14, None), (14, 10), (25, None)])
def test_deflection(plate, modes, membrane_modes) -> None:
    """Up to w/t 1.8 within half a per cent; without membrane energy nearly three times as far at the end."""
    body = plate.reduced(modes=modes, membrane_modes=membrane_modes)
    found = deflections(plate, body)
    print(modes, membrane_modes, "w/t", plate.deflections / THICK, "error", found / plate.deflections - 1)
    np.testing.assert_allclose(found, plate.deflections, rtol=DEFLECTION)
    linear = deflections(plate, body, membrane=False) / plate.deflections
    assert linear[0] < 1.03 and linear[1] > 1.5 and 2.7 < linear[2] < 3.0


def test_stress(plate) -> None:
    """Second Piola-Kirchhoff stress along the plate at w/t 1.07, in the middle of cells: their mean by the full model,
    which no bending is in, and what neighbours of the cells in the rim's corners have."""
    full, state = plate.full, plate.states[1]
    expected = np.einsum("eqi,eq->ei", full.stress(state.u), full.weight) / full.weight.sum(axis=1)[:, None]
    centres = plate.mesh.points[full.nodes].mean(axis=1)
    body = plate.reduced(modes=25, stress={"centres": centres})
    q = np.zeros(len(body.frequencies))
    for load in LOADS[:2]:
        q = held_equilibrium(body, load * UNIT, q)
    assert body.inertia_terms is not None and body.inertia_terms.stiffening is not None
    forms = body.inertia_terms.stiffening.membrane
    assert forms is not None
    found = body.stress["centres"].evaluate(q, {}, membrane=membrane_amplitudes(forms, q))
    largest = np.abs(expected).max()
    error = np.abs(found - expected) / largest
    inside = np.all(np.abs(centres[:, :2]) < 0.3 * SIDE, axis=1)
    print("error", error[inside].max(axis=0).round(4), error.max(axis=0).round(4))
    assert error[inside][:, [0, 1, 3]].max() < STRESS
    bending = body.stress["centres"].evaluate(q, {})[:, [0, 1, 3]]
    assert np.abs(bending).max() < 1e-6 * largest  # along the plate it has none there


def in_the_middle_of_cells(plate: Plate) -> tuple[StVenantKirchhoffBody, np.ndarray]:
    """The full model with its stresses in the middle of cells, on both sides of the plate, and these points (e, 2, 3).
    Elsewhere in a cell much wider than deep its bending stress swings by a fifth, as shear holds w' linear there."""
    basis, _ = scalar_basis(plate.mesh)
    one = 0.5 + 0.5 / np.sqrt(3.0) * np.array([-1.0, 1.0])
    X = np.array([[0.5, 0.5], [0.5, 0.5], one])
    basis = Basis(basis.mesh, basis.elem, quadrature=(X, np.full(2, 0.5)))
    full = copy.copy(plate.full)
    full.slopes = np.stack([np.asarray(f[0].grad) for f in basis.basis]).transpose(2, 3, 0, 1)
    return full, np.moveaxis(np.asarray(basis.global_coordinates()), 0, -1)


def test_stress_of_results(plate) -> None:
    """Second Piola-Kirchhoff stress of a result, bending and membrane together, and von Mises stress at w/t 1.07; a
    body that loads do not stiffen has no membrane part."""
    full, x = in_the_middle_of_cells(plate)
    inside = np.all(np.abs(x[:, :, :2]).max(axis=1) < 0.3 * SIDE, axis=1)
    points, expected = x[inside].reshape(-1, 3), full.stress(plate.states[1].u)[inside].reshape(-1, 6)
    body = plate.reduced(modes=25, stress={"inside": points})
    found = {}
    for stiffening in (True, False):
        scene = Scene(gravity=(0.0, 0.0, LOADS[1] * UNIT))
        held = scene.add_body(body, name="plate", stiffening=stiffening, inertia="constant")
        scene.add(joints.Fixed(scene.ground, held["rim"], name="rim"))
        result = equilibrium(scene)
        assert result.status == "completed"
        found[stiffening] = result.stress("plate", "inside")
    largest = np.abs(expected).max()
    error = np.abs(found[True].tensor[-1] - expected).max(axis=0) / largest
    mises = von_mises(expected)
    worst = np.abs(found[True].von_mises[-1] - mises).max() / mises.max()
    print("S of", largest, "error", error.round(4), "von Mises", worst)
    assert error[[0, 1, 3]].max() < RESULT_STRESS and worst < RESULT_STRESS
    q = result.history.bodies["plate"].modal[-1]
    np.testing.assert_array_equal(found[False].tensor[-1], body.stress["inside"].evaluate(q, {}))
